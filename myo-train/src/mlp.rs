//! A fully connected network with exact gradients.
//!
//! Layer `l` computes `z = W h + b`; hidden layers apply SiLU, the last is linear. Matrices of samples are row-major
//! `(rows, features)`, which faer reads as column-major `(features, rows)`; every product then runs over contiguous
//! memory: `Z = W H`, `dW = dZ H^T`, `dH = W^T dZ`. Knows neither policies nor rewards.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::mat::{MatMut, MatRef};
use faer::{Accum, Par};

use crate::kernels;
use crate::random::{Stream, fill_normal};

/// Sizes of the layers and where their parameters lie in a flat slice; holds no numbers itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Mlp {
    layers: Vec<Layer>,
}

#[derive(Clone, Debug, PartialEq)]
struct Layer {
    inputs: usize,
    outputs: usize,
    /// `W`, `(outputs, inputs)` column-major: all weights of the first input come first.
    weight: Range<usize>,
    bias: Range<usize>,
}

/// Memory for one pass over at most `rows` samples.
#[derive(Clone, Debug)]
pub struct MlpWork {
    rows: usize,
    /// Outputs of the hidden layers, `(rows, outputs)` each.
    hidden: Vec<Vec<f32>>,
    /// Derivatives of their activations.
    derivative: Vec<Vec<f32>>,
    output: Vec<f32>,
    /// Gradients with respect to a layer's `z`, used in turn.
    delta: [Vec<f32>; 2],
}

impl Mlp {
    /// A network from `inputs` over hidden layers of the given widths to `outputs`.
    pub fn new(inputs: usize, hidden: &[usize], outputs: usize) -> Self {
        let (mut layers, mut inputs, mut offset) = (Vec::new(), inputs, 0);
        for &width in hidden.iter().chain([&outputs]) {
            let weight = offset..offset + inputs * width;
            let bias = weight.end..weight.end + width;
            offset = bias.end;
            layers.push(Layer { inputs, outputs: width, weight, bias });
            inputs = width;
        }
        Self { layers }
    }

