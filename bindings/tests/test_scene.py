"""Tasks built from objects."""

import doctest
import inspect
import os
import pickle
import re
from dataclasses import MISSING, FrozenInstanceError, fields, is_dataclass, replace

import numpy as np
import pytest
from scene_source import MODULE, scene_source

import myoenv
from myoenv import scene as s

SMALL = s.Button(size=(0.045, 0.045, 0.02), min_force_n=1.5)
PANEL = s.Grid(at=(0.42, 0, -0.15), tilt_deg=60, rows=2, columns=3, pitch=0.06, of=SMALL)
PRESETS = {
    "ticket": {
        "scene": {
            "panel": PANEL,
            "board": s.Obstacle(at=(0.438, 0, -0.1603), size=(0.2, 0.14, 0.02), tilt_deg=60),
        },
        "script": [s.PressAndRelease(1, 3, 3, 5)],
        "time_limit_s": 6,
    },
    "hello": {
        "scene": {
            "phone": s.Keyboard(at=(0.32, 0, -0.3), layout="qwerty", pitch=0.01, key=0.009, min_force_n=0.5),
            "case": s.Obstacle(at=(0.32, 0, -0.3085), size=(0.11, 0.06, 0.01)),
        },
        "script": [s.Type("hello")],
        "time_limit_s": 6,
    },
    "slider": {
        "scene": {"volume": s.Slider(at=(0.42, 0.05, -0.15), tilt_deg=45, length=0.1, range=(0, 100), value=(0, 40))},
        "script": [s.Drag("volume", to=70, within=5)],
        "time_limit_s": 6,
    },
    "choice": {
        "scene": {
            "lamps": s.Grid(
                at=(0.42, 0, -0.15), tilt_deg=60, rows=1, columns=4, pitch=0.06, of=s.Button(size=(0.04, 0.04, 0.02))
            ),
            "board": s.Obstacle(at=(0.438, 0, -0.1603), size=(0.26, 0.08, 0.02), tilt_deg=60),
        },
        "script": [s.Repeat(5, steps=[s.React("lamps", after_s=(0.5, 1.5))])],
        "time_limit_s": 15,
    },
    "wall-ray": {
        "scene": {
            "wall": s.Obstacle(at=(2, 0, 0), tilt_deg=90, size=(1.6, 1, 0.02)),
            "ring": s.Circle(
                at=(1.99, 0, 0),
                tilt_deg=90,
                count=7,
                diameter=0.6,
                of=s.Sphere(radius=0.1, min_distance_from_previous=0),
            ),
        },
        "technique": s.Ray(from_="forearm", onto="wall"),
        "script": [s.Dwell("ring", for_s=0.25)],
        "time_limit_s": 12,
    },
    "pinch": {
        "model": "myo-hand",
        "scene": {
            "item": s.Sphere(
                at=s.Region(x=(0.33, 0.37), y=(-0.03, 0.06), z=(-0.28, -0.22)),
                radius=0.025,
                copies=3,
            )
        },
        "script": [s.Pinch("item")],
        "time_limit_s": 6,
    },
    "chord": {
        "model": "myo-hand",
        "scene": {
            "keys": s.Grid(
                at=(0.38, 0.004, -0.318),
                rows=1,
                columns=3,
                pitch=0.0235,
                names=["c", "d", "e"],
                of=s.Button(size=(0.0225, 0.06, 0.006), min_force_n=0.6),
            ),
            "desk": s.Obstacle(at=(0.38, 0.004, -0.331), size=(0.2, 0.16, 0.02)),
        },
        "script": [
            s.PressWith({"fingertip": "c", "middle": "d"}),
            s.PressWith({"fingertip": "d", "middle": "e"}),
            s.PressWith({"fingertip": "c", "middle": "d"}),
        ],
        "time_limit_s": 8,
    },
}


def build(name="test", *, scene=None, script=None, **settings) -> myoenv.Task:
    """A task on the panel, apart from what is given."""
    scene, script = scene or {"panel": PANEL}, script or [s.PressAndRelease(1)]
    return myoenv.build_task(name, scene=scene, script=script, **settings)


