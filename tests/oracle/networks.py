#!/usr/bin/env python3
"""Writes tests/golden/networks: networks as ONNX files, and what ONNX Runtime computes with them.

    pip install onnx onnxruntime numpy
    tests/oracle/networks.py
"""

import json
import pathlib

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "golden" / "networks"
RANDOM = np.random.default_rng(0)


def tensor(name: str, *shape: int) -> onnx.TensorProto:
    return numpy_helper.from_array(RANDOM.normal(0, 0.5, shape).astype(np.float32), name)


def value(name: str, *shape: int | str) -> onnx.ValueInfoProto:
    return helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)


def write(name: str, nodes: list, inputs: list, outputs: list, tensors: list) -> pathlib.Path:
    graph = helper.make_graph(nodes, name, inputs, outputs, tensors)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=9)
    onnx.checker.check_model(model)
    path = FOLDER / f"{name}.onnx"
    path.write_bytes(model.SerializeToString())
    return path


def actor() -> pathlib.Path:
    """A normaliser, two hidden layers with layer norm, a squashed action beside a value."""
    nodes = [
        helper.make_node("Sub", ["observation", "mean"], ["centred"]),
        helper.make_node("Div", ["centred", "std"], ["scaled"]),
        helper.make_node("Clip", ["scaled", "low", "high"], ["seen"]),
        helper.make_node("Gemm", ["seen", "w0", "b0"], ["a0"], transB=1),
        helper.make_node("LayerNormalization", ["a0", "gain", "shift"], ["n0"], axis=-1),
        helper.make_node("Elu", ["n0"], ["h0"]),
        helper.make_node("MatMul", ["h0", "w1"], ["a1"]),
        helper.make_node("Add", ["a1", "b1"], ["s1"]),
        helper.make_node("Sigmoid", ["s1"], ["g1"]),
        helper.make_node("Mul", ["s1", "g1"], ["h1"]),
        helper.make_node("Gemm", ["h1", "w2", "b2"], ["a2"], transB=1),
        helper.make_node("Tanh", ["a2"], ["action"]),
        helper.make_node("Gemm", ["h1", "w3", "b3"], ["value"], transB=1),
    ]
    std = numpy_helper.from_array(np.array([0.5, 2.0, 1.0], np.float32), "std")
    bounds = [numpy_helper.from_array(np.float32(bound), name) for name, bound in (("low", -2.0), ("high", 2.0))]
    tensors = [tensor("mean", 3), std, *bounds, tensor("w0", 8, 3), tensor("b0", 8), tensor("gain", 8), tensor("shift", 8)]
    tensors += [tensor("w1", 8, 6), tensor("b1", 6), tensor("w2", 2, 6), tensor("b2", 2), tensor("w3", 1, 6), tensor("b3", 1)]
    outputs = [value("value", "batch", 1), value("action", "batch", 2)]
    return write("actor", nodes, [value("observation", "batch", 3)], outputs, tensors)


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    session = onnxruntime.InferenceSession(actor(), providers=["CPUExecutionProvider"])
    seen = RANDOM.normal(0, 2, (6, 3)).astype(np.float32)
    actions = session.run(["action"], {"observation": seen})[0]
    made_by = f"tests/oracle/networks.py, ONNX Runtime {onnxruntime.__version__}"
    rows = {"made_by": made_by, "observations": seen.tolist(), "actions": actions.tolist()}
    (FOLDER / "actor.json").write_text(json.dumps(rows, indent=1) + "\n")

    # What is refused: several inputs, an image, no numbers, several outputs without an action, an operator that may never end.
    one, two = value("observation", 1, 3), value("memory", 1, 3)
    add = helper.make_node("Add", ["observation", "memory"], ["action"])
    write("two_inputs", [add], [one, two], [value("action", 1, 3)], [])
    relu = helper.make_node("Relu", ["pixels"], ["action"])
    write("image", [relu], [value("pixels", 1, 3, 8, 8)], [value("action", 1, 3, 8, 8)], [])
    halves = [helper.make_node(kind, ["observation"], [name]) for kind, name in (("Relu", "left"), ("Tanh", "right"))]
    write("two_outputs", halves, [one], [value("left", 1, 3), value("right", 1, 3)], [])
    grown = helper.make_node("Expand", ["observation", "shape"], ["action"])
    shape = numpy_helper.from_array(np.array([1 << 40, 3], np.int64), "shape")
    write("endless", [grown], [one], [value("action", 1 << 40, 3)], [shape])
    # One number in, every muscle of the embedded body at half.
    rest = [numpy_helper.from_array(np.zeros((416, 1), np.float32), "w"), numpy_helper.from_array(np.full(416, -0.5, np.float32), "b")]
    node = helper.make_node("Gemm", ["observation", "w", "b"], ["action"], transB=1)
    write("half", [node], [value("observation", "batch", 1)], [value("action", "batch", 416)], rest)


if __name__ == "__main__":
    main()
