"""Speed against MuJoCo, the two alternating within the same minute.

    cargo build --release && python benches/ratio.py [--protocol falling|standing] [--rounds 5] [--seconds 2]
    cargo build --release -p msk-physics --example speed && python benches/ratio.py --program target/release/examples/speed

Both run one thread of the same model from the same start, muscles excited at random anew every ten milliseconds. MuJoCo steps
in C (`mj_step` with nstep), ten steps a call, so Python costs it less than a thousandth. Prints the steps per second of every
round and the ratio of the medians; with --cpu, per second of CPU time instead of wall-clock time, which is fairer on a
machine that does other things.
"""

import argparse
import json
import pathlib
import resource
import statistics
import subprocess
import time

import mujoco
import numpy as np

ROOT = pathlib.Path(__file__).parent.parent


def start(model, data, standing):
    """As `msk physics bench` starts: the reference configuration, standing with its lowest point on the ground."""
    mujoco.mj_resetData(model, data)
    if not standing:
        return
    mujoco.mj_kinematics(model, data)
    heights = []
    for geom in range(model.ngeom):
        kind, size = model.geom_type[geom], model.geom_size[geom]
        if kind == mujoco.mjtGeom.mjGEOM_PLANE or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        down = data.geom_xmat[geom].reshape(3, 3)[2]
        reach = size[0] + size[1] * abs(down[2]) if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else np.linalg.norm(size * down)
        heights.append(data.geom_xpos[geom, 2] - reach)
    data.qpos[2] -= min(heights)


def steps_per_second_of_mujoco(model, protocol, seconds, clock, random):
    data = mujoco.MjData(model)
    duration = {"falling": 1.5, "standing": 0.2}[protocol]
    chunk = max(1, round(0.01 / model.opt.timestep))
    start(model, data, protocol == "standing")
    steps, begin, deadline = 0, clock(), time.monotonic() + seconds
    while time.monotonic() < deadline:
        if data.time >= duration:
            start(model, data, protocol == "standing")
        data.ctrl[:] = random.random(model.nu)
        mujoco.mj_step(model, data, nstep=chunk)
        steps += chunk
    return steps / (clock() - begin)


def run_msk(program, path, protocol, seconds):
    """The report of `msk physics bench`, or of the examples `speed` and `together`, and the CPU time that it took."""
    if pathlib.Path(program).stem in ("speed", "together"):
        command = [program, path, protocol, str(seconds)]
    else:
        command = [program, "physics", "bench", "--model", path, "--protocol", protocol, "--seconds", str(seconds), "--json"]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return report, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def steps_per_second_of_msk(program, path, protocol, seconds, cpu):
    report, total = run_msk(program, path, protocol, seconds)
    if not cpu:
        return report["steps_per_second"]
    # Reading the model is no part of a step.
    return report["steps"] / (total - run_msk(program, path, protocol, 0.0)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", default=str(ROOT / "bodies/models/human416.xml"))
    parser.add_argument("--msk", "--program", default=str(ROOT / "target/release/msk"), help="the program, or an example of msk-physics: `speed`, `together`")
    parser.add_argument("--protocol", choices=["falling", "standing"], default="falling")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=2.0)
    parser.add_argument("--cpu", action="store_true", help="count CPU time")
    arguments = parser.parse_args()
    model = mujoco.MjModel.from_xml_path(arguments.model)
    random = np.random.default_rng(0)
    ours, theirs = [], []
    for number in range(arguments.rounds):
        ours.append(
            steps_per_second_of_msk(arguments.msk, arguments.model, arguments.protocol, arguments.seconds, arguments.cpu)
        )
        clock = time.thread_time if arguments.cpu else time.monotonic
        theirs.append(steps_per_second_of_mujoco(model, arguments.protocol, arguments.seconds, clock, random))
        print(f"round {number + 1}: msk {ours[-1]:7.0f}   MuJoCo {mujoco.__version__} {theirs[-1]:7.0f}   ratio {ours[-1] / theirs[-1]:.2f}")
    unit = "processor" if arguments.cpu else "wall-clock"
    ratio = statistics.median(ours) / statistics.median(theirs)
    print(f"{arguments.protocol}, one thread: {ratio:.2f} times MuJoCo's steps per second of {unit} time")


if __name__ == "__main__":
    main()
