//! Settings of the learner, as the command line changes them.

use clap::Args;
use myo::changed_settings;
use myo::train::PpoConfig;
use serde_json::Value;

use crate::cli::failure::{Failure, Result};
use crate::cli::parse;

/// Settings of the learner that a command may change.
#[derive(Args, Clone, Debug, Default)]
pub struct LearnerOptions {
    /// Environments side by side [default: from the learner's settings]
    #[arg(long, value_name = "N", value_parser = parse::positive)]
    envs: Option<usize>,

    /// Change a setting of the learner; may be given several times. `config.json` of any run lists them all
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
}

impl LearnerOptions {
    /// `base` with the changes that were asked for.
    pub fn settings(&self, base: &PpoConfig) -> Result<PpoConfig> {
        settings(base, self.envs, &self.set)
    }
}

/// Settings of the learner with the changes asked for, `NAME=VALUE` each.
fn settings(base: &PpoConfig, num_envs: Option<usize>, changes: &[String]) -> Result<PpoConfig> {
    let mut pairs = changes.iter().map(|change| pair(change)).collect::<Result<Vec<_>>>()?;
    pairs.extend(num_envs.map(|count| ("num_envs", count.into())));
    Ok(changed_settings(base, pairs)?)
}

/// A name and a value; what is no JSON is told as it was written.
fn pair(change: &str) -> Result<(&str, Value)> {
    let Some((name, text)) = change.split_once('=') else {
        return Err(Failure::sentence(format!(
            "`--set {change}` needs the form NAME=VALUE, such as discount_per_s=0.7"
        )));
    };
    Ok((name, serde_json::from_str(text).unwrap_or_else(|_| text.into())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sentence(changes: &[&str]) -> String {
        let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
        match settings(&PpoConfig::default(), None, &changes) {
            Err(Failure::Sentence(text)) => text,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn settings_change_one_by_one() {
        let changes = ["discount_per_s=0.9".to_owned(), "policy_hidden=[64,32]".to_owned()];
        let config = settings(&PpoConfig::default(), Some(8), &changes).unwrap();
        assert_eq!((config.discount_per_s, config.num_envs), (0.9, 8));
        assert_eq!(config.policy_hidden, [64, 32]);
    }

    #[test]
    fn bad_settings_are_told_in_one_sentence() {
        assert!(sentence(&["discount=0.9"]).starts_with("unknown setting `discount`; did you mean `discount_per_s`"));
        assert_eq!(sentence(&["epochs=1.5"]), "`epochs` is `1.5`; it must be a whole number, 0 or more");
        assert_eq!(sentence(&["discount_per_s=2"]), "discount_per_s is 2.0; it must be at least 0 and less than 1");
        assert_eq!(sentence(&["clip"]), "`--set clip` needs the form NAME=VALUE, such as discount_per_s=0.7");
    }
}
