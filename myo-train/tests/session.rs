//! Whole trainings: they stop at their goal, heal themselves, tell what goes wrong, and start from others.

mod common;

use std::path::Path;

use common::Points;
use myo_env::{EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_gpu::GpuError;
use myo_train::session::{End, Examiner, Goal, News, Outcome, Progress};
use myo_train::{PpoConfig, RunFolder, RunWriter, Session, Trainer};

const ENVS: usize = 256;

fn config() -> PpoConfig {
    PpoConfig {
        num_envs: ENVS,
        steps_per_update: 16,
        policy_hidden: vec![32, 32],
        value_hidden: vec![32, 32],
        action_offset: 0.0,
        ..PpoConfig::default()
    }
}

/// Something that goes wrong in [`Points`].
#[derive(Clone, Copy)]
enum Mishap {
    None,
    /// The reward of one step is not a number.
    NanAt(usize),
    /// From this step on the device is gone.
    LostAt(usize),
    /// Targets are never done.
    Unreachable,
}

struct Fragile {
    env: Points,
    mishap: Mishap,
    steps: usize,
}

impl Fragile {
    fn new(mishap: Mishap) -> Self {
        Self { env: Points::new(ENVS), mishap, steps: 0 }
    }

    fn is_lost(&self) -> bool {
        matches!(self.mishap, Mishap::LostAt(step) if self.steps >= step)
    }
}

fn lost() -> EnvError {
    EnvError::Gpu(GpuError::DeviceLost { reason: "unplugged".into() })
}

impl VectorEnv for Fragile {
    fn spec(&self) -> &EnvSpec {
        self.env.spec()
    }
    fn reset(&mut self, seed: Option<u64>, mask: Option<&[bool]>, out: &mut [f32]) -> Result<(), EnvError> {
        self.env.reset(seed, mask, out)
    }
    fn step(&mut self, actions: &[f32], out: StepBuffers<'_>) -> Result<(), EnvError> {
        if self.is_lost() {
            return Err(lost());
        }
        self.steps += 1;
        let StepBuffers { observation, reward, terminated, truncated, final_observation, episode } = out;
        let still = vec![0.0; actions.len()];
        let actions = if matches!(self.mishap, Mishap::Unreachable) { &still } else { actions };
        self.env.step(
            actions,
            StepBuffers {
                observation,
                reward: &mut *reward,
                terminated,
                truncated,
                final_observation,
                episode: &mut *episode,
            },
        )?;
        match self.mishap {
            Mishap::NanAt(step) if self.steps == step => reward[3] = f32::NAN,
            Mishap::Unreachable => episode.chunks_mut(10).for_each(|episode| episode[2..4].fill(0.0)),
            _ => {}
        }
        Ok(())
    }
    fn save_state(&self) -> Result<Vec<u8>, EnvError> {
        if self.is_lost() { Err(lost()) } else { self.env.save_state() }
    }
    fn load_state(&mut self, state: &[u8]) -> Result<(), EnvError> {
        self.env.load_state(state)
    }
}

fn session_of(trainer: Trainer, goal: Goal) -> Session {
    let examiner = Examiner::on_host(Box::new(Points::new(ENVS)), trainer.seed());
    Session::new(trainer, examiner, goal)
}

fn session(mishap: Mishap, config: PpoConfig, goal: Goal) -> Session {
    session_of(Trainer::new(Box::new(Fragile::new(mishap)), config, 1).unwrap(), goal)
}

fn recorded(session: Session, folder: &Path) -> Session {
    let (trainer, names) = (session.trainer(), session.trainer().spec().episode_names.clone());
    let writer = RunWriter::create(folder, serde_json::Value::Null, trainer.config(), trainer.seed(), &names).unwrap();
    session.recorded_in(writer).unwrap()
}

/// Runs to the end; everything that was told, and the outcome.
fn run(mut session: Session) -> (Vec<Progress>, Outcome) {
    let mut told = Vec::new();
    loop {
        let progress = session.advance(&|| true).unwrap();
        let end = progress.end.clone();
        told.push(progress);
        if let Some(end) = end {
            return (told, session.conclude(end, &|| true).unwrap());
        }
    }
}

fn news(told: &[Progress]) -> Vec<&News> {
    told.iter().flat_map(|progress| &progress.news).collect()
}

const REACH: Goal = Goal { until: Some(0.95), steps: 3_000_000 };

fn steps(steps: u64) -> Goal {
    Goal { until: None, steps }
}

#[test]
fn a_training_stops_when_fresh_episodes_confirm_the_goal() {
    let (told, outcome) = run(session(Mishap::None, config(), REACH));
    let evaluation = outcome.evaluation.unwrap();
    assert_eq!((outcome.end, evaluation.episodes), (End::Until, 1000));
    assert!(evaluation.success.unwrap() >= 0.95 && evaluation.success_interval.unwrap()[0] > 0.93);
    let looks: Vec<u64> = told.iter().flat_map(|progress| &progress.looks).map(|look| look.episodes).collect();
    assert_eq!(looks[looks.len() - 2..], [256, 1000]);
    assert!(news(&told).is_empty());
    assert_eq!(run(session(Mishap::None, config(), REACH)).1.env_steps, outcome.env_steps, "the same seed");
}

#[test]
fn an_interrupt_ends_a_training_with_what_there_is() {
    let mut session = session(Mishap::None, config(), steps(u64::MAX));
    session.advance(&|| true).unwrap();
    let progress = session.advance(&|| false).unwrap();
    assert_eq!(progress.end, Some(End::Interrupted));
    let outcome = session.conclude(End::Interrupted, &|| false).unwrap();
    assert_eq!((outcome.updates, outcome.evaluation), (2, None));
}

#[test]
fn learning_that_runs_away_goes_back_and_still_succeeds() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("run");
    // In update 71, seven after the last state that was kept.
    let (told, outcome) = run(recorded(session(Mishap::NanAt(16 * 70 + 1), config(), steps(90 * 4096)), &folder));
    let [News::WentBack { reason, env_steps, to_env_steps, learning_rate }] = news(&told)[..] else {
        panic!("{:?}", news(&told));
    };
    let batch = config().batch_size() as u64;
    assert_eq!((*env_steps, *to_env_steps), (70 * batch, 64 * batch));
    assert!(reason.contains("NaN") && *learning_rate <= config().learning_rate_max / 4.0, "{reason} {learning_rate}");
    assert_eq!(outcome.end, End::Steps);
    assert!(outcome.evaluation.unwrap().success.unwrap() > 0.95);

    let table = std::fs::read_to_string(folder.join("metrics.csv")).unwrap();
    let steps: Vec<u64> = table.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert!(steps.windows(2).all(|pair| pair[1] == pair[0] + batch), "one row per update, none twice");
    assert_eq!(steps.last(), Some(&outcome.env_steps));
    let checkpoint = RunFolder::open(&folder).unwrap().latest_checkpoint().checkpoint.unwrap();
    assert_eq!(checkpoint.env_steps(), outcome.env_steps);
    assert!(checkpoint.config().learning_rate_max < config().learning_rate_max, "the bound stays after a resume");
}

