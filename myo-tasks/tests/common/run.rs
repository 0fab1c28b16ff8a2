//! Tasks that run without a body.

use myo_model::MOST_FINGERS;
use myo_scalar::{Counter, Scalar, Word};
use myo_tasks::logic::{
    CompiledTask, Contact, Goal, Landmarks, Sensed, Stay, TaskState, advance, begin_step, choose_nearest, draw_objects,
};
use myo_tasks::{Anywhere, Source, Task};

/// Physics steps of a control step.
pub const SUBSTEPS: usize = 25;
/// What share of it one is.
const SHARE: f64 = 1.0 / SUBSTEPS as f64;
/// What the fingertip does: where it is, and which box it touches how hard.
pub type Deed = ([f64; 3], Option<(usize, f64)>);
/// The fingertip, other fingers, and all that they touch: which finger (0 is the fingertip), which box, how hard.
pub type Touching = ([f64; 3], [[f64; 3]; MOST_FINGERS], Vec<(usize, usize, f64)>);
/// In the air.
pub const OFF: Deed = ([0.3, 0.0, 0.1], None);

pub fn text(scene: &str, script: &str) -> String {
    format!("version: 2\nname: t\nscene:\n{scene}\nscript:\n{script}\nuser: fastest\nmodel: mobl-arms\n")
}

pub fn task(scene: &str, script: &str) -> Task {
    Task::from_yaml(&text(scene, script), "t.yaml").unwrap()
}

/// What is said of a task that is refused.
pub fn refusal(text: &str) -> String {
    match Source::parse(text, "t.yaml") {
        Err(error) => error.to_string(),
        Ok(source) => source.messages(&source.check(&Anywhere)).join("\n"),
    }
}

/// The names of random draws in a control step.
fn counter(step: u32) -> Counter<<f64 as Scalar>::Word> {
    let word = Word::splat;
    Counter { seed: [word(1), word(2)], env: word(3), episode: word(1), step: word(step), stream: word(0) }
}

/// A task that runs without a body: at every physics step `at` says where the pointer is, and which box it touches how hard.
pub struct Run {
    pub task: CompiledTask<f64>,
    pub state: TaskState<f64>,
    pub step: usize,
    pub wrong_presses: f64,
    pub exits: f64,
    pub bonuses: f64,
}

impl Run {
    /// At the beginning of an episode.
    pub fn new(task: &Task) -> Self {
        Self::episode(task, 1)
    }

    /// At the beginning of the episode of this number.
    pub fn episode(task: &Task, episode: u32) -> Self {
        let counter = Counter { episode: Word::splat(episode), ..counter(0) };
        let task = CompiledTask::<f64>::new(task).unwrap();
        let mut state = TaskState::new(&task);
        state.restart(true);
        draw_objects(&task, true, counter, &mut state);
        begin_step(&task, true, counter, &mut state);
        Self { task, state, step: 0, wrong_presses: 0.0, exits: 0.0, bonuses: 0.0 }
    }

    /// What is to do now.
    pub fn goal(&self) -> Goal<f64> {
        Goal::of(&self.task, &self.state)
    }

    /// What is seen of a pointer that is here at the beginning of a control step.
    pub fn sensed_at(&self, pointer: [f64; 3]) -> Sensed<f64> {
        let body = Landmarks { fingertip: pointer, elbow: pointer, wrist: pointer, ..Landmarks::unknown() };
        let stay = Stay::new(&self.state, &self.goal());
        Sensed { body, pointer, stay, now: (self.step * SUBSTEPS) as f64 }
    }

    /// Runs control steps until the task is done or `steps` are over; returns whether it is done.
    pub fn run(&mut self, steps: usize, at: impl Fn(&Goal<f64>, usize) -> Deed) -> bool {
        self.run_hand(steps, |goal, now| (at(goal, now), [[0.0; 3]; MOST_FINGERS]))
    }

    /// The same with other fingers, which are there.
    pub fn run_hand(
        &mut self,
        steps: usize,
        at: impl Fn(&Goal<f64>, usize) -> (Deed, [[f64; 3]; MOST_FINGERS]),
    ) -> bool {
        self.run_touching(steps, |goal, now| {
            let ((pointer, touch), fingers) = at(goal, now);
            (pointer, fingers, touch.map(|(number, force)| (0, number, force)).into_iter().collect())
        })
    }

    /// The same with all that fingers touch.
    pub fn run_touching(&mut self, steps: usize, at: impl Fn(&Goal<f64>, usize) -> Touching) -> bool {
        let body = |pointer, fingers| Landmarks {
            fingertip: pointer,
            elbow: pointer,
            wrist: pointer,
            fingers,
            ..Landmarks::unknown()
        };
        for _ in 0..steps {
            let goal = self.goal();
            let mut stay = Stay::new(&self.state, &goal);
            for now in self.step * SUBSTEPS..(self.step + 1) * SUBSTEPS {
                let (fingertip, fingers, touches) = at(&goal, now);
                let contacts = touches.into_iter().map(|(finger, number, force)| Contact {
                    exists: true,
                    finger,
                    number: number as f64,
                    force,
                    facing: 1.0,
                });
                let body = body(fingertip, fingers);
                let pointer = goal.pointer(&self.task, &body, goal.centre);
                stay.follow(&self.task, &goal, &body, pointer, SHARE, contacts.collect::<Vec<_>>().into_iter());
            }
            self.step += 1;
            let (fingertip, fingers, _) = at(&goal, self.step * SUBSTEPS);
            let body = body(fingertip, fingers);
            let pointer = goal.pointer(&self.task, &body, goal.centre);
            let sensed = Sensed { body, pointer, stay, now: (self.step * SUBSTEPS) as f64 };
            let progress = advance(&self.task, &goal, &sensed, &mut self.state, SHARE);
            let begins = progress.target_over && !progress.task_over;
            begin_step(&self.task, begins, counter(self.step as u32), &mut self.state);
            choose_nearest(&self.task, &body, &mut self.state);
            self.wrong_presses += progress.wrong_presses;
            self.bonuses += progress.bonuses;
            self.exits += progress.exits;
            if progress.task_over {
                return progress.task_done;
            }
        }
        false
    }
}
