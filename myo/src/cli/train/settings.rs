//! Settings of the learner, as the command line changes them.

use clap::Args;
use myo::model::Nearest;
use myo::train::PpoConfig;
use serde_json::Value;

use crate::cli::failure::{Failure, Result};
use crate::cli::parse;

/// Settings of the learner that a command may change.
#[derive(Args, Clone, Debug)]
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
    let mut table = serde_json::to_value(base)?;
    changes.iter().try_for_each(|change| apply(&mut table, change))?;
    let mut config: PpoConfig = serde_json::from_value(table)?;
    config.num_envs = num_envs.unwrap_or(config.num_envs);
    config.validate()?;
    Ok(config)
}

fn apply(table: &mut Value, change: &str) -> Result<()> {
    let Some((name, text)) = change.split_once('=') else {
        return Err(Failure::sentence(format!(
            "`--set {change}` needs the form NAME=VALUE, such as discount_per_s=0.7"
        )));
    };
    let Some(entry) = table.get_mut(name) else {
        let valid: Vec<_> = table.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
        return Err(Failure::sentence(format!("unknown setting `{name}`; {}", Nearest::to(name, &valid))));
    };
    match serde_json::from_str::<Value>(text) {
        Ok(value) if same_kind(&value, entry) => *entry = value,
        _ => return Err(Failure::sentence(format!("`{name}` is `{text}`; it must be {}", kind(entry)))),
    }
    Ok(())
}

/// Whole numbers stay whole numbers; a list is a list of whole numbers.
fn same_kind(value: &Value, default: &Value) -> bool {
    match default {
        Value::Number(number) if number.is_u64() => value.is_u64(),
        Value::Number(_) => value.is_number(),
        Value::Array(_) => value.as_array().is_some_and(|list| list.iter().all(Value::is_u64)),
        _ => true,
    }
}

fn kind(default: &Value) -> &'static str {
    match default {
        Value::Number(number) if number.is_u64() => "a whole number, 0 or more",
        Value::Number(_) => "a number",
        _ => "a list of whole numbers, such as [128,128]",
    }
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
