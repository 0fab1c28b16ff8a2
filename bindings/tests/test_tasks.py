"""Tasks, models, and the body alone."""

import json
import pickle

import numpy as np
import pytest

import myoenv

POSE = np.array([0.2, 0.8, -0.3, 1.0, 0.1])


def test_one_task_from_everything(tmp_path, short_task):
    whole = myoenv.load_task(short_task)
    text = whole.to_yaml()
    (tmp_path / "task.yaml").write_text(text)
    position = "position = { x = 0.3, y = [-0.1, 0.1], z = [-0.3, -0.1] }"
    (tmp_path / "task.toml").write_text(
        f'version = 1\nname = "short"\ntime_limit_s = 0.4\n[[targets]]\nkind = "pointing"\n{position}\n'
        "radius = 0.3\ndwell_s = 0.05\n"
    )
    for source in (text, tmp_path / "task.yaml", str(tmp_path / "task.toml"), myoenv.to_dict(whole), whole):
        assert myoenv.load_task(source) == whole
    assert pickle.loads(pickle.dumps(whole)) == whole


def test_numbers_of_numpy_are_taken(short_task):
    short_task["targets"][0]["radius"] = np.float64(0.3)
    short_task["time_limit_s"] = np.float32(0.4)
    described = myoenv.to_dict(myoenv.load_task(short_task))
    assert described["targets"][0]["radius"] == 0.3 and described["time_limit_s"] == float(np.float32(0.4))


def test_warnings_are_python_s(short_task):
    short_task["targets"][0].update(position={"x": [0.3, 0.9], "y": 0.0, "z": 0.0}, radius=0.05)
    with pytest.warns(UserWarning, match="reach"):
        myoenv.make_vec(short_task, 2).close()


