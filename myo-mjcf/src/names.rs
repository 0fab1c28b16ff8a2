//! Names of elements and names in elements: what copies and attached models change.

use crate::elements::*;
use crate::mjcf::Mjcf;
use crate::place::{Kind, Spot};
use crate::replicate::spot_of;
use crate::table::Table;
use crate::tree::Branch;
use std::collections::HashSet;

/// An element that has a name.
pub(crate) trait Named {
    const KIND: Kind;

    fn name(&self) -> Option<&str>;

    /// Its name, if it has one.
    fn name_mut(&mut self) -> Option<&mut String>;

    fn spot(&self) -> Spot;

    fn append_to_name(&mut self, suffix: &str) {
        if let Some(name) = self.name_mut() {
            name.push_str(suffix);
        }
    }
}

macro_rules! named {
    ($($Type:ident = $kind:ident $tag:literal),* $(,)?) => { $(
        impl Named for $Type {
            const KIND: Kind = Kind::$kind;

            fn name(&self) -> Option<&str> {
                self.name.as_deref()
            }

            fn name_mut(&mut self) -> Option<&mut String> {
                self.name.as_mut()
            }

            fn spot(&self) -> Spot {
                spot_of(&self.place, $tag, self.name.as_deref())
            }
        }
    )* };
}
named! {
    Body = Body "body", Joint = Joint "joint", Geom = Geom "geom", Site = Site "site", Camera = Camera "camera",
    Light = Light "light", Mesh = Mesh "mesh", HeightField = HeightField "hfield", Texture = Texture "texture",
    Material = Material "material", Pair = Pair "pair", Exclude = Exclude "exclude", Equality = Equality "equality",
    Tendon = Tendon "tendon", Actuator = Actuator "actuator", Sensor = Sensor "sensor", Key = Key "key",
}

/// Elements whose name must be there.
macro_rules! always_named {
    ($($Type:ident = $kind:ident $tag:literal),* $(,)?) => { $(
        impl Named for $Type {
            const KIND: Kind = Kind::$kind;

            fn name(&self) -> Option<&str> {
                Some(&self.name)
            }

            fn name_mut(&mut self) -> Option<&mut String> {
                Some(&mut self.name)
            }

            fn spot(&self) -> Spot {
                spot_of(&self.place, $tag, Some(&self.name))
            }
        }
    )* };
}
always_named! { Numeric = Numeric "numeric", Text = Text "text", Tuple = Tuple "tuple" }

/// An element that refers to others.
pub(crate) trait Refers {
    /// Visits the names of others.
    fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String));

    /// Bytes that it holds beyond its own size.
    fn held(&self) -> usize;
}

macro_rules! refers_by_table {
    ($($Type:ident),*) => { $(
        impl Refers for $Type {
            fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String)) {
                self.references(visit);
            }

            fn held(&self) -> usize {
                Table::held(self)
            }
        }
    )* };
}
refers_by_table!(Geom, Site, Camera, Light, Mesh, Pair, Exclude, Actuator);

impl Refers for Material {
    fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String)) {
        self.references(visit);
        self.layers.iter_mut().for_each(|layer| layer.references(visit));
    }

    fn held(&self) -> usize {
        Table::held(self) + self.layers.iter().map(Table::held).sum::<usize>()
    }
}

impl Refers for Equality {
    fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String)) {
        match &mut self.constraint {
            Constraint::Connect(connect) => connect.references(visit),
            Constraint::Weld(weld) => weld.references(visit),
            Constraint::Joint(joint) => joint.references(visit),
            Constraint::Tendon(tendon) => tendon.references(visit),
        }
    }

    fn held(&self) -> usize {
        let own = match &self.constraint {
            Constraint::Connect(connect) => connect.held(),
            Constraint::Weld(weld) => weld.held(),
            Constraint::Joint(joint) => joint.held(),
            Constraint::Tendon(tendon) => tendon.held(),
        };
        Table::held(self) + own
    }
}

impl Refers for Tendon {
    fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String)) {
        self.references(visit);
        match &mut self.path {
            TendonPath::Spatial(points) => points.iter_mut().for_each(|point| match point {
                PathPoint::Site(site) => site.references(visit),
                PathPoint::Geom(geom) => geom.references(visit),
                PathPoint::Pulley(_) => {}
            }),
            TendonPath::Fixed(terms) => terms.iter_mut().for_each(|term| term.references(visit)),
        }
    }

    fn held(&self) -> usize {
        let path = match &self.path {
            TendonPath::Spatial(points) => points.iter().map(|point| match point {
                PathPoint::Site(site) => site.held(),
                PathPoint::Geom(geom) => geom.held(),
                PathPoint::Pulley(_) => 0,
            }),
            TendonPath::Fixed(terms) => return Table::held(self) + terms.iter().map(held_by_term).sum::<usize>(),
        };
        Table::held(self) + path.map(|held| held + size_of::<PathPoint>()).sum::<usize>()
    }
}

