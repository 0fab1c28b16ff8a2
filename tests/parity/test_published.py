"""MuJoCo's own test models of muscles and tendons: one thousand random states of each.

They are in the package `mujoco-mjx` (Apache-2.0). A tendon of theirs that runs through space and that no muscle pulls gets one; what
drives otherwise is left out.
"""

import importlib.resources
import itertools
import xml.etree.ElementTree as ElementTree

import mujoco
import pytest
from conftest import myo
from test_mjcf import MOST, STATES, errors, in_states, saved

FILES = importlib.resources.files("mujoco") / "mjx/test_data"
MODELS = [
    "actuator/arm21.xml",
    "actuator/arm26.xml",
    *(
        f"tendon/{name}.xml"
        for name in [
            "fixed_site",
            "fixed_site_wrap",
            "pulley_fixed_site_wrap",
            "pulley_site",
            "pulley_site_wrap",
            "pulley_wrap",
            "site",
            "site_wrap",
            "tendon",
            "wrap_sidesite",
        ]
    ),
]
#: What is not simulated, and what is said of it.
REFUSED = {"tendon/armature.xml": "inertia of tendons (`armature`) is not simulated"}
#: Lengths that a muscle has whose file does not tell (m).
LENGTHS = "0.1 0.6"
#: Accelerations and forces below this are none (rad/s2, N m): one of the models cannot move.
NOTHING = 1e-6


def with_muscles(name):
    """A model whose spatial tendons are pulled by muscles, and the names of a tip and of a body."""
    root = ElementTree.fromstring((FILES / name).read_text())
    number = itertools.count()
    bodies = root.findall("./worldbody//body")
    for element in [*bodies, *root.findall("./tendon/*")]:
        element.set("name", element.get("name", f"unnamed{next(number)}"))
    ElementTree.SubElement(bodies[-1], "site", name="tip")
    actuator = root.find("actuator")
    if actuator is None:
        actuator = ElementTree.SubElement(root, "actuator")
    for driver in list(actuator):
        if driver.tag == "muscle":
            driver.set("lengthrange", driver.get("lengthrange", LENGTHS))
        else:
            actuator.remove(driver)
    pulled = {muscle.get("tendon") for muscle in actuator}
    for tendon in root.findall("./tendon/spatial"):
        if tendon.get("name") not in pulled:
            ElementTree.SubElement(actuator, "muscle", tendon=tendon.get("name"), lengthrange=LENGTHS, force="20")
    if name == "tendon/tendon.xml":
        # What tendons run over touches, too.
        option = ElementTree.SubElement(root, "option")
        ElementTree.SubElement(option, "flag", contact="disable")
    return mujoco.MjSpec.from_string(ElementTree.tostring(root, encoding="unicode")), ("tip", bodies[0].get("name"))


@pytest.mark.parametrize("name", MODELS)
def test_every_quantity_is_mujocos(name, tmp_path):
    spec, landmarks = with_muscles(name)
    model, _, states = in_states(name.replace("/", "-"), landmarks, tmp_path, spec)
    assert len(states) == STATES and model.nu > 0
    worst = dict.fromkeys(MOST, 0.0)
    for state in states:
        for what, error in errors(model, state, NOTHING).items():
            worst[what] = max(worst[what], error)
    print(name, model.nv, model.nu, {what: f"{error:.1e}" for what, error in worst.items()})
    assert all(worst[what] < most for what, most in MOST.items()), worst


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_simulated_is_refused(name, tmp_path):
    spec, (tip, body) = with_muscles(name)
    path, _ = saved("refused", tmp_path, spec)
    with pytest.raises(pytest.fail.Exception) as refused:
        myo("model", "import", str(path), "--fingertip", tip, "--shoulder", body)
    assert REFUSED[name] in str(refused.value)
