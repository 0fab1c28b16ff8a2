//! Trainings that were ordered: kept in a file, done first to last in a thread of their own, steered while they run.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

use myo_lab::{Backend, ModelReach, RunDescription, changed_settings, default_steps, likely_cause};
use myo_train::session::{Change, End, Goal, News, Outcome, Trend, Until};
use myo_train::{Checkpoint, PpoConfig, RunFolder, write_whole};
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::compare;
use super::following::Following;
use super::hub::Hub;
use super::look;
use super::training::{Beginning, Heritage, Training};
use super::watch::Stage;
use super::workspace::Workspace;
use crate::protocol::{Before, Changes, Doubling, Event, Job, JobOrder, JobState, Refusal, Step};

/// Most users of one order.
const MOST_USERS: u32 = 64;
/// Episodes of the first look at a user that comes from another task.
const FIRST_LOOK: usize = 256;

/// All trainings that were ordered.
pub struct Jobs {
    list: Mutex<List>,
    /// Held while the list is written: what was made later is written later.
    writing: Mutex<()>,
    /// Rung whenever somebody orders or tells something.
    bell: Condvar,
    /// Whether the studio is about to end.
    is_closing: AtomicBool,
    workspace: Workspace,
    bodies: Arc<Bodies>,
    hub: Arc<Hub>,
    stage: Arc<Stage>,
    backend: Backend,
}

/// What is kept in the file, so that a studio that was killed goes on.
#[derive(Default, Serialize, Deserialize)]
struct List {
    next: u32,
    entries: Vec<Entry>,
}

#[derive(Clone, Serialize, Deserialize)]
struct Entry {
    job: Job,
    order: JobOrder,
    /// What it was told last and has not done yet.
    #[serde(skip)]
    told: Option<Step>,
    /// The task that a live training goes on with, and has not begun yet.
    #[serde(default)]
    next: Option<String>,
    /// Settings of the learner that come with it, where they are others.
    #[serde(default)]
    next_settings: Option<Changes>,
}

impl List {
    /// Adds a training that waits; its number.
    fn add(&mut self, order: JobOrder, run: Option<String>) -> u32 {
        self.next += 1;
        let job = Job {
            id: self.next,
            run,
            title: order.name.clone(),
            seed: order.seed,
            live: order.live,
            state: JobState::Waiting,
            progress: None,
            news: vec![],
        };
        self.entries.push(Entry { job, order, told: None, next: None, next_settings: None });
        self.next
    }
}

/// How a training of a task ended.
enum Over {
    /// It is over.
    So(JobState),
    /// Another task came: the user that goes on with it.
    Changed(Box<Checkpoint>),
}

