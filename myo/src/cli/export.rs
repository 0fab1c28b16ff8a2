//! `myo export`: what a user does, physics step by physics step, as a table.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use myo::train::Checkpoint;
use myo::train::session::evaluation_seed;
use myo::{Column, RunDescription, Trajectories, TrajectoryError, Values, trajectories};

use super::eval::chosen_checkpoint;
use super::failure::{Failure, Result};
use super::interrupt::Interrupt;
use super::output::print;
use super::parse;
use super::scenario::Scenario;
use super::train::open_run;

/// Arguments of `myo export`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Export {
    /// Run folders, each of a user
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,

    /// Episodes of each layout
    #[arg(long, value_name = "N", default_value = "20", value_parser = parse::positive)]
    episodes: usize,

    /// Seed of the episodes [default: that of `myo eval`]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,

    /// Checkpoint: a file, or the control steps in the name of one in the run folder [default: the newest]
    #[arg(long, value_name = "FILE|STEPS")]
    checkpoint: Option<String>,

    /// File to write; `-` is the standard output [default: RUN.csv, named after the first run]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,

    /// Replace the file where there is one
    #[arg(long)]
    force: bool,
}

const HELP: &str = "\
Examples:
  myo export runs/pointing-1                     pointing-1.csv: 20 episodes, every 2 ms
  myo export runs/pointing-1 --episodes 200 --out trajectories.csv
  myo export runs/phone-1 --out - | gzip > phone.csv.gz
  myo export runs/phone/seed-1 runs/phone/seed-2 --out phone.csv     two users in one table

Writes what the user does in fresh episodes, acting without exploring and with the noise of the task: a row for each physics step (2 ms), values separated by
commas, with a head line. A cell without a value is empty. Places are in m from the centre of the shoulder: x forward, y to the left, z up.

  participant                  the user: the name of its run folder
  episode                      from one; of several layouts, each has its own
  layout                       its name, where there are several
  time_s                       since the start of the episode, at the end of the physics step
  step, object                 what is to do: number of the step in the script, name of the object it asks for
  object_x_m, _y_m, _z_m       where that is; object_width_m how wide, of a sphere its diameter
  fingertip_x_m, _y_m, _z_m    the fingertip; pointer_x_m, ... what points, where that is something else
  force_n                      sum of all forces on the fingertip
  event                        entered: the last entry into what was asked for; done: the step was done; given_up: it took too long (step_limit_s); success or time_out: the end of the episode
  JOINT_rad, JOINT_rad_s       position and velocity of each independent joint
  MUSCLE_activation, _force_n  of each muscle, from 0 to 1, and the force with which it pulls
  JOINT_torque_nm              torque of all muscles on each independent joint (N m; of slides JOINT_force_n)
  mechanical_w, metabolic_w    power with which all muscles pull, and what they consume (Bhargava et al. 2004; more than at rest)

`myo measure` takes such tables, beside recordings of people. In Python the same is `myoenv.trajectories(run)`, columns that pandas and polars take as they are.";

/// Runs `myo export`.
pub fn run(args: &Export) -> Result<()> {
    let users = args.runs.iter().map(|run| Exported::open(run, args)).collect::<Result<Vec<_>>>()?;
    let users = told_apart(users)?;
    let mut export = Exporting::open(args)?;
    let interrupt = Interrupt::listen()?;
    for Exported { name, scenario, checkpoint, .. } in users {
        let seed = args.seed.unwrap_or_else(|| evaluation_seed(checkpoint.seed(), 0));
        let (mut policy, layouts) = (checkpoint.policy(), &scenario.layouts);
        trajectories(&mut policy, &scenario.model, layouts, (args.episodes, seed), |some| {
            export.add(&name, some)?;
            Ok::<bool, Failure>(!interrupt.wanted())
        })?;
        if interrupt.wanted() {
            return Err(Failure::Interrupted);
        }
    }
    export.finish()
}

/// A user whose movements are written.
struct Exported {
    name: String,
    path: String,
    scenario: Scenario,
    checkpoint: Checkpoint,
}

