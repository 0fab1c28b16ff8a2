//! The JSON Schema of a task file, for editors and forms.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde_json::Value;

use crate::description::Task;

/// JSON Schema (2020-12) of a task file, with the bounds that reading enforces; units stand in `x-unit`.
pub fn task_schema() -> Value {
    SchemaSettings::draft2020_12()
        .with_transform(RecursiveTransform(join_lines))
        .into_generator()
        .into_root_schema_for::<Task>()
        .to_value()
}

/// Editors show descriptions as they are: line breaks of the source do not belong there, those of paragraphs do.
fn join_lines(schema: &mut Schema) {
    let description = schema.get("description").and_then(Value::as_str);
    if let Some(joined) = description.map(|text| text.split("\n\n").map(|p| p.replace('\n', " ")).collect::<Vec<_>>()) {
        schema.insert("description".into(), joined.join("\n\n").into());
    }
}
