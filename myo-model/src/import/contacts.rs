//! Which parts of a body may touch each other.

use super::Import;
use myo_mjcf::{Geom, Switch};

impl<'a> Import<'a> {
    /// Refuses the first two geoms that may touch each other, and says how many pairs there are.
    pub(super) fn contacts(&mut self) {
        if !self.keeps(self.mjcf.flags.contact()) {
            return;
        }
        let (count, first) = self.touching();
        let Some((one, other)) = first else { return };
        let name = |geom: &Geom| {
            geom.name.as_ref().map_or_else(|| format!("the geom at {}", geom.place), |name| format!("`{name}`"))
        };
        let others = if count > 1 { format!(", nor are {} more pairs like this", count - 1) } else { String::new() };
        let what = format!(
            "it may touch {}, which is not simulated{others}; let parts pass through each other (`--without-contacts`, or `<option><flag contact=\"disable\"/></option>`)",
            name(other)
        );
        self.refuse(&one.place, ("geom", one.name.as_ref()), what);
    }

    /// How many pairs of geoms may touch, and the first of them.
    fn touching(&self) -> (usize, Option<(&'a Geom, &'a Geom)>) {
        let welded = Welded::of(self);
        let geoms: Vec<(usize, &'a Geom)> = self.mjcf.geoms().collect();
        let mut found = (0, None);
        for (number, &(body, one)) in geoms.iter().enumerate() {
            for &(other_body, other) in &geoms[..number] {
                if self.may_touch(&welded, (body, one), (other_body, other)) {
                    found = (found.0 + 1, found.1.or(Some((other, one))));
                }
            }
        }
        found
    }

    fn may_touch(&self, welded: &Welded, (body, one): (usize, &Geom), (other_body, other): (usize, &Geom)) -> bool {
        let [a, b] = [welded.with[body], welded.with[other_body]];
        let is = |name: &str, geom: &Geom| geom.name.as_deref() == Some(name);
        let asked = self.mjcf.pairs.iter().any(|pair| {
            is(&pair.geom1, one) && is(&pair.geom2, other) || is(&pair.geom1, other) && is(&pair.geom2, one)
        });
        // What stands still does not touch what stands still, nor a body itself.
        if a == b {
            return false;
        }
        let [first, second] = [body, other_body].map(|body| &self.names.bodies[body]);
        let ruled_out = self.mjcf.excludes.iter().any(|exclude| {
            (&exclude.body1, &exclude.body2) == (first, second) || (&exclude.body1, &exclude.body2) == (second, first)
        });
        let is_parent = self.mjcf.flags.filterparent() == Switch::On
            && a != 0
            && b != 0
            && (welded.parent(self, a) == b || welded.parent(self, b) == a);
        let by_bits = one.contype() & other.conaffinity() != 0 || other.contype() & one.conaffinity() != 0;
        asked || by_bits && !ruled_out && !is_parent
    }
}

/// Bodies that move as one.
struct Welded {
    /// Of each body the topmost one that it moves with.
    with: Vec<usize>,
}

impl Welded {
    fn of(import: &Import<'_>) -> Self {
        let mut with = vec![0; import.mjcf.bodies.len()];
        for (number, body) in import.mjcf.bodies.iter().enumerate() {
            with[number] = if body.joints.is_empty() { with[body.parent] } else { number };
        }
        Self { with }
    }

    fn parent(&self, import: &Import<'_>, body: usize) -> usize {
        self.with[import.mjcf.bodies[body].parent]
    }
}
