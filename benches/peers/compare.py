"""Control steps per second of `walk`: msk against MuJoCo through Gymnasium with the task in NumPy (`walk.py`), in turn.

    pip install ./python "mujoco==4.0.0" && python benches/peers/compare.py [--num-envs 16] [--steps 100] [--rounds 5]

First checks that both give the same observation and reward on the same states. Then both take the same number of steps with the same
random actions on the same processors: on one, Gymnasium's SyncVectorEnv; on several, its AsyncVectorEnv, a process for each
environment. msk is `gymnasium.make_vec("msk/Walk-v0", num_envs=..., threads=...)`. Episodes that end begin anew in the same step. Prints
a Markdown table: medians of the rounds, and the least and the greatest ratio of a round.
"""

import argparse
import os
import statistics
import sys
import tempfile
import time

import gymnasium
import mujoco
import numpy as np
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv
from walk import Walk

import msk

STATES = 64
"""Initial states from which the peer draws."""


def write(folder: str) -> None:
    """The files of the peer: the model and the reference as exported, and initial states of the task."""
    msk.compile("walk").export(folder)
    env = msk.make("walk", dtype=np.float64)
    states = {"qpos": [], "qvel": [], "phase": []}
    for seed in range(STATES):
        observation, _ = env.reset(seed=seed)
        sine, cosine = observation[channels(env)["phase"]]
        states["qpos"].append(env.state["qpos"])
        states["qvel"].append(env.state["qvel"])
        states["phase"].append(np.arctan2(sine, cosine) / (2.0 * np.pi) % 1.0)
    np.savez(f"{folder}/states.npz", **states)


def channels(env: msk.Env) -> dict[str, slice]:
    return {channel.name: channel.slice for channel in env.task.channels}


def check(folder: str) -> None:
    """Both see and reward the same states in the same way."""
    ours, peer = msk.make("walk", dtype=np.float64), Walk(folder)
    draws = np.random.default_rng(0)
    for seed in range(4):
        ours.reset(seed=seed)
        peer.reset_to(seed)
        for _ in range(60):
            observation, reward, terminated, _, _ = ours.step(draws.uniform(-1.0, 1.0, ours.action_space.shape))
            peer.steps += 1
            for name in ("qpos", "qvel", "act", "ctrl"):
                getattr(peer.data, name)[:] = ours.state[name]
            mujoco.mj_forward(peer.model, peer.data)
            np.testing.assert_allclose(peer.observation(), observation, rtol=1e-5, atol=1e-5)
            terms, fallen = peer.judge()
            np.testing.assert_allclose(sum(terms.values()), reward, rtol=1e-6, atol=1e-6)
            assert fallen == terminated
            if fallen:
                break


def peer_of(folder: str, num_envs: int, threads: int) -> gymnasium.vector.VectorEnv:
    kind = SyncVectorEnv if threads == 1 else AsyncVectorEnv
    return kind([lambda: Walk(folder)] * num_envs, autoreset_mode=AutoresetMode.SAME_STEP)


def ours_of(_folder: str, num_envs: int, threads: int) -> gymnasium.vector.VectorEnv:
    return gymnasium.make_vec("msk/Walk-v0", num_envs=num_envs, threads=threads)


def cpu_time(envs: gymnasium.vector.VectorEnv) -> float:
    """Seconds of CPU time of this process, and of those in which environments live."""
    others = dict(envs.call("cpu_time")) if isinstance(envs, SyncVectorEnv | AsyncVectorEnv) else {}
    return sum((others | {os.getpid(): time.process_time()}).values())


def measure(envs: gymnasium.vector.VectorEnv, steps: int, seed: int) -> tuple[float, float]:
    """Control steps per second of CPU time and of wall-clock time."""
    draws = np.random.default_rng(seed)
    actions = draws.uniform(-1.0, 1.0, (8, *envs.action_space.shape)).astype(np.float32)
    envs.reset(seed=seed)
    cpu, wall = cpu_time(envs), time.perf_counter()
    for step in range(steps):
        envs.step(actions[step % len(actions)])
    wall, cpu = time.perf_counter() - wall, cpu_time(envs) - cpu
    return envs.num_envs * steps / cpu, envs.num_envs * steps / wall


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--num-envs", type=int, default=16)
    parser.add_argument("--steps", type=int, default=100, help="vector steps of a round")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--threads", type=int, nargs="*", default=[1, 2])
    given = parser.parse_args()
    processors = sorted(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory() as folder:
        write(folder)
        check(folder)
        print(
            "| processors | clock | MuJoCo, control steps/s | msk, control steps/s | ratio of medians | ratios of rounds |"
        )
        print("|--:|---|--:|--:|--:|---|")
        for threads in given.threads:
            if threads > len(processors):
                raise SystemExit(
                    f"expected at most {len(processors)} threads, as many as there are processors, found {threads}"
                )
            os.sched_setaffinity(0, processors[:threads])
            sides = [make(folder, given.num_envs, threads) for make in (peer_of, ours_of)]
            rounds = []
            for number in range(given.rounds):
                order = (0, 1) if number % 2 == 0 else (1, 0)
                found = {side: measure(sides[side], given.steps, number) for side in order}
                rounds.append((found[0], found[1]))
                print(f"round {number + 1}: {found[0]} and {found[1]}", file=sys.stderr)
            for side in sides:
                side.close()
            for clock, name in enumerate(("CPU", "wall")):
                theirs, ours = ([measured[side][clock] for measured in rounds] for side in (0, 1))
                ratios = [mine / peer for peer, mine in zip(theirs, ours, strict=True)]
                ratio = statistics.median(ours) / statistics.median(theirs)
                print(
                    f"| {threads} | {name} | {statistics.median(theirs):,.0f} | {statistics.median(ours):,.0f} "
                    f"| {ratio:.1f} | {min(ratios):.1f} to {max(ratios):.1f} |"
                )


if __name__ == "__main__":
    main()
