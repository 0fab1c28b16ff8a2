//! Pointing and pressing tasks for a simulated user: their description, presets and checks.
//!
//! A [`Task`] is a [`Scene`] of named objects (spheres, buttons, obstacles; in groups, grids, circles and keyboards) and a
//! script of [`Instruction`]s that name them, within a time limit. It is a YAML text with documented fields ([`task_schema`] gives
//! them to editors and forms), read by [`load`] or [`Task::from_yaml`]; anything wrong in the text is reported with file, line
//! and column. [`Task::flat`] writes out every object and every step. [`check`] then tells, before any training, what cannot be
//! done by a body of a given [`Reach`]. Files of version 1, a list of [`Target`]s, are read as well.
//!
//! ```
//! use myo_tasks::{Anywhere, Task, check, preset_text};
//!
//! // One of the tasks that come with the library, slower.
//! let text = preset_text("pointing-single").unwrap().replace("for_s: 0.25", "for_s: 0.5");
//! let task = Task::from_yaml(&text, "my.yaml")?;
//! assert_eq!(task.flat()?.steps[0].dwell_s(), Some(0.5));
//! assert!(check(&task, &Anywhere).is_ok());
//!
//! // What is wrong is said where it stands.
//! let error = Task::from_yaml(&text.replace("for_s", "fors"), "my.yaml").unwrap_err();
//! assert!(error.to_string().contains("unknown key `fors` in `dwell` of entry 1 of the script; did you mean `for_s`?"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Lengths are metres relative to the shoulder centre (x forward, y to the left, z up), times seconds, forces newtons.
//!
//! What this crate does not know: bodies and how they move, random numbers' origin, learning, and what happens to a
//! reward once it is given. Files it only reads.

mod body;
mod check;
mod convert;
mod description;
mod expand;
mod explain;
mod fingers;
mod flat;
mod geometry;
mod instruction;
mod items;
mod layout;
mod load;
mod load_error;
pub mod logic;
mod motion;
mod motor;
mod notation;
mod pointer;
mod presets;
mod quantity;
mod range;
mod remedy;
mod report;
mod rules;
mod scene;
mod schema;
mod script;
mod slider;
mod spoken;
mod steps;
mod stick;
mod tagged;
mod target;
mod technique;
mod user;
mod weakness;

pub use body::{Body, Hand};
pub use check::{Anywhere, RARE_ACCEPTANCE, Reach, check, places_apart};
pub use description::{Control, FORMAT_VERSION, Observation, Pose, Reset, Reward, Stimulus, Task, rounded_steps};
pub use expand::{OBJECTS_MAX, STEPS_MAX};
pub use flat::{Action, Block, Cue, FlatTask, Object, Order, Pointer, Shape, Shift, Sphere, Step};
pub use geometry::spread;
pub use items::{Axes, PlacedItem};
pub use layout::SourceLocation;
pub use load::{SCHEMA_HINT, Source, load};
pub use load_error::{BadValue, LoadError};
pub use motion::{
    CircularMotion, DrivenMotion, LinearMotion, Motion, Path, PathDriven, PathSines, PathWave, RandomMotion,
    SinesMotion, Wave, Waves,
};
pub use motor::{Fatigue, Noise, Reflex};
pub use notation::{Name, Pitch, Place};
pub use presets::{preset, preset_names, preset_text};
pub use range::Range;
pub use remedy::{Move, Remedy};
pub use report::{Element, HeldPlace, InvalidTask, Report, TaskError, TaskWarning};
pub use scene::{Arc, ButtonItem, Circle, Grid, Group, Item, Keyboard, Letters, ObstacleItem, Scene, SphereItem};
pub use schema::task_schema;
pub use script::{Drag, Drive, Dwell, Follow, Instruction, Names, React, Repeat, Steer, Swing, Track, Typing};
pub use slider::{Direction, Slider, SliderItem};
pub use stick::{Stick, StickItem};
pub use target::{Pointing, Pressing, Region, TARGETS_MAX, Target};
pub use technique::{Cursor, GoGo, RateCursor, Ray, RayFrom, Technique};
pub use user::{Perception, User};
