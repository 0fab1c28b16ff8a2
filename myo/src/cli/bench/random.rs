//! Random numbers for benches: fast, and the same on every run.

/// SplitMix64 (Steele et al. 2014, doi 10.1145/2714064.2660195).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// Fills a slice with numbers in [-1, 1).
    pub fn fill_signed(&mut self, out: &mut [f32]) {
        out.iter_mut().for_each(|x| *x = 2.0 * self.unit() - 1.0);
    }
}
