"""Every wrong call is an exception with one sentence."""

import os
import threading

import gymnasium
import numpy as np
import pytest

import myoenv


def bad_actions(shape):
    good = np.zeros(shape, np.float32)
    nan, infinite = good.copy(), good.copy()
    nan[2, 3], infinite[0, 0] = np.nan, np.inf
    return {
        "one row too few": good[1:],
        "flat": good.ravel(),
        "a scalar": 0.5,
        "none": None,
        "text": "relax",
        "ragged": [[0.0], [0.0, 1.0]],
        "integers": good.astype(np.int32),
        "booleans": good.astype(bool),
        "complex": good.astype(np.complex64),
        "objects": good.astype(object),
        "not a number": nan,
        "infinite": infinite,
        "another axis": good[..., np.newaxis],
        "dates": good.astype("datetime64[s]"),
        "too large for float32": good.astype(np.float64) + 1e300,
    }


@pytest.mark.parametrize("case", bad_actions((8, 26)))
def test_bad_actions_are_refused_and_change_nothing(make, case):
    env = make(seed=1)
    env.reset()
    before = env.save_state()
    with pytest.raises(myoenv.ActionError) as error:
        env.step(bad_actions(env.action_space.shape)[case])
    assert "\n" not in str(error.value)
    assert env.save_state() == before


def test_the_sentence_tells_where_an_action_is_not_finite(make):
    env = make()
    with pytest.raises(ValueError, match="action 3 of environment 2 is NaN"):
        env.step(bad_actions(env.action_space.shape)["not a number"])


def test_actions_out_of_range_are_clipped(make):
    """Of any size that is finite."""
    env = make(seed=1)
    env.reset()
    state, actions = env.save_state(), env.action_space.sample()
    expected = env.step(np.sign(actions))[0]
    for factor in (1e3, 1e30):
        env.load_state(state)
        assert np.array_equal(env.step(np.sign(actions) * np.float32(factor))[0], expected)
    env.load_state(state)
    assert not np.array_equal(env.step(actions)[0], expected)


def test_other_floats_and_layouts_are_converted(make):
    env, reference = make(seed=1), make(seed=1)
    env.reset(), reference.reset()
    actions = reference.action_space.sample()
    expected = reference.step(actions)[0]
    state = env.save_state()
    for same in (
        actions.astype(np.float64),
        np.asfortranarray(actions),
        actions.tolist(),
        np.repeat(actions, 2, 0)[::2],
    ):
        env.load_state(state)
        assert np.array_equal(env.step(same)[0], expected)


@pytest.mark.parametrize(
    ("kwargs", "sentence"),
    [
        ({"num_envs": 0}, "num_envs is 0"),
        ({"num_envs": -3}, "num_envs is -3"),
        ({"num_envs": 2.5}, "num_envs is 2.5"),
        ({"num_envs": True}, "num_envs is True"),
        ({"autoreset": "never"}, "autoreset is 'never'"),
        ({"backend": "tpu"}, "tpu"),
        ({"backend": "cpu", "device": "rtx"}, "names a graphics card"),
        ({"seed": -1}, "seed is -1"),
        ({"seed": 2**64}, "seed is 18446744073709551616"),
        ({"seed": 1.5}, "seed is 1.5"),
        ({"threads": 0}, "threads is 0"),
        ({"threads": 10**6}, "threads is 1000000; it must be at most 1024"),
        ({"num_envs": 10**12}, "num_envs is 1000000000000; it must be at most"),
        ({"autoreset": []}, r"autoreset is \[\]"),
        ({"backend": None}, "backend is None; it must be a string"),
        ({"device": 1.5}, "device is 1.5; it must be a string"),
        ({"render_size": 64}, "render_size is 64; it must be width and height"),
        ({"render_size": (-3, 64)}, "render_size is -3 x 64; sizes are 16 to 4096 pixels"),
        ({"render_size": (64.5, 64)}, "render_size is 64.5; it must be a whole number"),
        ({"task": "a\0b.toml"}, "cannot read"),
        ({"render_mode": "human"}, "render_mode is 'human'"),
        ({"task": "pionting"}, "did you mean `pointing`"),
        ({"task": 3}, "a task is a name"),
        ({"task": "no/such/file.yaml"}, "cannot read"),
        ({"task": "no/such/file.toml"}, "cannot read"),
        ({"task": {"version": 1}}, "`name` is missing"),
        ({"task": {"version": 1, "name": "x", "targets": []}}, "no target"),
        ({"task": {"version": object()}}, "cannot be written as text"),
        ({"model": "no-such-arm"}, "no built-in model"),
    ],
)
def test_bad_arguments(kwargs, sentence):
    arguments = {"task": "pointing-single", "num_envs": 2, **kwargs}
    with pytest.raises((ValueError, TypeError), match=sentence):
        myoenv.make_vec(**arguments)


@pytest.mark.parametrize(
    ("seed", "options", "sentence"),
    [
        ([1, 2], None, "2 seeds for 8"),
        ("abc", None, "whole number"),
        (-1, None, "seed is -1"),
        (None, {"mask": 1}, "unknown option 'mask'"),
        (None, "reset_mask", "options is 'reset_mask'; it must be a dictionary"),
        (None, {"reset_mask": [True] * 8}, "NumPy array"),
        (None, {"reset_mask": np.ones(8)}, "must be bool"),
        (None, {"reset_mask": np.ones(7, bool)}, "expected"),
        (None, {"reset_mask": np.zeros(8, bool)}, "at least one"),
    ],
)
def test_bad_resets(make, seed, options, sentence):
    with pytest.raises((ValueError, TypeError), match=sentence):
        make().reset(seed=seed, options=options)


