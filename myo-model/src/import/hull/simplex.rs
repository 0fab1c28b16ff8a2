//! The four points that a hull begins with: those with the least and greatest x, then what spans most with these.

use super::HullError;
use nalgebra::Vector3;

/// Share of what it should be, below which a determinant may be one of a narrow simplex by mistake.
const NARROW: f64 = 1e-3;

/// What the points are like.
pub(super) struct Extent {
    /// Points with the least and greatest coordinate along each axis.
    pub extremes: Vec<usize>,
    /// Greatest extent along an axis (m).
    width: f64,
    /// Determinants of two and three points that are nothing (m^2, m^3).
    nothing: [f64; 2],
    /// What the distance of a point from a plane may be off by rounding (m).
    pub rounding: f64,
}

impl Extent {
    pub fn of(points: &[Vector3<f64>]) -> Self {
        let (mut extremes, mut width, mut most, mut sum) = (vec![], f64::NEG_INFINITY, 0.0_f64, 0.0);
        let mut nothing = [0.0; 3];
        for axis in 0..3 {
            let (mut low, mut high) = (0, 0);
            for (number, point) in points.iter().enumerate() {
                if points[high][axis] < point[axis] {
                    high = number;
                } else if points[low][axis] > point[axis] {
                    low = number;
                }
            }
            let (least, greatest) = (points[low][axis], points[high][axis]);
            width = width.max(greatest - least);
            most = most.max(greatest.max(-least));
            sum += greatest.max(-least);
            nothing[axis] = 10.0 * (80.0 * sum * f64::EPSILON);
            extremes.extend([low, high]);
        }
        let reach = (3.0_f64.sqrt() * most).min(sum);
        let rounding = f64::EPSILON * (3.0 * reach * 1.01 + most);
        Self { extremes, width, nothing: [nothing[1], nothing[2]], rounding }
    }

    /// Four points.
    pub fn simplex(&self, points: &[Vector3<f64>]) -> Result<[usize; 4], HullError> {
        let (mut low, mut high) = (self.extremes[0], self.extremes[0]);
        for &number in &self.extremes {
            if points[number].x > points[high].x {
                high = number;
            }
            if points[number].x < points[low].x {
                low = number;
            }
        }
        let mut simplex = vec![low, high];
        let mut span = points[high].x - points[low].x;
        while simplex.len() < 4 {
            let (next, larger) = self.furthest(points, &simplex, span).ok_or(HullError::Flat)?;
            simplex.push(next);
            span = larger;
        }
        let flat = span <= 0.0 || low == high;
        <[usize; 4]>::try_from(simplex).ok().filter(|_| !flat).ok_or(HullError::Flat)
    }

    /// The point that spans most with those of a simplex, and how much.
    fn furthest(&self, points: &[Vector3<f64>], simplex: &[usize], span: f64) -> Option<(usize, f64)> {
        let nothing = self.nothing[simplex.len() - 2];
        let mut best: Option<(usize, f64)> = None;
        for &number in &self.extremes {
            let spanned = spanned(points, simplex, number);
            if !simplex.contains(&number) && best.is_none_or(|(_, most)| spanned > most) {
                best = Some((number, spanned));
            }
        }
        let target = span * self.width;
        let is_poor = |(_, most): (usize, f64)| most < nothing || most > 0.0 && most / target < NARROW;
        if best.is_none_or(is_poor) {
            for number in (0..points.len()).filter(|k| !self.extremes.contains(k) && !simplex.contains(k)) {
                let spanned = spanned(points, simplex, number);
                if best.is_none_or(|(_, most)| spanned > most) {
                    best = Some((number, spanned));
                    if spanned >= nothing && spanned > 10.0 * NARROW * target {
                        break;
                    }
                }
            }
        }
        best
    }
}

/// The determinant that a point makes with two points in x and y, or with three.
fn spanned(points: &[Vector3<f64>], simplex: &[usize], apex: usize) -> f64 {
    let rows: Vec<Vector3<f64>> = simplex.iter().map(|&corner| points[corner] - points[apex]).collect();
    let two = |a1: f64, a2: f64, b1: f64, b2: f64| a1 * b2 - a2 * b1;
    let [a, b] = [rows[0], rows[1]];
    let determinant = match rows.get(2) {
        None => two(a.x, a.y, b.x, b.y),
        Some(c) => a.x * two(b.y, b.z, c.y, c.z) - b.x * two(a.y, a.z, c.y, c.z) + c.x * two(a.y, a.z, b.y, b.z),
    };
    determinant.abs()
}
