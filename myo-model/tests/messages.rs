//! What a person is told when a model is wrong.

use myo_model::description::{
    Connection, Contact, Geom, Hull, Joint, JointKind, Look, Over, PathElement, Pulley, Shape, Softness, TendonLimit,
    Weld, Wrap, WrapShape,
};
use myo_model::{Model, ModelDescription, builtin};

const ARM: &str = include_str!("../models/mobl-arms.yaml");

/// The message for the built-in arm's file with one piece of text replaced.
fn check_text(piece: &str, replacement: &str, message: &str) {
    assert!(ARM.contains(piece), "{piece}");
    let error = ModelDescription::from_yaml(&ARM.replacen(piece, replacement, 1), "arm.yaml").unwrap_err();
    assert_eq!(error.to_string(), message);
}

/// The message for the built-in arm's description after an edit.
fn check(edit: impl FnOnce(&mut ModelDescription), message: &str) {
    let mut arm = builtin("mobl-arms").unwrap();
    edit(&mut arm);
    assert_eq!(Model::new(&arm).unwrap_err().to_string(), message);
}

#[test]
fn text_errors_point_at_line_and_column() {
    check_text("mass: 8.01418", "mass: -8.01418", "arm.yaml:13:111: `bodies[1].mass` is -8.01418, lower than 0");
    check_text("mass: 8.01418", "mass: heavy", "arm.yaml:13:111: `heavy` is not a number");
    check_text("mass: 8.01418, ", "", "arm.yaml:13:191: missing field `mass`");
    check_text("version: 1", "version: -1", "arm.yaml:4:10: `-1` is not a u32");
    check_text("timestep: 0.002", "timestep: 2.0", "arm.yaml:8:21: `options.timestep` is 2.0, greater than 0.02");
    check_text(
        "com: [0.0, 0.0, 1.0]",
        "com: [0.0, 0.0]",
        "arm.yaml:12:73: invalid length 2, expected an array of length 3",
    );
    check_text(
        "stiffness: 2.0",
        "stiffness: 2.0, stiffness: 3.0",
        "arm.yaml:34:127: duplicate mapping key: stiffness not allowed here",
    );
    check_text("joints:", "joints", "arm.yaml:32:1: simple key expected ':'");
    check_text(
        "fvmax: 1.4}",
        "fvmax: 0.4}",
        "arm.yaml:187:24: `muscles[0].gain.fvmax` is lower than 1 (25 more like this)",
    );
    check_text("*passive, force: 1103.5}", "*passiv, force: 1103.5}", "arm.yaml:195:16: reference to unknown value");
}

#[test]
fn unknown_keys_come_with_the_nearest_valid_ones() {
    check_text("mass: 8.01418", "mas: 8.01418", "arm.yaml:13:105: unknown key `mas`; did you mean `mass`?");
    check_text(
        "kind: hinge",
        "kind: screw",
        "arm.yaml:33:37: unknown value `screw`; valid are `hinge`, `slide`, `ball`, `free`",
    );
    check_text(
        "length_range: [0.161563",
        "lengthrange: [0.161563",
        "arm.yaml:193:5: unknown key `lengthrange`; did you mean `length_range`?",
    );
}

#[test]
fn a_file_without_content_is_refused() {
    for text in ["", "# nothing\n", "version: 1\n", "[]", "\u{feff}", "{", "a: &a [*a]"] {
        assert!(ModelDescription::from_yaml(text, "arm.yaml").is_err(), "{text}");
    }
}

#[test]
fn a_file_cut_off_anywhere_is_refused_with_its_place_or_read_as_far_as_it_goes() {
    let (whole, mut refused) = (builtin("mobl-arms").unwrap(), 0);
    for end in (0..ARM.len()).step_by(61) {
        match ModelDescription::from_yaml(&ARM[..end], "arm.yaml") {
            Ok(description) => {
                // Only the muscles stand so late that all else is there; what was read before them is right.
                assert_eq!(description.bodies, whole.bodies, "cut at {end}");
                assert!(description.muscles.len() <= whole.muscles.len(), "cut at {end}");
            }
            Err(error) => {
                assert!(error.to_string().starts_with("arm.yaml:"), "cut at {end}: {error}");
                refused += 1;
            }
        }
    }
    assert!(refused > 100, "{refused}");
}

