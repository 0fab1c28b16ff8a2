//! MJCF out: a file from which MuJoCo (3.17 and 4.0 are tested) builds the very same model.
//!
//! Everything that influences the simulation is written out, defaults included, so that a MuJoCo with other defaults loads
//! the same. Numbers are printed so that they read back bit for bit. What MuJoCo derives (inverse weights, automatic muscle
//! force) is left to MuJoCo.

mod sensors;

use crate::description::{Cone, Integrator, Shape, SideRule, Softness, WrapShape};
use crate::model::{Body, Connection, Geom, Joint, Model, Muscle, Site, WORLD, Weld, Wrap};
use myo_muscle::CurveParameters;
use nalgebra::{UnitQuaternion, Vector3};
use std::fmt::Write;

/// How far (m) the volume of a button's touch sensor reaches beyond the box and its margin; contacts lie within the margin.
const SENSOR_MARGIN: f64 = 0.001;

/// MuJoCo's friction of geoms that say nothing.
const FRICTION: [f64; 5] = [1.0, 1.0, 0.005, 0.0001, 0.0001];

/// What [`to_mjcf`] adds to the model.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfOptions {
    /// Boxes that stand still in the world and feel touch. MuJoCo presses them with the model's cone of friction, Myo always with pyramids.
    pub buttons: Vec<Button>,
    /// Relative improvement at which MuJoCo's solver stops; 0 iterates until nothing improves any more.
    pub tolerance: f64,
    /// Most iterations of MuJoCo's solver in one step.
    pub iterations: u32,
}

impl Default for MjcfOptions {
    fn default() -> Self {
        Self { buttons: Vec::new(), tolerance: 1e-10, iterations: 100 }
    }
}

/// A box that stands still in the world; the sensor of the same name sums the normal forces on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Button {
    /// Name of body, geom, site and sensor.
    pub name: String,
    /// Centre in the world (m).
    pub pos: Vector3<f64>,
    /// Orientation in the world.
    pub quat: UnitQuaternion<f64>,
    /// Half sizes along its axes (m).
    pub half_size: [f64; 3],
    /// Contact margin (m).
    pub margin: f64,
    /// Sliding, torsional, rolling friction.
    pub friction: [f64; 3],
    /// Softness of contacts.
    pub softness: Softness,
}

/// The model as the text of an MJCF file.
///
/// Bodies, joints, sites, geoms, tendons and actuators get the order that they have in `model`. Geoms of contacts touch each
/// other as these say, all others touch buttons alone.
pub fn to_mjcf(model: &Model, options: &MjcfOptions) -> String {
    let mut xml = Xml::default();
    xml.open("mujoco", &[("model", text(&model.name))]);
    settings(&mut xml, model, options);
    rule_of_sides(&mut xml, model.options.side_rule);
    meshes(&mut xml, model);
    xml.open("worldbody", &[]);
    points_and_shapes(&mut xml, model, WORLD);
    bodies_below(&mut xml, model, WORLD);
    options.buttons.iter().for_each(|button| button_body(&mut xml, button));
    xml.close("worldbody");
    contacts(&mut xml, model);
    tendons(&mut xml, model);
    couplings(&mut xml, model);
    connections(&mut xml, model);
    actuators(&mut xml, model);
    sensors(&mut xml, model, &options.buttons);
    xml.close("mujoco");
    xml.text
}

fn settings(xml: &mut Xml, model: &Model, options: &MjcfOptions) {
    xml.leaf(
        "compiler",
        &[
            ("angle", text("radian")),
            ("autolimits", text("true")),
            ("inertiafromgeom", text("false")),
            ("balanceinertia", text("false")),
            ("boundmass", number(0.0)),
            ("boundinertia", number(0.0)),
            ("settotalmass", number(-1.0)),
            ("fusestatic", text("false")),
        ],
    );
    let integrator = match model.options.integrator {
        Integrator::Euler => "Euler",
        Integrator::ImplicitFast => "implicitfast",
        Integrator::Implicit => "implicit",
    };
    let cone = match model.options.cone {
        Cone::Pyramidal => "pyramidal",
        Cone::Elliptic => "elliptic",
    };
    xml.open(
        "option",
        &[
            ("timestep", number(model.options.timestep)),
            ("gravity", numbers(&model.options.gravity)),
            ("integrator", text(integrator)),
            ("cone", text(cone)),
            ("impratio", number(model.options.impratio)),
            ("solver", text("Newton")),
            ("jacobian", text("dense")),
            ("tolerance", number(options.tolerance)),
            ("iterations", text(&options.iterations.to_string())),
        ],
    );
    let eulerdamp = if model.options.implicit_joint_damping { "enable" } else { "disable" };
    xml.leaf("flag", &[("eulerdamp", text(eulerdamp))]);
    xml.close("option");
}

