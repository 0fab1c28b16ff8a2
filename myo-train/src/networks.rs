//! The two networks and the spread, in one flat vector of parameters; memory for passes over a chunk of samples.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use myo_env::EnvSpec;

use crate::mlp::{Mlp, MlpWork};
use crate::{PpoConfig, gaussian::Spread};

/// Samples that go through the networks at a time. Large enough for faer's matrix product to run at its full speed, small
/// enough that the activations of one chunk stay in the second-level cache; the same for any number of threads.
pub const CHUNK_ROWS: usize = 128;

/// Where the networks lie in the parameters: policy, logarithms of the standard deviations, value.
#[derive(Clone, Debug, PartialEq)]
pub struct Networks {
    /// From observations to mean actions.
    pub policy: Mlp,
    /// From observations to the discounted sum of future rewards.
    pub value: Mlp,
}

impl Networks {
    /// Networks for an environment.
    pub fn new(spec: &EnvSpec, config: &PpoConfig) -> Self {
        Self {
            policy: Mlp::new(spec.observation_size(), &config.policy_hidden, spec.action_size()),
            value: Mlp::new(spec.observation_size(), &config.value_hidden, 1),
        }
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.value_range().end
    }

    /// Place of the policy.
    pub fn policy_range(&self) -> Range<usize> {
        0..self.policy.len()
    }

    /// Place of the logarithms of the standard deviations.
    pub fn log_std_range(&self) -> Range<usize> {
        self.policy.len()..self.policy.len() + self.policy.outputs()
    }

    /// Place of the value network.
    pub fn value_range(&self) -> Range<usize> {
        let start = self.log_std_range().end;
        start..start + self.value.len()
    }

    /// Initial parameters.
    pub fn initialize(&self, seed: u64, config: &PpoConfig, control_dt: f64) -> Vec<f32> {
        let mut parameters = vec![0.0; self.len()];
        self.policy.initialize(seed, 0, 0.01, &mut parameters[self.policy_range()]);
        self.value.initialize(seed, 1, 1.0, &mut parameters[self.value_range()]);
        parameters[self.log_std_range()].fill(config.log_std(control_dt).initial as f32);
        parameters
    }

    /// The spread that belongs to `parameters`.
    pub fn spread(&self, parameters: &[f32]) -> Spread {
        Spread::new(&parameters[self.log_std_range()])
    }

    /// Memory for one chunk.
    pub fn work(&self) -> ChunkWork {
        let (observations, actions) = (self.policy.inputs(), self.policy.outputs());
        ChunkWork {
            observation: vec![0.0; CHUNK_ROWS * observations],
            action: vec![0.0; CHUNK_ROWS * actions],
            noise: vec![0.0; CHUNK_ROWS * noise_width(actions)],
            held: vec![0.0; CHUNK_ROWS * noise_width(actions)],
            scalars: [const { [0.0; CHUNK_ROWS] }; 3],
            policy: self.policy.work(CHUNK_ROWS),
            value: self.value.work(CHUNK_ROWS),
        }
    }
}

/// Noise drawn per action vector: whole blocks of four numbers.
pub fn noise_width(actions: usize) -> usize {
    actions.next_multiple_of(4)
}

/// Memory for one chunk of samples.
pub struct ChunkWork {
    /// Normalised observations.
    pub observation: Vec<f32>,
    /// Actions.
    pub action: Vec<f32>,
    /// Standard normal numbers.
    pub noise: Vec<f32>,
    /// Sums of those of earlier steps.
    pub held: Vec<f32>,
    /// Old log probability, advantage and value target.
    pub scalars: [[f32; CHUNK_ROWS]; 3],
    /// For the policy network.
    pub policy: MlpWork,
    /// For the value network.
    pub value: MlpWork,
}

/// Memory lent to whichever thread asks, as many pieces as were ever in use at once.
///
/// Results must not depend on what is left in a piece.
pub struct Lender<T> {
    free: Mutex<Vec<T>>,
}

impl<T> Lender<T> {
    /// Nothing to lend yet.
    pub fn new() -> Self {
        Self { free: Mutex::new(Vec::new()) }
    }

    /// Calls `body` with a piece, made by `make` when all are in use.
    pub fn with<R>(&self, make: impl FnOnce() -> T, body: impl FnOnce(&mut T) -> R) -> R {
        // A panic elsewhere leaves the list itself whole.
        let piece = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut piece = piece.unwrap_or_else(make);
        let result = body(&mut piece);
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(piece);
        result
    }
}
