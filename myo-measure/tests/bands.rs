//! Bands: what passes, fails, is missing or is only reported.

use myo_measure::bands::{BANDS, Confidence, Figure, Figures, Verdict, judge};

fn figures(values: &[(Figure, f64)]) -> Figures {
    let mut figures = Figures::new();
    for &(figure, value) in values {
        figures.set(figure, value).unwrap();
    }
    figures
}

fn verdict(band: usize, values: &[(Figure, f64)]) -> Verdict {
    judge(&figures(values))[band - 1].verdict
}

#[test]
fn bands_are_numbered_and_hold_their_limits() {
    for (index, band) in BANDS.iter().enumerate() {
        assert_eq!(usize::from(band.number), index + 1);
        for bound in band.bounds {
            assert!(bound.lower.is_some() || bound.upper.is_some(), "{band:?}");
            assert!(bound.lower.zip(bound.upper).is_none_or(|(lower, upper)| lower < upper), "{band:?}");
            assert_eq!(bound.judged, bound.confidence != Confidence::Unreliable, "{band:?}");
            for limit in [bound.lower, bound.upper].into_iter().flatten() {
                assert_eq!(bound.holds(limit), bound.closed, "{band:?}");
            }
        }
    }
}

#[test]
fn nothing_measured_is_nothing_passed() {
    assert!(judge(&Figures::new()).iter().all(|judged| judged.verdict == Verdict::NotMeasured));
    let refusal = Figures::new().set(Figure::FitR2, f64::NAN).unwrap_err().to_string();
    assert_eq!(refusal, "figure: NaN; it must be finite; leave out what was not measured");
}

#[test]
fn a_good_fit_through_few_indices_does_not_count() {
    let fit = (Figure::FitR2, 0.99);
    assert_eq!(verdict(1, &[fit]), Verdict::NotMeasured);
    assert_eq!(verdict(1, &[fit, (Figure::DistinctIndices, 4.0)]), Verdict::NotMeasured);
    assert_eq!(verdict(1, &[fit, (Figure::DistinctIndices, 8.0)]), Verdict::Passed);
    assert_eq!(verdict(1, &[(Figure::FitR2, 0.61), (Figure::DistinctIndices, 8.0)]), Verdict::Failed);
}

#[test]
fn one_failure_fails_and_one_gap_leaves_open() {
    assert_eq!(verdict(5, &[(Figure::PeakSpeed30, 1.0), (Figure::PeakOverMean, 1.9)]), Verdict::Passed);
    assert_eq!(verdict(5, &[(Figure::PeakSpeed30, 1.0)]), Verdict::NotMeasured);
    assert_eq!(verdict(5, &[(Figure::PeakSpeed30, 2.4)]), Verdict::Failed);
    assert_eq!(verdict(10, &[(Figure::EndpointElongation, 1.0)]), Verdict::Failed);
}

#[test]
fn what_is_unreliable_is_reported_and_not_judged() {
    assert_eq!(verdict(4, &[(Figure::MovementTime30, 0.7)]), Verdict::Reported);
    assert_eq!(verdict(4, &[(Figure::MovementTime30, 7.0)]), Verdict::Reported);
    assert_eq!(verdict(8, &[(Figure::Sparc, -1.5), (Figure::Ldlj, -20.0)]), Verdict::Passed);
    assert_eq!(verdict(8, &[(Figure::Sparc, -1.5)]), Verdict::Passed);
    assert_eq!(verdict(8, &[(Figure::Ldlj, -6.0)]), Verdict::NotMeasured);
    let along = [(Figure::EndpointElongation, 1.5), (Figure::EndpointGrowth, 0.03)];
    assert_eq!(verdict(10, &[along[0], along[1], (Figure::EndpointDirectionDeg, 9.0)]), Verdict::Passed);
    let drive = [(Figure::MeanActivation, 0.1), (Figure::ElbowCoContraction, 0.2), (Figure::ShareSaturated, 0.5)];
    assert_eq!(verdict(12, &drive), Verdict::Passed);
}

/// Figures of published logs of a muscle-driven user that moves too fast, trembles and saturates its muscles.
#[test]
fn a_user_that_is_not_like_people_fails_where_it_is_not() {
    let found = figures(&[
        (Figure::FitR2, 0.61),
        (Figure::DistinctIndices, 8.0),
        (Figure::FitSlope, 0.153),
        (Figure::Throughput, 9.2),
        (Figure::PeakSpeed30, 2.4),
        (Figure::PeakOverMean, 2.0),
        (Figure::Sparc, -1.44),
        (Figure::Ldlj, -6.8),
        (Figure::PathOverChord, 1.03),
        (Figure::PathOverChordFromHanging, 1.21),
        (Figure::HoldSpeed, 0.188),
        (Figure::MeanActivation, 0.52),
        (Figure::ElbowCoContraction, 0.64),
    ]);
    let judged = judge(&found);
    let with = |verdict: Verdict| -> Vec<u8> {
        judged.iter().filter(|judged| judged.verdict == verdict).map(|judged| judged.band.number).collect()
    };
    assert_eq!(with(Verdict::Failed), [1, 3, 5, 11, 12]);
    assert_eq!(with(Verdict::Passed), [2, 8, 9]);
    let throughput = judged[2].findings[0];
    assert_eq!((throughput.value, throughput.bound.to_string().as_str()), (Some(9.2), "from 2.5 to 7.5"));
}
