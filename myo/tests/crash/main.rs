//! Trainings that are killed, or whose disk fails, at every one of their file operations, and gone on with: they end as if
//! nothing had happened. A fixed sample of all cases; every one with `MYO_TEST_ALL=1`.
#![cfg(target_os = "linux")]

mod left;
mod plateau;
mod scene;
mod together;

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use myo::train::RunFolder;

use scene::{Scene, TASK, errors, software_card};

#[test]
fn a_training_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    Scene::new(&["--until", "off", "--steps", "8192"]).check_all();
}

#[test]
fn going_on_with_a_training_may_be_stopped_at_any_file_operation() {
    Scene::new(&["--until", "off", "--steps", "8192"]).begun(|operations| operations / 2).check_all();
}

#[test]
fn going_on_to_a_new_goal_may_be_stopped_at_any_file_operation() {
    Scene::new(&["--until", "off", "--steps", "4096"]).further(4096).check_all();
}

#[test]
fn a_training_with_a_goal_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    // The first seed that reaches its goal in the middle of its steps.
    let scene = (1..40).find_map(|seed| {
        let scene = Scene::new(&["--until", "0.07", "--steps", "30720", "--seed", &seed.to_string()]);
        let (left, _) = scene.undisturbed();
        (5..15).contains(&left.updates()[0]).then_some(scene)
    });
    scene.expect("a seed with a goal in reach").check_all();
}

#[test]
fn a_training_that_runs_away_and_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    let runaway = ["--set", "kl_target=0", "--set", "learning_rate=0.01", "--set", "kl_max=0.05"];
    let scene = Scene::new(&[&["--until", "off", "--steps", "8192"][..], &runaway].concat());
    let run = scene.place.path().join("told");
    assert!(errors(&scene.start(&run, &[])).contains("ran away"));
    scene.check_all();
}

#[test]
fn a_warm_start_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    let mut scene = Scene::new(&["--until", "off", "--steps", "4096"]);
    let source = scene.place.path().join("source");
    assert!(scene.start(&source, &[]).status.success());
    // The networks are those of the source.
    scene.training.truncate(7);
    let more = ["--set", "rollout_s=3.2", "--until", "off", "--steps", "4096", "--from", source.to_str().unwrap()];
    scene.training.extend(more.map(String::from));
    scene.check_all();
}

#[test]
fn a_training_on_a_card_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    let Some(card) = software_card() else {
        println!("skipped: there is no driver that computes a graphics card on the processor");
        return;
    };
    // A start takes seconds there.
    Scene::new(&["--until", "off", "--steps", "4096", "--backend", "gpu", "--device", &card]).sample(1).check_all();
}

#[test]
fn an_edited_description_is_checked_as_a_new_task_and_new_options_are() {
    let scene = Scene::new(&["--until", "off", "--steps", "2048"]);
    let run = scene.place.path().join("run");
    assert!(scene.start(&run, &[]).status.success());
    let file = run.join("config.json");
    let whole: serde_json::Value = serde_json::from_slice(&fs::read(&file).unwrap()).unwrap();
    let edits = [
        ("/run/task/targets", serde_json::json!([]), "has no target"),
        (
            "/run/task/time_limit_s",
            serde_json::json!(1e308),
            "`time_limit_s` is 1e308 s; it must be from 0.001 to 600 s",
        ),
        (
            "/run/until",
            serde_json::json!(2),
            "until is 2; it must be \"plateau\", a share above 0 and at most 1, or null",
        ),
        ("/run/steps", serde_json::json!(0), "steps is 0; it must be at least 1"),
        ("/run/backend", serde_json::json!("tpu"), "backend is \"tpu\"; it must be \"cpu\" or \"gpu\""),
        ("/run/backend", serde_json::json!("gpu"), "backend is \"gpu\", so device must name the graphics card"),
        ("/run/version", serde_json::json!(["0.1.0"]), "invalid type"),
    ];
    for (key, value, sentence) in edits {
        let mut edited = whole.clone();
        *edited.pointer_mut(key).expect("a key of the description") = value;
        fs::write(&file, edited.to_string()).unwrap();
        let eval = ["eval", run.to_str().unwrap()];
        let resume = ["train", "--resume", run.to_str().unwrap(), "--steps", "4096"];
        for args in [&eval[..], &resume] {
            let output = Command::new(env!("CARGO_BIN_EXE_myo")).args(args).output().expect("the program starts");
            let text = errors(&output);
            assert_eq!(output.status.code(), Some(1), "{key}: {text}");
            assert!(text.contains("config.json") && text.contains(sentence), "{key}: {text}");
        }
    }
}

/// A training that goes on until it is told to stop.
fn endless(folder: &Path, before: &str) -> std::process::Child {
    fs::write(folder.join("crash.yaml"), TASK).unwrap();
    let myo = env!("CARGO_BIN_EXE_myo");
    let command =
        format!("{before} exec {myo} train crash.yaml --out run --until off --steps 1G --envs 32 --threads 1");
    let mut shell = Command::new("sh");
    shell.args(["-c", &command]).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = shell.spawn().unwrap();
    let rows = || fs::read_to_string(folder.join("run/metrics.csv")).unwrap_or_default().lines().count();
    while rows() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "the training goes on");
        std::thread::sleep(Duration::from_millis(20));
    }
    child
}

fn signal(child: &std::process::Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

#[test]
fn a_closed_terminal_stops_a_training_unless_that_was_to_be_ignored() {
    let place = tempfile::tempdir().unwrap();
    let mut heard = endless(place.path(), "");
    signal(&heard, "-HUP");
    assert_eq!(heard.wait().unwrap().code(), Some(130), "it stops with a checkpoint");
    assert!(RunFolder::open(&place.path().join("run")).unwrap().latest_checkpoint().unwrap().checkpoint.is_some());

    // As `nohup` and shells do for what runs in the background.
    let place = tempfile::tempdir().unwrap();
    let mut deaf = endless(place.path(), "trap '' HUP INT;");
    signal(&deaf, "-HUP");
    signal(&deaf, "-INT");
    let rows = || fs::read_to_string(place.path().join("run/metrics.csv")).unwrap().lines().count();
    let before = rows();
    while rows() < before + 3 {
        assert!(deaf.try_wait().unwrap().is_none(), "the training goes on");
        std::thread::sleep(Duration::from_millis(20));
    }
    signal(&deaf, "-TERM");
    assert_eq!(deaf.wait().unwrap().code(), Some(130));
}
