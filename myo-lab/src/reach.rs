//! The bridge between the body and the checks of a task: what it reaches, what it can hold, how fast it is.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use myo_dynamics::plan::Point;
use myo_dynamics::{BodyPlaces, CouplingMode, Plan, PlanError, ReachableSpace, Strength};
use myo_model::Model;
use myo_tasks::logic::{CompiledTask, Landmarks, Pointer};
use myo_tasks::{FlatTask, Reach, Task};

use crate::advice::Body;

/// What another finger of a model reaches.
#[derive(Clone, Debug)]
struct FingerReach(ReachableSpace);

impl Reach for FingerReach {
    fn nearest_in_reach(&self, point_rel_shoulder: [f64; 3]) -> [f64; 3] {
        nearest(&self.0, point_rel_shoulder)
    }
}

/// The point in a space that is nearest to a point; that point itself when it is in it.
fn nearest(space: &ReachableSpace, point: [f64; 3]) -> [f64; 3] {
    let nearest = space.nearest(point);
    if nearest.distance_m == 0.0 { point } else { nearest.point }
}

/// What a model can reach with its fingertip, or what a task points with, for [`myo_tasks::check()`], and hold there, for [`likely_cause`].
///
/// [`likely_cause`]: crate::likely_cause()
#[derive(Clone, Debug)]
pub struct ModelReach {
    space: Arc<ReachableSpace>,
    /// Of the fingertip, where what points comes everywhere in time.
    hand: Option<ReachableSpace>,
    /// Of other fingers that the task asks for, by name.
    fingers: BTreeMap<String, FingerReach>,
    /// Made when it is first asked for.
    strength: OnceLock<Strength>,
    physics_dt_s: f64,
    /// Whether the fingertip itself points.
    is_fingertip: bool,
}

impl ModelReach {
    /// Explores the poses of a model, once it has been tried out under random controls.
    ///
    /// # Errors
    /// The model cannot be simulated.
    pub fn new(model: &Model) -> Result<Self, PlanError> {
        Self::of_pointer(model, Pointer::Fingertip, &FlatTask::default())
    }

    /// The same for what a task points with; for the fingertip where the task has errors.
    ///
    /// # Errors
    /// The model cannot be simulated, does not tell where the arm is that a ray comes from, or has not the fingers that the task asks for.
    pub fn for_task(model: &Model, task: &Task) -> Result<Self, PlanError> {
        match task.flat() {
            Ok(flat) => Self::of_pointer(model, CompiledTask::of(task, &flat).pointer, &flat),
            Err(_) => Self::new(model),
        }
    }

    fn of_pointer(model: &Model, pointer: Pointer<f64>, flat: &FlatTask) -> Result<Self, PlanError> {
        let mut plan = Plan::exact(model, CouplingMode::Reduced)?;
        plan.check_held()?;
        plan.try_out()?;
        if pointer.is_ray() {
            plan = plan.with_arm(model)?;
        }
        let fingers = &flat.fingers;
        let plan = plan.with_fingers(model, fingers)?;
        for finger in flat.pressing_fingers() {
            plan.check_presses(finger, &fingers[finger])?;
        }
        let (plan, is_fingertip) = (plan.specialised(), pointer.is_fingertip());
        let hand = pointer.is_rate_cursor().then(|| ReachableSpace::new(&plan));
        let space = if is_fingertip {
            ReachableSpace::new(&plan)
        } else {
            let place = move |body: &BodyPlaces, goal: [f64; 3]| {
                let [elbow, wrist] = body.arm;
                pointer
                    .place_in_time(&Landmarks { fingertip: body.fingertip, elbow, wrist, ..Landmarks::unknown() }, goal)
            };
            ReachableSpace::of_pointer(&plan, Arc::new(place))
        };
        let of_finger = |(name, &fingertip): (&String, &Point<f64>)| {
            let plan = Plan { fingertip, ..plan.clone() };
            (name.clone(), FingerReach(ReachableSpace::new(&plan)))
        };
        Ok(Self {
            space: Arc::new(space),
            hand,
            fingers: fingers.iter().zip(&plan.fingers).map(of_finger).collect(),
            strength: OnceLock::new(),
            physics_dt_s: plan.timestep,
            is_fingertip,
        })
    }

    fn strength(&self) -> &Strength {
        self.strength.get_or_init(|| Strength::new(Arc::clone(&self.space)))
    }
}

