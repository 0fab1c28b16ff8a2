"""Muscle paths over spheres and cylinders: a body with every kind of them, in random states and where paths begin to bend,
by the rule of sides of this MuJoCo."""

import mujoco
import numpy as np
import pytest
from simulation import forward, relative_error

# Where a path through a round thing touches it, MuJoCo's iteration leaves up to 1e-6 rad; the length is stationary there.
THROUGH = {"through_elbow", "flexor", "wrist_through_ball"}


class Pair:
    """Myo's state and MuJoCo's data."""

    def __init__(self, model, step):
        self.step, data = step, forward(model, step)
        self.length, self.velocity = data.ten_length.copy(), data.ten_velocity.copy()
        self.force, self.qacc = data.actuator_force.copy(), data.qacc.copy()
        self.moments = np.zeros((model.nu, model.nv))
        sparse = data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
        mujoco.mju_sparse2dense(self.moments, *sparse)
        self.bends = sum(data.ten_wrapnum) - model.ntendon
        names = [model.tendon(index).name for index in range(model.ntendon)]
        self.through = np.array([name in THROUGH for name in names])


@pytest.fixture(scope="module")
def pairs(wraps, wrap_states):
    return [Pair(wraps, step) for step in wrap_states]


@pytest.fixture(scope="module")
def random(pairs):
    return [pair for pair in pairs if pair.step["onset"] is None]


@pytest.fixture(scope="module")
def onsets(pairs):
    return [pair for pair in pairs if pair.step["onset"] is not None]


def worst(pairs, quantity, wanted, through):
    """Greatest difference over the muscles that go through something, or over the others."""

    def error(pair):
        difference = np.abs(getattr(pair, wanted) - np.array(pair.step[quantity]))
        difference = difference.reshape(len(pair.through), -1).max(axis=1)
        return difference[pair.through == through].max()

    return max(map(error, pairs))


def test_there_are_enough_states(random, onsets):
    assert len(random) == 1000
    bends = np.mean([pair.step["bends"] for pair in random], axis=0)
    assert len(bends) == 19
    assert ((bends > 0.0) & (bends < 1.0)).all(), "every stretch must bend in some states and not in others"
    assert len(onsets) > 2000
    assert len({pair.step["onset"] for pair in onsets}) >= 15, "of nearly every stretch"


@pytest.mark.parametrize("through", [False, True])
def test_lengths(random, onsets, through):
    for pairs in random, onsets:
        assert worst(pairs, "tendon_length", "length", through) < 1e-12


@pytest.mark.parametrize(("through", "bound"), [(False, 1e-10), (True, 1e-7)])
def test_velocities_and_moment_arms(random, onsets, through, bound):
    for pairs in random, onsets:
        assert worst(pairs, "tendon_velocity", "velocity", through) < bound
        assert worst(pairs, "moments", "moments", through) < bound


def test_forces_and_accelerations(pairs):
    assert max(relative_error(pair.step["muscle_force"], pair.force, 1.0) for pair in pairs) < 1e-6
    assert max(relative_error(pair.step["qacc"], pair.qacc) for pair in pairs) < 1e-6
