//! The task in numbers.

use super::drive;
use super::{
    DragStep, DriveStep, Handle, PinchStep, Pointer, Shifts, Sines, SteerStep, StepCue, Swing, SwingStep, Waves,
};
use crate::flat::{Action, Block, FlatTask, Object, Order, Shape, Step};
use crate::{InvalidTask, Reward, Stimulus, Task};
use myo_model::StaticBox;
use myo_scalar::Real;
use std::borrow::Cow;

/// Control steps of a dwell of no seconds: less than any physics step.
const AT_ONCE: f64 = 1e-6;
/// How long (s) the fingertip must be off a button for it to be let go: who bounces off it and comes back sooner pressed once. As in the
/// recordings of presses of `myo-measure`.
const BOUNCE_S: f64 = 0.03;
/// The force (N) that an obstacle asks for: none is as great.
pub(super) const NEVER_PRESSED_N: f64 = f32::MAX as f64;
/// What movements cost in full per second, in greatest bonuses: in a quarter of a second as much as is earned at once. What costs more counts
/// for less.
const DEAR: f64 = 4.0;
/// What movements cost is compared with a bonus of at least so much: single precision divides by it.
const LEAST_BONUS: f64 = 1e-6;

/// A task ready to run, with numbers of type `T`: plain ones as it is compiled, one per lane as it runs. Lengths m from the
/// shoulder centre, times in control steps, forces N.
///
/// What is no `T` is its structure: code is compiled for it. All numbers may differ between tasks of one structure, those
/// included that say which object a step asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct CompiledTask<T> {
    /// Spheres, in the order of the scene.
    pub spheres: Vec<DrawnSphere<T>>,
    /// Boxes that can be touched, in the order of the scene.
    pub boxes: Vec<TouchBox<T>>,
    /// What is to do, one after the other.
    pub steps: Vec<TaskStep<T>>,
    /// Which kinds of steps there are.
    pub kinds: Kinds,
    /// Places of groups and boxes that are drawn.
    pub shifts: Shifts<T>,
    /// How each sphere moves; none where all stand still.
    pub waves: Vec<Waves<T>>,
    /// How far and how fast each sphere moves along waves that are drawn; none where none does.
    pub sines: Vec<Sines<T>>,
    /// How each sphere swings about a hinge; none where there are no sticks to be swung.
    pub swings: Vec<Swing<T>>,
    /// Of each step, how it wants a stick; none where there are none to be swung.
    pub swing_steps: Vec<SwingStep<T>>,
    /// Along which line each sphere is driven, a unit vector, or zeros; none where nothing is to be driven.
    pub lines: Vec<[T; 3]>,
    /// Of each step, how it wants a vehicle; none where there are none to be driven.
    pub drive_steps: Vec<DriveStep<T>>,
    /// Handles of sliders, in the order of the scene.
    pub handles: Vec<Handle<T>>,
    /// Of each step, where it wants a handle; none where there are no sliders to be dragged.
    pub drags: Vec<DragStep<T>>,
    /// Of each step, what must be waited for; none where all count at once.
    pub cues: Vec<StepCue<T>>,
    /// Numbers of the objects that steps with a choice choose from.
    pub choices: Vec<T>,
    /// Of each step, one where all the time inside is added up, and two where all the time is; none where there is no such step.
    pub follows: Vec<T>,
    /// Seconds of a control step, where something is tracked or driven.
    pub control_s: Option<T>,
    /// The way of each step; none where no step has one.
    pub steers: Vec<SteerStep<T>>,
    /// Names of other fingers that steps ask for.
    pub fingers: Vec<String>,
    /// Of each step, which of these points instead of the fingertip, or -1; none where always the fingertip does.
    pub leads: Vec<T>,
    /// Of each step and each of these fingers, the number of the sphere where it must be, of the box that it must press, or -1; none where no step asks for that.
    pub also: Vec<Vec<T>>,
    /// Of each step, how fingers must come together; none where no step asks for that.
    pub pinches: Vec<PinchStep<T>>,
    /// Steps that change places with each other; empty where all stand where they are written.
    pub orders: Vec<Order>,
    /// Number of the box that corrects a wrong press, where each must be corrected.
    pub correction: Option<T>,
    /// Control steps after a wrong press in which presses do not count; none where they do, or nothing can be pressed by mistake.
    pub error_pause: Option<T>,
    /// Control steps for which the fingertip must be off a button for it to be let go, and off everything to be lifted.
    pub bounce: T,
    /// What points.
    pub pointer: Pointer<T>,
    /// Control steps until the episode is cut.
    pub time_limit: T,
    /// Control steps until the current step is given up, from when it counts; none where it may take as long as the episode.
    pub step_limit: Option<T>,
    /// Reward weights.
    pub weights: Weights<T>,
}

