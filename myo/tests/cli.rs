//! The built `myo` program, run as a user runs it.

use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use myo::train::Checkpoint;
use serde_json::Value;

fn myo(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
    command.args(args).current_dir(folder).output().expect("the program starts")
}

fn here(args: &[&str]) -> Output {
    myo(Path::new("."), args)
}

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", stderr(output));
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> Value {
    serde_json::from_str(&stdout(output)).unwrap()
}

/// Fails with a sentence and the status for failures, not that for wrong usage or a panic.
fn assert_refused(output: &Output, sentence: &str) {
    assert_eq!(output.status.code(), Some(1), "{}", stderr(output));
    assert!(stderr(output).contains(sentence), "{}", stderr(output));
}

/// Arguments of a training of `updates` updates of 512 control steps each.
fn short_training<'a>(steps: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let fixed = ["train", "pointing-single", "--until", "off", "--envs", "32", "--steps", steps];
    let small = ["--set", "steps_per_update=16", "--set", "policy_hidden=[16]", "--set", "value_hidden=[16]"];
    [&fixed[..], &small, more].concat()
}

fn newest_checkpoint(run: &Path) -> Checkpoint {
    let folder = myo::train::RunFolder::open(run).unwrap();
    let mut checkpoint = folder.latest_checkpoint().unwrap().checkpoint.expect("a whole checkpoint");
    checkpoint.forget_wall_time();
    checkpoint
}

#[test]
fn every_command_explains_itself_with_an_example() {
    for command in [
        "train",
        "eval",
        "devices",
        "task list",
        "task show",
        "task check",
        "task schema",
        "model list",
        "model show",
        "model export",
        "bench physics",
        "bench env",
        "bench train",
        "bench kernel",
        "bench nan",
    ] {
        let args: Vec<&str> = command.split(' ').chain(["--help"]).collect();
        let help = stdout(&here(&args));
        assert!(help.contains("Example") && help.contains(&format!("myo {command}")), "{command}: {help}");
    }
    assert!(stdout(&here(&["--help"])).contains("myo train pointing"));
}

#[test]
fn wrong_usage_has_status_2() {
    for args in [&["train"][..], &["fly"], &["train", "ar", "--steps", "0"], &["eval", "x", "--episodes", "-1"], &[]] {
        assert_eq!(here(args).status.code(), Some(2), "{args:?}");
    }
}

#[test]
fn unknown_names_get_the_nearest_ones() {
    assert_refused(&here(&["train", "pontin"]), "did you mean `pointing`");
    assert_refused(&here(&["task", "show", "mobile"]), "did you mean `mobile-typing`");
    assert_refused(&here(&["model", "show", "mobl-arm"]), "did you mean `mobl-arms`");
    assert_refused(&here(&["train", "ar", "--set", "discount=1"]), "did you mean `discount_per_s`");
}

#[test]
fn preset_is_shown_with_its_comments() {
    let text = stdout(&here(&["task", "show", "ar"]));
    assert_eq!(Some(text.as_str()), myo::tasks::preset_text("ar"));
}

#[test]
fn lists_are_json_on_request() {
    let tasks = json(&here(&["task", "list", "--json"]));
    let names: Vec<_> = tasks.as_array().unwrap().iter().map(|task| task["name"].as_str().unwrap()).collect();
    assert_eq!(names, myo::tasks::preset_names());
    assert_eq!(json(&here(&["model", "list", "--json"]))[0]["muscles"], 26);
    assert_eq!(json(&here(&["model", "show", "mobl-arms", "--json"]))["muscles"].as_array().unwrap().len(), 26);
    assert!(json(&here(&["task", "schema"]))["properties"]["targets"].is_object());
}

