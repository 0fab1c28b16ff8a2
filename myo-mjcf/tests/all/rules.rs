//! MuJoCo's rules: classes, partial vectors, angles, orientations, frames, shortcuts. The numbers are MuJoCo 4.0's.

use super::*;
use myo_mjcf::{Auto, BiasKind, Constraint, DynKind, GainKind, JointKind, PathPoint, Shape, TendonPath};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

/// The first geom of a model whose main class has `class`, and whose geom has `own`.
fn geom(class: &str, own: &str) -> myo_mjcf::Geom {
    let model = read(&format!("<default><geom {class}/></default><worldbody><geom {own}/></worldbody>"));
    model.bodies[0].geoms[0].clone()
}

#[test]
fn nobody_said_anything_is_none_and_the_method_gives_the_default() {
    let geom = geom("", "");
    assert_eq!((geom.kind, geom.size, geom.friction), (None, None, None));
    assert_eq!(geom.kind(), Shape::Sphere);
    assert_eq!((geom.size(), geom.friction()), ([0.0; 3], [1.0, 0.005, 0.0001]));
    assert!(geom.said().is_empty());
}

#[test]
fn fewer_numbers_keep_the_rest_of_the_class_or_the_default() {
    assert_eq!(geom("size='.1 .7 .8'", "size='.5'").size, Some([0.5, 0.7, 0.8]));
    assert_eq!(geom("", "solref='.5'").solref, Some([0.5, 1.0]));
    assert_eq!(geom("", "friction='2 3'").friction, Some([2.0, 3.0, 0.0001]));
    assert_eq!(geom("user='1 2 3'", "user='4'").user, Some(vec![4.0]));
}

#[test]
fn nothing_between_quotes_takes_away_what_the_class_said() {
    let geom = geom("material='m' user='1'", "material='' user='' name=''");
    assert_eq!((geom.material, geom.user, geom.name), (None, None, None));
}

#[test]
fn classes_inherit_whatever_their_order() {
    let model = read(
        "<default><default class='a'><geom rgba='1 0 0 1'/><default class='b'><geom size='3'/></default></default>\
         <geom size='2'/></default>\
         <worldbody><geom/><body childclass='a'><geom/><body><geom class='b'/><geom class='main'/>\
         <frame childclass='b'><geom/></frame></body></body></worldbody>",
    );
    let sizes: Vec<_> = model.geoms().map(|(_, geom)| (geom.size()[0], geom.rgba()[1])).collect();
    assert_eq!(sizes, [(2.0, 0.5), (2.0, 0.0), (3.0, 0.0), (2.0, 0.5), (3.0, 0.0)]);
}

#[test]
fn a_class_is_what_its_parent_was_when_it_was_written() {
    let model = read(
        "<default><geom size='1'/><default class='a'/></default><default><geom size='2'/></default>\
         <worldbody><geom/><geom class='a'/></worldbody>",
    );
    let sizes: Vec<_> = model.geoms().map(|(_, geom)| geom.size()[0]).collect();
    assert_eq!(sizes, [2.0, 1.0]);
}

#[test]
fn of_several_compilers_the_last_word_holds_for_all() {
    let model = read(
        "<compiler angle='radian' eulerseq='zyx'/><worldbody><geom euler='90 0 0'/></worldbody><compiler angle='degree'/>",
    );
    assert_close(&model.bodies[0].geoms[0].pose.quat(), &[FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]);
}

