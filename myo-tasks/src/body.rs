//! Whose body it is that does a task: how large, how strong, which hand.

use std::collections::BTreeMap;

use garde::Validate;
use myo_model::{Model, ModelDescription, ModelError, Sex, Size};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::description::Task;
use crate::quantity::Quantity;

const HEIGHT: Quantity = Quantity::between(1.2, 2.2, "m");
const MASS: Quantity = Quantity::between(25.0, 200.0, "kg");
const AGE: Quantity = Quantity::between(18.0, 80.0, "years");
const STRENGTH: Quantity = Quantity::between(0.01, 3.0, "");
const OF_MUSCLE: Quantity = Quantity::between(0.0, 3.0, "");

/// Masses (kg) per square of a stature (m2) that people have.
const STOUTNESS: Quantity = Quantity::between(12.0, 60.0, "kg/m2");

/// Age (years) from which on people lose strength, and what is left of it after each ten years.
const STRONGEST_UNTIL: f64 = 50.0;
const LEFT_PER_DECADE: f64 = 0.865;

/// What the body of the simulated user is like, where it is not as the model has it. Targets stay where they are relative to the shoulder of the arm that
/// does the task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema, Validate)]
#[serde(deny_unknown_fields, default)]
#[garde(allow_unvalidated)]
pub struct Body {
    /// Whose proportions and strength: `female` or `male`. Default: as the model; `myo-arm` is a man's. Lengths and masses of segments as shares of stature and body
    /// mass after de Leva 1996, doi 10.1016/0021-9290(95)00178-6; a kilogram of a woman is 0.63 times as strong as a man's, so that the median woman is half as strong as
    /// the median man, as measured at the shoulder (doi 10.1016/0268-0033(89)90046-6).
    pub sex: Option<Sex>,

    /// Stature, in m. Default: as the model, 1.735 for `myo-arm`. Bones, paths of muscles and bones that they bend over all grow with it.
    #[garde(custom(given(HEIGHT)))]
    #[schemars(transform = HEIGHT.schema())]
    pub height_m: Option<f64>,

    /// Body mass, in kg. Default: as stout as the model (25.4 kg per square metre of stature for `myo-arm`). The torque of muscles grows with it (Jaric 2002, doi
    /// 10.2165/00007256-200232100-00002).
    #[garde(custom(given(MASS)))]
    #[schemars(transform = MASS.schema())]
    pub mass_kg: Option<f64>,

    /// Age, in years: from 50 on strength falls by 13.5 % in ten years (Hurley 1995, doi 10.1093/gerona/50a.special_issue.41: 12 to 15 %). Default: young. It changes nothing
    /// else; that older people are slower to see and to decide is for `perception` to say.
    #[garde(custom(given(AGE)))]
    #[schemars(transform = AGE.schema())]
    pub age_years: Option<f64>,

    /// The hand that does it. `left` mirrors the body: places are then relative to the centre of the left shoulder. Default `right`.
    pub hand: Hand,

    /// How many times as strong as people of this size all muscles are: their active force. Default 1; 0.5 is what simulations of sarcopenia take (MyoSuite).
    #[garde(custom(STRENGTH.rule()))]
    #[schemars(transform = STRENGTH.schema())]
    pub strength: f64,

    /// The same for single muscles, such as `SUPSP: 0` for a torn tendon, and for groups of them: `shoulder`, `elbow`, `hand`. Those of a named user stay where the task does not name them; `{}` takes all back. Default: none.
    #[garde(custom(each_muscle))]
    #[schemars(transform = OF_MUSCLE.schema())]
    pub muscles: BTreeMap<String, f64>,

    /// Tendon transfers: `PT: ECRB` makes the first muscle pull where the second did, which pulls no more. Default: none.
    pub transfers: BTreeMap<String, String>,
}

/// The hand that does a task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Hand {
    /// The right hand.
    #[default]
    Right,
    /// The left hand.
    Left,
}

impl Default for Body {
    fn default() -> Self {
        Self {
            sex: None,
            height_m: None,
            mass_kg: None,
            age_years: None,
            hand: Hand::Right,
            strength: 1.0,
            muscles: BTreeMap::new(),
            transfers: BTreeMap::new(),
        }
    }
}

impl Body {
    /// Whether it is the body of the model.
    pub fn is_the_models(&self) -> bool {
        *self == Self::default()
    }

