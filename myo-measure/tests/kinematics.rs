//! Figures of movements that others worked out, and what must not change them.

mod common;

use common::{along_x, assert_close, minimum_jerk, minimum_jerk_speed, reach};
use myo_measure::smoothness::{ldlj, sparc};
use myo_measure::{Edge, MeasureError, Movement, Point, signal};

fn measure(positions: &[Point], rate_hz: f64) -> Movement {
    Movement::of(positions, rate_hz, Edge::Threshold, Edge::Threshold).unwrap()
}

#[test]
fn minimum_jerk_has_the_figures_of_its_formula() {
    for (rate_hz, distance, duration_s) in [(1000.0, 0.3, 0.6), (500.0, 0.1, 1.2), (1000.0, 0.5, 0.4)] {
        let positions = reach(rate_hz, distance, duration_s);
        let whole = |s: f64| Edge::Sample((s * rate_hz).round() as usize);
        let movement = Movement::of(&positions, rate_hz, whole(0.2), whole(0.2 + duration_s)).unwrap();
        assert_close(movement.duration_s, duration_s, 1e-12);
        assert_close(movement.peak_speed, 1.875 * distance / duration_s, 1e-3);
        assert_close(movement.peak_over_mean, 1.875, 1e-3);
        assert_close(movement.time_of_peak, 0.5, 1e-3);
        assert_close(movement.path, distance, 1e-9);
        assert_close(movement.chord, distance, 1e-9);
        assert_close(movement.path_over_chord.unwrap(), 1.0, 1e-9);
        assert_eq!(movement.speed_maxima, 1);
        assert_close(movement.ldlj, -204.8_f64.ln(), 0.02);
        assert_close(movement.sparc, -1.40, 0.01);
    }
}

/// The speed of minimum jerk is 5 % of its peak where `s (1 - s) = sqrt(0.05) / 4`.
#[test]
fn edges_are_where_the_speed_crosses_the_threshold() {
    let (rate_hz, duration_s) = (1000.0, 0.8);
    let movement = measure(&reach(rate_hz, 0.3, duration_s), rate_hz);
    let s = 0.5 * (1.0 - (1.0 - 0.05_f64.sqrt()).sqrt());
    assert_close(movement.onset as f64, (0.2 + s * duration_s) * rate_hz, 1.0);
    assert_close(movement.end as f64, (0.2 + (1.0 - s) * duration_s) * rate_hz, 1.0);
    assert_close(movement.ldlj, -4.4, 0.05);
}

/// At 100 Hz, the least rate that movements should be recorded at, the same figures are a little off.
#[test]
fn coarse_recordings_have_nearly_the_same_figures() {
    let whole = Movement::of(&reach(100.0, 0.3, 0.6), 100.0, Edge::Sample(20), Edge::Sample(80)).unwrap();
    assert_close(whole.peak_speed, 1.875 * 0.3 / 0.6, 1e-3);
    assert_close(whole.sparc, -1.40, 0.005);
    assert_close(whole.ldlj, -204.8_f64.ln(), 0.06);
    assert_close(measure(&reach(100.0, 0.3, 0.6), 100.0).time_of_peak, 0.5, 0.01);
}

#[test]
fn jerk_of_whole_bells_is_that_of_the_integral() {
    let bell: Vec<f64> = (0..=1000).map(|i| minimum_jerk_speed(f64::from(i) / 1000.0)).collect();
    assert_close(ldlj(&bell, 1000.0).unwrap(), -204.8_f64.ln(), 1e-4);
    // -log(8 quad(lambda t: ((100 t^2 - 10) exp(-5 t^2))^2, -1, 1)) of SciPy 1.17.1, with T = 2 and a peak of 1.
    let gauss: Vec<f64> = (-1000..=1000).map(|i| (-5.0 * (f64::from(i) / 1000.0).powi(2)).exp()).collect();
    assert_close(ldlj(&gauss, 1000.0).unwrap(), -5.816967784035892, 1e-4);
}

