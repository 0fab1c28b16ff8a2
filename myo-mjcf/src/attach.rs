//! `<attach>`: another model, or a part of it, with a prefix before its names.

use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::limits::too_much;
use crate::mjcf::{Mjcf, Refused};
use crate::names::{Named, Refers, all_names, visit_all_names, visit_all_references};
use crate::nearest::nearest;
use crate::place::Kind;
use crate::read::{Reader, Wanted};
use crate::table::{Scope, exclusive, fill};
use crate::tree::{Branch, Within};
use crate::value::Auto;
use std::collections::HashSet;

impl Reader<'_> {
    #[inline(never)]
    pub(crate) fn attach(&mut self, branch: &mut Branch, node: &Node, within: &Within) -> Result<(), MjcfError> {
        let mut attach = Attach::default();
        fill(node, Scope::Element, &mut [&mut attach], &[])?;
        exclusive(node, &["body", "frame"])?;
        self.budget.book(1, 0, || node.spot())?;
        self.childless(node)?;
        let Some(name) = &attach.model else {
            self.refuse(node, "parts of the model itself are not attached; put them into a file and attach that");
            return Ok(());
        };
        let child = self.attached(node, &attach, name, within.depth)?;
        self.add(branch, node, within, child, &attach.prefix)
    }

    /// Reads the model to attach, or the part that is wanted.
    fn attached(&mut self, node: &Node, attach: &Attach, name: &str, depth: usize) -> Result<Mjcf, MjcfError> {
        let unknown = |attribute, kind, name: &str, names: &[&str]| {
            let (at, nearest) = (node.at_attribute(attribute), nearest(name, names));
            MjcfError::UnknownName { at, attribute, kind, name: name.to_owned(), nearest }
        };
        let Some(document) = self.models.get(name).cloned() else {
            let mut names: Vec<_> = self.models.keys().map(String::as_str).collect();
            names.sort_unstable();
            return Err(unknown("model", Kind::Model, name, &names));
        };
        let limit = self.budget.limits.depth;
        if depth + document.deepest > limit {
            return Err(too_much(node.spot(), "elements within each other", limit as u64));
        }
        self.budget.visit(document.nodes.len(), || node.spot())?;
        let (wanted, tag, part) = match (&attach.body, &attach.frame) {
            (Some(body), _) => (Wanted::Body(body), "body", body.as_str()),
            (_, Some(frame)) => (Wanted::Frame(frame), "frame", frame.as_str()),
            _ => (Wanted::All, "", name),
        };
        if !tag.is_empty() {
            let names = document.nodes.iter().filter(|node| &*node.tag == tag).filter_map(|node| node.get("name"));
            let names: Vec<_> = names.collect();
            if !names.contains(&part) {
                let (attribute, kind) = if tag == "body" { ("body", Kind::Body) } else { ("frame", Kind::Frame) };
                return Err(unknown(attribute, kind, part, &names));
            }
        }
        let attaching = self.attaching.clone();
        let mut child = Reader::new(self.files, &document, self.budget, depth, attaching).read(wanted)?;
        if !tag.is_empty() {
            keep_resolved(&mut child);
        }
        Ok(child)
    }

    /// Puts a model that is read on a body of this one.
    fn add(
        &mut self,
        branch: &mut Branch,
        node: &Node,
        within: &Within,
        mut child: Mjcf,
        prefix: &str,
    ) -> Result<(), MjcfError> {
        settle_limits(&mut child);
        self.tell_differences(node, &child);
        let world = &mut child.bodies[0];
        world.name = None;
        let mut rename = |_, name: &mut String| name.insert_str(0, prefix);
        visit_all_names(&mut child, &mut rename);
        visit_all_references(&mut child, &mut rename);
        let part = Branch { bodies: std::mem::take(&mut child.bodies), frames: Vec::new() };
        let (elements, _) = part.size();
        self.budget.book(0, prefix.len() as u64 * elements as u64, || node.spot())?;
        branch.graft(part, within.host, &within.frame, node)?;
        self.arrivals.push((self.replicas.len(), self.lengths()));
        let out = &mut self.out;
        out.meshes.append(&mut child.meshes);
        out.height_fields.append(&mut child.height_fields);
        out.textures.append(&mut child.textures);
        out.materials.append(&mut child.materials);
        out.pairs.append(&mut child.pairs);
        out.excludes.append(&mut child.excludes);
        out.tendons.append(&mut child.tendons);
        out.equalities.append(&mut child.equalities);
        out.actuators.append(&mut child.actuators);
        out.sensors.append(&mut child.sensors);
        out.numerics.append(&mut child.numerics);
        out.texts.append(&mut child.texts);
        out.tuples.append(&mut child.tuples);
        out.refused.append(&mut child.refused);
        Ok(())
    }

    /// What an attached model says about the whole model does not hold; where that matters it is told.
    fn tell_differences(&mut self, node: &Node, child: &Mjcf) {
        let mut tell = |element: &str, why: &str| {
            let (element, place) = (element.to_owned(), node.place.clone());
            self.out.refused.push(Refused { element, place, why: why.to_owned() });
        };
        let (own, other) = (&self.out.compiler, &child.compiler);
        let same = own.boundmass() == other.boundmass()
            && own.boundinertia() == other.boundinertia()
            && own.settotalmass() == other.settotalmass()
            && own.balanceinertia() == other.balanceinertia()
            && own.fitaabb() == other.fitaabb()
            && own.discardvisual() == other.discardvisual()
            && own.fusestatic() == other.fusestatic()
            && own.inertiafromgeom() == other.inertiafromgeom()
            && own.inertiagrouprange() == other.inertiagrouprange()
            && own.alignfree() == other.alignfree();
        if !same {
            tell(
                "compiler",
                "mass and fusing are those of the main file, not of the attached model; make both say the same",
            );
        }
        let (option, flags) = (child.option.said(), child.flags.said());
        if (!option.is_empty() && option != self.out.option.said())
            || (!flags.is_empty() && flags != self.out.flags.said())
        {
            tell("option", "options are those of the main file, not of the attached model; make both say the same");
        }
        if !child.keys.is_empty() {
            tell("keyframe", "stored states of an attached model are not read; write them into the main file");
        }
    }
}

