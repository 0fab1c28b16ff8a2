//! From a model to the exact plan: one link per moving joint, frames turned so that every joint acts along z.

use super::coordinates::Coordinates;
use super::{
    BallAxis, Body, Branch, Connection, ContactPair, ContactSphere, CouplingMode, Drive, Elements, Elimination,
    Equality, FixedFrame, Form, ImplicitMuscle, JointCoordinates, Limit, Link, LinkMotion, Movers, Placement, Plan,
    PlanError, Point, RoundThing, Screw, Segment, SegmentPair, Stretch, TendonLimit, Tendons, Unsymmetric, connections,
    implicit, pairs, reference_pose, sets,
};
use crate::impedance::Impedance;
use myo_model::Model;
use myo_model::description::{Integrator, JointKind, Shape};
use myo_muscle::Muscle;
use myo_nearest::Nearest;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::BTreeSet;

/// A rotation closer to none than this is none: products of unit quaternions leave rounding behind.
const PARALLEL: f64 = 1e-14;

/// Inverse inertia (1/kg) of a limited tendon below which its limit is harder than single precision can bear.
const LEAST_FELT: f64 = 1e-7;

impl Plan<f64> {
    /// The same, and it keeps where elbow and wrist are. To be asked of an exact plan, before it is specialised.
    ///
    /// # Errors
    /// [`PlanError::NoArm`]: the model's landmarks do not tell.
    pub fn with_arm(mut self, model: &Model) -> Result<Self, PlanError> {
        let (Some(elbow), Some(wrist)) = (model.elbow_body, model.wrist_body) else {
            let missing = if model.elbow_body.is_none() { "elbow" } else { "wrist" };
            return Err(PlanError::NoArm { missing });
        };
        self.arm = Some([elbow, wrist].map(|body| self.elements.bodies[body].origin));
        Ok(self)
    }

    /// The same, and it keeps where these of the model's fingers are, in this order, and what they press with; the others press nothing. To be asked of an exact plan, before it is
    /// specialised.
    ///
    /// # Errors
    /// [`PlanError::NoFinger`]: the model has none of a name.
    pub fn with_fingers(mut self, model: &Model, names: &[String]) -> Result<Self, PlanError> {
        let known: Vec<&str> = model.fingers.iter().map(|(name, _)| name.as_str()).collect();
        let number = |name: &String| match known.iter().position(|known| known == name) {
            Some(number) => Ok(number),
            None => Err(PlanError::NoFinger { name: name.clone(), nearest: Nearest::to(name, &known) }),
        };
        let kept = names.iter().map(number).collect::<Result<Vec<usize>, _>>()?;
        self.fingers = kept.iter().map(|&number| self.elements.sites[model.fingers[number].1]).collect();
        self.contact_spheres.retain_mut(|sphere| {
            let now = sphere.finger.checked_sub(1).map(|number| kept.iter().position(|&kept| kept == number));
            sphere.finger = now.flatten().map_or(0, |place| place + 1);
            now.is_none_or(|place| place.is_some())
        });
        self.contact_spheres.sort_by_key(|sphere| sphere.finger);
        // Coordinates feel each other through what is left.
        self.connect();
        Ok(self)
    }

    /// Refuses to press with one of the fingers that it keeps, by its number, if nothing of it does.
    ///
    /// # Errors
    /// [`PlanError::PressesNothing`].
    pub fn check_presses(&self, finger: usize, name: &str) -> Result<(), PlanError> {
        let presses = self.contact_spheres.iter().any(|sphere| sphere.finger == finger + 1);
        if presses { Ok(()) } else { Err(PlanError::PressesNothing { name: name.to_owned() }) }
    }

