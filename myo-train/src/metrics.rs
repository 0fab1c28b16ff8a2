//! What one update tells about the training.

use myo_env::{Column, EnvSpec};

use crate::learn::LearnStats;
use crate::rollout::told_layouts;

/// Sums over finished episodes, one per column of the episode summary; NaN entries are left out.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeSums {
    /// Finished episodes.
    pub count: u64,
    sum: Vec<f64>,
    entries: Vec<u64>,
}

impl EpisodeSums {
    /// No episodes.
    pub fn new(columns: usize) -> Self {
        Self { count: 0, sum: vec![0.0; columns], entries: vec![0; columns] }
    }

    /// From the number of episodes, then sums per column, then numbers of entries per column, as the card adds them up.
    pub fn from_rows(rows: &[f32]) -> Self {
        let (sum, entries) = rows[1..].split_at(rows.len() / 2);
        let entries = entries.iter().map(|&n| n as u64).collect();
        Self { count: rows[0] as u64, sum: sum.iter().map(|&x| x.into()).collect(), entries }
    }

    /// Forgets all episodes.
    pub fn clear(&mut self) {
        self.count = 0;
        self.sum.fill(0.0);
        self.entries.fill(0);
    }

    /// Takes in the summary of one episode.
    pub fn add(&mut self, summary: &[f32]) {
        self.count += 1;
        for ((sum, entries), &x) in self.sum.iter_mut().zip(&mut self.entries).zip(summary) {
            if !x.is_nan() {
                *sum += f64::from(x);
                *entries += 1;
            }
        }
    }

    /// Mean of every column, NaN where there was no entry.
    pub fn means(&self) -> impl Iterator<Item = f64> + '_ {
        self.sum.iter().zip(&self.entries).map(|(sum, &n)| sum / n as f64)
    }
}

/// Episodes that ended in an update.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Episodes {
    /// How many.
    pub count: u64,
    /// Their means: the names of [`EnvSpec::episode_names`](myo_env::EnvSpec::episode_names), NaN without an episode.
    pub means: Vec<(String, f64)>,
}

impl Episodes {
    /// With these names of columns.
    pub(crate) fn new(names: &[String], sums: &EpisodeSums) -> Self {
        Self { count: sums.count, means: names.iter().cloned().zip(sums.means()).collect() }
    }

    /// Mean of a column of the episode summary, if there is one and an episode ended.
    pub fn mean(&self, name: &str) -> Option<f64> {
        let found = self.means.iter().find(|(n, _)| n == name);
        found.map(|&(_, mean)| mean).filter(|mean| !mean.is_nan())
    }
}

/// Everything that one update is worth recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UpdateMetrics {
    /// Control steps of all environments since the start.
    pub env_steps: u64,
    /// Updates since the start, this one included.
    pub updates: u64,
    /// Seconds of training since the start, those before a resume included.
    pub wall_s: f64,
    /// Seconds spent acting and stepping the environment in this update.
    pub collect_s: f64,
    /// Seconds spent learning in this update.
    pub learn_s: f64,
    /// Whole episodes of the policy with its noise.
    pub episodes: Episodes,
    /// Of the policy without noise; see [`PpoConfig::noise_free_envs`](crate::PpoConfig::noise_free_envs).
    pub noise_free: Episodes,
    /// As `episodes`, of each layout; empty where there is one.
    pub layouts: Vec<Episodes>,
    /// Mean reward per control step.
    pub reward_per_step: f64,
    /// Losses, divergence, clip fraction and gradient norm.
    pub learn: LearnStats,
    /// Share of the variance of the value targets that the value network foresaw.
    pub explained_variance: f64,
    /// Entropy of the policy in nats, summed over actions.
    pub entropy: f64,
    /// Mean standard deviation of the policy's outputs.
    pub action_std: f64,
    /// Step size of Adam that this update used.
    pub learning_rate: f64,
    /// Share of what movement and errors cost that counted in this update.
    pub cost_share: f64,
}

