//! What to write instead of a name that does not exist.
//!
//! ```
//! use myo_nearest::Nearest;
//!
//! assert_eq!(Nearest::to("ulma", &["radius", "ulna"]).to_string(), "did you mean `ulna`?");
//! ```
//!
//! This crate knows nothing but names.

use std::fmt;

/// Similarity, from 0 to 1, below which a name is no help.
const SIMILAR: f64 = 0.6;

/// Letters from which on a name that is part of another one counts: `x` is part of many.
const PART_LETTERS: usize = 3;

/// Names that are proposed at most.
const MOST_SIMILAR: usize = 3;

/// Names that are listed at most when none is similar.
const MOST_LISTED: usize = 24;

/// Names that exist, for one who wrote a name that does not: the most similar ones, or what there is to choose from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Nearest {
    /// The most similar names, the best first; at least one.
    Similar(Vec<String>),
    /// No name is similar.
    Valid {
        /// The first of those that exist, in their own order.
        listed: Vec<String>,
        /// How many others there are.
        others: usize,
    },
}

impl Nearest {
    /// The names among `valid` that `name` may stand for; letter case does not count.
    pub fn to(name: &str, valid: &[&str]) -> Self {
        let mut ranked: Vec<_> = valid.iter().map(|other| (similarity(name, other), *other)).collect();
        ranked.retain(|(similarity, _)| *similarity >= SIMILAR);
        ranked.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        if ranked.is_empty() {
            let listed = valid.iter().take(MOST_LISTED).map(ToString::to_string).collect();
            return Self::Valid { listed, others: valid.len().saturating_sub(MOST_LISTED) };
        }
        Self::Similar(ranked.into_iter().take(MOST_SIMILAR).map(|(_, other)| other.to_owned()).collect())
    }
}

impl fmt::Display for Nearest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Similar(names) => match &quoted(names)[..] {
                [most @ .., last] if !most.is_empty() => write!(f, "did you mean {} or {last}?", most.join(", ")),
                names => write!(f, "did you mean {}?", names.concat()),
            },
            Self::Valid { listed, others } => match (&listed[..], others) {
                ([], _) => f.write_str("there is none"),
                (_, 0) => write!(f, "valid are {}", quoted(listed).join(", ")),
                (_, others) => write!(f, "valid are {} and {others} others", quoted(listed).join(", ")),
            },
        }
    }
}

/// Similarity from 0 to 1. A name that contains the other one counts as well as one with few typing slips.
fn similarity(name: &str, other: &str) -> f64 {
    let [name, other] = [name, other].map(str::to_lowercase);
    let contains = |whole: &str, part: &str| part.chars().count() >= PART_LETTERS && whole.contains(part);
    let slips = strsim::normalized_damerau_levenshtein(&name, &other);
    if contains(&name, &other) || contains(&other, &name) { slips.max(SIMILAR) } else { slips }
}

fn quoted(names: &[String]) -> Vec<String> {
    names.iter().map(|name| format!("`{name}`")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(name: &str, valid: &[&str]) -> String {
        Nearest::to(name, valid).to_string()
    }

    #[test]
    fn similar_names_come_best_first_whatever_their_case() {
        let valid = ["ulna", "humphant", "humerus", "humphant1"];
        assert_eq!(message("HUMPHANTT", &valid), "did you mean `humphant` or `humphant1`?");
        assert_eq!(message("Ulma", &valid), "did you mean `ulna`?");
        let all = ["reach_a", "reach_b", "reach_c", "reach_d"];
        assert_eq!(message("reach_", &all), "did you mean `reach_a`, `reach_b` or `reach_c`?");
    }

    #[test]
    fn a_name_that_is_part_of_another_counts_either_way() {
        assert_eq!(message("typing", &["pointing-single", "mobile-typing"]), "did you mean `mobile-typing`?");
        assert_eq!(message("TRIlong-P1-old-and-long", &["BIC", "TRIlong"]), "did you mean `TRIlong`?");
    }

    #[test]
    fn what_resembles_nothing_comes_with_what_there_is() {
        // A single letter is part of it by chance.
        assert_eq!(message("size", &["x", "y", "z"]), "valid are `x`, `y`, `z`");
        assert_eq!(message("size", &[]), "there is none");
        let many: Vec<_> = (0..30).map(|number| format!("site{number}")).collect();
        let many: Vec<_> = many.iter().map(String::as_str).collect();
        let message = message("qqq", &many);
        assert!(
            message.starts_with("valid are `site0`, `site1`,") && message.ends_with("`site23` and 6 others"),
            "{message}"
        );
    }
}
