//! From description to model: names become indices, and what elements say about each other is checked.

mod connections;
mod hulls;
mod looks;
mod sensors;

use crate::check::{Bound, Check};
use crate::description::{self as source, JointKind, ModelDescription, PathElement, Shape};
use crate::error::{Element, ElementKind, ModelError};
use crate::model::{Body, Contact, Coupling, Geom, Joint, Model, Muscle, Over, Pulley, Site, WORLD, Wrap};
use myo_nearest::Nearest;
use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use sensors::Measured;
use std::collections::HashMap;

pub(crate) use hulls::MOST_CORNERS;
#[cfg(test)]
pub(crate) use hulls::hull;

/// Version of the model format that this crate reads.
pub const FORMAT_VERSION: u32 = 1;

/// Fingers that a model may name beside the one that points: with it those of a hand.
pub const MOST_FINGERS: usize = 4;

/// How many times as hard friction may be as the normal force.
const IMPRATIOS: std::ops::RangeInclusive<f64> = 1e-3..=1e3;

/// Time steps (s) that models may ask for.
const TIMESTEPS: std::ops::RangeInclusive<f64> = 1e-5..=0.02;

/// Mass (kg) and inertia (kg m^2) below which a moving body makes the mass matrix singular; MuJoCo's bound.
const SMALLEST_MOVING: f64 = 1e-15;

/// Smallest radius (m) of what muscles run over: single precision makes nothing of less.
const SMALLEST_WRAP: f64 = 1e-5;

/// Smallest semi-axis (m) of an ellipsoid: single precision finds nothing on a thinner one.
const SMALLEST_RADIUS: f64 = 1e-4;
/// Least scale of a convex mesh.
const SMALLEST_SCALE: f64 = 1e-3;

/// What lengths of branches may be divided by.
const DIVISORS: std::ops::RangeInclusive<f64> = 0.1..=100.0;

/// Smallest friction; MuJoCo's.
pub(crate) const SMALLEST_FRICTION: f64 = 1e-5;

/// How much (relative) a principal moment may exceed the sum of the others: figures are rounded where they are printed.
const INERTIA_ROUNDING: f64 = 1e-6;

impl Model {
    /// Checks a description and resolves its names.
    ///
    /// Bodies are put in depth-first order (parents before children, siblings as written), joints, sites, geoms and wraps in the
    /// order of their bodies; this is the order that MuJoCo gives the same model. Couplings and muscles stay as written.
    pub fn new(description: &ModelDescription) -> Result<Self, ModelError> {
        if description.version != FORMAT_VERSION {
            return Err(ModelError::FormatVersion { found: description.version, supported: FORMAT_VERSION });
        }
        check_options(description)?;
        let (bodies, body_index) = bodies(description)?;
        check_anthropometry(description, &body_index)?;
        let joints = joints(description, &body_index)?;
        check_freedom(&bodies, &joints)?;
        check_moving_mass(&bodies, &joints)?;
        let couplings = couplings(description, &joints)?;
        let connections = connections::connections(description, &body_index)?;
        let sites = sites(description, &body_index)?;
        let hulls = hulls::hulls(description)?;
        let geoms = geoms(description, &body_index)?;
        let contacts = contacts(description, &geoms)?;
        let site_index = Index::new(ElementKind::Site, sites.iter().map(|site| site.name.as_str()))?;
        let wraps = wraps(description, &body_index)?;
        let wrap_index = Index::new(ElementKind::Wrap, wraps.iter().map(|wrap| wrap.name.as_str()))?;
        let muscles = muscles(description, &site_index, &wrap_index)?;
        let landmarks = Element::new(ElementKind::Landmarks, "");
        let body = |name: &Option<String>| name.as_deref().map(|name| body_index.find(name, &landmarks)).transpose();
        let fingers = fingers(description, &site_index)?;
        let looks = looks::looks(description, &body_index)?;
        let measured = Measured {
            bodies: &body_index,
            joints: &joints,
            sites: &sites,
            geoms: &geoms,
            wraps: &wraps,
            muscles: &muscles,
        };
        let sensors = sensors::sensors(description, &measured)?;
        Ok(Self {
            name: description.name.clone(),
            changes: description.changes.clone(),
            stature_m: description.anthropometry.as_ref().map(|whose| whose.height_m),
            options: description.options.clone(),
            fingertip_site: site_index.find(&description.landmarks.fingertip, &landmarks)?,
            fingers,
            shoulder_body: body_index.find(&description.landmarks.shoulder, &landmarks)?,
            elbow_body: body(&description.landmarks.elbow)?,
            wrist_body: body(&description.landmarks.wrist)?,
            bodies,
            joints,
            couplings,
            connections,
            sites,
            geoms,
            contacts,
            wraps,
            muscles,
            hulls,
            sensors,
            looks,
        })
    }
}

