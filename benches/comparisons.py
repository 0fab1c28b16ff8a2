#!/usr/bin/env python3
"""How often `compare` tells two layouts apart, and how often a layout from itself.

    myo train a.yaml --seeds 40 --out a; myo train b.yaml --seeds 40 --out b
    python3 benches/comparisons.py a b [--users 5] [--repeat 200]

Draws that many of the trained users of each layout, compares them as `myo compare` does, and counts the comparisons
that claim a difference in the time per episode or in anything. Needs the package `myoenv[compare]`.
"""

import argparse
import random
from pathlib import Path

import myoenv


def claims(first, second):
    """Whether the time per episode is claimed to differ, and whether anything is."""
    table = myoenv.compare(first, second)
    differs = table["verdict"].isin(["higher", "lower"])
    return differs["episode_length_s"], differs.any()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs=2, type=Path, help="folders that `myo train --seeds` made")
    parser.add_argument("--users", type=int, default=5, help="users of each layout in a comparison")
    parser.add_argument("--repeat", type=int, default=200, help="comparisons")
    args = parser.parse_args()
    a, b = (sorted(folder.glob("seed-*")) for folder in args.folders)
    if min(len(a), len(b)) < 2 * args.users:
        parser.error(f"each folder must hold at least {2 * args.users} users; they hold {len(a)} and {len(b)}")
    rng = random.Random(1)
    for what, one, other in (("each other", a, b), ("itself", a, a), ("itself", b, b)):
        counts = [0, 0]
        for _ in range(args.repeat):
            # Nobody is compared with himself.
            first = rng.sample(one, args.users)
            second = rng.sample([run for run in other if run not in first], args.users)
            counts = [count + bool(claim) for count, claim in zip(counts, claims(first, second), strict=True)]
        names = one[0].parent.name if one is other else f"{one[0].parent.name} and {other[0].parent.name}"
        time, anything = counts
        print(f"{names}, from {what}: a difference in time in {time} of {args.repeat}, in anything in {anything}")


if __name__ == "__main__":
    main()
