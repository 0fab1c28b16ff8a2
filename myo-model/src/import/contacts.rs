//! Which parts of a body may touch each other.

use super::apart::{Apart, frame};
use super::meshes::Meshes;
use super::{Import, written};
use crate::compile::SMALLEST_FRICTION;
use crate::description::{Contact, Geom, Shape, Softness};
use myo_mjcf::{self as source, Cone, Pair, Switch};
use std::cmp::Ordering;

/// A geom, with the number of its body and its own.
#[derive(Clone, Copy)]
pub(super) struct Held<'a> {
    pub body: usize,
    pub number: usize,
    pub geom: &'a source::Geom,
}

/// How many dimensions the force of a contact may have.
const CONDIMS: [i32; 4] = [1, 3, 4, 6];

/// Two geoms that may touch, and how.
struct Touch<'a> {
    geoms: [Held<'a>; 2],
    condim: i32,
    /// As MuJoCo has it: of two directions, of twisting, and of rolling about both.
    friction: [f64; 5],
    margin: f64,
    gap: f64,
    adhesion: f64,
    softness: Softness,
    /// Whether friction is as soft as something else, which pyramids do not ask.
    slides_otherwise: bool,
}

impl<'a> Import<'a> {
    /// Geoms that touch others, and which ones. What can never touch, however joints stand, is left out; so is what stands around (planes, cylinders, boxes), or could not be simulated, and is not
    /// touched unless joints stand far beyond their limits.
    pub(super) fn contacts(&mut self) -> (Vec<Geom>, Vec<Contact>) {
        if !self.keeps(self.mjcf.flags.contact()) {
            return (vec![], vec![]);
        }
        let mut touches = self.touches();
        let mut meshes = Meshes::of(self.mjcf, self.folder);
        touches.iter().flat_map(|touch| touch.geoms).for_each(|held| meshes.read(held.geom));
        let apart = Apart::of(self.mjcf, &meshes);
        touches.retain(|touch| !apart.always(touch.geoms, touch.reach()));
        let never = |touch: &Touch<'_>| {
            let is_sure = touch.is_simulated(&meshes) && !touch.has_scenery();
            !is_sure && apart.within_limits(touch.geoms, touch.reach(), |joint| self.hard_range(joint))
        };
        touches.retain(|touch| !never(touch));
        let (simulated, others): (Vec<_>, Vec<_>) = touches.into_iter().partition(|touch| touch.is_simulated(&meshes));
        if let Some(first) = others.first() {
            self.refuse_touch(first, others.len(), &meshes);
        }
        let mut geoms: Vec<Geom> = vec![];
        for held in simulated.iter().flat_map(|touch| touch.geoms) {
            let name = self.geom_name(held);
            if !geoms.iter().any(|geom| geom.name == name) {
                geoms.extend(self.geom(held, &mut meshes));
            }
        }
        self.hulls = meshes.hulls();
        let contact = |touch: &Touch<'_>| Contact {
            geoms: touch.geoms.map(|held| self.geom_name(held)),
            margin: touch.margin,
            softness: touch.softness,
            ..touch.friction()
        };
        let contacts = simulated.iter().map(contact).collect();
        (geoms, contacts)
    }

    /// Refuses the first contact of a kind that is not simulated, and says how many there are.
    fn refuse_touch(&mut self, touch: &Touch<'_>, count: usize, meshes: &Meshes<'_>) {
        let [one, other] = touch.geoms;
        let name = |held: Held<'_>| {
            held.geom
                .name
                .as_ref()
                .map_or_else(|| format!("the geom at {}", held.geom.place), |name| format!("`{name}`"))
        };
        let kinds = touch.geoms.map(|held| format!("{:?}", held.geom.kind()).to_lowercase());
        let unread = touch.geoms.iter().find_map(|held| Some((held, meshes.why_not(held.geom)?)));
        let why = if let Some((held, why)) = unread.filter(|_| touch.is_known()) {
            format!("the mesh of {}: {why}", name(*held))
        } else if !touch.is_known() {
            format!("contact of {} and {} is not simulated", kinds[0], kinds[1])
        } else if !CONDIMS.contains(&touch.condim) {
            format!("`condim` is {}; there are 1, 3, 4 and 6", touch.condim)
        } else {
            "of contacts only those with neither `gap` nor `adhesion`, nor `solreffriction` in elliptic cones, are simulated".into()
        };
        let others = if count > 1 { format!(", nor are {} more pairs like this", count - 1) } else { String::new() };
        let what = format!(
            "it may touch {}: {why}{others}; let parts pass through each other (`--without-contacts`, or `<option><flag contact=\"disable\"/></option>`)",
            name(other)
        );
        self.refuse(&one.geom.place, ("geom", one.geom.name.as_ref()), what);
    }

    /// All pairs that may touch by their bits, and those by name.
    fn touches(&self) -> Vec<Touch<'a>> {
        let welded = Welded::of(self);
        let held = |(number, (body, geom)): (usize, (usize, &'a source::Geom))| Held { body, number, geom };
        let geoms: Vec<Held<'a>> = self.mjcf.geoms().enumerate().map(held).collect();
        let find = |name: &str| geoms.iter().find(|held| held.geom.name.as_deref() == Some(name)).copied();
        let named = |pair: &'a Pair| {
            let geoms = [find(&pair.geom1)?, find(&pair.geom2)?];
            let slides_otherwise = pair.solreffriction() != [0.0; 2] && self.mjcf.option.cone() == Cone::Elliptic;
            let touch = Touch { slides_otherwise, ..Touch::of_pair(pair, geoms) };
            (welded.with[geoms[0].body] != welded.with[geoms[1].body]).then_some(touch)
        };
        let mut touches: Vec<Touch<'a>> = self.mjcf.pairs.iter().filter_map(named).collect();
        let asked: Vec<[usize; 2]> = touches.iter().map(|touch| touch.geoms.map(|held| held.number)).collect();
        let is_asked = |a: &Held<'_>, b: &Held<'_>| {
            asked.iter().any(|pair| *pair == [a.number, b.number] || *pair == [b.number, a.number])
        };
        // Most geoms are only seen.
        let mut touching = geoms.iter().filter(|held| held.geom.contype() != 0 || held.geom.conaffinity() != 0);
        while let Some(one) = touching.next() {
            for other in touching.clone() {
                if !is_asked(one, other) && self.may_touch(&welded, one, other) {
                    touches.push(Touch::of_geoms([*one, *other]));
                }
            }
        }
        touches
    }

    fn may_touch(&self, welded: &Welded, one: &Held<'_>, other: &Held<'_>) -> bool {
        let [a, b] = [welded.with[one.body], welded.with[other.body]];
        // What stands still does not touch what stands still, nor a body itself.
        if a == b {
            return false;
        }
        let by_bits =
            one.geom.contype() & other.geom.conaffinity() != 0 || other.geom.contype() & one.geom.conaffinity() != 0;
        let [first, second] = [one, other].map(|held| &self.names.bodies[held.body]);
        let ruled_out = || {
            self.mjcf.excludes.iter().any(|exclude| {
                (&exclude.body1, &exclude.body2) == (first, second)
                    || (&exclude.body1, &exclude.body2) == (second, first)
            })
        };
        let is_parent = self.mjcf.flags.filterparent() == Switch::On
            && a != 0
            && b != 0
            && (welded.parent(self, a) == b || welded.parent(self, b) == a);
        by_bits && !is_parent && !ruled_out()
    }

    /// The name of a geom that touches. What tendons run over, too, is there twice, under two names.
    fn geom_name(&self, held: Held<'_>) -> String {
        let name = &self.names.geoms[held.number];
        if self.is_run_over(name) { format!("{name}_surface") } else { name.clone() }
    }

    /// The description of a geom of a shape that is simulated.
    fn geom(&self, held: Held<'_>, meshes: &mut Meshes<'_>) -> Option<Geom> {
        let geom = held.geom;
        let mut described = Geom {
            name: self.geom_name(held),
            body: self.names.bodies[held.body].clone(),
            shape: Shape::Plane,
            pos: geom.pose.pos(),
            quat: geom.pose.quat(),
            margin: geom.margin(),
            friction: geom.friction(),
            softness: Softness { solref: geom.solref(), solimp: geom.solimp() },
        };
        if let Some(touching) = meshes.touching(geom) {
            let place = frame(&geom.pose) * touching.frame;
            (described.pos, described.quat) = (place.translation.vector.into(), written(&place.rotation));
            described.shape = Shape::Mesh { hull: meshes.hull(geom)?, scale: 1.0 };
        } else {
            described.shape = shape(geom)?;
        }
        Some(described)
    }
}

