//! Looking on while a user learns: beside the training a user of the present policy does the task in real time, in an environment of its
//! own, so that what is watched costs the training nothing but a copy of the policy now and then.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use myo_model::Model;
use myo_tasks::Task;
use myo_train::Policy;

use super::actor::Actor;
use super::hub::Hub;
use crate::protocol::{MotionHeader, Refusal};

/// So much movement (s) is sent at once: what is seen is late by as much.
const PIECE_S: f64 = 0.25;
/// The policy is copied at most so often.
const RENEW_EVERY: Duration = Duration::from_millis(200);
/// After a copy at least so many times as long as it took passes before the next: looking on costs a training next to nothing, whatever
/// the copy costs.
const REST: u32 = 100;

/// What is being watched.
#[derive(Default)]
pub struct Stage {
    scene: Mutex<Scene>,
    bell: Condvar,
}

#[derive(Default)]
struct Scene {
    /// The training that is asked for.
    wanted: Option<u32>,
    /// The training that is under way, or was last, and what it does.
    job: Option<u32>,
    play: Option<Arc<(Model, Task)>>,
    policy: Option<(Policy, u64)>,
    /// When the next copy is due.
    due: Option<Instant>,
}

impl Stage {
    fn scene(&self) -> MutexGuard<'_, Scene> {
        self.scene.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A training begins, or goes on with another task.
    pub fn enter(&self, job: u32, model: &Model, task: &Task, policy: Policy, env_steps: u64) {
        let mut scene = self.scene();
        scene.job = Some(job);
        scene.play = Some(Arc::new((model.clone(), task.clone())));
        scene.policy = Some((policy, env_steps));
        drop(scene);
        self.bell.notify_all();
    }

    /// Whether it is time for a new copy of the policy of a training.
    pub fn wants(&self, job: u32) -> bool {
        let scene = self.scene();
        let is_due = scene.due.is_none_or(|due| Instant::now() >= due);
        scene.wanted == Some(job) && scene.job == Some(job) && is_due
    }

    /// Takes a copy of the policy as it is now.
    pub fn renew(&self, job: u32, copy: impl FnOnce() -> Policy, env_steps: u64) {
        let begun = Instant::now();
        let policy = copy();
        let rest = RENEW_EVERY.max(REST * begun.elapsed());
        let mut scene = self.scene();
        if scene.job == Some(job) {
            (scene.policy, scene.due) = (Some((policy, env_steps)), Some(Instant::now() + rest));
        }
    }

    /// Chooses what is watched.
    pub fn watch(&self, job: Option<u32>) {
        self.scene().wanted = job;
        self.bell.notify_all();
    }

    /// Shows what is watched, for ever: the thread of those who look on.
    pub fn work(&self, hub: &Hub) {
        loop {
            let (job, play) = self.next(hub);
            // A task that cannot be shown is told by its training; a fault in showing costs nobody the next one.
            let shown = catch_unwind(AssertUnwindSafe(|| self.show(job, &play, hub)));
            if !matches!(shown, Ok(Ok(()))) {
                std::thread::sleep(RENEW_EVERY);
            }
        }
    }

    /// Waits for something to watch.
    fn next(&self, hub: &Hub) -> (u32, Arc<(Model, Task)>) {
        let mut scene = self.scene();
        loop {
            match (&scene.play, scene.job) {
                (Some(play), Some(job)) if scene.wanted == Some(job) && hub.has_listeners() => {
                    return (job, Arc::clone(play));
                }
                _ => {}
            }
            let waited = self.bell.wait_timeout(scene, Duration::from_secs(1));
            scene = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn is_watched(&self, job: u32, play: &Arc<(Model, Task)>, hub: &Hub) -> bool {
        let scene = self.scene();
        let same = scene.play.as_ref().is_some_and(|now| Arc::ptr_eq(now, play));
        same && scene.wanted == Some(job) && hub.has_listeners()
    }

    /// Shows one until something else is watched.
    fn show(&self, job: u32, play: &Arc<(Model, Task)>, hub: &Hub) -> Result<(), Refusal> {
        let mut actor = Actor::new(&play.0, &play.1, u64::from(job))?;
        let (layout, frame_s) = (actor.layout(), actor.frame_s());
        let frames = (PIECE_S / frame_s).round().max(1.0) as usize;
        let (mut policy, mut env_steps) = (None, 0);
        let mut due = Instant::now();
        loop {
            if let Some((newest, steps)) = self.scene().policy.take() {
                (policy, env_steps) = (Some(newest), steps);
            }
            if !self.is_watched(job, play, hub) {
                // For those who look again.
                let mut scene = self.scene();
                scene.policy = scene.policy.take().or(policy.map(|policy| (policy, env_steps)));
                return Ok(());
            }
            let Some(policy) = &mut policy else { return Err(Refusal::sentence("there is no policy yet")) };
            let mut numbers = Vec::with_capacity(frames * layout.frame_size());
            for _ in 0..frames {
                actor.act(policy)?;
                actor.push_frame(&mut numbers)?;
            }
            let frame_size = layout.frame_size();
            hub.show(
                MotionHeader { id: None, job: Some(job), env_steps, frame_s, layout: layout.clone(), frame_size },
                numbers,
            );
            due += Duration::from_secs_f64(frames as f64 * frame_s);
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
            // After a pause of the machine what was missed is left out.
            due = Instant::now().checked_sub(Duration::from_secs(1)).map_or(due, |late| due.max(late));
        }
    }
}
