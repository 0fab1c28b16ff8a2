//! `myo eval`: how well a trained policy does.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use myo::train::gpu::DeviceEvaluator;
use myo::train::session::{Trend, evaluation_seed};
use myo::train::{Checkpoint, RunFolder, evaluate};
use myo::{Envs, RunDescription, layout_names, misfits};
use serde::Serialize;
use serde_json::Value;

use super::backend::{BackendName, Options, sentence};
use super::failure::{Failure, Result};
use super::interrupt::Interrupt;
use super::output::{argument, command, name, print, print_json, rounded};
use super::protocol::{self, People, Protocol};
use super::run_folder::existing_checkpoint;
use super::scenario::Scenario;
use super::train::open_run;
use super::{parse, report};

/// Most environments that run side by side.
const ENVS: usize = 1024;

/// Arguments of `myo eval`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Eval {
    /// Run folder
    run: PathBuf,

    /// Another layout to try the user on as it is, without training: a task by its name or file, for the same body and technique,
    /// in which the same is perceived
    #[arg(long, value_name = "TASK")]
    task: Option<String>,

    /// Checkpoint to evaluate: a file, or the control steps in the name of one in the run folder [default: the newest]
    #[arg(long, value_name = "FILE|STEPS")]
    checkpoint: Option<String>,

    /// Fresh episodes, of each layout
    #[arg(long, value_name = "N", default_value = "1000", value_parser = parse::count)]
    episodes: u64,

    /// Seed of the episodes [default: one made from that of the training, never the same]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Ask what people were asked, in place of the task
    #[arg(long, value_name = "NAME", conflicts_with_all = ["task", "checkpoint", "seed", "episodes"])]
    protocol: Option<Protocol>,

    /// Users who are asked: the one of the run and others who differ in nothing but their seed [default: 3]
    #[arg(long, value_name = "N", value_parser = parse::positive, requires = "protocol")]
    seeds: Option<usize>,

    /// Control steps after which they stop to practise what the protocol asks, in any case [default: 200M at 20 Hz, 10 million simulated seconds]
    #[arg(long, value_name = "N", value_parser = parse::count, requires = "protocol")]
    steps: Option<u64>,

    /// Recordings of people, as `myo measure` takes them, beside the answers of F1 and K1; may be given several times
    #[arg(long, value_name = "FILE", requires = "protocol")]
    people: Vec<PathBuf>,

    #[command(flatten)]
    physics: Options,

    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo eval runs/pointing-1
  myo eval runs/pointing-1 --episodes 10000 --seed 3 --json
  myo eval runs/phone-1 --task other-phone.yaml             how would this user do on another layout?
  myo eval runs/pointing-1 --checkpoint 1638400
  myo eval runs/pointing-1 --protocol F1 --people ours.csv  Fitts' law of the user beside that of our participants
  myo eval runs/pointing-1 --protocol M1                    is the body of this user as strong as people?

Evaluates the deterministic policy of the newest checkpoint, or of the one before it if that file is damaged.

With --task the user does a layout that it was not trained on, with what it learned elsewhere. There may be other objects in other places,
more steps and of other kinds. It is done by the user of the run with its body, where the file does not say `body`. Model, hand, technique, control step and what is perceived must be those of the training, else all that
differs is named: `pointer_position` is perceived only where the technique is not the fingertip, `target_velocity` where something
moves, `cue` where a step must be waited for, `drag` where there is a slider to drag or a stick to swing, `drive` where something is driven, `fingers` where other fingers are asked for. The result says that the user was not trained there.
A user of several layouts (`myo train --together`) does each of them; the table has them and their mean.

Movement time is from the start of a target (the end of the one before, or the reset) to the last entry into it or the touch of
a button: without dwell, to one physics step. With dwell it is the time to the end of the target.

