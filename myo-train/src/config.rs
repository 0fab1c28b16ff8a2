//! Every hyperparameter of the learner, in one place.

use myo_env::EnvConfig;
use myo_tasks::User;
use schemars::JsonSchema;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use thiserror::Error;

use crate::gaussian::Bound;

/// Settings of PPO. The defaults train the built-in arm to point on two processor cores.
///
/// One "control step" is one action of one environment. What has to do with time is in simulated seconds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PpoConfig {
    /// Environments stepped side by side (default 4,096). More of them give steadier gradients per update and need
    /// more control steps in all.
    pub num_envs: usize,
    /// Simulated seconds of every environment between two updates (default 0.1), rounded to whole control steps, at least one.
    /// Longer roll-outs lean less on the value network, and update less often.
    pub rollout_s: f64,
    /// Share of the environments, at most 0.9, whose episodes begin in the middle of the task (default 0.75): in one of many
    /// poses, with any of the targets, mostly with the one that the environment failed at before. Otherwise a target that is
    /// not done hides all that come after it, and a posture in which the arm rests near a target hides the one in which it
    /// would do it. These episodes are learned from, and counted nowhere: success and times are those of whole episodes.
    pub exploring_starts: f64,
    /// Passes over the collected samples in one update (default 2). More learn more from the same samples, until
    /// the policy has moved too far from the one that collected them.
    pub epochs: usize,
    /// Gradient steps per pass (default 8); each sees an equal share of the samples.
    pub minibatches: usize,
    /// Widths of the hidden layers of the policy (default 128, 128).
    pub policy_hidden: Vec<usize>,
    /// Widths of the hidden layers of the value network (default 128, 128).
    pub value_hidden: Vec<usize>,

    /// What a reward one second of simulated time ahead counts, in [0, 1) (default 0.5, that is 0.966 per control step at
    /// 20 Hz: a reward counts half after a second). Lower learns sooner, higher plans further: with 0.36 the arm stops short
    /// of targets that it must go round to reach. Per second, so that a task with other control steps looks as far ahead.
    pub discount_per_s: f64,
    /// What is left of the advantage estimate's weight after one second, in [0, 1] (default 0.12, that is a decay of 0.9 per
    /// control step at 20 Hz). 0 trusts the value network alone, 1 the returns alone.
    pub gae_lambda_per_s: f64,
    /// The probability ratio of an action earns nothing beyond 1 plus or minus this (default 0.2), times the root of the steps for
    /// which exploration noise stays.
    pub clip: f64,
    /// Weight of the policy's entropy, summed over actions, in nats (default 0.005). Higher keeps exploring longer.
    pub entropy_coefficient: f64,
    /// Weight of the squared distance by which the mean of an action lies beyond where muscles can follow, in units of the policy's output
    /// (default 0). A muscle that is asked for more than all, or for less than nothing by more than the noise, does not feel a small change of what it
    /// is asked for, and does not learn to do anything else.
    pub bound_coefficient: f64,
    /// What an advantage counts for at most, for better or worse, in units of reward (default 0), where it is not 0. A single environment that goes to ruin, such as an
    /// arm in cramps, may otherwise weigh as much as all others. Errors of the value network are bounded alike.
    pub advantage_max: f64,
    /// Weight of the mean squared error of the value network (default 0.5).
    pub value_coefficient: f64,
    /// Rewards are multiplied by this before learning (default 1); metrics show them unscaled.
    pub reward_scale: f64,

    /// Step size of Adam at the start (default 1e-3); then controlled by the divergence of the policy.
    pub learning_rate: f64,
    /// The step size never falls below this (default 1e-5).
    pub learning_rate_min: f64,
    /// The step size never rises above this (default 1e-2).
    pub learning_rate_max: f64,
    /// Divergence from the collecting policy that one update should reach, mean over its last pass, in nats (default
    /// 0.06). It is divided by the steps for which exploration noise stays, so that it tells of the same movement at any control
    /// rate. 0 keeps the step size fixed. Larger moves faster and may collapse.
    pub kl_target: f64,
    /// The step size is divided by `kl_factor` when the divergence is above `kl_target * kl_tolerance`, multiplied by it
    /// below `kl_target / kl_tolerance` (default 1.5).
    pub kl_factor: f64,
    /// See `kl_factor` (default 1.5).
    pub kl_tolerance: f64,
    /// An update that moves the policy further than this, in nats, has gone astray and is taken back (default 1).
    pub kl_max: f64,
    /// Decay of Adam's mean gradient per gradient step (default 0.9).
    pub adam_beta1: f64,
    /// Decay of Adam's mean squared gradient per gradient step (default 0.999).
    pub adam_beta2: f64,
    /// Added to the root of the mean squared gradient (default 1e-5); keeps steps small where gradients are tiny.
    pub adam_epsilon: f64,
    /// Longer gradients, over all parameters together, are shortened to this length (default 1).
    pub gradient_norm_max: f64,

    /// Logarithm of the standard deviation of the policy at the start, in units of the policy's output (default -0.7,
    /// that is 0.5). One learned number per action, the same in every state.
    pub log_std_initial: f64,
    /// Seconds for which an action's noise stays in the actions after it (default 0.05), rounded to whole control steps, at least
    /// one. The noise of an action is the sum of its own draw and those that are left, and has the standard deviation above. Noise
    /// that changed with every one of many small steps would cancel out before muscles feel it.
    pub exploration_s: f64,
    /// The logarithm of the standard deviation never falls below this (default -1.6, that is 0.2). Steps of a given divergence
    /// are as short as the spread is small, so learning stands still where it vanishes.
    pub log_std_min: f64,
    /// The logarithm of the standard deviation never rises above this (default 0.5).
    pub log_std_max: f64,
    /// Simulated seconds in which the share of what movement costs that counts may grow by a factor of 4096, from next to nothing to all
    /// (default 1e5, that is 2 million control steps at 20 Hz); great shares grow more slowly. What counts never comes to more than two thirds of what targets
    /// earn: whom every movement costs dear before any has led anywhere learns to keep still, and does not learn otherwise later. When nothing improves
    /// with less, it comes to be all. 0 lets all of it count from the start. After Schumacher et al. 2023
    /// (doi 10.48550/arXiv.2309.02976), whose cost of effort follows the performance.
    pub cost_ramp_s: f64,
    /// The environment gets `clip(action_offset + action_scale * a, -1, 1)` for the policy's output `a` (default -0.5).
    /// For muscles, whose control is `(1 + action) / 2`, the defaults mean `clip(0.25 + 0.5 a, 0, 1)`: a new policy
    /// holds them at a quarter, rather than at half strength against each other.
    pub action_offset: f64,
    /// See `action_offset` (default 1).
    pub action_scale: f64,

    /// Normalised observations are held within plus or minus this many standard deviations (default 5).
    pub observation_clip: f64,
    /// Least standard deviation of an observation, relative to the larger of 1 and its mean's size (default 0.05); see
    /// `Normalizer`.
    pub observation_std_floor: f64,

    /// Whether a graphics card that has matrix units learns with them (default true): activations and gradients have 16
    /// bits, sums and parameters 32. Where a layer has more than 256 inputs or outputs, on other cards, and on the
    /// processor, all have 32 bits.
    pub matrix_units: bool,
}

