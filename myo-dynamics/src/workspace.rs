//! State of the body, and everything that one step computes on the way.

use crate::mesh::Scratch;
use crate::plan::{Bundle, Plan};
use crate::spatial::{Frame, Inertia, Motion, Rotation, Vec3, Wrench};
use crate::step::wrap::Gap;
use crate::step::{ConeSearch, Coriolis};
use myo_scalar::{Mask, Real, Scalar, Word};

/// What changes from step to step: the body's full state.
#[derive(Clone, Debug)]
pub struct State<S> {
    /// Positions (rad or m; quaternions), `nq`.
    pub qpos: Vec<S>,
    /// Rates of the generalised coordinates (rad/s or m/s), `ndof`.
    pub qvel: Vec<S>,
    /// Muscle activations, `nmuscle`.
    pub act: Vec<S>,
}

impl<S: Scalar> State<S> {
    /// At rest in the pose of reference, of a plan in any precision.
    pub fn new<C: Real>(plan: &Plan<C>) -> Self {
        let zeros = |n| vec![S::zero(); n];
        Self {
            qpos: plan.qpos0.iter().map(|q| S::lit(q.to_f64())).collect(),
            qvel: zeros(plan.ndof()),
            act: zeros(plan.nmuscle()),
        }
    }
}

/// A joint at one moment.
#[derive(Clone, Copy, Debug)]
pub struct JointState<S> {
    /// Position (rad or m).
    pub position: S,
    /// Rate of the position.
    pub rate: S,
    /// Derivative of the position with respect to the coordinate.
    pub slope: S,
    /// Second derivative times squared speed: the acceleration that the coupling alone causes.
    pub drift: S,
    /// Sine and cosine of the position, for hinges.
    pub sin: S,
    /// See `sin`.
    pub cos: S,
}

/// Where profiles are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct ProfiledState<S: Scalar> {
    /// Argument of the polynomials.
    pub argument: S,
    /// Where the coordinate is not so far past its limits that they are held.
    pub is_free: S::Mask,
    /// Speed of the coordinate (rad/s), zero where they are held.
    pub speed: S,
    /// Torque on the coordinate (N m) apart from the profiles' share.
    pub passive: S,
}

/// A soft constraint row on one coordinate or on all of them.
#[derive(Clone, Copy, Debug)]
pub struct Row<S: Scalar> {
    /// Where the row exists.
    pub exists: S::Mask,
    /// Where it pushes in the current round.
    pub active: S::Mask,
    /// `D`, the reciprocal regularisation.
    pub weight: S,
    /// Reference acceleration.
    pub reference: S,
    /// For limits: derivative of the row's position with respect to the coordinate.
    pub slope: S,
}

impl<S: Scalar> Row<S> {
    /// How hard it pushes where its acceleration is so.
    #[inline(always)]
    pub(crate) fn force(&self, acceleration: S) -> S {
        (self.weight * (self.reference - acceleration)).only(self.active)
    }

    pub(crate) fn none() -> Self {
        let no = S::Mask::splat(false);
        Self { exists: no, active: no, weight: S::zero(), reference: S::zero(), slope: S::zero() }
    }
}

/// Contact of the fingertip with a box, or of two parts of the body.
#[derive(Clone, Copy, Debug)]
pub struct Contact<S: Scalar> {
    /// Where there is one.
    pub exists: S::Mask,
    /// Index of the box; of no meaning for parts of the body.
    pub index: S,
    /// Distance of the surfaces, negative inside (m).
    pub distance: S,
    /// Out of the box, or from the first part to the second.
    pub normal: Vec3<S>,
    /// Cosine of the angle between it and the third axis of the box: 1 on the face, 0 on a side; zero for parts of the body.
    pub facing: S,
    /// The four edges of the friction pyramid.
    pub rows: [Row<S>; 4],
    /// Sum of normal forces (N): what MuJoCo's touch sensor reads.
    pub force: S,
}

impl<S: Scalar> Contact<S> {
    /// No contact.
    pub fn none() -> Self {
        let (no, o) = (S::Mask::splat(false), S::zero());
        Self {
            exists: no,
            index: o,
            distance: o,
            normal: Vec3::zero(),
            facing: o,
            rows: [Row::none(); PYRAMID],
            force: o,
        }
    }

