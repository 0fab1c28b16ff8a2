//! `myo fit`: which user moves as the people of recordings do.

use std::path::{Path, PathBuf};

use clap::Args;
use myo::fitting::{Anybody, Fitted, comparable, practice};
use myo::protocol::Practice;
use myo::recordings::Participant;
use myo::tasks::User;
use myo::train::PpoConfig;
use serde_json::json;

use super::backend::Options;
use super::failure::{Failure, Result, complain};
use super::interrupt::Interrupt;
use super::measure::{of_file, read};
use super::output::{print, print_json, row, table};
use super::parse;
use super::scenario::Scenario;
use super::train::{Practising, practise};

/// The task whose user begins where none is named; its targets are others.
const TASK: &str = "pointing";

/// Who can be anybody.
#[derive(Args)]
pub struct AnybodyArgs {
    /// Whose body, rhythm and senses the user has, as `myo task users` lists them, or a task with `user` and `body`
    #[arg(long, value_name = "USER|TASK", default_value = "human")]
    pub user: String,

    /// Folder of the user who has learnt to be anybody; trained there first where there is none [default: runs/anybody-USER]
    #[arg(long, value_name = "FOLDER")]
    pub practised: Option<PathBuf>,

    /// Control steps after which that training stops in any case [default: as of `myo train`]
    #[arg(long, value_name = "N", value_parser = parse::count)]
    pub steps: Option<u64>,

    /// Seed of that training, and of the simulations
    #[arg(long, value_name = "N", default_value = "1")]
    pub seed: u64,

    #[command(flatten)]
    pub physics: Options,
}

/// Arguments of `myo fit`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Fit {
    /// Tables of recordings, as `myo measure` takes them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Take all participants of a file for one person
    #[arg(long)]
    together: bool,

    #[command(flatten)]
    anybody: AnybodyArgs,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo fit people.csv                                    each participant
  myo fit people.csv --together --user older_woman      all participants as one person, on an old woman's body
  myo fit people.csv --user ours.yaml                   with body, senses and delays of that task

Looks for the user who moves as a person does: for motor noise (noise.signal_dependent), how far off targets seem (perception.vision_noise), and
what effort and changes of control cost (reward.effort_cost, reward.control_change_cost). One user learns first to be anybody, once: a training of some minutes on a graphics card, of an hour and
more on two processor cores. Then each fit is simulation alone, of 150 users who do targets of the person's distances and widths across circles, and takes a minute or two.

Recordings need three pairs of distance (6 to 40 cm) and width (1.2 to 12 cm) with eight movements each; distances and widths that differ by less
than a tenth are alike. What is compared are means over pairs: movement times, their growth with difficulty and their scatter, peak speed and its time, smoothness, straightness, and where the first
bell of speed ends, and the activation of each muscle that was recorded (columns such as DELT1_activation, 0 to 1). What the recordings do not tell is said to be unknown; its value is not to be used. Body, delays and senses are as told, and targets lie half a metre before the shoulder.

The answer has lines for the task file of a simulated participant. Distance: root mean square over figures of the difference between user and person, in
standard deviations of that figure between repetitions of one user; 1 is as near as one user is to itself.

JSON: a list of objects with `file`, `participant`, `movements`, `pairs` (distance and width in m), `traits` (`key`, `what`, `before`, `found`, `interval`, `is_told`), `distance_before`,
`distance_after`, `figures` (`what`, `person`, `before`, `after`).";

/// Runs `myo fit`.
pub fn run(args: &Fit) -> Result<()> {
    let people = args.files.iter().map(|file| Ok((file, people(file, args.together)?))).collect::<Result<Vec<_>>>()?;
    let (beginner, _) = beginner(&args.anybody.user)?;
    for (file, people) in &people {
        for person in people {
            // Before an hour of training.
            comparable(person, &beginner.model).map_err(|error| of_file(file, &error))?;
        }
    }
    let anybody = anybody(&args.anybody)?;
    let mut found = vec![];
    for (file, people) in &people {
        for person in people {
            complain(&format!("{}: simulating users like {}", file.display(), person.name));
            found.extend(anybody.fitted(person, args.anybody.seed, &|| true)?.map(|fitted| (file, fitted)));
        }
    }
    if args.json {
        let object = |(file, fitted): &(&&PathBuf, Fitted)| {
            let mut value = serde_json::to_value(fitted)?;
            value["file"] = json!(file.display().to_string());
            Ok(value)
        };
        return print_json(&found.iter().map(object).collect::<Result<Vec<_>>>()?);
    }
    let text = |(file, fitted): &(&&PathBuf, Fitted)| text(file, fitted);
    print(&found.iter().map(text).collect::<Vec<_>>().join("\n"))
}

