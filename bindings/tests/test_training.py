"""Training, policies, evaluation."""

import csv
import json
import re
import shutil

import numpy as np
import pytest

import myoenv
from myoenv import _native
from myoenv.runs import read_run
from myoenv.session import Session

SMALL = {
    "settings": {"rollout_s": 0.2, "policy_hidden": [16], "value_hidden": [16]},
    "num_envs": 32,
    "backend": "cpu",
}


#: A task of which a user is told less.
OTHER_OBSERVATIONS = myoenv.to_dict(myoenv.load_task("pointing-single"))
OTHER_OBSERVATIONS["observation"]["touch"] = False


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


def test_progress_is_the_line_of_the_command(monkeypatch, capsys, short_task):
    monkeypatch.setattr("myoenv.session._LINE_EVERY", 0.0)
    short_task["targets"][0]["min_distance_from_previous"] = 0
    short_task["targets"] *= 2
    myoenv.train(short_task, steps=4096, until=None, progress=True, **SMALL)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 32 and all(" steps, " in line and line.endswith(" left") for line in lines), lines
    assert re.search(r", bottleneck target [12] \((pointing|pressing)\) at \d+ %, ", lines[-1]), lines[-1]
    myoenv.train(short_task, steps=128, until=None, **SMALL)
    assert capsys.readouterr().err == ""


def test_the_policy_is_read_again(run):
    policy = myoenv.Policy.load(run.run)
    observation = myoenv.make("pointing-single").reset(seed=1)[0]
    action = policy(observation)
    assert action.shape == (26,) and (abs(action) <= 1).all()
    assert np.array_equal(action, run.policy(observation[np.newaxis])[0])
    cases = {
        "has 56 entries, the policy knows 57": observation[:-1],
        "an entry that is not finite": observation * np.nan,
        "an array of numbers, not of shape": "text",
        "cannot be made an array": [[1], [2, 3]],
        "not finite": np.full(57, 1e300),
    }
    for sentence, wrong in cases.items():
        with pytest.raises(ValueError, match=sentence):
            policy(wrong)
    assert policy(np.zeros((0, 57))).shape == (0, 26) and policy(np.zeros((2, 3, 57))).shape == (2, 3, 26)
    for wrong in (None, 3, ""):
        with pytest.raises(TypeError, match=r"path is .*; it must be a path"):
            myoenv.Policy.load(wrong)
    with pytest.raises(TypeError, match=r"made by Policy\.load or train"):
        myoenv.Policy(3)


def test_the_table_has_one_entry_per_episode(run):
    table = myoenv.evaluate(run.run, 70, num_envs=32)
    assert {len(column) for column in table.values()} == {70}
    assert np.array_equal(table["success"], myoenv.evaluate(run.run, 70, num_envs=32)["success"])
    done = table["target_1_success"] == 1
    assert np.isnan(table["target_1_time"][~done]).all() and np.isnan(table["target_1_movement_time"][~done]).all()
    # After the dwell of 0.25 s, to the physics step, comes what is left of its control step of 0.05 s.
    dwell = (table["target_1_time"] - table["target_1_movement_time"])[done]
    assert ((dwell > 0.25 - 1e-4) & (dwell < 0.3 - 1e-4)).all()
    assert len(myoenv.evaluate(run.policy, 5, task="pointing-single")["return"]) == 5


