//! `myo measure`.

use std::fmt::Write;

use crate::{assert_refused, json, myo, short_training, stdout};

/// Movements of two people by minimum jerk, half a second each over 20 or 30 cm, at 100 Hz.
fn people() -> String {
    let mut text =
        String::from("participant,trial,time_ms,x_mm,y_mm,target_x_mm,target_y_mm,target_width_mm,note_mood\n");
    for who in ["Ada", "Ben"] {
        for trial in 0..8 {
            let distance = if trial % 2 == 0 { 200.0 } else { 300.0 };
            for sample in 0..=80 {
                let s = (f64::from(sample - 10) / 50.0).clamp(0.0, 1.0);
                let x = distance * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
                writeln!(text, "{who},{trial},{},{x},5,{distance},0,30,calm", 1000 + 10 * sample).unwrap();
            }
        }
    }
    text
}

#[test]
fn people_and_simulated_users_are_measured_in_the_same_way() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("people.csv"), people()).unwrap();
    let answer = json(&myo(folder.path(), &["measure", "people.csv", "--json"]));
    let [found] = &answer.as_array().unwrap()[..] else { panic!("one file, one answer: {answer}") };
    assert_eq!([&found["participants"], &found["movements"], &found["missed"]], [2, 16, 0]);
    assert!(found["no_fitts"].as_str().unwrap().contains("indices of difficulty"), "{found}");
    let told = stdout(&myo(folder.path(), &["measure", "people.csv"]));
    assert!(told.contains("smoothness, SPARC") && told.contains("there is no Fitts' law: "), "{told}");

    // Somebody who never came to a target has nothing to be measured.
    stdout(&myo(folder.path(), &short_training("512", &["--out", "run"])));
    stdout(&myo(folder.path(), &["export", "run", "--episodes", "3", "--out", "simulated.csv"]));
    let refused = myo(folder.path(), &["measure", "people.csv", "simulated.csv"]);
    assert_refused(
        &refused,
        "simulated.csv: run made 0 movements at targets, and missed 3; at least 5 movements of each person are needed",
    );
    assert_refused(&myo(folder.path(), &["measure", "nobody.csv"]), "nobody.csv: cannot be read");
}

#[test]
fn nobody_practises_for_recordings_that_no_user_can_be_fitted_to() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("people.csv"), people()).unwrap();
    assert_refused(
        &myo(folder.path(), &["fit", "people.csv"]),
        "people.csv: Ada: 0 movements in 0 pairs of distance and width can be compared; a fit needs 3 pairs with 8 movements each, from 6 to 40 cm at targets from 12 to 120 mm wide",
    );
    // Sixteen movements of all together are of two pairs.
    assert_refused(
        &myo(folder.path(), &["fit", "people.csv", "--together"]),
        "people.csv: all 2 participants: 16 movements in 2 pairs of distance and width can be compared",
    );
    assert_refused(
        &myo(folder.path(), &["fit", "people.csv", "--user", "nobody"]),
        "there is no preset and no file called `nobody`",
    );
    assert_refused(&myo(folder.path(), &["bench", "fit", "--user", "fastest"]), "--user fastest: it has no noise");
    assert_refused(
        &myo(folder.path(), &["bench", "fit", "--vision-delay-ms", "80,40,50"]),
        "40 and 50 ms are the same number of control steps of 40 ms",
    );
    assert_refused(
        &myo(folder.path(), &["bench", "fit", "--trainings", "21"]),
        "21 trainings: a fit can take 20 at most",
    );
    // The last of the users is impossible, and the first learns nothing before that is said.
    assert_refused(&myo(folder.path(), &["bench", "fit", "--height-m", "1.7,5"]), "body.height_m");
    assert!(!folder.path().join("runs").exists(), "nobody was trained");
}

#[test]
fn trainings_of_a_fit_lie_side_by_side() {
    let folder = tempfile::tempdir().unwrap();
    stdout(&myo(folder.path(), &short_training("512", &["--seeds", "2", "--out", "somebody"])));
    let fit = |more: &[&str]| myo(folder.path(), &[&["bench", "fit", "--practised", "somebody"], more].concat());
    assert_refused(&fit(&["--seed", "7"]), "somebody has trainings with seeds 1 to 2, to which 7 does not join");
    assert_refused(&fit(&["--seed", "0"]), "somebody has trainings with seeds 1 to 2, to which 0 does not join");
    assert!(!folder.path().join("somebody/seed-7").exists());
    // Trained by somebody else, without a plan: what is there is taken, and what is not there not made beside it.
    std::fs::remove_file(folder.path().join("somebody/plan.json")).unwrap();
    assert_refused(&fit(&["--trainings", "3"]), "somebody has not all of the trainings with seeds 1 to 3");
    assert_refused(&fit(&["--trainings", "2"]), "seed-1 practised other tasks than are asked for now");
}
