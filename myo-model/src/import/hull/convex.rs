//! Convex hulls after Barber, Dobkin and Huhdanpaa 1996 (doi 10.1145/235815.235821), in the order of their program Qhull, with which MuJoCo
//! makes those of its meshes: the order of triangles decides that of polygons, which counts where several would do for a contact.
//!
//! Qhull merges triangles that lie in one plane within rounding, and divides them again at the end. Here such planes count as seen from a point that
//! lies in them, and are made anew. So triangles in one plane may be divided in another way, and stand in another order.

use super::HullError;
use super::facets::{Facets, NONE};
use super::simplex::Extent;
use nalgebra::Vector3;

/// The hull of points as triangles, counter-clockwise as seen from outside. It takes away from the points that may be added to hulls.
pub(super) fn hull(points: &[Vector3<f64>], left: &mut usize) -> Result<Vec<[usize; 3]>, HullError> {
    if points.len() < 4 {
        return Err(HullError::Few);
    }
    let extent = Extent::of(points);
    let simplex = extent.simplex(points)?;
    let mut growing = Growing::new(points, simplex, extent.rounding)?;
    growing.part_all(simplex);
    while let Some(facet) = growing.facets.next {
        match growing.facets.all[facet].outside.pop() {
            Some(point) => {
                *left = left.checked_sub(1).ok_or(HullError::Slow)?;
                growing.add(point, facet)?;
            }
            None => growing.facets.next = growing.facets.after(facet),
        }
    }
    let triangle = |facet: usize| {
        let facet = &growing.facets.all[facet];
        let [a, b, c] = facet.corners;
        if facet.is_upright { [b, a, c] } else { [a, b, c] }
    };
    Ok(growing.facets.from(growing.facets.first()).map(triangle).collect())
}

/// A hull that grows point by point.
struct Growing<'a> {
    points: &'a [Vector3<f64>],
    facets: Facets,
    /// Within all facets.
    middle: Vector3<f64>,
    /// What a distance may be off (m), and from which on something is in front of a plane, or outside.
    rounding: f64,
    visible: f64,
    outside: f64,
    visits: usize,
    /// Whether all new facets are looked at for the points of those that are gone, and whether that is not needed.
    looks_at_all: bool,
    is_blunt: bool,
}

impl<'a> Growing<'a> {
    /// The hull of four points.
    fn new(points: &'a [Vector3<f64>], simplex: [usize; 4], rounding: f64) -> Result<Self, HullError> {
        let middle = simplex.iter().map(|&point| points[point]).rev().sum::<Vector3<f64>>() / 4.0;
        let visible = 2.0 * rounding;
        let mut growing = Self {
            points,
            facets: Facets::default(),
            middle,
            rounding,
            visible,
            outside: 2.0 * visible,
            visits: 0,
            looks_at_all: false,
            is_blunt: false,
        };
        growing.facets.begin();
        let [d, c, b, a] = simplex;
        for (number, corners) in [[b, c, d], [a, c, d], [a, b, d], [a, b, c]].into_iter().enumerate() {
            growing.facets.make(corners, number % 2 == 0);
        }
        for number in 0..4 {
            let others = (0..4).filter(|&other| other != number);
            others.enumerate().for_each(|(place, other)| growing.facets.all[number].neighbours[place] = other);
        }
        growing.facets.finish();
        growing.facets.next = growing.facets.first();
        growing.set_plane(0);
        if growing.facets.all[0].distance(&growing.middle) > rounding {
            growing.facets.all.iter_mut().for_each(|facet| facet.is_upright ^= true);
        }
        (0..4).for_each(|facet| growing.set_plane(facet));
        // Each plane has the middle behind it.
        let is_flat = growing.facets.all.iter().any(|facet| facet.distance(&growing.middle) >= -rounding);
        if is_flat { Err(HullError::Flat) } else { Ok(growing) }
    }

    fn set_plane(&mut self, facet: usize) {
        let facet = &mut self.facets.all[facet];
        let [p0, p1, p2] = facet.corners.map(|corner| self.points[corner]);
        let (u, v) = (p2 - p0, p1 - p0);
        let normal = Vector3::new(u.y * v.z - u.z * v.y, v.x * u.z - v.z * u.x, u.x * v.y - u.y * v.x);
        let norm = (normal.x * normal.x + normal.y * normal.y + normal.z * normal.z).sqrt();
        let norm = if facet.is_upright { norm } else { -norm };
        facet.normal = if norm == 0.0 { Vector3::zeros() } else { normal / norm };
        facet.offset = -(p0.x * facet.normal.x + p0.y * facet.normal.y + p0.z * facet.normal.z);
    }

    fn distance(&self, facet: usize, point: usize) -> f64 {
        self.facets.all[facet].distance(&self.points[point])
    }

