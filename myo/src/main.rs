//! The `myo` command: `myo --help` tells the rest.
mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
