//! Means, shares and their confidence intervals.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// What the intervals hold with 95 % confidence leaves out on either side.
const TAIL: f64 = 0.025;
/// Quantile of the normal distribution that goes with it.
const NORMAL: f64 = 1.959_963_984_540_054;

/// A quantity that was observed some times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Mean.
    pub mean: f64,
    /// Standard deviation, with one degree of freedom less than observations; zero for a single one.
    pub sd: f64,
    /// 95 % confidence interval of the mean, see [`mean_interval`].
    pub interval: Option<[f64; 2]>,
}

impl Sample {
    /// Of the entries that are not NaN; nothing if there are none.
    pub fn of(x: &[f64]) -> Option<Self> {
        let x = || x.iter().copied().filter(|x| !x.is_nan());
        let n = x().count();
        if n == 0 {
            return None;
        }
        let mean = x().sum::<f64>() / n as f64;
        let squares: f64 = x().map(|x| (x - mean) * (x - mean)).sum();
        let sd = (squares / (n as f64 - 1.0).max(1.0)).sqrt();
        Some(Self { mean, sd, interval: mean_interval(mean, sd, n) })
    }

    /// The same in another unit.
    pub fn times(self, factor: f64) -> Self {
        let interval = self.interval.map(|ends| ends.map(|x| x * factor));
        Self { mean: self.mean * factor, sd: self.sd * factor, interval }
    }
}

/// Student's interval that holds a true mean with 95 % confidence when `n` independent observations have this mean and
/// standard deviation; a single one says nothing about it. Exact for observations of a normal distribution, and for any other
/// in the limit of many.
pub fn mean_interval(mean: f64, sd: f64, n: usize) -> Option<[f64; 2]> {
    let t = StudentsT::new(0.0, 1.0, n as f64 - 1.0).ok()?.inverse_cdf(1.0 - TAIL);
    let half = t * sd / (n as f64).sqrt();
    Some([mean - half, mean + half])
}

/// How the means of two samples differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Welch {
    /// 95 % confidence interval of the second mean less the first.
    pub interval: [f64; 2],
    /// Probability of a difference as large where the means are the same.
    pub p_value: f64,
}

/// Welch's test of two independent samples whose spreads may differ (1947, doi 10.1093/biomet/34.1-2.28); none where a sample
/// has fewer than two observations.
pub fn welch(first: &[f64], second: &[f64]) -> Option<Welch> {
    if first.len().min(second.len()) < 2 {
        return None;
    }
    let (a, b) = (Sample::of(first)?, Sample::of(second)?);
    // Variance of each mean.
    let variance = |sample: Sample, n: usize| sample.sd * sample.sd / n as f64;
    let (of_a, of_b) = (variance(a, first.len()), variance(b, second.len()));
    let (difference, error) = (b.mean - a.mean, (of_a + of_b).sqrt());
    if error == 0.0 {
        return Some(Welch { interval: [difference; 2], p_value: f64::from(u8::from(difference == 0.0)) });
    }
    let share = |variance: f64, n: usize| variance * variance / (n as f64 - 1.0);
    let freedom = (of_a + of_b).powi(2) / (share(of_a, first.len()) + share(of_b, second.len()));
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let half = student.inverse_cdf(1.0 - TAIL) * error;
    Some(Welch {
        interval: [difference - half, difference + half],
        p_value: 2.0 * student.cdf(-(difference / error).abs()),
    })
}

/// Probability of ranks that differ as much between two samples of one distribution, both ways: the rank-sum test (Wilcoxon
/// 1945, doi 10.2307/3001968; Mann and Whitney 1947, doi 10.1214/aoms/1177730491), exact, ties included, over all ways to draw
/// the first sample from both. It asks for no shape of the distribution. One where a sample is empty.
pub fn rank_sum(first: &[f64], second: &[f64]) -> f64 {
    let all = [first, second].concat();
    // Twice the ranks, so that those of ties, in the middle, are whole.
    let rank = |x: f64| {
        let (below, equal) = (all.iter().filter(|&&y| y < x).count(), all.iter().filter(|&&y| y == x).count());
        2 * below + equal + 1
    };
    let ranks: Vec<usize> = all.iter().map(|&x| rank(x)).collect();
    let (drawn, most) = (first.len(), ranks.iter().sum::<usize>());
    // How many ways there are to draw so many of those looked at with this sum.
    let mut ways = vec![vec![0.0; most + 1]; drawn + 1];
    ways[0][0] = 1.0;
    for (seen, &rank) in ranks.iter().enumerate() {
        for count in (1..=drawn.min(seen + 1)).rev() {
            let (fewer, more) = ways.split_at_mut(count);
            for sum in (rank..=most).rev() {
                more[0][sum] += fewer[count - 1][sum - rank];
            }
        }
    }
    let (found, middle) = (ranks[..drawn].iter().sum::<usize>(), most * drawn);
    // Distances from the mean sum, times the number of all.
    let distance = |sum: usize| (sum * all.len()).abs_diff(middle);
    let of_all: f64 = ways[drawn].iter().sum();
    let as_far: f64 = (0..=most).filter(|&sum| distance(sum) >= distance(found)).map(|sum| ways[drawn][sum]).sum();
    (as_far / of_all).min(1.0)
}

