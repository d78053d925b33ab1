"""Golden numbers of the smooth (constraint-free) half of a step, from MuJoCo.

    python tests/oracle/smooth.py

writes tests/golden/smooth_*.json.gz and tests/golden/wrap.json.gz, which tests/smooth_parity.rs reads. States are not
stored: both sides draw them from the same generator (SplitMix64), in the same order.

Quantities of the small models are stored whole. Those of the full body are stored as weighted sums over consecutive
entries, `GROUPS` of them each, with weights that no plausible mistake cancels; this keeps 200 states under a megabyte.
"""

import ctypes
import glob
import gzip
import json
import pathlib

import mujoco
import numpy as np

assert mujoco.__version__ == "4.0.0", mujoco.__version__

HERE = pathlib.Path(__file__).parent
GOLDEN = HERE.parent / "golden"
BODY = HERE.parent.parent / "bodies" / "models" / "human416.xml"
GROUPS = {
    "xpos": 16, "xquat": 16, "ten_length": 8, "ten_velocity": 8, "ten_J": 1696, "actuator_force": 8, "act_dot": 32,
    "M": 64, "qfrc_bias": 8, "qfrc_passive": 16, "qfrc_actuator": 8, "qfrc_smooth": 8, "qacc_smooth": 8,
}


class SplitMix:
    """Steele, Lea and Flood, Fast splittable pseudorandom number generators, OOPSLA 2014."""

    def __init__(self, seed):
        self.state = seed

    def unit(self):
        mask = (1 << 64) - 1
        self.state = (self.state + 0x9E3779B97F4A7C15) & mask
        z = self.state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        return ((z ^ (z >> 31)) >> 11) * 2.0**-53

    def between(self, low, high):
        return low + (high - low) * self.unit()


def draw(model, data, random):
    """A random state: joints up to a tenth of their range beyond it, couplings violated, everything else at random."""
    for joint in range(model.njnt):
        address = model.jnt_qposadr[joint]
        kind = model.jnt_type[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE or kind == mujoco.mjtJoint.mjJNT_BALL:
            for i in range(7 if kind == mujoco.mjtJoint.mjJNT_FREE else 4):
                data.qpos[address + i] = random.between(-1.0, 1.0)
        else:
            low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-1.0, 1.0)
            data.qpos[address] = low + (high - low) * random.between(-0.1, 1.1)
    for i in range(model.nv):
        data.qvel[i] = random.between(-3.0, 3.0)
    for i in range(model.na):
        data.act[i] = random.unit()
    for i in range(model.nu):
        data.ctrl[i] = random.between(-0.1, 1.1)
    for i in range(model.nv):
        data.qfrc_applied[i] = random.between(-5.0, 5.0)
    for body in range(1, model.nbody):
        for i in range(6):
            data.xfrc_applied[body, i] = random.between(-2.0, 2.0)


def dense_tendon_jacobian(model, data):
    dense = np.zeros((model.ntendon, model.nv))
    if model.ntendon:
        mujoco.mju_sparse2dense(dense, data.ten_J, model.ten_J_rownnz, model.ten_J_rowadr, model.ten_J_colind)
    return dense


def quantities(model, data):
    """All compared quantities, flat.

    Those of the joints are scaled by the inertia that each dof feels, lest a finger's error hide behind the pelvis's size:
    forces by 1/sqrt(M_ii), accelerations by sqrt(M_ii), M_ij by 1/sqrt(M_ii M_jj), and of M_ii itself the logarithm. M is
    listed on the sparsity of the tree (MuJoCo's own keeps only the diagonal of bodies it calls simple).
    """
    mujoco.mj_forward(model, data)
    out = {name: np.array(getattr(data, name)).ravel() for name in GROUPS if name not in ("ten_J", "M")}
    out["ten_J"] = dense_tendon_jacobian(model, data).ravel()
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    root = np.sqrt(np.diag(mass))
    for name in out:
        if name.startswith("qfrc"):
            out[name] = out[name] / root
    out["qacc_smooth"] = out["qacc_smooth"] * root
    entries = []
    for dof in range(model.nv):
        above = model.dof_parentid[dof]
        path = []
        while above >= 0:
            path.insert(0, mass[dof, above] / root[dof] / root[above])
            above = model.dof_parentid[above]
        entries += path + [2 * np.log(root[dof])]
    out["M"] = np.array(entries)
    return out


