//! A task as it stands in a file: what to do, how it is rewarded and what the simulated user perceives.

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::body::{Body, body_rule};
use crate::check::value_errors;
use crate::motor::{Fatigue, Noise, Reflex};
use crate::notation::Name;
use crate::quantity::Quantity;
use crate::report::{InvalidTask, TaskError};
use crate::rules::{description_rule, model_rule, name_rule, observation_rule, version_rule};
use crate::scene::Scene;
use crate::script::Instruction;
use crate::target::{Pointing, Target};
use crate::technique::Technique;
use crate::user::{Perception, User};

const WEIGHT: Quantity = Quantity::between(0.0, 1e6, "");
const TIME_LIMIT: Quantity = Quantity::between(0.001, 600.0, "s");
const STEP_LIMIT: Quantity = Quantity::between(0.001, 600.0, "s");
const CONTROL_STEP: Quantity = Quantity::between(0.001, 0.5, "s");
const ANGLE_SPREAD: Quantity = Quantity::between(0.0, 1.0, "rad");
const VELOCITY_SPREAD: Quantity = Quantity::between(0.0, 10.0, "rad/s");
const SCALE: Quantity = Quantity::between(0.0, 10.0, "m");
pub(crate) const HELD: Quantity = Quantity::between(0.001, 10.0, "s");
pub(crate) const SHARE: Quantity = Quantity::between(0.0, 1.0, "");

/// The newest version of the task format. Files of version 1 are read as well.
pub const FORMAT_VERSION: u32 = 2;

/// A task: what stands before the user, and what is to do with it within a time limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Myo task")]
pub struct Task {
    /// Version of this format: 2, or 1 with `targets` instead of a scene and a script.
    #[garde(custom(version_rule))]
    #[schemars(range(min = 1, max = 2))]
    pub version: u32,

    /// Short name, used for run folders and tables.
    #[garde(custom(name_rule))]
    #[schemars(length(min = 1, max = 64))]
    pub name: String,

    /// What the task stands for, for people. Default: empty; at most 10,000 characters.
    #[serde(default)]
    #[garde(custom(description_rule))]
    #[schemars(length(max = 10000))]
    pub description: String,

    /// The body that does it: the name of a built-in model, or a model file, looked for in the folder of the task file.
    /// Default `myo-arm`.
    #[serde(default = "default_model")]
    #[garde(custom(model_rule))]
    #[schemars(length(min = 1, max = 4096))]
    pub model: String,

    /// Who does it: what the simulated user is like where this task does not say. `human` moves as people do, `fastest` as fast as its muscles
    /// allow. Default `human`.
    #[serde(default)]
    #[garde(skip)]
    pub user: User,

    /// What the user's body is like where it is not as the model has it: how large, how strong, which hand.
    #[serde(default)]
    #[garde(dive, custom(body_rule))]
    pub body: Body,

    /// What stands there: objects by name, alone or in groups; up to 256.
    #[serde(default, skip_serializing_if = "Scene::is_empty")]
    #[garde(dive)]
    pub scene: Scene,

    /// What is to do with them, one after the other; up to 256 steps.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[garde(skip)]
    pub script: Vec<Instruction>,

    /// What points: the fingertip, a ray, a Go-Go hand or a cursor. Default `fingertip`.
    #[serde(default, skip_serializing_if = "Technique::is_fingertip")]
    #[garde(dive)]
    pub technique: Technique,

    /// What the simulated user sees of the task: the object of the current step and of the next one, or of the `current` one alone.
    /// Default `all`.
    #[serde(default, skip_serializing_if = "Stimulus::is_all")]
    #[garde(skip)]
    pub stimulus: Stimulus,

    /// The button that takes back a wrong press, such as `delete`: each must be corrected before the script goes on. Without it
    /// wrong presses are counted, and cost what `reward.wrong_press` says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(skip)]
    pub correction: Option<Name>,

    /// Of version 1 alone: the targets in the order in which they must be done, 1 to 10, repetitions counted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[garde(dive)]
    #[schemars(length(max = 10))]
    pub targets: Vec<Target>,

    /// When an episode ends without success, in s. Rounded to whole control steps. Default 12.
    #[serde(default = "default_time_limit")]
    #[garde(custom(TIME_LIMIT.rule()))]
    #[schemars(transform = TIME_LIMIT.schema())]
    pub time_limit_s: f64,

