//! Boxes fixed to the world that fingers can press.

use crate::crowd::{MovedBox, most_at_once};
use crate::impedance::{Impedance, pyramid_diagonal};
use crate::plan::{ContactSphere, Plan};
use myo_model::StaticBox;
use myo_model::description::Softness;
use myo_scalar::{Real, Scalar};
use nalgebra::Vector3;

/// How surfaces behave in contact; the same for all boxes of a task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Distance at which contact forces begin (m); it adds to the fingertip's.
    pub margin: f64,
    /// Sliding friction; the greater of box and fingertip holds.
    pub friction: f64,
    /// Softness; the mean of box and fingertip holds.
    pub softness: Softness,
}

impl Default for Surface {
    /// A button of the published systems.
    fn default() -> Self {
        Self { margin: 0.001, friction: 1.0, softness: Softness::default() }
    }
}

/// Boxes, and the contact parameters that they share, compiled for one plan. Where the boxes are may differ from lane to lane.
#[derive(Clone, Debug)]
pub struct Obstacles<C, T = C> {
    /// The boxes.
    pub boxes: Vec<StaticBox<T>>,
    /// Per box, which of the [offsets](crate::Workspace::offsets) moves it; where none does, a number that there is not. Empty where
    /// all stand still.
    pub moved_by: Vec<T>,
    /// Per box, which of them is added to half its sizes, along its own axes; the ball around it holds it however large. Empty where all
    /// sizes are fixed.
    pub grown_by: Vec<T>,
    /// How they and each sphere that presses touch.
    pub touches: Vec<Touch<C>>,
}

/// How a sphere and boxes of a surface touch.
#[derive(Clone, Copy, Debug)]
pub struct Touch<C> {
    /// Sum of the margins (m).
    pub margin: C,
    /// Sliding friction.
    pub friction: C,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia of every pyramid row.
    pub diagonal: C,
    /// What the share of it in the regularisation is not below.
    pub least: C,
}

impl<C: Real> Touch<C> {
    fn new(sphere: &ContactSphere<C>, surface: &Surface, timestep: f64, impratio: f64) -> Self {
        let c = C::from_f64;
        let friction = sphere.friction.max(surface.friction);
        let scaled = pyramid_diagonal(friction, impratio, sphere.diagonal);
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let mut softness = surface.softness;
        softness.solref.iter_mut().zip(sphere.softness.solref).for_each(|(a, b)| *a = mean(*a, b));
        softness.solimp.iter_mut().zip(sphere.softness.solimp).for_each(|(a, b)| *a = mean(*a, b));
        Self {
            margin: c(sphere.margin + surface.margin),
            friction: c(friction),
            impedance: Impedance::new(&softness, timestep),
            diagonal: c(scaled.diagonal),
            least: c(scaled.least),
        }
    }
}

impl<C: Real> Obstacles<C> {
    /// Boxes for the fingers of a plan. A plan without spheres that press touches none of them.
    pub fn new(plan: &Plan<C>, boxes: &[StaticBox], surface: Surface) -> Self {
        let boxes = boxes.iter().map(|each| each.map(&mut |&x| C::from_f64(x))).collect();
        Self::with_boxes(plan, boxes, surface)
    }

    /// How many of the boxes one finger of a plan can touch at once, at most, where they stand.
    pub fn most_at_once(&self, plan: &Plan<C>) -> usize {
        self.most_at_once_moved(plan, &[])
    }

    /// How many of the boxes one finger of a plan can touch at once, at most, where offset `k` is up to one half, either way, of each
    /// of the ways (m) of number `k`, and boxes are as large as they may become.
    pub fn most_at_once_moved(&self, plan: &Plan<C>, ways: &[[[f64; 3]; 3]]) -> usize {
        let ways: Vec<[Vector3<f64>; 3]> = ways.iter().map(|ways| ways.map(Vector3::from)).collect();
        let number = |of: &[C], k: usize| of.get(k).map_or(ways.len(), |number| number.to_f64() as usize);
        let boxes: Vec<MovedBox> = (0..self.boxes.len())
            .map(|k| {
                let mut place = self.boxes[k].map(&mut |&x: &C| x.to_f64()).oriented();
                for way in ways.get(number(&self.grown_by, k)).into_iter().flatten() {
                    place.half_size += 0.5 * way.abs();
                }
                MovedBox { place, moved_by: number(&self.moved_by, k) }
            })
            .collect();
        let reach = |(sphere, touch): (&ContactSphere<C>, &Touch<C>)| sphere.radius.to_f64() + touch.margin.to_f64();
        let farthest = plan.contact_spheres.iter().zip(&self.touches).map(reach).reduce(f64::max);
        farthest.map_or(1, |reach| most_at_once(&boxes, &ways, reach))
    }

    /// The same in every lane.
    pub fn splat<S: Scalar<Const = C>>(&self) -> Obstacles<C, S> {
        let boxes = self.boxes.iter().map(|each| each.map(&mut |&x| S::splat(x))).collect();
        let splat = |numbers: &[C]| numbers.iter().map(|&number| S::splat(number)).collect();
        self.with(boxes, splat(&self.moved_by), splat(&self.grown_by))
    }
}

impl<C: Real, T> Obstacles<C, T> {
    /// Nothing to touch.
    pub fn none(plan: &Plan<C>) -> Self {
        Self::with_boxes(plan, vec![], Surface::default())
    }

    /// Other boxes of the same surface.
    pub fn with<U>(&self, boxes: Vec<StaticBox<U>>, moved_by: Vec<U>, grown_by: Vec<U>) -> Obstacles<C, U> {
        Obstacles { boxes, moved_by, grown_by, touches: self.touches.clone() }
    }

    /// Boxes for the fingers of a plan. A plan without spheres that press touches none of them.
    pub fn with_boxes(plan: &Plan<C>, boxes: Vec<StaticBox<T>>, surface: Surface) -> Self {
        let (timestep, impratio) = (plan.timestep.to_f64(), plan.impratio.to_f64());
        let touch = |sphere: &ContactSphere<C>| Touch::new(sphere, &surface, timestep, impratio);
        Self { boxes, moved_by: vec![], grown_by: vec![], touches: plan.contact_spheres.iter().map(touch).collect() }
    }
}
