//! `myo train --seeds N`: the same training with several seeds, since one may be lucky.

use std::path::{Path, PathBuf};

use myo::train::session::{End, Outcome};
use serde_json::{Value, json};

use crate::cli::failure::{Failure, Result};
use crate::cli::output::{duration, percent, print, print_json, rounded, row, table, write_file};

/// What the trainings have in common.
pub struct Several {
    task: String,
    folder: PathBuf,
    rows: Vec<Row>,
}

struct Row {
    seed: u64,
    outcome: Outcome,
}

/// A quantity of each training, if it exists.
type Quantity = (&'static str, fn(&Outcome) -> Option<f64>);

const QUANTITIES: [Quantity; 5] = [
    ("wall_s", |outcome| Some(outcome.wall_s)),
    ("env_steps", |outcome| Some(outcome.env_steps as f64)),
    ("success", |outcome| outcome.evaluation.as_ref()?.success),
    ("episode_length_s", |outcome| outcome.evaluation.as_ref()?.episode_length_s),
    ("effort", |outcome| outcome.evaluation.as_ref()?.effort),
];

impl Several {
    /// None yet; each gets its own run folder in `folder`.
    pub fn new(task: &str, folder: &Path) -> Result<Self> {
        if let Some(parent) = folder.parent() {
            std::fs::create_dir_all(parent)?;
        }
        std::fs::create_dir(folder).map_err(|error| {
            Failure::sentence(format!(
                "cannot make the folder {}: {error}; choose another with --out",
                folder.display()
            ))
        })?;
        Ok(Self { task: task.into(), folder: folder.to_owned(), rows: Vec::new() })
    }

    /// Folder of one of them.
    pub fn run_folder(&self, seed: u64) -> PathBuf {
        self.folder.join(format!("seed-{seed}"))
    }

    /// Takes in how one went; writes the table of all so far.
    pub fn add(&mut self, seed: u64, outcome: Outcome) -> Result<()> {
        self.rows.push(Row { seed, outcome });
        let text = serde_json::to_string_pretty(&self.json())? + "\n";
        write_file(&self.folder.join("seeds.json"), &text)
    }

    /// Mean and standard deviation of a quantity over the trainings that have it.
    fn spread(&self, quantity: fn(&Outcome) -> Option<f64>) -> Option<(f64, f64)> {
        let values: Vec<f64> = self.rows.iter().filter_map(|row| quantity(&row.outcome)).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        (n > 0.0).then(|| (mean, (squares / (n - 1.0).max(1.0)).sqrt()))
    }

    fn reached(&self) -> usize {
        self.rows.iter().filter(|row| row.outcome.end == End::Until).count()
    }

    fn json(&self) -> Value {
        let runs = self.rows.iter().map(|Row { seed, outcome }| {
            json!({
                "seed": seed,
                "run": outcome.run,
                "env_steps": outcome.env_steps,
                "updates": outcome.updates,
                "wall_s": outcome.wall_s,
                "stopped_by": outcome.end.name(),
                "evaluation": outcome.evaluation,
            })
        });
        let of = |pick: fn((f64, f64)) -> f64| -> Value {
            QUANTITIES.iter().map(|(name, f)| ((*name).to_owned(), json!(self.spread(*f).map(pick)))).collect()
        };
        json!({
            "task": self.task,
            "folder": self.folder,
            "runs": runs.collect::<Vec<_>>(),
            "reached": self.reached(),
            "mean": of(|(mean, _)| mean),
            "sd": of(|(_, sd)| sd),
        })
    }

    /// Tells how all of them went.
    pub fn tell(&self, as_json: bool) -> Result<()> {
        if as_json {
            return print_json(&self.json());
        }
        let mut cells = vec![row(["seed", "time", "control steps", "success", "episode", "effort", "stopped by"])];
        cells.extend(
            self.rows
                .iter()
                .map(|Row { seed, outcome }| Self::cells(&seed.to_string(), |f| f(outcome), outcome.end.name())),
        );
        cells.push(Self::cells("mean", |f| self.spread(f).map(|(mean, _)| mean), ""));
        cells.push(Self::cells("sd", |f| self.spread(f).map(|(_, sd)| sd), ""));
        print(&format!(
            "\n{}: {} of {} seeds reached the goal\n\n{}\n  run folders     {}\n",
            self.task,
            self.reached(),
            self.rows.len(),
            table(&cells),
            self.folder.display()
        ))
    }

    /// One row of the table for people.
    fn cells(name: &str, value: impl Fn(fn(&Outcome) -> Option<f64>) -> Option<f64>, end: &str) -> Vec<String> {
        let show: [fn(f64) -> String; 5] =
            [duration, rounded, percent, |s| format!("{s:.2} s"), |effort| format!("{effort:.4}")];
        let numbers = QUANTITIES.iter().zip(show).map(|((_, f), show)| value(*f).map_or("-".into(), show));
        [name.to_owned()].into_iter().chain(numbers).chain([end.to_owned()]).collect()
    }
}
