//! Paths in a task file as people say them, who count from one.

/// `targets[1].radius` as `` `radius` of target 2 ``, `script[0].drag.to` as `` `drag.to` of entry 1 of the script ``, `scene.b.size[1]`
/// as ``the height of `scene.b` ``.
pub(crate) fn spoken(path: &str) -> String {
    let Some((item, field)) = innermost(path) else { return format!("`{path}`") };
    match field {
        "" => item,
        field => format!("`{field}` of {item}"),
    }
}

/// The innermost entry of a list that a path leads through, in words, and the rest of the path.
fn innermost(path: &str) -> Option<(String, &str)> {
    let (list, rest) = path.rsplit_once('[')?;
    let (index, field) = rest.split_once(']')?;
    let index: usize = index.parse().ok()?;
    Some((entry(list, index), field.trim_start_matches('.')))
}

/// An entry of a list, counted from zero.
fn entry(list: &str, index: usize) -> String {
    let number = index + 1;
    if let Some(within) = list.strip_suffix(".repeat.steps") {
        return format!("entry {number} of the repetition in {}", spoken(within));
    }
    match (list, list.rsplit_once('.')) {
        ("targets", _) => format!("target {number}"),
        ("script", _) => format!("entry {number} of the script"),
        (_, Some((owner, field))) => match component(field, index) {
            Some(component) => format!("the {component} of {}", spoken(owner)),
            None => format!("entry {number} of {}", spoken(list)),
        },
        (_, None) => format!("entry {number} of {}", spoken(list)),
    }
}

/// What the numbers of a size or a place are called.
pub(crate) fn component(field: &str, index: usize) -> Option<&'static str> {
    let names = match field {
        "size" => ["width", "height", "depth"],
        "at" | "position" => ["x position", "y position", "z position"],
        _ => return None,
    };
    names.get(index).copied()
}

#[cfg(test)]
mod tests {
    use super::spoken;

    #[test]
    fn whatever_has_an_index_is_counted_from_one() {
        for (path, words) in [
            ("time_limit_s", "`time_limit_s`"),
            ("scene.panel.of", "`scene.panel.of`"),
            ("targets[0]", "target 1"),
            ("targets[1].dwell_s", "`dwell_s` of target 2"),
            ("script[0]", "entry 1 of the script"),
            ("script[2].drag.to", "`drag.to` of entry 3 of the script"),
            ("script[1].press[3]", "entry 4 of `press` of entry 2 of the script"),
            ("script[0].repeat.steps[1].dwell", "`dwell` of entry 2 of the repetition in entry 1 of the script"),
            ("scene.b.size[1]", "the height of `scene.b`"),
            ("targets[0].position[2]", "the z position of target 1"),
            ("scene.b.moves.waves[0].by[2]", "entry 3 of `by` of entry 1 of `scene.b.moves.waves`"),
        ] {
            assert_eq!(spoken(path), words, "{path}");
        }
    }
}
