"""Tasks built from objects: what stands in a scene, what a script asks for, what points, and all settings.

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

__all__ = [
    "AnyOrder",
    "Arc",
    "Body",
    "Button",
    "Circle",
    "CircleMotion",
    "Cursor",
    "Drag",
    "Drive",
    "DrivenMotion",
    "Dwell",
    "Fatigue",
    "Fingertip",
    "Follow",
    "GoGo",
    "Grid",
    "Group",
    "Keyboard",
    "LineMotion",
    "Motion",
    "Noise",
    "Object",
    "Observation",
    "Obstacle",
    "Perception",
    "Pinch",
    "Place",
    "Press",
    "PressAndRelease",
    "PressWith",
    "RandomMotion",
    "RandomOrder",
    "RateCursor",
    "Ray",
    "React",
    "Reflex",
    "Region",
    "Repeat",
    "Reset",
    "Reward",
    "SinesMotion",
    "Slider",
    "Sphere",
    "Steer",
    "Step",
    "Stick",
    "Swing",
    "Technique",
    "Track",
    "Type",
    "User",
    "Wait",
    "Wave",
    "WavesMotion",
    "build_task",
]


@dataclass(frozen=True, kw_only=True, repr=False)
class Region(Described):
    """An axis-parallel box of positions, in m relative to the shoulder centre. Each axis is a number or `(min, max)`.

    Args:
        x: Forward, away from the chest, in m. From -2 to 2 m.
        y: To the user's left, in m; negative is right of the right shoulder. From -2 to 2 m.
        z: Up, in m. From -2 to 2 m.
    """

    x: NumberOrRange
    y: NumberOrRange
    z: NumberOrRange


# Three numbers or ranges.
Place: TypeAlias = Sequence[NumberOrRange] | Array | Region


# Who does a task.
User: TypeAlias = Literal[
    "human",
    "fastest",
    "woman",
    "man",
    "small_woman",
    "large_man",
    "older_woman",
    "older_man",
    "sarcopenia",
    "rotator_cuff_tear",
    "tendon_transfer",
    "left_handed",
    "tired",
]


@dataclass(frozen=True, kw_only=True, repr=False)
class Wave(Described):
    """A sine wave.

    Args:
        by: How far it goes from the middle to either side, `(x, y, z)` in m. Each from -2 to 2 m.
        period_s: Time of one wave, in s. From 0.2 to 600.
    """

    by: Triple
    period_s: float


class Motion(OfKind):
    """How a sphere moves about its place. Every episode begins somewhere else on the path."""


@dataclass(frozen=True, kw_only=True, repr=False)
class CircleMotion(Motion):
    """Round and round.

    Args:
        diameter: Diameter of the circle, in m. From 0.001 to 2 m.
        period_s: Time of one round, in s. From 0.2 to 600.
        tilt_deg: How the circle is tilted, in degrees: 0 lies like a table; 90, the default, stands like a wall before
            the user. From 0 to 180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
    """

    kind: ClassVar[str] = "circle"
    diameter: float
    period_s: float
    tilt_deg: float | None = None
    turn_deg: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class LineMotion(Motion):
    """Back and forth, like a pendulum.

    Args:
        by: From one end to the other, `(x, y, z)` in m. Each from -2 to 2 m.
        period_s: Time of one way there and back, in s. From 0.2 to 600.
    """

    kind: ClassVar[str] = "line"
    by: Triple
    period_s: float


@dataclass(frozen=True, kw_only=True, repr=False)
class WavesMotion(Motion):
    """Up to four sine waves, added up.

    Args:
        waves: The waves, 1 to 4; each begins anywhere in its period.
    """

    kind: ClassVar[str] = "waves"
    waves: Sequence[Wave]


@dataclass(frozen=True, kw_only=True, repr=False)
class RandomMotion(Motion):
    """A path that does not repeat and cannot be foreseen for long.

    Args:
        by: How far it may go from its place to either side, `(x, y, z)` in m. Each from -2 to 2 m.
        period_s: Period of the fastest of its waves, in s; the slowest takes 2.7 times as long. From 0.2 to 600.
    """

    kind: ClassVar[str] = "random"
    by: Triple
    period_s: float


@dataclass(frozen=True, kw_only=True, repr=False)
class SinesMotion(Motion):
    """Sine waves that are drawn anew for every episode, slow ones and fast ones.

    Args:
        by: How far it may go from its place to either side, `(x, y, z)` in m. Each from -2 to 2 m.
        up_to_hz: Greatest frequency of its waves, in Hz. From 0.001 to 5.
    """

    kind: ClassVar[str] = "sines"
    by: Triple
    up_to_hz: float


@dataclass(frozen=True, kw_only=True, repr=False)
class DrivenMotion(Motion):
    """As a stick drives it, like a car on rails.

    Args:
        by: How far it may go from its place to either side, `(x, y, z)` in m; this way where the angle of the stick
            rises. Each from -100 to 100 m.
        acceleration: Its acceleration where the stick is as far from 0 as it goes, in m/s^2; less in proportion where
            it is not. Default 2. From 0.01 to 1,000 m/s^2.
        drag_per_s: The share of its speed that it would lose in a second, per s, so that `acceleration / drag_per_s` is
            its greatest speed in m/s. Default 1. From 0 to 100 per s.
    """

    kind: ClassVar[str] = "driven"
    by: Triple
    acceleration: float | None = None
    drag_per_s: float | None = None


class Object(OfKind):
    """One or several objects. Places are in m from the shoulder centre (x forward, y to the left, z up), or, in a
    group, along the group's own axes."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Sphere(Object):
    """A sphere in the air, or several alike.

    Args:
        radius: Radius in m, a number or `(min, max)`; drawn anew for every episode. From 0.001 to 2.
        at: Where the centre may lie, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode.
            Each from -2 to 2 m.
        copies: So many spheres like this, each drawn for itself: with `copies=3`, `ball` becomes `ball.1`, `ball.2` and
            `ball.3`. From 1 to 256.
        moves: How it moves about its place. Without it: not at all.
        min_distance_from_previous: Least distance in m between this centre and that of the object before it in the
            scene, obstacles aside; positions are redrawn until it holds; that of a stick is its hinge. Without it:
            twice the greatest radius. 0 switches the rule off. From 0 to 4 m.
    """

    kind: ClassVar[str] = "sphere"
    radius: NumberOrRange
    at: Place | None = None
    copies: int | None = None
    moves: Motion | None = None
    min_distance_from_previous: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Button(Object):
    """A box that can be pressed.

    Args:
        size: Full sizes `(width, height, depth)` in m: of the upright face, width is the horizontal and height the
            vertical extent; depth is how thick the button is. Each a number or `(min, max)`, drawn anew for every
            episode, from 0.001 to 2.
        at: Centre of the box, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each from
            -2 to 2 m.
        tilt_deg: Where the face looks, in degrees: 0 up, like a key on a table; 90 towards the user, like a wall.
            Default 0. From 0 to 180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
        min_force_n: Contact force that counts as pressed, in N. From 0.01 to 1000; 1, the default, is a light touch.
    """

    kind: ClassVar[str] = "button"
    size: Sequence[NumberOrRange] | Array
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None
    min_force_n: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Slider(Object):
    """A handle that is dragged along a way.

    Args:
        length: How far the handle can be moved, in m. From 0.001 to 2 m.
        at: The middle of the way, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each
            from -2 to 2 m.
        handle: Length of the handle along the way, in m. Default 0.02. From 0.001 to 2 m.
        width: How wide the way and its handle are, in m. Default 0.02. From 0.001 to 2 m.
        depth: How thick it is, in m. Default 0.005. From 0.001 to 2 m.
        rises: Which way the value rises. Default `right`. `right`: Across the face, to the user's right. `up`: Up the
            face.
        range: Values at both ends of the way, the smaller one first. Default `(0, 1)`.
        value: Where the handle stands when an episode begins: a value, or `(min, max)`, drawn anew for every episode.
            Without it: at the smaller end. From -1,000,000 to 1,000,000.
        tilt_deg: Where it looks, in degrees: 0 up, like a table; 90 towards the user, like a wall. Default 0. From 0 to
            180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
        min_force_n: Contact force that takes hold of the handle, in N. From 0.01 to 1000; 0.2, the default, is less
            than a touch that is felt.
    """

    kind: ClassVar[str] = "slider"
    length: float
    at: Place | None = None
    handle: float | None = None
    width: float | None = None
    depth: float | None = None
    rises: Literal["right", "up"] | None = None
    range: Pair | None = None
    value: NumberOrRange | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None
    min_force_n: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Stick(Object):
    """A stick on a hinge, whose knob is swung.

    Args:
        length: From the hinge to the middle of the knob, in m. From 0.001 to 2 m.
        at: Where its hinge is, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each from
            -2 to 2 m.
        knob: Radius of the knob, in m; less than the length. Default 0.02. From 0.001 to 2 m.
        swings: Which way its angle rises. Default `right`. `right`: Across the face, to the user's right. `up`: Up the
            face.
        range_deg: How far it swings, in degrees, the smaller angle first: at 0 it stands straight out of what it stands
            on. Default `(-45, 45)`.
        angle_deg: How it stands when an episode begins, in degrees: a number, or `(min, max)`, drawn anew for every
            episode. Without it: at the smaller end, or at 0 where it springs back. From -180 to 180 deg.
        springs_back_s: Of a stick that goes back to 0 by a spring when it is left: how long it takes for two thirds of
            the way, in s. Without it, it stays where it is left. From 0.01 to 10 s.
        tilt_deg: Where what it stands on looks, in degrees: 0 up, like a table; 90 towards the user, like a wall.
            Default 0. From 0 to 180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
    """

    kind: ClassVar[str] = "stick"
    length: float
    at: Place | None = None
    knob: float | None = None
    swings: Literal["right", "up"] | None = None
    range_deg: Pair | None = None
    angle_deg: NumberOrRange | None = None
    springs_back_s: float | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Obstacle(Object):
    """A box that only stands in the way: a table, the edge of a display.

    Args:
        size: Full sizes `(width, height, depth)` in m, each a number or `(min, max)`, as of a button. Each from 0.001
            to 2 m.
        at: Centre of the box, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each from
            -2 to 2 m.
        tilt_deg: Where its face looks, as of a button. Default 0. From 0 to 180 deg.
        turn_deg: Turned about the vertical, as of a button. Default 0. From -180 to 180 deg.
    """

    kind: ClassVar[str] = "obstacle"
    size: Sequence[NumberOrRange] | Array
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Group(Object):
    """Objects that are moved, turned and scaled as one.

    Args:
        objects: What belongs to it.
        at: Where its origin lies, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode, and
            all that belongs to it moves along. Default: at the origin of what is around it. Each from -2 to 2 m.
        tilt_deg: How it is tilted, in degrees: at 0 its own axes are those around it; at 90 its x points up, and its z
            to the user. From 0 to 180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
        scale: Factor for all lengths in it. Default 1. From 0.01 to 100.
    """

    kind: ClassVar[str] = "group"
    objects: Mapping[str, Object]
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None
    scale: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Grid(Object):
    """Rows and columns of one object.

    Args:
        rows: How many rows. From 1 to 256.
        columns: How many columns. From 1 to 256.
        pitch: Distance from one middle to the next, in m; of rows and columns alike, or `(across, down)`. From 0.001 to
            2 m.
        of: What stands at each place; its own `at` is added.
        at: Its middle, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each from -2 to 2
            m.
        tilt_deg: How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user. From 0 to
            180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
        names: What each is called, row by row. Without it: 1, 2, 3 and so on.
    """

    kind: ClassVar[str] = "grid"
    rows: int
    columns: int
    pitch: float | Pair
    of: Object
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None
    names: Sequence[Name] | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Arc(Object):
    """One object again and again on a part of a circle.

    Args:
        count: How many objects. From 1 to 256.
        radius: From the middle of the circle to theirs, in m. From 0.001 to 2 m.
        of: What stands at each place; its own `at` is added.
        at: Middle of the circle, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each
            from -2 to 2 m.
        tilt_deg: How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user. From 0 to
            180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
        from_deg: Where the first stands, in degrees: 0 up the face (of a table: straight ahead), 90 to the right.
            Default -45. From -180 to 180 deg.
        to_deg: Where the last stands, in degrees. Default 45. From -180 to 180 deg.
        names: What each is called, from the first to the last. Without it: 1, 2, 3 and so on.
    """

    kind: ClassVar[str] = "arc"
    count: int
    radius: float
    of: Object
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None
    from_deg: float | None = None
    to_deg: float | None = None
    names: Sequence[Name] | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Circle(Object):
    """One object again and again on a circle, numbered across it (ISO 9241-9).

    Args:
        count: How many objects; an odd number, so that every way is as long as the others. From 3 to 255.
        diameter: Diameter of the circle through their middles, in m. From 0.001 to 2 m.
        of: What stands at each place; its own `at` is added.
        at: Its middle, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each from -2 to 2
            m.
        tilt_deg: How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user. From 0 to
            180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
    """

    kind: ClassVar[str] = "circle"
    count: int
    diameter: float
    of: Object
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Keyboard(Object):
    """The keys of a keyboard.

    Args:
        pitch: Distance from the middle of one key to that of the next, in m. From 0.001 to 2 m.
        key: Width and height of a key, in m, a number or `(min, max)`, drawn for all keys anew for every episode; the
            space bar is four pitches and a key wide. From 0.001 to 2 m.
        at: Its middle, `(x, y, z)` in m, each a number or `(min, max)`; drawn anew for every episode. Each from -2 to 2
            m.
        tilt_deg: How it is tilted, in degrees: 0 lies like a table, 90 stands like a wall before the user. From 0 to
            180 deg.
        turn_deg: Turned about the vertical, in degrees, to the left as seen from above. Default 0. From -180 to 180
            deg.
        layout: Which letters stand where. Default `qwerty`. `qwerty`: The letters of English, the space bar below.
        depth: How thick keys are, in m. Default 0.005. From 0.001 to 2 m.
        min_force_n: Contact force that counts as pressed, in N. From 0.01 to 1000; 1, the default, is a light touch.
    """

    kind: ClassVar[str] = "keyboard"
    pitch: float
    key: NumberOrRange
    at: Place | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None
    layout: Literal["qwerty"] | None = None
    depth: float | None = None
    min_force_n: float | None = None


