//! What one update tells about the training.

use crate::learn::LearnStats;

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
    /// Episodes that ended in this update.
    pub episodes: u64,
    /// Their means: the names of [`EnvSpec::episode_names`](myo_env::EnvSpec::episode_names), NaN without an episode.
    pub episode_means: Vec<(String, f64)>,
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
}

impl UpdateMetrics {
    /// Control steps of all environments per second in this update, learning included.
    pub fn steps_per_s(&self) -> f64 {
        self.env_steps as f64 / self.updates as f64 / (self.collect_s + self.learn_s)
    }

    /// Mean of a column of the episode summary, if there is one and an episode ended.
    pub fn episode_mean(&self, name: &str) -> Option<f64> {
        let found = self.episode_means.iter().find(|(n, _)| n == name);
        found.map(|&(_, mean)| mean).filter(|mean| !mean.is_nan())
    }

    /// Names of [`UpdateMetrics::row`].
    pub fn columns(episode_names: &[String]) -> impl Iterator<Item = &str> {
        FIRST_COLUMNS.into_iter().chain(episode_names.iter().map(String::as_str)).chain(LAST_COLUMNS)
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
            self.episodes as f64,
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
        ];
        first.into_iter().chain(self.episode_means.iter().map(|&(_, mean)| mean)).chain(last).collect()
    }
}

const FIRST_COLUMNS: [&str; 7] = ["env_steps", "updates", "wall_s", "steps_per_s", "collect_s", "learn_s", "episodes"];
const LAST_COLUMNS: [&str; 10] = [
    "reward_per_step",
    "policy_loss",
    "value_loss",
    "explained_variance",
    "kl",
    "clip_fraction",
    "entropy",
    "action_std",
    "gradient_norm",
    "learning_rate",
];
