"""The simulator against MuJoCo's three ways of stepping: one episode (`mj_step`), and many (`mujoco.rollout`, `mujoco.batch`).

    cargo build --release && cargo build --release -p msk-physics --example speed --example together
    pip install "mujoco==4.0.0" numpy
    python benches/peers/physics.py [--protocol falling|standing] [--rounds 5] [--seconds 1.5] [--episodes 8 64] [--json FILE]

One thread each, of the same model file, from the same start, with the same excitations: both draw them anew every ten milliseconds
from SplitMix64 with the seed 1. The two take turns, and steps are counted per second of CPU time. It prints medians of the rounds with
the least and the greatest, microseconds per stage of both (those of MuJoCo by its own timers), rows, contacts and iterations of the solver, how long the
model takes to compile, and how much memory an episode takes. Also with MuJoCo's `implicitfast`; and, of ours, with elastic tendons.
"""

import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import time

import mujoco
import mujoco.batch
import mujoco.rollout
import numpy as np

ROOT = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "benches"))
from ratio import start

DURATION = {"falling": 1.5, "standing": 0.2}
CHUNK = 10
"""Physics steps between two draws."""


class SplitMix64:
    """The generator of the examples `speed` and `together`."""

    def __init__(self, seed):
        self.state = np.uint64(seed)

    def random(self, count):
        with np.errstate(over="ignore"):
            z = self.state + np.uint64(0x9E3779B97F4A7C15) * np.arange(1, count + 1, dtype=np.uint64)
            self.state = z[-1]
            z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
            z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
            return (z ^ (z >> np.uint64(31))).astype(float) / 2.0**64


def one(model, protocol, seconds):
    """Steps per second of `mj_step`."""
    data, random = mujoco.MjData(model), SplitMix64(1)
    start(model, data, protocol == "standing")
    steps, begin, deadline = 0, time.thread_time(), time.monotonic() + seconds
    while time.monotonic() < deadline:
        if data.time >= DURATION[protocol]:
            start(model, data, protocol == "standing")
        data.ctrl[:] = random.random(model.nu)
        mujoco.mj_step(model, data, nstep=CHUNK)
        steps += CHUNK
    return steps / (time.thread_time() - begin)


def begin_of(model, protocol):
    """The first state, as all kinds of many take it."""
    data = mujoco.MjData(model)
    start(model, data, protocol == "standing")
    state = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, state, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    return data.qpos.copy(), state


def many_by_batch(model, protocol, seconds, episodes):
    """Steps per second of `mujoco.batch`, every episode at its own time."""
    batch, random = mujoco.batch.Batch(model, nsim=episodes, nthread=1), SplitMix64(1)
    position = begin_of(model, protocol)[0]
    qpos, ctrl, clock = batch.bind("qpos"), batch.bind("ctrl"), batch.bind("time")
    qpos[:] = position
    limits = DURATION[protocol] * np.arange(1, episodes + 1) / episodes
    steps, begin, deadline = 0, time.thread_time(), time.monotonic() + seconds
    while time.monotonic() < deadline:
        ended = np.flatnonzero(np.asarray(clock).reshape(-1) >= limits)
        if len(ended):
            batch.reset(ended)
            qpos[ended] = position
            limits[ended] = DURATION[protocol]
        ctrl[:] = random.random(episodes * model.nu).reshape(episodes, -1)
        batch.step(nstep=CHUNK)
        steps += CHUNK * episodes
    return steps / (time.thread_time() - begin)


def many_by_rollout(model, protocol, seconds, episodes):
    """Steps per second of `mujoco.rollout`: whole episodes, whose excitations are drawn before."""
    data, random, (_, state) = mujoco.MjData(model), SplitMix64(1), begin_of(model, protocol)
    draws = round(DURATION[protocol] / model.opt.timestep / CHUNK)
    control = np.repeat(random.random(episodes * draws * model.nu).reshape(episodes, draws, model.nu), CHUNK, axis=1)
    steps, spent, deadline = 0, 0.0, time.monotonic() + seconds
    with mujoco.rollout.Rollout(nthread=0) as rollout:
        while time.monotonic() < deadline:
            for episode in range(episodes):
                begin = time.thread_time()
                rollout.rollout(model, [data], state, control[episode : episode + 1])
                spent += time.thread_time() - begin
                steps += draws * CHUNK
                if time.monotonic() >= deadline:
                    break
    return steps / spent


