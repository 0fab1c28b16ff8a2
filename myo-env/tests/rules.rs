//! Rules of one's own: when they are asked, what they see, and what becomes of what they say.

use crate::common::{actions, arm, column, entry, gpu, rollout, without_gpu};
use myo_env::{
    Autoreset, CpuEnv, Env, EnvConfig, EnvError, GpuEnv, Moment, RULES_COLUMNS, ReferenceEnv, Rules, Skeleton,
    StepStorage, Tables, VectorEnv, Verdict,
};
use myo_model::Model;
use myo_scalar::Scalar;
use myo_tasks::Task;

/// Observes what there is to see, and ends episodes by the clock.
#[derive(Clone, Debug)]
struct Probe {
    name: &'static str,
    /// Names of the first numbers in place of the right ones.
    first_names: &'static [&'static str],
    /// When (s) an episode is done, and when it is failed.
    done_at: f64,
    failed_at: f64,
}

const PROBE: Probe = Probe { name: "probe", first_names: &["calls"], done_at: 9.0, failed_at: 9.0 };

/// What a probe observes behind how often it was asked.
const SEEN: [&str; 13] =
    ["time", "effort", "tip_x", "tip_y", "tip_z", "vx", "vy", "vz", "ball_x", "ball_y", "ball_z", "ball_radius", "arm"];

impl Rules for Probe {
    fn name(&self) -> &str {
        self.name
    }
    fn observed(&self) -> Vec<String> {
        self.first_names.iter().chain(&SEEN).map(ToString::to_string).collect()
    }
    fn remembered(&self) -> usize {
        1
    }
    #[inline(always)]
    fn step<S: Scalar>(&self, now: &Moment<'_, S>, memory: &mut [S], observation: &mut Vec<S>) -> Verdict<S> {
        memory[0] += S::lit(1.0);
        observation.extend([memory[0], now.time, now.effort()]);
        observation.extend(now.fingertip);
        observation.extend(now.fingertip_velocity);
        let ball = &now.spheres[now.spheres.len() - 1];
        observation.extend(ball.centre);
        observation.push(ball.radius);
        // From wrist to elbow.
        let arm = now.elbow.zip(now.wrist).map(|(elbow, wrist)| [0, 1, 2].map(|k| (elbow[k] - wrist[k]).sq()));
        observation.push(arm.map_or(S::zero(), |[x, y, z]| (x + y + z).sqrt()));
        let done = S::lit(self.done_at - 1e-3).lt(now.time);
        let failed = S::lit(self.failed_at - 1e-3).lt(now.time);
        Verdict { reward: memory[0] * S::lit(0.5), done, failed }
    }
}

/// A table, and a ball on its way above it.
fn task() -> Task {
    let text = "version: 2\nuser: fastest\nmodel: mobl-arms\nname: probed\nscene:\n  table: {kind: obstacle, at: [0.3, 0, -0.5], size: [0.6, 0.6, 0.02]}\n  \
                ball: {kind: sphere, at: [0.4, [-0.1, 0.1], 0], radius: [0.1, 0.2], moves: {kind: circle, diameter: 0.2, period_s: 3}}\n\
                script:\n  - dwell: {in: ball, for_s: 0.1}\ntime_limit_s: 0.5\n";
    Task { script: vec![], ..Task::from_yaml(text, "probed").unwrap() }
}

fn model() -> Model {
    arm(&task())
}

fn config(num_envs: usize) -> EnvConfig {
    EnvConfig { num_envs, seed: 5, ..EnvConfig::default() }
}

/// The same environments in every evaluator that there is.
fn everywhere(rules: &Probe, config: &EnvConfig) -> Vec<Box<dyn VectorEnv>> {
    let (model, task) = (model(), task());
    let mut envs: Vec<Box<dyn VectorEnv>> = vec![
        Box::new(ReferenceEnv::with_rules(&model, &task, rules, config).unwrap()),
        Box::new(CpuEnv::with_rules(&model, &task, rules, config).unwrap()),
    ];
    if !without_gpu() {
        envs.push(Box::new(GpuEnv::with_rules(&gpu(), &model, &task, rules, config).unwrap()));
    }
    envs
}

fn observed(env: &dyn VectorEnv, observation: &[f32], name: &str) -> Vec<f32> {
    let (nobs, at) = (env.spec().observation_size(), entry(env, name));
    observation.chunks_exact(nobs).map(|row| row[at]).collect()
}

