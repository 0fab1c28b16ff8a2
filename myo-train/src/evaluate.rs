//! How well a policy does on fresh episodes.

use myo_env::{Autoreset, EnvSpec, StepStorage, VectorEnv};
use serde::{Deserialize, Serialize};

use crate::rollout::told_layouts;
use crate::statistics::{Sample, wilson_interval};
use crate::{Policy, TrainError};

/// Result of [`evaluate`]. The keys of its JSON form are stable; quantities that do not exist are `null`.
///
/// Every mean comes with an interval that holds the policy's true mean, over all episodes that there could be, with 95 %
/// confidence: Student's for means, whose episodes are independent, Wilson's (1927, doi 10.1080/01621459.1927.10502953) for
/// shares. They tell how well this policy is known, not how much another training of it would differ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Share of episodes in which every target was done.
    pub success: Option<f64>,
    /// 95 % confidence interval of `success`.
    pub success_interval: Option<[f64; 2]>,
    /// Episodes counted.
    pub episodes: u64,
    /// One entry per target, in order.
    pub targets: Vec<TargetEvaluation>,
    /// Mean distance from the fingertip to the centre of the current target at the end, in metres: of the last target where
    /// all are done.
    pub final_distance_m: Option<f64>,
    /// 95 % confidence interval of it.
    pub final_distance_m_interval: Option<[f64; 2]>,
    /// Mean squared control.
    pub effort: Option<f64>,
    /// 95 % confidence interval of it.
    pub effort_interval: Option<[f64; 2]>,
    /// Share of the strength of all muscles that fatigues in an episode, mean, as of rested people and without what recovers (3CC-r; Looft et al.
    /// 2018, doi 10.1016/j.jbiomech.2018.06.005).
    #[serde(default)]
    pub fatigue: Option<f64>,
    /// 95 % confidence interval of it.
    #[serde(default)]
    pub fatigue_interval: Option<[f64; 2]>,
    /// Mean number of presses per episode of buttons that were not asked for.
    #[serde(default)]
    pub wrong_presses: Option<f64>,
    /// 95 % confidence interval of it.
    #[serde(default)]
    pub wrong_presses_interval: Option<[f64; 2]>,
    /// Mean number of times per episode that a way was left.
    #[serde(default)]
    pub exits: Option<f64>,
    /// 95 % confidence interval of it.
    #[serde(default)]
    pub exits_interval: Option<[f64; 2]>,
    /// Share of the time of `track` steps inside what is to be tracked, mean; none without such steps.
    #[serde(default)]
    pub on_target: Option<f64>,
    /// 95 % confidence interval of it.
    #[serde(default)]
    pub on_target_interval: Option<[f64; 2]>,
    /// Distance from its centre, root mean square over the time, mean, in metres; none without such steps.
    #[serde(default)]
    pub tracking_error_m: Option<f64>,
    /// 95 % confidence interval of it.
    #[serde(default)]
    pub tracking_error_m_interval: Option<[f64; 2]>,
    /// Mean duration of an episode, in seconds.
    pub episode_length_s: Option<f64>,
    /// 95 % confidence interval of it.
    pub episode_length_s_interval: Option<[f64; 2]>,
    /// Mean sum of rewards of an episode.
    #[serde(rename = "return")]
    pub episode_return: Option<f64>,
    /// 95 % confidence interval of it.
    #[serde(rename = "return_interval")]
    pub episode_return_interval: Option<[f64; 2]>,
    /// Of each layout, in order, where there are several; all else is over equally many episodes of every layout then.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layouts: Vec<Evaluation>,
}

/// One target's part of an [`Evaluation`]. Times are those of the episodes in which it was done.
///
/// Movement time is the field's: from the start signal, here the end of the target before or the reset, to the last entry
/// into the target or to the touch of a button, without dwell (Soukoreff & MacKenzie 2004, doi 10.1016/j.ijhcs.2004.09.001; ISO
/// 9241-411). It is known to one physics step. The policy has no reaction time of its own: it perceives the start at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetEvaluation {
    /// Share of all episodes in which the target was done.
    pub success: f64,
    /// 95 % confidence interval of it.
    pub success_interval: Option<[f64; 2]>,
    /// Mean movement time, without dwell, in seconds.
    pub movement_time_s: Option<f64>,
    /// Standard deviation of these times, in seconds.
    pub movement_time_s_sd: Option<f64>,
    /// 95 % confidence interval of their mean, in seconds.
    pub movement_time_s_interval: Option<[f64; 2]>,
    /// Mean time from the target's start to its end, dwell included, in seconds; each is a whole number of control steps.
    pub time_s: Option<f64>,
    /// Standard deviation of these times, in seconds.
    pub time_s_sd: Option<f64>,
    /// 95 % confidence interval of their mean, in seconds.
    pub time_s_interval: Option<[f64; 2]>,
}

