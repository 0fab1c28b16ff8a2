"""What users install: one wheel, in an environment that has nothing else; and a source distribution that is whole."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(
    not (ROOT / "Cargo.toml").exists() or shutil.which("cargo") is None,
    reason="cargo is missing: no wheel can be built",
)

# Made of what `./test` has compiled already, or, with `--all`, as `pip install .` makes it.
SOON = ["--profile", "dev", "--features", "beside-tests"]
BUILD = ["--profile", "release"] if os.environ.get("MYO_TEST_ALL") else SOON

# What a user does first, with nothing but what the wheel brings.
USE = """
import importlib.metadata, pathlib, sys
import numpy as np
import myoenv

folder = pathlib.Path(myoenv.__file__).parent
assert pathlib.Path(sys.prefix) in folder.parents, folder
assert myoenv.__version__ == importlib.metadata.version("myoenv")
envs = myoenv.make_vec("pointing-uitb", 16, "cpu", seed=1)
envs.reset()
observation, reward, *_ = envs.step(envs.action_space.sample())
assert observation.shape == (16, 57) and np.isfinite(reward).all()
result = myoenv.train("pointing-single", until=None, steps=1024, num_envs=64, backend="cpu", out="run")
assert np.array_equal(myoenv.Policy.load("run")(observation), result.policy(observation))
print("installed and used")
"""


def run(*command, **options) -> str:
    """Runs a command to its end; what it prints."""
    done = subprocess.run(command, capture_output=True, text=True, timeout=1500, check=False, **options)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """A folder with a wheel and a source distribution."""
    out = tmp_path_factory.mktemp("dist")
    run(sys.executable, "-m", "maturin", "build", "--locked", *BUILD, "--out", str(out), cwd=ROOT)
    run(sys.executable, "-m", "maturin", "sdist", "--out", str(out), cwd=ROOT)
    return out


def test_there_is_one_wheel_for_all_versions_of_python(built):
    [wheel] = built.glob("*.whl")
    assert re.fullmatch(r"myoenv-[\d.]+-cp311-abi3-\w+\.whl", wheel.name)
    there = set(zipfile.ZipFile(wheel).namelist())
    sources = {
        f"myoenv/{path.name}" for path in (ROOT / "bindings/python/myoenv").glob("*.py*") if path.suffix != ".pyc"
    }
    assert {"myoenv/py.typed", "myoenv/_native.pyi"} <= there and sources <= there | {"myoenv/_native.pyd"}
    compiled = [name for name in there if re.fullmatch(r"myoenv/_native[\w.]*\.(so|pyd)", name)]
    assert len(compiled) == 1
    others = {name for name in there if not name.startswith("myoenv")}
    assert not others, "nothing is installed beside the package"


def test_the_wheel_is_installed_and_used_where_nothing_else_is(built, tmp_path):
    [wheel] = built.glob("*.whl")
    venv.create(tmp_path / "fresh", with_pip=True)
    python = tmp_path / "fresh" / ("Scripts" if os.name == "nt" else "bin") / "python"
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", wheel, cwd=tmp_path, env=environment)
    assert run(python, "-c", USE, cwd=tmp_path, env=environment).endswith("installed and used\n")


def test_the_source_distribution_has_every_crate_that_it_is_built_of(built, tmp_path):
    [archive] = built.glob("*.tar.gz")
    with tarfile.open(archive) as file:
        file.extractall(tmp_path, filter="data")
    [folder] = tmp_path.iterdir()
    assert (folder / "pyproject.toml").exists() and (folder / "Cargo.lock").exists()
    # Resolves what is left of the workspace, and fails where a crate or a version is not as it must be. Crates that the
    # package does not need, such as the benches, are not there, nor stay in the lock file what only they need.
    run("cargo", "metadata", "--offline", "--format-version", "1", cwd=folder)
    locked, ours = (tomllib.loads((at / "Cargo.lock").read_text())["package"] for at in (folder, ROOT))
    versions = [{(package["name"], package["version"]) for package in lock} for lock in (locked, ours)]
    assert versions[0] < versions[1]
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["dependencies"]
    for name, dependency in workspace.items():
        if isinstance(dependency, dict) and "path" in dependency:
            ours, theirs = ROOT / dependency["path"], folder / dependency["path"]
            sources = {path.relative_to(ours) for path in (ours / "src").rglob("*") if path.is_file()}
            assert sources <= {path.relative_to(theirs) for path in theirs.rglob("*")}, name
