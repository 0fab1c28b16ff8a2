//! Preloaded into a program on Linux, makes one of its file operations go wrong.
//!
//! Operations on files below `FAULT_ROOT` are counted from 1 and, if `FAULT_LOG` is set, written there, `name path` each. The
//! one with the number `FAULT_AT` goes wrong as `FAULT` says: `kill` ends the process before it, `torn` in the middle of a
//! write; `eio` makes it fail once; `enospc` leaves no room from there on, after half of a write.
//!
//! The library's test `crash` compiles this file by itself, without Cargo.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

unsafe extern "C" {
    fn dlsym(handle: *mut c_void, name: *const c_char) -> *mut c_void;
    fn __errno_location() -> *mut c_int;
    fn getenv(name: *const c_char) -> *const c_char;
    fn kill(pid: c_int, signal: c_int) -> c_int;
    fn getpid() -> c_int;
    fn pause() -> c_int;
}

const NEXT: *mut c_void = -1_isize as *mut c_void;
const SIGKILL: c_int = 9;
const EIO: c_int = 5;
const ENOSPC: c_int = 28;
const O_CREAT: c_int = 0o100;

/// Descriptors of files below the root.
static WATCHED: [AtomicBool; 4096] = [const { AtomicBool::new(false) }; 4096];
static PATHS: Mutex<Vec<(c_int, String)>> = Mutex::new(Vec::new());
static COUNT: AtomicU64 = AtomicU64::new(0);
static IS_FULL: AtomicBool = AtomicBool::new(false);
static LOG: Mutex<c_int> = Mutex::new(-1);

/// The function that is hidden by the one of the same name here.
macro_rules! real {
    ($name:literal, fn($($arg:ty),*) -> $ret:ty) => {{
        let name = concat!($name, "\0").as_ptr().cast();
        // SAFETY: the C library has a function of this name and type.
        unsafe { std::mem::transmute::<*mut c_void, extern "C" fn($($arg),*) -> $ret>(dlsym(NEXT, name)) }
    }};
}

/// What an operation shall do.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Work,
    /// Fail with this error.
    Fail(c_int),
    /// Do half of what was asked, then as the next says.
    HalfThenKill,
    HalfThenFull,
}

fn variable(name: &'static [u8]) -> Option<String> {
    // SAFETY: the name ends with a zero, and the environment is not changed while the program runs.
    let value = unsafe { getenv(name.as_ptr().cast()) };
    // SAFETY: what is there ends with a zero.
    (!value.is_null()).then(|| unsafe { CStr::from_ptr(value) }.to_string_lossy().into_owned())
}

fn text(path: *const c_char) -> String {
    // SAFETY: paths end with a zero.
    unsafe { CStr::from_ptr(path) }.to_string_lossy().into_owned()
}

fn is_below(path: &str) -> bool {
    variable(b"FAULT_ROOT\0").is_some_and(|root| path.starts_with(&root))
}

fn die() -> ! {
    // SAFETY: ends this process.
    unsafe {
        kill(getpid(), SIGKILL);
        loop {
            pause();
        }
    }
}

fn log(name: &str, path: &str) {
    let Some(file) = variable(b"FAULT_LOG\0") else { return };
    let Ok(mut fd) = LOG.lock() else { return };
    if *fd < 0 {
        // Write, create, append.
        let file = format!("{file}\0");
        *fd = real!("open64", fn(*const c_char, c_int, c_int) -> c_int)(file.as_ptr().cast(), 0o2101, 0o644);
    }
    let line = format!("{name} {path}\n");
    real!("write", fn(c_int, *const c_void, usize) -> isize)(*fd, line.as_ptr().cast(), line.len());
}

/// Counts an operation; `takes_room` tells whether a full disk is in its way.
fn fate(name: &str, path: &str, takes_room: bool) -> Fate {
    let number = COUNT.fetch_add(1, Ordering::SeqCst) + 1;
    log(name, path);
    if IS_FULL.load(Ordering::SeqCst) && takes_room {
        return Fate::Fail(ENOSPC);
    }
    if variable(b"FAULT_AT\0").and_then(|at| at.parse().ok()) != Some(number) {
        return Fate::Work;
    }
    match (variable(b"FAULT\0").as_deref(), name) {
        (Some("kill"), _) => die(),
        (Some("torn"), "write") => Fate::HalfThenKill,
        (Some("eio"), _) => Fate::Fail(EIO),
        (Some("enospc"), "write") => Fate::HalfThenFull,
        (Some("enospc"), _) => {
            IS_FULL.store(true, Ordering::SeqCst);
            if takes_room { Fate::Fail(ENOSPC) } else { Fate::Work }
        }
        _ => Fate::Work,
    }
}

fn fail(error: c_int) -> c_int {
    // SAFETY: every thread has its own.
    unsafe { *__errno_location() = error };
    -1
}

