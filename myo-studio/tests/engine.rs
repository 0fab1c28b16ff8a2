//! The engine as a page sees it: questions in JSON, answers, events.

use std::path::Path;
use std::time::{Duration, Instant};

use myo_lab::Backend;
use myo_studio::engine::Engine;
use myo_studio::protocol::{Message, Question};
use myo_tasks::preset_text;
use serde_json::{Value, json};

/// Longer than any training here takes on a slow machine.
const PATIENCE: Duration = Duration::from_secs(120);

fn engine(folder: &Path) -> Engine {
    Engine::open(folder.to_owned(), Backend::Cpu).unwrap()
}

fn ask(engine: &Engine, call: &str, with: Value) -> Result<Value, Value> {
    let Message::Text(text) = engine.answer(Question { id: 7, call: call.into(), with }) else { panic!("text") };
    let reply: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(reply["id"], 7);
    match (reply.get("ok"), reply.get("refused")) {
        (Some(ok), None) => Ok(ok.clone()),
        (None, Some(refused)) => Err(refused.clone()),
        _ => panic!("{reply}"),
    }
}

fn refusal(engine: &Engine, call: &str, with: Value) -> String {
    ask(engine, call, with).unwrap_err()["message"].as_str().unwrap().to_owned()
}

/// A task that is learnt in a moment: one large sphere where the hand hangs.
fn easy(x: f64) -> String {
    format!(
        "version: 2\nuser: fastest\nmodel: mobl-arms\nname: easy\nscene:\n  ball: {{kind: sphere, at: [{x}, 0, -0.4], radius: 0.3}}\nscript:\n  - dwell: {{in: ball, for_s: 0.05}}\n\
         time_limit_s: 1\n"
    )
}

fn order(text: &str, until: &str, live: bool) -> Value {
    json!({"order": {"text": text, "name": "easy", "seed": 3, "users": 1, "until": until, "steps": null, "from": null, "live": live}})
}

fn job(engine: &Engine, id: u64) -> Value {
    let state = serde_json::to_value(engine.state()).unwrap();
    state["jobs"].as_array().unwrap().iter().find(|job| job["id"] == id).cloned().unwrap_or(Value::Null)
}

