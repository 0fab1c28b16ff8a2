"""Every example runs, shortly, and prints its speed."""

import re
from importlib.util import find_spec

import pytest
from conftest import EXAMPLES, run_example

# Example, the packages that it needs, and arguments that make it short.
CASES = [
    ("sb3_ppo.py", ["stable_baselines3"], ["--envs", "32", "--steps", "6144"]),
    ("cleanrl_ppo.py", ["torch"], ["--envs", "32", "--steps", "1024"]),
    ("jax_ppo.py", ["jax"], ["--envs", "32", "--steps", "1024"]),
    ("rsl_rl_ppo.py", ["rsl_rl"], ["--envs", "32", "--steps", "1024"]),
    ("skrl_ppo.py", ["skrl"], ["--envs", "32", "--steps", "1024"]),
    ("sweep.py", ["ray"], ["--columns", "2", "--rows", "1", "--seeds", "1", "--steps", "16384"]),
    ("speed.py", ["jax"], ["--jax", "--envs", "1", "64", "--seconds", "1", "--rounds", "1"]),
    # The others' environments are left out: they are no part of the tests.
    ("compare.py", [], ["--only", "myoenv", "myoenv.myosuite", "--seconds", "0.1", "--rounds", "1"]),
]


def test_every_example_is_run():
    # RLlib's has its test in an environment of its own.
    assert {path.name for path in EXAMPLES.glob("*.py")} == {case[0] for case in CASES} | {"rllib_ppo.py"}


@pytest.mark.parametrize(("example", "needs", "short"), CASES, ids=[case[0] for case in CASES])
def test_example_runs(example, needs, short, tmp_path):
    missing = [package for package in needs if find_spec(package) is None]
    if missing:
        pytest.skip(f"{example} needs {', '.join(missing)}, which is not installed")
    assert re.search(r"\d (control )?steps/s", run_example(example, *short, cwd=tmp_path))