With --protocol the user is asked what people were asked in studies, and the answers stand beside theirs. It practises first what is asked, as its
task was learnt, and so do others with other seeds; they are kept in the folder `protocols` of the run. F1 is Fitts' law, K1 speeds and shapes of movements, K2 where
movements end before they are corrected, K3 how still the arm is held, K4 how much slower a hand is where its way is more curved, K5 what muscles do, C1 how much longer it takes to react where there are more to choose from, S1 how long ways take that must not be left, S2 how well a wandering target is tracked, I1 how long pointing with a ray takes, I2 reaching far with a hand that grows, T1 presses of keys, T3 words per minute, E2 what ten minutes of
selecting in the air cost at the height of the shoulder and of the waist. M1, A1, E1 and E3 ask the body alone: M1 isometric strength of elbow, shoulder and forearm, the share of it that holds the
straight arm up, moment arms at the elbow, and muscles that change sides; A1 whether it becomes the bodies of small and large people; E1 how long muscles hold a load, E3 how they recover. `bands` does all but A1, C1, E3, I1, I2, K4, S1, S2 and T3 and tells which figures are like people's. JSON: of F1 `conditions` and `fitts` (`r2`, `slope_s_per_bit`, `intercept_s`, `throughput_bit_s`, each also with `_interval`, the 95 %
confidence interval of the mean over users), of K1 `rows` (`figure`, `what`, `unit`, `median`, `interval`), of K2 `rows`, `elongation`, `growth_along`, `direction_deg`, of K3 and K5 `rows`, of K4 `laps_per_s`, `exponent`, `r2` (each with `median` and `interval`) and `finished`, of C1 `rows` (`choices`, `bits`, `response_s`, `missed`), `slope_s_per_bit`, `intercept_s`, of S1 `rows` (`shape`, `width_m`, `index`,
`time_s`, `time_s_interval`, `left`) and `steering` (`shape`, `r2`, `slope_s`, `intercept_s`, each also with `_interval`), of S2 `rows` (`up_to_hz`, `target_speed_m_s`, `rms_error_m`, `mean_error_m`, `inside`, `lag_s`, `gain`), of I1 `rows` (`distance_deg`, `width_deg`, `time_s`, `missed`) and `law` (`pairs`, `r2`, `slope_s_per_bit`, `intercept_s`, `exponent`, `r2_of_exponent`), of I2 `rows` (`distance_m`, `time_s`, `hand_speed_m_s`, `pointer_speed_m_s`, `missed`), of T1
`peak_force_n`, `contact_time_s`, `impulse_n_s`, `interval_s`, `rate_hz`, of T3 `rows` (`key_m`, `words_per_min`, `letter_s`, `wrong_per_100`, `unfinished`); of M1 `model`, `strength`, `holding`, `moment_arms`, `sign_changes`; of A1 `model`, `rows` (`user`, `height_m`, `mass_kg`, `reach_m`, `reach_of_height`, `people_reach_of_height`,
`arm_kg`, `arm_of_mass`, `people_arm_of_mass`, `strength_of_man`, `holding_share`), `woman_of_man`; of E1 `rows` (`joint`, `load`, `time_s`, `people_s`,
`of_people`), of E2 `rows` (`height`, `fatigued`, `of_strength`, `consumed_endurance`, `consumed_nicer`, `upper_arm`, `metabolic_w`, `torque_nm`, `torque_change_nm_s`, `activation`, `selections_per_min`), of E3 `rows` (`joint`, `after_work`, `after_rest`,
`without_rest_factor`); of all that ask a user `users`. Of `bands`
`users`, `bands`, a list with `number`, `what`, `verdict` (`passed`, `failed`, `not_measured`, `reported`) and `findings` (`figure`, `lower`, `upper`,
`value`, `verdict`, `judged`, `confidence`), and the answers under their names.

JSON: `success` (share of episodes with every target done), `episodes`, `targets`, a list with `success`, `movement_time_s`
and `time_s` (with dwell) each, `final_distance_m`, `effort`, `fatigue` (share of the strength of all muscles that fatigues in an episode), `episode_length_s`, `return`; each of these but `episodes` also
with `_interval` behind its name, a list of the two ends of its 95 % confidence interval (Wilson's for shares, Student's for
means), and times of targets with `_sd` (standard deviation); and `run`, `user` (who it is, with its body), `task`, `trained_task`, `trained_layouts` (names, one or more), `env_steps` (control steps that the policy was
trained for), `trend` (what the last doubling of them brought and more would, as `myo train --json` tells), `seed`, `backend` (`cpu` or `gpu`) and
`device` (its name); `trained_here`, whether the user was trained on this layout; and with several layouts `layouts`, a list of the same
quantities of each, with its name as `task`; all else is over as many episodes of each then. Values that do not exist are null. Backends agree up to rounding, not bit for bit.";

/// What `--json` prints.
#[derive(Serialize)]
struct Results<'a> {
    #[serde(flatten)]
    evaluation: Value,
    run: String,
    user: String,
    task: &'a str,
    trained_task: &'a str,
    trained_layouts: Vec<String>,
    trained_here: bool,
    env_steps: u64,
    trend: Option<Trend>,
    seed: u64,
    backend: &'a str,
    device: Option<&'a str>,
}

/// People who stand beside an answer, before anybody practises for it.
fn people_beside(protocol: Protocol, files: &[PathBuf]) -> Result<Vec<People>> {
    if !files.is_empty() && ![Protocol::F1, Protocol::K1].contains(&protocol) {
        return Err(Failure::sentence("--people stands beside the answers of F1 and K1 alone; leave it out"));
    }
    People::of(files)
}

