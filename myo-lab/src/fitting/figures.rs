//! In what movements at targets are compared.

use myo_measure::fitts::{Trial, index_of_difficulty};
use myo_measure::{Movement, statistics};

use super::FittingError;
use super::practice::{DISTANCES, WIDTHS};
use crate::protocol::Aimed;

/// Fewest movements of a pair of distance and width, fewest pairs, and most.
const LEAST: usize = 8;
const LEAST_PAIRS: usize = 3;
const MOST_PAIRS: usize = 12;
/// Distances, and widths, are alike where they differ by less than this factor.
const ALIKE: f64 = 1.2;

/// What is compared of hands, for people; of each the mean over pairs of distance and width. The activation of each muscle that was recorded comes behind them.
pub const FIGURES: [&str; 10] = [
    "movement time (s)",
    "growth of its logarithm per bit",
    "scatter of movement times (ratio)",
    "peak speed (m/s)",
    "time of the peak, share of the duration",
    "smoothness, SPARC",
    "path over chord",
    "where the first bell of speed ends, share of the way",
    "its scatter along the way, share of the way",
    "its scatter across the way, share of the way",
];
/// How many there are.
const COUNT: usize = FIGURES.len();
/// Muscles are as good as silent below this activation, which no electromyogram tells from noise, so that a ratio to nothing does not count.
const SILENT: f64 = 0.01;
/// Least standard deviations of figures: of hands no more than rounding; of muscles, which may be silent in all users, a fiftieth of an activation.
const LEAST_OF_HANDS: f64 = 1e-9;
const LEAST_OF_MUSCLES: f64 = 0.02;
/// Of these, those whose ratios count, not their differences.
const BY_RATIO: [bool; COUNT] = [true, false, true, true, false, false, false, false, true, true];

/// A movement at a target.
#[derive(Clone, Debug)]
pub struct Aim {
    /// From the centre of the target before (m).
    distance: f64,
    /// Of the target (m).
    width: f64,
    trial: Trial,
    movement: Option<Movement>,
    first_stop: Option<[f64; 3]>,
    /// Mean activations of the muscles that are compared; nothing where they are not known.
    pub(super) activations: Vec<f64>,
}

impl Aim {
    pub(super) fn new([distance, width]: [f64; 2], aimed: &Aimed, activations: Vec<f64>) -> Self {
        let &Aimed { trial, movement, first_stop, .. } = aimed;
        Self { distance, width, trial, movement, first_stop, activations }
    }
}

#[cfg(test)]
impl Aim {
    pub(super) fn known(
        [distance, width]: [f64; 2],
        trial: Trial,
        movement: Movement,
        first_stop: Option<[f64; 3]>,
    ) -> Self {
        Self { distance, width, trial, movement: Some(movement), first_stop, activations: vec![] }
    }

    /// Makes it take so much longer (s).
    pub(super) fn later(&mut self, more_s: f64) {
        self.trial.movement_time_s += more_s;
        if let Some(movement) = &mut self.movement {
            movement.duration_s += more_s;
        }
    }

    /// Whether times (s) and places (m) of two movements at targets are the same, to a few samples.
    pub(super) fn is_like(&self, other: &Self, most: f64) -> bool {
        let numbers = |one: &Self| {
            let (movement, stop) = (one.movement.unwrap(), one.first_stop.unwrap());
            let (trial, end) = (one.trial, one.trial.end);
            let times = [trial.movement_time_s, 0.1 * movement.peak_speed, 0.1 * movement.time_of_peak];
            let shapes = [movement.duration_s, 0.1 * movement.sparc, one.width, one.distance];
            [
                times.to_vec(),
                shapes.to_vec(),
                stop.to_vec(),
                end.to_vec(),
                trial.start.to_vec(),
                trial.target.to_vec(),
                one.activations.clone(),
            ]
            .concat()
        };
        numbers(self).iter().zip(numbers(other)).all(|(a, b)| (a - b).abs() <= most)
    }
}

/// All figures of one person or user, as numbers whose differences count.
pub(super) type Figures = Vec<f64>;

/// Least standard deviation that a figure can have.
pub(super) const fn least(number: usize) -> f64 {
    if number < COUNT { LEAST_OF_HANDS } else { LEAST_OF_MUSCLES }
}

/// A figure as it is told: undoes the logarithm.
pub(super) fn told(number: usize, value: f64) -> f64 {
    if *BY_RATIO.get(number).unwrap_or(&true) { value.exp() } else { value }
}

/// Pairs of distance and width (m) of which a person made enough movements, the most frequent first.
fn pairs(who: &str, movements: &[Aim]) -> Result<Vec<[f64; 2]>, FittingError> {
    let in_range = |[least, most]: [f64; 2], value: f64| (0.97 * least..=1.03 * most).contains(&value);
    let mut bins: Vec<Vec<[f64; 2]>> = vec![];
    for one in movements.iter().filter(|one| in_range(DISTANCES, one.distance) && in_range(WIDTHS, one.width)) {
        let pair = [one.distance, one.width];
        match bins.iter_mut().find(|bin| alike(bin[0], pair)) {
            Some(bin) => bin.push(pair),
            None => bins.push(vec![pair]),
        }
    }
    let middle = |bin: &Vec<[f64; 2]>| [0, 1].map(|k| bin.iter().map(|pair| pair[k]).sum::<f64>() / bin.len() as f64);
    // What is alike to the first of a bin need not be so to its middle.
    let counted = |pair: [f64; 2]| (of(movements, pair).len(), pair);
    let mut found: Vec<(usize, [f64; 2])> = bins.iter().map(middle).map(counted).collect();
    found.retain(|&(count, _)| count >= LEAST);
    found.sort_by_key(|&(count, _)| std::cmp::Reverse(count));
    if found.len() < LEAST_PAIRS {
        return Err(FittingError::TooFew {
            who: who.into(),
            found: found.iter().map(|(count, _)| count).sum(),
            pairs: found.len(),
            least: LEAST,
            least_pairs: LEAST_PAIRS,
        });
    }
    found.truncate(MOST_PAIRS);
    Ok(found.into_iter().map(|(_, pair)| pair).collect())
}

