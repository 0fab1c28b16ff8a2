//! From moments of one environment to a drawing.

use myo_dynamics::{CouplingMode, Plan, PlanError, Workspace, step};
use myo_env::Snapshot;
use myo_model::Model;
use myo_tasks::{Block, Shape as Form, Stage, Task};

use super::{Colour, Drawing, Shape};

/// A point in space (m, from the shoulder centre).
type Point = [f64; 3];

/// Size of the page (m) on which the user and everything in reach has room.
const PAGE: [f64; 2] = [2.08, 1.56];

const PAPER: Colour = colour(0xfbfaf7);
const SKIN: Colour = colour(0xe4ded2);
const BONE: Colour = colour(0xd9cfbb);
const MUSCLE: Colour = colour(0xb3362b);
const TARGET: Colour = colour(0x2f7d6d);
const DONE: Colour = colour(0x9aa0a6);
const PATH: Colour = colour(0x27496d);

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
    plan: Plan<f64>,
    bones: Vec<usize>,
    paths: Vec<Vec<usize>>,
    stage: Stage,
    /// Of each object, its number among the spheres.
    spheres: Vec<usize>,
}

impl Painter {
    /// For a model and a task.
    ///
    /// # Errors
    /// The model cannot be simulated.
    pub fn new(model: &Model, task: &Task) -> Result<Self, PlanError> {
        // A task that cannot be run has nothing to draw.
        let stage = task.stage().unwrap_or_default();
        let before = |index: usize| stage.objects[..index].iter().filter(|object| object.sphere().is_some()).count();
        Ok(Self {
            plan: Plan::exact(model, CouplingMode::Reduced)?,
            bones: bones(model),
            paths: model.muscles.iter().map(|muscle| muscle.path.clone()).collect(),
            spheres: (0..stage.objects.len()).map(before).collect(),
            stage,
        })
    }

    /// One moment: the current object is strong, those of later steps are faint, all others grey.
    pub fn moment(&self, moment: &Snapshot) -> Drawing {
        let mut page = Page::new();
        let phase = moment.task.phase.round() as usize;
        let is_asked_for = |object: usize, from: usize| self.stage.steps.iter().skip(from).any(|s| s.object == object);
        let current = self.stage.steps.get(phase).map(|step| step.object);
        for object in (0..self.stage.objects.len()).rev().filter(|object| Some(*object) != current).chain(current) {
            let (tone, strength) = if Some(object) == current {
                (TARGET, 1.0)
            } else if is_asked_for(object, phase) {
                (TARGET, 0.3)
            } else {
                (DONE, 0.35)
            };
            self.object(&mut page, object, moment, tone, strength);
        }
        self.arm(&mut page, moment);
        page.drawing
    }

    /// A whole episode: all targets, numbered, the path of the fingertip with a dot for every moment, and the arm as it is
    /// in the last of the moments. Without any moments, only the user's trunk.
    pub fn episode(&self, moments: &[Snapshot]) -> Drawing {
        let mut page = Page::new();
        let Some(last) = moments.last() else { return page.drawing };
        for object in 0..self.stage.objects.len() {
            let numbers: Vec<String> = (1..)
                .zip(&self.stage.steps)
                .filter(|(_, step)| step.object == object)
                .map(|(number, _)| number.to_string())
                .collect();
            let (tone, strength) = if numbers.is_empty() { (DONE, 0.25) } else { (TARGET, 0.5) };
            self.object(&mut page, object, last, tone, strength);
            let (centre, size) = self.place(object, last);
            if !numbers.is_empty() {
                page.label(centre, size.clamp(0.008, 0.035), numbers.join(" "), TARGET);
            }
        }
        let path: Vec<Point> = moments.iter().map(|moment| self.fingertip(moment)).collect();
        page.line(&path, 0.004, shade(PATH, 0.75));
        for &point in &path {
            page.disc(point, 0.0055, PATH);
        }
        self.arm(&mut page, last);
        page.drawing
    }

    /// Centre of an object, and its radius or half its lesser side (m).
    fn place(&self, object: usize, moment: &Snapshot) -> (Point, f64) {
        match &self.stage.objects[object].shape {
            Form::Sphere(_) => {
                let number = self.spheres[object];
                (moment.task.position[number], moment.task.size[number])
            }
            Form::Button(block) | Form::Obstacle(block) => (block.centre, 0.5 * block.size[0].min(block.size[1])),
        }
    }

    fn object(&self, page: &mut Page, object: usize, moment: &Snapshot, tone: Colour, strength: f64) {
        match &self.stage.objects[object].shape {
            Form::Sphere(_) => {
                let (centre, radius) = self.place(object, moment);
                page.sphere(centre, radius, tone, strength);
            }
            Form::Button(block) | Form::Obstacle(block) => page.block(block, tone, strength),
        }
    }