#[test]
fn unknown_names_come_with_the_nearest_valid_ones() {
    let unknown = builtin("mobl_arm").unwrap_err().to_string();
    assert_eq!(unknown, "there is no built-in model `mobl_arm`; did you mean `mobl-arms`?");
    check(
        |arm| arm.joints[14].body = "humeros".into(),
        "joint `shoulder_rot`: unknown body `humeros`; did you mean `humerus`?",
    );
    check(|arm| arm.bodies[2].parent = "torax".into(), "body `clavicle`: unknown body `torax`; did you mean `thorax`?");
    check(
        |arm| arm.couplings[0].independent = Some("shoulder_elf".into()),
        "coupling of joint `sternoclavicular_r2`: unknown joint `shoulder_elf`; did you mean `shoulder_elv`, `shoulder_rot` or `shoulder1_r2`?",
    );
    check(
        |arm| arm.muscles[0].path[1] = "DELT1-P22".into(),
        "muscle `DELT1`: unknown site `DELT1-P22`; did you mean `DELT1-P2`, `DELT1-P4` or `DELT2-P2`?",
    );
    check(
        |arm| arm.landmarks.fingertip = "finger".into(),
        "landmarks: unknown site `finger`; did you mean `fingertip`?",
    );
    let fingers = |names: &[&str]| names.iter().map(|&name| (name.to_owned(), "fingertip".to_owned())).collect();
    check(
        |arm| arm.landmarks.fingers = [("thumb".to_owned(), "finger".to_owned())].into(),
        "landmarks: unknown site `finger`; did you mean `fingertip`?",
    );
    check(
        |arm| arm.landmarks.fingers = fingers(&["a", "b", "c", "d", "e"]),
        "landmarks: `fingers` names 5 fingers beside the fingertip; at most 4 are followed, leave out the others",
    );
    check(
        |arm| arm.landmarks.fingers = fingers(&["thumb"]),
        "landmarks: site `fingertip` is the tip of `fingertip` and of `thumb`; every finger has its own",
    );
    check(
        |arm| arm.landmarks.fingers = fingers(&["fingertip"]),
        "landmarks: a finger is named `fingertip`, which tasks take for what points; choose another name, such as `thumb`",
    );
}

#[test]
fn names_must_be_unique_and_free() {
    check(
        |arm| arm.sites[3].name = arm.sites[4].name.clone(),
        "site `PECM3-P4` is declared twice; names of one kind must differ",
    );
    check(
        |arm| arm.muscles[1].name = "DELT1".into(),
        "muscle `DELT1` is declared twice; names of one kind must differ",
    );
    check(|arm| arm.joints[2].name.clear(), "joint number 3 has an empty name; every element needs one");
    check(
        |arm| arm.bodies[0].name = "world".into(),
        "a body is named `world`, which is reserved for the fixed root; choose another name",
    );
}