/// The example of the authors' own program (repository siva82kb/SPARC, `scripts/smoothness.py`: -1.41403), and two profiles
/// that its formula was evaluated on with NumPy 2.4.6.
#[test]
fn spectral_arc_length_is_that_of_its_authors() {
    let gauss: Vec<f64> = (-100..100).map(|i| (-5.0 * (f64::from(i) / 100.0).powi(2)).exp()).collect();
    assert_close(sparc(&gauss, 100.0).unwrap(), -1.41403, 5e-6);
    let wobble = |i: i32| {
        let (bell, turn) = (std::f64::consts::PI * f64::from(i) / 80.0, std::f64::consts::TAU * f64::from(i) / 100.0);
        bell.sin().powi(2) * (1.0 + 0.3 * (6.0 * turn).sin())
    };
    assert_close(sparc(&(0..=80).map(wobble).collect::<Vec<_>>(), 100.0).unwrap(), -1.8092151860693448, 1e-9);
    let few = [0.1, 0.4, 0.9, 1.3, 1.1, 0.7, 0.8, 0.6, 0.3, 0.1];
    assert_close(sparc(&few, 100.0).unwrap(), -1.1802899994214304, 1e-9);
}

#[test]
fn overlapping_submovements_are_counted() {
    let (rate_hz, first) = (200.0, |t: f64| 0.25 * minimum_jerk((t - 0.2) / 0.5));
    let second = |begin: f64| move |t: f64| first(t) + 0.05 * minimum_jerk((t - begin) / 0.3);
    assert_eq!(measure(&along_x(rate_hz, 1.2, second(0.6)), rate_hz).speed_maxima, 2);
    // Begun earlier, it drowns in the first.
    assert_eq!(measure(&along_x(rate_hz, 1.2, second(0.3)), rate_hz).speed_maxima, 1);
}

/// SciPy 1.17.1: `v = abs(gradient(x, 0.01, edge_order=2))`, `len(find_peaks(v, prominence=0.05 * v.max())[0])`; one more maximum has a
/// prominence of 0.0036 of the peak.
#[test]
fn maxima_are_those_of_scipy() {
    let speed = |i: f64| ((0.21 * i).sin() + 0.6 * (0.83 * i).sin() + 0.1 * (2.9 * i).sin()).abs();
    let place = |n: usize| (0..n).map(|i| speed(i as f64) / 100.0).sum::<f64>();
    let positions: Vec<Point> = (0..40).map(|n| [place(n), 0.0, 0.0]).collect();
    let movement = Movement::of(&positions, 100.0, Edge::Sample(0), Edge::Sample(39)).unwrap();
    assert_eq!(movement.speed_maxima, 5);
}

#[test]
fn size_and_pace_leave_the_shape_as_it_is() {
    let place = |t: f64| 0.25 * minimum_jerk((t - 0.2) / 0.5) + 0.06 * minimum_jerk((t - 0.55) / 0.3);
    let usual = measure(&along_x(1000.0, 1.1, place), 1000.0);
    for (size, pace) in [(2.0, 1.0), (0.1, 1.0), (1.0, 2.0), (3.0, 0.5)] {
        // A slower movement, recorded at a lower rate, has the same samples.
        let rate_hz = 1000.0 / pace;
        let other = measure(&along_x(rate_hz, 1.1 * pace, |t| size * place(t / pace)), rate_hz);
        assert_close(other.peak_speed, usual.peak_speed * size / pace, 1e-9);
        assert_close(other.duration_s, usual.duration_s * pace, 1e-9);
        assert_close(other.peak_over_mean, usual.peak_over_mean, 1e-9);
        assert_close(other.time_of_peak, usual.time_of_peak, 1e-9);
        assert_close(other.ldlj, usual.ldlj, 1e-6);
        assert_close(other.sparc, usual.sparc, 0.01);
        assert_eq!(other.speed_maxima, usual.speed_maxima);
    }
}

