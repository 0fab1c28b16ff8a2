#!/usr/bin/env python3
"""How little effort holds the fingertip at a point, whatever the posture, and how a relaxed arm hangs.

    myo model export myo-arm --out arm.xml
    python3 benches/least_effort.py arm.xml 0.35,0,-0.35 0.55,0,0 [--set DELT1=0.518]

A point is relative to the shoulder (m; x forward, y left, z up). Of postures that bring the fingertip there, found from
random ones, the row tells the one with the least mean squared activation that balances gravity and passive forces at
every joint, and its angles (degrees). Limits of joints help for nothing. `--set` gives the passive force of a muscle
another scale (`fpmax`). Needs mujoco and scipy.
"""

import argparse

import mujoco
import numpy as np
from scipy.optimize import least_squares, lsq_linear

JOINTS = ("elv_angle", "shoulder_elv", "shoulder_rot", "elbow_flexion", "pro_sup", "deviation", "flexion")
#: Activations that leave more torque than this unbalanced (N m) do not hold the arm.
UNBALANCED = 0.1
#: A posture whose fingertip is farther away than this (m) does not reach the point.
OFF = 0.01
#: Postures from which the search begins are drawn from this share of the range of each joint, from its lower limit.
DRAWN = np.array([1.0, 0.4, 1.0, 1.0, 1.0, 0.3, 0.3])
#: How much more a torque that is left unbalanced (N m) weighs than activation.
WEIGHT = 100
#: How long the relaxed arm is given to come to rest (s).
REST_S = 10


class Arm:
    """MuJoCo's model with its coupled joints."""

    def __init__(self, path):
        self.model = model = mujoco.MjModel.from_xml_path(path)
        self.data = mujoco.MjData(model)
        joints = [model.joint(name) for name in JOINTS]
        self.qpos = [joint.qposadr[0] for joint in joints]
        self.dof = [joint.dofadr[0] for joint in joints]
        self.lower, self.upper = np.array([joint.range for joint in joints]).T
        self.couplings = [
            (model.eq_obj1id[i], model.eq_obj2id[i], np.polynomial.Polynomial(model.eq_data[i, :5]))
            for i in range(model.neq)
            if model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT
        ]
        self.pose(np.clip(np.zeros(len(JOINTS)), self.lower, self.upper))
        self.shoulder = self.data.body("humphant").xpos.copy()

    def pose(self, angles):
        """Free joints at these angles (rad), coupled ones where they belong, muscles relaxed."""
        model, data = self.model, self.data
        mujoco.mj_resetData(model, data)
        data.qpos[self.qpos] = angles
        for dependent, independent, law in self.couplings:
            data.qpos[model.jnt_qposadr[dependent]] = law(data.qpos[model.jnt_qposadr[independent]])
        mujoco.mj_forward(model, data)

    def along_couplings(self):
        """Velocities of all joints for each of the free ones."""
        model, data = self.model, self.data
        moves = np.zeros((model.nv, len(JOINTS)))
        moves[self.dof, range(len(JOINTS))] = 1
        for dependent, independent, law in self.couplings:
            slope = law.deriv()(data.qpos[model.jnt_qposadr[independent]])
            moves[model.jnt_dofadr[dependent]] += slope * moves[model.jnt_dofadr[independent]]
        return moves

    def effort(self, angles):
        """Least mean squared activation that holds this posture; infinite where muscles cannot."""
        model, data = self.model, self.data
        self.pose(angles)
        moves = self.along_couplings()
        arms = np.zeros((model.nu, model.nv))
        mujoco.mju_sparse2dense(
            arms, data.actuator_moment.ravel(), data.moment_rownnz, data.moment_rowadr, data.moment_colind
        )
        passive = data.actuator_force.copy()
        data.act[:] = 1
        mujoco.mj_fwdActuation(model, data)
        active = (arms @ moves).T * (data.actuator_force - passive)
        asked = moves.T @ (data.qfrc_bias - data.qfrc_passive) - (arms @ moves).T @ passive
        rows, sides = np.vstack([WEIGHT * active, np.eye(model.nu)]), np.append(WEIGHT * asked, np.zeros(model.nu))
        activation = lsq_linear(rows, sides, bounds=(0, 1)).x
        holds = np.abs(active @ activation - asked).max() < UNBALANCED
        return np.mean(activation**2) if holds else np.inf

    def reach(self, place, start):
        """Angles near `start` that bring the fingertip to a place, and how far off it is left (m)."""

        def off(angles):
            self.pose(angles)
            return self.data.site("fingertip").xpos - place

        inside = np.clip(start, self.lower + 1e-3, self.upper - 1e-3)
        found = least_squares(
            lambda a: np.append(10 * off(a), 1e-3 * (a - start)), inside, bounds=(self.lower, self.upper)
        )
        return found.x, np.linalg.norm(off(found.x))

    def hang(self):
        """Angles of the upper arm of the relaxed arm at rest, forward and outward of straight down, and its elbow's."""
        self.pose(np.clip(np.radians([45, 20, 0, 30, 0, 0, 0]), self.lower, self.upper))
        for _ in range(round(REST_S / self.model.opt.timestep)):
            mujoco.mj_step(self.model, self.data)
        forward, left, up = self.data.body("ulna").xpos - self.data.body("humphant").xpos
        return np.degrees([np.arctan2(forward, -up), np.arctan2(-left, -up), self.data.qpos[self.qpos[3]]])


def main():
    """Prints how the arm hangs and a row for each point."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", help="MJCF of the arm")
    parser.add_argument("points", nargs="*", metavar="X,Y,Z")
    parser.add_argument("--set", action="append", default=[], metavar="MUSCLE=FPMAX")
    parser.add_argument("--tries", type=int, default=40)
    given = parser.parse_args()
    arm = Arm(given.model)
    for name, fpmax in (change.split("=") for change in given.set):
        muscle = arm.model.actuator(name).id
        arm.model.actuator_biasprm[muscle, 7] = float(fpmax)
    forward, outward, elbow = arm.hang()
    print(f"hangs {forward:.1f} degrees forward and {outward:.1f} outward, elbow bent by {elbow:.0f}")
    for point in given.points:
        place, random = arm.shoulder + np.array([float(x) for x in point.split(",")]), np.random.default_rng(0)
        found = []
        for _ in range(given.tries):
            start = arm.lower + DRAWN * random.random(len(JOINTS)) * (arm.upper - arm.lower)
            angles, off = arm.reach(place, start)
            found.append((arm.effort(angles) if off < OFF else np.inf, tuple(np.degrees(angles).round())))
        effort, angles = min(found)
        says = ", ".join(f"{name} {angle:.0f}" for name, angle in zip(JOINTS, angles, strict=True))
        print(f"{point}: effort {effort:.5f} with {says}" if np.isfinite(effort) else f"{point}: cannot be held")


if __name__ == "__main__":
    main()
