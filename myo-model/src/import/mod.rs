//! MJCF in: what is read of MuJoCo's files becomes a description, or is refused by name.
//!
//! What this crate cannot simulate as MuJoCo does is never left out: all of it is listed, with its place. What has no part in
//! the simulation (cameras, lights, materials, stored states, some sensors) is counted, see [`unused`]; what is seen of bodies comes with [`looks()`].

mod apart;
mod connections;
mod contacts;
mod hull;
mod joints;
mod lock;
mod looks;
mod mass;
mod meshes;
mod muscles;
mod ranges;
mod sensors;
mod settings;

use crate::ModelDescription;
use crate::compile::FORMAT_VERSION;
use crate::description::{Body, Geom, Hull, Landmarks, Shape, SideRule, Site, Softness};
use myo_mjcf::{Folder, Mjcf, Place};
use nalgebra::UnitQuaternion;
use std::collections::HashSet;
use std::fmt;

pub use looks::looks;

/// What MJCF does not say, or what is to be left out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportOptions {
    /// Elements that tasks refer to.
    pub landmarks: Landmarks,
    /// Whether parts of the body pass through each other, whatever the file says.
    pub without_contacts: bool,
    /// How side sites tell ways around wraps: what MJCF does not say, and versions of MuJoCo do in two ways.
    pub side_rule: SideRule,
    /// Joints that stand still as in the pose of the file, with those that follow them.
    pub locked: Vec<String>,
}

impl ImportOptions {
    /// With all that the file says, as MuJoCo 4.0 understands it.
    pub fn new(landmarks: Landmarks) -> Self {
        Self { landmarks, without_contacts: false, side_rule: SideRule::default(), locked: vec![] }
    }
}

/// Something in a file that cannot be simulated as MuJoCo does.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsupported {
    /// Where it stands.
    pub place: Place,
    /// The element, as `<joint name="knee">`.
    pub element: String,
    /// What is not simulated, and what would be right.
    pub what: String,
}

impl fmt::Display for Unsupported {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}: {}", self.place, self.element, self.what)
    }
}

/// The description of an MJCF model.
///
/// Elements without a name get one: `joint3` is the third joint. Bodies, joints and so on keep the order of MuJoCo's indices.
///
/// # Errors
/// Everything in it that cannot be simulated as MuJoCo does.
pub fn from_mjcf(mjcf: &Mjcf, options: &ImportOptions) -> Result<ModelDescription, Vec<Unsupported>> {
    described(mjcf, options, None)
}

/// The same, with contacts of meshes, whose files are below a folder.
///
/// # Errors
/// Everything in it that cannot be simulated as MuJoCo does.
pub fn from_mjcf_in(
    mjcf: &Mjcf,
    options: &ImportOptions,
    folder: &Folder,
) -> Result<ModelDescription, Vec<Unsupported>> {
    described(mjcf, options, Some(folder))
}

fn described(
    mjcf: &Mjcf,
    options: &ImportOptions,
    folder: Option<&Folder>,
) -> Result<ModelDescription, Vec<Unsupported>> {
    let mjcf = &*lock::locked(mjcf, &options.locked)?;
    let mut import = Import {
        mjcf,
        names: Names::of(mjcf),
        run_over: muscles::run_over(mjcf),
        side_rule: options.side_rule,
        folder,
        hulls: vec![],
        unsupported: vec![],
    };
    let refused = |one: &myo_mjcf::Refused| Unsupported {
        place: one.place.clone(),
        element: format!("<{}>", one.element),
        what: one.why.clone(),
    };
    import.unsupported.extend(mjcf.refused.iter().map(refused));
    let (mut geoms, contacts) = if options.without_contacts { (vec![], vec![]) } else { import.contacts() };
    let landmarks = options.landmarks.clone();
    for site in [&landmarks.fingertip].into_iter().chain(landmarks.fingers.values()) {
        geoms.extend(import.fingertip(site, &geoms));
    }
    let mut description = ModelDescription {
        version: FORMAT_VERSION,
        name: mjcf.model.clone().unwrap_or_else(|| "model".into()),
        source: mjcf.bodies.first().map_or_else(String::new, |world| world.place.file.to_string()),
        options: import.settings(),
        anthropometry: None,
        changes: String::new(),
        bodies: import.bodies(),
        joints: import.joints(),
        couplings: import.couplings(),
        connections: import.connections(),
        sites: import.sites(),
        geoms,
        contacts,
        wraps: import.wraps(),
        muscles: import.muscles(),
        hulls: std::mem::take(&mut import.hulls),
        sensors: vec![],
        looks: vec![],
        landmarks,
    };
    import.add_sensors(&mut description);
    if import.unsupported.is_empty() { Ok(description) } else { Err(import.unsupported) }
}

/// Kinds of elements of a file that its description leaves out, as they have no part in the simulation, and how many there are of each.
pub fn unused(mjcf: &Mjcf, description: &ModelDescription) -> Vec<(String, usize)> {
    let all = [
        ("cameras", mjcf.cameras().count()),
        ("lights", mjcf.lights().count()),
        ("textures", mjcf.textures.len()),
        ("materials", mjcf.materials.len()),
        ("stored states", mjcf.keys.len()),
    ];
    let all = all.into_iter().filter(|(_, count)| *count > 0).map(|(kind, count)| (kind.to_owned(), count));
    all.chain(sensors::passed_over(mjcf, &Names::of(mjcf).sensors, description)).collect()
}

