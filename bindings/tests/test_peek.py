"""What can be seen of environments."""

import numpy as np
import pytest

import myoenv

MIXED = """
version: 2
name: mixed
time_limit_s: 2
scene:
  slot: {kind: sphere, at: {x: 0.4, y: [-0.1, 0.1], z: -0.2}, radius: [0.03, 0.05]}
  wall: {kind: obstacle, at: [0.5, 0.2, -0.3], size: [0.1, 0.2, 0.02]}
  key: {kind: button, at: [0.4, -0.1, -0.2], tilt_deg: 60, size: [0.03, 0.05, 0.01]}
script: [{dwell: {in: slot, for_s: 0.2}}, {press: key}]
"""


def steps(env, count: int) -> np.ndarray:
    """The observation after some steps of random actions."""
    env.action_space.seed(1)
    for _ in range(count):
        observation, *_ = env.step(env.action_space.sample())
    return observation


def test_a_peek_agrees_with_the_observation(make):
    env = make("pointing-uitb", 6)
    env.reset(seed=1)
    observation, seen = steps(env, 4), env.peek()
    at = env.observation_names.index

    def observed(name: str) -> np.ndarray:
        return observation[:, at(f"{name}.x") : at(f"{name}.x") + 3]

    current = seen.object_positions[np.arange(6), seen.current_object]
    np.testing.assert_allclose(seen.fingertip, observed("fingertip_position"), atol=1e-6)
    np.testing.assert_array_equal(current.astype(np.float32), observed("target_position"))
    np.testing.assert_allclose(2 * seen.act - 1, observation[:, at(f"activation.{seen.muscle_names[0]}") :][:, :26])
    np.testing.assert_allclose(seen.qvel, observation[:, at(f"joint_velocity.{seen.joint_names[0]}") :][:, :5])
    np.testing.assert_allclose(seen.time, 4 * env.control_dt)
    assert seen.muscle_names == env.action_names
    assert (seen.episode == 1).all() and not seen.ended.any() and (seen.steps_done == 0).all()


def test_a_peek_agrees_with_the_body(make):
    env = make("pointing-uitb", 3)
    env.reset(seed=1)
    steps(env, 3)
    seen, body = env.peek(), myoenv.Simulation(env.model)
    assert (seen.joint_names, seen.body_names) == (body.joint_names, body.body_names)
    sites = env.model.tables()
    for row in range(3):
        body.qpos = seen.qpos[row]
        np.testing.assert_allclose(seen.fingertip[row], body.fingertip, atol=1e-12)
        np.testing.assert_allclose(seen.body_positions[row], body.body_positions, atol=1e-12)
        lengths = [np.linalg.norm(np.diff(path[row], axis=0), axis=1).sum() for path in seen.muscle_paths]
        np.testing.assert_allclose(lengths, body.tendon_length, atol=1e-12)
        for muscle, path in enumerate(seen.muscle_paths):
            on = sites["muscle_path"][muscle]
            bodies, places = sites["site_body"][on], sites["site_pos"][on]
            turned = np.einsum("pij,pj->pi", seen.body_rotations[row, bodies], places)
            np.testing.assert_allclose(path[row], seen.body_positions[row, bodies] + turned, atol=1e-12)


def test_some_environments_are_seen_as_they_are_among_all(make, fast):
    env = make(fast("ticket"), 9)
    env.reset(seed=1)
    steps(env, 2)
    state, every, some = env.save_state(), env.peek(), env.peek(4, 7)
    for name in ("qpos", "act", "body_rotations", "object_positions", "touch"):
        assert np.array_equal(getattr(some, name), getattr(every, name)[4:7]), name
    assert env.peek(8).qpos.shape == (1, 5) and env.peek(3, 3).muscle_paths[0].shape[0] == 0
    assert env.save_state() == state


def test_objects_are_told(make):
    env = make(MIXED, 4)
    env.reset(seed=1)
    seen = env.peek()
    assert (seen.object_names, seen.object_kinds) == (["slot", "wall", "key"], ["sphere", "obstacle", "button"])
    assert (seen.current_object == 0).all() and not seen.object_done.any()
    assert ((seen.object_half_sizes[:, 0] >= 0.03) & (seen.object_half_sizes[:, 0] <= 0.05)).all()
    assert len(np.unique(seen.object_positions[:, 0, 1])) == 4
    np.testing.assert_allclose(seen.object_half_sizes[:, 2], np.tile([0.025, 0.015, 0.005], (4, 1)))
    np.testing.assert_allclose(seen.object_positions[:, 2], np.tile([0.4, -0.1, -0.2], (4, 1)))
    axes = seen.object_rotations[0, 2]
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert axes[2, 0] == pytest.approx(np.sin(np.pi / 3))


def test_a_peek_knows_the_end_of_an_episode(make, short_task):
    env = make(short_task, 1, autoreset="next_step")
    env.reset(seed=1)
    while not (over := env.peek()).ended:
        steps(env, 1)
    steps(env, 1)
    after = env.peek()
    assert 0 < over.time <= 0.4 and (after.time, after.episode, after.ended) == (0, over.episode + 1, False)
