#!/usr/bin/env python3
"""Writes MyoArm (Python package myo-sim 0.2.3) in the form that Myo simulates: one right arm with a pointing hand.

    python extract.py OUT.json [--mjcf OUT.xml] [--yaml OUT.yaml] [--repairs none|mistakes|all] [--extrinsic none|all|APL,...]

Needs mujoco==4.0.0, numpy and myo-sim==0.2.3. The compiled MuJoCo model is the only source of figures, so whatever
MuJoCo's compiler defaults or balances is what Myo gets.

What happens, one function per step:
  pose         fingers are brought to a pointing hand; every other joint stands at zero
  merge        all bodies below the wrist become one body `hand`, all bodies above the clavicle one body `thorax`
  tree         bodies, joints, joint couplings in Myo's notation; the thorax is turned to Myo's world (x forward, z up)
  paths        sites and wrapping objects of the muscles that cross a free joint; stretches of a path that lie within
               one body are cut where they bend around an object, and `length_range` moves by their constant length
  repair       deviations from the source, each with its reason (`--repairs none` leaves them out)
"""
from __future__ import annotations

import argparse
import json
import warnings

import mujoco
import numpy as np

SOURCE_MODEL = "myoarm_r"
NAME = "myo-arm"
CITATION = (
    "MyoArm of myo-sim 0.2.3 (Apache-2.0, Copyright 2025 Vikash Kumar, Vittorio Caggiano; "
    "Caggiano et al. 2022, https://doi.org/10.48550/arXiv.2205.13600), after the MoBL upper-extremity model "
    "(Holzbaur et al. 2005, https://doi.org/10.1007/s10439-005-3320-7); fingers held, see NOTICE"
)

FREE = ["elv_angle_r", "shoulder_elv_r", "shoulder_rot_r", "elbow_flexion_r", "pro_sup_r", "deviation_r", "flexion_r"]
TORSO = "chest_r"  # its frame becomes the frame of `thorax`
WRIST = "lunate_r"  # its frame becomes the frame of `hand`

# Index straight, the other fingers curled into the palm, the thumb laid over them (rad). Joints not named stay at zero.
POINTING = {
    "mcp3_flexion_r": 1.20, "pm3_flexion_r": 1.50, "md3_flexion": 0.90,
    "mcp4_flexion_r": 1.25, "pm4_flexion": 1.50, "md4_flexion_r": 0.90,
    "mcp5_flexion_r": 1.30, "pm5_flexion_r": 1.50, "md5_flexion_r": 0.90,
    "cmc_flexion": 0.0, "cmc_abduction": 0.0, "mp_flexion_r": -0.60, "ip_flexion_r": -0.80,
}  # fmt: skip

# Muscles of the fingers and the thumb that start in the forearm. With the fingers held they only
# make the wrist stronger, twice as strong as people's; dropped by default (`docs/bodies.md`).
EXTRINSIC = ["FDS5", "FDS4", "FDS3", "FDS2", "FDP5", "FDP4", "FDP3", "FDP2", "EDC5", "EDC4", "EDC3", "EDC2",
             "EDM", "EIP", "EPL", "EPB", "FPL", "APL"]  # fmt: skip

# Myo's world: x forward, y left, z up. The thorax frame (OpenSim: x forward, y up, z right) stands in it like this.
THORAX_POS = [0.0, 0.0, 1.0]
THORAX_QUAT = [np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0]

FINGERTIP_BODY = "distph2_r"
FINGERTIP_SITE = "IFtip_r"
# A capsule around the last bone, from which the radius of the fingertip is taken.
FINGERTIP_GEOM = "distph2_coll_r"
# A finger yields when it touches, its joints, which are held here, and its pulp, which stiffens as it is pressed
# (Pawluk and Howe 1999, https://doi.org/10.1115/1.2800860); yet nobody comes through a plate. MuJoCo takes the mean of
# this and of what is touched.
FINGER = {"solref": [0.04, 1.0], "solimp": [0.1, 0.95, 0.003, 0.5, 2.0]}
SAME_BODY = 1e-12


# ------------------------------------------------------------------------------------------------------------ source
def load_source():
    """The compiled model and data of MyoArm."""
    import myo_sim

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return myo_sim.load(SOURCE_MODEL)


def pose(model, data):
    """Sets the pointing hand; every other joint stands at zero (couplings have no constant term)."""
    data.qpos[:] = 0.0
    for name, value in POINTING.items():
        joint = model.joint(name)
        low, high = joint.range
        if not low <= value <= high:
            raise ValueError(f"{name}: {value} lies outside its range {low} to {high}")
        data.qpos[joint.qposadr[0]] = value
    mujoco.mj_forward(model, data)


def short(name):
    """Names without the side: this arm is the right one."""
    return name.removesuffix("_r")


# ------------------------------------------------------------------------------------------------------------- merge
def descends(model, body, ancestor):
    while body > 0:
        if body == ancestor:
            return True
        body = model.body_parentid[body]
    return False


def merge(model):
    """Owner of every body: `thorax` for what does not move, `hand` for what lies below the wrist, else itself."""
    wrist = model.body(WRIST).id
    torso = model.body(TORSO).id
    owner = np.arange(model.nbody)
    for body in range(model.nbody):
        if descends(model, body, wrist):
            owner[body] = wrist
        elif model.body_weldid[body] == 0:
            owner[body] = torso
    return owner


def owner_name(model, body):
    return {TORSO: "thorax", WRIST: "hand"}.get(model.body(body).name, short(model.body(body).name))