/// Names of one kind of element, each with its position.
struct Index<'a> {
    kind: ElementKind,
    positions: HashMap<&'a str, usize>,
    names: Vec<&'a str>,
}

impl<'a> Index<'a> {
    fn new(kind: ElementKind, names: impl IntoIterator<Item = &'a str>) -> Result<Self, ModelError> {
        let names: Vec<_> = names.into_iter().collect();
        let mut positions = HashMap::new();
        for (position, &name) in names.iter().enumerate() {
            if name.is_empty() {
                return Err(ModelError::EmptyName { kind, position: position + 1 });
            }
            if positions.insert(name, position).is_some() {
                return Err(ModelError::DuplicateName { element: Element::new(kind, name) });
            }
        }
        Ok(Self { kind, positions, names })
    }

    fn find(&self, name: &str, from: &Element) -> Result<usize, ModelError> {
        self.positions.get(name).copied().ok_or_else(|| ModelError::UnknownName {
            element: from.clone(),
            wanted: self.kind,
            name: name.to_owned(),
            nearest: Nearest::to(name, &self.names),
        })
    }
}

/// Sites of other fingers, by name.
fn fingers(description: &ModelDescription, sites: &Index<'_>) -> Result<Vec<(String, usize)>, ModelError> {
    let (fingers, landmarks) = (&description.landmarks.fingers, Element::new(ElementKind::Landmarks, ""));
    if fingers.len() > MOST_FINGERS {
        return Err(ModelError::TooManyFingers { count: fingers.len(), most: MOST_FINGERS });
    }
    if let Some(position) = fingers.keys().position(|name| name.trim().is_empty()) {
        return Err(ModelError::EmptyName { kind: ElementKind::Landmarks, position: position + 1 });
    }
    if let Some(name) = fingers.keys().find(|name| name.as_str() == "fingertip") {
        return Err(ModelError::ReservedFinger { name: name.clone() });
    }
    let mut tips = vec![("fingertip", &description.landmarks.fingertip)];
    for (name, site) in fingers {
        if let Some((one, _)) = tips.iter().find(|(_, tip)| *tip == site) {
            let [site, one, other] = [site, *one, name].map(str::to_owned);
            return Err(ModelError::SharedTip { site, one, other });
        }
        tips.push((name, site));
    }
    fingers.iter().map(|(name, site)| Ok((name.clone(), sites.find(site, &landmarks)?))).collect()
}

fn check_options(description: &ModelDescription) -> Result<(), ModelError> {
    let check = Check::new(ElementKind::Options, "");
    check.within("gravity", &description.options.gravity, &Bound::ACCELERATION)?;
    let impratio = description.options.impratio;
    check.require(IMPRATIOS.contains(&impratio), "impratio", impratio, "", "from 0.001 to 1000")?;
    let timestep = description.options.timestep;
    check.require(TIMESTEPS.contains(&timestep), "timestep", timestep, " s", "from 0.00001 to 0.02 s")
}

