//! The built `myo` program on machines with a graphics card, with software that imitates one, and with neither.
//!
//! Training and measuring run on the first adapter, so on a machine without a card on the processor.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn run(folder: &Path, args: &[&str], without_drivers: bool) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
    command.args(args).current_dir(folder).env_remove("NODEVICE_SELECT").env_remove("XDG_RUNTIME_DIR");
    // Compiled kernels are kept from test to test, but not in the user's folder.
    command.env("MYO_CACHE_DIR", env!("CARGO_TARGET_TMPDIR"));
    if without_drivers {
        // Both names that Vulkan loaders know.
        command.env("VK_DRIVER_FILES", "/no/driver").env("VK_ICD_FILENAMES", "/no/driver");
    }
    command.output().expect("the program starts")
}

fn myo(folder: &Path, args: &[&str]) -> Output {
    run(folder, args, false)
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn json(output: &Output) -> Value {
    assert!(output.status.success(), "{}", stderr(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn assert_refused(output: &Output, sentence: &str) {
    assert_eq!(output.status.code(), Some(1), "{}", stderr(output));
    assert!(stderr(output).contains(sentence), "{}", stderr(output));
}

/// What `myo devices` lists. Without any the test fails, unless `MYO_NO_GPU` says that this is meant.
fn devices() -> Option<Value> {
    let listed = json(&myo(Path::new("."), &["devices", "--json"]));
    if listed["devices"].as_array().unwrap().is_empty() {
        assert_eq!(std::env::var("MYO_NO_GPU").as_deref(), Ok("1"), "no adapter; to skip this test, set MYO_NO_GPU=1");
        println!("skipped: MYO_NO_GPU=1, and there is no adapter");
        return None;
    }
    Some(listed)
}

/// Arguments of a training of so many control steps, in updates of 16 steps of the environments.
fn short_training<'a>(envs: &'a str, steps: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let fixed =
        ["train", "pointing-single", "--until", "off", "--envs", envs, "--steps", steps, "--out", "run", "--json"];
    [&fixed[..], &["--set", "rollout_s=0.8", "--set", "policy_hidden=[16]", "--set", "value_hidden=[16]"], more]
        .concat()
}

#[test]
fn adapters_are_listed_with_what_auto_takes() {
    let Some(listed) = devices() else { return };
    let all = listed["devices"].as_array().unwrap();
    for (number, device) in all.iter().enumerate() {
        assert_eq!(device["number"], number);
        assert!(["name", "kind", "backend", "driver"].iter().all(|key| device[*key].is_string()), "{device}");
        assert!(device["max_buffer_bytes"].as_u64() >= Some(128 << 20) && device["subgroups"].is_boolean(), "{device}");
    }
    let card = all.iter().position(|device| device["kind"] != "software");
    assert_eq!(listed["auto"], Value::from(card));
    assert_eq!(listed["hint"].is_null(), card.is_some());

    let text = String::from_utf8(myo(Path::new("."), &["devices"]).stdout).unwrap();
    let chosen = card.map_or("the processor".into(), |number| number.to_string());
    assert!(text.contains(all[0]["name"].as_str().unwrap()), "{text}");
    assert!(text.contains(&format!("`--backend auto` takes {chosen}")), "{text}");
}

#[test]
fn listing_adapters_prints_nothing_to_standard_error() {
    let Some(_) = devices() else { return };
    assert_eq!(stderr(&myo(Path::new("."), &["devices"])), "");
}

/// On Linux a driver is what the Vulkan loader finds; elsewhere it cannot be taken away.
#[cfg(target_os = "linux")]
#[test]
fn without_a_driver_it_is_said_what_to_install_and_the_processor_serves() {
    let bare = |args: &[&str]| run(Path::new("."), args, true);
    let listed = json(&bare(&["devices", "--json"]));
    assert_eq!((&listed["devices"], &listed["auto"]), (&Value::Array(Vec::new()), &Value::Null));
    assert!(listed["hint"].as_str().unwrap().contains("mesa-vulkan-drivers"));
    let text = String::from_utf8(bare(&["devices"]).stdout).unwrap();
    assert!(text.contains("auto` takes the processor") && text.contains("mesa-vulkan-drivers"), "{text}");

    assert_refused(&bare(&["train", "pointing-single", "--backend", "gpu"]), "no GPU was found");
    assert_refused(&bare(&["bench", "env", "--device", "0"]), "no GPU was found");
    let folder = tempfile::tempdir().unwrap();
    // So many that `auto` would take a card.
    let auto = run(folder.path(), &short_training("256", "4k", &["--threads", "1"]), true);
    let result = json(&auto);
    assert_eq!((&result["backend"], &result["device"]), (&"cpu".into(), &Value::Null));
}

/// The card is opened while the task is read.
#[test]
fn a_bad_task_is_told_whether_there_is_a_card_or_not() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my.yaml"), "version: 2\nnam: x\n").unwrap();
    for without_drivers in [false, true] {
        let refused = run(folder.path(), &["train", "my.yaml", "--backend", "gpu"], without_drivers);
        assert_refused(&refused, "my.yaml:2:1: unknown key `nam`");
        assert_eq!(stderr(&refused).lines().count(), 1, "{}", stderr(&refused));
    }
}

#[test]
fn names_that_fit_no_adapter_are_refused() {
    let Some(listed) = devices() else { return };
    let here = |args: &[&str]| myo(Path::new("."), args);
    let name = listed["devices"][0]["name"].as_str().unwrap();
    assert_refused(&here(&["train", "pointing-single", "--device", "voodoo"]), &format!("there is 0: {name}"));
    assert_refused(&here(&["eval", "x", "--device", "0"]), "not a run folder");
    assert_refused(&here(&["train", "ar", "--backend", "cpu", "--device", "0"]), "leave one of them out");
}

#[test]
fn software_alone_must_be_named() {
    let Some(listed) = devices() else { return };
    if !listed["auto"].is_null() {
        println!("skipped: there is a card, so the refusal of software cannot be seen");
        return;
    }
    let refused = myo(Path::new("."), &["train", "pointing-single", "--backend", "gpu"]);
    assert_refused(&refused, "only a software adapter is there");
    assert!(stderr(&refused).contains("--device 0"), "{}", stderr(&refused));
}

#[test]
fn a_run_on_the_gpu_goes_on_there_or_elsewhere() {
    let Some(listed) = devices() else { return };
    let name = &listed["devices"][0]["name"];
    let folder = tempfile::tempdir().unwrap();
    let training = myo(folder.path(), &short_training("32", "1k", &["--device", name.as_str().unwrap()]));
    assert!(stderr(&training).contains(&format!("on the gpu ({})", name.as_str().unwrap())), "{}", stderr(&training));
    let result = json(&training);
    assert_eq!((&result["backend"], &result["device"], &result["env_steps"]), (&"gpu".into(), name, &1024.into()));
    let config: Value = serde_json::from_slice(&std::fs::read(folder.path().join("run/config.json")).unwrap()).unwrap();
    assert_eq!((&config["run"]["backend"], &config["run"]["device"]), (&"gpu".into(), name));

    let resume = |steps: &str, more: &[&str]| {
        let args = [&["train", "--resume", "run", "--json", "--steps", steps], more].concat();
        json(&myo(folder.path(), &args))
    };
    let (there, elsewhere) = (resume("1536", &[]), resume("2k", &["--backend", "cpu"]));
    assert_eq!((&there["backend"], &there["env_steps"]), (&"gpu".into(), &1536.into()));
    assert_eq!((&elsewhere["backend"], &elsewhere["env_steps"]), (&"cpu".into(), &2048.into()));
    let evaluate =
        |more: &[&str]| json(&myo(folder.path(), &[&["eval", "run", "--episodes", "64", "--json"], more].concat()));
    let (gpu, cpu) = (evaluate(&["--device", "0"]), evaluate(&["--backend", "cpu"]));
    assert_eq!((&gpu["backend"], &gpu["device"], &cpu["backend"]), (&"gpu".into(), name, &"cpu".into()));
    let [a, b] = [gpu, cpu].map(|result| result["return"].as_f64().unwrap());
    assert!((a - b).abs() < 0.01 * b.abs(), "{a} on the gpu, {b} on the cpu");

    if cfg!(target_os = "linux") {
        let gone = run(folder.path(), &["train", "--resume", "run", "--steps", "4k"], true);
        assert_refused(&gone, "which is not available now: no GPU was found");
        assert!(stderr(&gone).contains("--backend cpu"), "{}", stderr(&gone));
    }
}

fn newest_checkpoint(run: &Path) -> myo::train::Checkpoint {
    let run = myo::train::RunFolder::open(run).unwrap();
    let mut checkpoint = run.latest_checkpoint().unwrap().checkpoint.expect("a whole checkpoint");
    checkpoint.forget_wall_time();
    checkpoint
}

#[test]
fn several_users_on_the_gpu_train_at_once_each_as_alone() {
    let Some(_) = devices() else { return };
    let [several, alone] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let seeds = ["--device", "0", "--seeds", "3", "--seed", "4"];
    let begun = myo(several.path(), &short_training("32", "1k", &seeds));
    let heard = stderr(&begun);
    // All begin before any of them ends.
    assert!(["seed-4", "seed-5", "seed-6"].iter().all(|run| heard.contains(&format!("in run/{run}"))), "{heard}");
    assert!(!heard.contains("one after the other"), "{heard}");
    let result = json(&begun);
    assert_eq!(result["runs"].as_array().unwrap().len(), 3, "{result}");
    // One begins anew, two go on.
    std::fs::remove_dir_all(several.path().join("run/seed-5")).unwrap();
    let result = json(&myo(several.path(), &["train", "--resume", "run", "--steps", "2k", "--json"]));
    for (row, seed) in result["runs"].as_array().unwrap().iter().zip(["4", "5", "6"]) {
        let out = format!("alone-{seed}");
        let mut args = short_training("32", "2k", &["--device", "0", "--seed", seed]);
        *args.iter_mut().find(|arg| **arg == "run").unwrap() = &out;
        let expected = json(&myo(alone.path(), &args));
        assert_eq!((&row["seed"], &row["stopped_by"]), (&expected["seed"], &expected["stopped_by"]));
        assert_eq!(row["evaluation"], expected["evaluation"], "seed {seed}");
        let runs = [several.path().join("run").join(format!("seed-{seed}")), alone.path().join(&out)];
        let [a, b] = runs.map(|run| newest_checkpoint(&run));
        assert_eq!((a.env_steps(), b.env_steps()), (2048, 2048));
        assert!(a == b, "seed {seed}: the same weights, moments and episodes");
    }
    assert!(
        json(&myo(several.path(), &["train", "--resume", "run", "--json"]))["runs"] == result["runs"],
        "all are over"
    );
}

#[test]
fn a_run_resumed_on_the_gpu_ends_with_the_same_bits() {
    let Some(_) = devices() else { return };
    let [whole, parts] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let train = |folder: &Path, steps| json(&myo(folder, &short_training("32", steps, &["--device", "0"])));
    train(whole.path(), "2k");
    train(parts.path(), "1k");
    json(&myo(parts.path(), &["train", "--resume", "run", "--steps", "2k", "--json"]));
    let [a, b] = [whole, parts].map(|folder| newest_checkpoint(&folder.path().join("run")));
    assert_eq!((a.env_steps(), b.env_steps()), (2048, 2048));
    assert!(a == b, "the same weights, moments and episodes");
}

#[test]
fn measurements_on_the_gpu_give_rows() {
    let Some(listed) = devices() else { return };
    let args = ["bench", "env", "--task", "pointing-single", "--device", "0", "--envs", "64", "--json"];
    let bench = json(&myo(Path::new("."), &[&args[..], &["--part", "env,physics,host"]].concat()));
    let rows = bench["rows"].as_array().unwrap();
    assert_eq!(rows.iter().map(|row| row["part"].as_str().unwrap()).collect::<Vec<_>>(), ["env", "physics", "host"]);
    for row in rows {
        assert_eq!(
            (&row["backend"], &row["device"], &row["envs"]),
            (&"gpu".into(), &listed["devices"][0]["name"], &64.into())
        );
        for key in ["ready_s", "physics_steps_per_s", "control_steps_per_s", "control_steps_per_s_median"] {
            assert!(row[key].as_f64().unwrap() > 0.0, "{key}: {row}");
        }
        assert!(row["machine"].is_string() && row["date"].is_string() && row["driver"].is_string(), "{row}");
    }
    assert!(["warm", "cold", "none"].contains(&rows[0]["kernel_cache"].as_str().unwrap()));
    let all = ["--seeds", "2", "--at-once", "--until", "off", "--steps", "1k", "--envs", "32", "--json"];
    let args = [&["bench", "train", "pointing-single", "--device", "0"], &all[..]].concat();
    let small = ["--set", "rollout_s=0.8", "--set", "policy_hidden=[16]", "--set", "value_hidden=[16]"];
    let bench = json(&myo(Path::new("."), &[&args[..], &small].concat()));
    let rows = bench["rows"].as_array().unwrap();
    assert_eq!(rows.iter().map(|row| row["seed"].as_u64().unwrap()).collect::<Vec<_>>(), [1, 2]);
    assert!(rows.iter().all(|row| row["env_steps"] == 1024 && row["stopped_by"] == "steps"), "{bench}");
}

#[test]
fn a_training_on_the_gpu_looks_at_its_goal_there() {
    let Some(_) = devices() else { return };
    let folder = tempfile::tempdir().unwrap();
    let task = "version: 1
name: easy
targets: [{kind: pointing, position: {x: 0.35, y: 0, z: 0}, radius: 0.3, dwell_s: 0.05}]
time_limit_s: 1
";
    std::fs::write(folder.path().join("easy.yaml"), task).unwrap();
    let args = ["train", "easy.yaml", "--device", "0", "--envs", "256", "--until", "0.3", "--steps", "400k", "--json"];
    let result = json(&myo(folder.path(), &args));
    assert_eq!(result["stopped_by"], "until", "{result}");
    assert!(result["evaluation"]["success"].as_f64().unwrap() >= 0.3);
    assert_eq!(result["evaluation"]["episodes"], 1000);
}

/// Two layouts of a sphere, the second with another time limit if that is asked for.
fn write_layouts(folder: &Path, second_limit_s: f64) {
    for (name, x, limit_s) in [("near", 0.35, 1.0), ("far", 0.5, second_limit_s)] {
        let target = format!("{{kind: pointing, position: {{x: {x}, y: 0, z: 0}}, radius: 0.1, dwell_s: 0.05}}");
        let task = format!("version: 1\nname: {name}\ntargets: [{target}]\ntime_limit_s: {limit_s}\n");
        std::fs::write(folder.join(format!("{name}.yaml")), task).unwrap();
    }
}

const SMALL: [&str; 6] = ["--set", "rollout_s=0.8", "--set", "policy_hidden=[16]", "--set", "value_hidden=[16]"];

#[test]
fn one_user_of_several_layouts_learns_and_goes_on_on_the_gpu() {
    let Some(_) = devices() else { return };
    let folder = tempfile::tempdir().unwrap();
    write_layouts(folder.path(), 0.2);
    let train = |out: &str, steps: &str, more: &[&str]| {
        let layouts = ["train", "near.yaml", "far.yaml", "--together", "--until", "off", "--envs", "32", "--json"];
        let args = [&layouts[..], &["--device", "0", "--out", out, "--steps", steps], &SMALL, more].concat();
        json(&myo(folder.path(), &args))
    };
    let whole = train("whole", "2k", &[]);
    let layouts = whole["evaluation"]["layouts"].as_array().unwrap();
    assert_eq!(layouts.iter().map(|layout| &layout["task"]).collect::<Vec<_>>(), ["near", "far"]);
    assert!(layouts.iter().all(|layout| layout["episodes"] == 1000), "{whole}");
    assert!(layouts[1]["episode_length_s"].as_f64() <= Some(0.2), "{whole}");
    train("parts", "1k", &[]);
    json(&myo(folder.path(), &["train", "--resume", "parts", "--steps", "2k", "--json"]));
    let [a, b] = ["whole", "parts"].map(|run| newest_checkpoint(&folder.path().join(run)));
    assert!(a == b, "the same weights, moments and episodes");
    // Of several such users each is as alone.
    let users = train("users", "2k", &["--seeds", "2"]);
    assert_eq!(users["runs"][0]["evaluation"]["return"], whole["evaluation"]["return"]);
    assert!(newest_checkpoint(&folder.path().join("users/seed-1")) == a);
    let args = ["eval", "whole", "--episodes", "64", "--json"];
    let [gpu, cpu] =
        [["--device", "0"], ["--backend", "cpu"]].map(|on| json(&myo(folder.path(), &[&args[..], &on].concat())));
    for (gpu, cpu) in gpu["layouts"].as_array().unwrap().iter().zip(cpu["layouts"].as_array().unwrap()) {
        let [a, b] = [gpu, cpu].map(|layout| layout["return"].as_f64().unwrap());
        assert!((a - b).abs() < 0.02 * b.abs(), "{a} on the gpu, {b} on the cpu");
    }
}

#[test]
fn users_of_two_layouts_are_compared_at_once_each_as_alone() {
    let Some(_) = devices() else { return };
    let folder = tempfile::tempdir().unwrap();
    let short = ["--until", "off", "--envs", "32", "--steps", "1k", "--device", "0", "--json"];
    let compare = |out: &str| {
        let args = [&["compare", "near.yaml", "far.yaml", "--seeds", "2", "--out", out], &short[..], &SMALL].concat();
        myo(folder.path(), &args)
    };
    write_layouts(folder.path(), 1.0);
    let output = compare("both");
    let heard = stderr(&output);
    let (last_begun, first_end) = (heard.rfind("in both/far/seed-2"), heard.find("layout 1, seed 1: "));
    assert!(last_begun.is_some() && first_end.is_none_or(|end| last_begun < Some(end)), "{heard}");
    let result = json(&output);
    assert_eq!(
        (&result["users"], &result["folders"]),
        (&serde_json::json!([2, 2]), &serde_json::json!(["both/near", "both/far"]))
    );
    for (layout, seed) in [("near", "1"), ("far", "1"), ("far", "2")] {
        let out = format!("{layout}-{seed}");
        let file = format!("{layout}.yaml");
        let alone = [&["train", &file, "--seed", seed, "--out", &out], &short[..], &SMALL].concat();
        json(&myo(folder.path(), &alone));
        let run = folder.path().join("both").join(layout).join(format!("seed-{seed}"));
        assert!(newest_checkpoint(&run) == newest_checkpoint(&folder.path().join(&out)), "{out}");
        let evaluation = |run: &Path| std::fs::read(run.join("evaluation.json")).unwrap();
        assert!(evaluation(&run) == evaluation(&folder.path().join(&out)), "{out}");
    }
    // The folder of one layout goes on by itself.
    let again = json(&myo(folder.path(), &["train", "--resume", "both/far", "--steps", "2k", "--json"]));
    assert!(again["runs"].as_array().unwrap().iter().all(|row| row["env_steps"] == 2048), "{again}");
    // Other time limits do not fit into one batch.
    write_layouts(folder.path(), 0.5);
    let result = json(&compare("apart"));
    assert_eq!(result["users"], serde_json::json!([2, 2]));
}
