//! Parts of the body that do not pass through each other.

use super::build::Tree;
use super::{FixedFrame, Movers, Plan, PlanError, Point};
use crate::impedance::{Impedance, Scaled, pyramid_diagonal};
use crate::mesh::{BOX_CONTACTS, Hull, MOST_CONTACTS};
use crate::step::LOWEST;
use myo_model::Model;
use myo_model::description::{Cone, Shape};
use myo_model::model::{Contact, Geom};
use nalgebra::Vector3;
use std::sync::Arc;

/// Two parts that do not pass through each other.
#[derive(Clone, Debug)]
pub struct ContactPair<C> {
    /// Their shapes, in the order of [`PartForm`].
    pub parts: [Part<C>; 2],
    /// Distance of their middles, of the second's from a plane or cylinder, or of a capsule's from a box (m), from which on they do not touch.
    pub far: C,
    /// Number of its first contact among those of all pairs.
    pub slot: usize,
    /// In how many points they may touch: a rod lies on something flat with both its ends.
    pub points: usize,
    /// How many dimensions the force in a point has, as MuJoCo counts them: 1 without friction, 3 with what resists sliding, 4 with what resists twisting as well, and
    /// 6 with what resists rolling.
    pub condim: usize,
    /// Whether friction is that along the axis of the second part and across: of rods on a plane, as MuJoCo has it.
    pub is_along_axis: bool,
    /// Distance at which the contact force begins (m).
    pub margin: C,
    /// Whether its forces are in an elliptic cone; else each direction has two opposite edges.
    pub is_cone: bool,
    /// What resists sliding along two directions, twisting (m) and rolling about both directions (m).
    pub friction: [C; 5],
    /// Of cones: how much force along the normal counts as much as sliding, of which each direction counts as its friction.
    pub opening: C,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia of every row.
    pub diagonal: C,
    /// What the share of it in the regularisation is not below.
    pub least: C,
    /// Coordinates that move the parts against each other.
    pub movers: Movers,
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
    /// All that is below a plane, the z axis up.
    Plane,
    /// A cylinder about the z axis.
    Cylinder {
        /// Radius (m).
        radius: C,
        /// Half of its length (m).
        half_length: C,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Semi-axes (m).
        radii: [C; 3],
    },
    /// A ball, or half a ball on each end of a cylinder about the z axis.
    Capsule {
        /// Radius (m).
        radius: C,
        /// Half of the length without the balls (m); zero for a ball.
        half_length: C,
    },
    /// A box.
    Box {
        /// Half of its sides (m).
        half_size: [C; 3],
    },
    /// A convex mesh, or a box beside one or beside a cylinder or an ellipsoid, by its number among the plan's.
    Mesh(usize),
}

impl<C> ContactPair<C> {
    /// How many contacts a point takes, each of four rows: the edges of two directions of friction, or as many dimensions of a cone.
    pub fn slots_each(&self) -> usize {
        if self.is_cone { self.condim.div_ceil(4) } else { (self.condim / 2).max(1) }
    }

    /// How many all of them take.
    pub fn slots(&self) -> usize {
        self.points * self.slots_each()
    }

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

impl<C> Plan<C> {
    /// Numbers among the contacts of pairs, one for each point in which parts may touch: the others of a point resist twisting and rolling.
    pub fn pair_points(&self) -> impl Iterator<Item = usize> {
        let points = |pair: &ContactPair<C>| (pair.slot..pair.slot + pair.slots()).step_by(pair.slots_each());
        self.pairs.iter().flat_map(points)
    }

    /// Whether forces of any pair are in an elliptic cone.
    pub fn has_cones(&self) -> bool {
        self.pairs.iter().any(|pair| pair.is_cone)
    }

    /// Whether some contacts are looked for [one body at a time](Scalar::lane_by_lane): those of convex meshes, and of boxes with anything but planes and
    /// capsules. Graphics cards do not do that.
    pub fn touches_one_by_one(&self) -> bool {
        let is_box = |part: &Part<C>| matches!(part.form, PartForm::Box { .. });
        !self.hulls.is_empty() || self.pairs.iter().any(|pair| pair.parts.iter().all(is_box))
    }

