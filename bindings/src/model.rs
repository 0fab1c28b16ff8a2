//! Models and their tables.

use std::collections::BTreeMap;
use std::path::PathBuf;

use myo::import_model;
use myo::model::description::Landmarks;
use myo::model::import::ImportOptions;
use myo::model::{ModelDescription, builtin, builtin_names};
use numpy::ndarray::{Array1, Array2, Array3};
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{self, compute};

/// Fingertip, shoulder, elbow, wrist, other fingers.
type LandmarkNames = (String, String, Option<String>, Option<String>, BTreeMap<String, String>);

/// A body: bodies, joints, sites, muscles.
#[pyclass(module = "myoenv", frozen)]
pub struct Model {
    description: ModelDescription,
    model: myo::model::Model,
}

impl Model {
    /// The model itself.
    pub fn inner(&self) -> &myo::model::Model {
        &self.model
    }

    /// As the body of a task's user.
    pub fn of(&self, task: &myo::tasks::Task) -> PyResult<myo::model::Model> {
        task.embody(&self.description).map_err(error::task)
    }

    /// As the body of the user of these layouts, who has one body.
    pub fn of_first(&self, layouts: &[myo::tasks::Task]) -> PyResult<myo::model::Model> {
        layouts.first().map_or_else(|| Ok(self.model.clone()), |task| self.of(task))
    }

    /// The description, unless it is that of the body which comes with the library under this name.
    pub fn unless_built_in(&self, name: &str) -> Option<ModelDescription> {
        let is_built_in = builtin(name).is_ok_and(|known| known == self.description);
        (!is_built_in).then(|| self.description.clone())
    }

    fn checked(description: ModelDescription) -> PyResult<Self> {
        let model = myo::model::Model::new(&description).map_err(error::task)?;
        Ok(Self { description, model })
    }
}

#[pymethods]
impl Model {
    /// A model that comes with the library, by its name.
    #[new]
    #[pyo3(signature = (name = "mobl-arms"))]
    fn new(name: &str) -> PyResult<Self> {
        Self::checked(builtin(name).map_err(error::task)?)
    }

    /// A YAML text; `name` stands in messages. JSON is YAML, too.
    #[staticmethod]
    #[pyo3(signature = (text, name = "model"))]
    fn from_yaml(text: &str, name: &str) -> PyResult<Self> {
        Self::checked(ModelDescription::from_yaml(text, name).map_err(error::task)?)
    }

    /// A model of MuJoCo's file, and what of it has no part in the simulation. `landmarks` are the names of the site that points, and of the bodies whose origins are the shoulder and, where they are
    /// told, elbow and wrist, then sites of other fingers by their names.
    #[staticmethod]
    fn from_mjcf(
        py: Python<'_>,
        file: PathBuf,
        landmarks: LandmarkNames,
        without_contacts: bool,
        side_rule: &str,
        locked: Vec<String>,
        root: Option<PathBuf>,
    ) -> PyResult<(Self, Vec<String>)> {
        let (fingertip, shoulder, elbow, wrist, fingers) = landmarks;
        let landmarks = Landmarks { fingertip, shoulder, elbow, wrist, fingers };
        let side_rule = side_rule.parse().map_err(PyValueError::new_err::<String>)?;
        let options = ImportOptions { landmarks, without_contacts, side_rule, locked };
        let imported = compute(py, || import_model(&file, root.as_deref(), &options))?.map_err(error::task)?;
        Ok((Self::checked(imported.description)?, imported.passed_over))
    }

    /// The model as a YAML file.
    fn to_yaml(&self) -> PyResult<String> {
        self.description.to_yaml().map_err(error::task)
    }

    /// The model as JSON, with the keys of a model file.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.description).map_err(error::task)
    }

    /// The model for MuJoCo.
    fn to_mjcf(&self) -> String {
        myo::model::mjcf::to_mjcf(&self.model, &myo::model::mjcf::MjcfOptions::default())
    }

    /// Short name.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// Every table as arrays, the entity first in each name; see `Model.tables` in the type stubs.
    fn tables<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let out = Tables { model: &self.model, out: PyDict::new(py) };
        out.bodies()?;
        out.joints()?;
        out.sites()?;
        out.muscles()?;
        Ok(out.out)
    }

    fn __repr__(&self) -> String {
        let m = &self.model;
        format!("Model({:?}, {} joints, {} muscles)", m.name, m.joints.len(), m.muscles.len())
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let model = this.get();
        Ok((this.get_type().getattr("from_yaml")?, (model.to_yaml()?, model.model.name.clone())))
    }
}

/// Fills the dictionary, one entity at a time.
struct Tables<'a, 'py> {
    model: &'a myo::model::Model,
    out: Bound<'py, PyDict>,
}

/// One number per row.
fn column<'py, T: numpy::Element>(py: Python<'py>, values: impl Iterator<Item = T>) -> Bound<'py, PyArray1<T>> {
    Array1::from_iter(values).into_pyarray(py)
}

