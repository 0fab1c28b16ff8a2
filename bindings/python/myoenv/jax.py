"""Environments for JAX: `reset(key)` and `step(state, action)` that work under `jax.jit` and `jax.lax.scan`.

>>> from myoenv.jax import JaxEnv
>>> env = JaxEnv("pointing", 1024)
>>> state, obs = env.reset(jax.random.key(1))
>>> state, out = env.step(state, jnp.zeros((1024, env.num_actions)))

What it is: on the processor, a program of XLA steps all environments at once, without Python. Where JAX computes on a
graphics card, and with a jaxlib of another interface than 0.3, each step calls back to Python, and so does every reset.

What it costs: nearly nothing on the processor, a few tenths of a millisecond per call back; docs/performance.md has the
figures.

What it is not:

- A pure function. The environments live on the host and have one present, so a state can be stepped once. Stepping an
  older one, one from before a reset, or one of other environments raises an error; it never silently steps something
  else.
- Ordered by itself within a program that steps and then resets: tell the compiler with `reset(key, after=state)`.
- Something to `vmap`: the batch is made by `num_envs`. `pmap` and sharding across hosts are not supported either.
- Differentiable: there is no gradient through a step.

`myoenv.brax.BraxEnv` has the interface of Brax on top.
"""

from __future__ import annotations

import ctypes
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Self

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.experimental import io_callback
from numpy.typing import NDArray

from myoenv._native import ActionError, xla_step_handler
from myoenv.tasks import TaskLike
from myoenv.vector import Backend, make_vec


def _register() -> bool:
    """Whether this XLA takes steps without Python: it refuses handlers of an interface that it does not know."""
    try:
        handler = jax.ffi.pycapsule(ctypes.c_void_p(xla_step_handler()))
        jax.ffi.register_ffi_target("myoenv_step", handler, platform="cpu")
    except Exception:
        # Which one depends on the version, and any of them means the same.
        return False
    return True


#: Whether steps need no Python on the processor.
XLA_TAKES_STEPS = _register()