    /// How long each step of the script may take, in s, from when it counts. What is not done by then is given up: the script goes on with the next
    /// step, and the episode is no success. Rounded to whole control steps. Default: as long as the episode.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(custom(step_limit_rule))]
    #[schemars(transform = STEP_LIMIT.schema())]
    pub step_limit_s: Option<f64>,

    /// Time between two decisions of the simulated user, in s; muscle controls are held in between.
    /// From 0.001 to 0.5; default 0.05 (20 Hz).
    #[serde(default = "default_control_step")]
    #[garde(custom(CONTROL_STEP.rule()))]
    #[schemars(transform = CONTROL_STEP.schema())]
    pub control_dt_s: f64,

    /// What an action asks of a muscle: its excitation, or a change of what it does. Default `absolute`.
    #[serde(default, skip_serializing_if = "Control::is_absolute")]
    #[garde(skip)]
    pub control: Control,

    /// How the body starts an episode.
    #[serde(default)]
    #[garde(dive)]
    pub reset: Reset,

    /// What the simulated user is rewarded for.
    #[serde(default)]
    #[garde(dive)]
    pub reward: Reward,

    /// What the simulated user perceives.
    #[serde(default)]
    #[garde(custom(observation_rule))]
    pub observation: Observation,

    /// How late it is perceived.
    #[serde(default)]
    #[garde(dive)]
    pub perception: Perception,

    /// Motor noise, off by default.
    #[serde(default)]
    #[garde(dive)]
    pub noise: Noise,

    /// Stretch reflexes of muscles, off by default.
    #[serde(default)]
    #[garde(dive)]
    pub reflex: Reflex,

    /// Fatigue of muscles, off by default.
    #[serde(default)]
    #[garde(dive)]
    pub fatigue: Fatigue,
}

/// What the simulated user sees of the task. Default `all`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stimulus {
    /// The object of the current step, and where that of the next one is.
    #[default]
    All,
    /// The object of the current step alone.
    Current,
    /// The same, and only until the pointer has moved a centimetre towards it or elsewhere; from then on it is remembered as it was.
    BeforeMovement,
}

/// What an action `a`, from -1 to 1, asks of a muscle. Default `absolute`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// The excitation `(a + 1) / 2`.
    #[default]
    Absolute,
    /// The excitation `activation + a`, within 0 and 1, with the activation as the control step begins; as in User-in-the-Box (Ikkala et al.
    /// 2022, doi 10.1145/3526113.3545689).
    Relative,
}

impl Control {
    fn is_absolute(&self) -> bool {
        *self == Self::Absolute
    }
}

/// How the body starts an episode. Coupled joints follow the independent ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
pub struct Reset {
    /// Joint angles at the start. Default for `user: human` `near_zero`, for `user: fastest` `range_uniform`.
    #[garde(skip)]
    pub pose: Pose,

    /// With `near_zero`: angles are drawn from plus or minus this, in rad, kept within the joint range. Default 0.05.
    #[garde(custom(ANGLE_SPREAD.rule()))]
    #[schemars(transform = ANGLE_SPREAD.schema())]
    pub pose_spread_rad: f64,

    /// Joint velocities are drawn from plus or minus this, in rad/s; the pose `zero` always starts at rest. Default 0.05.
    #[garde(custom(VELOCITY_SPREAD.rule()))]
    #[schemars(transform = VELOCITY_SPREAD.schema())]
    pub velocity_spread_rad_s: f64,

    /// Muscle activations are drawn from 0 to this. Default for `user: human` 0: relaxed, for `user: fastest` 1.
    #[garde(custom(SHARE.rule()))]
    #[schemars(transform = SHARE.schema())]
    pub activation_max: f64,
}

/// Joint angles at the start of an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pose {
    /// Every independent joint anywhere in its range.
    #[default]
    RangeUniform,
    /// Every independent joint close to zero: the arm hangs.
    NearZero,
    /// Every joint at zero, at rest.
    Zero,
}