/// Waits until a training is as it should be.
fn wait(engine: &Engine, id: u64, is: impl Fn(&Value) -> bool) -> Value {
    let begun = Instant::now();
    loop {
        let job = job(engine, id);
        if is(&job) {
            return job;
        }
        assert_ne!(job["state"]["is"], "failed", "{job}");
        assert!(begun.elapsed() < PATIENCE, "{job}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_text_is_looked_at_and_checked_in_the_words_of_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let text = preset_text("public-display").unwrap();
    let look = ask(&engine, "look", json!({"text": text})).unwrap();
    assert_eq!(look["findings"], json!([]));
    assert_eq!(look["view"]["objects"].as_array().unwrap().len(), 5, "four buttons and a wall");
    assert_eq!(look["view"]["steps"][1]["label"], "press upper_left");
    assert_eq!(look["view"]["objects"][1]["steps"], json!([1]));
    assert_eq!(look["view"]["items"][1]["path"], "scene.upper_left");
    assert!(
        ask(&engine, "check", json!({"text": text}))
            .unwrap()
            .as_array()
            .unwrap()
            .iter()
            .all(|f| f["severity"] == "warning")
    );

    // Wrong values keep their path and line; so does what lies out of reach.
    let wrong = text.replace("at: [0.42,  0.15,  0.01]", "at: [0.92,  0.15,  0.01]");
    let findings = ask(&engine, "check", json!({"text": wrong})).unwrap();
    let error = findings.as_array().unwrap().iter().find(|finding| finding["severity"] == "error").unwrap();
    assert_eq!((error["path"].as_str(), error["line"].as_u64()), (Some("scene.upper_left.at"), Some(15)));
    assert!(error["message"].as_str().unwrap().contains("out of reach"), "{error}");

    let typo = ask(&engine, "look", json!({"text": text.replace("tilt_deg: 90", "tilt: 90")})).unwrap();
    assert_eq!(typo["view"], Value::Null);
    assert!(typo["findings"][0]["message"].as_str().unwrap().starts_with("unknown key `tilt`"), "{typo}");
    // Tasks of version 1 are seen, and written anew.
    let old = "version: 1\nname: t\ntargets:\n  - {kind: pointing, position: {x: 0.4, y: 0, z: 0}, radius: 0.1, dwell_s: 0.1}\n";
    let seen = ask(&engine, "look", json!({"text": old})).unwrap();
    assert_eq!(
        (seen["view"]["items"].as_array().unwrap().len(), seen["view"]["objects"].as_array().unwrap().len()),
        (0, 1)
    );
    let anew = ask(&engine, "convert", json!({"text": old})).unwrap();
    let seen = ask(&engine, "look", json!({"text": anew})).unwrap();
    assert_eq!(seen["view"]["items"].as_array().unwrap().len(), 1, "{anew}");
    // A scene is shown before there is a script.
    let draft =
        "version: 2\nname: t\nscene:\n  ok: {kind: button, at: [0.4, 0, 0], size: [0.05, 0.05, 0.02]}\nscript: []\n";
    let draft = ask(&engine, "look", json!({"text": draft})).unwrap();
    assert_eq!(draft["view"]["objects"][0]["name"], "ok");
    assert_eq!(draft["findings"][0]["severity"], "error");
    // Wrong numbers are not written out, however many they ask for.
    let many = "version: 1\nname: t\ntargets:\n  - {kind: pointing, position: {x: 0.4, y: 0, z: 0}, radius: 0.1, dwell_s: 0.1, repeat: 4000000000}\n";
    assert_eq!(ask(&engine, "look", json!({"text": many})).unwrap()["view"], Value::Null);
}

#[test]
fn names_cannot_leave_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(&folder.path().join("work"));
    std::fs::write(folder.path().join("secret.yaml"), "secret").unwrap();
    for name in ["../secret", "/etc/passwd", "a/b", "..", ".", "", "a\\b", "nul\0", ".hidden", "a.", &"x".repeat(81)] {
        let refused = refusal(&engine, "open", json!({"name": name}));
        assert!(refused.contains("the name of a task"), "{name:?}: {refused}");
        assert!(ask(&engine, "save", json!({"name": name, "text": "x"})).is_err());
    }
    for name in ["../work/../secret", "/etc", "..", "", "a/../../b"] {
        let refused = refusal(&engine, "run", json!({"name": name}));
        assert!(refused.contains("is no name of a run"), "{name:?}: {refused}");
        assert!(ask(&engine, "discard_run", json!({"name": name})).is_err());
    }
    #[cfg(unix)]
    {
        std::fs::create_dir_all(folder.path().join("work/runs")).unwrap();
        std::os::unix::fs::symlink(folder.path(), folder.path().join("work/runs/out")).unwrap();
        assert!(refusal(&engine, "discard_run", json!({"name": "out"})).contains("leads out"));
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("secret.yaml")).unwrap(), "secret");
}

#[test]
fn tasks_are_kept_as_they_were_written_and_thrown_away_to_a_bin() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let text = "# mine\nversion: 2  # of course\n";
    ask(&engine, "save", json!({"name": "mine", "text": text})).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("tasks/mine.yaml")).unwrap(), text);
    assert_eq!(ask(&engine, "open", json!({"name": "mine"})).unwrap()["text"], text);
    assert_eq!(ask(&engine, "tasks", Value::Null).unwrap()[0]["name"], "mine");
    ask(&engine, "discard_task", json!({"name": "mine"})).unwrap();
    assert_eq!(ask(&engine, "tasks", Value::Null).unwrap(), json!([]));
    assert_eq!(std::fs::read_to_string(folder.path().join("bin/mine.yaml")).unwrap(), text);
    // A second one of the name does not replace the first.
    ask(&engine, "save", json!({"name": "mine", "text": "other"})).unwrap();
    ask(&engine, "discard_task", json!({"name": "mine"})).unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("bin/mine.yaml")).unwrap(), text);
    assert_eq!(std::fs::read_to_string(folder.path().join("bin/mine.yaml.2")).unwrap(), "other");
}