    /// Ends it, everywhere.
    #[inline(always)]
    pub(crate) fn clear(&mut self) {
        let no = S::Mask::splat(false);
        (self.exists, self.force) = (no, S::zero());
        for row in &mut self.rows {
            (row.exists, row.active) = (no, no);
        }
    }
}

/// A contact of a pair, by the numbers of both.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairContact {
    pub pair: usize,
    pub contact: usize,
}

/// How far the fingertip may move before it can touch anything.
#[derive(Clone, Copy, Debug)]
pub struct Clearance<S> {
    /// From where (m, from the shoulder centre).
    pub from: Vec3<S>,
    /// By how much (m); nothing is known where it is zero.
    pub free: S,
}

impl<S: Scalar> Clearance<S> {
    /// Nothing is known.
    #[inline(always)]
    pub fn unknown() -> Self {
        Self { from: Vec3::zero(), free: S::zero() }
    }
}

/// The boxes that are nearest to where the fingertip was.
#[derive(Clone, Debug)]
pub struct Nearby<S> {
    /// Where it was (m, from the shoulder centre).
    pub from: Vec3<S>,
    /// How far it may move (m) before any other box can be touched; nothing is known where it is zero.
    pub free: S,
    /// Their numbers: some more than can be touched at once.
    pub boxes: Vec<S>,
}

impl<S: Scalar> Nearby<S> {
    /// Boxes that are listed beyond those that can be touched at once.
    const SPARE: usize = 2;

    /// Nothing is known.
    fn unknown(contacts: usize) -> Self {
        Self { from: Vec3::zero(), free: S::zero(), boxes: vec![S::zero(); contacts + Self::SPARE] }
    }

    /// Forgets what it knew.
    #[inline(always)]
    pub fn forget(&mut self) {
        self.free = S::zero();
    }
}

/// Number of edges of the friction pyramid.
pub const PYRAMID: usize = 4;

/// What the constraint solver did, per lane. A lane holds at most 2^32 rounds; [`SolverTally::take`] empties it in time.
#[derive(Clone, Copy, Debug)]
pub struct SolverTally<S: Scalar> {
    /// Rounds of all steps.
    pub rounds: S::Word,
    /// Steps that ended with rows still wrong.
    pub unsolved: S::Word,
}

impl<S: Scalar> SolverTally<S> {
    /// Nothing yet.
    #[inline(always)]
    pub fn new() -> Self {
        Self { rounds: S::Word::splat(0), unsolved: S::Word::splat(0) }
    }

    /// Adds what `steps` steps did to the counts of this block's bodies, the first one in lane 0, and starts anew.
    #[inline(always)]
    pub fn take(&mut self, steps: usize, counts: &mut [SolverCount]) {
        let (mut rounds, mut unsolved) = ([0; MAX_LANES], [0; MAX_LANES]);
        self.rounds.store(&mut rounds);
        self.unsolved.store(&mut unsolved);
        SolverCount::add(counts, steps, [&rounds, &unsolved]);
        *self = Self::new();
    }
}

impl<S: Scalar> Default for SolverTally<S> {
    fn default() -> Self {
        Self::new()
    }
}

/// Most lanes of any level.
pub(crate) const MAX_LANES: usize = 16;

/// What the constraint solver did for one body, or for several together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SolverCount {
    /// Physics steps.
    pub steps: u64,
    /// Rounds that they took; one each without limits and contact.
    pub rounds: u64,
    /// Steps that ended after the greatest number of rounds with rows still wrong: their forces are not to be trusted.
    pub unsolved: u64,
}

impl SolverCount {
    /// Adds what `steps` steps did to the counts of bodies: rounds of each, and steps that were left unsolved.
    pub fn add(counts: &mut [Self], steps: usize, [rounds, unsolved]: [&[u32]; 2]) {
        for ((count, &rounds), &unsolved) in counts.iter_mut().zip(rounds).zip(unsolved) {
            *count += Self { steps: steps as u64, rounds: rounds.into(), unsolved: unsolved.into() };
        }
    }
}

impl std::ops::AddAssign for SolverCount {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.rounds += other.rounds;
        self.unsolved += other.unsolved;
    }
}