#[test]
fn numbers_must_make_sense() {
    check(|arm| arm.version = 7, "the model has format version 7, but this program reads version 1");
    check(|arm| arm.options.timestep = 0.0, "options: `timestep` is 0 s; it must be from 0.00001 to 0.02 s");
    check(|arm| arm.options.gravity[2] = f64::NAN, "options: `gravity` is NaN; a finite number is needed");
    check(|arm| arm.bodies[8].mass = -1.0, "body `humerus`: `mass` is -1 kg; it must be 0 or more");
    check(|arm| arm.bodies[8].pos[0] = f64::INFINITY, "body `humerus`: `pos` is inf; a finite number is needed");
    check(|arm| arm.bodies[8].quat = [0.0; 4], "body `humerus`: `quat` has length zero; a direction is needed");
    check(
        |arm| arm.bodies[8].inertia = [3.0, 1.0, 1.0],
        "body `humerus`: principal moments 3 1 1 kg m^2 belong to no solid; each must be at most the sum of the others",
    );
    check(
        |arm| arm.bodies[3].mass = 0.0,
        "body `clavphant` moves but has no mass; give it some, or weld it to a body that has",
    );
    check(|arm| arm.joints[15].axis = [0.0; 3], "joint `elbow_flexion`: `axis` has length zero; a direction is needed");
    check(
        |arm| arm.joints[15].range = Some([2.0, 0.0]),
        "joint `elbow_flexion`: `range` runs from 2 to 0; the first must be below the second",
    );
    check(|arm| arm.joints[15].damping = -0.5, "joint `elbow_flexion`: `damping` is -0.5; it must be 0 or more");
    check(
        |arm| arm.joints[15].softness.solimp[0] = 1.5,
        "joint `elbow_flexion`: `softness.solimp` is 1.5; it must be between 0 and 1",
    );
    check(
        |arm| arm.muscles[3].parameters.length_range = [0.2, 0.1],
        "muscle `SUPSP`: `length_range` runs from 0.2 to 0.1 m; the first must be below the second",
    );
    check(
        |arm| arm.muscles[3].parameters.gain.lmax = 0.9,
        "muscle `SUPSP`: `lmax` is 0.9; it must be above the optimal length of 1",
    );
    check(
        |arm| arm.sites[7].pos[1] = 136.0,
        "site `LAT1-P4`: `pos` is 136 m; it must be within 10 m; is it in millimetres?",
    );
    check(
        |arm| arm.joints[15].range = Some([0.0, 130.0]),
        "joint `elbow_flexion`: `range` is 130; it must be within 100 rad (or m); is it in degrees?",
    );
    check(
        |arm| arm.joints[15].softness.solimp[4] = 30.0,
        "joint `elbow_flexion`: `softness.solimp` is 30; it must be a power between 1 and 8",
    );
    check(
        |arm| arm.muscles[3].parameters.tau_act = 0.001,
        "muscle `SUPSP`: `tau_act` is 0.001 s; it must be at least the time step, `options.timestep`",
    );
    check(|arm| arm.geoms[0].margin = -0.1, "geom `fingertip`: `margin` is -0.1 m; it must be 0 or more");
}

#[test]
fn elements_must_fit_together() {
    check(
        |arm| arm.joints[0].body = "world".into(),
        "joint `r_z` is on `world`, which stands still; name the body that moves",
    );
    check(
        |arm| arm.bodies[2].parent = "hand".into(),
        "body `clavicle` is its own ancestor; every chain of parents must end at `world`",
    );
    check(
        |arm| arm.couplings[1].dependent = "sternoclavicular_r2".into(),
        "joint `sternoclavicular_r2` is the dependent joint of two couplings; at most one is allowed",
    );
    check(
        |arm| arm.couplings[0].independent = Some("unrotscap_r2".into()),
        "joint `sternoclavicular_r2` follows joint `unrotscap_r2`, which is itself a dependent joint; couple it to a free joint",
    );
    check(
        |arm| (arm.joints[15].kind, arm.joints[15].axis) = (JointKind::Ball, [0.0; 3]),
        "joint `elbow_flexion` is a ball joint, which has no `range`; leave it out",
    );
    check(|arm| arm.joints[0].kind = JointKind::Free, "joint `r_z` is a free joint, which has no `axis`; leave it out");
    let loose = |joint: &mut Joint, kind: JointKind| {
        (joint.kind, joint.axis, joint.pos, joint.range) = (kind, [0.0; 3], [0.0; 3], None);
        (joint.stiffness, joint.spring_ref) = (0.0, 0.0);
    };
    check(
        |arm| loose(&mut arm.joints[15], JointKind::Free),
        "joint `elbow_flexion` is a free joint, but its body hangs on `humerus`; only bodies on `world` move freely",
    );
    check(
        |arm| {
            let mut second = arm.joints[15].clone();
            second.name = "elbow_varus".into();
            loose(&mut arm.joints[15], JointKind::Ball);
            arm.joints.push(second);
        },
        "joint `elbow_varus` follows the ball joint `elbow_flexion` of the same body, which leaves it nothing to do; drop one of them",
    );
    check(
        |arm| loose(&mut arm.joints[0], JointKind::Ball),
        "coupling of joint `r_z`: joint `r_z` is a ball joint; only hinges and slides follow and lead",
    );
    check(|arm| arm.muscles[0].path.truncate(1), "muscle `DELT1`: its path has 1 site(s); at least 2 are needed");
}

