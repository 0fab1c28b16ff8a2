//! Who does a task: what a simulated user is like where the task does not say.

use garde::Validate;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::{HELD, Pose, Reset, Reward, SHARE, Task, default_control_step};
use crate::motor::Noise;
use crate::quantity::Quantity;

const DELAY: Quantity = Quantity::between(0.0, 1000.0, "ms");
const PAUSE: Quantity = Quantity::between(0.0, 10.0, "s");

/// What the simulated user is like where the task says nothing else: how often it decides, what it perceives how late, its motor noise,
/// and what speed and effort are worth to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum User {
    /// Is to move as people do: with motor noise, with eyes that are late, and with regard to its effort. In shape and speed its movements are
    /// like people's; how far it is like them is told in `docs/people.md`.
    #[default]
    Human,
    /// As fast as its muscles allow: no noise, no delay, effort that costs next to nothing. For comparisons of learners, and of tasks whose
    /// speed is all that counts.
    Fastest,
}

/// How late the simulated user perceives, in ms, rounded to whole control steps, and how far off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
pub struct Perception {
    /// What is seen: where objects are, what became of them, where a pointer other than the fingertip is. Default 0.
    #[garde(custom(DELAY.rule()))]
    #[schemars(transform = DELAY.schema())]
    pub vision_delay_ms: f64,

    /// What is felt of the own body: joints, fingertip, activations. Default 0.
    #[garde(custom(DELAY.rule()))]
    #[schemars(transform = DELAY.schema())]
    pub body_delay_ms: f64,

    /// The force of a touch. Default 0.
    #[garde(custom(DELAY.rule()))]
    #[schemars(transform = DELAY.schema())]
    pub touch_delay_ms: f64,

    /// How far off a target seems that is away from the pointer: standard deviation along the line between them, as a share of its length and
    /// another 4 mm, and half as much across; along the line at most two standard deviations. It shrinks on the way, so that a movement misses by
    /// far less. Default 0.
    #[garde(custom(SHARE.rule()))]
    #[schemars(transform = SHARE.schema())]
    pub vision_noise: f64,

    /// How long a target seems off in the same way: the time in s after which e-times less of it is left, and something new has taken its place, as of
    /// people who look again several times a second. Default 0.3, as long as eyes rest on a place (Rayner 1998, doi 10.1037/0033-2909.124.3.372).
    #[garde(custom(HELD.rule()))]
    #[schemars(transform = HELD.schema())]
    pub vision_held_s: f64,

    /// How long it takes to go on after a wrong press, in s: presses do not count in that time. Default 0; for `user: human` 0.5, about the time of two
    /// keystrokes of people (0.24 s each, Dhakal et al. 2018, doi 10.1145/3173574.3174220), as to take back and press again.
    #[garde(custom(PAUSE.rule()))]
    #[schemars(transform = PAUSE.schema())]
    pub error_pause_s: f64,
}

impl Default for Perception {
    fn default() -> Self {
        Self {
            vision_delay_ms: 0.0,
            body_delay_ms: 0.0,
            touch_delay_ms: 0.0,
            vision_noise: 0.0,
            vision_held_s: 0.3,
            error_pause_s: 0.0,
        }
    }
}

/// All that users differ in.
struct Traits {
    control_dt_s: f64,
    reward: Reward,
    noise: Noise,
    perception: Perception,
    reset: Reset,
}

impl User {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Human, Self::Fastest];

    /// Its name in a task file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Human => "human",
            Self::Fastest => "fastest",
        }
    }

    fn traits(self) -> Traits {
        let fastest = Traits {
            control_dt_s: default_control_step(),
            reward: Reward::default(),
            noise: Noise::default(),
            perception: Perception::default(),
            reset: Reset::default(),
        };
        match self {
            Self::Fastest => fastest,
            Self::Human => human(fastest.reward),
        }
    }
}

