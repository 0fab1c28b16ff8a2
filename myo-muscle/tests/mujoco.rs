//! Against figures of MuJoCo 3.17.0: `mju_muscleGain`, `mju_muscleBias` and `mju_muscleDynamics`.

use myo_muscle::{CurveParameters, Muscle, MuscleParameters};

fn muscle(tau_smooth: f64) -> Muscle<f64> {
    let curve = CurveParameters {
        range: [0.75, 1.05],
        force: Some(500.0),
        scale: 200.0,
        lmin: 0.5,
        lmax: 1.6,
        vmax: 1.5,
        fpmax: 1.3,
        fvmax: 1.2,
    };
    let parameters = MuscleParameters {
        length_range: [0.1, 0.2],
        gain: curve.clone(),
        bias: curve,
        tau_act: 0.01,
        tau_deact: 0.04,
        tau_smooth,
        ctrl_range: [0.0, 1.0],
        group: None,
    };
    Muscle::new(&parameters, 1.0)
}

/// Length (m), velocity (m/s), gain (N), bias (N).
const FORCES: &[[f64; 4]] = &[
    [0.0, -0.6666666666666667, 0.0, 0.0],
    [0.0, 0.16666666666666669, 0.0, 0.0],
    [0.049999999999999996, 0.05, -45.99999999999997, 0.0],
    [0.1166666666666667, 0.0, -340.00000000000006, 0.0],
    [0.16666666666666669, -0.23333333333333334, -139.3777777777778, 0.0],
    [0.18333333333333335, -0.6666666666666667, 0.0, 0.0],
    [0.18333333333333335, 0.16666666666666669, -600.0, 0.0],
    [0.21666666666666673, 0.05, -543.0555555555554, -36.111111111111164],
    [0.2666666666666667, 0.0, -326.38888888888863, -225.69444444444477],
    [0.33333333333333337, -0.23333333333333334, -17.77777777777775, -650.0000000000003],
    [0.41666666666666674, -0.6666666666666667, 0.0, -1191.6666666666667],
    [0.41666666666666674, 0.16666666666666669, 0.0, -1191.6666666666667],
    [0.0, 0.0, 0.0, 0.0],
    [0.1166666666666667, -0.23333333333333334, -96.71111111111112, 0.0],
    [0.18333333333333335, -0.6666666666666667, 0.0, 0.0],
    [0.21666666666666673, 0.16666666666666669, -566.6666666666666, -36.111111111111164],
    [0.33333333333333337, 0.05, -71.87499999999989, -650.0000000000003],
];

/// Smoothing, excitation, activation, rate (1/s).
const RATES: &[[f64; 4]] = &[
    [0.0, 0.0, 0.5, -15.625],
    [0.0, 1.0, 0.2, 100.0],
    [0.0, 0.45, 0.5, -1.5624999999999996],
    [0.0, 0.55, 0.5, 4.0000000000000036],
    [0.0, 0.7, 0.0, 140.0],
    [0.0, 1.5, 0.9, 5.4054054054054035],
    [0.0, -0.5, 0.1, -1.6250000000000002],
    [0.2, 0.0, 0.5, -15.625],
    [0.2, 1.0, 0.2, 100.0],
    [0.2, 0.45, 0.5, -1.667698120582391],
    [0.2, 0.55, 0.5, 3.443868971547727],
    [0.2, 0.7, 0.0, 139.99999999999986],
    [0.2, 1.5, 0.9, 5.405405405405404],
    [0.2, -0.5, 0.1, -1.6250000000000002],
];

#[test]
fn forces_equal_mujocos() {
    for &[length, velocity, gain, bias] in FORCES {
        for activation in [0.0, 0.3, 1.0] {
            let force = muscle(0.0).force(length, velocity, activation);
            assert!((force - (gain * activation + bias)).abs() < 1e-9, "{length} m, {velocity} m/s: {force}");
        }
    }
}

#[test]
fn activation_rates_equal_mujocos() {
    for &[smooth, excitation, activation, rate] in RATES {
        let found = muscle(smooth).activation_rate(excitation, activation);
        assert!((found - rate).abs() < 1e-9, "{smooth}, {excitation}, {activation}: {found} for {rate}");
    }
}

#[test]
fn activation_stays_between_zero_and_one() {
    let (muscle, mut activation, h) = (muscle(0.0), 0.0f64, 0.002);
    for k in 0..2000 {
        // Excitations beyond the control range as well.
        let excitation = 2.0 * f64::from(k * 37 % 101) / 100.0 - 0.5;
        activation += h * muscle.activation_rate(excitation, activation);
        assert!((0.0..=1.0).contains(&activation), "step {k}: {activation}");
    }
}
