//! Control steps per second of the whole environment on one thread.
use myo_env::{CpuEnv, EnvConfig, StepStorage, VectorEnv};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for name in myo_tasks::preset_names() {
        let task = myo_tasks::preset(name).ok_or("a listed preset exists")?;
        let model = myo_model::Model::new(&myo_model::builtin(&task.model)?)?;
        let config = EnvConfig { num_envs: 1024, threads: Some(1), ..Default::default() };
        let mut env = CpuEnv::new(&model, &task, &config)?;
        let mut out = StepStorage::new(env.spec());
        let mut seed = 1u32;
        let mut actions = vec![0.0f32; 1024 * env.spec().action_size()];
        let (mut best, mut ended) = (f64::INFINITY, 0);
        for _ in 0..100 {
            for a in &mut actions {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *a = (seed >> 8) as f32 / (1 << 23) as f32 - 1.0;
            }
            let start = Instant::now();
            env.step(&actions, out.buffers())?;
            best = best.min(start.elapsed().as_secs_f64());
            ended += out.terminated.iter().filter(|&&t| t).count();
        }
        let bad = out.observation.iter().filter(|x| !x.is_finite()).count();
        println!(
            "{name:16} {:.0} control steps/s, {ended} tasks done by chance, {bad} bad numbers, obs {}",
            1024.0 / best,
            env.spec().observation_size()
        );
    }
    Ok(())
}
