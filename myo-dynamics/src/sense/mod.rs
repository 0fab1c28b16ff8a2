//! What sensors read: MuJoCo's `sensordata`, worked out when somebody asks.

mod volume;

use crate::plan::{Feeling, FixedFrame, JointCoordinates, Measured, Plan, Seen, Sensors, Turn};
use crate::spatial::{Frame, Motion, Vec3, Wrench};
use crate::step::constraint::within;
use crate::step::kinematics::joint_state;
use crate::step::{force, pair};
use crate::workspace::{State, Workspace};
use myo_model::description::{FrameQuantity, JointQuantity, MuscleQuantity, SubtreeQuantity};
use nalgebra::{Quaternion, UnitQuaternion};

impl Sensors {
    /// The numbers of all sensors, one after the other, after [`step::forward`](crate::step::forward) of an exact plan in a state. Wrenches and
    /// torques of `ws` are of no use afterwards.
    ///
    /// # Panics
    /// The state or `ws` is of another plan.
    pub fn read(&self, plan: &Plan<f64>, state: &State<f64>, ws: &mut Workspace<f64>) -> Vec<Vec<f64>> {
        if self.all.iter().any(|sensor| matches!(sensor.measured, Measured::Pulled { .. })) {
            force::muscle_torques(plan, ws);
        }
        let mut reading = Reading { plan, state, ws };
        let read = |sensor: &crate::plan::Sensor| {
            let mut numbers = reading.of(&sensor.measured);
            if sensor.cutoff > 0.0 {
                numbers.iter_mut().for_each(|x| *x = x.clamp(-sensor.cutoff, sensor.cutoff));
            }
            numbers
        };
        self.all.iter().map(read).collect()
    }
}

/// A moment that is read.
struct Reading<'a> {
    plan: &'a Plan<f64>,
    state: &'a State<f64>,
    ws: &'a mut Workspace<f64>,
}

