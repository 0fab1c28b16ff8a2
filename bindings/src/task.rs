//! Tasks.

use myo::ModelReach;
use myo::tasks::{Source, load, preset_names as names, preset_text, task_schema as schema};
use pyo3::prelude::*;

use crate::error::{self, TaskError, compute};
use crate::model::Model;

/// A task: targets to point at or to press within a time limit.
///
/// Lengths are metres from the shoulder centre (x forward, y to the left, z up), times seconds, forces newtons.
#[pyclass(module = "myoenv", frozen)]
pub struct Task {
    source: Source,
}

impl Task {
    /// The task itself.
    pub fn inner(&self) -> &myo::tasks::Task {
        &self.source.task
    }
}

#[pymethods]
impl Task {
    /// A preset by its name, or a YAML file.
    #[staticmethod]
    fn load(name_or_path: &str) -> PyResult<Self> {
        Ok(Self { source: load(name_or_path).map_err(error::task)? })
    }

    /// A YAML text; `name` stands in messages. JSON is YAML, too.
    #[staticmethod]
    #[pyo3(signature = (text, name = "task"))]
    fn from_yaml(text: &str, name: &str) -> PyResult<Self> {
        Ok(Self { source: Source::parse(text, name).map_err(error::task)? })
    }

    /// The task as a YAML file, every field written out.
    fn to_yaml(&self) -> String {
        self.source.task.to_yaml()
    }

    /// The task as JSON, with the keys of a task file.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.source.task).map_err(error::task)
    }

    /// Refuses what the body cannot do; returns sentences about what is odd.
    fn check(&self, py: Python<'_>, model: &Model) -> PyResult<Vec<String>> {
        let body = model.of(&self.source.task)?;
        let report = compute(py, || Ok(self.source.check(&ModelReach::for_task(&body, &self.source.task)?)))?
            .map_err(|refusal: myo::dynamics::PlanError| error::task(refusal))?;
        let sentences = self.source.messages(&report);
        let (errors, warnings) = sentences.split_at(report.errors.len());
        if errors.is_empty() { Ok(warnings.to_vec()) } else { Err(TaskError::new_err(errors.join("\n"))) }
    }

    /// The same done by the user of another task, with that user's body, where this text says nothing of them.
    fn done_as(&self, other: &Self) -> Self {
        Self { source: self.source.clone().done_as(&other.source.task) }
    }

    /// Short name.
    #[getter]
    fn name(&self) -> &str {
        &self.source.task.name
    }

    /// Name of the body that does it.
    #[getter]
    fn model(&self) -> &str {
        &self.source.task.model
    }

    /// Number of targets: of the steps of its script, repetitions counted.
    #[getter]
    fn num_targets(&self) -> usize {
        self.source.task.flat().map_or(0, |flat| flat.steps.len())
    }

    /// Whether it is a preset as it comes with the library: these need no check.
    #[getter]
    fn is_preset(&self) -> bool {
        preset_text(&self.source.name) == Some(&*self.source.text)
    }

    fn __repr__(&self) -> String {
        format!("Task({:?}, {} targets)", self.source.task.name, self.num_targets())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.source.task == other.source.task
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let source = &this.get().source;
        Ok((this.get_type().getattr("from_yaml")?, (source.text.clone(), source.name.clone())))
    }
}

/// The tasks themselves.
pub fn inner(tasks: &[PyRef<'_, Task>]) -> Vec<myo::tasks::Task> {
    tasks.iter().map(|task| task.inner().clone()).collect()
}

/// Names of the tasks that come with the library.
#[pyfunction]
pub fn preset_names() -> Vec<&'static str> {
    names()
}

/// JSON Schema of a task file, as JSON.
#[pyfunction]
pub fn task_schema() -> String {
    schema().to_string()
}
