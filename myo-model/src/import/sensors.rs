//! Sensors of what a model keeps; others are passed over, since they have no part in the simulation.

use super::Import;
use super::contacts::solid;
use crate::ModelDescription;
use crate::description::{
    Frame, FrameQuantity, JointKind, JointQuantity, Measure, MuscleQuantity, Sensor, Shape, SubtreeQuantity,
};
use myo_mjcf::{self as source, Mjcf};
use std::collections::BTreeMap;

impl Import<'_> {
    /// Adds sensors to the description, and to their sites what they need of these.
    pub(super) fn add_sensors(&self, description: &mut ModelDescription) {
        let sensor = |(sensor, name): (&source::Sensor, &String)| {
            let measures = self.measure(sensor, description)?;
            Some(Sensor { name: name.clone(), measures, cutoff: sensor.cutoff() })
        };
        description.sensors = self.mjcf.sensors.iter().zip(&self.names.sensors).filter_map(sensor).collect();
        for (site, (_, written)) in description.sites.iter_mut().zip(self.mjcf.sites()) {
            for sensor in &description.sensors {
                if sees(&sensor.measures, &site.name) {
                    site.quat = written.pose.quat();
                }
                if sensor.measures == Measure::Touch(site.name.clone()) {
                    site.shape = volume(written);
                }
            }
        }
    }

    /// What a sensor measures; nothing of one that is passed over.
    fn measure(&self, sensor: &source::Sensor, description: &ModelDescription) -> Option<Measure<String>> {
        let is_at_once = sensor.nsample() == 0 && sensor.delay() == 0.0 && sensor.interval.is_none();
        if !is_at_once {
            return None;
        }
        let site = || sensor.site.clone();
        match sensor.kind {
            "touch" => Some(Measure::Touch(site().filter(|name| self.has_volume(name))?)),
            "gyro" => Some(Measure::Gyro(site()?)),
            "velocimeter" => Some(Measure::Velocimeter(site()?)),
            "subtreecom" => self.subtree(sensor, SubtreeQuantity::Centre),
            "subtreelinvel" => self.subtree(sensor, SubtreeQuantity::Velocity),
            kind => {
                let joint = || of_joint(kind).and_then(|(kind, quantity)| joint(sensor, kind, quantity, description));
                let muscle = || self.muscle_of(sensor, of_muscle(kind)?, description);
                let frame = || self.frame_of(sensor, of_frame(kind)?, description);
                joint().or_else(muscle).or_else(frame)
            }
        }
    }

    fn has_volume(&self, site: &str) -> bool {
        let mut sites = self.mjcf.sites().map(|(_, site)| site);
        sites.find(|other| other.name.as_deref() == Some(site)).and_then(volume).is_some()
    }

    fn subtree(&self, sensor: &source::Sensor, quantity: SubtreeQuantity) -> Option<Measure<String>> {
        let of = sensor.body.clone()?;
        let bodies = &self.mjcf.bodies;
        let mut is_below: Vec<bool> = bodies.iter().map(|body| body.name.as_ref() == Some(&of)).collect();
        // Parents stand before their children.
        for number in 1..bodies.len() {
            is_below[number] |= is_below[bodies[number].parent];
        }
        let is_known = |number: usize| !is_below[number] || self.mass_is_known(number);
        (1..bodies.len()).all(is_known).then_some(Measure::Subtree { of, quantity })
    }

    /// The first muscle of a tendon or actuator: its limit is that of the tendon.
    fn muscle_of(
        &self,
        sensor: &source::Sensor,
        quantity: MuscleQuantity,
        description: &ModelDescription,
    ) -> Option<Measure<String>> {
        let actuators = &self.mjcf.actuators;
        let number = match (&sensor.actuator, &sensor.tendon) {
            (Some(actuator), _) => actuators.iter().position(|other| other.name.as_ref() == Some(actuator))?,
            (None, tendon) => {
                let mut pulling = actuators.iter().enumerate().filter(|(_, other)| other.tendon == *tendon);
                let (first, _) = pulling.next()?;
                // What several do together no muscle tells.
                (quantity != MuscleQuantity::Force || pulling.next().is_none()).then_some(first)?
            }
        };
        let muscle = description.muscles.get(number)?;
        let is_there = muscle.limit.is_some() || !quantity.is_of_limit();
        is_there.then(|| Measure::Muscle { of: muscle.name.clone(), quantity })
    }

    fn frame_of(
        &self,
        sensor: &source::Sensor,
        quantity: FrameQuantity,
        description: &ModelDescription,
    ) -> Option<Measure<String>> {
        let frame = |kind: &Option<String>, name: &Option<String>, needs_axes| {
            self.frame(kind.as_deref()?, name.as_deref()?, needs_axes, description)
        };
        let of = frame(&sensor.objtype, &sensor.objname, quantity.is_turn())?;
        let seen_from = match &sensor.refname {
            None => None,
            Some(_) => Some(frame(&sensor.reftype, &sensor.refname, true)?),
        };
        Some(Measure::Frame { of, quantity, seen_from })
    }

    /// A frame that the description has, with its axes where these are needed.
    fn frame(&self, kind: &str, name: &str, needs_axes: bool, description: &ModelDescription) -> Option<Frame<String>> {
        let frame = match kind {
            "xbody" => Frame::Body,
            "body" => {
                let body = self.names.bodies.iter().position(|body| body == name)?;
                let is_known = if needs_axes { self.axes_are_known(body) } else { self.mass_is_known(body) };
                is_known.then_some(Frame::Centre)?
            }
            "geom" if description.wraps.iter().any(|wrap| wrap.name == name) => Frame::Wrap,
            "geom" if description.geoms.iter().any(|geom| geom.name == name) => Frame::Geom,
            "site" => Frame::Site,
            _ => return None,
        };
        Some(frame(name.to_owned()))
    }
}

