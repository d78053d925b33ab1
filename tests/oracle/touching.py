"""Which of two answers to "where do these shapes touch" is right, from the shapes' definitions alone.

The signed distance of two convex shapes is the largest value, over all unit vectors n, of the gap between them across n. An
answer with a normal across which the gap is larger is the better one, whoever gave it.
"""

import mujoco
import numpy as np

KINDS = mujoco.mjtGeom
# Why contacts differ, in the order in which it is asked.
CLASSES = {
    "closer": "ours separate the shapes by less than MuJoCo's, which stopped short",
    "along": "another point of the same line or face",
    "corners": "other four corners of the same face",
    "azimuth": "a cap that a first cylinder shows: which line of its side MuJoCo lays on the other's cap follows from its search",
    "edge": "nearly parallel parts: another edge or face was laid on the other shape; one of the two separates by as little as the other's",
    "farther": "MuJoCo's separate by less",
}


def reach(model, data, geom, direction):
    """How far a shape reaches from its centre."""
    kind, size = model.geom_type[geom], model.geom_size[geom]
    d = direction @ data.geom_xmat[geom].reshape(3, 3)
    if kind == KINDS.mjGEOM_SPHERE:
        return size[0]
    if kind == KINDS.mjGEOM_CAPSULE:
        return size[0] + size[1] * abs(d[2])
    if kind == KINDS.mjGEOM_ELLIPSOID:
        return float(np.linalg.norm(size * d))
    if kind == KINDS.mjGEOM_CYLINDER:
        return size[0] * float(np.hypot(d[0], d[1])) + size[1] * abs(d[2])
    return float(np.abs(d) @ size)


def gap(model, data, pair, direction):
    first, second = pair
    between = direction @ (data.geom_xpos[second] - data.geom_xpos[first])
    return between - reach(model, data, first, direction) - reach(model, data, second, -direction)


def same_plane(ours, theirs):
    """Whether all contacts lie on one pair of facing planes: the distance is one linear function of the place."""
    points = np.array([place for _, place, _ in ours + theirs])
    distances = np.array([distance for distance, *_ in ours + theirs])
    left = np.c_[points, np.ones(len(points))]
    solution, *_ = np.linalg.lstsq(left, distances, rcond=None)
    return np.abs(left @ solution - distances).max() < 1e-6


def classify(model, data, pair, ours, theirs):
    """The class of a difference; contacts are distance, place, normal."""
    if not ours or not theirs:
        return "farther" if not ours else "edge"
    best = [max(gap(model, data, pair, normal) for *_, normal in found) for found in (ours, theirs)]
    normals = np.array([normal for *_, normal in ours + theirs])
    one_face = np.abs(normals - normals[0]).max() < 1e-6
    if len(ours) == len(theirs) == 1:
        if one_face and abs(ours[0][0] - theirs[0][0]) < 1e-8:
            return "along"
        return "closer" if best[0] >= best[1] else "farther"
    if one_face and len(ours) == len(theirs) and same_plane(ours, theirs):
        return "corners"
    cylinder = model.geom_type[pair[0]] == KINDS.mjGEOM_CYLINDER
    axis = data.geom_xmat[pair[0]].reshape(3, 3)[:, 2]
    if cylinder and len(ours) == 1 and abs(ours[0][2] @ axis) > 1 - 1e-9:
        return "azimuth"
    return "edge"
