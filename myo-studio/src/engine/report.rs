//! A report: the page of runs with everything that it asks already answered, as one file.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use myo_lab::RunDescription;
use myo_train::RunFolder;

use super::workspace::seconds;
use super::{compare, look, motion, replay, runs};
use crate::pages;
use crate::protocol::{LeftOut, Recorded, RecordedMotion, RecordedRun, Refusal, Replay};

/// The episode that a report shows.
const SEED: u32 = 1;
/// Where the page has what was recorded.
const PLACE: &str = "\"MYO_RECORDED\"";

/// A page (HTML) on runs, each a name and a folder.
///
/// # Errors
/// None of the runs can be read, or the pages are not in this program.
pub fn report(runs: &[(String, PathBuf)]) -> Result<String, Refusal> {
    let page = pages::report()?;
    let mut table = compare::table(runs);
    let (mut whole, mut first) = (Vec::new(), None);
    for (name, folder) in runs {
        match recorded(name, folder) {
            Ok(run) => whole.push(run),
            // One that cannot be read hides no other.
            Err(refusal) => {
                if table.left_out.iter().all(|left| left.run != *name) {
                    table.left_out.push(LeftOut { run: name.clone(), reason: refusal.message.clone() });
                }
                first = first.or(Some(refusal));
            }
        }
    }
    if let (true, Some(refusal)) = (whole.is_empty(), first) {
        return Err(refusal);
    }
    let (version, made_s) = (env!("CARGO_PKG_VERSION").into(), seconds(SystemTime::now()));
    let recorded = Recorded { version, made_s, runs: whole, table };
    // No word of a task may end the script that holds it.
    let json = serde_json::to_string(&recorded)?.replace('<', "\\u003c");
    Ok(page.replacen(PLACE, &json, 1))
}

fn recorded(name: &str, folder: &Path) -> Result<RecordedRun, Refusal> {
    let detail = runs::detail_of(folder, name)?;
    let run = RunFolder::open(folder)?;
    let (model, task) = (RunDescription::of(&run)?.body()?, RunDescription::of(&run)?.task);
    let view = look::look(&detail.text).view;
    let view = view.ok_or_else(|| Refusal::sentence(format!("the task of {name} cannot be shown")))?;
    let body = motion::shape(&model, &task)?;
    let has_checkpoint = !detail.checkpoints.is_empty();
    let motion = has_checkpoint.then(|| episode(name, folder)).transpose()?;
    let efforts = if has_checkpoint { replay::efforts(folder, name)? } else { vec![] };
    Ok(RecordedRun { detail, view, body, efforts, motion })
}

fn episode(name: &str, folder: &Path) -> Result<RecordedMotion, Refusal> {
    let asked = Replay { run: name.to_owned(), seed: SEED, env_steps: None };
    let (header, numbers) = replay::replay(folder, &asked)?;
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    Ok(RecordedMotion { header, numbers: STANDARD.encode(bytes) })
}
