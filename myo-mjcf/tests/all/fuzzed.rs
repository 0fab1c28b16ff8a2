//! What the fuzzer found worth keeping: every input reaches code that no smaller one reaches.

#[path = "../../fuzz/any.rs"]
mod any;

/// As `fuzz/keep.py` wrote it.
const CORPUS: &str = include_str!("../../fuzz/corpus.txt");

#[test]
fn what_the_fuzzer_found_ends_with_a_tree_or_an_error() {
    let inputs: Vec<&str> = CORPUS.split('\u{1e}').collect();
    assert!(inputs.len() > 500, "{} inputs", inputs.len());
    let panics: Vec<_> = inputs.iter().filter(|input| std::panic::catch_unwind(|| any::read(input)).is_err()).collect();
    assert_eq!(panics, Vec::<&&str>::new());
}
