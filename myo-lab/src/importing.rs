//! Bodies of MuJoCo's files, as `myo model import` and `myoenv.import_model` have them.

use std::path::{Path, PathBuf};

use myo_dynamics::{CouplingMode, Plan, PlanError};
use myo_mjcf::{FileError, Folder, MeshError, Mjcf, MjcfError, read_below};
use myo_model::description::Look;
use myo_model::import::{ImportOptions, Unsupported, from_mjcf, from_mjcf_in, looks, unused};
use myo_model::{Model, ModelDescription, ModelError};
use thiserror::Error;

/// A body that can be simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// What a model file says of it.
    pub description: ModelDescription,
    /// What of the file has no part in the simulation, such as `7 cameras`.
    pub passed_over: Vec<String>,
}

/// Why there is none.
#[derive(Debug, Error)]
pub enum ImportError {
    /// The file cannot be read, or is no MJCF.
    #[error(transparent)]
    Read(#[from] MjcfError),
    /// What cannot be simulated, all of it.
    #[error("{}", told(.all))]
    Unsupported {
        /// Each thing, where it stands in files below a folder.
        all: Vec<Unsupported>,
    },
    /// What is no body.
    #[error("{}: {why}", file.display())]
    Model {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        why: ModelError,
    },
    /// It cannot be simulated as a whole.
    #[error("{}: {why}", file.display())]
    Plan {
        /// The file.
        file: PathBuf,
        /// Why.
        why: PlanError,
    },
}

/// What cannot be simulated is told so often at most.
const MOST_TOLD: usize = 20;

fn told(all: &[Unsupported]) -> String {
    let mut sentences: Vec<String> = all.iter().take(MOST_TOLD).map(ToString::to_string).collect();
    sentences.extend(more_than_told(all));
    sentences.join("\n")
}

impl ImportError {
    /// How many things are told of one by one, and a sentence about the others.
    pub fn told(all: &[Unsupported]) -> (&[Unsupported], Option<String>) {
        (&all[..all.len().min(MOST_TOLD)], more_than_told(all))
    }
}

fn more_than_told(all: &[Unsupported]) -> Option<String> {
    let more = all.len().checked_sub(MOST_TOLD).filter(|&more| more > 0)?;
    Some(format!("and {more} more like these"))
}

/// What is seen of bodies. Meshes that cannot be read are told; without them a body has no less part in the simulation.
fn seen(mjcf: &Mjcf, root: &Path, passed_over: &mut Vec<String>) -> Vec<Look> {
    let (looks, unread) = match Folder::new(root) {
        Ok(folder) => looks(mjcf, &folder),
        Err(why) => (vec![], vec![MeshError::File { file: root.display().to_string(), why }]),
    };
    if let Some(first) = unread.first() {
        let hint = match first {
            MeshError::File { why: FileError::Outside, .. } => " (`--root FOLDER`, `root=` in Python)",
            _ => "",
        };
        passed_over.push(format!("meshes of {} geom(s), which cannot be read: {first}{hint}", unread.len()));
    }
    looks
}

/// Reads a body from a file of MuJoCo's, opens no file outside of `root`, or of the file's folder without it, and tries out what it is.
///
/// # Errors
/// As [`ImportError`] has it.
pub fn import_model(file: &Path, root: Option<&Path>, options: &ImportOptions) -> Result<Imported, ImportError> {
    let root = root.unwrap_or_else(|| file.parent().unwrap_or(Path::new("")));
    let here = if root.as_os_str().is_empty() { Path::new(".") } else { root };
    let mjcf = read_below(here, file)?;
    let described = match Folder::new(here) {
        Ok(folder) => from_mjcf_in(&mjcf, options, &folder),
        Err(_) => from_mjcf(&mjcf, options),
    };
    let mut description = described.map_err(|all| ImportError::Unsupported { all })?;
    let mut passed_over: Vec<String> =
        unused(&mjcf, &description).iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    description.looks = seen(&mjcf, here, &mut passed_over);
    let named = || file.to_owned();
    let model = Model::new(&description).map_err(|why| ImportError::Model { file: named(), why })?;
    Plan::exact(&model, CouplingMode::Reduced)
        .and_then(|plan| plan.try_out())
        .map_err(|why| ImportError::Plan { file: named(), why })?;
    Ok(Imported { description, passed_over })
}
