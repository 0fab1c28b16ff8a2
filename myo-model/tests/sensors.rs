//! Sensors: what is taken from MJCF, what is told instead, and what is wrong with a description.

use std::collections::BTreeMap;

use myo_mjcf::{Limits, Mjcf, read_from};
use myo_model::description::{
    Frame, FrameQuantity, JointQuantity, Landmarks, Measure, MuscleQuantity, Sensor, Shape, SubtreeQuantity,
};
use myo_model::import::{ImportOptions, from_mjcf, unused};
use myo_model::mjcf::{MjcfOptions, to_mjcf};
use myo_model::{Model, ModelDescription, Size, builtin};

fn read(text: &str) -> Mjcf {
    let files = BTreeMap::from([("arm.xml".to_owned(), text.to_owned())]);
    read_from(&files, "arm.xml", Limits::default()).unwrap()
}

fn options() -> ImportOptions {
    ImportOptions::new(Landmarks::new("tip", "humerus"))
}

/// An arm over a floor, with these sensors.
fn arm(sensors: &str) -> Mjcf {
    read(&format!(
        r#"<mujoco model="arm">
  <worldbody>
    <camera name="eye"/>
    <geom name="floor" type="plane" size="1 1 1"/>
    <geom name="wall" type="mesh" mesh="wall" contype="0" conaffinity="0"/>
    <site name="origin" pos="0.02 0 0.1"/>
    <body name="humerus" pos="0 0 1">
      <joint name="shoulder" type="ball"/>
      <inertial pos="0 0 0.1" mass="1" diaginertia="0.1 0.2 0.3"/>
      <geom name="bone" type="capsule" size="0.02 0.1" contype="0" conaffinity="0"/>
      <site name="insertion" pos="0.02 0 -0.05" quat="1 2 0 0"/>
      <body name="ulna">
        <joint name="elbow" axis="0 1 0" range="0 130"/>
        <joint name="slide" type="slide"/>
        <geom name="pad" size="0.05" pos="0 0 -1"/>
        <site name="tip" pos="0 0 -1" type="capsule" size="0.1 0.2" quat="1 1 0 0"/>
      </body>
    </body>
  </worldbody>
  <asset><mesh name="wall" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/></asset>
  <tendon>
    <spatial name="cord" limited="true" range="0 9"><site site="origin"/><site site="insertion"/></spatial>
    <spatial name="string"><site site="origin"/><site site="tip"/></spatial>
  </tendon>
  <actuator>
    <muscle name="BIC" tendon="cord" lengthrange="0.7 1.1" force="300"/>
    <muscle name="BRA" tendon="cord" lengthrange="0.7 1.1" force="300"/>
  </actuator>
  <sensor>{sensors}</sensor>
</mujoco>"#
    ))
}

fn import(sensors: &str) -> ModelDescription {
    from_mjcf(&arm(sensors), &options()).unwrap()
}

const KNOWN: &str = r#"
    <touch name="pulp" site="tip" cutoff="20" noise="0.1"/>
    <gyro name="gyro" site="insertion"/> <velocimeter name="velocimeter" site="tip"/>
    <jointpos name="bent" joint="elbow"/> <jointvel name="bending" joint="slide"/>
    <jointactuatorfrc name="torque" joint="elbow"/> <jointlimitfrc name="stop" joint="elbow"/>
    <ballquat name="ball" joint="shoulder"/> <ballangvel name="turning" joint="shoulder"/>
    <tendonpos name="cord" tendon="cord"/> <tendonlimitpos name="taut" tendon="cord"/>
    <actuatorvel name="BRA" actuator="BRA"/> <actuatorfrc name="BRA force" actuator="BRA"/>
    <framepos name="hand" objtype="site" objname="tip"/>
    <framequat name="hand on ulna" objtype="xbody" objname="ulna" reftype="body" refname="humerus"/>
    <framelinvel name="pad" objtype="geom" objname="pad"/> <framezaxis name="up" objtype="xbody" objname="world"/>
    <framepos name="middle" objtype="body" objname="ulna"/>
    <subtreecom name="weight" body="humerus"/>
    <subtreelinvel body="ulna"/>"#;

