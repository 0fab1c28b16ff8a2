//! Updates on the card beside updates on the processor, from the same record.

use myo_env::VectorEnv;
use myo_gpu::Gpu;

use super::{DeviceLearner, MatrixTile, Precision, Settings, Tiles};
use crate::PpoConfig;
use crate::gpu::testing::{assert_close, gpu};
use crate::gpu::tests::{Brain, FIRST_STEP, SEED, start};
use crate::gpu::{DeviceRollout, Tile};
use crate::learn::{LearnStats, Learner, Optimizer};
use crate::networks::Networks;
use crate::rollout::Rollout;

const SETTINGS: Settings = Settings { seed: SEED, update: 5, learning_rate: 1e-3, gradient_steps: 40 };

/// A record on the card and the same one in the host's memory.
fn collected(gpu: &Gpu, num_envs: usize) -> (DeviceRollout, Brain, Rollout) {
    let (env, mut brain, mut observation) = start(gpu, num_envs);
    // As on the processor.
    brain.config.matrix_units = false;
    let mut rollout = Rollout::new(env.spec(), &brain.config);
    let mut card = DeviceRollout::new(env, &brain.config).unwrap();
    card.collect(&brain.actor(), FIRST_STEP, &mut rollout, &mut observation).unwrap();
    // The policy has moved since, so that some ratios leave the band.
    brain.parameters.iter_mut().enumerate().for_each(|(i, w)| *w += 0.03 * (i as f32).sin());
    // Some advantages are beyond this.
    brain.config.advantage_max = 0.3;
    rollout.estimate(&brain.config);
    assert!(rollout.advantage.iter().any(|a| a.abs() == 0.3) && rollout.advantage.iter().any(|a| a.abs() < 0.3));
    // As if most means lay beyond what has an effect.
    (brain.config.bound_coefficient, brain.config.action_scale) = (0.3, 50.0);
    (card, brain, rollout)
}

/// What an update leaves behind.
struct Learned {
    parameters: Vec<f32>,
    optimizer: Optimizer,
    stats: LearnStats,
}

/// Memory of Adam that is not that of the beginning.
fn optimizer(len: usize, warm: bool) -> Optimizer {
    let number = |scale: f32| move |i: usize| if warm { scale * (1.5 + (0.7 * i as f32).sin()) } else { 0.0 };
    Optimizer {
        mean: (0..len).map(number(1e-4)).collect(),
        square: (0..len).map(number(1e-6)).collect(),
        steps: SETTINGS.gradient_steps,
    }
}

#[test]
fn a_learner_of_fewer_parameters_than_its_networks_have_is_refused() {
    let Some(gpu) = gpu() else { return };
    let (card, brain, _) = collected(&gpu, 4);
    let short = gpu.buffer("parameters", brain.parameters.len() - 1).unwrap();
    let error = DeviceLearner::new(&gpu, card.sizes(), &brain.config, &short, card.buffers()).err().unwrap();
    assert!(error.to_string().contains("of buffer parameters were asked for"), "{error}");
}

fn on_card(card: &DeviceRollout, brain: &Brain, config: &PpoConfig, warm: bool) -> (DeviceLearner, Learned) {
    on_card_within(card, brain, config, warm, (1 << 27, Tiles::default()))
}

/// The same with activations of at most so many bytes at a time, and with other tiles.
fn on_card_within(
    card: &DeviceRollout,
    brain: &Brain,
    config: &PpoConfig,
    warm: bool,
    limits: (u64, Tiles),
) -> (DeviceLearner, Learned) {
    let gpu = card.gpu();
    // Not those of the roll-out, whose networks may have other sizes.
    let weights = gpu.buffer("parameters", brain.parameters.len()).unwrap();
    gpu.write(&weights, 0, &brain.parameters).unwrap();
    let mut learner = DeviceLearner::with_limit(gpu, card.sizes(), config, &weights, card.buffers(), limits).unwrap();
    let mut optimizer = optimizer(brain.parameters.len(), warm);
    gpu.write(&learner.memory().mean, 0, &optimizer.mean).unwrap();
    gpu.write(&learner.memory().square, 0, &optimizer.square).unwrap();
    learner.prepare(card.sizes(), SETTINGS).unwrap();
    let mut batch = gpu.batch();
    learner.record(&mut batch);
    let mut metrics = vec![0.0; learner.metrics_len()];
    let mut parameters = vec![0.0; brain.parameters.len()];
    let memory = learner.memory();
    let mut reads = [
        memory.metrics.part(0, &mut metrics).unwrap(),
        memory.mean.part(0, &mut optimizer.mean).unwrap(),
        memory.square.part(0, &mut optimizer.square).unwrap(),
        weights.part(0, &mut parameters).unwrap(),
    ];
    batch.submit_and_read(&mut reads).unwrap();
    optimizer.steps += learner.layout().steps() as u64;
    let stats = learner.stats(&metrics, SETTINGS.update).unwrap();
    (learner, Learned { parameters, optimizer, stats })
}

