//! Checks of numbers.

use crate::description::{Softness, TendonLimit};
use crate::error::{Element, ElementKind, ModelError};
use myo_muscle::{CurveParameters, MuscleParameters};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Length below which a direction or a quaternion has none.
const SHORTEST: f64 = 1e-15;

/// Greatest values of either sign that a body may have: far more than any has, and little enough for single precision.
/// What is beyond is a slip, most often of the unit.
pub(crate) struct Bound {
    most: f64,
    unit: &'static str,
    expected: &'static str,
}

impl Bound {
    const fn new(most: f64, unit: &'static str, expected: &'static str) -> Self {
        Self { most, unit, expected }
    }
    pub(crate) const LENGTH: Self = Self::new(10.0, " m", "within 10 m; is it in millimetres?");
    pub(crate) const ACCELERATION: Self = Self::new(1e3, " m/s^2", "within 1000 m/s^2");
    pub(crate) const MASS: Self = Self::new(1e4, " kg", "within 10000 kg; is it in grams?");
    pub(crate) const INERTIA: Self = Self::new(1e4, " kg m^2", "within 10000 kg m^2; is it in other units?");
    pub(crate) const JOINT_POSITION: Self = Self::new(100.0, "", "within 100 rad (or m); is it in degrees?");
    pub(crate) const STIFFNESS: Self = Self::new(1e7, "", "within 10000000 N m/rad (or N/m)");
    pub(crate) const DAMPING: Self = Self::new(1e6, "", "within 1000000 N m s/rad (or N s/m)");
    pub(crate) const ARMATURE: Self = Self::new(1e4, "", "within 10000 kg m^2 (or kg)");
    pub(crate) const COEFFICIENT: Self = Self::new(1e3, "", "within 1000");
    pub(crate) const DIRECTION: Self = Self::new(1e6, "", "within 1000000; it is scaled to length one");
    pub(crate) const FORCE: Self = Self::new(1e6, " N", "within 1000000 N");
    pub(crate) const TIME: Self = Self::new(100.0, " s", "within 100 s; is it in milliseconds?");
    pub(crate) const NORMALISED: Self = Self::new(100.0, "", "within 100 optimal lengths");
    pub(crate) const RATIO: Self = Self::new(1e3, "", "within 1000");
}

/// Greatest power of an impedance: with a midpoint at its bound of 1e-4, single precision holds no more.
const MOST_POWER: f64 = 8.0;

/// Checks of numbers that belong to one element.
pub(crate) struct Check {
    pub(crate) element: Element,
}

impl Check {
    pub(crate) fn new(kind: ElementKind, name: &str) -> Self {
        Self { element: Element::new(kind, name) }
    }

    pub(crate) fn finite(&self, field: &'static str, values: &[f64]) -> Result<(), ModelError> {
        match values.iter().find(|value| !value.is_finite()) {
            Some(&value) => Err(ModelError::NotFinite { element: self.element.clone(), field, value }),
            None => Ok(()),
        }
    }

    pub(crate) fn require(
        &self,
        holds: bool,
        field: &'static str,
        value: f64,
        unit: &'static str,
        expected: &'static str,
    ) -> Result<(), ModelError> {
        self.finite(field, &[value])?;
        if holds {
            Ok(())
        } else {
            Err(ModelError::OutOfRange { element: self.element.clone(), field, value, unit, expected })
        }
    }

    /// Every value is finite and within a bound, either sign.
    pub(crate) fn within(&self, field: &'static str, values: &[f64], bound: &Bound) -> Result<(), ModelError> {
        values
            .iter()
            .try_for_each(|&value| self.require(value.abs() <= bound.most, field, value, bound.unit, bound.expected))
    }

    pub(crate) fn at_least(
        &self,
        field: &'static str,
        value: f64,
        bound: f64,
        unit: &'static str,
        expected: &'static str,
    ) -> Result<(), ModelError> {
        self.require(value >= bound, field, value, unit, expected)
    }

    pub(crate) fn above(
        &self,
        field: &'static str,
        value: f64,
        bound: f64,
        unit: &'static str,
        expected: &'static str,
    ) -> Result<(), ModelError> {
        self.require(value > bound, field, value, unit, expected)
    }

    pub(crate) fn not_negative(&self, field: &'static str, value: f64, unit: &'static str) -> Result<(), ModelError> {
        self.at_least(field, value, 0.0, unit, "0 or more")
    }

    pub(crate) fn ascending(
        &self,
        field: &'static str,
        [lower, upper]: [f64; 2],
        unit: &'static str,
    ) -> Result<(), ModelError> {
        self.finite(field, &[lower, upper])?;
        if lower < upper {
            Ok(())
        } else {
            Err(ModelError::InvertedRange { element: self.element.clone(), field, lower, upper, unit })
        }
    }

