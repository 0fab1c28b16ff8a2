#!/usr/bin/env python3
"""Whether simulated users come to findings about layouts that people came to.

    python3 benches/findings.py [--seeds 5] [--only 1,4] [--out DIR] [-- MORE OPTIONS OF `myo train`]

The findings and what counts as their right sign are those of `docs/findings.md`. Every study trains users to their
plateau with `myo train --seeds`, on tasks made here, and asks them with `myo eval --json`. A finding holds when the
sign is right in every seed; a user who did not learn its task has no sign, and the finding does not hold. Who is
trained already is asked again at once, and who was interrupted goes on first.
"""

import argparse
import json
import statistics
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

#: Least share of its episodes in which a user must succeed for its times to mean anything.
LEARNT = 0.8

#: Metres from the right shoulder to the middle of the body.
MIDLINE = 0.17


def task(name, scene, script, time_limit_s):
    """A task of the default user on the default arm of people."""
    head = {"version": 2, "name": name, "user": "human", "model": "myo-arm"}
    return {**head, "scene": scene, "script": script, "time_limit_s": time_limit_s}


def sphere(at, radius):
    """A sphere that may be as near to the one before as it likes."""
    return {"kind": "sphere", "at": at, "radius": radius, "min_distance_from_previous": 0}


def display(row, height):
    """Two buttons in one row of an upright wall, each tapped from a place of rest at the hip."""
    button = {"kind": "button", "size": [0.05, 0.05, 0.02], "tilt_deg": 90, "min_force_n": 1}
    scene = {
        "wall": {"kind": "obstacle", "at": [0.441, 0, -0.1], "size": [0.5, 0.6, 0.02], "tilt_deg": 90},
        "hip": sphere([0.2, -0.05, -0.45], 0.06),
        "right": {**button, "at": [0.42, -0.15, height]},
        "left": {**button, "at": [0.42, 0.15, height]},
    }
    rest = {"dwell": {"in": "hip", "for_s": 0.2}}
    return task(row, scene, [rest, {"press": "right"}, rest, {"press": "left"}], 8)


def keys(width_mm):
    """Five keys in a row on a plate, pressed in an order that each episode draws."""
    width = width_mm / 1000
    button = {"kind": "button", "size": [width, width, 0.001], "min_force_n": 0.3}
    row = {
        "kind": "grid",
        "at": [0.32, 0, -0.3],
        "rows": 1,
        "columns": 5,
        "pitch": round(width + 0.001, 4),
        "of": button,
    }
    plate = {"kind": "obstacle", "at": [0.32, 0, -0.306], "size": [0.09, 0.04, 0.01]}
    return task(
        f"keys-{width_mm}-mm", {"keys": row, "plate": plate}, [{"random_order": [{"press": [1, 2, 3, 4, 5]}]}], 8
    )


def sides():
    """From the middle of the body, at the height of the shoulder, to the left and to the right."""
    stay = {"for_s": 0.2}
    scene = {
        place: sphere([0.45, MIDLINE + y, 0], 0.03) for place, y in (("middle", 0), ("left", 0.2), ("right", -0.2))
    }
    order = ("middle", "left", "middle", "right")
    return task("sides", scene, [{"dwell": {"in": place, **stay}} for place in order], 6)


def spheres(name, x, z):
    """Five spheres in a plane, as far ahead and as high as told."""
    at = {"x": x, "y": [-0.1, 0.1], "z": [z - 0.1, z + 0.1]}
    scene = {"ball": {"kind": "sphere", "copies": 5, "at": at, "radius": 0.04, "min_distance_from_previous": 0.08}}
    return task(name, scene, [{"dwell": {"in": "ball", "for_s": 0.25}}], 10)


def tunnel(width_cm):
    """A straight way of 30 cm."""
    ends = {"start": sphere([0.45, 0.2, -0.1], 0.04), "end": sphere([0.45, -0.1, -0.1], 0.04)}
    steer = {"steer": {"through": ["start", "end"], "width": width_cm / 100}}
    return task(f"tunnel-{width_cm}-cm", ends, [{"dwell": {"in": "start", "for_s": 0.2}}, steer], 8)


