"""Environments that go on with other numbers of their task."""

import copy

import numpy as np
import pytest

import myoenv


@pytest.fixture
def other_task(short_task) -> dict:
    """The same structure elsewhere, smaller, longer."""
    task = copy.deepcopy(short_task)
    task["targets"][0]["position"] = {"x": 0.35, "y": [0.05, 0.2], "z": [-0.2, 0.0]}
    task["targets"][0]["radius"] = 0.2
    task["time_limit_s"] = 0.6
    task["reward"] = {"time_cost": 2.0}
    return task


def test_another_task_is_as_if_it_had_been_there_from_the_start(make, short_task, other_task):
    exchanged, made = make(short_task, seed=1), make(other_task, seed=1)
    exchanged.reset()
    exchanged.step(exchanged.action_space.sample())
    observation, infos = exchanged.set_task(other_task)
    assert observation in exchanged.observation_space and infos == {}
    assert exchanged.single_observation_space == made.single_observation_space
    assert exchanged.max_episode_steps == made.max_episode_steps == 12
    assert np.array_equal(exchanged.reset(seed=3)[0], made.reset(seed=3)[0])
    for k in range(30):
        actions = np.full(made.action_space.shape, np.sin(k), np.float32)
        for a, b in zip(exchanged.step(actions)[:4], made.step(actions)[:4], strict=True):
            assert np.array_equal(a, b)
    assert exchanged.save_state() == made.save_state()
    assert np.array_equal(exchanged.render_env(2), made.render_env(2))


def test_the_seed_of_the_first_reset_counts_after_another_task_too(make, short_task, other_task):
    exchanged, made = make(short_task, seed=9), make(other_task, seed=9)
    assert np.array_equal(exchanged.set_task(other_task)[0], made.reset()[0])


def test_another_structure_is_refused_and_changes_nothing(make, short_task, other_task):
    env = make(short_task)
    env.reset(seed=1)
    state, space = env.save_state(), env.observation_space
    first = other_task["targets"][0]
    other_task["targets"] = [first, {**first, "min_distance_from_previous": 0}]
    with pytest.raises(ValueError, match="it has 2 steps instead of 1"):
        env.set_task(other_task)
    with pytest.raises(ValueError, match="radius"):
        env.set_task({**short_task, "targets": [{**short_task["targets"][0], "radius": -1}]})
    with pytest.raises(TypeError):
        env.set_task(7)
    assert env.save_state() == state and env.observation_space is space
    assert env.task == myoenv.load_task(short_task)