def ours(program, path, protocol, seconds, *more):
    """The report of an example, with its steps per second of CPU time."""
    command = [str(program), str(path), protocol, str(seconds), *map(str, more)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


STAGES = {
    "kinematics and tendons": "POS_KINEMATICS",
    "inertia": "POS_INERTIA",
    "contacts": "POS_COLLISION",
    "rows": "POS_MAKE",
    "velocities": "VELOCITY",
    "muscles": "ACTUATION",
    "solver": "CONSTRAINT",
    "integrator": "ADVANCE",
}


def stages_of_mujoco(model, protocol, seconds):
    """Microseconds per step of MuJoCo's own timers, and the sizes of its constraint problem."""
    data, random = mujoco.MjData(model), SplitMix64(1)
    start(model, data, protocol == "standing")
    sizes = {"rows": [], "contacts": [], "iterations": []}
    mujoco.set_mjcb_time(lambda: time.perf_counter_ns() * 1e-3)
    try:
        steps, deadline = 0, time.monotonic() + seconds
        totals = np.zeros(len(data.timer))
        while time.monotonic() < deadline:
            if data.time >= DURATION[protocol]:
                totals += np.array([timer.duration for timer in data.timer])
                start(model, data, protocol == "standing")
            data.ctrl[:] = random.random(model.nu)
            for _ in range(CHUNK):
                mujoco.mj_step(model, data)
                sizes["rows"].append(data.nefc)
                sizes["contacts"].append(data.ncon)
                sizes["iterations"].append(int(data.solver_niter[0]))
            steps += CHUNK
        totals += np.array([timer.duration for timer in data.timer])
    finally:
        mujoco.set_mjcb_time(None)
    per_stage = {name: totals[getattr(mujoco.mjtTimer, f"mjTIMER_{timer}")] / steps for name, timer in STAGES.items()}
    spreads = {name: {"mean": np.mean(values), "p95": int(np.percentile(values, 95))} for name, values in sizes.items()}
    return per_stage, spreads


def spread(values):
    return f"{statistics.median(values):,.0f} ({min(values):,.0f} to {max(values):,.0f})"


def compiled_in(command):
    """CPU seconds of a program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def of_program(program, path, protocol, seconds, flags):
    """Steps per second of CPU time of `msk physics bench`."""

    def ran(seconds):
        command = [
            str(program),
            "physics",
            "bench",
            "--model",
            path,
            "--protocol",
            protocol,
            "--seconds",
            str(seconds),
            "--json",
            *flags,
        ]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return report["steps"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    # Reading the model is no part of a step.
    (steps, whole), (_, reading) = ran(seconds), ran(0.0)
    return steps / (whole - reading)


def memory(program, path, episodes):
    """Peak memory of a program with so many episodes, MB."""
    script = "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, capture_output=True); " + (
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024)"
    )
    command = [sys.executable, "-c", script, str(program), str(path), "falling", "0.1", str(episodes)]
    return float(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", default=str(ROOT / "bodies/models/human416.xml"))
    parser.add_argument(
        "--programs",
        type=pathlib.Path,
        default=ROOT / "target/release/examples",
        help="folder of `speed` and `together`",
    )
    parser.add_argument(
        "--msk", type=pathlib.Path, default=ROOT / "target/release/msk", help="the program, for elastic tendons"
    )
    parser.add_argument("--protocol", choices=["falling", "standing"], default="falling")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1.5)
    parser.add_argument("--episodes", type=int, nargs="+", default=[8, 64])
    parser.add_argument("--json", type=pathlib.Path, help="also write all numbers here")
    arguments = parser.parse_args()
    speed, together = arguments.programs / "speed", arguments.programs / "together"
    path, protocol, seconds = arguments.model, arguments.protocol, arguments.seconds
    model = mujoco.MjModel.from_xml_path(path)
    implicit = mujoco.MjModel.from_xml_path(path)
    implicit.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST

    pairs = {
        "one, mj_step": (lambda: ours(speed, path, protocol, seconds), lambda: one(model, protocol, seconds)),
        "one, mj_step with implicitfast": (
            lambda: ours(speed, path, protocol, seconds),
            lambda: one(implicit, protocol, seconds),
        ),
    }
    for count in arguments.episodes:
        mine = lambda count=count: ours(together, path, protocol, seconds, count)
        pairs[f"{count}, mujoco.batch"] = (mine, lambda count=count: many_by_batch(model, protocol, seconds, count))
        pairs[f"{count}, mujoco.rollout"] = (mine, lambda count=count: many_by_rollout(model, protocol, seconds, count))

    report = {"protocol": protocol, "mujoco": mujoco.__version__, "pairs": {}}
    print(
        f"{protocol}, one thread, {arguments.rounds} rounds of {seconds} s, steps per second of CPU time: medians (least to greatest)\n"
    )
    print("| episodes, against | msk | MuJoCo | ratio of medians | ratios of rounds |\n|---|--:|--:|--:|---|")
    for name, (mine, theirs) in pairs.items():
        rounds = [(mine()["steps_per_second"], theirs()) for _ in range(arguments.rounds)]
        left, right = zip(*rounds, strict=True)
        ratios = [a / b for a, b in rounds]
        ratio = statistics.median(left) / statistics.median(right)
        print(
            f"| {name} | {spread(left)} | {spread(right)} | {ratio:.2f} | {min(ratios):.2f} to {max(ratios):.2f} |",
            flush=True,
        )
        report["pairs"][name] = {"msk": left, "mujoco": right}

    alone, lanes = ours(speed, path, protocol, seconds), ours(together, path, protocol, seconds, 8)
    stages, sizes = stages_of_mujoco(model, protocol, seconds)
    print("\n| microseconds per step | msk | msk, in eight lanes | MuJoCo |\n|---|--:|--:|--:|")
    for name, theirs in stages.items():
        # MuJoCo's timer of kinematics also runs while it finds the paths of tendons.
        parts = name.split(" and ")
        left, right = (sum(report["us_per_stage"][part] for part in parts) for report in (alone, lanes))
        print(f"| {name} | {left:.1f} | {right:.1f} | {theirs:.1f} |")
    print("\n| per step | msk: mean, 95 % | MuJoCo: mean, 95 % |\n|---|---|---|")
    for name, theirs in sizes.items():
        print(f"| {name} | {alone[name]['mean']:.1f}, {alone[name]['p95']} | {theirs['mean']:.1f}, {theirs['p95']} |")
    report |= {"speed": alone, "together": lanes, "stages": stages, "sizes": sizes}

    script = f"import mujoco; mujoco.MjModel.from_xml_path({path!r})"
    compile_ours = statistics.median(compiled_in([str(speed), path, protocol, "0"]) for _ in range(3))
    compile_theirs = statistics.median(compiled_in([sys.executable, "-c", script]) for _ in range(3))
    compile_theirs -= statistics.median(compiled_in([sys.executable, "-c", "import mujoco"]) for _ in range(3))
    few, most = 64, 1088
    per_episode = (memory(together, path, most) - memory(together, path, few)) / (most - few) * 1024
    data = mujoco.MjData(model)
    print(
        f"\nCompiling the model: msk {compile_ours * 1e3:.0f} ms (with its plan and first state), MuJoCo {compile_theirs * 1e3:.0f} ms of CPU time."
    )
    state = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION) * 8 / 1024
    print(
        f"A further episode: msk {per_episode:.0f} kB in lanes; MuJoCo {(data.nbuffer + data.maxuse_arena) / 1024:.0f} kB for an mjData without"
        f" contacts, {state:.0f} kB for a row of `mujoco.batch`."
    )
    report |= {"compile_seconds": [compile_ours, compile_theirs], "kilobytes_per_episode": per_episode}

    rigid, elastic = (
        [of_program(arguments.msk, path, protocol, seconds, flags) for _ in range(arguments.rounds)]
        for flags in ([], ["--elastic"])
    )
    print(f"`msk physics bench`: {spread(rigid)} steps per second of CPU time, with elastic tendons {spread(elastic)}.")
    report |= {"rigid": rigid, "elastic": elastic}
    if arguments.json:
        arguments.json.write_text(json.dumps(report, indent=1) + "\n")


if __name__ == "__main__":
    main()
