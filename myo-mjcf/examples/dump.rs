//! Prints a model as lines `kind, index, name, field, values`, with tabs between, defaults filled in.
//!
//! `cargo run -p myo-mjcf --example dump -- MODEL.xml [ROOT_FOLDER]`; `tests/against_mujoco.py` compares the lines with
//! what MuJoCo makes of the same file.

use myo_mjcf::*;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let model = match &arguments[..] {
        [path] => read(Path::new(path)),
        [path, root] => read_below(Path::new(root), Path::new(path)),
        _ => {
            eprintln!("usage: dump MODEL.xml [ROOT_FOLDER]");
            return ExitCode::from(2);
        }
    };
    match model {
        Ok(model) => {
            dump(&model);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// An element that prints its fields.
struct Lines<'a> {
    kind: &'a str,
    index: usize,
    name: &'a str,
}

impl Lines<'_> {
    fn text(&self, field: &str, value: &str) {
        println!("{}\t{}\t{}\t{field}\t{value}", self.kind, self.index, self.name);
    }

    fn numbers(&self, field: &str, values: &[f64]) {
        let values: Vec<_> = values.iter().map(|value| format!("{value:?}")).collect();
        self.text(field, &values.join(" "));
    }

    fn number(&self, field: &str, value: f64) {
        self.numbers(field, &[value]);
    }

    fn pose(&self, pose: &Pose) {
        self.numbers("pos", &pose.pos());
        self.numbers("quat", &pose.quat());
    }

    fn softness(&self, suffix: &str, solref: [f64; 2], solimp: [f64; 5]) {
        self.numbers(&format!("solref{suffix}"), &solref);
        self.numbers(&format!("solimp{suffix}"), &solimp);
    }
}

fn lines<'a>(kind: &'a str, index: usize, name: Option<&'a str>) -> Lines<'a> {
    Lines { kind, index, name: name.unwrap_or_default() }
}

fn dump(model: &Mjcf) {
    let auto = model.compiler.autolimits();
    options(model);
    for (index, body) in model.bodies.iter().enumerate() {
        dump_body(index, body);
    }
    for (index, (body, joint)) in model.joints().enumerate() {
        dump_joint(index, body, joint, auto);
    }
    for (index, (body, geom)) in model.geoms().enumerate() {
        dump_geom(index, body, geom);
    }
    for (index, (body, site)) in model.sites().enumerate() {
        let out = lines("site", index, site.name.as_deref());
        out.number("body", body as f64);
        out.text("type", site.kind().word());
        out.pose(&site.pose);
        out.numbers("size", &site.size());
        out.numbers("rgba", &site.rgba());
        out.number("group", f64::from(site.group()));
    }
    for (index, tendon) in model.tendons.iter().enumerate() {
        dump_tendon(index, tendon, auto);
    }
    for (index, actuator) in model.actuators.iter().enumerate() {
        dump_actuator(index, actuator, auto);
    }
    for (index, equality) in model.equalities.iter().enumerate() {
        dump_equality(index, equality);
    }
    for (index, exclude) in model.excludes.iter().enumerate() {
        lines("exclude", index, exclude.name.as_deref())
            .text("bodies", &format!("{} {}", exclude.body1, exclude.body2));
    }
    for (index, pair) in model.pairs.iter().enumerate() {
        let out = lines("pair", index, pair.name.as_deref());
        out.text("geoms", &format!("{} {}", pair.geom1, pair.geom2));
        out.numbers("friction", &pair.friction());
        out.softness("", pair.solref(), pair.solimp());
        out.numbers("scalars", &[f64::from(pair.condim()), pair.margin(), pair.gap()]);
    }
    for (index, sensor) in model.sensors.iter().enumerate() {
        let out = lines("sensor", index, sensor.name.as_deref());
        out.text("kind", sensor.kind);
        out.number("cutoff", sensor.cutoff());
    }
    for (index, key) in model.keys.iter().enumerate() {
        let out = lines("key", index, key.name.as_deref());
        out.number("time", key.time());
        for (field, values) in [("qpos", &key.qpos), ("qvel", &key.qvel), ("act", &key.act), ("ctrl", &key.ctrl)] {
            if let Some(values) = values {
                out.numbers(field, values);
            }
        }
    }
}

fn options(model: &Mjcf) {
    let out = lines("option", 0, model.model.as_deref());
    let option = &model.option;
    out.number("timestep", option.timestep());
    out.numbers("gravity", &option.gravity());
    out.number("impratio", option.impratio());
    out.number("tolerance", option.tolerance());
    out.number("iterations", f64::from(option.iterations()));
    out.text("integrator", option.integrator().word());
    out.text("cone", option.cone().word());
    out.text("solver", option.solver().word());
}

fn dump_body(index: usize, body: &Body) {
    let out = lines("body", index, body.name.as_deref());
    out.number("parent", body.parent as f64);
    out.pose(&body.pose);
    out.number("gravcomp", body.gravcomp());
    if let Some(inertial) = &body.inertial {
        out.number("mass", inertial.mass);
        out.numbers("ipos", &inertial.pose.pos());
        if inertial.fullinertia.is_none() {
            out.numbers("iquat", &inertial.pose.quat());
            out.numbers("inertia", &inertial.diaginertia());
        }
    }
}

