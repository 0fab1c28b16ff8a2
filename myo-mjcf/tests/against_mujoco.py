"""Compares what the reader says of models with what MuJoCo makes of them.

usage: python tests/against_mujoco.py DUMP [--root FOLDER] [--assets FOLDER] MODEL.xml ...

DUMP is the built example `dump`. FOLDER after --root is the one that no include may leave. FOLDER after --assets is where
folders of meshes and textures are, for models that look for them elsewhere. MuJoCo 4.0 is tested.
"""

import re
import subprocess
import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

import mujoco
import numpy as np

TOLERANCE = 1e-12
JOINT_TYPES = "free ball slide hinge".split()
GEOM_TYPES = "plane hfield sphere capsule ellipsoid cylinder box mesh sdf".split()
DYN = "none integrator filter filterexact muscle dcmotor pid user".split()
GAIN = "fixed affine muscle dcmotor so3 pid user".split()
BIAS = "none affine muscle dcmotor so3 user".split()


class Report:
    def __init__(self):
        self.compared, self.wrong, self.largest = Counter(), [], 0.0

    def same(self, what, ours, theirs):
        self.compared[what.split("[")[0] + "." + what.split(".")[-1]] += 1
        if ours != theirs:
            self.wrong.append(f"{what}: {ours!r}, MuJoCo {theirs!r}")

    def close(self, what, ours, theirs, tolerance=TOLERANCE):
        ours, theirs = np.atleast_1d(np.asarray(ours, float)), np.atleast_1d(np.asarray(theirs, float))
        self.compared[what.split("[")[0] + "." + what.split(".")[-1]] += 1
        if ours.shape != theirs.shape:
            self.wrong.append(f"{what}: {ours}, MuJoCo {theirs}")
            return
        error = float(np.max(np.abs(ours - theirs) / np.maximum(1.0, np.abs(theirs)), initial=0.0))
        if error > tolerance:
            self.wrong.append(f"{what}: {ours}, MuJoCo {theirs}")
        elif tolerance == TOLERANCE:
            self.largest = max(self.largest, error)


def dump(program, path, root):
    command = [program, str(path)] + ([root] if root else [])
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    elements = defaultdict(lambda: defaultdict(dict))
    for line in lines:
        kind, index, name, field, value = line.split("\t")
        elements[kind][int(index)].update({"name": name, field: value})
    return elements


def numbers(text):
    return np.array([float(word) for word in text.split()])


def without_repeated_classes(text):
    """MuJoCo cannot read what it saves of some models: a class is there twice. The second one goes."""
    seen = set()

    def once(match):
        new = match.group(1) not in seen
        seen.add(match.group(1))
        return match.group(0) if new else ""

    return re.sub(r'^    <default class="([^"]*)">\n.*?^    </default>\n', once, text, flags=re.M | re.S)


def load(path, assets):
    spec = mujoco.MjSpec.from_file(str(path))
    if assets:
        for asset in [*spec.meshes, *spec.textures, *spec.hfields]:
            folder = spec.texturedir if isinstance(asset, mujoco.MjsTexture) else spec.meshdir
            names = [name for name in f"{folder}/{asset.file}".split("/") if name not in ("", ".", "..")]
            # Wherever it looks for the file, the end of the path is right.
            places = [Path(assets, *names[start:]).resolve() for start in range(len(names))]
            asset.file = next((str(place) for place in places if place.is_file()), asset.file)
        spec.meshdir = spec.texturedir = ""
    return spec, spec.compile()


def in_frame(pos, quat, inner_pos, inner_quat):
    moved, turned = np.zeros(3), np.zeros(4)
    mujoco.mju_rotVecQuat(moved, inner_pos, quat)
    mujoco.mju_mulQuat(turned, quat, inner_quat)
    return pos + moved, turned


