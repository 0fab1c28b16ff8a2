//! Recordings whose figures are known, and tables that are none.

use std::fmt::Write;

use myo_lab::recordings::{AimedFigures, RecordingError, Recordings};

/// Intercept (s) and slope (s/bit) of people who obey Fitts' law.
const LAW: [f64; 2] = [0.12, 0.14];
const HEAD: &str = "participant,trial,time_s,x_m,y_m,z_m,target_x_m,target_y_m,target_z_m,target_width_m\n";

fn minimum_jerk(share: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
}

/// A table of people who move by minimum jerk, each movement a trial, at `rate` Hz with a clock that began at noon; lengths in `unit` m.
fn people(rate: f64, head: &str, unit: f64) -> String {
    people_who_end(usual, rate, head, unit)
}

/// How far behind its target's centre a movement ends, in widths of the target.
fn usual(repeat: i32) -> f64 {
    0.12 * (f64::from(repeat) - 2.5)
}

/// The same of people who end elsewhere.
fn people_who_end(off: impl Fn(i32) -> f64, rate: f64, head: &str, unit: f64) -> String {
    let mut text = head.to_owned();
    for who in 0..3 {
        let mut trial = 0;
        for [distance, width] in [[0.2, 0.08], [0.3, 0.04], [0.2, 0.02], [0.3, 0.01], [0.15, 0.02]] {
            for repeat in 0..6 {
                trial += 1;
                let end = distance + width * off(repeat);
                let duration = LAW[0] + LAW[1] * (distance / width + 1.0_f64).log2();
                let samples = ((0.3 + duration + 0.3) * rate) as usize;
                for sample in 0..samples {
                    let at = sample as f64 / rate;
                    let x = end * minimum_jerk((at - 0.3) / duration);
                    let [x, distance, width] = [x, distance, width].map(|length| length / unit);
                    writeln!(text, "P{who},{trial},{},{x},0,0,{distance},0,0,{width}", 43_200.0 + at).unwrap();
                }
            }
        }
    }
    text
}

fn read(text: &str) -> Result<Recordings, RecordingError> {
    Recordings::read(text.as_bytes())
}

fn figures(text: &str) -> AimedFigures {
    AimedFigures::of(&read(text).unwrap()).unwrap()
}

fn value(figures: &AimedFigures, name: &str) -> f64 {
    figures.rows.iter().find(|row| row.figure == name).unwrap().median
}

#[test]
fn movements_by_minimum_jerk_have_the_figures_of_minimum_jerk() {
    let found = figures(&people(200.0, HEAD, 1.0));
    assert_eq!((found.participants, found.movements, found.missed), (3, 90, 0));
    // From 5 % of the peak speed on, the first bit of a movement is cut off.
    assert!((value(&found, "sparc") + 1.40).abs() < 0.02, "{found:?}");
    assert!((value(&found, "time_of_peak") - 0.5).abs() < 0.02 && value(&found, "speed_maxima") == 1.0);
    assert!((value(&found, "path_over_chord") - 1.0).abs() < 1e-3);
    assert!((value(&found, "distance_m") - 0.2).abs() < 1e-9);
    // The peak of a middling movement, of 0.2 m to 2 cm: 1.875 D / T.
    let duration = LAW[0] + LAW[1] * 11.0_f64.log2();
    let usual = 1.875 * 0.2 / duration;
    assert!((value(&found, "peak_speed_m_s") / usual - 1.0).abs() < 0.25, "{found:?}");
    let fitts = found.fitts.unwrap();
    assert!(fitts.conditions == 5.0 && fitts.r2.median > 0.98, "{fitts:?}");
    // Entries come before ends, the more so the larger the target: the slope is a little steeper than that of durations.
    assert!((fitts.slope_s_per_bit.median / LAW[1] - 1.0).abs() < 0.2, "{fitts:?}");
}

/// Errors make targets wider (ISO 9241-411): the same hands with misses have less throughput.
#[test]
fn misses_cost_throughput() {
    // The last of six movements ends a width behind the centre of its target.
    let beyond = |repeat: i32| if repeat == 5 { 1.0 } else { usual(repeat) };
    let [good, missed] = [figures(&people(200.0, HEAD, 1.0)), figures(&people_who_end(beyond, 200.0, HEAD, 1.0))];
    assert_eq!((good.missed, missed.missed, missed.movements), (0, 15, 90));
    let throughput = |figures: &AimedFigures| figures.fitts.as_ref().unwrap().throughput_bit_s.median;
    assert!(throughput(&missed) < 0.8 * throughput(&good), "{} {}", throughput(&good), throughput(&missed));
}

