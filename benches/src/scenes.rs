//! The scenes that are measured, as they stand in `scenes.json`.

use std::sync::LazyLock;

use myo_dynamics::{CouplingMode, Plan, StaticBox};
use myo_model::{Model, builtin};
use myo_scalar::symbolic::Form;
use myo_tasks::{Observation, Task};
use myo_train::PpoConfig;
use serde::Deserialize;

/// All of them.
pub static SCENES: LazyLock<Scenes> =
    LazyLock::new(|| serde_json::from_str(include_str!("../scenes.json")).expect("scenes.json holds scenes"));

/// What `scenes.json` holds.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenes {
    /// Physics alone.
    pub physics: Vec<PhysicsScene>,
    /// The whole environment.
    pub environment: EnvScenes,
    /// Networks and updates.
    pub learner: LearnerScenes,
    /// Kernels for graphics cards.
    pub kernels: KernelScenes,
}

/// Physics alone.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhysicsScene {
    /// Name of the bench.
    pub name: String,
    /// A built-in model.
    pub model: String,
    /// `exact` or `specialised`.
    plan: PlanKind,
    /// Height of a table under the hand, if there is one (m above the shoulder).
    pub table_z_m: Option<f64>,
    /// Excitations are drawn from 0 to this.
    #[serde(default = "one")]
    pub excitation_max: f32,
}

fn one() -> f32 {
    1.0
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum PlanKind {
    Exact,
    Specialised,
}

impl PhysicsScene {
    /// The compiled model.
    pub fn plan(&self) -> Plan<f64> {
        let exact = Plan::exact(&model(&self.model), CouplingMode::Reduced).expect("built-in models compile");
        match self.plan {
            PlanKind::Exact => exact,
            PlanKind::Specialised => exact.specialised(),
        }
    }

    /// What there is to touch: nothing, or a table of two metres by two.
    pub fn boxes(&self) -> Vec<StaticBox> {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let table = |z: f64| StaticBox::new([0.0, 0.0, z - 0.5], axes, [1.0, 1.0, 0.5]);
        self.table_z_m.map(table).into_iter().collect()
    }
}

/// The whole environment.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvScenes {
    /// Control steps on lanes, one core.
    pub step: Vec<EnvScene>,
    /// Resets of all environments.
    pub reset: Vec<EnvScene>,
    /// Control steps in double precision.
    pub reference: Vec<EnvScene>,
    /// Control steps on a graphics card.
    pub card: Vec<EnvScene>,
}

/// Environments of one task.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvScene {
    /// Name of the bench.
    pub name: String,
    /// A preset.
    task: String,
    /// Environments side by side.
    pub envs: usize,
    /// Other parts of the observation than the preset's.
    observation: Option<Observation>,
}

impl EnvScene {
    /// Task and body.
    pub fn task_and_model(&self) -> (Task, Model) {
        let (mut task, model) = task_and_model(&self.task);
        if let Some(observation) = &self.observation {
            task.observation = observation.clone();
        }
        (task, model)
    }
}

/// Networks and updates.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearnerScenes {
    /// Forward and backward passes.
    pub networks: Vec<NetworkScene>,
    /// Advantages of a roll-out.
    pub advantages: Vec<RolloutScene>,
    /// Whole updates.
    pub updates: Vec<UpdateScene>,
    /// Whole updates on a graphics card.
    pub card: Vec<CardUpdateScene>,
}

/// Forward and backward passes.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkScene {
    /// Name of the bench.
    pub name: String,
    /// Widths of the hidden layers of the policy.
    pub policy: Vec<usize>,
    /// Widths of the hidden layers of the value network.
    pub value: Vec<usize>,
    /// Samples of a pass.
    pub samples: usize,
}

/// A roll-out of made-up numbers.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RolloutScene {
    /// Name of the bench.
    pub name: String,
    /// Environments side by side.
    pub envs: usize,
    /// Control steps of each.
    pub steps: usize,
}

/// A whole update: acting in an idle environment, and learning.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct UpdateScene {
    /// Name of the bench.
    pub name: String,
    /// Settings of the learner that are not the defaults.
    pub settings: PpoConfig,
}

/// A whole update on a graphics card: acting in a task, and learning.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CardUpdateScene {
    /// Name of the bench.
    pub name: String,
    /// A preset.
    task: String,
    /// Settings of the learner that are not the defaults.
    pub settings: PpoConfig,
}

impl CardUpdateScene {
    /// Task and body.
    pub fn task_and_model(&self) -> (Task, Model) {
        task_and_model(&self.task)
    }
}

/// Kernels for graphics cards.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KernelScenes {
    /// Recording and printing; needs no card.
    pub record: Vec<KernelScene>,
    /// From nothing to environments that can be stepped.
    pub card: Vec<EnvScene>,
}

/// A kernel of a task.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KernelScene {
    /// Name of the bench.
    pub name: String,
    /// A preset.
    task: String,
    /// Which of its kernels.
    pub kernel: KernelKind,
    form: FormName,
}

/// Which kernel of a task.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum KernelKind {
    /// A control step with everything that belongs to it.
    Step,
    /// The physics of a control step.
    Physics,
    /// The reset.
    Reset,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum FormName {
    Straight,
    Loops,
}

impl KernelScene {
    /// Task and body.
    pub fn task_and_model(&self) -> (Task, Model) {
        task_and_model(&self.task)
    }

    /// How the muscles are written.
    pub fn form(&self) -> Form {
        match self.form {
            FormName::Straight => Form::Straight,
            FormName::Loops => Form::Loops,
        }
    }
}

fn task_and_model(preset: &str) -> (Task, Model) {
    let task = myo_tasks::preset(preset).unwrap_or_else(|| panic!("there is no preset `{preset}`"));
    let model = model(&task.model);
    (task, model)
}

fn model(name: &str) -> Model {
    Model::new(&builtin(name).expect("scenes name built-in models")).expect("built-in models are right")
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::{EnvScene, SCENES};

    #[test]
    fn names_are_unique_within_their_group() {
        let names = |scenes: &'static [EnvScene]| scenes.iter().map(|s| s.name.as_str()).collect();
        let groups: [Vec<&str>; 8] = [
            SCENES.physics.iter().map(|s| s.name.as_str()).collect(),
            names(&SCENES.environment.step),
            names(&SCENES.environment.reset),
            names(&SCENES.environment.reference),
            names(&SCENES.environment.card),
            SCENES.learner.networks.iter().map(|s| s.name.as_str()).collect(),
            SCENES.learner.updates.iter().map(|s| s.name.as_str()).collect(),
            SCENES.kernels.record.iter().map(|s| s.name.as_str()).collect(),
        ];
        for group in groups {
            assert!(!group.is_empty());
            assert_eq!(group.iter().collect::<HashSet<_>>().len(), group.len(), "{group:?}");
        }
    }
}
