//! What computes the physics: what was asked for, and what is taken.

use clap::{Args, ValueEnum};
use myo::env::{BuildError, EnvConfig};
use myo::gpu::{GpuError, Want};
use myo::model::Model;
use myo::tasks::Task;
use myo::{Envs, Place, Wish};

use super::failure::{Failure, Result, complain};

/// The options of every command that simulates.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// What computes the physics [default: auto, in benches cpu]
    #[arg(long, value_enum)]
    pub backend: Option<Backend>,

    /// Graphics card, by its number or a part of its name, see `myo devices`; a software adapter is taken only if it is named
    #[arg(long, value_name = "NAME")]
    pub device: Option<String>,
}

/// What computes the physics.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
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

    /// What they ask for; a named device is a wish for a graphics card.
    pub fn wish(&self, default: Backend) -> Result<Wish> {
        match (self.backend, &self.device) {
            (Some(Backend::Cpu), Some(name)) => Err(Failure::sentence(format!(
                "`--device {name}` names a graphics card, but `--backend cpu` takes none; leave one of them out"
            ))),
            (_, Some(name)) => Ok(Wish::Gpu(Want::Named(name.clone()))),
            (backend, None) => Ok(match backend.unwrap_or(default) {
                Backend::Auto => Wish::Auto,
                Backend::Cpu => Wish::Cpu,
                Backend::Gpu => Wish::Gpu(Want::Hardware),
            }),
        }
    }
}

/// What is taken for so many environments; tells why a graphics card that is there is not.
pub fn place(wish: &Wish, num_envs: usize) -> Result<Place> {
    wish.place(num_envs, &mut warn).map_err(|error| refusal(&error))
}

/// Environments for a task where they are wished; tells why a graphics card is not taken.
pub fn build(wish: &Wish, model: &Model, task: &Task, config: &EnvConfig) -> Result<Envs> {
    wish.build(model, task, config, &mut warn).map_err(|error| match error {
        BuildError::Gpu(error) => refusal(&error),
        other => other.into(),
    })
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

/// A place, for people.
pub fn sentence(place: &Place) -> String {
    match place.device() {
        None => format!("the cpu ({} threads)", rayon::current_num_threads()),
        Some(device) => format!("the gpu ({device})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(backend: Option<Backend>, device: Option<&str>) -> Result<Wish> {
        Options { backend, device: device.map(String::from) }.wish(Backend::Auto)
    }

    #[test]
    fn a_device_is_a_wish_for_a_graphics_card() {
        let named = Wish::Gpu(Want::Named("rtx".into()));
        assert_eq!(wish(None, Some("rtx")).unwrap(), named);
        assert_eq!(wish(Some(Backend::Gpu), Some("rtx")).unwrap(), named);
        assert_eq!(wish(Some(Backend::Gpu), None).unwrap(), Wish::Gpu(Want::Hardware));
        assert_eq!((wish(None, None).unwrap(), wish(Some(Backend::Cpu), None).unwrap()), (Wish::Auto, Wish::Cpu));
        match wish(Some(Backend::Cpu), Some("rtx")) {
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