class Step(Instruction):
    """Something to do. Where it names a group, it means each object of it in turn."""


@dataclass(frozen=True, repr=False)
class Dwell(Step):
    """Stay in spheres: `Dwell("slot", for_s=0.3)`.

    Args:
        in_: Names of the spheres, or of groups of them, in the order in which to stay in them.
        for_s: How long in each without a break, in s, from 0 to 600; to the physics step, at least one.
        with_: The finger that must be inside, by the name that the body's model has for it. Without it: the fingertip,
            or what points in its place.
        also: Spheres in which other fingers must be at the same time, by the names that the body's model has for them:
            `{"thumb": "left"}`.
    """

    action: ClassVar[str] = "dwell"
    in_: Names
    _: KW_ONLY
    for_s: float
    with_: str | None = None
    also: Mapping[str, Name] | None = None


@dataclass(frozen=True, repr=False)
class Pinch(Step):
    """Bring another finger to the fingertip while what points is in spheres: `Pinch("item")`.

    Args:
        in_: Names of the spheres, or of groups of them, in the order in which to pinch in them. What points must be
            inside as fingers close: a ray pinches from afar.
        with_: The finger that comes to the fingertip, by the name that the body's model has for it. Default `thumb`.
        for_s: How long both stay together in each, in s, from 0 to 600; to the physics step, at least one. Default 0.
        closer_than: How near tips are together, in m, from 0.001 to 0.2. Default 0.02.
        apart: How far they must have been apart before, in m, from `closer_than` to 0.4. Default 0.035.
    """

    action: ClassVar[str] = "pinch"
    in_: Names
    _: KW_ONLY
    with_: str | None = None
    for_s: float | None = None
    closer_than: float | None = None
    apart: float | None = None


