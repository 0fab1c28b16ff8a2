//! Reader of MJCF, the model format of MuJoCo.
//!
//! Text in, a typed tree out: [`read`] gives an [`Mjcf`] whose elements know their [`Place`] and say what file and default
//! classes say together. Includes are spliced, frames folded into what they hold, copies made, other models attached;
//! angles are in rad and orientations are unit quaternions. Each field is `None` where nobody has said anything; the
//! method of the same name then gives MuJoCo's default.
//!
//! ```
//! use myo_mjcf::{Limits, Shape, read_from};
//! use std::collections::BTreeMap;
//!
//! let text = r#"<mujoco>
//!   <default><geom size="0.02"/></default>
//!   <worldbody>
//!     <body name="ulna" pos="0 0 0.3">
//!       <joint name="elbow" axis="0 1 0" range="0 130"/>
//!       <geom type="capsule" fromto="0 0 0 0 0 -0.25"/>
//!     </body>
//!   </worldbody>
//! </mujoco>"#;
//! let files = BTreeMap::from([("arm.xml".to_owned(), text.to_owned())]);
//! let model = read_from(&files, "arm.xml", Limits::default())?;
//!
//! let ulna = &model.bodies[1];
//! assert_eq!(ulna.joints[0].range(), [0.0, 130_f64.to_radians()]);
//! assert_eq!((ulna.geoms[0].kind(), ulna.geoms[0].size()), (Shape::Capsule, [0.02, 0.125, 0.0]));
//! assert_eq!(ulna.geoms[0].place.to_string(), "arm.xml:6:7");
//! # Ok::<(), myo_mjcf::MjcfError>(())
//! ```
//!
//! Whatever MuJoCo would not know is an error with file, line and column, and the nearest name that would be right. What
//! MuJoCo knows and this crate does not (plugins, flexible bodies and so on) is listed in [`Mjcf::refused`]. No file can
//! exhaust the machine: see [`Limits`]. No file outside the folder of the model is opened: see [`Folder`].
//!
//! [`Mesh::triangles`] opens the files of meshes.
//!
//! This crate knows no simulation and no inertia of shapes or meshes, and does not look up what elements
//! refer to.
mod attach;
mod check;
mod classes;
mod document;
mod elements;
mod error;
mod files;
mod include;
mod leaves;
mod limits;
mod mesh;
mod mjcf;
mod names;
mod nearest;
mod place;
mod pose;
mod read;
mod reading;
mod replicate;
mod scan;
mod sections;
mod table;
mod tree;
mod value;

pub use elements::*;
pub use error::MjcfError;
pub use files::{FileError, Files, Folder};
pub use limits::Limits;
pub use mesh::{MeshError, Triangles};
pub use mjcf::{Mjcf, Refused};
pub use myo_nearest::Nearest;
pub use place::{Kind, Place, Spot};
pub use pose::Pose;
pub use value::{Auto, Count, Switch};

use document::Document;
use limits::Budget;
use read::{Reader, Wanted};
use std::path::Path;

/// Reads a model file; nothing outside its folder is opened.
pub fn read(path: &Path) -> Result<Mjcf, MjcfError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    read_below(folder, path)
}

/// Reads a model file; nothing outside the folder `root` is opened.
pub fn read_below(root: &Path, path: &Path) -> Result<Mjcf, MjcfError> {
    let failed = |why| MjcfError::Main { path: path.display().to_string(), why };
    let folder = Folder::new(root).map_err(failed)?;
    let main = folder.relative(path).map_err(failed)?;
    read_from(&folder, &main, Limits::default())
}

/// Reads the model whose main file is `main`, a path as `files` take it.
pub fn read_from(files: &dyn Files, main: &str, limits: Limits) -> Result<Mjcf, MjcfError> {
    let mut budget = Budget::new(limits);
    let document = Document::load(files, main, 0, &mut budget)?;
    Reader::new(files, &document, &mut budget, 0, Vec::new()).read(Wanted::All)
}
