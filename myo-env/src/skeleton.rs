//! From the state of one environment to poses: where bodies, muscles, fingertip and objects are.

use crate::config::BuildError;
use crate::digits::{Digit, digits, tip};
use crate::snapshot::Snapshot;
use crate::vector::EnvError;
use myo_dynamics::spatial::{Frame, Rotation, Vec3};
use myo_dynamics::step::wrap::{Round, points};
use myo_dynamics::{CouplingMode, Plan, Workspace, step};
use myo_model::Model;
use myo_model::model::{Muscle, Over, WORLD};
use myo_tasks::logic::{self, CompiledTask, Goal, Landmarks, Point, TaskState};
use myo_tasks::{Block, Direction, FlatTask, Object, Pointer, RayFrom, Shape, Slider, Stick, Task};

/// Bodies lighter than this (kg) only carry joints.
const LEAST_MASS: f64 = 0.05;

/// Bodies that carry no more than this (kg) are points of muscles that move with a joint.
const MARKER: f64 = 1.2e-3;

/// Points that stand for the bend of a muscle path over something.
const BEND_POINTS: usize = 7;

/// A model and a task, ready to tell where everything is at a moment of an environment: what viewers draw, and nothing about
/// drawing. Positions come from the kinematics of the physics, in double precision.
///
/// ```
/// use myo_env::{CpuEnv, EnvConfig, Role, Skeleton, VectorEnv};
///
/// let task = myo_tasks::preset("pointing-uitb").unwrap();
/// let model = myo_model::Model::new(&myo_model::builtin(&task.model)?)?;
/// let env = CpuEnv::new(&model, &task, &EnvConfig { num_envs: 1000, ..Default::default() })?;
/// let skeleton = Skeleton::new(&model, &task)?;
/// for moment in env.peek(7..9)? {
///     let pose = skeleton.pose(&moment)?;
///     let [x, y, z] = pose.fingertip;
///     println!("The fingertip is at {x:.3}, {y:.3}, {z:.3} m.");
///     assert_eq!(pose.objects[0].role, Role::Current);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Skeleton {
    model: Model,
    plan: Plan<f64>,
    limb: Vec<usize>,
    digits: Vec<Digit>,
    flat: FlatTask,
    task: CompiledTask<f64>,
    /// Of each object, its number among the spheres, or among the boxes.
    numbers: Vec<usize>,
}

/// Where everything is at one moment. Lengths in m from the shoulder centre, world axes: x forward, y to the left, z up.
#[derive(Clone, Debug)]
pub struct SkeletonPose {
    /// Axes and origins of the bodies, in the order of the model, the world first.
    pub bodies: Vec<Frame<f64>>,
    /// The muscles, in the order of the model.
    pub muscles: Vec<MusclePose>,
    /// The point that presses.
    pub fingertip: [f64; 3],
    /// The tips of the model's other [fingers](Model::fingers).
    pub fingers: Vec<[f64; 3]>,
    /// What points: the fingertip, or what the technique makes of the posture, or the finger that the step asks for.
    pub pointer: [f64; 3],
    /// Where a ray begins that points.
    pub ray_from: Option<[f64; 3]>,
    /// What stands there, in the order of the [task](Skeleton::task).
    pub objects: Vec<ObjectPose>,
    /// Index of the step that is to do; none once all are done.
    pub step: Option<usize>,
    /// Index of the object that it asks for; none once all steps are done, and before one of several lights up.
    pub current: Option<usize>,
}

/// A bone as it can be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bone {
    /// Bodies that its ends are fixed to.
    pub bodies: [usize; 2],
    /// Its ends, as seen in these (m).
    pub ends: [[f64; 3]; 2],
}

/// A muscle at one moment.
#[derive(Clone, Debug)]
pub struct MusclePose {
    /// Its path from origin to insertion: straight lines from point to point (m), whose length is the one in the physics, short of arcs; behind a pulley it goes back the way it came to
    /// where the branch begins. Where it may bend over something, seven points lie on the arc, or on the straight line while it does not bend.
    pub points: Vec<[f64; 3]>,
    /// Its activation in [0, 1].
    pub activation: f64,
}

