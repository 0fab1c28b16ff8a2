//! From moments of one environment to a drawing.

use std::cmp::Ordering;

use myo_dynamics::{CouplingMode, Plan, PlanError, Workspace, step};
use myo_env::Snapshot;
use myo_model::Model;
use myo_tasks::{Pressing, Target, Task};

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
    targets: Vec<Target>,
}

impl Painter {
    /// For a model and a task.
    ///
    /// # Errors
    /// The model cannot be simulated.
    pub fn new(model: &Model, task: &Task) -> Result<Self, PlanError> {
        Ok(Self {
            plan: Plan::exact(model, CouplingMode::Reduced)?,
            bones: bones(model),
            paths: model.muscles.iter().map(|muscle| muscle.path.clone()).collect(),
            targets: task.clone().expanded().targets,
        })
    }

    /// One moment: targets that are done are grey, the current one strong, later ones faint.
    pub fn moment(&self, moment: &Snapshot) -> Drawing {
        let mut page = Page::new();
        let phase = moment.task.phase.round() as usize;
        for (k, target) in self.targets.iter().enumerate().rev() {
            let (tone, strength) = match k.cmp(&phase) {
                Ordering::Less => (DONE, 0.35),
                Ordering::Equal => (TARGET, 1.0),
                Ordering::Greater => (TARGET, 0.3),
            };
            page.target(target, moment, k, tone, strength);
        }
        self.arm(&mut page, moment);
        page.drawing
    }

    /// A whole episode: all targets, numbered, the path of the fingertip with a dot for every moment, and the arm as it is
    /// in the last of the moments. Without any moments, only the user's trunk.
    pub fn episode(&self, moments: &[Snapshot]) -> Drawing {
        let mut page = Page::new();
        let Some(last) = moments.last() else { return page.drawing };
        for (k, target) in self.targets.iter().enumerate() {
            page.target(target, last, k, TARGET, 0.5);
            page.label(last.task.position[k], 0.035, (k + 1).to_string(), TARGET);
        }
        let path: Vec<Point> = moments.iter().map(|moment| self.fingertip(moment)).collect();
        page.line(&path, 0.004, shade(PATH, 0.75));
        for &point in &path {
            page.disc(point, 0.0055, PATH);
        }
        self.arm(&mut page, last);
        page.drawing
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

    fn target(&mut self, target: &Target, moment: &Snapshot, index: usize, tone: Colour, strength: f64) {
        match target {
            Target::Pointing(_) => {
                let (centre, radius) = (moment.task.position[index], moment.task.size[index]);
                self.disc(centre, radius, shade(tone, 0.25 * strength));
                self.push(Shape::Ring { centre: on_page(centre), radius, width: 0.004, colour: shade(tone, strength) });
            }
            Target::Pressing(button) => self.button(button, tone, strength),
        }
    }

    fn button(&mut self, button: &Pressing, tone: Colour, strength: f64) {
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
        self.line(&[front[0], front[1], front[2], front[3], front[0]], 0.003, shade(tone, strength));
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
