//! The built `myo` program, run as a user runs it.

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

/// Otherwise the program would compute with another level than it was asked for, and not say so.
#[test]
fn every_command_refuses_a_level_that_there_is_not() {
    let with = |level: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
        command.args(["task", "list"]).env("MYO_LEVEL", level).output().expect("the program starts")
    };
    let sentence =
        "MYO_LEVEL is \"avx\", which is no level; levels are portable, avx2, avx512, and this processor has portable";
    assert_refused(&with("avx"), sentence);
    assert_eq!(with("avx").stdout, b"");
    assert_eq!(stdout(&with("portable")), stdout(&with("")));
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
        "completions",
        "man",
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
    let result = json(&myo(folder.path(), &short_training("3k", &["--json", "--seed", "3"])));
    assert_eq!((&result["run"], &result["stopped_by"]), (&"runs/pointing-single-1".into(), &"steps".into()));
    assert_eq!((&result["env_steps"], &result["seed"]), (&3072.into(), &3.into()));
    assert_eq!(result["evaluation"]["episodes"], 1000);

    let run = folder.path().join("runs/pointing-single-1");
    for file in ["config.json", "metrics.csv", "evaluation.json", "tensorboard", "checkpoints"] {
        assert!(run.join(file).exists(), "{file}");
    }
    let metrics = std::fs::read_to_string(run.join("metrics.csv")).unwrap();
    assert_eq!(metrics.lines().count(), 1 + 6);
    let rows: Vec<Vec<&str>> = metrics.lines().map(|line| line.split(',').collect()).collect();
    // All environments that were not done before meet the time limit in the fifth update.
    let fifth = |name: &str| rows[5][rows[0].iter().position(|column| *column == name).expect(name)].parse::<f64>();
    assert!((1.0..1.5).contains(&fifth("solver_rounds").unwrap()), "{metrics}");
    assert_eq!(fifth("solver_unsolved"), Ok(0.0));
    let shown = stdout(&myo(folder.path(), &["task", "show", "runs/pointing-single-1"]));
    assert_eq!(myo::tasks::Task::from_yaml(&shown, "run").unwrap(), myo::tasks::preset("pointing-single").unwrap());

    let evaluate = |more: &[&str]| {
        let args = [&["eval", "runs/pointing-single-1", "--episodes", "20", "--json"], more].concat();
        json(&myo(folder.path(), &args))
    };
    let evaluation = evaluate(&[]);
    assert_eq!((&evaluation["episodes"], &evaluation["env_steps"]), (&20.into(), &3072.into()));
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

/// Starts a training, presses Ctrl-C when `run` has two updates, and gives back what it wrote.
#[cfg(unix)]
fn interrupt(folder: &Path, args: &[&str], run: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
    let training = command.args(args).current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = training.spawn().unwrap();
    let metrics = folder.join(run).join("metrics.csv");
    while std::fs::read_to_string(&metrics).unwrap_or_default().lines().count() < 3 {
        assert!(child.try_wait().unwrap().is_none(), "the training goes on");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130));
    output
}

/// Runs the command behind `next: ` in a shell, as a user who copies it.
#[cfg(unix)]
fn run_next(folder: &Path, told: &Output) -> Output {
    let told = String::from_utf8(told.stdout.clone()).unwrap();
    let next = told.lines().find_map(|line| line.strip_prefix("next: ")).expect("what to do next is told");
    Command::new("sh").args(["-c", next]).current_dir(folder).output().unwrap()
}

#[cfg(unix)]
#[test]
fn interrupted_training_stops_with_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let output = interrupt(folder.path(), &short_training("1G", &["--out", "run"]), "run");
    assert!(String::from_utf8_lossy(&output.stdout).contains("train --resume run"));
    assert!(newest_checkpoint(&folder.path().join("run")).updates() >= 2);
}

#[cfg(unix)]
#[test]
fn commands_that_are_told_can_be_copied() {
    for run in ["it's my $HOME; `reboot` *&|<>\\\"", "-x"] {
        let folder = tempfile::tempdir().unwrap();
        let out = format!("--out={run}");
        let trained = myo(folder.path(), &short_training("512", &[&out]));
        assert!(trained.status.success(), "{run}: {}", stderr(&trained));
        let evaluated = stdout(&run_next(folder.path(), &trained));
        assert!(evaluated.contains("of 10,000 fresh episodes"), "{run}: {evaluated}");
    }
    let folder = tempfile::tempdir().unwrap();
    let stopped = interrupt(folder.path(), &short_training("64k", &["--out", "my run"]), "my run");
    stdout(&run_next(folder.path(), &stopped));
    assert_eq!(newest_checkpoint(&folder.path().join("my run")).env_steps(), 64_000_u64.next_multiple_of(512));
}

