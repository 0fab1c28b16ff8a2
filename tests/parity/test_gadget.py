"""Single steps of bodies with what the arm lacks: slides, two joints on one body, curved couplings, implicit damping, a
smoothed muscle with an automatic force; a free body with another one on a ball joint."""

import mujoco
import numpy as np
import pytest
from conftest import load, read
from simulation import forward, relative_error


@pytest.fixture(scope="module", params=["gadget", "balloon"])
def gadget(data, request):
    return load(data / f"{request.param}.xml")


@pytest.fixture(scope="module")
def pairs(data, gadget):
    name = "balloon" if gadget.nq > gadget.nv else "gadget"
    steps = read(data / f"{name}.json")
    assert len(steps) >= 100 and len(steps[0]["qpos"]) == gadget.nq
    return [(step, forward(gadget, step)) for step in steps]


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
