"""Small helpers around MuJoCo."""

import mujoco
import numpy as np


def forward(model, state):
    """MuJoCo's data at one state, without memory of an earlier one."""
    data = mujoco.MjData(model)
    data.qpos[:] = state["qpos"]
    data.qvel[:] = state["qvel"]
    data.act[:] = state["act"]
    data.ctrl[:] = state["ctrl"]
    mujoco.mj_forward(model, data)
    return data


def dependent_joints(model):
    """Joints that an equality ties to another joint or to a constant."""
    return sorted(set(model.eq_obj1id.tolist()))


def independent_joints(model):
    return [joint for joint in range(model.njnt) if joint not in dependent_joints(model)]


def relative_error(found, wanted, floor=1e-30):
    """Greatest difference in units of the greatest wanted value (or of `floor`, if that is greater)."""
    found, wanted = np.asarray(found), np.asarray(wanted)
    return np.abs(found - wanted).max() / max(np.abs(wanted).max(), floor)