    /// Compiles a model without any shortcut: the reference that everything else is compared with.
    pub fn exact(model: &Model, coupling: CouplingMode) -> Result<Self, PlanError> {
        if model.muscles.is_empty() {
            return Err(PlanError::NoMuscles);
        }
        let coordinates = Coordinates::of(model, coupling);
        if !coordinates.joints.iter().any(JointCoordinates::moves) {
            return Err(PlanError::NothingMoves);
        }
        let tree = Tree::new(model, &coordinates);
        let tendons = tendons(model, &tree)?;
        let tendon_limits = tendon_limits(model, &tree);
        let bodies = tree.bodies(model);
        let contact_spheres = contact_spheres(model, &tree)?;
        let (pairs, hulls) = pairs::pairs(model, &tree)?;
        let connections = connections::connections(model, &tree);
        let fingertip = tree.site(model, model.fingertip_site);
        let elements = tree.elements(model);
        let is_implicit = model.options.integrator != Integrator::Euler;
        let along = |muscle| ImplicitMuscle { dofs: tree.dofs_along(model, muscle), pairs: vec![] };
        let implicit_muscles = model.muscles.iter().filter(|_| is_implicit).map(along).collect();
        let unsymmetric = Unsymmetric::asked(model, &coordinates);
        let apart = implicit::apart(model, &coordinates);
        let h = model.options.timestep;
        let mut plan = Plan {
            timestep: h,
            impratio: model.options.impratio,
            implicit_damping: model.options.implicit_joint_damping || is_implicit,
            gravity: model.options.gravity,
            origin: model.shoulder_in_zero_pose().into(),
            curved_joints: coordinates.curved_joints(model),
            limits: limits(model, &coordinates),
            equalities: if coupling == CouplingMode::Soft { equalities(model, &coordinates) } else { vec![] },
            connections,
            dofs: coordinates.dofs,
            carried: None,
            balls: coordinates.balls,
            qpos0: coordinates.qpos0,
            screws: tree.screws,
            links: tree.links,
            bodies,
            sets: vec![],
            mass_terms: vec![],
            elimination: Elimination::default(),
            unsymmetric,
            projections: vec![],
            profiled: vec![],
            energy_profiles: vec![],
            tendons,
            muscles: vec![],
            implicit_muscles,
            apart,
            hulls,
            smooth_activation: model.muscles.iter().any(|muscle| muscle.parameters.tau_smooth > 0.0),
            tendon_limits,
            fingertip,
            arm: None,
            fingers: vec![],
            contact_spheres,
            pairs,
            joints: coordinates.joints,
            elements,
        };
        plan.connect();
        plan.muscles = model.muscles.iter().map(|m| Muscle::new(&m.parameters, 1.0)).collect();
        let reference = match coupling {
            CouplingMode::Soft => reference_pose::measure(&plan)?,
            CouplingMode::Reduced => reference_pose::measure(&Plan::exact(model, CouplingMode::Soft)?)?,
        };
        plan.muscles =
            model.muscles.iter().zip(&reference.acc0).map(|(m, &acc0)| Muscle::new(&m.parameters, acc0)).collect();
        plan.weigh_constraints(model, &reference)?;
        if coupling == CouplingMode::Reduced {
            plan.check_stability()?;
        }
        Ok(plan)
    }

    /// Recomputes which links move together, and which coordinates feel each other.
    pub(super) fn connect(&mut self) {
        let mut used: BTreeSet<usize> = self.bodies.iter().map(|b| b.link).collect();
        used.extend(self.tendons.pairs.iter().flat_map(|pair| [pair.a, pair.b]));
        used.extend(self.contact_spheres.iter().map(|sphere| sphere.centre.link));
        used.extend(self.pairs.iter().flat_map(ContactPair::links));
        used.extend(self.connections.iter().flat_map(Connection::all_links));
        used.extend(self.tendons.stretches().flat_map(Stretch::pulled_links));
        used.remove(&0);
        sets::connect(self, &used);
        self.elimination = Elimination::of(self);
        self.unsymmetric = self.unsymmetric.take().map(|unsymmetric| unsymmetric.of(self));
        let along = self.implicit_muscles.iter().map(|muscle| ImplicitMuscle::of(muscle.dofs.clone(), self));
        self.implicit_muscles = along.collect();
        for sphere in &mut self.contact_spheres {
            sphere.movers = Movers::of([0, sphere.centre.link], &self.links, &self.elimination);
        }
        for pair in &mut self.pairs {
            pair.movers = Movers::of(pair.links(), &self.links, &self.elimination);
        }
    }

