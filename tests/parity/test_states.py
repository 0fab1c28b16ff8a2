"""One thousand random states: every quantity of one evaluation against MuJoCo's."""

import numpy as np
import pytest
from simulation import forward, relative_error


@pytest.fixture(scope="module")
def pairs(arm, states):
    """Myo's state and MuJoCo's data of the same state."""
    return [(state, forward(arm, state)) for state in states]


def worst(pairs, error):
    return max(error(state, data) for state, data in pairs)


def test_there_are_a_thousand_varied_states(arm, states):
    assert len(states) == 1000
    qpos = np.array([state["qpos"] for state in states])
    assert qpos.shape == (1000, arm.nq)
    limited = arm.jnt_limited.astype(bool)
    low, high = arm.jnt_range[limited].T
    outside = (qpos[:, limited] < low) | (qpos[:, limited] > high)
    assert 0 < outside.any(axis=1).mean() < 1, "some states must violate a limit, and some must not"
    assert np.std([state["qvel"] for state in states]) > 0
    assert np.std([state["act"] for state in states]) > 0


def test_tendon_lengths(pairs):
    assert worst(pairs, lambda state, data: np.abs(data.ten_length - state["tendon_length"]).max()) < 1e-12


def test_tendon_velocities(pairs):
    assert worst(pairs, lambda state, data: np.abs(data.ten_velocity - state["tendon_velocity"]).max()) < 1e-11


def test_muscle_forces(pairs):
    def error(state, data):
        difference = np.abs(data.actuator_force - state["muscle_force"])
        return (difference / np.maximum(np.abs(data.actuator_force), 1.0)).max()

    assert worst(pairs, error) < 1e-9


def test_bias_forces(pairs):
    assert worst(pairs, lambda state, data: relative_error(state["qfrc_bias"], data.qfrc_bias)) < 1e-9


def test_springs_and_dampers(pairs):
    assert worst(pairs, lambda state, data: relative_error(state["qfrc_passive"], data.qfrc_passive)) < 1e-9


def test_soft_accelerations(pairs):
    assert worst(pairs, lambda state, data: relative_error(state["qacc_soft"], data.qacc)) < 1e-6
