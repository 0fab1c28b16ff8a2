//! MJCF in: the very same model comes back, MuJoCo's rules hold, and what cannot be simulated is refused by name.

use std::collections::BTreeMap;

use myo_mjcf::{Limits, Mjcf, read_from};
use myo_model::description::{Joint, Landmarks, PathElement, WrapShape};
use myo_model::import::{ImportOptions, Unsupported, from_mjcf, unused};
use myo_model::mjcf::{MjcfOptions, to_mjcf};
use myo_model::{Model, ModelDescription, builtin, builtin_names};

fn read(text: &str) -> Mjcf {
    let files = BTreeMap::from([("arm.xml".to_owned(), text.to_owned())]);
    read_from(&files, "arm.xml", Limits::default()).unwrap()
}

fn options(fingertip: &str, shoulder: &str) -> ImportOptions {
    let landmarks = Landmarks { fingertip: fingertip.into(), shoulder: shoulder.into(), elbow: None, wrist: None };
    ImportOptions { landmarks, without_contacts: false }
}

/// An arm of one joint and one muscle, with more in its head, its joint, its body, its tendon and its muscle.
fn arm([head, joint, body, tendon, muscle]: [&str; 5]) -> String {
    format!(
        r#"<mujoco model="arm">
  <compiler angle="degree"/>
  {head}
  <worldbody>
    <site name="origin" pos="0.02 0 0.1"/>
    <body name="humerus" pos="0 0 1">
      <joint name="elbow" axis="0 1 0" range="0 130" damping="0.1" {joint}/>
      <geom name="bone" type="capsule" size="0.02 0.1" contype="0" conaffinity="0"/>
      <site name="insertion" pos="0.02 0 -0.05"/>
      <site name="tip" pos="0 0 -0.12"/>
      {body}
    </body>
  </worldbody>
  <tendon><spatial name="BIC" {tendon}><site site="origin"/><site site="insertion"/></spatial></tendon>
  <actuator><muscle name="BIC" tendon="BIC" lengthrange="0.7 1.1" force="300" {muscle}/></actuator>
</mujoco>"#
    )
}

fn import(parts: [&str; 5]) -> Result<ModelDescription, Vec<Unsupported>> {
    from_mjcf(&read(&arm(parts)), &options("tip", "humerus"))
}

#[test]
fn what_was_exported_comes_back() {
    for name in builtin_names() {
        let model = Model::new(&builtin(name).unwrap()).unwrap();
        let text = to_mjcf(&model, &MjcfOptions::default());
        let site = &model.sites[model.fingertip_site].name;
        let back = from_mjcf(&read(&text), &options(site, &model.bodies[model.shoulder_body].name)).unwrap();
        let mut back = Model::new(&back).unwrap();
        // What MJCF does not know.
        (back.elbow_body, back.wrist_body, back.stature_m) = (model.elbow_body, model.wrist_body, model.stature_m);
        for (own, muscle) in model.muscles.iter().zip(&mut back.muscles) {
            muscle.parameters.group = own.parameters.group;
        }
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-15 + 1e-12 * b.abs();
        for (own, body) in model.bodies.iter().zip(&mut back.bodies) {
            assert!(own.inertia.iter().zip(&body.inertia).all(|(a, b)| close(*a, *b)), "{name}: {}", own.name);
            assert!(own.quat.angle_to(&body.quat) < 1e-12, "{name}: {}", own.name);
            (body.inertia, body.inertia_quat, body.quat) = (own.inertia, own.inertia_quat, own.quat);
        }
        for (own, joint) in model.joints.iter().zip(&mut back.joints) {
            assert!((own.axis - joint.axis).norm() < 1e-12, "{name}: {}", own.name);
            joint.axis = own.axis;
        }
        for (own, wrap) in model.wraps.iter().zip(&mut back.wraps) {
            assert!(own.quat.angle_to(&wrap.quat) < 1e-12, "{name}: {}", own.name);
            wrap.quat = own.quat;
        }
        // First what is short to read.
        assert_eq!((&back.name, &back.options), (&model.name, &model.options));
        for (own, back) in model.bodies.iter().zip(&back.bodies) {
            assert_eq!(back, own, "{name}");
        }
        for (own, back) in model.joints.iter().zip(&back.joints) {
            assert_eq!(back, own, "{name}");
        }
        assert_eq!((&back.geoms, &back.wraps), (&model.geoms, &model.wraps), "{name}");
        assert!(back == model, "{name}");
    }
}

