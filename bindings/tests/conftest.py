"""Shared by all tests."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import myoenv

EXAMPLES = Path(__file__).parents[1] / "examples"
PRESETS = Path(__file__).parents[2] / "myo-tasks" / "presets"

MODES = ["next_step", "same_step", "disabled"]


@pytest.fixture
def make() -> Callable[..., myoenv.MyoVectorEnv]:
    """Makes environments on the processor that are closed after the test."""
    made = []

    def build(task="pointing-single", num_envs=8, **kwargs):
        made.append(myoenv.make_vec(task, num_envs, "cpu", **kwargs))
        return made[-1]

    yield build
    for env in made:
        env.close()


@pytest.fixture
def fast(tmp_path) -> Callable[[str], Path]:
    """Writes presets done by the fastest user, on a body of straight muscles: what is tested with them is quick."""

    def write(preset: str) -> Path:
        path = tmp_path / f"{preset}.yaml"
        text = (PRESETS / path.name).read_text()
        path.write_text(text.replace("version: 2\n", "version: 2\nuser: fastest\nmodel: mobl-arms\n", 1))
        return path

    return write


@pytest.fixture
def short_task() -> dict:
    """A task whose episodes end soon, one way or the other."""
    anywhere = {"x": 0.3, "y": [-0.1, 0.1], "z": [-0.3, -0.1]}
    return {
        "version": 1,
        "name": "short",
        "time_limit_s": 0.4,
        "targets": [{"kind": "pointing", "position": anywhere, "radius": 0.3, "dwell_s": 0.05}],
    }


def relaxed(env) -> np.ndarray:
    """Actions that relax all muscles."""
    return np.full(env.action_space.shape, -1, np.float32)


def run_example(example: str, *arguments: str, cwd: Path) -> str:
    """Runs an example to its end; what it prints."""
    command = [sys.executable, EXAMPLES / example, *arguments]
    # One thread of PyTorch: more of them than processors make small networks slow.
    env = {**os.environ, "OMP_NUM_THREADS": "1"}
    run = subprocess.run(command, cwd=cwd, env=env, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr[-4000:]
    return run.stdout