/// A muscle of the built-in arm with this path, and a cylinder to run over.
fn check_path(path: Vec<PathElement>, message: &str) {
    check(
        |arm| {
            arm.wraps.push(elbow());
            arm.muscles[0].path = path;
        },
        message,
    );
}

fn elbow() -> Wrap {
    Wrap {
        name: "elbow".into(),
        body: "humerus".into(),
        shape: WrapShape::Cylinder { radius: 0.016, half_length: 0.03 },
        pos: [0.0; 3],
        quat: [1.0, 0.0, 0.0, 0.0],
    }
}

fn over(wrap: &str, side: Option<&str>) -> PathElement {
    PathElement::Over(Over { over: wrap.into(), side: side.map(Into::into) })
}

#[test]
fn wraps_must_stand_between_two_sites() {
    let site = || PathElement::from("DELT1-P2");
    let elbow = || over("elbow", None);
    check_path(
        vec![elbow(), site(), site()],
        "muscle `DELT1`: its path begins with `{over: elbow}`; a site must stand before it and after it",
    );
    check_path(
        vec![site(), site(), elbow()],
        "muscle `DELT1`: its path ends with `{over: elbow}`; a site must stand before it and after it",
    );
    check_path(
        vec![site(), elbow(), elbow(), site()],
        "muscle `DELT1`: `{over: elbow}` and `{over: elbow}` follow each other; put a site between them",
    );
    check_path(vec![site()], "muscle `DELT1`: its path has 1 site(s); at least 2 are needed");
    check_path(vec![site(), over("elbo", None), site()], "muscle `DELT1`: unknown wrap `elbo`; did you mean `elbow`?");
    check_path(
        vec![site(), over("elbow", Some("DELT1-P22")), site()],
        "muscle `DELT1`: unknown site `DELT1-P22`; did you mean `DELT1-P2`, `DELT1-P4` or `DELT2-P2`?",
    );
}

#[test]
fn friction_is_some_or_none() {
    let check_friction = |contact: Contact, message: &str| {
        let contact = Contact { geoms: ["a", "b"].map(String::from), ..contact };
        check(|arm| arm.contacts.push(contact), &format!("contact `a, b`: {message}"));
    };
    let sliding = |friction: f64| Contact { friction, ..Contact::default() };
    check_friction(sliding(-0.1), "`friction` is -0.1; it must be at least 0.00001, or 0 for none");
    check_friction(sliding(1e-6), "`friction` is 0.000001; it must be at least 0.00001, or 0 for none");
    let across = Contact { friction_across: Some(0.0), ..sliding(0.5) };
    check_friction(across, "`friction_across` is 0; it must be at least 0.00001, and there only with `friction`");
    let twisting = Contact { torsional: 0.01, ..sliding(0.0) };
    check_friction(twisting, "`torsional` is 0.01; it must be at least 0.00001 m, and there only with `friction`");
    let rolling = Contact { rolling: [0.01; 2], ..sliding(0.5) };
    check_friction(rolling, "`rolling` is 0.01; it must be at least 0.00001 m, and there only with `torsional`");
    let lame = Contact { torsional: 0.01, rolling: [0.01, 0.0], ..sliding(0.5) };
    check_friction(lame, "`rolling` is 0; it must be at least 0.00001 m in both directions, or 0 in both");
}

