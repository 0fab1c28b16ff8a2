//! Stretches of muscle paths that may bend round something.

use super::{FixedFrame, Point, RoundShape, RoundThing, Side, Stretch, Tendons};
use crate::spatial::{Frame, Rotation, Vec3};
use crate::step::wrap::{OnSide, Round, course};
use myo_model::description::WrapShape;
use myo_model::model::Wrap;
use nalgebra::{Matrix3, Vector3};

impl From<&WrapShape> for RoundShape {
    fn from(shape: &WrapShape) -> Self {
        match shape {
            WrapShape::Sphere { .. } => Self::Sphere,
            WrapShape::Cylinder { .. } => Self::Cylinder,
        }
    }
}

impl RoundThing<f64> {
    /// A wrap of a model, with nothing that runs over it yet.
    pub(super) fn new(wrap: &Wrap, frame: FixedFrame<f64>) -> Self {
        let shape = RoundShape::from(&wrap.shape);
        Self { frame, shape, radius: wrap.shape.radius(), stretches: vec![] }
    }

    /// Links that feel forces.
    pub(super) fn pulled_links(&self) -> impl Iterator<Item = usize> {
        let ends = self.stretches.iter().flat_map(|stretch| &stretch.ends);
        ends.map(|end| end.link).chain([self.frame.origin.link])
    }

    /// Every point whose place is asked for.
    pub(super) fn points_mut(&mut self) -> impl Iterator<Item = &mut Point<f64>> {
        let stretches = self.stretches.iter_mut().flat_map(|stretch| {
            let side = match &mut stretch.side {
                Side::Moving(point) => Some(point),
                Side::Any | Side::Fixed(_) | Side::Inside => None,
            };
            stretch.ends.iter_mut().chain(side)
        });
        stretches.chain([&mut self.frame.origin])
    }

    /// The link of every such point.
    pub(super) fn links(&self) -> impl Iterator<Item = usize> {
        let side = |stretch: &Stretch<f64>| match &stretch.side {
            Side::Moving(point) => Some(point.link),
            Side::Any | Side::Fixed(_) | Side::Inside => None,
        };
        self.pulled_links().chain(self.stretches.iter().filter_map(side))
    }

    /// A point of the same link, from the centre and in the own axes (m).
    fn local(&self, point: &Point<f64>) -> Option<[f64; 3]> {
        let turn = Matrix3::from_columns(&self.frame.axes.map(Vector3::from)).transpose();
        let FixedFrame { origin, .. } = &self.frame;
        (point.link == origin.link)
            .then(|| (turn * (Vector3::from(point.position) - Vector3::from(origin.position))).into())
    }

    fn side(&self, point: Option<Point<f64>>) -> Side<f64> {
        let Some(point) = point else { return Side::Any };
        let Some(local) = self.local(&point) else { return Side::Moving(point) };
        match OnSide::told_by(Vec3::splat(local), self.shape, self.radius) {
            OnSide::Inside => Side::Inside,
            OnSide::Of(local) => Side::Fixed(local.array()),
            OnSide::Any | OnSide::Either(..) => Side::Any,
        }
    }

    /// Length (m) of a stretch that is fixed to the link of the round thing with all that tells its way.
    fn constant_length(&self, stretch: &Stretch<f64>) -> Option<f64> {
        let side = match stretch.side {
            Side::Any => OnSide::Any,
            Side::Inside => OnSide::Inside,
            Side::Fixed(local) => OnSide::Of(Vec3::splat(local)),
            Side::Moving(_) => return None,
        };
        let [a, b] = [Vec3::splat(stretch.local[0]?), Vec3::splat(stretch.local[1]?)];
        let frame = Frame { rotation: Rotation::identity(), position: Vec3::zero() };
        let round = Round { shape: self.shape, radius: self.radius, frame };
        Some(course(&round, side, [a, b], [a, b]).length)
    }
}

impl Tendons<f64> {
    /// Adds a stretch over `thing`, which has none itself, to those over the same one.
    pub(super) fn add_stretch(
        &mut self,
        muscle: usize,
        ends: [Point<f64>; 2],
        thing: &RoundThing<f64>,
        side: Option<Point<f64>>,
    ) {
        let local = ends.each_ref().map(|end| thing.local(end));
        let stretch = Stretch { muscle, ends, local, side: thing.side(side) };
        if let Some(length) = thing.constant_length(&stretch) {
            self.constant[muscle] += length;
            return;
        }
        let is_same = |other: &RoundThing<f64>| {
            (other.frame, other.shape, other.radius) == (thing.frame, thing.shape, thing.radius)
        };
        match self.wraps.iter_mut().find(|other| is_same(other)) {
            Some(other) => other.stretches.push(stretch),
            None => self.wraps.push(RoundThing { stretches: vec![stretch], ..thing.clone() }),
        }
    }
}