fn check_anthropometry(description: &ModelDescription, bodies: &Index<'_>) -> Result<(), ModelError> {
    let Some(whose) = &description.anthropometry else { return Ok(()) };
    let check = Check::new(ElementKind::Anthropometry, "");
    let is_height = (0.3..=3.0).contains(&whose.height_m);
    check.require(is_height, "height_m", whose.height_m, " m", "from 0.3 to 3 m")?;
    check.require((3.0..=500.0).contains(&whose.mass_kg), "mass_kg", whose.mass_kg, " kg", "from 3 to 500 kg")?;
    let mut names: Vec<&String> = whose.upper_arm.iter().chain(&whose.forearm).chain(&whose.hand).collect();
    names.iter().try_for_each(|name| bodies.find(name, &check.element).map(drop))?;
    names.sort();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(ModelError::InTwoSegments { body: pair[0].clone() }),
        None => Ok(()),
    }
}

/// The bodies in depth-first order, and the index over their names (the world included).
fn bodies(description: &ModelDescription) -> Result<(Vec<Body>, Index<'_>), ModelError> {
    if description.bodies.iter().any(|body| body.name == "world") {
        return Err(ModelError::ReservedName);
    }
    let order = depth_first(&description.bodies)?;
    let names = order.iter().map(|&written| description.bodies[written].name.as_str());
    let index = Index::new(ElementKind::Body, std::iter::once("world").chain(names))?;
    let mut bodies = vec![world()];
    for &written in &order {
        bodies.push(body(&description.bodies[written], &index)?);
    }
    Ok((bodies, index))
}

/// Positions of the written bodies, parents before children and siblings in the order in which they are written.
fn depth_first(bodies: &[source::Body]) -> Result<Vec<usize>, ModelError> {
    let names = bodies.iter().map(|body| body.name.as_str());
    let index = Index::new(ElementKind::Body, std::iter::once("world").chain(names))?;
    let mut children = vec![Vec::new(); bodies.len() + 1];
    for (written, body) in bodies.iter().enumerate() {
        let parent = index.find(&body.parent, &Element::new(ElementKind::Body, &body.name))?;
        children[parent].push(written);
    }
    let mut order = Vec::with_capacity(bodies.len());
    let mut waiting: Vec<usize> = children[WORLD].iter().rev().copied().collect();
    while let Some(written) = waiting.pop() {
        order.push(written);
        waiting.extend(children[written + 1].iter().rev());
    }
    match (0..bodies.len()).find(|written| !order.contains(written)) {
        Some(lost) => Err(ModelError::BodyCycle { element: Element::new(ElementKind::Body, &bodies[lost].name) }),
        None => Ok(order),
    }
}

fn world() -> Body {
    Body {
        name: "world".to_owned(),
        parent: WORLD,
        pos: Vector3::zeros(),
        quat: UnitQuaternion::identity(),
        mass: 0.0,
        com: Vector3::zeros(),
        inertia: Matrix3::zeros(),
        principal_inertia: Vector3::zeros(),
        inertia_quat: UnitQuaternion::identity(),
    }
}

fn body(body: &source::Body, index: &Index) -> Result<Body, ModelError> {
    let check = Check::new(ElementKind::Body, &body.name);
    check.within("pos", &body.pos, &Bound::LENGTH)?;
    check.within("com", &body.com, &Bound::LENGTH)?;
    check.not_negative("mass", body.mass, " kg")?;
    check.within("mass", &[body.mass], &Bound::MASS)?;
    for moment in body.inertia {
        check.not_negative("inertia", moment, " kg m^2")?;
    }
    check.within("inertia", &body.inertia, &Bound::INERTIA)?;
    let total: f64 = body.inertia.iter().sum();
    if body.inertia.iter().any(|&moment| moment > (total - moment) * (1.0 + INERTIA_ROUNDING)) {
        return Err(ModelError::ImpossibleInertia { element: check.element, moments: body.inertia });
    }
    let inertia_quat = check.rotation("inertia_quat", body.inertia_quat)?;
    let principal_inertia = Vector3::from(body.inertia);
    let principal_axes = inertia_quat.to_rotation_matrix().into_inner();
    Ok(Body {
        parent: index.find(&body.parent, &check.element)?,
        name: body.name.clone(),
        pos: body.pos.into(),
        quat: check.rotation("quat", body.quat)?,
        mass: body.mass,
        com: body.com.into(),
        inertia: principal_axes * Matrix3::from_diagonal(&principal_inertia) * principal_axes.transpose(),
        principal_inertia,
        inertia_quat,
    })
}

