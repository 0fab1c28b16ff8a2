//! The simulated user: what of it stays, and how it moves.

use serde::{Deserialize, Serialize};

/// What of a body stays the same whatever it does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct BodyShape {
    /// Name of the model.
    pub name: String,
    /// Its bodies, the world first, parents before children.
    pub parts: Vec<BodyPart>,
    /// Indices of the parts from the upper arm down to the hand.
    pub limb: Vec<usize>,
    /// Fingers and thumb that move; none of a hand whose fingers are held.
    pub digits: Vec<DigitShape>,
    /// Its muscles.
    pub muscles: Vec<MuscleShape>,
    /// Whether it is a left arm.
    pub is_left: bool,
    /// What is seen of parts, where more is known than their bones.
    pub looks: Vec<LookShape>,
    /// Whether it is the arm of a person who faces along x, who is drawn around it; of any other body its bones are.
    pub is_person: bool,
    /// Its bones.
    pub bones: Vec<BoneShape>,
    /// Whether nothing moves from the trunk to the elbow.
    pub moves_hand_only: bool,
    /// Stature of the person (m), where it is known.
    pub stature_m: Option<f64>,
    /// Names of the independent joints, in the order of [`MotionLayout::joints`].
    pub joints: Vec<String>,
}

/// Triangles fixed to a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct LookShape {
    /// Index of the part.
    pub part: usize,
    /// Position of their frame in that of the part (m).
    pub pos: [f64; 3],
    /// Its orientation there, `x y z w`.
    pub quat: [f64; 4],
    /// Unit of the points (m).
    pub step: f64,
    /// Points in that unit: whole numbers of 16 bits, the lower byte first, in base 64.
    pub points: String,
    /// Indices of the points of triangles, of 16 bits without sign, in base 64.
    pub faces: String,
}

/// A bone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct BoneShape {
    /// Indices of the parts that its ends are fixed to.
    pub parts: [usize; 2],
    /// Its ends, as seen in these (m).
    pub ends: [[f64; 3]; 2],
}

/// A finger or thumb.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct DigitShape {
    /// Indices of its parts, the one next to the palm first.
    pub parts: Vec<usize>,
    /// Its tip, as seen in the last of them (m).
    pub tip: [f64; 3],
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct BodyPart {
    /// Name.
    pub name: String,
    /// Index of the part that it hangs on; of the world, itself.
    pub parent: usize,
    /// Mass (kg).
    pub mass_kg: f64,
}

/// A muscle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MuscleShape {
    /// Name.
    pub name: String,
    /// Number of points of its path, from origin to insertion.
    pub points: usize,
    /// Index of the part that each point is fixed to.
    pub on: Vec<usize>,
    /// Force of the muscle at full activation and its best length (N), where the model states it.
    pub peak_force_n: Option<f64>,
}

/// What a [`Motion`](super::Message::Motion) is a motion of, and how its numbers lie.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MotionLayout {
    /// Parts of the body: of each its origin (m from the shoulder centre, world axes) and its orientation as a quaternion, `x y z w`.
    pub parts: usize,
    /// Points of each muscle: of each muscle its points (m), then its activation in [0, 1].
    pub muscle_points: Vec<usize>,
    /// Independent joints: of each its coordinate (rad).
    pub joints: usize,
    /// Objects of the task: of each its centre (m), its orientation `x y z w`, half its sizes along its own axes (m), its value (NaN without
    /// one), its part in the task (0 current, 1 later, 2 done, 3 bystander).
    pub objects: usize,
}

/// Numbers of a frame that are those of the moment: time (s) since the episode began, its number, the step that is to do (-1 once all
/// are done), fingertip (m), pointer (m), force on what is touched (N).
pub const MOMENT: usize = 10;
/// Numbers of a part of the body.
pub const PART: usize = 7;
/// Numbers of an object.
pub const OBJECT: usize = 12;

impl MotionLayout {
    /// Numbers of one frame: those of the moment, then of parts, muscles, joints and objects.
    pub fn frame_size(&self) -> usize {
        let muscles: usize = self.muscle_points.iter().map(|points| 3 * points + 1).sum();
        MOMENT + PART * self.parts + muscles + self.joints + OBJECT * self.objects
    }
}