def to_frame(data, body, point, rotation=None):
    """A world point (and rotation matrix) in the frame of a body."""
    frame = data.xmat[body].reshape(3, 3)
    local = frame.T @ (point - data.xpos[body])
    return local if rotation is None else (local, frame.T @ rotation)


def quaternion(matrix):
    quat = np.zeros(4)
    mujoco.mju_mat2Quat(quat, np.ascontiguousarray(matrix).ravel())
    return quat if quat[0] >= 0 else -quat


def composite_inertia(model, data, members, frame):
    """Mass, centre of mass, principal moments and their orientation of several bodies in the frame of one of them."""
    mass = sum(model.body_mass[b] for b in members)
    com = sum(model.body_mass[b] * data.xipos[b] for b in members) / mass
    tensor = np.zeros((3, 3))
    for b in members:
        axes = data.ximat[b].reshape(3, 3)
        arm = data.xipos[b] - com
        tensor += axes @ np.diag(model.body_inertia[b]) @ axes.T
        tensor += model.body_mass[b] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    moments, axes = np.linalg.eigh(tensor)
    moments, axes = moments[::-1], axes[:, ::-1]
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    com, axes = to_frame(data, frame, com, axes)
    return mass, com, moments, quaternion(axes)


# -------------------------------------------------------------------------------------------------------------- tree
def bodies(model, data, owner):
    result = []
    for body in range(1, model.nbody):
        if owner[body] != body:
            continue
        members = [b for b in range(model.nbody) if owner[b] == body and (b > 0)]
        if len(members) > 1:
            mass, com, inertia, axes = composite_inertia(model, data, members, body)
        else:
            mass, com = model.body_mass[body], model.body_ipos[body]
            inertia, axes = model.body_inertia[body], model.body_iquat[body]
        if model.body(body).name == TORSO:
            parent, pos, quat = "world", THORAX_POS, THORAX_QUAT
        else:
            above = owner[model.body_parentid[body]]
            parent = owner_name(model, above)
            pos, turn = to_frame(data, above, data.xpos[body], data.xmat[body].reshape(3, 3))
            pos, quat = zero_pose(model, body, above, pos, turn)
        result.append({
            "name": owner_name(model, body), "parent": parent, "pos": pos, "quat": quat,
            "mass": mass, "com": com, "inertia": inertia, "inertia_quat": axes,
        })  # fmt: skip
    return result


def zero_pose(model, body, above, pos, turn):
    """Placement of a body in its owner's frame at joint zero; exact figures of the source where nothing was merged."""
    if model.body_parentid[body] == above:
        return model.body_pos[body], model.body_quat[body]
    return pos, quaternion(turn)


def joints(model, owner):
    result = []
    for joint in range(model.njnt):
        body = model.jnt_bodyid[joint]
        if owner[body] != body:
            continue
        if model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
            raise ValueError(f"{model.joint(joint).name} is no hinge")
        dof = model.jnt_dofadr[joint]
        result.append({
            "name": short(model.joint(joint).name), "body": owner_name(model, body), "kind": "hinge",
            "axis": model.jnt_axis[joint], "pos": model.jnt_pos[joint],
            "range": model.jnt_range[joint] if model.jnt_limited[joint] else None,
            "stiffness": model.jnt_stiffness[joint], "spring_ref": model.qpos_spring[model.jnt_qposadr[joint]],
            "damping": model.dof_damping[dof], "armature": model.dof_armature[dof],
            "softness": {"solref": model.jnt_solref[joint], "solimp": model.jnt_solimp[joint]},
        })  # fmt: skip
    return result


def couplings(model):
    result = []
    for row in range(model.neq):
        if model.eq_type[row] != mujoco.mjtEq.mjEQ_JOINT:
            raise ValueError(f"{model.equality(row).name} is no joint coupling")
        result.append({
            "dependent": short(model.joint(model.eq_obj1id[row]).name),
            "independent": short(model.joint(model.eq_obj2id[row]).name),
            "polycoef": model.eq_data[row][:5],
            "softness": {"solref": model.eq_solref[row], "solimp": model.eq_solimp[row]},
        })  # fmt: skip
    return result


# ------------------------------------------------------------------------------------------------------------- paths
SITE, SPHERE, CYLINDER = (int(t) for t in (mujoco.mjtWrap.mjWRAP_SITE, mujoco.mjtWrap.mjWRAP_SPHERE,
                                           mujoco.mjtWrap.mjWRAP_CYLINDER))  # fmt: skip


def raw_path(model, tendon):
    """Elements of a tendon: ("site", id) or ("wrap", geom, side site or -1)."""
    path = []
    first = model.tendon_adr[tendon]
    for row in range(first, first + model.tendon_num[tendon]):
        kind, ident = int(model.wrap_type[row]), int(model.wrap_objid[row])
        if kind == SITE:
            path.append(("site", ident))
        elif kind in (SPHERE, CYLINDER):
            path.append(("wrap", ident, int(round(model.wrap_prm[row]))))
        else:
            raise ValueError(f"{model.tendon(tendon).name}: element of kind {kind}")
    return path


def body_of(model, owner, element):
    body = model.site_bodyid[element[1]] if element[0] == "site" else model.geom_bodyid[element[1]]
    return owner[body]


def simplify(model, owner, path):
    """The path without what never changes: wrapping objects between two sites of their own body, and whatever follows
    the first site of the last body (tendons that run on through the held fingers)."""
    kept = []
    for at, element in enumerate(path):
        if element[0] == "wrap":
            here = body_of(model, owner, element)
            if body_of(model, owner, path[at - 1]) == here == body_of(model, owner, path[at + 1]):
                continue
        kept.append(element)
    hand = model.body(WRIST).id
    while len(kept) > 1 and all(e[0] == "site" and body_of(model, owner, e) == hand for e in kept[-2:]):
        kept.pop()
    return kept


