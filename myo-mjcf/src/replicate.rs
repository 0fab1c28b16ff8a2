//! `<replicate>`: copies of what stands in it, and of what refers to that.

use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::limits::too_much;
use crate::names::{Named, Refers, rename_branch, visit_names};
use crate::place::{Kind, Spot};
use crate::pose::{Frame, euler_rotation};
use crate::read::{Reader, Replica};
use crate::table::{Scope, fill};
use crate::tree::{Branch, Within};
use nalgebra::Vector3;
use std::collections::{BTreeMap, HashSet};

impl Reader<'_> {
    #[inline(never)]
    pub(crate) fn replicate(&mut self, branch: &mut Branch, node: &Node, within: &Within) -> Result<(), MjcfError> {
        let mut replicate = Replicate::default();
        fill(node, Scope::Element, &mut [&mut replicate], &[])?;
        self.budget.book(1, 0, || node.spot())?;
        // As in MuJoCo, less than nothing is nothing.
        let count = usize::try_from(replicate.count).unwrap_or(0);
        if count > self.budget.limits.copies {
            return Err(too_much(node.spot(), "copies of one <replicate>", self.budget.limits.copies as u64));
        }
        let class = self.classes.of(node, "childclass")?.unwrap_or_else(|| within.class.clone());
        let mut part = Branch::new();
        let inside = Within { host: 0, frame: Frame::identity(), class, depth: within.depth + 1, ..*within };
        self.children(&mut part, node, &inside)?;
        if part.is_empty() {
            return Ok(());
        }
        let replica =
            Replica { count, separator: replicate.sep.clone().unwrap_or_default(), place: node.place.clone() };
        let names = self.remember(&mut part, replica);
        self.copy(branch, node, within, &part, &names, &replicate)
    }

    /// Notes that these names will be gone, so that what refers to them can follow.
    fn remember(&mut self, part: &mut Branch, replica: Replica) -> HashSet<(Kind, String)> {
        let mut names = HashSet::new();
        visit_names(part, &mut |kind, name| names.extend([(kind, name.clone())]));
        let index = self.replicas.len();
        self.replicas.push(replica);
        for name in &names {
            self.copied.entry(name.clone()).or_insert(index);
        }
        names
    }

    fn copy(
        &mut self,
        branch: &mut Branch,
        node: &Node,
        within: &Within,
        part: &Branch,
        names: &HashSet<(Kind, String)>,
        replicate: &Replicate,
    ) -> Result<(), MjcfError> {
        let compiler = self.out.compiler.clone();
        let angles = replicate.euler.unwrap_or_default();
        let offset = Vector3::from(replicate.offset.unwrap_or_default());
        let (elements, bytes) = part.size();
        let count = usize::try_from(replicate.count).unwrap_or(0);
        let separator = replicate.sep.as_deref().unwrap_or_default();
        let mut frame = Frame::identity();
        for index in 0..count {
            let suffix = suffix(separator, index, count);
            let named = suffix.len() as u64 * elements as u64;
            self.budget.book(elements, bytes.saturating_add(named), || node.spot())?;
            // The angle is multiplied, not added up, so that it stays exact.
            frame.rotation = euler_rotation(angles.map(|angle| angle * index as f64), &compiler);
            let mut copy = part.clone();
            rename_branch(&mut copy, &mut |kind, name| {
                if names.contains(&(kind, name.clone())) {
                    name.push_str(&suffix);
                }
            });
            branch.graft(copy, within.host, &within.frame.times(&frame), node)?;
            frame.pos += frame.rotation * offset;
        }
        Ok(())
    }

    /// Replaces what refers to copied things by as many copies.
    pub(crate) fn follow_copies(&mut self) -> Result<(), MjcfError> {
        if self.copied.is_empty() {
            return Ok(());
        }
        let present = crate::names::all_names(&mut self.out);
        let pairs = std::mem::take(&mut self.out.pairs);
        self.out.pairs = self.follow(pairs, 0, &present)?;
        let excludes = std::mem::take(&mut self.out.excludes);
        self.out.excludes = self.follow(excludes, 1, &present)?;
        let tendons = std::mem::take(&mut self.out.tendons);
        self.out.tendons = self.follow(tendons, 2, &present)?;
        // Actuators, constraints and sensors may refer to tendons that have become copies just now.
        let present = crate::names::all_names(&mut self.out);
        let equalities = std::mem::take(&mut self.out.equalities);
        self.out.equalities = self.follow(equalities, 3, &present)?;
        let actuators = std::mem::take(&mut self.out.actuators);
        self.out.actuators = self.follow(actuators, 4, &present)?;
        let present = crate::names::all_names(&mut self.out);
        let sensors = std::mem::take(&mut self.out.sensors);
        self.out.sensors = self.follow(sensors, 5, &present)?;
        let tuples = std::mem::take(&mut self.out.tuples);
        self.out.tuples = self.follow(tuples, 6, &present)?;
        Ok(())
    }

    /// In MuJoCo's order: by the moment when a model is attached or a replica made, and of each replica copy by copy.
    fn follow<T: Refers + Named + Clone>(
        &mut self,
        elements: Vec<T>,
        list: usize,
        present: &HashSet<(Kind, String)>,
    ) -> Result<Vec<T>, MjcfError> {
        let mut done: Vec<(usize, T)> = Vec::new();
        let mut waiting: BTreeMap<usize, Vec<T>> = BTreeMap::new();
        let mut arrivals = self.arrivals.iter().map(|(replicas, lengths)| (lengths[list], 2 * replicas)).peekable();
        let mut moment = 0;
        for (index, mut element) in elements.into_iter().enumerate() {
            while let Some((_, later)) = arrivals.next_if(|(first, _)| *first <= index) {
                moment = later;
            }
            match self.replica_of(&mut element, present)? {
                Some(replica) => waiting.entry(replica).or_default().push(element),
                None => done.push((moment, element)),
            }
        }
        drop(arrivals);
        while let Some((index, elements)) = waiting.pop_first() {
            // What refers to them by name is to follow them.
            for name in elements.iter().filter_map(Named::name) {
                self.copied.entry((T::KIND, name.to_owned())).or_insert(index);
            }
            for mut copy in self.copies(&elements, index)? {
                match self.replica_of(&mut copy, present)? {
                    Some(later) if later > index => waiting.entry(later).or_default().push(copy),
                    _ => done.push((2 * index + 1, copy)),
                }
            }
        }
        done.sort_by_key(|(moment, _)| *moment);
        Ok(done.into_iter().map(|(_, element)| element).collect())
    }

    /// As many copies of these elements as a replica has, each referring to its own copy of what it refers to.
    fn copies<T: Refers + Named + Clone>(&mut self, elements: &[T], replica: usize) -> Result<Vec<T>, MjcfError> {
        let Replica { count, separator, .. } = &self.replicas[replica];
        let mut copies = Vec::new();
        for number in 0..*count {
            let suffix = suffix(separator, number, *count);
            for element in elements {
                let mut copy = element.clone();
                self.budget.book(1, (copy.held() + suffix.len()) as u64, || element.spot())?;
                copy.append_to_name(&suffix);
                copy.refer(&mut |_, name| name.push_str(&suffix));
                copies.push(copy);
            }
        }
        Ok(copies)
    }

    /// The replica that copied all that an element refers to, if one did.
    fn replica_of<T: Refers + Named>(
        &self,
        element: &mut T,
        present: &HashSet<(Kind, String)>,
    ) -> Result<Option<usize>, MjcfError> {
        let (mut replicas, mut gone) = (Vec::new(), None);
        element.refer(&mut |kind, name| {
            let key = (kind, name.clone());
            // A name that something still has is that thing's.
            let replica = if present.contains(&key) { None } else { self.copied.get(&key).copied() };
            if replica.is_some() && gone.is_none() {
                gone = Some(key);
            }
            replicas.push(replica);
        });
        let Some((kind, name)) = gone else { return Ok(None) };
        let first = replicas.iter().flatten().next().copied();
        if replicas.iter().any(|replica| *replica != first) {
            let replicate = first.map(|index| self.replicas[index].place.clone()).unwrap_or_default();
            return Err(MjcfError::PartlyCopied { at: Box::new(element.spot()), kind, name, replicate });
        }
        Ok(first)
    }
}

