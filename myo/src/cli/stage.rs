//! A task and the body that does it, ready to be simulated.

use std::path::Path;

use myo::env::EnvConfig;
use myo::model::{Model, ModelDescription};
use myo::tasks::{Report, Source, Task, load};
use myo::train::PpoConfig;
use myo::{Backend, Envs, ModelReach, RunDescription, most_success};

use super::backend;
use super::failure::{Failure, Mistake, Result, model_failure, task_mistakes};
use super::model;

/// A task and its model.
pub struct Stage {
    /// What to do.
    pub task: Task,
    /// The body that does it.
    pub model: Model,
    /// The description of the model, unless it comes with the program: its file may change.
    pub own_model: Option<ModelDescription>,
    /// The greatest share of episodes that can succeed, as far as the check of the task knows.
    pub most_success: f64,
}

impl Stage {
    /// Reads a preset or a task file, prints warnings, and refuses a task that cannot be done.
    pub fn open(name_or_file: &str) -> Result<Self> {
        let source = read(name_or_file)?;
        let (report, model) = examine(&source)?;
        let (errors, warnings) = mistakes(&source, &report);
        warnings.iter().for_each(Mistake::tell);
        if !errors.is_empty() {
            return Err(Failure::Mistakes(errors));
        }
        let own_model = model::own(&source.task.model)?;
        Ok(Self { task: source.task, model, own_model, most_success: most_success(&report) })
    }

    /// The task and the model of a run.
    pub fn of(run: &RunDescription) -> Result<Self> {
        let model = run.body().map_err(|error| model_failure(&error))?;
        Ok(Self { task: run.task.clone(), model, own_model: run.model.clone(), most_success: 1.0 })
    }

    /// Environments of the task for several trainings at once; none where they would run one after the other.
    pub fn env_for_several(&self, backend: &Backend, config: &PpoConfig, trainings: usize) -> Result<Option<Envs>> {
        backend::build_several(backend, &self.model, &self.task, &config.envs(0), trainings)
    }

    /// Environments of the task to train in, on the backend that is asked for.
    pub fn training_env(&self, backend: &Backend, config: &PpoConfig, seed: u64) -> Result<Envs> {
        backend::build(backend, &self.model, &self.task, &config.envs(seed))
    }

    /// Environments of the task on the backend that is asked for.
    pub fn env(&self, backend: &Backend, num_envs: usize, seed: u64) -> Result<Envs> {
        backend::build(backend, &self.model, &self.task, &EnvConfig { num_envs, seed, ..EnvConfig::default() })
    }
}

/// What the runs of a preset or a task file are called: like the preset, or like the file without its ending.
pub fn run_name(name_or_file: &str) -> String {
    let path = Path::new(name_or_file);
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    stem.replace(|c: char| !c.is_alphanumeric() && c != '_', "-")
}

/// Reads a preset or a task file.
pub fn read(name_or_file: &str) -> Result<Source> {
    load(name_or_file).map_err(|error| Failure::Mistakes(task_mistakes(&error)))
}

/// Everything wrong or odd about a task for its body, and the body.
pub fn examine(source: &Source) -> Result<(Report, Model)> {
    let model = model::open(&source.task.model).map_err(|failure| at_model_key(source, failure))?;
    let reach = ModelReach::new(&model)?;
    Ok((source.check(&reach), model))
}

/// An unknown model is a mistake of the task.
fn at_model_key(source: &Source, failure: Failure) -> Failure {
    match failure {
        Failure::Sentence(text) => Failure::Mistakes(vec![Mistake::in_task(source, "model", &text)]),
        other => other,
    }
}

/// The errors and the warnings of a report, with their places.
pub fn mistakes(source: &Source, report: &Report) -> (Vec<Mistake>, Vec<Mistake>) {
    let errors = report.errors.iter().map(|error| Mistake::in_task(source, &error.path(), &error.to_string()));
    let warnings = report.warnings.iter().map(|odd| Mistake::in_task(source, &odd.path(), &odd.to_string()).warning());
    (errors.collect(), warnings.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_called_like_the_preset_or_the_file() {
        let names = ["pointing-single", "my.yaml", "../tasks/two keys.v2.yml", "./ar"].map(run_name);
        assert_eq!(names, ["pointing-single", "my", "two-keys-v2", "ar"]);
    }
}
