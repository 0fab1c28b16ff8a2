//! The numbers of a task, which may change without anything being compiled again.

use crate::tables::Tables;
use myo_dynamics::{Obstacles, Plan};
use myo_muscle::{Fatigue, FatigueRates, MotorNoise, MuscleGroup};
use myo_scalar::{Real, Scalar};
use myo_tasks::logic::{CompiledTask, Shifts};
use myo_tasks::{Control, FlatTask, Pose, Reset, Task};

/// Least and greatest position of a joint (rad), where it has limits.
pub(crate) type JointRange = Option<[f64; 2]>;

/// All numbers of a task, of type `T`.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters<T> {
    /// What is to do.
    pub task: CompiledTask<T>,
    /// What actions ask of muscles.
    pub control: Control,
    /// Motor noise.
    pub noise: Option<Motor<T>>,
    /// Stretch reflexes.
    pub reflex: Option<Reflex<T>>,
    /// Fatigue.
    pub fatigue: Option<Tiring<T>>,
    /// How far off targets seem.
    pub vision_noise: Option<Vision<T>>,
    /// How episodes begin.
    pub start: Start<T>,
}

/// Motor noise of all muscles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor<T> {
    /// Standard deviations: signal-dependent, constant.
    pub deviations: [T; 2],
    /// How it changes.
    pub process: MotorNoise<T>,
}

/// Stretch reflexes of all muscles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflex<T> {
    /// By how much of itself an excitation grows, per greatest shortening speed at which the muscle lengthens.
    pub gain: T,
    /// By how much of itself it changes at most.
    pub most: T,
}

/// Fatigue of all muscles.
#[derive(Clone, Debug, PartialEq)]
pub struct Tiring<T> {
    /// How those tire that move one joint.
    pub groups: Vec<Fatigue<T>>,
    /// To which of these each muscle belongs.
    pub group: Vec<usize>,
    /// Greatest share that is fatigued at the start.
    pub initial: T,
    /// Whether it lasts from one episode to the next.
    pub lasts: bool,
}

/// How far off targets seem.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vision<T> {
    /// Standard deviation, as a share of their distance.
    pub share: T,
    /// How much of it a control step leaves as it is, and how much of what is drawn anew it adds.
    pub kept: T,
    pub fresh: T,
}

/// Distribution of the body's state at the start of an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct Start<T> {
    /// Joint positions.
    pub pose: Poses<T>,
    /// Joint positions where environments explore: within all that the joints allow.
    pub any_pose: Poses<T>,
    /// Greatest speed, either way.
    pub speed: T,
    /// Greatest activation.
    pub activation: T,
}

/// Joint positions, uniform in intervals (rad).
#[derive(Clone, Debug, PartialEq)]
pub struct Poses<T> {
    lowest: Vec<T>,
    width: Vec<T>,
}

/// What a control step runs on: tables, and numbers of the lanes' own.
pub struct World<'a, S: Scalar> {
    /// What is the same for all.
    pub tables: &'a Tables<S::Const>,
    /// The numbers.
    pub parameters: Parameters<S>,
    /// What fingers can press, where these numbers say.
    pub obstacles: Obstacles<S::Const, S>,
}

impl<C: Real> Parameters<C> {
    /// Those of a task of this flat form, for a body whose joints have these ranges (rad) and whose muscles move these joints.
    pub(crate) fn new(task: &Task, flat: &FlatTask, ranges: &[JointRange], groups: &[Option<MuscleGroup>]) -> Self {
        Self {
            task: CompiledTask::of(task, flat),
            control: task.control,
            noise: Motor::new(task),
            reflex: Reflex::new(task),
            fatigue: Tiring::new(task, groups),
            vision_noise: Vision::new(task),
            start: Start::new(task, ranges),
        }
    }

