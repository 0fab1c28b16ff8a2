//! The same plan in another precision.

use super::{
    Body, ContactSphere, CurvedJoint, Dof, DoubleHingeSegment, Drive, Elements, EnergyProfile, Equality, HingeSegment,
    Limit, Link, LinkMotion, Placement, Plan, Point, PoseProfile, ProfileSegment, ProfiledCoordinate, Tendons,
};
use crate::polynomial::Polynomial;
use myo_scalar::Real;

fn c<D: Real>(x: f64) -> D {
    D::from_f64(x)
}
fn vector<D: Real, const N: usize>(x: [f64; N]) -> [D; N] {
    x.map(c)
}
fn columns<D: Real>(x: [[f64; 3]; 3]) -> [[D; 3]; 3] {
    x.map(vector)
}
fn polynomials<D: Real>(p: &[Polynomial<f64>; 3]) -> [Polynomial<D>; 3] {
    p.each_ref().map(Polynomial::cast)
}

impl Plan<f64> {
    /// Rounds every constant.
    pub fn cast<D: Real>(&self) -> Plan<D> {
        Plan {
            timestep: c(self.timestep),
            implicit_damping: self.implicit_damping,
            gravity: vector(self.gravity),
            origin: vector(self.origin),
            dofs: self.dofs.iter().map(Dof::cast).collect(),
            links: self.links.iter().map(Link::cast).collect(),
            screws: self.screws.clone(),
            bodies: self.bodies.iter().map(Body::cast).collect(),
            sets: self.sets.clone(),
            mass_terms: self.mass_terms.clone(),
            projections: self.projections.clone(),
            curved_joints: self.curved_joints.iter().map(CurvedJoint::cast).collect(),
            profiled: self.profiled.iter().map(ProfiledCoordinate::cast).collect(),
            energy_profiles: self.energy_profiles.iter().map(EnergyProfile::cast).collect(),
            tendons: self.tendons.cast(),
            muscles: self.muscles.iter().map(myo_muscle::Muscle::cast).collect(),
            smooth_activation: self.smooth_activation,
            limits: self.limits.iter().map(Limit::cast).collect(),
            equalities: self.equalities.iter().map(Equality::cast).collect(),
            fingertip: self.fingertip.cast(),
            contact_sphere: self.contact_sphere.as_ref().map(ContactSphere::cast),
            joints: self.joints.iter().map(Drive::cast).collect(),
            elements: self.elements.cast(),
        }
    }
}

impl Elements<f64> {
    fn cast<D: Real>(&self) -> Elements<D> {
        Elements {
            bodies: self.bodies.iter().map(Point::cast).collect(),
            sites: self.sites.iter().map(Point::cast).collect(),
        }
    }
}

impl Dof<f64> {
    fn cast<D: Real>(&self) -> Dof<D> {
        Dof {
            name: self.name.clone(),
            range: self.range.map(vector),
            stiffness: c(self.stiffness),
            spring_torque: c(self.spring_torque),
            damping: c(self.damping),
            armature: c(self.armature),
        }
    }
}

impl Drive<f64> {
    fn cast<D: Real>(&self) -> Drive<D> {
        Drive { dof: self.dof, poly: vector(self.poly), form: self.form }
    }
}

impl Link<f64> {
    fn cast<D: Real>(&self) -> Link<D> {
        let motion = match &self.motion {
            LinkMotion::Fixed => LinkMotion::Fixed,
            LinkMotion::Hinge(p) => LinkMotion::Hinge(p.cast()),
            LinkMotion::Slide(p) => LinkMotion::Slide(p.cast()),
            LinkMotion::Profile(p) => LinkMotion::Profile(Box::new(p.cast())),
        };
        Link { parent: self.parent, motion, drive: self.drive.cast(), screw_of_dof: self.screw_of_dof.clone() }
    }
}

impl Placement<f64> {
    fn cast<D: Real>(&self) -> Placement<D> {
        Placement { offset: vector(self.offset), axes: self.axes.map(columns) }
    }
}

