//! A body with its other arm.

use crate::description::{Joint, JointKind, ModelDescription};

impl ModelDescription {
    /// The same body mirrored at the plane between left and right (`y = 0`): a right arm becomes a left one.
    ///
    /// Every frame is mirrored with what is fixed to it, and every hinge turns the other way round in space, so that a joint angle means to the left
    /// arm what it meant to the right one, and the same controls move both alike.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        for body in &mut self.bodies {
            body.pos = point(body.pos);
            body.quat = turn(body.quat);
            body.com = point(body.com);
            body.inertia_quat = turn(body.inertia_quat);
        }
        for joint in &mut self.joints {
            joint.pos = point(joint.pos);
            joint.axis = axis(joint);
        }
        for connection in &mut self.connections {
            connection.anchors = connection.anchors.map(point);
            if let Some(weld) = &mut connection.weld {
                weld.quat = turn(weld.quat);
            }
        }
        for site in &mut self.sites {
            site.pos = point(site.pos);
            site.quat = turn(site.quat);
        }
        for geom in &mut self.geoms {
            geom.pos = point(geom.pos);
            geom.quat = turn(geom.quat);
        }
        for wrap in &mut self.wraps {
            wrap.pos = point(wrap.pos);
            wrap.quat = turn(wrap.quat);
        }
        // What is seen is seen in the mirror, too; a surface that is inside out is none.
        self.looks.clear();
        self.options.gravity = point(self.options.gravity);
        self
    }
}

/// A point, or a direction along which something moves.
fn point([x, y, z]: [f64; 3]) -> [f64; 3] {
    [x, -y, z]
}

/// An orientation: what is turned about `a` by an angle is turned about the mirrored `-a`.
fn turn([w, x, y, z]: [f64; 4]) -> [f64; 4] {
    [w, -x, y, -z]
}

fn axis(joint: &Joint) -> [f64; 3] {
    let [x, y, z] = joint.axis;
    match joint.kind {
        JointKind::Hinge => [-x, y, -z],
        JointKind::Slide | JointKind::Ball | JointKind::Free => point(joint.axis),
    }
}
