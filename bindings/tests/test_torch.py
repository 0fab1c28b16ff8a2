"""Tensors, rsl_rl and skrl."""

import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed")

import torch

import myoenv
from myoenv.torch import TorchVectorEnv


def actions_like(envs, step: int) -> np.ndarray:
    shape = envs.action_space.shape
    return np.random.default_rng(step).uniform(-1, 1, shape).astype(np.float32)


def test_tensors_hold_what_the_arrays_hold(make, short_task):
    arrays = make(short_task, seed=3, autoreset="same_step")
    tensors = TorchVectorEnv(make(short_task, seed=3, autoreset="same_step"))
    obs, _ = arrays.reset()
    np.testing.assert_array_equal(tensors.reset()[0].numpy(), obs)
    for step in range(20):
        actions = actions_like(arrays, step)
        *expected, infos = arrays.step(actions)
        *got, tensor_infos = tensors.step(torch.from_numpy(actions))
        for one, other in zip(expected, got, strict=True):
            np.testing.assert_array_equal(one, other.numpy())
        assert ("ended" in tensor_infos) == bool(infos)
        if infos:
            ended = tensor_infos["ended"].numpy()
            np.testing.assert_array_equal(ended, np.flatnonzero(infos["_final_obs"]))
            np.testing.assert_array_equal(tensor_infos["final_obs"].numpy(), np.stack(infos["final_obs"][ended]))


def test_final_observations_are_those_before_the_reset(make, short_task):
    envs = TorchVectorEnv(make(short_task, seed=3, autoreset="same_step"))
    alone = make(short_task, seed=3, autoreset="disabled")
    envs.reset()
    alone.reset()
    for step in range(20):
        actions = actions_like(alone, step)
        _, _, terminated, truncated, infos = envs.step(torch.from_numpy(actions))
        expected = alone.step(actions)[0]
        if (terminated | truncated).any():
            np.testing.assert_array_equal(infos["final_obs"].numpy(), expected[infos["ended"].numpy()])
            return
    raise AssertionError("no episode ended")


def test_without_copies_the_memory_is_the_same(make):
    envs = TorchVectorEnv(make(copy=False))
    obs, _ = envs.reset()
    again, *_ = envs.step(torch.zeros(envs.num_envs, envs.num_actions))
    assert obs.data_ptr() == again.data_ptr()


def test_a_kept_tensor_does_not_change(make):
    envs = TorchVectorEnv(make())
    obs, _ = envs.reset()
    before = obs.clone()
    envs.step(torch.zeros(envs.num_envs, envs.num_actions))
    assert torch.equal(obs, before)


def test_a_mask_resets_some(make):
    envs = TorchVectorEnv(make(num_envs=4))
    before, _ = envs.reset(seed=1)
    mask = torch.tensor([True, False, False, True])
    after, _ = envs.reset(mask=mask)
    assert torch.equal((before != after).any(-1), mask)


def test_actions_with_a_gradient_are_taken(make):
    envs, alone = TorchVectorEnv(make(seed=1)), TorchVectorEnv(make(seed=1))
    envs.reset(), alone.reset()
    actions = torch.full((envs.num_envs, envs.num_actions), 0.5, requires_grad=True)
    obs, reward, *_ = envs.step(actions)
    expected = alone.step(actions.detach())
    assert torch.equal(obs, expected[0]) and torch.equal(reward, expected[1])
    assert not obs.requires_grad and actions.requires_grad