#[test]
fn a_user_is_trained_replayed_noted_renamed_and_thrown_away() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let id = ask(&engine, "train", order(&easy(0.1), "0.5", false)).unwrap()[0].as_u64().unwrap();
    let done = wait(&engine, id, |job| job["state"]["is"] == "done");
    assert_eq!((done["run"].as_str(), done["state"]["by"].as_str()), (Some("easy-1"), Some("until")));
    assert!(done["state"]["success"].as_f64().unwrap() >= 0.5);

    let runs = ask(&engine, "runs", Value::Null).unwrap();
    assert_eq!((runs[0]["name"].as_str(), runs[0]["standing"]["state"].as_str()), (Some("easy-1"), Some("evaluated")));
    let detail = ask(&engine, "run", json!({"name": "easy-1"})).unwrap();
    assert_eq!(detail["targets"][0]["label"], "dwell in ball");
    assert!(!detail["curve"].as_array().unwrap().is_empty() && detail["episodes"] == 1000);

    // What it answered to protocols is shown, in their order.
    assert_eq!(detail["protocols"], json!([]));
    std::fs::create_dir(folder.path().join("runs/easy-1/protocols")).unwrap();
    for (file, text) in [("K3.txt", "still"), ("F1.txt", "law"), ("F1.svg", "<svg/>")] {
        std::fs::write(folder.path().join("runs/easy-1/protocols").join(file), text).unwrap();
    }
    let detail = ask(&engine, "run", json!({"name": "easy-1"})).unwrap();
    let answers =
        json!([{"name": "F1", "text": "law", "plot": "<svg/>"}, {"name": "K3", "text": "still", "plot": null}]);
    assert_eq!(detail["protocols"], answers);

    let replay = |seed: u32| {
        let with = json!({"run": "easy-1", "seed": seed, "env_steps": null});
        match engine.answer(Question { id: 9, call: "replay".into(), with }) {
            Message::Motion(header, numbers) => (header, numbers),
            Message::Text(text) => panic!("{text}"),
        }
    };
    let (header, numbers) = replay(1);
    assert_eq!((header.id, header.frame_size), (Some(9), header.layout.frame_size()));
    assert_eq!(numbers.len() % header.frame_size, 0);
    let last = &numbers[numbers.len() - header.frame_size..];
    assert!(last[0] > 0.0 && f64::from(last[0]) <= 1.0 + 1e-6, "the end of the episode: {}", last[0]);
    // What has no value is NaN, which is not equal to itself.
    let bits = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&replay(1).1), bits(&numbers), "an episode is the same whenever it is asked for");
    assert_ne!(bits(&replay(2).1), bits(&numbers));

    let note = json!({"tags": ["pilot"], "note": "first"});
    ask(&engine, "note", json!({"name": "easy-1", "note": note})).unwrap();
    ask(&engine, "rename_run", json!({"name": "easy-1", "to": "best"})).unwrap();
    assert_eq!(job(&engine, id)["run"], "best", "its training knows");
    assert_eq!(ask(&engine, "run", json!({"name": "best"})).unwrap()["entry"]["note"], note);
    assert!(refusal(&engine, "rename_run", json!({"name": "best", "to": "a/b"})).contains("must not contain"));
    ask(&engine, "discard_run", json!({"name": "best"})).unwrap();
    assert_eq!(ask(&engine, "runs", Value::Null).unwrap(), json!([]));
    assert!(folder.path().join("bin/best/config.json").exists());
    assert_eq!(job(&engine, id)["run"], Value::Null);
}

