"""Every example runs, shortly, and prints its speed."""

import os
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[1] / "examples"

# Example, the packages that it needs, and arguments that make it short.
CASES = [
    ("sb3_ppo.py", ["stable_baselines3"], ["--envs", "32", "--steps", "6144"]),
    ("cleanrl_ppo.py", ["torch"], ["--envs", "32", "--steps", "1024"]),
    ("jax_ppo.py", ["jax"], ["--envs", "32", "--steps", "1024"]),
    ("rsl_rl_ppo.py", ["rsl_rl"], ["--envs", "32", "--steps", "1024"]),
    ("skrl_ppo.py", ["skrl"], ["--envs", "32", "--steps", "1024"]),
    ("rllib_ppo.py", ["ray.rllib", "torch"], ["--envs", "8", "--steps", "512"]),
    ("sweep.py", ["ray"], ["--columns", "2", "--rows", "1", "--seeds", "1", "--steps", "16384"]),
]


def is_there(package: str) -> bool:
    try:
        return find_spec(package) is not None
    except ModuleNotFoundError:
        return False


def test_every_trainer_is_listed():
    assert {path.name for path in EXAMPLES.glob("*_ppo.py")} <= {case[0] for case in CASES}


@pytest.mark.parametrize(("example", "needs", "short"), CASES, ids=[case[0] for case in CASES])
def test_example_runs(example, needs, short, tmp_path):
    missing = [package for package in needs if not is_there(package)]
    if missing:
        pytest.skip(f"{example} needs {', '.join(missing)}, which is not installed")
    command = [sys.executable, EXAMPLES / example, *short]
    # One thread of PyTorch: more of them than processors make small networks slow.
    env = {**os.environ, "OMP_NUM_THREADS": "1"}
    run = subprocess.run(command, cwd=tmp_path, env=env, capture_output=True, text=True, timeout=600, check=False)
    assert run.returncode == 0, run.stderr[-4000:]
    assert re.search(r"\d steps/s", run.stdout), run.stdout