#[test]
fn steps_far_too_long_are_shortened_until_they_fit() {
    let config = PpoConfig { kl_target: 0.0, learning_rate: 0.2, learning_rate_max: 0.2, ..config() };
    let (told, outcome) = run(session(Mishap::None, config, steps(300_000)));
    let news = news(&told);
    assert!(!news.is_empty() && outcome.end == End::Steps);
    assert!(news.iter().all(|n| matches!(n, News::WentBack { reason, .. } if reason.contains("kl_max"))), "{news:?}");
}

#[test]
fn a_training_that_nothing_heals_ends_with_the_reason() {
    let config = PpoConfig { kl_max: 1e-9, ..config() };
    let mut session = session(Mishap::None, config, REACH);
    let error = (0..10).find_map(|_| session.advance(&|| true).err()).expect("four tries are enough");
    assert!(error.to_string().contains("diverged"), "{error}");
    assert!(error.to_string().contains("5 times from the same state: the policy moved by"), "{error}");
}

#[test]
fn a_training_that_leads_nowhere_is_told_once() {
    let config = PpoConfig { policy_hidden: vec![2], value_hidden: vec![2], epochs: 1, ..config() };
    let (told, outcome) = run(session(Mishap::Unreachable, config, Goal { until: Some(0.95), steps: 8_000_000 }));
    let [News::Flat { env_steps, recent }] = news(&told)[..] else { panic!("{:?}", news(&told)) };
    assert!(*env_steps >= 6_000_000 && recent.success == 0.0, "{env_steps} {recent:?}");
    assert_eq!(outcome.end, End::Steps);
}

