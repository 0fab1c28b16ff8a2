"""The library's own PPO: train, look, stop. The loop is that of `myo train`, and so are the run folders."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv import _native
from myoenv.arguments import as_count, as_seed
from myoenv.policy import Policy
from myoenv.tasks import Model, ModelLike, Task, TaskLike, task_and_model, to_dict
from myoenv.vector import Backend, make_vec

Metrics = dict[str, float]

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
    """How a training went."""

    #: `until`, `steps`, `callback` or `interrupt`.
    stopped_by: str
    #: Control steps of all environments.
    env_steps: int
    #: Updates of the policy.
    updates: int
    #: Seconds, looks at the goal included.
    wall_s: float
    #: The deterministic policy on fresh episodes, with the keys of `evaluation.json`; none after an interrupt.
    evaluation: dict[str, Any] | None
    #: The policy.
    policy: Policy = field(repr=False)
    #: The run folder, if the training was recorded.
    run: Path | None


def train(
    task: TaskLike,
    *,
    seed: int = 1,
    until: float | None = 0.95,
    steps: int = 60_000_000,
    out: str | PathLike[str] | None = None,
    callback: Callable[[Metrics], Any] | None = None,
    settings: Mapping[str, Any] | None = None,
    num_envs: int | None = None,
    backend: Backend = "auto",
    device: str | None = None,
    threads: int | None = None,
    model: ModelLike | None = None,
) -> TrainResult:
    """Trains a policy with PPO.

    Args:
        task: A preset's name, a YAML or TOML file, a YAML text, a dictionary, or a `Task`.
        seed: Seed of everything random.
        until: Share of fresh episodes in which the deterministic policy must succeed; None trains all `steps`.
        steps: Control steps of all environments after which to stop in any case.
        out: Run folder to make, as `myo train` makes it; without one nothing is written.
        callback: Called after every update with its metrics (the columns of `metrics.csv`; NaN where there is none);
            training stops when it returns True.
        settings: Settings of PPO that differ from their defaults, such as `{"gamma": 0.98}`.
        num_envs: Environments side by side.
        backend: `"cpu"`, `"gpu"` or `"auto"`.
        device: A graphics card by its number or a part of its name.
        threads: Threads of the processor, all by default.
        model: Another body than the task's.

    Ctrl-C stops with a checkpoint.
    """
    if until is not None and not 0 < until <= 1:
        raise ValueError(f"until is {until}; it must be above 0 and at most 1, or None")
    task, body = task_and_model(task, model)
    session = _Session(task, body, as_seed(seed), until, as_count("steps", steps))
    config = dict(settings or {})
    if num_envs is not None:
        config["num_envs"] = as_count("num_envs", num_envs)
    session.trainer = _native.Trainer(
        task,
        body,
        config=_settings(config),
        seed=session.seed,
        backend=backend,
        device=device,
        threads=None if threads is None else as_count("threads", threads),
        resume=None,
    )
    return session.run(out, callback)


def evaluate(
    run: str | PathLike[str] | Policy,
    episodes: int = 1000,
    *,
    task: TaskLike | None = None,
    seed: int | None = None,
    num_envs: int = 1024,
    backend: Backend = "auto",
    device: str | None = None,
    model: ModelLike | None = None,
) -> dict[str, NDArray[np.float32]]:
    """Runs a policy's mean actions on fresh episodes; returns one array per quantity, one entry per episode.

    `pandas.DataFrame(evaluate("runs/pointing-1"))` is a table. Columns: `return`, `length` (control steps), `success`,
    `targets_done`, `final_distance` (m), `effort`, the parts of the reward, and for each target `target_1_success` and
    `target_1_time` (s, NaN where it was not done).

    Args:
        run: A run folder, or a `Policy`.
        episodes: How many.
        task: The task; that of the run by default.
        seed: Seed of the episodes; by default one made from that of the training, never the same.
        num_envs: Most environments side by side.
        backend: `"cpu"`, `"gpu"` or `"auto"`.
        device: A graphics card by its number or a part of its name.
        model: Another body than the task's.
    """
    episodes = as_count("episodes", episodes)
    policy, task, trained_with = _what_to_evaluate(run, task)
    seed = evaluation_seed(trained_with, 0) if seed is None else as_seed(seed)
    envs = make_vec(
        task, min(as_count("num_envs", num_envs), episodes), backend, autoreset="same_step", device=device, model=model
    )
    try:
        return _episodes(policy, envs._env, episodes, seed)
    finally:
        envs.close()


def _what_to_evaluate(run: Any, task: TaskLike | None) -> tuple[Policy, TaskLike, int]:
    if isinstance(run, Policy):
        if task is None:
            raise ValueError("a policy alone knows no task; name one with task=...")
        return run, task, 0
    config = json.loads(_native.run_config(fspath(run)))
    return Policy.load(run), config["run"]["task"] if task is None else task, config["seed"]


def _episodes(policy: Policy, env: _native.Env, episodes: int, seed: int) -> dict[str, NDArray[np.float32]]:
    """Every environment counts its first few episodes, equally many up to one: were the first ones to end anywhere
    counted, short episodes, mostly the successful ones, would be over-represented."""
    if policy.observation_names != env.observation_names:
        raise ValueError("the policy was trained on other observations than those of this task")
    count = env.num_envs
    quota = np.array([episodes // count + (i < episodes % count) for i in range(count)])
    rows: list[list[NDArray[np.float32]]] = [[] for _ in range(count)]
    observation = env.reset(seed, None, None)
    while quota.any():
        observation, _, _, _, ended = env.step(policy._native.act(observation))
        if ended is None:
            continue
        for one, summary in zip(ended[0], ended[2], strict=True):
            if quota[one]:
                quota[one] -= 1
                rows[one].append(summary)
    table = np.concatenate([np.array(of_env, np.float32) for of_env in rows])
    return {name: table[:, k].copy() for k, name in enumerate(env.episode_names)}


def evaluation_seed(training_seed: int, number: int) -> int:
    """A seed for the `number`-th evaluation that is not the one of the training; 0 is that of `evaluate`.

    SplitMix64 (Steele et al. 2014, doi 10.1145/2714064.2660195): neighbours become far apart. So does `myo eval`.
    """
    word = 2**64 - 1
    z = (training_seed + (number + 1) * 0x9E3779B97F4A7C15) & word
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & word
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & word
    return z ^ (z >> 31)


class _Schedule:
    """When to look whether the goal is reached; by steps, not by the clock, so that a seed stops at the same update."""

    def __init__(self, until: float) -> None:
        self.until = until
        self.recent: float | None = None
        self.last_look = 0
        self.wait = 0

    def is_due(self, metrics: Metrics) -> bool:
        success = metrics["success"]
        if not math.isnan(success):
            before = success if self.recent is None else self.recent
            self.recent = before + (1 - math.exp(-metrics["episodes"] / _MEMORY)) * (success - before)
        near = self.recent is not None and self.recent >= self.until - _NEAR
        return metrics["env_steps"] - self.last_look >= (self.wait if near else _LONGEST_WAIT)

    def looked(self, env_steps: int, cost: int) -> None:
        self.last_look = env_steps
        self.wait = _STEPS_PER_LOOK * cost


class _Session:
    """One training from start to end."""

    trainer: _native.Trainer

    def __init__(self, task: Task, model: Model, seed: int, until: float | None, steps: int) -> None:
        self.task, self.model, self.seed, self.until, self.steps = task, model, seed, until, steps
        self.schedule = None if until is None else _Schedule(until)
        self.looks = 0
        self.evaluation: dict[str, Any] | None = None

    def run(self, out: str | PathLike[str] | None, callback: Callable[[Metrics], Any] | None) -> TrainResult:
        if out is not None:
            self.trainer.record_in(fspath(out), json.dumps(self.description()))
        start = time.perf_counter()
        try:
            stopped_by = self._updates(callback)
            if self.evaluation is None:
                self.evaluation = self._evaluate(_LOOKS[-1])
        except KeyboardInterrupt:
            stopped_by, self.evaluation = "interrupt", None
        self.trainer.checkpoint()
        if self.evaluation is not None:
            self.trainer.record_evaluation(json.dumps(self.evaluation))
        return TrainResult(
            stopped_by=stopped_by,
            env_steps=self.trainer.env_steps,
            updates=self.trainer.updates,
            wall_s=time.perf_counter() - start,
            evaluation=self.evaluation,
            policy=Policy(self.trainer.policy()),
            run=None if out is None else Path(out),
        )

    def description(self) -> dict[str, Any]:
        """The caller's part of `config.json`, as the command line reads it."""
        device = {} if self.trainer.device is None else {"device": self.trainer.device}
        return {
            "task": to_dict(self.task),
            "backend": self.trainer.backend,
            **device,
            "version": _native.__version__,
            "until": self.until,
            "steps": self.steps,
        }

    def _updates(self, callback: Callable[[Metrics], Any] | None) -> str:
        saved = time.monotonic()
        while self.trainer.env_steps < self.steps:
            metrics = self.trainer.update()
            if time.monotonic() - saved > _CHECKPOINT_EVERY:
                self.trainer.checkpoint()
                saved = time.monotonic()
            if callback is not None and callback(metrics) is True:
                return "callback"
            if self.schedule is not None and self.schedule.is_due(metrics) and self._reached(self.schedule):
                return "until"
        return "steps"

    def _reached(self, schedule: _Schedule) -> bool:
        """Looks quickly first, then on enough episodes to be sure."""
        cost = 0
        for episodes in _LOOKS:
            evaluation = self._evaluate(episodes)
            cost += -(-episodes // _LOOK_ENVS) * _LOOK_ENVS * self.trainer.max_episode_steps
            reached = evaluation["success"] >= schedule.until
            if not reached:
                break
        schedule.looked(self.trainer.env_steps, cost)
        if reached:
            self.evaluation = evaluation
        return reached

    def _evaluate(self, episodes: int) -> dict[str, Any]:
        self.looks += 1
        seed = evaluation_seed(self.seed, self.looks)
        policy = self.trainer.policy()
        text = _native.evaluate(policy, self.task, self.model, episodes=episodes, num_envs=_LOOK_ENVS, seed=seed)
        return json.loads(text)


def _settings(config: dict[str, Any]) -> str:
    try:
        return json.dumps(config, default=lambda value: value.tolist(), allow_nan=False)
    except (TypeError, ValueError, AttributeError) as error:
        raise ValueError(f"bad training setting: {error}") from None


def default_settings() -> dict[str, Any]:
    """The settings of PPO with their defaults."""
    return json.loads(_native.default_settings())
