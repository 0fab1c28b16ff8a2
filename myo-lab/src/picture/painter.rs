//! From moments of one environment to a drawing.

use myo_dynamics::spatial::{Frame, Vec3};
use myo_env::{Bone, BuildError, Digit, EnvError, MusclePose, ObjectPose, Role, Skeleton, SkeletonPose, Snapshot};
use myo_model::Model;
use myo_tasks::{Action, Shape as Form, Task};
use nalgebra::Point3;

use super::{Colour, Drawing, Shape};

/// A point in space (m, from the shoulder centre).
type Point = [f64; 3];

/// How thick the bones of a hand are drawn whose fingers move (m).
const FINGER: f64 = 0.012;
/// Size of the page (m) on which the user and everything in reach has room.
const PAGE: [f64; 2] = [2.08, 1.56];

const PAPER: Colour = colour(0xfbfaf7);
const SKIN: Colour = colour(0xe4ded2);
const BONE: Colour = colour(0xd9cfbb);
const MUSCLE: Colour = colour(0xb3362b);
const TARGET: Colour = colour(0x2f7d6d);
const DONE: Colour = colour(0x9aa0a6);
const PATH: Colour = colour(0x27496d);

/// Stature (m) of the person as it is drawn where the model tells none.
const DRAWN_STATURE: f64 = 1.735;

/// From a number such as `0x2f7d6d`.
const fn colour(rgb: u32) -> Colour {
    let [_, red, green, blue] = rgb.to_be_bytes();
    [red as f64 / 255.0, green as f64 / 255.0, blue as f64 / 255.0, 1.0]
}

fn shade([red, green, blue, _]: Colour, alpha: f64) -> Colour {
    [red, green, blue, alpha.clamp(0.0, 1.0)]
}

/// Draws environments of one model and task.
#[derive(Clone, Debug)]
pub struct Painter {
    skeleton: Skeleton,
}

impl Painter {
    /// For a model and a task.
    ///
    /// # Errors
    /// The model cannot be simulated, or the task has values out of bounds.
    pub fn new(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Ok(Self { skeleton: Skeleton::new(model, task)? })
    }

    /// For what a skeleton knows.
    pub fn of(skeleton: Skeleton) -> Self {
        Self { skeleton }
    }

    /// What knows where everything is.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// One moment: the current object is strong, those of later steps are faint, all others grey.
    ///
    /// # Errors
    /// The moment is of another model or task.
    pub fn moment(&self, moment: &Snapshot) -> Result<Drawing, EnvError> {
        let (mut page, pose) = (Page::around(&self.skeleton), self.skeleton.pose(moment)?);
        let is_current = |object: &ObjectPose| object.role == Role::Current;
        let (current, others): (Vec<usize>, Vec<usize>) =
            (0..pose.objects.len()).rev().partition(|&index| is_current(&pose.objects[index]));
        self.ways(&mut page, &pose);
        for index in others.into_iter().chain(current) {
            let (tone, strength) = match pose.objects[index].role {
                Role::Current => (TARGET, 1.0),
                Role::Later => (TARGET, 0.3),
                Role::Done | Role::Bystander => (DONE, 0.35),
            };
            self.object(&mut page, index, &pose, tone, strength);
        }
        self.arm(&mut page, &pose);
        Ok(page.drawing)
    }

    /// A whole episode: all targets, numbered, the path of the pointer with a dot for every moment, and the arm as it is
    /// in the last of the moments. Without any moments, only the user's trunk.
    ///
    /// # Errors
    /// A moment is of another model or task.
    pub fn episode(&self, moments: &[Snapshot]) -> Result<Drawing, EnvError> {
        let mut page = Page::around(&self.skeleton);
        let poses = moments.iter().map(|moment| self.skeleton.pose(moment)).collect::<Result<Vec<_>, _>>()?;
        let Some(last) = poses.last() else { return Ok(page.drawing) };
        self.ways(&mut page, last);
        for index in 0..last.objects.len() {
            self.numbered(&mut page, index, last);
        }
        let path: Vec<Point> = poses.iter().map(|pose| pose.pointer).collect();
        page.line(&path, 0.004, shade(PATH, 0.75));
        for &point in &path {
            page.disc(point, 0.0055, PATH);
        }
        self.arm(&mut page, last);
        Ok(page.drawing)
    }