#[test]
fn a_training_waits_pauses_stops_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let id = ask(&engine, "train", order(&easy(0.1), "off", false)).unwrap()[0].as_u64().unwrap();
    let second = ask(&engine, "train", order(&easy(0.1), "0.5", false)).unwrap()[0].as_u64().unwrap();
    let steps = |job: &Value| job["progress"]["env_steps"].as_u64().unwrap_or_default();
    wait(&engine, id, |job| steps(job) > 0);
    assert_eq!(job(&engine, second)["state"]["is"], "waiting");
    assert!(refusal(&engine, "discard_run", json!({"name": "easy-1"})).contains("is being trained; stop it first"));
    assert!(refusal(&engine, "go_on", json!({"run": "easy-1"})).contains("is being trained already"));

    ask(&engine, "tell", json!({"job": id, "step": "pause"})).unwrap();
    let paused = wait(&engine, id, |job| job["state"]["is"] == "paused");
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(steps(&job(&engine, id)), steps(&paused), "nothing is learnt in a pause");
    ask(&engine, "tell", json!({"job": id, "step": "resume"})).unwrap();
    wait(&engine, id, |job| steps(job) > steps(&paused));

    ask(&engine, "tell", json!({"job": id, "step": "stop"})).unwrap();
    wait(&engine, id, |job| job["state"]["is"] == "stopped");
    wait(&engine, second, |job| job["state"]["is"] == "done");
    let before =
        ask(&engine, "run", json!({"name": "easy-1"})).unwrap()["entry"]["standing"]["env_steps"].as_u64().unwrap();
    assert!(before > 0, "a stop leaves a checkpoint");
    ask(&engine, "tell", json!({"job": id, "step": "resume"})).unwrap();
    wait(&engine, id, |job| steps(job) > before);
    ask(&engine, "tell", json!({"job": id, "step": "dismiss"})).unwrap();
    wait(&engine, id, Value::is_null);
}

#[test]
fn a_studio_that_was_killed_goes_on_with_its_trainings() {
    let folder = tempfile::tempdir().unwrap();
    let first = engine(folder.path());
    let id = ask(&first, "train", order(&easy(0.1), "off", false)).unwrap()[0].as_u64().unwrap();
    wait(&first, id, |job| job["progress"]["env_steps"].as_u64().unwrap_or_default() > 0);
    ask(&first, "tell", json!({"job": id, "step": "stop"})).unwrap();
    wait(&first, id, |job| job["state"]["is"] == "stopped");
    let Err(busy) = Engine::open(folder.path().to_owned(), Backend::Cpu) else { panic!("two in one folder") };
    assert!(busy.message.contains("another studio works in"), "{}", busy.message);
    drop(first);
    // As the file is while it trains, which a kill leaves behind.
    let file = folder.path().join("studio.json");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("\"is\": \"stopped\""), "{text}");
    std::fs::write(&file, text.replace("\"is\": \"stopped\"", "\"is\": \"training\"")).unwrap();
    let second = engine(folder.path());
    wait(&second, id, |job| job["state"]["is"] == "training" && job["progress"]["wall_s"].as_f64() > Some(0.0));
    assert_eq!(job(&second, id)["run"], "easy-1");
    ask(&second, "tell", json!({"job": id, "step": "stop"})).unwrap();
    wait(&second, id, |job| job["state"]["is"] == "stopped");

    drop(second);
    std::fs::write(&file, "{").unwrap();
    let Err(refusal) = Engine::open(folder.path().to_owned(), Backend::Cpu) else { panic!("a damaged list") };
    assert!(refusal.message.contains("is damaged") && refusal.message.contains("move it away"), "{}", refusal.message);
}

