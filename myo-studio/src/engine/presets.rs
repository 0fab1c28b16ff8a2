//! The tasks that come with the program, as cards.

use std::sync::OnceLock;

use myo_env::{CpuEnv, EnvConfig, StepStorage, VectorEnv};
use myo_lab::picture::Painter;
use myo_model::builtin;
use myo_tasks::{Task, preset, preset_names, preset_text};
use rayon::prelude::*;

use super::replay::at_rest;
use crate::protocol::{PresetCard, Refusal};

/// A card of each.
pub fn cards() -> &'static [PresetCard] {
    static CARDS: OnceLock<Vec<PresetCard>> = OnceLock::new();
    CARDS.get_or_init(|| preset_names().into_par_iter().filter_map(card).collect())
}

fn card(name: &str) -> Option<PresetCard> {
    let (task, text) = (preset(name)?, preset_text(name)?);
    Some(PresetCard {
        name: name.to_owned(),
        description: task.description.clone(),
        text: text.to_owned(),
        steps: task.flat().map_or(0, |flat| flat.steps.len()),
        picture: picture(&task).unwrap_or_default(),
    })
}

/// The user before the first movement.
fn picture(task: &Task) -> Result<String, Refusal> {
    let model = task.embody(&builtin(&task.model)?)?;
    let mut env = CpuEnv::new(&model, &at_rest(task), &EnvConfig { num_envs: 1, seed: 1, ..EnvConfig::default() })?;
    let mut step = StepStorage::new(env.spec());
    env.reset(Some(1), None, &mut step.observation)?;
    let moment = env.peek(0..1)?.remove(0);
    Ok(Painter::new(&model, task)?.moment(&moment)?.svg())
}
