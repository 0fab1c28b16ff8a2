//! `myo compare`: which of two layouts is better.

use std::path::{Path, PathBuf};

use clap::Args;
use myo::train::RunFolder;
use myo::{Comparison, Group};

use super::failure::{Failure, Result};
use super::interrupt::Interrupt;
use super::output::{argument, command, print, print_json, row, table};
use super::scenario::{Scenario, run_name};
use super::train::{Several, Side, TrainingOptions, free_folder, train_both, train_users};

/// Arguments of `myo compare`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Compare {
    /// A task, by its name or file; or users trained before: a run folder, or one of `myo train --seeds`
    first: String,

    /// The other one
    second: String,

    /// Users to train on each task: ten tell apart what five see five times in six
    #[arg(long, value_name = "N", default_value = "10", value_parser = super::parse::positive)]
    seeds: usize,

    /// Folder to make for them [default: runs/<n>, named after both tasks]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    #[command(flatten)]
    how: TrainingOptions,

    /// Print the result as JSON on standard output; progress stays on standard error
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo compare grid.yaml row.yaml                    ten users of each, trained until they have finished learning
  myo compare ar public-display --seeds 5 --json
  myo compare runs/grid-1 runs/row-1                users that are trained already

Every user is a training of its own, with its own seed, and is evaluated in 1,000 fresh episodes. On a graphics card the users of both
tasks train at once, each to the bit as alone, where the tasks differ in numbers alone, time limits are the same and there are no more
than 64 users; else those of the second after those of the first. A difference is claimed where
it is unlikely to be chance (the rank-sum test over users, with fewer than five of each Welch's; Holm's correction over success,
time, effort and fatigue: a layout differs from itself once in twenty comparisons) and larger than what more training may still bring
(3 % of time, effort and fatigue, 1 % of success).
With one user of a layout nothing can be claimed. What else weakens the comparison is told: other bodies, versions, kinds of
targets, rewards or settings, and users that had not finished learning.

The users are kept in a folder for each layout: stopped with Ctrl-C, go on with `myo train --resume` and compare the folders.

JSON: `names`, `users` (of each), `differences`, a list of objects with `quantity` (`success`, `episode_length_s`, `effort`, `fatigue`),
`first`, `second`, `difference` (second less first), `interval` (95 %), `p_value` and `verdict` (`higher`, `lower`,
`within_training`, `no_difference`, `unknown`); `caveats`; `sentences`; `folders`.";

/// Runs `myo compare`.
pub fn run(args: &Compare) -> Result<()> {
    let arguments = [&args.first[..], &args.second[..]];
    let trained = arguments.map(|argument| Path::new(argument).is_dir().then(|| PathBuf::from(argument)));
    let folders = match trained {
        [Some(first), Some(second)] => [first, second],
        trained => train(args, arguments, trained)?,
    };
    let names = names(arguments, &folders);
    let [first, second] = [0, 1].map(|side| group(names[side].clone(), &folders[side]));
    let comparison = Comparison::new(&first?, &second?);
    if args.json {
        let mut result = serde_json::to_value(&comparison)?;
        result["sentences"] = comparison.sentences().collect();
        result["folders"] = serde_json::to_value(&folders)?;
        return print_json(&result);
    }
    print(&report(&comparison, &folders))
}

/// Trains users of the layouts that are tasks; the folder of each.
fn train(args: &Compare, arguments: [&str; 2], trained: [Option<PathBuf>; 2]) -> Result<[PathBuf; 2]> {
    // Nothing is trained for a comparison that cannot be.
    let open = |side: usize| match &trained[side] {
        Some(folder) => group(String::new(), folder).map(|_| None),
        None => Scenario::open_for(arguments[side], args.how.user()).map(Some),
    };
    let scenarios = [open(0)?, open(1)?];
    let free = || free_folder(&format!("{}-{}", run_name(arguments[0]), run_name(arguments[1])));
    let place = args.out.clone().unwrap_or_else(free);
    let own = |side: usize| {
        let same = run_name(arguments[0]) == run_name(arguments[1]);
        let name = run_name(arguments[side]);
        place.join(if same { format!("{name}-{}", side + 1) } else { name })
    };
    let interrupt = Interrupt::listen()?;
    if let [Some(first), Some(second)] = scenarios {
        let sides = [(0, first), (1, second)].map(|(side, scenario)| Side { scenario, folder: own(side) });
        if train_both(&args.how, &sides, args.seeds, &interrupt)? {
            return Ok(sides.map(|side| side.folder));
        }
    }
    let mut folders = [PathBuf::new(), PathBuf::new()];
    for (side, trained) in trained.into_iter().enumerate() {
        folders[side] = match trained {
            Some(folder) => folder,
            None => {
                train_users(&args.how, arguments[side], args.seeds, &own(side), &interrupt)?;
                own(side)
            }
        };
    }
    Ok(folders)
}

/// What the layouts are called: like their tasks, or like their folders.
fn names(arguments: [&str; 2], folders: &[PathBuf; 2]) -> [String; 2] {
    let name = |side: usize| match Path::new(arguments[side]).is_dir() {
        true => folders[side].file_name().map_or(arguments[side].into(), |name| name.to_string_lossy().into_owned()),
        false => run_name(arguments[side]),
    };
    let names = [name(0), name(1)];
    if names[0] == names[1] { [0, 1].map(|side| format!("{} ({})", names[side], side + 1)) } else { names }
}

/// The users in a folder.
fn group(name: String, folder: &Path) -> Result<Group> {
    if let Some(several) = Several::open(folder)? {
        let (users, planned) = several.users();
        if users.len() < planned {
            let next = command(&["train", "--resume", &argument(folder)]);
            return Err(Failure::sentence(format!(
                "{} of {planned} users in {} are trained; go on with: {next}",
                users.len(),
                folder.display()
            )));
        }
        let plan = several.plan();
        return Ok(Group { name, run: plan.run.clone(), ppo: plan.ppo.clone(), users });
    }
    let run = RunFolder::open(folder)?;
    if run.evaluation()?.is_none() {
        let next = command(&["train", "--resume", &argument(folder)]);
        return Err(Failure::sentence(format!("{} is not evaluated yet; go on with: {next}", folder.display())));
    }
    Ok(Group::of_runs(name, &[run])?)
}

fn report(comparison: &Comparison, folders: &[PathBuf; 2]) -> String {
    let [first, second] = &comparison.names;
    let mut rows = vec![row(["", first, second, "difference", "95 % interval"])];
    rows.extend(comparison.differences.iter().map(|difference| {
        let show = |value| difference.quantity.show(value);
        vec![
            difference.quantity.name().into(),
            show(difference.first),
            show(difference.second),
            show(difference.difference),
            difference.interval.map_or("-".into(), |[low, high]| format!("{} to {}", show(low), show(high))),
        ]
    }));
    let users = comparison.users.map(|users| users.to_string());
    rows.push(vec!["users".into(), users[0].clone(), users[1].clone(), String::new(), String::new()]);
    let lines = |lines: Vec<String>, mark: &str| lines.iter().map(|line| format!("{mark}{line}\n")).collect::<String>();
    let sentences = comparison.sentences().collect();
    let caveats = lines(comparison.caveats.clone(), "note: ");
    let [a, b] = folders.each_ref().map(|folder| folder.display());
    format!("\n{}\n{}{caveats}\nrun folders: {a}, {b}\n", table(&rows), lines(sentences, ""))
}
