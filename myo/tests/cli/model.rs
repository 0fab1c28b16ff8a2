//! `myo model`.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use crate::{assert_refused, here, myo, stdout};

#[test]
fn exported_model_is_xml_with_all_muscles() {
    let xml = stdout(&here(&["model", "export", "mobl-arms", "--format", "mjcf"]));
    assert_balanced(&xml);
    let actuators = &xml[xml.find("<actuator").unwrap()..xml.find("</actuator>").unwrap()];
    assert_eq!(actuators.matches("name=").count(), 26);
}

/// Every element that is opened is closed, the last first, and text outside of elements is blank.
fn assert_balanced(xml: &str) {
    let mut open = Vec::new();
    for tag in xml.split('<').skip(1) {
        let (inside, after) = tag.split_once('>').expect("a tag ends");
        assert!(after.trim().is_empty() && inside.matches('"').count() % 2 == 0, "<{tag}");
        match inside.strip_prefix('/') {
            Some(name) => assert_eq!(open.pop(), Some(name)),
            None if inside.ends_with('/') => {}
            None => open.push(inside.split(' ').next().unwrap()),
        }
    }
    assert!(open.is_empty() && xml.starts_with('<'), "{open:?}");
}

#[test]
fn exported_model_file_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let export = |model: &str| myo(folder.path(), &["model", "export", model, "--format", "yaml", "--out", "arm.yaml"]);
    assert_eq!(stdout(&export("mobl-arms")), "");
    let first = std::fs::read_to_string(folder.path().join("arm.yaml")).unwrap();
    stdout(&export("arm.yaml"));
    assert_eq!(first, std::fs::read_to_string(folder.path().join("arm.yaml")).unwrap());
    let missing = myo(folder.path(), &["model", "export", "mobl-arms", "--out", "no/such/arm.xml"]);
    assert_refused(&missing, "cannot write no/such/arm.xml");
}

#[test]
fn a_model_of_mujoco_becomes_a_model_file() {
    let folder = tempfile::tempdir().unwrap();
    let here = |args: &[&str]| myo(folder.path(), args);
    here(&["model", "export", "mobl-arms", "--out", "arm.xml"]);
    let named = ["--fingertip", "fingertip", "--shoulder", "humphant"];
    let import = |file: &str, more: &[&str]| here(&[&["model", "import", file][..], &named, more].concat());
    stdout(&import("arm.xml", &["--out", "back.yaml"]));
    let sizes = |name: &str| {
        let mut found: Value = serde_json::from_str(&stdout(&here(&["model", "check", name, "--json"]))).unwrap();
        // The same up to rounding.
        let reach = found["anatomy"]["distance_m"][1].as_f64().unwrap();
        found.as_object_mut().unwrap().remove("anatomy");
        (found, (1e6 * reach).round())
    };
    assert_eq!(sizes("back.yaml"), sizes("mobl-arms"));
    assert_refused(&here(&["model", "check", "arm.xml"]), "`myo model import arm.xml --fingertip SITE --shoulder BODY");
    assert_refused(
        &here(&["model", "import", "arm.xml", "--fingertip", "tip", "--shoulder", "humphant"]),
        "did you mean `fingertip`",
    );
    // What is wrong is told with its place.
    let text = std::fs::read_to_string(folder.path().join("arm.xml")).unwrap();
    let with = |name: &str, from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        std::fs::write(folder.path().join(name), text.replacen(from, to, 1)).unwrap();
    };
    with("misspelt.xml", "<joint name", "<joint damp=\"1\" name");
    assert_refused(&import("misspelt.xml", &[]), "misspelt.xml:");
    assert_refused(&import("misspelt.xml", &[]), "no attribute `damp`; did you mean `springdamper` or `damping`?");
    with("dry.xml", "<joint name", "<joint frictionloss=\"1\" name");
    assert_refused(&import("dry.xml", &[]), "dry friction (`frictionloss`) is not simulated");
    assert_refused(&import("absent.xml", &[]), "absent.xml");
    let said = import("dry.xml", &[]);
    assert!(!String::from_utf8_lossy(&said.stderr).contains("./dry.xml"), "{said:?}");
}

/// A folder with the arm's model file.
fn with_arm() -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let text = stdout(&myo(folder.path(), &["model", "export", "mobl-arms", "--format", "yaml"]));
    std::fs::write(folder.path().join("arm.yaml"), &text).unwrap();
    (folder, text)
}

