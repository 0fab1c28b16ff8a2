//! Steps inside programs of XLA, without Python: a handler of its foreign function interface.
//!
//! The declarations are those of `xla/ffi/api/c_api.h`, version 0.3, which comes with jaxlib (`jax.ffi.include_dir()`); only
//! what is used is declared. XLA refuses a handler of a version that it does not know when it is registered, and
//! `myoenv.jax` then calls back to Python.

use std::collections::BTreeMap;
use std::ffi::{CString, c_char, c_int, c_void};
use std::mem::{offset_of, size_of};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;
use std::slice;
use std::sync::atomic::{AtomicI64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};

use pyo3::prelude::*;

use crate::env::{Inner, Shared, Shown};

/// Environments by their numbers. A compiled program outlives them, so it has no pointer to them.
static ENVS: Mutex<BTreeMap<i64, Weak<Shared>>> = Mutex::new(BTreeMap::new());

/// The number of environments, the same each time.
pub fn id_of(shared: &Arc<Shared>) -> i64 {
    let mut envs = ENVS.lock().unwrap_or_else(PoisonError::into_inner);
    envs.retain(|_, shared| shared.strong_count() > 0);
    let known = envs.iter().find(|(_, other)| std::ptr::eq(other.as_ptr(), Arc::as_ptr(shared)));
    if let Some((&id, _)) = known {
        return id;
    }
    // Numbers are not used again: an old program must not step other environments.
    static NEXT: AtomicI64 = AtomicI64::new(1);
    let id = NEXT.fetch_add(1, Ordering::Relaxed);
    envs.insert(id, Arc::downgrade(shared));
    id
}

/// Address of the handler that steps environments, for `jax.ffi.pycapsule`.
#[pyfunction]
pub fn xla_step_handler() -> usize {
    let handler: unsafe extern "C" fn(*mut CallFrame) -> *mut c_void = step_handler;
    handler as usize
}

const VERSION: (c_int, c_int) = (0, 3);
const METADATA: c_int = 1;
const EXECUTE: c_int = 3;
const SCALAR: c_int = 3;
const INVALID_ARGUMENT: c_int = 3;
const PRED: c_int = 1;
const S32: c_int = 4;
const S64: c_int = 5;
const F32: c_int = 11;

#[repr(C)]
struct Extension {
    struct_size: usize,
    kind: c_int,
    next: *mut Extension,
}

#[repr(C)]
struct MetadataExtension {
    base: Extension,
    metadata: *mut Metadata,
}

#[repr(C)]
struct Metadata {
    struct_size: usize,
    api_version: ApiVersion,
    traits: u32,
}

#[repr(C)]
struct ApiVersion {
    struct_size: usize,
    extension_start: *mut Extension,
    major: c_int,
    minor: c_int,
}

#[repr(C)]
struct Api {
    struct_size: usize,
    extension_start: *mut Extension,
    api_version: ApiVersion,
    internal_api: *const c_void,
    error_create: unsafe extern "C" fn(*mut ErrorCreateArgs) -> *mut c_void,
}

#[repr(C)]
struct ErrorCreateArgs {
    struct_size: usize,
    extension_start: *mut Extension,
    message: *const c_char,
    code: c_int,
}

/// Arguments and results alike: so many pointers to buffers.
#[repr(C)]
struct Values {
    struct_size: usize,
    extension_start: *mut Extension,
    size: i64,
    kinds: *const c_int,
    values: *const *const Buffer,
}

#[repr(C)]
struct Attributes {
    struct_size: usize,
    extension_start: *mut Extension,
    size: i64,
    kinds: *const c_int,
    names: *const *const c_void,
    values: *const *const ScalarAttribute,
}

#[repr(C)]
struct ScalarAttribute {
    dtype: c_int,
    value: *const i64,
}

