//! The steering law: how long a path through a tunnel takes.
//!
//! `MT = a + b A / W` for a tunnel of length `A` and constant width `W` (Accot and Zhai 1997, doi 10.1145/258549.258760).

use crate::{Line, Result, check};

/// Fewest different quotients of length and width that a line is put through.
pub const LEAST_INDICES: usize = 3;
/// Quotients closer than this share are the same.
const SAME_INDEX: f64 = 1e-9;

/// Passes through one tunnel.
#[derive(Clone, Debug, PartialEq)]
pub struct Tunnel {
    /// Length in m.
    pub length: f64,
    /// Width in m.
    pub width: f64,
    /// Times in s of passes that did not leave the tunnel.
    pub times_s: Vec<f64>,
    /// Passes that left it.
    pub left: usize,
}

impl Tunnel {
    /// Index of difficulty, length over width.
    pub fn index(&self) -> f64 {
        self.length / self.width
    }
}

/// The steering law of some tunnels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steering {
    /// Through mean times of tunnels: intercept in s, slope in s per unit of length over width.
    pub fit: Line,
    /// Share of all passes that left their tunnel.
    pub left: f64,
}

impl Steering {
    /// Of tunnels of at least three different indices, each with a pass that did not leave it.
    ///
    /// # Errors
    /// Fewer indices or passes, lengths, widths or times that are not positive, the same mean time throughout.
    pub fn of(tunnels: &[Tunnel]) -> Result<Self> {
        tunnels
            .iter()
            .enumerate()
            .try_for_each(|(i, tunnel)| check_tunnel(tunnel).map_err(|e| e.within("tunnel", i)))?;
        let (x, y): (Vec<f64>, Vec<f64>) =
            tunnels.iter().map(|tunnel| (tunnel.index(), crate::statistics::mean(&tunnel.times_s))).unzip();
        let mut indices = x.clone();
        indices.sort_by(f64::total_cmp);
        indices.dedup_by(|a, b| (*a - *b).abs() <= SAME_INDEX * b.abs());
        check::at_least("different quotients of length and width for a fit", indices.len(), LEAST_INDICES)?;
        let left: usize = tunnels.iter().map(|tunnel| tunnel.left).sum();
        let passed: usize = tunnels.iter().map(|tunnel| tunnel.times_s.len()).sum();
        Ok(Self { fit: Line::through(&x, &y)?, left: left as f64 / (left + passed) as f64 })
    }
}

fn check_tunnel(tunnel: &Tunnel) -> Result<()> {
    let positive = "finite and greater than 0";
    check::setting("length in m", tunnel.length, positive, tunnel.length > 0.0)?;
    check::setting("width in m", tunnel.width, positive, tunnel.width > 0.0)?;
    check::at_least("passes", tunnel.times_s.len(), 1)?;
    check::within("time in s", &tunnel.times_s, positive, |time| time > 0.0)
}
