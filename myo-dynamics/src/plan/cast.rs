//! The same plan in another precision.

use super::{
    BallAxis, Body, Branch, Bundle, Connection, ContactPair, ContactSphere, CurvedJoint, Dof, DoubleHingeSegment,
    Drive, Elements, EnergyProfile, Equality, FixedFrame, HingeSegment, JointCoordinates, Limit, Link, LinkMotion,
    Part, PartForm, Placement, Plan, Point, PoseProfile, ProfileSegment, ProfiledCoordinate, RoundThing, Side, Stretch,
    TendonLimit, Tendons,
};
use crate::cast::{Cast, cast};
use myo_scalar::Real;

impl Plan<f64> {
    /// Rounds every constant.
    pub fn cast<D: Real>(&self) -> Plan<D> {
        Cast::cast(self)
    }
}

cast! {
    Plan {
        timestep, impratio, gravity, origin, dofs, qpos0, links, bodies, curved_joints, profiled, energy_profiles, tendons, muscles, limits, tendon_limits,
        equalities, connections, fingertip, arm, fingers, contact_spheres, pairs, joints, elements;
        implicit_damping, carried, balls, screws, sets, mass_terms, elimination, unsymmetric, projections, implicit_muscles, apart, smooth_activation, hulls
    }
    Elements { bodies, sites, wraps }
    Dof { range, stiffness, spring_torque, damping, armature; name, kind, at }
    Drive { poly; dof, at, form }
    Link { motion, drive; parent, screw_of_dof }
    Placement { offset, axes }
    ProfiledCoordinate { domain; dof, at }
    PoseProfile { axes, position, screw, screw_rate; coordinate }
    Body { mass, com, isotropic, arms; link }
    CurvedJoint { drive, stiffness, spring_ref, damping, armature }
    EnergyProfile { inertia, centrifugal, weight; coordinate }
    Point { position; link }
    FixedFrame { origin, axes }
    Tendons { constant, branches, points, hinge, double_hinge, profiles, wraps; pairs }
    Branch { share; muscle }
    HingeSegment { square, half; muscle, link }
    DoubleHingeSegment { square; muscle, links }
    ProfileSegment { square, half_slope; muscle, coordinate }
    RoundThing { frame, radius; shape, rule }
    Bundle { stretches; shape, rule, way, is_moored }
    Stretch { round, ends, local, side; muscle }
    Limit { drive, range, impedance, diagonal }
    TendonLimit { range, margin, impedance, diagonal; muscle, dofs }
    Equality { drive, impedance, diagonal; dependent, at }
    Connection { frames, coms, torque_scale, impedance, diagonals }
    BallAxis { placement; at, axis }
    ContactSphere { centre, body_com, radius; finger, margin, friction, softness, diagonal, movers }
    ContactPair { parts, far, margin, friction, opening, impedance, diagonal, least; slot, points, condim, is_cone, is_along_axis, movers }
    Part { frame, form, body_com }
}

impl<C: Real + Cast<D, Output = D>, D: Real> Cast<D> for LinkMotion<C> {
    type Output = LinkMotion<D>;
    fn cast(&self) -> LinkMotion<D> {
        match self {
            Self::Fixed => LinkMotion::Fixed,
            Self::Hinge(placement) => LinkMotion::Hinge(placement.cast()),
            Self::Slide(placement) => LinkMotion::Slide(placement.cast()),
            Self::Ball(ball) => LinkMotion::Ball(ball.cast()),
            Self::Profile(profile) => LinkMotion::Profile(profile.cast()),
        }
    }
}

impl<C: Real + Cast<D, Output = D>, D: Real> Cast<D> for JointCoordinates<C> {
    type Output = JointCoordinates<D>;
    fn cast(&self) -> JointCoordinates<D> {
        match self {
            Self::One(drive) => JointCoordinates::One(drive.cast()),
            Self::Many { qpos, qvel } => JointCoordinates::Many { qpos: qpos.clone(), qvel: qvel.clone() },
        }
    }
}

impl<C: Real + Cast<D, Output = D>, D: Real> Cast<D> for PartForm<C> {
    type Output = PartForm<D>;
    fn cast(&self) -> PartForm<D> {
        match self {
            Self::Plane => PartForm::Plane,
            Self::Cylinder { radius, half_length } => {
                PartForm::Cylinder { radius: radius.cast(), half_length: half_length.cast() }
            }
            Self::Capsule { radius, half_length } => {
                PartForm::Capsule { radius: radius.cast(), half_length: half_length.cast() }
            }
            Self::Ellipsoid { radii } => PartForm::Ellipsoid { radii: radii.cast() },
            Self::Box { half_size } => PartForm::Box { half_size: half_size.cast() },
            Self::Mesh(number) => PartForm::Mesh(*number),
        }
    }
}

impl<C: Real + Cast<D, Output = D>, D: Real> Cast<D> for Side<C> {
    type Output = Side<D>;
    fn cast(&self) -> Side<D> {
        match self {
            Self::Any => Side::Any,
            Self::Inside => Side::Inside,
            Self::Fixed(point) => Side::Fixed(point.cast()),
            Self::Moving(point) => Side::Moving(point.cast()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CouplingMode;
    use myo_model::{Model, builtin};

    /// Every plan of the arm, so that every kind of table is filled in one of them.
    fn plans() -> Vec<Plan<f64>> {
        let arm = Model::new(&builtin("mobl-arms").unwrap()).unwrap();
        let [reduced, soft] =
            [CouplingMode::Reduced, CouplingMode::Soft].map(|coupling| Plan::exact(&arm, coupling).unwrap());
        vec![reduced.specialised(), reduced.with_arm(&arm).unwrap(), soft]
    }

    /// All numbers, to the last bit: as many digits as it takes to read the same number back.
    fn text<C: Real>(plan: &Plan<C>) -> String {
        format!("{plan:?}")
    }

    #[test]
    fn a_plan_of_the_same_precision_is_the_same_plan() {
        for plan in plans() {
            assert_eq!(text(&plan.cast::<f64>()), text(&plan));
        }
    }

    #[test]
    fn single_precision_comes_back_from_double_precision() {
        for plan in plans() {
            let single: Plan<f32> = plan.cast();
            let double: Plan<f64> = Cast::cast(&single);
            assert_eq!(text(&double.cast::<f32>()), text(&single));
            assert_ne!(text(&double), text(&plan), "a plan in double precision has more digits");
        }
    }
}
