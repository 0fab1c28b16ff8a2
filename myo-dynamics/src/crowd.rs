//! How many boxes can be touched at once.

use myo_model::OrientedBox;
use nalgebra::Vector3;

/// Branches of the search for the greatest number; beyond them a greater bound is taken.
const MOST_BRANCHES: usize = 100_000;

/// A box that may be moved.
#[derive(Clone, Copy, Debug)]
pub struct MovedBox {
    /// Where it stands.
    pub place: OrientedBox,
    /// Number of what moves it; one that there is not where it stands still.
    pub moved_by: usize,
}

/// A bound of how many of these boxes a point can be within `reach` metres of at once; at least one. What is moved by number `k` is so by
/// any share, from minus one half to one half, of each of the ways (m) of that number.
///
/// Boxes that are all near one point are near each other in pairs. So the bound is the greatest set of boxes that all have gaps of
/// at most twice the reach, found by branch and bound.
pub fn most_at_once(boxes: &[MovedBox], ways: &[[Vector3<f64>; 3]], reach: f64) -> usize {
    let is_near = |a: &MovedBox, b: &MovedBox| {
        // What is moved as one keeps its distance.
        let apart = [a, b].into_iter().filter(|_| a.moved_by != b.moved_by).filter_map(|each| ways.get(each.moved_by));
        let apart: Vec<Vector3<f64>> = apart.flatten().copied().collect();
        let (a, b) = (&a.place, &b.place);
        let moved: f64 = apart.iter().map(|way| 0.5 * way.norm()).sum();
        let far = a.half_size.norm() + b.half_size.norm() + moved + 2.0 * reach;
        (a.centre - b.centre).norm() <= far && a.least_gap(b, &apart) <= 2.0 * reach
    };
    let later = |k: usize| (k + 1..boxes.len()).filter(|&other| is_near(&boxes[k], &boxes[other])).collect();
    let search = Search { later: (0..boxes.len()).map(later).collect() };
    let (mut best, mut branches) = (1, 0);
    for first in 0..boxes.len() {
        search.extend(1, &search.later[first], &mut best, &mut branches);
    }
    best
}

/// For each box, those after it that are near.
struct Search {
    later: Vec<Vec<usize>>,
}

impl Search {
    /// Extends a set of `size` boxes by any of the candidates, all of which are near all of the set.
    fn extend(&self, size: usize, candidates: &[usize], best: &mut usize, branches: &mut usize) {
        *best = size.max(*best);
        *branches += 1;
        if size + candidates.len() <= *best {
            return;
        }
        if *branches > MOST_BRANCHES {
            *best = size + candidates.len();
            return;
        }
        for (k, &next) in candidates.iter().enumerate() {
            let left: Vec<usize> =
                candidates[k + 1..].iter().copied().filter(|other| self.later[next].contains(other)).collect();
            self.extend(size + 1, &left, best, branches);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    fn keys(rows: usize, columns: usize, pitch: f64, indent: f64) -> Vec<MovedBox> {
        let place = |row: usize, column: usize| {
            Vector3::new(-(row as f64) * pitch, -(column as f64 + indent * row as f64) * pitch, 0.0)
        };
        let half_size = Vector3::new(0.0045, 0.0045, 0.0025);
        let key =
            |centre| MovedBox { place: OrientedBox { centre, axes: Matrix3::identity(), half_size }, moved_by: 0 };
        (0..rows).flat_map(|row| (0..columns).map(move |column| place(row, column))).map(key).collect()
    }

    #[test]
    fn keys_meet_in_fours_and_staggered_ones_in_threes() {
        assert_eq!(most_at_once(&keys(3, 10, 0.010, 0.0), &[], 0.002), 4);
        assert_eq!(most_at_once(&keys(3, 10, 0.010, 0.5), &[], 0.002), 3);
        assert_eq!(most_at_once(&keys(3, 10, 0.014, 0.5), &[], 0.002), 1, "5 mm apart");
        assert_eq!(most_at_once(&keys(1, 10, 0.010, 0.0), &[], 0.002), 2);
        // A fingertip of 15 mm over keys of 10 mm: four in a row have gaps of up to 21 mm.
        assert_eq!(most_at_once(&keys(1, 10, 0.010, 0.0), &[], 0.015), 4);
        assert_eq!(most_at_once(&[], &[], 0.002), 1);
    }

    #[test]
    fn two_hundred_boxes_in_one_place_are_bounded_soon() {
        assert_eq!(most_at_once(&keys(10, 20, 1e-4, 0.3), &[], 0.002), 200);
    }

    #[test]
    fn keys_that_are_moved_each_for_itself_may_meet() {
        let mut two = keys(1, 2, 0.05, 0.0);
        let way = |length: f64| [Vector3::new(0.0, length, 0.0), Vector3::zeros(), Vector3::zeros()];
        assert_eq!(most_at_once(&two, &[way(0.2)], 0.002), 1, "moved as one");
        two[1].moved_by = 1;
        // 41 mm apart; within 4 mm of each other from 74 mm of range in all.
        assert_eq!(most_at_once(&two, &[way(0.02), way(0.05)], 0.002), 1);
        assert_eq!(most_at_once(&two, &[way(0.03), way(0.05)], 0.002), 2);
    }
}
