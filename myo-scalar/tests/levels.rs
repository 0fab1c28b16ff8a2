//! Every level must agree with the standard library's f64, and all levels draw the same integers.

use myo_scalar::{
    Counter, LaneTask, Level, Mask, Scalar, Word, atan2, dispatch, normal_pair, open_unit, philox, philox_block,
    seed_words, unit,
};
use proptest::prelude::*;

/// Applies one function of two numbers to padded slices.
struct Map<'a, F> {
    a: &'a [f32],
    b: &'a [f32],
    f: F,
}

trait Function {
    fn apply<S: Scalar>(&self, a: S, b: S) -> S;
}

impl<F: Function> LaneTask for Map<'_, F> {
    type Output = Vec<f32>;
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Vec<f32> {
        let mut out = vec![f32::NAN; self.a.len()];
        for i in (0..self.a.len()).step_by(S::LANES) {
            self.f.apply(S::load(&self.a[i..]), S::load(&self.b[i..])).store(&mut out[i..]);
        }
        out
    }
}

macro_rules! function {
    ($name:ident, |$a:ident, $b:ident| $e:expr) => {
        #[derive(Clone, Copy)]
        struct $name;
        impl Function for $name {
            #[inline(always)]
            fn apply<S: Scalar>(&self, $a: S, $b: S) -> S {
                $e
            }
        }
    };
}
function!(Sin, |a, _b| a.sin_cos().0);
function!(Cos, |a, _b| a.sin_cos().1);
function!(Exp, |a, _b| a.exp());
function!(Ln, |a, _b| a.ln());
function!(Rsqrt, |a, _b| a.rsqrt());
function!(Recip, |a, _b| a.recip());
function!(Sqrt, |a, _b| a.sqrt());
function!(Floor, |a, _b| a.floor());
function!(Angle, |a, b| atan2(a, b));
function!(Fused, |a, b| a.mul_add(b, a - b));
function!(Chosen, |a, b| S::select(a.lt(b) | !b.le(a), -a.abs(), b.min(a)));
function!(Blend, |a, b| S::select(a.lt(b) & S::zero().lt(a), a.max(b), b));

const SIZE: usize = 32;

fn check<F: Function + Copy>(f: F, a: &[f32], b: &[f32], relative: f64, absolute: f64) {
    for level in Level::available() {
        let out = dispatch(level, Map { a, b, f });
        for i in 0..a.len() {
            let want = f.apply(f64::from(a[i]), f64::from(b[i]));
            let error = (f64::from(out[i]) - want).abs();
            assert!(error <= absolute + relative * want.abs(), "{level:?} {}: {} for {want}", a[i], out[i]);
        }
    }
}

proptest! {
    #[test]
    fn elementary_functions_agree_with_f64(
        angle in prop::collection::vec(-60.0f32..60.0, SIZE),
        exponent in prop::collection::vec(-80.0f32..80.0, SIZE),
        positive in prop::collection::vec(1e-6f32..1e6, SIZE),
    ) {
        check(Sin, &angle, &angle, 0.0, 2e-7);
        check(Cos, &angle, &angle, 0.0, 2e-7);
        check(Exp, &exponent, &exponent, 3e-7, 0.0);
        check(Ln, &positive, &positive, 2e-7, 1e-7);
        check(Rsqrt, &positive, &positive, 3e-7, 0.0);
        check(Recip, &positive, &positive, 3e-7, 0.0);
        check(Sqrt, &positive, &positive, 2e-7, 0.0);
        check(Floor, &angle, &angle, 0.0, 0.0);
    }

    #[test]
    fn angles_agree_with_the_standard_library(
        y in prop::collection::vec(-2.0f32..2.0, SIZE),
        x in prop::collection::vec(-2.0f32..2.0, SIZE),
        size in -12..12,
    ) {
        check(Angle, &y, &x, 0.0, 3e-7);
        for (&y, &x) in y.iter().zip(&x) {
            let (y, x) = (f64::from(y) * 10_f64.powi(size), f64::from(x));
            prop_assert!((atan2(y, x) - y.atan2(x)).abs() < 1e-15, "{y} {x}: {} for {}", atan2(y, x), y.atan2(x));
        }
    }

    #[test]
    fn comparisons_and_fused_products_agree_with_f64(
        a in prop::collection::vec(-2.0f32..2.0, SIZE),
        b in prop::collection::vec(-2.0f32..2.0, SIZE),
    ) {
        check(Fused, &a, &b, 1e-6, 1e-6);
        check(Chosen, &a, &b, 0.0, 0.0);
        check(Blend, &a, &b, 0.0, 0.0);
    }
}

