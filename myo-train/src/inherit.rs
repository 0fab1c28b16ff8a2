//! Warm starts: what of another training's networks and scaling a new one can use.

use myo_env::EnvSpec;

use crate::checkpoint::Checkpoint;
use crate::networks::Networks;
use crate::normalizer::Normalizer;
use crate::{Mlp, PpoConfig, TrainError};

/// What a warm start could use; see [`Trainer::warm_start`](crate::Trainer::warm_start).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inherited {
    /// Control steps of the training that it comes from.
    pub env_steps: u64,
    /// Observations that both trainings have.
    pub observations: usize,
    /// Actions that both have.
    pub actions: usize,
}

/// A training that takes over.
pub struct Heir<'a> {
    /// Its environment.
    pub spec: &'a EnvSpec,
    /// Its settings.
    pub config: &'a PpoConfig,
    /// Its networks.
    pub networks: &'a Networks,
}

/// For every name its place in the other list.
type Places = Vec<Option<usize>>;

fn places(names: &[String], other: &[String]) -> Places {
    names.iter().map(|name| other.iter().position(|known| known == name)).collect()
}

fn shared(places: &Places) -> usize {
    places.iter().flatten().count()
}

impl Heir<'_> {
    /// Replaces initial parameters and scaling by what the other training knows better.
    pub fn take(
        &self,
        other: &Checkpoint,
        parameters: &mut [f32],
        normalizer: &mut Normalizer,
    ) -> Result<Inherited, TrainError> {
        self.check_widths(other)?;
        let observations = places(&self.spec.observation_names, &other.observation_names);
        let actions = places(&self.spec.action_names, &other.action_names);
        self.check_shared("observations", &observations)?;
        self.check_shared("actions", &actions)?;

        let (here, there) = (self.networks, other.networks());
        let own = (&here.policy, &mut parameters[here.policy_range()]);
        copy_network(own, (&there.policy, &other.parameters[there.policy_range()]), &observations, &actions);
        let own = (&here.value, &mut parameters[here.value_range()]);
        copy_network(own, (&there.value, &other.parameters[there.value_range()]), &observations, &vec![Some(0)]);
        let (log_std, known) = (&mut parameters[here.log_std_range()], &other.parameters[there.log_std_range()]);
        for (log_std, place) in log_std.iter_mut().zip(&actions) {
            *log_std = place.map_or(*log_std, |place| known[place]);
        }
        self.keep_actions(&other.config, parameters, &actions);
        // As much as one update's worth of observations, so that it soon follows the new ones.
        *normalizer = inherit_scaling(normalizer, &other.normalizer, &observations, self.config.batch_size() as f64);
        let (observations, actions) = (shared(&observations), shared(&actions));
        Ok(Inherited { env_steps: other.env_steps(), observations, actions })
    }

    /// Makes up for another mapping from outputs to actions: `offset + scale y = other_offset + other_scale x` for the output
    /// `x` of the other policy gives `y = (other_scale / scale) x + (other_offset - offset) / scale`.
    fn keep_actions(&self, other: &PpoConfig, parameters: &mut [f32], actions: &Places) {
        let own = self.config;
        let (ratio, shift) =
            (other.action_scale / own.action_scale, (other.action_offset - own.action_offset) / own.action_scale);
        if (ratio, shift) == (1.0, 0.0) {
            return;
        }
        let known = || actions.iter().enumerate().filter(|(_, place)| place.is_some()).map(|(output, _)| output);
        let policy = &mut parameters[self.networks.policy_range()];
        if let Some([n_in, n_out, weight, bias]) = self.networks.policy.layers().last() {
            let scaled = |x: f32, shift: f64| (f64::from(x) * ratio + shift) as f32;
            for output in known() {
                policy[bias + output] = scaled(policy[bias + output], shift);
                (0..n_in).map(|input| weight + input * n_out + output).for_each(|i| policy[i] = scaled(policy[i], 0.0));
            }
        }
        let log_std = &mut parameters[self.networks.log_std_range()];
        for output in known() {
            let wanted = f64::from(log_std[output]) + ratio.ln();
            log_std[output] = wanted.clamp(own.log_std_min, own.log_std_max) as f32;
        }
    }

    fn check_widths(&self, other: &Checkpoint) -> Result<(), TrainError> {
        let widths = |config: &PpoConfig| (config.policy_hidden.clone(), config.value_hidden.clone());
        let (own, others) = (widths(self.config), widths(&other.config));
        if own == others {
            return Ok(());
        }
        let tell = |(policy, value): &(Vec<usize>, Vec<usize>)| format!("{policy:?} and {value:?}");
        let (got, expected) = (tell(&others), tell(&own));
        Err(TrainError::Mismatch { what: "the width of the hidden layers to start from", got, expected })
    }

    fn check_shared(&self, what: &'static str, places: &Places) -> Result<(), TrainError> {
        if shared(places) > 0 {
            return Ok(());
        }
        let (got, expected) = (format!("none of the {what} of the run to start from"), "some of them".into());
        Err(TrainError::Mismatch { what: "the environment", got, expected })
    }
}

