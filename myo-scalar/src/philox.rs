//! Counter-based random numbers: Philox4x32-10 (Salmon et al. 2011, doi 10.1145/2063384.2063405).
//!
//! A draw is a pure function of where it is used, so the result depends neither on threads nor on the order of
//! evaluation, and every implementation of [`Word`] computes the same integers.

use crate::scalar::{Scalar, Word};

/// Names one block of four random words.
#[derive(Clone, Copy, Debug)]
pub struct Counter<W> {
    /// Seed, low half first; see [`seed_words`].
    pub seed: [W; 2],
    /// Which environment.
    pub env: W,
    /// Which episode of that environment.
    pub episode: W,
    /// Which control step, or which try.
    pub step: W,
    /// What the draw is for, and its running number: purposes must not share values.
    pub stream: W,
}

/// The two halves of a seed, the same in every lane.
#[inline(always)]
pub fn seed_words<W: Word>(seed: u64) -> [W; 2] {
    [W::splat(seed as u32), W::splat((seed >> 32) as u32)]
}

/// Four random words per lane.
#[inline(always)]
pub fn philox<W: Word>(counter: Counter<W>) -> [W; 4] {
    const ROUNDS: usize = 10;
    let mut key = counter.seed;
    let [mut c0, mut c1, mut c2, mut c3] = [counter.stream, counter.step, counter.episode, counter.env];
    for _ in 0..ROUNDS {
        let (hi0, lo0) = c0.mul_wide(0xD251_1F53);
        let (hi1, lo1) = c2.mul_wide(0xCD9E_8D57);
        (c0, c1, c2, c3) = (hi1 ^ c1 ^ key[0], lo1, hi0 ^ c3 ^ key[1], lo0);
        key = [key[0] + W::splat(0x9E37_79B9), key[1] + W::splat(0xBB67_AE85)];
    }
    [c0, c1, c2, c3]
}

/// Uniform in [0, 1): the upper 24 bits, exact in single precision.
#[inline(always)]
pub fn unit<S: Scalar>(word: S::Word) -> S {
    S::from_word(word >> 8) * S::lit(1.0 / 16_777_216.0)
}

/// Two independent standard normal numbers from two words (Box and Muller 1958, doi 10.1214/aoms/1177706645).
#[inline(always)]
pub fn normal_pair<S: Scalar>(a: S::Word, b: S::Word) -> (S, S) {
    // The half step keeps the logarithm's argument above zero.
    let u = S::from_word(a >> 8).mul_add(S::lit(1.0 / 16_777_216.0), S::lit(0.5 / 16_777_216.0));
    let radius = (u.ln() * S::lit(-2.0)).sqrt();
    let (sin, cos) = (unit::<S>(b) * S::lit(std::f64::consts::TAU)).sin_cos();
    (radius * cos, radius * sin)
}
