//! `myo fit`: which user moves as the people of recordings do.

use std::path::{Path, PathBuf};

use clap::Args;
use myo::fitting::{Anybody, Candidate, Fitted, FittedAmong, FittingError, MOST_TRAININGS, comparable, practice};
use myo::protocol::Practice;
use myo::recordings::Participant;
use myo::tasks::{Task, User};
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

    /// Look for how late the user sees, too, among these delays (`perception.vision_delay_ms`), such as 40,80,120; a user learns for each
    #[arg(long, value_name = "MS", value_delimiter = ',', value_parser = parse::number)]
    pub vision_delay_ms: Vec<f64>,

    /// Look for how tall the user is, too, among these statures (`body.height_m`), such as 1.55,1.75,1.95; a user learns for each
    #[arg(long, value_name = "M", value_delimiter = ',', value_parser = parse::number)]
    pub height_m: Vec<f64>,

    /// Folder of the trainings (`seed-1`, `seed-2` and so on) in which the user has learnt to be anybody; trained there first where there are none [default: runs/anybody-USER, and where several are looked among
    /// runs/anybody-USER-80ms-1.75m and so on]
    #[arg(long, value_name = "FOLDER")]
    pub practised: Option<PathBuf>,

    /// Trainings of each, with this seed and the next ones: what one does by chance and another does not is in the intervals of what is found, and with 1 in none
    #[arg(long, value_name = "N", default_value = "3", value_parser = parse::positive)]
    pub trainings: usize,

    /// Control steps after which each training stops in any case [default: as of `myo train`]
    #[arg(long, value_name = "N", value_parser = parse::count)]
    pub steps: Option<u64>,

    /// Seed of the first training, and of the simulations
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
  myo fit people.csv --vision-delay-ms 40,80,120        and how late each participant sees

Looks for the user who moves as a person does: for motor noise (noise.signal_dependent), how far off targets seem (perception.vision_noise), and
what effort and changes of control cost (reward.effort_cost, reward.control_change_cost). One user learns first to be anybody, once, in three trainings apart (--trainings): each takes some minutes on a graphics card, an hour and
more on two processor cores. Then each fit is simulation alone, of 150 users who do targets of the person's distances and widths across circles, and takes a minute or two.
Trainings differ in habits that no trait makes: figures in which they differ count for less, and intervals are as wide as a person's habits, taken for those of one more training, make them.

Recordings need three pairs of distance (6 to 40 cm) and width (1.2 to 12 cm) with eight movements each; distances and widths that differ by less
than a tenth are alike. What is compared are means over pairs: movement times, their growth with difficulty and their scatter, peak speed and its time, smoothness, straightness, and where the first
bell of speed ends, and the activation of each muscle that was recorded (columns such as DELT1_activation, 0 to 1). What the recordings do not tell is said to be unknown; its value is not to be used. Body, delays and senses are as told, and targets lie half a metre before the shoulder.

With --vision-delay-ms and --height-m a user of each delay and each stature learns to be anybody, each becomes as near to the person as it can, and the nearest is told, with those that
the recordings do not rule out (95 of 100; where nobody comes as near as chance lets, so much more has to lie between two users).

The answer has lines for the task file of a simulated participant. Distance: root mean square over figures of the difference between user and person, in
standard deviations of that figure between users of the same traits, of all trainings; 1 is as near as one such user is to another.

JSON: a list of objects with `file`, `participant`, `movements`, `pairs` (distance and width in m), `traits` (`key`, `what`, `before`, `found`, `interval`, `is_told`), `distance_before` (null where the user before could not do what the person did),
`distance_after`, `trainings`, `figures` (`what`, `person`, `before`, `after`) of the nearest user, and `candidates`, the nearest first (`vision_delay_ms` and `height_m`, null as told; `distance`, null of who cannot do what the person did; `is_possible`).";