class Press(OfNames, Step):
    """Press buttons: `Press(1, 3, 3, 5)`. A button is done as soon as it is pressed hard enough; one that is pressed
    twice in a row must be let go in between.

    Args:
        names: Names of the objects, in this order.
    """

    action: ClassVar[str] = "press"


@dataclass(frozen=True, repr=False)
class PressWith(Step):
    """Press a button with each of these fingers, all at the same time: `PressWith({"fingertip": "c", "thumb": "e"})`.
    It is done once all are down; each must be lifted before it can press again.

    Args:
        fingers: Name of a button by each finger.
    """

    action: ClassVar[str] = "press_with"
    has_short_form: ClassVar[bool] = True
    fingers: Mapping[str, Name]


class PressAndRelease(OfNames, Step):
    """Press buttons and let go of them: `PressAndRelease(1, 3, 3, 5)`. A button is done when it is let go.

    Args:
        names: Names of the objects, in this order.
    """

    action: ClassVar[str] = "press_and_release"


@dataclass(frozen=True, repr=False)
class Drag(Step):
    """Drag the handle of a slider to a value and let go of it there: `Drag("volume", to=70, within=2)`.

    Args:
        slider: Name of the slider whose handle is dragged.
        to: The value at which to let go of the handle, in the range of the slider.
        within: How far off the value may be when the handle is let go, in the same unit.
    """

    action: ClassVar[str] = "drag"
    slider: Name
    _: KW_ONLY
    to: float
    within: float