impl std::iter::Sum for SolverCount {
    fn sum<I: Iterator<Item = Self>>(counts: I) -> Self {
        counts.fold(Self::default(), |mut sum, count| {
            sum += count;
            sum
        })
    }
}

/// Results and scratch memory of one step; allocated once, overwritten by every step.
#[derive(Clone, Debug)]
pub struct Workspace<S: Scalar> {
    /// Per profiled coordinate of the plan.
    pub profiled: Vec<ProfiledState<S>>,
    /// Per link.
    pub joint: Vec<JointState<S>>,
    /// Axes of each link in the world.
    pub rotation: Vec<Rotation<S>>,
    /// Origin of each link (m, from O, or from the free body of a plan that [reckons from there](Plan::carried): the world's is O then).
    pub position: Vec<Vec3<S>>,
    /// Whether it does.
    pub is_carried: bool,
    /// What looking for contacts of meshes needs.
    pub touching: Scratch,
    /// By a pair's first contact, a direction from its first part to the second along which they were far apart, in the first's frame, if the second is a mesh. No result
    /// depends on it, but where to begin to look.
    pub towards: Vec<Vec3<S>>,
    /// Screws: one per link, then the plan's further ones.
    pub screw: Vec<Motion<S>>,
    /// Velocity of each link.
    pub velocity: Vec<Motion<S>>,
    /// Acceleration of each link at zero acceleration of the coordinates, minus gravity.
    pub acceleration: Vec<Motion<S>>,
    /// Applied minus inertial wrench on each link.
    pub wrench: Vec<Wrench<S>>,
    /// Inertia of each link about O.
    pub inertia: Vec<Inertia<S>>,
    /// Sums over the plan's sets.
    pub set_inertia: Vec<Inertia<S>>,
    /// Sums over the plan's sets.
    pub set_wrench: Vec<Wrench<S>>,
    /// Direction and moment of each straight segment, in the order of the plan's pairs.
    pub line: Vec<Wrench<S>>,
    /// Of each stretch that may bend, in the order of the plan's bundles: the lines that leave its first point and arrive at its
    /// last one. That of a moored end is not worked out, since it pulls nothing.
    pub wrap_lines: Vec<[Wrench<S>; 2]>,
    /// One where such a stretch bends, else zero.
    pub wrap_bends: Vec<S>,
    /// What is looked for of those that may lead through something round, in the same order.
    pub(crate) gaps: Vec<Gap<S>>,
    /// Derivative of length per hinge segment.
    pub hinge_slope: Vec<S>,
    /// Derivatives of length per double-hinge segment.
    pub double_hinge_slope: Vec<[S; 2]>,
    /// Derivative of length per profile segment.
    pub profile_slope: Vec<S>,
    /// Torque on each link's joint from hinge segments (N m).
    pub joint_torque: Vec<S>,
    /// Length of each muscle's path, and then of each of the plan's branches (m).
    pub tendon_length: Vec<S>,
    /// Its rate (m/s).
    pub tendon_velocity: Vec<S>,
    /// Actuator forces (N), negative when pulling: of muscles, and then what of them pulls along each branch.
    pub muscle_force: Vec<S>,
    /// Moment arms of every path on every coordinate (m or 1), `(paths, ndof)`, of plans whose steps are implicit; else empty.
    pub arms: Vec<S>,
    /// Mass matrix with armature, `(ndof, ndof)`, lower triangle.
    pub mass: Vec<S>,
    /// Generalised force without constraints, `ndof`.
    pub torque: Vec<S>,
    /// Limit rows.
    pub limit: Vec<Row<S>>,
    /// Rows of limited tendons.
    pub tendon_limit: Vec<Row<S>>,
    /// How far they get from their limit with every coordinate, `(tendon limits, ndof)`, where they are at one.
    pub tendon_limit_jacobian: Vec<S>,
    /// Equality rows.
    pub equality: Vec<Row<S>>,
    /// Jacobian of the equality rows, `(nequality, ndof)`.
    pub equality_jacobian: Vec<S>,
    /// Contacts: of each sphere that presses with boxes, as many as there can be at once, see [`Workspace::box_contacts`]; then those of each pair of the plan, in as many points as it may touch.
    pub contacts: Vec<Contact<S>>,
    /// How many of them are with boxes.
    pub box_slots: usize,
    /// Of the others, those that the solver found in any lane.
    pub(crate) touching_pairs: Vec<PairContact>,
    /// Per sphere that presses, where no box has to be looked at. Who puts the body elsewhere, or other boxes around it, makes it
    /// [unknown](Clearance::unknown).
    pub clearance: Vec<Clearance<S>>,
    /// How far boxes are off their places and their half sizes (m), by the numbers in [`Obstacles::moved_by`](crate::Obstacles::moved_by)
    /// and [`Obstacles::grown_by`](crate::Obstacles::grown_by); empty where none is.
    /// Set by whoever moves them.
    pub offsets: Vec<Vec3<S>>,
    /// Per sphere that presses, the nearest boxes, where there are many.
    pub nearby: Vec<Nearby<S>>,
    /// Jacobian of the contacts' rows, `(contacts, 4, ndof)`.
    pub contact_jacobian: Vec<S>,
    /// Matrix of the solver and its factor, `(ndof, ndof)`, lower triangle.
    pub matrix: Vec<S>,
    /// Reciprocal diagonal of the factor.
    pub pivot: Vec<S>,
    /// Generalised acceleration, `ndof`.
    pub qacc: Vec<S>,
    /// The acceleration that the last step integrated: `qacc`, or with damping taken implicitly, `ndof`. Until then the solver's, where there are cones.
    pub step_qacc: Vec<S>,
    /// Scratch of implicit steps that take Coriolis forces along.
    pub coriolis: Coriolis<S>,
    /// Scratch of the solver where there are cones.
    pub search: ConeSearch<S>,
    /// Where rows were still wrong in the solver's last round.
    pub unsettled: S::Mask,
    /// What the solver did since this was last taken.
    pub tally: SolverTally<S>,
}

