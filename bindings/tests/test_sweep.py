"""Sweeps on a local cluster of two workers."""

import csv
import os
import sys

import pytest

from myoenv import train
from myoenv.sweep import button_grid, sweep
from myoenv.tasks import TaskError, load_task, to_dict

# JAX, where other tests have imported it, warns of forks; Ray starts programs by them.
pytestmark = pytest.mark.filterwarnings("ignore:os.fork:RuntimeWarning")

SHORT = {"steps": 512, "num_envs": 32, "settings": {"rollout_s": 0.4}}


@pytest.fixture(scope="module")
def cluster():
    ray = pytest.importorskip("ray", reason="Ray is not installed")
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    yield ray
    ray.shutdown()
    cluster.shutdown()


def test_a_grid_has_a_button_at_every_place():
    grid = button_grid(columns=6, rows=4)
    places = {tuple(layout["scene"]["button"]["at"]) for layout in grid.values()}
    assert len(places) == len(grid) == 24
    assert all(load_task(layout).num_targets == 1 for layout in grid.values())
    display = to_dict(load_task("public-display"))["scene"]
    assert {tuple(thing["at"]) for thing in display.values() if thing["kind"] == "button"} <= places


def test_a_grid_may_be_of_spheres_and_of_the_older_format():
    sphere = button_grid("pointing", columns=1, rows=1)["r0c0"]
    assert sphere["scene"]["sphere"]["at"] == [0.42, 0.15, 0.01] and load_task(sphere).num_targets == 1
    target = {"kind": "pressing", "position": [0.3, 0, 0], "size": [0.1, 0.1, 0.1], "tilt_deg": 0, "min_force_n": 1}
    old = button_grid({"version": 1, "name": "old", "targets": [target]}, columns=1, rows=1)["r0c0"]
    assert old["targets"][0]["position"] == [0.42, 0.15, 0.01] and load_task(old).num_targets == 1


def test_without_ray_it_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(ImportError, match=r"pip install 'myoenv\[sweep\]'"):
        sweep(button_grid(), folder=tmp_path)


def test_a_card_trains_layouts_at_once_each_as_alone(tmp_path, fast):
    if os.environ.get("MYO_NO_GPU") == "1":
        pytest.skip("MYO_NO_GPU=1")
    layouts = button_grid(fast("public-display"), columns=2, rows=1)
    rows = sweep(layouts, [1, 2], tmp_path, backend="gpu", device=0, until=None, **SHORT)
    assert [(row["layout"], row["seed"], row["error"]) for row in rows] == [
        ("r0c0", 1, ""),
        ("r0c0", 2, ""),
        ("r0c1", 1, ""),
        ("r0c1", 2, ""),
    ]
    alone = train(layouts["r0c1"], seed=2, until=None, backend="gpu", device=0, **SHORT)
    assert rows[3]["return"] == alone.evaluation["return"]
    heard = []
    assert sweep(layouts, [1, 2], tmp_path, backend="gpu", until=None, progress=heard.append, **SHORT) == rows == heard


def test_a_device_belongs_to_a_card(tmp_path):
    with pytest.raises(ValueError, match='take "cpu" without a device'):
        sweep(button_grid(), folder=tmp_path, device=0)


def test_a_bad_layout_is_refused_before_anything_is_trained(cluster, tmp_path):
    layouts = {**button_grid(columns=1, rows=1), "far": button_grid(columns=1, rows=1, x=5.0)["r0c0"]}
    with pytest.raises(TaskError, match=r"the x position of `scene.button` is 5 m"):
        sweep(layouts, [1], tmp_path, **SHORT)
    assert not (tmp_path / "trials").exists()


@pytest.mark.parametrize(
    ("kwargs", "sentence"),
    [
        ({"layouts": ["pointing"]}, "layouts is .*; it must be a dictionary"),
        ({"layouts": {3: "pointing"}}, "layouts has the key 3"),
        ({"seeds": 3}, "seeds is 3"),
        ({"seeds": ["one"]}, "seed is 'one'"),
        ({"until": 2}, "until is 2"),
        ({"num_envs": 0}, "num_envs is 0"),
        ({"steps": 0}, "steps is 0"),
        ({"cpus_per_trial": 0}, "cpus_per_trial is 0"),
        ({"folder": 3}, "folder is 3; it must be a path"),
    ],
)
def test_bad_arguments_are_told_at_once(kwargs, sentence, tmp_path):
    pytest.importorskip("ray", reason="Ray is not installed")
    arguments = {"layouts": {"one": "pointing-single"}, "folder": tmp_path, **kwargs}
    with pytest.raises((ValueError, TypeError), match=sentence):
        sweep(**arguments)


