//! States of environments as bytes, the same for every backend.
//!
//! Little endian: the word `MYOSTATE`; the format's version, u32; CRC-32C of all that follows, u32; the [`Header`]; then one
//! row per environment, its numbers as f64 and its integers as u32.

use crate::rules::Outline;
use crate::state::EnvState;
use crc32c::crc32c;
use myo_model::Model;
use myo_scalar::Real;
use myo_tasks::Task;

/// How every state begins.
const MAGIC: &[u8; 8] = b"MYOSTATE";
/// The version of the format that this library reads and writes.
const VERSION: u32 = 7;
/// Where the checksum stands, and where what it covers begins.
const CHECKSUM: std::ops::Range<usize> = 12..16;
/// Integers per environment.
const WORDS: usize = EnvState::<f64>::WORDS;

/// Which model and task a state is of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity {
    model: Named,
    task: Named,
}

/// A name, and a checksum of all that it stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Named {
    name: String,
    fingerprint: u32,
}

impl Named {
    fn new(name: &str, contents: String) -> Self {
        Self { name: name.into(), fingerprint: crc32c(contents.as_bytes()) }
    }

    fn of(tasks: &[Task], rules: Option<&Outline>) -> Self {
        let name = tasks.first().map_or("", |task| &task.name);
        let contents = match tasks {
            [task] => format!("{task:?}"),
            tasks => format!("{tasks:?}"),
        };
        match rules {
            None => Self::new(name, contents),
            Some(rules) => Self::new(&format!("{name}, rules {}", rules.name), contents + &rules.contents),
        }
    }
}

impl Identity {
    /// The identity of a model and of tasks whose repeated targets are written out, under rules of one's own, if given. The first
    /// task gives the name.
    pub fn new(model: &Model, tasks: &[Task], rules: Option<&Outline>) -> Self {
        Self { model: Named::new(&model.name, format!("{model:?}")), task: Named::of(tasks, rules) }
    }

    /// The same model with other tasks.
    pub fn with_tasks(&self, tasks: &[Task], rules: Option<&Outline>) -> Self {
        Self { model: self.model.clone(), task: Named::of(tasks, rules) }
    }

    /// Says what differs from the identity that an environment has.
    fn check(&self, own: &Self) -> Result<(), String> {
        let (model, task) = ((&self.model, &own.model), (&self.task, &own.task));
        if model.0.name != model.1.name {
            return Err(format!("it is of the model `{}`, this environment has `{}`", model.0.name, model.1.name));
        }
        if task.0.name != task.1.name {
            return Err(format!("it is of the task `{}`, this environment does `{}`", task.0.name, task.1.name));
        }
        if model.0 != model.1 {
            return Err(format!(
                "it is of another version of the model `{}`: what the model says has changed",
                model.0.name
            ));
        }
        if task.0 != task.1 {
            return Err(format!(
                "it is of another version of the task `{}`: what the task says has changed",
                task.0.name
            ));
        }
        Ok(())
    }
}

/// What a state holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Environments.
    pub num_envs: usize,
    /// Numbers per environment.
    pub count: usize,
    /// Bytes of a number while it is simulated.
    pub precision: usize,
    /// Of what model and task.
    pub identity: Identity,
}

impl Header {
    /// The header of states whose numbers are of type `C`.
    pub fn of<C: Real>(num_envs: usize, count: usize, identity: &Identity) -> Self {
        Self { num_envs, count, precision: size_of::<C>(), identity: identity.clone() }
    }

    /// Writes a state; `number` and `word` give entry `k` of an environment.
    pub fn save(&self, number: impl Fn(usize, usize) -> f64, word: impl Fn(usize, usize) -> u32) -> Vec<u8> {
        let mut out = Vec::with_capacity(256 + self.num_envs * self.row_size());
        out.extend(MAGIC);
        out.extend(VERSION.to_le_bytes());
        out.extend([0; 4]);
        out.extend([self.num_envs, self.count, self.precision].iter().flat_map(|&x| (x as u64).to_le_bytes()));
        for Named { name, fingerprint } in [&self.identity.model, &self.identity.task] {
            out.extend(fingerprint.to_le_bytes());
            out.extend((name.len() as u32).to_le_bytes());
            out.extend(name.as_bytes());
        }
        for env in 0..self.num_envs {
            out.extend((0..self.count).flat_map(|k| number(env, k).to_le_bytes()));
            out.extend((0..WORDS).flat_map(|k| word(env, k).to_le_bytes()));
        }
        sign(&mut out);
        out
    }

