"""PPO in one file, in the manner of CleanRL's `ppo_continuous_action.py`: `python cleanrl_ppo.py --steps 4000000`.

Needs `pip install myoenv[torch]`.
"""

import argparse
import time
from collections import deque

import torch
from torch import Tensor, nn
from torch.distributions import Normal

import myoenv
from myoenv.torch import TorchVectorEnv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--task", default="pointing-single")
parser.add_argument("--envs", type=int, default=1024)
parser.add_argument("--steps", type=int, default=4_000_000, help="control steps of all environments")
parser.add_argument("--rollout", type=int, default=16, help="control steps of each environment per update")
parser.add_argument("--epochs", type=int, default=4)
parser.add_argument("--minibatches", type=int, default=4)
parser.add_argument("--lr", type=float, default=1e-3)
parser.add_argument("--gamma", type=float, default=0.98)
parser.add_argument("--gae-lambda", type=float, default=0.95)
parser.add_argument("--clip", type=float, default=0.2)
parser.add_argument("--entropy", type=float, default=0.002)
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--episodes", type=int, default=1000, help="fresh episodes to evaluate in at the end")
args = parser.parse_args()


def mlp(inputs: int, outputs: int, last_gain: float) -> nn.Sequential:
    """Two hidden layers of 128, orthogonal weights."""
    layers = [nn.Linear(inputs, 128), nn.Tanh(), nn.Linear(128, 128), nn.Tanh(), nn.Linear(128, outputs)]
    for layer, gain in zip(layers[::2], (2**0.5, 2**0.5, last_gain), strict=True):
        nn.init.orthogonal_(layer.weight, gain)
        nn.init.zeros_(layer.bias)
    return nn.Sequential(*layers)


class Agent(nn.Module):
    """Policy, value, and the running mean and variance of observations."""

    def __init__(self, num_obs: int, num_actions: int) -> None:
        super().__init__()
        self.actor, self.critic = mlp(num_obs, num_actions, 0.01), mlp(num_obs, 1, 1.0)
        self.log_std = nn.Parameter(torch.full((num_actions,), -0.7))
        self.register_buffer("mean", torch.zeros(num_obs))
        self.register_buffer("var", torch.ones(num_obs))
        self.register_buffer("count", torch.tensor(1e-4))

    def see(self, obs: Tensor) -> None:
        """Takes a batch of observations into the running moments (Chan et al. 1983)."""
        n, delta = obs.shape[0], obs.mean(0) - self.mean
        total = self.count + n
        m2 = self.var * self.count + obs.var(0, correction=0) * n + delta**2 * self.count * n / total
        self.mean += delta * n / total
        self.var, self.count = m2 / total, total

    def normalise(self, obs: Tensor) -> Tensor:
        return ((obs - self.mean) / (self.var + 1e-4).sqrt()).clamp(-5, 5)

    def policy(self, obs: Tensor) -> Normal:
        """Muscles at a quarter of their strength, -0.5, when nothing is known."""
        return Normal(self.actor(obs) - 0.5, self.log_std.exp())

    def value(self, obs: Tensor) -> Tensor:
        return self.critic(obs).squeeze(-1)


torch.manual_seed(args.seed)
envs = TorchVectorEnv(myoenv.make_vec(args.task, args.envs, seed=args.seed, autoreset="same_step"))
agent = Agent(envs.num_obs, envs.num_actions)
optimizer = torch.optim.Adam(agent.parameters(), lr=args.lr, eps=1e-5)

shape = (args.rollout, args.envs)
obs_buf, actions_buf = torch.zeros(*shape, envs.num_obs), torch.zeros(*shape, envs.num_actions)
logp_buf, rewards, dones, values = (torch.zeros(shape) for _ in range(4))
successes: deque[float] = deque(maxlen=1000)

obs, _ = envs.reset()
start = time.perf_counter()
updates = max(1, args.steps // (args.rollout * args.envs))
for update in range(1, updates + 1):
    with torch.no_grad():
        for t in range(args.rollout):
            agent.see(obs)
            obs_buf[t] = agent.normalise(obs)
            policy = agent.policy(obs_buf[t])
            actions_buf[t] = policy.sample()
            logp_buf[t] = policy.log_prob(actions_buf[t]).sum(-1)
            values[t] = agent.value(obs_buf[t])
            obs, reward, terminated, truncated, infos = envs.step(actions_buf[t].clamp(-1, 1))
            rewards[t], dones[t] = reward, (terminated | truncated).float()
            if "ended" in infos:
                # Where the time was up, what could still have come is worth its value.
                ended = infos["ended"]
                final_value = agent.value(agent.normalise(infos["final_obs"]))
                rewards[t, ended] += args.gamma * final_value * (~terminated[ended])
                successes.extend(infos["final_info"]["summary"]["success"][ended.numpy()])

        # Generalised advantage estimation (Schulman et al. 2015, arXiv 1506.02438).
        advantages, last, next_value = torch.zeros(shape), 0.0, agent.value(agent.normalise(obs))
        for t in reversed(range(args.rollout)):
            going_on = 1 - dones[t]
            delta = rewards[t] + args.gamma * next_value * going_on - values[t]
            advantages[t] = last = delta + args.gamma * args.gae_lambda * going_on * last
            next_value = values[t]
        returns = (advantages + values).flatten()

    flat = (obs_buf.flatten(0, 1), actions_buf.flatten(0, 1), logp_buf.flatten(), advantages.flatten(), returns)
    for _ in range(args.epochs):
        for part in torch.randperm(returns.numel()).chunk(args.minibatches):
            b_obs, b_actions, b_logp, b_advantages, b_returns = (buffer[part] for buffer in flat)
            policy = agent.policy(b_obs)
            ratio = (policy.log_prob(b_actions).sum(-1) - b_logp).exp()
            b_advantages = (b_advantages - b_advantages.mean()) / (b_advantages.std() + 1e-8)
            clipped = ratio.clamp(1 - args.clip, 1 + args.clip)
            policy_loss = -torch.min(b_advantages * ratio, b_advantages * clipped).mean()
            value_loss = 0.5 * (agent.value(b_obs) - b_returns).square().mean()
            loss = policy_loss + value_loss - args.entropy * policy.entropy().sum(-1).mean()
            optimizer.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(agent.parameters(), 1.0)
            optimizer.step()

    if update % 20 == 0 or update == updates:
        steps = update * args.rollout * args.envs
        rate = steps / (time.perf_counter() - start)
        success = f"{sum(successes) / len(successes):.1%}" if successes else "none ended"
        print(f"{steps:,} steps, success {success}, {rate:,.0f} steps/s, learning included")


@torch.no_grad()
def act(observation):
    """The mean actions."""
    return agent.policy(agent.normalise(torch.from_numpy(observation))).mean.numpy()


table = myoenv.evaluate(act, args.episodes, task=args.task)
print(f"success {table['success'].mean():.1%} of {args.episodes} fresh episodes")