def test_other_checkpoints_and_tasks_are_evaluated(run, tmp_path):
    folder = tmp_path / "longer"
    shutil.copytree(run.run, folder)
    later = myoenv.train(resume=folder, steps=2048)
    newest = myoenv.evaluate(folder, 40, num_envs=40)
    assert np.array_equal(newest["return"], myoenv.evaluate(folder, 40, num_envs=40, checkpoint=2048)["return"])
    shutil.copy(folder / "checkpoints" / "step_000000001024.ckpt", folder / "checkpoints" / "step_best.ckpt")
    first = myoenv.evaluate(folder, 40, num_envs=40, checkpoint=1024)
    assert np.array_equal(first["return"], myoenv.evaluate(run.run, 40, num_envs=40)["return"])
    assert not np.array_equal(first["return"], newest["return"])
    file = folder / "checkpoints" / "step_000000001024.ckpt"
    assert np.array_equal(first["return"], myoenv.evaluate(folder, 40, num_envs=40, checkpoint=file)["return"])
    observation = np.ones(len(run.policy.observation_names))
    assert np.array_equal(myoenv.Policy.load(folder, checkpoint=1024)(observation), run.policy(observation))
    assert np.array_equal(myoenv.Policy.load(folder, checkpoint=2048)(observation), later.policy(observation))

    easy = myoenv.to_dict(myoenv.load_task("pointing-single"))
    easy["scene"]["ball"]["radius"] = 1.5
    assert myoenv.evaluate(folder, 40, num_envs=40, task=easy)["success"].mean() > newest["success"].mean()


@pytest.mark.parametrize(
    ("kwargs", "error", "sentence"),
    [
        ({"checkpoint": 77}, myoenv.TrainingError, "has no checkpoint after 77 control steps; there are 1024"),
        ({"checkpoint": "no/such.ckpt"}, myoenv.TrainingError, "no/such.ckpt"),
        ({"checkpoint": 1.5}, TypeError, "checkpoint is 1.5; it must be a whole number"),
        ({"task": OTHER_OBSERVATIONS}, ValueError, "`touch` cannot be perceived there"),
        ({"episodes": 0}, ValueError, "episodes is 0"),
    ],
)
def test_bad_evaluations_are_told(run, kwargs, error, sentence):
    with pytest.raises(error, match=sentence):
        myoenv.evaluate(run.run, **kwargs)


def test_a_policy_has_no_checkpoints(run):
    with pytest.raises(ValueError, match="a policy alone has no checkpoints"):
        myoenv.evaluate(run.policy, task="pointing-single", checkpoint=1024)


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
    result = myoenv.train(short_task, until=0.95, steps=20_000, **SMALL)
    assert result.stopped_by == "until" and result.evaluation["success"] >= 0.9
    # It is over too soon to tell whether the user was still improving.
    assert result.trend is None


def test_a_user_is_trained_to_its_plateau_unless_told_otherwise(short_task, tmp_path):
    for given, kept in [
        ({}, "plateau"),
        ({"until": "plateau"}, "plateau"),
        ({"until": 0.5}, 0.5),
        ({"until": None}, None),
    ]:
        folder = tmp_path / f"run-{kept}-{len(given)}"
        myoenv.train(short_task, steps=128, out=folder, **given, **SMALL)
        assert read_run(folder).until == kept


def test_a_goal_that_was_reached_is_told_and_can_be_raised(short_task, tmp_path):
    short_task["targets"][0]["radius"] = 1.5
    folder = tmp_path / "run"
    done = myoenv.train(short_task, until=0.5, steps=20_000, out=folder, **SMALL)
    assert done.stopped_by == "until"
    sentence = (
        r"has reached its goal with \d+\.\d % success; raise it with until=\.\.\., or take it away with until=None"
    )
    with pytest.raises(ValueError, match=sentence):
        myoenv.train(resume=folder)
    # More steps do not help: the goal ended the run.
    with pytest.raises(ValueError, match=sentence):
        myoenv.train(resume=folder, steps=40_000)
    more = myoenv.train(resume=folder, until=None, steps=done.env_steps + 128)
    assert (more.stopped_by, more.updates) == ("steps", done.updates + 1)
    # Killed between its last checkpoint and its evaluation, where it is the same again.
    first = (folder / "evaluation.json").read_text()
    (folder / "evaluation.json").unlink()
    assert myoenv.train(resume=folder, until=None, steps=1).evaluation == json.loads(first)


def rows_without_seconds(run) -> list[dict[str, str]]:
    """The metrics of a run but for how long things took."""
    with open(run / "metrics.csv") as file:
        return [{k: v for k, v in row.items() if not k.endswith("_s")} for row in csv.DictReader(file)]


