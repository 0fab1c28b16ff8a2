"""What Gymnasium expects."""

import pickle
import warnings

import gymnasium
import numpy as np
import pytest
from conftest import MODES, relaxed
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from gymnasium.vector.utils import batch_space
from gymnasium.wrappers.vector import NormalizeObservation, RecordEpisodeStatistics

import myoenv


@pytest.mark.parametrize("preset", myoenv.preset_names())
def test_check_env_has_nothing_to_say(preset):
    env = gymnasium.make(myoenv.env_id(preset), render_mode="rgb_array")
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        check_env(env.unwrapped)
    assert [str(warning.message) for warning in said] == []
    env.close()


@pytest.mark.parametrize("preset", myoenv.preset_names())
def test_presets_are_registered_as_vectors(preset):
    envs = gymnasium.make_vec(myoenv.env_id(preset), num_envs=3, autoreset="same_step", backend="cpu")
    assert isinstance(envs.unwrapped, myoenv.MyoVectorEnv)
    assert envs.metadata["autoreset_mode"] is AutoresetMode.SAME_STEP
    assert envs.reset(seed=1)[0].shape == (3, *envs.single_observation_space.shape)
    envs.close()


@pytest.mark.parametrize("mode", MODES)
def test_our_own_checker_passes(make, short_task, mode):
    assert myoenv.check_vec_env(make(short_task, autoreset=mode))[-1] == "autoreset"


@pytest.mark.parametrize("preset", myoenv.preset_names())
def test_observations_of_violent_movements_lie_in_the_space(make, preset):
    env = make(preset, 64, seed=1, autoreset="same_step")
    env.reset()
    env.action_space.seed(1)
    for k in range(120):
        if k % 15 == 0:
            actions = np.sign(env.action_space.sample())
        assert env.step(actions)[0] in env.observation_space


def test_observations_of_a_user_who_misjudges_lie_in_the_space(make, short_task):
    envs = make({**short_task, "user": "human", "model": "myo-arm"}, 64, seed=1, autoreset="same_step")
    assert envs.reset()[0] in envs.observation_space
    space, names = envs.single_observation_space, envs.observation_names
    bounded = np.abs(space.high) < np.finfo(np.float32).max
    assert not bounded[names.index("target_position.y")] and not bounded[names.index("target_vector.y")]
    assert all(
        bounded[k] for k, name in enumerate(names) if name.startswith(("control", "activation", "target_direction"))
    )
    sees = {**short_task, "user": "human", "model": "myo-arm", "perception": {"vision_noise": 0}}
    seen = make(sees, 1).single_observation_space
    assert np.isclose(seen.high[names.index("target_position.y")], 0.1, atol=1e-4)


def test_tired_muscles_are_felt_within_the_space(make, short_task):
    envs = make({**short_task, "fatigue": {"speed": 100, "initial_max": 0.8}}, 16, seed=1)
    observation, _ = envs.reset()
    tired = [k for k, name in enumerate(envs.observation_names) if name.startswith("fatigue.")]
    assert len(tired) == envs.single_action_space.shape[0]
    space = envs.single_observation_space
    assert np.allclose(space.low[tired], 0, atol=1e-4) and np.allclose(space.high[tired], 1, atol=1e-4)
    after, *_ = envs.step(np.ones(envs.action_space.shape, np.float32))
    assert observation in envs.observation_space and after in envs.observation_space
    assert after[:, tired].mean() > observation[:, tired].mean() > 0.3


def test_environment_i_of_a_seed_is_the_single_one_of_seed_plus_i(make):
    rows, _ = make(num_envs=20).reset(seed=5)
    single = myoenv.make("pointing-single")
    for i in (0, 3, 19):
        assert np.array_equal(single.reset(seed=5 + i)[0], rows[i])


def test_seeds_may_be_listed_with_gaps(make):
    env = make(num_envs=4)
    listed, _ = env.reset(seed=[9, None, 9, 2])
    assert np.array_equal(listed[0], listed[2]) and not np.array_equal(listed[0], listed[3])
    assert np.array_equal(listed[3], myoenv.make("pointing-single").reset(seed=2)[0])


def test_the_constructor_s_seed_is_that_of_the_first_reset(make):
    env, other = make(seed=3), make()
    assert np.array_equal(env.reset()[0], other.reset(seed=3)[0])
    assert np.array_equal(env.reset()[0], other.reset()[0])
    assert not np.array_equal(make().reset()[0], make().reset()[0])


def test_random_actions_fill_the_action_space(make):
    space = make(num_envs=500).action_space
    space.seed(3)
    state = pickle.dumps(space)
    actions = space.sample()
    assert actions in space and actions.dtype == np.float32 and space == batch_space(make().single_action_space, 500)
    assert actions.min() < -0.99 and actions.max() > 0.99 and abs(actions.mean()) < 0.02
    assert np.array_equal(actions, pickle.loads(state).sample()) and not np.array_equal(actions, space.sample())


def test_random_generators_follow_the_seed(make):
    env = make()
    env.reset(seed=11)
    assert env.np_random_seed == 11
    first = env.np_random.random()
    env.reset(seed=11)
    assert env.np_random.random() == first


