//! Nearest valid names for a name that was mistyped.

/// Similarity, from 0 to 1, below which a name is no help.
const SIMILAR: f64 = 0.6;

/// ``did you mean `a` or `b`?``, or the whole list when nothing is near.
pub(crate) fn hint(given: &str, valid: &[&str]) -> String {
    match nearest(given, valid)[..] {
        [] => format!("valid are {}", quoted(valid).join(", ")),
        ref near => format!("did you mean {}?", quoted(near).join(" or ")),
    }
}

/// At most three of `valid`, the most similar to `given` first.
fn nearest<'a>(given: &str, valid: &[&'a str]) -> Vec<&'a str> {
    let given = given.to_lowercase();
    let mut scored: Vec<_> = valid.iter().map(|name| (similarity(&given, name), *name)).collect();
    scored.retain(|(score, _)| *score >= SIMILAR);
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.into_iter().take(3).map(|(_, name)| name).collect()
}

/// A name that contains the given one, or is contained in it, counts as well as one with few typing slips.
fn similarity(given: &str, name: &str) -> f64 {
    let slips = strsim::normalized_damerau_levenshtein(given, name);
    let contained = given.len() > 2 && (name.contains(given) || given.contains(name));
    if contained { slips.max(SIMILAR) } else { slips }
}

fn quoted(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| format!("`{name}`")).collect()
}
