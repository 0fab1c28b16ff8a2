"""JAX and the Brax-style interface."""

import gc

import numpy as np
import pytest

pytest.importorskip("jax", reason="JAX is not installed")

import jax
import jax.numpy as jnp

import myoenv
import myoenv.jax
from myoenv.brax import BraxEnv
from myoenv.jax import JaxEnv


@pytest.fixture(params=["in XLA", "by callback"])
def way(request, monkeypatch):
    """How steps are taken: the second is that of graphics cards, and of an XLA that is too old or too new."""
    if request.param == "by callback":
        monkeypatch.setattr(myoenv.jax, "XLA_TAKES_STEPS", False)


@pytest.fixture
def env(way, short_task):
    env = JaxEnv(short_task, 8, "cpu")
    yield env
    env.close()


@pytest.fixture
def brax_env(way, short_task):
    env = BraxEnv(short_task, 8, "cpu")
    yield env
    env.close()


def roll(env: JaxEnv, key: jax.Array, length: int = 20):
    """A roll-out with random actions: all in one program."""

    @jax.jit
    def run(key):
        def step(state, key):
            action = jax.random.uniform(key, (env.num_envs, env.num_actions), minval=-1, maxval=1)
            return env.step(state, action)

        state, obs = env.reset(key)
        return obs, jax.lax.scan(step, state, jax.random.split(key, length))[1]

    return jax.device_get(run(key))


def test_equal_keys_give_equal_roll_outs(env):
    first, again, other = (roll(env, jax.random.key(k)) for k in (1, 1, 2))
    jax.tree.map(np.testing.assert_array_equal, first, again)
    assert (first[0] != other[0]).any()


def test_a_roll_out_is_that_of_the_vector_environment(env, make, short_task):
    key = jax.random.key(4)
    obs, steps = roll(env, key)
    high, low = (int(word) for word in jax.random.bits(key, (2,), jnp.uint32))
    envs = make(short_task, autoreset="same_step")
    np.testing.assert_array_equal(envs.reset(seed=high << 32 | low)[0], obs)
    ended = 0
    for t, step_key in enumerate(jax.random.split(key, 20)):
        action = np.asarray(jax.random.uniform(step_key, (8, env.num_actions), minval=-1, maxval=1))
        obs, reward, terminated, truncated, infos = envs.step(action)
        np.testing.assert_array_equal(steps.obs[t], obs)
        np.testing.assert_array_equal(steps.reward[t], reward)
        np.testing.assert_array_equal(steps.terminated[t], terminated)
        np.testing.assert_array_equal(steps.truncated[t], truncated)
        done = terminated | truncated
        np.testing.assert_array_equal(steps.next_obs[t][~done], obs[~done])
        if done.any():
            ended += 1
            np.testing.assert_array_equal(steps.next_obs[t][done], np.stack(infos["final_obs"][done]))
            np.testing.assert_array_equal(steps.summary["return"][t], infos["final_info"]["summary"]["return"])
    assert ended > 0


def test_every_environment_can_have_its_key(env):
    keys = jax.random.split(jax.random.key(0), 8)
    _, one = env.reset(keys)
    _, two = env.reset(keys[::-1])
    _, legacy = env.reset(jax.random.key_data(keys))
    assert (np.asarray(one) != np.asarray(two)).any()
    np.testing.assert_array_equal(one, legacy)


def test_this_xla_takes_steps():
    assert myoenv.jax.XLA_TAKES_STEPS


def test_a_state_is_stepped_once(env):
    state, _ = env.reset(jax.random.key(1))
    action = jnp.zeros((8, env.num_actions))
    following, _ = env.step(state, action)
    with pytest.raises(jax.errors.JaxRuntimeError, match="a state can be stepped once, and not after a reset"):
        jax.block_until_ready(env.step(state, action))
    env.reset(jax.random.key(1))
    with pytest.raises(jax.errors.JaxRuntimeError, match="a state can be stepped once, and not after a reset"):
        jax.block_until_ready(env.step(following, action))


