"""What a run folder says about itself."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from typing import Any

from myoenv import _native
from myoenv.arguments import as_path


@dataclass(frozen=True)
class RunDescription:
    """What was trained, on what, until when: what `config.json` says, which the compiled half writes and checks."""

    #: What the properties below are read from, with the keys of `config.json`.
    run: dict[str, Any]
    #: Seed of everything random.
    seed: int
    #: All settings of PPO.
    settings: dict[str, Any]

    @classmethod
    def from_json(cls, text: str) -> RunDescription:
        """The description in a `config.json`."""
        config = json.loads(text)
        return cls(config["run"], config["seed"], config["ppo"])

    @property
    def task(self) -> dict[str, Any]:
        """The task, with the keys of a task file; the first of several layouts."""
        task: dict[str, Any] = self.run["task"]
        return task

    @property
    def layouts(self) -> list[dict[str, Any]]:
        """All layouts that the user learns, one or more, with the keys of a task file."""
        others: list[dict[str, Any]] = self.run.get("other_layouts", [])
        return [self.task, *others]

    @property
    def model(self) -> dict[str, Any] | None:
        """The body, with the keys of a model file, unless it is the one that comes with the library under its name."""
        return self.run.get("model")

    @property
    def backend(self) -> str:
        """`cpu` or `gpu`: where it began; only there does it continue bit for bit."""
        return str(self.run["backend"])

    @property
    def device(self) -> str | None:
        """Name of the graphics card, if it was one."""
        return self.run.get("device")

    @property
    def until(self) -> float | str | None:
        """`"plateau"`, a share of fresh episodes in which the deterministic policy must succeed, or None."""
        return self.run.get("until")

    @property
    def steps(self) -> int:
        """Control steps after which to stop in any case."""
        return int(self.run["steps"])

    @property
    def start_from(self) -> str | None:
        """The run that a warm start began with, if any."""
        began: dict[str, Any] = self.run.get("from", {})
        return began.get("run")

    @property
    def inherited_env_steps(self) -> int | None:
        """Control steps of that run then."""
        began: dict[str, Any] = self.run.get("from", {})
        return began.get("env_steps")


def read_run(path: str | PathLike[str]) -> RunDescription:
    """Reads the description of a run folder."""
    return RunDescription.from_json(_native.run_config(as_path("run", path)))