    /// In what it differs from the body of a model, such as `a woman 1.63 m tall, left hand`; empty where it does not.
    pub fn words(&self) -> String {
        let sex = match self.sex {
            Some(Sex::Female) => Some("a woman".to_owned()),
            Some(Sex::Male) => Some("a man".to_owned()),
            None => None,
        };
        let number = |value: Option<f64>, words: &str| value.map(|value| format!("{value} {words}"));
        let strength = (self.strength != 1.0).then(|| format!("{} times as strong", self.strength));
        let each = self.muscles.iter().map(|(name, share)| Some(format!("{name} {share} times as strong")));
        let moved = self.transfers.iter().map(|(donor, recipient)| Some(format!("{donor} in place of {recipient}")));
        let parts = [
            sex,
            number(self.height_m, "m tall"),
            number(self.mass_kg, "kg"),
            number(self.age_years, "years old"),
            (self.hand == Hand::Left).then(|| "left hand".to_owned()),
            strength,
        ];
        parts.into_iter().chain(each).chain(moved).flatten().collect::<Vec<_>>().join(", ")
    }

    /// The model as the body of this person.
    ///
    /// # Errors
    /// The model cannot be simulated, or cannot become that body: it has no such muscle, or does not tell whose body it is.
    pub fn of(&self, model: &ModelDescription) -> Result<Model, ModelError> {
        if self.is_the_models() {
            return Model::new(model);
        }
        let Self { sex, height_m, mass_kg, .. } = *self;
        let mut person = model
            .clone()
            .sized(&Size { sex, height_m, mass_kg })?
            .with_strength(self.strength * self.left_at_age(), &self.muscles)?
            .with_transfers(&self.transfers)?;
        if self.hand == Hand::Left {
            person = person.mirrored();
        }
        person.changes = self.words();
        Model::new(&person)
    }

    /// What is left of strength at this age.
    fn left_at_age(&self) -> f64 {
        let decades = (self.age_years.unwrap_or(STRONGEST_UNTIL) - STRONGEST_UNTIL).max(0.0) / 10.0;
        LEFT_PER_DECADE.powf(decades)
    }
}

impl Task {
    /// The body that does it: the model that it names, given its description, as the body of its user.
    ///
    /// # Errors
    /// As for [`Body::of`].
    pub fn embody(&self, model: &ModelDescription) -> Result<Model, ModelError> {
        self.body.of(model)
    }
}

fn given(quantity: Quantity) -> impl Fn(&Option<f64>, &()) -> garde::Result {
    move |value, ()| value.map_or(Ok(()), |value| quantity.check(value))
}

fn each_muscle(muscles: &BTreeMap<String, f64>, (): &()) -> garde::Result {
    muscles.iter().try_for_each(|(name, &share)| {
        OF_MUSCLE.check(share).map_err(|error| garde::Error::new(format!("has `{name}`, which {}", error.message())))
    })
}

/// The rule of a whole body: stature and mass of one person.
pub(crate) fn body_rule(body: &Body, (): &()) -> garde::Result {
    let (Some(height_m), Some(mass_kg)) = (body.height_m, body.mass_kg) else { return Ok(()) };
    STOUTNESS.check(mass_kg / height_m.powi(2)).map_err(|_| {
        let [least, most] = [STOUTNESS.least(), STOUTNESS.most()].map(|stout| stout * height_m.powi(2));
        garde::Error::new(format!(
            "has {mass_kg} kg at {height_m} m; people of that stature have from {least:.0} to {most:.0} kg"
        ))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_is_told_by_what_it_differs_in() {
        assert_eq!(Body::default().words(), "");
        let one = Body {
            sex: Some(Sex::Female),
            height_m: Some(1.525),
            hand: Hand::Left,
            muscles: [("SUPSP".to_owned(), 0.0)].into(),
            transfers: [("PT".to_owned(), "ECRB".to_owned())].into(),
            ..Body::default()
        };
        assert_eq!(one.words(), "a woman, 1.525 m tall, left hand, SUPSP 0 times as strong, PT in place of ECRB");
    }

    #[test]
    fn strength_is_lost_from_fifty_on() {
        let at = |age_years| Body { age_years, ..Body::default() }.left_at_age();
        assert_eq!([at(None), at(Some(30.0)), at(Some(50.0)), at(Some(60.0))], [1.0, 1.0, 1.0, 0.865]);
        assert!((at(Some(80.0)) - 0.865_f64.powi(3)).abs() < 1e-12);
    }
}