/// What the simulated user is rewarded for: costs per second, bonuses and fines per event. All weights are positive; costs are subtracted.
/// They do not depend on the control step, so that a user who decides more often is not paid otherwise.
///
/// The defaults are those that train soonest. The published system (MyoInteract) has, at 20 Hz, `distance_cost: 20`,
/// `inside_is_zero: false`, `remaining_path: true`, `time_cost: 0`, `subtask_bonus: 0`, `completion_bonus: 10`, `effort_cost: 0`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
pub struct Reward {
    /// Cost per second and metre of the distance from the fingertip to the current target. Default 6:
    /// where the arm must first go away from a target to reach it, a larger cost makes stopping short pay. Depth behind the face of a button counts
    /// three times: the way there goes round it.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub distance_cost: f64,

    /// Where distances count for less: the cost grows with `s (1 - e^(-d / s))` instead of the distance `d`, where `s` is this in m. Near the
    /// target it is the same, far away no more than `s`. Default 0: the distance itself.
    #[garde(custom(SCALE.rule()))]
    #[schemars(transform = SCALE.schema())]
    pub distance_scale_m: f64,

    /// `true`: the fingertip's distance counts from the sphere's surface and is 0 inside, so that dwelling anywhere in it
    /// costs nothing; for a button it counts from the pressed face. `false`: from the centre. Default true.
    #[garde(skip)]
    pub inside_is_zero: bool,

    /// Whether the distance goes on over the centres of the targets still to come. Default false.
    #[garde(skip)]
    pub remaining_path: bool,

    /// Cost per second as long as the task is not finished. Default 0.6.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub time_cost: f64,

    /// Given once when a target is done, the last one included; of what is tracked, for every second inside. Default 3.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub subtask_bonus: f64,

    /// Given once when the whole task is done. Default 6.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub completion_bonus: f64,

    /// Cost of pressing a button that the current step does not ask for, each time. Default 0; for `user: human` 2, two thirds of what a target brings. It is
    /// counted in any case, and takes the time of `perception.error_pause_s`.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub wrong_press: f64,

    /// Cost of leaving the way of a `steer`, each time. Default 0: it is counted, and that is all.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub exit: f64,

    /// Cost per second of muscle control: times the sum over muscles of the squared control that is asked for, also where fatigue leaves less of
    /// a muscle. Default 0.02; for `user: human` 4.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub effort_cost: f64,

    /// Cost per second of jerky movement: times the sum over independent joints of the squared acceleration in rad/s2.
    /// Default 0; accelerations are large: the published weight is 1.33e-4.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub acceleration_cost: f64,

    /// Cost per second of changing what is asked of muscles: times the sum over muscles of the squared rate of change of the control, in 1/s, before
    /// motor noise. Holding still costs none of it, fast movement most. What effort, acceleration, this and contact cost together counts for less beyond four times the greatest bonus per second. Default 0. After minimum torque change (Uno, Kawato and Suzuki 1989, doi 10.1007/BF00204593).
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub control_change_cost: f64,

    /// Cost per second of touching hard: times the squared force in N between the fingertip and all that it touches. Default 0; for `user: human` 0.12: 25 N,
    /// fifty times what people press glass with, cost as much in 0.04 s as a target brings.
    #[garde(custom(WEIGHT.rule()))]
    #[schemars(transform = WEIGHT.schema())]
    pub contact_cost: f64,

    /// Until costs were per second: per metre and control step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(custom(optional_weight))]
    #[schemars(skip)]
    pub distance: Option<f64>,

    /// Until costs were per second: `effort_cost` per control step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(custom(optional_weight))]
    #[schemars(skip)]
    pub neural_effort: Option<f64>,

    /// Until costs were per second: `acceleration_cost` per control step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[garde(custom(optional_weight))]
    #[schemars(skip)]
    pub acceleration_effort: Option<f64>,
}

