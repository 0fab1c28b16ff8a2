//! Fitts' law, end points and steering against published and constructed data.

mod common;

use common::assert_close;
use myo_measure::fitts::{Condition, Pointing, Trial, Users, index_of_difficulty};
use myo_measure::steering::{Steering, Tunnel};
use myo_measure::{EndpointCloud, Line, Point, Spread};

/// Mean movement times in ms of the 16 conditions of Fitts' tapping task with the light stylus (1954, doi 10.1037/h0055392,
/// table 1): amplitudes 2, 4, 8, 16 inches by rows of widths 1/4, 1/2, 1, 2 inches.
const FITTS_1954: [[f64; 4]; 4] = [
    [392.0, 484.0, 580.0, 731.0],
    [281.0, 372.0, 469.0, 595.0],
    [212.0, 260.0, 357.0, 481.0],
    [180.0, 203.0, 279.0, 388.0],
];

fn fitts_1954() -> impl Iterator<Item = (f64, f64, f64)> {
    let row = |(row, times): (usize, [f64; 4])| {
        times
            .into_iter()
            .enumerate()
            .map(move |(column, time)| (2.0 * 2_f64.powi(column as i32), 0.25 * 2_f64.powi(row as i32), time))
    };
    FITTS_1954.into_iter().enumerate().flat_map(row)
}

/// MacKenzie 1992 (doi 10.1207/s15327051hci0701_3) has MT = 12.8 + 94.7 ID with r = 0.9831 for Fitts' own index; the standard
/// errors are those of SciPy 1.17.1, `linregress`.
#[test]
fn the_line_of_fitts_1954_is_the_published_one() {
    let (x, y): (Vec<f64>, Vec<f64>) =
        fitts_1954().map(|(distance, width, time)| ((2.0 * distance / width).log2(), time)).unzip();
    let line = Line::through(&x, &y).unwrap();
    assert_close(line.intercept, 12.8, 0.05);
    assert_close(line.slope, 94.7, 0.05);
    assert_close(line.r2.sqrt(), 0.9831, 5e-5);
    assert_close(line.slope_error, 4.718840467439309, 1e-9);
    assert_close(line.intercept_error, 20.2965002920982, 1e-9);
    assert_eq!(line.count, 16);
}

/// A trial along an axis that is none of the frame's, which ends `along` behind the centre and `across` beside it.
fn trial(distance: f64, movement_time_s: f64, along: f64, across: f64) -> Trial {
    let (axis, side) = ([0.6, 0.8, 0.0], [-0.8, 0.6, 0.0]);
    let start = [0.1, -0.2, 0.3];
    let at = |a: f64, b: f64| [0, 1, 2].map(|i| start[i] + a * axis[i] + b * side[i]);
    Trial { movement_time_s, start, target: at(distance, 0.0), end: at(distance + along, across) }
}

/// The same through conditions, in Shannon's form: SciPy 1.17.1, `linregress(log2(A / W + 1), MT)`.
#[test]
fn the_fit_through_conditions_is_that_of_scipy() {
    let inch = 0.0254;
    let conditions: Vec<Condition> = fitts_1954()
        .map(|(distance, width, time)| Condition {
            distance: distance * inch,
            width: width * inch,
            trials: [-1.0, 0.0, 1.0]
                .map(|side| trial(distance * inch, time * (1.0 + 0.1 * side) / 1e3, 0.001 * side, 0.0))
                .to_vec(),
        })
        .collect();
    let pointing = Pointing::of(&conditions).unwrap();
    let fit = pointing.fit().unwrap();
    assert_close(fit.slope, 0.11153652168668254, 1e-12);
    assert_close(fit.intercept, 0.027689100947925482, 1e-12);
    assert_close(fit.r2, 0.9873183232004622, 1e-12);
    assert_close(fit.slope_error, 0.0033784136315299397, 1e-12);
    let of_trials = pointing.fit_of_trials().unwrap();
    assert_close(of_trials.slope, fit.slope, 1e-12);
    assert!(of_trials.r2 < fit.r2 && of_trials.count == 48);
    // Quotients 1, 2, 4 ... 64.
    assert_eq!(pointing.distinct_indices(0.0, 10.0), 7);
    assert_eq!(pointing.distinct_indices(2_f64.log2(), 5_f64.log2()), 3);
}

#[test]
fn effective_measures_are_those_of_the_standard() {
    // SD along: 4 mm; covered on average: 300 mm and 2 mm.
    let along = [-0.004, 0.000, 0.004].map(|x| x + 0.002);
    let trials = along.map(|x| trial(0.3, 0.6, x, 0.001)).to_vec();
    let pointing = Pointing::of(&[Condition { distance: 0.3, width: 0.012, trials }]).unwrap();
    let condition = &pointing.conditions[0];
    assert_close(condition.index, (0.3_f64 / 0.012 + 1.0).log2(), 1e-12);
    assert_close(condition.sd_along.unwrap(), 0.004, 1e-12);
    assert_close(condition.effective_width().unwrap(), 4.133 * 0.004, 1e-12);
    assert_close(condition.effective_distance, 0.302, 1e-12);
    let index = (0.302_f64 / (4.133 * 0.004) + 1.0).log2();
    assert_close(condition.effective_index().unwrap(), index, 1e-12);
    assert_close(pointing.throughput().unwrap(), index / 0.6, 1e-12);
    // One of three ended 6.1 mm from the centre of a target of 12 mm; 1 mm on one of two axes across.
    assert_close(condition.misses, 1.0 / 3.0, 1e-12);
    assert_close(condition.rms_across, 0.001 * 0.5_f64.sqrt(), 1e-12);
}

