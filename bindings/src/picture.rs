//! One environment drawn: the user from behind and to the left, the arm with its muscles, targets.

use myo::dynamics::{Coupling, Plan, PlanError, Workspace, step};
use myo::env::Snapshot;
use myo::model::Model;
use myo::tasks::{Pressing, Target, Task};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform};

type Point = [f64; 3];

/// Size of the page (m) that fits the picture; nearer things are lower left, the plane of the targets upper right.
const PAGE: [f64; 2] = [2.08, 1.56];

const PAPER: [u8; 3] = [0xfb, 0xfa, 0xf7];
const SKIN: [u8; 3] = [0xe4, 0xde, 0xd2];
const BONE: [u8; 3] = [0xd9, 0xcf, 0xbb];
const MUSCLE: [u8; 3] = [0xb3, 0x36, 0x2b];
const CURRENT: [u8; 3] = [0x2f, 0x7d, 0x6d];
const DONE: [u8; 3] = [0x9a, 0xa0, 0xa6];

fn shade([r, g, b]: [u8; 3], alpha: f64) -> Color {
    Color::from_rgba8(r, g, b, (255.0 * alpha.clamp(0.0, 1.0)) as u8)
}

/// What a picture needs to know of model and task.
pub struct Painter {
    plan: Plan<f64>,
    bones: Vec<usize>,
    paths: Vec<Vec<usize>>,
    targets: Vec<Target>,
}

impl Painter {
    /// For a model and a task.
    pub fn new(model: &Model, task: &Task) -> Result<Self, PlanError> {
        Ok(Self {
            plan: Plan::exact(model, Coupling::Reduced)?,
            bones: bones(model),
            paths: model.muscles.iter().map(|muscle| muscle.path.clone()).collect(),
            targets: task.clone().expanded().targets,
        })
    }

    /// Red, green and blue of every pixel, row by row.
    pub fn paint(&self, moment: &Snapshot, width: usize, height: usize) -> Vec<u8> {
        let mut ws = Workspace::<f64>::new(&self.plan);
        step::kinematics::kinematics(&self.plan, &moment.body.qpos, &moment.body.qvel, &mut ws);
        let mut canvas = Canvas::new(width, height);
        trunk(&mut canvas);
        self.targets(&mut canvas, moment);
        self.arm(&mut canvas, &ws, &moment.body.act);
        canvas.pixels()
    }

    fn targets(&self, canvas: &mut Canvas, moment: &Snapshot) {
        let phase = moment.task.phase.round() as usize;
        for (k, target) in self.targets.iter().enumerate().rev() {
            let (tone, strength) = match k.cmp(&phase) {
                std::cmp::Ordering::Less => (DONE, 0.35),
                std::cmp::Ordering::Equal => (CURRENT, 1.0),
                std::cmp::Ordering::Greater => (CURRENT, 0.3),
            };
            match target {
                Target::Pointing(_) => {
                    let (centre, radius) = (moment.task.position[k], moment.task.size[k]);
                    canvas.disc(centre, radius, shade(tone, 0.25 * strength));
                    canvas.ring(centre, radius, 0.004, shade(tone, strength));
                }
                Target::Pressing(button) => draw_button(canvas, button, tone, strength),
            }
        }
    }

    fn arm(&self, canvas: &mut Canvas, ws: &Workspace<f64>, act: &[f64]) {
        let body = |&index: &usize| ws.place(&self.plan.elements.bodies[index]).array();
        let fingertip = step::fingertip(&self.plan, ws);
        let bones: Vec<Point> = self.bones.iter().map(body).chain([fingertip]).collect();
        for (k, bone) in bones.windows(2).enumerate() {
            // Thinner towards the hand.
            let width = 0.058 * 0.72_f64.powi(k as i32);
            canvas.line(bone, width, shade(BONE, 1.0));
        }
        for (path, &act) in self.paths.iter().zip(act) {
            let points: Vec<Point> =
                path.iter().map(|&site| ws.place(&self.plan.elements.sites[site]).array()).collect();
            canvas.line(&points, 0.003 + 0.007 * act, shade(MUSCLE, 0.35 + 0.6 * act));
        }
        canvas.disc(fingertip, 0.013, shade(MUSCLE, 1.0));
    }
}

