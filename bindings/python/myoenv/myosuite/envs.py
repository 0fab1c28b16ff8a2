"""MyoSuite's environments for Gymnasium, one alone and many side by side."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from myoenv._native import NeedsResetError
from myoenv.arguments import (
    as_actions,
    as_count,
    as_mapping,
    as_mask,
    as_num_envs,
    as_seed,
    as_text,
    as_threads,
    fresh_seed,
    spread_seeds,
)
from myoenv.myosuite.core import Core
from myoenv.vector import Autoreset, as_mode

#: An episode has succeeded that was solved in more control steps than these (MyoSuite's `evaluate_success`).
SOLVED_STEPS = 5


def make(env_id: str) -> MyoSuiteEnv:
    """Makes one environment; without a time limit, which `gymnasium.make("myosuite/...")` adds."""
    return MyoSuiteEnv(env_id)


def make_vec(env_id: str, num_envs: int = 1, **kwargs: Any) -> MyoSuiteVectorEnv:
    """Makes many environments side by side; arguments are those of `MyoSuiteVectorEnv`."""
    return MyoSuiteVectorEnv(env_id, num_envs, **kwargs)


class MyoSuiteEnv(gymnasium.Env):
    """One environment of MyoSuite.

    Actions are `(nmuscle,)` float32 in [-1, 1]: muscles are excited by `1 / (1 + exp(-5 (action - 0.5)))`.
    Observations are positions of joints, their rates times the control step, the error of a pose, or the tips and their
    errors, and activations, float32. `info` has what the reward is made of, and `solved`.
    """

    metadata = {"render_modes": []}  # noqa: RUF012

    def __init__(self, env_id: str) -> None:
        self._core = Core(as_text("env_id", env_id), 1, 1)
        self.task = self._core.task
        self.control_dt = self._core.control_dt
        self.observation_space, self.action_space = _spaces(self._core)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts a new episode and returns its first observation. A seed restarts the random stream."""
        for option in as_mapping("options", options):
            raise ValueError(f"unknown option {option!r}; there is none")
        super().reset(seed=None if seed is None else as_seed(seed))
        self._core.begin(np.zeros(1, np.int64), [self.np_random])
        return self._core.look()[0][0], {}

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One control step: observation, reward, terminated, truncated, info."""
        self._core.advance(as_actions(action, (self._core.nmuscle,))[np.newaxis])
        lost = self._core.mend()
        observation, reward, over, terms = self._core.look()
        info = {key: values[0] for key, values in terms.items()}
        return observation[0], float(reward[0]), bool(over[0] or lost[0]), False, info


class MyoSuiteVectorEnv(gymnasium.vector.VectorEnv):
    """Environments of MyoSuite side by side, on all threads.

    Infos of finished episodes: `summary`, a dictionary of arrays `return`, `length` and `success` (solved in more than
    five control steps, as MyoSuite counts), in `final_info` with same-step autoreset, where `episode` has `r` and `l`.

    An integer seed gives environment `i` the seed `seed + i`: it then draws what MyoSuite draws with that seed.

    Args:
        env_id: A name of `ids()`.
        num_envs: How many environments.
        seed: Seed of the first `reset`; without one it is drawn from the system.
        autoreset: What happens when an episode ends, as of `myoenv.make_vec`.
        threads: Threads of the processor; all of them by default.
        max_episode_steps: Control steps after which an episode is truncated; MyoSuite's number by default.
    """

    def __init__(
        self,
        env_id: str,
        num_envs: int = 1,
        *,
        seed: int | None = None,
        autoreset: Autoreset | AutoresetMode = "next_step",
        threads: int | None = None,
        max_episode_steps: int | None = None,
    ) -> None:
        self.num_envs = as_num_envs(num_envs)
        self._mode = as_mode(autoreset)
        self._core = Core(as_text("env_id", env_id), self.num_envs, as_threads(threads))
        self.task = self._core.task
        self.control_dt = self._core.control_dt
        limit = self.task["max_episode_steps"] if max_episode_steps is None else max_episode_steps
        self.max_episode_steps: int = as_count("max_episode_steps", limit)
        self.metadata = {"autoreset_mode": self._mode, "render_modes": [], "render_fps": round(1 / self.control_dt)}
        self.single_observation_space, self.single_action_space = _spaces(self._core)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        first = fresh_seed() if seed is None else as_seed(seed)
        self._rngs = [seeding.np_random(own)[0] for own in spread_seeds(first, self.num_envs)]
        self.episode_names = ["return", "length", "success"]
        self._steps = np.zeros(self.num_envs, np.int64)
        self._return = np.zeros(self.num_envs)
        self._solved = np.zeros(self.num_envs, np.int64)
        #: Episodes that the next step begins anew, or that wait for a reset.
        self._ended = np.ones(self.num_envs, np.bool_)

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts new episodes and returns the observations, `(num_envs, observation_size)`.

        Args:
            seed: A number, which gives environment `i` the seed `seed + i`, or a list with one for each; None goes on
                with the random streams.
            options: `{"reset_mask": mask}` resets only where the boolean array `(num_envs,)` is true.
        """
        options = as_mapping("options", options)
        mask = options.pop("reset_mask", None)
        if options:
            raise ValueError(f"unknown option {next(iter(options))!r}; the only one is 'reset_mask'")
        mask = np.ones(self.num_envs, np.bool_) if mask is None else as_mask(mask, self.num_envs)
        if seed is not None:
            if isinstance(seed, (int, np.integer)):
                super().reset(seed=int(seed))
            for env, own in enumerate(spread_seeds(seed, self.num_envs)):
                if own is not None and mask[env]:
                    self._rngs[env] = seeding.np_random(own)[0]
        self._begin(mask)
        return self._core.look()[0], {}

    def _begin(self, mask: NDArray[np.bool_]) -> None:
        (envs,) = np.nonzero(mask)
        if len(envs):
            self._core.begin(envs, self._rngs)
        self._steps[mask], self._return[mask], self._solved[mask], self._ended[mask] = 0, 0.0, 0, False

    def step(
        self, actions: Any
    ) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One control step: observations, rewards, terminations, truncations, infos.

        Args:
            actions: `(num_envs, nmuscle)`, float32 (other float types are converted), finite.

        Raises:
            NeedsResetError: Episodes ended before, or none has begun, and they do not begin by themselves.
        """
        actions = as_actions(actions, (self.num_envs, self._core.nmuscle))
        anew = self._ended.copy()
        if self._mode is not AutoresetMode.NEXT_STEP and anew.any():
            raise NeedsResetError(f"environment {np.argmax(anew)} has ended or not begun; reset it first")
        self._core.advance(actions)
        lost = self._core.mend()
        self._begin(anew)
        self._steps[~anew] += 1
        observation, reward, over, terms = self._core.look()
        reward[anew] = 0.0
        terminated = (over | lost) & ~anew
        truncated = (self._steps >= self.max_episode_steps) & ~anew
        self._ended = terminated | truncated
        self._return += reward
        self._solved += terms["solved"] & ~anew
        infos: dict[str, Any] = {}
        for key, values in terms.items():
            infos[key], infos[f"_{key}"] = values, ~anew
        if self._ended.any():
            infos |= {"summary": self._summary(), "_summary": self._ended.copy()}
        if self._mode is AutoresetMode.SAME_STEP and self._ended.any():
            infos = self._same_step(observation, infos)
            observation = self._core.look()[0]
        return observation, reward, terminated, truncated, infos

    def _summary(self) -> dict[str, Any]:
        """Of episodes that ended."""
        success = self._solved > SOLVED_STEPS
        columns = {"return": self._return, "length": self._steps, "success": success.astype(np.float64)}
        summary: dict[str, Any] = {}
        for name, values in columns.items():
            summary[name] = np.where(self._ended, values, 0)
            summary[f"_{name}"] = self._ended.copy()
        return summary

    def _same_step(self, observation: NDArray[np.float32], infos: dict[str, Any]) -> dict[str, Any]:
        """Begins anew what has ended; its last observations and infos go where Gymnasium has them."""
        ended = self._ended.copy()
        final_obs = np.full(self.num_envs, None, dtype=object)
        for env in np.nonzero(ended)[0]:
            final_obs[env] = observation[env]
        final_info, going_on = _masked(infos, ended), _masked(infos, ~ended)
        del going_on["summary"], going_on["_summary"]
        summary = final_info["summary"]
        statistics = {"r": summary["return"], "l": summary["length"], "_r": ended.copy(), "_l": ended.copy()}
        final_info |= {"episode": statistics, "_episode": ended.copy()}
        self._begin(ended)
        return {
            **going_on,
            "final_obs": final_obs,
            "_final_obs": ended,
            "final_info": final_info,
            "_final_info": ended.copy(),
        }


def _masked(infos: dict[str, Any], mask: NDArray[np.bool_]) -> dict[str, Any]:
    """The same of these environments alone."""
    return {key: mask.copy() if key.startswith("_") else values for key, values in infos.items()}


def _spaces(core: Core) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    size = core.look()[0].shape[1]
    observation = gymnasium.spaces.Box(-np.inf, np.inf, (size,), np.float32)
    return observation, gymnasium.spaces.Box(-1.0, 1.0, (core.nmuscle,), np.float32)
