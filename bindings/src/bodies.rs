//! Many bodies alone, stepped side by side.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

use myo::dynamics::{Batch, CouplingMode, Obstacles, Plan, Sensors, State, Workspace, step};
use myo::scalar::Level;
use numpy::ndarray::{Array2, Array3, ArrayView2, Axis, ShapeError};
use numpy::{IntoPyArray, PyArray2, PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;
use rayon::prelude::*;

use crate::error::{self, BusyError, compute};
use crate::model::Model;
use crate::process::{Birthplace, own_pool, pool};

/// As many as environments side by side, and as their threads (`arguments.py`).
const MOST_BODIES: usize = 1 << 24;
const MOST_THREADS: usize = 1024;

/// Bodies of one kind without a task, stepped side by side on all threads, in single precision.
#[pyclass(module = "myoenv", frozen)]
pub struct Bodies {
    live: Mutex<Batch>,
    /// With places of all sites, in double precision.
    exact: Plan<f64>,
    /// Of the exact plan.
    sensors: Sensors,
    sensor_names: Vec<String>,
    site_names: Vec<String>,
    muscle_names: Vec<String>,
    pool: Arc<ThreadPool>,
    born: Birthplace,
}

impl Bodies {
    fn open(&self) -> PyResult<MutexGuard<'_, Batch>> {
        self.born.check("the batch of bodies")?;
        match self.live.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(poisoned)) => Ok(PoisonError::into_inner(poisoned)),
            Err(TryLockError::WouldBlock) => {
                Err(BusyError::new_err("another thread is using these bodies; give each thread its own"))
            }
        }
    }

    /// A row for each body.
    fn rows<'py>(
        &self,
        py: Python<'py>,
        width: usize,
        of: fn(&Batch, usize) -> Vec<f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let batch = self.open()?;
        let mut rows = Array2::zeros((batch.size(), width));
        for (body, mut row) in rows.outer_iter_mut().enumerate() {
            row.iter_mut().zip(of(&batch, body)).for_each(|(to, x)| *to = x);
        }
        Ok(rows.into_pyarray(py))
    }

    /// Where these sites are in these poses, in axes of the model's world (m), one after the other.
    fn places(&self, qpos: ArrayView2<'_, f64>, sites: &[usize]) -> Vec<[f64; 3]> {
        let (at_rest, origin) = (vec![0.0; self.exact.ndof()], self.exact.origin);
        let of_pose = |ws: &mut Workspace<f64>, pose: &[f64]| -> Vec<[f64; 3]> {
            step::kinematics::kinematics(&self.exact, pose, &at_rest, ws);
            let place = |&site: &usize| {
                let place = ws.place(&self.exact.elements.sites[site]).array();
                [0, 1, 2].map(|k| place[k] + origin[k])
            };
            sites.iter().map(place).collect()
        };
        let poses: Vec<Vec<f64>> = qpos.outer_iter().map(|pose| pose.to_vec()).collect();
        let start = || Workspace::new(&self.exact);
        poses.par_iter().map_init(start, |ws, pose| of_pose(ws, pose)).flatten_iter().collect()
    }
}

/// What sensors read in a state: the numbers of each.
fn read(exact: &Plan<f64>, sensors: &Sensors, ws: &mut Workspace<f64>, state: &State<f64>) -> Vec<Vec<f64>> {
    step::forward(exact, &Obstacles::none(exact), state, ws);
    sensors.read(exact, state, ws)
}

/// Numbers that do not fill an array.
fn wrong(error: ShapeError) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Refuses an array of another shape, or with numbers that are not finite.
fn check(what: &str, values: ArrayView2<'_, f64>, expected: [usize; 2]) -> PyResult<()> {
    if values.shape() != expected {
        let shape = values.shape();
        return Err(PyValueError::new_err(format!("{what} has the shape {shape:?}, expected {expected:?}")));
    }
    match values.indexed_iter().find(|(_, x)| !x.is_finite()) {
        Some(((row, column), x)) => {
            Err(PyValueError::new_err(format!("{what}[{row}, {column}] is {x}; it must be finite")))
        }
        None => Ok(()),
    }
}

