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
from extract import FINGER, plain, to_yaml

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
#: Finger, site of its tip, its last bone, the source's capsule around that.
FINGERS = {
    "index": ("IFtip_r", "distph2_r", "distph2_coll_r"),
    "little": ("LFtip_r", "distph5_r", "5distph_coll_r"),
    "middle": ("MFtip_r", "distph3_r", "distph3_coll_r"),
    "ring": ("RFtip_r", "distph4_r", "distph4_coll_r"),
    "thumb": ("THtip_r", "distal_thumb_r", "distal_thumb_coll_r"),
}
#: Which finger points where a task does not say.
POINTS = "index"
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


def tips(model):
    """The balls that press, and the capsules that do not pass through each other."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    balls, capsules = [], []
    for finger, (site, bone, capsule) in FINGERS.items():
        geom, body = model.geom(capsule), model.body(bone)
        if model.geom_bodyid[geom.id] != body.id or model.geom_type[geom.id] != mujoco.mjtGeom.mjGEOM_CAPSULE:
            raise SystemExit(f"{capsule} is no capsule around {bone}")
        radius, half = model.geom_size[geom.id][:2]
        axis = np.zeros(9)
        mujoco.mju_quat2Mat(axis, model.geom_quat[geom.id])
        along = axis.reshape(3, 3)[:, 2] * half
        pos = model.geom_pos[geom.id]
        # Of both ends the one at the tip.
        end = min((pos + along, pos - along), key=lambda end: np.linalg.norm(end - model.site(site).pos))
        common = {"body": bone, "margin": 0.001, "friction": [1.0, 0.005, 0.0001], "softness": FINGER}
        balls.append({"name": f"{finger}_tip", **common, "shape": {"sphere": {"radius": radius}}, "pos": end})
        shape = {"capsule": {"radius": radius, "half_length": half}}
        capsules.append({"name": f"{finger}_pad", **common, "shape": shape, "pos": pos, "quat": model.geom_quat[geom.id]})
    return balls, capsules


def main():
    source, mjcf = sys.argv[1:3]
    description = yaml.safe_load(Path(source).read_text())
    model = mujoco.MjModel.from_xml_path(mjcf)
    description["bodies"] = bodies(description["bodies"])
    known = {body["name"] for body in description["bodies"]}
    for key in ("joints", "sites", "wraps"):
        description[key] = [item for item in description[key] if item["body"] in known]
    joints = {joint["name"] for joint in description["joints"]}
    description["couplings"] = [item for item in description["couplings"] if item["dependent"] in joints]
    used = {name for muscle in description["muscles"] for element in muscle["path"] for name in names_in(element)}
    description["sites"] = [site for site in description["sites"] if site["name"] in used]
    description["wraps"] = [wrap for wrap in description["wraps"] if wrap["name"] in used]
    balls, capsules = tips(model)
    description["sites"] += [{key: ball[key] for key in ("name", "body", "pos")} for ball in balls]
    description["geoms"] = capsules + balls
    description["contacts"] = [
        {"geoms": ["thumb_pad", pad["name"]], "margin": 0.001, "friction": 1.0, "softness": FINGER}
        for pad in capsules
        if pad["name"] != "thumb_pad"
    ]
    description["name"], description["source"] = "myo-hand", CITATION
    others = {finger: f"{finger}_tip" for finger in FINGERS if finger != POINTS}
    description["landmarks"] = {**description["landmarks"], "fingertip": f"{POINTS}_tip", "fingers": others}
    print(HEADER + to_yaml(plain(description)), end="")


def names_in(element):
    """Names of sites and round things in an element of a path."""
    if isinstance(element, str):
        return [element]
    return [name for name in element.values() if isinstance(name, str)]


if __name__ == "__main__":
    main()
