"""rsl_rl's PPO: `python rsl_rl_ppo.py --steps 4000000`.

Needs `pip install myoenv[rsl-rl]`.
"""

import argparse
import time

import numpy as np
import torch
from rsl_rl.runners import OnPolicyRunner
from tensordict import TensorDict

import myoenv
from myoenv.rsl_rl import RslRlVecEnv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--task", default="pointing-single")
parser.add_argument("--envs", type=int, default=1024)
parser.add_argument("--steps", type=int, default=4_000_000, help="control steps of all environments")
parser.add_argument("--log-dir", default=None, help="folder for TensorBoard and checkpoints")
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--episodes", type=int, default=1000, help="fresh episodes to evaluate in at the end")
args = parser.parse_args()

network = {"class_name": "MLPModel", "hidden_dims": [128, 128], "activation": "elu", "obs_normalization": True}
config = {
    "num_steps_per_env": 16,
    "save_interval": 100,
    "obs_groups": {"actor": ["policy"], "critic": ["policy"]},
    "actor": {
        **network,
        "distribution_cfg": {"class_name": "GaussianDistribution", "init_std": 0.5, "std_type": "log"},
    },
    "critic": network,
    "algorithm": {
        "class_name": "PPO",
        "num_learning_epochs": 4,
        "num_mini_batches": 4,
        "gamma": 0.98,
        "lam": 0.95,
        "learning_rate": 1e-3,
        "desired_kl": 0.02,
        "entropy_coef": 0.002,
    },
}

torch.manual_seed(args.seed)
envs = RslRlVecEnv(args.task, args.envs, seed=args.seed)
runner = OnPolicyRunner(envs, config, log_dir=args.log_dir)
updates = max(1, args.steps // (config["num_steps_per_env"] * args.envs))
start = time.perf_counter()
runner.learn(updates)
wall_s = time.perf_counter() - start
print(f"{updates * config['num_steps_per_env'] * args.envs / wall_s:,.0f} steps/s, learning included")

policy = runner.get_inference_policy()


@torch.inference_mode()
def act(observation: np.ndarray) -> np.ndarray:
    """The mean actions."""
    rows = TensorDict({"policy": torch.from_numpy(observation)}, batch_size=[len(observation)])
    return policy(rows.to(envs.device)).cpu().numpy()


table = myoenv.evaluate(act, args.episodes, task=args.task)
print(f"success {table['success'].mean():.1%} of {args.episodes} fresh episodes")