/// Whoever gives up ended nowhere: that is a miss and no movement.
#[test]
fn who_gives_up_has_no_movement() {
    let text = people(200.0, &HEAD.replace("width_m\n", "width_m,event\n"), 1.0);
    let lines: Vec<&str> = text.lines().collect();
    let trial = |line: &str| line.split(',').nth(1).map(str::to_owned);
    let ended: String = lines
        .iter()
        .enumerate()
        .map(|(k, line)| match (k, lines.get(k + 1).is_none_or(|next| trial(next) != trial(line))) {
            (0, _) => format!("{line}\n"),
            (_, false) => format!("{line},\n"),
            (_, true) if trial(line).as_deref() == Some("1") => format!("{line},time_out\n"),
            (_, true) => format!("{line},done\n"),
        })
        .collect();
    let found = figures(&ended);
    assert_eq!((found.movements, found.missed), (87, 3));
}

#[test]
fn rates_units_and_clocks_make_no_difference() {
    let usual = figures(&people(500.0, HEAD, 1.0));
    let millimetres = HEAD.replace("_m,", "_mm,").replace("_m\n", "_mm\n");
    for other in [figures(&people(500.0, &millimetres, 1e-3)), figures(&people(120.0, HEAD, 1.0))] {
        for row in &usual.rows {
            let again = value(&other, row.figure);
            assert!(
                (row.median - again).abs() <= 0.02 * row.median.abs().max(0.1),
                "{}: {} {again}",
                row.figure,
                row.median
            );
        }
    }
}

#[test]
fn events_say_when_a_target_was_entered_and_done() {
    let mut text = HEAD.replace("width_m\n", "width_m,event\n");
    for sample in 0..200 {
        let at = f64::from(sample) / 100.0;
        let x = 0.3 * minimum_jerk((at - 0.2) / 0.6) - 0.3 * minimum_jerk((at - 1.2) / 0.6);
        let target = if sample < 110 { 0.3 } else { 0.0 };
        let event = match sample {
            75 | 180 => "entered",
            109 | 199 => "done",
            _ => "",
        };
        writeln!(text, "a,1,{at},{x},0,0,{target},0,0,0.05,{event}").unwrap();
    }
    let recordings = read(&text).unwrap();
    let selections = &recordings.participants[0].trials[0].selections;
    assert_eq!(
        selections.iter().map(|one| (one.samples, one.entry)).collect::<Vec<_>>(),
        [([0, 109], 75), ([110, 199], 180)]
    );
    // Without them the same is told by where the hand is.
    let bare: String = text.lines().map(|line| format!("{},\n", line.rsplit_once(',').unwrap().0)).collect();
    let bare = bare.replacen("width_m,\n", "width_m,event\n", 1);
    let bare = read(&bare).unwrap();
    let [first, second] = &bare.participants[0].trials[0].selections[..] else { panic!("two selections") };
    assert_eq!([first.samples, second.samples], [[0, 109], [110, 199]]);
    assert!(first.entry.abs_diff(75) < 12 && second.entry.abs_diff(175) < 12, "{first:?} {second:?}");
}

/// Numbers of rows, as pandas writes them in a first column without a name.
/// A table of one trial, with these further columns, and their values in each row.
fn with_columns(columns: &str, values: impl Fn(usize) -> String) -> String {
    let mut text = format!("{},{columns}\n", HEAD.trim_end());
    for sample in 0..60 {
        let (at, x) = (0.01 * sample as f64, 0.2 * minimum_jerk(sample as f64 / 50.0));
        writeln!(text, "Ada,1,{at},{x},0,0,0.2,0,0,0.03,{}", values(sample)).unwrap();
    }
    text
}

#[test]
fn activations_are_read_muscle_by_muscle() {
    let text = with_columns("DELT1_activation,note_emg_activation,BIClong_activation", |sample| {
        format!("{},,{}", 0.01 * sample as f64, 1.2 - 0.01 * sample as f64)
    });
    let recordings = read(&text).unwrap();
    let [ada] = &recordings.participants[..] else { panic!("{recordings:?}") };
    assert_eq!(ada.muscles, ["DELT1", "BIClong"]);
    let active = &ada.trials[0].activations;
    assert!(active.len() == 120 && (active[20] - 0.1).abs() < 1e-12 && (active[21] - 1.1).abs() < 1e-12, "{active:?}");
    // What was recorded of some tells nothing of all.
    let mut others = read(&people(100.0, HEAD, 1.0)).unwrap();
    others.append(recordings.clone());
    assert_eq!(others.as_one().participants[0].muscles, [""; 0]);
    assert_eq!(recordings.as_one().participants[0].muscles, ["DELT1", "BIClong"]);
}

