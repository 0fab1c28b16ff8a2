//! The body alone, in double precision.

use std::sync::{Mutex, MutexGuard, PoisonError};

use myo::dynamics::{CouplingMode, Obstacles, Plan, State, Workspace, step};
use myo::env::Tables;
use numpy::ndarray::Array2;
use numpy::{
    AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayLike1, PyUntypedArray,
    PyUntypedArrayMethods, get_array_module,
};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::error::{self, compute};
use crate::model::Model;
use crate::task::Task;

/// Steps, some milliseconds of them, after which Ctrl-C is looked for.
const STEPS_BETWEEN_SIGNALS: i64 = 1000;

/// One body, stepped directly: the double-precision reference. Coupled joints follow the independent ones.
///
/// Positions are metres from the shoulder centre (x forward, y to the left, z up).
#[pyclass(module = "myoenv", frozen)]
pub struct Simulation {
    plan: Plan<f64>,
    obstacles: Obstacles<f64>,
    joint_names: Vec<String>,
    muscle_names: Vec<String>,
    body_names: Vec<String>,
    moment: Mutex<Moment>,
}

struct Moment {
    state: State<f64>,
    ws: Workspace<f64>,
    time: f64,
    /// Whether `ws` belongs to `state`.
    fresh: bool,
}

impl Simulation {
    fn moment(&self) -> MutexGuard<'_, Moment> {
        self.moment.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Everything that follows from the state.
    fn looked(&self) -> MutexGuard<'_, Moment> {
        let mut moment = self.moment();
        let Moment { state, ws, fresh, .. } = &mut *moment;
        if !*fresh {
            step::forward(&self.plan, &self.obstacles, state, ws);
            *fresh = true;
        }
        moment
    }

    fn advance(&self, ctrl: &[f64], steps: i64) {
        let mut moment = self.moment();
        let Moment { state, ws, time, fresh } = &mut *moment;
        for _ in 0..steps {
            step::step(&self.plan, &self.obstacles, ctrl, state, ws);
        }
        *time += steps as f64 * self.plan.timestep;
        *fresh = false;
    }

    fn set(&self, values: &[f64], part: fn(&mut State<f64>) -> &mut Vec<f64>) {
        let mut moment = self.moment();
        part(&mut moment.state).copy_from_slice(values);
        moment.fresh = false;
    }
}

/// So many finite numbers, whatever they come in.
fn numbers(what: &str, values: &Bound<'_, PyAny>, expected: usize) -> PyResult<Vec<f64>> {
    let refuse = |sentence: String| PyValueError::new_err(format!("{what} {sentence}"));
    let array = get_array_module(values.py())?
        .call_method1("asarray", (values,))
        .map_err(|error| refuse(format!("cannot be made an array: {}", error.value(values.py()))))?;
    let array = array.cast::<PyUntypedArray>()?;
    if !matches!(array.dtype().kind(), b'f' | b'i' | b'u') {
        return Err(refuse(format!("is of type {}; it must be numbers", array.dtype())));
    }
    if array.shape() != [expected] {
        return Err(refuse(format!("has the shape {:?}, expected [{expected}]", array.shape())));
    }
    let values = array.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>()?.as_array().to_vec();
    match values.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(PyValueError::new_err(format!("{what}[{index}] is {}; it must be finite", values[index]))),
        None => Ok(values),
    }
}

#[pymethods]
impl Simulation {
    /// A body at rest in the zero pose; with a task, its buttons can be touched.
    #[new]
    #[pyo3(signature = (model, task = None))]
    fn new(model: &Model, task: Option<&Task>) -> PyResult<Self> {
        let model = task.map_or_else(|| Ok(model.inner().clone()), |task| model.of(task.inner()))?;
        let plan = Plan::exact(&model, CouplingMode::Reduced).map_err(error::task)?;
        let obstacles = match task {
            Some(task) => Tables::<f64>::new(&model, task.inner()).map_err(error::build)?.obstacles(),
            None => Obstacles::none(&plan),
        };
        let names = |all: Vec<&String>| all.into_iter().cloned().collect();
        let ws = Workspace::with_contacts(&plan, obstacles.most_at_once(&plan));
        let moment = Moment { state: State::new(&plan), ws, time: 0.0, fresh: false };
        Ok(Self {
            joint_names: plan.dofs.iter().map(|dof| dof.name.clone()).collect(),
            muscle_names: names(model.muscles.iter().map(|m| &m.name).collect()),
            body_names: names(model.bodies.iter().map(|b| &b.name).collect()),
            obstacles,
            moment: Mutex::new(moment),
            plan,
        })
    }

    /// Advances `steps` physics steps under excitations `(nmuscle,)`, clipped to [0, 1].
    #[pyo3(signature = (ctrl, steps = 1))]
    fn step(&self, py: Python<'_>, ctrl: &Bound<'_, PyAny>, steps: i64) -> PyResult<()> {
        let mut ctrl = numbers("ctrl", ctrl, self.plan.nmuscle())?;
        ctrl.iter_mut().for_each(|u| *u = u.clamp(0.0, 1.0));
        if steps < 0 {
            return Err(PyValueError::new_err(format!("steps is {steps}; it must be at least 0")));
        }
        let mut left = steps;
        while left > 0 {
            let now = left.min(STEPS_BETWEEN_SIGNALS);
            compute(py, || self.advance(&ctrl, now))?;
            py.check_signals()?;
            left -= now;
        }
        if self.moment().state.qpos.iter().any(|x| !x.is_finite()) {
            return Err(PyRuntimeError::new_err("the body moves too fast to be computed; reset it"));
        }
        Ok(())
    }

