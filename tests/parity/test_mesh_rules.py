"""Contacts of convex meshes: what `mesh_rules.py` makes of them, and MuJoCo 4.0, in random states of `myolegs26`.

Legs move through their ranges, most of the time in the air, else over pedestal and floor, so that bones meet each other
and these. No capsule or ellipsoid of the trunk comes to a bone that way; probes do that are put onto bones at random.
"""

import itertools
from collections import defaultdict
from typing import NamedTuple

import mesh_rules
import mujoco
import numpy as np
import pytest
from conftest import MUJOCO
from myo_sim.build import compose

pytestmark = pytest.mark.skipif(MUJOCO < 4, reason="contacts of meshes are another thing before MuJoCo 4")

STATES = 1200
#: One of so many states is over pedestal and floor.
LANDS_EVERY = 3
PROBED = 120
PAIRS = 300
#: Margin of the probes, as that of the trunk's own capsules and ellipsoids (m).
PROBE_MARGIN = 0.001
CAPSULE, ELLIPSOID = (0.075, 0.145), (0.26, 0.095, 0.14)
#: Greatest errors of dist (m), pos (m) and normal.
EXACT = (1e-9, 1e-6, 1e-6)
#: Contacts of a pair that are less than this apart are one that is there twice (m).
SAME = 1e-9
PLANE, MESH, CYLINDER = (int(getattr(mujoco.mjtGeom, f"mjGEOM_{name}")) for name in ["PLANE", "MESH", "CYLINDER"])


class Compared(NamedTuple):
    """Contacts of a pair of geoms: MuJoCo's number and that of the rules, and if they are equal the greatest errors."""

    wanted: int
    found: int
    errors: np.ndarray | None
    #: The same of contacts that stand there twice taken once.
    errors_of_distinct: np.ndarray | None

    def within(self, most):
        return self.errors is not None and bool((self.errors <= most).all())

    def distinct_within(self, most):
        return self.errors_of_distinct is not None and bool((self.errors_of_distinct <= most).all())


def legs():
    """The legs, and two probes that touch bones alone, compiled."""
    spec = compose.build_spec("myolegs26")
    for name, kind, size in [("capsule", "CAPSULE", (*CAPSULE, 0)), ("ellipsoid", "ELLIPSOID", ELLIPSOID)]:
        body = spec.worldbody.add_body(name=f"{name} probe", mocap=True, pos=[0, 0, 100])
        kind = getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")
        body.add_geom(name=f"{name} probe", type=kind, size=size, margin=PROBE_MARGIN, contype=1, conaffinity=0)
    model = spec.compile()
    model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-12, 500
    return model


def meets(model, one, other):
    """Whether MuJoCo looks for contacts of two geoms that no `pair` names."""
    types, affinities = model.geom_contype, model.geom_conaffinity
    bits = types[one] & affinities[other] | types[other] & affinities[one]
    welded = [int(model.body_weldid[model.geom_bodyid[geom]]) for geom in (one, other)]
    parents = [int(model.body_weldid[model.body_parentid[body]]) for body in welded]
    # Parent and child do not touch, unless the parent is the world.
    family = all(welded) and (welded[0] == parents[1] or welded[1] == parents[0])
    return bits and welded[0] != welded[1] and not family


def pairs_with_meshes(model):
    """Margins of all pairs of geoms that may touch of which the second is a mesh."""
    geoms = sorted(range(model.ngeom), key=lambda geom: (model.geom_type[geom], geom))
    ends = [pair for pair in itertools.combinations(geoms, 2) if model.geom_type[pair[1]] == MESH]
    margins = {(a, b): model.geom_margin[a] + model.geom_margin[b] for a, b in ends if meets(model, a, b)}
    named = zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), model.pair_margin, strict=True)
    return margins | {(min(a, b), max(a, b)): margin for a, b, margin in named}