impl Default for PpoConfig {
    fn default() -> Self {
        Self {
            num_envs: 4096,
            rollout_s: 0.1,
            exploring_starts: 0.75,
            epochs: 2,
            minibatches: 8,
            policy_hidden: vec![128, 128],
            value_hidden: vec![128, 128],
            discount_per_s: 0.5,
            gae_lambda_per_s: 0.12,
            clip: 0.2,
            entropy_coefficient: 0.005,
            bound_coefficient: 0.0,
            advantage_max: 0.0,
            value_coefficient: 0.5,
            reward_scale: 1.0,
            learning_rate: 1e-3,
            learning_rate_min: 1e-5,
            learning_rate_max: 1e-2,
            kl_target: 0.06,
            kl_factor: 1.5,
            kl_tolerance: 1.5,
            kl_max: 1.0,
            adam_beta1: 0.9,
            adam_beta2: 0.999,
            adam_epsilon: 1e-5,
            gradient_norm_max: 1.0,
            log_std_initial: -0.7,
            exploration_s: 0.05,
            log_std_min: -1.6,
            log_std_max: 0.5,
            cost_ramp_s: 1e5,
            action_offset: -0.5,
            action_scale: 1.0,
            observation_clip: 5.0,
            observation_std_floor: 0.05,
            matrix_units: true,
        }
    }
}

