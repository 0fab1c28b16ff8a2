//! What ergonomists read off an arm that works in the air: how long it could go on, and in which postures it is.

use crate::{MeasureError, Result, check};

/// Below this share of their strength people go on for ever, as consumed endurance has it.
const FOR_EVER: f64 = 0.15;

fn share(share: f64) -> Result<f64> {
    check::setting("share of strength", share, "from 0 to 1", (0.0..=1.0).contains(&share))?;
    Ok(share)
}

/// How long (s) an arm that takes this share of its strength can be held up; infinite up to 15 %: consumed endurance
/// (Hincapié-Ramos, Guo, Moghadasian and Irani 2014, doi 10.1145/2556288.2557130) after Rohmert.
///
/// # Errors
/// A share that is not from 0 to 1.
pub fn rohmert_endurance_s(of_strength: f64) -> Result<f64> {
    let beyond = 100.0 * (share(of_strength)? - FOR_EVER);
    Ok(if beyond <= 0.0 { f64::INFINITY } else { 1236.5 / beyond.powf(0.618) - 72.5 })
}

/// The same as the model NICER has it (Li et al. 2024, arXiv 2406.08875), without its corrections for arms above the shoulder and for rest, whose figures were not found: no
/// share is held for ever.
///
/// # Errors
/// A share that is not from 0 to 1.
pub fn nicer_endurance_s(of_strength: f64) -> Result<f64> {
    Ok(14.86 / ((100.0 * share(of_strength)?).powf(1.83) * 0.000_218))
}

/// Share of this endurance (s) that so many seconds of work take; none where it is infinite.
///
/// # Errors
/// A time below zero, or no endurance at all.
pub fn consumed(seconds: f64, endurance_s: f64) -> Result<f64> {
    check::setting("seconds of work", seconds, "finite and at least 0", seconds.is_finite() && seconds >= 0.0)?;
    if endurance_s.is_nan() || endurance_s <= 0.0 {
        let (what, right) = ("endurance in s", "above 0");
        return Err(MeasureError::OutOfRange { what, index: None, value: endurance_s, right });
    }
    Ok(seconds / endurance_s)
}

/// Where an upper arm is, as the posture score RULA counts it (McAtamney and Corlett 1993, doi 10.1016/0003-6870(93)90080-S).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UpperArm {
    /// Within 20 degrees of the vertical: 1.
    Hanging,
    /// From 20 to 45 degrees forward or sideways, or more than 20 backward: 2.
    Low,
    /// From 45 to 90 degrees: 3.
    High,
    /// Above 90 degrees: 4.
    Overhead,
}

impl UpperArm {
    /// All, from the hanging arm on.
    pub const ALL: [Self; 4] = [Self::Hanging, Self::Low, Self::High, Self::Overhead];

    /// An upper arm that is so far (degrees) from hanging straight down; backward where that is below zero.
    ///
    /// # Errors
    /// An angle that is not finite.
    pub fn at(degrees: f64) -> Result<Self> {
        check::setting("elevation in degrees", degrees, "finite", degrees.is_finite())?;
        Ok(match degrees {
            angle if angle.abs() <= 20.0 => Self::Hanging,
            angle if angle <= 45.0 => Self::Low,
            angle if angle <= 90.0 => Self::High,
            _ => Self::Overhead,
        })
    }

    /// Its score, from 1 to 4, without what an arm that is held sideways or leant on adds or takes.
    pub fn score(self) -> u32 {
        1 + self as u32
    }

    /// Share of these angles (degrees) in each class.
    ///
    /// # Errors
    /// No angle, or one that is not finite.
    pub fn shares(degrees: &[f64]) -> Result<[f64; 4]> {
        check::at_least("angles of the upper arm", degrees.len(), 1)?;
        let mut counts = [0.0; 4];
        for (index, &angle) in degrees.iter().enumerate() {
            let class = Self::at(angle).map_err(|_| MeasureError::NotFinite {
                what: "angles of the upper arm",
                index,
                value: angle,
            })?;
            counts[class as usize] += 1.0;
        }
        Ok(counts.map(|count| count / degrees.len() as f64))
    }
}
