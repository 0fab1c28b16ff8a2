//! Protocols on recordings whose figures are known, and on users who have learnt nothing.

use std::f64::consts::TAU;

use myo_env::{CpuEnv, EnvConfig, VectorEnv};
use myo_lab::protocol::{
    BEFORE_WAY, CHOICES, ChoiceReaction, Done, EllipseLaps, FAR, FAR_REACHES, FarReaches, FittsLaw, Kinematics,
    LAP_PIECES, LAPS, MuscleDrive, Practice, ProtocolError, Pursuit, REACTIONS, RayPointing, Recording, SELECTIONS,
    Scatter, SteeringLaw, Stillness, TYPED, Targets, Typing, UserReaches, WAY_PIECES, Way, circle_targets, conditions,
    ray_pairs, reaches, record, ways,
};
use myo_lab::{ModelReach, one_structure};
use myo_measure::bands::{Figure, Figures};
use myo_measure::fitts::index_of_difficulty;
use myo_measure::signal;
use myo_model::{Model, builtin};
use myo_tasks::{Reward, Task, check, preset};
use myo_train::{Policy, PpoConfig, Trainer};

const RATE_HZ: f64 = 500.0;
/// A user of Fitts' law: intercept (s) and slope (s/bit).
const LAW: [f64; 2] = [0.1, 0.15];
/// Share of a minimum-jerk movement that passes before its speed is 5 % of its peak: 16 s^2 (1 - s)^2 is 0.05 there.
const ONSET: f64 = 0.0594;
/// How long it stays in a target.
const DWELL_S: f64 = 0.25;

fn arm(name: &str) -> Model {
    Model::new(&builtin(name).unwrap()).unwrap()
}

/// Numbers spread evenly over (-1, 1), the same ones always.
fn spread(number: usize) -> f64 {
    let golden = 0.618_033_988_749_895 * number as f64;
    2.0 * (golden - golden.floor()) - 1.0
}

/// Minimum jerk (Flash and Hogan 1985).
fn minimum_jerk(share: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
}

/// How long the ideal user takes for a condition (s).
fn movement_time(condition: usize) -> f64 {
    let [distance, width] = conditions()[condition];
    LAW[0] + LAW[1] * index_of_difficulty(distance, width)
}

/// Reaches for every target by minimum jerk, ends up off it by a share of the way, and rests.
fn ideal(condition: usize, episode: usize) -> Recording {
    let samples = |seconds: f64| (seconds * RATE_HZ).round() as usize;
    let duration = samples(movement_time(condition));
    let mut at = [0.2, 0.0, -0.5];
    let (mut fingertip, mut done) = (vec![at; samples(0.2)], vec![]);
    for (selection, target) in circle_targets(conditions()[condition][0]).into_iter().enumerate() {
        let begin = if selection == 0 { 0 } else { fingertip.len() };
        let off = 1.0 + 0.02 * spread(97 * condition + 31 * episode + selection);
        let way: [f64; 3] = std::array::from_fn(|k| off * (target[k] - at[k]));
        let place = |share: f64| std::array::from_fn::<f64, 3, _>(|k| at[k] + share * way[k]);
        fingertip.extend((1..=duration).map(|sample| place(minimum_jerk(sample as f64 / duration as f64))));
        let entry = fingertip.len();
        fingertip.extend(vec![place(1.0); samples(DWELL_S)]);
        done.push(Done { begin, entry, end: fingertip.len() });
        at = place(1.0);
    }
    let n = fingertip.len();
    let activations = vec![0.1; n];
    Recording {
        rate_hz: RATE_HZ,
        fingertip,
        force: vec![0.0; n],
        qpos: vec![],
        qvel: vec![],
        activations,
        done,
        exits: 0.0,
        wrong_presses: 0.0,
        targets: None,
    }
}

fn ideal_user(episodes: usize) -> UserReaches {
    let of = |condition| (0..episodes).map(|episode| ideal(condition, episode)).collect();
    let layouts: Vec<Vec<Recording>> = (0..conditions().len()).map(of).collect();
    UserReaches { reaches: reaches(&layouts).unwrap(), repeats: episodes }
}

/// What the law becomes from 5 % of the peak on, of recordings without what is faster than 10 Hz, which rounds the onset.
fn smoothed_law() -> [f64; 2] {
    let time = |condition: usize| {
        let (duration, rest) = ((movement_time(condition) * RATE_HZ).round() as usize, 200);
        let distance = conditions()[condition][0];
        let at = |sample: usize| [distance * minimum_jerk((sample as f64 - rest as f64) / duration as f64), 0.0, 0.0];
        let path: Vec<_> = (0..duration + 2 * rest).map(at).collect();
        let smooth = signal::low_pass_points(&path, RATE_HZ, 10.0).unwrap();
        let steps: Vec<f64> = smooth.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
        let peak = steps.iter().copied().fold(0.0, f64::max);
        let onset = steps.iter().position(|&step| step > 0.05 * peak).unwrap();
        (rest + duration - onset) as f64 / RATE_HZ
    };
    let all: Vec<[f64; 2]> = (0..conditions().len())
        .map(|condition| {
            let [distance, width] = conditions()[condition];
            [index_of_difficulty(distance, width), time(condition)]
        })
        .collect();
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
    let [index, time] = [0, 1].map(|k| mean(&|point| point[k]));
    let slope = mean(&|point| (point[0] - index) * (point[1] - time)) / mean(&|point| (point[0] - index).powi(2));
    [time - slope * index, slope]
}