fn on_host(rollout: &Rollout, brain: &Brain, config: &PpoConfig, warm: bool) -> Learned {
    let mut learner = Learner::new(&brain.networks, config, 0.05);
    let (mut parameters, mut optimizer) = (brain.parameters.clone(), optimizer(brain.parameters.len(), warm));
    let (address, rate) = ((SETTINGS.seed, SETTINGS.update), SETTINGS.learning_rate);
    let stats = learner
        .learn(&brain.networks, rollout, config, address, rate, &brain.lender, &mut parameters, &mut optimizer, &|| {
            true
        })
        .unwrap();
    Learned { parameters, optimizer, stats: stats.unwrap() }
}

fn assert_same_stats(card: &LearnStats, host: &LearnStats) {
    let close = |what, a: f64, b: f64| assert!((a - b).abs() < 1e-4 * b.abs() + 2e-6, "{what}: {a} on the card, {b}");
    close("policy loss", card.policy_loss, host.policy_loss);
    close("value loss", card.value_loss, host.value_loss);
    close("kl", card.kl, host.kl);
    close("clip fraction", card.clip_fraction, host.clip_fraction);
    close("gradient norm", card.gradient_norm, host.gradient_norm);
}

#[test]
fn advantages_agree_with_the_processor() {
    let Some(gpu) = gpu() else { return };
    let envs = 37;
    let (card, brain, rollout) = collected(&gpu, envs);
    let (learner, _) = on_card(&card, &brain, &brain.config, false);
    let sizes = card.sizes();
    let mut estimate = vec![0.0; 2 * sizes.samples()];
    let mut sums = [0.0; 4];
    gpu.read(&learner.memory().estimate, 0, &mut estimate).unwrap();
    gpu.read(&learner.memory().estimate_sums, 0, &mut sums).unwrap();
    let samples = |all: &[f32]| all.chunks(sizes.padded).flat_map(|row| row[..envs].to_vec()).collect::<Vec<_>>();
    let (advantage, target) = estimate.split_at(sizes.samples());
    assert_close("advantage", &samples(advantage), &rollout.advantage, 1e-5);
    assert_close("target", &samples(target), &rollout.target, 1e-5);
    let sum = |x: &[f32], power: i32| x.iter().map(|&x| f64::from(x).powi(power)).sum::<f64>() as f32;
    let expected =
        [sum(&rollout.advantage, 1), sum(&rollout.target, 1), sum(&rollout.advantage, 2), sum(&rollout.target, 2)];
    assert_close("sums", &sums, &expected, 1e-5);
}

#[test]
fn the_gradient_of_a_minibatch_agrees_with_the_processor() {
    let Some(gpu) = gpu() else { return };
    // Idle columns, and all samples in one minibatch.
    let (card, brain, rollout) = collected(&gpu, 37);
    for hidden in [vec![33, 20], vec![], vec![130]] {
        let config = PpoConfig { epochs: 1, minibatches: 1, value_hidden: hidden, ..brain.config.clone() };
        let mut brain = Brain::new(card.env(), config.clone(), &rollout.observation[..37 * card.sizes().observations]);
        brain.parameters.iter_mut().enumerate().for_each(|(i, w)| *w += 0.03 * (i as f32).sin());
        let (_, got) = on_card(&card, &brain, &config, false);
        let expected = on_host(&rollout, &brain, &config, false);
        assert_same_stats(&got.stats, &expected.stats);
        assert!(got.stats.clip_fraction > 0.01 && got.stats.clip_fraction < 0.9, "{:?}", got.stats);
        // From zero, the mean is a tenth of the shortened gradient.
        let largest = expected.optimizer.mean.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
        let scaled = |x: &[f32]| x.iter().map(|x| x / largest).collect::<Vec<_>>();
        assert_close("gradient", &scaled(&got.optimizer.mean), &scaled(&expected.optimizer.mean), 1e-4);
    }
}

#[test]
fn whole_updates_agree_with_the_processor() {
    let Some(gpu) = gpu() else { return };
    // Few enough samples that every one is shuffled alone, and no idle columns: the same minibatches on both sides.
    let (card, brain, rollout) = collected(&gpu, 64);
    for (epochs, minibatches) in [(1, 1), (2, 8)] {
        let config = PpoConfig { epochs, minibatches, ..brain.config.clone() };
        let (learner, got) = on_card(&card, &brain, &config, true);
        assert!(minibatches == 1 || learner.layout().block == 1);
        let expected = on_host(&rollout, &brain, &config, true);
        assert_same_stats(&got.stats, &expected.stats);
        let moved =
            |after: &[f32]| after.iter().zip(&brain.parameters).map(|(a, b)| (a - b) / 1e-3).collect::<Vec<_>>();
        assert_close("steps", &moved(&got.parameters), &moved(&expected.parameters), 2e-3);
        assert_eq!(got.optimizer.steps, expected.optimizer.steps);
    }
}

