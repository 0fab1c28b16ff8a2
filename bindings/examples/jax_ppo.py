"""PPO in plain JAX on the Brax-style environment, an update is one program: `python jax_ppo.py --steps 4000000`.

Needs `pip install myoenv[jax]`.
"""

import argparse
import time
from functools import partial
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax import Array

import myoenv
from myoenv.brax import BraxEnv

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--task", default="pointing-single")
parser.add_argument("--envs", type=int, default=1024)
parser.add_argument("--steps", type=int, default=4_000_000, help="control steps of all environments")
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--episodes", type=int, default=1000, help="fresh episodes to evaluate in at the end")
args = parser.parse_args()
ROLLOUT, EPOCHS, MINIBATCHES = 16, 4, 4
GAMMA, GAE_LAMBDA, CLIP, ENTROPY, LEARNING_RATE = 0.98, 0.95, 0.2, 0.002, 1e-3

env = BraxEnv(args.task, args.envs, seed=args.seed)
Params = Any


class Moments(NamedTuple):
    """Running mean and variance of observations."""

    mean: Array
    var: Array
    count: Array

    def see(self, obs: Array) -> "Moments":
        n, delta = obs.shape[0], obs.mean(0) - self.mean
        total = self.count + n
        m2 = self.var * self.count + obs.var(0) * n + delta**2 * self.count * n / total
        return Moments(self.mean + delta * n / total, m2 / total, total)

    def normalise(self, obs: Array) -> Array:
        return jnp.clip((obs - self.mean) / jnp.sqrt(self.var + 1e-4), -5, 5)


class Sample(NamedTuple):
    """One control step of every environment."""

    obs: Array
    action: Array
    logp: Array
    value: Array
    reward: Array
    done: Array


def init(key: Array) -> Params:
    """Two hidden layers of 128 for policy and value."""

    def mlp(key: Array, outputs: int, last_gain: float) -> list[tuple[Array, Array]]:
        sizes, gains = (env.observation_size, 128, 128, outputs), (2**0.5, 2**0.5, last_gain)
        keys = jax.random.split(key, 3)
        weights = [
            jax.nn.initializers.orthogonal(gain)(k, (m, n))
            for k, gain, m, n in zip(keys, gains, sizes, sizes[1:], strict=False)
        ]
        return [(w, jnp.zeros(w.shape[1])) for w in weights]

    actor, critic = jax.random.split(key)
    log_std = jnp.full(env.action_size, -0.7)
    return {"actor": mlp(actor, env.action_size, 0.01), "critic": mlp(critic, 1, 1.0), "log_std": log_std}


def forward(layers: list[tuple[Array, Array]], x: Array) -> Array:
    for w, b in layers[:-1]:
        x = jnp.tanh(x @ w + b)
    w, b = layers[-1]
    return x @ w + b


def value_of(params: Params, obs: Array) -> Array:
    return forward(params["critic"], obs)[..., 0]


def mean_action(params: Params, obs: Array) -> Array:
    """Muscles at a quarter of their strength, -0.5, when nothing is known."""
    return forward(params["actor"], obs) - 0.5


def log_prob(params: Params, obs: Array, action: Array) -> Array:
    z = (action - mean_action(params, obs)) / jnp.exp(params["log_std"])
    return (-0.5 * z**2 - params["log_std"] - 0.5 * jnp.log(2 * jnp.pi)).sum(-1)


def loss_of(params: Params, batch: tuple[Array, ...]) -> Array:
    obs, action, old_logp, advantage, target = batch
    ratio = jnp.exp(log_prob(params, obs, action) - old_logp)
    advantage = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
    policy_loss = -jnp.minimum(ratio * advantage, jnp.clip(ratio, 1 - CLIP, 1 + CLIP) * advantage).mean()
    value_loss = 0.5 * jnp.square(value_of(params, obs) - target).mean()
    return policy_loss + value_loss - ENTROPY * params["log_std"].sum()


def adam(params: Params, grads: Params, m: Params, v: Params, t: Array) -> tuple[Params, Params, Params, Array]:
    """One step of Adam (Kingma and Ba 2014, arXiv 1412.6980), gradients shortened to length 1."""
    norm = jnp.sqrt(sum(jnp.square(g).sum() for g in jax.tree.leaves(grads)))
    grads, t = jax.tree.map(lambda g: g / jnp.maximum(norm, 1.0), grads), t + 1
    m = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, m, grads)
    v = jax.tree.map(lambda v, g: 0.999 * v + 0.001 * g**2, v, grads)
    rate = LEARNING_RATE * jnp.sqrt(1 - 0.999**t) / (1 - 0.9**t)
    return jax.tree.map(lambda p, m, v: p - rate * m / (jnp.sqrt(v) + 1e-5), params, m, v), m, v, t


