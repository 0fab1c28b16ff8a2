//! Joints, and joints that follow others.

use super::Import;
use crate::description::{Coupling, Joint, JointKind, Softness};
use myo_mjcf::{self as source, Auto, Constraint, Switch};

impl Import<'_> {
    pub(super) fn joints(&mut self) -> Vec<Joint> {
        let mjcf = self.mjcf;
        mjcf.joints().enumerate().filter_map(|(number, (body, joint))| self.joint(number, body, joint)).collect()
    }

    /// The limits of a joint that has some.
    pub(super) fn range_of(&self, joint: &source::Joint) -> Option<[f64; 2]> {
        let is_limited = joint.limited().decide(self.mjcf.compiler.autolimits(), joint.range);
        (is_limited && self.keeps(self.mjcf.flags.limit())).then(|| joint.range())
    }

    /// The same of one whose limits are as hard as MuJoCo's own, or harder.
    pub(super) fn hard_range(&self, joint: &source::Joint) -> Option<[f64; 2]> {
        let ([time_constant, damping_ratio], [at_zero, ..]) = (joint.solreflimit(), joint.solimplimit());
        let is_hard = (0.0..=0.02).contains(&time_constant) && damping_ratio >= 1.0 && at_zero >= 0.9;
        self.range_of(joint).filter(|_| is_hard)
    }

    /// A joint; none of a kind that is refused.
    fn joint(&mut self, number: usize, body: usize, joint: &source::Joint) -> Option<Joint> {
        let flags = &self.mjcf.flags;
        let on = |switch: Switch| switch == Switch::On && flags.passive() == Switch::On;
        let (has_springs, has_dampers) = (on(flags.spring()), on(flags.damper()));
        let autolimits = self.mjcf.compiler.autolimits();
        let element = ("joint", joint.name.as_ref());
        let kind = match joint.kind() {
            source::JointKind::Hinge => JointKind::Hinge,
            source::JointKind::Slide => JointKind::Slide,
            source::JointKind::Ball => JointKind::Ball,
            source::JointKind::Free => JointKind::Free,
        };
        // MuJoCo lets no free joint have limits.
        let range = self.range_of(joint).filter(|_| kind != JointKind::Free);
        let is_limited = range.is_some();
        let [stiffness, damping] = [joint.stiffness(), joint.damping()];
        let (is_scalar, is_free) = (kind.is_scalar(), kind == JointKind::Free);
        let aligns = is_free && self.is_aligned(body, joint);
        let is_curved = |[_, square, cube]: [f64; 3]| square != 0.0 || cube != 0.0;
        self.refuse_all(
            &joint.place,
            element,
            &[
                (
                    joint.reference() != 0.0,
                    "a position in the written pose (`ref`) other than 0 is not simulated; count from the written pose",
                ),
                (aligns, "a body's frame is not moved to its centre of mass (`align`, `alignfree`)"),
                (!is_scalar && is_limited, "limits of ball joints (`range`) are not simulated"),
                (
                    !is_scalar && has_springs && stiffness[0] != 0.0,
                    "springs of ball and free joints (`stiffness`) are not simulated",
                ),
                (joint.springdamper() != [0.0; 2], "`springdamper` is not computed; give `stiffness` and `damping`"),
                (
                    has_springs && (is_curved(stiffness) || joint.springyield() != 0.0),
                    "springs that are not linear are not simulated; give `stiffness` one number, and no `springyield`",
                ),
                (
                    has_dampers && is_curved(damping),
                    "dampers that are not linear are not simulated; give `damping` one number",
                ),
                (
                    joint.frictionloss() != 0.0 && self.keeps(flags.frictionloss()),
                    "dry friction (`frictionloss`) is not simulated",
                ),
                (is_limited && joint.margin() != 0.0, "limits begin at the limit; leave `margin` out"),
                (
                    joint.actuatorfrclimited().decide(autolimits, joint.actuatorfrcrange),
                    "the sum of muscle torques is not limited (`actuatorfrclimited`)",
                ),
            ],
        );
        self.refuse_direct(&joint.place, element, joint.solreflimit());
        Some(Joint {
            name: self.names.joints[number].clone(),
            body: self.names.bodies[body].clone(),
            kind,
            axis: if is_scalar { joint.axis() } else { [0.0; 3] },
            pos: if is_free { [0.0; 3] } else { joint.pos() },
            range,
            stiffness: if has_springs { stiffness[0] } else { 0.0 },
            spring_ref: if is_scalar { joint.springref() } else { 0.0 },
            damping: if has_dampers { damping[0] } else { 0.0 },
            armature: joint.armature(),
            softness: Softness { solref: joint.solreflimit(), solimp: joint.solimplimit() },
        })
    }

    /// Whether MuJoCo moves the frame of a free body to its centre of mass: of one that carries no other.
    fn is_aligned(&self, body: usize, joint: &source::Joint) -> bool {
        let is_asked = match joint.align {
            Some(Auto::Yes) => true,
            Some(Auto::No) => false,
            Some(Auto::Auto) | None => self.mjcf.compiler.alignfree(),
        };
        is_asked && self.mjcf.bodies.iter().skip(1).all(|other| other.parent != body)
    }

    pub(super) fn couplings(&mut self) -> Vec<Coupling> {
        let mjcf = self.mjcf;
        if !self.keeps(mjcf.flags.equality()) {
            return vec![];
        }
        // What is not active is not simulated by MuJoCo either.
        mjcf.equalities.iter().filter(|one| one.active()).filter_map(|one| self.coupling(one)).collect()
    }

    fn coupling(&mut self, equality: &source::Equality) -> Option<Coupling> {
        match &equality.constraint {
            Constraint::Joint(coupling) => {
                self.refuse_direct(&equality.place, ("joint", equality.name.as_ref()), equality.solref());
                Some(Coupling {
                    dependent: coupling.joint1.clone(),
                    independent: coupling.joint2.clone(),
                    polycoef: coupling.polycoef(),
                    softness: Softness { solref: equality.solref(), solimp: equality.solimp() },
                })
            }
            Constraint::Tendon(_) => {
                let element = ("tendon", equality.name.as_ref());
                self.refuse(&equality.place, element, "equalities of tendons are not simulated");
                None
            }
            // See `connections.rs`.
            Constraint::Connect(_) | Constraint::Weld(_) => None,
        }
    }

    pub(super) fn refuse_direct(&mut self, place: &source::Place, element: (&str, Option<&String>), solref: [f64; 2]) {
        if solref[0] <= 0.0 || solref[1] <= 0.0 {
            self.refuse(
                place,
                element,
                "softness as stiffness and damping (negative `solref`) is not simulated; give time constant and damping ratio",
            );
        }
    }
}
