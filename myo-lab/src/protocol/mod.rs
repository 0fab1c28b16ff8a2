//! What people were asked in studies, asked of a simulated user.
//!
//! A user learns the tasks of a protocol first ([`Practice`]), with its own body, rhythm, reward and noise. Then it is [recorded](record) at every
//! physics step, and the recordings become tables: [`FittsLaw`] (F1), [`Kinematics`] (K1), [`Scatter`] (K2), [`Stillness`] (K3), [`MuscleDrive`] (K5),
//! [`KeyPresses`] (T1), [`Typing`] (T3), [`SteeringLaw`] (S1), [`Pursuit`] (S2), [`EllipseLaps`] (K4), [`ChoiceReaction`] (C1), [`RayPointing`] (I1), [`FarReaches`] (I2)
//! and [`WorkInTheAir`] (E2). [`Strength`] (M1), [`Endurance`] (E1) and [`Recovery`] (E3) ask the body alone. What they found stands beside figures of people in
//! [`myo_measure::bands`].

mod answers;
mod choosing;
mod ellipse;
mod endurance;
mod error;
mod far;
mod fitts;
mod holding;
mod keys;
mod kinematics;
mod plot;
mod pointing;
mod practice;
mod ray;
mod reach;
mod recording;
mod scatter;
mod sizes;
mod steering;
mod strength;
mod tracking;
mod typing;
mod working;

pub use answers::{KeptAnswer, answer_path, kept_answers};
pub use choosing::{ChoiceReaction, ChoiceRow};
pub use ellipse::EllipseLaps;
pub use endurance::{Endurance, EnduranceRow, Recovery, RecoveryRow};
pub use error::ProtocolError;
pub use far::{FarReaches, FarRow};
pub use fitts::{FittsCondition, FittsFit, FittsLaw};
pub use holding::{DriveRow, MuscleDrive, Stillness, StillnessRow};
pub use keys::KeyPresses;
pub use kinematics::{KinematicRow, Kinematics, SpeedProfile};
pub use plot::{Plot, PlotError, PlotPoint, PlotSeries};
pub use pointing::{OverUsers, UserReaches};
pub use practice::{
    BEFORE_WAY, CHOICES, FAR, FAR_REACHES, HOLD_DEG, LAP_PIECES, LAPS, Practice, REACTIONS, SELECTIONS, TYPED,
    WAY_PIECES, Way, circle_targets, conditions, ray_pairs, ways,
};
pub(crate) use practice::{DWELL_S, Layout, PLANE_X, circle};
pub use ray::{RayLaw, RayPointing, RayRow};
pub(crate) use reach::{Aimed, CUT_OFF_HZ, StraightOn, Track, mean_profile};
pub use reach::{Reach, reaches};
pub use recording::{Done, Recording, Targets, record};
pub use scatter::{Scatter, ScatterRow};
pub use sizes::{SizeRow, Sizes, SizesError, WomanOfMan};
pub use steering::{SteeringFit, SteeringLaw, SteeringRow};
pub use strength::{HoldingShare, MomentArm, SignChange, Strength, StrengthError, StrengthRow};
pub use tracking::{Pursuit, PursuitRow};
pub use typing::{Typing, TypingRow};
pub use working::{WorkInTheAir, WorkRow};
