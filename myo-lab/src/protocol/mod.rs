//! What people were asked in studies, asked of a simulated user.
//!
//! A user learns the tasks of a protocol first ([`Practice`]), with its own body, rhythm, reward and noise. Then it is [recorded](record) at every
//! physics step, and the recordings become tables: [`FittsLaw`] (F1), [`Kinematics`] (K1), [`Scatter`] (K2), [`Stillness`] (K3), [`MuscleDrive`] (K5)
//! and [`KeyPresses`] (T1). [`Strength`] (M1) asks the body alone. What they found stands beside figures of people in
//! [`myo_measure::bands`].

mod answers;
mod error;
mod fitts;
mod holding;
mod keys;
mod kinematics;
mod plot;
mod pointing;
mod practice;
mod reach;
mod recording;
mod scatter;
mod strength;

pub use answers::{KeptAnswer, answer_path, kept_answers};
pub use error::ProtocolError;
pub use fitts::{FittsCondition, FittsFit, FittsLaw};
pub use holding::{DriveRow, MuscleDrive, Stillness, StillnessRow};
pub use keys::KeyPresses;
pub use kinematics::{KinematicRow, Kinematics, SpeedProfile};
pub use plot::{Plot, PlotError, PlotPoint, PlotSeries};
pub use pointing::{OverUsers, UserReaches};
pub use practice::{HOLD_DEG, Practice, SELECTIONS, circle_targets, conditions};
pub use reach::{Reach, reaches};
pub use recording::{Done, Recording, record};
pub use scatter::{Scatter, ScatterRow};
pub use strength::{HoldingShare, MomentArm, SignChange, Strength, StrengthError, StrengthRow};
