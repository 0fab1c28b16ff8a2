//! Every error, word by word.

use super::*;

#[track_caller]
fn check(inside: &str, expected: &str) {
    assert_eq!(message(inside), format!("m.xml:{expected}"));
}

#[test]
fn what_is_unknown_comes_with_the_nearest() {
    check("<wordbody/>", "1:9: <wordbody>: no such element in <mujoco>; did you mean `worldbody`?");
    check("<worldbody><goem/></worldbody>", "1:20: <goem>: no such element in <body>; did you mean `geom`?");
    check(
        "<worldbody>\n  <geom name='g'\n    siz='1'/></worldbody>",
        "3:5: <geom name=\"g\">: no attribute `siz`; did you mean `size`?",
    );
    check("<worldbody><geom><x/></geom></worldbody>", "1:26: <x>: no such element in <geom>; valid are `plugin`");
    check("<worldbody><site><x/></site></worldbody>", "1:26: <x>: no such element in <site>; there is none");
    check(
        "<worldbody><geom type='shpere'/></worldbody>",
        "1:26: <geom> type: no such value `shpere`; did you mean `sphere`?",
    );
    check(
        "<worldbody><body mocap='yes'/></worldbody>",
        "1:26: <body> mocap: no such value `yes`; valid are `true`, `false`",
    );
    check(
        "<default><default class='bone'/></default><worldbody><geom class='bon'/></worldbody>",
        "1:68: <geom> class: no default class `bon`; did you mean `bone`?",
    );
    check(
        "<worldbody><frame childclass='bone'/></worldbody>",
        "1:27: <frame> childclass: no default class `bone`; valid are `main`",
    );
    check(
        "<sensor><jointpso/></sensor>",
        "1:17: <jointpso>: no such element in <sensor>; did you mean `jointpos` or `jointvel`?",
    );
}

#[test]
fn attributes_belong_to_their_element() {
    let motor = message("<actuator><motor joint='j' kp='1'/></actuator>");
    assert!(motor.starts_with("m.xml:1:36: <motor>: no attribute `kp`; "), "{motor}");
    let touch = message("<sensor><touch site='s' joint='j'/></sensor>");
    assert!(touch.starts_with("m.xml:1:33: <touch>: no attribute `joint`; "), "{touch}");
    let fixed = message("<tendon><fixed width='1'/></tendon>");
    assert!(fixed.starts_with("m.xml:1:24: <fixed>: no attribute `width`; "), "{fixed}");
    let class = message("<default><geom name='x'/></default>");
    assert!(class.starts_with("m.xml:1:24: <geom name=\"x\">: no attribute `name`; "), "{class}");
    check("<asset name='a'/>", "1:16: <asset name=\"a\">: no attribute `name`; there is none");
    check("<include file='a' x='1'/>", "1:27: <include>: no attribute `x`; valid are `file`");
}

#[test]
fn numbers_are_checked() {
    check("<option timestep='fast'/>", "1:17: <option> timestep: `fast` is not a number");
    check("<option timestep='0x10'/>", "1:17: <option> timestep: `0x10` is not a number");
    check("<option timestep='nan'/>", "1:17: <option> timestep: `nan` is not finite; a finite number is needed");
    check(
        "<option iterations='1.5'/>",
        "1:17: <option> iterations: `1.5` is not a whole number between -2147483648 and 2147483647",
    );
    check("<option gravity='1 2'/>", "1:17: <option> gravity: 2 values; 3 are needed");
    check("<option timestep='1 2'/>", "1:17: <option> timestep: 2 values; 1 is needed");
    check("<worldbody><geom size='1 2 3 4'/></worldbody>", "1:26: <geom> size: 4 values; 1 to 3 are needed");
    check("<option actuatorgroupdisable='31'/>", "1:17: <option> actuatorgroupdisable: `31`; it must be 0 to 30");
    check("<statistic extent='0'/>", "1:20: <statistic> extent: `0`; it must be above 0");
    check("<size nkey='-2'/>", "1:15: <size> nkey: `-2`; it must be -1 or more");
    check(
        "<size memory='lots'/>",
        "1:15: <size> memory: `lots`; it must be -1, or a whole number with K, M, G, T, P, E or nothing after it",
    );
    check("<worldbody><body quat='0 0 0 0'/></worldbody>", "1:26: <body> quat: `0 0 0 0`; it must be longer than zero");
    check("<worldbody><body zaxis='0 0 0'/></worldbody>", "1:26: <body> zaxis: `0 0 0`; it must be longer than zero");
    check("<actuator><position joint='j' kv='-1'/></actuator>", "1:39: <position> kv: `-1`; it must be 0 or more");
}

