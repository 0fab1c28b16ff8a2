//! Equality constraints and tendons.

use crate::document::Node;
use crate::elements::*;
use crate::error::MjcfError;
use crate::read::Reader;
use crate::table::{Scope, Table, exclusive, fill, need};

const EQUALITIES: [&str; 4] = ["connect", "weld", "joint", "tendon"];

impl Reader<'_> {
    pub(crate) fn equality(&mut self, node: &Node) -> Result<(), MjcfError> {
        let class = self.classes.of(node, "class")?.unwrap_or_else(|| self.classes.main());
        let mut equality = (*class.equality).clone();
        equality.constraint = match &*node.tag {
            "connect" => Constraint::Connect(self.over(node, &mut equality)?),
            "weld" => Constraint::Weld(self.over(node, &mut equality)?),
            "joint" => Constraint::Joint(self.over(node, &mut equality)?),
            "tendon" => Constraint::Tendon(self.over(node, &mut equality)?),
            "flex" | "flexvert" | "flexstrain" => {
                self.refuse(node, "flexible bodies are not read; leave their constraints out");
                return Ok(());
            }
            _ => return Err(node.unknown("equality", &EQUALITIES)),
        };
        match equality.constraint {
            Constraint::Connect(_) => check_ends(node, &["body1", "anchor"], &["body1", "body2", "anchor"])?,
            Constraint::Weld(_) => check_ends(node, &["body1"], &["body1", "body2", "anchor", "relpose"])?,
            Constraint::Joint(_) | Constraint::Tendon(_) => {}
        }
        self.out.equalities.push(equality);
        self.childless(node)
    }

    /// Reads what is special to an element beside what is common to its kind.
    fn over<T: Table + Default>(&mut self, node: &Node, common: &mut dyn Table) -> Result<T, MjcfError> {
        let mut special = T::default();
        fill(node, Scope::Element, &mut [&mut *common, &mut special], &[])?;
        self.budget.book(1, (common.held() + special.held()) as u64, || node.spot())?;
        Ok(special)
    }

    pub(crate) fn tendon(&mut self, node: &Node) -> Result<(), MjcfError> {
        // How it looks matters to a path only.
        let except: &[&str] = match &*node.tag {
            "spatial" => &[],
            "fixed" => &["width", "material", "rgba"],
            _ => return Err(node.unknown("tendon", &["spatial", "fixed"])),
        };
        let class = self.classes.of(node, "class")?.unwrap_or_else(|| self.classes.main());
        let mut tendon = self.element(node, (*class.tendon).clone(), except)?;
        tendon.path = match &*node.tag {
            "spatial" => TendonPath::Spatial(self.collect(node, Self::path_point)?),
            _ => TendonPath::Fixed(self.collect(node, Self::joint_term)?),
        };
        self.out.tendons.push(tendon);
        Ok(())
    }

    fn collect<T>(
        &mut self,
        parent: &Node,
        mut read: impl FnMut(&mut Self, &Node) -> Result<T, MjcfError>,
    ) -> Result<Vec<T>, MjcfError> {
        let document = self.document;
        let read_one = |node| {
            self.childless(node)?;
            read(self, node)
        };
        document.children(parent).map(read_one).collect()
    }

    fn path_point(&mut self, node: &Node) -> Result<PathPoint, MjcfError> {
        Ok(match &*node.tag {
            "site" => PathPoint::Site(self.element(node, PathSite::default(), &[])?),
            "geom" => PathPoint::Geom(self.element(node, PathGeom::default(), &[])?),
            "pulley" => PathPoint::Pulley(self.element(node, Pulley::default(), &[])?),
            _ => return Err(node.unknown("spatial", &["site", "geom", "pulley"])),
        })
    }

    fn joint_term(&mut self, node: &Node) -> Result<JointTerm, MjcfError> {
        match &*node.tag {
            "joint" => self.element(node, JointTerm::default(), &[]),
            _ => Err(node.unknown("fixed", &["joint"])),
        }
    }
}

/// Either two sites, or bodies: not both, and enough of one.
fn check_ends(node: &Node, bodies: &[&'static str], of_bodies: &[&'static str]) -> Result<(), MjcfError> {
    let sites = ["site1", "site2"];
    if sites.iter().any(|site| node.get(site).is_some()) {
        need(node, &sites)?;
        return of_bodies.iter().try_for_each(|attribute| exclusive(node, &["site1", attribute]));
    }
    need(node, bodies)
}
