"""Which simulated user moves as the people of recordings do."""

from __future__ import annotations

import json
from functools import cache
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from myoenv import _native
from myoenv.arguments import as_count, as_number, as_path, as_seed, as_threads
from myoenv.tasks import TaskLike, task_and_model
from myoenv.training import train

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas


#: Most trainings that a fit can take, as `myo fit` says.
MOST_TRAININGS = 20


def fit(
    recordings: str | PathLike[str] | pandas.DataFrame,
    *,
    user: TaskLike = "human",
    vision_delay_ms: Sequence[float] = (),
    height_m: Sequence[float] = (),
    trainings: int = 3,
    practised: str | PathLike[str] | None = None,
    together: bool = False,
    seed: int = 1,
    threads: int | None = None,
    **training: Any,
) -> list[dict[str, Any]]:
    """Looks for the user who moves as each participant does: motor noise, misjudged targets, what effort and changes of
    control cost, as `myo fit` does.

    One user learns first to be anybody, once, in three trainings apart, which Ctrl-C leaves to go on the next time:
    each takes some minutes on a graphics card, an hour and more on two cores. Each fit is simulation alone, a minute or
    two. Trainings differ in habits that no trait makes: figures in which they differ count for less, and intervals are
    as wide as a person's habits, taken for those of one more training, make them.

    A dictionary for each participant: `participant`, `movements`, `pairs` (distance and width in m), `traits` (`key`,
    its place in a task; `what`; `before`, `found`, `interval`, its 95 % confidence interval; `is_told`, without which
    `found` is not to be used), `distance_before` (None where the user could not do before what the person did),
    `distance_after` (root mean square over figures, in standard deviations between users of the same traits, of all
    trainings), `trainings` and `figures` (`what`, `person`, `before`, `after`) of the nearest user; and `candidates`,
    the nearest first (`vision_delay_ms` and `height_m`, None as told; `distance`, None of who cannot do what the person
    did; `is_possible`, whether the recordings do not rule it out).

    Args:
        recordings: A table of recorded movements as `myo measure` takes it: a CSV file, or a DataFrame of its columns.
        user: Whose body, rhythm and senses the user has: the name of a user, or a task.
        vision_delay_ms: Delays of vision among which to look, too; a user learns for each.
        height_m: Statures (m) among which to look, too; a user learns for each, with each delay.
        trainings: Trainings of each, with this seed and the next ones. With 1 what another would have done differently
            is in no interval.
        practised: Folder of the trainings (`seed-1`, `seed-2` and so on) in which the user has learnt to be anybody;
            trained there first where there are none. By default `runs/anybody-USER`, where `myo fit` has it, too. Where
            several are looked among, as with `vision_delay_ms`, `-80ms-1.75m` and the like are put behind.
        together: Whether all participants are one person.
        seed: Seed of the first training and of the simulations.
        threads: Threads of the processor, all by default.
        training: Arguments of `myoenv.train` for those trainings, such as `steps`, `backend` or `progress`.
    """
    for name in ("task", "layouts", "model", "settings", "out", "resume", "start_from"):
        if name in training:
            raise TypeError(f"fit chooses {name} itself; leave it out")
    table = _table(recordings)
    task, model = task_and_model(_done_by(user))
    # Before an hour of training.
    _native.check_recordings(table, bool(together), task, model)
    among = (_numbers("vision_delay_ms", vision_delay_ms), _numbers("height_m", height_m))
    seeds = range(as_seed(seed), as_seed(seed) + as_count("trainings", trainings, MOST_TRAININGS))
    candidates = [
        (_folder(task.name, practised, suffix), _native.Task.from_yaml(text))
        for suffix, text in _native.fitting_candidates(task, *among)
    ]
    for folder, own in candidates:
        for number in seeds:
            if not (place := _training(folder, number)).exists():
                _practise(own, model, place, seed=number, threads=threads, **training)
    runs = [[str(_training(folder, number)) for number in seeds] for folder, _ in candidates]
    fitted: list[dict[str, Any]] = json.loads(
        _native.fit(runs, task, model, among, table, bool(together), seeds.start, as_threads(threads))
    )
    return fitted


def _numbers(name: str, values: Any) -> list[float]:
    if isinstance(values, str) or not hasattr(values, "__iter__"):
        raise TypeError(f"{name} is {values!r}; it must be a sequence of numbers")
    return [as_number(name, value) for value in values]


def _folder(name: str, practised: str | PathLike[str] | None, suffix: str) -> Path:
    """Where the user has learnt to be anybody, or is to."""
    place = Path(as_path("practised", practised if practised is not None else Path("runs") / f"anybody-{name}"))
    return place.with_name(place.name + suffix)


def _training(folder: Path, seed: int) -> Path:
    return folder / f"seed-{seed}"


def _practise(task: _native.Task, model: _native.Model, place: Path, **training: Any) -> None:
    """One training. Who is interrupted goes on the next time, and is not taken for somebody who has learnt."""
    unfinished = place.with_name(f"{place.name}-practising")
    if unfinished.exists():
        kept = {
            name: training[name]
            for name in ("backend", "callback", "device", "progress", "threads")
            if name in training
        }
        result = train(resume=unfinished, **kept)
    else:
        layouts = [_native.Task.from_yaml(text) for text in _native.fitting_layouts(task)]
        settings = json.loads(_native.fitting_settings(task))
        result = train(layouts=layouts, model=model, settings=settings, out=unfinished, **training)
    if result.stopped_by == "interrupt":
        raise KeyboardInterrupt
    unfinished.rename(place)


def _table(recordings: Any) -> str:
    if hasattr(recordings, "to_csv"):
        text: str = recordings.to_csv(index=False)
        return text
    return Path(as_path("recordings", recordings)).read_text(encoding="utf-8")


@cache
def _users() -> frozenset[str]:
    """Names of all users that a task may name."""
    schema = json.loads(_native.task_schema())
    return frozenset(one["const"] for one in schema["$defs"]["User"]["oneOf"])


def _done_by(user: TaskLike) -> TaskLike:
    """The task whose user begins; what is to do in it does not matter."""
    if not isinstance(user, str) or user not in _users():
        return user
    if user == "fastest":
        raise ValueError(
            "user is fastest, who has no noise and no misjudgement that could be like a person's; take human, or "
            "another of `myo task users`"
        )
    scene = {"ball": {"kind": "sphere", "at": [0.4, 0, 0], "radius": 0.05}}
    script = [{"dwell": {"in": "ball", "for_s": 0.25}}]
    return {"version": 2, "name": user, "user": user, "scene": scene, "script": script}
