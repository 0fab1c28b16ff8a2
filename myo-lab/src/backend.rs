//! What environments run on: the backend that was asked for, the device that is used, and training there.

use std::error::Error;

use myo_env::gpu::GpuOptions;
use myo_env::{BuildError, CpuEnv, EnvConfig, EnvSpec, GpuEnv, Rules, VectorEnv};
use myo_gpu::{AdapterChoice, Gpu, GpuError};
use myo_model::Model;
use myo_tasks::Task;
use myo_train::gpu::{DeviceEvaluator, compile_ahead};
use myo_train::session::{Examiner, Goal};
use myo_train::{Checkpoint, Member, PpoConfig, Session, TrainError, Trainer};

use crate::users::User;

/// [`Backend::Auto`] takes a graphics card from this many environments per thread of the processor.
///
/// A step on a card takes as long for one environment as for some thousands: 0.15 ms on an H200. In that time two AVX-512
/// threads step 110 environments, and sixteen 300.
pub const AUTO_ENVS_PER_THREAD: usize = 64;

/// Simulated seconds of all environments together after which a training stops unless asked otherwise.
const LONGEST_TRAINING_S: f64 = 1e7;

/// Control steps of all environments after which a training stops unless asked otherwise: 200 million at 20 Hz.
pub fn default_steps(control_dt_s: f64) -> u64 {
    (LONGEST_TRAINING_S / control_dt_s).round() as u64
}

/// Environments for looks at a policy: on the processor enough to keep it busy, on a card as many as take no longer than one.
const LOOK_ENVS: [usize; 2] = [256, 1024];

/// The backend that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Backend {
    /// Whichever is faster on this machine.
    Auto,
    /// The processor.
    Cpu,
    /// This adapter.
    Gpu(AdapterChoice),
}

/// The device that is used.
#[derive(Clone, Debug)]
pub enum Device {
    /// The processor.
    Cpu,
    /// An open graphics card.
    Gpu(Gpu),
}

/// Environments on a device.
pub enum Envs {
    /// On the processor.
    Cpu(Box<CpuEnv>),
    /// On a graphics card.
    Gpu(Box<GpuEnv>),
}

/// How a training starts.
pub enum Start<'a> {
    /// With a new policy.
    New {
        /// Its settings.
        config: &'a PpoConfig,
        /// Seed of everything random.
        seed: u64,
        /// The run whose networks it starts from, if any; see [`Trainer::warm_start`].
        from: Option<&'a Checkpoint>,
    },
    /// Where it was stopped.
    Resumed(&'a Checkpoint),
}

impl Start<'_> {
    /// Seed of the training.
    pub fn seed(&self) -> u64 {
        match self {
            Self::New { seed, .. } => *seed,
            Self::Resumed(checkpoint) => checkpoint.seed(),
        }
    }

    fn member(&self) -> Member<'_> {
        match self {
            Self::New { config, seed, .. } => Member::New { config, seed: *seed },
            Self::Resumed(checkpoint) => Member::Resumed(checkpoint),
        }
    }

    fn from(&self) -> Option<&Checkpoint> {
        if let Self::New { from, .. } = self { *from } else { None }
    }
}

fn not_on_a_card() -> TrainError {
    let (what, expected) = ("the device of several trainings at once", "a graphics card".to_owned());
    TrainError::Mismatch { what, got: "the processor".into(), expected }
}

/// [`Backend::Auto`] takes a graphics card from this many environments, in this pool of threads.
pub fn auto_envs() -> usize {
    AUTO_ENVS_PER_THREAD * rayon::current_num_threads()
}

impl Backend {
    /// The device for this many environments. `notice` is told why an available graphics card is not used.
    ///
    /// # Errors
    /// The card that was asked for is not available.
    pub fn device(&self, num_envs: usize, notice: &mut dyn FnMut(&dyn Error)) -> Result<Device, GpuError> {
        match self {
            Self::Cpu => Ok(Device::Cpu),
            Self::Gpu(choice) => Gpu::open(choice).map(Device::Gpu),
            Self::Auto if num_envs < auto_envs() => Ok(Device::Cpu),
            Self::Auto => Ok(Gpu::open(&AdapterChoice::Hardware).map_or_else(
                |error| {
                    if !matches!(error, GpuError::NoAdapter | GpuError::OnlySoftware { .. }) {
                        notice(&error);
                    }
                    Device::Cpu
                },
                Device::Gpu,
            )),
        }
    }

