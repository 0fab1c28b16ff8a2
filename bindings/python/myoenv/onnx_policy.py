"""A policy as an ONNX file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from myoenv._native import TrainingError, __version__, write_whole

try:
    import onnx
except ImportError:
    raise ImportError("ONNX files need the package onnx; install it with: pip install 'myoenv[onnx]'") from None

# Old enough for any runtime, new enough for all that is used here.
_OPSET = 17
_IR_VERSION = 8

Weights = Mapping[str, NDArray[np.float32]]


def write(weights: Weights, observation_names: Sequence[str], action_names: Sequence[str], path: str) -> None:
    """Writes the file, whole or not at all."""
    write_whole(path, _model(weights, observation_names, action_names).SerializeToString())


def read(path: str) -> tuple[dict[str, NDArray[np.float32]], list[str], list[str]]:
    """Weights, names of observations and names of actions of a file that `write` wrote."""
    try:
        model = onnx.load(path)
        names = {entry.key: json.loads(entry.value) for entry in model.metadata_props if entry.key.endswith("_names")}
        observation_names, action_names = names["observation_names"], names["action_names"]
    except FileNotFoundError:
        raise
    except Exception as error:
        raise TrainingError(f"{path} is no ONNX file that Policy.to_onnx wrote: {error}") from None
    constants = {one.name: np.array(onnx.numpy_helper.to_array(one)) for one in model.graph.initializer}
    weights = {name: array for name, array in constants.items() if name in _weight_names(constants)}
    # Equal weights in another graph would be another policy.
    expected = _nodes(sum(name.endswith(".weight") for name in weights))
    if list(model.graph.node) != expected:
        raise TrainingError(
            f"{path} computes something else than Policy.to_onnx writes; only its weights may be changed"
        )
    return weights, observation_names, action_names


def _weight_names(constants: Mapping[str, Any]) -> set[str]:
    return {name for name in constants if not name.startswith("constant_")}


def _nodes(layers: int) -> list[Any]:
    """What is computed; the description is that of `Policy.weights`."""
    node = onnx.helper.make_node
    nodes = [
        node("Sub", ["observation", "observation_mean"], ["centred"]),
        node("Mul", ["centred", "observation_inverse_std"], ["scaled"]),
        node("Neg", ["observation_limit"], ["observation_least"]),
        node("Clip", ["scaled", "observation_least", "observation_limit"], ["x0"]),
    ]
    for k in range(layers):
        out = f"z{k + 1}"
        nodes.append(node("Gemm", [f"x{k}", f"layers.{k}.weight", f"layers.{k}.bias"], [out], transB=1))
        if k < layers - 1:
            nodes.append(node("Sigmoid", [out], [f"s{k + 1}"]))
            nodes.append(node("Mul", [out, f"s{k + 1}"], [f"x{k + 1}"]))
    return [
        *nodes,
        node("Mul", [f"z{layers}", "action_scale"], ["stretched"]),
        node("Add", ["stretched", "action_offset"], ["shifted"]),
        node("Clip", ["shifted", "constant_-1", "constant_1"], ["action"]),
    ]


def _model(weights: Weights, observation_names: Sequence[str], action_names: Sequence[str]) -> Any:
    helper, kind = onnx.helper, onnx.TensorProto.FLOAT
    constants = {**weights, "constant_-1": np.float32(-1), "constant_1": np.float32(1)}
    graph = helper.make_graph(
        _nodes(sum(name.endswith(".weight") for name in weights)),
        "policy",
        [helper.make_tensor_value_info("observation", kind, ["batch", len(observation_names)])],
        [helper.make_tensor_value_info("action", kind, ["batch", len(action_names)])],
        [onnx.numpy_helper.from_array(np.asarray(array), name) for name, array in constants.items()],
    )
    model = helper.make_model(
        graph,
        producer_name="myoenv",
        producer_version=__version__,
        opset_imports=[helper.make_opsetid("", _OPSET)],
        ir_version=_IR_VERSION,
    )
    names = {"observation_names": observation_names, "action_names": action_names}
    helper.set_model_props(model, {key: json.dumps(list(value)) for key, value in names.items()})
    onnx.checker.check_model(model)
    return model
