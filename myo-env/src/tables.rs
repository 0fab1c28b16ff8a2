//! A model and a task, compiled in the precision of the backend.

use crate::config::BuildError;
use crate::observe::{self, ObservationPart};
use crate::parameters::{JointRange, Parameters, World};
use crate::perceive;
use crate::rows::MAX_LANES;
use crate::rules::Outline;
use crate::saved::Identity;
use myo_dynamics::{CouplingMode, Obstacles, Plan};
use myo_model::Model;
use myo_muscle::{FatigueRates, MuscleGroup};
use myo_scalar::{Real, Scalar};
use myo_tasks::{FlatTask, InvalidTask, Task, TaskError};

/// Boxes that may be touched at once: code grows with each.
const MOST_CONTACTS: usize = 16;

/// One environment: what code is compiled for, and the numbers of its task.
#[derive(Clone, Debug)]
pub struct Tables<C> {
    /// The body.
    pub plan: Plan<C>,
    /// In what it differs from its model, in words.
    body: String,
    /// How surfaces behave that it touches; without boxes.
    surface: Obstacles<C>,
    /// The numbers of the task; with layouts, of the first.
    pub parameters: Parameters<C>,
    /// All numbers of each of several layouts: environment `env` has those of number `env` modulo how many there are. Empty
    /// where all environments have the same.
    layouts: Vec<Vec<C>>,
    /// Whether code is compiled so that every environment reads numbers of its own.
    pub own_numbers: bool,
    /// How many boxes each finger can touch at once, at most.
    pub contacts: usize,
    /// Physics steps per control step.
    pub substeps: u32,
    /// Parts of the observation, in order.
    pub observation: Vec<ObservationPart>,
    /// Of every entry of the observation that a part gives: how many control steps it is late.
    pub delays: Vec<usize>,
    /// Rules that judge in place of the script.
    pub(crate) rules: Option<Outline>,
    /// Of every independent joint, unrounded.
    ranges: Vec<JointRange>,
    /// Of every muscle: which joint it moves.
    groups: Vec<Option<MuscleGroup>>,
    /// Of every muscle: share of the strength of all that fatigues in a control step while it is as active as it can be, unrounded.
    pub(crate) fatigue: Vec<f64>,
    /// Seconds of a physics step, unrounded.
    pub(crate) timestep: f64,
    /// Which model and task these are.
    pub(crate) identity: Identity,
}

impl<C: Real> Tables<C> {
    /// Compiles a model and a task, with the specialised plan.
    ///
    /// # Errors
    /// The task has values out of bounds, or the model cannot be simulated.
    pub fn new(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::with_plan(model, task, None, &|exact| exact.specialised().cast())
    }

    /// The same with several layouts, tasks of one structure.
    ///
    /// # Errors
    /// As for [`Tables::new`]; there is none, or their structures differ.
    pub fn with_layouts(model: &Model, tasks: &[Task]) -> Result<Self, BuildError> {
        Self::of_layouts(model, tasks, None, &|exact| exact.specialised().cast())
    }

    /// The same with several layouts, tasks of one structure, and another plan; `rules` judge in place of the scripts, if given.
    ///
    /// # Errors
    /// As for [`Tables::new`]; there is none, or their structures differ.
    pub(crate) fn of_layouts(
        model: &Model,
        tasks: &[Task],
        rules: Option<Outline>,
        plan: &dyn Fn(&Plan<f64>) -> Plan<C>,
    ) -> Result<Self, BuildError> {
        let mut tables = Self::with_plan(model, tasks.first().ok_or(BuildError::NoLayouts)?, rules, plan)?;
        if tasks.len() > 1 {
            tables.own_numbers = true;
            // Code is made for the layout where most boxes can be touched at once.
            tables.contacts = MOST_CONTACTS;
            let all = tables.all_numbers(tasks)?;
            tables.contacts = all.iter().map(|numbers| tables.contacts_of(numbers)).max().unwrap_or(1);
            tables.put(&all, tasks);
        }
        Ok(tables)
    }

    /// The same with the exact plan, which the specialised one is compared with.
    ///
    /// # Errors
    /// As for [`Tables::new`].
    pub fn exact(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::with_plan(model, task, None, &|exact| exact.cast())
    }

