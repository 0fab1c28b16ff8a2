//! What computes the physics: what was asked for, and what is taken.

use clap::{Args, ValueEnum};
use myo::env::BuildError;
use myo::gpu::{Gpu, GpuError, Want};

use super::failure::{Failure, Result, complain};

/// Environments per thread of the processor from which on `auto` takes a graphics card.
///
/// A step on a card takes as long for one environment as for some thousands, 0.15 ms on an H200, in which two AVX-512 threads
/// do 110 environments and sixteen 300.
pub const AUTO_ENVS_PER_THREAD: usize = 64;

/// The options of every command that simulates.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// What computes the physics [default: auto, in benches cpu]
    #[arg(long, value_enum)]
    pub backend: Option<Backend>,

    /// Graphics card, by its number or a part of its name, see `myo devices`; only so a software adapter is taken
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

/// What was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wish {
    /// What is faster here.
    Auto,
    /// The processor.
    Cpu,
    /// This adapter.
    Gpu(Want),
}

/// What is taken.
#[derive(Clone, Debug)]
pub enum Place {
    /// The processor.
    Cpu,
    /// An open graphics card.
    Gpu(Gpu),
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

/// Environments from which on `auto` takes a graphics card here.
pub fn auto_envs() -> usize {
    AUTO_ENVS_PER_THREAD * rayon::current_num_threads()
}

impl Wish {
    /// What is taken for so many environments.
    pub fn place(&self, num_envs: usize) -> Result<Place> {
        match self {
            Self::Cpu => Ok(Place::Cpu),
            Self::Gpu(want) => Gpu::open(want).map(Place::Gpu).map_err(|error| refusal(&error)),
            Self::Auto if num_envs < auto_envs() => Ok(Place::Cpu),
            Self::Auto => Ok(Gpu::open(&Want::Hardware).map_or_else(|error| without_card(&error), Place::Gpu)),
        }
    }

    /// Builds something at a place. With `auto`, what a graphics card refuses is built on the processor, and that is told.
    pub fn build<T>(
        &self,
        place: Place,
        make: impl Fn(&Place) -> std::result::Result<T, BuildError>,
    ) -> Result<(Place, T)> {
        match make(&place) {
            Err(error @ (BuildError::TooLargeForGpu { .. } | BuildError::Gpu(_))) if *self == Self::Auto => {
                complain(&format!("warning: {error}\nthe processor is taken instead"));
                Ok((Place::Cpu, make(&Place::Cpu)?))
            }
            made => Ok((place, made?)),
        }
    }
}

/// The processor; a card that is there but cannot be used is worth a word.
fn without_card(error: &GpuError) -> Place {
    if !matches!(error, GpuError::NoAdapter | GpuError::OnlySoftware { .. }) {
        complain(&format!("warning: {error}\nthe processor is taken instead"));
    }
    Place::Cpu
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

impl Place {
    /// Name of the backend.
    pub fn backend(&self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu(_) => "gpu",
        }
    }

    /// Name of the graphics card, if it is one.
    pub fn device(&self) -> Option<&str> {
        match self {
            Self::Cpu => None,
            Self::Gpu(gpu) => Some(&gpu.adapter().name),
        }
    }

    /// For people.
    pub fn sentence(&self) -> String {
        let threads = rayon::current_num_threads();
        match self {
            Self::Cpu => format!("the cpu ({threads} threads)"),
            Self::Gpu(gpu) => format!("the gpu ({})", gpu.adapter().name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish(backend: Option<Backend>, device: Option<&str>) -> Result<Wish> {
        Options { backend, device: device.map(String::from) }.wish(Backend::Auto)
    }

    fn too_large(place: &Place) -> std::result::Result<&'static str, BuildError> {
        static TRIES: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        match TRIES.fetch_add(1, std::sync::atomic::Ordering::Relaxed).is_multiple_of(2) {
            true => Err(BuildError::TooLargeForGpu { operations: 9, most: 1 }),
            false => Ok(place.backend()),
        }
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
    fn few_environments_stay_on_the_processor() {
        assert!(matches!(Wish::Auto.place(auto_envs() - 1).unwrap(), Place::Cpu));
    }

    #[test]
    fn what_is_too_large_for_a_card_is_built_on_the_processor_only_if_that_was_left_open() {
        let (place, made) = Wish::Auto.build(Place::Cpu, too_large).unwrap();
        assert_eq!((place.backend(), made), ("cpu", "cpu"));
        match Wish::Gpu(Want::Hardware).build(Place::Cpu, too_large) {
            Err(Failure::Sentence(text)) => assert!(text.contains("9 operations"), "{text}"),
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
