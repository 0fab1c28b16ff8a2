//! Which lanes this processor has, and how to run a task on them.

use crate::scalar::Scalar;

/// An instruction-set level that this processor has: there is no way to make another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Level(Instructions);

/// Instruction sets that lanes are written for, narrowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Instructions {
    /// Eight lanes in plain arrays; on aarch64 the compiler makes NEON of them.
    Portable,
    /// Eight lanes, AVX2 and FMA.
    Avx2,
    /// Sixteen lanes, AVX-512.
    Avx512,
}

impl Instructions {
    const ALL: [Self; 3] = [Self::Portable, Self::Avx2, Self::Avx512];

    #[cfg(target_arch = "x86_64")]
    fn are_available(self) -> bool {
        match self {
            Self::Portable => true,
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            Self::Avx512 => {
                Self::Avx2.are_available()
                    && is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn are_available(self) -> bool {
        self == Self::Portable
    }
}

impl Level {
    /// The widest level of this processor. The environment variable `MYO_LEVEL` (`portable`, `avx2`, `avx512`) asks for a
    /// narrower one; a level that the processor lacks is never chosen.
    pub fn detect() -> Self {
        let asked = std::env::var("MYO_LEVEL").ok().and_then(|name| Self::named(&name));
        asked.unwrap_or_else(|| Self::available().pop().expect("the portable level is always there"))
    }

    /// The level of a name that [`Level::name`] gives; none if the processor lacks it or there is no such name.
    pub fn named(name: &str) -> Option<Self> {
        Self::available().into_iter().find(|level| level.name() == name)
    }

    /// All levels that this processor can run, narrowest first.
    pub fn available() -> Vec<Self> {
        Instructions::ALL.into_iter().filter(|set| set.are_available()).map(Self).collect()
    }

    /// Environments per value at this level.
    pub fn lanes(self) -> usize {
        match self.0 {
            Instructions::Portable | Instructions::Avx2 => 8,
            Instructions::Avx512 => 16,
        }
    }

    /// Short lower-case name.
    pub fn name(self) -> &'static str {
        match self.0 {
            Instructions::Portable => "portable",
            Instructions::Avx2 => "avx2",
            Instructions::Avx512 => "avx512",
        }
    }
}

/// Generic code to run on lanes. `run` and everything that it calls must be `#[inline(always)]`: code that is not
/// inlined into the entry point of its level is compiled without the level's instructions, several times slower.
pub trait LaneTask {
    /// What the task returns.
    type Output;
    /// Runs on one lane type.
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output;
}

/// Runs a task on the lanes of a level.
#[inline]
pub fn dispatch<T: LaneTask>(level: Level, task: T) -> T::Output {
    match level.0 {
        Instructions::Portable => task.run::<crate::portable::F32x8>(),
        // SAFETY: a `Level` exists only where its features were detected.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx2 => unsafe { run_avx2(task) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Instructions::Avx512 => unsafe { run_avx512(task) },
        #[cfg(not(target_arch = "x86_64"))]
        _ => task.run::<crate::portable::F32x8>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<T: LaneTask>(task: T) -> T::Output {
    task.run::<crate::avx2::F32x8>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn run_avx512<T: LaneTask>(task: T) -> T::Output {
    task.run::<crate::avx512::F32x16>()
}
