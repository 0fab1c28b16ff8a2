//! A training, and what can go wrong at each of its file operations.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use myo::train::RunFolder;

use super::left::{Left, names};

/// Cases that run side by side.
const THREADS: usize = 2;

const SIGKILL: i32 = 9;

/// Over in a fifth of a second, so that evaluations take no time.
pub const TASK: &str = "\
version: 1
name: crash
targets:
  - kind: pointing
    position: {x: [0.3, 0.5], y: [-0.2, 0.3], z: [-0.3, 0.2]}
    radius: 0.15
    dwell_s: 0.01
time_limit_s: 0.2
";

/// A training of some updates, with a checkpoint after each.
pub struct Scene {
    pub place: tempfile::TempDir,
    pub shim: PathBuf,
    /// Arguments of `myo train`, without the folder.
    pub training: Vec<String>,
    /// A run that was killed, to go on with in place of a new one.
    pub begun: Option<PathBuf>,
    /// Control steps that it is to go on to, if not to the goal that it began with.
    pub further: Option<u64>,
    /// What goes wrong, and cases of a sample for each.
    pub faults: Vec<(Fault, usize)>,
}

/// Something that goes wrong at a file operation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
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

/// Seconds per control step of a task's text.
fn control_dt(task: &str) -> f64 {
    let written = task.lines().find_map(|line| line.strip_prefix("control_dt_s: "));
    written.map_or(0.05, |seconds| seconds.parse().expect("a number"))
}

impl Scene {
    /// A training with these further arguments.
    pub fn new(more: &[&str]) -> Self {
        Self::of(TASK, [32, 64], more)
    }

    /// A training on this task in so many environments, of which each takes so many steps per update.
    pub fn of(task: &str, [envs, steps]: [usize; 2], more: &[&str]) -> Self {
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
        fs::write(place.path().join("crash.yaml"), task).unwrap();
        let (envs, steps) = (envs.to_string(), format!("rollout_s={}", steps as f64 * control_dt(task)));
        let fixed = ["crash.yaml", "--envs", &envs, "--checkpoint-every-s", "0", "--threads", "1"];
        let small = ["--set", &steps, "--set", "policy_hidden=[8]", "--set", "value_hidden=[8]"];
        let training = [&fixed[..], &small, more].concat().into_iter().map(String::from).collect();
        let faults = [Fault::Kill, Fault::Torn, Fault::Eio, Fault::Enospc].map(|fault| (fault, 6)).into();
        Self { place, shim, training, begun: None, further: None, faults }
    }

    /// The same, with so many cases of each fault in a sample: for trainings that take long.
    pub fn sample(mut self, cases: usize) -> Self {
        self.faults.iter_mut().for_each(|(_, sample)| *sample = cases);
        self
    }

    /// The same, going on with a run that was killed: at the operation that `at` says of how many there are.
    pub fn begun(self, at: impl Fn(usize) -> usize) -> Self {
        let (whole, operations) = self.undisturbed();
        let (run, at) = (self.place.path().join("begun"), at(operations.len()).to_string());
        let output = self.start(&run, &[("FAULT", "kill"), ("FAULT_AT", &at)]);
        assert_eq!(output.status.signal(), Some(SIGKILL));
        let scene = Self { begun: Some(run), ..self };
        assert_eq!(whole.difference(&scene.undisturbed().0), None);
        scene
    }

    /// The same, going on with a run that was over, by so many control steps.
    pub fn further(self, steps: u64) -> Self {
        let run = self.place.path().join("begun");
        let output = self.start(&run, &[]);
        assert!(output.status.success(), "{}", errors(&output));
        let end = RunFolder::open(&run).unwrap().latest_checkpoint().unwrap().checkpoint.expect("a checkpoint");
        Self { begun: Some(run), further: Some(end.env_steps() + steps), ..self }
    }

