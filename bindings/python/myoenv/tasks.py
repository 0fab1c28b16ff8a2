"""Tasks and models from whatever a caller has: a name, a file, a text, a dictionary."""

from __future__ import annotations

import json
import tomllib
import warnings
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from myoenv._native import Model, Task, TaskError

__all__ = [
    "Model",
    "ModelLike",
    "Task",
    "TaskError",
    "TaskLike",
    "load_model",
    "load_task",
    "task_and_model",
    "to_dict",
]

TaskLike = Task | str | PathLike[str] | Mapping[str, Any]
ModelLike = Model | str | PathLike[str] | Mapping[str, Any]


def load_task(task: TaskLike) -> Task:
    """A task from a preset's name, a YAML or TOML file, a YAML text, or a dictionary with the keys of a task file.

    Lengths are metres from the shoulder centre (x forward, y to the left, z up), times seconds, forces newtons.

    >>> load_task("pointing").num_targets
    10
    """
    if isinstance(task, Task):
        return task
    if isinstance(task, Mapping):
        return Task.from_yaml(_json(task), "task")
    text = _text(task, "a task")
    if "\n" in text:
        return Task.from_yaml(text)
    if text.endswith(".toml"):
        return Task.from_yaml(_json(_toml(text)), text)
    return Task.load(text)


def load_model(model: ModelLike) -> Model:
    """A model from a built-in name, a YAML file, a YAML text, or a dictionary with the keys of a model file."""
    if isinstance(model, Model):
        return model
    if isinstance(model, Mapping):
        return Model.from_yaml(_json(model), "model")
    text = _text(model, "a model")
    if "\n" in text:
        return Model.from_yaml(text)
    if Path(text).suffix in (".yaml", ".yml"):
        return Model.from_yaml(_read(text), text)
    return Model(text)


def task_and_model(task: TaskLike, model: ModelLike | None = None) -> tuple[Task, Model]:
    """Both, checked against each other: what the body cannot do is refused, what is odd is warned of."""
    task = load_task(task)
    checked = task.is_preset and model is None
    body = load_model(task.model if model is None else model)
    if not checked:
        for sentence in task.check(body):
            warnings.warn(sentence, stacklevel=3)
    return task, body


def to_dict(thing: Task | Model) -> dict[str, Any]:
    """A task or model as a dictionary, with the keys of its file."""
    described: dict[str, Any] = json.loads(thing.to_json())
    return described


def _text(source: object, what: str) -> str:
    if isinstance(source, (str, PathLike)):
        text = fspath(source)
        if isinstance(text, str):
            return text
    raise TypeError(f"{what} is a name, a path, a text or a dictionary, not {type(source).__name__}")


def _read(path: str) -> str:
    try:
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise TaskError(f"cannot read {path}: {error.strerror}") from None
    except ValueError as error:
        # A name that no file can have, or bytes that are no text.
        raise TaskError(f"cannot read {path!r}: {error}") from None


def _toml(path: str) -> dict[str, Any]:
    try:
        return tomllib.loads(_read(path))
    except tomllib.TOMLDecodeError as error:
        raise TaskError(f"{path} is no TOML: {error}") from None


def _json(mapping: Mapping[str, Any]) -> str:
    try:
        return json.dumps(dict(mapping), default=_plain, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise TaskError(f"the dictionary cannot be written as text: {error}") from None


def _plain(value: Any) -> Any:
    """NumPy's numbers and arrays as Python's."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} has no place in a task or model")
