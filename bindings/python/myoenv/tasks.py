"""Tasks and models from whatever a caller has: a name, a file, a text, a dictionary."""

from __future__ import annotations

import io
import json
import math
import re
import tomllib
import warnings
from collections.abc import Callable, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal, TypeVar

from myoenv import _native
from myoenv._native import Model, Task, TaskError
from myoenv.arguments import as_path
from myoenv.described import plain

__all__ = [
    "Model",
    "ModelLike",
    "Task",
    "TaskError",
    "TaskLike",
    "import_model",
    "layouts_and_model",
    "load_model",
    "load_task",
    "task_and_model",
    "task_schema",
    "to_dict",
]

_Read = TypeVar("_Read", Task, Model)

TaskLike = Task | str | PathLike[str] | Mapping[str, Any]
ModelLike = Model | str | PathLike[str] | Mapping[str, Any]


def load_task(task: TaskLike) -> Task:
    """A task from a preset's name, a YAML or TOML file, a YAML text, or a dictionary with the keys of a task file, in
    which parts may be those of `myoenv.scene`.

    Lengths are metres from the shoulder centre (x forward, y to the left, z up), times seconds, forces newtons.

    >>> load_task("pointing").num_targets
    10
    """
    if isinstance(task, Task):
        return task
    if isinstance(task, Mapping):
        return _from_data(Task.from_yaml, task, "task")
    text = _text(task, "a task")
    if "\n" in text:
        return Task.from_yaml(text)
    if text.endswith(".toml"):
        return _from_data(Task.from_yaml, _toml(text), "task", text)
    return Task.load(text)


def load_model(model: ModelLike) -> Model:
    """A model from a built-in name, a YAML file, a YAML text, or a dictionary with the keys of a model file."""
    if isinstance(model, Model):
        return model
    if isinstance(model, Mapping):
        return _from_data(Model.from_yaml, model, "model")
    text = _text(model, "a model")
    if "\n" in text:
        return Model.from_yaml(text)
    if Path(text).suffix in (".yaml", ".yml"):
        return Model.from_yaml(_read(text), text)
    return Model(text)


def import_model(
    file: str | PathLike[str],
    *,
    fingertip: str,
    shoulder: str,
    elbow: str | None = None,
    wrist: str | None = None,
    fingers: Mapping[str, str] | None = None,
    without_contacts: bool = False,
    side_rule: Literal["mujoco4", "mujoco3"] = "mujoco4",
    lock: Sequence[str] = (),
    root: str | PathLike[str] | None = None,
) -> Model:
    """A model of a file of MuJoCo's (MJCF), as `myo model import` makes it.

    What cannot be simulated is refused with its name and place; a warning tells what is passed over, as it has no part
    in the simulation. Meshes that are seen come along, coarser.

    >>> arm = import_model("myoarm_r.xml", fingertip="IFtip_r", shoulder="humerus_r")  # doctest: +SKIP
    >>> env = myoenv.make_vec("pointing", 64, model=arm)  # doctest: +SKIP

    Args:
        file: The file. Others that it includes are found from it.
        fingertip: Site that points and presses.
        shoulder: Body whose origin is the centre of the shoulder, from which places are measured.
        elbow: Body whose origin is the elbow, for rays from the forearm; with the wrist, a person is drawn around the
            arm, who faces along x.
        wrist: Body whose origin is the wrist, for rays.
        fingers: Sites of other fingers by the names that tasks have for them, such as `{"thumb": "THtip_r"}`; at most
            four.
        without_contacts: Whether parts of the body pass through each other.
        side_rule: How side sites tell ways around wraps: as MuJoCo since 4.0, or as before, for what was made
            with that.
        lock: Joints that stand still as in the pose of the file, with those that follow them.
        root: Folder outside of which no file is opened; by default that of the file.
    """
    names = {"fingertip": fingertip, "shoulder": shoulder, "elbow": elbow, "wrist": wrist}
    for name, value in names.items():
        if not (isinstance(value, str) or (value is None and name in ("elbow", "wrist"))):
            raise TypeError(f"{name} is {value!r}; it must be a name")
    if isinstance(lock, str) or not all(isinstance(name, str) for name in lock):
        raise TypeError(f"lock is {lock!r}; it must be a list of names")
    others = dict(fingers or {})
    if not all(isinstance(name, str) for name in [*others, *others.values()]):
        raise TypeError(f"fingers is {fingers!r}; it must have names of sites by names of fingers")
    below = None if root is None else as_path("root", root)
    landmarks = (fingertip, shoulder, elbow, wrist, others)
    model, passed_over = Model.from_mjcf(
        as_path("file", file), landmarks, bool(without_contacts), str(side_rule), list(lock), below
    )
    if passed_over:
        what = ", ".join(passed_over)
        warnings.warn(f"passed over, as they have no part in the simulation: {what}", UserWarning, stacklevel=2)
    return model


