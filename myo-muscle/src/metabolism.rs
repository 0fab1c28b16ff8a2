//! What muscles consume: the model of Bhargava, Pandy and Anderson 2004 (doi 10.1016/S0021-9290(03)00239-2).

use crate::curves::ForceCurves;
use crate::parameters::CurveParameters;
use core::f64::consts::FRAC_PI_2;

/// Density of muscle (kg/m^3).
const DENSITY: f64 = 1059.7;
/// Greatest force by cross-section (Pa) that muscle masses are reckoned with. Mammalian muscle has 0.25 MPa; arm models have the torques of strong arms from smaller
/// muscles. With 0.6 MPa those of the built-in arms weigh 2.6 and 3.3 kg, and 1.5 to 4.7 kg were measured (Holzbaur et al. 2007,
/// doi 10.1016/j.jbiomech.2006.11.011: 1427 to 4426 cm^3).
const SPECIFIC_TENSION: f64 = 0.6e6;
/// Share of slow fibres, where nothing is known of a muscle.
const SLOW: f64 = 0.5;
/// Heat of activation (W/kg): slow fibres, fast ones.
const ACTIVATION_HEAT: [f64; 2] = [40.0, 133.0];
/// Heat of maintained activation at the optimal length (W/kg): slow fibres, fast ones.
const MAINTENANCE_HEAT: [f64; 2] = [74.0, 111.0];
/// Heat by the distance shortened (N): shares of the isometric force and of the force there is.
const SHORTENING: [f64; 2] = [0.16, 0.18];
/// The same by the distance lengthened: share of the force there is.
const LENGTHENING: f64 = 0.157;

/// A muscle that consumes energy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metabolism {
    curves: ForceCurves<f64>,
    mass_kg: f64,
    /// From tendon length (m) to fibre length in units of the optimal length.
    normalised: [f64; 2],
}

/// What a muscle consumes at a moment (W), more than at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetabolicPower {
    /// Heat of calcium pumped, from the moment of activation on.
    pub activation: f64,
    /// Heat of cross-bridges that cycle and hold.
    pub maintenance: f64,
    /// Heat of shortening, more than without moving; negative where the muscle is lengthened.
    pub shortening: f64,
    /// Work done by the active force; negative where the muscle is lengthened.
    pub work: f64,
}

impl MetabolicPower {
    /// All together. What is put into a muscle that is lengthened does not come back as food: never
    /// below zero.
    pub fn total(&self) -> f64 {
        (self.activation + self.maintenance + self.shortening + self.work).max(0.0)
    }
}

impl Metabolism {
    /// Of a muscle with these curves, worked out from these parameters of its active force.
    pub fn new(curves: ForceCurves<f64>, gain: &CurveParameters) -> Self {
        let normalised = curves.fibre_length(gain);
        let optimal_length = normalised[0].recip();
        let mass_kg = curves.peak_isometric_force() / SPECIFIC_TENSION * DENSITY * optimal_length;
        Self { curves, mass_kg, normalised }
    }

    /// Its mass (kg): what has the greatest force at the optimal length.
    pub fn mass_kg(&self) -> f64 {
        self.mass_kg
    }

    /// What it consumes at a length (m) and velocity (m/s, positive when lengthening) of the whole tendon path and an activation in [0, 1].
    ///
    /// The published model goes by excitation; here it is the activation, which follows within some tens of milliseconds.
    pub fn power(&self, length: f64, velocity: f64, activation: f64) -> MetabolicPower {
        let recruited = {
            let (sin, cos) = (FRAC_PI_2 * activation).sin_cos();
            [SLOW * sin, (1.0 - SLOW) * (1.0 - cos)]
        };
        let heat = |[slow, fast]: [f64; 2]| self.mass_kg * (slow * recruited[0] + fast * recruited[1]);
        let isometric = self.curves.active_force(length, 0.0, activation);
        let force = self.curves.active_force(length, velocity, activation);
        let shortened = -velocity;
        let by_distance =
            if shortened > 0.0 { SHORTENING[0] * isometric + SHORTENING[1] * force } else { LENGTHENING * force };
        MetabolicPower {
            activation: heat(ACTIVATION_HEAT),
            maintenance: by_length(self.normalised[0] * length + self.normalised[1]) * heat(MAINTENANCE_HEAT),
            shortening: by_distance * shortened,
            work: force * shortened,
        }
    }
}