    /// Ways to steer along, as wide as they are.
    fn ways(&self, page: &mut Page, pose: &SkeletonPose) {
        let task = self.skeleton.task();
        for (number, step) in task.steps.iter().enumerate() {
            let Action::Steer { from, width } = step.action else { continue };
            let ends = [from, step.object].map(|object| pose.objects[object].frame.position.array());
            let strength = if pose.step == Some(number) { 0.25 } else { 0.12 };
            page.line(&ends, width, shade(TARGET, strength));
        }
    }

    /// An object with the numbers of the steps that ask for it.
    fn numbered(&self, page: &mut Page, index: usize, pose: &SkeletonPose) {
        let asks = (1..).zip(&self.skeleton.task().steps).filter(|(_, step)| step.involves(index));
        let numbers: Vec<String> = asks.map(|(number, _)| number.to_string()).collect();
        let (tone, strength) = if numbers.is_empty() { (DONE, 0.25) } else { (TARGET, 0.5) };
        self.object(page, index, pose, tone, strength);
        if !numbers.is_empty() {
            let ObjectPose { frame, half_size: [height, width, _], .. } = &pose.objects[index];
            let centre = frame.position.array();
            page.label(centre, height.min(*width).clamp(0.008, 0.035), numbers.join(" "), TARGET);
        }
    }

    fn object(&self, page: &mut Page, index: usize, pose: &SkeletonPose, tone: Colour, strength: f64) {
        let object = &pose.objects[index];
        match &self.skeleton.task().objects[index].shape {
            Form::Sphere(_) => page.sphere(object.frame.position.array(), object.half_size[0], tone, strength),
            Form::Stick(_) => {
                let knob = object.frame.position.array();
                if let Some(hinge) = object.hinge {
                    page.line(&[hinge, knob], 0.5 * object.half_size[0], shade(tone, 0.7 * strength));
                    page.disc(hinge, 0.4 * object.half_size[0], shade(tone, strength));
                }
                page.sphere(knob, object.half_size[0], tone, strength);
            }
            Form::Button(_) | Form::Obstacle(_) => page.block(&object.frame, object.half_size, tone, strength),
            Form::Slider(_) => {
                page.block(&object.frame, object.half_size, tone, 0.4 * strength);
                if let Some((frame, half_size)) = &object.handle {
                    page.block(frame, *half_size, tone, strength);
                }
            }
        }
    }

    /// All bones of a body that is no person's arm.
    fn bones(&self, page: &mut Page, pose: &SkeletonPose) {
        for Bone { bodies, ends } in self.skeleton.bones() {
            let [a, b] = [0, 1].map(|k| pose.bodies[bodies[k]].place(Vec3::splat(ends[k])));
            let length = (b - a).dot(b - a).sqrt();
            page.line(&[a.array(), b.array()], (SLENDER * length).min(THICKEST), BONE);
        }
    }

    /// Bones and muscles; redder and thicker muscles are more active.
    fn arm(&self, page: &mut Page, pose: &SkeletonPose) {
        let joints = self.skeleton.limb().iter().map(|&body| pose.bodies[body].position.array());
        let bones: Vec<Point> = joints.chain([pose.fingertip]).collect();
        let digits = self.skeleton.digits();
        // Where fingers move a hand is drawn by its bones, over its muscles.
        let hand = if digits.is_empty() { bones.len() } else { bones.len() - 2 };
        if self.skeleton.is_person() {
            for (k, bone) in bones.windows(2).enumerate().take(hand) {
                // Thinner towards the hand.
                page.line(bone, 0.058 * 0.72_f64.powi(k as i32), BONE);
            }
        } else {
            self.bones(page, pose);
        }
        // As wide on the page whether a whole person is on it or a hand.
        let near = page.scale.max(1.0).recip();
        for MusclePose { points, activation } in &pose.muscles {
            page.line(points, near * (0.003 + 0.007 * activation), shade(MUSCLE, 0.35 + 0.6 * activation));
        }
        for digit in digits {
            page.line(&along(digit, bones[hand], pose), FINGER, shade(BONE, 0.9));
        }
        pose.fingers.iter().for_each(|&tip| page.disc(tip, 0.5 * FINGER, PATH));
        page.disc(pose.fingertip, if digits.is_empty() { 0.013 } else { 0.6 * FINGER }, MUSCLE);
        if let Some(from) = pose.ray_from {
            page.line(&[from, pose.pointer], 0.003, shade(PATH, 0.5));
        }
        if pose.pointer != pose.fingertip {
            page.disc(pose.pointer, 0.013, PATH);
        }
    }
}

