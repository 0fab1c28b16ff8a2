//! `myo bench`.

use crate::{assert_refused, here, json, myo, short_training, stderr, stdout};

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
    assert!(text.contains("@compute @workgroup_size(32"), "{}", &text[..200.min(text.len())]);
}

/// Movements by minimum jerk to targets of two widths over three distances, each a trial, at 100 Hz.
fn recordings() -> String {
    let mut text = String::from("trial,time_s,x_m,y_m,target_x_m,target_y_m,target_width_m\n");
    let mut trial = 0;
    for [distance, width] in [[0.2, 0.02], [0.3, 0.02], [0.4, 0.02], [0.2, 0.08], [0.3, 0.08], [0.4, 0.08]] {
        for repeat in 0..4 {
            trial += 1;
            let end = distance + 0.1 * width * (f64::from(repeat) - 1.5);
            let duration = 0.1 + 0.15 * f64::log2(distance / width + 1.0);
            for sample in 0..((0.6 + duration) * 100.0) as u32 {
                let time = f64::from(sample) / 100.0;
                let s = ((time - 0.3) / duration).clamp(0.0, 1.0);
                let x = end * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                text += &format!("{trial},{time},{x},0,{distance},0,{width}\n");
            }
        }
    }
    text
}

#[test]
fn published_figures_are_drawn_and_what_is_there_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("people.csv"), recordings()).unwrap();
    let asked = ["bench", "published", "--only", "figures", "--seeds", "1", "--steps", "2M", "--backend", "cpu"];
    let told = stdout(&myo(folder.path(), &asked));
    assert!(told.contains("published: published.md, published.json and 3 figures"), "{told}");
    let data = folder.path().join("published/published.json");
    let read = || serde_json::from_slice::<serde_json::Value>(&std::fs::read(&data).unwrap()).unwrap();
    let alone = read();
    assert_eq!((&alone["aiming"][0]["users"], alone["aiming"].as_array().unwrap().len()), (&1.into(), 1));

    // The user is there already; people and the same user again stand beside it.
    let more = [&asked[..], &["--people", "people.csv", "--beside", "published/users"]].concat();
    let again = myo(folder.path(), &more);
    let told = stdout(&again);
    assert!(told.contains("7 figures") && !stderr(&again).contains("training"), "{told}{}", stderr(&again));
    let together = read();
    assert_eq!(together["aiming"][0], alone["aiming"][0]);
    assert_eq!(together["aiming"][1]["fitts"], alone["aiming"][0]["fitts"], "the same user, recorded alike");
    assert_eq!((&together["aiming"][2]["name"], &together["aiming"][2]["movements"]), (&"people".into(), &24.into()));
    let page = std::fs::read_to_string(folder.path().join("published/published.md")).unwrap();
    assert!(page.contains("How users move") && !page.contains("How long users learn"), "{page}");

    std::fs::write(&data, "{").unwrap();
    assert_refused(&myo(folder.path(), &more), "published.json is damaged");
}

#[test]
fn published_refuses_what_it_cannot_measure_before_anybody_learns() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("odd.csv"), "trial,time_s\n1,0\n").unwrap();
    let refused = |more: &[&str], sentence: &str| {
        let words = [&["bench", "published", "--only", "figures", "--seeds", "1", "--steps", "1k"], more].concat();
        assert_refused(&myo(folder.path(), &words), sentence);
        assert!(!folder.path().join("published/users").exists(), "{more:?}");
    };
    refused(&["--people", "odd.csv"], "odd.csv: there is no column `x_m`");
    refused(&["--people", "nobody.csv"], "nobody.csv: cannot be read");
    refused(&["--beside", "nowhere"], "nowhere");
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    refused(&["--beside", "run"], "movements at targets, and missed");
}
