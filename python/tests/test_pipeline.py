"""Steps in the background: the numbers of a vector environment to the bit, in the order in which they were sent."""

import os
import signal
import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import msk
from conftest import CALM, actions, short

SLOTS, BATCH = 12, 4


@pytest.mark.parametrize("mode", [AutoresetMode.SAME_STEP, AutoresetMode.NEXT_STEP])
def test_batches_are_parts_of_one_vector_environment(task: msk.Task, mode: AutoresetMode):
    """Observations, rewards, flags and infos, through many ends and resets."""
    whole = msk.make_vec(task, SLOTS, autoreset_mode=mode, threads=1)
    pipeline = msk.Pipeline(task, SLOTS, BATCH, autoreset_mode=mode, threads=2)
    observations, infos = whole.reset(seed=3)
    none = np.zeros(SLOTS, bool)
    expected = (observations, np.zeros(SLOTS), none, none, infos)
    pipeline.reset(seed=3)
    ends = 0
    batches = [slice(first, first + BATCH) for first in range(0, SLOTS, BATCH)]
    for number, action in enumerate(actions(task, 30, SLOTS)):
        at_once = number % 2 == 1
        for slots in batches:
            *arrays, infos = pipeline.recv()
            assert np.array_equal(infos.pop("env_id"), np.arange(SLOTS)[slots])
            for name, found, of_all in zip(
                ("observation", "reward", "terminated", "truncated"), arrays, expected, strict=False
            ):
                assert np.array_equal(found, of_all[slots]), name
            compare(infos, expected[4], slots)
            if not at_once:
                pipeline.send(action[slots])
        for slots in batches if at_once else []:
            pipeline.send(action[slots])
        expected = whole.step(action)
        ends += (expected[2] | expected[3]).sum()
    assert ends > 2 * SLOTS


def compare(found: dict, of_all: dict, slots: slice) -> None:
    """Infos of a batch: those of its slots."""
    for key, value in found.items():
        if isinstance(value, dict):
            compare(value, of_all[key], slots)
        elif not key.startswith("_"):
            mask = found[f"_{key}"]
            assert np.array_equal(mask, of_all[f"_{key}"][slots]), key
            assert all(np.array_equal(value[slot], of_all[key][slots][slot]) for slot in np.flatnonzero(mask)), key
    missing = {key for key in of_all.keys() - found.keys() if key.startswith("_") and of_all[key][slots].any()}
    assert not missing


def test_a_step_that_was_sent_is_that_of_step(task: msk.Task):
    sent, stepped = (msk.make_vec(task, 5, threads=2) for _ in range(2))
    sent.reset(seed=0), stepped.reset(seed=0)
    for action in actions(task, 20, 5):
        sent.send(action)
        found, expected = sent.recv(), stepped.step(action)
        assert all(np.array_equal(one, other) for one, other in zip(found[:4], expected[:4], strict=True))
        assert found[4].keys() == expected[4].keys()


def test_a_step_under_way_excludes_everything_else(task: msk.Task):
    envs = msk.make_vec(task, 2, threads=1)
    action = actions(task, 2)
    with pytest.raises(gymnasium.error.ResetNeeded, match=r"before send\(\)"):
        envs.send(action)
    envs.reset(seed=0)
    with pytest.raises(RuntimeError, match=r"no step is under way: call send\(\) before recv\(\)"):
        envs.recv()
    envs.send(action)
    uses = [
        lambda: envs.send(action),
        lambda: envs.step(action),
        lambda: envs.reset(seed=0),
        lambda: envs.state(0),
        envs.snapshot,
        lambda: envs.weights.__setitem__("upright", 2),
    ]
    for use in uses:
        with pytest.raises(RuntimeError, match=r"a step is under way: call recv\(\) first"):
            use()
    envs.recv()
    envs.step(action)


