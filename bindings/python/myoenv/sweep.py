"""Many trainings side by side, layouts times seeds, one table.

At once on a graphics card, or on as many machines as Ray knows:

>>> from myoenv.sweep import button_grid, sweep
>>> rows = sweep(button_grid(columns=6, rows=4), seeds=[1, 2, 3], folder="layouts")
>>> pandas.DataFrame(rows).groupby("layout")[["success", "target_1_time_s"]].mean()

A finished trial leaves a file in the folder and is not run again: the same call goes on where an earlier one was
stopped. On processors it needs `pip install myoenv[sweep]`.
"""

from __future__ import annotations

import csv
import hashlib
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, Literal

import numpy as np

from myoenv._native import __version__, write_whole
from myoenv.arguments import (
    MOST_THREADS,
    as_count,
    as_device,
    as_mapping,
    as_num_envs,
    as_number,
    as_pair,
    as_path,
    as_seed,
    as_text,
    as_until,
)
from myoenv.at_once import User, train_users
from myoenv.tasks import TaskError, TaskLike, load_task, task_and_model, to_dict
from myoenv.training import STEPS

Row = dict[str, Any]


def button_grid(
    task: TaskLike = "public-display",
    *,
    columns: int = 6,
    rows: int = 4,
    x: float = 0.42,
    y: tuple[float, float] = (0.15, -0.15),
    z: tuple[float, float] = (0.01, -0.29),
) -> dict[str, dict[str, Any]]:
    """One task per place of a grid on an upright wall: what `task` asks for first, put there, alone.

    Metres from the shoulder centre: `x` forward, `y` from the left column to the right one, `z` from the top row to
    the bottom one. Keys are `r0c0` (upper left) and so on. The defaults are the 24 places between the corners of
    `public-display`.
    """
    described = to_dict(load_task(task))
    alone = _first_target(described)
    x, y, z = as_number("x", x), as_pair("y", y), as_pair("z", z)
    layouts = {}
    for i, z_m in enumerate(np.linspace(*z, as_count("rows", rows))):
        for j, y_m in enumerate(np.linspace(*y, as_count("columns", columns))):
            place = [round(x, 6), round(float(y_m), 6), round(float(z_m), 6)]
            name = f"r{i}c{j}"
            layouts[name] = {**described, "name": name, **alone(place)}
    return layouts


def _first_target(described: dict[str, Any]) -> Callable[[list[float]], dict[str, Any]]:
    """The parts of a task in which its first target stands at a place, alone."""
    if described["version"] == 1:
        target = described["targets"][0]
        return lambda place: {"targets": [{**target, "position": place}]}
    [(action, asked)] = described["script"][0].items()
    names = asked.get("in") if isinstance(asked, dict) else asked
    name = names[0] if isinstance(names, list) else names
    thing = described["scene"].get(name)
    if thing is None or thing["kind"] not in ("button", "sphere"):
        raise TaskError(
            f"the first step of {described['name']} asks for no button or sphere that stands in the scene by itself; "
            "take a task that begins with one, such as public-display"
        )
    # Its name told where it stood.
    name, single = thing["kind"], {key: value for key, value in thing.items() if key != "copies"}
    step = {action: {**asked, "in": name} if isinstance(asked, dict) else name}
    return lambda place: {"scene": {name: {**single, "at": place}}, "script": [step]}