#[test]
fn fitts_law_comes_out_as_it_went_in() {
    let found = FittsLaw::of(&[ideal_user(5), ideal_user(5)]).unwrap();
    let fit = found.fitts.as_ref().unwrap();
    // To a sample of 2 ms.
    let law = smoothed_law();
    assert!((fit.slope_s_per_bit - law[1]).abs() < 2e-3, "{:?}", found.fitts);
    assert!((fit.intercept_s - law[0]).abs() < 4e-3 && fit.r2 > 0.999, "{:?}", found.fitts);
    assert!(fit.distinct_indices >= 8 && found.users == 2);
    assert!(found.conditions.iter().all(|condition| condition.missed == 0.0), "{:?}", found.conditions);
    // Equal users differ in nothing.
    let [low, high] = fit.slope_s_per_bit_interval.unwrap();
    assert!((high - low).abs() < 1e-12);
    // Ends are spread evenly over 4 % of the way, so that effective widths and indices go by that alone.
    let sd = 0.04 / 12_f64.sqrt();
    let index = (1.0 / (4.133 * sd) + 1.0).log2();
    let all = conditions().len();
    let expected =
        (0..all).map(|condition| index / ((1.0 - ONSET) * movement_time(condition))).sum::<f64>() / all as f64;
    assert!((fit.throughput_bit_s / expected - 1.0).abs() < 0.05, "{} {expected}", fit.throughput_bit_s);
}

#[test]
fn who_begins_before_the_signal_is_not_faster_for_it() {
    let prompt = FittsLaw::of(&[ideal_user(3)]).unwrap().fitts.unwrap();
    // The signal comes when a tenth of a second of each movement is over.
    let early = |condition| {
        let of = |episode| {
            let mut recording = ideal(condition, episode);
            for selection in 1..recording.done.len() {
                let late = recording.done[selection].begin + 50;
                (recording.done[selection].begin, recording.done[selection - 1].end) = (late, late);
            }
            recording
        };
        (0..3).map(of).collect()
    };
    let layouts: Vec<Vec<Recording>> = (0..conditions().len()).map(early).collect();
    let early =
        FittsLaw::of(&[UserReaches { reaches: reaches(&layouts).unwrap(), repeats: 3 }]).unwrap().fitts.unwrap();
    assert!((early.slope_s_per_bit - prompt.slope_s_per_bit).abs() < 1e-3, "{early:?} {prompt:?}");
    assert!((early.intercept_s - prompt.intercept_s).abs() < 3e-3, "{early:?} {prompt:?}");
}

#[test]
fn movements_of_minimum_jerk_are_told_as_such() {
    let found = Kinematics::of(&[ideal_user(3)]).unwrap();
    let figure = |figure: Figure| found.rows.iter().find(|row| row.figure == figure).unwrap().median;
    assert_eq!(found.movements, 3 * (SELECTIONS - 1) * conditions().len());
    // From 5 % to 5 % of its peak it has a peak of 1.66 times its mean.
    assert!((1.5..1.9).contains(&figure(Figure::PeakOverMean)), "{}", figure(Figure::PeakOverMean));
    // It enters its targets when it ends.
    assert!(
        (figure(Figure::TimeOfPeak) - (0.5 - ONSET) / (1.0 - ONSET)).abs() < 0.005,
        "{}",
        figure(Figure::TimeOfPeak)
    );
    let maxima = [Figure::SpeedMaximaEasy, Figure::SpeedMaximaHard, Figure::SpeedMaximaPerBit].map(figure);
    assert_eq!(maxima, [1.0, 1.0, 0.0]);
    assert!((figure(Figure::PathOverChord) - 1.0).abs() < 1e-3, "{}", figure(Figure::PathOverChord));
    assert!((-1.65..-1.35).contains(&figure(Figure::Sparc)), "{}", figure(Figure::Sparc));
    // The peak is 1.875 times the mean over the whole duration, 30 cm over the times of the four widths.
    let of_30 = (0..conditions().len()).filter(|&condition| conditions()[condition][0] == 0.3);
    let peaks: Vec<f64> = of_30.map(|condition| 1.875 * 0.3 / movement_time(condition)).collect();
    let [slowest, fastest] = [f64::min, f64::max].map(|of| peaks.iter().copied().reduce(of).unwrap());
    assert!((slowest..fastest).contains(&figure(Figure::PeakSpeed30)), "{}", figure(Figure::PeakSpeed30));
}

