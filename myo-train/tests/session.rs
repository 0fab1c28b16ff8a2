//! Whole trainings: they stop at their goal, heal themselves, tell what goes wrong, and start from others.

mod common;

use std::cell::Cell;
use std::path::Path;
use std::time::Duration;

use common::{Points, SUMMARY};
use myo_env::{EnvError, EnvSpec, StepBuffers, VectorEnv};
use myo_gpu::GpuError;
use myo_train::session::{End, Examiner, Goal, News, Outcome, Progress, Until};
use myo_train::{Checkpoint, PpoConfig, RunFolder, RunWriter, Session, Trainer};

const ENVS: usize = 256;

fn config() -> PpoConfig {
    PpoConfig {
        num_envs: ENVS,
        rollout_s: 0.8,
        policy_hidden: vec![32, 32],
        value_hidden: vec![32, 32],
        exploring_starts: 0.0,
        action_offset: 0.0,
        // So few samples take shorter steps: with the defaults, users of the toy differ by more than a plateau allows.
        minibatches: 4,
        kl_target: 0.02,
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
    /// No episode of the second of two layouts is said to succeed.
    SecondFails,
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
            Mishap::SecondFails => {
                episode.chunks_mut(SUMMARY).skip(1).step_by(2).for_each(|episode| episode[2..4].fill(0.0));
            }
            Mishap::Unreachable => episode.chunks_mut(SUMMARY).for_each(|episode| {
                episode[2..4].fill(0.0);
                // Nothing earned, but something spent.
                episode[SUMMARY - 2..].copy_from_slice(&[0.0, -1e-4]);
            }),
            _ => {}
        }
        Ok(())
    }
    fn set_cost_share(&mut self, share: f64) -> Result<(), EnvError> {
        self.env.set_cost_share(share)
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
    Session::new(trainer, examiner, goal).unwrap()
}

fn session(mishap: Mishap, config: PpoConfig, goal: Goal) -> Session {
    session_of(Trainer::new(Box::new(Fragile::new(mishap)), config, 1).unwrap(), goal)
}

