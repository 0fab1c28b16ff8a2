"""Which user moves as the people of recordings do."""

import json

import numpy as np
import pytest

import myoenv
from myoenv import _native

PAIRS = [(0.1, 0.05), (0.2, 0.05), (0.3, 0.03)]


def table(movements=8, pairs=PAIRS, participant="anna"):
    """Somebody who goes to and fro by minimum jerk, a little differently each time, as columns."""
    chance = np.random.default_rng(3)
    columns = {
        name: []
        for name in ("participant", "trial", "time_s", "x_m", "y_m", "target_x_m", "target_y_m", "target_width_m")
    }
    for number, (distance, width) in enumerate(pairs):
        now, at = 0.0, 0.0
        for movement in range(movements + 1):
            target = distance if movement % 2 == 0 else 0.0
            end = target + 0.2 * width * chance.normal()
            took = 0.3 + 0.1 * np.log2(distance / width + 1) + 0.03 * chance.normal()
            for time in np.arange(0, took + 0.3, 0.01):
                s = min(time / took, 1)
                share = s**3 * (10 - 15 * s + 6 * s * s)
                row = (
                    participant,
                    number,
                    now + time,
                    at + share * (end - at),
                    0.01 * np.sin(np.pi * share),
                    target,
                    0.0,
                    width,
                )
                for column, value in zip(columns.values(), row, strict=True):
                    column.append(value)
            now, at = now + took + 0.31, end
    return columns


def csv(columns):
    rows = zip(*columns.values(), strict=True)
    return "\n".join([",".join(columns), *(",".join(map(str, row)) for row in rows)]) + "\n"


@pytest.fixture
def people(tmp_path):
    path = tmp_path / "people.csv"
    path.write_text(csv(table()))
    return path


def test_muscles_that_the_body_has_not_are_refused_before_anybody_practises(tmp_path):
    columns = table()
    columns["DELT_activation"] = [0.1] * len(columns["x_m"])
    with pytest.raises(ValueError, match=r"has no muscle `DELT`; did you mean `DELT1`.*`note_`"):
        _write_and_fit(tmp_path, columns)


def test_what_cannot_be_fitted_is_said_before_anybody_practises(people, tmp_path):
    with pytest.raises(ValueError, match=r"anna: 18 movements in 2 pairs .* a fit needs 3 pairs"):
        _write_and_fit(tmp_path, table(pairs=PAIRS[:2]))
    with pytest.raises(ValueError, match="no column `trial`"):
        _write_and_fit(
            tmp_path,
            {"time_s": [0], "x_m": [0], "y_m": [0], "target_x_m": [0], "target_y_m": [0], "target_width_m": [1]},
        )
    with pytest.raises(ValueError, match="user is fastest, who has no noise"):
        myoenv.fit(people, user="fastest")
    with pytest.raises(TypeError, match="fit chooses layouts itself"):
        myoenv.fit(people, layouts=["pointing"])
    with pytest.raises(TypeError, match="recordings is 3; it must be a path"):
        myoenv.fit(3)
    with pytest.raises(ValueError, match="40 and 50 ms are the same number of control steps of 40 ms"):
        myoenv.fit(people, vision_delay_ms=[40, 80, 50], practised=tmp_path / "nobody")
    for trainings, most in ((0, "at least 1"), (21, "at most 20")):
        with pytest.raises(ValueError, match=f"trainings is {trainings}; it must be {most}"):
            myoenv.fit(people, trainings=trainings, practised=tmp_path / "nobody")
    with pytest.raises(TypeError, match=r"height_m is 1\.7; it must be a sequence of numbers"):
        myoenv.fit(people, height_m=1.7)
    with pytest.raises((ValueError, myoenv.TaskError), match=r"body\.height_m"):
        myoenv.fit(people, height_m=[1.7, 5], practised=tmp_path / "nobody")
    assert not list(tmp_path.glob("runs")) and not list(tmp_path.glob("nobody*"))