/// Kinds of steps that code is compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Some step is a dwell.
    pub dwell: bool,
    /// Some step is a press, or a press corrects.
    pub press: bool,
    /// It matters when a button is let go, and what else is pressed: some step asks to let go or must be waited for, there are
    /// several presses or boxes, or wrong presses must be corrected.
    pub release: bool,
    /// Some step is to follow or to track something.
    pub follow: bool,
    /// Some step is to track something.
    pub track: bool,
    /// Some step drags a handle.
    pub drag: bool,
    /// Some step swings a stick, or drives something with it.
    pub swing: bool,
    /// Some step drives something.
    pub drive: bool,
    /// Some step must be waited for.
    pub cue: bool,
    /// Some sphere moves.
    pub motion: bool,
    /// Some sphere moves along waves that are drawn.
    pub sines: bool,
    /// Some step is a way.
    pub steer: bool,
    /// Some step asks another finger to point or press instead of the fingertip.
    pub lead: bool,
    /// Some step asks other fingers to be somewhere, or to press, at the same time.
    pub also: bool,
    /// There are presses, and other fingers that may press.
    pub chord: bool,
    /// Some step is a pinch.
    pub pinch: bool,
    /// What comes next is shown.
    pub next: bool,
    /// Once a movement has begun, its object is not seen any more, but remembered.
    pub memory: bool,
}

/// [`Reward`], with costs per control step.
#[derive(Clone, Debug, PartialEq)]
pub struct Weights<T> {
    /// Per metre.
    pub distance_cost: T,
    /// Where distances count for less (m); none where they count as they are.
    pub distance_scale: Option<T>,
    /// Count the distance from the surface.
    pub inside_is_zero: bool,
    /// Add the path over the targets still to come.
    pub remaining_path: bool,
    /// Per control step.
    pub time_cost: T,
    /// Per target done.
    pub subtask_bonus: T,
    /// For the whole task.
    pub completion_bonus: T,
    /// Per press of a button that was not asked for.
    pub wrong_press: T,
    /// Per time that a way was left.
    pub exit: T,
    /// Per squared control.
    pub effort_cost: T,
    /// Per squared acceleration.
    pub acceleration_cost: T,
    /// Per squared change of a control from one control step to the next; none where it costs nothing.
    pub change_cost: Option<T>,
    /// Per squared force of contact (N^2), in the mean over a control step; none where it costs nothing or there is nothing to touch.
    pub contact_cost: Option<T>,
    /// What these four cost in a control step beyond which more of it counts for less.
    pub dear: T,
    /// How much of these four, of wrong presses and of ways that were left counts: 1, or less for a learner who is to find out first what there is to do.
    pub cost_share: T,
}

/// Where a sphere may lie.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnSphere<T> {
    /// Corner of the box of centres.
    pub lo: [T; 3],
    /// Size of that box.
    pub extent: [T; 3],
    /// Least radius.
    pub radius: T,
    /// Greatest radius minus the least.
    pub radius_extent: T,
    /// Least distance from the object before.
    pub min_distance: T,
    /// That object.
    pub previous: Option<Which>,
    /// Its number among all objects, which its random draws depend on.
    pub number: u32,
}