@dataclass(frozen=True)
class Pytree:
    """What all states share: they are changed by making new ones."""

    def replace(self, **changes: Any) -> Self:
        """A copy with some fields changed."""
        return replace(self, **changes)


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class EnvState(Pytree):
    """A token for the present state of the host's environments: the data dependency that keeps steps in order."""

    #: A number of the environments, and that of their resets and steps so far, `(2,)` int32.
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
    """Copies of one task; finished ones are reset in the same step, to new targets.

    Steps run in the background, as all of JAX: wait with `jax.block_until_ready` before you use `envs` directly.
    """

    def __init__(self, task: TaskLike, num_envs: int, backend: Backend = "auto", **options: Any) -> None:
        """Makes the environments; `options` are those of `make_vec`. Seeds come with the key of `reset`."""
        # XLA copies what a callback returns, so the environment need not.
        self._host = _Host(task, num_envs, backend, options)
        self.envs = self._host.envs
        self.num_envs = num_envs
        self.num_obs, self.num_actions = len(self.envs.observation_names), len(self.envs.action_names)
        f32, flag = jnp.float32, jnp.bool_
        obs, rows = self._like(f32, self.num_obs), self._like(f32)
        summary = {name: rows for name in self.envs.episode_names}
        # On a graphics card, steps are calls back to Python.
        self._in_xla = XLA_TAKES_STEPS and jax.default_backend() == "cpu"
        self._reset_like = (EnvState(self._token), obs)
        self._step_like = (EnvState(self._token), Step(obs, obs, rows, self._like(flag), self._like(flag), summary))
        # Compiled even when called alone: without a compiler between, arrays of the host could be shared.
        self._reset, self._step = jax.jit(self._call_reset), jax.jit(self._call_step)

    def reset(self, key: Array, after: EnvState | None = None) -> tuple[EnvState, Array]:
        """Starts new episodes everywhere: a state and the observations, `(num_envs, num_obs)`.

        Args:
            key: One key, or `(num_envs,)` keys, one for each environment. Equal keys give equal episodes.
            after: The state that the reset follows. A compiled program that steps and then resets needs it: nothing
                else tells the compiler which comes first, and steps that a reset overtakes raise an error.
        """
        if after is None and not isinstance(key, jax.core.Tracer):
            # The steps that were asked for come first. What failed among them is raised where it is used.
            with suppress(jax.errors.JaxRuntimeError):
                jax.effects_barrier()
        state, obs = self._reset(key, after)
        return state, obs

    def step(self, state: EnvState, action: Array) -> tuple[EnvState, Step]:
        """One control step of `action`, `(num_envs, num_actions)` in [-1, 1]; values beyond are clipped."""
        following, step = self._step(state, action)
        return following, step

    def close(self) -> None:
        """Frees the environments, after the steps that were asked for."""
        # What failed among them has been raised where it was used, or nobody wants to know.
        with suppress(jax.errors.JaxRuntimeError):
            jax.effects_barrier()
        self.envs.close()

    def _call_reset(self, key: Array, after: EnvState | None) -> tuple[EnvState, Array]:
        typed = jnp.issubdtype(key.dtype, jax.dtypes.prng_key)
        # Keys of the old kind are a few words each.
        shape = key.shape if typed else key.shape[:-1]
        if shape not in {(), (self.num_envs,)} or not (typed or key.dtype == jnp.uint32):
            raise ValueError(f"reset takes one key, or one for each of {self.num_envs} environments, not {key.aval}")
        batched = shape != ()
        words = jax.vmap(_words)(key) if batched else _words(key)
        token = () if after is None else (after.token,)
        state, obs = io_callback(self._host.reset, self._reset_like, words, *token, ordered=True)
        return state, obs

    def _call_step(self, state: EnvState, action: Array) -> tuple[EnvState, Step]:
        shape = (self.num_envs, self.num_actions)
        if action.shape != shape:
            raise ActionError(f"actions have the shape {action.shape}, expected {shape}")
        if not jnp.issubdtype(action.dtype, jnp.floating):
            raise ActionError(f"actions are of type {action.dtype}, expected float32")
        action = action.astype(jnp.float32)
        return self._xla_step(state.token, action) if self._in_xla else self._host_step(state.token, action)

    def _xla_step(self, token: Array, action: Array) -> tuple[EnvState, Step]:
        """Within XLA, without Python."""
        f32, flag = jnp.float32, jnp.bool_
        obs, rows, flags = self._like(f32, self.num_obs), self._like(f32), self._like(flag)
        names = self.envs.episode_names
        summary = jax.ShapeDtypeStruct((len(names), self.num_envs), f32)
        call = jax.ffi.ffi_call(
            "myoenv_step", (self._token, obs, obs, rows, flags, flags, summary), has_side_effect=True
        )
        token, *out, summary = call(token, action, env=np.int64(self.envs._env.xla_id()))
        obs, next_obs, reward, terminated, truncated = out
        by_name = dict(zip(names, summary, strict=True))
        return EnvState(token), Step(obs, next_obs, reward, terminated, truncated, by_name)

    def _host_step(self, token: Array, action: Array) -> tuple[EnvState, Step]:
        state, step = io_callback(self._host.step, self._step_like, token, action, ordered=True)
        return state, step

    @property
    def _token(self) -> jax.ShapeDtypeStruct:
        return jax.ShapeDtypeStruct((2,), jnp.int32)

    def _like(self, dtype: Any, *width: int) -> jax.ShapeDtypeStruct:
        return jax.ShapeDtypeStruct((self.num_envs, *width), dtype)


def _words(key: Array) -> Array:
    """Two random words, `(2,)` uint32: the halves of a seed."""
    return jax.random.bits(key, (2,), jnp.uint32)


class _Host:
    """The other end of the callbacks: NumPy in, NumPy out."""

    def __init__(self, task: TaskLike, num_envs: int, backend: Backend, options: dict[str, Any]) -> None:
        self.envs = make_vec(task, num_envs, backend, autoreset="same_step", copy=False, **options)
        zeros = np.zeros(num_envs, np.float32)
        self.no_summary = {name: zeros for name in self.envs.episode_names}

    def reset(self, words: Any, token: Any = None) -> tuple[EnvState, NDArray[np.float32]]:
        """Of `(2,)` or `(num_envs, 2)` random words of 32 bits, which make the seeds; after the state of `token`."""
        if token is not None:
            self.envs._env.check_token(np.asarray(token).tolist())
        words = np.asarray(words).astype(np.uint64)
        seeds = words[..., 0] << np.uint64(32) | words[..., 1]
        obs, _ = self.envs.reset(seed=seeds.tolist())
        return self._next(), obs

    def step(self, token: Any, action: Any) -> tuple[EnvState, Step]:
        """The same as the handler in XLA."""
        self.envs._env.check_token(np.asarray(token).tolist())
        obs, reward, terminated, truncated, infos = self.envs.step(np.asarray(action))
        next_obs, summary = obs, self.no_summary
        if infos:
            next_obs, summary = obs.copy(), infos["final_info"]["summary"]
            for env in np.flatnonzero(infos["_final_obs"]):
                next_obs[env] = infos["final_obs"][env]
            summary = {name: summary[name] for name in self.envs.episode_names}
        return self._next(), Step(obs, next_obs, reward, terminated, truncated, summary)

    def _next(self) -> EnvState:
        return EnvState(np.array(self.envs._env.token, np.int32))
