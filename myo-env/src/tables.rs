//! A model and a task, compiled in the precision of the backend.

use crate::config::BuildError;
use crate::observe::{self, ObservationPart};
use crate::parameters::{JointRange, Parameters, World};
use crate::saved::Identity;
use myo_dynamics::{CouplingMode, Obstacles, Plan};
use myo_model::Model;
use myo_scalar::{Real, Scalar};
use myo_tasks::{InvalidTask, Task};

/// Boxes that may be touched at once: code grows with each.
const MOST_CONTACTS: usize = 16;

/// One environment: what code is compiled for, and the numbers of its task.
#[derive(Clone, Debug)]
pub struct Tables<C> {
    /// The body.
    pub plan: Plan<C>,
    /// How surfaces behave that it touches; without boxes.
    surface: Obstacles<C>,
    /// The numbers of the task.
    pub parameters: Parameters<C>,
    /// How many boxes the fingertip can touch at once, at most.
    pub contacts: usize,
    /// Physics steps per control step.
    pub substeps: u32,
    /// Parts of the observation, in order.
    pub observation: Vec<ObservationPart>,
    /// Of every independent joint, unrounded.
    ranges: Vec<JointRange>,
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
        Self::with_plan(model, task, |exact| exact.specialised().cast())
    }

    /// The same with the exact plan, which the specialised one is compared with.
    ///
    /// # Errors
    /// As for [`Tables::new`].
    pub fn exact(model: &Model, task: &Task) -> Result<Self, BuildError> {
        Self::with_plan(model, task, |exact| exact.cast())
    }

    fn with_plan(model: &Model, task: &Task, plan: impl Fn(&Plan<f64>) -> Plan<C>) -> Result<Self, BuildError> {
        task.check_values()?;
        let task = task.clone().expanded();
        let exact = Plan::exact(model, CouplingMode::Reduced)?;
        task.check_control_step(exact.timestep).map_err(InvalidTask::from)?;
        let ranges: Vec<JointRange> = exact.dofs.iter().map(|dof| dof.range).collect();
        let plan = plan(&exact);
        let (surface, parameters) = (Obstacles::none(&plan), Parameters::new(&task, &ranges)?);
        let contacts = surface.with(parameters.boxes()).most_at_once(&plan);
        if contacts > MOST_CONTACTS {
            return Err(BuildError::Crowded { contacts, most: MOST_CONTACTS });
        }
        Ok(Self {
            contacts,
            surface,
            parameters,
            substeps: task.substeps(exact.timestep),
            observation: observe::parts(&task.observation),
            identity: Identity::new(model, &task),
            ranges,
            timestep: exact.timestep,
            plan,
        })
    }

    /// The numbers of another task of the same structure, and which one it is: everything may differ but the numbers of steps,
    /// spheres and boxes, which kinds of steps there are, what is observed, the length of a control step, how the reward measures the distance, and whether there is noise.
    ///
    /// # Errors
    /// [`BuildError::OtherStructure`] tells what differs; values out of bounds.
    pub fn set_task(&mut self, task: &Task) -> Result<(), BuildError> {
        task.check_values()?;
        let task = task.clone().expanded();
        task.check_control_step(self.timestep).map_err(InvalidTask::from)?;
        let differs = |what: String| BuildError::OtherStructure { what };
        if task.substeps(self.timestep) != self.substeps {
            let own = f64::from(self.substeps) * self.timestep;
            return Err(differs(format!("its control step is {} s instead of {own} s", task.control_dt_s)));
        }
        if observe::parts(&task.observation) != self.observation {
            return Err(differs("it is observed in another way".into()));
        }
        let parameters = Parameters::new(&task, &self.ranges)?.in_place_of(&self.parameters).map_err(differs)?;
        let (contacts, most) = (self.surface.with(parameters.boxes()).most_at_once(&self.plan), self.contacts);
        if contacts > most {
            return Err(differs(format!("{contacts} of its boxes may be touched at once instead of {most}")));
        }
        self.parameters = parameters;
        self.identity = self.identity.with_task(&task);
        Ok(())
    }

    /// Steps of the task.
    pub fn steps(&self) -> usize {
        self.parameters.task.steps.len()
    }

    /// What the fingertip can press.
    pub fn obstacles(&self) -> Obstacles<C> {
        self.surface.with(self.parameters.boxes())
    }

    /// The same numbers in every lane.
    #[inline(always)]
    pub fn splat<S: Scalar<Const = C>>(&self) -> World<'_, S> {
        self.with(self.parameters.map(&mut |&number| S::splat(number)))
    }

    /// With numbers of the lanes' own.
    #[inline(always)]
    pub fn with<S: Scalar<Const = C>>(&self, parameters: Parameters<S>) -> World<'_, S> {
        World { tables: self, obstacles: self.surface.with(parameters.boxes()), parameters }
    }
}
