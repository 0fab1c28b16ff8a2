"""Bodies of others, from their MJCF: one thousand random states of each against MuJoCo.

The models are those of the package `myo-sim`, as MuJoCo saves them, with inertia, and a small one that falls on floor and table. Parts of
arms touch the trunk in some states, legs and whole bodies what they stand on, bones of legs each other; those of the
others never meet, which the import finds out.
"""

import base64
import json
import os
import re
import sys

import mesh_rules
import mujoco
import myo_sim
import numpy as np
import pytest
from conftest import MUJOCO, ROOT, myo, output

sys.path.append(str(ROOT / "myo-mjcf/tests"))
from against_mujoco import without_repeated_classes
from myo_sim.build import compose
from simulation import forward, relative_error

STATES = 1000
#: Each with a fingertip, or what else may be pointed with, and a shoulder.
MODELS = {
    "myoelbow": ("wrist", "r_humerus"),
    "myofinger": ("IFtip", "proximal"),
    "tight finger": ("IFtip", "proximal"),
    "myohand_r": ("IFtip_r", "humerus_r"),
    "myoarm_r": ("IFtip_r", "humerus_r"),
    "myoarms": ("IFtip_r", "humerus_r"),
    "myolegs": ("torso_root_attach", "sacrum"),
    "myolegs26": ("torso_root_attach", "sacrum"),
    "legs among capsules": ("torso_root_attach", "sacrum"),
    "legs among ellipsoids": ("torso_root_attach", "sacrum"),
    "legs among boxes": ("torso_root_attach", "sacrum"),
    "legs among spheres": ("torso_root_attach", "sacrum"),
    "myofullbody": ("IFtip_r", "humerus_r"),
    "tumbler": ("tip", "arm"),
    "linkage": ("tip", "arm"),
    "blocks": ("tip", "arm"),
    "elliptic blocks": ("tip", "arm"),
    "twisting tumbler": ("tip", "arm"),
    "rolling tumbler": ("tip", "arm"),
    "implicitfast tumbler": ("tip", "arm"),
    "implicitfast myofinger": ("IFtip", "proximal"),
    "implicitfast myoarm_r": ("IFtip_r", "humerus_r"),
    "implicitfast juggler": ("tip", "arm"),
    "implicit tumbler": ("tip", "arm"),
    "implicit linkage": ("tip", "arm"),
    "implicit juggler": ("tip", "arm"),
    "implicit myofinger": ("IFtip", "proximal"),
    "implicit myoarm_r": ("IFtip_r", "humerus_r"),
    "implicit myolegs": ("torso_root_attach", "sacrum"),
    "elliptic tumbler": ("tip", "arm"),
    "elliptic rolling tumbler": ("tip", "arm"),
    "elliptic myolegs": ("torso_root_attach", "sacrum"),
    "held myoarm_r": ("IFtip_r", "humerus_r"),
    "sliding myoarm_r": ("IFtip_r", "humerus_r"),
    "myotorso": ("torso_root_attach", "Full Body"),
}
#: What is changed of some: the text in a file, what stands in its place, and how often it is there.
CHANGED = {
    # Lengths that its tendons have left in nearly all poses; those of the file they never leave.
    "tight finger": ('range="0 0.33"', 'range="0.04 0.08" margin="0.01"', 5),
    # Contacts without friction.
    "sliding myoarm_r": ("<pair ", '<pair condim="1" ', 4),
}
#: What makes the falling body resist more than sliding.
ROUGH = {
    "twisting tumbler": lambda text: text.replace('condim="3"/>', 'condim="4" friction="0.9 0.6 0.03"/>'),
    "rolling tumbler": lambda text: text.replace(
        'condim="3"/>', 'condim="6" friction="0.8 0.8 0.03 0.01 0.02"/>'
    ).replace("<default>", '<option impratio="3"/><default>'),
    "elliptic tumbler": lambda text: text.replace('condim="3"/>', 'condim="4" friction="0.9 0.6 0.03"/>', 3).replace(
        "<default>", '<option cone="elliptic"/><default>'
    ),
    "elliptic blocks": lambda text: text.replace("<default>", '<option cone="elliptic"/><default>'),
    "elliptic rolling tumbler": lambda text: text.replace(
        'condim="3"/>', 'condim="6" friction="0.8 0.6 0.03 0.01 0.02"/>'
    ).replace("<default>", '<option impratio="3" cone="elliptic"/><default>'),
}
BEFORE_4 = MUJOCO < 4
#: What a side site says changed with 4.0.
SIDE_RULE = "mujoco3" if BEFORE_4 else "mujoco4"
if BEFORE_4:
    # How rods lie on cylinders and how free bodies turn implicitly is another thing there, and what it saves of the others it cannot read, or has no contacts.
    others = [name for name in MODELS if {"tumbler", "juggler", "blocks", "myolegs"} & set(name.split())]
    for name in [*others, "myofullbody", "myoarms", "sliding myoarm_r"]:
        del MODELS[name]
    # Nor are contacts of meshes the same.
    for name in ["myolegs26", *(name for name in MODELS if name.startswith("legs among"))]:
        del MODELS[name]
