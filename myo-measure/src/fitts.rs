//! Fitts' law: how long a selection takes for how far and how small a target.
//!
//! Shannon's form: `ID = log2(D / W + 1)` in bits, `MT = a + b ID` (MacKenzie 1992, doi 10.1207/s15327051hci0701_3). Fitts' own
//! `log2(2 D / W)` (1954, doi 10.1037/h0055392) is larger by up to one bit. Throughput is that of ISO 9241-411 (Soukoreff and
//! MacKenzie 2004, doi 10.1016/j.ijhcs.2004.09.001): the mean over conditions of `IDe / MT`, which is not `1 / b`.

use crate::{Line, MeasureError, Point, Result, Spread, check, point, statistics};

/// Width in standard deviations that holds 96 % of the end points of a normal distribution: `sqrt(2 pi e)`, rounded as in
/// ISO 9241-411.
pub const EFFECTIVE_WIDTH: f64 = 4.133;
/// Trials further from the mean of their condition than this many standard deviations are left out. No trial of ten or fewer can
/// be that far.
pub const OUTLIER: f64 = 3.0;
/// Fewest different indices of difficulty that a line is put through.
pub const LEAST_INDICES: usize = 3;
/// Fewest trials of a condition that its effective width is taken from.
pub const LEAST_TRIALS: usize = 3;
/// Indices of difficulty closer than this, in bits, are the same.
const SAME_INDEX: f64 = 1e-6;

/// Index of difficulty in bits of a distance and a width in the same unit, Shannon's form.
pub fn index_of_difficulty(distance: f64, width: f64) -> f64 {
    (distance / width + 1.0).log2()
}

/// One selection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Movement time in s, without reaction and without dwell.
    pub movement_time_s: f64,
    /// Where the movement began, in m.
    pub start: Point,
    /// Centre of the target in m. The task axis leads from `start` to here.
    pub target: Point,
    /// Where the selection was made, in m: the contact, or the mean position over the dwell.
    pub end: Point,
}

impl Trial {
    /// How far a point is along the task axis behind the target (less than zero: before it), in m.
    fn deviation(&self) -> f64 {
        self.along(point::minus(self.end, self.target))
    }

    /// Distance covered along the task axis in m.
    fn covered(&self) -> f64 {
        self.along(point::minus(self.end, self.start))
    }

    fn along(&self, vector: Point) -> f64 {
        let axis = point::minus(self.target, self.start);
        point::dot(vector, axis) / point::length(axis)
    }

    /// Length of the deviation across the task axis in m.
    fn across(&self) -> f64 {
        let off = point::minus(self.end, self.target);
        let along = self.along(off);
        (point::dot(off, off) - along * along).max(0.0).sqrt()
    }

    fn miss(&self) -> f64 {
        point::length(point::minus(self.end, self.target))
    }
}

/// Trials of one distance and one width.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// Nominal distance in m.
    pub distance: f64,
    /// Nominal width in m: the diameter of a sphere.
    pub width: f64,
    /// What was done.
    pub trials: Vec<Trial>,
}

/// One condition, evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionFigures {
    /// Nominal index of difficulty in bits.
    pub index: f64,
    /// Trials that count.
    pub trials: usize,
    /// Trials whose movement time or whose deviation along the task axis was beyond [`OUTLIER`] standard deviations, both found in
    /// one pass over all trials.
    pub dropped: usize,
    /// Movement times that count, in s.
    pub movement_times_s: Vec<f64>,
    /// Their mean.
    pub movement_time_s: f64,
    /// Mean distance covered along the task axis, in m.
    pub effective_distance: f64,
    /// Standard deviation along the task axis, in m; none with fewer than [`LEAST_TRIALS`] trials.
    pub sd_along: Option<f64>,
    /// Root mean square of the deviation from the target across the task axis, per axis, in m.
    pub rms_across: f64,
    /// Share of trials that ended further from the centre of the target than half its width.
    pub misses: f64,
}

