#!/usr/bin/env python3
"""What the muscles of the elbow do while it moves: whether they work against each other, and which.

    myo export RUN --episodes 2 --out moves.csv
    python3 benches/co_contraction.py moves.csv

RUN is a user who points, such as `protocols/pointing/seed-1` in a run that was asked F1. Of all samples after the first
selection: the index `2 sum min(F, E) / sum (F + E)` of the mean activations of flexors and of extensors, at rest and at
speed; how much both vary; whether they change together; and the mean and the greatest activation of each muscle.
"""

import csv
import statistics
import sys
from itertools import pairwise

FLEXORS = ("BIClong", "BICshort", "BRA", "BRD", "ECRL", "PT")
EXTENSORS = ("TRIlong", "TRIlat", "TRImed")
#: Speeds of the elbow (rad/s) from one of which to the next is told.
SPEEDS = (0, 0.05, 0.2, 0.5, 1, 100)
#: Samples of 50 ms.
APART = 25


def moving(path):
    """The rows of a table after the first selection of each episode."""
    with open(path, newline="") as file:
        episode, has_begun, rows = None, False, []
        for row in csv.DictReader(file):
            if (row["episode"], row.get("layout")) != episode:
                episode, has_begun = (row["episode"], row.get("layout")), False
            if has_begun:
                rows.append(row)
            has_begun = has_begun or "done" in row["event"]
    return rows


def index(flexors, extensors):
    """Co-contraction index."""
    both = list(zip(flexors, extensors, strict=True))
    return 2 * sum(map(min, both)) / sum(map(sum, both)) if both else float("nan")


def changes(series):
    """By how much a series changes in 50 ms."""
    return [later - now for now, later in zip(series, series[APART:], strict=False)]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    rows = moving(sys.argv[1])
    if not rows:
        sys.exit(f"{sys.argv[1]}: nobody selected anything")
    muscles = [name.removesuffix("_activation") for name in rows[0] if name.endswith("_activation")]
    activation = {muscle: [float(row[f"{muscle}_activation"]) for row in rows] for muscle in muscles}
    flexors, extensors = (
        [statistics.fmean(all_of) for all_of in zip(*(activation[muscle] for muscle in group), strict=True)]
        for group in (FLEXORS, EXTENSORS)
    )
    print(f"{len(rows)} samples, index {index(flexors, extensors):.2f}")
    speed = [abs(float(row["elbow_flexion_rad_s"])) for row in rows]
    for low, high in pairwise(SPEEDS):
        at = [sample for sample, value in enumerate(speed) if low <= value < high]
        if at:
            found = index([flexors[sample] for sample in at], [extensors[sample] for sample in at])
            print(f"  from {low} to {high} rad/s ({100 * len(at) / len(speed):.0f} %): {found:.2f}")
    print(f"standard deviations {statistics.pstdev(flexors):.3f} (flexors), {statistics.pstdev(extensors):.3f}")
    together = statistics.correlation(changes(flexors), changes(extensors))
    print(f"correlation of changes in 50 ms {together:.2f}")
    for muscle in muscles:
        print(f"  {muscle:9} {statistics.fmean(activation[muscle]):.3f}, at most {max(activation[muscle]):.3f}")


if __name__ == "__main__":
    main()
