//! A training run frozen between two updates, and its file.
//!
//! File: 8 bytes `MYOCKPT\n`, version (u32), length of the payload (u64), CRC-32C of the payload (u32), payload. Little
//! endian throughout. The payload holds the fields of [`Checkpoint`] in order; lists begin with their length (u64); the
//! configuration, the names and what a session remembers are JSON. Version 1 ended before the session; up to version 2 points of
//! its learning curve were other means; up to version 3 settings were per control step, whose length was not told.

use std::path::Path;

use crc32c::crc32c;
use thiserror::Error;

use crate::config::OLD_CONTROL_DT;
use crate::files::{IoError, write_atomically};
use crate::learn::Optimizer;
use crate::networks::Networks;
use crate::normalizer::Normalizer;
use crate::session::{Memory, Trend};
use crate::{Mlp, Policy, PpoConfig};

const MAGIC: &[u8; 8] = b"MYOCKPT\n";
const VERSION: u32 = 4;
/// The oldest version that can be read.
const OLDEST: u32 = 1;
const HEADER: usize = 24;

/// Everything that the next updates depend on.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub(crate) config: PpoConfig,
    /// Seconds per control step.
    pub(crate) control_dt: f64,
    pub(crate) seed: u64,
    pub(crate) updates: u64,
    pub(crate) wall_s: f64,
    pub(crate) learning_rate: f64,
    pub(crate) observation_names: Vec<String>,
    pub(crate) action_names: Vec<String>,
    pub(crate) parameters: Vec<f32>,
    pub(crate) optimizer: Optimizer,
    pub(crate) normalizer: Normalizer,
    pub(crate) observation: Vec<f32>,
    pub(crate) env_state: Vec<u8>,
    /// What the [`Session`](crate::Session) around the training knew; none where there was no session.
    pub(crate) session: Option<SessionState>,
}

/// What the next decisions of a [`Session`](crate::Session) depend on, besides its trainer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SessionState {
    /// Looks, learning curve, confirmed goal.
    pub memory: Memory,
    /// The state to go back to when learning runs away, without a session; none where it is the checkpoint itself.
    pub good: Option<Box<Checkpoint>>,
}

/// Why a checkpoint cannot be used.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file cannot be read or written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The file does not start as a checkpoint does.
    #[error("this is not a checkpoint: it does not start with MYOCKPT")]
    Magic,
    /// Written by another version of this program.
    #[error("the checkpoint has format {found}; this program reads formats {OLDEST} to {VERSION}")]
    Version {
        /// Format of the file.
        found: u32,
    },
    /// The file ends too early or too late.
    #[error("the checkpoint is {got} bytes long, but should be {expected}; it was cut off or added to")]
    Length {
        /// Bytes in the file.
        got: u64,
        /// Bytes announced in its header.
        expected: u64,
    },
    /// The contents changed after they were written.
    #[error("the checkpoint is damaged: its checksum is {got:08x}, but should be {expected:08x}")]
    Checksum {
        /// Of the contents.
        got: u32,
        /// In the header.
        expected: u32,
    },
    /// The contents contradict themselves.
    #[error("the checkpoint is inconsistent: {reason}")]
    Inconsistent {
        /// What is wrong.
        reason: String,
    },
    /// A number with which training cannot go on, nor a policy act.
    #[error("the checkpoint cannot be used: {what} {index} is {value}")]
    NotFinite {
        /// Which list of numbers.
        what: &'static str,
        /// Entry of that list, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
}

impl CheckpointError {
    /// Whether the file itself is spoilt, so that an older one may take its place. What could not be read, or is of a
    /// newer program, may be whole.
    pub fn is_damage(&self) -> bool {
        !matches!(self, Self::Io(_) | Self::Version { .. })
    }
}

impl Checkpoint {
    /// The settings of the training.
    pub fn config(&self) -> &PpoConfig {
        &self.config
    }

    /// The seed of the training.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Updates done.
    pub fn updates(&self) -> u64 {
        self.updates
    }

    /// Control steps of all environments done.
    pub fn env_steps(&self) -> u64 {
        self.updates * self.config.batch_size(self.control_dt) as u64
    }

    /// What the last doubling of the training brought and more would, if a session wrote it and that can be told.
    pub fn trend(&self) -> Option<Trend> {
        self.session.as_ref()?.memory.trend()
    }

    /// Sets the time spent to zero: the one thing in which equal runs differ.
    pub fn forget_wall_time(&mut self) {
        self.wall_s = 0.0;
        if let Some(SessionState { memory, good }) = &mut self.session {
            memory.evaluation_s = 0.0;
            good.iter_mut().for_each(|good| good.forget_wall_time());
        }
    }

