"""Whatever ends a training, what it learned is kept; and what ran away is not."""

import json
import os
import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import myoenv

SMALL = {
    "settings": {"rollout_s": 0.2, "policy_hidden": [16], "value_hidden": [16]},
    "num_envs": 32,
    "backend": "cpu",
}

# What every script below begins with; its only argument is the run folder. `later` sends a signal to itself.
BEGINNING = """
import os, signal, sys, threading, time
import myoenv

SMALL = {small}
heard = []

def later(number, seconds=0.3):
    threading.Timer(seconds, os.kill, (os.getpid(), number)).start()
"""


def run_script(script: str, folder) -> subprocess.CompletedProcess:
    """Runs a script to its end, in a process of its own: a signal is for all of it."""
    code = BEGINNING.format(small=SMALL) + textwrap.dedent(script)
    return subprocess.run(
        [sys.executable, "-c", code, folder], capture_output=True, text=True, timeout=120, check=False
    )


def checkpoints(folder) -> list:
    return sorted((folder / "checkpoints").iterdir())


class Stop(BaseException):
    """What is no `Exception` either."""


@pytest.mark.parametrize("reason", [SystemExit(3), RuntimeError("no network"), Stop(), GeneratorExit()], ids=repr)
def test_whatever_a_callback_raises_leaves_a_checkpoint(tmp_path, reason):
    def fail(metrics):
        raise reason

    with pytest.raises(type(reason)) as raised:
        myoenv.train("pointing-single", out=tmp_path / "run", until=None, steps=256, callback=fail, **SMALL)
    assert raised.value is reason
    assert [path.name for path in checkpoints(tmp_path / "run")] == ["step_000000000128.ckpt"]
    # The traceback is still there, and the run can be had.
    assert myoenv.train(resume=tmp_path / "run").updates == 2


RUNAWAY = {
    "a policy that moves too far": {"kl_max": 1e-9, "learning_rate_min": 1e-4},
    "weights that are not finite": {"learning_rate": 1e38, "learning_rate_max": 1e38, "learning_rate_min": 1e37},
}


@pytest.mark.parametrize("case", RUNAWAY)
@pytest.mark.filterwarnings("ignore:training ran away:RuntimeWarning")
def test_training_that_runs_away_leaves_no_checkpoint_of_that(tmp_path, case):
    wild = SMALL | {"settings": SMALL["settings"] | RUNAWAY[case] | {"kl_target": 0.0}}
    with pytest.raises(myoenv.TrainingError, match="training diverged"):
        myoenv.train("pointing-single", out=tmp_path / "run", until=None, steps=10_000, **wild)
    # The good state that training went back to, before its first update.
    assert [path.name for path in checkpoints(tmp_path / "run")] == ["step_000000000000.ckpt"]
    assert np.isfinite(myoenv.Policy.load(tmp_path / "run")(np.zeros((1, 57), np.float32))).all()


def test_ctrl_c_in_the_last_evaluation_keeps_the_policy(tmp_path):
    script = """
    def last(metrics):
        heard.append(metrics)
        if metrics["updates"] == 2:
            later(signal.SIGINT)
    # Ten targets: the evaluation takes seconds.
    result = myoenv.train("pointing-uitb", out=sys.argv[1], until=None, steps=256, callback=last, **SMALL)
    action = result.policy([0.0] * len(result.policy.observation_names))
    print(result.stopped_by, result.evaluation, result.updates, len(heard), action.shape)
    """
    run = run_script(script, tmp_path / "run")
    assert run.stdout == "interrupt None 2 2 (26,)\n", run.stderr
    assert [path.name for path in checkpoints(tmp_path / "run")] == ["step_000000000256.ckpt"]


def test_a_last_evaluation_that_was_cut_off_is_made_up_for(tmp_path):
    script = """
    def last(metrics):
        heard.append(metrics)
        if metrics["updates"] == 2:
            later(signal.SIGINT)
    result = myoenv.train("pointing-uitb", out=sys.argv[1], until=None, steps=256, callback=last, **SMALL)
    print(result.stopped_by)
    """
    run = tmp_path / "run"
    assert run_script(script, run).stdout == "interrupt\n" and not (run / "evaluation.json").exists()
    heard = []
    resumed = myoenv.train(resume=run, callback=heard.append)
    assert (resumed.stopped_by, resumed.env_steps, resumed.updates, heard) == ("steps", 256, 2, [])
    assert json.loads((run / "evaluation.json").read_text()) == resumed.evaluation
    whole = myoenv.train("pointing-uitb", until=None, steps=256, **SMALL)
    assert resumed.evaluation == whole.evaluation
    with pytest.raises(ValueError, match="has 256 control steps, and its limit is 256; raise it with steps="):
        myoenv.train(resume=run)


