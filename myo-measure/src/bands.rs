//! Bands of human figures: fifteen checks that tell whether a simulated user moves like people.
//!
//! A band is a set of [`Bound`]s on figures. They are wide, since people, tasks and methods of measurement differ; [`BANDS`] names
//! what they are drawn from, and [`Confidence`] says how far they can be trusted. Figures are medians over at least 200 movements
//! of at least 3 users, measured with motor noise and a deterministic policy, unless said otherwise; that much is up to the caller.

use std::fmt;

use serde::Serialize;

use crate::{Result, check};

mod table;

pub use table::BANDS;

/// How far a bound can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Confidence {
    /// Measured in people by several.
    Good,
    /// Drawn from few studies, or from studies of other tasks.
    Fair,
    /// Derived, or hanging on the method of measurement: worth reading, not worth judging by.
    Unreliable,
}

/// What bands are about. Units are SI; shares are of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Figure {
    /// Different indices of difficulty from 1.5 to 5 bits that the fit stands on
    /// ([`Pointing::distinct_indices`](crate::fitts::Pointing::distinct_indices)).
    DistinctIndices,
    /// R2 of Fitts' law through means of conditions.
    FitR2,
    /// Slope of Fitts' law in s/bit.
    FitSlope,
    /// Effective throughput in bit/s, without dwell and reaction.
    Throughput,
    /// Movement time in s over 30 cm to a target of 5 cm, without dwell and reaction.
    MovementTime30,
    /// Peak speed in m/s over 30 cm.
    PeakSpeed30,
    /// Peak over mean speed.
    PeakOverMean,
    /// Time of the peak as a share of the duration.
    TimeOfPeak,
    /// Change of that share per bit of difficulty by smaller widths.
    TimeOfPeakPerBit,
    /// Speed maxima per movement at less than 2.5 bits.
    SpeedMaximaEasy,
    /// Speed maxima per movement at 3 to 5 bits.
    SpeedMaximaHard,
    /// Change of the mean number of speed maxima per bit of difficulty.
    SpeedMaximaPerBit,
    /// Spectral arc length.
    Sparc,
    /// Logarithm of the dimensionless jerk. It hangs on the window: from 5 % to 5 % of its peak speed even minimum jerk has -4.4, outside
    /// of the band, which is why it is not judged.
    Ldlj,
    /// Path over chord from target to target of a plane.
    PathOverChord,
    /// Path over chord from the hanging arm.
    PathOverChordFromHanging,
    /// SD of end points along the movement over that across, without sight of the hand.
    EndpointElongation,
    /// Change of the SD along the movement per metre of distance.
    EndpointGrowth,
    /// SD of end points across the movement as seen from its start, in degrees.
    EndpointDirectionDeg,
    /// Mean speed of a hand that holds still, in m/s.
    HoldSpeed,
    /// Tremor of a hand that holds still from 4 to 15 Hz, peak to peak, in m.
    Tremor,
    /// Mean activation of all muscles of an arm held at 45 degrees.
    MeanActivation,
    /// Share of activations above 0.95.
    ShareSaturated,
    /// Co-contraction index of the elbow.
    ElbowCoContraction,
    /// Peak force of a tap in N.
    TapPeakForce,
    /// Contact time of a tap in s.
    TapContactTime,
    /// Taps per second, as fast as possible.
    TapRate,
    /// Share of its strength that a stretched arm, held at 90 degrees, takes.
    HoldingShare,
    /// Changes of sign of the moment arms of brachialis and deltoid within the range of motion.
    MomentArmSignChanges,
    /// Least quotient of endurance time and that of people, over loads of 0.2 to 0.8 of strength.
    EnduranceLeast,
    /// Greatest such quotient.
    EnduranceGreatest,
    /// How often, from load to greater load, endurance does not fall.
    EnduranceRises,
    /// Fatigue of work at the waist over that of the same work at the height of the shoulder.
    WaistOverShoulder,
}

/// What a figure should be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bound {
    /// Which figure.
    pub figure: Figure,
    /// Least that passes.
    pub lower: Option<f64>,
    /// Most that passes.
    pub upper: Option<f64>,
    /// Whether the limits themselves pass.
    pub closed: bool,
    /// How far it can be trusted.
    pub confidence: Confidence,
    /// Whether it is judged; others are reported only.
    pub judged: bool,
}

