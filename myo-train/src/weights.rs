//! A policy as plain numbers, for other programs.

use thiserror::Error;

use crate::Policy;
use crate::mlp::Mlp;
use crate::networks::{Lender, Networks};
use crate::normalizer::Normalizer;

/// Everything that an action is computed from.
///
/// Observations are scaled: `x = clip((observation - mean) * inverse_std, -limit, limit)`. Each layer but the last computes
/// `x = silu(W x + b)`, the last one `x = W x + b`. The action is `clip(offset + scale * x, -1, 1)`.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyWeights {
    /// Names of the observations, in order.
    pub observation_names: Vec<String>,
    /// Names of the actions, in order.
    pub action_names: Vec<String>,
    /// Mean of each observation.
    pub observation_mean: Vec<f32>,
    /// One over the standard deviation of each observation; positive.
    pub observation_inverse_std: Vec<f32>,
    /// Scaled observations are clipped at plus and minus this; positive.
    pub observation_limit: f32,
    /// At least one; the first takes the observations, the last gives the actions.
    pub layers: Vec<LayerWeights>,
    /// Action of an output of zero.
    pub action_offset: f32,
    /// Action per output.
    pub action_scale: f32,
}

/// One layer of a [`PolicyWeights`].
#[derive(Clone, Debug, PartialEq)]
pub struct LayerWeights {
    /// `W`, `(outputs, inputs)` row-major.
    pub weight: Vec<f32>,
    /// `b`, `(outputs,)`.
    pub bias: Vec<f32>,
}

/// Why weights are no policy.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// A list of the wrong length.
    #[error("{what} has {got} entries, expected {expected}")]
    Length {
        /// The list.
        what: String,
        /// Its length.
        got: usize,
        /// What fits the names and the layers.
        expected: usize,
    },
    /// A number that cannot be computed with.
    #[error("{what} is {value}; it must be {expected}")]
    Value {
        /// The number's name.
        what: String,
        /// Its value.
        value: f32,
        /// What it must be.
        expected: &'static str,
    },
    /// Nothing between observations and actions.
    #[error("a policy has at least one layer, one observation and one action")]
    Empty,
}

impl PolicyWeights {
    /// Refuses numbers that are no policy, with the first fault.
    fn check(&self) -> Result<(), WeightsError> {
        let (observations, actions) = (self.observation_names.len(), self.action_names.len());
        if self.layers.is_empty() || observations == 0 || actions == 0 {
            return Err(WeightsError::Empty);
        }
        length("observation_mean", &self.observation_mean, observations)?;
        length("observation_inverse_std", &self.observation_inverse_std, observations)?;
        finite("observation_mean", &self.observation_mean)?;
        finite("action_offset", &[self.action_offset])?;
        finite("action_scale", &[self.action_scale])?;
        positive("observation_inverse_std", &self.observation_inverse_std)?;
        positive("observation_limit", &[self.observation_limit])?;
        let mut inputs = observations;
        for (k, LayerWeights { weight, bias }) in self.layers.iter().enumerate() {
            let (of_weight, of_bias) = (format!("layers.{k}.weight"), format!("layers.{k}.bias"));
            let outputs = if k + 1 == self.layers.len() { actions } else { bias.len() };
            length(&of_bias, bias, outputs.max(1))?;
            length(&of_weight, weight, outputs * inputs)?;
            finite(&of_weight, weight)?;
            finite(&of_bias, bias)?;
            inputs = outputs;
        }
        Ok(())
    }

    fn networks(&self) -> Networks {
        let (observations, last) = (self.observation_names.len(), self.layers.len() - 1);
        let hidden: Vec<usize> = self.layers[..last].iter().map(|layer| layer.bias.len()).collect();
        Networks {
            policy: Mlp::new(observations, &hidden, self.action_names.len()),
            // A policy that acts has no use for one; this is the smallest.
            value: Mlp::new(observations, &[], 1),
        }
    }
}

impl Policy {
    /// Everything that an action is computed from.
    pub fn weights(&self) -> PolicyWeights {
        let parameters = &self.parameters[self.networks.policy_range()];
        let layers = self.networks.policy.layers().map(|[inputs, outputs, weight, bias]| LayerWeights {
            weight: transposed(&parameters[weight..][..inputs * outputs], inputs, outputs),
            bias: parameters[bias..][..outputs].to_vec(),
        });
        let (mean, inverse_std) = self.normalizer.scaling();
        PolicyWeights {
            observation_names: self.observation_names.clone(),
            action_names: self.action_names.clone(),
            observation_mean: mean.to_vec(),
            observation_inverse_std: inverse_std.to_vec(),
            observation_limit: self.normalizer.parts().0,
            layers: layers.collect(),
            action_offset: self.mapping.0,
            action_scale: self.mapping.1,
        }
    }

