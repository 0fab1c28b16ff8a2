//! Frames of bodies, against joint transformations multiplied one after the other.

mod common;

use common::{arm, difference, random_state};
use myo_dynamics::spatial::Frame;
use myo_dynamics::{CouplingMode, Plan, Workspace, step::kinematics::kinematics};
use myo_model::Model;
use myo_model::description::JointKind;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// Frames of all bodies in the model's world.
fn chained(model: &Model, joints: &[f64]) -> Vec<Isometry3<f64>> {
    let mut frames = vec![Isometry3::identity()];
    for (index, body) in model.bodies.iter().enumerate().skip(1) {
        let mut frame = frames[body.parent] * Isometry3::from_parts(Translation3::from(body.pos), body.quat);
        for (joint, &position) in model.joints.iter().zip(joints).filter(|(joint, _)| joint.body == index) {
            let still = UnitQuaternion::identity();
            frame *= match joint.kind {
                JointKind::Ball | JointKind::Free => unreachable!("the arm has none"),
                JointKind::Slide => Isometry3::from_parts(Translation3::from(joint.axis * position), still),
                JointKind::Hinge => {
                    let turn = UnitQuaternion::from_axis_angle(&Unit::new_normalize(joint.axis), position);
                    Isometry3::from_parts(Translation3::from(joint.pos - turn * joint.pos), turn)
                }
            };
        }
        frames.push(frame);
    }
    frames
}

fn numbers(frame: &Frame<f64>) -> [f64; 12] {
    let Frame { rotation, position } = frame;
    let columns = [rotation.x, rotation.y, rotation.z, *position].map(|column| column.array());
    std::array::from_fn(|k| columns[k / 3][k % 3])
}

#[test]
fn frames_of_bodies_are_those_of_their_joints() {
    for name in ["mobl-arms", "mobl-arms-uitb"] {
        let model = arm(name);
        for coupling in [CouplingMode::Reduced, CouplingMode::Soft] {
            let plan = Plan::exact(&model, coupling).unwrap();
            let (origin, mut ws) = (Vector3::from(plan.origin), Workspace::<f64>::new(&plan));
            for number in 0..10 {
                let state = random_state(&plan, number);
                kinematics(&plan, &state.qpos, &state.qvel, &mut ws);
                let wanted = chained(&model, &plan.joint_positions(&state.qpos));
                assert_eq!(plan.elements.bodies.len(), wanted.len());
                for (body, (got, want)) in plan.elements.bodies.iter().zip(wanted).enumerate() {
                    let axes = want.rotation.to_rotation_matrix().into_inner();
                    let want = [axes.as_slice(), (want.translation.vector - origin).as_slice()].concat();
                    let off = difference(&numbers(&ws.fixed(got)), &want);
                    assert!(off < 1e-12, "{name}, {}: {off:e}", model.bodies[body].name);
                }
            }
        }
    }
}
