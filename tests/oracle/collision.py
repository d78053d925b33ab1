"""Golden numbers of contacts between all kinds of shapes, from MuJoCo.

    python tests/oracle/collision.py

writes tests/golden/collision_*.json.gz, which tests/collision_parity.rs reads. Each pair of kinds is a model of two free
bodies; poses are not stored, both sides draw them from the same generator. MuJoCo's general convex collider is tightened
from its `ccd_tolerance` of 1e-6 m, so that differences are not those of its stopping early.

Poses come in four sorts: anywhere near, face to face, nearly face to face, and deep inside each other. Over the height field
shapes stay high enough to touch its surface, `multiccd` is off and there is a margin: without either MuJoCo's depth of a
polyhedron in a prism is not the least one.
"""

import itertools
import math
import pathlib

import mujoco
import numpy as np

from smooth import SplitMix, write

ROCK = "-.2 -.15 -.1  .25 -.2 -.12  .2 .2 -.15  -.15 .25 -.1  0 .05 .3  .2 .02 .2  -.1 -.1 .2"
CUBE = " ".join(f"{x * 0.2} {y * 0.15} {z * 0.25}" for x, y, z in itertools.product((-1, 1), repeat=3))
HEIGHTS = " ".join(f"{0.5 + 0.5 * math.sin(1.7 * k * k):.6f}" for k in range(42))
ASSETS = f"""<asset>
  <mesh name="rock" vertex="{ROCK}"/>
  <mesh name="cube" vertex="{CUBE}"/>
  <hfield name="hills" nrow="6" ncol="7" size="1 .8 .15 .1" elevation="{HEIGHTS}"/>
</asset>"""

SHAPES = {
    "plane": 'type="plane" size="1 1 .1"',
    "hills": 'type="hfield" hfield="hills"',
    "sphere": 'type="sphere" size=".16"',
    "capsule": 'type="capsule" size=".09 .2"',
    "ellipsoid": 'type="ellipsoid" size=".12 .2 .16"',
    "cylinder": 'type="cylinder" size=".15 .2"',
    "box": 'type="box" size=".2 .14 .17"',
    "slab": 'type="box" size=".3 .35 .1"',
    "rock": 'type="mesh" mesh="rock"',
    "cube": 'type="mesh" mesh="cube"',
}
CLOSED = {"plane", "sphere", "capsule", "box", "slab"}
FIXED = ("plane", "hills")


def pairs():
    names = list(SHAPES)
    for first, second in itertools.combinations_with_replacement(names, 2):
        if second not in FIXED:
            yield first, second


def is_closed(first, second):
    """Whether MuJoCo meets the two with a closed form."""
    return first == "plane" or {first, second} <= CLOSED or {first, second} in ({"sphere", "cylinder"}, {"sphere", "ellipsoid"})


def text(first, second, margin):
    joint = "" if first in FIXED else "<freejoint/>"
    flags = '<flag multiccd="disable"/>' if first == "hills" else ""
    return f"""<mujoco><option ccd_tolerance="1e-13" ccd_iterations="1000">{flags}</option>{ASSETS}<worldbody>
  <body>{joint}<geom {SHAPES[first]} margin="{margin}"/></body>
  <body><freejoint/><geom {SHAPES[second]}/></body>
</worldbody></mujoco>"""


def orientation(random, sort):
    """A random rotation, a multiple of quarter turns, or nearly that."""
    free = [random.between(-1.0, 1.0) for _ in range(4)]
    turn = [float(int(random.between(-2.0, 2.0))) for _ in range(4)]
    if sort in (0, 3) or not any(turn):
        return free
    return [t + 0.02 * f for t, f in zip(turn, free)] if sort == 2 else turn


def draw(random, number, joints):
    """Positions and orientations of the bodies that move."""
    sort = number % 4
    coordinates = []
    for _ in range(joints):
        reach = 0.08 if sort == 3 else 0.26
        coordinates += [random.between(-reach, reach) for _ in range(3)]
        coordinates += orientation(random, sort)
    return coordinates


