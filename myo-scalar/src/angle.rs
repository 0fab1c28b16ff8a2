//! The angle of a direction in the plane, from the operations that every kind of number has.

use crate::scalar::Scalar;

/// `atan(t) / t` in `t^2`, for t in [0, 1], highest power first: minimax in the relative error (1.6e-8), by Remez' algorithm.
const ATAN: [f64; 9] = [
    0.002_849_889_770_457_7,
    -0.016_068_629_563_852,
    0.042_691_520_260_515,
    -0.075_042_946_233_338,
    0.106_409_340_651_72,
    -0.142_036_444_767_17,
    0.199_926_193_929_4,
    -0.333_330_733_451_13,
    0.999_999_984_765_78,
];

/// Precision (see [`Scalar::EPSILON`]) from which on the error of [`ATAN`] shows.
const FINE: f64 = 1e-10;

/// Keeps reciprocals finite where both coordinates are zero.
const TINY: f64 = 1e-30;

/// Angle (rad, in [-pi, pi]) of the direction (`x`, `y`), whose length may be anything from 1e-15 to 1e15; zero for none.
///
/// Good to 3e-7 rad in single precision and to 4e-16 rad in double precision.
#[inline(always)]
pub fn atan2<S: Scalar>(y: S, x: S) -> S {
    let (width, height) = (x.abs(), y.abs());
    let ratio = width.min(height) * width.max(height).max(S::lit(TINY)).recip();
    let square = ratio * ratio;
    let mut series = S::lit(ATAN[0]);
    for &c in &ATAN[1..] {
        series = series.mul_add(square, S::lit(c));
    }
    let octant = series * ratio;
    let is_steep = width.lt(height);
    let quadrant = S::select(is_steep, S::lit(std::f64::consts::FRAC_PI_2) - octant, octant);
    let half = S::select(x.lt(S::zero()), S::lit(std::f64::consts::PI) - quadrant, quadrant);
    let angle = S::select(y.lt(S::zero()), -half, half);
    if S::EPSILON < FINE { refined(angle, y, x) } else { angle }
}

/// What the angle misses is the angle between its direction and the one asked for, which is next to nothing: its sine.
#[inline(always)]
fn refined<S: Scalar>(angle: S, y: S, x: S) -> S {
    let (sin, cos) = angle.sin_cos();
    let length = (x * x + y * y).max(S::lit(TINY)).sqrt();
    angle + (y * cos - x * sin) * length.recip()
}
