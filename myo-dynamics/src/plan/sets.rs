//! Which links share a screw, and the sums that follow from it.
//!
//! With one coordinate per joint this is the composite-rigid-body algorithm (Featherstone 2008, chapter 6). A coordinate
//! that drives several joints has one screw per stretch of links; every pair of screws needs the inertia of the links
//! that move along both.

use super::{Link, LinkSet, MassTerm, Plan, Projection};
use std::collections::{BTreeMap, BTreeSet};

type Set = BTreeSet<usize>;

/// Fills the sets, mass terms and projections of a plan whose links, screws and bodies are final. `used` are the links
/// that carry mass or feel forces.
pub(super) fn connect(plan: &mut Plan<f64>, used: &Set) {
    let movers = links_of_screws(&plan.links, used);
    let massive: Set = plan.bodies.iter().map(|body| body.link).collect();
    let mut wanted: BTreeSet<Set> = BTreeSet::new();
    let mut products: BTreeMap<(Set, usize, usize), Vec<(usize, usize)>> = BTreeMap::new();
    for (&(dof_a, a), links_a) in &movers {
        wanted.insert(links_a.clone());
        for (&(dof_b, b), links_b) in &movers {
            if (dof_b, b) < (dof_a, a) {
                continue;
            }
            let both: Set = links_a.intersection(links_b).copied().collect();
            if both.is_disjoint(&massive) {
                continue;
            }
            wanted.insert(both.clone());
            // Accelerate along the screw whose links are exactly these, so that its product serves all others.
            let ((column, screw), row) =
                if links_b == &both { ((dof_b, b), (a, dof_a)) } else { ((dof_a, a), (b, dof_b)) };
            products.entry((both, screw, column)).or_default().push(row);
        }
    }
    let mut ordered: Vec<Set> = wanted.into_iter().collect();
    ordered.sort_by_key(|set| (set.len(), set.clone()));
    plan.sets = (0..ordered.len()).map(|k| decompose(&ordered, k)).collect();
    let number = |set: &Set| ordered.iter().position(|s| s == set).expect("every wanted set is in the list");
    plan.mass_terms = products
        .into_iter()
        .map(|((set, screw, column), rows)| MassTerm { set: number(&set), screw, column, rows })
        .collect();
    plan.projections =
        movers.iter().map(|(&(dof, screw), links)| Projection { dof, screw, set: number(links) }).collect();
}

/// Links that move along each (coordinate, screw), as far as they are used.
fn links_of_screws(links: &[Link<f64>], used: &Set) -> BTreeMap<(usize, usize), Set> {
    let mut out: BTreeMap<(usize, usize), Set> = BTreeMap::new();
    for (index, link) in links.iter().enumerate().filter(|(index, _)| used.contains(index)) {
        for (dof, screw) in link.screw_of_dof.iter().enumerate() {
            if let Some(screw) = *screw {
                out.entry((dof, screw)).or_default().insert(index);
            }
        }
    }
    out
}

/// Writes a set as a sum of the largest earlier sets that fit and the links that remain.
fn decompose(ordered: &[Set], k: usize) -> LinkSet {
    let mut rest = ordered[k].clone();
    let mut sets = vec![];
    for (j, smaller) in ordered[..k].iter().enumerate().rev() {
        if smaller.len() > 1 && smaller.is_subset(&rest) {
            sets.push(j);
            rest = rest.difference(smaller).copied().collect();
        }
    }
    LinkSet { sets, links: rest.into_iter().collect() }
}
