"""Golden numbers of what a task can measure on the full body, from MuJoCo.

    python tests/oracle/sensors.py

writes tests/golden/sensors.json.gz, which tests/sensors.rs reads.

Velocities of points come from Jacobians, whole-body quantities from MuJoCo's subtree velocities, clearances from its own
distance function, ground forces from its contact forces: none of them repeats a formula of the code under test.
"""

import gzip
import json
import pathlib

import mujoco
import numpy as np

assert mujoco.__version__ == "4.0.0", mujoco.__version__

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODEL = ROOT / "bodies/models/human416.xml"

# Name, body, point in the body's frame, shapes of the segment.
FOOT = ["foot_col1", "foot_col3", "foot_col4", "bofoot_col1", "bofoot_col2"]
LANDMARKS = [
    ("sole_l", "calcn_l", [0.10, -0.02, 0.0], [f"l_{name}" for name in FOOT]),
    ("sole_r", "calcn_r", [0.10, -0.02, 0.0], [f"r_{name}" for name in FOOT]),
    ("pelvis", "pelvis", [0.0, 0.0, 0.0], ["l_pelvis_col", "r_pelvis_col"]),
    ("chin", "head", [0.102, -0.047, 0.0], ["hat_jaw_coll2"]),
    ("wrist_r", "lunate_r", [0.0, 0.0, 0.0], ["radius_r_coll", "radius_r_coll_2", "radius_r_coll_3"]),
]
# Anatomical forward, left, up in a body's frame: x, -z, y; in the root's frame -y, x, z.
AXES = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], float).T
ROOT_AXES = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]], float).T


def flat(array):
    return np.asarray(array, float).ravel().tolist()


def random_state(model, data, rng, height):
    mujoco.mj_resetData(model, data)
    for joint in range(1, model.njnt):
        low, high = model.jnt_range[joint]
        data.qpos[model.jnt_qposadr[joint]] = rng.uniform(0.9 * low + 0.1 * high, 0.1 * low + 0.9 * high) * 0.3
    data.qpos[:2] = rng.normal(0, 0.3, 2)
    quaternion = np.array([np.sqrt(0.5), 0, 0, np.sqrt(0.5)]) + rng.normal(0, 0.02, 4)
    data.qpos[3:7] = quaternion / np.linalg.norm(quaternion)
    data.qvel[:] = rng.normal(0, 0.7, model.nv)
    data.act[:] = rng.uniform(0, 1, model.na)
    data.ctrl[:] = rng.uniform(0, 1, model.nu)
    # Lowered until the lowest foot is `height` above the ground.
    data.qpos[2] = 2.0
    mujoco.mj_forward(model, data)
    lowest = min(clearance(model, data, names) for _, _, _, names in LANDMARKS)
    data.qpos[2] += height - lowest
    mujoco.mj_forward(model, data)


def clearance(model, data, names):
    floor = model.geom("floor").id
    line = np.zeros(6)
    return min(mujoco.mj_geomDistance(model, data, floor, model.geom(name).id, 100.0, line) for name in names)


def point_velocity(model, data, body, point):
    jacobian, rotational = np.zeros((3, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, jacobian, rotational, point, body)
    return jacobian @ data.qvel, rotational @ data.qvel


def ground_force(model, data, names):
    floor, shapes = model.geom("floor").id, {model.geom(name).id for name in names}
    total, touches = np.zeros(3), False
    for index, contact in enumerate(data.contact):
        first, second = contact.geom
        if floor in (first, second) and ({first, second} - {floor}) <= shapes:
            force = np.zeros(6)
            mujoco.mj_contactForce(model, data, index, force)
            on_second = contact.frame.reshape(3, 3).T @ force[:3]
            total += on_second if first == floor else -on_second
            touches = touches or contact.efc_address >= 0
    return total, touches


def landmark(model, data, name, body, local, names):
    index = model.body(body).id
    rotation = data.xmat[index].reshape(3, 3)
    point = data.xpos[index] + rotation @ np.array(local)
    velocity, angular = point_velocity(model, data, index, point)
    force, touches = ground_force(model, data, names)
    return {
        "name": name,
        "body": body,
        "point": local,
        "segment": names,
        "position": flat(point),
        "velocity": flat(velocity),
        "axes": flat((rotation @ AXES).T),
        "angular_velocity": flat(angular),
        "clearance": clearance(model, data, names),
        "ground_force": flat(force),
        "ground_contact": float(touches),
    }


def reactions(model, data):
    """Force of the parent on the body of each joint, and its torque about the joint, from `cfrc_int`."""
    mujoco.mj_rnePostConstraint(model, data)
    found = []
    for joint in range(model.njnt):
        body = model.jnt_bodyid[joint]
        torque, force = data.cfrc_int[body][:3], data.cfrc_int[body][3:]
        arm = data.xanchor[joint] - data.subtree_com[model.body_rootid[body]]
        found.append({"joint": model.joint(joint).name, "force": flat(force), "torque": flat(torque - np.cross(arm, force))})
    return found


def measure(model, data):
    mujoco.mj_subtreeVel(model, data)
    root = model.body("Full Body").id
    velocity, angular = point_velocity(model, data, root, data.xpos[root])
    return {
        "position": flat(data.qpos),
        "velocity": flat(data.qvel),
        "activation": flat(data.act),
        "control": flat(data.ctrl),
        "landmarks": [landmark(model, data, *entry) for entry in LANDMARKS],
        "com_position": flat(data.subtree_com[root]),
        "com_velocity": flat(data.subtree_linvel[root]),
        "angular_momentum": flat(data.subtree_angmom[root]),
        "root_position": flat(data.xpos[root]),
        "root_axes": flat((data.xmat[root].reshape(3, 3) @ ROOT_AXES).T),
        "root_velocity": flat(velocity),
        "root_angular_velocity": flat(angular),
        "joint_torque": flat(data.qfrc_actuator),
        "joint_acceleration": flat(data.qacc),
        "joint_reaction": reactions(model, data),
        "muscle_length": flat(data.actuator_length),
        "muscle_velocity": flat(data.actuator_velocity),
        "muscle_force": flat(data.actuator_force),
    }


def main():
    model = mujoco.MjModel.from_xml_path(str(MODEL))
    data = mujoco.MjData(model)
    rng = np.random.default_rng(7)
    cases = []
    for height in (0.4, -0.003, -0.008):
        random_state(model, data, rng, height)
        cases.append(measure(model, data))
    with open(ROOT / "tests/golden/sensors.json.gz", "wb") as file:
        with gzip.GzipFile(filename="", fileobj=file, mode="wb", mtime=0) as packed:
            packed.write(json.dumps({"mujoco": mujoco.__version__, "cases": cases}).encode())


if __name__ == "__main__":
    main()
