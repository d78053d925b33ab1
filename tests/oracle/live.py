"""Parity with an installed MuJoCo at fresh random states, through `msk physics forward`.

    cargo build --release && python tests/oracle/live.py [--states 40] [--seed N] [--model FILE] [--msk FILE]

Draws half of the states on the ground and half with limits violated, sends each through the program and through mj_forward,
and prints the worst error of every quantity. MuJoCo runs twice: with its default settings, and with the tolerance of its
iterative convex collider tightened. States in which that collider took part (a capsule or ellipsoid against an ellipsoid)
are counted apart: at its default tolerance of 1e-6 m its normals are good to about 1e-2.
Exits with 1 if a quantity of the other states, or a tightened one of these, is out of tolerance.
"""

import argparse
import json
import pathlib
import secrets
import subprocess
import sys
import tempfile

import mujoco
import numpy as np

from constraint import BODY, SplitMix, dense_jacobian, draw, is_convex, mass_matrix, place, tighten

ROOT = pathlib.Path(__file__).parent.parent.parent
# Quantity, absolute (else relative to the largest entry), tolerance, tolerance with the tightened convex collider.
QUANTITIES = [
    ("xpos", True, 1e-12, 1e-12),
    ("xquat", True, 1e-12, 1e-12),
    ("ten_length", True, 1e-9, 1e-9),
    ("ten_velocity", False, 1e-9, 1e-9),
    ("actuator_force", False, 1e-10, 1e-10),
    ("M", False, 1e-10, 1e-10),
    ("qfrc_bias", False, 1e-10, 1e-10),
    ("qfrc_passive", False, 1e-10, 1e-10),
    ("qfrc_actuator", False, 1e-10, 1e-10),
    ("contact.dist", True, 1e-8, 1e-8),
    ("contact.pos", True, 1e-8, 1e-4),
    ("contact.frame", True, 1e-8, 1e-3),
    ("efc_J", True, 1e-9, 1e-3),
    ("efc_pos", True, 1e-9, 1e-9),
    ("efc_D", False, 1e-9, 1e-8),
    ("efc_aref", False, 1e-9, 1e-4),
    ("qacc_smooth", False, 1e-9, 1e-9),
    ("efc_force", False, 1e-6, 1e-4),
    ("qfrc_constraint", False, 1e-6, 1e-4),
    ("qacc", False, 1e-6, 1e-4),
]


def theirs(model, data):
    out = {name: np.array(getattr(data, name)).ravel() for name, *_ in QUANTITIES if hasattr(data, name)}
    out["M"] = mass_matrix(model, data).ravel()
    out["efc_J"] = dense_jacobian(model, data).ravel()
    contacts = data.contact[: data.ncon]
    for field in ("dist", "pos", "frame"):
        out[f"contact.{field}"] = np.array([getattr(contact, field) for contact in contacts]).ravel()
    return out, [[int(contact.geom1), int(contact.geom2)] for contact in contacts]


def ours(program, path, state, folder):
    file = pathlib.Path(folder) / "state.json"
    file.write_text(json.dumps(state))
    command = [program, "physics", "forward", "--model", path, "--state", str(file), "--constraint-jacobian"]
    report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    for field in ("dist", "pos", "frame"):
        report[f"contact.{field}"] = np.array([contact[field] for contact in report["contact"]]).ravel()
    return report, [contact["geom"] for contact in report["contact"]]


class Worst:
    """The worst error of every quantity, in the scale of its tolerance."""

    def __init__(self):
        self.states, self.errors = 0, {name: 0.0 for name, *_ in QUANTITIES}

    def add(self, actual, expected):
        self.states += 1
        for name, absolute, *_ in QUANTITIES:
            a, e = np.asarray(actual[name]), expected[name]
            if a.shape != e.shape:
                self.errors[name] = np.inf
            elif a.size:
                scale = 1.0 if absolute else max(np.abs(e).max(), 1e-300)
                self.errors[name] = max(self.errors[name], float(np.abs(a - e).max() / scale))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", default=str(BODY))
    parser.add_argument("--msk", default=str(ROOT / "target/release/msk"), help="the program")
    parser.add_argument("--states", type=int, default=40)
    parser.add_argument("--seed", type=int, default=None)
    arguments = parser.parse_args()
    seed = secrets.randbits(32) if arguments.seed is None else arguments.seed
    print(f"MuJoCo {mujoco.__version__}, {arguments.model}, {arguments.states} states from seed {seed}")
    model = mujoco.MjModel.from_xml_path(arguments.model)
    defaults = model.opt.ccd_tolerance, model.opt.ccd_iterations
    data, random = mujoco.MjData(model), SplitMix(seed)
    plain, convex, tightened = Worst(), Worst(), Worst()
    on_tree = model.njnt > 0 and model.jnt_type[0] == mujoco.mjtJoint.mjJNT_FREE and model.nu > 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(arguments.states):
            mujoco.mj_resetData(model, data)
            draw(model, data, random, number % 2 == 0)
            if on_tree:
                place(model, data, random.between(0.0, 0.02) if number // 2 % 2 == 0 else -0.3)
            names = ["qpos", "qvel", "act", "ctrl", "qacc_warmstart"]
            state = {name: np.array(getattr(data, name)).tolist() for name in names}
            actual, our_geoms = ours(arguments.msk, arguments.model, state, folder)
            mujoco.mj_forward(model, data)
            involved = any(is_convex(model, contact) for contact in data.contact[: data.ncon])
            expected, geoms = theirs(model, data)
            if geoms != our_geoms:
                sys.exit(f"state {number}: contacts {our_geoms}, MuJoCo's {geoms}")
            (convex if involved else plain).add(actual, expected)
            if involved:
                data.qacc_warmstart[:] = state["qacc_warmstart"]
                tighten(model)
                mujoco.mj_forward(model, data)
                model.opt.ccd_tolerance, model.opt.ccd_iterations = defaults
                tightened.add(actual, theirs(model, data)[0])
    print(f"{'':>16} {plain.states:4} states  within     | {convex.states:4} states with the convex collider")
    print(f"{'':>16} {'':18}           | {'default':>10} {'tightened':>10}  within")
    failed = False
    for name, absolute, exact, loose in QUANTITIES:
        errors = plain.errors[name], convex.errors[name], tightened.errors[name]
        bad = errors[0] > exact or errors[2] > loose
        failed |= bad
        kind = "abs" if absolute else "rel"
        print(f"{name:>16} {errors[0]:10.1e} {kind} {exact:10.0e}   | {errors[1]:10.1e} {errors[2]:10.1e} {loose:10.0e}", "FAILED" if bad else "")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