    /// Contacts that there may be between parts.
    pub(crate) fn pair_contacts(&self) -> usize {
        self.pairs.last().map_or(0, |last| last.slot + last.slots())
    }
}

impl ContactPair<f64> {
    /// Sets the inverse inertia of the rows from the inverse masses of both bodies (1/kg).
    pub(super) fn weigh(&mut self, [one, other]: [f64; 2], impratio: f64) {
        let mass = one + other;
        let scaled = match self.condim {
            1 => Scaled::new(mass, 1.0),
            _ if self.is_cone => Scaled::new(mass, self.opening * self.opening),
            _ => pyramid_diagonal(self.friction[0], impratio, mass),
        };
        (self.diagonal, self.least) = (scaled.diagonal, scaled.least);
    }
}

/// All pairs of a model, and their convex meshes.
type Pairs = (Vec<ContactPair<f64>>, Vec<Arc<Hull>>);

/// All pairs of a model.
pub(super) fn pairs(model: &Model, tree: &Tree) -> Result<Pairs, PlanError> {
    let (mut pairs, mut slot) = (Vec::with_capacity(model.contacts.len()), 0);
    let mut hulls = Hulls::default();
    for contact in &model.contacts {
        let pair = ContactPair { slot, ..pair(model, tree, contact, &mut hulls)? };
        slot += pair.slots();
        pairs.push(pair);
    }
    Ok((pairs, hulls.all))
}

fn pair(model: &Model, tree: &Tree, contact: &Contact, hulls: &mut Hulls) -> Result<ContactPair<f64>, PlanError> {
    let mut geoms = contact.geoms;
    // Which one of two meshes is the first counts: that which stands first.
    geoms.sort_unstable_by_key(|&geom| matches!(model.geoms[geom].shape, Shape::Mesh { .. }).then_some(geom));
    let geoms = geoms.map(|geom| &model.geoms[geom]);
    let unlike = || PlanError::UnlikeParts { geoms: geoms.map(|geom| geom.name.clone()) };
    let mut parts = geoms.map(|geom| part(model, tree, geom, hulls));
    parts.sort_by_key(|part| part.form.rank());
    hulls.take_for_boxes(&mut parts);
    let is_flat = |form: PartForm<f64>| matches!(form, PartForm::Plane | PartForm::Cylinder { .. });
    let [one, other] = parts.each_ref().map(|part| part.form);
    if matches!(
        (one, other),
        (PartForm::Plane, PartForm::Plane) | (PartForm::Cylinder { .. }, PartForm::Cylinder { .. })
    ) {
        return Err(unlike());
    }
    let is_rod = matches!(other, PartForm::Capsule { .. }) && !is_ball(other);
    let is_capsule_on_box = matches!((one, other), (PartForm::Capsule { .. }, PartForm::Box { .. }));
    let first_reach = if is_flat(one) { 0.0 } else { one.reach(hulls) };
    let second_reach = if is_capsule_on_box { 0.0 } else { other.reach(hulls) };
    Ok(ContactPair {
        far: first_reach + second_reach + contact.margin,
        slot: 0,
        points: points(one, other),
        is_along_axis: one == PartForm::Plane && is_rod,
        parts,
        margin: contact.margin,
        friction: contact.friction,
        condim: contact.condim(),
        is_cone: contact.condim() > 1 && model.options.cone == Cone::Elliptic,
        opening: contact.friction[0] / model.options.impratio.sqrt(),
        impedance: Impedance::new(&contact.softness, model.options.timestep),
        diagonal: 0.0,
        least: 0.0,
        movers: Movers::default(),
    })
}

/// In how many points two parts may touch.
fn points(one: PartForm<f64>, other: PartForm<f64>) -> usize {
    match (one, other) {
        (PartForm::Ellipsoid { .. }, PartForm::Mesh(_)) => 1,
        (PartForm::Capsule { .. }, PartForm::Mesh(_)) if is_ball(one) => 1,
        (PartForm::Capsule { .. }, PartForm::Mesh(_)) => 2,
        (_, PartForm::Mesh(_)) => MOST_CONTACTS,
        (PartForm::Box { .. }, PartForm::Box { .. }) => BOX_CONTACTS,
        (PartForm::Plane, PartForm::Box { .. } | PartForm::Cylinder { .. }) => LOWEST,
        (PartForm::Plane | PartForm::Cylinder { .. }, PartForm::Capsule { .. }) if !is_ball(other) => 2,
        (PartForm::Capsule { .. }, PartForm::Box { .. }) if !is_ball(one) => 2,
        _ => 1,
    }
}

/// A capsule without length.
fn is_ball(form: PartForm<f64>) -> bool {
    matches!(form, PartForm::Capsule { half_length, .. } if half_length == 0.0)
}

fn part(model: &Model, tree: &Tree, geom: &Geom, hulls: &mut Hulls) -> Part<f64> {
    let com: Vector3<f64> = model.bodies[geom.body].com;
    let frame = tree.placed(geom.body, geom.pos, geom.quat);
    Part { frame, form: form(model, geom.shape, hulls), body_com: tree.point(geom.body, com) }
}

/// Convex meshes of all pairs.
#[derive(Default)]
struct Hulls {
    all: Vec<Arc<Hull>>,
    /// What each of them is.
    sources: Vec<HullSource>,
}

/// What a convex mesh is, its sizes as bits.
#[derive(Clone, Copy, PartialEq, Eq)]
enum HullSource {
    /// A hull of the model, so much larger.
    Model { hull: usize, scale: u64 },
    /// A box of these half sides.
    Box([u64; 3]),
}

impl Hulls {
    /// The number of the hull of a model, of this size.
    fn number(&mut self, model: &Model, hull: usize, scale: f64) -> usize {
        let source = HullSource::Model { hull, scale: scale.to_bits() };
        self.of_source(source, || Hull::new(&model.hulls[hull], scale))
    }

