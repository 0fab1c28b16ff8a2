"""One training from start, or from a checkpoint, to its end; the loop is here, each update in the compiled half."""

from __future__ import annotations

import json
import sys
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from myoenv import _native
from myoenv._native import DeviceError
from myoenv.policy import Policy
from myoenv.runs import RunDescription

#: Seconds between two lines of progress.
_LINE_EVERY = 5.0

Metrics = dict[str, float]
Evaluation = dict[str, Any]


@dataclass
class TrainResult:
    """How a training went; in a run that was resumed, counts and seconds of before are included."""

    #: `until`, `plateau`, `steps`, `callback` or `interrupt`.
    stopped_by: str
    #: Control steps of all environments.
    env_steps: int
    #: Updates of the policy.
    updates: int
    #: Seconds of training and of looking at the goal.
    wall_s: float
    #: The deterministic policy on fresh episodes, with the keys of `evaluation.json`; none after an interrupt.
    evaluation: Evaluation | None
    #: What the `last_doubling` of the training brought, at `env_steps` counted from `since`, and what `four_times` as
    #: many steps would: changes of `episode_time` and `return` as shares of themselves and of what was gained, of
    #: `success` as a share of all episodes; none where that cannot be told.
    trend: Metrics | None
    #: The policy.
    policy: Policy = field(repr=False)
    #: The run folder, if the training was recorded.
    run: Path | None


class Callback:
    """Follows a training from its start to its end; `myoenv.train` takes one in place of a function."""

    def start(self, description: RunDescription, folder: Path | None) -> None:
        """Called once before the first update; `folder` is the run folder, if there is one."""

    def __call__(self, metrics: Metrics) -> Any:
        """Called after every update with the columns of `metrics.csv`; training stops when it returns True."""

    def finish(self, result: TrainResult | None) -> None:
        """Called once at the end, however the training ended; without a result after an error."""


class Session:
    """One training that is about to run."""

    def __init__(self, native: _native.Session, folder: Path | None, progress: bool = False) -> None:
        self.native, self.folder, self.progress = native, folder, progress
        self.last_line = time.monotonic()

    def run(self, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        """Trains to the end."""
        result: TrainResult | None = None
        try:
            if isinstance(callback, Callback):
                callback.start(RunDescription.from_json(self.native.description()), self.folder)
            result = self._run(callback)
            return result
        finally:
            # Whatever ended the training, a whole one leaves a checkpoint; and another may go on with the run, even
            # while a traceback still holds this one.
            self.native.leave()
            if isinstance(callback, Callback):
                callback.finish(result)

    def _run(self, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        try:
            end, reason = self._train(callback)
        except KeyboardInterrupt:
            end, reason = "interrupt", None
        policy = Policy(self.native.policy())
        concluded, raised = self.native.conclude(end)
        outcome = json.loads(concluded)
        if end == "device_lost":
            path = outcome["checkpoint"]
            kept = "" if path is None else f"; the run goes on from its checkpoint {path}, with new episodes"
            raise DeviceError(f"the GPU was lost: {reason}{kept}")
        # Ctrl-C during the last evaluation: the training is whole, its evaluation is not.
        if raised is not None and not isinstance(raised, KeyboardInterrupt):
            raise raised
        return TrainResult(
            # What ended the last evaluation does not concern the callback.
            stopped_by=end if outcome["stopped_by"] == "steps" else outcome["stopped_by"],
            env_steps=outcome["env_steps"],
            updates=outcome["updates"],
            wall_s=outcome["wall_s"],
            evaluation=outcome["evaluation"],
            trend=outcome["trend"],
            policy=policy,
            run=self.folder,
        )

    def _train(self, callback: Callable[[Metrics], Any] | None) -> tuple[str, str | None]:
        """Updates until there is a reason to stop; which it is, and what the driver said if the card was lost."""
        while True:
            progress = self.native.advance()
            for sentence in progress["news"]:
                warnings.warn(sentence, RuntimeWarning, stacklevel=5)
            self._show(progress["line"])
            metrics = progress["metrics"]
            stopped = callback is not None and metrics is not None and callback(metrics) is True
            # What a signal handler raised, such as KeyboardInterrupt; only now: the callback hears of every update.
            if progress["raised"] is not None:
                raise progress["raised"]
            if progress["end"] is not None:
                return progress["end"], progress["reason"]
            if stopped:
                return "callback", None

    def _show(self, line: str | None) -> None:
        """Writes how it goes to standard error, every few seconds."""
        if self.progress and line is not None and time.monotonic() >= self.last_line + _LINE_EVERY:
            self.last_line = time.monotonic()
            print(line, file=sys.stderr, flush=True)
