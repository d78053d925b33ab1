"""The example of a learner goes on exactly where it was interrupted."""

import sys

import pytest

from conftest import REPOSITORY

torch = pytest.importorskip("torch", reason="PyTorch is not installed")
pytest.importorskip("tensorboard", reason="TensorBoard is not installed")
pytest.importorskip("tqdm", reason="tqdm is not installed")

sys.path.insert(0, str(REPOSITORY / "examples" / "python"))
import ppo


def test_a_resumed_run_has_the_bits_of_one_that_was_never_interrupted(tmp_path):
    settings = ppo.Settings(num_envs=4, rollout=16, minibatches=2)
    whole = ppo.Trainer(settings)
    logged = [whole.update() for _ in range(4)]
    first = ppo.Trainer(settings)
    [first.update() for _ in range(2)]
    first.save(tmp_path / "checkpoint.pt")
    second = ppo.Trainer.load(tmp_path / "checkpoint.pt")
    assert [second.update() for _ in range(2)] == logged[2:]
    assert second.steps == whole.steps == 256
    assert all(torch.equal(one, other) for one, other in zip(whole.agent.parameters(), second.agent.parameters()))
