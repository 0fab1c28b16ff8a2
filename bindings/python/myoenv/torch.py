"""Environments for PyTorch: tensors in, tensors out, without copies where the processor does both.

>>> from myoenv.torch import TorchVectorEnv
>>> envs = TorchVectorEnv(myoenv.make_vec("pointing", 1024, autoreset="same_step"))
>>> obs, infos = envs.reset(seed=1)
>>> obs, reward, terminated, truncated, infos = envs.step(torch.zeros(1024, envs.num_actions))

On the processor a tensor shares its memory with the array that the environment wrote, and actions are read where they
are. On another device every tensor is copied there once. `myoenv.rsl_rl` builds on this; skrl, which takes
Gymnasium's vector environments, needs only `skrl.envs.wrappers.torch.wrap_env(myoenv.make_vec(...))`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray
from torch import Tensor

from myoenv._native import ActionError
from myoenv.vector import MyoVectorEnv

Infos = dict[str, Any]


class TorchVectorEnv:
    """The tensor side of a vector environment.

    Observations are `(num_envs, num_obs)` float32, rewards `(num_envs,)` float32, flags `(num_envs,)` bool. Whether a
    tensor outlives the next call is decided by `copy` of the environment: with `copy=False` all calls write the same
    tensors.
    """

    def __init__(self, envs: MyoVectorEnv, device: torch.device | str = "cpu") -> None:
        """Wraps `envs`; tensors live on `device`."""
        if not isinstance(envs, MyoVectorEnv):
            raise TypeError(f"envs is a {type(envs).__name__}; it must be what myoenv.make_vec returns")
        self.envs = envs
        self.device = torch.device(device)
        self.num_envs: int = envs.num_envs
        self.num_obs, self.num_actions = len(envs.observation_names), len(envs.action_names)
        self._same_step = envs.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP

    def reset(self, *, seed: int | list[int] | None = None, mask: Tensor | None = None) -> tuple[Tensor, Infos]:
        """Starts new episodes, where `mask`, `(num_envs,)` bool, is true if there is one; returns the observations."""
        options = None if mask is None else {"reset_mask": _tensor("mask", mask).cpu().numpy()}
        obs, infos = self.envs.reset(seed=seed, options=options)
        return self._tensor(obs), infos

    def step(self, actions: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor, Infos]:
        """One control step of `actions`, `(num_envs, num_actions)`: observations, rewards, two flags, infos.

        With same-step autoreset and an episode that ended, infos get `ended`, `(k,)` int64, the environments where
        one did, and `final_obs` becomes their last observations, `(k, num_obs)`.
        """
        if not _tensor("actions", actions).is_floating_point():
            raise ActionError(f"actions are of type {actions.dtype}, expected torch.float32")
        obs, reward, terminated, truncated, infos = self.envs.step(actions.detach().to("cpu", torch.float32).numpy())
        if self._same_step and "final_obs" in infos:
            ended = np.flatnonzero(infos["_final_obs"])
            final_obs = np.stack([infos["final_obs"][env] for env in ended])
            infos = {**infos, "ended": self._tensor(ended), "final_obs": self._tensor(final_obs)}
        return self._tensor(obs), self._tensor(reward), self._tensor(terminated), self._tensor(truncated), infos

    def close(self) -> None:
        """Frees the environments."""
        self.envs.close()

    def _tensor(self, array: NDArray[Any]) -> Tensor:
        return torch.from_numpy(array).to(self.device)


def _tensor(name: str, value: Any) -> Tensor:
    if not isinstance(value, Tensor):
        raise TypeError(f"{name} is a {type(value).__name__}; it must be a tensor")
    return value