    /// A policy of weights as [`Policy::weights`] gives them; it acts alike, bit for bit.
    ///
    /// # Errors
    /// Lists whose lengths do not fit each other, numbers that are not finite.
    pub fn from_weights(weights: &PolicyWeights) -> Result<Self, WeightsError> {
        weights.check()?;
        let networks = weights.networks();
        let mut parameters = vec![0.0; networks.len()];
        for ([inputs, outputs, weight, bias], layer) in networks.policy.layers().zip(&weights.layers) {
            parameters[weight..][..inputs * outputs].copy_from_slice(&transposed(&layer.weight, outputs, inputs));
            parameters[bias..][..outputs].copy_from_slice(&layer.bias);
        }
        let (mean, inverse_std) = (weights.observation_mean.clone(), weights.observation_inverse_std.clone());
        Ok(Self {
            networks,
            parameters,
            normalizer: Normalizer::from_scaling(weights.observation_limit, mean, inverse_std),
            mapping: (weights.action_offset, weights.action_scale),
            observation_names: weights.observation_names.clone(),
            action_names: weights.action_names.clone(),
            normalized: Vec::new(),
            lender: Lender::new(),
        })
    }
}

/// A row-major `(rows, columns)` matrix with its rows as columns.
fn transposed(matrix: &[f32], rows: usize, columns: usize) -> Vec<f32> {
    (0..columns).flat_map(|column| (0..rows).map(move |row| matrix[row * columns + column])).collect()
}

fn length(what: &str, list: &[f32], expected: usize) -> Result<(), WeightsError> {
    let got = list.len();
    if got == expected { Ok(()) } else { Err(WeightsError::Length { what: what.into(), got, expected }) }
}

fn finite(what: &str, list: &[f32]) -> Result<(), WeightsError> {
    all(what, list, "finite", f32::is_finite)
}

fn positive(what: &str, list: &[f32]) -> Result<(), WeightsError> {
    all(what, list, "positive and finite", |x| x.is_finite() && x > 0.0)
}

fn all(what: &str, list: &[f32], expected: &'static str, is: impl Fn(f32) -> bool) -> Result<(), WeightsError> {
    match list.iter().position(|&x| !is(x)) {
        None => Ok(()),
        Some(index) => {
            let what = if list.len() == 1 { what.into() } else { format!("{what}[{index}]") };
            Err(WeightsError::Value { what, value: list[index], expected })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two observations, two hidden units, one action.
    fn weights() -> PolicyWeights {
        PolicyWeights {
            observation_names: vec!["a".into(), "b".into()],
            action_names: vec!["pull".into()],
            observation_mean: vec![1.0, -1.0],
            observation_inverse_std: vec![2.0, 0.5],
            observation_limit: 3.0,
            layers: vec![
                LayerWeights { weight: vec![1.0, 2.0, 3.0, 4.0], bias: vec![0.0, -1.0] },
                LayerWeights { weight: vec![0.5, -0.25], bias: vec![0.125] },
            ],
            action_offset: 0.1,
            action_scale: 0.2,
        }
    }

    #[test]
    fn weights_compute_what_their_description_says() {
        let mut policy = Policy::from_weights(&weights()).unwrap();
        let mut action = [0.0];
        policy.act_deterministic(&[1.5, 1.0], &mut action);
        let silu = |z: f64| z / (1.0 + (-z).exp());
        // Scaled observations are (1, 1).
        let expected = 0.1 + 0.2 * (0.5 * silu(3.0) - 0.25 * silu(6.0) + 0.125);
        assert!((f64::from(action[0]) - expected).abs() < 1e-6, "{action:?} {expected}");
        // Scaled observations are clipped at (3, -3).
        policy.act_deterministic(&[1e6, -1e6], &mut action);
        let expected = 0.1 + 0.2 * (0.5 * silu(-3.0) - 0.25 * silu(-4.0) + 0.125);
        assert!((f64::from(action[0]) - expected).abs() < 1e-6, "{action:?} {expected}");
    }

    #[test]
    fn weights_go_out_and_in_unchanged() {
        assert_eq!(Policy::from_weights(&weights()).unwrap().weights(), weights());
    }

    #[test]
    fn what_is_no_policy_is_refused_with_its_place() {
        type Change = fn(&mut PolicyWeights);
        let cases: [(Change, &str); 8] = [
            (|w| w.layers.clear(), "at least one layer"),
            (|w| w.action_names.clear(), "one action"),
            (|w| w.observation_mean.push(0.0), "observation_mean has 3 entries, expected 2"),
            (|w| w.layers[0].weight.truncate(3), "layers.0.weight has 3 entries, expected 4"),
            (|w| w.layers[1].bias.push(0.0), "layers.1.bias has 2 entries, expected 1"),
            (|w| w.layers[0].bias.clear(), "layers.0.bias has 0 entries, expected 1"),
            (|w| w.layers[1].weight[1] = f32::NAN, "layers.1.weight[1] is NaN; it must be finite"),
            (|w| w.observation_inverse_std[0] = 0.0, "observation_inverse_std[0] is 0; it must be positive"),
        ];
        for (change, sentence) in cases {
            let mut wrong = weights();
            change(&mut wrong);
            let refusal = Policy::from_weights(&wrong).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(refusal.contains(sentence), "{refusal:?} does not say {sentence:?}");
        }
    }
}