    /// Springs and dampers must be slower than time steps. Both bounds are those of a single joint in the reference pose:
    /// `h d / I < 2` for a damper taken explicitly, `h^2 k / I < 4` for a spring with semi-implicit Euler steps; half of
    /// each leaves room for other poses.
    fn check_stability(&self) -> Result<(), PlanError> {
        let (h, inertias) = (self.timestep, reference_pose::inertias(self)?);
        for (k, dof) in self.dofs.iter().enumerate() {
            let (joint, inertia, timestep_s) = (dof.name.clone(), inertias[k], h);
            let (most, damping) = (inertia / h, dof.damping);
            if !self.implicit_damping && damping > most {
                return Err(PlanError::Overdamped { joint, damping, inertia, timestep_s, most });
            }
            let (most, stiffness) = (2.0 * inertia / (h * h), dof.stiffness);
            if stiffness > most {
                return Err(PlanError::TooStiff { joint, stiffness, inertia, timestep_s, most });
            }
        }
        Ok(())
    }

    fn weigh_constraints(&mut self, model: &Model, reference: &reference_pose::ReferencePose) -> Result<(), PlanError> {
        // It was measured with every joint a coordinate.
        let rates =
            |joints: &[myo_model::model::Joint]| joints.iter().map(|joint| joint.kind.sizes()[1]).sum::<usize>();
        let of = |joint: usize| reference.inverse_inertia[rates(&model.joints[..joint])];
        let is_limited = |&joint: &usize| limited(&model.joints[joint], &self.joints[joint]).is_some();
        let joints = (0..model.joints.len()).filter(is_limited);
        for (limit, joint) in self.limits.iter_mut().zip(joints) {
            limit.diagonal = of(joint);
        }
        for (equality, coupling) in self.equalities.iter_mut().zip(&model.couplings) {
            equality.diagonal = of(coupling.dependent) + coupling.independent.map_or(0.0, of);
        }
        for (sphere, &mass) in self.contact_spheres.iter_mut().zip(&reference.sphere_inverse_masses) {
            sphere.diagonal = mass;
        }
        for (limit, &mass) in self.tendon_limits.iter_mut().zip(&reference.tendon_inverse_masses) {
            if !limit.dofs.is_empty() && mass < LEAST_FELT {
                return Err(PlanError::StuckTendon { muscle: model.muscles[limit.muscle].name.clone() });
            }
            limit.diagonal = mass;
        }
        for (pair, &masses) in self.pairs.iter_mut().zip(&reference.pair_inverse_masses) {
            pair.weigh(masses, model.options.impratio);
        }
        for (connection, &inverses) in self.connections.iter_mut().zip(&reference.connection_inverses) {
            connection.weigh(inverses);
        }
        Ok(())
    }
}

/// How a joint moves that can come to a limit: one that is held at a position cannot.
pub(super) fn limited<'a>(
    joint: &myo_model::model::Joint,
    place: &'a JointCoordinates<f64>,
) -> Option<(&'a Drive<f64>, [f64; 2])> {
    Some((place.drive().filter(|drive| drive.dof.is_some())?, joint.range?))
}

fn limits(model: &Model, coordinates: &Coordinates) -> Vec<Limit<f64>> {
    let row = |(joint, place): (&myo_model::model::Joint, &JointCoordinates<f64>)| {
        let (&drive, range) = limited(joint, place)?;
        let impedance = Impedance::new(&joint.softness, model.options.timestep);
        Some(Limit { drive, range, impedance, diagonal: 0.0 })
    };
    model.joints.iter().zip(&coordinates.joints).filter_map(row).collect()
}