/// An object by its number among those of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// A sphere.
    Sphere(usize),
    /// A box.
    Box(usize),
}

/// A box that can be touched.
#[derive(Clone, Debug, PartialEq)]
pub struct TouchBox<T> {
    /// Where it is, and how large, with the middle of sizes that are drawn and a ball around the largest; axes of a button: up the face, across it, out of it.
    pub shape: StaticBox<T>,
    /// Force that counts as pressed.
    pub min_force: T,
}

/// Something to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskStep<T> {
    /// One if it is a press, zero if it is a dwell.
    pub is_press: T,
    /// Number of the sphere or box.
    pub object: T,
    /// Control steps to stay in a sphere, a real number, and never zero, so that shares of it can be told.
    pub dwell: T,
    /// One if the button must be let go, too.
    pub releases: T,
}

impl<C: Real> CompiledTask<C> {
    /// Works a task out.
    ///
    /// # Errors
    /// What is wrong with its values.
    pub fn new(task: &Task) -> Result<Self, InvalidTask> {
        Ok(Self::of(task, &task.flat()?))
    }

    /// The same of a task whose [flat form](Task::flat) or [scenery](Task::scenery) this is. Without steps there is nothing to judge: no goal can be
    /// asked for.
    pub fn of(task: &Task, flat: &FlatTask) -> Self {
        let numbers = Numbers::of(flat);
        let sphere = |(number, object): (usize, &Object)| sphere(object, number, &numbers);
        let step = |step: &Step| TaskStep::new(step, numbers.0[step.object], task.control_dt_s);
        let kinds = Kinds::of(flat);
        Self {
            shifts: Shifts::new(flat),
            waves: if kinds.motion { waves(flat, task.control_dt_s) } else { vec![] },
            sines: if kinds.sines { sines(flat, task.control_dt_s) } else { vec![] },
            swings: if kinds.swing { swings(flat, task.control_dt_s) } else { vec![] },
            swing_steps: if kinds.swing { flat.steps.iter().map(SwingStep::new).collect() } else { vec![] },
            lines: if kinds.drive { round(flat).map(drive::line).collect() } else { vec![] },
            drive_steps: if kinds.drive { drive_steps(flat, &numbers) } else { vec![] },
            handles: if kinds.drag { handles(flat) } else { vec![] },
            drags: if kinds.drag { drags(flat) } else { vec![] },
            cues: if kinds.cue { cues(flat, task.control_dt_s) } else { vec![] },
            choices: flat.steps.iter().flat_map(|step| &step.among).map(|&object| numbers.number(object)).collect(),
            follows: if kinds.follow { follows(flat) } else { vec![] },
            control_s: (kinds.track || kinds.drive).then(|| C::from_f64(task.control_dt_s)),
            steers: if kinds.steer { steers(flat, &numbers) } else { vec![] },
            fingers: flat.fingers.clone(),
            leads: if kinds.lead { flat.steps.iter().map(lead).collect() } else { vec![] },
            also: if kinds.also { flat.steps.iter().map(|step| also(step, flat, &numbers)).collect() } else { vec![] },
            pinches: if kinds.pinch {
                flat.steps.iter().map(|step| PinchStep::new(step.pinch.as_ref())).collect()
            } else {
                vec![]
            },
            orders: flat.orders.clone(),
            correction: flat.correction.map(|object| numbers.number(object)),
            error_pause: (kinds.release && task.perception.error_pause_s > 0.0)
                .then(|| C::from_f64((task.perception.error_pause_s / task.control_dt_s).round())),
            bounce: C::from_f64(BOUNCE_S / task.control_dt_s),
            pointer: Pointer::new(flat, task.control_dt_s),
            spheres: flat.objects.iter().enumerate().filter_map(sphere).collect(),
            boxes: flat.objects.iter().filter_map(TouchBox::new).collect(),
            steps: flat.steps.iter().map(step).collect(),
            kinds,
            time_limit: C::from_f64(f64::from(task.time_limit_steps())),
            step_limit: task.step_limit_steps().map(|steps| C::from_f64(f64::from(steps))),
            weights: Weights::new(
                &task.reward,
                task.control_dt_s,
                flat.objects.iter().any(|object| object.block().is_some()),
            ),
        }
    }
}

