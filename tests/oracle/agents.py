#!/usr/bin/env python3
"""Agents as ONNX files, by ONNX Runtime, against their own tensors by NumPy in double precision.

    pip install onnx onnxruntime numpy safetensors
    msk agent export FOLDER --onnx agent.onnx
    tests/oracle/agents.py FOLDER agent.onnx
"""

import sys
import tomllib
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
from safetensors.numpy import load_file

FUNCTIONS = {
    "tanh": np.tanh,
    "relu": lambda x: np.maximum(x, 0),
    "elu": lambda x: np.where(x > 0, x, np.expm1(np.minimum(x, 0))),
    "silu": lambda x: x / (1 + np.exp(-x)),
}


def expected(folder: Path, seen: np.ndarray) -> np.ndarray:
    agent = tomllib.loads((folder / "agent.toml").read_text())
    tensors = {name: value.astype(np.float64) for name, value in load_file(folder / "policy.safetensors").items()}
    network = agent["network"]
    x = (seen - tensors["observation.mean"]) / tensors["observation.std"]
    x = np.clip(x, -agent["clip"], agent["clip"])
    for layer in range(len(network["hidden"]) + 1):
        x = x @ tensors[f"{layer}.weight"].T + tensors[f"{layer}.bias"]
        if layer < len(network["hidden"]):
            if network["layer_norm"]:
                x = (x - x.mean(-1, keepdims=True)) / np.sqrt(x.var(-1, keepdims=True) + 1e-5)
                x = x * tensors[f"norm{layer}.scale"] + tensors[f"norm{layer}.shift"]
            x = FUNCTIONS[network["activation"]](x)
    return np.tanh(x) if agent["squash"] else x


def main() -> None:
    folder, path = Path(sys.argv[1]), Path(sys.argv[2])
    onnx.checker.check_model(onnx.load(path), full_check=True)
    session = onnxruntime.InferenceSession(path)
    width = session.get_inputs()[0].shape[1]
    seen = np.random.default_rng(0).normal(0, 1, (64, width)).astype(np.float32)
    found = session.run(["action"], {"observation": seen})[0]
    error = np.abs(found - expected(folder, seen.astype(np.float64))).max()
    print(f"{path}: {found.shape[1]} entries of {len(seen)} actions agree within {error:.1e}")
    assert error < 1e-6 * max(1.0, np.abs(found).max()), error


if __name__ == "__main__":
    main()