/// An object at one moment.
#[derive(Clone, Debug)]
pub struct ObjectPose {
    /// Its centre and own axes, of a stick those of its knob; those of a box are x up its upright face, y across it to the left, z out of it.
    pub frame: Frame<f64>,
    /// Half its size along each own axis (m); for a sphere or a knob three times the radius.
    pub half_size: [f64; 3],
    /// The handle of a slider that the task drags: centre and axes, half sizes (m).
    pub handle: Option<(Frame<f64>, [f64; 3])>,
    /// The hinge of a stick (m).
    pub hinge: Option<[f64; 3]>,
    /// The value that a slider stands at, in its range, or the angle of a stick (degrees).
    pub value: Option<f64>,
    /// Its part in the task.
    pub role: Role,
}

/// What an object is to the task at one moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The current step asks for it.
    Current,
    /// A later step asks for it.
    Later,
    /// All steps that ask for it are done.
    Done,
    /// No step asks for it.
    Bystander,
}

impl Skeleton {
    /// For a model and a task.
    ///
    /// # Errors
    /// The model cannot be simulated, or the task has values out of bounds.
    pub fn new(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::on(task.flat()?, model, task)
    }

    /// For a model and a task whose script does not count, since [`Rules`](crate::Rules) of one's own judge.
    ///
    /// # Errors
    /// As for [`new`](Self::new); the task has a technique.
    pub fn without_script(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::on(task.scenery()?, model, task)
    }

    fn on(flat: FlatTask, model: &Model, task: &Task) -> Result<Self, BuildError> {
        let is_round = |index: usize| flat.objects[index].is_round();
        let number = |index: usize| (0..index).filter(|&other| is_round(other) == is_round(index)).count();
        let task = CompiledTask::of(task, &flat);
        let plan = Plan::exact(model, CouplingMode::Reduced)?.with_fingers(model, &task.fingers)?;
        let limb = limb(model);
        Ok(Self {
            model: model.clone(),
            plan: if task.pointer.is_ray() { plan.with_arm(model)? } else { plan },
            digits: limb.last().map_or_else(Vec::new, |&hand| digits(model, hand)),
            limb,
            numbers: (0..flat.objects.len()).map(number).collect(),
            flat,
            task,
        })
    }

    /// The model: names, parents of bodies, paths of muscles.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Objects and steps of the task, with their names.
    pub fn task(&self) -> &FlatTask {
        &self.flat
    }

    /// Names of the independent joints, in the order of `qpos`.
    pub fn joint_names(&self) -> impl Iterator<Item = &str> {
        self.plan.dofs.iter().map(|dof| &*dof.name)
    }

    /// Indices of the bodies with mass on the way from the upper arm down to the fingertip, the upper arm first.
    pub fn limb(&self) -> &[usize] {
        &self.limb
    }

    /// Fingers and thumb that move beyond the last body of the [limb](Self::limb).
    pub fn digits(&self) -> &[Digit] {
        &self.digits
    }

    /// Whether it is the arm of a person who faces along x: that of one whose size is known, or one that tells its elbow and wrist. Of any
    /// other body only its own bones and muscles can be drawn.
    pub fn is_person(&self) -> bool {
        self.model.stature_m.is_some() || (self.model.elbow_body.is_some() && self.model.wrist_body.is_some())
    }

    /// Its bones as they can be drawn: from joint to joint of bodies that carry mass or lead to the fingertip, and on to where the last of them end.
    pub fn bones(&self) -> Vec<Bone> {
        let bodies = &self.model.bodies;
        let mut carried: Vec<f64> = bodies.iter().map(|body| body.mass).collect();
        for body in (1..bodies.len()).rev() {
            let below = carried[body];
            carried[bodies[body].parent] += below;
        }
        let is_of_finger = |body: usize| self.digits.iter().any(|digit| digit.bodies.contains(&body));
        let pointing = self.model.sites[self.model.fingertip_site].body;
        let up = |&body: &usize| (body != WORLD).then(|| bodies[body].parent);
        let pointed: Vec<usize> = std::iter::successors(Some(pointing), up).collect();
        let is_drawn = |&body: &usize| carried[body] > MARKER || is_of_finger(body) || pointed.contains(&body);
        let drawn: Vec<usize> = (1..bodies.len()).filter(is_drawn).collect();
        let hung = drawn.iter().filter(|&&body| bodies[body].parent != WORLD).map(|&body| {
            let parent = bodies[body].parent;
            Bone { bodies: [parent, body], ends: [self.joint(parent), self.joint(body)] }
        });
        let is_last = |&&body: &&usize| body == pointing || drawn.iter().all(|&other| bodies[other].parent != body);
        let last = drawn
            .iter()
            .filter(is_last)
            .map(|&body| Bone { bodies: [body; 2], ends: [self.joint(body), tip(&self.model, body)] });
        hung.chain(last).collect()
    }

