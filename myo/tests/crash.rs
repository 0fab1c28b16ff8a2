//! Trainings that are killed, or whose disk fails, at every one of their file operations, and gone on with: they end as if
//! nothing had happened. A fixed sample of all cases; every one with `MYO_TEST_ALL=1`.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use myo::train::RunFolder;

/// Cases of a sample, for each kind of fault.
const SAMPLE: usize = 6;

/// Cases that run side by side.
const THREADS: usize = 2;

const SIGKILL: i32 = 9;

/// Over in a fifth of a second, so that evaluations take no time.
const TASK: &str = "\
version: 1
name: crash
targets:
  - kind: pointing
    position: {x: [0.3, 0.5], y: [-0.2, 0.3], z: [-0.3, 0.2]}
    radius: 0.15
    dwell_s: 0.05
time_limit_s: 0.2
";

/// A training of some updates, with a checkpoint after each.
struct Scene {
    place: tempfile::TempDir,
    shim: PathBuf,
    /// Arguments of `myo train`, without the folder.
    training: Vec<String>,
    /// A run that was killed, to go on with in place of a new one.
    begun: Option<PathBuf>,
    /// Control steps that it is to go on to, if not those that it began with.
    further: Option<u64>,
    /// Cases of a sample, for each kind of fault.
    sample: usize,
}

/// Something that goes wrong at a file operation.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Kill,
    Torn,
    Eio,
    Enospc,
}

impl Fault {
    fn name(self) -> &'static str {
        match self {
            Self::Kill => "kill",
            Self::Torn => "torn",
            Self::Eio => "eio",
            Self::Enospc => "enospc",
        }
    }

    /// Whether an operation can go wrong in this way.
    fn concerns(self, operation: &str) -> bool {
        let takes_room =
            ["write", "create", "mkdir", "fsync", "fdatasync"].iter().any(|name| operation.starts_with(name));
        match self {
            Self::Kill | Self::Eio => true,
            Self::Torn => operation.starts_with("write"),
            Self::Enospc => takes_room,
        }
    }
}

/// What a finished run left: names of all files, metrics but for times, checkpoint and evaluation.
#[derive(PartialEq)]
struct Left {
    files: Vec<String>,
    metrics: Vec<Vec<String>>,
    checkpoint: Vec<u8>,
    evaluation: Vec<u8>,
    events: u64,
}

impl Left {
    fn of(run: &Path) -> Self {
        let folder = RunFolder::open(run).expect("a run");
        let mut checkpoint = folder.latest_checkpoint().unwrap().checkpoint.expect("a checkpoint");
        checkpoint.forget_wall_time();
        let text = fs::read_to_string(run.join("metrics.csv")).unwrap();
        let rows: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let keep = |column: &usize| !rows[0][*column].ends_with("_s") || rows[0][*column].starts_with("target");
        let columns: Vec<usize> = (0..rows[0].len()).filter(keep).collect();
        let mut files = names(run, Path::new(""));
        // Their names tell when they were made.
        let is_event_file = |name: &String| name.starts_with("tensorboard/");
        let events =
            files.iter().filter(|name| is_event_file(name)).map(|name| run.join(name).metadata().unwrap().len());
        Self {
            events: events.sum(),
            metrics: rows.iter().map(|row| columns.iter().map(|&column| row[column].to_owned()).collect()).collect(),
            checkpoint: checkpoint.to_bytes(),
            evaluation: fs::read(run.join("evaluation.json")).expect("an evaluation"),
            files: {
                files.retain(|name| !is_event_file(name));
                files
            },
        }
    }

    /// What differs, if anything does.
    fn difference(&self, other: &Self) -> Option<String> {
        let differ = [
            ("files", self.files != other.files),
            ("metrics", self.metrics != other.metrics),
            ("checkpoint", self.checkpoint != other.checkpoint),
            ("evaluation", self.evaluation != other.evaluation),
            ("TensorBoard events", self.events != other.events),
        ];
        let found: Vec<_> = differ.iter().filter(|(_, differs)| *differs).map(|(name, _)| *name).collect();
        (!found.is_empty()).then(|| format!("other {}: {:?}, not {:?}", found.join(", "), other.files, self.files))
    }
}

/// Files below a folder, in order.
fn names(root: &Path, below: &Path) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for entry in fs::read_dir(root.join(below)).unwrap() {
        let path = below.join(entry.unwrap().file_name());
        if root.join(&path).is_dir() {
            found.extend(names(root, &path));
        } else {
            found.push(path.to_string_lossy().into_owned());
        }
    }
    found.sort();
    found
}

