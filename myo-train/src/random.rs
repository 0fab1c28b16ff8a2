//! Random numbers that depend on nothing but their address: seed, stream, step and position.
//!
//! The numbers are Philox's, as in the environments ([`myo_scalar::philox_block`]). Any can be drawn at any time in any
//! order, so results do not depend on threads and a resumed run needs no more state than its step counter.

use myo_scalar::{LaneTask, Level, Scalar, Word, dispatch, open_unit, philox_block, seed_words};

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

/// Blocks of four words that stand side by side in the order of the words.
const WIDTH: usize = 16;
/// Groups drawn at once: few calls, little memory.
const GROUPS: usize = 16;
/// Word `k` of `WIDTH` consecutive blocks.
type Group = [[u32; WIDTH]; 4];

/// Draws consecutive blocks from `first_block` on.
struct Draw<'a> {
    seed: u64,
    stream: Stream,
    step: u64,
    first_block: u32,
    groups: &'a mut [Group],
}

impl LaneTask for Draw<'_> {
    type Output = ();
    #[inline(always)]
    fn run<S: Scalar<Const = f32>>(self) {
        let key = seed_words(self.seed);
        let [low, high] = seed_words(self.step);
        let stream = S::Word::splat(self.stream as u32);
        let mut lanes = [0; WIDTH];
        lanes.iter_mut().zip(0..).for_each(|(lane, number)| *lane = number);
        let mut first = self.first_block;
        for group in self.groups {
            for lane in (0..WIDTH).step_by(S::LANES) {
                let block = S::Word::load(&lanes[lane..]) + S::Word::splat(first);
                let words = philox_block::<S>(key, [block, low, high, stream]);
                for (word, row) in words.into_iter().zip(group.iter_mut()) {
                    word.store(&mut row[lane..]);
                }
            }
            first = first.wrapping_add(WIDTH as u32);
        }
    }
}

/// Fills `out` with independent standard normal numbers (Box and Muller, doi 10.1214/aoms/1177706645).
///
/// Blocks of four numbers are counted from `first_block`, so a long sequence may be filled piece by piece.
pub fn fill_normal(seed: u64, stream: Stream, step: u64, first_block: u32, out: &mut [f32]) {
    in_groups(seed, stream, step, first_block, out, normals);
}

/// Fills `out` with the exploration noise that is left of earlier control steps: the sum of the draws of [`Stream::Actions`] in the
/// `steps - 1` steps before `step`, blocks counted from `first_block`.
pub fn fill_held(seed: u64, (step, steps): (u64, usize), first_block: u32, out: &mut [f32]) {
    out.fill(0.0);
    if steps == 1 {
        return;
    }
    let mut draw = [0.0; GROUPS * 4 * WIDTH];
    for (out, first) in out.chunks_mut(draw.len()).zip((first_block..).step_by(GROUPS * WIDTH)) {
        let draw = &mut draw[..out.len()];
        for earlier in 1..steps as u64 {
            fill_normal(seed, Stream::Actions, step.wrapping_sub(earlier), first, draw);
            out.iter_mut().zip(&*draw).for_each(|(out, draw)| *out += draw);
        }
    }
}

/// Fills `out` with uniform 32-bit words.
pub fn fill_words(seed: u64, stream: Stream, step: u64, out: &mut [u32]) {
    in_groups(seed, stream, step, 0, out, |groups, out| {
        out.copy_from_slice(&groups.as_flattened().as_flattened()[..out.len()]);
    });
}

/// Draws groups and lets `write` make numbers of them, piece by piece.
fn in_groups<T>(
    seed: u64,
    stream: Stream,
    step: u64,
    mut first_block: u32,
    out: &mut [T],
    write: impl Fn(&[Group], &mut [T]),
) {
    let mut groups = [[[0; WIDTH]; 4]; GROUPS];
    for out in out.chunks_mut(GROUPS * 4 * WIDTH) {
        let groups = &mut groups[..out.len().div_ceil(4 * WIDTH)];
        dispatch(Level::current(), Draw { seed, stream, step, first_block, groups });
        write(groups, out);
        first_block = first_block.wrapping_add((GROUPS * WIDTH) as u32);
    }
}

kernels! {
    /// Four normal numbers of every block of words.
    pub fn normals<const FMA: bool>(groups: &[Group], out: &mut [f32]) {
        let unit = |word| open_unit::<f32>(<f32 as Scalar>::Word::splat(word));
        for (words, out) in groups.iter().zip(out.chunks_mut(4 * WIDTH)) {
            let mut normal = [[0.0_f32; 4]; WIDTH];
            for (lane, normal) in normal.iter_mut().enumerate() {
                for pair in 0..2 {
                    let radius = (-2.0 * ln::<FMA>(unit(words[2 * pair][lane]))).sqrt();
                    let (sin, cos) = sin_cos_turns::<FMA>(unit(words[2 * pair + 1][lane]));
                    normal[2 * pair] = madd::<FMA>(radius, cos, 0.0);
                    normal[2 * pair + 1] = madd::<FMA>(radius, sin, 0.0);
                }
            }
            let flat = normal.as_flattened();
            out.copy_from_slice(&flat[..out.len()]);
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
    fn noise_that_is_left_is_the_sum_of_the_draws_before() {
        let draw = |step: u64| {
            let mut out = vec![0.0; 3000];
            fill_normal(7, Stream::Actions, step, 5, &mut out);
            out
        };
        // Across the end of the low word of the step, and before the first step.
        for step in [9, (1 << 32) + 1, 1] {
            let mut held = vec![f32::NAN; 3000];
            fill_held(7, (step, 4), 5, &mut held);
            let before = [1, 2, 3].map(|earlier| draw(step.wrapping_sub(earlier)));
            for (k, held) in held.iter().enumerate() {
                assert!((held - before.iter().map(|draw| draw[k]).sum::<f32>()).abs() < 1e-5, "{k}: {held}");
            }
            let mut none = vec![f32::NAN; 8];
            fill_held(7, (step, 1), 5, &mut none);
            assert_eq!(none, [0.0; 8]);
        }
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