def crosses_free_joint(model, owner, path):
    return len({body_of(model, owner, e) for e in path}) > 1


def muscle_curve(prm):
    return {
        "range": prm[0:2], "force": prm[2], "scale": prm[3], "lmin": prm[4], "lmax": prm[5], "vmax": prm[6],
        "fpmax": prm[7], "fvmax": prm[8],
    }  # fmt: skip


def muscle_parameters(model, actuator):
    if (
        model.actuator_dyntype[actuator] != mujoco.mjtDyn.mjDYN_MUSCLE
        or model.actuator_gaintype[actuator] != mujoco.mjtGain.mjGAIN_MUSCLE
        or model.actuator_biastype[actuator] != mujoco.mjtBias.mjBIAS_MUSCLE
        or model.actuator_gear[actuator][0] != 1.0
        or model.actuator_forcelimited[actuator]
    ):
        raise ValueError(f"{model.actuator(actuator).name} is no plain muscle")
    dynamics = model.actuator_dynprm[actuator]
    return {
        "length_range": model.actuator_lengthrange[actuator].copy(),
        "gain": muscle_curve(model.actuator_gainprm[actuator]),
        "bias": muscle_curve(model.actuator_biasprm[actuator]),
        "tau_act": dynamics[0], "tau_deact": dynamics[1], "tau_smooth": dynamics[2],
        "ctrl_range": model.actuator_ctrlrange[actuator],
    }  # fmt: skip


def site_label(muscle, name):
    """`DELT1_DELT1-P1_r` and `FDS4-P1_r` become `DELT1-P1` and `FDS4-P1`."""
    name = short(name)
    return name.removeprefix(muscle + "_") if name.startswith(f"{muscle}_{muscle}") else name


class Places:
    """Sites and wrapping objects that the paths ask for, each written once."""

    def __init__(self, model, data, owner):
        self.model, self.data, self.owner = model, data, owner
        self.sites, self.wraps, self.site_names, self.wrap_names = [], [], {}, {}

    def site(self, ident, label):
        if ident not in self.site_names:
            if label in self.site_names.values():
                raise ValueError(f"two sites are called {label}")
            owner = self.owner[self.model.site_bodyid[ident]]
            pos = self.model.site_pos[ident]
            if owner != self.model.site_bodyid[ident]:
                pos = to_frame(self.data, owner, self.data.site_xpos[ident])
            self.site_names[ident] = label
            self.sites.append({"name": label, "body": owner_name(self.model, owner), "pos": pos})
        return self.site_names[ident]

    def wrap(self, ident):
        if ident not in self.wrap_names:
            model = self.model
            owner = self.owner[model.geom_bodyid[ident]]
            pos, quat = model.geom_pos[ident], model.geom_quat[ident]
            if owner != model.geom_bodyid[ident]:
                pos, turn = to_frame(self.data, owner, self.data.geom_xpos[ident],
                                     self.data.geom_xmat[ident].reshape(3, 3))  # fmt: skip
                quat = quaternion(turn)
            kind = {int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere", int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder"}[
                int(model.geom_type[ident])
            ]
            name = short(model.geom(ident).name).removesuffix("_wrap")
            shape = {"radius": model.geom_size[ident][0]}
            if kind == "cylinder":
                shape["half_length"] = model.geom_size[ident][1]  # for drawing only: paths see an endless cylinder
            self.wrap_names[ident] = name
            self.wraps.append({
                "name": name, "body": owner_name(model, owner), "shape": {kind: shape},
                "pos": pos, "quat": quat,
            })  # fmt: skip
        return self.wrap_names[ident]


# Which joint a muscle moves, as far as fatigue differs: of those that cross two, the one that it is known for.
GROUPS = {
    "shoulder": ["DELT1", "DELT2", "DELT3", "SUPSP", "INFSP", "SUBSC", "TMIN", "TMAJ", "PECM1", "PECM2", "PECM3", "LAT1", "LAT2",
                 "LAT3", "CORB"],
    "elbow": ["TRIlong", "TRIlat", "TRImed", "ANC", "SUP", "BIClong", "BICshort", "BRA", "BRD", "PT", "PQ"],
    "hand": ["ECRL", "ECRB", "ECU", "FCR", "FCU", "PL", *EXTRINSIC],
}


def muscles(model, data, owner, places, drop):
    """Muscles that cross a free joint, their paths and parameters; `places` collects what the paths name."""
    result = []
    for actuator in range(model.nu):
        name = model.actuator(actuator).name
        tendon = model.actuator_trnid[actuator, 0]
        whole = raw_path(model, tendon)
        if name in drop or not crosses_free_joint(model, owner, whole):
            continue
        path = []
        for element in simplify(model, owner, whole):
            if element[0] == "site":
                path.append(places.site(element[1], site_label(name, model.site(element[1]).name)))
                continue
            entry = {"over": places.wrap(element[1])}
            if element[2] >= 0:
                entry["side"] = places.site(element[2], short(model.site(element[2]).name).replace("_sidesite", "-side"))
            path.append(entry)
        group = next((group for group, names in GROUPS.items() if name in names), None)
        if group is None:
            raise ValueError(f"muscle {name} stands in none of GROUPS: say which joint it moves")
        result.append({"name": name, "path": path, **muscle_parameters(model, actuator), "group": group})
    return result