    /// Boxes are convex meshes beside whatever else is looked for as one.
    fn take_for_boxes(&mut self, [one, other]: &mut [Part<f64>; 2]) {
        match (one.form, other.form) {
            (PartForm::Cylinder { .. } | PartForm::Ellipsoid { .. }, PartForm::Box { half_size }) => {
                other.form = self.of_box(half_size);
            }
            (PartForm::Box { half_size }, PartForm::Mesh(_)) => one.form = self.of_box(half_size),
            _ => {}
        }
    }

    fn of_box(&mut self, half_size: [f64; 3]) -> PartForm<f64> {
        let source = HullSource::Box(half_size.map(f64::to_bits));
        PartForm::Mesh(self.of_source(source, || Hull::of_box(half_size)))
    }

    fn of_source(&mut self, source: HullSource, make: impl FnOnce() -> Hull) -> usize {
        self.sources.iter().position(|other| *other == source).unwrap_or_else(|| {
            self.sources.push(source);
            self.all.push(Arc::new(make()));
            self.all.len() - 1
        })
    }
}

fn form(model: &Model, shape: Shape, hulls: &mut Hulls) -> PartForm<f64> {
    match shape {
        Shape::Mesh { hull, scale } => PartForm::Mesh(hulls.number(model, hull, scale)),
        Shape::Plane => PartForm::Plane,
        Shape::Cylinder { radius, half_length } => PartForm::Cylinder { radius, half_length },
        Shape::Ellipsoid { radii } => PartForm::Ellipsoid { radii },
        Shape::Sphere { radius } => PartForm::Capsule { radius, half_length: 0.0 },
        Shape::Capsule { radius, half_length } => PartForm::Capsule { radius, half_length },
        Shape::Box { half_size } => PartForm::Box { half_size },
    }
}

impl PartForm<f64> {
    /// Radius of a ball around its middle that holds it (m).
    fn reach(&self, hulls: &Hulls) -> f64 {
        match *self {
            Self::Plane => f64::INFINITY,
            Self::Cylinder { radius, half_length } => radius.hypot(half_length),
            Self::Ellipsoid { radii } => radii.into_iter().fold(0.0, f64::max),
            Self::Capsule { radius, half_length } => radius + half_length,
            Self::Box { half_size } => Vector3::from(half_size).norm(),
            Self::Mesh(number) => hulls.all[number].reach(),
        }
    }

    /// Its place among the forms.
    fn rank(&self) -> usize {
        match self {
            Self::Plane => 0,
            Self::Cylinder { .. } => 1,
            Self::Ellipsoid { .. } => 2,
            Self::Capsule { .. } => 3,
            Self::Box { .. } => 4,
            Self::Mesh(_) => 5,
        }
    }
}
