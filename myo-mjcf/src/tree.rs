//! Bodies and what stands in them: frames fold away, classes come down, angles become rad.

use crate::classes::Class;
use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::place::Place;
use crate::pose::{Frame, Pose};
use crate::read::{Reader, Wanted};
use crate::table::{Scope, fill};
use std::rc::Rc;

/// Bodies, the first of which holds what stands in no other: the world, or whatever this is grafted on.
#[derive(Clone, Debug, Default)]
pub(crate) struct Branch {
    pub bodies: Vec<Body>,
    /// Names of frames, which are gone otherwise.
    pub frames: Vec<(String, Place)>,
}

impl Branch {
    pub fn new() -> Self {
        Self { bodies: vec![Body::default()], frames: Vec::new() }
    }
}

/// What holds for the elements within another one.
#[derive(Clone)]
pub(crate) struct Within {
    /// The body they belong to.
    pub host: usize,
    pub frame: Frame,
    pub class: Rc<Class>,
    /// Whether that body is the world, which has no joints and no mass.
    pub in_world: bool,
    pub depth: usize,
}

const IN_BODIES: [&str; 12] = [
    "body",
    "frame",
    "inertial",
    "joint",
    "freejoint",
    "geom",
    "site",
    "camera",
    "light",
    "replicate",
    "attach",
    "include",
];

impl Reader<'_> {
    /// Reads the bodies, or those that are wanted.
    pub(crate) fn tree(&mut self, wanted: Wanted<'_>) -> Result<(), MjcfError> {
        let mut branch = Branch::new();
        branch.bodies[0].name = Some("world".to_owned());
        branch.bodies[0].place = self.document.root().place.clone();
        let class = self.classes.main();
        let depth = self.depth;
        let within = Within { host: 0, frame: Frame::identity(), class, in_world: true, depth };
        let root = self.document.root();
        for section in self.document.children(root).filter(|node| &*node.tag == "worldbody") {
            if !section.attributes.is_empty() {
                return Err(section.misplaced("the world has no attributes; leave them out"));
            }
            match wanted {
                Wanted::All => self.children(&mut branch, section, &within)?,
                Wanted::Body(name) => self.pick(&mut branch, section, ("body", name), &within)?,
                Wanted::Frame(name) => self.pick(&mut branch, section, ("frame", name), &within)?,
            }
        }
        self.out.bodies = branch.bodies;
        crate::check::check_frames(branch.frames)
    }

    /// Reads the one element of this tag and name, with the class that holds there.
    fn pick(
        &mut self,
        branch: &mut Branch,
        parent: &Node,
        (tag, name): (&str, &str),
        within: &Within,
    ) -> Result<(), MjcfError> {
        for node in self.document.children(parent) {
            if &*node.tag == tag && node.get("name") == Some(name) {
                self.child(branch, node, within)?;
            } else if matches!(&*node.tag, "body" | "frame") {
                let class = self.classes.of(node, "childclass")?.unwrap_or_else(|| within.class.clone());
                self.pick(branch, node, (tag, name), &Within { class, ..within.clone() })?;
            }
        }
        Ok(())
    }

    pub(crate) fn children(&mut self, branch: &mut Branch, parent: &Node, within: &Within) -> Result<(), MjcfError> {
        self.document.children(parent).try_for_each(|node| self.child(branch, node, within))
    }

    fn child(&mut self, branch: &mut Branch, node: &Node, within: &Within) -> Result<(), MjcfError> {
        match &*node.tag {
            "body" => self.body(branch, node, within),
            "frame" => self.frame(branch, node, within),
            "replicate" => self.replicate(branch, node, within),
            "attach" => self.attach(branch, node, within),
            "inertial" | "joint" | "freejoint" | "geom" | "site" | "camera" | "light" => {
                self.leaf(&mut branch.bodies[within.host], node, within)?;
                self.childless(node)
            }
            "composite" | "flexcomp" => {
                self.refuse(node, "composites and flexible bodies are not read; write their bodies out");
                Ok(())
            }
            "plugin" => {
                self.refuse(node, "plugins are not read; leave them out");
                Ok(())
            }
            _ => Err(node.unknown("body", &IN_BODIES)),
        }
    }

    #[inline(never)]
    fn body(&mut self, branch: &mut Branch, node: &Node, within: &Within) -> Result<(), MjcfError> {
        let mut body = self.element(node, Body::default(), &[])?;
        body.pose.settle(node, &self.out.compiler)?;
        body.pose.enter(&within.frame);
        body.parent = within.host;
        let class = self.classes.of(node, "childclass")?.unwrap_or_else(|| within.class.clone());
        let host = branch.bodies.len();
        branch.bodies.push(body);
        let depth = within.depth + 1;
        self.children(branch, node, &Within { host, frame: Frame::identity(), class, in_world: false, depth })
    }

    #[inline(never)]
    fn frame(&mut self, branch: &mut Branch, node: &Node, within: &Within) -> Result<(), MjcfError> {
        let mut pose = Pose::default();
        let mut names = FrameNames::default();
        fill(node, Scope::Element, &mut [&mut names, &mut pose], &[])?;
        pose.settle(node, &self.out.compiler)?;
        self.budget.book(1, 0, || node.spot())?;
        branch.frames.extend(names.name.map(|name| (name, node.place.clone())));
        let class = self.classes.of(node, "childclass")?.unwrap_or_else(|| within.class.clone());
        let (frame, depth) = (within.frame.times(&pose.frame()), within.depth + 1);
        self.children(branch, node, &Within { frame, class, depth, ..within.clone() })
    }
}