/// Coordinates from which on a body is large, and environments of one.
const LARGE_BODY: usize = 20;
const MANY_ENVS: usize = 16_384;

/// Logarithms of the standard deviations of one draw of exploration noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogStd {
    /// At the start.
    pub initial: f64,
    /// Least.
    pub min: f64,
    /// Greatest.
    pub max: f64,
}

/// A band that grows with the steps of exploration still has a lower end.
const WIDEST_CLIP: f64 = 0.9;

/// Longest time for which noise stays (s): a card makes all draws of it again for each action.
const LONGEST_EXPLORATION_S: f64 = 1.0;

/// Longest time (s) in which costs grow.
const LONGEST_RAMP_S: f64 = 1e9;

/// Longest roll-out (s).
const LONGEST_S: f64 = 600.0;

/// Seconds per control step of settings that were given per control step.
pub(crate) const OLD_CONTROL_DT: f64 = 0.05;

/// A time in whole control steps, at least one.
fn whole_steps(time_s: f64, control_dt: f64) -> usize {
    ((time_s / control_dt).round() as usize).max(1)
}

/// Of so many environments one acts without noise.
const NOISE_FREE: usize = 64;

/// A hyperparameter outside its range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{name} is {value}; it must be {range}")]
pub struct ConfigError {
    /// Field of [`PpoConfig`].
    pub name: &'static str,
    /// Its value.
    pub value: String,
    /// What is allowed.
    pub range: &'static str,
}

impl PpoConfig {
    /// Control steps of every environment between two updates, with control steps of `control_dt` seconds.
    pub fn steps_per_update(&self, control_dt: f64) -> usize {
        whole_steps(self.rollout_s, control_dt)
    }

    /// Samples of one update.
    pub fn batch_size(&self, control_dt: f64) -> usize {
        self.num_envs * self.steps_per_update(control_dt)
    }

    /// Draws that the exploration noise of one action is the sum of.
    pub fn exploration_steps(&self, control_dt: f64) -> usize {
        whole_steps(self.exploration_s, control_dt)
    }

    /// Greatest distance of a probability ratio from 1. A draw that stays in several actions is spread over as many samples, each of
    /// which tells less of the policy's movement, and more of its own draw.
    pub(crate) fn ratio_clip(&self, control_dt: f64) -> f32 {
        (self.clip * (self.exploration_steps(control_dt) as f64).sqrt()).min(WIDEST_CLIP.max(self.clip)) as f32
    }

    /// What the logarithms of the standard deviations of a control step's own noise begin with and are kept within: with as many
    /// draws in an action as [`exploration_steps`](Self::exploration_steps) says, their sum has the deviation that the settings say.
    pub(crate) fn log_std(&self, control_dt: f64) -> LogStd {
        let less = 0.5 * (self.exploration_steps(control_dt) as f64).ln();
        let Self { log_std_initial, log_std_min, log_std_max, .. } = self;
        LogStd { initial: log_std_initial - less, min: log_std_min - less, max: log_std_max - less }
    }

    /// Decay of the advantage estimate per control step, often called lambda.
    pub fn gae_lambda(&self, control_dt: f64) -> f64 {
        self.gae_lambda_per_s.powf(control_dt)
    }

    /// The first so many environments act without noise: how good the policy itself has become is told by them at no cost. Their
    /// actions teach it nothing.
    pub fn noise_free_envs(&self) -> usize {
        self.num_envs / NOISE_FREE
    }

    /// The environments to train in.
    pub fn envs(&self, seed: u64) -> EnvConfig {
        let exploring = (self.exploring_starts * self.num_envs as f64) as usize;
        EnvConfig { num_envs: self.num_envs, seed, exploring, ..EnvConfig::default() }
    }

    /// The same for a body of so many coordinates. A large one keeps a card busy with four times as many environments, which learn no
    /// worse from as many control steps: of `myoarm_r` (27 coordinates) users who reach for balls had 71 % success after 48 million and 98.6 %
    /// after 164 million in a minute and a half, where a quarter of the environments came to 66 % after 50 and 77 % after 84 million.
    pub fn on_body(self, coordinates: usize) -> Self {
        let num_envs = if coordinates < LARGE_BODY { self.num_envs } else { MANY_ENVS };
        Self { num_envs, ..self }
    }