#[cfg(unix)]
#[test]
fn an_interrupted_training_of_several_seeds_goes_on_with_the_same_result() {
    let folder = tempfile::tempdir().unwrap();
    let both = ["--seeds", "3", "--seed", "4", "--out"];
    let whole = json(&myo(folder.path(), &short_training("32k", &[&both[..], &["whole", "--json"]].concat())));
    let args = short_training("32k", &[&both[..], &["parts"]].concat());
    let stopped = interrupt(folder.path(), &args, "parts/seed-5");
    assert!(String::from_utf8_lossy(&stopped.stdout).contains("train --resume parts"));
    assert!(!folder.path().join("parts/seed-6").exists());
    // Somewhere else, as after an upload.
    std::fs::rename(folder.path().join("parts"), folder.path().join("moved")).unwrap();
    let output = myo(folder.path(), &["train", "--resume", "moved", "--json"]);
    assert!(stderr(&output).contains("seed 4 is done"), "{}", stderr(&output));
    let parts = json(&output);
    // All but the times and the folder.
    let results = |all: &Value| {
        let rows = all["runs"].as_array().unwrap().iter();
        let keys = ["seed", "env_steps", "updates", "stopped_by", "evaluation"];
        let rows: Vec<Value> = rows.map(|row| keys.iter().map(|key| row[*key].clone()).collect()).collect();
        (rows, all["mean"]["success"].clone(), all["sd"]["effort"].clone(), all["reached"].clone())
    };
    assert_eq!(results(&parts), results(&whole));
    assert_eq!(parts["runs"][0]["run"], "moved/seed-4");
    for seed in ["seed-4", "seed-5", "seed-6"] {
        let [whole, moved] = ["whole", "moved"].map(|run| newest_checkpoint(&folder.path().join(run).join(seed)));
        assert!(whole == moved, "{seed}");
    }
    // With nothing left to do it tells the same, with a higher limit all go on, and one may go on alone.
    assert_eq!(json(&myo(folder.path(), &["train", "--resume", "moved", "--json"])), parts);
    let further = json(&myo(folder.path(), &["train", "--resume", "moved", "--steps", "33k", "--json"]));
    assert_eq!(further["mean"]["env_steps"], 33_280.0);
    assert_eq!(json(&myo(folder.path(), &["train", "--resume", "moved", "--json"])), further, "the limit is kept");
    let alone = json(&myo(folder.path(), &["train", "--resume", "whole/seed-6", "--steps", "33k", "--json"]));
    assert_eq!(alone["evaluation"], further["runs"][2]["evaluation"]);
}

#[test]
fn a_warm_start_with_several_seeds_goes_on_without_the_other_run() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("1k", &["--out", "first"])));
    let warm = ["train", "pointing-single", "--from", "first", "--until", "off", "--envs", "32", "--steps", "512"];
    let all = json(&myo(folder.path(), &[&warm[..], &["--seeds", "2", "--out", "both", "--json"]].concat()));
    // As if it had been killed before the second began.
    std::fs::remove_dir_all(folder.path().join("both/seed-2")).unwrap();
    std::fs::remove_file(folder.path().join("both/seeds.json")).unwrap();
    std::fs::remove_dir_all(folder.path().join("first")).unwrap();
    let seeds: Value = serde_json::from_value(all.clone()).unwrap();
    let one = serde_json::json!({"runs": [seeds["runs"][0]]});
    std::fs::write(folder.path().join("both/seeds.json"), one.to_string()).unwrap();
    let again = json(&myo(folder.path(), &["train", "--resume", "both", "--json"]));
    assert_eq!(again["runs"][1]["evaluation"], all["runs"][1]["evaluation"]);
    assert_eq!(again["mean"]["success"], all["mean"]["success"]);
}

#[test]
fn seeds_beyond_the_greatest_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let greatest = u64::MAX.to_string();
    let refused = myo(folder.path(), &short_training("512", &["--seeds", "2", "--seed", &greatest]));
    assert_refused(&refused, "it can be at most 18446744073709551614");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left");
    let one = json(&myo(folder.path(), &short_training("512", &["--seeds", "1", "--seed", &greatest, "--json"])));
    assert_eq!(one["runs"][0]["seed"], u64::MAX);
}

