"""Callbacks by name: `myoenv.train("pointing", callback="wandb")`.

Both follow a training with what `metrics.csv` has as columns, by control steps, and end with the evaluation. For other
settings than the defaults, make one: `callback=WandbCallback(project="reach", mode="offline")`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

from myoenv.runs import RunDescription
from myoenv.session import Callback, Metrics, TrainResult

# A longer value of a parameter is refused by servers of MLflow.
_LONGEST_PARAMETER = 6000


class WandbCallback(Callback):
    """Records a training as a run of Weights & Biases; needs `pip install wandb`."""

    def __init__(self, **options: Any) -> None:
        """`options` are those of `wandb.init`; the project is `myo` by default."""
        self._wandb = _import("wandb", "wandb")
        self._options = {"project": "myo", **options}
        self._run: Any = None

    def start(self, description: RunDescription, folder: Path | None) -> None:
        """Opens the run, with everything that describes the training as its configuration."""
        name = {} if folder is None else {"name": folder.name}
        self._run = self._wandb.init(config=_configuration(description), **(name | self._options))

    def __call__(self, metrics: Metrics) -> None:
        """Logs what there is of the metrics."""
        self._run.log(_finite(metrics), step=int(metrics["env_steps"]))

    def finish(self, result: TrainResult | None) -> None:
        """Puts the evaluation in the summary and closes the run; as failed if the training failed."""
        if self._run is None:
            return
        if result is not None:
            self._run.summary.update({"stopped_by": result.stopped_by, **evaluation_columns(result)})
        self._run.finish(exit_code=1 if result is None else 0)


class MlflowCallback(Callback):
    """Records a training as a run of MLflow: the active one, or a new one; needs `pip install mlflow`."""

    def __init__(self, **options: Any) -> None:
        """`options` are those of `mlflow.start_run`."""
        self._mlflow = _import("mlflow", "mlflow")
        self._options = options
        self._own = self._open = False

    def start(self, description: RunDescription, folder: Path | None) -> None:
        """Opens a run unless one is active, with everything that describes the training as its parameters."""
        self._own = self._mlflow.active_run() is None
        if self._own:
            name = {} if folder is None else {"run_name": folder.name}
            self._mlflow.start_run(**(name | self._options))
        self._open = True
        parameters = {name: value for name, value in _configuration(description).items() if value is not None}
        texts = {name: value if isinstance(value, str) else json.dumps(value) for name, value in parameters.items()}
        self._mlflow.log_params({name: text[:_LONGEST_PARAMETER] for name, text in texts.items()})

    def __call__(self, metrics: Metrics) -> None:
        """Logs what there is of the metrics."""
        self._mlflow.log_metrics(_finite(metrics), step=int(metrics["env_steps"]))

    def finish(self, result: TrainResult | None) -> None:
        """Logs the evaluation, and closes the run if it was opened here; as failed if the training failed."""
        if not self._open:
            return
        if result is not None:
            self._mlflow.set_tag("stopped_by", result.stopped_by)
            self._mlflow.log_metrics(evaluation_columns(result), step=result.env_steps)
        if self._own:
            self._mlflow.end_run("FAILED" if result is None else "FINISHED")


_NAMED: dict[str, Callable[[], Callback]] = {"wandb": WandbCallback, "mlflow": MlflowCallback}


def as_callback(callback: Any) -> Callable[[Metrics], Any] | None:
    """What follows a training: a function, a `Callback`, or one by its name."""
    if isinstance(callback, str) and callback in _NAMED:
        return _NAMED[callback]()
    if callback == "tensorboard":
        raise ValueError("a run folder has TensorBoard events without a callback: name a folder with out=...")
    if callback is None or (callable(callback) and not isinstance(callback, type)):
        return callback
    raise TypeError(f"callback is {callback!r}; it must be a function, a Callback, {' or '.join(map(repr, _NAMED))}")


def _import(module: str, package: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        raise ImportError(f"this callback needs {package}; install it with: pip install {package}") from None


def _configuration(description: RunDescription) -> dict[str, Any]:
    """Everything that describes a training, the settings of PPO one by one."""
    return {"seed": description.seed, **description.run, **description.settings}


def _finite(metrics: Metrics) -> Metrics:
    """Without what does not exist, such as the success of no episodes."""
    return {name: value for name, value in metrics.items() if math.isfinite(value)}


def evaluation_columns(result: TrainResult) -> Metrics:
    """The evaluation as a flat table: `evaluation/success`, `evaluation/target_1_success`, ...; what there is of it.

    Intervals become two columns, `evaluation/success_low` and `evaluation/success_high`.
    """
    evaluation = dict(result.evaluation or {})
    for k, target in enumerate(evaluation.pop("targets", ()), start=1):
        evaluation |= {f"target_{k}_{name}": value for name, value in target.items()}
    columns: dict[str, Any] = {}
    for name, value in evaluation.items():
        if name.endswith("_interval"):
            low, high = value or (None, None)
            what = name.removesuffix("_interval")
            columns |= {f"{what}_low": low, f"{what}_high": high}
        else:
            columns[name] = value
    return {f"evaluation/{name}": float(value) for name, value in columns.items() if value is not None}
