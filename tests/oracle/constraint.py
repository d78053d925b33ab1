"""Golden numbers of the constrained half of a step, from MuJoCo.

    python tests/oracle/constraint.py

writes tests/golden/constraint_*.json.gz, which tests/constraint_parity.rs reads. States are not stored: both sides draw
them from the same generator, only the height that puts a body on the ground comes from here.

Quantities of the small models are stored whole. The full body's rows, accelerations and forces are stored as weighted sums
over a few consecutive entries, scaled so that no small entry hides behind a large one.

MuJoCo's general convex collider, which meets a capsule or ellipsoid with an ellipsoid, stops at `ccd_tolerance`; it is
tightened here from 1e-6 m. The distance it finds is then exact to 1e-11 m, but a normal found from a distance keeps about
its square root as an error: states with such contacts are marked `convex` and compared more loosely.

Single states are solved with the models' own settings. In the rollouts the solver's tolerance is tightened to 1e-14: at the
default 1e-8 MuJoCo skips the solver when the last step's solution is nearly right, and after a second of flight it is 6e-7
away from its own converged result.
"""

import mujoco
import numpy as np

from smooth import BODY, HERE, SplitMix, folded, write

FREE, BALL = mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL
CONVEX = {mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE, mujoco.mjtGeom.mjGEOM_ELLIPSOID}
GROUPS = {"position": 4, "velocity": 4, "reference": 4, "logweight": 4, "jacobian": 512, "force": 4, "qacc": 4}


def tighten(model):
    model.opt.ccd_tolerance = 1e-13
    model.opt.ccd_iterations = 1000


def draw(model, data, random, violated):
    """A random state, couplings nearly met; joints a twentieth of their range within their limits or beyond them."""
    reach = 0.05 if violated else -0.05
    for joint in range(model.njnt):
        address = model.jnt_qposadr[joint]
        kind = model.jnt_type[joint]
        if kind == FREE or kind == BALL:
            count = 7 if kind == FREE else 4
            for i in range(count):
                data.qpos[address + i] = random.between(-1.0, 1.0)
            if kind == FREE and model.nu == 0:
                for i in range(3):
                    data.qpos[address + i] *= 0.12
        else:
            low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-0.1, 0.1)
            data.qpos[address] = low + (high - low) * random.between(-reach, 1.0 + reach)
    for equality in range(model.neq):
        slave, leader = model.eq_obj1id[equality], model.eq_obj2id[equality]
        x = 0.0
        if leader >= 0:
            address = model.jnt_qposadr[leader]
            x = data.qpos[address] - model.qpos0[address]
        a = model.eq_data[equality]
        wanted = a[0] + x * (a[1] + x * (a[2] + x * (a[3] + x * a[4])))
        address = model.jnt_qposadr[slave]
        data.qpos[address] = model.qpos0[address] + wanted + random.between(-1e-3, 1e-3)
    for i in range(model.nv):
        data.qvel[i] = random.between(-1.5, 1.5)
    for i in range(model.na):
        data.act[i] = random.unit()
    for i in range(model.nu):
        data.ctrl[i] = random.unit()
    warm = random.unit() < 0.5
    for i in range(model.nv):
        data.qacc_warmstart[i] = random.between(-20.0, 20.0) if warm else 0.0


def lowest(model, data):
    """Height of the lowest point of the colliding shapes above z = 0."""
    heights = []
    for geom in range(model.ngeom):
        kind, size = model.geom_type[geom], model.geom_size[geom]
        if kind == mujoco.mjtGeom.mjGEOM_PLANE or not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            continue
        down = data.geom_xmat[geom].reshape(3, 3)[2]
        reach = size[0] + size[1] * abs(down[2]) if kind == mujoco.mjtGeom.mjGEOM_CAPSULE else np.linalg.norm(size * down)
        heights.append(data.geom_xpos[geom, 2] - reach)
    return min(heights)


def place(model, data, depth):
    """Moves the root so that its lowest point is `depth` under the ground; the height is part of the golden file."""
    mujoco.mj_kinematics(model, data)
    data.qpos[2] -= lowest(model, data) + depth
    return float(data.qpos[2])


def is_convex(model, contact):
    kinds = [mujoco.mjtGeom(model.geom_type[geom]) for geom in (contact.geom1, contact.geom2)]
    return mujoco.mjtGeom.mjGEOM_ELLIPSOID in kinds and all(kind in CONVEX for kind in kinds)


