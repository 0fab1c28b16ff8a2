//! Answers of users as text.

use myo::measure::bands::{Finding, Judgement, Verdict};
use myo::muscle::MuscleGroup;
use myo::protocol::{
    ChoiceReaction, EllipseLaps, Endurance, FarReaches, FittsLaw, KeyPresses, Kinematics, MuscleDrive, OverUsers,
    Pursuit, RayPointing, Recovery, Scatter, SizeRow, Sizes, SteeringLaw, Stillness, Strength, Typing, WorkInTheAir,
};
use serde::Serialize;
use serde_json::Value;

use crate::cli::output::{name, row, table};

/// A figure to three digits.
fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let digits = (2 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    format!("{value:.digits$}")
}

fn interval(interval: Option<[f64; 2]>) -> String {
    interval.map_or("-".into(), |[low, high]| format!("{} to {}", short(low), short(high)))
}

pub fn users(count: usize) -> String {
    if count == 1 { "one user".into() } else { format!("{count} users") }
}

pub fn fitts(found: &FittsLaw) -> String {
    let mut rows = vec![row(["distance", "width", "ID", "movement time", "95 % interval", "not made"])];
    rows.extend(found.conditions.iter().map(|c| {
        row([
            &format!("{:.0} cm", 100.0 * c.distance_m),
            &format!("{:.1} cm", 100.0 * c.width_m),
            &format!("{:.2} bit", c.id_bit),
            &c.movement_time_s.map_or("not learnt".into(), |time| format!("{time:.3} s")),
            &interval(c.movement_time_s_interval),
            &format!("{:.1} %", 100.0 * c.missed),
        ])
    }));
    let who = users(found.users);
    let title = format!("Protocol F1, Fitts' law of {who}, across a circle of 13 targets, dwell not counted");
    let Some(fit) = &found.fitts else { return format!("{title}\n{}", table(&rows)) };
    let fits = [
        row(["Fitts' law", "median", "95 % interval", "people"]),
        row(["R2", &short(fit.r2), &interval(fit.r2_interval), "at least 0.9"]),
        row(["slope, s/bit", &short(fit.slope_s_per_bit), &interval(fit.slope_s_per_bit_interval), "0.09 to 0.3"]),
        row(["intercept, s", &short(fit.intercept_s), &interval(fit.intercept_s_interval), ""]),
        row([
            "throughput, bit/s",
            &short(fit.throughput_bit_s),
            &interval(fit.throughput_bit_s_interval),
            "2.5 to 7.5",
        ]),
    ];
    format!("{title}\n{}\n{}", table(&rows), table(&fits))
}

pub fn kinematics(found: &Kinematics) -> String {
    let mut rows = vec![row(["movements", "median", "95 % interval", ""])];
    rows.extend(found.rows.iter().map(|r| row([r.what, &short(r.median), &interval(r.interval), r.unit])));
    format!("Protocol K1, {} movements of {}\n{}", found.movements, users(found.users), table(&rows))
}

pub fn scatter(found: &Scatter) -> String {
    let mm = |metres: f64| format!("{:.1} mm", 1e3 * metres);
    let mut rows = vec![row(["distance", "SD along", "SD across", "beyond the target"])];
    rows.extend(found.rows.iter().map(|r| {
        row([&format!("{:.0} cm", 100.0 * r.distance_m), &mm(r.sd_along_m), &mm(r.sd_across_m), &mm(r.overshoot_m)])
    }));
    format!(
        "Protocol K2, end points of {} before any correction, targets of 1 cm\n{}\nalong over across {}, {} mm more along for each 10 cm, \
         across {} degrees\n",
        users(found.users),
        table(&rows),
        short(found.elongation),
        short(100.0 * found.growth_along),
        short(found.direction_deg)
    )
}

pub fn stillness(found: &Stillness) -> String {
    let mut rows = vec![row(["arm raised by", "mean speed", "tremor, 4 to 15 Hz", "drift"])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            &format!("{} degrees", r.at_deg),
            &format!("{:.1} mm/s", 1e3 * r.mean_speed_m_s),
            &format!("{:.2} mm", 1e3 * r.tremor_m),
            &format!("{:.1} mm", 1e3 * r.drift_m),
        ])
    }));
    format!("Protocol K3, holding of {} (people: at most 20 mm/s and 0.5 mm)\n{}", users(found.users), table(&rows))
}

