//! What an episode tells of the constraint solver.

use crate::common::{arm, column, gpu, rollout, short, without_gpu};
use myo_env::{CpuEnv, EnvConfig, GpuEnv, StepStorage, VectorEnv};

const ENVS: usize = 21;

/// A column of the episodes that ended in a step.
fn ended(env: &dyn VectorEnv, out: &StepStorage, name: &str) -> Vec<f32> {
    let column = column(env, name);
    out.episode.chunks(env.spec().episode_size()).map(|episode| episode[column]).collect()
}

#[test]
fn an_episode_counts_its_own_rounds_and_no_others() {
    let task = short("mobile-typing");
    let mut env = CpuEnv::new(&arm(&task), &task, &EnvConfig { num_envs: ENVS, ..Default::default() }).unwrap();
    let limit = env.spec().max_episode_steps;
    let mut before = [0; ENVS];
    for episode in 0..2 {
        let run = rollout(&mut env, limit);
        let last = &run[limit - 1];
        assert!(last.truncated.iter().all(|&truncated| truncated), "every episode ends here");
        let steps = (limit as u32 * env.tables().substeps) as f32;
        for (i, mean) in ended(&env, last, "solver_rounds").into_iter().enumerate() {
            let count = env.solver_counts()[i];
            let rounds = (count.rounds - before[i]) as f32;
            assert!((mean * steps - rounds).abs() < 0.01, "episode {episode} of {i}: {mean} for {rounds} in {steps}");
            before[i] = count.rounds;
        }
        assert!(ended(&env, last, "solver_rounds").iter().any(|&mean| mean > 1.0), "limits were met");
        assert_eq!(ended(&env, last, "solver_unsolved"), [0.0; ENVS]);
    }
}

#[test]
fn a_card_counts_as_the_processor_does() {
    if without_gpu() {
        return;
    }
    let task = short("mobile-typing");
    let config = EnvConfig { num_envs: ENVS, ..Default::default() };
    let mut cpu = CpuEnv::new(&arm(&task), &task, &config).unwrap();
    let mut card = GpuEnv::new(&gpu(), &arm(&task), &task, &config).unwrap();
    let limit = cpu.spec().max_episode_steps;
    let (on_cpu, on_card) = (rollout(&mut cpu, limit), rollout(&mut card, limit));
    let rounds = |env: &dyn VectorEnv, run: &[StepStorage]| ended(env, &run[limit - 1], "solver_rounds");
    // Rounding may change when a limit is met, by a step or two of 250.
    for (x, y) in rounds(&card, &on_card).into_iter().zip(rounds(&cpu, &on_cpu)) {
        assert!((x - y).abs() < 0.02, "{x} for {y}");
    }
    assert_eq!(ended(&card, &on_card[limit - 1], "solver_unsolved"), [0.0; ENVS]);
}
