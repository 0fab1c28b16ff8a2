//! Why a training that leads nowhere may do so, as far as its task and its episodes tell.

use myo_tasks::{Reach, Report, Target, Task, TaskError, TaskWarning, check};
use myo_train::session::Recent;

/// Closer to the edge of reach than this (m), a pose has little freedom left and muscles have little strength.
const EDGE_M: f64 = 0.03;

/// If at least this share of positions is at the edge, that is the likely cause.
const EDGE_SHARE: f64 = 0.05;

/// If the mean episode takes at least this share of the time limit, lack of time is the likely cause.
const LATE: f64 = 0.9;

/// The greatest share of episodes that can succeed, as far as the check of a task can tell: those in which no sphere lies
/// out of reach. Buttons do not count: one that is partly out of reach can still be pressed elsewhere.
pub fn most_success(report: &Report) -> f64 {
    let reached = report.warnings.iter().filter_map(|warning| match warning {
        TaskWarning::PartlyOutOfReach { target, fraction, .. } if target.kind == "pointing" => {
            Some((1.0 - fraction).powi((target.last - target.first + 1) as i32))
        }
        _ => None,
    });
    reached.product()
}

/// Why so many episodes probably fail, and what may help: one sentence.
pub fn likely_cause(task: &Task, reach: &dyn Reach, recent: &Recent) -> String {
    let hardest = hardest(recent);
    let at_edge = at_edge(&check(task, &Nearer(reach)), hardest);
    let limit = f64::from(task.time_limit_steps());
    let (number, count) = (hardest + 1, recent.target_success.len());
    if at_edge >= EDGE_SHARE {
        return format!(
            "likely cause: {:.0} % of the positions of target {number} lie within {:.0} cm of the edge of reach or beyond; \
             bring them nearer to the shoulder or make them larger",
            100.0 * at_edge,
            100.0 * EDGE_M
        );
    }
    if hardest > 0 && recent.length >= LATE * limit {
        return format!(
            "likely cause: time; when the {} s are over, {:.1} of {count} targets are done; raise time_limit_s",
            task.time_limit_s, recent.targets_done
        );
    }
    if let Some(Target::Pointing(sphere)) = task.clone().expanded().targets.get(hardest)
        && recent.final_distance < sphere.radius.centre()
    {
        return format!(
            "likely cause: the dwell of target {number}; the fingertip ends {:.1} cm from its centre, but does not stay inside \
             for {} s; shorten dwell_s or enlarge the radius",
            100.0 * recent.final_distance,
            sphere.dwell_s
        );
    }
    format!(
        "target {number} is missed most often, and nothing in its description says why; another seed, more environments \
         (--envs 4096) or a larger distance weight may help"
    )
}

/// The target at which most episodes end.
fn hardest(recent: &Recent) -> usize {
    let before = [1.0].into_iter().chain(recent.target_success.iter().copied());
    let lost = before.zip(&recent.target_success).map(|(before, after)| before - after);
    lost.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index)
}

/// Share of the positions of a target that a check found out of reach.
fn at_edge(report: &Report, index: usize) -> f64 {
    let holds = |first, last| (first..=last).contains(&index);
    let error = report.errors.iter().find_map(|error| match error {
        TaskError::OutOfReach { target, .. } if holds(target.first, target.last) => Some(1.0),
        _ => None,
    });
    let warning = report.warnings.iter().find_map(|warning| match warning {
        TaskWarning::PartlyOutOfReach { target, fraction, .. } if holds(target.first, target.last) => Some(*fraction),
        _ => None,
    });
    error.or(warning).unwrap_or(0.0)
}

/// The same reach, shorter by [`EDGE_M`].
struct Nearer<'a>(&'a dyn Reach);

impl Reach for Nearer<'_> {
    fn distance_out_of_reach(&self, point: [f64; 3]) -> f64 {
        let length = point.iter().map(|x| x * x).sum::<f64>().sqrt();
        let further = 1.0 + EDGE_M / length.max(EDGE_M);
        self.0.distance_out_of_reach(point.map(|x| x * further))
    }
}

#[cfg(test)]
mod tests {
    use myo_tasks::preset;

    use super::*;

    /// Half a metre in every direction.
    struct Ball;

    impl Reach for Ball {
        fn distance_out_of_reach(&self, point: [f64; 3]) -> f64 {
            (point.iter().map(|x| x * x).sum::<f64>().sqrt() - 0.5).max(0.0)
        }
    }

    fn cause(task: &Task, target_success: &[f64], length: f64, final_distance: f64) -> String {
        let targets_done = target_success.iter().sum();
        let success = *target_success.last().unwrap();
        let target_success = target_success.to_vec();
        likely_cause(
            task,
            &Ball,
            &Recent { success, targets_done, final_distance, length, episode_return: 0.0, target_success },
        )
    }

    #[test]
    fn spheres_out_of_reach_bound_the_success() {
        let mut task = preset("mobile-typing").unwrap();
        assert_eq!(most_success(&check(&task, &Ball)), 1.0);
        let Target::Pointing(sphere) = &mut task.targets[0] else { panic!("spheres") };
        sphere.position.x.max = 0.45;
        let most = most_success(&check(&task, &Ball));
        // x below 0.41, of 0.225 to 0.45.
        assert!((most - 0.185 / 0.225).abs() < 0.02, "{most}");
    }

    #[test]
    fn each_cause_is_named_with_its_figures() {
        let mut task = preset("mobile-typing").unwrap();
        let text = cause(&task, &[0.9, 0.8, 0.7, 0.3, 0.2], 75.0, 0.1);
        assert!(text.contains("when the 4 s are over, 2.9 of 5 targets are done"), "{text}");
        let text = cause(&task, &[0.9, 0.8, 0.7, 0.3, 0.2], 40.0, 0.005);
        assert!(text.contains("dwell of target 4") && text.contains("0.5 cm"), "{text}");
        let text = cause(&task, &[0.1, 0.1, 0.1, 0.1, 0.1], 40.0, 0.3);
        assert!(text.contains("target 1 is missed most often"), "{text}");
        task.targets.truncate(1);
        let Target::Pointing(sphere) = &mut task.targets[0] else { panic!("spheres") };
        sphere.position.x.max = 0.45;
        let text = cause(&task, &[0.6], 40.0, 0.3);
        assert!(text.contains("% of the positions of target 1 lie within 3 cm of the edge of reach"), "{text}");
    }
}