/// Wilson's interval (1927, doi 10.1080/01621459.1927.10502953) that holds a true share with 95 % confidence when a share `p`
/// of `n` independent trials succeeded.
pub fn wilson_interval(p: f64, n: f64) -> [f64; 2] {
    let z = NORMAL;
    let centre = p + z * z / (2.0 * n);
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    [((centre - half) / scale).max(0.0), ((centre + half) / scale).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_close([low, high]: [f64; 2], [a, b]: [f64; 2]) {
        assert!((low - a).abs() < 1e-4 && (high - b).abs() < 1e-4, "{low} {high} for {a} {b}");
    }

    #[test]
    fn wilson_interval_of_known_cases() {
        // 81 of 263, a textbook case: 0.2553 to 0.3662
        assert_close(wilson_interval(81.0 / 263.0, 263.0), [0.2553, 0.3662]);
        assert_close(wilson_interval(1.0, 100.0), [0.9630, 1.0]);
        assert_eq!(wilson_interval(1.0, 100.0)[1], 1.0);
    }

    /// Quantiles of printed tables of Student's t.
    #[test]
    fn intervals_of_means_have_the_width_of_tables() {
        for (n, t) in [(2, 12.7062), (3, 4.3027), (5, 2.7764), (11, 2.2281), (31, 2.0423), (121, 1.9799)] {
            let root = f64::from(n).sqrt();
            assert_close(mean_interval(0.0, root, n as usize).unwrap(), [-t, t]);
        }
        assert_close(mean_interval(0.0, 100.0, 10_000).unwrap(), [-1.9602, 1.9602]);
        assert_eq!(mean_interval(3.0, 0.0, 1), None);
        assert_eq!(mean_interval(3.0, 0.0, 2), Some([3.0, 3.0]));
    }

    /// Student's sleep data (1908) as two samples, which R's manual tests: t = -1.8608, 17.776 degrees of freedom,
    /// p = 0.07939, interval of the first less the second -3.3654832 to 0.2054832.
    #[test]
    fn welch_tests_a_published_example() {
        let first = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let second = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        let Welch { interval: [low, high], p_value } = welch(&first, &second).unwrap();
        assert!((low + 0.205_483_2).abs() < 1e-6 && (high - 3.365_483_2).abs() < 1e-6, "{low} {high}");
        assert!((p_value - 0.07939).abs() < 1e-5, "{p_value}");
        assert_eq!(welch(&[1.0], &second), None);
        assert_eq!(welch(&[1.0, 1.0], &[1.0, 1.0]), Some(Welch { interval: [0.0; 2], p_value: 1.0 }));
        assert_eq!(welch(&[1.0, 1.0], &[2.0, 2.0]), Some(Welch { interval: [1.0; 2], p_value: 0.0 }));
    }

    /// Known cases: R's `wilcox.test(exact = TRUE)` of its manual's example (Hollander and Wolfe 1973, page 69), where the
    /// alternative is one-sided with p = 0.1272, so that both sides have 0.2544; and counts by hand.
    #[test]
    fn rank_sum_tests_published_examples() {
        let permeability_at_term = [0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46];
        let months_before = [1.15, 0.88, 0.90, 0.74, 1.21];
        let p = rank_sum(&permeability_at_term, &months_before);
        assert!((p - 0.2544).abs() < 5e-5, "{p}");
        assert_eq!(p, rank_sum(&months_before, &permeability_at_term));
        // Two of 252 ways to draw five of ten.
        let apart = rank_sum(&[1.0, 2.0, 3.0, 4.0, 5.0], &[6.0, 7.0, 8.0, 9.0, 10.0]);
        assert!((apart - 2.0 / 252.0).abs() < 1e-12, "{apart}");
        // With ties: of six ways to draw two of 1, 1, 2, 3, sums of ranks 1.5, 1.5, 3, 4 of 3, 4.5 (2), 5.5 (2), 7; mean 5.
        let tied = rank_sum(&[1.0, 1.0], &[2.0, 3.0]);
        assert!((tied - 2.0 / 6.0).abs() < 1e-12, "{tied}");
        assert_eq!((rank_sum(&[1.0; 5], &[1.0; 5]), rank_sum(&[], &[1.0])), (1.0, 1.0));
    }

    /// What SciPy 1.17.1 says: `mannwhitneyu(first, second, method="exact").pvalue`.
    #[test]
    fn rank_sum_is_that_of_scipy() {
        let longer = [5.0, 4.2, 6.3, 7.7, 3.1, 8.4, 6.9, 5.8, 7.2, 4.9];
        let cases: [(&[f64], &[f64], f64); 4] = [
            (&[1.3, 2.7, 0.4, 3.9, 2.2], &[4.1, 1.9, 5.6, 3.3, 2.5], 0.2222222222222222),
            (&[0.2, 1.1, 0.7], &[0.9, 1.6, 2.4, 0.3, 1.8, 3.0, 1.2, 2.1], 0.08484848484848484),
            (&longer, &[3.8, 2.9, 4.4, 3.3, 5.1, 2.2, 4.0], 0.009666803784450843),
            (&[9.5], &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], 0.2857142857142857),
        ];
        for (first, second, expected) in cases {
            let p = rank_sum(first, second);
            assert!((p - expected).abs() < 1e-12, "{first:?} and {second:?}: {p} for {expected}");
        }
    }

    #[test]
    fn what_does_not_exist_is_left_out() {
        let Sample { mean, sd, interval } = Sample::of(&[f64::NAN, 1.0, 3.0]).unwrap();
        assert_eq!((mean, sd), (2.0, 2.0_f64.sqrt()));
        assert_close(interval.unwrap(), [2.0 - 12.7062, 2.0 + 12.7062]);
        assert_eq!(Sample::of(&[f64::NAN]), None);
        assert_eq!(Sample::of(&[4.0, f64::NAN]), Some(Sample { mean: 4.0, sd: 0.0, interval: None }));
    }
}
