//! What users bring along where a task does not say what they are like.

use myo_tasks::{Body, Hand, Perception, Reward, Source, Task, User, preset_names, preset_text};

const BALL: &str = "version: 2\nname: t\nscene: {ball: {kind: sphere, at: [0.4, 0, 0], radius: 0.1}}\n\
                    script: [{dwell: {in: ball, for_s: 0.2}}]\n";

fn read(more: &str) -> Task {
    Task::from_yaml(&format!("{BALL}{more}"), "t.yaml").unwrap()
}

/// All that users differ in.
fn traits(task: &Task) -> String {
    let Task { reward, noise, perception, reset, control_dt_s, .. } = task;
    format!("{reward:?} {noise:?} {perception:?} {reset:?} {control_dt_s}")
}

#[test]
fn a_human_with_a_human_arm_does_what_names_nobody() {
    for (task, origin) in [(read(""), "a text"), (Task::without_script("t"), "code")] {
        assert_eq!((task.user, task.model.as_str()), (User::Human, "myo-arm"), "{origin}");
        assert_eq!(traits(&task), traits(&read("user: human\n")), "{origin}");
    }
}

#[test]
fn the_fastest_user_is_what_values_are_without_a_user() {
    let fastest = read("user: fastest\n");
    assert_eq!((fastest.reward, fastest.perception), (Reward::default(), Perception::default()));
}

#[test]
fn texts_of_version_1_mean_what_they_meant() {
    let text =
        "version: 1\nname: t\ntargets: [{kind: pointing, position: {x: 0.4, y: 0, z: 0}, radius: 0.1, dwell_s: 0.2}]\n";
    let read = |more: &str| Task::from_yaml(&format!("{text}{more}"), "t.yaml").unwrap();
    let old = read("");
    assert_eq!((old.user, old.model.as_str(), old.control_dt_s), (User::Fastest, "mobl-arms", 0.05));
    assert_eq!(Task::from_yaml(&old.clone().converted().to_yaml(), "t.yaml").unwrap().user, User::Fastest);
    let told = read("user: human\nmodel: myo-arm\n");
    assert_eq!((told.user, told.model.as_str(), told.control_dt_s), (User::Human, "myo-arm", 0.04));
}

#[test]
fn what_a_text_says_is_kept_whoever_does_the_task() {
    let said = "reward: {effort_cost: 0.7, time_cost: 0.1}\nnoise: {constant: 0.2}\nperception: {touch_delay_ms: 40}\ncontrol_dt_s: 0.04\n";
    for user in User::ALL {
        let task = read(&format!("user: {}\n{said}", user.name()));
        let told =
            (task.reward.effort_cost, task.reward.time_cost, task.noise.constant, task.perception.touch_delay_ms);
        assert_eq!((task.user, told, task.control_dt_s), (user, (0.7, 0.1, 0.2, 40.0), 0.04));
    }
    // Also under the names that costs had before.
    let old = read(
        "user: human\nreward: {neural_effort: 0.02, distance: 0.5, acceleration_effort: 0.001}\ncontrol_dt_s: 0.05\n",
    )
    .reward;
    assert_eq!([old.effort_cost, old.distance_cost, old.acceleration_cost], [0.4, 10.0, 0.02]);
}

#[test]
fn another_user_does_the_same_text() {
    for name in preset_names() {
        let source = Source::parse(preset_text(name).unwrap(), name).unwrap();
        let users = User::ALL.map(|user| source.clone().done_by(user).task);
        for (user, task) in User::ALL.into_iter().zip(&users) {
            assert_eq!(task.user, user, "{name}");
            // There and back leaves nothing of the other.
            let again = source.clone().done_by(User::Human).done_by(User::Fastest).done_by(user).task;
            assert_eq!(&again, task, "{name}");
            assert_eq!(&Task::from_yaml(&task.to_yaml(), name).unwrap(), task, "{name}");
        }
        assert_eq!((&users[0].scene, &users[0].script), (&users[1].scene, &users[1].script), "{name}");
    }
}