/// What a person did: pairs of distance and width (m), figures, and how many movements these are.
pub(super) fn of_person(who: &str, movements: &[Aim]) -> Result<(Vec<[f64; 2]>, Figures, usize), FittingError> {
    let pairs = pairs(who, movements)?;
    let (own, count) = figures(movements, &pairs).ok_or_else(|| FittingError::Alike { who: who.into() })?;
    Ok((pairs, own, count))
}

/// Movements of a pair.
fn of(movements: &[Aim], pair: [f64; 2]) -> Vec<&Aim> {
    movements.iter().filter(|one| alike([one.distance, one.width], pair)).collect()
}

fn alike(a: [f64; 2], b: [f64; 2]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a / b).ln().abs() < 0.5 * ALIKE.ln())
}

/// Figures of movements of these pairs, and how many movements those are; none where too few were made of a pair.
pub(super) fn figures(movements: &[Aim], pairs: &[[f64; 2]]) -> Option<(Figures, usize)> {
    let of_pair = |pair: &[f64; 2]| {
        let own = of(movements, *pair);
        (own.len() >= LEAST).then(|| Some((of_pair(&own)?, own.len())))?
    };
    let all: Vec<(Figures, usize)> = pairs.iter().map(of_pair).collect::<Option<_>>()?;
    let mean = |figure: usize| all.iter().map(|(own, _)| own[figure]).sum::<f64>() / all.len() as f64;
    let mut means: Figures = (0..all.first()?.0.len()).map(mean).collect();
    let indices: Vec<f64> = pairs.iter().map(|&[distance, width]| index_of_difficulty(distance, width)).collect();
    let times: Vec<f64> = all.iter().map(|(own, _)| own[0]).collect();
    means[1] = statistics::slope(&indices, &times).ok()?;
    means.iter().all(|x| x.is_finite()).then(|| (means, all.iter().map(|(_, count)| count).sum()))
}

/// Of movements of one pair; the growth of movement times is that over pairs, and nothing here.
fn of_pair(own: &[&Aim]) -> Option<Figures> {
    let times: Vec<f64> = own.iter().map(|one| one.trial.movement_time_s).filter(|&time| time > 0.0).collect();
    let times: Vec<f64> = times.into_iter().map(f64::ln).collect();
    let over = |of: &dyn Fn(&Movement) -> Option<f64>| {
        let values: Vec<f64> = own.iter().filter_map(|one| of(one.movement.as_ref()?)).collect();
        mean(&values)
    };
    let stops: Vec<[f64; 2]> = own.iter().filter_map(|one| first_stop(one)).collect();
    let [along, across] = [0, 1].map(|k| stops.iter().map(|stop| stop[k]).collect::<Vec<f64>>());
    let hand = [
        mean(&times)?,
        0.0,
        deviation(&times)?.ln(),
        over(&|movement| Some(movement.peak_speed.ln()))?,
        over(&|movement| Some(movement.time_of_peak))?,
        over(&|movement| Some(movement.sparc))?,
        // One movement that turned round must not outweigh all others.
        over(&|movement| movement.path_over_chord.map(|ratio| ratio.min(2.0)))?,
        mean(&along)?,
        deviation(&along)?.ln(),
        mean(&across.iter().map(|x| x * x).collect::<Vec<_>>())?.sqrt().ln(),
    ];
    Some(hand.into_iter().chain(activations(own)).collect())
}

/// How active each muscle was, over the movements of which it is known.
fn activations(own: &[&Aim]) -> Vec<f64> {
    let muscles = own.iter().map(|one| one.activations.len()).max().unwrap_or_default();
    let of = |muscle: usize| {
        let values: Vec<f64> = own.iter().filter_map(|one| one.activations.get(muscle).copied()).collect();
        mean(&values).unwrap_or_default().max(SILENT).ln()
    };
    (0..muscles).map(of).collect()
}

/// Where the first bell of speed ended: along the way from start to target, and across it, as shares of the way.
fn first_stop(one: &Aim) -> Option<[f64; 2]> {
    let (stop, trial) = (one.first_stop?, &one.trial);
    let (way, gone) = (minus(trial.target, trial.start), minus(stop, trial.start));
    let length = dot(way, way);
    let along = dot(gone, way) / length;
    let off = [0, 1, 2].map(|k| gone[k] - along * way[k]);
    let across = (dot(off, off) / length).sqrt();
    // Who set off the other way is no measure of aim.
    (along.is_finite() && (0.2..2.0).contains(&along)).then_some([along, across])
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Standard deviation; none of values that are all the same.
fn deviation(values: &[f64]) -> Option<f64> {
    let middle = mean(values)?;
    let squares: Vec<f64> = values.iter().map(|x| (x - middle) * (x - middle)).collect();
    // Less is rounding of values that are all the same.
    Some(mean(&squares)?.sqrt()).filter(|&deviation| deviation > 1e-6)
}
