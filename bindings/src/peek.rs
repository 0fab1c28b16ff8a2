//! Some environments at one moment, as arrays.

use myo::dynamics::spatial::Frame;
use myo::env::{EnvError, Role, Skeleton, SkeletonPose, Snapshot};
use numpy::ndarray::{Array2, Array3, Array4};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Moments with their poses.
pub type Seen = Vec<(Snapshot, SkeletonPose)>;

/// Where everything is; the skeleton of each moment by its place.
pub fn posed<'a>(skeleton: impl Fn(usize) -> &'a Skeleton, moments: Vec<Snapshot>) -> Result<Seen, EnvError> {
    let pose = |(k, moment)| skeleton(k).pose(&moment).map(|pose| (moment, pose));
    moments.into_iter().enumerate().map(pose).collect()
}

/// The fields of `myoenv.Peek`, by name; arrays have the environments as their first axis.
pub fn fields<'py>(
    py: Python<'py>,
    skeleton: &Skeleton,
    control_dt: f64,
    seen: &[(Snapshot, SkeletonPose)],
) -> PyResult<Bound<'py, PyDict>> {
    let fields = Fields { skeleton, seen, out: PyDict::new(py) };
    fields.names()?;
    fields.body()?;
    fields.muscles()?;
    fields.objects()?;
    fields.task(control_dt)?;
    Ok(fields.out)
}

/// Fills the dictionary.
struct Fields<'a, 'py> {
    skeleton: &'a Skeleton,
    seen: &'a [(Snapshot, SkeletonPose)],
    out: Bound<'py, PyDict>,
}

impl<'py> Fields<'_, 'py> {
    fn py(&self) -> Python<'py> {
        self.out.py()
    }

    fn names(&self) -> PyResult<()> {
        let (model, objects) = (self.skeleton.model(), &self.skeleton.task().objects);
        self.out.set_item("joint_names", self.skeleton.joint_names().collect::<Vec<_>>())?;
        self.out.set_item("muscle_names", model.muscles.iter().map(|muscle| &muscle.name).collect::<Vec<_>>())?;
        self.out.set_item("body_names", model.bodies.iter().map(|body| &body.name).collect::<Vec<_>>())?;
        self.out.set_item("object_names", objects.iter().map(|object| &object.name).collect::<Vec<_>>())?;
        self.out.set_item("object_kinds", objects.iter().map(|object| object.kind()).collect::<Vec<_>>())
    }

    fn body(&self) -> PyResult<()> {
        let (ndof, nbody) = (self.skeleton.joint_names().count(), self.skeleton.model().bodies.len());
        self.rows("qpos", ndof, |env, k| self.seen[env].0.body.qpos[k])?;
        self.rows("qvel", ndof, |env, k| self.seen[env].0.body.qvel[k])?;
        self.rows("fingertip", 3, |env, k| self.seen[env].1.fingertip[k])?;
        self.rows("pointer", 3, |env, k| self.seen[env].1.pointer[k])?;
        self.frames("body", nbody, |env, body| &self.seen[env].1.bodies[body])
    }

    fn muscles(&self) -> PyResult<()> {
        let (muscles, n) = (&self.skeleton.model().muscles, self.seen.len());
        self.rows("act", muscles.len(), |env, k| self.seen[env].0.body.act[k])?;
        let path = |k: usize| {
            let points = self.skeleton.path_bodies(k).len();
            let entry = |(env, point, axis): (usize, usize, usize)| self.seen[env].1.muscles[k].points[point][axis];
            Array3::from_shape_fn((n, points, 3), entry).into_pyarray(self.py())
        };
        self.out.set_item("muscle_paths", (0..muscles.len()).map(path).collect::<Vec<_>>())
    }

    fn objects(&self) -> PyResult<()> {
        let (n, count) = (self.seen.len(), self.skeleton.task().objects.len());
        self.frames("object", count, |env, object| &self.seen[env].1.objects[object].frame)?;
        let half_size = |(env, object, axis): (usize, usize, usize)| self.seen[env].1.objects[object].half_size[axis];
        let half_sizes = Array3::from_shape_fn((n, count, 3), half_size);
        self.out.set_item("object_half_sizes", half_sizes.into_pyarray(self.py()))?;
        let is_done = |(env, object): (usize, usize)| self.seen[env].1.objects[object].role == Role::Done;
        self.out.set_item("object_done", Array2::from_shape_fn((n, count), is_done).into_pyarray(self.py()))?;
        let value = |(env, object): (usize, usize)| self.seen[env].1.objects[object].value.unwrap_or(f64::NAN);
        self.out.set_item("object_values", Array2::from_shape_fn((n, count), value).into_pyarray(self.py()))?;
        self.column("current_object", |_, pose| pose.current.map_or(-1, |object| object as i64))
    }

    fn task(&self, control_dt: f64) -> PyResult<()> {
        self.column("steps_done", |moment, _| moment.task.phase.round() as i64)?;
        self.column("touch", |moment, _| moment.touch)?;
        self.column("time", |moment, _| moment.task.step * control_dt)?;
        self.column("episode", |moment, _| i64::from(moment.episode))?;
        self.column("ended", |moment, _| moment.ended)
    }

    /// One entry per environment.
    fn column<T: numpy::Element>(&self, key: &str, entry: impl Fn(&Snapshot, &SkeletonPose) -> T) -> PyResult<()> {
        let entries = self.seen.iter().map(|(moment, pose)| entry(moment, pose));
        self.out.set_item(key, PyArray1::from_iter(self.py(), entries))
    }

    /// One row per environment.
    fn rows(&self, key: &str, width: usize, entry: impl Fn(usize, usize) -> f64) -> PyResult<()> {
        let rows = Array2::from_shape_fn((self.seen.len(), width), |(env, k)| entry(env, k));
        self.out.set_item(key, rows.into_pyarray(self.py()))
    }

    /// Positions and rotations of something that each environment has so many of.
    fn frames<'a>(&self, what: &str, count: usize, frame: impl Fn(usize, usize) -> &'a Frame<f64>) -> PyResult<()> {
        let n = self.seen.len();
        let position = |(env, k, axis): (usize, usize, usize)| frame(env, k).position.array()[axis];
        let rotation = |(env, k, row, column): (usize, usize, usize, usize)| {
            let axes = &frame(env, k).rotation;
            [axes.x, axes.y, axes.z][column].array()[row]
        };
        let positions = Array3::from_shape_fn((n, count, 3), position);
        let rotations = Array4::from_shape_fn((n, count, 3, 3), rotation);
        self.out.set_item(format!("{what}_positions"), positions.into_pyarray(self.py()))?;
        self.out.set_item(format!("{what}_rotations"), rotations.into_pyarray(self.py()))
    }
}
