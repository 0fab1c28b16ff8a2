//! Joints that are locked: a model without them, as if their bodies were welded in the pose of the file.

use super::Unsupported;
use myo_mjcf::{Constraint, Mjcf};
use myo_nearest::Nearest;
use std::borrow::Cow;

/// The model without some joints; what followed them stands still.
///
/// # Errors
/// Names that no joint has.
pub(super) fn locked<'a>(mjcf: &'a Mjcf, names: &[String]) -> Result<Cow<'a, Mjcf>, Vec<Unsupported>> {
    if names.is_empty() {
        return Ok(Cow::Borrowed(mjcf));
    }
    let known: Vec<&str> = mjcf.joints().filter_map(|(_, joint)| joint.name.as_deref()).collect();
    let unknown = names.iter().filter(|name| !known.contains(&name.as_str()));
    let unknown: Vec<Unsupported> = unknown.map(|name| no_joint(mjcf, name, &known)).collect();
    if !unknown.is_empty() {
        return Err(unknown);
    }
    let is_locked = |name: &String| names.contains(name);
    let mut rest = mjcf.clone();
    for body in &mut rest.bodies {
        body.joints.retain(|joint| !joint.name.as_ref().is_some_and(is_locked));
    }
    rest.equalities.retain_mut(|equality| match &mut equality.constraint {
        Constraint::Joint(coupling) => {
            coupling.joint2.take_if(|leader| is_locked(leader));
            !is_locked(&coupling.joint1)
        }
        Constraint::Connect(_) | Constraint::Weld(_) | Constraint::Tendon(_) => true,
    });
    Ok(Cow::Owned(rest))
}

fn no_joint(mjcf: &Mjcf, name: &str, known: &[&str]) -> Unsupported {
    let what = format!("there is no joint `{name}` to lock; {}", Nearest::to(name, known));
    // The world is where bodies begin.
    let place = mjcf.bodies.first().map(|world| world.place.clone()).unwrap_or_default();
    Unsupported { place, element: "<worldbody>".into(), what }
}
