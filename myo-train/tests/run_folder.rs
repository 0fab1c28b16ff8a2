//! What a run leaves behind, and what damage does to it.

mod common;

use std::fs;
use std::path::Path;

use common::{Constant, Points};
use myo_env::VectorEnv;
use myo_train::{Checkpoint, Evaluation, PpoConfig, RunClaim, RunConfig, RunFolder, RunWriter, Trainer, evaluate};

fn config() -> PpoConfig {
    PpoConfig {
        num_envs: 32,
        rollout_s: 0.4,
        exploring_starts: 0.0,
        policy_hidden: vec![16],
        value_hidden: vec![16],
        action_offset: 0.0,
        action_scale: 1.0,
        ..PpoConfig::default()
    }
}

fn points() -> Box<dyn VectorEnv> {
    Box::new(Points::new(32))
}

fn start(path: &Path) -> (Trainer, RunWriter) {
    let trainer = Trainer::new(points(), config(), 7).unwrap();
    let run = RunWriter::create(path, serde_json::json!({"task": "points"}), &config(), 7, trainer.spec());
    (trainer, run.unwrap())
}

fn train(trainer: &mut Trainer, run: &mut RunWriter, updates: usize, checkpoint_every: u64) {
    for _ in 0..updates {
        run.record(&trainer.update().unwrap()).unwrap();
        if trainer.updates().is_multiple_of(checkpoint_every) {
            run.write_checkpoint(&trainer.save().unwrap()).unwrap();
        }
    }
}

fn resume(path: &Path) -> (Trainer, RunWriter) {
    let latest = RunFolder::open(path).unwrap().latest_checkpoint().unwrap();
    let checkpoint = latest.checkpoint.expect("there is a whole checkpoint");
    let trainer = Trainer::restore(points(), &checkpoint).unwrap();
    let run = RunClaim::take(path).unwrap().resume(checkpoint.env_steps(), trainer.spec()).unwrap();
    (trainer, run)
}

/// The metrics without the columns that hold times.
fn metrics(path: &Path) -> Vec<Vec<String>> {
    let text = fs::read_to_string(path.join("metrics.csv")).unwrap();
    let rows: Vec<Vec<String>> = text.lines().map(|line| line.split(',').map(String::from).collect()).collect();
    let keep: Vec<bool> = rows[0].iter().map(|name| !name.ends_with("_s")).collect();
    rows.iter().map(|row| row.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(x, _)| x.clone()).collect()).collect()
}

#[test]
fn a_killed_and_resumed_run_ends_with_the_same_metrics_and_weights() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let (mut trainer, mut run) = start(&whole);
    train(&mut trainer, &mut run, 7, 2);
    let mut expected = trainer.save().unwrap();

    let (mut trainer, mut run) = start(&broken);
    train(&mut trainer, &mut run, 5, 2);
    drop((trainer, run));
    // As a process killed while it writes would leave it.
    let mut text = fs::read_to_string(broken.join("metrics.csv")).unwrap();
    text.push_str("2560,6,0.3");
    fs::write(broken.join("metrics.csv"), text).unwrap();
    fs::write(broken.join("checkpoints/step_000000003072.ckpt.part"), "half").unwrap();

    let (mut trainer, mut run) = resume(&broken);
    assert_eq!(trainer.updates(), 4);
    train(&mut trainer, &mut run, 3, 2);
    let mut got = trainer.save().unwrap();
    expected.forget_wall_time();
    got.forget_wall_time();
    assert!(expected.to_bytes() == got.to_bytes());
    assert_eq!(metrics(&whole), metrics(&broken));
    assert_eq!(metrics(&whole).len(), 8);
}

#[test]
fn a_folder_that_exists_is_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    drop(start(&path));
    let files = ["config.json", "metrics.csv"].map(|name| path.join(name));
    let before = files.each_ref().map(|file| fs::read(file).unwrap());
    fs::create_dir(folder.path().join("run-2")).unwrap();
    let error =
        RunWriter::create(&path, serde_json::Value::Null, &config(), 1, points().spec()).unwrap_err().to_string();
    assert!(error.contains("run exists already"), "{error}");
    assert!(error.ends_with("run-3"), "{error}");
    assert!(files.each_ref().map(|file| fs::read(file).unwrap()) == before);
    assert!(fs::read_dir(folder.path().join("run-2")).unwrap().next().is_none());
    let error = RunFolder::open(folder.path()).unwrap_err().to_string();
    assert!(error.ends_with("is not a run folder: it has no config.json"), "{error}");
}

