//! What is seen of bodies: whether it is whole, and of which body.

use super::Index;
use crate::check::{Bound, Check};
use crate::description::{self as source, ModelDescription};
use crate::error::{ElementKind, ModelError};
use crate::model::Look;
use base64::prelude::{BASE64_STANDARD, Engine};

/// What is seen of bodies, in the order of these.
pub(super) fn looks(description: &ModelDescription, bodies: &Index<'_>) -> Result<Vec<Look>, ModelError> {
    let look = |(number, written): (usize, &source::Look)| {
        let check = Check::new(ElementKind::Look, &format!("{} of {}", number + 1, written.body));
        check.within("pos", &written.pos, &Bound::LENGTH)?;
        check.above("step", written.step, 0.0, " m", "above 0 m")?;
        check.within("step", &[written.step], &Bound::LENGTH)?;
        let bad = |what: &str| ModelError::BadLook { element: check.element.clone(), what: what.to_owned() };
        let bytes = |text: &str| BASE64_STANDARD.decode(text).map_err(|error| bad(&error.to_string()));
        let (points, faces) = (bytes(&written.points)?, bytes(&written.faces)?);
        if points.len() % 6 != 0 || faces.len() % 6 != 0 {
            return Err(bad("each point and each triangle takes six bytes"));
        }
        let most = faces.chunks_exact(2).map(|pair| usize::from(u16::from_le_bytes([pair[0], pair[1]]))).max();
        if most.is_some_and(|most| most >= points.len() / 6) {
            return Err(bad("a triangle has a point that is not there"));
        }
        Ok(Look {
            body: bodies.find(&written.body, &check.element)?,
            pos: written.pos.into(),
            quat: check.rotation("quat", written.quat)?,
            step: written.step,
            points: written.points.as_str().into(),
            faces: written.faces.as_str().into(),
        })
    };
    let mut looks: Vec<Look> = description.looks.iter().enumerate().map(look).collect::<Result<_, _>>()?;
    looks.sort_by_key(|look| look.body);
    Ok(looks)
}
