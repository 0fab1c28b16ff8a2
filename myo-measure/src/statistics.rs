//! Medians, intervals and straight lines.

use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::{Result, check};

/// What the intervals hold with 95 % confidence leaves out on either side.
const TAIL: f64 = 0.025;

/// Mean of some numbers; NaN of none.
pub(crate) fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

/// Standard deviation, with one degree of freedom less than numbers; NaN of a single one.
pub(crate) fn sd(x: &[f64]) -> f64 {
    (squares(x) / (x.len() as f64 - 1.0)).sqrt()
}

/// The value that a share of all is below, with straight lines between ranks (type 7 of Hyndman and Fan 1996,
/// doi 10.1080/00031305.1996.10473566, which R and NumPy have as default).
///
/// # Errors
/// No values, values that are not finite, a share outside [0, 1].
pub fn quantile(x: &[f64], share: f64) -> Result<f64> {
    check::at_least("values", x.len(), 1)?;
    check::finite("values", x)?;
    check::setting("share", share, "from 0 to 1", (0.0..=1.0).contains(&share))?;
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = share * (x.len() - 1) as f64;
    let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
    Ok(below + (above - below) * rank.fract())
}

/// The middle value.
///
/// # Errors
/// Those of [`quantile`].
pub fn median(x: &[f64]) -> Result<f64> {
    quantile(x, 0.5)
}

/// How a figure is spread over movements, trials or users.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// How many there are.
    pub count: usize,
    /// The middle one.
    pub median: f64,
    /// 5 % are below.
    pub low: f64,
    /// 5 % are above.
    pub high: f64,
    /// Mean.
    pub mean: f64,
    /// Student's 95 % confidence interval of the mean; none for a single value. Exact for values of a normal distribution.
    pub interval: Option<[f64; 2]>,
}

impl Spread {
    /// Of at least one value.
    ///
    /// # Errors
    /// Those of [`quantile`].
    pub fn of(x: &[f64]) -> Result<Self> {
        let (low, median, high) = (quantile(x, 0.05)?, median(x)?, quantile(x, 0.95)?);
        let mean = mean(x);
        let interval = (x.len() > 1).then(|| {
            let half = student_quantile((x.len() - 1) as f64) * sd(x) / (x.len() as f64).sqrt();
            [mean - half, mean + half]
        });
        Ok(Self { count: x.len(), median, low, high, mean, interval })
    }
}

/// How many standard errors the 95 % confidence interval of a mean reaches to either side; NaN without a degree of freedom.
pub fn student_quantile(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |student| student.inverse_cdf(1.0 - TAIL))
}

/// Rise of `y` per unit of `x` by least squares, of at least two points; what is level has a slope of 0.
///
/// # Errors
/// Fewer points, unequal lengths, numbers that are not finite, no spread of `x`.
pub fn slope(x: &[f64], y: &[f64]) -> Result<f64> {
    check::same_length("y of a line", y.len(), x.len())?;
    check::at_least("points of a line", x.len(), 2)?;
    check::finite("x of a line", x)?;
    check::finite("y of a line", y)?;
    check::spread("x of a line", x, "a slope needs points at different places")?;
    let (x_mean, y_mean) = (mean(x), mean(y));
    let products: f64 = x.iter().zip(y).map(|(x, y)| (x - x_mean) * (y - y_mean)).sum();
    let slope = products / squares(x);
    check::setting("slope of a line", slope, "finite; the numbers are too large or too close", true)?;
    Ok(slope)
}

/// Sum of squares about the mean.
fn squares(x: &[f64]) -> f64 {
    let centre = mean(x);
    x.iter().map(|x| (x - centre).powi(2)).sum()
}

/// A straight line through points by least squares, `y = intercept + slope * x`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Value at zero, in units of `y`.
    pub intercept: f64,
    /// Rise per unit of `x`.
    pub slope: f64,
    /// Standard error of the intercept, of n - 2 degrees of freedom.
    pub intercept_error: f64,
    /// Standard error of the slope.
    pub slope_error: f64,
    /// Share of the variance of `y` that the line explains.
    pub r2: f64,
    /// How many points there are.
    pub count: usize,
}

impl Line {
    /// Through at least three points that are neither above one another nor level; `x` and `y` have equal lengths.
    ///
    /// # Errors
    /// Fewer points, unequal lengths, numbers that are not finite, no spread of `x` or of `y`.
    pub fn through(x: &[f64], y: &[f64]) -> Result<Self> {
        let slope = slope(x, y)?;
        check::at_least("points of a line", x.len(), 3)?;
        check::spread("y of a line", y, "no share of a variance of zero can be explained")?;
        let (n, x_mean, y_mean) = (x.len() as f64, mean(x), mean(y));
        let intercept = y_mean - slope * x_mean;
        let (xx, yy) = (squares(x), squares(y));
        let residual: f64 = x.iter().zip(y).map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
        let variance = residual / (n - 2.0);
        Ok(Self {
            intercept,
            slope,
            intercept_error: (variance * (1.0 / n + x_mean * x_mean / xx)).sqrt(),
            slope_error: (variance / xx).sqrt(),
            r2: 1.0 - residual / yy,
            count: x.len(),
        })
    }

    /// Value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.intercept + self.slope * x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of printed tables of Student's t.
    #[test]
    fn student_has_the_quantiles_of_tables() {
        for (freedom, t) in [
            (1, 12.7062),
            (2, 4.3027),
            (3, 3.1824),
            (4, 2.7764),
            (9, 2.2622),
            (10, 2.2281),
            (30, 2.0423),
            (120, 1.9799),
        ] {
            assert!((student_quantile(f64::from(freedom)) - t).abs() < 5e-5, "{freedom}");
        }
    }

    /// NumPy 2.4: `quantile([3, 1, 4, 1, 5, 9, 2, 6], [.05, .5, .95])`.
    #[test]
    fn quantiles_are_those_of_numpy() {
        let x = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let Spread { low, median, high, mean, count, .. } = Spread::of(&x).unwrap();
        assert!((low - 1.0).abs() < 1e-12 && (median - 3.5).abs() < 1e-12 && (high - 7.95).abs() < 1e-12, "{high}");
        assert_eq!((mean, count), (3.875, 8));
        assert_eq!(Spread::of(&[2.0]).unwrap().interval, None);
    }

    #[test]
    fn lines_that_do_not_exist_are_refused_by_reason() {
        let refusal = |x: &[f64], y: &[f64]| Line::through(x, y).unwrap_err().to_string();
        assert_eq!(refusal(&[1.0, 2.0], &[1.0, 2.0]), "points of a line: 2 given, at least 3 are needed");
        assert_eq!(
            refusal(&[1.0; 3], &[1.0, 2.0, 3.0]),
            "x of a line: all are 1; a slope needs points at different places"
        );
        assert_eq!(
            refusal(&[1.0, 2.0, 3.0], &[1.0, f64::NAN, 3.0]),
            "y of a line: NaN at index 1; every number must be finite"
        );
        assert_eq!(refusal(&[1.0; 3], &[1.0]), "y of a line: 1 entries, but 3 are needed to go with the rest");
    }
}
