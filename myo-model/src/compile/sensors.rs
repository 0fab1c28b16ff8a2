//! Sensors: which element each one measures, and whether there is anything to measure.

use super::Index;
use crate::check::Check;
use crate::description::{FrameQuantity, JointKind, JointQuantity, Measure, ModelDescription, Shape};
use crate::error::{ElementKind, ModelError};
use crate::model::{Geom, Joint, Muscle, Sensor, Site, Wrap};

/// Elements that sensors measure.
pub(super) struct Measured<'a> {
    pub bodies: &'a Index<'a>,
    pub joints: &'a [Joint],
    pub sites: &'a [Site],
    pub geoms: &'a [Geom],
    pub wraps: &'a [Wrap],
    pub muscles: &'a [Muscle],
}

/// The sensors, in the order in which they are written.
pub(super) fn sensors(description: &ModelDescription, of: &Measured<'_>) -> Result<Vec<Sensor>, ModelError> {
    Index::new(ElementKind::Sensor, description.sensors.iter().map(|sensor| sensor.name.as_str()))?;
    let joints = Index::new(ElementKind::Joint, of.joints.iter().map(|joint| joint.name.as_str()))?;
    let sites = Index::new(ElementKind::Site, of.sites.iter().map(|site| site.name.as_str()))?;
    let geoms = Index::new(ElementKind::Geom, of.geoms.iter().map(|geom| geom.name.as_str()))?;
    let wraps = Index::new(ElementKind::Wrap, of.wraps.iter().map(|wrap| wrap.name.as_str()))?;
    let muscles = Index::new(ElementKind::Muscle, of.muscles.iter().map(|muscle| muscle.name.as_str()))?;
    let mut sensors = Vec::with_capacity(description.sensors.len());
    for sensor in &description.sensors {
        let check = Check::new(ElementKind::Sensor, &sensor.name);
        let measures = sensor.measures.try_map(|kind, name| {
            let index = match kind {
                ElementKind::Joint => &joints,
                ElementKind::Site => &sites,
                ElementKind::Geom => &geoms,
                ElementKind::Wrap => &wraps,
                ElementKind::Muscle => &muscles,
                _ => of.bodies,
            };
            index.find(name, &check.element)
        })?;
        check.not_negative("cutoff", sensor.cutoff, "")?;
        let fault = missing(&measures, of).or_else(|| (sensor.cutoff > 0.0).then(|| endless(&measures, of)).flatten());
        if let Some(why) = fault {
            return Err(ModelError::NothingToMeasure { element: check.element, why });
        }
        sensors.push(Sensor { name: sensor.name.clone(), measures, cutoff: sensor.cutoff });
    }
    Ok(sensors)
}

/// What is not there to be measured, if anything.
fn missing(measures: &Measure<usize>, of: &Measured<'_>) -> Option<&'static str> {
    match *measures {
        Measure::Touch(site) => match of.sites[site].shape {
            None => Some("its site has no `shape` in which it would feel touch"),
            Some(Shape::Plane | Shape::Mesh { .. }) => {
                Some("its site must be a sphere, capsule, ellipsoid, cylinder or box")
            }
            Some(_) => None,
        },
        Measure::Joint { of: joint, quantity } => missing_of_joint(&of.joints[joint], quantity),
        Measure::Muscle { of: muscle, quantity } => {
            (quantity.is_of_limit() && of.muscles[muscle].limit.is_none()).then_some("its muscle has no `limit`")
        }
        Measure::Gyro(_) | Measure::Velocimeter(_) | Measure::Frame { .. } | Measure::Subtree { .. } => None,
    }
}

fn missing_of_joint(joint: &Joint, quantity: JointQuantity) -> Option<&'static str> {
    let is_motion = matches!(quantity, JointQuantity::Position | JointQuantity::Velocity);
    if joint.kind == JointKind::Free {
        Some("its joint is a free one; measure the frame of its body")
    } else if !joint.kind.is_scalar() && !is_motion {
        Some("its joint is a ball joint, of which only `position` and `velocity` are measured")
    } else if quantity.is_of_limit() && joint.range.is_none() {
        Some("its joint has no `range`")
    } else {
        None
    }
}

/// Why its numbers have no greatest size, if they have none.
fn endless(measures: &Measure<usize>, of: &Measured<'_>) -> Option<&'static str> {
    let is_turn = match *measures {
        Measure::Frame { quantity, .. } => FrameQuantity::is_turn(quantity),
        Measure::Joint { of: joint, quantity: JointQuantity::Position } => !of.joints[joint].kind.is_scalar(),
        _ => false,
    };
    is_turn.then_some("orientations and axes have no `cutoff`; leave it out")
}
