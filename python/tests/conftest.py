"""Tasks that the tests share."""

import os
from pathlib import Path

import numpy as np
import pytest

import msk

REPOSITORY = Path(__file__).resolve().parents[2]

SHORT = """
task balance {
    body    human
    control 100 Hz
    horizon 12 steps
    init {
        pose neutral
        root { height on ground, velocity [0.2 m/s, 0, 0] }
        noise joints normal(0, 0.03 rad)
        noise velocities normal(0, 0.3 rad/s)
    }
    observe { com.acceleration; prev(pelvis.height); independent.q }
    reward {
        2 (1..4)  upright = torso.up.z
        3 (fixed) change = 1 s/m * rate(pelvis.height)
    }
    metrics { height = pelvis.height; velocity = com.velocity }
    terminate { early when com.velocity.z < 0 m/s }
    success survived
}
"""
"""Episodes of at most 12 steps, many of which end earlier."""

CALM = ("com.velocity.z < 0 m/s", "pelvis.height < 0.2 m")
"""The change that leaves the horizon as the only end."""


def short(*changes: tuple[str, str], **settings) -> msk.Task:
    """The short task, with parts of its text replaced."""
    text = SHORT
    for before, after in changes:
        assert before in text
        text = text.replace(before, after)
    return msk.compile_text(text, **settings)


@pytest.fixture(scope="session")
def task() -> msk.Task:
    return short()


@pytest.fixture
def env(task: msk.Task) -> msk.Env:
    return msk.make(task)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """The short task in a file."""
    path = tmp_path / "balance.msk"
    path.write_text(SHORT)
    return path


@pytest.fixture(scope="session")
def cluster():
    """Two nodes of Ray on this machine, each with one processor."""
    ray = pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    os.environ["RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO"] = "0"
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


def actions(task: msk.Task, *shape: int, seed: int = 0) -> np.ndarray:
    """Random actions of the given shape, times their entries."""
    return np.random.default_rng(seed).uniform(-1, 1, (*shape, len(task.actions))).astype(np.float32)
