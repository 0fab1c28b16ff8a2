//! How spheres move about their places, as it stands in a file, and as waves that are added up.

use std::f64::consts::TAU;

use garde::Validate;
use nalgebra::{Rotation3, Vector3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::quantity::Quantity;
use crate::scene::{is_zero, tilted_and_turned};
use crate::target::{LENGTH, TILT, TURN, on_one_line};

const EXCURSION: Quantity = Quantity::between(-2.0, 2.0, "m");
const WAY: Quantity = Quantity::between(-100.0, 100.0, "m");
const ACCELERATION: Quantity = Quantity::between(0.01, 1000.0, "m/s^2");
const DRAG: Quantity = Quantity::between(0.0, 100.0, "per s");
const FREQUENCY: Quantity = Quantity::between(0.001, 5.0, "Hz");
const PERIOD: Quantity = Quantity::between(0.2, 600.0, "s");
/// Waves of each axis that are drawn.
pub(crate) const SINES: usize = 5;
/// Most waves that are added up.
pub(crate) const WAVES_MAX: usize = 4;
/// Periods of a random path's waves, in units of the shortest: no two repeat together for long.
const RANDOM_PERIODS: [f64; WAVES_MAX] = [1.0, 1.37, 1.93, 2.71];

/// How a sphere moves about its place. Every episode begins somewhere else on the path.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Motion {
    /// Round and round.
    Circle(CircularMotion),
    /// Back and forth, like a pendulum.
    Line(LinearMotion),
    /// Up to four sine waves, added up.
    Waves(Waves),
    /// A path that does not repeat and cannot be foreseen for long.
    Random(RandomMotion),
    /// Sine waves that are drawn anew for every episode, slow ones and fast ones.
    Sines(SinesMotion),
    /// As a stick drives it, like a car on rails.
    Driven(DrivenMotion),
}

/// Round and round on a circle about the sphere's place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct CircularMotion {
    /// Diameter of the circle, in m.
    #[garde(custom(LENGTH.rule()))]
    #[schemars(transform = LENGTH.schema())]
    pub diameter: f64,

    /// Time of one round, in s. From 0.2 to 600.
    #[garde(custom(PERIOD.rule()))]
    #[schemars(transform = PERIOD.schema())]
    pub period_s: f64,

    /// How the circle is tilted, in degrees: 0 lies like a table; 90, the default, stands like a wall before the user.
    #[serde(default = "upright", skip_serializing_if = "is_upright")]
    #[garde(custom(TILT.rule()))]
    #[schemars(transform = TILT.schema())]
    pub tilt_deg: f64,

    /// Turned about the vertical, in degrees, to the left as seen from above. Default 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[garde(custom(TURN.rule()))]
    #[schemars(transform = TURN.schema())]
    pub turn_deg: f64,
}

/// Back and forth along a line whose middle is the sphere's place, fastest there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct LinearMotion {
    /// From one end to the other, `[x, y, z]` in m.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(EXCURSION.rule())))]
    #[schemars(transform = EXCURSION.schema())]
    pub by: [f64; 3],

    /// Time of one way there and back, in s. From 0.2 to 600.
    #[garde(custom(PERIOD.rule()))]
    #[schemars(transform = PERIOD.schema())]
    pub period_s: f64,
}

/// Sine waves that are added up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Waves {
    /// The waves, 1 to 4; each begins anywhere in its period.
    #[garde(dive, length(min = 1, max = WAVES_MAX))]
    #[schemars(length(min = 1, max = 4))]
    pub waves: Vec<Wave>,
}

/// A sine wave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct Wave {
    /// How far it goes from the middle to either side, `[x, y, z]` in m.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(EXCURSION.rule())))]
    #[schemars(transform = EXCURSION.schema())]
    pub by: [f64; 3],

    /// Time of one wave, in s. From 0.2 to 600.
    #[garde(custom(PERIOD.rule()))]
    #[schemars(transform = PERIOD.schema())]
    pub period_s: f64,
}

/// Four waves of different periods, each axis for itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct RandomMotion {
    /// How far it may go from its place to either side, `[x, y, z]` in m.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(EXCURSION.rule())))]
    #[schemars(transform = EXCURSION.schema())]
    pub by: [f64; 3],

    /// Period of the fastest of its waves, in s; the slowest takes 2.7 times as long. From 0.2 to 600.
    #[garde(custom(PERIOD.rule()))]
    #[schemars(transform = PERIOD.schema())]
    pub period_s: f64,
}