    /// Inputs, outputs, first weight and first bias of every layer; weights are `(outputs, inputs)` column-major.
    pub(crate) fn layers(&self) -> impl Iterator<Item = [usize; 4]> + '_ {
        self.layers.iter().map(|layer| [layer.inputs, layer.outputs, layer.weight.start, layer.bias.start])
    }

    /// Number of parameters.
    pub fn len(&self) -> usize {
        self.layers.last().map_or(0, |layer| layer.bias.end)
    }

    /// Whether there are no parameters; never so for a network made by [`Mlp::new`].
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        self.layers[0].inputs
    }

    /// Number of outputs.
    pub fn outputs(&self) -> usize {
        self.layers[self.layers.len() - 1].outputs
    }

    /// Floating-point operations of the matrix products for one sample, forward and backward.
    pub fn flops_per_sample(&self) -> usize {
        let products = |layer: &Layer| 2 * layer.inputs * layer.outputs;
        3 * self.layers.iter().map(products).sum::<usize>() - products(&self.layers[0])
    }

    /// Random orthogonal weights with gain sqrt 2, `output_gain` in the last layer; biases zero.
    ///
    /// `sequence` keeps networks with one seed apart.
    pub fn initialize(&self, seed: u64, sequence: u64, output_gain: f64, parameters: &mut [f32]) {
        let last = self.layers.len() - 1;
        for (index, layer) in self.layers.iter().enumerate() {
            let gain = if index == last { output_gain } else { std::f64::consts::SQRT_2 };
            let step = sequence << 32 | index as u64;
            let weight = &mut parameters[layer.weight.clone()];
            orthogonal(layer.outputs, layer.inputs, gain, seed, step, weight);
            parameters[layer.bias.clone()].fill(0.0);
        }
    }

    /// Memory for passes over at most `rows` samples.
    pub fn work(&self, rows: usize) -> MlpWork {
        let hidden = &self.layers[..self.layers.len() - 1];
        let buffers = || hidden.iter().map(|layer| vec![0.0; rows * layer.outputs]).collect::<Vec<_>>();
        let widest = self.layers.iter().map(|layer| layer.outputs).max().unwrap_or(0);
        MlpWork {
            rows,
            hidden: buffers(),
            derivative: buffers(),
            output: vec![0.0; rows * self.outputs()],
            delta: [vec![0.0; rows * widest], vec![0.0; rows * widest]],
        }
    }

    /// Outputs `(rows, outputs)` for the samples `x`, `(rows, inputs)`.
    pub fn forward<'w>(&self, parameters: &[f32], x: &[f32], work: &'w mut MlpWork) -> &'w mut [f32] {
        self.pass::<false>(parameters, x, work)
    }

    /// As [`Mlp::forward`], and keeps what [`Mlp::backward`] needs.
    pub fn forward_for_gradient<'w>(&self, parameters: &[f32], x: &[f32], work: &'w mut MlpWork) -> &'w mut [f32] {
        self.pass::<true>(parameters, x, work)
    }

    fn pass<'w, const GRADIENT: bool>(&self, parameters: &[f32], x: &[f32], work: &'w mut MlpWork) -> &'w mut [f32] {
        let rows = x.len() / self.inputs();
        assert!(rows <= work.rows && x.len() == rows * self.inputs(), "{rows} samples, room for {}", work.rows);
        for (index, layer) in self.layers.iter().enumerate() {
            let bias = &parameters[layer.bias.clone()];
            let weight = layer.weight(parameters);
            let (before, here) = work.hidden.split_at_mut(index);
            let h_in = before.last().map_or(x, |h| &h[..rows * layer.inputs]);
            let h_in = MatRef::from_column_major_slice(h_in, layer.inputs, rows);
            let out = here.first_mut().unwrap_or(&mut work.output);
            let out = &mut out[..rows * layer.outputs];
            // Z = W H
            product(MatMut::from_column_major_slice_mut(out, layer.outputs, rows), Accum::Replace, weight, h_in);
            match work.derivative.get_mut(index) {
                Some(d) if GRADIENT => kernels::bias_silu_derivative(out, bias, &mut d[..rows * layer.outputs]),
                Some(_) => kernels::bias_silu(out, bias),
                None => kernels::add_bias(out, bias),
            }
        }
        &mut work.output[..rows * self.outputs()]
    }

    /// Gradient of a loss with respect to the parameters, added to `gradient` (written over it unless `add`).
    ///
    /// Follows [`Mlp::forward_for_gradient`] with the same samples; its output must have been overwritten with
    /// the derivative of the loss with respect to it.
    pub fn backward(&self, parameters: &[f32], x: &[f32], work: &mut MlpWork, gradient: &mut [f32], add: bool) {
        let rows = x.len() / self.inputs();
        let accumulate = if add { Accum::Add } else { Accum::Replace };
        let [delta, next] = &mut work.delta;
        let (mut delta, mut next) = (delta, next);
        let n_output = rows * self.outputs();
        delta[..n_output].copy_from_slice(&work.output[..n_output]);
        for (index, layer) in self.layers.iter().enumerate().rev() {
            let dz = &mut delta[..rows * layer.outputs];
            let bias_gradient = &mut gradient[layer.bias.clone()];
            if !add {
                bias_gradient.fill(0.0);
            }
            match work.derivative.get(index) {
                Some(d) => kernels::activation_backward(dz, &d[..dz.len()], bias_gradient),
                None => kernels::add_row_sum(dz, bias_gradient),
            }
            let dz = MatRef::from_column_major_slice(dz, layer.outputs, rows);
            let h_in = if index == 0 { x } else { &work.hidden[index - 1][..rows * layer.inputs] };
            let h_in = MatRef::from_column_major_slice(h_in, layer.inputs, rows);
            let dw = &mut gradient[layer.weight.clone()];
            // dW = dZ H^T
            let dw = MatMut::from_column_major_slice_mut(dw, layer.outputs, layer.inputs);
            product(dw, accumulate, dz, h_in.transpose());
            if index > 0 {
                // dH = W^T dZ
                let dh = &mut next[..rows * layer.inputs];
                let dh = MatMut::from_column_major_slice_mut(dh, layer.inputs, rows);
                product(dh, Accum::Replace, layer.weight(parameters).transpose(), dz);
                std::mem::swap(&mut delta, &mut next);
            }
        }
    }
}

impl Layer {
    fn weight<'p>(&self, parameters: &'p [f32]) -> MatRef<'p, f32> {
        MatRef::from_column_major_slice(&parameters[self.weight.clone()], self.outputs, self.inputs)
    }
}

/// `out = a b`, or `out += a b`, on the calling thread.
fn product(out: MatMut<'_, f32>, accumulate: Accum, a: MatRef<'_, f32>, b: MatRef<'_, f32>) {
    matmul(out, accumulate, a, b, 1.0, Par::Seq);
}

