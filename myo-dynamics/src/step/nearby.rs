//! Scenes of many boxes where rows are read from memory: the nearest boxes are listed, and as long as no other can have come into
//! reach, nothing else is looked at. Loops over all boxes are then as rare as a fingertip moves past its neighbours.
//!
//! After L. Verlet 1967 (doi 10.1103/PhysRev.159.98), who lists the neighbours of molecules.

use super::boxes::{Boxes, Which};
use super::contact::{ROUNDING, surface};
use crate::spatial::Vec3;
use crate::workspace::Nearby;
use myo_scalar::{Carried, Scalar, Stage, Visitor};

/// With more boxes than this the nearest are listed.
const MANY: usize = 32;
/// Farther than anything in reach (m).
const FAR: f64 = 1e3;

/// Whether these numbers list the nearest of so many boxes.
pub const fn lists<S: Scalar>(boxes: usize) -> bool {
    S::READS_ROWS && boxes > MANY
}

/// Lists the boxes that are nearest to the fingertip, and how far it may go before another is.
pub struct List<'a, S: Scalar> {
    /// All boxes.
    pub boxes: Boxes<'a, S>,
    /// Centre of the fingertip.
    pub centre: Vec3<S>,
    /// From there to where contact begins (m).
    pub reach: S,
    /// What is listed.
    pub nearby: &'a mut Nearby<S>,
}

impl<S: Scalar> Stage<S> for List<'_, S> {
    const NAME: &'static str = "list of the nearest boxes";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { boxes, centre, reach, nearby } = self;
        let mut order = Order::new(nearby.boxes.len());
        S::for_each_row(boxes.count(), &mut order, |order, row| {
            // Of the ball around a box: the least that it can be. A closer look, or passing over what changes nothing, is slower on cards.
            let (away, radius) = boxes.seen_from(centre, Which::Row(row));
            order.insert(away.dot(away).sqrt() - radius - reach, S::row_number(row));
        });
        // Where more balls are in reach than are listed, as of large boxes and small ones side by side, it takes that closer look: no more
        // boxes than are listed can be touched.
        let crowded = order.rest.le(S::lit(ROUNDING));
        S::when(crowded, &mut order, |order| S::outline(LookCloser { boxes, centre, reach, order }));
        nearby.boxes.copy_from_slice(&order.numbers);
        nearby.from = centre;
        nearby.free = (order.rest - S::lit(ROUNDING)).max(S::zero());
    }
}

/// Puts boxes in the order of their surfaces, where the balls around them do not tell which can be touched.
struct LookCloser<'a, 'b, S: Scalar> {
    boxes: Boxes<'a, S>,
    centre: Vec3<S>,
    reach: S,
    order: &'b mut Order<S>,
}

impl<S: Scalar> Stage<S> for LookCloser<'_, '_, S> {
    const NAME: &'static str = "list of the nearest surfaces";
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let Self { boxes, centre, reach, order } = self;
        *order = Order::new(order.numbers.len());
        S::for_each_row(boxes.count(), order, |order, row| {
            let which = Which::Row(row);
            let (away, _) = boxes.seen_from(centre, which);
            let (axes, half_size) = boxes.sides(which);
            order.insert(surface(axes, half_size, away).0 - reach, S::row_number(row));
        });
    }
}

/// The nearest boxes so far, nearest first.
struct Order<S> {
    distances: Vec<S>,
    numbers: Vec<S>,
    /// Least distance of all that are not among them.
    rest: S,
}

impl<S: Scalar> Order<S> {
    /// So many places, and nothing in them.
    #[inline(always)]
    fn new(count: usize) -> Self {
        let far = S::lit(FAR);
        Self { distances: vec![far; count], numbers: vec![S::zero(); count], rest: far }
    }

    /// Puts a box where it belongs; what is pushed out at the end is the rest. No place waits for the one before it, which cards
    /// are slow at.
    #[inline(always)]
    fn insert(&mut self, distance: S, number: S) {
        let Self { distances, numbers, rest } = self;
        let is_closer: Vec<S::Mask> = distances.iter().map(|&other| distance.lt(other)).collect();
        let last = distances.len() - 1;
        *rest = rest.min(S::select(is_closer[last], distances[last], distance));
        // From the end, so that what moves on is still there.
        for k in (0..=last).rev() {
            for (values, new) in [(&mut *distances, distance), (&mut *numbers, number)] {
                let here = S::select(is_closer[k], new, values[k]);
                values[k] = if k == 0 { here } else { S::select(is_closer[k - 1], values[k - 1], here) };
            }
        }
    }
}

impl<S: Scalar> Carried<S> for Order<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        visitor.numbers(self.distances.iter_mut().chain(&mut self.numbers).chain([&mut self.rest]));
    }
}

