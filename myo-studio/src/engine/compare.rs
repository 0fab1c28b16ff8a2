//! Runs by what their users learnt, and what tells the layouts apart.

use std::path::{Path, PathBuf};

use myo_lab::{Comparison, Difference, Group, Quantity, RunDescription, find_runs};
use myo_tasks::Task;
use myo_train::session::{Goal, Until};
use myo_train::statistics::Sample;
use myo_train::{PpoConfig, RunFolder, TargetEvaluation};

use super::workspace::Workspace;
use crate::protocol::{Against, Contrast, LayoutRow, LayoutTable, LeftOut, Mean, Refusal, StepRow, UserRow};

/// Runs that may be compared with one another: of the same layouts, trained in the same way.
struct Kin {
    way: Way,
    names: Vec<String>,
    runs: Vec<RunFolder>,
}

/// What users learnt, and how.
#[derive(PartialEq)]
struct Way {
    layouts: Vec<Task>,
    ppo: PpoConfig,
    goal: Goal,
    /// Whether they had learnt something else before.
    is_heir: bool,
}

impl Way {
    fn of(run: &RunFolder) -> Result<Self, Refusal> {
        let description = RunDescription::of(run)?;
        let (goal, is_heir) = (description.goal(), description.from.is_some());
        Ok(Self { layouts: description.layouts(), ppo: run.config().ppo.clone(), goal, is_heir })
    }

    /// What tells it from others of the same layout, for people.
    fn words(&self) -> String {
        let goal = match self.goal.until {
            Until::Plateau => String::new(),
            until => format!("until {until}"),
        };
        let heir = if self.is_heir { "learnt something else before" } else { "" };
        let settings = if self.is_as_it_comes() { "" } else { "other settings" };
        [&goal, heir, settings].into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(", ")
    }

    /// Whether its settings are those of its kind of users, but for how many environments a device has.
    fn is_as_it_comes(&self) -> bool {
        let PpoConfig { num_envs, matrix_units, .. } = self.ppo;
        self.ppo == PpoConfig { num_envs, matrix_units, ..PpoConfig::for_user(self.layouts[0].user) }
    }
}

/// What the groups are called: like their layouts, with what tells those of one layout apart.
fn names(kin: &[Kin]) -> Vec<String> {
    let layout = |kin: &Kin| kin.way.layouts[0].name.clone();
    let mut names: Vec<String> = Vec::new();
    for own in kin {
        let is_alone = kin.iter().filter(|other| layout(other) == layout(own)).count() == 1;
        let words = if is_alone { String::new() } else { own.way.words() };
        let name = if words.is_empty() { layout(own) } else { format!("{} ({words})", layout(own)) };
        names.push(distinct(&names, name));
    }
    names
}

/// A name that none of the others has: what comes again has its number, `press l`, `press l (2)`.
fn distinct(others: &[String], name: String) -> String {
    let numbered = (2..).map(|k| format!("{name} ({k})"));
    std::iter::once(name.clone()).chain(numbered).find(|name| !others.contains(name)).unwrap_or(name)
}

/// The layouts of these runs, each a name and a folder. What cannot be read or is not evaluated is left out, and told.
pub fn table(runs: &[(String, PathBuf)]) -> LayoutTable {
    let (mut kin, mut left_out): (Vec<Kin>, Vec<LeftOut>) = (vec![], vec![]);
    for (name, folder) in runs {
        match sorted_in(&mut kin, name, folder) {
            Ok(()) => {}
            Err(refusal) => left_out.push(LeftOut { run: name.clone(), reason: refusal.message }),
        }
    }
    let names = names(&kin);
    let mut groups: Vec<(Group, Kin)> = Vec::new();
    for (kin, name) in kin.into_iter().zip(names) {
        match Group::of_runs(name, &kin.runs) {
            Ok(group) => groups.push((group, kin)),
            Err(error) => {
                left_out.extend(kin.names.iter().map(|run| LeftOut { run: run.clone(), reason: error.to_string() }));
            }
        }
    }
    let layouts = groups.iter().enumerate().map(|(index, (group, kin))| {
        let against = (index > 0).then(|| against(&Comparison::new(&groups[0].0, group)));
        row(group, kin, against)
    });
    LayoutTable { layouts: layouts.collect(), left_out }
}

/// Puts a run to those that it may be compared with.
fn sorted_in(kin: &mut Vec<Kin>, name: &str, folder: &Path) -> Result<(), Refusal> {
    let run = RunFolder::open(folder)?;
    let way = Way::of(&run)?;
    if run.evaluation()?.is_none() {
        return Err(Refusal::sentence("it is not evaluated yet; go on with it first"));
    }
    let place = kin.iter().position(|kin| kin.way == way);
    let place = place.unwrap_or_else(|| {
        kin.push(Kin { way, names: vec![], runs: vec![] });
        kin.len() - 1
    });
    // Two of one seed say no more than one, and would make chance look small.
    let twin = kin[place].runs.iter().position(|other| other.config().seed == run.config().seed);
    if let Some(twin) = twin.filter(|_| !kin[place].way.is_heir) {
        let other = &kin[place].names[twin];
        return Err(Refusal::sentence(format!("it is the same user as {other}: task, seed and settings are the same")));
    }
    kin[place].names.push(name.to_owned());
    kin[place].runs.push(run);
    Ok(())
}