fn tendon_limits(model: &Model, tree: &Tree) -> Vec<TendonLimit<f64>> {
    let row = |(muscle, m): (usize, &myo_model::model::Muscle)| {
        let limit = m.limit?;
        Some(TendonLimit {
            muscle,
            dofs: tree.dofs_along(model, m),
            range: limit.range,
            margin: limit.margin,
            impedance: Impedance::new(&limit.softness, model.options.timestep),
            diagonal: 0.0,
        })
    };
    model.muscles.iter().enumerate().filter_map(row).collect()
}

fn equalities(model: &Model, coordinates: &Coordinates) -> Vec<Equality<f64>> {
    let place = |joint: usize| coordinates.joints[joint].drive().and_then(Drive::place);
    let row = |c: &myo_model::model::Coupling| {
        let (dependent, at) = place(c.dependent)?;
        Some(Equality {
            dependent,
            at,
            drive: Drive::of(c.independent.and_then(place), c.polycoef),
            impedance: Impedance::new(&c.softness, model.options.timestep),
            diagonal: 0.0,
        })
    };
    model.couplings.iter().filter_map(row).collect()
}

/// Links, and where every body of the model sits on them at joint position zero.
pub(super) struct Tree {
    links: Vec<Link<f64>>,
    screws: Vec<Screw>,
    placement: Vec<(usize, Isometry3<f64>)>,
}

impl Tree {
    fn new(model: &Model, coordinates: &Coordinates) -> Self {
        let world = Link {
            parent: 0,
            motion: LinkMotion::Fixed,
            drive: Drive::of(None, [0.0; 5]),
            screw_of_dof: vec![None; coordinates.dofs.len()],
        };
        // Everything is measured from the shoulder centre.
        let origin =
            Isometry3::from_parts(Translation3::from(-model.shoulder_in_zero_pose()), UnitQuaternion::identity());
        let mut tree = Self { links: vec![world], screws: vec![], placement: vec![(0, origin)] };
        for (index, body) in model.bodies.iter().enumerate().skip(1) {
            let (mut link, parent) = tree.placement[body.parent];
            let mut place = parent * Isometry3::from_parts(Translation3::from(body.pos), body.quat);
            for (joint, own) in model.joints.iter().zip(&coordinates.joints).filter(|(joint, _)| joint.body == index) {
                match own {
                    JointCoordinates::One(drive) if drive.dof.is_some() => {
                        let motion = if joint.kind == JointKind::Hinge { LinkMotion::Hinge } else { LinkMotion::Slide };
                        (link, place) = tree.add_link((joint.pos, joint.axis), motion, *drive, (link, place));
                    }
                    JointCoordinates::One(drive) => place *= locked(joint, drive.poly[0]),
                    JointCoordinates::Many { qpos, qvel } => {
                        let mut start = (qpos.start, qvel.start);
                        if joint.kind == JointKind::Free {
                            (link, place) = tree.add_place(origin, start);
                            start = (start.0 + 3, start.1 + 3);
                        }
                        (link, place) = tree.add_ball(joint.pos, start, (link, place));
                    }
                }
            }
            tree.placement.push((link, place));
        }
        tree.screws = assign_screws(&mut tree.links);
        tree
    }