/// What is appended to names: numbers of equal length, so that names sort.
fn suffix(separator: &str, index: usize, count: usize) -> String {
    let digits = count.to_string().len();
    format!("{separator}{index:0digits$}")
}

impl Branch {
    pub fn is_empty(&self) -> bool {
        let host = &self.bodies[0];
        let things = host.joints.len() + host.geoms.len() + host.sites.len() + host.cameras.len() + host.lights.len();
        self.bodies.len() == 1 && things == 0 && host.inertial.is_none() && self.frames.is_empty()
    }

    /// Number of elements, and bytes that they hold beyond their own size.
    pub fn size(&self) -> (usize, u64) {
        use crate::table::Table;
        let mut elements = self.bodies.len() + self.frames.len();
        let mut bytes = self.frames.iter().map(|(name, _)| name.len()).sum::<usize>();
        for body in &self.bodies {
            elements +=
                body.joints.len() + body.geoms.len() + body.sites.len() + body.cameras.len() + body.lights.len();
            bytes += body.held();
            bytes += body.joints.iter().map(Table::held).sum::<usize>();
            bytes += body.geoms.iter().map(Table::held).sum::<usize>();
            bytes += body.sites.iter().map(Table::held).sum::<usize>();
            bytes += body.cameras.iter().map(Table::held).sum::<usize>();
            bytes += body.lights.iter().map(Table::held).sum::<usize>();
        }
        (elements, bytes as u64)
    }

