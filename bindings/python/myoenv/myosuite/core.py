"""The state of many bodies, what they observe, and what it is worth."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv._native import Bodies
from myoenv.myosuite.tasks import load_body, task

#: Poses among which targets that can be reached are looked for, and the seed of that search (MyoSuite's own).
_POSES, _POSES_SEED = 100_000, 0


class Core:
    """Bodies that do one of MyoSuite's tasks; episodes begin where the caller says."""

    def __init__(self, env_id: str, num_envs: int, threads: int | None) -> None:
        self.task = task(env_id)
        # Coupled joints are MuJoCo's: each has a position of its own.
        self.bodies = Bodies(load_body(self.task["body"]), num_envs, soft_couplings=True, threads=threads)
        self.control_dt: float = self.task["frame_skip"] * self.bodies.timestep
        self.nmuscle = len(self.bodies.muscle_names)
        self.rest = np.array(self.task["init_qpos"])
        low, high = np.array(self.task["low"]), np.array(self.task["high"])
        self.goal = np.tile((low + high).ravel() / 2, (num_envs, 1))
        self.time = np.zeros(num_envs)
        self._table = _reachable(self.bodies, self.task, self.rest) if self.task.get("within_reach") else None

    def begin(self, envs: NDArray[np.int64], rngs: list[np.random.Generator]) -> None:
        """New episodes: a target, then, in some tasks, a pose of chance, both drawn as MyoSuite draws them."""
        poses = np.tile(self.rest, (len(envs), 1))
        for row, env in enumerate(envs):
            self.goal[env] = self._target(rngs[env])
            if self.task.get("random_start"):
                low, high = self.bodies.joint_ranges.T
                poses[row] = rngs[env].uniform(low=low, high=high)
        relaxed = np.zeros((len(envs), self.nmuscle))
        self.bodies.set(envs, poses, np.zeros_like(poses), relaxed)
        self.time[envs] = 0.0

    def _target(self, rng: np.random.Generator) -> NDArray[np.float64]:
        low, high = np.array(self.task["low"]), np.array(self.task["high"])
        if self._table is not None:
            return np.asarray(self._table[rng.integers(len(self._table))]).ravel()
        if self.task["kind"] == "pose":
            return rng.uniform(low=low, high=high) if self.task["generated"] else low
        return np.concatenate([rng.uniform(low=one, high=other) for one, other in zip(low, high, strict=True)])

    def advance(self, actions: NDArray[np.float32]) -> None:
        """One control step of all."""
        clipped = np.clip(actions, np.float32(-1), np.float32(1))
        excitation = 1.0 / (1.0 + np.exp(-5.0 * (clipped - 0.5)))
        self.bodies.step(excitation.astype(np.float32), self.task["frame_skip"])
        # As MuJoCo's clock: what is later than two control steps is so by rounding, too.
        for _ in range(self.task["frame_skip"]):
            self.time += self.bodies.timestep

    def look(self) -> tuple[NDArray[np.float32], NDArray[np.float64], NDArray[np.bool_], dict[str, NDArray[Any]]]:
        """Observations, rewards, whether episodes are over, and what rewards are made of, with `solved`."""
        qpos, qvel, activation = self.bodies.qpos, self.bodies.qvel, self.bodies.activation
        if self.task["kind"] == "pose":
            error = self.goal - qpos[:, : self.goal.shape[1]].astype(np.float64)
            shown, terms = [error], self._pose(error)
        else:
            tips = self.bodies.site_positions(self.task["tips"]).reshape(len(qpos), -1)
            shown, terms = [tips, self.goal - tips], self._reach(self.goal - tips)
        terms["act_reg"] = -np.linalg.norm(activation, axis=1).astype(np.float64) / self.nmuscle
        reward = np.sum([weight * terms[key] for key, weight in self.task["weights"].items()], axis=0)
        over = terms["penalty"] < 0
        return np.hstack([qpos, qvel * self.control_dt, *shown, activation]).astype(np.float32), reward, over, terms

    def _pose(self, error: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
        distance, near = np.linalg.norm(error, axis=1), self.task["near"]
        return {
            "pose": -distance,
            "bonus": 1.0 * (distance < near) + 1.0 * (distance < self.task["bonus_within"] * near),
            "penalty": -1.0 * (distance > self.task["far"]),
            "solved": distance < near,
        }

    def _reach(self, error: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
        distance, tips = np.linalg.norm(error, axis=1), len(self.task["tips"])
        near, far = 0.0125 * tips, self.task["far_per_tip"] * tips
        return {
            "reach": -distance,
            "bonus": 1.0 * (distance < 2 * near) + 1.0 * (distance < near),
            "penalty": -1.0 * ((distance > far) & (self.time > 2.0 * self.control_dt)),
            "solved": distance < near,
        }

    def mend(self) -> NDArray[np.bool_]:
        """Which bodies moved too fast to be computed; they are put to rest, as MuJoCo does."""
        state = np.hstack([self.bodies.qpos, self.bodies.qvel])
        lost: NDArray[np.bool_] = np.any(~np.isfinite(state), axis=1)
        if lost.any():
            (envs,) = np.nonzero(lost)
            poses = np.tile(self.rest, (len(envs), 1))
            self.bodies.set(envs, poses, np.zeros_like(poses), np.zeros((len(envs), self.nmuscle)))
        return lost


def _reachable(bodies: Bodies, task: dict[str, Any], rest: NDArray[np.float64]) -> NDArray[np.float64]:
    """Where the tips are in poses of chance, of those in which they are within the box, `(n, tips, 3)`."""
    rng = np.random.default_rng(_POSES_SEED)
    poses = np.tile(rest, (_POSES, 1))
    for joint, (low, high) in enumerate(bodies.joint_ranges):
        if np.isfinite(low):
            poses[:, joint] = rng.uniform(low, high, _POSES)
    places = bodies.site_positions(task["tips"], poses)
    inside = np.all((places >= np.array(task["low"])) & (places <= np.array(task["high"])), axis=(1, 2))
    return places[inside]