NO_CONTACTS = '<option><flag contact="disable"/></option>'
#: Greatest errors: lengths (m), moment arms (m), velocities (m/s), forces and accelerations relative. Ways round cylinders
#: are found by rounds of iteration, here as there.
MOST = {"length": 1e-9, "moment": 1e-7, "velocity": 1e-6, "force": 1e-5, "distance": 1e-7, "bias": 1e-9, "smooth": 1e-6, "qacc": 1e-4, "step": 1e-4}


#: Sizes of what stands among legs, from and to (m), and how many there are of each.
AMONG = {
    "capsules": ("CAPSULE", ([0.02, 0.05, 0], [0.06, 0.15, 0])),
    "ellipsoids": ("ELLIPSOID", ([0.03] * 3, [0.12] * 3)),
    "boxes": ("BOX", ([0.03] * 3, [0.12] * 3)),
    "spheres": ("SPHERE", ([0.03, 0, 0], [0.12, 0, 0])),
    "cylinders": ("CYLINDER", ([0.03, 0.02, 0], [0.12, 0.15, 0])),
}
OBSTACLES = 40


def among(shapes):
    """The legs of which bones touch each other, among shapes that they meet nearly always, some with a margin."""
    spec, rng = compose.build_spec("myolegs26"), np.random.default_rng(1)
    kind, sizes = AMONG[shapes]
    for number in range(OBSTACLES):
        place, turn = rng.uniform([-0.5, -0.5, 0.1], [0.5, 0.5, 1.1]), rng.normal(size=4)
        spec.worldbody.add_geom(
            name=f"obstacle{number}",
            type=getattr(mujoco.mjtGeom, f"mjGEOM_{kind}"),
            size=rng.uniform(*sizes),
            pos=place,
            quat=turn / np.linalg.norm(turn),
            margin=rng.choice([0.0, 0.002]),
            # Bones alone: what the trunk has is touched by nothing.
            contype=1,
            conaffinity=0,
        )
    return spec


def held(spec):
    """An arm whose index finger is pinned to its middle one, and whose hand is welded to the trunk."""
    anchor, pose = [0, -0.01, 0, *[0] * 9], [*[0] * 10, 0.2, 0]
    for kind, one, other, data in [("CONNECT", "distph2_r", "distph3_r", anchor), ("WELD", "capitate_r", "torso", pose)]:
        spec.add_equality(
            type=getattr(mujoco.mjtEq, f"mjEQ_{kind}"),
            objtype=mujoco.mjtObj.mjOBJ_BODY,
            name1=one,
            name2=other,
            data=data,
        )
    return spec


