//! Whose body a model is, and the same body as large, as heavy and as strong as somebody else's.
//!
//! Segments are scaled by shares of stature and of body mass (de Leva 1996, doi 10.1016/0021-9290(95)00178-6), muscles keep the ratio of fibre and tendon, and
//! torques grow with body mass (Jaric 2002, doi 10.2165/00007256-200232100-00002).

use std::collections::HashMap;

use nalgebra::Point3;
#[cfg(feature = "files")]
use schemars::JsonSchema;
#[cfg(feature = "files")]
use serde::{Deserialize, Serialize};

use crate::description::{Body, Connection, Geom, Joint, ModelDescription, Muscle, Shape, Wrap, WrapShape};
use crate::error::{Element, ElementKind, ModelError};
use crate::model::{Model, Pulley, Site};

/// Sex, as far as proportions and strength differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(rename_all = "lowercase"))]
pub enum Sex {
    /// A woman.
    Female,
    /// A man.
    Male,
}

impl Sex {
    /// Shares of stature (lengths) and of body mass.
    fn shares(self) -> Shares {
        match self {
            Self::Male => Shares { upper_arm: (0.1618, 0.0271), forearm: (0.1545, 0.0162), hand: 0.0061 },
            Self::Female => Shares { upper_arm: (0.1586, 0.0255), forearm: (0.1523, 0.0138), hand: 0.0056 },
        }
    }

    /// Torque of a kilogram of body, as a share of a man's. In shoulder flexion women are half as strong as men (doi 10.1016/0268-0033(89)90046-6); the
    /// median woman weighs 0.79 of the median man (soldiers of ANSUR II).
    fn strength(self) -> f64 {
        match self {
            Self::Male => 1.0,
            Self::Female => 0.5 / (66.8 / 84.6),
        }
    }
}

/// Length as a share of stature with mass as a share of body mass; of the hand, whose length is the same share of women's and men's stature, the mass alone.
struct Shares {
    upper_arm: (f64, f64),
    forearm: (f64, f64),
    hand: f64,
}

/// Whose body a model is, and which of its bodies are which segment of the arm. What is in none belongs to the trunk.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "files", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "files", serde(deny_unknown_fields))]
pub struct Anthropometry {
    /// Sex.
    pub sex: Sex,
    /// Stature (m).
    pub height_m: f64,
    /// Body mass (kg).
    pub mass_kg: f64,
    /// Bodies of the upper arm.
    pub upper_arm: Vec<String>,
    /// Bodies of the forearm.
    pub forearm: Vec<String>,
    /// Bodies of the hand.
    pub hand: Vec<String>,
}

/// Somebody's sex, stature and mass; what is not said is as the model has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Size {
    /// Sex.
    pub sex: Option<Sex>,
    /// Stature (m).
    pub height_m: Option<f64>,
    /// Body mass (kg). Without it the mass goes with the square of the stature.
    pub mass_kg: Option<f64>,
}

/// How many times as long and as heavy.
#[derive(Clone, Copy)]
struct Scale {
    length: f64,
    mass: f64,
}

/// What a segment, a joint and a muscle are scaled by.
struct Scales {
    by_body: HashMap<String, Scale>,
    trunk: Scale,
    /// Of torques of muscles.
    torque: f64,
}

impl ModelDescription {
    /// The same body as large, as heavy and as strong as somebody of this size.
    ///
    /// # Errors
    /// The model does not tell whose body it is, or not how strong a muscle is.
    pub fn sized(mut self, size: &Size) -> Result<Self, ModelError> {
        if *size == Size::default() {
            return Ok(self);
        }
        let nobodys = || ModelError::NoAnthropometry { model: self.name.clone() };
        let own = self.anthropometry.clone().ok_or_else(nobodys)?;
        let theirs = own.of(size);
        let scales = Scales::new(&own, &theirs);
        let before = lengths(&Model::new(&self)?);
        self.bodies.iter_mut().for_each(|body| scales.body(body));
        self.joints.iter_mut().for_each(|joint| scales.joint(joint));
        for Connection { bodies, anchors, .. } in &mut self.connections {
            for (anchor, body) in anchors.iter_mut().zip(&*bodies) {
                *anchor = scales.point(*anchor, body);
            }
        }
        for site in &mut self.sites {
            site.pos = scales.point(site.pos, &site.body);
            if site.body != "world" {
                site.shape = site.shape.map(|shape| times(shape, scales.of(&site.body).length));
            }
        }
        self.geoms.iter_mut().for_each(|geom| scales.geom(geom));
        for look in &mut self.looks {
            let length = scales.of(&look.body).length;
            look.pos = look.pos.map(|x| x * length);
            look.step *= length;
        }
        self.wraps.iter_mut().for_each(|wrap| scales.wrap(wrap));
        for contact in &mut self.contacts {
            // What stands around keeps its size.
            let mut parts = self.geoms.iter().filter(|geom| geom.body != "world" && contact.geoms.contains(&geom.name));
            let length = parts.next().map_or(1.0, |geom| scales.of(&geom.body).length);
            // As the surfaces that twist and roll on each other.
            contact.torsional *= length;
            contact.rolling = contact.rolling.map(|x| x * length);
        }
        let after = lengths(&Model::new(&self)?);
        for (muscle, (before, after)) in self.muscles.iter_mut().zip(before.into_iter().zip(after)) {
            scales.muscle(muscle, if before > 0.0 { after / before } else { 1.0 })?;
        }
        self.anthropometry = Some(theirs);
        Ok(self)
    }
}

