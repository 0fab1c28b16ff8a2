//! Reads a file: sections in MuJoCo's order, whatever theirs is.

use crate::classes::Classes;
use crate::document::{Document, Node};
use crate::elements::*;
use crate::error::MjcfError;
use crate::files::Files;
use crate::limits::Budget;
use crate::mjcf::{Mjcf, Refused};
use crate::place::{Kind, Place};
use crate::table::{Scope, Table, fill};
use std::collections::HashMap;
use std::rc::Rc;

/// What `<replicate>` does, for what refers to the things it copies.
#[derive(Debug)]
pub(crate) struct Replica {
    pub count: usize,
    pub separator: String,
    pub place: Place,
}

/// Reads one main file, with all that it includes.
pub(crate) struct Reader<'a> {
    pub files: &'a dyn Files,
    pub document: &'a Document,
    pub budget: &'a mut Budget,
    /// How deep elements stand already: that of the element which attaches this file.
    pub depth: usize,
    /// Main files that are being read, this one included: none may attach itself.
    pub attaching: Vec<String>,
    pub classes: Classes,
    pub models: HashMap<String, Rc<Document>>,
    pub replicas: Vec<Replica>,
    /// Names that a replica copied, so that nothing has them any more.
    pub copied: HashMap<(Kind, String), usize>,
    /// For each attached model how many replicas there were before, and how many elements of each list.
    pub arrivals: Vec<(usize, [usize; LISTS])>,
    pub out: Mjcf,
}

/// Lists of elements that refer to others, see [`Reader::lengths`].
pub(crate) const LISTS: usize = 7;

