//! Stretch reflexes: muscles that lengthen are excited more, by as much as the task says, and nothing else changes.

use crate::common::{arm, gpu, short, without_gpu};
use myo_dynamics::{CouplingMode, Plan, State, Workspace, step};
use myo_env::gpu::GpuOptions;
use myo_env::{Autoreset, CpuEnv, EnvConfig, GpuEnv, ReferenceEnv, StepStorage, VectorEnv};
use myo_model::Model;
use myo_tasks::{Reflex, Task};

const ENVS: usize = 20;
const REFLEX: Reflex = Reflex { gain: 8.0, most: 0.4 };

fn task(reflex: Reflex) -> Task {
    Task { reflex, time_limit_s: 5.0, ..short("pointing-uitb") }
}

fn config() -> EnvConfig {
    EnvConfig { num_envs: ENVS, seed: 5, autoreset: Autoreset::SameStep, ..EnvConfig::default() }
}

/// Tendon lengths (m) of the body as it is written down.
struct Tendons {
    plan: Plan<f64>,
    workspace: Workspace<f64>,
    /// Greatest shortening speed of each muscle (m/s).
    greatest: Vec<f64>,
}

impl Tendons {
    fn of(model: &Model) -> Self {
        let plan = Plan::exact(model, CouplingMode::Reduced).unwrap();
        let greatest = model.muscles.iter().map(|muscle| {
            let (ends, gain) = (muscle.parameters.length_range, &muscle.parameters.gain);
            // From end to end are so many optimal lengths.
            let optimal = (ends[1] - ends[0]) / (gain.range[1] - gain.range[0]);
            gain.vmax * optimal
        });
        Self { greatest: greatest.collect(), workspace: Workspace::new(&plan), plan }
    }

    fn lengths(&mut self, qpos: impl Iterator<Item = f64>) -> Vec<f64> {
        let qpos: Vec<f64> = qpos.collect();
        step::kinematics::kinematics(&self.plan, &qpos, &vec![0.0; qpos.len()], &mut self.workspace);
        step::tendon::lengths(&self.plan, &mut self.workspace);
        self.workspace.tendon_length.clone()
    }

    /// How fast each muscle lengthens, of its greatest shortening speed, by lengths a little before and after.
    fn lengthening(&mut self, body: &State<f64>) -> Vec<f64> {
        let dt = 1e-5;
        let [before, after] = [-dt, dt].map(|dt| {
            self.lengths(body.qpos.iter().zip(&body.qvel).map(|(position, velocity)| position + velocity * dt))
        });
        let change = after.iter().zip(&before).map(|(after, before)| (after - before) / (2.0 * dt));
        change.zip(&self.greatest).map(|(velocity, greatest)| velocity / greatest).collect()
    }
}

/// Who has reflexes does what others do that are asked for what reflexes make of what these are asked for.
fn check(make: &dyn Fn(&Task) -> Box<dyn VectorEnv>) {
    let [with, without] = [REFLEX, Reflex::default()].map(task);
    let (mut quick, mut slow) = (make(&with), make(&without));
    let mut tendons = Tendons::of(&arm(&with));
    let (spec, muscles) = (quick.spec().clone(), quick.spec().action_size());
    assert_eq!(spec.observation_names, slow.spec().observation_names);
    let (mut a, mut b) = (StepStorage::new(&spec), StepStorage::new(&spec));
    quick.reset(Some(1), None, &mut a.observation).unwrap();
    slow.reset(Some(1), None, &mut b.observation).unwrap();
    let (mut greatest, mut cut) = (0.0_f64, 0);
    for number in 0..6 {
        let asked: Vec<f32> = (0..ENVS * muscles).map(|k| ((k * 7 + number * 5) % 21) as f32 / 10.0 - 1.0).collect();
        let seen = quick.peek(0..ENVS).unwrap();
        let others: Vec<f32> = seen
            .iter()
            .flat_map(|env| tendons.lengthening(&env.body))
            .zip(&asked)
            .map(|(rate, &action)| {
                let more = (REFLEX.gain * rate).clamp(-REFLEX.most, REFLEX.most);
                (greatest, cut) = (greatest.max(more), cut + i32::from(more.abs() == REFLEX.most));
                let control = 0.5 * f64::from(action) + 0.5;
                (2.0 * (control * (1.0 + more)).min(1.0) - 1.0) as f32
            })
            .collect();
        quick.step(&asked, a.buffers()).unwrap();
        slow.step(&others, b.buffers()).unwrap();
        for (entry, (x, y)) in a.observation.iter().zip(&b.observation).enumerate() {
            let name = &spec.observation_names[entry % spec.observation_size()];
            assert!((x - y).abs() < 1e-3 * (1.0 + y.abs()), "{name}, step {number}: {x} and {y}");
        }
        let differs = a.reward.iter().zip(&b.reward).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
        assert!(differs < 1e-3, "reward, step {number}: {differs}");
    }
    assert!(greatest > 0.2 && cut > 0, "{greatest}, {cut}: both within bounds and at them");
}

#[test]
fn muscles_that_lengthen_are_excited_more() {
    check(&|task| Box::new(ReferenceEnv::new(&arm(task), task, &config()).unwrap()));
    check(&|task| Box::new(CpuEnv::new(&arm(task), task, &config()).unwrap()));
}

#[test]
fn so_they_are_on_a_card() {
    if without_gpu() {
        return;
    }
    let (gpu, options) = (gpu(), GpuOptions { envs_per_shard: 16, ..GpuOptions::default() });
    check(&|task| Box::new(GpuEnv::with_options(&gpu, &arm(task), task, &config(), &options).unwrap()));
}

#[test]
fn who_has_reflexes_can_be_without_but_not_the_other_way_round() {
    let [with, without] = [REFLEX, Reflex::default()].map(task);
    let mut env = CpuEnv::new(&arm(&with), &with, &config()).unwrap();
    env.set_task(&without).unwrap();
    let mut env = CpuEnv::new(&arm(&without), &without, &config()).unwrap();
    let error = env.set_task(&with).unwrap_err().to_string();
    assert!(error.contains("have reflexes where they had none (reflex.gain)"), "{error}");
}
