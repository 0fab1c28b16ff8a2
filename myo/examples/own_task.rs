//! A task of one's own: swing the fingertip from side to side before the arm sinks or tires. What is observed, rewarded and judged is
//! one function, which learns on a graphics card or on the processor: `cargo run --release -p myo-sim --example own_task`.

use myo::env::{Moment, Rules, Verdict};
use myo::model::builtin;
use myo::scalar::Scalar;
use myo::tasks::Task;
use myo::train::PpoConfig;
use myo::{Backend, Envs};

/// The rules, with numbers that may be chosen.
#[derive(Clone, Debug)]
pub struct Swing {
    /// How far (m) to either side of the shoulder the fingertip must go before it turns.
    pub reach: f64,
    /// So many turns are enough.
    pub turns: f64,
}

impl Rules for Swing {
    fn name(&self) -> &str {
        "swing"
    }
    fn observed(&self) -> Vec<String> {
        ["side", "sideways", "height", "speed", "tiredness"].map(String::from).to_vec()
    }
    fn remembered(&self) -> usize {
        2 // Turns so far, and tiredness: a mean of the effort of the last seconds.
    }
    #[inline(always)]
    fn step<S: Scalar>(&self, now: &Moment<'_, S>, memory: &mut [S], observation: &mut Vec<S>) -> Verdict<S> {
        let ([_, sideways, height], speed, dt) = (now.fingertip, now.fingertip_velocity[1], S::lit(now.control_dt));
        let is_odd = memory[0] - S::lit(2.0) * (S::lit(0.5) * memory[0]).floor();
        let side = S::lit(1.0) - S::lit(2.0) * is_odd; // 1 to the left, -1 to the right.
        let turns = S::indicator(S::lit(self.reach).lt(sideways * side));
        memory[0] += turns;
        memory[1] += (now.effort() - memory[1]) * dt * S::lit(0.5);
        observation.extend([side, sideways, height, speed, memory[1]]);
        let reward = turns + speed * side * dt * S::lit(3.0) - now.effort() * S::lit(0.01);
        let failed = S::lit(0.5).lt(memory[1]) | height.lt(S::lit(-0.65));
        Verdict { reward, done: S::lit(self.turns).le(memory[0]), failed }
    }
}

/// Body, time and beginning.
pub fn task() -> Task {
    Task { time_limit_s: 6.0, ..Task::without_script("swing") }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (task, config) = (task(), PpoConfig { exploring_starts: 0.0, ..PpoConfig::default() });
    let device = Backend::Auto.device(config.num_envs, &mut |reason| eprintln!("{reason}"))?;
    let (model, rules) = (task.embody(&builtin(&task.model)?)?, Swing { reach: 0.15, turns: 10.0 });
    let mut trainer = Envs::with_rules(&device, &model, &task, &rules, &config.envs(1))?.train(config, 1)?;
    for _ in 0..300 {
        println!("mean return: {:?}", trainer.update()?.episodes.mean("return"));
    }
    Ok(())
}
