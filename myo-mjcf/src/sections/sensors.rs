//! Sensors.

use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::read::{Reader, check_object_type};
use crate::table::{Scope, Table, exclusive, need};
use crate::value::Fault;

/// Objects that have a place in space.
const FRAMES: [&str; 5] = ["body", "xbody", "geom", "site", "camera"];

impl Reader<'_> {
    pub(crate) fn sensor(&mut self, node: &Node) -> Result<(), MjcfError> {
        if &*node.tag == "plugin" {
            self.refuse(node, "plugins are not read; leave them out");
            return Ok(());
        }
        let Some(kind) = SENSOR_KINDS.iter().find(|kind| kind.tag == &*node.tag) else {
            let tags: Vec<_> = SENSOR_KINDS.iter().map(|kind| kind.tag).collect();
            return Err(node.unknown("sensor", &tags));
        };
        let all = Sensor::default().attributes(Scope::Element);
        let except: Vec<_> = all.into_iter().filter(|name| !kind.takes(name)).collect();
        let mut sensor = self.element(node, Sensor { kind: kind.tag, ..Sensor::default() }, &except)?;
        need(node, kind.required)?;
        check_objects(node, kind)?;
        sensor.kind = kind.tag;
        self.out.sensors.push(sensor);
        self.childless(node)
    }
}

fn check_objects(node: &Node, kind: &SensorKind) -> Result<(), MjcfError> {
    for attribute in ["objtype", "reftype"] {
        match node.get(attribute) {
            None => {}
            Some(word) if kind.tag == "user" => check_object_type(node, attribute, word)?,
            Some(word) if FRAMES.contains(&word) => {}
            Some(word) => return Err(Fault::keyword(word, &FRAMES).of(node, attribute)),
        }
    }
    together(node, "objtype", "objname")?;
    together(node, "reftype", "refname")?;
    match kind.tag {
        "rangefinder" => one_of(node, &["site", "camera"]),
        "distance" | "normal" | "fromto" => {
            one_of(node, &["geom1", "body1"])?;
            one_of(node, &["geom2", "body2"])
        }
        "contact" => {
            exclusive(node, &["geom1", "body1", "subtree1", "site"])?;
            exclusive(node, &["geom2", "body2", "subtree2"])
        }
        _ => Ok(()),
    }
}

fn together(node: &Node, first: &'static str, second: &'static str) -> Result<(), MjcfError> {
    match (node.get(first), node.get(second)) {
        (Some(_), None) => need(node, &[second]),
        (None, Some(_)) => need(node, &[first]),
        _ => Ok(()),
    }
}

fn one_of(node: &Node, attributes: &[&'static str; 2]) -> Result<(), MjcfError> {
    exclusive(node, attributes)?;
    if node.get(attributes[1]).is_some() { Ok(()) } else { need(node, &attributes[..1]) }
}