def test_bad_grids_are_told():
    for kwargs, sentence in (({"x": "far"}, "x is 'far'"), ({"x": float("nan")}, "x is nan"), ({"y": 1}, "y is 1")):
        with pytest.raises((ValueError, TypeError), match=sentence):
            button_grid(**kwargs)
    for task in ("hello", "ticket"):
        with pytest.raises(TaskError, match=f"the first step of {task} asks for no button or sphere"):
            button_grid(task)


def test_a_sweep_is_one_table_and_goes_on(cluster, tmp_path, fast):
    assert len([node for node in cluster.nodes() if node["Alive"]]) == 2
    grid = button_grid(fast("public-display"), columns=2, rows=1)
    first = sweep({"r0c0": grid["r0c0"]}, [1, 2], tmp_path, **SHORT)
    files = {path: path.stat().st_mtime_ns for path in (tmp_path / "trials").iterdir()}
    assert len(files) == 2

    seen = []
    rows = sweep(grid, [1, 2], tmp_path, **SHORT, progress=seen.append)
    assert [(row["layout"], row["seed"]) for row in rows] == [("r0c0", 1), ("r0c0", 2), ("r0c1", 1), ("r0c1", 2)]
    assert all(row["error"] == "" and 0 <= row["success"] <= 1 and row["env_steps"] == 512 for row in rows)
    assert rows[:2] == first, "finished trials are not run again"
    assert len(seen) == 4
    assert all(path.stat().st_mtime_ns == then for path, then in files.items())
    with open(tmp_path / "results.csv", newline="") as file:
        assert [row["layout"] for row in csv.DictReader(file)] == [row["layout"] for row in rows]


def test_tune_varies_settings_and_layouts(cluster, tmp_path, fast):
    from ray import tune

    from myoenv.tune import trainable

    layouts = button_grid(fast("public-display"), columns=2, rows=1)
    space = {"layout": tune.grid_search(list(layouts)), "learning_rate": tune.choice([5e-4]), "seed": 3}
    run = trainable(layouts=layouts, **SHORT, until=None)
    tuner = tune.Tuner(run, param_space=space, run_config=tune.RunConfig(storage_path=str(tmp_path), verbose=0))
    results = tuner.fit()
    assert results.num_terminated == 2 and results.num_errors == 0
    assert {result.config["layout"] for result in results} == set(layouts)
    for result in results:
        # Two updates and the evaluation.
        assert result.metrics["training_iteration"] == 3 and result.metrics["env_steps"] == 512
        assert result.metrics_dataframe["learning_rate"][0] == 5e-4
        assert 0 <= result.metrics["evaluation/success"] <= 1
    # Other places of the button are other tasks.
    assert len({result.metrics["reward_per_step"] for result in results}) == 2


def test_tune_tells_bad_arguments(monkeypatch):
    pytest.importorskip("ray.tune", reason="Ray Tune is not installed")
    from myoenv.tune import trainable

    for kwargs, sentence in (
        ({}, "name a task or layouts"),
        ({"task": "x", "cpus_per_trial": 0}, "cpus_per_trial is 0"),
    ):
        with pytest.raises(ValueError, match=sentence):
            trainable(**kwargs)
    with pytest.raises(TaskError, match=r"the x position of `scene.button` is 5 m"):
        trainable(layouts=button_grid(columns=1, rows=1, x=5.0))
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(ImportError, match=r"pip install 'myoenv\[tune\]'"):
        trainable("pointing")


def test_a_failed_trial_has_its_error_in_the_table_and_no_file(cluster, tmp_path, fast):
    grid = button_grid(fast("public-display"), columns=1, rows=1)
    [row] = sweep(grid, [1], tmp_path, **SHORT | {"settings": {"discount_per_s": 2.0}})
    assert "discount_per_s" in row["error"]
    assert list((tmp_path / "trials").iterdir()) == []
