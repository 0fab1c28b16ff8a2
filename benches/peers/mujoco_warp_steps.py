"""MuJoCo Warp: a control step of all environments in one CUDA graph; on a processor without graphs.

Random excitations are drawn once per environment and written anew before every control step, in turn from eight sets.
"""

import time

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp
from common import TOLERANCE, best_and_median, distance_from_c, rates, settings

s = settings()
wp.config.quiet = True
wp.init()
device = wp.get_device()
host = mujoco.MjModel.from_xml_path(s["file"])
host.opt.tolerance = TOLERANCE
SETS = 8


def measure(envs: int) -> None:
    """A row for so many environments."""
    start = time.perf_counter()
    model = mjw.put_model(host)
    # Every joint can be at its limit, and every coupling has a row; there is nothing to touch.
    data = mjw.make_data(host, nworld=envs, nconmax=1, njmax=host.neq + host.njnt)
    random = np.random.default_rng(s["seed"])
    sets = [wp.array(random.random((envs, host.nu), dtype=np.float32), dtype=float) for _ in range(SETS)]

    def physics() -> None:
        for _ in range(s["substeps"]):
            mjw.step(model, data)

    mjw.step(model, data)  # compiles
    replay = physics
    if device.is_cuda:
        with wp.ScopedCapture() as capture:
            physics()
        replay = lambda: wp.capture_launch(capture.graph)  # noqa: E731
    wp.synchronize()
    ready_s = time.perf_counter() - start
    count = [0]

    def step() -> None:
        wp.copy(data.ctrl, sets[count[0] % SETS])
        count[0] += 1
        replay()

    step()
    actions = [(np.zeros(host.nu), 1), (sets[0].numpy()[0], s["substeps"])]
    difference = distance_from_c(host, actions, data.qpos.numpy()[0])
    times = best_and_median(step, wp.synchronize, s["seconds"])
    finite = float(np.isfinite(data.qpos.numpy()).all(axis=1).mean())
    where = {"version": f"{mujoco.__version__}, Warp {wp.config.version}", "device": device.name}
    checks = {"finite": finite, "difference_rad": difference}
    rates("MuJoCo Warp", envs, s["substeps"], times, **where, ready_s=ready_s, **checks)


for envs in s["envs"]:
    measure(envs)
