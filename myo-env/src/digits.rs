//! Fingers and thumb of a body as viewers draw them.

use std::iter::successors;

use myo_model::Model;
use myo_model::model::WORLD;

/// How much of its next but last bone a finger goes on where no site tells where it ends.
const LAST_BONE: f64 = 0.7;

/// A finger or thumb that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Digit {
    /// Indices of its bodies, the one next to the palm first.
    pub bodies: Vec<usize>,
    /// Its tip, as seen in the last of them (m).
    pub tip: [f64; 3],
}

/// All that move beyond a hand, in the order of the bodies at their tips.
pub(crate) fn digits(model: &Model, hand: usize) -> Vec<Digit> {
    let mut digits: Vec<Digit> = vec![];
    for bodies in tips(model).filter_map(|tip| moving(model, hand, tip)) {
        // Of branches of one digit the longest is it.
        match digits.iter_mut().find(|digit| digit.bodies[0] == bodies[0]) {
            Some(other) if bodies.len() > other.bodies.len() => *other = digit(model, bodies),
            Some(_) => {}
            None => digits.push(digit(model, bodies)),
        }
    }
    digits
}

/// Bodies that carry no other.
fn tips(model: &Model) -> impl Iterator<Item = usize> {
    (0..model.bodies.len()).filter(|&body| !model.bodies.iter().any(|other| other.parent == body))
}

/// The bodies from the first that moves beyond a hand to this one.
fn moving(model: &Model, hand: usize, tip: usize) -> Option<Vec<usize>> {
    let up = successors(Some(tip), |&body| (body != WORLD).then(|| model.bodies[body].parent));
    let mut way: Vec<usize> = up.take_while(|&body| body != hand && body != WORLD).collect();
    way.reverse();
    let moves = |&body: &usize| model.joints.iter().any(|joint| joint.body == body);
    let is_beyond = way.first().is_some_and(|&body| model.bodies[body].parent == hand);
    let first = way.iter().position(moves).filter(|_| is_beyond)?;
    Some(way.split_off(first))
}

fn digit(model: &Model, bodies: Vec<usize>) -> Digit {
    let tip = tip(model, bodies[bodies.len() - 1]);
    Digit { bodies, tip }
}

/// Where a body ends that carries no other, as seen in it: at the tip of a finger, else where its farthest site is.
pub(crate) fn tip(model: &Model, last: usize) -> [f64; 3] {
    let is_here = |&site: &usize| model.sites[site].body == last;
    let named = model.fingers.iter().map(|&(_, site)| site).chain([model.fingertip_site]).find(is_here);
    let place = |site: usize| model.sites[site].pos;
    let length = |&a: &usize, &b: &usize| place(a).norm().total_cmp(&place(b).norm());
    let farthest = || (0..model.sites.len()).filter(is_here).max_by(length);
    let bone = &model.bodies[last];
    let on = bone.quat.inverse_transform_vector(&bone.pos) * LAST_BONE;
    named.or_else(farthest).map_or(on, place).into()
}