/// Bodies from the shoulder's elbow side down to the hand: those with mass on the way to the fingertip.
fn bones(model: &Model) -> Vec<usize> {
    let mut chain = vec![];
    let mut body = model.sites[model.fingertip_site].body;
    while body != myo::model::model::WORLD {
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

/// Head and trunk, for scale: the shoulder centre is 17 cm right of the middle.
fn trunk(canvas: &mut Canvas) {
    let skin = shade(SKIN, 1.0);
    canvas.line(&[[0.0, 0.17, -0.02], [0.0, 0.17, -0.36]], 0.283, skin);
    canvas.line(&[[0.0, 0.0, 0.0], [0.0, 0.34, 0.0]], 0.105, skin);
    canvas.line(&[[0.0, 0.17, 0.0], [0.0, 0.17, 0.14]], 0.092, skin);
    canvas.disc([0.0, 0.17, 0.29], 0.105, skin);
}

fn draw_button(canvas: &mut Canvas, button: &Pressing, tone: [u8; 3], strength: f64) {
    let front = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(across, up)| button.face_point(across, up));
    let (normal, depth) = (button.normal(), button.size[2]);
    let back = front.map(|p| [0, 1, 2].map(|axis| p[axis] - depth * normal[axis]));
    canvas.polygon(&back, shade(tone, 0.2 * strength));
    for k in 0..4 {
        let side = [front[k], front[(k + 1) % 4], back[(k + 1) % 4], back[k]];
        canvas.polygon(&side, shade(tone, 0.2 * strength));
    }
    canvas.polygon(&front, shade(tone, 0.55 * strength));
    canvas.line(&[front[0], front[1], front[2], front[3], front[0]], 0.003, shade(tone, strength));
}

/// A picture in the making, in metres.
struct Canvas {
    pixmap: Pixmap,
    /// Pixels per metre.
    scale: f64,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        let mut pixmap = Pixmap::new(width as u32, height as u32).expect("sizes are checked by the caller");
        pixmap.fill(shade(PAPER, 1.0));
        Self { pixmap, scale: (width as f64 / PAGE[0]).min(height as f64 / PAGE[1]) }
    }

    /// Oblique projection of a point (m, from the shoulder centre) to pixels.
    fn place(&self, [x, y, z]: Point) -> (f32, f32) {
        let (right, up) = (0.62 * x - y - 0.2, z + 0.18 * x - 0.14);
        let (width, height) = (f64::from(self.pixmap.width()), f64::from(self.pixmap.height()));
        ((0.5 * width + self.scale * right) as f32, (0.5 * height - self.scale * up) as f32)
    }

    fn paint(colour: Color) -> Paint<'static> {
        let mut paint = Paint { anti_alias: true, ..Paint::default() };
        paint.set_color(colour);
        paint
    }

    fn outline(&self, points: &[Point], closed: bool) -> Option<Path> {
        let mut path = PathBuilder::new();
        for (k, &point) in points.iter().enumerate() {
            let (x, y) = self.place(point);
            if k == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
        }
        if closed {
            path.close();
        }
        path.finish()
    }

    fn stroke(&mut self, path: &Path, width_m: f64, colour: Color) {
        let width = (width_m * self.scale).max(0.7) as f32;
        let stroke = Stroke { width, line_cap: LineCap::Round, line_join: LineJoin::Round, ..Stroke::default() };
        self.pixmap.stroke_path(path, &Self::paint(colour), &stroke, Transform::identity(), None);
    }

    fn fill(&mut self, path: &Path, colour: Color) {
        self.pixmap.fill_path(path, &Self::paint(colour), FillRule::Winding, Transform::identity(), None);
    }

    fn line(&mut self, points: &[Point], width_m: f64, colour: Color) {
        if let Some(path) = self.outline(points, false) {
            self.stroke(&path, width_m, colour);
        }
    }

    fn polygon(&mut self, points: &[Point], colour: Color) {
        if let Some(path) = self.outline(points, true) {
            self.fill(&path, colour);
        }
    }

    fn circle(&self, centre: Point, radius_m: f64) -> Option<Path> {
        let (x, y) = self.place(centre);
        PathBuilder::from_circle(x, y, (radius_m * self.scale).max(0.5) as f32)
    }

    fn disc(&mut self, centre: Point, radius_m: f64, colour: Color) {
        if let Some(path) = self.circle(centre, radius_m) {
            self.fill(&path, colour);
        }
    }

    fn ring(&mut self, centre: Point, radius_m: f64, width_m: f64, colour: Color) {
        if let Some(path) = self.circle(centre, radius_m) {
            self.stroke(&path, width_m, colour);
        }
    }

    /// The paper is opaque, so no pixel is transparent.
    fn pixels(&self) -> Vec<u8> {
        self.pixmap.pixels().iter().flat_map(|p| [p.red(), p.green(), p.blue()]).collect()
    }
}