#[test]
fn outliers_are_dropped_and_counted() {
    let usual = |i: usize| trial(0.3, 0.5 + 0.01 * (i % 5) as f64, 0.001 * (i % 7) as f64, 0.0);
    let mut trials: Vec<Trial> = (0..35).map(usual).collect();
    let usual = Pointing::of(&[Condition { distance: 0.3, width: 0.02, trials: trials.clone() }]).unwrap();
    assert_eq!(usual.dropped(), 0);
    trials.push(trial(0.3, 2.0, 0.003, 0.0));
    trials.push(trial(0.3, 0.52, -0.1, 0.0));
    let both = Pointing::of(&[Condition { distance: 0.3, width: 0.02, trials }]).unwrap();
    assert_eq!((both.dropped(), both.conditions[0].trials), (2, 35));
    assert_eq!(both.conditions[0].movement_time_s, usual.conditions[0].movement_time_s);
}

fn user(intercept: f64, slope: f64) -> Vec<Condition> {
    let condition = |width: f64| {
        let time = intercept + slope * index_of_difficulty(0.3, width);
        let trials = [-1.0, 0.0, 1.0].map(|side| trial(0.3, time, 0.2 * width * side, 0.0)).to_vec();
        Condition { distance: 0.3, width, trials }
    };
    [0.01, 0.02, 0.04, 0.08].map(condition).to_vec()
}

#[test]
fn users_are_summed_up_by_median_and_interval() {
    let slopes = [0.15, 0.2, 0.1, 0.18, 0.17];
    let users = Users::of(&slopes.map(|slope| user(0.1, slope))).unwrap();
    assert_close(users.slope.median, 0.17, 1e-9);
    assert_close(users.slope.mean, 0.16, 1e-9);
    assert_eq!(users.users.len(), 5);
    assert_close(users.r2.low, 1.0, 1e-9);
    assert!(users.throughput.interval.is_some());
    assert_eq!(Users::of(&[user(0.1, 0.2)]).unwrap().slope.interval, None);
    // SciPy 1.17.1: `t.interval(.95, 4, z.mean(), sem(z))`.
    let [low, high] = Spread::of(&[4.1, 5.2, 3.9, 4.8, 5.5]).unwrap().interval.unwrap();
    assert_close(low, 3.8442421457522027, 1e-9);
    assert_close(high, 5.555757854247798, 1e-9);
}

#[test]
fn what_gives_no_law_is_refused_by_reason() {
    let full = user(0.1, 0.2);
    let two = Pointing::of(&full[..2]).unwrap();
    assert_eq!(
        two.fit().unwrap_err().to_string(),
        "different indices of difficulty for a fit: 2 given, at least 3 are needed"
    );
    assert!(two.throughput().is_ok());
    assert_eq!(Pointing::of(&[]).unwrap_err().to_string(), "conditions: 0 given, at least 1 are needed");
    let changed = |change: fn(&mut Vec<Condition>)| {
        let mut conditions = full.clone();
        change(&mut conditions);
        Users::of(&[full.clone(), conditions]).unwrap_err().to_string()
    };
    assert_eq!(
        changed(|c| c[2].trials[1].movement_time_s = 0.0),
        "user 1: condition 2: movement time in s: 0 at index 1; it must be finite and greater than 0"
    );
    assert_eq!(
        changed(|c| c[0].width = -0.01),
        "user 1: condition 0: width in m: -0.01; it must be finite and greater than 0"
    );
    assert_eq!(changed(|c| c[1].trials.clear()), "user 1: condition 1: trials: 0 given, at least 1 are needed");
    assert_eq!(
        changed(|c| c[1].trials.truncate(2)),
        "user 1: condition 1: trials for an effective width: 2 given, at least 3 are needed"
    );
    assert_eq!(
        changed(|c| c[3].trials[0].target = c[3].trials[0].start),
        "user 1: condition 3: distance from start to target in m: 0 at index 0; it must be finite and greater than 0"
    );
    assert_eq!(
        changed(|c| c[3].trials[2].end[1] = f64::NAN),
        "user 1: condition 3: end of a trial in m: NaN at index 2; every number must be finite"
    );
    let same = changed(|c| c[0].trials = vec![c[0].trials[0]; 20]);
    assert!(same.starts_with("user 1: condition 0: SD of end points") && same.contains("motor noise"), "{same}");
}

