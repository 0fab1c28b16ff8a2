//! Activation dynamics and force curves of MuJoCo's muscle actuator (documentation chapter "Muscles"), which follow
//! Millard et al. 2013 (doi 10.1115/1.4023390) with a rigid tendon and piecewise quadratic curves.

use crate::parameters::{CurveParameters, MuscleParameters};
use myo_scalar::{Real, Scalar};

/// Keeps quotients finite, as MuJoCo's `mjMINVAL` does.
const TINY: f64 = 1e-15;

/// A muscle ready to run: lengths and velocities of the tendon are taken as they are, the curves' units worked into the
/// coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Muscle<C> {
    /// From length, velocity and activation to force.
    pub curves: ForceCurves<C>,
    /// From excitation to activation.
    pub dynamics: ActivationDynamics<C>,
    /// Whether the activation's time constants blend; a property of the model, so a branch on it is not data-dependent.
    pub is_smooth: bool,
}

/// `[scale, offset]` of a linear function.
type Linear<T> = [T; 2];

/// Coefficients of the force curves: constants, or numbers that run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceCurves<T> {
    /// From tendon length to the distance from the optimum, in units of the distance to the inflection point on that
    /// side: above the optimum, and below it.
    above: Linear<T>,
    below: Linear<T>,
    /// From tendon velocity to the normalised velocity (1 is the greatest shortening speed).
    velocity_scale: T,
    /// From tendon velocity to units of the lengthening speed at which the force saturates.
    lengthening_scale: T,
    /// `fvmax - 1`: that speed, and how far the force rises.
    saturation: T,
    /// Half the peak isometric force (N).
    half_force: T,
    /// From tendon length to units of the width of the passive curve's quadratic part, from optimal length on.
    stretch: Linear<T>,
    /// Passive force at the end of the quadratic part (N).
    passive_half_force: T,
}

/// Coefficients of the activation dynamics: constants, or numbers that run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActivationDynamics<T> {
    tau_act: T,
    rate_deact: T,
    inverse_smooth: T,
    ctrl: [T; 2],
}

/// Scale and offset from tendon length (m) to fibre length in units of the optimal length.
fn normalisation(length_range: [f64; 2], curve: &CurveParameters) -> (f64, f64) {
    let optimal = (length_range[1] - length_range[0]) / (curve.range[1] - curve.range[0]).max(TINY);
    let scale = 1.0 / optimal.max(TINY);
    (scale, curve.range[0] - length_range[0] * scale)
}

/// Distance from the optimum to the inflection point above it, in units of the optimal length.
fn inflection(gain: &CurveParameters) -> f64 {
    (0.5 * (1.0 + gain.lmax) - 1.0).max(TINY)
}

/// Peak isometric force (N): given, or `scale / acc0`.
fn peak_force(curve: &CurveParameters, acc0: f64) -> f64 {
    curve.force.unwrap_or(curve.scale / acc0.max(TINY))
}

impl<C: Real> Muscle<C> {
    /// Works the parameters out. `acc0` (rad/s^2 per N) is the norm of the joint acceleration that one newton of this
    /// muscle causes in the reference pose; it matters only where `force` is absent.
    pub fn new(parameters: &MuscleParameters, acc0: f64) -> Self {
        Self {
            curves: ForceCurves::from_row(ForceCurves::new(parameters, acc0).row().map(C::from_f64)),
            dynamics: ActivationDynamics::from_row(ActivationDynamics::new(parameters).row().map(C::from_f64)),
            is_smooth: parameters.tau_smooth > 0.0,
        }
    }

    /// The same muscle in another precision.
    pub fn cast<D: Real>(&self) -> Muscle<D> {
        let c = |x: C| D::from_f64(x.to_f64());
        Muscle {
            curves: ForceCurves::from_row(self.curves.row().map(c)),
            dynamics: ActivationDynamics::from_row(self.dynamics.row().map(c)),
            is_smooth: self.is_smooth,
        }
    }

    /// Actuator force (N), negative when the muscle pulls; see [`ForceCurves::force`].
    #[inline(always)]
    pub fn force<S: Scalar<Const = C>>(&self, length: S, velocity: S, activation: S) -> S {
        ForceCurves::from_row(self.curves.row().map(S::splat)).force(length, velocity, activation)
    }

    /// Time derivative of the activation (1/s); see [`ActivationDynamics::rate`].
    #[inline(always)]
    pub fn activation_rate<S: Scalar<Const = C>>(&self, excitation: S, activation: S) -> S {
        ActivationDynamics::from_row(self.dynamics.row().map(S::splat)).rate(self.is_smooth, excitation, activation)
    }
}

impl ForceCurves<f64> {
    /// The greatest active force (N), at optimal length and at rest.
    pub fn peak_isometric_force(&self) -> f64 {
        2.0 * self.half_force
    }

