"""Fingertips of MyoHand and MyoArm as Myo ships them: balls that press, and pads that do not pass through each other."""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "myo-arm"))
from extract import FINGER

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


def fingertips(description, model, name=lambda name: name):
    """Adds fingertips to a description, whose bodies may have other names than the model's."""
    balls, capsules = tips(model)
    for item in balls + capsules:
        item["body"] = name(item["body"])
    description["sites"] += [{key: ball[key] for key in ("name", "body", "pos")} for ball in balls]
    description["geoms"] = capsules + balls
    description["contacts"] = [
        {"geoms": ["thumb_pad", pad["name"]], "margin": 0.001, "friction": 1.0, "softness": FINGER}
        for pad in capsules
        if pad["name"] != "thumb_pad"
    ]
    others = {finger: f"{finger}_tip" for finger in FINGERS if finger != POINTS}
    description["landmarks"] = {**description["landmarks"], "fingertip": f"{POINTS}_tip", "fingers": others}


def used_names(muscles):
    """Names of sites and round things in the paths of muscles."""
    return {name for muscle in muscles for element in muscle["path"] for name in names_in(element)}


def names_in(element):
    """Names of sites and round things in an element of a path."""
    if isinstance(element, str):
        return [element]
    return [name for name in element.values() if isinstance(name, str)]