#[test]
fn mistakes_in_a_task_are_told_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = myo::tasks::preset_text("ar").unwrap();
    let line = 1 + text.lines().position(|line| line.contains("0.42, 0.15, -0.29")).unwrap();
    let files = [
        ("far.yaml", text.replace("0.42, 0.15, -0.29", "0.92, 0.15, -0.29"), format!("far.yaml:{line}:15: target 2")),
        ("key.yaml", text.replacen("dwell_s", "dwel_s", 1), ":5: unknown key `dwel_s`".into()),
        ("body.yaml", format!("model: mobl\n{text}"), "body.yaml:1:8: there is no built-in model `mobl`".into()),
        ("no.yaml", String::new(), "no.yaml:1:1: ".into()),
    ];
    for (name, text, expected) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
        assert_refused(&myo(folder.path(), &["task", "check", name]), &expected);
        assert_refused(&myo(folder.path(), &["train", name]), &expected);
        let output = myo(folder.path(), &["task", "check", name, "--json"]);
        assert_eq!(output.status.code(), Some(1));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&found["ok"], &found["errors"][0]["file"]), (&Value::Bool(false), &Value::from(name)));
        assert!(found["errors"][0]["line"].as_u64().unwrap() >= 1);
    }
    assert!(!folder.path().join("runs").exists(), "nothing was trained");
    assert_refused(&myo(folder.path(), &["task", "check", "absent.yaml"]), "cannot read absent.yaml");
}

#[test]
fn presets_can_be_trained() {
    for name in myo::tasks::preset_names() {
        assert!(json(&here(&["task", "check", name, "--json"]))["ok"].as_bool().unwrap(), "{name}");
    }
}

#[test]
fn exported_model_is_xml_with_all_muscles() {
    let xml = stdout(&here(&["model", "export", "mobl-arms", "--format", "mjcf"]));
    assert_balanced(&xml);
    let actuators = &xml[xml.find("<actuator").unwrap()..xml.find("</actuator>").unwrap()];
    assert_eq!(actuators.matches("name=").count(), 26);
}

/// Every element that is opened is closed, the last first, and text outside of elements is blank.
fn assert_balanced(xml: &str) {
    let mut open = Vec::new();
    for tag in xml.split('<').skip(1) {
        let (inside, after) = tag.split_once('>').expect("a tag ends");
        assert!(after.trim().is_empty() && inside.matches('"').count() % 2 == 0, "<{tag}");
        match inside.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if inside.ends_with('/') => {}
            None => open.push(inside.split(' ').next().unwrap()),
        }
    }
    assert!(open.is_empty() && xml.starts_with('<'), "{open:?}");
}

#[test]
fn exported_model_file_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let export = |model: &str| myo(folder.path(), &["model", "export", model, "--format", "yaml", "--out", "arm.yaml"]);
    assert_eq!(stdout(&export("mobl-arms")), "");
    let first = std::fs::read_to_string(folder.path().join("arm.yaml")).unwrap();
    stdout(&export("arm.yaml"));
    assert_eq!(first, std::fs::read_to_string(folder.path().join("arm.yaml")).unwrap());
    let missing = myo(folder.path(), &["model", "export", "mobl-arms", "--out", "no/such/arm.xml"]);
    assert_refused(&missing, "cannot write no/such/arm.xml");
}

