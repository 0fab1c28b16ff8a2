//! Where the fingertip, or another pointer, can get to.

use crate::plan::{Dof, DofKind, Plan};
use crate::step::{fingertip, kinematics::kinematics};
use crate::workspace::Workspace;
use myo_scalar::{Counter, Scalar, Word, philox, seed_words, unit};
use nalgebra::{Matrix3, Vector3};
use std::fmt;
use std::sync::Arc;

/// Poses in the cloud that searches start from: one per 6 cm or so of the arm's space.
const CLOUD: usize = 8192;
/// Halvings of the space of poses, along one coordinate each.
const HALVINGS: usize = 5;
/// A search starts in each of these regions, because from one alone it may end beside the goal.
const REGIONS: usize = 1 << HALVINGS;
/// Nearer than this (m) the fingertip is there: less than any target's size, more than what a search leaves.
const THERE: f64 = 1e-3;
/// Most rounds of one search; five to ten are usual.
const MAX_ROUNDS: usize = 40;
/// How far (m) one round tries to move: the derivative says little about more.
const LONGEST_STEP: f64 = 0.1;
/// A round that comes closer by less than this (m) ends the search.
const LEAST_GAIN: f64 = 1e-5;
/// By how much (rad) a coordinate is moved to see what the pointer does.
const DIFFERENCE: f64 = 1e-6;
/// What a coordinate without limits is searched over (rad).
const UNLIMITED: [f64; 2] = [-std::f64::consts::PI, std::f64::consts::PI];

/// Places of the body in a pose (m, from the shoulder centre, world axes).
#[derive(Clone, Copy, Debug)]
pub struct BodyPlaces {
    /// The fingertip.
    pub fingertip: [f64; 3],
    /// Elbow and wrist, of plans that [keep them](Plan::with_arm); else the fingertip.
    pub arm: [[f64; 3]; 2],
}

/// What points: its place (m) for a body and the point that is asked for.
pub type PointerPlace = Arc<dyn Fn(&BodyPlaces, [f64; 3]) -> [f64; 3] + Send + Sync>;

/// The points that the fingertip, or another pointer, can reach within the joint limits, couplings respected, forces aside.
///
/// A query starts from the nearest of some random poses and refines them (Levenberg 1944, Marquardt 1963, with the
/// coordinates held in their ranges). The result depends on the plan and the point alone.
#[derive(Clone)]
pub struct ReachableSpace {
    pub(crate) plan: Plan<f64>,
    /// What each coordinate is searched over; those of free bodies and ball joints are held.
    ranges: Vec<[f64; 2]>,
    /// What points; the fingertip without one.
    pointer: Option<PointerPlace>,
    /// Pose and places of the body.
    cloud: Vec<(Vec<f64>, BodyPlaces)>,
}

impl fmt::Debug for ReachableSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (poses, has_pointer) = (self.cloud.len(), self.pointer.is_some());
        f.debug_struct("ReachableSpace")
            .field("poses", &poses)
            .field("has_pointer", &has_pointer)
            .finish_non_exhaustive()
    }
}

/// The pose that brings the pointer nearest to a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    /// Positions, joints within their limits (rad or m).
    pub pose: Vec<f64>,
    /// Where the pointer is then (m, from the shoulder centre, world axes).
    pub point: [f64; 3],
    /// What is left to the point that was asked for (m): zero where the fingertip can get.
    pub distance_m: f64,
}

/// One search: pose, what is left to the goal, and the derivative of the pointer, one column per coordinate.
struct Search<'a> {
    space: &'a ReachableSpace,
    goal: Vector3<f64>,
    ws: Workspace<f64>,
    still: Vec<f64>,
}

impl ReachableSpace {
    /// Samples the poses of a plan, whose fingertip points.
    pub fn new(plan: &Plan<f64>) -> Self {
        Self::sample(plan, None)
    }

    /// The same for another pointer.
    pub fn of_pointer(plan: &Plan<f64>, pointer: PointerPlace) -> Self {
        Self::sample(plan, Some(pointer))
    }

    fn sample(plan: &Plan<f64>, pointer: Option<PointerPlace>) -> Self {
        let range = |dof: &Dof<f64>| match dof.kind {
            DofKind::Joint => dof.range.unwrap_or(UNLIMITED),
            DofKind::Place | DofKind::Turn => [plan.qpos0[dof.at]; 2],
        };
        let ranges: Vec<[f64; 2]> = plan.dofs.iter().map(range).collect();
        let mut space = Self { plan: plan.clone(), ranges, pointer, cloud: vec![] };
        let mut search = Search::new(&space, Vector3::zeros());
        let cloud = (0..CLOUD).map(|k| space.pose(k)).map(|pose| {
            let places = search.places(&pose);
            (pose, places)
        });
        space.cloud = cloud.collect();
        space
    }

