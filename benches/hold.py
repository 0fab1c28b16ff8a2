#!/usr/bin/env python3
"""How fast a fingertip moves while it stays in a target, with the task as it was learnt and with some of it changed.

    python3 benches/hold.py RUN [reflex.gain=40 ...]

RUN is the folder of a run whose steps are dwells, such as `protocols/holding/seed-1` in a run that was asked K3. Each
argument after it, `key.key=number` or several joined by commas, is one more row: the same policy, without further
practice, where the task has these numbers instead. A row is the median and mean speed over control steps (mm/s) of 200
episodes, from a quarter of each dwell on, and how many dwells were done. Needs the Python package.
"""

import argparse
import json
from pathlib import Path

import numpy as np

import myoenv

ENVS = 200
SEED = 3
#: Share of a dwell after which the fingertip is taken to be held.
SETTLED = 0.25


def changed(task, changes):
    """The task with other numbers at `key.key=number,...`."""
    task = json.loads(json.dumps(task))
    for change in filter(None, changes.split(",")):
        path, number = change.split("=")
        *parts, last = path.split(".")
        place = task
        for part in parts:
            place = place.setdefault(part, {})
        place[last] = float(number)
    return task


def held(task, policy):
    """Speeds (m/s) between control steps in dwells, and how many dwells were done."""
    env = myoenv.make_vec(task, num_envs=ENVS)
    observation, _ = env.reset(seed=SEED)
    names = list(env.observation_names)
    fingertip = [names.index(f"fingertip_position.{axis}") for axis in "xyz"]
    dwell, phase = names.index("dwell_fraction"), names.index("phase")
    lasts, speeds, done = np.ones(ENVS, dtype=bool), [], 0
    for _ in range(round(task["time_limit_s"] / task["control_dt_s"])):
        before = observation
        observation, _, terminated, truncated, _ = env.step(policy(before))
        done += np.count_nonzero(lasts & (terminated | (observation[:, phase] > before[:, phase])))
        # What an ended episode is followed by begins anew elsewhere.
        lasts &= ~(terminated | truncated)
        stays = lasts & (before[:, dwell] > SETTLED) & (observation[:, dwell] >= before[:, dwell])
        way = observation[stays][:, fingertip] - before[stays][:, fingertip]
        speeds.extend(np.linalg.norm(way, axis=1) / task["control_dt_s"])
    env.close()
    return np.array(speeds), done


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("changes", nargs="*")
    arguments = parser.parse_args()
    task = json.loads((arguments.run / "config.json").read_text())["run"]["task"]
    policy = myoenv.Policy.load(arguments.run)
    for changes in ["", *arguments.changes]:
        speeds, done = held(changed(task, changes), policy)
        figures = f"{1e3 * np.median(speeds):.0f} mm/s, mean {1e3 * np.mean(speeds):.0f}" if speeds.size else "no dwell"
        print(f"{changes or 'as learnt'}: {figures}, over {speeds.size} control steps; {done} dwells done")


if __name__ == "__main__":
    main()
