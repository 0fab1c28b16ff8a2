//! Actuators: shortcuts become general parameters, by MuJoCo's rules.

use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::read::Reader;
use crate::table::{Scope, Table, exclusive, fill};
use crate::value::{Auto, Number};

const ACTUATORS: [&str; 9] =
    ["general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion"];

/// What an actuator can act on; one of them must be there.
const TARGETS: [&str; 6] = ["joint", "jointinparent", "tendon", "cranksite", "site", "body"];

/// Attributes that no shortcut has, unless it says so.
const GENERAL: [&str; 15] = [
    "body",
    "actlimited",
    "actrange",
    "actdim",
    "input",
    "velrange",
    "ffrange",
    "dyntype",
    "gaintype",
    "biastype",
    "dynprm",
    "gainprm",
    "biasprm",
    "actearly",
    "inheritrange",
];

/// Attributes that adhesion lacks beside those.
const OF_TRANSMISSION: [&str; 13] = [
    "ctrllimited",
    "joint",
    "jointinparent",
    "tendon",
    "slidersite",
    "cranksite",
    "site",
    "refsite",
    "lengthrange",
    "gear",
    "damping",
    "armature",
    "cranklength",
];

/// The attributes of the table that a kind of actuator does not have.
fn except(tag: &str) -> Vec<&'static str> {
    let without = |names: &[&str]| GENERAL.into_iter().filter(|name| !names.contains(name)).collect::<Vec<_>>();
    match tag {
        "general" => Vec::new(),
        "position" => without(&["inheritrange"]),
        "intvelocity" => [&without(&["inheritrange", "actlimited", "actrange"])[..], &["timeconst"]].concat(),
        "damper" => [&GENERAL[..], &["ctrllimited"]].concat(),
        "muscle" => [&GENERAL[..], &["site", "refsite"]].concat(),
        "adhesion" => [&without(&["body"])[..], &OF_TRANSMISSION].concat(),
        _ => GENERAL.to_vec(),
    }
}

impl Reader<'_> {
    /// Reads an actuator over what its class says; `None` if it is refused.
    pub(crate) fn actuator(
        &mut self,
        node: &Node,
        mut actuator: Actuator,
        scope: Scope,
    ) -> Result<Option<Actuator>, MjcfError> {
        let mut shortcut = match &*node.tag {
            "general" => Shortcut::General,
            "motor" => Shortcut::Motor,
            "position" => Shortcut::Position(Servo::default()),
            "velocity" => Shortcut::Velocity(VelocityServo::default()),
            "intvelocity" => Shortcut::IntVelocity(Servo::default()),
            "damper" => Shortcut::Damper(VelocityServo::default()),
            "cylinder" => Shortcut::Cylinder(Cylinder::default()),
            "muscle" => Shortcut::Muscle(Muscle::default()),
            "adhesion" => Shortcut::Adhesion(Adhesion::default()),
            "plugin" | "orientation" | "pid" | "dcmotor" => {
                self.refuse(node, "plugins and MuJoCo's newer servos and motors are not read; use `general`");
                return Ok(None);
            }
            _ => return Err(node.unknown("actuator", &ACTUATORS)),
        };
        read_both(node, scope, &mut actuator, &mut shortcut)?;
        lower(node, &mut actuator, &shortcut)?;
        actuator.shortcut = shortcut;
        self.budget.book(1, actuator.held() as u64, || node.spot())?;
        if scope == Scope::Element {
            check_target(node)?;
            self.childless(node)?;
        }
        Ok(Some(actuator))
    }
}

fn read_both(node: &Node, scope: Scope, actuator: &mut Actuator, shortcut: &mut Shortcut) -> Result<(), MjcfError> {
    let except = except(&node.tag);
    match shortcut {
        Shortcut::General | Shortcut::Motor => fill(node, scope, &mut [actuator], &except),
        Shortcut::Position(own) | Shortcut::IntVelocity(own) => fill(node, scope, &mut [actuator, own], &except),
        Shortcut::Velocity(own) | Shortcut::Damper(own) => fill(node, scope, &mut [actuator, own], &except),
        Shortcut::Cylinder(own) => fill(node, scope, &mut [actuator, own], &except),
        Shortcut::Muscle(own) => fill(node, scope, &mut [actuator, own], &except),
        Shortcut::Adhesion(own) => fill(node, scope, &mut [actuator, own], &except),
    }
}

