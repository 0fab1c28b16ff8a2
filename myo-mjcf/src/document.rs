//! The elements of a file and of all that it includes, as they are written.

use crate::error::MjcfError;
use crate::files::{FileError, Files, folder_of, join};
use crate::limits::{Budget, too_much};
use crate::mjcf::Refused;
use crate::nearest::{nearest, short};
use crate::place::{Place, Spot};
use crate::scan::{Clean, Lines, scan};
use roxmltree::{NodeId, ParsingOptions};
use std::collections::HashSet;
use std::sync::Arc;

/// An element as it is written.
#[derive(Debug)]
pub(crate) struct Node {
    pub tag: Box<str>,
    pub place: Place,
    pub attributes: Vec<Attribute>,
    pub children: Vec<usize>,
    /// Text between its tags, other than white space.
    pub text: Option<Box<str>>,
}

/// An attribute as it is written.
#[derive(Debug)]
pub(crate) struct Attribute {
    pub name: Box<str>,
    pub value: Box<str>,
    line: u32,
    column: u32,
}

impl Node {
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|attribute| &*attribute.name == name).map(|attribute| &*attribute.value)
    }

    pub fn spot(&self) -> Spot {
        // An empty name is none, as in MuJoCo.
        let name = self.get("name").filter(|name| !name.is_empty());
        Spot { place: self.place.clone(), tag: short(&self.tag), name: name.map(short) }
    }

    /// The element, at the place of one of its attributes.
    pub fn spot_of(&self, name: &str) -> Spot {
        let mut spot = self.spot();
        if let Some(attribute) = self.attributes.iter().find(|attribute| &*attribute.name == name) {
            (spot.place.line, spot.place.column) = (attribute.line, attribute.column);
        }
        spot
    }

    pub fn at(&self) -> Box<Spot> {
        Box::new(self.spot())
    }

    pub fn at_attribute(&self, name: &str) -> Box<Spot> {
        Box::new(self.spot_of(name))
    }

    pub fn unknown(&self, parent: &str, valid: &[&str]) -> MjcfError {
        MjcfError::UnknownElement { at: self.at(), parent: short(parent), nearest: nearest(&self.tag, valid) }
    }

    pub fn misplaced(&self, why: &'static str) -> MjcfError {
        MjcfError::Misplaced { at: self.at(), why }
    }
}

/// Stands for an include, which is replaced by what is in its file.
const NO_NODE: usize = usize::MAX;

/// A main file with what it includes; the first node is the root.
#[derive(Debug)]
pub(crate) struct Document {
    pub path: String,
    pub nodes: Vec<Node>,
    pub refused: Vec<Refused>,
    /// How deep elements stand at most.
    pub deepest: usize,
}

impl Document {
    /// Reads `main` and all that it includes; its root stands `depth` deep.
    pub fn load(files: &dyn Files, main: &str, depth: usize, budget: &mut Budget) -> Result<Self, MjcfError> {
        let main_error = |why| MjcfError::Main { path: main.to_owned(), why };
        let path = join("", main).ok_or_else(|| main_error(FileError::Outside))?;
        let text = read_text(files, &path, budget).map_err(main_error)?;
        let mut loader = Loader::new(files, &path, budget);
        loader.add_file(&path, &text, depth, 0, None)?;
        Ok(Self { deepest: loader.deepest, nodes: loader.nodes, refused: loader.refused, path })
    }

    pub fn root(&self) -> &Node {
        &self.nodes[0]
    }

    pub fn children<'a>(&'a self, node: &'a Node) -> impl Iterator<Item = &'a Node> {
        node.children.iter().map(|&child| &self.nodes[child])
    }
}

pub(crate) fn read_text(files: &dyn Files, path: &str, budget: &mut Budget) -> Result<String, FileError> {
    let left = budget.limits.total_bytes.saturating_sub(budget.bytes);
    let text = files.read(path, budget.limits.file_bytes.min(left))?;
    budget.bytes += text.len() as u64;
    Ok(text)
}

pub(crate) struct Loader<'a> {
    pub files: &'a dyn Files,
    pub budget: &'a mut Budget,
    pub main_folder: String,
    nodes: Vec<Node>,
    pub seen: HashSet<String>,
    refused: Vec<Refused>,
    deepest: usize,
}

impl<'a> Loader<'a> {
    fn new(files: &'a dyn Files, main: &str, budget: &'a mut Budget) -> Self {
        let seen = HashSet::from([main.to_owned()]);
        let main_folder = folder_of(main).to_owned();
        Self { files, budget, main_folder, nodes: Vec::new(), seen, refused: Vec::new(), deepest: 0 }
    }