impl<T> CompiledTask<T> {
    /// Whether it must be remembered since when the current step counts: it is not always since the step before was done.
    pub(super) fn has_cues(&self) -> bool {
        self.kinds.cue || !self.orders.is_empty() || self.step_limit.is_some()
    }

    /// How many fingers may press.
    pub fn pressers(&self) -> usize {
        if self.kinds.chord { 1 + self.fingers.len() } else { 1 }
    }

    /// Whether it matters how hard the fingertip touches: something is pressed, or touching costs something.
    #[inline(always)]
    pub fn is_felt(&self) -> bool {
        self.kinds.press || self.weights.contact_cost.is_some()
    }

    /// The same structure with other numbers: each is what `f` makes of this one, in a fixed order.
    #[inline(always)]
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> CompiledTask<U> {
        CompiledTask {
            spheres: self.spheres.iter().map(|sphere| sphere.map(f)).collect(),
            boxes: self.boxes.iter().map(|each| each.map(f)).collect(),
            steps: self.steps.iter().map(|step| step.map(f)).collect(),
            kinds: self.kinds,
            shifts: self.shifts.map(f),
            waves: self.waves.iter().map(|waves| waves.map(f)).collect(),
            sines: self.sines.iter().map(|sines| sines.map(f)).collect(),
            swings: self.swings.iter().map(|swing| swing.map(f)).collect(),
            swing_steps: self.swing_steps.iter().map(|step| step.map(f)).collect(),
            lines: self.lines.iter().map(|line| line.each_ref().map(&mut *f)).collect(),
            drive_steps: self.drive_steps.iter().map(|step| step.map(f)).collect(),
            handles: self.handles.iter().map(|handle| handle.map(f)).collect(),
            drags: self.drags.iter().map(|drag| drag.map(f)).collect(),
            cues: self.cues.iter().map(|cue| cue.map(f)).collect(),
            choices: self.choices.iter().map(&mut *f).collect(),
            follows: self.follows.iter().map(&mut *f).collect(),
            control_s: self.control_s.as_ref().map(&mut *f),
            steers: self.steers.iter().map(|steer| steer.map(f)).collect(),
            fingers: self.fingers.clone(),
            leads: self.leads.iter().map(&mut *f).collect(),
            also: self.also.iter().map(|step| step.iter().map(&mut *f).collect()).collect(),
            pinches: self.pinches.iter().map(|step| step.map(f)).collect(),
            orders: self.orders.clone(),
            correction: self.correction.as_ref().map(&mut *f),
            error_pause: self.error_pause.as_ref().map(&mut *f),
            bounce: f(&self.bounce),
            pointer: self.pointer.map(f),
            time_limit: f(&self.time_limit),
            step_limit: self.step_limit.as_ref().map(&mut *f),
            weights: self.weights.map(f),
        }
    }
}

