"""The interface of Brax and MuJoCo Playground over `myoenv.jax`: `reset(key) -> State`, `step(State, action) -> State`.

Brax itself is not needed. Four things differ from an environment of Brax, because the environments live on the host:

- It is a batch already. Do not wrap it in Brax's training wrappers: no `VmapWrapper`, no `AutoResetWrapper`. Finished
  episodes start anew with new targets, unlike with Brax's wrapper, which repeats the first state.
- `obs` is what to act on next. Where `done`, what the step led to is `info["next_obs"]`.
- A state can be stepped once; see `myoenv.jax`.
- There is no gradient through a step.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array

from myoenv.jax import EnvState, JaxEnv, Pytree
from myoenv.tasks import TaskLike
from myoenv.vector import Backend


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class State(Pytree):
    """State of a batch, with the fields of Brax's; the first axis is `num_envs`."""

    #: What only the environment needs.
    pipeline_state: EnvState
    #: Observations to act on, `(num_envs, observation_size)` float32.
    obs: Array
    #: Rewards of the last step, `(num_envs,)` float32.
    reward: Array
    #: 1 where the last step ended an episode, `(num_envs,)` float32.
    done: Array
    #: Summaries of the episodes that ended in the last step, each `(num_envs,)` float32, zero where none did.
    metrics: dict[str, Array]
    #: `truncation`, `(num_envs,)` float32: 1 where the time was up and the task not done. `next_obs`, like `obs`:
    #: what the last step led to.
    info: dict[str, Any]


class BraxEnv:
    """Copies of one task with the interface of `brax.envs.Env`, batched by `num_envs`."""

    def __init__(self, task: TaskLike, num_envs: int, backend: Backend = "auto", **options: Any) -> None:
        """Makes the environments; `options` are those of `make_vec`."""
        self._env = JaxEnv(task, num_envs, backend, **options)
        self.num_envs = num_envs
        self.envs = self._env.envs

    def reset(self, rng: Array, after: State | None = None) -> State:
        """Starts new episodes; `rng` is one key or `(num_envs,)` keys, `after` the state that the reset follows.

        A compiled program that steps and then resets needs `after`; see `myoenv.jax.JaxEnv.reset`.
        """
        pipeline_state, obs = self._env.reset(rng, None if after is None else after.pipeline_state)
        # Arrays of their own, so that a state can be donated.
        reward, done, truncation = (jnp.zeros(self.num_envs) for _ in range(3))
        metrics = {name: jnp.zeros(self.num_envs) for name in self.envs.episode_names}
        return State(pipeline_state, obs, reward, done, metrics, {"truncation": truncation, "next_obs": jnp.copy(obs)})

    def step(self, state: State, action: Array) -> State:
        """One control step of `action`, `(num_envs, action_size)` in [-1, 1]; what others put into `info` stays."""
        pipeline_state, out = self._env.step(state.pipeline_state, action)
        done = (out.terminated | out.truncated).astype(jnp.float32)
        truncation = (out.truncated & ~out.terminated).astype(jnp.float32)
        info = {**state.info, "truncation": truncation, "next_obs": out.next_obs}
        return State(pipeline_state, out.obs, out.reward, done, {**state.metrics, **out.summary}, info)

    def close(self) -> None:
        """Frees the environments."""
        self._env.close()

    @property
    def observation_size(self) -> int:
        """Entries of an observation."""
        return self._env.num_obs

    @property
    def action_size(self) -> int:
        """Entries of an action: muscles."""
        return self._env.num_actions

    @property
    def backend(self) -> str:
        """Where the environments are stepped: `cpu` or `gpu`."""
        return self.envs.backend

    @property
    def dt(self) -> float:
        """Seconds of a control step."""
        return self.envs.control_dt

    @property
    def unwrapped(self) -> BraxEnv:
        """Itself."""
        return self
