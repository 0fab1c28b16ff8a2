"""What of users shows what effort costs them, of all that `myo export` writes of 64 users who differ in their traits.

    myo bench fit --users 1 --practised anybody --backend gpu     # who learns to be anybody
    myo export anybody/seed-1 --episodes 2 --out 1.csv            # 24 movements of each user, 0.8 GB
    python3 benches/what_tells_effort.py anybody/seed-1 1.csv     # more files for more movements, of other --seed

Of each quantity a polynomial of the second degree of the four traits, as `myo fit` has them, its slopes along the
traits, and how many times what is left about it the slope along effort is. Effort within a tenth needs 22. Needs numpy.
"""

from __future__ import annotations

import csv
import json
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

#: Traits as they stand in a task, with their least and greatest values (`myo-lab/src/fitting/nature.rs`).
TRAITS = [
    ("noise", "signal_dependent", 0.02, 0.2),
    ("perception", "vision_noise", 0.05, 0.4),
    ("reward", "effort_cost", 1.0, 64.0),
    ("reward", "control_change_cost", 3.0, 44.0),
]
EFFORT = 2
#: Every so many physics steps is enough.
EVERY = 4
OTHERS = ("elv_angle_rad", "shoulder_elv_rad", "shoulder_rot_rad", "elbow_flexion_rad", "metabolic_w")


def places(run: Path) -> np.ndarray:
    """Where each layout's user is among all, -1 to 1 for each trait."""
    described = json.loads((run / "config.json").read_text())["run"]
    layouts = [described["task"], *described["other_layouts"]]
    values = [[task[part][key] for part, key, _, _ in TRAITS] for task in layouts]
    least, most = np.array([[low, high] for _, _, low, high in TRAITS]).T
    return 2 * np.log(np.array(values) / least) / np.log(most / least) - 1


def means(files: list[Path]) -> tuple[list[str], dict[str, np.ndarray]]:
    """Means of activations and of the other quantities, by layout, from the second target on."""
    names: list[str] = []
    sums: dict[str, np.ndarray] = defaultdict(lambda: np.zeros(1))
    for path in files:
        with path.open(newline="") as file:
            rows = csv.reader(file)
            head = next(rows)
            names = [name for name in head if name.endswith("_activation") or name in OTHERS]
            at = [head.index(name) for name in names]
            layout, step = head.index("layout"), head.index("step")
            for row in thinned(rows):
                if row[step] not in ("", "0", "1"):
                    sums[row[layout]] = sums[row[layout]] + np.array([1.0, *(float(row[k]) for k in at)])
    return names, {layout: total[1:] / total[0] for layout, total in sums.items()}


def thinned(rows):
    for number, row in enumerate(rows):
        if number % EVERY == 0:
            yield row


def slopes(design: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float]:
    """Slopes along the traits in the middle, and the standard deviation about the polynomial."""
    found, *_ = np.linalg.lstsq(design, values, rcond=None)
    free = len(values) - design.shape[1]
    return found[1 : 1 + len(TRAITS)], float(np.sqrt(((values - design @ found) ** 2).sum() / free))


def main() -> None:
    run, files = Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]]
    place = places(run)
    pairs = [(i, j) for i in range(len(TRAITS)) for j in range(i, len(TRAITS))]
    design = np.column_stack([np.ones(len(place)), place, *(place[:, i] * place[:, j] for i, j in pairs)])
    names, found = means(files)
    table = np.array([found[f"spheres ({k + 1})"] for k in range(len(place))])
    muscles = [k for k, name in enumerate(names) if name.endswith("_activation")]
    rows = {"mean activation": np.log(table[:, muscles].mean(axis=1))}
    for k, name in enumerate(names):
        rows[name] = table[:, k] if name.endswith("_rad") else np.log(np.maximum(table[:, k], 1e-5))
    print(f"{'':24}{'slopes along ' + ', '.join(key for _, key, _, _ in TRAITS):80}{'rest':>8}{'effort':>8}")
    scaled = []
    for name, values in rows.items():
        slope, rest = slopes(design, values)
        if name.endswith("_activation"):
            scaled.append(slope / rest)
        print(f"{name:24}{np.array2string(slope, precision=3):80}{rest:8.4f}{abs(slope[EFFORT]) / rest:8.1f}")
    told = np.array(scaled).T @ np.array(scaled)
    half = np.log(TRAITS[EFFORT][3] / TRAITS[EFFORT][2]) / 2
    known, unknown = 1 / np.sqrt(told[EFFORT, EFFORT]), np.sqrt(np.linalg.inv(told)[EFFORT, EFFORT])
    within = [100 * (np.exp(half * error) - 1) for error in (known, unknown)]
    print(f"all activations: effort within {within[0]:.0f} % with the other traits known, {within[1]:.0f} % else")


if __name__ == "__main__":
    main()
