//! What muscles can hold still, and how fast they can move the fingertip.

use crate::obstacles::Obstacles;
use crate::plan::Plan;
use crate::reach::ReachableSpace;
use crate::step::{fingertip, forward, kinematics::kinematics, step};
use crate::workspace::{State, Workspace};
use myo_scalar::{Counter, Scalar, Word, philox, seed_words, unit};
use std::sync::Arc;

/// Poses tried before a place counts as one that cannot be held.
const POSES: usize = 64;
/// Poses tried beside its centre.
const FEWER_POSES: usize = 16;
/// Sweeps of the search for activations; a few dozen are usual.
const MAX_SWEEPS: usize = 1000;
/// A torque that is left over counts as balanced below this share of what all muscles together can do to the coordinate.
const BALANCED: f64 = 1e-3;
/// Nearer than this (rad) to a limit, the limit carries what pushes against it.
const AT_LIMIT: f64 = 1e-2;
/// Movements that the greatest speed is taken from, and how long each lasts (s).
const MOVEMENTS: usize = 64;
/// See [`MOVEMENTS`].
const MOVEMENT_S: f64 = 0.4;
/// Time over which a speed is measured (s).
const SPEED_OVER_S: f64 = 0.02;

/// What the muscles of a plan can do.
#[derive(Clone, Debug)]
pub struct Strength {
    space: Arc<ReachableSpace>,
    /// Greatest torque of all muscles together on each coordinate, over some poses (N m).
    scale: Vec<f64>,
}

/// Generalised forces at rest, without constraints: `torque(act) = rest + sum_i act_i * muscles[i]` (N m).
#[derive(Clone, Debug)]
struct Torques {
    rest: Vec<f64>,
    muscles: Vec<Vec<f64>>,
}

impl Strength {
    /// Of the body whose poses `space` knows.
    pub fn new(space: Arc<ReachableSpace>) -> Self {
        let ndof = space.plan.ndof();
        let mut scale = vec![f64::MIN_POSITIVE; ndof];
        for number in 0..POSES {
            let torques = Torques::at(&space.plan, space.sampled(number).0);
            for (k, scale) in scale.iter_mut().enumerate() {
                *scale = scale.max(torques.muscles.iter().map(|torque| torque[k].abs()).sum());
            }
        }
        Self { space, scale }
    }

    /// Activations in [0, 1] under which a pose (rad) stays as it is when it is at rest; none if there are none. A
    /// coordinate at its limit may lean on it.
    pub fn hold(&self, pose: &[f64]) -> Option<Vec<f64>> {
        let plan = &self.space.plan;
        let torques = Torques::at(plan, pose);
        // In units in which all coordinates are about as strong.
        let scaled = |torque: &[f64]| -> Vec<f64> { torque.iter().zip(&self.scale).map(|(t, s)| t / s).collect() };
        let muscles = torques.muscles.iter().map(|torque| (scaled(torque), 1.0));
        let limits = plan.dofs.iter().enumerate().filter_map(|(k, dof)| {
            let [lo, hi] = dof.range?;
            let way = f64::from(i8::from(pose[dof.at] <= lo + AT_LIMIT) - i8::from(pose[dof.at] >= hi - AT_LIMIT));
            (way != 0.0).then(|| ((0..plan.ndof()).map(|j| if j == k { way } else { 0.0 }).collect(), f64::INFINITY))
        });
        let columns: Vec<(Vec<f64>, f64)> = muscles.chain(limits).collect();
        balance(scaled(&torques.rest), &columns).map(|mut found| {
            found.truncate(plan.nmuscle());
            found
        })
    }

    /// Whether muscles can hold the fingertip still somewhere in a sphere (m, from the shoulder centre): at its centre in
    /// any of 64 poses, or two thirds of the way to its surface in any of 16.
    pub fn holds(&self, centre_rel_shoulder: [f64; 3], radius: f64) -> bool {
        let can = |point, count| {
            let poses = self.space.poses_at(point, radius / 3.0, count);
            poses.iter().any(|pose| self.hold(pose).is_some())
        };
        let beside = [0, 1, 2].into_iter().flat_map(|axis| {
            [-1.0, 1.0].map(|sign| {
                let mut point = centre_rel_shoulder;
                point[axis] += sign * radius / 1.5;
                point
            })
        });
        can(centre_rel_shoulder, POSES) || beside.into_iter().any(|point| can(point, FEWER_POSES))
    }