    /// Where a body turns, as seen in it (m): its first joint, or its origin.
    fn joint(&self, body: usize) -> [f64; 3] {
        let joint = self.model.joints.iter().find(|joint| joint.body == body);
        joint.map_or([0.0; 3], |joint| joint.pos.into())
    }

    /// Whether fingers move and nothing from the trunk to the elbow does.
    pub fn moves_hand_only(&self) -> bool {
        let Some(elbow) = self.model.elbow_body.filter(|_| !self.digits.is_empty()) else { return false };
        let up = |&body: &usize| (body != WORLD).then(|| self.model.bodies[body].parent);
        let is_held = |body: usize| self.model.joints.iter().all(|joint| joint.body != body);
        std::iter::successors(Some(elbow), up).all(is_held)
    }

    /// Of each point of a muscle's path, the body that it lies on.
    ///
    /// # Panics
    /// There is no such muscle.
    pub fn path_bodies(&self, muscle: usize) -> Vec<usize> {
        let bend = |over: &Over, _: [usize; 2]| vec![self.model.wraps[over.wrap].body; BEND_POINTS];
        along(&self.model.muscles[muscle], |site| self.model.sites[site].body, bend)
    }

    /// Where everything is at a moment of an environment with this model and task.
    ///
    /// # Errors
    /// [`EnvError::WrongLength`] where the moment is of another model or task.
    pub fn pose(&self, moment: &Snapshot) -> Result<SkeletonPose, EnvError> {
        self.check(moment)?;
        let ws = self.posed(&moment.body.qpos);
        let ahead = self.ahead(&moment.task);
        let step = ahead.first().copied();
        let body = self.landmarks(&ws, &moment.task);
        let ray_from = self.plan.arm.is_some().then_some(match &self.flat.pointer {
            Pointer::Ray { from: RayFrom::Forearm, .. } => body.wrist,
            _ => body.fingertip,
        });
        let corrects = moment.task.corrects() == Some(true);
        let asked_for = || step.and_then(|step| self.asked_for(step, &moment.task));
        let current = if corrects { self.flat.correction } else { asked_for() };
        Ok(SkeletonPose {
            bodies: self.plan.elements.bodies.iter().map(|body| ws.fixed(body)).collect(),
            muscles: self.muscles(&ws, &moment.body.act),
            fingertip: body.fingertip,
            fingers: self.model.fingers.iter().map(|&(_, site)| self.site(&ws, site)).collect(),
            pointer: self.pointer(&body, &moment.task),
            ray_from,
            objects: (0..self.flat.objects.len())
                .map(|index| self.object(index, &moment.task, &ahead, current))
                .collect(),
            step,
            current,
        })
    }

    fn pointer(&self, body: &Landmarks<f64>, state: &TaskState<f64>) -> Point<f64> {
        if self.flat.steps.is_empty() {
            // Without a script only the fingertip points.
            return body.fingertip;
        }
        let goal = Goal::of(&self.task, state);
        goal.pointer(&self.task, body, goal.centre)
    }

