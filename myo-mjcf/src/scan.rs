//! A first look at the text, before the XML library sees it: what is cheap to refuse, and what MuJoCo forgives.

use crate::error::MjcfError;
use crate::limits::{Limits, too_much};
use crate::place::{Place, Spot};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Attributes of an element on average, at most.
const ATTRIBUTES_EACH: usize = 10;

/// Text that the XML library takes, and what it has more than the file.
pub(crate) struct Clean<'t> {
    pub text: Cow<'t, str>,
    /// Positions of spaces that are not in the file.
    pub added: Vec<usize>,
}

/// The text as XML. MuJoCo's parser forgives `--` in comments, which is blanked, and attributes without a space between
/// them, which get one.
///
/// Refuses document types and namespaces, and more elements, depth or attributes than the limits allow.
pub(crate) fn scan<'t>(text: &'t str, file: &Arc<str>, limits: &Limits) -> Result<Clean<'t>, MjcfError> {
    let mut scanner = Scanner { text, file, limits, depth: 0, elements: 0, attributes: 0, edits: Vec::new() };
    let mut at = 0;
    while let Some(start) = text[at..].find('<') {
        match scanner.markup(at + start)? {
            Some(end) => at = end,
            // Something has no end; the XML library says what and where.
            None => break,
        }
    }
    Ok(edited(text, &scanner.edits))
}

/// What must change for the library.
enum Edit {
    Blank(Range<usize>),
    Space(usize),
}

struct Scanner<'a> {
    text: &'a str,
    file: &'a Arc<str>,
    limits: &'a Limits,
    depth: usize,
    elements: usize,
    attributes: usize,
    edits: Vec<Edit>,
}

impl Scanner<'_> {
    /// Passes what starts at `start` with `<`; the position after it.
    fn markup(&mut self, start: usize) -> Result<Option<usize>, MjcfError> {
        let text = self.text;
        let rest = &text[start..];
        let after = |opening: &str, closing: &str| {
            rest[opening.len()..].find(closing).map(|end| start + opening.len() + end + closing.len())
        };
        if rest.starts_with("<!--") {
            let end = after("<!--", "-->");
            if let Some(end) = end {
                self.comment(start + 4..end - 3);
            }
            return Ok(end);
        }
        if rest.starts_with("<![CDATA[") {
            return Ok(after("<![CDATA[", "]]>"));
        }
        if rest.starts_with("<?") {
            return Ok(after("<?", "?>"));
        }
        if rest.starts_with("<!") {
            return Err(MjcfError::DocumentType { place: self.place(start) });
        }
        self.tag(start)
    }

    fn comment(&mut self, inside: Range<usize>) {
        let text = &self.text[inside.clone()];
        if text.contains("--") || text.ends_with('-') {
            self.edits.push(Edit::Blank(inside));
        }
    }

    fn tag(&mut self, start: usize) -> Result<Option<usize>, MjcfError> {
        let bytes = self.text.as_bytes();
        let (mut quote, mut attributes) = (None, 0);
        for (at, &byte) in bytes.iter().enumerate().skip(start + 1) {
            match (quote, byte) {
                (Some(open), _) if open == byte => {
                    quote = None;
                    if bytes.get(at + 1).is_some_and(|next| next.is_ascii_alphabetic() || *next == b'_') {
                        self.edits.push(Edit::Space(at + 1));
                    }
                }
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => {
                    attributes += 1;
                    self.attribute(start, at, attributes)?;
                }
                (None, b'>') => {
                    self.count(start, bytes[start + 1] == b'/', bytes[at - 1] == b'/')?;
                    return Ok(Some(at + 1));
                }
                (None, b'<') => return Ok(None),
                (None, _) => {}
            }
        }
        Ok(None)
    }

    fn attribute(&mut self, start: usize, equals: usize, count: usize) -> Result<(), MjcfError> {
        if count > self.limits.attributes {
            return Err(too_much(self.spot(start), "attributes of one element", self.limits.attributes as u64));
        }
        self.attributes += 1;
        let most = self.limits.elements.saturating_mul(ATTRIBUTES_EACH);
        if self.attributes > most {
            return Err(too_much(self.spot(start), "attributes", most as u64));
        }
        // Looked for in a window of bytes, since a position in the text may be within a character.
        let before = &self.text.as_bytes()[start..equals];
        let name = before.trim_ascii_end().rsplit(u8::is_ascii_whitespace).next().unwrap_or_default();
        if name == b"xmlns" || name.starts_with(b"xmlns:") {
            let message = "MJCF has no namespaces; leave `xmlns` out".to_owned();
            return Err(MjcfError::Xml { place: self.place(start), message });
        }
        Ok(())
    }

    fn count(&mut self, start: usize, closes: bool, empty: bool) -> Result<(), MjcfError> {
        if closes {
            self.depth = self.depth.saturating_sub(1);
            return Ok(());
        }
        self.elements += 1;
        if self.elements > self.limits.elements {
            return Err(too_much(self.spot(start), "elements", self.limits.elements as u64));
        }
        if self.depth >= self.limits.depth {
            return Err(too_much(self.spot(start), "elements within each other", self.limits.depth as u64));
        }
        self.depth += usize::from(!empty);
        Ok(())
    }

    fn spot(&self, start: usize) -> Spot {
        let tag = self.text[start + 1..].chars().take_while(|c| !c.is_whitespace() && !matches!(c, '>' | '/' | '<'));
        // A name as long as the file would make a message as long as the file.
        Spot { place: self.place(start), tag: tag.take(64).collect(), name: None }
    }

    /// Counts lines from the start, so for errors only.
    fn place(&self, at: usize) -> Place {
        let before = &self.text[..at];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.matches('\n').count() + 1;
        let column = before[line_start..].chars().count() + 1;
        Place { file: self.file.clone(), line: bounded(line), column: bounded(column) }
    }
}

