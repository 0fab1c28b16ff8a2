"""The force with which the fingertip presses a box, against MuJoCo's touch sensor."""

import numpy as np
import pytest
from simulation import forward


def touch(model, press):
    body = model.body("button").id
    model.body_pos[body] = press["button"]["pos"]
    model.body_quat[body] = press["button"]["quat"]
    return forward(model, press).sensor("button").data[0]


@pytest.fixture(scope="module")
def forces(arm_with_button, presses):
    """Myo's and MuJoCo's force of each case, two columns."""
    return np.array([(press["touch_force"], touch(arm_with_button, press)) for press in presses])


def test_cases_press_and_miss(forces):
    assert len(forces) >= 20
    assert (forces[:, 1] > 1.0).sum() >= 10, "MuJoCo must feel a force in ten cases at least"
    assert (forces[:, 1] == 0.0).any(), "and none in one"


def test_pressing_forces(forces):
    found, wanted = forces.T
    assert (np.abs(found - wanted) / np.maximum(np.abs(wanted), 1.0)).max() < 1e-3