/// Random `(rows, cols)` column-major matrix with orthogonal rows or columns, whichever are fewer, times `gain`
/// (Saxe et al. 2014, arXiv 1312.6120). Gram-Schmidt, twice over, in double precision.
fn orthogonal(rows: usize, cols: usize, gain: f64, seed: u64, step: u64, out: &mut [f32]) {
    fill_normal(seed, Stream::Weights, step, 0, out);
    let (count, length) = (rows.min(cols), rows.max(cols));
    // Entry `i` of vector `k`, in the memory of the column-major matrix.
    let place = |k: usize, i: usize| if cols <= rows { i + rows * k } else { k + rows * i };
    let mut vectors: Vec<Vec<f64>> = Vec::with_capacity(count);
    for k in 0..count {
        let mut u: Vec<f64> = (0..length).map(|i| f64::from(out[place(k, i)])).collect();
        for _ in 0..2 {
            for v in &vectors {
                let dot: f64 = u.iter().zip(v).map(|(a, b)| a * b).sum();
                u.iter_mut().zip(v).for_each(|(a, b)| *a -= dot * b);
            }
        }
        let norm = u.iter().map(|a| a * a).sum::<f64>().sqrt();
        u.iter_mut().for_each(|a| *a /= norm);
        vectors.push(u);
    }
    for (k, v) in vectors.iter().enumerate() {
        for (i, a) in v.iter().enumerate() {
            out[place(k, i)] = (gain * a) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(n: usize, step: u64) -> Vec<f32> {
        let mut x = vec![0.0; n];
        fill_normal(11, Stream::Actions, step, 0, &mut x);
        x
    }

    /// The slow, obvious version: one sample in double precision.
    fn forward_f64(net: &Mlp, parameters: &[f64], x: &[f64]) -> Vec<f64> {
        let mut h = x.to_vec();
        for (index, layer) in net.layers.iter().enumerate() {
            let unit = |o: usize| {
                let sum: f64 =
                    h.iter().enumerate().map(|(i, h)| parameters[layer.weight.start + o + i * layer.outputs] * h).sum();
                let z = sum + parameters[layer.bias.start + o];
                if index + 1 < net.layers.len() { z / (1.0 + (-z).exp()) } else { z }
            };
            h = (0..layer.outputs).map(unit).collect();
        }
        h
    }

    #[test]
    fn forward_agrees_with_the_obvious_version() {
        let net = Mlp::new(7, &[33, 20], 5);
        let parameters = numbers(net.len(), 0);
        let x = numbers(7 * 40, 1);
        let mut work = net.work(64);
        let fast = net.forward(&parameters, &x, &mut work).to_vec();
        assert_eq!(fast, net.forward_for_gradient(&parameters, &x, &mut work));
        let wide: Vec<f64> = parameters.iter().map(|&p| p.into()).collect();
        for (x, fast) in x.chunks(7).zip(fast.chunks(5)) {
            let x: Vec<f64> = x.iter().map(|&x| x.into()).collect();
            for (slow, fast) in forward_f64(&net, &wide, &x).iter().zip(fast) {
                assert!((slow - f64::from(*fast)).abs() < 1e-4 * (1.0 + slow.abs()), "{slow} {fast}");
            }
        }
    }

    #[test]
    fn gradient_agrees_with_finite_differences() {
        let (n_in, n_out, rows) = (5, 3, 17);
        let net = Mlp::new(n_in, &[16, 9], n_out);
        let parameters: Vec<f32> = numbers(net.len(), 2).iter().map(|p| 0.4 * p).collect();
        let (x, target) = (numbers(n_in * rows, 3), numbers(n_out * rows, 4));
        // L = 1/2 sum (y - target)^2, so dL/dy = y - target
        let loss = |parameters: &[f64]| -> f64 {
            let mut sum = 0.0;
            for (x, target) in x.chunks(n_in).zip(target.chunks(n_out)) {
                let x: Vec<f64> = x.iter().map(|&x| x.into()).collect();
                let y = forward_f64(&net, parameters, &x);
                sum += y.iter().zip(target).map(|(y, &t)| 0.5 * (y - f64::from(t)).powi(2)).sum::<f64>();
            }
            sum
        };
        let mut work = net.work(rows);
        let mut gradient = vec![f32::NAN; net.len()];
        for (piece, (x, target)) in x.chunks(n_in * 9).zip(target.chunks(n_out * 9)).enumerate() {
            let y = net.forward_for_gradient(&parameters, x, &mut work);
            y.iter_mut().zip(target).for_each(|(y, t)| *y -= t);
            net.backward(&parameters, x, &mut work, &mut gradient, piece > 0);
        }
        let mut wide: Vec<f64> = parameters.iter().map(|&p| p.into()).collect();
        for index in 0..wide.len() {
            let (centre, h) = (wide[index], 1e-5);
            wide[index] = centre + h;
            let above = loss(&wide);
            wide[index] = centre - h;
            let below = loss(&wide);
            wide[index] = centre;
            let slope = (above - below) / (2.0 * h);
            let got = f64::from(gradient[index]);
            assert!((slope - got).abs() < 2e-5 * (1.0 + slope.abs()), "parameter {index}: {got}, not {slope}");
        }
    }

    #[test]
    fn initial_weights_are_orthogonal_with_their_gain() {
        let net = Mlp::new(6, &[10], 4);
        let mut parameters = vec![f32::NAN; net.len()];
        net.initialize(5, 0, 0.01, &mut parameters);
        for (layer, gain) in net.layers.iter().zip([2.0_f64.sqrt(), 0.01]) {
            let w = &parameters[layer.weight.clone()];
            let tall = layer.inputs <= layer.outputs;
            let (count, length) = if tall { (layer.inputs, layer.outputs) } else { (layer.outputs, layer.inputs) };
            let at =
                |k: usize, i: usize| f64::from(if tall { w[i + layer.outputs * k] } else { w[k + layer.outputs * i] });
            for (a, b) in (0..count).flat_map(|a| (0..count).map(move |b| (a, b))) {
                let dot: f64 = (0..length).map(|i| at(a, i) * at(b, i)).sum();
                let expected = if a == b { gain * gain } else { 0.0 };
                assert!((dot - expected).abs() < 1e-6 * gain, "{a} {b}: {dot}");
            }
            assert!(parameters[layer.bias.clone()].iter().all(|&b| b == 0.0));
        }
    }
}