/// What of a model is wanted.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wanted<'a> {
    All,
    Body(&'a str),
    Frame(&'a str),
}

const SECTIONS: [&str; 17] = [
    "compiler",
    "option",
    "size",
    "visual",
    "statistic",
    "default",
    "extension",
    "custom",
    "asset",
    "contact",
    "deformable",
    "equality",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
    "worldbody",
];

impl<'a> Reader<'a> {
    pub fn new(
        files: &'a dyn Files,
        document: &'a Document,
        budget: &'a mut Budget,
        depth: usize,
        mut attaching: Vec<String>,
    ) -> Self {
        attaching.push(document.path.clone());
        Self {
            files,
            document,
            budget,
            depth,
            attaching,
            classes: Classes::default(),
            models: HashMap::new(),
            replicas: Vec::new(),
            copied: HashMap::new(),
            arrivals: Vec::new(),
            out: Mjcf::default(),
        }
    }

    /// How many elements there are of those that refer to others.
    pub fn lengths(&self) -> [usize; LISTS] {
        let out = &self.out;
        [
            out.pairs.len(),
            out.excludes.len(),
            out.tendons.len(),
            out.equalities.len(),
            out.actuators.len(),
            out.sensors.len(),
            out.tuples.len(),
        ]
    }

    pub fn read(mut self, wanted: Wanted<'_>) -> Result<Mjcf, MjcfError> {
        let root = self.document.root();
        self.out.refused.clone_from(&self.document.refused);
        self.out.model = root.get("model").map(str::to_owned);
        for section in self.document.children(root) {
            if !SECTIONS.contains(&&*section.tag) {
                return Err(section.unknown(&root.tag, &SECTIONS));
            }
        }
        for tag in &SECTIONS[..SECTIONS.len() - 1] {
            for section in self.document.children(root).filter(|section| &*section.tag == *tag) {
                self.section(section)?;
            }
        }
        self.tree(wanted)?;
        self.follow_copies()?;
        crate::check::check(&mut self.out)?;
        Ok(self.out)
    }

    fn section(&mut self, section: &'a Node) -> Result<(), MjcfError> {
        match &*section.tag {
            "compiler" => self.compiler(section),
            "option" => self.option(section),
            "size" => self.sizes(section),
            "visual" => self.visual(section),
            "statistic" => self.statistic(section),
            "default" => self.default_section(section),
            "extension" => self.each(section, |reader, node| {
                reader.refuse(node, "plugins are not read; leave them out");
                Ok(())
            }),
            "custom" => self.each(section, Self::custom),
            "asset" => self.each(section, Self::asset),
            "contact" => self.each(section, Self::contact),
            "deformable" => self.each(section, |reader, node| {
                reader.refuse(node, "flexible bodies and skins are not read; use rigid bodies");
                Ok(())
            }),
            "equality" => self.each(section, Self::equality),
            "tendon" => self.each(section, Self::tendon),
            "actuator" => self.each(section, |reader, node| {
                let class = reader.classes.of(node, "class")?.unwrap_or_else(|| reader.classes.main());
                let actuator = reader.actuator(node, (*class.actuator).clone(), Scope::Element)?;
                reader.out.actuators.extend(actuator);
                Ok(())
            }),
            "sensor" => self.each(section, Self::sensor),
            _ => self.each(section, Self::key),
        }
    }

    /// Reads the elements of a section, which has no attributes.
    fn each(
        &mut self,
        section: &'a Node,
        mut read: impl FnMut(&mut Self, &'a Node) -> Result<(), MjcfError>,
    ) -> Result<(), MjcfError> {
        fill(section, Scope::Element, &mut [], &[])?;
        self.document.children(section).try_for_each(|node| read(self, node))
    }

    /// An element over what its class says, counted.
    pub fn element<T: Table>(&mut self, node: &Node, mut element: T, except: &[&str]) -> Result<T, MjcfError> {
        fill(node, Scope::Element, &mut [&mut element], except)?;
        self.budget.book(1, element.held() as u64, || node.spot())?;
        Ok(element)
    }

    pub fn refuse(&mut self, node: &Node, why: &str) {
        let refused = Refused { element: node.tag.to_string(), place: node.place.clone(), why: why.to_owned() };
        self.out.refused.push(refused);
    }

    /// No element may stand in this one, except a plugin, which is refused.
    pub fn childless(&mut self, node: &Node) -> Result<(), MjcfError> {
        for child in self.document.children(node) {
            let may_be_plugin = matches!(&*node.tag, "geom" | "mesh");
            if !may_be_plugin || &*child.tag != "plugin" {
                return Err(child.unknown(&node.tag, if may_be_plugin { &["plugin"] } else { &[] }));
            }
            self.refuse(child, "plugins are not read; leave them out");
        }
        Ok(())
    }

    /// Each of these elements may stand in `parent` once.
    pub fn once(&self, parent: &Node, tags: &[&str]) -> Result<(), MjcfError> {
        let mut first: HashMap<&str, &Place> = HashMap::new();
        for node in self.document.children(parent).filter(|node| tags.contains(&&*node.tag)) {
            if let Some(place) = first.insert(&node.tag, &node.place) {
                return Err(MjcfError::Repeated { at: node.at(), first: place.clone() });
            }
        }
        Ok(())
    }

    fn contact(&mut self, node: &Node) -> Result<(), MjcfError> {
        match &*node.tag {
            "pair" => {
                let class = self.classes.of(node, "class")?.unwrap_or_else(|| self.classes.main());
                let pair = self.element(node, (*class.pair).clone(), &[])?;
                self.out.pairs.push(pair);
            }
            "exclude" => {
                let exclude = self.element(node, Exclude::default(), &[])?;
                self.out.excludes.push(exclude);
            }
            _ => return Err(node.unknown("contact", &["pair", "exclude"])),
        }
        self.childless(node)
    }

    fn key(&mut self, node: &Node) -> Result<(), MjcfError> {
        if &*node.tag != "key" {
            return Err(node.unknown("keyframe", &["key"]));
        }
        let key = self.element(node, Key::default(), &[])?;
        self.out.keys.push(key);
        self.childless(node)
    }

    fn custom(&mut self, node: &Node) -> Result<(), MjcfError> {
        match &*node.tag {
            "numeric" => {
                let numeric = self.element(node, Numeric::default(), &[])?;
                self.out.numerics.push(numeric);
            }
            "text" => {
                let mut text = self.element(node, Text::default(), &[])?;
                text.data = text.data.or_else(|| node.text.as_deref().map(str::to_owned));
                if text.data.is_none() {
                    return Err(MjcfError::Missing { at: node.at(), attribute: "data" });
                }
                self.out.texts.push(text);
            }
            "tuple" => return self.tuple(node),
            _ => return Err(node.unknown("custom", &["numeric", "text", "tuple"])),
        }
        self.childless(node)
    }

    fn tuple(&mut self, node: &Node) -> Result<(), MjcfError> {
        let mut tuple = self.element(node, Tuple::default(), &[])?;
        for child in self.document.children(node) {
            if &*child.tag != "element" {
                return Err(child.unknown("tuple", &["element"]));
            }
            let element = self.element(child, TupleElement::default(), &[])?;
            check_object_type(child, "objtype", &element.objtype)?;
            self.childless(child)?;
            tuple.elements.push(element);
        }
        self.out.tuples.push(tuple);
        Ok(())
    }
}

/// Words that stand for kinds of elements.
pub(crate) const OBJECT_TYPES: [&str; 21] = [
    "body", "xbody", "joint", "dof", "geom", "site", "camera", "light", "mesh", "hfield", "texture", "material",
    "pair", "exclude", "equality", "tendon", "actuator", "sensor", "numeric", "text", "tuple",
];

pub(crate) fn check_object_type(node: &Node, attribute: &str, word: &str) -> Result<(), MjcfError> {
    match object_kind(word) {
        Some(_) => Ok(()),
        None => Err(crate::value::Fault::keyword(word, &OBJECT_TYPES).of(node, attribute)),
    }
}
