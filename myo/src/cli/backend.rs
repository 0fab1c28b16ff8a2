//! What computes the physics: what was asked for, and what is taken.

use clap::{Args, ValueEnum};
use myo::env::{BuildError, EnvConfig};
use myo::gpu::{AdapterChoice, GpuError};
use myo::model::Model;
use myo::tasks::Task;
use myo::train::PpoConfig;
use myo::{Backend, Device, Envs};

use super::failure::{Failure, Result, complain};

/// The options of every command that simulates.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// What computes the physics [default: auto, in benches cpu]
    #[arg(long, value_enum)]
    pub backend: Option<BackendName>,

    /// Graphics card, by its number or a part of its name, see `myo devices`; a software adapter is taken only if it is named
    #[arg(long, value_name = "NAME")]
    pub device: Option<String>,
}

/// What computes the physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BackendName {
    /// A graphics card where there is one and enough environments for it, else the processor
    Auto,
    /// Processor cores
    Cpu,
    /// A graphics card
    Gpu,
}

impl Options {
    /// Whether any was given.
    pub fn is_given(&self) -> bool {
        self.backend.is_some() || self.device.is_some()
    }

    /// What they ask for; a named device asks for a graphics card.
    pub fn choice(&self, default: BackendName) -> Result<Backend> {
        match (self.backend, &self.device) {
            (Some(BackendName::Cpu), Some(name)) => Err(Failure::sentence(format!(
                "`--device {name}` names a graphics card, but `--backend cpu` takes none; leave one of them out"
            ))),
            (_, Some(name)) => Ok(Backend::Gpu(AdapterChoice::Named(name.clone()))),
            (backend, None) => Ok(match backend.unwrap_or(default) {
                BackendName::Auto => Backend::Auto,
                BackendName::Cpu => Backend::Cpu,
                BackendName::Gpu => Backend::Gpu(AdapterChoice::Hardware),
            }),
        }
    }
}

/// The device for this many environments; tells the user why an available graphics card is not used.
pub fn device(backend: &Backend, num_envs: usize) -> Result<Device> {
    backend.device(num_envs, &mut warn).map_err(|error| refusal(&error))
}

/// Environments for layouts on this backend; tells the user why a graphics card is not used.
pub fn build(backend: &Backend, model: &Model, layouts: &[Task], config: &EnvConfig) -> Result<Envs> {
    backend.build(model, layouts, config, &mut warn).map_err(unbuilt)
}

/// As [`build`], to train in with these settings and this seed.
pub fn build_for_training(
    backend: &Backend,
    model: &Model,
    layouts: &[Task],
    training: (&PpoConfig, u64),
) -> Result<Envs> {
    backend.build_for_training(model, layouts, training, &mut warn).map_err(unbuilt)
}

/// As [`build_for_training`], with as many environments for each of several trainings at once; none on the processor.
pub fn build_several(
    backend: &Backend,
    model: &Model,
    layouts: &[Task],
    config: &PpoConfig,
    trainings: usize,
) -> Result<Option<Envs>> {
    let Some(device) = device(backend, config.num_envs)?.for_several(trainings)? else { return Ok(None) };
    Ok(Some(Envs::for_training(&device, model, layouts, (config, 0))?))
}

fn unbuilt(error: BuildError) -> Failure {
    match error {
        BuildError::Gpu(error) => refusal(&error),
        other => other.into(),
    }
}

fn warn(error: &dyn std::error::Error) {
    complain(&format!("warning: {error}\nthe processor is taken instead"));
}

fn refusal(error: &GpuError) -> Failure {
    match error {
        GpuError::OnlySoftware { found } => Failure::sentence(format!(
            "only a software adapter is there ({}), which computes on the processor; take `--backend cpu`, or ask for the \
             adapter with `--device 0`",
            found.join(", ")
        )),
        _ => Failure::sentence(error.to_string()),
    }
}

/// A device, for people.
pub fn sentence(device: &Device) -> String {
    match device.card() {
        None => format!("the cpu ({} threads)", rayon::current_num_threads()),
        Some(device) => format!("the gpu ({device})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn choice(backend: Option<BackendName>, device: Option<&str>) -> Result<Backend> {
        Options { backend, device: device.map(String::from) }.choice(BackendName::Auto)
    }

    #[test]
    fn a_device_asks_for_a_graphics_card() {
        let named = Backend::Gpu(AdapterChoice::Named("rtx".into()));
        assert_eq!(choice(None, Some("rtx")).unwrap(), named);
        assert_eq!(choice(Some(BackendName::Gpu), Some("rtx")).unwrap(), named);
        assert_eq!(choice(Some(BackendName::Gpu), None).unwrap(), Backend::Gpu(AdapterChoice::Hardware));
        assert_eq!(
            (choice(None, None).unwrap(), choice(Some(BackendName::Cpu), None).unwrap()),
            (Backend::Auto, Backend::Cpu)
        );
        match choice(Some(BackendName::Cpu), Some("rtx")) {
            Err(Failure::Sentence(text)) => assert!(text.contains("leave one of them out"), "{text}"),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn software_alone_is_refused_with_both_ways_out() {
        let error = GpuError::OnlySoftware { found: vec!["llvmpipe".into()] };
        let Failure::Sentence(text) = refusal(&error) else { panic!("one sentence") };
        let parts = ["only a software adapter is there (llvmpipe)", "--backend cpu", "--device 0"];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }
}