fn check_target(node: &Node) -> Result<(), MjcfError> {
    exclusive(node, &TARGETS)?;
    let has = |name: &str| node.get(name).is_some();
    if !TARGETS.iter().any(|target| has(target)) {
        return Err(node.misplaced("nothing to act on; name a joint, a tendon, a site, a cranksite or a body"));
    }
    if has("cranksite") != has("slidersite") {
        return Err(node.misplaced("a slider-crank has both `cranksite` and `slidersite`; give both or none"));
    }
    if has("refsite") && !has("site") {
        return Err(node.misplaced("`refsite` goes with `site`; leave it out"));
    }
    if has("cranklength") && !has("cranksite") {
        return Err(node.misplaced("`cranklength` goes with `cranksite`; leave it out"));
    }
    Ok(())
}

/// What a shortcut means, as the functions `mjs_setTo...` of MuJoCo have it.
fn lower(node: &Node, actuator: &mut Actuator, shortcut: &Shortcut) -> Result<(), MjcfError> {
    match shortcut {
        Shortcut::General => {}
        Shortcut::Motor => {
            set(actuator, DynKind::None, GainKind::Fixed, BiasKind::None);
            gain(actuator)[0] = 1.0;
        }
        Shortcut::Position(servo) => lower_servo(node, actuator, servo, false)?,
        Shortcut::IntVelocity(servo) => lower_servo(node, actuator, servo, true)?,
        Shortcut::Velocity(servo) => {
            let kv = servo.kv.unwrap_or(actuator.gainprm()[0]);
            set(actuator, DynKind::None, GainKind::Fixed, BiasKind::Affine);
            gain(actuator)[0] = kv;
            *bias(actuator) = [0.0, 0.0, -kv, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        }
        Shortcut::Damper(damper) => lower_damper(node, actuator, damper)?,
        Shortcut::Cylinder(cylinder) => lower_cylinder(actuator, cylinder),
        Shortcut::Muscle(muscle) => lower_muscle(node, actuator, muscle)?,
        Shortcut::Adhesion(adhesion) => {
            let strength = adhesion.gain.unwrap_or(actuator.gainprm()[0]);
            not_negative(node, "gain", strength)?;
            not_negative_range(node, actuator)?;
            gain(actuator)[0] = strength;
            actuator.ctrllimited = Some(Auto::Yes);
            actuator.gaintype = Some(GainKind::Fixed);
            actuator.biastype = Some(BiasKind::None);
        }
    }
    Ok(())
}

fn set(actuator: &mut Actuator, dynamics: DynKind, gain: GainKind, bias: BiasKind) {
    actuator.dyntype = Some(dynamics);
    actuator.gaintype = Some(gain);
    actuator.biastype = Some(bias);
}

fn gain(actuator: &mut Actuator) -> &mut [f64; 10] {
    let value = actuator.gainprm();
    actuator.gainprm.insert(value)
}

fn bias(actuator: &mut Actuator) -> &mut [f64; 10] {
    let value = actuator.biasprm();
    actuator.biasprm.insert(value)
}

fn dynamics(actuator: &mut Actuator) -> &mut [f64; 10] {
    let value = actuator.dynprm();
    actuator.dynprm.insert(value)
}

fn lower_servo(node: &Node, actuator: &mut Actuator, servo: &Servo, integrates: bool) -> Result<(), MjcfError> {
    exclusive(node, &["kv", "dampratio"])?;
    let kp = servo.kp.unwrap_or(actuator.gainprm()[0]);
    gain(actuator)[0] = kp;
    bias(actuator)[1] = -kp;
    // Negative is damping, positive a damping ratio.
    if let Some(kv) = servo.kv {
        not_negative(node, "kv", kv)?;
        bias(actuator)[2] = -kv;
    }
    if let Some(ratio) = servo.dampratio {
        not_negative(node, "dampratio", ratio)?;
        bias(actuator)[2] = ratio;
    }
    if let Some(time) = servo.timeconst {
        not_negative(node, "timeconst", time)?;
        dynamics(actuator)[0] = time;
        actuator.dyntype = Some(if time == 0.0 { DynKind::None } else { DynKind::FilterExact });
    }
    let range = if integrates { ("actrange", actuator.actrange()) } else { ("ctrlrange", actuator.ctrlrange()) };
    if actuator.inheritrange() > 0.0 && range.1 != [0.0; 2] {
        return Err(MjcfError::Exclusive { at: node.at(), first: range.0, second: "inheritrange" });
    }
    if integrates {
        actuator.dyntype = Some(DynKind::Integrator);
    }
    actuator.gaintype = Some(GainKind::Fixed);
    actuator.biastype = Some(BiasKind::Affine);
    Ok(())
}

fn lower_damper(node: &Node, actuator: &mut Actuator, damper: &VelocityServo) -> Result<(), MjcfError> {
    let inherited = if actuator.gaintype() == GainKind::Affine { -actuator.gainprm()[2] } else { 0.0 };
    let kv = damper.kv.unwrap_or(inherited);
    not_negative(node, "kv", kv)?;
    not_negative_range(node, actuator)?;
    set(actuator, DynKind::None, GainKind::Affine, BiasKind::None);
    *gain(actuator) = [0.0, 0.0, -kv, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    actuator.ctrllimited = Some(Auto::Yes);
    Ok(())
}

fn lower_cylinder(actuator: &mut Actuator, cylinder: &Cylinder) {
    if let Some(time) = cylinder.timeconst {
        dynamics(actuator)[0] = time;
    }
    if let Some(constants) = cylinder.bias {
        bias(actuator)[..3].copy_from_slice(&constants);
    }
    if let Some(area) = cylinder.area {
        gain(actuator)[0] = area;
    }
    if let Some(diameter) = cylinder.diameter.filter(|diameter| *diameter >= 0.0) {
        gain(actuator)[0] = std::f64::consts::PI / 4.0 * diameter * diameter;
    }
    set(actuator, DynKind::Filter, GainKind::Fixed, BiasKind::Affine);
}

/// Defaults of a muscle: which parameter, what it is if nobody has said anything, what it becomes.
const MUSCLE_GAIN: [(f64, f64); 9] =
    [(1.0, 0.75), (0.0, 1.05), (0.0, -1.0), (0.0, 200.0), (0.0, 0.5), (0.0, 1.6), (0.0, 1.5), (0.0, 1.3), (0.0, 1.2)];

fn lower_muscle(node: &Node, actuator: &mut Actuator, muscle: &Muscle) -> Result<(), MjcfError> {
    let mut times = actuator.dynprm();
    for (time, (unsaid, default)) in times.iter_mut().zip([(1.0, 0.01), (0.0, 0.04)]) {
        *time = if *time == unsaid { default } else { *time };
    }
    if let Some(smooth) = muscle.tausmooth {
        not_negative(node, "tausmooth", smooth)?;
        times[2] = smooth;
    }
    let mut gains = actuator.gainprm();
    for (gain, (unsaid, default)) in gains.iter_mut().zip(MUSCLE_GAIN) {
        *gain = if *gain == unsaid { default } else { *gain };
    }
    // A negative number says nothing.
    overwrite(&mut times, muscle.timeconst.map(|times| times.map(Some)).unwrap_or_default());
    overwrite(&mut gains, muscle.range.map(|range| range.map(Some)).unwrap_or_default());
    let single = [muscle.force, muscle.scale, muscle.lmin, muscle.lmax, muscle.vmax, muscle.fpmax, muscle.fvmax];
    overwrite(&mut gains[2..], single);
    bias(actuator)[..9].copy_from_slice(&gains[..9]);
    (actuator.dynprm, actuator.gainprm) = (Some(times), Some(gains));
    set(actuator, DynKind::Muscle, GainKind::Muscle, BiasKind::Muscle);
    Ok(())
}

fn overwrite<const N: usize>(old: &mut [f64], new: [Option<f64>; N]) {
    for (old, new) in old.iter_mut().zip(new) {
        *old = new.filter(|new| *new >= 0.0).unwrap_or(*old);
    }
}

fn not_negative(node: &Node, attribute: &'static str, value: impl Number + PartialOrd) -> Result<(), MjcfError> {
    if value >= Default::default() {
        return Ok(());
    }
    let (at, text) = (node.at_attribute(attribute), value.to_string());
    Err(MjcfError::OutOfRange { at, attribute, text, expected: "0 or more" })
}

fn not_negative_range(node: &Node, actuator: &Actuator) -> Result<(), MjcfError> {
    actuator.ctrlrange().into_iter().try_for_each(|bound| not_negative(node, "ctrlrange", bound))
}