    /// What users of a kind learn with where nothing else is said.
    ///
    /// The defaults learn fast. A human user must stay in small targets in spite of noise, and with muscles that cost
    /// something: costs grow slowly, it learns in smaller steps from longer roll-outs with a larger policy, and what it
    /// explores with is small and may fade, and grows in no muscle that is at rest, where it would go unnoticed. Its steps
    /// may become shorter, for the less it explores, the shorter is one of a given divergence. Its first updates run away
    /// with steps of 1e-3, and do not with a quarter of that.
    pub fn for_user(user: User) -> Self {
        if !user.is_human() {
            return Self::default();
        }
        Self {
            rollout_s: 0.4,
            learning_rate: 2.5e-4,
            learning_rate_min: 1e-6,
            entropy_coefficient: 0.0003,
            bound_coefficient: 1.0,
            advantage_max: 6.0,
            log_std_initial: -1.4,
            log_std_min: -5.0,
            log_std_max: -1.4,
            action_offset: -0.8,
            policy_hidden: vec![256, 256],
            cost_ramp_s: 1e6,
            ..Self::default()
        }
    }

    /// What users of a kind learn with, with the networks of these settings: what a warm start begins with.
    pub fn with_learning_of(&self, user: User) -> Self {
        let Self { policy_hidden, value_hidden, .. } = self.clone();
        Self { policy_hidden, value_hidden, ..Self::for_user(user) }
    }

    /// Discount per control step of `control_dt` seconds, often called gamma.
    pub fn gamma(&self, control_dt: f64) -> f64 {
        self.discount_per_s.powf(control_dt)
    }

    /// Where means of actions are held.
    pub(crate) fn bound(&self) -> Bound {
        let reached = |control: f64| ((control - self.action_offset) / self.action_scale) as f32;
        Bound { least: reached(-1.0), most: reached(1.0), factor: 2.0 * self.bound_coefficient as f32 }
    }

    /// Settings as they were written up to format 3 of checkpoints, in today's words: control steps were those of 20 Hz.
    pub fn modernised(mut saved: Value) -> Value {
        let Some(fields) = saved.as_object_mut() else { return saved };
        if let Some(steps) = fields.remove("steps_per_update").as_ref().and_then(Value::as_f64) {
            fields.insert("rollout_s".into(), (steps * OLD_CONTROL_DT).into());
        }
        if let Some(lambda) = fields.remove("gae_lambda").as_ref().and_then(Value::as_f64) {
            fields.insert("gae_lambda_per_s".into(), lambda.powf(OLD_CONTROL_DT.recip()).into());
        }
        saved
    }