    /// Appends the link behind a hinge or slide, whose anchor and axis are given in the frame of its body; returns it with the body's
    /// place on it.
    fn add_link(
        &mut self,
        (anchor, axis): (Vector3<f64>, Vector3<f64>),
        motion: impl Fn(Placement<f64>) -> LinkMotion<f64>,
        drive: Drive<f64>,
        (parent, place): (usize, Isometry3<f64>),
    ) -> (usize, Isometry3<f64>) {
        let anchor = place * nalgebra::Point3::from(anchor);
        let axes = frame_along(place.rotation * axis);
        let motion = motion(Placement::new(anchor.coords, axes));
        self.links.push(Link { parent, motion, drive, screw_of_dof: vec![] });
        let turn = axes.map_or_else(UnitQuaternion::identity, |r| {
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(r))
        });
        let frame = Isometry3::from_parts(Translation3::from(anchor.coords), turn);
        (self.links.len() - 1, frame.inverse() * place)
    }

    /// Appends the links that carry a free body along the axes of the world, whose origin is given; its place is not turned yet.
    fn add_place(&mut self, origin: Isometry3<f64>, (at, dof): (usize, usize)) -> (usize, Isometry3<f64>) {
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        axes.into_iter().enumerate().fold((0, origin), |reached, (k, axis)| {
            let drive = Drive::of(Some((dof + k, at + k)), [0.0, 1.0, 0.0, 0.0, 0.0]);
            self.add_link((Vector3::zeros(), axis), LinkMotion::Slide, drive, reached)
        })
    }

    /// Appends the three links of a ball joint; returns the last with the body's place on it.
    fn add_ball(
        &mut self,
        anchor: Vector3<f64>,
        (at, dof): (usize, usize),
        (parent, place): (usize, Isometry3<f64>),
    ) -> (usize, Isometry3<f64>) {
        let turned = place.rotation.to_rotation_matrix().into_inner();
        let is_parallel = (turned - Matrix3::identity()).amax() <= PARALLEL;
        let offset = place * nalgebra::Point3::from(anchor);
        let placement = Placement::new(offset.coords, (!is_parallel).then_some(turned));
        for axis in 0..3 {
            self.links.push(Link {
                parent: if axis == 0 { parent } else { self.links.len() - 1 },
                motion: LinkMotion::Ball(BallAxis { placement: placement.clone(), at, axis }),
                drive: Drive::of(Some((dof + axis, at)), [0.0, 1.0, 0.0, 0.0, 0.0]),
                screw_of_dof: vec![],
            });
        }
        (self.links.len() - 1, Isometry3::translation(-anchor.x, -anchor.y, -anchor.z))
    }

    pub(super) fn point(&self, body: usize, position: Vector3<f64>) -> Point<f64> {
        let (link, place) = self.placement[body];
        Point { link, position: (place * nalgebra::Point3::from(position)).coords.into() }
    }

    fn frame(&self, body: usize) -> FixedFrame<f64> {
        let turn = self.placement[body].1.rotation.to_rotation_matrix();
        FixedFrame { origin: self.point(body, Vector3::zeros()), axes: turn.into_inner().into() }
    }

    fn elements(&self, model: &Model) -> Elements<f64> {
        Elements {
            bodies: (0..model.bodies.len()).map(|body| self.frame(body)).collect(),
            sites: (0..model.sites.len()).map(|site| self.site(model, site)).collect(),
            wraps: model.wraps.iter().map(|wrap| self.wrap(wrap)).collect(),
        }
    }

    fn wrap(&self, wrap: &myo_model::model::Wrap) -> FixedFrame<f64> {
        self.placed(wrap.body, wrap.pos, wrap.quat)
    }

    /// A frame at a place of a body.
    pub(super) fn placed(&self, body: usize, pos: Vector3<f64>, quat: UnitQuaternion<f64>) -> FixedFrame<f64> {
        let turn = (self.placement[body].1.rotation * quat).to_rotation_matrix();
        FixedFrame { origin: self.point(body, pos), axes: turn.into_inner().into() }
    }

    /// Coordinates that move anything on the path of a muscle.
    fn dofs_along(&self, model: &Model, muscle: &myo_model::model::Muscle) -> Vec<usize> {
        let sites = muscle.path.iter().map(|&site| model.sites[site].body);
        let bodies = sites.chain(muscle.over.iter().map(|over| model.wraps[over.wrap].body));
        let links: BTreeSet<usize> = bodies.map(|body| self.placement[body].0).collect();
        let ndof = self.links[0].screw_of_dof.len();
        (0..ndof).filter(|&dof| links.iter().any(|&link| self.links[link].screw_of_dof[dof].is_some())).collect()
    }

    fn site(&self, model: &Model, site: usize) -> Point<f64> {
        self.point(model.sites[site].body, model.sites[site].pos)
    }

    /// Merges the bodies on each link into one.
    fn bodies(&self, model: &Model) -> Vec<Body<f64>> {
        (1..self.links.len()).filter_map(|link| self.merged_body(model, link)).collect()
    }

    fn merged_body(&self, model: &Model, link: usize) -> Option<Body<f64>> {
        let members = || model.bodies.iter().zip(&self.placement).filter(|(_, (on, _))| *on == link);
        let centre = |body: &myo_model::model::Body, place: &Isometry3<f64>| place * nalgebra::Point3::from(body.com);
        let mass: f64 = members().map(|(body, _)| body.mass).sum();
        let moment: Vector3<f64> = members().map(|(body, (_, place))| centre(body, place).coords * body.mass).sum();
        let com = if mass > 0.0 { moment / mass } else { Vector3::zeros() };
        let inertia: Matrix3<f64> = members()
            .map(|(body, (_, place))| {
                let r = place.rotation.to_rotation_matrix();
                let d = centre(body, place).coords - com;
                r * body.inertia * r.inverse()
                    + (Matrix3::identity() * d.norm_squared() - d * d.transpose()) * body.mass
            })
            .sum();
        (mass > 0.0 || inertia.norm() > 0.0).then(|| Body::new(link, mass, com, inertia))
    }
}