class Scene:
    """The legs in MuJoCo and by the rules."""

    def __init__(self):
        self.model = legs()
        self.data = mujoco.MjData(self.model)
        #: Where position and quaternion of the root begin in `qpos`.
        self.root = int(self.model.joint("root").qposadr[0])
        self.margins = pairs_with_meshes(self.model)
        meshes = {geom for _, geom in self.margins}
        self.polytopes = {geom: mesh_rules.poly_from_model(self.model, self.model.geom_dataid[geom]) for geom in meshes}

    def pose(self, rng, in_the_air):
        """A pose with joints anywhere in their ranges, and the root high up, or anywhere around the pedestal."""
        model, qpos = self.model, self.data.qpos
        qpos[:] = model.qpos0
        for joint, start in enumerate(model.jnt_qposadr):
            if model.jnt_limited[joint]:
                qpos[start] = rng.uniform(*model.jnt_range[joint])
        root = self.root
        if in_the_air:
            qpos[root + 2] += 3
            return
        out = rng.choice([0.8, 1.8], p=[0.7, 0.3])
        qpos[root : root + 3] += [*rng.uniform(-out, out, 2), rng.uniform(-1.2, 0.1)]
        qpos[root + 3 : root + 7] = mesh_rules.mesh_nearest.unit(rng.normal(size=4))

    def contacts(self):
        """MuJoCo's contacts of each pair of geoms."""
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)
        found = defaultdict(list)
        for contact in self.data.contact:
            found[tuple(contact.geom.tolist())].append(contact)
        return found

    def near(self, one, other):
        """Whether bounding spheres of two geoms overlap; a plane has none."""
        model, places = self.model, self.data.geom_xpos
        reach = model.geom_rbound[one] + model.geom_rbound[other] + self.margins[one, other]
        return model.geom_type[one] == PLANE or np.linalg.norm(places[one] - places[other]) < reach

    def placed(self, geom):
        """The geom as the rules know it, and the function of theirs for it and a mesh."""
        rotation, position, size = self.data.geom_xmat[geom], self.data.geom_xpos[geom], self.model.geom_size[geom]
        match mujoco.mjtGeom(self.model.geom_type[geom]):
            case mujoco.mjtGeom.mjGEOM_MESH:
                return self.polytopes[geom].placed(rotation, position), mesh_rules.mesh_mesh
            case mujoco.mjtGeom.mjGEOM_PLANE:
                return mesh_rules.Plane(rotation, position), mesh_rules.plane_mesh
            case mujoco.mjtGeom.mjGEOM_CYLINDER:
                return mesh_rules.Cylinder(rotation, position, *size[:2]), mesh_rules.cylinder_mesh
            case mujoco.mjtGeom.mjGEOM_CAPSULE:
                return mesh_rules.Capsule(rotation, position, *size[:2]), mesh_rules.capsule_mesh
            case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
                return mesh_rules.Ellipsoid(rotation, position, size), mesh_rules.ellipsoid_mesh

    def compared(self, pairs):
        """Contacts of those of some pairs where MuJoCo or the rules have any, by type of the first geom."""
        wanted, compared = self.contacts(), defaultdict(list)
        near = {pair for pair in self.margins if self.near(*pair)}
        assert near.issuperset(pair for pair in wanted if self.model.geom_type[pair[1]] == MESH)
        for pair in near.intersection(pairs):
            first, rule = self.placed(pair[0])
            second, _ = self.placed(pair[1])
            found = rule(first, second, self.margins[pair])
            if found or wanted[pair]:
                compared[int(self.model.geom_type[pair[0]])].append(comparison(wanted[pair], found))
        return compared


def distinct(contacts):
    """Contacts without those that are where an earlier one is."""
    earlier = [[np.abs(other.pos - each.pos).max() < SAME for other in contacts[:i]] for i, each in enumerate(contacts)]
    return [each for each, same in zip(contacts, earlier, strict=True) if not any(same)]


def greatest_errors(wanted, found):
    """Greatest errors of contacts as sets, each with the nearest of those left; nothing if their numbers differ."""
    if len(wanted) != len(found):
        return None
    left, errors = list(wanted), np.zeros(3)
    for contact in found:
        k = min(range(len(left)), key=lambda k: np.linalg.norm(left[k].pos - contact.pos))
        other = left.pop(k)
        offs = other.dist - contact.dist, other.pos - contact.pos, other.frame[:3] - contact.normal
        errors = np.maximum(errors, [np.abs(off).max() for off in offs])
    return errors


def comparison(wanted, found):
    errors_of_distinct = greatest_errors(distinct(wanted), distinct(found))
    return Compared(len(wanted), len(found), greatest_errors(wanted, found), errors_of_distinct)


@pytest.fixture(scope="module")
def scene():
    return Scene()


@pytest.fixture(scope="module")
def legs_compared(scene):
    """What pedestal, floor and bones make with bones, by type of the first geom."""
    rng, compared = np.random.default_rng(1), defaultdict(list)
    pairs = [pair for pair in scene.margins if scene.model.geom_type[pair[0]] in (PLANE, CYLINDER, MESH)]
    for state in range(STATES):
        scene.pose(rng, in_the_air=state % LANDS_EVERY > 0)
        for kind, some in scene.compared(pairs).items():
            compared[kind] += some
    return compared


def probed(scene, name):
    """What a probe makes with bones that it is put onto, by up to 3 cm deep."""
    rng, compared = np.random.default_rng(2), []
    data, body, geom = scene.data, scene.model.body(f"{name} probe"), scene.model.geom(f"{name} probe").id
    pairs = [pair for pair in scene.margins if pair[0] == geom]
    for _ in range(PROBED):
        scene.pose(rng, in_the_air=True)
        data.mocap_quat[body.mocapid] = rng.normal(size=4)
        mujoco.mj_kinematics(scene.model, data)
        probe, _ = scene.placed(geom)
        bone, _ = scene.placed(pairs[rng.integers(len(pairs))][1])
        normal = mesh_rules.mesh_nearest.unit(rng.normal(size=3))
        deepest = bone.vertices[(bone.vertices @ normal).argmin()]
        surface = probe.support(normal) + (CAPSULE[0] * normal if name == "capsule" else 0)
        data.mocap_pos[body.mocapid] += deepest - surface + rng.uniform(-PROBE_MARGIN, 0.03) * normal
        for some in scene.compared(pairs).values():
            compared += some
    data.mocap_pos[body.mocapid] = [0, 0, 100]
    return compared


