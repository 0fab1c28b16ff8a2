//! Activation dynamics and force curves of MuJoCo's muscle actuator (documentation chapter "Muscles"), which follow
//! Millard et al. 2013 (doi 10.1115/1.4023390) with a rigid tendon and piecewise quadratic curves.

use crate::parameters::{CurveParameters, MuscleParameters};
use myo_scalar::{Real, Scalar};

/// Keeps quotients finite, as MuJoCo's `mjMINVAL` does.
const TINY: f64 = 1e-15;

/// A muscle ready to run: `length * length_scale + length_offset` is the normalised fibre length, and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscle<C> {
    active: Active<C>,
    passive: Passive<C>,
    activation: Activation<C>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Active<C> {
    length_scale: C,
    length_offset: C,
    velocity_scale: C,
    /// Reciprocal distance from optimal length to the inflection points below and above it.
    below: C,
    above: C,
    fvmax: C,
    /// `fvmax - 1`: the normalised lengthening speed at which the force saturates, and its reciprocal.
    saturation: C,
    inverse_saturation: C,
    force: C,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Passive<C> {
    length_scale: C,
    length_offset: C,
    /// Reciprocal width of the quadratic part, starting at optimal length.
    inverse_width: C,
    /// Force at the end of the quadratic part (N).
    half_force: C,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Activation<C> {
    rate_act: C,
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
        let bias_inflection = 0.5 * (1.0 + bias.lmax);
        Self {
            active: Active {
                length_scale: c(gain_scale),
                length_offset: c(gain_offset),
                velocity_scale: c(gain_scale / gain.vmax.max(TINY)),
                below: c(1.0 / (1.0 - 0.5 * (gain.lmin + 1.0)).max(TINY)),
                above: c(1.0 / (0.5 * (1.0 + gain.lmax) - 1.0).max(TINY)),
                fvmax: c(gain.fvmax),
                saturation: c(saturation),
                inverse_saturation: c(1.0 / saturation.max(TINY)),
                force: c(peak_force(gain, acc0)),
            },
            passive: Passive {
                length_scale: c(bias_scale),
                length_offset: c(bias_offset),
                inverse_width: c(1.0 / (bias_inflection - 1.0).max(TINY)),
                half_force: c(0.5 * bias.fpmax * peak_force(bias, acc0)),
            },
            activation: Activation {
                rate_act: c(1.0 / parameters.tau_act),
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
                length_scale: c(a.length_scale),
                length_offset: c(a.length_offset),
                velocity_scale: c(a.velocity_scale),
                below: c(a.below),
                above: c(a.above),
                fvmax: c(a.fvmax),
                saturation: c(a.saturation),
                inverse_saturation: c(a.inverse_saturation),
                force: c(a.force),
            },
            passive: Passive {
                length_scale: c(p.length_scale),
                length_offset: c(p.length_offset),
                inverse_width: c(p.inverse_width),
                half_force: c(p.half_force),
            },
            activation: Activation {
                rate_act: c(t.rate_act),
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
        let gain =
            self.active.force_length(length) * self.active.force_velocity(velocity) * S::splat(self.active.force);
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
            let tau_act = stretch * S::splat(t.rate_act).recip();
            let tau_deact = (stretch * S::splat(t.rate_deact)).recip();
            let blend = smooth_step(difference.mul_add(S::splat(t.inverse_smooth), S::lit(0.5)));
            let tau = (tau_act - tau_deact).mul_add(blend, tau_deact);
            return difference * tau.max(S::lit(TINY)).recip();
        }
        let rate_act = stretch.recip() * S::splat(t.rate_act);
        let rate_deact = stretch * S::splat(t.rate_deact);
        difference * S::select(S::zero().lt(difference), rate_act, rate_deact)
    }
}

impl<C: Real> Active<C> {
    /// Active force-length curve: one at optimal length, a bump of four parabolas between `lmin` and `lmax`.
    #[inline(always)]
    fn force_length<S: Scalar<Const = C>>(&self, length: S) -> S {
        let excess = length.mul_add(S::splat(self.length_scale), S::splat(self.length_offset)) - S::lit(1.0);
        // Distance from the optimum in units of the distance to the inflection point on that side: 0 to 2.
        let t = (excess * S::splat(self.above)).max(-(excess * S::splat(self.below)));
        let rest = (S::lit(2.0) - t).max(S::zero());
        let top = (t * t).mul_add(S::lit(-0.5), S::lit(1.0));
        S::select(t.lt(S::lit(1.0)), top, rest * rest * S::lit(0.5))
    }

    /// Force-velocity curve: zero at the greatest shortening speed, one standing still, `fvmax` lengthening fast.
    #[inline(always)]
    fn force_velocity<S: Scalar<Const = C>>(&self, velocity: S) -> S {
        let v = velocity * S::splat(self.velocity_scale);
        let shorten = (v + S::lit(1.0)).max(S::zero());
        let rest = (S::splat(self.saturation) - v).max(S::zero());
        let lengthen = S::splat(self.fvmax) - rest * rest * S::splat(self.inverse_saturation);
        S::select(S::zero().lt(v), lengthen, shorten * shorten)
    }
}

impl<C: Real> Passive<C> {
    /// Passive force (N): quadratic from optimal length to the inflection point, linear beyond.
    #[inline(always)]
    fn force<S: Scalar<Const = C>>(&self, length: S) -> S {
        let excess = length.mul_add(S::splat(self.length_scale), S::splat(self.length_offset)) - S::lit(1.0);
        let t = (excess * S::splat(self.inverse_width)).max(S::zero());
        // t^2 up to one, then its tangent 2 t - 1: written as one expression of the part below one.
        let quadratic = t.min(S::lit(1.0));
        let shape = quadratic.mul_add(quadratic, (t - quadratic) * S::lit(2.0));
        shape * S::splat(self.half_force)
    }
}

/// Quintic step from 0 to 1 on [0, 1] with vanishing first and second derivatives at the ends.
#[inline(always)]
fn smooth_step<S: Scalar>(x: S) -> S {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * S::lit(3.0)).mul_add(x.mul_add(S::lit(2.0), S::lit(-5.0)), S::lit(10.0))
}