def by_a_post(spec):
    """Boxes that touch nothing but a cylinder."""
    for pair in list(spec.pairs):
        spec.delete(pair)
    cylinder = mujoco.mjtGeom.mjGEOM_CYLINDER
    spec.worldbody.add_geom(
        name="post", type=cylinder, size=[0.12, 0.2, 0], pos=[0.3, 0.3, 0.5], quat=[0.9, 0.3, 0.1, 0], contype=0, conaffinity=0
    )
    spec.add_pair(geomname1="post", geomname2="fist", condim=3)
    return spec


def spec_of(name):
    """A model as its package builds it, or as its name says it is changed."""
    first, _, rest = name.partition(" ")
    if first in ("implicit", "implicitfast"):
        spec = spec_of(rest)
        spec.option.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{first.upper()}")
        return spec
    if first == "held":
        return held(spec_of(rest))
    if name == "elliptic myolegs":
        spec = spec_of(rest)
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        return spec
    legacy = myo_sim.MODELS_DIR / "legacy"
    if name.startswith("legs among "):
        return among(name.removeprefix("legs among "))
    if name == "blocks by a post":
        return by_a_post(spec_of(first))
    if name.split()[-1] in ("tumbler", "juggler", "blocks", "linkage"):
        text = (ROOT / f"myo-dynamics/examples/{name.split()[-1]}.xml").read_text()
        return mujoco.MjSpec.from_string(ROUGH[name](text) if name in ROUGH else text)
    if name == "myoelbow":
        return mujoco.MjSpec.from_file(str(legacy / "elbow/myoelbow_1dof6muscles.xml"))
    if "finger" in name:
        return mujoco.MjSpec.from_file(str(legacy / "finger/myofinger_v0.xml"))
    return compose.build_spec(name.removeprefix("sliding "))


def saved(name, folder, spec=None):
    """What MuJoCo saves of a model, or of what was made of it, and what it makes of that."""
    spec = spec or spec_of(name)
    spec.compiler.saveinertial = 1
    spec.compile()
    text = spec.to_xml()
    meshes = myo_sim.MODELS_DIR
    text = without_repeated_classes(text)
    if BEFORE_4:
        # A class is saved without its name there, with what says that meshes are only seen.
        text = text.replace("\n    <default>\n", '\n    <default class="nameless">\n')
        text = text.replace("\n  <default>\n", f"\n  {NO_CONTACTS}\n  <default>\n", 1)
    text = text.replace("../../meshes", str(meshes / "meshes")).replace("../../textures", str(meshes / "textures"))
    if name in CHANGED:
        old, new, count = CHANGED[name]
        assert text.count(old) == count
        text = text.replace(old, new)
    path = folder / f"{name}.xml"
    path.write_text(text)
    return path, mujoco.MjModel.from_xml_path(str(path))


def example(package, name):
    """An example: the one in the folder that MYO_EXAMPLES names, or what cargo makes of it."""
    folder = os.environ.get("MYO_EXAMPLES")
    if folder:
        return os.path.join(folder, name)
    output("cargo", "build", "--quiet", "-p", package, "--example", name)
    return str(ROOT / "target/debug/examples" / name)


def in_states(name, landmarks, folder, spec=None):
    """MuJoCo's model, its file, and what Myo makes of that in many states."""
    path, model = saved(name, folder, spec)
    model.opt.tolerance, model.opt.iterations = 1e-12, 300
    model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-12, 500
    states = output(example("myo-dynamics", "states"), str(path), *landmarks, str(STATES), SIDE_RULE, "/")
    return model, path, json.loads(states)


@pytest.fixture(scope="module", params=MODELS)
def compared(request, tmp_path_factory):
    name = request.param
    return name, *in_states(name, MODELS[name], tmp_path_factory.mktemp(name))


def step_error(model, data, state, floor):
    """How far velocities and activations are after a step, as rates of change."""
    before = data.qvel.copy()
    mujoco.mj_step(model, data)
    change, found = data.qvel - before, np.asarray(state["qvel_after"]) - before
    return max(relative_error(found, change, floor), np.abs(data.act - state["act_after"]).max())