def test_bad_files_are_told_by_their_names(tmp_path):
    for name in ("bytes.toml", "bytes.yaml"):
        (tmp_path / name).write_bytes(b"\xff\xfe\x00")
        with pytest.raises(myoenv.TaskError, match=name):
            myoenv.load_task(tmp_path / name)
    with pytest.raises(myoenv.TaskError, match=r"bytes\.yaml"):
        myoenv.load_model(tmp_path / "bytes.yaml")


def test_one_environment_refuses_what_many_refuse():
    env = myoenv.make("pointing-single")
    cases = {
        "shape (25,), expected": np.zeros(25),
        r"shape \(1, 26\), expected \(26,\)": np.zeros((1, 26)),
        "cannot be made an array": [[1.0], [1.0, 2.0]],
        "of type int64": np.zeros(26, np.int64),
        "action 0 of environment 0 is NaN": np.full(26, np.nan),
    }
    env.reset(seed=1)
    for sentence, actions in cases.items():
        with pytest.raises(myoenv.ActionError, match=sentence.replace("(25,)", r"\(25,\)")):
            env.step(actions)
    with pytest.raises(ValueError, match="unknown option 'reset_mask'; there is none"):
        env.reset(options={"reset_mask": np.ones(1, bool)})
    with pytest.raises(TypeError, match="seed is"):
        env.reset(seed=[1])


def test_pictures_and_states_that_are_not_there(make):
    env = make(num_envs=4)
    for index in (-1, 4):
        with pytest.raises(ValueError, match=f"env is {index}; it must be from 0 to 3"):
            env.render_env(index)
    for start, stop in ((-1, 2), (3, 2), (0, 5), (5, None)):
        with pytest.raises(ValueError, match=f"environments {start} to {stop or 4} are asked for; .* from 0 to 4"):
            env.peek(start, stop)
    with pytest.raises(TypeError, match="start is 'half'; it must be a whole number"):
        env.peek("half")
    for state in (None, "state", np.zeros(3)):
        with pytest.raises(TypeError, match="a state is what save_state returned, bytes"):
            env.load_state(state)


def test_what_the_body_cannot_do_is_refused(short_task):
    short_task["targets"][0]["position"] = {"x": 1.9, "y": 0, "z": 0}
    with pytest.raises(myoenv.TaskError, match=r"out of reach .*; move its centre \d+\.\d cm to \(0\.\d+, .* back"):
        myoenv.make_vec(short_task, 2)


def test_closing_twice_is_fine_and_use_after_it_is_not(make):
    env = make()
    env.close()
    env.close()
    for use in (
        env.reset,
        lambda: env.step(env.action_space.sample()),
        env.save_state,
        env.peek,
        lambda: env.render_env(0),
    ):
        with pytest.raises(myoenv.ClosedError, match="closed"):
            use()
    single = gymnasium.make("myo/PointingSingle-v0")
    single.close()
    single.close()
    with pytest.raises(myoenv.ClosedError):
        single.unwrapped.reset()


def test_a_constructor_that_fails_leaves_nothing_to_close():
    env = myoenv.MyoVectorEnv.__new__(myoenv.MyoVectorEnv)
    with pytest.raises(ValueError, match="num_envs"):
        env.__init__("pointing", 0)
    env.close()


def test_a_finished_environment_is_not_stepped_without_autoreset(make, short_task):
    env = make(short_task, autoreset="disabled")
    env.reset(seed=1)
    relax, ended = np.full(env.action_space.shape, -1.0), np.zeros(8, bool)
    for _ in range(8):
        if not ended.any():
            _, _, terminated, truncated, _ = env.step(relax)
            ended = terminated | truncated
    assert ended.any()
    for _ in range(2):
        with pytest.raises(myoenv.NeedsResetError, match="reset it"):
            env.step(relax)
    env.reset(options={"reset_mask": ended})
    assert env.step(relax)[0].shape[0] == 8


def test_two_threads_on_one_environment_are_told(make):
    env = make(num_envs=256)
    env.reset()
    actions, errors = env.action_space.sample(), []
    thread = threading.Thread(target=env._env.time_steps, args=(actions, 50))
    thread.start()
    while thread.is_alive():
        try:
            env.step(actions)
        except myoenv.BusyError as error:
            errors.append(str(error))
    assert errors and all("another thread" in error for error in errors)
    # The environment is free again.
    assert env.step(actions)[0].shape == (256, len(env.observation_names))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning", "ignore:os.fork:RuntimeWarning")
def test_after_a_fork_the_child_is_told_and_can_make_its_own(make):
    env = make(num_envs=64)
    env.reset(seed=1)
    child = os.fork()
    if child == 0:
        code = 1
        try:
            env.step(env.action_space.sample())
        except myoenv.ForkedError:
            env.close()
            own = myoenv.make_vec("pointing-single", 64, "cpu")
            own.reset(seed=1)
            own.step(own.action_space.sample())
            code = 0
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    # The parent's goes on.
    env.step(env.action_space.sample())


def test_states_of_others_are_refused(make):
    env = make()
    for state in (b"", b"x" * 100, make(num_envs=3).save_state()):
        with pytest.raises(ValueError, match="does not fit"):
            env.load_state(state)