#[test]
fn mirrored_turned_and_moved_movements_have_the_same_figures() {
    let curve = |t: f64| {
        let s = minimum_jerk((t - 0.2) / 0.7);
        [0.3 * s, 0.05 * (3.0 * s).sin(), 0.02 * s * s]
    };
    let positions: Vec<Point> = (0..220).map(|i| curve(f64::from(i) / 200.0)).collect();
    let usual = measure(&positions, 200.0);
    assert!(usual.path_over_chord.unwrap() > 1.01);
    let (sine, cosine) = 0.7_f64.sin_cos();
    let changes: [fn(Point, f64, f64) -> Point; 3] = [
        |[x, y, z], _, _| [-x, y, z],
        |[x, y, z], sine, cosine| [cosine * x - sine * y, sine * x + cosine * y, z],
        |[x, y, z], _, _| [x + 0.4, y - 1.0, z + 2.0],
    ];
    for change in changes {
        let changed: Vec<Point> = positions.iter().map(|&point| change(point, sine, cosine)).collect();
        let other = measure(&changed, 200.0);
        assert_eq!((other.onset, other.end, other.speed_maxima), (usual.onset, usual.end, usual.speed_maxima));
        assert_close(other.path_over_chord.unwrap(), usual.path_over_chord.unwrap(), 1e-9);
        assert_close(other.peak_speed, usual.peak_speed, 1e-9);
        assert_close(other.sparc, usual.sparc, 1e-9);
        assert_close(other.ldlj, usual.ldlj, 1e-6);
    }
}

#[test]
fn there_and_back_has_no_chord() {
    let positions = along_x(200.0, 1.6, |t| 0.2 * (minimum_jerk((t - 0.2) / 0.6) - minimum_jerk((t - 0.8) / 0.6)));
    let movement = Movement::of(&positions, 200.0, Edge::Sample(20), Edge::Sample(300)).unwrap();
    assert_eq!((movement.path_over_chord, movement.speed_maxima), (None, 2));
}

#[test]
fn what_is_no_movement_is_refused_by_reason() {
    let refusal = |positions: &[Point], rate_hz: f64, onset, end| -> String {
        Movement::of(positions, rate_hz, onset, end).unwrap_err().to_string()
    };
    let (free, positions) = (Edge::Threshold, reach(100.0, 0.3, 0.6));
    assert_eq!(refusal(&[], 100.0, free, free), "samples: 0 given, at least 3 are needed");
    assert_eq!(refusal(&[[0.5; 3]; 50], 100.0, free, free), "peak speed in m/s: 0; it must be greater than 0");
    assert_eq!(refusal(&positions, 0.0, free, free), "rate in Hz: 0; it must be greater than 0 and at most 1e60");
    assert_eq!(refusal(&positions, 20.0, free, free), "rate in Hz: 20; it must be greater than 20");
    let mut broken = positions.clone();
    broken[7][2] = f64::INFINITY;
    assert_eq!(refusal(&broken, 100.0, free, free), "positions: inf at index 7; every number must be finite");
    assert_eq!(refusal(&positions, 100.0, free, Edge::Sample(101)), "end: 101; it must be a sample of the recording");
    assert_eq!(refusal(&positions, 100.0, Edge::Sample(40), Edge::Sample(40)), "end: 40; it must be after the onset");
    assert_eq!(
        refusal(&positions, 100.0, Edge::Sample(40), Edge::Sample(44)),
        "samples of speed: 5 given, at least 7 are needed"
    );
    assert!(matches!(
        Movement::of(&positions[40..], 100.0, free, free),
        Err(MeasureError::NoEdge { what: "onset of the movement", index: 0, .. })
    ));
    assert_eq!(
        refusal(&positions[..51], 100.0, free, free),
        "end of the movement: the speed at index 50 is 1.000 of the peak and never below 0.05; let the recording last longer, \
         or give the sample of the end"
    );
}

/// SciPy 1.17.1: `filtfilt(*butter(2, cutoff, kind, fs=100), x, padtype="odd", padlen=max(9, ceil(100 / cutoff)))` of
/// `x = sin(0.3 i) + 0.2 cos(2.1 i) + 0.01 i` for i from 0 to 39, at samples 0, 1, 10, 20, 38 and 39.
#[test]
fn filters_are_those_of_scipy() {
    let x: Vec<f64> = (0..40).map(f64::from).map(|i| (0.3 * i).sin() + 0.2 * (2.1 * i).cos() + 0.01 * i).collect();
    let check = |filtered: Vec<f64>, expected: [f64; 6]| {
        for (sample, expected) in [0, 1, 10, 20, 38, 39].into_iter().zip(expected) {
            assert_close(filtered[sample], expected, 1e-12);
        }
    };
    check(
        signal::low_pass(&x, 100.0, 10.0).unwrap(),
        [
            0.19852295125721345,
            0.4029709638517811,
            0.23486042067500484,
            -0.06706390065273526,
            -0.3607891429893383,
            -0.1781435755813099,
        ],
    );
    check(
        signal::low_pass(&x, 100.0, 20.0).unwrap(),
        [
            0.20003087729848218,
            0.3242814439758927,
            0.23767928449062192,
            -0.0812359622338888,
            -0.5046273423074805,
            -0.1769037819248794,
        ],
    );
    check(
        signal::high_pass(&x, 100.0, 10.0).unwrap(),
        [
            0.0014770486335734384,
            -0.19841997839448466,
            -0.10328624938764445,
            -0.09234781529933407,
            -0.23844523247390967,
            0.00014127072107786298,
        ],
    );
}