#[test]
fn ends_that_scatter_along_the_way_are_told_as_such() {
    let found = Scatter::of(&[ideal_user(12)]).unwrap();
    assert!(found.elongation > 10.0, "{found:?}");
    // 4 % of the way, spread evenly: 1.15 cm more for each metre.
    assert!((found.growth_along - 0.04 / 12_f64.sqrt()).abs() < 2e-3, "{}", found.growth_along);
    // Some directions may be missing, but not most.
    let without = |directions: usize| {
        let mut user = ideal_user(12);
        user.reaches.retain(|reach| reach.condition != 0 || reach.selection > directions);
        Scatter::of(&[user])
    };
    assert!((without(6).unwrap().elongation / found.elongation - 1.0).abs() < 0.1);
    assert!(without(7).unwrap_err().to_string().contains("end points over 100 mm"));
    let error = Scatter::of(&[ideal_user(2)]).unwrap_err().to_string();
    assert!(error.contains("end points over 100 mm") && error.contains("at least"), "{error}");
}

#[test]
fn users_who_have_not_learnt_a_condition_have_no_law_and_times_of_the_others() {
    let half_learnt = || {
        let mut user = ideal_user(4);
        user.reaches.retain(|reach| reach.condition != 3 || reach.selection < 3);
        user
    };
    let (found, whole) = (FittsLaw::of(&[half_learnt()]).unwrap(), FittsLaw::of(&[ideal_user(4)]).unwrap());
    let what = found.unlearnt.as_ref().unwrap();
    assert!(what.contains("the user did 8 of 52, and at least 26 are needed"), "{what}");
    assert_eq!((&found.fitts, whole.unlearnt), (&None, None));
    for (index, (found, whole)) in found.conditions.iter().zip(&whole.conditions).enumerate() {
        let expected = if index == 3 { None } else { whole.movement_time_s };
        assert_eq!(found.movement_time_s, expected, "{index}");
    }
    let plot = found.plot();
    assert_eq!((plot.title.as_str(), plot.series.len()), ("No law yet: times of what was learnt", 1));
    let mut figures = Figures::new();
    found.figures(&mut figures).unwrap();
    assert_eq!((figures.get(Figure::FitR2), figures.get(Figure::Throughput)), (None, None));

    // One who has learnt it tells its time, and still there is no law of both.
    let both = FittsLaw::of(&[half_learnt(), ideal_user(4)]).unwrap();
    assert_eq!((both.fitts, both.conditions[3].movement_time_s), (None, whole.conditions[3].movement_time_s));

    let nobody = UserReaches { reaches: vec![], repeats: 4 };
    assert!(matches!(FittsLaw::of(&[nobody]), Err(ProtocolError::TooFew { found: 0, .. })));
}

/// Rests at the beginning of a way and goes along it evenly, for so many seconds from its first sphere to its last.
fn along(way: &Way, seconds: f64, exits: f64) -> Recording {
    let [rest, moving] = [0.2, seconds].map(|seconds: f64| (seconds * RATE_HZ).round() as usize);
    let place = |mut gone: f64| {
        for ends in way.corners.windows(2) {
            let step: [f64; 3] = std::array::from_fn(|k| ends[1][k] - ends[0][k]);
            let length = step.iter().map(|x| x * x).sum::<f64>().sqrt();
            if gone <= length {
                return std::array::from_fn(|k| ends[0][k] + step[k] * gone / length);
            }
            gone -= length;
        }
        way.corners[WAY_PIECES]
    };
    let mut fingertip = vec![way.corners[0]; rest];
    fingertip.extend((1..=moving).map(|sample| place(0.01 + way.length() * sample as f64 / moving as f64)));
    let at = |sample| Done { begin: sample, entry: sample, end: sample };
    let mut done = vec![Done { begin: 0, entry: 0, end: rest - 50 }, at(rest - 50)];
    done.extend((1..=WAY_PIECES).map(|piece| at(rest - 1 + moving * piece / WAY_PIECES)));
    Recording { exits, ..recorded(fingertip, done) }
}

