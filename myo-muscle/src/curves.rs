//! Activation dynamics and force curves of MuJoCo's muscle actuator (documentation chapter "Muscles"), which follow
//! Millard et al. 2013 (doi 10.1115/1.4023390) with a rigid tendon and piecewise quadratic curves.

use crate::parameters::{CurveParameters, MuscleParameters};
use myo_scalar::{Real, Scalar};

/// Keeps quotients finite, as MuJoCo's `mjMINVAL` does.
const TINY: f64 = 1e-15;

/// A muscle ready to run: lengths and velocities of the tendon are taken as they are, the curves' units worked into the coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscle<C> {
    active: Active<C>,
    passive: Passive<C>,
    activation: Activation<C>,
}

/// `[scale, offset]` of a linear function.
type Linear<C> = [C; 2];

#[derive(Clone, Copy, Debug, PartialEq)]
struct Active<C> {
    /// From tendon length to the distance from the optimum, in units of the distance to the inflection point on that
    /// side: above the optimum, and below it.
    above: Linear<C>,
    below: Linear<C>,
    /// From tendon velocity to the normalised velocity (1 is the greatest shortening speed).
    velocity_scale: C,
    /// From tendon velocity to units of the lengthening speed at which the force saturates.
    lengthening_scale: C,
    /// `fvmax - 1`: that speed, and how far the force rises.
    saturation: C,
    /// Half the peak isometric force (N).
    half_force: C,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Passive<C> {
    /// From tendon length to units of the quadratic part's width, from optimal length on.
    stretch: Linear<C>,
    /// Force at the end of the quadratic part (N).
    half_force: C,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Activation<C> {
    tau_act: C,
    rate_deact: C,
    inverse_smooth: C,
    /// Whether the time constants blend; a property of the model, so a branch on it is not data-dependent.
    smooth: bool,
    ctrl_lo: C,
    ctrl_hi: C,
}

/// Scale and offset from tendon length (m) to fibre length in units of the optimal length.
fn normalisation(length_range: [f64; 2], curve: &CurveParameters) -> (f64, f64) {
    let optimal = (length_range[1] - length_range[0]) / (curve.range[1] - curve.range[0]).max(TINY);
    let scale = 1.0 / optimal.max(TINY);
    (scale, curve.range[0] - length_range[0] * scale)
}

/// Peak isometric force (N): given, or `scale / acc0`.
fn peak_force(curve: &CurveParameters, acc0: f64) -> f64 {
    curve.force.unwrap_or(curve.scale / acc0.max(TINY))
}

impl<C: Real> Muscle<C> {
    /// Works the parameters out. `acc0` (rad/s^2 per N) is the norm of the joint acceleration that one newton of this
    /// muscle causes in the reference pose; it matters only where `force` is absent.
    pub fn new(parameters: &MuscleParameters, acc0: f64) -> Self {
        let c = C::from_f64;
        let (gain, bias) = (&parameters.gain, &parameters.bias);
        let (gain_scale, gain_offset) = normalisation(parameters.length_range, gain);
        let (bias_scale, bias_offset) = normalisation(parameters.length_range, bias);
        let saturation = gain.fvmax - 1.0;
        let velocity_scale = gain_scale / gain.vmax.max(TINY);
        // The distance of the normalised length from the optimum, `scale * length + offset - 1`, in some unit.
        let distance = |scale: f64, offset: f64, unit: f64| [scale / unit, (offset - 1.0) / unit].map(c);
        let above = (0.5 * (1.0 + gain.lmax) - 1.0).max(TINY);
        let below = (1.0 - 0.5 * (gain.lmin + 1.0)).max(TINY);
        let stretch = (0.5 * (1.0 + bias.lmax) - 1.0).max(TINY);
        Self {
            active: Active {
                above: distance(gain_scale, gain_offset, above),
                below: distance(gain_scale, gain_offset, -below),
                velocity_scale: c(velocity_scale),
                lengthening_scale: c(velocity_scale / saturation.max(TINY)),
                saturation: c(saturation),
                half_force: c(0.5 * peak_force(gain, acc0)),
            },
            passive: Passive {
                stretch: distance(bias_scale, bias_offset, stretch),
                half_force: c(0.5 * bias.fpmax * peak_force(bias, acc0)),
            },
            activation: Activation {
                tau_act: c(parameters.tau_act),
                rate_deact: c(1.0 / parameters.tau_deact),
                inverse_smooth: c(1.0 / parameters.tau_smooth.max(TINY)),
                smooth: parameters.tau_smooth > 0.0,
                ctrl_lo: c(parameters.ctrl_range[0]),
                ctrl_hi: c(parameters.ctrl_range[1]),
            },
        }
    }

    /// The same muscle in another precision.
    pub fn cast<D: Real>(&self) -> Muscle<D> {
        let c = |x: C| D::from_f64(x.to_f64());
        let (a, p, t) = (&self.active, &self.passive, &self.activation);
        Muscle {
            active: Active {
                above: a.above.map(c),
                below: a.below.map(c),
                velocity_scale: c(a.velocity_scale),
                lengthening_scale: c(a.lengthening_scale),
                saturation: c(a.saturation),
                half_force: c(a.half_force),
            },
            passive: Passive { stretch: p.stretch.map(c), half_force: c(p.half_force) },
            activation: Activation {
                tau_act: c(t.tau_act),
                rate_deact: c(t.rate_deact),
                inverse_smooth: c(t.inverse_smooth),
                smooth: t.smooth,
                ctrl_lo: c(t.ctrl_lo),
                ctrl_hi: c(t.ctrl_hi),
            },
        }
    }

    /// Actuator force (N), negative when the muscle pulls: `-(activation * fl(l) * fv(v) * F + fp(l) * F)`.
    ///
    /// `length` (m) and `velocity` (m/s, positive when lengthening) are those of the whole tendon path.
    #[inline(always)]
    pub fn force<S: Scalar<Const = C>>(&self, length: S, velocity: S, activation: S) -> S {
        let active = &self.active;
        let gain = active.twice_force_length(length) * active.force_velocity(velocity) * S::splat(active.half_force);
        -gain.mul_add(activation, self.passive.force(length))
    }

    /// Time derivative of the activation (1/s) under an excitation:
    /// `(u - a) / tau`, with `tau_act * (0.5 + 1.5 a)` on the way up and `tau_deact / (0.5 + 1.5 a)` on the way down.
    #[inline(always)]
    pub fn activation_rate<S: Scalar<Const = C>>(&self, excitation: S, activation: S) -> S {
        let t = &self.activation;
        let u = excitation.max(S::splat(t.ctrl_lo)).min(S::splat(t.ctrl_hi)).clamp(0.0, 1.0);
        let stretch = activation.clamp(0.0, 1.0).mul_add(S::lit(1.5), S::lit(0.5));
        let difference = u - activation;
        if t.smooth {
            let tau_act = stretch * S::splat(t.tau_act);
            let tau_deact = (stretch * S::splat(t.rate_deact)).recip();
            let blend = smooth_step(difference.mul_add(S::splat(t.inverse_smooth), S::lit(0.5)));
            let tau = (tau_act - tau_deact).mul_add(blend, tau_deact);
            return difference * tau.max(S::lit(TINY)).recip();
        }
        let rate_act = (stretch * S::splat(t.tau_act)).recip();
        let rate_deact = stretch * S::splat(t.rate_deact);
        difference * S::select(S::zero().lt(difference), rate_act, rate_deact)
    }
}

/// A linear function at `x`.
#[inline(always)]
fn linear<S: Scalar>(f: &Linear<S::Const>, x: S) -> S {
    x.mul_add(S::splat(f[0]), S::splat(f[1]))
}

impl<C: Real> Active<C> {
    /// Twice the active force-length curve: the curve is one at optimal length, a bump of four parabolas between `lmin`
    /// and `lmax`.
    ///
    /// With the distance t from the optimum, 1 at the inflection point and 2 at the end, it is `1 - t^2 / 2` inside and
    /// `(2 - t)^2 / 2` outside; both are `(1 - min(t, 1)^2 + clip(2 - t, 0, 1)^2) / 2`.
    #[inline(always)]
    fn twice_force_length<S: Scalar<Const = C>>(&self, length: S) -> S {
        let t = linear(&self.above, length).max(linear(&self.below, length));
        let (inner, outer) = (t.min(S::lit(1.0)), (S::lit(2.0) - t).clamp(0.0, 1.0));
        outer.mul_add(outer, (-inner).mul_add(inner, S::lit(1.0)))
    }

    /// Force-velocity curve: zero at the greatest shortening speed, one standing still, `fvmax` lengthening fast.
    ///
    /// Two parabolas, `(1 + v)^2` shortening and `1 + s (2 - v/s) v/s` lengthening, with s = `fvmax - 1`; each is
    /// constant where the other one bends, so that both can be added.
    #[inline(always)]
    fn force_velocity<S: Scalar<Const = C>>(&self, velocity: S) -> S {
        let shorten = velocity.mul_add(S::splat(self.velocity_scale), S::lit(1.0)).clamp(0.0, 1.0);
        let lengthen = (velocity * S::splat(self.lengthening_scale)).clamp(0.0, 1.0);
        let rise = lengthen * S::splat(self.saturation) * (S::lit(2.0) - lengthen);
        shorten.mul_add(shorten, rise)
    }
}

impl<C: Real> Passive<C> {
    /// Passive force (N): quadratic from optimal length to the inflection point, `t^2`, then its tangent `2 t - 1`.
    #[inline(always)]
    fn force<S: Scalar<Const = C>>(&self, length: S) -> S {
        let t = linear(&self.stretch, length);
        let quadratic = t.clamp(0.0, 1.0);
        quadratic * t.mul_add(S::lit(2.0), -quadratic) * S::splat(self.half_force)
    }
}

/// Quintic step from 0 to 1 on [0, 1] with vanishing first and second derivatives at the ends.
#[inline(always)]
fn smooth_step<S: Scalar>(x: S) -> S {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * S::lit(3.0)).mul_add(x.mul_add(S::lit(2.0), S::lit(-5.0)), S::lit(10.0))
}
