"""Threads, signals, forked and spawned processes, defects."""

import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from gymnasium.error import ResetNeeded
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


def in_threads(count: int, work) -> list:
    """What ``work(number)`` gives, or raises, in so many threads that begin together."""
    results: list = [None] * count
    start = threading.Barrier(count)

    def run(number: int) -> None:
        start.wait()
        try:
            results[number] = work(number)
        except Exception as error:  # noqa: BLE001 (which one it is, tests look at)
            results[number] = error

    threads = [threading.Thread(target=run, args=[number], daemon=True) for number in range(count)]
    [thread.start() for thread in threads]
    [thread.join(60) for thread in threads]
    assert not any(thread.is_alive() for thread in threads), "a thread hangs"
    return results


#: What is done with an object that other threads use, too.
SHARED = {
    "env": (
        lambda task: msk.make(task, clip_actions=True),
        lambda env, task: (env.reset(seed=1), env.step(actions(task)), env.state, env.snapshot(), env.draw()),
    ),
    "vector": (
        lambda task: msk.make_vec(task, 64, threads=1),
        lambda envs, task: (
            envs.step(actions(task, 64)),
            envs.state(0),
            envs.snapshot(),
            envs.weights.update({"upright": 2}),
        ),
    ),
    "background": (
        lambda task: msk.make_vec(task, 16, threads=2),
        lambda envs, task: (envs.send(actions(task, 16)), envs.recv()),
    ),
    "simulation": (
        lambda task: msk.physics.Simulation(msk.physics.human()),
        lambda simulation, task: (simulation.step(20), simulation.state(), simulation.forward()),
    ),
    "batch": (
        lambda task: msk.physics.Batch(msk.physics.human(), 8, threads=1),
        lambda batch, task: (batch.step(5), batch.positions(), batch.state(0)),
    ),
    "camera": (
        lambda task: msk.make(task, render_mode="rgb_array", width=64, height=48),
        lambda env, task: env.render(),
    ),
}


@pytest.mark.parametrize("name", SHARED)
def test_threads_that_share_an_object_get_errors_and_never_hang(task: msk.Task, name: str):
    """With the interpreter's lock and, on free-threaded builds, without it."""
    make, use = SHARED[name]
    shared = make(task)
    if hasattr(shared, "reset"):
        shared.reset(**({} if name == "simulation" else {"seed": 0}))
    expected = ("another thread is using this object", "a step is under way", "no step is under way")

    def play(number: int) -> None:
        for _ in range(10):
            try:
                use(shared, task)
            except RuntimeError as error:
                if not any(words in str(error) for words in expected) and not isinstance(error, ResetNeeded):
                    raise

    assert in_threads(4, play) == [None] * 4
    # It is as good as before.
    if name == "background":
        with contextlib.suppress(RuntimeError):
            shared.recv()
    if hasattr(shared, "reset"):
        shared.reset(**({} if name == "simulation" else {"seed": 0}))
    use(shared, task)


def test_another_thread_is_told_apart_from_a_defect(task: msk.Task):
    envs = msk.make_vec(task, 64, threads=1)
    envs.reset(seed=0)
    going = threading.Event()

    def play(number: int) -> None:
        if number == 0:
            going.set()
            for _ in range(20):
                envs.step(actions(task, 64))
        else:
            going.wait()
            end = time.monotonic() + 30
            while time.monotonic() < end:
                envs.state(0)

    _, told = in_threads(2, play)
    assert "another thread is using this object: give each thread one of its own" in str(told)


def test_threads_with_environments_of_their_own_play_the_same_numbers(task: msk.Task):
    """They share the task with its body, and nothing else."""

    def play(number: int) -> bytes:
        envs = msk.make_vec(task, 4, threads=1)
        observations, _ = envs.reset(seed=number)
        seen = [observations.tobytes()]
        for step in range(15):
            observations, rewards, *_ = envs.step(actions(task, 4, seed=step))
            seen += [observations.tobytes(), rewards.tobytes()]
        return b"".join(seen)

    assert in_threads(4, play) == [play(number) for number in range(4)]


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
