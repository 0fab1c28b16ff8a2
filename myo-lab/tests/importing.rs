//! Bodies of MuJoCo's files come with what is seen of them.

use std::path::Path;

use myo_lab::import_model;
use myo_model::description::Landmarks;
use myo_model::import::ImportOptions;

const ARM: &str = r#"<mujoco>
  <compiler meshdir="bones"/>
  <asset><mesh name="bone" file="bone.obj" scale="0.001 0.001 0.001"/></asset>
  <worldbody>
    <geom type="mesh" mesh="bone" contype="0" conaffinity="0"/>
    <site name="origin" pos="0.05 0 0.1"/>
    <body name="humerus">
      <inertial pos="0 0 -0.1" mass="1" diaginertia="0.01 0.01 0.001"/>
      <joint name="elbow" axis="0 1 0" range="-60 60" damping="0.1"/>
      <geom type="mesh" mesh="bone" pos="0 0 0.01" contype="0" conaffinity="0"/>
      <geom type="mesh" mesh="bone" group="3" contype="0" conaffinity="0"/>
      <site name="insertion" pos="0.02 0 -0.1"/>
      <site name="tip" pos="0 0 -0.2"/>
    </body>
  </worldbody>
  <tendon><spatial name="biceps"><site site="origin"/><site site="insertion"/></spatial></tendon>
  <actuator><muscle name="biceps" tendon="biceps" lengthrange="0.1 0.3" force="100"/></actuator>
</mujoco>"#;

/// A tetrahedron in millimetres.
const BONE: &str = "v 0 0 0\nv 30 0 0\nv 0 30 0\nv 0 0 30\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

fn import(folder: &Path) -> myo_lab::Imported {
    let options = ImportOptions::new(Landmarks::new("tip", "humerus"));
    import_model(&folder.join("arm.xml"), None, &options).unwrap()
}

#[test]
fn meshes_that_are_seen_on_bodies_come_with_them() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.xml"), ARM).unwrap();
    std::fs::create_dir(folder.path().join("bones")).unwrap();
    std::fs::write(folder.path().join("bones/bone.obj"), BONE).unwrap();
    let imported = import(folder.path());
    assert_eq!(imported.passed_over, Vec::<String>::new());
    // One of the world and one that is hidden are not there.
    let [look] = &imported.description.looks[..] else { panic!("{:?}", imported.description.looks) };
    assert_eq!((&*look.body, look.pos), ("humerus", [0.0, 0.0, 0.01]));
    assert!((look.step * f64::from(i16::MAX) - 0.03).abs() < 1e-8, "as large as it is: {}", look.step);

    // It is kept in a model file.
    let text = imported.description.to_yaml().unwrap();
    let read = myo_model::ModelDescription::from_yaml(&text, "arm.yaml").unwrap();
    assert_eq!(read.looks, imported.description.looks);
}

#[test]
fn what_cannot_be_read_is_told_and_leaves_the_body_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("arm.xml"), ARM).unwrap();
    let imported = import(folder.path());
    assert!(imported.description.looks.is_empty());
    let told = "meshes of 1 geom(s), which cannot be read: bone.obj does not exist";
    assert_eq!(imported.passed_over, [told]);
    std::fs::write(folder.path().join("arm.xml"), ARM.replace("\"bones\"", "\"../bones\"")).unwrap();
    let outside = &import(folder.path()).passed_over[0];
    assert!(outside.contains("outside the folder of the model") && outside.contains("--root FOLDER"), "{outside}");
}
