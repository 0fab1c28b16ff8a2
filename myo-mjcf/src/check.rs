//! What must hold of the whole: names of one kind differ, numbers are finite.

use crate::elements::*;
use crate::error::MjcfError;
use crate::mjcf::Mjcf;
use crate::names::Named;
use crate::place::{Kind, Place};
use crate::replicate::spot_of;
use std::collections::HashMap;

pub(crate) fn check(model: &mut Mjcf) -> Result<(), MjcfError> {
    differ(&model.bodies)?;
    differ(model.bodies.iter().flat_map(|body| &body.joints))?;
    differ(model.bodies.iter().flat_map(|body| &body.geoms))?;
    differ(model.bodies.iter().flat_map(|body| &body.sites))?;
    differ(model.bodies.iter().flat_map(|body| &body.cameras))?;
    differ(model.bodies.iter().flat_map(|body| &body.lights))?;
    differ(&model.meshes)?;
    differ(&model.height_fields)?;
    differ(&model.textures)?;
    differ(&model.materials)?;
    differ(&model.pairs)?;
    differ(&model.excludes)?;
    differ(&model.equalities)?;
    differ(&model.tendons)?;
    differ(&model.actuators)?;
    differ(&model.sensors)?;
    differ(&model.keys)?;
    differ(&model.numerics)?;
    differ(&model.texts)?;
    differ(&model.tuples)?;
    model.bodies.iter().try_for_each(finite_body)
}

fn differ<'a, T: Named + 'a>(elements: impl IntoIterator<Item = &'a T>) -> Result<(), MjcfError> {
    let mut first: HashMap<&str, &T> = HashMap::new();
    for element in elements {
        let Some(name) = element.name() else { continue };
        if let Some(other) = first.insert(name, element) {
            let (at, first) = (Box::new(element.spot()), other.spot().place);
            return Err(MjcfError::DuplicateName { at, kind: T::KIND, first });
        }
    }
    Ok(())
}

/// Frames are gone, but their names must differ too.
pub(crate) fn check_frames(frames: Vec<(String, Place)>) -> Result<(), MjcfError> {
    let mut first: HashMap<String, Place> = HashMap::new();
    for (name, place) in frames {
        let spot = spot_of(&place, "frame", Some(&name));
        if let Some(first) = first.insert(name, place) {
            return Err(MjcfError::DuplicateName { at: Box::new(spot), kind: Kind::Frame, first });
        }
    }
    Ok(())
}

/// Frames within frames can add up to more than a number can hold.
fn finite_body(body: &Body) -> Result<(), MjcfError> {
    finite(body, body.pose.pos().iter().chain(&body.pose.quat()))?;
    for geom in &body.geoms {
        finite(geom, geom.pose.pos().iter().chain(&geom.pose.quat()).chain(&geom.size()))?;
    }
    for site in &body.sites {
        finite(site, site.pose.pos().iter().chain(&site.pose.quat()).chain(&site.size()))?;
    }
    for camera in &body.cameras {
        finite(camera, camera.pose.pos().iter().chain(&camera.pose.quat()))?;
    }
    for light in &body.lights {
        finite(light, light.pos().iter().chain(&light.dir()))?;
    }
    for joint in &body.joints {
        finite(joint, joint.pos().iter().chain(&joint.axis()))?;
    }
    let Some(inertial) = &body.inertial else { return Ok(()) };
    finite(body, inertial.pose.pos().iter().chain(&inertial.fullinertia.unwrap_or_default()))
}

fn finite<'a>(element: &impl Named, numbers: impl Iterator<Item = &'a f64>) -> Result<(), MjcfError> {
    match numbers.copied().find(|number| !number.is_finite()) {
        None => Ok(()),
        Some(number) => {
            let (at, text) = (Box::new(element.spot()), number.to_string());
            let expected = "small enough to be a finite number after its frames";
            Err(MjcfError::OutOfRange { at, attribute: "pos", text, expected })
        }
    }
}