def sweep(
    layouts: Mapping[str, TaskLike],
    seeds: Iterable[int] = (1, 2, 3),
    folder: str | PathLike[str] = "sweep",
    *,
    until: float | Literal["plateau"] | None = "plateau",
    steps: int = STEPS,
    settings: Mapping[str, Any] | None = None,
    num_envs: int | None = None,
    backend: Literal["cpu", "gpu"] = "cpu",
    device: str | int | None = None,
    cpus_per_trial: int = 1,
    address: str | None = None,
    progress: Callable[[Row], Any] | None = None,
) -> list[Row]:
    """Trains every layout with every seed; returns one row for each, in this order, and writes them as `results.csv`.

    Columns: `layout`, `seed`, `success`, `return`, `effort`, `fatigue`, `final_distance_m`, `episode_length_s` and, for
    each target, `target_1_success`, `target_1_movement_time_s` (without dwell) and `target_1_time_s` (with it), all of
    1,000 fresh episodes with the deterministic policy; then `env_steps`, `wall_s`, `stopped_by`, and `error`, which is
    empty where all went well. A trial that failed is tried again by the next call.

    Args:
        layouts: Tasks by their names in the table; all are checked before the first is trained.
        seeds: Seeds of training.
        folder: Where results are kept, on the machine that calls.
        until: What to train to, as of `myoenv.train`: `"plateau"`, a share of success, or None for all `steps`.
        steps: Control steps of all environments after which a trial stops in any case.
        settings: Settings of PPO that differ from their defaults.
        num_envs: Environments of a trial.
        backend: `"cpu"`, where Ray spreads trials over processors; or `"gpu"`, where one card of this machine trains
            layouts of one structure (as many objects and steps of the same kinds, the same time limit) at once, up to
            64 users at a time, each as it would be trained alone.
        device: A graphics card by its number or a part of its name.
        cpus_per_trial: Processor threads of a trial, also what Ray reserves for it.
        address: A Ray cluster, `"auto"` for the one that runs here; by default, if there is none, one is started for
            the call.
        progress: Called with every row as it is there, also with those of earlier calls.
    """
    on_card = as_text("backend", backend) == "gpu"
    if not on_card and (backend != "cpu" or device is not None):
        raise ValueError(f'backend is {backend!r} and device {device!r}; take "cpu" without a device, or "gpu"')
    ray = None if on_card else _ray()
    goal = as_until(until)
    options = {
        "until": until if isinstance(until, str) or until is None else float(goal),
        "steps": as_count("steps", steps),
        "settings": as_mapping("settings", settings),
        "num_envs": None if num_envs is None else as_num_envs(num_envs),
    }
    threads = as_count("cpus_per_trial", cpus_per_trial, MOST_THREADS)
    if not isinstance(seeds, Iterable):
        raise TypeError(f"seeds is {seeds!r}; it must be a list of whole numbers")
    folder = Path(as_path("folder", folder))
    trials = _trials(as_mapping("layouts", layouts), [as_seed(seed) for seed in seeds], options)
    results = _Results(folder, progress)
    missing = [trial for trial in trials if not results.load(trial)]
    if missing and ray is None:
        _run_on_card(missing, as_device(device), goal, results)
    elif missing and ray is not None:
        started = not ray.is_initialized()
        if started:
            ray.init(address=address, include_dashboard=False, log_to_driver=False)
        try:
            _run(ray, missing, threads, results)
        finally:
            if started:
                ray.shutdown()
    rows = [results.rows[trial.id] for trial in trials]
    write_table(rows, folder / "results.csv")
    return rows


def write_table(rows: Sequence[Row], path: str | PathLike[str]) -> None:
    """Writes rows as CSV; columns that a row does not have stay empty."""
    columns = list(dict.fromkeys(name for row in rows for name in row))
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)


@dataclass(frozen=True)
class Trial:
    """One training: what it is called, and everything that its result depends on."""

    layout: str
    seed: int
    #: JSON of the task, the options of training, and the version of the library.
    description: str

    @property
    def id(self) -> str:
        """Name of its file: readable, and different for a different description."""
        readable = "".join(c if c.isalnum() or c in "-_" else "_" for c in self.layout)
        return f"{readable}-{self.seed}-{hashlib.sha256(f'{self.layout} {self.description}'.encode()).hexdigest()[:12]}"


