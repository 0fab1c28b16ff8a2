//! MJCF in: the very same model comes back, MuJoCo's rules hold, and what cannot be simulated is refused by name.

use std::collections::BTreeMap;

use myo_mjcf::{Limits, Mjcf, read_from};
use myo_model::description::{
    Connection, Contact, Joint, JointKind, Landmarks, PathElement, Pulley, Softness, TendonLimit, Weld, WrapShape,
};
use myo_model::import::{ImportOptions, Unsupported, from_mjcf, unused};
use myo_model::mjcf::{MjcfOptions, to_mjcf};
use myo_model::{Model, ModelDescription, builtin, builtin_names};

fn read(text: &str) -> Mjcf {
    let files = BTreeMap::from([("arm.xml".to_owned(), text.to_owned())]);
    read_from(&files, "arm.xml", Limits::default()).unwrap()
}

fn options(fingertip: &str, shoulder: &str) -> ImportOptions {
    let landmarks = Landmarks::new(fingertip, shoulder);
    ImportOptions::new(landmarks)
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
        let mut options = options(site, &model.bodies[model.shoulder_body].name);
        let site = |&(ref finger, site): &(String, usize)| (finger.clone(), model.sites[site].name.clone());
        options.landmarks.fingers = model.fingers.iter().map(site).collect();
        let back = from_mjcf(&read(&text), &options).unwrap();
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
        for (own, geom) in model.geoms.iter().zip(&mut back.geoms) {
            assert!(own.quat.angle_to(&geom.quat) < 1e-12, "{name}: {}", own.name);
            geom.quat = own.quat;
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

/// A body with this joint.
fn hung(joint: &str) -> String {
    format!("<body>{joint}<geom size=\"0.01\" contype=\"0\" conaffinity=\"0\"/></body>")
}

#[test]
fn what_cannot_be_simulated_is_refused_by_name_and_place() {
    let told = |parts| import(parts).unwrap_err().iter().map(ToString::to_string).collect::<Vec<_>>();
    for (parts, start) in [
        (
            ["<option integrator=\"RK4\"/>", "", "", "", ""],
            "arm.xml:3:3: <option>: of integrators only `Euler`, `implicit` and `implicitfast`",
        ),
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
            ["", "", &hung("<joint type=\"ball\" range=\"0 30\"/>"), "", ""],
            "arm.xml:11:13: <joint>: limits of ball joints (`range`)",
        ),
        (
            ["", "", &hung("<joint type=\"ball\" stiffness=\"1\"/>"), "", ""],
            "arm.xml:11:13: <joint>: springs of ball and",
        ),
        (["", "", &hung("<freejoint align=\"true\"/>"), "", ""], "arm.xml:11:13: <joint>: a body's frame is not moved"),
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
        (
            ["", "", "", "range=\"0 1\" solreflimit=\"-100 -1\"", ""],
            "arm.xml:14:11: <tendon name=\"BIC\">: softness as stiffness",
        ),
        (
            [
                "<tendon><spatial name=\"rope\" range=\"0 1\"><site site=\"origin\"/><site site=\"tip\"/></spatial></tendon>",
                "",
                "",
                "",
                "",
            ],
            "arm.xml:3:11: <tendon name=\"rope\">: limits (`limited`, `range`) of tendons that no muscle pulls",
        ),
        (["", "", "", "stiffness=\"10\"", ""], "arm.xml:14:11: <tendon name=\"BIC\">: springs of tendons"),
        (["", "", "", "", "forcerange=\"-1 0\""], "arm.xml:15:13: <actuator name=\"BIC\">: limits of muscle force"),
        (["", "", "", "", "gear=\"2\""], "arm.xml:15:13: <actuator name=\"BIC\">: a muscle pulls its tendon as it is"),
        (
            ["<equality><tendon tendon1=\"BIC\"/></equality>", "", "", "", ""],
            "arm.xml:3:13: <tendon>: equalities of tendons are not simulated",
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
}

#[test]
fn bodies_are_pinned_and_welded() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let of = |equalities: &str| {
        let body = r#"<body name="hand" pos="0 0 0.5" quat="1 0 0 1"><joint axis="1 0 0"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
          <site name="palm" pos="0.1 0 0" quat="1 0 0 1"/></body>"#;
        let more = format!("<equality>{equalities}</equality>");
        let all = from_mjcf(&read(&arm([&more, "", body, "", ""])), &options("tip", "humerus")).unwrap();
        let back = to_mjcf(&Model::new(&all).unwrap(), &MjcfOptions::default());
        let back = from_mjcf(&read(&back), &options("tip", "humerus")).unwrap().connections;
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        for (own, back) in all.connections.iter().zip(&back) {
            assert_eq!((&own.bodies, own.softness), (&back.bodies, back.softness));
            assert!(close(own.anchors.as_flattened(), back.anchors.as_flattened()), "{own:?} {back:?}");
            let quat = |connection: &Connection| {
                connection.weld.map_or([0.0; 5], |Weld { quat: [w, x, y, z], torque_scale }| [w, x, y, z, torque_scale])
            };
            assert!(close(&quat(own), &quat(back)), "{own:?} {back:?}");
        }
        assert_eq!(
            ModelDescription::from_yaml(&all.to_yaml().unwrap(), "arm.yaml").unwrap().connections.len(),
            back.len()
        );
        all.connections
    };
    // A point of the first body, where the second has it in the pose of the file.
    let [pinned] = &of("<connect body1=\"humerus\" body2=\"hand\" anchor=\"0.1 0.2 0.5\" solref=\"0.1 0.5\"/>")[..]
    else {
        panic!()
    };
    assert_eq!((&pinned.bodies, pinned.weld), (&["humerus", "hand"].map(String::from), None));
    assert!((pinned.anchors[1][0] - 0.2).abs() < 1e-12 && (pinned.anchors[1][1] + 0.1).abs() < 1e-12, "{pinned:?}");
    assert_eq!(pinned.softness.solref, [0.1, 0.5]);
    // Without a second body it is the world.
    let [welded] = &of("<weld body1=\"humerus\" anchor=\"0 0 1\"/>")[..] else { panic!() };
    assert_eq!((&welded.bodies[1], welded.anchors), (&"world".to_owned(), [[0.0; 3], [0.0, 0.0, 1.0]]));
    assert_eq!(welded.weld, Some(Weld { quat: [1.0, 0.0, 0.0, 0.0], torque_scale: 1.0 }));
    // A pose that is told holds as it is; one of sites is that of the bodies then.
    let [told] =
        &of("<weld body1=\"humerus\" body2=\"hand\" anchor=\"0 0 1\" relpose=\"1 2 3 0 0 2 0\" torquescale=\"0.2\"/>")
            [..]
    else {
        panic!()
    };
    assert_eq!(told.anchors, [[1.0, 2.0, 3.0], [0.0, 0.0, 1.0]]);
    assert_eq!(told.weld, Some(Weld { quat: [0.0, 0.0, 1.0, 0.0], torque_scale: 0.2 }));
    let [sites] = &of("<weld site1=\"tip\" site2=\"palm\"/>")[..] else { panic!() };
    assert_eq!(sites.anchors, [[0.0, 0.0, -0.12], [0.1, 0.0, 0.0]]);
    let Weld { quat: [w, x, y, z], .. } = sites.weld.unwrap();
    assert!((w - half).abs() < 1e-12 && (z + half).abs() < 1e-12 && (x, y) == (0.0, 0.0), "{sites:?}");
    assert_eq!(of("<connect body1=\"humerus\" anchor=\"0 0 0\" active=\"false\"/>"), []);
}

#[test]
fn tendons_divide_and_are_limited() {
    let text = arm(["", "", "", "range=\"0.1 0.4\" margin=\"0.01\" solimplimit=\"0.8\"", ""])
        .replace(
            "<site site=\"insertion\"/></spatial>",
            "<site site=\"insertion\"/><pulley divisor=\"2\"/><site site=\"origin\"/><site site=\"tip\"/></spatial>",
        )
        .replace(
            "</actuator>",
            "<muscle name=\"BRA\" tendon=\"BIC\" lengthrange=\"0.7 1.1\" force=\"300\"/></actuator>",
        );
    let all = from_mjcf(&read(&text), &options("tip", "humerus")).unwrap();
    let [first, second] = &all.muscles[..] else { panic!("two muscles") };
    let site = |name: &str| PathElement::from(name);
    let pulley = PathElement::Pulley(Pulley { pulley: 2.0 });
    assert_eq!(first.path, [site("origin"), site("insertion"), pulley, site("origin"), site("tip")]);
    let softness = Softness { solref: [0.02, 1.0], solimp: [0.8, 0.95, 0.001, 0.5, 2.0] };
    assert_eq!(first.limit, Some(TendonLimit { range: [0.1, 0.4], margin: 0.01, softness }));
    // The same tendon is not limited twice.
    assert_eq!((&second.path, second.limit), (&first.path, None));
    let model = Model::new(&all).unwrap();
    let stretches: Vec<_> =
        model.muscles[0].stretches().map(|(from, pulley)| (from, pulley.map(|pulley| pulley.divisor))).collect();
    assert_eq!(stretches, [(0, None), (2, Some(2.0))]);
    // They go out as they came in, to a file of either kind.
    let back = from_mjcf(&read(&to_mjcf(&model, &MjcfOptions::default())), &options("tip", "humerus")).unwrap();
    assert_eq!(back.muscles[0], *first);
    assert_eq!(ModelDescription::from_yaml(&all.to_yaml().unwrap(), "arm.yaml").unwrap().muscles, all.muscles);
    let unlimited = text.replace("<compiler", "<option><flag limit=\"disable\"/></option><compiler");
    assert_eq!(from_mjcf(&read(&unlimited), &options("tip", "humerus")).unwrap().muscles[0].limit, None);
}

/// An arm whose hand has a palm with these bits, beside a table of this height (m), with more in the file.
fn hand(height: f64, bits: &str, more: &str) -> String {
    let body = format!(r#"<body name="hand"><joint axis="1 0 0"/><geom name="palm" size="0.02" {bits}/></body>"#);
    let table = format!(r#"<geom name="table" type="box" size="1 1 0.1" pos="0 0 {}"/>"#, height - 0.1);
    arm(["", "", &body, "", ""]).replace("<worldbody>", &format!("{more}<worldbody>{table}"))
}

fn contacts(text: &str) -> Result<Vec<[String; 2]>, String> {
    let all = from_mjcf(&read(text), &options("tip", "humerus")).map_err(|all| all[0].to_string())?;
    Model::new(&all).map_err(|error| error.to_string())?;
    Ok(all.contacts.into_iter().map(|contact| contact.geoms).collect())
}

/// Of a geom that begins to press only when it is deeper: not simulated.
const GAP: &str = "gap=\"0.01\"";

#[test]
fn parts_that_may_touch_are_refused_unless_they_need_not() {
    let none = Ok(vec![]);
    assert_eq!(
        contacts(&hand(0.99, GAP, "")).unwrap_err(),
        "arm.xml:4:14: <geom name=\"table\">: it may touch `palm`: of contacts only those with neither `gap` nor `adhesion`, nor `solreffriction` in elliptic cones, are simulated; let parts pass through each other (`--without-contacts`, or `<option><flag contact=\"disable\"/></option>`)"
    );
    // By distance, bits, names, the whole, and by who asks.
    assert_eq!(contacts(&hand(0.9, GAP, "")), none);
    assert_eq!(contacts(&hand(0.99, "contype=\"0\" conaffinity=\"2\" gap=\"0.01\"", "")), none);
    assert_eq!(contacts(&hand(0.99, GAP, "<contact><exclude body1=\"world\" body2=\"hand\"/></contact>")), none);
    assert_eq!(contacts(&hand(0.99, GAP, "<option><flag contact=\"disable\"/></option>")), none);
    let options = ImportOptions { without_contacts: true, ..options("tip", "humerus") };
    assert!(from_mjcf(&read(&hand(0.99, GAP, "")), &options).is_ok());
    // By limits, and 0.35 rad beyond: at 130 and 20 degrees the palm is 0.83 m above the ground; by one limit more it is not known.
    let held = |height: f64, limits: &str| {
        let text = hand(height, GAP, "").replace("<body name=\"hand\">", "<body name=\"hand\" pos=\"0 0 0.2\">");
        contacts(&text.replace("<joint axis=\"1 0 0\"/>", &format!("<joint axis=\"1 0 0\" {limits}/>")))
    };
    assert_eq!(held(0.8, "range=\"-5 5\""), none);
    assert!(held(0.8, "range=\"-5 5\" solreflimit=\"0.5 1\"").unwrap_err().contains("it may touch `palm`"));
    assert!(held(0.82, "range=\"-5 5\"").unwrap_err().contains("it may touch `palm`"));
    assert!(held(0.8, "").unwrap_err().contains("it may touch `palm`"));
    // What is fitted to a mesh has its size from there.
    let asset = r#"<asset><mesh name="hull" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>"#;
    let fitted = hand(0.5, GAP, asset).replace("size=\"0.02\"", "type=\"capsule\" mesh=\"hull\" mass=\"0\"");
    let all = from_mjcf(&read(&fitted), &self::options("tip", "humerus")).unwrap_err();
    assert!(all.iter().any(|one| one.to_string().contains("it may touch `palm`")), "{all:?}");
    // What hangs on a slide may be anywhere.
    let sliding = hand(0.0, GAP, "").replace("<joint axis=\"1 0 0\"/>", "<joint type=\"slide\" axis=\"1 0 0\"/>");
    assert!(contacts(&sliding).unwrap_err().contains("it may touch `palm`"));
    let posts = hand(0.99, "type=\"cylinder\"", "")
        .replace("type=\"box\" size=\"1 1 0.1\" pos=\"0 0 0.89\"", "type=\"cylinder\" size=\"1 0.1\" pos=\"0 0 0.89\"")
        .replace("size=\"0.02\"", "size=\"0.02 0.02\"");
    let refused = contacts(&posts).unwrap_err();
    assert!(refused.contains("contact of cylinder and cylinder is not simulated"), "{refused}");
}

#[test]
fn parts_that_touch_are_a_contact() {
    assert_eq!(contacts(&hand(0.99, "", "")), Ok(vec![["table", "palm"].map(String::from)]));
    let both = vec![["palm", "bone"].map(String::from)];
    // A pair that is asked for touches whatever its bits say; parent and child do not by themselves.
    let none = "contype=\"0\" conaffinity=\"0\"";
    let pair = "<contact><pair geom1=\"palm\" geom2=\"bone\"/></contact>";
    assert_eq!(contacts(&hand(0.0, none, pair)), Ok(both.clone()));
    let near = hand(0.0, "contype=\"2\" conaffinity=\"2\" friction=\"0.4\" margin=\"0.002\"", "").replace(
        "size=\"0.02 0.1\" contype=\"0\" conaffinity=\"0\"",
        "size=\"0.02 0.1\" contype=\"2\" conaffinity=\"2\" margin=\"0.001\" solmix=\"3\" solref=\"0.04 1\"",
    );
    assert_eq!(contacts(&near), Ok(vec![]));
    let unfiltered = near.replace("<worldbody>", "<option><flag filterparent=\"disable\"/></option><worldbody>");
    assert_eq!(contacts(&unfiltered), Ok(vec![["bone", "palm"].map(String::from)]));
    // Margins add up, the greater friction holds, softness is mixed by its weights.
    let mixed = from_mjcf(&read(&unfiltered), &options("tip", "humerus")).unwrap();
    let contact = &mixed.contacts[0];
    assert_eq!((contact.margin, contact.friction), (0.003, 1.0));
    assert!((contact.softness.solref[0] - 0.035).abs() < 1e-15, "{:?}", contact.softness);
    // Who has the higher priority decides alone.
    let decided = unfiltered.replace("friction=\"0.4\"", "friction=\"0.4\" priority=\"1\"");
    let contact = &from_mjcf(&read(&decided), &options("tip", "humerus")).unwrap().contacts[0];
    assert_eq!((contact.margin, contact.friction, contact.softness.solref), (0.003, 0.4, [0.02, 1.0]));
    // Without friction.
    let slippery = unfiltered.replace("friction=\"0.4\"", "condim=\"1\"").replace("margin=\"0.001\"", "condim=\"1\"");
    let sliding = from_mjcf(&read(&slippery), &options("tip", "humerus")).unwrap();
    assert_eq!(sliding.contacts[0].friction, 0.0);
    let back = to_mjcf(&Model::new(&sliding).unwrap(), &MjcfOptions::default());
    assert_eq!(from_mjcf(&read(&back), &options("tip", "humerus")).unwrap().contacts, sliding.contacts);
    let resists = |text: &str| {
        let all = from_mjcf(&read(text), &options("tip", "humerus")).unwrap();
        let back = to_mjcf(&Model::new(&all).unwrap(), &MjcfOptions::default());
        assert_eq!(from_mjcf(&read(&back), &options("tip", "humerus")).unwrap().contacts, all.contacts);
        assert_eq!(ModelDescription::from_yaml(&all.to_yaml().unwrap(), "arm.yaml").unwrap().contacts, all.contacts);
        let [Contact { friction, friction_across, torsional, rolling, .. }] = all.contacts[..] else { panic!("one") };
        (friction, friction_across, torsional, rolling)
    };
    let across = hand(0.0, none, "<contact><pair geom1=\"bone\" geom2=\"palm\" friction=\"0.3 0.2\"/></contact>");
    assert_eq!(resists(&across), (0.3, Some(0.2), 0.0, [0.0; 2]));
    let twisting = slippery.replace("condim=\"1\"", "condim=\"4\"");
    assert_eq!(resists(&twisting), (1.0, None, 0.005, [0.0; 2]));
    let rolling = slippery.replace("condim=\"1\"", "condim=\"6\" friction=\"0.4 0.02 0.03\"");
    assert_eq!(resists(&rolling), (0.4, None, 0.02, [0.03; 2]));
    let odd = slippery.replace("condim=\"1\"", "condim=\"2\"");
    assert!(contacts(&odd).unwrap_err().contains("`condim` is 2; there are 1, 3, 4 and 6"), "{odd}");
}

/// A body that falls on a floor or a table, with an arm on a ball joint.
const FALLING: &str = r#"<mujoco><compiler autolimits="true"/><worldbody>
  <geom name="floor" type="plane" size="1 1 1" pos="0 0 -1" quat="0.9 0.1 0 0"/>
  <geom name="table" type="cylinder" size="0.5 0.2"/>
  <body name="trunk" pos="0.1 0.2 1" quat="0.8 0 0.6 0">
    <freejoint name="root"/>
    <geom name="trunk" type="ellipsoid" size="0.1 0.2 0.3" mass="20"/>
    <site name="chest" pos="0.1 0 0.1"/>
    <body name="arm" pos="0 0.2 0.2">
      <joint name="shoulder" type="ball" pos="0 0 0.01" damping="0.3" armature="0.01"/>
      <geom name="arm" type="capsule" size="0.04 0.15" pos="0 0 -0.15" mass="2" friction="0.5"/>
      <site name="tip" pos="0 0 -0.3"/>
      <body name="finger"><joint name="knuckle" axis="0 1 0" range="0 90"/><geom name="finger" size="0.01" mass="0.1"/></body>
    </body>
  </body></worldbody>
  <equality><joint joint1="knuckle" polycoef="0.2 0 0 0 0"/></equality>
  <tendon><spatial name="pull"><site site="chest"/><site site="tip"/></spatial></tendon>
  <actuator><muscle name="pull" tendon="pull" lengthrange="0.1 0.9" force="100"/></actuator></mujoco>"#;

#[test]
fn bodies_fall_freely_on_floors_and_tables() {
    let all = from_mjcf(&read(FALLING), &options("tip", "arm")).unwrap();
    let model = Model::new(&all).unwrap();
    let kinds: Vec<JointKind> = model.joints.iter().map(|joint| joint.kind).collect();
    assert_eq!(kinds, [JointKind::Free, JointKind::Ball, JointKind::Hinge]);
    assert_eq!(kinds.iter().map(|kind| kind.sizes()).fold([0, 0], |[a, b], [c, d]| [a + c, b + d]), [12, 10]);
    assert_eq!((model.joints[1].damping, model.joints[1].armature), (0.3, 0.01));
    // All three bodies may come to both; the finger is a child of the arm, but touches the trunk.
    assert_eq!(all.contacts.len(), 7, "{:?}", all.contacts);
    // It goes out as it came in, to a file of either kind.
    let back = from_mjcf(&read(&to_mjcf(&model, &MjcfOptions::default())), &options("tip", "arm")).unwrap();
    assert_eq!((&back.joints, &back.contacts), (&all.joints, &all.contacts));
    assert_eq!(ModelDescription::from_yaml(&all.to_yaml().unwrap(), "falling.yaml").unwrap(), all);
    // Locked joints are none, nor are those that follow them.
    let locked = |names: &[&str]| {
        let locked = names.iter().map(|&name| name.into()).collect();
        from_mjcf(&read(FALLING), &ImportOptions { locked, ..options("tip", "arm") })
    };
    let held = locked(&["root", "shoulder"]).unwrap();
    assert_eq!((held.joints.len(), held.couplings.len()), (1, 1));
    // What stands still touches nothing that does: the finger alone moves, beside what it hangs on.
    assert!(held.contacts.iter().all(|contact| contact.geoms.contains(&"finger".into())), "{:?}", held.contacts);
    assert_eq!(locked(&["knuckle"]).unwrap().couplings, []);
    let unknown = locked(&["shulder"]).unwrap_err();
    assert_eq!(
        unknown[0].to_string(),
        "arm.xml:1:1: <worldbody>: there is no joint `shulder` to lock; did you mean `shoulder`?"
    );
}

/// A tetrahedron of this name, with more of its own.
fn tetrahedron(name: &str, more: &str) -> String {
    let [vertex, face] = [".1 0 0 0 .1 0 0 0 .1 0 0 0", "0 1 2 1 0 3 2 1 3 0 2 3"];
    format!("<mesh name=\"{name}\" vertex=\"{vertex}\" face=\"{face}\" {more}/>")
}

#[test]
fn meshes_that_touch_come_as_convex_hulls() {
    let beside = |mesh: &str, other: &str| {
        let table = format!("<asset>{mesh}</asset><worldbody><geom name=\"table\" {other}/></worldbody>");
        let body = r#"<geom name="rock" type="mesh" mesh="rock" mass="0" pos="0 0 -0.1" quat="0 1 0 0"/>"#;
        from_mjcf(&read(&arm([&table, "", body, "", ""])), &options("tip", "humerus"))
    };
    let plane = r#"type="plane" size="1 1 1" pos="0 0 0.9""#;
    let all = beside(&tetrahedron("rock", ""), plane).unwrap();
    assert_eq!((all.hulls.len(), all.contacts.len()), (1, 1));
    let model = Model::new(&all).unwrap();
    let hull = &model.hulls[0];
    assert_eq!((hull.points.len(), hull.triangles.len(), hull.polygons.len()), (4, 4, 4));
    // The mesh stands about its centre of mass.
    let rock = model.geoms.iter().find(|geom| geom.name == "rock").unwrap();
    let mut corners: Vec<[i32; 3]> = hull
        .points
        .iter()
        .map(|point| (rock.quat * point + rock.pos).map(|x| (1e6 * x).round() as i32).into())
        .collect();
    corners.sort();
    assert_eq!(corners, [[0, -100_000, -100_000], [0, 0, -200_000], [0, 0, -100_000], [100_000, 0, -100_000]]);
    assert!((hull.points.iter().sum::<nalgebra::Vector3<f64>>()).norm() < 1e-9);
    // Files keep all of it, and MuJoCo's have the same corners.
    let yaml = all.to_yaml().unwrap();
    assert_eq!(ModelDescription::from_yaml(&yaml, "arm").unwrap(), all);
    let back = from_mjcf(&read(&to_mjcf(&model, &MjcfOptions::default())), &options("tip", "humerus")).unwrap();
    assert_eq!((back.hulls.len(), back.contacts.clone()), (1, all.contacts.clone()));
    // All other shapes touch meshes, too.
    for other in [
        "size=\"0.1\"",
        "type=\"box\" size=\".1 .2 .3\"",
        "type=\"cylinder\" size=\"1 .1\"",
        "type=\"capsule\" size=\".1 .2\"",
        "type=\"ellipsoid\" size=\".1 .2 .3\"",
    ] {
        assert_eq!(beside(&tetrahedron("rock", ""), &format!("{other} pos=\"0 0 0.8\"")).unwrap().contacts.len(), 1);
    }
    let refused = |mesh: &str, other: &str| {
        let all = beside(mesh, other).unwrap_err();
        assert_eq!(all.len(), 1, "{all:?}");
        all[0].to_string()
    };
    let why = |mesh: &str, why: &str| {
        let told = refused(mesh, plane);
        assert!(told.contains(&format!("it may touch `rock`: the mesh of `rock`: {why}; let parts pass")), "{told}");
    };
    why(&tetrahedron("rock", "maxhullvert=\"10\""), "`maxhullvert` is not known");
    why(
        &tetrahedron("rock", "inertia=\"exact\""),
        "its frame is not that of `inertia=\"legacy\"`, the only one that is known",
    );
    why("<mesh name=\"rock\" vertex=\"0 0 0 1 0 0 0 1 0\" face=\"0 1 2\"/>", "it has fewer than four different points");
    why("<mesh name=\"rock\" vertex=\"0 0 0 1 0 0 0 1 0 1 1 0\" face=\"0 1 2 1 2 3\"/>", "it is flat, or nothing");
    why("<mesh name=\"rock\" file=\"rock.stl\"/>", "rock.stl is not read: the model is no file of a folder");
}

#[test]
fn what_has_no_name_gets_one_and_what_has_no_part_is_counted() {
    let body = r#"<body><joint axis="1 0 0"/><geom size="0.02" contype="0" conaffinity="0"/><site/><camera/></body>"#;
    let text = arm(["<asset><material name=\"bone\"/></asset>", "", body, "", ""]);
    let mjcf = read(&text);
    let all = from_mjcf(&mjcf, &options("tip", "humerus")).unwrap();
    assert_eq!(unused(&mjcf, &all), [("cameras".into(), 1), ("materials".into(), 1)]);
    assert_eq!((&*all.bodies[1].name, &*all.joints[1].name, &*all.sites[3].name), ("body3", "joint2", "site4"));
    // A ball about the fingertip is what presses.
    let body = r#"<geom name="pad" size="0.008" pos="0 0 -0.12" margin="0.001"/>"#;
    let pressing = import(["", "", body, "", ""]).unwrap();
    assert_eq!(pressing.geoms.len(), 1);
    assert_eq!((&*pressing.geoms[0].name, pressing.geoms[0].margin), ("pad", 0.001));
}