#[test]
fn activations_that_are_none_are_refused_in_a_sentence() {
    for (columns, value, message) in [
        (
            "DELT1_activation",
            "-0.1",
            "line 2: `DELT1_activation` is -0.1; an activation from 0 to 1 is needed; is it in percent, or not rectified?",
        ),
        (
            "DELT1_activation",
            "45",
            "line 2: `DELT1_activation` is 45; an activation from 0 to 1 is needed; is it in percent, or not rectified?",
        ),
        ("DELT1_activation", "", "line 2: `DELT1_activation` is empty; a number is needed"),
        (
            "_activation",
            "0.1",
            "column 11 is called `_activation`; the muscle's own name is needed before `_activation`, once",
        ),
        (
            "A_activation,A_activation",
            "0.1,0.1",
            "column 12 is called `A_activation`; the muscle's own name is needed before `_activation`, once",
        ),
    ] {
        assert_eq!(read(&with_columns(columns, |_| value.into())).unwrap_err().to_string(), message);
    }
}

#[test]
fn numbered_rows_make_no_difference() {
    let text = people(100.0, HEAD, 1.0);
    let numbered: String = text
        .lines()
        .enumerate()
        .map(|(k, line)| if k == 0 { format!(",{line}\n") } else { format!("{},{line}\n", k - 1) })
        .collect();
    assert_eq!(read(&numbered).unwrap(), read(&text).unwrap());
}

#[test]
fn tables_that_are_none_are_refused_in_a_sentence() {
    let good = people(100.0, HEAD, 1.0);
    let first: Vec<&str> = good.lines().take(98).collect();
    let broken = |change: &dyn Fn(usize, &str) -> Option<String>| {
        let text: Vec<String> = first.iter().enumerate().filter_map(|(k, line)| change(k, line)).collect();
        match read(&text.join("\n")) {
            Err(error) => error.to_string(),
            Ok(recordings) => AimedFigures::of(&recordings).unwrap_err().to_string(),
        }
    };
    let head =
        |to: &'static str| move |k: usize, line: &str| Some(if k == 0 { to.to_owned() } else { line.to_owned() });
    for (change, sentence) in [
        (
            &head("participant,trial,time_s,x_m,y_m,z_m,tagret_x_m,target_y_m,target_z_m,target_width_m")
                as &dyn Fn(usize, &str) -> Option<String>,
            "there is no column `target_x_m` and `target_y_m`",
        ),
        (
            &head("participant,trial,time,x_m,y_m,z_m,target_x_m,target_y_m,target_z_m,target_width_m"),
            "there is no column `time_s` (or `time_ms`)",
        ),
        (
            &head("participant,trial,time_s,x_m,y_m,z_mm,target_x_m,target_y_m,goal_z_m,target_width_m"),
            "the hand and the target must both have a `z`",
        ),
        (
            &head("particpant,trial,time_s,x_m,y_m,z_m,target_x_m,target_y_m,target_z_m,target_width_m"),
            "unknown column `particpant`; did you mean `participant`?",
        ),
        (
            &|k, line| Some(if k == 5 { line.replacen("P0,1,43200.04", "P0,1,noon", 1) } else { line.into() }),
            "line 6: `time_s` is `noon`; a number is needed",
        ),
        (
            &|k, line| Some(if k == 5 { line.replacen(",0,0,", ",900,0,", 1) } else { line.into() }),
            "line 6: `x_m` is 900; a length within 10 m is needed; is it in other units",
        ),
        (
            &head("participant,trial,time_s,x_mm,y_mm,z_mm,target_x_mm,target_y_mm,target_z_mm,target_width_mm"),
            "line 2: `target_width_mm` is 0.08; a width from 0.5 mm to 10 m is needed; is it in other units",
        ),
        (
            &|k, line| (!(20..40).contains(&k)).then(|| line.to_owned()),
            "P0, trial 1: there is a gap of 0.210 s after 43200.18 s (line 20)",
        ),
        (
            &|k, line| Some(if k == 7 { first[6].to_owned() } else { line.into() }),
            "P0, trial 1: its clock stands or goes back in line 8",
        ),
        (&|k, line| (k < 10).then(|| line.to_owned()), "P0, trial 1: it has 9 samples; at least 20 are needed"),
        (
            &|k, line| Some(if k == 3 { format!("{line},7") } else { line.into() }),
            "line 4: this row has 11 values, and the head line names 10",
        ),
        (&|k, _| (k == 0).then(|| first[0].to_owned()), "there is no sample in the table"),
        (&|_, line| Some(line.replace(',', ";")), "with ';' between names; values must be separated by commas"),
        (&|k, _| (k > 0).then(String::new), "there is no column `x_m` and `y_m`"),
        (&|_, line| Some(line.to_owned()), "P0 made 1 movements at targets, and missed 0; at least 5 movements"),
    ] {
        let error = broken(change);
        assert!(error.contains(sentence), "{error}\nexpected {sentence}");
    }
    let twice = format!(
        "{}\n{}",
        first.join("\n"),
        good.lines().skip(200).take(60).chain(first[1..].iter().copied()).collect::<Vec<_>>().join("\n")
    );
    assert!(read(&twice).unwrap_err().to_string().contains("its rows are not together; sort the table"));
}