def test_a_step_past_jax_makes_its_states_old(env):
    state, _ = env.reset(jax.random.key(1))
    jax.block_until_ready(state)
    env.envs.step(env.envs.action_space.sample())
    with pytest.raises(jax.errors.JaxRuntimeError, match="a state can be stepped once"):
        jax.block_until_ready(env.step(state, jnp.zeros((8, env.num_actions))))


def test_a_state_of_other_environments_is_refused(env, short_task):
    """Although both have taken as many steps."""
    other = JaxEnv(short_task, 8, "cpu")
    (state, _), (foreign, _) = env.reset(jax.random.key(1)), other.reset(jax.random.key(1))
    action = jnp.zeros((8, env.num_actions))
    with pytest.raises(jax.errors.JaxRuntimeError, match="this state is of other environments"):
        jax.block_until_ready(env.step(foreign, action))
    with pytest.raises(jax.errors.JaxRuntimeError, match="this state is of other environments"):
        jax.block_until_ready(env.reset(jax.random.key(1), after=foreign))
    # Neither was stepped.
    jax.block_until_ready((env.step(state, action), other.step(foreign, action)))
    other.close()


def many_steps(env, state, length: int = 30):
    """A program's worth of steps, and the rewards of all of them."""
    action = jnp.zeros((env.num_envs, env.num_actions))
    state, steps = jax.lax.scan(lambda state, _: env.step(state, action), state, None, length=length)
    return state, steps.reward


def test_a_reset_comes_after_the_state_that_it_names(env):
    """In one program, where nothing else says what comes first."""

    @jax.jit
    def twice(key):
        state, _ = env.reset(key)
        state, first = many_steps(env, state)
        state, _ = env.reset(key, after=state)
        return first, many_steps(env, state)[1]

    for k in range(3):
        first, second = jax.device_get(twice(jax.random.key(k)))
        np.testing.assert_array_equal(first, second)


def test_a_brax_reset_comes_after_the_state_that_it_names(brax_env):
    @jax.jit
    def twice(key):
        action = jnp.zeros((8, brax_env.action_size))
        state = brax_env.reset(key)
        first = brax_env.step(state, action)
        return first.reward, brax_env.step(brax_env.reset(key, after=first), action).reward

    np.testing.assert_array_equal(*jax.device_get(twice(jax.random.key(1))))


def test_a_reset_follows_an_old_state_no_more(env):
    old, _ = env.reset(jax.random.key(1))
    jax.block_until_ready(env.step(old, jnp.zeros((8, env.num_actions))))
    with pytest.raises(jax.errors.JaxRuntimeError, match="a state can be stepped once, and not after a reset"):
        jax.block_until_ready(env.reset(jax.random.key(1), after=old))


def test_a_reset_waits_for_the_steps_that_were_asked_for(env):
    action = jnp.zeros((8, env.num_actions))
    for k in range(3):
        (state, _), rewards = env.reset(jax.random.key(k)), []
        for _ in range(20):
            state, out = env.step(state, action)
            rewards.append(out.reward)
        following, _ = env.reset(jax.random.key(k))
        assert np.isfinite(jnp.stack(rewards)).all()
        jax.block_until_ready(env.step(following, action))


def test_bad_actions_are_told_in_one_sentence(env):
    state, _ = env.reset(jax.random.key(1))
    with pytest.raises(myoenv.ActionError, match=r"actions have the shape \(7, 26\), expected \(8, 26\)"):
        env.step(state, jnp.zeros((7, 26)))
    for wrong in (jnp.zeros((8, 26), jnp.int32), jnp.zeros((8, 26), jnp.complex64), jnp.zeros((8, 26), bool)):
        with pytest.raises(myoenv.ActionError, match=f"actions are of type {wrong.dtype}, expected float32"):
            env.step(state, wrong)
    with pytest.raises(jax.errors.JaxRuntimeError, match="action 3 of environment 2 is NaN"):
        jax.block_until_ready(env.step(state, jnp.zeros((8, 26)).at[2, 3].set(jnp.nan)))
    # The refused step took none.
    jax.block_until_ready(env.step(state, np.zeros((8, 26))))