impl ConditionFigures {
    /// Of the trials of one user.
    ///
    /// # Errors
    /// A condition without a distance, a width or trials, or trials that are no numbers.
    pub fn of(condition: &Condition) -> Result<Self> {
        check_condition(condition)?;
        let all = &condition.trials;
        let typical = |of: fn(&Trial) -> f64| {
            let values: Vec<f64> = all.iter().map(of).collect();
            let (mean, sd) = (statistics::mean(&values), statistics::sd(&values));
            // Nothing is far where there is one trial, or all are the same.
            move |trial: &&Trial| sd.is_nan() || (of(trial) - mean).abs() <= OUTLIER * sd
        };
        let (in_time, on_axis) = (typical(|trial| trial.movement_time_s), typical(Trial::deviation));
        let kept: Vec<Trial> = all.iter().filter(|trial| in_time(trial) && on_axis(trial)).copied().collect();
        check::at_least("trials that are no outliers", kept.len(), 1)?;
        let each = |of: fn(&Trial) -> f64| kept.iter().map(of).collect::<Vec<f64>>();
        let movement_times_s = each(|trial| trial.movement_time_s);
        let missed = kept.iter().filter(|trial| trial.miss() > 0.5 * condition.width).count();
        let squares: Vec<f64> = kept.iter().map(|trial| 0.5 * trial.across().powi(2)).collect();
        Ok(Self {
            index: index_of_difficulty(condition.distance, condition.width),
            trials: kept.len(),
            dropped: all.len() - kept.len(),
            movement_time_s: statistics::mean(&movement_times_s),
            movement_times_s,
            effective_distance: statistics::mean(&each(Trial::covered)),
            sd_along: (kept.len() >= LEAST_TRIALS).then(|| statistics::sd(&each(Trial::deviation))),
            rms_across: statistics::mean(&squares).sqrt(),
            misses: missed as f64 / kept.len() as f64,
        })
    }

    /// Effective width `4.133 SD` along the task axis, in m.
    ///
    /// # Errors
    /// Fewer than [`LEAST_TRIALS`] trials, end points that do not vary.
    pub fn effective_width(&self) -> Result<f64> {
        let what = "trials for an effective width";
        let sd = self.sd_along.ok_or(MeasureError::TooFew { what, found: self.trials, least: LEAST_TRIALS })?;
        // Equal end points differ by rounding alone: 1e-12 m is less than an atom.
        let right = "greater than 0: end points that do not vary have no effective width (measure with motor noise)";
        check::setting("SD of end points along the task axis in m", sd, right, sd > 1e-12)?;
        Ok(EFFECTIVE_WIDTH * sd)
    }

    /// Effective index of difficulty `log2(De / We + 1)` in bits.
    ///
    /// # Errors
    /// Those of [`effective_width`](Self::effective_width), movements that on the whole lead away from their targets.
    pub fn effective_index(&self) -> Result<f64> {
        let width = self.effective_width()?;
        let distance = self.effective_distance;
        check::setting("effective distance in m", distance, "greater than 0", distance > 0.0)?;
        Ok(index_of_difficulty(distance, width))
    }

    /// Throughput `IDe / MT` of this condition in bit/s.
    ///
    /// # Errors
    /// Those of [`effective_index`](Self::effective_index).
    pub fn throughput(&self) -> Result<f64> {
        Ok(self.effective_index()? / self.movement_time_s)
    }
}

fn check_condition(condition: &Condition) -> Result<()> {
    let positive = "finite and greater than 0";
    check::setting("distance in m", condition.distance, positive, condition.distance > 0.0)?;
    check::setting("width in m", condition.width, positive, condition.width > 0.0)?;
    check::at_least("trials", condition.trials.len(), 1)?;
    let times: Vec<f64> = condition.trials.iter().map(|trial| trial.movement_time_s).collect();
    check::within("movement time in s", &times, positive, |time| time > 0.0)?;
    for (index, trial) in condition.trials.iter().enumerate() {
        check::finite_point("start of a trial in m", index, trial.start)?;
        check::finite_point("target of a trial in m", index, trial.target)?;
        check::finite_point("end of a trial in m", index, trial.end)?;
        let value = point::length(point::minus(trial.target, trial.start));
        if value == 0.0 || !value.is_finite() {
            let what = "distance from start to target in m";
            return Err(MeasureError::OutOfRange {
                what,
                index: Some(index),
                value,
                right: "finite and greater than 0",
            });
        }
    }
    Ok(())
}

/// How one user points: all conditions, evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Pointing {
    /// In the order handed in.
    pub conditions: Vec<ConditionFigures>,
}