impl<S: Scalar> Workspace<S> {
    /// Memory for a plan whose fingers touch one box each at a time.
    pub fn new(plan: &Plan<S::Const>) -> Self {
        Self::with_contacts(plan, 1)
    }

    /// Memory for a plan and so many boxes that each sphere can touch at once: no fewer than
    /// [`Obstacles::most_at_once`](crate::Obstacles::most_at_once) says, else contacts are left out.
    pub fn with_contacts(plan: &Plan<S::Const>, contacts: usize) -> Self {
        let o = S::zero();
        let (nlink, ndof, npath) = (plan.links.len(), plan.ndof(), plan.tendons.constant.len());
        let joint = JointState { position: o, rate: o, slope: o, drift: o, sin: o, cos: o };
        let profiled = ProfiledState { argument: o, is_free: S::Mask::splat(true), speed: o, passive: o };
        let nscrew = nlink + plan.screws.len();
        let nsegment = plan.tendons.pairs.iter().map(|pair| pair.segments.len()).sum();
        let nstretch = plan.tendons.wraps.iter().map(|bundle| bundle.stretches.len()).sum();
        let massless = Inertia::zero();
        let spheres = plan.contact_spheres.len();
        let (each, box_slots) = (contacts, contacts * spheres);
        let contacts = box_slots + plan.pair_contacts();
        Self {
            profiled: vec![profiled; plan.profiled.len()],
            joint: vec![joint; nlink],
            rotation: vec![Rotation::identity(); nlink],
            position: vec![Vec3::zero(); nlink],
            is_carried: plan.carried.is_some(),
            touching: Scratch::new(plan.hulls.iter().map(AsRef::as_ref)).remembering(crate::step::seeds::<S>(plan)),
            towards: vec![Vec3::zero(); plan.pair_contacts()],
            screw: vec![Motion::zero(); nscrew],
            velocity: vec![Motion::zero(); nlink],
            acceleration: vec![Motion::zero(); nlink],
            wrench: vec![Wrench::zero(); nlink],
            inertia: vec![massless; nlink],
            set_inertia: vec![massless; plan.sets.len()],
            set_wrench: vec![Wrench::zero(); plan.sets.len()],
            line: vec![Wrench::zero(); nsegment],
            wrap_lines: vec![[Wrench::zero(); 2]; nstretch],
            wrap_bends: vec![o; nstretch],
            gaps: vec![Gap::none(); plan.tendons.wraps.iter().map(Bundle::ngap).sum()],
            hinge_slope: vec![o; plan.tendons.hinge.len()],
            double_hinge_slope: vec![[o; 2]; plan.tendons.double_hinge.len()],
            profile_slope: vec![o; plan.tendons.profiles.len()],
            joint_torque: vec![o; nlink],
            tendon_length: vec![o; npath],
            tendon_velocity: vec![o; npath],
            muscle_force: vec![o; npath],
            arms: vec![o; if plan.implicit_muscles.is_empty() { 0 } else { npath * ndof }],
            mass: vec![o; ndof * ndof],
            torque: vec![o; ndof],
            limit: vec![Row::none(); plan.limits.len()],
            tendon_limit: vec![Row::none(); plan.tendon_limits.len()],
            tendon_limit_jacobian: vec![o; plan.tendon_limits.len() * ndof],
            equality: vec![Row::none(); plan.equality_rows()],
            equality_jacobian: vec![o; plan.equality_rows() * ndof],
            contacts: vec![Contact::none(); contacts],
            box_slots,
            touching_pairs: Vec::with_capacity(plan.pair_contacts()),
            clearance: vec![Clearance::unknown(); spheres],
            offsets: vec![],
            nearby: vec![Nearby::unknown(each); spheres],
            contact_jacobian: vec![o; contacts * PYRAMID * ndof],
            matrix: vec![o; ndof * ndof],
            pivot: vec![o; ndof],
            qacc: vec![o; ndof],
            step_qacc: vec![o; ndof],
            coriolis: Coriolis::new(plan),
            search: ConeSearch::new(if plan.has_cones() { ndof } else { 0 }),
            unsettled: S::Mask::splat(false),
            tally: SolverTally::new(),
        }
    }

