//! MuJoCo's C library as the opponent, run by a Python interpreter that has it.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use myo::model::Model;
use myo::model::mjcf::{MjcfOptions, to_mjcf};

use crate::cli::failure::{Failure, Result};

const SCRIPT: &str = include_str!("step_mujoco.py");

/// MuJoCo's own default; the exported file asks for more exact solutions, which would be slower.
const TOLERANCE: f64 = 1e-8;

/// A process that steps one model with `mj_step`.
pub struct Opponent {
    /// Version of MuJoCo.
    pub version: String,
    python: PathBuf,
    process: Child,
    orders: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    _model_file: tempfile::NamedTempFile,
}

impl Opponent {
    /// Starts the process. With `one_core` it and the calling thread, with all threads that it starts later, stay on
    /// the same core, where the system allows that.
    pub fn start(python: &Path, model: &Model, one_core: bool) -> Result<Self> {
        let mut model_file = tempfile::Builder::new().suffix(".xml").tempfile()?;
        let options = MjcfOptions { tolerance: TOLERANCE, ..MjcfOptions::default() };
        model_file.write_all(to_mjcf(model, &options).as_bytes())?;
        let started = Command::new(python)
            .args(["-c", SCRIPT])
            .arg(model_file.path())
            .arg(if one_core { "one-core" } else { "any-core" })
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn();
        let mut process =
            started.map_err(|error| Failure::sentence(format!("cannot run {}: {error}", python.display())))?;
        let (orders, answers) = (process.stdin.take(), process.stdout.take());
        let Some(answers) = answers else { return Err(Failure::sentence("the Python process has no output")) };
        let answers = BufReader::new(answers);
        let mut opponent = Self {
            version: String::new(),
            python: python.to_owned(),
            process,
            orders,
            answers,
            _model_file: model_file,
        };
        opponent.version = opponent.answer()?;
        Ok(opponent)
    }

    /// Seconds that a number of control steps of 25 physics steps took, and the share of them that ended at a limit.
    pub fn step(&mut self, control_steps: usize) -> Result<(f64, f64)> {
        if let Some(orders) = &mut self.orders {
            // A process that has ended is told by its missing answer.
            let _ = writeln!(orders, "{control_steps}").and_then(|()| orders.flush());
        }
        let answer = self.answer()?;
        let numbers: Vec<f64> = answer.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        match numbers[..] {
            [seconds, limited] => Ok((seconds, limited)),
            _ => Err(Failure::sentence(format!("the Python process answered `{answer}`, not with two numbers"))),
        }
    }

    fn answer(&mut self) -> Result<String> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? > 0 {
            return Ok(line.trim().to_owned());
        }
        let mut said = String::new();
        if let Some(stderr) = &mut self.process.stderr {
            // Whatever it said is better than nothing.
            let _ = stderr.read_to_string(&mut said);
        }
        let reason = said.trim().lines().last().unwrap_or("it said nothing").to_owned();
        let python = self.python.display();
        Err(Failure::sentence(format!(
            "{python} cannot step the model with MuJoCo: {reason}. Name an interpreter that has the package `mujoco`: \
             --against-mujoco PYTHON"
        )))
    }
}

impl Drop for Opponent {
    fn drop(&mut self) {
        // The end of its input ends the process.
        drop(self.orders.take());
        let _ = self.process.wait();
    }
}

/// The interpreter of the tests' environment, if they have run here, else the one on the path.
pub fn default_python() -> PathBuf {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| PathBuf::from("target"), PathBuf::from);
    let tests = target.join("parity/mujoco-3.17.0/bin/python");
    if tests.exists() { tests } else { PathBuf::from("python3") }
}