impl ProfiledCoordinate<f64> {
    fn cast<D: Real>(&self) -> ProfiledCoordinate<D> {
        ProfiledCoordinate { dof: self.dof, domain: self.domain.cast() }
    }
}

impl PoseProfile<f64> {
    fn cast<D: Real>(&self) -> PoseProfile<D> {
        PoseProfile {
            coordinate: self.coordinate,
            axes: self.axes.as_ref().map(|axes| axes.each_ref().map(polynomials)),
            position: polynomials(&self.position),
            screw: self.screw.each_ref().map(polynomials),
            screw_rate: self.screw_rate.each_ref().map(polynomials),
        }
    }
}

impl Body<f64> {
    fn cast<D: Real>(&self) -> Body<D> {
        Body {
            link: self.link,
            mass: c(self.mass),
            com: vector(self.com),
            isotropic: c(self.isotropic),
            arms: self.arms.map(vector),
        }
    }
}

impl CurvedJoint<f64> {
    fn cast<D: Real>(&self) -> CurvedJoint<D> {
        CurvedJoint {
            drive: self.drive.cast(),
            stiffness: c(self.stiffness),
            spring_ref: c(self.spring_ref),
            damping: c(self.damping),
            armature: c(self.armature),
        }
    }
}

impl EnergyProfile<f64> {
    fn cast<D: Real>(&self) -> EnergyProfile<D> {
        EnergyProfile {
            coordinate: self.coordinate,
            inertia: self.inertia.cast(),
            centrifugal: self.centrifugal.cast(),
            weight: self.weight.cast(),
        }
    }
}

impl Point<f64> {
    fn cast<D: Real>(&self) -> Point<D> {
        Point { link: self.link, position: vector(self.position) }
    }
}

impl Tendons<f64> {
    fn cast<D: Real>(&self) -> Tendons<D> {
        Tendons {
            constant: self.constant.iter().map(|&x| c(x)).collect(),
            points: self.points.iter().map(Point::cast).collect(),
            pairs: self.pairs.clone(),
            hinge: self.hinge.iter().map(HingeSegment::cast).collect(),
            double_hinge: self.double_hinge.iter().map(DoubleHingeSegment::cast).collect(),
            profiles: self.profiles.iter().map(ProfileSegment::cast).collect(),
        }
    }
}

impl HingeSegment<f64> {
    fn cast<D: Real>(&self) -> HingeSegment<D> {
        HingeSegment { muscle: self.muscle, link: self.link, square: vector(self.square), half: self.half.map(c) }
    }
}

impl DoubleHingeSegment<f64> {
    fn cast<D: Real>(&self) -> DoubleHingeSegment<D> {
        DoubleHingeSegment { muscle: self.muscle, links: self.links, square: columns(self.square) }
    }
}

impl ProfileSegment<f64> {
    fn cast<D: Real>(&self) -> ProfileSegment<D> {
        ProfileSegment {
            muscle: self.muscle,
            coordinate: self.coordinate,
            square: self.square.cast(),
            half_slope: self.half_slope.cast(),
        }
    }
}

impl Limit<f64> {
    fn cast<D: Real>(&self) -> Limit<D> {
        Limit {
            drive: self.drive.cast(),
            range: vector(self.range),
            impedance: self.impedance.cast(),
            diagonal: c(self.diagonal),
        }
    }
}

impl Equality<f64> {
    fn cast<D: Real>(&self) -> Equality<D> {
        Equality {
            dependent: self.dependent,
            drive: self.drive.cast(),
            impedance: self.impedance.cast(),
            diagonal: c(self.diagonal),
        }
    }
}

impl ContactSphere<f64> {
    fn cast<D: Real>(&self) -> ContactSphere<D> {
        ContactSphere {
            centre: self.centre.cast(),
            body_com: self.body_com.cast(),
            radius: c(self.radius),
            margin: self.margin,
            friction: self.friction,
            softness: self.softness,
            diagonal: self.diagonal,
        }
    }
}