#[test]
fn a_live_training_takes_its_user_to_every_task_that_comes() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let id = ask(&engine, "train", order(&easy(0.1), "0.5", true)).unwrap()[0].as_u64().unwrap();
    let first = wait(&engine, id, |job| job["state"]["is"] == "done");
    assert_eq!(first["progress"]["before"], Value::Null);
    // Of another structure, too: a button instead of a sphere.
    let button = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: easy\nscene:\n  ok: {kind: button, at: [0.4, 0, -0.2], size: [0.3, 0.3, 0.02], tilt_deg: 60}\nscript:\n  - press: ok\n\
                  time_limit_s: 2\n";
    let note = json!({"tags": ["mine"], "note": ""});
    ask(&engine, "note", json!({"name": "easy-1", "note": note})).unwrap();
    for (text, name) in [(easy(0.3), "ball"), (button.to_owned(), "ok")] {
        ask(&engine, "relearn", json!({"job": id, "text": text})).unwrap();
        let done = wait(&engine, id, |job| {
            let detail = || ask(&engine, "run", json!({"name": "easy-1"})).unwrap_or_default();
            job["state"]["is"] == "done"
                && detail()["text"].as_str().is_some_and(|text| text.contains(&format!("{name}:")))
        });
        assert!(done["progress"]["before"]["success"].is_f64(), "{done}");
        assert_eq!(done["run"], "easy-1", "one run, of the last task");
    }
    assert_eq!(
        ask(&engine, "run", json!({"name": "easy-1"})).unwrap()["entry"]["note"],
        note,
        "notes stay with the user"
    );
    let names: Vec<_> =
        std::fs::read_dir(folder.path().join("runs")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["easy-1"], "nothing is left aside");
    let wrong = refusal(&engine, "relearn", json!({"job": id, "text": easy(1.8)}));
    assert!(wrong.contains("out of reach"), "{wrong}");
    assert_eq!(job(&engine, id)["state"]["is"], "done", "what cannot be trained changes nothing");
}

#[test]
fn what_is_no_question_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    assert!(refusal(&engine, "fly", Value::Null).contains("knows no call named \"fly\""));
    assert!(refusal(&engine, "look", json!({"txt": "x"})).contains("unknown field"));
    assert!(refusal(&engine, "train", order(&easy(0.1), "soon", false)).contains("expected `plateau`"));
    let mut none = order(&easy(0.1), "off", false);
    none["order"]["users"] = json!(0);
    assert!(refusal(&engine, "train", none).contains("from 1 to 64"));
    assert!(refusal(&engine, "train", order(&easy(1.8), "off", false)).contains("out of reach"));
    assert!(
        refusal(&engine, "replay", json!({"run": "none", "seed": 1, "env_steps": null}))
            .contains("is not a run folder")
    );
    assert!(refusal(&engine, "tell", json!({"job": 99, "step": "stop"})).contains("not in the list"));
}

#[test]
fn a_damaged_run_hides_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let damaged = folder.path().join("runs/broken");
    std::fs::create_dir_all(&damaged).unwrap();
    std::fs::write(damaged.join("config.json"), "{").unwrap();
    let runs = ask(&engine, "runs", Value::Null).unwrap();
    assert_eq!((runs[0]["name"].as_str(), runs[0]["standing"]["is"].as_str()), (Some("broken"), Some("damaged")));
    ask(&engine, "discard_run", json!({"name": "broken"})).unwrap();
    assert_eq!(ask(&engine, "runs", Value::Null).unwrap(), json!([]));
}

#[test]
fn weights_and_step_size_change_while_a_user_learns() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let mut first = order(&easy(0.1), "off", false);
    first["order"]["settings"] = json!({"learning_rate": 0.002});
    let id = ask(&engine, "train", first).unwrap()[0].as_u64().unwrap();
    wait(&engine, id, |job| job["progress"]["env_steps"].as_u64() > Some(0));
    let config = || -> Value {
        let text = std::fs::read_to_string(folder.path().join("runs/easy-1/config.json")).unwrap_or_default();
        serde_json::from_str(&text).unwrap_or_default()
    };
    assert_eq!(config()["ppo"]["learning_rate"], 0.002);
    let dear = format!("{}reward: {{effort_cost: 0.2}}\n", easy(0.1));
    ask(&engine, "relearn", json!({"job": id, "text": dear, "settings": {"learning_rate": 0.0005}})).unwrap();
    let changed = wait(&engine, id, |job| job["progress"]["before"]["success"].is_f64());
    assert_eq!(changed["run"], "easy-1", "the same user goes on");
    assert_eq!(config()["ppo"]["learning_rate"], 0.0005);
    assert_eq!(config()["run"]["task"]["reward"]["effort_cost"], 0.2);
    let wrong = refusal(&engine, "relearn", json!({"job": id, "text": dear, "settings": {"clip": -1}}));
    assert!(wrong.contains("clip is -1.0; it must be finite and greater than 0"), "{wrong}");
    ask(&engine, "tell", json!({"job": id, "step": "stop"})).unwrap();
    wait(&engine, id, |job| job["state"]["is"] == "stopped");
    let over = refusal(&engine, "relearn", json!({"job": id, "text": dear, "settings": null}));
    assert!(over.contains("its run stays as it is"), "{over}");
}