#[test]
fn orientations_are_unit_quaternions() {
    let half = FRAC_1_SQRT_2;
    let cases = [
        ("quat='2 0 0 2'", [half, 0.0, 0.0, half]),
        ("axisangle='0 0 5 90'", [half, 0.0, 0.0, half]),
        ("xyaxes='0 2 0 -1 1 0'", [half, 0.0, 0.0, half]),
        ("zaxis='1 0 0'", [half, 0.0, half, 0.0]),
        ("zaxis='0 0 -3'", [0.0, 1.0, 0.0, 0.0]),
        ("euler='10 20 30'", [0.943_714_364, 0.127_679_440, 0.144_878_125, 0.268_535_822]),
    ];
    for (written, quat) in cases {
        assert_close(&geom("", written).pose.quat(), &quat);
    }
    let fixed = read("<compiler eulerseq='XYZ'/><worldbody><geom euler='10 20 30'/></worldbody>");
    let quat = [0.951_548_524_6, 0.038_134_576_5, 0.189_307_857_4, 0.239_298_337_7];
    assert_close(&fixed.bodies[0].geoms[0].pose.quat(), &quat);
}

#[test]
fn the_orientation_of_the_element_replaces_that_of_the_class() {
    assert_close(&geom("euler='90 0 0'", "quat='0 0 0 1'").pose.quat(), &[0.0, 0.0, 0.0, 1.0]);
    assert_close(&geom("quat='0 0 0 1'", "euler='180 0 0'").pose.quat(), &[0.0, 1.0, 0.0, 0.0]);
}

#[test]
fn end_points_become_position_orientation_and_size() {
    let capsule = geom("", "type='capsule' size='.1' fromto='0 0 0 1 0 0' euler='90 0 0'");
    assert_eq!((capsule.size(), capsule.pose.pos(), capsule.fromto), ([0.1, 0.5, 0.0], [0.5, 0.0, 0.0], None));
    assert_close(&capsule.pose.quat(), &[FRAC_1_SQRT_2, 0.0, -FRAC_1_SQRT_2, 0.0]);
    assert_eq!(geom("", "type='box' size='.1 .2' fromto='0 0 0 1 0 0'").size(), [0.1, 0.1, 0.5]);
    assert_eq!(geom("size='.1 .7 .8'", "type='cylinder' fromto='0 0 0 1 0 0'").size(), [0.1, 0.5, 0.8]);
    let model = world("<site type='capsule' size='.1' fromto='0 0 0 1 0 0'/>");
    assert_eq!(model.bodies[0].sites[0].size(), [0.1, 0.5, 0.005]);
}

#[test]
fn angles_of_joints_are_in_rad_where_they_are_angles() {
    let model = world(
        "<body><joint range='0 90' ref='90' springref='90' springyield='90'/>\
         <joint type='slide' range='0 90' ref='90'/><joint type='ball' range='0 90'/></body>",
    );
    let [hinge, slide, ball] = &model.bodies[1].joints[..] else { panic!() };
    assert_close(&hinge.range(), &[0.0, FRAC_PI_2]);
    assert_close(&[hinge.reference(), hinge.springref(), hinge.springyield()], &[FRAC_PI_2; 3]);
    assert_eq!((slide.range(), slide.reference()), ([0.0, 90.0], 90.0));
    assert_close(&ball.range(), &[0.0, FRAC_PI_2]);
    let model = read("<compiler angle='radian'/><worldbody><body><joint range='0 2'/></body></worldbody>");
    assert_eq!(model.bodies[1].joints[0].range, Some([0.0, 2.0]));
}

#[test]
fn frames_fold_into_all_that_stands_in_them() {
    let model = world(
        "<body><frame pos='1 0 0' euler='0 0 90'><frame pos='0 0 1'>\
         <joint axis='1 0 0' pos='1 0 0'/><inertial pos='0 1 0' mass='1' diaginertia='1 2 3'/>\
         <site pos='1 0 0'/><light pos='0 1 0' dir='1 0 0'/><camera/><body name='b' pos='1 0 0'/>\
         <freejoint/><joint type='ball' pos='1 0 0'/></frame></frame></body>",
    );
    let body = &model.bodies[1];
    assert_close(&body.joints[0].pos(), &[1.0, 1.0, 1.0]);
    assert_close(&body.joints[0].axis(), &[0.0, 1.0, 0.0]);
    assert_eq!((body.joints[1].pos, body.joints[1].kind), (None, Some(JointKind::Free)));
    assert_eq!(body.joints[2].axis, None);
    let inertial = body.inertial.as_ref().unwrap();
    assert_close(&inertial.pose.pos(), &[0.0, 0.0, 1.0]);
    assert_close(&inertial.pose.quat(), &[FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]);
    assert_close(&body.lights[0].dir(), &[0.0, 1.0, 0.0]);
    assert_close(&body.cameras[0].pose.pos(), &[1.0, 0.0, 1.0]);
    assert_close(&model.bodies[2].pose.pos(), &[1.0, 1.0, 1.0]);
    assert_eq!(model.bodies[2].parent, 1);
}