fn joints(description: &ModelDescription, bodies: &Index) -> Result<Vec<Joint>, ModelError> {
    Index::new(ElementKind::Joint, description.joints.iter().map(|joint| joint.name.as_str()))?;
    let mut joints = Vec::with_capacity(description.joints.len());
    for written in &description.joints {
        joints.push(joint(written, bodies)?);
    }
    joints.sort_by_key(|joint: &Joint| joint.body);
    Ok(joints)
}

/// Free joints move bodies on the world and are their only joints; after a ball joint nothing turns the same body.
fn check_freedom(bodies: &[Body], joints: &[Joint]) -> Result<(), ModelError> {
    for (index, joint) in joints.iter().enumerate() {
        let element = Element::new(ElementKind::Joint, &joint.name);
        let parent = bodies[joint.body].parent;
        if joint.kind == JointKind::Free && parent != WORLD {
            return Err(ModelError::FreeBelow { element, parent: bodies[parent].name.clone() });
        }
        let before = joints[..index].iter().filter(|before| before.body == joint.body);
        let takes_all = |before: &&Joint| match before.kind {
            JointKind::Hinge | JointKind::Slide => joint.kind == JointKind::Free,
            JointKind::Ball => joint.kind != JointKind::Slide,
            JointKind::Free => true,
        };
        if let Some(before) = before.clone().find(takes_all) {
            let (first, kind) = (before.name.clone(), before.kind.name());
            return Err(ModelError::Superfluous { element, first, kind });
        }
    }
    Ok(())
}

fn joint(joint: &source::Joint, bodies: &Index) -> Result<Joint, ModelError> {
    let check = Check::new(ElementKind::Joint, &joint.name);
    let body = bodies.find(&joint.body, &check.element)?;
    if body == WORLD {
        return Err(ModelError::JointOnWorld { element: check.element });
    }
    check.within("pos", &joint.pos, &Bound::LENGTH)?;
    check.within("spring_ref", &[joint.spring_ref], &Bound::JOINT_POSITION)?;
    check.softness(&joint.softness)?;
    check.not_negative("stiffness", joint.stiffness, "")?;
    check.not_negative("damping", joint.damping, "")?;
    check.not_negative("armature", joint.armature, "")?;
    check.within("stiffness", &[joint.stiffness], &Bound::STIFFNESS)?;
    check.within("damping", &[joint.damping], &Bound::DAMPING)?;
    check.within("armature", &[joint.armature], &Bound::ARMATURE)?;
    if let Some(range) = joint.range {
        check.within("range", &range, &Bound::JOINT_POSITION)?;
        check.ascending("range", range, "")?;
    }
    if !joint.kind.is_scalar() {
        check_many(joint, &check.element)?;
    }
    Ok(Joint {
        name: joint.name.clone(),
        body,
        kind: joint.kind,
        axis: if joint.kind.is_scalar() { check.direction("axis", joint.axis)? } else { Vector3::zeros() },
        pos: joint.pos.into(),
        range: joint.range,
        stiffness: joint.stiffness,
        spring_ref: joint.spring_ref,
        damping: joint.damping,
        armature: joint.armature,
        softness: joint.softness,
    })
}

