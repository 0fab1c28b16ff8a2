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


@pytest.fixture(scope="module")
def key_forces(arm_with_keys, key_presses):
    """Of each case: Myo's and MuJoCo's force on every key, and the accelerations."""

    def case(press):
        model = arm_with_keys
        for k, place in enumerate(press["keys"]):
            body = model.body(f"key{k}").id
            model.body_pos[body] = place
            model.body_quat[body] = press["quat"]
        data = forward(model, press)
        felt = [data.sensor(f"key{k}").data[0] for k in range(len(press["keys"]))]
        return press["touch_forces"], felt, press["qacc_soft"], data.qacc.copy()

    return [case(press) for press in key_presses]


def test_several_keys_are_pressed_at_once(key_forces):
    touched = [np.count_nonzero(np.array(felt) > 0.01) for _, felt, _, _ in key_forces]
    for count in (0, 1, 2, 3, 4):
        assert count in touched, f"MuJoCo must feel {count} keys in one case at least: {touched}"


def test_forces_on_several_keys(key_forces):
    for found, wanted, qacc, wanted_qacc in key_forces:
        scale = max(np.abs(wanted).max(), 1.0)
        assert np.abs(np.array(found) - wanted).max() / scale < 1e-3
        assert np.abs(np.array(qacc) - wanted_qacc).max() / np.abs(wanted_qacc).max() < 1e-3
