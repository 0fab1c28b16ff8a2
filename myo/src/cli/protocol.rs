//! `myo eval --protocol`: a simulated user asked what people were asked.

use clap::ValueEnum;
use myo::model::Model;
use myo::protocol::Strength;

use super::failure::{Failure, Result};
use super::output::{name, print, print_json, table};

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Protocol {
    /// Strength, moment arms, and the share of strength that holds the arm up
    #[value(name = "M1")]
    M1,
}

/// Asks, and prints the answer.
pub fn run(protocol: Protocol, model: &Model, json: bool) -> Result<()> {
    match protocol {
        Protocol::M1 => {
            let found = Strength::of(model).map_err(|error| Failure::sentence(error.to_string()))?;
            if json { print_json(&found) } else { print(&strength(&found)) }
        }
    }
}

/// Protocol M1 for people.
fn strength(found: &Strength) -> String {
    let verdict = |passes| if passes { "pass" } else { "FAIL" }.to_owned();
    let head = |cells: &[&str]| cells.iter().map(ToString::to_string).collect::<Vec<_>>();
    let mut strengths = vec![head(&["strength", "at", "this body", "people", ""])];
    strengths.extend(found.strength.iter().map(|row| {
        let [from, to] = row.people_n_m;
        let people = if from == to { format!("{from}") } else { format!("{from} to {to}") };
        vec![row.what.into(), format!("{}", row.at_deg), format!("{:.1}", row.torque_n_m), people, verdict(row.passes)]
    }));
    let mut holding = vec![head(&["arm straight", "at", "gravity", "strength", "share", ""])];
    holding.extend(found.holding.iter().map(|row| {
        let torques = [row.gravity_n_m, row.strength_n_m].map(|torque| format!("{torque:.1}"));
        let [gravity, strength] = torques;
        let share = format!("{:.2}", row.share);
        vec![row.way.into(), format!("{}", row.at_deg), gravity, strength, share, verdict(row.passes)]
    }));
    let mut arms = vec![head(&["moment arm at the elbow", "at", "this body", "people"])];
    arms.extend(found.moment_arms.iter().map(|row| {
        vec![
            row.muscle.into(),
            format!("{}", row.at_deg),
            format!("{:.2}", row.body_cm),
            format!("{:.2}", row.people_cm),
        ]
    }));
    let changes = match &found.sign_changes[..] {
        [] => "No muscle that was looked at changes sides.\n".to_owned(),
        changes => changes
            .iter()
            .map(|change| {
                format!("{} changes sides at {} degrees of {}: FAIL\n", change.muscle, change.at_deg, change.joint)
            })
            .collect(),
    };
    format!(
        "Protocol M1, strength of {} (N m, degrees)\n{}\nShare of strength that holds the arm up (people: 0.12 to 0.35)\n{}\n\
         Moment arms (cm)\n{}\n{changes}",
        name(&found.model),
        table(&strengths),
        table(&holding),
        table(&arms)
    )
}