/// A file cannot choose the rule by which it is understood; it says which one it was made for.
fn rule_of_sides(xml: &mut Xml, rule: SideRule) {
    if rule == SideRule::Mujoco3 {
        xml.open("custom", &[]);
        xml.leaf("text", &[("name", text("side_rule")), ("data", text("as in MuJoCo before 4.0"))]);
        xml.close("custom");
    }
}

fn bodies_below(xml: &mut Xml, model: &Model, parent: usize) {
    for (index, body) in model.bodies.iter().enumerate().skip(1).filter(|(_, body)| body.parent == parent) {
        open_body(xml, body);
        for joint in model.joints.iter().filter(|joint| joint.body == index) {
            xml.leaf("joint", &joint_attributes(joint));
        }
        points_and_shapes(xml, model, index);
        bodies_below(xml, model, index);
        xml.close("body");
    }
}

fn open_body(xml: &mut Xml, body: &Body) {
    let place = [("name", text(&body.name)), ("pos", numbers(body.pos.as_slice())), ("quat", rotation(&body.quat))];
    xml.open("body", &place);
    // MuJoCo takes no inertial element without mass; a body that has none gets none.
    if body.mass > 0.0 || body.principal_inertia.max() > 0.0 {
        xml.leaf(
            "inertial",
            &[
                ("pos", numbers(body.com.as_slice())),
                ("quat", rotation(&body.inertia_quat)),
                ("mass", number(body.mass)),
                ("diaginertia", numbers(body.principal_inertia.as_slice())),
            ],
        );
    }
}

fn joint_attributes(joint: &Joint) -> Vec<Attribute> {
    if !joint.kind.is_scalar() {
        return ball_or_free(joint);
    }
    let mut attributes = vec![
        ("name", text(&joint.name)),
        ("type", text(joint.kind.name())),
        ("axis", numbers(joint.axis.as_slice())),
        ("pos", numbers(joint.pos.as_slice())),
        ("limited", text(if joint.range.is_some() { "true" } else { "false" })),
        ("stiffness", number(joint.stiffness)),
        ("springref", number(joint.spring_ref)),
        ("damping", number(joint.damping)),
        ("armature", number(joint.armature)),
        ("margin", number(0.0)),
        ("solreflimit", numbers(&joint.softness.solref)),
        ("solimplimit", numbers(&joint.softness.solimp)),
    ];
    attributes.extend(joint.range.map(|range| ("range", numbers(&range))));
    attributes
}

/// A joint without axis, limit and spring.
fn ball_or_free(joint: &Joint) -> Vec<Attribute> {
    vec![
        ("name", text(&joint.name)),
        ("type", text(joint.kind.name())),
        ("pos", numbers(joint.pos.as_slice())),
        ("limited", text("false")),
        ("stiffness", number(0.0)),
        ("damping", number(joint.damping)),
        ("armature", number(joint.armature)),
    ]
}

/// Each geom with a convex mesh has its own, of its name.
fn meshes(xml: &mut Xml, model: &Model) {
    let mut is_open = false;
    for geom in &model.geoms {
        let Shape::Mesh { hull, scale } = geom.shape else { continue };
        if !is_open {
            xml.open("asset", &[]);
            is_open = true;
        }
        let hull = &model.hulls[hull];
        let points: Vec<f64> = hull.points.iter().flatten().map(|x| x * scale).collect();
        let faces: Vec<String> = hull.triangles.iter().flatten().map(usize::to_string).collect();
        xml.leaf("mesh", &[("name", text(&geom.name)), ("vertex", numbers(&points)), ("face", faces.join(" "))]);
    }
    if is_open {
        xml.close("asset");
    }
}

