//! The engine: everything the page can ask for, computed here. It knows no sockets; whoever has one hands it [questions](crate::protocol).

mod actor;
mod bodies;
mod compare;
mod following;
mod hub;
mod jobs;
mod look;
mod motion;
mod presets;
mod replay;
mod report;
mod reward;
mod runs;
mod surface;
mod training;
mod watch;
mod workspace;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use myo_lab::{Backend, RunDescription};
use myo_model::builtin_names;
use myo_tasks::Task;
use serde_json::Value;

use crate::protocol::{
    Answer, AnswersOne, AskBody, AskBodyOfRun, AskEfforts, AskReach, AskReport, AskReward, AskRewardMap, AskRun,
    AskSchema, AskSettings, AskUsersOf, BodyShape, CheckTask, CompareRuns, ConvertTask, DiscardRun, DiscardTask, Event,
    Finding, GoOn, Hello, LayoutTable, LayoutUsers, LearnerSetting, ListRuns, ListTasks, Look, LookAt, Message,
    MotionHeader, NoteRun, OpenTask, Pose, Question, Refusal, Relearn, RenameRun, Replay, Reply, RewardMap, RewardView,
    RunDetail, RunEntry, SaveTask, Surface, TaskFile, TaskText, TellJob, Train, Watch, Welcome, ask,
};
use bodies::Bodies;
pub use hub::Hub;
use jobs::Jobs;
pub use report::report;
use watch::Stage;
use workspace::{Kind, Workspace};

/// Answers everything that a page asks, and trains in threads of its own.
pub struct Engine {
    workspace: Workspace,
    bodies: Arc<Bodies>,
    hub: Arc<Hub>,
    stage: Arc<Stage>,
    jobs: Arc<Jobs>,
    /// The thread of the trainings.
    worker: Mutex<Option<JoinHandle<()>>>,
    /// Of the folder: two studios in one would train the same users.
    _lock: std::fs::File,
}

impl Engine {
    /// An engine that keeps tasks and runs in a folder; trainings that a killed one left there go on.
    ///
    /// # Errors
    /// Another studio works there, or the list of its trainings is damaged.
    pub fn open(folder: PathBuf, backend: Backend) -> Result<Self, Refusal> {
        let workspace = Workspace::new(folder);
        let lock = workspace.lock()?;
        let (bodies, hub, stage) = (Arc::new(Bodies::default()), Arc::new(Hub::default()), Arc::new(Stage::default()));
        let (models, ears, scene) = (Arc::clone(&bodies), Arc::clone(&hub), Arc::clone(&stage));
        let jobs = Arc::new(Jobs::open(workspace.clone(), models, ears, scene, backend)?);
        let (worker, watcher, listeners) = (Arc::clone(&jobs), Arc::clone(&stage), Arc::clone(&hub));
        let worker = std::thread::Builder::new().name("trainings".into()).spawn(move || worker.work())?;
        // Pages ask for the cards first: they are painted meanwhile.
        std::thread::Builder::new().name("cards".into()).spawn(|| _ = presets::cards())?;
        std::thread::Builder::new().name("watch".into()).spawn(move || watcher.work(&listeners))?;
        let worker = Mutex::new(Some(worker));
        Ok(Self { workspace, bodies, hub, stage, jobs, worker, _lock: lock })
    }

    /// Ends the training that is under way with a checkpoint, and waits until that is written. An engine that is opened in this folder
    /// later goes on with it.
    pub fn close(&self) {
        self.jobs.close();
        let worker = self.worker.lock().unwrap_or_else(PoisonError::into_inner).take();
        // A worker that failed has nothing to wait for.
        let _ = worker.map(JoinHandle::join);
    }

    /// Who is told what happens by itself.
    pub fn hub(&self) -> &Hub {
        &self.hub
    }

    /// What a page must know when it comes.
    pub fn state(&self) -> Event {
        Event::Jobs { jobs: self.jobs.all() }
    }

    /// Answers a question, whatever it is: a fault in an answer is told, and costs nobody the engine.
    pub fn answer(&self, question: Question) -> Message {
        let Question { id, call, with } = question;
        let answered = catch_unwind(AssertUnwindSafe(|| self.try_answer(&call, with)));
        let answered = answered.unwrap_or_else(|_| {
            Err(Refusal::sentence(format!("the engine failed on {call:?}; this is a fault of Myo, not yours")))
        });
        let answer = match answered {
            Ok(Answered::Motion(header, numbers)) => {
                return Message::Motion(MotionHeader { id: Some(id), ..header }, numbers);
            }
            Ok(Answered::Value(value)) => Answer::Ok(value),
            Err(refusal) => Answer::Refused(refusal),
        };
        Message::Text(serde_json::to_string(&Reply { id, answer }).unwrap_or_default())
    }

