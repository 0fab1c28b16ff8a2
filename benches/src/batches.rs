//! How long batches of kernels take.

use std::collections::BTreeMap;
use std::time::Instant;

use myo_gpu::{Batch, Gpu};

/// What may go wrong.
pub type Failure = Box<dyn std::error::Error>;

/// Seconds per repetition: the best of several batches, each long enough to hide its submission.
pub fn seconds(gpu: &Gpu, add: impl Fn(&mut Batch)) -> Result<f64, Failure> {
    let run = |count: u32| -> Result<f64, Failure> {
        let start = Instant::now();
        let mut batch = gpu.batch();
        (0..count).for_each(|_| add(&mut batch));
        batch.submit()?;
        gpu.wait()?;
        Ok(start.elapsed().as_secs_f64())
    };
    run(2)?;
    let count = (0.1 / (run(3)? / 3.0)).ceil().clamp(2.0, 400.0) as u32;
    let mut best = f64::INFINITY;
    for _ in 0..4 {
        best = best.min(run(count)? / f64::from(count));
    }
    Ok(best)
}

/// Prints how much of the device's time each kernel takes.
pub fn breakdown(gpu: &Gpu, add: impl Fn(&mut Batch)) -> Result<(), Failure> {
    let Ok(mut batch) = gpu.batch().timed() else {
        println!("    (this device has no clock)");
        return Ok(());
    };
    add(&mut batch);
    let mut kernels = BTreeMap::<String, (u32, f64)>::new();
    for timing in batch.submit_and_time()? {
        let (count, seconds) = kernels.entry(timing.kernel).or_default();
        *count += 1;
        *seconds += timing.seconds;
    }
    for (kernel, (count, seconds)) in kernels {
        let each = seconds / f64::from(count) * 1e6;
        println!("    {kernel:24} {count:4} x {each:9.1} us = {:8.3} ms", seconds * 1e3);
    }
    Ok(())
}
