"""The library's own PPO: train, look, stop. Run folders are those of `myo train`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from os import PathLike, fspath
from types import EllipsisType
from typing import Any, Literal

from myoenv import _native
from myoenv._native import DeviceError
from myoenv.arguments import (
    as_count,
    as_device,
    as_mapping,
    as_num_envs,
    as_path,
    as_seed,
    as_share,
    as_text,
    as_threads,
)
from myoenv.callbacks import as_callback
from myoenv.runs import RunDescription, read_run
from myoenv.session import Callback, Metrics, Session, TrainResult
from myoenv.tasks import Model, ModelLike, Task, TaskLike, load_model, load_task, task_and_model, to_dict
from myoenv.vector import Backend

# Backend and device, as asked for.
BackendChoice = tuple[str, str | None]

_UNTIL = 0.95
_STEPS = 60_000_000


def train(
    task: TaskLike | None = None,
    *,
    seed: int | None = None,
    until: float | EllipsisType | None = ...,
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
) -> TrainResult:
    """Trains a policy with PPO, from the start or from where a run was stopped.

    Args:
        task: A preset's name, a YAML or TOML file, a YAML text, a dictionary, or a `Task`.
        seed: Seed of everything random; 1 by default.
        until: Share of fresh episodes in which the deterministic policy must succeed, 0.95 by default; None trains all
            `steps`.
        steps: Control steps of all environments after which to stop in any case; 60 million by default.
        out: Run folder to make, as `myo train` makes it; without one nothing is written.
        callback: Called after every update with its metrics (the columns of `metrics.csv`; NaN where there is none);
            training stops when it returns True. What it raises leaves `train`, after a checkpoint. A `myoenv.Callback`
            also hears of the start and of the end; `"wandb"` and `"mlflow"` are two of them, see `myoenv.callbacks`.
        settings: Settings of PPO that differ from their defaults, such as `{"discount_per_s": 0.5}`.
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

    Ctrl-C stops with a checkpoint and returns the result so far, even during the last evaluation; the loss of a
    graphics card stops with a checkpoint, too. Training that runs away goes back to its last good state, and training
    that leads nowhere is noticed; both with a `RuntimeWarning`.
    """
    follow = as_callback(callback)
    if resume is None:
        if task is None:
            raise ValueError("name a task, or a run to resume")
        task, body = task_and_model(task, model)
        description = _describe(task, None if model is None else body, seed, settings, num_envs)
        description = replace(description, start_from=None if start_from is None else as_path("start_from", start_from))
        choice = _choice(backend, device)
    else:
        _refuse(task=task, model=model, seed=seed, settings=settings, num_envs=num_envs, out=out, start_from=start_from)
        description = read_run(resume)
        task = load_task(description.task)
        body = load_model(task.model if description.model is None else description.model)
        began = (description.backend, description.device)
        choice = began if backend is None and device is None else _choice(backend, device)
    if until is not ...:
        description = replace(description, until=None if until is None else as_share("until", until))
    if steps is not None:
        description = replace(description, steps=as_count("steps", steps))
    native = _open(task, body, description, choice, threads, resume)
    description = replace(description, backend=native.backend, device=native.device)
    if resume is None:
        description = replace(description, inherited_env_steps=native.inherited_env_steps)
    session = Session(native, description)
    if resume is not None:
        session.record_in(as_path("resume", resume), go_on=True)
    elif out is not None:
        session.record_in(as_path("out", out), go_on=False)
    return session.run(follow)


def _describe(
    task: Task,
    own_model: Model | None,
    seed: int | None,
    settings: Mapping[str, Any] | None,
    num_envs: int | None,
) -> RunDescription:
    """A new run; where it takes place is known when it is open."""
    changes = as_mapping("settings", settings)
    if num_envs is not None:
        changes["num_envs"] = as_num_envs(num_envs)
    return RunDescription(
        task=to_dict(task),
        model=None if own_model is None else to_dict(own_model),
        seed=1 if seed is None else as_seed(seed),
        settings=changes,
        backend="auto",
        device=None,
        until=_UNTIL,
        steps=_STEPS,
    )


def _refuse(**given: Any) -> None:
    """A run goes on as it is."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(f"resume goes on with a run as it is; leave out {name}")


def _choice(backend: Any, device: Any) -> BackendChoice:
    return as_text("backend", "auto" if backend is None else backend), as_device(device)


def _open(
    task: Task,
    model: Model,
    description: RunDescription,
    choice: BackendChoice,
    threads: int | None,
    resume: str | PathLike[str] | None,
) -> _native.Session:
    backend, device = choice
    try:
        session = _native.Session(
            task,
            model,
            config=_json(description.settings),
            seed=description.seed,
            backend=backend,
            device=device,
            threads=as_threads(threads),
            until=description.until,
            steps=description.steps,
            resume=resume,
            # A run that goes on has taken over what it began with.
            start_from=description.start_from if resume is None else None,
        )
    except DeviceError as error:
        if resume is None or choice != (description.backend, description.device):
            raise
        elsewhere = "to go on elsewhere, name a backend or a device"
        raise DeviceError(f"the run began on {device}, which cannot be had now: {error}; {elsewhere}") from None
    if resume is not None:
        _refuse_if_over(session, fspath(resume), description.steps)
    return session


def _refuse_if_over(session: _native.Session, run: str, limit: int) -> None:
    """Says what would make a training go on whose end is recorded; one that lacks its evaluation goes on to have it."""
    if session.over is None or not session.is_evaluated:
        return
    end, done, success = session.over, session.env_steps, session.confirmed_success
    # A traceback may hold the session for long; the run is free at once.
    session.leave()
    if end == "until" and success is not None:
        help = "raise it with until=..., or take it away with until=None"
        raise ValueError(f"{run} has reached its goal with {100 * success:.1f} % success; {help}")
    raise ValueError(f"{run} has {done} control steps, and its limit is {limit}; raise it with steps=...")


def _json(settings: dict[str, Any]) -> str:
    try:
        return json.dumps(settings, default=lambda value: value.tolist(), allow_nan=False)
    except (TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"bad training setting: {error}") from None


def default_settings() -> dict[str, Any]:
    """The settings of PPO with their defaults."""
    settings: dict[str, Any] = json.loads(_native.default_settings())
    return settings
