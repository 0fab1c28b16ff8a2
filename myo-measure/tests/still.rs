//! Holds, drives of muscles and taps that are known because they were made.

mod common;

use std::f64::consts::TAU;

use common::assert_close;
use myo_measure::drive::{co_contraction, group_activation};
use myo_measure::taps::{Contact, Press, Taps};
use myo_measure::{Drive, Hold, Point};

/// A hold of 3 s at 200 Hz: drift and sway along the first axis, tremor along the slant of the others.
fn hold(drift: f64, sway: f64, tremor: f64, tremor_hz: f64) -> Hold {
    let place = |i: i32| {
        let t = f64::from(i) / 200.0;
        let shake = tremor * (TAU * tremor_hz * t + 0.4).sin();
        [0.5 + drift * t + sway * (TAU * 0.7 * t).cos(), 0.6 * shake, 0.1 + 0.8 * shake]
    };
    Hold::of(&(0..=600).map(place).collect::<Vec<Point>>(), 200.0).unwrap()
}

#[test]
fn tremor_is_heard_through_drift_and_sway() {
    for tremor_hz in [6.0, 8.0, 8.37, 12.0] {
        let hold = hold(0.002, 0.010, 0.000_15, tremor_hz);
        assert_close(hold.tremor_peak_to_peak, 0.000_30, 0.000_012);
        assert_close(hold.tremor_rms, 0.000_15 / 2_f64.sqrt(), 0.000_006);
    }
    for outside_hz in [1.0, 25.0] {
        assert!(hold(0.0, 0.0, 0.001, outside_hz).tremor_peak_to_peak < 0.000_06, "{outside_hz}");
    }
}

#[test]
fn drift_and_speed_are_those_of_a_straight_motion() {
    let hold = hold(0.003, 0.0, 0.0, 8.0);
    assert_close(hold.duration_s, 3.0, 1e-12);
    assert_close(hold.drift, 0.009, 1e-9);
    assert_close(hold.mean_speed, 0.003, 1e-9);
    assert_close(hold.tremor_peak_to_peak, 0.0, 2e-5);
    let still = Hold::of(&[[0.1, 0.2, 0.3]; 201], 100.0).unwrap();
    assert_close(still.drift + still.mean_speed + still.tremor_peak_to_peak, 0.0, 1e-12);
}

#[test]
fn holds_too_short_or_too_coarse_are_refused() {
    let refusal = |n: usize, rate_hz| Hold::of(&vec![[0.0; 3]; n], rate_hz).unwrap_err().to_string();
    assert_eq!(refusal(100, 100.0), "samples of one second: 100 given, at least 101 are needed");
    assert_eq!(refusal(100, 30.0), "rate in Hz: 30; it must be finite and greater than 30");
    assert_eq!(refusal(0, f64::NAN), "rate in Hz: NaN; it must be finite and greater than 30");
}

#[test]
fn drives_are_counted_by_hand() {
    // Two muscles: one ramps by 0.01 per 10 ms, one switches between its ends every 50 ms.
    let rows = (0..100).flat_map(|i| [f64::from(i) / 100.0, if i / 5 % 2 == 0 { 0.0 } else { 1.0 }]);
    let drive = Drive::of(&rows.collect::<Vec<_>>(), 2, 100.0).unwrap();
    assert_close(drive.mean_of_muscles[0], 0.495, 1e-12);
    assert_close(drive.mean_of_muscles[1], 0.5, 1e-12);
    assert_close(drive.mean, 0.4975, 1e-12);
    // 0, 0.01, 0.02, 0.03, 0.04 and 50 zeros; 0.96, 0.97, 0.98, 0.99 and 50 ones.
    assert_close(drive.share_at_rest, 55.0 / 200.0, 1e-12);
    assert_close(drive.share_saturated, 54.0 / 200.0, 1e-12);
    assert_close(drive.change_per_50_ms, 0.5 * (0.05 + 1.0), 1e-12);
    // A rate of which 50 ms are no whole samples.
    let ramp: Vec<f64> = (0..50).map(|i| f64::from(i) / 100.0).collect();
    assert_close(Drive::of(&ramp, 1, 30.0).unwrap().change_per_50_ms, 0.015, 1e-12);
}

#[test]
fn co_contraction_goes_from_none_to_all() {
    assert_eq!(co_contraction(&[1.0, 0.0, 2.0], &[0.0, 3.0, 0.0]).unwrap(), 0.0);
    assert_eq!(co_contraction(&[1.0, 2.0], &[1.0, 2.0]).unwrap(), 1.0);
    assert_close(co_contraction(&[3.0, 0.0], &[1.0, 4.0]).unwrap(), 2.0 * 1.0 / 8.0, 1e-12);
    assert_eq!(co_contraction(&[1.0, 2.0], &[0.5, 1.0]), co_contraction(&[0.5, 1.0], &[1.0, 2.0]));
    let refusal = |f: &[f64], e: &[f64]| co_contraction(f, e).unwrap_err().to_string();
    assert_eq!(refusal(&[0.0], &[0.0]), "sum of flexors and extensors: 0; it must be finite and greater than 0");
    assert_eq!(refusal(&[0.0, -1.0], &[0.0; 2]), "flexors: -1 at index 1; it must be 0 or more");
    assert_eq!(refusal(&[0.0], &[]), "extensors: 0 entries, but 1 are needed to go with the rest");
}

