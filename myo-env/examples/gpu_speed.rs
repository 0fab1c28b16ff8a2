//! Control steps per second on the graphics card: `gpu_speed [TASK]`.
use myo_env::gpu::PhysicsBench;
use myo_env::{EnvConfig, GpuEnv, Tables, VectorEnv};
use myo_gpu::{Batch, Gpu, Want};
use std::time::Instant;

fn measure(gpu: &Gpu, add: impl Fn(&mut Batch)) -> f64 {
    let run = |count: u32| {
        let start = Instant::now();
        let mut batch = gpu.batch();
        for _ in 0..count {
            add(&mut batch);
        }
        batch.submit().unwrap();
        gpu.wait().unwrap();
        start.elapsed().as_secs_f64()
    };
    run(2);
    let count = (0.2 / (run(3) / 3.0)).ceil().clamp(2.0, 400.0) as u32;
    (0..5).map(|_| run(count) / f64::from(count)).fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let name = std::env::args().nth(1).unwrap_or("pointing".into());
    let task = myo_tasks::preset(&name).ok_or("no such task")?;
    let model = myo_model::Model::new(&myo_model::builtin(&task.model)?)?;
    let tables = Tables::<f64>::new(&model, &task)?;
    let start = Instant::now();
    let gpu = Gpu::open(&Want::Any)?;
    println!("{name} on {}, open {:.0} ms", gpu.adapter().name, start.elapsed().as_secs_f64() * 1e3);
    let sizes: Vec<usize> = match std::env::args().nth(2) {
        Some(sizes) => sizes.split(',').map(|x| x.parse().unwrap()).collect(),
        None => vec![1024, 16_384, 65_536, 262_144],
    };
    for num_envs in sizes {
        let start = Instant::now();
        let env = {
            let form = std::env::var_os("MYO_LOOPS").map(|_| myo_scalar::symbolic::Form::Loops);
            let options = myo_env::gpu::GpuOptions { form, ..Default::default() };
            GpuEnv::with_options(&gpu, &model, &task, &EnvConfig { num_envs, ..Default::default() }, &options)?
        };
        let ready = start.elapsed().as_secs_f64();
        let nact = env.spec().action_size();
        let mut x = 1u32;
        for shard in env.shards() {
            let actions: Vec<f32> = (0..nact * shard.num_envs)
                .map(|_| {
                    x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (x >> 8) as f32 / (1 << 23) as f32 - 1.0
                })
                .collect();
            gpu.write(&shard.actions, 0, &actions)?;
        }
        let whole = measure(&gpu, |batch| env.shards().iter().for_each(|shard| shard.step(env.kernels(), batch)));
        let start = Instant::now();
        let physics = PhysicsBench::new(&env, &tables)?;
        let physics_ready = start.elapsed().as_secs_f64();
        let alone = measure(&gpu, |batch| physics.step(batch));
        println!(
            "{num_envs:8} envs: whole {:8.2} M/s, physics {:8.2} M/s (ready {ready:.2} s, physics {physics_ready:.2} s)",
            num_envs as f64 / whole / 1e6,
            num_envs as f64 / alone / 1e6
        );
    }
    Ok(())
}
