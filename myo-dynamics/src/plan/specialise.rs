//! Cheaper tables for the same physics.
//!
//! - The squared length of a segment across one hinge is `A + B cos + C sin`, across two hinges in a row bilinear in
//!   (1, cos, sin) of both: exact.
//! - Links that move with one coordinate through several joints (a shoulder girdle) become polynomials in that coordinate:
//!   their pose where something hangs on it, their energy, and the lengths of segments between them. Fits are refused
//!   unless they are as good as single precision, and followed past the coordinate's limits as [`ProfiledCoordinate`] says.
//! - A free body is the origin of everything ([`Plan::carried`]), so that it may go far.

use super::build::assign_screws;
use super::{
    Connection, DofKind, DoubleHingeSegment, Drive, Elements, EnergyProfile, HingeSegment, Link, LinkMotion, Part,
    Placement, Plan, Point, PoseProfile, ProfileSegment, ProfiledCoordinate, Segment, SegmentPair, Stretch, Tendons,
};
use crate::polynomial::{Domain, NODES, Polynomial, fit, nodes};
use crate::spatial::{Motion, Rotation, Vec3};
use crate::step::{inertia, kinematics};
use crate::workspace::{State, Workspace};
use nalgebra::{Matrix3, Vector3};
use std::collections::{BTreeMap, BTreeSet};

/// Greatest error of a fit, in SI units: a tenth of what single precision resolves at half a metre.
const TOLERANCE: f64 = 3e-9;
/// Segments that can become shorter (m) keep the general form, which guards against division by zero.
const SHORTEST: f64 = 1e-4;
/// How far past its limits a coordinate is fitted (rad): soft limits give way under strong muscles.
const BEYOND_LIMITS: f64 = 0.1;
/// How much farther the fits are followed (rad); the arm comes 0.15 rad past its limits at worst.
const FOLLOWED: f64 = 0.4;

impl Plan<f64> {
    /// A plan that computes the same from cheaper tables.
    #[must_use]
    pub fn specialised(&self) -> Self {
        let mut plan = Self { elements: Elements::default(), ..self.clone() };
        plan.lift_masses();
        for dof in 0..self.ndof() {
            if let Some(profiled) = plan.with_profile(dof) {
                plan = profiled;
            }
        }
        plan.fold_hinge_segments();
        plan.connect();
        plan.carried = plan.free_body();
        plan
    }

    /// Where the place of the only free body begins in `qpos`. None where profiles are, which are places in the world.
    fn free_body(&self) -> Option<usize> {
        let mut places = self.dofs.iter().filter(|dof| dof.kind == DofKind::Place).map(|dof| dof.at);
        let first = places.next().filter(|_| self.profiled.is_empty())?;
        (places.count() == 2).then_some(first)
    }

    /// Replaces the links that move with `dof` alone through several joints; none if there are none or a fit fails.
    fn with_profile(&self, dof: usize) -> Option<Self> {
        let girdle: BTreeSet<usize> = (1..self.links.len()).filter(|&k| self.moves_only_with(k, dof)).collect();
        if girdle.len() < 2 {
            return None;
        }
        let (samples, at) = (Samples::take(self, dof)?, self.dofs[dof].at);
        let fixed_or_girdle = |link: usize| link == 0 || girdle.contains(&link);
        let mut plan = self.clone();
        plan.profiled.push(ProfiledCoordinate { dof, at, domain: samples.domain });
        plan.fold_length_profiles(&samples, fixed_or_girdle)?;
        plan.energy_profiles.push(samples.energy(self, &girdle)?);
        plan.bodies.retain(|body| !girdle.contains(&body.link));
        let needed = plan.links_in_use();
        for &link in girdle.intersection(&needed) {
            plan.links[link].motion = LinkMotion::Profile(Box::new(samples.pose(link)?));
            plan.links[link].parent = 0;
            plan.links[link].drive = Drive::of(Some((dof, at)), [0.0, 1.0, 0.0, 0.0, 0.0]);
        }
        plan.keep_links(|link| !girdle.contains(&link) || needed.contains(&link));
        Some(plan)
    }

    fn moves_only_with(&self, link: usize, dof: usize) -> bool {
        let moving = |(k, screw): (usize, &Option<usize>)| screw.is_some() == (k == dof);
        self.links[link].screw_of_dof.iter().enumerate().all(moving)
    }