    /// Where the pointer is.
    fn point(&self, places: &BodyPlaces, goal: Vector3<f64>) -> Vector3<f64> {
        match &self.pointer {
            Some(pointer) => pointer(places, goal.into()).into(),
            None => places.fingertip.into(),
        }
    }

    /// A pose drawn at random from the region that its number belongs to.
    fn pose(&self, number: usize) -> Vec<f64> {
        let word = <f64 as Scalar>::Word::splat;
        let draw = |dof: usize| {
            let [env, stream, zero] = [word(number as u32), word(dof as u32), word(0)];
            unit::<f64>(philox::<f64>(Counter { seed: seed_words(0), env, episode: zero, step: zero, stream })[0])
        };
        let region = number * REGIONS / CLOUD;
        let before = |dof: usize| (0..dof).filter(|&dof| self.is_searched(dof)).count();
        let share = |dof: usize| match before(dof) {
            number @ 0..HALVINGS => 0.5 * (draw(dof) + f64::from(u8::from(region >> number & 1 == 1))),
            _ => draw(dof),
        };
        self.plan.pose(|dof, _| {
            let [lo, hi] = self.ranges[dof];
            lo + (hi - lo) * share(dof)
        })
    }

    fn is_searched(&self, dof: usize) -> bool {
        self.plan.dofs[dof].kind == DofKind::Joint
    }

    /// The pose, within the joint limits, that brings the pointer nearest to a point, which is relative to the shoulder
    /// centre, in world axes. Less than a millimetre away counts as there.
    pub fn nearest(&self, point_rel_shoulder: [f64; 3]) -> Nearest {
        let goal = Vector3::from(point_rel_shoulder);
        let mut search = Search::new(self, goal);
        let mut best = Nearest { pose: vec![], point: [f64::NAN; 3], distance_m: f64::INFINITY };
        for start in self.starts(goal) {
            let found = search.refine(goal, start.clone());
            if found.distance_m < best.distance_m {
                best = found;
            }
            if best.distance_m < THERE {
                return Nearest { distance_m: 0.0, ..best };
            }
        }
        best
    }

    /// How far (m) a point stays from the pointer at best, zero where the pointer can get. The point is relative to
    /// the shoulder centre, in world axes.
    pub fn distance_out_of_reach(&self, point_rel_shoulder: [f64; 3]) -> f64 {
        self.nearest(point_rel_shoulder).distance_m
    }

    /// Up to `count` poses with the pointer at most `radius` (m) from a point, as unlike each other as those sampled
    /// near it are; none where it is out of reach.
    pub fn poses_at(&self, point_rel_shoulder: [f64; 3], radius: f64, count: usize) -> Vec<Vec<f64>> {
        let goal = Vector3::from(point_rel_shoulder);
        let mut search = Search::new(self, goal);
        let mut nearest: Vec<_> =
            self.cloud.iter().map(|(pose, at)| ((self.point(at, goal) - goal).norm_squared(), pose)).collect();
        let count = count.min(nearest.len());
        nearest.select_nth_unstable_by(count.saturating_sub(1), |a, b| a.0.total_cmp(&b.0));
        nearest.truncate(count);
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        let near = nearest.into_iter().map(|(_, pose)| pose);
        let found = self.starts(goal).into_iter().chain(near).map(|pose| search.refine(goal, pose.clone()));
        found.filter(|found| found.distance_m <= radius.max(THERE)).map(|found| found.pose).take(count).collect()
    }

    /// A sampled pose and its fingertip; every number below a few thousand has another, from all regions in turn.
    pub(crate) fn sampled(&self, number: usize) -> (&[f64], Vector3<f64>) {
        let (pose, places) = &self.cloud[(number % REGIONS * (CLOUD / REGIONS) + number / REGIONS) % CLOUD];
        (pose, places.fingertip.into())
    }

    /// From each region of the poses the one whose fingertip is nearest to a point, nearest first.
    fn starts(&self, goal: Vector3<f64>) -> Vec<&Vec<f64>> {
        let mut nearest = [(f64::INFINITY, 0); REGIONS];
        for (k, (_, places)) in self.cloud.iter().enumerate() {
            let distance = (self.point(places, goal) - goal).norm_squared();
            let region = &mut nearest[k * REGIONS / CLOUD];
            if distance < region.0 {
                *region = (distance, k);
            }
        }
        nearest.sort_by(|a, b| a.0.total_cmp(&b.0));
        nearest.iter().map(|&(_, k)| &self.cloud[k].0).collect()
    }
}