/// NumPy 2.4.6: `cov` and `eigh` of `0.30 + 0.004 sin(1.7 k) + 0.002 cos(0.9 k), 0.003 sin(2.3 k), 0.002 cos(3.1 k)`
/// for k from 0 to 11, and the angle of the long axis to the first.
#[test]
fn clouds_are_those_of_numpy() {
    let stop = |k: f64| {
        [0.3 + 0.004 * (1.7 * k).sin() + 0.002 * (0.9 * k).cos(), 0.003 * (2.3 * k).sin(), 0.002 * (3.1 * k).cos()]
    };
    let stops: Vec<Point> = (0..12).map(|k| stop(f64::from(k))).collect();
    let cloud = EndpointCloud::of(&stops, [0.0; 3], [0.3, 0.0, 0.0]).unwrap();
    let covariance = [
        [1.2227721559230124e-05, 5.34170016371065e-07, -4.445657499904389e-07],
        [5.34170016371065e-07, 4.57083164024051e-06, -1.1899423789401935e-06],
        [-4.445657499904389e-07, -1.1899423789401935e-06, 4.0594215744687906e-06],
    ];
    for (row, expected) in cloud.covariance.iter().flatten().zip(covariance.iter().flatten()) {
        assert_close(*row, *expected, 1e-15);
    }
    for (sd, expected) in
        cloud.axes.into_iter().zip([0.0035070060387881576, 0.0023368514319122833, 0.001760116133387889])
    {
        assert_close(sd, expected, 1e-12);
    }
    assert_close(cloud.angle_deg.unwrap(), 5.863508454179466, 1e-9);
    assert_close(cloud.sd_along, 1.2227721559230124e-05_f64.sqrt(), 1e-12);
    let across = (0.5 * (4.57083164024051e-06 + 4.0594215744687906e-06_f64)).sqrt();
    assert_close(cloud.sd_across, across, 1e-12);
    assert_close(cloud.direction_sd_deg, (across / 0.3).atan().to_degrees(), 1e-12);
}

/// Six points on the axes of a box have a known covariance; along a slanting movement its quadratic form.
#[test]
fn clouds_of_known_shape_have_its_axes() {
    let [long, middle, short] = [0.008, 0.004, 0.002];
    let corners: [Point; 6] = [
        [long, 0.0, 0.0],
        [-long, 0.0, 0.0],
        [0.0, middle, 0.0],
        [0.0, -middle, 0.0],
        [0.0, 0.0, short],
        [0.0, 0.0, -short],
    ];
    let cloud = EndpointCloud::of(&corners, [-0.2, -0.2, 0.0], [0.0; 3]).unwrap();
    let variance = |half: f64| 2.0 * half * half / 5.0;
    for (sd, half) in cloud.axes.into_iter().zip([long, middle, short]) {
        assert_close(sd, variance(half).sqrt(), 1e-12);
    }
    assert_close(cloud.angle_deg.unwrap(), 45.0, 1e-9);
    assert_close(cloud.sd_along.powi(2), 0.5 * (variance(long) + variance(middle)), 1e-12);
    assert_close(cloud.overshoot, 0.0, 1e-15);
    let mirrored = corners.map(|[x, y, z]| [-x, -y, -z]);
    let other = EndpointCloud::of(&mirrored, [0.2, 0.2, 0.0], [0.0; 3]).unwrap();
    assert_close(other.sd_across, cloud.sd_across, 1e-15);
    let round = corners.map(|corner| corner.map(|x: f64| if x == 0.0 { 0.0 } else { 0.004 * x.signum() }));
    assert_eq!(EndpointCloud::of(&round, [-0.2, 0.0, 0.0], [0.0; 3]).unwrap().angle_deg, None);
}

#[test]
fn clouds_of_nothing_are_refused() {
    let refusal = |stops: &[Point], start| EndpointCloud::of(stops, start, [0.0; 3]).unwrap_err().to_string();
    assert_eq!(refusal(&[[0.0; 3]; 3], [1.0; 3]), "stops: 3 given, at least 4 are needed");
    assert_eq!(
        refusal(&[[0.0; 3]; 4], [0.0; 3]),
        "distance from start to target in m: 0; it must be finite and greater than 0"
    );
    let far = [[0.0; 3], [1e200; 3], [0.0; 3], [-1e200, 0.0, 0.0]];
    assert_eq!(refusal(&far, [1.0; 3]), "stop in m: 1e200 at index 1; it must be at most 1e60 in size");
}

#[test]
fn steering_law_of_made_up_times() {
    let tunnel = |width: f64| {
        let time = 0.2 + 0.08 * 0.3 / width;
        Tunnel { length: 0.3, width, times_s: vec![0.9 * time, 1.1 * time], left: 1 }
    };
    let steering = Steering::of(&[0.02, 0.03, 0.05, 0.08].map(tunnel)).unwrap();
    assert_close(steering.fit.slope, 0.08, 1e-12);
    assert_close(steering.fit.intercept, 0.2, 1e-12);
    assert_close(steering.left, 1.0 / 3.0, 1e-12);
    let refusal = Steering::of(&[0.02, 0.02, 0.03].map(tunnel)).unwrap_err().to_string();
    assert_eq!(refusal, "different quotients of length and width for a fit: 2 given, at least 3 are needed");
}