def shift_length_ranges(model, data, description):
    """Moves `length_range` by the constant length that `simplify` cut off, so that forces stay what they were.

    The constant is the difference of the whole tendon (source) and the shortened one (written model) in one posture."""
    reduced = mujoco.MjModel.from_xml_string(to_mjcf(description))
    other = mujoco.MjData(reduced)
    mujoco.mj_forward(reduced, other)
    offsets = {}
    for muscle in description["muscles"]:
        whole = data.ten_length[model.actuator_trnid[model.actuator(muscle["name"]).id, 0]]
        offset = whole - other.ten_length[reduced.tendon(muscle["name"]).id]
        if abs(offset) > 1e-9:
            muscle["length_range"] = muscle["length_range"] - offset
            offsets[muscle["name"]] = offset
    return offsets


# ------------------------------------------------------------------------------------------------------------ repair
PHANTOMS = ["clavphant", "scapphant", "humphant", "humphant1"]

# Forearm muscles whose `range` is MuJoCo's default (0.75 to 1.05), which by definition runs over the lengths that the
# joints can reach; their `length_range` was measured on the hand alone (elbow held) and does not hold for this arm.
FOREARM = ["ECRL", "ECRB", "ECU", "FCR", "FCU", "PL", "PT", "PQ", *EXTRINSIC]

# Peak forces (N) that are exactly twice those of the MoBL arm; external rotation is 1.7 times a man's with them.
DOUBLED = ["INFSP", "TMIN", "TMAJ"]


# Damping of a relaxed arm's joints (N m s/rad): Davidson and Charles 2017, doi 10.1007/s10439-016-1765-5, who take it as 0.07 s of
# the stiffness that was measured in people; read in a program, not in the paper. They have 0.756 for flexion and 0.383 for
# abduction, of which the mean is taken here, for elevation is either, by its plane; what couples joints is left out.
DAMPING = {"elv_angle": 0.52, "shoulder_elv": 0.57, "shoulder_rot": 0.52, "elbow_flexion": 0.61,
           "pro_sup": 0.02, "deviation": 0.08, "flexion": 0.03}

# Stiffness of a relaxed forearm and wrist about their middle (N m/rad), without what couples them (at most 0.29): Davidson and
# Charles 2017, doi 10.1007/s10439-016-1765-5, after Drake and Charles 2014, doi 10.1007/s10439-014-1054-0. The muscles that
# are left have next to no passive force there.
STIFFNESS = {"pro_sup": 0.756, "deviation": 2.92, "flexion": 0.992}

# A man whose upper arm and forearm together, and whose arm's mass, are these shares of stature and body mass (de Leva 1996, doi
# 10.1016/0021-9290(95)00178-6: 0.1618 and 0.1545 of stature, 0.0494 of mass).
ANTHROPOMETRY = {"sex": "male", "height_m": 1.735, "mass_kg": 76.6,
                 "upper_arm": ["humerus"], "forearm": ["ulna", "radius"], "hand": ["hand"]}


def find(items, name):
    return next(item for item in items if item["name"] == name)


def drop_from_path(description, name, *elements):
    """Takes sites and wrapping objects (by name) out of a muscle's path."""
    muscle = find(description["muscles"], name)
    muscle["path"] = [e for e in muscle["path"] if (e if isinstance(e, str) else e["over"]) not in elements]


class Probe:
    """The description as a MuJoCo model, to measure lengths in."""

    def __init__(self, description):
        self.model = mujoco.MjModel.from_xml_string(to_mjcf(description))
        self.data = mujoco.MjData(self.model)
        self.free = [self.model.joint(short(n)).id for n in FREE]

    def lengths(self, values):
        """Tendon lengths at values of the free coordinates (rad), dependents following."""
        model, data = self.model, self.data
        data.qpos[:] = 0.0
        for joint, value in zip(self.free, values):
            data.qpos[model.jnt_qposadr[joint]] = value
        for row in range(model.neq):
            leader = data.qpos[model.jnt_qposadr[model.eq_obj2id[row]]]
            data.qpos[model.jnt_qposadr[model.eq_obj1id[row]]] = np.polyval(model.eq_data[row][4::-1], leader)
        mujoco.mj_kinematics(model, data)
        mujoco.mj_tendon(model, data)
        return data.ten_length.copy()


def reached_lengths(description, draws=6000):
    """Shortest and longest length of every tendon over the joint ranges (random postures, ends of ranges favoured)."""
    probe = Probe(description)
    rng = np.random.default_rng(7)
    low, high = probe.model.jnt_range[probe.free].T
    u = rng.uniform(-0.25, 1.25, (draws, len(low))).clip(0.0, 1.0)
    lengths = np.array([probe.lengths(low + row * (high - low)) for row in u])
    return {probe.model.tendon(t).name: [lengths[:, t].min(), lengths[:, t].max()] for t in range(probe.model.ntendon)}