#[test]
fn the_steering_law_comes_out_as_it_went_in() {
    let seconds = |way: &Way| 0.2 + 0.1 * way.length() / way.width;
    let user = |leaves: usize| -> Vec<Vec<Recording>> {
        let pass = |way: &Way, episode: usize| {
            let left = episode < leaves;
            along(way, if left { 9.0 } else { seconds(way) }, if left { 2.0 } else { 0.0 })
        };
        ways().iter().map(|way| (0..8).map(|episode| pass(way, episode)).collect()).collect()
    };
    let found = SteeringLaw::of(&[user(1), user(2)]).unwrap();
    assert_eq!((found.users, found.rows.len()), (2, 8));
    for (row, way) in found.rows.iter().zip(ways()) {
        assert_eq!((row.shape, row.width_m), (way.shape, way.width));
        let [time_s, left] = [row.time_s, row.left].map(Option::unwrap);
        assert!((time_s - seconds(&way)).abs() < 0.002 && (left - 1.5 / 8.0).abs() < 1e-9, "{row:?}");
    }
    // 30 cm, and 15 sides of a polygon of 16 corners, from sphere to sphere.
    let [straight, circle] = [0, 4].map(|way: usize| found.rows[way].index * found.rows[way].width_m);
    assert!((straight - 0.28).abs() < 1e-9 && (circle - 0.5653).abs() < 1e-4, "{straight}, {circle}");
    assert_eq!(found.steering.iter().map(|fit| fit.shape).collect::<Vec<_>>(), ["straight", "circle"]);
    for fit in &found.steering {
        assert!(
            fit.r2 > 0.9999 && (fit.slope_s - 0.1).abs() < 1e-3 && (fit.intercept_s - 0.2).abs() < 0.005,
            "{fit:?}"
        );
    }
    assert_eq!(found.unlearnt, None);
    found.plot().svg().unwrap();
    let what = "passes of the straight way of 20 mm that did not leave it: the user did 1 of 8";
    let refused = SteeringLaw::of(&[user(7)]).unwrap_err().to_string();
    assert!(refused.starts_with(what), "{refused}");
    // One way is too narrow for one user: no law of its shape, all else as it was.
    let (mut learner, other) = (user(1), user(2));
    learner[0] = user(7).swap_remove(0);
    let narrow = SteeringLaw::of(&[learner, other]).unwrap();
    assert!(narrow.unlearnt.as_ref().is_some_and(|told| told.starts_with(what)), "{:?}", narrow.unlearnt);
    assert_eq!(narrow.steering, found.steering[1..]);
    assert_eq!((&narrow.rows[1..], narrow.rows[0].left), (&found.rows[1..], Some((7.0 / 8.0 + 2.0 / 8.0) / 2.0)));
    assert!((narrow.rows[0].time_s.unwrap() - seconds(&ways()[0])).abs() < 0.002, "{:?}", narrow.rows[0]);
    assert_eq!(narrow.plot().series.len(), 3);
    narrow.plot().svg().unwrap();
}

#[test]
fn words_per_minute_and_errors_come_out_as_they_went_in() {
    let letters = TYPED.chars().count();
    // A letter every so many samples, after a second for the first one.
    let typed = |every: usize, wrong_presses: f64, letters: usize| {
        let press = |letter: usize| 500 + every * letter;
        let done: Vec<Done> = (0..letters)
            .map(|letter| Done {
                begin: letter.checked_sub(1).map_or(0, |before| press(before) + 5),
                entry: press(letter),
                end: press(letter) + 5,
            })
            .collect();
        let n = press(letters) + 10;
        let (fingertip, force) = (vec![[0.0; 3]; n], vec![0.0; n]);
        Recording {
            rate_hz: RATE_HZ,
            fingertip,
            force,
            qpos: vec![],
            qvel: vec![],
            activations: vec![],
            done,
            exits: 0.0,
            wrong_presses,
            targets: None,
        }
    };
    let user =
        |every: usize| vec![vec![typed(every, 1.0, letters), typed(every, 0.0, letters), typed(every, 9.0, 3)]; 4];
    let found = Typing::of(&[user(200), user(250)]).unwrap();
    assert_eq!(found.rows.iter().map(|row| row.key_m).collect::<Vec<_>>(), [0.005, 0.007, 0.009, 0.012]);
    for row in &found.rows {
        // 0.4 and 0.5 s for a letter; a word has five.
        let [words, letter_s, wrong] = [row.words_per_min, row.letter_s, row.wrong_per_100].map(Option::unwrap);
        assert!((words - 0.5 * (30.0 + 24.0)).abs() < 1e-9, "{row:?}");
        assert!((letter_s - 0.45).abs() < 1e-9 && (row.unfinished - 1.0 / 3.0).abs() < 1e-9, "{row:?}");
        assert!((wrong - 50.0 / letters as f64).abs() < 1e-9, "who did not finish has no rate: {row:?}");
    }
    found.plot().svg().unwrap();
    let beginner = vec![vec![typed(200, 0.0, letters), typed(200, 0.0, 2), typed(200, 0.0, 2)]; 4];
    let what = "the sentence on keys of 5 mm: the user did 1 of 3";
    let refused = Typing::of(std::slice::from_ref(&beginner)).unwrap_err().to_string();
    assert!(refused.starts_with(what), "{refused}");
    // Small keys that nobody has learnt have no figures; the others are as they were.
    let smallest = |mut user: Vec<Vec<Recording>>| {
        user[0].clone_from(&beginner[0]);
        user
    };
    let some = Typing::of(&[smallest(user(200)), smallest(user(250))]).unwrap();
    assert!(some.unlearnt.is_some_and(|told| told.starts_with(what)));
    assert_eq!((some.rows[0].letter_s, &some.rows[1..]), (None, &found.rows[1..]));
    assert!((some.rows[0].unfinished - 2.0 / 3.0).abs() < 1e-9);
}

