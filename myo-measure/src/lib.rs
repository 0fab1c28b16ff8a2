//! Measures of recorded movements, for simulated users and real people alike: positions over time in, figures out.
//!
//! - [`signal`] makes times even and smooths without delay;
//! - [`Movement`] finds onset and end of one movement, and its speeds, shape and [`smoothness`];
//! - [`fitts`] is Fitts' law and throughput, of one user and over several;
//! - [`EndpointCloud`] says how repeats of one movement scatter, [`Hold`] how still a hand is held;
//! - [`ergonomics`] says how long a raised arm can be held and in which postures it is;
//! - [`drive`] is about activations of muscles, [`taps`] about contact forces, [`steering`] about paths through tunnels, [`tracking`] about moving targets,
//!   [`power_law`] about speed and curvature;
//! - [`bands`] holds figures of people, and judges figures of simulated users by them.
//!
//! A movement as minimum jerk has it, 30 cm in 0.6 s, after a rest and before one:
//!
//! ```
//! use myo_measure::bands::{Figure, Figures, Verdict, judge};
//! use myo_measure::{Edge, Movement};
//! let rate_hz = 100.0;
//! let at = |sample: i32| {
//!     let s = ((f64::from(sample) / rate_hz - 0.2) / 0.6).clamp(0.0, 1.0);
//!     [0.3 * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s), 0.0, 0.0]
//! };
//! let positions: Vec<[f64; 3]> = (0..100).map(at).collect();
//! let movement = Movement::of(&positions, rate_hz, Edge::Threshold, Edge::Threshold)?;
//! assert!((movement.peak_speed - 1.875 * 0.3 / 0.6).abs() < 0.01);
//! assert_eq!(movement.speed_maxima, 1);
//!
//! // As fast as people are; how jagged or how accurate such movements are in the mean was not measured.
//! let mut figures = Figures::new();
//! figures.set(Figure::PeakSpeed30, movement.peak_speed)?.set(Figure::PeakOverMean, movement.peak_over_mean)?;
//! let judged = judge(&figures);
//! assert_eq!((judged[4].band.number, judged[4].verdict), (5, Verdict::Passed));
//! assert_eq!(judged[0].verdict, Verdict::NotMeasured);
//! # Ok::<(), myo_measure::MeasureError>(())
//! ```
//!
//! Lengths are in m, times in s, forces in N. Where there is no figure there is an error that says why, or nothing, never a
//! number: too few samples, movements or indices of difficulty, no movement, a recording that begins amid one.
//!
//! This crate knows no simulators, no files and no plots. It does not know which target was meant, when it lit up or what counts
//! as a hit: who calls it does, and gives the end of a movement where the target decides it. It smooths nothing by itself. A figure
//! inside of its band does not make a user human; one outside tells where to look.

pub mod bands;
mod check;
pub mod drive;
pub mod endpoints;
pub mod ergonomics;
mod error;
pub mod fitts;
pub mod hold;
pub mod movement;
mod point;
pub mod power_law;
pub mod signal;
pub mod smoothness;
pub mod statistics;
pub mod steering;
pub mod taps;
pub mod tracking;

pub use drive::Drive;
pub use endpoints::EndpointCloud;
pub use error::{MeasureError, Result};
pub use hold::Hold;
pub use movement::{Edge, Movement};
pub use point::{Point, centre};
pub use statistics::{Line, Spread};
