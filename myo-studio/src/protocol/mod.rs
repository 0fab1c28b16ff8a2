//! The language between the page and an engine. Everything here is data; `web/src/engine/protocol.ts` is written from it.
//!
//! The page asks with a [`Question`] and gets one [`Reply`]; what happens by itself, the engine tells as [`Event`]s. What moves comes as
//! one block of numbers behind a [`MotionHeader`]. Lengths are in m from the shoulder centre: x forward, y to the left, z up.

mod body;
mod compare;
mod jobs;
mod report;
mod reward;
mod runs;
mod task;
#[cfg(test)]
mod typescript;

use myo_tasks::Body;
use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use body::{
    BodyPart, BodyShape, BoneShape, DigitShape, LookShape, MOMENT, MotionLayout, MuscleShape, OBJECT, PART,
};
pub use compare::{Against, Contrast, LayoutRow, LayoutTable, LayoutUsers, LeftOut, Mean, StepRow, UserRow};
pub use jobs::{Before, Bottleneck, Changes, Doubling, Job, JobOrder, JobProgress, JobState, LearnerSetting, Step};
pub use report::{Recorded, RecordedMotion, RecordedRun};
pub use reward::{Cut, RewardMap, RewardTerm, RewardView};
pub use runs::{CurvePoint, ProtocolAnswer, RunDetail, RunEntry, RunNote, RunStanding, TargetResult};
pub use task::{
    Finding, ItemView, Look, ObjectKind, ObjectView, PresetCard, Severity, StepView, Surface, TaskFile, TaskText,
    TaskView,
};

/// What the page asks.
#[derive(Clone, Debug, Deserialize)]
pub struct Question {
    /// The reply has the same.
    pub id: u32,
    /// Which [call](CALLS) it is.
    pub call: String,
    /// What goes with it.
    #[serde(default)]
    pub with: Value,
}

/// What the engine answers, in text.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// What was asked for.
    Ok(Value),
    /// Why it cannot be had.
    Refused(Refusal),
}

/// The answer to a question.
#[derive(Clone, Debug, Serialize)]
pub struct Reply {
    /// Of the question.
    pub id: u32,
    /// The answer.
    #[serde(flatten)]
    pub answer: Answer,
}

/// Why something cannot be done: one sentence, and what it is about where that is known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Refusal {
    /// For people.
    pub message: String,
    /// What is wrong in the text of a task.
    pub findings: Vec<Finding>,
}

impl<E: std::error::Error> From<E> for Refusal {
    fn from(error: E) -> Self {
        Self::sentence(error.to_string())
    }
}

impl Refusal {
    /// A refusal in one sentence.
    pub fn sentence(message: impl Into<String>) -> Self {
        Self { message: message.into(), findings: vec![] }
    }
}

/// What happens by itself.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// All trainings of the studio, first to last, whenever one changes.
    Jobs {
        /// All of them.
        jobs: Vec<Job>,
    },
    /// Runs have come, gone or changed.
    Runs,
    /// A task file has come, gone or changed.
    Tasks {
        /// Its name; none where it may be any.
        name: Option<String>,
    },
}

/// What comes before the numbers of a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct MotionHeader {
    /// Of the question that it answers; none where it comes by itself, as those who watch a training get it.
    pub id: Option<u32>,
    /// The training that is watched.
    pub job: Option<u32>,
    /// Control steps that the policy was trained for.
    pub env_steps: u64,
    /// Time from one frame to the next (s).
    pub frame_s: f64,
    /// How the numbers of a frame lie.
    pub layout: MotionLayout,
    /// Numbers of a frame.
    pub frame_size: usize,
}

/// What an engine sends.
#[derive(Clone, Debug)]
pub enum Message {
    /// JSON.
    Text(String),
    /// A [`MotionHeader`] and numbers.
    Motion(MotionHeader, Vec<f32>),
}

impl Message {
    /// A motion as bytes: the length of the header (4 bytes, little end first), the header in JSON, filled up with spaces to a multiple of
    /// four, and the numbers in single precision, little end first.
    pub fn bytes(header: &MotionHeader, numbers: &[f32]) -> Vec<u8> {
        let mut json = serde_json::to_vec(header).unwrap_or_default();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bytes = Vec::with_capacity(4 + json.len() + 4 * numbers.len());
        bytes.extend((json.len() as u32).to_le_bytes());
        bytes.extend(json);
        numbers.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
        bytes
    }
}

