//! Motor noise: its formula, the bounds of excitations, and what it is at different rates.

use myo_muscle::{CONSTANT_NOISE, MotorNoise, NOISE_TIME_S, SIGNAL_DEPENDENT_NOISE, noisy_excitation};
use myo_scalar::{Scalar, Word, normal_pair, philox_block};

#[test]
fn noise_is_a_constant_part_and_one_that_grows_with_the_excitation() {
    // By hand: sqrt((0.6 * 0.5)^2 + 0.4^2) = 0.5.
    let noisy = noisy_excitation::<f64>(0.5, 0.6, 0.4, 0.5);
    assert!((noisy - 0.75).abs() < 1e-15, "{noisy}");
    assert_eq!(noisy_excitation::<f64>(0.3, SIGNAL_DEPENDENT_NOISE, CONSTANT_NOISE, 0.0), 0.3);
    // Without an excitation, only the constant part is left.
    assert!((noisy_excitation::<f64>(0.0, SIGNAL_DEPENDENT_NOISE, CONSTANT_NOISE, 1.0) - 0.185).abs() < 1e-15);
    // Without noise there is none.
    assert_eq!(noisy_excitation::<f64>(0.0, 0.0, 0.0, 3.0), 0.0);
}

#[test]
fn excitations_stay_between_zero_and_one() {
    for (u, z, wanted) in [(0.9, 5.0, 1.0), (0.1, -5.0, 0.0), (1.0, 0.0, 1.0), (0.0, 0.0, 0.0)] {
        assert_eq!(noisy_excitation::<f64>(u, SIGNAL_DEPENDENT_NOISE, CONSTANT_NOISE, z), wanted, "{u}, {z}");
    }
}

fn word(word: u32) -> <f64 as Scalar>::Word {
    Word::splat(word)
}

fn draws() -> impl Iterator<Item = f64> {
    (0..).flat_map(|block: u32| {
        let words = philox_block::<f64>([7, 8].map(word), [block, 0, 0, 0].map(word));
        let ((a, b), (c, d)) = (normal_pair::<f64>(words[0], words[1]), normal_pair(words[2], words[3]));
        [a, b, c, d]
    })
}

#[test]
fn noise_is_as_strong_and_as_slow_at_any_rate() {
    for rate in [20.0, 50.0, 100.0, 500.0] {
        let dt = 1.0 / rate;
        let noise = MotorNoise::new(dt);
        let steps = (4000.0 * rate) as usize;
        let (mut z, mut squares, mut lagged) = (0.0, 0.0, 0.0);
        let lag = (0.1 * rate) as usize;
        let mut past = vec![0.0; lag];
        let (mut means, mut sum) = (Vec::new(), 0.0);
        for (step, draw) in draws().take(steps).enumerate() {
            z = noise.next(z, draw);
            squares += z * z / steps as f64;
            lagged += z * past[step % lag] / steps as f64;
            past[step % lag] = z;
            sum += z / rate;
            if (step + 1) % rate as usize == 0 {
                means.push(sum);
                sum = 0.0;
            }
        }
        assert!((squares - 1.0).abs() < 0.03, "variance {squares} at {rate} Hz");
        assert!((lagged - (-0.1 / NOISE_TIME_S).exp()).abs() < 0.03, "{lagged} after a tenth of a second at {rate} Hz");
        // The mean over a second has the variance of white noise of the power that is left at low frequencies: 2 NOISE_TIME_S.
        let power: f64 = means.iter().map(|mean| mean * mean).sum::<f64>() / means.len() as f64;
        // Held for a control step it is stronger by dt / 2 coth(dt / 2 NOISE_TIME_S) / NOISE_TIME_S; 1.31 at 20 Hz.
        let held = dt / 2.0 / (dt / 2.0 / NOISE_TIME_S).tanh();
        assert!((power / (2.0 * held) - 1.0).abs() < 0.12, "{power} against {} at {rate} Hz", 2.0 * held);
    }
}
