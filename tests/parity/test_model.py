"""The exported file is the model: same elements, same order, same derived quantities."""

import re

import mujoco
import numpy as np
import pytest
from conftest import ROOT, myo

VARIANTS = ("mobl-arms", "mobl-arms-uitb")


@pytest.fixture(scope="module", params=VARIANTS)
def exported(request):
    xml = myo("model", "export", request.param, "--format", "mjcf")
    return mujoco.MjModel.from_xml_string(xml)


def names_in_model_file(section):
    """Names in one section of the built-in arm's model file."""
    text = (ROOT / "myo-model/models/mobl-arms.yaml").read_text()
    block = re.search(rf"^{section}:\n((?:[ #].*\n)+)", text, re.MULTILINE).group(1)
    return re.findall(r"^  - (?:\{)?name: ([^,\n]+)", block, re.MULTILINE)


@pytest.mark.parametrize(
    ("section", "element", "count"),
    [("bodies", "body", 17), ("joints", "joint", 17), ("sites", "site", 110), ("muscles", "actuator", 26)],
)
def test_elements_keep_their_order(exported, section, element, count):
    kind = getattr(mujoco.mjtObj, f"mjOBJ_{element.upper()}")
    first = 1 if element == "body" else 0
    total = {"body": exported.nbody, "joint": exported.njnt, "site": exported.nsite, "actuator": exported.nu}[element]
    found = [mujoco.mj_id2name(exported, kind, index) for index in range(first, total)]
    assert len(found) == count
    assert found == names_in_model_file(section)


def test_mass_is_that_of_the_bodies(exported):
    assert exported.body_mass.sum() == pytest.approx(12.8025, abs=1e-12)


def test_landmarks_are_in_place_in_the_zero_pose(exported):
    data = mujoco.MjData(exported)
    mujoco.mj_forward(exported, data)
    np.testing.assert_allclose(data.site("fingertip").xpos, [0.034937, -0.198526, 0.285043], atol=1e-6)
    np.testing.assert_allclose(data.body("humphant").xpos, [-0.017555, -0.17, 0.993], atol=1e-6)


def test_muscles_keep_separate_curves_and_length_ranges(exported):
    np.testing.assert_array_equal(exported.actuator_gainprm[:, :2], np.tile([0.5, 2.0], (26, 1)))
    np.testing.assert_array_equal(exported.actuator_biasprm[:, :2], np.tile([0.75, 1.05], (26, 1)))
    assert (exported.actuator_lengthrange[:, 0] < exported.actuator_lengthrange[:, 1]).all()
    np.testing.assert_array_equal(exported.actuator_ctrlrange, np.tile([0.0, 1.0], (26, 1)))


def test_parity_data_uses_the_same_arm(arm):
    xml = myo("model", "export", "mobl-arms", "--format", "mjcf")
    exported = mujoco.MjModel.from_xml_string(xml)
    for field in ("body_mass", "body_inertia", "body_pos", "jnt_axis", "jnt_range", "site_pos", "actuator_gainprm", "eq_data"):
        np.testing.assert_array_equal(getattr(exported, field), getattr(arm, field), err_msg=field)
