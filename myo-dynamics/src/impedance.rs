//! MuJoCo's soft constraints: impedance, regularisation and reference acceleration
//! (documentation chapter "Computation", sections "Constraint model" and "Parameters").

use crate::cast::{Cast, cast};
use myo_model::description::Softness;
use myo_scalar::{Real, Scalar};

/// Bounds that MuJoCo clips impedances to.
const IMPEDANCE_RANGE: (f64, f64) = (1e-4, 0.9999);
/// MuJoCo's smallest divisor.
pub(crate) const TINY: f64 = 1e-15;

/// A constraint's softness, worked out for one time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impedance<C> {
    at_zero: C,
    rise: C,
    inverse_width: C,
    midpoint: C,
    power: C,
    /// `1 / midpoint^(power - 1)` and `1 / (1 - midpoint)^(power - 1)`.
    below: C,
    above: C,
    /// The power is two; a property of the model.
    quadratic: bool,
    stiffness: C,
    damping: C,
}

cast!(Impedance {
    at_zero, rise, inverse_width, midpoint, power, below, above, stiffness, damping;
    quadratic
});

impl<C: Real> Impedance<C> {
    /// Works a softness out; times shorter than two time steps are lengthened to them, as MuJoCo's `refsafe` does.
    pub fn new(softness: &Softness, timestep: f64) -> Self {
        let c = C::from_f64;
        let [at_zero, at_width, width, midpoint, power] = softness.solimp;
        let clip = |x: f64| x.clamp(IMPEDANCE_RANGE.0, IMPEDANCE_RANGE.1);
        let (at_zero, at_width, midpoint, power) = (clip(at_zero), clip(at_width), clip(midpoint), power.max(1.0));
        let flat = at_zero == at_width || width <= TINY;
        let base = if flat { 0.5 * (at_zero + at_width) } else { at_zero };
        let (stiffness, damping) = reference(softness.solref, at_width, timestep);
        Self {
            at_zero: c(base),
            rise: c(if flat { 0.0 } else { at_width - at_zero }),
            inverse_width: c(1.0 / width.max(TINY)),
            midpoint: c(midpoint),
            power: c(power),
            below: c(midpoint.powf(1.0 - power)),
            above: c((1.0 - midpoint).powf(1.0 - power)),
            quadratic: power == 2.0,
            stiffness: c(stiffness),
            damping: c(damping),
        }
    }

    /// Impedance at a violation (distance past the margin, either sign).
    #[inline(always)]
    fn at<S: Scalar<Const = C>>(&self, violation: S) -> S {
        let x = (violation.abs() * S::splat(self.inverse_width)).min(S::lit(1.0));
        let (below, above) = (S::splat(self.below), S::splat(self.above));
        let rest = S::lit(1.0) - x;
        let rising = below * self.raise(x);
        let settling = S::lit(1.0) - above * self.raise(rest);
        let y = S::select(S::splat(self.midpoint).lt(x), settling, rising);
        y.mul_add(S::splat(self.rise), S::splat(self.at_zero))
    }

    /// `x^power` for x in [0, 1].
    #[inline(always)]
    fn raise<S: Scalar<Const = C>>(&self, x: S) -> S {
        if self.quadratic {
            return x * x;
        }
        // The floor keeps the logarithm finite; its power is zero to any precision.
        (x.max(S::lit(1e-12)).ln() * S::splat(self.power)).exp()
    }

    /// Weight `D = imp / ((1 - imp) * diagonal)` and reference acceleration `-b * velocity - k * imp * violation` of a row
    /// whose unconstrained inverse inertia is `diagonal`.
    #[inline(always)]
    pub fn row<S: Scalar<Const = C>>(&self, violation: S, velocity: S, diagonal: S) -> (S, S) {
        self.row_of(violation, violation, velocity, diagonal, S::lit(TINY))
    }

    /// The same of one of several rows that are one violation together: `norm` of all is what impedance goes with, and `least` what the share of
    /// the inverse inertia in the regularisation is not below.
    #[inline(always)]
    pub fn row_of<S: Scalar<Const = C>>(&self, norm: S, violation: S, velocity: S, diagonal: S, least: S) -> (S, S) {
        let imp = self.at(norm);
        let weight = imp * ((S::lit(1.0) - imp) * diagonal).max(least).recip();
        let elastic = S::splat(self.stiffness) * imp * violation;
        (weight, -(S::splat(self.damping).mul_add(velocity, elastic)))
    }
}

/// Stiffness and damping of the reference acceleration.
fn reference(solref: [f64; 2], at_width: f64, timestep: f64) -> (f64, f64) {
    let [first, second] = solref;
    if first > 0.0 {
        let time = first.max(2.0 * timestep);
        let stiffness = 1.0 / (at_width * at_width * time * time * second * second).max(TINY);
        (stiffness, 2.0 / (at_width * time).max(TINY))
    } else {
        // Negative numbers give stiffness and damping directly.
        (-first / (at_width * at_width), -second / at_width)
    }
}

/// Inverse inertia of every row of a friction pyramid, from its first sliding friction, how many times as hard friction is as the normal force, and the
/// inverse mass (1/kg) that its two surfaces have together: MuJoCo scales the regularisation of a pyramid so that its stiffness does not depend on
/// the friction.
pub(crate) fn pyramid_diagonal(friction: f64, impratio: f64, inverse_mass: f64) -> Scaled {
    Scaled::new((1.0 + friction * friction) * inverse_mass, 2.0 * friction * friction / impratio)
}

/// An inverse inertia that rows have in other units than the contact has: what MuJoCo keeps from vanishing is the contact's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scaled {
    /// Inverse inertia of every row.
    pub diagonal: f64,
    /// What the share of it in the regularisation is not below.
    pub least: f64,
}

impl Scaled {
    /// So much, in units of which one is `scale` of the contact's.
    pub(crate) fn new(own: f64, scale: f64) -> Self {
        Self { diagonal: own * scale, least: TINY * scale }
    }
}
