//! What was published of other systems.

use serde::Serialize;

/// A training time that was published: means and standard deviations over runs, until the reward curve looked flat to its authors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedTraining {
    /// The system, and which of its tasks.
    pub system: &'static str,
    /// Our preset that asks for the same.
    pub preset: &'static str,
    /// How many users were trained.
    pub runs: u32,
    /// Control steps.
    pub env_steps: [f64; 2],
    /// Seconds.
    pub wall_s: [f64; 2],
}

/// Where the figures are from: MyoInteract (Bhattarai et al. 2026, arXiv 2602.15245) on an RTX 5090, who trained User-in-the-Box (Ikkala et al. 2022,
/// doi 10.1145/3526113.3545689), too.
pub const TRAININGS: [PublishedTraining; 6] = [
    PublishedTraining {
        system: "User-in-the-Box, pointing",
        preset: "pointing-replication",
        runs: 3,
        env_steps: [42.9e6, 9.0e6],
        wall_s: [6.9 * 3600.0, 1.5 * 3600.0],
    },
    PublishedTraining {
        system: "MyoInteract (Replication), pointing",
        preset: "pointing-replication",
        runs: 5,
        env_steps: [7.4e6, 0.8e6],
        wall_s: [0.17 * 3600.0, 0.03 * 3600.0],
    },
    PublishedTraining {
        system: "MyoInteract (Default), pointing",
        preset: "pointing-uitb",
        runs: 5,
        env_steps: [34.9e6, 1.9e6],
        wall_s: [0.60 * 3600.0, 0.03 * 3600.0],
    },
    PublishedTraining {
        system: "MyoInteract, AR",
        preset: "ar",
        runs: 5,
        env_steps: [9.9e6, 1.3e6],
        wall_s: [23.2 * 60.0, 2.2 * 60.0],
    },
    PublishedTraining {
        system: "MyoInteract, public display",
        preset: "public-display",
        runs: 5,
        env_steps: [6.7e6, 2.5e6],
        wall_s: [14.9 * 60.0, 4.9 * 60.0],
    },
    PublishedTraining {
        system: "MyoInteract, mobile typing",
        preset: "mobile-typing",
        runs: 5,
        env_steps: [10.4e6, 4.1e6],
        wall_s: [11.7 * 60.0, 3.9 * 60.0],
    },
];

/// Control steps after which the published pointing user of MyoInteract (Default) was asked for the figures.
pub const FIGURE_STEPS: u64 = 34_900_000;

/// R2 of Fitts' law as published: MyoInteract (Default), and (Replication).
pub const PUBLISHED_R2: [f64; 2] = [0.89, 0.90];
