//! Which lanes this processor has, and how to run a task on them.

use std::ffi::OsStr;
use std::fmt;
use std::sync::OnceLock;

use crate::scalar::Scalar;

/// Environment variable that asks for a level by its name.
const VARIABLE: &str = "MYO_LEVEL";

/// An instruction-set level that this processor has: there is no way to make another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Level(Instructions);

/// Instruction sets that lanes are written for, narrowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Instructions {
    /// Eight lanes in plain arrays; on aarch64 the compiler makes NEON of them.
    Portable,
    /// Eight lanes, AVX2 and FMA.
    Avx2,
    /// Sixteen lanes, AVX-512 F, BW, DQ and VL.
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
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn are_available(self) -> bool {
        self == Self::Portable
    }

    /// Short lower-case name.
    fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }
}

impl Level {
    /// The level that this process computes with: the one that the environment variable `MYO_LEVEL` asks for
    /// (`portable`, `avx2`, `avx512`), or the widest of the processor where it is not set or empty. It is read once.
    ///
    /// # Errors
    /// `MYO_LEVEL` names no level, or one that the processor lacks. Programs should ask when they start.
    pub fn detect() -> Result<Self, LevelError> {
        static DETECTED: OnceLock<Result<Level, LevelError>> = OnceLock::new();
        DETECTED.get_or_init(|| Self::asked(std::env::var_os(VARIABLE).as_deref())).clone()
    }

    /// The same for code that cannot fail: the widest level where [`Level::detect`] is an error.
    #[inline]
    pub fn current() -> Self {
        static CURRENT: OnceLock<Level> = OnceLock::new();
        *CURRENT.get_or_init(|| Self::detect().unwrap_or_else(|_| Self::widest()))
    }

    /// The widest level of this processor, whatever `MYO_LEVEL` says.
    pub fn widest() -> Self {
        Self::available().pop().expect("the portable level is always there")
    }

    /// The level of a name that [`Level::name`] gives.
    ///
    /// # Errors
    /// There is no such name, or the processor lacks the level.
    pub fn named(name: &str) -> Result<Self, LevelError> {
        let found = Self::available().into_iter().find(|level| level.name() == name);
        found.ok_or_else(|| LevelError { name: name.to_owned(), from_variable: false })
    }

    /// The level that the value of [`VARIABLE`] asks for.
    fn asked(value: Option<&OsStr>) -> Result<Self, LevelError> {
        match value {
            Some(name) if !name.is_empty() => {
                Self::named(&name.to_string_lossy()).map_err(|error| LevelError { from_variable: true, ..error })
            }
            _ => Ok(Self::widest()),
        }
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
        self.0.name()
    }

    /// Its instruction sets, which this processor has.
    #[inline]
    pub fn instructions(self) -> Instructions {
        self.0
    }
}

/// A level was asked for that there is not, or not here. The message names those that there are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LevelError {
    name: String,
    from_variable: bool,
}

impl fmt::Display for LevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names =
            |sets: &mut dyn Iterator<Item = Instructions>| sets.map(Instructions::name).collect::<Vec<_>>().join(", ");
        let all = names(&mut Instructions::ALL.into_iter());
        let here = names(&mut Level::available().into_iter().map(Level::instructions));
        let is_known = Instructions::ALL.iter().any(|set| set.name() == self.name);
        let subject = if self.from_variable { format!("{VARIABLE} is") } else { "level".to_owned() };
        let fault = if is_known { "which this processor lacks" } else { "which is no level" };
        write!(f, "{subject} {:?}, {fault}; levels are {all}, and this processor has {here}", self.name)
    }
}

impl std::error::Error for LevelError {}

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variable_asks_for_a_level() {
        assert_eq!(Level::asked(None), Ok(Level::widest()));
        assert_eq!(Level::asked(Some("".as_ref())), Ok(Level::widest()));
        for level in Level::available() {
            assert_eq!(Level::asked(Some(level.name().as_ref())), Ok(level));
        }
    }

    #[test]
    fn a_name_that_is_no_level_is_an_error_that_names_those_there_are() {
        let here = Level::available().into_iter().map(Level::name).collect::<Vec<_>>().join(", ");
        let tail = format!("which is no level; levels are portable, avx2, avx512, and this processor has {here}");
        let message = |name: &str| Level::asked(Some(name.as_ref())).unwrap_err().to_string();
        assert_eq!(message("avx"), format!("MYO_LEVEL is \"avx\", {tail}"));
        assert_eq!(message("AVX2"), format!("MYO_LEVEL is \"AVX2\", {tail}"));
        assert_eq!(Level::named("sse").unwrap_err().to_string(), format!("level \"sse\", {tail}"));
    }

    /// Another processor's level cannot be tried here, but every processor lacks one or has them all.
    #[test]
    fn a_level_that_the_processor_lacks_is_an_error() {
        for set in Instructions::ALL.into_iter().filter(|set| !set.are_available()) {
            let message = Level::asked(Some(set.name().as_ref())).unwrap_err().to_string();
            assert!(message.contains("which this processor lacks"), "{message}");
        }
    }
}