#[test]
fn runs_are_called_like_the_file_of_their_task() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("tasks")).unwrap();
    let text = stdout(&here(&["task", "show", "pointing-single"]));
    std::fs::write(folder.path().join("tasks/my.yaml"), text).unwrap();
    let args = ["train", "tasks/my.yaml", "--envs", "8", "--steps", "64", "--until", "off", "--json"];
    assert_eq!(json(&myo(folder.path(), &args))["run"], "runs/my-1");
    let several = json(&myo(folder.path(), &[&args[..], &["--seeds", "1"]].concat()));
    assert_eq!((&several["folder"], &several["runs"][0]["run"]), (&"runs/my-2".into(), &"runs/my-2/seed-1".into()));
    let hint = "runs/my-2 holds the runs of several seeds; name one of them, such as runs/my-2/seed-1";
    assert_refused(&myo(folder.path(), &["eval", "runs/my-2"]), hint);
    assert_refused(&myo(folder.path(), &["train", "ar", "--from", "runs/my-2"]), hint);
}

/// Bytes that would command a terminal.
fn commands_terminal(output: &Output) -> bool {
    let all = [&output.stdout[..], &output.stderr].concat();
    String::from_utf8(all).unwrap().chars().any(|c| c.is_control() && c != '\n')
}

#[test]
fn text_from_files_does_not_command_the_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let evil = "run\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m\n  fake line";
    let shown = r"run\u{1b}]0;owned\u{7}\u{1b}[2J\u{9b}31m";
    let trained = myo(folder.path(), &short_training("2k", &["--out", evil]));
    let told = stdout(&trained) + &stderr(&trained);
    assert!(!commands_terminal(&trained), "{told:?}");
    assert!(told.contains(shown), "{told}");
    let evaluated = myo(folder.path(), &["eval", evil, "--episodes", "4"]);
    assert!(evaluated.status.success() && !commands_terminal(&evaluated), "{}", stderr(&evaluated));

    // A task with such a name is none.
    let text = stdout(&here(&["task", "show", "pointing-single"]));
    let named = text.replace("name: pointing-single", r#"name: "a\e[2J""#);
    assert_ne!(named, text);
    std::fs::write(folder.path().join("named.yaml"), named).unwrap();
    let refused = myo(folder.path(), &["train", "named.yaml"]);
    assert!(stderr(&refused).contains("`name` has the control character U+001B") && !commands_terminal(&refused));

    // In messages about the file, and in its name.
    for text in
        ["\"a\\e[2J\": 1\n", "version: 1\nname: x\nmodel: \"a\\e[2J\"\ntargets: []\n", "a\u{1b}[2J: 1\n", "\u{9b}"]
    {
        std::fs::write(folder.path().join("bad.yaml"), text).unwrap();
        let refused = myo(folder.path(), &["task", "check", "bad.yaml"]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(!commands_terminal(&refused), "{:?}", stderr(&refused));
    }
    let unknown = myo(folder.path(), &["eval", "a\u{1b}[2J"]);
    assert!(!commands_terminal(&unknown) && stderr(&unknown).contains(r"a\u{1b}[2J is not a run folder"));

    // What is shown to another program is the file itself.
    let raw = "name: \u{202e}x\n";
    std::fs::write(folder.path().join("raw.yaml"), text.replace("name: pointing-single\n", raw)).unwrap();
    assert!(stdout(&myo(folder.path(), &["task", "show", "raw.yaml"])).contains(raw));
}

#[test]
fn a_policy_can_be_tried_on_another_task() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("2k", &["--out", "run"])));
    let evaluate = |more: &[&str]| {
        let args = [&["eval", "run", "--episodes", "16", "--seed", "3", "--json"], more].concat();
        let output = myo(folder.path(), &args);
        (json(&output), stderr(&output))
    };
    let (own, _) = evaluate(&[]);
    let (same, told) = evaluate(&["--task", "pointing-single"]);
    assert_eq!((same, told.as_str()), (own.clone(), ""), "nothing is told where nothing differs");

    let (other, told) = evaluate(&["--task", "mobile-typing"]);
    assert_eq!((&other["task"], &other["trained_task"]), (&"mobile-typing".into(), &"pointing-single".into()));
    assert_eq!(other["targets"].as_array().unwrap().len(), 5);
    assert_ne!(other["return"], own["return"]);
    assert_eq!(told, "", "it observes the same");

    let text = stdout(&here(&["task", "show", "pointing-single"]));
    let seen = text.clone() + "observation: {joint_acceleration: true, phase: false, touch: false}\n";
    std::fs::write(folder.path().join("seen.yaml"), seen).unwrap();
    let (_, told) = evaluate(&["--task", "seen.yaml"]);
    let new = "5 observations that the policy does not know and does not use: joint_acceleration.elv_angle, ";
    let gone = "2 observations that the policy knows and does not get: phase, touch";
    assert!(told.contains(new) && told.contains(gone), "{told}");

    let more_text = stdout(&here(&["model", "export", "mobl-arms-uitb", "--format", "yaml"]));
    let renamed = more_text.replace("DELT1", "OTHER1");
    assert_ne!(renamed, more_text);
    std::fs::write(folder.path().join("arm.yaml"), renamed).unwrap();
    std::fs::write(folder.path().join("mine.yaml"), text.replace("mobl-arms-uitb", "arm.yaml")).unwrap();
    let refused = myo(folder.path(), &["eval", "run", "--task", "mine.yaml"]);
    assert_refused(&refused, "OTHER1");
    assert!(stderr(&refused).contains("which the policy does not know"), "{}", stderr(&refused));
}

