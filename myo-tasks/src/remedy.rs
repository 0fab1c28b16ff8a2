//! What brings a target into reach: the least move, or a smaller range.

use std::fmt;

use nalgebra::Vector3;

use crate::check::Reach;
use crate::geometry::spread;
use crate::range::Range;
use crate::target::Region;

/// Rounds of the search for a move; two or three are usual.
const MAX_ROUNDS: usize = 24;
/// Points out of reach that each round learns from, the farthest first.
const LEARNT_FROM: usize = 8;
/// Points that a search looks at before it makes sure of all.
const FEW: usize = 64;
/// How far (m) beyond the edge of reach targets are moved, so that coordinates can be rounded to a millimetre; the second
/// where the first is too little.
const MARGINS: [f64; 2] = [0.002, 0.005];
/// A move longer than this (m) helps nobody.
const LONGEST_MOVE: f64 = 2.0;
/// Parts that a range is cut in, at whole millimetres, when it is narrowed.
const PARTS: u32 = 20;
/// What ranges are shrunk to that cannot be moved into reach as they are.
const SCALES: [f64; 4] = [0.5, 0.25, 0.1, 0.0];
/// Components of a move below this (m) are not worth a word.
const WORTH_A_WORD: f64 = 0.005;

/// Places or sizes of a target that all are in reach; each was checked after its coordinates were rounded to a millimetre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Remedy {
    /// The nearest place in which every centre, or all of a button's face, is in reach; of a smaller range where none was
    /// found for all of it, nor a part that can stay.
    pub moved: Option<Move>,
    /// A part of the range that can be reached; none for a single place, or where none was found.
    pub narrowed: Option<Region>,
}

/// A target moved elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// What its ranges are shrunk to first, about their middle: 1 leaves them as they are.
    pub scale: f64,
    /// How far (m), along x, y and z.
    pub by: [f64; 3],
    /// Where it is then (m, relative to the shoulder centre).
    pub to: Region,
}

impl Move {
    /// Length of the way (m).
    pub fn length(&self) -> f64 {
        Vector3::from(self.by).norm()
    }
}

impl fmt::Display for Move {
    /// `7.8 cm to (0.468, 0.254, -0.119) m, that is 5.8 cm forward, 3.6 cm to the right and 1.9 cm down`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} cm to {}, that is {}", 100.0 * self.length(), Place(&self.to), Directions(self.by))
    }
}

impl Remedy {
    /// What to do; a single place is called `it`, such as `its centre`.
    pub(crate) fn advice(&self, it: &str) -> String {
        match (&self.moved, &self.narrowed) {
            (Some(moved), None) if moved.scale < 1.0 => {
                format!("shrink the range to {:.1} % and move it {moved}", 100.0 * moved.scale)
            }
            (Some(moved), None) if moved.to.is_point() => format!("move {it} {moved}"),
            (Some(moved), None) => format!("move the range {moved}"),
            (Some(moved), Some(part)) => format!("move the range {moved}; or narrow it to {}", Place(part)),
            (None, Some(part)) => format!("narrow the range to {}; no place was found for all of it", Place(part)),
            (None, None) => "no place was found for it that is in reach as a whole".into(),
        }
    }
}

/// The least move of a target to where all points that have to be in reach are.
pub(crate) fn least_move(region: Region, points: &[[f64; 3]], reach: &dyn Reach) -> Option<Move> {
    MARGINS.iter().find_map(|&margin| {
        let by = search(points, reach, margin)?.map(|x| (1e3 * x).round() / 1e3);
        let missed = points.iter().any(|&p| reach.distance_out_of_reach((Vector3::from(p) + by).into()) > 0.0);
        (!missed).then(|| Move { scale: 1.0, by: by.into(), to: region.moved(by.into()) })
    })
}