/// How much of the heat of maintenance there is at a fibre length in units of the optimal one.
fn by_length(fibre: f64) -> f64 {
    if fibre < 1.0 { fibre.max(0.5) } else { (3.0 - 2.0 * fibre).max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A muscle of 500 N and 10 cm, its curves those of MuJoCo's muscles with twice to ten times their speed.
    fn muscle(vmax: f64) -> Metabolism {
        let gain = CurveParameters {
            range: [0.5, 1.5],
            force: Some(500.0),
            scale: 200.0,
            lmin: 0.5,
            lmax: 1.6,
            vmax,
            fpmax: 1.3,
            fvmax: 1.2,
        };
        let parameters = crate::MuscleParameters {
            length_range: [0.15, 0.25],
            bias: gain.clone(),
            gain: gain.clone(),
            tau_act: 0.01,
            tau_deact: 0.04,
            tau_smooth: 0.0,
            ctrl_range: [0.0, 1.0],
            group: None,
        };
        Metabolism::new(crate::Muscle::<f64>::new(&parameters, 1.0).curves, &gain)
    }

    #[test]
    fn a_muscle_at_rest_and_one_that_holds_consume_what_the_published_numbers_say() {
        let muscle = muscle(10.0);
        // 500 N over 0.6 MPa, ten centimetres long.
        assert!((muscle.mass_kg() - 500.0 / 0.6e6 * 1059.7 * 0.1).abs() < 1e-12, "{}", muscle.mass_kg());
        assert_eq!(muscle.power(0.2, 0.0, 0.0).total(), 0.0);
        // Fully active at its optimal length, half of it slow: 86.5 and 92.5 W/kg.
        let held = muscle.power(0.2, 0.0, 1.0);
        let per_kg = |watts: f64| watts / muscle.mass_kg();
        assert!((per_kg(held.activation) - 86.5).abs() < 1e-9 && (per_kg(held.maintenance) - 92.5).abs() < 1e-9);
        assert_eq!((held.shortening, held.work), (0.0, 0.0));
        // Half as long and half as much again: half of the maintenance, and none.
        assert!((per_kg(muscle.power(0.15, 0.0, 1.0).maintenance) - 46.25).abs() < 1e-9);
        assert!(per_kg(muscle.power(0.25, 0.0, 1.0).maintenance).abs() < 1e-9);
        assert!((per_kg(muscle.power(0.225, 0.0, 1.0).maintenance) - 46.25).abs() < 1e-9);
        // Slow fibres come first: a tenth of the activation costs less than a tenth of the heat.
        let little = muscle.power(0.2, 0.0, 0.1).total() / held.total();
        assert!((0.05..0.1).contains(&little), "{little}");
    }

    #[test]
    fn shortening_costs_more_and_lengthening_less_than_holding() {
        let muscle = muscle(10.0);
        let held = muscle.power(0.2, 0.0, 1.0).total();
        let shortening = muscle.power(0.2, -0.3, 1.0);
        // Three optimal lengths per second are 0.3 of the greatest speed: (1 - 0.3)^2 of the force.
        let force = 500.0 * 0.49;
        assert!((shortening.work - 0.3 * force).abs() < 1e-9, "{shortening:?}");
        assert!((shortening.shortening - 0.3 * (0.16 * 500.0 + 0.18 * force)).abs() < 1e-9, "{shortening:?}");
        assert!(shortening.total() > held);
        let lengthening = muscle.power(0.2, 0.1, 1.0);
        assert!(lengthening.work < 0.0 && lengthening.shortening < 0.0 && lengthening.total() < held);
        assert_eq!(muscle.power(0.2, 1.0, 1.0).total(), 0.0, "a muscle that is torn apart gives nothing back");
    }

    /// At most 68 % was found in a muscle of a person (Jubrias et al. 2008), which is held to be very much.
    #[test]
    fn no_muscle_makes_more_work_of_what_it_consumes_than_muscles_do() {
        for vmax in [1.5, 10.0] {
            let muscle = muscle(vmax);
            let speeds = (1..100).map(|percent| f64::from(percent) / 100.0 * vmax * 0.1);
            let share = |speed: f64, activation: f64| {
                let power = muscle.power(0.2, -speed, activation);
                power.work / power.total()
            };
            for activation in [0.05, 0.3, 1.0] {
                let best = speeds.clone().map(|speed| share(speed, activation)).fold(0.0, f64::max);
                assert!((0.2..0.68).contains(&best), "{best} at {activation}, {vmax}");
            }
        }
    }
}
