//! Checks of numbers.

use crate::description::Softness;
use crate::error::{Element, ElementKind, ModelError};
use myo_muscle::{CurveParameters, MuscleParameters};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Length below which a direction or a quaternion has none.
const SHORTEST: f64 = 1e-15;

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
        self.finite(field, &value)?;
        let zero = || ModelError::ZeroLength { element: self.element.clone(), field };
        Vector3::from(value).try_normalize(SHORTEST).ok_or_else(zero)
    }

    pub(crate) fn rotation(&self, field: &'static str, wxyz: [f64; 4]) -> Result<UnitQuaternion<f64>, ModelError> {
        self.finite(field, &wxyz)?;
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
        self.not_negative("softness.solimp", width, "")?;
        self.at_least("softness.solimp", power, 1.0, "", "a power of 1 or more")
    }

    pub(crate) fn muscle(&self, muscle: &MuscleParameters) -> Result<(), ModelError> {
        self.ascending("length_range", muscle.length_range, " m")?;
        self.ascending("ctrl_range", muscle.ctrl_range, "")?;
        self.above("tau_act", muscle.tau_act, 0.0, " s", "above 0 s")?;
        self.above("tau_deact", muscle.tau_deact, 0.0, " s", "above 0 s")?;
        self.not_negative("tau_smooth", muscle.tau_smooth, "")?;
        self.curve(&muscle.gain)?;
        self.curve(&muscle.bias)
    }

    fn curve(&self, curve: &CurveParameters) -> Result<(), ModelError> {
        self.ascending("range", curve.range, " optimal lengths")?;
        if let Some(force) = curve.force {
            self.not_negative("force", force, " N")?;
        }
        self.not_negative("scale", curve.scale, "")?;
        self.require(curve.lmin < 1.0, "lmin", curve.lmin, "", "below the optimal length of 1")?;
        self.above("lmax", curve.lmax, 1.0, "", "above the optimal length of 1")?;
        self.above("vmax", curve.vmax, 0.0, " optimal lengths/s", "above 0")?;
        self.not_negative("fpmax", curve.fpmax, "")?;
        self.at_least("fvmax", curve.fvmax, 1.0, "", "1 or more")
    }
}
