//! What each muscle of a body at rest does to each coordinate: moment arm, force, torque.

use crate::obstacles::Obstacles;
use crate::plan::Plan;
use crate::step::forward;
use crate::workspace::{State, Workspace};

/// Half the difference (rad or m) over which the slope of a path's length is taken. The error is about its square over the square of
/// a path's curvature, and the rounding of a length over it: both under 1e-9 m.
const HALF_STEP: f64 = 1e-5;

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
    /// Moment arms (m), minus the slope of the length over each coordinate: positive where it pulls the coordinate up.
    pub moment_arms: Vec<f64>,
    /// Active torque on each coordinate (N m).
    pub torque: Vec<f64>,
}

impl Isometric {
    /// At the pose `qpos` of a plan with reduced coordinates (rad or m).
    ///
    /// # Panics
    /// `qpos` has another number of entries than the plan has coordinates.
    pub fn at(plan: &Plan<f64>, qpos: &[f64]) -> Self {
        let weightless = Plan { gravity: [0.0; 3], ..plan.clone() };
        let mut bench = Bench::new(&weightless);
        let (passive, resting) = bench.torque_and_forces(qpos, None);
        let (loaded, _) = Bench::new(plan).torque_and_forces(qpos, None);
        let slopes: Vec<Vec<f64>> = (0..plan.ndof()).map(|k| bench.slopes(qpos, k)).collect();
        let length = bench.lengths(qpos);
        let pull = |muscle: usize| {
            let (torque, forces) = bench.torque_and_forces(qpos, Some(muscle));
            Pull {
                length: length[muscle],
                force: resting[muscle] - forces[muscle],
                moment_arms: slopes.iter().map(|slope| -slope[muscle]).collect(),
                torque: difference(&torque, &passive),
            }
        };
        let muscles = (0..plan.nmuscle()).map(pull).collect();
        Self { gravity: difference(&loaded, &passive), passive, muscles }
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

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// A body to try poses on.
struct Bench<'a> {
    plan: &'a Plan<f64>,
    obstacles: Obstacles<f64, f64>,
    state: State<f64>,
    ws: Workspace<f64>,
}

impl<'a> Bench<'a> {
    fn new(plan: &'a Plan<f64>) -> Self {
        Self { plan, obstacles: Obstacles::none(plan), state: State::new(plan), ws: Workspace::new(plan) }
    }

    fn look(&mut self, qpos: &[f64], active: Option<usize>) {
        self.state.qpos.copy_from_slice(qpos);
        self.state.act.fill(0.0);
        active.into_iter().for_each(|muscle| self.state.act[muscle] = 1.0);
        forward(self.plan, &self.obstacles, &self.state, &mut self.ws);
    }

    /// Torques on the coordinates, and forces of the muscles, negative where they pull.
    fn torque_and_forces(&mut self, qpos: &[f64], active: Option<usize>) -> (Vec<f64>, Vec<f64>) {
        self.look(qpos, active);
        (self.ws.torque.clone(), self.ws.muscle_force.clone())
    }

    fn lengths(&mut self, qpos: &[f64]) -> Vec<f64> {
        self.look(qpos, None);
        self.ws.tendon_length.clone()
    }

    /// Slopes of all lengths over coordinate `k`.
    fn slopes(&mut self, qpos: &[f64], k: usize) -> Vec<f64> {
        let mut moved = |by: f64| {
            let mut qpos = qpos.to_vec();
            qpos[k] += by;
            self.lengths(&qpos)
        };
        let [after, before] = [moved(HALF_STEP), moved(-HALF_STEP)];
        difference(&after, &before).into_iter().map(|change| change / (2.0 * HALF_STEP)).collect()
    }
}