    /// Refuses values with which no training can work.
    ///
    /// # Errors
    /// The first field whose value is out of its range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        first_unmet(self.checks())
    }

    /// Refuses values with which a training with control steps of `control_dt` seconds cannot work.
    ///
    /// # Errors
    /// The first field whose value is out of its range.
    pub fn validate_for(&self, control_dt: f64) -> Result<(), ConfigError> {
        self.validate()?;
        let samples = self.num_envs.saturating_mul(self.steps_per_update(control_dt));
        let check = |is_met, name, value: usize, range| Check { name, value: value.to_string(), range, is_met };
        let most = "such that a batch has at most 2^30 samples";
        let share = "from 1 to the samples of a batch";
        first_unmet(vec![
            check(samples <= 1 << 30, "num_envs", self.num_envs, most),
            check(self.minibatches <= samples, "minibatches", self.minibatches, share),
        ])
    }

    /// What is allowed for each field that has a range, in words.
    pub fn ranges() -> Vec<(&'static str, &'static str)> {
        Self::default().checks().into_iter().map(|Check { name, range, .. }| (name, range)).collect()
    }

    /// Everything that [`validate`](Self::validate) looks at.
    fn checks(&self) -> Vec<Check> {
        let mut checks = Vec::new();
        let mut check = |is_met: bool, name, value: &dyn std::fmt::Debug, range| {
            checks.push(Check { name, value: format!("{value:?}"), range, is_met });
        };
        for (name, value) in [("epochs", self.epochs), ("minibatches", self.minibatches)] {
            check(value >= 1, name, &value, "at least 1");
        }
        check((1..=1 << 30).contains(&self.num_envs), "num_envs", &self.num_envs, "from 1 to 2^30");
        check((0.0..=LONGEST_S).contains(&self.rollout_s), "rollout_s", &self.rollout_s, "from 0 to 600");
        check((0.0..=LONGEST_RAMP_S).contains(&self.cost_ramp_s), "cost_ramp_s", &self.cost_ramp_s, "from 0 to 1e9");
        let stays = self.exploration_s;
        check((0.0..=LONGEST_EXPLORATION_S).contains(&stays), "exploration_s", &stays, "from 0 to 1");
        for (name, widths) in [("policy_hidden", &self.policy_hidden), ("value_hidden", &self.value_hidden)] {
            let is_met = widths.iter().all(|&w| (1..=8192).contains(&w));
            check(is_met, name, widths, "a list of widths from 1 to 8192");
        }
        for (name, value) in
            [("discount_per_s", self.discount_per_s), ("adam_beta1", self.adam_beta1), ("adam_beta2", self.adam_beta2)]
        {
            check((0.0..1.0).contains(&value), name, &value, "at least 0 and less than 1");
        }
        let starts = self.exploring_starts;
        check((0.0..=0.9).contains(&starts), "exploring_starts", &starts, "from 0 to 0.9");
        let lambda = self.gae_lambda_per_s;
        check((0.0..=1.0).contains(&lambda), "gae_lambda_per_s", &lambda, "from 0 to 1");
        for (name, value) in [
            ("entropy_coefficient", self.entropy_coefficient),
            ("bound_coefficient", self.bound_coefficient),
            ("advantage_max", self.advantage_max),
            ("value_coefficient", self.value_coefficient),
            ("kl_target", self.kl_target),
        ] {
            check(value >= 0.0 && value.is_finite(), name, &value, "finite and not negative");
        }
        for (name, value) in [
            ("clip", self.clip),
            ("kl_max", self.kl_max),
            ("reward_scale", self.reward_scale),
            ("learning_rate_min", self.learning_rate_min),
            ("learning_rate_max", self.learning_rate_max),
            ("adam_epsilon", self.adam_epsilon),
            ("gradient_norm_max", self.gradient_norm_max),
            ("action_scale", self.action_scale),
            ("observation_clip", self.observation_clip),
            ("observation_std_floor", self.observation_std_floor),
        ] {
            check(value > 0.0 && value.is_finite(), name, &value, "finite and greater than 0");
        }
        for (name, value) in [("kl_factor", self.kl_factor), ("kl_tolerance", self.kl_tolerance)] {
            check(value >= 1.0 && value.is_finite(), name, &value, "finite and at least 1");
        }
        let rates = self.learning_rate_min..=self.learning_rate_max;
        let range = "between learning_rate_min and learning_rate_max";
        check(rates.contains(&self.learning_rate), "learning_rate", &self.learning_rate, range);
        let log_std = self.log_std_min..=self.log_std_max;
        let range = "between log_std_min and log_std_max";
        check(log_std.contains(&self.log_std_initial), "log_std_initial", &self.log_std_initial, range);
        check(self.log_std_min >= -20.0, "log_std_min", &self.log_std_min, "at least -20");
        check(self.log_std_max <= 20.0, "log_std_max", &self.log_std_max, "at most 20");
        check(self.action_offset.is_finite(), "action_offset", &self.action_offset, "finite");
        checks
    }
}

/// Reads settings that a run keeps, for `deserialize_with`; see [`PpoConfig::modernised`].
///
/// # Errors
/// They are no settings.
pub fn saved_settings<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PpoConfig, D::Error> {
    let saved = PpoConfig::modernised(Value::deserialize(deserializer)?);
    serde_json::from_value(saved).map_err(D::Error::custom)
}

/// A field with a range.
struct Check {
    name: &'static str,
    value: String,
    range: &'static str,
    is_met: bool,
}

