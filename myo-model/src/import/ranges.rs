//! Which geoms never touch as long as no joint is far beyond its limits.
//!
//! Limits are soft, so hinges may stand [`BEYOND`] beyond them here; limits softer than MuJoCo's own are none. Of a box of joint positions the middle is looked at: nothing moves farther from where it is there than the joints turn,
//! each by at most half of the box, times the longest lever. Where that does not do, the box is halved along the joint that moves most.

use super::apart::{Apart, frame};
use super::contacts::Held;
use myo_mjcf::{Joint, JointKind};
use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

/// How far hinges may be beyond their limits (rad).
const BEYOND: f64 = 0.35;
/// Boxes that are looked at, for a pair of geoms.
const MOST_BOXES: usize = 4096;

/// A joint on the way to a geom.
struct Stop<'a> {
    body: usize,
    joint: &'a Joint,
    range: [f64; 2],
    /// How far (m) the geom moves at most while the hinge turns by one.
    lever: f64,
}

impl Apart<'_> {
    /// Whether two geoms never come within a margin (m) of each other while every hinge between them is within its limits, or a little beyond. `range` tells limits that hold.
    pub(super) fn within_limits(
        &self,
        geoms: [Held<'_>; 2],
        margin: f64,
        range: impl Fn(&Joint) -> Option<[f64; 2]>,
    ) -> bool {
        let ancestor = self.common_ancestor(geoms[0].body, geoms[1].body);
        let [Some(one), Some(other)] = geoms.map(|held| self.stops(held, ancestor, &range)) else { return false };
        let (from_one, stops) = (one.len(), one.into_iter().chain(other).collect::<Vec<_>>());
        let mut boxes = vec![stops.iter().map(|stop| stop.range).collect::<Vec<_>>()];
        for _ in 0..MOST_BOXES {
            let Some(own) = boxes.pop() else { return true };
            let middle: Vec<f64> = own.iter().map(|[low, high]| 0.5 * (low + high)).collect();
            let [first, second] = [&stops[..from_one], &stops[from_one..]];
            let places = [
                self.place(geoms[0], ancestor, first, &middle[..from_one]),
                self.place(geoms[1], ancestor, second, &middle[from_one..]),
            ];
            let clear = self.clearance(geoms, places) - margin;
            if clear <= 0.0 {
                return false;
            }
            let moves: Vec<f64> =
                stops.iter().zip(&own).map(|(stop, [low, high])| 0.5 * (high - low) * stop.lever).collect();
            if moves.iter().sum::<f64>() < clear {
                continue;
            }
            let Some(widest) = (0..moves.len()).max_by(|&a, &b| moves[a].total_cmp(&moves[b])) else { return false };
            for half in [[own[widest][0], middle[widest]], [middle[widest], own[widest][1]]] {
                let mut part = own.clone();
                part[widest] = half;
                boxes.push(part);
            }
        }
        false
    }

    /// The joints between an ancestor and a geom, the ancestor's first; none if one of them may stand anywhere, or the geom has no end and moves.
    fn stops(
        &self,
        held: Held<'_>,
        ancestor: usize,
        range: impl Fn(&Joint) -> Option<[f64; 2]>,
    ) -> Option<Vec<Stop<'_>>> {
        let joints = self.joints_below(ancestor, held.body);
        if joints.is_empty() {
            return Some(vec![]);
        }
        let mut stops = vec![];
        let (middle, mut lever) = self.meshes.ball(held.geom)?;
        let mut last = self.frames[held.body] * frame(&held.geom.pose) * middle;
        for &(body, joint) in joints.iter().rev() {
            let anchor = self.frames[body] * Point3::from(joint.pos());
            lever += (last - anchor).norm();
            last = anchor;
            if joint.kind() != JointKind::Hinge {
                return None;
            }
            let [low, high] = range(joint)?;
            stops.push(Stop { body, joint, range: [low - BEYOND, high + BEYOND], lever });
        }
        stops.reverse();
        Some(stops)
    }

    /// Where a geom is, seen from an ancestor, with joints at these positions.
    fn place(&self, held: Held<'_>, ancestor: usize, stops: &[Stop<'_>], positions: &[f64]) -> Isometry3<f64> {
        let mut place = Isometry3::identity();
        for body in self.bodies_below(ancestor, held.body) {
            place *= frame(&self.mjcf.bodies[body].pose);
            for (stop, &position) in stops.iter().zip(positions).filter(|(stop, _)| stop.body == body) {
                place *= turned(stop.joint, position);
            }
        }
        place * frame(&held.geom.pose)
    }

    /// Distance (m) of two geoms at these places, or less.
    fn clearance(&self, geoms: [Held<'_>; 2], places: [Isometry3<f64>; 2]) -> f64 {
        let from = |one: usize, other: usize| {
            let (middle, reach) = self.meshes.ball(geoms[other].geom)?;
            Some(self.surface(geoms[one].geom, &places[one], &(places[other] * middle)) - reach)
        };
        [from(0, 1), from(1, 0)].into_iter().flatten().fold(f64::NEG_INFINITY, f64::max)
    }
}

/// What a hinge at an angle does to its body.
fn turned(joint: &Joint, angle: f64) -> Isometry3<f64> {
    let (anchor, axis) = (Vector3::from(joint.pos()), Unit::new_normalize(Vector3::from(joint.axis())));
    let turn = UnitQuaternion::from_axis_angle(&axis, angle);
    Isometry3::from_parts(Translation3::from(anchor - turn * anchor), turn)
}