impl Scene {
    /// A training with these further arguments.
    fn new(more: &[&str]) -> Self {
        let place = tempfile::tempdir().unwrap();
        let shim = place.path().join("libshim.so");
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/crash/shim.rs");
        let rustc = std::env::var_os("RUSTC").unwrap_or("rustc".into());
        let built = Command::new(rustc)
            .args(["--edition", "2024", "--crate-type", "cdylib", "-O", "-o"])
            .args([&shim, Path::new(source)])
            .output()
            .expect("rustc starts");
        assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
        fs::write(place.path().join("crash.yaml"), TASK).unwrap();
        let fixed = ["crash.yaml", "--envs", "32", "--checkpoint-every-s", "0", "--threads", "1"];
        let small = ["--set", "steps_per_update=64", "--set", "policy_hidden=[8]", "--set", "value_hidden=[8]"];
        let training = [&fixed[..], &small, more].concat().into_iter().map(String::from).collect();
        Self { place, shim, training, begun: None, further: None, sample: SAMPLE }
    }

    /// The same, going on with a run that was killed in the middle.
    fn begun(self) -> Self {
        let (_, operations) = self.undisturbed();
        fs::remove_dir_all(self.place.path().join("whole")).unwrap();
        fs::remove_file(self.place.path().join("operations")).unwrap();
        let (run, at) = (self.place.path().join("begun"), (operations.len() / 2).to_string());
        let output = self.start(&run, &[("FAULT", "kill"), ("FAULT_AT", &at)]);
        assert_eq!(output.status.signal(), Some(SIGKILL));
        Self { begun: Some(run), ..self }
    }

    /// The same, going on with a run that was over to more control steps.
    fn further(self, steps: u64) -> Self {
        let run = self.place.path().join("begun");
        assert!(self.start(&run, &[]).status.success());
        Self { begun: Some(run), further: Some(steps), ..self }
    }

    /// Runs `myo train` with a run folder and variables of the shim.
    fn train(&self, args: &[&str], run: &Path, variables: &[(&str, &str)]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
        command.arg("train").args(args).current_dir(self.place.path()).stdin(Stdio::null());
        if !variables.is_empty() {
            command.env("LD_PRELOAD", &self.shim).env("FAULT_ROOT", run).envs(variables.iter().copied());
        }
        command.output().expect("the program starts")
    }

    fn start(&self, run: &Path, variables: &[(&str, &str)]) -> Output {
        if let Some(begun) = &self.begun
            && !run.exists()
        {
            for name in names(begun, Path::new("")) {
                fs::create_dir_all(run.join(&name).parent().unwrap()).unwrap();
                fs::copy(begun.join(&name), run.join(&name)).unwrap();
            }
            return self.go_on(run, variables);
        }
        let out = run.to_str().unwrap();
        let args: Vec<&str> = self.training.iter().map(String::as_str).chain(["--out", out]).collect();
        self.train(&args, run, variables)
    }

    /// Goes on with a run, or starts it again where nothing of it is there; `variables` as in [`Self::train`].
    fn go_on(&self, run: &Path, variables: &[(&str, &str)]) -> Output {
        if !run.join("config.json").exists() {
            return self.start(run, variables);
        }
        let resume = ["--resume", run.to_str().unwrap(), "--checkpoint-every-s", "0", "--threads", "1"];
        // A goal that was taken in holds.
        let is_new = |steps: &u64| RunFolder::open(run).unwrap().config().run["steps"] != *steps;
        let steps = self.further.filter(is_new).map(|steps| steps.to_string());
        let goal = steps.as_ref().map_or(vec![], |steps| vec!["--steps", steps]);
        self.train(&[&resume[..], &goal].concat(), run, variables)
    }

    /// The undisturbed run and its file operations.
    fn undisturbed(&self) -> (Left, Vec<String>) {
        let (run, log) = (self.place.path().join("whole"), self.place.path().join("operations"));
        let output = self.start(&run, &[("FAULT_LOG", log.to_str().unwrap())]);
        assert!(output.status.success(), "{}", errors(&output));
        let operations = fs::read_to_string(log).unwrap().lines().map(String::from).collect();
        (Left::of(&run), operations)
    }

    /// One case: the fault, and what is wrong with what comes after it.
    fn check(&self, whole: &Left, name: &str, fault: Fault, at: usize) -> Result<(), String> {
        let run = self.place.path().join(name);
        let at = at.to_string();
        let output = self.start(&run, &[("FAULT", fault.name()), ("FAULT_AT", &at)]);
        match fault {
            Fault::Kill | Fault::Torn if output.status.signal() == Some(SIGKILL) => {}
            Fault::Kill | Fault::Torn => return Err(format!("it was not killed: {}", errors(&output))),
            Fault::Eio | Fault::Enospc if output.status.success() => {}
            Fault::Eio | Fault::Enospc => check_complaint(&output, &run)?,
        }
        if !output.status.success() {
            let again = self.go_on(&run, &[]);
            // All that was left to do may have been done.
            if !again.status.success() && !errors(&again).contains("raise it with") {
                return Err(format!("it does not go on: {}", errors(&again)));
            }
        }
        let difference = whole.difference(&Left::of(&run));
        fs::remove_dir_all(run).unwrap();
        difference.map_or(Ok(()), Err)
    }

