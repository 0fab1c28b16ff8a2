"""Environments for JAX: `reset(key)` and `step(state, action)` that work under `jax.jit` and `jax.lax.scan`.

>>> from myoenv.jax import JaxEnv
>>> env = JaxEnv("pointing", 1024)
>>> state, obs = env.reset(jax.random.key(1))
>>> state, out = env.step(state, jnp.zeros((1024, env.num_actions)))

What it is: XLA calls back to the host, where the library steps all environments at once.

What it costs: a round trip from XLA to Python and back per control step, and copies of the arrays. Measured under
`scan` on one core of a server processor, with `pointing-single`: 0.15 ms at 16 environments, where a step takes 0.14 ms
without; 0.2 to 0.5 ms at 1,024, where a step takes 3.3 ms. So use many environments.

What it is not:

- A pure function. The environments live on the host and have one present, so a state can be stepped once. Stepping an
  older one, or one from before a reset, raises an error; it never silently steps something else.
- Something to `vmap`: the batch is made by `num_envs`. `pmap` and sharding across hosts are not supported either.
- Differentiable: gradients do not pass through the callback.

`myoenv.brax.BraxEnv` has the interface of Brax on top.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.experimental import io_callback

from myoenv.tasks import TaskLike
from myoenv.vector import Backend, make_vec


class Pytree:
    """What all states share: they are changed by making new ones."""

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed."""
        return replace(self, **changes)  # type: ignore[type-var]


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class EnvState(Pytree):
    """Which present of the host's environments is meant: the data dependency that puts steps in their order."""

    #: Number of resets and steps so far, `()` int32.
    token: Array


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class Step(Pytree):
    """What a step returns; the first axis is `num_envs`."""

    #: Observations to act on, `(num_envs, num_obs)` float32; the first of the next episode where one ended.
    obs: Array
    #: Observations that the step led to, `(num_envs, num_obs)` float32; the last of the episode where one ended.
    next_obs: Array
    #: Rewards, `(num_envs,)` float32.
    reward: Array
    #: The task is done, `(num_envs,)` bool.
    terminated: Array
    #: The time is up, `(num_envs,)` bool.
    truncated: Array
    #: Summaries of episodes that ended, each `(num_envs,)` float32, zero where none did.
    summary: dict[str, Array]


class JaxEnv:
    """Copies of one task behind callbacks; finished ones are reset in the same step, to new targets."""

    def __init__(self, task: TaskLike, num_envs: int, backend: Backend = "auto", **options: Any) -> None:
        """Makes the environments; `options` are those of `make_vec`. Seeds come with the key of `reset`."""
        # XLA copies what a callback returns, so the environment need not.
        self._host = _Host(task, num_envs, backend, options)
        self.envs = self._host.envs
        self.num_envs = num_envs
        self.num_obs: int = self.envs.single_observation_space.shape[0]
        self.num_actions: int = self.envs.single_action_space.shape[0]
        f32, flag = jnp.float32, jnp.bool_
        obs, rows = self._like(f32, self.num_obs), self._like(f32)
        summary = {name: rows for name in self.envs.episode_names}
        self._reset_like = (EnvState(self._token), obs)
        self._step_like = (EnvState(self._token), Step(obs, obs, rows, self._like(flag), self._like(flag), summary))
        # Compiled even when called alone: without a compiler between, arrays of the host could be shared.
        self._reset, self._step = jax.jit(self._call_reset), jax.jit(self._call_step)

    def reset(self, key: Array) -> tuple[EnvState, Array]:
        """Starts new episodes everywhere: a state and the observations, `(num_envs, num_obs)`.

        `key` is one key, or `(num_envs,)` keys, one for each environment. Equal keys give equal episodes.
        """
        return self._reset(key)

    def step(self, state: EnvState, action: Array) -> tuple[EnvState, Step]:
        """One control step of `action`, `(num_envs, num_actions)` in [-1, 1]; values beyond are clipped."""
        return self._step(state, action)

    def close(self) -> None:
        """Frees the environments."""
        self.envs.close()

    def _call_reset(self, key: Array) -> tuple[EnvState, Array]:
        batched = key.ndim == (1 if jnp.issubdtype(key.dtype, jax.dtypes.prng_key) else 2)
        draw = lambda one: jax.random.bits(one, (2,), jnp.uint32)  # noqa: E731
        words = jax.vmap(draw)(key) if batched else draw(key)
        return io_callback(self._host.reset, self._reset_like, words)

    def _call_step(self, state: EnvState, action: Array) -> tuple[EnvState, Step]:
        return io_callback(self._host.step, self._step_like, state.token, action.astype(jnp.float32))

    @property
    def _token(self) -> jax.ShapeDtypeStruct:
        return jax.ShapeDtypeStruct((), jnp.int32)

    def _like(self, dtype: Any, *width: int) -> jax.ShapeDtypeStruct:
        return jax.ShapeDtypeStruct((self.num_envs, *width), dtype)


class _Host:
    """The other end of the callbacks: NumPy in, NumPy out."""

    def __init__(self, task: TaskLike, num_envs: int, backend: Backend, options: dict[str, Any]) -> None:
        self.envs = make_vec(task, num_envs, backend, autoreset="same_step", copy=False, **options)
        self.token = 0
        zeros = np.zeros(num_envs, np.float32)
        self.no_summary = {name: zeros for name in self.envs.episode_names}

    def reset(self, words: Any) -> tuple[EnvState, np.ndarray]:
        words = np.asarray(words).astype(np.uint64)
        seeds = words[..., 0] << np.uint64(32) | words[..., 1]
        obs, _ = self.envs.reset(seed=seeds.tolist())
        return self._next(), obs

    def step(self, token: Any, action: Any) -> tuple[EnvState, Step]:
        if int(token) != self.token:
            raise ValueError(
                f"this state is number {int(token)}, the environments are at {self.token}: "
                "a state can be stepped once, and not after a reset"
            )
        obs, reward, terminated, truncated, infos = self.envs.step(np.asarray(action))
        next_obs, summary = obs, self.no_summary
        if infos:
            next_obs, summary = obs.copy(), infos["final_info"]["summary"]
            for env in np.flatnonzero(infos["_final_obs"]):
                next_obs[env] = infos["final_obs"][env]
            summary = {name: summary[name] for name in self.envs.episode_names}
        return self._next(), Step(obs, next_obs, reward, terminated, truncated, summary)

    def _next(self) -> EnvState:
        self.token = (self.token + 1) % 2**31
        return EnvState(np.int32(self.token))