    /// Adds the elements of a file: with its root if it is the main one, else below `parent`.
    pub fn add_file(
        &mut self,
        path: &str,
        text: &str,
        depth: usize,
        includes: usize,
        parent: Option<usize>,
    ) -> Result<(), MjcfError> {
        let file: Arc<str> = path.into();
        let clean = scan(text, &file, &self.budget.limits)?;
        // Text and comments between elements are nodes too.
        let most_nodes = self.budget.limits.elements.saturating_mul(4).saturating_add(16);
        let nodes_limit = u32::try_from(most_nodes).unwrap_or(u32::MAX);
        let options = ParsingOptions { nodes_limit, ..ParsingOptions::default() };
        let xml = roxmltree::Document::parse_with_options(&clean.text, options);
        let xml = xml.map_err(|error| xml_error(&error, &clean, &file))?;
        check_root(&xml, &clean, &file, parent.is_none())?;
        let mut lines = Lines::new(&clean);
        // Elements that the current one stands in. In place of the root of an included file stands its includer's parent.
        let mut open: Vec<(NodeId, usize)> = Vec::new();
        for node in xml.root_element().descendants() {
            while open.last().is_some_and(|(id, _)| Some(*id) != node.parent().map(|parent| parent.id())) {
                open.pop();
            }
            if node.is_text() {
                self.add_text(open.last().map(|(_, index)| *index), node.text().unwrap_or_default());
            }
            if !node.is_element() {
                continue;
            }
            if let (true, Some(parent)) = (open.is_empty(), parent) {
                open.push((node.id(), parent));
                continue;
            }
            let new = self.node(node, &file, &mut lines, depth + open.len())?;
            if let Some(&(_, parent)) = open.last() {
                if &*new.tag == "include" {
                    let is_empty = node.children().all(|child| !child.is_element());
                    self.include(&new, is_empty, path, depth + open.len() - 1, includes, parent)?;
                    open.push((node.id(), NO_NODE));
                    continue;
                }
                let index = self.nodes.len();
                self.nodes[parent].children.push(index);
            }
            open.push((node.id(), self.nodes.len()));
            self.nodes.push(new);
        }
        Ok(())
    }

    fn node(
        &mut self,
        node: roxmltree::Node<'_, '_>,
        file: &Arc<str>,
        lines: &mut Lines<'_>,
        depth: usize,
    ) -> Result<Node, MjcfError> {
        let mut place = |position| {
            let (line, column) = lines.line_and_column(position);
            Place { file: file.clone(), line, column }
        };
        let own = place(node.range().start);
        let attributes = node.attributes().map(|attribute| {
            let Place { line, column, .. } = place(attribute.range().start);
            Attribute { name: attribute.name().into(), value: attribute.value().into(), line, column }
        });
        let attributes = attributes.collect();
        let new = Node { tag: node.tag_name().name().into(), place: own, attributes, children: Vec::new(), text: None };
        if depth >= self.budget.limits.depth {
            return Err(too_much(new.spot(), "elements within each other", self.budget.limits.depth as u64));
        }
        self.deepest = self.deepest.max(depth);
        if self.nodes.len() >= self.budget.limits.elements {
            return Err(too_much(new.spot(), "elements", self.budget.limits.elements as u64));
        }
        Ok(new)
    }

    fn add_text(&mut self, parent: Option<usize>, text: &str) {
        let Some(node) = parent.and_then(|index| self.nodes.get_mut(index)) else { return };
        if text.trim().is_empty() {
            return;
        }
        // Only `<text>` says something between its tags.
        if &*node.tag == "text" {
            node.text.get_or_insert_default();
            node.text = node.text.take().map(|before| format!("{before}{text}").into());
        } else if node.text.is_none() {
            node.text = Some(Box::default());
            let why = "MuJoCo ignores text between elements; remove it, or make a comment of it";
            self.refused.push(Refused { element: node.tag.to_string(), place: node.place.clone(), why: why.into() });
        }
    }
}

fn check_root(
    xml: &roxmltree::Document<'_>,
    clean: &Clean<'_>,
    file: &Arc<str>,
    is_main: bool,
) -> Result<(), MjcfError> {
    let (expected, valid): (_, &[&str]) = if is_main {
        ("a model is `mujoco`", &["mujoco"])
    } else {
        ("a file to include is `mujocoinclude` or `mujoco`", &["mujocoinclude", "mujoco"])
    };
    let root = xml.root_element();
    let tag = root.tag_name().name();
    let (line, column) = Lines::new(clean).line_and_column(root.range().start);
    let at = Box::new(Spot { place: Place { file: file.clone(), line, column }, tag: short(tag), name: None });
    if !valid.contains(&tag) {
        return Err(MjcfError::Root { at, expected });
    }
    // What the root of an included file says is lost, so only its model's name may be there.
    match root.attributes().find(|attribute| attribute.name() != "model") {
        Some(other) => {
            let nearest = nearest(other.name(), &["model"]);
            Err(MjcfError::UnknownAttribute { at, attribute: short(other.name()), nearest })
        }
        None => Ok(()),
    }
}

fn xml_error(error: &roxmltree::Error, clean: &Clean<'_>, file: &Arc<str>) -> MjcfError {
    if matches!(error, roxmltree::Error::UnclosedRootNode) {
        let (line, column) = Lines::new(clean).line_and_column(clean.text.len());
        let message = "the file ends within an element; an end tag is missing".to_owned();
        return MjcfError::Xml { place: Place { file: file.clone(), line, column }, message };
    }
    let position = error.pos();
    let (line, column) = clean.in_file((position.row, position.col));
    let place = Place { file: file.clone(), line, column };
    // The library tells the place as well, within its sentence.
    let message = error.to_string().replace(&format!(" at {position}"), "");
    MjcfError::Xml { place, message }
}
