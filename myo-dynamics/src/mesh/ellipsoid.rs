//! An ellipsoid and a convex mesh: one contact, the least overlap over all normals.

use super::contacts::{Contacts, single};
use super::placed::Placed;
use super::round::{Round, Search, bisected};
use super::scratch::Scratch;
use super::touch::{Touch, are_quickly_apart};
use nalgebra::Vector3;

/// An ellipsoid of semi-axes along its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipsoid {
    pub radii: Vector3<f64>,
}

impl Round for Ellipsoid {
    fn furthest(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        let scaled = direction.component_mul(&self.radii);
        scaled.component_mul(&self.radii) / scaled.norm()
    }
}

impl Ellipsoid {
    /// The contact with a mesh, up to a margin (m).
    pub fn contacts(
        &self,
        mesh: &Placed<'_>,
        towards: &mut Vector3<f64>,
        margin: f64,
        scratch: &mut Scratch,
    ) -> Contacts {
        if are_quickly_apart(|direction| self.furthest(direction), mesh, *towards, margin) {
            return Contacts::default();
        }
        let touch = self.touch(mesh, scratch);
        *towards = touch.normal;
        if touch.depth > -margin { single(&touch, 0.0) } else { Contacts::default() }
    }

    /// Where it and a mesh touch, wherever they are.
    pub(super) fn touch(&self, mesh: &Placed<'_>, scratch: &mut Scratch) -> Touch {
        let mut search = Search::new(self, mesh, scratch);
        for (number, vertex) in search.vertices().iter().enumerate() {
            if search.may_count(number) {
                self.normals_through(vertex, |normal| search.at_vertex(&normal, number));
            }
        }
        search.along_arcs(|_| true);
        search.best
    }

    /// Normals of the surface that pass through a point.
    ///
    /// The normal through y has the direction of y / (a² + t), a being the semi-axes, where the sum of (a y / (a² + t))² is one.
    fn normals_through(&self, point: &Vector3<f64>, mut found: impl FnMut(Vector3<f64>)) {
        let squares = self.radii.component_mul(&self.radii);
        let numerators = squares.component_mul(&point.component_mul(point));
        let excess = |t: f64| numerators.component_div(&squares.map(|square| (square + t).powi(2))).sum() - 1.0;
        let mut tell = |root: f64| {
            let normal = point.component_div(&squares.map(|square| square + root));
            if let Some(normal) = normal.try_normalize(f64::MIN_POSITIVE) {
                found(normal);
            }
        };
        // The nearest point of the surface has the root that is greater than all poles.
        let shortest = squares.imin();
        let low = point[shortest].abs() * self.radii[shortest] - squares[shortest];
        tell(bisected(excess, low, low.max(numerators.sum().sqrt())));
        // Of a point deep inside, a surface point further away may be the one that counts. Between two poles the sum is convex.
        let slope = |t: f64| -numerators.component_div(&squares.map(|square| (square + t).powi(3))).sum();
        let mut poles: [f64; 3] = (-squares).into();
        poles.sort_unstable_by(f64::total_cmp);
        for [low, high] in [[poles[0], poles[1]], [poles[1], poles[2]]] {
            let least = bisected(slope, low, high);
            if excess(least) < 0.0 {
                tell(bisected(excess, low, least));
                tell(bisected(excess, least, high));
            }
        }
    }
}