#[test]
fn a_checkpoint_can_be_chosen() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("1k", &["--out", "run"])));
    let keep = folder.path().join("early.ckpt");
    std::fs::copy(folder.path().join("run/checkpoints/step_000000001024.ckpt"), keep).unwrap();
    stdout(&myo(folder.path(), &["train", "--resume", "run", "--steps", "2k"]));
    let evaluate = |checkpoint: &[&str]| {
        let args = [&["eval", "run", "--episodes", "16", "--seed", "3", "--json"], checkpoint].concat();
        json(&myo(folder.path(), &args))
    };
    let steps = |result: &Value| result["env_steps"].as_u64().unwrap();
    let (newest, early) = (evaluate(&[]), evaluate(&["--checkpoint", "early.ckpt"]));
    assert_eq!((steps(&newest), steps(&early)), (2048, 1024));
    assert_ne!(newest["return"], early["return"]);
    assert_eq!(evaluate(&["--checkpoint", "1024"]), early);
    assert_eq!(evaluate(&["--checkpoint", "2_048"]), newest);
    let refused =
        |which, sentence| assert_refused(&myo(folder.path(), &["eval", "run", "--checkpoint", which]), sentence);
    refused("3k", "run has no checkpoint of 3000 control steps; it has those of 1024, 2048");
    refused("nowhere.ckpt", "cannot use the checkpoint nowhere.ckpt");
    refused("run/config.json", "this is not a checkpoint");
    refused("run", "cannot use the checkpoint run: ");
    let mut bytes = std::fs::read(folder.path().join("early.ckpt")).unwrap();
    bytes[300] ^= 1;
    std::fs::write(folder.path().join("early.ckpt"), bytes).unwrap();
    refused("early.ckpt", "the checkpoint is damaged");
    // That of a task with other observations, without being told that the task is another one.
    let task = stdout(&here(&["task", "show", "pointing-single"])) + "observation: {phase: false}\n";
    std::fs::write(folder.path().join("mine.yaml"), task).unwrap();
    let other = ["train", "mine.yaml", "--out", "other", "--until", "off", "--envs", "8", "--steps", "64"];
    stdout(&myo(folder.path(), &other));
    refused("other/checkpoints/step_000000000064.ckpt", "does not fit");
}

#[cfg(unix)]
#[test]
fn bash_completes_commands_options_and_values() {
    let script = stdout(&here(&["completions", "bash"]));
    let complete = |line: &str| {
        let words: Vec<String> = line.split(' ').map(|word| format!("'{word}'")).collect();
        let ask = format!(
            "{script}\nCOMP_WORDS=({}); COMP_CWORD={}; COMPREPLY=(); _myo myo '{}' '{}'; echo \"${{COMPREPLY[@]}}\"",
            words.join(" "),
            words.len() - 1,
            line.split(' ').next_back().unwrap(),
            line.rsplit(' ').nth(1).unwrap(),
        );
        stdout(&Command::new("bash").args(["--norc", "-c", &ask]).output().expect("bash is there"))
    };
    assert_eq!(complete("myo tra").trim(), "train");
    assert_eq!(complete("myo train --see").trim(), "--seed --seeds");
    assert_eq!(complete("myo train --backend g").trim(), "gpu");
    assert_eq!(complete("myo task che").trim(), "check");
}

