//! Muscles, the ways they take, and what these run over.

use super::Import;
use crate::description::{Muscle, Over, PathElement, Pulley, Softness, TendonLimit, Wrap, WrapShape};
use myo_mjcf::{Actuator, BiasKind, DynKind, GainKind, Mjcf, PathPoint, Shape, Switch, Tendon, TendonPath};
use myo_muscle::{CurveParameters, MuscleParameters};
use std::collections::HashSet;

/// Names of geoms that tendons run over.
pub(super) fn run_over(mjcf: &Mjcf) -> HashSet<&str> {
    let paths = mjcf.tendons.iter().filter_map(|tendon| match &tendon.path {
        TendonPath::Spatial(path) => Some(path),
        TendonPath::Fixed(_) => None,
    });
    let over = paths.flatten().filter_map(|point| match point {
        PathPoint::Geom(over) => Some(over.geom.as_str()),
        _ => None,
    });
    over.collect()
}

impl Import<'_> {
    /// Whether a tendon runs over the geom of this name.
    pub(super) fn is_run_over(&self, name: &str) -> bool {
        self.run_over.contains(name)
    }

    /// Spheres and cylinders that tendons run over.
    pub(super) fn wraps(&mut self) -> Vec<Wrap> {
        let mjcf = self.mjcf;
        let mut all = vec![];
        for (body, geom) in mjcf.geoms() {
            let Some(name) = geom.name.as_ref().filter(|name| self.is_run_over(name)) else { continue };
            let [radius, half_length, _] = geom.size();
            let shape = match geom.kind() {
                Shape::Sphere => WrapShape::Sphere { radius },
                Shape::Cylinder => WrapShape::Cylinder { radius, half_length },
                _ => {
                    self.refuse(&geom.place, ("geom", Some(name)), "tendons run over spheres and cylinders");
                    continue;
                }
            };
            let body = self.names.bodies[body].clone();
            all.push(Wrap { name: name.clone(), body, shape, pos: geom.pose.pos(), quat: geom.pose.quat() });
        }
        all
    }

    pub(super) fn muscles(&mut self) -> Vec<Muscle> {
        let mjcf = self.mjcf;
        mjcf.tendons.iter().for_each(|tendon| self.check_tendon(tendon));
        mjcf.actuators.iter().enumerate().filter_map(|(number, actuator)| self.muscle(number, actuator)).collect()
    }

    /// Lengths that a tendon does not leave; none without limit.
    fn limit(&mut self, tendon: &Tendon) -> Option<TendonLimit> {
        let is_limited = tendon.limited().decide(self.mjcf.compiler.autolimits(), tendon.range);
        if !is_limited || !self.keeps(self.mjcf.flags.limit()) {
            return None;
        }
        self.refuse_direct(&tendon.place, ("tendon", tendon.name.as_ref()), tendon.solreflimit());
        let softness = Softness { solref: tendon.solreflimit(), solimp: tendon.solimplimit() };
        Some(TendonLimit { range: tendon.range(), margin: tendon.margin(), softness })
    }

    /// Refuses forces that a tendon has of itself.
    fn check_tendon(&mut self, tendon: &Tendon) {
        let flags = &self.mjcf.flags;
        let autolimits = self.mjcf.compiler.autolimits();
        let on = |switch: Switch| switch == Switch::On && flags.passive() == Switch::On;
        let is_limited = tendon.limited().decide(autolimits, tendon.range) && self.keeps(flags.limit());
        let is_pulled =
            self.mjcf.actuators.iter().any(|actuator| actuator.tendon.is_some() && actuator.tendon == tendon.name);
        self.refuse_all(
            &tendon.place,
            ("tendon", tendon.name.as_ref()),
            &[
                (
                    is_limited && !is_pulled,
                    "limits (`limited`, `range`) of tendons that no muscle pulls are not simulated",
                ),
                (
                    on(flags.spring()) && tendon.stiffness() != [0.0; 3],
                    "springs of tendons (`stiffness`) are not simulated",
                ),
                (
                    on(flags.damper()) && tendon.damping() != [0.0; 3],
                    "dampers of tendons (`damping`) are not simulated",
                ),
                (
                    tendon.frictionloss() != 0.0 && self.keeps(flags.frictionloss()),
                    "dry friction of tendons (`frictionloss`) is not simulated",
                ),
                (tendon.armature() != 0.0, "inertia of tendons (`armature`) is not simulated"),
                (
                    tendon.actuatorfrclimited().decide(autolimits, tendon.actuatorfrcrange),
                    "the sum of forces on a tendon is not limited (`actuatorfrclimited`)",
                ),
            ],
        );
    }

    fn muscle(&mut self, number: usize, actuator: &Actuator) -> Option<Muscle> {
        let element = ("actuator", actuator.name.as_ref());
        let kinds = (actuator.dyntype(), actuator.gaintype(), actuator.biastype());
        if kinds != (DynKind::Muscle, GainKind::Muscle, BiasKind::Muscle) {
            self.refuse(&actuator.place, element, "actuators other than muscles are not simulated");
            return None;
        }
        let Some(tendon) = &actuator.tendon else {
            self.refuse(&actuator.place, element, "muscles must pull tendons; give it a `tendon`");
            return None;
        };
        self.check_muscle(actuator);
        // The reader knows that there is one.
        let tendon = self.mjcf.tendons.iter().find(|other| other.name.as_ref() == Some(tendon))?;
        let is_first = self.mjcf.actuators[..number].iter().all(|other| other.tendon != actuator.tendon);
        let [tau_act, tau_deact, tau_smooth, ..] = actuator.dynprm();
        let is_limited = actuator.ctrllimited().decide(self.mjcf.compiler.autolimits(), actuator.ctrlrange);
        Some(Muscle {
            name: actuator.name.clone().unwrap_or_else(|| format!("muscle{}", number + 1)),
            path: self.path(tendon)?,
            // A tendon that several muscles pull is limited once.
            limit: if is_first { self.limit(tendon) } else { None },
            parameters: MuscleParameters {
                length_range: actuator.lengthrange(),
                gain: curve(actuator.gainprm()),
                bias: curve(actuator.biasprm()),
                tau_act,
                tau_deact,
                tau_smooth,
                // MuJoCo's muscles clamp their control themselves.
                ctrl_range: if is_limited { actuator.ctrlrange() } else { [0.0, 1.0] },
                group: None,
            },
        })
    }

    fn check_muscle(&mut self, actuator: &Actuator) {
        let autolimits = self.mjcf.compiler.autolimits();
        self.refuse_all(
            &actuator.place,
            ("actuator", actuator.name.as_ref()),
            &[
                (
                    actuator.lengthrange() == [0.0; 2],
                    "its `lengthrange` is not computed; let MuJoCo load the model and save it with `mj_saveLastXML`, which writes it",
                ),
                (
                    actuator.gear() != [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
                    "a muscle pulls its tendon as it is; leave `gear` out",
                ),
                (
                    actuator.forcelimited().decide(autolimits, actuator.forcerange),
                    "limits of muscle force (`forcerange`) are not simulated",
                ),
                (
                    actuator.actlimited().decide(autolimits, actuator.actrange),
                    "limits of activation (`actrange`) are not simulated",
                ),
                (actuator.actearly(), "activation before its time (`actearly`) is not simulated"),
                (actuator.delay() != 0.0 || actuator.nsample() != 0, "delayed controls (`delay`, `nsample`) are not simulated"),
                (
                    actuator.damping() != [0.0; 3] || actuator.armature() != 0.0,
                    "damping and inertia of actuators are not simulated",
                ),
            ],
        );
    }

    /// The way of a tendon; none of one that is refused.
    fn path(&mut self, tendon: &Tendon) -> Option<Vec<PathElement>> {
        let element = ("tendon", tendon.name.as_ref());
        let TendonPath::Spatial(points) = &tendon.path else {
            self.refuse(&tendon.place, element, "muscles must pull tendons that run through space (`spatial`)");
            return None;
        };
        let element = |point: &PathPoint| match point {
            PathPoint::Site(site) => PathElement::Site(site.site.clone()),
            PathPoint::Geom(geom) => PathElement::Over(Over { over: geom.geom.clone(), side: geom.sidesite.clone() }),
            PathPoint::Pulley(pulley) => PathElement::Pulley(Pulley { pulley: pulley.divisor }),
        };
        Some(points.iter().map(element).collect())
    }
}

/// MuJoCo's nine parameters; a negative force asks for the automatic one.
fn curve([lower, upper, force, scale, lmin, lmax, vmax, fpmax, fvmax, _]: [f64; 10]) -> CurveParameters {
    let force = (force >= 0.0).then_some(force);
    CurveParameters { range: [lower, upper], force, scale, lmin, lmax, vmax, fpmax, fvmax }
}
