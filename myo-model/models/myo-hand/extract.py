#!/usr/bin/env python3
"""Writes MyoHand (Python package myo-sim 0.2.3) in the form that Myo ships: a hand whose fingers do tasks.

    myo model import myohand_r.xml --fingertip IFtip_r --shoulder humerus_r --elbow ulna_r --wrist lunate_r --out FILE.yaml
    python extract.py FILE.yaml myohand_r.xml > ../myo-hand.yaml

Needs mujoco==4.0.0, numpy and PyYAML; `myohand_r.xml` is the model of `myo_sim` as MuJoCo saves it. What is changed:

  trunk      everything above the upper arm is left out: nothing of it moves, and no muscle begins there
  elbow      the upper arm hangs and the elbow is bent by 90 degrees, so that the forearm points forward as at a desk
             (the source stretches the whole arm to the side); the wrist's muscles that begin above it are as long as
             that makes them
  fingertips every finger has a ball in its last bone that points and presses, about a site of its own: the end of the
             source's capsule around that bone
  contacts   the last bone of the thumb and those of the fingers do not pass through each other (capsules of the source,
             which touch nothing there), so that a pinch ends where skin meets skin
  softness   of all of these that of a finger's pulp, as in myo-arm

Joints, their damping, muscles and paths are the source's.
"""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np
import yaml

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "myo-arm"))
from extract import plain, to_yaml
from fingertips import fingertips, used_names

HEADER = """\
# A human right hand and its wrist on a forearm that is held: all fingers move, each may point, press and pinch.
# Made of MyoHand of the package myo-sim 0.2.3 by myo-hand/extract.py, which lists every change.
# Licensed under the Apache Licence 2.0 alone; see NOTICE.
# World: x forward, y to the left, z up. Metres, kilograms, seconds, newtons, radians; quaternions are w, x, y, z.
# A field that is left out has the default that the format documents (for example `pos: [0, 0, 0]`).
"""
CITATION = (
    "MyoHand of myo-sim 0.2.3 (Apache-2.0, Copyright 2025 Vikash Kumar, Vittorio Caggiano; "
    "Caggiano et al. 2022, https://doi.org/10.48550/arXiv.2205.13600); elbow bent, fingertips added, see NOTICE"
)
UPPER_ARM, FOREARM = "humerus_r", "ulna_r"
#: The upper arm's frame (OpenSim: x forward, y up, z right) in Myo's world, at the height of a shoulder.
UPPER_ARM_POS = [0.0, 0.0, 1.4]
UPPER_ARM_QUAT = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]
#: Axis of the elbow in the forearm's frame, as in the source's arm.
ELBOW_AXIS = [0.0494004108, 0.036600308, 0.998108219]
ELBOW_BENT = np.pi / 2


def product(a, b):
    out = np.zeros(4)
    mujoco.mju_mulQuat(out, np.asarray(a, float), np.asarray(b, float))
    return out


def turn(axis, angle):
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * np.asarray(axis) / np.linalg.norm(axis)])


def bodies(all_bodies):
    """The upper arm and all that hangs on it; what is held has no weight that anything feels."""
    kept, names = [], {UPPER_ARM}
    for body in all_bodies:
        if body["name"] == UPPER_ARM:
            kept.append({**body, "parent": "world", "pos": UPPER_ARM_POS, "quat": UPPER_ARM_QUAT})
        elif body["parent"] in names:
            names.add(body["name"])
            if body["name"] == FOREARM:
                body = {**body, "quat": product(body["quat"], turn(ELBOW_AXIS, ELBOW_BENT))}
            kept.append(body)
    return kept


def main():
    source, mjcf = sys.argv[1:3]
    description = yaml.safe_load(Path(source).read_text())
    description.pop("looks", None)
    model = mujoco.MjModel.from_xml_path(mjcf)
    description["bodies"] = bodies(description["bodies"])
    known = {body["name"] for body in description["bodies"]}
    for key in ("joints", "sites", "wraps"):
        description[key] = [item for item in description[key] if item["body"] in known]
    joints = {joint["name"] for joint in description["joints"]}
    description["couplings"] = [item for item in description["couplings"] if item["dependent"] in joints]
    used = used_names(description["muscles"])
    description["sites"] = [site for site in description["sites"] if site["name"] in used]
    description["wraps"] = [wrap for wrap in description["wraps"] if wrap["name"] in used]
    fingertips(description, model)
    description["name"], description["source"] = "myo-hand", CITATION
    print(HEADER + to_yaml(plain(description)), end="")


if __name__ == "__main__":
    main()
