//! Boxes fixed to the world that the fingertip can press.

use crate::impedance::Impedance;
use crate::plan::Plan;
use myo_model::description::Softness;
use myo_scalar::Real;

/// A box for the fingertip to press, as a task describes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StaticBox {
    /// Centre (m, from the shoulder centre in world axes).
    pub centre: [f64; 3],
    /// Axes as columns.
    pub axes: [[f64; 3]; 3],
    /// Half sizes along the axes (m).
    pub half_size: [f64; 3],
}

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

/// Boxes, and the contact parameters that they share, compiled for one plan.
#[derive(Clone, Debug)]
pub struct Obstacles<C> {
    /// The boxes.
    pub boxes: Vec<CompiledBox<C>>,
    /// Sum of the margins (m).
    pub margin: C,
    /// Sliding friction.
    pub friction: C,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse inertia of every pyramid row.
    pub diagonal: C,
}

/// [`StaticBox`] in precision `C`.
#[derive(Clone, Copy, Debug)]
pub struct CompiledBox<C> {
    /// Centre (m, from O).
    pub centre: [C; 3],
    /// Axes as columns.
    pub axes: [[C; 3]; 3],
    /// Half sizes (m).
    pub half_size: [C; 3],
}

impl<C: Real> Obstacles<C> {
    /// Nothing to touch.
    pub fn none(plan: &Plan<C>) -> Self {
        Self::new(plan, &[], Surface::default())
    }

    /// Boxes for the fingertip of a plan. A plan without a contact sphere touches none of them.
    pub fn new(plan: &Plan<C>, boxes: &[StaticBox], surface: Surface) -> Self {
        let c = C::from_f64;
        let sphere = plan.contact_sphere.as_ref();
        let friction = sphere.map_or(0.0, |s| s.friction).max(surface.friction);
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let softness = sphere.map_or(surface.softness, |s| {
            let mut mixed = surface.softness;
            mixed.solref.iter_mut().zip(s.softness.solref).for_each(|(a, b)| *a = mean(*a, b));
            mixed.solimp.iter_mut().zip(s.softness.solimp).for_each(|(a, b)| *a = mean(*a, b));
            mixed
        });
        // MuJoCo scales the regularisation of a pyramid so that its stiffness does not depend on the friction.
        let inverse_mass = sphere.map_or(1.0, |s| s.diagonal);
        let diagonal = 2.0 * friction * friction * (1.0 + friction * friction) * inverse_mass;
        let columns = |m: [[f64; 3]; 3]| m.map(|v| v.map(c));
        Self {
            boxes: boxes
                .iter()
                .filter(|_| sphere.is_some())
                .map(|b| CompiledBox { centre: b.centre.map(c), axes: columns(b.axes), half_size: b.half_size.map(c) })
                .collect(),
            margin: c(sphere.map_or(0.0, |s| s.margin) + surface.margin),
            friction: c(friction),
            impedance: Impedance::new(&softness, plan.timestep.to_f64()),
            diagonal: c(diagonal),
        }
    }
}