#[test]
fn named_people_have_their_bodies_and_texts_may_change_them() {
    let woman = read("user: woman\n");
    assert_eq!((woman.body.height_m, woman.body.mass_kg), (Some(1.626), Some(66.8)));
    assert_eq!(traits(&woman), traits(&read("")));
    let taller = read("user: woman\nbody: {height_m: 1.8}\n");
    assert_eq!((taller.body.height_m, taller.body.mass_kg), (Some(1.8), Some(66.8)));
    let older = read("user: older_man\n");
    assert_eq!((older.body.age_years, older.perception.vision_delay_ms), (Some(75.0), 105.0));
    let tired = ["user: tired\n", "user: tired\nfatigue: {initial_max: 0.2}\n"].map(|text| read(text).fatigue);
    assert_eq!(
        tired.map(|fatigue| (fatigue.speed, fatigue.lasts, fatigue.initial_max)),
        [(1.0, false, 0.5), (1.0, false, 0.2)]
    );
    // A text may give back what a named user has not; written out and read again it is the same.
    let right = read("user: left_handed\nbody: {hand: right}\n");
    assert_eq!(right.body.hand, Hand::Right);
    assert_eq!(Task::from_yaml(&right.to_yaml(), "t.yaml").unwrap(), right);
    let torn = read("user: rotator_cuff_tear\nbody: {muscles: {DELT1: 0.5, INFSP: 0.3}}\n");
    let muscles: Vec<(&str, f64)> = torn.body.muscles.iter().map(|(name, share)| (&**name, *share)).collect();
    assert_eq!(muscles, [("DELT1", 0.5), ("INFSP", 0.3), ("SUPSP", 0.0)]);
    assert_eq!(Task::from_yaml(&torn.to_yaml(), "t.yaml").unwrap(), torn);
    let healed = read("user: rotator_cuff_tear\nbody: {muscles: {}}\n");
    assert!(healed.body.muscles.is_empty());
    assert_eq!(Task::from_yaml(&healed.to_yaml(), "t.yaml").unwrap(), healed);
    let unsized_woman = Task { body: Body::default(), ..woman };
    assert_eq!(Task::from_yaml(&unsized_woman.to_yaml(), "t.yaml").unwrap(), unsized_woman);
}

#[test]
fn every_named_user_is_a_body_that_moves() {
    let arm = myo_model::builtin("myo-arm").unwrap();
    for user in User::ALL {
        let task = read("").done_by(user);
        assert!(task.check_values().is_ok(), "{}", user.name());
        let model = task.embody(&arm).unwrap();
        assert_eq!(model.changes, task.body.words(), "{}", user.name());
        assert_eq!(model.has_left_arm(), user == User::LeftHanded, "{}", user.name());
    }
}

#[test]
fn impossible_bodies_are_refused_where_they_stand() {
    for (body, where_and_what) in [
        ("{height_m: 5}", "t.yaml:5:18: `body.height_m` is 5 m; it must be from 1.2 to 2.2 m"),
        ("{strength: -1}", "`body.strength` is -1; it must be from 0.01 to 3"),
        ("{age_years: 7}", "is 7 years; it must be from 18 to 80 years"),
        ("{muscles: {SUPSP: -0.5}}", "has `SUPSP`, which is -0.5; it must be from 0 to 3"),
        ("{height_m: 1.3, mass_kg: 150}", "has 150 kg at 1.3 m; people of that stature have from 20 to 101 kg"),
        ("{hand: both}", "right"),
    ] {
        let error = Task::from_yaml(&format!("{BALL}body: {body}\n"), "t.yaml").unwrap_err().to_string();
        assert!(error.contains(where_and_what), "{error}");
    }
}

#[test]
fn unknown_users_are_told_the_known_ones() {
    let error = Task::from_yaml(&format!("{BALL}user: hasty\n"), "t.yaml").unwrap_err().to_string();
    assert!(error.contains("t.yaml:5:7") && error.contains("human") && error.contains("fastest"), "{error}");
    let error =
        Task::from_yaml(&format!("{BALL}perception: {{vision_delay_ms: -5}}\n"), "t.yaml").unwrap_err().to_string();
    assert!(error.contains("from 0 to 1000 ms"), "{error}");
}
