"""Golden numbers of actuators, passive elements and integrators, from MuJoCo.

    python tests/oracle/actuation.py

writes tests/golden/actuation_*.json.gz, which tests/actuation_parity.rs reads. States are not stored: both sides draw them
from the same generator in the same order (smooth.py), with set points spread over more than a turn.
"""

import mujoco
import numpy as np

from smooth import HERE, SplitMix, draw, write

SEEDS = {
    "ball_free": 700, "gravity": 701, "keyframes": 702, "motors": 703, "sites": 704, "spin": 705, "tendons": 706,
    "adhesion": 707, "underwater": 708,
}
STATES = ["actuator_length", "actuator_velocity", "actuator_force", "act_dot", "qfrc_actuator", "qfrc_passive", "qacc"]
KEYS = ["qpos", "qvel", "act", "ctrl", "mocap_pos", "mocap_quat", "xpos", "qacc"]
INTEGRATORS = {
    "euler": (mujoco.mjtIntegrator.mjINT_EULER, 0),
    "explicit": (mujoco.mjtIntegrator.mjINT_EULER, mujoco.mjtDisableBit.mjDSBL_EULERDAMP),
    "implicitfast": (mujoco.mjtIntegrator.mjINT_IMPLICITFAST, 0),
    "RK4": (mujoco.mjtIntegrator.mjINT_RK4, 0),
}


def spread(model, data):
    """Set points and activations of whatever is no muscle, over [-4, 4]."""
    for actuator in range(model.nactuator):
        data.ctrl[actuator] = 8 * data.ctrl[actuator] - 4
        slot = model.actuator_actadr[actuator]
        if slot >= 0 and model.actuator_dyntype[actuator] != mujoco.mjtDyn.mjDYN_MUSCLE:
            data.act[slot] = 8 * data.act[slot] - 4


def start(model, data, random):
    """A state for a rollout: slower, with nothing applied."""
    mujoco.mj_resetData(model, data)
    draw(model, data, random)
    spread(model, data)
    data.qvel *= 0.5
    data.qfrc_applied[:] = 0
    data.xfrc_applied[:] = 0


def record(model, data):
    return np.concatenate([data.qpos, data.qvel, data.act]).tolist()


def with_actuators(model, dofs, actuators):
    """What each dof has of its own, and what actuators add to the joint that they move."""
    total = dofs.copy()
    for actuator in np.flatnonzero(actuators):
        if model.actuator_trntype[actuator] == mujoco.mjtTrn.mjTRN_JOINT:
            dof = model.jnt_dofadr[model.actuator_trnid[actuator, 0]]
            total[dof] += actuators[actuator] * model.actuator_gear[actuator, 0] ** 2
    return total.tolist()


def golden(path, seed, states=25, rollouts=3):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    content = {
        "seed": seed,
        "compiled": {
            "actuator_acc0": model.actuator_acc0.tolist(),
            "dof_damping": with_actuators(model, model.dof_damping, model.actuator_damping),
            "dof_armature": with_actuators(model, model.dof_armature, model.actuator_armature),
            "jnt_stiffness": model.jnt_stiffness.tolist(),
            "actuator_biasprm": model.actuator_biasprm[:, :3].ravel().tolist(),
        },
        "states": [],
        "rollouts": {name: [] for name in INTEGRATORS},
    }
    for _ in range(states):
        mujoco.mj_resetData(model, data)
        draw(model, data, random)
        spread(model, data)
        mujoco.mj_forward(model, data)
        content["states"].append({name: np.array(getattr(data, name)).ravel().tolist() for name in STATES})
    for _ in range(rollouts):
        before = random.state
        for name, (integrator, flags) in INTEGRATORS.items():
            model.opt.integrator, model.opt.disableflags = integrator, flags
            random.state = before
            start(model, data, random)
            mujoco.mj_step(model, data)
            first = record(model, data)
            mujoco.mj_step(model, data, 499)
            assert np.isfinite(data.qpos).all() and not data.warning.number.any(), (path, name)
            content["rollouts"][name].append({"first": first, "last": record(model, data)})
        model.opt.integrator, model.opt.disableflags = INTEGRATORS["euler"]
    content["keyframes"] = [keyframe(model, data, key) for key in range(model.nkey)]
    write(f"actuation_{path.stem}", content)


def keyframe(model, data, key):
    """A key frame as it is stored, where it puts the bodies, and a quarter of a second from it."""
    mujoco.mj_resetDataKeyframe(model, data, key)
    mujoco.mj_forward(model, data)
    stored = {name: np.array(getattr(data, name)).ravel().tolist() for name in KEYS}
    mujoco.mj_step(model, data, 125)
    return {"name": model.key(key).name, "time": model.key_time[key], **stored, "later": record(model, data)}


def sensors(path, seed, states=40):
    """Readings of a body on the ground, in random poses."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    content = {"seed": seed, "states": []}
    for number in range(states):
        mujoco.mj_resetData(model, data)
        draw(model, data, random)
        data.qpos[:3] = [0, 0, 0.05 + 0.2 * random.unit()]
        data.time = number
        mujoco.mj_forward(model, data)
        content["states"].append({"sensordata": data.sensordata.tolist(), "contacts": data.ncon})
    touches = np.array([state["sensordata"][:4] for state in content["states"]])
    assert (touches > 0).any(axis=0).all() and (touches == 0).any(axis=0).all(), touches
    write("actuation_sensors", content)


if __name__ == "__main__":
    sensors(HERE / "models" / "sensors" / "sensors.xml", 751)
    for path in sorted((HERE / "models" / "actuation").glob("*.xml")):
        golden(path, SEEDS[path.stem])