    /// Environments for layouts, tasks of one structure, on the backend that was asked for. With [`Backend::Auto`], what a graphics
    /// card refuses is built on the processor, and `notice` is told why.
    ///
    /// # Errors
    /// A task or the model cannot be simulated, structures differ, or the card that was asked for is not available.
    pub fn build(
        &self,
        model: &Model,
        layouts: &[Task],
        config: &EnvConfig,
        notice: &mut dyn FnMut(&dyn Error),
    ) -> Result<Envs, BuildError> {
        let device = self.device(config.num_envs, notice)?;
        self.build_at(device, notice, |device| Envs::with_layouts(device, model, layouts, config))
    }

    /// The same to [train in](Envs::for_training) with these settings and this seed.
    ///
    /// # Errors
    /// As for [`build`](Self::build).
    pub fn build_for_training(
        &self,
        model: &Model,
        layouts: &[Task],
        (config, seed): (&PpoConfig, u64),
        notice: &mut dyn FnMut(&dyn Error),
    ) -> Result<Envs, BuildError> {
        let device = self.device(config.num_envs, notice)?;
        self.build_at(device, notice, |device| Envs::for_training(device, model, layouts, (config, seed)))
    }

    fn build_at<T>(
        &self,
        device: Device,
        notice: &mut dyn FnMut(&dyn Error),
        make: impl Fn(&Device) -> Result<T, BuildError>,
    ) -> Result<T, BuildError> {
        match make(&device) {
            Err(
                error @ (BuildError::TooLargeForGpu { .. }
                | BuildError::DriverBrokeDown { .. }
                | BuildError::MeshesOnGpu
                | BuildError::OutOfGpuMemory { .. }
                | BuildError::Gpu(_)),
            ) if *self == Self::Auto => {
                notice(&error);
                make(&Device::Cpu)
            }
            made => made,
        }
    }
}

impl Device {
    /// Name of the backend, `cpu` or `gpu`.
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu(_) => "gpu",
        }
    }

    /// The same device for so many trainings at once, see [`Envs::sessions`]; none where they would run one after the other
    /// anyway, on the processor.
    ///
    /// # Errors
    /// More trainings than a card takes at once, or the card is lost.
    pub fn for_several(&self, trainings: usize) -> Result<Option<Self>, GpuError> {
        match self {
            Self::Cpu => Ok(None),
            Self::Gpu(gpu) => gpu.in_groups(trainings).map(|gpu| Some(Self::Gpu(gpu))),
        }
    }

    /// Name of the graphics card, if it is one.
    pub fn card(&self) -> Option<&str> {
        match self {
            Self::Cpu => None,
            Self::Gpu(gpu) => Some(&gpu.adapter().name),
        }
    }
}

impl Envs {
    /// Environments for a task on this device.
    ///
    /// # Errors
    /// The task or model cannot be simulated there.
    pub fn new(device: &Device, model: &Model, task: &Task, config: &EnvConfig) -> Result<Self, BuildError> {
        Self::with_layouts(device, model, std::slice::from_ref(task), config)
    }

    /// The same with several layouts, tasks of one structure: environment `env` does the task of number `env` modulo how many
    /// there are.
    ///
    /// # Errors
    /// As for [`new`](Self::new); there is no task, or more than environments, or their structures differ.
    pub fn with_layouts(
        device: &Device,
        model: &Model,
        layouts: &[Task],
        config: &EnvConfig,
    ) -> Result<Self, BuildError> {
        Ok(match device {
            Device::Cpu => Self::Cpu(Box::new(CpuEnv::with_layouts(model, layouts, config)?)),
            Device::Gpu(gpu) => {
                let env = GpuEnv::with_layouts(gpu, model, layouts, config, &GpuOptions::default())?;
                Self::Gpu(Box::new(env))
            }
        })
    }

    /// The same to train in with these settings and this seed. On a card, the kernels of the training are compiled beside those of
    /// the environments, which take longer: a training that begins there later finds them.
    ///
    /// # Errors
    /// As for [`with_layouts`](Self::with_layouts).
    pub fn for_training(
        device: &Device,
        model: &Model,
        layouts: &[Task],
        (config, seed): (&PpoConfig, u64),
    ) -> Result<Self, BuildError> {
        rayon::in_place_scope(|scope| {
            if let Device::Gpu(gpu) = device {
                scope.spawn(|_| prepare_training(gpu, model, layouts, config));
            }
            Self::with_layouts(device, model, layouts, &config.envs(seed))
        })
    }

