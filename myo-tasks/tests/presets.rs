//! The tasks that come with the library, and reading and writing in general.

use std::path::Path;

use crate::common::{VERSION_1, version_1};
use myo_tasks::{
    Anywhere, LoadError, Pointing, Range, Region, SCHEMA_HINT, Target, Task, User, check, load, preset, preset_names,
    preset_text, rounded_steps, task_schema,
};
use serde_json::Value;

#[test]
fn presets_are_sound() {
    for name in preset_names() {
        let task = preset(name).unwrap();
        assert_eq!(task.name, name);
        let published = ["pointing-single", "pointing-replication"].contains(&name) || name.ends_with("-uitb");
        let of_hands = ["pinch", "chord"].contains(&name) || name.starts_with("hand-");
        let by_arm_and_hand = ["ar-pinch", "ar-menu"].contains(&name);
        let who = match (published, of_hands) {
            (true, _) => ("mobl-arms-uitb", User::Fastest),
            (_, true) => ("myo-hand", User::Human),
            _ if by_arm_and_hand => ("myo-arm-hand", User::Human),
            _ => ("myo-arm", User::Human),
        };
        assert_eq!((task.model.as_str(), task.user), who, "{name}");
        assert_eq!(check(&task, &Anywhere), Default::default(), "{name}");
        assert!(preset_text(name).unwrap().starts_with(SCHEMA_HINT), "{name}");
    }
    assert!(preset("nothing").is_none());
}

#[test]
fn presets_round_trip() {
    for name in preset_names() {
        let task = preset(name).unwrap();
        let text = task.to_yaml();
        assert!(text.starts_with(SCHEMA_HINT));
        assert_eq!(Task::from_yaml(&text, name).unwrap(), task, "{text}");
    }
}

#[test]
fn presets_have_the_published_values() {
    let shape = |name: &str| {
        let task = preset(name).unwrap();
        let flat = task.flat().unwrap();
        let letter = |step| if flat.object(step).sphere().is_some() { 'S' } else { 'B' };
        let kinds: String = (0..flat.steps.len()).map(letter).collect();
        (kinds, task.time_limit_s)
    };
    assert_eq!(shape("pointing-uitb"), ("SSSSSSSSSS".into(), 12.0));
    assert_eq!(shape("pointing-replication"), ("SSSSSSSSSS".into(), 40.0));
    assert_eq!(shape("pointing-single"), ("S".into(), 4.0));
    assert_eq!(shape("ar"), ("SBSBSBSB".into(), 10.0));
    assert_eq!(shape("public-display"), ("BBBB".into(), 4.0));
    assert_eq!(shape("tracking-uitb"), ("SS".into(), 12.0));
    assert_eq!(shape("choice-uitb"), ("B".repeat(10), 40.0));
    assert_eq!(shape("driving-uitb"), ("B".into(), 10.0));
    // People take their time.
    assert_eq!(shape("pointing"), ("SSSSSSSSSS".into(), 20.0));
    assert_eq!(shape("mobile-typing"), ("SSSSS".into(), 8.0));

    let pointing = preset("pointing-uitb").unwrap().flat().unwrap();
    let (y, z) = (Range::new(-0.2, 0.4), Range::new(-0.3, 0.3));
    assert_eq!(pointing.object(9).name, "ball.10");
    assert_eq!(pointing.object(9).region(), Region { x: 0.55.into(), y, z });
    assert_eq!(pointing.object(9).sphere().unwrap().apart, Some((8, 0.3)));
    assert_eq!(pointing.steps[9].dwell_s(), Some(0.25));

    let ar = preset("ar").unwrap().flat().unwrap();
    for (step, y) in [(0, 0.15), (2, 0.15), (4, 0.1), (6, 0.15)] {
        assert_eq!(ar.object(step).region().y, Range::new(-y, y));
    }
    assert_eq!(ar.object(6).sphere().unwrap().apart, Some((5, 0.3)));
    assert_eq!(preset("mobile-typing").unwrap().flat().unwrap().steps[0].dwell_s(), Some(0.05));
}