    fn try_answer(&self, call: &str, with: Value) -> Result<Answered, Refusal> {
        let motion = |(header, numbers)| Answered::Motion(header, numbers);
        match call {
            "replay" => {
                let asked: Replay = serde_json::from_value(with)?;
                replay::replay(&self.workspace.run(&asked.run)?, &asked).map(motion)
            }
            "pose" => {
                let Pose { text } = serde_json::from_value(with)?;
                let task = self.workspace.read(&text)?.task;
                replay::moment(&*self.bodies.of(&task)?, &task).map(motion)
            }
            _ => ask(self, call, with).map(Answered::Value),
        }
    }
}

impl Drop for Engine {
    /// Nobody writes in the folder once it is free for another studio.
    fn drop(&mut self) {
        self.close();
    }
}

enum Answered {
    Value(Value),
    Motion(MotionHeader, Vec<f32>),
}

impl AnswersOne<Hello> for Engine {
    fn answer_one(&self, _: Hello) -> Result<Welcome, Refusal> {
        Ok(Welcome {
            version: env!("CARGO_PKG_VERSION").into(),
            folder: self.workspace.folder().display().to_string(),
            threads: rayon::current_num_threads(),
            presets: presets::cards().to_vec(),
            models: builtin_names().iter().map(|&name| name.to_owned()).collect(),
        })
    }
}

impl AnswersOne<AskSchema> for Engine {
    fn answer_one(&self, _: AskSchema) -> Result<Value, Refusal> {
        Ok(serde_json::to_value(myo_tasks::task_schema())?)
    }
}

impl AnswersOne<LookAt> for Engine {
    fn answer_one(&self, LookAt { text }: LookAt) -> Result<Look, Refusal> {
        Ok(look::look(&text))
    }
}

impl AnswersOne<ConvertTask> for Engine {
    fn answer_one(&self, ConvertTask { text }: ConvertTask) -> Result<String, Refusal> {
        Ok(look::read(&text)?.task.converted().to_yaml())
    }
}

impl AnswersOne<CheckTask> for Engine {
    fn answer_one(&self, CheckTask { text }: CheckTask) -> Result<Vec<Finding>, Refusal> {
        let source = match self.workspace.read(&text) {
            Ok(source) => source,
            Err(refusal) => return Ok(refusal.findings),
        };
        let reach = self.bodies.reach(&source.task)?;
        Ok(look::of_report(&source, &source.check(&*reach)))
    }
}

impl AnswersOne<AskReach> for Engine {
    fn answer_one(&self, AskReach { text }: AskReach) -> Result<Surface, Refusal> {
        Ok(surface::surface(&*self.bodies.reach(&self.workspace.read(&text)?.task)?))
    }
}

impl AnswersOne<AskReward> for Engine {
    fn answer_one(&self, AskReward { text }: AskReward) -> Result<RewardView, Refusal> {
        let task = self.workspace.read(&text)?.task;
        reward::view(&task, &*self.bodies.of(&task)?, &*self.bodies.reach(&task)?)
    }
}

impl AnswersOne<AskRewardMap> for Engine {
    fn answer_one(&self, AskRewardMap { text, step, cut }: AskRewardMap) -> Result<RewardMap, Refusal> {
        reward::map(&self.workspace.read(&text)?.task, step, cut)
    }
}

impl AnswersOne<AskSettings> for Engine {
    fn answer_one(&self, _: AskSettings) -> Result<Vec<LearnerSetting>, Refusal> {
        let told = |setting: myo_lab::LearnerSetting| LearnerSetting {
            name: setting.name,
            about: setting.about,
            default: setting.default,
            range: setting.range.map(str::to_owned),
        };
        Ok(myo_lab::learner_settings().into_iter().map(told).collect())
    }
}

impl AnswersOne<AskBody> for Engine {
    fn answer_one(&self, AskBody { model, body }: AskBody) -> Result<BodyShape, Refusal> {
        let bare = Task { model: self.workspace.model(&model), body, ..Task::without_script("body") };
        Ok(motion::shape(&*self.bodies.of(&bare)?, &bare)?)
    }
}

impl AnswersOne<AskBodyOfRun> for Engine {
    fn answer_one(&self, AskBodyOfRun { name }: AskBodyOfRun) -> Result<BodyShape, Refusal> {
        let description = RunDescription::of(&myo_train::RunFolder::open(&self.workspace.run(&name)?)?)?;
        Ok(motion::shape(&description.body()?, &description.task)?)
    }
}

impl AnswersOne<ListTasks> for Engine {
    fn answer_one(&self, _: ListTasks) -> Result<Vec<TaskFile>, Refusal> {
        self.workspace.list_tasks()
    }
}

impl AnswersOne<OpenTask> for Engine {
    fn answer_one(&self, OpenTask { name }: OpenTask) -> Result<TaskText, Refusal> {
        self.workspace.open_task(&name)
    }
}