    /// Puts another branch on a body, in a frame of that.
    pub fn graft(&mut self, mut branch: Self, host: usize, frame: &Frame, at: &Node) -> Result<(), MjcfError> {
        let first = self.bodies.len();
        self.frames.append(&mut branch.frames);
        let mut bodies = branch.bodies.into_iter();
        let Some(mut loose) = bodies.next() else { return Ok(()) };
        loose.joints.iter_mut().for_each(|joint| joint.enter(frame));
        loose.geoms.iter_mut().for_each(|geom| geom.pose.enter(frame));
        loose.sites.iter_mut().for_each(|site| site.pose.enter(frame));
        loose.cameras.iter_mut().for_each(|camera| camera.pose.enter(frame));
        loose.lights.iter_mut().for_each(|light| light.enter(frame));
        let body = &mut self.bodies[host];
        if let Some(mut inertial) = loose.inertial {
            if let Some(other) = &body.inertial {
                return Err(MjcfError::Repeated { at: at.at(), first: other.place.clone() });
            }
            inertial.enter(frame);
            body.inertial = Some(inertial);
        }
        body.joints.append(&mut loose.joints);
        body.geoms.append(&mut loose.geoms);
        body.sites.append(&mut loose.sites);
        body.cameras.append(&mut loose.cameras);
        body.lights.append(&mut loose.lights);
        for mut body in bodies {
            if body.parent == 0 {
                body.pose.enter(frame);
                body.parent = host;
            } else {
                body.parent += first - 1;
            }
            self.bodies.push(body);
        }
        Ok(())
    }
}

/// What an error shows of an element that is read already.
pub(crate) fn spot_of(place: &crate::Place, tag: &str, name: Option<&str>) -> Spot {
    Spot { place: place.clone(), tag: tag.to_owned(), name: name.map(str::to_owned) }
}