/// What joints have no use for that more than one number tells the position of.
fn check_many(joint: &source::Joint, element: &Element) -> Result<(), ModelError> {
    let has = [
        ("axis", joint.axis != [0.0; 3]),
        ("range", joint.range.is_some()),
        ("stiffness", joint.stiffness != 0.0),
        ("spring_ref", joint.spring_ref != 0.0),
        ("pos", joint.kind == JointKind::Free && joint.pos != [0.0; 3]),
    ];
    match has.into_iter().find(|(_, has)| *has) {
        Some((field, _)) => Err(ModelError::NotOfKind { element: element.clone(), kind: joint.kind.name(), field }),
        None => Ok(()),
    }
}

/// A body with joints needs mass and inertia, its own or those of bodies welded to it.
fn check_moving_mass(bodies: &[Body], joints: &[Joint]) -> Result<(), ModelError> {
    let mut jointed = vec![false; bodies.len()];
    joints.iter().for_each(|joint| jointed[joint.body] = true);
    let mut mass: Vec<f64> = bodies.iter().map(|body| body.mass).collect();
    let mut inertia: Vec<f64> = bodies.iter().map(|body| body.principal_inertia.min()).collect();
    for child in (1..bodies.len()).rev().filter(|&child| !jointed[child]) {
        mass[bodies[child].parent] += mass[child];
        inertia[bodies[child].parent] += inertia[child];
    }
    for moving in (1..bodies.len()).filter(|&body| jointed[body]) {
        let missing = |quantity| ModelError::Massless {
            element: Element::new(ElementKind::Body, &bodies[moving].name),
            quantity,
        };
        if mass[moving] < SMALLEST_MOVING {
            return Err(missing("mass"));
        }
        if inertia[moving] < SMALLEST_MOVING {
            return Err(missing("inertia"));
        }
    }
    Ok(())
}

fn couplings(description: &ModelDescription, joints: &[Joint]) -> Result<Vec<Coupling>, ModelError> {
    let index = Index::new(ElementKind::Joint, joints.iter().map(|joint| joint.name.as_str()))?;
    let mut couplings: Vec<Coupling> = Vec::with_capacity(description.couplings.len());
    for coupling in &description.couplings {
        let check = Check::new(ElementKind::Coupling, &coupling.dependent);
        check.within("polycoef", &coupling.polycoef, &Bound::COEFFICIENT)?;
        check.softness(&coupling.softness)?;
        let dependent = index.find(&coupling.dependent, &check.element)?;
        if couplings.iter().any(|other| other.dependent == dependent) {
            return Err(ModelError::CoupledTwice { element: Element::new(ElementKind::Joint, &coupling.dependent) });
        }
        let independent =
            coupling.independent.as_deref().map(|leader| index.find(leader, &check.element)).transpose()?;
        couplings.push(Coupling { dependent, independent, polycoef: coupling.polycoef, softness: coupling.softness });
    }
    check_scalar(&couplings, joints)?;
    check_chains(&couplings, joints)?;
    Ok(couplings)
}

fn check_scalar(couplings: &[Coupling], joints: &[Joint]) -> Result<(), ModelError> {
    for coupling in couplings {
        let coupled = [Some(coupling.dependent), coupling.independent].into_iter().flatten();
        if let Some(joint) = coupled.map(|joint| &joints[joint]).find(|joint| !joint.kind.is_scalar()) {
            return Err(ModelError::CouplesMany {
                element: Element::new(ElementKind::Coupling, &joints[coupling.dependent].name),
                joint: joint.name.clone(),
                kind: joint.kind.name(),
            });
        }
    }
    Ok(())
}

fn check_chains(couplings: &[Coupling], joints: &[Joint]) -> Result<(), ModelError> {
    for coupling in couplings {
        let Some(leader) = coupling.independent else { continue };
        if couplings.iter().any(|other| other.dependent == leader) {
            return Err(ModelError::CouplingChain {
                element: Element::new(ElementKind::Joint, &joints[coupling.dependent].name),
                leader: joints[leader].name.clone(),
            });
        }
    }
    Ok(())
}

