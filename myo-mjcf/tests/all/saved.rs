//! A model and what MuJoCo 4.0 saves of it are the same tree: `rich_saved.xml` is MuJoCo's.

use super::*;
use myo_mjcf::{Constraint, PathPoint, TendonPath};
use std::path::Path;

/// What both must say, element by element.
fn facts(model: &Mjcf) -> Vec<(String, Vec<f64>)> {
    let mut facts = Vec::new();
    let mut fact = |kind: &str, name: &Option<String>, numbers: Vec<f64>| {
        facts.push((format!("{kind} {}", name.as_deref().unwrap_or("-")), numbers));
    };
    for body in &model.bodies {
        fact("body", &body.name, [&[body.parent as f64][..], &body.pose.pos(), &body.pose.quat()].concat());
        if let Some(inertial) = &body.inertial {
            let pose = [inertial.pose.pos().to_vec(), inertial.pose.quat().to_vec()].concat();
            fact("inertial", &body.name, [&[inertial.mass][..], &inertial.diaginertia(), &pose].concat());
        }
    }
    for (body, joint) in model.joints() {
        fact("joint", &joint.name, [&[body as f64, joint.reference(), joint.springref()][..], &joint.range()].concat());
        fact(
            joint.kind().word(),
            &joint.name,
            [joint.pos(), unit(joint.axis()), joint.stiffness(), joint.damping()].concat(),
        );
        fact("limit", &joint.name, [&joint.solreflimit()[..], &joint.solimplimit()].concat());
    }
    for (body, geom) in model.geoms() {
        // The saved one leaves out what the shape does not need.
        let count = match geom.kind().word() {
            "sphere" => 1,
            "capsule" | "cylinder" => 2,
            _ => 3,
        };
        fact(geom.kind().word(), &geom.name, [&[body as f64][..], &geom.size()[..count], &geom.solref()].concat());
        fact("place", &geom.name, [&geom.pose.pos()[..], &geom.pose.quat(), &geom.friction()].concat());
        fact("looks", &geom.name, geom.rgba().to_vec());
    }
    for (body, site) in model.sites() {
        fact("site", &site.name, [&[body as f64][..], &site.pose.pos(), &site.pose.quat()].concat());
    }
    for tendon in &model.tendons {
        fact("tendon", &tendon.name, tendon.range().to_vec());
        // Where it is left to MuJoCo the saved one has the length.
        if !tendon.name.as_deref().is_some_and(|name| name.starts_with("to_tip")) {
            fact("spring", &tendon.name, tendon.springlength().to_vec());
        }
        match &tendon.path {
            TendonPath::Fixed(terms) => {
                terms.iter().for_each(|term| fact("term", &Some(term.joint.clone()), vec![term.coef]));
            }
            TendonPath::Spatial(points) => points.iter().for_each(|point| match point {
                PathPoint::Site(site) => fact("through", &Some(site.site.clone()), vec![]),
                PathPoint::Geom(geom) => fact("over", &Some(format!("{} {:?}", geom.geom, geom.sidesite)), vec![]),
                PathPoint::Pulley(pulley) => fact("pulley", &None, vec![pulley.divisor]),
            }),
        }
    }
    for actuator in &model.actuators {
        let law = [actuator.dyntype().word(), actuator.gaintype().word(), actuator.biastype().word()].join(" ");
        fact(&law, &actuator.name, [actuator.dynprm(), actuator.gainprm(), actuator.biasprm()].concat());
        fact("ranges", &actuator.name, [actuator.ctrlrange(), actuator.actrange(), actuator.lengthrange()].concat());
        fact("gear", &actuator.name, actuator.gear().to_vec());
    }
    for equality in &model.equalities {
        let numbers = match &equality.constraint {
            Constraint::Joint(joint) => joint.polycoef().to_vec(),
            Constraint::Weld(weld) => vec![weld.torquescale()],
            Constraint::Connect(connect) => connect.anchor().to_vec(),
            Constraint::Tendon(tendon) => tendon.polycoef().to_vec(),
        };
        fact("equality", &equality.name, [&numbers[..], &equality.solref(), &[f64::from(equality.active())]].concat());
    }
    for sensor in &model.sensors {
        fact(sensor.kind, &sensor.name, vec![sensor.cutoff(), f64::from(sensor.dim())]);
    }
    for material in &model.materials {
        fact("material", &material.name, [&material.rgba()[..], &[material.specular()]].concat());
    }
    facts
}

/// MuJoCo saves axes with length 1.
fn unit(axis: [f64; 3]) -> [f64; 3] {
    let length = axis.iter().map(|part| part * part).sum::<f64>().sqrt();
    axis.map(|part| part / length)
}

#[test]
fn a_saved_model_is_its_source() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let [source, saved] = ["rich.xml", "rich_saved.xml"].map(|name| myo_mjcf::read(&folder.join(name)).unwrap());
    assert_eq!((&source.refused[..], &saved.refused[..]), (&[][..], &[][..]));
    let (source, saved) = (facts(&source), facts(&saved));
    let names = |facts: &[(String, Vec<f64>)]| facts.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    // MuJoCo sorts materials and the like by no rule of ours.
    let sorted = |mut names: Vec<String>| {
        names.sort();
        names
    };
    assert_eq!(sorted(names(&source)), sorted(names(&saved)));
    for ((name, ours), (other, theirs)) in source.iter().zip(&saved).filter(|((name, _), (other, _))| name == other) {
        let close = ours.len() == theirs.len()
            // MuJoCo writes six digits.
            && ours.iter().zip(theirs).all(|(a, b)| (a - b).abs() <= 5e-6 * a.abs().max(1.0));
        assert!(close, "{name} {ours:?}, saved {other} {theirs:?}");
    }
    assert_eq!(names(&source), names(&saved));
}
