"""MyoSuite's environments do what MyoSuite's do.

`references/myosuite.npz` holds the beginning of an episode of each, under actions of chance, as MyoSuite 3.0.0 does it
(`myosuite_data.py` records it).
"""

from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import myoenv
from myoenv import myosuite

REFERENCE = np.load(Path(__file__).parent / "references/myosuite.npz")
SEED = 3


def recorded(env_id):
    names = ("observations", "rewards", "terminated", "solved", "actions")
    return tuple(REFERENCE[f"{env_id}/{name}"] for name in names)


def test_there_are_poses_and_reaches_of_four_bodies():
    assert len(myosuite.ids()) == 22
    assert myosuite.SUITE == {"myosuite": "3.0.0", "myo-sim": "0.2.3", "mujoco": "4.0.0"}
    sizes = {name: (len(myosuite.load_body(name).tables()["muscle_force"])) for name in ("myoelbow", "myohand")}
    assert sizes == {"myoelbow": 6, "myohand": 39}


@pytest.mark.parametrize("env_id", myosuite.ids())
def test_episodes_are_those_of_myosuite(env_id):
    observations, rewards, terminated, solved, actions = recorded(env_id)
    env = myosuite.make(env_id)
    observation, _ = env.reset(seed=SEED)
    # The same draws: only rounding to single precision differs.
    assert np.abs(observation - observations[0]).max() < 1e-6
    # A light finger multiplies what single precision rounds off.
    most = 5e-4 if env.task["body"] == "myofinger" else 1e-4
    for step, action in enumerate(actions):
        observation, reward, over, truncated, info = env.step(action)
        assert np.abs(observation - observations[step + 1]).max() < (most if step else 1e-5), step
        assert abs(reward - rewards[step]) < most, step
        assert (over, info["solved"]) == (terminated[step], solved[step]), step
        assert not truncated


def test_double_precision_is_as_near_as_the_record():
    # Of one body without coupled joints, for which the reference of this library is in double precision.
    *_, actions = recorded("myoFingerPoseFixed-v0")
    observations = recorded("myoFingerPoseFixed-v0")[0]
    body = myoenv.Simulation(myosuite.load_body("myofinger"))
    for step, action in enumerate(actions):
        excitation = (1 / (1 + np.exp(-5 * (action - np.float32(0.5))))).astype(np.float32)
        body.step(excitation.astype(float), 10)
        assert np.abs(body.qpos - observations[step + 1][:4]).max() < 1e-6, step


@pytest.mark.filterwarnings("ignore:.*Box observation space m.*imum value is.*infinity")
def test_gymnasium_finds_no_fault():
    env = gymnasium.make("myosuite/myoElbowPose1D6MRandom-v0")
    check_env(env.unwrapped, skip_render_check=True)
    env.reset(seed=1)
    for step in range(100):
        *_, terminated, truncated, _ = env.step(env.action_space.sample())
        assert not terminated and truncated == (step == 99)


@pytest.mark.parametrize("autoreset", ["next_step", "same_step", "disabled"])
@pytest.mark.parametrize("env_id", ["myoElbowPose1D6MRandom-v0", "myoHandReachRandom-v0"])
def test_many_keep_their_promises(env_id, autoreset):
    envs = myosuite.make_vec(env_id, 5, autoreset=autoreset)
    assert myoenv.check_vec_env(envs, steps=200)[-1] == "autoreset"


def test_each_of_many_is_one_alone():
    env_id = "myoFingerPoseRandom-v0"
    envs = gymnasium.make_vec(f"myosuite/{env_id}", num_envs=20, vectorization_mode="vector_entry_point")
    observations, _ = envs.reset(seed=5)
    alone = myosuite.make(env_id)
    rng = np.random.default_rng(1)
    actions = rng.uniform(-1, 1, (10, *envs.action_space.shape)).astype(np.float32)
    observation, _ = alone.reset(seed=5 + 13)
    assert np.array_equal(observations[13], observation)
    for action in actions:
        observations, rewards, *_ = envs.step(action)
        observation, reward, *_ = alone.step(action[13])
        assert np.array_equal(observations[13], observation) and rewards[13] == reward


def test_a_hand_that_is_too_far_ends_and_begins_anew():
    envs = myosuite.make_vec("myoHandReachFixed-v0", 3, seed=1)
    envs.reset()
    first = recorded("myoHandReachFixed-v0")[0][0]
    for action in recorded("myoHandReachFixed-v0")[-1]:
        *_, terminated, truncated, infos = envs.step(np.tile(action, (3, 1)))
    assert terminated.all() and not truncated.any() and (infos["penalty"] == -1).all() and infos["_penalty"].all()
    observations, rewards, terminated, _, infos = envs.step(np.ones_like(envs.action_space.sample()))
    assert np.abs(observations - first).max() < 1e-6 and not rewards.any() and not terminated.any()
    assert not infos["_penalty"].any()


def test_a_body_that_flies_apart_ends_alone():
    envs, others = (myosuite.make_vec("myoElbowPose1D6MRandom-v0", 3, seed=1) for _ in range(2))
    envs.reset()
    others.reset()
    core = envs._core
    core.bodies.set(np.array([1]), np.zeros((1, 1)), np.full((1, 1), 1e30), np.zeros((1, 6)))
    actions = np.zeros((3, 6), np.float32)
    observations, rewards, terminated, truncated, _ = envs.step(actions)
    assert list(terminated) == [False, True, False] and not truncated.any()
    assert np.isfinite(observations).all() and np.isfinite(rewards).all()
    assert np.array_equal(observations[[0, 2]], others.step(actions)[0][[0, 2]])


