"""Shared by all tests."""

from collections.abc import Callable

import numpy as np
import pytest

import myoenv

MODES = ["next_step", "same_step", "disabled"]


@pytest.fixture
def make() -> Callable[..., myoenv.MyoVectorEnv]:
    """Makes environments on the processor that are closed after the test."""
    made = []

    def build(task="pointing-single", num_envs=8, **kwargs):
        made.append(myoenv.make_vec(task, num_envs, "cpu", **kwargs))
        return made[-1]

    yield build
    for env in made:
        env.close()


@pytest.fixture
def short_task() -> dict:
    """A task whose episodes end soon, one way or the other."""
    anywhere = {"x": 0.3, "y": [-0.1, 0.1], "z": [-0.3, -0.1]}
    return {
        "version": 1,
        "name": "short",
        "time_limit_s": 0.4,
        "targets": [{"kind": "pointing", "position": anywhere, "radius": 0.3, "dwell_s": 0.05}],
    }


def relaxed(env) -> np.ndarray:
    """Actions that relax all muscles."""
    return np.full(env.action_space.shape, -1, np.float32)
