"""Several layouts side by side, and users who learn all of them or are asked about another."""

import copy
import json

import numpy as np
import pytest

import myoenv

SMALL = {"rollout_s": 0.8, "policy_hidden": [16], "value_hidden": [16]}


@pytest.fixture
def layouts(short_task) -> list[dict]:
    """Two places of one sphere, the second with more time."""
    far = copy.deepcopy(short_task)
    far["name"], far["time_limit_s"] = "far", 0.6
    far["targets"][0]["position"] = {"x": 0.35, "y": [0.15, 0.25], "z": [-0.1, 0.1]}
    return [short_task, far]


@pytest.fixture
def two_targets(short_task) -> dict:
    """More steps, and of the same kind."""
    task = copy.deepcopy(short_task)
    task["targets"].append({**task["targets"][0], "min_distance_from_previous": 0})
    return {**task, "name": "two"}


def test_every_environment_does_its_layout_as_if_it_were_alone(make, layouts):
    envs = myoenv.make_vec(num_envs=7, backend="cpu", layouts=layouts, seed=1)
    assert [task.name for task in envs.layouts] == ["short", "far"] and envs.max_episode_steps == 12
    together = envs.reset(seed=5)[0]
    assert together in envs.observation_space
    alone = [make(layout, num_envs=7) for layout in layouts]
    observations = [one.reset(seed=5)[0] for one in alone]
    for step in range(15):
        for k, observation in enumerate(observations):
            assert np.array_equal(together[k::2], observation[k::2]), step
        actions = np.full(envs.action_space.shape, np.sin(step), np.float32)
        together = envs.step(actions)[0]
        observations = [one.step(actions)[0] for one in alone]
    # Who looks on sees each in its own scene.
    for k, one in enumerate(alone):
        assert np.array_equal(envs.peek(k, k + 1).object_positions, one.peek(k, k + 1).object_positions)
        assert np.array_equal(envs.render_env(k), one.render_env(k))
    envs.set_task(layouts[1])
    assert [task.name for task in envs.layouts] == ["far"]
    envs.close()


def test_layouts_that_do_not_belong_together_are_refused(layouts, two_targets):
    with pytest.raises(ValueError, match="it has 2 steps instead of 1"):
        myoenv.make_vec(num_envs=4, backend="cpu", layouts=[layouts[0], two_targets])
    with pytest.raises(ValueError, match="2 layouts need an environment each; there are 1"):
        myoenv.make_vec(num_envs=1, backend="cpu", layouts=layouts)
    with pytest.raises(ValueError, match="layout 2 is for the body mobl-arms-uitb and the first for mobl-arms"):
        myoenv.make_vec(num_envs=4, layouts=[layouts[0], {**layouts[1], "model": "mobl-arms-uitb"}])
    with pytest.raises(ValueError, match="not both"):
        myoenv.make_vec("ar", 4, layouts=layouts)
    with pytest.raises(ValueError, match="name a task"):
        myoenv.make_vec(num_envs=4)
    for wrong in ("ar", [], 3):
        with pytest.raises(TypeError, match="layouts is a list of tasks"):
            myoenv.make_vec(num_envs=4, layouts=wrong)


def test_one_policy_learns_several_layouts(tmp_path, layouts, two_targets):
    training = {"settings": SMALL, "num_envs": 32, "until": None, "backend": "cpu"}
    run = myoenv.train(layouts=layouts, steps=2048, out=tmp_path / "run", **training)
    assert [layout["episodes"] for layout in run.evaluation["layouts"]] == [1000, 1000]
    mean = np.mean([layout["return"] for layout in run.evaluation["layouts"]])
    assert run.evaluation["return"] == pytest.approx(mean)
    description = myoenv.runs.read_run(run.run)
    assert [task["name"] for task in description.layouts] == ["short", "far"]
    assert json.loads((tmp_path / "run" / "evaluation.json").read_text()) == run.evaluation

    heard = []
    resumed = myoenv.train(resume=run.run, steps=4096, callback=heard.append)
    assert {"layout_1_success", "layout_2_success"} <= heard[0].keys()
    whole = myoenv.train(layouts=layouts, steps=4096, out=tmp_path / "whole", **training)
    assert resumed.evaluation == whole.evaluation, "as if it had not been stopped"
    with pytest.raises(ValueError, match="leave out layouts"):
        myoenv.train(resume=run.run, layouts=layouts)

    table = myoenv.evaluate(run.run, 5, num_envs=3)
    assert np.bincount(table["layout"]).tolist() == [5, 5]
    assert table["length"][table["layout"] == 0].max() <= 8 < table["length"][table["layout"] == 1].max()
    assert "layout" not in myoenv.evaluate(run.run, 5, task=layouts[1])
    assert len(myoenv.evaluate(run.run, 5, task=two_targets)["return"]) == 5, "a layout that it was not trained on"


def test_a_user_is_not_asked_about_a_layout_where_it_cannot_act(tmp_path, short_task, fast):
    run = myoenv.train(short_task, settings=SMALL, num_envs=32, steps=512, until=None, out=tmp_path / "run").run
    for other, sentence in [
        ({**short_task, "model": "mobl-arms-uitb"}, "its body is mobl-arms-uitb instead of mobl-arms"),
        (fast("wall-ray"), "its technique is a ray from the forearm onto a display instead of the fingertip; `pointer"),
        (
            fast("slider"),
            "`drag` is perceived there, and was not in training .it is there only where there is a slider",
        ),
        ({**short_task, "control_dt_s": 0.01}, "its control step is 0.01 s instead of 0.05 s"),
    ]:
        with pytest.raises(ValueError, match=sentence):
            myoenv.evaluate(run, 5, task=other)
