//! Reading and writing task files.

use std::path::Path;

use myo_model::builtin_names;
use serde_saphyr::options::NonFiniteFloatPolicy;

use crate::check::{Reach, check, value_errors};
use crate::description::{Reward, Task};
use crate::explain::Explain;
use crate::layout::{Layout, SourceLocation};
use crate::load_error::{BadValue, LoadError};
use crate::presets::preset_text;
use crate::report::{Report, TaskError};
use crate::user::User;

/// First line of a task file: it lets an editor that knows the YAML language server complete and check the file.
pub const SCHEMA_HINT: &str = "# yaml-language-server: $schema=./myo-task.schema.json";

/// A task together with the text it was read from.
#[derive(Clone, Debug)]
pub struct Source {
    /// File name, or the name of the preset.
    pub name: String,
    /// The text as it was written, comments included.
    pub text: String,
    /// What it says, repeated targets written out.
    pub task: Task,
    layout: Layout,
    /// For each target of `task`, its index in the text.
    origin: Vec<usize>,
}

/// Reads a preset or a file. A preset's name goes first; write `./ar` for a file called `ar`. A model file that the task
/// names is looked for in the folder of the task.
pub fn load(name_or_path: &str) -> Result<Source, LoadError> {
    if let Some(text) = preset_text(name_or_path) {
        return Source::parse(text, name_or_path);
    }
    let path = Path::new(name_or_path);
    let looks_like_path = path.components().count() > 1 || path.extension().is_some();
    if !looks_like_path && !path.exists() {
        return Err(LoadError::UnknownPreset { name: name_or_path.to_owned() });
    }
    let text = std::fs::read_to_string(path).map_err(|cause| LoadError::Io { path: path.to_owned(), cause })?;
    Ok(Source::parse(&text, name_or_path)?.in_folder(path.parent().unwrap_or(Path::new(""))))
}

impl Source {
    /// The same as the text of a file in a folder: a model file that the task names is looked for there.
    #[must_use]
    pub fn in_folder(mut self, folder: &Path) -> Self {
        self.task.model = model_from(&self.task.model, folder);
        self
    }
}

/// The model of a task file as seen from the working directory: paths in a file start at its folder.
pub fn model_from(model: &str, folder: &Path) -> String {
    let looks_like_path = Path::new(model).components().count() > 1 || Path::new(model).extension().is_some();
    let beside = folder.join(model);
    let is_file = !builtin_names().contains(&model) && (looks_like_path || beside.is_file());
    if is_file { beside.to_string_lossy().into_owned() } else { model.to_owned() }
}

impl Task {
    /// Reads a task file's text. `file_name` is used in messages only.
    pub fn from_yaml(text: &str, file_name: &str) -> Result<Self, LoadError> {
        Source::parse(text, file_name).map(|source| source.task)
    }

    /// The task as a file, without comments. The commented file of a preset is [`preset_text`].
    ///
    /// # Panics
    /// Never: all fields have a form in YAML.
    pub fn to_yaml(&self) -> String {
        // YAML 1.2, else the key `y` is quoted for readers that take it for "yes".
        let options = serde_saphyr::ser_options! { yaml_12: true, no_lang_directive: true };
        let body = serde_saphyr::to_string_with_options(&self.clone().collapsed(), options)
            .expect("every field of a task can be written");
        format!("{SCHEMA_HINT}\n{body}")
    }
}

impl Source {
    /// Reads a task file's text. `name` is used in messages only.
    pub fn parse(text: &str, name: &str) -> Result<Self, LoadError> {
        match Self::draft(text, name)? {
            (source, values) if values.is_empty() => Ok(source),
            (_, values) => Err(LoadError::Values { values }),
        }
    }

