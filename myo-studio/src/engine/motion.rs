//! From moments of an environment to the numbers of a motion.

use myo_dynamics::spatial::Rotation;
use myo_env::{Bone, BuildError, Digit, EnvError, Role, Skeleton, SkeletonPose, Snapshot};
use myo_model::Model;
use myo_tasks::{Task, Technique};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

use crate::protocol::{BodyPart, BodyShape, BoneShape, DigitShape, LookShape, MotionLayout, MuscleShape};

/// What of the body that a task asks for stays the same, whatever its script and technique.
///
/// # Errors
/// The model cannot be simulated, or the task has values out of bounds.
pub fn shape(model: &Model, task: &Task) -> Result<BodyShape, BuildError> {
    let bare = Task { technique: Technique::default(), ..task.clone() };
    Ok(shape_of(&Skeleton::without_script(model, &bare)?))
}

fn shape_of(skeleton: &Skeleton) -> BodyShape {
    let model = skeleton.model();
    let part =
        |body: &myo_model::model::Body| BodyPart { name: body.name.clone(), parent: body.parent, mass_kg: body.mass };
    let muscle = |(index, muscle): (usize, &myo_model::model::Muscle)| {
        let on = skeleton.path_bodies(index);
        let peak_force_n = muscle.parameters.gain.force;
        MuscleShape { name: muscle.name.clone(), points: on.len(), on, peak_force_n }
    };
    BodyShape {
        name: model.name.clone(),
        parts: model.bodies.iter().map(part).collect(),
        limb: skeleton.limb().to_vec(),
        digits: skeleton.digits().iter().map(digit).collect(),
        muscles: model.muscles.iter().enumerate().map(muscle).collect(),
        is_left: model.has_left_arm(),
        looks: model.looks.iter().map(look).collect(),
        is_person: skeleton.is_person(),
        bones: skeleton.bones().into_iter().map(|Bone { bodies: parts, ends }| BoneShape { parts, ends }).collect(),
        moves_hand_only: skeleton.moves_hand_only(),
        stature_m: model.stature_m,
        joints: skeleton.joint_names().map(str::to_owned).collect(),
    }
}

fn look(look: &myo_model::model::Look) -> LookShape {
    LookShape {
        part: look.body,
        pos: look.pos.into(),
        quat: look.quat.coords.into(),
        step: look.step,
        points: look.points.to_string(),
        faces: look.faces.to_string(),
    }
}

fn digit(digit: &Digit) -> DigitShape {
    DigitShape { parts: digit.bodies.clone(), tip: digit.tip }
}

/// How the numbers of a frame lie.
pub fn layout(skeleton: &Skeleton) -> MotionLayout {
    let model = skeleton.model();
    MotionLayout {
        parts: model.bodies.len(),
        muscle_points: (0..model.muscles.len()).map(|muscle| skeleton.path_bodies(muscle).len()).collect(),
        joints: skeleton.joint_names().count(),
        objects: skeleton.task().objects.len(),
    }
}

/// Adds the numbers of a frame; `time_s` is that since the episode began.
///
/// # Errors
/// The moment is of another model or task.
pub fn push_frame(skeleton: &Skeleton, moment: &Snapshot, time_s: f64, numbers: &mut Vec<f32>) -> Result<(), EnvError> {
    let pose = skeleton.pose(moment)?;
    let mut push = |x: f64| numbers.push(x as f32);
    push(time_s);
    push(f64::from(moment.episode));
    push(pose.step.map_or(-1.0, |step| step as f64));
    pose.fingertip.into_iter().chain(pose.pointer).for_each(&mut push);
    push(moment.touch);
    for body in &pose.bodies {
        body.position.array().into_iter().chain(quaternion(&body.rotation)).for_each(&mut push);
    }
    for muscle in &pose.muscles {
        muscle.points.iter().flatten().copied().chain([muscle.activation]).for_each(&mut push);
    }
    moment.body.qpos.iter().copied().for_each(&mut push);
    objects(&pose, push);
    Ok(())
}

fn objects(pose: &SkeletonPose, mut push: impl FnMut(f64)) {
    for object in &pose.objects {
        object.frame.position.array().into_iter().for_each(&mut push);
        quaternion(&object.frame.rotation).into_iter().for_each(&mut push);
        object.half_size.into_iter().for_each(&mut push);
        push(object.value.unwrap_or(f64::NAN));
        push(match object.role {
            Role::Current => 0.0,
            Role::Later => 1.0,
            Role::Done => 2.0,
            Role::Bystander => 3.0,
        });
    }
}

/// `x y z w`.
fn quaternion(axes: &Rotation<f64>) -> [f64; 4] {
    let [x, y, z] = [axes.x, axes.y, axes.z].map(|axis| axis.array());
    let matrix = Matrix3::from_columns(&[x.into(), y.into(), z.into()]);
    let turned = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(matrix));
    turned.coords.into()
}