/// The least move of a range shrunk as little as need be; the centres of its corners have to be in reach, and some between.
pub(crate) fn shrink_and_move(region: &Region, reach: &dyn Reach) -> Option<Move> {
    SCALES.iter().find_map(|&scale| {
        let shrunk = region.shrunk(scale);
        let inside = (0..FEW as u32).map(|k| shrunk.at(spread(k)));
        let mut points: Vec<_> = shrunk.corners().into_iter().chain(inside).collect();
        points.dedup();
        Some(Move { scale, ..least_move(shrunk, &points, reach)? })
    })
}

/// The shortest translation (m) that brings all points into reach.
///
/// Cutting planes (Kelley 1960): a point that is out of reach by `d` along the unit vector `u` to its nearest place in
/// reach asks `u . t >= u . t_now + d` of the translation. The shortest that grants all wishes so far is tried next.
fn search(points: &[[f64; 3]], reach: &dyn Reach, margin: f64) -> Option<Vector3<f64>> {
    let (mut moved, mut wishes) = (Vector3::zeros(), Vec::new());
    let few: Vec<_> = points.iter().step_by(points.len().div_ceil(FEW)).copied().collect();
    for _ in 0..MAX_ROUNDS {
        let missed = Some(wishes_of(&few, moved, reach, margin)).filter(|wishes| !wishes.is_empty());
        let mut missed = missed.unwrap_or_else(|| wishes_of(points, moved, reach, margin));
        if missed.is_empty() {
            return Some(moved);
        }
        missed.sort_by(|a, b| b.lack.total_cmp(&a.lack));
        wishes.extend(missed.into_iter().take(LEARNT_FROM));
        moved = shortest(&wishes);
        let is_near = moved.norm() < LONGEST_MOVE;
        if !is_near {
            break;
        }
    }
    None
}

/// What a point asks of a translation `t`: `way . t >= least`; `lack` is what it is out of reach by (m).
struct Wish {
    way: Vector3<f64>,
    least: f64,
    lack: f64,
}

fn wishes_of(points: &[[f64; 3]], moved: Vector3<f64>, reach: &dyn Reach, margin: f64) -> Vec<Wish> {
    let wish = |&point: &[f64; 3]| {
        let at = Vector3::from(point) + moved;
        let to = Vector3::from(reach.nearest_in_reach(at.into())) - at;
        let way = to.try_normalize(0.0)?;
        Some(Wish { way, least: way.dot(&moved) + to.norm() + margin, lack: to.norm() })
    };
    points.iter().filter_map(wish).collect()
}

/// The shortest vector that grants all wishes (Hildreth 1957); long, or not a number, where there is none.
fn shortest(wishes: &[Wish]) -> Vector3<f64> {
    let (mut weights, mut moved) = (vec![0.0; wishes.len()], Vector3::zeros());
    for _ in 0..1000 {
        for (wish, weight) in wishes.iter().zip(&mut weights) {
            let next = f64::max(0.0, *weight + wish.least - wish.way.dot(&moved));
            moved += (next - *weight) * wish.way;
            *weight = next;
        }
    }
    moved
}

/// A part of a region without the places (m) that were missed; with each place, whether it was reached. The cut that loses
/// most of what was missed for what it costs comes first.
pub(crate) fn reached_part(region: &Region, places: &[([f64; 3], bool)]) -> Option<Region> {
    let mut part = *region;
    loop {
        let left: Vec<_> = places.iter().filter(|(place, _)| part.holds(*place)).collect();
        let missed = left.iter().filter(|(_, is_reached)| !is_reached).count();
        match missed {
            _ if missed == left.len() => return None,
            0 => return Some(part),
            _ => {}
        }
        // How much of what a cut loses was missed: as a share, and in number.
        let gain = |cut: &Region| {
            let lost = left.iter().filter(|(place, _)| !cut.holds(*place));
            let (bad, all) = lost.fold((0, 0), |(bad, all), (_, is_reached)| (bad + u32::from(!is_reached), all + 1));
            (f64::from(bad) / f64::from(all.max(1)), bad)
        };
        let cuts = cuts(region, &part).map(|cut| (gain(&cut), cut));
        let best = cuts.max_by(|((a, m), _), ((b, n), _)| a.total_cmp(b).then(m.cmp(n)));
        part = best.filter(|((_, bad), _)| *bad > 0)?.1;
    }
}

