//! Figures as smooth functions of traits, and the place where they are nearest to some.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use myo_measure::statistics::student_quantile;

use super::figures::{Figures, least};
use super::nature::{COUNT, places};

/// Terms of a polynomial of the second degree: 1, each trait, each product of two.
pub(super) const TERMS: usize = 1 + COUNT + COUNT * (COUNT + 1) / 2;
/// Places from which the nearest is looked for.
const STARTS: usize = 24;
const ROUNDS: usize = 60;
/// What is known of a place beforehand, as the reciprocal of a squared standard error: that it is anything from -1 to 1.
const LEAST_TOLD: f64 = 3.0;

/// Freedom that the mean over figures counts as, where the deviation of one between trainings is estimated.
const SHARED_FREEDOM: f64 = 2.0;

/// Polynomials of the second degree through the figures of some natures, by least squares, and how far what is known of them can be trusted: of what the polynomials leave over, and of how far one
/// training is from another in all places alike.
pub(super) struct Surface {
    /// A column for each figure.
    coefficients: DMatrix<f64>,
    /// Covariances of the coefficients of a figure, in its squared deviations.
    covariances: DMatrix<f64>,
    /// How far the users of each training are off, (trainings, figures).
    offsets: DMatrix<f64>,
    /// Degrees of freedom of what is left.
    free: f64,
    /// Variances of each figure of one nature about its polynomial, by chance and by what that does not know; of a person, by as many movements as natures made.
    pub within: Figures,
    /// Variances of each figure between trainings.
    pub between: Figures,
    /// Standard deviations of a person, who learnt apart from all of these, from the middle of all trainings.
    pub deviations: Figures,
}

/// What natures did: where they are, of which training each is, and their figures.
#[derive(Default)]
pub(super) struct Samples {
    pub places: Vec<[f64; COUNT]>,
    pub trainings: Vec<usize>,
    pub figures: Vec<Figures>,
}

/// A place, and how sure it is.
pub(super) struct Nearest {
    pub place: [f64; COUNT],
    /// How far the 95 % confidence interval of each coordinate reaches to either side.
    pub reaches: [f64; COUNT],
}

/// Squared standard errors of a coordinate: by chance, and by what one training does and another does not.
#[derive(Clone, Copy)]
struct Errors {
    chance: f64,
    training: f64,
}

