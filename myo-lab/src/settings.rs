//! Settings of the learner one by one: what there is, and how a few of them are changed.

use myo_model::{Model, Nearest};
use myo_tasks::User;
use myo_train::{ConfigError, PpoConfig};
use serde_json::{Map, Value};
use thiserror::Error;

/// A field of [`PpoConfig`].
#[derive(Clone, Debug, PartialEq)]
pub struct LearnerSetting {
    /// Its name.
    pub name: String,
    /// What it says of itself.
    pub about: String,
    /// What it is where nobody changes it.
    pub default: Value,
    /// What is allowed, in words; none for a switch.
    pub range: Option<&'static str>,
}

/// Why settings cannot be changed so.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SettingsError {
    /// There is no such setting.
    #[error("unknown setting `{name}`; {hint}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// What it may have meant.
        hint: String,
    },
    /// The value is of another kind.
    #[error("`{name}` is `{value}`; it must be {kind}")]
    Kind {
        /// The setting.
        name: String,
        /// What was asked for.
        value: String,
        /// What it must be.
        kind: &'static str,
    },
    /// The value is out of its range.
    #[error(transparent)]
    Range(#[from] ConfigError),
}

/// All settings, in the order of the fields.
pub fn learner_settings() -> Vec<LearnerSetting> {
    let (ranges, schema) = (PpoConfig::ranges(), schemars::schema_for!(PpoConfig));
    let about = |name: &str| {
        let field = schema.get("properties").and_then(|fields| fields.get(name));
        let text = field.and_then(|field| field.get("description")?.as_str()).unwrap_or_default();
        text.replace('\n', " ")
    };
    let setting = |(name, default): (String, Value)| LearnerSetting {
        about: about(&name),
        range: ranges.iter().find(|(own, _)| *own == name).map(|(_, range)| *range),
        name,
        default,
    };
    fields(&PpoConfig::default()).into_iter().map(setting).collect()
}

fn fields(config: &PpoConfig) -> Map<String, Value> {
    match serde_json::to_value(config) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

/// What users of a kind learn with on a body where nothing else is said.
pub fn usual_settings(user: User, body: &Model) -> PpoConfig {
    PpoConfig::for_user(user).on_body(body.joints.len() - body.couplings.len())
}

/// Settings with some of them changed.
///
/// # Errors
/// There is no setting of a name, or a value is not one that it can have.
pub fn changed_settings<'a>(
    base: &PpoConfig,
    changes: impl IntoIterator<Item = (&'a str, Value)>,
) -> Result<PpoConfig, SettingsError> {
    let mut table = fields(base);
    for (name, value) in changes {
        let Some(entry) = table.get_mut(name) else {
            let valid: Vec<&str> = table.keys().map(String::as_str).collect();
            let hint = Nearest::to(name, &valid).to_string();
            return Err(SettingsError::Unknown { name: name.to_owned(), hint });
        };
        if !same_kind(&value, entry) {
            let (name, value) = (name.to_owned(), value.as_str().map_or_else(|| value.to_string(), str::to_owned));
            return Err(SettingsError::Kind { name, value, kind: kind(entry) });
        }
        *entry = value;
    }
    let config: PpoConfig = serde_json::from_value(Value::Object(table)).map_err(|error| SettingsError::Kind {
        name: "settings".into(),
        value: error.to_string(),
        kind: "settings of the learner",
    })?;
    config.validate()?;
    Ok(config)
}

/// Whole numbers stay whole numbers; a list is a list of whole numbers, a switch a switch.
fn same_kind(value: &Value, default: &Value) -> bool {
    match default {
        Value::Number(number) if number.is_u64() => value.is_u64(),
        Value::Number(_) => value.is_number(),
        Value::Array(_) => value.as_array().is_some_and(|list| list.iter().all(Value::is_u64)),
        _ => value.is_boolean(),
    }
}

fn kind(default: &Value) -> &'static str {
    match default {
        Value::Number(number) if number.is_u64() => "a whole number, 0 or more",
        Value::Number(_) => "a number",
        Value::Array(_) => "a list of whole numbers, such as [128,128]",
        _ => "true or false",
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn refused(name: &str, value: Value) -> String {
        changed_settings(&PpoConfig::default(), [(name, value)]).unwrap_err().to_string()
    }

    #[test]
    fn settings_change_one_by_one() {
        let changes = [("discount_per_s", json!(0.9)), ("policy_hidden", json!([64, 32]))];
        let config = changed_settings(&PpoConfig::default(), changes).unwrap();
        assert_eq!((config.discount_per_s, &config.policy_hidden[..]), (0.9, &[64, 32][..]));
        assert_eq!(PpoConfig { discount_per_s: 0.5, policy_hidden: vec![128, 128], ..config }, PpoConfig::default());
    }

    #[test]
    fn bad_settings_are_told_in_one_sentence() {
        assert!(
            refused("discount", json!(0.9)).starts_with("unknown setting `discount`; did you mean `discount_per_s`")
        );
        assert_eq!(refused("epochs", json!(1.5)), "`epochs` is `1.5`; it must be a whole number, 0 or more");
        assert_eq!(refused("matrix_units", json!("maybe")), "`matrix_units` is `maybe`; it must be true or false");
        assert_eq!(refused("discount_per_s", json!(2)), "discount_per_s is 2.0; it must be at least 0 and less than 1");
        assert_eq!(
            refused("learning_rate", json!(1)),
            "learning_rate is 1.0; it must be between learning_rate_min and learning_rate_max"
        );
    }

    #[test]
    fn every_setting_explains_itself_and_all_but_switches_say_their_range() {
        let settings = learner_settings();
        assert_eq!(settings.len(), fields(&PpoConfig::default()).len());
        for LearnerSetting { name, about, default, range } in settings {
            assert!(!about.is_empty(), "{name}");
            assert_eq!(range.is_none(), default.is_boolean(), "{name}");
        }
    }
}
