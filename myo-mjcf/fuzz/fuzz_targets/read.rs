//! Any bytes as the main file, with a few files to include and attach: reading ends, without a panic.
//!
//! `cargo +nightly fuzz run read fuzz/corpus/read fuzz/seeds -- -max_len=16384` in the folder of the crate.

#![no_main]

use libfuzzer_sys::fuzz_target;
use myo_mjcf::{Limits, read_from};
use std::collections::BTreeMap;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let files = [
        ("main.xml", text),
        ("parts.xml", include_str!("../../tests/data/parts.xml")),
        ("hand.xml", include_str!("../../tests/data/hand.xml")),
        ("self.xml", r#"<mujocoinclude><include file="self.xml"/></mujocoinclude>"#),
        ("a/b.xml", r#"<mujocoinclude><include file="../parts.xml"/></mujocoinclude>"#),
    ];
    let files: BTreeMap<_, _> = files.map(|(path, text)| (path.to_owned(), text.to_owned())).into();
    let mut limits = Limits::default();
    // Small enough that the worst case is quick.
    limits.elements = 5_000;
    limits.copies = 1_000;
    limits.held_bytes = 4 << 20;
    if let Err(error) = read_from(&files, "main.xml", limits) {
        assert!(!error.to_string().is_empty());
    }
});
