//! The JSON Schema of a task file, for editors and forms.

use schemars::generate::SchemaSettings;
use serde_json::Value;

use crate::description::Task;

/// JSON Schema (2020-12) of a task file, with the bounds that reading enforces; units stand in `x-unit`.
pub fn task_schema() -> Value {
    SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Task>().to_value()
}
