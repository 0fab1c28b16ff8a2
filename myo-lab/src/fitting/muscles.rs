//! Muscles of a body that were recorded of a person, too.

use myo_model::{Model, Nearest};

use super::{Aim, FittingError};
use crate::recordings::{Measured, Participant};

/// Muscles that are compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Recorded {
    /// What they are called.
    pub names: Vec<String>,
    /// Their numbers in the body.
    pub numbers: Vec<usize>,
}

impl Recorded {
    /// All of a person's, in their order.
    pub fn of(person: &Participant, model: &Model) -> Result<Self, FittingError> {
        let number = |name: &String| model.muscles.iter().position(|muscle| muscle.name == *name);
        let known = |name: &String| {
            number(name).ok_or_else(|| {
                let all: Vec<&str> = model.muscles.iter().map(|muscle| &*muscle.name).collect();
                FittingError::UnknownMuscle {
                    name: name.clone(),
                    body: model.name.clone(),
                    nearest: Nearest::to(name, &all),
                }
            })
        };
        let numbers = person.muscles.iter().map(known).collect::<Result<_, _>>()?;
        Ok(Self { names: person.muscles.clone(), numbers })
    }
}

impl From<&Measured> for Aim {
    fn from(one: &Measured) -> Self {
        Self::new([one.distance, one.width], &one.aimed, one.activations.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn muscles_are_found_by_name_and_others_are_refused() {
        let model = Model::new(&myo_model::builtin("mobl-arms").unwrap()).unwrap();
        let person = |muscles: &[&str]| Participant {
            name: "Ada".into(),
            muscles: muscles.iter().map(|&name| name.into()).collect(),
            trials: vec![],
        };
        let found = Recorded::of(&person(&["BRA", "DELT1"]), &model).unwrap();
        let names: Vec<&str> = found.numbers.iter().map(|&number| &*model.muscles[number].name).collect();
        assert_eq!(names, ["BRA", "DELT1"]);
        let refused = Recorded::of(&person(&["DELT"]), &model).unwrap_err().to_string();
        assert_eq!(
            refused,
            "`mobl-arms` has no muscle `DELT`; did you mean `DELT1`, `DELT2` or `DELT3`? A column that is not to be compared is passed over where its name begins with `note_`"
        );
    }
}
