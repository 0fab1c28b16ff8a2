//! The exported file holds every element, with numbers that read back the same.

use myo_model::description::{Over, PathElement, Wrap, WrapShape};
use myo_model::mjcf::{Button, MjcfOptions, to_mjcf};
use myo_model::{Model, builtin};
use nalgebra::{UnitQuaternion, Vector3};

fn arm() -> Model {
    Model::new(&builtin("mobl-arms").unwrap()).unwrap()
}

fn count(xml: &str, tag: &str) -> usize {
    xml.matches(&format!("<{tag} ")).count()
}

#[test]
fn nothing_is_dropped() {
    let arm = arm();
    let xml = to_mjcf(&arm, &MjcfOptions::default());
    assert_eq!(count(&xml, "body"), arm.bodies.len() - 1);
    assert_eq!(count(&xml, "joint"), arm.joints.len() + arm.couplings.len());
    assert_eq!(count(&xml, "spatial"), arm.muscles.len());
    assert_eq!(count(&xml, "general"), arm.muscles.len());
    assert_eq!(count(&xml, "geom"), arm.geoms.len());
    let path_sites: usize = arm.muscles.iter().map(|muscle| muscle.path.len()).sum();
    assert_eq!(count(&xml, "site"), arm.sites.len() + path_sites);
    assert_eq!(count(&xml, "touch"), 0);
}

#[test]
fn numbers_read_back_bit_for_bit() {
    let mut arm = arm();
    arm.joints[3].damping = 0.1 + 0.2;
    let xml = to_mjcf(&arm, &MjcfOptions::default());
    assert!(xml.contains("damping=\"0.30000000000000004\""));
}

#[test]
fn names_are_escaped() {
    let mut arm = arm();
    arm.muscles[0].name = "a<\"b\"&c".to_owned();
    let xml = to_mjcf(&arm, &MjcfOptions::default());
    assert_eq!(xml.matches("\"a&lt;&quot;b&quot;&amp;c\"").count(), 3);
}

#[test]
fn buttons_feel_touch() {
    let button = Button {
        name: "button".to_owned(),
        pos: Vector3::new(0.4, -0.1, 0.9),
        quat: UnitQuaternion::identity(),
        half_size: [0.025, 0.025, 0.01],
        margin: 0.001,
        friction: [1.0, 0.005, 0.0001],
        softness: Default::default(),
    };
    let xml = to_mjcf(&arm(), &MjcfOptions { buttons: vec![button], ..MjcfOptions::default() });
    assert!(xml.contains("<touch name=\"button\" site=\"button\"/>"));
    assert!(xml.contains("size=\"0.025 0.025 0.01\" contype=\"1\" conaffinity=\"1\" condim=\"3\""));
}

#[test]
fn what_muscles_run_over_is_a_geom_that_touches_nothing() {
    let mut arm = builtin("mobl-arms").unwrap();
    let shape = WrapShape::Cylinder { radius: 0.016, half_length: 0.03 };
    let (name, body) = ("elbow".to_owned(), "humerus".to_owned());
    arm.wraps.push(Wrap { name, body, shape, pos: [0.0, 0.1, 0.0], quat: [1.0, 0.0, 0.0, 0.0] });
    let over = |side: Option<&str>| PathElement::Over(Over { over: "elbow".into(), side: side.map(Into::into) });
    arm.muscles[0].path.insert(1, over(None));
    arm.muscles[1].path.insert(1, over(Some("DELT1-P2")));
    let xml = to_mjcf(&Model::new(&arm).unwrap(), &MjcfOptions::default());
    for line in [
        "<geom name=\"elbow\" type=\"cylinder\" size=\"0.016 0.03\" pos=\"0.0 0.1 0.0\" quat=\"1.0 0.0 0.0 0.0\" \
         contype=\"0\" conaffinity=\"0\"/>",
        "<geom geom=\"elbow\"/>",
        "<geom geom=\"elbow\" sidesite=\"DELT1-P2\"/>",
    ] {
        assert!(xml.contains(line), "{line}");
    }
}