#[test]
fn a_new_description_is_kept_with_settings_and_seed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    drop(start(&path));
    let before = RunFolder::open(&path).unwrap().config().clone();
    let mut claim = RunClaim::take(&path).unwrap();
    let description = serde_json::json!({"task": "points", "steps": 2});
    claim.describe(description.clone()).unwrap();
    let expected = RunConfig { run: description, ..before };
    assert_eq!(claim.folder().config(), &expected);
    assert_eq!(RunFolder::open(&path).unwrap().config(), &expected);
    assert!(!path.join("config.json.part").exists());
}

#[test]
fn two_trainings_in_one_folder_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (_trainer, _run) = start(&path);
    let error = RunClaim::take(&path).unwrap_err().to_string();
    assert!(error.starts_with("another process is training in"), "{error}");
}

#[test]
fn a_damaged_checkpoint_is_refused_and_the_previous_one_used() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 5, 1);
    drop((trainer, run));
    let run = RunFolder::open(&path).unwrap();
    let files = run.checkpoints().unwrap();
    assert_eq!(files.len(), 3, "the last three are kept");
    let mut bytes = fs::read(&files[0]).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&files[0], &bytes).unwrap();
    fs::write(&files[1], &fs::read(&files[1]).unwrap()[..500]).unwrap();

    let latest = run.latest_checkpoint().unwrap();
    assert_eq!(latest.checkpoint.unwrap().updates(), 3);
    let reasons: Vec<String> = latest.refused.iter().map(|(_, error)| error.to_string()).collect();
    assert!(reasons[0].starts_with("the checkpoint is damaged: its checksum is"), "{}", reasons[0]);
    assert!(reasons[1].starts_with("the checkpoint is 500 bytes long, but should be"), "{}", reasons[1]);

    let (mut trainer, mut run) = resume(&path);
    train(&mut trainer, &mut run, 1, 1);
    assert_eq!(metrics(&path).len(), 5);
    assert_eq!(run.folder().latest_checkpoint().unwrap().checkpoint.unwrap().updates(), 4);
}

#[test]
fn a_checkpoint_whose_weights_are_not_finite_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nan.ckpt");
    let checkpoint = Trainer::new(points(), config(), 7).unwrap().save().unwrap();
    let mut bytes = checkpoint.to_bytes();
    // Its checksum is put right.
    let at = first_parameter(&bytes);
    bytes[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let sum = crc32c(&bytes[24..]).to_le_bytes();
    bytes[20..24].copy_from_slice(&sum);
    let error = Checkpoint::from_bytes(&bytes).unwrap_err().to_string();
    assert_eq!(error, "the checkpoint cannot be used: parameter 0 is NaN");
    fs::write(&path, &bytes).unwrap();
    assert_eq!(Checkpoint::read(&path).unwrap_err().to_string(), error);
}

/// Place of the first parameter: behind the header, the settings (with their length), seed, updates, two numbers (with their
/// count), two lists of names and the number of parameters.
fn first_parameter(bytes: &[u8]) -> usize {
    let length = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    let mut at = 24;
    // Settings, control step, seed and updates, times; names of observations and of actions.
    at += 8 + length(at) + 16 + 16 + 24;
    at += 8 + length(at);
    at += 8 + length(at);
    at + 8
}

/// Bit by bit, as the polynomial of Castagnoli says.
fn crc32c(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ if crc & 1 == 1 { 0x82F6_3B78 } else { 0 })
    })
}

#[test]
fn only_what_a_run_wrote_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 1, 1);
    let checkpoints = path.join("checkpoints");
    let kept = ["best.ckpt", "step_000000000512 (copy).ckpt", "step_9.ckpt", "zero.ckpt"];
    for name in kept {
        fs::copy(checkpoints.join("step_000000000256.ckpt"), checkpoints.join(name)).unwrap();
    }
    let own = path.join("tensorboard/events.out.tfevents.9999999999.host");
    fs::write(&own, "of another program").unwrap();
    train(&mut trainer, &mut run, 5, 1);
    drop(run);
    drop(resume(&path));
    assert!(kept.iter().all(|name| checkpoints.join(name).exists()));
    assert_eq!(RunFolder::open(&path).unwrap().checkpoints().unwrap().len(), 3);
    assert_eq!(fs::read_to_string(own).unwrap(), "of another program");
}

#[test]
fn a_checkpoint_that_cannot_be_read_is_not_taken_for_a_damaged_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 2, 1);
    drop(run);
    let newest = path.join("checkpoints/step_000000000512.ckpt");
    let whole = fs::read(&newest).unwrap();
    let error = || RunFolder::open(&path).unwrap().latest_checkpoint().unwrap_err().to_string();
    let mut newer = whole.clone();
    newer[8] = 9;
    fs::write(&newest, newer).unwrap();
    assert!(
        error().ends_with("512.ckpt: the checkpoint has format 9; this program reads formats 1 to 4"),
        "{}",
        error()
    );
    fs::remove_file(&newest).unwrap();
    fs::create_dir(&newest).unwrap();
    assert!(error().starts_with("cannot read") && error().contains("step_000000000512.ckpt"), "{}", error());
}