fn known() -> ModelDescription {
    import(KNOWN)
}

fn measures(description: &ModelDescription, name: &str) -> Measure<String> {
    description.sensors.iter().find(|sensor| sensor.name == name).unwrap().measures.clone()
}

#[test]
fn sensors_measure_what_files_say() {
    let all = known();
    assert_eq!(all.sensors.len(), 20);
    let muscle = |of: &str, quantity| Measure::Muscle { of: of.to_owned(), quantity };
    assert_eq!(measures(&all, "ball"), Measure::Joint { of: "shoulder".into(), quantity: JointQuantity::Position });
    // Tendons are those of their first muscles.
    assert_eq!(measures(&all, "cord"), muscle("BIC", MuscleQuantity::Length));
    assert_eq!(measures(&all, "taut"), muscle("BIC", MuscleQuantity::LimitDistance));
    assert_eq!(measures(&all, "BRA"), muscle("BRA", MuscleQuantity::Velocity));
    let seen_from = Some(Frame::Centre("humerus".to_owned()));
    let turned = Measure::Frame { of: Frame::Body("ulna".into()), quantity: FrameQuantity::Orientation, seen_from };
    assert_eq!(measures(&all, "hand on ulna"), turned);
    let subtree = Measure::Subtree { of: "ulna".to_owned(), quantity: SubtreeQuantity::Velocity };
    assert_eq!(measures(&all, "sensor20"), subtree);
    assert_eq!((all.sensors[0].cutoff, all.sensors[1].cutoff), (20.0, 0.0));
    // Only sites that sensors ask are turned, and have a shape where they feel touch.
    let sites: Vec<_> = all.sites.iter().map(|site| (site.quat[1] != 0.0, site.shape)).collect();
    let capsule = Shape::Capsule { radius: 0.1, half_length: 0.2 };
    assert_eq!(sites, [(false, None), (true, None), (true, Some(capsule))]);
    assert!(import("").sites.iter().all(|site| site.quat == [1.0, 0.0, 0.0, 0.0] && site.shape.is_none()));
}

#[test]
fn they_come_back_from_mjcf_and_from_yaml() {
    let all = known();
    assert_eq!(ModelDescription::from_yaml(&all.to_yaml().unwrap(), "arm.yaml").unwrap(), all);
    let model = Model::new(&all).unwrap();
    let back = from_mjcf(&read(&to_mjcf(&model, &MjcfOptions::default())), &options()).unwrap();
    assert_eq!(Model::new(&back).unwrap().sensors, model.sensors);
    assert_eq!(Model::new(&back).unwrap().sites, model.sites);
    assert!(!import("").to_yaml().unwrap().contains("sensors"));
}

#[test]
fn what_is_not_measured_is_told_by_its_kind() {
    let others = r#"
        <accelerometer site="tip"/> <accelerometer site="origin"/>
        <clock/> <rangefinder site="tip"/> <user dim="1"/>
        <jointpos joint="elbow" delay="0.01" nsample="2"/>
        <tendonpos tendon="string"/> <tendonactuatorfrc tendon="cord"/>
        <jointlimitpos joint="slide"/>
        <framepos objtype="geom" objname="bone"/> <framepos objtype="xbody" objname="ulna" reftype="camera" refname="eye"/>
        <framexaxis objtype="body" objname="ulna"/>
        <jointvel name="kept" joint="elbow"/>"#;
    let told = |mjcf: &Mjcf, options: &ImportOptions| {
        let description = from_mjcf(mjcf, options).unwrap();
        let told = unused(mjcf, &description);
        let told: Vec<String> = told.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        (description.sensors.len(), told.join(", "))
    };
    let mjcf = arm(others);
    let all = "1 cameras, 2 `accelerometer` sensors, 1 `clock` sensors, 2 `framepos` sensors, 1 `framexaxis` sensors, 1 `jointlimitpos` sensors, \
        1 `jointpos` sensors, 1 `rangefinder` sensors, 1 `tendonactuatorfrc` sensors, 1 `tendonpos` sensors, 1 `user` sensors";
    assert_eq!(told(&mjcf, &options()), (1, all.to_owned()));
    let locked = ImportOptions { locked: vec!["elbow".to_owned()], ..options() };
    let (kept, told) = told(&mjcf, &locked);
    assert!(kept == 0 && told.contains("1 `jointvel` sensors"), "{told}");
}