class _Results:
    """Rows in memory and, when finished, on disk: one file per trial."""

    def __init__(self, folder: Path, progress: Callable[[Row], Any] | None) -> None:
        self.folder = folder / "trials"
        self.folder.mkdir(parents=True, exist_ok=True)
        self.progress = progress
        self.rows: dict[str, Row] = {}

    def load(self, trial: Trial) -> bool:
        """Takes the row of an earlier call, if there is one."""
        try:
            row = json.loads((self.folder / f"{trial.id}.json").read_text(encoding="utf-8"))
        except FileNotFoundError:
            return False
        self._take(trial, row)
        return True

    def finish(self, trial: Trial, row: Row) -> None:
        """Keeps a row; whole or not at all, whenever the call is stopped."""
        write_whole(self.folder / f"{trial.id}.json", json.dumps(row).encode())
        self._take(trial, row)

    def fail(self, trial: Trial, error: Exception) -> None:
        """Tells of a failure; nothing is left on disk, so that the next call tries again."""
        # Ray's errors tell where it was; the last line tells what.
        lines = str(error).strip().splitlines() or [type(error).__name__]
        self._take(trial, {"layout": trial.layout, "seed": trial.seed, "error": lines[-1]})

    def _take(self, trial: Trial, row: Row) -> None:
        self.rows[trial.id] = row
        if self.progress is not None:
            self.progress(row)


def _trials(layouts: Mapping[str, TaskLike], seeds: list[int], options: dict[str, Any]) -> list[Trial]:
    trials = []
    for name, layout in layouts.items():
        task, _ = task_and_model(layout)
        for seed in seeds:
            described = {"task": to_dict(task), "seed": seed, **options, "version": __version__}
            trials.append(Trial(name, seed, json.dumps(described, sort_keys=True)))
    return trials


def _run(ray: Any, trials: list[Trial], threads: int, results: _Results) -> None:
    """Hands trials to Ray, which runs as many at once as there are processors for."""
    remote = ray.remote(num_cpus=threads, max_retries=2)(run_trial)
    running = {remote.remote(trial, threads): trial for trial in trials}
    try:
        while running:
            [done], _ = ray.wait(list(running), num_returns=1)
            trial = running.pop(done)
            try:
                results.finish(trial, ray.get(done))
            except ray.exceptions.RayError as error:
                results.fail(trial, error)
    finally:
        for unfinished in running:
            ray.cancel(unfinished, force=True)


def _run_on_card(trials: list[Trial], device: str | None, goal: str, results: _Results) -> None:
    """Trains trials at once, batch after batch."""
    described = [json.loads(trial.description) for trial in trials]
    if not described:
        return
    users = [User(*task_and_model(each["task"]), each["seed"]) for each in described]
    # Only tasks and seeds differ from trial to trial.
    first = described[0]
    num_envs = {} if first["num_envs"] is None else {"num_envs": first["num_envs"]}
    settings = {**first["settings"], **num_envs}
    for k, outcome in train_users(users, settings=settings, device=device, until=goal, steps=first["steps"]):
        if isinstance(outcome, RuntimeError):
            results.fail(trials[k], outcome)
        else:
            results.finish(trials[k], _row(trials[k], **outcome))


def run_trial(trial: Trial, threads: int) -> Row:
    """Trains one layout with one seed, here; its row."""
    from myoenv.training import train

    described = json.loads(trial.description)
    result = train(
        described["task"],
        seed=described["seed"],
        until=described["until"],
        steps=described["steps"],
        settings=described["settings"],
        num_envs=described["num_envs"],
        backend="cpu",
        threads=threads,
    )
    return _row(
        trial,
        evaluation=result.evaluation,
        env_steps=result.env_steps,
        wall_s=result.wall_s,
        stopped_by=result.stopped_by,
    )


def _row(
    trial: Trial, *, evaluation: dict[str, Any] | None, env_steps: int, wall_s: float, stopped_by: str, **_: Any
) -> Row:
    evaluation = evaluation or {}
    means = ("success", "return", "effort", "fatigue", "final_distance_m", "episode_length_s")
    row: Row = {"layout": trial.layout, "seed": trial.seed, **{name: evaluation.get(name) for name in means}}
    for k, target in enumerate(evaluation.get("targets", ()), start=1):
        row |= {f"target_{k}_{name}": target[name] for name in ("success", "movement_time_s", "time_s")}
    run = {"env_steps": env_steps, "wall_s": round(wall_s, 2), "stopped_by": stopped_by}
    return row | run | {"error": ""}


def _ray() -> Any:
    try:
        import ray
    except ImportError:
        raise ImportError("a sweep needs Ray; install it with: pip install 'myoenv[sweep]'") from None
    return ray
