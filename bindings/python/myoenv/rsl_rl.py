"""Environments for rsl_rl: `OnPolicyRunner(RslRlVecEnv("pointing", 1024), config).learn(100)`.

Written against rsl-rl-lib 5, whose observations are a `TensorDict` of groups; there is one group, `policy`.
"""

from __future__ import annotations

from typing import Any

import torch
from rsl_rl.env import VecEnv
from tensordict import TensorDict
from torch import Tensor

from myoenv.tasks import TaskLike
from myoenv.torch import TorchVectorEnv
from myoenv.vector import Backend, make_vec


class RslRlVecEnv(VecEnv):
    """Copies of one task as rsl_rl's `VecEnv`.

    A finished environment is reset in the same step. `extras["time_outs"]` is true where the time was up and the task
    not done; there rsl_rl adds the value of what could still have come. `extras["log"]` has the mean summary of the
    episodes that ended in this step, and their last observations are `extras["final_obs"]`, those of the environments
    `extras["ended"]`.
    """

    def __init__(
        self,
        task: TaskLike,
        num_envs: int,
        backend: Backend = "auto",
        *,
        seed: int | None = None,
        tensor_device: torch.device | str = "cpu",
        **options: Any,
    ) -> None:
        """Makes the environments; tensors live on `tensor_device`, other `options` are those of `make_vec`."""
        self.envs = make_vec(task, num_envs, backend, seed=seed, autoreset="same_step", **options)
        self._tensors = TorchVectorEnv(self.envs, tensor_device)
        self.num_envs = num_envs
        self.num_actions = self._tensors.num_actions
        self.max_episode_length = self.envs.max_episode_steps
        self.device = self._tensors.device
        self.cfg = {"task": self.envs.task.name, "num_envs": num_envs, "backend": self.envs.backend}
        self._episode_length = torch.zeros(num_envs, dtype=torch.long, device=self.device)
        self._obs, _ = self._tensors.reset()

    def get_observations(self) -> TensorDict:
        """The current observations: the group `policy`, `(num_envs, num_obs)`."""
        return TensorDict({"policy": self._obs}, batch_size=[self.num_envs], device=self.device)

    def reset(self, *, seed: int | None = None) -> tuple[TensorDict, dict[str, Any]]:
        """Starts new episodes everywhere; rsl_rl itself never calls it."""
        self._obs, _ = self._tensors.reset(seed=seed)
        self._episode_length = torch.zeros_like(self._episode_length)
        return self.get_observations(), {}

    def step(self, actions: Tensor) -> tuple[TensorDict, Tensor, Tensor, dict[str, Any]]:
        """One control step: observations, rewards `(num_envs,)`, dones `(num_envs,)` int64, extras."""
        self._obs, reward, terminated, truncated, infos = self._tensors.step(actions)
        done = terminated | truncated
        self._episode_length = torch.where(done, 0, self._episode_length + 1)
        extras: dict[str, Any] = {"time_outs": truncated & ~terminated}
        if "ended" in infos:
            extras |= {"ended": infos["ended"], "final_obs": infos["final_obs"], "log": self._log(infos)}
        return self.get_observations(), reward, done.long(), extras

    @property
    def episode_length_buf(self) -> Tensor:
        """Control steps since each environment's last reset, `(num_envs,)` int64."""
        return self._episode_length

    @episode_length_buf.setter
    def episode_length_buf(self, value: Tensor) -> None:
        raise ValueError("an episode cannot begin in its middle; call learn with init_at_random_ep_len=False")

    def close(self) -> None:
        """Frees the environments."""
        self.envs.close()

    def _log(self, infos: dict[str, Any]) -> dict[str, float]:
        """Mean summary of the episodes that just ended."""
        summary = infos["final_info"]["summary"]
        ended = infos["_final_obs"]
        return {f"/episode/{name}": float(summary[name][ended].mean()) for name in self.envs.episode_names[:6]}