def test_bad_tensors_are_told(make):
    envs = TorchVectorEnv(make())
    envs.reset()
    for wrong, sentence in (
        (torch.zeros(8, 26, dtype=torch.int64), r"actions are of type torch\.int64, expected torch\.float32"),
        (torch.zeros(8, 26, dtype=torch.complex64), "actions are of type"),
        (torch.zeros(8, 25), r"shape \(8, 25\), expected \(8, 26\)"),
        (torch.full((8, 26), 1e300, dtype=torch.float64), "action 0 of environment 0 is inf"),
    ):
        with pytest.raises(myoenv.ActionError, match=sentence):
            envs.step(wrong)
    with pytest.raises(TypeError, match="actions is a ndarray; it must be a tensor"):
        envs.step(np.zeros((8, 26), np.float32))
    with pytest.raises(TypeError, match="mask is a list; it must be a tensor"):
        envs.reset(mask=[True] * 8)
    with pytest.raises(TypeError, match=r"it must be what myoenv\.make_vec returns"):
        TorchVectorEnv(myoenv.make("pointing"))
    envs.close()
    envs.close()
    with pytest.raises(myoenv.ClosedError):
        envs.step(torch.zeros(8, 26))


@pytest.fixture
def rsl_env(short_task):
    pytest.importorskip("rsl_rl", reason="rsl-rl-lib is not installed")
    from myoenv.rsl_rl import RslRlVecEnv

    env = RslRlVecEnv(short_task, 8, "cpu", seed=1)
    yield env
    env.close()


def test_rsl_rl_has_its_attributes(rsl_env):
    from rsl_rl.env import VecEnv

    assert isinstance(rsl_env, VecEnv)
    assert rsl_env.num_actions == 26
    assert rsl_env.max_episode_length == 8  # 0.4 s at 20 Hz
    observations = rsl_env.get_observations()
    assert observations["policy"].shape == (8, rsl_env.envs.single_observation_space.shape[0])
    assert observations.batch_size == (8,)


def test_rsl_rl_tells_time_outs_from_successes(rsl_env):
    seen = set()
    for step in range(40):
        actions = torch.from_numpy(actions_like(rsl_env.envs, step))
        _, reward, dones, extras = rsl_env.step(actions)
        assert reward.shape == dones.shape == (8,)
        assert not (extras["time_outs"] & ~dones.bool()).any()
        assert torch.equal(rsl_env.episode_length_buf == 0, dones.bool())
        if dones.any():
            assert torch.equal(extras["ended"], dones.nonzero().squeeze(-1))
            assert extras["final_obs"].shape == (int(dones.sum()), rsl_env.get_observations()["policy"].shape[1])
            share = 1 - float(extras["time_outs"].sum() / dones.sum())
            assert extras["log"]["/episode/success"] == pytest.approx(share)
            seen |= set(extras["time_outs"][dones.bool()].tolist())
    assert seen == {True, False}


def test_rsl_rl_refuses_episodes_that_begin_in_their_middle(rsl_env):
    with pytest.raises(ValueError, match="init_at_random_ep_len=False"):
        rsl_env.episode_length_buf = torch.zeros(8)


def test_rsl_rl_tells_bad_actions_and_closed_environments(rsl_env):
    with pytest.raises(myoenv.ActionError, match="action 0 of environment 0 is NaN"):
        rsl_env.step(torch.full((8, 26), torch.nan))
    rsl_env.close()
    rsl_env.close()
    with pytest.raises(myoenv.ClosedError):
        rsl_env.step(torch.zeros(8, 26))


def test_skrl_takes_the_vector_environment(make):
    pytest.importorskip("skrl", reason="skrl is not installed")
    from skrl.envs.wrappers.torch import wrap_env

    plain = make(seed=1, autoreset="same_step")
    envs = wrap_env(plain, wrapper="gymnasium")
    first, _ = envs.reset()
    assert first.shape == (8, *envs.observation_space.shape)
    state, actions = plain.save_state(), torch.from_numpy(actions_like(plain, 1))
    *wrapped, _ = envs.step(actions)
    plain.load_state(state)
    obs, *columns, _ = plain.step(actions.numpy())
    for got, expected in zip(wrapped, [obs, *(column[:, np.newaxis] for column in columns)], strict=True):
        np.testing.assert_array_equal(got.numpy(), expected)