impl AnswersOne<SaveTask> for Engine {
    fn answer_one(&self, SaveTask { name, text }: SaveTask) -> Result<TaskFile, Refusal> {
        let file = self.workspace.save_task(&name, &text)?;
        self.hub.tell(&Event::Tasks { name: Some(name) });
        Ok(file)
    }
}

impl AnswersOne<DiscardTask> for Engine {
    fn answer_one(&self, DiscardTask { name }: DiscardTask) -> Result<(), Refusal> {
        self.workspace.discard(Kind::Task, &name)?;
        self.hub.tell(&Event::Tasks { name: None });
        Ok(())
    }
}

impl AnswersOne<Train> for Engine {
    fn answer_one(&self, Train { order }: Train) -> Result<Vec<u32>, Refusal> {
        self.jobs.order(&order)
    }
}

impl AnswersOne<GoOn> for Engine {
    fn answer_one(&self, GoOn { run }: GoOn) -> Result<u32, Refusal> {
        self.jobs.go_on(&run)
    }
}

impl AnswersOne<Relearn> for Engine {
    fn answer_one(&self, Relearn { job, text, settings }: Relearn) -> Result<(), Refusal> {
        self.jobs.relearn(job, text, settings)
    }
}

impl AnswersOne<TellJob> for Engine {
    fn answer_one(&self, TellJob { job, step }: TellJob) -> Result<(), Refusal> {
        self.jobs.tell(job, step)
    }
}

impl AnswersOne<Watch> for Engine {
    fn answer_one(&self, Watch { job }: Watch) -> Result<(), Refusal> {
        self.stage.watch(job);
        Ok(())
    }
}

impl AnswersOne<ListRuns> for Engine {
    fn answer_one(&self, _: ListRuns) -> Result<Vec<RunEntry>, Refusal> {
        runs::list(&self.workspace)
    }
}

impl AnswersOne<AskRun> for Engine {
    fn answer_one(&self, AskRun { name }: AskRun) -> Result<RunDetail, Refusal> {
        runs::detail(&self.workspace, &name)
    }
}

impl AnswersOne<AskEfforts> for Engine {
    fn answer_one(&self, AskEfforts { name }: AskEfforts) -> Result<Vec<Option<f64>>, Refusal> {
        replay::efforts(&self.workspace.run(&name)?, &name)
    }
}

impl AnswersOne<CompareRuns> for Engine {
    fn answer_one(&self, CompareRuns { names }: CompareRuns) -> Result<LayoutTable, Refusal> {
        Ok(compare::table(&self.named(&names)?))
    }
}

impl AnswersOne<AskUsersOf> for Engine {
    fn answer_one(&self, AskUsersOf { text, until }: AskUsersOf) -> Result<LayoutUsers, Refusal> {
        let task = self.workspace.read(&text)?.task;
        let runs = compare::users_of(&self.workspace, &task, until.parse()?)?;
        Ok(LayoutUsers { runs, on_the_way: self.jobs.on_the_way(&text, &until) })
    }
}

impl AnswersOne<AskReport> for Engine {
    fn answer_one(&self, AskReport { names }: AskReport) -> Result<String, Refusal> {
        report(&self.named(&names)?)
    }
}

impl AnswersOne<NoteRun> for Engine {
    fn answer_one(&self, NoteRun { name, note }: NoteRun) -> Result<(), Refusal> {
        runs::write_note(&self.workspace, &name, &note)?;
        self.hub.tell(&Event::Runs);
        Ok(())
    }
}

impl AnswersOne<RenameRun> for Engine {
    fn answer_one(&self, RenameRun { name, to }: RenameRun) -> Result<(), Refusal> {
        self.refuse_if_training(&name)?;
        let renamed = self.workspace.rename_run(&name, &to)?;
        self.jobs.renamed(&name, Some(&renamed))?;
        self.hub.tell(&Event::Runs);
        Ok(())
    }
}

impl AnswersOne<DiscardRun> for Engine {
    fn answer_one(&self, DiscardRun { name }: DiscardRun) -> Result<(), Refusal> {
        self.refuse_if_training(&name)?;
        self.workspace.discard(Kind::Run, &name)?;
        self.jobs.renamed(&name, None)?;
        self.hub.tell(&Event::Runs);
        Ok(())
    }
}

impl Engine {
    /// Runs with their folders.
    fn named(&self, names: &[String]) -> Result<Vec<(String, PathBuf)>, Refusal> {
        names.iter().map(|name| Ok((name.clone(), self.workspace.run(name)?))).collect()
    }

    /// The folder of a run that somebody writes into stays where it is.
    fn refuse_if_training(&self, name: &str) -> Result<(), Refusal> {
        let folder = self.workspace.run(name)?;
        match myo_train::RunFolder::open(&folder) {
            Ok(run) if run.is_training() => Err(Refusal::sentence(format!("{name} is being trained; stop it first"))),
            // A damaged run can be thrown away.
            _ => Ok(()),
        }
    }
}
