"""One training from start, or from a checkpoint, to its end. The loop is that of `myo train`."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from myoenv import _native
from myoenv._native import DeviceError
from myoenv.evaluation import evaluation_seed
from myoenv.policy import Policy
from myoenv.runs import RunDescription
from myoenv.tasks import Model, Task

Metrics = dict[str, float]
Evaluation = dict[str, Any]

# Episodes of a quick look whether the goal is reached, and of the one that confirms it.
_LOOKS = (256, 1000)
# Environments that evaluate side by side.
_LOOK_ENVS = 256
# Training success lags behind that of the deterministic policy: a look is worth its time this near to the goal.
_NEAR = 0.2
# Episodes over which training success is averaged.
_MEMORY = 500.0
# Control steps of training for each one of evaluation, so that looking costs little.
_STEPS_PER_LOOK = 8
# Control steps after which a look is taken in any case.
_LONGEST_WAIT = 4_000_000
# Seconds between two checkpoints.
_CHECKPOINT_EVERY = 30.0


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


class _Schedule:
    """When to look whether the goal is reached; by steps, not by the clock, so that a seed stops at the same update."""

    def __init__(self, until: float, env_steps: int) -> None:
        self.until = until
        self.recent: float | None = None
        self.last_look = env_steps
        self.wait = 0

    def is_due(self, metrics: Metrics) -> bool:
        """Hears of an update; whether to look now."""
        success = metrics["success"]
        if not math.isnan(success):
            before = success if self.recent is None else self.recent
            self.recent = before + (1 - math.exp(-metrics["episodes"] / _MEMORY)) * (success - before)
        near = self.recent is not None and self.recent >= self.until - _NEAR
        return metrics["env_steps"] - self.last_look >= (self.wait if near else _LONGEST_WAIT)

    def looked(self, env_steps: int, cost: int) -> None:
        """Hears that a look was taken and how many control steps it took."""
        self.last_look = env_steps
        self.wait = _STEPS_PER_LOOK * cost


class Session:
    """One training that is about to run."""

    def __init__(self, trainer: _native.Trainer, task: Task, model: Model, description: RunDescription) -> None:
        self.trainer, self.task, self.model, self.description = trainer, task, model, description
        until = description.until
        self.schedule = None if until is None else _Schedule(until, trainer.env_steps)
        self.folder: Path | None = None
        self.looks = 0
        self.training_s = 0.0
        self.evaluation_s = 0.0
        self.saved_at = time.monotonic()

    def record_in(self, folder: str, *, go_on: bool) -> None:
        """Makes a run folder, or goes on with one: metrics, checkpoints and the evaluation are kept there."""
        self.trainer.record_in(folder, json.dumps(self.description.to_dict()), go_on)
        self.folder = Path(folder)

    def run(self, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        """Trains to the end."""
        try:
            return self._run(callback)
        finally:
            # Another training may go on with the run, even while a traceback still holds this one.
            self.trainer.stop_recording()

    def _run(self, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        try:
            stopped_by, evaluation = self._train(callback)
            self._checkpoint()
            evaluation = evaluation or self._evaluate(_LOOKS[-1])
        except KeyboardInterrupt:
            stopped_by, evaluation = "interrupt", None
            self._checkpoint()
        if evaluation is not None:
            self.trainer.record_evaluation(json.dumps(evaluation))
        return TrainResult(
            stopped_by=stopped_by,
            env_steps=self.trainer.env_steps,
            updates=self.trainer.updates,
            wall_s=self.training_s + self.evaluation_s,
            evaluation=evaluation,
            policy=Policy(self.trainer.policy()),
            run=self.folder,
        )

    def _train(self, callback: Callable[[Metrics], Any] | None) -> tuple[str, Evaluation | None]:
        """Updates until there is a reason to stop; with the evaluation that was the reason."""
        while self.trainer.env_steps < self.description.steps:
            metrics = self._update()
            self.training_s = metrics["wall_s"]
            if time.monotonic() - self.saved_at > _CHECKPOINT_EVERY:
                self._checkpoint()
            if callback is not None and self._call(callback, metrics):
                return "callback", None
            if self.schedule is not None and self.schedule.is_due(metrics):
                reached = self._look(self.schedule)
                if reached is not None:
                    return "until", reached
        return "steps", None

    def _update(self) -> Metrics:
        try:
            return self.trainer.update()
        except DeviceError as error:
            path = self._checkpoint()
            kept = "" if path is None else f"; the run goes on from its checkpoint {path}, with new episodes"
            raise DeviceError(f"{error}{kept}") from None

    def _call(self, callback: Callable[[Metrics], Any], metrics: Metrics) -> bool:
        try:
            return callback(metrics) is True
        except Exception:
            self._checkpoint()
            raise

    def _checkpoint(self) -> str | None:
        self.saved_at = time.monotonic()
        return self.trainer.checkpoint()

    def _look(self, schedule: _Schedule) -> Evaluation | None:
        """The evaluation in which the goal is reached, if it is: quickly first, then on enough episodes to be sure."""
        cost, reached = 0, None
        for episodes in _LOOKS:
            evaluation = self._evaluate(episodes)
            cost += -(-episodes // _LOOK_ENVS) * _LOOK_ENVS * self.trainer.max_episode_steps
            reached = evaluation if evaluation["success"] >= schedule.until else None
            if reached is None:
                break
        schedule.looked(self.trainer.env_steps, cost)
        return reached

    def _evaluate(self, episodes: int) -> Evaluation:
        start = time.perf_counter()
        self.looks += 1
        seed = evaluation_seed(self.description.seed, self.looks)
        policy = self.trainer.policy()
        text = _native.evaluate(policy, self.task, self.model, episodes=episodes, num_envs=_LOOK_ENVS, seed=seed)
        self.evaluation_s += time.perf_counter() - start
        return json.loads(text)