impl Placement<f64> {
    fn new(offset: Vector3<f64>, axes: Option<Matrix3<f64>>) -> Self {
        let column = |r: &Matrix3<f64>, k: usize| r.column(k).into_owned().into();
        Self { offset: offset.into(), axes: axes.map(|r| [column(&r, 0), column(&r, 1), column(&r, 2)]) }
    }
}

/// Gives every link its screw for every coordinate that moves it; returns the screws beyond one per link.
pub(super) fn assign_screws(links: &mut [Link<f64>]) -> Vec<Screw> {
    let mut further = vec![];
    for index in 1..links.len() {
        let Link { parent, drive, .. } = links[index];
        let mut screws = links[parent].screw_of_dof.clone();
        let dof = drive.dof.expect("links exist only for joints with a coordinate");
        screws[dof] = Some(match screws[dof] {
            None if drive.form == Form::Identity => index,
            parent => {
                further.push(Screw { parent, link: index });
                links.len() + further.len() - 1
            }
        });
        links[index].screw_of_dof = screws;
    }
    further
}

/// Body motion of a joint held at a constant position.
fn locked(joint: &myo_model::model::Joint, position: f64) -> Isometry3<f64> {
    match joint.kind {
        JointKind::Slide => {
            Isometry3::from_parts(Translation3::from(joint.axis * position), UnitQuaternion::identity())
        }
        JointKind::Ball | JointKind::Free => unreachable!("only hinges and slides follow others"),
        JointKind::Hinge => {
            let turn = UnitQuaternion::from_axis_angle(&Unit::new_normalize(joint.axis), position);
            Isometry3::from_parts(Translation3::from(joint.pos - turn * joint.pos), turn)
        }
    }
}

