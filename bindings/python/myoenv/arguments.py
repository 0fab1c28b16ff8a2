"""What callers pass, made fit for the compiled half or refused in one sentence."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Mapping, Sequence
from numbers import Real
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv._native import ActionError

SEED_LIMIT = 2**64
# More than any machine has memory for: a slip of the keyboard should not end the process.
MOST_ENVS = 2**24
MOST_THREADS = 1024
# Least and greatest width or height of a picture.
PICTURE_SIZES = (16, 4096)


def as_actions(actions: Any, shape: tuple[int, ...]) -> NDArray[np.float32]:
    """Actions as a contiguous float32 array of `shape`, without a copy where they are one."""
    if type(actions) is not np.ndarray:
        try:
            actions = np.asarray(actions)
        except Exception as error:
            raise ActionError(f"actions cannot be made an array: {error}") from None
    if actions.shape != shape:
        raise ActionError(f"actions have the shape {actions.shape}, expected {shape}")
    if actions.dtype.kind != "f":
        raise ActionError(f"actions are of type {actions.dtype}, expected float32")
    with np.errstate(over="ignore"):
        # What is too large for float32 becomes infinite, and is refused as such.
        return np.ascontiguousarray(actions, dtype=np.float32)


def as_count(name: str, value: Any, most: int | None = None) -> int:
    """A whole number from 1 on."""
    number = as_integer(name, value)
    if number < 1:
        raise ValueError(f"{name} is {number}; it must be at least 1")
    if most is not None and number > most:
        raise ValueError(f"{name} is {number}; it must be at most {most}")
    return number


def as_num_envs(value: Any) -> int:
    """A number of environments."""
    return as_count("num_envs", value, MOST_ENVS)


def as_threads(value: Any) -> int | None:
    """A number of threads, or none for all processors."""
    return None if value is None else as_count("threads", value, MOST_THREADS)


def as_path(name: str, value: Any) -> str:
    """The path of a file or folder."""
    if not isinstance(value, (str, PathLike)) or not isinstance(os.fspath(value), str) or not os.fspath(value):
        raise TypeError(f"{name} is {value!r}; it must be a path")
    return os.fspath(value)


def as_mapping(name: str, value: Any) -> dict[str, Any]:
    """A new dictionary, of one with strings as keys; empty for None."""
    if value is not None and not isinstance(value, Mapping):
        raise TypeError(f"{name} is {value!r}; it must be a dictionary")
    for key in value or ():
        if not isinstance(key, str):
            raise TypeError(f"{name} has the key {key!r}; keys must be strings")
    return dict(value or {})


def as_number(name: str, value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} is {value!r}; it must be a number")
    if not math.isfinite(value):
        raise ValueError(f"{name} is {value}; it must be finite")
    return float(value)


def as_pair(name: str, value: Any) -> tuple[float, float]:
    """Two finite numbers."""
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise TypeError(f"{name} is {value!r}; it must be two numbers")
    return as_number(name, value[0]), as_number(name, value[1])


def as_weights(value: Any) -> dict[str, NDArray[np.float32]]:
    """Arrays of finite numbers by their names, float32 and contiguous."""
    weights = {}
    for name, array in as_mapping("weights", value).items():
        try:
            array = np.asarray(array)
        except Exception as error:
            raise ValueError(f"{name} cannot be made an array: {error}") from None
        if array.dtype.kind not in "fiu":
            raise TypeError(f"{name} is of type {array.dtype}; it must be numbers")
        with np.errstate(over="ignore"):
            weights[name] = np.array(array, np.float32, order="C")
        if not np.isfinite(weights[name]).all():
            raise ValueError(f"{name} has an entry that is not finite in float32")
    return weights


def as_text(name: str, value: Any) -> str:
    """A string."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}; it must be a string")
    return value


def as_device(device: Any) -> str | None:
    """A graphics card by its number or a part of its name, or none."""
    if isinstance(device, (int, np.integer)) and not isinstance(device, bool):
        return str(device)
    return None if device is None else as_text("device", device)


def as_index(name: str, value: Any, count: int) -> int:
    """A whole number from 0 to `count` - 1."""
    number = as_integer(name, value)
    if not 0 <= number < count:
        raise ValueError(f"{name} is {number}; it must be from 0 to {count - 1}")
    return number


def as_range(start: Any, stop: Any, count: int) -> tuple[int, int]:
    """The first of some environments and the one after the last; None for the end."""
    first = as_integer("start", start)
    end = count if stop is None else as_integer("stop", stop)
    if not 0 <= first <= end <= count:
        raise ValueError(
            f"environments {first} to {end} are asked for; start and stop must be from 0 to {count}, in order"
        )
    return first, end


def as_picture_size(value: Any) -> tuple[int, int]:
    """Width and height in pixels."""
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise TypeError(f"render_size is {value!r}; it must be width and height")
    width, height = (as_integer("render_size", one) for one in value)
    least, most = PICTURE_SIZES
    if not (least <= width <= most and least <= height <= most):
        raise ValueError(f"render_size is {width} x {height}; sizes are {least} to {most} pixels")
    return width, height


def as_integer(name: str, value: Any) -> int:
    """A whole number; booleans are refused."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}; it must be a whole number") from None


def as_share(name: str, value: Any) -> float:
    """A share above 0 and up to 1."""
    number = as_number(name, value)
    if not 0 < number <= 1:
        raise ValueError(f"{name} is {value}; it must be above 0 and at most 1")
    return number


def as_until(value: Any) -> str:
    """What a training is for: `"plateau"`, a share above 0 and up to 1, or None; as the compiled half reads it."""
    if value is None:
        return "off"
    if isinstance(value, str):
        if value != "plateau":
            raise ValueError(f'until is {value!r}; it must be "plateau", a share above 0 and at most 1, or None')
        return value
    return repr(as_share("until", value))


def as_seed(seed: Any) -> int:
    """A seed, from 0 to 2**64 - 1."""
    number = as_integer("seed", seed)
    if not 0 <= number < SEED_LIMIT:
        raise ValueError(f"seed is {number}; it must be from 0 to 2**64 - 1")
    return number


def fresh_seed() -> int:
    """A seed from the system's source of randomness."""
    return int.from_bytes(os.urandom(8), "little")


def spread_seeds(seed: int | Sequence[int | None], num_envs: int) -> list[int | None]:
    """One seed for each environment: `seed + i` for a number, as Gymnasium does."""
    if not isinstance(seed, str) and isinstance(seed, (Sequence, np.ndarray)):
        if len(seed) != num_envs:
            raise ValueError(f"there are {len(seed)} seeds for {num_envs} environments")
        return [None if one is None else as_seed(one) for one in seed]
    first = as_seed(seed)
    return [(first + i) % SEED_LIMIT for i in range(num_envs)]


def as_mask(mask: Any, num_envs: int) -> NDArray[np.bool_]:
    """A reset mask: boolean, one entry for each environment, at least one of them true."""
    if not isinstance(mask, np.ndarray):
        raise TypeError(f"reset_mask is a {type(mask).__name__}; it must be a NumPy array")
    if mask.dtype != np.bool_:
        raise TypeError(f"reset_mask is of type {mask.dtype}; it must be bool")
    if mask.shape != (num_envs,):
        raise ValueError(f"reset_mask has the shape {mask.shape}, expected {(num_envs,)}")
    if not mask.any():
        raise ValueError("reset_mask is false everywhere; it must name at least one environment")
    return np.ascontiguousarray(mask)
