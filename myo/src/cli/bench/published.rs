//! `myo bench published`: the experiments of the published system, done again.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use myo::published::{Aiming, FIGURE_STEPS, Made, Published, PublishedError, TrainedTo, at_widths};
use myo::recordings::Recordings;
use myo::tasks::User;
use myo::train::session::{Goal, Until, evaluation_seed};
use myo::train::{Checkpoint, PpoConfig, RunFolder, write_whole};
use myo::{Device, RunDescription, default_steps};

use super::machine::Machine;
use super::train::{Trained, train_once};
use crate::cli::backend::{BackendName, Options};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::measure;
use crate::cli::output::print;
use crate::cli::parse;
use crate::cli::run_folder::existing_checkpoint;
use crate::cli::scenario::Scenario;
use crate::cli::train::{Practising, Several, practise_until};

/// The body and the user of the published system.
const BODY: &str = "mobl-arms-uitb";
const USER: User = User::Fastest;
/// Its tasks, as presets.
const TASKS: [&str; 5] = ["pointing-replication", "pointing-uitb", "ar", "public-display", "mobile-typing"];
/// The one whose users are recorded.
const POINTING: &str = "pointing-uitb";
/// Share of successful episodes to which users of the tables learn.
const GOAL: f64 = 0.95;
/// Episodes of each user at each width.
const EPISODES: usize = 24;
const DATA: &str = "published.json";
const PAGE: &str = "published.md";

/// Arguments of `myo bench published`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct PublishedArgs {
    /// Where the page, its data and its figures are kept
    #[arg(long, value_name = "FOLDER", default_value = "published")]
    out: PathBuf,

    /// Make the tables or the figures alone; what is in the folder of the others stays
    #[arg(long, value_enum)]
    only: Option<Part>,

    /// Users of each task: seeds 1 to N
    #[arg(long, value_name = "N", default_value = "5", value_parser = parse::positive)]
    seeds: usize,

    /// Control steps that users of the figures learn; the published ones learnt 34.9M
    #[arg(long, value_name = "N", default_value_t = FIGURE_STEPS, value_parser = parse::count)]
    steps: u64,

    /// Users that stand beside them in the figures: a run, or a folder of several seeds; may be given several times
    #[arg(long, value_name = "RUN")]
    beside: Vec<PathBuf>,

    /// People who stand beside them: a table of recordings as `myo measure` takes it; may be given several times
    #[arg(long, value_name = "FILE")]
    people: Vec<PathBuf>,

    #[command(flatten)]
    physics: Options,
}

/// What is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Control steps and time until users of five tasks have learnt
    Tables,
    /// Fitts' law, positions and velocities of users who point
    Figures,
}

impl Part {
    const ALL: [Self; 2] = [Self::Tables, Self::Figures];

    const fn name(self) -> &'static str {
        match self {
            Self::Tables => "tables",
            Self::Figures => "figures",
        }
    }
}

const HELP: &str = "\
Examples:
  myo bench published
  myo bench published --only figures --beside runs/pointing-1 --people people.csv
  myo bench published --backend gpu --out docs/experiments

MyoInteract (arXiv 2602.15245) reports how long users learn its tasks, and Fitts' law, positions and velocities of users who point. This does the same with users of Myo on its body, as fast as
muscles allow. It writes a page (published.md), its figures (fitts.svg, positions-1.svg, velocities-1.svg, ...) and what was found as data (published.json); users of the figures are kept in `users` and are found again.
The page tells what is alike and what is not.";

/// Runs `myo bench published`.
pub fn run(args: &PublishedArgs) -> Result<()> {
    let interrupt = Interrupt::listen()?;
    std::fs::create_dir_all(&args.out)
        .map_err(|error| Failure::sentence(format!("cannot make the folder {}: {error}", args.out.display())))?;
    let mut found = read(&args.out.join(DATA))?;
    // Before anybody learns for nothing.
    let people = args.people.iter().map(|file| people(file)).collect::<Result<Vec<_>>>()?;
    let beside = args.beside.iter().map(|run| beside(run)).collect::<Result<Vec<_>>>()?;
    for part in Part::ALL.into_iter().filter(|part| args.only.is_none_or(|only| only == *part)) {
        let start = Instant::now();
        let device = match part {
            Part::Tables => {
                let (trainings, device) = trainings(args, &interrupt)?;
                found.trainings = trainings;
                device
            }
            Part::Figures => {
                let (own, device) = own_users(args, &interrupt)?;
                found.aiming = std::iter::once(own).chain(beside.clone()).chain(people.clone()).collect();
                device
            }
        };
        found.made.retain(|made| made.what != part.name());
        found.made.push(made(part, device, start.elapsed().as_secs_f64()));
        write(&args.out, &found)?;
    }
    print(&format!("{}: {PAGE}, {DATA} and {} figures\n", args.out.display(), found.plots().len()))
}

fn made(part: Part, device: String, wall_s: f64) -> Made {
    let Machine { machine, date, version } = Machine::here();
    // A folder may have a name that is no Unicode.
    let words: Vec<String> = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let words: Vec<&str> = std::iter::once("myo").chain(words.iter().map(String::as_str)).collect();
    let command = shlex::try_join(words).unwrap_or_default();
    Made { what: part.name().into(), command, machine, device, date, version: version.into(), wall_s }
}