    fn with_plan(
        model: &Model,
        task: &Task,
        rules: Option<Outline>,
        plan: &dyn Fn(&Plan<f64>) -> Plan<C>,
    ) -> Result<Self, BuildError> {
        let flat = flat_of(task, rules.is_some())?;
        let body = task.body.words();
        if body != model.changes {
            return Err(BuildError::OtherBody { task: body, body: model.changes.clone() });
        }
        let task = task.clone().expanded();
        let mut exact = Plan::exact(model, CouplingMode::Reduced)?;
        exact.check_held()?;
        task.check_control_step(exact.timestep).map_err(InvalidTask::from)?;
        let ranges: Vec<JointRange> = exact.dofs.iter().map(|dof| dof.range).collect();
        let groups: Vec<_> = model.muscles.iter().map(|muscle| muscle.parameters.group).collect();
        let fatigue = fatigue_of(&exact, &groups, task.control_dt_s);
        let parameters = Parameters::new(&task, &flat, &ranges, &groups);
        let observation = parts_of(&task, &parameters, rules.as_ref());
        if observation.is_empty() && rules.as_ref().is_none_or(|rules| rules.observed.is_empty()) {
            return Err(nothing_observed().into());
        }
        // Rules may ask for elbow and wrist wherever there are any.
        let has_arm = model.elbow_body.is_some() && model.wrist_body.is_some();
        if parameters.task.pointer.is_ray() || rules.is_some() && has_arm {
            exact = exact.with_arm(model)?;
        }
        exact = exact.with_fingers(model, &flat.fingers)?;
        for finger in flat.pressing_fingers() {
            exact.check_presses(finger, &flat.fingers[finger])?;
        }
        let plan = plan(&exact);
        let surface = Obstacles::none(&plan);
        let contacts = parameters.most_contacts(&surface, &plan);
        if contacts > MOST_CONTACTS {
            return Err(BuildError::Crowded { contacts, most: MOST_CONTACTS });
        }
        Ok(Self {
            body,
            contacts,
            surface,
            layouts: vec![],
            own_numbers: false,
            substeps: task.substeps(exact.timestep),
            delays: perceive::delays(
                &task,
                &observation,
                [exact.ndof(), exact.nmuscle(), parameters.task.fingers.len()],
            ),
            observation,
            parameters,
            identity: Identity::new(model, &[task], rules.as_ref()),
            rules,
            ranges,
            fatigue,
            groups,
            timestep: exact.timestep,
            plan,
        })
    }

    /// The numbers of other tasks of the same structure, and which ones they are: everything may differ but the numbers of steps,
    /// spheres and boxes, which kinds of steps there are, what is observed, the length of a control step, how the reward measures
    /// the distance, and whether there is noise or fatigue and whether it lasts. Environment `env` does the task of number `env` modulo how many there are.
    ///
    /// # Errors
    /// [`BuildError::OtherStructure`] tells what differs; values out of bounds; no task.
    pub fn set_tasks(&mut self, tasks: &[Task]) -> Result<(), BuildError> {
        let all = self.all_numbers(tasks)?;
        if all.len() > 1 && !self.own_numbers {
            let what = "there are several, and these environments were made for one at a time".into();
            return Err(BuildError::OtherStructure { what });
        }
        self.put(&all, tasks);
        Ok(())
    }

    /// The numbers of tasks of this structure; at least one.
    fn all_numbers(&self, tasks: &[Task]) -> Result<Vec<Parameters<C>>, BuildError> {
        let all = tasks.iter().map(|task| self.numbers_of(task)).collect::<Result<Vec<_>, _>>()?;
        if all.is_empty() { Err(BuildError::NoLayouts) } else { Ok(all) }
    }

    /// Lets so much of what effort and acceleration cost count, from 0 to 1.
    pub fn set_cost_share(&mut self, share: f64) {
        let place = self.parameters.cost_share();
        for numbers in &mut self.layouts {
            numbers[place] = C::from_f64(share);
        }
        self.parameters.task.weights.cost_share = C::from_f64(share);
    }

    /// Puts the numbers of tasks, whose values are right, in place.
    fn put(&mut self, all: &[Parameters<C>], tasks: &[Task]) {
        self.layouts = if self.own_numbers { all.iter().map(Parameters::numbers).collect() } else { vec![] };
        let share = self.parameters.task.weights.cost_share.to_f64();
        self.parameters = all[0].clone();
        self.set_cost_share(share);
        let tasks: Vec<Task> = tasks.iter().map(|task| task.clone().expanded()).collect();
        self.identity = self.identity.with_tasks(&tasks, self.rules.as_ref());
    }

    /// The numbers of a task that has this structure.
    fn numbers_of(&self, task: &Task) -> Result<Parameters<C>, BuildError> {
        let flat = flat_of(task, self.rules.is_some())?;
        task.check_control_step(self.timestep).map_err(InvalidTask::from)?;
        let differs = |what: String| BuildError::OtherStructure { what };
        if task.body.words() != self.body {
            return Err(differs("its user has another body (`body`)".into()));
        }
        if task.substeps(self.timestep) != self.substeps {
            let own = f64::from(self.substeps) * self.timestep;
            return Err(differs(format!("its control step is {} s instead of {own} s", task.control_dt_s)));
        }
        let parameters =
            Parameters::new(task, &flat, &self.ranges, &self.groups).in_place_of(&self.parameters).map_err(differs)?;
        if parts_of(task, &parameters, self.rules.as_ref()) != self.observation {
            return Err(differs("it is observed in another way".into()));
        }
        let widths = [self.plan.ndof(), self.plan.nmuscle(), parameters.task.fingers.len()];
        if perceive::delays(task, &self.observation, widths) != self.delays {
            return Err(differs("it is perceived with another delay".into()));
        }
        let (contacts, most) = (self.contacts_of(&parameters), self.contacts);
        if contacts > most {
            return Err(differs(format!("{contacts} of its boxes may be touched at once instead of {most}")));
        }
        Ok(parameters)
    }