/// Makes limits explicit, since the compiler of the main file may decide otherwise.
fn settle_limits(model: &mut Mjcf) {
    let auto = model.compiler.autolimits();
    let settle = |flag: &mut Option<Auto>, range: Option<[f64; 2]>| {
        let decided = flag.unwrap_or(Auto::Auto).decide(auto, range);
        *flag = Some(if decided { Auto::Yes } else { Auto::No });
    };
    for joint in model.bodies.iter_mut().flat_map(|body| &mut body.joints) {
        settle(&mut joint.limited, joint.range);
        settle(&mut joint.actuatorfrclimited, joint.actuatorfrcrange);
    }
    for tendon in &mut model.tendons {
        settle(&mut tendon.limited, tendon.range);
        settle(&mut tendon.actuatorfrclimited, tendon.actuatorfrcrange);
    }
    for actuator in &mut model.actuators {
        settle(&mut actuator.forcelimited, actuator.forcerange);
        settle(&mut actuator.actlimited, actuator.actrange);
        // A range that MuJoCo takes over from the target limits as one that is written.
        let inherits = actuator.inheritrange() > 0.0;
        settle(&mut actuator.ctrllimited, actuator.ctrlrange.or(inherits.then_some([1.0, 1.0])));
    }
}

/// Drops what refers to something that is not there, as MuJoCo does when a part of a model is attached.
fn keep_resolved(model: &mut Mjcf) {
    let mut names = all_names(model);
    // The world of the attached model is none of its parts.
    names.remove(&(Kind::Body, "world".to_owned()));
    // What is dropped takes its name with it.
    for kind in [Kind::Tendon, Kind::Actuator, Kind::Sensor, Kind::Pair, Kind::Exclude, Kind::Equality, Kind::Tuple] {
        names.retain(|(other, _)| *other != kind);
    }
    retain(&mut model.pairs, &mut names);
    retain(&mut model.excludes, &mut names);
    retain(&mut model.tendons, &mut names);
    retain(&mut model.equalities, &mut names);
    retain(&mut model.actuators, &mut names);
    retain(&mut model.sensors, &mut names);
    retain(&mut model.tuples, &mut names);
}

fn retain<T: Named + Refers>(elements: &mut Vec<T>, names: &mut HashSet<(Kind, String)>) {
    elements.retain_mut(|element| {
        let mut resolved = true;
        element.refer(&mut |kind, name| resolved &= names.contains(&(kind, name.clone())));
        if resolved {
            names.extend(element.name().map(|name| (T::KIND, name.to_owned())));
        }
        resolved
    });
}
