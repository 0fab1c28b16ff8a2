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