#[test]
fn metrics_that_are_not_those_of_the_run_are_refused_and_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 3, 1);
    drop(run);
    let file = path.join("metrics.csv");
    let text = fs::read_to_string(&file).unwrap();
    let second = text.lines().nth(2).unwrap();
    for (changed, reason) in [
        (text.replacen("env_steps", "steps", 1).into_bytes(), "its first line does not name the columns"),
        (text.replace(second, "512;oops").into_bytes(), "line 3 is not a row of 30 numbers"),
        (vec![0xff, 0xfe, 0x00], "it is not text"),
    ] {
        fs::write(&file, &changed).unwrap();
        let error = RunClaim::take(&path).unwrap().resume(768, trainer.spec()).unwrap_err().to_string();
        assert!(error.contains("metrics.csv") && error.contains(reason), "{error}");
        assert!(fs::read(&file).unwrap() == changed);
    }
    fs::write(&file, &text).unwrap();
    drop(RunClaim::take(&path).unwrap().resume(768, trainer.spec()).unwrap());
    assert_eq!(fs::read_to_string(&file).unwrap(), text);
}

#[test]
fn a_table_of_before_there_was_a_column_goes_on_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 3, 1);
    drop(run);
    let file = path.join("metrics.csv");
    let text = fs::read_to_string(&file).unwrap();
    let place = text.lines().next().unwrap().split(',').position(|name| name == "cost_share").unwrap();
    let table = |change: &dyn Fn(&mut Vec<&str>)| -> String {
        let line = |line: &str| {
            let mut cells: Vec<&str> = line.split(',').collect();
            change(&mut cells);
            cells.join(",") + "\n"
        };
        text.lines().map(line).collect()
    };
    fs::write(&file, table(&|cells| _ = cells.remove(place))).unwrap();
    drop(RunClaim::take(&path).unwrap().resume(768, trainer.spec()).unwrap());
    let expected = table(&|cells| cells[place] = if cells[0] == "env_steps" { "cost_share" } else { "" });
    assert_eq!(fs::read_to_string(&file).unwrap(), expected);
}

#[test]
fn a_folder_whose_training_was_stopped_at_its_beginning_is_taken_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("lock"), "").unwrap();
    fs::write(path.join("config.json.part"), "{\"form").unwrap();
    let error = RunFolder::open(&path).unwrap_err().to_string();
    assert!(error.contains("was stopped before it wrote config.json") && error.contains("run"), "{error}");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 1, 1);
    drop((trainer, run));
    // Stopped right after its description: all the rest is made again.
    for remains in ["checkpoints", "tensorboard"] {
        fs::remove_dir_all(path.join(remains)).unwrap();
    }
    fs::remove_file(path.join("metrics.csv")).unwrap();
    drop(RunClaim::take(&path).unwrap().resume(0, points().spec()).unwrap());
    assert_eq!(metrics(&path).len(), 1);
}

#[test]
fn an_edited_description_is_checked_as_a_new_one_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 1, 1);
    drop(run);
    let file = path.join("config.json");
    let text = fs::read_to_string(&file).unwrap();
    for (from, to, sentence) in [
        ("\"format\": 1", "\"format\": 7", "format is 7; this program knows run folders of format 1"),
        ("\"clip\": 0.2", "\"clip\": -1", "clip is -1.0; it must be finite and greater than 0"),
        ("\"seed\": 7", "\"seed\": 7, \"colour\": 1", "unknown field `colour`"),
        ("\"seed\": 7", "\"seed\": 8", "seed is 8, but 7 in its checkpoints"),
        ("\"epochs\": 2", "\"epochs\": 3", "epochs is 3, but 2 in its checkpoints"),
    ] {
        assert!(text.contains(from), "{from}");
        fs::write(&file, text.replace(from, to)).unwrap();
        let opened = RunFolder::open(&path).and_then(|run| run.latest_checkpoint());
        let error = opened.unwrap_err().to_string();
        assert!(error.contains("config.json") && error.contains(sentence), "{error}");
    }
}

#[test]
fn an_old_evaluation_does_not_stay_beside_a_newer_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run");
    let (mut trainer, mut run) = start(&path);
    train(&mut trainer, &mut run, 1, 1);
    let evaluation = evaluate(&mut trainer.policy(), points().as_mut(), 32, 5, |_| true).unwrap();
    run.folder().write_evaluation(&evaluation).unwrap();
    assert!(run.folder().has_evaluation().unwrap());
    train(&mut trainer, &mut run, 1, 1);
    assert!(!run.folder().has_evaluation().unwrap());
}

