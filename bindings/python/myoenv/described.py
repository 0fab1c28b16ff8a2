"""What the parts of a task in `myoenv.scene` have in common."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.floating[Any]] | NDArray[np.integer[Any]]
# Two numbers.
Pair: TypeAlias = Sequence[float] | Array
# Three numbers.
Triple: TypeAlias = Sequence[float] | Array
NumberOrRange: TypeAlias = float | Pair
# Objects are called by text; keys and places of a grid may be numbers.
Name: TypeAlias = str | int
Names: TypeAlias = Name | Sequence[Name]


@dataclass(frozen=True)
class Described:
    """A part of a task file. What is left out, or None, is not written, so that it has the default of the format."""

    def given(self) -> Iterator[tuple[str, Any]]:
        """The fields that a file would have, by their names in Python."""
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None or field.default is MISSING:
                yield field.name, value

    def to_dict(self) -> dict[str, Any]:
        """The part as a dictionary, with the keys of a task file."""
        # `in` and `from`, which Python keeps for itself, have an underscore behind them.
        return {name.removesuffix("_"): plain(value) for name, value in self.given()}

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.given())})"


@dataclass(frozen=True, repr=False)
class OfKind(Described):
    """A part whose kind stands in the key `kind`."""

    kind: ClassVar[str]

    def to_dict(self) -> dict[str, Any]:
        """The part as a dictionary, with the keys of a task file."""
        return {"kind": self.kind, **super().to_dict()}


@dataclass(frozen=True, repr=False)
class Instruction(Described):
    """A step of a script: its action as the only key."""

    action: ClassVar[str]
    # Whether the first field may stand for all.
    has_short_form: ClassVar[bool] = False

    def to_dict(self) -> dict[str, Any]:
        """The step as a dictionary, with the keys of a task file."""
        asked = super().to_dict()
        if self.has_short_form and len(asked) == 1:
            [asked] = asked.values()
        return {self.action: asked}


@dataclass(frozen=True, init=False, repr=False)
class OfNames(Instruction):
    """A step that asks for nothing but objects."""

    names: tuple[Names, ...]

    def __init__(self, *names: Names) -> None:
        object.__setattr__(self, "names", names)

    def to_dict(self) -> dict[str, Any]:
        """The step as a dictionary, with the keys of a task file."""
        return {self.action: plain(self.names[0] if len(self.names) == 1 else self.names)}

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(map(repr, self.names))})"


def plain(value: Any) -> Any:
    """Parts of tasks as dictionaries, NumPy's numbers and arrays as Python's, wherever they stand."""
    if isinstance(value, Described):
        return value.to_dict()
    if isinstance(value, Mapping):
        return {key: plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return value.tolist() if hasattr(value, "tolist") else value
