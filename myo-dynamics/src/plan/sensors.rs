//! Sensors of a model: what each one reads of an exact plan.

use super::build::limited;
use super::{FixedFrame, JointCoordinates, Link, Plan, Point};
use myo_model::Model;
use myo_model::description::{
    Frame, FrameQuantity, JointKind, JointQuantity, Measure, MuscleQuantity, Shape, SubtreeQuantity,
};
use nalgebra::{Matrix3, UnitQuaternion, Vector3};

/// Least mass (kg) that has a centre; MuJoCo's.
const LEAST_MASS: f64 = 1e-15;

/// Sensors of a model, in the order of its description.
///
/// They read an [exact](Plan::exact) plan, of which nothing was dropped, after [`step::forward`](crate::step::forward); a step knows nothing of them.
#[derive(Clone, Debug)]
pub struct Sensors {
    pub(crate) all: Vec<Sensor>,
}

/// A sensor.
#[derive(Clone, Debug)]
pub(crate) struct Sensor {
    pub measured: Measured,
    /// Greatest size of each of its numbers; 0 is any.
    pub cutoff: f64,
}

/// What it reads.
#[derive(Clone, Debug)]
pub(crate) enum Measured {
    Touch(Feeling),
    Gyro(FixedFrame<f64>),
    Velocimeter(FixedFrame<f64>),
    /// Position or velocity of a joint.
    Joint {
        joint: JointCoordinates<f64>,
        is_rate: bool,
    },
    /// What muscles do along the screw of a link, which carries others; nothing where a joint stands still.
    Pulled {
        screw: usize,
        links: Vec<usize>,
    },
    /// A limit of a joint, by its number in the plan; none where a joint stands still.
    Limit {
        limit: Option<usize>,
        quantity: JointQuantity,
    },
    Muscle {
        muscle: usize,
        quantity: MuscleQuantity,
    },
    /// A limit of a tendon, by its number in the plan.
    TendonLimit {
        limit: usize,
        quantity: MuscleQuantity,
    },
    Frame {
        of: Seen,
        quantity: FrameQuantity,
        seen_from: Option<Seen>,
    },
    /// Centres of mass, each with its share of the whole.
    Subtree {
        centres: Vec<(Point<f64>, f64)>,
        quantity: SubtreeQuantity,
    },
}

/// Where a site feels touch.
#[derive(Clone, Debug)]
pub(crate) struct Feeling {
    pub frame: FixedFrame<f64>,
    pub shape: Shape,
    /// Pairs that its body is in, and whether it is the first part of each.
    pub pairs: Vec<(usize, bool)>,
}

/// A frame, and how it comes to be turned as it is.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    pub frame: FixedFrame<f64>,
    /// From the world on. A rotation has two quaternions, and only this tells which is MuJoCo's.
    pub turns: Vec<Turn>,
}

/// A turn on the way to a frame.
#[derive(Clone, Debug)]
pub(crate) enum Turn {
    /// That never changes.
    Fixed(UnitQuaternion<f64>),
    /// About an axis, of a joint.
    Hinge(usize, Vector3<f64>),
    /// Of a ball joint: where its quaternion begins in `qpos`.
    Ball(usize),
    /// The same of a free body, whatever was before.
    Free(usize),
}

impl Sensors {
    /// Those of a model, as an [exact](Plan::exact) plan of it has them.
    pub fn new(model: &Model, plan: &Plan<f64>) -> Self {
        let compiler = Compiler { model, plan };
        let sensor = |sensor: &myo_model::model::Sensor| Sensor {
            measured: compiler.measured(&sensor.measures),
            cutoff: sensor.cutoff,
        };
        Self { all: model.sensors.iter().map(sensor).collect() }
    }

    /// How many numbers each of them gives.
    pub fn sizes(&self) -> impl Iterator<Item = usize> {
        self.all.iter().map(|sensor| sensor.measured.size())
    }
}

impl Measured {
    fn size(&self) -> usize {
        match self {
            Self::Joint { joint: JointCoordinates::Many { qpos, .. }, is_rate: false } => qpos.len(),
            Self::Joint { joint: JointCoordinates::Many { qvel, .. }, is_rate: true } => qvel.len(),
            Self::Frame { quantity: FrameQuantity::Orientation, .. } => 4,
            Self::Gyro(_) | Self::Velocimeter(_) | Self::Frame { .. } | Self::Subtree { .. } => 3,
            _ => 1,
        }
    }
}

struct Compiler<'a> {
    model: &'a Model,
    plan: &'a Plan<f64>,
}