    /// Links that children, bodies, path points, the fingertip or the contact sphere refer to.
    fn links_in_use(&self) -> BTreeSet<usize> {
        let mut used = BTreeSet::from([0, self.fingertip.link]);
        used.extend(self.bodies.iter().map(|body| body.link));
        used.extend(self.tendons.points.iter().map(|point| point.link));
        used.extend(self.tendons.stretches().flat_map(Stretch::links));
        used.extend(self.arm.iter().flatten().chain(&self.fingers).map(|point| point.link));
        used.extend(self.contact_spheres.iter().flat_map(|s| [s.centre.link, s.body_com.link]));
        used.extend(self.pairs.iter().flat_map(|pair| &pair.parts).flat_map(Part::links));
        used.extend(self.connections.iter().flat_map(Connection::all_links));
        // Parents of links that cannot themselves be dropped.
        let alone = |k: usize| self.links[k].screw_of_dof.iter().flatten().count() == 1;
        used.extend((1..self.links.len()).filter(|&k| !alone(k)).map(|k| self.links[k].parent));
        used
    }

    /// Drops links and renumbers the rest.
    fn keep_links(&mut self, keep: impl Fn(usize) -> bool) {
        let kept: Vec<usize> = (0..self.links.len()).filter(|&k| k == 0 || keep(k)).collect();
        let new: BTreeMap<usize, usize> = kept.iter().enumerate().map(|(new, &old)| (old, new)).collect();
        self.links = kept.iter().map(|&k| self.links[k].clone()).collect();
        for link in &mut self.links {
            link.parent = new[&link.parent];
        }
        let points = self.tendons.points.iter_mut().chain([&mut self.fingertip]).chain(self.arm.iter_mut().flatten());
        let points = points.chain(&mut self.fingers);
        let points = points.chain(
            self.tendons.wraps.iter_mut().flat_map(|bundle| &mut bundle.stretches).flat_map(Stretch::points_mut),
        );
        let points = points.chain(self.pairs.iter_mut().flat_map(|pair| &mut pair.parts).flat_map(Part::points_mut));
        let points = points.chain(self.connections.iter_mut().flat_map(Connection::points_mut));
        for point in points.chain(self.contact_spheres.iter_mut().flat_map(|s| [&mut s.centre, &mut s.body_com])) {
            point.link = new[&point.link];
        }
        for pair in &mut self.tendons.pairs {
            (pair.a, pair.b) = (new[&pair.a], new[&pair.b]);
        }
        for body in &mut self.bodies {
            body.link = new[&body.link];
        }
        self.screws = assign_screws(&mut self.links);
    }

    /// Turns segments between links that `together` holds for into profiles of their squared length. Not of the length:
    /// its root makes a short segment's length too sharp a function for a polynomial.
    fn fold_length_profiles(&mut self, samples: &Samples, together: impl Fn(usize) -> bool) -> Option<()> {
        let old = self.tendons.clone();
        self.tendons.clear_segments();
        for (pair, &Segment { muscle, a, b }) in old.segments() {
            let (a, b) = (old.points[a], old.points[b]);
            let squared = |ws: &Workspace<f64>| {
                let between = ws.place(&b) - ws.place(&a);
                between.dot(between)
            };
            let shortest_of = |poses: &[Workspace<f64>]| poses.iter().map(squared).fold(f64::INFINITY, f64::min).sqrt();
            let (within, beyond) = samples.poses.split_at(NODES);
            let shortest = shortest_of(within);
            if !(together(pair.a) && together(pair.b)) || shortest.min(shortest_of(beyond)) < SHORTEST {
                self.tendons.add_segment(muscle, a, b);
                continue;
            }
            // dl = d(l^2) / (2 l)
            let square = samples.fit_to(TOLERANCE * 2.0 * shortest, squared)?;
            let half_slope = square.derivative().scaled(0.5 * samples.domain.scale());
            let coordinate = samples.coordinate;
            self.tendons.profiles.push(ProfileSegment { muscle, coordinate, square, half_slope });
        }
        Some(())
    }

