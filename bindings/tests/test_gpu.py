"""Graphics cards: the best that answers, which may be a driver that computes on the processor."""

import os

import numpy as np
import pytest
from conftest import MODES

import myoenv

pytestmark = pytest.mark.skipif(
    os.environ.get("MYO_NO_GPU") == "1", reason="MYO_NO_GPU=1: without a driver, the tests on a GPU are left out"
)

# Named, as an adapter of software is not taken otherwise.
GPU = {"backend": "gpu", "device": 0}
SMALL = {"num_envs": 32, "settings": {"rollout_s": 0.2, "policy_hidden": [16], "value_hidden": [16]}}


@pytest.fixture
def make_pair(short_task):
    """Makes equal environments on the processor and on the card."""
    made = []

    def build(**options):
        made.extend(myoenv.make_vec(short_task, 8, seed=1, **place, **options) for place in ({"backend": "cpu"}, GPU))
        return made

    yield build
    for env in made:
        env.close()


@pytest.mark.parametrize("mode", MODES)
def test_our_own_checker_passes(make_pair, mode):
    _, card = make_pair(autoreset=mode)
    assert (card.backend, card.device) == ("gpu", myoenv.devices()[0][0])
    assert myoenv.check_vec_env(card)[-1] == "autoreset"


def test_the_card_does_what_the_processor_does(make_pair):
    cpu, card = make_pair(autoreset="same_step")
    np.testing.assert_allclose(card.reset()[0], cpu.reset()[0], atol=1e-6)
    random = np.random.default_rng(1)
    for _ in range(5):
        actions = random.uniform(-1, 1, cpu.action_space.shape).astype(np.float32)
        expected, got = cpu.step(actions), card.step(actions)
        np.testing.assert_allclose(got[0], expected[0], atol=1e-4)
        np.testing.assert_allclose(got[1], expected[1], atol=1e-4)
    expected, got = cpu.peek(), card.peek(2, 5)
    for name in ("fingertip", "act", "body_rotations", "object_positions", "episode"):
        np.testing.assert_allclose(getattr(got, name), getattr(expected, name)[2:5], atol=1e-4, err_msg=name)


def test_bad_calls_are_told(make_pair):
    _, card = make_pair()
    card.reset()
    with pytest.raises(myoenv.ActionError, match="action 0 of environment 0 is NaN"):
        card.step(np.full((8, 26), np.nan))
    with pytest.raises(ValueError, match="does not fit"):
        card.load_state(b"state")
    card.close()
    card.close()
    with pytest.raises(myoenv.ClosedError):
        card.reset()
    with pytest.raises(myoenv.DeviceError, match='no GPU is called "no such card"'):
        myoenv.make_vec("pointing", 8, "gpu", device="no such card")


def test_training_goes_on_and_is_evaluated(tmp_path):
    start = {"until": None, **GPU, **SMALL}
    whole = myoenv.train("pointing-single", steps=512, **start)
    stopped = myoenv.train("pointing-single", steps=256, out=tmp_path / "run", **start)
    resumed = myoenv.train(resume=tmp_path / "run", steps=512)
    assert (whole.updates, stopped.updates, resumed.updates) == (4, 2, 4)
    observation = np.random.default_rng(1).normal(size=(20, len(whole.policy.observation_names)))
    assert np.array_equal(resumed.policy(observation), whole.policy(observation))
    tables = [myoenv.evaluate(tmp_path / "run", 16, num_envs=16, **place) for place in ({"backend": "cpu"}, GPU)]
    np.testing.assert_allclose(tables[1]["return"], tables[0]["return"], rtol=1e-2)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning", "ignore:os.fork:RuntimeWarning")
def test_after_a_fork_the_child_gets_no_card():
    myoenv.devices()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            myoenv.make_vec("pointing-single", 8, **GPU)
        except myoenv.ForkedError:
            code = 0
        finally:
            os._exit(code)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
