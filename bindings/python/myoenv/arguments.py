"""What callers pass, made fit for the compiled half or refused in one sentence."""

from __future__ import annotations

import operator
import os
from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv._native import ActionError

SEED_LIMIT = 2**64


def as_actions(actions: Any, shape: tuple[int, int]) -> NDArray[np.float32]:
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


def as_count(name: str, value: Any) -> int:
    """A whole number from 1 on."""
    number = as_integer(name, value)
    if number < 1:
        raise ValueError(f"{name} is {number}; it must be at least 1")
    return number


def as_integer(name: str, value: Any) -> int:
    """A whole number; a boolean is none."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        return operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}; it must be a whole number") from None


def as_share(name: str, value: Any) -> float:
    """A share above 0 and up to 1."""
    if isinstance(value, bool) or not isinstance(value, Real):
        raise TypeError(f"{name} is {value!r}; it must be a number")
    if not 0 < value <= 1:
        raise ValueError(f"{name} is {value}; it must be above 0 and at most 1")
    return float(value)


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
    if isinstance(seed, (Sequence, np.ndarray)) and not isinstance(seed, str):
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
