//! Where and when a number was measured.

use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

/// Goes with every row.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// The processor's name, and how many hardware threads this process may use.
    pub machine: String,
    /// Day, `YYYY-MM-DD`, UTC.
    pub date: String,
    /// Version of this program.
    pub version: &'static str,
}

impl Machine {
    /// This machine, today.
    pub fn here() -> Self {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let name = processor().unwrap_or_else(|| std::env::consts::ARCH.into());
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        Self {
            machine: format!("{name}, {threads} hardware threads"),
            date: date(now / 86400),
            version: env!("CARGO_PKG_VERSION"),
        }
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The date so many days after 1970-01-01.
fn date(mut days: u64) -> String {
    let is_leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

#[cfg(test)]
mod tests {
    use super::date;

    #[test]
    fn dates_of_known_days() {
        let days = [0, 58, 59, 11_016, 11_017, 19_722, 19_723, 20_453];
        let dates = [
            "1970-01-01",
            "1970-02-28",
            "1970-03-01",
            "2000-02-29",
            "2000-03-01",
            "2023-12-31",
            "2024-01-01",
            "2025-12-31",
        ];
        assert_eq!(days.map(date), dates);
    }
}