def test_same_step_keeps_the_last_observation(make, short_task):
    env = make(short_task, 32, seed=1, autoreset="same_step")
    env.reset()
    for _ in range(8):
        _, _, terminated, truncated, infos = env.step(relaxed(env))
        if infos:
            break
    done = terminated | truncated
    assert np.array_equal(infos["_final_obs"], done) and np.array_equal(infos["_final_info"], done)
    left = env.observation_names.index("time_left")
    for env_index in np.flatnonzero(done):
        length = infos["final_info"]["episode"]["l"][env_index]
        assert infos["final_obs"][env_index][left] == pytest.approx(1 - length / 8, abs=1e-6)
    assert np.array_equal(infos["final_info"]["summary"]["success"][done] > 0.5, terminated[done])


def test_episode_statistics_agree_with_gymnasium_s_wrapper(make, short_task):
    env = RecordEpisodeStatistics(make(short_task, 16, seed=1))
    env.reset()
    seen = 0
    for _ in range(20):
        infos = env.step(relaxed(env))[4]
        if "summary" in infos:
            done = infos["_summary"]
            np.testing.assert_allclose(infos["episode"]["r"][done], infos["summary"]["return"][done], rtol=1e-5)
            np.testing.assert_array_equal(infos["episode"]["l"][done], infos["summary"]["length"][done])
            seen += done.sum()
    assert seen >= 16


def test_gymnasium_s_wrappers_take_it(make):
    env, plain = NormalizeObservation(make(num_envs=4)), make(num_envs=4)
    env.reset(seed=1), plain.reset(seed=1)
    for _ in range(3):
        actions = plain.action_space.sample()
        normalised, observation = env.step(actions)[0], plain.step(actions)[0]
        expected = (observation - env.obs_rms.mean) / np.sqrt(env.obs_rms.var + env.epsilon)
        np.testing.assert_allclose(normalised, expected, rtol=1e-4, atol=1e-5)


def test_states_go_back_bit_for_bit(make):
    env = make(seed=4)
    env.reset()
    state = env.save_state()
    actions = env.action_space.sample()
    first = env.step(actions)
    env.load_state(state)
    again = env.step(actions)
    assert all(np.array_equal(a, b) for a, b in zip(first[:4], again[:4], strict=True))


def test_threads_do_not_change_results(make):
    runs = []
    for threads in (None, 1, 3):
        env = make(num_envs=50, seed=2, threads=threads)
        env.action_space.seed(0)
        env.reset()
        runs.append(np.array([env.step(env.action_space.sample())[0] for _ in range(5)]))
    assert np.array_equal(runs[0], runs[1]) and np.array_equal(runs[0], runs[2])


def test_without_copies_the_arrays_stay_the_same(make):
    env, copies = make(seed=1, copy=False), make(seed=1)
    first, _ = env.reset()
    copies.reset()
    actions = env.action_space.sample()
    answer, copied = env.step(actions), copies.step(actions)
    assert answer[0] is first
    assert all(np.array_equal(a, b) for a, b in zip(answer[:4], copied[:4], strict=True))


def in_place(observation: np.ndarray, count: int) -> np.ndarray:
    """Actions computed where an observation is: a contiguous view of its beginning, 26 for each environment."""
    actions = observation.reshape(-1)[: count * 26].reshape(count, 26)
    np.clip(actions, -1, 1, out=actions)
    return actions


@pytest.mark.parametrize("output", ["the first numbers", "the last numbers"])
def test_without_copies_actions_may_be_computed_in_place_of_outputs(make, output):
    env, copies = make(num_envs=40, seed=1, copy=False), make(num_envs=40, seed=1)
    observation, _ = env.reset()
    copies.reset()
    for _ in range(5):
        numbers = observation if output == "the first numbers" else observation[18:]
        actions = in_place(numbers, 40)
        assert np.shares_memory(actions, observation)
        expected = copies.step(actions.copy())
        observation, *others, _ = env.step(actions)
        for got, right in zip((observation, *others), expected[:4], strict=True):
            assert np.array_equal(got, right)


def test_arrays_are_writable_and_go_through_dlpack(make):
    observation, _ = make().reset(seed=1)
    assert observation.flags.writeable and observation.flags.owndata
    assert np.array_equal(np.from_dlpack(observation), observation)


def test_pictures_show_targets(make, short_task):
    def picture(radius: float) -> np.ndarray:
        short_task["targets"][0]["radius"] = radius
        env = make(short_task, 1, render_mode="rgb_array", render_size=(320, 240))
        env.reset(seed=1)
        return env.render()[0]

    small, large = ((picture(radius) != picture(0.01)).any(-1).sum() for radius in (0.05, 0.2))
    # The arm is the same, and the area of a ball grows with the square of its radius; the arm may cover some of it.
    assert 500 < 4 * small < large < 240 * 320 / 2


def test_pictures_show_the_arm(make):
    env = make("ar", 3, seed=1, render_mode="rgb_array", render_size=(320, 240))
    env.reset()
    frames = env.render()
    assert len(frames) == 3 and all(frame.shape == (240, 320, 3) and frame.dtype == np.uint8 for frame in frames)
    # Different arms before the same buttons.
    assert not np.array_equal(frames[0], frames[1])
    assert len(np.unique(frames[0].reshape(-1, 3), axis=0)) > 50
    assert make().render() is None
