#!/usr/bin/env python3
"""How surely users learn layouts that nobody tuned for.

    python3 benches/layouts.py [--layouts 20] [--seeds 10] [--out FILE] [-- MORE OPTIONS OF `myo bench train`]

Draws layouts of three to six spheres and buttons before the user, keeps those of which every part can be reached
(`myo task check` has no warning), trains users of each until 95 % of fresh episodes succeed (`myo bench train`), and
tells how many got there and how the slowest compares with the median. Layout `n` is the same on every machine.
"""

import argparse
import json
import random
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

#: Metres relative to the right shoulder: x forward, y to the left, z up.
SPACE = {"x": (0.25, 0.5), "y": (-0.25, 0.25), "z": (-0.35, 0.2)}


def sphere(rng, place, name):
    """A sphere, and the step that asks for it."""
    radius = round(rng.uniform(0.03, 0.08), 3)
    thing = {"kind": "sphere", "at": place, "radius": radius, "min_distance_from_previous": 0}
    return thing, {"dwell": {"in": name, "for_s": rng.choice([0.1, 0.2, 0.3])}}


def button(rng, place, name):
    """A button, and the step that asks for it."""
    side = round(rng.uniform(0.03, 0.07), 3)
    thing = {
        "kind": "button",
        "at": place,
        "size": [side, side, 0.02],
        "tilt_deg": rng.choice([0, 45, 90]),
        "min_force_n": rng.choice([0.5, 1, 2]),
    }
    return thing, {"press": name}


def draw(rng, name, count):
    """A layout of so many targets, as a task file: JSON is YAML."""
    task = {"version": 2, "name": name, "scene": {}, "script": [], "time_limit_s": 1.5 * count + 1}
    for number in range(1, count + 1):
        place = [round(rng.uniform(*SPACE[axis]), 3) for axis in "xyz"]
        target = f"target{number}"
        thing, step = rng.choice([sphere, button])(rng, place, target)
        task["scene"][target] = thing
        task["script"].append(step)
    return task


def layouts(count, folder, myo):
    """Files of the first so many layouts."""
    rng = random.Random(1)
    return [layout(rng, folder / f"layout-{n + 1}.yaml", myo) for n in range(count)]


def layout(rng, file, myo):
    """Draws until every part can be reached; the number of targets once, or layouts of many would be rare."""
    count = rng.randint(3, 6)
    while True:
        file.write_text(json.dumps(draw(rng, file.stem, count)))
        check = subprocess.run([myo, "task", "check", str(file), "--json"], capture_output=True, text=True)
        report = json.loads(check.stdout)
        if report["ok"] and not report["warnings"]:
            return file


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--layouts", type=int, default=20)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--myo", default="target/release/myo", help="the program")
    parser.add_argument("--out", type=Path, help="where to keep the rows, as JSON")
    parser.add_argument("options", nargs="*", help="more options of `myo bench train`, after `--`")
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as place:
        for file in layouts(args.layouts, Path(place), args.myo):
            command = [args.myo, "bench", "train", str(file), "--seeds", str(args.seeds), "--json", *args.options]
            told = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)
            task = json.loads(file.read_text())
            rows += [{"scene": task["scene"], "script": task["script"], **row} for row in told["rows"]]
            steps = [row["env_steps"] / 1e6 for row in told["rows"]]
            reached, shown = told["reached"], " ".join(f"{x:.1f}" for x in sorted(steps))
            print(f"{file.stem}: {reached} of {args.seeds} reached it; {shown} M control steps", flush=True)
    steps = [row["env_steps"] for row in rows]
    failed = sum(row["stopped_by"] == "steps" for row in rows)
    middle = statistics.median(steps)
    print(
        f"{len(rows) - failed} of {len(rows)} users reached it; median {middle / 1e6:.1f} M control steps, "
        f"slowest {max(steps) / 1e6:.1f} M, {max(steps) / middle:.1f} times as many"
    )
    if args.out:
        args.out.write_text(json.dumps(rows, indent=1))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