    fn check(&self, moment: &Snapshot) -> Result<(), EnvError> {
        let (Snapshot { body, task, .. }, spheres) = (moment, self.task.spheres.len());
        let fresh = TaskState::<f64>::new(&self.task);
        let lengths = [
            ("qpos of the snapshot", body.qpos.len(), self.plan.ndof()),
            ("act of the snapshot", body.act.len(), self.plan.nmuscle()),
            ("task.position of the snapshot", task.position.len(), spheres),
            ("task.size of the snapshot", task.size.len(), spheres),
            ("task.phases of the snapshot", task.phases.len(), self.task.waves.len()),
            ("task.values of the snapshot", task.values.len(), self.task.handles.len()),
            ("task.done_at of the snapshot", task.done_at.len(), self.task.steps.len()),
            ("task.order of the snapshot", task.order.len(), fresh.order.len()),
            ("task.cue of the snapshot", usize::from(task.cue.is_some()), usize::from(fresh.cue.is_some())),
            (
                "task.steering of the snapshot",
                usize::from(task.steering.is_some()),
                usize::from(fresh.steering.is_some()),
            ),
            (
                "task.sticks of the snapshot",
                task.sticks.as_ref().map_or(0, |sticks| sticks.angles.len()),
                fresh.sticks.as_ref().map_or(0, |sticks| sticks.angles.len()),
            ),
            (
                "task.vehicles of the snapshot",
                task.vehicles.as_ref().map_or(0, |vehicles| vehicles.along.len()),
                fresh.vehicles.as_ref().map_or(0, |vehicles| vehicles.along.len()),
            ),
            ("task.shifts of the snapshot", task.shifts.len(), fresh.shifts.len()),
            ("task.seen of the snapshot", usize::from(task.seen.is_some()), usize::from(fresh.seen.is_some())),
            ("task.cursor of the snapshot", usize::from(task.cursor.is_some()), usize::from(fresh.cursor.is_some())),
            (
                "task.given_up of the snapshot",
                usize::from(task.given_up.is_some()),
                usize::from(fresh.given_up.is_some()),
            ),
            ("task.open of the snapshot", usize::from(task.open.is_some()), usize::from(fresh.open.is_some())),
            ("task.errors of the snapshot", usize::from(task.errors.is_some()), usize::from(fresh.errors.is_some())),
        ];
        match lengths.into_iter().find(|(_, got, expected)| got != expected) {
            Some((what, got, expected)) => Err(EnvError::WrongLength { what, got, expected }),
            None => Ok(()),
        }
    }

    /// The body in this position, at rest.
    fn posed(&self, qpos: &[f64]) -> Workspace<f64> {
        let mut ws = Workspace::new(&self.plan);
        step::kinematics::kinematics(&self.plan, qpos, &vec![0.0; qpos.len()], &mut ws);
        ws
    }

    fn muscles(&self, ws: &Workspace<f64>, act: &[f64]) -> Vec<MusclePose> {
        let pose = |(muscle, &activation): (&Muscle, &f64)| MusclePose { points: self.path(ws, muscle), activation };
        self.model.muscles.iter().zip(act).map(pose).collect()
    }

    /// Where a site of the model is (m).
    fn site(&self, ws: &Workspace<f64>, site: usize) -> Point<f64> {
        ws.place(&self.plan.elements.sites[site]).array()
    }

    fn path(&self, ws: &Workspace<f64>, muscle: &Muscle) -> Vec<[f64; 3]> {
        let site = |site: usize| ws.place(&self.plan.elements.sites[site]);
        let bend = |over: &Over, ends: [usize; 2]| {
            let shape = &self.model.wraps[over.wrap].shape;
            let frame = ws.fixed(&self.plan.elements.wraps[over.wrap]);
            let rule = self.model.options.side_rule;
            let round = Round { shape: shape.into(), rule, radius: shape.radius(), frame };
            let bent = points(&round, over.side.map(site), ends.map(site), BEND_POINTS);
            bent.into_iter().map(Vec3::array).collect()
        };
        along(muscle, |here| site(here).array(), bend)
    }

    fn landmarks(&self, ws: &Workspace<f64>, task: &TaskState<f64>) -> Landmarks<f64> {
        let fingertip = step::fingertip(&self.plan, ws);
        let arm = self.plan.arm.as_ref().map(|arm| arm.each_ref().map(|point| ws.place(point).array()));
        let [elbow, wrist] = arm.unwrap_or([fingertip; 2]);
        let cursor = task.cursor.unwrap_or_default();
        let mut landmarks = Landmarks { fingertip, elbow, wrist, cursor, ..Landmarks::unknown() };
        for (finger, place) in landmarks.fingers.iter_mut().zip(step::fingers(&self.plan, ws)) {
            *finger = place;
        }
        landmarks
    }

    /// Steps that are not done, the current one first.
    fn ahead(&self, task: &TaskState<f64>) -> Vec<usize> {
        let done = task.phase.round() as usize;
        let at = |place: usize| task.order.get(place).map_or(place, |&step| step as usize);
        (done..self.flat.steps.len()).map(at).collect()
    }