def errors(model, state, floor=1e-30):
    """How far Myo is from MuJoCo in one state; forces and accelerations in units of the greatest, or of a floor."""
    data = forward(model, state)
    moments = np.zeros((model.nu, model.nv))
    mujoco.mju_sparse2dense(
        moments, data.actuator_moment.ravel(), data.moment_rownnz, data.moment_rowadr, data.moment_colind.ravel()
    )
    distances = np.sort(data.contact.dist)
    # Of those that are there at all: what is as far as its margin is, or is not.
    assert len(distances) == len(state["distances"])
    force = np.abs(data.actuator_force - state["muscle_force"]) / np.maximum(np.abs(data.actuator_force), 1.0)
    return {
        "length": np.abs(data.actuator_length - state["tendon_length"]).max(),
        "moment": np.abs(moments - state["moments"]).max(),
        "velocity": np.abs(data.actuator_velocity - state["tendon_velocity"]).max(),
        "force": force.max(),
        "distance": np.abs(distances - np.sort(state["distances"])).max(initial=0.0),
        "bias": relative_error(state["qfrc_bias"], data.qfrc_bias, floor),
        "smooth": relative_error(state["qacc_smooth"], data.qacc_smooth, floor),
        "qacc": relative_error(state["qacc_soft"], data.qacc, floor),
        "step": step_error(model, data, state, floor),
    }


def test_every_quantity_is_mujocos(compared):
    name, model, _, states = compared
    assert len(states) == STATES and len(states[0]["qpos"]) == model.nq
    worst = dict.fromkeys(MOST, 0.0)
    for state in states:
        for what, error in errors(model, state).items():
            worst[what] = max(worst[what], error)
    print(name, {what: f"{error:.1e}" for what, error in worst.items()})
    assert all(worst[what] < most for what, most in MOST.items()), worst


@pytest.mark.skipif(BEFORE_4, reason="contacts of meshes are another thing before MuJoCo 4")
@pytest.mark.parametrize("name", ["legs among cylinders", "blocks by a post"])
def test_bones_and_boxes_lie_on_cylinders_as_mujocos(name, tmp_path):
    landmarks = MODELS["blocks" if "blocks" in name else "myolegs26"]
    model, _, states = in_states(name, landmarks, tmp_path)
    others, most, touching = 0, 0.0, 0
    for state in states:
        wanted, found = np.sort(forward(model, state).contact.dist), np.sort(state["distances"])
        touching += len(wanted) > 0
        error = np.abs(wanted - found).max(initial=0.0) if len(wanted) == len(found) else np.inf
        # On the rim MuJoCo's search ends a little beside the point that touches.
        if error > 2e-6:
            others += 1
        else:
            most = max(most, error)
    print(f"{touching} states with contacts, {others} others than MuJoCo's, the rest within {most:.1e} m")
    # Where a cylinder stands on a vertex, MuJoCo takes a line of its side by chance, once in ten thousand pairs one
    # that is over the bone. And of the sixteen corners of an end two may be as good as each other.
    assert touching > 0.2 * STATES and others <= 5


def test_a_model_file_is_made_of_it(compared, tmp_path):
    name, model, path, _ = compared
    if name.startswith("legs among"):
        pytest.skip("the legs are a body of their own already")
    fingertip, shoulder = MODELS[name]
    made = tmp_path / f"{name}.yaml"
    landmarks = ["--fingertip", fingertip, "--shoulder", shoulder]
    # Meshes that touch are read from where the package is.
    root = ["--root", "/"] if "legs26" in name else []
    myo("model", "import", str(path), *landmarks, "--side-rule", SIDE_RULE, "--out", str(made), *root)
    assert ("side_rule: mujoco3" in made.read_text()) == BEFORE_4
    sizes = json.loads(myo("model", "check", str(made), "--json"))
    assert (sizes["joints"], sizes["muscles"]) == (model.njnt, model.nu)