/// How much thinner a bone is than long, where only bones are drawn.
const SLENDER: f64 = 0.12;
/// The thickest of them (m).
const THICKEST: f64 = 0.03;

/// A finger from the wrist to its tip.
fn along(digit: &Digit, wrist: Point, pose: &SkeletonPose) -> Vec<Point> {
    let [x, y, z] = digit.tip;
    let joints = digit.bodies.iter().map(|&body| pose.bodies[body].position.array());
    let tip = digit.bodies.last().map(|&body| pose.bodies[body].place(Vec3::new(x, y, z)).array());
    [wrist].into_iter().chain(joints).chain(tip).collect()
}

/// A drawing in the making, with points given in space.
struct Page {
    drawing: Drawing,
    /// How large things are drawn, 1 as in life.
    scale: f64,
    /// What is in the middle of the page, in life size.
    middle: [f64; 2],
}

impl Page {
    /// Paper with head and trunk of a person on it: the centre of a right shoulder is 17 cm right of the middle, that of a left one as far left.
    fn around(skeleton: &Skeleton) -> Self {
        let size = skeleton.model().stature_m.unwrap_or(DRAWN_STATURE) / DRAWN_STATURE;
        let side = if skeleton.model().has_left_arm() { -size } else { size };
        let drawing = Drawing { size: PAGE, paper: PAPER, shapes: vec![] };
        let (middle, most) = view(skeleton);
        let mut page = Self { drawing, scale: scale(skeleton, middle, most), middle };
        if !skeleton.is_person() {
            return page;
        }
        let at = |y: f64, z: f64| [0.0, side * y, size * z];
        page.line(&[at(0.17, -0.02), at(0.17, -0.36)], 0.283 * size, SKIN);
        page.line(&[at(0.0, 0.0), at(0.34, 0.0)], 0.105 * size, SKIN);
        page.line(&[at(0.17, 0.0), at(0.17, 0.14)], 0.092 * size, SKIN);
        page.disc(at(0.17, 0.29), 0.105 * size, SKIN);
        page
    }

    fn at(&self, point: Point) -> [f64; 2] {
        let place = on_page(point);
        [0, 1].map(|axis| (place[axis] - self.middle[axis]) * self.scale)
    }

    fn sphere(&mut self, centre: Point, radius: f64, tone: Colour, strength: f64) {
        self.disc(centre, radius, shade(tone, 0.25 * strength));
        self.ring(centre, radius, 0.004, shade(tone, strength));
    }