#[test]
fn two_bodies_are_held_together() {
    let held = |bodies: [&str; 2], change: &dyn Fn(&mut Connection)| {
        let mut connection = Connection {
            bodies: bodies.map(String::from),
            anchors: [[0.0; 3]; 2],
            weld: Some(Weld { quat: [1.0, 0.0, 0.0, 0.0], torque_scale: 1.0 }),
            softness: Softness::default(),
        };
        change(&mut connection);
        move |arm: &mut ModelDescription| arm.connections.push(connection)
    };
    check(held(["hand", "hand"], &|_| {}), "a connection names body `hand` twice; it holds two together");
    check(
        held(["hand", "humeru"], &|_| {}),
        "connection `hand, humeru`: unknown body `humeru`; did you mean `humerus`?",
    );
    check(
        held(["hand", "world"], &|connection| connection.anchors[1][0] = 300.0),
        "connection `hand, world`: `anchors` is 300 m; it must be within 10 m; is it in millimetres?",
    );
    let scale = |connection: &mut Connection| connection.weld.iter_mut().for_each(|weld| weld.torque_scale = -1.0);
    check(held(["hand", "world"], &scale), "connection `hand, world`: `torque_scale` is -1 m; it must be 0 or more");
}

#[test]
fn what_is_seen_must_be_whole() {
    // Four points, and a triangle of the first three.
    let look = |points: &str, faces: &str, step: f64| Look {
        body: "humerus".into(),
        pos: [0.0; 3],
        quat: [1.0, 0.0, 0.0, 0.0],
        step,
        points: points.into(),
        faces: faces.into(),
    };
    let [points, faces] = ["A".repeat(32), "AAABAAIA".to_owned()];
    let mut arm = builtin("mobl-arms").unwrap();
    arm.looks.push(look(&points, &faces, 1e-5));
    assert_eq!(Model::new(&arm).unwrap().looks.len(), 1);
    let check_look = |look: Look, what: &str| {
        check(|arm| arm.looks.push(look), &format!("look `1 of humerus`: {what}"));
    };
    let unread = "points and triangles cannot be read:";
    check_look(look("A?AA", &faces, 1e-5), &format!("{unread} Invalid symbol 63, offset 1."));
    check_look(look("AAAA", &faces, 1e-5), &format!("{unread} each point and each triangle takes six bytes"));
    check_look(look(&points, "AAABAAQA", 1e-5), &format!("{unread} a triangle has a point that is not there"));
    check_look(look(&points, &faces, 0.0), "`step` is 0 m; it must be above 0 m");
}

/// Numbers in base 64, the lowest byte first.
fn base64<const N: usize>(bytes: impl Iterator<Item = [u8; N]>) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let bytes: Vec<u8> = bytes.flatten().collect();
    let three = |bytes: &[u8]| {
        let bits = bytes.iter().chain([&0; 2]).take(3).fold(0, |bits, &byte| bits << 8 | u32::from(byte));
        let digit = |k: usize| {
            if k <= bytes.len() { char::from(DIGITS[(bits >> (18 - 6 * k) & 63) as usize]) } else { '=' }
        };
        [0, 1, 2, 3].map(digit)
    };
    bytes.chunks(3).flat_map(three).collect()
}

fn words(numbers: &[u16]) -> String {
    base64(numbers.iter().map(|number| number.to_le_bytes()))
}