def supinator_onto_radius(description):
    """SUP starts where its path leaves the cylinder in full supination, instead of 4 mm before the cylinder.

    In the source the path loses the cylinder beyond 67 degrees of pronation (the wrap nears a whole turn), becomes 28 mm
    shorter and a pronator. From the new start the rest of the path is the same, without the loss."""
    probe = Probe(description)
    model, data = probe.model, probe.data
    supine = np.zeros(len(probe.free))
    at = FREE.index("pro_sup_r")
    supine[at] = model.jnt_range[probe.free[at]][0]
    probe.lengths(supine)
    tendon, radius = model.tendon("SUP").id, model.body("radius").id
    first, count = data.ten_wrapadr[tendon], data.ten_wrapnum[tendon]
    points = np.asarray(data.wrap_xpos).reshape(-1, 3)[first : first + count]
    objects = np.asarray(data.wrap_obj).ravel()[first : first + count]
    leaves = points[np.flatnonzero(objects >= 0)[-1]]
    leaves = data.xmat[radius].reshape(3, 3).T @ (leaves - data.xpos[radius])
    cylinder = find(description["wraps"], "SUP_cylinder")
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, np.array(cylinder["quat"], dtype=float))
    turn = turn.reshape(3, 3)
    local = turn.T @ (leaves - np.array(cylinder["pos"]))
    local[:2] *= (cylinder["shape"]["cylinder"]["radius"] + 2e-4) / np.linalg.norm(local[:2])
    site = find(description["sites"], "SUP-P2")
    site["pos"] = turn @ local + np.array(cylinder["pos"])
    drop_from_path(description, "SUP", "SUP-P1")
    muscle = find(description["muscles"], "SUP")
    # MuJoCo chooses the way round by the side site: it goes to where the path leaves the cylinder in neutral, which is
    # near the middle of the arc in full pronation.
    probe.lengths(np.zeros(len(probe.free)))
    leaves = np.asarray(data.wrap_xpos).reshape(-1, 3)[first : first + count][
        np.flatnonzero(np.asarray(data.wrap_obj).ravel()[first : first + count] >= 0)[-1]]  # fmt: skip
    leaves = turn.T @ (data.xmat[radius].reshape(3, 3).T @ (leaves - data.xpos[radius]) - np.array(cylinder["pos"]))
    middle = leaves[:2] * 2 * cylinder["shape"]["cylinder"]["radius"] / np.linalg.norm(leaves[:2])
    side = next(e["side"] for e in muscle["path"] if isinstance(e, dict))
    find(description["sites"], side)["pos"] = turn @ np.append(middle, local[2]) + np.array(cylinder["pos"])
    neutral = np.zeros(len(probe.free))
    muscle["length_range"] = np.array(muscle["length_range"]) - (
        probe.lengths(neutral)[tendon] - Probe(description).lengths(neutral)[tendon])  # fmt: skip


