"""Sensors of MuJoCo's files: what bodies read."""

import numpy as np
import pytest

import myoenv

LEVER = """<mujoco>
  <worldbody>
    <site name="hook" pos="0.1 0 1.2"/>
    <body name="arm" pos="0 0 1">
      <joint name="elbow" axis="0 1 0" range="-2 2"/>
      <inertial pos="0 0 -0.2" mass="1" diaginertia="0.02 0.02 0.002"/>
      <site name="tip" pos="0 0 -0.4" quat="1 1 0 0" size="0.02"/>
    </body>
  </worldbody>
  <tendon><spatial name="cord"><site site="hook"/><site site="tip"/></spatial></tendon>
  <actuator><muscle name="lift" tendon="cord" lengthrange="0.3 0.9" force="100"/></actuator>
  <sensor>
    <jointpos name="bent" joint="elbow"/>
    <framepos name="place" objtype="site" objname="tip"/>
    <framequat name="turn" objtype="site" objname="tip"/>
    <velocimeter name="speed" site="tip"/>
    <actuatorfrc name="pull" actuator="lift" cutoff="10"/>
    <touch name="pulp" site="tip"/>
    <accelerometer name="shake" site="tip"/>
  </sensor>
</mujoco>"""


@pytest.fixture
def lever(tmp_path):
    path = tmp_path / "lever.xml"
    path.write_text(LEVER)
    with pytest.warns(match="1 `accelerometer` sensors"):
        return myoenv.import_model(path, fingertip="tip", shoulder="arm")


def test_sensors_read_bodies_as_they_are(lever):
    bodies = myoenv.Bodies(lever, 3)
    assert bodies.sensor_names == ["bent", "place", "turn", "speed", "pull", "pulp"]
    assert bodies.sensor_sizes == [1, 3, 4, 3, 1, 1]
    angle, rate = np.pi / 2, 2.0
    bodies.set(np.array([1]), np.full((1, 1), angle), np.full((1, 1), rate), np.ones((1, 1)))
    read = bodies.sensors()
    assert list(read) == bodies.sensor_names
    for name, size in zip(bodies.sensor_names, bodies.sensor_sizes, strict=True):
        assert read[name].shape == (3, size) and read[name].dtype == np.float64
    assert np.allclose(read["bent"][:, 0], [0, angle, 0])
    assert np.allclose(read["place"], [[0, 0, 0.6], [-0.4, 0, 1], [0, 0, 0.6]], atol=1e-6)
    half = np.sqrt(0.5)
    assert np.allclose(read["turn"], [[half, half, 0, 0], [0.5, 0.5, 0.5, -0.5], [half, half, 0, 0]], atol=1e-6)
    # Along the x axis of the arm, which its tip shares.
    assert np.allclose(read["speed"], [[0, 0, 0], [-0.4 * rate, 0, 0], [0, 0, 0]], atol=1e-6)
    assert read["pull"][1, 0] == -10 and not read["pulp"].any()
    # The same in one thread, and after a step another.
    again = myoenv.Bodies(lever, 3, threads=1)
    again.set(np.array([1]), np.full((1, 1), angle), np.full((1, 1), rate), np.ones((1, 1)))
    assert all(np.array_equal(values, read[name]) for name, values in again.sensors().items())
    again.step(np.zeros((3, 1), np.float32))
    assert not np.array_equal(again.sensors()["place"], read["place"])


def test_sensors_come_with_the_model(lever):
    copy = myoenv.Model.from_yaml(lever.to_yaml())
    assert myoenv.Bodies(copy, 1).sensor_names == myoenv.Bodies(lever, 1).sensor_names
    assert '<velocimeter name="speed" site="tip"/>' in lever.to_mjcf()
    assert myoenv.Bodies(myoenv.Model("mobl-arms"), 1).sensors() == {}