/// Integers of consecutive environments, and the numbers made from them.
struct Draw {
    seed: u64,
    first_env: u32,
}

impl LaneTask for Draw {
    type Output = (Vec<[u32; 4]>, Vec<f32>);
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output {
        let (mut words, mut normals) = (vec![[0; 4]; SIZE], vec![0.0; SIZE]);
        for i in (0..SIZE).step_by(S::LANES) {
            let mut env = [0u32; SIZE];
            for (lane, e) in env.iter_mut().enumerate() {
                *e = self.first_env + (i + lane) as u32;
            }
            let block = philox::<S>(Counter {
                seed: seed_words(self.seed),
                env: S::Word::load(&env),
                episode: S::Word::splat(7),
                step: S::Word::splat(11),
                stream: S::Word::splat(3),
            });
            for (k, word) in block.into_iter().enumerate() {
                let mut lane_words = [0u32; SIZE];
                word.store(&mut lane_words);
                for lane in 0..S::LANES {
                    words[i + lane][k] = lane_words[lane];
                }
            }
            normal_pair::<S>(block[0], block[1]).0.store(&mut normals[i..]);
        }
        (words, normals)
    }
}

#[test]
fn philox_integers_equal_the_reference_library_at_every_level() {
    for level in Level::available() {
        let seed = 0x0123_4567_89ab_cdefu64;
        let (words, _) = dispatch(level, Draw { seed, first_env: 100 });
        for (i, got) in words.iter().enumerate() {
            let key = [seed as u32, (seed >> 32) as u32];
            // The library counts with one 128-bit number whose lowest word is the first of the block.
            let counter = 3 | 11 << 32 | 7 << 64 | (100 + i as u128) << 96;
            let mut library = rand_philox::Philox::new(key, counter);
            let want = std::array::from_fn(|_| library.next_u32());
            assert_eq!(*got, want, "{level:?}, environment {i}");
        }
    }
}

/// One block, the same in every lane.
struct Block {
    key: [u32; 2],
    counter: [u32; 4],
}

impl LaneTask for Block {
    type Output = Vec<[u32; 4]>;
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) -> Self::Output {
        let words = philox_block::<S>(self.key.map(S::Word::splat), self.counter.map(S::Word::splat));
        let lanes = words.map(|word| {
            let mut lanes = [0; SIZE];
            word.store(&mut lanes);
            lanes
        });
        (0..S::LANES).map(|lane| lanes.map(|words| words[lane])).collect()
    }
}

/// The vectors that the authors publish with Random123 (`kat_vectors`, lines `philox4x32 10`).
#[test]
fn philox_gives_the_published_known_answers_at_every_level() {
    let pi = [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344];
    let known = [
        ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
        ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
        (pi, [0xa409_3822, 0x299f_31d0], [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1]),
    ];
    for (counter, key, answer) in known {
        for level in Level::available() {
            let lanes = dispatch(level, Block { key, counter });
            assert_eq!(lanes, vec![answer; level.lanes()], "{}", level.name());
        }
        let alone = Block { key, counter }.run::<f32>();
        assert_eq!(alone, [answer]);
    }
}

#[test]
fn normal_draws_have_zero_mean_unit_variance_and_agree_between_levels() {
    let all: Vec<(Level, Vec<f32>)> = Level::available()
        .into_iter()
        .map(|level| {
            let mut draws = vec![];
            for block in 0..500 {
                draws.extend(dispatch(level, Draw { seed: 5, first_env: block * SIZE as u32 }).1);
            }
            (level, draws)
        })
        .collect();
    let n = all[0].1.len() as f32;
    for (level, draws) in &all {
        let mean = draws.iter().sum::<f32>() / n;
        let variance = draws.iter().map(|x| (x - mean).powi(2)).sum::<f32>() / n;
        assert!(mean.abs() < 4.0 / n.sqrt(), "{level:?}: mean {mean}");
        assert!((variance - 1.0).abs() < 6.0 / n.sqrt(), "{level:?}: variance {variance}");
        for (a, b) in draws.iter().zip(&all[0].1) {
            assert!((a - b).abs() < 2e-6 * (1.0 + b.abs()), "{level:?}: {a} {b}");
        }
    }
}

#[test]
fn unit_draws_stay_in_the_half_open_interval() {
    for word in [0, 1, 255, 256, u32::MAX] {
        let x: f64 = unit(<f64 as Scalar>::Word::splat(word));
        assert!((0.0..1.0).contains(&x));
    }
}

