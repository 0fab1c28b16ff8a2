//! What the tests share.

use myo_gpu::{AdapterChoice, Gpu};

/// Any device. Without one the test fails, unless `MYO_NO_GPU` says that this is meant.
pub fn gpu() -> Option<Gpu> {
    match Gpu::open_with_cache(&AdapterChoice::Any, None) {
        Ok(gpu) => Some(gpu),
        Err(error) if std::env::var("MYO_NO_GPU").as_deref() == Ok("1") => {
            println!("skipped: MYO_NO_GPU=1, and {error}");
            None
        }
        Err(error) => panic!("{error}. To skip these tests, set MYO_NO_GPU=1."),
    }
}

/// Asserts that numbers agree relative to the larger of 1 and their size.
pub fn assert_close(what: &str, got: &[f32], expected: &[f32], tolerance: f32) {
    assert_eq!(got.len(), expected.len(), "{what}");
    for (i, (&a, &b)) in got.iter().zip(expected).enumerate() {
        assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{what} {i}: {a} on the card, {b} expected");
    }
}

/// Asserts that a kernel for matrix units keeps the rules of the language, also where no card could run it.
pub fn assert_valid(text: &str) {
    let module = naga::front::wgsl::parse_str(text).unwrap_or_else(|e| panic!("{}", e.emit_to_string(text)));
    assert_valid_module(&module, text);
}

/// The same of a module.
pub fn assert_valid_module(module: &naga::Module, text: &str) {
    let all = naga::valid::Capabilities::all();
    let valid = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), all).validate(module);
    assert!(valid.is_ok(), "{}", valid.unwrap_err().emit_to_string(text));
}