#[test]
fn durations_are_rounded_to_steps() {
    // Cut instead of rounded, each of these would lose a step at 20 Hz.
    for (duration, steps) in [(0.15, 3), (0.30, 6), (0.35, 7), (0.60, 12), (0.70, 14), (0.95, 19), (1.15, 23)] {
        assert_eq!(rounded_steps(duration, 0.05), steps, "{duration} s");
    }
    assert_eq!(rounded_steps(0.0, 0.05), 1);
    let substeps = ["pointing", "pointing-uitb"].map(|name| preset(name).unwrap().substeps(0.002));
    assert_eq!(substeps, [20, 25]);
}

#[test]
fn repeated_targets_are_written_out_and_folded_again() {
    let task = version_1("pointing");
    assert_eq!(task.targets.len(), 10);
    assert!(task.targets.iter().all(|target| target.repeat() == 1));
    let folded = task.clone().collapsed();
    assert_eq!(folded.targets.len(), 1);
    assert_eq!(folded.targets[0].repeat(), 10);
    assert_eq!(folded.expanded(), task);
    let ar = version_1("ar");
    assert_eq!(ar.clone().collapsed(), ar, "nothing repeats there");
}

#[test]
fn least_distance_defaults_to_twice_the_greatest_radius() {
    let Target::Pointing(sphere) = &version_1("pointing-single").targets[0] else { panic!("a sphere") };
    assert_eq!(sphere.min_distance(), 0.3);
    assert_eq!(Pointing { min_distance_from_previous: Some(0.1), ..sphere.clone() }.min_distance(), 0.1);
}

#[test]
fn button_axes_follow_the_tilt() {
    let Target::Pressing(mut button) = version_1("public-display").targets[0].clone() else { panic!("a button") };
    button.size = [0.06, 0.04, 0.02];
    let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
    // Upright: the face looks to the user, its width runs along y and its height along z.
    assert!(close(button.block().normal(), [-1.0, 0.0, 0.0]));
    assert!(close(button.block().face_point(1.0, 1.0), [0.42 - 0.01, -0.15 + 0.03, 0.01 + 0.02]));
    button.tilt_deg = 0.0;
    assert!(close(button.block().normal(), [0.0, 0.0, 1.0]));
    assert!(close(button.block().face_point(0.0, 0.0), [0.42, -0.15, 0.01 + 0.01]));
}

#[test]
fn files_are_read_and_a_preset_name_goes_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.yaml");
    std::fs::write(&path, preset_text("ar").unwrap().replace("name: ar", "name: mine")).unwrap();
    let source = load(path.to_str().unwrap()).unwrap();
    assert_eq!(source.task.name, "mine");
    assert!(source.text.contains("# anywhere before the user"), "comments are kept");
    assert_eq!(load("ar").unwrap().name, "ar");
    let missing = folder.path().join("none.yaml");
    assert!(matches!(load(missing.to_str().unwrap()), Err(LoadError::Io { path, .. }) if path == Path::new(&missing)));
}

#[test]
fn a_model_file_is_looked_for_beside_its_task() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    std::fs::write(at("arm"), "").unwrap();
    let model = |written: &str| {
        let text = preset_text("ar").unwrap().replace("name: ar", &format!("name: mine\nmodel: {written}"));
        std::fs::write(at("mine.yaml"), text).unwrap();
        load(&at("mine.yaml")).unwrap().task.model
    };
    assert_eq!(model("arm.yaml"), at("arm.yaml"));
    assert_eq!(model("bodies/arm.yaml"), at("bodies/arm.yaml"));
    assert_eq!(model("arm"), at("arm"), "a file without an ending");
    assert_eq!(model("/bodies/arm.yaml"), "/bodies/arm.yaml");
    assert_eq!(model("mobl-arms"), "mobl-arms", "a model that comes with the library");
    assert_eq!(model("mobl-legs"), "mobl-legs", "neither: whoever opens it says so");
}

