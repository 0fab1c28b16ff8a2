"""One second of random controls: reduced coordinates against MuJoCo's soft couplings, lanes against f64."""

import mujoco
import numpy as np
import pytest
from simulation import independent_joints

STEPS_PER_CONTROL = 25


def simulate(model, rollout):
    """Joint positions after each control step."""
    data = mujoco.MjData(model)
    data.qpos[:] = rollout["qpos0"]
    data.qvel[:] = rollout["qvel0"]
    data.act[:] = rollout["act0"]
    positions = []
    for ctrl in rollout["ctrl"]:
        data.ctrl[:] = ctrl
        for _ in range(STEPS_PER_CONTROL):
            mujoco.mj_step(model, data)
        positions.append(data.qpos.copy())
    return np.array(positions)


def rms(difference):
    return np.sqrt(np.mean(np.square(difference)))


@pytest.fixture(scope="module")
def free(arm):
    return independent_joints(arm)


def test_rollouts_last_a_second(arm, rollouts):
    assert len(rollouts) >= 10
    for rollout in rollouts:
        assert len(rollout["ctrl"]) * STEPS_PER_CONTROL * arm.opt.timestep == pytest.approx(1.0)
        assert np.shape(rollout["qpos_reduced"]) == np.shape(rollout["qpos_lanes"]) == (len(rollout["ctrl"]), arm.nq)


def test_reduced_rollouts_follow_mujoco(arm, rollouts, free):
    errors = [simulate(arm, rollout)[:, free] - np.array(rollout["qpos_reduced"])[:, free] for rollout in rollouts]
    assert rms(errors) < 5e-4, f"rms per joint: {np.sqrt(np.mean(np.square(errors), axis=(0, 1)))}"


def test_lanes_follow_the_reference(rollouts, free):
    lanes = np.array([rollout["qpos_lanes"][-1] for rollout in rollouts])
    reference = np.array([rollout["qpos_reduced"][-1] for rollout in rollouts])
    assert rms((lanes - reference)[:, free]) < 1e-5