fn recorded(session: Session, folder: &Path) -> Session {
    let trainer = session.trainer();
    let writer =
        RunWriter::create(folder, serde_json::Value::Null, trainer.config(), trainer.seed(), trainer.spec()).unwrap();
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

const REACH: Goal = Goal { until: Until::Success(0.95), steps: 3_000_000 };

fn steps(steps: u64) -> Goal {
    Goal { until: Until::Off, steps }
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

/// A training of two layouts, which do not differ unless something goes wrong in one.
fn session_of_layouts(mishap: Mishap, goal: Goal) -> Session {
    let env = || Box::new(Fragile { env: Points::new(ENVS).in_layouts(2), ..Fragile::new(mishap) });
    let trainer = Trainer::new(env(), config(), 1).unwrap();
    let examiner = Examiner::on_host(env(), trainer.seed());
    Session::new(trainer, examiner, goal).unwrap()
}

#[test]
fn a_goal_is_reached_when_it_is_in_every_layout() {
    // Half of all episodes succeed where all of one layout do.
    let goal = Goal { until: Until::Success(0.45), steps: 500_000 };
    let (told, outcome) = run(session_of_layouts(Mishap::None, goal));
    let evaluation = outcome.evaluation.unwrap();
    assert_eq!((outcome.end, evaluation.episodes, evaluation.layouts.len()), (End::Until, 2000, 2));
    assert_eq!(
        evaluation.least_success(),
        evaluation.layouts.iter().filter_map(|layout| layout.success).reduce(f64::min)
    );
    let looks: Vec<u64> = told.iter().flat_map(|progress| &progress.looks).map(|look| look.episodes).collect();
    assert_eq!(looks[looks.len() - 2..], [512, 2000], "256 and 1000 of each");

    let (told, outcome) = run(session_of_layouts(Mishap::SecondFails, goal));
    let evaluation = outcome.evaluation.unwrap();
    assert!(evaluation.success > Some(0.45), "the mean alone would have ended it: {:?}", evaluation.success);
    assert_eq!((outcome.end, evaluation.layouts[1].success), (End::Steps, Some(0.0)));
    let least = told.last().unwrap().least.unwrap();
    assert_eq!((least.layout, least.success), (1, 0.0));
    let until_the_look = told.iter().flat_map(|progress| &progress.looks).all(|look| look.least_success() == Some(0.0));
    assert!(until_the_look);
}

#[test]
fn an_interrupt_ends_a_training_with_what_there_is() {
    let mut session = session(Mishap::None, config(), steps(u64::MAX));
    session.advance(&|| true).unwrap();
    let progress = session.advance(&|| false).unwrap();
    assert_eq!(progress.end, Some(End::Interrupted));
    let outcome = session.conclude(End::Interrupted, &|| false).unwrap();
    assert_eq!((outcome.updates, outcome.evaluation), (1, None));
}

/// A training that is stopped after `asked` questions whether to go on, in the update after `before` of them; whether that
/// was in the update, and the state that it left behind.
fn interrupted(before: u64, asked: usize, folder: &Path) -> (bool, Checkpoint) {
    let mut session = recorded(session(Mishap::None, config(), steps(u64::MAX)), folder);
    (0..before).for_each(|_| drop(session.advance(&|| true).unwrap()));
    let state = session.trainer().save().unwrap().to_bytes();
    let left = Cell::new(asked);
    let go_on = || left.replace(left.get().saturating_sub(1)) > 0;
    let progress = session.advance(&go_on).unwrap();
    assert_eq!(progress.end, Some(End::Interrupted));
    let is_same = session.trainer().save().unwrap().to_bytes() == state;
    assert_eq!(is_same, progress.metrics.is_none(), "after {asked} questions");
    let outcome = session.conclude(End::Interrupted, &go_on).unwrap();
    assert_eq!(outcome.updates, before + u64::from(!is_same));
    let rows = std::fs::read_to_string(folder.join("metrics.csv")).unwrap().lines().count() as u64 - 1;
    assert_eq!(rows, outcome.updates);
    (is_same, newest(folder))
}

#[test]
fn an_interrupt_anywhere_in_an_update_leaves_the_state_before_it() {
    let place = tempfile::tempdir().unwrap();
    for before in [0, 3] {
        let stopped = |asked: usize| interrupted(before, asked, &place.path().join(format!("{before}-{asked}")));
        let points: Vec<Checkpoint> =
            (0..).map(stopped).take_while(|(is_in_update, _)| *is_in_update).map(|(_, state)| state).collect();
        // Before the update, each of its steps, the values, and each minibatch of each pass.
        assert_eq!(points.len(), 1 + 16 + 1 + config().epochs * config().minibatches);
        // As of a training that is stopped between two updates.
        let between = place.path().join(format!("{before}-between"));
        run(recorded(session(Mishap::None, config(), steps(before * 4096)), &between));
        assert!(points.iter().all(|state| *state == newest(&between)));
        // All of them are the same, so one goes on for all.
        let (whole, again) =
            (place.path().join(format!("{before}-whole")), place.path().join(format!("{before}-again")));
        let (_, outcome) = run(recorded(session(Mishap::None, config(), steps(6 * 4096)), &whole));
        let (_, resumed) = run(resumed(&points[0], steps(6 * 4096), &again));
        assert!(newest(&again) == newest(&whole) && resumed.evaluation == outcome.evaluation);
    }
}

#[test]
fn a_training_goes_on_from_an_update_that_was_ended_early_as_if_it_had_not_begun() {
    let new = || Trainer::new(Box::new(Points::new(ENVS)), config(), 3).unwrap();
    let (mut trainer, mut undisturbed) = (new(), new());
    for asked in 0..26 {
        let left: Cell<usize> = Cell::new(asked);
        let updated = trainer.update_while(&|| left.replace(left.get().saturating_sub(1)) > 0).unwrap();
        assert!(updated.is_none(), "after {asked} questions");
    }
    let (again, first) = (trainer.update_while(&|| true).unwrap().unwrap(), undisturbed.update().unwrap());
    assert_eq!((again.learn, again.env_steps, again.entropy), (first.learn, first.env_steps, first.entropy));
    let state = |trainer: &Trainer| {
        let mut state = trainer.save().unwrap();
        state.forget_wall_time();
        state.to_bytes()
    };
    assert!(state(&trainer) == state(&undisturbed));
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
    let batch = config().batch_size(0.05) as u64;
    assert_eq!((*env_steps, *to_env_steps), (70 * batch, 64 * batch));
    assert!(reason.contains("NaN") && *learning_rate <= config().learning_rate_max / 4.0, "{reason} {learning_rate}");
    assert_eq!(outcome.end, End::Steps);
    assert!(outcome.evaluation.unwrap().success.unwrap() > 0.95);

    let table = std::fs::read_to_string(folder.join("metrics.csv")).unwrap();
    let steps: Vec<u64> = table.lines().skip(1).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert!(steps.windows(2).all(|pair| pair[1] == pair[0] + batch), "one row per update, none twice");
    assert_eq!(steps.last(), Some(&outcome.env_steps));
    let checkpoint = RunFolder::open(&folder).unwrap().latest_checkpoint().unwrap().checkpoint.unwrap();
    assert_eq!(checkpoint.env_steps(), outcome.env_steps);
    assert!(checkpoint.config().learning_rate_max < config().learning_rate_max, "the bound stays after a resume");
}

#[test]
fn steps_become_longer_again_when_all_goes_well() {
    let place = tempfile::tempdir().unwrap();
    let allowed = |updates: u64| {
        let folder = place.path().join(updates.to_string());
        run(recorded(session(Mishap::NanAt(16 * 70 + 1), config(), steps(updates * 4096)), &folder));
        let checkpoint = RunFolder::open(&folder).unwrap().latest_checkpoint().unwrap().checkpoint.unwrap();
        checkpoint.config().learning_rate_max / config().learning_rate_max
    };
    // It goes back from 70 updates to 64; every 64 updates a state is kept as a good one.
    assert_eq!([100, 150, 200, 300].map(allowed), [0.25, 0.5, 1.0, 1.0]);
}

#[test]
fn steps_far_too_long_are_shortened_until_they_fit() {
    let config = PpoConfig { kl_target: 0.0, learning_rate: 0.2, learning_rate_max: 0.2, ..config() };
    let (told, outcome) = run(session(Mishap::None, config, steps(300_000)));
    let news = news(&told);
    assert!(!news.is_empty() && outcome.end == End::Steps);
    assert!(news.iter().all(|n| matches!(n, News::WentBack { reason, .. } if reason.contains("kl_max"))), "{news:?}");
    let rates: Vec<f64> =
        told.iter().filter_map(|progress| progress.metrics.as_ref()).map(|m| m.learning_rate).collect();
    assert!(rates.is_sorted_by(|a, b| a >= b) && rates.last().is_some_and(|&rate| rate < 0.2), "{rates:?}");
    assert!(told[told.len() - 10..].iter().all(|progress| progress.news.is_empty()), "they fit in the end");
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
    let (told, outcome) =
        run(session(Mishap::Unreachable, config, Goal { until: Until::Success(0.95), steps: 8_000_000 }));
    let [News::Flat { env_steps, layout: None, recent }] = news(&told)[..] else { panic!("{:?}", news(&told)) };
    assert!(*env_steps >= 6_000_000 && recent.success == 0.0, "{env_steps} {recent:?}");
    assert_eq!(outcome.end, End::Steps);
}

/// The newest checkpoint of a run, without the time that it took.
fn newest(folder: &Path) -> Checkpoint {
    let mut checkpoint = RunFolder::open(folder).unwrap().latest_checkpoint().unwrap().checkpoint.unwrap();
    checkpoint.forget_wall_time();
    checkpoint
}

/// Goes on from a checkpoint, recorded in another folder.
fn resumed(checkpoint: &Checkpoint, goal: Goal, folder: &Path) -> Session {
    resumed_with(examiner(Mishap::None), checkpoint, goal, folder)
}

fn resumed_with(examiner: Examiner, checkpoint: &Checkpoint, goal: Goal, folder: &Path) -> Session {
    let trainer = Trainer::restore(Box::new(Fragile::new(Mishap::None)), checkpoint).unwrap();
    recorded(Session::resume(trainer, examiner, goal, checkpoint).unwrap(), folder)
}

/// Looks in episodes in which this goes wrong.
fn examiner(mishap: Mishap) -> Examiner {
    Examiner::on_host(Box::new(Fragile::new(mishap)), 1)
}

/// Stops a training after each of its updates in turn, or rather each `stride`-th, goes on, and compares the ends. `looks` is
/// what goes wrong in looks.
fn check_that_no_stop_is_seen(config: PpoConfig, goal: Goal, stride: usize, looks: Mishap) -> Vec<Progress> {
    let place = tempfile::tempdir().unwrap();
    let whole = place.path().join("whole");
    let trainer = Trainer::new(Box::new(Fragile::new(Mishap::None)), config, 1).unwrap();
    let session = Session::new(trainer, examiner(looks), goal).unwrap();
    let mut session = recorded(session, &whole).checkpoint_every(Duration::ZERO);
    let (mut told, mut states) = (Vec::new(), Vec::new());
    let outcome = loop {
        let progress = session.advance(&|| true).unwrap();
        states.push(newest(&whole).to_bytes());
        told.push(progress);
        if let Some(end) = told.last().unwrap().end.clone() {
            break session.conclude(end, &|| true).unwrap();
        }
    };
    let end = newest(&whole).to_bytes();
    for (index, state) in states.iter().enumerate().step_by(stride) {
        let folder = place.path().join(format!("stopped-{index}"));
        let (_, again) = run(resumed_with(examiner(looks), &Checkpoint::from_bytes(state).unwrap(), goal, &folder));
        assert_eq!((again.end, again.env_steps), (outcome.end.clone(), outcome.env_steps), "after {index}");
        assert_eq!(again.evaluation, outcome.evaluation, "after {index}");
        assert!(newest(&folder).to_bytes() == end, "after {index}");
    }
    told
}

#[test]
fn a_training_with_a_goal_that_was_stopped_ends_as_one_left_alone() {
    let goal = |steps| Goal { until: Until::Success(0.9), steps };
    let told = check_that_no_stop_is_seen(config(), goal(3_000_000), 9, Mishap::None);
    assert_eq!(told.last().unwrap().end, Some(End::Until));
    // Looks in vain, too.
    let told = check_that_no_stop_is_seen(config(), goal(400_000), 19, Mishap::Unreachable);
    assert!(told.iter().filter(|progress| !progress.looks.is_empty()).count() > 1);
}

#[test]
fn a_training_to_its_plateau_ends_when_more_of_it_brings_nothing() {
    for seed in 1..=3 {
        let train = |goal| {
            let trainer = Trainer::new(Box::new(Points::new(ENVS)), config(), seed).unwrap();
            run(session_of(trainer, goal))
        };
        let (told, outcome) = train(Goal { until: Until::Plateau, steps: 40_000_000 });
        assert_eq!((&outcome.end, outcome.trend.unwrap().is_plateau()), (&End::Plateau, true));
        assert!(told[..told.len() - 1].iter().all(|progress| progress.end.is_none()), "it ends at once");
        // Of training episodes: the mean actions of so small a toy are better and worse by turns.
        let (later, _) = train(steps(4 * outcome.env_steps));
        let (then, now) = (last_length(&later), last_length(&told));
        assert!((then / now - 1.0).abs() < 0.03, "{now} control steps, {then} later");
    }
}

/// The share of the costs that counted in each update.
fn cost_shares(told: &[Progress]) -> Vec<f64> {
    told.iter().filter_map(|progress| Some(progress.metrics.as_ref()?.cost_share)).collect()
}

#[test]
fn movement_costs_what_the_user_can_afford() {
    let of = |mishap, cost_ramp_s, control_steps| {
        let config = PpoConfig { cost_ramp_s, ..config() };
        cost_shares(&run(session(mishap, config, steps(control_steps))).0)
    };
    let shares = of(Mishap::None, 10_000.0, 1_000_000);
    assert!(shares[0] < 3e-4, "next to nothing");
    assert_eq!(shares[shares.len() - 1], 1.0, "who earns more pays for it: {shares:?}");
    // Unless nothing improves with less, which in the first quarter nobody can know, the share grows by the same factor in the same time,
    // from a 4096th to all of it in 50,000 s.
    let slowly = of(Mishap::None, 50_000.0, 1_000_000);
    let at = |share: f64| slowly[(share * slowly.len() as f64) as usize];
    let quarter = (1.0_f64 / 4096.0).powf(0.75);
    assert!(at(0.25) < 1.01 * quarter && at(0.25) > 0.5 * quarter, "no faster than that: {slowly:?}");

    let shares = of(Mishap::Unreachable, 5_000.0, 200_000);
    assert!(shares.iter().all(|&share| share < 3e-4), "who earns nothing pays next to nothing: {shares:?}");
    assert!(of(Mishap::Unreachable, 0.0, 200_000).iter().all(|&share| share == 1.0));
}

/// Mean length of the episodes in the last tenth of a training.
fn last_length(told: &[Progress]) -> f64 {
    let metrics = told[told.len() - told.len() / 10..].iter().filter_map(|progress| progress.metrics.as_ref());
    let (mut sum, mut episodes) = (0.0, 0.0);
    for (length, count) in metrics.filter_map(|m| Some((m.episodes.mean("length")?, m.episodes.count as f64))) {
        sum += count * length;
        episodes += count;
    }
    sum / episodes
}

#[test]
fn a_training_to_its_plateau_that_was_stopped_ends_as_one_left_alone() {
    let told =
        check_that_no_stop_is_seen(config(), Goal { until: Until::Plateau, steps: 40_000_000 }, 97, Mishap::None);
    assert_eq!(told.last().unwrap().end, Some(End::Plateau));
}

#[test]
fn the_evaluation_that_is_reported_had_no_say_in_when_to_stop() {
    let (told, outcome) = run(session(Mishap::None, config(), REACH));
    let evaluation = outcome.evaluation.unwrap();
    let looks: Vec<_> = told.iter().flat_map(|progress| &progress.looks).collect();
    assert!(looks.len() >= 2 && looks.last().unwrap().episodes == evaluation.episodes);
    assert!(looks.iter().all(|look| **look != evaluation), "{looks:?}");
}

#[test]
fn a_training_that_ran_away_and_was_stopped_ends_as_one_left_alone() {
    let config = PpoConfig { kl_target: 0.0, learning_rate: 0.2, learning_rate_max: 0.2, ..config() };
    let told = check_that_no_stop_is_seen(config, steps(90 * 4096), 19, Mishap::None);
    assert!(!news(&told).is_empty());
}

#[test]
fn a_look_that_was_cut_off_is_taken_when_the_training_goes_on() {
    let place = tempfile::tempdir().unwrap();
    let goal = Goal { until: Until::Success(0.9), steps: 3_000_000 };
    let (told, outcome) = run(session(Mishap::None, config(), goal));
    let first_look = told.iter().position(|progress| !progress.looks.is_empty()).unwrap();
    // As Ctrl-C in the middle of the first look.
    let mut session = recorded(session(Mishap::None, config(), goal), &place.path().join("stopped"));
    let (asked, limit) = (Cell::new(0), Cell::new(usize::MAX));
    let go_on = || asked.replace(asked.get() + 1) < limit.get();
    for _ in 0..first_look {
        asked.set(0);
        session.advance(&go_on).unwrap();
    }
    // As often as without a look, and twice more.
    limit.set(asked.replace(0) + 2);
    let progress = session.advance(&go_on).unwrap();
    assert_eq!((progress.end, progress.metrics.is_some()), (Some(End::Interrupted), true));
    session.conclude(End::Interrupted, &go_on).unwrap();

    let mut session = resumed(&newest(&place.path().join("stopped")), goal, &place.path().join("again"));
    let progress = session.advance(&|| true).unwrap();
    assert_eq!((&progress.metrics, &progress.looks), (&None, &told[first_look].looks));
    let again = run(session).1;
    assert_eq!((again.env_steps, again.evaluation), (outcome.env_steps, outcome.evaluation));
}

#[test]
fn a_training_that_is_over_is_left_as_it_is_and_its_evaluation_made_again() {
    let place = tempfile::tempdir().unwrap();
    for (name, goal) in [("steps", steps(8192)), ("until", Goal { until: Until::Success(0.9), steps: 3_000_000 })] {
        let (whole, again) = (place.path().join(name), place.path().join(format!("{name}-again")));
        let (_, outcome) = run(recorded(session(Mishap::None, config(), goal), &whole));
        // As one killed before it could evaluate.
        let (told, made_up) = run(resumed(&newest(&whole), goal, &again));
        assert_eq!((told.len(), &told[0].metrics), (1, &None));
        assert_eq!((made_up.end, made_up.env_steps), (outcome.end, outcome.env_steps));
        assert!(made_up.evaluation.is_some());
        assert_eq!(made_up.evaluation, outcome.evaluation);
        let evaluation = |folder: &Path| std::fs::read(folder.join("evaluation.json")).unwrap();
        assert_eq!(evaluation(&again), evaluation(&whole));
    }
}

#[test]
fn a_goal_that_was_reached_and_is_higher_now_is_sought_again() {
    let place = tempfile::tempdir().unwrap();
    let goal = |until| Goal { until, steps: 3_000_000 };
    let (told, _) =
        run(recorded(session(Mishap::None, config(), goal(Until::Success(0.5))), &place.path().join("low")));
    // What confirmed the goal, not what was reported.
    let success = told.last().unwrap().looks.last().unwrap().success.unwrap();
    let over =
        |until, name: &str| resumed(&newest(&place.path().join("low")), goal(until), &place.path().join(name)).over();
    assert_eq!(over(Until::Success(success), "same"), Some(End::Until));
    assert_eq!((over(Until::Success(0.999), "higher"), over(Until::Off, "off")), (None, None));
}

#[test]
fn a_lost_device_leaves_the_newest_checkpoint_as_it_is() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("run");
    let fragile = recorded(session(Mishap::LostAt(2 * 16 + 2), config(), steps(u64::MAX)), &folder);
    let (_, outcome) = run(fragile.checkpoint_every(Duration::ZERO));
    assert_eq!(outcome.end, End::DeviceLost { reason: "unplugged".into() });
    assert_eq!((outcome.updates, outcome.evaluation), (2, None));
    let path = outcome.checkpoint.unwrap();
    assert!(path.ends_with("checkpoints/step_000000008192.ckpt"), "{}", path.display());
    // It holds the episodes: the training goes on as if nothing had been lost.
    let (_, again) = run(resumed(&newest(&folder), steps(16_384), &place.path().join("again")));
    let whole = place.path().join("whole");
    assert_eq!(again.evaluation, run(recorded(session(Mishap::None, config(), steps(16_384)), &whole)).1.evaluation);
    assert!(newest(&whole) == newest(&place.path().join("again")));

    // A loss right after the training went back to the state of that checkpoint.
    let written = std::fs::read(&path).unwrap();
    let gone_back = resumed(&newest(&folder), steps(u64::MAX), &place.path().join("lost"));
    gone_back.conclude(End::DeviceLost { reason: "unplugged".into() }, &|| true).unwrap();
    assert!(written == std::fs::read(&path).unwrap());
}

#[test]
fn a_loss_before_the_first_checkpoint_leaves_none() {
    let place = tempfile::tempdir().unwrap();
    let session = recorded(session(Mishap::LostAt(3), config(), steps(u64::MAX)), &place.path().join("run"));
    let (_, outcome) = run(session);
    assert!(matches!(outcome.end, End::DeviceLost { .. }) && outcome.checkpoint.is_none());
    assert!(RunFolder::open(&place.path().join("run")).unwrap().checkpoints().unwrap().is_empty());
}

#[test]
fn a_training_that_failed_leaves_no_checkpoint_of_what_ran_away() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("run");
    let mut session = recorded(session(Mishap::None, PpoConfig { kl_max: 1e-9, ..config() }, REACH), &folder);
    let failed = (0..10).any(|_| session.advance(&|| true).is_err());
    let outcome = session.conclude(End::Interrupted, &|| true).unwrap();
    assert!(failed && outcome.evaluation.is_none());
    assert_eq!(newest(&folder).updates(), 0, "the state that it went back to");
}

