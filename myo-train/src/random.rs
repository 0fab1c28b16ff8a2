//! Random numbers that depend on nothing but their address: seed, stream, step and position.
//!
//! Philox4x32-10 of Salmon et al. 2011 (doi 10.1145/2063384.2063405): ten rounds of multiply and exchange turn a
//! 128-bit counter and a 64-bit key into 128 random bits. Any number can be drawn at any time in any order, so results
//! do not depend on threads and a resumed run needs no more state than its step counter.

use crate::simd::{kernels, ln, madd, sin_cos_turns};

/// What the numbers are for; streams with the same seed are independent of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// Initial weights.
    Weights = 1,
    /// Exploration noise.
    Actions = 2,
    /// Order of the samples in the minibatches.
    Shuffle = 3,
}

/// Numbers drawn side by side, so that the rounds vectorise.
const WIDTH: usize = 16;

/// Ten Philox rounds over `WIDTH` counters that differ in their first word.
#[inline(always)]
fn philox(seed: u64, first: u32, counter: [u32; 3]) -> [[u32; WIDTH]; 4] {
    let mut key = [seed as u32, (seed >> 32) as u32];
    let [mut x0, mut x1, mut x2, mut x3] = [[0; WIDTH], [counter[0]; WIDTH], [counter[1]; WIDTH], [counter[2]; WIDTH]];
    for (lane, word) in x0.iter_mut().enumerate() {
        *word = first.wrapping_add(lane as u32);
    }
    for _ in 0..10 {
        for (((x0, x1), x2), x3) in x0.iter_mut().zip(&mut x1).zip(&mut x2).zip(&mut x3) {
            let a = u64::from(*x0) * 0xD251_1F53;
            let b = u64::from(*x2) * 0xCD9E_8D57;
            *x0 = (b >> 32) as u32 ^ *x1 ^ key[0];
            *x1 = b as u32;
            *x2 = (a >> 32) as u32 ^ *x3 ^ key[1];
            *x3 = a as u32;
        }
        key = [key[0].wrapping_add(0x9E37_79B9), key[1].wrapping_add(0xBB67_AE85)];
    }
    [x0, x1, x2, x3]
}

/// Uniform in (0, 1), never 0, so that its logarithm is finite.
#[inline(always)]
fn open_unit(word: u32) -> f32 {
    ((word >> 9) as f32 + 0.5) * (1.0 / 8_388_608.0)
}

kernels! {
    /// Fills `out` with independent standard normal numbers (Box and Muller, doi 10.1214/aoms/1177706645).
    ///
    /// Blocks of four numbers are counted from `first_block`, so a long sequence may be filled piece by piece.
    pub fn fill_normal<const FMA: bool>(seed: u64, stream: Stream, step: u64, first_block: u32, out: &mut [f32]) {
        let counter = [step as u32, (step >> 32) as u32, stream as u32];
        for (group, out) in out.chunks_mut(4 * WIDTH).enumerate() {
            let words = philox(seed, first_block.wrapping_add((group * WIDTH) as u32), counter);
            let mut normal = [[0.0_f32; 4]; WIDTH];
            for (lane, normal) in normal.iter_mut().enumerate() {
                for pair in 0..2 {
                    let radius = (-2.0 * ln::<FMA>(open_unit(words[2 * pair][lane]))).sqrt();
                    let (sin, cos) = sin_cos_turns::<FMA>(open_unit(words[2 * pair + 1][lane]));
                    normal[2 * pair] = madd::<FMA>(radius, cos, 0.0);
                    normal[2 * pair + 1] = madd::<FMA>(radius, sin, 0.0);
                }
            }
            let flat = normal.as_flattened();
            out.copy_from_slice(&flat[..out.len()]);
        }
    }

    /// Fills `out` with uniform 32-bit words, counted as in [`fill_normal`].
    pub fn fill_words<const FMA: bool>(seed: u64, stream: Stream, step: u64, out: &mut [u32]) {
        let counter = [step as u32, (step >> 32) as u32, stream as u32];
        for (group, out) in out.chunks_mut(4 * WIDTH).enumerate() {
            let words = philox(seed, (group * WIDTH) as u32, counter);
            for (out, word) in out.iter_mut().zip(words.as_flattened()) {
                *out = *word;
            }
        }
    }
}

/// Writes a random order of `0..order.len()` (Fisher and Yates); `words` is memory of the same length.
pub fn shuffle(seed: u64, step: u64, order: &mut [u32], words: &mut [u32]) {
    fill_words(seed, Stream::Shuffle, step, words);
    for (index, slot) in order.iter_mut().enumerate() {
        *slot = index as u32;
    }
    for last in (1..order.len()).rev() {
        // The high part of a product is a draw from 0..=last, even to one part in 2^32 / (last + 1).
        let pick = (u64::from(words[last]) * (last as u64 + 1)) >> 32;
        order.swap(last, pick as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First known answer of the authors' test vectors, counters and keys of zeros and of ones.
    #[test]
    fn philox_gives_the_published_known_answers() {
        let zeros = philox(0, 0, [0, 0, 0]);
        assert_eq!(zeros.map(|w| w[0]), [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]);
        let ones = philox(u64::MAX, u32::MAX, [u32::MAX; 3]);
        assert_eq!(ones.map(|w| w[0]), [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]);
    }

    #[test]
    fn normal_numbers_have_the_right_moments_and_do_not_depend_on_the_pieces() {
        let mut all = vec![0.0; 400_000];
        fill_normal(7, Stream::Actions, 3, 0, &mut all);
        let n = all.len() as f64;
        let moment = |p: i32| all.iter().map(|&x| f64::from(x).powi(p)).sum::<f64>() / n;
        assert!(moment(1).abs() < 0.006, "mean {}", moment(1));
        assert!((moment(2) - 1.0).abs() < 0.01, "variance {}", moment(2));
        assert!(moment(3).abs() < 0.03, "skew {}", moment(3));
        assert!((moment(4) - 3.0).abs() < 0.08, "kurtosis {}", moment(4));

        let mut piece = vec![0.0; 40];
        fill_normal(7, Stream::Actions, 3, 11, &mut piece);
        assert_eq!(piece, all[44..84]);
    }

    #[test]
    fn shuffle_is_a_permutation_that_depends_on_seed_and_step() {
        let shuffled = |seed, step| {
            let (mut order, mut words) = (vec![0; 1000], vec![0; 1000]);
            shuffle(seed, step, &mut order, &mut words);
            order
        };
        let orders = [shuffled(1, 5), shuffled(1, 6), shuffled(2, 5)];
        assert!(orders[0] != orders[1] && orders[0] != orders[2] && orders[1] != orders[2]);
        assert_eq!(shuffled(1, 5), orders[0]);
        for mut order in orders {
            // In a random order, a thousandth of all stays where it was: one, and hardly ever ten.
            assert!(order.iter().enumerate().filter(|&(i, &x)| i == x as usize).count() < 10);
            order.sort_unstable();
            assert!(order.iter().enumerate().all(|(i, &x)| i == x as usize));
        }
    }
}