/// Names of all elements in MuJoCo's order, those of the nameless included.
struct Names {
    bodies: Vec<String>,
    joints: Vec<String>,
    sites: Vec<String>,
    geoms: Vec<String>,
    sensors: Vec<String>,
}

impl Names {
    fn of(mjcf: &Mjcf) -> Self {
        let named = |kind: &str, names: Vec<Option<&String>>| {
            let name = |(number, name): (usize, &Option<&String>)| match name {
                Some(name) => (*name).clone(),
                None => free(&format!("{kind}{}", number + 1), &names),
            };
            names.iter().enumerate().map(name).collect()
        };
        Self {
            bodies: named("body", mjcf.bodies.iter().map(|body| body.name.as_ref()).collect()),
            joints: named("joint", mjcf.joints().map(|(_, joint)| joint.name.as_ref()).collect()),
            geoms: named("geom", mjcf.geoms().map(|(_, geom)| geom.name.as_ref()).collect()),
            sensors: named("sensor", mjcf.sensors.iter().map(|sensor| sensor.name.as_ref()).collect()),
            sites: named("site", mjcf.sites().map(|(_, site)| site.name.as_ref()).collect()),
        }
    }
}

/// An orientation as descriptions have it.
fn written(turn: &UnitQuaternion<f64>) -> [f64; 4] {
    [turn.w, turn.i, turn.j, turn.k]
}

/// A name that none of these has.
fn free(name: &str, taken: &[Option<&String>]) -> String {
    if taken.contains(&Some(&name.to_owned())) { free(&format!("{name}_"), taken) } else { name.to_owned() }
}

/// A model on its way in.
struct Import<'a> {
    mjcf: &'a Mjcf,
    names: Names,
    /// Names of geoms that tendons run over.
    run_over: HashSet<&'a str>,
    side_rule: SideRule,
    /// Where meshes are read from.
    folder: Option<&'a Folder>,
    /// Convex meshes that geoms touch with.
    hulls: Vec<Hull>,
    unsupported: Vec<Unsupported>,
}

impl Import<'_> {
    fn refuse(&mut self, place: &Place, (tag, name): (&str, Option<&String>), what: impl Into<String>) {
        let element = name.map_or_else(|| format!("<{tag}>"), |name| format!("<{tag} name=\"{name}\">"));
        self.unsupported.push(Unsupported { place: place.clone(), element, what: what.into() });
    }

    /// Refuses those of some things that are not as they must be.
    fn refuse_all(&mut self, place: &Place, element: (&str, Option<&String>), faults: &[(bool, &str)]) {
        for (_, what) in faults.iter().filter(|(is_fault, _)| *is_fault) {
            self.refuse(place, element, *what);
        }
    }

    fn bodies(&mut self) -> Vec<Body> {
        let mjcf = self.mjcf;
        let moving = self.moving();
        let mut all = vec![];
        for (number, body) in mjcf.bodies.iter().enumerate().skip(1) {
            let element = ("body", body.name.as_ref());
            self.refuse_all(
                &body.place,
                element,
                &[
                    (body.mocap(), "a body that a user moves (`mocap`) is not simulated"),
                    (body.gravcomp() != 0.0, "compensated weight (`gravcomp`) is not simulated; leave it out"),
                ],
            );
            let mass = self.mass(number, moving[number]);
            all.push(Body {
                name: self.names.bodies[number].clone(),
                parent: self.names.bodies[body.parent].clone(),
                pos: body.pose.pos(),
                quat: body.pose.quat(),
                mass: mass.mass,
                com: mass.com,
                inertia: mass.inertia,
                inertia_quat: mass.quat,
            });
        }
        all
    }

    /// Of each body, whether anything moves it.
    fn moving(&self) -> Vec<bool> {
        let mut moving = vec![false; self.mjcf.bodies.len()];
        for (number, body) in self.mjcf.bodies.iter().enumerate() {
            moving[number] = !body.joints.is_empty() || moving[body.parent];
        }
        moving
    }

    fn sites(&self) -> Vec<Site> {
        let site = |((body, site), name): ((usize, &myo_mjcf::Site), &String)| Site {
            name: name.clone(),
            body: self.names.bodies[body].clone(),
            pos: site.pose.pos(),
            quat: [1.0, 0.0, 0.0, 0.0],
            shape: None,
        };
        self.mjcf.sites().zip(&self.names.sites).map(site).collect()
    }

    /// The ball about the site of a fingertip, if there is one: it is what presses. One that touches parts of the body, too, is
    /// there twice, as a geom of a contact presses nothing.
    fn fingertip(&self, site: &str, touching: &[Geom]) -> Option<Geom> {
        let site = self.names.sites.iter().position(|name| name == site)?;
        let (body, site) = self.mjcf.sites().nth(site)?;
        let is_it = |geom: &&myo_mjcf::Geom| {
            geom.kind() == myo_mjcf::Shape::Sphere
                && geom.pose.pos() == site.pose.pos()
                && (geom.contype() != 0 || geom.conaffinity() != 0)
        };
        let geom = self.mjcf.bodies[body].geoms.iter().find(is_it)?;
        let taken: Vec<Option<&String>> = touching.iter().map(|geom| Some(&geom.name)).collect();
        let name = free(geom.name.as_deref().unwrap_or("fingertip"), &taken);
        Some(Geom {
            name,
            body: self.names.bodies[body].clone(),
            shape: Shape::Sphere { radius: geom.size()[0] },
            pos: geom.pose.pos(),
            quat: geom.pose.quat(),
            margin: geom.margin(),
            friction: geom.friction(),
            softness: Softness { solref: geom.solref(), solimp: geom.solimp() },
        })
    }
}
