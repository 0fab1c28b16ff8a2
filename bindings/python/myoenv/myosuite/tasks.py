"""What MyoSuite's environments ask: data that `bindings/tests/myosuite_data.py` read out of them."""

from __future__ import annotations

import difflib
import json
from functools import cache
from importlib import resources
from typing import Any

from gymnasium.envs.registration import register, registry

from myoenv._native import Model

_DATA = resources.files(__name__.rpartition(".")[0])


@cache
def _data() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(_DATA.joinpath("tasks.json").read_text(encoding="utf-8"))
    return data


def ids() -> list[str]:
    """Names of all environments, as MyoSuite has them."""
    return list(_data()["tasks"])


#: Versions from which tasks and bodies are: of `myosuite`, of its models `myo-sim`, and of MuJoCo.
SUITE: dict[str, str] = _data()["from"]


def task(env_id: str) -> dict[str, Any]:
    """What one of them asks.

    Raises:
        ValueError: There is none of this name.
    """
    tasks: dict[str, dict[str, Any]] = _data()["tasks"]
    if not isinstance(env_id, str) or env_id not in tasks:
        near = difflib.get_close_matches(str(env_id), tasks, n=2)
        hint = f"did you mean {' or '.join(near)}?" if near else "see myoenv.myosuite.ids()"
        raise ValueError(f"there is no environment {env_id!r} of MyoSuite here; {hint}")
    return tasks[env_id]


@cache
def load_body(name: str) -> Model:
    """A body of MyoSuite: `myoelbow`, `myofinger`, `myohand` or `myoarm` (which has no fingers)."""
    known = sorted({one["body"] for one in _data()["tasks"].values()})
    if name not in known:
        raise ValueError(f"there is no body {name!r} of MyoSuite here; there are {', '.join(known)}")
    return Model.from_yaml(_DATA.joinpath(f"{name}.yaml").read_text(encoding="utf-8"), name)


def register_envs() -> None:
    """Registers all of them with Gymnasium, as `myosuite/myoHandPoseRandom-v0`; importing `myoenv` calls it."""
    for env_id, one in _data()["tasks"].items():
        if f"myosuite/{env_id}" not in registry:
            register(
                id=f"myosuite/{env_id}",
                entry_point="myoenv.myosuite.envs:MyoSuiteEnv",
                vector_entry_point="myoenv.myosuite.envs:MyoSuiteVectorEnv",
                max_episode_steps=one["max_episode_steps"],
                kwargs={"env_id": env_id},
            )