fn row(group: &Group, kin: &Kin, against: Option<Against>) -> LayoutRow {
    let users = group.users.iter().zip(&kin.runs).zip(&kin.names).map(|((user, run), name)| UserRow {
        run: name.clone(),
        seed: run.config().seed,
        success: user.evaluation.success,
        episode_s: user.evaluation.episode_length_s,
        effort: user.evaluation.effort,
        fatigue: user.evaluation.fatigue,
    });
    let over = |quantity: Quantity| {
        let most = if quantity == Quantity::Success { 1.0 } else { f64::INFINITY };
        mean(group.users.iter().map(|user| quantity.of(user)), most)
    };
    LayoutRow {
        name: group.name.clone(),
        users: users.collect(),
        success: over(Quantity::Success),
        episode_s: over(Quantity::EpisodeLengthS),
        effort: over(Quantity::Effort),
        fatigue: over(Quantity::Fatigue),
        steps: steps(group),
        against,
    }
}

/// Each step over users; none where a run has several layouts, whose steps are not the same.
fn steps(group: &Group) -> Vec<StepRow> {
    let (1, Ok(flat)) = (group.run.layouts().len(), group.run.task.flat()) else { return vec![] };
    let mut labels: Vec<String> = Vec::new();
    for index in 0..flat.steps.len() {
        labels.push(distinct(&labels, flat.label(index)));
    }
    let step = |(index, label): (usize, String)| {
        let of = |value: fn(&TargetEvaluation) -> Option<f64>, most| {
            mean(group.users.iter().map(|user| user.evaluation.targets.get(index).and_then(value)), most)
        };
        StepRow {
            label,
            success: of(|target| Some(target.success), 1.0),
            movement_time_s: of(|target| target.movement_time_s, f64::INFINITY),
        }
    };
    labels.into_iter().enumerate().map(step).collect()
}

/// Mean of a quantity from zero to `most`: no range leaves these bounds, however few users there are.
fn mean(values: impl Iterator<Item = Option<f64>>, most: f64) -> Option<Mean> {
    let Sample { mean, interval, .. } = Sample::of(&values.flatten().collect::<Vec<_>>())?;
    Some(Mean { mean, interval: interval.map(|ends| ends.map(|x| x.clamp(0.0, most))) })
}

fn against(comparison: &Comparison) -> Against {
    let contrast = |difference: &Difference| Contrast {
        quantity: word(&difference.quantity),
        difference: difference.difference,
        interval: difference.interval,
        verdict: word(&difference.verdict),
    };
    Against {
        contrasts: comparison.differences.iter().map(contrast).collect(),
        sentences: comparison.sentences().collect(),
        caveats: comparison.caveats.clone(),
    }
}

/// The word for it in JSON.
fn word(value: &impl serde::Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|word| Some(word.as_str()?.to_owned())).unwrap_or_default()
}

/// Runs whose users learn a task as it is, or did, whatever came of it; damaged ones are nobody's.
///
/// # Errors
/// The folder cannot be read.
pub fn runs_of(workspace: &Workspace, task: &Task) -> Result<Vec<RunFolder>, Refusal> {
    let folder = workspace.runs();
    if !folder.exists() {
        return Ok(vec![]);
    }
    let of_task = |path: &Path| {
        let run = RunFolder::open(path).ok()?;
        let layouts = RunDescription::of(&run).ok()?.layouts();
        (layouts == std::slice::from_ref(task)).then_some(run)
    };
    Ok(find_runs(&folder)?.iter().filter_map(|run| of_task(&run.path)).collect())
}

/// Runs whose users have learnt a task as it is from nothing, up to a goal and with the settings as they come, by name.
///
/// # Errors
/// The folder cannot be read.
pub fn users_of(workspace: &Workspace, task: &Task, until: Until) -> Result<Vec<String>, Refusal> {
    let counts = |run: &RunFolder| {
        let way = Way::of(run).ok().filter(|way| way.goal.until == until && !way.is_heir && way.is_as_it_comes());
        way.is_some() && matches!(run.evaluation(), Ok(Some(_)))
    };
    let mut seeds = Vec::new();
    let mut is_new = |run: &RunFolder| {
        let is_new = !seeds.contains(&run.config().seed);
        seeds.push(run.config().seed);
        is_new
    };
    let mut runs = runs_of(workspace, task)?;
    runs.retain(counts);
    runs.retain(|run| is_new(run));
    Ok(runs.iter().map(|run| workspace.name_of(run.path())).collect())
}