#[test]
fn schema_bounds_come_from_the_rules() {
    let schema = task_schema();
    let sphere = &schema["$defs"]["Target"]["oneOf"][0]["properties"];
    assert_eq!(sphere["kind"]["const"], "pointing");
    assert_eq!(sphere["dwell_s"]["minimum"], 0.0);
    assert_eq!(sphere["dwell_s"]["x-unit"], "s");
    assert_eq!(sphere["radius"]["anyOf"][1]["items"]["minimum"], 0.001);
    let button = &schema["$defs"]["Target"]["oneOf"][1]["properties"];
    assert_eq!(button["size"]["items"]["minimum"], 0.001);
    assert_eq!(schema["properties"]["time_limit_s"]["default"], 12.0);
    assert!(
        !schema.to_string().replace("\\n\\n", "").contains("\\n"),
        "descriptions have no line breaks but those of paragraphs"
    )
}

#[test]
fn presets_validate_against_the_schema() {
    let schema = task_schema();
    for name in preset_names() {
        for text in [preset_text(name).unwrap().to_owned(), preset(name).unwrap().to_yaml()] {
            let value: Value = serde_saphyr::from_str(&text).unwrap();
            assert_eq!(fault(&schema, &schema, &value), None, "{name}");
        }
    }
    for (name, text) in VERSION_1 {
        assert_eq!(fault(&schema, &schema, &serde_saphyr::from_str(text).unwrap()), None, "{name} of version 1");
    }
    for (key, misspelt) in [("radius", "radios"), ("for_s", "for"), ("press:", "pres:")] {
        let text = preset_text("ar").unwrap().replace(key, misspelt);
        assert!(fault(&schema, &schema, &serde_saphyr::from_str(&text).unwrap()).is_some(), "{misspelt}");
    }
}

/// The part of JSON Schema that the task's schema uses; says what does not fit.
fn fault(root: &Value, schema: &Value, value: &Value) -> Option<String> {
    if let Some(reference) = schema["$ref"].as_str() {
        let target = root.pointer(reference.trim_start_matches('#')).expect("the reference has a target");
        return fault(root, target, value);
    }
    for key in ["oneOf", "anyOf"] {
        if let Some(options) = schema[key].as_array() {
            let fitting = options.iter().filter(|option| fault(root, option, value).is_none()).count();
            return (fitting != 1).then(|| format!("{value} fits {fitting} options"));
        }
    }
    if schema.get("const").is_some_and(|word| word != value) {
        return Some(format!("{value} is not {}", schema["const"]));
    }
    let kind = match value {
        Value::Object(_) => "object",
        Value::Array(_) => "array",
        Value::String(_) => "string",
        Value::Bool(_) => "boolean",
        Value::Number(n) if n.is_u64() => "integer",
        Value::Number(_) => "number",
        Value::Null => "null",
    };
    let allowed = |name: &Value| name == kind || (name == "number" && kind == "integer");
    if !schema["type"].as_array().map_or(allowed(&schema["type"]), |names| names.iter().any(allowed)) {
        return Some(format!("{value} is no {}", schema["type"]));
    }
    let beyond = |key: &str, test: fn(f64, f64) -> bool| {
        let bound = schema[key].as_f64()?;
        test(value.as_f64()?, bound).then(|| format!("{value} breaks {key} {bound}"))
    };
    if let Some(bound) = beyond("minimum", |v, b| v < b).or_else(|| beyond("maximum", |v, b| v > b)) {
        return Some(bound);
    }
    if let Some(items) = value.as_array() {
        return items.iter().find_map(|item| fault(root, &schema["items"], item));
    }
    let entries = value.as_object()?;
    let mut required = schema["required"].as_array().into_iter().flatten();
    if let Some(missing) = required.find(|key| !entries.contains_key(key.as_str().unwrap())) {
        return Some(format!("{missing} is missing"));
    }
    // Names in a scene are free; what stands under them is not.
    let other = schema.get("additionalProperties").filter(|other| other.is_object());
    entries.iter().find_map(|(key, value)| match schema["properties"].get(key).or(other) {
        Some(property) => fault(root, property, value),
        None => Some(format!("{key} is unknown")),
    })
}