    /// These numbers where others were, which code was compiled for.
    ///
    /// # Errors
    /// What differs in structure, as half a sentence.
    pub(crate) fn in_place_of(mut self, others: &Self) -> Result<Self, String> {
        if others.noise.is_some() {
            // Noise of no size is noise all the same.
            let silent = |motor| Motor { deviations: [C::from_f64(0.0); 2], ..motor };
            self.noise = self.noise.or(others.noise.map(silent));
        }
        if others.reflex.is_some() {
            let idle = |reflex| Reflex { gain: C::from_f64(0.0), ..reflex };
            self.reflex = self.reflex.or(others.reflex.map(idle));
        }
        if let Some(tiring) = &others.fatigue {
            self.fatigue = self.fatigue.or_else(|| Some(tiring.none()));
        }
        if others.task.weights.change_cost.is_some() {
            let cost = &mut self.task.weights.change_cost;
            *cost = cost.or(Some(C::from_f64(0.0)));
        }
        if others.task.error_pause.is_some() {
            let pause = &mut self.task.error_pause;
            *pause = pause.or(Some(C::from_f64(0.0)));
        }
        if others.task.weights.contact_cost.is_some() {
            let cost = &mut self.task.weights.contact_cost;
            *cost = cost.or(Some(C::from_f64(0.0)));
        }
        if others.vision_noise.is_some() {
            let clear = |vision| Vision { share: C::from_f64(0.0), ..vision };
            self.vision_noise = self.vision_noise.or(others.vision_noise.map(clear));
        }
        let (new, old) = (self.map(&mut |_| ()), others.map(&mut |_| ()));
        match new.difference(&old) {
            Some(what) => Err(what),
            None => Ok(self),
        }
    }
}

impl<T> Parameters<T> {
    /// The same structure with other numbers: each is what `f` makes of this one, in a fixed order.
    #[inline(always)]
    pub fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Parameters<U> {
        Parameters {
            task: self.task.map(f),
            control: self.control,
            noise: self.noise.as_ref().map(|noise| noise.map(f)),
            reflex: self.reflex.as_ref().map(|reflex| reflex.map(f)),
            fatigue: self.fatigue.as_ref().map(|tiring| tiring.map(f)),
            vision_noise: self.vision_noise.as_ref().map(|vision| vision.map(f)),
            start: self.start.map(f),
        }
    }
}

impl Parameters<()> {
    /// What differs from another structure, as half a sentence.
    fn difference(&self, other: &Self) -> Option<String> {
        let (ours, theirs) = (&self.task, &other.task);
        for (word, new, old) in [
            ("steps", ours.steps.len(), theirs.steps.len()),
            ("spheres", ours.spheres.len(), theirs.spheres.len()),
            ("boxes", ours.boxes.len(), theirs.boxes.len()),
            ("places and sizes that are drawn", ours.shifts.spans.len(), theirs.shifts.spans.len()),
        ] {
            if new != old {
                return Some(format!("it has {new} {word} instead of {old}"));
            }
        }
        let (new, old) = (ours.kinds, theirs.kinds);
        for (new, old, with, without) in [
            (new.dwell, old.dwell, "asks for dwells", "asks for no dwell"),
            (new.press, old.press, "asks for presses", "asks for no press"),
            (
                new.release,
                old.release,
                "asks to let go, or has several presses or boxes",
                "does not ask to let go, and has one press and one box",
            ),
            (new.follow, old.follow, "asks to follow something", "asks to follow nothing"),
            (new.drag, old.drag, "asks to drag a slider", "asks to drag nothing"),
            (new.swing, old.swing, "asks to swing a stick", "asks to swing nothing"),
            (new.drive, old.drive, "asks to drive something", "asks to drive nothing"),
            (
                !ours.shifts.sizes.is_empty(),
                !theirs.shifts.sizes.is_empty(),
                "draws sizes of boxes",
                "draws no size of a box",
            ),
            (new.cue, old.cue, "has steps that must be waited for", "has no step that must be waited for"),
            (new.motion, old.motion, "has spheres that move", "has no sphere that moves"),
            (new.steer, old.steer, "has ways to steer along", "has no way to steer along"),
            (new.lead, old.lead, "asks other fingers to lead", "asks no other finger to lead"),
            (new.chord, old.chord, "asks other fingers to press", "asks no other finger to press"),
            (new.also, old.also, "asks where other fingers are", "does not ask where other fingers are"),
            (new.pinch, old.pinch, "asks for pinches", "asks for no pinch"),
            (new.next, old.next, "shows what comes next", "does not show what comes next"),
            (
                new.memory,
                old.memory,
                "hides its objects once a movement has begun",
                "does not hide its objects once a movement has begun",
            ),
            (
                ours.correction.is_some(),
                theirs.correction.is_some(),
                "has wrong presses corrected",
                "has no wrong press corrected",
            ),
        ] {
            if new != old {
                return Some(if new {
                    format!("it {with}, and the other did not")
                } else {
                    format!("it {without}, and the other did")
                });
            }
        }
        for (word, new, old) in [
            ("sliders", ours.handles.len(), theirs.handles.len()),
            ("objects to choose from", ours.choices.len(), theirs.choices.len()),
        ] {
            if new != old {
                return Some(format!("it has {new} {word} instead of {old}"));
            }
        }
        if ours.orders != theirs.orders {
            return Some("other steps of it change places with each other".into());
        }
        if ours.fingers != theirs.fingers {
            return Some("it asks for other fingers".into());
        }
        if ours.pointer != theirs.pointer {
            return Some("its technique is another".into());
        }
        if ours.spheres != theirs.spheres {
            return Some("its spheres and boxes stand in another order".into());
        }
        if ours.weights.change_cost != theirs.weights.change_cost {
            return Some("changing controls costs something where it cost nothing (reward.control_change_cost)".into());
        }
        if ours.error_pause != theirs.error_pause {
            return Some("wrong presses take time where they took none (perception.error_pause_s)".into());
        }
        if ours.weights.contact_cost != theirs.weights.contact_cost {
            return Some("touching costs something where it cost nothing (reward.contact_cost)".into());
        }
        if self.task.weights != other.task.weights {
            return Some(
                "it measures the distance in another way (reward.inside_is_zero, reward.remaining_path, reward.distance_scale_m)".into(),
            );
        }
        if ours.step_limit != theirs.step_limit {
            return Some(
                "its steps may take only so long where they could take any time, or the other way round (step_limit_s)"
                    .into(),
            );
        }
        if self.control != other.control {
            return Some(
                "its actions ask for excitations where they asked for changes, or the other way round (control)".into(),
            );
        }
        if self.noise != other.noise {
            return Some("it has motor noise where there was none".into());
        }
        if self.reflex != other.reflex {
            return Some("its muscles have reflexes where they had none (reflex.gain)".into());
        }
        match (&self.fatigue, &other.fatigue) {
            (Some(_), None) => return Some("its muscles tire where they did not (fatigue.speed)".into()),
            (Some(new), Some(old)) if new.lasts != old.lasts => {
                return Some("its fatigue lasts from one episode to the next where it did not, or the other way round (fatigue.lasts)".into());
            }
            _ => {}
        }
        if self.vision_noise != other.vision_noise {
            return Some(
                "its targets are seen with noise where they were seen without (perception.vision_noise)".into(),
            );
        }
        (self != other).then(|| "its structure is another".into())
    }
}