    /// Forgets where meshes touched. Searches begin there, and of two ways that are as good they may find another one: what other bodies did before
    /// must not count.
    pub fn forget_touches(&mut self) {
        self.touching.forget();
        self.towards.fill(Vec3::zero());
    }

    /// Contacts with boxes of each sphere that presses, in the order of [`Plan::contact_spheres`].
    pub fn box_contacts(&self) -> impl Iterator<Item = &[Contact<S>]> + Clone {
        (0..self.clearance.len()).map(|sphere| &self.contacts[self.slots_of(sphere)])
    }

    /// Which contacts are those with boxes of the sphere of this number.
    #[inline(always)]
    pub(crate) fn slots_of(&self, sphere: usize) -> std::ops::Range<usize> {
        let each = self.box_slots / self.clearance.len();
        sphere * each..(sphere + 1) * each
    }

    /// Nothing is known any more of how far spheres are from boxes.
    pub fn forget_boxes(&mut self) {
        self.clearance.fill(Clearance::unknown());
        self.nearby.iter_mut().for_each(Nearby::forget);
    }

    /// Position of a point fixed to a link (m, from O).
    #[inline(always)]
    pub fn place<C: Real>(&self, point: &crate::plan::Point<C>) -> Vec3<S>
    where
        S: Scalar<Const = C>,
    {
        let local = Vec3::splat(point.position);
        if point.link == 0 {
            return self.carried(local);
        }
        self.frame(point.link).place(local)
    }

    /// The place that is this far from O, as this plan reckons it.
    #[inline(always)]
    pub(crate) fn carried(&self, place: Vec3<S>) -> Vec3<S> {
        if self.is_carried { place + self.position[0] } else { place }
    }

    /// How far from O a place is that this plan reckons so.
    #[inline(always)]
    pub(crate) fn uncarried(&self, place: Vec3<S>) -> Vec3<S> {
        if self.is_carried { place - self.position[0] } else { place }
    }

    /// Axes in the world, and origin (m, from O), of a frame fixed to a link.
    #[inline(always)]
    pub fn fixed<C: Real>(&self, frame: &crate::plan::FixedFrame<C>) -> Frame<S>
    where
        S: Scalar<Const = C>,
    {
        Frame { rotation: self.rotation[frame.origin.link].times(&frame.axes), position: self.place(&frame.origin) }
    }

    /// Axes and origin of a link.
    #[inline(always)]
    pub fn frame(&self, link: usize) -> Frame<S> {
        Frame { rotation: self.rotation[link], position: self.position[link] }
    }
}