/// Runs the mean actions of `policy` in `env` until `episodes` episodes have ended; so many of each layout where there are several.
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
    let mut tally = Tally::new(episodes, &spec);
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

/// Refuses environments that do not fit the policy, do not start their episodes again, or begin them in the middle of the task.
pub(crate) fn check(policy: &Policy, spec: &EnvSpec) -> Result<(), TrainError> {
    policy.check(spec)?;
    let mismatch = |what, got, expected: &str| Err(TrainError::Mismatch { what, got, expected: expected.into() });
    if spec.autoreset != Autoreset::SameStep {
        return mismatch("the autoreset mode", format!("{:?}", spec.autoreset), "SameStep");
    }
    match spec.exploring {
        0 => Ok(()),
        some => {
            mismatch("the number of environments that explore", some.to_string(), "0, as only whole episodes count")
        }
    }
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
    /// For so many episodes of each layout.
    pub fn new(episodes: usize, spec: &EnvSpec) -> Self {
        let (envs, layouts) = (spec.num_envs, spec.layouts());
        let quota = (0..envs).map(|env| {
            // This one is number `i` of the `n` environments that do its layout.
            let (i, n) = (env / layouts, (envs - env % layouts).div_ceil(layouts));
            episodes / n + usize::from(i < episodes % n)
        });
        let episodes = episodes * layouts.min(envs);
        Self { episodes, quota: quota.collect(), summaries: vec![Vec::new(); envs], counted: 0 }
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
        let of = |first: usize, step: usize| {
            let summaries = self.summaries.iter().skip(first).step_by(step).flatten().copied().collect::<Vec<_>>();
            Evaluation::new(spec, summaries.len().checked_div(spec.episode_size()).unwrap_or(self.counted), &summaries)
        };
        let layouts = told_layouts(spec);
        Evaluation { layouts: (0..layouts).map(|layout| of(layout, layouts)).collect(), ..of(0, 1) }
    }
}

impl Evaluation {
    /// From the summaries of `episodes` episodes, one row each.
    fn new(spec: &EnvSpec, episodes: usize, summaries: &[f32]) -> Self {
        let column = |name: &str| {
            let index = spec.episode_names.iter().position(|n| n == name)?;
            Some(summaries.iter().skip(index).step_by(spec.episode_size()).map(|&x| f64::from(x)).collect::<Vec<_>>())
        };
        let sample = |name: &str| column(name).and_then(|x| Sample::of(&x));
        let share = |name: &str| sample(name).map(|x| (x.mean, wilson_interval(x.mean, episodes as f64)));
        let target = |i: usize| {
            let of = |name: &str| format!("target_{i}_{name}");
            let (success, success_interval) = share(&of("success"))?;
            let (movement, time) = (sample(&of("movement_time")), sample(&of("time")));
            Some(TargetEvaluation {
                success,
                success_interval: Some(success_interval),
                movement_time_s: mean(movement),
                movement_time_s_sd: movement.map(|x| x.sd),
                movement_time_s_interval: interval(movement),
                time_s: mean(time),
                time_s_sd: time.map(|x| x.sd),
                time_s_interval: interval(time),
            })
        };
        let success = share("success");
        let (distance, effort, episode_return) = (sample("final_distance"), sample("effort"), sample("return"));
        let length = sample("length").map(|steps| steps.times(spec.control_dt));
        Self {
            success: success.map(|(share, _)| share),
            success_interval: success.map(|(_, interval)| interval),
            episodes: episodes as u64,
            targets: (1..).map_while(target).collect(),
            final_distance_m: mean(distance),
            final_distance_m_interval: interval(distance),
            effort: mean(effort),
            effort_interval: interval(effort),
            fatigue: mean(sample("fatigue")),
            fatigue_interval: interval(sample("fatigue")),
            wrong_presses: mean(sample("wrong_presses")),
            wrong_presses_interval: interval(sample("wrong_presses")),
            exits: mean(sample("exits")),
            exits_interval: interval(sample("exits")),
            on_target: mean(sample("on_target")),
            on_target_interval: interval(sample("on_target")),
            tracking_error_m: mean(sample("tracking_error")),
            tracking_error_m_interval: interval(sample("tracking_error")),
            episode_length_s: mean(length),
            episode_length_s_interval: interval(length),
            episode_return: mean(episode_return),
            episode_return_interval: interval(episode_return),
            layouts: vec![],
        }
    }

