"""Trained policies."""

from __future__ import annotations

import math
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv import _native
from myoenv.arguments import as_path


class Policy:
    """A trained policy: `policy(observations)` is the mean action, in [-1, 1].

    >>> policy = Policy.load("runs/pointing-1")  # doctest: +SKIP
    >>> actions = policy(observations)  # doctest: +SKIP
    """

    def __init__(self, native: _native.Policy) -> None:
        if not isinstance(native, _native.Policy):
            raise TypeError(f"a policy is made by Policy.load or train, not of a {type(native).__name__}")
        self._native = native

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Policy:
        """The policy of a run folder's newest checkpoint that is whole, or of a checkpoint file."""
        return cls(_native.Policy.load(as_path("path", path)))

    @property
    def observation_names(self) -> list[str]:
        """Names of the observations that it was trained on, in order."""
        return self._native.observation_names

    @property
    def action_names(self) -> list[str]:
        """Names of the actions, in order."""
        return self._native.action_names

    def __call__(self, observation: Any) -> NDArray[np.float32]:
        """Mean actions `(..., nmuscle)` for observations `(..., observation_size)`."""
        try:
            observation = np.asarray(observation)
        except Exception as error:
            raise ValueError(f"the observation cannot be made an array: {error}") from None
        if observation.dtype.kind not in "fiu" or observation.ndim == 0:
            raise ValueError(
                f"an observation is an array of numbers, not of shape {observation.shape}, type {observation.dtype}"
            )
        *batch, width = observation.shape
        with np.errstate(over="ignore"):
            # What is too large for float32 becomes infinite, and is refused as such.
            rows = np.ascontiguousarray(observation, np.float32).reshape(math.prod(batch), width)
        if not np.isfinite(rows).all():
            raise ValueError("the observation has an entry that is not finite")
        return self._native.act(rows).reshape(*batch, len(self.action_names))
