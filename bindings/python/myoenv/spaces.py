"""What observations and actions can be."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium.spaces import Box
from numpy.typing import NDArray

from myoenv._native import Env


class ActionSpace(Box):
    """A `Box` of [-1, 1] that draws random actions ten times as fast: for thousands of environments, drawing takes a
    quarter of the time of a step otherwise."""

    def __init__(self, *shape: int) -> None:
        super().__init__(-1, 1, shape, np.float32)

    def sample(self, mask: None = None, probability: None = None) -> NDArray[np.float32]:
        """Actions drawn evenly from [-1, 1)."""
        if mask is not None or probability is not None:
            return super().sample(mask, probability)  # which says why not
        sample = self.np_random.random(self.shape, np.float32)
        sample *= 2
        sample -= 1
        return sample

    def __reduce__(self) -> Any:
        # A copy goes on with the same random numbers.
        return type(self), self.shape, self.__dict__


def spaces(env: Env) -> tuple[Box, ActionSpace]:
    """Observation and action space of one environment.

    Bounds hold for certain. Joint positions, velocities and accelerations have none, as joint limits are soft, nor
    have targets that a user misjudges (`perception.vision_noise`): theirs are the greatest finite numbers.
    """
    low, high = env.observation_bounds
    return Box(low, high, dtype=np.float32), ActionSpace(len(env.action_names))