pub fn drive(found: &MuscleDrive) -> String {
    let mut rows =
        vec![row(["", "mean activation", "below 0.05", "above 0.95", "change in 50 ms", "elbow co-contraction"])];
    rows.extend(found.rows.iter().map(|r| {
        let percent = |share: f64| format!("{:.1} %", 100.0 * share);
        row([
            r.when,
            &short(r.mean),
            &percent(r.share_at_rest),
            &percent(r.share_saturated),
            &short(r.change_per_50_ms),
            &short(r.elbow_co_contraction),
        ])
    }));
    format!("Protocol K5, muscles of {}\n{}", users(found.users), table(&rows))
}

pub fn keys(found: &KeyPresses) -> String {
    let rows = [
        row(["presses", "median", "people"]),
        row(["peak force", &format!("{:.2} N", found.peak_force_n), "0.3 to 2 N"]),
        row(["contact time", &format!("{:.0} ms", 1e3 * found.contact_time_s), "60 to 220 ms"]),
        row(["impulse", &format!("{:.3} N s", found.impulse_n_s), ""]),
        row(["from press to press", &format!("{:.0} ms", 1e3 * found.interval_s), ""]),
        row(["one key, presses per second", &short(found.rate_hz), "at most 6.5"]),
    ];
    format!("Protocol T1, {} presses of {}\n{}", found.presses, users(found.users), table(&rows))
}

/// A word of the library as it is written in JSON, with spaces.
fn word(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().as_ref().and_then(Value::as_str).unwrap_or_default().replace('_', " ")
}

/// All bands, of so many users.
pub fn bands(count: usize, judged: &[Judgement]) -> String {
    let mut rows = vec![row(["band", "", "figure", "value", "people", ""])];
    for Judgement { band, findings, .. } in judged {
        for (at, Finding { bound, value, verdict }) in findings.iter().enumerate() {
            let (number, what) = if at == 0 { (band.number.to_string(), band.what) } else { (String::new(), "") };
            let value = value.map_or("-".into(), short);
            rows.push(row([&number, what, &word(bound.figure), &value, &bound.to_string(), &word(verdict)]));
        }
    }
    let many = |verdict| judged.iter().filter(|judgement| judgement.verdict == verdict).count();
    format!(
        "Figures of {}, medians, beside people's\n{}\n{} bands passed, {} failed\n",
        users(count),
        table(&rows),
        many(Verdict::Passed),
        many(Verdict::Failed)
    )
}

fn joint(group: Option<MuscleGroup>) -> &'static str {
    group.map_or("muscles of no known joint", MuscleGroup::name)
}

/// Protocol E1 for people.
pub fn endurance(found: &Endurance) -> String {
    let mut rows = vec![row(["muscles", "load", "held for", "people", "of people's"])];
    let seconds = |time_s: f64| format!("{time_s:.0} s");
    rows.extend(found.rows.iter().map(|r| {
        row([
            joint(r.joint),
            &format!("{:.0} %", 100.0 * r.load),
            &r.time_s.map_or("over an hour".into(), seconds),
            &seconds(r.people_s),
            &r.of_people.map_or("-".into(), |share| format!("{share:.2}")),
        ])
    }));
    format!(
        "Protocol E1, how long muscles of {} hold a share of all they can (people: 0.6 to 1.6 times their mean)\n{}",
        name(&found.model),
        table(&rows)
    )
}

/// Protocol A1 for people.
pub fn sizes(found: &Sizes) -> String {
    let mut head = row(["body"]);
    head.extend(found.rows.iter().map(|r| r.user.to_owned()));
    let line = |what: &str, of: &dyn Fn(&SizeRow) -> String| {
        std::iter::once(what.to_owned()).chain(found.rows.iter().map(of)).collect::<Vec<_>>()
    };
    let rows = vec![
        head,
        line("stature", &|r| format!("{:.3} m", r.height_m)),
        line("body mass", &|r| format!("{:.1} kg", r.mass_kg)),
        line("reach ahead of the shoulder", &|r| format!("{:.2} m", r.reach_m)),
        line("  of stature", &|r| format!("{:.3}", r.reach_of_height)),
        line("  people, bones in line", &|r| format!("{:.3}", r.people_reach_of_height)),
        line("mass of the arm", &|r| format!("{:.2} kg", r.arm_kg)),
        line("  of body mass", &|r| format!("{:.2} %", 100.0 * r.arm_of_mass)),
        line("  people", &|r| format!("{:.2} %", 100.0 * r.people_arm_of_mass)),
        line("strength of the shoulder, of man's", &|r| format!("{:.2}", r.strength_of_man[0])),
        line("strength of the elbow, of man's", &|r| format!("{:.2}", r.strength_of_man[1])),
        line("share of it that holds the arm ahead", &|r| format!("{:.2}", r.holding_share)),
    ];
    let mut women = vec![row(["strength, woman of man", "these bodies", "people"])];
    women.extend(found.woman_of_man.iter().map(|r| {
        let [from, to] = r.people;
        let people = if from == to { format!("{from}") } else { format!("{from} to {to}") };
        row([r.joint, &format!("{:.2}", r.share), &people])
    }));
    format!("Protocol A1, small and large people with {}\n{}\n{}", name(&found.model), table(&rows), table(&women))
}