#[repr(C)]
struct Buffer {
    struct_size: usize,
    extension_start: *mut Extension,
    dtype: c_int,
    data: *mut c_void,
    rank: i64,
    dims: *const i64,
}

#[repr(C)]
struct CallFrame {
    struct_size: usize,
    extension_start: *mut Extension,
    api: *const Api,
    context: *mut c_void,
    stage: c_int,
    args: Values,
    rets: Values,
    attributes: Attributes,
}

impl Values {
    /// # Safety
    /// As XLA made it, in an execution.
    unsafe fn buffers<const N: usize>(&self) -> Result<[&Buffer; N], String> {
        if self.size != N as i64 {
            return Err(format!("{} buffers were passed, expected {N}", self.size));
        }
        // SAFETY: there are as many as `size` tells, all of them buffers, which is the only kind that there is.
        Ok(std::array::from_fn(|k| unsafe { &**self.values.add(k) }))
    }
}

/// Types of Rust with their numbers in XLA. For all of them zeros are a value.
trait Element: Copy {
    const DTYPE: c_int;
}

impl Element for f32 {
    const DTYPE: c_int = F32;
}

impl Element for bool {
    const DTYPE: c_int = PRED;
}

impl Element for i32 {
    const DTYPE: c_int = S32;
}

impl Buffer {
    fn check<T: Element>(&self, len: usize) -> Result<(), String> {
        // SAFETY: XLA tells as many dimensions as the rank.
        let dims =
            unsafe { slice::from_raw_parts(if self.rank == 0 { [].as_ptr() } else { self.dims }, self.rank as usize) };
        if self.dtype != T::DTYPE || dims.iter().product::<i64>() != len as i64 {
            return Err(format!(
                "a buffer has type {} and shape {dims:?}, expected {len} of type {}",
                self.dtype,
                T::DTYPE
            ));
        }
        Ok(())
    }

    /// # Safety
    /// An argument of an execution.
    unsafe fn read<T: Element>(&self, len: usize) -> Result<&[T], String> {
        self.check::<T>(len)?;
        // SAFETY: XLA aligns and fills it; type and length were compared.
        Ok(unsafe { slice::from_raw_parts(self.data.cast(), len) })
    }

    /// # Safety
    /// A result of an execution, asked for once.
    #[expect(clippy::mut_from_ref, reason = "the memory belongs to the caller of the handler, who asks once")]
    unsafe fn write<T: Element>(&self, len: usize) -> Result<&mut [T], String> {
        self.check::<T>(len)?;
        let data: *mut T = self.data.cast();
        // SAFETY: XLA aligns it; type and length were compared, and what was there before need not be a value.
        unsafe {
            data.write_bytes(0, len);
            Ok(slice::from_raw_parts_mut(data, len))
        }
    }
}

/// What XLA calls: before any program with all arguments empty, to hear of the version, then once per step.
unsafe extern "C" fn step_handler(frame: *mut CallFrame) -> *mut c_void {
    // SAFETY: XLA passes a frame that lives until the return.
    let frame = unsafe { &*frame };
    // SAFETY: an extension is nothing or of the kind that it tells.
    if unsafe { tell_version(frame.extension_start) } {
        return null_mut();
    }
    // SAFETY: as XLA made it.
    let outcome = catch_unwind(AssertUnwindSafe(|| unsafe { execute(frame) }));
    match outcome.unwrap_or_else(|_| Err("internal error in a step, please report it".into())) {
        Ok(()) => null_mut(),
        // SAFETY: XLA's table of functions is there in every call.
        Err(message) => unsafe { error(&*frame.api, &message) },
    }
}

/// Answers the question for the version, if it is asked.
unsafe fn tell_version(extension: *mut Extension) -> bool {
    // SAFETY: as the caller says.
    unsafe {
        if extension.is_null() || (*extension).kind != METADATA {
            return false;
        }
        let metadata = &mut *(*extension.cast::<MetadataExtension>()).metadata;
        (metadata.api_version.major, metadata.api_version.minor) = VERSION;
        metadata.traits = 0;
    }
    true
}

