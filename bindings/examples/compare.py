"""Steps per second beside other muscle-driven arms: `python bindings/examples/compare.py [--seconds S] [--rounds N]`.

MyoSuite's environments are stepped by three: by this library (`myoenv.myosuite`), by EnvPool and by MyoSuite itself;
`--env` chooses one.

Needs `pip install envpool myosuite`; what is not there is left out. Everybody in turns, in one process, random actions,
all processors. MyoSuite's environments are single ones, run side by side by Gymnasium in processes.
"""

import argparse
import importlib
import json
import os
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from importlib.metadata import version

import numpy as np

Step = Callable[[], object]

ENV = "myoArmReachRandom-v0"


def ours(num_envs: int, env_id: str) -> tuple[Step, float]:
    """MyoSuite's environment, stepped by this library."""
    import myoenv

    envs = myoenv.myosuite.make_vec(env_id, num_envs, seed=1)
    envs.reset()
    actions = envs.action_space.sample()
    return lambda: envs.step(actions), envs.control_dt


def myo(num_envs: int, _: str) -> tuple[Step, float]:
    """Ours: a step of all environments, and the seconds it simulates."""
    import myoenv

    envs = myoenv.make_vec("pointing-single", num_envs, "cpu", seed=1)
    envs.reset()
    actions = envs.action_space.sample()
    return lambda: envs.step(actions), envs.control_dt


def envpool(num_envs: int, env_id: str) -> tuple[Step, float]:
    """EnvPool's arm, all environments in every batch."""
    import envpool

    envs = envpool.make(env_id, env_type="gymnasium", num_envs=num_envs, num_threads=os.cpu_count())
    envs.reset()
    actions = np.random.default_rng(1).uniform(-1, 1, (num_envs, *envs.action_space.shape)).astype(np.float32)
    return lambda: envs.step(actions), 0.02


def myosuite(num_envs: int, env_id: str) -> tuple[Step, float]:
    """MyoSuite's arm, in Gymnasium's processes."""
    import gymnasium

    def make() -> gymnasium.Env:
        # Importing it registers its environments, in every process anew.
        importlib.import_module("myosuite")
        return gymnasium.make(env_id)

    single = make()
    control_dt = float(single.unwrapped.dt)
    single.close()
    envs = gymnasium.vector.AsyncVectorEnv([make] * num_envs, context="spawn")
    envs.reset(seed=1)
    actions = envs.action_space.sample()
    return lambda: envs.step(actions), control_dt


# How they are made, and how many environments each.
CONTESTANTS = {
    "myoenv": (myo, (64, 1024)),
    "myoenv.myosuite": (ours, (64, 1024)),
    "envpool": (envpool, (64,)),
    "myosuite": (myosuite, (2,)),
}


def rates(step: Step, num_envs: int, seconds: float) -> float:
    """Control steps per second of all environments."""
    start, count = time.perf_counter(), 0
    while time.perf_counter() - start < seconds:
        step()
        count += num_envs
    return count / (time.perf_counter() - start)


def contestants(names: list[str], env_id: str) -> Iterator[tuple[str, int, Step, float]]:
    """Whoever of them is installed: name, environments, a step, seconds that it simulates."""
    for package in names:
        make, sizes = CONTESTANTS[package]
        for num_envs in sizes:
            try:
                step, control_dt = make(num_envs, env_id)
                step()
            except Exception as error:
                print(f"{package} is left out: {error}", file=sys.stderr)
                break
            yield f"{package} {version(package.partition('.')[0])}", num_envs, step, control_dt


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="+", choices=CONTESTANTS, default=list(CONTESTANTS))
    parser.add_argument("--env", default=ENV, help=f"one of myoenv.myosuite.ids(), by default {ENV}")
    parser.add_argument("--seconds", type=float, default=3)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", action="store_true", help="print an object per line")
    args = parser.parse_args()
    warnings.filterwarnings("ignore")
    everybody = list(contestants(args.only, args.env))
    best = [0.0] * len(everybody)
    for _ in range(args.rounds):
        for k, (_, num_envs, step, _) in enumerate(everybody):
            best[k] = max(best[k], rates(step, num_envs, args.seconds))
    for rate, (name, num_envs, _, control_dt) in zip(best, everybody, strict=True):
        simulated = rate * control_dt
        if args.json:
            row = {"what": "arms in their own environments", "system": name, "envs": num_envs}
            print(json.dumps(row | {"control_steps_per_s": rate, "simulated_s_per_s": simulated}))
            continue
        print(f"{name:22} {num_envs:6,} environments {rate:10,.0f} control steps/s {simulated:8,.1f} simulated s per s")


if __name__ == "__main__":
    main()