pub fn typing(found: &Typing) -> String {
    let mut rows = vec![row([
        "keys",
        "words/min",
        "95 % interval",
        "per letter",
        "wrong per 100",
        "95 % interval",
        "not finished",
    ])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            &format!("{:.0} mm", 1e3 * r.key_m),
            &r.words_per_min.map_or("-".into(), short),
            &interval(r.words_per_min_interval),
            &r.letter_s.map_or("-".into(), |time_s| format!("{time_s:.3} s")),
            &r.wrong_per_100.map_or("-".into(), short),
            &interval(r.wrong_per_100_interval),
            &format!("{:.1} %", 100.0 * r.unfinished),
        ])
    }));
    let who = users(found.users);
    format!(
        "Protocol T3, one sentence on a phone with one finger, {who}\n{}\npeople with one finger: 29 words/min\n",
        table(&rows)
    )
}

pub fn tracking(found: &Pursuit) -> String {
    let mut rows = vec![row([
        "up to",
        "speed of the target",
        "distance, RMS",
        "95 % interval",
        "mean",
        "inside",
        "95 % interval",
        "late by",
        "95 % interval",
        "gain",
        "95 % interval",
    ])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            &format!("{} Hz", r.up_to_hz),
            &format!("{:.3} m/s", r.target_speed_m_s),
            &format!("{:.1} cm", 100.0 * r.rms_error_m),
            &interval(r.rms_error_m_interval.map(|ends| ends.map(|error| 100.0 * error))),
            &format!("{:.1} cm", 100.0 * r.mean_error_m),
            &format!("{:.1} %", 100.0 * r.inside),
            &interval(r.inside_interval.map(|ends| ends.map(|share| 100.0 * share))),
            &format!("{:.0} ms", 1e3 * r.lag_s),
            &interval(r.lag_s_interval.map(|ends| ends.map(|lag| 1e3 * lag))),
            &short(r.gain),
            &interval(r.gain_interval),
        ])
    }));
    format!("Protocol S2, tracking of a sphere that wanders, by {}\n{}", users(found.users), table(&rows))
}

pub fn ray(found: &RayPointing) -> String {
    let mut rows = vec![row(["angle", "width", "movement time", "95 % interval", "missed"])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            &format!("{:.0} deg", r.distance_deg),
            &format!("{:.0} deg", r.width_deg),
            &r.time_s.map_or("-".into(), |time| format!("{:.3} s", time.median)),
            &interval(r.time_s.and_then(|time| time.interval)),
            &format!("{:.1} %", 100.0 * r.missed),
        ])
    }));
    let law = found.law.as_ref().map_or(String::new(), |law| {
        let mut fits = vec![row([
            "law",
            "R2",
            "95 % interval",
            "slope, s",
            "95 % interval",
            "exponent of the width",
            "95 % interval",
        ])];
        fits.push(row([
            "a + b log2(alpha/omega + 1)",
            &short(law.r2.median),
            &interval(law.r2.interval),
            &short(law.slope_s_per_bit.median),
            &interval(law.slope_s_per_bit.interval),
            "1",
            "",
        ]));
        let [r2, k] = [law.r2_of_exponent, law.exponent];
        fits.push(row([
            "a + b log2(alpha/omega^k + 1)^2",
            &short(r2.median),
            &interval(r2.interval),
            "",
            "",
            &short(k.median),
            &interval(k.interval),
        ]));
        fits.push(row(["people (Lane 2025; Kopper 2010)", "0.92", "", "", "", "about 3", ""]));
        format!("\nthrough {} pairs\n{}", law.pairs, table(&fits))
    });
    format!("Protocol I1, a ray from the hand at a wall two metres away, {}\n{}{law}", users(found.users), table(&rows))
}

