"""Findings about layouts, asked of users who only pretend."""

import sys
from pathlib import Path

import pytest

import myoenv

BENCHES = Path(__file__).resolve().parent.parent
sys.path[:0] = [str(BENCHES)]

import findings  # noqa: E402

#: Makes the folder of a run, and tells of users as slow as the name of their task says; that of seed 2 learnt nothing.
PRETENDS = """#!{python}
import json, pathlib, sys
words = sys.argv[1:]
if words[:2] == ["train", "--resume"]:
    assert pathlib.Path(words[2]).is_dir() and len(words) == 3
elif words[0] == "train":
    runs = pathlib.Path(words[words.index("--out") + 1])
    tasks = [json.load(open(word)) for word in words[1:] if word.endswith(".yaml")]
    for seed in range(1, int(words[words.index("--seeds") + 1]) + 1):
        run = runs / f"seed-{{seed}}"
        run.mkdir(parents=True)
        (run / "tasks.json").write_text(json.dumps(tasks))
    assert ("--together" in words) == (len(tasks) > 1)
    assert words[-2:] == ["--steps", "1k"]
else:
    run = pathlib.Path(words[1])
    tasks = json.loads((run / "tasks.json").read_text())
    success = 0.1 if run.name.endswith("-2") else 0.9
    cost = {{"upper": 2, "shoulder": 2}}
    each = lambda task: {{
        "targets": [{{"movement_time_s": cost.get(task["name"], 1)}}] * len(task["script"]),
        "effort": cost.get(task["name"], 1),
        "fatigue": 1,
        "success": success,
    }}
    print(json.dumps({{**each(tasks[0]), "layouts": [each(task) for task in tasks]}}))
"""


@pytest.fixture
def asked(tmp_path, monkeypatch, capsys):
    """What the script prints for some findings, and its exit status."""
    program = tmp_path / "myo"
    program.write_text(PRETENDS.format(python=sys.executable))
    program.chmod(0o755)

    def ask(only, seeds):
        words = ["--seeds", str(seeds), "--only", only, "--myo", str(program), "--out", str(tmp_path / "runs")]
        monkeypatch.setattr(sys, "argv", ["findings.py", *words, "--", "--steps", "1k"])
        return findings.main(), capsys.readouterr().out

    return ask


def test_every_study_is_a_task_of_the_human_user():
    tasks = [task for _, _, studies, _ in findings.FINDINGS for study in studies for task in study]
    assert len({task["name"] for task in tasks}) == len(tasks) == 32
    for task in tasks:
        assert task["user"] == "human"
        targets = {"ball": 5, "keys": 5, "start": 3, "b1": 9}
        first = next(iter(task["scene"]))
        assert myoenv.load_task(task).num_targets == targets.get(first, len(task["script"]))


def test_a_finding_holds_when_every_seed_has_its_sign(asked):
    status, told = asked("1,4", 1)
    assert status == 0
    assert "upper 2.000 s, lower 1.000 s" in told
    assert "4 the height of the shoulder costs more: right in 1 of 1" in told
    assert asked("1", 1) == (0, told.split("  seed 1 right: shoulder")[0]), "who was trained is asked again"


def test_a_user_who_learnt_nothing_has_no_sign(asked):
    status, told = asked("1", 2)
    assert status == 1
    assert "seed 2 WRONG: not learnt: 10 % of the episodes of one succeed" in told
    assert "right in 1 of 2" in told


def user(times, wrong=0.0):
    """The figures of a user with these movement times."""
    return {"targets": [{"movement_time_s": time} for time in times], "wrong_presses": wrong, "success": 1.0}


def tired(least, centred=2.0):
    """The figures of a user whom the layout of this number tires least."""
    layouts = [{"fatigue": 3.0} for _ in findings.TRIPLES]
    layouts[findings.CENTRED]["fatigue"] = centred
    layouts[least]["fatigue"] = 1.0
    return [{"layouts": layouts, "success": 1.0}]


def test_signs_are_those_of_the_list():
    assert findings.against_fatigue(tired(3), [tired(3), tired(3), tired(8)])[0]
    assert not findings.against_fatigue(tired(8), [tired(3), tired(3)])[0], "chosen by others alone"
    assert not findings.against_fatigue(tired(3, 0.5), [tired(3, 0.5)])[0]
    errors = [2.0, 1.0, 0.5, 0.1, 0.1]
    keys = [user([0.5 - 0.01 * n] * 5, wrong) for n, wrong in enumerate(errors)]
    assert findings.larger_keys(keys)[0]
    assert not findings.larger_keys(keys[::-1])[0]
    assert findings.other_side([user([0.3, 0.5, 0.3, 0.4])])[0]
    assert not findings.other_side([user([0.3, 0.4, 0.3, 0.5])])[0]
    in_proportion = [user([0.3, 0.0, 0.1 + 0.05 * 30 / width]) for width in findings.WIDTHS_CM]
    assert findings.steering(in_proportion)[0]
    assert not findings.steering(in_proportion[::-1])[0]
    assert not findings.steering([*in_proportion[:3], user([0.3, 0.0, None])])[0]
