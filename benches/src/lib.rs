//! What the benches of this workspace share: scenes in data, made-up numbers, checks of results, the machine.
//!
//! `cargo bench -p myo-benches` measures everything, `-- --quick` in a minute or two; `README.md` beside this crate says more.
//! A bench is a scene of `scenes.json` with a name; what it computes is checked, so that nothing is timed that went wrong.
//! Tests run every bench once, untimed.

mod batches;
mod check;
mod idle;
mod machine;
mod numbers;
mod roll_out;
mod scenes;

pub use batches::{Failure, breakdown, seconds};
pub use check::assert_finite;
pub use idle::Idle;
pub use machine::{card, harness, one_core};
pub use numbers::Numbers;
pub use roll_out::RollOut;
pub use scenes::{EnvScene, KernelKind, KernelScene, PhysicsScene, SCENES};
