//! Physics steps per second of one core: random excitations in [0, 1], redrawn every 25 steps.
//! An argument (`avx512`, `avx2`, `portable`) asks for one level.
use myo_dynamics::{Batch, Coupling, Plan};
use myo_model::{Model, builtin};
use myo_scalar::Level;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::new(&builtin("mobl-arms")?)?;
    let exact = Plan::exact(&model, Coupling::Reduced)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let size = 1024;
    let wanted = std::env::args().nth(1);
    for (name, plan) in [("exact", &exact), ("specialised", &exact.specialised())] {
        for level in Level::available().into_iter().filter(|level| wanted.as_ref().is_none_or(|w| w == level.name())) {
            let mut batch = Batch::new(plan, size, level);
            let mut seed = 1u32;
            let mut best = f64::INFINITY;
            for _ in 0..60 {
                for body in 0..size {
                    let ctrl: Vec<f32> = (0..plan.nmuscle())
                        .map(|_| {
                            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                            (seed >> 8) as f32 / (1 << 24) as f32
                        })
                        .collect();
                    batch.set_ctrl(body, &ctrl);
                }
                let start = Instant::now();
                pool.install(|| batch.step(25));
                best = best.min(start.elapsed().as_secs_f64());
            }
            let us = best * 1e6 / (25.0 * size as f64);
            println!("{name:12} {:9} {us:.4} us per body and step; body 3 ends at {:?}", level.name(), batch.qpos(3));
        }
    }
    Ok(())
}