/// Axes (columns) with z along `axis`, turned as little as possible; none if already there.
fn frame_along(axis: Vector3<f64>) -> Option<Matrix3<f64>> {
    let turn = Rotation3::rotation_between(&Vector3::z(), &axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    ((turn.matrix() - Matrix3::identity()).amax() > PARALLEL).then(|| *turn.matrix())
}

/// The spheres that press: that of the fingertip, then those of the model's fingers, in their order, as far as they have one.
fn contact_spheres(model: &Model, tree: &Tree) -> Result<Vec<ContactSphere<f64>>, PlanError> {
    let mut spheres: Vec<ContactSphere<f64>> = vec![];
    for geom in model.pressing_geoms() {
        let Shape::Sphere { radius } = geom.shape else {
            return Err(PlanError::NotASphere { name: geom.name.clone() });
        };
        // Of fingers on one body it is that of the nearest; what presses may be anywhere, as long as there is nothing else.
        let sites = [model.fingertip_site].into_iter().chain(model.fingers.iter().map(|&(_, site)| site));
        let away = |site: usize| (model.sites[site].pos - geom.pos).norm();
        let own = sites.enumerate().filter(|&(_, site)| model.sites[site].body == geom.body);
        let finger = own.min_by(|a, b| away(a.1).total_cmp(&away(b.1))).map_or(0, |(finger, _)| finger);
        if spheres.iter().any(|sphere| sphere.finger == finger) {
            return Err(PlanError::TooManyGeoms { name: geom.name.clone() });
        }
        spheres.push(ContactSphere {
            finger,
            centre: tree.point(geom.body, geom.pos),
            body_com: tree.point(geom.body, model.bodies[geom.body].com),
            radius,
            margin: geom.margin,
            friction: geom.friction[0],
            softness: geom.softness,
            diagonal: 0.0,
            movers: Movers::default(),
        });
    }
    spheres.sort_by_key(|sphere| sphere.finger);
    Ok(spheres)
}

/// All path segments as straight lines between two points; segments within one link are constant.
fn tendons(model: &Model, tree: &Tree) -> Result<Tendons<f64>, PlanError> {
    let mut out = Tendons {
        constant: vec![0.0; model.muscles.len()],
        branches: vec![],
        points: vec![],
        pairs: vec![],
        hinge: vec![],
        double_hinge: vec![],
        profiles: vec![],
        wraps: vec![],
    };
    for (muscle, m) in model.muscles.iter().enumerate() {
        let mut pulleys = vec![];
        for (after, pulley) in m.stretches() {
            let muscle = pulley.map_or(muscle, |pulley| {
                if pulleys.last() != Some(&pulley.before) {
                    pulleys.push(pulley.before);
                    out.branches.push(Branch { muscle, share: pulley.divisor.recip() });
                    out.constant.push(0.0);
                }
                out.constant.len() - 1
            });
            let [a, b] = [after, after + 1].map(|element| tree.site(model, m.path[element]));
            if let Some(over) = m.over.iter().find(|over| over.after == after) {
                let (wrap, side) = (&model.wraps[over.wrap], over.side.map(|site| tree.site(model, site)));
                out.add_stretch(muscle, [a, b], RoundThing::new(wrap, model.options.side_rule, tree.wrap(wrap)), side);
            } else if a.link == b.link {
                out.constant[muscle] += (Vector3::from(b.position) - Vector3::from(a.position)).norm();
            } else {
                out.add_segment(muscle, a, b);
            }
        }
    }
    Ok(out)
}

impl Tendons<f64> {
    /// Adds a straight segment; its points are shared with neighbours.
    pub(super) fn add_segment(&mut self, muscle: usize, a: Point<f64>, b: Point<f64>) {
        let (a, b) = if a.link <= b.link { (a, b) } else { (b, a) };
        let segment = Segment { muscle, a: self.point(a), b: self.point(b) };
        match self.pairs.iter_mut().find(|pair| (pair.a, pair.b) == (a.link, b.link)) {
            Some(pair) => pair.segments.push(segment),
            None => self.pairs.push(SegmentPair { a: a.link, b: b.link, segments: vec![segment] }),
        }
    }

    fn point(&mut self, point: Point<f64>) -> usize {
        self.points.iter().position(|p| *p == point).unwrap_or_else(|| {
            self.points.push(point);
            self.points.len() - 1
        })
    }
}