fn points_and_shapes(xml: &mut Xml, model: &Model, body: usize) {
    for site in model.sites.iter().filter(|site| site.body == body) {
        xml.leaf("site", &site_attributes(site));
    }
    for (number, connection) in pins(model) {
        for end in (0..2).filter(|&end| connection.bodies[end] == body) {
            let pos = numbers(connection.anchors[end].as_slice());
            xml.leaf("site", &[("name", text(&pin(model, number, end))), ("pos", pos)]);
        }
    }
    for (index, geom) in model.geoms.iter().enumerate().filter(|(_, geom)| geom.body == body) {
        let presses = !model.contacts.iter().any(|contact| contact.geoms.contains(&index));
        xml.leaf("geom", &geom_attributes(geom, presses));
    }
    for wrap in model.wraps.iter().filter(|wrap| wrap.body == body) {
        xml.leaf("geom", &wrap_attributes(wrap));
    }
}

/// What muscles run over is a geom that touches nothing.
fn wrap_attributes(wrap: &Wrap) -> Vec<Attribute> {
    let (kind, size) = match wrap.shape {
        WrapShape::Sphere { radius } => ("sphere", vec![radius]),
        WrapShape::Cylinder { radius, half_length } => ("cylinder", vec![radius, half_length]),
    };
    vec![
        ("name", text(&wrap.name)),
        ("type", text(kind)),
        ("size", numbers(&size)),
        ("pos", numbers(wrap.pos.as_slice())),
        ("quat", rotation(&wrap.quat)),
        ("contype", text("0")),
        ("conaffinity", text("0")),
    ]
}

fn site_attributes(site: &Site) -> Vec<Attribute> {
    let (kind, size) = site.shape.map_or_else(|| ("sphere", vec![0.001]), named);
    let mut attributes =
        vec![("name", text(&site.name)), ("pos", numbers(site.pos.as_slice())), ("size", numbers(&size))];
    if site.shape.is_some() {
        attributes.push(("type", text(kind)));
    }
    if site.quat != UnitQuaternion::identity() {
        attributes.push(("quat", rotation(&site.quat)));
    }
    attributes
}

/// MuJoCo's name of a shape, and its sizes.
fn named(shape: Shape) -> (&'static str, Vec<f64>) {
    match shape {
        Shape::Sphere { radius } => ("sphere", vec![radius]),
        Shape::Capsule { radius, half_length } => ("capsule", vec![radius, half_length]),
        Shape::Ellipsoid { radii } => ("ellipsoid", radii.to_vec()),
        Shape::Cylinder { radius, half_length } => ("cylinder", vec![radius, half_length]),
        // How far pictures show it.
        Shape::Plane => ("plane", vec![1.0, 1.0, 0.1]),
        Shape::Box { half_size } => ("box", half_size.to_vec()),
        Shape::Mesh { .. } => ("mesh", vec![]),
    }
}

/// Geoms of contacts touch what those say, the others (which press) buttons.
fn geom_attributes(geom: &Geom, presses: bool) -> Vec<Attribute> {
    let (kind, size) = named(geom.shape);
    let mut attributes = vec![
        ("name", text(&geom.name)),
        ("type", text(kind)),
        if size.is_empty() { ("mesh", text(&geom.name)) } else { ("size", numbers(&size)) },
        ("pos", numbers(geom.pos.as_slice())),
        ("quat", rotation(&geom.quat)),
        ("contype", text(if presses { "1" } else { "0" })),
        ("conaffinity", text("0")),
    ];
    attributes.extend(contact(geom.margin, &geom.friction, &geom.softness));
    attributes
}

fn button_body(xml: &mut Xml, button: &Button) {
    let place =
        [("name", text(&button.name)), ("pos", numbers(button.pos.as_slice())), ("quat", rotation(&button.quat))];
    xml.open("body", &place);
    let mut geom = vec![
        ("name", text(&button.name)),
        ("type", text("box")),
        ("size", numbers(&button.half_size)),
        ("contype", text("1")),
        ("conaffinity", text("1")),
    ];
    geom.extend(contact(button.margin, &button.friction, &button.softness));
    xml.leaf("geom", &geom);
    let reach = button.half_size.map(|half| half + button.margin + SENSOR_MARGIN);
    xml.leaf("site", &[("name", text(&button.name)), ("type", text("box")), ("size", numbers(&reach))]);
    xml.close("body");
}