/// Which parts the observation has, in this order; at least one. All of them by default, accelerations aside.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[expect(clippy::struct_excessive_bools, reason = "each part is its own switch in the file")]
pub struct Observation {
    /// Angles of the independent joints, their range mapped to -1 to 1. Default true.
    pub joint_position: bool,
    /// Velocities of the independent joints, in rad/s. Default true.
    pub joint_velocity: bool,
    /// Accelerations of the independent joints, in 100 rad/s2. Default false: they are noisy and velocities say enough.
    pub joint_acceleration: bool,
    /// Position of the fingertip, in m from the shoulder centre. Default true.
    pub fingertip_position: bool,
    /// Position of the pointer, in m from the shoulder centre, where the technique is not the fingertip itself. Default true.
    pub pointer_position: bool,
    /// Activation of each muscle, 0 to 1 mapped to -1 to 1. Default true.
    pub activation: bool,
    /// What of each muscle is fatigued, a share, in tasks with fatigue. Default true.
    pub fatigue: bool,
    /// Control that each muscle was last asked for, without motor noise, 0 to 1 mapped to -1 to 1, in tasks where changing it costs something. Default true.
    pub control: bool,
    /// Centre of the current target, in m from the shoulder centre. Default true.
    pub target_position: bool,
    /// Radius of the current sphere or knob, or half the width of the current button or way, in m. Default true.
    pub target_size: bool,
    /// From the fingertip, or the pointer, to the centre of the current target, in m. Default true.
    pub target_vector: bool,
    /// The same way as a share of its length and the radius together: nearly a unit vector far away, half as long at the edge of a sphere, 0 in its
    /// middle, so that small targets are hit as easily by who has learnt large ones. Default true.
    pub target_direction: bool,
    /// Where the face of the current button or slider looks, a unit vector; 0 for spheres, and before it lights up. Default false.
    pub target_normal: bool,
    /// Whether the current target is to be pressed or dragged, 1, or to be pointed at, 0. Default false.
    pub target_kind: bool,
    /// Velocity of the current target, in m/s, in tasks where something moves. Default true.
    pub target_velocity: bool,
    /// From the centre of the current target to that of the next, in m; 0 at the last target. Default true.
    pub next_target_vector: bool,
    /// How many targets are done, as a share of all. Default true.
    pub phase: bool,
    /// How much of the current dwell has passed, as a share. Default true.
    pub dwell_fraction: bool,
    /// Time left until the limit, as a share. Default true.
    pub time_left: bool,
    /// Whether the fingertip is inside the current sphere: 1 or 0. Default true.
    pub inside: bool,
    /// Force on the fingertip, whatever it touches, as a share of what the current button needs, at most 1. Default true.
    pub touch: bool,
    /// Whether the current target may be gone for: 0 before it lights up or the wait is over, else 1; in tasks with waits. Default true.
    pub cue: bool,
    /// Share of the pause after a wrong press that is left, in tasks and of users where there is one (`perception.error_pause_s`). Default true.
    pub pause: bool,
    /// Whether the handle of the current slider, or the knob of the current stick, is held, 1 or 0, and the way it must go, in m; in tasks with
    /// sliders or sticks. Default true.
    pub drag: bool,
    /// From the current vehicle to where it must stop, in m, and its speed, in m/s; in tasks in which something is driven. Default true.
    pub drive: bool,
    /// From the fingertip, or the pointer, to the farthest place of the current way that was come to, in m, and whether it is within the
    /// way: 1 or 0; in tasks with ways. Default true.
    pub steer: bool,
    /// Whether the fingertip holds its button of several that are to be pressed at once: 1 or 0. From every other finger that the task asks for to where it must be, in m, how large that is, in m, whether the current step asks for it, and whether
    /// it is ready: holds the button that it is to press with others, or is open for a pinch; 1 or 0, in tasks that ask for other fingers. Default true.
    pub fingers: bool,
    /// From the fingertip to the nearest place of the surface of any box but the current target, in m, shortened to 1 where it is farther, and
    /// 1 downwards where there is none; in tasks with boxes. Default false.
    pub nearest_obstacle: bool,
    /// What the user is like, of what users of one body differ in: signal-dependent motor noise in tenths, `perception.vision_noise` in fifths, `reward.effort_cost`
    /// in fours and `reward.control_change_cost` in tens. For one who learns to be anybody, in layouts that differ in these. Default false.
    pub traits: bool,
}

impl Task {
    /// A task of this name with an empty scene and an empty script, all else as it is where a file says nothing: what a task
    /// begins with that is judged by code. As it is, without a script, [`flat`](Self::flat) refuses it.
    pub fn without_script(name: &str) -> Self {
        let mut task = Self {
            version: FORMAT_VERSION,
            name: name.to_owned(),
            description: String::new(),
            model: default_model(),
            user: User::default(),
            body: Body::default(),
            scene: Scene::default(),
            script: vec![],
            technique: Technique::default(),
            stimulus: Stimulus::default(),
            correction: None,
            targets: vec![],
            time_limit_s: default_time_limit(),
            step_limit_s: None,
            control_dt_s: default_control_step(),
            control: Control::default(),
            reset: Reset::default(),
            reward: Reward::default(),
            observation: Observation::default(),
            perception: Perception::default(),
            noise: Noise::default(),
            reflex: Reflex::default(),
            fatigue: Fatigue::default(),
        };
        task.fill_in(|_| false);
        task
    }

