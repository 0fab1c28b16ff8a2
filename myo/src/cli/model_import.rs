//! `myo model import`: a model file of one of MuJoCo.

use std::path::{Path, PathBuf};

use clap::Args;
use myo::model::description::{Landmarks, SideRule};
use myo::model::import::{ImportOptions, Unsupported};
use myo::tasks::SourceLocation;
use myo::train::write_whole;
use myo::{ImportError, Imported, import_model};

use super::failure::{Failure, Mistake, Result, complain};
use super::output::print_file;

/// Arguments of `myo model import`.
#[derive(Args)]
#[command(after_help = HELP)]
pub struct Import {
    /// MJCF file
    file: PathBuf,
    /// Site that points and presses
    #[arg(long, value_name = "SITE")]
    fingertip: String,
    /// Body whose origin is the centre of the shoulder, from which places are measured
    #[arg(long, value_name = "BODY")]
    shoulder: String,
    /// Body whose origin is the elbow, for rays from the forearm; with the wrist, a person is drawn around the arm, who faces along x
    #[arg(long, value_name = "BODY")]
    elbow: Option<String>,
    /// Body whose origin is the wrist, for rays
    #[arg(long, value_name = "BODY")]
    wrist: Option<String>,
    /// Another finger, by the name that tasks have for it; once for each, at most four [example: thumb=THtip_r]
    #[arg(long, value_name = "NAME=SITE", value_parser = named)]
    finger: Vec<(String, String)>,
    /// Let parts of the body pass through each other
    #[arg(long)]
    without_contacts: bool,
    /// How side sites tell ways around wraps: as MuJoCo since 4.0, or as before (`mujoco3`), for what was made with that
    #[arg(long, value_name = "RULE", default_value = "mujoco4")]
    side_rule: SideRule,
    /// Joint that stands still as in the pose of the file, with those that follow it; once for each [example: the free joint of a pelvis]
    #[arg(long, value_name = "JOINT")]
    lock: Vec<String>,
    /// Folder outside of which no file is opened [default: that of the file]
    #[arg(long, value_name = "FOLDER")]
    root: Option<PathBuf>,
    /// File to write [default: standard output]
    #[arg(long, short, value_name = "FILE")]
    out: Option<PathBuf>,
}

const HELP: &str = "\
Example:
  myo model import myoarm_r.xml --fingertip IFtip_r --shoulder humerus_r --out myoarm.yaml
  myo train ours.yaml                           with `model: myoarm.yaml` in the task

Joints of all kinds, couplings of joints, tendons over sites, spheres and cylinders, muscles, and contacts of spheres, capsules and ellipsoids with each
other, planes and cylinders are simulated as MuJoCo 4.0 does. All else that has a part in the simulation (contacts of other shapes, springs of
tendons, motors and so on) is refused by name, file and line; what is only sensed, and what can never touch, is passed over. Meshes that are seen come along, coarser. Includes, classes, frames, copies and attached models are resolved.";

impl Import {
    /// Runs `myo model import`.
    pub fn run(&self) -> Result<()> {
        let landmarks = Landmarks {
            fingertip: self.fingertip.clone(),
            shoulder: self.shoulder.clone(),
            elbow: self.elbow.clone(),
            wrist: self.wrist.clone(),
            fingers: self.finger.iter().cloned().collect(),
        };
        let (without_contacts, locked) = (self.without_contacts, self.lock.clone());
        let options = ImportOptions { landmarks, without_contacts, side_rule: self.side_rule, locked };
        let root = self.root.as_deref();
        let Imported { description, passed_over } =
            import_model(&self.file, root, &options).map_err(|error| match error {
                ImportError::Unsupported { all } => {
                    refused(root.or_else(|| self.file.parent()).unwrap_or(Path::new("")), &all)
                }
                other => Failure::sentence(other.to_string()),
            })?;
        if !passed_over.is_empty() {
            complain(&format!("passed over, as they have no part in the simulation: {}", passed_over.join(", ")));
        }
        let text = description.to_yaml()?;
        match &self.out {
            Some(path) => Ok(write_whole(path, text.as_bytes())?),
            None => print_file(&text),
        }
    }
}

/// A name and what has it.
fn named(text: &str) -> std::result::Result<(String, String), String> {
    let (name, site) = text.split_once('=').ok_or("it is a name and a site, such as thumb=THtip_r")?;
    Ok((name.to_owned(), site.to_owned()))
}

/// All that cannot be simulated, each where it stands.
fn refused(root: &Path, all: &[Unsupported]) -> Failure {
    let mistake = |one: &Unsupported| {
        let file = root.join(&*one.place.file).display().to_string();
        let place = SourceLocation { file, line: one.place.line.into(), column: one.place.column.into() };
        Mistake::at(&place, &format!("{}: {}", one.element, one.what))
    };
    let (told, more) = ImportError::told(all);
    let mut mistakes: Vec<Mistake> = told.iter().map(mistake).collect();
    mistakes.extend(more.map(|message| Mistake { message, place: None, text: None, warning: false }));
    Failure::Mistakes(mistakes)
}