    /// The policy.
    pub fn policy(&self) -> Policy {
        let names = (&self.observation_names[..], &self.action_names[..]);
        Policy::new(names, self.networks(), &self.config, self.parameters.clone(), self.normalizer.clone())
    }

    pub(crate) fn networks(&self) -> Networks {
        let (observations, actions) = (self.observation_names.len(), self.action_names.len());
        Networks {
            policy: Mlp::new(observations, &self.config.policy_hidden, actions),
            value: Mlp::new(observations, &self.config.value_hidden, 1),
        }
    }

    /// The contents of the file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer(vec![0; HEADER]);
        out.json(&self.config);
        out.f64s(&[self.control_dt]);
        out.u64(self.seed);
        out.u64(self.updates);
        out.f64s(&[self.wall_s, self.learning_rate]);
        out.json(&self.observation_names);
        out.json(&self.action_names);
        out.f32s(&self.parameters);
        out.f32s(&self.optimizer.mean);
        out.f32s(&self.optimizer.square);
        out.u64(self.optimizer.steps);
        let (limit, std_floor, count, mean, m2) = self.normalizer.parts();
        out.f64s(&[limit.into(), std_floor, count]);
        out.f64s(mean);
        out.f64s(m2);
        out.f32s(&self.observation);
        out.bytes(&self.env_state);
        out.json(&self.session.as_ref().map(|session| &session.memory));
        let good = self.session.as_ref().and_then(|session| session.good.as_ref());
        out.bytes(&good.map_or(Vec::new(), |good| good.to_bytes()));
        let mut bytes = out.0;
        let payload = &bytes[HEADER..];
        let (length, checksum) = (payload.len() as u64, crc32c(payload));
        bytes[..8].copy_from_slice(MAGIC);
        bytes[8..12].copy_from_slice(&VERSION.to_le_bytes());
        bytes[12..20].copy_from_slice(&length.to_le_bytes());
        bytes[20..24].copy_from_slice(&checksum.to_le_bytes());
        bytes
    }

    /// Reads what [`Checkpoint::to_bytes`] wrote; refuses anything else with the reason.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        Self::parse(bytes, true)
    }

    /// `with_session`: whether a session may be in it; in the state that another checkpoint goes back to there is none.
    fn parse(bytes: &[u8], with_session: bool) -> Result<Self, CheckpointError> {
        if !bytes.starts_with(MAGIC) {
            return Err(CheckpointError::Magic);
        }
        if bytes.len() < HEADER {
            return Err(CheckpointError::Length { got: bytes.len() as u64, expected: HEADER as u64 });
        }
        let mut header = Reader(&bytes[8..HEADER]);
        let (version, length, expected) = (header.u32()?, header.u64()?, header.u32()?);
        if !(OLDEST..=VERSION).contains(&version) {
            return Err(CheckpointError::Version { found: version });
        }
        let payload = &bytes[HEADER..];
        if payload.len() as u64 != length {
            let expected = length.saturating_add(HEADER as u64);
            return Err(CheckpointError::Length { got: bytes.len() as u64, expected });
        }
        let got = crc32c(payload);
        if got != expected {
            return Err(CheckpointError::Checksum { got, expected });
        }
        let checkpoint = Self::from_payload(Reader(payload), version, with_session)?;
        checkpoint.check()?;
        Ok(checkpoint)
    }

    fn from_payload(mut payload: Reader<'_>, version: u32, with_session: bool) -> Result<Self, CheckpointError> {
        let (config, control_dt) =
            if version > 3 { (payload.json()?, payload.f64_array::<1>()?[0]) } else { payload.old_config()? };
        let (seed, updates) = (payload.u64()?, payload.u64()?);
        let [wall_s, learning_rate] = payload.f64_array()?;
        let (observation_names, action_names) = (payload.json()?, payload.json()?);
        let parameters = payload.f32s()?;
        let optimizer = Optimizer { mean: payload.f32s()?, square: payload.f32s()?, steps: payload.u64()? };
        let [limit, std_floor, count] = payload.f64_array()?;
        let (mean, m2) = (payload.f64s()?, payload.f64s()?);
        let normalizer = Normalizer::from_parts(limit as f32, std_floor, count, mean, m2);
        let (observation, env_state) = (payload.f32s()?, payload.bytes()?.to_vec());
        let session = if with_session && version > 1 { payload.session()? } else { None };
        Ok(Self {
            config,
            control_dt,
            seed,
            updates,
            wall_s,
            learning_rate,
            observation_names,
            action_names,
            parameters,
            optimizer,
            normalizer,
            observation,
            env_state,
            session,
        })
    }

    /// Refuses sizes that do not fit together, so that nothing later can run out of bounds.
    fn check(&self) -> Result<(), CheckpointError> {
        let inconsistent = |reason| Err(CheckpointError::Inconsistent { reason });
        if !(self.control_dt.is_finite() && self.control_dt > 0.0) {
            return inconsistent(format!("its control step is {} s", self.control_dt));
        }
        if let Err(error) = self.config.validate_for(self.control_dt) {
            return inconsistent(error.to_string());
        }
        let (observations, parameters) = (self.observation_names.len(), self.networks().len());
        for (what, got, expected) in [
            ("parameters", self.parameters.len(), parameters),
            ("means of the gradient", self.optimizer.mean.len(), parameters),
            ("squares of the gradient", self.optimizer.square.len(), parameters),
            ("means of the observations", self.normalizer.size(), observations),
            ("deviations of the observations", self.normalizer.parts().4.len(), observations),
            ("current observations", self.observation.len(), observations * self.config.num_envs),
        ] {
            if got != expected {
                return inconsistent(format!("it holds {got} {what}, but should hold {expected}"));
            }
        }
        if let Some(good) = self.session.as_ref().and_then(|session| session.good.as_ref()) {
            let sizes = |checkpoint: &Self| {
                let Self { config, control_dt, .. } = checkpoint;
                (checkpoint.networks(), config.batch_size(*control_dt), config.num_envs)
            };
            if sizes(good) != sizes(self) {
                return inconsistent("the state to go back to has other sizes".into());
            }
        }
        self.check_finite()
    }

    /// Refuses numbers with which nothing can be done.
    fn check_finite(&self) -> Result<(), CheckpointError> {
        let single = |x: &[f32]| x.iter().position(|x| !x.is_finite()).map(|i| (i, x[i].into()));
        let double = |x: &[f64]| x.iter().position(|x| !x.is_finite()).map(|i| (i, x[i]));
        let (_, _, count, mean, m2) = self.normalizer.parts();
        for (what, found) in [
            ("parameter", single(&self.parameters)),
            ("mean of the gradient", single(&self.optimizer.mean)),
            ("square of the gradient", single(&self.optimizer.square)),
            ("mean of the observations", double(mean)),
            ("deviation of the observations", double(m2)),
            ("number of observations", double(&[count])),
            ("learning rate", double(&[self.learning_rate])),
            ("time", double(&[self.wall_s])),
        ] {
            if let Some((index, value)) = found {
                return Err(CheckpointError::NotFinite { what, index, value });
            }
        }
        self.session.as_ref().and_then(|session| session.good.as_ref()).map_or(Ok(()), |good| good.check_finite())
    }

    /// Writes the file: under another name first, then, once it is safely on disk, under its own.
    ///
    /// # Errors
    /// The file cannot be written, or a weight is not finite: such a checkpoint would stand before one that can be used.
    pub fn write(&self, path: &Path) -> Result<(), CheckpointError> {
        self.check_finite()?;
        Ok(write_atomically(path, &self.to_bytes())?)
    }

    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        let bytes = std::fs::read(path).map_err(|source| IoError::new("read", path, source))?;
        Self::from_bytes(&bytes)
    }
}