def share(some, most):
    return sum(each.within(most) for each in some) / len(some)


def told(name, some):
    errors = np.max([each.errors for each in some if each.errors is not None], axis=0)
    unequal = sum(each.wanted != each.found for each in some)
    print(f"{name}: {len(some)} pairs, {unequal} unequal, exact {share(some, EXACT):.4f}, greatest errors {errors}")


def test_meshes_touch_each_other_as_mujocos(legs_compared):
    some = legs_compared[MESH]
    told("mesh-mesh", some)
    assert len(some) >= PAIRS and {each.wanted for each in some} == {1, 2, 3, 4}
    assert all(each.wanted == each.found and each.distinct_within(EXACT) for each in some)
    # Of more than four corners, in some pairs out of thousands, one is taken twice; which one is an exact tie.
    assert sum(not each.within(EXACT) for each in some) <= 3e-3 * len(some)


def test_meshes_lie_on_a_plane_as_mujocos(legs_compared):
    some = legs_compared[PLANE]
    told("plane-mesh", some)
    assert len(some) >= PAIRS and {each.wanted for each in some} == {1, 2, 3, 4}
    assert all(each.within(EXACT) for each in some)


def turned_down(scene, geom, vertex):
    """A pose in which a vertex of a geom is the geom's lowest, 2 mm below the floor."""
    scene.pose(np.random.default_rng(3), in_the_air=True)
    mujoco.mj_kinematics(scene.model, scene.data)
    bone, _ = scene.placed(geom)
    down = bone.triangle_normals[(bone.triangles == vertex).any(1)].mean(0)
    turn, qpos, root = np.zeros(4), scene.data.qpos, scene.root
    mujoco.mju_quatZ2Vec(turn, -down)
    mujoco.mju_negQuat(turn, turn)
    quaternion = qpos[root + 3 : root + 7].copy()
    mujoco.mju_mulQuat(qpos[root + 3 : root + 7], turn, quaternion)
    mujoco.mj_kinematics(scene.model, scene.data)
    heights = scene.placed(geom)[0].vertices[:, 2]
    assert heights.argmin() == vertex
    qpos[root + 2] += scene.model.geom("floor").pos[2] - heights.min() - 0.002


def test_a_vertex_that_no_polygon_has_lies_alone(scene):
    floor = scene.model.geom("floor").id
    left_out = [(geom, i) for geom, bone in scene.polytopes.items() for i, at in enumerate(bone.polygons_at) if not at]
    assert len(left_out) == 3
    for geom, vertex in left_out:
        turned_down(scene, geom, vertex)
        [compared] = scene.compared([(floor, geom)])[PLANE]
        assert compared.wanted == 1 and compared.within(EXACT)


def test_meshes_lie_on_a_cylinder_as_mujocos(legs_compared):
    some = legs_compared[CYLINDER]
    told("cylinder-mesh", some)
    assert len(some) >= PAIRS and {each.wanted for each in some} == {1, 2, 3, 4}
    # What the line of a cylinder's side does where the cylinder stands on a vertex is left to chance in MuJoCo.
    assert sum(each.wanted != each.found for each in some) <= 3e-3 * len(some)
    # On the rim MuJoCo's search ends some 1e-6 to 1e-5 m beside the point that touches, and its contacts go with that.
    assert share(some, EXACT) > 0.9
    assert share(some, (1e-5, 1e-4, 1e-5)) >= 1 - 3e-3


def test_meshes_touch_capsules_as_mujocos(scene):
    some = probed(scene, "capsule")
    told("capsule-mesh", some)
    assert len(some) >= PAIRS and {each.wanted for each in some} == {1, 2}
    assert all(each.wanted == each.found for each in some)
    # Where one end alone touches, MuJoCo's search ends a little beside it.
    assert share(some, EXACT) > 0.98
    assert share(some, (1e-7, 1e-5, 1e-6)) == 1


def test_meshes_touch_ellipsoids_as_mujocos(scene):
    some = probed(scene, "ellipsoid")
    told("ellipsoid-mesh", some)
    assert len(some) >= PAIRS and {each.wanted for each in some} == {1}
    assert all(each.wanted == each.found for each in some)
    # On round surfaces MuJoCo's search is exact in depth, and slow sideways.
    assert share(some, (1e-8, np.inf, np.inf)) == 1
    assert share(some, (1e-8, 1e-5, 1e-4)) >= 0.99
