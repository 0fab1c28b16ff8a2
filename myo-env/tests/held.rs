//! A body that is held, whose parts touch with friction in cones, and whose steps are implicit, does tasks on every backend.

use crate::common::{assert_follows, fast, gpu, rollout, without_gpu};
use myo_env::{CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, Snapshot, StepStorage, VectorEnv};
use myo_model::description::{Cone, Connection, Contact, Geom, Integrator, Shape, Softness, Weld};
use myo_model::{Model, builtin};

/// The arm with its forearm on a strap and its hand on a spring, and a pad on its hand that rubs against its trunk.
fn held(cone: Cone, integrator: Integrator) -> Model {
    let mut arm = builtin("mobl-arms").unwrap();
    (arm.options.cone, arm.options.integrator, arm.options.impratio) = (cone, integrator, 2.0);
    let softness = Softness { solref: [0.3, 1.0], ..Softness::default() };
    let hold = |body: &str, weld: Option<Weld>| Connection {
        bodies: [body, "thorax"].map(String::from),
        anchors: [[0.0; 3], [0.3, -0.2, 0.2]],
        weld,
        softness,
    };
    arm.connections.push(hold("radius", None));
    arm.connections.push(hold("hand", Some(Weld { quat: [0.8, 0.6, 0.0, 0.0], torque_scale: 0.1 })));
    for (name, body, radius) in [("trunk", "thorax", 0.35), ("pad", "hand", 0.12)] {
        let shape = Shape::Ellipsoid { radii: [radius, radius, 0.9 * radius] };
        arm.geoms.push(Geom { name: name.into(), body: body.into(), shape, pos: [0.0; 3], ..arm.geoms[0].clone() });
    }
    arm.contacts.push(Contact {
        geoms: ["trunk", "pad"].map(String::from),
        friction: 0.8,
        friction_across: Some(0.5),
        torsional: 0.02,
        rolling: [0.01; 2],
        ..Contact::default()
    });
    Model::new(&arm).unwrap()
}

const STEPS: usize = 12;

fn runs(env: &mut dyn VectorEnv) -> Vec<StepStorage> {
    rollout(env, STEPS)
}

#[test]
fn lanes_and_cards_follow_the_reference() {
    let (task, config) = (fast("pointing-uitb"), EnvConfig { num_envs: 32, ..EnvConfig::default() });
    for (cone, integrator) in [
        (Cone::Elliptic, Integrator::ImplicitFast),
        (Cone::Pyramidal, Integrator::ImplicitFast),
        (Cone::Pyramidal, Integrator::Implicit),
    ] {
        let model = held(cone, integrator);
        let mut reference = ReferenceEnv::new(&model, &task, &config).unwrap();
        let wanted = runs(&mut reference);
        let saved = reference.save_state().unwrap();
        let moved = |env: usize| Snapshot::read(reference.tables(), &saved, env).unwrap().body.qvel;
        assert!((0..config.num_envs).all(|env| moved(env).iter().any(|rate| rate.abs() > 1e-3)), "they move");
        let mut lanes = CpuEnv::new(&model, &task, &config).unwrap();
        for (step, (got, want)) in runs(&mut lanes).iter().zip(&wanted).enumerate() {
            assert_follows(&reference, got, want, &format!("lanes, {cone:?}, {integrator:?}, step {step}"));
        }
        if !without_gpu() {
            let mut card = GpuEnv::new(&gpu(), &model, &task, &config).unwrap();
            for (step, (got, want)) in runs(&mut card).iter().zip(&wanted).enumerate() {
                assert_follows(&reference, got, want, &format!("card, {cone:?}, {integrator:?}, step {step}"));
            }
        }
    }
}
