"""Steps per second of CPU time of the vector environment, through Python and in Rust alone, in turn.

cargo build --release --bench batch --manifest-path python/Cargo.toml   # prints where the program is
python python/benches/vector.py PROGRAM --task walk --num-envs 64 --threads 1 --steps 100 --rounds 5

Both play the same episodes with the same actions, and their rewards must be equal to the bit. The package must be built in the
same profile (`pip install ./python` builds for release).
"""

import argparse
import resource
import statistics
import subprocess
import time

import numpy as np

import msk


def through_python(task: str, num_envs: int, threads: int, steps: int) -> tuple[float, float]:
    """Seconds of CPU time, and the sum of all rewards."""
    envs = msk.make_vec(task, num_envs, threads=threads)
    envs.reset(seed=0)
    actions = np.full(envs.action_space.shape, -0.5, np.float32)
    rewards = 0.0
    begun = time.process_time()
    for _ in range(steps):
        for reward in envs.step(actions)[1].tolist():
            rewards += reward
    return time.process_time() - begun, rewards


def in_rust(program: str, task: str, num_envs: int, threads: int, steps: int) -> tuple[float, float]:
    """The same: what the steps add to the CPU time of the program without steps."""

    def run(steps: int) -> tuple[float, float]:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [program, task, str(num_envs), str(threads), str(steps)]
        rewards = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, float(rewards)

    seconds, rewards = run(steps)
    return seconds - run(0)[0], rewards


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--task", default="walk")
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    work = (given.task, given.num_envs, given.threads, given.steps)
    ratios = []
    for number in range(given.rounds):
        if number % 2:
            (python, found), (rust, expected) = through_python(*work), in_rust(given.program, *work)
        else:
            (rust, expected), (python, found) = in_rust(given.program, *work), through_python(*work)
        if found != expected:
            raise SystemExit(f"the rewards differ: {found} and {expected}")
        ratios.append(rust / python)
        taken = given.num_envs * given.steps
        print(f"Python {taken / python:9.0f} steps/s   Rust {taken / rust:9.0f} steps/s   ratio {rust / python:.3f}")
    print(f"median ratio {statistics.median(ratios):.3f}")


if __name__ == "__main__":
    main()
