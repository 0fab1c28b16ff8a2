//! Places that every episode draws: what stands there is as if it had been written there.

use crate::common::{arm, drifting, entry, rollout, steered};
use myo_env::{EnvConfig, ReferenceEnv, Snapshot, StepStorage, VectorEnv};
use myo_tasks::{Item, Range, Region, Task};

fn env(task: &Task) -> ReferenceEnv {
    let config = EnvConfig { num_envs: 16, seed: 4, ..Default::default() };
    ReferenceEnv::new(&arm(task), task, &config).unwrap()
}

fn moment(env: &ReferenceEnv, number: usize) -> Snapshot {
    env.peek(number..number + 1).unwrap().remove(0)
}

/// A place that is moved by this from the middle of its range.
fn placed(region: &mut Region, by: [f64; 3]) {
    for (range, by) in [&mut region.x, &mut region.y, &mut region.z].into_iter().zip(by) {
        *range = Range::fixed(range.centre() + by);
    }
}

#[test]
fn what_is_drawn_there_is_felt_and_seen_as_if_it_stood_there() {
    let task = drifting();
    let mut drawn = env(&task);
    drawn.reset(None, None, &mut vec![0.0; 16 * drawn.spec().observation_size()]).unwrap();
    let moments: Vec<Snapshot> = (0..16).map(|number| moment(&drawn, number)).collect();
    // The longest episode; the next one draws its places anew.
    let steps = 16;
    let wanted = rollout(&mut drawn, steps);
    let nobs = drawn.spec().observation_size();
    let nearest = entry(&drawn, "nearest_obstacle.x");
    let (mut touched, mut compared) = (0, 0);
    for (number, moment) in moments.iter().enumerate() {
        let mut fixed = task.clone();
        let [desk, shelf] = [0, 2].map(|draw| moment.task.shifts[draw]);
        let Item::Group(group) = &mut fixed.scene.0["desk"] else { panic!("a group") };
        placed(&mut group.at.0, desk);
        let Item::Obstacle(obstacle) = &mut fixed.scene.0["shelf"] else { panic!("an obstacle") };
        placed(&mut obstacle.at.0, shelf);
        let Item::Group(group) = &mut fixed.scene.0["desk"] else { panic!("a group") };
        let Item::Button(other) = &mut group.objects.0["other"] else { panic!("a button") };
        let [height, width, depth] = moment.task.shifts[1];
        other.size = [0, 1, 2].map(|k| Range::fixed(other.size[k].centre() + 2.0 * [width, height, depth][k]));
        let mut alone = env(&fixed);
        alone.reset(None, None, &mut vec![0.0; 16 * nobs]).unwrap();
        for (a, b) in wanted.iter().zip(&rollout(&mut alone, steps)) {
            assert!((a.reward[number] - b.reward[number]).abs() < 1e-4);
            assert_eq!(a.terminated[number], b.terminated[number]);
            if a.terminated[number] || a.truncated[number] {
                break;
            }
            let row = |out: &StepStorage| out.observation[number * nobs..(number + 1) * nobs].to_vec();
            for ((x, y), name) in row(a).into_iter().zip(row(b)).zip(&alone.spec().observation_names) {
                assert!((x - y).abs() < 1e-4, "environment {number}, {name}: {x} for {y}");
            }
            let length: f32 = row(a)[nearest..].iter().map(|x| x * x).sum();
            assert!(length <= 1.0 + 1e-6, "{length}");
            // What is touched is two millimetres away, the skin of the fingertip.
            touched += usize::from(row(a)[nearest..].iter().all(|x| x.abs() < 2e-3));
            compared += 1;
        }
    }
    assert!(touched > 10 && compared > 150, "{touched} of {compared} steps with contact");
}

#[test]
fn every_episode_draws_them_anew_and_the_skeleton_shows_them() {
    let task = drifting();
    let mut env = env(&task);
    let skeleton = myo_env::Skeleton::new(&arm(&task), &task).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..40 {
        rollout(&mut env, 1);
        let now = moment(&env, 0);
        let [x, y, z] = now.task.shifts[0];
        seen.insert(x.to_bits());
        let pose = skeleton.pose(&now).unwrap();
        let ([height, width, depth], half) = (now.task.shifts[1], pose.objects[1].half_size);
        let sizes = [0.35 + height, 0.2125 + width, 0.03 + depth];
        assert!(half.iter().zip(sizes).all(|(a, b)| (a - b).abs() < 1e-9), "{half:?} for {sizes:?}");
        let plate = pose.objects[0].frame.position;
        let (sin, cos) = 20_f64.to_radians().sin_cos();
        let place = [0.25 - 0.3 * sin + x, 0.3 * cos + y, -0.1 + z];
        assert!(plate.array().iter().zip(place).all(|(a, b)| (a - b).abs() < 1e-9), "{plate:?} for {place:?}");
        assert!(x.abs() <= 0.1 && y.abs() <= 0.2 && z.abs() <= 0.2);
    }
    assert!((3..=12).contains(&seen.len()), "{} episodes in 2 s", seen.len());
}

#[test]
fn a_cursor_that_moves_by_itself_stays_where_it_went_and_begins_in_the_middle() {
    let mut env = env(&steered());
    let [y, z] = ["pointer_position.y", "pointer_position.z"].map(|name| entry(&env, name));
    let nobs = env.spec().observation_size();
    let mut moved = 0;
    for out in rollout(&mut env, 60) {
        for number in 0..16 {
            let pointer = [y, z].map(|k| out.observation[number * nobs + k]);
            let is_new = out.terminated[number] || out.truncated[number];
            assert!(!is_new || pointer.iter().all(|x| x.abs() < 1e-9), "{pointer:?}");
            moved += usize::from(pointer.iter().any(|x| x.abs() > 0.1));
        }
    }
    assert!(moved > 20, "{moved}");
}