/// What is left of `part` after cuts across one axis, from either side, at every twentieth of the region.
fn cuts(region: &Region, part: &Region) -> impl Iterator<Item = Region> {
    let (region, part) = (*region, *part);
    (0..3).filter(move |&axis| region.axes()[axis].width() > 0.0).flat_map(move |axis| {
        let (whole, now) = (region.axes()[axis], part.axes()[axis]);
        let places = (1..PARTS).map(move |k| (1e3 * whole.at(f64::from(k) / f64::from(PARTS))).round() / 1e3);
        let sides = move |at| [Range::new(at, now.max), Range::new(now.min, at)];
        places.filter(move |at| now.min < *at && *at < now.max).flat_map(sides).map(move |range| {
            let mut axes = part.axes();
            axes[axis] = range;
            let [x, y, z] = axes;
            Region { x, y, z }
        })
    })
}

impl Region {
    /// Whether it is a single place.
    pub fn is_point(&self) -> bool {
        self.axes().iter().all(|range| range.width() == 0.0)
    }

    /// The same elsewhere, `by` metres along each axis.
    pub fn moved(&self, by: [f64; 3]) -> Self {
        let moved = |range: Range, by: f64| Range::new(range.min + by, range.max + by);
        Self { x: moved(self.x, by[0]), y: moved(self.y, by[1]), z: moved(self.z, by[2]) }
    }

    /// The same with ranges of this share of their widths about the same middle.
    fn shrunk(&self, scale: f64) -> Self {
        let [x, y, z] = self.axes().map(|range| {
            let half = 0.5 * scale * range.width();
            Range::new(range.centre() - half, range.centre() + half)
        });
        Self { x, y, z }
    }

    fn holds(&self, place: [f64; 3]) -> bool {
        self.axes().iter().zip(place).all(|(range, x)| range.min <= x && x <= range.max)
    }

    fn axes(&self) -> [Range; 3] {
        [self.x, self.y, self.z]
    }
}

/// `(0.468, 0.254, -0.119) m`, or `x 0.55, y -0.1 to 0.25, z 0 to 0.3 m`.
pub(crate) struct Place<'a>(pub &'a Region);

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Region { x, y, z } = self.0;
        let number = |x: f64| (1e3 * x).round() / 1e3 + 0.0;
        if self.0.is_point() {
            return write!(f, "({}, {}, {}) m", number(x.min), number(y.min), number(z.min));
        }
        let range = |range: &Range| match range.width() > 0.0 {
            true => format!("{} to {}", number(range.min), number(range.max)),
            false => number(range.min).to_string(),
        };
        write!(f, "x {}, y {}, z {} m", range(x), range(y), range(z))
    }
}

/// A way in m in words, the longest part first.
struct Directions([f64; 3]);

impl fmt::Display for Directions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const WORDS: [[&str; 2]; 3] = [["back", "forward"], ["to the right", "to the left"], ["down", "up"]];
        let mut parts: Vec<(f64, &str)> =
            (0..3).map(|k| (self.0[k].abs(), WORDS[k][usize::from(self.0[k] > 0.0)])).collect();
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        let many = parts.iter().filter(|(way, _)| *way >= WORTH_A_WORD).count().max(1);
        for (k, (way, word)) in parts[..many].iter().enumerate() {
            let join = if k == 0 {
                ""
            } else if k + 1 == many {
                " and "
            } else {
                ", "
            };
            write!(f, "{join}{:.1} cm {word}", 100.0 * way)?;
        }
        Ok(())
    }
}
