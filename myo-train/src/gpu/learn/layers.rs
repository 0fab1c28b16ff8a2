//! The layers of both networks, and where they lie in the memory of an update.

use super::layout::Precision;
use crate::networks::Networks;

/// A layer among both networks.
#[derive(Clone, Copy, Debug)]
pub struct LayerRows {
    /// Rows of its input.
    pub inputs: usize,
    /// Rows of its output.
    pub outputs: usize,
    /// First weight among the parameters.
    pub weight: usize,
    /// First bias.
    pub bias: usize,
    /// First row of its input among the activations.
    pub x_row: usize,
    /// First row of its outputs among the activations.
    pub h_row: usize,
    /// First row of its outputs among the gradients.
    pub z_row: usize,
    /// Whether another one follows.
    pub hidden: bool,
}

/// The layers of the policy and of the value network, for so many observations. With 32 bits every row of gradients has one
/// of activations; with 16 bits only hidden layers have activations, each followed by a row of ones.
pub fn layers(networks: &Networks, observations: usize, precision: Precision) -> [Vec<LayerRows>; 2] {
    let ones = precision.ones();
    let (mut h_row, mut z_row) = (observations + ones, 0);
    let nets = [(&networks.policy, networks.policy_range()), (&networks.value, networks.value_range())];
    nets.map(|(net, range)| {
        let (mut x_row, last) = (0, net.layers().count() - 1);
        let place = |(index, [inputs, outputs, weight, bias]): (usize, [usize; 4])| {
            let (weight, bias, hidden) = (range.start + weight, range.start + bias, index < last);
            let layer = LayerRows { inputs, outputs, weight, bias, x_row, h_row, z_row, hidden };
            x_row = h_row;
            z_row += outputs;
            h_row += if hidden || ones == 0 { outputs + ones } else { 0 };
            layer
        };
        net.layers().enumerate().map(place).collect()
    })
}
