"""Golden numbers of compiled models, from MuJoCo: what each array of a model holds after reading its file.

    python tests/oracle/mjcf.py

writes tests/golden/mjcf.json.gz, which tests/mjcf_parity.rs reads. Needs mujoco==4.0.0 and numpy.

Orientations are stored as rotation matrices (a quaternion's sign is free), inertias as tensors in the body's frame (the
order and sign of principal axes are free), limits that do not apply as zeros. The small models are stored whole, the full
body as weighted sums over 64 consecutive entries, with weights that no plausible mistake cancels.
"""

import gzip
import json
import pathlib

import mujoco
import numpy as np

assert mujoco.__version__ == "4.0.0", mujoco.__version__

HERE = pathlib.Path(__file__).parent
SMALL = ("frames", "inertias", "actuators", "copies", "masses", "ranges")
BODY = HERE.parent.parent / "bodies" / "models" / "human416.xml"


def matrices(quaternions):
    out = np.zeros((len(quaternions), 9))
    for row, quaternion in zip(out, quaternions):
        mujoco.mju_quat2Mat(row, quaternion)
    return out


def tensors(quaternions, moments):
    frames = matrices(quaternions).reshape(-1, 3, 3)
    return np.array([frame @ np.diag(moment) @ frame.T for frame, moment in zip(frames, moments)])


def limits(limited, ranges):
    return ranges * limited[:, None]


def linear(coefficients):
    """The first coefficient of a force; the others belong to polynomials of higher degree."""
    return coefficients if coefficients.ndim == 1 else coefficients[:, 0]


def arrays(m):
    # Meshes have no place in our models: geoms are counted without them.
    kept = np.flatnonzero(m.geom_type != int(mujoco.mjtGeom.mjGEOM_MESH))
    renumbered = np.cumsum(m.geom_type != int(mujoco.mjtGeom.mjGEOM_MESH)) - 1
    wraps = np.isin(m.wrap_type, (int(mujoco.mjtWrap.mjWRAP_SPHERE), int(mujoco.mjtWrap.mjWRAP_CYLINDER)))
    scalar = m.jnt_type >= int(mujoco.mjtJoint.mjJNT_SLIDE)
    exclusions = sorted(divmod(int(signature), 1 << 16) for signature in m.exclude_signature)
    return {
        "qpos0": m.qpos0,
        "option": np.array([m.opt.timestep, *m.opt.gravity, m.opt.iterations, m.opt.ls_iterations, m.opt.tolerance,
                            m.opt.ls_tolerance, m.opt.impratio]),
        "body_tree": np.stack([m.body_parentid, m.body_rootid, m.body_weldid, m.body_jntnum, m.body_dofnum], 1),
        "body_pos": m.body_pos,
        "body_mat": matrices(m.body_quat),
        "body_ipos": m.body_ipos,
        "body_tensor": tensors(m.body_iquat, m.body_inertia),
        "body_mass": np.stack([m.body_mass, m.body_subtreemass], 1),
        "jnt_index": np.stack([m.jnt_type, m.jnt_bodyid, m.jnt_qposadr, m.jnt_dofadr, m.jnt_limited], 1),
        "jnt_pos": m.jnt_pos,
        "jnt_axis": m.jnt_axis,
        "jnt_range": limits(m.jnt_limited, m.jnt_range),
        "jnt_number": np.stack([m.jnt_margin, linear(m.jnt_stiffness), np.where(scalar, m.qpos_spring[m.jnt_qposadr], 0)], 1),
        "jnt_limit": np.hstack([m.jnt_solref, m.jnt_solimp]),
        "dof_index": np.stack([m.dof_bodyid, m.dof_jntid, m.dof_parentid], 1),
        "dof_number": np.stack([m.dof_armature, linear(m.dof_damping), m.dof_frictionloss], 1),
        "geom_index": np.stack([m.geom_type, m.geom_bodyid, m.geom_contype, m.geom_conaffinity, m.geom_condim,
                                m.geom_priority, m.geom_group], 1)[kept],
        "geom_size": m.geom_size[kept],
        "geom_pos": m.geom_pos[kept],
        "geom_mat": matrices(m.geom_quat[kept]),
        "geom_number": np.hstack([np.stack([m.geom_solmix, m.geom_margin, m.geom_gap, m.geom_rbound], 1), m.geom_friction,
                                  m.geom_solref, m.geom_solimp])[kept],
        "site_index": m.site_bodyid,
        "site_pos": m.site_pos,
        "site_mat": matrices(m.site_quat),
        "tendon_index": np.stack([m.tendon_num, m.tendon_limited], 1),
        "tendon_number": np.hstack([np.stack([linear(m.tendon_stiffness), linear(m.tendon_damping), m.tendon_margin], 1),
                                    limits(m.tendon_limited, m.tendon_range), m.tendon_solref_lim, m.tendon_solimp_lim]),
        "wrap": np.stack([m.wrap_type, np.where(wraps, renumbered[np.where(wraps, m.wrap_objid, 0)], m.wrap_objid), m.wrap_prm], 1),
        "actuator_index": np.stack([m.actuator_trnid[:, 0], m.actuator_ctrllimited], 1),
        "actuator_number": np.hstack([m.actuator_gear[:, :1], limits(m.actuator_ctrllimited, m.actuator_ctrlrange),
                                      m.actuator_lengthrange, m.actuator_dynprm[:, :3], m.actuator_gainprm[:, :9],
                                      m.actuator_biasprm[:, :9]]),
        "eq_index": np.stack([m.eq_obj1id, m.eq_obj2id], 1),
        "eq_number": np.hstack([m.eq_data[:, :5], m.eq_solref, m.eq_solimp]),
        "pair_index": np.stack([renumbered[m.pair_geom1], renumbered[m.pair_geom2], m.pair_dim], 1),
        "pair_number": np.hstack([m.pair_friction, m.pair_solref, m.pair_solimp, m.pair_solreffriction,
                                  m.pair_margin[:, None], m.pair_gap[:, None]]),
        "exclude": np.array(exclusions),
    }


def names(m):
    kinds = {"body": m.nbody, "joint": m.njnt, "site": m.nsite, "tendon": m.ntendon, "actuator": m.nu, "equality": m.neq}
    enum = mujoco.mjtObj
    return {kind: [mujoco.mj_id2name(m, getattr(enum, f"mjOBJ_{kind.upper()}"), i) or "" for i in range(count)]
            for kind, count in kinds.items()}


def folded(values, group=64):
    weights = np.array([((i * 7919) % 101 + 1) / 101 for i in range(len(values))])
    weighted = values * weights
    return [float(weighted[i : i + group].sum()) for i in range(0, len(values), group)]


def record(path, whole):
    model = mujoco.MjModel.from_xml_path(str(path))
    flat = {name: np.asarray(values, float).ravel() for name, values in arrays(model).items()}
    return {"names": names(model) if whole else {},
            "arrays": {name: values.tolist() if whole else folded(values) for name, values in flat.items()}}


def main():
    models = {name: record(HERE / "models" / "mjcf" / f"{name}.xml", whole=True) for name in SMALL}
    models["human416"] = record(BODY, whole=False)
    content = json.dumps({"mujoco": mujoco.__version__, **models}).encode()
    with open(HERE.parent / "golden" / "mjcf.json.gz", "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as file:
        file.write(content)


if __name__ == "__main__":
    main()
