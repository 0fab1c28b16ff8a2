"""What the peers' scripts share: the arguments they are called with, timing, and the rows they print.

Each script is called as `python SCRIPT SETTINGS`, where SETTINGS is a JSON object that `measure.py` makes of
`peers.json`, and prints one JSON object per line of what it measured.
"""

import json
import sys
import time
from collections.abc import Callable

# MuJoCo's own default; the exported file asks for more exact solutions, which would be slower.
TOLERANCE = 1e-8
REPEATS = 5
# After one control step from rest, in single precision.
MOST_DIFFERENCE_RAD = 1e-4


def settings() -> dict:
    """What to measure."""
    return json.loads(sys.argv[1])


def emit(**row) -> None:
    """One result."""
    print(json.dumps(row), flush=True)


def best_and_median(step: Callable[[], object], wait: Callable[[], object], seconds: float) -> tuple[float, float]:
    """Seconds per step, of several measurements that last so long in all. A step may be under way when it returns."""

    def run(count: int) -> float:
        start = time.perf_counter()
        for _ in range(count):
            step()
        wait()
        return (time.perf_counter() - start) / count

    run(1)
    count = max(1, round(seconds / REPEATS / run(2)))
    times = sorted(run(count) for _ in range(REPEATS))
    return times[0], times[REPEATS // 2]


def distance_from_c(model, actions: list[tuple], qpos) -> float:
    """The greatest difference of a joint (rad) from MuJoCo's C library under the same excitations, each for some steps.

    Both start at rest. Who simulates something else has no place in the table.
    """
    import mujoco

    data = mujoco.MjData(model)
    for ctrl, steps in actions:
        data.ctrl[:] = ctrl
        mujoco.mj_step(model, data, nstep=steps)
    difference = float(abs(data.qpos - qpos).max())
    if not abs(data.qpos).max() > 100 * MOST_DIFFERENCE_RAD:
        raise SystemExit("the excitations move no joint by much, so nothing can be compared")
    if not difference < MOST_DIFFERENCE_RAD:
        raise SystemExit(f"after one control step a joint is {difference:.2g} rad from where MuJoCo's C library has it")
    return difference


def rates(name: str, envs: int, substeps: int, times: tuple[float, float], **more) -> None:
    """The row of a simulator that took so long per control step of all environments."""
    best, median = times
    emit(
        what="physics",
        system=name,
        envs=envs,
        control_steps_per_s=envs / best,
        control_steps_per_s_median=envs / median,
        physics_steps_per_s=substeps * envs / best,
        **more,
    )