impl Kinds {
    fn of(flat: &FlatTask) -> Self {
        let any = |is: fn(&Step) -> bool| flat.steps.iter().any(is);
        let presses = flat.steps.iter().filter(|step| step.dwell_s().is_none()).count();
        let boxes = flat.objects.iter().filter(|object| object.block().is_some()).count();
        let (drag, cue) = (any(|step| matches!(step.action, Action::Drag { .. })), any(|step| step.cue.is_some()));
        let corrects = flat.correction.is_some();
        let moving = || flat.objects.iter().filter_map(|object| object.sphere()?.path.as_ref());
        let chord = (presses > 0 || corrects) && !flat.fingers.is_empty();
        let asks_for_release = chord || drag || corrects || any(|step| step.action == Action::PressAndRelease);
        Self {
            dwell: any(|step| step.dwell_s().is_some()),
            press: presses > 0 || corrects,
            release: asks_for_release || presses > 0 && (cue || presses.max(boxes) > 1),
            follow: any(|step| matches!(step.action, Action::Follow(_) | Action::Track(_))),
            track: any(|step| matches!(step.action, Action::Track(_))),
            drag,
            swing: any(|step| matches!(step.action, Action::Swing { .. } | Action::Drive { .. })),
            drive: any(|step| matches!(step.action, Action::Drive { .. })),
            cue,
            motion: moving().any(|path| path.driven.is_none()),
            sines: moving().any(|path| path.sines.is_some()),
            steer: any(|step| matches!(step.action, Action::Steer { .. })),
            lead: any(|step| step.lead.is_some()),
            also: any(|step| !step.also.is_empty()),
            chord,
            pinch: any(|step| step.pinch.is_some()),
            next: flat.stimulus == Stimulus::All,
            memory: flat.stimulus == Stimulus::BeforeMovement,
        }
    }
}

/// Number of each object among those of its kind.
struct Numbers(Vec<Which>);

impl Numbers {
    fn of(flat: &FlatTask) -> Self {
        let (mut spheres, mut boxes) = (0.., 0..);
        let number = |object: &Object| match object.shape {
            Shape::Sphere(_) | Shape::Stick(_) => Which::Sphere(spheres.next().expect("there is no end")),
            Shape::Button(_) | Shape::Obstacle(_) | Shape::Slider(_) => {
                Which::Box(boxes.next().expect("there is no end"))
            }
        };
        Self(flat.objects.iter().map(number).collect())
    }

    fn number<C: Real>(&self, object: usize) -> C {
        let (Which::Sphere(number) | Which::Box(number)) = self.0[object];
        C::from_f64(number as f64)
    }
}

fn waves<C: Real>(flat: &FlatTask, control_dt_s: f64) -> Vec<Waves<C>> {
    let path = |object: &Object| Waves::new(object.sphere().and_then(|sphere| sphere.path.as_ref()), control_dt_s);
    round(flat).map(path).collect()
}

fn sines<C: Real>(flat: &FlatTask, control_dt_s: f64) -> Vec<Sines<C>> {
    let sines = |object: &Object| {
        Sines::new(object.sphere().and_then(|sphere| sphere.path.as_ref()?.sines.as_ref()), control_dt_s)
    };
    round(flat).map(sines).collect()
}

/// Spheres, and sticks, whose knobs are spheres.
fn round(flat: &FlatTask) -> impl Iterator<Item = &Object> {
    flat.objects.iter().filter(|object| object.is_round())
}

fn handles<C: Real>(flat: &FlatTask) -> Vec<Handle<C>> {
    let handle = |(number, object): (usize, &Object)| match &object.shape {
        Shape::Slider(slider) => Some(Handle::new(slider, number)),
        _ => None,
    };
    flat.objects.iter().enumerate().filter_map(handle).collect()
}

fn drags<C: Real>(flat: &FlatTask) -> Vec<DragStep<C>> {
    let is_slider = |object: &&Object| matches!(object.shape, Shape::Slider(_));
    let slider = |object: usize| flat.objects[..object].iter().filter(is_slider).count();
    flat.steps.iter().map(|step| DragStep::new(step, slider)).collect()
}

fn cues<C: Real>(flat: &FlatTask, control_dt_s: f64) -> Vec<StepCue<C>> {
    let mut first = 0;
    let cue = |step: &Step| {
        let cue = StepCue::new(step, flat, first, control_dt_s);
        first += step.among.len();
        cue
    };
    flat.steps.iter().map(cue).collect()
}