/// Follows positions of a text that only grow, so that a whole file is counted once.
pub(crate) struct Lines<'a> {
    clean: &'a Clean<'a>,
    /// How many of the added spaces have been passed.
    added: usize,
    at: usize,
    line: usize,
    column: usize,
}

impl<'a> Lines<'a> {
    pub fn new(clean: &'a Clean<'a>) -> Self {
        Self { clean, added: 0, at: 0, line: 1, column: 1 }
    }

    /// Line and column in the file of a position, which is not before the last one asked for.
    pub fn line_and_column(&mut self, position: usize) -> (u32, u32) {
        let passed = self.clean.text.get(self.at..position).unwrap_or_default();
        for (offset, c) in passed.char_indices() {
            if self.clean.added.get(self.added) == Some(&(self.at + offset)) {
                self.added += 1;
            } else if c == '\n' {
                (self.line, self.column) = (self.line + 1, 1);
            } else {
                self.column += 1;
            }
        }
        self.at = self.at.max(position);
        (bounded(self.line), bounded(self.column))
    }
}

impl Clean<'_> {
    /// A place that the library tells, in the file.
    pub fn in_file(&self, (line, column): (u32, u32)) -> (u32, u32) {
        let before: usize = self.text.split_inclusive('\n').take(line.saturating_sub(1) as usize).map(str::len).sum();
        let this = self.text[before..].split('\n').next().unwrap_or_default();
        let passed = this.char_indices().take(column.saturating_sub(1) as usize);
        let added = passed.filter(|(offset, _)| self.added.binary_search(&(before + offset)).is_ok()).count();
        (line, column.saturating_sub(bounded(added)))
    }
}

fn bounded(count: usize) -> u32 {
    u32::try_from(count).unwrap_or(u32::MAX)
}

fn edited<'t>(text: &'t str, edits: &[Edit]) -> Clean<'t> {
    if edits.is_empty() {
        return Clean { text: Cow::Borrowed(text), added: Vec::new() };
    }
    let (mut out, mut added, mut at) = (String::with_capacity(text.len() + edits.len()), Vec::new(), 0);
    for edit in edits {
        match edit {
            Edit::Blank(range) => {
                out.push_str(&text[at..range.start]);
                out.push_str(&text[range.clone()].replace('-', " "));
                at = range.end;
            }
            Edit::Space(position) => {
                out.push_str(&text[at..*position]);
                added.push(out.len());
                out.push(' ');
                at = *position;
            }
        }
    }
    out.push_str(&text[at..]);
    Clean { text: Cow::Owned(out), added }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scanned(text: &str) -> String {
        let clean = scan(text, &"a.xml".into(), &Limits::default());
        clean.map(|clean| clean.text.into_owned()).unwrap_or_else(|error| error.to_string())
    }

    #[test]
    fn only_comments_change_and_nothing_moves() {
        let text = "<a b=\"<!-- -- -->\"><!-- é -- x ---><![CDATA[<!-- -- -->]]><!-- fine - --></a>";
        let clean = "<a b=\"<!-- -- -->\"><!-- é    x  --><![CDATA[<!-- -- -->]]><!-- fine - --></a>";
        assert_eq!(scanned(text), clean);
    }

    #[test]
    fn attributes_get_their_space_and_places_do_not_move() {
        let clean = scan("<a b=\"1\"c='2'd=\"3\"/>", &"a.xml".into(), &Limits::default()).unwrap();
        assert_eq!(clean.text, "<a b=\"1\" c='2' d=\"3\"/>");
        let mut lines = Lines::new(&clean);
        let places: Vec<_> = ["b=", "c=", "d="].iter().map(|name| clean.text.find(name).unwrap()).collect();
        let columns: Vec<_> = places.iter().map(|&place| lines.line_and_column(place).1).collect();
        assert_eq!(columns, [4, 9, 14]);
        assert_eq!(clean.in_file((1, 16)), (1, 14));
    }

    #[test]
    fn what_does_not_end_is_left_to_the_library() {
        for text in ["<", "<!--", "<a", "<a b=\"", "<![CDATA[", "<?xml", "</", "<>", "<a <b"] {
            assert_eq!(scanned(text), text);
        }
    }

    #[test]
    fn document_types_and_namespaces_are_refused() {
        assert!(scanned("\n <!DOCTYPE a>").starts_with("a.xml:2:2: document type"));
        assert!(scanned("<é xmlns:x = \"u\"/>").starts_with("a.xml:1:1: MJCF has no namespaces"));
    }
}
