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

from myoenv.sb3 import MyoSuiteVecEnv, MyoVecEnv


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
        assert observation.shape == (16, 57) and reward.dtype == np.float32 and done.dtype == bool
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


def test_ppo_updates_its_policy(short_task):
    env = VecNormalize(MyoVecEnv(short_task, 32, "cpu", seed=1))
    model = PPO("MlpPolicy", env, n_steps=16, batch_size=128, n_epochs=1, seed=1, device="cpu")
    before = {name: tensor.clone() for name, tensor in model.policy.state_dict().items()}
    model.learn(1024)
    assert model.num_timesteps == 1024 and env.obs_rms.count > 1024
    after = model.policy.state_dict()
    assert all(tensor.isfinite().all() for tensor in after.values())
    assert {name for name in after if not after[name].equal(before[name])} == set(after)
    # Every environment had ended an episode of 8 steps by then.
    assert len(model.ep_info_buffer) >= 32 and all(0 < info["l"] <= 8 for info in model.ep_info_buffer)
    action, _ = model.predict(env.reset(), deterministic=True)
    assert action.shape == (32, 26) and (abs(action) <= 1).all()


def test_myosuite_is_learnt_as_others_are():
    env = MyoSuiteVecEnv("myoHandReachRandom-v0", 6, seed=1)
    env.reset()
    ended = []
    for _ in range(110):
        observation, _, done, infos = env.step(np.full((6, 39), 1, np.float32))
        assert [bool(info) for info in infos] == list(done)
        ended += [info for info in infos if info]
        assert observation.shape == (6, 115)
    assert len(ended) >= 6 and all(one["episode"]["l"] == one["summary"]["length"] <= 100 for one in ended)
    assert all(one["TimeLimit.truncated"] == (one["episode"]["l"] == 100) for one in ended)
    agent = PPO(
        "MlpPolicy", MyoSuiteVecEnv("myoElbowPose1D6MRandom-v0", 16, seed=1), n_steps=120, batch_size=240, seed=1
    )
    agent.learn(4000)
    assert agent.ep_info_buffer and all(one["l"] == 100 for one in agent.ep_info_buffer)