/// Runs `myo eval`.
pub fn run(args: &Eval) -> Result<()> {
    let folder = open_run(&args.run)?;
    let trained = RunDescription::of(&folder)?;
    if let Some(protocol) = args.protocol {
        let asked = protocol::Asked {
            folder: &args.run,
            scenario: Scenario::of(&trained)?,
            config: folder.config().ppo.clone(),
            users: (args.seeds.unwrap_or(protocol::USERS), folder.config().seed),
            steps: args.steps,
            physics: &args.physics,
            people: people_beside(protocol, &args.people)?,
        };
        return protocol::run(protocol, &asked, args.json);
    }
    let scenario = match &args.task {
        Some(task) => elsewhere(&args.run, &trained, task)?,
        None => Scenario::of(&trained)?,
    };
    let trained_here = trained.layouts().contains(&scenario.task);
    let checkpoint = chosen_checkpoint(&folder, args.checkpoint.as_deref())?;
    let interrupt = Interrupt::listen()?;
    let seed = args.seed.unwrap_or_else(|| evaluation_seed(checkpoint.seed(), 0));
    let episodes = usize::try_from(args.episodes)?;
    let layouts = scenario.layouts.len();
    let num_envs = episodes.saturating_mul(layouts).min(ENVS).max(layouts);
    let env = scenario.env(&args.physics.choice(BackendName::Auto)?, num_envs, seed)?;
    let mut policy = checkpoint.policy();
    let (device, bar) = (env.device(), bar(args.episodes.saturating_mul(layouts as u64)));
    let progress = |counted: usize| {
        bar.set_position(counted as u64);
        !interrupt.wanted()
    };
    let evaluation = match env {
        Envs::Cpu(mut env) => evaluate(&mut policy, env.as_mut(), episodes, seed, progress)?,
        Envs::Gpu(env) => DeviceEvaluator::new(*env, &policy)?.evaluate(&policy, episodes, seed, progress)?,
    };
    bar.finish_and_clear();
    // Episodes that ended before an interrupt are too often short ones.
    if interrupt.wanted() {
        return Err(Failure::Interrupted);
    }
    let (task, trained_task) = (&scenario.task.name, &trained.task.name);
    if args.json {
        let (run, env_steps, trend) = (args.run.display().to_string(), checkpoint.env_steps(), checkpoint.trend());
        let (backend, device) = (device.backend(), device.card());
        let evaluation = report::json(&scenario.layouts, &evaluation)?;
        return print_json(&Results {
            evaluation,
            run,
            user: scenario.task.who(),
            task,
            trained_task,
            trained_layouts: layout_names(&trained.layouts()),
            trained_here,
            env_steps,
            trend,
            seed,
            backend,
            device,
        });
    }
    let steps = rounded(checkpoint.env_steps() as f64);
    let title = Scenario::of(&trained)?.title();
    let (warning, elsewhere) = match trained_here {
        true => (String::new(), String::new()),
        false => (
            format!("This user was not trained on {}: it acts there with what it learned on {title}.\n\n", name(task)),
            format!(" on {title}, none on {}", name(task)),
        ),
    };
    print(&format!(
        "{warning}{}{}  user            {}\n  trained         {steps} control steps{elsewhere}\n  evaluated       on {}\n",
        report::evaluation(&scenario.layouts, &evaluation),
        report::practice(checkpoint.trend()),
        scenario.task.who(),
        sentence(&device)
    ))
}

/// The checkpoint that is asked for, or the newest.
pub fn chosen_checkpoint(run: &RunFolder, which: Option<&str>) -> Result<Checkpoint> {
    which.map_or_else(|| existing_checkpoint(run), |which| checkpoint(run, which))
}

/// The checkpoint in a file, or of so many control steps in the run folder.
fn checkpoint(run: &RunFolder, which: &str) -> Result<Checkpoint> {
    let file = Path::new(which);
    let path = match which.parse().or_else(|_| parse::count(which)) {
        Ok(steps) if !file.exists() => checkpoint_of(run, steps)?,
        _ => file.to_owned(),
    };
    Checkpoint::read(&path)
        .map_err(|error| Failure::sentence(format!("cannot use the checkpoint {}: {error}", path.display())))
}

fn checkpoint_of(run: &RunFolder, steps: u64) -> Result<PathBuf> {
    let steps_of = |path: &Path| path.file_stem()?.to_str()?.strip_prefix("step_")?.parse::<u64>().ok();
    let files = run.checkpoints()?;
    if let Some(file) = files.iter().find(|path| steps_of(path) == Some(steps)) {
        return Ok(file.clone());
    }
    let there: Vec<String> =
        files.iter().rev().filter_map(|path| steps_of(path).map(|steps| steps.to_string())).collect();
    let there =
        if there.is_empty() { "it has none yet".into() } else { format!("it has those of {}", there.join(", ")) };
    Err(Failure::sentence(format!("{} has no checkpoint of {steps} control steps; {there}", run.path().display())))
}

/// Another layout for the user of a run; refused where the user cannot act there, with all that differs.
fn elsewhere(run: &Path, trained: &RunDescription, task: &str) -> Result<Scenario> {
    let (own, scenario) = (Scenario::of(trained)?, Scenario::open_as(task, &trained.task)?);
    let misfits = misfits(own.setting(), scenario.setting())?;
    if misfits.is_empty() {
        return Ok(scenario);
    }
    let reasons: Vec<String> = misfits.iter().map(ToString::to_string).collect();
    let next = command(&["train", task, "--from", &argument(run)]);
    Err(Failure::sentence(format!(
        "the user of {} cannot do {}: {}. To train one that can, beginning with what this one knows: {next}",
        run.display(),
        name(&scenario.task.name),
        reasons.join("; ")
    )))
}

fn bar(episodes: u64) -> ProgressBar {
    let target =
        if std::io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let style = ProgressStyle::with_template("{bar:20} {pos} of {len} episodes, {eta} left");
    ProgressBar::with_draw_target(Some(episodes), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