/// What is in the folder already.
fn read(path: &Path) -> Result<Published> {
    match std::fs::read(path) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(Published::default()),
        Err(error) => Err(Failure::sentence(format!("cannot read {}: {error}", path.display()))),
        Ok(text) => serde_json::from_slice(&text).map_err(|error| {
            Failure::sentence(format!("{} is damaged: {error}; move it away, or choose another --out", path.display()))
        }),
    }
}

fn write(folder: &Path, found: &Published) -> Result<()> {
    for (stem, plot) in found.plots() {
        let svg = plot.svg().map_err(|error| Failure::sentence(error.to_string()))?;
        write_whole(&folder.join(format!("{stem}.svg")), svg.as_bytes())?;
    }
    let mut text = serde_json::to_vec_pretty(found)?;
    text.push(b'\n');
    write_whole(&folder.join(DATA), &text)?;
    Ok(write_whole(&folder.join(PAGE), found.page().as_bytes())?)
}

/// Users of all tasks, trained to their goal, and what computed it.
fn trainings(args: &PublishedArgs, interrupt: &Interrupt) -> Result<(Vec<TrainedTo>, String)> {
    let (mut all, mut device) = (vec![], String::new());
    let backend = args.physics.choice(BackendName::Auto)?;
    for name in TASKS {
        let scenario = Scenario::of_preset(name, USER, BODY)?;
        let goal = Goal { until: Until::Success(GOAL), steps: default_steps(scenario.task.control_dt_s) };
        for seed in 1..=args.seeds as u64 {
            complain(&format!("{name} with seed {seed} of {}", args.seeds));
            let config = PpoConfig::for_user(USER);
            let trained = train_once(&scenario, &config, &backend, (seed, goal), interrupt)?;
            device = told(&trained.device);
            all.push(result(name, seed, &trained));
        }
    }
    Ok((all, device))
}

fn told(device: &Device) -> String {
    device.card().map_or_else(threads, str::to_owned)
}

fn threads() -> String {
    format!("{} threads used", rayon::current_num_threads())
}

fn result(task: &str, seed: u64, trained: &Trained) -> TrainedTo {
    let Trained { outcome, wall_s, .. } = trained;
    TrainedTo {
        task: task.into(),
        body: BODY.into(),
        user: USER.name().into(),
        seed,
        goal: GOAL,
        reached: outcome.end == myo::train::session::End::Until,
        env_steps: outcome.env_steps,
        wall_s: *wall_s,
        success: outcome.evaluation.as_ref().and_then(|evaluation| evaluation.success),
    }
}

/// How users of the published task aim who learnt as long as the published ones, and what computed them.
fn own_users(args: &PublishedArgs, interrupt: &Interrupt) -> Result<(Aiming, String)> {
    let scenario = Scenario::of_preset(POINTING, USER, BODY)?;
    let practising = Practising {
        scenario: &scenario,
        config: PpoConfig::for_user(USER),
        users: (args.seeds, 1),
        steps: Some(args.steps),
        physics: &args.physics,
    };
    let folder = args.out.join("users");
    let users = practise_until(&practising, Until::Off, &folder, interrupt)?;
    let run = RunDescription::of(&RunFolder::open(&Several::run_folder_in(&folder, 1))?)?;
    let name = format!("{POINTING}, user {}, {:.1} M control steps", USER.name(), 1e-6 * args.steps as f64);
    let aiming = aiming(&name, &scenario, &users)?;
    Ok((aiming, run.device.unwrap_or_else(threads)))
}

/// Users of a run, or of several with different seeds.
fn beside(path: &Path) -> Result<Aiming> {
    let folders = match Several::open(path)? {
        Some(several) => several.run_folders(),
        None => vec![path.to_owned()],
    };
    let runs = folders.iter().map(|folder| Ok(RunFolder::open(folder)?)).collect::<Result<Vec<_>>>()?;
    let users = runs.iter().map(existing_checkpoint).collect::<Result<Vec<_>>>()?;
    let Some(first) = runs.first() else {
        return Err(Failure::sentence(format!("there is no user in {}", path.display())));
    };
    let description = RunDescription::of(first)?;
    let (task, user) = (description.task.name.clone(), description.task.user.name());
    aiming(&format!("{task}, user {user}"), &Scenario::of(&description)?, &users)
}

fn aiming(name: &str, scenario: &Scenario, users: &[Checkpoint]) -> Result<Aiming> {
    let layouts = at_widths(&scenario.task).map_err(sentence(name))?;
    let mut all = Recordings { participants: vec![] };
    for checkpoint in users {
        complain(&format!("recording {name}, seed {}", checkpoint.seed()));
        let asked = (EPISODES, evaluation_seed(checkpoint.seed(), 0));
        let user = format!("seed {}", checkpoint.seed());
        let recorded = Recordings::of_user(&user, &mut checkpoint.policy(), &scenario.model, &layouts, asked);
        all.append(recorded.map_err(PublishedError::from).map_err(sentence(name))?);
    }
    Aiming::of(name, &all).map_err(sentence(name))
}

fn people(file: &Path) -> Result<Aiming> {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    Aiming::of(&stem, &measure::read(file)?).map_err(|error| measure::of_file(file, &error))
}

fn sentence(what: &str) -> impl Fn(PublishedError) -> Failure + '_ {
    move |error| Failure::sentence(format!("{what}: {error}"))
}