def test_tables_have_one_row_per_entity():
    model = myoenv.Model()
    tables = model.tables()
    assert tables["body_inertia"].shape == (len(tables["body_name"]), 3, 3)
    assert tables["joint_range"].shape == (17, 2) and len(tables["muscle_name"]) == 26
    assert tables["body_mass"].sum() == pytest.approx(sum(b["mass"] for b in json.loads(model.to_json())["bodies"]))
    assert all(path.max() < len(tables["site_name"]) for path in tables["muscle_path"])
    assert not any(map(len, tables["muscle_branch"])) and not np.isfinite(tables["muscle_limit"]).any()
    divided = json.loads(model.to_json())
    biceps = divided["muscles"][-1]
    biceps["path"] += [{"pulley": 2}, *biceps["path"]]
    biceps["limit"] = {"range": [0.1, 0.5]}
    tables = myoenv.load_model(divided).tables()
    assert tables["muscle_branch"][-1].tolist() == [len(biceps["path"]) // 2] and tables["muscle_divisor"][-1] == [2]
    assert tables["muscle_limit"][-1].tolist() == [0.1, 0.5]
    body, whole = myoenv.Simulation(myoenv.load_model(divided)), myoenv.Simulation(model)
    assert body.tendon_length.shape == (26,)
    np.testing.assert_allclose(body.tendon_length[-1], 1.5 * whole.tendon_length[-1])
    np.testing.assert_allclose(body.moment_arms[-1], 1.5 * whole.moment_arms[-1])
    assert "<mujoco" in model.to_mjcf()


def test_a_model_of_mujoco_is_imported(tmp_path):
    path, names = tmp_path / "arm.xml", {"fingertip": "fingertip", "shoulder": "humphant"}
    text = myoenv.Model().to_mjcf()
    path.write_text(text)
    model = myoenv.import_model(path, **names)
    assert repr(model) == repr(myoenv.Model())
    wanted, found = myoenv.Model().tables(), model.tables()
    for name, value in wanted.items():
        if name not in ("muscle_path",) and isinstance(value, np.ndarray):
            np.testing.assert_allclose(found[name], value, rtol=1e-9, atol=1e-12, err_msg=name)
    # It does tasks, and it tells what of its file was of no use.
    assert myoenv.Simulation(model).qpos.shape == (5,)
    path.write_text(text.replace("<worldbody>", '<worldbody><camera name="aside"/>', 1))
    with pytest.warns(UserWarning, match="passed over, as they have no part in the simulation: 1 cameras"):
        myoenv.import_model(str(path), **names)
    path.write_text(text)
    assert "side_rule" not in model.to_yaml()
    assert "side_rule: mujoco3" in myoenv.import_model(path, **names, side_rule="mujoco3").to_yaml()
    with pytest.raises(ValueError, match="no rule of sides is `mujoco2`; there are `mujoco4` and `mujoco3`"):
        myoenv.import_model(path, **names, side_rule="mujoco2")


def test_what_is_no_model_of_mujoco_is_refused(tmp_path):
    path, names = tmp_path / "arm.xml", {"fingertip": "fingertip", "shoulder": "humphant"}
    text = myoenv.Model().to_mjcf()
    path.write_text(text.replace("<joint name", '<joint frictionloss="1" name', 1))
    with pytest.raises(myoenv.TaskError, match=r"arm\.xml:\d+:\d+: <joint name=.*dry friction \(`frictionloss`\)"):
        myoenv.import_model(path, **names)
    path.write_text(text)
    with pytest.raises(myoenv.TaskError, match="did you mean `fingertip`"):
        myoenv.import_model(path, fingertip="fingertp", shoulder="humphant")
    with pytest.raises(myoenv.TaskError, match=r"absent\.xml"):
        myoenv.import_model(tmp_path / "absent.xml", **names)
    with pytest.raises(TypeError, match=r"shoulder is None; it must be a name"):
        myoenv.import_model(path, fingertip="fingertip", shoulder=None)
    with pytest.raises(TypeError, match="file is 3; it must be a path"):
        myoenv.import_model(3, **names)


def test_the_body_falls_and_follows_its_muscles():
    body = myoenv.Simulation(myoenv.Model())
    body.qpos = np.full(len(body.joint_names), 0.3)
    before = body.fingertip
    body.step(np.zeros(26), 50)
    assert body.time == pytest.approx(0.1) and not np.allclose(body.fingertip, before)
    assert np.allclose(body.activation, 0)
    body.step(np.full(26, 0.5), 50)
    assert (body.activation > 0.3).all() and (body.muscle_force >= 0).all() and body.muscle_force.max() > 100
    body.reset()
    assert body.time == 0 and not body.qvel.any()


def test_moment_arms_are_derivatives_of_length():
    body = myoenv.Simulation(myoenv.Model())
    pose, step = POSE, 1e-6
    for k in range(5):
        lengths = []
        for sign in (-1, 1):
            moved = pose.copy()
            moved[k] += sign * step
            body.qpos = moved
            lengths.append(body.tendon_length)
        body.qpos = pose
        np.testing.assert_allclose(body.moment_arms[:, k], -(lengths[1] - lengths[0]) / (2 * step), atol=1e-8)
    body.qvel = [0.5, -1, 0.2, 2, 0]
    np.testing.assert_allclose(body.tendon_velocity, -body.moment_arms @ body.qvel, atol=1e-12)


def test_the_mass_matrix_is_symmetric_and_positive():
    body = myoenv.Simulation(myoenv.Model())
    assert np.array_equal(body.mass_matrix, body.mass_matrix.T)
    assert (np.linalg.eigvalsh(body.mass_matrix) > 0).all()


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (np.zeros(4), r"qpos has the shape \[4\], expected \[5\]"),
        (np.zeros((1, 5)), r"qpos has the shape \[1, 5\]"),
        ([0, np.nan, 0, 0, 0], r"qpos\[1\] is NaN; it must be finite"),
        (np.zeros(5, complex), "qpos is of type complex128; it must be numbers"),
        (None, "qpos is of type object"),
        ("12345", "qpos is of type <U5"),
        ([[1], [2, 3]], "qpos cannot be made an array"),
    ],
)
def test_bad_states_of_the_body_are_refused(values, sentence):
    body = myoenv.Simulation(myoenv.Model())
    body.qpos = POSE
    with pytest.raises(ValueError, match=sentence):
        body.qpos = values
    assert np.array_equal(body.qpos, POSE)