def bodies(report, elements, model, spec):
    bound_mass, bound_inertia = spec.compiler.boundmass, spec.compiler.boundinertia
    for index, body in elements["body"].items():
        what = f"body[{body['name'] or index}]"
        report.same(f"{what}.name", body["name"], model.body(index).name)
        report.same(f"{what}.parent", int(float(body["parent"])), int(model.body_parentid[index]))
        report.close(f"{what}.pos", numbers(body["pos"]), model.body_pos[index])
        report.close(f"{what}.quat", numbers(body["quat"]), model.body_quat[index])
        report.close(f"{what}.gravcomp", numbers(body["gravcomp"]), model.body_gravcomp[index])
        if "mass" in body and not spec.compiler.inertiafromgeom == 1:
            mass = max(float(body["mass"]), bound_mass)
            report.close(f"{what}.mass", mass, model.body_mass[index])
            report.close(f"{what}.ipos", numbers(body["ipos"]), model.body_ipos[index])
            if "inertia" in body:
                inertia = np.maximum(numbers(body["inertia"]), bound_inertia)
                report.close(f"{what}.inertia", inertia, model.body_inertia[index])
                report.close(f"{what}.iquat", numbers(body["iquat"]), model.body_iquat[index])


def joints(report, elements, model):
    for index, joint in elements["joint"].items():
        what, dof, qpos = f"joint[{joint['name'] or index}]", model.jnt_dofadr[index], model.jnt_qposadr[index]
        kind = JOINT_TYPES[model.jnt_type[index]]
        report.same(f"{what}.name", joint["name"], model.joint(index).name)
        report.same(f"{what}.type", joint["type"], kind)
        report.same(f"{what}.body", int(float(joint["body"])), int(model.jnt_bodyid[index]))
        if kind != "free":
            report.close(f"{what}.pos", numbers(joint["pos"]), model.jnt_pos[index])
            limited = float(joint["limited"])
            report.close(f"{what}.limited", limited, model.jnt_limited[index])
            # MuJoCo leaves the range of a joint without limits in degrees.
            if limited:
                report.close(f"{what}.range", numbers(joint["range"]), model.jnt_range[index])
        if kind in ("slide", "hinge"):
            axis = numbers(joint["axis"])
            report.close(f"{what}.axis", axis / np.linalg.norm(axis), model.jnt_axis[index])
            report.close(f"{what}.ref", float(joint["ref"]), model.qpos0[qpos])
            report.close(f"{what}.springref", float(joint["springref"]), model.qpos_spring[qpos])
            if not numbers(joint["springdamper"]).any():
                stiffness, damping = numbers(joint["stiffness"]), numbers(joint["damping"])
                report.close(f"{what}.stiffness", stiffness, [model.jnt_stiffness[index], *model.jnt_stiffnesspoly[index]])
                report.close(f"{what}.damping", damping, [model.dof_damping[dof], *model.dof_dampingpoly[dof]])
        report.close(f"{what}.armature", float(joint["armature"]), model.dof_armature[dof])
        report.close(f"{what}.frictionloss", float(joint["frictionloss"]), model.dof_frictionloss[dof])
        report.close(f"{what}.margin", float(joint["margin"]), model.jnt_margin[index])
        report.close(f"{what}.group", float(joint["group"]), model.jnt_group[index])
        report.close(f"{what}.solreflimit", numbers(joint["solreflimit"]), model.jnt_solref[index])
        report.close(f"{what}.solimplimit", numbers(joint["solimplimit"]), model.jnt_solimp[index])
        report.close(f"{what}.solreffriction", numbers(joint["solreffriction"]), model.dof_solref[dof])
        report.close(f"{what}.solimpfriction", numbers(joint["solimpfriction"]), model.dof_solimp[dof])
        user = numbers(joint["user"])
        report.close(f"{what}.user", user, model.jnt_user[index][: len(user)])


def pose_of_mesh(report, what, geom, model, index):
    mesh = model.geom_dataid[index]
    pos, quat = in_frame(numbers(geom["pos"]), numbers(geom["quat"]), model.mesh_pos[mesh], model.mesh_quat[mesh])
    report.same(f"{what}.mesh", geom["mesh"], model.mesh(mesh).name)
    # The frame of a mesh has the precision of its own computation.
    report.close(f"{what}.meshpos", pos, model.geom_pos[index], 1e-9)
    report.close(f"{what}.meshquat", quat, model.geom_quat[index], 1e-9)