    /// Divides all points among the first facets.
    fn part_all(&mut self, simplex: [usize; 4]) {
        let mut left: Vec<usize> = (0..self.points.len()).filter(|point| !simplex.contains(point)).collect();
        let facets: Vec<usize> = self.facets.from(self.facets.first()).collect();
        for facet in facets {
            let (mut best, mut most) = (None, 0.0);
            let mut outside = vec![];
            let is_left = |&point: &usize| {
                let distance = self.distance(facet, point);
                // Clearly outside.
                if distance < 2.0 * self.outside {
                    return true;
                }
                match best {
                    Some(furthest) if distance > most => {
                        outside.push(furthest);
                        (best, most) = (Some(point), distance);
                    }
                    Some(_) => outside.push(point),
                    None => (best, most) = (Some(point), distance),
                }
                false
            };
            left.retain(is_left);
            outside.extend(best);
            self.facets.all[facet].outside = outside;
            self.facets.all[facet].furthest = most;
        }
        self.looks_at_all = true;
        if let Some(first) = self.facets.first() {
            left.into_iter().for_each(|point| self.part(point, first));
        }
        self.looks_at_all = false;
        self.facets.next = self.facets.first();
        self.begin_with_the_furthest();
    }

    fn begin_with_the_furthest(&mut self) {
        let (mut best, mut most) = (None, f64::NEG_INFINITY);
        for facet in self.facets.from(self.facets.first()) {
            let Some(&furthest) = self.facets.all[facet].outside.last() else { continue };
            let distance = self.distance(facet, furthest);
            if distance > most {
                (best, most) = (Some(facet), distance);
            }
        }
        if let Some(best) = best {
            self.facets.move_to_next(best);
        }
    }

    /// Adds a point that a facet sees.
    fn add(&mut self, point: usize, facet: usize) -> Result<(), HullError> {
        let visible = self.find_visible(point, facet);
        self.facets.begin();
        let replaced = self.make_cone(point, &visible)?;
        let new: Vec<usize> = self.facets.from(self.facets.new).collect();
        self.match_sides(&new)?;
        for &facet in &new {
            self.set_plane(facet);
            if self.facets.all[facet].distance(&self.middle) > self.rounding {
                return Err(HullError::Narrow);
            }
        }
        (self.looks_at_all, self.is_blunt) = (false, false);
        for (&gone, replaced) in visible.iter().zip(replaced) {
            let start = replaced.or(self.facets.new).ok_or(HullError::Narrow)?;
            for point in std::mem::take(&mut self.facets.all[gone].outside) {
                self.part(point, start);
            }
        }
        self.looks_at_all = false;
        visible.into_iter().for_each(|facet| self.facets.remove(facet));
        self.facets.finish();
        Ok(())
    }

    /// Facets that see a point, moved to the end of the list.
    fn find_visible(&mut self, point: usize, facet: usize) -> Vec<usize> {
        self.visits += 1;
        let mut visible = vec![facet];
        let mut done = 0;
        self.see(facet);
        while let Some(&facet) = visible.get(done) {
            done += 1;
            for neighbour in self.facets.all[facet].neighbours {
                if self.facets.all[neighbour].visit == self.visits {
                    continue;
                }
                self.facets.all[neighbour].visit = self.visits;
                // What lies in its plane is made anew.
                if self.distance(neighbour, point) >= -self.visible {
                    self.see(neighbour);
                    visible.push(neighbour);
                }
            }
        }
        visible
    }

    fn see(&mut self, facet: usize) {
        self.facets.all[facet].visit = self.visits;
        self.facets.all[facet].is_visible = true;
        self.facets.move_to_end(facet);
    }

    /// A facet from a point to each side between what sees it and what does not; of each that is gone the last one made for it.
    fn make_cone(&mut self, point: usize, visible: &[usize]) -> Result<Vec<Option<usize>>, HullError> {
        let mut replaced = vec![];
        for &gone in visible {
            let mut last = None;
            for neighbour in self.facets.all[gone].neighbours {
                let horizon = &self.facets.all[neighbour];
                if horizon.is_visible {
                    continue;
                }
                let skip = horizon.neighbours.iter().position(|&facet| facet == gone).ok_or(HullError::Narrow)?;
                let [a, b] = match skip {
                    0 => [horizon.corners[1], horizon.corners[2]],
                    1 => [horizon.corners[0], horizon.corners[2]],
                    _ => [horizon.corners[0], horizon.corners[1]],
                };
                let is_odd = skip % 2 == 1;
                let is_upright = if horizon.is_upright { is_odd } else { !is_odd };
                let made = self.facets.make([point, a, b], is_upright);
                self.facets.all[made].neighbours[0] = neighbour;
                self.facets.all[neighbour].neighbours[skip] = made;
                last = Some(made);
            }
            replaced.push(last);
        }
        Ok(replaced)
    }