fn first_unmet(checks: Vec<Check>) -> Result<(), ConfigError> {
    match checks.into_iter().find(|check| !check.is_met) {
        Some(Check { name, value, range, .. }) => Err(ConfigError { name, value, range }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_are_valid_and_missing_keys_take_them() {
        User::ALL.map(PpoConfig::for_user).iter().for_each(|config| config.validate().unwrap());
        let config: PpoConfig = serde_json::from_str(r#"{"discount_per_s": 0.9}"#).unwrap();
        assert_eq!(config, PpoConfig { discount_per_s: 0.9, ..PpoConfig::default() });
    }

    #[test]
    fn every_description_names_the_default() {
        let schema = serde_json::to_value(schemars::schema_for!(PpoConfig)).unwrap();
        let defaults = serde_json::to_value(PpoConfig::default()).unwrap();
        for (name, default) in defaults.as_object().unwrap() {
            let description = schema["properties"][name]["description"].as_str().unwrap().replace('\n', " ");
            let told = description.split("(default ").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
            let numbers = |text: &str| -> Vec<f64> {
                let plain = text.replace("4,096", "4096");
                plain.split(", ").map_while(|number| number.parse().ok()).collect()
            };
            let is_told = match default {
                Value::Array(list) => numbers(told) == list.iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>(),
                Value::Number(number) => numbers(told)[0] == number.as_f64().unwrap(),
                other => *other == told.parse::<bool>().unwrap(),
            };
            assert!(is_told, "{name}: {default}, described as {told}");
        }
    }

    #[test]
    fn settings_mean_the_same_at_any_control_rate() {
        let config = PpoConfig::default();
        for (control_dt, steps, noise) in [(0.1, 1, 1), (0.05, 2, 1), (0.02, 5, 3), (0.01, 10, 5)] {
            assert_eq!((config.steps_per_update(control_dt), config.exploration_steps(control_dt)), (steps, noise));
            let per_second = config.gae_lambda(control_dt).powf(control_dt.recip());
            assert!((per_second - config.gae_lambda_per_s).abs() < 1e-12);
            // The deviations of all draws that lie in an action add up to the one that was asked for.
            let own = config.log_std(control_dt).initial.exp();
            assert!((own * (noise as f64).sqrt() - config.log_std_initial.exp()).abs() < 1e-12);
            assert!((f64::from(config.ratio_clip(control_dt)) - 0.2 * (noise as f64).sqrt()).abs() < 1e-6);
        }
        let wide = PpoConfig { clip: 0.5, ..config };
        assert_eq!(wide.ratio_clip(0.001), 0.9, "a ratio is clipped from below, too");
    }

    #[test]
    fn settings_per_control_step_are_read_as_those_of_20_hz() {
        let old = serde_json::json!({"num_envs": 8, "steps_per_update": 16, "gae_lambda": 0.9});
        let config: PpoConfig = serde_json::from_value(PpoConfig::modernised(old)).unwrap();
        assert_eq!((config.num_envs, config.steps_per_update(0.05)), (8, 16));
        assert!((config.gae_lambda(0.05) - 0.9).abs() < 1e-12);
    }

    #[test]
    fn what_a_batch_is_too_small_or_too_large_for_is_known_with_the_control_step() {
        let few = PpoConfig { num_envs: 3, ..PpoConfig::default() };
        few.validate().unwrap();
        few.validate_for(0.01).unwrap();
        assert_eq!(
            few.validate_for(0.05).unwrap_err().to_string(),
            "minibatches is 8; it must be from 1 to the samples of a batch"
        );
        let many = PpoConfig { num_envs: 1 << 29, rollout_s: 1.0, ..PpoConfig::default() };
        assert_eq!(many.validate_for(0.05).unwrap_err().name, "num_envs");
    }

    #[test]
    fn a_bad_value_is_named_with_its_range() {
        let config = PpoConfig { discount_per_s: 1.0, ..PpoConfig::default() };
        assert_eq!(
            config.validate().unwrap_err().to_string(),
            "discount_per_s is 1.0; it must be at least 0 and less than 1"
        );
        let config = PpoConfig { clip: f64::NAN, ..PpoConfig::default() };
        assert_eq!(config.validate().unwrap_err().to_string(), "clip is NaN; it must be finite and greater than 0");
        assert!(
            serde_json::from_str::<PpoConfig>(r#"{"discount_per_m": 0.9}"#)
                .unwrap_err()
                .to_string()
                .contains("discount_per_m")
        );
    }
}
