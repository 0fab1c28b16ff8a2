//! The part of XLA's foreign function interface that is used here.
//!
//! The declarations are those of `xla/ffi/api/c_api.h`, version 0.3, which comes with jaxlib (`jax.ffi.include_dir()`).

use std::ffi::{CString, c_char, c_int, c_void};
use std::mem::{offset_of, size_of};
use std::ptr::null_mut;
use std::slice;

/// Major and minor version of these declarations.
const VERSION: (c_int, c_int) = (0, 3);
const METADATA: c_int = 1;
const EXECUTE: c_int = 3;
const SCALAR: c_int = 3;
const INVALID_ARGUMENT: c_int = 3;
const PRED: c_int = 1;
const S32: c_int = 4;
const S64: c_int = 5;
const F32: c_int = 11;

/// A function that XLA calls; what it returns is an error, or null.
pub type Handler = unsafe extern "C" fn(*mut CallFrame) -> *mut c_void;

/// All that XLA passes to a handler.
#[repr(C)]
pub struct CallFrame {
    struct_size: usize,
    extension_start: *mut Extension,
    api: *const Api,
    context: *mut c_void,
    stage: c_int,
    args: Values,
    rets: Values,
    attributes: Attributes,
}

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

/// An array.
#[repr(C)]
pub struct Buffer {
    struct_size: usize,
    extension_start: *mut Extension,
    dtype: c_int,
    data: *mut c_void,
    rank: i64,
    dims: *const i64,
}

impl CallFrame {
    /// Answers the question for the version, if it is asked.
    ///
    /// # Safety
    /// XLA made the frame.
    pub unsafe fn tell_version(&self) -> bool {
        // SAFETY: an extension is nothing, or of the kind that it tells.
        unsafe {
            if self.extension_start.is_null() || (*self.extension_start).kind != METADATA {
                return false;
            }
            let metadata = &mut *(*self.extension_start.cast::<MetadataExtension>()).metadata;
            (metadata.api_version.major, metadata.api_version.minor) = VERSION;
            metadata.traits = 0;
        }
        true
    }

    /// Whether there are arrays; stages before this one prepare.
    pub fn is_execution(&self) -> bool {
        self.stage == EXECUTE
    }

    /// The attribute that is a whole number, if it is the only one.
    ///
    /// # Safety
    /// XLA made the frame.
    pub unsafe fn only_number(&self) -> Option<i64> {
        let Attributes { size, kinds, values, .. } = &self.attributes;
        // SAFETY: as many kinds and values as `size` tells, and the values are of their kinds.
        unsafe { (*size == 1 && **kinds == SCALAR && (***values).dtype == S64).then(|| *(***values).value) }
    }

    /// So many arguments and results.
    ///
    /// # Safety
    /// XLA made the frame, and this is the execution.
    pub unsafe fn arrays<const N: usize, const M: usize>(&self) -> Result<([&Buffer; N], [&Buffer; M]), String> {
        // SAFETY: as the caller says.
        unsafe { Ok((self.args.buffers()?, self.rets.buffers()?)) }
    }

    /// An error that becomes an exception of JAX; XLA frees it.
    ///
    /// # Safety
    /// XLA made the frame.
    pub unsafe fn error(&self, message: &str) -> *mut c_void {
        let message = CString::new(message.replace('\0', " ")).unwrap_or_default();
        let mut args = ErrorCreateArgs {
            struct_size: offset_of!(ErrorCreateArgs, code) + size_of::<c_int>(),
            extension_start: null_mut(),
            message: message.as_ptr(),
            code: INVALID_ARGUMENT,
        };
        // SAFETY: XLA's table of functions is there in every call, and XLA copies the message.
        unsafe { ((*self.api).error_create)(&mut args) }
    }
}

impl Values {
    /// # Safety
    /// As XLA made it, in an execution.
    unsafe fn buffers<const N: usize>(&self) -> Result<[&Buffer; N], String> {
        if self.size != N as i64 {
            return Err(format!("{} arrays were passed, expected {N}", self.size));
        }
        // SAFETY: there are as many as `size` tells, all of them buffers, which is the only kind that there is.
        Ok(std::array::from_fn(|k| unsafe { &**self.values.add(k) }))
    }
}

/// Types of Rust with their numbers in XLA. For all of them zeros are a value.
pub trait Element: Copy {
    /// The number.
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
        let dims = match self.rank {
            0 => &[],
            // SAFETY: XLA tells as many dimensions as the rank.
            rank => unsafe { slice::from_raw_parts(self.dims, rank as usize) },
        };
        if self.dtype != T::DTYPE || dims.iter().product::<i64>() != len as i64 {
            let (got, expected) = (self.dtype, T::DTYPE);
            return Err(format!("an array has type {got} and shape {dims:?}, expected {len} of type {expected}"));
        }
        Ok(())
    }

    /// What is in it.
    ///
    /// # Safety
    /// It is an argument of an execution; a `bool` must be one.
    pub unsafe fn read<T: Element>(&self, len: usize) -> Result<&[T], String> {
        self.check::<T>(len)?;
        // SAFETY: XLA aligns and fills it; type and length were compared.
        Ok(unsafe { slice::from_raw_parts(self.data.cast(), len) })
    }

    /// A place for a result, filled with zeros.
    ///
    /// # Safety
    /// It is a result of an execution, asked for once.
    #[expect(clippy::mut_from_ref, reason = "the memory belongs to the caller of the handler, who asks once")]
    pub unsafe fn write<T: Element>(&self, len: usize) -> Result<&mut [T], String> {
        self.check::<T>(len)?;
        let data: *mut T = self.data.cast();
        // SAFETY: XLA aligns it; type and length were compared, and what was there before need not be a value.
        unsafe {
            data.write_bytes(0, len);
            Ok(slice::from_raw_parts_mut(data, len))
        }
    }
}