#: Rows and columns of the places that a button of a layout may have before the user's eyes: metres up and to the left
#: of the right shoulder. The middle is at the height of the eyes, a fifth of a metre above the shoulder, before the
#: middle of the body.
UP, LEFT = (0.3, 0.2, 0.1), tuple(round(MIDLINE + y, 2) for y in (0.25, 0.15, 0.05, -0.05, -0.15, -0.25))

#: Layouts of three buttons: all neighbours side by side, and all columns; rows and columns are counted from the upper
#: left.
TRIPLES = [[(row, column + k) for k in range(3)] for row in range(3) for column in range(4)]
TRIPLES += [[(row, column) for row in range(3)] for column in range(6)]

#: The one in the middle; of the two there are, that on the side of the arm.
CENTRED = TRIPLES.index([(1, 2), (1, 3), (1, 4)])


def triples():
    """Three buttons on a wall, pressed one after the other three times, in every layout."""
    button = {"kind": "button", "size": [0.05, 0.05, 0.02], "tilt_deg": 90, "min_force_n": 1}
    wall = {"kind": "obstacle", "at": [0.471, MIDLINE, 0.2], "size": [0.4, 0.7, 0.02], "tilt_deg": 90}

    def triple(number, places):
        buttons = {f"b{k}": {**button, "at": [0.45, LEFT[c], UP[r]]} for k, (r, c) in enumerate(places, 1)}
        steps = [{"press": list(buttons)}]
        return task(f"triple-{number}", {**buttons, "wall": wall}, [{"repeat": {"times": 3, "steps": steps}}], 10)

    return [triple(number, places) for number, places in enumerate(TRIPLES)]


def time_of(told, number):
    """Movement time of a target in s; more than any where nobody made it."""
    time = told["targets"][number]["movement_time_s"]
    return float("inf") if time is None else time


def lower_display(told):
    """Whether the lower row is faster and cheaper."""
    upper, lower = told[0]["layouts"]
    times = [sum(time_of(row, press) for press in (1, 3)) / 2 for row in (upper, lower)]
    efforts = [row["effort"] for row in (upper, lower)]
    says = f"upper {times[0]:.3f} s, lower {times[1]:.3f} s; efforts {efforts[0]:.4f} and {efforts[1]:.4f}"
    return times[1] < times[0] and efforts[1] < efforts[0], says


WIDTHS_MM = (3, 5, 7, 9.6, 12)


def larger_keys(told):
    """Whether errors fall with the width up to 9.6 mm and no further, and small keys take longer."""
    wrong = [user["wrong_presses"] / 5 for user in told]
    times = [statistics.mean(time_of(user, key) for key in range(5)) for user in told]
    fall = all(wider < narrower for narrower, wider in pairwise(wrong[:4]))
    says = ", ".join(f"{w} mm {100 * e:.1f} % {t:.3f} s" for w, e, t in zip(WIDTHS_MM, wrong, times, strict=True))
    return fall and abs(wrong[4] - wrong[3]) <= 0.03 and times[0] > times[3], says


def other_side(told):
    """Whether targets across the body take longer with the right arm."""
    left, right = time_of(told[0], 1), time_of(told[0], 3)
    return left > right, f"left {left:.3f} s, right {right:.3f} s"


def high_is_dear(told):
    """Whether the same spheres cost more at the height of the shoulder."""
    shoulder, waist = (layout["effort"] for layout in told[0]["layouts"])
    return waist < shoulder, f"shoulder {shoulder:.4f}, waist {waist:.4f}"


WIDTHS_CM = (2, 3, 5, 8)


def steering(told):
    """Whether time grows with every narrower way, in proportion to length over width."""
    # Its targets: to stay at the start, to be there when the way begins, and the way.
    times = [time_of(user, 2) for user in told]
    if float("inf") in times:
        return False, "a way that nobody made"
    r2 = statistics.correlation([0.3 / (width / 100) for width in WIDTHS_CM], times) ** 2
    grows = all(narrower > wider for narrower, wider in pairwise(times))
    says = ", ".join(f"{w} cm {t:.3f} s" for w, t in zip(WIDTHS_CM, times, strict=True))
    return grows and r2 >= 0.8, f"{says}; R2 {r2:.2f}"