def repair(description, calibrate=True):
    """What is changed against the source, with the reason; docs/bodies.md has the figures.

    Mistakes of the source are always mended; `calibrate` also moves what is possible but not human."""
    muscles = description["muscles"]
    log, remeasure = [], []
    for name in PHANTOMS:
        find(description["bodies"], name)["inertia"] = [1e-6] * 3
        log.append(f"{name}: moments of inertia 1 -> 1e-6 kg m2; it carries joints and no anatomy")
    supraspinatus = find(muscles, "SUPSP")
    supraspinatus["gain"] = dict(supraspinatus["bias"])
    log.append("SUPSP: the gain figures are those of SUP (copied line); its own bias figures are used for both")
    point = find(description["sites"], "DELT2-P2")
    point["pos"] = np.array(point["pos"], dtype=float) * [1.0, 1.0, -1.0]
    log.append("DELT2: P2 lay 3 cm medial of the shaft; z -0.0302 -> +0.0302 (with it the path reaches 148 to 207 mm, as "
               "length_range says: 150 to 207; without it 152 to 212)")
    find(description["wraps"], "TRI_cylinder")["pos"] = np.array([0.0028, -0.2919, -0.0119])
    log.append("TRI_cylinder: z -0.4219 -> -0.0119 (lay 5.6 cm above the elbow; with it TRIlat and TRImed reach 214.7 and "
               "202.3 mm, exactly as their length_range says; without it 209.0 and 196.7)")
    drop_from_path(description, "TRIlong", "TRIlong-P1b")
    log.append("TRIlong: P1b comes within millimetres of P1 and makes it a 4 cm rotator that flips at 0 degrees; dropped "
               "(without it the path reaches 244 to 383 mm, length_range says 245 to 393; with it 281 to 421)")
    supinator_onto_radius(description)
    log.append("SUP: starts on its cylinder; the source loses the cylinder (28 mm jump) beyond 67 degrees of pronation")
    remeasure += ["LAT1", "LAT2", "LAT3"]
    log.append("LAT1, LAT2, LAT3: length_range lies beyond what the path reaches (LAT1 wholly: no force anywhere); measured")
    forearm = [m["name"] for m in muscles if m["name"] in FOREARM]
    remeasure += forearm
    log.append(f"{', '.join(forearm)}: length_range was measured with the elbow held; measured over all joints")
    if calibrate:
        for name in DOUBLED:
            for curve in ("gain", "bias"):
                muscle = find(muscles, name)
                muscle[curve] = {**muscle[curve], "force": muscle[curve]["force"] / 2}
        log.append(f"{', '.join(DOUBLED)}: peak force halved, back to the published arm")
        point = find(description["sites"], "DELT1-P3")
        point["pos"] = np.array(point["pos"], dtype=float) + [0.0, 0.02, 0.01]
        drop_from_path(description, "DELT1", "DELT1hh_ellipsoid_DELT1")
        remeasure.append("DELT1")
        log.append("DELT1: P3 20 mm up and 10 mm out, so that it goes on flexing the shoulder above 117 degrees; its sphere "
                   "never touches the path in flexion or abduction and is dropped")
        drop_from_path(description, "PT", "PT-P4")
        log.append("PT: P4 dropped (with it the pronator becomes a supinator beyond 65 degrees of pronation)")
        drop_from_path(description, "SUPSP", "SUPSP-P2")
        remeasure.append("SUPSP")
        log.append("SUPSP: P2 dropped (with it the muscle adducts above 70 degrees); the sphere guides the path")
        biceps_over_elbow(description)
        log.append("BIClong, BICshort: bend over the elbow's cylinder like BRD (their own spheres lie beside the path: moment "
                   "arm below zero at full extension); the cylinder stands at z 0.0054 instead of 0.054, square to the joint")
        for name, fpmax in SOFTER.items():
            for curve in ("gain", "bias"):
                find(muscles, name)[curve] = {**find(muscles, name)[curve], "fpmax": fpmax}
        log.append("TRIlong: fpmax 1.87 -> 0.45 (passive force up to 1.2 times the peak force in pointing postures); BRD: "
                   "fpmax 0.94 -> 0.3 (held a relaxed elbow at 47 degrees); DELT2: 1.73 -> 0.45 (held a relaxed arm up); DELT1: "
                   "0.52 -> 0.13 (held a relaxed arm 14 degrees forward, and an arm drawn back by as much with 12 N m)")
        drop_from_path(description, "DELT2", "DELT2-P2", "Deltoid2_ellipsoid_DELT2")
        remeasure.append("DELT2")
        log.append("DELT2: its side site lies inside its sphere, which therefore pulls the path towards the joint above 45 "
                   "degrees, and P2 makes it push the arm forward when abducted; both dropped, length_range measured")
        for name, wrap in IDLE:
            drop_from_path(description, name, wrap)
        log.append(f"{', '.join(n for n, _ in IDLE)}: wrapping objects that change no moment arm by more than 2 mm in any "
                   "posture (0.3 mm in pointing postures) dropped")
        for muscle in muscles:
            if muscle["name"] in FOREARM:
                muscle["gain"] = {**muscle["gain"], "vmax": 10.0, "fvmax": 1.4}
        log.append(f"{', '.join(forearm)}: vmax 1.5 -> 10, fvmax 1.2 -> 1.4 (MuJoCo's defaults in the source; all other muscles "
                   "of the arm have 10 and 1.4)")
        hand = find(description["bodies"], "hand")
        hand.update(hand_of_de_leva(hand["mass"]))
        log.append("hand: centre of mass 30 -> 64 mm from the wrist, moments of inertia to a fifth or half: by de Leva's shares for "
                   "the same mass (22 of the source's 27 bones carry 1e-4 kg m2 each for the solver's sake, and the carpals "
                   "weigh as much as the fingers)")
        for joint in description["joints"]:
            if joint["body"] in GIRDLE:
                joint["armature"] = 0.01
        log.append("joints of clavicle, scapula and the phantoms: armature 1e-4 -> 0.01 kg m2; without the phantoms' 1 kg m2 the "
                   "coupled joints would be so light that MuJoCo's soft limits and couplings give way (12 degrees at rest)")
        followers = {c["dependent"] for c in description["couplings"]}
        for joint in description["joints"]:
            if joint["name"] in followers:
                joint["range"] = None
        log.append("joints that follow another: limits dropped (the leader's limit implies them; the source's bite at 177 "
                   "degrees of elevation and lie exactly at the rest position)")
        find(description["joints"], "deviation")["range"] = np.array(DEVIATION)
        for joint in description["joints"]:
            joint["damping"] = DAMPING.get(joint["name"], 0.0)
        log.append("damping: 1.05 (shoulder), 0.75 (elbow), 0.5 (forearm) and 0.25 N m s/rad (wrist) -> 0.52 to 0.57, 0.61, 0.02, 0.03 and "
                   "0.08, as of people; the eleven joints that follow another -> 0, for they damp the same turn once more: "
                   "raising the arm met 1.6 N m s/rad, of which ten of them were 0.55")
        for name, stiffness in STIFFNESS.items():
            find(description["joints"], name)["stiffness"] = stiffness
        log.append("forearm and wrist: springs of 0.76 (turning), 2.92 (sideways) and 0.99 N m/rad, as measured in relaxed people; "
                   "without the fingers' muscles nothing held a relaxed wrist, which fell to its limits and was held against them")
        log.append("deviation: 25 degrees radial, 10 ulnar -> 20 radial, 30 ulnar; the source has it the wrong way round")
    drop_unused(description)
    reached = reached_lengths(description)
    for name in remeasure:
        find(muscles, name)["length_range"] = np.array(reached[name])
    if calibrate:
        find(description["joints"], "shoulder_elv")["range"][0] = HANGING
        log.append("shoulder_elv: from 0 -> from 10 degrees: a hanging arm lies against the trunk. Straight down, the plane in which it is "
                   "raised has no meaning, no muscle turns it, and an arm in one plane cannot be drawn back")
    return log


# Elevation of an arm that hangs beside the trunk (rad), which is not in the model. A choice, not a fit.
HANGING = 0.174532925


# Base of the middle finger (third knuckle) in the frame of the hand, posture-free (m).
KNUCKLE = np.array([0.00471, -0.08058, 0.01148])


def hand_of_de_leva(mass):
    """Centre of mass and moments of inertia of a hand of this mass (de Leva 1996, men; length = wrist to knuckle III):
    79 % from the wrist; radii of gyration 51.3 % about x (flexion), 40.1 % about y (long axis), 62.8 % about z."""
    length = np.linalg.norm(KNUCKLE)
    return {
        "com": 0.79 * KNUCKLE, "inertia": mass * (np.array([0.513, 0.401, 0.628]) * length) ** 2,
        "inertia_quat": np.array([1.0, 0.0, 0.0, 0.0]),
    }  # fmt: skip