pub fn far(found: &FarReaches) -> String {
    let mut rows =
        vec![row(["distance", "movement time", "95 % interval", "peak speed of the hand", "of the pointer", "missed"])];
    let number =
        |value: Option<OverUsers>, unit: &str| value.map_or("-".into(), |one| format!("{:.2} {unit}", one.median));
    rows.extend(found.rows.iter().map(|r| {
        row([
            &format!("{:.1} m", r.distance_m),
            &number(r.time_s, "s"),
            &interval(r.time_s.and_then(|time| time.interval)),
            &number(r.hand_speed_m_s, "m/s"),
            &number(r.pointer_speed_m_s, "m/s"),
            &format!("{:.1} %", 100.0 * r.missed),
        ])
    }));
    format!(
        "Protocol I2, out to spheres of 20 cm with a hand that grows (Go-Go), {}\n{}",
        users(found.users),
        table(&rows)
    )
}

pub fn steering(found: &SteeringLaw) -> String {
    let mut rows = vec![row(["way", "width", "length over width", "time", "95 % interval", "left"])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            r.shape,
            &format!("{:.0} cm", 100.0 * r.width_m),
            &format!("{:.1}", r.index),
            &r.time_s.map_or("-".into(), |time_s| format!("{time_s:.3} s")),
            &interval(r.time_s_interval),
            &r.left.map_or("-".into(), |left| format!("{:.1} %", 100.0 * left)),
        ])
    }));
    let mut fits = vec![row(["steering law", "R2", "95 % interval", "slope, s", "95 % interval", "intercept, s"])];
    fits.extend(found.steering.iter().map(|fit| {
        let [r2, slope] = [interval(fit.r2_interval), interval(fit.slope_s_interval)];
        row([fit.shape, &short(fit.r2), &r2, &short(fit.slope_s), &slope, &short(fit.intercept_s)])
    }));
    fits.push(row(["people", "0.96 to 0.98", "", "0.08 with a pen", "", ""]));
    let who = users(found.users);
    format!(
        "Protocol S1, the steering law of {who}, from the first sphere of a way to its last\n{}\n{}",
        table(&rows),
        table(&fits)
    )
}

/// Protocol E2 for people.
pub fn work(found: &WorkInTheAir) -> String {
    let mut head = row(["ten minutes of selecting in the air, at the height of the"]);
    head.extend(found.rows.iter().map(|r| r.height.to_owned()));
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let line = |what: &str, of: &dyn Fn(&myo::protocol::WorkRow) -> String| {
        std::iter::once(what.to_owned()).chain(found.rows.iter().map(of)).collect::<Vec<_>>()
    };
    let mut rows = vec![
        head,
        line("fatigued of the muscles that raise the arm (3CC-r)", &|r| percent(r.fatigued)),
        line("strength that holds the upper arm up", &|r| percent(r.of_strength)),
        line("endurance consumed (Consumed Endurance)", &|r| percent(r.consumed_endurance)),
        line("endurance consumed (NICER)", &|r| percent(r.consumed_nicer)),
    ];
    for (class, what) in
        ["within 20 degrees of hanging", "from 20 to 45", "from 45 to 90", "above 90"].iter().enumerate()
    {
        rows.push(line(&format!("time with the upper arm {what} (RULA {})", class + 1), &|r| {
            percent(r.upper_arm[class])
        }));
    }
    rows.extend([
        line("consumed by muscles, more than at rest (Bhargava et al. 2004)", &|r| format!("{:.1} W", r.metabolic_w)),
        line("consumed for a selection", &|r| format!("{:.1} J", 60.0 * r.metabolic_w / r.selections_per_min)),
        line("torque of muscles on all joints, root mean square", &|r| format!("{:.1} N m", r.torque_nm)),
        line("change of that torque, root mean square", &|r| format!("{:.0} N m/s", r.torque_change_nm_s)),
        line("squared activation of muscles, mean", &|r| format!("{:.4}", r.activation)),
        line("selections per minute", &|r| format!("{:.0}", r.selections_per_min)),
    ]);
    format!("Protocol E2, {}\n{}", users(found.users), table(&rows))
}