@partial(jax.jit, donate_argnums=0)
def update(carry: tuple) -> tuple[tuple, tuple[Array, Array]]:
    """Collects a roll-out and learns from it; returns how many episodes ended and how many of them in success."""
    (params, m, v, t), moments, state, key = carry

    def act(carry: tuple, key: Array) -> tuple[tuple, tuple]:
        moments, state = carry
        moments = moments.see(state.obs)
        obs = moments.normalise(state.obs)
        noise = jax.random.normal(key, (args.envs, env.action_size))
        action = mean_action(params, obs) + jnp.exp(params["log_std"]) * noise
        state = env.step(state, jnp.clip(action, -1, 1))
        # Where the time was up, what could still have come is worth its value.
        rest = GAMMA * value_of(params, moments.normalise(state.info["next_obs"])) * state.info["truncation"]
        logp, value = log_prob(params, obs, action), value_of(params, obs)
        sample = Sample(obs, action, logp, value, state.reward + rest, state.done)
        return (moments, state), (sample, state.metrics["success"].sum())

    key, act_key, shuffle_key = jax.random.split(key, 3)
    (moments, state), (samples, successes) = jax.lax.scan(act, (moments, state), jax.random.split(act_key, ROLLOUT))

    def gae(carry: tuple[Array, Array], sample: Sample) -> tuple[tuple[Array, Array], Array]:
        advantage, next_value = carry
        going_on = 1 - sample.done
        delta = sample.reward + GAMMA * next_value * going_on - sample.value
        advantage = delta + GAMMA * GAE_LAMBDA * going_on * advantage
        return (advantage, sample.value), advantage

    last_value = value_of(params, moments.normalise(state.obs))
    _, advantages = jax.lax.scan(gae, (jnp.zeros(args.envs), last_value), samples, reverse=True)
    columns = (samples.obs, samples.action, samples.logp, advantages, advantages + samples.value)
    columns = jax.tree.map(lambda x: x.reshape(ROLLOUT * args.envs, *x.shape[2:]), columns)

    def learn(learner: tuple, part: Array) -> tuple[tuple, None]:
        grads = jax.grad(loss_of)(learner[0], jax.tree.map(lambda x: x[part], columns))
        return adam(learner[0], grads, *learner[1:]), None

    orders = jax.vmap(partial(jax.random.permutation, x=ROLLOUT * args.envs))(jax.random.split(shuffle_key, EPOCHS))
    learner, _ = jax.lax.scan(learn, (params, m, v, t), orders.reshape(EPOCHS * MINIBATCHES, -1))
    return (learner, moments, state, key), (samples.done.sum(), successes.sum())


key, init_key, reset_key = jax.random.split(jax.random.key(args.seed), 3)
params = init(init_key)
zeros = jax.tree.map(jnp.zeros_like, params)
moments = Moments(jnp.zeros(env.observation_size), jnp.ones(env.observation_size), jnp.array(1e-4))
carry = ((params, zeros, jax.tree.map(jnp.zeros_like, params), jnp.array(0)), moments, env.reset(reset_key), key)
carry, _ = update(carry)  # compiles, and is not timed

start, updates = time.perf_counter(), max(1, args.steps // (ROLLOUT * args.envs))
ended = succeeded = 0.0
for k in range(1, updates + 1):
    carry, (done, success) = update(carry)
    ended, succeeded = ended + float(done), succeeded + float(success)
    if k % 20 == 0 or k == updates:
        rate = k * ROLLOUT * args.envs / (time.perf_counter() - start)
        share = f"{succeeded / ended:.1%}" if ended else "none ended"
        print(f"{k * ROLLOUT * args.envs:,} steps, success {share}, {rate:,.0f} steps/s, learning included")
        ended = succeeded = 0.0

learner, moments, *_ = carry
act = jax.jit(lambda obs: mean_action(learner[0], moments.normalise(obs)))
table = myoenv.evaluate(act, args.episodes, task=args.task)
print(f"success {table['success'].mean():.1%} of {args.episodes} fresh episodes")