    fn block(&mut self, frame: &Frame<f64>, [h, w, d]: [f64; 3], tone: Colour, strength: f64) {
        let corner = |up: f64, across: f64, out: f64| frame.place(Vec3::new(up * h, across * w, out * d)).array();
        let side =
            |out: f64| [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)].map(|(up, across)| corner(up, across, out));
        let (front, back) = (side(1.0), side(-1.0));
        self.polygon(&back, shade(tone, 0.2 * strength));
        for k in 0..4 {
            let side = [front[k], front[(k + 1) % 4], back[(k + 1) % 4], back[k]];
            self.polygon(&side, shade(tone, 0.2 * strength));
        }
        self.polygon(&front, shade(tone, 0.55 * strength));
        let width = (0.12 * h.min(w)).clamp(0.001, 0.003);
        self.line(&[front[0], front[1], front[2], front[3], front[0]], width, shade(tone, strength));
    }

    fn line(&mut self, points: &[Point], width: f64, colour: Colour) {
        let points = points.iter().map(|&point| self.at(point)).collect();
        self.push(Shape::Line { points, width: width * self.scale, colour });
    }

    fn polygon(&mut self, points: &[Point], colour: Colour) {
        let points = points.iter().map(|&point| self.at(point)).collect();
        self.push(Shape::Polygon { points, colour });
    }

    fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.push(Shape::Disc { centre: self.at(centre), radius: radius * self.scale, colour });
    }

    fn ring(&mut self, centre: Point, radius: f64, width: f64, colour: Colour) {
        let (radius, width) = (radius * self.scale, width * self.scale);
        self.push(Shape::Ring { centre: self.at(centre), radius, width, colour });
    }

    fn label(&mut self, centre: Point, height: f64, text: String, colour: Colour) {
        self.push(Shape::Label { centre: self.at(centre), height: height * self.scale, text, colour });
    }

    fn push(&mut self, shape: Shape) {
        self.drawing.shapes.push(shape);
    }
}

/// How large a hand is drawn of a person who moves nothing else.
const CLOSE: f64 = 4.0;
/// From the wrist to the middle of such a picture: half a hand forward (m).
const HALF_HAND: f64 = 0.08;

/// What is in the middle of the page, and how large things are drawn at most: a whole person as large as in life, a hand alone from nearby,
/// and bones alone so that they have room.
fn view(skeleton: &Skeleton) -> ([f64; 2], f64) {
    let (model, limb) = (skeleton.model(), skeleton.limb());
    if !skeleton.is_person() {
        return view_of_bones(skeleton);
    }
    let Some(&hand) = limb.last().filter(|_| skeleton.moves_hand_only()) else { return ([0.0; 2], 1.0) };
    let place = model.frames_in_zero_pose()[hand].translation.vector - model.shoulder_in_zero_pose();
    (on_page([place.x + HALF_HAND, place.y, place.z]), CLOSE)
}

/// Share of the page that bones fill in one direction.
const FILLED: f64 = 0.6;
/// How much larger than in life small ones are drawn at most.
const LARGEST: f64 = 8.0;

fn view_of_bones(skeleton: &Skeleton) -> ([f64; 2], f64) {
    let model = skeleton.model();
    let (frames, shoulder) = (model.frames_in_zero_pose(), model.shoulder_in_zero_pose());
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let ends = |bone: Bone| [0, 1].map(|k| frames[bone.bodies[k]] * Point3::from(bone.ends[k]));
    for end in skeleton.bones().into_iter().flat_map(ends) {
        let place = on_page((end.coords - shoulder).into());
        for axis in 0..2 {
            (low[axis], high[axis]) = (low[axis].min(place[axis]), high[axis].max(place[axis]));
        }
    }
    if low[0] > high[0] {
        return ([0.0; 2], 1.0);
    }
    let most = (0..2).map(|axis| FILLED * PAGE[axis] / (high[axis] - low[axis])).fold(LARGEST, f64::min);
    ([0, 1].map(|axis| 0.5 * (low[axis] + high[axis])), most)
}

/// As large as may be where a scene has room on the page, as nearly all have, and else as large as it has.
fn scale(skeleton: &Skeleton, middle: [f64; 2], most: f64) -> f64 {
    let corners = skeleton.task().objects.iter().flat_map(|object| {
        let half = object.block().map_or(0.0, |block| 0.5 * block.size[0].max(block.size[1]));
        object.extent().corners().map(|corner| (on_page(corner), half))
    });
    let room = corners
        .flat_map(|(corner, half)| [0, 1].map(|axis| 0.5 * PAGE[axis] / ((corner[axis] - middle[axis]).abs() + half)));
    room.fold(most, f64::min)
}

/// Oblique projection.
fn on_page([x, y, z]: Point) -> [f64; 2] {
    [0.62 * x - y - 0.2, z + 0.18 * x - 0.14]
}
