//! A trained policy, ready to act.

use myo_env::EnvSpec;
use rayon::prelude::*;

use crate::networks::{CHUNK_ROWS, ChunkWork, Lender, Networks};
use crate::normalizer::Normalizer;
use crate::{PpoConfig, TrainError, gaussian};

/// Weights, scaling of observations and mapping of actions; knows neither rewards nor how it was trained.
pub struct Policy {
    pub(crate) networks: Networks,
    pub(crate) parameters: Vec<f32>,
    pub(crate) normalizer: Normalizer,
    pub(crate) mapping: (f32, f32),
    pub(crate) observation_names: Vec<String>,
    pub(crate) action_names: Vec<String>,
    pub(crate) normalized: Vec<f32>,
    pub(crate) lender: Lender<ChunkWork>,
}

impl Policy {
    pub(crate) fn new(
        spec: (&[String], &[String]),
        networks: Networks,
        config: &PpoConfig,
        parameters: Vec<f32>,
        normalizer: Normalizer,
    ) -> Self {
        Self {
            networks,
            parameters,
            normalizer,
            mapping: (config.action_offset as f32, config.action_scale as f32),
            observation_names: spec.0.to_vec(),
            action_names: spec.1.to_vec(),
            normalized: Vec::new(),
            lender: Lender::new(),
        }
    }

    /// Names of the observations that the policy was trained on, in order.
    pub fn observation_names(&self) -> &[String] {
        &self.observation_names
    }

    /// Names of the actions, in order.
    pub fn action_names(&self) -> &[String] {
        &self.action_names
    }

    /// Refuses an environment whose observations or actions are not those of the training.
    pub fn check(&self, spec: &EnvSpec) -> Result<(), TrainError> {
        check_names("the list of observations", &spec.observation_names, &self.observation_names)?;
        check_names("the list of actions", &spec.action_names, &self.action_names)
    }

    /// The policy for another environment, with observations and actions matched by name. Observations that are new to it do
    /// not influence it; those that the environment lacks count as average.
    ///
    /// # Errors
    /// No observation is known, or an action is not.
    pub fn for_environment(&self, spec: &EnvSpec) -> Result<Self, TrainError> {
        crate::inherit::policy_for(self, spec)
    }

    /// Mean action for every row of `observation`, `(.., observations)`, into `actions`, `(.., actions)` in [-1, 1].
    ///
    /// Rows may be any number; chunks of them run in parallel.
    ///
    /// # Panics
    /// If the two slices do not hold the same number of rows.
    pub fn act_deterministic(&mut self, observation: &[f32], actions: &mut [f32]) {
        let net = &self.networks.policy;
        let (n_obs, n_act) = (net.inputs(), net.outputs());
        assert_eq!(observation.len() * n_act, actions.len() * n_obs, "observations and actions differ in rows");
        self.normalized.resize(observation.len(), 0.0);
        let parameters = &self.parameters[self.networks.policy_range()];
        (observation.par_chunks(CHUNK_ROWS * n_obs))
            .zip(self.normalized.par_chunks_mut(CHUNK_ROWS * n_obs))
            .zip(actions.par_chunks_mut(CHUNK_ROWS * n_act))
            .for_each(|((raw, x), actions)| {
                self.normalizer.apply(raw, x);
                self.lender.with(
                    || self.networks.work(),
                    |work| gaussian::map_actions(net.forward(parameters, x, &mut work.policy), self.mapping, actions),
                );
            });
    }
}

/// Compares two lists of names; the error tells the first difference.
pub(crate) fn check_names(what: &'static str, got: &[String], expected: &[String]) -> Result<(), TrainError> {
    if got == expected {
        return Ok(());
    }
    let differ = (0..got.len().max(expected.len())).find(|&i| got.get(i) != expected.get(i)).unwrap_or(0);
    let tell = |names: &[String]| match names.get(differ) {
        Some(name) => format!("{} long with \"{name}\" at place {differ}", names.len()),
        None => format!("{} long", names.len()),
    };
    Err(TrainError::Mismatch { what, got: tell(got), expected: tell(expected) })
}
