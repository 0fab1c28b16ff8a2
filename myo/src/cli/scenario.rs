//! A task and the body that does it, ready to be simulated.

use std::path::Path;

use myo::env::EnvConfig;
use myo::model::{Model, ModelDescription};
use myo::tasks::{Report, Source, Task, User, load};
use myo::train::PpoConfig;
use myo::{
    Backend, Envs, LayoutsError, ModelReach, RunDescription, Setting, layout_names, most_success, one_structure,
    usual_settings,
};

use super::backend;
use super::failure::{Failure, Mistake, Result, model_failure, task_mistakes};
use super::model;
use super::output::name;

/// Layouts that are all named in a title, at most.
const NAMED: usize = 4;

/// A task, or several layouts of one, and its model.
pub struct Scenario {
    /// What to do; the first of several layouts.
    pub task: Task,
    /// All layouts, one or more.
    pub layouts: Vec<Task>,
    /// The body that does it.
    pub model: Model,
    /// The description of the model, unless it comes with the program: its file may change.
    pub own_model: Option<ModelDescription>,
    /// The greatest share of episodes that can succeed, as far as the check of the task knows.
    pub most_success: f64,
}

impl Scenario {
    /// What its users learn with where nothing else is said.
    pub fn usual_settings(&self) -> PpoConfig {
        usual_settings(self.task.user, &self.model)
    }

    /// Reads a preset or a task file, prints warnings, and refuses a task that cannot be done.
    pub fn open(name_or_file: &str) -> Result<Self> {
        Self::open_for(name_or_file, None)
    }

    /// The same for a user who is like this where the task does not say.
    pub fn open_for(name_or_file: &str, user: Option<User>) -> Result<Self> {
        Self::open_with(name_or_file, user, |_| ())
    }

    /// The same for a user who is changed in something.
    pub fn open_with(name_or_file: &str, user: Option<User>, change: impl FnOnce(&mut Task)) -> Result<Self> {
        let source = read(name_or_file)?;
        let mut source = user.map_or_else(|| source.clone(), |user| source.clone().done_by(user));
        change(&mut source.task);
        source.task.check_values().map_err(|error| Failure::sentence(format!("{name_or_file}: {error}")))?;
        Self::of_source(source)
    }

    /// The same for the user of another task, who brings its body along.
    pub fn open_as(name_or_file: &str, other: &Task) -> Result<Self> {
        Self::of_source(read(name_or_file)?.done_as(other))
    }

    /// A preset, done by this user with another body.
    pub fn of_preset(name: &str, user: User, body: &str) -> Result<Self> {
        let mut source = read(name)?.done_by(user);
        source.task.model = body.into();
        Self::of_source(source)
    }

    fn of_source(source: Source) -> Result<Self> {
        let (report, model) = examine(&source)?;
        let (errors, warnings) = mistakes(&source, &report);
        warnings.iter().for_each(Mistake::tell);
        if !errors.is_empty() {
            return Err(Failure::Mistakes(errors));
        }
        let own_model = model::own(&source.task.model)?;
        let (task, layouts) = (source.task.clone(), vec![source.task]);
        Ok(Self { task, layouts, model, own_model, most_success: most_success(&report) })
    }

    /// The same with several layouts, which must have one structure.
    pub fn open_together(names_or_files: &[String], user: Option<User>) -> Result<Self> {
        let scenarios = names_or_files.iter().map(|name| Self::open_for(name, user)).collect::<Result<Vec<_>>>()?;
        let most_success = scenarios.iter().map(|scenario| scenario.most_success).fold(1.0, f64::min);
        let layouts: Vec<Task> = scenarios.iter().map(|scenario| scenario.task.clone()).collect();
        let Some(first) = scenarios.into_iter().next() else { return Err(Failure::sentence("name a task")) };
        one_structure(&first.model, &layouts).map_err(|error| match error {
            LayoutsError::Differs { index, what } => Failure::sentence(format!(
                "{} cannot be learned together with {}: {what}. Layouts may differ in numbers alone: where things are, how large, \
                 which of them a step asks for, times, forces, weights",
                names_or_files[index], names_or_files[0]
            )),
            other => other.into(),
        })?;
        Ok(Self { layouts, most_success, ..first })
    }