    /// Success in the layout where it is least, or in the only one.
    pub fn least_success(&self) -> Option<f64> {
        let least = |least: Option<f64>, layout: &Self| Some(least?.min(layout.success?));
        self.layouts.iter().fold(self.success, least)
    }
}

fn mean(sample: Option<Sample>) -> Option<f64> {
    sample.map(|x| x.mean)
}

fn interval(sample: Option<Sample>) -> Option<[f64; 2]> {
    sample.and_then(|x| x.interval)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two targets, four episodes: one does both, two do the first, one does none.
    #[test]
    fn times_and_shares_come_with_intervals() {
        let names = ["length", "success", "target_1_success", "target_1_time", "target_1_movement_time"];
        let second = ["target_2_success", "target_2_time", "target_2_movement_time"];
        let spec = EnvSpec {
            num_envs: 1,
            observation_names: vec![],
            action_names: vec![],
            episode_names: names.iter().chain(&second).map(|&name| name.to_owned()).collect(),
            control_dt: 0.05,
            max_episode_steps: 40,
            layout_limits: vec![],
            autoreset: Autoreset::SameStep,
            exploring: 0,
        };
        let nan = f32::NAN;
        let summaries = [
            [30.0, 1.0, 1.0, 0.75, 0.5, 1.0, 0.75, 0.25],
            [40.0, 0.0, 1.0, 1.0, 0.75, 0.0, nan, nan],
            [40.0, 0.0, 1.0, 1.25, 1.0, 0.0, nan, nan],
            [40.0, 0.0, 0.0, nan, nan, 0.0, nan, nan],
        ];
        let evaluation = Evaluation::new(&spec, 4, summaries.as_flattened());
        assert_eq!((evaluation.success, evaluation.success_interval), (Some(0.25), Some(wilson_interval(0.25, 4.0))));
        let [first, second] = &evaluation.targets[..] else { panic!("{evaluation:?}") };
        assert_eq!((first.success, first.success_interval), (0.75, Some(wilson_interval(0.75, 4.0))));
        assert_eq!((first.movement_time_s, first.movement_time_s_sd), (Some(0.75), Some(0.25)));
        assert_eq!((first.time_s, first.time_s_sd), (Some(1.0), Some(0.25)));
        // Student's quantile for three observations is 4.3027.
        let half = 4.3027 * 0.25 / 3.0_f64.sqrt();
        for (interval, mean) in [(first.movement_time_s_interval, 0.75), (first.time_s_interval, 1.0)] {
            let [low, high] = interval.unwrap();
            assert!((low - (mean - half)).abs() < 1e-4 && (high - (mean + half)).abs() < 1e-4, "{low} {high}");
        }
        assert_eq!((second.movement_time_s, second.time_s), (Some(0.25), Some(0.75)));
        assert_eq!(
            (second.movement_time_s_interval, second.time_s_interval),
            (None, None),
            "one says nothing about it"
        );
        assert_eq!(evaluation.episode_length_s, Some(1.875));
        let [low, high] = evaluation.episode_length_s_interval.unwrap();
        // 2.5 steps of 0.05 s and the quantile of four observations, 3.1824.
        assert!((low - (1.875 - 3.1824 * 0.125)).abs() < 1e-4 && (high - (1.875 + 3.1824 * 0.125)).abs() < 1e-4);
        assert_eq!((evaluation.effort, evaluation.effort_interval), (None, None));
    }
}