fn shape(geom: &source::Geom) -> Option<Shape> {
    // What is fitted to a mesh has its size from there.
    if geom.mesh.is_some() {
        return None;
    }
    match geom.kind() {
        source::Shape::Plane => Some(Shape::Plane),
        kind => solid(kind, geom.size()),
    }
}

/// A shape with an inside, of MuJoCo's kind and sizes.
pub(super) fn solid(kind: source::Shape, [a, b, c]: [f64; 3]) -> Option<Shape> {
    match kind {
        source::Shape::Sphere => Some(Shape::Sphere { radius: a }),
        source::Shape::Capsule => Some(Shape::Capsule { radius: a, half_length: b }),
        source::Shape::Ellipsoid => Some(Shape::Ellipsoid { radii: [a, b, c] }),
        source::Shape::Cylinder => Some(Shape::Cylinder { radius: a, half_length: b }),
        source::Shape::Box => Some(Shape::Box { half_size: [a, b, c] }),
        _ => None,
    }
}

/// What a geom is like where it touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Plane,
    Cylinder,
    Sphere,
    Capsule,
    Ellipsoid,
    Box,
    Mesh,
    Other,
}

impl Form {
    fn of(geom: &source::Geom) -> Self {
        match (shape(geom), geom.kind()) {
            (Some(Shape::Plane), _) => Self::Plane,
            (Some(Shape::Cylinder { .. }), _) => Self::Cylinder,
            (Some(Shape::Sphere { .. }), _) => Self::Sphere,
            (Some(Shape::Capsule { .. }), _) => Self::Capsule,
            (Some(Shape::Ellipsoid { .. }), _) => Self::Ellipsoid,
            (Some(Shape::Box { .. }), _) => Self::Box,
            (None, source::Shape::Mesh) => Self::Mesh,
            _ => Self::Other,
        }
    }