impl<'a> Search<'a> {
    fn new(space: &'a ReachableSpace, goal: Vector3<f64>) -> Self {
        Self { space, goal, ws: Workspace::new(&space.plan), still: vec![0.0; space.plan.ndof()] }
    }

    fn places(&mut self, pose: &[f64]) -> BodyPlaces {
        let plan = &self.space.plan;
        kinematics(plan, pose, &self.still, &mut self.ws);
        let fingertip = fingertip(plan, &self.ws);
        let arm = plan.arm.as_ref().map(|arm| arm.each_ref().map(|point| self.ws.place(point).array()));
        BodyPlaces { fingertip, arm: arm.unwrap_or([fingertip; 2]) }
    }

    fn tip(&mut self, pose: &[f64]) -> Vector3<f64> {
        let places = self.places(pose);
        self.space.point(&places, self.goal)
    }

    /// Velocity of the pointer per unit of each coordinate's speed, at the last pose, which is `pose`.
    fn jacobian(&mut self, pose: &[f64], tip: Vector3<f64>) -> Vec<Vector3<f64>> {
        let plan = &self.space.plan;
        if self.space.pointer.is_some() {
            return self.differences(pose, tip);
        }
        let at = crate::spatial::Vec3::new(tip.x, tip.y, tip.z);
        let column = |screw: Option<usize>| screw.map_or([0.0; 3], |screw| self.ws.screw[screw].at(at).array());
        plan.links[plan.fingertip.link].screw_of_dof.iter().map(|&screw| column(screw).into()).collect()
    }

    /// The same by differences: of a pointer only its place is known.
    fn differences(&mut self, pose: &[f64], tip: Vector3<f64>) -> Vec<Vector3<f64>> {
        let (mut near, ndof) = (pose.to_vec(), self.space.ranges.len());
        let column = |k: usize| {
            if !self.space.is_searched(k) {
                return Vector3::zeros();
            }
            let at = self.space.plan.dofs[k].at;
            near[at] = pose[at] + DIFFERENCE;
            let moved = self.tip(&near);
            near[at] = pose[at];
            (moved - tip) / DIFFERENCE
        };
        (0..ndof).map(column).collect()
    }

    /// Moves from `pose` towards the goal as far as possible.
    fn refine(&mut self, goal: Vector3<f64>, mut pose: Vec<f64>) -> Nearest {
        let mut tip = self.tip(&pose);
        let mut jacobian = self.jacobian(&pose, tip);
        let mut left = (goal - tip).norm_squared();
        let mut damping = 1e-3;
        for _ in 0..MAX_ROUNDS {
            if left < THERE * THERE {
                break;
            }
            let way = (goal - tip).cap_magnitude(LONGEST_STEP);
            let next = self.moved(&pose, &jacobian, way, damping);
            let next_tip = self.tip(&next);
            let next_left = (goal - next_tip).norm_squared();
            if next_left < left {
                let gain = left.sqrt() - next_left.sqrt();
                (pose, tip, left, damping) = (next, next_tip, next_left, damping * 0.1);
                jacobian = self.jacobian(&pose, tip);
                if gain < LEAST_GAIN && damping < 1e-3 {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e2 {
                    break;
                }
            }
        }
        Nearest { pose, point: tip.into(), distance_m: left.sqrt() }
    }

    /// A step `J^T (J J^T + damping)^-1 way` of the coordinates that are not held by a limit, cut at the limits.
    fn moved(&self, pose: &[f64], jacobian: &[Vector3<f64>], way: Vector3<f64>, damping: f64) -> Vec<f64> {
        let dofs = &self.space.plan.dofs;
        let held = |k: usize| {
            let (at, [lo, hi], slope) = (dofs[k].at, self.space.ranges[k], jacobian[k].dot(&way));
            !self.space.is_searched(k) || pose[at] <= lo && slope < 0.0 || pose[at] >= hi && slope > 0.0
        };
        let free: Vec<bool> = (0..dofs.len()).map(|k| !held(k)).collect();
        let mut square = Matrix3::identity() * damping;
        for (column, _) in jacobian.iter().zip(&free).filter(|(_, free)| **free) {
            square += column * column.transpose();
        }
        // Positive definite, whatever the columns are.
        let dual = square.cholesky().map_or_else(Vector3::zeros, |c| c.solve(&way));
        let mut moved = pose.to_vec();
        for (k, dof) in dofs.iter().enumerate().filter(|(k, _)| free[*k]) {
            let [lo, hi] = self.space.ranges[k];
            moved[dof.at] = (pose[dof.at] + jacobian[k].dot(&dual)).clamp(lo, hi);
        }
        moved
    }
}