#[test]
fn going_back_repeats_the_training_to_the_bit() {
    let mut trainer = Trainer::new(Box::new(Points::new(ENVS)), config(), 3).unwrap();
    let bits = |trainer: &Trainer| {
        let mut checkpoint = trainer.save().unwrap();
        checkpoint.forget_wall_time();
        checkpoint.to_bytes()
    };
    (0..3).for_each(|_| drop(trainer.update().unwrap()));
    let state = trainer.save().unwrap();
    let first = trainer.update().unwrap();
    let expected = bits(&trainer);
    trainer.update().unwrap();
    assert!(bits(&trainer) != expected);
    trainer.go_back(&state, 1.0).unwrap();
    let again = trainer.update().unwrap();
    assert_eq!((first.learn, first.env_steps, first.entropy), (again.learn, again.env_steps, again.entropy));
    assert!(bits(&trainer) == expected);
    assert!(again.wall_s > first.wall_s, "time is not given back");
}

#[test]
fn a_warm_start_needs_fewer_steps() {
    let mut first = session(Mishap::None, config(), REACH);
    let cold = loop {
        if first.advance(&|| true).unwrap().end.is_some() {
            break first.trainer().save().unwrap();
        }
    };
    let mut trainer = Trainer::new(Box::new(Points::new(ENVS)), config(), 2).unwrap();
    let inherited = trainer.warm_start(&cold).unwrap();
    assert_eq!((inherited.observations, inherited.actions), (6, 2));
    let place = tempfile::tempdir().unwrap();
    let session = recorded(session_of(trainer, REACH), &place.path().join("run"));
    // It could go on from here without the folder of the first.
    let written = RunFolder::open(&place.path().join("run")).unwrap().latest_checkpoint().unwrap().checkpoint.unwrap();
    let again = Trainer::restore(Box::new(Points::new(ENVS)), &written).unwrap();
    assert_eq!(again.save().unwrap(), session.trainer().save().unwrap());
    let (_, outcome) = run(session);
    assert_eq!(outcome.end, End::Until);
    // No look before every environment has ended an episode, which takes 16,384 steps.
    assert!(3 * outcome.env_steps <= cold.env_steps(), "{} after {}", outcome.env_steps, cold.env_steps());

    let narrow = PpoConfig { policy_hidden: vec![16], ..config() };
    let mut trainer = Trainer::new(Box::new(Points::new(ENVS)), narrow, 2).unwrap();
    let error = trainer.warm_start(&cold).unwrap_err().to_string();
    assert!(error.contains("hidden layers") && error.contains("[32, 32]"), "{error}");
}
