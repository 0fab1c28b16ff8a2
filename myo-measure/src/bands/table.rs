//! The bands as data.

use super::Confidence::{Fair, Good, Unreliable};
use super::{Band, Bound, Confidence, Figure};

/// All bands by number. Sources of their figures, as far as they have one in print:
///
/// | band | drawn from |
/// |---|---|
/// | 1-3 | Fitts 1954 (doi 10.1037/h0055392), MacKenzie 1992 (10.1207/s15327051hci0701_3) and 2015 (10.1007/978-3-319-20916-6_23) |
/// | 4 | a and b of pointing in air: derived, not measured |
/// | 5, 6 | Flash and Hogan 1985 (10.1523/JNEUROSCI.05-07-01688.1985) for the ideal, Gordon et al. 1994 (10.1007/BF00241415), MacKenzie et al. 1987 for skew |
/// | 7 | Smyrnis et al. 2000 (10.1007/s002210000416), and reviews of submovements |
/// | 8 | Balasubramanian et al. 2015 (10.1186/s12984-015-0090-9), Gulde and Hermsdörfer 2018 (10.3389/fneur.2018.00615) |
/// | 9 | Atkeson and Hollerbach 1985 (10.1523/JNEUROSCI.05-09-02318.1985) |
/// | 10 | Gordon et al. 1994, van Beers et al. 2004 (10.1152/jn.00652.2003) |
/// | 11 | tremor of outstretched arms (Arch Neurol 1982;39:358), Lakie et al. 2015 (10.1113/JP270464) |
/// | 12 | Gribble et al. 2003 for co-contraction; levels of EMG in pointing |
/// | 13 | Asakawa et al. 2017 (J Electromyogr Kinesiol 34:6), Dhakal et al. 2018 (10.1145/3173574.3174220), rates of tapping |
/// | 14, 15 | strength and endurance of shoulder and elbow |
pub const BANDS: [Band; 15] = [
    Band {
        number: 1,
        what: "Fitts' law on means of conditions, at least 8 indices from 1.5 to 5 bits",
        requires: &[least(Figure::DistinctIndices, 8.0, Good)],
        bounds: &[least(Figure::FitR2, 0.90, Good)],
    },
    band(2, "slope of Fitts' law", &[range(Figure::FitSlope, 0.09, 0.30, Good)]),
    // Above 8 bit/s nobody points; from 7.5 to 8 the band leaves open, which is not passing either.
    band(3, "effective throughput without dwell and reaction", &[range(Figure::Throughput, 2.5, 7.5, Good)]),
    band(4, "movement time over 30 cm to 5 cm", &[reported(range(Figure::MovementTime30, 0.45, 1.0, Unreliable))]),
    band(
        5,
        "peak speed over 30 cm, peak over mean speed",
        &[range(Figure::PeakSpeed30, 0.7, 1.8, Fair), range(Figure::PeakOverMean, 1.6, 2.3, Fair)],
    ),
    band(
        6,
        "time of peak speed, earlier for smaller targets",
        &[range(Figure::TimeOfPeak, 0.30, 0.52, Fair), below(Figure::TimeOfPeakPerBit, 0.0, Fair)],
    ),
    band(
        7,
        "speed maxima per movement, more for harder targets",
        &[
            range(Figure::SpeedMaximaEasy, 1.0, 2.0, Fair),
            range(Figure::SpeedMaximaHard, 1.0, 4.0, Fair),
            above(Figure::SpeedMaximaPerBit, 0.0, Fair),
        ],
    ),
    band(
        8,
        "smoothness",
        &[range(Figure::Sparc, -1.75, -1.40, Good), reported(range(Figure::Ldlj, -7.5, -5.0, Unreliable))],
    ),
    band(
        9,
        "path over chord",
        &[range(Figure::PathOverChord, 1.01, 1.12, Fair), most(Figure::PathOverChordFromHanging, 1.25, Fair)],
    ),
    band(
        10,
        "end points without sight of the hand: longer along the movement, the more the further",
        &[
            above(Figure::EndpointElongation, 1.0, Good),
            above(Figure::EndpointGrowth, 0.0, Good),
            reported(range(Figure::EndpointDirectionDeg, 2.0, 4.0, Unreliable)),
        ],
    ),
    band(11, "hold: speed and tremor", &[most(Figure::HoldSpeed, 0.020, Good), most(Figure::Tremor, 0.000_5, Good)]),
    band(
        12,
        "drive of muscles",
        &[
            most(Figure::MeanActivation, 0.20, Fair),
            reported(most(Figure::ShareSaturated, 0.02, Unreliable)),
            most(Figure::ElbowCoContraction, 0.45, Fair),
        ],
    ),
    band(
        13,
        "taps",
        &[
            range(Figure::TapPeakForce, 0.3, 2.0, Good),
            range(Figure::TapContactTime, 0.060, 0.220, Good),
            most(Figure::TapRate, 6.5, Good),
        ],
    ),
    band(
        14,
        "strength: share taken by holding, moment arms",
        &[range(Figure::HoldingShare, 0.12, 0.35, Good), most(Figure::MomentArmSignChanges, 0.0, Good)],
    ),
    band(
        15,
        "fatigue: endurance over that of people, waist against shoulder",
        &[
            least(Figure::EnduranceLeast, 0.6, Good),
            most(Figure::EnduranceGreatest, 1.6, Good),
            most(Figure::EnduranceRises, 0.0, Good),
            below(Figure::WaistOverShoulder, 1.0, Good),
        ],
    ),
];

const fn band(number: u8, what: &'static str, bounds: &'static [Bound]) -> Band {
    Band { number, what, requires: &[], bounds }
}

const fn bound(figure: Figure, limits: [Option<f64>; 2], closed: bool, confidence: Confidence) -> Bound {
    Bound { figure, lower: limits[0], upper: limits[1], closed, confidence, judged: true }
}

const fn range(figure: Figure, lower: f64, upper: f64, confidence: Confidence) -> Bound {
    bound(figure, [Some(lower), Some(upper)], true, confidence)
}

const fn least(figure: Figure, lower: f64, confidence: Confidence) -> Bound {
    bound(figure, [Some(lower), None], true, confidence)
}

const fn most(figure: Figure, upper: f64, confidence: Confidence) -> Bound {
    bound(figure, [None, Some(upper)], true, confidence)
}

const fn above(figure: Figure, lower: f64, confidence: Confidence) -> Bound {
    bound(figure, [Some(lower), None], false, confidence)
}

const fn below(figure: Figure, upper: f64, confidence: Confidence) -> Bound {
    bound(figure, [None, Some(upper)], false, confidence)
}

const fn reported(bound: Bound) -> Bound {
    Bound { judged: false, ..bound }
}
