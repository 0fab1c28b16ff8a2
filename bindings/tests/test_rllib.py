"""RLlib, in the environment that has its version of Gymnasium."""

import re

import pytest
from conftest import run_example

pytest.importorskip("ray.rllib", reason="RLlib is not installed", exc_type=ImportError)


def test_its_example_runs(tmp_path):
    printed = run_example("rllib_ppo.py", "--envs", "8", "--steps", "512", cwd=tmp_path)
    assert re.search(r"\d steps/s", printed)
