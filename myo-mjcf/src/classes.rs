//! Default classes: what elements say without saying it.

use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::nearest::{nearest, short};
use crate::place::{Kind, Place};
use crate::read::Reader;
use crate::table::{Scope, Table, fill, unknown_attribute};
use std::collections::BTreeMap;
use std::rc::Rc;

/// The class of everything that names none.
pub(crate) const MAIN: &str = "main";

/// What each element is before its own attributes are read. Shared, since most classes say little.
#[derive(Clone, Debug, Default)]
pub(crate) struct Class {
    pub mesh: Rc<Mesh>,
    pub texture: Rc<Texture>,
    pub material: Rc<Material>,
    pub joint: Rc<Joint>,
    pub geom: Rc<Geom>,
    pub site: Rc<Site>,
    pub camera: Rc<Camera>,
    pub light: Rc<Light>,
    pub pair: Rc<Pair>,
    pub equality: Rc<Equality>,
    pub tendon: Rc<Tendon>,
    pub actuator: Rc<Actuator>,
}

/// The classes of a file, by name.
#[derive(Debug, Default)]
pub(crate) struct Classes {
    by_name: BTreeMap<String, (Rc<Class>, Place)>,
    main: Rc<Class>,
}

impl Classes {
    pub fn main(&self) -> Rc<Class> {
        self.main.clone()
    }

    /// The class that an attribute of a node names, if there is the attribute.
    pub fn of(&self, node: &Node, attribute: &'static str) -> Result<Option<Rc<Class>>, MjcfError> {
        let Some(name) = node.get(attribute) else { return Ok(None) };
        match self.by_name.get(name) {
            Some((class, _)) => Ok(Some(class.clone())),
            None if name == MAIN => Ok(Some(self.main())),
            None => {
                let names: Vec<_> = [MAIN].into_iter().chain(self.by_name.keys().map(String::as_str)).collect();
                let (at, nearest) = (node.at_attribute(attribute), nearest(name, &names));
                Err(MjcfError::UnknownClass { at, attribute, name: short(name), nearest })
            }
        }
    }
}

/// Elements that a class may have, once each; shortcuts of actuators all act on the same.
const CLASS_ELEMENTS: [&str; 23] = [
    "default",
    "mesh",
    "texture",
    "material",
    "joint",
    "geom",
    "site",
    "camera",
    "light",
    "pair",
    "equality",
    "tendon",
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    // Names that are known, and refused.
    "orientation",
    "pid",
];

impl Reader<'_> {
    /// Reads a `default` section: the class of everything, and those within it.
    pub(crate) fn default_section(&mut self, section: &Node) -> Result<(), MjcfError> {
        if section.get("class").is_some_and(|name| name != MAIN && !name.is_empty()) {
            return Err(
                section.misplaced("the outermost default class is `main`; leave the name out, or nest the class")
            );
        }
        let main = self.class(section, (*self.classes.main).clone())?;
        self.classes.main = Rc::new(main);
        self.nested_classes(section, &self.classes.main())
    }

    fn nested_classes(&mut self, parent: &Node, inherited: &Class) -> Result<(), MjcfError> {
        for node in self.document.children(parent).filter(|node| &*node.tag == "default") {
            self.budget.book(1, 0, || node.spot())?;
            let name = node.get("class").filter(|name| !name.is_empty());
            let name = name.ok_or_else(|| MjcfError::Missing { at: node.at(), attribute: "class" })?;
            let first = match self.classes.by_name.get(name) {
                Some((_, place)) => Some(place.clone()),
                None if name == MAIN => Some(parent.place.clone()),
                None => None,
            };
            if let Some(first) = first {
                return Err(MjcfError::DuplicateName { at: node.at_attribute("class"), kind: Kind::Class, first });
            }
            let class = Rc::new(self.class(node, inherited.clone())?);
            self.classes.by_name.insert(name.to_owned(), (class.clone(), node.place.clone()));
            self.nested_classes(node, &class)?;
        }
        Ok(())
    }

    /// A class is what its parent is, changed by its elements.
    fn class(&mut self, section: &Node, mut class: Class) -> Result<Class, MjcfError> {
        if let Some(other) = section.attributes.iter().find(|attribute| &*attribute.name != "class") {
            return Err(unknown_attribute(section, &other.name, &["class"]));
        }
        self.once(section, &CLASS_ELEMENTS[1..])?;
        for node in self.document.children(section) {
            self.class_element(node, &mut class)?;
        }
        Ok(class)
    }

    /// Changes what a class says of an element; a list that it inherits is held once more.
    fn set<T: Table + Clone>(&mut self, node: &Node, table: &mut Rc<T>) -> Result<(), MjcfError> {
        let table: &mut T = Rc::make_mut(table);
        fill(node, Scope::Class, &mut [table], &[])?;
        self.budget.book(1, table.held() as u64, || node.spot())
    }

    fn class_element(&mut self, node: &Node, class: &mut Class) -> Result<(), MjcfError> {
        match &*node.tag {
            "default" => return Ok(()),
            "mesh" => self.set(node, &mut class.mesh)?,
            "texture" => self.set(node, &mut class.texture)?,
            "material" => {
                self.set(node, &mut class.material)?;
                if let Some(layers) = self.layers(node)? {
                    Rc::make_mut(&mut class.material).layers = layers;
                }
                return Ok(());
            }
            "joint" => self.set(node, &mut class.joint)?,
            "geom" => self.set(node, &mut class.geom)?,
            "site" => self.set(node, &mut class.site)?,
            "camera" => self.set(node, &mut class.camera)?,
            "light" => self.set(node, &mut class.light)?,
            "pair" => self.set(node, &mut class.pair)?,
            "equality" => self.set(node, &mut class.equality)?,
            "tendon" => self.set(node, &mut class.tendon)?,
            tag if CLASS_ELEMENTS.contains(&tag) || tag == "dcmotor" => {
                let actuator = (*class.actuator).clone();
                if let Some(actuator) = self.actuator(node, actuator, Scope::Class)? {
                    class.actuator = Rc::new(actuator);
                }
            }
            _ => return Err(node.unknown("default", &CLASS_ELEMENTS)),
        }
        self.childless(node)
    }
}