fn sites(description: &ModelDescription, bodies: &Index) -> Result<Vec<Site>, ModelError> {
    let mut sites = Vec::with_capacity(description.sites.len());
    for site in &description.sites {
        let check = Check::new(ElementKind::Site, &site.name);
        check.within("pos", &site.pos, &Bound::LENGTH)?;
        let body = bodies.find(&site.body, &check.element)?;
        if let Some(form) = &site.shape {
            shape(&check, form, description.hulls.len())?;
        }
        let (pos, quat) = (site.pos.into(), check.rotation("quat", site.quat)?);
        sites.push(Site { name: site.name.clone(), body, pos, quat, shape: site.shape });
    }
    sites.sort_by_key(|site: &Site| site.body);
    Ok(sites)
}

fn geoms(description: &ModelDescription, bodies: &Index) -> Result<Vec<Geom>, ModelError> {
    Index::new(ElementKind::Geom, description.geoms.iter().map(|geom| geom.name.as_str()))?;
    let mut geoms = Vec::with_capacity(description.geoms.len());
    for written in &description.geoms {
        geoms.push(geom(written, bodies, description.hulls.len())?);
    }
    geoms.sort_by_key(|geom: &Geom| geom.body);
    Ok(geoms)
}

fn geom(geom: &source::Geom, bodies: &Index, hulls: usize) -> Result<Geom, ModelError> {
    let check = Check::new(ElementKind::Geom, &geom.name);
    check.within("pos", &geom.pos, &Bound::LENGTH)?;
    check.softness(&geom.softness)?;
    check.not_negative("margin", geom.margin, " m")?;
    check.within("margin", &[geom.margin], &Bound::LENGTH)?;
    for coefficient in geom.friction {
        check.not_negative("friction", coefficient, "")?;
        check.within("friction", &[coefficient], &Bound::RATIO)?;
    }
    shape(&check, &geom.shape, hulls)?;
    Ok(Geom {
        name: geom.name.clone(),
        body: bodies.find(&geom.body, &check.element)?,
        shape: geom.shape,
        pos: geom.pos.into(),
        quat: check.rotation("quat", geom.quat)?,
        margin: geom.margin,
        friction: geom.friction,
        softness: geom.softness,
    })
}

/// Sizes of a shape, of which there are so many hulls.
fn shape(check: &Check, shape: &Shape, hulls: usize) -> Result<(), ModelError> {
    match *shape {
        Shape::Sphere { radius } => {
            check.above("radius", radius, 0.0, " m", "above 0 m")?;
            check.within("radius", &[radius], &Bound::LENGTH)?;
        }
        Shape::Plane => {}
        Shape::Capsule { radius, half_length } | Shape::Cylinder { radius, half_length } => {
            for (field, size) in [("radius", radius), ("half_length", half_length)] {
                check.above(field, size, 0.0, " m", "above 0 m")?;
                check.within(field, &[size], &Bound::LENGTH)?;
            }
        }
        Shape::Ellipsoid { radii } => {
            for radius in radii {
                check.at_least("radii", radius, SMALLEST_RADIUS, " m", "at least 0.0001 m")?;
                check.within("radii", &[radius], &Bound::LENGTH)?;
            }
        }
        Shape::Box { half_size } => {
            for size in half_size {
                check.above("half_size", size, 0.0, " m", "above 0 m")?;
                check.within("half_size", &[size], &Bound::LENGTH)?;
            }
        }
        Shape::Mesh { hull, .. } if hull >= hulls => {
            return Err(ModelError::NoHull { element: check.element.clone(), hull, count: hulls });
        }
        Shape::Mesh { scale, .. } => {
            check.at_least("scale", scale, SMALLEST_SCALE, "", "at least 0.001")?;
            check.within("scale", &[scale], &Bound::RATIO)?;
        }
    }
    Ok(())
}

