"""Writes the module `myoenv.scene` from the JSON Schema of task files, so that no word of it stands in two places.

`MYO_BLESS=1 python -m pytest bindings/tests/test_scene.py` writes it anew.
"""

import json
import keyword
import re
import textwrap
from pathlib import Path
from typing import Any, NamedTuple

MODULE = Path(__file__).parents[1] / "python/myoenv/scene.py"
WIDTH = 120

HEAD = '''"""Tasks built from objects: what stands in a scene, what a script asks for, what points, and all settings.

>>> from myoenv import build_task, scene as s
>>> task = build_task(
...     "volume",
...     scene={"volume": s.Slider(at=(0.42, 0.05, -0.15), tilt_deg=45, length=0.1, range=(0, 100))},
...     script=[s.Drag("volume", to=70, within=5)],
...     time_limit_s=6,
... )

Fields are the keys of a task file; `in` and `from`, which Python keeps for itself, are `in_` and `from_`. Fields that
are left out, or None, have the defaults of the format. Vectors and ranges are tuples, lists or arrays. Whether values
fit is told when the task is built. Every object has `to_dict()`.

Lengths are metres from the shoulder centre (x forward, y to the left, z up), times seconds, forces newtons, angles
degrees unless it is said otherwise.
"""

# Made from the JSON Schema of task files by `MYO_BLESS=1 python -m pytest bindings/tests/test_scene.py`.

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar, Literal, TypeAlias

from myoenv._native import Task
from myoenv.described import (
    Array,
    Described,
    Instruction,
    Name,
    Names,
    NumberOrRange,
    OfKind,
    OfNames,
    Pair,
    Triple,
)
from myoenv.tasks import load_task
'''

# The parts of a task in the order of an explanation. Of version 2: `version` is written, and `targets` are left out.
TASK_FIELDS = [
    "name",
    "scene",
    "script",
    "technique",
    "stimulus",
    "correction",
    "time_limit_s",
    "step_limit_s",
    "user",
    "body",
    "reward",
    "observation",
    "reset",
    "perception",
    "noise",
    "reflex",
    "fatigue",
    "control_dt_s",
    "control",
    "model",
    "description",
]

# Parts that are classes of fields and nothing else.
PLAIN_PARTS = ("Body", "Reward", "Observation", "Reset", "Perception", "Noise", "Reflex", "Fatigue")

# Where it makes a difference that there is no file.
IN_PYTHON = [
    ("looked for in the folder of the task file", "looked for in the working directory"),
    ("`{thumb: left}`", '`{"thumb": "left"}`'),
    ("Which parts the observation has, in this order;", "Which parts the observation has;"),
]

# Types of definitions that are no classes, and classes of those that have several.
ALIASES = {"Place": "Place", "User": "User", "Names": "Names", "Pitch": "float | Pair", "Scene": "Mapping[str, Object]"}
BASES = {"Item": "Object", "Instruction": "Step", "Motion": "Motion", "Technique": "Technique"}