impl Jobs {
    /// The trainings of a folder; those that a killed studio left under way wait to go on.
    pub fn open(
        workspace: Workspace,
        bodies: Arc<Bodies>,
        hub: Arc<Hub>,
        stage: Arc<Stage>,
        backend: Backend,
    ) -> Result<Self, Refusal> {
        let path = file(&workspace);
        let mut list = match std::fs::read(&path) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => List::default(),
            Err(error) => return Err(Refusal::sentence(format!("cannot read {}: {error}", path.display()))),
            Ok(text) => serde_json::from_slice(&text).map_err(|error| {
                Refusal::sentence(format!(
                    "{} is damaged: {error}; move it away, and the list begins anew",
                    path.display()
                ))
            })?,
        };
        for entry in &mut list.entries {
            match entry.job.state {
                JobState::Preparing | JobState::Training | JobState::Evaluating => entry.job.state = JobState::Waiting,
                JobState::Paused => entry.job.state = JobState::Stopped,
                _ => {}
            }
        }
        Ok(Self {
            list: Mutex::new(list),
            writing: Mutex::new(()),
            bell: Condvar::new(),
            is_closing: AtomicBool::new(false),
            workspace,
            bodies,
            hub,
            stage,
            backend,
        })
    }

    fn list(&self) -> MutexGuard<'_, List> {
        self.list.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// All of them, first to last.
    pub fn all(&self) -> Vec<Job> {
        self.list().entries.iter().map(|entry| entry.job.clone()).collect()
    }

    /// Orders trainings; their numbers.
    ///
    /// # Errors
    /// The order is not one that can be carried out.
    pub fn order(&self, order: &JobOrder) -> Result<Vec<u32>, Refusal> {
        order.until.parse::<Until>()?;
        check_settings(&order.settings)?;
        if order.users == 0 || order.users > MOST_USERS {
            return Err(Refusal::sentence(format!(
                "{} users are asked for; from 1 to {MOST_USERS} can be",
                order.users
            )));
        }
        self.refuse_what_cannot_be_trained(&order.text)?;
        // The name becomes that of a folder.
        self.workspace.task(&order.name)?;
        if let Some(from) = &order.from {
            self.workspace.run(from)?;
        }
        let taken = self.taken_seeds(&order.text)?;
        let mut list = self.list();
        let free = (order.seed..=u64::MAX).filter(|seed| order.from.is_some() || !taken.contains(seed));
        let order_of = |seed: u64| JobOrder { seed, users: 1, ..order.clone() };
        let ids = free.take(order.users as usize).map(|seed| list.add(order_of(seed), None)).collect();
        drop(list);
        self.changed()?;
        Ok(ids)
    }

    /// Seeds of users who learnt a task or are about to: one more of the same seed would be the same user again.
    fn taken_seeds(&self, text: &str) -> Result<Vec<u64>, Refusal> {
        let runs = compare::runs_of(&self.workspace, &self.workspace.read(text)?.task)?;
        let list = self.list();
        let ordered = list.entries.iter().filter(|entry| entry.order.text == text).map(|entry| entry.job.seed);
        Ok(runs.iter().map(|run| run.config().seed).chain(ordered).collect())
    }

    /// Trainings of a task as it is that have not ended, with this goal.
    pub fn on_the_way(&self, text: &str, until: &str) -> Vec<u32> {
        let list = self.list();
        let is_of = |entry: &&Entry| {
            let is_open = entry.is_under_way() || entry.job.state == JobState::Waiting;
            is_open && entry.order.text == text && entry.order.until == until && entry.order.from.is_none()
        };
        list.entries.iter().filter(is_of).map(|entry| entry.job.id).collect()
    }

    fn refuse_what_cannot_be_trained(&self, text: &str) -> Result<(), Refusal> {
        let source = self.workspace.read(text)?;
        let report = source.check(&*self.bodies.reach(&source.task)?);
        if report.is_ok() {
            return Ok(());
        }
        let findings = look::of_report(&source, &report);
        let message = report.errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        Err(Refusal { message, findings })
    }

    /// Lets the user of a training go on with another task or other settings, whether it is under way or over.
    ///
    /// # Errors
    /// There is no such training, it has no user yet, or the task cannot be trained so.
    pub fn relearn(&self, id: u32, text: String, settings: Option<Changes>) -> Result<(), Refusal> {
        self.refuse_what_cannot_be_trained(&text)?;
        settings.as_ref().map_or(Ok(()), check_settings)?;
        if let Some(settings) = &settings {
            self.refuse_other_widths(id, settings)?;
        }
        let mut list = self.list();
        let entry = list.entries.iter_mut().find(|entry| entry.job.id == id);
        let entry = entry.ok_or_else(|| Refusal::sentence("this training is not in the list any more"))?;
        if !entry.job.live && !entry.is_under_way() {
            return Err(Refusal::sentence("this training is over, and its run stays as it is; train another user"));
        }
        entry.next_settings = settings.or(entry.next_settings.take());
        entry.next = Some(text);
        if !entry.is_under_way() {
            entry.job.state = JobState::Waiting;
        }
        drop(list);
        self.changed()
    }

    /// What has been learnt lies in layers of the widths that it was learnt with.
    fn refuse_other_widths(&self, id: u32, settings: &Changes) -> Result<(), Refusal> {
        let run = self.list().entries.iter().find(|entry| entry.job.id == id).and_then(|entry| entry.job.run.clone());
        let Some(run) = run else { return Ok(()) };
        let own = RunFolder::open(&self.workspace.run(&run)?)?.config().ppo.clone();
        let wanted = changed_settings(&PpoConfig::default(), changes(settings))?;
        if (&own.policy_hidden, &own.value_hidden) == (&wanted.policy_hidden, &wanted.value_hidden) {
            return Ok(());
        }
        Err(Refusal::sentence(format!(
            "the widths of hidden layers cannot change while a user learns: it has {:?} (policy_hidden) and {:?} (value_hidden); train \
             another user",
            own.policy_hidden, own.value_hidden
        )))
    }

    /// Takes up a run again that was stopped, whoever trained there.
    ///
    /// # Errors
    /// It trains already, or cannot be read.
    pub fn go_on(&self, run: &str) -> Result<u32, Refusal> {
        let folder = self.workspace.run(run)?;
        let summary = myo_lab::run_summary(&folder)?;
        if summary.state == myo_lab::RunState::Training {
            return Err(Refusal::sentence(format!("{run} is being trained already")));
        }
        let mut list = self.list();
        let order = JobOrder {
            text: String::new(),
            name: summary.layouts.join(", "),
            seed: summary.seed,
            users: 1,
            until: "plateau".into(),
            steps: None,
            from: None,
            live: false,
            settings: changed_in(&RunFolder::open(&folder)?)?,
        };
        let id = list.add(order, Some(run.to_owned()));
        drop(list);
        self.changed()?;
        Ok(id)
    }

    /// Tells a training what to do next.
    ///
    /// # Errors
    /// There is no such training, or it cannot do that as it stands.
    pub fn tell(&self, id: u32, step: Step) -> Result<(), Refusal> {
        let mut list = self.list();
        let none = || Refusal::sentence("this training is not in the list any more");
        let index = list.entries.iter().position(|entry| entry.job.id == id).ok_or_else(none)?;
        let entry = &mut list.entries[index];
        match (step, entry.is_under_way()) {
            (_, true) => entry.told = Some(step),
            (Step::Dismiss, false) => drop(list.entries.remove(index)),
            (Step::Resume, false) if !matches!(entry.job.state, JobState::Done { .. }) => {
                entry.job.state = JobState::Waiting;
            }
            (Step::Stop | Step::Pause, false) if entry.job.state == JobState::Waiting => {
                entry.job.state = JobState::Stopped;
            }
            (_, false) => return Err(Refusal::sentence("this training is not under way")),
        }
        drop(list);
        self.changed()
    }

    /// Keeps the list and tells everybody.
    fn changed(&self) -> Result<(), Refusal> {
        self.bell.notify_all();
        self.tell_pages();
        let _turn = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let text = serde_json::to_vec_pretty(&*self.list())?;
        Ok(write_whole(&file(&self.workspace), &text)?)
    }

    fn tell_pages(&self) {
        self.hub.tell(&Event::Jobs { jobs: self.all() });
    }

    /// Changes a training of the list, and tells everybody.
    fn update(&self, id: u32, change: impl FnOnce(&mut Job)) {
        if let Some(entry) = self.list().entries.iter_mut().find(|entry| entry.job.id == id) {
            change(&mut entry.job);
        }
        self.tell_pages();
    }

    /// The same, and keeps it. A list that cannot be written is worth a word, not the training.
    fn update_and_keep(&self, id: u32, change: impl FnOnce(&mut Job)) {
        self.update(id, change);
        if let Err(refusal) = self.changed() {
            self.update(id, |job| job.news.push(refusal.message));
        }
    }

    /// What it was told and has not done yet.
    fn told(&self, id: u32) -> Option<Step> {
        self.list().entries.iter().find(|entry| entry.job.id == id)?.told
    }

    fn take_told(&self, id: u32) -> Option<Step> {
        self.list().entries.iter_mut().find(|entry| entry.job.id == id)?.told.take()
    }

    /// Ends what is under way with a checkpoint, and begins nothing more; the next studio in this folder goes on.
    pub fn close(&self) {
        self.is_closing.store(true, Ordering::Relaxed);
        // Whoever waits for the bell has looked at the list before, or sees this.
        drop(self.list());
        self.bell.notify_all();
    }

    fn is_closing(&self) -> bool {
        self.is_closing.load(Ordering::Relaxed)
    }

    /// Trains one after the other until the studio ends: the thread of the trainings.
    pub fn work(&self) {
        while let Some(entry) = self.next() {
            let id = entry.job.id;
            // A fault in one training costs nobody the others.
            let state = match catch_unwind(AssertUnwindSafe(|| self.carry_out(&entry))) {
                Ok(Ok(state)) => state,
                Ok(Err(refusal)) => JobState::Failed { message: refusal.message },
                Err(_) => JobState::Failed { message: "the training failed; this is a fault of Myo, not yours".into() },
            };
            let told = self.take_told(id);
            let was_cut = self.is_closing() && told.is_none() && is_unfinished(&state);
            self.settle(id, if was_cut { JobState::Waiting } else { state });
            if told == Some(Step::Dismiss) {
                let _ = self.tell(id, Step::Dismiss);
            }
            self.hub.tell(&Event::Runs);
        }
    }

    /// How a training stands in the end. A live one whose task was changed in the last moment goes on.
    fn settle(&self, id: u32, state: JobState) {
        if let Some(entry) = self.list().entries.iter_mut().find(|entry| entry.job.id == id) {
            let goes_on = entry.next.is_some() && matches!(state, JobState::Done { .. });
            entry.job.state = if goes_on { JobState::Waiting } else { state };
        }
        self.update_and_keep(id, |_| ());
    }

    /// A run has another name now, or none.
    ///
    /// # Errors
    /// The list cannot be written.
    pub fn renamed(&self, run: &str, to: Option<&str>) -> Result<(), Refusal> {
        let mut list = self.list();
        for entry in &mut list.entries {
            if entry.job.run.as_deref() == Some(run) {
                entry.job.run = to.map(str::to_owned);
                // A user that is gone goes on with nothing.
                entry.job.live &= to.is_some();
            }
            if entry.order.from.as_deref() == Some(run) {
                entry.order.from = to.map(str::to_owned);
            }
        }
        drop(list);
        self.changed()
    }

    /// The next one that waits, once there is one; none once the studio ends.
    fn next(&self) -> Option<Entry> {
        let mut list = self.list();
        loop {
            if self.is_closing() {
                return None;
            }
            if let Some(entry) = list.entries.iter_mut().find(|entry| entry.job.state == JobState::Waiting) {
                (entry.job.state, entry.told) = (JobState::Preparing, None);
                let entry = entry.clone();
                drop(list);
                self.tell_pages();
                return Some(entry);
            }
            list = self.bell.wait(list).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Trains one to its end; a live one through all its tasks.
    fn carry_out(&self, entry: &Entry) -> Result<JobState, Refusal> {
        let id = entry.job.id;
        let mut training = self.prepare(entry)?;
        loop {
            match self.train(id, training)? {
                Over::So(state) => return Ok(state),
                Over::Changed(checkpoint) => training = self.prepare_next(id, *checkpoint)?,
            }
        }
    }

    /// Trains one task to its end, or until there is another.
    fn train(&self, id: u32, training: Training) -> Result<Over, Refusal> {
        let told = || self.told(id);
        let stop = || !self.is_closing() && !matches!(told(), Some(Step::Stop | Step::Dismiss));
        let mut following = Following::new(&training);
        let Training { mut session, task, model, .. } = training;
        self.stage.enter(id, &model, &task, session.trainer().policy(), session.trainer().env_steps());
        self.update_and_keep(id, |job| job.state = JobState::Training);
        self.hub.tell(&Event::Runs);
        if session.trainer().inherited().is_some() && session.trainer().updates() == 0 {
            following.before = session
                .measure(FIRST_LOOK, 1, &stop)?
                .map(|seen| Before { success: seen.success, episode_s: seen.episode_length_s });
            let first = following.at_first();
            self.update(id, |job| job.progress = Some(first));
        }
        loop {
            self.wait_while_paused(id);
            if self.has_next(id) {
                let heir = session.trainer().save()?;
                // Should what comes next not begin, nothing of this is lost.
                session.conclude(End::Interrupted, &|| false)?;
                return Ok(Over::Changed(Box::new(heir)));
            }
            let progress = session.advance(&stop)?;
            following.doubling = session.trend().map(doubling);
            if self.stage.wants(id) {
                self.stage.renew(id, || session.trainer().policy(), session.trainer().env_steps());
            }
            for news in &progress.news {
                let sentence = sentence(news, &task, &model)?;
                self.update(id, |job| job.news.push(sentence));
            }
            if let Some(now) = following.after(&progress) {
                self.update(id, |job| job.progress = Some(now));
            }
            if let Some(end) = progress.end.clone() {
                self.stage.renew(id, || session.trainer().policy(), session.trainer().env_steps());
                let last = following.last(&progress);
                self.update(id, |job| {
                    job.progress = last.or(job.progress.take());
                    if end != End::Interrupted {
                        job.state = JobState::Evaluating;
                    }
                });
                // A change of the task cuts the last evaluation short.
                let stop = || stop() && !self.has_next(id);
                let heir = session.trainer().save()?;
                let outcome = session.conclude(end, &stop)?;
                return Ok(if self.has_next(id) { Over::Changed(Box::new(heir)) } else { Over::So(state(&outcome)) });
            }
        }
    }

    fn has_next(&self, id: u32) -> bool {
        self.list().entries.iter().any(|entry| entry.job.id == id && entry.next.is_some())
    }

    /// Makes a training of an order, or takes its run up again.
    fn prepare(&self, entry: &Entry) -> Result<Training, Refusal> {
        let Entry { job, order, next, .. } = entry;
        let mut notices = Vec::new();
        let training = match (&job.run, next) {
            (Some(run), Some(_)) => self.prepare_next(job.id, Heritage::of(self.workspace.run(run)?)?.checkpoint)?,
            (Some(run), None) => Training::resume(&self.workspace.run(run)?, &mut |notice| notices.push(notice))?,
            (None, _) => {
                let heir_to = order.from.as_deref().map(|run| Heritage::of(self.workspace.run(run)?)).transpose()?;
                let run = self.workspace.free_run(&order.name);
                let training = self.begin(order, &order.text, heir_to, &run, &mut notices)?;
                self.update_and_keep(job.id, |job| job.run = Some(run));
                training
            }
        };
        self.update(job.id, |job| job.news.append(&mut notices));
        Ok(training)
    }

    /// The user of a training begins the task that came last. What it was told of the one before is forgotten.
    fn prepare_next(&self, id: u32, checkpoint: Checkpoint) -> Result<Training, Refusal> {
        let mut list = self.list();
        let gone = || Refusal::sentence("this training is not in the list any more");
        let entry = list.entries.iter_mut().find(|entry| entry.job.id == id).ok_or_else(gone)?;
        let text = entry.next.clone().unwrap_or_else(|| entry.order.text.clone());
        entry.job.news.clear();
        entry.job.state = JobState::Preparing;
        // What it was told was about the task of before, unless it was to end.
        entry.told = entry.told.filter(|told| matches!(told, Step::Stop | Step::Dismiss));
        let (mut order, run) = (entry.order.clone(), entry.job.run.clone());
        order.settings = entry.next_settings.clone().unwrap_or(order.settings);
        drop(list);
        self.changed()?;
        let run = run.ok_or_else(gone)?;
        let heir_to = Some(Heritage { run: self.workspace.run(&run)?, checkpoint });
        let mut notices = Vec::new();
        let training = self.begin(&order, &text, heir_to, &run, &mut notices);
        let order = training.is_ok().then_some(JobOrder { text: text.clone(), ..order });
        self.has_begun(id, &text, order);
        let training = training?;
        self.update_and_keep(id, |job| job.news.append(&mut notices));
        Ok(training)
    }

    /// A task waits no longer once its training is whole, or cannot be: a studio that is killed before begins it again. Without an order
    /// all stays as it was before.
    fn has_begun(&self, id: u32, text: &str, order: Option<JobOrder>) {
        if let Some(entry) = self.list().entries.iter_mut().find(|entry| entry.job.id == id) {
            if entry.next.as_deref() == Some(text) {
                (entry.next, entry.next_settings) = (None, None);
            }
            entry.order = order.unwrap_or_else(|| entry.order.clone());
        }
    }

    fn begin(
        &self,
        order: &JobOrder,
        text: &str,
        heir_to: Option<Heritage>,
        run: &str,
        notices: &mut Vec<String>,
    ) -> Result<Training, Refusal> {
        let task = self.workspace.read(text)?.task;
        let goal = Goal {
            until: order.until.parse()?,
            steps: order.steps.unwrap_or_else(|| default_steps(task.control_dt_s)),
        };
        let (model, settings, backend) = (self.bodies.of(&task)?, &order.settings, &self.backend);
        let beginning = Beginning { task: &task, model: &model, backend, settings, seed: order.seed, goal, heir_to };
        Training::begin(beginning, &self.workspace.run(run)?, &mut |notice| notices.push(notice))
    }

    fn wait_while_paused(&self, id: u32) {
        if self.told(id) != Some(Step::Pause) {
            return;
        }
        self.update_and_keep(id, |job| job.state = JobState::Paused);
        let mut list = self.list();
        while !self.is_closing()
            && list.entries.iter().any(|entry| entry.job.id == id && entry.told == Some(Step::Pause))
        {
            list = self.bell.wait(list).unwrap_or_else(PoisonError::into_inner);
        }
        drop(list);
        self.update_and_keep(id, |job| job.state = JobState::Training);
    }
}

impl Entry {
    fn is_under_way(&self) -> bool {
        use JobState::{Evaluating, Paused, Preparing, Training};
        matches!(self.job.state, Preparing | Training | Paused | Evaluating)
    }
}

/// Whether a training was cut short: before its end, or in its last evaluation.
fn is_unfinished(state: &JobState) -> bool {
    matches!(state, JobState::Stopped | JobState::Done { success: None, .. })
}

/// Refuses settings that no learner can have.
fn check_settings(settings: &Changes) -> Result<(), Refusal> {
    Ok(changed_settings(&PpoConfig::default(), changes(settings)).map(drop)?)
}

/// Settings by name, as the learner takes them.
pub fn changes(settings: &Changes) -> impl Iterator<Item = (&str, serde_json::Value)> {
    settings.iter().map(|(name, value)| (&**name, value.clone()))
}

/// What of the settings of a run is not as it comes; the widths of its layers stay with the user.
fn changed_in(run: &RunFolder) -> Result<Changes, Refusal> {
    let usual = PpoConfig::for_user(RunDescription::of(run)?.task.user);
    let (own, default) = (serde_json::to_value(&run.config().ppo)?, serde_json::to_value(usual)?);
    let serde_json::Value::Object(own) = own else { return Ok(Changes::new()) };
    let differs =
        |name: &str, value: &serde_json::Value| default.get(name) != Some(value) && !name.ends_with("_hidden");
    Ok(own.into_iter().filter(|(name, value)| differs(name, value)).collect())
}

fn doubling(trend: Trend) -> Doubling {
    let Change { success, episode_time, .. } = trend.last_doubling;
    Doubling { success, episode_time, is_plateau: trend.is_plateau() }
}

fn file(workspace: &Workspace) -> PathBuf {
    workspace.folder().join("studio.json")
}

/// How a training stands after its end.
fn state(outcome: &Outcome) -> JobState {
    match &outcome.end {
        End::Interrupted => JobState::Stopped,
        End::DeviceLost { reason } => JobState::Failed {
            message: format!("the graphics card was lost: {reason}; resume it to go on from its newest checkpoint"),
        },
        end => JobState::Done {
            by: end.name().into(),
            success: outcome.evaluation.as_ref().and_then(|evaluation| evaluation.success),
            episode_s: outcome.evaluation.as_ref().and_then(|evaluation| evaluation.episode_length_s),
        },
    }
}

/// News, for people: what was seen, then the likely cause.
fn sentence(news: &News, task: &myo_tasks::Task, model: &myo_model::Model) -> Result<String, Refusal> {
    Ok(match news {
        News::WentBack { .. } => news.to_string(),
        News::Flat { recent, .. } => {
            format!("{news}\n{}", likely_cause(task, &ModelReach::for_task(model, task)?, recent))
        }
    })
}
