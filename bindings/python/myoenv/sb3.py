"""Environments for Stable-Baselines3, as its own `VecEnv`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv

from myoenv.arguments import as_seed
from myoenv.myosuite import MyoSuiteVectorEnv
from myoenv.tasks import ModelLike, TaskLike
from myoenv.vector import RENDER_SIZE, Backend, MyoVectorEnv, make_vec

Indices = None | int | Sequence[int]


class _VecEnv(VecEnv):
    """What Stable-Baselines3 asks of environments of ours, which begin anew in the step that ends them."""

    def __init__(self, envs: MyoVectorEnv | MyoSuiteVectorEnv) -> None:
        self.envs = envs
        self._actions: Any = None
        self._empty: list[dict[str, Any]] = [{} for _ in range(envs.num_envs)]
        super().__init__(envs.num_envs, envs.single_observation_space, envs.single_action_space)

    def reset(self) -> NDArray[np.float32]:
        """Starts new episodes everywhere and returns the observations, `(num_envs, observation_size)`."""
        options = next((one for one in self._options if one), None)
        seeds = None if all(seed is None for seed in self._seeds) else self._seeds
        # Once for all, as with a good one: a bad option must not stand in the way of every reset that follows.
        self._reset_options()
        observation, _ = self.envs.reset(seed=seeds, options=options)
        self._reset_seeds()
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return observation

    def seed(self, seed: int | None = None) -> list[int | None]:
        """Seeds of the next `reset`: `seed + i` for environment `i`."""
        seeds: list[int | None] = super().seed(None if seed is None else as_seed(seed))
        return seeds

    def step_async(self, actions: NDArray[np.float32]) -> None:
        """Takes the actions, `(num_envs, nmuscle)`, of the next `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """One control step: observations, rewards, dones, infos."""
        observation, reward, terminated, truncated, infos = self.envs.step(self._actions)
        if "final_obs" not in infos:
            return observation, reward.astype(np.float32, copy=False), terminated | truncated, self._empty.copy()
        told = self._infos(terminated, truncated, infos)
        return observation, reward.astype(np.float32, copy=False), terminated | truncated, told

    def _infos(
        self, terminated: NDArray[np.bool_], truncated: NDArray[np.bool_], infos: dict[str, Any]
    ) -> list[dict[str, Any]]:
        out = self._empty.copy()
        final, summary = infos["final_obs"], infos["final_info"]["summary"]
        names = self.envs.episode_names
        for env in np.flatnonzero(infos["_final_obs"]):
            row = {name: float(summary[name][env]) for name in names}
            out[env] = {
                "terminal_observation": final[env],
                "TimeLimit.truncated": bool(truncated[env] and not terminated[env]),
                "episode": {"r": row["return"], "l": int(row["length"])},
                "is_success": row["success"] > 0.5,
                "summary": row,
            }
        return out

    def close(self) -> None:
        """Frees the environments."""
        self.envs.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A picture of every environment."""
        frames: Any = self.envs.render() if self.envs.render_mode else None
        return [None] * self.num_envs if frames is None else frames

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """An attribute, which all environments share."""
        value = getattr(self.envs, attr_name)
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Sets an attribute of all environments; one environment has none of its own."""
        if len(list(self._get_indices(indices))) != self.num_envs:
            raise ValueError(f"{attr_name} can only be set for all environments at once")
        setattr(self.envs, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Calls a method of the environments once; the answer holds for each."""
        value = getattr(self.envs, method_name)(*method_args, **method_kwargs)
        return [value for _ in self._get_indices(indices)]

    def env_is_wrapped(self, wrapper_class: type[Any], indices: Indices = None) -> list[bool]:
        """Whether it is wrapped: never, but episode statistics are there as a `Monitor` would give them."""
        from stable_baselines3.common.monitor import Monitor

        return [wrapper_class is Monitor for _ in self._get_indices(indices)]


class MyoVecEnv(_VecEnv):
    """Copies of one task for Stable-Baselines3: `PPO("MlpPolicy", MyoVecEnv("pointing-single", 256))`.

    A finished environment is reset in the same step; its info has `terminal_observation`, `TimeLimit.truncated`,
    `episode` with `r` and `l` (no `Monitor` needed), `is_success`, and `summary`. The infos of all others are empty and
    used again in the next step, so nothing must be written into them.
    """

    def __init__(
        self,
        task: TaskLike,
        num_envs: int,
        backend: Backend = "auto",
        *,
        seed: int | None = None,
        device: str | int | None = None,
        threads: int | None = None,
        model: ModelLike | None = None,
        render_mode: Literal["rgb_array"] | None = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        super().__init__(
            make_vec(
                task,
                num_envs,
                backend,
                seed=seed,
                autoreset="same_step",
                device=device,
                threads=threads,
                model=model,
                render_mode=render_mode,
                render_size=render_size,
            )
        )


class MyoSuiteVecEnv(_VecEnv):
    """Copies of one of MyoSuite's environments: `PPO("MlpPolicy", MyoSuiteVecEnv("myoHandPoseRandom-v0", 64))`.

    Infos are as those of `MyoVecEnv`; `summary` has `return`, `length` and `success`.
    """

    def __init__(self, env_id: str, num_envs: int, *, seed: int | None = None, threads: int | None = None) -> None:
        super().__init__(MyoSuiteVectorEnv(env_id, num_envs, seed=seed, autoreset="same_step", threads=threads))
