//! What muscles do that nobody decides: noise, reflexes and fatigue.

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::{HELD, SHARE};
use crate::quantity::Quantity;

const SPEED: Quantity = Quantity::between(0.0, 1000.0, "");
const GAIN: Quantity = Quantity::between(0.0, 1000.0, "");

/// Gaussian motor noise on the muscle controls: independent for each muscle, and as strong and as slow at any control step as noise
/// that is drawn every `held_s` and held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
pub struct Noise {
    /// Standard deviation as a share of the control itself. Default 0 (off); the literature's level is 0.103.
    #[garde(custom(SHARE.rule()))]
    #[schemars(transform = SHARE.schema())]
    pub signal_dependent: f64,

    /// Standard deviation that does not depend on the control. Default 0 (off); the literature's level is 0.185.
    #[garde(custom(SHARE.rule()))]
    #[schemars(transform = SHARE.schema())]
    pub constant: f64,

    /// How slow the noise is: as slow as noise that is drawn every so many seconds and held until then. The force of people's muscles varies by slow
    /// common fluctuations of what drives them for the most part (Dideriksen et al. 2012, doi 10.1152/jn.00938.2011). Default 0.05.
    #[garde(custom(HELD.rule()))]
    #[schemars(transform = HELD.schema())]
    pub held_s: f64,
}

impl Default for Noise {
    fn default() -> Self {
        Self { signal_dependent: 0.0, constant: 0.0, held_s: 0.05 }
    }
}

/// Stretch reflexes: a muscle that works is excited more while it lengthens and less while it shortens, without a decision, and so a held arm gives
/// way less. It is by how fast the muscle lengthens at the start of a control step, and so late by half of one on average. It is in proportion to what
/// is asked of the muscle (Matthews 1986, doi 10.1113/jphysiol.1986.sp016066), in proportion to slow changes of length and no greater for fast ones, a coarse form
/// of spindles that tell of the root of the speed (Prochazka and Gorassini 1998, doi 10.1111/j.1469-7793.1998.277bu.x), and changing it costs nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
pub struct Reflex {
    /// By how much of itself an excitation grows, per greatest shortening speed of the muscle at which it lengthens. Default 0 (off).
    #[garde(custom(GAIN.rule()))]
    #[schemars(transform = GAIN.schema())]
    pub gain: f64,

    /// By how much of itself it grows or shrinks at most. Default 0.3.
    #[garde(custom(SHARE.rule()))]
    #[schemars(transform = SHARE.schema())]
    pub most: f64,
}

impl Default for Reflex {
    fn default() -> Self {
        Self { gain: 0.0, most: 0.3 }
    }
}

/// Fatigue: what of a muscle cannot be driven after work, and comes back with rest. The three-compartment model with faster recovery at rest (3CC-r; Looft, Herkert and
/// Frey-Law 2018, doi 10.1016/j.jbiomech.2018.06.005) with the published rates of each muscle's joint: of what is active a share fatigues (1.8 % per second at the
/// shoulder, 0.9 at elbow and hand), and what is not fatigued is the most that a muscle can be excited. The user feels it (`observation.fatigue`).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
pub struct Fatigue {
    /// How many times as fast as people muscles tire and recover. Default 0 (off); 1 as people, 10 what takes people ten minutes in one.
    #[garde(custom(SPEED.rule()))]
    #[schemars(transform = SPEED.schema())]
    pub speed: f64,

    /// Whether it lasts from one episode to the next, until a reset with a seed: long work is many episodes. Otherwise every episode begins as `initial_max` says.
    /// Who learns so is soon at work for long in every environment, and forgets how to begin. Default false.
    #[garde(skip)]
    pub lasts: bool,

    /// What of each muscle is fatigued at the start is drawn from 0 to this. Default 0: rested.
    #[garde(custom(SHARE.rule()))]
    #[schemars(transform = SHARE.schema())]
    pub initial_max: f64,
}

impl Default for Fatigue {
    fn default() -> Self {
        Self { speed: 0.0, lasts: false, initial_max: 0.0 }
    }
}

impl Fatigue {
    /// Whether muscles tire, or may be tired from the start.
    pub fn is_on(&self) -> bool {
        self.speed > 0.0 || self.initial_max > 0.0
    }
}
