//! Parts of the body that do not pass through each other.

use super::build::Tree;
use super::{FixedFrame, PlanError, Point};
use crate::impedance::{Impedance, pyramid_diagonal};
use myo_model::Model;
use myo_model::description::Shape;
use myo_model::model::{Contact, Geom};
use nalgebra::Vector3;

/// Two parts that do not pass through each other.
#[derive(Clone, Debug)]
pub struct ContactPair<C> {
    /// Their shapes, an ellipsoid first.
    pub parts: [Part<C>; 2],
    /// Square of the distance of their middles (m^2) from which on they do not touch.
    pub far: C,
    /// Distance at which the contact force begins (m).
    pub margin: C,
    /// Sliding friction.
    pub friction: C,
    /// Whether there is none: then there is one row, along the normal.
    pub is_slippery: bool,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia of every row.
    pub diagonal: C,
}

/// A part of the body that others touch.
#[derive(Clone, Debug)]
pub struct Part<C> {
    /// Its middle, and its axes as columns.
    pub frame: FixedFrame<C>,
    /// Its shape.
    pub form: PartForm<C>,
    /// Centre of mass of the model's body that it is fixed to: where the inverse inertia is measured.
    pub body_com: Point<C>,
}

/// Shape of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PartForm<C> {
    /// A ball, or half a ball on each end of a cylinder about the z axis.
    Capsule {
        /// Radius (m).
        radius: C,
        /// Half of the length without the balls (m); zero for a ball.
        half_length: C,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Semi-axes (m).
        radii: [C; 3],
    },
}

impl<C> ContactPair<C> {
    /// The links of both parts.
    pub(crate) fn links(&self) -> [usize; 2] {
        [self.parts[0].frame.origin.link, self.parts[1].frame.origin.link]
    }
}

impl<C> Part<C> {
    /// Links that it refers to.
    pub(super) fn links(&self) -> [usize; 2] {
        [self.frame.origin.link, self.body_com.link]
    }

    /// Points that it refers to.
    pub(super) fn points_mut(&mut self) -> [&mut Point<C>; 2] {
        [&mut self.frame.origin, &mut self.body_com]
    }
}

impl ContactPair<f64> {
    /// Sets the inverse inertia of the rows from the inverse masses of both bodies (1/kg).
    pub(super) fn weigh(&mut self, [one, other]: [f64; 2]) {
        self.diagonal = if self.is_slippery { one + other } else { pyramid_diagonal(self.friction, one + other) };
    }
}

/// All pairs of a model.
pub(super) fn pairs(model: &Model, tree: &Tree) -> Result<Vec<ContactPair<f64>>, PlanError> {
    let mut pairs = Vec::with_capacity(model.contacts.len());
    for contact in &model.contacts {
        pairs.push(pair(model, tree, contact)?);
    }
    Ok(pairs)
}

fn pair(model: &Model, tree: &Tree, contact: &Contact) -> Result<ContactPair<f64>, PlanError> {
    let geoms = contact.geoms.map(|geom| &model.geoms[geom]);
    let unlike = || PlanError::UnlikeParts { geoms: geoms.map(|geom| geom.name.clone()) };
    let [first, second] = geoms.map(|geom| part(model, tree, geom));
    let mut parts = [first.ok_or_else(unlike)?, second.ok_or_else(unlike)?];
    let is_ellipsoid = |part: &Part<f64>| matches!(part.form, PartForm::Ellipsoid { .. });
    if is_ellipsoid(&parts[1]) {
        parts.swap(0, 1);
    }
    if is_ellipsoid(&parts[1]) {
        return Err(unlike());
    }
    let reach: f64 = parts.iter().map(|part| part.form.reach()).sum();
    Ok(ContactPair {
        parts,
        far: (reach + contact.margin).powi(2),
        margin: contact.margin,
        friction: contact.friction,
        is_slippery: contact.friction == 0.0,
        impedance: Impedance::new(&contact.softness, model.options.timestep),
        diagonal: 0.0,
    })
}

fn part(model: &Model, tree: &Tree, geom: &Geom) -> Option<Part<f64>> {
    let form = match geom.shape {
        Shape::Sphere { radius } => PartForm::Capsule { radius, half_length: 0.0 },
        Shape::Capsule { radius, half_length } => PartForm::Capsule { radius, half_length },
        Shape::Ellipsoid { radii } => PartForm::Ellipsoid { radii },
        Shape::Box { .. } => return None,
    };
    let com: Vector3<f64> = model.bodies[geom.body].com;
    Some(Part { frame: tree.placed(geom.body, geom.pos, geom.quat), form, body_com: tree.point(geom.body, com) })
}

impl PartForm<f64> {
    /// Radius of a ball around its middle that holds it (m).
    fn reach(&self) -> f64 {
        match *self {
            Self::Capsule { radius, half_length } => radius + half_length,
            Self::Ellipsoid { radii } => radii.into_iter().fold(0.0, f64::max),
        }
    }
}
