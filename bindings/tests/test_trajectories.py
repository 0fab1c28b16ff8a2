"""What a user does, physics step by physics step."""

import numpy as np
import pytest

import myoenv


@pytest.fixture
def run(short_task, tmp_path):
    # Steps so small that nothing runs away.
    settings = {"learning_rate": 1e-5}
    myoenv.train(
        short_task, steps=1024, until=None, num_envs=32, settings=settings, backend="cpu", out=tmp_path / "run"
    )
    return tmp_path / "run"


def test_columns_are_those_of_the_same_episodes_as_an_evaluation(run):
    columns = myoenv.trajectories(run, 4)
    [rows] = {len(column) for column in columns.values()}
    summary = myoenv.evaluate(run, 4, backend="cpu")
    assert rows == round(summary["length"].sum() * 0.05 / 0.002)
    ends = columns["time_s"][np.isin(columns["event"], ["success", "time_out"])]
    assert len(ends) == 4 and (columns["event"] == "success").sum() == summary["success"].sum()
    assert columns["episode"].dtype == np.uint32 and set(columns["episode"]) == {1, 2, 3, 4}
    assert np.all((columns["DELT1_activation"] >= 0) & (columns["DELT1_activation"] <= 1))
    again = myoenv.trajectories(run, 2)
    assert np.array_equal(again["fingertip_x_m"], columns["fingertip_x_m"][columns["episode"] <= 2])


def test_what_cannot_be_exported_is_said(run, tmp_path):
    with pytest.raises(ValueError, match="episodes"):
        myoenv.trajectories(run, 0)
    with pytest.raises(myoenv.TrainingError, match="not a run folder"):
        myoenv.trajectories(tmp_path / "nothing")
