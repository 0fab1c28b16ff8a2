//! Bounds of the observation: what holds for certain, and the largest finite number for what has no bound.

use myo::model::Model;
use myo::model::description::JointKind;
use myo::model::model::WORLD;
use myo::tasks::{Action, Pointer, Shape, Task};
use nalgebra::{UnitQuaternion, Vector3};

type Interval = [f64; 2];

/// Joint angles and velocities have no bound: limits are soft. Nor have targets of a user who misjudges them: how far off they seem is
/// normally distributed. Not infinite, because checkers of environments warn of that.
const UNBOUNDED: Interval = [-(f32::MAX as f64), f32::MAX as f64];

/// Bounds are computed exactly and observations in single precision.
const ROUNDING: f64 = 1e-5;

/// Least and greatest value of every entry of the observation, in any of the layouts.
pub fn bounds(model: &Model, layouts: &[Task], names: &[String]) -> (Vec<f32>, Vec<f32>) {
    let regions: Vec<Regions> = layouts.iter().map(|task| Regions::new(model, task)).collect();
    let wide = |[lo, hi]: Interval| {
        let slack = |x: f64| ROUNDING * x.abs().max(1.0);
        if [lo, hi] == UNBOUNDED { [lo, hi] } else { [lo - slack(lo), hi + slack(hi)] }
    };
    let of = |name: &str| hull(regions.iter().map(|regions| regions.of(name)));
    names.iter().map(|name| wide(of(name)).map(|x| x as f32)).map(|[lo, hi]| (lo, hi)).unzip()
}

/// Where things can be, per axis (m from the shoulder centre).
struct Regions {
    fingertip: [Interval; 3],
    pointer: [Interval; 3],
    target: [Interval; 3],
    size: Interval,
    targets: usize,
    misjudged: bool,
}

impl Regions {
    fn new(model: &Model, task: &Task) -> Self {
        // A task that cannot be run has no environments either.
        let flat = task.flat().unwrap_or_default();
        let asked_for = || flat.steps.iter().flat_map(|step| step.objects()).chain(flat.correction);
        let wanted = || asked_for().map(|object| &flat.objects[object]);
        let region = |axis: usize| {
            hull(wanted().map(|object| {
                let region = object.extent();
                let range = [region.x, region.y, region.z][axis];
                [range.min, range.max]
            }))
        };
        let size = hull(wanted().map(|object| match &object.shape {
            Shape::Sphere(sphere) => [sphere.radius.min, sphere.radius.max],
            Shape::Stick(stick) => [stick.knob; 2],
            Shape::Button(block) | Shape::Obstacle(block) => {
                let (half, by) = (0.5 * block.size[0], object.growth.map_or(0.0, |growth| growth.farthest(1)));
                [half - by, half + by]
            }
            Shape::Slider(slider) => {
                hull([slider.block.size[0], slider.handle].map(|size| [0.5 * size; 2]).into_iter())
            }
        }));
        let ways = flat.steps.iter().filter_map(|step| match step.action {
            Action::Steer { width, .. } => Some([0.5 * width; 2]),
            _ => None,
        });
        let size = hull(ways.chain([size]));
        let targets = flat.steps.len();
        let fingertip = reach(model);
        let is_fingertip = flat.pointer == Pointer::Fingertip && flat.steps.iter().all(|step| step.lead.is_none());
        let pointer = if is_fingertip { fingertip } else { [UNBOUNDED; 3] };
        let misjudged = task.perception.vision_noise > 0.0;
        Self { fingertip, pointer, target: [0, 1, 2].map(region), size, targets, misjudged }
    }

    /// The interval of an entry such as `target_position.x`.
    fn of(&self, name: &str) -> Interval {
        let (part, entry) = name.split_once('.').unwrap_or((name, ""));
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == entry).unwrap_or(0);
        match part {
            "fingertip_position" => self.fingertip[axis],
            "next_target_vector" if self.targets <= 1 => [0.0, 0.0],
            "target_position" | "target_vector" | "next_target_vector" if self.misjudged => UNBOUNDED,
            "target_position" => self.target[axis],
            "target_size" => self.size,
            "target_vector" => difference(self.target[axis], self.pointer[axis]),
            "next_target_vector" => including_zero(difference(self.target[axis], self.target[axis])),
            "activation" | "control" => [-1.0, 1.0],
            "fatigue" | "phase" | "dwell_fraction" | "time_left" | "inside" | "touch" | "cue" | "target_kind" => {
                [0.0, 1.0]
            }
            // Unit vectors, and what is no longer.
            "target_normal" | "target_direction" | "nearest_obstacle" => [-1.0, 1.0],
            "drag" if entry == "held" => [0.0, 1.0],
            "fingers" if [".asked", ".ready"].iter().any(|word| entry.ends_with(word)) => [0.0, 1.0],
            _ => UNBOUNDED,
        }
    }
}

fn hull(intervals: impl Iterator<Item = Interval>) -> Interval {
    intervals.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], [a, b]| [lo.min(a), hi.max(b)])
}

fn difference(a: Interval, b: Interval) -> Interval {
    if b == UNBOUNDED { UNBOUNDED } else { [a[0] - b[1], a[1] - b[0]] }
}

fn including_zero([lo, hi]: Interval) -> Interval {
    [lo.min(0.0), hi.max(0.0)]
}

/// A box around everything the fingertip can touch: the arm as a string of its lengths, from where it leaves the world.
fn reach(model: &Model) -> [Interval; 3] {
    let mut chain = vec![];
    let mut body = model.sites[model.fingertip_site].body;
    while body != WORLD {
        chain.push(body);
        body = model.bodies[body].parent;
    }
    let (mut base, mut turn, mut length, mut moves) = (Vector3::zeros(), UnitQuaternion::identity(), 0.0, false);
    for &index in chain.iter().rev() {
        let body = &model.bodies[index];
        if moves {
            length += body.pos.norm();
        } else {
            base += turn * body.pos;
            turn *= body.quat;
        }
        for joint in model.joints.iter().filter(|joint| joint.body == index) {
            if matches!(joint.kind, JointKind::Slide | JointKind::Free) {
                return [UNBOUNDED; 3];
            }
            moves = true;
            // The body's origin turns about the anchor.
            length += 2.0 * joint.pos.norm();
        }
    }
    length += model.sites[model.fingertip_site].pos.norm();
    let base = base - origin(model);
    [0, 1, 2].map(|axis| [base[axis] - length, base[axis] + length])
}

/// The shoulder centre in the zero pose, in the model's world.
fn origin(model: &Model) -> Vector3<f64> {
    let mut at = Vector3::zeros();
    let mut body = model.shoulder_body;
    while body != WORLD {
        let this = &model.bodies[body];
        at = this.pos + this.quat * at;
        body = this.parent;
    }
    at
}
