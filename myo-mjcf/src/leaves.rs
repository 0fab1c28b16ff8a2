//! What stands in bodies and has nothing in it: joints, geoms, sites, cameras, lights, mass.

use crate::classes::Class;
use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::pose::{Frame, stretch};
use crate::read::Reader;
use crate::table::{exclusive, need};
use crate::tree::Within;
use std::f64::consts::PI;

impl Reader<'_> {
    /// Reads what has nothing in it.
    #[inline(never)]
    pub(crate) fn leaf(&mut self, body: &mut Body, node: &Node, within: &Within) -> Result<(), MjcfError> {
        let class = self.classes.of(node, "class")?.unwrap_or_else(|| within.class.clone());
        match &*node.tag {
            "inertial" | "joint" | "freejoint" if within.in_world => {
                Err(node.misplaced("the world does not move; put it into a body"))
            }
            "inertial" => self.inertial(body, node, &within.frame),
            "joint" => self.joint(body, node, &within.frame, &class),
            "freejoint" => self.free_joint(body, node),
            "geom" => self.geom(body, node, &within.frame, &class),
            "site" => self.site(body, node, &within.frame, &class),
            "camera" => self.camera(body, node, &within.frame, &class),
            _ => self.light(body, node, &within.frame, &class),
        }
    }

    fn inertial(&mut self, body: &mut Body, node: &Node, frame: &Frame) -> Result<(), MjcfError> {
        let mut inertial = self.element(node, Inertial::default(), &[])?;
        need(node, &["pos"])?;
        for orientation in ["quat", "axisangle", "xyaxes", "zaxis", "euler", "diaginertia"] {
            exclusive(node, &["fullinertia", orientation])?;
        }
        inertial.pose.settle(node, &self.out.compiler)?;
        inertial.enter(frame);
        if let Some(first) = &body.inertial {
            return Err(MjcfError::Repeated { at: node.at(), first: first.place.clone() });
        }
        body.inertial = Some(inertial);
        Ok(())
    }

    fn joint(&mut self, body: &mut Body, node: &Node, frame: &Frame, class: &Class) -> Result<(), MjcfError> {
        let mut joint = self.element(node, (*class.joint).clone(), &[])?;
        if self.out.compiler.angle() == AngleUnit::Degree {
            joint.convert_degrees();
        }
        joint.enter(frame);
        body.joints.push(joint);
        Ok(())
    }

    /// A free joint without the class that `<joint type="free">` has.
    fn free_joint(&mut self, body: &mut Body, node: &Node) -> Result<(), MjcfError> {
        let FreeJoint { place, name, group, align, .. } = self.element(node, FreeJoint::default(), &[])?;
        body.joints.push(Joint { place, name, group, align, kind: Some(JointKind::Free), ..Joint::default() });
        Ok(())
    }

    fn geom(&mut self, body: &mut Body, node: &Node, frame: &Frame, class: &Class) -> Result<(), MjcfError> {
        let mut geom = self.element(node, (*class.geom).clone(), &[])?;
        geom.pose.settle(node, &self.out.compiler)?;
        if let Some(fromto) = geom.fromto.take() {
            let (shape, size) = (geom.kind(), geom.size());
            geom.size = Some(stretch(node, shape, fromto, &mut geom.pose, size)?);
        }
        geom.pose.enter(frame);
        body.geoms.push(geom);
        Ok(())
    }

    fn site(&mut self, body: &mut Body, node: &Node, frame: &Frame, class: &Class) -> Result<(), MjcfError> {
        let mut site = self.element(node, (*class.site).clone(), &[])?;
        site.pose.settle(node, &self.out.compiler)?;
        if let Some(fromto) = site.fromto.take() {
            let (shape, size) = (site.kind(), site.size());
            site.size = Some(stretch(node, shape, fromto, &mut site.pose, size)?);
        }
        site.pose.enter(frame);
        body.sites.push(site);
        Ok(())
    }

    fn camera(&mut self, body: &mut Body, node: &Node, frame: &Frame, class: &Class) -> Result<(), MjcfError> {
        let mut camera = self.element(node, (*class.camera).clone(), &[])?;
        exclusive(node, &["fovy", "sensorsize"])?;
        camera.pose.settle(node, &self.out.compiler)?;
        camera.pose.enter(frame);
        body.cameras.push(camera);
        Ok(())
    }

    fn light(&mut self, body: &mut Body, node: &Node, frame: &Frame, class: &Class) -> Result<(), MjcfError> {
        let mut light = (*class.light).clone();
        exclusive(node, &["directional", "type"])?;
        // One says again what the other said in a class.
        match (node.get("directional"), node.get("type")) {
            (Some(_), _) => light.kind = None,
            (_, Some(_)) => light.directional = None,
            _ => {}
        }
        let mut light = self.element(node, light, &[])?;
        light.enter(frame);
        body.lights.push(light);
        Ok(())
    }
}

impl Joint {
    fn convert_degrees(&mut self) {
        let hinge = self.kind() == JointKind::Hinge;
        if hinge || self.kind() == JointKind::Ball {
            self.range = self.range.map(|range| range.map(|angle| angle * (PI / 180.0)));
        }
        if hinge {
            for angle in [&mut self.reference, &mut self.springref, &mut self.springyield] {
                *angle = angle.map(|angle| angle * (PI / 180.0));
            }
        }
    }

    /// Moves it out of a frame. A free joint has no place, a ball joint no axis.
    pub(crate) fn enter(&mut self, frame: &Frame) {
        if self.kind() == JointKind::Free || *frame == Frame::identity() {
            return;
        }
        self.pos = Some(frame.point(self.pos()));
        if self.kind() != JointKind::Ball {
            self.axis = Some(frame.vector(self.axis()));
        }
    }
}

impl Light {
    /// Whether its rays are parallel, whichever attribute says so.
    pub fn is_directional(&self) -> bool {
        self.directional.unwrap_or(self.kind() == LightKind::Directional)
    }

    pub(crate) fn enter(&mut self, frame: &Frame) {
        if *frame != Frame::identity() {
            self.pos = Some(frame.point(self.pos()));
            self.dir = Some(frame.vector(self.dir()));
        }
    }
}

impl Inertial {
    pub(crate) fn enter(&mut self, frame: &Frame) {
        if *frame == Frame::identity() {
            return;
        }
        match self.fullinertia {
            // Its axes are those of the body, so its numbers turn.
            Some(inertia) => {
                self.fullinertia = Some(frame.inertia(inertia));
                self.pose.pos = Some(frame.point(self.pose.pos()));
            }
            None => self.pose.enter(frame),
        }
    }
}
