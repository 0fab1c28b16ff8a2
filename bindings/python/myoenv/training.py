"""The library's own PPO: train, look, stop. Run folders are those of `myo train`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from types import EllipsisType
from typing import Any, Literal

from myoenv import _native
from myoenv.arguments import (
    as_count,
    as_device,
    as_mapping,
    as_num_envs,
    as_path,
    as_seed,
    as_text,
    as_threads,
    as_until,
)
from myoenv.callbacks import as_callback
from myoenv.runs import RunDescription
from myoenv.session import Callback, Metrics, Session, TrainResult
from myoenv.tasks import ModelLike, TaskLike, layouts_and_model
from myoenv.vector import Backend

#: Control steps after which to stop in any case.
STEPS = 200_000_000


def train(
    task: TaskLike | None = None,
    *,
    layouts: Sequence[TaskLike] | None = None,
    seed: int | None = None,
    until: float | Literal["plateau"] | EllipsisType | None = ...,
    steps: int | None = None,
    out: str | PathLike[str] | None = None,
    callback: Callable[[Metrics], Any] | Callback | Literal["wandb", "mlflow"] | None = None,
    settings: Mapping[str, Any] | None = None,
    num_envs: int | None = None,
    backend: Backend | None = None,
    device: str | int | None = None,
    threads: int | None = None,
    model: ModelLike | None = None,
    resume: str | PathLike[str] | None = None,
    start_from: str | PathLike[str] | None = None,
    progress: bool = False,
) -> TrainResult:
    """Trains a policy with PPO, from the start or from where a run was stopped.

    Args:
        task: A preset's name, a YAML or TOML file, a YAML text, a dictionary, or a `Task`.
        layouts: In place of `task` several of one structure, whose numbers alone differ: one policy learns all of them
            side by side. A goal is reached when it is in every layout, and `evaluation["layouts"]` tells of each.
        seed: Seed of everything random; 1 by default.
        until: What to train to: `"plateau"`, the default, where four times as many steps would change the time of an
            episode by less than 3 %, and success and return hardly; a share of fresh episodes in which the
            deterministic policy succeeds, such as 0.95, which is where it has just begun to be good; or None, to train
            all `steps`.
        steps: Control steps of all environments after which to stop in any case; 200 million at 20 Hz by default.
        out: Run folder to make, as `myo train` makes it; without one nothing is written.
        callback: Called after every update with its metrics (the columns of `metrics.csv`; NaN where there is none);
            training stops when it returns True. What it raises leaves `train`, after a checkpoint. A `myoenv.Callback`
            also hears of the start and of the end; `"wandb"` and `"mlflow"` are two of them, see `myoenv.callbacks`.
        settings: Settings of PPO that differ from those its user learns with, such as `{"discount_per_s": 0.7}`.
        num_envs: Environments side by side.
        backend: `"cpu"`, `"gpu"` or `"auto"`, which is the default.
        device: A graphics card by its number or a part of its name.
        threads: Threads of the processor, all by default.
        model: Another body than the task's.
        resume: A run folder, of `myo train` or of this function, to go on with from its newest checkpoint, to the bit
            as if it had never been stopped; one that lacks no more than its last evaluation makes that. `until`,
            `steps` and the backend are the run's unless others are given, and with another backend or device it is not
            to the bit; task, model, seed and settings are always the run's.
        start_from: A run folder or checkpoint whose networks to begin with; its task may have had other targets, and
            its body other muscles: observations and actions are matched by name.
        progress: Whether to write a line to standard error every 5 s, as `myo train` does: steps, success, the target
            that is missed most, and the time left.

    Ctrl-C stops with a checkpoint and returns the result so far, even during the last evaluation; the loss of a
    graphics card stops with a checkpoint, too. Training that runs away goes back to its last good state, and training
    that leads nowhere is noticed; both with a `RuntimeWarning`.
    """
    follow = as_callback(callback)
    given_backend, given_device = None if backend is None else as_text("backend", backend), as_device(device)
    goal = None if until is ... else as_until(until)
    limit = None if steps is None else as_count("steps", steps)
    if resume is not None:
        _refuse(
            task=task,
            layouts=layouts,
            model=model,
            seed=seed,
            settings=settings,
            num_envs=num_envs,
            out=out,
            start_from=start_from,
        )
        folder = as_path("resume", resume)
        native = _native.Session.resume(
            folder,
            backend=given_backend,
            device=given_device,
            threads=as_threads(threads),
            until=goal,
            steps=limit,
        )
        _refuse_if_over(native, folder)
        native.record_on()
        return Session(native, Path(folder), progress).run(follow)
    if task is None and layouts is None:
        raise ValueError("name a task, or a run to resume")
    tasks, body = layouts_and_model(task, layouts, model)
    changes = as_mapping("settings", settings)
    if num_envs is not None:
        changes["num_envs"] = as_num_envs(num_envs)
    native = _native.Session(
        tasks,
        body,
        config=as_json(changes),
        seed=1 if seed is None else as_seed(seed),
        backend=given_backend or "auto",
        device=given_device,
        threads=as_threads(threads),
        until=goal or "plateau",
        steps=limit or STEPS,
        start_from=None if start_from is None else as_path("start_from", start_from),
    )
    if out is None:
        return Session(native, None, progress).run(follow)
    folder = as_path("out", out)
    native.record_in(folder)
    return Session(native, Path(folder), progress).run(follow)


def _refuse(**given: Any) -> None:
    """Refuses arguments that a resumed run cannot take."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"resume goes on with a run as it is; leave out {name}")


def _refuse_if_over(session: _native.Session, run: str) -> None:
    """Refuses a run whose end is recorded, and says what would make it go on; without its evaluation it is not over."""
    if session.over is None or not session.is_evaluated:
        return
    end, done, success = session.over, session.env_steps, session.confirmed_success
    # A traceback may hold the session for long; the run is free at once.
    session.leave()
    if end == "until" and success is not None:
        help = "raise it with until=..., or take it away with until=None"
        raise ValueError(f"{run} has reached its goal with {100 * success:.1f} % success; {help}")
    if end == "plateau":
        help = "to train on, take until=None and raise steps"
        raise ValueError(f"{run} has come to its plateau after {done} control steps; {help}")
    limit = RunDescription.from_json(session.description()).steps
    raise ValueError(f"{run} has {done} control steps, and its limit is {limit}; raise it with steps=...")


def as_json(settings: dict[str, Any]) -> str:
    """Settings as JSON, numbers of NumPy included."""
    try:
        return json.dumps(settings, default=lambda value: value.tolist(), allow_nan=False)
    except (TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"bad training setting: {error}") from None


def default_settings(user: str = "human") -> dict[str, Any]:
    """The settings of PPO that a `user` of a task, `fastest` or `human`, learns with where nothing else is said."""
    settings: dict[str, Any] = json.loads(_native.default_settings(user))
    return settings
