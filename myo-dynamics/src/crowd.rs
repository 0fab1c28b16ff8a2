//! How many boxes can be touched at once.

use myo_model::OrientedBox;

/// Branches of the search for the greatest number; beyond them a greater bound is taken.
const MOST_BRANCHES: usize = 100_000;

/// A bound of how many of these boxes a point can be within `reach` metres of at once; at least one.
///
/// Boxes that are all near one point are near each other in pairs. So the bound is the greatest set of boxes that all have gaps of
/// at most twice the reach, found by branch and bound.
pub fn most_at_once(boxes: &[OrientedBox], reach: f64) -> usize {
    let is_near = |a: &OrientedBox, b: &OrientedBox| {
        let far = a.half_size.norm() + b.half_size.norm() + 2.0 * reach;
        (a.centre - b.centre).norm() <= far && a.gap(b) <= 2.0 * reach
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

    fn keys(rows: usize, columns: usize, pitch: f64, indent: f64) -> Vec<OrientedBox> {
        let place = |row: usize, column: usize| {
            Vector3::new(-(row as f64) * pitch, -(column as f64 + indent * row as f64) * pitch, 0.0)
        };
        let half_size = Vector3::new(0.0045, 0.0045, 0.0025);
        let key = |centre| OrientedBox { centre, axes: Matrix3::identity(), half_size };
        (0..rows).flat_map(|row| (0..columns).map(move |column| place(row, column))).map(key).collect()
    }

    #[test]
    fn keys_meet_in_fours_and_staggered_ones_in_threes() {
        assert_eq!(most_at_once(&keys(3, 10, 0.010, 0.0), 0.002), 4);
        assert_eq!(most_at_once(&keys(3, 10, 0.010, 0.5), 0.002), 3);
        assert_eq!(most_at_once(&keys(3, 10, 0.014, 0.5), 0.002), 1, "5 mm apart");
        assert_eq!(most_at_once(&keys(1, 10, 0.010, 0.0), 0.002), 2);
        // A fingertip of 15 mm over keys of 10 mm: four in a row have gaps of up to 21 mm.
        assert_eq!(most_at_once(&keys(1, 10, 0.010, 0.0), 0.015), 4);
        assert_eq!(most_at_once(&[], 0.002), 1);
    }

    #[test]
    fn two_hundred_boxes_in_one_place_are_bounded_soon() {
        assert_eq!(most_at_once(&keys(10, 20, 1e-4, 0.3), 0.002), 200);
    }
}
