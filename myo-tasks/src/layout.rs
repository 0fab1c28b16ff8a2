//! Where each key of a YAML text stands, so that any later complaint about a value can point at it.

use std::fmt;

use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_saphyr::Spanned;

/// A position in a file, counted from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceLocation {
    /// File name as it was given, or the name of a preset.
    pub file: String,
    /// Line, from 1.
    pub line: u64,
    /// Column in characters, from 1.
    pub column: u64,
}

impl SourceLocation {
    pub(crate) fn new(file: &str, (line, column): Position) -> Self {
        Self { file: file.to_owned(), line, column }
    }
}

impl fmt::Display for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// Line and column.
pub(crate) type Position = (u64, u64);

/// The positions of all nodes of a YAML document.
#[derive(Clone, Debug)]
pub(crate) struct Layout(Spanned<Node>);

#[derive(Clone, Debug)]
enum Node {
    Scalar(Option<String>),
    List(Vec<Spanned<Node>>),
    Map(Vec<(Spanned<String>, Spanned<Node>)>),
}

impl Layout {
    /// Reads the positions; `None` when the text is not YAML at all.
    pub(crate) fn of(text: &str) -> Option<Self> {
        serde_saphyr::from_str_with_options(text, crate::load::yaml_options()).ok().map(Self)
    }

    /// Where the value at `path` (such as `targets[1].radius`) stands; the nearest enclosing value when it is left out.
    pub(crate) fn value(&self, path: &str) -> Position {
        let mut node = &self.0;
        for part in parts(path) {
            let child = match &node.value {
                Node::Map(entries) => entries.iter().find(|(key, _)| key.value == part).map(|(_, value)| value),
                Node::List(items) => part.parse().ok().and_then(|i: usize| items.get(i)),
                Node::Scalar(_) => None,
            };
            match child {
                Some(child) => node = child,
                None => break,
            }
        }
        position(node)
    }

    /// Whether there is a value at `path`.
    pub(crate) fn has(&self, path: &str) -> bool {
        let mut node = &self.0;
        for part in parts(path) {
            let Node::Map(entries) = &node.value else { return false };
            let Some((_, child)) = entries.iter().find(|(key, _)| key.value == part) else { return false };
            node = child;
        }
        true
    }

    /// The first key called `name` at or after `from` in reading order, and the path of the map that holds it.
    pub(crate) fn key(&self, name: &str, from: Position) -> Option<(Position, String)> {
        find(&self.0, "", &mut |key, _, path| {
            (key.value == name && position(key) >= from).then(|| (position(key), path.to_owned()))
        })
    }

    /// The first value of a key called `name` that reads `text` at or after `from`.
    pub(crate) fn scalar(&self, name: &str, text: &str, from: Position) -> Option<(Position, String)> {
        find(&self.0, "", &mut |key, value, path| {
            let found = matches!(&value.value, Node::Scalar(Some(scalar)) if scalar == text);
            (found && key.value == name && position(value) >= from).then(|| (position(value), path.to_owned()))
        })
    }

    /// The entry whose key or value stands exactly at `at`: its path, where its value stands, and what that is in words.
    pub(crate) fn entry(&self, at: Position) -> Option<(String, Position, String)> {
        find(&self.0, "", &mut |key, value, path| {
            (position(key) == at || position(value) == at)
                .then(|| (join(path, &key.value), position(value), value.value.in_words()))
        })
    }

    /// The path of the innermost map or list that stands at `at`; empty for the whole document.
    pub(crate) fn path_at(&self, at: Position) -> String {
        let mut path = String::new();
        let mut node = &self.0;
        'down: loop {
            match &node.value {
                Node::Map(entries) => {
                    for (key, value) in entries.iter().rev() {
                        if position(key) <= at {
                            if matches!(value.value, Node::Scalar(_)) {
                                break 'down;
                            }
                            path = join(&path, &key.value);
                            node = value;
                            continue 'down;
                        }
                    }
                }
                Node::List(items) => {
                    for (i, item) in items.iter().enumerate().rev() {
                        if position(item) <= at && !matches!(item.value, Node::Scalar(_)) {
                            path = format!("{path}[{i}]");
                            node = item;
                            continue 'down;
                        }
                    }
                }
                Node::Scalar(_) => {}
            }
            break;
        }
        path
    }
}

impl Node {
    fn in_words(&self) -> String {
        match self {
            Self::Scalar(Some(text)) => format!("`{text}`"),
            Self::Scalar(None) => "empty".into(),
            Self::List(items) => format!("a list of {}", items.len()),
            Self::Map(_) => "a group of keys".into(),
        }
    }
}

/// Depth-first search over all entries of all maps, in reading order.
fn find<R>(
    node: &Spanned<Node>,
    path: &str,
    test: &mut impl FnMut(&Spanned<String>, &Spanned<Node>, &str) -> Option<R>,
) -> Option<R> {
    match &node.value {
        Node::Scalar(_) => None,
        Node::List(items) => items.iter().enumerate().find_map(|(i, item)| find(item, &format!("{path}[{i}]"), test)),
        Node::Map(entries) => entries
            .iter()
            .find_map(|(key, value)| test(key, value, path).or_else(|| find(value, &join(path, &key.value), test))),
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// `targets[1].radius` as `targets`, `1`, `radius`.
fn parts(path: &str) -> impl Iterator<Item = &str> {
    path.split(['.', '[', ']']).filter(|part| !part.is_empty())
}

fn position<T>(node: &Spanned<T>) -> Position {
    (node.referenced.line(), node.referenced.column())
}

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

macro_rules! scalars {
    ($($visit:ident: $kind:ty),*) => {$(
        fn $visit<E>(self, value: $kind) -> Result<Node, E> {
            Ok(Node::Scalar(Some(value.to_string())))
        }
    )*};
}

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("any value")
    }

    scalars!(visit_bool: bool, visit_i64: i64, visit_u64: u64, visit_f64: f64, visit_str: &str);

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Scalar(None))
    }

    fn visit_none<E>(self) -> Result<Node, E> {
        Ok(Node::Scalar(None))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Node, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Node::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Node, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Node::Map(entries))
    }
}