    /// From tendon length (m) to fibre length in units of the optimal length, scale and offset; these curves are worked out from `gain`.
    pub fn fibre_length(&self, gain: &CurveParameters) -> [f64; 2] {
        let unit = inflection(gain);
        [self.above[0] * unit, self.above[1] * unit + 1.0]
    }

    fn new(parameters: &MuscleParameters, acc0: f64) -> Self {
        let (gain, bias) = (&parameters.gain, &parameters.bias);
        let (gain_scale, gain_offset) = normalisation(parameters.length_range, gain);
        let (bias_scale, bias_offset) = normalisation(parameters.length_range, bias);
        let saturation = gain.fvmax - 1.0;
        let velocity_scale = gain_scale / gain.vmax.max(TINY);
        // The distance of the normalised length from the optimum, `scale * length + offset - 1`, in some unit.
        let distance = |scale: f64, offset: f64, unit: f64| [scale / unit, (offset - 1.0) / unit];
        let above = inflection(gain);
        let below = (1.0 - 0.5 * (gain.lmin + 1.0)).max(TINY);
        Self {
            above: distance(gain_scale, gain_offset, above),
            below: distance(gain_scale, gain_offset, -below),
            velocity_scale,
            lengthening_scale: velocity_scale / saturation.max(TINY),
            saturation,
            half_force: 0.5 * peak_force(gain, acc0),
            stretch: distance(bias_scale, bias_offset, (0.5 * (1.0 + bias.lmax) - 1.0).max(TINY)),
            passive_half_force: 0.5 * bias.fpmax * peak_force(bias, acc0),
        }
    }
}

impl<T: Copy> ForceCurves<T> {
    /// Number of coefficients.
    pub const ROW: usize = 11;

    /// From tendon velocity (m/s) to the normalised velocity, of which 1 is the greatest shortening speed.
    #[inline(always)]
    pub fn velocity_scale(&self) -> T {
        self.velocity_scale
    }

    /// All coefficients in a row, for tables.
    #[inline(always)]
    pub fn row(&self) -> [T; 11] {
        let Self { above, below, stretch, .. } = self;
        [
            above[0],
            above[1],
            below[0],
            below[1],
            self.velocity_scale,
            self.lengthening_scale,
            self.saturation,
            self.half_force,
            stretch[0],
            stretch[1],
            self.passive_half_force,
        ]
    }

    /// What [`ForceCurves::row`] returned.
    #[inline(always)]
    pub fn from_row(row: [T; 11]) -> Self {
        let [a0, a1, b0, b1, velocity_scale, lengthening_scale, saturation, half_force, s0, s1, passive_half_force] =
            row;
        let (above, below, stretch) = ([a0, a1], [b0, b1], [s0, s1]);
        Self { above, below, velocity_scale, lengthening_scale, saturation, half_force, stretch, passive_half_force }
    }
}

/// A linear function at `x`.
#[inline(always)]
fn linear<S: Scalar>(f: &Linear<S>, x: S) -> S {
    x.mul_add(f[0], f[1])
}

impl<S: Scalar> ForceCurves<S> {
    /// Actuator force (N), negative when the muscle pulls: `-(activation * fl(l) * fv(v) * F + fp(l) * F)`.
    ///
    /// `length` (m) and `velocity` (m/s, positive when lengthening) are those of the whole tendon path.
    #[inline(always)]
    pub fn force(&self, length: S, velocity: S, activation: S) -> S {
        -self.gain(length, velocity).mul_add(activation, self.passive_force(length))
    }

    /// What of it (N) is active, positive when the muscle pulls.
    #[inline(always)]
    pub fn active_force(&self, length: S, velocity: S, activation: S) -> S {
        self.gain(length, velocity) * activation
    }

    /// By how much the force grows with the rate of the tendon's length (N s/m), against it: the muscle as a damper, as
    /// MuJoCo's implicit integrators have it. Never negative.
    #[inline(always)]
    pub fn damping(&self, length: S, velocity: S, activation: S) -> S {
        self.twice_force_length(length) * self.force_velocity_slope(velocity) * self.half_force * activation
    }

    /// Active force (N) of a muscle that is fully active.
    #[inline(always)]
    fn gain(&self, length: S, velocity: S) -> S {
        self.twice_force_length(length) * self.force_velocity(velocity) * self.half_force
    }

    /// Twice the active force-length curve: the curve is one at optimal length, a bump of four parabolas between `lmin`
    /// and `lmax`.
    ///
    /// With the distance t from the optimum, 1 at the inflection point and 2 at the end, it is `1 - t^2 / 2` inside and
    /// `(2 - t)^2 / 2` outside; both are `(1 - min(t, 1)^2 + clip(2 - t, 0, 1)^2) / 2`.
    #[inline(always)]
    fn twice_force_length(&self, length: S) -> S {
        let t = linear(&self.above, length).max(linear(&self.below, length));
        let (inner, outer) = (t.min(S::lit(1.0)), (S::lit(2.0) - t).clamp(0.0, 1.0));
        outer.mul_add(outer, (-inner).mul_add(inner, S::lit(1.0)))
    }