fn dump_joint(index: usize, body: usize, joint: &Joint, auto: bool) {
    let out = lines("joint", index, joint.name.as_deref());
    out.number("body", body as f64);
    out.text("type", joint.kind().word());
    out.numbers("pos", &joint.pos());
    out.numbers("axis", &joint.axis());
    out.numbers("range", &joint.range());
    out.number("limited", f64::from(joint.limited().decide(auto, joint.range)));
    out.numbers("stiffness", &joint.stiffness());
    out.numbers("damping", &joint.damping());
    out.numbers("springdamper", &joint.springdamper());
    out.number("armature", joint.armature());
    out.number("frictionloss", joint.frictionloss());
    out.number("margin", joint.margin());
    out.number("ref", joint.reference());
    out.number("springref", joint.springref());
    out.number("group", f64::from(joint.group()));
    out.softness("limit", joint.solreflimit(), joint.solimplimit());
    out.softness("friction", joint.solreffriction(), joint.solimpfriction());
    out.numbers("user", joint.user.as_deref().unwrap_or_default());
}

fn dump_geom(index: usize, body: usize, geom: &Geom) {
    let out = lines("geom", index, geom.name.as_deref());
    out.number("body", body as f64);
    out.text("type", geom.kind().word());
    out.text("mesh", geom.mesh.as_deref().unwrap_or_default());
    out.pose(&geom.pose);
    out.numbers("size", &geom.size());
    out.numbers("contact", &[geom.contype(), geom.conaffinity(), geom.condim(), geom.priority()].map(f64::from));
    out.numbers("friction", &geom.friction());
    out.softness("", geom.solref(), geom.solimp());
    out.numbers("scalars", &[geom.solmix(), geom.margin(), geom.gap()]);
    out.number("group", f64::from(geom.group()));
    out.numbers("rgba", &geom.rgba());
    out.text("material", geom.material.as_deref().unwrap_or_default());
}

fn dump_tendon(index: usize, tendon: &Tendon, auto: bool) {
    let out = lines("tendon", index, tendon.name.as_deref());
    out.numbers("range", &tendon.range());
    out.number("limited", f64::from(tendon.limited().decide(auto, tendon.range)));
    out.numbers("stiffness", &tendon.stiffness());
    out.numbers("damping", &tendon.damping());
    out.numbers("springlength", &tendon.springlength());
    out.numbers("scalars", &[tendon.frictionloss(), tendon.margin(), tendon.width(), f64::from(tendon.group())]);
    out.softness("limit", tendon.solreflimit(), tendon.solimplimit());
    let path: Vec<_> = match &tendon.path {
        TendonPath::Fixed(terms) => terms.iter().map(|term| format!("joint:{}:{:?}", term.joint, term.coef)).collect(),
        TendonPath::Spatial(points) => points.iter().map(point).collect(),
    };
    out.text("path", &path.join(" "));
}

fn point(point: &PathPoint) -> String {
    match point {
        PathPoint::Site(site) => format!("site:{}", site.site),
        PathPoint::Geom(geom) => format!("geom:{}:{}", geom.geom, geom.sidesite.as_deref().unwrap_or_default()),
        PathPoint::Pulley(pulley) => format!("pulley:{:?}", pulley.divisor),
    }
}

fn dump_actuator(index: usize, actuator: &Actuator, auto: bool) {
    let out = lines("actuator", index, actuator.name.as_deref());
    let targets = [
        ("joint", &actuator.joint),
        ("jointinparent", &actuator.jointinparent),
        ("tendon", &actuator.tendon),
        ("site", &actuator.site),
        ("body", &actuator.body),
        ("cranksite", &actuator.cranksite),
    ];
    for (kind, name) in targets.into_iter().filter_map(|(kind, name)| Some((kind, name.as_deref()?))) {
        out.text("target", &format!("{kind}:{name}"));
    }
    let law = [actuator.dyntype().word(), actuator.gaintype().word(), actuator.biastype().word()];
    out.text("law", &law.join(" "));
    out.numbers("dynprm", &actuator.dynprm());
    out.numbers("gainprm", &actuator.gainprm());
    out.numbers("biasprm", &actuator.biasprm());
    out.numbers("gear", &actuator.gear());
    out.numbers("ctrlrange", &actuator.ctrlrange());
    out.numbers("forcerange", &actuator.forcerange());
    out.numbers("actrange", &actuator.actrange());
    out.numbers("lengthrange", &actuator.lengthrange());
    let limited = [
        actuator.ctrllimited().decide(auto, actuator.ctrlrange),
        actuator.forcelimited().decide(auto, actuator.forcerange),
        actuator.actlimited().decide(auto, actuator.actrange),
    ];
    out.numbers("limited", &limited.map(f64::from));
    out.number("group", f64::from(actuator.group()));
}

fn dump_equality(index: usize, equality: &Equality) {
    let out = lines("equality", index, equality.name.as_deref());
    out.number("active", f64::from(equality.active()));
    out.softness("", equality.solref(), equality.solimp());
    match &equality.constraint {
        Constraint::Joint(joint) => {
            out.text("objects", &format!("{} {}", joint.joint1, joint.joint2.as_deref().unwrap_or_default()));
            out.numbers("polycoef", &joint.polycoef());
        }
        Constraint::Tendon(tendon) => {
            out.text("objects", &format!("{} {}", tendon.tendon1, tendon.tendon2.as_deref().unwrap_or_default()));
            out.numbers("polycoef", &tendon.polycoef());
        }
        Constraint::Connect(connect) => {
            let bodies = connect.body1.iter().chain(&connect.body2).cloned().collect::<Vec<_>>();
            out.text("objects", &bodies.join(" "));
            out.numbers("anchor", &connect.anchor());
        }
        Constraint::Weld(weld) => {
            let bodies = weld.body1.iter().chain(&weld.body2).cloned().collect::<Vec<_>>();
            out.text("objects", &bodies.join(" "));
            out.numbers("torquescale", &[weld.torquescale()]);
        }
    }
}
