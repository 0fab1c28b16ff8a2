//! Lists the adapters of this machine, best first, and opens the best: `cargo run -p myo-gpu --example adapters`.

use std::process::ExitCode;

use myo_gpu::{AdapterChoice, Gpu, adapters};

fn main() -> ExitCode {
    for (i, adapter) in adapters().iter().enumerate() {
        println!("{i}: {} ({:?}), {}, {}", adapter.name, adapter.kind, adapter.backend, adapter.driver);
    }
    match Gpu::open(&AdapterChoice::Any) {
        Ok(_) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
