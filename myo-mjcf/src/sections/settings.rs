//! Compiler, options, sizes, statistics: several elements add up, the last one to say something wins.

use crate::document::Node;
use crate::elements::Coordinates;
use crate::error::MjcfError;
use crate::read::Reader;
use crate::table::{Scope, exclusive, fill};

/// Groups of actuators that can be switched off: bits of an `int`.
const ACTUATOR_GROUPS: i32 = 31;

impl Reader<'_> {
    pub(crate) fn compiler(&mut self, node: &Node) -> Result<(), MjcfError> {
        fill(node, Scope::Element, &mut [&mut self.out.compiler], &[])?;
        if self.out.compiler.coordinate() == Coordinates::Global {
            return Err(node.misplaced("global coordinates are not read; save the model with MuJoCo 2.3.3"));
        }
        self.once(node, &["lengthrange"])?;
        for child in self.document.children(node) {
            if &*child.tag != "lengthrange" {
                return Err(child.unknown("compiler", &["lengthrange"]));
            }
            fill(child, Scope::Element, &mut [&mut self.out.length_range], &[])?;
            self.childless(child)?;
        }
        Ok(())
    }

    pub(crate) fn option(&mut self, node: &Node) -> Result<(), MjcfError> {
        let before = self.out.option.actuatorgroupdisable.take();
        fill(node, Scope::Element, &mut [&mut self.out.option], &[])?;
        let groups = self.out.option.actuatorgroupdisable.take();
        if groups.iter().flatten().any(|group| !(0..ACTUATOR_GROUPS).contains(group)) {
            let attribute = "actuatorgroupdisable";
            let text = node.get(attribute).unwrap_or_default().to_owned();
            return Err(MjcfError::OutOfRange {
                at: node.at_attribute(attribute),
                attribute,
                text,
                expected: "0 to 30",
            });
        }
        // Groups that are off stay off.
        self.out.option.actuatorgroupdisable = match (before, groups) {
            (Some(before), Some(groups)) => Some([before, groups].concat()),
            (before, groups) => before.or(groups),
        };
        self.once(node, &["flag"])?;
        for child in self.document.children(node) {
            if &*child.tag != "flag" {
                return Err(child.unknown("option", &["flag"]));
            }
            fill(child, Scope::Element, &mut [&mut self.out.flags], &[])?;
            self.childless(child)?;
        }
        Ok(())
    }

    pub(crate) fn sizes(&mut self, node: &Node) -> Result<(), MjcfError> {
        fill(node, Scope::Element, &mut [&mut self.out.sizes], &[])?;
        exclusive(node, &["memory", "nstack"])?;
        exclusive(node, &["memory", "njmax"])?;
        let sizes = &self.out.sizes;
        let counts = [
            ("njmax", sizes.njmax),
            ("nconmax", sizes.nconmax),
            ("nstack", sizes.nstack),
            ("nuserdata", sizes.nuserdata),
            ("nkey", sizes.nkey),
            ("nuser_body", sizes.nuser_body),
            ("nuser_jnt", sizes.nuser_jnt),
            ("nuser_geom", sizes.nuser_geom),
            ("nuser_site", sizes.nuser_site),
            ("nuser_cam", sizes.nuser_cam),
            ("nuser_tendon", sizes.nuser_tendon),
            ("nuser_actuator", sizes.nuser_actuator),
            ("nuser_sensor", sizes.nuser_sensor),
        ];
        if let Some((attribute, count)) = counts.into_iter().find(|(_, count)| count.is_some_and(|count| count < -1)) {
            let (at, text) = (node.at_attribute(attribute), count.unwrap_or_default().to_string());
            return Err(MjcfError::OutOfRange { at, attribute, text, expected: "-1 or more" });
        }
        if let Some(memory) = sizes.memory.as_deref().filter(|memory| !is_memory(memory)) {
            let (at, text) = (node.at_attribute("memory"), memory.to_owned());
            let expected = "-1, or a whole number with K, M, G, T, P, E or nothing after it";
            return Err(MjcfError::OutOfRange { at, attribute: "memory", text, expected });
        }
        self.childless(node)
    }

    pub(crate) fn statistic(&mut self, node: &Node) -> Result<(), MjcfError> {
        fill(node, Scope::Element, &mut [&mut self.out.statistic], &[])?;
        if let Some(extent) = self.out.statistic.extent.filter(|extent| *extent <= 0.0) {
            let (at, text) = (node.at_attribute("extent"), extent.to_string());
            return Err(MjcfError::OutOfRange { at, attribute: "extent", text, expected: "above 0" });
        }
        self.childless(node)
    }
}

fn is_memory(text: &str) -> bool {
    let text = text.trim();
    let number = text.strip_suffix(|c: char| "KMGTPE".contains(c.to_ascii_uppercase())).unwrap_or(text);
    text == "-1" || (!number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}
