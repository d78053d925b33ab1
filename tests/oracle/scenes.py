"""Golden numbers of bodies in scenes, from MuJoCo.

    python tests/oracle/scenes.py

writes tests/golden/scenes.json.gz, which tests/scene_parity.rs reads. The scenes are written here as MJCF around the small
body of tests/oracle/models/scene_body.xml; the code under test builds them from their descriptions.
"""

import gzip
import json
import pathlib

import mujoco
import numpy as np

assert mujoco.__version__ == "4.0.0", mujoco.__version__

ROOT = pathlib.Path(__file__).resolve().parents[2]
BODY = (ROOT / "tests/oracle/models/scene_body.xml").read_text()

# Bodies of the world, what the trunk carries, sites of the left and right arm, equalities.
SCENES = {
    "door": (
        """<body name="door" pos="0.5 -0.4 0.1">
             <joint name="door.swing" axis="0 0 -1" range="0 1.5" damping="0.05" stiffness="0.2"/>
             <body name="door.leaf" pos="0 0.4 1.0">
               <geom name="door.leaf" type="ellipsoid" size="0.04 0.5 1.0" mass="19.4"/>
             </body>
             <body name="door.handle" pos="-0.08 0.8 0.9" quat="0.70710678118654752 0.70710678118654752 0 0">
               <geom name="door.handle" type="capsule" size="0.03 0.1" mass="0.5" friction="0.7 0.01 0.0001" condim="4"/>
             </body>
           </body>""",
        "", "", "", "",
    ),
    "ball_and_board": (
        """<body name="board" pos="0 0 0.05"><geom name="board" type="ellipsoid" size="0.4 0.6 0.05"/></body>
           <body name="ball" pos="0.6 0 1.2"><freejoint name="ball"/>
             <geom name="ball" type="sphere" size="0.11" mass="0.4" friction="0.8 0.02 0.001" condim="6"/></body>
           <body name="pole" pos="0.3 0.5 1"><geom name="pole" type="capsule" size="0.05 1"/></body>""",
        "", "", "", "",
    ),
    "load": (
        "",
        """<body name="load" pos="-0.2 0 0.25">
             <geom name="load" type="ellipsoid" size="0.15 0.2 0.25" mass="12"/>
             <body name="load.flap" pos="0 0 0.3"><joint name="load.hinge" axis="0 1 0" pos="0.1 0 0" damping="0.1"/>
               <geom name="load.flap" type="sphere" size="0.1" mass="1"/></body>
           </body>""",
        "", "", "",
    ),
    "bar": (
        """<body name="bar" pos="0.5 0 1.4"><freejoint name="bar"/>
             <geom name="bar" type="capsule" size="0.02 0.6" mass="8" quat="0.70710678118654752 0.70710678118654752 0 0"
                   contype="0" conaffinity="0"/>
             <site name="bar_l"/>
             <site name="bar_r"/>
           </body>""",
        "", '<site name="hand_l" pos="0.5 0 0"/>', '<site name="hand_r" pos="0.5 0 0"/>',
        """<equality><weld site1="hand_l" site2="bar_l"/><connect site1="hand_r" site2="bar_r"/></equality>""",
    ),
}


def compose(world, carried, left, right, equality):
    text = BODY.replace('mass="3" conaffinity="0"/>\n      </body>\n      <body name="arm_r"',
                        f'mass="3" conaffinity="0"/>{left}\n      </body>\n      <body name="arm_r"')
    head, tail = text.rsplit('mass="3" conaffinity="0"/>\n      </body>\n', 1)
    text = f'{head}mass="3" conaffinity="0"/>{right}\n      </body>\n{carried}{tail}'
    text = text.replace("</worldbody>", world + "</worldbody>")
    return text.replace("</mujoco>", equality + "</mujoco>")


def flat(array):
    return np.asarray(array, float).ravel().tolist()


def states(model, rng, count):
    data = mujoco.MjData(model)
    while count:
        mujoco.mj_resetData(model, data)
        for joint in range(model.njnt):
            address = model.jnt_qposadr[joint]
            if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
                data.qpos[address:address + 3] += rng.normal(0, [0.25, 0.25, 0.25])
                data.qpos[address + 2] = abs(data.qpos[address + 2] - 0.7) * 0.8 + 0.05
                quaternion = np.array([1.0, 0, 0, 0]) + rng.normal(0, 0.4, 4)
                data.qpos[address + 3:address + 7] = quaternion / np.linalg.norm(quaternion)
            else:
                data.qpos[address] = rng.uniform(-1.2, 1.6)
        data.qvel[:] = rng.normal(0, 0.8, model.nv)
        mujoco.mj_forward(model, data)
        # Shapes deep in each other may be pushed apart in several ways.
        if any(contact.dist < -0.02 for contact in data.contact):
            continue
        count -= 1
        yield {
            "qpos": flat(data.qpos),
            "qvel": flat(data.qvel),
            "contacts": [contact.geom.tolist() + [float(contact.dist)] for contact in data.contact],
            "rows": int(data.nefc),
            "efc_pos": flat(data.efc_pos),
            "qacc": flat(data.qacc),
        }


def main():
    rng = np.random.default_rng(12)
    golden = {}
    for name, parts in SCENES.items():
        model = mujoco.MjModel.from_xml_string(compose(*parts))
        model.opt.iterations, model.opt.tolerance = 100, 1e-10
        golden[name] = {
            "bodies": [model.body(index).name for index in range(model.nbody)],
            "body_mass": flat(model.body_mass),
            "body_ipos": flat(model.body_ipos),
            "body_invweight0": flat(model.body_invweight0),
            "body_subtreemass": flat(model.body_subtreemass),
            "dof_invweight0": flat(model.dof_invweight0),
            "qpos0": flat(model.qpos0),
            "states": list(states(model, rng, 40)),
        }
        touching = sum(len(state["contacts"]) for state in golden[name]["states"])
        print(f"{name}: {model.nbody} bodies, {touching} contacts in 40 states")
    path = ROOT / "tests/golden/scenes.json.gz"
    with gzip.GzipFile(path, "wb", mtime=0) as file:
        file.write(json.dumps(golden).encode())
    print(path.stat().st_size, "bytes")


if __name__ == "__main__":
    main()
