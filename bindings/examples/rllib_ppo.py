"""RLlib's PPO with two workers that collect: `python rllib_ppo.py --steps 4000000`.

Needs `pip install myoenv[rllib]`.
"""

import argparse
import time

import ray
import torch
from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from ray.tune.registry import register_env

import myoenv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--task", default="pointing-single")
parser.add_argument("--envs", type=int, default=64, help="environments of a worker")
parser.add_argument("--workers", type=int, default=2)
parser.add_argument("--steps", type=int, default=400_000, help="control steps of all environments")
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--episodes", type=int, default=1000, help="fresh episodes to evaluate in at the end")
args = parser.parse_args()


def make(config):
    """One environment to look at its spaces; side by side where RLlib asks for `num_envs`."""
    if "num_envs" in config:
        return myoenv.make_vec(config["task"], config["num_envs"], "cpu", threads=1)
    return myoenv.make(config["task"])


register_env("myo", make)
ray.init(include_dashboard=False, log_to_driver=False)
config = (
    PPOConfig()
    .environment("myo", env_config={"task": args.task})
    .env_runners(
        num_env_runners=args.workers,
        num_envs_per_env_runner=args.envs,
        gym_env_vectorize_mode="vector_entry_point",
        rollout_fragment_length=16,
        num_cpus_per_env_runner=0.5,
    )
    .training(
        train_batch_size_per_learner=16 * args.envs * args.workers,
        minibatch_size=4 * args.envs * args.workers,
        num_epochs=4,
        gamma=0.98,
        lambda_=0.95,
        lr=1e-3,
        entropy_coeff=0.002,
        grad_clip=1.0,
        use_kl_loss=False,
        vf_clip_param=1e6,
    )
    .rl_module(model_config=DefaultModelConfig(fcnet_hiddens=[128, 128]))
    .debugging(seed=args.seed, log_level="ERROR")
)
algorithm = config.build_algo()

start, steps = time.perf_counter(), 0
while steps < args.steps:
    collected = algorithm.train()["env_runners"]
    steps = collected["num_env_steps_sampled_lifetime"]
    mean_return = collected.get("episode_return_mean", float("nan"))
    rate = steps / (time.perf_counter() - start)
    print(f"{steps:,.0f} steps, return {mean_return:.2f}, {rate:,.0f} steps/s, learning included", flush=True)

module = algorithm.get_module()


@torch.inference_mode()
def act(observation):
    """The mean actions: of the means and logarithms of deviations, the first half."""
    out = module.forward_inference({"obs": torch.from_numpy(observation)})["action_dist_inputs"]
    return out[:, : out.shape[1] // 2].clamp(-1, 1).numpy()


table = myoenv.evaluate(act, args.episodes, task=args.task, backend="cpu")
print(f"success {table['success'].mean():.1%} of {args.episodes} fresh episodes")
algorithm.stop()
ray.shutdown()
