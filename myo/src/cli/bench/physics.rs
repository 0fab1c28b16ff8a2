//! `myo bench physics`: random controls, redrawn every 25 steps; only the steps are timed.

use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use myo::dynamics::{Batch, CouplingMode, Plan, SolverCount};
use myo::scalar::Level;
use serde::Serialize;
use serde_json::json;

use super::machine::Machine;
use super::mujoco::{Opponent, default_python};
use super::random::Random;
use super::{Code, CodeName, best_and_median};
use crate::cli::failure::{Failure, Result, complain};
use crate::cli::output::{percent, print, print_json, rounded, row, table};
use crate::cli::{model, parse};

/// Physics steps between two draws of the controls: a control step of 50 ms at 500 Hz.
const SUBSTEPS: usize = 25;
/// Measurements; the opponents take turns.
const REPEATS: usize = 11;
/// Control steps per measurement.
const STEPS: usize = 20;
/// The same for MuJoCo, which steps one body at a time.
const MUJOCO_STEPS: usize = 200;
/// Control steps before the first measurement: bodies leave the pose they start in and come to their limits.
const WARM_UP: usize = 40;

/// Arguments of `myo bench physics`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct PhysicsArgs {
    /// Compare with MuJoCo's `mj_step` through a Python interpreter that has the package `mujoco` [default: that of the
    /// tests, else python3]
    #[arg(long, value_name = "PYTHON", num_args = 0..=1)]
    against_mujoco: Option<Option<PathBuf>>,

    /// Instruction sets, separated by commas [default: machine code if there can be any, and the widest of this processor]
    #[arg(long, value_enum, value_delimiter = ',')]
    level: Vec<CodeName>,

    /// Name of a model, or a model file
    #[arg(long, default_value = "mobl-arms")]
    model: String,

    /// Bodies side by side [default: 1024 for each thread]
    #[arg(long, value_name = "N", value_parser = parse::positive)]
    envs: Option<usize>,

    /// Print the rows as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench physics
  myo bench physics --against-mujoco --level compiled,avx512,avx2
  myo bench physics --threads 8 --json

Every body gets new random excitations in [0, 1] every 25 physics steps of 2 ms. Rates are those of the best of 11
measurements; `median` is the middle one; `rounds` are those of the constraint solver per physics step, `unsolved` the
physics steps that it gave up on, which should be none. With `--against-mujoco` the two take turns, on one core if `--threads` is 1,
and `ratio` is the quotient of the physics steps per second.

JSON: `rows` of objects with `backend`, `level`, `model`, `envs`, `threads`, `physics_steps_per_s`,
`control_steps_per_s`, `physics_steps_per_s_median`, `limited` (share of control steps that end with a joint beyond its
limit), `solver_rounds` (of the constraint solver per physics step), `solver_unsolved` (physics steps that it gave up on; 0
is right), `ratio`, `ratio_median`, `machine`, `date`, `version`; and `ratio` of the first row.";

/// One measured backend.
#[derive(Clone, Debug, Serialize)]
struct Row {
    backend: String,
    level: Option<&'static str>,
    model: String,
    envs: usize,
    threads: usize,
    physics_steps_per_s: f64,
    control_steps_per_s: f64,
    physics_steps_per_s_median: f64,
    limited: f64,
    solver_rounds: Option<f64>,
    solver_unsolved: Option<u64>,
    ratio: Option<f64>,
    ratio_median: Option<f64>,
    #[serde(flatten)]
    machine: Machine,
}

/// Runs `myo bench physics`.
pub fn run(args: &PhysicsArgs, threads: usize) -> Result<()> {
    // Before this process stays on one core, which is then all that it could tell of.
    let machine = Machine::here();
    let codes = args.level.iter().map(|name| name.code()).collect::<Result<Vec<_>>>()?;
    let model = model::open(&args.model)?;
    let python = args.against_mujoco.clone().map(|python| python.unwrap_or_else(default_python));
    // Before the threads start, because they stay on the core of the one that starts them.
    let opponent = python.map(|python| Opponent::start(&python, &model, threads == 1)).transpose()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| Failure::sentence(format!("cannot start {threads} threads: {error}")))?;
    let plan = Plan::exact(&model, CouplingMode::Reduced)?.specialised();
    let envs = args.envs.unwrap_or(1024 * threads);
    let codes = if codes.is_empty() { usual(&plan)? } else { codes };
    let mut scene = Scene { model: &model.name, plan, envs, pool, opponent, machine };
    let rows = codes.into_iter().map(|code| scene.measure(code)).collect::<Result<Vec<_>>>()?.concat();
    show(args.json, &rows, &scene.machine)
}

/// Machine code if there can be any of a plan, and the lanes of this processor.
fn usual(plan: &Plan<f64>) -> Result<Vec<Code>> {
    let lanes = Code::Lanes(Level::detect()?);
    Ok(match Batch::compiled(plan, 1) {
        Ok(_) => vec![Code::Compiled, lanes],
        Err(reason) => {
            complain(&format!("without machine code: {reason}"));
            vec![lanes]
        }
    })
}

/// What is measured, and against whom.
struct Scene<'a> {
    model: &'a str,
    plan: Plan<f64>,
    envs: usize,
    pool: rayon::ThreadPool,
    opponent: Option<Opponent>,
    machine: Machine,
}