impl<S: Scalar> Carried<S> for Nearby<S> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        let Self { from, free, boxes } = self;
        visitor.numbers(boxes.iter_mut().chain([&mut from.x, &mut from.y, &mut from.z, free]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::obstacles::{Obstacles, Surface};
    use crate::workspace::Workspace;
    use crate::{CouplingMode, Plan, StaticBox};
    use myo_model::{Model, builtin};

    /// Two hundred buttons on a wall.
    fn wall() -> Vec<StaticBox> {
        let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
        let button = |k: usize| [0.4, 0.025 * (k % 20) as f64 - 0.24, 0.025 * (k / 20) as f64 - 0.4];
        (0..200).map(|k| StaticBox::new(button(k), axes, [0.01, 0.01, 0.005])).collect()
    }

    /// The same before a panel and beside bars that are much larger than they are.
    fn furnished() -> Vec<StaticBox> {
        let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
        let large = [
            ([0.42, 0.0, -0.2875], [0.15, 0.3, 0.01]),
            ([0.4, 0.0, -0.12], [0.02, 0.3, 0.01]),
            ([0.4, 0.0, -0.46], [0.02, 0.3, 0.01]),
            ([0.3, 0.0, -0.6], [0.3, 0.3, 0.01]),
        ];
        wall().into_iter().chain(large.map(|(centre, half_size)| StaticBox::new(centre, axes, half_size))).collect()
    }

    #[test]
    fn whatever_can_be_touched_is_listed_beside_boxes_of_any_size() {
        let plan = Plan::exact(&Model::new(&builtin("mobl-arms").unwrap()).unwrap(), CouplingMode::Reduced).unwrap();
        let obstacles = Obstacles::<f64>::new(&plan, &furnished(), Surface::default());
        let reach = plan.contact_spheres[0].radius + obstacles.touches[0].margin;
        let count = obstacles.most_at_once(&plan);
        let boxes = Boxes { obstacles: &obstacles, offsets: &[] };
        let mut touched = 0;
        for k in 0..2000 {
            let along = |step: f64| (f64::from(k) * step).fract();
            let centre = Vec3::new(0.38 + 0.03 * along(0.618), 0.6 * along(0.414) - 0.3, 0.5 * along(0.732) - 0.55);
            let mut nearby = Workspace::<f64>::with_contacts(&plan, count).nearby.remove(0);
            List { boxes, centre, reach, nearby: &mut nearby }.run();
            let unlisted = (0..obstacles.boxes.len()).filter(|&row| !nearby.boxes.contains(&(row as f64)));
            let distance = |row: usize| {
                let which = Which::Listed(row as f64);
                let (axes, half_size) = boxes.sides(which);
                surface::<f64>(axes, half_size, boxes.seen_from(centre, which).0).0 - reach
            };
            let nearest = unlisted.map(distance).fold(f64::INFINITY, f64::min);
            assert!(nearest >= nearby.free && nearest > 0.0, "{nearest} and {} at {centre:?}", nearby.free);
            touched += usize::from(nearby.boxes.iter().any(|&row| distance(row as usize) < 0.0));
        }
        assert!(touched > 500, "{touched}");
    }

    #[test]
    fn what_is_passed_over_is_neither_among_the_nearest_nor_the_next() {
        let plan = Plan::exact(&Model::new(&builtin("mobl-arms").unwrap()).unwrap(), CouplingMode::Reduced).unwrap();
        let obstacles = Obstacles::<f64>::new(&plan, &wall(), Surface::default());
        let reach = 0.011;
        let boxes = Boxes { obstacles: &obstacles, offsets: &[] };
        for k in 0..500 {
            // From before the wall to behind it, over its edges.
            let along = |step: f64| (f64::from(k) * step).fract();
            let centre = Vec3::new(0.3 + 0.15 * along(0.618), 0.6 * along(0.414) - 0.3, 0.5 * along(0.732) - 0.5);
            let mut nearby = Workspace::<f64>::with_contacts(&plan, 4).nearby.remove(0);
            List { boxes, centre, reach, nearby: &mut nearby }.run();

            let distance = |row: usize| {
                let [x, y, z] = obstacles.boxes[row].centre;
                let away = centre - Vec3::new(x, y, z);
                away.dot(away).sqrt() - obstacles.boxes[row].radius - reach
            };
            let mut all: Vec<(f64, f64)> = (0..200).map(|row| (distance(row), row as f64)).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let count = nearby.boxes.len();
            let nearest: Vec<f64> = all[..count].iter().map(|&(_, row)| row).collect();
            assert_eq!(nearby.boxes, nearest, "at {centre:?}");
            assert_eq!(nearby.free, (all[count].0 - ROUNDING).max(0.0), "at {centre:?}");
        }
    }
}