fn contacts(description: &ModelDescription, geoms: &[Geom]) -> Result<Vec<Contact>, ModelError> {
    let index = Index::new(ElementKind::Geom, geoms.iter().map(|geom| geom.name.as_str()))?;
    let mut contacts: Vec<Contact> = Vec::with_capacity(description.contacts.len());
    for contact in &description.contacts {
        let [one, other] = &contact.geoms;
        let check = Check::new(ElementKind::Contact, &format!("{one}, {other}"));
        check.not_negative("margin", contact.margin, " m")?;
        check.within("margin", &[contact.margin], &Bound::LENGTH)?;
        let friction = friction(contact, &check)?;
        check.softness(&contact.softness)?;
        let mut found = [index.find(one, &check.element)?, index.find(other, &check.element)?];
        found.sort_unstable();
        if found[0] == found[1] {
            return Err(ModelError::TouchesItself { geom: one.clone() });
        }
        if contacts.iter().any(|other| other.geoms == found) {
            return Err(ModelError::DuplicateName { element: check.element });
        }
        let &source::Contact { margin, softness, .. } = contact;
        contacts.push(Contact { geoms: found, margin, friction, softness });
    }
    Ok(contacts)
}

/// What resists in each direction: each no less than MuJoCo's least, or none together with all that come after it.
fn friction(contact: &source::Contact, check: &Check) -> Result<[f64; 5], ModelError> {
    let &source::Contact { friction, friction_across, torsional, rolling: [first, second], .. } = contact;
    let all = [
        ("friction", friction, "at least 0.00001, or 0 for none"),
        ("friction_across", friction_across.unwrap_or(friction), "at least 0.00001, and there only with `friction`"),
        ("torsional", torsional, "at least 0.00001 m, and there only with `friction`"),
        ("rolling", first, "at least 0.00001 m, and there only with `torsional`"),
        ("rolling", second, "at least 0.00001 m in both directions, or 0 in both"),
    ];
    // Of both directions in a plane there is friction in both.
    let (mut may_resist, mut resists) = (true, [false; 5]);
    for (k, (field, coefficient, expected)) in all.into_iter().enumerate() {
        resists[k] = coefficient >= SMALLEST_FRICTION;
        let is_second = k == 1 || k == 4;
        let fits = if is_second { resists[k] == resists[k - 1] } else { may_resist || !resists[k] };
        check.require(fits && (resists[k] || coefficient == 0.0), field, coefficient, "", expected)?;
        check.within(field, &[coefficient], &Bound::RATIO)?;
        may_resist = resists[k];
    }
    Ok(all.map(|(_, coefficient, _)| coefficient))
}

fn wraps(description: &ModelDescription, bodies: &Index) -> Result<Vec<Wrap>, ModelError> {
    // In MuJoCo both are geoms.
    let geoms = description.geoms.iter().map(|geom| geom.name.as_str());
    Index::new(ElementKind::Wrap, geoms.chain(description.wraps.iter().map(|wrap| wrap.name.as_str())))?;
    let mut wraps = Vec::with_capacity(description.wraps.len());
    for written in &description.wraps {
        wraps.push(wrap(written, bodies)?);
    }
    wraps.sort_by_key(|wrap: &Wrap| wrap.body);
    Ok(wraps)
}

fn wrap(wrap: &source::Wrap, bodies: &Index) -> Result<Wrap, ModelError> {
    let check = Check::new(ElementKind::Wrap, &wrap.name);
    check.within("pos", &wrap.pos, &Bound::LENGTH)?;
    let radius = wrap.shape.radius();
    check.at_least("radius", radius, SMALLEST_WRAP, " m", "at least 0.00001 m")?;
    check.within("radius", &[radius], &Bound::LENGTH)?;
    if let source::WrapShape::Cylinder { half_length, .. } = wrap.shape {
        check.above("half_length", half_length, 0.0, " m", "above 0 m")?;
        check.within("half_length", &[half_length], &Bound::LENGTH)?;
    }
    Ok(Wrap {
        name: wrap.name.clone(),
        body: bodies.find(&wrap.body, &check.element)?,
        shape: wrap.shape,
        pos: wrap.pos.into(),
        quat: check.rotation("quat", wrap.quat)?,
    })
}