impl Scene<'_> {
    /// The row of some code, and that of MuJoCo measured in turns with it.
    fn measure(&mut self, code: Code) -> Result<Vec<Row>> {
        complain(&format!("measuring {} bodies with {}", self.envs, code.name()));
        let mut runner = Runner::new(&self.plan, self.envs, code)?;
        self.pool.install(|| runner.measure(WARM_UP));
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for _ in 0..REPEATS {
            ours.push(self.pool.install(|| runner.measure(STEPS)));
            if let Some(opponent) = &mut self.opponent {
                theirs.push(opponent.step(MUJOCO_STEPS)?);
            }
        }
        let threads = self.pool.current_num_threads();
        let mut own = self.row("cpu", (self.envs, threads), STEPS, &ours);
        own.level = Some(code.name());
        let solver: SolverCount = runner.batch.solver_counts().iter().copied().sum();
        own.solver_rounds = Some(solver.rounds as f64 / solver.steps as f64);
        own.solver_unsolved = Some(solver.unsolved);
        let Some(opponent) = &self.opponent else { return Ok(vec![own]) };
        let other = self.row(&format!("mujoco {}", opponent.version), (1, 1), MUJOCO_STEPS, &theirs);
        own.ratio = Some(own.physics_steps_per_s / other.physics_steps_per_s);
        own.ratio_median = Some(own.physics_steps_per_s_median / other.physics_steps_per_s_median);
        Ok(vec![own, other])
    }

    /// From seconds and shares of limited steps; every measurement took so many control steps.
    fn row(&self, backend: &str, (envs, threads): (usize, usize), steps: usize, measured: &[(f64, f64)]) -> Row {
        let (best, median) = best_and_median(measured.iter().map(|(seconds, _)| *seconds).collect());
        let control_steps = (envs * steps) as f64;
        let physics_steps = control_steps * SUBSTEPS as f64;
        Row {
            backend: backend.into(),
            level: None,
            model: self.model.into(),
            envs,
            threads,
            physics_steps_per_s: physics_steps / best,
            control_steps_per_s: control_steps / best,
            physics_steps_per_s_median: physics_steps / median,
            limited: measured.iter().map(|(_, limited)| limited).sum::<f64>() / measured.len() as f64,
            solver_rounds: None,
            solver_unsolved: None,
            ratio: None,
            ratio_median: None,
            machine: self.machine.clone(),
        }
    }
}

/// A batch with random controls.
struct Runner<'a> {
    plan: &'a Plan<f64>,
    batch: Batch,
    random: Random,
    ctrl: Vec<f32>,
}

impl<'a> Runner<'a> {
    fn new(plan: &'a Plan<f64>, envs: usize, code: Code) -> Result<Self> {
        let batch = match code {
            Code::Lanes(level) => Batch::new(plan, envs, level),
            Code::Compiled => Batch::compiled(plan, envs).map_err(|error| Failure::sentence(error.to_string()))?,
        };
        Ok(Self { plan, batch, random: Random(1), ctrl: vec![0.0; plan.nmuscle()] })
    }

    /// Seconds that a number of control steps took, and the share of them that ended with a joint beyond its limit.
    fn measure(&mut self, control_steps: usize) -> (f64, f64) {
        let (mut seconds, mut limited) = (0.0, 0);
        for _ in 0..control_steps {
            for body in 0..self.batch.size() {
                self.ctrl.iter_mut().for_each(|x| *x = self.random.unit());
                self.batch.set_ctrl(body, &self.ctrl);
            }
            let start = Instant::now();
            self.batch.step(SUBSTEPS);
            seconds += start.elapsed().as_secs_f64();
            limited += (0..self.batch.size()).filter(|&body| self.is_limited(body)).count();
        }
        (seconds, limited as f64 / (control_steps * self.batch.size()) as f64)
    }

    fn is_limited(&self, body: usize) -> bool {
        let beyond = |(q, range): (f32, Option<[f64; 2]>)| {
            range.is_some_and(|[low, high]| f64::from(q) < low || f64::from(q) > high)
        };
        self.batch.qpos(body).into_iter().zip(self.plan.dofs.iter().map(|dof| dof.range)).any(beyond)
    }
}

fn show(json: bool, rows: &[Row], machine: &Machine) -> Result<()> {
    if json {
        return print_json(&json!({"rows": rows, "ratio": rows.first().and_then(|row| row.ratio)}));
    }
    let heading = [
        "backend",
        "level",
        "envs",
        "threads",
        "physics steps/s",
        "median",
        "control steps/s",
        "limited",
        "rounds",
        "unsolved",
        "ratio",
    ];
    let mut cells = vec![row(heading)];
    cells.extend(rows.iter().map(|r| {
        row([
            &r.backend,
            r.level.unwrap_or("-"),
            &r.envs.to_string(),
            &r.threads.to_string(),
            &rounded(r.physics_steps_per_s),
            &rounded(r.physics_steps_per_s_median),
            &rounded(r.control_steps_per_s),
            &percent(r.limited),
            &r.solver_rounds.map_or(String::new(), |rounds| format!("{rounds:.2}")),
            &r.solver_unsolved.map_or(String::new(), |steps| steps.to_string()),
            &r.ratio.map_or(String::new(), |ratio| format!("{ratio:.0}")),
        ])
    }));
    print(&format!("{}, {}, myo {}\n{}", machine.machine, machine.date, machine.version, table(&cells)))
}
