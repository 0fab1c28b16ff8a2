//! What trainings leave behind, to compare those that were disturbed with those that were not.

use std::fs;
use std::path::Path;

use myo::train::RunFolder;
use serde_json::Value;

/// What a finished training left, or the finished trainings of several users.
pub struct Left {
    runs: Vec<LeftRun>,
    /// The results in `seeds.json` but for times and folders.
    results: Vec<Value>,
}

impl Left {
    /// What is in a run folder, or in one of several seeds.
    pub fn of(folder: &Path) -> Self {
        let Ok(results) = fs::read(folder.join("seeds.json")) else {
            return Self { runs: vec![LeftRun::of(folder)], results: vec![] };
        };
        let results: Value = serde_json::from_slice(&results).unwrap();
        let results = results["runs"].as_array().expect("a list of results");
        let run = |result: &Value| LeftRun::of(&folder.join(format!("seed-{}", result["seed"])));
        let told = ["seed", "env_steps", "updates", "stopped_by", "trend", "evaluation"];
        let told = |result: &Value| told.iter().map(|key| result[*key].clone()).collect();
        Self { runs: results.iter().map(run).collect(), results: results.iter().map(told).collect() }
    }

    /// Updates of each training.
    pub fn updates(&self) -> Vec<usize> {
        // The first row is the heading.
        self.runs.iter().map(|run| run.metrics.len() - 1).collect()
    }

    /// What differs, if anything does.
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.results != other.results {
            return Some(format!("other results: {:?}, not {:?}", other.results, self.results));
        }
        self.runs.iter().zip(&other.runs).find_map(|(run, other)| run.difference(other))
    }
}

/// What a finished run left: names of all files, metrics but for times, checkpoint and evaluation.
#[derive(PartialEq)]
struct LeftRun {
    files: Vec<String>,
    metrics: Vec<Vec<String>>,
    checkpoint: Vec<u8>,
    evaluation: Vec<u8>,
    events: u64,
}

impl LeftRun {
    fn of(run: &Path) -> Self {
        let folder = RunFolder::open(run).expect("a run");
        let mut checkpoint = folder.latest_checkpoint().unwrap().checkpoint.expect("a checkpoint");
        checkpoint.forget_wall_time();
        let text = fs::read_to_string(run.join("metrics.csv")).unwrap();
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let keep = |column: &usize| !rows[0][*column].ends_with("_s") || rows[0][*column].starts_with("target");
        let columns: Vec<usize> = (0..rows[0].len()).filter(keep).collect();
        let mut files = names(run, Path::new(""));
        // Their names tell when they were made.
        let is_event_file = |name: &String| name.starts_with("tensorboard/");
        let events =
            files.iter().filter(|name| is_event_file(name)).map(|name| run.join(name).metadata().unwrap().len());
        Self {
            events: events.sum(),
            metrics: rows.iter().map(|row| columns.iter().map(|&column| row[column].to_owned()).collect()).collect(),
            checkpoint: checkpoint.to_bytes(),
            evaluation: fs::read(run.join("evaluation.json")).expect("an evaluation"),
            files: {
                files.retain(|name| !is_event_file(name));
                files
            },
        }
    }

    /// What differs, if anything does.
    fn difference(&self, other: &Self) -> Option<String> {
        let differ = [
            ("files", self.files != other.files),
            ("metrics", self.metrics != other.metrics),
            ("checkpoint", self.checkpoint != other.checkpoint),
            ("evaluation", self.evaluation != other.evaluation),
            ("TensorBoard events", self.events != other.events),
        ];
        let found: Vec<_> = differ.iter().filter(|(_, differs)| *differs).map(|(name, _)| *name).collect();
        (!found.is_empty()).then(|| format!("other {}: {:?}, not {:?}", found.join(", "), other.files, self.files))
    }
}

/// Files below a folder, in order.
pub fn names(root: &Path, below: &Path) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for entry in fs::read_dir(root.join(below)).unwrap() {
        let path = below.join(entry.unwrap().file_name());
        if root.join(&path).is_dir() {
            found.extend(names(root, &path));
        } else {
            found.push(path.to_string_lossy().into_owned());
        }
    }
    found.sort();
    found
}