    /// Reads a text that somebody still writes: the task as far as it goes, and the values that are wrong, in the order of the text.
    ///
    /// # Errors
    /// The text is no YAML, or has keys or types that no task has.
    pub fn draft(text: &str, name: &str) -> Result<(Self, Vec<BadValue>), LoadError> {
        let layout = Layout::of(text);
        let mut task: Task = serde_saphyr::from_str_with_options(text, yaml_options())
            .map_err(|error| Explain { name, layout: layout.as_ref() }.error(&error))?;
        // A text that yields a task is YAML, so it has a layout.
        let layout = layout.ok_or_else(|| LoadError::Syntax {
            place: SourceLocation::new(name, (1, 1)),
            message: "the file cannot be read a second time to find positions".into(),
        })?;
        task.as_meant_then(|path| layout.has(path));
        task.fill_in(|path| layout.has(path));
        let mut values = bad_values(&task, name, &layout);
        values.extend(costs_twice(&task.reward, name, &layout));
        // Wrong values may ask for millions of copies.
        let repeats = |i: usize| if values.is_empty() { task.targets[i].repeat() as usize } else { 1 };
        let origin = (0..task.targets.len()).flat_map(|i| std::iter::repeat_n(i, repeats(i))).collect();
        let task = if values.is_empty() { task.expanded().with_costs_per_second() } else { task };
        Ok((Self { name: name.to_owned(), text: text.to_owned(), task, layout, origin }, values))
    }

    /// The same with another user, where the text does not say what it is like.
    #[must_use]
    pub fn done_by(mut self, user: User) -> Self {
        self.task.user = user;
        self.task.fill_in(|path| self.layout.has(path));
        self
    }

    /// The same done by the user of another task, with that user's body, where the text says nothing of them.
    #[must_use]
    pub fn done_as(self, other: &Task) -> Self {
        let mut source = self.done_by(other.user);
        if !source.layout.has("body") {
            source.task.body = other.body.clone();
        }
        source
    }

    /// Everything that [`check`] finds.
    pub fn check(&self, reach: &dyn Reach) -> Report {
        check(&self.task, reach)
    }

    /// Where the value at `path` of [`Source::task`] stands in the text, as the paths of errors and warnings say it.
    pub fn place(&self, path: &str) -> SourceLocation {
        SourceLocation::new(&self.name, self.layout.value(&self.path_in_text(path)))
    }

    /// All sentences of a report, errors first, each behind the place it speaks of.
    pub fn messages(&self, report: &Report) -> Vec<String> {
        let errors = report.errors.iter().map(|error| format!("{}: {error}", self.place(&error.path())));
        let warnings = report.warnings.iter().map(|w| format!("{}: warning: {w}", self.place(&w.path())));
        errors.chain(warnings).collect()
    }

    /// Repeated targets count once in the text.
    fn path_in_text(&self, path: &str) -> String {
        let renumbered = path.strip_prefix("targets[").and_then(|rest| {
            let (index, tail) = rest.split_once(']')?;
            let index = self.origin.get(index.parse::<usize>().ok()?)?;
            Some(format!("targets[{index}]{tail}"))
        });
        renumbered.unwrap_or_else(|| path.to_owned())
    }
}

/// Costs that a text has under their old name, per control step, and under their new one.
fn costs_twice(reward: &Reward, name: &str, layout: &Layout) -> Vec<BadValue> {
    let Reward { distance, neural_effort, acceleration_effort, .. } = reward;
    let costs = [
        (distance, "distance", "distance_cost"),
        (neural_effort, "neural_effort", "effort_cost"),
        (acceleration_effort, "acceleration_effort", "acceleration_cost"),
    ];
    let twice = costs.into_iter().filter(|(old, _, new)| old.is_some() && layout.has(&format!("reward.{new}")));
    let bad = |(_, old, new): (_, &'static str, &'static str)| {
        let error = TaskError::Value {
            path: format!("reward.{old}"),
            subject: format!("`{old}` of `reward`"),
            problem: format!("is a cost per control step, and `{new}` the same per second; leave one of them out"),
        };
        BadValue { place: SourceLocation::new(name, layout.value(&error.path())), error }
    };
    twice.map(bad).collect()
}

fn bad_values(task: &Task, name: &str, layout: &Layout) -> Vec<BadValue> {
    let located = |error: TaskError| BadValue { place: SourceLocation::new(name, layout.value(&error.path())), error };
    let mut values: Vec<BadValue> = value_errors(task).into_iter().map(located).collect();
    values.sort_by_key(|value| (value.place.line, value.place.column));
    values
}

/// Options for every reading: numbers such as `.nan` come through, so that they are refused with a sentence of our own.
pub(crate) fn yaml_options() -> serde_saphyr::Options {
    serde_saphyr::options! {
        with_snippet: false,
        strict_booleans: true,
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
    }
}