/// Runs `myo fit`.
pub fn run(args: &Fit) -> Result<()> {
    let people = args.files.iter().map(|file| Ok((file, people(file, args.together)?))).collect::<Result<Vec<_>>>()?;
    let candidates = candidates(&args.anybody)?;
    let (beginner, _) = beginner(&args.anybody.user, candidates[0])?;
    for (file, people) in &people {
        for person in people {
            // Before an hour of training.
            comparable(person, &beginner.model).map_err(|error| of_file(file, &error))?;
        }
    }
    let users = anybodies(&args.anybody, (args.anybody.trainings, args.anybody.seed), &Interrupt::listen()?)?;
    let mut found = vec![];
    for (file, people) in &people {
        for person in people {
            complain(&format!("{}: simulating users like {}", file.display(), person.name));
            let fitted = FittedAmong::of(&users, person, args.anybody.seed, &|| true)?;
            found.extend(fitted.map(|fitted| (file, fitted)));
        }
    }
    if args.json {
        let object = |(file, fitted): &(&&PathBuf, FittedAmong)| {
            let mut value = serde_json::to_value(fitted)?;
            value["file"] = json!(file.display().to_string());
            Ok(value)
        };
        return print_json(&found.iter().map(object).collect::<Result<Vec<_>>>()?);
    }
    let text = |(file, fitted): &(&&PathBuf, FittedAmong)| text(file, fitted);
    print(&found.iter().map(text).collect::<Vec<_>>().join("\n"))
}

/// The people of a file, or all of them as one.
fn people(file: &Path, together: bool) -> Result<Vec<Participant>> {
    let recordings = read(file)?;
    Ok(if together { recordings.as_one() } else { recordings }.participants)
}

/// Among whom is looked.
fn candidates(args: &AnybodyArgs) -> Result<Vec<Candidate>> {
    let (told, _) = beginner(&args.user, Candidate::default())?;
    Ok(Candidate::all(&args.vision_delay_ms, &args.height_m, told.task.control_dt_s)?)
}

/// The user who is to become somebody else, and what it is called.
fn beginner(user: &str, candidate: Candidate) -> Result<(Scenario, String)> {
    let change = |task: &mut Task| candidate.change(task);
    let named = User::ALL.into_iter().find(|known| known.name() == user);
    match named {
        Some(user) if !user.is_human() => Err(Failure::sentence(format!(
            "--user {user}: it has no noise and no misjudgement that could be like a person's; take `human`, or another of `myo task users`",
            user = user.name()
        ))),
        Some(user) => Ok((Scenario::open_with(TASK, Some(user), change)?, user.name().into())),
        None => {
            let scenario = Scenario::open_with(user, None, change)?;
            let name = scenario.task.name.clone();
            Ok((scenario, name))
        }
    }
}

/// The users who can be anybody, one for each delay and stature that is looked among; in so many trainings, the first with this seed, they learn to be so where they are not there yet.
pub fn anybodies(
    args: &AnybodyArgs,
    (trainings, seed): (usize, u64),
    interrupt: &Interrupt,
) -> Result<Vec<(Candidate, Anybody)>> {
    if trainings > MOST_TRAININGS {
        return Err(FittingError::TooMany { count: trainings }.into());
    }
    let candidates = candidates(args)?;
    // All of them are possible before the first one learns.
    let beginners = candidates.into_iter().map(|candidate| Ok((candidate, beginner(&args.user, candidate)?)));
    let beginners = beginners.collect::<Result<Vec<_>>>()?;
    let learnt = |(candidate, (scenario, name)): (Candidate, (Scenario, String))| {
        let folder = args.practised.clone().unwrap_or_else(|| Path::new("runs").join(format!("anybody-{name}")));
        let own = match folder.file_name() {
            Some(name) => {
                let mut name = name.to_os_string();
                name.push(candidate.suffix());
                folder.with_file_name(name)
            }
            None => folder,
        };
        Ok((candidate, anybody(args, (trainings, seed), scenario, &own, interrupt)?))
    };
    beginners.into_iter().map(learnt).collect()
}

/// The user who can be anybody with a body; it learns to be so where it is not there yet.
fn anybody(
    args: &AnybodyArgs,
    users: (usize, u64),
    scenario: Scenario,
    folder: &Path,
    interrupt: &Interrupt,
) -> Result<Anybody> {
    let AnybodyArgs { steps, physics, .. } = args;
    let layouts = practice(&scenario.task).map_err(|error| Failure::sentence(error.to_string()))?;
    let task = layouts[0].clone();
    let (model, own_model) = (scenario.model.clone(), scenario.own_model.clone());
    let config = Practice::Pointing.learning(&PpoConfig::for_user(task.user));
    let practised = Scenario { task, layouts, model, own_model, most_success: 1.0 };
    let practising = Practising { scenario: &practised, config, users, steps: *steps, physics };
    let checkpoints = practise(&practising, folder, interrupt)?;
    Ok(Anybody::new(checkpoints, scenario.model, scenario.task)?)
}