def test_keys_must_fit(env):
    for wrong in (jax.random.split(jax.random.key(0), 7), 3, np.zeros((8, 2))):
        with pytest.raises(ValueError, match="one key, or one for each of 8 environments"):
            env.reset(wrong)


def test_closed_environments_are_told(env):
    state, _ = env.reset(jax.random.key(1))
    env.close()
    env.close()
    with pytest.raises(jax.errors.JaxRuntimeError, match="the environment is closed"):
        jax.block_until_ready(env.step(state, jnp.zeros((8, env.num_actions))))
    with pytest.raises(jax.errors.JaxRuntimeError, match="the environment is closed"):
        jax.block_until_ready(env.reset(jax.random.key(1)))


def test_a_program_that_outlives_its_environments_says_so(short_task):
    env = JaxEnv(short_task, 8, "cpu")
    state, _ = env.reset(jax.random.key(1))
    jax.block_until_ready(state)
    number = np.int64(env.envs._env.xla_id())
    env.close()
    del env
    gc.collect()
    step = jax.jit(lambda: jax.ffi.ffi_call("myoenv_step", (), has_side_effect=True)(env=number))
    with pytest.raises(jax.errors.JaxRuntimeError, match="the environment is gone"):
        jax.block_until_ready(step())


def test_closing_waits_for_the_steps_that_were_asked_for(env):
    state, _ = env.reset(jax.random.key(1))
    rewards = []
    for _ in range(50):
        state, out = env.step(state, jnp.zeros((8, env.num_actions)))
        rewards.append(out.reward)
    env.close()
    assert np.isfinite(jnp.stack(rewards)).all()


def test_there_is_no_gradient(env):
    state, _ = env.reset(jax.random.key(1))
    with pytest.raises(ValueError, match=r"JVP|cannot be differentiated"):
        jax.grad(lambda action: env.step(state, action)[1].reward.sum())(jnp.zeros((8, env.num_actions)))


def test_brax_state_has_brax_shapes(brax_env):
    state = jax.jit(brax_env.reset)(jax.random.key(1))
    again = jax.jit(brax_env.step)(state, jnp.zeros((8, brax_env.action_size)))
    assert jax.tree.structure(again) == jax.tree.structure(state)
    shapes = jax.tree.map(lambda x: (x.shape, x.dtype), (state, again))
    assert shapes[0] == shapes[1]
    assert state.obs.shape == (8, brax_env.observation_size)
    assert state.done.shape == state.reward.shape == (8,)


def test_brax_truncation_and_new_targets(brax_env):
    """Time-outs are told from successes, and an episode does not begin where the one before it did."""
    state = brax_env.reset(jax.random.key(1))
    first = np.asarray(state.obs)
    step, outcomes = jax.jit(brax_env.step), set()
    for t in range(40):
        state = step(state, jax.random.uniform(jax.random.key(t), (8, brax_env.action_size), minval=-1))
        done, truncation = np.asarray(state.done) > 0, np.asarray(state.info["truncation"]) > 0
        np.testing.assert_array_equal(truncation & ~done, False)
        np.testing.assert_array_equal(np.asarray(state.metrics["success"])[done] > 0, ~truncation[done])
        assert (np.asarray(state.obs)[done] != first[done]).any(-1).all()
        outcomes |= set(truncation[done].tolist())
    assert outcomes == {True, False}


def test_what_others_keep_in_info_stays(brax_env):
    state = brax_env.reset(jax.random.key(1))
    state = state.replace(info={**state.info, "mine": jnp.arange(8)})
    state = jax.jit(brax_env.step, donate_argnums=0)(state, jnp.zeros((8, brax_env.action_size)))
    np.testing.assert_array_equal(state.info["mine"], np.arange(8))