def geoms(report, elements, model):
    for index, geom in elements["geom"].items():
        what = f"geom[{geom['name'] or index}]"
        report.same(f"{what}.name", geom["name"], model.geom(index).name)
        report.same(f"{what}.type", geom["type"], GEOM_TYPES[model.geom_type[index]])
        report.same(f"{what}.body", int(float(geom["body"])), int(model.geom_bodyid[index]))
        if geom["mesh"] and geom["type"] == "mesh":
            pose_of_mesh(report, what, geom, model, index)
        elif not geom["mesh"]:
            report.close(f"{what}.pos", numbers(geom["pos"]), model.geom_pos[index])
            report.close(f"{what}.quat", numbers(geom["quat"]), model.geom_quat[index])
            if geom["type"] not in ("plane", "hfield"):
                count = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(geom["type"], 3)
                report.close(f"{what}.size", numbers(geom["size"])[:count], model.geom_size[index][:count])
        contact = [model.geom_contype, model.geom_conaffinity, model.geom_condim, model.geom_priority]
        report.close(f"{what}.contact", numbers(geom["contact"]), [array[index] for array in contact])
        report.close(f"{what}.friction", numbers(geom["friction"]), model.geom_friction[index])
        report.close(f"{what}.solref", numbers(geom["solref"]), model.geom_solref[index])
        report.close(f"{what}.solimp", numbers(geom["solimp"]), model.geom_solimp[index])
        scalars = [model.geom_solmix[index], model.geom_margin[index], model.geom_gap[index]]
        report.close(f"{what}.scalars", numbers(geom["scalars"]), scalars)
        report.close(f"{what}.group", float(geom["group"]), model.geom_group[index])
        material = model.geom_matid[index]
        report.same(f"{what}.material", geom["material"], model.mat(material).name if material >= 0 else "")
        if material < 0:
            report.close(f"{what}.rgba", numbers(geom["rgba"]), model.geom_rgba[index], 1e-6)


def sites(report, elements, model):
    for index, site in elements["site"].items():
        what = f"site[{site['name'] or index}]"
        report.same(f"{what}.name", site["name"], model.site(index).name)
        report.same(f"{what}.type", site["type"], GEOM_TYPES[model.site_type[index]])
        report.same(f"{what}.body", int(float(site["body"])), int(model.site_bodyid[index]))
        report.close(f"{what}.pos", numbers(site["pos"]), model.site_pos[index])
        report.close(f"{what}.quat", numbers(site["quat"]), model.site_quat[index])
        report.close(f"{what}.size", numbers(site["size"]), model.site_size[index])
        report.close(f"{what}.group", float(site["group"]), model.site_group[index])
        if model.site_matid[index] < 0:
            report.close(f"{what}.rgba", numbers(site["rgba"]), model.site_rgba[index], 1e-6)


def path_of(model, tendon):
    path, start = [], model.tendon_adr[tendon]
    for wrap in range(start, start + model.tendon_num[tendon]):
        kind, target, parameter = model.wrap_type[wrap], model.wrap_objid[wrap], model.wrap_prm[wrap]
        if kind == mujoco.mjtWrap.mjWRAP_JOINT:
            path.append(f"joint:{model.joint(target).name}:{float(parameter)!r}")
        elif kind == mujoco.mjtWrap.mjWRAP_PULLEY:
            path.append(f"pulley:{float(parameter)!r}")
        elif kind == mujoco.mjtWrap.mjWRAP_SITE:
            path.append(f"site:{model.site(target).name}")
        else:
            path.append(f"geom:{model.geom(target).name}:{model.site(int(parameter)).name if parameter >= 0 else ''}")
    return " ".join(path)


