//! Models as somebody else's bodies.

use std::collections::BTreeMap;

use myo_model::description::{PathElement, Softness, TendonLimit, WrapShape};
use myo_model::{Model, ModelDescription, ModelError, Sex, Size, builtin};

fn arm() -> ModelDescription {
    builtin("myo-arm").unwrap()
}

fn named<T: Copy>(pairs: &[(&str, T)]) -> BTreeMap<String, T> {
    pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect()
}

fn transfers(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(donor, recipient)| ((*donor).to_owned(), (*recipient).to_owned())).collect()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
}

#[test]
fn a_mirrored_body_mirrored_is_the_body() {
    let once = arm().mirrored();
    assert_ne!(once, arm());
    assert_eq!(once.mirrored(), arm());
}

#[test]
fn the_size_of_the_model_changes_nothing() {
    assert_eq!(arm().sized(&Size::default()).unwrap(), arm());
    let own = arm().anthropometry.unwrap();
    let size = Size { sex: Some(own.sex), height_m: Some(own.height_m), mass_kg: Some(own.mass_kg) };
    assert_eq!(arm().sized(&size).unwrap(), arm());
}

/// Twice as tall and eight times as heavy: everything that follows from lengths and masses alone is known.
#[test]
fn a_body_of_the_same_shape_scales_as_geometry_says() {
    let own = arm().anthropometry.unwrap();
    let size = Size { sex: None, height_m: Some(2.0 * own.height_m), mass_kg: Some(8.0 * own.mass_kg) };
    let (small, large) = (arm(), arm().sized(&size).unwrap());
    for (a, b) in small.bodies.iter().zip(&large.bodies).filter(|(a, _)| a.parent != "world") {
        assert!((0..3).all(|k| close(2.0 * a.pos[k], b.pos[k]) && close(2.0 * a.com[k], b.com[k])), "{}", a.name);
        assert!(close(8.0 * a.mass, b.mass) && close(32.0 * a.inertia[0], b.inertia[0]), "{}", a.name);
    }
    for (a, b) in small.wraps.iter().zip(&large.wraps) {
        assert!(close(2.0 * a.shape.radius(), b.shape.radius()), "{}", a.name);
        assert!(matches!(
            (a.shape, b.shape),
            (WrapShape::Sphere { .. }, WrapShape::Sphere { .. })
                | (WrapShape::Cylinder { .. }, WrapShape::Cylinder { .. })
        ));
    }
    for (a, b) in small.muscles.iter().zip(&large.muscles) {
        let (a, b) = (&a.parameters, &b.parameters);
        assert!(close(2.0 * a.length_range[0], b.length_range[0]));
        // Eight times the torque over twice the moment arm.
        assert!(close(4.0 * a.gain.force.unwrap(), b.gain.force.unwrap()));
        assert!(close(4.0 * a.bias.force.unwrap(), b.bias.force.unwrap()));
        assert_eq!(a.gain.range, b.gain.range);
    }
    // Damping over inertia is a time, and the same.
    assert!(small.joints.iter().zip(&large.joints).all(|(a, b)| close(32.0 * a.damping, b.damping)));
}

#[test]
fn a_woman_has_the_proportions_of_women() {
    let own = arm().anthropometry.unwrap();
    let size = Size { sex: Some(Sex::Female), height_m: Some(own.height_m), mass_kg: Some(own.mass_kg) };
    let woman = arm().sized(&size).unwrap();
    let of = |model: &ModelDescription, name: &str| model.bodies.iter().find(|body| body.name == name).unwrap().clone();
    let ratio = |name: &str| of(&woman, name).mass / of(&arm(), name).mass;
    assert!(close(ratio("humerus"), 2.55 / 2.71) && close(ratio("radius"), 1.38 / 1.62));
    assert!(close(ratio("hand"), 0.56 / 0.61) && close(ratio("scapula"), 1.0));
    // What damps the elbow goes with what is damped.
    let damping =
        |model: &ModelDescription| model.joints.iter().find(|joint| joint.name == "elbow_flexion").unwrap().damping;
    assert!(close(damping(&woman) / damping(&arm()), 1.38 / 1.62 * (0.1523_f64 / 0.1545).powi(2)));
    // The hand hangs on the forearm.
    assert!(close(of(&woman, "hand").pos[1] / of(&arm(), "hand").pos[1], 0.1523 / 0.1545));
    assert!(Model::new(&woman).is_ok());
}

