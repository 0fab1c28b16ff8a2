//! One gradient step of the published networks (policy 4 x 128, value 5 x 256) with Adam, as JSON, an object per line:
//! `cargo run --release -p myo-benches --example gradient_step -- processor|card SAMPLES ...`.
//!
//! `benches/peers/torch_learner.py` measures the same in PyTorch. On the processor, the time is what an update of one gradient
//! step says that learning took; advantages and the order of the samples are part of it.

use std::time::Instant;

use clap::{Parser, ValueEnum};
use myo_benches::{Failure, Idle, RollOut, seconds};
use myo_gpu::{AdapterChoice, Gpu};
use myo_train::gpu::{DeviceLearner, Settings};
use myo_train::{PpoConfig, Trainer};
use serde_json::json;

/// Measures one gradient step of the published networks.
#[derive(Parser)]
struct Arguments {
    /// Where it is measured
    device: Device,
    /// Numbers of samples
    #[arg(required = true, value_delimiter = ',')]
    samples: Vec<usize>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Device {
    Processor,
    Card,
}

/// Measurements on the processor last at least this long (s).
const LEAST_S: f64 = 1.0;

fn config(samples: usize) -> PpoConfig {
    PpoConfig {
        num_envs: samples,
        rollout_s: 0.05,
        epochs: 1,
        minibatches: 1,
        policy_hidden: vec![128; 4],
        value_hidden: vec![256; 5],
        ..PpoConfig::default()
    }
}

/// Best and median.
fn on_processor(samples: usize) -> Result<(f64, f64), Failure> {
    let mut trainer = Trainer::new(Box::new(Idle::new(&config(samples))), config(samples), 1)?;
    trainer.update()?;
    let (start, mut times) = (Instant::now(), vec![]);
    while times.len() < 5 || start.elapsed().as_secs_f64() < LEAST_S {
        let metrics = trainer.update()?;
        if !metrics.learn.gradient_norm.is_finite() {
            return Err("the gradient is not finite".into());
        }
        times.push(metrics.learn_s);
    }
    times.sort_by(f64::total_cmp);
    Ok((times[0], times[times.len() / 2]))
}

/// The best of several batches of gradient steps.
fn on_card(gpu: &Gpu, config: &PpoConfig) -> Result<f64, Failure> {
    let RollOut { sizes, record, parameters } = RollOut::new(gpu, config)?;
    let mut learner = DeviceLearner::new(gpu, &sizes, config, &parameters, &record)?;
    learner.prepare(&sizes, Settings { seed: 1, update: 0, learning_rate: 1e-4, gradient_steps: 0 })?;
    let best = seconds(gpu, |batch| learner.record_step(batch))?;
    let mut after = vec![0.0; parameters.len()];
    gpu.read(&parameters, 0, &mut after)?;
    if after.iter().any(|x| !x.is_finite()) {
        return Err("a parameter is not finite after the gradient steps".into());
    }
    Ok(best)
}

fn row(system: &str, device: &str, samples: usize, best: f64, median: Option<f64>) {
    let row = json!({
        "what": "gradient step", "system": system, "version": env!("CARGO_PKG_VERSION"), "device": device,
        "samples": samples, "gradient_step_s": best, "gradient_step_s_median": median,
    });
    println!("{row}");
}

fn main() -> Result<(), Failure> {
    let Arguments { device, samples: sizes } = Arguments::parse();
    match device {
        Device::Processor => {
            let device = format!("{} threads", rayon::current_num_threads());
            for samples in sizes {
                let (best, median) = on_processor(samples)?;
                row("Myo, 32 bits", &device, samples, best, Some(median));
            }
        }
        Device::Card => {
            let gpu = Gpu::open(&AdapterChoice::Any)?;
            let name = &gpu.adapter().name;
            for samples in sizes {
                let plain = PpoConfig { matrix_units: false, ..config(samples) };
                row("Myo, 32 bits", name, samples, on_card(&gpu, &plain)?, None);
                if gpu.adapter().cooperative_matrix {
                    row("Myo, matrix units", name, samples, on_card(&gpu, &config(samples))?, None);
                }
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_of_the_documents_are_understood() {
        let read = |line: &str| Arguments::try_parse_from(line.split(' '));
        let Arguments { device, samples } = read("gradient_step card 1280 8192 65536").unwrap();
        assert!(matches!(device, Device::Card));
        assert_eq!(samples, [1280, 8192, 65_536]);
        assert!(matches!(read("gradient_step processor 64").unwrap().device, Device::Processor));
        assert!(read("gradient_step card").is_err() && read("gradient_step 64").is_err());
    }
}
