"""Lengths and moment arms of muscles of the full body over joint sweeps, from MuJoCo.

    python tests/oracle/moment_arms.py

writes tests/golden/moment_arms.json.gz, which tests/muscle_sweep.rs reads. Every sweep starts from the reference
configuration; followers of the swept joint are put where their couplings want them.
"""

import gzip
import json
import pathlib

import mujoco
import numpy as np

assert mujoco.__version__ == "4.0.0", mujoco.__version__

HERE = pathlib.Path(__file__).parent
STEPS = 12
SWEEPS = [
    ("soleus_r", "ankle_angle_r"), ("recfem_r", "knee_angle_r"), ("gaslat_r", "knee_angle_r"), ("glmax1_r", "hip_flexion_r"),
    ("psoas_r", "hip_flexion_r"), ("DELT2", "shoulder_elv_r"), ("TRIlong", "elbow_flex_r"), ("FDS3", "flexion_r"),
    ("rect_abd_r", "flex_extension"), ("LTpT_T8_l", "flex_extension"),
]


def name_of(model, kind, index):
    return mujoco.mj_id2name(model, kind, index)


def couplings(model):
    """(follower, leader or -1, polynomial), leaders before followers."""
    rows = [
        (model.eq_obj1id[i], model.eq_obj2id[i], model.eq_data[i, :5].copy())
        for i in range(model.neq) if model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT
    ]
    done = []
    while rows:
        waiting = {row[0] for row in rows}
        ready = [row for row in rows if row[1] not in waiting]
        assert ready
        done += ready
        rows = [row for row in rows if row[1] in waiting]
    return done


def solve(model, rows, qpos, rate):
    for follower, leader, polynomial in rows:
        at, own = model.jnt_qposadr[leader], model.jnt_qposadr[follower]
        x = qpos[at] - model.qpos0[at] if leader >= 0 else 0.0
        qpos[own] = model.qpos0[own] + np.polyval(polynomial[::-1], x)
        slope = np.polyval(np.polyder(polynomial[::-1]), x) if leader >= 0 else 0.0
        rate[model.jnt_dofadr[follower]] = slope * rate[model.jnt_dofadr[leader]] if leader >= 0 else 0.0


model = mujoco.MjModel.from_xml_path(str(HERE.parent.parent / "bodies" / "models" / "human416.xml"))
data = mujoco.MjData(model)
rows = couplings(model)
sweeps = []
for muscle, joint in SWEEPS:
    actuator = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, muscle)
    moving = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint)
    if actuator < 0 or moving < 0:
        raise SystemExit(f"{muscle} or {joint} is not in the model")
    low, high = model.jnt_range[moving]
    samples = []
    for step in range(STEPS + 1):
        data.qpos[:] = model.qpos0
        data.qpos[model.jnt_qposadr[moving]] = low + (high - low) * step / STEPS
        rate = np.zeros(model.nv)
        rate[model.jnt_dofadr[moving]] = 1.0
        solve(model, rows, data.qpos, rate)
        mujoco.mj_fwdPosition(model, data)
        dense = np.zeros((model.nu, model.nv))
        mujoco.mju_sparse2dense(dense, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind)
        samples.append({
            "coordinate": data.qpos[model.jnt_qposadr[moving]],
            "length": data.actuator_length[actuator],
            "moment_arm": -float(dense[actuator] @ rate),
            "own": -float(dense[actuator, model.jnt_dofadr[moving]]),
        })
    sweeps.append({"muscle": muscle, "joint": joint, "samples": samples})

with gzip.GzipFile(HERE.parent / "golden" / "moment_arms.json.gz", "wb", mtime=0) as file:
    file.write(json.dumps({"steps": STEPS, "sweeps": sweeps}).encode())
print(sum(len(sweep["samples"]) for sweep in sweeps), "samples")
