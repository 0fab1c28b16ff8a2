//! Readers of the sections, one file each.

mod actuators;
mod assets;
mod constraints;
mod sensors;
mod settings;
mod visuals;
