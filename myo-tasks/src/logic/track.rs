//! How well moving spheres are tracked.

use myo_scalar::Scalar;

/// Sums over physics steps in which a sphere was to be tracked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracking<S> {
    /// How many there were.
    pub steps: S,
    /// In how many of them the pointer was inside.
    pub inside: S,
    /// Squared distances from the pointer to the centre (m^2).
    pub squared_distance: S,
}

impl<S: Scalar> Tracking<S> {
    /// Nothing yet.
    #[inline(always)]
    pub fn new() -> Self {
        Self { steps: S::zero(), inside: S::zero(), squared_distance: S::zero() }
    }

    /// Its numbers, in the order of the fields.
    #[inline(always)]
    pub fn numbers(&mut self) -> [&mut S; 3] {
        let Self { steps, inside, squared_distance } = self;
        [steps, inside, squared_distance]
    }

    /// Counts a physics step where the mask says that something is tracked.
    #[inline(always)]
    pub(super) fn count(&mut self, tracks: S::Mask, inside: S::Mask, squared_distance: S) {
        self.steps += S::indicator(tracks);
        self.inside += S::indicator(tracks & inside);
        self.squared_distance += squared_distance.only(tracks);
    }

    /// Adds another's sums.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.inside += other.inside;
        self.squared_distance += other.squared_distance;
    }

    /// Share of the steps inside; NaN where there were none.
    #[inline(always)]
    pub fn on_target(&self) -> S {
        self.per_step(self.inside)
    }

    /// Root mean square of the distances (m); NaN where there were none.
    #[inline(always)]
    pub fn error(&self) -> S {
        self.per_step(self.squared_distance).sqrt()
    }

    #[inline(always)]
    fn per_step(&self, sum: S) -> S {
        let mean = sum * self.steps.max(S::lit(1.0)).recip();
        S::select(S::lit(0.5).lt(self.steps), mean, S::lit(f64::NAN))
    }
}

impl<S: Scalar> Default for Tracking<S> {
    fn default() -> Self {
        Self::new()
    }
}