#[test]
fn muscles_are_weaker_by_name_and_by_group() {
    let weak = arm().with_strength(0.5, &named(&[("SUPSP", 0.0), ("elbow", 0.8)])).unwrap();
    let share = |name: &str| {
        let of = |model: &ModelDescription| {
            let muscle = model.muscles.iter().find(|muscle| muscle.name == name).unwrap();
            (muscle.parameters.gain.force.unwrap(), muscle.parameters.bias.force.unwrap())
        };
        let ((weak, passive), (strong, usual)) = (of(&weak), of(&arm()));
        assert!(close(passive, usual), "{name} has the passive force of before");
        weak / strong
    };
    assert!(close(share("DELT1"), 0.5) && share("SUPSP") == 0.0 && close(share("BRA"), 0.4));
}

#[test]
fn a_limit_stays_with_its_tendon() {
    let mut arm = arm();
    let limit = Some(TendonLimit { range: [0.1, 0.5], margin: 0.0, softness: Softness::default() });
    let [first, second, third] = [0, 1, 2].map(|muscle| arm.muscles[muscle].name.clone());
    // Two muscles pull one tendon.
    arm.muscles[1].path = arm.muscles[0].path.clone();
    arm.muscles[0].limit = limit;
    let moved = arm.clone().with_transfers(&transfers(&[(&first, &third)])).unwrap();
    let of = |name: &str| moved.muscles.iter().find(|muscle| muscle.name == name).unwrap().limit;
    assert_eq!((of(&first), of(&second)), (None, limit));
    // Of a tendon that another muscle is put on, the limit is its own now.
    arm.muscles.swap(0, 2);
    let moved = arm.with_transfers(&transfers(&[(&third, &first)])).unwrap();
    assert_eq!(moved.muscles.iter().find(|muscle| muscle.name == third).unwrap().limit, limit);
}

#[test]
fn a_transferred_tendon_pulls_where_the_other_did() {
    let moved = arm().with_transfers(&transfers(&[("PT", "ECRB")])).unwrap();
    let find = |model: &ModelDescription, name: &str| model.muscles.iter().find(|m| m.name == name).cloned();
    let (before, after) = (find(&arm(), "PT").unwrap(), find(&moved, "PT").unwrap());
    let replaced = find(&arm(), "ECRB").unwrap();
    assert!(find(&moved, "ECRB").is_none() && moved.muscles.len() + 1 == arm().muscles.len());
    assert_eq!(after.path, replaced.path);
    assert!(matches!(after.path[0], PathElement::Site(_)));
    assert_eq!(after.parameters.gain, before.parameters.gain);
    assert_eq!(after.parameters.length_range, replaced.parameters.length_range);
}

#[test]
fn what_no_body_has_is_refused_in_a_sentence() {
    let refused = |made: Result<ModelDescription, ModelError>| made.unwrap_err().to_string();
    let text = refused(arm().with_strength(1.0, &named(&[("SUPS", 0.5)])));
    assert_eq!(text, "the body of the user: unknown muscle `SUPS`; did you mean `SUPSP`, `SUP` or `SUBSC`?");
    let text = refused(arm().with_transfers(&transfers(&[("PT", "ECRB"), ("FCU", "ECRB")])));
    assert!(text.starts_with("muscle `ECRB` is moved or replaced by two tendon transfers"), "{text}");
    let text = refused(arm().with_transfers(&transfers(&[("PT", "FCU"), ("FCU", "ECRB")])));
    assert!(text.starts_with("muscle `FCU` is moved or replaced by two"), "{text}");
    let text = refused(arm().with_transfers(&transfers(&[("PT", "PT")])));
    assert!(text.starts_with("muscle `PT` is moved or replaced by two"), "{text}");

    let taller = Size { height_m: Some(1.9), ..Size::default() };
    let mut nobody = arm();
    nobody.anthropometry = None;
    assert!(refused(nobody.sized(&taller)).contains("model `myo-arm` does not tell whose body it is"));
    let mut unmeasured = arm();
    unmeasured.muscles[3].parameters.gain.force = None;
    assert!(refused(unmeasured.sized(&taller)).starts_with("muscle `SUPSP` does not tell its peak isometric `force`"));
    let mut lost = arm();
    lost.anthropometry.as_mut().unwrap().hand.push("finger".into());
    assert!(refused(lost.sized(&taller)).starts_with("anthropometry: unknown body `finger`"));
    let mut twice = arm();
    twice.anthropometry.as_mut().unwrap().hand.push("ulna".into());
    assert!(Model::new(&twice).unwrap_err().to_string().starts_with("body `ulna` is named twice in `anthropometry`"));
    let mut flat = arm();
    flat.anthropometry.as_mut().unwrap().height_m = 0.0;
    let text = Model::new(&flat).unwrap_err().to_string();
    assert_eq!(text, "anthropometry: `height_m` is 0 m; it must be from 0.3 to 3 m");
}