def camel(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_"))


def field_name(key: str) -> str:
    return f"{key}_" if keyword.iskeyword(key) else key


def number(value: float) -> str:
    return f"{int(value):,}" if value == int(value) else f"{value:g}"


NAMES = {"$ref": "#/$defs/Names"}


class Asked(NamedTuple):
    """A step of the format."""

    told: str
    fields: dict[str, Any]
    required: list[str]
    # Whether the first field may stand for all.
    short: bool


class Writer:
    """Writes the module from a schema."""

    def __init__(self, schema: dict[str, Any]):
        self.task = schema
        self.parts = schema["$defs"]
        self.steps = {}
        for step in self.parts["Instruction"]["oneOf"]:
            [(action, of)] = step["properties"].items()
            self.steps[action] = Asked(step["description"], *self.asked(of))
        self.names: list[str] = []

    def asked(self, of: dict[str, Any]) -> tuple[dict[str, Any], list[str], bool]:
        """What a step asks for: its fields, those that must be given, and whether the first may stand for all."""
        if of == NAMES:
            return {"names": {**of, "description": "Names of the objects, in this order."}}, ["names"], True
        if of.get("items", {}).get("$ref", "").endswith("/Instruction"):
            return {"steps": {**of, "description": "The steps."}}, ["steps"], True
        part = self.resolve(of)
        if "additionalProperties" in part and "properties" not in part:
            return {"fingers": {**of, "description": "Name of a button by each finger."}}, ["fingers"], True
        long = next((one for one in map(self.resolve, [part, *part.get("anyOf", [])]) if "properties" in one), None)
        if long is None:
            return {"for_s": {**of, "description": "How long, in s, a number or `[min, max]`."}}, ["for_s"], True
        fields = in_order(long)
        return fields, long["required"], long is not part

    # Words

    def words(self, text: str) -> str:
        """A description in Python's words: `True`, tuples, keywords and calls in place of YAML."""
        text = re.sub(r"`(\w+): ((?:\{[^`]*\}|\[[^`]*\]|[^`{\[]+))`", self.in_python, text)
        text = re.sub(r"`\[([^`\]]*)\]`", r"`(\1)`", text)
        text = re.sub(r"(`|[Dd]efault )(true|false)\b", lambda found: found[1] + found[2].capitalize(), text)
        for old, new in IN_PYTHON:
            text = text.replace(old, new)
        return text

    def in_python(self, found: re.Match[str]) -> str:
        """`dwell: {in: slot, for_s: 0.3}` as `Dwell("slot", for_s=0.3)`, `copies: 3` as `copies=3`."""
        key, yaml = found.groups()
        text = re.sub(r"[A-Za-z_]+", lambda word: json.dumps(word[0]), yaml.replace("[...]", "etc"))
        value = json.loads(text.replace('"true"', "true").replace('"false"', "false"))
        return f"`{self.call(key, value)}`"

    def call(self, key: str, value: Any) -> str:
        """A step as the call of its class, any other field as a keyword."""
        if key not in self.steps:
            return f"{field_name(key)}={self.literal(value)}"
        fields = self.steps[key].fields
        if next(iter(fields)) == "steps":
            return f"{camel(key)}([{', '.join(map(self.literal, value))}])"
        if next(iter(fields)) == "fingers":
            return f"{camel(key)}({json.dumps(value)})"
        if not isinstance(value, dict):
            arguments = value if isinstance(value, list) else [value]
            return f"{camel(key)}({', '.join(map(self.literal, arguments))})"
        named = [
            self.literal(value[name]) if k == 0 else f"{field_name(name)}={self.literal(value[name])}"
            for k, name in enumerate(fields)
            if name in value
        ]
        return f"{camel(key)}({', '.join(named)})"

    def literal(self, value: Any) -> str:
        if value == "etc":
            return "[...]"
        if isinstance(value, dict):
            return ", ".join(self.call(key, inner) for key, inner in value.items())
        if isinstance(value, list):
            return f"({', '.join(map(self.literal, value))})"
        return json.dumps(value) if isinstance(value, str) else repr(value)

    def explain(self, schema: dict[str, Any]) -> str:
        """What a field means, with its choices and, where they are not told yet, its bounds."""
        told = schema.get("description", "")
        kind = self.resolve(schema)
        choices = [one for one in kind.get("oneOf", []) if "const" in one and one.get("type") == "string"]
        if choices and len(choices) == len(kind["oneOf"]):
            missing = [one for one in choices if f"`{one['const']}`, " not in told]
            told += "".join(f" `{one['const']}`: {one['description']}" for one in missing)
        bounds = self.bounds(schema)
        if bounds and bounds[0].replace(",", "") not in told.replace(",", ""):
            each = "Each from" if bounds[2] else "From"
            told += f" {each} {bounds[0]}{' ' + bounds[1] if bounds[1] else ''}."
        return self.words(told.strip())

    def bounds(self, schema: dict[str, Any]) -> tuple[str, str, bool] | None:
        """Least and greatest value, unit, and whether there are several."""
        if "minimum" in schema:
            return f"{number(schema['minimum'])} to {number(schema['maximum'])}", schema.get("x-unit", ""), False
        if "items" in schema and (found := self.bounds(schema["items"])):
            return found[0], found[1], True
        for one in schema.get("anyOf", []):
            if found := self.bounds(one):
                return found
        if schema.get("$ref", "").endswith(("/Place", "/Pitch")):
            return self.bounds(self.resolve(schema))
        return None

    # Types

    def resolve(self, schema: dict[str, Any]) -> dict[str, Any]:
        return self.parts[schema["$ref"].rsplit("/", 1)[1]] if "$ref" in schema else schema

    def type_of(self, schema: dict[str, Any]) -> str:
        """The type of a value in Python, None aside."""
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[1]
            if name in ALIASES or name in BASES:
                return ALIASES.get(name) or BASES[name]
            choices = self.parts[name].get("oneOf")
            return f"Literal[{', '.join(json.dumps(one['const']) for one in choices)}]" if choices else name
        if "anyOf" in schema:
            types = [self.type_of(one) for one in schema["anyOf"] if one.get("type") != "null"]
            types = ["NumberOrRange"] if types == ["float", "Pair"] else types
            return "Name" if types == ["str", "int"] else " | ".join(types)
        kind = schema["type"]
        if isinstance(kind, list):
            [kind] = set(kind) - {"null"}
        if kind == "array":
            if schema["items"].get("type") == "number":
                return {2: "Pair", 3: "Triple"}[schema["maxItems"]]
            several = f"Sequence[{self.type_of(schema['items'])}]"
            return f"{several} | Array" if several == "Sequence[NumberOrRange]" else several
        if kind == "object":
            return f"Mapping[str, {self.type_of(schema['additionalProperties'])}]"
        return {"number": "float", "integer": "int", "string": "str", "boolean": "bool"}[kind]

    # Classes

    def class_of(
        self, name: str, base: str, told: str, fields: dict[str, Any], required: list[str], *, constant="", first=False
    ) -> str:
        """A dataclass; `first`: its first field may be given without its name."""
        self.names.append(name)
        told = docstring(self.words(told), [(field_name(key), self.explain(of)) for key, of in fields.items()])
        body = ["", *([constant] if constant else [])]
        for k, (key, of) in enumerate(fields.items()):
            kind = self.type_of(of)
            body.append(f"{field_name(key)}: {kind}" if key in required else f"{field_name(key)}: {kind} | None = None")
            if first and k == 0 and len(fields) > 1:
                body.append("_: KW_ONLY")
        options = "frozen=True, repr=False" if first else "frozen=True, kw_only=True, repr=False"
        return f"@dataclass({options})\nclass {name}({base}):\n{indented(told, *body)}\n"

    def kinds(self, part: str, ending: str = "") -> list[str]:
        """The classes of a part that has kinds, behind what they have in common."""
        base = BASES[part]
        classes = [self.base(base, "OfKind", self.parts[part]["description"])]
        for of in self.parts[part]["oneOf"]:
            if "properties" in of:
                fields = in_order(of)
                kind = fields.pop("kind")["const"]
                constant = f'kind: ClassVar[str] = "{kind}"'
                name = camel(kind) + ending
                classes.append(self.class_of(name, base, of["description"], fields, of["required"], constant=constant))
        return classes

    def base(self, name: str, of: str, told: str) -> str:
        self.names.append(name)
        return f"class {name}({of}):\n{indented(docstring(self.words(told), []))}\n"

    def step(self, action: str) -> str:
        told, fields, required, short = self.steps[action]
        constant = f'action: ClassVar[str] = "{action}"'
        if "names" in fields:
            self.names.append(camel(action))
            doc = docstring(self.words(told), [("names", self.explain(fields["names"]))])
            return f"class {camel(action)}(OfNames, Step):\n{indented(doc, '', constant)}\n"
        if short:
            constant += "\nhas_short_form: ClassVar[bool] = True"
        return self.class_of(camel(action), "Step", told, fields, required, constant=constant, first=True)

    def user(self) -> str:
        names = "".join(f"    {json.dumps(one['const'])},\n" for one in self.parts["User"]["oneOf"])
        return f"# Who does a task.\nUser: TypeAlias = Literal[\n{names}]\n"

    def plain_part(self, name: str) -> str:
        part = self.parts[name]
        return self.class_of(name, "Described", part["description"], in_order(part), part.get("required", []))

    def build_task(self) -> str:
        fields = self.task["properties"]
        assert set(fields) == {*TASK_FIELDS, "version", "targets"}, "a new part of a task needs its place"
        self.names.append("build_task")
        lines = ["name: str,", "*,"]
        for key in TASK_FIELDS[1:]:
            kind = self.type_of(fields[key])
            kind += ' | Literal["fingertip"]' if key == "technique" else ""
            lines.append(f"{key}: {kind}," if key in ("scene", "script") else f"{key}: {kind} | None = None,")
        told = "A task of a scene, a script and settings, for `make_vec`, `train` and whatever else takes a task."
        raises = "Raises:\n    TaskError: A value does not fit; the sentence names it, such as `scene.panel.of.size`."
        doc = docstring(told, [(key, self.explain(fields[key])) for key in TASK_FIELDS])
        doc = doc.removesuffix('"""') + f'\n{raises}\n"""'
        given = [f'"{key}": {key},' for key in TASK_FIELDS]
        body = [
            doc,
            "task: dict[str, Any] = {",
            '    "version": 2,',
            *(f"    {line}" for line in given),
            "}",
            'needed = ("name", "scene", "script")',
            "return load_task({key: value for key, value in task.items() if key in needed or value is not None})",
        ]
        head = "\n".join(f"    {line}" for line in lines)
        return f"def build_task(\n{head}\n) -> Task:\n{indented(*body)}\n"

    def module(self) -> str:
        parts = [
            self.plain_part("Region"),
            "# Three numbers or ranges.\nPlace: TypeAlias = Sequence[NumberOrRange] | Array | Region\n",
            self.user(),
            self.plain_part("Wave"),
            *self.kinds("Motion", "Motion"),
            *self.kinds("Item"),
            self.base("Step", "Instruction", self.parts["Instruction"]["description"]),
            *(self.step(action) for action in self.steps),
            *self.kinds("Technique"),
            *(self.plain_part(name) for name in PLAIN_PARTS),
            self.build_task(),
        ]
        listed = "".join(f'    "{name}",\n' for name in sorted([*self.names, "Place", "User"]))
        return f"{HEAD}\n__all__ = [\n{listed}]\n\n\n" + "\n\n".join(parts)


def in_order(of: dict[str, Any]) -> dict[str, Any]:
    """The fields of an object, those that must be given first."""
    required = of.get("required", [])
    return {key: of["properties"][key] for key in [*required, *(k for k in of["properties"] if k not in required)]}


def indented(*lines: str) -> str:
    return textwrap.indent("\n".join(lines).rstrip(), "    ")


def docstring(told: str, fields: list[tuple[str, str]]) -> str:
    """A docstring, before it is indented by four."""
    width = WIDTH - 4
    paragraphs = [textwrap.wrap(paragraph, width) for paragraph in f'"""{told}'.split("\n\n")]
    lines = [line for paragraph in paragraphs for line in [*paragraph, ""]][:-1]
    if not fields:
        return "\n".join(lines) + '"""'
    lines += ["", "Args:"]
    for name, explained in fields:
        lines += textwrap.wrap(f"{name}: {explained}", width, initial_indent="    ", subsequent_indent=" " * 8)
    return "\n".join([*lines, '"""'])


def scene_source(schema: dict[str, Any]) -> str:
    """The text of `myoenv/scene.py`."""
    return Writer(schema).module()
