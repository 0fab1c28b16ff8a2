//! How muscles are driven: level, saturation, restlessness, co-contraction.

use crate::{MeasureError, Result, check};

/// Activations below and above are at the ends of their range.
const ENDS: [f64; 2] = [0.05, 0.95];
/// Time in s over which changes are counted.
const CHANGE_S: f64 = 0.05;

/// Activations of muscles over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Mean of each muscle.
    pub mean_of_muscles: Vec<f64>,
    /// Mean of all.
    pub mean: f64,
    /// Share of all samples below 0.05.
    pub share_at_rest: f64,
    /// Share of all samples above 0.95.
    pub share_saturated: f64,
    /// Mean size of the change over 50 ms, of all muscles.
    pub change_per_50_ms: f64,
}

impl Drive {
    /// Of `activations`, (n, muscles) row by row, in [0, 1] at a fixed rate in Hz. Between samples the change over 50 ms is
    /// taken from straight lines.
    ///
    /// # Errors
    /// No muscles, a length that is no multiple of `muscles`, less than 50 ms, activations outside [0, 1], a rate below 20 Hz.
    pub fn of(activations: &[f64], muscles: usize, rate_hz: f64) -> Result<Self> {
        let samples = check_activations(activations, muscles)?;
        check::setting("rate in Hz", rate_hz, "finite and at least 20", rate_hz >= 1.0 / CHANGE_S)?;
        let late = CHANGE_S * rate_hz;
        check::at_least("samples of activation", samples, (late.ceil() as usize).saturating_add(1))?;
        let of_muscle = |muscle: usize| activations[muscle..].iter().step_by(muscles).sum::<f64>() / samples as f64;
        let mean_of_muscles: Vec<f64> = (0..muscles).map(of_muscle).collect();
        let share =
            |is: &dyn Fn(f64) -> bool| activations.iter().filter(|&&a| is(a)).count() as f64 / activations.len() as f64;
        Ok(Self {
            mean: mean_of_muscles.iter().sum::<f64>() / muscles as f64,
            mean_of_muscles,
            share_at_rest: share(&|a| a < ENDS[0]),
            share_saturated: share(&|a| a > ENDS[1]),
            change_per_50_ms: mean_change(activations, muscles, late),
        })
    }
}

/// Mean of `|a(t + late) - a(t)|`, where `late` is in samples.
fn mean_change(activations: &[f64], muscles: usize, late: f64) -> f64 {
    let (whole, part) = (late.floor() as usize, late.fract());
    let next = late.ceil() as usize;
    let changes = activations[next * muscles..].iter().enumerate().map(|(i, after)| {
        let before = activations[whole * muscles + i];
        (before + (after - before) * part - activations[i]).abs()
    });
    changes.sum::<f64>() / (activations.len() - next * muscles) as f64
}

/// Mean activation of a group of muscles over time, (n), of `activations`, (n, muscles) row by row.
///
/// # Errors
/// No muscles in all or in the group, one that does not exist, a length that is no multiple of `muscles`, activations outside
/// [0, 1].
pub fn group_activation(activations: &[f64], muscles: usize, group: &[usize]) -> Result<Vec<f64>> {
    check_activations(activations, muscles)?;
    check::at_least("muscles of a group", group.len(), 1)?;
    if let Some(index) = group.iter().position(|&muscle| muscle >= muscles) {
        let (what, value) = ("muscle of a group", group[index] as f64);
        return Err(MeasureError::OutOfRange {
            what,
            index: Some(index),
            value,
            right: "less than the number of muscles",
        });
    }
    let mean = |row: &[f64]| group.iter().map(|&muscle| row[muscle]).sum::<f64>() / group.len() as f64;
    Ok(activations.chunks_exact(muscles).map(mean).collect())
}

/// Co-contraction index of two series, torques or activations of flexors and of extensors: `2 sum min(F, E) / sum (F + E)`, from 0
/// (one at a time) to 1 (both alike). It is the mean of `2 min(F, E) / (F + E)` weighted with `F + E`, so that moments of rest
/// decide nothing (Falconer and Winter 1985, Electromyogr Clin Neurophysiol 25:135, take the same areas).
///
/// # Errors
/// No samples, unequal lengths, numbers that are not finite or negative, both at rest throughout.
pub fn co_contraction(flexors: &[f64], extensors: &[f64]) -> Result<f64> {
    check::same_length("extensors", extensors.len(), flexors.len())?;
    check::at_least("samples of co-contraction", flexors.len(), 1)?;
    check::within("flexors", flexors, "0 or more", |x| x >= 0.0)?;
    check::within("extensors", extensors, "0 or more", |x| x >= 0.0)?;
    let common: f64 = flexors.iter().zip(extensors).map(|(f, e)| f.min(*e)).sum();
    let all = flexors.iter().chain(extensors).sum::<f64>();
    check::setting("sum of flexors and extensors", all, "finite and greater than 0", all > 0.0)?;
    Ok(2.0 * common / all)
}

/// How many samples there are.
fn check_activations(activations: &[f64], muscles: usize) -> Result<usize> {
    check::at_least("muscles", muscles, 1)?;
    let samples = activations.len() / muscles;
    check::at_least("samples of activation", samples, 1)?;
    check::same_length("activations", activations.len(), samples * muscles)?;
    check::within("activation", activations, "from 0 to 1", |a| (0.0..=1.0).contains(&a))?;
    Ok(samples)
}