#[test]
fn they_are_asked_at_the_beginning_and_after_every_control_step_and_forget_with_the_episode() {
    for env in &mut everywhere(&PROBE, &config(5)) {
        let mut first = vec![0.0; 5 * env.spec().observation_size()];
        env.reset(Some(5), None, &mut first).unwrap();
        assert_eq!(observed(env.as_ref(), &first, "calls"), [1.0; 5]);
        assert_eq!(observed(env.as_ref(), &first, "effort"), [0.0; 5]);
        // Ten control steps end an episode of half a second.
        let runs = rollout(env.as_mut(), 13);
        for (step, out) in (1..).zip(&runs) {
            let calls = (step % 10 + 1) as f32;
            assert_eq!(observed(env.as_ref(), &out.observation, "calls"), [calls; 5], "step {step}");
            let time = observed(env.as_ref(), &out.observation, "time");
            assert!(time.iter().all(|time| (time - 0.05 * (calls - 1.0)).abs() < 1e-6), "step {step}: {time:?}");
            assert_eq!(out.reward, [if step == 10 { 5.5 } else { 0.5 * calls }; 5], "step {step}");
            assert_eq!(out.truncated, [step == 10; 5]);
        }
        let last = observed(env.as_ref(), &runs[9].final_observation, "calls");
        assert_eq!(last, [11.0; 5], "the last observation is kept");
    }
}

/// An observation that is asked for anew is the one there was, also where others begin an episode.
#[test]
fn others_that_begin_anew_are_not_noticed() {
    for env in &mut everywhere(&PROBE, &config(5)) {
        let before = rollout(env.as_mut(), 3).pop().unwrap().observation;
        let mut again = vec![0.0; before.len()];
        env.reset(None, Some(&[false; 5]), &mut again).unwrap();
        assert_eq!(observed(env.as_ref(), &again, "calls"), [4.0; 5]);
        assert_eq!(observed(env.as_ref(), &again, "effort"), observed(env.as_ref(), &before, "effort"));
        env.reset(None, Some(&[false, true, false, false, true]), &mut again).unwrap();
        assert_eq!(observed(env.as_ref(), &again, "calls"), [4.0, 1.0, 4.0, 4.0, 1.0]);
        let remembered = env.peek(0..5).unwrap().into_iter().flat_map(|moment| moment.remembered);
        assert_eq!(remembered.collect::<Vec<_>>(), [4.0, 1.0, 4.0, 4.0, 1.0]);
    }
}

#[test]
fn done_failed_and_timed_out_are_told_apart() {
    let names = RULES_COLUMNS.map(|column| column.name);
    for (done_at, failed_at, length, [success, failed]) in
        [(0.2, 9.0, 4, [1.0, 0.0]), (9.0, 0.15, 3, [0.0, 1.0]), (0.2, 0.2, 4, [0.0, 1.0]), (9.0, 9.0, 10, [0.0, 0.0])]
    {
        for env in &mut everywhere(&Probe { done_at, failed_at, ..PROBE }, &config(3)) {
            assert_eq!(env.spec().episode_names, names);
            let runs = rollout(env.as_mut(), length);
            let (last, before) = runs.split_last().unwrap();
            assert!(before.iter().all(|out| !out.terminated[0] && !out.truncated[0]));
            assert_eq!((last.terminated[0], last.truncated[0]), (success + failed > 0.5, success + failed < 0.5));
            let summary = |name: &str| last.episode[column(env.as_ref(), name)];
            assert_eq!([summary("success"), summary("failed"), summary("length")], [success, failed, length as f32]);
            let reward: f32 = runs.iter().map(|out| out.reward[0]).sum();
            assert!((summary("return") - reward).abs() < 1e-4);
            // What is observed of the effort is that of the control step alone.
            let efforts = before.iter().map(|out| &out.observation).chain([&last.final_observation]);
            let efforts: f32 = efforts.map(|row| observed(env.as_ref(), row, "effort")[0]).sum();
            assert!((summary("effort") - efforts / length as f32).abs() < 1e-5);
        }
    }
}

