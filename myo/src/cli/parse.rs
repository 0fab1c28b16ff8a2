//! Values of options.

use myo::env::MOST_THREADS;
use myo::model::Nearest;
use myo::tasks::User;

/// A whole number, 1 or more.
pub fn positive(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if n >= 1 => Ok(n),
        _ => Err("expected a whole number, 1 or more".into()),
    }
}

/// A number.
pub fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "expected a number".into())
}

/// A number of processor threads.
pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if (1..=MOST_THREADS).contains(&n) => Ok(n),
        _ => Err(format!("expected a whole number from 1 to {MOST_THREADS}")),
    }
}

/// A large count, 1 or more: `60000000`, `60_000_000`, `60M`, `1.5M`, `200k` or `6e7`.
pub fn count(text: &str) -> Result<u64, String> {
    let plain = text.replace(['_', ','], "");
    let (digits, unit) = match plain.as_bytes().last() {
        Some(b'k' | b'K') => (&plain[..plain.len() - 1], 1e3),
        Some(b'M') => (&plain[..plain.len() - 1], 1e6),
        Some(b'G') => (&plain[..plain.len() - 1], 1e9),
        _ => (&plain[..], 1.0),
    };
    let number = digits.trim_end().parse::<f64>().unwrap_or(f64::NAN) * unit;
    // Beyond 2^53 not every whole number exists in binary fractions.
    if number.fract() == 0.0 && (1.0..=9e15).contains(&number) {
        return Ok(number as u64);
    }
    Err("expected a whole number, 1 or more, such as 60000000, 60M or 200k".into())
}

/// Who does a task.
pub fn user(text: &str) -> Result<User, String> {
    let unknown = || Nearest::to(text, &User::ALL.map(User::name)).to_string();
    User::ALL.into_iter().find(|user| user.name() == text).ok_or_else(unknown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_may_be_short() {
        for (text, n) in [("1", 1), ("60M", 60_000_000), ("1.5k", 1500), ("6e7", 60_000_000), ("1_000", 1000)] {
            assert_eq!(count(text), Ok(n), "{text}");
        }
        for text in ["", "k", "0", "-1", "1.5", "nan", "inf", "1e30", "many", "é"] {
            assert!(count(text).is_err(), "{text}");
        }
    }

    #[test]
    fn numbers_are_finite() {
        assert_eq!(number(" 1.5"), Ok(1.5));
        assert!(["", "nan", "inf", "1e999", "1,5"].iter().all(|text| number(text).is_err()));
    }

    #[test]
    fn threads_are_few() {
        assert_eq!(threads("2"), Ok(2));
        assert!(["0", "1000000", "two"].iter().all(|text| threads(text).unwrap_err().contains("1 to 1024")));
    }
}
