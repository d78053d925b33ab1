"""Threads, signals, forked and spawned processes, defects."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from gymnasium.vector import AsyncVectorEnv

import msk
from conftest import CALM, actions, short
from msk import _native


def test_other_threads_go_on_during_a_step():
    """Another thread counts while 64 environments take a step."""
    task = short(CALM)
    envs = msk.make_vec(task, 64, threads=1)
    envs.reset(seed=0)
    counted, going = 0, True

    def count() -> None:
        nonlocal counted
        while going:
            counted += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    envs.step(actions(task, 64))
    during = counted - before
    going = False
    thread.join()
    assert during > 10


def test_one_environment_serves_one_thread_at_a_time(task: msk.Task):
    envs = msk.make_vec(task, 64, threads=1)
    envs.reset(seed=0)
    errors = []

    def play() -> None:
        try:
            for _ in range(20):
                envs.step(actions(task, 64))
        except RuntimeError as error:
            errors.append(str(error))

    threads = [threading.Thread(target=play) for _ in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all("borrowed" in error for error in errors)
    envs.reset(seed=0)


def _play(task: msk.Task) -> np.ndarray:
    envs = msk.make_vec(task, 3, threads=2)
    envs.reset(seed=0)
    return envs.step(actions(task, 3))[0]


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_in_another_process(task: msk.Task, method: str):
    with multiprocessing.get_context(method).Pool(1) as pool:
        assert np.array_equal(pool.apply_async(_play, (task,)).get(60), _play(task))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
@pytest.mark.filterwarnings("ignore:.*use of fork:DeprecationWarning")
def test_a_forked_process_goes_on():
    """The threads of the parent do not live in the child, which starts its own; the numbers stay the same."""
    task = short(CALM)
    envs, batch = msk.make_vec(task, 3, threads=2), msk.physics.Batch(msk.physics.human(), 9, threads=2)
    envs.reset(seed=0)
    envs.step(actions(task, 3))
    batch.step()
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            batch.step()
            os.write(writer, envs.step(actions(task, 3, seed=1))[0].tobytes() + batch.positions().tobytes())
        finally:
            os._exit(0)
    os.close(writer)
    batch.step()
    expected = envs.step(actions(task, 3, seed=1))[0].tobytes() + batch.positions().tobytes()
    found = b"".join(iter(lambda: os.read(reader, 1 << 16), b""))
    os.waitpid(child, 0)
    assert found == expected


def test_gymnasiums_asynchronous_vector(task: msk.Task):
    envs = AsyncVectorEnv([lambda: msk.make("stand")] * 2, context="spawn")
    observations, _ = envs.reset(seed=0)
    assert np.array_equal(observations, msk.make_vec("stand", 2, threads=1).reset(seed=0)[0])
    envs.close()


@pytest.mark.skipif(sys.platform == "win32", reason="signals differ")
def test_control_c_stops_a_long_computation():
    text = (
        "import msk, signal\n"
        # A shell that starts the tests in the background has interrupts ignored, in the programs that they start, too.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "simulation = msk.physics.Simulation(msk.physics.human())\n"
        "print('ready', flush=True)\n"
        "simulation.step(10**9)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "ready\n"
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert "KeyboardInterrupt" in errors and process.returncode != 0


@pytest.mark.skipif(not hasattr(_native, "provoke_panic"), reason="built for release")
def test_no_panic_reaches_python():
    with pytest.raises(msk.InternalError, match="a defect of msk, not of your program: provoked; please report it"):
        _native.provoke_panic()