    /// The same with costs as files have them now; see [`Reward::per_second`].
    #[must_use]
    pub fn with_costs_per_second(self) -> Self {
        Self { reward: self.reward.per_second(self.control_dt_s), ..self }
    }

    /// Control steps until the time limit.
    pub fn time_limit_steps(&self) -> u32 {
        self.steps(self.time_limit_s)
    }

    /// Control steps until a step of the script is given up; none where it may take as long as the episode.
    pub fn step_limit_steps(&self) -> Option<u32> {
        self.step_limit_s.map(|seconds| self.steps(seconds))
    }

    /// Refuses values out of bounds. Tasks read from a text have been checked; those made or changed by code have not.
    ///
    /// # Errors
    /// All such values.
    pub fn check_values(&self) -> Result<(), InvalidTask> {
        let errors = value_errors(self);
        if errors.is_empty() { Ok(()) } else { Err(InvalidTask { errors }) }
    }

    /// Refuses a control step that is not a whole number of physics steps of `physics_dt_s` seconds.
    ///
    /// # Errors
    /// [`TaskError::UnevenControlStep`], with the nearest control steps that fit.
    pub fn check_control_step(&self, physics_dt_s: f64) -> Result<(), TaskError> {
        let ratio = self.control_dt_s / physics_dt_s;
        if ratio > 0.5 && (ratio - ratio.round()).abs() <= 1e-6 {
            return Ok(());
        }
        // Printed without what binary fractions leave at the end.
        let whole = |steps: f64| (steps * physics_dt_s * 1e9).round() / 1e9;
        let nearest = [ratio.floor(), ratio.ceil().max(1.0)].map(whole);
        Err(TaskError::UnevenControlStep { control_dt_s: self.control_dt_s, physics_dt_s, nearest })
    }

    /// Physics steps of `physics_dt_s` seconds in one control step.
    pub fn substeps(&self, physics_dt_s: f64) -> u32 {
        rounded_steps(self.control_dt_s, physics_dt_s)
    }

    fn steps(&self, duration_s: f64) -> u32 {
        rounded_steps(duration_s, self.control_dt_s)
    }

    /// The same task with every repeated target written out, so that each `repeat` is 1.
    pub fn expanded(mut self) -> Self {
        self.targets = self.targets.into_iter().flat_map(copies).collect();
        self
    }

    /// The same task with equal spheres in a row written as one that repeats: the opposite of [`Task::expanded`].
    pub fn collapsed(mut self) -> Self {
        self.targets.dedup_by(|next, kept| match (next, kept) {
            (Target::Pointing(next), Target::Pointing(kept)) => {
                let n = kept.repeat.saturating_add(next.repeat);
                let same = *next == Pointing { repeat: next.repeat, ..kept.clone() };
                if same {
                    kept.repeat = n;
                }
                same
            }
            _ => false,
        });
        self
    }
}

/// Whole steps of `step_s` nearest to `duration_s`, at least one.
///
/// Rounded, not cut: 0.30 s at 20 Hz is 5.999... steps in binary fractions and must be 6.
pub fn rounded_steps(duration_s: f64, step_s: f64) -> u32 {
    (duration_s / step_s).round().max(1.0) as u32
}

fn copies(target: Target) -> impl Iterator<Item = Target> {
    let n = target.repeat() as usize;
    let mut single = target;
    if let Target::Pointing(sphere) = &mut single {
        sphere.repeat = 1;
    }
    std::iter::repeat_n(single, n)
}

impl Stimulus {
    #[expect(clippy::trivially_copy_pass_by_ref, reason = "the signature serde asks for")]
    fn is_all(&self) -> bool {
        *self == Self::All
    }
}