def task_and_model(task: TaskLike, model: ModelLike | None = None) -> tuple[Task, Model]:
    """Both, checked against each other: what the body cannot do is refused, what is odd is warned of."""
    task = load_task(task)
    checked = task.is_preset and model is None
    body = load_model(task.model if model is None else model)
    if not checked:
        try:
            sentences = task.check(body)
        except TaskError as error:
            raise TaskError(_without_place(str(error))) from None
        for sentence in sentences:
            warnings.warn(_without_place(sentence), stacklevel=3)
    return task, body


def layouts_and_model(
    task: TaskLike | None, layouts: Sequence[TaskLike] | None, model: ModelLike | None = None
) -> tuple[list[Task], Model]:
    """The task alone, or all layouts, which must be for one body; and the body."""
    if (task is None) == (layouts is None):
        raise ValueError("name a task, or several of one structure with layouts=[...], not both")
    if layouts is None:
        assert task is not None
        one, body = task_and_model(task, model)
        return [one], body
    if isinstance(layouts, (str, Mapping, Task)) or not isinstance(layouts, Sequence) or not layouts:
        raise TypeError("layouts is a list of tasks, at least one")
    both = [task_and_model(layout, model) for layout in layouts]
    (first, body), others = both[0], both[1:]
    for k, (other, _) in enumerate(others, 2):
        if model is None and other.model != first.model:
            raise ValueError(
                f"layout {k} is for the body {other.model} and the first for {first.model}; name one model"
            )
    return [layout for layout, _ in both], body


def to_dict(thing: Task | Model) -> dict[str, Any]:
    """A task or model as a dictionary, with the keys of its file."""
    described: dict[str, Any] = json.loads(thing.to_json())
    return described


def task_schema() -> dict[str, Any]:
    """JSON Schema (2020-12) of a task file, for editors and forms; units stand in `x-unit`."""
    schema: dict[str, Any] = json.loads(_native.task_schema())
    return schema


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


def _from_data(read: Callable[[str, str], _Read], data: Mapping[str, Any], what: str, file: str | None = None) -> _Read:
    """Reads what has no lines and columns that a caller could look at: errors name the entry by its path instead."""
    try:
        text, paths = _written(data)
        return read(text, what)
    except RecursionError:
        raise TaskError("the dictionary cannot be written as text: it has no end") from None
    except TaskError as error:
        sentences = re.sub(rf"^{what}{_PLACE}(.*)", lambda found: _with_path(found, paths), str(error), flags=re.M)
        raise TaskError(f"{file}: {sentences}" if file else sentences) from None


# Line and column in a text that `_written` made.
_PLACE = r":1:(\d+): "


def _with_path(found: re.Match[str], paths: Mapping[int, str]) -> str:
    column, sentence = found.groups()
    path = paths.get(int(column), "")
    return f"{path}: {sentence}" if path and f"`{path}`" not in sentence else sentence


def _without_place(sentences: str) -> str:
    """What a check says about a task that was read from data."""
    return re.sub(rf"^task{_PLACE}(warning: )?", "", sentences, flags=re.M)


def _written(data: Mapping[str, Any]) -> tuple[str, dict[int, str]]:
    """Data as one line of YAML, and the path of each value by the column, from 1 on, where it begins."""
    text, paths = io.StringIO(), {}

    def write(value: Any, path: str) -> None:
        paths[text.tell() + 1] = path
        if isinstance(value, Mapping):
            text.write("{")
            for k, (key, entry) in enumerate(value.items()):
                if not isinstance(key, (str, int)) or isinstance(key, bool):
                    raise TaskError(f"{f'`{path}`' if path else 'the dictionary'} has the key {key!r}; keys are text")
                text.write(f"{', ' if k else ''}{json.dumps(str(key))}: ")
                write(entry, f"{path}.{key}" if path else str(key))
            text.write("}")
        elif isinstance(value, list):
            text.write("[")
            for k, entry in enumerate(value):
                text.write(", " if k else "")
                write(entry, f"{path}[{k}]")
            text.write("]")
        elif isinstance(value, float) and not math.isfinite(value):
            # Refused like any other number that does not fit.
            text.write(".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf")
        elif value is None or isinstance(value, (str, int, float)):
            text.write(json.dumps(value))
        else:
            raise TaskError(f"`{path}` is of type {type(value).__name__}, which cannot be written as text")

    write(plain(data), "")
    return text.getvalue(), paths