def test_a_resumed_run_ends_as_if_it_had_never_stopped(run, tmp_path):
    folder = tmp_path / "stopped"

    def three(metrics) -> bool:
        return metrics["updates"] >= 3

    stopped = myoenv.train("pointing-single", seed=3, until=None, steps=1024, out=folder, callback=three, **SMALL)
    assert (stopped.updates, stopped.env_steps) == (3, 384)
    resumed = myoenv.train(resume=folder)
    assert (resumed.updates, resumed.env_steps, resumed.run) == (8, 1024, folder)
    observation = np.random.default_rng(1).normal(size=(50, len(run.policy.observation_names)))
    assert np.array_equal(resumed.policy(observation), run.policy(observation))
    assert not np.array_equal(stopped.policy(observation), run.policy(observation))
    assert rows_without_seconds(folder) == rows_without_seconds(run.run)
    assert resumed.evaluation == run.evaluation


def test_a_new_goal_is_kept_when_a_run_is_stopped_again(run, tmp_path):
    folder = tmp_path / "further"
    shutil.copytree(run.run, folder)

    def described():
        return json.loads((folder / "config.json").read_text())

    before = described()
    with pytest.raises(ValueError, match="its limit is 1024"):
        myoenv.train(resume=folder, until=0.99)
    assert described() == before, "what is refused changes nothing"
    stopped = myoenv.train(resume=folder, steps=1408, until=1.0, callback=lambda metrics: True)
    assert (stopped.stopped_by, stopped.env_steps) == ("callback", 1152)
    before["run"] |= {"steps": 1408, "until": 1.0}
    assert described() == before
    resumed = myoenv.train(resume=folder)
    assert (resumed.stopped_by, resumed.env_steps) == ("steps", 1408)


def test_a_run_without_a_checkpoint_begins_again(run, tmp_path):
    folder = tmp_path / "killed"
    shutil.copytree(run.run, folder)
    for path in (folder / "checkpoints").iterdir():
        path.unlink()
    resumed = myoenv.train(resume=folder, threads=1)
    assert resumed.updates == 8 and resumed.evaluation == run.evaluation


def test_a_damaged_checkpoint_is_told(run, tmp_path):
    folder = tmp_path / "damaged"
    shutil.copytree(run.run, folder)
    [checkpoint] = (folder / "checkpoints").iterdir()
    (folder / "checkpoints" / "step_000000002048.ckpt").write_bytes(checkpoint.read_bytes()[:-10])
    with pytest.warns(UserWarning, match="step_000000002048.ckpt cannot be used"):
        assert myoenv.train(resume=folder, steps=1200).updates == 10
    for path in (folder / "checkpoints").iterdir():
        path.write_bytes(b"")
    with pytest.raises(myoenv.TrainingError, match="no checkpoint that can be used"):
        myoenv.train(resume=folder, steps=4000)


def test_another_body_is_kept_in_the_run(tmp_path):
    heavier = myoenv.to_dict(myoenv.Model())
    for body in heavier["bodies"]:
        body["mass"] *= 1.1
    folder = tmp_path / "run"
    first = myoenv.train("pointing-single", model=heavier, until=None, steps=256, out=folder, **SMALL)
    resumed = myoenv.train(resume=folder, steps=384)
    whole = myoenv.train("pointing-single", model=heavier, until=None, steps=384, **SMALL)
    other = myoenv.train("pointing-single", until=None, steps=384, **SMALL)
    observation = np.ones((1, len(first.policy.observation_names)), np.float32)
    assert np.array_equal(resumed.policy(observation), whole.policy(observation))
    assert not np.array_equal(other.policy(observation), whole.policy(observation))
    heavy = myoenv.evaluate(folder, 8, num_envs=8)["final_distance"]
    assert not np.array_equal(heavy, myoenv.evaluate(folder, 8, num_envs=8, model="mobl-arms")["final_distance"])


