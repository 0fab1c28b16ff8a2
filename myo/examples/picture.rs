//! Draws one episode of a trained user as SVG: `cargo run --release -p myo-sim --example picture -- RUN TASK OUT.svg`.

use myo::env::{Autoreset, CpuEnv, EnvConfig, StepStorage, VectorEnv};
use myo::model::builtin;
use myo::picture::Painter;
use myo::train::RunFolder;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [run, task, out] = arguments.as_slice() else { return Err("usage: picture RUN TASK OUT.svg".into()) };
    let task = myo::tasks::load(task)?.task;
    let model = task.embody(&builtin(&task.model)?)?;
    let latest = RunFolder::open(run.as_ref())?.latest_checkpoint()?;
    let mut policy = latest.checkpoint.ok_or("the run has no checkpoint")?.policy();

    let config = EnvConfig { seed: 5, autoreset: Autoreset::Disabled, ..EnvConfig::default() };
    let mut env = CpuEnv::new(&model, &task, &config)?;
    let mut now = StepStorage::new(env.spec());
    let mut action = vec![0.0; env.spec().action_size()];
    env.reset(None, None, &mut now.observation)?;
    let mut moments = env.peek(0..1)?;
    while !(now.terminated[0] || now.truncated[0]) {
        policy.act_deterministic(&now.observation, &mut action);
        env.step(&action, now.buffers())?;
        moments.extend(env.peek(0..1)?);
    }
    std::fs::write(out, Painter::new(&model, &task)?.episode(&moments)?.svg())?;
    Ok(())
}
