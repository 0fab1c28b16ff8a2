"""Single steps of a body with what the arm lacks: slides, two joints on one body, curved couplings, implicit damping, a
smoothed muscle with an automatic force."""

import mujoco
import numpy as np
import pytest
from simulation import forward, relative_error


@pytest.fixture(scope="module")
def pairs(gadget, gadget_steps):
    assert len(gadget_steps) >= 100
    return [(step, forward(gadget, step)) for step in gadget_steps]


def test_the_gadget_damps_implicitly(gadget):
    assert not gadget.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    assert (gadget.dof_damping > 0).all()


def test_automatic_muscle_force(pairs):
    assert max(relative_error(step["muscle_force"], data.actuator_force) for step, data in pairs) < 1e-9


def test_accelerations(pairs):
    assert max(relative_error(step["qacc"], data.qacc) for step, data in pairs) < 1e-6


def test_next_state(gadget, pairs):
    for step, data in pairs:
        mujoco.mj_step(gadget, data)
        assert relative_error(step["qvel_next"], data.qvel) < 1e-6
        assert np.abs(data.qpos - step["qpos_next"]).max() < 1e-7
        assert np.abs(data.act - step["act_next"]).max() < 1e-12
