//! Speed of learning on this machine, beside the matrix product it is made of.
//!
//! `cargo run --release -p myo-benches --example learner_speed [THREADS]`

use std::hint::black_box;
use std::time::Instant;

use clap::Parser;
use faer::{Accum, Mat, Par, linalg::matmul::matmul};
use myo_benches::Idle;
use myo_train::{Mlp, PpoConfig, Trainer};
use rayon::prelude::*;

/// Measures learning on this machine, beside the matrix product it is made of.
#[derive(Parser)]
struct Arguments {
    /// As many threads as the machine runs at once, unless told
    threads: Option<usize>,
}

const BATCH: usize = 4096;

/// Best of several timings, in seconds.
fn best(repeats: usize, mut body: impl FnMut()) -> f64 {
    body();
    let time = |_| {
        let start = Instant::now();
        body();
        start.elapsed().as_secs_f64()
    };
    (0..repeats).map(time).fold(f64::INFINITY, f64::min)
}

/// GFLOP/s of square matrix products, one on each thread.
fn matmul_peak(threads: usize) -> f64 {
    let n = 512;
    let a = Mat::<f32>::from_fn(n, n, |i, j| ((i * 7 + j) % 13) as f32);
    let mut outs = vec![Mat::<f32>::zeros(n, n); threads];
    let seconds = best(30, || {
        outs.par_iter_mut().for_each(|out| matmul(out.as_mut(), Accum::Replace, &a, &a, 1.0, Par::Seq));
    });
    threads as f64 * 2.0 * (n as f64).powi(3) / seconds / 1e9
}

/// Seconds for forward and backward passes of `BATCH` samples in chunks of `rows`.
fn network_pass(net: &Mlp, rows: usize, threads: usize) -> f64 {
    let mut parameters = vec![0.0; net.len()];
    net.initialize(1, 0, 1.0, &mut parameters);
    let x: Vec<f32> = (0..BATCH * net.inputs()).map(|i| (i % 17) as f32 * 0.1 - 0.8).collect();
    let mut lanes: Vec<_> = (0..threads).map(|_| (net.work(rows), vec![0.0; net.len()])).collect();
    let share = (BATCH / threads) * net.inputs();
    best(30, || {
        lanes.par_iter_mut().zip(x.par_chunks(share)).for_each(|((work, gradient), x)| {
            for x in x.chunks(rows * net.inputs()) {
                net.forward_for_gradient(&parameters, x, work);
                net.backward(&parameters, x, work, gradient, true);
            }
        });
        black_box(&lanes);
    })
}

fn update(peak: f64) {
    let config = PpoConfig::default();
    let (policy, value) = networks(&config);
    let flops = policy.flops_per_sample() + value.flops_per_sample();
    let samples = config.batch_size(0.05) as f64;
    let passes = samples * config.epochs as f64;
    let mut trainer = Trainer::new(Box::new(Idle::new(&config)), config, 1).expect("the settings fit");
    let (mut learn, mut collect) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..25 {
        let metrics = trainer.update().expect("the idle environment is harmless");
        learn = learn.min(metrics.learn_s);
        collect = collect.min(metrics.collect_s);
    }
    let speed = passes * flops as f64 / learn / 1e9;
    println!(
        "acting, per update of {samples}          {:8.2} ms  {:6.2} M samples/s",
        collect * 1e3,
        samples / collect / 1e6
    );
    println!("learning, per update                 {:8.2} ms  {:6.2} M samples/s", learn * 1e3, passes / learn / 1e6);
    println!("  matrix products of the gradients   {speed:8.1} GFLOP/s, {:.0} % of the peak", 100.0 * speed / peak);
}

fn networks(config: &PpoConfig) -> (Mlp, Mlp) {
    (
        Mlp::new(Idle::OBSERVATIONS, &config.policy_hidden, Idle::ACTIONS),
        Mlp::new(Idle::OBSERVATIONS, &config.value_hidden, 1),
    )
}

fn main() {
    let threads = Arguments::parse().threads.unwrap_or_else(rayon::current_num_threads);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
    pool.install(|| {
        let peak = matmul_peak(threads);
        println!("{threads} threads; matrix product 512 x 512: {peak:.1} GFLOP/s");
        let (policy, value) = networks(&PpoConfig::default());
        let flops = (policy.flops_per_sample() + value.flops_per_sample()) as f64;
        for rows in [64, 128, 256, 512] {
            let seconds = network_pass(&policy, rows, threads) + network_pass(&value, rows, threads);
            let speed = BATCH as f64 * flops / seconds / 1e9;
            println!(
                "both networks, {BATCH} samples by {rows:4} {:8.2} ms  {:6.2} M samples/s  {speed:6.1} GFLOP/s, {:.0} % of the peak",
                seconds * 1e3,
                BATCH as f64 / seconds / 1e6,
                100.0 * speed / peak
            );
        }
        update(peak);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_of_the_documents_are_understood() {
        let read = |line: &str| Arguments::try_parse_from(line.split(' ')).map(|arguments| arguments.threads);
        assert_eq!(read("learner_speed 2").unwrap(), Some(2));
        assert_eq!(read("learner_speed").unwrap(), None);
        assert!(read("learner_speed two").is_err());
    }
}