def test_a_body_that_the_task_names_is_kept_in_the_run(tmp_path):
    heavier = myoenv.to_dict(myoenv.Model())
    for body in heavier["bodies"]:
        body["mass"] *= 1.1
    (tmp_path / "arm.yaml").write_text(json.dumps(heavier))
    task = myoenv.to_dict(myoenv.load_task("pointing-single")) | {"model": str(tmp_path / "arm.yaml")}
    first = myoenv.train(task, until=None, steps=128, out=tmp_path / "run", **SMALL)
    (tmp_path / "arm.yaml").write_text("no body any more")
    assert myoenv.train(resume=tmp_path / "run", steps=256).updates == 2
    assert json.loads((first.run / "config.json").read_text())["run"]["model"] == heavier


def test_an_error_of_the_callback_leaves_a_checkpoint_and_the_run_free(tmp_path):
    def fail(metrics):
        raise RuntimeError("no network")

    with pytest.raises(RuntimeError, match="no network") as error:
        myoenv.train("pointing-single", out=tmp_path / "run", until=None, steps=256, callback=fail, **SMALL)
    # The traceback is still there, and the run can be had.
    assert error.tb is not None
    assert myoenv.train(resume=tmp_path / "run").updates == 2


def test_ctrl_c_stops_with_a_checkpoint(tmp_path):
    def interrupt(metrics):
        raise KeyboardInterrupt

    result = myoenv.train("pointing-single", out=tmp_path / "run", until=None, steps=256, callback=interrupt, **SMALL)
    assert (result.stopped_by, result.evaluation, result.updates) == ("interrupt", None, 1)
    assert myoenv.train(resume=tmp_path / "run").updates == 2


def test_a_lost_card_leaves_a_checkpoint(run):
    """The native half is a stand-in: no driver can be made to fail."""

    class Lost:
        def advance(self):
            return {
                "metrics": None,
                "line": None,
                "news": [],
                "end": "device_lost",
                "reason": "unplugged",
                "raised": None,
            }

        def policy(self):
            return _native.Policy.load(run.run)

        def conclude(self, end):
            assert end == "device_lost"
            return json.dumps({"checkpoint": "run/checkpoints/step_1.ckpt"}), None

        def leave(self):
            self.left = True

    session = Session(Lost(), None)
    with pytest.raises(myoenv.DeviceError, match="unplugged; the run goes on from its checkpoint run/checkpoints"):
        session.run(None)
    assert session.native.left


def test_learning_that_runs_away_is_told_and_healed():
    wild = SMALL | {"settings": SMALL["settings"] | {"learning_rate": 0.2, "learning_rate_max": 0.2, "kl_target": 0.0}}
    heard = []
    with pytest.warns(RuntimeWarning, match="training ran away after .* kl_max"):
        result = myoenv.train("pointing-single", until=None, steps=640, callback=heard.append, **wild)
    assert result.stopped_by == "steps" and len(heard) >= result.updates == 5


def test_a_training_begins_with_what_another_learned(run, tmp_path, fast):
    short = {"until": None, "steps": 128, "num_envs": 32, "settings": {"rollout_s": 0.2}, "backend": "cpu"}
    warm = myoenv.train(fast("public-display"), start_from=run.run, out=tmp_path / "warm", **short)
    config = json.loads((warm.run / "config.json").read_text())
    assert config["run"]["from"] == {"run": str(run.run), "env_steps": 1024}
    assert config["ppo"]["policy_hidden"] == [16]
    assert len(list((warm.run / "checkpoints").iterdir())) == 2
    assert myoenv.train(resume=warm.run, steps=256).updates == 2
    # Killed before its first checkpoint, it begins again with the same networks.
    killed = tmp_path / "killed"
    shutil.copytree(warm.run, killed)
    for path in (killed / "checkpoints").iterdir():
        path.unlink()
    again = myoenv.train(resume=killed, steps=128)
    assert again.evaluation == warm.evaluation
    config["run"]["from"]["env_steps"] = 512
    for path in (killed / "checkpoints").iterdir():
        path.unlink()
    (killed / "config.json").write_text(json.dumps(config))
    with pytest.raises(myoenv.TrainingError, match=r"after 512 control steps, and was stopped .* is at 1024 now"):
        myoenv.train(resume=killed)
    with pytest.raises(myoenv.TrainingError, match="width of the hidden layers"):
        myoenv.train("ar", start_from=run.run, settings={"policy_hidden": [8]})
    with pytest.raises(ValueError, match="leave out start_from"):
        myoenv.train(resume=run.run, start_from=run.run)