#[pymethods]
impl Bodies {
    /// So many bodies at rest in the pose of reference: joints at zero, free bodies where the model puts them. With `soft_couplings` coupled joints have positions of their own, held together by soft constraints as MuJoCo's are; else they follow the
    /// independent ones.
    #[new]
    #[pyo3(signature = (model, num_bodies, *, soft_couplings = false, threads = None))]
    fn new(model: &Model, num_bodies: usize, soft_couplings: bool, threads: Option<usize>) -> PyResult<Self> {
        for (what, count, most) in [("num_bodies", Some(num_bodies), MOST_BODIES), ("threads", threads, MOST_THREADS)] {
            if let Some(count) = count.filter(|count| !(1..=most).contains(count)) {
                return Err(PyValueError::new_err(format!("{what} is {count}; it must be from 1 to {most}")));
            }
        }
        let couplings = if soft_couplings { CouplingMode::Soft } else { CouplingMode::Reduced };
        let model = model.inner();
        let exact = Plan::exact(model, couplings).map_err(error::task)?;
        let level = Level::detect().map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self {
            live: Mutex::new(Batch::new(&exact.specialised(), num_bodies, level)),
            sensors: Sensors::new(model, &exact),
            sensor_names: model.sensors.iter().map(|sensor| sensor.name.clone()).collect(),
            site_names: model.sites.iter().map(|site| site.name.clone()).collect(),
            muscle_names: model.muscles.iter().map(|muscle| muscle.name.clone()).collect(),
            exact,
            pool: threads.map_or_else(pool, |threads| own_pool(Some(threads)))?,
            born: Birthplace::here(),
        })
    }

    /// Advances all by `steps` physics steps under excitations `(num_bodies, nmuscle)`, clipped to [0, 1].
    #[pyo3(signature = (ctrl, steps = 1))]
    fn step(&self, py: Python<'_>, ctrl: PyReadonlyArray2<'_, f32>, steps: usize) -> PyResult<()> {
        let mut batch = self.open()?;
        check("ctrl", ctrl.as_array().mapv(f64::from).view(), [batch.size(), self.muscle_names.len()])?;
        for (body, row) in ctrl.as_array().outer_iter().enumerate() {
            let row: Vec<f32> = row.iter().map(|&x| x.clamp(0.0, 1.0)).collect();
            batch.set_ctrl(body, &row);
        }
        let batch = &mut *batch;
        compute(py, || self.pool.install(|| batch.step(steps)))
    }

    /// Gives these bodies positions `(n, nq)`, rates `(n, ndof)` and activations `(n, nmuscle)`.
    fn set(
        &self,
        bodies: PyReadonlyArray1<'_, i64>,
        qpos: PyReadonlyArray2<'_, f64>,
        qvel: PyReadonlyArray2<'_, f64>,
        activation: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<()> {
        let mut batch = self.open()?;
        let (bodies, ndof) = (bodies.as_array(), self.exact.ndof());
        check("qpos", qpos.as_array(), [bodies.len(), self.exact.nq()])?;
        check("qvel", qvel.as_array(), [bodies.len(), ndof])?;
        check("activation", activation.as_array(), [bodies.len(), self.muscle_names.len()])?;
        // What single precision holds.
        for (what, values) in [("qpos", &qpos), ("qvel", &qvel)] {
            let most = f64::from(f32::MAX);
            if let Some(((row, column), x)) = values.as_array().indexed_iter().find(|(_, x)| x.abs() > most) {
                return Err(PyValueError::new_err(format!(
                    "{what}[{row}, {column}] is {x}; it must be at most {most}"
                )));
            }
        }
        if let Some(((row, column), x)) = activation.as_array().indexed_iter().find(|(_, x)| !(0.0..=1.0).contains(*x))
        {
            return Err(PyValueError::new_err(format!("activation[{row}, {column}] is {x}; it must be from 0 to 1")));
        }
        let size = batch.size();
        let number = |body: i64| usize::try_from(body).ok().filter(|&body| body < size);
        let numbers = bodies.iter().map(|&body| {
            number(body).ok_or_else(|| PyValueError::new_err(format!("there is no body {body} of {size}")))
        });
        for (row, body) in numbers.collect::<PyResult<Vec<_>>>()?.into_iter().enumerate() {
            let of = |array: &PyReadonlyArray2<'_, f64>| array.as_array().index_axis(Axis(0), row).to_vec();
            batch.set_state(body, &of(&qpos), &of(&qvel), &of(&activation));
        }
        Ok(())
    }

    /// Positions of sites in these poses `(n, nq)`, in axes of the model's world (m), `(n, nsite, 3)`; poses of the bodies if none are told.
    #[pyo3(signature = (sites, qpos = None))]
    fn site_positions<'py>(
        &self,
        py: Python<'py>,
        sites: Vec<String>,
        qpos: Option<PyReadonlyArray2<'py, f64>>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let number = |name: &String| {
            let unknown = || PyValueError::new_err(format!("the body has no site `{name}`"));
            self.site_names.iter().position(|site| site == name).ok_or_else(unknown)
        };
        let numbers = sites.iter().map(number).collect::<PyResult<Vec<_>>>()?;
        let poses = match qpos {
            Some(qpos) => {
                let poses = qpos.as_array().to_owned();
                check("qpos", poses.view(), [poses.nrows(), self.exact.nq()])?;
                poses
            }
            None => {
                let batch = self.open()?;
                let rows: Vec<f64> = (0..batch.size()).flat_map(|body| batch.qpos(body)).map(f64::from).collect();
                Array2::from_shape_vec((batch.size(), self.exact.nq()), rows).map_err(wrong)?
            }
        };
        let count = poses.nrows();
        let places = compute(py, || self.pool.install(|| self.places(poses.view(), &numbers)))?;
        let flat: Vec<f64> = places.into_iter().flatten().collect();
        Ok(Array3::from_shape_vec((count, numbers.len(), 3), flat).map_err(wrong)?.into_pyarray(py))
    }

    /// What sensors read of the bodies as they are now, in double precision: `(num_bodies, size)` of each, by its name.
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        if self.sensor_names.is_empty() {
            return Ok(PyDict::new(py));
        }
        let states: Vec<State<f64>> = {
            let batch = self.open()?;
            let wide = |row: Vec<f32>| row.into_iter().map(f64::from).collect();
            let state =
                |body| State { qpos: wide(batch.qpos(body)), qvel: wide(batch.qvel(body)), act: wide(batch.act(body)) };
            (0..batch.size()).map(state).collect()
        };
        let start = || Workspace::new(&self.exact);
        let read = |ws: &mut Workspace<f64>, state: &State<f64>| read(&self.exact, &self.sensors, ws, state);
        let rows: Vec<Vec<Vec<f64>>> =
            compute(py, || self.pool.install(|| states.par_iter().map_init(start, read).collect()))?;
        let out = PyDict::new(py);
        for (number, (name, size)) in self.sensor_names.iter().zip(self.sensors.sizes()).enumerate() {
            let flat = rows.iter().flat_map(|row| row[number].iter().copied()).collect();
            let array = Array2::from_shape_vec((rows.len(), size), flat).map_err(wrong)?;
            out.set_item(name, array.into_pyarray(py))?;
        }
        Ok(out)
    }

    /// Names of the sensors, in the order of the model.
    #[getter]
    fn sensor_names(&self) -> Vec<String> {
        self.sensor_names.clone()
    }

    /// How many numbers each sensor reads.
    #[getter]
    fn sensor_sizes(&self) -> Vec<usize> {
        self.sensors.sizes().collect()
    }

    /// Positions of the joints (rad or m), `(num_bodies, nq)`: of a ball joint a quaternion (w, x, y, z), of a free one its place in the world and then that.
    #[getter]
    fn qpos<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.rows(py, self.exact.nq(), Batch::qpos)
    }

    /// Rates of the coordinates (rad/s or m/s), `(num_bodies, ndof)`: of ball and free joints three and six.
    #[getter]
    fn qvel<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.rows(py, self.exact.ndof(), Batch::qvel)
    }

    /// Muscle activations in [0, 1], `(num_bodies, nmuscle)`.
    #[getter]
    fn activation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.rows(py, self.muscle_names.len(), Batch::act)
    }

    /// Names of the coordinates that have rates, in their order: of the joints, and of ball and free joints with `_tx` to `_rz`.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.exact.dofs.iter().map(|dof| dof.name.clone()).collect()
    }

    /// Limits of these coordinates (rad or m), `(ndof, 2)`; infinite where there are none.
    #[getter]
    fn joint_ranges<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let free = [f64::NEG_INFINITY, f64::INFINITY];
        let ends: Vec<[f64; 2]> = self.exact.dofs.iter().map(|dof| dof.range.unwrap_or(free)).collect();
        Array2::from(ends).into_pyarray(py)
    }

    /// Names of the muscles.
    #[getter]
    fn muscle_names(&self) -> Vec<String> {
        self.muscle_names.clone()
    }

    /// Seconds per physics step.
    #[getter]
    fn timestep(&self) -> f64 {
        self.exact.timestep
    }

    /// What a pickle would have to hold lives with threads of this process.
    fn __reduce__(&self) -> PyResult<()> {
        Err(error::no_pickle("bodies", "make them anew"))
    }
}