fn path_of(fd: c_int) -> Option<String> {
    let is_watched = usize::try_from(fd).ok().and_then(|fd| WATCHED.get(fd)).is_some_and(|w| w.load(Ordering::SeqCst));
    let paths = if is_watched { PATHS.lock().ok()? } else { return None };
    paths.iter().rev().find(|(known, _)| *known == fd).map(|(_, path)| path.clone())
}

fn opened(fd: c_int, path: &str) -> c_int {
    if let Some(watched) = usize::try_from(fd).ok().and_then(|fd| WATCHED.get(fd)) {
        watched.store(true, Ordering::SeqCst);
        if let Ok(mut paths) = PATHS.lock() {
            paths.retain(|(known, _)| *known != fd);
            paths.push((fd, path.to_owned()));
        }
    }
    fd
}

/// Operations on a path.
macro_rules! on_path {
    ($name:ident, $symbol:literal, takes_room: $room:literal, ($path:ident: *const c_char $(, $arg:ident: $ty:ty)*)) => {
        /// See the C library.
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($path: *const c_char $(, $arg: $ty)*) -> c_int {
            let text = text($path);
            if is_below(&text) && let Fate::Fail(error) = fate($symbol, &text, $room) {
                return fail(error);
            }
            real!($symbol, fn(*const c_char $(, $ty)*) -> c_int)($path $(, $arg)*)
        }
    };
}

on_path!(mkdir, "mkdir", takes_room: true, (path: *const c_char, mode: u32));
on_path!(unlink, "unlink", takes_room: false, (path: *const c_char));
on_path!(rename, "rename", takes_room: false, (path: *const c_char, new: *const c_char));

/// Operations on an open file.
macro_rules! on_file {
    ($name:ident, $symbol:literal, takes_room: $room:literal, ($fd:ident $(, $arg:ident: $ty:ty)*)) => {
        /// See the C library.
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($fd: c_int $(, $arg: $ty)*) -> c_int {
            if let Some(path) = path_of($fd) && let Fate::Fail(error) = fate($symbol, &path, $room) {
                return fail(error);
            }
            real!($symbol, fn(c_int $(, $ty)*) -> c_int)($fd $(, $arg)*)
        }
    };
}

on_file!(fsync, "fsync", takes_room: true, (fd));
on_file!(fdatasync, "fdatasync", takes_room: true, (fd));
on_file!(ftruncate64, "ftruncate64", takes_room: false, (fd, length: i64));

/// See the C library.
#[unsafe(no_mangle)]
pub extern "C" fn open64(path: *const c_char, flags: c_int, mode: c_int) -> c_int {
    let name = text(path);
    let open = || real!("open64", fn(*const c_char, c_int, c_int) -> c_int)(path, flags, mode);
    if !is_below(&name) {
        return open();
    }
    match fate(if flags & O_CREAT != 0 { "create" } else { "open" }, &name, flags & O_CREAT != 0) {
        Fate::Fail(error) => fail(error),
        _ => opened(open(), &name),
    }
}

/// See the C library.
#[unsafe(no_mangle)]
pub extern "C" fn opendir(path: *const c_char) -> *mut c_void {
    let name = text(path);
    if is_below(&name)
        && let Fate::Fail(error) = fate("opendir", &name, false)
    {
        fail(error);
        return std::ptr::null_mut();
    }
    real!("opendir", fn(*const c_char) -> *mut c_void)(path)
}

/// See the C library.
#[unsafe(no_mangle)]
pub extern "C" fn read(fd: c_int, out: *mut c_void, length: usize) -> isize {
    if let Some(path) = path_of(fd)
        && let Fate::Fail(error) = fate("read", &path, false)
    {
        return fail(error) as isize;
    }
    real!("read", fn(c_int, *mut c_void, usize) -> isize)(fd, out, length)
}

/// See the C library.
#[unsafe(no_mangle)]
pub extern "C" fn write(fd: c_int, data: *const c_void, length: usize) -> isize {
    let write = |length| real!("write", fn(c_int, *const c_void, usize) -> isize)(fd, data, length);
    let Some(path) = path_of(fd) else { return write(length) };
    match fate("write", &path, true) {
        Fate::Work => write(length),
        Fate::Fail(error) => fail(error) as isize,
        Fate::HalfThenKill => {
            write(length / 2);
            die()
        }
        Fate::HalfThenFull => {
            IS_FULL.store(true, Ordering::SeqCst);
            write(length / 2)
        }
    }
}

/// See the C library.
#[unsafe(no_mangle)]
pub extern "C" fn close(fd: c_int) -> c_int {
    if let Some(watched) = usize::try_from(fd).ok().and_then(|fd| WATCHED.get(fd)) {
        watched.store(false, Ordering::SeqCst);
    }
    real!("close", fn(c_int) -> c_int)(fd)
}
