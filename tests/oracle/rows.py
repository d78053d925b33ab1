"""Golden numbers of constraint rows and of the constrained acceleration, one small model per feature, from MuJoCo.

    python tests/oracle/rows.py

writes tests/golden/rows_*.json.gz from tests/oracle/row_models/*.xml, which tests/row_parity.rs reads, and
tests/golden/stages_*.json.gz from tests/oracle/scene_models/*.xml, which tests/scene_stages.rs writes and compares. States are not stored:
both sides draw them from the same generator, around the reference configuration, and every third of them holds or releases
equalities at random. Of the Jacobian the golden file holds each row's weighted sum; everything else is stored whole. A
rollout of a tenth of a second goes on from the next state that the generator gives; half way all equalities change over
between holding and being released.
"""

import mujoco
import numpy as np

from constraint import dense_jacobian, mass_matrix, tighten
from smooth import HERE, SplitMix, folded, write

FREE, BALL = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL
STATES = 15
STEPS = 50


def draw(model, data, random, number):
    """A random state near the reference configuration: free bodies move and turn little, so that contacts stay shallow."""
    for joint in range(model.njnt):
        address = model.jnt_qposadr[joint]
        kind = model.jnt_type[joint]
        reach = [0.01] * 3 + [0.1] * 4 if kind == FREE else [0.3] * 4 if kind == BALL else [0.3]
        for i, width in enumerate(reach):
            data.qpos[address + i] = model.qpos0[address + i] + random.between(-width, width)
    for i in range(model.nv):
        data.qvel[i] = random.between(-1.5, 1.5)
    for i in range(model.na):
        data.act[i] = random.unit()
    for i in range(model.nu):
        data.ctrl[i] = random.unit()
    for i in range(model.nv):
        data.qfrc_applied[i] = random.between(-3.0, 3.0)
    if number % 3 == 2:
        for equality in range(model.neq):
            data.eq_active[equality] = random.unit() < 0.5
    warm = random.unit() < 0.5
    for i in range(model.nv):
        data.qacc_warmstart[i] = random.between(-20.0, 20.0) if warm else 0.0


def touched(data):
    """Where shapes meet, and what leads there: for scenes."""
    contacts = data.contact[: data.ncon]
    arrays = {
        "geom_xpos": data.geom_xpos, "bias": data.qfrc_bias,
        "contact_geoms": [c.geom for c in contacts], "contact_dist": [c.dist for c in contacts],
        "contact_pos": [c.pos for c in contacts], "contact_normal": [c.frame[:3] for c in contacts],
    }
    return {name: np.array(values, dtype=float).ravel().tolist() for name, values in arrays.items()}


def record(model, data, scene):
    mujoco.mj_forward(model, data)
    jacobian, mass = dense_jacobian(model, data), mass_matrix(model, data)
    arrays = {
        "type": data.efc_type, "position": data.efc_pos, "margin": data.efc_margin, "velocity": data.efc_vel,
        "reference": data.efc_aref, "logweight": np.log(data.efc_D), "force": data.efc_force,
        "qacc": data.qacc * np.sqrt(np.diag(mass)), "passive": data.qfrc_passive, "ten_length": data.ten_length,
    }
    found = {name: np.array(values).ravel().tolist() for name, values in arrays.items()}
    found["jacobian"] = folded(jacobian.ravel(), model.nv)
    return found | (touched(data) if scene else {})


def rows(path, name, seed):
    model = mujoco.MjModel.from_xml_path(str(path))
    tighten(model)
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    states = []
    for number in range(STATES):
        mujoco.mj_resetData(model, data)
        draw(model, data, random, number)
        states.append(record(model, data, name.startswith("stages")))
    mujoco.mj_resetData(model, data)
    draw(model, data, random, 0)
    for number in range(STEPS):
        if number == STEPS // 2:
            data.eq_active[:] = 1 - data.eq_active
        mujoco.mj_step(model, data)
    constants = {name: np.array(getattr(model, name)).ravel().tolist() for name in ("tendon_invweight0", "tendon_length0")}
    end = {"qpos": data.qpos.tolist(), "qvel": data.qvel.tolist()}
    write(name, {"seed": seed, "constants": constants, "states": states, "end": end})
    seen = sorted({int(kind) for state in states for kind in state["type"]})
    print(f"{name}: {sum(len(state['type']) for state in states)} rows of types {seen}")


if __name__ == "__main__":
    # The models of friction without slip were added later: the others keep their numbers.
    models = sorted((HERE / "row_models").glob("*.xml"), key=lambda path: (path.stem.startswith("no_slip"), path))
    for number, path in enumerate(models):
        rows(path, f"rows_{path.stem}", 900 + number)
    for number, path in enumerate(sorted((HERE / "scene_models").glob("*.xml"))):
        rows(path, f"stages_{path.stem}", 1900 + number)
