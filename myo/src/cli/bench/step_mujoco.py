# Steps a model as often as standard input asks for: a line with a number of control steps in, a line with
# "seconds share-of-control-steps-that-end-with-a-limit-engaged" out. Arguments: model file, "one-core" or anything else.
import os
import sys
import time

import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
random = np.random.default_rng(0)
if sys.argv[2] == "one-core" and hasattr(os, "sched_setaffinity"):
    core = {max(os.sched_getaffinity(0))}
    os.sched_setaffinity(0, core)
    # The program that measures itself against this one shares the core; only one of the two runs at a time.
    os.sched_setaffinity(os.getppid(), core)
print(mujoco.__version__, flush=True)

for line in sys.stdin:
    steps, seconds, limited = int(line), 0.0, 0
    for _ in range(steps):
        data.ctrl[:] = random.random(model.nu)
        start = time.perf_counter()
        mujoco.mj_step(model, data, nstep=25)
        seconds += time.perf_counter() - start
        limited += data.nefc > data.ne
    print(seconds, limited / steps, flush=True)
