//! Several layouts for one user.

use myo_env::{BuildError, Tables};
use myo_model::Model;
use myo_tasks::Task;

/// Why one user cannot learn several tasks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LayoutsError {
    /// One of them differs from the first in more than its numbers.
    #[error("layout {} cannot be learned together with the first: {what}", index + 1)]
    Differs {
        /// Its place among the tasks, from 0.
        index: usize,
        /// What differs, as half a sentence.
        what: String,
    },
    /// One of them cannot be simulated, or there is none.
    #[error(transparent)]
    Build(#[from] BuildError),
}

/// Refuses tasks that differ from the first in more than their numbers: one batch cannot hold both.
///
/// # Errors
/// Which one differs, and in what; or a task cannot be simulated.
pub fn one_structure(model: &Model, tasks: &[Task]) -> Result<(), LayoutsError> {
    let first = tasks.first().ok_or(BuildError::NoLayouts)?;
    for (index, task) in tasks.iter().enumerate().skip(1) {
        if task.model != first.model {
            let what = format!("its body is {} instead of {}", task.model, first.model);
            return Err(LayoutsError::Differs { index, what });
        }
        Tables::<f64>::with_layouts(model, &[first.clone(), task.clone()]).map_err(|error| match error {
            BuildError::OtherStructure { what } => LayoutsError::Differs { index, what },
            other => other.into(),
        })?;
    }
    Ok(())
}

/// What layouts are called: like their tasks, with a number where several are called the same.
pub fn layout_names(tasks: &[Task]) -> Vec<String> {
    let mut names: Vec<String> = Vec::with_capacity(tasks.len());
    for task in tasks {
        let name = &task.name;
        let same = tasks.iter().filter(|other| other.name == *name).count();
        let numbered = |k: usize| if same > 1 { format!("{name} ({k})") } else { name.clone() };
        names.extend((1..).map(numbered).find(|name| same == 1 || !names.contains(name)));
    }
    names
}

#[cfg(test)]
mod tests {
    use myo_tasks::preset;

    use super::*;

    #[test]
    fn layouts_that_are_called_the_same_are_numbered() {
        let named = |names: &[&str]| {
            let task = |name: &&str| Task { name: (*name).into(), ..preset("pointing-uitb").unwrap() };
            layout_names(&names.iter().map(task).collect::<Vec<_>>())
        };
        assert_eq!(named(&["a", "b"]), ["a", "b"]);
        assert_eq!(named(&["a", "b", "a"]), ["a (1)", "b", "a (2)"]);
    }
}