@dataclass(frozen=True, repr=False)
class Swing(Step):
    """Swing a stick to an angle and leave its knob there: `Swing("lever", to_deg=30, within_deg=3)`.

    Args:
        stick: Name of the stick whose knob is swung.
        to_deg: The angle at which to leave the knob, in degrees, in the range of the stick.
        within_deg: How far off the angle may be when the knob is left, in degrees.
    """

    action: ClassVar[str] = "swing"
    stick: Name
    _: KW_ONLY
    to_deg: float
    within_deg: float


@dataclass(frozen=True, repr=False)
class Drive(Step):
    """Drive a sphere with a stick into another sphere, and stop it there: `Drive("lever", vehicle="car",
    into="garage")`.

    Args:
        stick: Name of the stick whose knob is held and moved.
        vehicle: Name of the sphere that it drives, whose motion (`moves`) is `driven`.
        into: Name of the sphere in which the middle of the vehicle must come to a stop.
        slower_than: How slow it must be there, in m/s, from 0.001 to 10. Default 0.05.
    """

    action: ClassVar[str] = "drive"
    stick: Name
    _: KW_ONLY
    vehicle: Name
    into: Name
    slower_than: float | None = None


@dataclass(frozen=True, repr=False)
class Follow(Step):
    """Stay with moving spheres for a time: `Follow("ball", for_s=3)`.

    Args:
        target: Names of the spheres that move, or of groups of them, in the order in which to follow them.
        for_s: How long inside each, in s, from 0 to 600: all the time inside is added up, to the physics step, at least
            one.
    """

    action: ClassVar[str] = "follow"
    target: Names
    _: KW_ONLY
    for_s: float


@dataclass(frozen=True, repr=False)
class Track(Step):
    """Keep to moving spheres as well as one can for a time: `Track("ball", for_s=10)`.

    Args:
        target: Names of the spheres that move, or of groups of them, in the order in which to track them.
        for_s: How long to keep to each, in s, from 0 to 600; to the physics step, at least one. It is done when the
            time is over, and every second inside brings `reward.subtask_bonus`; how much of it was inside (`on_target`)
            and how far off (`tracking_error`) tells how well.
    """

    action: ClassVar[str] = "track"
    target: Names
    _: KW_ONLY
    for_s: float


@dataclass(frozen=True, repr=False)
class Steer(Step):
    """Go from sphere to sphere without leaving a way of some width, as through a menu or a tunnel: `Steer(("a", "b",
    "c"), width=0.03)`.

    Args:
        through: The spheres, two or more: the way begins in the first, goes straight from each to the next, and ends in
            the last.
        width: How wide it is, in m, from 0.002 to 4. Whoever leaves it must come back to where it was left; how often
            it was left is counted (`exits`), and costs what `reward.exit` says.
    """

    action: ClassVar[str] = "steer"
    through: Names
    _: KW_ONLY
    width: float


@dataclass(frozen=True, repr=False)
class React(Step):
    """Wait for one of several objects to light up, and press it or dwell in it: `React("lamps", after_s=(0.5, 1.5))`.

    Args:
        among: Names of the buttons, or of the spheres, of which one lights up; each as often as the others.
        after_s: After what time one lights up, in s, a number or `(min, max)`, drawn anew every time.
        for_s: Of spheres: how long to stay inside, in s. Buttons are pressed.
    """

    action: ClassVar[str] = "react"
    among: Names
    _: KW_ONLY
    after_s: NumberOrRange
    for_s: float | None = None


@dataclass(frozen=True, repr=False)
class Wait(Step):
    """Wait before the next step, in s, a number or `(min, max)`, drawn anew every time: `Wait(0.5)`. What comes next
    can be seen, and does not count before the time is over.

    Args:
        for_s: How long, in s, a number or `(min, max)`.
    """

    action: ClassVar[str] = "wait"
    has_short_form: ClassVar[bool] = True
    for_s: NumberOrRange


@dataclass(frozen=True, repr=False)
class Type(Step):
    """Press the keys of a keyboard: `Type("hello")`, or `Type("hello", on="keyboard")`.

    Args:
        text: Each letter is the name of a key, a blank is `space`. Capital letters are typed as small ones.
        on: On which keyboard or group. Without it: on the only keyboard there is.
    """

    action: ClassVar[str] = "type"
    has_short_form: ClassVar[bool] = True
    text: str
    _: KW_ONLY
    on: str | None = None


@dataclass(frozen=True, repr=False)
class RandomOrder(Step):
    """Steps in an order that each episode draws: `RandomOrder([Press(1, 2, 3)])`.

    Args:
        steps: The steps.
    """

    action: ClassVar[str] = "random_order"
    has_short_form: ClassVar[bool] = True
    steps: Sequence[Step]


@dataclass(frozen=True, repr=False)
class AnyOrder(Step):
    """Steps in any order that the user takes: `AnyOrder([Press(1, 2, 3)])`. What is nearest to the pointer counts as
    the current step.

    Args:
        steps: The steps.
    """

    action: ClassVar[str] = "any_order"
    has_short_form: ClassVar[bool] = True
    steps: Sequence[Step]


@dataclass(frozen=True, repr=False)
class Repeat(Step):
    """The same steps again: `Repeat(3, steps=[...])`.

    Args:
        times: How often the steps are done, 1 to 256.
        steps: What is done every time, in this order.
    """

    action: ClassVar[str] = "repeat"
    times: int
    _: KW_ONLY
    steps: Sequence[Step]