impl Compiler<'_> {
    fn measured(&self, measures: &Measure<usize>) -> Measured {
        match *measures {
            Measure::Touch(site) => Measured::Touch(self.feeling(site)),
            Measure::Gyro(site) => Measured::Gyro(self.frame(Frame::Site(site))),
            Measure::Velocimeter(site) => Measured::Velocimeter(self.frame(Frame::Site(site))),
            Measure::Joint { of, quantity } => self.joint(of, quantity),
            Measure::Muscle { of: muscle, quantity } => {
                let limit = self.plan.tendon_limits.iter().position(|limit| limit.muscle == muscle);
                match limit.filter(|_| quantity.is_of_limit()) {
                    Some(limit) => Measured::TendonLimit { limit, quantity },
                    None => Measured::Muscle { muscle, quantity },
                }
            }
            Measure::Frame { of, quantity, seen_from } => {
                Measured::Frame { of: self.seen(of), quantity, seen_from: seen_from.map(|frame| self.seen(frame)) }
            }
            Measure::Subtree { of, quantity } => Measured::Subtree { centres: self.centres(of, quantity), quantity },
        }
    }

    fn feeling(&self, site: usize) -> Feeling {
        let (model, site_frame) = (self.model, self.frame(Frame::Site(site)));
        let site = &model.sites[site];
        let pair = |(number, contact): (usize, &myo_model::model::Contact)| {
            let touches = contact.geoms.iter().any(|&geom| model.geoms[geom].body == site.body);
            // Parts of one link do not touch each other.
            touches.then(|| (number, self.plan.pairs[number].links()[0] == site_frame.origin.link))
        };
        Feeling {
            frame: site_frame,
            // Checked when the model was made; a point feels nothing.
            shape: site.shape.unwrap_or(Shape::Sphere { radius: 0.0 }),
            pairs: model.contacts.iter().enumerate().filter_map(pair).collect(),
        }
    }

    fn joint(&self, of: usize, quantity: JointQuantity) -> Measured {
        let (joints, places) = (&self.model.joints, &self.plan.joints);
        match quantity {
            JointQuantity::Position => Measured::Joint { joint: places[of].clone(), is_rate: false },
            JointQuantity::Velocity => Measured::Joint { joint: places[of].clone(), is_rate: true },
            JointQuantity::MuscleForce => self.pulled(of),
            _ => {
                let is_limited = |&joint: &usize| limited(&joints[joint], &places[joint]).is_some();
                let limit = is_limited(&of).then(|| (0..of).filter(is_limited).count());
                Measured::Limit { limit, quantity }
            }
        }
    }

    /// Every joint that moves has links of its own, in the order of joints.
    fn pulled(&self, of: usize) -> Measured {
        let links = |joint: &JointCoordinates<f64>| match joint {
            JointCoordinates::One(drive) => usize::from(drive.dof.is_some()),
            JointCoordinates::Many { qvel, .. } => qvel.len(),
        };
        let screw = 1 + self.plan.joints[..of].iter().map(links).sum::<usize>();
        let mut carried = vec![];
        if links(&self.plan.joints[of]) > 0 {
            carried.push(screw);
            for (link, Link { parent, .. }) in self.plan.links.iter().enumerate().skip(screw + 1) {
                if carried.contains(parent) {
                    carried.push(link);
                }
            }
        }
        Measured::Pulled { screw, links: carried }
    }

    /// Centres of a body and of all that hangs on it.
    fn centres(&self, of: usize, quantity: SubtreeQuantity) -> Vec<(Point<f64>, f64)> {
        let bodies = &self.model.bodies;
        let mut is_below: Vec<bool> = (0..bodies.len()).map(|body| body == of).collect();
        for body in 1..bodies.len() {
            is_below[body] |= is_below[bodies[body].parent];
        }
        let below = || (0..bodies.len()).filter(|&body| is_below[body]);
        let mass: f64 = below().map(|body| bodies[body].mass).sum();
        let centre = |body: usize| self.frame(Frame::Centre(body)).origin;
        match (mass < LEAST_MASS, quantity) {
            (false, _) => below().map(|body| (centre(body), bodies[body].mass / mass)).collect(),
            (true, SubtreeQuantity::Centre) => vec![(centre(of), 1.0)],
            (true, SubtreeQuantity::Velocity) => vec![],
        }
    }

    fn seen(&self, frame: Frame<usize>) -> Seen {
        let (body, _, quat) = self.place(frame);
        let mut turns = self.turns(body);
        turns.push(Turn::Fixed(quat));
        Seen { frame: self.frame(frame), turns }
    }

    /// Turns from the world to a body.
    fn turns(&self, body: usize) -> Vec<Turn> {
        let bodies = &self.model.bodies;
        let mut turns = if body == 0 { return vec![] } else { self.turns(bodies[body].parent) };
        turns.push(Turn::Fixed(bodies[body].quat));
        for (number, joint) in self.model.joints.iter().enumerate().filter(|(_, joint)| joint.body == body) {
            match (joint.kind, &self.plan.joints[number]) {
                (JointKind::Hinge, _) => turns.push(Turn::Hinge(number, joint.axis)),
                (JointKind::Ball, JointCoordinates::Many { qpos, .. }) => turns.push(Turn::Ball(qpos.start)),
                (JointKind::Free, JointCoordinates::Many { qpos, .. }) => turns.push(Turn::Free(qpos.start + 3)),
                _ => {}
            }
        }
        turns
    }

    fn frame(&self, frame: Frame<usize>) -> FixedFrame<f64> {
        let (body, pos, quat) = self.place(frame);
        let FixedFrame { origin, axes } = self.plan.elements.bodies[body];
        let turn = Matrix3::from_columns(&axes.map(Vector3::from));
        let position = Vector3::from(origin.position) + turn * pos;
        let axes = turn * quat.to_rotation_matrix().into_inner();
        FixedFrame { origin: Point { link: origin.link, position: position.into() }, axes: axes.into() }
    }

    /// Body of a frame, and where it is on that.
    fn place(&self, frame: Frame<usize>) -> (usize, Vector3<f64>, UnitQuaternion<f64>) {
        let model = self.model;
        match frame {
            Frame::Body(body) => (body, Vector3::zeros(), UnitQuaternion::identity()),
            Frame::Centre(body) => (body, model.bodies[body].com, model.bodies[body].inertia_quat),
            Frame::Geom(geom) => (model.geoms[geom].body, model.geoms[geom].pos, model.geoms[geom].quat),
            Frame::Wrap(wrap) => (model.wraps[wrap].body, model.wraps[wrap].pos, model.wraps[wrap].quat),
            Frame::Site(site) => (model.sites[site].body, model.sites[site].pos, model.sites[site].quat),
        }
    }
}