#[test]
fn no_damage_to_a_checkpoint_goes_unnoticed_or_panics() {
    let mut trainer = Trainer::new(points(), config(), 7).unwrap();
    trainer.update().unwrap();
    let bytes = trainer.save().unwrap().to_bytes();
    assert_eq!(Checkpoint::from_bytes(&bytes).unwrap(), trainer.save().unwrap());
    for i in (0..bytes.len()).step_by(97).chain(0..24) {
        let mut bytes = bytes.clone();
        bytes[i] ^= 0x10;
        assert!(Checkpoint::from_bytes(&bytes).is_err(), "byte {i}");
        assert!(Checkpoint::from_bytes(&bytes[..i]).is_err(), "cut at {i}");
    }
    let mut version = bytes.clone();
    version[8] = 9;
    let error = Checkpoint::from_bytes(&version).unwrap_err().to_string();
    assert_eq!(error, "the checkpoint has format 9; this program reads formats 1 to 4");
}

#[test]
fn evaluation_counts_equally_many_episodes_of_every_environment() {
    // Episodes of the last environment take eight times as long as those of the first: counted as they end, the first would
    // give 16 of 40.
    let mut env = Constant::staircase(8);
    let config = PpoConfig { num_envs: 8, ..config() };
    let trainer = Trainer::new(Box::new(Constant::staircase(8)), config, 7).unwrap();
    for (episodes, counts) in [(40, [5; 8]), (20, [3, 3, 3, 3, 2, 2, 2, 2]), (3, [1, 1, 1, 0, 0, 0, 0, 0])] {
        let evaluation = evaluate(&mut trainer.policy(), &mut env, episodes, 5, |_| true).unwrap();
        let sum: usize = counts.iter().enumerate().map(|(env, count)| count * (env + 1)).sum();
        assert_eq!(evaluation.episodes, episodes as u64);
        assert_eq!(evaluation.episode_return, Some(sum as f64 / episodes as f64), "{episodes} episodes");
    }
}

#[test]
fn an_evaluation_asks_whether_to_go_on_and_stops_when_it_shall() {
    let trainer = Trainer::new(points(), config(), 7).unwrap();
    let mut asked = 0;
    let evaluation = evaluate(&mut trainer.policy(), points().as_mut(), 80, 5, |counted| {
        asked += 1;
        counted < 40
    });
    let counted = evaluation.unwrap().episodes;
    assert!((40..80).contains(&counted) && asked > 0, "{counted} after {asked} questions");
}

#[test]
fn an_evaluation_goes_out_and_in_under_its_names() {
    let trainer = Trainer::new(points(), config(), 7).unwrap();
    let run = |episodes| evaluate(&mut trainer.policy(), points().as_mut(), episodes, 5, |_| true).unwrap();
    let evaluation = run(80);
    assert_eq!(evaluation.episodes, 80);
    assert_eq!(evaluation, run(80), "the same seed gives the same evaluation");
    let [low, high] = evaluation.success_interval.unwrap();
    assert!(low <= evaluation.success.unwrap() && evaluation.success.unwrap() <= high);
    assert_eq!(evaluation.targets.len(), 2);
    assert!(evaluation.targets[0].success >= evaluation.targets[1].success);

    let json: serde_json::Value = serde_json::to_value(&evaluation).unwrap();
    let mut keys: Vec<_> = json.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    let expected = [
        "effort",
        "effort_interval",
        "episode_length_s",
        "episode_length_s_interval",
        "episodes",
        "exits",
        "exits_interval",
        "fatigue",
        "fatigue_interval",
        "final_distance_m",
        "final_distance_m_interval",
        "on_target",
        "on_target_interval",
        "return",
        "return_interval",
        "success",
        "success_interval",
        "targets",
        "tracking_error_m",
        "tracking_error_m_interval",
        "wrong_presses",
        "wrong_presses_interval",
    ];
    assert_eq!(keys, expected);
    let mut keys: Vec<_> = json["targets"][0].as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    let expected = [
        "movement_time_s",
        "movement_time_s_interval",
        "movement_time_s_sd",
        "success",
        "success_interval",
        "time_s",
        "time_s_interval",
        "time_s_sd",
    ];
    assert_eq!(keys, expected);

    let folder = tempfile::tempdir().unwrap();
    let (_, run) = start(&folder.path().join("run"));
    run.folder().write_evaluation(&evaluation).unwrap();
    let text = fs::read(folder.path().join("run/evaluation.json")).unwrap();
    assert_eq!(serde_json::from_slice::<Evaluation>(&text).unwrap(), evaluation);
}
