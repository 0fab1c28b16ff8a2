//! Runs by what their users learnt, and what tells the layouts apart.

use std::path::PathBuf;

use myo_lab::{Comparison, Difference, Group, Quantity, RunDescription, find_runs};
use myo_tasks::Task;
use myo_train::statistics::Sample;
use myo_train::{PpoConfig, RunFolder, TargetEvaluation};

use super::workspace::Workspace;
use crate::protocol::{Against, Contrast, LayoutRow, LayoutTable, LeftOut, Mean, Refusal, StepRow, UserRow};

/// Runs that may be compared with one another: of the same layouts, trained in the same way.
struct Kin {
    layouts: Vec<Task>,
    ppo: PpoConfig,
    names: Vec<String>,
    runs: Vec<RunFolder>,
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
    let names = myo_lab::layout_names(&kin.iter().map(|kin| kin.layouts[0].clone()).collect::<Vec<_>>());
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
fn sorted_in(kin: &mut Vec<Kin>, name: &str, folder: &std::path::Path) -> Result<(), Refusal> {
    let run = RunFolder::open(folder)?;
    let layouts = RunDescription::of(&run)?.layouts();
    if run.evaluation()?.is_none() {
        return Err(Refusal::sentence("it is not evaluated yet; go on with it first"));
    }
    let ppo = run.config().ppo.clone();
    let place = kin.iter().position(|kin| kin.layouts == layouts && kin.ppo == ppo);
    let place = place.unwrap_or_else(|| {
        kin.push(Kin { layouts, ppo, names: vec![], runs: vec![] });
        kin.len() - 1
    });
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
        steps: steps(group),
        against,
    }
}

/// Each step over users; none where a run has several layouts, whose steps are not the same.
fn steps(group: &Group) -> Vec<StepRow> {
    let ([task], Ok(flat)) = (&group.run.layouts()[..], group.run.task.flat()) else { return vec![] };
    debug_assert_eq!(task.name, group.run.task.name);
    let step = |index: usize| {
        let of = |value: fn(&TargetEvaluation) -> Option<f64>, most| {
            mean(group.users.iter().map(|user| user.evaluation.targets.get(index).and_then(value)), most)
        };
        StepRow {
            label: flat.label(index),
            success: of(|target| Some(target.success), 1.0),
            movement_time_s: of(|target| target.movement_time_s, f64::INFINITY),
        }
    };
    (0..flat.steps.len()).map(step).collect()
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

/// Runs whose users learnt a task as it is, by name; damaged ones are nobody's.
///
/// # Errors
/// The folder cannot be read.
pub fn users_of(workspace: &Workspace, task: &Task) -> Result<Vec<String>, Refusal> {
    let folder = workspace.runs();
    if !folder.exists() {
        return Ok(vec![]);
    }
    let is_of = |path: &std::path::Path| {
        let run = RunFolder::open(path).ok()?;
        (RunDescription::of(&run).ok()?.layouts() == std::slice::from_ref(task)).then_some(())
    };
    let found = find_runs(&folder)?;
    Ok(found.iter().filter(|run| is_of(&run.path).is_some()).map(|run| workspace.name_of(&run.path)).collect())
}