impl Surface {
    /// Through at least one nature more than there are terms and further trainings, some of each training; none where they lie in a plane. `more`: how many times the variances of figures of one nature those of what
    /// is to be compared are.
    pub(super) fn through(samples: &Samples, trainings: usize, more: f64) -> Option<Self> {
        let Samples { places, trainings: of, figures: found } = samples;
        if !(0..trainings).all(|training| of.contains(&training)) {
            return None;
        }
        let columns = TERMS + trainings - 1;
        let design = DMatrix::from_fn(places.len(), columns, |row, column| match column.checked_sub(TERMS) {
            None => terms(&places[row])[column],
            Some(other) => of_training(of[row], other),
        });
        let count = found.first()?.len();
        let values = DMatrix::from_fn(found.len(), count, |row, figure| found[row][figure]);
        let normal = (design.transpose() * &design).cholesky()?;
        let (solved, inverse) = (normal.solve(&(design.transpose() * &values)), normal.inverse());
        let left = &values - &design * &solved;
        let free = places.len().checked_sub(columns).filter(|&free| free > 0)? as f64;
        let variance = |figure: usize| (left.column(figure).norm_squared() / free).max(least(figure).powi(2));
        let within: Figures = (0..count).map(variance).collect();
        let contrasts = DMatrix::from_fn(trainings, columns - TERMS, of_training);
        let offsets = &contrasts * solved.rows(TERMS, columns - TERMS);
        let chance =
            (&contrasts * inverse.view((TERMS, TERMS), (columns - TERMS, columns - TERMS)) * contrasts.transpose())
                .trace();
        let between = between(&offsets, &within, chance);
        let apart = 1.0 + 1.0 / trainings as f64;
        let deviations = within.iter().zip(&between).map(|(own, other)| (own * more + other * apart).sqrt()).collect();
        let coefficients = solved.rows(0, TERMS).into_owned();
        let covariances = inverse.view((0, 0), (TERMS, TERMS)).into_owned();
        Some(Self { coefficients, covariances, offsets, free, within, between, deviations })
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

    /// The place within `reach` of another where the figures are nearest to these.
    pub(super) fn nearest(&self, figures: &Figures, about: [f64; COUNT], reach: f64) -> Nearest {
        let [low, high] = [-reach, reach].map(|far| about.map(|x| (x + far).clamp(-1.0, 1.0)));
        let starts = places(STARTS, about, reach).into_iter().chain([about]);
        let ends = starts.map(|start| self.descend(figures, start, [low, high]));
        let place = ends.min_by(|a, b| self.squared(figures, a).total_cmp(&self.squared(figures, b))).unwrap_or(about);
        Nearest { place, reaches: self.errors(figures, &place).map(|errors| self.reach(errors)) }
    }

    /// How sure a place is that was found.
    fn errors(&self, figures: &Figures, place: &[f64; COUNT]) -> [Errors; COUNT] {
        let (normal, _) = self.normal(figures, place);
        // Slopes are known by chance, too: what of them is chance alone tells nothing of a place.
        let gradients = gradients(place);
        let shares: f64 = self.within.iter().zip(&self.deviations).map(|(own, all)| own / (all * all)).sum();
        let chance = &gradients * &self.covariances * gradients.transpose() * shares;
        let told = SMatrix::<f64, COUNT, COUNT>::from_fn(|row, column| normal[(row, column)] - chance[(row, column)]);
        let mut parts = told.symmetric_eigen();
        parts.eigenvalues.apply(|value| *value = value.max(LEAST_TOLD).recip());
        let variances = parts.recompose();
        let trainings = self.offsets.nrows();
        std::array::from_fn(|k| {
            let moved = self.moved(place, &variances, k);
            let sum = |of: &dyn Fn(usize) -> f64| moved.iter().enumerate().map(|(i, by)| by * by * of(i)).sum::<f64>();
            let (all, between) = (sum(&|i| self.deviations[i].powi(2)), sum(&|i| self.apart() * self.between[i]));
            // What is known of a place beforehand is no matter of trainings; nor can they be more than all that is unknown.
            let of_trainings = between * (variances[(k, k)] / all.max(f64::MIN_POSITIVE)).min(1.0);
            // Figures are off together, so that by how much a place is is seen of each training as a whole.
            let off =
                |training: usize| moved.iter().enumerate().map(|(i, by)| by * self.offsets[(training, i)]).sum::<f64>();
            let squares: f64 = (0..trainings).map(|training| off(training).powi(2)).sum();
            let training = if trainings > 1 { self.apart() * squares / (trainings - 1) as f64 } else { 0.0 };
            // So few trainings seem alike by luck, and the same luck has given their figures their weight.
            Errors { chance: variances[(k, k)] - of_trainings, training: training.max(of_trainings) }
        })
    }

    /// How many times the variance between trainings that of one more from the middle of these is.
    fn apart(&self) -> f64 {
        1.0 + 1.0 / self.offsets.nrows() as f64
    }

    /// By how much a coordinate that is found moves for each figure that is off by 1.
    fn moved(&self, place: &[f64; COUNT], variances: &SMatrix<f64, COUNT, COUNT>, coordinate: usize) -> Figures {
        let slopes = self.slopes(place);
        let of = |(figure, deviation): (usize, &f64)| {
            (0..COUNT).map(|j| variances[(coordinate, j)] * slopes[j][figure]).sum::<f64>() / (deviation * deviation)
        };
        self.deviations.iter().enumerate().map(of).collect()
    }

    /// Half a 95 % interval, by Student's distribution with as much freedom as both kinds of errors have together (Satterthwaite 1946, doi 10.2307/3002019).
    fn reach(&self, Errors { chance, training }: Errors) -> f64 {
        let between = (self.offsets.nrows() as f64 - 1.0).max(1.0);
        let freedom = (chance + training).powi(2) / (chance * chance / self.free + training * training / between);
        student_quantile(freedom) * (chance + training).sqrt()
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

/// Trainings are told apart by how far each further one is from the first, all of them together being off by nothing.
fn of_training(training: usize, other: usize) -> f64 {
    match training {
        0 => -1.0,
        _ if training == other + 1 => 1.0,
        _ => 0.0,
    }
}

/// Variances of each figure between trainings, of how far each is off. A few trainings tell little of one figure: the mean over all, in variances of that figure within a training, counts with it.
/// `chance`: sum of the variances of what they are off, as far as they are so by chance, in those of a figure.
fn between(offsets: &DMatrix<f64>, within: &Figures, chance: f64) -> Figures {
    let freedom = offsets.nrows() as f64 - 1.0;
    if freedom < 1.0 {
        return vec![0.0; within.len()];
    }
    let ratio =
        |(figure, own): (usize, &f64)| (offsets.column(figure).norm_squared() / own - chance).max(0.0) / freedom;
    let ratios: Vec<f64> = within.iter().enumerate().map(ratio).collect();
    let middle = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let shared = |ratio: f64| (freedom * ratio + SHARED_FREEDOM * middle) / (freedom + SHARED_FREEDOM);
    within.iter().zip(ratios).map(|(own, ratio)| own * shared(ratio)).collect()
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

    fn of_one_training(places: Vec<[f64; COUNT]>, figures: Vec<Figures>) -> Option<Surface> {
        let trainings = vec![0; places.len()];
        Surface::through(&Samples { places, trainings, figures }, 1, 1.0)
    }

    /// An even number from -0.5 to 0.5 (SplitMix64).
    fn even(seed: u64) -> f64 {
        let mut z = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }

    /// Figures of users whose training adds to each, whoever learns, and of a person of one training more: how many coordinates there are, lie in their intervals, are told, and are both.
    fn of_another_training(trainings: usize, runs: u64) -> [usize; 4] {
        let (tried, mut counts) = (places(64, [0.0; COUNT], 1.0), [0; 4]);
        for (run, sought) in (0..runs).zip(places(runs as usize, [0.0; COUNT], 0.8)) {
            let of = |place: &[f64; COUNT], training: usize, index: usize| -> Figures {
                let seed = |part: usize, figure: usize| run << 32 | (part as u64) << 8 | figure as u64;
                let added = |k: usize| 0.6 * even(seed(training, k)) + 0.1 * even(seed(1000 + index, k));
                known(place).iter().enumerate().map(|(k, x)| x + added(k)).collect()
            };
            let numbers: Vec<usize> = (0..64).map(|n| n * trainings / 64).collect();
            let figures = tried.iter().zip(&numbers).enumerate().map(|(n, (place, &own))| of(place, own, n)).collect();
            let samples = Samples { places: tried.clone(), trainings: numbers, figures };
            let surface = Surface::through(&samples, trainings, 2.0).unwrap();
            let nearest = surface.nearest(&of(&sought, 500, 500), [0.0; COUNT], 1.0);
            for ((found, known), reach) in nearest.place.iter().zip(sought).zip(nearest.reaches) {
                let (inside, told) = ((found - known).abs() <= reach, reach < 0.5);
                let found = [true, inside, told, inside && told];
                counts.iter_mut().zip(found).for_each(|(count, one)| *count += usize::from(one));
            }
        }
        counts
    }

    #[test]
    fn people_of_another_training_lie_in_the_intervals() {
        for trainings in [2, 3, 6] {
            let [all, inside, told, both] = of_another_training(trainings, 60);
            assert!(inside * 100 >= 93 * all, "{trainings}: {inside} of {all}");
            assert!(both * 100 >= 90 * told, "{trainings}: {both} of {told} that are told");
            if trainings == 6 {
                // Nor is nothing told.
                assert!(told * 10 > all, "{told} of {all}");
            }
        }
    }

    #[test]
    fn a_place_is_found_by_its_figures() {
        let tried = places(40, [0.0; COUNT], 1.0);
        let found: Vec<Figures> = tried.iter().map(known).collect();
        let surface = of_one_training(tried, found).unwrap();
        let sought = [0.3, -0.55, 0.8, -0.2];
        let nearest = surface.nearest(&known(&sought), [0.0; COUNT], 1.0);
        assert!(nearest.place.iter().zip(sought).all(|(a, b)| (a - b).abs() < 1e-4), "{:?}", nearest.place);
        assert!(nearest.reaches.iter().all(|&reach| reach < 1e-4), "{:?}", nearest.reaches);
    }

    #[test]
    fn intervals_are_numbers_where_little_is_told() {
        let tried = places(40, [0.0; COUNT], 1.0);
        let chance = |index: usize, figure: usize| ((index * 7919 + 31 * figure) % 101) as f64 / 101.0;
        let noise = |index: usize| (0..6).map(|figure| chance(index, figure) + 2.0 * (index / 20) as f64).collect();
        let samples = Samples {
            trainings: (0..40).map(|index| index / 20).collect(),
            figures: (0..40).map(noise).collect(),
            places: tried,
        };
        let surface = Surface::through(&samples, 2, 1.0).unwrap();
        for sought in 0..20 {
            let figures = (0..6).map(|figure| chance(sought, figure) + 1.0).collect();
            let Nearest { reaches, .. } = surface.nearest(&figures, [0.0; COUNT], 1.0);
            assert!(reaches.iter().all(|reach| reach.is_finite() && *reach > 0.5), "{reaches:?}");
        }
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
        let surface = of_one_training(tried, found).unwrap();
        let nearest = surface.nearest(&known(&[0.1, 0.2, 0.3, 0.0]), [0.0; COUNT], 1.0);
        let [.., last] = nearest.reaches;
        assert!(last > 1.0 && nearest.reaches[..3].iter().all(|&reach| reach < 0.2), "{:?}", nearest.reaches);
    }

    #[test]
    fn a_training_whose_users_cannot_do_it_has_no_surface() {
        let tried = places(64, [0.0; COUNT], 1.0);
        let figures: Vec<Figures> = tried.iter().map(known).collect();
        for missing in 0..3 {
            let trainings = (0..64).map(|index| if index % 3 == missing { (missing + 1) % 3 } else { index % 3 });
            let samples = Samples { places: tried.clone(), trainings: trainings.collect(), figures: figures.clone() };
            assert!(Surface::through(&samples, 3, 1.0).is_none(), "{missing}");
        }
    }

    #[test]
    fn fewer_natures_than_terms_have_no_surface() {
        let tried = places(TERMS, [0.0; COUNT], 1.0);
        let found: Vec<Figures> = tried.iter().map(known).collect();
        assert!(of_one_training(tried, found).is_none());
    }
}