#[test]
fn what_is_practised_can_be_done() {
    for name in ["mobl-arms", "mobl-arms-uitb", "myo-arm"] {
        let (user, model) = (Task { model: name.into(), ..preset("pointing-uitb").unwrap() }, arm(name));
        for practice in Practice::ALL {
            let layouts = practice.layouts(&user).unwrap();
            one_structure(&model, &layouts).unwrap();
            // All of them are done by the same body, with the same technique.
            let reach = ModelReach::for_task(&model, &layouts[0]).unwrap();
            for layout in &layouts {
                let told = if [Practice::Steering, Practice::Ellipse].contains(&practice) { 2.0 } else { 0.0 };
                assert_eq!(layout.reward, Reward { exit: told, ..user.reward.clone() });
                assert_eq!(layout.noise, user.noise);
                assert_eq!(layout.control_dt_s, user.control_dt_s);
                let report = check(layout, &reach);
                assert!(report.errors.is_empty(), "{name}, {}: {:?}", layout.name, report.errors);
            }
        }
    }
}

#[test]
fn steps_of_ways_and_sentences_are_those_that_are_measured() {
    let (user, model) = (preset("pointing-uitb").unwrap(), arm("mobl-arms-uitb"));
    // To stay at the beginning of a way, to be there when it begins, and its pieces; a press for each letter.
    for (practice, steps) in [
        (Practice::Steering, BEFORE_WAY + WAY_PIECES),
        (Practice::Ellipse, BEFORE_WAY + LAPS * LAP_PIECES),
        (Practice::Choosing, 2 * REACTIONS),
        (Practice::Ray, SELECTIONS),
        (Practice::Far, 2 * FAR_REACHES),
        (Practice::Typing, TYPED.chars().count()),
    ] {
        let layouts = practice.layouts(&user).unwrap();
        let config = EnvConfig { num_envs: layouts.len(), ..EnvConfig::default() };
        let env = CpuEnv::with_layouts(&model, &layouts, &config).unwrap();
        let is_step = |name: &&String| name.starts_with("target_") && name.ends_with("_success");
        assert_eq!(env.spec().episode_names.iter().filter(is_step).count(), steps, "{practice:?}");
    }
}

/// A user who has learnt nothing.
fn untrained(model: &Model, layouts: &[Task]) -> Policy {
    let config = PpoConfig { num_envs: 64, policy_hidden: vec![8], value_hidden: vec![8], ..PpoConfig::default() };
    let env = CpuEnv::with_layouts(model, layouts, &config.envs(1)).unwrap();
    Trainer::new(Box::new(env), config, 1).unwrap().policy()
}

#[test]
fn recordings_are_whole_episodes_and_the_same_again() {
    let (user, model) = (preset("pointing-uitb").unwrap(), arm("mobl-arms-uitb"));
    let mut layouts = Practice::Pointing.layouts(&user).unwrap();
    layouts.truncate(3);
    layouts.iter_mut().for_each(|layout| layout.time_limit_s = 1.0);
    let mut policy = untrained(&model, &layouts);
    let found = record(&mut policy, &model, &layouts, (2, 7)).unwrap();
    assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2, 2]);
    for recording in found.iter().flatten() {
        // A second of 500 samples; nothing was done.
        let counts = (recording.fingertip.len(), recording.force.len(), recording.done.len());
        assert_eq!((counts, recording.rate_hz.round()), ((500, 500, 0), 500.0));
        assert_eq!(recording.activations.len(), 500 * model.muscles.len());
        assert!(recording.activations.iter().all(|act| (0.0..=1.0).contains(act)));
    }
    let again =
        |policy: &mut Policy, seed| record(policy, &model, &layouts, (2, seed)).unwrap()[2][1].fingertip.clone();
    assert_eq!(found[2][1].fingertip, again(&mut policy, 7));
    assert_ne!(found[2][1].fingertip, again(&mut policy, 8));
}

#[test]
fn holds_and_activations_of_users_who_do_not_hold_are_refused() {
    let model = arm("myo-arm");
    let user = Task { model: "myo-arm".into(), ..preset("pointing-uitb").unwrap() };
    let layouts = Practice::Holding.layouts(&user).unwrap();
    let found = record(&mut untrained(&model, &layouts), &model, &layouts, (6, 1)).unwrap().remove(0);
    let still = Stillness::of(std::slice::from_ref(&found)).unwrap_err();
    let drive = MuscleDrive::of(&model, &[(found.clone(), found)]).unwrap_err();
    for error in [still, drive] {
        assert!(matches!(error, ProtocolError::TooFew { found: 0, asked: 6, .. }), "{error}");
    }
}

#[test]
fn a_held_arm_is_as_still_as_it_was() {
    // 3 s in the target, moving evenly with 5 mm/s and trembling by 0.1 mm at 8 Hz.
    let n = 1500;
    let at = |sample: usize| {
        let t = sample as f64 / RATE_HZ;
        [0.4 + 0.005 * t, 1e-4 * (TAU * 8.0 * t).sin(), -0.4]
    };
    let fingertip: Vec<[f64; 3]> = (0..n).map(at).collect();
    let activations = vec![0.07; 32 * n];
    let done = vec![Done { begin: 0, entry: 0, end: n }; 2];
    let holds = vec![
        Recording {
            rate_hz: RATE_HZ,
            fingertip,
            force: vec![0.0; n],
            qpos: vec![],
            qvel: vec![],
            activations,
            done,
            exits: 0.0,
            wrong_presses: 0.0,
            targets: None
        };
        6
    ];
    let found = Stillness::of(std::slice::from_ref(&holds)).unwrap();
    for row in &found.rows {
        assert!((row.mean_speed_m_s - 0.0062).abs() < 5e-4, "{row:?}");
        assert!((row.tremor_m - 2e-4).abs() < 2e-5, "{row:?}");
    }
    let drive = MuscleDrive::of(&arm("myo-arm"), &[(holds.clone(), holds)]).unwrap();
    assert!((drive.rows[0].mean - 0.07).abs() < 1e-6 && drive.rows[0].share_saturated == 0.0, "{drive:?}");
    assert!((drive.rows[0].elbow_co_contraction - 1.0).abs() < 1e-6, "all pull alike: {drive:?}");
}

