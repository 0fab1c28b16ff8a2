//! Who does a task: what a simulated user is like where the task does not say.

use std::collections::BTreeMap;

use garde::Validate;
use myo_model::Sex;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::body::{Body, Hand};
use crate::description::{HELD, Pose, Reset, Reward, SHARE, Task, default_control_step};
use crate::motor::{Fatigue, Noise};
use crate::quantity::Quantity;

const DELAY: Quantity = Quantity::between(0.0, 1000.0, "ms");
/// Reactions are this much later at 75 than at 30: 0.55 ms a year (Woods et al. 2015, doi 10.3389/fnhum.2015.00131).
const LATER_AT_75_MS: f64 = 25.0;

const PAUSE: Quantity = Quantity::between(0.0, 10.0, "s");

/// What the simulated user is like where the task says nothing else: how often it decides, what it perceives how late, its motor noise,
/// and what speed and effort are worth to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum User {
    /// Is to move as people do: with motor noise, with eyes that are late, and with regard to its effort. In shape and speed its movements are
    /// like people's; how far it is like them is told in `docs/people.md`.
    #[default]
    Human,
    /// As fast as its muscles allow: no noise, no delay, effort that costs next to nothing. For comparisons of learners, and of tasks whose
    /// speed is all that counts.
    Fastest,
    /// `human` as the median woman: 1.626 m, 66.8 kg (soldiers of ANSUR II, 2012), with half the strength of the median man.
    Woman,
    /// `human` as the median man: 1.755 m, 84.6 kg (ANSUR II).
    Man,
    /// `human` as a small woman: 1.525 m and 51.3 kg, each less than 95 of 100 women have (ANSUR II).
    SmallWoman,
    /// `human` as a large man: 1.87 m and 110.7 kg, each more than 95 of 100 men have (ANSUR II).
    LargeMan,
    /// `human` as the median woman at 75: 0.7 times as strong, and seeing 25 ms later (0.55 ms a year, Woods et al. 2015, doi 10.3389/fnhum.2015.00131), which is a whole decision of 40 ms later.
    OlderWoman,
    /// `human` as the median man at 75, in the same way.
    OlderMan,
    /// `human` with muscles half as strong: loss of muscle, as MyoSuite simulates it.
    Sarcopenia,
    /// `human` with torn tendons of supraspinatus and infraspinatus: the common massive tear of the rotator cuff.
    RotatorCuffTear,
    /// `human` whose wrist extensors are paralysed, after the usual transfer of pronator teres: it pulls where the short radial extensor did.
    TendonTransfer,
    /// `human` with the left hand.
    LeftHanded,
    /// `human` whose muscles tire as people's do, each of which begins an episode anything between rested and half fatigued.
    Tired,
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
    /// another millimetre, and half as much across; along the line at most two standard deviations. It shrinks on the way, so that a movement misses by
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
    body: Body,
    fatigue: Fatigue,
}

impl User {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Human,
        Self::Fastest,
        Self::Woman,
        Self::Man,
        Self::SmallWoman,
        Self::LargeMan,
        Self::OlderWoman,
        Self::OlderMan,
        Self::Sarcopenia,
        Self::RotatorCuffTear,
        Self::TendonTransfer,
        Self::LeftHanded,
        Self::Tired,
    ];

    /// Its name in a task file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Human => "human",
            Self::Fastest => "fastest",
            Self::Woman => "woman",
            Self::Man => "man",
            Self::SmallWoman => "small_woman",
            Self::LargeMan => "large_man",
            Self::OlderWoman => "older_woman",
            Self::OlderMan => "older_man",
            Self::Sarcopenia => "sarcopenia",
            Self::RotatorCuffTear => "rotator_cuff_tear",
            Self::TendonTransfer => "tendon_transfer",
            Self::LeftHanded => "left_handed",
            Self::Tired => "tired",
        }
    }

    /// What it is like, as the schema of tasks says.
    pub fn about(self) -> String {
        let schema = schemars::schema_for!(Self).to_value();
        let kinds = schema["oneOf"].as_array().cloned().unwrap_or_default();
        let own = kinds.iter().find(|kind| kind["const"] == self.name());
        let text = own.and_then(|kind| kind["description"].as_str()).unwrap_or_default();
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Whether it is to move as people do.
    pub const fn is_human(self) -> bool {
        !matches!(self, Self::Fastest)
    }

    fn traits(self) -> Traits {
        let fastest = Traits {
            control_dt_s: default_control_step(),
            reward: Reward::default(),
            noise: Noise::default(),
            perception: Perception::default(),
            reset: Reset::default(),
            body: Body::default(),
            fatigue: Fatigue::default(),
        };
        if self == Self::Fastest {
            return fastest;
        }
        let human = human(fastest);
        match self {
            Self::OlderWoman | Self::OlderMan => {
                let vision_delay_ms = human.perception.vision_delay_ms + LATER_AT_75_MS;
                let perception = Perception { vision_delay_ms, ..human.perception };
                Traits { body: self.body(), perception, ..human }
            }
            Self::Tired => Traits { fatigue: Fatigue { speed: 1.0, lasts: false, initial_max: 0.5 }, ..human },
            _ => Traits { body: self.body(), ..human },
        }
    }

    fn body(self) -> Body {
        let person = |sex, height_m, mass_kg| Body {
            sex: Some(sex),
            height_m: Some(height_m),
            mass_kg: Some(mass_kg),
            ..Body::default()
        };
        // Medians and the outer twentieths of 1,986 women and 4,082 men of ANSUR II, computed from its public file.
        let [woman, man] = [person(Sex::Female, 1.626, 66.8), person(Sex::Male, 1.755, 84.6)];
        let torn = |muscles: &[&str]| muscles.iter().map(|name| ((*name).to_owned(), 0.0)).collect();
        match self {
            Self::Woman => woman,
            Self::Man => man,
            Self::SmallWoman => person(Sex::Female, 1.525, 51.3),
            Self::LargeMan => person(Sex::Male, 1.87, 110.7),
            Self::OlderWoman => Body { age_years: Some(75.0), ..woman },
            Self::OlderMan => Body { age_years: Some(75.0), ..man },
            Self::Sarcopenia => Body { strength: 0.5, ..Body::default() },
            Self::RotatorCuffTear => Body { muscles: torn(&["SUPSP", "INFSP"]), ..Body::default() },
            Self::TendonTransfer => Body {
                muscles: torn(&["ECRL", "ECU"]),
                transfers: [("PT".to_owned(), "ECRB".to_owned())].into(),
                ..Body::default()
            },
            Self::LeftHanded => Body { hand: Hand::Left, ..Body::default() },
            Self::Human | Self::Fastest | Self::Tired => Body::default(),
        }
    }
}

