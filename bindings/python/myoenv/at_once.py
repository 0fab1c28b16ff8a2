"""Users trained at once on a graphics card, each as it would be trained alone."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from myoenv._native import DeviceError, Model, Task, task_batches, train_at_once
from myoenv.training import as_json


class User(NamedTuple):
    """Who is to be trained."""

    task: Task
    body: Model
    seed: int


def train_users(
    users: Sequence[User], *, settings: Mapping[str, Any], device: str | None, until: str, steps: int
) -> Iterator[tuple[int, dict[str, Any] | RuntimeError]]:
    """For each user, by its number, how it went or what went wrong; batch after batch.

    A batch is of one body and of layouts of one structure. Nothing is said of a training that went back to a good state
    or leads nowhere.
    """
    bodies: dict[str, list[int]] = {}
    for k, user in enumerate(users):
        own = json.dumps(json.loads(user.task.to_json())["body"])
        bodies.setdefault(user.body.to_json() + own, []).append(k)
    for same in bodies.values():
        body = users[same[0]].body
        for batch in task_batches([users[k].task for k in same], body):
            members = [same[k] for k in batch]
            outcomes, raised = train_at_once(
                [users[k].task for k in members],
                body,
                [users[k].seed for k in members],
                config=as_json(dict(settings)),
                device=device,
                until=until,
                steps=steps,
            )
            if raised is not None:
                raise raised
            for k, (outcome, error) in zip(members, outcomes, strict=True):
                yield k, _told(outcome, error)


def _told(outcome: str | None, error: str) -> dict[str, Any] | RuntimeError:
    if outcome is None:
        return RuntimeError(error)
    told: dict[str, Any] = json.loads(outcome)
    return DeviceError("the GPU was lost") if told["stopped_by"] == "device_lost" else told
