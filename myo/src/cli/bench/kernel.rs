//! `myo bench kernel`: what the kernel of a task consists of.

use std::path::PathBuf;
use std::time::Instant;

use clap::{Args, ValueEnum};
use myo::env::gpu::record::{self, PHYSICS_BUFFERS, RESET_BUFFERS, STEP_BUFFERS};
use myo::env::{Autoreset, Tables};
use myo::scalar::symbolic::{Form, Program};
use myo::train::write_whole;
use serde_json::json;

use crate::cli::failure::{Failure, Result};
use crate::cli::output::{grouped, print, print_json, row, table};
use crate::cli::scenario::Scenario;

/// Threads of a workgroup in the text; it changes nothing else.
const WORKGROUP: u32 = 32;

/// Arguments of `myo bench kernel`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct KernelArgs {
    /// Name of a task, or a task file
    #[arg(long, default_value = "pointing-uitb")]
    task: String,

    /// Which kernel
    #[arg(long, value_enum, default_value_t = KernelKind::Env)]
    part: KernelKind,

    /// Loops over the tables of the body, as too large bodies have them
    #[arg(long)]
    loops: bool,

    /// Write the kernel as WGSL, to be read
    #[arg(long, value_name = "FILE")]
    wgsl: Option<PathBuf>,

    /// Print the counts as JSON
    #[arg(long)]
    json: bool,
}

const HELP: &str = "\
Examples:
  myo bench kernel
  myo bench kernel --task ar --part physics --wgsl physics.wgsl

One thread of a graphics card runs one environment for one control step. An operation is counted once, in the stage that
needs it first, however often its loop runs. No graphics card is needed.

JSON: `task`, `part`, `operations`, `record_s` (seconds until the kernel was recorded), and `stages`, a list of objects with
`stage` (names from the outermost on) and `operations`.";

/// Which kernel.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum KernelKind {
    /// A control step with everything that belongs to it
    Env,
    /// The physics of a control step
    Physics,
    /// The reset
    Reset,
}

impl KernelKind {
    fn record(self, tables: &Tables<f64>, form: Form) -> Program {
        match self {
            Self::Env => record::step(tables, Autoreset::default(), form),
            Self::Physics => record::physics(tables, form),
            Self::Reset => record::reset_program(tables, form),
        }
    }

    fn buffers(self) -> &'static [&'static str] {
        match self {
            Self::Env => &STEP_BUFFERS,
            Self::Physics => &PHYSICS_BUFFERS,
            Self::Reset => &RESET_BUFFERS,
        }
    }
}

/// Runs `myo bench kernel`.
pub fn run(args: &KernelArgs) -> Result<()> {
    let scenario = Scenario::open(&args.task)?;
    let tables = Tables::<f64>::new(&scenario.model, &scenario.task)?;
    record::check(&tables)?;
    let start = Instant::now();
    let program = args.part.record(&tables, if args.loops { Form::Loops } else { Form::Straight });
    let record_s = start.elapsed().as_secs_f64();
    if let Some(path) = &args.wgsl {
        let text = program.to_kernel(args.part.buffers(), WORKGROUP).to_wgsl().map_err(Failure::sentence)?;
        write_whole(path, text.as_bytes())?;
    }
    let part = args.part.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned());
    let stages: Vec<_> = program.stage_counts().into_iter().map(|s| (s.path.join(" / "), s.operations)).collect();
    if args.json {
        let stages: Vec<_> = stages.iter().map(|(stage, n)| json!({"stage": stage, "operations": n})).collect();
        return print_json(&json!({
            "task": scenario.task.name,
            "part": part,
            "operations": program.operations(),
            "record_s": record_s,
            "stages": stages,
        }));
    }
    let mut rows = vec![row(["operations", "stage"])];
    rows.extend(stages.iter().map(|(stage, n)| row([&grouped(*n as u64), stage])));
    let all = grouped(program.operations() as u64);
    print(&format!("{}, {part}: {all} operations, recorded in {record_s:.2} s\n{}", scenario.task.name, table(&rows)))
}