/// An error that becomes an exception of JAX; XLA frees it.
unsafe fn error(api: &Api, message: &str) -> *mut c_void {
    let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
    let mut args = ErrorCreateArgs {
        struct_size: offset_of!(ErrorCreateArgs, code) + size_of::<c_int>(),
        extension_start: null_mut(),
        message: message.as_ptr(),
        code: INVALID_ARGUMENT,
    };
    // SAFETY: XLA copies the message.
    unsafe { (api.error_create)(&mut args) }
}

/// The environments that the attribute `env`, the only one, names.
unsafe fn environments(attributes: &Attributes) -> Result<Arc<Shared>, String> {
    // SAFETY: as many kinds and values as `size` tells.
    let id = unsafe {
        if attributes.size != 1 || *attributes.kinds != SCALAR || (**attributes.values).dtype != S64 {
            return Err("a step has one attribute, the number of its environments".into());
        }
        *(**attributes.values).value
    };
    let envs = ENVS.lock().unwrap_or_else(PoisonError::into_inner);
    envs.get(&id).and_then(Weak::upgrade).ok_or_else(|| "the environment is gone; make a new one".into())
}

/// `(token, action)` to `(token, observation, next observation, reward, terminated, truncated, summary)`; the summary is
/// `(episode_size, num_envs)`, zero where no episode ended.
unsafe fn execute(frame: &CallFrame) -> Result<(), String> {
    if frame.stage != EXECUTE {
        return Ok(());
    }
    // SAFETY: XLA keeps arguments and results for this call, and each result is asked for once.
    let (shared, [token, action], results) =
        unsafe { (environments(&frame.attributes)?, frame.args.buffers()?, frame.rets.buffers::<7>()?) };
    let spec = &shared.spec;
    let (n, width) = (spec.num_envs, spec.observation_size());
    let [next_token, observation, next_observation, reward, terminated, truncated, summary] = results;
    // SAFETY: as above.
    let (token, action) = unsafe { (token.read::<i32>(1)?[0], action.read::<f32>(n * spec.action_size())?) };
    // SAFETY: as above.
    let (next_token, shown, next_observation, summary) = unsafe {
        let shown = Shown {
            observation: observation.write(n * width)?,
            reward: reward.write(n)?,
            terminated: terminated.write(n)?,
            truncated: truncated.write(n)?,
        };
        (next_token.write(1)?, shown, next_observation.write(n * width)?, summary.write(spec.episode_size() * n)?)
    };
    let mut opened = shared.open().map_err(|error| error.to_string())?;
    let inner = opened.inner();
    next_token[0] = step(inner, token, action, shown, next_observation, summary)?;
    Ok(())
}

fn step(
    inner: &mut Inner,
    token: i32,
    action: &[f32],
    shown: Shown<'_>,
    next_observation: &mut [f32],
    summary: &mut [f32],
) -> Result<i32, String> {
    if token != inner.present() {
        return Err(format!(
            "this state is number {token}, the environments are at {}: a state can be stepped once, and not after a reset",
            inner.present()
        ));
    }
    let Shown { observation, reward, terminated, truncated } = shown;
    let again =
        Shown { observation: &mut *observation, reward, terminated: &mut *terminated, truncated: &mut *truncated };
    inner.step(action, again).map_err(|error| error.to_string())?;
    next_observation.copy_from_slice(observation);
    let n = terminated.len();
    let (width, columns) = (observation.len() / n, summary.len() / n);
    for env in (0..n).filter(|&env| terminated[env] || truncated[env]) {
        next_observation[env * width..][..width].copy_from_slice(&inner.final_observation[env * width..][..width]);
        for (column, x) in inner.episode[env * columns..][..columns].iter().enumerate() {
            summary[column * n + env] = *x;
        }
    }
    Ok(inner.present())
}
