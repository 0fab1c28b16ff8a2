//! Which lanes this processor has, and how to run a kernel on them.

use crate::scalar::Scalar;

/// An instruction-set level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Level {
    /// Eight lanes in plain arrays; on aarch64 the compiler makes NEON of them.
    Portable,
    /// Eight lanes, AVX2 and FMA.
    Avx2,
    /// Sixteen lanes, AVX-512.
    Avx512,
}

impl Level {
    /// The widest level of this processor. The environment variable `MYO_LEVEL` (`portable`, `avx2`, `avx512`) asks for a
    /// narrower one; a level that the processor lacks is never chosen.
    pub fn detect() -> Self {
        let best = Self::widest();
        match std::env::var("MYO_LEVEL").ok().as_deref() {
            Some("portable") => Self::Portable,
            Some("avx2") => best.min(Self::Avx2),
            _ => best,
        }
    }

    #[cfg(target_arch = "x86_64")]
    fn widest() -> Self {
        if is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            Self::Avx512
        } else if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            Self::Avx2
        } else {
            Self::Portable
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn widest() -> Self {
        Self::Portable
    }

    /// All levels that this processor can run, narrowest first.
    pub fn available() -> Vec<Self> {
        [Self::Portable, Self::Avx2, Self::Avx512].into_iter().filter(|&level| level <= Self::widest()).collect()
    }

    /// Environments per value at this level.
    pub fn lanes(self) -> usize {
        match self {
            Self::Portable | Self::Avx2 => 8,
            Self::Avx512 => 16,
        }
    }

    /// Short lower-case name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

/// Generic code to run on lanes. `run` and everything that it calls must be `#[inline(always)]`: code that is not
/// inlined into the entry point of its level is compiled without the level's instructions, several times slower.
pub trait Kernel {
    /// What the kernel returns.
    type Output;
    /// Runs on one lane type.
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output;
}

/// Runs a kernel on the lanes of a level, or of the widest level below it that the processor has.
#[inline]
pub fn dispatch<K: Kernel>(level: Level, kernel: K) -> K::Output {
    match level.min(Level::widest()) {
        Level::Portable => kernel.run::<crate::portable::F32x8>(),
        // SAFETY: the level is at most the widest one, whose features were detected.
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => unsafe { run_avx2(kernel) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => unsafe { run_avx512(kernel) },
        #[cfg(not(target_arch = "x86_64"))]
        _ => kernel.run::<crate::portable::F32x8>(),
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn run_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<crate::avx2::F32x8>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
fn run_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<crate::avx512::F32x16>()
}
