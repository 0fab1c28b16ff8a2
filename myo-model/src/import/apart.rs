//! Which geoms can never touch, however their joints stand.
//!
//! A point that hangs on hinges stays within a ball around the first of them: its radius is the way from each hinge to the next, and
//! to the point. So a floor that an arm does not come down to needs no contact.

use super::contacts::Held;
use super::meshes::Meshes;
use myo_mjcf::{Joint, JointKind, Mjcf, Shape};
use nalgebra::{Isometry3, Point3, Translation3};

/// Where everything is in the pose of the file.
pub(super) struct Apart<'a> {
    pub(super) mjcf: &'a Mjcf,
    pub(super) frames: Vec<Isometry3<f64>>,
    pub(super) meshes: &'a Meshes<'a>,
}

/// Where a geom stays, seen from a body that it hangs on.
enum Stays {
    /// Nobody knows.
    Anywhere,
    /// It stands still.
    Still,
    /// Within a ball.
    Ball(Point3<f64>, f64),
}

impl<'a> Apart<'a> {
    pub(super) fn of(mjcf: &'a Mjcf, meshes: &'a Meshes<'a>) -> Self {
        Self { mjcf, frames: frames(mjcf), meshes }
    }

    /// Whether two geoms never come within a margin (m) of each other.
    pub(super) fn always(&self, [one, other]: [Held<'_>; 2], margin: f64) -> bool {
        let ancestor = self.common_ancestor(one.body, other.body);
        match (self.stays(one, ancestor), self.stays(other, ancestor)) {
            (Stays::Ball(a, near), Stays::Ball(b, far)) => (a - b).norm() > near + far + margin,
            (Stays::Still, Stays::Ball(centre, radius)) => self.distance(one, &centre) > radius + margin,
            (Stays::Ball(centre, radius), Stays::Still) => self.distance(other, &centre) > radius + margin,
            _ => false,
        }
    }

    pub(super) fn common_ancestor(&self, mut one: usize, mut other: usize) -> usize {
        // A child stands after its parent.
        while one != other {
            if one > other {
                one = self.mjcf.bodies[one].parent;
            } else {
                other = self.mjcf.bodies[other].parent;
            }
        }
        one
    }

    fn stays(&self, held: Held<'_>, ancestor: usize) -> Stays {
        let mut ball: Option<(Point3<f64>, f64)> = None;
        let mut last = Point3::origin();
        for (body, joint) in self.joints_below(ancestor, held.body) {
            if !matches!(joint.kind(), JointKind::Hinge | JointKind::Ball) {
                return Stays::Anywhere;
            }
            let anchor = self.frames[body] * Point3::from(joint.pos());
            ball = Some(match ball {
                None => (anchor, 0.0),
                Some((centre, radius)) => (centre, radius + (anchor - last).norm()),
            });
            last = anchor;
        }
        let Some((centre, radius)) = ball else { return Stays::Still };
        match self.meshes.ball(held.geom) {
            Some((middle, own)) => {
                let at = self.frames[held.body] * frame(&held.geom.pose) * middle;
                Stays::Ball(centre, radius + (at - last).norm() + own)
            }
            None => Stays::Anywhere,
        }
    }

    /// Bodies from below an ancestor down to one, in this order.
    pub(super) fn bodies_below(&self, ancestor: usize, mut body: usize) -> Vec<usize> {
        let mut bodies = vec![];
        while body != ancestor {
            bodies.push(body);
            body = self.mjcf.bodies[body].parent;
        }
        bodies.reverse();
        bodies
    }

    /// Their joints, each with its body.
    pub(super) fn joints_below(&self, ancestor: usize, body: usize) -> Vec<(usize, &'a Joint)> {
        let mjcf = self.mjcf;
        let of = |body: usize| mjcf.bodies[body].joints.iter().map(move |joint| (body, joint));
        self.bodies_below(ancestor, body).into_iter().flat_map(of).collect()
    }

    /// Distance of a point from a geom that stands still, or less.
    fn distance(&self, held: Held<'_>, point: &Point3<f64>) -> f64 {
        self.surface(held.geom, &(self.frames[held.body] * frame(&held.geom.pose)), point)
    }

    /// Distance of a point from a geom at a place, or less.
    pub(super) fn surface(&self, geom: &myo_mjcf::Geom, place: &Isometry3<f64>, point: &Point3<f64>) -> f64 {
        let local = place.inverse() * point;
        if geom.mesh.is_some() {
            let ball = self.meshes.ball(geom);
            return ball.map_or(f64::NEG_INFINITY, |(middle, reach)| (local - middle).norm() - reach);
        }
        let [a, b, c] = geom.size();
        let across = local.x.hypot(local.y);
        match geom.kind() {
            Shape::Plane => local.z,
            Shape::Sphere => local.coords.norm() - a,
            Shape::Capsule => across.hypot((local.z.abs() - b).max(0.0)) - a,
            Shape::Cylinder => (across - a).max(0.0).hypot((local.z.abs() - b).max(0.0)),
            Shape::Box => {
                (local.x.abs() - a).max(0.0).hypot((local.y.abs() - b).max(0.0)).hypot((local.z.abs() - c).max(0.0))
            }
            Shape::Ellipsoid => local.coords.norm() - a.max(b).max(c),
            Shape::HeightField | Shape::Mesh | Shape::Sdf => f64::NEG_INFINITY,
        }
    }
}

/// Radius of a ball around the middle of a geom that holds it; none of one without end, or whose size its file does not tell.
pub(super) fn reach(geom: &myo_mjcf::Geom) -> Option<f64> {
    if geom.mesh.is_some() {
        return None;
    }
    let [a, b, c] = geom.size();
    match geom.kind() {
        Shape::Sphere => Some(a),
        Shape::Capsule => Some(a + b),
        Shape::Cylinder => Some(a.hypot(b)),
        Shape::Ellipsoid => Some(a.max(b).max(c)),
        Shape::Box => Some(a.hypot(b).hypot(c)),
        Shape::Plane | Shape::HeightField | Shape::Mesh | Shape::Sdf => None,
    }
}

/// Frames of all bodies in the pose of the file.
pub(super) fn frames(mjcf: &Mjcf) -> Vec<Isometry3<f64>> {
    let mut frames: Vec<Isometry3<f64>> = Vec::with_capacity(mjcf.bodies.len());
    for body in &mjcf.bodies {
        let pose = frame(&body.pose);
        // Parents stand before their children, and the world before all.
        frames.push(frames.get(body.parent).map_or(pose, |parent| parent * pose));
    }
    frames
}

pub(super) fn frame(pose: &myo_mjcf::Pose) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(pose.pos()), pose.rotation())
}
