//! `myo bench`.

use crate::{assert_refused, here, json, myo};

#[test]
fn benches_give_rows() {
    let physics = json(&here(&["bench", "physics", "--envs", "16", "--level", "portable", "--json"]));
    let env = json(&here(&["bench", "env", "--task", "pointing-single", "--envs", "16", "--json"]));
    for row in [&physics["rows"][0], &env["rows"][0]] {
        for key in
            ["backend", "level", "envs", "threads", "physics_steps_per_s", "control_steps_per_s", "machine", "date"]
        {
            assert!(!row[key].is_null(), "{key}: {row}");
            assert!(!key.ends_with("_per_s") || row[key].as_f64().unwrap() > 0.0, "{key}: {row}");
        }
    }
    assert_refused(&here(&["bench", "physics", "--against-mujoco", "/no/python"]), "cannot run /no/python");
    let nan = json(&here(&["bench", "nan", "--steps", "20k", "--envs", "256", "--json"]));
    assert_eq!((&nan["non_finite"], nan["control_steps"].as_u64() >= Some(20_000)), (&0.into(), true));
    let args = ["bench", "train", "pointing-single", "--seeds", "2", "--steps", "512", "--envs", "32", "--json"];
    let train = json(&here(&args));
    assert_eq!((&train["rows"][1]["seed"], &train["rows"][1]["stopped_by"]), (&2.into(), &"steps".into()));
    assert_refused(&here(&["bench", "env", "--part", "physics"]), "`myo bench physics` measures the physics alone");
}

#[test]
fn operations_of_a_kernel_are_those_of_its_stages() {
    let folder = tempfile::tempdir().unwrap();
    let kernel = json(&myo(folder.path(), &["bench", "kernel", "--task", "ar", "--wgsl", "ar.wgsl", "--json"]));
    let stages = kernel["stages"].as_array().unwrap();
    let sum: u64 = stages.iter().map(|stage| stage["operations"].as_u64().unwrap()).sum();
    assert_eq!((kernel["operations"].as_u64(), &kernel["part"]), (Some(sum), &"env".into()));
    assert!(stages.iter().any(|stage| stage["stage"].as_str().unwrap().contains(" / ")));
    let text = std::fs::read_to_string(folder.path().join("ar.wgsl")).unwrap();
    assert!(text.contains("@compute @workgroup_size(64"), "{}", &text[..200.min(text.len())]);
}