def test_bad_steps_of_the_body_are_refused():
    body = myoenv.Simulation(myoenv.Model())
    for ctrl, steps, sentence in (
        (np.zeros(3), 1, r"ctrl has the shape \[3\]"),
        (np.full(26, np.inf), 1, r"ctrl\[0\] is inf"),
        (np.zeros(26), -1, "steps is -1"),
    ):
        with pytest.raises(ValueError, match=sentence):
            body.step(ctrl, steps)
    for activation in (1.5, -0.1):
        with pytest.raises(ValueError, match=rf"activation\[0\] is {activation}; it must be from 0 to 1"):
            body.activation = np.full(26, activation)
    assert body.time == 0


def test_a_body_that_moves_too_fast_says_so_and_can_be_reset():
    body = myoenv.Simulation(myoenv.Model())
    body.qvel = np.full(5, 1e200)
    with pytest.raises(RuntimeError, match="too fast to be computed; reset it"):
        body.step(np.zeros(26), 5)
    body.reset()
    body.step(np.zeros(26), 5)
    assert np.isfinite(body.qpos).all()


def button_ahead(gap: float) -> tuple[myoenv.Simulation, myoenv.Simulation]:
    """An arm with an upright button whose centre is so far (m) in front of the fingertip, and the same arm without."""
    model = myoenv.Model()
    free = myoenv.Simulation(model)
    free.qpos = POSE
    x, y, z = free.fingertip
    place = {"position": [x + gap, y, z], "size": [0.05, 0.05, 0.02], "tilt_deg": 0.0}
    button = {"kind": "pressing", **place, "min_force_n": 1.0}
    task = myoenv.load_task({"version": 1, "name": "press", "time_limit_s": 1.0, "targets": [button]})
    body = myoenv.Simulation(model, task)
    body.qpos = POSE
    return body, free


def fingertip_jacobian(body: myoenv.Simulation, step: float = 1e-6) -> np.ndarray:
    """Derivative of the fingertip's position with respect to `qpos`, `(3, ndof)`, by differences."""
    pose, columns = body.qpos, []
    for direction in np.eye(len(pose)) * step:
        places = []
        for sign in (-1, 1):
            body.qpos = pose + sign * direction
            places.append(body.fingertip)
        columns.append((places[1] - places[0]) / (2 * step))
    body.qpos = pose
    return np.array(columns).T


def test_a_button_pushes_back_with_the_force_that_it_tells():
    before = 0.0
    for gap in (0.026, 0.024, 0.022, 0.018):
        body, free = button_ahead(gap)
        # What the button does to the joints, and the force at the fingertip that does the same.
        torque = body.mass_matrix @ (body.qacc - free.qacc)
        force, *_ = np.linalg.lstsq(fingertip_jacobian(free).T, torque, rcond=None)
        # Against the finger, which comes from behind; the deeper, the stronger.
        assert force[0] < 0
        assert body.contact_force == pytest.approx(-force[0], rel=2e-3)
        assert body.contact_force > before + 10
        # The friction pyramid, with a coefficient of 1.
        assert np.abs(force[1:]).sum() <= 1.01 * body.contact_force
        before = body.contact_force
    assert button_ahead(0.03)[0].contact_force == 0


def test_muscles_press_a_button():
    body, free = button_ahead(0.03)
    # Muscles that move the finger forward.
    forward = free.moment_arms @ np.linalg.solve(free.mass_matrix, fingertip_jacobian(free)[0])
    ctrl = np.where(forward > 0, 0.3, 0.0)
    start, forces = body.fingertip[0], []
    for _ in range(100):
        body.step(ctrl)
        free.step(ctrl)
        forces.append(body.contact_force)
    assert forces[0] == 0
    # Enough for any task's button and less than an arm can, and the same for as long as it is pressed.
    assert 5 < forces[-1] < 100 and np.ptp(forces[-25:]) < 0.05 * forces[-1]
    assert body.fingertip[0] - start < 0.005 and body.fingertip[0] < free.fingertip[0]
