//! `myo train --seeds N`: the same training with several seeds, since one may be lucky.
//!
//! ```text
//! folder/
//!   plan.json     what is trained, and with which seeds
//!   from.ckpt     what a warm start starts from
//!   seed-1/       a run folder, ...
//!   seeds.json    results of those that are over
//! ```

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use myo::train::session::{End, Goal, Outcome, Trend};
use myo::train::statistics::Sample;
use myo::train::{Checkpoint, Evaluation, PpoConfig, RunClaim, RunError, RunFolder, write_whole};
use myo::{RunDescription, TrainedUser};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{Ready, loss};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::interrupt::Interrupt;
use crate::cli::output::{argument, command, duration, name, percent, print, print_json, rounded, row, table};

const PLAN: &str = "plan.json";
const FROM: &str = "from.ckpt";
const RESULTS: &str = "seeds.json";

/// The layout of the folder that this program knows.
const FORMAT: u32 = 1;

/// So many seeds from the first on.
pub fn seeds(first: u64, count: u64) -> Result<RangeInclusive<u64>> {
    let more = count.saturating_sub(1);
    first.checked_add(more).map(|last| first..=last).ok_or_else(|| {
        Failure::sentence(format!(
            "--seed {first} leaves no room for {count} seeds; it can be at most {}",
            u64::MAX - more
        ))
    })
}

/// The run in a folder. One that holds several runs is refused with a hint.
pub fn open_run(path: &Path) -> Result<RunFolder> {
    RunFolder::open(path).map_err(|error| match (error, Several::open(path)) {
        (RunError::NotARun { .. }, Ok(Some(several))) => {
            let run = several.run_folder(several.plan.first_seed);
            Failure::sentence(format!(
                "{} holds the runs of several seeds; name one of them, such as {}",
                path.display(),
                run.display()
            ))
        }
        (error, _) => error.into(),
    })
}

/// What is trained.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    format: u32,
    /// The first seed.
    pub first_seed: u64,
    /// The last one.
    pub last_seed: u64,
    /// What the runs have in common.
    pub run: RunDescription,
    /// Settings of the learner.
    #[serde(deserialize_with = "myo::train::saved_settings")]
    pub ppo: PpoConfig,
}

impl Plan {
    /// A training with each of these seeds.
    pub fn new(seeds: RangeInclusive<u64>, run: RunDescription, ppo: PpoConfig) -> Self {
        Self { format: FORMAT, first_seed: *seeds.start(), last_seed: *seeds.end(), run, ppo }
    }

    fn check(self) -> std::result::Result<Self, String> {
        if self.format != FORMAT {
            return Err(format!("format is {}; this program knows format {FORMAT}", self.format));
        }
        if self.first_seed > self.last_seed {
            return Err(format!("first_seed is {}, last_seed {}", self.first_seed, self.last_seed));
        }
        self.ppo.validate().map(|()| self).map_err(|error| error.to_string())
    }
}

/// How the results of several trainings are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// As a table for people.
    Table,
    /// As JSON.
    Json,
    /// Not at all: the caller tells.
    Nothing,
}

/// Trainings of one plan.
pub struct Several {
    folder: PathBuf,
    plan: Plan,
    rows: Vec<Row>,
}

/// The result of one of them, with the keys of the JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Row {
    seed: u64,
    run: PathBuf,
    env_steps: u64,
    updates: u64,
    wall_s: f64,
    stopped_by: String,
    #[serde(default)]
    trend: Option<Trend>,
    evaluation: Option<Evaluation>,
}