    fn fingertip(&self, moment: &Snapshot) -> Point {
        step::fingertip(&self.plan, &self.posed(moment))
    }

    fn posed(&self, moment: &Snapshot) -> Workspace<f64> {
        let mut ws = Workspace::new(&self.plan);
        step::kinematics::kinematics(&self.plan, &moment.body.qpos, &moment.body.qvel, &mut ws);
        ws
    }

    /// Bones and muscles; redder and thicker muscles are more active.
    fn arm(&self, page: &mut Page, moment: &Snapshot) {
        let ws = self.posed(moment);
        let fingertip = step::fingertip(&self.plan, &ws);
        let body = |&index: &usize| ws.place(&self.plan.elements.bodies[index]).array();
        let bones: Vec<Point> = self.bones.iter().map(body).chain([fingertip]).collect();
        for (k, bone) in bones.windows(2).enumerate() {
            // Thinner towards the hand.
            page.line(bone, 0.058 * 0.72_f64.powi(k as i32), BONE);
        }
        for (path, &act) in self.paths.iter().zip(&moment.body.act) {
            let points: Vec<Point> =
                path.iter().map(|&site| ws.place(&self.plan.elements.sites[site]).array()).collect();
            page.line(&points, 0.003 + 0.007 * act, shade(MUSCLE, 0.35 + 0.6 * act));
        }
        page.disc(fingertip, 0.013, MUSCLE);
    }
}

/// Bodies from the upper arm down to the hand: those with mass on the way to the fingertip.
fn bones(model: &Model) -> Vec<usize> {
    let mut chain = vec![];
    let mut body = model.sites[model.fingertip_site].body;
    while body != myo_model::model::WORLD {
        let here = &model.bodies[body];
        if here.mass > 0.05 {
            chain.push(body);
        }
        body = here.parent;
    }
    chain.reverse();
    // The girdle lies in the trunk.
    let first = chain.iter().position(|&index| model.bodies[index].name.contains("humer")).unwrap_or(0);
    chain.split_off(first)
}

/// A drawing in the making, with points given in space.
struct Page {
    drawing: Drawing,
}

impl Page {
    /// Paper with head and trunk on it, for scale: the shoulder centre is 17 cm right of the middle.
    fn new() -> Self {
        let mut page = Self { drawing: Drawing { size: PAGE, paper: PAPER, shapes: vec![] } };
        page.line(&[[0.0, 0.17, -0.02], [0.0, 0.17, -0.36]], 0.283, SKIN);
        page.line(&[[0.0, 0.0, 0.0], [0.0, 0.34, 0.0]], 0.105, SKIN);
        page.line(&[[0.0, 0.17, 0.0], [0.0, 0.17, 0.14]], 0.092, SKIN);
        page.disc([0.0, 0.17, 0.29], 0.105, SKIN);
        page
    }

    fn sphere(&mut self, centre: Point, radius: f64, tone: Colour, strength: f64) {
        self.disc(centre, radius, shade(tone, 0.25 * strength));
        self.push(Shape::Ring { centre: on_page(centre), radius, width: 0.004, colour: shade(tone, strength) });
    }

    fn block(&mut self, button: &Block, tone: Colour, strength: f64) {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let front = corners.map(|(across, up)| button.face_point(across, up));
        let (normal, depth) = (button.normal(), button.size[2]);
        let back = front.map(|p| [0, 1, 2].map(|axis| p[axis] - depth * normal[axis]));
        self.polygon(&back, shade(tone, 0.2 * strength));
        for k in 0..4 {
            let side = [front[k], front[(k + 1) % 4], back[(k + 1) % 4], back[k]];
            self.polygon(&side, shade(tone, 0.2 * strength));
        }
        self.polygon(&front, shade(tone, 0.55 * strength));
        let width = (0.06 * button.size[0].min(button.size[1])).clamp(0.001, 0.003);
        self.line(&[front[0], front[1], front[2], front[3], front[0]], width, shade(tone, strength));
    }

    fn line(&mut self, points: &[Point], width: f64, colour: Colour) {
        self.push(Shape::Line { points: points.iter().map(|&p| on_page(p)).collect(), width, colour });
    }

    fn polygon(&mut self, points: &[Point], colour: Colour) {
        self.push(Shape::Polygon { points: points.iter().map(|&p| on_page(p)).collect(), colour });
    }

    fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.push(Shape::Disc { centre: on_page(centre), radius, colour });
    }

    fn label(&mut self, centre: Point, height: f64, text: String, colour: Colour) {
        self.push(Shape::Label { centre: on_page(centre), height, text, colour });
    }

    fn push(&mut self, shape: Shape) {
        self.drawing.shapes.push(shape);
    }
}

/// Oblique projection.
fn on_page([x, y, z]: Point) -> [f64; 2] {
    [0.62 * x - y - 0.2, z + 0.18 * x - 0.14]
}
