//! Everything that a user did in some episodes, physics step by physics step, as a table.

use std::io::{self, Write};

use myo_dynamics::{CouplingMode, Exerter, Exertion, Plan, State};
use myo_env::{
    BuildError, CpuEnv, EnvConfig, EnvError, Skeleton, SkeletonPose, Snapshot, StepStorage, TraceShape, VectorEnv,
};
use myo_model::Model;
use myo_model::description::JointKind;
use myo_tasks::{Pointer, Task};
use myo_train::session::evaluation_seed;
use myo_train::{Policy, TrainError};
use thiserror::Error;

use crate::layout_names;
use crate::protocol::Done;

/// Episodes that run side by side; more take more memory and no less time.
const AT_ONCE: usize = 32;

/// Why there are no trajectories.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The task cannot be simulated.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// An environment refused.
    #[error(transparent)]
    Env(#[from] EnvError),
    /// The policy was trained for other observations or actions.
    #[error(transparent)]
    Policy(#[from] TrainError),
    /// They cannot be written.
    #[error("cannot write trajectories: {0}")]
    Write(#[from] io::Error),
}

/// A table by columns, all equally long.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectories {
    /// Its columns.
    pub columns: Vec<Column>,
}

/// One column.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, which ends with the unit.
    pub name: String,
    /// What is in it.
    pub values: Values,
}

/// What is in a column; what does not exist is NaN, 0 or empty.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Counted from one.
    Whole(Vec<u32>),
    /// Measured.
    Number(Vec<f64>),
    /// Names.
    Text(Vec<String>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Whole(all) => all.len(),
            Self::Number(all) => all.len(),
            Self::Text(all) => all.len(),
        }
    }

    /// As it stands in a file.
    fn write(&self, row: usize, out: &mut impl Write) -> io::Result<()> {
        match self {
            Self::Whole(all) if all[row] == 0 => Ok(()),
            Self::Whole(all) => write!(out, "{}", all[row]),
            Self::Number(all) if all[row].is_nan() => Ok(()),
            // Seven digits are those of single precision.
            Self::Number(all) => write!(out, "{}", (all[row] * 1e7).round() / 1e7),
            Self::Text(all) => out.write_all(quoted(&all[row]).as_bytes()),
        }
    }
}

/// A text as a cell (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

impl Trajectories {
    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Writes the names of the columns.
    ///
    /// # Errors
    /// The writer refuses.
    pub fn write_head(&self, out: &mut impl Write) -> io::Result<()> {
        let names: Vec<String> = self.columns.iter().map(|column| quoted(&column.name)).collect();
        writeln!(out, "{}", names.join(","))
    }