#[test]
fn groups_are_means_of_their_muscles() {
    let activations = [0.1, 0.3, 0.9, 0.2, 0.4, 0.8];
    let group = group_activation(&activations, 3, &[0, 2]).unwrap();
    assert_close(group[0], 0.5, 1e-12);
    assert_close(group[1], 0.5, 1e-12);
    let refusal = group_activation(&activations, 3, &[0, 3]).unwrap_err().to_string();
    assert_eq!(refusal, "muscle of a group: 3 at index 1; it must be less than the number of muscles");
    let refusal = group_activation(&activations, 4, &[0]).unwrap_err().to_string();
    assert_eq!(refusal, "activations: 6 entries, but 4 are needed to go with the rest");
    let refusal = Drive::of(&[0.5, 1.5], 1, 20.0).unwrap_err().to_string();
    assert_eq!(refusal, "activation: 1.5 at index 1; it must be from 0 to 1");
    assert_eq!(Drive::of(&[], 0, 100.0).unwrap_err().to_string(), "muscles: 0 given, at least 1 are needed");
}

#[test]
fn presses_begin_and_end_at_their_own_thresholds() {
    // A touch that is no press, a press that wavers between the thresholds, another.
    let force = [0.0, 0.2, 0.0, 0.3, 0.6, 0.2, 0.4, 0.1, 0.05, 0.0, 0.0, 1.0, 0.0];
    let taps = Taps::of(&force, 100.0, Contact::default()).unwrap();
    let [first, second] = taps.presses[..] else { panic!("{:?}", taps.presses) };
    assert_eq!((first.begin, first.end, first.peak), (3, 8, 0.6));
    assert_close(first.contact_time_s, 0.05, 1e-12);
    assert_close(first.impulse, 0.016, 1e-12);
    assert_eq!(second, Press { begin: 11, end: 12, contact_time_s: 0.01, peak: 1.0, impulse: 0.01 });
    assert_eq!((taps.cut_off, taps.intervals_s.len()), (0, 1));
    assert_close(taps.median_interval_s().unwrap(), 0.08, 1e-12);
    assert_close(taps.median_contact_time_s().unwrap(), 0.03, 1e-12);
    assert_close(taps.median_peak().unwrap(), 0.8, 1e-12);
    assert_close(taps.median_impulse().unwrap(), 0.013, 1e-12);
}

#[test]
fn presses_that_the_recording_cuts_off_are_counted_apart() {
    let every = Contact { bounce_s: 0.0, ..Contact::default() };
    let taps = Taps::of(&[0.5, 0.0, 0.5, 0.0, 0.5], 100.0, every).unwrap();
    assert_eq!((taps.presses.len(), taps.cut_off), (1, 2));
    assert_eq!(taps.median_interval_s().unwrap_err().to_string(), "whole presses: 1 given, at least 2 are needed");
    let none = Taps::of(&[0.0; 10], 100.0, Contact::default()).unwrap();
    assert_eq!(none.median_peak().unwrap_err().to_string(), "whole presses: 0 given, at least 1 are needed");
}

#[test]
fn a_fingertip_that_bounces_presses_once() {
    // Off for 10 ms, then for 40 ms.
    let force = [0.0, 0.5, 0.8, 0.0, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0, 0.6, 0.0];
    let presses = |bounce_s| Taps::of(&force, 100.0, Contact { bounce_s, ..Contact::default() }).unwrap().presses;
    let of = |presses: Vec<Press>| presses.iter().map(|press| (press.begin, press.end)).collect::<Vec<_>>();
    assert_eq!(of(presses(0.03)), [(1, 6), (10, 11)]);
    assert_eq!(of(presses(0.0)), [(1, 3), (4, 6), (10, 11)]);
    assert_eq!(presses(0.03)[0].peak, 0.8);
}

#[test]
fn forces_that_cannot_be_are_refused() {
    let refusal = |force: &[f64], contact| Taps::of(force, 100.0, contact).unwrap_err().to_string();
    let usual = Contact::default();
    assert_eq!(refusal(&[0.0, -0.1], usual), "contact force in N: -0.1 at index 1; it must be 0 or more");
    assert_eq!(refusal(&[f64::NAN], usual), "contact force in N: NaN at index 0; every number must be finite");
    assert_eq!(refusal(&[], usual), "samples of force: 0 given, at least 1 are needed");
    let upside_down = Contact { press: 0.1, release: 0.3, ..usual };
    assert_eq!(refusal(&[0.0], upside_down), "press in N: 0.1; it must be greater than the release");
}