def test_the_module_is_made_from_the_schema():
    made = scene_source(myoenv.task_schema())
    if os.environ.get("MYO_BLESS"):
        MODULE.write_text(made, encoding="utf-8")
    remedy = "run `MYO_BLESS=1 python -m pytest bindings/tests/test_scene.py` and install the package anew"
    assert MODULE.read_text(encoding="utf-8") == made, f"the format of tasks has changed: {remedy}"
    assert inspect.getsource(s) == made, f"another version is installed: {remedy}"


def test_classes_have_the_fields_of_the_schema():
    schema = myoenv.task_schema()
    parts = schema["$defs"]
    found = {}
    for name in s.__all__:
        part = getattr(s, name)
        if inspect.isclass(part) and is_dataclass(part) and fields(part):
            found[name] = {field.name.removesuffix("_"): field.default is MISSING for field in fields(part)}
    expected = {}
    for of, ending in (("Item", ""), ("Motion", "Motion"), ("Technique", "")):
        for kind in parts[of]["oneOf"]:
            keys = dict(kind.get("properties", {}))
            name = keys.pop("kind", {"const": ""})["const"].title().replace("_", "") + ending
            if keys:
                expected[name] = {key: key in kind["required"] for key in keys}
    same = (
        "Dwell",
        "Pinch",
        "Drag",
        "Swing",
        "Drive",
        "Follow",
        "Track",
        "Steer",
        "React",
        "Repeat",
        "Region",
        "Wave",
        "Reward",
        "Observation",
        "Reset",
        "Body",
        "Perception",
        "Noise",
        "Reflex",
        "Fatigue",
    )
    for name, part in [*((name, parts[name]) for name in same), ("Type", parts["Text"])]:
        expected[name] = {key: key in part.get("required", ()) for key in part["properties"]}
    bare = {"Press": {"names": True}, "PressAndRelease": {"names": True}, "Wait": {"for_s": True}}
    bare |= {"PressWith": {"fingers": True}, "RandomOrder": {"steps": True}, "AnyOrder": {"steps": True}}
    assert found == expected | bare
    steps = {next(iter(step["properties"])) for step in parts["Instruction"]["oneOf"]}
    assert steps == {part.action for part in map(vars(s).get, s.__all__) if hasattr(part, "action")}
    arguments = set(inspect.signature(myoenv.build_task).parameters)
    assert arguments == set(schema["properties"]) - {"version", "targets"}


def test_every_field_is_explained_where_editors_look():
    for name in s.__all__:
        part = getattr(s, name)
        if name not in ("Place", "User"):
            explained = inspect.getdoc(part).partition("\nArgs:")[2].partition("\nRaises:")[0]
            keys = (
                inspect.signature(part).parameters if name == "build_task" else [field.name for field in fields(part)]
            )
            assert re.findall(r"^ {4}(\w+): \S", explained, re.M) == list(keys), name


