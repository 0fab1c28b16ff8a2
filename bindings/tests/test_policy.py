"""Policies go to other programs and back."""

import copy
import pickle
import sys

import numpy as np
import pytest

import myoenv


@pytest.fixture(scope="module")
def policy():
    """Trained for a moment, with layers of different widths, so that no axis can be mistaken for another."""
    settings = {"rollout_s": 0.2, "policy_hidden": [16, 24], "value_hidden": [16]}
    return myoenv.train("pointing-single", until=None, steps=512, num_envs=32, backend="cpu", settings=settings).policy


@pytest.fixture(scope="module")
def observations(policy):
    """Rows of many sizes: some of them are clipped."""
    rng = np.random.default_rng(1)
    scale = 10.0 ** rng.uniform(-2, 3, (200, 1))
    return (scale * rng.normal(size=(200, len(policy.observation_names)))).astype(np.float32)


def by_hand(weights, observation):
    """The description of `Policy.weights`, in double precision."""
    w = {name: array.astype(np.float64) for name, array in weights.items()}
    x = np.clip(
        (observation - w["observation_mean"]) * w["observation_inverse_std"],
        -w["observation_limit"],
        w["observation_limit"],
    )
    layers = sum(name.endswith(".weight") for name in w)
    for k in range(layers):
        x = x @ w[f"layers.{k}.weight"].T + w[f"layers.{k}.bias"]
        if k < layers - 1:
            x = x / (1 + np.exp(-x))
    return np.clip(w["action_offset"] + w["action_scale"] * x, -1, 1)


def same(policy):
    names = {"observation_names": policy.observation_names, "action_names": policy.action_names}
    return myoenv.Policy.from_weights(policy.weights, **names)


def test_weights_are_all_that_an_action_is_computed_from(policy, observations):
    weights = policy.weights
    shapes = {name: array.shape for name, array in weights.items()}
    assert shapes == {
        "observation_mean": (57,),
        "observation_inverse_std": (57,),
        "observation_limit": (),
        "layers.0.weight": (16, 57),
        "layers.0.bias": (16,),
        "layers.1.weight": (24, 16),
        "layers.1.bias": (24,),
        "layers.2.weight": (26, 24),
        "layers.2.bias": (26,),
        "action_offset": (),
        "action_scale": (),
    }
    assert all(array.dtype == np.float32 for array in weights.values())
    np.testing.assert_allclose(policy(observations), by_hand(weights, observations), atol=2e-6)
    # They are copies.
    weights["layers.0.bias"][:] = 7
    assert (policy.weights["layers.0.bias"] != 7).all()


def test_equal_weights_act_alike_bit_for_bit(policy, observations):
    copies = [same(policy), pickle.loads(pickle.dumps(policy)), copy.copy(policy), copy.deepcopy(policy)]
    for other in copies:
        assert np.array_equal(other(observations), policy(observations))
        assert (other.observation_names, other.action_names) == (policy.observation_names, policy.action_names)


def test_other_weights_act_otherwise(policy, observations):
    weights = policy.weights
    weights["layers.1.bias"] = weights["layers.1.bias"] + 0.5
    names = {"observation_names": policy.observation_names, "action_names": policy.action_names}
    other = myoenv.Policy.from_weights(weights, **names)
    np.testing.assert_allclose(other(observations), by_hand(weights, observations), atol=2e-6)
    assert not np.array_equal(other(observations), policy(observations))


def without(weights, name):
    return {key: value for key, value in weights.items() if key != name}


@pytest.mark.parametrize(
    ("change", "error", "sentence"),
    [
        (lambda w: without(w, "layers.0.bias"), ValueError, r'have no "layers\.0\.bias"'),
        (lambda w: without(w, "layers.1.weight"), ValueError, r'no weights "layers\.1\.bias"'),
        (lambda w: without(w, "action_scale"), ValueError, 'have no "action_scale"'),
        (lambda w: w | {"layers.3.bias": np.zeros(3)}, ValueError, r'no weights "layers\.3\.bias"'),
        (
            lambda w: w | {"layers.0.weight": w["layers.0.weight"].T},
            ValueError,
            r"shape \[57, 16\], expected \[16, 57\]",
        ),
        (lambda w: w | {"layers.0.weight": np.zeros(3)}, ValueError, "expected 2 dimensions"),
        (lambda w: w | {"observation_mean": np.zeros(56)}, ValueError, "has 56 entries, expected 57"),
        (lambda w: w | {"observation_limit": np.float32(0)}, ValueError, "observation_limit is 0; it must be positive"),
        (lambda w: w | {"action_scale": np.nan}, ValueError, "action_scale has an entry that is not finite"),
        (lambda w: w | {"action_scale": 1e300}, ValueError, "action_scale has an entry that is not finite"),
        (lambda w: w | {"action_scale": "one"}, TypeError, "action_scale is of type <U3; it must be numbers"),
        (lambda w: w | {"layers.2.bias": [[1], [1, 2]]}, ValueError, "cannot be made an array"),
        (lambda w: w | {1: 2}, TypeError, "weights has the key 1"),
        (lambda w: None, ValueError, 'have no "observation_mean"'),
        (lambda w: [1], TypeError, r"weights is \[1\]; it must be a dictionary"),
    ],
)
def test_weights_that_are_no_policy_are_told(policy, change, error, sentence):
    names = {"observation_names": policy.observation_names, "action_names": policy.action_names}
    with pytest.raises(error, match=sentence):
        myoenv.Policy.from_weights(change(policy.weights), **names)