impl Pointing {
    /// Of at least one condition.
    ///
    /// # Errors
    /// No conditions; in one of them no trials, distances, widths or times that are not positive, points that are not finite.
    pub fn of(conditions: &[Condition]) -> Result<Self> {
        check::at_least("conditions", conditions.len(), 1)?;
        let evaluate =
            |(index, condition)| ConditionFigures::of(condition).map_err(|error| error.within("condition", index));
        Ok(Self { conditions: conditions.iter().enumerate().map(evaluate).collect::<Result<_>>()? })
    }

    /// Fitts' law through the means of conditions: intercept in s, slope in s/bit.
    ///
    /// # Errors
    /// Fewer than [`LEAST_INDICES`] different indices of difficulty, the same mean time throughout.
    pub fn fit(&self) -> Result<Line> {
        self.check_indices()?;
        let (x, y): (Vec<f64>, Vec<f64>) = self.conditions.iter().map(|c| (c.index, c.movement_time_s)).unzip();
        Line::through(&x, &y)
    }

    /// The same through all trials; its `r2` is what the law explains of single trials.
    ///
    /// # Errors
    /// Those of [`fit`](Self::fit).
    pub fn fit_of_trials(&self) -> Result<Line> {
        self.check_indices()?;
        let trials = self.conditions.iter().flat_map(|c| c.movement_times_s.iter().map(|&time| (c.index, time)));
        let (x, y): (Vec<f64>, Vec<f64>) = trials.unzip();
        Line::through(&x, &y)
    }

    /// Throughput in bit/s: the mean over conditions of `IDe / MT`.
    ///
    /// # Errors
    /// Those of [`ConditionFigures::throughput`], and in which condition.
    pub fn throughput(&self) -> Result<f64> {
        let each = |(index, condition): (usize, &ConditionFigures)| {
            condition.throughput().map_err(|error| error.within("condition", index))
        };
        Ok(statistics::mean(&self.conditions.iter().enumerate().map(each).collect::<Result<Vec<_>>>()?))
    }

    /// How many different indices of difficulty lie between two, ends included, in bits.
    pub fn distinct_indices(&self, from: f64, to: f64) -> usize {
        let mut indices: Vec<f64> = self.conditions.iter().map(|condition| condition.index).collect();
        indices.retain(|index| (from - SAME_INDEX..=to + SAME_INDEX).contains(index));
        indices.sort_by(f64::total_cmp);
        indices.dedup_by(|a, b| (*a - *b).abs() < SAME_INDEX);
        indices.len()
    }

    /// Trials that were left out of all conditions.
    pub fn dropped(&self) -> usize {
        self.conditions.iter().map(|condition| condition.dropped).sum()
    }

    fn check_indices(&self) -> Result<()> {
        let found = self.distinct_indices(0.0, f64::INFINITY);
        check::at_least("different indices of difficulty for a fit", found, LEAST_INDICES)
    }
}

/// How several users point who did the same conditions: real people, or seeds of simulated ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Users {
    /// Each of them.
    pub users: Vec<Pointing>,
    /// Intercepts in s.
    pub intercept: Spread,
    /// Slopes in s/bit.
    pub slope: Spread,
    /// R2 of the fits through means of conditions.
    pub r2: Spread,
    /// Throughputs in bit/s; its mean is that of ISO 9241-411.
    pub throughput: Spread,
}

impl Users {
    /// Of at least one user; confidence intervals need two.
    ///
    /// # Errors
    /// Those of [`Pointing::of`], [`Pointing::fit`] and [`Pointing::throughput`], and of which user.
    pub fn of(users: &[Vec<Condition>]) -> Result<Self> {
        check::at_least("users", users.len(), 1)?;
        let of_user = |conditions: &Vec<Condition>| {
            let user = Pointing::of(conditions)?;
            let figures = (user.fit()?, user.throughput()?);
            Ok((user, figures))
        };
        let each = |(index, user)| of_user(user).map_err(|error: MeasureError| error.within("user", index));
        let (users, figures): (Vec<Pointing>, Vec<(Line, f64)>) =
            users.iter().enumerate().map(each).collect::<Result<Vec<_>>>()?.into_iter().unzip();
        let spread = |of: fn(&(Line, f64)) -> f64| Spread::of(&figures.iter().map(of).collect::<Vec<_>>());
        Ok(Self {
            users,
            intercept: spread(|(line, _)| line.intercept)?,
            slope: spread(|(line, _)| line.slope)?,
            r2: spread(|(line, _)| line.r2)?,
            throughput: spread(|&(_, throughput)| throughput)?,
        })
    }
}
