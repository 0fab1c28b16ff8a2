//! The bridge between the body and the checks of a task: what it reaches, what it can hold, how fast it is.

use std::sync::{Arc, OnceLock};

use myo_dynamics::{CouplingMode, Plan, PlanError, ReachableSpace, Strength};
use myo_model::Model;
use myo_tasks::Reach;

use crate::advice::Body;

/// What a model can reach with its fingertip, for [`myo_tasks::check()`], and hold there, for [`likely_cause`].
///
/// [`likely_cause`]: crate::likely_cause()
#[derive(Clone, Debug)]
pub struct ModelReach {
    space: Arc<ReachableSpace>,
    /// Made when it is first asked for.
    strength: OnceLock<Strength>,
    physics_dt_s: f64,
}

impl ModelReach {
    /// Explores the poses of a model, once it has been tried out under random controls.
    ///
    /// # Errors
    /// The model cannot be simulated.
    pub fn new(model: &Model) -> Result<Self, PlanError> {
        let plan = Plan::exact(model, CouplingMode::Reduced)?;
        plan.try_out()?;
        let plan = plan.specialised();
        let space = Arc::new(ReachableSpace::new(&plan));
        Ok(Self { space, strength: OnceLock::new(), physics_dt_s: plan.timestep })
    }

    fn strength(&self) -> &Strength {
        self.strength.get_or_init(|| Strength::new(Arc::clone(&self.space)))
    }
}

impl Reach for ModelReach {
    fn nearest_in_reach(&self, point_rel_shoulder: [f64; 3]) -> [f64; 3] {
        let nearest = self.space.nearest(point_rel_shoulder);
        if nearest.distance_m == 0.0 { point_rel_shoulder } else { nearest.point }
    }

    fn can_hold(&self, centre_rel_shoulder: [f64; 3], radius: f64) -> bool {
        self.strength().holds(centre_rel_shoulder, radius)
    }

    fn physics_dt_s(&self) -> Option<f64> {
        Some(self.physics_dt_s)
    }
}

impl Body for ModelReach {
    fn fastest_m_per_s(&self) -> f64 {
        self.strength().fastest()
    }
}

#[cfg(test)]
mod tests {
    use myo_model::builtin;
    use myo_tasks::{Range, Region, Remedy, Report, Target, Task, TaskError, TaskWarning, check, preset, preset_names};
    use myo_train::session::EpisodeMeans;

    use super::*;
    use crate::likely_cause;

    fn body(name: &str) -> ModelReach {
        ModelReach::new(&Model::new(&builtin(name).unwrap()).unwrap()).unwrap()
    }

    fn sphere(x: f64) -> Task {
        let text = format!(
            "version: 1\nname: t\ntargets:\n  - kind: pointing\n    position: {{ x: {x}, y: 0.29, z: -0.1 }}\n    radius: 0.02\n    dwell_s: 0.2\ntime_limit_s: 4\n"
        );
        Task::from_yaml(&text, "t").unwrap()
    }

    /// Places on the left of the chest: the nearer to the shoulder, the farther out of reach.
    #[test]
    fn advice_moves_targets_out_of_reach_where_the_body_reaches_and_not_nearer_to_the_shoulder() {
        let reach = body("mobl-arms");
        assert_eq!(check(&sphere(0.55), &reach), Report::default());
        for (x, expected) in [(0.41, 0.056), (0.35, 0.093), (0.30, 0.115), (0.20, 0.134)] {
            let mut task = sphere(x);
            let report = check(&task, &reach);
            let [error @ TaskError::OutOfReach { beyond_m, remedy, .. }] = &report.errors[..] else {
                panic!("{report:?}")
            };
            assert!((beyond_m - expected).abs() < 0.003, "{x}: {beyond_m}");
            let Remedy { moved: Some(moved), narrowed: None } = &**remedy else { panic!("{remedy:?}") };
            // The centre moves by the radius more than the surface, and two or five millimetres.
            assert!((moved.length() - beyond_m - 0.02).abs() < 0.006, "{moved:?}");
            // As far straight towards the shoulder the centre is out of reach still.
            let place = [x, 0.29, -0.1];
            let nearer = 1.0 - moved.length() / place.map(|x| x * x).iter().sum::<f64>().sqrt();
            assert!(reach.distance_out_of_reach(place.map(|x| x * nearer)) > 0.01, "{moved:?}");
            let text = error.to_string();
            assert!(text.contains("; move its centre ") && !text.contains("nearer"), "{text}");
            let Target::Pointing(sphere) = &mut task.targets[0] else { panic!("a sphere") };
            sphere.position = moved.to;
            // Reached is not held: at the last place it is not, which is all that is found.
            let mut found = check(&task, &reach);
            let weak =
                found.warnings.extract_if(.., |warning| matches!(warning, TaskWarning::CannotHold { .. })).count();
            assert_eq!((found, weak), (Report::default(), usize::from(x == 0.20)), "{text}");
        }
    }

