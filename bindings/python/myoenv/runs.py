"""What a run folder says about itself."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any

from myoenv import _native
from myoenv._native import TrainingError
from myoenv.arguments import as_path


@dataclass(frozen=True)
class RunDescription:
    """What was trained, on what, until when: `config.json`, as the command line writes and reads it, too."""

    #: The task, with the keys of a task file.
    task: dict[str, Any]
    #: Another body than the task's, with the keys of a model file.
    model: dict[str, Any] | None
    #: Seed of everything random.
    seed: int
    #: All settings of PPO.
    settings: dict[str, Any]
    #: `cpu` or `gpu`: where it began, and where alone it goes on to the bit.
    backend: str
    #: Name of the graphics card, if it was one.
    device: str | None
    #: Share of fresh episodes in which the deterministic policy must succeed, if any.
    until: float | None
    #: Control steps after which to stop in any case.
    steps: int
    #: The run that a warm start began with, if any, and its control steps then.
    start_from: str | None = None
    inherited_env_steps: int | None = None

    def to_dict(self) -> dict[str, Any]:
        """The caller's part of `config.json`: seed and settings have places of their own there."""
        began = {"run": self.start_from, "env_steps": self.inherited_env_steps}
        optional = {"device": self.device, "model": self.model, "from": None if self.start_from is None else began}
        return {
            "task": self.task,
            "backend": self.backend,
            **{key: value for key, value in optional.items() if value is not None},
            "version": _native.__version__,
            "until": self.until,
            "steps": self.steps,
        }


def read_run(path: str | PathLike[str]) -> RunDescription:
    """Reads the description of a run folder."""
    folder = as_path("run", path)
    config = json.loads(_native.run_config(folder))
    run = config["run"]
    try:
        return RunDescription(
            task=run["task"],
            model=run.get("model"),
            seed=config["seed"],
            settings=config["ppo"],
            backend=run["backend"],
            device=run.get("device"),
            until=run["until"],
            steps=run["steps"],
            start_from=run.get("from", {}).get("run"),
            inherited_env_steps=run.get("from", {}).get("env_steps"),
        )
    except (TypeError, AttributeError, KeyError) as error:
        raise TrainingError(f"{folder}/config.json does not say what was trained: {error}") from None