@pytest.mark.parametrize(
    ("kwargs", "sentence"),
    [
        ({"task": "pointing"}, "leave out task"),
        ({"seed": 3}, "leave out seed"),
        ({"out": "elsewhere"}, "leave out out"),
        ({"num_envs": 3}, "leave out num_envs"),
        ({"settings": {}}, "leave out settings"),
        ({"model": "mobl-arms"}, "leave out model"),
        ({}, "has 1024 control steps, and its limit is 1024"),
        ({"backend": "gpu", "device": "no such card"}, "no such card"),
    ],
)
def test_what_a_resumed_run_refuses(run, kwargs, sentence):
    with pytest.raises((ValueError, myoenv.DeviceError), match=sentence):
        myoenv.train(resume=run.run, **kwargs)


def test_a_run_on_a_card_that_is_gone_says_so(run, tmp_path):
    folder = tmp_path / "moved"
    shutil.copytree(run.run, folder)
    config = json.loads((folder / "config.json").read_text())
    config["run"] |= {"backend": "gpu", "device": "no such card"}
    (folder / "config.json").write_text(json.dumps(config))
    with pytest.raises(myoenv.DeviceError, match=r"the run began on no such card, which cannot be had now.*elsewhere"):
        myoenv.train(resume=folder, steps=2000)
    assert myoenv.train(resume=folder, steps=1152, backend="cpu").updates == 9


@pytest.mark.parametrize(
    ("kwargs", "error", "sentence"),
    [
        ({"settings": {"gama": 0.9}}, ValueError, "unknown field `gama`"),
        ({"settings": {"discount_per_s": 2}}, ValueError, "discount_per_s is 2"),
        ({"settings": {"discount_per_s": object()}}, ValueError, "bad training setting"),
        ({"task": None}, ValueError, "name a task, or a run to resume"),
        ({"until": 1.5}, ValueError, "until is 1.5"),
        (
            {"until": "0.9"},
            ValueError,
            "until is '0.9'; it must be \"plateau\", a share above 0 and at most 1, or None",
        ),
        ({"threads": 0}, ValueError, "threads is 0"),
        ({"threads": 10**6}, ValueError, "threads is 1000000; it must be at most 1024"),
        ({"num_envs": 10**9}, ValueError, "num_envs is 1000000000; it must be at most"),
        ({"steps": 1e6}, TypeError, "steps is 1000000.0; it must be a whole number"),
        ({"until": float("nan")}, ValueError, "until is nan"),
        ({"callback": "print"}, TypeError, "callback is 'print'; it must be a function"),
        ({"settings": [1]}, TypeError, r"settings is \[1\]; it must be a dictionary"),
        ({"settings": {1: 2}}, TypeError, "settings has the key 1; keys must be strings"),
        ({"out": ""}, TypeError, "out is ''; it must be a path"),
        ({"out": 3}, TypeError, "out is 3; it must be a path"),
        ({"resume": 3, "task": None}, TypeError, "resume is 3; it must be a path"),
        ({"resume": "no/such/run", "task": None}, myoenv.TrainingError, "not a run folder"),
        ({"steps": 0}, ValueError, "steps is 0"),
        ({"seed": "one"}, TypeError, "seed is 'one'"),
    ],
)
def test_bad_arguments(kwargs, error, sentence):
    with pytest.raises(error, match=sentence):
        myoenv.train(**{"task": "pointing-single", **kwargs})


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
    shutil.copytree(run.run, tmp_path / "other")
    config = json.loads((run.run / "config.json").read_text())
    (tmp_path / "other" / "config.json").write_text(json.dumps({**config, "run": None}))
    with pytest.raises(myoenv.TrainingError, match=r"cannot understand .*config\.json: invalid type: null"):
        myoenv.train(resume=tmp_path / "other")