def test_a_data_frame_is_such_a_table_and_all_its_people_may_be_one(tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = pandas.concat([pandas.DataFrame(table(participant=name, pairs=PAIRS[:2])) for name in ("anna", "bert")])
    for together, who in ((False, "anna: 18"), (True, "all 2 participants: 36")):
        with pytest.raises(ValueError, match=f"{who} movements in 2 pairs"):
            myoenv.fit(frame, together=together, practised=tmp_path / "nobody")


# Beginners with so few environments.
@pytest.mark.filterwarnings("ignore:training ran away")
def test_who_is_interrupted_has_not_learnt_it_and_goes_on(people, tmp_path):
    def stop(_):
        raise KeyboardInterrupt

    how = {"num_envs": 64, "backend": "cpu", "until": None, "steps": 1 << 20, "practised": tmp_path / "somebody"}
    steps = []
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt):
            myoenv.fit(people, trainings=2, callback=stop, **how)
        assert [path.name for path in (tmp_path / "somebody").iterdir()] == ["seed-1-practising"]
        metrics = (tmp_path / "somebody/seed-1-practising/metrics.csv").read_text().splitlines()
        steps.append(len(metrics))
    assert steps[1] > steps[0]


def _write_and_fit(folder, columns):
    path = folder / "other.csv"
    path.write_text(csv(columns))
    return myoenv.fit(path, practised=folder / "nobody")


def test_layouts_to_become_anybody_in_differ_in_traits_alone():
    texts = _native.fitting_layouts(myoenv.load_task("pointing"))
    layouts = [myoenv.to_dict(_native.Task.from_yaml(text)) for text in texts]
    costs = {(one["reward"]["effort_cost"], one["reward"]["control_change_cost"]) for one in layouts}
    assert len(layouts) == len(costs) == 64
    assert all(one["observation"]["traits"] and one["scene"] == layouts[0]["scene"] for one in layouts)
    settings = json.loads(_native.fitting_settings(myoenv.load_task("pointing")))
    assert settings["log_std_min"] <= -3.5


def test_each_candidate_has_a_task_of_its_own():
    task = myoenv.load_task("pointing")
    found = _native.fitting_candidates(task, [40, 120], [1.6])
    assert [suffix for suffix, _ in found] == ["-40ms-1.6m", "-120ms-1.6m"]
    tasks = [myoenv.to_dict(_native.Task.from_yaml(text)) for _, text in found]
    assert [(one["perception"]["vision_delay_ms"], one["body"]["height_m"]) for one in tasks] == [(40, 1.6), (120, 1.6)]
    assert _native.fitting_candidates(task, [], [])[0][0] == ""


def test_a_beginner_can_be_nobody(people, tmp_path):
    task = myoenv.load_task(
        {
            "version": 2,
            "name": "human",
            "user": "human",
            "model": "mobl-arms",
            "scene": {"ball": {"kind": "sphere", "at": [0.4, 0, 0], "radius": 0.05}},
            "script": [{"dwell": {"in": "ball", "for_s": 0.25}}],
        }
    )
    layouts = [_native.Task.from_yaml(text) for text in _native.fitting_layouts(task)]
    practised = tmp_path / "beginner"
    # Steps so small that nothing runs away.
    how = {"until": None, "num_envs": 64, "settings": {"learning_rate": 1e-5}, "backend": "cpu"}
    for seed in (1, 2):
        myoenv.train(layouts=layouts, steps=2048, out=practised / f"seed-{seed}", seed=seed, **how)
    wanted = "of 32 natures only 0 could do what anna did, and at least 1 are needed"
    with pytest.raises(ValueError, match=wanted):
        myoenv.fit(people, user=task, practised=practised, trainings=2)
    # Who practised as somebody else is not taken for this user.
    other = {**myoenv.to_dict(task), "control_dt_s": 0.02}
    with pytest.raises(ValueError, match="practised other tasks than are asked for now"):
        myoenv.fit(people, user=other, practised=practised, trainings=2)
