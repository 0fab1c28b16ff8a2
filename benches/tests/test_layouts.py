"""Layouts that nobody tuned for."""

import json
import random
import sys
from pathlib import Path

import pytest

import myoenv

BENCHES = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(BENCHES)]

import layouts  # noqa: E402

#: Finds fault with tasks that have a button, and says that users of layout 2 fail.
PRETENDS = """#!{python}
import json, sys
task = json.load(open(sys.argv[3]))
if sys.argv[1] == "task":
    buttons = [thing for thing in task["scene"].values() if thing["kind"] == "button"]
    print(json.dumps({{"ok": True, "errors": [], "warnings": buttons}}))
else:
    stopped_by = "steps" if task["name"] == "layout-2" else "until"
    rows = [{{"seed": seed, "env_steps": seed * 1000000, "stopped_by": stopped_by}} for seed in (1, 2, 6)]
    print(json.dumps({{"rows": rows, "reached": 0 if stopped_by == "steps" else 3}}))
"""


@pytest.fixture
def program(tmp_path):
    """A program that only pretends."""
    program = tmp_path / "myo"
    program.write_text(PRETENDS.format(python=sys.executable))
    program.chmod(0o755)
    return str(program)


def test_layouts_are_tasks_of_spheres_and_buttons_and_the_same_each_time():
    drawn = [layouts.draw(random.Random(seed), "drawn", 6) for seed in range(8)]
    assert drawn == [layouts.draw(random.Random(seed), "drawn", 6) for seed in range(8)]
    kinds = {thing["kind"] for layout in drawn for thing in layout["scene"].values()}
    assert kinds == {"sphere", "button"}
    for layout in drawn:
        task = myoenv.load_task(layout)
        assert (task.name, task.num_targets) == ("drawn", 6)


def test_only_layouts_without_warnings_are_taken(tmp_path, program):
    files = layouts.layouts(3, tmp_path, program)
    assert [file.stem for file in files] == ["layout-1", "layout-2", "layout-3"]
    tasks = [json.loads(file.read_text()) for file in files]
    assert all(thing["kind"] == "sphere" for task in tasks for thing in task["scene"].values())
    assert all(3 <= len(task["scene"]) == len(task["script"]) <= 6 for task in tasks)


def test_the_slowest_and_those_who_fail_are_told(tmp_path, program, monkeypatch, capsys):
    out = tmp_path / "rows.json"
    command = ["layouts.py", "--layouts", "3", "--seeds", "3", "--myo", program, "--out", str(out)]
    monkeypatch.setattr(sys, "argv", command)
    assert layouts.main() == 1
    told = capsys.readouterr().out.splitlines()
    assert told[1] == "layout-2: 0 of 3 reached it; 1.0 2.0 6.0 M control steps"
    assert told[3] == ("6 of 9 users reached it; median 2.0 M control steps, slowest 6.0 M, 3.0 times as many")
    assert len(json.loads(out.read_text())) == 9
