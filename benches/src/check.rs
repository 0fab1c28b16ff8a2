//! Results that are worth a time.

/// Panics unless there are `len` numbers and all of them are finite.
#[track_caller]
pub fn assert_finite(what: &str, numbers: impl IntoIterator<Item = f32>, len: usize) {
    let mut count = 0;
    for (i, x) in numbers.into_iter().enumerate() {
        assert!(x.is_finite(), "entry {i} of {what} is {x}");
        count += 1;
    }
    assert_eq!(count, len, "numbers in {what}");
}

#[cfg(test)]
mod tests {
    use super::assert_finite;

    #[test]
    fn finite_numbers_of_the_right_count_pass() {
        assert_finite("numbers", [0.0, -1.5], 2);
    }

    #[test]
    #[should_panic(expected = "entry 1 of rewards is NaN")]
    fn a_number_that_is_none_is_named() {
        assert_finite("rewards", [0.0, f32::NAN], 2);
    }

    #[test]
    #[should_panic(expected = "numbers in rewards")]
    fn a_missing_number_is_noticed() {
        assert_finite("rewards", [0.0], 2);
    }
}