def test_success_is_more_than_five_steps_that_are_solved():
    envs = myosuite.make_vec("myoElbowPose1D6MFixed-v0", 2, seed=1, max_episode_steps=7)
    envs.reset()
    # Held at the target by hand: one all the time, the other for five steps.
    for step in range(7):
        poses = np.array([[2.0], [2.0 if step < 5 else 0.5]])
        envs._core.bodies.set(np.arange(2), poses, np.zeros((2, 1)), np.zeros((2, 6)))
        _, _, terminated, truncated, infos = envs.step(np.full((2, 6), -1, np.float32))
    assert truncated.all() and not terminated.any()
    assert list(infos["summary"]["success"]) == [1, 0] and list(infos["summary"]["length"]) == [7, 7]
    with pytest.raises(ValueError, match="max_episode_steps is 0; it must be at least 1"):
        myosuite.make_vec("myoElbowPose1D6MFixed-v0", 2, max_episode_steps=0)


def test_the_last_step_may_end_in_two_ways():
    actions = recorded("myoHandReachFixed-v0")[-1]
    envs = myosuite.make_vec("myoHandReachFixed-v0", 1, seed=1, max_episode_steps=len(actions))
    alone = gymnasium.make("myosuite/myoHandReachFixed-v0", max_episode_steps=len(actions))
    envs.reset(seed=3)
    alone.reset(seed=3)
    for action in actions:
        *_, terminated, truncated, _ = envs.step(action[np.newaxis])
        *_, one_terminated, one_truncated, _ = alone.step(action)
    assert (terminated[0], truncated[0]) == (one_terminated, one_truncated) == (True, True)


def test_what_is_not_there_is_said():
    with pytest.raises(ValueError, match=r"no environment 'myoElbowPose1D6M-v0' .* did you mean myoElbowPose1D6M"):
        myosuite.make("myoElbowPose1D6M-v0")
    with pytest.raises(ValueError, match="there is no body 'myolegs' of MyoSuite here; there are myoarm, myoelbow"):
        myosuite.load_body("myolegs")
    with pytest.raises(ValueError, match="num_envs is 0; it must be at least 1"):
        myosuite.make_vec("myoFingerPoseFixed-v0", 0)
    env = myosuite.make("myoFingerPoseFixed-v0")
    with pytest.raises(myoenv.ActionError, match=r"actions have the shape \(4,\), expected \(5,\)"):
        env.step(np.zeros(4, np.float32))
    with pytest.raises(ValueError, match="unknown option 'pose'; there is none"):
        env.reset(options={"pose": 1})
    envs = myosuite.make_vec("myoFingerPoseFixed-v0", 2, autoreset="disabled")
    with pytest.raises(myoenv.NeedsResetError, match="environment 0 has ended or not begun; reset it first"):
        envs.step(np.zeros((2, 5), np.float32))


def test_bodies_refuse_what_they_cannot_take():
    body = myosuite.load_body("myofinger")
    for count, threads, refused in (
        (0, None, "num_bodies is 0"),
        (10**15, None, "num_bodies is"),
        (3, 0, "threads is 0"),
    ):
        with pytest.raises(ValueError, match=f"{refused}.*; it must be from 1 to"):
            myoenv.Bodies(body, count, threads=threads)
    bodies = myoenv.Bodies(body, 3)
    assert bodies.joint_names == ["IFadb", "IFmcp", "IFpip", "IFdip"] and bodies.timestep == 0.002
    with pytest.raises(ValueError, match=r"ctrl has the shape \[2, 5\], expected \[3, 5\]"):
        bodies.step(np.zeros((2, 5), np.float32))
    with pytest.raises(ValueError, match=r"ctrl\[1, 2\] is NaN; it must be finite"):
        ctrl = np.zeros((3, 5), np.float32)
        ctrl[1, 2] = np.nan
        bodies.step(ctrl)
    rest = (np.zeros((1, 4)), np.zeros((1, 4)), np.zeros((1, 5)))
    with pytest.raises(ValueError, match="there is no body 3 of 3"):
        bodies.set(np.array([3]), *rest)
    with pytest.raises(ValueError, match="the body has no site `tip`"):
        bodies.site_positions(["tip"])
    for what, at, refused in (("qpos", 0, 1e39), ("activation", 2, 5.0), ("activation", 2, -0.5)):
        given = [array.copy() for array in rest]
        given[at][0, 1] = refused
        with pytest.raises(ValueError, match=rf"{what}\[0, 1\] is .*; it must be"):
            bodies.set(np.array([0]), *given)
    before = bodies.site_positions(["IFtip"])
    bodies.set(np.array([1]), np.full((1, 4), 0.3), *rest[1:])
    after = bodies.site_positions(["IFtip"])
    moved = np.abs(after - before).max(axis=(1, 2))
    assert moved[1] > 0.01 and moved[0] == moved[2] == 0
    with pytest.raises(TypeError, match="bodies cannot be pickled"):
        __import__("pickle").dumps(bodies)
