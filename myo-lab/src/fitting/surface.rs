//! Figures as smooth functions of traits, and the place where they are nearest to some.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::figures::Figures;
use super::nature::{COUNT, places};

/// Terms of a polynomial of the second degree: 1, each trait, each product of two.
pub(super) const TERMS: usize = 1 + COUNT + COUNT * (COUNT + 1) / 2;
/// Places from which the nearest is looked for.
const STARTS: usize = 24;
const ROUNDS: usize = 60;
/// What is known of a place beforehand, as the reciprocal of a squared standard error: that it is anything from -1 to 1.
const LEAST_TOLD: f64 = 3.0;

/// Polynomials of the second degree through the figures of some natures, by least squares.
pub(super) struct Surface {
    /// A column for each figure.
    coefficients: DMatrix<f64>,
    /// Covariances of the coefficients of a figure, in its squared deviations.
    covariances: DMatrix<f64>,
    /// Standard deviation of each figure about its polynomial: by chance, and by what the polynomial does not know.
    pub deviations: Figures,
}

/// A place, and how sure it is.
pub(super) struct Nearest {
    pub place: [f64; COUNT],
    /// Standard errors of its coordinates.
    pub errors: [f64; COUNT],
}

impl Surface {
    /// Through at least one nature more than there are terms; none where they lie in a plane.
    pub(super) fn through(places: &[[f64; COUNT]], found: &[Figures]) -> Option<Self> {
        let design = DMatrix::from_fn(places.len(), TERMS, |row, term| terms(&places[row])[term]);
        let count = found.first()?.len();
        let values = DMatrix::from_fn(found.len(), count, |row, figure| found[row][figure]);
        let normal = (design.transpose() * &design).cholesky()?;
        let (coefficients, covariances) = (normal.solve(&(design.transpose() * &values)), normal.inverse());
        let left = &values - &design * &coefficients;
        let free = places.len().checked_sub(TERMS).filter(|&free| free > 0)? as f64;
        let deviation = |figure| (left.column(figure).norm_squared() / free).sqrt().max(1e-9);
        let deviations = (0..count).map(deviation).collect();
        Some(Self { coefficients, covariances, deviations })
    }

    /// Figures at a place.
    pub(super) fn at(&self, place: &[f64; COUNT]) -> Figures {
        let found = DVector::from_row_slice(&terms(place)).transpose() * &self.coefficients;
        found.iter().copied().collect()
    }

    /// How they change along each trait.
    fn slopes(&self, place: &[f64; COUNT]) -> [Figures; COUNT] {
        let slopes = gradients(place) * &self.coefficients;
        std::array::from_fn(|number| slopes.row(number).iter().copied().collect())
    }

    /// The place within `reach` of another where the figures are nearest to these, whose own deviations are so many times those of a nature.
    pub(super) fn nearest(&self, figures: &Figures, about: [f64; COUNT], reach: f64, more: f64) -> Nearest {
        let [low, high] = [-reach, reach].map(|far| about.map(|x| (x + far).clamp(-1.0, 1.0)));
        let starts = places(STARTS, about, reach).into_iter().chain([about]);
        let ends = starts.map(|start| self.descend(figures, start, [low, high]));
        let place = ends.min_by(|a, b| self.squared(figures, a).total_cmp(&self.squared(figures, b))).unwrap_or(about);
        Nearest { place, errors: self.variances(figures, &place).map(|variance| (variance * more).sqrt()) }
    }

    /// Squared standard errors of a place that was found.
    fn variances(&self, figures: &Figures, place: &[f64; COUNT]) -> [f64; COUNT] {
        let (normal, _) = self.normal(figures, place);
        // Slopes are known by chance, too: what of them is chance alone tells nothing of a place.
        let gradients = gradients(place);
        let chance = &gradients * &self.covariances * gradients.transpose() * figures.len() as f64;
        let told = SMatrix::<f64, COUNT, COUNT>::from_fn(|row, column| normal[(row, column)] - chance[(row, column)]);
        let mut parts = told.symmetric_eigen();
        parts.eigenvalues.apply(|value| *value = value.max(LEAST_TOLD).recip());
        let variances = parts.recompose();
        std::array::from_fn(|k| variances[(k, k)])
    }

    /// Squared distance from figures, in deviations.
    fn squared(&self, figures: &Figures, place: &[f64; COUNT]) -> f64 {
        self.off(figures, place).iter().map(|x| x * x).sum()
    }

    fn off(&self, figures: &Figures, place: &[f64; COUNT]) -> Figures {
        let found = self.at(place);
        let off = figures.iter().zip(&found).zip(&self.deviations);
        off.map(|((sought, found), deviation)| (sought - found) / deviation).collect()
    }