#[test]
fn all_settings_of_the_learner_are_told_with_their_ranges() {
    let folder = tempfile::tempdir().unwrap();
    let settings = ask(&engine(folder.path()), "settings", Value::Null).unwrap();
    let clip = settings.as_array().unwrap().iter().find(|setting| setting["name"] == "clip").unwrap();
    assert_eq!((&clip["default"], &clip["range"]), (&json!(0.2), &json!("finite and greater than 0")));
    assert!(clip["about"].as_str().unwrap().contains("probability ratio"));
}

#[test]
fn a_reward_is_told_with_its_bounds_and_lies_in_space() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let text = preset_text("public-display").unwrap();
    let reward = ask(&engine, "reward", json!({"text": text})).unwrap();
    let terms = reward["terms"].as_array().unwrap();
    let bonus = terms.iter().find(|term| term["path"] == "reward.subtask_bonus").unwrap();
    assert_eq!((&bonus["is_cost"], &bonus["episode"]), (&json!(false), &json!([0.0, 12.0])));
    let best: f64 = terms.iter().map(|term| term["episode"][1].as_f64().unwrap()).sum();
    assert!((reward["episode"][1].as_f64().unwrap() - best).abs() < 1e-9 && best > 17.0, "{reward}");
    let map = ask(&engine, "reward_map", json!({"text": text, "step": 1, "cut": "front"})).unwrap();
    let values: Vec<f64> = map["values"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect();
    assert_eq!(values.len() as u64, map["columns"].as_u64().unwrap() * map["rows"].as_u64().unwrap());
    // The object is in the middle.
    let (best, _) = values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
    assert!(best.abs_diff(values.len() / 2) <= 62, "{best}");
    let wrong = refusal(&engine, "reward", json!({"text": "version: 2\nname: x\n"}));
    assert!(!wrong.is_empty());
}