    /// The greatest speed of the fingertip (m/s) in 64 movements, each from another pose, with all muscles fully active
    /// that drive the coordinates some way, and the others slack.
    pub fn fastest(&self) -> f64 {
        (0..MOVEMENTS).map(|number| self.speed(number)).fold(0.0, f64::max)
    }

    /// The greatest speed of the fingertip in one movement.
    fn speed(&self, number: usize) -> f64 {
        let plan = &self.space.plan;
        let (pose, _) = self.space.sampled(number);
        let torques = Torques::at(plan, pose);
        let way: Vec<f64> = (0..plan.ndof()).map(|k| uniform(number, k) - 0.5).collect();
        let drives =
            |torque: &Vec<f64>| torque.iter().zip(&self.scale).zip(&way).map(|((t, s), w)| t / s * w).sum::<f64>();
        let act: Vec<f64> = torques.muscles.iter().map(|torque| f64::from(u8::from(drives(torque) > 0.0))).collect();
        let (mut state, mut ws) =
            (State { qpos: pose.to_vec(), act: act.clone(), ..State::new(plan) }, Workspace::new(plan));
        let obstacles = Obstacles::none(plan);
        let held = (SPEED_OVER_S / plan.timestep).ceil().max(1.0) as usize;
        let mut tip = tip_at(plan, &state, &mut ws);
        let mut fastest: f64 = 0.0;
        for _ in 0..(MOVEMENT_S / (held as f64 * plan.timestep)).ceil() as usize {
            for _ in 0..held {
                step(plan, &obstacles, &act, &mut state, &mut ws);
            }
            let next = tip_at(plan, &state, &mut ws);
            let way = (0..3).map(|k| (next[k] - tip[k]).powi(2)).sum::<f64>().sqrt();
            fastest = fastest.max(way / (held as f64 * plan.timestep));
            tip = next;
        }
        fastest
    }
}

impl Torques {
    fn at(plan: &Plan<f64>, pose: &[f64]) -> Self {
        let (mut state, mut ws) = (State { qpos: pose.to_vec(), ..State::new(plan) }, Workspace::new(plan));
        let obstacles = Obstacles::none(plan);
        let mut torque = |active: Option<usize>| {
            state.act.fill(0.0);
            active.into_iter().for_each(|muscle| state.act[muscle] = 1.0);
            forward(plan, &obstacles, &state, &mut ws);
            ws.torque.clone()
        };
        let rest = torque(None);
        let alone = |muscle| torque(Some(muscle)).iter().zip(&rest).map(|(torque, rest)| torque - rest).collect();
        let muscles = (0..plan.nmuscle()).map(alone).collect();
        Self { rest, muscles }
    }
}

/// Shares `x` of the columns, each from 0 to its bound, for which `rest + sum_i x_i * column_i` vanishes; none if there
/// are none. Coordinate descent on half the squared sum (Luo and Tseng 1992: it converges linearly, whatever the rank).
fn balance(mut rest: Vec<f64>, columns: &[(Vec<f64>, f64)]) -> Option<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut shares = vec![0.0; columns.len()];
    for _ in 0..MAX_SWEEPS {
        for ((column, most), share) in columns.iter().zip(&mut shares) {
            let square = dot(column, column);
            if square > 0.0 {
                let next = (*share - dot(column, &rest) / square).clamp(0.0, *most);
                let change = next - *share;
                rest.iter_mut().zip(column).for_each(|(rest, column)| *rest += change * column);
                *share = next;
            }
        }
        if rest.iter().all(|rest| rest.abs() < BALANCED) {
            return Some(shares);
        }
    }
    None
}

fn tip_at(plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> [f64; 3] {
    kinematics(plan, &state.qpos, &state.qvel, ws);
    fingertip(plan, ws)
}

/// Uniform in [0, 1).
fn uniform(number: usize, entry: usize) -> f64 {
    let word = |x: usize| <f64 as Scalar>::Word::splat(x as u32);
    let counter =
        Counter { seed: seed_words(1), env: word(number), episode: word(0), step: word(0), stream: word(entry) };
    unit::<f64>(philox::<f64>(counter)[0])
}