def test_wrong_actions_are_not_sent(task: msk.Task):
    envs = msk.make_vec(task, 2, threads=1)
    envs.reset(seed=0)
    with pytest.raises(ValueError, match="must have the shape"):
        envs.send(actions(task, 3))
    with pytest.raises(RuntimeError, match="no step is under way"):
        envs.recv()
    pipeline = msk.Pipeline(task, 4, 2, threads=1)
    pipeline.reset(seed=0)
    pipeline.recv()
    with pytest.raises(ValueError, match="must have the shape"):
        pipeline.send(actions(task, 4))
    pipeline.send(actions(task, 2))


def test_what_is_dropped_disturbs_nothing(task: msk.Task):
    pipeline, other = msk.Pipeline(task, 4, 2, threads=1), msk.make_vec(task, 2, threads=1)
    pipeline.reset(seed=0), other.reset(seed=7)
    pipeline.recv()
    pipeline.send(actions(task, 2))
    del pipeline
    other.send(actions(task, 2))
    other.recv()


def test_a_reset_begins_anew(task: msk.Task):
    pipeline = msk.Pipeline(task, 4, 2, threads=1)
    with pytest.raises(RuntimeError, match="no batch is under way"):
        pipeline.recv()
    with pytest.raises(RuntimeError, match="no batch waits for actions"):
        pipeline.send(actions(task, 2))
    pipeline.reset(seed=0)
    first = [pipeline.recv()[0] for _ in pipeline.batches]
    pipeline.send(actions(task, 2))
    pipeline.reset(seed=[0, 1, 2, 3])
    assert np.array_equal(first, [pipeline.recv()[0] for _ in pipeline.batches])
    with pytest.raises(ValueError, match="expected one seed per environment, 4, found 2"):
        pipeline.reset(seed=[0, 1])


@pytest.mark.parametrize(("slots", "size"), [(4, 3), (4, 0), (4, 8), (0, 1)])
def test_wrong_sizes(task: msk.Task, slots: int, size: int):
    with pytest.raises(ValueError, match="a batch size that divides the number of environments"):
        msk.Pipeline(task, slots, size)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.filterwarnings("ignore:.*use of fork:DeprecationWarning")
def test_a_forked_process_has_a_queue_of_its_own(task: msk.Task):
    away, here = (msk.make_vec(task, 2, threads=2) for _ in range(2))
    away.reset(seed=0), here.reset(seed=1)
    here.send(actions(task, 2)), here.recv()
    away.send(actions(task, 2))
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            here.send(actions(task, 2, seed=1))
            os.write(writer, here.recv()[0].tobytes())
            away.recv()
        except RuntimeError as error:
            os.write(writer, str(error).encode())
        finally:
            os._exit(0)
    os.close(writer)
    away.recv()
    here.send(actions(task, 2, seed=1))
    expected = here.recv()[0].tobytes()
    found = b"".join(iter(lambda: os.read(reader, 1 << 16), b""))
    os.waitpid(child, 0)
    assert found.startswith(expected)
    assert b"the step was sent before this process was forked" in found


@pytest.mark.skipif(sys.platform == "win32", reason="signals differ")
def test_waiting_is_interrupted_and_goes_on():
    task = short(CALM)
    # One batch waits for the steps of all others, which take longer than signals are looked at.
    pipeline = msk.Pipeline(task, 256, 64, threads=1)
    pipeline.reset(seed=0)
    for _ in pipeline.batches:
        pipeline.recv()
        pipeline.send(np.zeros((64, len(task.actions)), np.float32))

    def interrupt(*_: object) -> None:
        raise InterruptedError("as Ctrl-C does")

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.001)
        with pytest.raises(InterruptedError):
            pipeline.batches[-1].recv()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    expected = msk.make_vec(task, 256, threads=1)
    expected.reset(seed=0)
    observations = expected.step(np.zeros((256, len(task.actions)), np.float32))[0]
    assert np.array_equal(np.concatenate([pipeline.recv()[0] for _ in pipeline.batches]), observations)
