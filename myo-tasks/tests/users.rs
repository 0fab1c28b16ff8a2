//! What users bring along where a task does not say what they are like.

use myo_tasks::{Perception, Reward, Source, Task, User, preset_names, preset_text};

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
fn unknown_users_are_told_the_known_ones() {
    let error = Task::from_yaml(&format!("{BALL}user: hasty\n"), "t.yaml").unwrap_err().to_string();
    assert!(error.contains("t.yaml:5:7") && error.contains("human") && error.contains("fastest"), "{error}");
    let error =
        Task::from_yaml(&format!("{BALL}perception: {{vision_delay_ms: -5}}\n"), "t.yaml").unwrap_err().to_string();
    assert!(error.contains("from 0 to 1000 ms"), "{error}");
}