    /// Whether things often stand around in this form.
    fn is_scenery(self) -> bool {
        matches!(self, Self::Plane | Self::Cylinder | Self::Box)
    }

    /// Whether contacts of two are simulated: of all but two cylinders.
    fn meets(self, other: Self) -> bool {
        let is_known = self != Self::Other && other != Self::Other;
        is_known && !matches!((self, other), (Self::Plane, Self::Plane) | (Self::Cylinder, Self::Cylinder))
    }
}

impl<'a> Touch<'a> {
    fn is_simulated(&self, meshes: &Meshes<'_>) -> bool {
        self.is_known()
            && self.geoms.iter().all(|held| meshes.why_not(held.geom).is_none())
            && (self.gap, self.adhesion) == (0.0, 0.0)
            && !self.slides_otherwise
            && CONDIMS.contains(&self.condim)
    }

    /// Whether contacts of such shapes are simulated.
    fn is_known(&self) -> bool {
        let [one, other] = self.geoms.map(|held| Form::of(held.geom));
        one.meets(other)
    }

    /// Whether one of them often stands around: a plane, cylinder or box.
    fn has_scenery(&self) -> bool {
        self.geoms.iter().any(|held| Form::of(held.geom).is_scenery())
    }

    /// A contact with its friction: none where it has no dimension for it, else no less than MuJoCo takes.
    fn friction(&self) -> Contact {
        let of =
            |k: usize, condim: i32| if self.condim < condim { 0.0 } else { self.friction[k].max(SMALLEST_FRICTION) };
        let [friction, across] = [of(0, 3), of(1, 3)];
        Contact {
            friction,
            friction_across: (across != friction).then_some(across),
            torsional: of(2, 4),
            rolling: [of(3, 6), of(4, 6)],
            ..Contact::default()
        }
    }