def tendons(report, elements, model):
    for index, tendon in elements["tendon"].items():
        what = f"tendon[{tendon['name'] or index}]"
        report.same(f"{what}.name", tendon["name"], model.tendon(index).name)
        report.same(f"{what}.path", tendon["path"], path_of(model, index))
        report.close(f"{what}.limited", float(tendon["limited"]), model.tendon_limited[index])
        report.close(f"{what}.range", numbers(tendon["range"]), model.tendon_range[index])
        stiffness = [model.tendon_stiffness[index], *model.tendon_stiffnesspoly[index]]
        report.close(f"{what}.stiffness", numbers(tendon["stiffness"]), stiffness)
        damping = [model.tendon_damping[index], *model.tendon_dampingpoly[index]]
        report.close(f"{what}.damping", numbers(tendon["damping"]), damping)
        # -1 becomes the length in the reference pose.
        spring = numbers(tendon["springlength"])
        if spring[0] != -1:
            report.close(f"{what}.springlength", spring, model.tendon_lengthspring[index])
        scalars = [model.tendon_frictionloss, model.tendon_margin, model.tendon_width, model.tendon_group]
        report.close(f"{what}.scalars", numbers(tendon["scalars"]), [float(array[index]) for array in scalars], 1e-7)
        report.close(f"{what}.solreflimit", numbers(tendon["solreflimit"]), model.tendon_solref_lim[index])
        report.close(f"{what}.solimplimit", numbers(tendon["solimplimit"]), model.tendon_solimp_lim[index])


def target_of(model, actuator):
    kind, target = model.actuator_trntype[actuator], model.actuator_trnid[actuator][0]
    name = {0: "joint", 1: "jointinparent", 2: "cranksite", 3: "tendon", 4: "site", 5: "body"}[int(kind)]
    lists = {"joint": model.joint, "jointinparent": model.joint, "tendon": model.tendon, "body": model.body}
    return f"{name}:{lists.get(name, model.site)(target).name}"


def actuators(report, elements, model, spec):
    for index, actuator in elements["actuator"].items():
        what = f"actuator[{actuator['name'] or index}]"
        report.same(f"{what}.name", actuator["name"], model.actuator(index).name)
        report.same(f"{what}.target", actuator["target"], target_of(model, index))
        law = f"{DYN[model.actuator_dyntype[index]]} {GAIN[model.actuator_gaintype[index]]} {BIAS[model.actuator_biastype[index]]}"
        report.same(f"{what}.law", actuator["law"], law)
        is_muscle = GAIN[model.actuator_gaintype[index]] == "muscle"
        for field, array in [("dynprm", model.actuator_dynprm), ("gainprm", model.actuator_gainprm), ("biasprm", model.actuator_biasprm)]:
            ours, theirs = numbers(actuator[field]), array[index].copy()
            # A force of -1 becomes one that is computed from `scale`.
            if is_muscle and field != "dynprm" and ours[2] < 0:
                ours[2] = theirs[2] = 0.0
            # A damping ratio becomes damping.
            if field == "biasprm" and ours[2] > 0 and law.endswith("affine"):
                ours[2] = theirs[2] = 0.0
            report.close(f"{what}.{field}", ours, theirs)
        report.close(f"{what}.gear", numbers(actuator["gear"]), model.actuator_gear[index])
        report.close(f"{what}.ctrlrange", numbers(actuator["ctrlrange"]), model.actuator_ctrlrange[index])
        report.close(f"{what}.forcerange", numbers(actuator["forcerange"]), model.actuator_forcerange[index])
        report.close(f"{what}.actrange", numbers(actuator["actrange"]), model.actuator_actrange[index])
        limited = [model.actuator_ctrllimited[index], model.actuator_forcelimited[index], model.actuator_actlimited[index]]
        report.close(f"{what}.limits", numbers(actuator["limited"]), limited)
        length = numbers(actuator["lengthrange"])
        if length.any():
            report.close(f"{what}.lengthrange", length, model.actuator_lengthrange[index])
        report.close(f"{what}.group", float(actuator["group"]), model.actuator_group[index])


def equalities(report, elements, model):
    for index, equality in elements["equality"].items():
        what, kind = f"equality[{equality['name'] or index}]", model.eq_type[index]
        report.same(f"{what}.name", equality["name"], model.equality(index).name)
        report.close(f"{what}.active", float(equality["active"]), model.eq_active0[index])
        report.close(f"{what}.solref", numbers(equality["solref"]), model.eq_solref[index])
        report.close(f"{what}.solimp", numbers(equality["solimp"]), model.eq_solimp[index])
        if "polycoef" in equality:
            lists = model.joint if kind == mujoco.mjtEq.mjEQ_JOINT else model.tendon
            second = model.eq_obj2id[index]
            theirs = f"{lists(model.eq_obj1id[index]).name} {lists(second).name if second >= 0 else ''}"
            report.same(f"{what}.objects", equality["objects"], theirs)
            report.close(f"{what}.polycoef", numbers(equality["polycoef"]), model.eq_data[index][:5])
        elif "anchor" in equality:
            report.close(f"{what}.anchor", numbers(equality["anchor"]), model.eq_data[index][:3])
        elif "torquescale" in equality:
            report.close(f"{what}.torquescale", float(equality["torquescale"]), model.eq_data[index][10])


