//! What all front doors of Myo share, the command line, the studio and Python: users are trained on some device, their runs are
//! found again, compared, explained and drawn.
//!
//! - [`Backend`], [`Device`] and [`Envs`] choose between processor and graphics card and train there; [`train_at_once`] trains several users;
//! - [`RunDescription`] is what a run folder says about its training, and [`find_runs`] finds all that lie in a folder;
//! - [`describe_model`] finds a body by its name, [`Anatomy`] tells what it is, [`ModelReach`] lets the checks of a task ask a model;
//! - [`Comparison`] tells two layouts apart, [`misfits`] whether a user can act on a layout that it was not trained on;
//! - [`likely_cause`] and [`most_success`] say why a training leads nowhere or cannot reach its goal;
//! - [`reward_terms`] says what each term of a reward can be worth, [`reward_slice`] how it lies in space;
//! - [`trajectories()`] writes down what a user does, physics step by physics step;
//! - [`fitting`] looks for the user who moves as a person does;
//! - [`published`] holds the experiments of the published system against ours;
//! - [`picture`] draws the simulated user, [`ProgressLine`] says in a line how a training goes.
//!
//! This crate knows no command line, no browser and no Python.
mod advice;
mod anatomy;
mod backend;
mod compare;
mod fit;
pub mod fitting;
mod importing;
mod layouts;
mod models;
pub mod picture;
pub mod progress;
pub mod protocol;
pub mod published;
mod reach;
pub mod recordings;
mod reward;
mod run_description;
mod runs;
mod settings;
mod trajectories;
mod users;

pub use advice::{Body, likely_cause, most_success};
pub use anatomy::{Anatomy, MuscleAnatomy, moment_arm_plots};
pub use backend::{AUTO_ENVS_PER_THREAD, Backend, Device, Envs, Start, auto_envs, default_steps};
pub use compare::{Comparison, Difference, Group, Quantity, TrainedUser, Verdict};
pub use fit::{Misfit, Setting, misfits};
pub use importing::{ImportError, Imported, import_model};
pub use layouts::{LayoutsError, layout_names, one_structure};
pub use models::{ModelFileError, describe_model, own_model};
pub use progress::ProgressLine;
pub use reach::ModelReach;
pub use reward::{RewardTerm, Slice, reward_slice, reward_terms};
pub use run_description::{RunDescription, WarmStart, WarmStartMoved};
pub use runs::{FoundRun, RunState, RunSummary, find_runs, run_summary};
pub use settings::{LearnerSetting, SettingsError, changed_settings, learner_settings, usual_settings};
pub use trajectories::{Column, Trajectories, TrajectoryError, Values, trajectories};
pub use users::{MOST_AT_ONCE, User, UsersError, batches, train_at_once};
