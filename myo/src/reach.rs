//! The bridge between the body's reach and the checks of a task.

use myo_dynamics::{CouplingMode, Plan, PlanError, ReachableSpace};
use myo_model::Model;
use myo_tasks::Reach;

/// What a model can reach with its fingertip, for [`myo_tasks::check()`].
#[derive(Clone, Debug)]
pub struct ModelReach {
    space: ReachableSpace,
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
        Ok(Self { space: ReachableSpace::new(&plan), physics_dt_s: plan.timestep })
    }
}

impl Reach for ModelReach {
    fn distance_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64 {
        self.space.distance_out_of_reach(point_rel_shoulder)
    }

    fn physics_dt_s(&self) -> Option<f64> {
        Some(self.physics_dt_s)
    }
}