/// The people of a file, or all of them as one.
fn people(file: &Path, together: bool) -> Result<Vec<Participant>> {
    let recordings = read(file)?;
    Ok(if together { recordings.as_one() } else { recordings }.participants)
}

/// The user who is to become somebody else, and what it is called.
fn beginner(user: &str) -> Result<(Scenario, String)> {
    let named = User::ALL.into_iter().find(|known| known.name() == user);
    match named {
        Some(user) if !user.is_human() => Err(Failure::sentence(format!(
            "--user {user}: it has no noise and no misjudgement that could be like a person's; take `human`, or another of `myo task users`",
            user = user.name()
        ))),
        Some(user) => Ok((Scenario::open_for(TASK, Some(user))?, user.name().into())),
        None => {
            let scenario = Scenario::open(user)?;
            let name = scenario.task.name.clone();
            Ok((scenario, name))
        }
    }
}

/// The user who can be anybody; it learns to be so where it is not there yet.
pub fn anybody(args: &AnybodyArgs) -> Result<Anybody> {
    let AnybodyArgs { user, practised, steps, seed, physics } = args;
    let (scenario, name) = beginner(user)?;
    let folder = practised.clone().unwrap_or_else(|| Path::new("runs").join(format!("anybody-{name}")));
    let layouts = practice(&scenario.task).map_err(|error| Failure::sentence(error.to_string()))?;
    let task = layouts[0].clone();
    let (model, own_model) = (scenario.model.clone(), scenario.own_model.clone());
    let config = Practice::Pointing.learning(&PpoConfig::for_user(task.user));
    let practised = Scenario { task, layouts, model, own_model, most_success: 1.0 };
    let practising = Practising { scenario: &practised, config, users: (1, *seed), steps: *steps, physics };
    let mut users = practise(&practising, &folder, &Interrupt::listen()?)?;
    let checkpoint = users.pop().ok_or_else(|| Failure::sentence("nobody has practised"))?;
    Ok(Anybody::new(checkpoint, scenario.model, scenario.task))
}

fn text(file: &Path, fitted: &Fitted) -> String {
    let Fitted { participant, movements, pairs, traits, distance_before, distance_after, figures } = fitted;
    let mut rows = vec![row(["", "before", "found", "95 % interval"])];
    rows.extend(traits.iter().map(|one| {
        let [low, high] = one.interval;
        let (found, interval) = if one.is_told {
            (format!("{:.3}", one.found), format!("{low:.3} to {high:.3}"))
        } else {
            ("unknown".into(), format!("the recordings do not tell ({low:.3} to {high:.3})"))
        };
        row([one.key, &format!("{:.3}", one.before), &found, &interval])
    }));
    let mut compared = vec![row(["mean over pairs", "person", "user before", "user found"])];
    compared.extend(figures.iter().map(|figure| {
        let [person, before, after] = [figure.person, figure.before, figure.after].map(|value| format!("{value:.3}"));
        row([&figure.what, &person, &before, &after])
    }));
    let name = if participant.is_empty() { "the participant" } else { participant };
    format!(
        "{}: {name}, {movements} movements in {} pairs of distance and width\n{}\n{}\ndistance {distance_before:.1} before, {distance_after:.1} with the user found\n\n{}",
        file.display(),
        pairs.len(),
        table(&rows),
        table(&compared),
        lines(fitted)
    )
}

/// What a task file says of such a user.
fn lines(fitted: &Fitted) -> String {
    let told =
        fitted.traits.iter().filter(|one| one.is_told).filter_map(|one| Some((one.key.split_once('.')?, one.found)));
    let line = |((part, key), value): ((&str, &str), f64)| format!("{part}: {{{key}: {value:.4}}}\n");
    // Two of them are costs.
    let (costs, others): (Vec<_>, Vec<_>) = told.partition(|((part, _), _)| *part == "reward");
    let costs: Vec<String> = costs.iter().map(|((_, key), value)| format!("{key}: {value:.4}")).collect();
    let reward = if costs.is_empty() { String::new() } else { format!("reward: {{{}}}\n", costs.join(", ")) };
    let others: String = others.into_iter().map(line).collect();
    if others.is_empty() && reward.is_empty() {
        return "nothing of such a user is known\n".into();
    }
    format!("in a task file:\n{others}{reward}")
}