#[test]
fn users_are_held_against_each_other_by_layout_and_reported_in_one_file() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let mut two = order(&easy(0.1), "0.5", false);
    two["order"]["users"] = json!(2);
    let mut ids = ask(&engine, "train", two).unwrap().as_array().unwrap().clone();
    let far = easy(0.2).replace("name: easy", "name: far");
    let mut other = order(&far, "0.5", false);
    other["order"]["name"] = json!("far");
    ids.extend(ask(&engine, "train", other).unwrap().as_array().unwrap().clone());
    for id in ids {
        wait(&engine, id.as_u64().unwrap(), |job| job["state"]["is"] == "done");
    }
    let users_of = |until: &str| ask(&engine, "users_of", json!({"text": easy(0.1), "until": until})).unwrap();
    assert_eq!(users_of("0.5"), json!({"runs": ["easy-1", "easy-2"], "on_the_way": []}));
    assert_eq!(users_of("plateau"), json!({"runs": [], "on_the_way": []}), "of the same goal alone");
    // One more is another user, and one that has begun is on the way.
    let more = ask(&engine, "train", order(&easy(0.1), "off", false)).unwrap()[0].as_u64().unwrap();
    assert_eq!(job(&engine, more)["seed"], 5);
    assert_eq!(users_of("off"), json!({"runs": [], "on_the_way": [more]}));
    wait(&engine, more, |job| job["progress"]["env_steps"].as_u64() > Some(0));
    let wide = json!({"job": more, "text": easy(0.1), "settings": {"policy_hidden": [64, 64]}});
    assert!(refusal(&engine, "relearn", wide).contains("cannot change while a user learns"));
    ask(&engine, "tell", json!({"job": more, "step": "dismiss"})).unwrap();
    wait(&engine, more, Value::is_null);
    // A copy of a run says nothing new.
    let runs = folder.path().join("runs");
    copy(&runs.join("easy-1"), &runs.join("twin"));
    let twins = ask(&engine, "compare", json!({"names": ["easy-1", "twin"]})).unwrap();
    assert!(twins["left_out"][0]["reason"].as_str().unwrap().contains("the same user as easy-1"), "{twins}");
    let names = json!({"names": ["easy-1", "easy-2", "far-1", "gone"]});
    let table = ask(&engine, "compare", names).unwrap();
    let (layouts, left_out) = (table["layouts"].as_array().unwrap(), table["left_out"].as_array().unwrap());
    let of = |row: &Value| (row["name"].clone(), row["users"].as_array().unwrap().len());
    assert_eq!(layouts.iter().map(of).collect::<Vec<_>>(), [(json!("easy"), 2), (json!("far"), 1)]);
    assert_eq!(layouts[0]["users"][1]["seed"], 4);
    assert_eq!(layouts[0]["against"], Value::Null);
    assert!(layouts[0]["success"]["interval"][1].as_f64().unwrap() <= 1.0);
    // One user of the second layout says nothing about chance.
    assert_eq!(layouts[1]["against"]["contrasts"][0]["verdict"], "unknown");
    assert_eq!(layouts[1]["steps"].as_array().unwrap().len(), 1);
    assert_eq!(left_out[0]["run"], "gone");

    let efforts = ask(&engine, "efforts", json!({"name": "easy-1"})).unwrap();
    let [effort] = &efforts.as_array().unwrap()[..] else { panic!("{efforts}") };
    // That of whole episodes, where there is one step.
    let whole = layouts[0]["users"][0]["effort"].as_f64().unwrap();
    assert!((effort.as_f64().unwrap() / whole - 1.0).abs() < 0.1, "{effort} {whole}");

    let refused = refusal(&engine, "report", json!({"names": ["gone"]}));
    assert!(refused.contains("is not a run folder") || refused.contains("without the studio's pages"), "{refused}");
    if myo_studio::pages::missing_pages().is_ok() {
        let page = ask(&engine, "report", json!({"names": ["easy-1", "far-1"]})).unwrap();
        let page = page.as_str().unwrap();
        let recorded = recorded(page);
        assert_eq!(recorded["runs"].as_array().unwrap().len(), 2);
        assert!(recorded["runs"][0]["motion"]["numbers"].as_str().unwrap().len() > 1000);
        assert!(!page.contains("src=\"/") && !page.contains("href=\"/"), "nothing else is needed");
    }
}

/// What a report shows.
fn recorded(page: &str) -> Value {
    let begin = page.find("type=\"application/json\">").unwrap() + "type=\"application/json\">".len();
    let end = begin + page[begin..].find("</script>").unwrap();
    serde_json::from_str(&page[begin..end]).unwrap()
}

#[test]
fn a_user_who_points_from_afar_has_a_body_and_a_report() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let ray = easy(0.1).replace("script:", "technique: {kind: ray, from: forearm}\nscript:");
    let id = ask(&engine, "train", order(&ray, "0.01", false)).unwrap()[0].as_u64().unwrap();
    wait(&engine, id, |job| job["state"]["is"] == "done");
    assert!(ask(&engine, "body_of_run", json!({"name": "easy-1"})).unwrap()["muscles"].as_array().unwrap().len() > 20);
    if myo_studio::pages::missing_pages().is_ok() {
        let page = ask(&engine, "report", json!({"names": ["easy-1"]})).unwrap();
        assert!(recorded(page.as_str().unwrap())["runs"][0]["motion"]["numbers"].as_str().unwrap().len() > 1000);
    }
}

