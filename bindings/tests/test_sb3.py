"""Stable-Baselines3."""

import warnings

import gymnasium
import numpy as np
import pytest

import myoenv

pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 is not installed")

from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.vec_env import VecNormalize

from myoenv.sb3 import MyoVecEnv


def test_its_checker_has_nothing_to_say():
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        check_env(gymnasium.make("myo/Pointing-v0", render_mode="rgb_array").unwrapped)
    assert [str(warning.message) for warning in said] == []


def test_ends_of_episodes_are_told(short_task):
    env = MyoVecEnv(short_task, 16, "cpu", seed=1)
    env.reset()
    ended = 0
    for _ in range(20):
        observation, reward, done, infos = env.step(np.full((16, 26), -1, np.float32))
        assert observation.shape == (16, 54) and reward.dtype == np.float32 and done.dtype == bool
        for i, info in enumerate(infos):
            assert bool(info) == done[i]
            if done[i]:
                assert not np.array_equal(info["terminal_observation"], observation[i])
                assert info["TimeLimit.truncated"] != info["is_success"]
                assert info["episode"]["l"] == info["summary"]["length"]
                ended += 1
    assert ended >= 16
    env.close()


def test_seeds_attributes_and_pictures():
    env = MyoVecEnv("pointing-single", 3, "cpu", render_mode="rgb_array", render_size=(64, 48))
    assert env.get_attr("render_mode") == ["rgb_array"] * 3 and env.get_attr("control_dt", 1) == [0.05]
    env.seed(5)
    first = env.reset()
    env.seed(5)
    assert np.array_equal(first, env.reset()) and not np.array_equal(first, env.reset())
    assert len(env.get_images()) == 3 and env.render().shape == (96, 128, 3)
    with pytest.raises(ValueError, match="all environments"):
        env.set_attr("render_size", (32, 32), indices=0)
    env.close()


def test_bad_calls_are_told():
    env = MyoVecEnv("pointing-single", 3, "cpu")
    for seed, error in ((-1, ValueError), ("one", TypeError)):
        with pytest.raises(error, match="seed is"):
            env.seed(seed)
    env.set_options({"mask": 1})
    with pytest.raises(ValueError, match="unknown option 'mask'"):
        env.reset()
    env.reset()
    with pytest.raises(myoenv.ActionError, match="expected"):
        env.step(np.zeros((2, 26), np.float32))
    env.close()
    env.close()
    with pytest.raises(myoenv.ClosedError):
        env.reset()


def test_ppo_learns_a_little():
    env = VecNormalize(MyoVecEnv("pointing-single", 32, "cpu", seed=1))
    model = PPO("MlpPolicy", env, n_steps=8, batch_size=128, n_epochs=1, seed=1, device="cpu")
    model.learn(512)
    action, _ = model.predict(env.reset(), deterministic=True)
    assert action.shape == (32, 26)