def against_fatigue(told, others):
    """Whether the layout that tires others least tires this user less than the centred one."""
    tiring = [[layout["fatigue"] for layout in user["layouts"]] for [user] in (told, *others)]
    chosen = min(range(len(TRIPLES)), key=lambda number: sum(user[number] for user in tiring[1:]))
    own, centred = tiring[0][chosen], tiring[0][CENTRED]
    says = f"{100 * own:.3f} % of strength with {TRIPLES[chosen]}, {100 * centred:.3f} % in the middle"
    return own < centred, says


#: Number in `docs/findings.md`, what it says, the tasks of each user (several are layouts of one), and who judges them.
FINDINGS = [
    (
        1,
        "lower targets of a display are faster and cheaper",
        [[display("upper", 0.1), display("lower", -0.3)]],
        lower_display,
    ),
    (2, "larger keys: fewer errors up to 9.6 mm", [[keys(width)] for width in WIDTHS_MM], larger_keys),
    (3, "targets across the body take longer", [[sides()]], other_side),
    (
        4,
        "the height of the shoulder costs more",
        [[spheres("shoulder", 0.55, 0), spheres("waist", 0.35, -0.35)]],
        high_is_dear,
    ),
    (5, "time through a tunnel follows length over width", [[tunnel(width)] for width in WIDTHS_CM], steering),
    (6, "a layout chosen against fatigue tires less than a centred one", [triples()], against_fatigue),
]


class Users:
    """Trains users with the program, and asks them."""

    def __init__(self, myo, out, seeds, options):
        self.myo, self.out, self.seeds, self.options = myo, out, seeds, options
        self.finished = set()

    def trained(self, tasks):
        """The folder of users of these layouts, one for each seed: new ones, or those there once they have finished."""
        names = [task["name"] for task in tasks]
        runs = self.out / ("-".join(names) if len(names) < 3 else f"{names[0]}-to-{names[-1]}")
        if runs in self.finished:
            return runs
        if runs.exists():
            self.call("train", "--resume", runs)
        else:
            files = [self.out / f"{task['name']}.yaml" for task in tasks]
            for file, text in zip(files, tasks, strict=True):
                file.write_text(json.dumps(text))
            together = ["--together"] if len(files) > 1 else []
            self.call("train", *files, *together, "--out", runs, "--seeds", self.seeds, *self.options)
        self.finished.add(runs)
        return runs

    def asked(self, studies, seed):
        """What the users of a seed come to, one for each study."""
        return [json.loads(self.call("eval", self.trained(tasks) / f"seed-{seed}", "--json")) for tasks in studies]

    def call(self, *words):
        return subprocess.run([self.myo, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True).stdout


def verdict(judge, told, others):
    """Whether a seed's users have the right sign, and their figures; `others` are those of the other seeds."""
    least = min(user["success"] for user in told)
    if least < LEARNT:
        return False, f"not learnt: {100 * least:.0f} % of the episodes of one succeed"
    return judge(told, others) if judge is against_fatigue else judge(told)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--only", help="numbers of findings, such as 1,4")
    parser.add_argument("--myo", default="target/release/myo", help="the program")
    parser.add_argument("--out", type=Path, default=Path("runs/findings"), help="where the users are kept")
    parser.add_argument("options", nargs="*", help="more options of `myo train`, after `--`")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    users = Users(args.myo, args.out, args.seeds, args.options)
    asked = [int(number) for number in args.only.split(",")] if args.only else [number for number, *_ in FINDINGS]
    missed = 0
    for number, claim, studies, judge in FINDINGS:
        if number not in asked:
            continue
        right = 0
        told = {seed: users.asked(studies, seed) for seed in range(1, args.seeds + 1)}
        for seed, own in told.items():
            has_sign, says = verdict(judge, own, [other for name, other in told.items() if name != seed])
            right += has_sign
            print(f"  seed {seed} {'right' if has_sign else 'WRONG'}: {says}", flush=True)
        missed += right < args.seeds
        print(f"{number} {claim}: right in {right} of {args.seeds}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