impl Bound {
    /// Whether a value is within.
    pub fn holds(&self, value: f64) -> bool {
        let above = self.lower.is_none_or(|lower| value > lower || self.closed && value == lower);
        let below = self.upper.is_none_or(|upper| value < upper || self.closed && value == upper);
        above && below
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.lower, self.upper, self.closed) {
            (Some(lower), Some(upper), true) => write!(f, "from {lower} to {upper}"),
            (Some(lower), Some(upper), false) => write!(f, "between {lower} and {upper}"),
            (Some(lower), None, true) => write!(f, "at least {lower}"),
            (Some(lower), None, false) => write!(f, "above {lower}"),
            (None, Some(upper), true) => write!(f, "at most {upper}"),
            (None, Some(upper), false) => write!(f, "below {upper}"),
            (None, None, _) => f.write_str("anything"),
        }
    }
}

/// One of the fifteen checks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// From 1 to 15.
    pub number: u8,
    /// What is looked at.
    pub what: &'static str,
    /// What the other figures need to mean anything; the band counts as not measured without it.
    #[serde(skip)]
    pub requires: &'static [Bound],
    /// What the figures should be.
    #[serde(skip)]
    pub bounds: &'static [Bound],
}

/// Figures of a simulated user, or of a person.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    values: std::collections::BTreeMap<Figure, f64>,
}

impl Figures {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a figure, or replaces it.
    ///
    /// # Errors
    /// A value that is not finite: what was not measured is left out instead.
    pub fn set(&mut self, figure: Figure, value: f64) -> Result<&mut Self> {
        check::setting("figure", value, "finite; leave out what was not measured", true)?;
        self.values.insert(figure, value);
        Ok(self)
    }

    /// A figure, where it was measured.
    pub fn get(&self, figure: Figure) -> Option<f64> {
        self.values.get(&figure).copied()
    }
}

/// What comes of a figure, or of a band.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// All that is judged is within its bounds.
    Passed,
    /// Something that is judged is out of its bounds.
    Failed,
    /// Something that is judged was not measured, and nothing failed.
    NotMeasured,
    /// Measured, but nothing here is judged.
    Reported,
}

/// A figure beside its bound.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// What it should be.
    #[serde(flatten)]
    pub bound: Bound,
    /// What it is.
    pub value: Option<f64>,
    /// What comes of it.
    pub verdict: Verdict,
}

/// A band, judged.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Which band.
    #[serde(flatten)]
    pub band: Band,
    /// What comes of it.
    pub verdict: Verdict,
    /// Its figures: first those that it requires, then those of its bounds, each in the order of the band.
    pub findings: Vec<Finding>,
}

/// All [`BANDS`], judged by these figures.
pub fn judge(figures: &Figures) -> Vec<Judgement> {
    BANDS.iter().map(|band| judge_band(band, figures)).collect()
}

fn judge_band(band: &Band, figures: &Figures) -> Judgement {
    let required: Vec<Finding> = band.requires.iter().map(|bound| requirement(bound, figures)).collect();
    let ready = required.iter().all(|finding| finding.verdict == Verdict::Passed);
    let found: Vec<Finding> = band.bounds.iter().map(|bound| finding(bound, figures, ready)).collect();
    let verdict = together(&found);
    Judgement { band: *band, verdict, findings: [required, found].concat() }
}

/// What is not as a band requires it is as good as not measured.
fn requirement(bound: &Bound, figures: &Figures) -> Finding {
    let value = figures.get(bound.figure);
    let met = value.is_some_and(|value| bound.holds(value));
    Finding { bound: *bound, value, verdict: if met { Verdict::Passed } else { Verdict::NotMeasured } }
}

fn finding(bound: &Bound, figures: &Figures, ready: bool) -> Finding {
    let value = figures.get(bound.figure);
    let verdict = match value {
        Some(_) if !bound.judged => Verdict::Reported,
        Some(value) if ready && bound.holds(value) => Verdict::Passed,
        Some(_) if ready => Verdict::Failed,
        _ => Verdict::NotMeasured,
    };
    Finding { bound: *bound, value, verdict }
}

fn together(findings: &[Finding]) -> Verdict {
    let judged = || findings.iter().filter(|finding| finding.bound.judged);
    let any = |verdict| judged().any(|finding| finding.verdict == verdict);
    match () {
        () if any(Verdict::Failed) => Verdict::Failed,
        () if any(Verdict::NotMeasured) => Verdict::NotMeasured,
        () if any(Verdict::Passed) => Verdict::Passed,
        () if findings.iter().all(|finding| finding.value.is_none()) => Verdict::NotMeasured,
        () => Verdict::Reported,
    }
}