fn contact(margin: f64, friction: &[f64; 3], softness: &Softness) -> Vec<Attribute> {
    vec![
        ("condim", text("3")),
        ("margin", number(margin)),
        ("gap", number(0.0)),
        ("friction", numbers(friction)),
        ("solmix", number(1.0)),
        ("solref", numbers(&softness.solref)),
        ("solimp", numbers(&softness.solimp)),
    ]
}

fn contacts(xml: &mut Xml, model: &Model) {
    xml.section("contact", &model.contacts, |xml, contact| {
        let [one, other] = contact.geoms.map(|geom| text(&model.geoms[geom].name));
        let condim = contact.condim();
        // What does not count is as MuJoCo has it.
        let ours = contact.friction.into_iter().take(condim - 1);
        let friction: Vec<f64> = ours.chain(FRICTION.into_iter().skip(condim - 1)).collect();
        xml.leaf(
            "pair",
            &[
                ("geom1", one),
                ("geom2", other),
                ("condim", condim.to_string()),
                ("margin", number(contact.margin)),
                ("gap", number(0.0)),
                ("friction", numbers(&friction)),
                ("solref", numbers(&contact.softness.solref)),
                ("solimp", numbers(&contact.softness.solimp)),
            ],
        );
    });
}

fn tendons(xml: &mut Xml, model: &Model) {
    xml.section("tendon", &model.muscles, |xml, muscle| {
        let mut attributes = vec![("name", text(&muscle.name))];
        if let Some(limit) = &muscle.limit {
            attributes.extend([
                ("limited", text("true")),
                ("range", numbers(&limit.range)),
                ("margin", number(limit.margin)),
                ("solreflimit", numbers(&limit.softness.solref)),
                ("solimplimit", numbers(&limit.softness.solimp)),
            ]);
        }
        xml.open("spatial", &attributes);
        for (index, &site) in muscle.path.iter().enumerate() {
            for pulley in muscle.pulleys.iter().filter(|pulley| pulley.before == index) {
                xml.leaf("pulley", &[("divisor", number(pulley.divisor))]);
            }
            xml.leaf("site", &[("site", text(&model.sites[site].name))]);
            for over in muscle.over.iter().filter(|over| over.after == index) {
                let mut attributes = vec![("geom", text(&model.wraps[over.wrap].name))];
                attributes.extend(over.side.map(|side| ("sidesite", text(&model.sites[side].name))));
                xml.leaf("geom", &attributes);
            }
        }
        xml.close("spatial");
    });
}

fn couplings(xml: &mut Xml, model: &Model) {
    xml.section("equality", &model.couplings, |xml, coupling| {
        let mut attributes = vec![("joint1", text(&model.joints[coupling.dependent].name))];
        attributes.extend(coupling.independent.map(|leader| ("joint2", text(&model.joints[leader].name))));
        attributes.extend([
            ("polycoef", numbers(&coupling.polycoef)),
            ("solref", numbers(&coupling.softness.solref)),
            ("solimp", numbers(&coupling.softness.solimp)),
        ]);
        xml.leaf("joint", &attributes);
    });
}

/// Connections about which bodies may turn, with their numbers: their two anchors are sites, since MuJoCo takes one point for both else.
fn pins(model: &Model) -> impl Iterator<Item = (usize, &Connection)> {
    model.connections.iter().enumerate().filter(|(_, connection)| connection.weld.is_none())
}

/// The name of the site at one end of such a connection, which no other site has.
fn pin(model: &Model, number: usize, end: usize) -> String {
    let mut name = format!("connection{}_{}", number + 1, end + 1);
    while model.sites.iter().any(|site| site.name == name) {
        name.push('_');
    }
    name
}

fn connections(xml: &mut Xml, model: &Model) {
    let numbered: Vec<(usize, &Connection)> = model.connections.iter().enumerate().collect();
    xml.section("equality", &numbered, |xml, &(number, connection)| {
        let softness =
            [("solref", numbers(&connection.softness.solref)), ("solimp", numbers(&connection.softness.solimp))];
        let (tag, ends) = match connection.weld {
            None => ("connect", vec![("site1", text(&pin(model, number, 0))), ("site2", text(&pin(model, number, 1)))]),
            Some(weld) => ("weld", welded(model, connection, &weld)),
        };
        xml.leaf(tag, &[ends, softness.into()].concat());
    });
}