/// One line of [`CALLS`]: what goes with a question and what comes back, as types of the page.
pub struct Call {
    /// How it is called.
    pub name: &'static str,
    /// Type of what goes with it.
    pub with: &'static str,
    /// Type of what comes back.
    pub reply: &'static str,
}

/// Declares the questions of the page. Each is a type of what goes with it, and knows its reply.
macro_rules! calls {
    ($($(#[$doc:meta])* $name:literal $with:ident { $($(#[$about:meta])* $field:ident: $kind:ty,)* } -> $reply:ty, $script:literal;)*) => {
        $(
            $(#[$doc])*
            #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
            #[cfg_attr(test, derive(ts_rs::TS))]
            #[serde(deny_unknown_fields)]
            pub struct $with { $($(#[$about])* pub $field: $kind,)* }
            impl Asks for $with { type Reply = $reply; }
        )*
        /// Everything that can be asked.
        pub const CALLS: &[Call] = &[$(Call { name: $name, with: stringify!($with), reply: $script },)*];
        /// Hands a question to what answers it.
        ///
        /// # Errors
        /// There is no such call, what goes with it is something else, or the engine refuses.
        pub fn ask(engine: &impl Answers, call: &str, with: Value) -> Result<Value, Refusal> {
            let with = if with.is_null() { Value::Object(Default::default()) } else { with };
            match call {
                $($name => Ok(serde_json::to_value(engine.answer(serde_json::from_value::<$with>(with)?)?)?),)*
                other => Err(Refusal::sentence(format!("this engine knows no call named {other:?}; is the page of another version?"))),
            }
        }
        /// What answers every question.
        pub trait Answers: $(AnswersOne<$with> +)* Sized {
            /// Answers one of them.
            ///
            /// # Errors
            /// Why it cannot be answered.
            fn answer<Q: Asks>(&self, question: Q) -> Result<Q::Reply, Refusal> where Self: AnswersOne<Q> {
                self.answer_one(question)
            }
        }
        impl<T: $(AnswersOne<$with> +)* Sized> Answers for T {}
    };
}

/// Something that can be asked.
pub trait Asks {
    /// What comes back.
    type Reply: Serialize;
}

/// What answers a question of this type.
pub trait AnswersOne<Q: Asks> {
    /// The answer.
    ///
    /// # Errors
    /// Why there is none.
    fn answer_one(&self, question: Q) -> Result<Q::Reply, Refusal>;
}

calls! {
    /// What this engine is and has.
    "hello" Hello {} -> Welcome, "Welcome";
    /// The JSON Schema of task files: fields with explanation, default and range.
    "schema" AskSchema {} -> Value, "unknown";
    /// What stands in the text of a task and what is wrong with it, reach aside.
    "look" LookAt {
        /// The text.
        text: String,
    } -> Look, "Look";
    /// The text of a task in the newest version of the format, without its comments.
    "convert" ConvertTask {
        /// The text.
        text: String,
    } -> String, "string";
    /// Everything wrong or odd about a task, reach included.
    "check" CheckTask {
        /// The text.
        text: String,
    } -> Vec<Finding>, "Array<Finding>";
    /// What the pointer of a task can reach.
    "reach" AskReach {
        /// The text.
        text: String,
    } -> Surface, "Surface";
    /// What a task is rewarded for, with the least and the greatest value of each term.
    "reward" AskReward {
        /// The text.
        text: String,
    } -> RewardView, "RewardView";
    /// The reward over a rectangle through the object of a step.
    "reward_map" AskRewardMap {
        /// The text.
        text: String,
        /// Number of the step, from 0.
        step: usize,
        /// How the rectangle lies.
        cut: Cut,
    } -> RewardMap, "RewardMap";
    /// All settings of the learner.
    "settings" AskSettings {} -> Vec<LearnerSetting>, "Array<LearnerSetting>";
    /// The body of a task's user.
    "body" AskBody {
        /// Name or file of the model.
        model: String,
        /// What its user changes of it.
        #[cfg_attr(test, ts(type = "unknown"))]
        body: Body,
    } -> BodyShape, "BodyShape";
    /// The body that learnt in a run, whatever became of the file of its model.
    "body_of_run" AskBodyOfRun {
        /// Name of the run.
        name: String,
    } -> BodyShape, "BodyShape";
    /// Task files that were kept.
    "tasks" ListTasks {} -> Vec<TaskFile>, "Array<TaskFile>";
    /// Opens a task that was kept.
    "open" OpenTask {
        /// Its name.
        name: String,
    } -> TaskText, "TaskText";
    /// Keeps a task.
    "save" SaveTask {
        /// Its name: that of the file without its ending.
        name: String,
        /// The text.
        text: String,
    } -> TaskFile, "TaskFile";
    /// Puts a task into the bin.
    "discard_task" DiscardTask {
        /// Its name.
        name: String,
    } -> (), "null";
    /// Trains a user, once those before it are done.
    "train" Train {
        /// What and how.
        order: JobOrder,
    } -> Vec<u32>, "Array<number>";
    /// Takes a run up again that was stopped, whoever trained there.
    "go_on" GoOn {
        /// Name of the run.
        run: String,
    } -> u32, "number";
    /// Goes on with a training on another task, or with other settings: its user keeps what it has learnt.
    "relearn" Relearn {
        /// Which one.
        job: u32,
        /// Text of the task.
        text: String,
        /// Settings of the learner that are not as they come; none leaves them as they are.
        #[cfg_attr(test, ts(type = "Record<string, unknown> | null"))]
        settings: Option<Changes>,
    } -> (), "null";
    /// Tells a training what to do next.
    "tell" TellJob {
        /// Which one.
        job: u32,
        /// What to do.
        step: Step,
    } -> (), "null";
    /// Chooses the training whose movement comes as motions; none for none.
    "watch" Watch {
        /// Which one.
        job: Option<u32>,
    } -> (), "null";
    /// All runs.
    "runs" ListRuns {} -> Vec<RunEntry>, "Array<RunEntry>";
    /// All that is known of a run.
    "run" AskRun {
        /// Its name: the path of its folder below that of all runs.
        name: String,
    } -> RunDetail, "RunDetail";
    /// Mean squared control of each step of a run over some fresh episodes; null for steps that no episode comes to.
    "efforts" AskEfforts {
        /// Its name.
        name: String,
    } -> Vec<Option<f64>>, "Array<number | null>";
    /// Runs by what their users learnt, with what tells the layouts apart.
    "compare" CompareRuns {
        /// Names of the runs; the layout of the first is what others are held against.
        names: Vec<String>,
    } -> LayoutTable, "LayoutTable";
    /// Who has learnt a task as it is from nothing, with the settings as they come, and who is about to.
    "users_of" AskUsersOf {
        /// Text of the task.
        text: String,
        /// When they stop: `plateau`, `off` or a share of successful episodes.
        until: String,
    } -> LayoutUsers, "LayoutUsers";
    /// A report on runs as one page (HTML) that needs nothing else.
    "report" AskReport {
        /// Names of the runs.
        names: Vec<String>,
    } -> String, "string";
    /// Writes tags and a note down beside a run.
    "note" NoteRun {
        /// Name of the run.
        name: String,
        /// What to write down.
        note: RunNote,
    } -> (), "null";
    /// Gives a run another name.
    "rename_run" RenameRun {
        /// Its name.
        name: String,
        /// What it is to be called.
        to: String,
    } -> (), "null";
    /// Puts a run into the bin.
    "discard_run" DiscardRun {
        /// Its name.
        name: String,
    } -> (), "null";
}

/// The first moment of a task, which comes as a motion of one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Text of the task.
    pub text: String,
}

/// An episode of a run, which comes as a motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(deny_unknown_fields)]
pub struct Replay {
    /// Name of the run.
    pub run: String,
    /// Seed of the episode; episodes of one seed are the same whatever user does them.
    pub seed: u32,
    /// Control steps of the checkpoint; the newest without.
    pub env_steps: Option<u64>,
}

/// What an engine is and has.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Welcome {
    /// Version of Myo.
    pub version: String,
    /// Where tasks and runs are kept, for people.
    pub folder: String,
    /// Threads of the processor.
    pub threads: usize,
    /// Tasks that come with it.
    pub presets: Vec<PresetCard>,
    /// Bodies that come with it.
    pub models: Vec<String>,
}