impl UpdateMetrics {
    /// Control steps of all environments per second in this update, learning included.
    pub fn steps_per_s(&self) -> f64 {
        self.env_steps as f64 / self.updates as f64 / (self.collect_s + self.learn_s)
    }

    /// Names of [`UpdateMetrics::row`].
    pub fn columns(spec: &EnvSpec) -> Vec<String> {
        let name = |column: &Column| column.name.to_owned();
        let (first, last) = (FIRST_COLUMNS.iter().map(name), LAST_COLUMNS.iter().map(name));
        let layouts = (1..=told_layouts(spec)).map(|k| format!("layout_{k}_{}", LAYOUT_COLUMN.name));
        first.chain(spec.episode_names.iter().cloned()).chain(last).chain(layouts).collect()
    }

    /// All numbers, in the order of [`UpdateMetrics::columns`].
    pub fn row(&self) -> Vec<f64> {
        let first: [f64; FIRST_COLUMNS.len()] = [
            self.env_steps as f64,
            self.updates as f64,
            self.wall_s,
            self.steps_per_s(),
            self.collect_s,
            self.learn_s,
            self.episodes.count as f64,
        ];
        let learn = &self.learn;
        let last: [f64; LAST_COLUMNS.len()] = [
            self.reward_per_step,
            learn.policy_loss,
            learn.value_loss,
            self.explained_variance,
            learn.kl,
            learn.clip_fraction,
            self.entropy,
            self.action_std,
            learn.gradient_norm,
            self.learning_rate,
            self.cost_share,
        ];
        let layouts = self.layouts.iter().map(|episodes| episodes.mean(LAYOUT_COLUMN.name).unwrap_or(f64::NAN));
        first.into_iter().chain(self.episodes.means.iter().map(|&(_, mean)| mean)).chain(last).chain(layouts).collect()
    }
}

/// Columns of the metrics before those of the episodes.
pub const FIRST_COLUMNS: [Column; 7] = [
    Column::new("env_steps", "", "Control steps of all environments since the start."),
    Column::new("updates", "", "Updates since the start, this one included."),
    Column::new("wall_s", "s", "Training since the start, that before a resume included."),
    Column::new(
        "steps_per_s",
        "1/s",
        "Control steps of all environments per second in this update, learning included.",
    ),
    Column::new("collect_s", "s", "Acting and stepping the environments in this update."),
    Column::new("learn_s", "s", "Learning in this update."),
    Column::new(
        "episodes",
        "",
        "Episodes that ended in this update, of environments that act with noise and do not explore.",
    ),
];

/// Column of the metrics for every layout, after all others, where one policy learns several.
pub const LAYOUT_COLUMN: Column = Column::new(
    "success",
    "",
    "Share of the episodes of this layout that ended in this update in which every target was done.",
);

/// Columns of the metrics after those of the episodes.
pub const LAST_COLUMNS: [Column; 11] = [
    Column::new("reward_per_step", "", "Mean reward per control step, unscaled."),
    Column::new("policy_loss", "", "Clipped surrogate objective, negated; mean over the update."),
    Column::new("value_loss", "", "Mean squared error of the value network, of scaled rewards."),
    Column::new("explained_variance", "", "Share of the variance of the value targets that the value network foresaw."),
    Column::new("kl", "nats", "Divergence from the collecting policy, mean over the last pass."),
    Column::new("clip_fraction", "", "Share of samples whose probability ratio left the clip range."),
    Column::new("entropy", "nats", "Entropy of the policy, summed over actions."),
    Column::new("action_std", "", "Mean standard deviation of the policy's outputs."),
    Column::new("gradient_norm", "", "Length of the gradient before it was shortened, mean."),
    Column::new("learning_rate", "", "Step size of Adam that this update used."),
    Column::new("cost_share", "", "Share of what movement and errors cost that counted in this update."),
];
