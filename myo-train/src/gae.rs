//! Advantages.

/// Generalised advantage estimation (Schulman et al. 2016, arXiv 1506.02438), all arrays `(steps, envs)`:
///
/// `delta_t = reward_t + gamma next_value_t - value_t`,
/// `advantage_t = delta_t + gamma lambda advantage_{t+1}`, the sum cut where an episode `ended`.
///
/// `next_value` is what the future is worth after the step: the value of the next observation; of the last observation
/// of its episode where the time limit cut it off; 0 where the task ended.
pub fn advantages(
    envs: usize,
    (gamma, lambda): (f32, f32),
    reward: &[f32],
    value: &[f32],
    next_value: &[f32],
    ended: &[bool],
    advantage_out: &mut [f32],
) {
    let steps = reward.len() / envs;
    for t in (0..steps).rev() {
        let (here, later) = advantage_out.split_at_mut((t + 1) * envs);
        for env in 0..envs {
            let i = t * envs + env;
            let delta = reward[i] + gamma * next_value[i] - value[i];
            let future = if ended[i] || later.is_empty() { 0.0 } else { later[env] };
            here[i] = delta + gamma * lambda * future;
        }
    }
}

/// Lets no advantage count for more than `most`, for better or worse, where that is not 0.
pub fn bound(advantage: &mut [f32], most: f32) {
    if most > 0.0 {
        advantage.iter_mut().for_each(|advantage| *advantage = advantage.clamp(-most, most));
    }
}

/// Share of the variance of `target` that `prediction` explains: 1 is perfect, 0 no better than the mean.
pub fn explained_variance(prediction: &[f32], target: &[f32]) -> f64 {
    let variance = |x: &mut dyn Iterator<Item = f64>| {
        let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for x in x {
            n += 1.0;
            sum += x;
            squares += x * x;
        }
        squares / n - (sum / n) * (sum / n)
    };
    let error = variance(&mut target.iter().zip(prediction).map(|(&t, &p)| f64::from(t) - f64::from(p)));
    1.0 - error / variance(&mut target.iter().map(|&t| t.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stream, fill_normal};

    /// The definition: the discounted sum of all deltas until the end of the episode.
    fn obvious(env: usize, t: usize, envs: usize, delta: &[f64], ended: &[bool], decay: f64) -> f64 {
        let (mut sum, mut weight) = (0.0, 1.0);
        for t in t..delta.len() / envs {
            sum += weight * delta[t * envs + env];
            weight *= decay;
            if ended[t * envs + env] {
                break;
            }
        }
        sum
    }

    #[test]
    fn advantages_agree_with_their_definition() {
        let (steps, envs) = (23, 7);
        let mut numbers = vec![0.0; 3 * steps * envs];
        fill_normal(3, Stream::Actions, 0, 0, &mut numbers);
        let (reward, rest) = numbers.split_at(steps * envs);
        let (value, next_value) = rest.split_at(steps * envs);
        let ended: Vec<bool> = reward.iter().map(|&r| r > 1.2).collect();
        let mut fast = vec![f32::NAN; steps * envs];
        advantages(envs, (0.97, 0.95), reward, value, next_value, &ended, &mut fast);
        let delta: Vec<f64> = (0..steps * envs)
            .map(|i| f64::from(reward[i]) + 0.97 * f64::from(next_value[i]) - f64::from(value[i]))
            .collect();
        for (i, &fast) in fast.iter().enumerate() {
            let slow = obvious(i % envs, i / envs, envs, &delta, &ended, 0.97 * 0.95);
            assert!((f64::from(fast) - slow).abs() < 1e-5, "{i}: {fast} {slow}");
        }
    }

    #[test]
    fn advantages_of_a_roll_out_worked_out_by_hand() {
        // One environment, four steps; the task ends after the second. gamma = 1/2, lambda = 1/2, so deltas count a quarter.
        let (reward, value, next) = ([1.0, 2.0, -1.0, 4.0], [0.5, 1.0, 2.0, 1.0], [1.0, 0.0, 1.0, 2.0]);
        let mut got = [f32::NAN; 4];
        advantages(1, (0.5, 0.5), &reward, &value, &next, &[false, true, false, false], &mut got);
        // Deltas: 1 + 0.5 - 0.5 = 1, 2 - 1 = 1, -1 + 0.5 - 2 = -2.5, 4 + 1 - 1 = 4.
        assert_eq!(got, [1.25, 1.0, -1.5, 4.0]);
    }

    #[test]
    fn advantages_have_bounds_where_they_are_to() {
        let all = [-200.0, -6.0, 0.5, 7.0, f32::INFINITY];
        for (most, expected) in [(6.0, [-6.0, -6.0, 0.5, 6.0, 6.0]), (0.0, all)] {
            let mut bounded = all;
            bound(&mut bounded, most);
            assert_eq!(bounded, expected);
        }
    }

    #[test]
    fn explained_variance_of_perfect_and_constant_predictions() {
        let target = [1.0, 2.0, 4.0];
        assert!((explained_variance(&target, &target) - 1.0).abs() < 1e-12);
        assert!(explained_variance(&[3.0; 3], &target).abs() < 1e-12);
    }
}
