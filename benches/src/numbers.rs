//! Made-up numbers: fast, and the same on every run.

/// Numbers without a pattern that matters: a linear congruential generator (Numerical Recipes, 1992, section 7.1).
#[derive(Clone, Debug)]
pub struct Numbers(pub u32);

impl Numbers {
    /// A number in [0, 1).
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / (1 << 24) as f32
    }

    /// Fills a slice with numbers in [-1, 1).
    pub fn fill_signed(&mut self, out: &mut [f32]) {
        out.iter_mut().for_each(|x| *x = 2.0 * self.unit() - 1.0);
    }

    /// `len` numbers in [-1, 1).
    pub fn signed(seed: u32, len: usize) -> Vec<f32> {
        let mut out = vec![0.0; len];
        Self(seed).fill_signed(&mut out);
        out
    }
}