impl<C: Real> Parameters<C> {
    /// All numbers in the order of [`map`](Self::map).
    pub(crate) fn numbers(&self) -> Vec<C> {
        let mut numbers = vec![];
        self.map(&mut |&number| numbers.push(number));
        numbers
    }

    /// Which of these is the share of the costs of movement that counts.
    pub(crate) fn cost_share(&self) -> usize {
        let mut places = 0..;
        self.map(&mut |_| places.next().unwrap_or_default()).task.weights.cost_share
    }
}

impl<T: Copy> Parameters<T> {
    /// What fingers can press, of this surface.
    #[inline(always)]
    pub fn obstacles<C: Real>(&self, surface: &Obstacles<C>) -> Obstacles<C, T> {
        let Shifts { boxes, sizes, .. } = &self.task.shifts;
        surface.with(self.task.boxes.iter().map(|each| each.shape).collect(), boxes.clone(), sizes.clone())
    }
}

impl<C: Real> Parameters<C> {
    /// How many boxes of this surface each finger of a plan can touch at once, at most.
    pub(crate) fn most_contacts(&self, surface: &Obstacles<C>, plan: &Plan<C>) -> usize {
        let ways: Vec<_> = self.task.shifts.spans.iter().map(|spans| spans.map(|span| span.map(C::to_f64))).collect();
        self.obstacles(surface).most_at_once_moved(plan, &ways)
    }
}

impl<C: Real> Motor<C> {
    /// That of a task; none without.
    fn new(task: &Task) -> Option<Self> {
        let noise = &task.noise;
        let deviations = [noise.signal_dependent, noise.constant];
        let process = MotorNoise::new(task.control_dt_s, noise.held_s).map(&mut |&x| C::from_f64(x));
        let noisy = deviations.iter().any(|&deviation| deviation > 0.0);
        noisy.then(|| Self { deviations: deviations.map(C::from_f64), process })
    }
}

impl<T> Motor<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Motor<U> {
        Motor { deviations: self.deviations.each_ref().map(&mut *f), process: self.process.map(f) }
    }
}

impl<C: Real> Reflex<C> {
    /// Those of a task; none without.
    fn new(task: &Task) -> Option<Self> {
        let [gain, most] = [task.reflex.gain, task.reflex.most].map(C::from_f64);
        (task.reflex.gain > 0.0).then_some(Self { gain, most })
    }
}

impl<T> Reflex<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Reflex<U> {
        Reflex { gain: f(&self.gain), most: f(&self.most) }
    }
}