/// Each axis for itself is a sum of five sine waves whose frequencies, phases and weights every episode draws, as in the tracking task of User-in-the-Box
/// (Ikkala et al. 2022, doi 10.1145/3526113.3545689): frequencies from 0 to the greatest, weights from 1 to 5, scaled so that no wave leaves the range.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct SinesMotion {
    /// How far it may go from its place to either side, `[x, y, z]` in m.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(EXCURSION.rule())))]
    #[schemars(transform = EXCURSION.schema())]
    pub by: [f64; 3],

    /// Greatest frequency of its waves, in Hz. From 0.001 to 5.
    #[garde(custom(FREQUENCY.rule()))]
    #[schemars(transform = FREQUENCY.schema())]
    pub up_to_hz: f64,
}

/// Along a line, as a stick drives it (`drive` in the script): the stick accelerates it, and by itself it comes to a stop. It stands still at its
/// place when an episode begins, and while no step asks to drive it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
pub struct DrivenMotion {
    /// How far it may go from its place to either side, `[x, y, z]` in m; this way where the angle of the stick rises.
    #[serde(serialize_with = "on_one_line")]
    #[garde(inner(custom(WAY.rule())))]
    #[schemars(transform = WAY.schema())]
    pub by: [f64; 3],

    /// Its acceleration where the stick is as far from 0 as it goes, in m/s^2; less in proportion where it is not. Default 2.
    #[serde(default = "brisk")]
    #[garde(custom(ACCELERATION.rule()))]
    #[schemars(transform = ACCELERATION.schema())]
    pub acceleration: f64,

    /// The share of its speed that it would lose in a second, per s, so that `acceleration / drag_per_s` is its greatest speed in m/s. Default 1.
    #[serde(default = "one")]
    #[garde(custom(DRAG.rule()))]
    #[schemars(transform = DRAG.schema())]
    pub drag_per_s: f64,
}

/// A path as waves: at time `t` (s) the centre is off its place by the sum of `cosine cos(angle) + sine sin(angle)`, where
/// `angle = rate t + phase` and every episode draws the phase of every wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The waves; none where all are drawn.
    pub waves: Vec<PathWave>,
    /// Those that every episode draws.
    pub sines: Option<PathSines>,
    /// How a stick drives it, in place of waves.
    pub driven: Option<PathDriven>,
}

/// A line along which a stick drives something, see [`DrivenMotion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathDriven {
    /// How far it goes one way; as far the other way (m, world axes).
    pub by: [f64; 3],
    /// Acceleration where the stick is as far from 0 as it goes (m/s^2).
    pub acceleration: f64,
    /// Share of the speed that is lost by time (1/s).
    pub drag: f64,
}

/// Waves of a path that every episode draws, see [`SinesMotion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSines {
    /// How far the waves of each own axis go at most (m, world axes).
    pub axes: [[f64; 3]; 3],
    /// Greatest angle per time (rad/s).
    pub rate: f64,
}

/// One of the waves of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathWave {
    /// Goes with the cosine (m, world axes).
    pub cosine: [f64; 3],
    /// Goes with the sine (m, world axes).
    pub sine: [f64; 3],
    /// Angle per time (rad/s).
    pub rate: f64,
}

impl Motion {
    /// Its waves, for a frame that is turned and scaled like this; none where it does not move at all.
    pub(crate) fn path(&self, rotation: Rotation3<f64>, scale: f64) -> Option<Path> {
        let wave = |cosine: Vector3<f64>, sine: Vector3<f64>, period_s: f64| PathWave {
            cosine: (rotation * cosine * scale).into(),
            sine: (rotation * sine * scale).into(),
            rate: TAU / period_s,
        };
        let still = Vector3::zeros();
        let waves: Vec<PathWave> = match self {
            Self::Circle(circle) => {
                let (own, radius) = (tilted_and_turned(circle.tilt_deg, circle.turn_deg), 0.5 * circle.diameter);
                vec![wave(own * Vector3::x() * radius, own * Vector3::y() * radius, circle.period_s)]
            }
            Self::Line(line) => vec![wave(Vector3::from(line.by) * 0.5, still, line.period_s)],
            Self::Waves(waves) => {
                waves.waves.iter().map(|each| wave(Vector3::from(each.by), still, each.period_s)).collect()
            }
            Self::Random(random) => random.waves().map(|(cosine, sine, period)| wave(cosine, sine, period)).collect(),
            Self::Sines(sines) => {
                let [x, y, z] = sines.by;
                let axes = [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]];
                let axes = axes.map(|axis| (rotation * Vector3::from(axis) * scale).into());
                let moves = sines.by.iter().any(|x| *x != 0.0);
                let sines = PathSines { axes, rate: TAU * sines.up_to_hz };
                return moves.then_some(Path { waves: vec![], sines: Some(sines), driven: None });
            }
            Self::Driven(DrivenMotion { by, acceleration, drag_per_s }) => {
                let way: [f64; 3] = (rotation * Vector3::from(*by) * scale).into();
                let driven = PathDriven { by: way, acceleration: *acceleration, drag: *drag_per_s };
                let moves = by.iter().any(|x| *x != 0.0);
                return moves.then_some(Path { waves: vec![], sines: None, driven: Some(driven) });
            }
        };
        let moves = |wave: &PathWave| wave.cosine.iter().chain(&wave.sine).any(|x| *x != 0.0);
        waves.iter().any(moves).then_some(Path { waves, sines: None, driven: None })
    }
}

