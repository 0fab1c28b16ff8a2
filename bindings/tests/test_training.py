"""Training, policies, evaluation."""

import csv
import json

import numpy as np
import pytest

import myoenv

SMALL = {
    "settings": {"steps_per_update": 4, "policy_hidden": [16], "value_hidden": [16]},
    "num_envs": 32,
    "backend": "cpu",
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs") / "short"
    heard = []
    result = myoenv.train("pointing-single", seed=3, until=None, steps=1024, out=folder, callback=heard.append, **SMALL)
    assert len(heard) == result.updates == 8 and result.stopped_by == "steps" and result.env_steps == 1024
    return result


def test_a_run_folder_is_left(run):
    config = json.loads((run.run / "config.json").read_text())
    assert config["seed"] == 3 and config["run"]["task"]["name"] == "pointing-single"
    with open(run.run / "metrics.csv") as file:
        assert len(list(csv.DictReader(file))) == run.updates
    assert json.loads((run.run / "evaluation.json").read_text()) == run.evaluation
    assert list((run.run / "checkpoints").iterdir())


def test_the_policy_is_read_again(run):
    policy = myoenv.Policy.load(run.run)
    observation = myoenv.make("pointing-single").reset(seed=1)[0]
    action = policy(observation)
    assert action.shape == (26,) and (abs(action) <= 1).all()
    assert np.array_equal(action, run.policy(observation[np.newaxis])[0])
    for wrong in (observation[:-1], observation * np.nan, "text"):
        with pytest.raises(ValueError):
            policy(wrong)


def test_the_table_has_one_entry_per_episode(run):
    table = myoenv.evaluate(run.run, 70, num_envs=32)
    assert {len(column) for column in table.values()} == {70}
    assert np.array_equal(table["success"], myoenv.evaluate(run.run, 70, num_envs=32)["success"])
    assert np.isnan(table["target_1_time"][table["target_1_success"] == 0]).all()
    assert len(myoenv.evaluate(run.policy, 5, task="pointing-single")["return"]) == 5


def test_a_seed_gives_the_same_weights(run, tmp_path):
    again = myoenv.train("pointing-single", seed=3, until=None, steps=1024, **SMALL)
    observation = np.zeros((3, len(run.policy.observation_names)), np.float32)
    assert np.array_equal(again.policy(observation), run.policy(observation)) and again.run is None
    assert again.evaluation == run.evaluation


def test_a_callback_stops(tmp_path):
    result = myoenv.train("pointing-single", callback=lambda metrics: metrics["updates"] >= 2, **SMALL)
    assert result.stopped_by == "callback" and result.updates == 2


def test_an_easy_task_reaches_its_goal(short_task):
    short_task["targets"][0]["radius"] = 1.5
    result = myoenv.train(short_task, steps=20_000, **SMALL)
    assert result.stopped_by == "until" and result.evaluation["success"] >= 0.95


@pytest.mark.parametrize(
    ("kwargs", "error", "sentence"),
    [
        ({"settings": {"gama": 0.9}}, ValueError, "unknown field `gama`"),
        ({"settings": {"gamma": 2}}, ValueError, "gamma is 2"),
        ({"settings": {"gamma": object()}}, ValueError, "bad training setting"),
        ({"until": 1.5}, ValueError, "until is 1.5"),
        ({"steps": 0}, ValueError, "steps is 0"),
        ({"seed": "one"}, TypeError, "seed is 'one'"),
    ],
)
def test_bad_arguments(kwargs, error, sentence):
    with pytest.raises(error, match=sentence):
        myoenv.train("pointing-single", **kwargs)


def test_runs_are_not_overwritten(run):
    with pytest.raises(FileExistsError, match="never overwritten"):
        myoenv.train("pointing-single", steps=100, out=run.run, **SMALL)


def test_what_is_no_run_is_told(tmp_path, run):
    with pytest.raises(myoenv.TrainingError, match="not a run folder"):
        myoenv.Policy.load(tmp_path / "nothing")
    with pytest.raises(myoenv.TrainingError, match="not a run folder"):
        myoenv.evaluate(tmp_path)
    with pytest.raises(ValueError, match="knows no task"):
        myoenv.evaluate(run.policy)
