"""How well a policy does."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv import _native
from myoenv.arguments import as_actions, as_count, as_num_envs, as_path, as_seed
from myoenv.policy import Policy
from myoenv.runs import read_run
from myoenv.tasks import ModelLike, TaskLike, load_model, load_task
from myoenv.vector import Backend, make_vec

# What acts: a batch of observations to a batch of actions.
Actor = Callable[[NDArray[np.float32]], Any]


def evaluate(
    run: str | PathLike[str] | Policy | Actor,
    episodes: int = 1000,
    *,
    task: TaskLike | None = None,
    checkpoint: int | str | PathLike[str] | None = None,
    seed: int | None = None,
    num_envs: int = 1024,
    backend: Backend = "auto",
    device: str | int | None = None,
    model: ModelLike | None = None,
) -> dict[str, NDArray[np.float32]]:
    """Runs a policy, ours or anybody's, on fresh episodes; returns one array per quantity, one entry per episode.

    `pandas.DataFrame(evaluate("runs/pointing-1"))` is a table. Columns: `return`, `length` (control steps), `success`,
    `targets_done`, `final_distance` (m), `effort`, `fatigue`, the parts of the reward, and for each target
    `target_1_success`, `target_1_movement_time` (s: from the end of the target before it, or the reset, to the last
    entry or the touch, without dwell, in whole physics steps) and `target_1_time` (s: to its own end, dwell included,
    in whole control steps), both NaN where it was not done. Of a run of several layouts there are `episodes` of each,
    and `layout` tells which, counted from 0.

    Args:
        run: A run folder or a `Policy`, of which the mean actions are taken, or any function that makes actions
            `(num_envs, nmuscle)` of observations `(num_envs, observation_size)`.
        episodes: How many, of each layout.
        task: The task, that of the run or all of its layouts by default. Another one than those may have other objects
            in other places and other steps, though the user was not trained there; body, technique, control step and
            what is perceived must be the same, else all that differs is named. It is done by the user of the run, with
            its body where the task does not say `body`.
        checkpoint: Another checkpoint of the run than the newest: the control steps after which it was written, or the
            path of its file.
        seed: Seed of the episodes; by default one made from that of the training, never the same.
        num_envs: Most environments side by side.
        backend: `"cpu"`, `"gpu"` or `"auto"`.
        device: A graphics card by its number or a part of its name.
        model: Another body than that of the run, or of the task if one is named.
    """
    episodes = as_count("episodes", episodes)
    policy: Actor
    layouts: list[TaskLike] = []
    if callable(run):
        if checkpoint is not None:
            raise ValueError("a policy alone has no checkpoints; name a run folder, or leave out checkpoint")
        policy, trained_with = run, 0
    else:
        description = read_run(run)
        policy, trained_with = Policy.load(run, checkpoint=checkpoint), description.seed
        if task is None:
            layouts, model = list(description.layouts), description.model if model is None else model
        else:
            task = load_task(task).done_as(load_task(description.task))
            _refuse_misfits(run, task, model)
    if task is not None:
        layouts = [task]
    if not layouts:
        raise ValueError("a policy alone knows no task; name one with task=...")
    seed = _native.evaluation_seed(trained_with, 0) if seed is None else as_seed(seed)
    side_by_side = max(min(as_num_envs(num_envs), episodes * len(layouts)), len(layouts))
    envs = make_vec(
        num_envs=side_by_side, backend=backend, layouts=layouts, autoreset="same_step", device=device, model=model
    )
    try:
        return _episodes(policy, envs._env, episodes, seed, len(layouts))
    finally:
        envs.close()


def _refuse_misfits(run: str | PathLike[str], task: TaskLike, model: ModelLike | None) -> None:
    """Refuses a task in which the user of a run cannot act, with all that differs."""
    other = load_task(task)
    body = load_model(other.model if model is None else model)
    misfits = _native.misfits(as_path("run", run), other, body)
    if misfits:
        raise ValueError(f"the user of {run} cannot do {other.name}: {'; '.join(misfits)}")


def _episodes(
    policy: Actor, env: _native.Env, episodes: int, seed: int, layouts: int
) -> dict[str, NDArray[np.float32]]:
    """Every environment counts its first few episodes, equally many up to one: were the first ones to end anywhere
    counted, short episodes, mostly the successful ones, would be over-represented."""
    if isinstance(policy, Policy) and policy.observation_names != env.observation_names:
        raise ValueError("the policy was trained on other observations than those of this task")
    if isinstance(policy, Policy) and policy.action_names != env.action_names:
        raise ValueError("the policy was trained with other actions than those of this body")
    count = env.num_envs
    shape = (count, len(env.action_names))
    same = [len(range(i % layouts, count, layouts)) for i in range(count)]
    quota = np.array([episodes // n + (i // layouts < episodes % n) for i, n in enumerate(same)])
    rows: list[list[NDArray[np.float32]]] = [[] for _ in range(count)]
    observation = env.reset(seed, None, None)
    while quota.any():
        observation, _, _, _, ended = env.step(as_actions(policy(observation), shape))
        if ended is None:
            continue
        for one, summary in zip(ended[0], ended[2], strict=True):
            if quota[one]:
                quota[one] -= 1
                rows[one].append(summary)
    table = np.concatenate([np.array(of_env, np.float32) for of_env in rows])
    columns = {name: table[:, k].copy() for k, name in enumerate(env.episode_names)}
    if layouts > 1:
        columns["layout"] = np.concatenate([np.full(len(of_env), i % layouts) for i, of_env in enumerate(rows)])
    return columns