#[test]
fn full_inertia_turns_with_its_frame() {
    let model = world(
        "<body><frame euler='0 0 90'><inertial pos='0 0 0' mass='1' fullinertia='1 2 3 .1 .2 .3'/></frame></body>",
    );
    let inertial = model.bodies[1].inertial.as_ref().unwrap();
    assert_close(&inertial.fullinertia.unwrap(), &[2.0, 1.0, 3.0, -0.1, -0.3, 0.2]);
    assert_eq!(inertial.pose.quat, None);
}

#[test]
fn a_freejoint_has_no_class_but_a_joint_of_type_free_has() {
    let model = read(
        "<default><joint damping='3'/></default>\
         <worldbody><body><joint type='free'/></body><body><freejoint name='f' align='false'/></body></worldbody>",
    );
    assert_eq!(model.bodies[1].joints[0].damping(), [3.0, 0.0, 0.0]);
    let free = &model.bodies[2].joints[0];
    assert_eq!((free.damping, free.align, free.name.as_deref()), (None, Some(Auto::No), Some("f")));
}

#[test]
fn shortcuts_set_general_parameters_over_their_class() {
    let model = read(
        "<default><position kp='5'/></default><worldbody><body><joint name='j'/></body></worldbody><actuator>\
         <position joint='j' kv='2'/><motor joint='j'/><general joint='j'/><velocity joint='j'/>\
         <muscle joint='j' range='.5 1'/><position joint='j' dampratio='1' timeconst='.1'/></actuator>",
    );
    let first = |prm: [f64; 10]| [prm[0], prm[1], prm[2]];
    let all: Vec<_> =
        model.actuators.iter().map(|it| (first(it.gainprm()), first(it.biasprm()), it.dyntype())).collect();
    assert_eq!(all[0], ([5.0, 0.0, 0.0], [0.0, -5.0, -2.0], DynKind::None));
    assert_eq!(all[1], ([1.0, 0.0, 0.0], [0.0, -5.0, 0.0], DynKind::None));
    assert_eq!(all[2], ([5.0, 0.0, 0.0], [0.0, -5.0, 0.0], DynKind::None));
    assert_eq!(all[3], ([5.0, 0.0, 0.0], [0.0, 0.0, -5.0], DynKind::None));
    assert_eq!(all[5], ([5.0, 0.0, 0.0], [0.0, -5.0, 1.0], DynKind::FilterExact));
    let motor = &model.actuators[1];
    assert_eq!((motor.gaintype, motor.biastype), (Some(GainKind::Fixed), Some(BiasKind::None)));
}

#[test]
fn a_muscle_has_defaults_of_its_own() {
    let model =
        read("<worldbody><body><joint name='j'/></body></worldbody><actuator><muscle joint='j' force='9'/></actuator>");
    let muscle = &model.actuators[0];
    assert_eq!(muscle.gainprm(), [0.75, 1.05, 9.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2, 0.0]);
    assert_eq!((muscle.biasprm(), muscle.dynprm()[..3].to_vec()), (muscle.gainprm(), vec![0.01, 0.04, 0.0]));
    assert!(
        matches!(&muscle.shortcut, myo_mjcf::Shortcut::Muscle(own) if own.force == Some(9.0) && own.vmax.is_none())
    );
}