    /// Moves segments across one or two hinges into closed forms.
    fn fold_hinge_segments(&mut self) {
        let old = self.tendons.clone();
        self.tendons.clear_segments();
        for (_, segment) in old.segments() {
            let (a, b) = (old.points[segment.a], old.points[segment.b]);
            let muscle = segment.muscle;
            if let Some(square) = self.across_hinge(a, b).filter(never_vanishes) {
                let half = [0.5 * square[1], 0.5 * square[2]];
                self.tendons.hinge.push(HingeSegment { muscle, link: b.link, square, half });
            } else if let Some((links, square)) = self.across_two_hinges(a, b) {
                self.tendons.double_hinge.push(DoubleHingeSegment { muscle, links, square });
            } else {
                self.tendons.add_segment(muscle, a, b);
            }
        }
        self.tendons.hinge.sort_by_key(|segment| segment.link);
    }

    fn hinge_to(&self, link: usize) -> Option<&Placement<f64>> {
        match &self.links[link].motion {
            LinkMotion::Hinge(placement) => Some(placement),
            _ => None,
        }
    }

    fn across_hinge(&self, a: Point<f64>, b: Point<f64>) -> Option<[f64; 3]> {
        let placement = self.hinge_to(b.link).filter(|_| self.links[b.link].parent == a.link)?;
        Some(squared_length(placement, Vector3::from(a.position), Vector3::from(b.position)))
    }

    /// Bilinear coefficients, from three positions of the first hinge: `c0 + c1 cos + c2 sin` through them.
    fn across_two_hinges(&self, a: Point<f64>, b: Point<f64>) -> Option<([usize; 2], [[f64; 3]; 3])> {
        let middle = self.links[b.link].parent;
        let (inner, outer) = (self.hinge_to(middle)?, self.hinge_to(b.link)?);
        if self.links[middle].parent != a.link || middle == 0 {
            return None;
        }
        let at = |angle: f64| {
            // The first point, seen from the link between the hinges.
            let seen = turned(-angle) * from_parent(inner, Vector3::from(a.position));
            squared_length(outer, seen, Vector3::from(b.position))
        };
        let third = std::f64::consts::TAU / 3.0;
        let [f0, f1, f2] = [at(0.0), at(third), at(2.0 * third)];
        let mut square = [[0.0; 3]; 3];
        for k in 0..3 {
            square[0][k] = (f0[k] + f1[k] + f2[k]) / 3.0;
            square[1][k] = (2.0 * f0[k] - f1[k] - f2[k]) / 3.0;
            square[2][k] = (f1[k] - f2[k]) / 3.0_f64.sqrt();
        }
        Some(([middle, b.link], square))
    }
}

/// Whether a segment of squared length `c0 + c1 cos + c2 sin` is never too short to have a direction.
fn never_vanishes([c0, c1, c2]: &[f64; 3]) -> bool {
    c0 - c1.hypot(*c2) > SHORTEST * SHORTEST
}

impl Tendons<f64> {
    fn clear_segments(&mut self) {
        self.points.clear();
        self.pairs.clear();
    }
    fn segments(&self) -> impl Iterator<Item = (&SegmentPair, &Segment)> {
        self.pairs.iter().flat_map(|pair| pair.segments.iter().map(move |segment| (pair, segment)))
    }
}

/// A point of the parent, seen from the frame of the joint.
fn from_parent(placement: &Placement<f64>, point: Vector3<f64>) -> Vector3<f64> {
    let moved = point - Vector3::from(placement.offset);
    match placement.axes {
        None => moved,
        Some(columns) => Matrix3::from_columns(&columns.map(Vector3::from)).transpose() * moved,
    }
}

fn turned(angle: f64) -> nalgebra::Rotation3<f64> {
    nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), angle)
}

/// `|a - R_z(angle) b|^2 = c0 + c1 cos(angle) + c2 sin(angle)`.
fn squared_length(placement: &Placement<f64>, a: Vector3<f64>, b: Vector3<f64>) -> [f64; 3] {
    let a = from_parent(placement, a);
    let constant = a.norm_squared() + b.norm_squared() - 2.0 * a.z * b.z;
    [constant, -2.0 * (a.x * b.x + a.y * b.y), -2.0 * (a.y * b.x - a.x * b.y)]
}

/// The exact plan at the nodes of a fit and past its ends: one coordinate swept at unit speed, the others at zero.
struct Samples {
    dof: usize,
    /// Index in [`Plan::profiled`].
    coordinate: usize,
    domain: Domain<f64>,
    links: Vec<Link<f64>>,
    /// Without gravity, at unit speed: accelerations are derivatives of screws.
    poses: Vec<Workspace<f64>>,
    /// With gravity, at rest.
    resting: Vec<Workspace<f64>>,
}