#[test]
fn a_studio_that_ends_leaves_its_training_with_a_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let first = engine(folder.path());
    let id = ask(&first, "train", order(&easy(0.1), "off", false)).unwrap()[0].as_u64().unwrap();
    let seen = wait(&first, id, |job| job["progress"]["env_steps"].as_u64() > Some(0));
    first.close();
    assert_eq!(job(&first, id)["state"]["is"], "waiting");
    drop(first);
    let run = myo_train::RunFolder::open(&folder.path().join("runs/easy-1")).unwrap();
    let kept = run.env_steps().unwrap();
    assert!(kept >= seen["progress"]["env_steps"].as_u64().unwrap(), "{kept}");
    let second = engine(folder.path());
    wait(&second, id, |job| job["progress"]["env_steps"].as_u64() > Some(kept));
    // An engine that is let go ends as one that is closed: nobody writes once the folder is free.
    drop(second);
    let text = std::fs::read_to_string(folder.path().join("studio.json")).unwrap();
    assert!(text.contains("\"is\": \"waiting\""), "{text}");
    myo_train::RunClaim::take(&folder.path().join("runs/easy-1")).unwrap();
}

#[test]
fn the_model_of_a_task_is_looked_for_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    let own = easy(0.1).replace("model: mobl-arms\n", "model: my-arm.yaml\n");
    assert!(refusal(&engine, "train", order(&own, "0.5", false)).contains("my-arm.yaml"));
    let description = myo_model::builtin("mobl-arms").unwrap();
    std::fs::create_dir_all(folder.path().join("tasks")).unwrap();
    let file = folder.path().join("tasks/my-arm.yaml");
    std::fs::write(&file, description.to_yaml().unwrap()).unwrap();
    assert_eq!(ask(&engine, "check", json!({"text": own})).unwrap(), json!([]));
    assert!(
        ask(&engine, "body", json!({"model": "my-arm.yaml", "body": {}})).unwrap()["muscles"].as_array().unwrap().len()
            > 20
    );
    let id = ask(&engine, "train", order(&own, "0.5", false)).unwrap()[0].as_u64().unwrap();
    wait(&engine, id, |job| job["state"]["is"] == "done");
    // The run keeps its body, whatever becomes of the file.
    std::fs::remove_file(&file).unwrap();
    assert!(ask(&engine, "body_of_run", json!({"name": "easy-1"})).unwrap()["muscles"].as_array().unwrap().len() > 20);
}

#[test]
fn what_cannot_be_written_is_said_in_a_sentence_and_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let engine = engine(folder.path());
    // As on a full disk, nothing can be made where tasks and runs are kept.
    std::fs::write(folder.path().join("tasks"), "in the way").unwrap();
    std::fs::write(folder.path().join("runs"), "in the way").unwrap();
    let told = refusal(&engine, "save", json!({"name": "mine", "text": easy(0.1)}));
    assert!(told.contains("cannot make") && told.contains("tasks"), "{told}");
    let id = ask(&engine, "train", order(&easy(0.1), "0.5", false)).unwrap()[0].as_u64().unwrap();
    let begun = Instant::now();
    while job(&engine, id)["state"]["is"] != "failed" {
        assert!(begun.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(job(&engine, id)["state"]["message"].as_str().unwrap().contains("runs"), "{}", job(&engine, id));
    // Once there is room it goes on.
    std::fs::remove_file(folder.path().join("runs")).unwrap();
    ask(&engine, "tell", json!({"job": id, "step": "resume"})).unwrap();
    wait_again(&engine, id);
}

/// Waits for the end of a training that had failed before.
fn wait_again(engine: &Engine, id: u64) {
    let begun = Instant::now();
    while job(engine, id)["state"]["is"] != "done" {
        assert!(begun.elapsed() < PATIENCE, "{}", job(engine, id));
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap().map(Result::unwrap) {
        let place = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &place);
        } else {
            std::fs::copy(entry.path(), &place).unwrap();
        }
    }
}
