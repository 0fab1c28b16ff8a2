//! What is asked of the reader, whatever it reads: it ends, with a tree or with an error that says something.

use myo_mjcf::{Limits, read_from};
use std::collections::BTreeMap;

/// Reads a main file, with a few others that it may include and attach.
pub fn read(main: &str) {
    let files = [
        ("main.xml", main),
        ("parts.xml", include_str!("../tests/data/parts.xml")),
        ("hand.xml", include_str!("../tests/data/hand.xml")),
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
}
