"""Ray Tune over settings of PPO, seeds and layouts.

>>> from ray import tune
>>> from myoenv.sweep import button_grid
>>> from myoenv.tune import trainable
>>> layouts = button_grid(columns=2, rows=1)
>>> space = {"layout": tune.grid_search(list(layouts)), "learning_rate": tune.loguniform(1e-4, 3e-3)}
>>> tuner = tune.Tuner(trainable(layouts=layouts, until=None, steps=2_000_000), param_space=space)
>>> table = tuner.fit().get_dataframe()

Needs `pip install myoenv[tune]`. For every layout with every seed and nothing else, `myoenv.sweep` is simpler.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from myoenv.arguments import MOST_THREADS, as_count, as_mapping
from myoenv.callbacks import evaluation_columns
from myoenv.session import Metrics
from myoenv.tasks import TaskLike, task_and_model, to_dict
from myoenv.training import train

# Points of the space that are arguments of `train`; all others are settings of PPO.
_ARGUMENTS = ("seed", "num_envs", "until", "steps")


def trainable(
    task: TaskLike | None = None,
    *,
    layouts: Mapping[str, TaskLike] | None = None,
    cpus_per_trial: int = 1,
    **options: Any,
) -> Any:
    """What `ray.tune.Tuner` runs: one training for each point of the space.

    A point may have `layout`, a name in `layouts`; `seed`, `num_envs`, `until` and `steps`, as of `myoenv.train`; and
    any setting of PPO by its name. Every update reports the columns of `metrics.csv`, and the end of a training reports
    them once more with the evaluation: `evaluation/success`, `evaluation/target_1_movement_time_s` and so on.

    Args:
        task: The task of points without a layout.
        layouts: Tasks by their names; all are checked here.
        cpus_per_trial: Processor threads of a training, also what Ray reserves for it.
        options: Arguments of `myoenv.train` for all points, such as `steps` and `settings`.
    """
    tune = _tune()
    threads = as_count("cpus_per_trial", cpus_per_trial, MOST_THREADS)
    if task is None and not layouts:
        raise ValueError("name a task or layouts")
    known = {name: _described(one) for name, one in as_mapping("layouts", layouts).items()}
    default = None if task is None else _described(task)
    settings = as_mapping("settings", options.pop("settings", None))

    def run(point: dict[str, Any]) -> None:
        point = dict(point)
        layout = point.pop("layout", None)
        if layout is not None and layout not in known:
            raise ValueError(f"layout is {layout!r}; it must be one of {', '.join(map(repr, known))}")
        arguments = {name: point.pop(name) for name in _ARGUMENTS if name in point}
        latest: Metrics = {}

        def report(metrics: Metrics) -> None:
            latest.update(metrics)
            tune.report(metrics)

        result = train(
            default if layout is None else known[layout],
            **{"backend": "cpu", "threads": threads, **options, **arguments},
            settings={**settings, **point},
            callback=report,
        )
        tune.report({**latest, **evaluation_columns(result)})

    return tune.with_resources(run, {"cpu": threads})


def _described(task: TaskLike) -> dict[str, Any]:
    """A task as text that goes to other machines, checked."""
    return to_dict(task_and_model(task)[0])


def _tune() -> Any:
    try:
        from ray import tune
    except ImportError:
        raise ImportError("this needs Ray Tune; install it with: pip install 'myoenv[tune]'") from None
    return tune