def golden(name, chosen, seed, count):
    found = []
    for index, (first, second) in enumerate(chosen):
        margin = 0.03 if index % 3 == 2 or first == "hills" else 0.0
        model_text = text(first, second, margin)
        model = mujoco.MjModel.from_xml_string(model_text)
        data = mujoco.MjData(model)
        random = SplitMix(seed + index)
        cases = []
        for number in range(count):
            data.qpos[:] = draw(random, number, model.njnt)
            if first == "hills":
                data.qpos[2] = 0.16 + 0.5 * abs(data.qpos[2])
            mujoco.mj_kinematics(model, data)
            mujoco.mj_collision(model, data)
            cases.append([
                [round(float(value), 11) for value in (c.dist, *c.pos, *c.frame[:3])] for c in data.contact[: data.ncon]
            ])
        found.append({"first": first, "second": second, "closed": is_closed(first, second), "seed": seed + index,
                      "text": model_text, "cases": cases})
    write(f"collision_{name}", {"pairs": found})


def rays(seed, count):
    """Rays from around every shape and from inside it: distances, -1 where nothing is met, and normals."""
    found = []
    for index, name in enumerate(SHAPES):
        model_text = f"""<mujoco>{ASSETS}<worldbody><geom pos=".1 -.2 .15" quat=".9 .2 -.3 .1" {SHAPES[name]}/></worldbody></mujoco>"""
        model = mujoco.MjModel.from_xml_string(model_text)
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        random = SplitMix(seed + index)
        hits = []
        for number in range(count):
            reach = 0.05 if number % 3 == 0 else 0.6
            origin = np.array([0.1, -0.2, 0.15]) + [random.between(-reach, reach) for _ in range(3)]
            aim = np.array([0.1, -0.2, 0.15]) + [random.between(-0.3, 0.3) for _ in range(3)]
            geom, normal = np.array([-1], dtype=np.int32), np.zeros(3)
            distance = mujoco.mj_ray(model, data, origin, aim - origin, None, 1, -1, geom, normal)
            hits.append([round(float(value), 11) for value in (distance, *normal)])
        found.append({"shape": name, "seed": seed + index, "text": model_text, "hits": hits})
    return found


def gaps(seed, count):
    """Distances of shapes that are apart."""
    found = []
    for index, (first, second) in enumerate(pairs()):
        model_text = text(first, second, 0.0)
        model = mujoco.MjModel.from_xml_string(model_text)
        data = mujoco.MjData(model)
        random = SplitMix(seed + index)
        distances = []
        for number in range(count):
            data.qpos[:] = draw(random, 0, model.njnt)
            data.qpos[-7:-4] += [0.3, 0.2, 0.7]
            mujoco.mj_kinematics(model, data)
            distances.append(round(mujoco.mj_geomDistance(model, data, 0, 1, 5.0, np.zeros(6)), 11))
        found.append({"first": first, "second": second, "seed": seed + index, "text": model_text, "distances": distances})
    return found


def solids():
    """Masses, centres, inertia tensors and shapes of a model of meshes."""
    model = mujoco.MjModel.from_xml_path(str(pathlib.Path(__file__).parent / "models" / "mjcf" / "solids.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    frames = data.ximat.reshape(-1, 3, 3)
    tensors = [frame @ np.diag(moments) @ frame.T for frame, moments in zip(frames, model.body_inertia)]
    return {
        "mass": model.body_mass.tolist(), "centre": model.body_ipos.ravel().tolist(), "tensor": np.array(tensors).ravel().tolist(),
        "radius": model.geom_rbound.tolist(), "samples": model.hfield_data.ravel().tolist(),
        "hulls": [int(model.mesh_graph[start]) for start in model.mesh_graphadr],
    }


if __name__ == "__main__":
    every = list(pairs())
    golden("closed", [pair for pair in every if is_closed(*pair)], 700, 60)
    golden("convex", [pair for pair in every if not is_closed(*pair)], 800, 36)
    write("collision_queries", {"rays": rays(900, 45), "gaps": gaps(1000, 8), "solids": solids()})