impl RandomMotion {
    /// Slow waves are wide, so that all are equally fast; the vertical goes with cosine and sine by turns, so that no axis
    /// follows another.
    fn waves(&self) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>, f64)> {
        let [x, y, z] = self.by;
        let sum: f64 = RANDOM_PERIODS.iter().sum();
        RANDOM_PERIODS.into_iter().enumerate().map(move |(k, period)| {
            let (share, up) = (period / sum, z * 0.5_f64.sqrt());
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let (cosine, sine) = (Vector3::new(x, 0.0, sign * up), Vector3::new(0.0, y, up));
            (cosine * share, sine * share, period * self.period_s)
        })
    }
}

impl Path {
    /// How far (m) the centre is off its place at a time (s), with these phases (rad); a wave without one has none. Waves that are drawn are left out.
    pub fn offset(&self, time_s: f64, phases: &[f64]) -> [f64; 3] {
        let phases = phases.iter().copied().chain(std::iter::repeat(0.0));
        let sum = self.waves.iter().zip(phases).fold(Vector3::zeros(), |sum: Vector3<f64>, (wave, phase)| {
            let (sin, cos) = (wave.rate * time_s + phase).sin_cos();
            sum + Vector3::from(wave.cosine) * cos + Vector3::from(wave.sine) * sin
        });
        sum.into()
    }

    /// No point of it is farther off its place along an axis (m).
    pub fn farthest(&self, axis: usize) -> f64 {
        let drawn = self.ways().map(|own| own[axis].abs());
        self.waves.iter().map(|wave| wave.cosine[axis].hypot(wave.sine[axis])).chain(drawn).sum()
    }

    /// Ways along which it goes to either side, besides its waves (m).
    fn ways(&self) -> impl Iterator<Item = [f64; 3]> {
        let drawn = self.sines.into_iter().flat_map(|sines| sines.axes);
        drawn.chain(self.driven.map(|driven| driven.by))
    }

    /// Places that it comes to, off its own (m): where all waves go the same way, and the farthest along every axis.
    pub(crate) fn samples(&self) -> Vec<[f64; 3]> {
        const ANGLES: u32 = 16;
        let together = (0..ANGLES).map(|k| vec![TAU * f64::from(k) / f64::from(ANGLES); self.waves.len()]);
        let farthest = [(0, 0.0), (0, 0.5), (1, 0.0), (1, 0.5), (2, 0.0), (2, 0.5)].map(|(axis, turn)| {
            let phase = |wave: &PathWave| wave.sine[axis].atan2(wave.cosine[axis]) + TAU * turn;
            self.waves.iter().map(phase).collect()
        });
        let drawn = self.ways().flat_map(|axis| [axis, axis.map(|x| -x)]);
        together.chain(farthest).map(|phases: Vec<f64>| self.offset(0.0, &phases)).chain(drawn).collect()
    }
}

fn brisk() -> f64 {
    2.0
}

fn one() -> f64 {
    1.0
}

fn upright() -> f64 {
    90.0
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde asks for")]
fn is_upright(tilt_deg: &f64) -> bool {
    *tilt_deg == 90.0
}

/// By hand: the derived form would put the variant's index into the path, where the file has nothing.
impl Validate for Motion {
    type Context = ();

    fn validate_into(&self, ctx: &(), parent: &mut dyn FnMut() -> garde::Path, report: &mut garde::Report) {
        match self {
            Self::Circle(motion) => motion.validate_into(ctx, parent, report),
            Self::Line(motion) => motion.validate_into(ctx, parent, report),
            Self::Waves(motion) => motion.validate_into(ctx, parent, report),
            Self::Random(motion) => motion.validate_into(ctx, parent, report),
            Self::Sines(motion) => motion.validate_into(ctx, parent, report),
            Self::Driven(motion) => motion.validate_into(ctx, parent, report),
        }
    }
}