/// Protocol E3 for people.
pub fn recovery(found: &Recovery) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let mut rows = vec![row(["muscles", "fatigued after work", "after rest", "if rest were no better than work"])];
    rows.extend(found.rows.iter().map(|r| {
        row([joint(r.joint), &percent(r.after_work), &percent(r.after_rest), &percent(r.without_rest_factor)])
    }));
    format!(
        "Protocol E3, muscles of {}, ten turns of 30 s at half of all they can and 30 s of rest\n{}",
        name(&found.model),
        table(&rows)
    )
}

/// Protocol M1 for people.
pub fn strength(found: &Strength) -> String {
    let verdict = |passes| if passes { "pass" } else { "FAIL" }.to_owned();
    let head = |cells: &[&str]| cells.iter().map(ToString::to_string).collect::<Vec<_>>();
    let mut strengths = vec![head(&["strength", "at", "this body", "people", ""])];
    strengths.extend(found.strength.iter().map(|row| {
        let [from, to] = row.people_n_m;
        let people = if from == to { format!("{from}") } else { format!("{from} to {to}") };
        vec![row.what.into(), format!("{}", row.at_deg), format!("{:.1}", row.torque_n_m), people, verdict(row.passes)]
    }));
    let mut holding = vec![head(&["arm straight", "at", "gravity", "strength", "share", ""])];
    holding.extend(found.holding.iter().map(|row| {
        let torques = [row.gravity_n_m, row.strength_n_m].map(|torque| format!("{torque:.1}"));
        let [gravity, strength] = torques;
        let share = format!("{:.2}", row.share);
        vec![row.way.into(), format!("{}", row.at_deg), gravity, strength, share, verdict(row.passes)]
    }));
    let mut arms = vec![head(&["moment arm at the elbow", "at", "this body", "people"])];
    arms.extend(found.moment_arms.iter().map(|row| {
        vec![
            row.muscle.into(),
            format!("{}", row.at_deg),
            format!("{:.2}", row.body_cm),
            format!("{:.2}", row.people_cm),
        ]
    }));
    let changes = match &found.sign_changes[..] {
        [] => "No muscle that was looked at changes sides.\n".to_owned(),
        changes => changes
            .iter()
            .map(|change| {
                format!("{} changes sides at {} degrees of {}: FAIL\n", change.muscle, change.at_deg, change.joint)
            })
            .collect(),
    };
    format!(
        "Protocol M1, strength of {} (N m, degrees)\n{}\nShare of strength that holds the arm up (people: 0.12 to 0.35)\n{}\n\
         Moment arms (cm)\n{}\n{changes}",
        name(&found.model),
        table(&strengths),
        table(&holding),
        table(&arms)
    )
}

pub fn ellipse(found: &EllipseLaps) -> String {
    let figure =
        |what: &str, own: &OverUsers, people: &str| row([what, &short(own.median), &interval(own.interval), people]);
    let rows = [
        row(["an ellipse of 20 by 10 cm", "median", "95 % interval", "people"]),
        figure("laps per second", &found.laps_per_s, ""),
        figure("exponent of speed over curvature", &found.exponent, "-0.35 to -0.28"),
        figure("R2", &found.r2, ""),
    ];
    format!(
        "Protocol K4, laps of {} as fast as they go, on a way of 3 cm, {:.0} % finished\n{}",
        users(found.users),
        100.0 * found.finished,
        table(&rows)
    )
}

pub fn choosing(found: &ChoiceReaction) -> String {
    let mut rows = vec![row(["choices", "bits", "response time", "95 % interval", "missed"])];
    rows.extend(found.rows.iter().map(|r| {
        row([
            &r.choices.to_string(),
            &format!("{:.2}", r.bits),
            &format!("{:.3} s", r.response_s.median),
            &interval(r.response_s.interval),
            &format!("{:.1} %", 100.0 * r.missed),
        ])
    }));
    let (slope, from) = (found.slope_s_per_bit, interval(found.slope_s_per_bit.interval));
    format!(
        "Protocol C1, one of several spheres 12 cm away lights up, {}\n{}\n{} s/bit ({from}); people who touch what lights up: nearly 0, \
         with keys that they had to learn: 0.15\n",
        users(found.users),
        table(&rows),
        short(slope.median)
    )
}