    /// Force-velocity curve: zero at the greatest shortening speed, one standing still, `fvmax` lengthening fast.
    ///
    /// Two parabolas, `(1 + v)^2` shortening and `1 + s (2 - v/s) v/s` lengthening, with s = `fvmax - 1`; each is
    /// constant where the other one bends, so that both can be added.
    #[inline(always)]
    fn force_velocity(&self, velocity: S) -> S {
        let shorten = velocity.mul_add(self.velocity_scale, S::lit(1.0)).clamp(0.0, 1.0);
        let lengthen = (velocity * self.lengthening_scale).clamp(0.0, 1.0);
        let rise = lengthen * self.saturation * (S::lit(2.0) - lengthen);
        shorten.mul_add(shorten, rise)
    }

    /// Derivative of the force-velocity curve by the rate of the tendon's length (s/m). Both parabolas begin with the same slope.
    #[inline(always)]
    fn force_velocity_slope(&self, velocity: S) -> S {
        let shorten = velocity.mul_add(self.velocity_scale, S::lit(1.0)).clamp(0.0, 1.0);
        let lengthen = (velocity * self.lengthening_scale).clamp(0.0, 1.0);
        let share = S::select(S::zero().lt(velocity), S::lit(1.0) - lengthen, shorten);
        share * (self.velocity_scale + self.velocity_scale)
    }

    /// Passive force (N): quadratic from optimal length to the inflection point, `t^2`, then its tangent `2 t - 1`.
    #[inline(always)]
    fn passive_force(&self, length: S) -> S {
        let t = linear(&self.stretch, length);
        let quadratic = t.clamp(0.0, 1.0);
        quadratic * t.mul_add(S::lit(2.0), -quadratic) * self.passive_half_force
    }
}

impl ActivationDynamics<f64> {
    fn new(parameters: &MuscleParameters) -> Self {
        Self {
            tau_act: parameters.tau_act,
            rate_deact: 1.0 / parameters.tau_deact,
            inverse_smooth: 1.0 / parameters.tau_smooth.max(TINY),
            ctrl: parameters.ctrl_range,
        }
    }
}

impl<T: Copy> ActivationDynamics<T> {
    /// Number of coefficients.
    pub const ROW: usize = 5;

    /// All coefficients in a row, for tables.
    #[inline(always)]
    pub fn row(&self) -> [T; 5] {
        [self.tau_act, self.rate_deact, self.inverse_smooth, self.ctrl[0], self.ctrl[1]]
    }

    /// What [`ActivationDynamics::row`] returned.
    #[inline(always)]
    pub fn from_row([tau_act, rate_deact, inverse_smooth, lo, hi]: [T; 5]) -> Self {
        Self { tau_act, rate_deact, inverse_smooth, ctrl: [lo, hi] }
    }
}

impl<S: Scalar> ActivationDynamics<S> {
    /// Time derivative of the activation (1/s) under an excitation:
    /// `(u - a) / tau`, with `tau_act * (0.5 + 1.5 a)` on the way up and `tau_deact / (0.5 + 1.5 a)` on the way down.
    /// The time constants blend within `tau_smooth` if the model says so; where it is zero, blending is a step and gives
    /// the same.
    #[inline(always)]
    pub fn rate(&self, is_smooth: bool, excitation: S, activation: S) -> S {
        let u = excitation.max(self.ctrl[0]).min(self.ctrl[1]).clamp(0.0, 1.0);
        let stretch = activation.clamp(0.0, 1.0).mul_add(S::lit(1.5), S::lit(0.5));
        let difference = u - activation;
        if is_smooth {
            let tau_act = stretch * self.tau_act;
            let tau_deact = (stretch * self.rate_deact).recip();
            let blend = smooth_step(difference.mul_add(self.inverse_smooth, S::lit(0.5)));
            let tau = (tau_act - tau_deact).mul_add(blend, tau_deact);
            return difference * tau.max(S::lit(TINY)).recip();
        }
        let rate_act = (stretch * self.tau_act).recip();
        let rate_deact = stretch * self.rate_deact;
        difference * S::select(S::zero().lt(difference), rate_act, rate_deact)
    }
}

/// Quintic step from 0 to 1 on [0, 1] with vanishing first and second derivatives at the ends.
#[inline(always)]
fn smooth_step<S: Scalar>(x: S) -> S {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * S::lit(3.0)).mul_add(x.mul_add(S::lit(2.0), S::lit(-5.0)), S::lit(10.0))
}
