//! Counter-based random numbers: Philox4x32-10 (Salmon et al. 2011, doi 10.1145/2063384.2063405).
//!
//! A draw is a pure function of where it is used, so the result depends neither on threads nor on the order of
//! evaluation, and every implementation of [`Word`] computes the same integers.

use crate::carried::{Carried, Visitor};
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
pub fn philox<S: Scalar>(counter: Counter<S::Word>) -> [S::Word; 4] {
    let Counter { seed, env, episode, step, stream } = counter;
    philox_block::<S>(seed, [stream, step, episode, env])
}

/// Four random words per lane, of a key and a counter whose words the caller gives a meaning. Words of both go from
/// low to high, as in the authors' Random123.
#[inline(always)]
pub fn philox_block<S: Scalar>(key: [S::Word; 2], counter: [S::Word; 4]) -> [S::Word; 4] {
    const ROUNDS: usize = 10;
    let mut state = State { key, words: counter };
    S::repeat(ROUNDS, &mut state, State::round);
    state.words
}

/// Between two rounds.
struct State<W> {
    key: [W; 2],
    words: [W; 4],
}

impl<W: Word> State<W> {
    #[inline(always)]
    fn round(&mut self) {
        let (key, [c0, c1, c2, c3]) = (self.key, self.words);
        let (hi0, lo0) = c0.mul_wide(0xD251_1F53);
        let (hi1, lo1) = c2.mul_wide(0xCD9E_8D57);
        self.words = [hi1 ^ c1 ^ key[0], lo1, hi0 ^ c3 ^ key[1], lo0];
        self.key = [key[0] + W::splat(0x9E37_79B9), key[1] + W::splat(0xBB67_AE85)];
    }
}

impl<S: Scalar> Carried<S> for State<S::Word> {
    fn visit(&mut self, visitor: &mut impl Visitor<S>) {
        for word in self.key.iter_mut().chain(&mut self.words) {
            visitor.word(word);
        }
    }
}

/// Uniform in [0, 1): the upper 24 bits, exact in single precision.
#[inline(always)]
pub fn unit<S: Scalar>(word: S::Word) -> S {
    S::from_word(word >> 8) * S::lit(1.0 / 16_777_216.0)
}

/// Uniform in (0, 1), exact in single precision: the middles of 2^23 equal parts, so that logarithms are finite.
#[inline(always)]
pub fn open_unit<S: Scalar>(word: S::Word) -> S {
    (S::from_word(word >> 9) + S::lit(0.5)) * S::lit(1.0 / 8_388_608.0)
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