impl Reach for ModelReach {
    fn nearest_in_reach(&self, point_rel_shoulder: [f64; 3]) -> [f64; 3] {
        nearest(&self.space, point_rel_shoulder)
    }

    fn fingertip_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64 {
        let space = self.hand.as_ref().unwrap_or(&self.space);
        space.nearest(point_rel_shoulder).distance_m
    }

    fn of_finger(&self, name: &str) -> Option<&dyn Reach> {
        self.fingers.get(name).map(|reach| reach as &dyn Reach)
    }

    fn can_hold(&self, centre_rel_shoulder: [f64; 3], radius: f64) -> bool {
        // What holding the fingertip still means for another pointer is not known.
        !self.is_fingertip || self.strength().holds(centre_rel_shoulder, radius)
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
    use myo_tasks::{
        Item, Range, Region, Remedy, Report, SphereItem, TaskError, TaskWarning, check, preset, preset_names,
    };
    use myo_train::session::EpisodeMeans;

    use super::*;
    use crate::likely_cause;

    fn body(name: &str) -> ModelReach {
        ModelReach::new(&Model::new(&builtin(name).unwrap()).unwrap()).unwrap()
    }

    fn sphere(x: f64) -> Task {
        dwelling(x, 0.2)
    }

    fn dwelling(x: f64, seconds: f64) -> Task {
        let ball = format!("{{kind: sphere, at: [{x}, 0.29, -0.1], radius: 0.02}}");
        let script = format!("[dwell: {{in: ball, for_s: {seconds}}}]");
        let text = format!(
            "version: 2\nuser: fastest\nmodel: mobl-arms\nname: t\nscene: {{ball: {ball}}}\nscript: {script}\ntime_limit_s: 4\n"
        );
        Task::from_yaml(&text, "t").unwrap()
    }

    fn ball(task: &mut Task) -> &mut SphereItem {
        let Item::Sphere(ball) = &mut task.scene.0["ball"] else { panic!("a sphere") };
        ball
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
            ball(&mut task).at.0 = moved.to;
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
        let at = |place: [f64; 3], dwell_s: f64| {
            let mut task = dwelling(0.0, dwell_s);
            let [x, y, z] = place.map(Range::from);
            (ball(&mut task).at.0, ball(&mut task).radius) = (Region { x, y, z }, 0.053.into());
            check(&task, &reach)
        };
        let report = at([0.258, 0.222, -0.311], 0.2);
        let [warning @ TaskWarning::CannotHold { fraction: 1.0, held: Some(held), .. }] = &report.warnings[..] else {
            panic!("{report:?}")
        };
        let text = warning.to_string();
        let expected = "muscles cannot hold the fingertip still in ball, such as at (0.26, 0.22, -0.31) m, so that it \
                        has to pass through and needs 0.2 s inside; they can 10 cm farther to the right, at ";
        assert!(text.starts_with(expected), "{text}");
        assert_eq!(warning.path(), "scene.ball.at");
        assert_eq!(at(held.point, 0.2), Report::default());
        // What is done as soon as it is touched needs no hold.
        assert_eq!(at([0.258, 0.222, -0.311], 0.05), Report::default());
    }

    /// What is said of a training that fails at one target.
    fn cause(task: &Task, reach: &ModelReach, target: usize) -> String {
        let target_success =
            (0..task.flat().unwrap().steps.len()).map(|k| if k < target { 1.0 } else { 0.2 }).collect();
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
        let by_fingers = ["myo-hand", "myo-arm-hand"];
        for name in ["mobl-arms", "mobl-arms-uitb"].into_iter().chain(by_fingers) {
            let model = Model::new(&builtin(name).unwrap()).unwrap();
            let presets = preset_names().into_iter().map(|name| preset(name).unwrap());
            let fits = |preset: &Task| {
                if by_fingers.contains(&name) { preset.model == name } else { !by_fingers.contains(&&*preset.model) }
            };
            for preset in presets.filter(fits) {
                let reach = ModelReach::for_task(&model, &preset).unwrap();
                let flat = preset.flat().unwrap();
                // Copies of a sphere are one description's.
                let is_copy = |k: usize| {
                    let [before, now] = [k - 1, k].map(|k| flat.object(k));
                    now.sphere().is_some() && now.path == before.path
                };
                for target in (0..flat.steps.len()).filter(|&k| k == 0 || !is_copy(k)) {
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
        assert!(text.contains("likely cause: muscles cannot hold the fingertip still in ball, such as at ("), "{text}");
    }
}