fn welded(model: &Model, connection: &Connection, weld: &Weld) -> Vec<Attribute> {
    let [one, other] = connection.bodies.map(|body| text(&model.bodies[body].name));
    let [at, anchor] = connection.anchors.each_ref().map(|anchor| numbers(anchor.as_slice()));
    vec![
        ("body1", one),
        ("body2", other),
        ("relpose", format!("{at} {}", rotation(&weld.turn))),
        ("anchor", anchor),
        ("torquescale", number(weld.torque_scale)),
    ]
}

fn actuators(xml: &mut Xml, model: &Model) {
    xml.section("actuator", &model.muscles, |xml, muscle| xml.leaf("general", &actuator_attributes(muscle)));
}

fn actuator_attributes(muscle: &Muscle) -> Vec<Attribute> {
    let parameters = &muscle.parameters;
    vec![
        ("name", text(&muscle.name)),
        ("tendon", text(&muscle.name)),
        ("dyntype", text("muscle")),
        ("gaintype", text("muscle")),
        ("biastype", text("muscle")),
        ("dynprm", numbers(&[parameters.tau_act, parameters.tau_deact, parameters.tau_smooth])),
        ("gainprm", curve(&parameters.gain)),
        ("biasprm", curve(&parameters.bias)),
        ("lengthrange", numbers(&parameters.length_range)),
        ("ctrlrange", numbers(&parameters.ctrl_range)),
    ]
}

/// MuJoCo's nine muscle parameters; a negative force asks for the automatic one.
fn curve(curve: &CurveParameters) -> String {
    let [lower, upper] = curve.range;
    let force = curve.force.unwrap_or(-1.0);
    numbers(&[lower, upper, force, curve.scale, curve.lmin, curve.lmax, curve.vmax, curve.fpmax, curve.fvmax])
}

fn sensors(xml: &mut Xml, model: &Model, buttons: &[Button]) {
    if buttons.is_empty() && model.sensors.is_empty() {
        return;
    }
    xml.open("sensor", &[]);
    for button in buttons {
        xml.leaf("touch", &[("name", text(&button.name)), ("site", text(&button.name))]);
    }
    model.sensors.iter().for_each(|sensor| sensors::sensor(xml, model, sensor));
    xml.close("sensor");
}

/// Name and value, the value escaped already.
type Attribute = (&'static str, String);

fn text(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The shortest decimal that reads back as the same f64.
fn number(value: f64) -> String {
    format!("{value:?}")
}

fn numbers(values: &[f64]) -> String {
    values.iter().copied().map(number).collect::<Vec<_>>().join(" ")
}

fn rotation(quat: &UnitQuaternion<f64>) -> String {
    numbers(&[quat.w, quat.i, quat.j, quat.k])
}

/// Text of an XML document that grows element by element.
#[derive(Default)]
struct Xml {
    text: String,
    depth: usize,
}

impl Xml {
    fn open(&mut self, tag: &str, attributes: &[Attribute]) {
        self.start(tag, attributes);
        self.text.push_str(">\n");
        self.depth += 1;
    }

    fn close(&mut self, tag: &str) {
        self.depth -= 1;
        self.indent();
        // Writing into a String cannot fail.
        let _ = writeln!(self.text, "</{tag}>");
    }

    fn leaf(&mut self, tag: &str, attributes: &[Attribute]) {
        self.start(tag, attributes);
        self.text.push_str("/>\n");
    }

    /// An element around `items`, left out when there are none.
    fn section<T>(&mut self, tag: &str, items: &[T], mut item: impl FnMut(&mut Self, &T)) {
        if items.is_empty() {
            return;
        }
        self.open(tag, &[]);
        items.iter().for_each(|element| item(self, element));
        self.close(tag);
    }

    fn start(&mut self, tag: &str, attributes: &[Attribute]) {
        self.indent();
        let _ = write!(self.text, "<{tag}");
        for (name, value) in attributes {
            let _ = write!(self.text, " {name}=\"{value}\"");
        }
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("  ", self.depth));
    }
}