impl Anthropometry {
    /// Whose body it becomes.
    fn of(&self, size: &Size) -> Self {
        let height_m = size.height_m.unwrap_or(self.height_m);
        let as_stout = self.mass_kg * (height_m / self.height_m).powi(2);
        Self { sex: size.sex.unwrap_or(self.sex), height_m, mass_kg: size.mass_kg.unwrap_or(as_stout), ..self.clone() }
    }
}

impl Scales {
    fn new(own: &Anthropometry, theirs: &Anthropometry) -> Self {
        let trunk = Scale { length: theirs.height_m / own.height_m, mass: theirs.mass_kg / own.mass_kg };
        let (a, b) = (own.sex.shares(), theirs.sex.shares());
        let segment = |before: (f64, f64), after: (f64, f64)| Scale {
            length: trunk.length * after.0 / before.0,
            mass: trunk.mass * after.1 / before.1,
        };
        let segments = [
            (&own.upper_arm, segment(a.upper_arm, b.upper_arm)),
            (&own.forearm, segment(a.forearm, b.forearm)),
            (&own.hand, segment((1.0, a.hand), (1.0, b.hand))),
        ];
        let named = |(names, scale): (&Vec<String>, Scale)| names.clone().into_iter().map(move |name| (name, scale));
        let by_body = segments.into_iter().flat_map(named).collect();
        let torque = trunk.mass * theirs.sex.strength() / own.sex.strength();
        Self { by_body, trunk, torque }
    }

    fn of(&self, body: &str) -> Scale {
        self.by_body.get(body).copied().unwrap_or(self.trunk)
    }

    fn point(&self, point: [f64; 3], body: &str) -> [f64; 3] {
        let of = if body == "world" { 1.0 } else { self.of(body).length };
        point.map(|x| x * of)
    }

    fn body(&self, body: &mut Body) {
        let Scale { length, mass } = self.of(&body.name);
        body.pos = self.point(body.pos, &body.parent);
        body.com = body.com.map(|x| x * length);
        body.mass *= mass;
        body.inertia = body.inertia.map(|moment| moment * mass * length.powi(2));
    }

    fn joint(&self, joint: &mut Joint) {
        joint.pos = self.point(joint.pos, &joint.body);
        // As inertia, so that a small arm is no better damped.
        let Scale { length, mass } = self.of(&joint.body);
        let inertia = mass * length.powi(2);
        joint.stiffness *= inertia;
        joint.damping *= inertia;
        joint.armature *= inertia;
    }

    fn geom(&self, geom: &mut Geom) {
        if geom.body == "world" {
            return;
        }
        let length = self.of(&geom.body).length;
        geom.pos = geom.pos.map(|x| x * length);
        geom.shape = times(geom.shape, length);
    }

    fn wrap(&self, wrap: &mut Wrap) {
        if wrap.body == "world" {
            return;
        }
        let length = self.of(&wrap.body).length;
        wrap.pos = wrap.pos.map(|x| x * length);
        wrap.shape = match wrap.shape {
            WrapShape::Sphere { radius } => WrapShape::Sphere { radius: radius * length },
            WrapShape::Cylinder { radius, half_length } => {
                WrapShape::Cylinder { radius: radius * length, half_length: half_length * length }
            }
        };
    }

    /// Fibre and tendon keep their ratio; moment arms are as much longer as the path, so that a torque takes less force.
    fn muscle(&self, muscle: &mut Muscle, longer: f64) -> Result<(), ModelError> {
        let Muscle { name, parameters, limit, .. } = muscle;
        parameters.length_range = parameters.length_range.map(|x| x * longer);
        if let Some(limit) = limit {
            limit.range = limit.range.map(|x| x * longer);
            limit.margin *= longer;
        }
        for curve in [&mut parameters.gain, &mut parameters.bias] {
            let force = curve
                .force
                .as_mut()
                .ok_or_else(|| ModelError::NoForce { element: Element::new(ElementKind::Muscle, name) })?;
            *force *= self.torque / longer;
        }
        Ok(())
    }
}

/// A shape that is so many times as large.
fn times(shape: Shape, length: f64) -> Shape {
    match shape {
        Shape::Sphere { radius } => Shape::Sphere { radius: radius * length },
        Shape::Capsule { radius, half_length } => {
            Shape::Capsule { radius: radius * length, half_length: half_length * length }
        }
        Shape::Cylinder { radius, half_length } => {
            Shape::Cylinder { radius: radius * length, half_length: half_length * length }
        }
        Shape::Plane => Shape::Plane,
        Shape::Ellipsoid { radii } => Shape::Ellipsoid { radii: radii.map(|x| x * length) },
        Shape::Box { half_size } => Shape::Box { half_size: half_size.map(|x| x * length) },
        Shape::Mesh { hull, scale } => Shape::Mesh { hull, scale: scale * length },
    }
}

/// Lengths of the straight lines through the sites of each muscle, with all joints at zero (m).
fn lengths(model: &Model) -> Vec<f64> {
    let frames = model.frames_in_zero_pose();
    let site = |index: &usize| {
        let Site { body, pos, .. } = &model.sites[*index];
        frames[*body] * Point3::from(*pos)
    };
    let length = |muscle: &crate::model::Muscle| {
        let points: Vec<Point3<f64>> = muscle.path.iter().map(site).collect();
        let stretch = |(from, pulley): (usize, Option<&Pulley>)| {
            (points[from + 1] - points[from]).norm() / pulley.map_or(1.0, |pulley| pulley.divisor)
        };
        muscle.stretches().map(stretch).sum()
    };
    model.muscles.iter().map(length).collect()
}
