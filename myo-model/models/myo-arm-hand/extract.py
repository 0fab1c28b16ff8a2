#!/usr/bin/env python3
"""Writes MyoArm (Python package myo-sim 0.2.3) with all its fingers free: the arm of `myo-arm` and the hand of `myo-hand`.

    myo model import myoarm_r.xml --fingertip IFtip_r --shoulder humerus_r --out FILE.yaml
    python extract.py FILE.yaml myoarm_r.xml > ../myo-arm-hand.yaml

Needs mujoco==4.0.0, numpy and PyYAML; `myoarm_r.xml` is the model of `myo_sim` as MuJoCo saves it. What is changed:

  arm        shoulder, elbow, forearm and wrist, their joints and muscles are those of myo-arm, with all that was mended
             there: how the arm hangs, how its joints are damped, which way muscles run
  hand       bones below the wrist, joints of the fingers and the 31 muscles that move them are the source's; the muscles
             that begin at the upper arm cross its elbow
  fingertips balls that press and pads that do not pass through each other, as in myo-hand
  names      without the side

The wrist keeps the springs that myo-arm has in place of the muscles of the fingers, though these are here: they hold a
relaxed wrist less than people's does (`docs/bodies.md`).
"""

from __future__ import annotations

import sys
from pathlib import Path

import mujoco
import yaml

MODELS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(MODELS / "myo-arm"), str(MODELS / "myo-hand")]
from extract import plain, short, to_yaml
from fingertips import fingertips, used_names

HEADER = """\
# A human right arm with shoulder girdle, elbow, forearm, wrist and hand: all fingers move, each may point, press and pinch.
# Made of MyoArm of the package myo-sim 0.2.3 by myo-arm-hand/extract.py, which lists every change.
# Licensed under the Apache Licence 2.0 alone; see NOTICE.
# World: x forward, y to the left, z up. Metres, kilograms, seconds, newtons, radians; quaternions are w, x, y, z.
# A field that is left out has the default that the format documents (for example `pos: [0, 0, 0]`).
"""
CITATION = (
    "MyoArm of myo-sim 0.2.3 (Apache-2.0, Copyright 2025 Vikash Kumar, Vittorio Caggiano; "
    "Caggiano et al. 2022, https://doi.org/10.48550/arXiv.2205.13600), after the MoBL upper-extremity model "
    "(Holzbaur et al. 2005, https://doi.org/10.1007/s10439-005-3320-7); arm as in myo-arm, fingertips added, see NOTICE"
)
#: The bone whose frame is that of `hand` in myo-arm.
WRIST, HAND = "lunate", "hand"


def name_of(name):
    """The name of a part of the source in what is made."""
    name = short(name)
    return HAND if name == WRIST else name


def renamed(item):
    """A part whose own name, and those that it refers to, are what they are here."""
    if isinstance(item, list):
        return [renamed(element) for element in item]
    if isinstance(item, dict):
        return {key: renamed(value) for key, value in item.items()}
    return name_of(item) if isinstance(item, str) else item


def below_wrist(bodies):
    """The bodies of the hand, first that at the wrist."""
    names, kept = {HAND}, []
    for body in bodies:
        if body["name"] in names or body["parent"] in names:
            names.add(body["name"])
            kept.append(body)
    return kept


def with_hand(arm, hand):
    """The arm of one description with the hand of the other."""
    bodies = below_wrist(hand["bodies"])
    fingers = {body["name"] for body in bodies} - {HAND}
    muscles = {muscle["name"] for muscle in arm["muscles"]}
    new = [{**muscle, "group": "hand"} for muscle in hand["muscles"] if muscle["name"] not in muscles]
    used = used_names(new)
    arm["bodies"] = [body for body in arm["bodies"] if body["name"] != HAND] + bodies
    arm["joints"] += [joint for joint in hand["joints"] if joint["body"] in fingers]
    arm["muscles"] += new
    for key in ("sites", "wraps"):
        there = {item["name"] for item in arm[key]}
        arm[key] += [item for item in hand[key] if item["name"] in used and item["name"] not in there]
    arm["anthropometry"]["hand"] += sorted(fingers)
    return arm


def main():
    source, mjcf = sys.argv[1:3]
    description = yaml.safe_load((MODELS / "myo-arm.yaml").read_text())
    hand = yaml.safe_load(Path(source).read_text())
    hand = {key: renamed(hand[key]) for key in ("bodies", "joints", "sites", "wraps", "muscles")}
    description = with_hand(description, hand)
    description["sites"] = [site for site in description["sites"] if site["name"] != "fingertip"]
    fingertips(description, mujoco.MjModel.from_xml_path(mjcf), name_of)
    description["name"], description["source"] = "myo-arm-hand", CITATION
    print(HEADER + to_yaml(plain(description)), end="")


if __name__ == "__main__":
    main()
