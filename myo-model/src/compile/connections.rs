//! Bodies that are held together: which ones, and whether it makes sense.

use super::Index;
use crate::check::{Bound, Check};
use crate::description::{self as source, ModelDescription};
use crate::error::{ElementKind, ModelError};
use crate::model::{Connection, Weld};

/// All connections of a description, in its order.
pub(super) fn connections(description: &ModelDescription, bodies: &Index<'_>) -> Result<Vec<Connection>, ModelError> {
    description.connections.iter().map(|written| connection(written, bodies)).collect()
}

fn connection(written: &source::Connection, bodies: &Index<'_>) -> Result<Connection, ModelError> {
    let [one, other] = &written.bodies;
    let check = Check::new(ElementKind::Connection, &format!("{one}, {other}"));
    if one == other {
        return Err(ModelError::HeldToItself { body: one.clone() });
    }
    for anchor in &written.anchors {
        check.within("anchors", anchor, &Bound::LENGTH)?;
    }
    check.softness(&written.softness)?;
    let weld = |weld: source::Weld| {
        check.not_negative("torque_scale", weld.torque_scale, " m")?;
        check.within("torque_scale", &[weld.torque_scale], &Bound::LENGTH)?;
        Ok(Weld { turn: check.rotation("quat", weld.quat)?, torque_scale: weld.torque_scale })
    };
    Ok(Connection {
        bodies: [bodies.find(one, &check.element)?, bodies.find(other, &check.element)?],
        anchors: written.anchors.map(Into::into),
        weld: written.weld.map(weld).transpose()?,
        softness: written.softness,
    })
}
