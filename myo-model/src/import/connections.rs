//! Bodies that equalities hold together: MuJoCo's `connect` and `weld`.

use super::apart::{frame, frames};
use super::{Import, written};
use crate::description::{Connection, Softness, Weld};
use myo_mjcf::{self as source, Constraint, Equality};
use nalgebra::{Isometry3, Point3, Quaternion, UnitQuaternion};

/// What is held, as one of two ends.
struct End {
    /// Index of its body.
    body: usize,
    /// Its place on this.
    place: Isometry3<f64>,
}

impl Import<'_> {
    pub(super) fn connections(&mut self) -> Vec<Connection> {
        let mjcf = self.mjcf;
        if !self.keeps(mjcf.flags.equality()) {
            return vec![];
        }
        // What is not active is not simulated by MuJoCo either.
        mjcf.equalities.iter().filter(|one| one.active()).filter_map(|one| self.connection(one)).collect()
    }

    fn connection(&mut self, equality: &Equality) -> Option<Connection> {
        let (tag, ends, weld) = match &equality.constraint {
            Constraint::Connect(connect) => ("connect", self.connected(connect)?, None),
            Constraint::Weld(weld) => {
                let (ends, weld) = self.welded(weld)?;
                ("weld", ends, Some(weld))
            }
            Constraint::Joint(_) | Constraint::Tendon(_) => return None,
        };
        self.refuse_direct(&equality.place, (tag, equality.name.as_ref()), equality.solref());
        Some(Connection {
            bodies: ends.each_ref().map(|end| self.names.bodies[end.body].clone()),
            anchors: ends.map(|end| end.place.translation.vector.into()),
            weld,
            softness: Softness { solref: equality.solref(), solimp: equality.solimp() },
        })
    }

    /// The ends of a `connect`: two sites, or one anchor, as both bodies have it in the pose of the file.
    fn connected(&self, connect: &source::Connect) -> Option<[End; 2]> {
        if let Some(sites) = self.sites_of(&connect.site1, &connect.site2) {
            return Some(sites);
        }
        let [one, other] = self.bodies_of(&connect.body1, &connect.body2)?;
        let frames = frames(self.mjcf);
        let anchor = Point3::from(connect.anchor());
        let seen = frames[other].inverse() * frames[one] * anchor;
        Some([(one, anchor), (other, seen)].map(|(body, anchor)| End { body, place: anchor.coords.into() }))
    }

    /// The ends of a `weld`: two sites, or what `relpose` and `anchor` say; without `relpose` the pose of the file holds.
    fn welded(&self, weld: &source::Weld) -> Option<([End; 2], Weld)> {
        let torque_scale = weld.torquescale();
        if let Some(ends) = self.sites_of(&weld.site1, &weld.site2) {
            // Of the first site seen from its body, and back from the second to its own.
            let turn = ends[0].place.rotation * ends[1].place.rotation.inverse();
            return Some((ends, Weld { quat: written(&turn), torque_scale }));
        }
        let [one, other] = self.bodies_of(&weld.body1, &weld.body2)?;
        let anchor = Point3::from(weld.anchor());
        let [x, y, z, quat @ ..] = weld.relpose();
        let (at, turn) = if quat == [0.0; 4] {
            let frames = frames(self.mjcf);
            let between = frames[one].inverse() * frames[other];
            (between * anchor, between.rotation)
        } else {
            let [w, i, j, k] = quat;
            (Point3::new(x, y, z), UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)))
        };
        let ends = [(one, at), (other, anchor)].map(|(body, anchor)| End { body, place: anchor.coords.into() });
        Some((ends, Weld { quat: written(&turn), torque_scale }))
    }

    /// Two sites, where they are named; the reader knows that there are both then.
    fn sites_of(&self, one: &Option<String>, other: &Option<String>) -> Option<[End; 2]> {
        let find = |name: &String| {
            let (body, site) = self.mjcf.sites().find(|(_, site)| site.name.as_ref() == Some(name))?;
            Some(End { body, place: frame(&site.pose) })
        };
        Some([find(one.as_ref()?)?, find(other.as_ref()?)?])
    }

    /// Two bodies, the second the world where none is named.
    fn bodies_of(&self, one: &Option<String>, other: &Option<String>) -> Option<[usize; 2]> {
        let find = |name: &String| self.mjcf.bodies.iter().position(|body| body.name.as_ref() == Some(name));
        let second = match other {
            Some(name) => find(name)?,
            None => 0,
        };
        Some([find(one.as_ref()?)?, second])
    }
}