#[test]
fn convex_meshes_must_be_whole() {
    let tetrahedron = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1], [0.0; 3]];
    let triangles: [u16; 12] = [0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 3];
    let polygons: [u16; 16] = [3, 0, 1, 2, 3, 1, 0, 3, 3, 2, 1, 3, 3, 0, 2, 3];
    let hull = |points: &[[f64; 3]], triangles: &[u16], polygons: &[u16]| Hull {
        points: base64(points.iter().flatten().map(|x| x.to_le_bytes())),
        triangles: words(triangles),
        polygons: words(polygons),
    };
    let mut arm = builtin("mobl-arms").unwrap();
    arm.hulls.push(hull(&tetrahedron, &triangles, &polygons));
    assert_eq!(Model::new(&arm).unwrap().hulls[0].polygons.len(), 4);
    let told = |hull: Hull, what: &str| check(|arm| arm.hulls.push(hull), &format!("hull `0`: {what}"));
    told(Hull { points: "AAA".into(), ..arm.hulls[0].clone() }, "`points` is not in base 64: Invalid padding");
    told(Hull { points: "AAAA".into(), ..arm.hulls[0].clone() }, "`points` is no list of 24 bytes each");
    told(hull(&tetrahedron[..3], &triangles[..3], &[]), "it has 3 corners; from 4 to 2000 are simulated");
    let open = "its triangles are no closed surface through all of its corners";
    told(hull(&tetrahedron, &triangles[..9], &polygons), open);
    told(hull(&tetrahedron, &[0, 1, 2, 0, 1, 2, 2, 1, 3, 0, 2, 3], &polygons), open);
    told(
        hull(&tetrahedron, &[0, 1, 2, 1, 0, 3, 2, 1, 3, 0, 2, 4], &polygons),
        "corner 4, counted from 0, is not there; it has 4",
    );
    let mut inside_out = triangles;
    inside_out.chunks_exact_mut(3).for_each(|corners| corners.swap(0, 1));
    told(
        hull(&tetrahedron, &inside_out, &polygons),
        "it is not convex: corners are outside of triangle 0, counted from 0",
    );
    let mut flat = tetrahedron;
    flat[2] = [0.05, 0.05, 0.0];
    told(hull(&flat, &triangles, &polygons), "triangle 0, counted from 0, has no area");
    let mut lost = tetrahedron;
    lost[3][0] = f64::NAN;
    told(hull(&lost, &triangles, &polygons), "`points` is NaN; a finite number is needed");
    lost[3][0] = -50.0;
    told(hull(&lost, &triangles, &polygons), "`points` is -50 m; it must be within 10 m; is it in millimetres?");
    told(hull(&tetrahedron, &triangles, &[3, 0, 1, 2, 4, 1, 2]), "`polygons` ends before polygon 1 does");
    told(hull(&tetrahedron, &triangles, &[3, 0, 1, 1]), "polygon 0, counted from 0, has no area, or a corner twice");
    let rock = |shape: Shape| Geom {
        name: "rock".into(),
        body: "humerus".into(),
        shape,
        pos: [0.0; 3],
        quat: [1.0, 0.0, 0.0, 0.0],
        margin: 0.0,
        friction: [1.0, 0.005, 0.0001],
        softness: Softness::default(),
    };
    let told = |shape: Shape, what: &str| check(|arm| arm.geoms.push(rock(shape)), &format!("geom `rock`: {what}"));
    told(Shape::Mesh { hull: 0, scale: 1.0 }, "its shape is hull 0, counted from 0, of 0");
    arm.geoms.push(rock(Shape::Mesh { hull: 0, scale: 0.0 }));
    let error = Model::new(&arm).unwrap_err().to_string();
    assert_eq!(error, "geom `rock`: `scale` is 0; it must be at least 0.001");
}

#[test]
fn branches_must_lead_somewhere_and_limits_leave_room() {
    let site = || PathElement::from("DELT1-P2");
    let pulley = |divisor| PathElement::Pulley(Pulley { pulley: divisor });
    let short = "muscle `DELT1`: a branch of its path has 1 site(s); at least 2 are needed";
    check_path(vec![site(), site(), pulley(2.0), site()], short);
    check_path(vec![pulley(2.0), site(), pulley(2.0), site(), site()], short);
    check_path(
        vec![site(), pulley(2.0), site(), site()],
        "muscle `DELT1`: its path has 1 site(s); at least 2 are needed",
    );
    check_path(
        vec![site(), site(), pulley(2.0), over("elbow", None), site(), site()],
        "muscle `DELT1`: its path begins with `{over: elbow}`; a site must stand before it and after it",
    );
    check_path(
        vec![site(), site(), over("elbow", None), pulley(2.0), site(), site()],
        "muscle `DELT1`: its path ends with `{over: elbow}`; a site must stand before it and after it",
    );
    check_path(
        vec![pulley(0.0), site(), site()],
        "muscle `DELT1`: `pulley` is 0; it must be a divisor from 0.1 to 100",
    );
    check_path(vec![pulley(f64::NAN), site(), site()], "muscle `DELT1`: `pulley` is NaN; a finite number is needed");
    let check_limit = |range: [f64; 2], margin: f64, message: &str| {
        let limit = TendonLimit { range, margin, softness: Softness::default() };
        check(|arm| arm.muscles[0].limit = Some(limit), message);
    };
    check_limit(
        [0.2, 0.1],
        0.0,
        "muscle `DELT1`: `limit.range` runs from 0.2 to 0.1 m; the first must be below the second",
    );
    check_limit([0.1, 0.2], 0.05, "muscle `DELT1`: `limit.margin` is 0.05 m; it must be less than half of the range");
    check_limit([0.1, 0.2], -0.1, "muscle `DELT1`: `limit.margin` is -0.1 m; it must be 0 or more");
    check_limit([0.1, f64::INFINITY], 0.0, "muscle `DELT1`: `limit.range` is inf; a finite number is needed");
}

