//! Masses on links, and carrying them further up the chain.

use super::{Body, LinkMotion, Plan};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Distances (m) and shares of inertia below this are rounding.
const NEGLIGIBLE: f64 = 1e-12;

impl Body<f64> {
    /// From the inertia about the centre of mass, in the link's axes (kg m^2).
    pub(super) fn new(link: usize, mass: f64, com: Vector3<f64>, inertia: Matrix3<f64>) -> Self {
        let eigen = SymmetricEigen::new(inertia);
        let (least, scale) = (eigen.eigenvalues.imin(), eigen.eigenvalues.amax());
        let isotropic = eigen.eigenvalues[least];
        let arm = |k: usize| {
            let surplus = eigen.eigenvalues[k] - isotropic;
            let length = if surplus > NEGLIGIBLE * scale { surplus.sqrt() } else { 0.0 };
            (eigen.eigenvectors.column(k) * length).into()
        };
        Self { link, mass, com: com.into(), isotropic, arms: [arm((least + 1) % 3), arm((least + 2) % 3)] }
    }

    /// Inertia about the centre of mass, in the link's axes (kg m^2).
    fn inertia(&self) -> Matrix3<f64> {
        let [a, b] = self.arms.map(Vector3::from);
        Matrix3::identity() * self.isotropic + a * a.transpose() + b * b.transpose()
    }

    /// This body and a mass at a point as one.
    fn with_mass_at(&self, mass: f64, point: Vector3<f64>) -> Self {
        let (whole, com) = (self.mass + mass, Vector3::from(self.com));
        let centre = (com * self.mass + point * mass) / whole;
        let about = |mass: f64, place: Vector3<f64>| {
            let d = place - centre;
            (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * mass
        };
        Self::new(self.link, whole, centre, self.inertia() + about(self.mass, com) + about(mass, point))
    }
}

impl Plan<f64> {
    /// A mass whose centre lies on its link's hinge does not move when the hinge turns, so it is a mass of the parent;
    /// what stays is a body that resists turning only.
    pub(super) fn lift_masses(&mut self) {
        // Parents come before children, so that a mass can go up several joints.
        for link in (1..self.links.len()).rev() {
            self.lift_mass(link);
        }
        self.bodies.retain(|body| body.mass > 0.0 || body.inertia().norm() > 0.0);
    }

    fn lift_mass(&mut self, link: usize) {
        let LinkMotion::Hinge(placement) = &self.links[link].motion else { return };
        let (placement, parent) = (placement.clone(), self.links[link].parent);
        let on_axis = |body: &&mut Body<f64>| body.mass > 0.0 && body.com[0].hypot(body.com[1]) < NEGLIGIBLE;
        let Some(body) = self.bodies.iter_mut().filter(|body| body.link == link).find(on_axis) else { return };
        let along = body.com[2];
        let mass = std::mem::take(&mut body.mass);
        body.com = [0.0; 3];
        let axis = placement.axes.map_or(Vector3::z(), |columns| Vector3::from(columns[2]));
        self.add_mass(parent, mass, Vector3::from(placement.offset) + axis * along);
    }

    /// Adds a mass at a point of a link; on the world it matters to nothing.
    fn add_mass(&mut self, link: usize, mass: f64, at: Vector3<f64>) {
        if link == 0 {
            return;
        }
        match self.bodies.iter_mut().find(|body| body.link == link) {
            Some(body) => *body = body.with_mass_at(mass, at),
            None => self.bodies.push(Body::new(link, mass, at, Matrix3::zeros())),
        }
    }
}
