//! Motor noise: its formula, the bounds of excitations, and what it is at different rates.

use myo_muscle::{ActivationDynamics, CONSTANT_NOISE, MotorNoise, SIGNAL_DEPENDENT_NOISE, noisy_excitation};
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
    for rate in [10.0, 20.0, 50.0, 100.0, 500.0] {
        let noise = MotorNoise::new(1.0 / rate, 0.05);
        let (mut z, mut squares, mut means, mut sum) = (0.0, 0.0, Vec::new(), 0.0);
        let steps = (8000.0 * rate) as usize;
        for (step, draw) in draws().take(steps).enumerate() {
            z = noise.next(z, draw);
            let deviation: f64 = noise.deviation(z);
            squares += deviation * deviation / steps as f64;
            sum += deviation / rate;
            // What is left in the mean over two seconds is low frequencies.
            if (step + 1) % (2.0 * rate) as usize == 0 {
                means.push(sum / 2.0);
                sum = 0.0;
            }
        }
        let power = 2.0 * means.iter().map(|mean| mean * mean).sum::<f64>() / means.len() as f64;
        assert!((power / 0.05 - 1.0).abs() < 0.08, "{power} at {rate} Hz");
        let variance = if rate < 20.0 { 0.5 } else { 1.0 };
        assert!((squares / variance - 1.0).abs() < 0.03, "variance {squares} at {rate} Hz");
    }
}

/// Coefficient of variation of the sum of the activations of so many equal muscles that are held at `u` by a user who decides 25 times a
/// second, with slow noise of these deviations; usual time constants (10 and 40 ms).
fn variation(muscles: usize, u: f64, [signal_dependent, constant]: [f64; 2]) -> f64 {
    const DECISION_S: f64 = 0.04;
    const PHYSICS_S: f64 = 0.002;
    let muscle = ActivationDynamics::from_row([0.01, 1.0 / 0.04, 0.0, 0.0, 1.0]);
    let (noise, mut draws) = (MotorNoise::new(DECISION_S, 0.4), draws());
    let (mut z, mut activation, mut sums) = (vec![0.0; muscles], vec![u; muscles], vec![]);
    for _ in 0..5000 {
        z.iter_mut().for_each(|z| *z = noise.next(*z, draws.next().unwrap()));
        for _ in 0..(DECISION_S / PHYSICS_S).round() as usize {
            for (a, &z) in activation.iter_mut().zip(&z) {
                *a += PHYSICS_S
                    * muscle.rate(false, noisy_excitation(u, signal_dependent, constant, noise.deviation(z)), *a);
            }
            sums.push(activation.iter().sum::<f64>());
        }
    }
    let mean = sums.iter().sum::<f64>() / sums.len() as f64;
    let variance = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / sums.len() as f64;
    variance.sqrt() / mean
}

/// What `docs/people.md` says of the noise of `user: human`.
#[test]
fn the_torque_of_a_few_muscles_varies_by_two_to_three_per_cent() {
    for u in [0.05, 0.2, 0.5] {
        let [three, six] = [3, 6].map(|muscles| variation(muscles, u, [0.05, 0.0008]));
        assert!((0.026..0.036).contains(&three), "{three} of three muscles at {u}");
        assert!((0.019..0.026).contains(&six), "{six} of six muscles at {u}");
    }
}

#[test]
fn at_twenty_decisions_a_second_noise_is_drawn_for_each() {
    let noise = MotorNoise::new(0.05, 0.05);
    assert_eq!(noise.next(3.0, 0.5), 0.5);
    assert_eq!(noise.deviation(0.5), 0.5);
}
