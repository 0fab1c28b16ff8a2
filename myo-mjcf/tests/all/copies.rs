//! `<replicate>` and `<attach>`.

use super::*;

fn names<'a>(names: impl Iterator<Item = &'a Option<String>>) -> Vec<&'a str> {
    names.map(|name| name.as_deref().unwrap_or("-")).collect()
}

#[test]
fn copies_are_numbered_with_as_many_digits_as_their_count() {
    let model = world("<replicate count='11' sep='-'><geom name='g'/></replicate>");
    let names = names(model.bodies[0].geoms.iter().map(|geom| &geom.name));
    assert_eq!((names.len(), names[0], names[10]), (11, "g-00", "g-10"));
    assert_eq!(world("<replicate count='0'><geom/></replicate>").geoms().count(), 0);
    assert_eq!(world("<replicate count='-1'><geom/></replicate>").geoms().count(), 0);
}

#[test]
fn copies_move_and_turn_on() {
    let model = world("<replicate count='3' offset='1 0 0' euler='0 0 90'><geom pos='1 0 0'/></replicate>");
    let geoms = &model.bodies[0].geoms;
    assert_close(&geoms[0].pose.pos(), &[1.0, 0.0, 0.0]);
    assert_close(&geoms[1].pose.pos(), &[1.0, 1.0, 0.0]);
    assert_close(&geoms[2].pose.pos(), &[0.0, 1.0, 0.0]);
    let model = world(
        "<frame pos='0 0 5' euler='0 0 90'><replicate count='2' offset='1 0 0'>\
         <frame pos='0 1 0'><body name='b' pos='0 0 1'><body name='c'/></body></frame></replicate></frame>",
    );
    assert_close(&model.bodies[1].pose.pos(), &[-1.0, 0.0, 6.0]);
    assert_close(&model.bodies[3].pose.pos(), &[-1.0, 1.0, 6.0]);
    let parents: Vec<_> = model.bodies.iter().map(|body| body.parent).collect();
    assert_eq!(parents, [0, 0, 1, 0, 3]);
}

#[test]
fn what_refers_to_copies_is_copied_with_them() {
    let model = read(
        "<worldbody><replicate count='2' sep='-'><body name='b'><replicate count='2' sep='.'><joint name='j'/>\
         </replicate><camera mode='targetbody' target='b'/></body></replicate></worldbody>\
         <sensor><jointpos name='p' joint='j'/><clock name='c'/><actuatorfrc actuator='m'/></sensor>\
         <actuator><motor name='m' joint='j'/></actuator>",
    );
    let targets: Vec<_> = model.cameras().map(|(_, camera)| camera.target.as_deref().unwrap()).collect();
    assert_eq!(targets, ["b-0", "b-1"]);
    let copies = ["p.0-0", "p.1-0", "p.0-1", "p.1-1"];
    let sensors = names(model.sensors.iter().map(|sensor| &sensor.name));
    // What refers to nothing stays single, where MuJoCo 4.0 makes copies of it, and copies of the copies.
    assert_eq!(sensors[..5], ["c", copies[0], "-", copies[1], "-"].map(|name| name)[..]);
    let joints: Vec<_> = model.actuators.iter().map(|motor| motor.joint.as_deref().unwrap()).collect();
    assert_eq!(joints, ["j.0-0", "j.1-0", "j.0-1", "j.1-1"]);
    let forces: Vec<_> = model.sensors.iter().filter_map(|sensor| sensor.actuator.as_deref()).collect();
    assert_eq!(forces, ["m.0-0", "m.1-0", "m.0-1", "m.1-1"]);
}

#[test]
fn one_who_refers_to_a_copy_and_to_a_single_thing_must_choose() {
    let error = message(
        "<worldbody><replicate count='2'><body name='b'/></replicate><body name='o'/></worldbody>\
         <contact><exclude name='e' body1='b' body2='o'/></contact>",
    );
    assert_eq!(
        error,
        "m.xml:1:106: <exclude name=\"e\">: refers to body `b`, which is copied by the <replicate> at m.xml:1:20, and to \
         something that is not; refer to one copy by its own name, or put both into the <replicate>"
    );
    let model = read(
        "<worldbody><replicate count='2'><body name='b'/></replicate><body name='o'/></worldbody>\
         <contact><exclude body1='b1' body2='o'/></contact>",
    );
    assert_eq!(model.excludes.len(), 1);
}