def test_examples_in_the_documentation_are_right():
    assert doctest.testmod(s) == (0, 2)
    examples = {
        'Dwell("slot", for_s=0.3)': {"dwell": {"in": "slot", "for_s": 0.3}},
        'Pinch("item")': {"pinch": {"in": "item"}},
        "Press(1, 3, 3, 5)": {"press": [1, 3, 3, 5]},
        'PressWith({"fingertip": "c", "thumb": "e"})': {"press_with": {"fingertip": "c", "thumb": "e"}},
        "PressAndRelease(1, 3, 3, 5)": {"press_and_release": [1, 3, 3, 5]},
        'Drag("volume", to=70, within=2)': {"drag": {"slider": "volume", "to": 70, "within": 2}},
        'Swing("lever", to_deg=30, within_deg=3)': {"swing": {"stick": "lever", "to_deg": 30, "within_deg": 3}},
        'Drive("lever", vehicle="car", into="garage")': {
            "drive": {"stick": "lever", "vehicle": "car", "into": "garage"}
        },
        'Follow("ball", for_s=3)': {"follow": {"target": "ball", "for_s": 3}},
        'Track("ball", for_s=10)': {"track": {"target": "ball", "for_s": 10}},
        'Steer(("a", "b", "c"), width=0.03)': {"steer": {"through": ["a", "b", "c"], "width": 0.03}},
        'React("lamps", after_s=(0.5, 1.5))': {"react": {"among": "lamps", "after_s": [0.5, 1.5]}},
        "Wait(0.5)": {"wait": 0.5},
        'Type("hello")': {"type": "hello"},
        'Type("hello", on="keyboard")': {"type": {"text": "hello", "on": "keyboard"}},
        "RandomOrder([Press(1, 2, 3)])": {"random_order": [{"press": [1, 2, 3]}]},
        "AnyOrder([Press(1, 2, 3)])": {"any_order": [{"press": [1, 2, 3]}]},
        "Repeat(3, steps=[...])": {"repeat": {"times": 3, "steps": [...]}},
    }
    shown = [" ".join(code.split()) for code in re.findall(r"`([A-Z]\w*\([^`]*\))`", inspect.getsource(s))]
    assert shown == list(examples)
    for code, written in examples.items():
        assert eval(code, vars(s)).to_dict() == written


@pytest.mark.parametrize("name", PRESETS)
def test_presets_can_be_built(name):
    preset = myoenv.load_task(name)
    description = myoenv.to_dict(preset)["description"]
    assert myoenv.build_task(name, **PRESETS[name], description=description) == preset


@pytest.mark.parametrize("name", PRESETS)
def test_environments_of_built_tasks_are_those_of_the_presets(make, name):
    task = myoenv.build_task(name, **PRESETS[name])
    assert pickle.loads(pickle.dumps(task)) == task
    envs = [make(one, 4, seed=1) for one in (task, name)]
    observations = [env.reset()[0] for env in envs]
    np.testing.assert_array_equal(*observations)
    actions = envs[0].action_space.sample()
    stepped = [env.step(actions) for env in envs]
    np.testing.assert_array_equal(stepped[0][0], stepped[1][0])
    np.testing.assert_array_equal(stepped[0][1], stepped[1][1])


def test_all_parts_are_read():
    path = [
        s.CircleMotion(diameter=0.1, period_s=2, tilt_deg=45, turn_deg=10),
        s.LineMotion(by=(0, 0.2, 0), period_s=3),
        s.WavesMotion(waves=[s.Wave(by=(0, 0.05, 0), period_s=2), s.Wave(by=(0, 0, 0.05), period_s=3)]),
        s.RandomMotion(by=(0, 0.05, 0.05), period_s=2),
    ]
    box = s.Region(x=0.35, y=(-0.1, 0.1), z=(-0.2, -0.1))
    balls = {f"ball{k}": s.Sphere(at=box, radius=(0.03, 0.05), moves=one) for k, one in enumerate(path)}
    task = build(
        scene={**balls, "panel": PANEL, "many": s.Sphere(at=(0.3, (-0.1, 0.1), 0), radius=0.05, copies=3)},
        script=[
            s.Follow(list(balls), for_s=0.5),
            s.Wait((0.1, 0.3)),
            s.Press(["panel.1", "panel.2"]),
            s.Press("panel"),
        ],
        technique=s.Fingertip(),
        reward=s.Reward(distance_cost=20, inside_is_zero=False),
        observation=s.Observation(joint_velocity=False),
        reset=s.Reset(pose="near_zero"),
        user="human",
        perception=s.Perception(vision_delay_ms=80),
        noise=s.Noise(constant=0.185),
        control_dt_s=0.02,
        model="mobl-arms",
        description="",
    )
    assert task.num_targets == 4 + 2 + 6
    described = myoenv.to_dict(task)
    assert described["scene"]["ball2"]["moves"]["waves"][1] == {"by": [0, 0, 0.05], "period_s": 3}
    assert (described["user"], described["perception"]["vision_delay_ms"]) == ("human", 80)
    assert not described["reward"]["inside_is_zero"] and not described["observation"]["joint_velocity"]
    for technique in (s.GoGo(gain=10), s.Cursor(onto="wall", at=(0.3, 0, -0.3), gain=2), "fingertip"):
        scene = {
            "wall": s.Obstacle(at=(0.36, 0, 0), tilt_deg=90, size=(1, 1, 0.02)),
            "ball": s.Sphere(at=(0.35, 0, 0), radius=0.05),
        }
        build(scene=scene, script=[s.Dwell("ball", for_s=0.1)], technique=technique)