    /// How near (m) the geoms have to come for any force: what sticks is drawn from farther away.
    fn reach(&self) -> f64 {
        if self.adhesion == 0.0 { self.margin } else { self.margin + self.gap }
    }

    fn of_pair(pair: &'a Pair, geoms: [Held<'a>; 2]) -> Self {
        Self {
            geoms,
            condim: pair.condim(),
            friction: pair.friction(),
            margin: pair.margin(),
            gap: pair.gap(),
            adhesion: pair.adhesion(),
            softness: Softness { solref: pair.solref(), solimp: pair.solimp() },
            slides_otherwise: false,
        }
    }

    /// Two geoms mix their parameters, unless one has the higher priority.
    fn of_geoms(geoms: [Held<'a>; 2]) -> Self {
        let [one, other] = geoms.map(|held| held.geom);
        let first = match one.priority().cmp(&other.priority()) {
            Ordering::Greater => Some(one),
            Ordering::Less => Some(other),
            Ordering::Equal => None,
        };
        let mixed = || {
            let share = mix(one.solmix(), other.solmix());
            let between = |a: f64, b: f64| share * a + (1.0 - share) * b;
            let (solref, other_solref) = (one.solref(), other.solref());
            // Stiffness and damping, which are negative, are not mixed.
            let is_direct = solref[0] <= 0.0 || other_solref[0] <= 0.0;
            let of_both = |a: f64, b: f64| if is_direct { a.min(b) } else { between(a, b) };
            Softness {
                solref: std::array::from_fn(|k| of_both(solref[k], other_solref[k])),
                solimp: std::array::from_fn(|k| between(one.solimp()[k], other.solimp()[k])),
            }
        };
        let greater = || std::array::from_fn(|k| one.friction()[k].max(other.friction()[k]));
        let [sliding, torsional, rolling] = first.map_or_else(greater, source::Geom::friction);
        Self {
            geoms,
            condim: first.map_or_else(|| one.condim().max(other.condim()), source::Geom::condim),
            friction: [sliding, sliding, torsional, rolling, rolling],
            margin: one.margin() + other.margin(),
            gap: one.gap() + other.gap(),
            adhesion: one.adhesion() + other.adhesion(),
            softness: first.map_or_else(mixed, |first| Softness { solref: first.solref(), solimp: first.solimp() }),
            slides_otherwise: false,
        }
    }
}

/// Share of the first of two geoms in what they mix; MuJoCo's rule for weights of nothing.
fn mix(one: f64, other: f64) -> f64 {
    const NOTHING: f64 = 1e-15;
    match (one < NOTHING, other < NOTHING) {
        (false, false) => one / (one + other),
        (true, true) => 0.5,
        (true, false) => 0.0,
        (false, true) => 1.0,
    }
}

/// Bodies that move as one.
struct Welded {
    /// Of each body the topmost one that it moves with.
    with: Vec<usize>,
}

impl Welded {
    fn of(import: &Import<'_>) -> Self {
        let mut with = vec![0; import.mjcf.bodies.len()];
        for (number, body) in import.mjcf.bodies.iter().enumerate() {
            with[number] = if body.joints.is_empty() { with[body.parent] } else { number };
        }
        Self { with }
    }

    fn parent(&self, import: &Import<'_>, body: usize) -> usize {
        self.with[import.mjcf.bodies[body].parent]
    }
}