def test_ctrl_c_during_an_update_keeps_those_before_which_the_callback_heard_of(tmp_path):
    script = """
    def hear(metrics):
        if not heard:
            # At once, while the next update computes.
            later(signal.SIGINT, 0.001)
        heard.append(metrics["updates"])
    result = myoenv.train("pointing-single", out=sys.argv[1], until=None, callback=hear, **(SMALL | {"num_envs": 4096}))
    print(result.stopped_by, heard == list(range(1, result.updates + 1)))
    """
    run = run_script(script, tmp_path / "run")
    assert run.stdout == "interrupt True\n", run.stderr
    assert len(checkpoints(tmp_path / "run")) == 1


def test_what_a_signal_handler_raises_leaves_train_after_a_checkpoint(tmp_path):
    script = """
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(5))
    myoenv.train("pointing-single", out=sys.argv[1], until=None, callback=lambda m: later(signal.SIGTERM, 0.0), **SMALL)
    """
    run = run_script(script, tmp_path / "run")
    assert run.returncode == 5, run.stderr
    assert len(checkpoints(tmp_path / "run")) == 1


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.filterwarnings("ignore:.*fork:DeprecationWarning", "ignore:os.fork:RuntimeWarning")
def test_a_forked_child_that_ends_writes_nothing(tmp_path):
    children = []

    def fork(metrics):
        if not children:
            children.append(os.fork())
            if children[0] == 0:
                raise SystemExit(7)
            assert os.waitstatus_to_exitcode(os.waitpid(children[0], 0)[1]) == 7
            assert checkpoints(tmp_path / "run") == []

    try:
        result = myoenv.train("pointing-single", out=tmp_path / "run", until=None, steps=256, callback=fork, **SMALL)
    except SystemExit as end:
        os._exit(end.code)
    assert result.updates == 2 and len(checkpoints(tmp_path / "run")) == 1


def test_a_training_that_failed_writes_no_more(tmp_path):
    from myoenv import _native

    session = _native.Session(
        [myoenv.Task.load("pointing-single")],
        myoenv.Model(),
        config=json.dumps(SMALL["settings"] | RUNAWAY["a policy that moves too far"] | {"num_envs": 32}),
        seed=1,
        backend="cpu",
        device=None,
        threads=1,
        until="off",
        steps=10_000,
        start_from=None,
    )
    session.record_in(tmp_path / "run")
    with pytest.raises(myoenv.TrainingError, match="training diverged"):
        for _ in range(10):
            session.advance()
    # The good state that training went back to, before its first update.
    before = [(path.name, path.read_bytes()) for path in checkpoints(tmp_path / "run")]
    assert [name for name, _ in before] == ["step_000000000000.ckpt"]
    for use in (session.policy, session.advance, lambda: session.conclude("interrupt")):
        with pytest.raises(myoenv.TrainingError, match="the training is over"):
            use()
    session.leave()
    assert [(path.name, path.read_bytes()) for path in checkpoints(tmp_path / "run")] == before


def test_signals_are_heard_in_the_main_thread_alone(tmp_path):
    """Python handles signals there; a training in another thread goes on."""
    script = """
    results = []
    def work():
        results.append(myoenv.train("pointing-single", until=None, steps=1280, callback=heard.append, **SMALL))
    thread = threading.Thread(target=work)
    thread.start()
    later(signal.SIGINT, 0.05)
    try:
        while thread.is_alive():
            time.sleep(0.01)
    except KeyboardInterrupt:
        print("interrupted")
    while not results:
        time.sleep(0.01)
    print(results[0].stopped_by, len(heard))
    """
    run = run_script(script, tmp_path)
    assert run.stdout == "interrupted\nsteps 10\n", run.stderr


def test_the_policy_of_a_stopped_training_acts(tmp_path):
    def interrupt(metrics):
        signal.raise_signal(signal.SIGINT)

    result = myoenv.train("pointing-single", out=tmp_path / "run", until=None, callback=interrupt, **SMALL)
    assert (result.stopped_by, result.updates) == ("interrupt", 1)
    observation = np.zeros(len(result.policy.observation_names))
    assert np.array_equal(result.policy(observation), myoenv.Policy.load(tmp_path / "run")(observation))