def test_orders_ways_and_corrections_are_read():
    task = build(
        scene={"panel": PANEL, "balls": s.Sphere(at=(0.3, (-0.1, 0.1), 0), radius=0.05, copies=2)},
        script=[s.RandomOrder([s.Press("panel.1", "panel.2")]), s.Steer("balls", width=0.2)],
        stimulus="current",
        correction="panel.1",
        step_limit_s=4,
        control="relative",
    )
    described = myoenv.to_dict(task)
    assert (described["step_limit_s"], described["control"]) == (4, "relative")
    assert (described["stimulus"], described["correction"], task.num_targets) == ("current", "panel.1", 4)


def test_what_is_left_out_is_not_written():
    assert SMALL.to_dict() == {"kind": "button", "size": [0.045, 0.045, 0.02], "min_force_n": 1.5}
    assert s.Reward().to_dict() == {} and s.GoGo().to_dict() == {"kind": "go_go"}
    assert repr(s.Dwell("slot", for_s=0.3)) == "Dwell(in_='slot', for_s=0.3)"
    assert repr(s.Press(1, "a")) == "Press(1, 'a')"


def test_parts_are_values():
    assert replace(SMALL, min_force_n=2).min_force_n == 2 and replace(SMALL) == SMALL != s.Obstacle(size=SMALL.size)
    assert s.Press(1, 2) == s.Press(1, 2) != s.PressAndRelease(1, 2)
    for part in (PANEL, *(step for preset in PRESETS.values() for step in preset["script"])):
        assert pickle.loads(pickle.dumps(part)) == part
    with pytest.raises(FrozenInstanceError):
        SMALL.size = (1, 1, 1)
    with pytest.raises(TypeError, match="size"):
        s.Button()
    with pytest.raises(TypeError, match="sizes"):
        s.Button(sizes=(1, 1, 1))


def test_numbers_of_numpy_and_lists_are_taken():
    same = s.Grid(
        at=np.array([0.42, 0, -0.15]),
        tilt_deg=np.float32(60),
        rows=np.int64(2),
        columns=3,
        pitch=[0.06, 0.06],
        of=SMALL,
    )
    tuples = replace(PANEL, pitch=(0.06, 0.06))
    assert build(scene={"panel": same}) == build(scene={"panel": tuples})
    mixed = {"version": 2, "name": "test", "scene": {"panel": PANEL}, "script": [s.PressAndRelease(1)]}
    assert myoenv.load_task(mixed) == build()
    assert build(scene={"panel": PANEL.to_dict()}) == build()


