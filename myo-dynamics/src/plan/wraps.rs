//! Stretches of muscle paths that may bend round something.

use super::{Bundle, FixedFrame, Point, RoundShape, RoundThing, Side, Stretch, Tendons, Way};
use crate::spatial::Vec3;
use crate::step::wrap::{OnSide, course};
use myo_model::description::{SideRule, WrapShape};
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
    /// A wrap of a model.
    pub(super) fn new(wrap: &Wrap, rule: SideRule, frame: FixedFrame<f64>) -> Self {
        let shape = RoundShape::from(&wrap.shape);
        let axes = match shape {
            RoundShape::Sphere => Matrix3::identity().into(),
            RoundShape::Cylinder => frame.axes,
        };
        Self { frame: FixedFrame { axes, ..frame }, shape, rule, radius: wrap.shape.radius() }
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
}

impl<C> Side<C> {
    fn way(&self) -> Way {
        match self {
            Self::Any | Self::Fixed(_) => Way::Around,
            Self::Inside => Way::Through,
            Self::Moving(_) => Way::Either,
        }
    }
}

impl Stretch<f64> {
    /// Links that feel forces.
    pub(super) fn pulled_links(&self) -> impl Iterator<Item = usize> {
        self.ends.iter().map(|end| end.link).chain([self.round.frame.origin.link])
    }

    /// Every point whose place is asked for.
    pub(super) fn points_mut(&mut self) -> impl Iterator<Item = &mut Point<f64>> {
        let side = match &mut self.side {
            Side::Moving(point) => Some(point),
            Side::Any | Side::Fixed(_) | Side::Inside => None,
        };
        self.ends.iter_mut().chain(side).chain([&mut self.round.frame.origin])
    }

    /// The link of every such point.
    pub(super) fn links(&self) -> impl Iterator<Item = usize> {
        let side = match &self.side {
            Side::Moving(point) => Some(point.link),
            Side::Any | Side::Fixed(_) | Side::Inside => None,
        };
        self.pulled_links().chain(side)
    }

    /// Its length (m) where its last end is fixed to the link of the round thing, too, `local` from its centre, and with all that
    /// tells its way.
    fn constant_length(&self, local: [f64; 3]) -> Option<f64> {
        let side = match self.side {
            Side::Any => OnSide::Any,
            Side::Inside => OnSide::Inside,
            Side::Fixed(local) => OnSide::Of(Vec3::splat(local)),
            Side::Moving(_) => return None,
        };
        let ends = [Vec3::splat(self.local?), Vec3::splat(local)];
        let RoundThing { shape, rule, radius, .. } = self.round;
        Some(course(shape, rule, radius, side, ends).length)
    }
}

impl<C> Bundle<C> {
    /// How many of its stretches may lead through something round: all, or none.
    #[inline(always)]
    pub(crate) fn ngap(&self) -> usize {
        match self.way {
            Way::Around => 0,
            Way::Through | Way::Either => self.stretches.len(),
        }
    }
}

impl Tendons<f64> {
    /// All stretches that may bend.
    pub(super) fn stretches(&self) -> impl Iterator<Item = &Stretch<f64>> {
        self.wraps.iter().flat_map(|bundle| &bundle.stretches)
    }

    /// Adds a stretch to those of its kind.
    pub(super) fn add_stretch(
        &mut self,
        muscle: usize,
        [a, b]: [Point<f64>; 2],
        round: RoundThing<f64>,
        side: Option<Point<f64>>,
    ) {
        // A way is the same there and back.
        let (ends, [local, last]) = match [round.local(&a), round.local(&b)] {
            [None, Some(local)] => ([b, a], [Some(local), None]),
            both => ([a, b], both),
        };
        let stretch = Stretch { muscle, round, ends, local, side: round.side(side) };
        if let Some(length) = last.and_then(|last| stretch.constant_length(last)) {
            self.constant[muscle] += length;
            return;
        }
        match self.wraps.iter_mut().find(|bundle| bundle.takes(&stretch)) {
            Some(bundle) => bundle.stretches.push(stretch),
            None => self.wraps.push(Bundle {
                shape: round.shape,
                rule: round.rule,
                way: stretch.side.way(),
                is_moored: local.is_some(),
                stretches: vec![stretch],
            }),
        }
    }
}

impl Bundle<f64> {
    /// Whether a stretch belongs to it. One link for all saves a loop over them the frames of each; that through things has a
    /// loop inside, too long to be there once more.
    fn takes(&self, other: &Stretch<f64>) -> bool {
        let link = |stretch: &Stretch<f64>| stretch.round.frame.origin.link;
        let is_near = self.way != Way::Around || self.stretches.iter().all(|stretch| link(stretch) == link(other));
        let kind = (other.round.shape, other.side.way(), other.local.is_some());
        is_near && (self.shape, self.way, self.is_moored) == kind
    }
}