    /// The normal equations of a step: matrix and right side.
    fn normal(&self, figures: &Figures, place: &[f64; COUNT]) -> (SMatrix<f64, COUNT, COUNT>, SVector<f64, COUNT>) {
        let (off, slopes) = (self.off(figures, place), self.slopes(place));
        let scaled =
            slopes.map(|own| own.iter().zip(&self.deviations).map(|(slope, deviation)| slope / deviation).collect());
        let product = |a: &Figures, b: &Figures| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        (
            SMatrix::from_fn(|row, column| product(&scaled[row], &scaled[column])),
            SVector::from_fn(|row, _| product(&scaled[row], &off)),
        )
    }

    /// Downhill within bounds (Levenberg 1944, doi 10.1090/qam/10666): steps as long as they bring something.
    fn descend(&self, figures: &Figures, start: [f64; COUNT], [low, high]: [[f64; COUNT]; 2]) -> [f64; COUNT] {
        let (mut place, mut damping) = (start, 1e-2);
        for _ in 0..ROUNDS {
            let (mut normal, right) = self.normal(figures, &place);
            for k in 0..COUNT {
                normal[(k, k)] += damping * normal[(k, k)].max(1e-9);
            }
            let Some(step) = normal.cholesky().map(|factor| factor.solve(&right)) else { break };
            let next = std::array::from_fn(|k| (place[k] + step[k]).clamp(low[k], high[k]));
            if self.squared(figures, &next) < self.squared(figures, &place) {
                (place, damping) = (next, 0.3 * damping);
            } else {
                damping *= 4.0;
            }
        }
        place
    }
}

/// How each term changes along each trait, (traits, terms).
fn gradients(place: &[f64; COUNT]) -> DMatrix<f64> {
    // The middle difference of a polynomial of the second degree is its slope.
    let difference = |number: usize| {
        let [low, high] = [-1.0, 1.0].map(|step| {
            let mut there = *place;
            there[number] += step;
            terms(&there)
        });
        std::array::from_fn::<f64, TERMS, _>(|term| 0.5 * (high[term] - low[term]))
    };
    let all: [[f64; TERMS]; COUNT] = std::array::from_fn(difference);
    DMatrix::from_fn(COUNT, TERMS, |number, term| all[number][term])
}

fn terms(place: &[f64; COUNT]) -> [f64; TERMS] {
    let mut all = [1.0; TERMS];
    all[1..=COUNT].copy_from_slice(place);
    let products = (0..COUNT).flat_map(|a| (a..COUNT).map(move |b| place[a] * place[b]));
    all[1 + COUNT..].iter_mut().zip(products).for_each(|(term, product)| *term = product);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figures of a nature, of which each knows something of two traits or three.
    fn known(place: &[f64; COUNT]) -> Figures {
        let [a, b, c, d] = *place;
        let figure = |figure| match figure {
            0 => a + 0.5 * b,
            1 => b - 0.3 * c + 0.2 * b * b,
            2 => c + 0.4 * d,
            3 => d - 0.5 * a + 0.3 * a * d,
            _ => figure as f64 + 0.1 * (a + b + c + d),
        };
        (0..10).map(figure).collect()
    }

    #[test]
    fn a_place_is_found_by_its_figures() {
        let tried = places(40, [0.0; COUNT], 1.0);
        let found: Vec<Figures> = tried.iter().map(known).collect();
        let surface = Surface::through(&tried, &found).unwrap();
        let sought = [0.3, -0.55, 0.8, -0.2];
        let nearest = surface.nearest(&known(&sought), [0.0; COUNT], 1.0, 1.0);
        assert!(nearest.place.iter().zip(sought).all(|(a, b)| (a - b).abs() < 1e-4), "{:?}", nearest.place);
        assert!(nearest.errors.iter().all(|&error| error < 1e-4), "{:?}", nearest.errors);
    }

    #[test]
    fn what_no_figure_depends_on_is_not_known() {
        let tried = places(40, [0.0; COUNT], 1.0);
        // Chance in every figure, and none that knows the last trait.
        let blind = |(index, place): (usize, &[f64; COUNT])| {
            let chance = 0.02 * ((index * 7919) % 101) as f64 / 101.0;
            known(&[place[0], place[1], place[2], 0.0]).iter().map(|x| x + chance).collect()
        };
        let found: Vec<Figures> = tried.iter().enumerate().map(blind).collect();
        let surface = Surface::through(&tried, &found).unwrap();
        let nearest = surface.nearest(&known(&[0.1, 0.2, 0.3, 0.0]), [0.0; COUNT], 1.0, 1.0);
        let [.., last] = nearest.errors;
        assert!(last > 0.5 && nearest.errors[..3].iter().all(|&error| error < 0.1), "{:?}", nearest.errors);
    }

    #[test]
    fn fewer_natures_than_terms_have_no_surface() {
        let tried = places(TERMS, [0.0; COUNT], 1.0);
        let found: Vec<Figures> = tried.iter().map(known).collect();
        assert!(Surface::through(&tried, &found).is_none());
    }
}