def test_a_moved_group_is_where_it_was_moved(make):
    def positions(at, turn_deg=None) -> np.ndarray:
        keys = s.Keyboard(at=(0.32, 0, -0.3), pitch=0.01, key=0.009)
        phone = s.Group(at=at, turn_deg=turn_deg, objects={"keys": keys})
        env = make(build(scene={"phone": phone}, script=[s.Type("hello", on="phone.keys")]), 1)
        env.reset(seed=1)
        return env.peek().object_positions[0]

    still = positions(None)
    assert len(still) == 27
    np.testing.assert_allclose(positions((0.02, -0.01, 0.03)), still + np.array([0.02, -0.01, 0.03]), atol=1e-9)
    turned = np.stack([-still[:, 1], still[:, 0], still[:, 2]], 1)
    np.testing.assert_allclose(positions((0.3, -0.3, 0), 90), turned + np.array([0.3, -0.3, 0]), atol=1e-9)


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (
            {"scene": {"panel": replace(PANEL, of=s.Button(size=(0.1, 0.1)))}},
            "`scene.panel.of.size` is a list of 2; it must be a list of length 3",
        ),
        (
            {"scene": {"panel": replace(PANEL, of=s.Button(size=None))}},
            "`scene.panel.of.size` is empty; it must be a list of length 3",
        ),
        (
            {"scene": {"panel": replace(PANEL, of=s.Button(size=(0.1, 5, 0.1)))}},
            "scene.panel.of.size[1]: the height of `scene.panel.of` is 5 m; it must be from 0.001 to 2 m",
        ),
        (
            {"scene": {"panel": replace(PANEL, at=(0, float("nan"), 0))}},
            "scene.panel.at[1]: the y position of `scene.panel` is NaN; it must be from -2 to 2 m",
        ),
        (
            {"scene": {"panel": replace(PANEL, tilt_deg=-float("inf"))}},
            "`scene.panel.tilt_deg` is -inf; it must be from 0 to 180 deg",
        ),
        (
            {"scene": {"panel": replace(PANEL, at={0.42, 0.1})}},
            "`scene.panel.at` is of type set, which cannot be written as text",
        ),
        ({"scene": {None: PANEL}}, "`scene` has the key None; keys are text"),
        (
            {"scene": {"a": PANEL, "b": {**PANEL.to_dict(), "row": 1}}},
            "unknown key `row` in `scene.b`; did you mean `rows`?",
        ),
        ({"scene": PANEL}, None),
        ({"script": s.Press(1)}, "`script` is a group of keys; it must be a list"),
        ({"script": [SMALL]}, None),
        ({"script": [s.Press()]}, "script: the script has no step; write what is to do, such as `- press: [1, 2]`"),
        ({"script": [s.Wait(1), s.Press(1, "9")]}, "script[1].press[1]: `9` is no object of the scene; valid are "),
        ({"time_limit_s": -1}, "`time_limit_s` is -1 s; it must be from 0.001 to 600 s"),
        ({"reward": {"distanc": 1}}, None),
        ({"technique": s.Ray(from_="nose")}, "technique.from: unknown value `nose` in `technique`; valid are "),
        ({"name": None}, "`name` is empty; it must be text"),
    ],
)
def test_wrong_values_give_the_sentence_of_the_reader(given, sentence):
    with pytest.raises(myoenv.TaskError) as error:
        build(**given)
    told = str(error.value)
    assert "\n" not in told and not re.search(r"\d:\d", told) and error.value.__cause__ is None
    if sentence is not None:
        assert told.startswith(sentence) and (told == sentence or sentence.endswith("are "))


def test_dictionaries_and_toml_have_the_same_sentences(tmp_path, short_task):
    short_task["targets"][0]["radius"] = 3
    sentence = "targets[0].radius: the radius of target 1 (pointing) is 3 m; it must be from 0.001 to 2 m"
    with pytest.raises(myoenv.TaskError, match=f"^{re.escape(sentence)}$"):
        myoenv.load_task(short_task)
    file = tmp_path / "task.toml"
    file.write_text('version = 2\nname = "a"\nscript = [{ press = 1 }]\n')
    with pytest.raises(myoenv.TaskError, match=rf"^{re.escape(str(file))}: script\[0\].press: `1` is no object"):
        myoenv.load_task(file)
    short_task["targets"].append(short_task)
    with pytest.raises(myoenv.TaskError, match="it has no end"):
        myoenv.load_task(short_task)


def test_what_is_out_of_reach_is_told_by_its_name(make):
    far = build(scene={"panel": replace(PANEL, at=(1.5, 0, 0))})
    with pytest.raises(myoenv.TaskError, match=r"^panel.1 is out of reach"):
        make(far)
    near = {"ball": s.Sphere(at=((0.3, 0.9), 0, 0), radius=0.05)}
    with pytest.warns(UserWarning, match=r"^(\d|muscles cannot).* of the range of ball"):
        make(build(scene=near, script=[s.Dwell("ball", for_s=0.1)]))