    /// All cases, or a sample of them; panics with the list of those that fail.
    fn check_all(&self) {
        let (whole, operations) = self.undisturbed();
        let cases = cases(&operations, self.sample);
        let (next, failed) = (AtomicUsize::new(0), Mutex::new(BTreeMap::new()));
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    while let Some(&(fault, at)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let name = format!("{}-{at}", fault.name());
                        if let Err(reason) = self.check(&whole, &name, fault, at) {
                            failed.lock().unwrap().insert(name, format!("{}: {reason}", operations[at - 1]));
                        }
                    }
                });
            }
        });
        let failed = failed.into_inner().unwrap();
        println!("{} cases at {} file operations", cases.len(), operations.len());
        assert!(failed.is_empty(), "{} of {} cases: {failed:#?}", failed.len(), cases.len());
    }
}

/// Faults and numbers of the operations that they happen at.
fn cases(operations: &[String], sample: usize) -> Vec<(Fault, usize)> {
    let is_all = std::env::var_os("MYO_TEST_ALL").is_some_and(|all| all == "1");
    let of = |fault: Fault| {
        let all: Vec<_> = (1..=operations.len()).filter(|at| fault.concerns(&operations[at - 1])).collect();
        let stride = if is_all { 1 } else { all.len().div_ceil(sample).max(1) };
        // Not the same place of every update.
        all.into_iter().skip(stride / 2).step_by(stride).map(move |at| (fault, at)).collect::<Vec<_>>()
    };
    [Fault::Kill, Fault::Torn, Fault::Eio, Fault::Enospc].into_iter().flat_map(of).collect()
}

fn errors(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// One sentence that names a file of the run.
fn check_complaint(output: &Output, run: &Path) -> Result<(), String> {
    let text = errors(output);
    let complaints: Vec<&str> = text.lines().filter(|line| line.starts_with("error: ")).collect();
    let is_plain = output.status.code() == Some(1) && !text.contains("panicked");
    match complaints[..] {
        [one] if is_plain && one.contains(run.to_str().unwrap()) => Ok(()),
        _ => Err(format!("status {:?}, complaints: {text}", output.status)),
    }
}

#[test]
fn a_training_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    Scene::new(&["--until", "off", "--steps", "8192"]).check_all();
}

#[test]
fn going_on_with_a_training_may_be_stopped_at_any_file_operation() {
    Scene::new(&["--until", "off", "--steps", "8192"]).begun().check_all();
}

#[test]
fn going_on_to_a_new_goal_may_be_stopped_at_any_file_operation() {
    Scene::new(&["--until", "off", "--steps", "4096"]).further(8192).check_all();
}

#[test]
fn a_training_with_a_goal_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    // The first seed that reaches its goal in the middle of its steps.
    let scene = (1..40).find_map(|seed| {
        let scene = Scene::new(&["--until", "0.07", "--steps", "30720", "--seed", &seed.to_string()]);
        let (left, _) = scene.undisturbed();
        (5..15).contains(&(left.metrics.len() - 1)).then_some(())?;
        fs::remove_dir_all(scene.place.path().join("whole")).unwrap();
        fs::remove_file(scene.place.path().join("operations")).unwrap();
        Some(scene)
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
    let scene = Scene::new(&["--until", "off", "--steps", "4096"]);
    let source = scene.place.path().join("source");
    assert!(scene.start(&source, &[]).status.success());
    let Scene { place, shim, mut training, begun, further, sample } = scene;
    training.truncate(7);
    training.extend(["--set", "steps_per_update=64", "--until", "off", "--steps", "4096", "--from"].map(String::from));
    training.push(source.to_str().unwrap().into());
    Scene { place, shim, training, begun, further, sample }.check_all();
}

/// A graphics card that is computed by the processor, if a driver for one is there.
fn software_card() -> Option<String> {
    let output =
        Command::new(env!("CARGO_BIN_EXE_myo")).args(["devices", "--json"]).output().expect("the program starts");
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).ok()?;
    let card = found["devices"].as_array()?.iter().find(|device| device["kind"] == "software")?;
    card["name"].as_str().map(String::from)
}

#[test]
fn a_training_on_a_card_that_is_stopped_at_any_file_operation_ends_as_one_left_alone() {
    let Some(card) = software_card() else {
        println!("skipped: there is no driver that computes a graphics card on the processor");
        return;
    };
    let scene = Scene::new(&["--until", "off", "--steps", "4096", "--backend", "gpu", "--device", &card]);
    // A start takes seconds there.
    Scene { sample: 1, ..scene }.check_all();
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