#[test]
fn samples_in_several_chunks_give_the_same_gradient() {
    let Some(gpu) = gpu() else { return };
    let (card, brain, _) = collected(&gpu, 37);
    let config = PpoConfig { epochs: 1, minibatches: 1, ..brain.config.clone() };
    let (whole, expected) = on_card(&card, &brain, &config, false);
    let (parts, got) = on_card_within(&card, &brain, &config, false, (1 << 16, Tiles::default()));
    assert!(whole.layout().chunks == 1 && parts.layout().chunks > 2, "{:?}", parts.layout());
    assert_same_stats(&got.stats, &expected.stats);
    let largest = expected.optimizer.mean.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    let scaled = |x: &[f32]| x.iter().map(|x| x / largest).collect::<Vec<_>>();
    assert_close("gradient", &scaled(&got.optimizer.mean), &scaled(&expected.optimizer.mean), 1e-5);
}

#[test]
fn every_tile_gives_the_same_gradient() {
    let Some(gpu) = gpu() else { return };
    let (card, brain, rollout) = collected(&gpu, 64);
    let config = PpoConfig { epochs: 1, minibatches: 1, ..brain.config.clone() };
    let expected = on_host(&rollout, &brain, &config, false).optimizer.mean;
    let largest = expected.iter().fold(0.0_f32, |most, x| most.max(x.abs()));
    let scaled = |x: &[f32]| x.iter().map(|x| x / largest).collect::<Vec<_>>();
    for tile in [
        Tile::new(16, 64, 16, (4, 4)),
        Tile::new(32, 64, 16, (4, 4)),
        Tile::new(64, 64, 16, (4, 4)),
        Tile::new(64, 128, 8, (8, 4)),
        Tile::new(64, 128, 8, (8, 8)),
        Tile::new(128, 64, 8, (8, 8)),
        Tile::new(128, 128, 8, (8, 8)),
    ] {
        let tiles = Tiles { layers: Some(tile), weights: Some(tile), ..Tiles::default() };
        let (_, got) = on_card_within(&card, &brain, &config, false, (1 << 27, tiles));
        assert_close("gradient", &scaled(&got.optimizer.mean), &scaled(&expected), 1e-4);
    }
}

#[test]
fn matrix_units_give_the_same_gradient_but_for_rounding_to_16_bits() {
    let Some(gpu) = gpu() else { return };
    if !gpu.adapter().cooperative_matrix {
        println!("skipped: {} has no matrix units", gpu.adapter().name);
        return;
    }
    // Idle columns.
    let (card, brain, rollout) = collected(&gpu, 37);
    for (hidden, limit, columns, tile) in [
        (vec![33, 20], 1 << 27, 32, MatrixTile::new((32, 32), (16, 32))),
        (vec![130], 1 << 27, 64, MatrixTile::new((64, 64), (32, 32))),
        (vec![], 1 << 27, 32, MatrixTile::new((128, 64), (32, 64))),
        // Several chunks.
        (vec![256, 16], 1 << 18, 64, MatrixTile::new((128, 128), (64, 64))),
    ] {
        // Nothing is cut off: a ratio at the edge may fall on the other side when it is rounded.
        let passes = PpoConfig { epochs: 1, minibatches: 1, clip: 100.0, ..brain.config.clone() };
        let config = PpoConfig { value_hidden: hidden, matrix_units: true, ..passes };
        let mut brain = Brain::new(card.env(), config.clone(), &rollout.observation[..37 * card.sizes().observations]);
        brain.parameters.iter_mut().enumerate().for_each(|(i, w)| *w += 0.03 * (i as f32).sin());
        let exact = on_host(&rollout, &brain, &config, false).optimizer.mean;
        let tiles = Tiles { columns: Some(columns), matrix_weights: Some(tile), ..Tiles::default() };
        let (learner, got) = on_card_within(&card, &brain, &config, false, (limit, tiles));
        assert_eq!(learner.layout().precision, Precision::Half);
        assert_eq!(learner.layout().chunks > 1, limit < 1 << 27, "{:?}", learner.layout());
        // What it costs to round the weights alone, in 32 bits on the processor.
        brain.parameters.iter_mut().for_each(|w| *w = to_16_bits(*w));
        let rounded = on_host(&rollout, &brain, &config, false).optimizer.mean;
        let networks = Networks::new(card.env().spec(), &config);
        for part in [networks.policy_range(), networks.value_range()] {
            let [error, cost] = [&got.optimizer.mean, &rounded]
                .map(|other| greatest_difference(&other[part.clone()], &exact[part.clone()]));
            // Activations and gradients are rounded, too.
            assert!(error < 3.0 * cost, "{error:e} on the card, {cost:e} by rounding the weights");
        }
    }
}

/// The nearest number with a mantissa of 11 bits (Veltkamp's splitting).
fn to_16_bits(x: f32) -> f32 {
    let far = 8193.0 * x;
    far - (far - x)
}

fn greatest_difference(a: &[f32], b: &[f32]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn the_same_update_gives_the_same_bits() {
    let Some(gpu) = gpu() else { return };
    let (card, brain, _) = collected(&gpu, 37);
    let bits = || {
        let (_, learned) = on_card(&card, &brain, &brain.config, true);
        let all = [learned.parameters, learned.optimizer.mean, learned.optimizer.square].concat();
        all.iter().map(|x| x.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!(bits(), bits());
}
