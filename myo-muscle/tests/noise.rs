//! Motor noise: its formula, and the bounds of excitations.

use myo_muscle::{CONSTANT_NOISE, SIGNAL_DEPENDENT_NOISE, noisy_excitation};

#[test]
fn noise_is_a_constant_part_and_one_that_grows_with_the_excitation() {
    // By hand: 0.5 + 0.1 * 0.5 * 2 + 0.2 * -1.
    let noisy = noisy_excitation::<f64>(0.5, 0.1, 0.2, 2.0, -1.0);
    assert!((noisy - 0.4).abs() < 1e-15, "{noisy}");
    assert_eq!(noisy_excitation::<f64>(0.3, SIGNAL_DEPENDENT_NOISE, CONSTANT_NOISE, 0.0, 0.0), 0.3);
    // Without an excitation, only the constant part is left.
    assert!((noisy_excitation::<f64>(0.0, SIGNAL_DEPENDENT_NOISE, CONSTANT_NOISE, 9.0, 1.0) - 0.185).abs() < 1e-15);
}

#[test]
fn excitations_stay_between_zero_and_one() {
    for (u, z, wanted) in [(0.9, 5.0, 1.0), (0.1, -5.0, 0.0), (1.0, 0.0, 1.0), (0.0, 0.0, 0.0)] {
        assert_eq!(noisy_excitation::<f64>(u, SIGNAL_DEPENDENT_NOISE, CONSTANT_NOISE, z, z), wanted, "{u}, {z}");
    }
}