def dense_jacobian(model, data):
    """The constraint Jacobian, row by row. Rows that MuJoCo left out again may still take room at the end of its array."""
    jacobian = np.zeros((data.nefc, model.nv))
    if mujoco.mj_isSparse(model) and data.nefc:
        mujoco.mju_sparse2dense(jacobian, data.efc_J.ravel(), data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    elif data.nefc:
        jacobian[:] = data.efc_J.ravel()[: jacobian.size].reshape(jacobian.shape)
    return jacobian


def mass_matrix(model, data):
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return mass


def record(model, data):
    """What is compared, after mj_forward."""
    contacts = [
        {"geoms": [int(c.geom1), int(c.geom2)], "distance": float(c.dist), "position": c.pos.tolist(),
         "frame": c.frame.tolist(), "convex": is_convex(model, c)}
        for c in data.contact[: data.ncon]
    ]
    jacobian, mass = dense_jacobian(model, data), mass_matrix(model, data)
    numbers = {
        "position": data.efc_pos, "velocity": data.efc_vel, "reference": data.efc_aref, "logweight": np.log(data.efc_D),
        "jacobian": jacobian.ravel(), "force": data.efc_force, "qacc": data.qacc * np.sqrt(np.diag(mass)),
    }
    return contacts, {name: np.array(values) for name, values in numbers.items()}


def state(model, data, groups):
    mujoco.mj_forward(model, data)
    contacts, numbers = record(model, data)
    return {
        "rows": int(data.nefc), "contacts": contacts, "convex": any(contact["convex"] for contact in contacts),
        **{name: folded(values, groups[name]) if groups else values.tolist() for name, values in numbers.items()},
    }


def small(path, seed, count=25):
    model = mujoco.MjModel.from_xml_path(str(path))
    tighten(model)
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    states = []
    for number in range(count):
        mujoco.mj_resetData(model, data)
        draw(model, data, random, number % 2 == 0)
        states.append(state(model, data, None))
    write(f"constraint_{path.stem}", {"seed": seed, "groups": {}, "states": states})


def body(seed, count=200):
    model = mujoco.MjModel.from_xml_path(str(BODY))
    tighten(model)
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    states = []
    for number in range(count):
        mujoco.mj_resetData(model, data)
        draw(model, data, random, number % 2 == 0)
        on_ground = number // 2 % 2 == 0
        height = place(model, data, random.between(0.0, 0.02) if on_ground else -0.3)
        states.append({"height": height, **state(model, data, GROUPS)})
    contents = {"seed": seed, "groups": GROUPS, "states": states}
    contents["constants"] = {
        name: np.array(getattr(model, name)).ravel().tolist()
        for name in ("body_invweight0", "dof_invweight0", "tendon_length0", "actuator_acc0")
    }
    write("constraint_human416", contents)


def rollouts(seed):
    """A second of flight without contacts, and 50 ms of several states on the ground."""
    model = mujoco.MjModel.from_xml_path(str(BODY))
    tighten(model)
    model.opt.tolerance = 1e-14
    data = mujoco.MjData(model)
    random = SplitMix(seed)
    found = {"flight": [], "ground": []}
    while len(found["flight"]) < 2 or len(found["ground"]) < 10:
        start = random.state
        flight = len(found["flight"]) < 2
        mujoco.mj_resetData(model, data)
        draw(model, data, random, False)
        height = place(model, data, -10.0 if flight else random.between(0.0, 0.01))
        if flight:
            # Little excitation, slow: arms must not meet the trunk.
            data.qvel[:] *= 0.1
            data.act[:] *= 0.05
            data.ctrl[:] *= 0.05
        contacts = convex = 0
        for _ in range(1000 if flight else 50):
            mujoco.mj_step(model, data)
            contacts += data.ncon
            convex += sum(is_convex(model, c) for c in data.contact[: data.ncon])
        if convex or (contacts if flight else not contacts):
            continue
        kind = "flight" if flight else "ground"
        found[kind].append({"seed": str(start), "height": height, "qpos": data.qpos.tolist(), "qvel": data.qvel.tolist()})
    write("constraint_rollouts", found)


def vary(model, random):
    """Gives a body other masses, strengths and frictions, as a program does that changes the model between episodes."""
    for body in range(model.nbody):
        factor = random.between(0.5, 1.5)
        model.body_mass[body] *= factor
        model.body_inertia[body] *= factor
    model.body_subtreemass[:] = model.body_mass
    for body in range(model.nbody - 1, 0, -1):
        model.body_subtreemass[model.body_parentid[body]] += model.body_subtreemass[body]
    for actuator in range(model.nu):
        # Peak force, or where that follows from the muscle's reach, the scale.
        entry = 2 if model.actuator_gainprm[actuator, 2] >= 0.0 else 3
        model.actuator_gainprm[actuator, entry] *= random.between(0.5, 1.5)
    for geom in range(model.ngeom):
        model.geom_friction[geom, 0] = random.between(0.2, 2.0)


def varied(seed):
    """50 ms of bodies of their own on the ground."""
    random = SplitMix(seed)
    found = []
    while len(found) < 6:
        start = random.state
        model = mujoco.MjModel.from_xml_path(str(BODY))
        tighten(model)
        model.opt.tolerance = 1e-14
        data = mujoco.MjData(model)
        draw(model, data, random, False)
        vary(model, random)
        height = place(model, data, random.between(0.0, 0.01))
        contacts = convex = 0
        for _ in range(50):
            mujoco.mj_step(model, data)
            contacts += data.ncon
            convex += sum(is_convex(model, c) for c in data.contact[: data.ncon])
        if contacts and not convex:
            found.append({"seed": str(start), "height": height, "qpos": data.qpos.tolist()})
    write("constraint_varied", {"rollouts": found})


if __name__ == "__main__":
    for number, path in enumerate(sorted((HERE / "contact_models").glob("*.xml"))):
        small(path, 500 + number)
    body(417)
    rollouts(418)
    varied(419)