/// Who keeps to a sphere that goes to and fro at some frequency (Hz), so many seconds late, for so many seconds after half a second in which it is
/// come to.
fn pursuing(hz: f64, late_s: f64, seconds: f64) -> Recording {
    let at = |t: f64| [0.45, 0.1 * (TAU * hz * t).sin(), -0.1];
    let (control_steps, samples) = (((0.5 + seconds) / 0.04).round() as usize, 20);
    let n = control_steps * samples;
    let begin = |step: usize| 0.04 * step as f64;
    Recording {
        rate_hz: RATE_HZ,
        fingertip: (0..n).map(|sample| at(sample as f64 / RATE_HZ - late_s)).collect(),
        force: vec![0.0; n],
        qpos: vec![],
        qvel: vec![],
        activations: vec![],
        done: vec![],
        exits: 0.0,
        wrong_presses: 0.0,
        targets: Some(Targets {
            samples,
            step: (0..control_steps).map(|step| usize::from(begin(step) > 0.49)).collect(),
            centre: (0..control_steps).map(|step| at(begin(step))).collect(),
        }),
    }
}

#[test]
fn who_tracks_a_little_late_is_told_so_for_every_frequency() {
    let frequencies = [0.05, 0.25, 0.5, 1.0];
    let user = |late_s: f64| frequencies.map(|hz| vec![pursuing(hz, late_s, 15.0); 3]).to_vec();
    let found = Pursuit::of(&[user(0.1), user(0.12), user(0.14)]).unwrap();
    assert_eq!(found.rows.iter().map(|row| row.up_to_hz).collect::<Vec<_>>(), frequencies);
    for row in &found.rows {
        assert!((row.lag_s - 0.12).abs() < 0.003 && (row.gain - 1.0).abs() < 0.02, "{row:?}");
        // Between two places of a wave that are 0.12 s apart; the slowest has not gone once to and fro.
        let rms = 0.1 * 2.0_f64.sqrt() * (std::f64::consts::PI * row.up_to_hz * 0.12).sin();
        assert!(row.up_to_hz < 0.1 || (row.rms_error_m / rms - 1.0).abs() < 0.03, "{row:?}, {rms}");
        let [low, high] = row.lag_s_interval.unwrap();
        assert!(low < 0.12 && 0.12 < high);
    }
    assert!(found.rows[0].inside == 1.0 && found.rows[3].inside < 0.9);
    // The plot is in centimetres.
    let plot = found.plot();
    assert!((plot.series[0].points[3].at[1] - 100.0 * found.rows[3].rms_error_m).abs() < 1e-12);
}

#[test]
fn who_came_to_no_target_has_no_figures() {
    let mut never = pursuing(0.25, 0.1, 15.0);
    never.targets.as_mut().unwrap().step.fill(0);
    let short = pursuing(0.25, 0.1, 2.5);
    let error = Pursuit::of(&[vec![vec![never.clone(), short]; 4]]).unwrap_err().to_string();
    assert!(
        error.starts_with(
            "episodes in which a target of up to 0.05 Hz was come to: the user did 0 of 2, and at least 1"
        ),
        "{error}"
    );
    // One episode is enough.
    assert!(Pursuit::of(&[vec![vec![never, pursuing(0.25, 0.1, 15.0)]; 4]]).is_ok());
}

/// Steps that were done one after the other, each so many samples long, over this path.
fn recorded(fingertip: Vec<[f64; 3]>, done: Vec<Done>) -> Recording {
    let n = fingertip.len();
    Recording {
        rate_hz: RATE_HZ,
        fingertip,
        force: vec![0.0; n],
        qpos: vec![],
        qvel: vec![],
        activations: vec![],
        done,
        exits: 0.0,
        wrong_presses: 0.0,
        targets: None,
    }
}

/// Laps of an ellipse of 20 by 10 cm in so many seconds each, of harmonic motion.
fn lapping(lap_s: f64, laps: usize) -> Recording {
    let lap = (lap_s * RATE_HZ) as usize;
    let at = |sample: usize| {
        let (sin, cos) = (TAU * sample as f64 / lap as f64).sin_cos();
        [0.45, -0.1 * sin, -0.1 + 0.05 * cos]
    };
    let end = |number: usize| lap * number / LAP_PIECES;
    let done = |number: usize| Done { begin: end(number.saturating_sub(1)), entry: end(number), end: end(number) };
    let before = (0..BEFORE_WAY).map(|_| Done { begin: 0, entry: 0, end: 0 });
    let done = before.chain((1..=laps * LAP_PIECES).map(done)).collect();
    recorded((0..=laps * lap).map(at).collect(), done)
}

