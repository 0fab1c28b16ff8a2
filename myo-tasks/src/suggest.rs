//! Nearest valid names for a name that was mistyped.

/// Similarity, from 0 to 1, below which a name is no help.
const SIMILAR: f64 = 0.6;

/// At most three of `names`, the most similar to `given` first.
pub(crate) fn nearest(given: &str, names: &[&str]) -> Vec<String> {
    let given = given.to_lowercase();
    let mut scored: Vec<_> = names.iter().map(|name| (similarity(&given, name), *name)).collect();
    scored.retain(|(score, _)| *score >= SIMILAR);
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.into_iter().take(3).map(|(_, name)| name.to_owned()).collect()
}

/// A name that contains the given one, or is contained in it, counts as well as one with few typing slips.
fn similarity(given: &str, name: &str) -> f64 {
    if given.len() > 2 && (name.contains(given) || given.contains(name)) {
        return 0.9;
    }
    strsim::normalized_damerau_levenshtein(given, name)
}

/// `did you mean `a` or `b`?`, or the whole list when nothing is near.
pub(crate) fn hint(nearest: &[String], all: &[&str]) -> String {
    let quoted = |names: &mut dyn Iterator<Item = &str>| names.map(|name| format!("`{name}`")).collect::<Vec<_>>();
    if nearest.is_empty() {
        format!("valid are {}", quoted(&mut all.iter().copied()).join(", "))
    } else {
        format!("did you mean {}?", quoted(&mut nearest.iter().map(String::as_str)).join(" or "))
    }
}