fn text(file: &Path, found: &FittedAmong) -> String {
    let Fitted { participant, movements, pairs, traits, distance_before, distance_after, trainings, figures, .. } =
        &found.fitted;
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
        let [person, after] = [figure.person, figure.after].map(|value| format!("{value:.3}"));
        let before = figure.before.map_or_else(|| "-".into(), |value| format!("{value:.3}"));
        row([&figure.what, &person, &before, &after])
    }));
    let habits = if *trainings > 1 {
        ""
    } else {
        "of one training alone: how far another one's habits would lead is in no interval (`--trainings 3`)\n"
    };
    let name = if participant.is_empty() { "the participant" } else { participant };
    format!(
        "{}: {name}, {movements} movements in {} pairs of distance and width\n{}{}\n{}\ndistance {} before, {distance_after:.1} with the user found\n{habits}\n{}",
        file.display(),
        pairs.len(),
        among(found),
        table(&rows),
        table(&compared),
        distance_before.map_or_else(
            || "unknown (it could not do what the person did)".into(),
            |distance| format!("{distance:.1}")
        ),
        lines(found)
    )
}

/// All among whom was looked, where there are several.
fn among(found: &FittedAmong) -> String {
    if found.candidates.len() < 2 {
        return String::new();
    }
    let value =
        |value: Option<f64>, unit: &str| value.map_or_else(|| "as told".into(), |value| format!("{value} {unit}"));
    let mut rows = vec![row(["sees late by", "stature", "distance", ""])];
    rows.extend(found.candidates.iter().enumerate().map(|(place, one)| {
        let words = match (place, one.is_possible) {
            (0, _) => "nearest",
            (_, true) => "not ruled out",
            (_, false) if one.distance.is_none() => "cannot do what the person did",
            (_, false) => "ruled out",
        };
        let distance = one.distance.map_or_else(|| "-".into(), |distance| format!("{distance:.2}"));
        let Candidate { vision_delay_ms, height_m } = one.candidate;
        row([&value(vision_delay_ms, "ms"), &value(height_m, "m"), &distance, words])
    }));
    format!("{}\n", table(&rows))
}

/// What a task file says of such a user.
fn lines(found: &FittedAmong) -> String {
    // Of whom the traits are.
    let Candidate { vision_delay_ms, height_m } =
        found.candidates.first().map_or_else(Candidate::default, |nearest| nearest.candidate);
    let of_body = height_m.map(|height| ("body", "height_m", height));
    let of_eyes = vision_delay_ms.map(|delay| ("perception", "vision_delay_ms", delay));
    let traits = found.fitted.traits.iter().filter(|one| one.is_told);
    let traits = traits.filter_map(|one| one.key.split_once('.').map(|(part, key)| (part, key, one.found)));
    let all: Vec<(&str, &str, f64)> = of_body.into_iter().chain(of_eyes).chain(traits).collect();
    let mut parts: Vec<&str> = all.iter().map(|&(part, ..)| part).collect();
    parts.sort_unstable();
    parts.dedup();
    if parts.is_empty() {
        return "nothing of such a user is known\n".into();
    }
    let line = |part: &str| {
        let own = all.iter().filter(|one| one.0 == part).map(|(_, key, value)| format!("{key}: {}", rounded(*value)));
        format!("{part}: {{{}}}\n", own.collect::<Vec<_>>().join(", "))
    };
    let mut all: String = parts.into_iter().map(line).collect();
    for (key, value, told) in [
        ("vision_delay_ms", vision_delay_ms, found.told(|one| one.vision_delay_ms)),
        ("height_m", height_m, found.told(|one| one.height_m)),
    ] {
        if value.is_some() && told.is_none() {
            all += &format!(
                "of `{key}` the recordings do not tell: it is that of the user to whom the other traits belong\n"
            );
        }
    }
    format!("in a task file:\n{all}")
}

/// Four digits behind the point, and none that say nothing.
fn rounded(value: f64) -> f64 {
    (1e4 * value).round() / 1e4
}
