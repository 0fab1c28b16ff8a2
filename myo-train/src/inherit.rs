//! Warm starts: what of another training's networks and scaling a new one can use.

use myo_env::EnvSpec;

use crate::checkpoint::Checkpoint;
use crate::networks::{Lender, Networks};
use crate::normalizer::Normalizer;
use crate::{Mlp, Policy, PpoConfig, TrainError};

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
        let (own, others) = (self.config.log_std(self.spec.control_dt), other.config.log_std(other.control_dt));
        // Of all noise in an action, as many draws as it may be the sum of.
        let shift = (own.max - self.config.log_std_max) - (others.max - other.config.log_std_max);
        for (log_std, place) in log_std.iter_mut().zip(&actions) {
            *log_std = place.map_or(*log_std, |place| (f64::from(known[place]) + shift).clamp(own.min, own.max) as f32);
        }
        self.keep_actions(&other.config, parameters, &actions);
        // As much as one update's worth of observations, so that it soon follows the new ones.
        *normalizer = inherit_scaling(
            normalizer,
            &other.normalizer,
            &observations,
            self.config.batch_size(self.spec.control_dt) as f64,
        );
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
        let (log_std, bounds) = (&mut parameters[self.networks.log_std_range()], own.log_std(self.spec.control_dt));
        for output in known() {
            let wanted = f64::from(log_std[output]) + ratio.ln();
            log_std[output] = wanted.clamp(bounds.min, bounds.max) as f32;
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

/// A policy for an environment with other observations and actions; see [`Policy::for_environment`].
pub fn policy_for(trained: &Policy, spec: &EnvSpec) -> Result<Policy, TrainError> {
    let observations = places(&spec.observation_names, &trained.observation_names);
    let actions = places(&spec.action_names, &trained.action_names);
    if shared(&observations) == 0 {
        let got = format!("none of whose {} observations the policy knows", observations.len());
        return Err(TrainError::Mismatch { what: "the environment", got, expected: "one with some of them".into() });
    }
    let unknown = spec.action_names.iter().zip(&actions).filter(|(_, place)| place.is_none());
    let unknown: Vec<String> = unknown.map(|(name, _)| format!("`{name}`")).collect();
    if !unknown.is_empty() {
        let got = format!("one with {}, which the policy does not know", unknown.join(", "));
        let expected = format!("only actions among its {}", trained.action_names.len());
        return Err(TrainError::Mismatch { what: "the list of actions", got, expected });
    }
    let there = &trained.networks;
    let here = Networks {
        policy: resized(&there.policy, observations.len(), actions.len()),
        value: resized(&there.value, observations.len(), 1),
    };
    let mut parameters = vec![0.0; here.len()];
    let known = &trained.parameters;
    let own = (&here.policy, &mut parameters[here.policy_range()]);
    copy_network(own, (&there.policy, &known[there.policy_range()]), &observations, &actions);
    let own = (&here.value, &mut parameters[here.value_range()]);
    copy_network(own, (&there.value, &known[there.value_range()]), &observations, &vec![Some(0)]);
    let log_std = actions.iter().flatten().map(|place| known[there.log_std_range()][*place]);
    parameters[here.log_std_range()].iter_mut().zip(log_std).for_each(|(own, known)| *own = known);

    let (limit, floor, count, mean, m2) = trained.normalizer.parts();
    let gather =
        |known: &[f64], new: f64| observations.iter().map(|place| place.map_or(new, |place| known[place])).collect();
    Ok(Policy {
        networks: here,
        parameters,
        normalizer: Normalizer::from_parts(limit, floor, count, gather(mean, 0.0), gather(m2, count)),
        mapping: trained.mapping,
        observation_names: spec.observation_names.clone(),
        action_names: spec.action_names.clone(),
        normalized: Vec::new(),
        lender: Lender::new(),
    })
}

/// A network with the same hidden layers.
fn resized(net: &Mlp, inputs: usize, outputs: usize) -> Mlp {
    let mut hidden: Vec<usize> = net.layers().map(|[_, width, ..]| width).collect();
    hidden.pop();
    Mlp::new(inputs, &hidden, outputs)
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
    fn a_policy_acts_the_same_where_names_stand_elsewhere() {
        let act = |policy: &mut Policy, observation: &[f32]| {
            let mut actions = vec![0.0; policy.action_names().len()];
            policy.act_deterministic(observation, &mut actions);
            actions
        };
        let mut own = policy();
        let expected = act(&mut own, &[0.1, 0.2, 0.3]);
        assert!(expected[0] != expected[1] && expected[0].abs() < 1.0);
        let same = own.for_environment(&spec(&["a", "b", "c"], &["x", "y"]));
        assert_eq!(act(&mut same.unwrap(), &[0.1, 0.2, 0.3]), expected);

        let mut other = own.for_environment(&spec(&["c", "new", "a", "b"], &["y"])).unwrap();
        for new in [9.0, -9.0] {
            assert!((act(&mut other, &[0.3, new, 0.1, 0.2])[0] - expected[1]).abs() < 1e-6);
        }
        // What is not observed counts as average.
        let mut less = own.for_environment(&spec(&["b"], &["x"])).unwrap();
        let average = act(&mut own, &[0.2, 0.2, -0.3])[0];
        assert!((act(&mut less, &[0.2])[0] - average).abs() < 1e-6 && average != expected[0]);
    }

    #[test]
    fn an_environment_that_a_policy_cannot_act_in_is_refused_with_the_difference() {
        let refused = |spec: EnvSpec| policy().for_environment(&spec).err().expect("it is refused").to_string();
        let text = refused(spec(&["a"], &["x", "z"]));
        assert!(text.contains("one with `z`, which the policy does not know"), "{text}");
        assert!(refused(spec(&["other"], &["x"])).contains("none of whose 1 observations the policy knows"));
    }

    fn spec(observations: &[&str], actions: &[&str]) -> EnvSpec {
        EnvSpec {
            num_envs: 1,
            observation_names: strings(observations),
            action_names: strings(actions),
            episode_names: Vec::new(),
            control_dt: 0.05,
            max_episode_steps: 1,
            layout_limits: vec![],
            autoreset: myo_env::Autoreset::SameStep,
            exploring: 0,
        }
    }

    /// Observes a, b and c, and acts with x and y.
    fn policy() -> Policy {
        // Far from the limits of the actions, at which all policies look alike.
        let (action_offset, action_scale) = (0.0, 0.1);
        let hidden = PpoConfig { policy_hidden: vec![8, 8], value_hidden: vec![8], ..PpoConfig::default() };
        let config = PpoConfig { action_offset, action_scale, ..hidden };
        let spec = spec(&["a", "b", "c"], &["x", "y"]);
        let networks = Networks::new(&spec, &config);
        let mut parameters = networks.initialize(1, &config, 0.05);
        networks.policy.initialize(1, 0, 1.0, &mut parameters[networks.policy_range()]);
        let normalizer = Normalizer::from_parts(5.0, 0.05, 10.0, vec![0.2, 0.1, -0.3], vec![10.0, 40.0, 0.9]);
        Policy::new((&spec.observation_names, &spec.action_names), networks, &config, parameters, normalizer)
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
