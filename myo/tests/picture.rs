//! Pictures stay what they are.
//!
//! `MYO_BLESS=1 cargo test -p myo-sim --test picture` draws them anew; look at `myo/tests/pictures` then.

use std::path::Path;

use myo::env::{Env, Snapshot};
use myo::model::{Model, builtin};
use myo::picture::Painter;
use myo::tasks::Task;

/// A sphere, an obstacle and two buttons, one of them pressed twice.
const TASK: &str = "
version: 2
user: fastest
model: mobl-arms
name: picture
time_limit_s: 2
scene:
  slot: {kind: sphere, at: [0.4, 0.15, -0.1], radius: 0.05}
  wall: {kind: obstacle, at: [0.5, 0.2, -0.3], size: [0.1, 0.2, 0.02]}
  panel:
    kind: group
    at: [0.45, -0.1, -0.3]
    tilt_deg: 60
    objects:
      left: {kind: button, at: [0, 0.04, 0], size: [0.03, 0.05, 0.01]}
      right: {kind: button, at: [0, -0.04, 0], size: [0.03, 0.05, 0.01]}
script: [{press: panel.left}, {dwell: {in: slot, for_s: 0.2}}, {press: panel.right}, {press: panel.left}]
";

fn parts() -> (Model, Task) {
    let task = Task::from_yaml(TASK, "picture.yaml").unwrap();
    (Model::new(&builtin("mobl-arms").unwrap()).unwrap(), task)
}

/// Moments of an arm that is lifted, whatever the physics makes of it, with more and more active muscles.
fn moments(model: &Model, task: &Task) -> Vec<Snapshot> {
    let first = Env::new(model, task, 1).unwrap().peek();
    let at = |k: u32| {
        let (mut moment, lifted) = (first.clone(), 0.1 * f64::from(k));
        moment.body.qpos = vec![0.3 + lifted, 0.4 + 2.0 * lifted, -0.2, 1.4 - lifted, 0.2];
        moment.body.act.iter_mut().zip(0..).for_each(|(act, k)| *act = lifted * f64::from(k % 3));
        moment.task.phase = f64::from(k / 2);
        moment
    };
    (0..5).map(at).collect()
}

/// Compares a picture with its file, or writes the file where that is asked for.
fn check(name: &str, svg: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pictures").join(name);
    if std::env::var_os("MYO_BLESS").is_some() {
        std::fs::write(&path, svg).unwrap();
    }
    let file = std::fs::read_to_string(&path).unwrap_or_default();
    let line = file.lines().zip(svg.lines()).position(|(old, new)| old != new).unwrap_or(0);
    assert!(file == svg, "{name} is drawn in another way, first at line {}", line + 1);
}

#[test]
fn a_moment_is_drawn_as_it_was() {
    let (model, task) = parts();
    let painter = Painter::new(&model, &task).unwrap();
    check("moment.svg", &painter.moment(&moments(&model, &task)[2]).unwrap().svg());
}

#[test]
fn an_episode_is_drawn_as_it_was() {
    let (model, task) = parts();
    let painter = Painter::new(&model, &task).unwrap();
    check("episode.svg", &painter.episode(&moments(&model, &task)).unwrap().svg());
    let nobody = painter.episode(&[]).unwrap();
    assert_eq!(nobody.shapes.len(), 4, "trunk, shoulders, neck and head");
}

#[test]
fn moments_of_another_body_are_refused() {
    let (model, task) = parts();
    let painter = Painter::new(&model, &task).unwrap();
    let mut moment = moments(&model, &task).remove(0);
    moment.body.act.pop();
    let refused = painter.moment(&moment).unwrap_err().to_string();
    assert_eq!(refused, "act of the snapshot has 25 entries, expected 26");
    assert!(painter.episode(&[moment]).is_err());
}