#[test]
fn laps_of_harmonic_motion_obey_the_two_thirds_law() {
    let user = |lap_s| vec![lapping(lap_s, LAPS), lapping(lap_s, LAPS), lapping(lap_s, 1)];
    let found = EllipseLaps::of(&[user(1.0), user(0.8)]).unwrap();
    assert_eq!(found.users, 2);
    // Between the first lap and the last, without what is faster than 10 Hz.
    assert!((found.laps_per_s.median - 0.5 * (1.0 + 1.25)).abs() < 1e-9, "{found:?}");
    assert!((found.exponent.median + 1.0 / 3.0).abs() < 0.01 && found.r2.median > 0.99, "{found:?}");
    assert!((found.finished - 2.0 / 3.0).abs() < 1e-12);
    let refused = EllipseLaps::of(&[vec![lapping(1.0, LAPS), lapping(1.0, 2)]]).unwrap_err().to_string();
    assert!(refused.starts_with("episodes of 3 laps of the ellipse: the user did 1 of 2"), "{refused}");
}

#[test]
fn who_takes_longer_to_choose_is_told_so_by_the_bit() {
    // Between reactions it comes back to the middle, which takes another time.
    let episode = |response_s: f64, reactions: usize| {
        let samples = (response_s * RATE_HZ).round() as usize;
        let step = |number: usize| {
            let took = if number.is_multiple_of(2) { 77 } else { samples };
            Done { begin: 1000 * number, entry: 1000 * number + took, end: 1000 * number + took + 125 }
        };
        recorded(vec![[0.0; 3]; 20_000], (0..2 * reactions).map(step).collect())
    };
    let bits = CHOICES.map(|choices| ((choices + 1) as f64).log2());
    let user = |slope: f64| -> Vec<Vec<Recording>> {
        bits.map(|bits| (0..4).map(|_| episode(0.3 + slope * bits, REACTIONS)).collect()).into()
    };
    let found = ChoiceReaction::of(&[user(0.1), user(0.2)]).unwrap();
    assert_eq!(found.rows.iter().map(|row| row.choices).collect::<Vec<_>>(), CHOICES);
    assert!((found.slope_s_per_bit.median - 0.15).abs() < 2e-3, "{found:?}");
    assert!((found.intercept_s.median - 0.3).abs() < 4e-3, "{found:?}");
    let [low, high] = found.slope_s_per_bit.interval.unwrap();
    assert!(low < 0.1 && high > 0.2);
    for (row, bits) in found.rows.iter().zip(bits) {
        assert!((row.bits - bits).abs() < 1e-12 && row.missed == 0.0);
        assert!((row.response_s.median - (0.3 + 0.15 * bits)).abs() < 2e-3, "{row:?}");
    }
    found.plot().svg().unwrap();
    let mut slow = user(0.1);
    slow[2] = vec![episode(0.5, 2); 4];
    let refused = ChoiceReaction::of(&[slow]).unwrap_err().to_string();
    assert!(refused.starts_with("reactions to one of 8: the user did 8 of 24"), "{refused}");
}

/// Two seconds for each step, of which so many are the movement.
fn paced(steps: usize, made: usize, moving_s: impl Fn(usize) -> f64) -> Recording {
    let step = |number: usize| {
        let (begin, took) = (1000 * number, (moving_s(number) * RATE_HZ).round() as usize);
        Done { begin, entry: begin + took, end: begin + took + 125 }
    };
    recorded(vec![[0.3, 0.0, 0.0]; 1000 * steps], (0..made).map(step).collect())
}

#[test]
fn targets_of_a_ray_are_as_far_apart_and_as_wide_as_their_angles() {
    let user = preset("pointing-uitb").unwrap();
    let layouts = Practice::Ray.layouts(&user).unwrap();
    let angle = |a: [f64; 3], b: [f64; 3]| {
        let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        (dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()).acos().to_degrees()
    };
    assert_eq!(layouts.len(), 12);
    for (layout, [distance, width]) in layouts.iter().zip(ray_pairs()) {
        let flat = layout.flat().unwrap();
        let at = |step: usize| {
            let region = flat.object(step).region();
            [region.x, region.y, region.z].map(|range| range.centre())
        };
        for step in 1..SELECTIONS {
            assert!((angle(at(step - 1), at(step)) - distance).abs() < 1e-6, "{}, step {step}", layout.name);
        }
        let radius = flat.object(0).sphere().unwrap().radius.centre();
        let far = at(0).iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((2.0 * (radius / far).atan().to_degrees() - width).abs() < 1e-6, "{}", layout.name);
    }
}