fn follows<C: Real>(flat: &FlatTask) -> Vec<C> {
    let follows = |step: &Step| match step.action {
        Action::Follow(_) => 1.0,
        Action::Track(_) => 2.0,
        _ => 0.0,
    };
    let follows = |step| C::from_f64(follows(step));
    flat.steps.iter().map(follows).collect()
}

fn swings<C: Real>(flat: &FlatTask, control_dt_s: f64) -> Vec<Swing<C>> {
    round(flat).map(|object| Swing::new(object, control_dt_s)).collect()
}

fn drive_steps<C: Real>(flat: &FlatTask, numbers: &Numbers) -> Vec<DriveStep<C>> {
    flat.steps.iter().map(|step| DriveStep::new(step, flat, |object| numbers.number(object))).collect()
}

fn steers<C: Real>(flat: &FlatTask, numbers: &Numbers) -> Vec<SteerStep<C>> {
    flat.steps.iter().map(|step| SteerStep::new(step, |object| numbers.number(object))).collect()
}

/// Which finger points in a step, or -1.
fn lead<C: Real>(step: &Step) -> C {
    C::from_f64(step.lead.map_or(-1.0, |finger| finger as f64))
}

/// Of each finger of a task, the number of the sphere or box where a step wants it, or -1.
fn also<C: Real>(step: &Step, flat: &FlatTask, numbers: &Numbers) -> Vec<C> {
    let of = |finger: usize| {
        let asked = step.also.iter().find(|also| also.finger == finger);
        asked.map_or(C::from_f64(-1.0), |also| numbers.number(also.object))
    };
    (0..flat.fingers.len()).map(of).collect()
}

fn sphere<C: Real>(object: &Object, number: usize, numbers: &Numbers) -> Option<DrawnSphere<C>> {
    let c = C::from_f64;
    let sphere = match &object.shape {
        Shape::Sphere(sphere) => Cow::Borrowed(sphere),
        Shape::Stick(stick) => Cow::Owned(stick.ball()),
        _ => return None,
    };
    let axes = [sphere.region.x, sphere.region.y, sphere.region.z];
    Some(DrawnSphere {
        lo: axes.map(|range| c(range.min)),
        extent: axes.map(|range| c(range.max - range.min)),
        radius: c(sphere.radius.min),
        radius_extent: c(sphere.radius.max - sphere.radius.min),
        min_distance: c(sphere.apart.map_or(0.0, |(_, least)| least)),
        previous: sphere.apart.map(|(previous, _)| numbers.0[previous]),
        number: number as u32,
    })
}

impl<T> DrawnSphere<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> DrawnSphere<U> {
        DrawnSphere {
            lo: self.lo.each_ref().map(&mut *f),
            extent: self.extent.each_ref().map(&mut *f),
            radius: f(&self.radius),
            radius_extent: f(&self.radius_extent),
            min_distance: f(&self.min_distance),
            previous: self.previous,
            number: self.number,
        }
    }
}

impl<C: Real> TouchBox<C> {
    /// Of an object that is a box.
    fn new(object: &Object) -> Option<Self> {
        let (block, largest) = (object.block()?, object.largest()?);
        let column = |k: usize| [0, 1, 2].map(|row| block.rotation[(row, k)]);
        let shape = |block: &Block| StaticBox::new(block.centre, [0, 1, 2].map(column), block.half_extents());
        let shape = StaticBox { radius: shape(&largest).radius, ..shape(block) };
        Some(Self {
            shape: shape.map(&mut |&x| C::from_f64(x)),
            min_force: C::from_f64(block.min_force_n.min(NEVER_PRESSED_N)),
        })
    }
}

impl<T> TouchBox<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> TouchBox<U> {
        TouchBox { shape: self.shape.map(f), min_force: f(&self.min_force) }
    }
}

impl<T: Copy> TouchBox<T> {
    /// All numbers, in the order of the fields.
    #[inline(always)]
    pub(super) fn row(&self) -> [T; 17] {
        let StaticBox { centre: [x, y, z], radius, .. } = self.shape;
        let [a, b, c, e, f, g, i, j, k, h, w, d] = self.shape.sides();
        [x, y, z, a, b, c, e, f, g, i, j, k, h, w, d, radius, self.min_force]
    }