def hulls_of(text):
    """Of each geom of a model file that is a mesh: points, triangles and polygons."""

    def numbers(list_, kind):
        return np.frombuffer(base64.b64decode(list_), kind)

    hulls = re.findall(r"points: >-\n *(\S+)\n *triangles: >-\n *(\S+)\n *polygons: >-\n *(\S+)", text)
    found = {}
    for name, number in re.findall(r"- name: (\S+)\n  body: \S+\n  shape:\n    mesh:\n      hull: (\d+)", text):
        points, triangles, polygons = hulls[int(number)]
        left, cut = numbers(polygons, "<u2").tolist(), []
        while left:
            count, *left = left
            cut.append(left[:count])
            left = left[count:]
        found[name] = numbers(points, "<f8").reshape(-1, 3), numbers(triangles, "<u2").reshape(-1, 3).tolist(), cut
    return found


@pytest.mark.skipif(BEFORE_4, reason="the compiler is that of MuJoCo 4")
def test_hulls_of_meshes_are_mujocos(tmp_path):
    path, model = saved("myolegs26", tmp_path)
    fingertip, shoulder = MODELS["myolegs26"]
    made = tmp_path / "legs.yaml"
    landmarks = ["--fingertip", fingertip, "--shoulder", shoulder]
    myo("model", "import", str(path), *landmarks, "--root", "/", "--out", str(made))
    found = hulls_of(made.read_text())
    assert len(found) == 15
    for name, (points, triangles, polygons) in found.items():
        wanted = mesh_rules.poly_from_model(model, model.geom(name).dataid[0])
        # To the last bit of single precision, each point once.
        number = {tuple(point): k for k, point in enumerate(points.astype(np.float32).astype(float))}
        order = [number[tuple(point)] for point in wanted.vertices]
        assert sorted(order) == list(range(len(points)))
        # In the same order, which counts.
        assert [[order[k] for k in corners] for corners in wanted.triangles.tolist()] == triangles
        assert [[order[k] for k in corners] for corners in wanted.polygons] == polygons
        areas = np.array([np.cross(points[p], points[np.roll(p, -1)]).sum(0) for p in polygons])
        assert np.abs(mesh_rules.mesh_nearest.unit(areas) - wanted.polygon_normals).max() < 1e-12


def test_contacts_are_refused_with_their_place(tmp_path):
    path, _ = saved("myotorso", tmp_path)
    text = path.read_text().replace(NO_CONTACTS, "")
    # Where it is touched, only by what is deeper than its gap.
    pattern = r'name="floor" size="7 7 0.1" pos="[^"]*" type="plane"'
    text, count = re.subn(pattern, 'name="floor" size="7 7 0.1" pos="0 0 0.9" type="plane" gap="0.01"', text)
    assert count == 1
    path.write_text(text)
    fingertip, shoulder = MODELS["myotorso"]
    command = ["model", "import", str(path), "--fingertip", fingertip, "--shoulder", shoulder]
    with pytest.raises(pytest.fail.Exception, match=r"it may touch .*--without-contacts"):
        myo(*command)
    assert "muscles" in myo(*command, "--without-contacts")


@pytest.mark.skipif(BEFORE_4, reason="the reader is held against MuJoCo 4.0")
def test_the_reader_says_what_mujoco_makes():
    legacy, seeds = myo_sim.MODELS_DIR / "legacy", ROOT / "myo-mjcf/fuzz/seeds"
    files = [*legacy.glob("elbow/*.xml"), *legacy.glob("finger/*.xml"), seeds / "rich.xml", seeds / "rich_saved.xml"]
    assert len(files) == 10
    script = ROOT / "myo-mjcf/tests/against_mujoco.py"
    dump = example("myo-mjcf", "dump")
    for path in files:
        root = myo_sim.MODELS_DIR if legacy in path.parents else seeds
        told = output(sys.executable, str(script), dump, "--root", str(root), str(path))
        assert " 0 differ" in told, told