    /// Low on the left, close to the body: in reach of every posture tried, and none can be held.
    #[test]
    fn a_sphere_in_which_muscles_cannot_hold_still_is_told_with_a_place_where_they_can() {
        let reach = body("mobl-arms");
        let mut task = sphere(0.258);
        let Target::Pointing(target) = &mut task.targets[0] else { panic!("a sphere") };
        target.position.y = 0.222.into();
        target.position.z = (-0.311).into();
        target.radius = 0.053.into();
        let report = check(&task, &reach);
        let [warning @ TaskWarning::CannotHold { fraction: 1.0, held: Some(held), .. }] = &report.warnings[..] else {
            panic!("{report:?}")
        };
        let text = warning.to_string();
        let expected = "muscles cannot hold the fingertip still in target 1 (pointing), such as at (0.26, 0.22, -0.31) m, so \
                        that it has to pass through and needs 0.2 s inside; they can 10 cm farther to the right, at ";
        assert!(text.starts_with(expected), "{text}");
        assert_eq!(warning.path(), "targets[0].position");
        let moved = |place: [f64; 3], dwell_s| {
            let mut task = task.clone();
            let Target::Pointing(target) = &mut task.targets[0] else { panic!("a sphere") };
            let [x, y, z] = place.map(Range::from);
            (target.position, target.dwell_s) = (Region { x, y, z }, dwell_s);
            check(&task, &reach)
        };
        assert_eq!(moved(held.point, 0.2), Report::default());
        // What is done as soon as it is touched needs no hold.
        assert_eq!(moved([0.258, 0.222, -0.311], 0.05), Report::default());
    }

    /// What is said of a training that fails at one target.
    fn cause(task: &Task, reach: &ModelReach, target: usize) -> String {
        let target_success = (0..task.targets.len()).map(|k| if k < target { 1.0 } else { 0.2 }).collect();
        // To the end of the time, near the target: what was once taken for a dwell too long, or too little time.
        let length = f64::from(task.time_limit_steps());
        let recent = EpisodeMeans {
            success: 0.2,
            targets_done: target as f64,
            final_distance: 0.01,
            length,
            episode_return: 0.0,
            target_success,
        };
        likely_cause(task, reach, &recent)
    }

    /// All presets were learnt by both bodies, so whatever is blamed is innocent.
    #[test]
    fn no_preset_is_blamed_for_a_training_that_fails() {
        for name in ["mobl-arms", "mobl-arms-uitb"] {
            let reach = body(name);
            for preset in preset_names().into_iter().map(|name| preset(name).unwrap()) {
                let kinds = (0..preset.targets.len()).filter(|&k| k == 0 || preset.targets[k] != preset.targets[k - 1]);
                for target in kinds {
                    let text = cause(&preset, &reach, target);
                    assert!(text.contains("no cause was found: it can be reached"), "{}, {name}: {text}", preset.name);
                }
            }
        }
    }

    #[test]
    fn a_body_too_weak_for_its_weight_is_blamed_and_its_reach_is_not() {
        let mut description = builtin("mobl-arms").unwrap();
        for muscle in &mut description.muscles {
            let gain = &mut muscle.parameters.gain;
            (gain.force, gain.scale) = (gain.force.map(|force| 0.02 * force), 0.02 * gain.scale);
        }
        let reach = ModelReach::new(&Model::new(&description).unwrap()).unwrap();
        let text = cause(&sphere(0.55), &reach, 0);
        assert!(
            text.contains("likely cause: muscles cannot hold the fingertip still in target 1 (pointing), such as at ("),
            "{text}"
        );
    }
}
