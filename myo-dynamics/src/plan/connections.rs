//! Bodies that are held together.

use super::build::Tree;
use super::{FixedFrame, Point};
use crate::impedance::Impedance;
use myo_model::Model;
use nalgebra::Vector3;

/// Two bodies that are held together: three rows for the place of a point, and three for their orientation if they are welded.
#[derive(Clone, Debug)]
pub struct Connection<C> {
    /// A frame on each body. Their origins coincide, and if they are welded their axes.
    pub frames: [FixedFrame<C>; 2],
    /// Centres of mass of the model's bodies: where inverse inertias are measured.
    pub coms: [Point<C>; 2],
    /// Length (m) by which half an angle counts as a distance, if they are welded.
    pub torque_scale: Option<C>,
    /// Softness.
    pub impedance: Impedance<C>,
    /// Inverse mass (1/kg) of both, and inverse inertia (1/(kg m^2)) by which they turn.
    pub diagonals: [C; 2],
}

impl<C> Connection<C> {
    /// How many rows it has.
    pub(crate) fn rows(&self) -> usize {
        if self.torque_scale.is_some() { 6 } else { 3 }
    }

    /// The links of both.
    pub(super) fn links(&self) -> [usize; 2] {
        [self.frames[0].origin.link, self.frames[1].origin.link]
    }

    /// All links that it refers to.
    pub(super) fn all_links(&self) -> [usize; 4] {
        let ([a, b], [c, d]) = (self.links(), [self.coms[0].link, self.coms[1].link]);
        [a, b, c, d]
    }

    /// Points that it refers to.
    pub(super) fn points_mut(&mut self) -> impl Iterator<Item = &mut Point<C>> {
        self.frames.iter_mut().map(|frame| &mut frame.origin).chain(&mut self.coms)
    }
}

impl Connection<f64> {
    /// Sets the inverse inertias of the rows, of which each body has one by which it moves and one by which it turns.
    pub(super) fn weigh(&mut self, [one, other]: [[f64; 2]; 2]) {
        self.diagonals = [one[0] + other[0], one[1] + other[1]];
    }
}

/// All connections of a model.
pub(super) fn connections(model: &Model, tree: &Tree) -> Vec<Connection<f64>> {
    let connection = |connection: &myo_model::model::Connection| {
        let turn = connection.weld.map(|weld| weld.turn).unwrap_or_default();
        let [one, other] = connection.bodies;
        let [at, anchor] = connection.anchors;
        let com = |body: usize| -> Vector3<f64> { model.bodies[body].com };
        Connection {
            frames: [tree.placed(one, at, turn), tree.placed(other, anchor, Default::default())],
            coms: connection.bodies.map(|body| tree.point(body, com(body))),
            torque_scale: connection.weld.map(|weld| weld.torque_scale),
            impedance: Impedance::new(&connection.softness, model.options.timestep),
            diagonals: [0.0; 2],
        }
    };
    model.connections.iter().map(connection).collect()
}