    /// What they are computed on.
    pub fn device(&self) -> Device {
        match self {
            Self::Cpu(_) => Device::Cpu,
            Self::Gpu(env) => Device::Gpu(env.gpu().clone()),
        }
    }

    /// The environments, whatever they are.
    pub fn as_env(&mut self) -> &mut dyn VectorEnv {
        match self {
            Self::Cpu(env) => env.as_mut(),
            Self::Gpu(env) => env.as_mut(),
        }
    }

    /// The environments, whatever they are.
    pub fn boxed(self) -> Box<dyn VectorEnv> {
        match self {
            Self::Cpu(env) => env,
            Self::Gpu(env) => env,
        }
    }

    /// Environments whose task is judged by rules of one's own, on this device.
    ///
    /// # Errors
    /// As for [`CpuEnv::with_rules`] and [`GpuEnv::with_rules`].
    pub fn with_rules(
        device: &Device,
        model: &Model,
        task: &Task,
        rules: &impl Rules,
        config: &EnvConfig,
    ) -> Result<Self, BuildError> {
        Ok(match device {
            Device::Cpu => Self::Cpu(Box::new(CpuEnv::with_rules(model, task, rules, config)?)),
            Device::Gpu(gpu) => Self::Gpu(Box::new(GpuEnv::with_rules(gpu, model, task, rules, config)?)),
        })
    }

    /// More environments of the same layouts and model on the same device, in which to look at a policy.
    ///
    /// # Errors
    /// No memory left, or the card is lost.
    pub fn for_looks(&self, seed: u64) -> Result<Self, BuildError> {
        let config = |num_envs| EnvConfig { num_envs, seed, ..EnvConfig::default() };
        let [host, card] = LOOK_ENVS;
        Ok(match self {
            Self::Cpu(env) => Self::Cpu(Box::new(env.sibling(&config(look_envs(host, env.spec())))?)),
            Self::Gpu(env) => Self::Gpu(Box::new(env.sibling(&config(look_envs(card, env.spec())))?)),
        })
    }

    /// A training that acts and learns where these environments are, and looks at its goal in `looks`, as from
    /// [`Envs::for_looks`].
    ///
    /// # Errors
    /// The settings or the checkpoint do not fit, or the card is lost.
    pub fn session(self, looks: Self, start: Start<'_>, goal: Goal) -> Result<Session, TrainError> {
        match start {
            Start::New { config, seed, from } => {
                let mut trainer = self.train(config.clone(), seed)?;
                from.map(|other| trainer.warm_start(other)).transpose()?;
                let examiner = looks.examine(&trainer)?;
                Session::new(trainer, examiner, goal)
            }
            Start::Resumed(checkpoint) => {
                let trainer = self.go_on(checkpoint)?;
                let examiner = looks.examine(&trainer)?;
                Session::resume(trainer, examiner, goal, checkpoint)
            }
        }
    }