    fn object(&self, index: usize, task: &TaskState<f64>, ahead: &[usize], current: Option<usize>) -> ObjectPose {
        let Object { shape, shift, growth, .. } = &self.flat.objects[index];
        let shift = shift.map_or([0.0; 3], |shift| task.shifts[shift.number]);
        let moved = |place: Point<f64>| [0, 1, 2].map(|k| place[k] + shift[k]);
        let growth = growth.map_or([0.0; 3], |growth| task.shifts[growth.number]);
        let boxed = |block: &Block| {
            let half_size = block.half_extents();
            (frame(moved(block.centre), axes(block)), [0, 1, 2].map(|k| half_size[k] + growth[k]))
        };
        let (frame, half_size) = match shape {
            Shape::Sphere(_) => {
                let (centre, radius, _) = logic::sphere(&self.task, task, self.numbers[index] as f64);
                (frame(centre, Rotation::identity()), [radius; 3])
            }
            Shape::Stick(stick) => {
                let (hinge, arm) = (moved(stick.hinge), stick.arm(self.angle(index, stick, task)));
                let knob = [0, 1, 2].map(|k| hinge[k] + arm[k]);
                (frame(knob, Rotation::identity()), [stick.knob; 3])
            }
            Shape::Button(block) | Shape::Obstacle(block) | Shape::Slider(Slider { block, .. }) => boxed(block),
        };
        let (mut handle, mut hinge, mut value) = (None, None, None);
        match shape {
            Shape::Slider(slider) => {
                let share = self.share(index, task);
                (handle, value) = share.map(|share| (way_handle(slider, share, moved), slider.value(share))).unzip();
            }
            Shape::Stick(stick) => {
                hinge = Some(moved(stick.hinge));
                value = Some(self.angle(index, stick, task).to_degrees());
            }
            _ => {}
        }
        ObjectPose { frame, half_size, handle, hinge, value, role: self.role(index, ahead, current) }
    }

    /// Where the handle of a slider stands, as a share of its way.
    fn share(&self, index: usize, task: &TaskState<f64>) -> Option<f64> {
        let slider = self.task.handles.iter().position(|handle| handle.number as usize == index)?;
        task.values.get(slider).copied()
    }

    /// The angle of a stick (rad); how it is described where none is ever swung.
    fn angle(&self, index: usize, stick: &Stick, task: &TaskState<f64>) -> f64 {
        task.sticks.as_ref().map_or(stick.start.min, |sticks| sticks.angles[self.numbers[index]])
    }

    /// The object that a step asks for; none before one of several lights up.
    fn asked_for(&self, step: usize, task: &TaskState<f64>) -> Option<usize> {
        let step = &self.flat.steps[step];
        match &task.cue {
            Some(cue) if !step.among.is_empty() => {
                let is_it = |&object: &usize| cue.lit_at <= task.step && self.numbers[object] == cue.object as usize;
                step.objects().find(is_it)
            }
            _ => Some(step.object),
        }
    }

    fn role(&self, object: usize, ahead: &[usize], current: Option<usize>) -> Role {
        let steps = &self.flat.steps;
        let also = |&step: &usize| steps[step].also.iter().any(|also| also.object == object);
        match current {
            Some(current) if current == object || ahead.first().is_some_and(also) => Role::Current,
            _ if ahead.iter().any(|&step| steps[step].involves(object)) => Role::Later,
            _ if steps.iter().any(|step| step.involves(object)) => Role::Done,
            _ => Role::Bystander,
        }
    }
}

/// Frame and half sizes (m) of a handle at a share of its way.
fn way_handle(slider: &Slider, share: f64, moved: impl Fn(Point<f64>) -> Point<f64>) -> (Frame<f64>, [f64; 3]) {
    let [mut height, mut width, depth] = slider.block.half_extents();
    match slider.rises {
        Direction::Right => width = 0.5 * slider.handle,
        Direction::Up => height = 0.5 * slider.handle,
    }
    (frame(moved(slider.handle_at(share)), axes(&slider.block)), [height, width, depth])
}