    /// Runs `myo train` with a run folder and variables of the shim.
    fn train(&self, args: &[&str], run: &Path, variables: &[(&str, &str)]) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_myo"));
        command.arg("train").args(args).current_dir(self.place.path()).stdin(Stdio::null());
        // Compiled kernels are kept from test to test, but not in the user's folder.
        command.env("MYO_CACHE_DIR", env!("CARGO_TARGET_TMPDIR"));
        if !variables.is_empty() {
            command.env("LD_PRELOAD", &self.shim).env("FAULT_ROOT", run).envs(variables.iter().copied());
        }
        command.output().expect("the program starts")
    }

    pub fn start(&self, run: &Path, variables: &[(&str, &str)]) -> Output {
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
        // Of one run, or of several.
        if !run.join("config.json").exists() && !run.join("plan.json").exists() {
            return self.start(run, variables);
        }
        let resume = ["--resume", run.to_str().unwrap(), "--checkpoint-every-s", "0", "--threads", "1"];
        // A goal that was taken in holds.
        let is_new = |steps: &u64| RunFolder::open(run).unwrap().config().run["steps"] != *steps;
        let steps = self.further.filter(is_new).map(|steps| steps.to_string());
        let goal = steps.as_ref().map_or(vec![], |steps| vec!["--until", "off", "--steps", steps]);
        self.train(&[&resume[..], &goal].concat(), run, variables)
    }

    /// The undisturbed run and its file operations. Nothing of it is kept.
    pub fn undisturbed(&self) -> (Left, Vec<String>) {
        let (run, log) = (self.place.path().join("whole"), self.place.path().join("operations"));
        let output = self.start(&run, &[("FAULT_LOG", log.to_str().unwrap())]);
        assert!(output.status.success(), "{}", errors(&output));
        let operations = fs::read_to_string(&log).unwrap().lines().map(String::from).collect();
        let left = Left::of(&run);
        fs::remove_dir_all(run).unwrap();
        fs::remove_file(log).unwrap();
        (left, operations)
    }

    /// One case: the fault, and what is said of what comes after it, or is wrong with that.
    fn check(&self, whole: &Left, name: &str, fault: Fault, at: usize) -> Result<String, String> {
        let run = self.place.path().join(name);
        let at = at.to_string();
        let output = self.start(&run, &[("FAULT", fault.name()), ("FAULT_AT", &at)]);
        match fault {
            Fault::Kill | Fault::Torn if output.status.signal() == Some(SIGKILL) => {}
            Fault::Kill | Fault::Torn => return Err(format!("it was not killed: {}", errors(&output))),
            Fault::Eio | Fault::Enospc if output.status.success() => {}
            Fault::Eio | Fault::Enospc => check_complaint(&output, &run)?,
        }
        let mut told = String::new();
        if !output.status.success() {
            let again = self.go_on(&run, &[]);
            told = errors(&again);
            // All that was left to do may have been done.
            let is_over = ["raise it with", "has come to its plateau"].iter().any(|reason| told.contains(reason));
            if !again.status.success() && !is_over {
                return Err(format!("it does not go on: {told}"));
            }
        }
        let difference = whole.difference(&Left::of(&run));
        fs::remove_dir_all(run).unwrap();
        difference.map_or(Ok(told), Err)
    }

    /// All cases, or a sample of them, and what was said when each went on; panics with the list of those that fail.
    pub fn check_all(&self) -> Vec<String> {
        self.check_against(&self.undisturbed())
    }

    /// The same against an undisturbed run, which was made with this scene.
    pub fn check_against(&self, (whole, operations): &(Left, Vec<String>)) -> Vec<String> {
        let cases = cases(operations, &self.faults);
        let (next, all, failed) = (AtomicUsize::new(0), Mutex::default(), Mutex::new(BTreeMap::new()));
        std::thread::scope(|scope| {
            for _ in 0..THREADS {
                scope.spawn(|| {
                    while let Some(&(fault, at)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let name = format!("{}-{at}", fault.name());
                        match self.check(whole, &name, fault, at) {
                            Ok(told) => Vec::push(&mut all.lock().unwrap(), told),
                            Err(reason) => {
                                failed.lock().unwrap().insert(name, format!("{}: {reason}", operations[at - 1]));
                            }
                        }
                    }
                });
            }
        });
        let failed = failed.into_inner().unwrap();
        println!("{} cases at {} file operations", cases.len(), operations.len());
        assert!(failed.is_empty(), "{} of {} cases: {failed:#?}", failed.len(), cases.len());
        all.into_inner().unwrap()
    }
}

/// Faults and numbers of the operations that they happen at.
fn cases(operations: &[String], faults: &[(Fault, usize)]) -> Vec<(Fault, usize)> {
    let is_all = std::env::var_os("MYO_TEST_ALL").is_some_and(|all| all == "1");
    let of = |&(fault, sample): &(Fault, usize)| {
        let all: Vec<_> = (1..=operations.len()).filter(|at| fault.concerns(&operations[at - 1])).collect();
        let stride = if is_all { 1 } else { all.len().div_ceil(sample).max(1) };
        // Not the same place of every update.
        all.into_iter().skip(stride / 2).step_by(stride).map(move |at| (fault, at)).collect::<Vec<_>>()
    };
    faults.iter().flat_map(of).collect()
}

pub fn errors(output: &Output) -> String {
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

/// A graphics card that is computed by the processor, if a driver for one is there.
pub fn software_card() -> Option<String> {
    let output =
        Command::new(env!("CARGO_BIN_EXE_myo")).args(["devices", "--json"]).output().expect("the program starts");
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).ok()?;
    let card = found["devices"].as_array()?.iter().find(|device| device["kind"] == "software")?;
    card["name"].as_str().map(String::from)
}