def others(report, elements, model):
    option = elements["option"][0]
    for field in ["timestep", "impratio", "tolerance", "iterations"]:
        report.close(f"option.{field}", float(option[field]), getattr(model.opt, field))
    report.close("option.gravity", numbers(option["gravity"]), model.opt.gravity)
    # MuJoCo sorts these by bodies, so they are compared as sets.
    ours = {tuple(sorted(exclude["bodies"].split())) for exclude in elements["exclude"].values()}
    theirs = set()
    for signature in model.exclude_signature:
        pair = model.body(int(signature) >> 16).name, model.body(int(signature) & 0xFFFF).name
        theirs.add(tuple(sorted(pair)))
    report.same("exclude.all", ours, theirs)
    ours, theirs = {}, {}
    for pair in elements["pair"].values():
        values = [*numbers(pair["friction"]), *numbers(pair["solref"]), *numbers(pair["solimp"]), *numbers(pair["scalars"])]
        ours[tuple(sorted(pair["geoms"].split()))] = values
    for index in range(model.npair):
        geoms = model.geom(model.pair_geom1[index]).name, model.geom(model.pair_geom2[index]).name
        values = [*model.pair_friction[index], *model.pair_solref[index], *model.pair_solimp[index]]
        values += [model.pair_dim[index], model.pair_margin[index], model.pair_gap[index]]
        theirs[tuple(sorted(geoms))] = values
    report.same("pair.all", set(ours), set(theirs))
    for geoms in ours.keys() & theirs.keys():
        report.close("pair.values", ours[geoms], theirs[geoms])
    for index, sensor in elements["sensor"].items():
        report.same(f"sensor[{index}].name", sensor["name"], model.sensor(index).name)
        report.close(f"sensor[{index}].cutoff", float(sensor["cutoff"]), model.sensor_cutoff[index])
    for index, key in elements["key"].items():
        report.same(f"key[{index}].name", key["name"], model.key(index).name)
        if "qpos" in key:
            qpos = numbers(key["qpos"])
            mujoco.mj_normalizeQuat(model, qpos)
            report.close(f"key[{index}].qpos", qpos, model.key_qpos[index])


def compare(program, path, root, assets):
    text = Path(path).read_text()
    mended = without_repeated_classes(text)
    if mended != text:
        print(f"{path}: repeated default classes left out")
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder, Path(path).name)
            copy.write_text(mended)
            return compare(program, copy, root, assets)
    elements, (spec, model) = dump(program, path, root), load(path, assets)
    report = Report()
    counts = {
        "body": model.nbody, "joint": model.njnt, "geom": model.ngeom, "site": model.nsite, "tendon": model.ntendon,
        "actuator": model.nu, "equality": model.neq, "exclude": model.nexclude, "pair": model.npair,
        "sensor": model.nsensor, "key": model.nkey,
    }
    for kind, count in counts.items():
        report.same(f"{kind}.count", len(elements[kind]), int(count))
    if not report.wrong:
        bodies(report, elements, model, spec)
        joints(report, elements, model)
        geoms(report, elements, model)
        sites(report, elements, model)
        tendons(report, elements, model)
        actuators(report, elements, model, spec)
        equalities(report, elements, model)
        others(report, elements, model)
    return report


def main(arguments):
    options, files = {"--root": "", "--assets": ""}, []
    program, rest = arguments[0], arguments[1:]
    while rest:
        word = rest.pop(0)
        if word in options:
            options[word] = rest.pop(0)
        else:
            files.append(word)
    failed = False
    for path in files:
        report = compare(program, path, options["--root"], options["--assets"])
        total = sum(report.compared.values())
        print(f"{path}: {total} values, {len(report.wrong)} differ, largest difference of the others {report.largest:.1e}")
        for line in report.wrong[:10]:
            print(f"  {line}")
        failed |= bool(report.wrong)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