fn muscles(description: &ModelDescription, sites: &Index, wraps: &Index) -> Result<Vec<Muscle>, ModelError> {
    Index::new(ElementKind::Muscle, description.muscles.iter().map(|muscle| muscle.name.as_str()))?;
    let mut muscles = Vec::with_capacity(description.muscles.len());
    for muscle in &description.muscles {
        let check = Check::new(ElementKind::Muscle, &muscle.name);
        let path = path(muscle, sites, wraps, &check.element)?;
        check.muscle(&muscle.parameters, description.options.timestep)?;
        if let Some(limit) = &muscle.limit {
            check.tendon_limit(limit)?;
        }
        muscles.push(path);
    }
    Ok(muscles)
}

/// The muscle with its path, whose elements must make sense beside each other.
fn path(muscle: &source::Muscle, sites: &Index, wraps: &Index, element: &Element) -> Result<Muscle, ModelError> {
    let mut path = Path::default();
    for step in &muscle.path {
        match step {
            PathElement::Site(site) => path.through(sites.find(site, element)?),
            PathElement::Over(written) => {
                let side = written.side.as_deref().map(|site| sites.find(site, element)).transpose()?;
                path.over(written, wraps.find(&written.over, element)?, side, element)?;
            }
            PathElement::Pulley(pulley) => {
                let is_divisor = DIVISORS.contains(&pulley.pulley);
                let check = Check { element: element.clone() };
                check.require(is_divisor, "pulley", pulley.pulley, "", "a divisor from 0.1 to 100")?;
                path.divides(pulley.pulley, element)?;
            }
        }
    }
    path.ends(element)?;
    let Path { sites, over, pulleys, .. } = path;
    let source::Muscle { name, limit, parameters, .. } = muscle;
    Ok(Muscle { name: name.clone(), path: sites, over, pulleys, limit: *limit, parameters: parameters.clone() })
}

/// A path as far as it was read.
#[derive(Default)]
struct Path<'a> {
    sites: Vec<usize>,
    over: Vec<Over>,
    pulleys: Vec<Pulley>,
    /// What it runs over since its last site.
    last: Option<&'a source::Over>,
}

impl<'a> Path<'a> {
    fn through(&mut self, site: usize) {
        self.sites.push(site);
        self.last = None;
    }

    fn over(
        &mut self,
        written: &'a source::Over,
        wrap: usize,
        side: Option<usize>,
        element: &Element,
    ) -> Result<(), ModelError> {
        if let Some(first) = self.last {
            return Err(ModelError::WrapsInRow {
                element: element.clone(),
                first: first.over.clone(),
                second: written.over.clone(),
            });
        }
        if self.of_branch() == 0 {
            return Err(loose(element, &written.over, "begins with"));
        }
        self.over.push(Over { after: self.sites.len() - 1, wrap, side });
        self.last = Some(written);
        Ok(())
    }

    /// A branch ends, and another begins; a path may begin with one.
    fn divides(&mut self, divisor: f64, element: &Element) -> Result<(), ModelError> {
        if !(self.sites.is_empty() && self.pulleys.is_empty()) {
            self.ends(element)?;
        }
        self.pulleys.push(Pulley { before: self.sites.len(), divisor });
        Ok(())
    }

    fn ends(&self, element: &Element) -> Result<(), ModelError> {
        match (self.last, self.of_branch()) {
            (Some(last), _) => Err(loose(element, &last.over, "ends with")),
            (None, count) if count < 2 => {
                let branch = if self.pulleys.is_empty() { "its path" } else { "a branch of its path" };
                Err(ModelError::ShortPath { element: element.clone(), branch, sites: count })
            }
            _ => Ok(()),
        }
    }

    /// Sites of the current branch.
    fn of_branch(&self) -> usize {
        self.sites.len() - self.pulleys.last().map_or(0, |pulley| pulley.before)
    }
}

fn loose(element: &Element, wrap: &str, place: &'static str) -> ModelError {
    ModelError::LooseWrap { element: element.clone(), wrap: wrap.to_owned(), place }
}