impl<C: Real> Tiring<C> {
    /// That of a task, for muscles that move these joints; none where none tires.
    fn new(task: &Task, muscles: &[Option<MuscleGroup>]) -> Option<Self> {
        let settings = &task.fatigue;
        let mut joints = muscles.to_vec();
        joints.sort_unstable();
        joints.dedup();
        let number = |joint| joints.binary_search(joint).expect("every joint is among them");
        let fatigue = |&joint| Fatigue::new(FatigueRates::of(joint), settings.speed, task.control_dt_s);
        settings.is_on().then(|| Self {
            groups: joints.iter().map(fatigue).collect(),
            group: muscles.iter().map(number).collect(),
            initial: C::from_f64(settings.initial_max),
            lasts: settings.lasts,
        })
    }

    /// The same for muscles that do not tire, and are not tired any more.
    fn none(&self) -> Self {
        let groups = vec![Fatigue::none(); self.groups.len()];
        Self { groups, group: self.group.clone(), initial: C::from_f64(0.0), lasts: self.lasts }
    }
}

impl<T> Tiring<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Tiring<U> {
        Tiring {
            groups: self.groups.iter().map(|group| group.map(f)).collect(),
            group: self.group.clone(),
            initial: f(&self.initial),
            lasts: self.lasts,
        }
    }
}

impl<C: Real> Vision<C> {
    /// That of a task; none where all is seen as it is.
    fn new(task: &Task) -> Option<Self> {
        let (share, held_s) = (task.perception.vision_noise, task.perception.vision_held_s);
        let kept = (-task.control_dt_s / held_s).exp();
        let [share, kept, fresh] = [share, kept, (1.0 - kept * kept).sqrt()].map(C::from_f64);
        (task.perception.vision_noise > 0.0).then_some(Self { share, kept, fresh })
    }
}

impl<T> Vision<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Vision<U> {
        Vision { share: f(&self.share), kept: f(&self.kept), fresh: f(&self.fresh) }
    }
}

impl<C: Real> Start<C> {
    fn new(task: &Task, ranges: &[JointRange]) -> Self {
        let reset = &task.reset;
        let poses = |pose| Poses::new(ranges.iter().map(|&range| interval(reset, pose, range)));
        let speed = if reset.pose == Pose::Zero { 0.0 } else { reset.velocity_spread_rad_s };
        Self {
            pose: poses(reset.pose),
            any_pose: poses(Pose::RangeUniform),
            speed: C::from_f64(speed),
            activation: C::from_f64(reset.activation_max),
        }
    }
}

impl<T> Start<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Start<U> {
        Start {
            pose: self.pose.map(f),
            any_pose: self.any_pose.map(f),
            speed: f(&self.speed),
            activation: f(&self.activation),
        }
    }
}

impl<C: Real> Poses<C> {
    fn new(intervals: impl Iterator<Item = [f64; 2]>) -> Self {
        let (lowest, width) = intervals.map(|[lo, hi]| (C::from_f64(lo), C::from_f64(hi - lo))).unzip();
        Self { lowest, width }
    }
}

impl<T> Poses<T> {
    #[inline(always)]
    fn map<U>(&self, f: &mut impl FnMut(&T) -> U) -> Poses<U> {
        Poses { lowest: self.lowest.iter().map(&mut *f).collect(), width: self.width.iter().map(&mut *f).collect() }
    }
}

impl<S: Scalar> Poses<S> {
    /// A pose, from a number in [0, 1) per coordinate.
    #[inline(always)]
    pub fn at(&self, draws: Vec<S>) -> impl Iterator<Item = S> {
        draws
            .into_iter()
            .zip(&self.lowest)
            .zip(&self.width)
            .map(|((draw, &lowest), &width)| draw.mul_add(width, lowest))
    }
}

/// The angle of this range that is nearest to `q`.
fn within(range: JointRange, q: f64) -> f64 {
    range.map_or(q, |[lo, hi]| q.clamp(lo, hi))
}

/// From where a joint of this range is drawn.
fn interval(reset: &Reset, pose: Pose, range: JointRange) -> [f64; 2] {
    match (pose, range) {
        (Pose::RangeUniform, Some(range)) => range,
        (Pose::Zero, range) => [0.0; 2].map(|q| within(range, q)),
        // A joint without limits has no range to draw from.
        (Pose::NearZero | Pose::RangeUniform, range) => {
            [-reset.pose_spread_rad, reset.pose_spread_rad].map(|off| within(range, within(range, 0.0) + off))
        }
    }
}