#[test]
fn output_that_nobody_reads_is_no_failure() {
    for args in [&["task", "show", "ar"][..], &["task", "schema"], &["model", "export", "mobl-arms"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
        let mut child = command.args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let complaint = BufReader::new(child.stderr.take().unwrap()).lines().next();
        assert!(complaint.is_none(), "{complaint:?}");
        assert!(child.wait().unwrap().success());
    }
}

#[test]
fn training_leaves_a_run_that_can_be_evaluated() {
    let folder = tempfile::tempdir().unwrap();
    let result = json(&myo(folder.path(), &short_training("2k", &["--json", "--seed", "3"])));
    assert_eq!((&result["run"], &result["stopped_by"]), (&"runs/pointing-single-1".into(), &"steps".into()));
    assert_eq!((&result["env_steps"], &result["seed"]), (&2048.into(), &3.into()));
    assert_eq!(result["evaluation"]["episodes"], 1000);

    let run = folder.path().join("runs/pointing-single-1");
    for file in ["config.json", "metrics.csv", "evaluation.json", "tensorboard", "checkpoints"] {
        assert!(run.join(file).exists(), "{file}");
    }
    assert_eq!(std::fs::read_to_string(run.join("metrics.csv")).unwrap().lines().count(), 1 + 4);
    let shown = stdout(&myo(folder.path(), &["task", "show", "runs/pointing-single-1"]));
    assert_eq!(myo::tasks::Task::from_yaml(&shown, "run").unwrap(), myo::tasks::preset("pointing-single").unwrap());

    let evaluate = |more: &[&str]| {
        let args = [&["eval", "runs/pointing-single-1", "--episodes", "20", "--json"], more].concat();
        json(&myo(folder.path(), &args))
    };
    let evaluation = evaluate(&[]);
    assert_eq!((&evaluation["episodes"], &evaluation["env_steps"]), (&20.into(), &2048.into()));
    let success = evaluation["success"].as_f64().unwrap();
    assert_eq!(evaluation["targets"][0]["success"].as_f64(), Some(success));
    for key in ["movement_time_s", "movement_time_s_sd"] {
        assert!(evaluation["targets"][0].as_object().unwrap().contains_key(key), "{key}");
    }
    for key in ["final_distance_m", "effort", "episode_length_s", "return"] {
        assert!(evaluation[key].is_f64(), "{key}");
    }
    assert_eq!(evaluation, evaluate(&[]), "same seed, same episodes");
    assert_ne!(evaluation["return"], evaluate(&["--seed", "5"])["return"]);
}

#[test]
fn run_folders_are_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let train = |more: &[&str]| myo(folder.path(), &short_training("512", more));
    stdout(&train(&[]));
    stdout(&train(&[]));
    assert!(folder.path().join("runs/pointing-single-2").exists());
    let before = std::fs::read(folder.path().join("runs/pointing-single-1/config.json")).unwrap();
    assert_refused(&train(&["--out", "runs/pointing-single-1"]), "never overwritten");
    std::fs::create_dir(folder.path().join("mine")).unwrap();
    std::fs::write(folder.path().join("mine/notes.txt"), "not a run").unwrap();
    assert_refused(&train(&["--out", "mine"]), "mine-2");
    assert_eq!(before, std::fs::read(folder.path().join("runs/pointing-single-1/config.json")).unwrap());
}

#[test]
fn resumed_and_threaded_trainings_end_with_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    let train = |steps: &'static str, more: &[&str]| stdout(&myo(folder.path(), &short_training(steps, more)));
    train("2k", &["--out", "whole", "--threads", "2"]);
    train("1k", &["--out", "parts", "--threads", "1"]);
    let again = myo(folder.path(), &["train", "--resume", "parts"]);
    assert_refused(&again, "raise it with --steps");
    stdout(&myo(folder.path(), &["train", "--resume", "parts", "--steps", "2k"]));
    assert!(newest_checkpoint(&folder.path().join("whole")) == newest_checkpoint(&folder.path().join("parts")));
    let steps = |run: &str| {
        let metrics = std::fs::read_to_string(folder.path().join(run).join("metrics.csv")).unwrap();
        metrics.lines().filter_map(|line| Some(line.split_once(',')?.0.to_owned())).collect::<Vec<_>>()
    };
    assert_eq!(steps("whole"), steps("parts"));
}

#[test]
fn damaged_checkpoint_is_told_and_the_one_before_used() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let whole = folder.path().join("run/checkpoints/step_000000000512.ckpt");
    let mut bytes = std::fs::read(&whole).unwrap();
    bytes[300] ^= 1;
    std::fs::write(folder.path().join("run/checkpoints/step_000000001024.ckpt"), &bytes).unwrap();
    let output = myo(folder.path(), &["eval", "run", "--episodes", "4"]);
    assert!(output.status.success());
    assert!(stderr(&output).contains("step_000000001024.ckpt cannot be used: the checkpoint is damaged"));
    assert!(stderr(&output).contains("512 control steps is used instead"), "{}", stderr(&output));
    std::fs::write(&whole, &bytes).unwrap();
    assert_refused(&myo(folder.path(), &["eval", "run", "--episodes", "4"]), "no checkpoint that can be used");
    assert_refused(&myo(folder.path(), &["eval", "elsewhere"]), "elsewhere is not a run folder");
}

