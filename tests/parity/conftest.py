"""Myo's quantities and the same model in MuJoCo.

`cargo run -p myo-dynamics --example parity -- DIRECTORY` computes everything once; MYO_PARITY_DATA names a directory
where that has been done already. The directory holds

    model.xml      the arm as exported
    press.xml      the same with one box named `button`
    states.json    [{qpos, qvel, act, ctrl, tendon_length, tendon_velocity, muscle_force, qfrc_bias, qfrc_passive, qacc_soft}]
    rollouts.json  [{qpos0, qvel0, act0, ctrl: one row per control step, qpos_reduced, qpos_lanes: one row after each}]
    press.json     [{qpos, qvel, act, ctrl, button: {pos, quat}, touch_force}]
    keys.xml       the arm with a thick fingertip, and six boxes named `key0` to `key5`
    keys.json      [{qpos, qvel, act, ctrl, keys: their positions, quat: of all, touch_forces, qacc_soft}]
    gadget.xml     a small body with slides, curved couplings and implicit damping
    gadget.json    [{qpos, qvel, act, ctrl, qacc, muscle_force, qpos_next, qvel_next, act_next}]
    balloon.xml    a free body with a tail on a ball joint
    balloon.json   the same of it
    wraps.xml      a small body with muscles over spheres and cylinders
    wraps.json     [{qpos, qvel, act, ctrl, tendon_length, tendon_velocity, moments: one row per muscle, muscle_force, qacc,
                    bends: of each stretch over something, onset: index of the one that begins to bend nearby, or null}]
    wraps_mujoco3.json  the same by the rule of sides that MuJoCo had before 4.0

Positions are in full coordinates, joints in the order of the model; forces have MuJoCo's sign (a pull is negative).
"""

import json
import os
import pathlib
import subprocess

import mujoco
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
MUJOCO = int(mujoco.__version__.split(".")[0])


def output(*command):
    """Standard output of a command; the test errors with its own words if it fails."""
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        pytest.fail(f"`{' '.join(command)}` failed:\n{done.stderr[-4000:]}", pytrace=False)
    return done.stdout


def myo(*arguments):
    """Standard output of `myo`: of the program that MYO_PROGRAM names, or of what cargo makes of it, which for a package
    alone compiles all crates once more."""
    program = os.environ.get("MYO_PROGRAM")
    return output(*([program] if program else ["cargo", "run", "--quiet", "-p", "myo-sim", "--"]), *arguments)


@pytest.fixture(scope="session")
def data(tmp_path_factory):
    """Directory with what Myo computed."""
    if "MYO_PARITY_DATA" in os.environ:
        return pathlib.Path(os.environ["MYO_PARITY_DATA"])
    directory = tmp_path_factory.mktemp("parity")
    output("cargo", "run", "--quiet", "-p", "myo-dynamics", "--example", "parity", "--", str(directory))
    return directory


def written(path):
    """The text of a file that the example wrote."""
    if not path.exists():
        pytest.fail(f"{path} is missing; the example `parity` of myo-dynamics writes it", pytrace=False)
    return path.read_text()


def read(path):
    return json.loads(written(path))


@pytest.fixture(scope="session")
def states(data):
    return read(data / "states.json")


@pytest.fixture(scope="session")
def rollouts(data):
    return read(data / "rollouts.json")


@pytest.fixture(scope="session")
def presses(data):
    return read(data / "press.json")


def load(path):
    """The model with a solver that runs until nothing improves any more."""
    model = mujoco.MjModel.from_xml_string(written(path))
    model.opt.tolerance = 0
    model.opt.iterations = 200
    model.opt.ls_tolerance = 1e-12
    model.opt.ls_iterations = 200
    return model


@pytest.fixture(scope="session")
def arm(data):
    return load(data / "model.xml")


@pytest.fixture(scope="session")
def arm_with_button(data):
    return load(data / "press.xml")


@pytest.fixture(scope="session")
def arm_with_keys(data):
    return load(data / "keys.xml")


@pytest.fixture(scope="session")
def key_presses(data):
    return read(data / "keys.json")


@pytest.fixture(scope="session")
def wraps(data):
    return load(data / "wraps.xml")


@pytest.fixture(scope="session")
def wrap_states(data):
    return read(data / ("wraps.json" if MUJOCO >= 4 else "wraps_mujoco3.json"))