/// Bodies with mass on the way from the upper arm to the fingertip.
fn limb(model: &Model) -> Vec<usize> {
    let mut chain = vec![];
    let mut body = model.sites[model.fingertip_site].body;
    while body != WORLD {
        let here = &model.bodies[body];
        if here.mass > LEAST_MASS {
            chain.push(body);
        }
        body = here.parent;
    }
    chain.reverse();
    // The girdle lies in the trunk.
    let first = chain.iter().position(|&index| model.bodies[index].name.contains("humer")).unwrap_or(0);
    chain.split_off(first)
}

fn frame([x, y, z]: Point<f64>, rotation: Rotation<f64>) -> Frame<f64> {
    Frame { rotation, position: Vec3::new(x, y, z) }
}

/// A box's own axes in the world.
fn axes(block: &Block) -> Rotation<f64> {
    let column = |k: usize| Vec3::new(block.rotation[(0, k)], block.rotation[(1, k)], block.rotation[(2, k)]);
    Rotation { x: column(0), y: column(1), z: column(2) }
}

/// The line that a muscle is drawn as: what `site` makes of each site of its path, and `bend` of what runs over something between two of them. Behind a pulley it goes back the way it
/// came to where the branch begins; straight there if that is no place on its way.
fn along<T: Clone>(muscle: &Muscle, site: impl Fn(usize) -> T, bend: impl Fn(&Over, [usize; 2]) -> Vec<T>) -> Vec<T> {
    let (mut line, mut ways): (Vec<T>, Vec<Way<T>>) = (vec![], vec![]);
    for (element, &here) in muscle.path.iter().enumerate() {
        let begins = muscle.pulleys.iter().any(|pulley| pulley.before == element);
        let from = element.checked_sub(1).filter(|_| !begins);
        let bends = |from: usize| {
            let over = muscle.over.iter().find(|over| over.after == from);
            over.map_or_else(Vec::new, |over| bend(over, [muscle.path[from], here]))
        };
        let mut way = Way { from, over: from.map_or_else(Vec::new, bends) };
        let before = muscle.path[..element].iter().rposition(|&site| begins && site == here);
        let mut is_there = false;
        if let Some(before) = before {
            let mut at = element - 1;
            while let Some(next) = ways[at].from.filter(|_| muscle.path[at] != here) {
                line.extend(ways[at].over.iter().rev().cloned());
                line.push(site(muscle.path[next]));
                at = next;
            }
            is_there = muscle.path[at] == here;
            // On from here it is the same place.
            way = ways[before].clone();
        } else {
            line.extend(way.over.iter().cloned());
        }
        if !is_there {
            line.push(site(here));
        }
        ways.push(way);
    }
    line
}

/// How a path comes to an element.
#[derive(Clone)]
struct Way<T> {
    /// From which one; from none to the first.
    from: Option<usize>,
    /// What it runs over on the way.
    over: Vec<T>,
}

#[cfg(test)]
mod tests {
    use myo_model::model::Pulley;
    use myo_model::{Model, builtin};

    use super::*;

    #[test]
    fn a_line_goes_back_along_itself_to_where_a_branch_begins() {
        let model = Model::new(&builtin("mobl-arms").unwrap()).unwrap();
        let pulley = |before| Pulley { before, divisor: 2.0 };
        let muscle = Muscle {
            path: vec![1, 2, 3, 4, 2, 5, 9, 8],
            over: vec![Over { after: 2, wrap: 0, side: None }],
            // One branch begins on the way of the first, one elsewhere.
            pulleys: vec![pulley(4), pulley(6)],
            ..model.muscles[0].clone()
        };
        let bend = |_: &Over, [from, to]: [usize; 2]| vec![10 * from + to; 2];
        assert_eq!(along(&muscle, |site| site, bend), [1, 2, 3, 34, 34, 4, 34, 34, 3, 2, 5, 9, 8]);
        // However many branches begin, each farther back, none goes back along what others went back.
        let many = Muscle {
            path: vec![1, 2, 3, 4, 3, 5, 2, 6, 1, 7],
            pulleys: vec![pulley(4), pulley(6), pulley(8)],
            over: vec![],
            ..muscle.clone()
        };
        assert_eq!(along(&many, |site| site, bend), [1, 2, 3, 4, 3, 5, 3, 2, 6, 2, 1, 7]);
        let whole = Muscle { pulleys: vec![], ..muscle };
        assert_eq!(along(&whole, |site| site, bend), [1, 2, 3, 34, 34, 4, 2, 5, 9, 8]);
    }
}