def folded(values, group):
    weights = np.array([((i * 7919) % 101 + 1) / 101 for i in range(len(values))])
    weighted = values * weights
    return [float(weighted[i : i + group].sum()) for i in range(0, len(values), group)]


def write(name, content):
    content = {"mujoco": mujoco.__version__, **content}
    with open(GOLDEN / f"{name}.json.gz", "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as file:
        file.write(json.dumps(content).encode())


def states(path, name, seed, count, groups):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    records = []
    for _ in range(count):
        mujoco.mj_resetData(model, data)
        draw(model, data, random)
        full = quantities(model, data)
        records.append({key: folded(values, groups[key]) if groups else values.tolist() for key, values in full.items()})
    write(f"smooth_{name}", {"seed": seed, "groups": groups or {}, "states": records})


def wraps(seed=11, count=600):
    """mju_wrap over random points, obstacles and side points, a part of them close to the onset of contact."""
    pointer = ctypes.POINTER(ctypes.c_double)
    library = ctypes.CDLL(glob.glob(str(pathlib.Path(mujoco.__file__).parent / "libmujoco.so*"))[0])
    library.mju_wrap.restype = ctypes.c_double
    library.mju_wrap.argtypes = [pointer] * 5 + [ctypes.c_double, ctypes.c_int, pointer]
    random = np.random.default_rng(seed)
    cases = []
    for case in range(count):
        shape = ["sphere", "cylinder"][case % 2]
        quat = random.normal(size=4)
        quat /= np.linalg.norm(quat)
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, quat)
        rotation = matrix.reshape(3, 3)
        position, radius = random.normal(size=3), random.uniform(0.3, 1.0)
        ends = random.normal(size=(2, 3)) * 1.3
        if case % 5 == 0:  # grazing: a straight line that misses or cuts the circle by next to nothing
            depth = radius * (1 + random.choice([-1, 1]) * 10 ** random.uniform(-9, -3))
            ends = np.array([[-random.uniform(0.5, 2), depth, 0.0], [random.uniform(0.5, 2), depth, 0.0]])
            if shape == "cylinder":
                ends[:, 2] = random.normal(size=2)
        if case % 25 == 7:  # end points exactly in line with the centre, which leaves the plane of a sphere open
            ends[0] = np.round(64 * ends[0]) / 64  # products without rounding
            rotation, position, ends[1] = np.eye(3), np.zeros(3), -2 * ends[0]
            matrix = rotation.ravel().copy()
        side = None
        if case % 4:
            side = random.normal(size=3)
            if case % 4 == 1:
                side *= radius * random.uniform(0.0, 0.95) / np.linalg.norm(side)
        world = [np.ascontiguousarray(rotation @ end + position) for end in ends]
        world_side = None if side is None else np.ascontiguousarray(rotation @ side + position)
        points = np.zeros(12)
        arrays = [points, world[0], world[1], position, matrix]
        kind = {"sphere": mujoco.mjtWrap.mjWRAP_SPHERE, "cylinder": mujoco.mjtWrap.mjWRAP_CYLINDER}[shape]
        length = library.mju_wrap(
            *[array.ctypes.data_as(pointer) for array in arrays], radius, int(kind),
            None if side is None else world_side.ctypes.data_as(pointer),
        )
        cases.append({
            "shape": shape, "position": position.tolist(), "rotation": matrix.tolist(), "radius": radius,
            "ends": [end.tolist() for end in world], "side": None if side is None else side.tolist(),
            "arc": length, "points": points[:6].tolist() if length >= 0 else None,
        })
    write("wrap", {"seed": seed, "cases": cases})


if __name__ == "__main__":
    wraps()
    for number, path in enumerate(sorted((HERE / "models").glob("*.xml"))):
        states(path, path.stem, 100 + number, 25, None)
    if BODY.exists():
        states(BODY, "human416", 416, 200, GROUPS)
