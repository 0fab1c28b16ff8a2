//! Names for messages: nearest ones, and short ones.

use myo_nearest::Nearest;

/// Characters that a message shows of a text at most.
const SHOWN: usize = 64;

/// Names that are compared at most.
const COMPARED: usize = 2_000;

/// The nearest of the names that exist. What is too long to be a slip of the pen is not compared, as that takes the
/// product of both lengths.
pub(crate) fn nearest(name: &str, valid: &[&str]) -> Nearest {
    let valid: Vec<_> = valid.iter().copied().filter(|name| name.len() <= SHOWN).take(COMPARED).collect();
    Nearest::to(if name.len() <= SHOWN { name } else { "" }, &valid)
}

/// The start of a text, enough to find it.
pub(crate) fn short(text: &str) -> String {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_cut_and_not_compared() {
        assert_eq!(short(&"é".repeat(64)), "é".repeat(64));
        assert_eq!(short(&"é".repeat(65)), format!("{}…", "é".repeat(64)));
        let long = "size".repeat(1_000_000);
        assert_eq!(nearest(&long, &["size", &long]).to_string(), "valid are `size`");
        assert_eq!(nearest("siz", &["size"]).to_string(), "did you mean `size`?");
    }
}