#[test]
fn manual_pages_are_written_for_every_command() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(stdout(&myo(folder.path(), &["man", "--out", "."])), "");
    for (page, words) in [("myo.1", &["man"][..]), ("myo-task-check.1", &["man", "task", "check"])] {
        let text = std::fs::read_to_string(folder.path().join(page)).unwrap();
        assert_eq!(text, stdout(&here(words)), "{page}");
        assert!(text.contains(".TH") && text.contains(".SH NOTES"), "{text}");
    }
    assert_refused(
        &here(&["man", "task", "fly"]),
        "`myo task` has no command `fly`; there are list, show, check, schema",
    );
    assert_refused(&myo(folder.path(), &["man", "--out", "nowhere"]), "cannot write nowhere");
}

/// What a user may pass by mistake where a file is expected; the names tell what is wrong.
fn bad_files(folder: &Path) -> Vec<String> {
    let files: [(&str, Vec<u8>); 6] = [
        ("empty.yaml", Vec::new()),
        ("picture.yaml", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec()),
        ("latin1.yaml", b"name: caf\xe9\n".to_vec()),
        ("list.yaml", b"- 1\n- 2\n".to_vec()),
        ("huge.yaml", vec![b'['; 4 << 20]),
        ("long.yaml", [b"name: ".to_vec(), vec![b'x'; 4 << 20]].concat()),
    ];
    for (name, bytes) in &files {
        std::fs::write(folder.join(name), bytes).unwrap();
    }
    std::fs::create_dir(folder.join("folder.yaml")).unwrap();
    files.iter().map(|(name, _)| (*name).to_owned()).chain(["folder.yaml".into(), "absent.yaml".into()]).collect()
}

#[test]
fn files_that_are_no_task_or_model_are_refused_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let commands: [&[&str]; 7] = [
        &["train"],
        &["task", "check"],
        &["eval", "run", "--task"],
        &["bench", "env", "--task"],
        &["bench", "train"],
        &["model", "show"],
        &["model", "export", "--out", "made"],
    ];
    for file in bad_files(folder.path()) {
        for command in commands {
            let output = myo(folder.path(), &[command, &[&file]].concat());
            assert_refused(&output, &file);
            let told = stderr(&output);
            assert!(told.len() < 2000, "{command:?} {file}: {} bytes are told", told.len());
        }
    }
    assert!(!folder.path().join("made").exists() && !folder.path().join("runs").exists(), "nothing is left");
}

#[test]
fn damaged_runs_are_refused_by_every_command() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    let whole = std::fs::read_to_string(folder.path().join("run/config.json")).unwrap();
    let mut odd: Value = serde_json::from_str(&whole).unwrap();
    odd["run"]["task"]["targets"] = "none".into();
    let commands: [&[&str]; 4] = [&["eval"], &["train", "--resume"], &["train", "ar", "--from"], &["task", "show"]];
    let damages = [("", "EOF"), ("{", "EOF"), ("[]", "config.json"), ("\0\u{1}", "line 1"), (&whole[..200], "EOF")];
    for (text, sentence) in damages {
        std::fs::write(folder.path().join("run/config.json"), text).unwrap();
        for command in commands {
            let refused = myo(folder.path(), &[command, &["run"]].concat());
            assert_refused(&refused, sentence);
            assert!(stderr(&refused).contains("cannot understand run/config.json: "), "{}", stderr(&refused));
        }
    }
    std::fs::write(folder.path().join("run/config.json"), odd.to_string()).unwrap();
    for command in [&["eval", "run"][..], &["train", "--resume", "run"], &["task", "show", "run"]] {
        assert_refused(&myo(folder.path(), command), "cannot understand run/config.json: ");
    }
    // What is no run at all.
    std::fs::write(folder.path().join("file"), "").unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    for (name, command) in
        ["file", "empty", "absent"].iter().flat_map(|name| commands[..3].iter().map(move |c| (name, c)))
    {
        let refused = myo(folder.path(), &[command, &[*name][..]].concat());
        assert_refused(&refused, name);
    }
}

#[test]
fn numbers_that_nobody_can_mean_are_refused() {
    let greatest = u64::MAX.to_string();
    for args in [
        &["train", "ar", "--envs", "0"][..],
        &["train", "ar", "--seeds", "0"],
        &["train", "ar", "--seed", "-1"],
        &["train", "ar", "--steps", "1e30"],
        &["train", "ar", "--until", "nan"],
        &["train", "ar", "--threads", &greatest],
        &["eval", "run", "--episodes", "0"],
    ] {
        let output = here(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {}", stderr(&output));
        let value = args.last().unwrap();
        assert!(stderr(&output).contains(&format!("'{value}'")), "{args:?}: {}", stderr(&output));
    }
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