    /// Writes the rows, values separated by commas.
    ///
    /// # Errors
    /// The writer refuses.
    pub fn write_rows(&self, out: &mut impl Write) -> io::Result<()> {
        for row in 0..self.rows() {
            for (index, column) in self.columns.iter().enumerate() {
                if index > 0 {
                    out.write_all(b",")?;
                }
                column.values.write(row, out)?;
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    /// Puts the rows of others with the same columns behind these.
    pub fn append(&mut self, episode: Self) {
        if self.columns.is_empty() {
            self.columns = episode.columns;
            return;
        }
        for (own, new) in self.columns.iter_mut().zip(episode.columns) {
            match (&mut own.values, new.values) {
                (Values::Whole(all), Values::Whole(new)) => all.extend(new),
                (Values::Number(all), Values::Number(new)) => all.extend(new),
                (Values::Text(all), Values::Text(new)) => all.extend(new),
                // Of other columns there is nothing to put there.
                _ => {}
            }
        }
    }
}

/// What `policy` does in `episodes` episodes of each layout, acting without exploring and with the task's noise: handed to `take` some episodes at a time, in
/// the order of their numbers, and `take` says whether to go on. The table is the same whatever the number of processors.
///
/// Columns: `episode` from one; `layout`, where there are several; `time_s` since the start of the episode, at the end of a physics step; `step` of the script that is to do, from
/// one, and `object` that it asks for, with its place (`object_x_m`, `object_y_m`, `object_z_m`: m from the shoulder centre, x forward, y to the left, z up) and
/// its size (`object_width_m`, of a sphere its diameter); `fingertip_x_m` and so on; `pointer_x_m` and so on, where something else points; `force_n` on the fingertip; `event`: `entered` at the last entry
/// into what was asked for, `done` when the step was done, `given_up` when it had taken too long (`step_limit_s`), `success` or `time_out` at the end of an episode; of each independent joint its position and its velocity (`elbow_flexion_rad`, `elbow_flexion_rad_s`),
/// of each muscle activation and force (`DELT1_activation`, `DELT1_force_n`); of all muscles together the torque on each of these joints (`elbow_flexion_torque_nm`), the power with
/// which they pull (`mechanical_w`), and what they consume, more than at rest (`metabolic_w`; [`myo_muscle::MetabolicPower`]).
///
/// # Errors
/// The policy does not fit the layouts, these cannot be simulated, or `take` fails.
pub fn trajectories<E: From<TrajectoryError>>(
    policy: &mut Policy,
    model: &Model,
    layouts: &[Task],
    (episodes, seed): (usize, u64),
    mut take: impl FnMut(Trajectories) -> Result<bool, E>,
) -> Result<(), E> {
    let scribe = Scribe::new(model, layouts)?;
    let side_by_side = (AT_ONCE / layouts.len().max(1)).max(1);
    for first in (0..episodes).step_by(side_by_side) {
        let count = side_by_side.min(episodes - first);
        let seed = if first == 0 { seed } else { evaluation_seed(seed, first as u64) };
        let at = (first, count, seed);
        if !take(scribe.some(policy, model, layouts, at)?)? {
            break;
        }
    }
    Ok(())
}

/// Writes down episodes of some layouts.
struct Scribe {
    skeletons: Vec<Skeleton>,
    names: Vec<String>,
    joints: Vec<(String, JointKind)>,
    muscles: Vec<String>,
    exerter: Exerter,
}

/// An episode on its way.
#[derive(Default)]
struct Going {
    samples: Vec<Sample>,
    /// Steps that are over, done or given up, with how many samples there were then.
    over: Vec<(usize, usize)>,
    is_over: bool,
}

/// One physics step.
struct Sample {
    step: Option<usize>,
    object: Option<Asked>,
    pose: [[f64; 3]; 2],
    force: f64,
    numbers: Vec<f32>,
    event: &'static str,
}

/// The object that is asked for.
#[derive(Clone)]
struct Asked {
    name: String,
    at: [f64; 3],
    width: f64,
}

impl Scribe {
    fn new(model: &Model, layouts: &[Task]) -> Result<Self, TrajectoryError> {
        let skeletons = layouts.iter().map(|task| Skeleton::new(model, task)).collect::<Result<Vec<_>, _>>()?;
        let first = skeletons.first().ok_or(BuildError::NoLayouts)?;
        let kind =
            |name: &str| model.joints.iter().find(|joint| joint.name == name).map_or(JointKind::Hinge, |j| j.kind);
        Ok(Self {
            joints: first.joint_names().map(|name| (name.to_owned(), kind(name))).collect(),
            muscles: model.muscles.iter().map(|muscle| muscle.name.clone()).collect(),
            names: layout_names(layouts),
            exerter: Exerter::new(model, Plan::exact(model, CouplingMode::Reduced).map_err(BuildError::from)?),
            skeletons,
        })
    }

    /// The episodes from `first` on, of each layout.
    fn some(
        &self,
        policy: &mut Policy,
        model: &Model,
        layouts: &[Task],
        (first, count, seed): (usize, usize, u64),
    ) -> Result<Trajectories, TrajectoryError> {
        let num_envs = count * layouts.len();
        let mut env = CpuEnv::with_layouts(model, layouts, &EnvConfig { num_envs, seed, ..EnvConfig::default() })?;
        let (spec, shape) = (env.spec().clone(), env.trace_shape());
        policy.check(&spec)?;
        let (mut step, mut actions) = (StepStorage::new(&spec), vec![0.0; num_envs * spec.action_size()]);
        let mut trace = vec![0.0; num_envs * shape.len_per_env()];
        let mut exerter = self.exerter.clone();
        let mut going: Vec<Going> = (0..num_envs).map(|_| Going::default()).collect();
        env.reset(Some(seed), None, &mut step.observation)?;
        while going.iter().any(|episode| !episode.is_over) {
            policy.act_deterministic(&step.observation, &mut actions);
            let before = env.peek(0..num_envs)?;
            env.step_traced(&actions, step.buffers(), &mut trace)?;
            for (number, episode) in going.iter_mut().enumerate().filter(|(_, episode)| !episode.is_over) {
                let rows = &trace[number * shape.len_per_env()..][..shape.len_per_env()];
                self.add(number % layouts.len(), &before[number], (&shape, rows), &mut exerter, episode)?;
                if step.terminated[number] || step.truncated[number] {
                    let summary = &step.episode[number * spec.episode_size()..][..spec.episode_size()];
                    let is_done = |step: usize| Done::is_done(&spec, summary, step);
                    let after_entry = |step: usize| Done::after_entry(&spec, summary, step, shape.rate_hz);
                    episode.end(is_done, after_entry, step.terminated[number]);
                }
            }
        }
        let mut all = Trajectories::default();
        for (number, episode) in going.iter().enumerate() {
            let (layout, repeat) = (number % layouts.len(), number / layouts.len());
            all.append(self.table(episode, layout, first + repeat + 1, shape.rate_hz));
        }
        Ok(all)
    }

    /// Adds the physics steps of a control step.
    fn add(
        &self,
        layout: usize,
        before: &Snapshot,
        (shape, rows): (&TraceShape, &[f32]),
        exerter: &mut Exerter,
        episode: &mut Going,
    ) -> Result<(), EnvError> {
        let skeleton = &self.skeletons[layout];
        let asked = skeleton.pose(before)?;
        // What comes next begins with a control step.
        if let Some(last) =
            episode.samples.last().and_then(|sample| sample.step).filter(|&last| asked.step != Some(last))
        {
            episode.over.push((last, episode.samples.len()));
        }
        let object = asked.current.map(|index| object(skeleton, &asked, index));
        let mut moment = before.clone();
        for sample in rows.chunks_exact(shape.columns).filter_map(|row| shape.sample(row)) {
            let State { qpos, qvel, act } = &mut moment.body;
            for (own, seen) in [(qpos, sample.qpos), (qvel, sample.qvel), (act, sample.activations)] {
                own.iter_mut().zip(seen).for_each(|(own, &seen)| *own = f64::from(seen));
            }
            let Exertion { torque, mechanical, metabolic } = exerter.at(&moment.body);
            let exerted: Vec<f32> = torque.into_iter().chain([mechanical, metabolic]).map(|x| x as f32).collect();
            let SkeletonPose { fingertip, pointer, .. } = skeleton.pose(&moment)?;
            let parts = [sample.qpos, sample.qvel, sample.activations, sample.muscle_forces, &exerted];
            episode.samples.push(Sample {
                step: asked.step,
                object: object.clone(),
                pose: [fingertip, pointer],
                force: sample.force,
                numbers: parts.concat(),
                event: "",
            });
        }
        Ok(())
    }

    fn table(&self, episode: &Going, layout: usize, number: usize, rate_hz: f64) -> Trajectories {
        let samples = &episode.samples;
        let column = |name: &str, values| Column { name: name.to_owned(), values };
        let numbers = |of: &dyn Fn(&Sample) -> f64| Values::Number(samples.iter().map(of).collect());
        let mut columns = vec![column("episode", Values::Whole(vec![number as u32; samples.len()]))];
        if self.names.len() > 1 {
            columns.push(column("layout", Values::Text(vec![self.names[layout].clone(); samples.len()])));
        }
        let times = (1..=samples.len()).map(|k| k as f64 / rate_hz).collect();
        let steps = samples.iter().map(|sample| sample.step.map_or(0, |step| step as u32 + 1)).collect();
        let name = |sample: &Sample| sample.object.as_ref().map(|object| object.name.clone()).unwrap_or_default();
        columns.extend([
            column("time_s", Values::Number(times)),
            column("step", Values::Whole(steps)),
            column("object", Values::Text(samples.iter().map(name).collect())),
        ]);
        let of_object = |of: &dyn Fn(&Asked) -> f64| numbers(&|sample| sample.object.as_ref().map_or(f64::NAN, of));
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            columns.push(column(&format!("object_{letter}_m"), of_object(&|object| object.at[axis])));
        }
        columns.push(column("object_width_m", of_object(&|object| object.width)));
        let task = self.skeletons[0].task();
        let points_itself = task.pointer == Pointer::Fingertip && task.steps.iter().all(|step| step.lead.is_none());
        for (index, point) in ["fingertip", "pointer"].iter().enumerate().take(if points_itself { 1 } else { 2 }) {
            for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
                columns.push(column(&format!("{point}_{letter}_m"), numbers(&|sample| sample.pose[index][axis])));
            }
        }
        columns.push(column("force_n", numbers(&|sample| sample.force)));
        columns.push(column("event", Values::Text(samples.iter().map(|sample| sample.event.to_owned()).collect())));
        let named = self.body_columns().into_iter().enumerate();
        columns.extend(named.map(|(k, name)| Column { name, values: numbers(&|sample| f64::from(sample.numbers[k])) }));
        Trajectories { columns }
    }

    /// Names of what is written down of joints and muscles.
    fn body_columns(&self) -> Vec<String> {
        let unit = |kind: &JointKind| if *kind == JointKind::Hinge { "rad" } else { "m" };
        let positions = self.joints.iter().map(|(name, kind)| format!("{name}_{}", unit(kind)));
        let velocities = self.joints.iter().map(|(name, kind)| format!("{name}_{}_s", unit(kind)));
        let activations = self.muscles.iter().map(|name| format!("{name}_activation"));
        let forces = self.muscles.iter().map(|name| format!("{name}_force_n"));
        let turned = |kind: &JointKind| if *kind == JointKind::Hinge { "torque_nm" } else { "force_n" };
        let torques = self.joints.iter().map(|(name, kind)| format!("{name}_{}", turned(kind)));
        let powers = ["mechanical_w", "metabolic_w"].map(str::to_owned);
        let muscles = positions.chain(velocities).chain(activations).chain(forces);
        muscles.chain(torques).chain(powers).collect()
    }
}

impl Going {
    /// Writes what happened beside the samples in which it did: which steps were done, and how many samples there were from the entry of each to its end.
    fn end(&mut self, is_done: impl Fn(usize) -> bool, after_entry: impl Fn(usize) -> Option<usize>, is_success: bool) {
        self.is_over = true;
        let (Some(last), length) = (self.samples.last(), self.samples.len()) else { return };
        let done_last = last.step.filter(|&step| is_done(step));
        self.over.extend(done_last.map(|step| (step, length)));
        for &(step, end) in &self.over {
            if !is_done(step) {
                self.samples[end - 1].event = "given_up";
                continue;
            }
            if let Some(entry) = after_entry(step).and_then(|since| end.checked_sub(since)) {
                // An entry in the very last sample is told before it: a sample has one event.
                self.samples[entry.min(end.saturating_sub(2))].event = "entered";
            }
            self.samples[end - 1].event = "done";
        }
        if is_success {
            self.samples[length - 1].event = "success";
        } else if done_last.is_none() {
            // Else the last step is done, and one before it was given up.
            self.samples[length - 1].event = "time_out";
        }
    }
}

/// The object of an index.
fn object(skeleton: &Skeleton, pose: &SkeletonPose, index: usize) -> Asked {
    let object = &pose.objects[index];
    Asked {
        name: skeleton.task().objects[index].name.clone(),
        at: object.frame.position.array(),
        width: 2.0 * object.half_size[1],
    }
}
