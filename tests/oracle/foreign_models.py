"""Other people's models, unchanged: read by the program and by MuJoCo, compared at random states, printed as a table.

    cargo build --release
    python -m pip download --no-deps -d wheels dm_control==1.0.50 myosuite==2.8.0 && cd wheels && unzip '*.whl'
    python tests/oracle/foreign_models.py [--states 3] [--seed 0] [--msk FILE] wheels

Takes files and folders; of a folder, every model in it that MuJoCo reads. The original body and its arms come with the
PyPI package musclemimic-models==1.0.6 (folder `musclemimic_models`), dm_control's suite and MyoSuite's models with the wheels
above. None of them is part of this repository. Needs mujoco==4.0.0 and numpy.

Errors are relative to the largest entry, positions absolute in metres; shapes are placed more loosely, because MuJoCo keeps
meshes in single precision. Constraints have their own checks; here the smooth
part of the physics is compared, which is what reading a file decides: kinematics, tendon and actuator lengths, actuator
forces (so length ranges and peak forces too), mass matrix, bias and passive forces. Exits with 1 if a model that MuJoCo reads
is refused, or if a quantity is out of tolerance.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import mujoco
import numpy as np

ROOT = pathlib.Path(__file__).parent.parent.parent
# Column, the quantities in it, whether errors are absolute, tolerance.
COLUMNS = [
    ("place", ("xpos", "xmat", "xipos"), True, 1e-9),
    ("shapes", ("geom_xpos",), True, 1e-6),
    ("length", ("ten_length", "actuator_length"), True, 1e-9),
    ("force", ("actuator_force", "qfrc_actuator"), False, 1e-6),
    ("inertia", ("M",), False, 1e-9),
    ("bias", ("qfrc_bias",), False, 1e-9),
    ("passive", ("qfrc_passive",), False, 1e-9),
    ("qacc_smooth", ("qacc_smooth",), False, 1e-6),
]


def draw(model, rng):
    """Coordinates in their ranges, everything else moderate."""
    position = model.qpos0.copy()
    for joint in range(model.njnt):
        address, kind = model.jnt_qposadr[joint], model.jnt_type[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            position[address : address + 3] += rng.normal(0, 0.2, 3)
            address += 3
        if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            turn = position[address : address + 4] + rng.normal(0, 0.3, 4)
            position[address : address + 4] = turn / np.linalg.norm(turn)
        elif model.jnt_limited[joint]:
            position[address] = rng.uniform(*model.jnt_range[joint])
        else:
            position[address] += rng.normal(0, 0.3)
    low, high = np.where(model.actuator_ctrllimited[:, None], model.actuator_ctrlrange, [-1, 1]).T
    state = {"qpos": position, "qvel": rng.normal(0, 1, model.nv), "act": rng.uniform(0, 1, model.na), "ctrl": rng.uniform(low, high)}
    return {name: values.tolist() for name, values in state.items()}


def theirs(model, state):
    data = mujoco.MjData(model)
    for name, values in state.items():
        getattr(data, name)[:] = values
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    if model.nv:
        mujoco.mj_fullM(model, data, mass)
    out = {"M": mass.ravel()} | {name: np.array(getattr(data, name)).ravel() for _, names, *_ in COLUMNS for name in names if name != "M"}
    return out | {"is mesh": model.geom_type == int(mujoco.mjtGeom.mjGEOM_MESH), "collides": (model.geom_contype | model.geom_conaffinity) != 0}


def ours(program, path, state):
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump(state, file)
        file.flush()
        command = [program, "physics", "forward", "--model", str(path), "--state", file.name]
        return subprocess.run(command, capture_output=True, text=True, timeout=600)


def shown(ours, theirs, is_mesh, collides):
    """Those of MuJoCo's geoms that are ours: meshes that only show are not part of our models."""
    ours, theirs, kept = ours.reshape(-1, 3), theirs.reshape(-1, 3), []
    if len(ours) == (~is_mesh | collides).sum():
        return theirs[~is_mesh | collides].ravel()
    # Some are ours because a sensor or a pair names them: by place.
    for place, mesh in zip(theirs, is_mesh):
        if not mesh or (len(kept) < len(ours) and np.abs(ours[len(kept)] - place).max() < 1e-6):
            kept.append(place)
    return np.array(kept).ravel()


def errors(actual, expected):
    """The worst error of each column."""
    worst = []
    for _, names, absolute, _ in COLUMNS:
        column = 0.0
        for name in names:
            a, e = np.asarray(actual[name], float).ravel(), expected[name]
            if name == "geom_xpos":
                e = shown(a, e, expected["is mesh"], expected["collides"])
            if a.shape != e.shape:
                column = np.inf
            elif a.size:
                column = max(column, np.abs(a - e).max() / (1.0 if absolute else max(np.abs(e).max(), 1e-9)))
        worst.append(column)
    return worst


def examine(program, path, states, seed):
    """The table's cells for one model, and whether it is in order; `None` where MuJoCo does not read it either."""
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError:
        return None
    rng, worst = np.random.default_rng(seed), np.zeros(len(COLUMNS))
    for _ in range(states):
        state = draw(model, rng)
        answer = ours(program, path, state)
        if answer.returncode:
            return ["refused: " + " ".join(answer.stderr.split())[:160].replace("|", "/")], False
        worst = np.maximum(worst, errors(json.loads(answer.stdout), theirs(model, state)))
    sizes = [str(size) for size in (model.nbody, model.nv, model.nu)]
    good = all(error <= tolerance for error, (*_, tolerance) in zip(worst, COLUMNS))
    return [*sizes, *(f"{error:.0e}" for error in worst)], good


def find(places):
    for place in map(pathlib.Path, places):
        if place.is_file():
            yield place
        yield from sorted(place.rglob("*.xml")) if place.is_dir() else ()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("places", nargs="+")
    parser.add_argument("--states", type=int, default=3)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--msk", default=str(ROOT / "target" / "release" / "msk"))
    arguments = parser.parse_args()
    if mujoco.__version__ != "4.0.0":
        sys.exit(f"this check is about MuJoCo 4.0.0, found {mujoco.__version__}")
    print("| model | bodies | dofs | actuators | " + " | ".join(name for name, *_ in COLUMNS) + " | |")
    print("|:--" * 4 + "|--:" * len(COLUMNS) + "|:--|")
    failed = 0
    for path in find(arguments.places):
        result = examine(arguments.msk, path, arguments.states, arguments.seed)
        if result is not None:
            cells, good = result
            failed += not good
            print(f"| {path.parent.name}/{path.stem} | " + " | ".join(cells) + f" | {'equal' if good else 'NOT EQUAL'} |", flush=True)
    sys.exit(int(failed > 0))


if __name__ == "__main__":
    main()
