//! What the muscles of a moving body do at a moment, and what it costs them.

use crate::plan::Plan;
use crate::step::{force, kinematics, muscle_forces, tendon};
use crate::workspace::{State, Workspace};
use myo_model::Model;
use myo_muscle::Metabolism;

/// What all muscles together do at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Exertion {
    /// Torque of the muscles on each coordinate of the plan (N m; N for slides).
    pub torque: Vec<f64>,
    /// Power with which they pull the body (W), negative where it pulls them.
    pub mechanical: f64,
    /// What they consume (W), more than at rest; see [`myo_muscle::MetabolicPower`].
    pub metabolic: f64,
}

/// A body whose muscles exert themselves.
#[derive(Clone, Debug)]
pub struct Exerter {
    plan: Plan<f64>,
    metabolism: Vec<Metabolism>,
    ws: Workspace<f64>,
}

impl Exerter {
    /// Of a model and its [exact](Plan::exact) plan with reduced coordinates.
    pub fn new(model: &Model, plan: Plan<f64>) -> Self {
        let muscles = plan.muscles.iter().zip(&model.muscles);
        let metabolism = muscles.map(|(own, muscle)| Metabolism::new(own.curves, &muscle.parameters.gain)).collect();
        let ws = Workspace::new(&plan);
        Self { plan, metabolism, ws }
    }

    /// What its muscles weigh together (kg), as metabolic power is reckoned with.
    pub fn muscle_mass_kg(&self) -> f64 {
        self.metabolism.iter().map(Metabolism::mass_kg).sum()
    }

    /// What muscles do in a state.
    ///
    /// # Panics
    /// The state is of another plan.
    pub fn at(&mut self, state: &State<f64>) -> Exertion {
        let Self { plan, metabolism, ws } = self;
        kinematics::kinematics(plan, &state.qpos, &state.qvel, ws);
        tendon::lengths(plan, ws);
        muscle_forces(plan, state, ws);
        // An actuator that pulls has a negative force, and one that shortens a negative velocity.
        let mechanical = ws
            .muscle_force
            .iter()
            .zip(&ws.tendon_velocity)
            .take(plan.nmuscle())
            .map(|(force, velocity)| force * velocity)
            .sum();
        let moments = ws.tendon_length.iter().zip(&ws.tendon_velocity).zip(&state.act);
        let consumed = metabolism.iter().zip(moments);
        let metabolic = consumed.map(|(muscle, ((&l, &v), &act))| muscle.power(l, v, act).total()).sum();
        Exertion { torque: force::muscle_torques(plan, ws), mechanical, metabolic }
    }
}