/// A joint that the description has, if such a sensor measures joints of its kind.
fn joint(
    sensor: &source::Sensor,
    kind: Option<JointKind>,
    quantity: JointQuantity,
    description: &ModelDescription,
) -> Option<Measure<String>> {
    let of = sensor.joint.as_ref()?;
    let joint = description.joints.iter().find(|joint| joint.name == *of)?;
    let is_of_kind = kind.map_or(joint.kind.is_scalar(), |kind| joint.kind == kind);
    let is_there = is_of_kind && (joint.range.is_some() || !quantity.is_of_limit());
    is_there.then(|| Measure::Joint { of: of.clone(), quantity })
}

/// What a kind of sensor measures of joints, and of which, if not of hinges and slides.
fn of_joint(kind: &str) -> Option<(Option<JointKind>, JointQuantity)> {
    Some(match kind {
        "jointpos" => (None, JointQuantity::Position),
        "jointvel" => (None, JointQuantity::Velocity),
        "jointactuatorfrc" => (None, JointQuantity::MuscleForce),
        "jointlimitpos" => (None, JointQuantity::LimitDistance),
        "jointlimitvel" => (None, JointQuantity::LimitVelocity),
        "jointlimitfrc" => (None, JointQuantity::LimitForce),
        "ballquat" => (Some(JointKind::Ball), JointQuantity::Position),
        "ballangvel" => (Some(JointKind::Ball), JointQuantity::Velocity),
        _ => return None,
    })
}

fn of_muscle(kind: &str) -> Option<MuscleQuantity> {
    Some(match kind {
        "tendonpos" | "actuatorpos" => MuscleQuantity::Length,
        "tendonvel" | "actuatorvel" => MuscleQuantity::Velocity,
        "tendonactuatorfrc" | "actuatorfrc" => MuscleQuantity::Force,
        "tendonlimitpos" => MuscleQuantity::LimitDistance,
        "tendonlimitvel" => MuscleQuantity::LimitVelocity,
        "tendonlimitfrc" => MuscleQuantity::LimitForce,
        _ => return None,
    })
}

fn of_frame(kind: &str) -> Option<FrameQuantity> {
    Some(match kind {
        "framepos" => FrameQuantity::Position,
        "framequat" => FrameQuantity::Orientation,
        "framexaxis" => FrameQuantity::XAxis,
        "frameyaxis" => FrameQuantity::YAxis,
        "framezaxis" => FrameQuantity::ZAxis,
        "framelinvel" => FrameQuantity::Velocity,
        "frameangvel" => FrameQuantity::AngularVelocity,
        _ => return None,
    })
}

/// Whether something is measured with a site.
fn sees(measures: &Measure<String>, site: &str) -> bool {
    let is_it = |frame: &Frame<String>| matches!(frame, Frame::Site(name) if name == site);
    match measures {
        Measure::Touch(name) | Measure::Gyro(name) | Measure::Velocimeter(name) => name == site,
        Measure::Frame { of, seen_from, .. } => is_it(of) || seen_from.as_ref().is_some_and(is_it),
        Measure::Joint { .. } | Measure::Muscle { .. } | Measure::Subtree { .. } => false,
    }
}

/// The volume of a site.
fn volume(site: &source::Site) -> Option<Shape> {
    solid(site.kind(), site.size())
}

/// Sensors that a description does not have, by their kinds.
pub(super) fn passed_over(mjcf: &Mjcf, names: &[String], description: &ModelDescription) -> Vec<(String, usize)> {
    let mut counts = BTreeMap::new();
    for (sensor, name) in mjcf.sensors.iter().zip(names) {
        if !description.sensors.iter().any(|kept| kept.name == *name) {
            *counts.entry(format!("`{}` sensors", sensor.kind)).or_insert(0) += 1;
        }
    }
    counts.into_iter().collect()
}