impl<'py> Tables<'_, 'py> {
    fn py(&self) -> Python<'py> {
        self.out.py()
    }

    fn names<'s>(&self, key: &str, names: impl Iterator<Item = &'s String>) -> PyResult<()> {
        self.out.set_item(key, names.collect::<Vec<_>>())
    }

    fn numbers(&self, key: &str, values: impl Iterator<Item = f64>) -> PyResult<()> {
        self.out.set_item(key, column(self.py(), values))
    }

    fn indices(&self, key: &str, values: impl Iterator<Item = usize>) -> PyResult<()> {
        self.out.set_item(key, column(self.py(), values.map(|index| index as i64)))
    }

    fn rows<const N: usize>(&self, key: &str, rows: impl Iterator<Item = [f64; N]>) -> PyResult<()> {
        let rows: Vec<[f64; N]> = rows.collect();
        self.out.set_item(key, Array2::from(rows).into_pyarray(self.py()))
    }

    fn bodies(&self) -> PyResult<()> {
        let bodies = &self.model.bodies;
        self.names("body_name", bodies.iter().map(|b| &b.name))?;
        self.indices("body_parent", bodies.iter().map(|b| b.parent))?;
        self.rows("body_pos", bodies.iter().map(|b| b.pos.into()))?;
        self.rows("body_quat", bodies.iter().map(|b| [b.quat.w, b.quat.i, b.quat.j, b.quat.k]))?;
        self.numbers("body_mass", bodies.iter().map(|b| b.mass))?;
        self.rows("body_com", bodies.iter().map(|b| b.com.into()))?;
        let entry = |(body, row, column): (usize, usize, usize)| bodies[body].inertia[(row, column)];
        let inertia = Array3::from_shape_fn((bodies.len(), 3, 3), entry);
        self.out.set_item("body_inertia", inertia.into_pyarray(self.py()))
    }

    fn joints(&self) -> PyResult<()> {
        let (joints, couplings) = (&self.model.joints, &self.model.couplings);
        self.names("joint_name", joints.iter().map(|j| &j.name))?;
        self.out.set_item("joint_kind", joints.iter().map(|j| j.kind.name()).collect::<Vec<_>>())?;
        self.indices("joint_body", joints.iter().map(|j| j.body))?;
        self.rows("joint_axis", joints.iter().map(|j| j.axis.into()))?;
        self.rows("joint_pos", joints.iter().map(|j| j.pos.into()))?;
        self.rows("joint_range", joints.iter().map(|j| j.range.unwrap_or([f64::NEG_INFINITY, f64::INFINITY])))?;
        self.numbers("joint_stiffness", joints.iter().map(|j| j.stiffness))?;
        self.numbers("joint_spring_ref", joints.iter().map(|j| j.spring_ref))?;
        self.numbers("joint_damping", joints.iter().map(|j| j.damping))?;
        self.numbers("joint_armature", joints.iter().map(|j| j.armature))?;
        self.indices("coupling_dependent", couplings.iter().map(|c| c.dependent))?;
        let independent = couplings.iter().map(|c| c.independent.map_or(-1, |index| index as i64));
        self.out.set_item("coupling_independent", column(self.py(), independent))?;
        self.rows("coupling_polycoef", couplings.iter().map(|c| c.polycoef))
    }

    fn sites(&self) -> PyResult<()> {
        let sites = &self.model.sites;
        self.names("site_name", sites.iter().map(|s| &s.name))?;
        self.indices("site_body", sites.iter().map(|s| s.body))?;
        self.rows("site_pos", sites.iter().map(|s| s.pos.into()))
    }

    fn muscles(&self) -> PyResult<()> {
        let muscles = &self.model.muscles;
        self.names("muscle_name", muscles.iter().map(|m| &m.name))?;
        let paths: Vec<_> = muscles.iter().map(|m| column(self.py(), m.path.iter().map(|&site| site as i64))).collect();
        self.out.set_item("muscle_path", paths)?;
        let pulleys = muscles.iter().map(|m| m.pulleys.iter());
        let begins: Vec<_> = pulleys.clone().map(|all| column(self.py(), all.map(|one| one.before as i64))).collect();
        self.out.set_item("muscle_branch", begins)?;
        let divisors: Vec<_> = pulleys.map(|all| column(self.py(), all.map(|one| one.divisor))).collect();
        self.out.set_item("muscle_divisor", divisors)?;
        let boundless = [f64::NEG_INFINITY, f64::INFINITY];
        self.rows("muscle_limit", muscles.iter().map(|m| m.limit.map_or(boundless, |limit| limit.range)))?;
        let of = || muscles.iter().map(|m| &m.parameters);
        self.rows("muscle_length_range", of().map(|p| p.length_range))?;
        self.rows("muscle_range", of().map(|p| p.gain.range))?;
        self.numbers("muscle_force", of().map(|p| p.gain.force.unwrap_or(f64::NAN)))?;
        self.numbers("muscle_scale", of().map(|p| p.gain.scale))?;
        self.numbers("muscle_lmin", of().map(|p| p.gain.lmin))?;
        self.numbers("muscle_lmax", of().map(|p| p.gain.lmax))?;
        self.numbers("muscle_vmax", of().map(|p| p.gain.vmax))?;
        self.numbers("muscle_fvmax", of().map(|p| p.gain.fvmax))?;
        self.numbers("muscle_fpmax", of().map(|p| p.bias.fpmax))?;
        self.numbers("muscle_tau_act", of().map(|p| p.tau_act))?;
        self.numbers("muscle_tau_deact", of().map(|p| p.tau_deact))?;
        self.rows("muscle_ctrl_range", of().map(|p| p.ctrl_range))
    }
}

/// Names of the models that come with the library.
#[pyfunction]
pub fn model_names() -> Vec<&'static str> {
    builtin_names().to_vec()
}