/// A quantity of each training, if it exists.
type Quantity = (&'static str, fn(&Row) -> Option<f64>);

const QUANTITIES: [Quantity; 5] = [
    ("wall_s", |row| Some(row.wall_s)),
    ("env_steps", |row| Some(row.env_steps as f64)),
    ("success", |row| row.evaluation.as_ref()?.success),
    ("episode_length_s", |row| row.evaluation.as_ref()?.episode_length_s),
    ("effort", |row| row.evaluation.as_ref()?.effort),
];

impl Several {
    /// Makes the folder, with the checkpoint that all of them start from, if there is one.
    pub fn create(folder: &Path, plan: Plan, from: Option<&Checkpoint>) -> Result<Self> {
        let refuse = |reason: &dyn std::fmt::Display| {
            Failure::sentence(format!(
                "cannot make the folder {}: {reason}; choose another with --out",
                folder.display()
            ))
        };
        if folder.exists() {
            return Err(refuse(&"it exists already"));
        }
        let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        std::fs::create_dir_all(parent).map_err(|error| refuse(&error))?;
        // It gets its name when the plan is in it: if the process is killed before, no useless folder is left under that name.
        let mut new = tempfile::Builder::new();
        new.prefix(".seeds-");
        // Temporary folders can be read by their owner only; this one stays, so it gets the usual permissions.
        #[cfg(unix)]
        new.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        let new = new.tempdir_in(parent).map_err(|error| refuse(&error))?;
        if let Some(from) = from {
            from.write(&new.path().join(FROM))?;
        }
        write_json(&new.path().join(PLAN), &plan)?;
        std::fs::rename(new.path(), folder).map_err(|error| refuse(&error))?;
        // The folder has another name now.
        let _ = new.keep();
        Ok(Self { folder: folder.to_owned(), plan, rows: Vec::new() })
    }

    /// The trainings in a folder, none if it is not one of several seeds.
    pub fn open(folder: &Path) -> Result<Option<Self>> {
        let Some(plan) = read_json::<Plan>(&folder.join(PLAN))? else { return Ok(None) };
        let plan = plan.check().map_err(|reason| damaged(&folder.join(PLAN), &reason))?;
        #[derive(Deserialize)]
        struct Results {
            runs: Vec<Row>,
        }
        let rows = read_json::<Results>(&folder.join(RESULTS))?.map_or_else(Vec::new, |results| results.runs);
        let mut several = Self { folder: folder.to_owned(), plan, rows: Vec::new() };
        // The others go on.
        let over = rows.into_iter().filter(|row| is_over(&row.stopped_by));
        // The folder may have been moved.
        several.rows = over.map(|row| Row { run: several.run_folder(row.seed), ..row }).collect();
        Ok(Some(several))
    }

    /// What is trained.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The checkpoint that all of them start from, if there is one.
    pub fn from(&self) -> Result<Option<Checkpoint>> {
        self.plan.run.from.as_ref().map(|_| Ok(Checkpoint::read(&self.folder.join(FROM))?)).transpose()
    }

    fn seeds(&self) -> RangeInclusive<u64> {
        self.plan.first_seed..=self.plan.last_seed
    }

    /// Folder of one of them.
    pub fn run_folder(&self, seed: u64) -> PathBuf {
        Self::run_folder_in(&self.folder, seed)
    }

    /// Folders of all of them that were begun.
    pub fn run_folders(&self) -> Vec<PathBuf> {
        self.seeds().map(|seed| self.run_folder(seed)).filter(|run| run.exists()).collect()
    }

    /// The same, in a folder of several.
    pub fn run_folder_in(folder: &Path, seed: u64) -> PathBuf {
        folder.join(format!("seed-{seed}"))
    }

    /// Plans further ones, up to this seed.
    pub fn extend_to(&mut self, last_seed: u64) -> Result<()> {
        if last_seed > self.plan.last_seed {
            self.plan.last_seed = last_seed;
            write_json(&self.folder.join(PLAN), &self.plan)?;
        }
        Ok(())
    }

    /// The users who are trained, as far as they were evaluated, and how many there are to be.
    pub fn users(&self) -> (Vec<TrainedUser>, usize) {
        let user = |row: &Row| Some(TrainedUser { evaluation: row.evaluation.clone()?, trend: row.trend });
        (self.rows.iter().filter_map(user).collect(), self.seeds().count())
    }

    /// Sets the goal of all of them, in the folders of those that have begun, too: each may go on alone. If it is another
    /// than before, none of them is over.
    pub fn aim(&mut self, goal: Goal) -> Result<()> {
        if goal != self.plan.run.goal() {
            for run in self.seeds().map(|seed| self.run_folder(seed)).filter(|run| run.join("config.json").exists()) {
                RunDescription::aim(&mut RunClaim::take(&run)?, goal)?;
            }
            self.plan.run = self.plan.run.clone().with_goal(goal);
            self.rows.clear();
            self.write_results()?;
            write_json(&self.folder.join(PLAN), &self.plan)?;
        }
        Ok(())
    }

    /// Trains with the seeds that are not over, one after the other, and reports the results of all.
    pub fn run(mut self, report: Report, mut train: impl FnMut(u64, &Path) -> Result<Outcome>) -> Result<()> {
        for seed in self.seeds() {
            if self.rows.iter().any(|row| row.seed == seed) {
                complain(&format!("seed {seed} is done"));
                continue;
            }
            let outcome = train(seed, &self.run_folder(seed))?;
            let end = outcome.end.clone();
            let lost = loss(&outcome, &self.folder);
            self.add(seed, outcome)?;
            match end {
                End::DeviceLost { .. } => return Err(Failure::DeviceLost(lost)),
                End::Interrupted => return self.tell_interrupt(&[seed], report),
                End::Until | End::Plateau | End::Steps => {}
            }
        }
        self.tell(report)
    }

    /// Trains at once with these seeds, those that are not over, and reports the results of all.
    pub fn run_at_once(mut self, report: Report, all: Vec<Ready<'_>>, interrupt: &Interrupt) -> Result<()> {
        for row in &self.rows {
            complain(&format!("seed {} is done", row.seed));
        }
        let seeds: Vec<u64> = all.iter().map(|ready| ready.session.trainer().seed()).collect();
        let mut failures = Vec::new();
        Ready::run_all(all, interrupt, |index, outcome| {
            failures.extend(outcome.and_then(|outcome| self.take(seeds[index], outcome)).err());
        });
        match failures.into_iter().next() {
            Some(failure) => Err(failure),
            None => self.tell_all(report),
        }
    }

    /// Takes in how one ended that ran at once with others.
    pub fn take(&mut self, seed: u64, outcome: Outcome) -> Result<()> {
        let (is_lost, lost) = (matches!(outcome.end, End::DeviceLost { .. }), loss(&outcome, &self.folder));
        self.add(seed, outcome)?;
        if is_lost { Err(Failure::DeviceLost(lost)) } else { Ok(()) }
    }

    /// Reports the results of all, or which of them were interrupted.
    pub fn tell_all(&self, report: Report) -> Result<()> {
        let is_interrupted = |row: &&Row| row.stopped_by == End::Interrupted.name();
        let interrupted: Vec<u64> = self.rows.iter().filter(is_interrupted).map(|row| row.seed).collect();
        if interrupted.is_empty() { self.tell(report) } else { self.tell_interrupt(&interrupted, report) }
    }

    /// The seeds of the trainings that are not over.
    pub fn left(&self) -> Vec<u64> {
        self.seeds().filter(|seed| self.rows.iter().all(|row| row.seed != *seed)).collect()
    }

    /// Takes in the result of one; writes the table of all so far.
    fn add(&mut self, seed: u64, outcome: Outcome) -> Result<()> {
        self.rows.push(Row {
            seed,
            run: self.run_folder(seed),
            env_steps: outcome.env_steps,
            updates: outcome.updates,
            wall_s: outcome.wall_s,
            stopped_by: outcome.end.name().into(),
            trend: outcome.trend,
            evaluation: outcome.evaluation,
        });
        self.rows.sort_by_key(|row| row.seed);
        self.write_results()
    }

    fn write_results(&self) -> Result<()> {
        write_json(&self.folder.join(RESULTS), &self.json())
    }

    /// A quantity over the trainings that have it.
    fn over_users(&self, quantity: fn(&Row) -> Option<f64>) -> Option<Sample> {
        Sample::of(&self.rows.iter().filter_map(quantity).collect::<Vec<_>>())
    }

    fn reached(&self) -> usize {
        self.rows.iter().filter(|row| [End::Until, End::Plateau].iter().any(|end| end.name() == row.stopped_by)).count()
    }

    fn json(&self) -> Value {
        let of = |pick: fn(Sample) -> f64| -> Value {
            QUANTITIES.iter().map(|(name, f)| ((*name).to_owned(), json!(self.over_users(*f).map(pick)))).collect()
        };
        json!({
            "task": self.plan.run.task.name,
            "folder": self.folder,
            "runs": self.rows,
            "reached": self.reached(),
            "mean": of(|sample| sample.mean),
            "sd": of(|sample| sample.sd),
        })
    }

    fn tell_interrupt(&self, seeds: &[u64], report: Report) -> Result<()> {
        if report == Report::Json {
            print_json(&self.json())?;
        } else {
            let next = command(&["train", "--resume", &argument(&self.folder)]);
            let stopped = match seeds {
                [seed] => format!("stopped in the training with seed {seed}, with a checkpoint"),
                seeds => format!(
                    "stopped in the trainings with seeds {}, each with a checkpoint",
                    seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")
                ),
            };
            print(&format!("\n{stopped}\n\nnext: {next}\n"))?;
        }
        Err(Failure::Interrupted)
    }

    /// Reports the results of all.
    fn tell(&self, report: Report) -> Result<()> {
        match report {
            Report::Nothing => return Ok(()),
            Report::Json => return print_json(&self.json()),
            Report::Table => {}
        }
        let mut cells = vec![row(["seed", "time", "control steps", "success", "episode", "effort", "stopped by"])];
        cells.extend(self.rows.iter().map(|row| Self::cells(&row.seed.to_string(), |f| f(row), &row.stopped_by)));
        cells.push(Self::cells("mean", |f| self.over_users(f).map(|sample| sample.mean), ""));
        cells.push(Self::cells("sd", |f| self.over_users(f).map(|sample| sample.sd), ""));
        print(&format!(
            "\n{}: {} of {} seeds reached the goal\n\n{}\n  run folders     {}\n",
            name(&self.plan.run.task.name),
            self.reached(),
            self.rows.len(),
            table(&cells),
            self.folder.display()
        ))
    }

    /// One row of the table for people.
    fn cells(name: &str, value: impl Fn(fn(&Row) -> Option<f64>) -> Option<f64>, end: &str) -> Vec<String> {
        let show: [fn(f64) -> String; 5] =
            [duration, rounded, percent, |s| format!("{s:.2} s"), |effort| format!("{effort:.4}")];
        let numbers = QUANTITIES.iter().zip(show).map(|((_, f), show)| value(*f).map_or("-".into(), show));
        [name.to_owned()].into_iter().chain(numbers).chain([end.to_owned()]).collect()
    }
}

/// Whether a training that was stopped for this reason has nothing left to do.
fn is_over(stopped_by: &str) -> bool {
    [End::Until, End::Plateau, End::Steps].iter().any(|end| end.name() == stopped_by)
}

fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string_pretty(value)? + "\n";
    Ok(write_whole(path, text.as_bytes())?)
}

/// None if the file is not there.
fn read_json<T: serde::de::DeserializeOwned>(path: &Path) -> Result<Option<T>> {
    let text = match std::fs::read(path) {
        // Neither is there anything below what is not a folder.
        Err(error) if matches!(error.kind(), std::io::ErrorKind::NotFound | std::io::ErrorKind::NotADirectory) => {
            return Ok(None);
        }
        text => text.map_err(|error| Failure::sentence(format!("cannot read {}: {error}", path.display())))?,
    };
    serde_json::from_slice(&text).map(Some).map_err(|error| damaged(path, &error))
}

fn damaged(path: &Path, reason: &dyn std::fmt::Display) -> Failure {
    Failure::sentence(format!("cannot understand {}: {reason}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_end_at_the_greatest() {
        assert_eq!(seeds(u64::MAX - 1, 2).unwrap(), u64::MAX - 1..=u64::MAX);
        assert_eq!(seeds(u64::MAX, 1).unwrap().count(), 1);
        let Err(Failure::Sentence(text)) = seeds(u64::MAX, 2) else { panic!("no third seed is left") };
        assert!(text.ends_with("it can be at most 18446744073709551614"), "{text}");
    }
}