impl Samples {
    fn take(plan: &Plan<f64>, dof: usize) -> Option<Self> {
        let [lo, hi] = plan.dofs[dof].range?;
        let domain = Domain::new(lo - BEYOND_LIMITS, hi + BEYOND_LIMITS, FOLLOWED);
        let weightless = Plan { gravity: [0.0; 3], ..plan.clone() };
        let sample = |plan: &Plan<f64>, speed: f64| -> Vec<Workspace<f64>> {
            let at = |t: f64| {
                let (mut state, mut ws) = (State::<f64>::new(plan), Workspace::<f64>::new(plan));
                (state.qpos[plan.dofs[dof].at], state.qvel[dof]) = (domain.at(t), speed);
                kinematics::kinematics(plan, &state.qpos, &state.qvel, &mut ws);
                inertia::resist(plan, &mut ws);
                ws
            };
            nodes().chain(domain.beyond()).map(at).collect()
        };
        let (poses, resting) = (sample(&weightless, 1.0), sample(plan, 0.0));
        Some(Self { dof, coordinate: plan.profiled.len(), domain, links: plan.links.clone(), poses, resting })
    }

    fn screw(&self, ws: &Workspace<f64>, link: usize) -> Motion<f64> {
        ws.screw[self.links[link].screw_of_dof[self.dof].expect("the link moves with this coordinate")]
    }

    fn fit_to(&self, tolerance: f64, of: impl Fn(&Workspace<f64>) -> f64) -> Option<Polynomial<f64>> {
        fit(&self.domain, &self.poses.iter().map(of).collect::<Vec<_>>(), tolerance)
    }

    fn fit(&self, of: impl Fn(&Workspace<f64>) -> f64) -> Option<Polynomial<f64>> {
        self.fit_to(TOLERANCE, of)
    }

    fn fit_vector(&self, of: impl Fn(&Workspace<f64>) -> Vec3<f64>) -> Option<[Polynomial<f64>; 3]> {
        Some([self.fit(|ws| of(ws).x)?, self.fit(|ws| of(ws).y)?, self.fit(|ws| of(ws).z)?])
    }

    fn pose(&self, link: usize) -> Option<PoseProfile<f64>> {
        let turns = |ws: &Workspace<f64>| !is_identity(&ws.rotation[link]);
        let axes = if self.poses.iter().any(turns) {
            Some([self.fit_vector(|ws| ws.rotation[link].x)?, self.fit_vector(|ws| ws.rotation[link].y)?])
        } else {
            None
        };
        Some(PoseProfile {
            coordinate: self.coordinate,
            axes,
            position: self.fit_vector(|ws| ws.position[link])?,
            screw: [self.fit_vector(|ws| self.screw(ws, link).ang)?, self.fit_vector(|ws| self.screw(ws, link).lin)?],
            screw_rate: [
                self.fit_vector(|ws| ws.acceleration[link].ang)?,
                self.fit_vector(|ws| ws.acceleration[link].lin)?,
            ],
        })
    }

    /// Energy of the bodies on `links`.
    fn energy(&self, plan: &Plan<f64>, links: &BTreeSet<usize>) -> Option<EnergyProfile<f64>> {
        let massive: Vec<usize> = plan.bodies.iter().map(|b| b.link).filter(|link| links.contains(link)).collect();
        let sum = |term: &dyn Fn(usize) -> f64| massive.iter().map(|&link| term(link)).sum::<f64>();
        let inertia =
            |ws: &Workspace<f64>| sum(&|link| self.screw(ws, link).dot(ws.inertia[link].apply(self.screw(ws, link))));
        // `wrench` holds what inertia subtracts.
        let resistance = |ws: &Workspace<f64>| sum(&|link| -self.screw(ws, link).dot(ws.wrench[link]));
        let weight = fit(&self.domain, &self.resting.iter().map(resistance).collect::<Vec<_>>(), TOLERANCE)?;
        Some(EnergyProfile {
            coordinate: self.coordinate,
            inertia: self.fit(inertia)?,
            centrifugal: self.fit(resistance)?,
            weight,
        })
    }
}

fn is_identity(r: &Rotation<f64>) -> bool {
    let i = Rotation::<f64>::identity();
    let far = |a: Vec3<f64>, b: Vec3<f64>| (a - b).dot(a - b) > TOLERANCE * TOLERANCE;
    !(far(r.x, i.x) || far(r.y, i.y) || far(r.z, i.z))
}
