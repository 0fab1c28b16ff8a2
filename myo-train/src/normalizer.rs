//! Running mean and spread of the observations.

use crate::kernels;

/// Scales observations by the mean and standard deviation of all seen so far, and clips them.
///
/// A feature that was constant in training has no spread to scale by. Divided by a tiny number, the first change of it,
/// say a target that stands 1 cm elsewhere, would become the largest input the network ever saw, on weights that were
/// never trained. So the standard deviation has a floor of `std_floor * max(1, |mean|)`: environments scale their
/// observations to order 1, where a centimetre is 0.01 to 0.04, and with the default floor of 0.05 the change enters
/// with less than one standard deviation. Features that truly vary less than that come in smaller, but not lost.
#[derive(Clone, Debug, PartialEq)]
pub struct Normalizer {
    limit: f32,
    std_floor: f64,
    count: f64,
    mean: Vec<f64>,
    /// Sum of squared deviations from the mean.
    m2: Vec<f64>,
    mean_f32: Vec<f32>,
    inverse_std: Vec<f32>,
}

/// Sums over some rows, taken relative to the mean of a [`Normalizer`] so that they keep their digits.
#[derive(Clone, Debug, PartialEq)]
pub struct Moments {
    count: f64,
    sum: Vec<f64>,
    sum_squares: Vec<f64>,
}

impl Moments {
    /// No rows, of `size` features each.
    pub fn new(size: usize) -> Self {
        Self { count: 0.0, sum: vec![0.0; size], sum_squares: vec![0.0; size] }
    }

    /// Forgets all rows.
    pub fn clear(&mut self) {
        self.count = 0.0;
        self.sum.fill(0.0);
        self.sum_squares.fill(0.0);
    }

    /// Adds the sums of other rows, taken relative to the same mean.
    pub fn add(&mut self, other: &Moments) {
        self.count += other.count;
        self.sum.iter_mut().zip(&other.sum).for_each(|(a, b)| *a += b);
        self.sum_squares.iter_mut().zip(&other.sum_squares).for_each(|(a, b)| *a += b);
    }

    /// Index of a feature that was NaN or infinite in some row.
    pub fn non_finite(&self) -> Option<usize> {
        self.sum_squares.iter().position(|s| !s.is_finite())
    }
}

impl Normalizer {
    /// Leaves observations as they are, except for clipping at `limit`, until rows are merged.
    pub fn new(size: usize, limit: f64, std_floor: f64) -> Self {
        Self {
            limit: limit as f32,
            std_floor,
            count: 0.0,
            mean: vec![0.0; size],
            m2: vec![0.0; size],
            mean_f32: vec![0.0; size],
            inverse_std: vec![1.0; size],
        }
    }

    /// A normaliser from what [`Normalizer::parts`] returned.
    pub fn from_parts(limit: f32, std_floor: f64, count: f64, mean: Vec<f64>, m2: Vec<f64>) -> Self {
        let mut normalizer = Self { count, mean, m2, ..Self::new(0, limit.into(), std_floor) };
        normalizer.refresh();
        normalizer
    }

    /// A normaliser that scales by these numbers and knows of no rows behind them.
    pub(crate) fn from_scaling(limit: f32, mean: Vec<f32>, inverse_std: Vec<f32>) -> Self {
        let fresh = Self::new(mean.len(), limit.into(), 0.0);
        Self { mean: mean.iter().map(|&x| x.into()).collect(), mean_f32: mean, inverse_std, ..fresh }
    }

    /// Limit, floor, number of rows, means, and sums of squared deviations.
    pub fn parts(&self) -> (f32, f64, f64, &[f64], &[f64]) {
        (self.limit, self.std_floor, self.count, &self.mean, &self.m2)
    }

    /// Number of features.
    pub fn size(&self) -> usize {
        self.mean.len()
    }

    /// Sums up `rows`, `(.., size)`, into `moments`.
    pub fn measure(&self, rows: &[f32], moments: &mut Moments) {
        moments.count += (rows.len() / self.size()) as f64;
        kernels::add_moments(rows, &self.mean, &mut moments.sum, &mut moments.sum_squares);
    }

    /// Moments from sums of `x - mean` and then of `(x - mean)^2` per feature, with the mean rounded to single precision
    /// as in [`Normalizer::scaling`].
    pub(crate) fn moments_from_f32(&self, rows: usize, sums: &[f32]) -> Moments {
        let (count, (sum, squares)) = (rows as f64, sums.split_at(self.size()));
        let mut moments = Moments { count, ..Moments::new(self.size()) };
        for i in 0..self.size() {
            // x - mean = (x - rounded) + shift
            let (shift, sum) = (f64::from(self.mean_f32[i]) - self.mean[i], f64::from(sum[i]));
            moments.sum[i] = sum + count * shift;
            moments.sum_squares[i] = f64::from(squares[i]) + 2.0 * shift * sum + count * shift * shift;
        }
        moments
    }

