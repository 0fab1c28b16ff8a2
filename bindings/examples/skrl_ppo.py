"""skrl's PPO, which takes Gymnasium's vector environments as they are: `python skrl_ppo.py --steps 4000000`.

Needs `pip install myoenv[skrl]`.
"""

import argparse
import time

import torch
from skrl.agents.torch import ExperimentCfg
from skrl.agents.torch.ppo import PPO
from skrl.envs.wrappers.torch import wrap_env
from skrl.memories.torch import RandomMemory
from skrl.models.torch import DeterministicMixin, GaussianMixin, Model
from skrl.resources.preprocessors.torch import RunningStandardScaler
from skrl.trainers.torch import SequentialTrainer
from skrl.utils import set_seed
from torch import nn

import myoenv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--task", default="pointing-single")
parser.add_argument("--envs", type=int, default=1024)
parser.add_argument("--steps", type=int, default=4_000_000, help="control steps of all environments")
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--episodes", type=int, default=1000, help="fresh episodes to evaluate in at the end")
args = parser.parse_args()
ROLLOUT = 16


def mlp(inputs: int, outputs: int) -> nn.Sequential:
    """Two hidden layers of 128."""
    return nn.Sequential(nn.Linear(inputs, 128), nn.ELU(), nn.Linear(128, 128), nn.ELU(), nn.Linear(128, outputs))


class Policy(GaussianMixin, Model):
    """Gaussian with one standard deviation per muscle."""

    def __init__(self, **spaces) -> None:
        Model.__init__(self, **spaces)
        GaussianMixin.__init__(self)
        self.net = mlp(self.num_observations, self.num_actions)
        self.log_std = nn.Parameter(torch.full((self.num_actions,), -0.7))

    def compute(self, inputs, role):
        return self.net(inputs["observations"]), {"log_std": self.log_std}


class Value(DeterministicMixin, Model):
    """State value."""

    def __init__(self, **spaces) -> None:
        Model.__init__(self, **spaces)
        DeterministicMixin.__init__(self)
        self.net = mlp(self.num_observations, 1)

    def compute(self, inputs, role):
        return self.net(inputs["observations"]), {}


set_seed(args.seed)
envs = wrap_env(myoenv.make_vec(args.task, args.envs, seed=args.seed, autoreset="same_step"), wrapper="gymnasium")
spaces = {"observation_space": envs.observation_space, "action_space": envs.action_space, "device": envs.device}
agent = PPO(
    models={"policy": Policy(**spaces), "value": Value(**spaces)},
    memory=RandomMemory(memory_size=ROLLOUT, num_envs=args.envs, device=envs.device),
    **spaces,
    cfg={
        "experiment": ExperimentCfg(write_interval=0, checkpoint_interval=0),
        "rollouts": ROLLOUT,
        "learning_epochs": 4,
        "mini_batches": 4,
        "discount_factor": 0.98,
        "learning_rate": 1e-3,
        "entropy_loss_scale": 0.002,
        "value_loss_scale": 0.5,
        "value_clip": 0.0,
        "grad_norm_clip": 1.0,
        "time_limit_bootstrap": True,
        "observation_preprocessor": RunningStandardScaler,
        "observation_preprocessor_kwargs": {"size": envs.observation_space, "device": envs.device},
    },
)

updates = max(1, args.steps // (ROLLOUT * args.envs))
timesteps = updates * ROLLOUT
trainer = SequentialTrainer(
    env=envs, agents=agent, cfg={"timesteps": timesteps, "headless": True, "close_environment_at_exit": False}
)
start = time.perf_counter()
trainer.train()
print(f"{timesteps * args.envs / (time.perf_counter() - start):,.0f} steps/s, learning included")


@torch.inference_mode()
def act(observation):
    """The mean actions."""
    agent.enable_training_mode(False)
    rows = torch.from_numpy(observation).to(envs.device)
    return agent.act(rows, None, timestep=timesteps, timesteps=timesteps)[1]["mean_actions"].cpu().numpy()


table = myoenv.evaluate(act, args.episodes, task=args.task)
print(f"success {table['success'].mean():.1%} of {args.episodes} fresh episodes")
