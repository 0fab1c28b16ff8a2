"""Callbacks by name: what reaches Weights & Biases, MLflow and a callback of one's own."""

import csv
import sys
from types import SimpleNamespace

import pytest

import myoenv
from myoenv.callbacks import MlflowCallback, WandbCallback

SMALL = {
    "settings": {"rollout_s": 0.2, "policy_hidden": [16], "value_hidden": [16]},
    "num_envs": 32,
    "backend": "cpu",
    "until": None,
    "steps": 256,
}


class Recorder:
    """A stand-in for either module that writes down what it is told."""

    def __init__(self, active=None):
        self.told, self.active = [], active
        self.summary = SimpleNamespace(update=lambda table: self.told.append(("summary", table)))

    def __getattr__(self, name):
        def call(*args, **kwargs):
            self.told.append((name, args, kwargs))
            return self.active if name == "active_run" else self

        return call

    def calls(self, name):
        return [entry[1:] for entry in self.told if entry[0] == name]


@pytest.fixture
def recorder(monkeypatch):
    recorder = Recorder()
    monkeypatch.setitem(sys.modules, "wandb", recorder)
    monkeypatch.setitem(sys.modules, "mlflow", recorder)
    return recorder


def rows(run):
    with open(run / "metrics.csv") as file:
        return [{k: float(v) for k, v in row.items() if v} for row in csv.DictReader(file)]


def test_wandb_hears_what_the_run_folder_records(recorder, tmp_path):
    result = myoenv.train("pointing-single", seed=4, out=tmp_path / "mine", callback="wandb", **SMALL)
    [(_, options)] = recorder.calls("init")
    assert (options["project"], options["name"]) == ("myo", "mine")
    assert options["config"]["seed"] == 4 and options["config"]["task"]["name"] == "pointing-single"
    assert options["config"]["policy_hidden"] == [16]
    logged = recorder.calls("log")
    assert [args[0] for args, _ in logged] == rows(result.run)
    assert [kwargs["step"] for _, kwargs in logged] == [128, 256]
    [(summary,)] = recorder.calls("summary")
    assert summary["stopped_by"] == "steps" and summary["evaluation/success"] == result.evaluation["success"]
    target = result.evaluation["targets"][0]
    assert summary["evaluation/target_1_success"] == target["success"]
    ends = [summary[f"evaluation/target_1_success_{end}"] for end in ("low", "high")]
    assert ends == target["success_interval"] and not any(name.endswith("_interval") for name in summary)
    assert recorder.calls("finish") == [((), {"exit_code": 0})]


def test_mlflow_hears_what_the_run_folder_records(recorder, tmp_path):
    result = myoenv.train("pointing-single", out=tmp_path / "mine", callback="mlflow", **SMALL)
    assert recorder.calls("start_run") == [((), {"run_name": "mine"})]
    [((parameters,), _)] = recorder.calls("log_params")
    assert parameters["seed"] == "1" and parameters["policy_hidden"] == "[16]"
    *logged, last = recorder.calls("log_metrics")
    assert [args[0] for args, _ in logged] == rows(result.run)
    assert last[0][0]["evaluation/success"] == result.evaluation["success"] and last[1] == {"step": 256}
    assert recorder.calls("end_run") == [(("FINISHED",), {})]


def test_mlflow_goes_on_in_the_active_run(recorder):
    recorder.active = object()
    myoenv.train("pointing-single", callback="mlflow", **SMALL)
    assert recorder.calls("start_run") == recorder.calls("end_run") == []
    assert len(recorder.calls("log_metrics")) == 3


@pytest.mark.parametrize("make", [WandbCallback, MlflowCallback])
def test_a_training_that_fails_is_recorded_as_failed(recorder, make):
    class Failing(make):
        def __call__(self, metrics):
            raise RuntimeError("no network")

    with pytest.raises(RuntimeError, match="no network"):
        myoenv.train("pointing-single", callback=Failing(), **SMALL)
    assert recorder.calls("finish") == ([((), {"exit_code": 1})] if make is WandbCallback else [])
    assert recorder.calls("end_run") == ([] if make is WandbCallback else [(("FAILED",), {})])


@pytest.mark.parametrize("name", ["wandb", "mlflow"])
def test_without_the_package_it_says_what_to_install(monkeypatch, tmp_path, name):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ImportError, match=f"pip install {name}"):
        myoenv.train("pointing-single", out=tmp_path / "run", callback=name, **SMALL)
    assert not (tmp_path / "run").exists()


def test_a_callback_of_one_s_own_hears_of_start_updates_and_end(tmp_path):
    class Mine(myoenv.Callback):
        def __init__(self):
            self.heard = []

        def start(self, description, folder):
            self.heard.append((description.task["name"], folder))

        def __call__(self, metrics):
            self.heard.append(metrics["updates"])
            return metrics["updates"] == 1

        def finish(self, result):
            self.heard.append(result)

    mine = Mine()
    result = myoenv.train("pointing-single", out=tmp_path / "run", callback=mine, **SMALL)
    assert result.stopped_by == "callback"
    assert mine.heard == [("pointing-single", tmp_path / "run"), 1, result]


@pytest.mark.parametrize(
    ("callback", "error", "sentence"),
    [
        ("tensorboard", ValueError, "a run folder has TensorBoard events without a callback"),
        ("comet", TypeError, "callback is 'comet'; it must be a function, a Callback, 'wandb' or 'mlflow'"),
        (3, TypeError, "callback is 3"),
        (WandbCallback, TypeError, "callback is <class"),
    ],
)
def test_bad_callbacks_are_told_at_once(callback, error, sentence):
    with pytest.raises(error, match=sentence):
        myoenv.train("pointing-single", callback=callback, **SMALL)


@pytest.mark.filterwarnings("ignore")
def test_wandb_itself_takes_it_offline(tmp_path, monkeypatch):
    wandb = pytest.importorskip("wandb", reason="wandb is not installed")
    monkeypatch.setenv("WANDB_SILENT", "true")
    callback = WandbCallback(mode="offline", dir=str(tmp_path))
    result = myoenv.train("pointing-single", callback=callback, **SMALL)
    assert wandb.run is None, "the run is closed"
    [folder] = (tmp_path / "wandb").glob("offline-run-*")
    assert any(path.suffix == ".wandb" and path.stat().st_size > 0 for path in folder.iterdir())
    assert result.stopped_by == "steps"


@pytest.mark.filterwarnings("ignore")
def test_mlflow_itself_takes_it(tmp_path, monkeypatch):
    mlflow = pytest.importorskip("mlflow", reason="mlflow is not installed")
    monkeypatch.setenv("MLFLOW_ALLOW_FILE_STORE", "true")
    mlflow.set_tracking_uri((tmp_path / "mlruns").as_uri())
    result = myoenv.train("pointing-single", callback="mlflow", **SMALL)
    run = mlflow.last_active_run()
    assert (run.info.status, run.data.tags["stopped_by"]) == ("FINISHED", "steps")
    assert run.data.metrics["evaluation/success"] == result.evaluation["success"]
    history = mlflow.MlflowClient().get_metric_history(run.info.run_id, "reward_per_step")
    assert [point.step for point in history] == [128, 256]
