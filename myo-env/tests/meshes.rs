//! A body whose meshes touch: it does tasks on processors, and cards refuse it by name.

use myo_env::gpu::record;
use myo_env::{CpuEnv, EnvConfig, ReferenceEnv, StepStorage, VectorEnv};
use myo_model::description::{Contact, Geom, Hull, Shape};
use myo_model::{Model, builtin};
use myo_tasks::preset;

/// The arm with a stone in its hand and one on its trunk.
fn arm_with_stones() -> Model {
    let mut arm = builtin("mobl-arms").unwrap();
    // A tetrahedron with edges of a decimetre.
    arm.hulls.push(Hull {
        points: "mpmZmZmZuT8AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAACamZmZmZm5PwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAJqZmZmZmbk/AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA".into(),
        triangles: "AAABAAIAAQAAAAMAAgABAAMAAAACAAMA".into(),
        polygons: "AwAAAAEAAgADAAEAAAADAAMAAgABAAMAAwAAAAIAAwA=".into(),
    });
    for (name, body) in [("trunk", "thorax"), ("stone", "hand")] {
        let shape = Shape::Mesh { hull: 0, scale: 2.0 };
        arm.geoms.push(Geom { name: name.into(), body: body.into(), shape, pos: [0.0; 3], ..arm.geoms[0].clone() });
    }
    arm.contacts.push(Contact {
        geoms: ["trunk", "stone"].map(String::from),
        margin: 0.001,
        friction: 0.8,
        ..Contact::default()
    });
    Model::new(&arm).unwrap()
}

#[test]
fn meshes_that_touch_are_refused_by_cards_and_nothing_else() {
    let (model, task) = (arm_with_stones(), preset("pointing").unwrap());
    let config = EnvConfig { num_envs: 16, ..EnvConfig::default() };
    let reference = ReferenceEnv::new(&model, &task, &EnvConfig { num_envs: 1, ..config }).unwrap();
    assert_eq!(
        record::check(reference.tables()).unwrap_err().to_string(),
        "contacts of meshes, and of boxes with anything but planes, spheres and capsules, are not simulated on graphics cards; take the cpu backend, or import the body without contacts (`myo model import --without-contacts`)"
    );
    let mut env = CpuEnv::new(&model, &task, &config).unwrap();
    let mut out = StepStorage::new(env.spec());
    env.reset(Some(1), None, &mut out.observation).unwrap();
    let actions = vec![0.5; env.spec().num_envs * env.spec().action_size()];
    for _ in 0..50 {
        env.step(&actions, out.buffers()).unwrap();
    }
    assert!(out.observation.iter().all(|x| x.is_finite()));
}