    /// Says why a state cannot go on in an environment whose own states have this header.
    pub fn check(&self, saved: &Self) -> Result<(), String> {
        saved.identity.check(&self.identity)?;
        for (name, got, want) in
            [("environments", saved.num_envs, self.num_envs), ("numbers per environment", saved.count, self.count)]
        {
            if got != want {
                return Err(format!("it has {got} {name}, this environment {want}"));
            }
        }
        // Numbers of lower precision are kept as they are; those of higher precision would be rounded.
        if saved.precision > self.precision {
            let (got, want) = (saved.precision, self.precision);
            return Err(format!("its numbers were computed in {got} bytes each, this environment has {want}"));
        }
        Ok(())
    }

    /// Bytes of one environment.
    fn row_size(&self) -> usize {
        self.count.saturating_mul(8).saturating_add(4 * WORDS)
    }
}

/// Writes the checksum of a state.
pub fn sign(state: &mut [u8]) {
    let checksum = crc32c(&state[CHECKSUM.end..]);
    state[CHECKSUM].copy_from_slice(&checksum.to_le_bytes());
}

/// A state whose bytes are whole.
#[derive(Clone, Debug)]
pub struct Saved<'a> {
    /// What it holds.
    pub header: Header,
    rows: &'a [u8],
}

impl<'a> Saved<'a> {
    /// Reads what [`Header::save`] wrote; says what is wrong with it.
    pub fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let mut rest = bytes;
        if take(&mut rest, MAGIC.len()) != Some(MAGIC) {
            return Err("it does not begin as the saved states of this version do".into());
        }
        let version = take_u32(&mut rest)?;
        if version != VERSION {
            return Err(format!(
                "it was saved in format {version}, this version of the library reads format {VERSION}"
            ));
        }
        if take_u32(&mut rest)? != crc32c(rest) {
            return Err("its checksum is wrong: some of its bytes were lost or changed".into());
        }
        let [num_envs, count, precision] = [(); 3].map(|()| take_usize(&mut rest));
        let identity = Identity { model: take_named(&mut rest)?, task: take_named(&mut rest)? };
        let header = Header { num_envs: num_envs?, count: count?, precision: precision?, identity };
        match header.num_envs.checked_mul(header.row_size()) {
            Some(size) if size == rest.len() => Ok(Self { header, rows: rest }),
            _ => Err(format!("{} bytes of environments do not fit its header", rest.len())),
        }
    }

    /// The same, if it has this environment.
    pub fn with_env(self, env: usize) -> Result<Self, String> {
        let n = self.header.num_envs;
        if env < n { Ok(self) } else { Err(format!("it has no environment {env}, only {n}")) }
    }

    /// Number `k` of an environment.
    pub fn number(&self, env: usize, k: usize) -> f64 {
        let at = env * self.header.row_size() + 8 * k;
        f64::from_le_bytes(self.rows[at..at + 8].try_into().expect("eight bytes"))
    }

    /// Integer `k` of an environment.
    pub fn word(&self, env: usize, k: usize) -> u32 {
        let at = env * self.header.row_size() + 8 * self.header.count + 4 * k;
        u32::from_le_bytes(self.rows[at..at + 4].try_into().expect("four bytes"))
    }

    /// Where the integers of an environment stand among the bytes of the whole state.
    pub fn words_in(&self, state_len: usize, env: usize) -> std::ops::Range<usize> {
        let end = state_len - self.rows.len() + (env + 1) * self.header.row_size();
        end - 4 * WORDS..end
    }
}

fn take<'a>(rest: &mut &'a [u8], count: usize) -> Option<&'a [u8]> {
    rest.split_off(..count)
}

const SHORT: &str = "it ends before its header does";

fn take_u32(rest: &mut &[u8]) -> Result<u32, String> {
    let bytes = take(rest, 4).ok_or(SHORT)?;
    Ok(u32::from_le_bytes(bytes.try_into().expect("four bytes")))
}

fn take_usize(rest: &mut &[u8]) -> Result<usize, String> {
    let bytes = take(rest, 8).ok_or(SHORT)?;
    let value = u64::from_le_bytes(bytes.try_into().expect("eight bytes"));
    usize::try_from(value).map_err(|_| format!("a size of {value} is more than this machine can count"))
}

fn take_named(rest: &mut &[u8]) -> Result<Named, String> {
    let fingerprint = take_u32(rest)?;
    let length = take_u32(rest)? as usize;
    let name = take(rest, length).ok_or(SHORT)?;
    Ok(Named { name: String::from_utf8_lossy(name).into_owned(), fingerprint })
}
