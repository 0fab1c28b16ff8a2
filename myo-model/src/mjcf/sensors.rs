//! Sensors, by MuJoCo's names.

use super::{Attribute, Xml, number, text};
use crate::description::{Frame, FrameQuantity, JointQuantity, Measure, MuscleQuantity, SubtreeQuantity};
use crate::model::{Model, Sensor};

pub(super) fn sensor(xml: &mut Xml, model: &Model, sensor: &Sensor) {
    let (tag, mut attributes) = measured(model, &sensor.measures);
    attributes.insert(0, ("name", text(&sensor.name)));
    if sensor.cutoff > 0.0 {
        attributes.push(("cutoff", number(sensor.cutoff)));
    }
    xml.leaf(tag, &attributes);
}

fn measured(model: &Model, measures: &Measure<usize>) -> (&'static str, Vec<Attribute>) {
    let site = |site: usize| vec![("site", text(&model.sites[site].name))];
    match *measures {
        Measure::Touch(of) => ("touch", site(of)),
        Measure::Gyro(of) => ("gyro", site(of)),
        Measure::Velocimeter(of) => ("velocimeter", site(of)),
        Measure::Joint { of, quantity } => {
            let joint = &model.joints[of];
            (of_joint(quantity, joint.kind.is_scalar()), vec![("joint", text(&joint.name))])
        }
        Measure::Muscle { of, quantity } => of_muscle(quantity, text(&model.muscles[of].name)),
        Measure::Frame { of, quantity, seen_from } => {
            let [kind, name] = object(model, of);
            let mut attributes = vec![("objtype", kind), ("objname", name)];
            if let Some([kind, name]) = seen_from.map(|frame| object(model, frame)) {
                attributes.extend([("reftype", kind), ("refname", name)]);
            }
            (of_frame(quantity), attributes)
        }
        Measure::Subtree { of, quantity } => {
            let tag = match quantity {
                SubtreeQuantity::Centre => "subtreecom",
                SubtreeQuantity::Velocity => "subtreelinvel",
            };
            (tag, vec![("body", text(&model.bodies[of].name))])
        }
    }
}

fn of_joint(quantity: JointQuantity, is_scalar: bool) -> &'static str {
    match quantity {
        JointQuantity::Position if is_scalar => "jointpos",
        JointQuantity::Position => "ballquat",
        JointQuantity::Velocity if is_scalar => "jointvel",
        JointQuantity::Velocity => "ballangvel",
        JointQuantity::MuscleForce => "jointactuatorfrc",
        JointQuantity::LimitDistance => "jointlimitpos",
        JointQuantity::LimitVelocity => "jointlimitvel",
        JointQuantity::LimitForce => "jointlimitfrc",
    }
}

/// Actuators and tendons have the names of their muscles.
fn of_muscle(quantity: MuscleQuantity, name: String) -> (&'static str, Vec<Attribute>) {
    let tag = match quantity {
        MuscleQuantity::Length => "actuatorpos",
        MuscleQuantity::Velocity => "actuatorvel",
        MuscleQuantity::Force => "actuatorfrc",
        MuscleQuantity::LimitDistance => "tendonlimitpos",
        MuscleQuantity::LimitVelocity => "tendonlimitvel",
        MuscleQuantity::LimitForce => "tendonlimitfrc",
    };
    (tag, vec![(if quantity.is_of_limit() { "tendon" } else { "actuator" }, name)])
}

fn of_frame(quantity: FrameQuantity) -> &'static str {
    match quantity {
        FrameQuantity::Position => "framepos",
        FrameQuantity::Orientation => "framequat",
        FrameQuantity::XAxis => "framexaxis",
        FrameQuantity::YAxis => "frameyaxis",
        FrameQuantity::ZAxis => "framezaxis",
        FrameQuantity::Velocity => "framelinvel",
        FrameQuantity::AngularVelocity => "frameangvel",
    }
}

/// Kind and name of what has a frame.
fn object(model: &Model, frame: Frame<usize>) -> [String; 2] {
    let (kind, name) = match frame {
        Frame::Body(body) => ("xbody", &model.bodies[body].name),
        Frame::Centre(body) => ("body", &model.bodies[body].name),
        Frame::Geom(geom) => ("geom", &model.geoms[geom].name),
        Frame::Wrap(wrap) => ("geom", &model.wraps[wrap].name),
        Frame::Site(site) => ("site", &model.sites[site].name),
    };
    [text(kind), text(name)]
}