def biceps_over_elbow(description):
    """Both heads of the biceps bend over the cylinder that BRD bends over, moved to where all three cross the elbow."""
    cylinder = find(description["wraps"], "ElbowBICBRD_ellipsoid")
    cylinder["pos"] = np.array([cylinder["pos"][0], cylinder["pos"][1], 0.0054])
    description["sites"].append({"name": "elbow-front", "body": "humerus", "pos": np.array([0.03, -0.289, -0.01])})
    for name in ("BIClong", "BICshort", "BRD"):
        for element in find(description["muscles"], name)["path"]:
            if isinstance(element, dict) and element["over"].lower().startswith(("elbow_bic", "elbowbic")):
                element.update(over=cylinder["name"], side="elbow-front")


# Bodies of the coupled joints.
GIRDLE = ["clavicle", "scapula", *PHANTOMS]

# Passive force scales that `repair` lowers.
SOFTER = {"TRIlong": 0.45, "BRD": 0.3, "DELT2": 0.45, "DELT1": 0.13}

# Wrapping objects that do next to nothing: found with wraps.py.
IDLE = [("DELT3", "delt3hum_ellipsoid_DELT3"), ("INFSP", "infsp_new_cylinder"), ("CORB", "TMAJ_LAT_PEC_CORBhh_sphere"),
        ("PQ", "PQ2")]  # fmt: skip

DEVIATION = [-0.523598776, 0.34906585]  # ulnar, radial (rad)


def drop_unused(description):
    """Sites and wrapping objects that no path names any more."""
    used = {description["landmarks"]["fingertip"]}
    for muscle in description["muscles"]:
        for element in muscle["path"]:
            used.update([element] if isinstance(element, str) else element.values())
    description["sites"] = [s for s in description["sites"] if s["name"] in used]
    description["wraps"] = [w for w in description["wraps"] if w["name"] in used]


# ------------------------------------------------------------------------------------------------------------- write
def describe(repairs="all", keep=()):
    """The whole description as a plain dictionary, and what there is to tell about it."""
    model, data = load_source()
    pose(model, data)
    owner = merge(model)
    places = Places(model, data, owner)
    paths = muscles(model, data, owner, places, [n for n in EXTRINSIC if n not in keep])
    tip = places.site(model.site(FINGERTIP_SITE).id, "fingertip")
    tip_pos = places.sites[-1]["pos"]
    description = {
        "version": 1, "name": NAME, "source": CITATION,
        "options": {"timestep": model.opt.timestep, "gravity": model.opt.gravity, "implicit_joint_damping": True},
        "landmarks": {"fingertip": tip, "shoulder": "humphant", "elbow": "ulna", "wrist": "hand"},
        "anthropometry": ANTHROPOMETRY,
        "bodies": bodies(model, data, owner), "joints": joints(model, owner), "couplings": couplings(model),
        "sites": places.sites, "wraps": places.wraps,
        "geoms": [{"name": "fingertip", "body": "hand",
                   "shape": {"sphere": {"radius": model.geom(FINGERTIP_GEOM).size[0]}}, "pos": tip_pos,
                   "margin": 0.001, "friction": [1.0, 0.005, 0.0001], "softness": FINGER}],
        "muscles": paths,
    }  # fmt: skip
    notes = {"cut_length": shift_length_ranges(model, data, description)}
    notes["repairs"] = [] if repairs == "none" else repair(description, calibrate=repairs == "all")
    return description, notes


def plain(value):
    """Numbers with nine digits, arrays as lists."""
    if isinstance(value, dict):
        return {k: plain(v) for k, v in value.items() if v is not None}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(v) for v in value]
    if isinstance(value, (float, np.floating)):
        return float(f"{value:.9g}") + 0.0
    if isinstance(value, (np.integer,)):
        return int(value)
    return value