    /// Tells new facets of each other.
    fn match_sides(&mut self, new: &[usize]) -> Result<(), HullError> {
        let mut open = std::collections::HashMap::new();
        for &facet in new {
            let [_, a, b] = self.facets.all[facet].corners;
            for (side, corner) in [(1, b), (2, a)] {
                match open.remove(&corner) {
                    None => _ = open.insert(corner, (facet, side)),
                    Some((other, other_side)) => {
                        let other: usize = other;
                        self.facets.all[facet].neighbours[side] = other;
                        self.facets.all[other].neighbours[other_side] = facet;
                    }
                }
            }
        }
        let is_whole = new.iter().all(|&facet| !self.facets.all[facet].neighbours.contains(&NONE));
        if open.is_empty() && is_whole && new.len() >= 3 { Ok(()) } else { Err(HullError::Narrow) }
    }

    /// Gives a point to a facet that it is outside of, if there is one.
    fn part(&mut self, point: usize, start: usize) {
        let (facet, distance) =
            if self.looks_at_all { self.best_of_all(point, start) } else { self.best(point, start) };
        if distance < self.outside {
            return;
        }
        let best = &mut self.facets.all[facet];
        let is_first = best.outside.is_empty();
        if is_first || best.furthest < distance {
            best.outside.push(point);
            best.furthest = distance;
        } else {
            let before_last = best.outside.len() - 1;
            best.outside.insert(before_last, point);
        }
        let is_new = best.is_new;
        if is_first && self.facets.next != Some(facet) {
            if !is_new {
                self.facets.move_to_end(facet);
                self.facets.all[facet].is_new = self.facets.new.is_some();
            } else if self.facets.next.is_some_and(|next| self.facets.all[next].is_new) {
                self.facets.next = self.facets.new;
            }
        }
    }

    /// The first new facet that a point is outside of, on the way to what it is furthest from.
    fn best(&mut self, point: usize, start: usize) -> (usize, f64) {
        self.visits += 1;
        let (mut best, mut most) = (start, self.distance(start, point));
        if most >= self.outside {
            return (best, most);
        }
        self.facets.all[start].visit = self.visits;
        let mut from = Some(start);
        while let Some(facet) = from.take() {
            for neighbour in self.facets.all[facet].neighbours {
                let other = &mut self.facets.all[neighbour];
                if !other.is_new || other.visit == self.visits {
                    continue;
                }
                other.visit = self.visits;
                let distance = self.distance(neighbour, point);
                if distance > most {
                    if distance >= self.outside {
                        return (neighbour, distance);
                    }
                    (best, most) = (neighbour, distance);
                    from = Some(neighbour);
                    break;
                }
            }
        }
        if !self.is_blunt && most < -self.rounding {
            if self.is_sharp() {
                self.looks_at_all = true;
                return self.best_of_all(point, best);
            }
            self.is_blunt = true;
        }
        self.best_beside(point, best, most)
    }

    /// Whether normals of new facets point into different octants: then what a point is furthest from may not be on the way.
    fn is_sharp(&self) -> bool {
        let octant = |facet: usize| self.facets.all[facet].normal.map(|x| x > 0.0);
        let mut new = self.facets.from(self.facets.new).map(octant);
        new.next().is_some_and(|first| new.any(|other| other != first))
    }

    /// The first new facet that a point is clearly outside of, from one on and round; else the one that it is furthest from.
    fn best_of_all(&mut self, point: usize, start: usize) -> (usize, f64) {
        self.visits += 1;
        let (mut best, mut most) = (start, f64::NEG_INFINITY);
        let before = self.facets.new.or(self.facets.first());
        let after: Vec<usize> = self.facets.from(Some(start)).collect();
        let round: Vec<usize> = self.facets.from(before).take_while(|&facet| facet != start).collect();
        for facet in after.into_iter().chain(round) {
            self.facets.all[facet].visit = self.visits;
            let distance = self.distance(facet, point);
            if distance > most {
                (best, most) = (facet, distance);
                if distance >= 2.0 * self.outside {
                    return (best, most);
                }
            }
        }
        self.best_beside(point, best, most)
    }

    /// The same among facets beside one, as long as they are nearly as good.
    fn best_beside(&mut self, point: usize, start: usize, found: f64) -> (usize, f64) {
        self.visits += 1;
        let (mut best, mut most) = (start, found);
        let slack = 2.0 * self.rounding + self.visible;
        let mut least = most - slack;
        self.facets.all[start].visit = self.visits;
        let mut left = vec![start];
        while let Some(facet) = left.pop() {
            for neighbour in self.facets.all[facet].neighbours {
                if self.facets.all[neighbour].visit == self.visits {
                    continue;
                }
                self.facets.all[neighbour].visit = self.visits;
                let distance = self.distance(neighbour, point);
                if distance > most {
                    (best, most, least) = (neighbour, distance, distance - slack);
                } else if distance < least {
                    continue;
                }
                left.push(neighbour);
            }
        }
        (best, most)
    }
}