/// What was found by searches, whose tables are in `docs/search.md` and `docs/training.md`: distances that count near by and half a metre away; 25
/// decisions a second, for who decides more often learns small targets late; time cheap, effort dear enough for a resting arm, and changes of controls
/// dear enough for movements of people's shape and speed; slow noise with which the torque of a joint of three to six muscles varies by 1.9 to 2.7 % (people:
/// 1 to 4 %); two decisions until something seen is known; targets that seem off by so much of their distance that first movements end beside them, more
/// along the way than across it; and a start from the hanging arm at rest, for nobody begins with joints and muscles as it happens. What touching hard
/// costs has had no search: 25 N, fifty times what people press glass with, cost in a decision what a target brings. An error takes half a second and
/// costs two thirds of what a target brings: to take back and press again are two presses more.
fn human(usual: Traits) -> Traits {
    Traits {
        control_dt_s: 0.04,
        reward: Reward {
            distance_cost: 4.0,
            distance_scale_m: 0.5,
            time_cost: 0.0,
            effort_cost: 4.0,
            control_change_cost: 11.0,
            contact_cost: 0.12,
            wrong_press: 2.0,
            ..usual.reward
        },
        noise: Noise { signal_dependent: 0.05, constant: 0.0008, held_s: 0.4 },
        perception: Perception { vision_delay_ms: 80.0, vision_noise: 0.2, error_pause_s: 0.5, ..usual.perception },
        reset: Reset { pose: Pose::NearZero, activation_max: 0.0, ..usual.reset },
        body: usual.body,
        fatigue: usual.fatigue,
    }
}

impl Task {
    /// Who does it, for people: the user by its name, and what its body is like where it is not as the model has it, such as
    /// `small_woman (a woman, 1.53 m tall)`.
    pub fn who(&self) -> String {
        match self.body.words() {
            words if words.is_empty() => self.user.name().into(),
            words => format!("{} ({words})", self.user.name()),
        }
    }

    /// The same done by another user, who brings along everything that users differ in.
    #[must_use]
    pub fn done_by(mut self, user: User) -> Self {
        self.user = user;
        self.fill_in(|_| false);
        self
    }

    /// Gives a task what its user brings along, wherever `is_given` does not know the path of a value: what a text leaves out.
    pub(crate) fn fill_in(&mut self, is_given: impl Fn(&str) -> bool) {
        let Traits { control_dt_s, reward, noise, perception, reset, body, fatigue } = self.user.traits();
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
        let own = &mut self.fatigue;
        fill(&mut own.speed, fatigue.speed, &["fatigue.speed"]);
        fill(&mut own.initial_max, fatigue.initial_max, &["fatigue.initial_max"]);
        if !is_given("fatigue.lasts") {
            own.lasts = fatigue.lasts;
        }
        self.fill_in_body(body, is_given);
    }

    fn fill_in_body(&mut self, usual: Body, is_given: impl Fn(&str) -> bool) {
        macro_rules! fill {
            ($($field:ident),*) => {$(
                if !is_given(concat!("body.", stringify!($field))) {
                    self.body.$field = usual.$field;
                }
            )*};
        }
        fill!(sex, height_m, mass_kg, age_years, hand, strength);
        // By name, so that a text that speaks of one muscle heals no other; an empty map takes all back.
        fill_map(&mut self.body.muscles, usual.muscles, "body.muscles", &is_given);
        fill_map(&mut self.body.transfers, usual.transfers, "body.transfers", &is_given);
    }
}

fn fill_map<V>(own: &mut BTreeMap<String, V>, usual: BTreeMap<String, V>, path: &str, is_given: impl Fn(&str) -> bool) {
    let is_named = |name: &str| is_given(&format!("{path}.{name}"));
    own.retain(|name, _| is_named(name));
    if is_given(path) && own.is_empty() {
        return;
    }
    own.extend(usual.into_iter().filter(|(name, _)| !is_named(name)));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_user_says_what_it_is_like() {
        assert!(User::ALL.iter().all(|user| user.about().len() > 20));
        let first: String = User::SmallWoman.about().chars().take(13).collect();
        assert_eq!(first, "`human` as a ");
    }

    #[test]
    fn names_are_those_of_files() {
        for user in User::ALL {
            assert_eq!(serde_json::to_value(user).unwrap(), user.name());
        }
    }
}