const CHILD: &str = "<mujoco model='child'><compiler angle='radian' autolimits='false'/>\
    <default><default class='k'><geom size='3'/></default></default><asset><material name='mat'/><mesh name='me' file='f.stl'/></asset>\
    <worldbody><geom name='w'/><body name='b' pos='0 0 1' euler='0 0 1.5707963267948966'><joint name='j' range='0 1'/>\
    <geom name='g' class='k' material='mat'/></body><frame name='f' pos='0 5 0' childclass='k'><body name='fb'>\
    <joint name='fj'/><geom/></body></frame></worldbody>\
    <sensor><jointpos name='p' joint='j'/><jointpos joint='fj'/></sensor><keyframe><key name='k' qpos='1 2'/></keyframe></mujoco>";

fn attached(attach: &str) -> Result<Mjcf, MjcfError> {
    let main = format!(
        "<mujoco><asset><model name='M' file='sub/c.xml'/></asset><worldbody><body><frame pos='1 0 0' euler='0 90 0'>\
         {attach}</frame></body></worldbody><sensor><clock name='own'/></sensor></mujoco>"
    );
    read_files(&[("m.xml", &main), ("sub/c.xml", CHILD)])
}

#[test]
fn a_body_of_another_model_keeps_its_angles_and_classes() {
    let model = attached("<attach model='M' body='b' prefix='x_'/>").unwrap();
    let body = &model.bodies[2];
    assert_eq!((body.name.as_deref(), body.parent), (Some("x_b"), 1));
    assert_close(&body.pose.pos(), &[2.0, 0.0, 0.0]);
    assert_close(&body.pose.quat(), &[0.5; 4]);
    assert_eq!((body.geoms[0].size()[0], body.geoms[0].material.as_deref()), (3.0, Some("x_mat")));
    // Without `autolimits` a range alone limits nothing, whatever the main file says.
    assert_eq!(body.joints[0].limited, Some(myo_mjcf::Auto::No));
    assert_eq!(names(model.sensors.iter().map(|sensor| &sensor.name)), ["own", "x_p"]);
    assert_eq!(model.meshes[0].path.as_ref().unwrap().path, "sub/f.stl");
    assert_eq!(model.refused.len(), 1, "{:?}", model.refused);
    assert_eq!(model.refused[0].element, "keyframe");
}

#[test]
fn a_frame_or_the_whole_world_of_another_model_may_be_attached() {
    let model = attached("<attach model='M' frame='f' prefix='x_'/>").unwrap();
    assert_eq!(names(model.bodies.iter().map(|body| &body.name)), ["world", "-", "x_fb"]);
    assert_close(&model.bodies[2].pose.pos(), &[1.0, 5.0, 0.0]);
    assert_eq!(model.bodies[2].geoms[0].size()[0], 3.0);
    assert_eq!(model.sensors.len(), 2);
    let model = attached("<attach model='M' prefix='x_'/>").unwrap();
    assert_eq!(names(model.bodies.iter().map(|body| &body.name)), ["world", "-", "x_b", "x_fb"]);
    assert_eq!(model.bodies[1].geoms[0].name.as_deref(), Some("x_w"));
}

#[test]
fn a_model_may_be_attached_twice_with_different_names() {
    let model = attached("<attach model='M' body='b' prefix='x_'/><attach model='M' body='b' prefix='y_'/>").unwrap();
    assert_eq!(names(model.materials.iter().map(|material| &material.name)), ["x_mat", "y_mat"]);
    let error = attached("<attach model='M' body='b' prefix=''/><attach model='M' body='b' prefix=''/>").unwrap_err();
    assert_eq!(
        error.to_string(),
        "sub/c.xml:1:226: <body name=\"b\">: there is a body of this name already, at sub/c.xml:1:226; names of one kind \
         must differ"
    );
}

#[test]
fn what_cannot_be_attached_is_told() {
    let message = |attach| attached(attach).unwrap_err().to_string();
    assert_eq!(message("<attach model='N' prefix=''/>"), "m.xml:1:117: <attach> model: no model `N`; valid are `M`");
    assert_eq!(
        message("<attach model='M' body='bb' prefix=''/>"),
        "m.xml:1:127: <attach> body: no body `bb`; valid are `b`, `fb`"
    );
    assert_eq!(message("<attach model='M'/>"), "m.xml:1:109: <attach>: `prefix` is missing");
}
