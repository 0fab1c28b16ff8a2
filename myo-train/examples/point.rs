//! Trains a point to reach two targets and leaves a run folder: `cargo run --release -p myo-train --example point FOLDER`.

#[path = "../tests/common/mod.rs"]
mod common;

use std::path::Path;

use myo_train::{PpoConfig, RunWriter, Trainer, evaluate};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("name a folder for the run")?;
    let config = PpoConfig {
        num_envs: 256,
        exploring_starts: 0.0,
        action_offset: 0.0,
        action_scale: 1.0,
        ..PpoConfig::default()
    };
    let seed = 1;
    let mut trainer = Trainer::new(Box::new(common::Points::new(256)), config, seed)?;
    let description = serde_json::json!({ "task": "two points" });
    let mut run = RunWriter::create(Path::new(&folder), description, trainer.config(), seed, trainer.spec())?;

    for _ in 0..80 {
        let metrics = trainer.update()?;
        run.record(&metrics)?;
        if metrics.updates.is_multiple_of(20) {
            run.write_checkpoint(&trainer.save()?)?;
            let success = metrics.episodes.mean("success").unwrap_or(0.0);
            println!("{:7} steps, {:8.0} steps/s, success {success:.2}", metrics.env_steps, metrics.steps_per_s());
        }
    }
    let evaluation = evaluate(&mut trainer.policy(), &mut common::Points::new(256), 1000, 2, |_| true)?;
    run.folder().write_evaluation(&evaluation)?;
    println!("{}", serde_json::to_string_pretty(&evaluation)?);
    Ok(())
}
