//! The command line: one file per command.

mod backend;
mod bench;
mod compare;
mod devices;
#[cfg(test)]
mod docs;
mod eval;
mod export;
mod failure;
mod fit;
#[cfg(feature = "studio")]
mod html;
mod interrupt;
mod measure;
mod model;
mod model_import;
mod output;
mod parse;
mod protocol;
mod report;
mod run_folder;
mod runs;
mod scenario;
mod shell;
#[cfg(feature = "studio")]
mod studio;
mod task;
mod train;

use std::process::ExitCode;
use std::thread::Scope;

use clap::{Parser, Subcommand};
use myo::scalar::Level;

use failure::{Failure, Result};

/// Simulated users made of muscle: describe a pointing or pressing task, train an arm on it, see how well it does.
#[derive(Parser)]
#[command(name = "myo", version, after_help = FIRST_STEPS)]
struct Cli {
    #[command(subcommand)]
    command: Command,

    /// Processor threads for everything [default: all]
    #[arg(long, global = true, value_name = "N", value_parser = parse::threads)]
    threads: Option<usize>,
}

const FIRST_STEPS: &str = "\
Examples:
  myo train pointing                 train on a task that comes with the program
  myo eval runs/pointing-1           see how well it does
  myo runs                           all that was trained here
  myo task show ar > my.yaml         start a task of your own
  myo train my.yaml

Exit status: 0 done, 1 failed, 2 wrong usage, 3 graphics card lost, 130 stopped by Ctrl-C.";

#[derive(Subcommand)]
enum Command {
    /// Train a simulated user on a task
    Train(train::Train),
    /// Evaluate a trained user on fresh episodes
    Eval(eval::Eval),
    /// Compare two layouts: train users on each and tell what differs
    Compare(compare::Compare),
    /// What a trained user does, physics step by physics step, as a table
    Export(export::Export),
    /// Figures of recorded movements, of people and of simulated users in the same way
    Measure(measure::Measure),
    /// Which user moves as the people of recordings do
    Fit(fit::Fit),
    /// Runs: what was trained, and how well it does
    Runs(runs::Runs),
    /// Runs as one page for the browser, which needs nothing else
    #[cfg(feature = "studio")]
    Report(html::Report),
    /// Set up, train, watch and compare in the browser
    #[cfg(feature = "studio")]
    Studio(studio::Studio),
    /// Tasks: list, show, check
    #[command(subcommand)]
    Task(task::Command),
    /// Models of the body: list, show, check, export, import
    #[command(subcommand)]
    Model(model::Command),
    /// Graphics cards that can compute the physics
    Devices(devices::Devices),
    /// Benchmarks: physics, environment, training, kernels, NaN hunt
    #[command(subcommand)]
    Bench(bench::Command),
    /// Print a script with which a shell completes commands and options
    Completions(shell::Completions),
    /// Print manual pages
    Man(shell::Manual),
}

/// Runs the command of this process.
pub fn main() -> ExitCode {
    let cli = Cli::parse();
    // A driver may crash where the process ends while it opens a card: that is waited for, after all has been told.
    std::thread::scope(|beside| match run(cli, beside) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    })
}

fn run<'scope>(cli: Cli, beside: &'scope Scope<'scope, '_>) -> Result<()> {
    Level::detect()?;
    if let Some(threads) = cli.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
        pool.map_err(|error| Failure::sentence(format!("cannot start {threads} threads: {error}")))?;
    }
    match cli.command {
        Command::Train(args) => train::run(&args, beside),
        Command::Eval(args) => eval::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Measure(args) => measure::run(&args),
        Command::Fit(args) => fit::run(&args),
        Command::Runs(args) => runs::run(&args),
        #[cfg(feature = "studio")]
        Command::Report(args) => html::run(&args),
        #[cfg(feature = "studio")]
        Command::Studio(args) => studio::run(&args),
        Command::Task(command) => task::run(command),
        Command::Model(command) => model::run(command),
        Command::Devices(args) => devices::run(&args),
        Command::Bench(command) => bench::run(&command, cli.threads),
        Command::Completions(args) => shell::completions(&args),
        Command::Man(args) => shell::manual(&args),
    }
}