#[test]
fn what_a_file_says_in_its_own_way_is_understood() {
    let all = import(["", "stiffness=\"2\" springref=\"45\"", "", "", "ctrllimited=\"false\""]).unwrap();
    let [Joint { range: Some([low, high]), stiffness, spring_ref, damping, .. }] = all.joints[..] else {
        panic!("{:?}", all.joints)
    };
    assert!(low == 0.0 && (high - 130_f64.to_radians()).abs() < 1e-12, "{low} {high}");
    assert!(stiffness == 2.0 && damping == 0.1 && (spring_ref - 45_f64.to_radians()).abs() < 1e-12, "{spring_ref}");
    assert_eq!(all.muscles[0].parameters.ctrl_range, [0.0, 1.0]);
    assert_eq!(all.muscles[0].parameters.gain.force, Some(300.0));
    assert_eq!(all.muscles[0].path, ["origin", "insertion"].map(PathElement::from));
    // Water of a capsule: as of a cylinder and a ball.
    let volume = std::f64::consts::PI * 0.02_f64.powi(2) * (0.2 + 4.0 / 3.0 * 0.02);
    let [humerus] = &all.bodies[..] else { panic!("{:?}", all.bodies) };
    assert!((humerus.mass - 1000.0 * volume).abs() < 1e-12 && humerus.com == [0.0; 3], "{humerus:?}");
    assert!(humerus.inertia[0] > 10.0 * humerus.inertia[2], "{humerus:?}");
    assert!(Model::new(&all).is_ok());
    let off = import([
        "<option gravity=\"0 0 -9.8\"><flag limit=\"disable\" gravity=\"disable\" damper=\"disable\"/></option>",
        "",
        "",
        "",
        "",
    ]);
    let off = off.unwrap();
    assert_eq!((off.joints[0].range, off.joints[0].damping, off.options.gravity), (None, 0.0, [0.0; 3]));
}

#[test]
fn shapes_add_up_to_the_mass_of_their_body() {
    let two = r#"<geom type="box" size="0.01 0.02 0.03" pos="0.1 0 0" mass="1" contype="0"/>
        <geom type="sphere" size="0.01" pos="-0.1 0 0" mass="3" contype="0"/>
        <geom type="ellipsoid" size="0.01 0.02 0.03" mass="0" contype="0"/>"#;
    let all = import(["<default><geom conaffinity=\"0\"/></default>", "", two, "", ""]).unwrap();
    let humerus = &all.bodies[0];
    let bone = humerus.mass - 4.0;
    assert!((humerus.com[0] + 0.2 / humerus.mass).abs() < 1e-12 && humerus.com[1] == 0.0, "{humerus:?}");
    // About the z axis: moments of each, and of each about the common centre.
    let [box_z, ball, bone_z] = [(0.01 * 0.01 + 0.02 * 0.02) / 3.0, 3.0 * 0.4 * 1e-4, bone_moment(bone)];
    let apart = 4.0 * 0.01 - humerus.mass * humerus.com[0].powi(2);
    let most = humerus.inertia.iter().any(|moment| (moment - (box_z + ball + bone_z + apart)).abs() < 1e-10);
    assert!(most, "{humerus:?}");
}

/// Moment of a capsule with this mass about its axis, of radius 0.02 and half length 0.1.
fn bone_moment(mass: f64) -> f64 {
    let (tube, ball) = (0.2, 4.0 / 3.0 * 0.02);
    mass * 0.02 * 0.02 * (0.5 * tube + 0.4 * ball) / (tube + ball)
}