class Technique(OfKind):
    """What points: every step of the script goes by one pointer, which the technique makes of the body's posture. Only
    fingers can press and drag."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Fingertip(Technique):
    """The fingertip itself."""

    kind: ClassVar[str] = "fingertip"


@dataclass(frozen=True, kw_only=True, repr=False)
class Ray(Technique):
    """A ray from the forearm or the hand, like that of a laser pointer.

    Args:
        from_: What it follows: `forearm`, from the elbow through the wrist, or `hand`, from the wrist through the
            fingertip.
        onto: Name of the object whose face it meets. Without it the ray goes through space.
    """

    kind: ClassVar[str] = "ray"
    from_: Literal["forearm", "hand"]
    onto: str | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class GoGo(Technique):
    """A hand that reaches farther the farther the arm is stretched (Go-Go; Poupyrev et al. 1996, doi
    10.1145/237091.237102).

    Args:
        beyond: Distance in m of the fingertip from the shoulder centre up to which the pointer is the fingertip.
            Default 0.4: two thirds of an arm's length, as published. From 0 to 4 m.
        gain: How fast it goes away beyond it, in 1/m. Default 16.7: the published 1/6 per cm. From 0 to 100 1/m.
    """

    kind: ClassVar[str] = "go_go"
    beyond: float | None = None
    gain: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Cursor(Technique):
    """A cursor on a display, moved by the fingertip.

    Args:
        onto: Name of the object on whose face it moves.
        at: Where the fingertip is when the cursor is in the middle, `(x, y, z)` in m. Each from -2 to 2 m.
        gain: How many metres the cursor moves for a metre of the fingertip (control-display gain). From 0.01 to 100.
        tilt_deg: How the plane of the hand is tilted, in degrees: 0, the default, lies like a table, on which forward
            is up on the display; 90 stands like a wall. From 0 to 180 deg.
        turn_deg: The plane of the hand turned about the vertical, in degrees, to the left as seen from above. Default
            0. From -180 to 180 deg.
    """

    kind: ClassVar[str] = "cursor"
    onto: str
    at: Triple
    gain: float
    tilt_deg: float | None = None
    turn_deg: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class RateCursor(Technique):
    """A cursor on a display that moves as long as the fingertip is off its place of rest, like that of a joystick.

    Args:
        onto: Name of the object on whose face it moves.
        at: Where the fingertip rests, `(x, y, z)` in m. Each from -2 to 2 m.
        gain: How fast the cursor moves, in m/s for each metre that the fingertip is farther off its rest than `still`.
            From 0.01 to 100.
        still: How far off its rest, in m, the fingertip moves nothing. Default 0.01. From 0 to 4 m.
        tilt_deg: How the plane of the hand is tilted, in degrees, as of a cursor. Default 0. From 0 to 180 deg.
        turn_deg: The plane of the hand turned about the vertical, in degrees, as of a cursor. Default 0. From -180 to
            180 deg.
    """

    kind: ClassVar[str] = "rate_cursor"
    onto: str
    at: Triple
    gain: float
    still: float | None = None
    tilt_deg: float | None = None
    turn_deg: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Body(Described):
    """What the body of the simulated user is like, where it is not as the model has it. Targets stay where they are
    relative to the shoulder of the arm that does the task.

    Args:
        sex: Whose proportions and strength: `female` or `male`. Default: as the model; `myo-arm` is a man's. Lengths
            and masses of segments as shares of stature and body mass after de Leva 1996, doi
            10.1016/0021-9290(95)00178-6; a kilogram of a woman is 0.63 times as strong as a man's, so that the median
            woman is half as strong as the median man, as measured at the shoulder (doi 10.1016/0268-0033(89)90046-6).
        height_m: Stature, in m. Default: as the model, 1.735 for `myo-arm`. Bones, paths of muscles and bones that they
            bend over all grow with it. From 1.2 to 2.2 m.
        mass_kg: Body mass, in kg. Default: as stout as the model (25.4 kg per square metre of stature for `myo-arm`).
            The torque of muscles grows with it (Jaric 2002, doi 10.2165/00007256-200232100-00002). From 25 to 200 kg.
        age_years: Age, in years: from 50 on strength falls by 13.5 % in ten years (Hurley 1995, doi
            10.1093/gerona/50a.special_issue.41: 12 to 15 %). Default: young. It changes nothing else; that older people
            are slower to see and to decide is for `perception` to say. From 18 to 80 years.
        hand: The hand that does it. `left` mirrors the body: places are then relative to the centre of the left
            shoulder. Default `right`. `right`: The right hand. `left`: The left hand.
        strength: How many times as strong as people of this size all muscles are: their active force. Default 1; 0.5 is
            what simulations of sarcopenia take (MyoSuite). From 0.01 to 3.
        muscles: The same for single muscles, such as `SUPSP=0` for a torn tendon, and for groups of them: `shoulder`,
            `elbow`, `hand`. Those of a named user stay where the task does not name them; `{}` takes all back. Default:
            none.
        transfers: Tendon transfers: `PT="ECRB"` makes the first muscle pull where the second did, which pulls no more.
            Default: none.
    """

    sex: Literal["female", "male"] | None = None
    height_m: float | None = None
    mass_kg: float | None = None
    age_years: float | None = None
    hand: Literal["right", "left"] | None = None
    strength: float | None = None
    muscles: Mapping[str, float] | None = None
    transfers: Mapping[str, str] | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Reward(Described):
    """What the simulated user is rewarded for: costs per second, bonuses and fines per event. All weights are positive;
    costs are subtracted. They do not depend on the control step, so that a user who decides more often is not paid
    otherwise.

    The defaults are those that train soonest. The published system (MyoInteract) has, at 20 Hz, `distance_cost=20`,
    `inside_is_zero=False`, `remaining_path=True`, `time_cost=0`, `subtask_bonus=0`, `completion_bonus=10`,
    `effort_cost=0`.

    Args:
        distance_cost: Cost per second and metre of the distance from the fingertip to the current target. Default 6:
            where the arm must first go away from a target to reach it, a larger cost makes stopping short pay. Depth
            behind the face of a button counts three times: the way there goes round it. From 0 to 1,000,000.
        distance_scale_m: Where distances count for less: the cost grows with `s (1 - e^(-d / s))` instead of the
            distance `d`, where `s` is this in m. Near the target it is the same, far away no more than `s`. Default 0:
            the distance itself. From 0 to 10 m.
        inside_is_zero: `True`: the fingertip's distance counts from the sphere's surface and is 0 inside, so that
            dwelling anywhere in it costs nothing; for a button it counts from the pressed face. `False`: from the
            centre. Default True.
        remaining_path: Whether the distance goes on over the centres of the targets still to come. Default False.
        time_cost: Cost per second as long as the task is not finished. Default 0.6. From 0 to 1,000,000.
        subtask_bonus: Given once when a target is done, the last one included; of what is tracked, for every second
            inside. Default 3. From 0 to 1,000,000.
        completion_bonus: Given once when the whole task is done. Default 6. From 0 to 1,000,000.
        wrong_press: Cost of pressing a button that the current step does not ask for, each time. Default 0; for
            `user="human"` 2, two thirds of what a target brings. It is counted in any case, and takes the time of
            `perception.error_pause_s`. From 0 to 1,000,000.
        exit: Cost of leaving the way of a `steer`, each time. Default 0: it is counted, and that is all. From 0 to
            1,000,000.
        effort_cost: Cost per second of muscle control: times the sum over muscles of the squared control that is asked
            for, also where fatigue leaves less of a muscle. Default 0.02; for `user="human"` 4. From 0 to 1,000,000.
        acceleration_cost: Cost per second of jerky movement: times the sum over independent joints of the squared
            acceleration in rad/s2. Default 0; accelerations are large: the published weight is 1.33e-4. From 0 to
            1,000,000.
        control_change_cost: Cost per second of changing what is asked of muscles: times the sum over muscles of the
            squared rate of change of the control, in 1/s, before motor noise. Holding still costs none of it, fast
            movement most. What effort, acceleration, this and contact cost together counts for less beyond four times
            the greatest bonus per second. Default 0. After minimum torque change (Uno, Kawato and Suzuki 1989, doi
            10.1007/BF00204593). From 0 to 1,000,000.
        contact_cost: Cost per second of touching hard: times the squared force in N between the fingertip and all that
            it touches. Default 0; for `user="human"` 0.12: 25 N, fifty times what people press glass with, cost as much
            in 0.04 s as a target brings. From 0 to 1,000,000.
    """

    distance_cost: float | None = None
    distance_scale_m: float | None = None
    inside_is_zero: bool | None = None
    remaining_path: bool | None = None
    time_cost: float | None = None
    subtask_bonus: float | None = None
    completion_bonus: float | None = None
    wrong_press: float | None = None
    exit: float | None = None
    effort_cost: float | None = None
    acceleration_cost: float | None = None
    control_change_cost: float | None = None
    contact_cost: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Observation(Described):
    """Which parts the observation has; at least one. All of them by default, accelerations aside.

    Args:
        joint_position: Angles of the independent joints, their range mapped to -1 to 1. Default True.
        joint_velocity: Velocities of the independent joints, in rad/s. Default True.
        joint_acceleration: Accelerations of the independent joints, in 100 rad/s2. Default False: they are noisy and
            velocities say enough.
        fingertip_position: Position of the fingertip, in m from the shoulder centre. Default True.
        pointer_position: Position of the pointer, in m from the shoulder centre, where the technique is not the
            fingertip itself. Default True.
        activation: Activation of each muscle, 0 to 1 mapped to -1 to 1. Default True.
        fatigue: What of each muscle is fatigued, a share, in tasks with fatigue. Default True.
        control: Control that each muscle was last asked for, without motor noise, 0 to 1 mapped to -1 to 1, in tasks
            where changing it costs something. Default True.
        target_position: Centre of the current target, in m from the shoulder centre. Default True.
        target_size: Radius of the current sphere or knob, or half the width of the current button or way, in m. Default
            True.
        target_vector: From the fingertip, or the pointer, to the centre of the current target, in m. Default True.
        target_direction: The same way as a share of its length and the radius together: nearly a unit vector far away,
            half as long at the edge of a sphere, 0 in its middle, so that small targets are hit as easily by who has
            learnt large ones. Default True.
        target_normal: Where the face of the current button or slider looks, a unit vector; 0 for spheres, and before it
            lights up. Default False.
        target_kind: Whether the current target is to be pressed or dragged, 1, or to be pointed at, 0. Default False.
        target_velocity: Velocity of the current target, in m/s, in tasks where something moves. Default True.
        next_target_vector: From the centre of the current target to that of the next, in m; 0 at the last target.
            Default True.
        phase: How many targets are done, as a share of all. Default True.
        dwell_fraction: How much of the current dwell has passed, as a share. Default True.
        time_left: Time left until the limit, as a share. Default True.
        inside: Whether the fingertip is inside the current sphere: 1 or 0. Default True.
        touch: Force on the fingertip, whatever it touches, as a share of what the current button needs, at most 1.
            Default True.
        cue: Whether the current target may be gone for: 0 before it lights up or the wait is over, else 1; in tasks
            with waits. Default True.
        pause: Share of the pause after a wrong press that is left, in tasks and of users where there is one
            (`perception.error_pause_s`). Default True.
        drag: Whether the handle of the current slider, or the knob of the current stick, is held, 1 or 0, and the way
            it must go, in m; in tasks with sliders or sticks. Default True.
        drive: From the current vehicle to where it must stop, in m, and its speed, in m/s; in tasks in which something
            is driven. Default True.
        steer: From the fingertip, or the pointer, to the farthest place of the current way that was come to, in m, and
            whether it is within the way: 1 or 0; in tasks with ways. Default True.
        fingers: Whether the fingertip holds its button of several that are to be pressed at once: 1 or 0. From every
            other finger that the task asks for to where it must be, in m, how large that is, in m, whether the current
            step asks for it, and whether it is ready: holds the button that it is to press with others, or is open for
            a pinch; 1 or 0, in tasks that ask for other fingers. Default True.
        nearest_obstacle: From the fingertip to the nearest place of the surface of any box but the current target, in
            m, shortened to 1 where it is farther, and 1 downwards where there is none; in tasks with boxes. Default
            False.
        traits: What the user is like, of what users of one body differ in: signal-dependent motor noise in tenths,
            `perception.vision_noise` in fifths, `reward.effort_cost` in fours and `reward.control_change_cost` in tens.
            For one who learns to be anybody, in layouts that differ in these. Default False.
    """

    joint_position: bool | None = None
    joint_velocity: bool | None = None
    joint_acceleration: bool | None = None
    fingertip_position: bool | None = None
    pointer_position: bool | None = None
    activation: bool | None = None
    fatigue: bool | None = None
    control: bool | None = None
    target_position: bool | None = None
    target_size: bool | None = None
    target_vector: bool | None = None
    target_direction: bool | None = None
    target_normal: bool | None = None
    target_kind: bool | None = None
    target_velocity: bool | None = None
    next_target_vector: bool | None = None
    phase: bool | None = None
    dwell_fraction: bool | None = None
    time_left: bool | None = None
    inside: bool | None = None
    touch: bool | None = None
    cue: bool | None = None
    pause: bool | None = None
    drag: bool | None = None
    drive: bool | None = None
    steer: bool | None = None
    fingers: bool | None = None
    nearest_obstacle: bool | None = None
    traits: bool | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Reset(Described):
    """How the body starts an episode. Coupled joints follow the independent ones.

    Args:
        pose: Joint angles at the start. Default for `user="human"` `near_zero`, for `user="fastest"` `range_uniform`.
            `range_uniform`: Every independent joint anywhere in its range. `zero`: Every joint at zero, at rest.
        pose_spread_rad: With `near_zero`: angles are drawn from plus or minus this, in rad, kept within the joint
            range. Default 0.05. From 0 to 1 rad.
        velocity_spread_rad_s: Joint velocities are drawn from plus or minus this, in rad/s; the pose `zero` always
            starts at rest. Default 0.05. From 0 to 10 rad/s.
        activation_max: Muscle activations are drawn from 0 to this. Default for `user="human"` 0: relaxed, for
            `user="fastest"` 1. From 0 to 1.
    """

    pose: Literal["range_uniform", "near_zero", "zero"] | None = None
    pose_spread_rad: float | None = None
    velocity_spread_rad_s: float | None = None
    activation_max: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Perception(Described):
    """How late the simulated user perceives, in ms, rounded to whole control steps, and how far off.

    Args:
        vision_delay_ms: What is seen: where objects are, what became of them, where a pointer other than the fingertip
            is. Default 0. From 0 to 1,000 ms.
        body_delay_ms: What is felt of the own body: joints, fingertip, activations. Default 0. From 0 to 1,000 ms.
        touch_delay_ms: The force of a touch. Default 0. From 0 to 1,000 ms.
        vision_noise: How far off a target seems that is away from the pointer: standard deviation along the line
            between them, as a share of its length and another millimetre, and half as much across; along the line at
            most two standard deviations. It shrinks on the way, so that a movement misses by far less. Default 0. From
            0 to 1.
        vision_held_s: How long a target seems off in the same way: the time in s after which e-times less of it is
            left, and something new has taken its place, as of people who look again several times a second. Default
            0.3, as long as eyes rest on a place (Rayner 1998, doi 10.1037/0033-2909.124.3.372). From 0.001 to 10 s.
        error_pause_s: How long it takes to go on after a wrong press, in s: presses do not count in that time. Default
            0; for `user="human"` 0.5, about the time of two keystrokes of people (0.24 s each, Dhakal et al. 2018, doi
            10.1145/3173574.3174220), as to take back and press again. From 0 to 10 s.
    """

    vision_delay_ms: float | None = None
    body_delay_ms: float | None = None
    touch_delay_ms: float | None = None
    vision_noise: float | None = None
    vision_held_s: float | None = None
    error_pause_s: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Noise(Described):
    """Gaussian motor noise on the muscle controls: independent for each muscle, and as strong and as slow at any
    control step as noise that is drawn every `held_s` and held.

    Args:
        signal_dependent: Standard deviation as a share of the control itself. Default 0 (off); the literature's level
            is 0.103. From 0 to 1.
        constant: Standard deviation that does not depend on the control. Default 0 (off); the literature's level is
            0.185. From 0 to 1.
        held_s: How slow the noise is: as slow as noise that is drawn every so many seconds and held until then. The
            force of people's muscles varies by slow common fluctuations of what drives them for the most part
            (Dideriksen et al. 2012, doi 10.1152/jn.00938.2011). Default 0.05. From 0.001 to 10 s.
    """

    signal_dependent: float | None = None
    constant: float | None = None
    held_s: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Reflex(Described):
    """Stretch reflexes: a muscle that works is excited more while it lengthens and less while it shortens, without a
    decision, and so a held arm gives way less. It is by how fast the muscle lengthens at the start of a control step,
    and so late by half of one on average. It is in proportion to what is asked of the muscle (Matthews 1986, doi
    10.1113/jphysiol.1986.sp016066), in proportion to slow changes of length and no greater for fast ones, a coarse form
    of spindles that tell of the root of the speed (Prochazka and Gorassini 1998, doi 10.1111/j.1469-7793.1998.277bu.x),
    and changing it costs nothing.

    Args:
        gain: By how much of itself an excitation grows, per greatest shortening speed of the muscle at which it
            lengthens. Default 0 (off). From 0 to 1,000.
        most: By how much of itself it grows or shrinks at most. Default 0.3. From 0 to 1.
    """

    gain: float | None = None
    most: float | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Fatigue(Described):
    """Fatigue: what of a muscle cannot be driven after work, and comes back with rest. The three-compartment model with
    faster recovery at rest (3CC-r; Looft, Herkert and Frey-Law 2018, doi 10.1016/j.jbiomech.2018.06.005) with the
    published rates of each muscle's joint: of what is active a share fatigues (1.8 % per second at the shoulder, 0.9 at
    elbow and hand), and what is not fatigued is the most that a muscle can be excited. The user feels it
    (`observation.fatigue`).

    Args:
        speed: How many times as fast as people muscles tire and recover. Default 0 (off); 1 as people, 10 what takes
            people ten minutes in one. From 0 to 1,000.
        lasts: Whether it lasts from one episode to the next, until a reset with a seed: long work is many episodes.
            Otherwise every episode begins as `initial_max` says. Who learns so is soon at work for long in every
            environment, and forgets how to begin. Default False.
        initial_max: What of each muscle is fatigued at the start is drawn from 0 to this. Default 0: rested. From 0 to
            1.
    """

    speed: float | None = None
    lasts: bool | None = None
    initial_max: float | None = None


def build_task(
    name: str,
    *,
    scene: Mapping[str, Object],
    script: Sequence[Step],
    technique: Technique | Literal["fingertip"] | None = None,
    stimulus: Literal["all", "current", "before_movement"] | None = None,
    correction: Name | None = None,
    time_limit_s: float | None = None,
    step_limit_s: float | None = None,
    user: User | None = None,
    body: Body | None = None,
    reward: Reward | None = None,
    observation: Observation | None = None,
    reset: Reset | None = None,
    perception: Perception | None = None,
    noise: Noise | None = None,
    reflex: Reflex | None = None,
    fatigue: Fatigue | None = None,
    control_dt_s: float | None = None,
    control: Literal["absolute", "relative"] | None = None,
    model: str | None = None,
    description: str | None = None,
) -> Task:
    """A task of a scene, a script and settings, for `make_vec`, `train` and whatever else takes a task.

    Args:
        name: Short name, used for run folders and tables.
        scene: What stands there: objects by name, alone or in groups; up to 256.
        script: What is to do with them, one after the other; up to 256 steps.
        technique: What points: the fingertip, a ray, a Go-Go hand or a cursor. Default `fingertip`.
        stimulus: What the simulated user sees of the task: the object of the current step and of the next one, or of
            the `current` one alone. Default `all`. `all`: The object of the current step, and where that of the next
            one is. `current`: The object of the current step alone. `before_movement`: The same, and only until the
            pointer has moved a centimetre towards it or elsewhere; from then on it is remembered as it was.
        correction: The button that takes back a wrong press, such as `delete`: each must be corrected before the script
            goes on. Without it wrong presses are counted, and cost what `reward.wrong_press` says.
        time_limit_s: When an episode ends without success, in s. Rounded to whole control steps. Default 12. From 0.001
            to 600 s.
        step_limit_s: How long each step of the script may take, in s, from when it counts. What is not done by then is
            given up: the script goes on with the next step, and the episode is no success. Rounded to whole control
            steps. Default: as long as the episode. From 0.001 to 600 s.
        user: Who does it: what the simulated user is like where this task does not say. `human` moves as people do,
            `fastest` as fast as its muscles allow. Default `human`. `human`: Is to move as people do: with motor noise,
            with eyes that are late, and with regard to its effort. In shape and speed its movements are like people's;
            how far it is like them is told in `docs/people.md`. `fastest`: As fast as its muscles allow: no noise, no
            delay, effort that costs next to nothing. For comparisons of learners, and of tasks whose speed is all that
            counts. `woman`: `human` as the median woman: 1.626 m, 66.8 kg (soldiers of ANSUR II, 2012), with half the
            strength of the median man. `man`: `human` as the median man: 1.755 m, 84.6 kg (ANSUR II). `small_woman`:
            `human` as a small woman: 1.525 m and 51.3 kg, each less than 95 of 100 women have (ANSUR II). `large_man`:
            `human` as a large man: 1.87 m and 110.7 kg, each more than 95 of 100 men have (ANSUR II). `older_woman`:
            `human` as the median woman at 75: 0.7 times as strong, and seeing 25 ms later (0.55 ms a year, Woods et al.
            2015, doi 10.3389/fnhum.2015.00131), which is a whole decision of 40 ms later. `older_man`: `human` as the
            median man at 75, in the same way. `sarcopenia`: `human` with muscles half as strong: loss of muscle, as
            MyoSuite simulates it. `rotator_cuff_tear`: `human` with torn tendons of supraspinatus and infraspinatus:
            the common massive tear of the rotator cuff. `tendon_transfer`: `human` whose wrist extensors are paralysed,
            after the usual transfer of pronator teres: it pulls where the short radial extensor did. `left_handed`:
            `human` with the left hand. `tired`: `human` whose muscles tire as people's do, each of which begins an
            episode anything between rested and half fatigued.
        body: What the user's body is like where it is not as the model has it: how large, how strong, which hand.
        reward: What the simulated user is rewarded for.
        observation: What the simulated user perceives.
        reset: How the body starts an episode.
        perception: How late it is perceived.
        noise: Motor noise, off by default.
        reflex: Stretch reflexes of muscles, off by default.
        fatigue: Fatigue of muscles, off by default.
        control_dt_s: Time between two decisions of the simulated user, in s; muscle controls are held in between. From
            0.001 to 0.5; default 0.05 (20 Hz).
        control: What an action asks of a muscle: its excitation, or a change of what it does. Default `absolute`.
            `absolute`: The excitation `(a + 1) / 2`. `relative`: The excitation `activation + a`, within 0 and 1, with
            the activation as the control step begins; as in User-in-the-Box (Ikkala et al. 2022, doi
            10.1145/3526113.3545689).
        model: The body that does it: the name of a built-in model, or a model file, looked for in the working
            directory. Default `myo-arm`.
        description: What the task stands for, for people. Default: empty; at most 10,000 characters.

    Raises:
        TaskError: A value does not fit; the sentence names it, such as `scene.panel.of.size`.
    """
    task: dict[str, Any] = {
        "version": 2,
        "name": name,
        "scene": scene,
        "script": script,
        "technique": technique,
        "stimulus": stimulus,
        "correction": correction,
        "time_limit_s": time_limit_s,
        "step_limit_s": step_limit_s,
        "user": user,
        "body": body,
        "reward": reward,
        "observation": observation,
        "reset": reset,
        "perception": perception,
        "noise": noise,
        "reflex": reflex,
        "fatigue": fatigue,
        "control_dt_s": control_dt_s,
        "control": control,
        "model": model,
        "description": description,
    }
    needed = ("name", "scene", "script")
    return load_task({key: value for key, value in task.items() if key in needed or value is not None})
