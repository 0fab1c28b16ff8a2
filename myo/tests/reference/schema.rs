//! A page of tables from a JSON Schema: one section per type, one row per key.

use std::fmt::Write;

use serde_json::{Map, Value};

/// The page: the type of the root first, under `heading`, then those that it refers to.
pub fn page(title: &str, introduction: &str, heading: &str, schema: &Value) -> String {
    let mut page = format!("# {title}\n\n{introduction}\n");
    section(heading, schema, &mut page);
    for (name, definition) in schema["$defs"].as_object().into_iter().flatten() {
        section(name, definition, &mut page);
    }
    page
}

fn section(name: &str, schema: &Value, page: &mut String) {
    write!(page, "\n## {name}\n\n{}\n", text(schema)).unwrap();
    if let Some(variants) = schema["oneOf"].as_array() {
        variants.iter().for_each(|variant| alternative(variant, page));
    }
    if let Some(properties) = schema["properties"].as_object() {
        table(schema, properties, page);
    } else if schema["anyOf"].is_array() || schema["additionalProperties"].is_object() {
        write!(page, "\n{}.\n", capitalised(&value(schema))).unwrap();
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// One of several forms: a word of its own, a key of its own, or keys that a `kind` selects.
fn alternative(variant: &Value, page: &mut String) {
    match (variant["const"].as_str(), variant["properties"].as_object()) {
        (Some(word), _) => write!(page, "\n- `{word}`: {}", text(variant)).unwrap(),
        (None, Some(properties)) if properties.len() == 1 => {
            let (key, form) = properties.iter().next().expect("there is one");
            write!(page, "\n- `{key}`: {}. {}\n", value(form), text(variant)).unwrap();
        }
        (None, Some(properties)) => {
            let kind = properties["kind"]["const"].as_str().expect("forms with keys have a kind");
            write!(page, "\n### `kind: {kind}`\n\n{}\n", text(variant)).unwrap();
            table(variant, properties, page);
        }
        (None, None) => panic!("a form that this page cannot show: {variant}"),
    }
    if variant["const"].is_string() {
        page.push('\n');
    }
}

fn table(schema: &Value, properties: &Map<String, Value>, page: &mut String) {
    let required: Vec<&str> = schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    let optional = properties.keys().map(String::as_str).filter(|key| !required.contains(key));
    page.push_str("\n| key | value | meaning |\n|---|---|---|\n");
    for key in required.iter().copied().chain(optional) {
        let property = &properties[key];
        let must = if required.contains(&key) { " *(required)*" } else { "" };
        let meaning = text(property).replace("\n\n", " ").replace('|', "\\|");
        writeln!(page, "| `{key}`{must} | {} | {meaning} |", value(property)).unwrap();
    }
}

/// What the source says of it, a paragraph a line.
fn text(schema: &Value) -> String {
    let text = schema["description"].as_str().unwrap_or_default();
    text.split("\n\n").map(|paragraph| paragraph.replace('\n', " ")).collect::<Vec<_>>().join("\n\n")
}

/// What may stand there, in words.
fn value(schema: &Value) -> String {
    if let Some(reference) = schema["$ref"].as_str() {
        let name = reference.trim_start_matches("#/$defs/");
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(word) = schema["const"].as_str() {
        return format!("`{word}`");
    }
    if let Some(forms) = schema["anyOf"].as_array() {
        // That a key may be left out is said by its not being required.
        let forms = forms.iter().filter(|form| form["type"] != "null");
        return forms.map(value).collect::<Vec<_>>().join(", or ");
    }
    match kind(schema) {
        "array" => list(schema),
        "boolean" => "`true` or `false`".into(),
        "string" => "text".into(),
        "object" => format!("names, each with: {}", value(&schema["additionalProperties"])),
        kind @ ("number" | "integer") => {
            let kind = if kind == "integer" { "whole number" } else { "number" };
            [kind.to_owned(), unit(schema), bounds(schema)]
                .into_iter()
                .filter(|part| !part.is_empty())
                .collect::<Vec<_>>()
                .join(", ")
        }
        other => panic!("a kind of value that this page cannot show: {other}"),
    }
}

fn kind(schema: &Value) -> &str {
    let kind = &schema["type"];
    kind.as_str().or_else(|| kind[0].as_str()).expect("every key has a type")
}

fn list(schema: &Value) -> String {
    let length = match (schema["minItems"].as_u64(), schema["maxItems"].as_u64()) {
        (Some(least), Some(most)) if least == most => format!("{least} of: "),
        (Some(least), Some(most)) => format!("{least} to {most} of: "),
        _ => "any number of: ".into(),
    };
    format!("list, {length}{}", value(&schema["items"]))
}

fn unit(schema: &Value) -> String {
    schema["x-unit"].as_str().unwrap_or_default().into()
}

fn bounds(schema: &Value) -> String {
    let least = schema["minimum"].as_f64().map(|x| format!("from {x}"));
    let above = schema["exclusiveMinimum"].as_f64().map(|x| format!("above {x}"));
    let most = schema["maximum"].as_f64().map(|x| format!("to {x}"));
    [least.or(above), most].into_iter().flatten().collect::<Vec<_>>().join(" ")
}