#[test]
fn what_muscles_run_over_is_found_among_geoms() {
    let body = r#"<geom name="condyle" type="cylinder" size="0.015 0.03" euler="90 0 0" contype="0" conaffinity="0"/>"#;
    let text = arm(["", "", body, "", ""]).replace(
        "<site site=\"insertion\"/></spatial>",
        "<geom geom=\"condyle\" sidesite=\"tip\"/><site site=\"insertion\"/></spatial>",
    );
    let all = from_mjcf(&read(&text), &options("tip", "humerus")).unwrap();
    let [wrap] = &all.wraps[..] else { panic!("{:?}", all.wraps) };
    assert_eq!((&*wrap.name, wrap.shape), ("condyle", WrapShape::Cylinder { radius: 0.015, half_length: 0.03 }));
    assert_eq!(all.muscles[0].path.len(), 3);
    assert!(Model::new(&all).is_ok());
}

#[test]
fn what_cannot_be_simulated_is_refused_by_name_and_place() {
    let told = |parts| import(parts).unwrap_err().iter().map(ToString::to_string).collect::<Vec<_>>();
    for (parts, start) in [
        (["<option integrator=\"RK4\"/>", "", "", "", ""], "arm.xml:3:3: <option>: only `integrator=\"Euler\"`"),
        (["<option density=\"1.2\"/>", "", "", "", ""], "arm.xml:3:3: <option>: forces of a medium"),
        (["<option><flag refsafe=\"disable\"/></option>", "", "", "", ""], "arm.xml:3:11: <flag>: time constants"),
        (["<compiler settotalmass=\"60\"/>", "", "", "", ""], "arm.xml:3:3: <compiler>: bodies are not scaled"),
        (["", "ref=\"10\"", "", "", ""], "arm.xml:7:7: <joint name=\"elbow\">: a position in the written pose"),
        (["", "frictionloss=\"0.1\"", "", "", ""], "arm.xml:7:7: <joint name=\"elbow\">: dry friction"),
        (["", "margin=\"0.1\"", "", "", ""], "arm.xml:7:7: <joint name=\"elbow\">: limits begin at the limit"),
        (["", "solreflimit=\"-100 -1\"", "", "", ""], "arm.xml:7:7: <joint name=\"elbow\">: softness as stiffness"),
        (["", "springdamper=\"0.1 1\"", "", "", ""], "arm.xml:7:7: <joint name=\"elbow\">: `springdamper`"),
        (
            ["", "actuatorfrcrange=\"-1 1\"", "", "", ""],
            "arm.xml:7:7: <joint name=\"elbow\">: the sum of muscle torques",
        ),
        (
            ["", "", "<body><freejoint/><geom size=\"0.01\" contype=\"0\" conaffinity=\"0\"/></body>", "", ""],
            "arm.xml:11:13: <joint>: free and ball joints",
        ),
        (["", "", "<body gravcomp=\"1\"/>", "", ""], "arm.xml:11:7: <body>: compensated weight"),
        (
            [
                "",
                "",
                "<geom type=\"sphere\" size=\"0.01\" shellinertia=\"true\" contype=\"0\" conaffinity=\"0\"/>",
                "",
                "",
            ],
            "arm.xml:11:7: <geom>: mass of meshes and of shells",
        ),
        (["", "", "", "range=\"0 1\"", ""], "arm.xml:14:11: <tendon name=\"BIC\">: limits of tendons"),
        (["", "", "", "stiffness=\"10\"", ""], "arm.xml:14:11: <tendon name=\"BIC\">: springs of tendons"),
        (["", "", "", "", "forcerange=\"-1 0\""], "arm.xml:15:13: <actuator name=\"BIC\">: limits of muscle force"),
        (["", "", "", "", "gear=\"2\""], "arm.xml:15:13: <actuator name=\"BIC\">: a muscle pulls its tendon as it is"),
        (
            ["<equality><weld body1=\"humerus\"/></equality>", "", "", "", ""],
            "arm.xml:3:13: <weld>: of equalities only those of joints",
        ),
        (
            ["<actuator><motor joint=\"elbow\"/></actuator>", "", "", "", ""],
            "arm.xml:3:13: <actuator>: actuators other than muscles",
        ),
    ] {
        let all = told(parts);
        assert!(all.iter().any(|one| one.starts_with(start)), "{start}: {all:?}");
    }
    let text = arm([""; 5]).replace("lengthrange=\"0.7 1.1\" ", "");
    let [one] = &from_mjcf(&read(&text), &options("tip", "humerus")).unwrap_err()[..] else { panic!("one is missing") };
    assert!(one.to_string().contains("its `lengthrange` is not computed; let MuJoCo load"), "{one}");
    let text = arm([""; 5]).replace(
        "<site site=\"insertion\"/></spatial>",
        "<pulley divisor=\"2\"/><site site=\"origin\"/><site site=\"insertion\"/></spatial>",
    );
    let [one] = &from_mjcf(&read(&text), &options("tip", "humerus")).unwrap_err()[..] else { panic!("one branch") };
    assert!(one.to_string().contains("<pulley>: branches of tendons"), "{one}");
}