#[test]
fn filters_keep_straight_lines_and_halve_the_cut_off() {
    let line: Vec<f64> = (0..300).map(|i| 0.1 - 0.02 * f64::from(i)).collect();
    for (filtered, line) in signal::low_pass(&line, 100.0, 5.0).unwrap().into_iter().zip(&line) {
        assert_close(filtered, *line, 1e-3);
    }
    let sine = |hz: f64, i: i32| (std::f64::consts::TAU * hz * f64::from(i) / 200.0).sin();
    let at_cutoff: Vec<f64> = (0..800).map(|i| sine(10.0, i)).collect();
    let filtered = signal::low_pass(&at_cutoff, 200.0, 10.0).unwrap();
    for i in 200..600 {
        assert_close(filtered[i], 0.5 * at_cutoff[i], 1e-6);
    }
}

#[test]
fn parabolas_survive_resampling_and_derivatives() {
    let parabola = |t: f64| 0.3 - 1.2 * t + 4.0 * t * t;
    let times: Vec<f64> = (0..50).map(|i| 0.01 * f64::from(i) + 0.003 * (2.0 * f64::from(i)).sin()).collect();
    let x: Vec<f64> = times.iter().map(|&t| parabola(t)).collect();
    let even = signal::resample(&times, &x, 250.0).unwrap();
    assert_eq!(even.len(), ((times[49] - times[0]) * 250.0) as usize + 1);
    for (i, x) in even.iter().enumerate() {
        assert_close(*x, parabola(times[0] + i as f64 / 250.0), 1e-12);
    }
    for (i, slope) in signal::derivative(&even, 250.0).unwrap().into_iter().enumerate() {
        assert_close(slope, -1.2 + 8.0 * (times[0] + i as f64 / 250.0), 1e-9);
    }
}

#[test]
fn bands_of_a_signal_are_sharp() {
    let wave = |hz: f64, t: f64| (std::f64::consts::TAU * hz * t).sin();
    let times = || (0..400).map(|i| f64::from(i) / 200.0);
    let x: Vec<f64> = times().map(|t| wave(3.5, t) + 2.0 * wave(8.0, t) + 0.5 * wave(20.0, t)).collect();
    for (found, t) in signal::band(&x, 200.0, 4.0, 15.0).unwrap().into_iter().zip(times()) {
        assert_close(found, 2.0 * wave(8.0, t), 1e-9);
    }
}

#[test]
fn uneven_times_are_refused_where_they_are() {
    let mut times: Vec<f64> = (0..20).map(|i| 0.01 * f64::from(i)).collect();
    assert_close(signal::rate_of(&times).unwrap(), 100.0, 1e-9);
    times[7] += 0.004;
    let refusal = signal::rate_of(&times).unwrap_err();
    assert!(matches!(refusal, MeasureError::UnevenTimes { index: 6, .. }), "{refusal}");
    assert!(refusal.to_string().contains("between samples 6 and 7"), "{refusal}");
    times[7] = times[6];
    let refusal = signal::rate_of(&times).unwrap_err().to_string();
    assert_eq!(refusal, "steps in time in s: 0 at index 6; it must be finite and greater than 0");
    let x = vec![0.0; 20];
    assert!(signal::resample(&times, &x, 100.0).is_err());
    times[7] = 0.07;
    let refusal = signal::resample(&times, &x, 1e30).unwrap_err().to_string();
    assert!(refusal.contains("at most 1000 samples"), "{refusal}");
    let refusal = signal::low_pass(&x, 100.0, 50.0).unwrap_err().to_string();
    assert_eq!(refusal, "cut-off in Hz: 50; it must be greater than 0 and less than half the rate");
}
