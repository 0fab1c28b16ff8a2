"""One environment, as Gymnasium's `Env`."""

from __future__ import annotations

from typing import Any, Literal

import gymnasium
import numpy as np
from numpy.typing import NDArray

from myoenv._native import Env
from myoenv.arguments import as_actions, as_device, as_mapping, as_picture_size, as_seed, as_text, fresh_seed
from myoenv.spaces import spaces
from myoenv.tasks import ModelLike, TaskLike, task_and_model
from myoenv.vector import RENDER_SIZE, Backend, check_render_mode


def make(task: TaskLike, **kwargs: Any) -> MyoEnv:
    """Makes one environment of a task; arguments are those of `MyoEnv`."""
    return MyoEnv(task, **kwargs)


class MyoEnv(gymnasium.Env):
    """One environment; made by `make` or `gymnasium.make("myo/Pointing-v0")`.

    Actions are `(nmuscle,)` float32 in [-1, 1], observations `(observation_size,)` float32. `info["summary"]` describes
    an episode that ended. Time limits are the task's own: `truncated` tells of them.
    """

    # Gymnasium asks the class; a class variable by its type could not be changed for a task with another frame rate.
    metadata = {"render_modes": ["rgb_array"], "render_fps": 20}  # noqa: RUF012

    def __init__(
        self,
        task: TaskLike,
        *,
        model: ModelLike | None = None,
        backend: Backend = "cpu",
        device: str | int | None = None,
        render_mode: Literal["rgb_array"] | None = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        self.task, self.model = task_and_model(task, model)
        self.render_mode = check_render_mode(render_mode)
        self.render_size = as_picture_size(render_size)
        self._env = Env(
            [self.task],
            self.model,
            1,
            seed=fresh_seed(),
            autoreset="disabled",
            backend=as_text("backend", backend),
            device=as_device(device),
            threads=1,
            copy=True,
        )
        self.observation_names: list[str] = self._env.observation_names
        self.action_names: list[str] = self._env.action_names
        self.episode_names: list[str] = self._env.episode_names
        self.max_episode_steps: int = self._env.max_episode_steps
        self.control_dt: float = self._env.control_dt
        self.metadata = {**self.metadata, "render_fps": round(1 / self.control_dt)}
        self.observation_space, self.action_space = spaces(self._env)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts a new episode and returns its first observation. A seed restarts the random stream."""
        for option in as_mapping("options", options):
            raise ValueError(f"unknown option {option!r}; there is none")
        if seed is not None:
            seed = as_seed(seed)
            super().reset(seed=seed)
        return self._env.reset(seed, None, None)[0], {}

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One control step: observation, reward, terminated, truncated, info."""
        actions = as_actions(action, (len(self.action_names),))
        observation, reward, terminated, truncated, ended = self._env.step(actions[np.newaxis])
        info: dict[str, Any] = {}
        if ended is not None:
            info["summary"] = dict(zip(self.episode_names, ended[2][0].tolist(), strict=True))
        return observation[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), info

    def render(self) -> NDArray[np.uint8] | None:
        """A picture, `(height, width, 3)` uint8; none without a render mode."""
        return None if self.render_mode is None else self._env.render(0, 1, as_picture_size(self.render_size))[0]

    def close(self) -> None:
        """Frees the environment; a second time does nothing."""
        if hasattr(self, "_env"):
            self._env.close()