#[cfg(unix)]
#[test]
fn interrupted_training_stops_with_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
    let training = command.args(short_training("1G", &["--out", "run"])).current_dir(folder.path());
    let mut child = training.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let metrics = folder.path().join("run/metrics.csv");
    while std::fs::read_to_string(&metrics).unwrap_or_default().lines().count() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "the training goes on");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let kill = [OsStr::new("-INT"), OsStr::new(&child.id().to_string())].map(OsStr::to_owned);
    assert!(Command::new("kill").args(kill).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    assert!(String::from_utf8_lossy(&output.stdout).contains("train --resume run"));
    assert!(newest_checkpoint(&folder.path().join("run")).updates() >= 2);
}

#[test]
fn benches_give_rows() {
    let physics = json(&here(&["bench", "physics", "--envs", "16", "--level", "portable", "--json"]));
    let env = json(&here(&["bench", "env", "--task", "pointing-single", "--envs", "16", "--json"]));
    for row in [&physics["rows"][0], &env["rows"][0]] {
        for key in
            ["backend", "level", "envs", "threads", "physics_steps_per_s", "control_steps_per_s", "machine", "date"]
        {
            assert!(!row[key].is_null(), "{key}: {row}");
        }
    }
    assert_refused(&here(&["bench", "physics", "--against-mujoco", "/no/python"]), "cannot run /no/python");
    let nan = json(&here(&["bench", "nan", "--steps", "20k", "--envs", "256", "--json"]));
    assert_eq!((&nan["non_finite"], nan["control_steps"].as_u64() >= Some(20_000)), (&0.into(), true));
    let args = ["bench", "train", "pointing-single", "--seeds", "2", "--steps", "512", "--envs", "32", "--json"];
    let train = json(&here(&args));
    assert_eq!((&train["rows"][1]["seed"], &train["rows"][1]["stopped_by"]), (&2.into(), &"steps".into()));
    assert_refused(&here(&["bench", "env", "--part", "physics"]), "`myo bench physics` measures the physics alone");
}

#[test]
fn operations_of_a_kernel_are_those_of_its_stages() {
    let folder = tempfile::tempdir().unwrap();
    let kernel = json(&myo(folder.path(), &["bench", "kernel", "--task", "ar", "--wgsl", "ar.wgsl", "--json"]));
    let stages = kernel["stages"].as_array().unwrap();
    let sum: u64 = stages.iter().map(|stage| stage["operations"].as_u64().unwrap()).sum();
    assert_eq!((kernel["operations"].as_u64(), &kernel["part"]), (Some(sum), &"env".into()));
    assert!(stages.iter().any(|stage| stage["stage"].as_str().unwrap().contains(" / ")));
    let text = std::fs::read_to_string(folder.path().join("ar.wgsl")).unwrap();
    assert!(text.contains("@compute @workgroup_size(64"), "{}", &text[..200.min(text.len())]);
}

