//! Protocol A1: whether small and large people reach as far, weigh as much and are as strong as people of their size.
//!
//! A model becomes the body of four named users, from a woman smaller than 95 of 100 to a man larger than 95 of 100; no user is trained.

use myo_dynamics::PlanError;
use myo_model::{Model, ModelDescription, ModelError, Sex};
use myo_tasks::{Body, Reach, Task, User};
use serde::Serialize;
use thiserror::Error;

use super::strength::{Strength, StrengthError};
use crate::ModelReach;

/// Who is asked, the one that the others are compared with last but one.
const WHO: [User; 4] = [User::SmallWoman, User::Woman, User::Man, User::LargeMan];
const COMPARED_WITH: usize = 2;
/// Straight ahead, farther than anybody reaches (m).
const AHEAD: [f64; 3] = [5.0, 0.0, 0.0];
/// Centre of the shoulder to the tip of the index finger as a share of stature, women and men, were all bones in line: upper arm and forearm after de Leva 1996, and the
/// hand after Winter 2009 (0.108, to the tip of the middle finger) less a centimetre.
const REACH_SHARE: [f64; 2] = [0.4129, 0.4183];
/// Mass of an arm as a share of body mass, women and men: de Leva 1996, doi 10.1016/0021-9290(95)00178-6.
const ARM_SHARE: [f64; 2] = [0.0449, 0.0494];
/// Strength of the median woman as a share of the median man's: of the shoulder (doi 10.1016/0268-0033(89)90046-6, and 25 women and 26 men in dynamic
/// flexion), and from and to of the elbow (handbooks).
const WOMAN_OF_MAN: [(&str, [f64; 2]); 2] = [("shoulder", [0.5, 0.5]), ("elbow", [0.5, 0.6])];

/// What protocol A1 found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sizes {
    /// Name of the model.
    pub model: String,
    /// Person by person, from small to large.
    pub rows: Vec<SizeRow>,
    /// Strength of the median woman as a share of the median man's, joint by joint.
    pub woman_of_man: Vec<WomanOfMan>,
}

/// The body of one person.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SizeRow {
    /// Who it is: a named user.
    pub user: &'static str,
    /// Stature (m).
    pub height_m: f64,
    /// Body mass (kg).
    pub mass_kg: f64,
    /// How far ahead of the centre of the shoulder the fingertip reaches (m).
    pub reach_m: f64,
    /// The same as a share of stature.
    pub reach_of_height: f64,
    /// That share of people, were all bones in line.
    pub people_reach_of_height: f64,
    /// Mass of the arm below the shoulder (kg).
    pub arm_kg: f64,
    /// The same as a share of body mass.
    pub arm_of_mass: f64,
    /// That share of people.
    pub people_arm_of_mass: f64,
    /// Isometric strength at shoulder and elbow, as shares of the median man's: means over the directions and angles of protocol M1.
    pub strength_of_man: [f64; 2],
    /// Share of strength that holds the straight arm ahead at the height of the shoulder.
    pub holding_share: f64,
}

/// Strength of the median woman beside the median man's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WomanOfMan {
    /// `shoulder` or `elbow`.
    pub joint: &'static str,
    /// Of these bodies.
    pub share: f64,
    /// Of people, from and to.
    pub people: [f64; 2],
}

