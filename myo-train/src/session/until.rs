//! When a training has reached what it is for.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use thiserror::Error;

/// What ends a training before its steps are used up. As text and in files: `plateau`, a share such as 0.95, or `off`
/// (in files null).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Until {
    /// The user is as good as it gets: return, success and time per episode have stopped improving; see
    /// [`Trend`](super::Trend).
    #[default]
    Plateau,
    /// The deterministic policy succeeds in this share of fresh episodes, above 0 and at most 1.
    Success(f64),
    /// Nothing: the steps alone end it.
    Off,
}

/// A goal that there is not.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("expected `plateau`, a share of successful episodes above 0 and at most 1, such as 0.95, or `off`")]
pub struct UntilError;

impl Until {
    /// This share of successful episodes.
    ///
    /// # Errors
    /// It is not above 0 and at most 1.
    pub fn success(share: f64) -> Result<Self, UntilError> {
        if share > 0.0 && share <= 1.0 { Ok(Self::Success(share)) } else { Err(UntilError) }
    }

    /// The share of success that is asked for, if it is that.
    pub fn share(self) -> Option<f64> {
        match self {
            Self::Success(share) => Some(share),
            Self::Plateau | Self::Off => None,
        }
    }
}

impl FromStr for Until {
    type Err = UntilError;

    fn from_str(text: &str) -> Result<Self, UntilError> {
        match text {
            "plateau" => Ok(Self::Plateau),
            "off" => Ok(Self::Off),
            share => Self::success(share.parse().map_err(|_| UntilError)?),
        }
    }
}

impl fmt::Display for Until {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plateau => f.write_str("plateau"),
            Self::Success(share) => write!(f, "{share}"),
            Self::Off => f.write_str("off"),
        }
    }
}

/// As it stands in files.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Share(f64),
    Name(String),
    Nothing(()),
}

impl Serialize for Until {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Plateau => Written::Name(self.to_string()),
            Self::Success(share) => Written::Share(*share),
            Self::Off => Written::Nothing(()),
        }
        .serialize(to)
    }
}

impl<'de> Deserialize<'de> for Until {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let refuse = |got: &dyn fmt::Display| {
            de::Error::custom(format!("until is {got}; it must be \"plateau\", a share above 0 and at most 1, or null"))
        };
        match Written::deserialize(from).map_err(|_| refuse(&"of another kind"))? {
            Written::Share(share) => Self::success(share).map_err(|_| refuse(&share)),
            Written::Name(name) if name == "plateau" => Ok(Self::Plateau),
            Written::Name(name) => Err(refuse(&format!("\"{name}\""))),
            Written::Nothing(()) => Ok(Self::Off),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_files_say_the_same() {
        for (text, file, until) in [
            ("plateau", "\"plateau\"", Until::Plateau),
            ("0.95", "0.95", Until::Success(0.95)),
            ("1", "1.0", Until::Success(1.0)),
            ("off", "null", Until::Off),
        ] {
            assert_eq!(text.parse(), Ok(until));
            assert_eq!(until.to_string(), text);
            assert_eq!(serde_json::to_string(&until).unwrap(), file);
            assert_eq!(serde_json::from_str::<Until>(file).unwrap(), until);
        }
    }

    #[test]
    fn what_is_no_goal_is_refused() {
        for text in ["0", "95", "1.01", "nan", "-0.5", "", "Plateau"] {
            assert_eq!(text.parse::<Until>(), Err(UntilError), "{text}");
        }
        for (file, got) in [("2", "2"), ("0", "0"), ("\"high\"", "\"high\""), ("[]", "of another kind")] {
            let told = serde_json::from_str::<Until>(file).unwrap_err().to_string();
            let wanted = format!("until is {got}; it must be \"plateau\", a share above 0 and at most 1, or null");
            assert!(told.starts_with(&wanted), "{told}");
        }
    }
}
