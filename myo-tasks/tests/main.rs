//! Tasks against what they must do: one program, as each compiles the code of a step anew.

mod common;

mod arrival;
mod bad_input;
mod driving;
mod fingers;
mod known_values;
mod limits;
mod motions;
mod orders;
mod places;
mod presets;
mod remedies;
mod scenes;
mod steering;
mod sticks;
mod touch;
mod users;
