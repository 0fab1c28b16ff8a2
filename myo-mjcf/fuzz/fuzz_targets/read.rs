//! Any bytes as the main file: reading ends, without a panic.
//!
//! `cargo +nightly fuzz run read fuzz/corpus/read fuzz/seeds -- -max_len=4096 -dict=fuzz/mjcf.dict` in the folder of the crate. What it finds
//! is kept in `corpus.txt` by `keep.py`, and read by the tests of every day (`tests/all/fuzzed.rs`).

#![no_main]

#[path = "../any.rs"]
mod any;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        any::read(text);
    }
});