def test_names_that_do_not_fit_are_told(policy):
    names = {"observation_names": policy.observation_names, "action_names": policy.action_names}
    cases = [
        ({"observation_names": policy.observation_names[1:]}, ValueError, r"expected \[16, 56\]"),
        ({"action_names": []}, ValueError, "one action"),
        ({"action_names": "muscles"}, TypeError, "action_names is 'muscles'; it must be a list of names"),
        ({"observation_names": [1]}, TypeError, r"observation_names is \[1\]"),
    ]
    for change, error, sentence in cases:
        with pytest.raises(error, match=sentence):
            myoenv.Policy.from_weights(policy.weights, **(names | change))


def test_a_module_of_pytorch_acts_alike_and_comes_back(policy, observations):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    module = policy.to_torch()
    assert list(module.state_dict()) and set(module.state_dict()) == set(policy.weights)
    with torch.no_grad():
        actions = module(torch.from_numpy(observations))
        np.testing.assert_allclose(actions.numpy(), policy(observations), atol=2e-6)
        assert torch.equal(module(torch.from_numpy(observations[0])), actions[0]) or torch.allclose(
            module(torch.from_numpy(observations[0])), actions[0], atol=2e-6
        )
    assert np.array_equal(myoenv.Policy.from_torch(module)(observations), policy(observations))
    with pytest.raises(TypeError, match="module is a Linear; it must be what"):
        myoenv.Policy.from_torch(torch.nn.Linear(57, 26))


def test_a_module_of_pytorch_can_be_trained_further(policy, observations):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    module = policy.to_torch()
    optimizer = torch.optim.SGD(module.parameters(), lr=0.1)
    module(torch.from_numpy(observations)).square().sum().backward()
    optimizer.step()
    trained = myoenv.Policy.from_torch(module)
    for name, array in trained.weights.items():
        assert np.array_equal(array, policy.weights[name]) == (not name.startswith("layers.")), name
    with torch.no_grad():
        np.testing.assert_allclose(module(torch.from_numpy(observations)).numpy(), trained(observations), atol=5e-6)


def runtimes():
    """Whatever computes ONNX files: Microsoft's runtime, and the reference that comes with the format."""
    return ["onnxruntime", "onnx.reference"]


@pytest.mark.parametrize("runtime", runtimes())
def test_an_onnx_file_acts_alike(policy, observations, tmp_path, runtime):
    pytest.importorskip("onnx", reason="onnx is not installed")
    policy.to_onnx(tmp_path / "policy.onnx")
    if runtime == "onnxruntime":
        pytest.importorskip("onnxruntime", reason="onnxruntime is not installed")
        import onnxruntime

        session = onnxruntime.InferenceSession(tmp_path / "policy.onnx", providers=["CPUExecutionProvider"])
        assert [(x.name, x.shape) for x in session.get_inputs()] == [("observation", ["batch", 57])]
        assert [(x.name, x.shape) for x in session.get_outputs()] == [("action", ["batch", 26])]
    else:
        from onnx.reference import ReferenceEvaluator

        session = ReferenceEvaluator(str(tmp_path / "policy.onnx"))
    for rows in (observations, observations[:1]):
        [actions] = session.run(None, {"observation": rows})
        np.testing.assert_allclose(actions, policy(rows), atol=2e-6)


def test_an_onnx_file_comes_back(policy, observations, tmp_path):
    pytest.importorskip("onnx", reason="onnx is not installed")
    policy.to_onnx(tmp_path / "policy.onnx")
    again = myoenv.Policy.from_onnx(tmp_path / "policy.onnx")
    assert np.array_equal(again(observations), policy(observations))
    assert (again.observation_names, again.action_names) == (policy.observation_names, policy.action_names)


def test_other_onnx_files_are_refused(policy, tmp_path):
    onnx = pytest.importorskip("onnx", reason="onnx is not installed")
    path = tmp_path / "policy.onnx"
    with pytest.raises(FileNotFoundError):
        myoenv.Policy.from_onnx(path)
    path.write_bytes(b"no such thing")
    with pytest.raises(myoenv.TrainingError, match=r"is no ONNX file that Policy\.to_onnx wrote"):
        myoenv.Policy.from_onnx(path)
    policy.to_onnx(path)
    model = onnx.load(path)
    sigmoid = next(node for node in model.graph.node if node.op_type == "Sigmoid")
    sigmoid.op_type = "Tanh"
    onnx.save(model, path)
    with pytest.raises(myoenv.TrainingError, match="computes something else"):
        myoenv.Policy.from_onnx(path)


@pytest.mark.parametrize("package", ["onnx", "torch"])
def test_without_the_package_it_says_so(policy, tmp_path, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.delitem(sys.modules, f"myoenv.{package}_policy", raising=False)
    write = {"onnx": lambda: policy.to_onnx(tmp_path / "policy.onnx"), "torch": policy.to_torch}[package]
    with pytest.raises(ImportError, match=rf"pip install 'myoenv\[{package}\]'"):
        write()


def test_what_lives_with_threads_says_why_it_cannot_be_copied(make):
    single = myoenv.make("pointing-single")
    for env in (make(), single, single._env):
        for way in (pickle.dumps, copy.copy, copy.deepcopy):
            if way is copy.copy and env is not single._env:
                # A second name for the same environment, as always in Python.
                continue
            with pytest.raises(TypeError, match=r"an environment cannot be pickled or copied.*save_state"):
                way(env)
    single.close()


def test_tasks_and_models_are_copied(short_task):
    task, model = myoenv.load_task(short_task), myoenv.Model()
    for way in (lambda thing: pickle.loads(pickle.dumps(thing)), copy.deepcopy):
        assert way(task) == task and myoenv.to_dict(way(model)) == myoenv.to_dict(model)
