"""One training from start, or from a checkpoint, to its end; the loop around updates that are Rust's."""

from __future__ import annotations

import json
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from myoenv import _native
from myoenv._native import DeviceError
from myoenv.policy import Policy
from myoenv.runs import RunDescription

Metrics = dict[str, float]
Evaluation = dict[str, Any]


@dataclass
class TrainResult:
    """How a training went; in a run that was resumed, counts and seconds of before are included."""

    #: `until`, `steps`, `callback` or `interrupt`.
    stopped_by: str
    #: Control steps of all environments.
    env_steps: int
    #: Updates of the policy.
    updates: int
    #: Seconds of training and of looking at the goal.
    wall_s: float
    #: The deterministic policy on fresh episodes, with the keys of `evaluation.json`; none after an interrupt.
    evaluation: Evaluation | None
    #: The policy.
    policy: Policy = field(repr=False)
    #: The run folder, if the training was recorded.
    run: Path | None


class Session:
    """One training that is about to run."""

    def __init__(self, native: _native.Session, description: RunDescription) -> None:
        self.native, self.description = native, description
        self.folder: Path | None = None

    def record_in(self, folder: str, *, go_on: bool) -> None:
        """Makes a run folder, or goes on with one: metrics, checkpoints and the evaluation are kept there."""
        self.native.record_in(folder, json.dumps(self.description.to_dict()), go_on)
        self.folder = Path(folder)

    def run(self, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        """Trains to the end."""
        try:
            return self._run(callback)
        finally:
            # Another training may go on with the run, even while a traceback still holds this one.
            self.native.abandon()

    def _run(self, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        try:
            end = self._train(callback)
        except KeyboardInterrupt:
            end = "interrupt"
        except DeviceError as error:
            path = json.loads(self.native.conclude("device_lost"))["checkpoint"]
            kept = "" if path is None else f"; the run goes on from its checkpoint {path}, with new episodes"
            raise DeviceError(f"{error}{kept}") from None
        except Exception:
            self.native.conclude("interrupt")
            raise
        policy = Policy(self.native.policy())
        outcome = json.loads(self.native.conclude(end))
        return TrainResult(
            # What ended the last evaluation is no matter of the callback.
            stopped_by=end if outcome["stopped_by"] == "steps" else outcome["stopped_by"],
            env_steps=outcome["env_steps"],
            updates=outcome["updates"],
            wall_s=outcome["wall_s"],
            evaluation=outcome["evaluation"],
            policy=policy,
            run=self.folder,
        )

    def _train(self, callback: Callable[[Metrics], Any] | None) -> str:
        """Updates until there is a reason to stop; the reason."""
        while True:
            progress = self.native.advance()
            for sentence in progress["news"]:
                warnings.warn(sentence, RuntimeWarning, stacklevel=5)
            if progress["end"] == "device_lost":
                raise DeviceError(f"the GPU was lost: {progress['reason']}")
            metrics = progress["metrics"]
            stopped = callback is not None and metrics is not None and callback(metrics) is True
            if progress["end"] is not None:
                return progress["end"]
            if stopped:
                return "callback"