    /// The task and the model of a run.
    pub fn of(run: &RunDescription) -> Result<Self> {
        let model = run.body().map_err(|error| model_failure(&error))?;
        let (task, layouts) = (run.task.clone(), run.layouts());
        Ok(Self { task, layouts, model, own_model: run.model.clone(), most_success: 1.0 })
    }

    /// The body and the first layout.
    pub fn setting(&self) -> Setting<'_> {
        Setting { task: &self.task, model: &self.model, own_model: self.own_model.as_ref() }
    }

    /// What is done, for people: the name of the task, or of the first few layouts.
    pub fn title(&self) -> String {
        let names: Vec<String> = layout_names(&self.layouts).iter().map(|layout| name(layout)).collect();
        match &names[..] {
            [one] => one.clone(),
            [first, .., last] if names.len() > NAMED => format!("{first} to {last} ({} layouts)", names.len()),
            [others @ .., last] => format!("{} and {last}", others.join(", ")),
            [] => String::new(),
        }
    }

    /// Environments of the task for several trainings at once; none where they would run one after the other.
    pub fn env_for_several(&self, backend: &Backend, config: &PpoConfig, trainings: usize) -> Result<Option<Envs>> {
        backend::build_several(backend, &self.model, &self.layouts, config, trainings)
    }

    /// Environments of the task to train in, on the backend that is asked for.
    pub fn training_env(&self, backend: &Backend, config: &PpoConfig, seed: u64) -> Result<Envs> {
        backend::build_for_training(backend, &self.model, &self.layouts, (config, seed))
    }

    /// Environments of the task on the backend that is asked for.
    pub fn env(&self, backend: &Backend, num_envs: usize, seed: u64) -> Result<Envs> {
        backend::build(backend, &self.model, &self.layouts, &EnvConfig { num_envs, seed, ..EnvConfig::default() })
    }
}

/// What the runs of a preset or a task file are called: like the preset, or like the file without its ending.
pub fn run_name(name_or_file: &str) -> String {
    let path = Path::new(name_or_file);
    let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    stem.replace(|c: char| !c.is_alphanumeric() && c != '_', "-")
}

/// What the runs of several layouts are called.
pub fn run_name_of(names_or_files: &[String]) -> String {
    let names: Vec<String> = names_or_files.iter().map(|name| run_name(name)).collect();
    match &names[..] {
        [first, ..] if names.len() > NAMED => format!("{first}-and-{}-more", names.len() - 1),
        all => all.join("-"),
    }
}

/// Reads a preset or a task file.
pub fn read(name_or_file: &str) -> Result<Source> {
    load(name_or_file).map_err(|error| Failure::Mistakes(task_mistakes(&error)))
}

/// Everything wrong or odd about a task for its body, and the body.
pub fn examine(source: &Source) -> Result<(Report, Model)> {
    let description = model::describe(&source.task.model).map_err(|failure| at_key(source, "model", failure))?;
    let refused = |key| move |error| at_key(source, key, model_failure(&error));
    Model::new(&description).map_err(refused("model"))?;
    let model = source.task.embody(&description).map_err(refused("body"))?;
    let reach = ModelReach::for_task(&model, &source.task)?;
    Ok((source.check(&reach), model))
}

/// An unknown model, or one that cannot become the body of the user, is a mistake of the task.
fn at_key(source: &Source, key: &str, failure: Failure) -> Failure {
    match failure {
        Failure::Sentence(text) => Failure::Mistakes(vec![Mistake::in_task(source, key, &text)]),
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
        let files = |count: usize| (0..count).map(|k| format!("tasks/{k}.yaml")).collect::<Vec<_>>();
        assert_eq!([1, 3, 6].map(|count| run_name_of(&files(count))), ["0", "0-1-2", "0-and-5-more"]);
    }
}