    /// Means, and one over standard deviations, as [`Normalizer::apply`] uses them.
    pub(crate) fn scaling(&self) -> (&[f32], &[f32]) {
        (&self.mean_f32, &self.inverse_std)
    }

    /// Takes in the rows behind `moments` (Chan, Golub and LeVeque 1983, doi 10.1080/00031305.1983.10483115).
    pub fn merge(&mut self, moments: &Moments) {
        if moments.count == 0.0 {
            return;
        }
        let total = self.count + moments.count;
        for ((mean, m2), (sum, squares)) in
            self.mean.iter_mut().zip(&mut self.m2).zip(moments.sum.iter().zip(&moments.sum_squares))
        {
            // With sums relative to the old mean: delta = sum / n, M2 of the new rows = sum d^2 - sum^2 / n.
            let delta = sum / moments.count;
            let new_m2 = (squares - sum * delta).max(0.0);
            *m2 += new_m2 + delta * delta * self.count * moments.count / total;
            *mean += delta * moments.count / total;
        }
        self.count = total;
        self.refresh();
    }

    fn refresh(&mut self) {
        self.mean_f32.resize(self.mean.len(), 0.0);
        self.inverse_std.resize(self.mean.len(), 1.0);
        for (i, (&mean, &m2)) in self.mean.iter().zip(&self.m2).enumerate() {
            let std = if self.count > 0.0 { (m2 / self.count).sqrt() } else { 1.0 };
            self.mean_f32[i] = mean as f32;
            self.inverse_std[i] = (1.0 / std.max(self.std_floor * mean.abs().max(1.0))) as f32;
        }
    }

    /// Writes the normalised `rows`, `(.., size)`, to `out`.
    pub fn apply(&self, rows: &[f32], out: &mut [f32]) {
        kernels::normalize_rows(rows, &self.mean_f32, &self.inverse_std, self.limit, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Stream, fill_normal};

    fn merged(rows: &[f32], size: usize, piece: usize) -> Normalizer {
        let mut normalizer = Normalizer::new(size, 5.0, 0.05);
        for rows in rows.chunks(piece * size) {
            let mut moments = Moments::new(size);
            normalizer.measure(rows, &mut moments);
            normalizer.merge(&moments);
        }
        normalizer
    }

    #[test]
    fn running_moments_agree_with_those_of_all_rows() {
        let mut rows = vec![0.0; 3 * 1000];
        fill_normal(1, Stream::Actions, 0, 0, &mut rows);
        rows.iter_mut().enumerate().for_each(|(i, x)| *x = *x * (1 + i % 3) as f32 + 100.0);
        let (a, b) = (merged(&rows, 3, 1000), merged(&rows, 3, 37));
        for i in 0..3 {
            let column: Vec<f64> = rows.iter().skip(i).step_by(3).map(|&x| x.into()).collect();
            let mean = column.iter().sum::<f64>() / 1000.0;
            let m2: f64 = column.iter().map(|x| (x - mean).powi(2)).sum();
            for n in [&a, &b] {
                assert!((n.mean[i] - mean).abs() < 1e-9, "{} {mean}", n.mean[i]);
                assert!((n.m2[i] / m2 - 1.0).abs() < 1e-9, "{} {m2}", n.m2[i]);
            }
        }
    }

    #[test]
    fn a_feature_constant_in_training_may_move_by_a_centimetre() {
        let rows: Vec<f32> = (0..2000).flat_map(|i| [0.55, (i % 7) as f32]).collect();
        let normalizer = merged(&rows, 2, 100);
        let mut out = [0.0; 2];
        normalizer.apply(&[0.55, 3.0], &mut out);
        assert!(out[0].abs() < 1e-5);
        normalizer.apply(&[0.55 + 0.04, 3.0], &mut out);
        assert!(out[0] > 0.1 && out[0] < 1.0, "1 cm, scaled by 4, became {}", out[0]);
        normalizer.apply(&[1e9, -1e9], &mut out);
        assert_eq!(out, [5.0, -5.0]);
    }

    #[test]
    fn a_normalizer_survives_its_parts() {
        let normalizer = merged(&[1.0, 2.0, 3.0, 5.0], 2, 1);
        let (limit, floor, count, mean, m2) = normalizer.parts();
        assert_eq!(normalizer, Normalizer::from_parts(limit, floor, count, mean.to_vec(), m2.to_vec()));
    }
}