fn held_by_term(term: &JointTerm) -> usize {
    term.held() + size_of::<JointTerm>()
}

impl Refers for Sensor {
    fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String)) {
        self.references(visit);
        visit_object(self.objtype.as_deref(), self.objname.as_mut(), visit);
        visit_object(self.reftype.as_deref(), self.refname.as_mut(), visit);
    }

    fn held(&self) -> usize {
        Table::held(self)
    }
}

impl Refers for Tuple {
    fn refer(&mut self, visit: &mut dyn FnMut(Kind, &mut String)) {
        for element in &mut self.elements {
            visit_object(Some(&element.objtype), Some(&mut element.objname), visit);
        }
    }

    fn held(&self) -> usize {
        let elements = self.elements.iter().map(|element| element.held() + size_of::<TupleElement>());
        Table::held(self) + elements.sum::<usize>()
    }
}

fn visit_object(kind: Option<&str>, name: Option<&mut String>, visit: &mut dyn FnMut(Kind, &mut String)) {
    if let (Some(kind), Some(name)) = (kind.and_then(object_kind), name) {
        visit(kind, name);
    }
}

/// Visits the names of the elements of a branch.
pub(crate) fn visit_names(branch: &mut Branch, visit: &mut dyn FnMut(Kind, &mut String)) {
    branch.frames.iter_mut().for_each(|(name, _)| visit(Kind::Frame, name));
    branch.bodies.iter_mut().for_each(|body| visit_body_names(body, visit));
}

fn visit_body_names(body: &mut Body, visit: &mut dyn FnMut(Kind, &mut String)) {
    visit_list(std::slice::from_mut(body), visit);
    visit_list(&mut body.joints, visit);
    visit_list(&mut body.geoms, visit);
    visit_list(&mut body.sites, visit);
    visit_list(&mut body.cameras, visit);
    visit_list(&mut body.lights, visit);
}

fn visit_list<T: Named>(elements: &mut [T], visit: &mut dyn FnMut(Kind, &mut String)) {
    for element in elements {
        if let Some(name) = element.name_mut() {
            visit(T::KIND, name);
        }
    }
}

/// Visits names of the elements of a branch, and names of others in them.
pub(crate) fn rename_branch(branch: &mut Branch, visit: &mut dyn FnMut(Kind, &mut String)) {
    visit_names(branch, visit);
    branch.bodies.iter_mut().for_each(|body| visit_body_references(body, visit));
}

fn visit_body_references(body: &mut Body, visit: &mut dyn FnMut(Kind, &mut String)) {
    body.geoms.iter_mut().for_each(|geom| geom.refer(visit));
    body.sites.iter_mut().for_each(|site| site.refer(visit));
    body.cameras.iter_mut().for_each(|camera| camera.refer(visit));
    body.lights.iter_mut().for_each(|light| light.refer(visit));
}

/// Visits the names of all elements of a model.
pub(crate) fn visit_all_names(model: &mut Mjcf, visit: &mut dyn FnMut(Kind, &mut String)) {
    model.bodies.iter_mut().for_each(|body| visit_body_names(body, visit));
    visit_list(&mut model.meshes, visit);
    visit_list(&mut model.height_fields, visit);
    visit_list(&mut model.textures, visit);
    visit_list(&mut model.materials, visit);
    visit_list(&mut model.pairs, visit);
    visit_list(&mut model.excludes, visit);
    visit_list(&mut model.equalities, visit);
    visit_list(&mut model.tendons, visit);
    visit_list(&mut model.actuators, visit);
    visit_list(&mut model.sensors, visit);
    visit_list(&mut model.keys, visit);
    visit_list(&mut model.numerics, visit);
    visit_list(&mut model.texts, visit);
    visit_list(&mut model.tuples, visit);
}

/// Visits all names of others in the elements of a model.
pub(crate) fn visit_all_references(model: &mut Mjcf, visit: &mut dyn FnMut(Kind, &mut String)) {
    model.bodies.iter_mut().for_each(|body| visit_body_references(body, visit));
    model.meshes.iter_mut().for_each(|mesh| mesh.refer(visit));
    model.materials.iter_mut().for_each(|material| material.refer(visit));
    model.pairs.iter_mut().for_each(|pair| pair.refer(visit));
    model.excludes.iter_mut().for_each(|exclude| exclude.refer(visit));
    model.equalities.iter_mut().for_each(|equality| equality.refer(visit));
    model.tendons.iter_mut().for_each(|tendon| tendon.refer(visit));
    model.actuators.iter_mut().for_each(|actuator| actuator.refer(visit));
    model.sensors.iter_mut().for_each(|sensor| sensor.refer(visit));
    model.tuples.iter_mut().for_each(|tuple| tuple.refer(visit));
}

/// The names of all elements of a model.
pub(crate) fn all_names(model: &mut Mjcf) -> HashSet<(Kind, String)> {
    let mut names = HashSet::new();
    visit_all_names(model, &mut |kind, name| names.extend([(kind, name.clone())]));
    names
}
