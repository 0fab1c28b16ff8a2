//! Tasks that run without a body.

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
        let body = Landmarks { fingertip: pointer, elbow: pointer, wrist: pointer, cursor: [0.0; 2] };
        let stay = Stay::new(&self.state, &self.goal());
        Sensed { body, pointer, stay, now: (self.step * SUBSTEPS) as f64 }
    }

    /// Runs control steps until the task is done or `steps` are over; returns whether it is done.
    pub fn run(&mut self, steps: usize, at: impl Fn(&Goal<f64>, usize) -> Deed) -> bool {
        for _ in 0..steps {
            let goal = self.goal();
            let mut stay = Stay::new(&self.state, &goal);
            for now in self.step * SUBSTEPS..(self.step + 1) * SUBSTEPS {
                let (pointer, touch) = at(&goal, now);
                let (number, force) = touch.unwrap_or((0, 0.0));
                let contact = Contact { exists: touch.is_some(), number: number as f64, force, facing: 1.0 };
                stay.follow(&self.task, &goal, pointer, SHARE, std::iter::once(contact));
            }
            self.step += 1;
            let (pointer, _) = at(&goal, self.step * SUBSTEPS);
            let body = Landmarks { fingertip: pointer, elbow: pointer, wrist: pointer, cursor: [0.0; 2] };
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
