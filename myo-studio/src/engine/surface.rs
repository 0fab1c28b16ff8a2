//! How far the pointer of a task reaches, as a surface around the shoulder.

use std::f64::consts::{PI, TAU};

use myo_tasks::Reach;
use rayon::prelude::*;

use crate::protocol::Surface;

/// Rings of corners from the top to the bottom, and corners of a ring.
const RINGS: usize = 20;
const CORNERS: usize = 32;
/// From here (m) the nearest place in reach is looked for: farther than any arm.
const FAR_M: f64 = 1.5;

/// The places in reach that are nearest to a wide sphere around the shoulder.
pub fn surface(reach: &(dyn Reach + Sync)) -> Surface {
    let direction = |index: usize| {
        let (ring, corner) = (index / CORNERS, index % CORNERS);
        let (from_top, around) = (PI * (ring as f64 + 0.5) / RINGS as f64, TAU * corner as f64 / CORNERS as f64);
        [from_top.sin() * around.cos(), from_top.sin() * around.sin(), from_top.cos()]
    };
    let place = |index: usize| reach.nearest_in_reach(direction(index).map(|x| FAR_M * x)).map(|x| x as f32);
    let points: Vec<[f32; 3]> = (0..RINGS * CORNERS).into_par_iter().map(place).collect();
    let corner = |ring: usize, corner: usize| (ring * CORNERS + corner % CORNERS) as u32;
    let quad = |ring: usize, at: usize| {
        let [a, b, c, d] = [corner(ring, at), corner(ring, at + 1), corner(ring + 1, at), corner(ring + 1, at + 1)];
        [[a, c, b], [b, c, d]]
    };
    let sides = (0..RINGS - 1).flat_map(|ring| (0..CORNERS).flat_map(move |at| quad(ring, at)));
    let lid = |ring: usize| (1..CORNERS - 1).map(move |at| [corner(ring, 0), corner(ring, at), corner(ring, at + 1)]);
    let triangles = sides.chain(lid(0)).chain(lid(RINGS - 1)).collect();
    Surface { points, triangles }
}