impl Exported {
    fn open(run: &Path, args: &Export) -> Result<Self> {
        let folder = open_run(run)?;
        Ok(Self {
            name: run.file_name().map_or_else(|| run.display().to_string(), |name| name.to_string_lossy().into_owned()),
            path: run.display().to_string(),
            scenario: Scenario::of(&RunDescription::of(&folder)?)?,
            checkpoint: chosen_checkpoint(&folder, args.checkpoint.as_deref())?,
        })
    }
}

/// Names as short as tell users apart.
fn told_apart(mut users: Vec<Exported>) -> Result<Vec<Exported>> {
    let short: Vec<String> = users.iter().map(|user| user.name.clone()).collect();
    for user in &mut users {
        if short.iter().filter(|name| **name == user.name).count() > 1 {
            user.name.clone_from(&user.path);
        }
    }
    let twice = (1..users.len()).find(|&k| users[..k].iter().any(|earlier| earlier.name == users[k].name));
    match twice {
        Some(k) => Err(Failure::sentence(format!("{} is named twice", users[k].name))),
        None => Ok(users),
    }
}

/// The first column that is not in the same place in both heads.
fn differing<'a>(head: &'a [String], other: &'a [String]) -> Option<&'a String> {
    let apart = head.iter().zip(other).find(|(a, b)| a != b).map(|(a, _)| a);
    apart.or_else(|| head.get(other.len())).or_else(|| other.get(head.len()))
}

/// What a writer says; a reader who has gone is no failure.
fn written(done: std::io::Result<()>) -> Result<()> {
    done.map_err(|error| match error.kind() {
        std::io::ErrorKind::BrokenPipe => Failure::OutputClosed,
        _ => TrajectoryError::from(error).into(),
    })
}

/// A table on its way into a file, which is there whole or not at all.
struct Exporting {
    out: Box<dyn Write>,
    /// The file, and what it is called until it is whole; none for the standard output.
    paths: Option<(PathBuf, PathBuf)>,
    rows: usize,
    /// Names of the columns.
    head: Vec<String>,
}

impl Exporting {
    fn open(args: &Export) -> Result<Self> {
        let path = args.out.clone().unwrap_or_else(|| default_path(&args.runs[0]));
        if path == Path::new("-") {
            return Ok(Self { out: Box::new(BufWriter::new(std::io::stdout())), paths: None, rows: 0, head: vec![] });
        }
        if path.exists() && !args.force {
            let path = path.display();
            return Err(Failure::sentence(format!("{path} is there already; name another with --out, or add --force")));
        }
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".part");
        let part = path.with_file_name(name);
        let file = File::create(&part)
            .map_err(|error| Failure::sentence(format!("cannot write {}: {error}", part.display())))?;
        Ok(Self { out: Box::new(BufWriter::new(file)), paths: Some((path, part)), rows: 0, head: vec![] })
    }

    fn add(&mut self, who: &str, mut some: Trajectories) -> Result<()> {
        let participant = Values::Text(vec![who.to_owned(); some.rows()]);
        some.columns.insert(0, Column { name: "participant".into(), values: participant });
        let head: Vec<String> = some.columns.iter().map(|column| column.name.clone()).collect();
        if self.rows == 0 {
            written(some.write_head(&mut self.out))?;
            self.head = head;
        } else if let Some(name) = differing(&head, &self.head) {
            return Err(Failure::sentence(format!(
                "{who} cannot stand in one table with the runs before it: the column {name} is not in the same place in both; export it into a file of its own"
            )));
        }
        self.rows += some.rows();
        written(some.write_rows(&mut self.out))
    }

    fn finish(mut self) -> Result<()> {
        written(self.out.flush())?;
        let Some((path, part)) = &self.paths else { return Ok(()) };
        std::fs::rename(part, path)
            .map_err(|error| Failure::sentence(format!("cannot write {}: {error}", path.display())))?;
        let (path, _) = self.paths.take().unwrap_or_default();
        print(&format!("{} rows are in {}\n", self.rows, path.display()))
    }
}

impl Drop for Exporting {
    /// Nothing half-written stays.
    fn drop(&mut self) {
        if let Some((_, part)) = &self.paths {
            let _ = std::fs::remove_file(part);
        }
    }
}

/// A file of this folder that is called like the run.
fn default_path(run: &Path) -> PathBuf {
    let name = run.file_name().map_or_else(|| "trajectories".into(), |name| name.to_string_lossy().into_owned());
    PathBuf::from(format!("{name}.csv"))
}
