"""Which of two layouts is better: users trained on each, and what their differences allow to say."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

from myoenv import _native
from myoenv.arguments import as_count, as_device, as_mapping, as_num_envs, as_path, as_until
from myoenv.at_once import User, train_users
from myoenv.runs import RunDescription
from myoenv.session import Callback, Metrics
from myoenv.tasks import TaskLike, task_and_model
from myoenv.training import STEPS, train

if TYPE_CHECKING:
    import pandas

Runs = Sequence[str | PathLike[str]]


def compare(
    first: TaskLike | Runs,
    second: TaskLike | Runs,
    *,
    seeds: int = 10,
    out: str | PathLike[str] | None = None,
    **training: Any,
) -> pandas.DataFrame:
    """Trains users on two layouts and tells what differs.

    A row per quantity (`success`, `episode_length_s`, `effort`, `fatigue`) with the columns `first` and `second`, means
    over users; `difference`, the second less the first; `low` and `high`, its 95 % confidence interval (Welch's, over
    users); `p_value`, by ranks of users from five of each on, else by Welch's test; and `verdict`: `higher` or `lower`
    where the difference is neither chance (Holm's correction over all rows) nor what more training may still bring,
    else `within_training`, `no_difference`, or, with a single user, `unknown`.
    `attrs` of the table holds `names`, `users` (of each), `sentences` and `caveats`, what weakens the comparison.

    Args:
        first: A task, as `myoenv.train` takes it, or a list of run folders of users who are trained already.
        second: The other one.
        seeds: Users to train on each task.
        out: Folder for the runs of users that are trained, two folders with one run per seed; by default none are kept.
        training: Arguments of `myoenv.train`, such as `until`, `settings`, `backend` or `progress`. With
            `backend="gpu"` all users are trained at once where the layouts differ in numbers alone and neither
            `out`, `callback`, `threads` nor `progress` is given; what single trainings warn of is not heard then.

    Needs pandas: `pip install myoenv[compare]`.
    """
    try:
        import pandas
    except ImportError:
        raise ImportError("this needs pandas; install it with: pip install 'myoenv[compare]'") from None
    count = as_count("seeds", seeds)
    for name in ("seed", "callback", "resume", "start_from"):
        if name in training:
            raise TypeError(f"compare chooses {name} itself; leave it out")
    place = None if out is None else Path(as_path("out", out))
    groups: list[str] = []
    if place is None and _is_task(first) and _is_task(second) and _can_be_at_once(training):
        groups = _groups_at_once([first, second], count, **training)
    else:
        for side, layout in (("first", first), ("second", second)):
            groups.append(_group(layout, side, count, None if place is None else place / side, training))
    result = json.loads(_native.compare(*groups))
    rows = []
    for row in result["differences"]:
        low, high = row.pop("interval") or (None, None)
        rows.append({**row, "low": low, "high": high})
    columns = ["first", "second", "difference", "low", "high", "p_value", "verdict"]
    table = pandas.DataFrame(rows).set_index("quantity")[columns]
    table.attrs.update({key: result[key] for key in ("names", "users", "sentences", "caveats")})
    return table


def _is_task(layout: TaskLike | Runs) -> TypeGuard[TaskLike]:
    return isinstance(layout, str) or not isinstance(layout, Sequence)


def _can_be_at_once(training: dict[str, Any]) -> bool:
    """Whether a card is asked for, and nothing that belongs to one training alone."""
    known = {"until", "steps", "settings", "num_envs", "backend", "device", "model"}
    return training.get("backend") == "gpu" and set(training) <= known


def _groups_at_once(
    layouts: list[TaskLike],
    seeds: int,
    *,
    backend: str,
    until: Any = "plateau",
    steps: Any = STEPS,
    settings: Any = None,
    num_envs: Any = None,
    device: Any = None,
    model: Any = None,
) -> list[str]:
    """The users of all layouts as JSON, trained at once."""
    pairs = [task_and_model(layout, model) for layout in layouts]
    users = [User(task, body, seed) for task, body in pairs for seed in range(1, seeds + 1)]
    changes = as_mapping("settings", settings)
    if num_envs is not None:
        changes["num_envs"] = as_num_envs(num_envs)
    outcomes: dict[int, dict[str, Any]] = {}
    goal, limit = as_until(until), STEPS if steps is None else as_count("steps", steps)
    for k, outcome in train_users(users, settings=changes, device=as_device(device), until=goal, steps=limit):
        if isinstance(outcome, _native.DeviceError):
            raise outcome
        if isinstance(outcome, RuntimeError):
            raise _native.TrainingError(str(outcome))
        if outcome["evaluation"] is None:
            raise KeyboardInterrupt
        outcomes[k] = outcome
    groups = []
    for k, (task, _) in enumerate(pairs):
        own = [outcomes[k * seeds + seed] for seed in range(seeds)]
        described = own[0]["description"]
        trained = [{"evaluation": user["evaluation"], "trend": user["trend"]} for user in own]
        groups.append(
            json.dumps({"name": task.name, "run": described["run"], "ppo": described["ppo"], "users": trained})
        )
    return groups


def _group(layout: TaskLike | Runs, side: str, seeds: int, place: Path | None, training: dict[str, Any]) -> str:
    """The users of a layout as JSON, trained here unless they are runs."""
    if isinstance(layout, Sequence) and not isinstance(layout, str):
        paths = [as_path(side, path) for path in layout]
        return _native.trained_users(Path(paths[0]).parent.name if len(paths) > 1 else Path(paths[0]).name, paths)
    users, heard = [], _Hearer()
    for seed in range(1, seeds + 1):
        run = None if place is None else place / f"seed-{seed}"
        result = train(layout, seed=seed, out=run, callback=heard, **training)
        if result.evaluation is None:
            raise KeyboardInterrupt
        users.append({"evaluation": result.evaluation, "trend": result.trend})
    described = heard.description
    assert described is not None
    name = described.task["name"]
    return json.dumps({"name": name, "run": described.run, "ppo": described.settings, "users": users})


class _Hearer(Callback):
    """Hears what is trained."""

    description: RunDescription | None = None

    def start(self, description: RunDescription, folder: Path | None) -> None:
        self.description = description

    def __call__(self, metrics: Metrics) -> None:
        pass