/// Copies the weights between what both networks know. Weights of inputs that are new become zero.
fn copy_network(
    (net, parameters): (&Mlp, &mut [f32]),
    (other, known): (&Mlp, &[f32]),
    inputs: &Places,
    outputs: &Places,
) {
    let last = net.layers().count() - 1;
    for (index, (layer, from)) in net.layers().zip(other.layers()).enumerate() {
        let [n_in, n_out, weight, bias] = layer;
        let [_, from_out, from_weight, from_bias] = from;
        let output = |o: usize| if index == last { outputs[o] } else { Some(o) };
        let input = |i: usize| if index == 0 { inputs[i] } else { Some(i) };
        for o in 0..n_out {
            let Some(from_o) = output(o) else { continue };
            parameters[bias + o] = known[from_bias + from_o];
            for i in 0..n_in {
                // Column-major: all weights of one input are neighbours.
                parameters[weight + i * n_out + o] =
                    input(i).map_or(0.0, |from_i| known[from_weight + from_i * from_out + from_o]);
            }
        }
    }
}

/// Means and spreads of the other scaling where it has them, else the own ones, all with the weight of `rows` rows.
fn inherit_scaling(own: &Normalizer, other: &Normalizer, places: &Places, rows: f64) -> Normalizer {
    let (limit, floor, count, mean, m2) = own.parts();
    let (_, _, other_count, other_mean, other_m2) = other.parts();
    let variance = |m2: f64, count: f64| if count > 0.0 { m2 / count } else { 0.0 };
    let own = (0..mean.len()).map(|i| (mean[i], variance(m2[i], count)));
    let merged = own
        .zip(places)
        .map(|(own, place)| place.map_or(own, |place| (other_mean[place], variance(other_m2[place], other_count))));
    let (mean, m2) = merged.map(|(mean, variance)| (mean, variance * rows)).unzip();
    Normalizer::from_parts(limit, floor, rows, mean, m2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strings(names: &[&str]) -> Vec<String> {
        names.iter().map(ToString::to_string).collect()
    }

    /// Outputs of a network for one input vector.
    fn output(net: &Mlp, parameters: &[f32], x: &[f32]) -> Vec<f32> {
        net.forward(parameters, x, &mut net.work(1)).to_vec()
    }

    #[test]
    fn names_that_moved_keep_their_meaning_and_new_ones_do_not_matter_yet() {
        let (other, net) = (Mlp::new(3, &[8, 8], 2), Mlp::new(4, &[8, 8], 3));
        let (mut known, mut parameters) = (vec![0.0; other.len()], vec![0.0; net.len()]);
        other.initialize(1, 0, 1.0, &mut known);
        net.initialize(2, 0, 1.0, &mut parameters);
        let fresh = output(&net, &parameters, &[0.1, 0.2, 0.3, 9.0]);
        let inputs = places(&strings(&["c", "a", "b", "new"]), &strings(&["a", "b", "c"]));
        let outputs = places(&strings(&["y", "new", "x"]), &strings(&["x", "y"]));
        copy_network((&net, &mut parameters), (&other, &known), &inputs, &outputs);

        let expected = output(&other, &known, &[0.2, 0.3, 0.1]);
        for new in [9.0, -9.0] {
            let got = output(&net, &parameters, &[0.1, 0.2, 0.3, new]);
            assert!((got[0] - expected[1]).abs() < 1e-6 && (got[2] - expected[0]).abs() < 1e-6, "{got:?} {expected:?}");
            assert_ne!(got[1], fresh[1], "a new action reads the other's features");
        }
    }

    #[test]
    fn scaling_is_taken_over_by_name() {
        let own = Normalizer::from_parts(5.0, 0.05, 10.0, vec![1.0, 2.0], vec![10.0, 40.0]);
        let other = Normalizer::from_parts(5.0, 0.05, 100.0, vec![7.0], vec![900.0]);
        let merged = inherit_scaling(&own, &other, &vec![None, Some(0)], 50.0);
        let (_, _, count, mean, m2) = merged.parts();
        assert_eq!((count, mean, m2), (50.0, &[1.0, 7.0][..], &[50.0, 450.0][..]));
    }
}