    pub(crate) fn direction(&self, field: &'static str, value: [f64; 3]) -> Result<Vector3<f64>, ModelError> {
        self.within(field, &value, &Bound::DIRECTION)?;
        let zero = || ModelError::ZeroLength { element: self.element.clone(), field };
        Vector3::from(value).try_normalize(SHORTEST).ok_or_else(zero)
    }

    pub(crate) fn rotation(&self, field: &'static str, wxyz: [f64; 4]) -> Result<UnitQuaternion<f64>, ModelError> {
        self.within(field, &wxyz, &Bound::DIRECTION)?;
        let [w, x, y, z] = wxyz;
        let zero = || ModelError::ZeroLength { element: self.element.clone(), field };
        UnitQuaternion::try_new(Quaternion::new(w, x, y, z), SHORTEST).ok_or_else(zero)
    }

    pub(crate) fn softness(&self, softness: &Softness) -> Result<(), ModelError> {
        let [time_constant, damping_ratio] = softness.solref;
        let [d0, d_width, width, midpoint, power] = softness.solimp;
        self.above("softness.solref", time_constant, 0.0, " s", "a time constant above 0 s")?;
        self.above("softness.solref", damping_ratio, 0.0, "", "a damping ratio above 0")?;
        for impedance in [d0, d_width, midpoint] {
            self.require((0.0..=1.0).contains(&impedance), "softness.solimp", impedance, "", "between 0 and 1")?;
        }
        self.within("softness.solref", &[time_constant], &Bound::TIME)?;
        self.within("softness.solref", &[damping_ratio], &Bound::RATIO)?;
        self.not_negative("softness.solimp", width, "")?;
        self.within("softness.solimp", &[width], &Bound::JOINT_POSITION)?;
        let is_power = (1.0..=MOST_POWER).contains(&power);
        self.require(is_power, "softness.solimp", power, "", "a power between 1 and 8")
    }

    /// Lengths that a tendon does not leave: only one end of them at a time.
    pub(crate) fn tendon_limit(&self, limit: &TendonLimit) -> Result<(), ModelError> {
        self.within("limit.range", &limit.range, &Bound::LENGTH)?;
        self.ascending("limit.range", limit.range, " m")?;
        self.not_negative("limit.margin", limit.margin, " m")?;
        let [shortest, longest] = limit.range;
        let fits = 2.0 * limit.margin < longest - shortest;
        self.require(fits, "limit.margin", limit.margin, " m", "less than half of the range")?;
        self.softness(&limit.softness)
    }

    /// Parameters of a muscle that is integrated in steps of `timestep` (s).
    pub(crate) fn muscle(&self, muscle: &MuscleParameters, timestep: f64) -> Result<(), ModelError> {
        self.within("length_range", &muscle.length_range, &Bound::LENGTH)?;
        self.ascending("length_range", muscle.length_range, " m")?;
        self.within("ctrl_range", &muscle.ctrl_range, &Bound::RATIO)?;
        self.ascending("ctrl_range", muscle.ctrl_range, "")?;
        for (field, tau) in [("tau_act", muscle.tau_act), ("tau_deact", muscle.tau_deact)] {
            self.above(field, tau, 0.0, " s", "above 0 s")?;
            self.within(field, &[tau], &Bound::TIME)?;
            // A quicker activation overshoots ever farther.
            self.at_least(field, tau, timestep, " s", "at least the time step, `options.timestep`")?;
        }
        self.not_negative("tau_smooth", muscle.tau_smooth, "")?;
        self.within("tau_smooth", &[muscle.tau_smooth], &Bound::RATIO)?;
        self.curve(&muscle.gain)?;
        self.curve(&muscle.bias)
    }

    fn curve(&self, curve: &CurveParameters) -> Result<(), ModelError> {
        self.within("range", &curve.range, &Bound::NORMALISED)?;
        self.ascending("range", curve.range, " optimal lengths")?;
        if let Some(force) = curve.force {
            self.not_negative("force", force, " N")?;
            self.within("force", &[force], &Bound::FORCE)?;
        }
        self.not_negative("scale", curve.scale, "")?;
        self.within("scale", &[curve.scale], &Bound::FORCE)?;
        self.require(curve.lmin < 1.0, "lmin", curve.lmin, "", "below the optimal length of 1")?;
        self.above("lmax", curve.lmax, 1.0, "", "above the optimal length of 1")?;
        self.above("vmax", curve.vmax, 0.0, " optimal lengths/s", "above 0")?;
        self.not_negative("fpmax", curve.fpmax, "")?;
        self.at_least("fvmax", curve.fvmax, 1.0, "", "1 or more")?;
        self.within("lmin", &[curve.lmin], &Bound::NORMALISED)?;
        self.within("lmax", &[curve.lmax], &Bound::NORMALISED)?;
        self.within("vmax", &[curve.vmax], &Bound::RATIO)?;
        self.within("fpmax", &[curve.fpmax], &Bound::RATIO)?;
        self.within("fvmax", &[curve.fvmax], &Bound::RATIO)
    }
}