#[test]
fn a_lost_device_leaves_a_checkpoint_that_goes_on() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("run");
    let session = session(Mishap::LostAt(2 * 16 + 2), config(), steps(u64::MAX));
    let (_, outcome) = run(recorded(session, &folder));
    assert_eq!(outcome.end, End::DeviceLost { reason: "unplugged".into() });
    assert_eq!((outcome.updates, outcome.evaluation), (2, None));
    let path = outcome.checkpoint.unwrap();
    assert!(path.ends_with("checkpoints/step_000000008192.ckpt"), "{}", path.display());

    let latest = RunFolder::open(&folder).unwrap().latest_checkpoint().checkpoint.unwrap();
    let mut trainer = Trainer::restore(Box::new(Points::new(ENVS)), &latest).unwrap();
    trainer.update().unwrap();
    assert_eq!(trainer.updates(), 3);
}

#[test]
fn a_checkpoint_with_its_episodes_is_kept_when_the_device_is_lost() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("run");
    let (_, outcome) = run(recorded(session(Mishap::None, config(), steps(8192)), &folder));
    let path = outcome.checkpoint.unwrap();
    let written = std::fs::read(&path).unwrap();

    let whole = RunFolder::open(&folder).unwrap().latest_checkpoint().checkpoint.unwrap();
    let trainer = Trainer::restore(Box::new(Fragile::new(Mishap::LostAt(2))), &whole).unwrap();
    let names = trainer.spec().episode_names.clone();
    let writer = RunWriter::resume(&folder, trainer.env_steps(), &names).unwrap();
    let (_, outcome) = run(session_of(trainer, steps(u64::MAX)).recorded_in(writer).unwrap());
    assert!(matches!(outcome.end, End::DeviceLost { .. }));
    assert!(written == std::fs::read(&path).unwrap());
}

#[test]
fn going_back_repeats_the_training_to_the_bit() {
    let mut trainer = Trainer::new(Box::new(Points::new(ENVS)), config(), 3).unwrap();
    (0..3).for_each(|_| drop(trainer.update().unwrap()));
    let state = trainer.save();
    let first = trainer.update().unwrap();
    trainer.update().unwrap();
    trainer.go_back(&state, 1.0).unwrap();
    let again = trainer.update().unwrap();
    assert_eq!((first.learn, first.env_steps, first.entropy), (again.learn, again.env_steps, again.entropy));
    assert!(again.wall_s > first.wall_s, "time is not given back");
}

#[test]
fn a_warm_start_needs_fewer_steps() {
    let mut first = session(Mishap::None, config(), REACH);
    let cold = loop {
        if first.advance(&|| true).unwrap().end.is_some() {
            break first.trainer().save();
        }
    };
    let mut trainer = Trainer::new(Box::new(Points::new(ENVS)), config(), 2).unwrap();
    let inherited = trainer.warm_start(&cold).unwrap();
    assert_eq!((inherited.observations, inherited.actions), (6, 2));
    let place = tempfile::tempdir().unwrap();
    let session = recorded(session_of(trainer, REACH), &place.path().join("run"));
    // It could go on from here without the folder of the first.
    let written = RunFolder::open(&place.path().join("run")).unwrap().latest_checkpoint().checkpoint.unwrap();
    assert_eq!(written, session.trainer().save());
    let (_, outcome) = run(session);
    assert_eq!(outcome.end, End::Until);
    // No look before every environment has ended an episode, which takes 16,384 steps.
    assert!(4 * outcome.env_steps <= cold.env_steps(), "{} after {}", outcome.env_steps, cold.env_steps());

    let narrow = PpoConfig { policy_hidden: vec![16], ..config() };
    let mut trainer = Trainer::new(Box::new(Points::new(ENVS)), narrow, 2).unwrap();
    let error = trainer.warm_start(&cold).unwrap_err().to_string();
    assert!(error.contains("hidden layers") && error.contains("[32, 32]"), "{error}");
}