    /// Back to rest in the zero pose.
    fn reset(&self) {
        let mut moment = self.moment();
        moment.state = State::new(&self.plan);
        (moment.time, moment.fresh) = (0.0, false);
    }

    /// Seconds simulated.
    #[getter]
    fn time(&self) -> f64 {
        self.moment().time
    }

    /// Seconds per physics step.
    #[getter]
    fn timestep(&self) -> f64 {
        self.plan.timestep
    }

    /// Positions of the independent joints (rad or m; quaternions of ball and free ones), `(nq,)`.
    #[getter]
    fn qpos<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.moment().state.qpos)
    }

    #[setter]
    fn set_qpos(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
        self.set(&numbers("qpos", values, self.plan.nq())?, |state| &mut state.qpos);
        Ok(())
    }

    /// Rates of their coordinates (rad/s or m/s), `(ndof,)`.
    #[getter]
    fn qvel<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.moment().state.qvel)
    }

    #[setter]
    fn set_qvel(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
        self.set(&numbers("qvel", values, self.plan.ndof())?, |state| &mut state.qvel);
        Ok(())
    }

    /// Muscle activations in [0, 1], `(nmuscle,)`.
    #[getter]
    fn activation<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.moment().state.act)
    }

    #[setter]
    fn set_activation(&self, values: &Bound<'_, PyAny>) -> PyResult<()> {
        let given = numbers("activation", values, self.plan.nmuscle())?;
        if let Some(muscle) = given.iter().position(|x| !(0.0..=1.0).contains(x)) {
            let x = given[muscle];
            return Err(PyValueError::new_err(format!("activation[{muscle}] is {x}; it must be from 0 to 1")));
        }
        self.set(&given, |state| &mut state.act);
        Ok(())
    }

    /// Accelerations of the independent joints in this state (rad/s^2), `(ndof,)`.
    #[getter]
    fn qacc<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.looked().ws.qacc)
    }

    /// Mass matrix of the independent joints (kg m^2), `(ndof, ndof)`.
    #[getter]
    fn mass_matrix<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let (n, moment) = (self.plan.ndof(), self.looked());
        Array2::from_shape_fn((n, n), |(i, j)| moment.ws.mass[i.max(j) * n + i.min(j)]).into_pyarray(py)
    }

    /// Positions of all joints of the model, coupled ones included (rad or m), `(njoint,)`.
    #[getter]
    fn joint_positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.plan.joint_positions(&self.moment().state.qpos).into_pyarray(py)
    }

    /// Lengths of the muscles' paths (m), `(nmuscle,)`.
    #[getter]
    fn tendon_length<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.looked().ws.tendon_length[..self.plan.nmuscle()])
    }

    /// Their rates (m/s), `(nmuscle,)`.
    #[getter]
    fn tendon_velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.looked().ws.tendon_velocity[..self.plan.nmuscle()])
    }

    /// Moment arms (m), `(nmuscle, ndof)`: minus the derivative of length with respect to position, so that force times
    /// moment arm is the torque of the muscle.
    #[getter]
    fn moment_arms<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let (ndof, nmuscle) = (self.plan.ndof(), self.plan.nmuscle());
        let qpos = self.moment().state.qpos.clone();
        let mut ws = Workspace::new(&self.plan);
        let mut arms = Array2::zeros((nmuscle, ndof));
        for dof in 0..ndof {
            // The rate of length at unit speed of one coordinate is the derivative.
            let mut qvel = vec![0.0; ndof];
            qvel[dof] = 1.0;
            step::kinematics::kinematics(&self.plan, &qpos, &qvel, &mut ws);
            step::tendon::lengths(&self.plan, &mut ws);
            for (muscle, rate) in ws.tendon_velocity[..nmuscle].iter().enumerate() {
                arms[(muscle, dof)] = -rate;
            }
        }
        arms.into_pyarray(py)
    }

    /// Muscle forces (N), `(nmuscle,)`, positive when pulling.
    #[getter]
    fn muscle_force<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let forces: Vec<f64> =
            self.looked().ws.muscle_force[..self.plan.nmuscle()].iter().map(|force| -force).collect();
        forces.into_pyarray(py)
    }

    /// Sum of normal forces on the boxes that fingers touch (N), 0 without contact.
    #[getter]
    fn contact_force(&self) -> f64 {
        self.looked().ws.box_contacts().flatten().filter(|contact| contact.exists).map(|contact| contact.force).sum()
    }

    /// Position of the fingertip (m), `(3,)`.
    #[getter]
    fn fingertip<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &step::fingertip(&self.plan, &self.looked().ws))
    }

    /// Origins of all bodies (m), `(nbody, 3)`, the world first.
    #[getter]
    fn body_positions<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        let moment = self.looked();
        let rows: Vec<[f64; 3]> =
            self.plan.elements.bodies.iter().map(|b| moment.ws.place(&b.origin).array()).collect();
        Array2::from(rows).into_pyarray(py)
    }

    /// Names of the independent joints, in the order of `qpos`.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.joint_names.clone()
    }

    /// Names of the muscles.
    #[getter]
    fn muscle_names(&self) -> Vec<String> {
        self.muscle_names.clone()
    }

    /// Names of the bodies.
    #[getter]
    fn body_names(&self) -> Vec<String> {
        self.body_names.clone()
    }
}