#[test]
fn several_seeds_give_runs_of_their_own_and_a_mean() {
    let folder = tempfile::tempdir().unwrap();
    let train = |more: &[&str]| myo(folder.path(), &short_training("1k", more));
    let all = json(&train(&["--seeds", "2", "--seed", "4", "--out", "both", "--json"]));
    assert_eq!(all["reached"], 0);
    let runs = all["runs"].as_array().unwrap();
    assert_eq!(runs.iter().map(|run| run["seed"].as_u64().unwrap()).collect::<Vec<_>>(), [4, 5]);
    let success = |run: &Value| run["evaluation"]["success"].as_f64().unwrap();
    let mean = (success(&runs[0]) + success(&runs[1])) / 2.0;
    assert!((all["mean"]["success"].as_f64().unwrap() - mean).abs() < 1e-12);
    assert_eq!((&all["mean"]["env_steps"], &all["sd"]["env_steps"]), (&1024.0.into(), &0.0.into()));
    let kept: Value = serde_json::from_slice(&std::fs::read(folder.path().join("both/seeds.json")).unwrap()).unwrap();
    assert_eq!(kept, all);

    stdout(&train(&["--seed", "5", "--out", "alone"]));
    let parameters = |run: &str| newest_checkpoint(&folder.path().join(run)).to_bytes();
    assert!(parameters("both/seed-5") == parameters("alone"), "a seed does not depend on the ones before it");
    let table = stdout(&train(&["--seeds", "2", "--out", "again"]));
    assert!(["mean", "sd", "0 of 2 seeds"].iter().all(|word| table.contains(word)), "{table}");
    assert_refused(&train(&["--seeds", "2", "--out", "both"]), "choose another with --out");
}

#[test]
fn a_run_may_begin_with_what_another_learned() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("2k", &["--out", "first"])));
    // Other targets, more of them, another body, and the networks of the first run without being told.
    let warm = ["train", "public-display", "--from", "first", "--out", "second", "--until", "off"];
    let short = ["--envs", "32", "--steps", "512"];
    let output = myo(folder.path(), &[&warm[..], &short].concat());
    stdout(&output);
    assert!(stderr(&output).contains("starting from first after 2,048 control steps"), "{}", stderr(&output));
    let config: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("second/config.json")).unwrap()).unwrap();
    assert_eq!(config["run"]["from"], serde_json::json!({"run": "first", "env_steps": 2048}));
    assert_eq!(config["ppo"]["policy_hidden"], serde_json::json!([16]));
    // Both checkpoints are there: what was inherited, and the end.
    let checkpoints = myo::train::RunFolder::open(&folder.path().join("second")).unwrap().checkpoints().unwrap();
    assert_eq!(checkpoints.len(), 2);

    let refused = |args: &[&str], sentence| assert_refused(&myo(folder.path(), args), sentence);
    refused(&["train", "ar", "--from", "nowhere"], "nowhere is not a run folder");
    refused(&["train", "ar", "--from", "first", "--set", "policy_hidden=[8]"], "width of the hidden layers");
    assert!(!folder.path().join("runs").exists(), "nothing is left of what was refused");
}

#[test]
fn a_goal_beyond_what_the_task_allows_is_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let far = "version: 1\nname: far\ntargets:\n- kind: pointing\n  position: {x: [0.5, 0.8], y: 0, z: 0}\n  radius: 0.02\n  dwell_s: 0.05\n";
    std::fs::write(folder.path().join("far.yaml"), far).unwrap();
    let train = |until| {
        let args = ["train", "far.yaml", "--envs", "8", "--steps", "64", "--until", until];
        stderr(&myo(folder.path(), &args))
    };
    assert!(
        train("0.95").contains("% of the episodes can succeed, since targets lie out of reach, and the goal is 95.0 %")
    );
    assert!(!train("off").contains("of the episodes can succeed"));
}

#[test]
fn a_run_keeps_its_body_when_the_file_changes() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &["model", "export", "mobl-arms", "--format", "yaml", "--out", "arm.yaml"]));
    let task = stdout(&here(&["task", "show", "pointing-single"])).replace("model: mobl-arms-uitb", "model: arm.yaml");
    std::fs::write(folder.path().join("mine.yaml"), task).unwrap();
    let args = ["train", "mine.yaml", "--out", "run", "--envs", "8", "--steps", "64", "--until", "off"];
    stdout(&myo(folder.path(), &args));
    let evaluate = || json(&myo(folder.path(), &["eval", "run", "--episodes", "8", "--json"]));
    let before = evaluate();
    std::fs::write(folder.path().join("arm.yaml"), "no body any more").unwrap();
    assert_eq!(evaluate(), before);
    stdout(&myo(folder.path(), &["train", "--resume", "run", "--steps", "128"]));
}
