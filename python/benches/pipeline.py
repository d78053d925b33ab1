"""Control steps per second of wall-clock time with a policy that takes as long as the simulation: in turn with it, and beside it.

python python/benches/pipeline.py --task walk --batch-size 16 --threads 1 --steps 60 --rounds 5

The policy waits, as for a GPU or another machine, for as long as a step of a batch takes. A vector environment of one batch is stepped
in turn with it; a pipeline of two such batches is stepped while it decides.
"""

import argparse
import statistics
import time
from collections.abc import Callable

import numpy as np

import msk


def in_turn(task: msk.Task, size: int, threads: int, decide: Callable[[], np.ndarray], steps: int) -> float:
    """Seconds of so many steps of a batch."""
    envs = msk.make_vec(task, size, threads=threads)
    envs.reset(seed=0)
    begun = time.perf_counter()
    for _ in range(steps):
        envs.step(decide())
    return time.perf_counter() - begun


def beside(task: msk.Task, size: int, threads: int, decide: Callable[[], np.ndarray], steps: int) -> float:
    """The same in a pipeline of two batches."""
    pipeline = msk.Pipeline(task, 2 * size, size, threads=threads)
    pipeline.reset(seed=0)
    begun = time.perf_counter()
    for _ in range(steps):
        pipeline.recv()
        pipeline.send(decide())
    return time.perf_counter() - begun


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="walk")
    parser.add_argument("--batch-size", type=int, default=16)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    task = msk.compile(given.task)
    actions = np.zeros((given.batch_size, len(task.actions)), np.float32)
    settings = (task, given.batch_size, given.threads)
    wait = in_turn(*settings, lambda: actions, given.steps) / given.steps

    def decide() -> np.ndarray:
        time.sleep(wait)
        return actions

    ratios = []
    for number in range(given.rounds):
        ways = (in_turn, beside) if number % 2 else (beside, in_turn)
        seconds = {way: way(*settings, decide, given.steps) for way in ways}
        ratios.append(seconds[in_turn] / seconds[beside])
        rates = [given.batch_size * given.steps / seconds[way] for way in (in_turn, beside)]
        print(f"in turn {rates[0]:9.0f} steps/s   beside {rates[1]:9.0f} steps/s   ratio {ratios[-1]:.2f}")
    print(f"median ratio {statistics.median(ratios):.2f}, the policy waits for {1000 * wait:.1f} ms")


if __name__ == "__main__":
    main()
