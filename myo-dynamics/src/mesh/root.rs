//! Where a function changes its sign.

/// How often a function is asked at most, and the share of an interval by which two places in it differ that are one.
const MOST: usize = 100;
const SAME: f64 = 1e-14;

/// Where a function changes its sign between two places: where the line between its values at both does, one of which is halved if it stays a second time
/// (M. Dowell and P. Jarratt 1971, doi 10.1007/BF01934364); or half way, where that does not narrow the interval.
pub(super) fn root(function: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (function(low), function(high));
    let (sign, same) = (at_low.signum(), SAME * (high - low));
    let (mut width, mut moved) = (high - low, 0);
    for round in 1..=MOST {
        let place = (low * at_high - high * at_low) / (at_high - at_low);
        let is_slow = round % 3 == 0 && high - low > 0.5 * width;
        if round % 3 == 0 {
            width = high - low;
        }
        let place = if !is_slow && place > low && place < high { place } else { 0.5 * (low + high) };
        if place - low <= same || high - place <= same {
            return place;
        }
        let value = function(place);
        if value == 0.0 {
            return place;
        }
        if value.signum() == sign {
            (low, at_low) = (place, value);
            at_high *= if moved < 0 { 0.5 } else { 1.0 };
            moved = -1;
        } else {
            (high, at_high) = (place, value);
            at_low *= if moved > 0 { 0.5 } else { 1.0 };
            moved = 1;
        }
    }
    0.5 * (low + high)
}
