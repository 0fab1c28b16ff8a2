"""MuJoCo's C library on one core: `mj_step`, random excitations redrawn every control step, which is not timed."""

import time

import mujoco
import numpy as np
from common import REPEATS, TOLERANCE, rates, settings

s = settings()
model = mujoco.MjModel.from_xml_path(s["file"])
model.opt.tolerance = TOLERANCE
data = mujoco.MjData(model)
random = np.random.default_rng(s["seed"])


def seconds(control_steps: int) -> float:
    """Per control step."""
    spent = 0.0
    for _ in range(control_steps):
        data.ctrl[:] = random.random(model.nu)
        start = time.perf_counter()
        mujoco.mj_step(model, data, nstep=s["substeps"])
        spent += time.perf_counter() - start
    return spent / control_steps


seconds(40)
times = sorted(seconds(200) for _ in range(REPEATS))
assert np.isfinite(data.qpos).all()
rates("MuJoCo C", 1, s["substeps"], (times[0], times[REPEATS // 2]), version=mujoco.__version__, device="one core")
