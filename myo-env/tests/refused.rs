//! What cannot be built is refused with a reason, whatever asks for it.

use crate::common::{arm, short, sphere};
use myo_env::{CpuEnv, EnvConfig};
use myo_tasks::{Observation, Scene, Task};

/// Why environments of this task are refused.
fn refusal(task: &Task, config: &EnvConfig) -> String {
    let model = arm(&short("pointing-uitb"));
    CpuEnv::new(&model, task, config).err().expect("it must be refused").to_string()
}

/// A body that is held by nothing would fall over.
#[test]
fn a_free_body_does_no_task() {
    let mut arm = myo_model::builtin("mobl-arms").unwrap();
    let held = "r_z";
    arm.couplings.retain(|coupling| coupling.dependent != held);
    let joint = arm.joints.iter_mut().find(|joint| joint.name == held).unwrap();
    (joint.kind, joint.axis, joint.pos, joint.range) =
        (myo_model::description::JointKind::Ball, [0.0; 3], [0.0; 3], None);
    (joint.stiffness, joint.spring_ref) = (0.0, 0.0);
    let model = myo_model::Model::new(&arm).unwrap();
    let refused = CpuEnv::new(&model, &short("pointing-uitb"), &EnvConfig::default()).err().unwrap().to_string();
    assert!(refused.starts_with(&format!("joint '{held}' moves in several ways at once")), "{refused}");
}

#[test]
fn a_task_made_by_code_is_checked_like_one_of_a_file() {
    let task = short("pointing-uitb");
    let one = EnvConfig::default();
    let refused = |task: Task, sentence: &str| {
        let text = refusal(&task, &one);
        assert!(text.contains(sentence), "{text}");
    };
    let idle = Task { script: vec![], ..task.clone() };
    refused(idle.clone(), "the script has no step");
    refused(Task { version: 1, scene: Scene::default(), ..idle }, "the task has no target; a task has from 1 to 10");
    refused(Task { time_limit_s: 1e308, ..task.clone() }, "`time_limit_s` is 1e308 s; it must be");
    refused(Task { control_dt_s: f64::NAN, ..task.clone() }, "`control_dt_s` is NaN; it must be from 0.001 to 0.5 s");
    refused(Task { version: 7, ..task.clone() }, "`version` is 7; versions 1 to 2 are known");
    let mut blind = task.clone();
    blind.observation = Observation {
        fingers: false,
        joint_position: false,
        joint_velocity: false,
        joint_acceleration: false,
        fingertip_position: false,
        activation: false,
        fatigue: false,
        control: false,
        target_position: false,
        target_size: false,
        target_vector: false,
        target_direction: false,
        next_target_vector: false,
        phase: false,
        dwell_fraction: false,
        time_left: false,
        inside: false,
        touch: false,
        pointer_position: false,
        target_velocity: false,
        cue: false,
        pause: false,
        drag: false,
        drive: false,
        steer: false,
        target_normal: false,
        target_kind: false,
        nearest_obstacle: false,
        traits: false,
    };
    refused(blind.clone(), "`observation` has no part; at least one must be true");
    blind.observation.cue = true;
    refused(blind, "`observation` has no part that this task has; at least one must be true");
    let mut repeated = task;
    sphere(&mut repeated, "ball").copies = Some(u32::MAX);
    refused(repeated, "4294967295");
}

#[test]
fn more_environments_than_the_memory_holds_are_refused_with_both_sizes() {
    for num_envs in [1 << 28, 1 << 31, 1 << 50, usize::MAX] {
        let text = refusal(&short("pointing-uitb"), &EnvConfig { num_envs, ..EnvConfig::default() });
        assert!(text.starts_with(&format!("{num_envs} environments ")), "{text}");
        assert!(text.contains("bytes") || text.contains("at most"), "{text}");
    }
}
