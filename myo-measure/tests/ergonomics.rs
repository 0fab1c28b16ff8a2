//! Ergonomics against the figures that are published with the formulas.

use myo_measure::ergonomics::{UpperArm, consumed, nicer_endurance_s, rohmert_endurance_s};

#[test]
fn arms_are_held_as_long_as_published() {
    // Hincapié-Ramos et al. 2014: 20, 30, 50 % of the strength.
    for (share, seconds) in [(0.2, 385.0), (0.3, 159.0), (0.5, 65.0)] {
        let found = rohmert_endurance_s(share).unwrap();
        assert!((found - seconds).abs() < 1.5, "{share}: {found} s, not {seconds}");
    }
    assert_eq!(rohmert_endurance_s(0.15).unwrap(), f64::INFINITY);
    // The curve of the shoulder (Frey-Law and Avin 2010), of which NICER's is a rounded form.
    for (share, seconds) in [(0.1, 1005.0), (0.2, 283.0), (0.5, 53.0)] {
        let found = nicer_endurance_s(share).unwrap();
        assert!((found / seconds - 1.0).abs() < 0.01, "{share}: {found} s, not {seconds}");
    }
    assert_eq!(nicer_endurance_s(0.0).unwrap(), f64::INFINITY);
}

#[test]
fn longer_or_harder_work_takes_more_of_what_can_be_done() {
    let of = |share| consumed(60.0, rohmert_endurance_s(share).unwrap()).unwrap();
    assert_eq!(of(0.1), 0.0);
    assert!(of(0.2) < of(0.3) && of(0.3) < of(0.6));
    let twice = consumed(120.0, nicer_endurance_s(0.3).unwrap()).unwrap();
    assert!((twice - 2.0 * consumed(60.0, nicer_endurance_s(0.3).unwrap()).unwrap()).abs() < 1e-12);
}

#[test]
fn upper_arms_are_counted_as_the_score_has_them() {
    let at = |degrees| UpperArm::at(degrees).unwrap().score();
    assert_eq!([-20.0, 0.0, 20.0].map(at), [1; 3]);
    assert_eq!([-60.0, 20.1, 45.0].map(at), [2; 3]);
    assert_eq!([45.1, 90.0, 90.1, 180.0].map(at), [3, 3, 4, 4]);
    assert_eq!(UpperArm::shares(&[0.0, 10.0, 60.0, 100.0]).unwrap(), [0.5, 0.0, 0.25, 0.25]);
}

#[test]
fn what_cannot_be_is_refused() {
    for error in [
        rohmert_endurance_s(1.2).unwrap_err(),
        nicer_endurance_s(-0.1).unwrap_err(),
        rohmert_endurance_s(f64::NAN).unwrap_err(),
    ] {
        assert!(error.to_string().contains("share of strength"), "{error}");
    }
    assert!(consumed(-1.0, 10.0).unwrap_err().to_string().contains("seconds of work"));
    assert!(consumed(1.0, 0.0).unwrap_err().to_string().contains("endurance"));
    assert!(UpperArm::shares(&[]).unwrap_err().to_string().contains("angles of the upper arm"));
    let error = UpperArm::shares(&[1.0, f64::INFINITY]).unwrap_err().to_string();
    assert!(error.contains("at index 1"), "{error}");
}