#[test]
fn what_must_be_there_is() {
    check("<contact><exclude body1='a'/></contact>", "1:18: <exclude>: `body2` is missing");
    check("<worldbody><body><inertial mass='1'/></body></worldbody>", "1:26: <inertial>: `pos` is missing");
    check("<worldbody><body><inertial pos='0 0 0'/></body></worldbody>", "1:26: <inertial>: `mass` is missing");
    check("<tendon><fixed><joint joint='j'/></fixed></tendon>", "1:24: <joint>: `coef` is missing");
    check("<sensor><touch/></sensor>", "1:17: <touch>: `site` is missing");
    check("<sensor><rangefinder/></sensor>", "1:17: <rangefinder>: `site` is missing");
    check(
        "<sensor><framepos objtype='site' objname='s' reftype='site'/></sensor>",
        "1:17: <framepos>: `refname` is missing",
    );
    check("<equality><connect body1='a'/></equality>", "1:19: <connect>: `anchor` is missing");
    check("<equality><weld site1='a'/></equality>", "1:19: <weld>: `site2` is missing");
    check("<custom><text name='a'/></custom>", "1:17: <text name=\"a\">: `data` is missing");
    check("<default><default/></default>", "1:18: <default>: `class` is missing");
    check("<include/>", "1:9: <include>: `file` is missing");
    check(
        "<actuator><motor name='m'/></actuator>",
        "1:19: <motor name=\"m\">: nothing to act on; name a joint, a tendon, a site, a cranksite or a body",
    );
}

#[test]
fn what_excludes_each_other_does() {
    check(
        "<worldbody><geom quat='1 0 0 0' euler='1 2 3'/></worldbody>",
        "1:41: <geom>: `quat` and `euler` exclude each other; give one of them",
    );
    check(
        "<actuator><motor joint='j' tendon='t'/></actuator>",
        "1:36: <motor>: `joint` and `tendon` exclude each other; give one of them",
    );
    check("<size memory='1M' njmax='3'/>", "1:27: <size>: `memory` and `njmax` exclude each other; give one of them");
    check(
        "<worldbody><geom type='capsule' pos='1 0 0' fromto='0 0 0 0 0 1' size='1'/></worldbody>",
        "1:20: <geom>: `pos` and `fromto` exclude each other; give one of them",
    );
}

#[test]
fn what_stands_in_the_wrong_place_is_told() {
    check("<worldbody><joint/></worldbody>", "1:20: <joint>: the world does not move; put it into a body");
    check("<worldbody name='w'/>", "1:9: <worldbody name=\"w\">: the world has no attributes; leave them out");
    check("<include file='a'><geom/></include>", "1:9: <include>: an include has no elements of its own");
    check(
        "<default class='bone'/>",
        "1:9: <default>: the outermost default class is `main`; leave the name out, or nest the class",
    );
    check(
        "<compiler coordinate='global'/>",
        "1:9: <compiler>: global coordinates are not read; save the model with MuJoCo 2.3.3",
    );
    check(
        "<worldbody><geom fromto='0 0 0 0 0 1'/></worldbody>",
        "1:20: <geom>: `fromto` is for capsules, cylinders, ellipsoids and boxes; leave it out or change the type",
    );
    check(
        "<worldbody><geom type='box' fromto='0 0 0 0 0 0'/></worldbody>",
        "1:20: <geom>: the two points of `fromto` are one; move them apart",
    );
}

#[test]
fn names_of_one_kind_differ() {
    check(
        "<worldbody><geom name='a'/><site name='a'/>\n<body><geom name='a'/></body></worldbody>",
        "2:7: <geom name=\"a\">: there is a geom of this name already, at m.xml:1:20; names of one kind must differ",
    );
    check(
        "<worldbody><body name='world'/></worldbody>",
        "1:20: <body name=\"world\">: there is a body of this name already, at m.xml:1:1; names of one kind must differ",
    );
    check(
        "<worldbody><frame name='f'/><frame name='f'/></worldbody>",
        "1:37: <frame name=\"f\">: there is a frame of this name already, at m.xml:1:20; names of one kind must differ",
    );
    check(
        "<default><default class='a'/><default class='a'/></default>",
        "1:47: <default>: there is a default class of this name already, at m.xml:1:18; names of one kind must differ",
    );
    check("<default><geom/><geom/></default>", "1:25: <geom>: there is one already, at m.xml:1:18; join the two");
    check(
        "<worldbody><body><inertial pos='0 0 0' mass='1'/><inertial pos='0 0 0' mass='1'/></body></worldbody>",
        "1:58: <inertial>: there is one already, at m.xml:1:26; join the two",
    );
}

#[test]
fn what_is_no_xml_says_where() {
    let message = |text| read_files(&[("m.xml", text)]).unwrap_err().to_string();
    assert_eq!(message("<mujoco>\n  <option></mujoco>"), "m.xml:2:11: expected 'option' tag, not 'mujoco'");
    assert_eq!(message("<mujoco>"), "m.xml:1:9: the file ends within an element; an end tag is missing");
    assert_eq!(message("<mujoco a='1' a='2'/>"), "m.xml:1:15: attribute 'a' is already defined");
    assert_eq!(message("<robot/>"), "m.xml:1:1: <robot>: the root of a model is `mujoco`");
    assert_eq!(message("<mujoco foo='1'/>"), "m.xml:1:1: <mujoco>: no attribute `foo`; valid are `model`");
    assert_eq!(message("<mujoco xmlns='u'/>"), "m.xml:1:1: MJCF has no namespaces; leave `xmlns` out");
    assert_eq!(message("<x:mujoco/>"), "m.xml:1:2: an unknown namespace prefix 'x'");
}

#[test]
fn errors_are_small() {
    assert!(size_of::<MjcfError>() <= 128, "{}", size_of::<MjcfError>());
}
