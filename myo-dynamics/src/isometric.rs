//! What each muscle of a body at rest does to each coordinate: moment arm, force, torque.

use crate::obstacles::Obstacles;
use crate::plan::Plan;
use crate::step::force::moment_arms;
use crate::step::forward;
use crate::workspace::{State, Workspace};

/// A body at rest in one pose, held by nothing. All vectors have an entry for each coordinate of the plan, in its order.
#[derive(Clone, Debug, PartialEq)]
pub struct Isometric {
    /// Torque of gravity (N m).
    pub gravity: Vec<f64>,
    /// Torque of springs, and of muscles that are stretched and do nothing (N m).
    pub passive: Vec<f64>,
    /// What each muscle adds when it is fully active.
    pub muscles: Vec<Pull>,
}

/// One muscle, fully active, at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// Length of its path (m).
    pub length: f64,
    /// Active force, without the passive one (N); positive when it pulls.
    pub force: f64,
    /// Moment arms (m), by virtual work minus the slope of the length over each coordinate: positive where it pulls the coordinate up.
    pub moment_arms: Vec<f64>,
    /// Active torque on each coordinate (N m).
    pub torque: Vec<f64>,
}

impl Isometric {
    /// At the pose `qpos` of an [exact](Plan::exact) plan with reduced coordinates (rad or m).
    ///
    /// # Panics
    /// `qpos` has another number of entries than the plan has coordinates.
    pub fn at(plan: &Plan<f64>, qpos: &[f64]) -> Self {
        let weightless = Plan { gravity: [0.0; 3], ..plan.clone() };
        let passive = at_rest(&weightless, qpos, 0.0);
        let (loaded, mut active) = (at_rest(plan, qpos, 0.0), at_rest(&weightless, qpos, 1.0));
        let (length, forces) = (active.tendon_length.clone(), active.muscle_force.clone());
        let mut pull = |muscle: usize| {
            // What a muscle does knows nothing of the others.
            let force = passive.muscle_force[muscle] - forces[muscle];
            let moment_arms: Vec<f64> =
                moment_arms(plan, muscle, &mut active).into_iter().map(|slope| -slope).collect();
            let torque = moment_arms.iter().map(|arm| arm * force).collect();
            Pull { length: length[muscle], force, moment_arms, torque }
        };
        let muscles = (0..plan.nmuscle()).map(&mut pull).collect();
        let gravity = loaded.torque.iter().zip(&passive.torque).map(|(loaded, passive)| loaded - passive).collect();
        Self { gravity, passive: passive.torque, muscles }
    }

    /// Torque (N m) of all muscles that pull coordinate `k` up, and of all that pull it down (negative), each fully active.
    pub fn strength(&self, k: usize) -> [f64; 2] {
        let torques = || self.muscles.iter().map(|muscle| muscle.torque[k]);
        [torques().filter(|&torque| torque > 0.0).sum(), torques().filter(|&torque| torque < 0.0).sum()]
    }

    /// Share of the muscles' strength that holds coordinate `k` against gravity alone; zero without gravity, and infinite where no muscle does.
    pub fn holding_share(&self, k: usize) -> f64 {
        let [up, down] = self.strength(k);
        let against = if self.gravity[k] < 0.0 { up } else { -down };
        if self.gravity[k] == 0.0 { 0.0 } else { self.gravity[k].abs() / against }
    }
}

/// All that a body at rest in a pose feels with each muscle active as far.
fn at_rest(plan: &Plan<f64>, qpos: &[f64], activation: f64) -> Workspace<f64> {
    let (mut state, mut ws) = (State::new(plan), Workspace::new(plan));
    state.qpos.copy_from_slice(qpos);
    state.act.fill(activation);
    forward(plan, &Obstacles::none(plan), &state, &mut ws);
    ws
}