impl Reading<'_> {
    fn of(&mut self, measured: &Measured) -> Vec<f64> {
        match measured {
            Measured::Touch(feeling) => vec![self.touch(feeling)],
            Measured::Gyro(frame) => self.own(frame, self.motion(frame).ang),
            Measured::Velocimeter(frame) => self.own(frame, self.motion(frame).lin),
            Measured::Joint { joint, is_rate } => self.joint(joint, *is_rate),
            Measured::Pulled { screw, links } => vec![self.pulled(*screw, links)],
            Measured::Limit { limit, quantity } => vec![limit.map_or(0.0, |limit| self.limit(limit, *quantity))],
            Measured::Muscle { muscle, quantity } => vec![self.muscle(*muscle, *quantity)],
            Measured::TendonLimit { limit, quantity } => vec![self.tendon_limit(*limit, *quantity)],
            Measured::Frame { of, quantity, seen_from } => self.frame(of, *quantity, seen_from.as_ref()),
            Measured::Subtree { centres, quantity } => {
                let mut sum = Vec3::zero();
                for (centre, share) in centres {
                    let place = self.ws.place(centre);
                    let term = match quantity {
                        SubtreeQuantity::Centre => self.in_world(place),
                        SubtreeQuantity::Velocity => self.ws.velocity[centre.link].at(place),
                    };
                    sum = term.mul_add(*share, sum);
                }
                sum.array().into()
            }
        }
    }

    /// The sum of the normal forces that a site feels: of contacts within its shape, or from which its body sees it ahead.
    fn touch(&mut self, feeling: &Feeling) -> f64 {
        let frame = self.ws.fixed(&feeling.frame);
        let mut sum = 0.0;
        for &(number, is_first) in &feeling.pairs {
            let pair = &self.plan.pairs[number];
            let (first, each) = (self.ws.box_slots + pair.slot, pair.slots_each());
            if !self.ws.contacts[first..first + pair.slots()].iter().any(|contact| contact.exists) {
                continue;
            }
            for (point, at) in pair::places(self.plan, pair, self.ws).into_iter().enumerate() {
                let contacts = &self.ws.contacts[first + point * each..][..each];
                let force: f64 = contacts.iter().map(|contact| contact.force).sum();
                let outwards = if is_first { contacts[0].normal } else { -contacts[0].normal };
                let (from, along) = (frame.seen(at), frame.rotation.apply_inverse(outwards));
                if contacts[0].exists && force > 0.0 && volume::is_met(feeling.shape, from, along) {
                    sum += force;
                }
            }
        }
        sum
    }

    fn joint(&self, joint: &JointCoordinates<f64>, is_rate: bool) -> Vec<f64> {
        let State { qpos, qvel, .. } = self.state;
        match joint {
            JointCoordinates::One(drive) => {
                let joint = joint_state(drive, qpos, qvel);
                vec![if is_rate { joint.rate } else { joint.position }]
            }
            JointCoordinates::Many { qvel: own, .. } if is_rate => qvel[own.clone()].to_vec(),
            JointCoordinates::Many { qpos: own, .. } => numbers(&self.quaternion(own.start)),
        }
    }

    /// What muscles do along a screw to the links that it carries.
    fn pulled(&self, screw: usize, links: &[usize]) -> f64 {
        let mut sum = Wrench::zero();
        links.iter().for_each(|&link| sum += self.ws.wrench[link]);
        if links.is_empty() { 0.0 } else { self.ws.screw[screw].dot(sum) }
    }

    fn limit(&self, number: usize, quantity: JointQuantity) -> f64 {
        let (limit, row) = (&self.plan.limits[number], &self.ws.limit[number]);
        if !row.exists {
            return 0.0;
        }
        let joint = joint_state(&limit.drive, &self.state.qpos, &self.state.qvel);
        let (distance, sign) = within(limit.range, joint.position);
        match quantity {
            JointQuantity::LimitDistance => distance,
            JointQuantity::LimitVelocity => sign * joint.rate,
            _ => row.force(limit.drive.dof.map_or(0.0, |dof| row.slope * self.ws.qacc[dof])),
        }
    }

    fn muscle(&self, muscle: usize, quantity: MuscleQuantity) -> f64 {
        match quantity {
            MuscleQuantity::Length => self.ws.tendon_length[muscle],
            MuscleQuantity::Velocity => self.ws.tendon_velocity[muscle],
            MuscleQuantity::Force => self.ws.muscle_force[muscle],
            // Without a limit there is none to be beyond.
            _ => 0.0,
        }
    }

    fn tendon_limit(&self, number: usize, quantity: MuscleQuantity) -> f64 {
        let (limit, row) = (&self.plan.tendon_limits[number], &self.ws.tendon_limit[number]);
        if !row.exists {
            return 0.0;
        }
        let (distance, sign) = within(limit.range, self.ws.tendon_length[limit.muscle]);
        match quantity {
            MuscleQuantity::LimitDistance => distance - limit.margin,
            MuscleQuantity::LimitVelocity => sign * self.ws.tendon_velocity[limit.muscle],
            _ => {
                let n = self.plan.ndof();
                let jacobian = &self.ws.tendon_limit_jacobian[number * n..][..n];
                row.force(jacobian.iter().zip(&self.ws.qacc).map(|(slope, a)| slope * a).sum())
            }
        }
    }

    fn frame(&self, of: &Seen, quantity: FrameQuantity, seen_from: Option<&Seen>) -> Vec<f64> {
        if quantity == FrameQuantity::Orientation {
            let turn = self.orientation(of);
            return numbers(&seen_from.map_or(turn, |from| self.orientation(from).inverse() * turn));
        }
        let frame = self.ws.fixed(&of.frame);
        let from = seen_from.map(|from| (self.ws.fixed(&from.frame), self.motion(&from.frame)));
        let vector = match quantity {
            FrameQuantity::Position if from.is_none() => self.in_world(frame.position),
            FrameQuantity::Velocity => self.motion(&of.frame).lin,
            FrameQuantity::AngularVelocity => self.motion(&of.frame).ang,
            FrameQuantity::YAxis => frame.rotation.y,
            FrameQuantity::ZAxis => frame.rotation.z,
            FrameQuantity::XAxis | FrameQuantity::Orientation => frame.rotation.x,
            FrameQuantity::Position => frame.position,
        };
        let Some((from, moves)) = from else { return vector.array().into() };
        let apart = frame.position - from.position;
        let seen = match quantity {
            FrameQuantity::Position => apart,
            // What stands still is carried backwards where that turns from which it is seen.
            FrameQuantity::Velocity => vector - moves.lin - moves.ang.cross(apart),
            FrameQuantity::AngularVelocity => vector - moves.ang,
            _ => vector,
        };
        from.rotation.apply_inverse(seen).array().into()
    }

    /// Velocity of the origin of a frame, and how it turns, in axes of the world.
    fn motion(&self, frame: &FixedFrame<f64>) -> Motion<f64> {
        let link = self.ws.velocity[frame.origin.link];
        Motion { ang: link.ang, lin: link.at(self.ws.place(&frame.origin)) }
    }

    /// The same vector in axes of a frame.
    fn own(&self, frame: &FixedFrame<f64>, vector: Vec3<f64>) -> Vec<f64> {
        let Frame { rotation, .. } = self.ws.fixed(frame);
        rotation.apply_inverse(vector).array().into()
    }

    fn in_world(&self, place: Vec3<f64>) -> Vec3<f64> {
        place + Vec3::splat(self.plan.origin)
    }

    fn orientation(&self, seen: &Seen) -> UnitQuaternion<f64> {
        seen.turns.iter().fold(UnitQuaternion::identity(), |before, turn| match turn {
            Turn::Fixed(turn) => before * turn,
            Turn::Hinge(joint, axis) => {
                let angle = self.joint(&self.plan.joints[*joint], false)[0];
                let axis = nalgebra::Unit::new_unchecked(*axis);
                before * UnitQuaternion::from_axis_angle(&axis, angle)
            }
            Turn::Ball(at) => before * self.quaternion(*at),
            Turn::Free(at) => self.quaternion(*at),
        })
    }

    fn quaternion(&self, at: usize) -> UnitQuaternion<f64> {
        let q = &self.state.qpos[at..at + 4];
        UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
    }
}

fn numbers(turn: &UnitQuaternion<f64>) -> Vec<f64> {
    vec![turn.w, turn.i, turn.j, turn.k]
}