/// Why protocol A1 cannot be done.
#[derive(Debug, Error)]
pub enum SizesError {
    /// The model cannot become somebody else's body.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A body cannot be asked for its strength.
    #[error(transparent)]
    Strength(#[from] StrengthError),
    /// A body cannot be simulated.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

/// A person's body and what it can.
struct Person {
    user: User,
    body: Body,
    model: Model,
    strength: Strength,
}

impl Sizes {
    /// Asks a model.
    ///
    /// # Errors
    /// It does not tell whose body it is, cannot be simulated, or lacks what protocol M1 names.
    pub fn of(model: &ModelDescription) -> Result<Self, SizesError> {
        let people = WHO.map(|user| Person::new(user, model)).into_iter().collect::<Result<Vec<_>, _>>()?;
        let man = &people[COMPARED_WITH];
        let rows: Vec<SizeRow> = people.iter().map(|person| person.row(man)).collect::<Result<_, _>>()?;
        let woman = rows[COMPARED_WITH - 1].strength_of_man;
        let share = |((joint, people), share)| WomanOfMan { joint, share, people };
        Ok(Self {
            model: model.name.clone(),
            rows,
            woman_of_man: WOMAN_OF_MAN.into_iter().zip(woman).map(share).collect(),
        })
    }
}

impl Person {
    fn new(user: User, description: &ModelDescription) -> Result<Self, SizesError> {
        let body = Task::without_script("size").done_by(user).body;
        let model = body.of(description)?;
        Ok(Self { user, strength: Strength::of(&model)?, body, model })
    }

    fn row(&self, man: &Self) -> Result<SizeRow, SizesError> {
        // Named users of this protocol have both.
        let [height_m, mass_kg] = [self.body.height_m, self.body.mass_kg].map(Option::unwrap_or_default);
        let ahead = ModelReach::new(&self.model)?.nearest_in_reach(AHEAD);
        let reach_m = ahead.iter().map(|x| x * x).sum::<f64>().sqrt();
        let arm_kg = arm_mass(&self.model);
        let is_man = usize::from(self.body.sex == Some(Sex::Male));
        let level = |row: &&super::HoldingShare| row.way == "forward" && row.at_deg == 90.0;
        Ok(SizeRow {
            user: self.user.name(),
            height_m,
            mass_kg,
            reach_m,
            reach_of_height: reach_m / height_m,
            people_reach_of_height: REACH_SHARE[is_man],
            arm_kg,
            arm_of_mass: arm_kg / mass_kg,
            people_arm_of_mass: ARM_SHARE[is_man],
            strength_of_man: WOMAN_OF_MAN.map(|(joint, _)| self.strength_of(man, joint)),
            holding_share: self.strength.holding.iter().find(level).map_or(f64::NAN, |row| row.share),
        })
    }

    /// Mean over all that protocol M1 asks of a joint.
    fn strength_of(&self, man: &Self, joint: &str) -> f64 {
        let own = self.strength.strength.iter().zip(&man.strength.strength);
        let shares: Vec<f64> = own
            .filter(|(row, _)| row.what.starts_with(joint))
            .map(|(row, man)| row.torque_n_m / man.torque_n_m)
            .collect();
        shares.iter().sum::<f64>() / shares.len() as f64
    }
}

/// Mass of everything that hangs on the shoulder (kg).
fn arm_mass(model: &Model) -> f64 {
    let mut hangs = vec![false; model.bodies.len()];
    // Parents come before their children.
    for (index, body) in model.bodies.iter().enumerate() {
        hangs[index] = index == model.shoulder_body || hangs[body.parent];
    }
    model.bodies.iter().zip(hangs).filter(|(_, hangs)| *hangs).map(|(body, _)| body.mass).sum()
}

#[cfg(test)]
mod tests {
    use myo_model::builtin;

    use super::*;

    #[test]
    fn people_of_all_sizes_are_as_published() {
        let found = Sizes::of(&builtin("myo-arm").unwrap()).unwrap();
        for row in &found.rows {
            // Bones are not in line.
            assert!((0.94..=1.0).contains(&(row.reach_of_height / row.people_reach_of_height)), "{row:?}");
            assert!((row.arm_of_mass / row.people_arm_of_mass - 1.0).abs() < 0.01, "{row:?}");
            assert!((0.12..=0.35).contains(&row.holding_share), "{row:?}");
        }
        for WomanOfMan { joint, share, people: [from, to] } in &found.woman_of_man {
            assert!((from - 0.02..=to + 0.02).contains(share), "{joint} {share}");
        }
        let strengths: Vec<f64> = found.rows.iter().map(|row| row.strength_of_man[0]).collect();
        assert!(strengths.is_sorted() && (strengths[2] - 1.0).abs() < 1e-12, "{strengths:?}");
    }

    #[test]
    fn a_model_that_is_nobodys_is_refused() {
        let mut nobody = builtin("myo-arm").unwrap();
        nobody.anthropometry = None;
        let error = Sizes::of(&nobody).unwrap_err().to_string();
        assert!(error.contains("does not tell whose body it is"), "{error}");
    }
}
