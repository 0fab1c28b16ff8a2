//! PPO, metrics, checkpoints, evaluation.