    /// How many numbers `parameters` has for each environment where programs are recorded; none where all share them.
    pub(crate) fn own_rows(&self) -> usize {
        self.layouts.first().map_or(0, Vec::len)
    }

    /// What lies in the buffer `parameters` of recorded programs for so many environments from `first` on.
    pub(crate) fn columns(&self, first: usize, num_envs: usize) -> Vec<f32> {
        let narrow = |number: C| number.to_f64() as f32;
        if self.layouts.is_empty() {
            return self.parameters.numbers().into_iter().map(narrow).collect();
        }
        let row = |row: usize| (first..first + num_envs).map(move |env| narrow(self.layout(env)[row]));
        (0..self.own_rows()).flat_map(row).collect()
    }

    /// How many boxes each finger can touch at once, at most.
    fn contacts_of(&self, parameters: &Parameters<C>) -> usize {
        parameters.most_contacts(&self.surface, &self.plan)
    }

    /// All numbers of the task of an environment, in the order of [`Parameters::map`].
    fn layout(&self, env: usize) -> &[C] {
        &self.layouts[env % self.layouts.len()]
    }

    /// Share of a control step that a physics step is.
    #[inline(always)]
    pub fn share(&self) -> f64 {
        1.0 / f64::from(self.substeps)
    }

    /// Length of a control step (s).
    #[inline(always)]
    pub fn control_dt(&self) -> f64 {
        f64::from(self.substeps) * self.timestep
    }

    /// Steps of the task; none under rules of one's own.
    pub fn steps(&self) -> usize {
        self.parameters.task.steps.len()
    }

    /// What fingers can press.
    pub fn obstacles(&self) -> Obstacles<C> {
        self.parameters.obstacles(&self.surface)
    }

    /// The same numbers in every lane.
    #[inline(always)]
    pub fn splat<S: Scalar<Const = C>>(&self) -> World<'_, S> {
        self.with(self.parameters.map(&mut |&number| S::splat(number)))
    }

    /// The numbers of each environment's task, for the lanes from environment `first` on.
    #[inline(always)]
    pub fn world<S: Scalar<Const = C>>(&self, first: usize) -> World<'_, S> {
        if self.layouts.is_empty() {
            return self.splat();
        }
        let lanes: [&[C]; MAX_LANES] = std::array::from_fn(|lane| self.layout(first + lane));
        let mut row = 0;
        self.with(self.parameters.map(&mut |_| {
            let mut numbers = [C::default(); MAX_LANES];
            for (number, lane) in numbers.iter_mut().zip(lanes) {
                *number = lane[row];
            }
            row += 1;
            S::load(&numbers[..S::LANES])
        }))
    }

    /// With numbers of the lanes' own.
    #[inline(always)]
    pub fn with<S: Scalar<Const = C>>(&self, parameters: Parameters<S>) -> World<'_, S> {
        World { tables: self, obstacles: parameters.obstacles(&self.surface), parameters }
    }
}

/// Objects and steps of a task; under rules no steps.
fn flat_of(task: &Task, has_rules: bool) -> Result<FlatTask, InvalidTask> {
    if has_rules { task.scenery() } else { task.flat() }
}

/// Of every muscle: which share of the strength of all fatigues in so many seconds while it is as active as it can be, with the rates of rested
/// people ([`FatigueRates`]).
fn fatigue_of(plan: &Plan<f64>, groups: &[Option<MuscleGroup>], seconds: f64) -> Vec<f64> {
    let forces = plan.muscles.iter().map(|muscle| muscle.curves.peak_isometric_force().max(0.0));
    let all = forces.clone().sum::<f64>().max(f64::MIN_POSITIVE);
    forces.zip(groups).map(|(force, &group)| FatigueRates::of(group).fatigue_per_s * seconds * force / all).collect()
}

/// What is observed of a task.
fn parts_of<C>(task: &Task, parameters: &Parameters<C>, rules: Option<&Outline>) -> Vec<ObservationPart> {
    let mut parts = observe::parts(&task.observation, parameters);
    parts.retain(|part| rules.is_none() || part.is_of_body());
    parts
}

/// All parts that are asked for are of things that the task has not.
fn nothing_observed() -> InvalidTask {
    let problem = "has no part that this task has; at least one must be true".into();
    TaskError::Value { path: "observation".into(), subject: "`observation`".into(), problem }.into()
}
