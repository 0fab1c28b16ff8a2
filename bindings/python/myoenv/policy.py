"""Policies that the library trained."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from myoenv import _native
from myoenv._native import TrainingError
from myoenv.arguments import as_integer, as_path, as_weights

if TYPE_CHECKING:
    from myoenv.torch_policy import PolicyModule


class Policy:
    """A trained policy: `policy(observations)` is the mean action, in [-1, 1].

    >>> policy = Policy.load("runs/pointing-1")  # doctest: +SKIP
    >>> actions = policy(observations)  # doctest: +SKIP

    It can be copied and pickled, and goes to other programs and back: `weights` and `from_weights` (NumPy), `to_torch`
    and `from_torch` (PyTorch), `to_onnx` and `from_onnx` (ONNX).
    """

    def __init__(self, native: _native.Policy) -> None:
        if not isinstance(native, _native.Policy):
            raise TypeError(f"a policy is made by Policy.load or train, not of a {type(native).__name__}")
        self._native = native

    @classmethod
    def load(cls, path: str | PathLike[str], *, checkpoint: int | str | PathLike[str] | None = None) -> Policy:
        """The policy of a run folder's newest checkpoint that is whole, or of a checkpoint file.

        Args:
            path: A run folder or a checkpoint file.
            checkpoint: Another checkpoint of the run than the newest: the control steps after which it was written, or
                the path of its file.
        """
        path = as_path("path", path)
        return cls(_native.Policy.load(path if checkpoint is None else checkpoint_file(path, checkpoint)))

    @classmethod
    def from_weights(
        cls,
        weights: Mapping[str, Any],
        *,
        observation_names: Sequence[str],
        action_names: Sequence[str],
    ) -> Policy:
        """A policy of arrays such as `weights` returns; of any number of layers, of any widths that fit.

        Args:
            weights: The arrays, with the names, shapes and meaning that `weights` describes.
            observation_names: Names of the observations, in order, as of `MyoVectorEnv.observation_names`.
            action_names: Names of the actions, in order.
        """
        names = [
            _names(name, listed) for name, listed in zip(_NAME_LISTS, (observation_names, action_names), strict=True)
        ]
        return cls(_native.Policy.from_weights(as_weights(weights), *names))

    @classmethod
    def from_torch(cls, module: PolicyModule) -> Policy:
        """A policy of what `to_torch` returned, trained further or not."""
        from myoenv.torch_policy import PolicyModule

        if not isinstance(module, PolicyModule):
            raise TypeError(f"module is a {type(module).__name__}; it must be what Policy.to_torch returned")
        weights = {name: tensor.detach().cpu().numpy() for name, tensor in module.state_dict().items()}
        names = (module.observation_names, module.action_names)
        return cls.from_weights(weights, observation_names=names[0], action_names=names[1])

    @classmethod
    def from_onnx(cls, path: str | PathLike[str]) -> Policy:
        """A policy of a file that `to_onnx` wrote; its weights may have been changed, its structure not.

        Needs `pip install myoenv[onnx]`.
        """
        from myoenv.onnx_policy import read

        weights, observation_names, action_names = read(as_path("path", path))
        return cls.from_weights(weights, observation_names=observation_names, action_names=action_names)

    @property
    def observation_names(self) -> list[str]:
        """Names of the observations that it was trained on, in order."""
        return self._native.observation_names

    @property
    def action_names(self) -> list[str]:
        """Names of the actions, in order."""
        return self._native.action_names

    @property
    def weights(self) -> dict[str, NDArray[np.float32]]:
        """Everything that an action is computed from, as new float32 arrays.

        Observations are scaled first: `x = clip((observation - observation_mean) * observation_inverse_std,
        -observation_limit, observation_limit)`. Each layer but the last computes `x = silu(weight @ x + bias)`, with
        `silu(z) = z / (1 + exp(-z))`, and the last one `x = weight @ x + bias`. The action is
        `clip(action_offset + action_scale * x, -1, 1)`.

        Names and shapes: `observation_mean` and `observation_inverse_std` `(observation_size,)`, `observation_limit`
        `()`, `layers.0.weight` `(outputs, inputs)` and `layers.0.bias` `(outputs,)`, `layers.1.weight` and so on,
        `action_offset` and `action_scale` `()`. They are those of the `state_dict` of `to_torch`.
        """
        return self._native.weights()

    def to_torch(self) -> PolicyModule:
        """The policy as a `torch.nn.Module`, from observations to actions, both `(..., size)` float32.

        Actions are equal but for rounding. The layers are parameters, the scaling is buffers. Needs PyTorch.
        """
        from myoenv.torch_policy import PolicyModule

        return PolicyModule(self.weights, self.observation_names, self.action_names)

    def to_onnx(self, path: str | PathLike[str]) -> None:
        """Writes the policy as an ONNX file: `observation` `(batch, observation_size)` to `action` `(batch, nmuscle)`.

        Actions are equal but for rounding. Names of observations and actions are in the file's metadata, as JSON. Needs
        `pip install myoenv[onnx]`; to run it, `onnxruntime` or another runtime is enough.
        """
        from myoenv.onnx_policy import write

        write(self.weights, self.observation_names, self.action_names, as_path("path", path))

    def __call__(self, observation: Any) -> NDArray[np.float32]:
        """Mean actions `(..., nmuscle)` for observations `(..., observation_size)`."""
        try:
            observation = np.asarray(observation)
        except Exception as error:
            raise ValueError(f"the observation cannot be made an array: {error}") from None
        if observation.dtype.kind not in "fiu" or observation.ndim == 0:
            raise ValueError(
                f"an observation is an array of numbers, not of shape {observation.shape}, type {observation.dtype}"
            )
        *batch, width = observation.shape
        with np.errstate(over="ignore"):
            # What is too large for float32 becomes infinite, and is refused as such.
            rows = np.ascontiguousarray(observation, np.float32).reshape(math.prod(batch), width)
        if not np.isfinite(rows).all():
            raise ValueError("the observation has an entry that is not finite")
        return self._native.act(rows).reshape(*batch, len(self.action_names))

    def __reduce__(self) -> Any:
        return _unpickled, (type(self), self.weights, self.observation_names, self.action_names)


def checkpoint_file(run: str, checkpoint: Any) -> str:
    """The file of a run's checkpoint, by its control steps or its path."""
    if isinstance(checkpoint, (str, PathLike)):
        return as_path("checkpoint", checkpoint)
    steps = as_integer("checkpoint", checkpoint)
    numbered = {file.stem.removeprefix("step_"): file for file in Path(run).glob("checkpoints/step_*.ckpt")}
    files = {int(number): file for number, file in numbered.items() if number.isdecimal()}
    if steps in files:
        return str(files[steps])
    there = f"; there are {', '.join(map(str, sorted(files)))}" if files else ""
    raise TrainingError(f"{run} has no checkpoint after {steps} control steps{there}")


_NAME_LISTS = ("observation_names", "action_names")


def _names(what: str, names: Any) -> list[str]:
    if isinstance(names, str) or not isinstance(names, Sequence) or not all(isinstance(name, str) for name in names):
        raise TypeError(f"{what} is {names!r}; it must be a list of names")
    return list(names)


def _unpickled(cls: type[Policy], weights: Any, observation_names: list[str], action_names: list[str]) -> Policy:
    return cls.from_weights(weights, observation_names=observation_names, action_names=action_names)
