"""Two layouts compared, from tasks and from runs."""

import pandas
import pytest

import myoenv
import myoenv.sweep

SHORT = {"until": None, "steps": 512, "num_envs": 32, "backend": "cpu", "settings": {"rollout_s": 0.8}}


def test_two_layouts_are_compared(tmp_path, fast):
    table = myoenv.compare("pointing-single", fast("public-display"), seeds=2, out=tmp_path, **SHORT)
    assert list(table.index) == ["success", "episode_length_s", "effort", "fatigue"]
    assert table.attrs["names"] == ["pointing-single", "public-display"] and table.attrs["users"] == [2, 2]
    assert len(table.attrs["sentences"]) == 4
    assert (table["difference"] == table["second"] - table["first"]).all()
    assert ((table["low"] <= table["difference"]) & (table["difference"] <= table["high"])).all()
    assert any("had not finished learning" in caveat for caveat in table.attrs["caveats"])

    # The same users again, from their runs.
    runs = {side: [tmp_path / side / f"seed-{seed}" for seed in (1, 2)] for side in ("first", "second")}
    pandas.testing.assert_frame_equal(myoenv.compare(**runs), table)
    alone = myoenv.compare(runs["first"][:1], runs["second"])
    assert (alone["verdict"] == "unknown").all() and alone["low"].isna().all()


def test_users_on_a_card_are_trained_at_once_and_as_if_each_were_alone(tmp_path, fast):
    layouts = myoenv.sweep.button_grid(fast("public-display"), columns=2, rows=1).values()
    short = {**SHORT, "backend": "gpu", "device": 0}
    at_once = myoenv.compare(*layouts, seeds=2, **short)
    alone = myoenv.compare(*layouts, seeds=2, out=tmp_path, **short)
    pandas.testing.assert_frame_equal(at_once, alone)
    assert at_once.attrs == alone.attrs and at_once.attrs["users"] == [2, 2]


def test_what_cannot_be_compared_is_refused(tmp_path):
    with pytest.raises(TypeError, match="compare chooses seed itself"):
        myoenv.compare("ar", "ar", seed=3)
    with pytest.raises(myoenv.TrainingError, match="is not a run folder"):
        myoenv.compare([tmp_path], [tmp_path])