/// What was found by searches, whose tables are in `docs/search.md` and `docs/training.md`: distances that count near by and half a metre away; 25
/// decisions a second, for who decides more often learns small targets late; time cheap, effort dear enough for a resting arm, and changes of controls
/// dear enough for movements of people's shape and speed; slow noise with which the torque of a joint of three to six muscles varies by 1.9 to 2.7 % (people:
/// 1 to 4 %); two decisions until something seen is known; targets that seem off by so much of their distance that first movements end beside them, more
/// along the way than across it; and a start from the hanging arm at rest, for nobody begins with joints and muscles as it happens. What touching hard and
/// errors cost has had no search: 25 N, fifty times what people press glass with, cost in a decision what a target brings, and an error takes half a
/// second and a tenth of that.
fn human(usual: Reward) -> Traits {
    Traits {
        control_dt_s: 0.04,
        reward: Reward {
            distance_cost: 4.0,
            distance_scale_m: 0.5,
            time_cost: 0.0,
            effort_cost: 8.0,
            control_change_cost: 7.0,
            contact_cost: 0.12,
            wrong_press: 0.3,
            ..usual
        },
        noise: Noise { signal_dependent: 0.05, constant: 0.0008, held_s: 0.4 },
        perception: Perception {
            vision_delay_ms: 80.0,
            vision_noise: 0.35,
            error_pause_s: 0.5,
            ..Perception::default()
        },
        reset: Reset { pose: Pose::NearZero, activation_max: 0.0, ..Reset::default() },
    }
}

impl Task {
    /// Gives a task what its user brings along, wherever `is_given` does not know the path of a value: what a text leaves out.
    pub(crate) fn fill_in(&mut self, is_given: impl Fn(&str) -> bool) {
        let Traits { control_dt_s, reward, noise, perception, reset } = self.user.traits();
        let fill = |value: &mut f64, usual: f64, paths: &[&str]| {
            if !paths.iter().any(|path| is_given(path)) {
                *value = usual;
            }
        };
        fill(&mut self.control_dt_s, control_dt_s, &["control_dt_s"]);
        let own = &mut self.reward;
        fill(&mut own.distance_cost, reward.distance_cost, &["reward.distance_cost", "reward.distance"]);
        fill(&mut own.distance_scale_m, reward.distance_scale_m, &["reward.distance_scale_m"]);
        fill(&mut own.time_cost, reward.time_cost, &["reward.time_cost"]);
        fill(&mut own.effort_cost, reward.effort_cost, &["reward.effort_cost", "reward.neural_effort"]);
        let acceleration = ["reward.acceleration_cost", "reward.acceleration_effort"];
        fill(&mut own.acceleration_cost, reward.acceleration_cost, &acceleration);
        fill(&mut own.control_change_cost, reward.control_change_cost, &["reward.control_change_cost"]);
        fill(&mut own.contact_cost, reward.contact_cost, &["reward.contact_cost"]);
        fill(&mut own.wrong_press, reward.wrong_press, &["reward.wrong_press"]);
        fill(&mut self.noise.signal_dependent, noise.signal_dependent, &["noise.signal_dependent"]);
        fill(&mut self.noise.constant, noise.constant, &["noise.constant"]);
        fill(&mut self.noise.held_s, noise.held_s, &["noise.held_s"]);
        if !is_given("reset.pose") {
            self.reset.pose = reset.pose;
        }
        fill(&mut self.reset.activation_max, reset.activation_max, &["reset.activation_max"]);
        let own = &mut self.perception;
        fill(&mut own.vision_delay_ms, perception.vision_delay_ms, &["perception.vision_delay_ms"]);
        fill(&mut own.vision_noise, perception.vision_noise, &["perception.vision_noise"]);
        fill(&mut own.vision_held_s, perception.vision_held_s, &["perception.vision_held_s"]);
        fill(&mut own.error_pause_s, perception.error_pause_s, &["perception.error_pause_s"]);
        fill(&mut own.body_delay_ms, perception.body_delay_ms, &["perception.body_delay_ms"]);
        fill(&mut own.touch_delay_ms, perception.touch_delay_ms, &["perception.touch_delay_ms"]);
    }
}
