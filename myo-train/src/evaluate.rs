//! How well a policy does on fresh episodes.

use myo_env::{Autoreset, EnvSpec, StepStorage, VectorEnv};
use serde::{Deserialize, Serialize};

use crate::{Policy, TrainError};

/// Result of [`evaluate`]. The keys of its JSON form are stable; quantities that do not exist are `null`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Share of episodes in which every target was done.
    pub success: Option<f64>,
    /// 95 % confidence interval of `success` (Wilson 1927, doi 10.1080/01621459.1927.10502953).
    pub success_interval: Option<[f64; 2]>,
    /// Episodes counted.
    pub episodes: u64,
    /// One entry per target, in order.
    pub targets: Vec<TargetEvaluation>,
    /// Mean distance to the last target at the end, in metres.
    pub final_distance_m: Option<f64>,
    /// Mean squared control.
    pub effort: Option<f64>,
    /// Mean duration of an episode, in seconds.
    pub episode_length_s: Option<f64>,
    /// Mean sum of rewards of an episode.
    #[serde(rename = "return")]
    pub episode_return: Option<f64>,
}

/// One target's part of an [`Evaluation`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetEvaluation {
    /// Share of all episodes in which the target was done.
    pub success: f64,
    /// Mean time from the target's start to its end where it was done, in seconds.
    pub movement_time_s: Option<f64>,
    /// Standard deviation of these times, in seconds.
    pub movement_time_s_sd: Option<f64>,
}

/// Runs the mean actions of `policy` in `env` until `episodes` episodes have ended.
///
/// `seed` restarts the environments. Every environment counts its first few episodes, equally many up to one: were the
/// first ones to end anywhere counted, short episodes, mostly the successful ones, would be over-represented.
/// `progress` hears how many are counted; when it returns false the evaluation ends early with those.
pub fn evaluate(
    policy: &mut Policy,
    env: &mut dyn VectorEnv,
    episodes: usize,
    seed: u64,
    mut progress: impl FnMut(usize) -> bool,
) -> Result<Evaluation, TrainError> {
    let spec = env.spec().clone();
    check(policy, &spec)?;
    let mut step = StepStorage::new(&spec);
    let mut actions = vec![0.0; spec.num_envs * spec.action_size()];
    let mut tally = Tally::new(episodes, spec.num_envs);
    env.reset(Some(seed), None, &mut step.observation)?;
    while !tally.is_full() {
        policy.act_deterministic(&step.observation, &mut actions);
        env.step(&actions, step.buffers())?;
        for i in 0..spec.num_envs {
            if step.terminated[i] || step.truncated[i] {
                tally.add(i, step.episode[i * spec.episode_size()..][..spec.episode_size()].iter().copied());
            }
        }
        if !progress(tally.counted) {
            break;
        }
    }
    Ok(tally.evaluation(&spec))
}

/// Refuses environments that do not fit the policy or do not start their episodes again.
pub(crate) fn check(policy: &Policy, spec: &EnvSpec) -> Result<(), TrainError> {
    policy.check(spec)?;
    if spec.autoreset == Autoreset::SameStep {
        return Ok(());
    }
    let (got, expected) = (format!("{:?}", spec.autoreset), "SameStep".into());
    Err(TrainError::Mismatch { what: "the autoreset mode", got, expected })
}

/// Episodes counted so far.
pub(crate) struct Tally {
    episodes: usize,
    /// How many each environment may still count.
    quota: Vec<usize>,
    /// Summaries in the order of the environments, so that sums do not depend on when an episode ended.
    summaries: Vec<Vec<f32>>,
    /// How many there are.
    pub counted: usize,
}

impl Tally {
    /// For so many episodes in so many environments.
    pub fn new(episodes: usize, envs: usize) -> Self {
        let quota = (0..envs).map(|i| episodes / envs + usize::from(i < episodes % envs)).collect();
        Self { episodes, quota, summaries: vec![Vec::new(); envs], counted: 0 }
    }

    /// Whether all are counted.
    pub fn is_full(&self) -> bool {
        self.counted >= self.episodes
    }

    /// Counts an episode that ended in environment `env`, if that may count another one.
    pub fn add(&mut self, env: usize, summary: impl Iterator<Item = f32>) {
        if self.quota[env] > 0 {
            self.quota[env] -= 1;
            self.counted += 1;
            self.summaries[env].extend(summary);
        }
    }

    /// The result.
    pub fn evaluation(&self, spec: &EnvSpec) -> Evaluation {
        Evaluation::new(spec, self.counted, &self.summaries.concat())
    }
}

impl Evaluation {
    /// From the summaries of `episodes` episodes, one row each.
    fn new(spec: &EnvSpec, episodes: usize, summaries: &[f32]) -> Self {
        let column = |name: &str| {
            let index = spec.episode_names.iter().position(|n| n == name)?;
            Some(summaries.iter().skip(index).step_by(spec.episode_size()).map(|&x| f64::from(x)).collect::<Vec<_>>())
        };
        let mean = |name: &str| column(name).and_then(|x| mean_and_sd(&x)).map(|(mean, _)| mean);
        let target = |i: usize| {
            let success = mean(&format!("target_{i}_success"))?;
            let times = column(&format!("target_{i}_time")).and_then(|x| mean_and_sd(&x));
            let (movement_time_s, movement_time_s_sd) = (times.map(|(mean, _)| mean), times.map(|(_, sd)| sd));
            Some(TargetEvaluation { success, movement_time_s, movement_time_s_sd })
        };
        let success = mean("success");
        Self {
            success,
            success_interval: success.map(|share| wilson_interval(share, episodes as f64)),
            episodes: episodes as u64,
            targets: (1..).map_while(target).collect(),
            final_distance_m: mean("final_distance"),
            effort: mean("effort"),
            episode_length_s: mean("length").map(|steps| steps * spec.control_dt),
            episode_return: mean("return"),
        }
    }
}

/// Mean and standard deviation (of the sample) of the entries that are not NaN.
fn mean_and_sd(x: &[f64]) -> Option<(f64, f64)> {
    let x = || x.iter().copied().filter(|x| !x.is_nan());
    let n = x().count() as f64;
    if n == 0.0 {
        return None;
    }
    let mean = x().sum::<f64>() / n;
    let squares: f64 = x().map(|x| (x - mean) * (x - mean)).sum();
    Some((mean, (squares / (n - 1.0).max(1.0)).sqrt()))
}

/// Interval that holds a true share with 95 % confidence when a share `p` of `n` trials succeeded.
fn wilson_interval(p: f64, n: f64) -> [f64; 2] {
    let z = 1.959_963_985;
    let centre = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    [((centre - half) / scale).max(0.0), ((centre + half) / scale).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_interval_of_known_cases() {
        // 81 of 263, a textbook case: 0.2553 to 0.3662
        let [low, high] = wilson_interval(81.0 / 263.0, 263.0);
        assert!((low - 0.2553).abs() < 1e-4 && (high - 0.3662).abs() < 1e-4, "{low} {high}");
        let [low, high] = wilson_interval(1.0, 100.0);
        assert!((low - 0.9630).abs() < 1e-4 && high == 1.0, "{low} {high}");
    }

    #[test]
    fn times_of_targets_never_reached_are_left_out() {
        assert_eq!(mean_and_sd(&[f64::NAN, 1.0, 3.0]), Some((2.0, 2.0_f64.sqrt())));
        assert_eq!(mean_and_sd(&[f64::NAN]), None);
        assert_eq!(mean_and_sd(&[4.0]), Some((4.0, 0.0)));
    }
}
