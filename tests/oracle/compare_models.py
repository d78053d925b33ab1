"""Two models of the same body must move alike: compares accelerations of MuJoCo on both at random states.

    python tests/oracle/compare_models.py ORIGINAL.xml bodies/models/human416.xml [--states 50] [--seed 0]

Needs mujoco==4.0.0 and numpy; ORIGINAL.xml is myofullbody.xml of the PyPI package musclemimic-models==1.0.6. Exit code 1
if any state differs by more than 1e-9 of the largest acceleration, or in the number of contacts or constraint rows.

States: coordinates in and a little beyond their ranges, the root turned at random and lowered into the floor in half of
them, velocities, activations and controls random. Both models are stepped through the same states without warm start.
"""

import argparse
import sys

import mujoco
import numpy as np

TOLERANCE = 1e-9


def random_state(model, rng, on_ground):
    """Position, velocity, activation and control; a standing height that touches the floor if `on_ground`."""
    position = model.qpos0.copy()
    for joint in range(model.njnt):
        address = model.jnt_qposadr[joint]
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            position[address : address + 3] = rng.normal(0, 0.2, 3)
            position[address + 2] += rng.uniform(0.3, 0.95) if on_ground else 3.0
            turn = position[address + 3 : address + 7] + rng.normal(0, 0.4, 4)
            position[address + 3 : address + 7] = turn / np.linalg.norm(turn)
        else:
            low, high = model.jnt_range[joint]
            position[address] = rng.uniform(low - 0.05 * (high - low), high + 0.05 * (high - low))
    return (position, rng.normal(0, 1, model.nv), rng.uniform(0, 1, model.na), rng.uniform(0, 1, model.nu))


def accelerations(model, state):
    data = mujoco.MjData(model)
    data.qpos, data.qvel, data.act, data.ctrl = state
    mujoco.mj_forward(model, data)
    return data


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("original")
    parser.add_argument("flat")
    parser.add_argument("--states", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    if mujoco.__version__ != "4.0.0":
        sys.exit(f"this check is about MuJoCo 4.0.0, found {mujoco.__version__}")
    original = mujoco.MjModel.from_xml_path(arguments.original)
    flat = mujoco.MjModel.from_xml_path(arguments.flat)
    for size in ("nbody", "nq", "nv", "nu", "na", "ntendon", "neq", "njnt", "npair", "nexclude"):
        if getattr(original, size) != getattr(flat, size):
            sys.exit(f"{size} differs: {getattr(original, size)} and {getattr(flat, size)}")

    rng = np.random.default_rng(arguments.seed)
    worst_smooth = worst = 0.0
    contacts = rows = 0
    for index in range(arguments.states):
        state = random_state(original, rng, on_ground=index % 2 == 0)
        first, second = accelerations(original, state), accelerations(flat, state)
        if (first.ncon, first.nefc) != (second.ncon, second.nefc):
            sys.exit(f"state {index}: {first.ncon} and {second.ncon} contacts, {first.nefc} and {second.nefc} rows")
        contacts, rows = contacts + first.ncon, rows + first.nefc
        smooth = np.abs(first.qacc_smooth - second.qacc_smooth).max() / np.abs(first.qacc_smooth).max()
        full = np.abs(first.qacc - second.qacc).max() / np.abs(first.qacc).max()
        worst_smooth, worst = max(worst_smooth, smooth), max(worst, full)
    print(f"mass {original.body_mass.sum():.6f} and {flat.body_mass.sum():.6f} kg")
    print(f"{arguments.states} states, {contacts} contacts, {rows} constraint rows")
    print(f"worst relative difference: {worst_smooth:.2e} without, {worst:.2e} with constraints")
    sys.exit(int(worst > TOLERANCE))


if __name__ == "__main__":
    main()