#[test]
fn a_model_that_can_be_simulated_is_told_with_its_size() {
    let (folder, _) = with_arm();
    for name in ["mobl-arms", "arm.yaml"] {
        let said = stdout(&myo(folder.path(), &["model", "check", name]));
        let sizes = "17 bodies, 17 joints that move with 5 coordinates, 26 muscles";
        assert!(
            said.starts_with(&format!("{name} can be simulated: {sizes}\n\nThe fingertip comes as near as ")),
            "{said}"
        );
        assert!(said.contains("BRA ") && said.contains("elbow_flexion"), "{said}");
        let found: Value =
            serde_json::from_str(&stdout(&myo(folder.path(), &["model", "check", name, "--json"]))).unwrap();
        assert_eq!((&found["ok"], &found["coordinates"]), (&Value::Bool(true), &Value::from(5)));
        assert_eq!(
            (found["anatomy"]["muscles"].as_array().unwrap().len(), found["anatomy"]["poses"].as_u64()),
            (26, Some(1000))
        );
    }
    // Moment arms, of every coordinate that muscles move.
    let drawn = myo(folder.path(), &["model", "check", "arm.yaml", "--plots", "arms"]);
    assert!(String::from_utf8_lossy(&drawn.stderr).contains("5 plots of moment arms are in arms"), "{drawn:?}");
    assert!(std::fs::read_to_string(folder.path().join("arms/elbow_flexion.svg")).unwrap().contains("moment arm (cm)"));
    let help = stdout(&myo(folder.path(), &["model", "check", "--help"]));
    assert!(help.contains("myo model check arm.yaml"), "{help}");
}

#[test]
fn what_is_wrong_with_a_model_is_told_with_its_file() {
    let (folder, text) = with_arm();
    let line = 1 + text.lines().position(|line| line.contains("mass: 8.01418")).unwrap();
    let cases = [
        ("mass: 8.01418", "mass: -8.01418", format!("wrong.yaml:{line}:")),
        ("mass: 8.01418", "mass: 8.1e6", "wrong.yaml: body `thorax`: `mass` is 8100000 kg".into()),
        ("version: 1", "version: 9", "wrong.yaml: the model has format version 9".into()),
        ("damping: 0.5", "damping: 5.0e5", "wrong.yaml: joint '".into()),
    ];
    for (piece, replacement, expected) in cases {
        assert!(text.contains(piece), "{piece}");
        std::fs::write(folder.path().join("wrong.yaml"), text.replacen(piece, replacement, 1)).unwrap();
        assert_refused(&myo(folder.path(), &["model", "check", "wrong.yaml"]), &expected);
        let output = myo(folder.path(), &["model", "check", "wrong.yaml", "--json"]);
        assert_eq!(output.status.code(), Some(1));
        let found: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&found["ok"], found["errors"].as_array().unwrap().len()), (&Value::Bool(false), 1));
    }
    assert_refused(&myo(folder.path(), &["model", "check", "absent.yaml"]), "cannot read absent.yaml");
}

fn export(folder: &Path, to: &str) -> Output {
    myo(folder, &["model", "export", "mobl-arms", "--format", "yaml", "-o", to])
}

#[cfg(unix)]
#[test]
fn an_export_follows_links() {
    use std::os::unix::fs::PermissionsExt;
    let (folder, text) = with_arm();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("old.yaml"), "old").unwrap();
    std::fs::set_permissions(at("old.yaml"), std::fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink("old.yaml", at("first")).unwrap();
    std::os::unix::fs::symlink("first", at("second")).unwrap();
    std::os::unix::fs::symlink("new.yaml", at("dangling")).unwrap();
    std::os::unix::fs::symlink("circle", at("circle")).unwrap();
    stdout(&export(folder.path(), "second"));
    stdout(&export(folder.path(), "dangling"));
    for (link, file) in [("second", "old.yaml"), ("dangling", "new.yaml")] {
        assert!(at(link).symlink_metadata().unwrap().is_symlink(), "{link}");
        assert!(!at(file).symlink_metadata().unwrap().is_symlink(), "{file}");
        assert_eq!(std::fs::read_to_string(at(file)).unwrap(), text, "{file}");
    }
    assert_eq!(at("old.yaml").metadata().unwrap().permissions().mode() & 0o777, 0o640);
    assert_refused(&export(folder.path(), "circle"), "cannot write circle");
}

#[cfg(unix)]
#[test]
fn an_export_goes_into_devices_and_pipes() {
    use std::os::unix::fs::FileTypeExt;
    let (folder, text) = with_arm();
    stdout(&export(folder.path(), "/dev/null"));
    assert!(std::fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    let pipe = folder.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    stdout(&export(folder.path(), "pipe"));
    assert!(std::fs::metadata(&pipe).unwrap().file_type().is_fifo());
    assert_eq!(reader.join().unwrap(), text);
}

#[test]
fn an_export_refuses_read_only_files_and_folders() {
    let (folder, _) = with_arm();
    let kept = folder.path().join("kept.yaml");
    std::fs::write(&kept, "precious").unwrap();
    let mut permissions = kept.metadata().unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&kept, permissions).unwrap();
    assert_refused(&export(folder.path(), "kept.yaml"), "cannot write kept.yaml: the file is read-only");
    assert_eq!(std::fs::read_to_string(&kept).unwrap(), "precious");
    assert_refused(&export(folder.path(), "."), "cannot write .");
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}