def to_mjcf(description):
    """The same model in MuJoCo's notation; the check of this file is the check of the description."""
    import xml.etree.ElementTree as ET

    d = plain(description)
    text = lambda v: " ".join(repr(x) for x in v)  # noqa: E731
    root = ET.Element("mujoco", model=d["name"])
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    option = ET.SubElement(root, "option", timestep=repr(d["options"]["timestep"]), gravity=text(d["options"]["gravity"]))
    ET.SubElement(option, "flag", eulerdamp="enable" if d["options"]["implicit_joint_damping"] else "disable")
    world = ET.SubElement(root, "worldbody")
    nodes = {"world": world}
    for b in d["bodies"]:
        node = ET.SubElement(nodes[b["parent"]], "body", name=b["name"], pos=text(b["pos"]), quat=text(b["quat"]))
        ET.SubElement(node, "inertial", mass=repr(b["mass"]), pos=text(b["com"]), quat=text(b["inertia_quat"]),
                      diaginertia=text(b["inertia"]))  # fmt: skip
        nodes[b["name"]] = node
    for j in d["joints"]:
        attributes = {"range": text(j["range"])} if "range" in j else {}
        ET.SubElement(nodes[j["body"]], "joint", name=j["name"], type=j["kind"], axis=text(j["axis"]),
                      pos=text(j["pos"]), stiffness=repr(j["stiffness"]), springref=repr(j["spring_ref"]),
                      damping=repr(j["damping"]), armature=repr(j["armature"]),
                      solreflimit=text(j["softness"]["solref"]), solimplimit=text(j["softness"]["solimp"]),
                      **attributes)  # fmt: skip
    for w in d["wraps"]:
        (kind, size), = w["shape"].items()
        extent = " ".join(repr(v) for v in size.values())
        ET.SubElement(nodes[w["body"]], "geom", name=w["name"], type=kind, size=extent, pos=text(w["pos"]),
                      quat=text(w["quat"]), contype="0", conaffinity="0", group="3", rgba="0.2 0.8 0.8 0.2")  # fmt: skip
    for g in d["geoms"]:
        ET.SubElement(nodes[g["body"]], "geom", name=g["name"] + "-skin", type="sphere",
                      size=repr(g["shape"]["sphere"]["radius"]), pos=text(g["pos"]), margin=repr(g["margin"]),
                      friction=text(g["friction"]), solref=text(g["softness"]["solref"]),
                      solimp=text(g["softness"]["solimp"]))  # fmt: skip
    for s in d["sites"]:
        ET.SubElement(nodes[s["body"]], "site", name=s["name"], pos=text(s["pos"]), size="0.002")
    equality = ET.SubElement(root, "equality")
    for c in d["couplings"]:
        ET.SubElement(equality, "joint", joint1=c["dependent"], joint2=c["independent"], polycoef=text(c["polycoef"]),
                      solref=text(c["softness"]["solref"]), solimp=text(c["softness"]["solimp"]))  # fmt: skip
    tendons, actuators = ET.SubElement(root, "tendon"), ET.SubElement(root, "actuator")
    for m in d["muscles"]:
        tendon = ET.SubElement(tendons, "spatial", name=m["name"])
        for element in m["path"]:
            if isinstance(element, str):
                ET.SubElement(tendon, "site", site=element)
            else:
                side = {"sidesite": element["side"]} if "side" in element else {}
                ET.SubElement(tendon, "geom", geom=element["over"], **side)
        curve = lambda c: text([*c["range"], c["force"], c["scale"], c["lmin"], c["lmax"], c["vmax"], c["fpmax"],  # noqa: E731
                                c["fvmax"]])  # fmt: skip
        ET.SubElement(actuators, "general", name=m["name"], tendon=m["name"], dyntype="muscle", gaintype="muscle",
                      biastype="muscle", dynprm=text([m["tau_act"], m["tau_deact"], m["tau_smooth"]]),
                      gainprm=curve(m["gain"]), biasprm=curve(m["bias"]), lengthrange=text(m["length_range"]),
                      ctrlrange=text(m["ctrl_range"]), ctrllimited="true")  # fmt: skip
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


DEFAULTS = {
    "quat": [1.0, 0.0, 0.0, 0.0], "inertia_quat": [1.0, 0.0, 0.0, 0.0], "com": [0.0, 0.0, 0.0], "stiffness": 0.0,
    "spring_ref": 0.0, "damping": 0.0, "armature": 0.0, "tau_smooth": 0.0, "ctrl_range": [0.0, 1.0],
    "softness": {"solref": [0.02, 1.0], "solimp": [0.9, 0.95, 0.001, 0.5, 2.0]},
}  # fmt: skip


def flow(value):
    """A value on one line of YAML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(flow(v) for v in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        text = repr(value)
        return text if "." in text else text.replace("e", ".0e")
    return str(value)


def to_yaml(description):
    """The description in the notation of Myo's model files: one element a line, defaults left out."""
    lines = []
    for key, value in plain(description).items():
        if isinstance(value, list):
            lines += ["", f"{key}:"]
            for item in value:
                # `pos` of a body has no default.
                short_item = {k: v for k, v in item.items() if v != DEFAULTS.get(k, v is None)}
                if key in ("joints", "geoms", "wraps") and short_item.get("pos") == [0.0, 0.0, 0.0]:
                    del short_item["pos"]
                lines.append(f"  - {flow(short_item)}")
        elif key == "source":
            lines.append(f"{key}: {json.dumps(value)}")
        else:
            lines.append(f"{key}: {flow(value)}")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", help="JSON file to write")
    parser.add_argument("--mjcf", help="also write the model as MJCF")
    parser.add_argument("--yaml", help="also write the model in the notation of Myo's model files")
    parser.add_argument("--repairs", choices=["none", "mistakes", "all"], default="all", help="what to mend (default: all)")
    parser.add_argument("--extrinsic", default="none", help="forearm muscles of fingers and thumb to keep: names with "
                        "commas, `all` or `none` (default: none)")  # fmt: skip
    options = parser.parse_args()
    keep = {"all": EXTRINSIC, "none": []}.get(options.extrinsic, options.extrinsic.split(","))
    description, notes = describe(options.repairs, keep)
    with open(options.out, "w", encoding="utf-8") as file:
        json.dump(plain(description), file, indent=1)
        file.write("\n")
    if options.mjcf:
        with open(options.mjcf, "w", encoding="utf-8") as file:
            file.write(to_mjcf(description))
    if options.yaml:
        with open(options.yaml, "w", encoding="utf-8") as file:
            file.write(to_yaml(description))
    wraps = [e for m in description["muscles"] for e in m["path"] if isinstance(e, dict)]
    print(f"{len(description['bodies'])} bodies, {len(description['joints'])} joints, "
          f"{len(description['couplings'])} couplings, {len(description['sites'])} sites, "
          f"{len(description['wraps'])} wrapping objects, {len(description['muscles'])} muscles, "
          f"{len(wraps)} wrapped segments ({sum('side' in w for w in wraps)} with a side site)")  # fmt: skip
    for line in notes["repairs"]:
        print("repair:", line)
    for name, length in notes["cut_length"].items():
        print(f"cut: {name} {length:.6f} m")


if __name__ == "__main__":
    main()