struct Writer(Vec<u8>);

impl Writer {
    fn u64(&mut self, x: u64) {
        self.0.extend(x.to_le_bytes());
    }
    fn bytes(&mut self, bytes: &[u8]) {
        self.u64(bytes.len() as u64);
        self.0.extend(bytes);
    }
    fn f32s(&mut self, xs: &[f32]) {
        self.u64(xs.len() as u64);
        xs.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
    }
    fn f64s(&mut self, xs: &[f64]) {
        self.u64(xs.len() as u64);
        xs.iter().for_each(|x| self.0.extend(x.to_le_bytes()));
    }
    fn json(&mut self, value: &impl serde::Serialize) {
        self.bytes(serde_json::to_string(value).expect("plain data always has a JSON form").as_bytes());
    }
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], CheckpointError> {
        let Some((head, tail)) = self.0.split_at_checked(n) else {
            return Err(CheckpointError::Inconsistent { reason: "a list is longer than the file".into() });
        };
        self.0 = tail;
        Ok(head)
    }
    fn array<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(N)?);
        Ok(out)
    }
    fn u32(&mut self) -> Result<u32, CheckpointError> {
        Ok(u32::from_le_bytes(self.array()?))
    }
    fn u64(&mut self) -> Result<u64, CheckpointError> {
        Ok(u64::from_le_bytes(self.array()?))
    }
    /// A list of `count` entries of `N` bytes.
    fn list<const N: usize>(&mut self) -> Result<impl Iterator<Item = [u8; N]> + use<'a, N>, CheckpointError> {
        let count = usize::try_from(self.u64()?).unwrap_or(usize::MAX);
        Ok(self.take(count.saturating_mul(N))?.as_chunks().0.iter().copied())
    }
    fn bytes(&mut self) -> Result<&'a [u8], CheckpointError> {
        let count = usize::try_from(self.u64()?).unwrap_or(usize::MAX);
        self.take(count)
    }
    fn f32s(&mut self) -> Result<Vec<f32>, CheckpointError> {
        Ok(self.list()?.map(f32::from_le_bytes).collect())
    }
    fn f64s(&mut self) -> Result<Vec<f64>, CheckpointError> {
        Ok(self.list()?.map(f64::from_le_bytes).collect())
    }
    fn f64_array<const N: usize>(&mut self) -> Result<[f64; N], CheckpointError> {
        let list = self.f64s()?;
        let n = list.len();
        list.try_into().map_err(|_| CheckpointError::Inconsistent { reason: format!("{n} numbers in place of {N}") })
    }
    fn session(&mut self) -> Result<Option<SessionState>, CheckpointError> {
        let (memory, good) = (self.json::<Option<Memory>>()?, self.bytes()?);
        let good = if good.is_empty() { None } else { Some(Box::new(Checkpoint::parse(good, false)?)) };
        Ok(memory.map(|memory| SessionState { memory, good }))
    }
    /// Settings up to version 3, and the control step that they are taken to have had.
    fn old_config(&mut self) -> Result<(PpoConfig, f64), CheckpointError> {
        let config = serde_json::from_value(PpoConfig::modernised(self.json()?))
            .map_err(|error| CheckpointError::Inconsistent { reason: error.to_string() })?;
        Ok((config, OLD_CONTROL_DT))
    }
    fn json<T: serde::de::DeserializeOwned>(&mut self) -> Result<T, CheckpointError> {
        serde_json::from_slice(self.bytes()?)
            .map_err(|error| CheckpointError::Inconsistent { reason: error.to_string() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checkpoint() -> Checkpoint {
        let small = PpoConfig { num_envs: 2, minibatches: 1, ..PpoConfig::default() };
        let config = PpoConfig { policy_hidden: vec![], value_hidden: vec![], ..small };
        // Two weights of the policy and its bias, the logarithm of its standard deviation, and as many of the values.
        let parameters = vec![0.1; 2 + 1 + 1 + 2 + 1];
        Checkpoint {
            config,
            control_dt: 0.05,
            seed: 1,
            updates: 0,
            wall_s: 0.0,
            learning_rate: 1e-3,
            observation_names: vec!["a".into(), "b".into()],
            action_names: vec!["pull".into()],
            optimizer: Optimizer { mean: parameters.clone(), square: parameters.clone(), steps: 1 },
            parameters,
            normalizer: Normalizer::from_parts(5.0, 0.05, 2.0, vec![0.0; 2], vec![1.0; 2]),
            observation: vec![0.0; 4],
            env_state: vec![],
            session: None,
        }
    }

    fn memory() -> Memory {
        let text = r#"{"looks": {"lead": 0.2, "last_look": 0, "wait": 0}, "curve": {"start": 0, "recent": null, "points": []},
            "evaluations": 0, "tries": 0, "told_flat": false, "evaluation_s": 0, "confirmed": null}"#;
        serde_json::from_str(text).unwrap()
    }

    #[test]
    fn a_checkpoint_whose_numbers_are_not_finite_is_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.ckpt");
        let whole = checkpoint();
        whole.write(&path).unwrap();
        assert_eq!(Checkpoint::read(&path).unwrap(), whole);
        let bytes = std::fs::read(&path).unwrap();
        type Change = fn(&mut Checkpoint);
        let cases: [(Change, &str); 5] = [
            (|c| c.parameters[3] = f32::NAN, "parameter 3 is NaN"),
            (|c| c.optimizer.square[6] = f32::INFINITY, "square of the gradient 6 is inf"),
            (
                |c| c.normalizer = Normalizer::from_parts(5.0, 0.05, 2.0, vec![0.0, f64::NAN], vec![1.0; 2]),
                "mean of the observations 1 is NaN",
            ),
            (|c| c.learning_rate = f64::NAN, "learning rate 0 is NaN"),
            (
                |c| {
                    let mut good = c.clone();
                    good.parameters[0] = f32::NEG_INFINITY;
                    c.session = Some(SessionState { memory: memory(), good: Some(Box::new(good)) });
                },
                "parameter 0 is -inf",
            ),
        ];
        for (change, sentence) in cases {
            let mut wrong = checkpoint();
            change(&mut wrong);
            let error = wrong.write(&path).unwrap_err().to_string();
            assert_eq!(error, format!("the checkpoint cannot be used: {sentence}"));
            assert!(std::fs::read(&path).unwrap() == bytes, "{sentence}: what was there is gone");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing half-written beside it");
    }
}