    /// Several trainings at once in environments that are [for so many](Device::for_several), as are `looks`. Each is what
    /// [`Envs::session`] makes of its start, bit for bit, but must advance in a thread of its own: one waits for the others.
    ///
    /// # Errors
    /// Environments for another number of trainings or on the processor, settings that differ in more than step sizes;
    /// otherwise as for [`Envs::session`].
    pub fn sessions(self, looks: Self, starts: &[Start<'_>], goal: Goal) -> Result<Vec<Session>, TrainError> {
        let (Self::Gpu(env), Self::Gpu(looks)) = (self, looks) else { return Err(not_on_a_card()) };
        let members: Vec<_> = starts.iter().map(Start::member).collect();
        let mut trainers = Trainer::several_on_card(*env, &members)?;
        for (trainer, start) in trainers.iter_mut().zip(starts) {
            start.from().map(|other| trainer.warm_start(other)).transpose()?;
        }
        let evaluators = DeviceEvaluator::several(*looks, &trainers)?;
        let session = |((trainer, evaluator), start): ((Trainer, _), &Start<'_>)| {
            let examiner = Examiner::on_card(evaluator, trainer.seed());
            match start {
                Start::New { .. } => Session::new(trainer, examiner, goal),
                Start::Resumed(checkpoint) => Session::resume(trainer, examiner, goal, checkpoint),
            }
        };
        trainers.into_iter().zip(evaluators).zip(starts).map(session).collect()
    }

    /// As [`Envs::sessions`], of new users, each of whom does a task of its own. All tasks must have the structure of these
    /// environments' task.
    ///
    /// # Errors
    /// A task of another structure; otherwise as for [`Envs::sessions`].
    pub fn sessions_of(
        self,
        looks: Self,
        users: &[User<'_>],
        config: &PpoConfig,
        goal: Goal,
    ) -> Result<Vec<Session>, TrainError> {
        let (Self::Gpu(env), Self::Gpu(looks)) = (self, looks) else { return Err(not_on_a_card()) };
        let members: Vec<Member<'_>> =
            users.iter().map(|user| Member::Of { task: user.task, config, seed: user.seed }).collect();
        let trainers = Trainer::several_on_card(*env, &members)?;
        let mut evaluators = DeviceEvaluator::several(*looks, &trainers)?;
        for (evaluator, user) in evaluators.iter_mut().zip(users) {
            evaluator.set_task(user.task)?;
        }
        let session = |(trainer, evaluator): (Trainer, _)| {
            let examiner = Examiner::on_card(evaluator, trainer.seed());
            Session::new(trainer, examiner, goal)
        };
        trainers.into_iter().zip(evaluators).map(session).collect()
    }

    /// A trainer with a new policy, which acts and learns where the environments are.
    ///
    /// # Errors
    /// The settings do not fit, or the card is lost.
    pub fn train(self, config: PpoConfig, seed: u64) -> Result<Trainer, TrainError> {
        match self {
            Self::Cpu(env) => Trainer::new(env, config, seed),
            Self::Gpu(env) => Trainer::on_card(*env, config, seed),
        }
    }

    /// A trainer that goes on from a checkpoint, of this backend or another.
    ///
    /// # Errors
    /// The checkpoint does not fit, or the card is lost.
    pub fn go_on(self, checkpoint: &Checkpoint) -> Result<Trainer, TrainError> {
        match self {
            Self::Cpu(env) => Trainer::restore(env, checkpoint),
            Self::Gpu(env) => Trainer::restore_on_card(*env, checkpoint),
        }
    }

    /// Looks at the policies of a trainer, in these environments.
    ///
    /// # Errors
    /// They do not fit the policy, or the card is lost.
    pub fn examine(self, trainer: &Trainer) -> Result<Examiner, TrainError> {
        Ok(match self {
            Self::Cpu(env) => Examiner::on_host(env, trainer.seed()),
            Self::Gpu(env) => Examiner::on_card(DeviceEvaluator::new(*env, &trainer.policy())?, trainer.seed()),
        })
    }
}

/// Environments to look at a policy in, of `usual` ones: every layout needs one.
fn look_envs(usual: usize, spec: &EnvSpec) -> usize {
    usual.max(spec.layouts())
}

/// Compiles the kernels of a training and of looks at it. What is wrong with its environments is told by those who make them.
fn prepare_training(gpu: &Gpu, model: &Model, layouts: &[Task], config: &PpoConfig) {
    if let Ok(spec) = EnvSpec::of_layouts(model, layouts, &config.envs(0)) {
        compile_ahead(gpu, &spec, config, look_envs(LOOK_ENVS[1], &spec));
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    #[test]
    fn few_environments_stay_on_the_processor() {
        let mut silent = |error: &dyn Error| panic!("{error}");
        assert!(matches!(Backend::Auto.device(auto_envs() - 1, &mut silent).unwrap(), Device::Cpu));
    }

    #[test]
    fn what_is_too_large_for_a_card_is_built_on_the_processor_only_if_that_was_left_open() {
        let (tries, mut heard) = (Cell::new(0), Vec::new());
        let make = |device: &Device| {
            tries.set(tries.get() + 1);
            if tries.get() % 2 == 1 {
                Err(BuildError::TooLargeForGpu { operations: 9, most: 1 })
            } else {
                Ok(device.backend())
            }
        };
        let made = Backend::Auto.build_at(Device::Cpu, &mut |error| heard.push(error.to_string()), make).unwrap();
        assert_eq!((made, heard.len()), ("cpu", 1));
        let error =
            Backend::Gpu(AdapterChoice::Hardware).build_at(Device::Cpu, &mut |_| unreachable!(), make).unwrap_err();
        assert!(error.to_string().contains("9 operations"), "{error}");
    }
}