impl Observation {
    /// Name of every part and whether it is wanted, in order.
    pub fn parts(&self) -> [(&'static str, bool); 29] {
        [
            ("joint_position", self.joint_position),
            ("joint_velocity", self.joint_velocity),
            ("joint_acceleration", self.joint_acceleration),
            ("fingertip_position", self.fingertip_position),
            ("pointer_position", self.pointer_position),
            ("activation", self.activation),
            ("fatigue", self.fatigue),
            ("control", self.control),
            ("target_position", self.target_position),
            ("target_size", self.target_size),
            ("target_vector", self.target_vector),
            ("target_direction", self.target_direction),
            ("target_normal", self.target_normal),
            ("target_kind", self.target_kind),
            ("target_velocity", self.target_velocity),
            ("next_target_vector", self.next_target_vector),
            ("phase", self.phase),
            ("dwell_fraction", self.dwell_fraction),
            ("time_left", self.time_left),
            ("inside", self.inside),
            ("touch", self.touch),
            ("cue", self.cue),
            ("pause", self.pause),
            ("drag", self.drag),
            ("drive", self.drive),
            ("steer", self.steer),
            ("fingers", self.fingers),
            ("nearest_obstacle", self.nearest_obstacle),
            ("traits", self.traits),
        ]
    }
}

impl Noise {
    /// Level of signal-dependent noise in the literature (van Beers et al. 2004).
    pub const LITERATURE_SIGNAL_DEPENDENT: f64 = 0.103;
    /// Level of constant noise in the literature (van Beers et al. 2004).
    pub const LITERATURE_CONSTANT: f64 = 0.185;
}

fn step_limit_rule(limit: &Option<f64>, context: &()) -> garde::Result {
    limit.map_or(Ok(()), |limit| STEP_LIMIT.rule()(&limit, context))
}

fn optional_weight(weight: &Option<f64>, context: &()) -> garde::Result {
    weight.map_or(Ok(()), |weight| WEIGHT.rule()(&weight, context))
}

impl Reward {
    /// With all costs per second; those of old files were per control step of `control_dt_s` seconds.
    #[must_use]
    pub fn per_second(&self, control_dt_s: f64) -> Self {
        // To twelve digits: 0.3 / 0.05 is meant to be 6.
        let digits = |x: f64| format!("{x:.11e}").parse().unwrap_or(x);
        let rate = |old: Option<f64>, new: f64| old.map_or(new, |per_step| digits(per_step / control_dt_s));
        Self {
            distance_cost: rate(self.distance, self.distance_cost),
            effort_cost: rate(self.neural_effort, self.effort_cost),
            acceleration_cost: rate(self.acceleration_effort, self.acceleration_cost),
            distance: None,
            neural_effort: None,
            acceleration_effort: None,
            ..self.clone()
        }
    }
}

impl Default for Reset {
    fn default() -> Self {
        Self { pose: Pose::RangeUniform, pose_spread_rad: 0.05, velocity_spread_rad_s: 0.05, activation_max: 1.0 }
    }
}

impl Default for Reward {
    fn default() -> Self {
        Self {
            distance_cost: 6.0,
            distance_scale_m: 0.0,
            inside_is_zero: true,
            remaining_path: false,
            time_cost: 0.6,
            subtask_bonus: 3.0,
            completion_bonus: 6.0,
            wrong_press: 0.0,
            exit: 0.0,
            effort_cost: 0.02,
            acceleration_cost: 0.0,
            control_change_cost: 0.0,
            contact_cost: 0.0,
            distance: None,
            neural_effort: None,
            acceleration_effort: None,
        }
    }
}

impl Default for Observation {
    fn default() -> Self {
        Self {
            joint_position: true,
            joint_velocity: true,
            joint_acceleration: false,
            fingertip_position: true,
            pointer_position: true,
            activation: true,
            fatigue: true,
            control: true,
            target_position: true,
            target_size: true,
            target_vector: true,
            target_direction: true,
            target_normal: false,
            target_kind: false,
            target_velocity: true,
            next_target_vector: true,
            phase: true,
            dwell_fraction: true,
            time_left: true,
            inside: true,
            touch: true,
            cue: true,
            pause: true,
            drag: true,
            drive: true,
            steer: true,
            fingers: true,
            nearest_obstacle: false,
            traits: false,
        }
    }
}

fn default_model() -> String {
    "myo-arm".into()
}

fn default_time_limit() -> f64 {
    12.0
}

pub(crate) fn default_control_step() -> f64 {
    0.05
}
