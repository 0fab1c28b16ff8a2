//! Muscle fatigue: what of a muscle cannot be driven after work, and comes back with rest.
//!
//! The three-compartment controller (Xia and Frey-Law 2008, doi 10.1016/j.jbiomech.2008.07.013): of a muscle's motor units a share rests, a share `a` is active, and a
//! share `f` is fatigued. Active ones fatigue at a rate `F`, fatigued ones recover at a rate `R`, `r` times as fast while the muscle rests (3CC-r, Looft, Herkert and
//! Frey-Law 2018, doi 10.1016/j.jbiomech.2018.06.005):
//!
//! ```text
//! df/dt = F a - R f    (r R instead of R at rest),    a <= 1 - f
//! ```
//!
//! The model's own controller brings units to work and back within a tenth of a second. Here activation dynamics do that, so that of its three numbers one is left:
//! what is not fatigued is the most that a muscle can be excited.
//!
//! Rates are those that fit how long people hold loads, fit joint by joint to 194 studies (Frey-Law, Looft and Heitsman 2012, doi 10.1016/j.jbiomech.2012.04.018, Table 1;
//! Frey-Law and Avin 2010, doi 10.1080/00140130903389068), read where others quote them: for men and women alike, since none were found for each.

use myo_scalar::{Real, Scalar};
#[cfg(feature = "serde")]
use schemars::JsonSchema;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

/// Muscles rest that are excited less than this: 1 % of all they can, since with noise and habits nothing is ever at exactly none. A choice.
const REST: f64 = 0.01;

/// Which joint a muscle moves, as far as fatigue differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum MuscleGroup {
    /// The shoulder and its girdle.
    Shoulder,
    /// The elbow, and the forearm's turning.
    Elbow,
    /// Wrist, hand and grip.
    Hand,
    /// The trunk.
    Trunk,
    /// The knee.
    Knee,
    /// The ankle.
    Ankle,
}

/// How fast muscles tire and recover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FatigueRates {
    /// `F`: share of active motor units that fatigue per second.
    pub fatigue_per_s: f64,
    /// `R`: share of fatigued ones that recover per second of work.
    pub recovery_per_s: f64,
    /// `r`: how many times as fast they recover at rest.
    pub rest_factor: f64,
}

/// How long people hold a share `f` of their greatest load, between a tenth and all of it: `b0 f^b1` s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Endurance {
    /// `b0`: how long they hold all of it (s).
    pub at_full_load_s: f64,
    /// `b1`: how much shorter heavier loads are held.
    pub exponent: f64,
}

impl MuscleGroup {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::Shoulder, Self::Elbow, Self::Hand, Self::Trunk, Self::Knee, Self::Ankle];

    /// Its name in a model file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shoulder => "shoulder",
            Self::Elbow => "elbow",
            Self::Hand => "hand",
            Self::Trunk => "trunk",
            Self::Knee => "knee",
            Self::Ankle => "ankle",
        }
    }

    /// Its rates. `r` was fitted at ankle, knee, elbow and hand (Looft et al. 2018), at the shoulder by Looft and Frey-Law 2020 (doi 10.1016/j.jbiomech.2020.109762), and not at the
    /// trunk, which has the usual 15.
    pub const fn rates(self) -> FatigueRates {
        let [fatigue_per_s, recovery_per_s, rest_factor] = match self {
            Self::Shoulder => [0.01820, 0.00168, 15.0],
            Self::Elbow => [0.00912, 0.00094, 15.0],
            Self::Hand => [0.00980, 0.00064, 30.0],
            Self::Trunk => [0.00755, 0.00075, 15.0],
            Self::Knee => [0.01500, 0.00149, 15.0],
            Self::Ankle => [0.00589, 0.00058, 15.0],
        };
        FatigueRates { fatigue_per_s, recovery_per_s, rest_factor }
    }

    /// How long people hold loads with it (Frey-Law and Avin 2010).
    pub const fn endurance(self) -> Endurance {
        let [at_full_load_s, exponent] = match self {
            Self::Shoulder => [14.86, -1.83],
            Self::Elbow => [17.98, -2.21],
            Self::Hand => [33.55, -1.61],
            Self::Trunk => [22.69, -2.27],
            Self::Knee => [19.38, -1.88],
            Self::Ankle => [34.71, -2.06],
        };
        Endurance { at_full_load_s, exponent }
    }
}

impl Endurance {
    /// Of all joints together.
    pub const POOLED: Self = Self { at_full_load_s: 21.92, exponent: -1.98 };

    /// How long (s) they hold this share of their greatest load.
    pub fn time_s(self, share: f64) -> f64 {
        self.at_full_load_s * share.powf(self.exponent)
    }
}

impl FatigueRates {
    /// Of all joints together, for muscles of which no joint is known.
    pub const POOLED: Self = Self { fatigue_per_s: 0.00970, recovery_per_s: 0.00091, rest_factor: 15.0 };

    /// Those of a group, or of all joints together.
    pub fn of(group: Option<MuscleGroup>) -> Self {
        group.map_or(Self::POOLED, MuscleGroup::rates)
    }
}

/// How much a muscle tires and recovers in a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fatigue<T> {
    /// Share of what is active that fatigues.
    fatigue: T,
    /// Share of what is fatigued that recovers at work.
    recovery: T,
    /// The same at rest.
    recovery_at_rest: T,
}

impl<C: Real> Fatigue<C> {
    /// In steps of so many seconds. `speed` is how many times as fast as these rates it goes.
    pub fn new(rates: FatigueRates, speed: f64, seconds: f64) -> Self {
        let FatigueRates { fatigue_per_s, recovery_per_s, rest_factor } = rates;
        // Shares of one at most, however long the step: nothing is below none or above all.
        let share = |rate: f64| C::from_f64(-(-rate * speed * seconds).exp_m1());
        Self {
            fatigue: share(fatigue_per_s),
            recovery: share(recovery_per_s),
            recovery_at_rest: share(recovery_per_s * rest_factor),
        }
    }
}

impl<C: Real> Fatigue<C> {
    /// Of muscles that do not tire: nothing fatigues, and what was fatigued has recovered a step later.
    pub fn none() -> Self {
        let [none, all] = [0.0, 1.0].map(C::from_f64);
        Self { fatigue: none, recovery: all, recovery_at_rest: all }
    }
}

impl<T> Fatigue<T> {
    /// The same with other numbers: each is what `f` makes of this one, in a fixed order.
    #[inline(always)]
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Fatigue<U> {
        Fatigue { fatigue: f(&self.fatigue), recovery: f(&self.recovery), recovery_at_rest: f(&self.recovery_at_rest) }
    }
}

impl<S: Scalar> Fatigue<S> {
    /// What is fatigued (a share) a step later, of a muscle that is as active and is excited as told, each from 0 to 1.
    #[inline(always)]
    pub fn next(&self, fatigued: S, activation: S, excitation: S) -> S {
        let recovery = S::select(excitation.lt(S::lit(REST)), self.recovery_at_rest, self.recovery);
        // Only what is not fatigued already can fatigue.
        let active = activation.min(S::lit(1.0) - fatigued);
        self.fatigue.mul_add(active, fatigued - recovery * fatigued)
    }
}

/// The most that a muscle can be excited of which this share is fatigued, of what it is asked for.
#[inline(always)]
pub fn left_of<S: Scalar>(excitation: S, fatigued: S) -> S {
    excitation.min(S::lit(1.0) - fatigued)
}