#[test]
fn constraints_and_tendons_keep_what_they_refer_to() {
    let model = read(
        "<tendon><spatial><site site='a'/><geom geom='g' sidesite='s'/><pulley divisor='2'/><site site='b'/></spatial>\
         <fixed springlength='1'><joint joint='j' coef='2'/></fixed></tendon>\
         <equality><joint joint1='j' polycoef='3'/><connect site1='a' site2='b'/></equality>",
    );
    let TendonPath::Spatial(points) = &model.tendons[0].path else { panic!() };
    assert!(matches!(&points[1], PathPoint::Geom(geom) if geom.geom == "g" && geom.sidesite.as_deref() == Some("s")));
    assert!(matches!(&points[2], PathPoint::Pulley(pulley) if pulley.divisor == 2.0));
    assert_eq!(model.tendons[1].springlength(), [1.0, 1.0]);
    let Constraint::Joint(joint) = &model.equalities[0].constraint else { panic!() };
    assert_eq!((joint.polycoef(), &joint.joint2), ([3.0, 1.0, 0.0, 0.0, 0.0], &None));
}

#[test]
fn sections_add_up() {
    let model = read(
        "<option timestep='1' actuatorgroupdisable='1'/><option gravity='0 0 1' actuatorgroupdisable='2'/>\
         <worldbody><geom name='a'/></worldbody><worldbody><geom name='b'/></worldbody>",
    );
    assert_eq!((model.option.timestep(), model.option.gravity()), (1.0, [0.0, 0.0, 1.0]));
    assert_eq!(model.option.actuatorgroupdisable, Some(vec![1, 2]));
    assert_eq!(model.geoms().count(), 2);
}

#[test]
fn what_is_valid_but_not_read_is_told() {
    let model = read(
        "<extension><plugin plugin='p'/></extension><deformable><flex/></deformable><asset><skin/></asset>\
         <worldbody>words<body><composite/><plugin/><geom><plugin/></geom></body><attach body='b' prefix='p'/></worldbody>\
         <equality><flex/></equality><actuator><plugin/><dcmotor/></actuator><sensor><plugin/></sensor>",
    );
    let mut refused: Vec<_> = model.refused.iter().map(|refused| refused.element.as_str()).collect();
    refused.sort_unstable();
    let expected = [
        "attach",
        "composite",
        "dcmotor",
        "flex",
        "flex",
        "plugin",
        "plugin",
        "plugin",
        "plugin",
        "plugin",
        "skin",
        "worldbody",
    ];
    assert_eq!(refused, expected);
    assert_eq!(
        model.refused[1].to_string(),
        "m.xml:1:20: <plugin>: plugins are not read; leave them out",
        "{:?}",
        model.refused
    );
}

#[test]
fn what_is_seen_is_kept_as_it_stands() {
    let model = read("<visual><map znear='.1'/><rgba haze='1 2 3 4'/></visual>");
    assert_eq!(model.visual[1].numbers("haze"), Some(vec![1.0, 2.0, 3.0, 4.0]));
    assert_eq!(model.visual[0].attributes, [("znear".to_owned(), ".1".to_owned())]);
}

#[test]
fn custom_text_may_stand_between_tags() {
    let model = read("<custom><text name='a'><![CDATA[x < y]]></text><numeric name='n' data=''/></custom>");
    assert_eq!(model.texts[0].data.as_deref(), Some("x < y"));
    assert!(model.refused.is_empty());
}

#[test]
fn limits_follow_ranges_if_the_compiler_says_so() {
    let range = Some([0.0, 1.0]);
    assert!(Auto::Auto.decide(true, range) && !Auto::Auto.decide(false, range) && !Auto::Auto.decide(true, None));
    assert!(Auto::Yes.decide(false, None) && !Auto::No.decide(true, range));
}
