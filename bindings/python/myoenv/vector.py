"""Environments stepped side by side, as Gymnasium's `VectorEnv`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from myoenv._native import Env
from myoenv.arguments import (
    as_actions,
    as_device,
    as_index,
    as_mapping,
    as_mask,
    as_num_envs,
    as_picture_size,
    as_range,
    as_seed,
    as_text,
    as_threads,
    fresh_seed,
    spread_seeds,
)
from myoenv.peek import Peek
from myoenv.spaces import ActionSpace, spaces
from myoenv.tasks import ModelLike, TaskLike, layouts_and_model, task_and_model

Autoreset = Literal["next_step", "same_step", "disabled"]
Backend = Literal["auto", "cpu", "gpu"]

_MODES = {
    "next_step": AutoresetMode.NEXT_STEP,
    "same_step": AutoresetMode.SAME_STEP,
    "disabled": AutoresetMode.DISABLED,
}

RENDER_SIZE = (640, 480)


def make_vec(
    task: TaskLike | None = None,
    num_envs: int = 1,
    backend: Backend = "auto",
    *,
    layouts: Sequence[TaskLike] | None = None,
    seed: int | None = None,
    autoreset: Autoreset | AutoresetMode = "next_step",
    copy: bool = True,
    device: str | int | None = None,
    threads: int | None = None,
    model: ModelLike | None = None,
    render_mode: Literal["rgb_array"] | None = None,
    render_size: tuple[int, int] = RENDER_SIZE,
) -> MyoVectorEnv:
    """Makes `num_envs` environments of a task, or of several layouts.

    Args:
        task: A preset's name, a YAML or TOML file, a YAML text, a dictionary, or a `Task`.
        num_envs: How many environments.
        layouts: In place of `task` several of one structure, whose numbers alone differ, side by side: environment `i`
            does `layouts[i % len(layouts)]`. There must be as many environments as layouts at least.
        backend: `"cpu"`, `"gpu"`, or `"auto"`, which takes a graphics card where there are enough environments for it.
        seed: Seed of the first `reset`; without one it is drawn from the system.
        autoreset: What happens when an episode ends. `"next_step"`: the step after it ignores the action and returns
            the first observation of the next episode, reward 0. `"same_step"`: the step that ends it returns that
            observation, and the last one in `infos["final_obs"]`. `"disabled"`: reset with `options["reset_mask"]`.
        copy: Without copies, every call returns the same arrays with new contents. Actions may be computed in place of
            them.
        device: A graphics card by its number or a part of its name, see `myoenv.devices()`.
        threads: Threads of the processor; all of them by default, in one pool for all environments.
        model: Another body than the task's.
        render_mode: `"rgb_array"`, or none.
        render_size: Width and height of a picture in pixels.
    """
    return MyoVectorEnv(
        task,
        num_envs,
        backend,
        layouts=layouts,
        seed=seed,
        autoreset=autoreset,
        copy=copy,
        device=device,
        threads=threads,
        model=model,
        render_mode=render_mode,
        render_size=render_size,
    )


class MyoVectorEnv(gymnasium.vector.VectorEnv):
    """Copies of one task, or of several layouts by turns.

    Made by `make_vec` or `gymnasium.make_vec("myo/Pointing-v0", num_envs=...)`.

    Actions are `(num_envs, nmuscle)` float32 in [-1, 1], -1 relaxes a muscle and 1 excites it fully; values beyond are
    clipped. Observations are `(num_envs, observation_size)` float32, rewards float32, flags bool, each `(num_envs,)`.
    `observation_names` and `action_names` say what the entries are.

    An integer seed gives environment `i` the seed `seed + i`: it then draws what `gymnasium.make` draws with that seed.

    Infos of finished episodes: `summary`, a dictionary of arrays with the names of `episode_names` (in `final_info`
    with same-step autoreset, where `episode` has `r` and `l`, too).
    """

    def __init__(
        self,
        task: TaskLike | None = None,
        num_envs: int = 1,
        backend: Backend = "auto",
        *,
        layouts: Sequence[TaskLike] | None = None,
        seed: int | None = None,
        autoreset: Autoreset | AutoresetMode = "next_step",
        copy: bool = True,
        device: str | int | None = None,
        threads: int | None = None,
        model: ModelLike | None = None,
        render_mode: Literal["rgb_array"] | None = None,
        render_size: tuple[int, int] = RENDER_SIZE,
    ) -> None:
        self.closed = True  # until it is open: a constructor that fails leaves nothing to close
        mode = as_mode(autoreset)
        self.layouts, self.model = layouts_and_model(task, layouts, model)
        self.task = self.layouts[0]
        self.render_mode = check_render_mode(render_mode)
        self.render_size = as_picture_size(render_size)
        self.num_envs = as_num_envs(num_envs)
        self._first_seed = None if seed is None else as_seed(seed)
        self._env = Env(
            self.layouts,
            self.model,
            self.num_envs,
            seed=fresh_seed(),
            autoreset=next(word for word, value in _MODES.items() if value is mode),
            backend=as_text("backend", backend),
            device=as_device(device),
            threads=as_threads(threads),
            copy=bool(copy),
        )
        self.closed = False
        self._same_step = mode is AutoresetMode.SAME_STEP
        self._set_attributes(mode)

    def _set_attributes(self, mode: AutoresetMode) -> None:
        env = self._env
        self.observation_names: list[str] = env.observation_names
        self.action_names: list[str] = env.action_names
        self.episode_names: list[str] = env.episode_names
        self.max_episode_steps: int = env.max_episode_steps
        self.control_dt: float = env.control_dt
        self.backend: str = env.backend
        self.device: str | None = env.device
        self.metadata = {
            "autoreset_mode": mode,
            "render_modes": ["rgb_array"],
            "render_fps": round(1 / self.control_dt),
        }
        self.single_observation_space, self.single_action_space = spaces(env)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._action_shape = (self.num_envs, len(self.action_names))
        self.action_space = ActionSpace(*self._action_shape)

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts new episodes and returns the observations, `(num_envs, observation_size)`.

        Args:
            seed: A number, which gives environment `i` the seed `seed + i`, or a list with one for each; None goes on
                with the random stream.
            options: `{"reset_mask": mask}` resets only where the boolean array `(num_envs,)` is true. Observations of
                the others are their current ones.
        """
        options = as_mapping("options", options)
        mask = options.pop("reset_mask", None)
        if options:
            raise ValueError(f"unknown option {next(iter(options))!r}; the only one is 'reset_mask'")
        if mask is not None:
            mask = as_mask(mask, self.num_envs)
        if seed is None:
            seed, self._first_seed = self._first_seed, None
        if seed is None:
            return self._env.reset(None, None, mask), {}
        seeds = spread_seeds(seed, self.num_envs)
        self._first_seed = None
        if isinstance(seed, (int, np.integer)):
            super().reset(seed=int(seed))
        seeded = np.array([one is not None for one in seeds])
        known = [one or 0 for one in seeds]
        if seeded.all():
            return self._env.reset(None, known, mask), {}
        # Environments without a seed go on with their streams.
        mask = np.ones(self.num_envs, np.bool_) if mask is None else mask
        observation = self._env.reset(None, None, mask)
        if (mask & seeded).any():
            observation = self._env.reset(None, known, mask & seeded)
        return observation, {}

    def step(
        self, actions: Any
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """One control step: observations, rewards, terminations, truncations, infos.

        Args:
            actions: `(num_envs, nmuscle)`, float32 (other float types are converted), finite.
        """
        observation, reward, terminated, truncated, ended = self._env.step(as_actions(actions, self._action_shape))
        infos = {} if ended is None else self._infos(*ended)
        return observation, reward, terminated, truncated, infos

    def _infos(
        self, envs: NDArray[np.int64], final_observation: NDArray[np.float32], episodes: NDArray[np.float32]
    ) -> dict[str, Any]:
        """Infos in Gymnasium's format: every `key` has a mask `_key`."""
        mask = np.zeros(self.num_envs, np.bool_)
        mask[envs] = True
        summary = self._columns(dict(zip(self.episode_names, episodes.T, strict=True)), envs, mask)
        if not self._same_step:
            return {"summary": summary, "_summary": mask}
        final_obs = np.full(self.num_envs, None, dtype=object)
        for row, env in enumerate(envs):
            final_obs[env] = final_observation[row]
        statistics = self._columns({"r": episodes[:, 0], "l": episodes[:, 1].astype(np.int64)}, envs, mask)
        final_info = {"episode": statistics, "_episode": mask.copy(), "summary": summary, "_summary": mask.copy()}
        return {
            "final_obs": final_obs,
            "_final_obs": mask,
            "final_info": final_info,
            "_final_info": mask.copy(),
        }

    def _columns(
        self, columns: dict[str, NDArray[Any]], envs: NDArray[np.int64], mask: NDArray[np.bool_]
    ) -> dict[str, NDArray[Any]]:
        out: dict[str, NDArray[Any]] = {}
        for name, values in columns.items():
            out[name] = np.zeros(self.num_envs, values.dtype)
            out[name][envs] = values
            out[f"_{name}"] = mask.copy()
        return out

    def peek(self, start: int = 0, stop: int | None = None) -> Peek:
        """What can be seen of the environments from `start` up to `stop`, of all by default; nothing changes.

        Only these environments are copied, from a graphics card, too: a look at one of many costs little.

        >>> import myoenv
        >>> envs = myoenv.make_vec("pointing", 1024, seed=1)
        >>> seen = envs.peek(3, 5)
        >>> seen.fingertip.shape, seen.object_names[seen.current_object[0]]
        ((2, 3), 'target 1 (pointing)')

        Raises:
            ValueError: There are no such environments.
        """
        return Peek(**self._env.peek(*as_range(start, stop, self.num_envs)))

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture of every environment, `(height, width, 3)` uint8 each; none without a render mode."""
        if self.render_mode is None:
            return None
        return tuple(self._env.render(0, self.num_envs, as_picture_size(self.render_size)))

    def render_env(self, env: int) -> NDArray[np.uint8]:
        """A picture of one environment, `(height, width, 3)` uint8, whatever the render mode."""
        env = as_index("env", env, self.num_envs)
        return self._env.render(env, env + 1, as_picture_size(self.render_size))[0]

    def save_state(self) -> bytes:
        """Everything that the next steps depend on."""
        return self._env.save_state()

    def load_state(self, state: bytes) -> None:
        """Goes back to what `save_state` returned, in this or an equal environment, bit for bit."""
        if not isinstance(state, bytes):
            raise TypeError(f"a state is what save_state returned, bytes, not {type(state).__name__}")
        self._env.load_state(state)

    def set_task(self, task: TaskLike) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Goes on with another task of the same structure, such as a layout to try. Nothing is compiled.
        All environments do it, whatever layouts they did.

        Positions, sizes, dwell, force, the reward's weights, noise, reflexes, fatigue, how episodes begin and the time
        limit may differ; the number and kinds of targets, what is observed, whether fatigue lasts and the control step
        may not. All episodes begin anew.
        `observation_space` and `max_episode_steps` are those of the new task.

        Returns:
            What `reset` returns.

        Raises:
            ValueError: The structure differs, or the body cannot do the task; everything is as before.
        """
        other, _ = task_and_model(task, self.model)
        self._env.set_task(other)
        self.task, self.layouts = other, [other]
        self.max_episode_steps = self._env.max_episode_steps
        self.single_observation_space, _ = spaces(self._env)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        return self.reset()

    def close_extras(self, **kwargs: Any) -> None:
        """Frees the environments; Gymnasium's `close` calls it."""
        self._env.close()


def check_render_mode(render_mode: str | None) -> Literal["rgb_array"] | None:
    """Refuses render modes that do not exist."""
    if render_mode is None:
        return None
    if render_mode == "rgb_array":
        return "rgb_array"
    raise ValueError(f'render_mode is {render_mode!r}; it must be "rgb_array" or None')


def as_mode(autoreset: Autoreset | AutoresetMode) -> AutoresetMode:
    """What happens when an episode ends, by its name."""
    if isinstance(autoreset, AutoresetMode):
        return autoreset
    if isinstance(autoreset, str) and autoreset in _MODES:
        return _MODES[autoreset]
    raise ValueError(f"autoreset is {autoreset!r}; it must be one of {', '.join(map(repr, _MODES))}")