#[test]
fn they_see_what_a_viewer_sees() {
    let skeleton = Skeleton::without_script(&model(), &task()).unwrap();
    let forearm = |moment: &myo_env::SkeletonPose| {
        let [elbow, wrist] = [skeleton.model().elbow_body, skeleton.model().wrist_body]
            .map(|body| moment.bodies[body.unwrap()].position);
        (elbow - wrist).array().iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    for env in &mut everywhere(&PROBE, &config(4)) {
        let out = rollout(env.as_mut(), 4).pop().unwrap();
        for (k, moment) in env.peek(0..4).unwrap().iter().enumerate() {
            let (pose, see) =
                (skeleton.pose(moment).unwrap(), |name| observed(env.as_ref(), &out.observation, name)[k]);
            let ball = &pose.objects[1];
            let shown = [pose.fingertip, ball.frame.position.array()].concat();
            let seen = ["tip_x", "tip_y", "tip_z", "ball_x", "ball_y", "ball_z"].map(see);
            for (seen, shown) in
                seen.iter().zip(shown).chain([(&see("ball_radius"), ball.half_size[0]), (&see("arm"), forearm(&pose))])
            {
                assert!((f64::from(*seen) - shown).abs() < 1e-5, "{seen} for {shown}");
            }
            assert_eq!(pose.pointer, pose.fingertip);
            assert_eq!((pose.step, pose.current), (None, None));
        }
    }
}

/// A little later and a little earlier, by the joints' own velocities.
#[test]
fn the_velocity_of_the_fingertip_is_the_rate_of_its_place() {
    let (skeleton, h) = (Skeleton::without_script(&model(), &task()).unwrap(), 1e-4);
    let mut fastest = 0.0_f64;
    for env in &mut everywhere(&PROBE, &config(8)) {
        let out = rollout(env.as_mut(), 4).pop().unwrap();
        for (k, moment) in env.peek(0..8).unwrap().iter().enumerate() {
            let place = |after: f64| {
                let mut moment = moment.clone();
                moment.body.qpos.iter_mut().zip(&moment.body.qvel).for_each(|(q, v)| *q += after * v);
                skeleton.pose(&moment).unwrap().fingertip
            };
            let (before, after) = (place(-h), place(h));
            for (axis, name) in ["vx", "vy", "vz"].into_iter().enumerate() {
                let rate = (after[axis] - before[axis]) / (2.0 * h);
                let said = f64::from(observed(env.as_ref(), &out.observation, name)[k]);
                assert!((said - rate).abs() < 1e-4 * (1.0 + rate.abs()), "{said} m/s for {rate}");
                fastest = fastest.max(rate.abs());
            }
        }
    }
    assert!(fastest > 0.3, "{fastest} m/s is too slow to tell");
}

#[test]
fn saved_states_go_on_under_the_same_rules_alone() {
    for env in &mut everywhere(&PROBE, &config(5)) {
        rollout(env.as_mut(), 3);
        let saved = env.save_state().unwrap();
        let went_on = rollout(env.as_mut(), 9);
        env.load_state(&saved).unwrap();
        for (a, b) in went_on.iter().zip(rollout(env.as_mut(), 9)) {
            assert!(a.observation == b.observation && a.reward == b.reward && a.truncated == b.truncated);
        }
        let refusal = |rules: &Probe| {
            let mut other = CpuEnv::with_rules(&model(), &task(), rules, &config(5)).unwrap();
            other.load_state(&saved).unwrap_err().to_string()
        };
        let other = refusal(&Probe { name: "other", ..PROBE });
        assert!(
            other.contains("is of the task `probed, rules probe`, this environment does `probed, rules other`"),
            "{other}"
        );
        let changed = refusal(&Probe { done_at: 0.3, ..PROBE });
        assert!(changed.contains("another version of the task `probed, rules probe`"), "{changed}");
        let mut script = CpuEnv::new(&model(), &crate::common::short("pointing-uitb"), &config(5)).unwrap();
        assert!(script.load_state(&saved).is_err());
    }
}

#[test]
fn numbers_of_the_task_are_exchanged_under_rules_too() {
    let mut longer = task();
    longer.time_limit_s = 0.7;
    crate::common::sphere(&mut longer, "ball").radius = myo_tasks::Range::new(0.3, 0.3);
    for env in &mut everywhere(&PROBE, &config(3)) {
        env.set_task(&longer).unwrap();
        assert_eq!(env.spec().max_episode_steps, 14);
        let mut first = vec![0.0; 3 * env.spec().observation_size()];
        env.reset(None, None, &mut first).unwrap();
        assert!(observed(env.as_ref(), &first, "ball_radius").iter().all(|radius| (radius - 0.3).abs() < 1e-6));
        assert!(rollout(env.as_mut(), 14).pop().unwrap().truncated[0]);
        let other = Task { scene: crate::common::short("pointing-uitb").scene, ..task() };
        let refusal = env.set_task(&other).unwrap_err();
        assert!(matches!(&refusal, EnvError::OtherTask { what } if what.contains("spheres instead of 1")), "{refusal}");
    }
}

#[test]
fn rules_that_contradict_themselves_and_what_they_cannot_judge_are_refused_by_name() {
    let (model, task) = (model(), task());
    let refusal = |task: &Task, rules: &Probe, config: &EnvConfig| {
        CpuEnv::with_rules(&model, task, rules, config).err().expect("it is wrong").to_string()
    };
    let two = refusal(&task, &Probe { first_names: &["calls", "more"], ..PROBE }, &config(2));
    assert_eq!(two, "the rules `probe` observe 14 numbers and name 15 in `observed`");
    let same = refusal(&task, &Probe { first_names: &["vx"], ..PROBE }, &config(2));
    assert_eq!(same, "the rules `probe` observe `vx`, a name that another number has; names must differ");
    let known = refusal(&task, &Probe { first_names: &["time_left"], ..PROBE }, &config(2));
    assert!(known.contains("observe `time_left`, a name that another number has"), "{known}");
    let nameless = refusal(&task, &Probe { first_names: &[" "], ..PROBE }, &config(2));
    assert!(nameless.contains("a number without a name"), "{nameless}");
    let exploring = refusal(&task, &PROBE, &EnvConfig { exploring: 1, ..config(2) });
    assert!(
        exploring.contains("set `exploring` to 0, in the settings of a training `exploring_starts`"),
        "{exploring}"
    );
    let ray = Task { technique: myo_tasks::preset("wall-ray").unwrap().technique, ..task.clone() };
    let ray = refusal(&ray, &PROBE, &config(2));
    assert!(ray.contains("the technique is a ray, by which only steps of a script go"), "{ray}");
    assert!(CpuEnv::new(&model, &task, &config(2)).is_err(), "without rules there must be a script");
}

/// A script, its targets and its reward are as if they were not there.
#[test]
fn rules_stand_in_the_place_of_a_script() {
    let mut with_script = task();
    with_script.script = crate::common::short("pointing-single").script;
    let text = serde_json::to_string(&with_script.script).unwrap();
    assert!(text.contains("dwell"), "{text}");
    let [mut with, mut without] =
        [&with_script, &task()].map(|task| CpuEnv::with_rules(&model(), task, &PROBE, &config(3)).unwrap());
    assert_eq!(with.spec(), without.spec());
    assert!(with.spec().observation_names.iter().all(|name| !name.starts_with("target")));
    for (a, b) in rollout(&mut with, 12).iter().zip(rollout(&mut without, 12)) {
        assert!(a.observation == b.observation && a.reward == b.reward);
    }
}

#[test]
fn one_environment_and_more_of_the_same_kind_have_them_too() {
    let mut one = Env::with_rules(&model(), &task(), &PROBE, 5).unwrap();
    let relaxed = vec![-1.0; one.spec().action_size()];
    assert_eq!(one.step(&relaxed).unwrap().reward, 1.0);
    assert_eq!(one.peek().remembered, [2.0]);

    let many = CpuEnv::with_rules(&model(), &task(), &PROBE, &config(3)).unwrap();
    let mut more = many.sibling(&EnvConfig { seed: 6, ..config(7) }).unwrap();
    let mut made = CpuEnv::with_rules(&model(), &task(), &PROBE, &EnvConfig { seed: 6, ..config(7) }).unwrap();
    let (actions, mut got) = (actions(&more, 0), StepStorage::new(more.spec()));
    let mut want = got.clone();
    more.step(&actions, got.buffers()).unwrap();
    made.step(&actions, want.buffers()).unwrap();
    assert!(got.observation == want.observation && got.reward == want.reward);
    assert!(many.sibling(&EnvConfig { exploring: 1, ..config(2) }).is_err());
    let disabled = EnvConfig { autoreset: Autoreset::Disabled, ..config(2) };
    let many = CpuEnv::with_rules(&model(), &task(), &PROBE, &disabled).unwrap();
    assert_eq!(many.sibling(&config(3)).unwrap().spec().autoreset, Autoreset::Disabled);
}

/// Snapshots of saved states are read with the tables of the environments.
#[test]
fn saved_states_are_looked_into_with_their_tables() {
    let mut env = ReferenceEnv::with_rules(&model(), &task(), &PROBE, &config(3)).unwrap();
    rollout(&mut env, 2);
    let saved = env.save_state().unwrap();
    let moment = myo_env::Snapshot::read(env.tables(), &saved, 1).unwrap();
    assert_eq!(moment.remembered, [3.0]);
    let others = Tables::<f64>::exact(&model(), &crate::common::short("pointing-uitb")).unwrap();
    assert!(myo_env::Snapshot::read(&others, &saved, 1).is_err());
}
