//! Environments against what they must do: one program, as each compiles the code of a step anew.

mod common;

mod accepted;
mod arrival;
mod conformance;
mod control_change;
mod cost_share;
mod driving;
mod exploring;
mod fatigue;
mod fingers;
mod groups;
mod held;
mod late;
mod limits;
mod meshes;
mod misjudge;
mod native;
mod parameters;
mod peek;
mod places;
mod precision;
mod reflex;
mod refused;
mod rules;
mod saved;
mod skeleton;
mod solver;
mod sticks;
mod trace;