    /// The opposite of [`row`](Self::row).
    #[inline(always)]
    pub(super) fn from_row(row: [T; 17]) -> Self {
        let [x, y, z, a, b, c, e, f, g, i, j, k, h, w, d, radius, min_force] = row;
        let (axes, half_size) = ([[a, b, c], [e, f, g], [i, j, k]], [h, w, d]);
        Self { shape: StaticBox { centre: [x, y, z], axes, half_size, radius }, min_force }
    }
}

impl<C: Real> TaskStep<C> {
    fn new(step: &Step, which: Which, control_dt_s: f64) -> Self {
        let c = C::from_f64;
        let truth = |truth: bool| c(f64::from(u8::from(truth)));
        let (Which::Sphere(object) | Which::Box(object)) = which;
        Self {
            is_press: truth(step.dwell_s().is_none()),
            object: c(object as f64),
            dwell: c(step.dwell_s().map_or(1.0, |seconds| (seconds / control_dt_s).max(AT_ONCE))),
            releases: truth(matches!(step.action, Action::PressAndRelease | Action::Drag { .. })),
        }
    }
}

impl<T> TaskStep<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> TaskStep<U> {
        TaskStep {
            is_press: f(&self.is_press),
            object: f(&self.object),
            dwell: f(&self.dwell),
            releases: f(&self.releases),
        }
    }
}

impl<T> Weights<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Weights<U> {
        Weights {
            distance_cost: f(&self.distance_cost),
            distance_scale: self.distance_scale.as_ref().map(&mut *f),
            inside_is_zero: self.inside_is_zero,
            remaining_path: self.remaining_path,
            time_cost: f(&self.time_cost),
            subtask_bonus: f(&self.subtask_bonus),
            completion_bonus: f(&self.completion_bonus),
            wrong_press: f(&self.wrong_press),
            exit: f(&self.exit),
            effort_cost: f(&self.effort_cost),
            acceleration_cost: f(&self.acceleration_cost),
            change_cost: self.change_cost.as_ref().map(&mut *f),
            contact_cost: self.contact_cost.as_ref().map(&mut *f),
            dear: f(&self.dear),
            cost_share: f(&self.cost_share),
        }
    }
}

impl<C: Real> Weights<C> {
    fn new(reward: &Reward, control_dt_s: f64, has_boxes: bool) -> Self {
        let (c, reward) = (C::from_f64, reward.per_second(control_dt_s));
        let per_step = |per_second: f64| c(per_second * control_dt_s);
        let bonus = reward.subtask_bonus.max(reward.completion_bonus);
        // Where nothing is earned there is nothing to compare with.
        let greatest_bonus = if bonus > 0.0 { bonus.max(LEAST_BONUS) } else { 1e12 };
        Self {
            distance_cost: per_step(reward.distance_cost),
            distance_scale: (reward.distance_scale_m > 0.0).then(|| c(reward.distance_scale_m)),
            inside_is_zero: reward.inside_is_zero,
            remaining_path: reward.remaining_path,
            time_cost: per_step(reward.time_cost),
            subtask_bonus: c(reward.subtask_bonus),
            completion_bonus: c(reward.completion_bonus),
            wrong_press: c(reward.wrong_press),
            exit: c(reward.exit),
            effort_cost: per_step(reward.effort_cost),
            acceleration_cost: per_step(reward.acceleration_cost),
            // Per second of a rate squared: a change over one control step is a rate times it.
            change_cost: (reward.control_change_cost > 0.0).then(|| c(reward.control_change_cost / control_dt_s)),
            contact_cost: (has_boxes && reward.contact_cost > 0.0).then(|| per_step(reward.contact_cost)),
            dear: per_step(DEAR * greatest_bonus),
            cost_share: c(1.0),
        }
    }
}