#[test]
fn parts_that_may_touch_are_refused_unless_they_need_not() {
    let hand = |bits: &str, more: &str| {
        let body = format!(r#"<body name="hand"><joint axis="1 0 0"/><geom name="palm" size="0.02" {bits}/></body>"#);
        arm(["", "", &body, "", ""])
            .replace("<worldbody>", &format!("{more}<worldbody><geom name=\"table\" type=\"plane\" size=\"1 1 1\"/>"))
    };
    let touching = |text: &str| from_mjcf(&read(text), &options("tip", "humerus")).err().map(|all| all[0].to_string());
    let refused = touching(&hand("", "")).unwrap();
    assert_eq!(
        refused,
        "arm.xml:4:14: <geom name=\"table\">: it may touch `palm`, which is not simulated; let parts pass through each other (`--without-contacts`, or `<option><flag contact=\"disable\"/></option>`)"
    );
    // By bits, by name, by the whole, and by who asks.
    assert_eq!(touching(&hand("contype=\"0\" conaffinity=\"2\"", "")), None);
    assert_eq!(touching(&hand("", "<contact><exclude body1=\"world\" body2=\"hand\"/></contact>")), None);
    assert_eq!(touching(&hand("", "<option><flag contact=\"disable\"/></option>")), None);
    let options = ImportOptions { without_contacts: true, ..options("tip", "humerus") };
    assert!(from_mjcf(&read(&hand("", "")), &options).is_ok());
    // A pair that is asked for touches whatever its bits say; parent and child do not by themselves.
    let none = "contype=\"0\" conaffinity=\"0\"";
    let pair = "<contact><pair geom1=\"palm\" geom2=\"bone\"/></contact>";
    assert!(touching(&hand(none, pair)).unwrap().contains("`palm`"));
    let near = hand("contype=\"2\" conaffinity=\"2\"", "").replace(
        "size=\"0.02 0.1\" contype=\"0\" conaffinity=\"0\"",
        "size=\"0.02 0.1\" contype=\"2\" conaffinity=\"2\"",
    );
    assert_eq!(touching(&near), None);
    let unfiltered = near.replace("<worldbody>", "<option><flag filterparent=\"disable\"/></option><worldbody>");
    assert!(touching(&unfiltered).unwrap().contains("`palm`"));
}

#[test]
fn what_has_no_name_gets_one_and_what_has_no_part_is_counted() {
    let body = r#"<body><joint axis="1 0 0"/><geom size="0.02" contype="0" conaffinity="0"/><site/><camera/></body>"#;
    let text = arm(["<asset><material name=\"bone\"/></asset>", "", body, "", ""]);
    let mjcf = read(&text);
    assert_eq!(unused(&mjcf), [("cameras", 1), ("materials", 1)]);
    let all = from_mjcf(&mjcf, &options("tip", "humerus")).unwrap();
    assert_eq!((&*all.bodies[1].name, &*all.joints[1].name, &*all.sites[3].name), ("body3", "joint2", "site4"));
    // A ball about the fingertip is what presses.
    let body = r#"<geom name="pad" size="0.008" pos="0 0 -0.12" margin="0.001"/>"#;
    let pressing = import(["", "", body, "", ""]).unwrap();
    assert_eq!(pressing.geoms.len(), 1);
    assert_eq!((&*pressing.geoms[0].name, pressing.geoms[0].margin), ("pad", 0.001));
}
