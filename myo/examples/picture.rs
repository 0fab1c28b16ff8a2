//! Draws one episode of a trained user as SVG: `cargo run --release -p myo --example picture -- RUN TASK OUT.svg`.
//!
//! The view is from behind and to the left of the user; nearer things are lower left, the plane of the targets upper right.

use myo::dynamics::{Coupling, Plan, Workspace, step};
use myo::env::Env;
use myo::model::{Model, builtin};
use myo::train::RunFolder;
use std::fmt::Write;

const WIDTH: f64 = 1200.0;
const HEIGHT: f64 = 900.0;
/// Pixels per metre.
const SCALE: f64 = 760.0;

/// Oblique projection of a point (m, from the shoulder) to the page.
fn page([x, y, z]: [f64; 3]) -> (f64, f64) {
    (470.0 + SCALE * (0.62 * x - y), 500.0 - SCALE * (z + 0.18 * x))
}

/// What is drawn of one moment.
struct Moment {
    fingertip: [f64; 3],
    target: [f64; 3],
    radius: f64,
    qpos: Vec<f64>,
    act: Vec<f64>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run, task, out] = arguments.as_slice() else { return Err("usage: picture RUN TASK OUT.svg".into()) };
    let task = myo::tasks::load(task)?.task;
    let model = Model::new(&builtin(&task.model)?)?;
    let plan = Plan::exact(&model, Coupling::Reduced)?;
    let latest = RunFolder::open(run.as_ref())?.latest_checkpoint()?;
    let checkpoint = latest.checkpoint.ok_or("the run has no checkpoint")?;
    let mut policy = checkpoint.policy();
    let mut env = Env::new(&model, &task, 5)?;
    let mut moments = vec![moment(&env, &plan)];
    let mut action = vec![0.0; env.spec().action_size()];
    loop {
        policy.act_deterministic(env.observation(), &mut action);
        let last = env.step(&action)?;
        let over = last.terminated || last.truncated;
        moments.push(moment(&env, &plan));
        if over {
            break;
        }
    }
    std::fs::write(out, draw(&model, &plan, &moments))?;
    Ok(())
}

/// Reads the current moment from the observation.
fn moment(env: &Env, plan: &Plan<f64>) -> Moment {
    let (names, values) = (&env.spec().observation_names, env.observation());
    let at = |name: &str| names.iter().position(|n| n.starts_with(name)).expect("the task observes it");
    let vector = |name: &str| [0, 1, 2].map(|k| f64::from(values[at(name) + k]));
    let joint = |(k, dof): (usize, &myo::dynamics::plan::Dof<f64>)| {
        let [lo, hi] = dof.range.expect("the arm's joints are limited");
        lo + (hi - lo) * (f64::from(values[at("joint_position") + k]) + 1.0) / 2.0
    };
    Moment {
        fingertip: vector("fingertip_position"),
        target: vector("target_position"),
        radius: f64::from(values[at("target_size")]),
        qpos: plan.dofs.iter().enumerate().map(joint).collect(),
        act: (0..plan.nmuscle()).map(|k| (f64::from(values[at("activation") + k]) + 1.0) / 2.0).collect(),
    }
}

fn draw(model: &Model, plan: &Plan<f64>, moments: &[Moment]) -> String {
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fbfaf7\"/>\n"
    );
    trunk(&mut svg);
    targets(&mut svg, moments);
    path(&mut svg, moments);
    arm(&mut svg, model, plan, &moments[moments.len() - 1]);
    svg.push_str("</svg>\n");
    svg
}

fn circle(svg: &mut String, centre: [f64; 3], radius: f64, style: &str) {
    let (x, y) = page(centre);
    writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{:.1}\" {style}/>", radius * SCALE).expect("to a string");
}

fn polyline(svg: &mut String, points: &[[f64; 3]], style: &str) {
    let coordinates = points.iter().map(|&p| page(p)).map(|(x, y)| format!("{x:.1},{y:.1}"));
    let list = coordinates.collect::<Vec<_>>().join(" ");
    writeln!(
        svg,
        "<polyline points=\"{list}\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\" {style}/>"
    )
    .expect("to a string");
}

/// Head and trunk, for scale: the shoulder centre is 17 cm right of the middle.
fn trunk(svg: &mut String) {
    let skin = "stroke=\"#e4ded2\"";
    polyline(svg, &[[0.0, 0.17, -0.02], [0.0, 0.17, -0.36]], &format!("{skin} stroke-width=\"215\""));
    polyline(svg, &[[0.0, 0.0, 0.0], [0.0, 0.34, 0.0]], &format!("{skin} stroke-width=\"80\""));
    polyline(svg, &[[0.0, 0.17, 0.0], [0.0, 0.17, 0.14]], &format!("{skin} stroke-width=\"70\""));
    circle(svg, [0.0, 0.17, 0.29], 0.105, "fill=\"#e4ded2\"");
}

/// Targets in the order in which they were the current one.
fn targets(svg: &mut String, moments: &[Moment]) {
    let mut seen: Vec<&Moment> = vec![];
    for moment in moments {
        if seen.last().is_none_or(|last| last.target != moment.target) {
            seen.push(moment);
        }
    }
    for (k, moment) in seen.iter().enumerate() {
        circle(svg, moment.target, moment.radius, "fill=\"#2f7d6d\" fill-opacity=\"0.13\" stroke=\"#2f7d6d\"");
        let (x, y) = page(moment.target);
        writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"22\" fill=\"#1d5b4f\" text-anchor=\"middle\">{}</text>",
            y + 8.0,
            k + 1
        )
        .expect("to a string");
    }
}

/// The fingertip's path, a dot per decision.
fn path(svg: &mut String, moments: &[Moment]) {
    let points: Vec<[f64; 3]> = moments.iter().map(|m| m.fingertip).collect();
    polyline(svg, &points, "stroke=\"#27496d\" stroke-width=\"2.5\" stroke-opacity=\"0.75\"");
    for &point in &points {
        circle(svg, point, 0.0045, "fill=\"#27496d\"");
    }
}

/// Bones and muscles at one moment; redder muscles are more active.
fn arm(svg: &mut String, model: &Model, plan: &Plan<f64>, moment: &Moment) {
    let mut ws = Workspace::<f64>::new(plan);
    step::kinematics::kinematics(plan, &moment.qpos, &vec![0.0; plan.ndof()], &mut ws);
    let body = |name: &str| {
        let index = model.bodies.iter().position(|b| b.name == name).expect("the arm has this body");
        ws.place(&plan.elements.bodies[index]).array()
    };
    let bones = [body("humerus"), body("ulna"), body("hand"), moment.fingertip];
    polyline(svg, &bones[..2], "stroke=\"#d9cfbb\" stroke-width=\"44\"");
    polyline(svg, &bones[1..3], "stroke=\"#d9cfbb\" stroke-width=\"32\"");
    polyline(svg, &bones[2..], "stroke=\"#d9cfbb\" stroke-width=\"20\"");
    for (muscle, act) in model.muscles.iter().zip(&moment.act) {
        let points: Vec<[f64; 3]> =
            muscle.path.iter().map(|&site| ws.place(&plan.elements.sites[site]).array()).collect();
        let (width, opacity) = (2.0 + 5.0 * act, 0.35 + 0.6 * act);
        let red = format!("stroke=\"#b3362b\" stroke-width=\"{width:.1}\" stroke-opacity=\"{opacity:.2}\"");
        polyline(svg, &points, &red);
    }
    circle(svg, moment.fingertip, 0.011, "fill=\"#b3362b\"");
}