#[test]
fn rays_have_the_law_of_their_angles() {
    let user = |slope: f64| -> Vec<Vec<Recording>> {
        let of_pair = |[distance, width]: [f64; 2]| {
            let time_s = 0.2 + slope * (distance / width + 1.0).log2();
            // From the hanging arm it takes longer.
            let one = || paced(SELECTIONS, SELECTIONS, |step| if step == 0 { 1.5 } else { time_s });
            vec![one(), one()]
        };
        ray_pairs().into_iter().map(of_pair).collect()
    };
    let found = RayPointing::of(&[user(0.15), user(0.25)]).unwrap();
    let law = found.law.as_ref().unwrap();
    assert_eq!((found.users, found.rows.len(), law.pairs, &found.unlearnt), (2, 12, 12, &None));
    assert!((law.slope_s_per_bit.median - 0.2).abs() < 2e-3 && (law.intercept_s.median - 0.2).abs() < 4e-3, "{law:?}");
    assert!(law.r2.median > 0.999 && law.r2_of_exponent.median < law.r2.median, "{law:?}");
    found.plot().svg().unwrap();
    // Times of another law are known by its exponent.
    let squared = |[distance, width]: [f64; 2]| {
        let time_s = 0.3 + 0.02 * (distance / f64::powf(width, 1.5) + 1.0).log2().powi(2);
        vec![paced(SELECTIONS, SELECTIONS, |_| time_s); 2]
    };
    let found = RayPointing::of(&[ray_pairs().into_iter().map(squared).collect()]).unwrap();
    let law = found.law.unwrap();
    assert!((law.exponent.median - 1.5).abs() < 0.05 && law.r2_of_exponent.median > 0.999, "{law:?}");
    // A pair that somebody has not learnt is told, and the law goes through the others.
    let mut beginner = user(0.2);
    beginner[0] = vec![paced(SELECTIONS, 3, |_| 1.0); 2];
    let found = RayPointing::of(&[user(0.2), beginner.clone()]).unwrap();
    assert_eq!(found.law.unwrap().pairs, 11);
    assert!((found.rows[0].missed - 0.5 * (1.0 - 4.0 / 26.0)).abs() < 1e-12, "{:?}", found.rows[0]);
    let told = found.unlearnt.unwrap();
    assert!(
        told.starts_with("selections with a ray, 10 degrees apart and 1 degrees wide: the user did 4 of 26"),
        "{told}"
    );
    let nothing = beginner.iter().map(|_| vec![paced(SELECTIONS, 0, |_| 1.0)]).collect();
    assert!(RayPointing::of(&[nothing]).is_err());
}

#[test]
fn far_reaches_tell_how_fast_the_hand_is_and_what_it_points_with() {
    let task = Practice::Far.layouts(&preset("pointing-uitb").unwrap()).unwrap().remove(0);
    // Straight ahead from 0.25 m to a place within a second by minimum jerk, and back at once.
    let reaching = |to: f64| {
        let path = (0..2 * FAR_REACHES * 1000).map(|sample| {
            let s = ((sample % 1000) as f64 / RATE_HZ).min(1.0);
            let share = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            let goes_out = (sample / 1000) % 2 == 1;
            [0.25 + (to - 0.25) * if goes_out { share } else { 1.0 - share }, 0.0, 0.0]
        });
        let step = |number: usize| Done { begin: 1000 * number, entry: 1000 * number + 500, end: 1000 * number + 625 };
        recorded(path.collect(), (0..2 * FAR_REACHES).map(step).collect())
    };
    // Where the fingertip must be for a hand that grows to be there: x + 16.7 (x - 0.4)^2 beyond 0.4 m.
    let fingertip = |far: f64| {
        if far <= 0.4 { far } else { 0.4 + ((1.0 + 4.0 * 16.7 * (far - 0.4)).sqrt() - 1.0) / (2.0 * 16.7) }
    };
    let user: Vec<Vec<Recording>> = FAR.into_iter().map(|far| vec![reaching(fingertip(far))]).collect();
    let found = FarReaches::of(&task, std::slice::from_ref(&user)).unwrap();
    assert_eq!((found.rows.len(), &found.unlearnt), (FAR.len(), &None));
    let mut before = 0.0;
    for (row, far) in found.rows.iter().zip(FAR) {
        let (time, hand, pointer) = (row.time_s.unwrap(), row.hand_speed_m_s.unwrap(), row.pointer_speed_m_s.unwrap());
        assert!((time.median - 1.0).abs() < 1e-9 && row.missed == 0.0, "{row:?}");
        assert!((hand.median - 1.875 * (fingertip(far) - 0.25)).abs() < 0.02, "{row:?}");
        // Within two thirds of the arm both are one.
        assert!(if far <= 0.4 {
            (pointer.median - hand.median).abs() < 0.01
        } else {
            pointer.median > 1.2 * hand.median
        });
        assert!(pointer.median > before, "{row:?}");
        before = pointer.median;
    }
    found.plot().svg().unwrap();
    let mut beginner = user;
    beginner[4] = vec![recorded(vec![[0.3, 0.0, 0.0]; 2000], vec![])];
    let told = FarReaches::of(&task, &[beginner]).unwrap().unlearnt.unwrap();
    assert!(told.starts_with("reaches to 1.9 m: the user did 0 of 6"), "{told}");
}