#[test]
fn wraps_must_have_a_size_and_names_of_their_own() {
    let check_wrap = |edit: fn(&mut Wrap), message: &str| {
        let mut wrap = elbow();
        edit(&mut wrap);
        check(|arm| arm.wraps.push(wrap), message);
    };
    check_wrap(
        |wrap| wrap.shape = WrapShape::Sphere { radius: 0.0 },
        "wrap `elbow`: `radius` is 0 m; it must be at least 0.00001 m",
    );
    check_wrap(
        |wrap| wrap.shape = WrapShape::Cylinder { radius: -0.01, half_length: 0.1 },
        "wrap `elbow`: `radius` is -0.01 m; it must be at least 0.00001 m",
    );
    check_wrap(
        |wrap| wrap.shape = WrapShape::Cylinder { radius: 0.01, half_length: 0.0 },
        "wrap `elbow`: `half_length` is 0 m; it must be above 0 m",
    );
    check_wrap(
        |wrap| wrap.shape = WrapShape::Sphere { radius: 16.0 },
        "wrap `elbow`: `radius` is 16 m; it must be within 10 m; is it in millimetres?",
    );
    check_wrap(|wrap| wrap.pos[0] = f64::NAN, "wrap `elbow`: `pos` is NaN; a finite number is needed");
    check_wrap(|wrap| wrap.quat = [0.0; 4], "wrap `elbow`: `quat` has length zero; a direction is needed");
    check_wrap(|wrap| wrap.body = "humeros".into(), "wrap `elbow`: unknown body `humeros`; did you mean `humerus`?");
    check_wrap(
        |wrap| wrap.name = "fingertip".into(),
        "wrap `fingertip` is declared twice; names of one kind must differ",
    );
}

#[test]
fn what_a_path_runs_over_is_read_with_its_place() {
    let path = "path: [DELT1-P1, DELT1-P2,";
    let wraps = "wraps:\n  - {name: elbow, body: humerus, shape: {cylinder: {radius: 0.02}}}\nmuscles:";
    let with = |element: &str| ARM.replacen(path, &format!("path: [DELT1-P1, {element}, DELT1-P2,"), 1);
    let with = |element: &str| with(element).replacen("muscles:", wraps, 1);
    let read = |element: &str| ModelDescription::from_yaml(&with(element), "arm.yaml");
    let description = read("{over: elbow, side: DELT1-P4}").unwrap();
    assert_eq!(description.muscles[0].path[1], over("elbow", Some("DELT1-P4")));
    let model = Model::new(&description).unwrap();
    assert_eq!(model.muscles[0].over.len(), 1);
    let again = ModelDescription::from_yaml(&description.to_yaml().unwrap(), "again.yaml").unwrap();
    assert_eq!(again, description);
    for (element, message) in [
        ("{ovr: elbow}", "unknown key `ovr`; did you mean `over`?"),
        ("{side: elbow}", "expected `over`, which may have a `side`, or `pulley`"),
        ("{over: elbow, pulley: 2}", "expected `over`, which may have a `side`, or `pulley`"),
        ("[elbow]", "invalid type: sequence, expected the name of a site, `{over: NAME}` or `{pulley: DIVISOR}`"),
    ] {
        let error = read(element).unwrap_err().to_string();
        assert!(error.starts_with("arm.yaml:") && error.ends_with(message), "{element}: {error}");
    }
}
