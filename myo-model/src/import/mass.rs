//! Mass of bodies, as the file gives it or as their shapes make it.

use super::{Import, written};
use myo_mjcf::{Auto, Body, Geom, Shape};
use nalgebra::{Matrix3, Quaternion, Rotation3, SymmetricEigen, UnitQuaternion, Vector3};
use std::f64::consts::PI;

/// Mass of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mass {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the body (m).
    pub com: [f64; 3],
    /// Principal moments (kg m^2).
    pub inertia: [f64; 3],
    /// Principal axes in the body (w, x, y, z).
    pub quat: [f64; 4],
}

const NOTHING: Mass = Mass { mass: 0.0, com: [0.0; 3], inertia: [0.0; 3], quat: [1.0, 0.0, 0.0, 0.0] };

impl Import<'_> {
    /// That of a body; nothing of one that stands still and whose shapes do not tell.
    pub(super) fn mass(&mut self, number: usize, moves: bool) -> Mass {
        let (body, compiler) = (&self.mjcf.bodies[number], &self.mjcf.compiler);
        let written = body.inertial.as_ref().filter(|_| compiler.inertiafromgeom() != Auto::Yes);
        let mut mass = match written {
            Some(inertial) => {
                let inertia = inertial.fullinertia.map(principal);
                let (inertia, quat) = inertia.unwrap_or_else(|| (inertial.diaginertia(), inertial.pose.quat()));
                Mass { mass: inertial.mass, com: inertial.pose.pos(), inertia, quat }
            }
            None if compiler.inertiafromgeom() == Auto::No => NOTHING,
            None => self.mass_of_shapes(body, moves),
        };
        mass.mass = mass.mass.max(compiler.boundmass());
        mass.inertia = mass.inertia.map(|moment| moment.max(compiler.boundinertia()));
        let total: f64 = mass.inertia.iter().sum();
        if compiler.balanceinertia() && mass.inertia.iter().any(|&moment| 2.0 * moment > total) {
            mass.inertia = [total / 3.0; 3];
        }
        mass
    }

    /// Whether mass and centre of mass of a body are MuJoCo's: those of one that stands still may be left out.
    pub(super) fn mass_is_known(&self, number: usize) -> bool {
        let (body, compiler) = (&self.mjcf.bodies[number], &self.mjcf.compiler);
        let is_written = body.inertial.is_some() && compiler.inertiafromgeom() != Auto::Yes;
        let mut unknown = self.weighed(body).filter(|geom| part(geom).is_none() && !is_massless(geom));
        number == 0 || is_written || compiler.inertiafromgeom() == Auto::No || unknown.next().is_none()
    }

    /// Whether its principal axes are MuJoCo's, too, which sorts those that it computes.
    pub(super) fn axes_are_known(&self, number: usize) -> bool {
        let (body, compiler) = (&self.mjcf.bodies[number], &self.mjcf.compiler);
        match &body.inertial {
            Some(inertial) => inertial.fullinertia.is_none() && compiler.inertiafromgeom() != Auto::Yes,
            None => number == 0 || body.geoms.is_empty(),
        }
    }

    /// Geoms that make the mass of a body.
    fn weighed<'b>(&self, body: &'b Body) -> impl Iterator<Item = &'b Geom> + use<'b> {
        let [first, last] = self.mjcf.compiler.inertiagrouprange();
        body.geoms.iter().filter(move |geom| (first..=last).contains(&geom.group()))
    }

    fn mass_of_shapes(&mut self, body: &Body, moves: bool) -> Mass {
        let mut parts = vec![];
        for geom in self.weighed(body) {
            match part(geom) {
                Some(part) => parts.push(part),
                None if moves && !is_massless(geom) => self.refuse(
                    &geom.place,
                    ("geom", geom.name.as_ref()),
                    "mass of meshes and of shells is not computed; give the body an `inertial`, or load the model in MuJoCo with `<compiler saveinertial=\"true\"/>` and save it with `mj_saveLastXML`",
                ),
                None => {}
            }
        }
        together(&parts)
    }
}