#[test]
fn unknown_names_and_what_is_not_there_are_refused() {
    let fault = |measures: Measure<String>, cutoff: f64| {
        let mut all = known();
        all.sensors.push(Sensor { name: "odd".to_owned(), measures, cutoff });
        Model::new(&all).unwrap_err().to_string()
    };
    let joint = |of: &str, quantity| Measure::Joint { of: of.to_owned(), quantity };
    let frame = |of, quantity| Measure::Frame { of, quantity, seen_from: None };
    for (measures, cutoff, told) in [
        (joint("elbov", JointQuantity::Position), 0.0, "sensor `odd`: unknown joint `elbov`; did you mean `elbow`?"),
        (frame(Frame::Geom("bad".to_owned()), FrameQuantity::Position), 0.0, "sensor `odd`: unknown geom `bad`; "),
        (
            Measure::Touch("origin".to_owned()),
            0.0,
            "sensor `odd`: its site has no `shape` in which it would feel touch",
        ),
        (joint("shoulder", JointQuantity::MuscleForce), 0.0, "sensor `odd`: its joint is a ball joint, "),
        (joint("slide", JointQuantity::LimitForce), 0.0, "sensor `odd`: its joint has no `range`"),
        (
            frame(Frame::Site("tip".to_owned()), FrameQuantity::XAxis),
            1.0,
            "sensor `odd`: orientations and axes have no `cutoff`",
        ),
        (Measure::Gyro("tip".to_owned()), -1.0, "sensor `odd`: `cutoff` is -1; it must be 0 or more"),
    ] {
        let found = fault(measures, cutoff);
        assert!(found.starts_with(told), "{found}");
    }
    let mut twice = known();
    twice.sensors.push(twice.sensors[0].clone());
    assert!(Model::new(&twice).unwrap_err().to_string().starts_with("sensor `pulp` is declared twice"));
}

#[test]
fn they_go_with_the_body_of_a_person() {
    let mut arm = builtin("myo-arm").unwrap();
    let muscles: Vec<String> = arm.muscles.iter().take(2).map(|muscle| muscle.name.clone()).collect();
    let force = |muscle: &String| Sensor {
        name: muscle.clone(),
        measures: Measure::Muscle { of: muscle.clone(), quantity: MuscleQuantity::Force },
        cutoff: 0.0,
    };
    arm.sensors = muscles.iter().map(force).collect();
    let tip = arm.sites.iter_mut().find(|site| site.name == arm.landmarks.fingertip).unwrap();
    (tip.shape, tip.quat) = (Some(Shape::Sphere { radius: 0.01 }), [0.8, 0.6, 0.0, 0.0]);
    // The second pulls no more.
    let transfers = BTreeMap::from([(muscles[0].clone(), muscles[1].clone())]);
    let moved = arm.clone().with_transfers(&transfers).unwrap();
    assert_eq!(Model::new(&moved).unwrap().sensors.len(), 1);
    let tall = Size { height_m: Some(2.0), ..Size::default() };
    let other = arm.clone().sized(&tall).unwrap().mirrored();
    let site = other.sites.iter().find(|site| site.name == arm.landmarks.fingertip).unwrap();
    assert_eq!(site.quat, [0.8, -0.6, 0.0, 0.0]);
    assert!(matches!(site.shape, Some(Shape::Sphere { radius }) if radius > 0.0105), "{:?}", site.shape);
}