#[test]
fn open_unit_draws_are_never_zero_or_one() {
    let draw = |word| open_unit::<f32>(<f32 as Scalar>::Word::splat(word));
    assert_eq!([0, 511, 512].map(draw), [0.5 / 8_388_608.0, 0.5 / 8_388_608.0, 1.5 / 8_388_608.0]);
    assert_eq!(f64::from(draw(u32::MAX)), 1.0 - 0.5 / 8_388_608.0);
}

#[test]
fn masks_answer_any() {
    assert!(<bool as Mask>::splat(true).any());
    assert!(!<bool as Mask>::splat(false).any());
}

/// Whatever a caller gets hold of can run, with the lanes that it names.
#[test]
fn a_level_is_one_that_this_processor_runs() {
    struct Lanes;
    impl LaneTask for Lanes {
        type Output = usize;
        #[inline(always)]
        fn run<S: Scalar<Const = f32>>(self) -> usize {
            S::LANES
        }
    }
    let names = ["portable", "avx2", "avx512", "sse", ""];
    let named: Vec<Level> = names.into_iter().filter_map(|name| Level::named(name).ok()).collect();
    assert_eq!(named, Level::available());
    assert_eq!(named[0].name(), "portable");
    assert!(Level::available().contains(&Level::current()));
    for level in named {
        assert_eq!(dispatch(level, Lanes), level.lanes(), "{}", level.name());
    }
}

function!(Gather, |a, b| S::gather(5, |k| [b * S::lit(k as f64)], a)[0]);

#[test]
fn rows_are_gathered_lane_by_lane_and_kept_within_the_table() {
    let index: Vec<f32> = (0..64).map(|k| (k % 9) as f32 - 2.0).collect();
    let values: Vec<f32> = (0..64).map(|k| 1.0 + k as f32).collect();
    for level in Level::available() {
        let out = dispatch(level, Map { a: &index, b: &values, f: Gather });
        for ((got, index), value) in out.iter().zip(&index).zip(&values) {
            assert_eq!(*got, value * index.clamp(0.0, 4.0), "{}", level.name());
        }
    }
}

function!(Alone, |a, b| S::lane_by_lane(a.lt(b), [a, b], |&[a, b]| {
    assert!(a < b, "there is no work where the mask is false");
    [f64::NAN, (b - a).exp()]
})[1]);

#[test]
fn work_is_done_lane_by_lane_where_it_is_asked_for() {
    let (a, b): (Vec<f32>, Vec<f32>) = (0..SIZE).map(|k| (0.1 * (k % 7) as f32, 0.03 * (k % 23) as f32)).unzip();
    for level in Level::available() {
        let out = dispatch(level, Map { a: &a, b: &b, f: Alone });
        for ((got, a), b) in out.iter().zip(&a).zip(&b) {
            let wanted = if a < b { (f64::from(*b) - f64::from(*a)).exp() as f32 } else { 0.0 };
            assert_eq!(*got, wanted, "{}", level.name());
        }
    }
    assert_eq!(f64::lane_by_lane(true, [2.0], |&[x]| [x, 3.0 * x]), [2.0, 6.0]);
    assert_eq!(f64::lane_by_lane(false, [2.0], |_| -> [f64; 2] { unreachable!() }), [0.0; 2]);
}

#[test]
fn angles_of_the_axes_and_of_next_to_nothing() {
    let along = [0.0_f64, 1.0, -1.0, 1e-20, -1e-20, 0.5];
    for (y, x) in along.into_iter().flat_map(|y| along.map(|x| (y, x))).filter(|&(y, x)| y != 0.0 || x != 0.0) {
        assert!((atan2(y, x) - y.atan2(x)).abs() < 4e-7 || y.hypot(x) < 1e-15, "{y} {x}: {}", atan2(y, x));
        assert!(atan2(y, x).is_finite(), "{y} {x}");
    }
    assert_eq!(atan2(0.0, 0.0), 0.0);
    for level in Level::available() {
        let (y, x) = ([0.0_f32; SIZE], [0.0_f32; SIZE]);
        assert_eq!(dispatch(level, Map { a: &y, b: &x, f: Angle }), [0.0; SIZE]);
    }
    // Small angles keep all their digits.
    for power in 1..12 {
        let y = 10_f64.powi(-power);
        assert!((atan2(y, 1.0) / y.atan() - 1.0).abs() < 4e-16, "{y}");
        assert!((f64::from(atan2(y as f32, 1.0_f32)) / f64::from(y as f32).atan() - 1.0).abs() < 2e-7, "{y}");
    }
}