/// Mass, centre of mass (m) and inertia about it (kg m^2) in the axes of the body.
type Part = (f64, Vector3<f64>, Matrix3<f64>);

/// Whether a geom that is no solid weighs nothing.
fn is_massless(geom: &Geom) -> bool {
    let has_none = geom.mass == Some(0.0) || geom.mass.is_none() && geom.density() == 0.0;
    has_none || matches!(geom.kind(), Shape::Plane | Shape::HeightField)
}

/// Of a geom; none of one without volume, or whose volume is not known here.
fn part(geom: &Geom) -> Option<Part> {
    if geom.shellinertia() || geom.mesh.is_some() {
        return None;
    }
    let (volume, moments) = solid(geom.kind(), geom.size())?;
    let mass = geom.mass.unwrap_or(geom.density() * volume);
    let [w, x, y, z] = geom.pose.quat();
    let axes = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).to_rotation_matrix().into_inner();
    let inertia = axes * Matrix3::from_diagonal(&(mass * Vector3::from(moments))) * axes.transpose();
    Some((mass, geom.pose.pos().into(), inertia))
}

/// Volume (m^3), and moments about the axes of a homogeneous solid of one kg (m^2).
fn solid(shape: Shape, [a, b, c]: [f64; 3]) -> Option<(f64, [f64; 3])> {
    let about = |share: f64, [x, y, z]: [f64; 3]| [share * (y + z), share * (x + z), share * (x + y)];
    Some(match shape {
        Shape::Sphere => (4.0 / 3.0 * PI * a.powi(3), [0.4 * a * a; 3]),
        Shape::Ellipsoid => (4.0 / 3.0 * PI * a * b * c, about(0.2, [a * a, b * b, c * c])),
        Shape::Box => (8.0 * a * b * c, about(1.0 / 3.0, [a * a, b * b, c * c])),
        Shape::Cylinder => {
            let across = (3.0 * a * a + 4.0 * b * b) / 12.0;
            (2.0 * PI * a * a * b, [across, across, 0.5 * a * a])
        }
        Shape::Capsule => {
            // A cylinder of this height between the halves of a ball.
            let height = 2.0 * b;
            let (tube, ball) = (PI * a * a * height, 4.0 / 3.0 * PI * a.powi(3));
            let share = ball / (tube + ball);
            let across = (1.0 - share) * (3.0 * a * a + height * height) / 12.0
                + share * (0.4 * a * a + height * (3.0 * a + 2.0 * height) / 8.0);
            (tube + ball, [across, across, (1.0 - share) * 0.5 * a * a + share * 0.4 * a * a])
        }
        Shape::Plane | Shape::HeightField | Shape::Mesh | Shape::Sdf => return None,
    })
}

/// Parts as one body.
fn together(parts: &[Part]) -> Mass {
    let mass: f64 = parts.iter().map(|(mass, ..)| mass).sum();
    if mass <= 0.0 {
        return NOTHING;
    }
    let com = parts.iter().map(|(mass, at, _)| *mass * at).sum::<Vector3<f64>>() / mass;
    let about = |(mass, at, inertia): &Part| {
        let off = at - com;
        inertia + *mass * (off.norm_squared() * Matrix3::identity() - off * off.transpose())
    };
    let (inertia, quat) = axes(parts.iter().map(about).sum());
    Mass { mass, com: com.into(), inertia, quat }
}

/// Principal moments and axes of xx, yy, zz, xy, xz, yz.
fn principal([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> ([f64; 3], [f64; 4]) {
    axes(Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz))
}

fn axes(inertia: Matrix3<f64>) -> ([f64; 3], [f64; 4]) {
    let is_diagonal = inertia.m12 == 0.0 && inertia.m13 == 0.0 && inertia.m23 == 0.0;
    if is_diagonal {
        return ([inertia.m11, inertia.m22, inertia.m33], NOTHING.quat);
    }
    let SymmetricEigen { eigenvalues, mut eigenvectors } = inertia.symmetric_eigen();
    if eigenvectors.determinant() < 0.0 {
        eigenvectors.column_mut(2).neg_mut();
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(eigenvectors));
    (eigenvalues.into(), written(&turn))
}
