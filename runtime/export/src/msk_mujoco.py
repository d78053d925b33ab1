"""What tasks exported by `msk export --target python` need beside NumPy and MuJoCo: the task itself, signals of `MjModel` and
`MjData`, operators with memory, random streams and motions.

Positions are in m, angles in rad, forces in N, expressed in the world frame. Everything is read of the present configuration:
call `mujoco.mj_forward` before.
"""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

#: Height of the ground, m, where nothing walkable lies under a place.
ABYSS = -10.0


@dataclass(frozen=True)
class Landmark:
    """A named point of a body with anatomical axes."""

    #: Name of the body of the model that carries it.
    body: str
    #: The point in the frame of that body, m.
    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    #: The anatomical axes forward, left, up in that frame.
    axes: tuple[tuple[float, float, float], ...] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    #: The shapes around it, by name or number: what touches, and what is above the ground.
    segment: tuple[str | int, ...] = ()


@dataclass(frozen=True)
class Anatomy:
    """What of a model is the body, and how its parts are called."""

    #: The body that carries all others.
    root: str
    #: Bodies of the scene that are attached to the body and do not count as parts of it.
    carried: tuple[str, ...] = ()
    landmarks: dict[str, Landmark] = field(default_factory=dict)
    #: Groups of landmarks that count as one entity in contacts.
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    #: Joints by their names in the task, where the model calls them otherwise.
    joints: dict[str, str] = field(default_factory=dict)
    #: Walkable shapes, by name or number; none means the level z = 0.
    ground: tuple[str | int, ...] = ()


def measured(signal: Callable[..., Any]) -> Callable[..., Any]:
    """A signal that is measured once per control step, however many formulas read it."""

    @functools.wraps(signal)
    def kept(self: Signals, *arguments: Any) -> Any:
        key = (signal.__name__, *arguments)
        if key not in self._known:
            self._known[key] = signal(self, *arguments)
        return self._known[key]

    return kept


class Signals:
    """Signals of one state of a model."""

    def __init__(self, model: mujoco.MjModel, anatomy: Anatomy) -> None:
        self.model, self.anatomy = model, anatomy
        self.data: mujoco.MjData | None = None
        #: The policy's action, entries in -1..1.
        self.action = np.zeros(model.nu)
        #: Length of the control step that has just passed, s; 0 at reset.
        self.elapsed = 0.0
        #: Time since reset, s.
        self.time = 0.0
        self._known: dict[tuple[Any, ...], Any] = {}
        self._velocities: dict[str, np.ndarray] = {}
        root = self._body(anatomy.root)
        carried = {self._body(name) for name in anatomy.carried}
        #: Numbers of the bodies that make up the body.
        self.own = np.array([body for body in range(model.nbody) if self._is_part(body, root) and body not in carried])
        self._mass = model.body_mass[self.own]
        self._ground = [self._geom(shape) for shape in anatomy.ground]
        self._joints: dict[tuple[str, ...], tuple[np.ndarray, np.ndarray]] = {}
        self._actuators: dict[tuple[str, ...], np.ndarray] = {}
        self._parts: dict[str, frozenset[int]] = {}

    def update(self, data: mujoco.MjData, action: np.ndarray, time: float, elapsed: float) -> None:
        """Goes on to a control step; at reset with `elapsed` 0, which forgets the velocities before."""
        self.data, self.action, self.time, self.elapsed = data, action, np.float64(time), elapsed
        self._known.clear()
        if elapsed == 0.0:
            self._velocities.clear()

    def _body(self, name: str) -> int:
        return self.model.body(name).id

    def _geom(self, shape: str | int) -> int:
        return shape if isinstance(shape, int) else self.model.geom(shape).id

    def _is_part(self, body: int, root: int) -> bool:
        while body > root:
            body = self.model.body_parentid[body]
        return body == root

    # Landmarks

    @measured
    def position(self, name: str) -> np.ndarray:
        """Position of a landmark, m."""
        landmark = self.anatomy.landmarks[name]
        body = self.data.body(landmark.body)
        return body.xpos + body.xmat.reshape(3, 3) @ np.array(landmark.point)

    @measured
    def velocity(self, name: str) -> np.ndarray:
        """Velocity of the point, m/s."""
        return self._velocity_at(self._body(self.anatomy.landmarks[name].body), self.position(name))

    def _velocity_at(self, body: int, point: np.ndarray) -> np.ndarray:
        # MuJoCo's spatial velocities refer to the centre of mass of the kinematic tree.
        spin, drift = self.data.cvel[body, :3], self.data.cvel[body, 3:]
        return drift + np.cross(spin, point - self.data.subtree_com[self.model.body_rootid[body]])

    @measured
    def acceleration(self, name: str) -> np.ndarray:
        """Mean acceleration of the point over the control step, m/s^2; 0 at reset."""
        return self._mean_acceleration(name, self.velocity(name))

    def _mean_acceleration(self, name: str, velocity: np.ndarray) -> np.ndarray:
        before, self._velocities[name] = self._velocities.get(name, velocity), velocity
        return (velocity - before) / self.elapsed if self.elapsed > 0.0 else np.zeros(3)

    @measured
    def axes(self, name: str) -> np.ndarray:
        """Anatomical axes forward, left and up, one after the other: 9 numbers."""
        landmark = self.anatomy.landmarks[name]
        return (self.data.body(landmark.body).xmat.reshape(3, 3) @ np.array(landmark.axes).T).T.ravel()

    def forward(self, name: str) -> np.ndarray:
        """Unit vector anatomically forward."""
        return self.axes(name)[:3]

    def left(self, name: str) -> np.ndarray:
        """Unit vector anatomically left."""
        return self.axes(name)[3:6]

    def up(self, name: str) -> np.ndarray:
        """Unit vector anatomically up."""
        return self.axes(name)[6:]

    def angular_velocity(self, name: str) -> np.ndarray:
        """Angular velocity of the body part, rad/s."""
        return self.data.cvel[self._body(self.anatomy.landmarks[name].body), :3]

    def heading(self, name: str) -> np.ndarray:
        """Where forward points, seen from above: unit vector of two components; world x where it is vertical."""
        level = self.forward(name)[:2]
        length = np.linalg.norm(level)
        return level / length if length > 1e-12 else np.array([1.0, 0.0])

    # Joints and muscles; lists of names give arrays

    def _addresses(self, names: tuple[str, ...]) -> tuple[np.ndarray, np.ndarray]:
        if names not in self._joints:
            joints = [self.model.joint(self.anatomy.joints.get(name, name)) for name in names]
            positions = np.array([joint.qposadr[0] for joint in joints])
            self._joints[names] = positions, np.array([joint.dofadr[0] for joint in joints])
        return self._joints[names]

    def q(self, *names: str) -> np.ndarray:
        """Coordinates of joints, rad or m."""
        return self.data.qpos[self._addresses(names)[0]]

    def qd(self, *names: str) -> np.ndarray:
        """Their rates, rad/s or m/s."""
        return self.data.qvel[self._addresses(names)[1]]

    def qdd(self, *names: str) -> np.ndarray:
        """Their accelerations, rad/s^2 or m/s^2."""
        return self.data.qacc[self._addresses(names)[1]]

    def torque(self, *names: str) -> np.ndarray:
        """Generalised forces of all muscles on joints, N m or N."""
        return self.data.qfrc_actuator[self._addresses(names)[1]]

    def _muscles(self, names: tuple[str, ...]) -> np.ndarray:
        if names not in self._actuators:
            self._actuators[names] = np.array([self.model.actuator(name).id for name in names])
        return self._actuators[names]

    def muscle_length(self, *names: str) -> np.ndarray:
        """Lengths of muscle-tendon units, m."""
        return self.data.actuator_length[self._muscles(names)]

    def muscle_velocity(self, *names: str) -> np.ndarray:
        """Their rates, m/s."""
        return self.data.actuator_velocity[self._muscles(names)]

    def muscle_force(self, *names: str) -> np.ndarray:
        """Actuator forces, N, negative in tension."""
        return self.data.actuator_force[self._muscles(names)]

    def activation(self, *names: str) -> np.ndarray:
        """Activations, 0..1."""
        return self.data.act[self.model.actuator_actadr[self._muscles(names)]]

    def excitation(self, *names: str) -> np.ndarray:
        """Excitations, 0..1."""
        return self.data.ctrl[self._muscles(names)]

    def muscle_action(self, *names: str) -> np.ndarray:
        """The actions of muscles, -1..1."""
        return self.action[self._muscles(names)]

    # The whole body

    @measured
    def com_position(self) -> np.ndarray:
        """Centre of mass of the body without what it carries, m."""
        return self._mass @ self.data.xipos[self.own] / self._mass.sum()

    @measured
    def com_velocity(self) -> np.ndarray:
        """Its velocity, m/s."""
        velocities = [self._velocity_at(body, self.data.xipos[body]) for body in self.own]
        return self._mass @ np.array(velocities) / self._mass.sum()

    @measured
    def com_acceleration(self) -> np.ndarray:
        """Its mean acceleration over the control step, m/s^2; 0 at reset."""
        return self._mean_acceleration("com", self.com_velocity())

    @measured
    def angular_momentum(self) -> np.ndarray:
        """Angular momentum about the centre of mass, kg m^2/s."""
        centre, drift, total = self.com_position(), self.com_velocity(), np.zeros(3)
        for body, mass in zip(self.own, self._mass, strict=True):
            axes, position = self.data.ximat[body].reshape(3, 3), self.data.xipos[body]
            total += axes @ (self.model.body_inertia[body] * (axes.T @ self.data.cvel[body, :3]))
            total += mass * np.cross(position - centre, self._velocity_at(body, position) - drift)
        return total

    # Contacts; a part is a landmark's segment, `group NAME`, `ground` or `robot`

    def _shapes(self, part: str) -> frozenset[int]:
        if part not in self._parts:
            landmarks, word, name = self.anatomy.landmarks, *part.partition(" ")[::2]
            if part == "ground":
                shapes = self._ground
            elif part == "robot":
                shapes = [geom for geom in range(self.model.ngeom) if self.model.geom_bodyid[geom] in self.own]
            else:
                members = self.anatomy.groups[name] if word == "group" else (part,)
                shapes = [self._geom(shape) for member in members for shape in landmarks[member].segment]
            self._parts[part] = frozenset(shapes)
        return self._parts[part]

    @measured
    def _contacts(self, first: str, second: str) -> list[tuple[int, float]]:
        """Numbers of the contacts of two parts, and the sign of their forces on the first."""
        one, other = self._shapes(first), self._shapes(second)
        found = []
        for number in range(self.data.ncon):
            contact = self.data.contact[number]
            a, b = (int(geom) for geom in contact.geom)
            # Contacts in the gap beyond the margin carry no force.
            if contact.dist >= contact.includemargin:
                continue
            if b in one and a in other:
                found.append((number, 1.0))
            elif a in one and b in other:
                found.append((number, -1.0))
        return found

    def touching(self, first: str, second: str) -> np.float64:
        """1 where two parts touch, else 0."""
        return np.float64(bool(self._contacts(first, second)))

    def contact_count(self, first: str, second: str) -> np.float64:
        """Number of their contact points."""
        return np.float64(len(self._contacts(first, second)))

    def contact_force(self, first: str, second: str) -> np.ndarray:
        """Force on the first by the second, N."""
        total, wrench = np.zeros(3), np.zeros(6)
        for number, sign in self._contacts(first, second):
            mujoco.mj_contactForce(self.model, self.data, number, wrench)
            total += sign * self.data.contact[number].frame.reshape(3, 3).T @ wrench[:3]
        return total

    def slip(self, first: str, second: str) -> np.float64:
        """Sliding speed where they touch, weighted by the normal forces, m/s; 0 without contact."""
        sliding = pressing = 0.0
        wrench = np.zeros(6)
        for number, _ in self._contacts(first, second):
            mujoco.mj_contactForce(self.model, self.data, number, wrench)
            contact = self.data.contact[number]
            a, b = (self._velocity_at(self.model.geom_bodyid[geom], contact.pos) for geom in contact.geom)
            against = contact.frame.reshape(3, 3) @ (b - a)
            sliding += wrench[0] * np.linalg.norm(against[1:])
            pressing += wrench[0]
        return np.float64(sliding / pressing if pressing > 0.0 else 0.0)

    # The ground

    def place(self, name: str, offset: Sequence[float]) -> np.ndarray:
        """A landmark's position, moved by an offset along its heading: forward, left, up."""
        ahead = self.heading(name)
        level = ahead * offset[0] + np.array([-ahead[1], ahead[0]]) * offset[1]
        return self.position(name) + np.array([*level, offset[2]])

    def ground_height(self, place: np.ndarray) -> np.float64:
        """Height of walkable ground under or over a place, m."""
        return self._footing(place)[0]

    def ground_normal(self, place: np.ndarray) -> np.ndarray:
        """Upward unit normal of the ground there; straight up where there is none."""
        return self._footing(place)[1]

    def _footing(self, place: np.ndarray) -> tuple[np.float64, np.ndarray]:
        """The highest walkable surface over or under a place: its height and its upward normal."""
        up = np.array([0.0, 0.0, 1.0])
        if not self._ground:
            return np.float64(0.0), up
        return max((self._top(geom, place) for geom in self._ground), key=lambda footing: footing[0])

    def _top(self, geom: int, place: np.ndarray) -> tuple[np.float64, np.ndarray]:
        position, rotation = self.data.geom_xpos[geom], self.data.geom_xmat[geom].reshape(3, 3)
        kind, up = self.model.geom_type[geom], np.array([0.0, 0.0, 1.0])
        none = np.float64(ABYSS), up
        if kind == mujoco.mjtGeom.mjGEOM_PLANE:
            normal = rotation[:, 2]
            if normal[2] <= 0.0:
                return none
            return position[2] - normal[:2] @ (place[:2] - position[:2]) / normal[2], normal
        if kind == mujoco.mjtGeom.mjGEOM_HFIELD:
            return self._on_field(geom, rotation.T @ (np.array([*place[:2], position[2]]) - position)) or none
        # From outside, but no farther away than needed.
        above = np.array([place[0], place[1], position[2] + 1.001 * self.model.geom_rbound[geom]])
        size = self.model.geom_size[geom]
        fall = mujoco.mju_rayGeom(position, self.data.geom_xmat[geom], size, above, -up, kind)
        if fall < 0.0:
            return none
        outward = _normal(kind, size, rotation.T @ (above - fall * up - position))
        return above[2] - fall, rotation @ outward

    def _on_field(self, geom: int, place: np.ndarray) -> tuple[np.float64, np.ndarray] | None:
        """Height and normal of a height field at a place of its own frame; cells are cut along their diagonals."""
        model, field = self.model, self.model.geom_dataid[geom]
        rotation = self.data.geom_xmat[geom].reshape(3, 3)
        if rotation[2, 2] < 1.0 - 1e-9:
            raise NotImplementedError("the height of a height field that is not level")
        rows, columns = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
        first, size = model.hfield_adr[field], model.hfield_size[field]
        samples = model.hfield_data[first : first + rows * columns].reshape(rows, columns).astype(float) * size[2]
        cells = np.array([columns - 1, rows - 1])
        along = (place[:2] / size[:2] + 1.0) * 0.5 * cells
        if (along < 0.0).any() or (along > cells).any():
            return None
        column, row = np.minimum(along.astype(int), cells - 1)
        x, y = along - (column, row)
        (here, right), (ahead, across) = samples[row : row + 2, column : column + 2]
        rise = (right - here, across - right) if x >= y else (across - ahead, ahead - here)
        slope = np.array(rise) * cells / (2.0 * size[:2])
        normal = np.array([-slope[0], -slope[1], 1.0])
        height = self.data.geom_xpos[geom][2] + here + x * rise[0] + y * rise[1]
        return height, rotation @ (normal / np.linalg.norm(normal))

    @measured
    def clearance(self, name: str) -> np.float64:
        """Height of the lowest point of a landmark's segment above the ground, which is level, m."""
        planes = [(self.data.geom_xpos[geom], self.data.geom_xmat[geom].reshape(3, 3)[:, 2]) for geom in self._ground]
        planes = planes or [(np.zeros(3), np.array([0.0, 0.0, 1.0]))]
        shapes = self._shapes(name)
        return np.float64(min((self._above(shape, *plane) for shape in shapes for plane in planes), default=np.inf))

    def _above(self, geom: int, origin: np.ndarray, normal: np.ndarray) -> np.float64:
        """How far a convex shape is above a plane, along the vertical."""
        size, kinds = self.model.geom_size[geom], mujoco.mjtGeom
        down = self.data.geom_xmat[geom].reshape(3, 3).T @ -normal
        kind = self.model.geom_type[geom]
        if kind == kinds.mjGEOM_SPHERE:
            reach = size[0]
        elif kind == kinds.mjGEOM_CAPSULE:
            reach = size[0] + size[1] * abs(down[2])
        elif kind == kinds.mjGEOM_ELLIPSOID:
            reach = np.linalg.norm(size * down)
        elif kind == kinds.mjGEOM_CYLINDER:
            reach = size[0] * np.hypot(down[0], down[1]) + size[1] * abs(down[2])
        elif kind == kinds.mjGEOM_BOX:
            reach = size @ np.abs(down)
        else:
            raise NotImplementedError(f"the clearance of a shape of kind {kinds(kind).name}")
        return ((self.data.geom_xpos[geom] - origin) @ normal - reach) / normal[2]

    def radar(self, name: str, group: str, sectors: int, over: float, span: float) -> np.ndarray:
        """Nearness of the members of a group, sector by sector from left to right: 1 - distance / span of the nearest, 0 if
        none is in sight. Members are spheres or upright cylinders: discs, seen from above."""
        eye, heading = self.position(name)[:2], self.heading(name)
        seen = np.zeros(sectors)
        for member in self.anatomy.groups[group]:
            for shape in self.anatomy.landmarks[member].segment:
                geom = self._geom(shape)
                if (
                    self.model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_CYLINDER
                    and abs(self.data.geom_xmat[geom][8]) < 1.0 - 1e-9
                ):
                    raise NotImplementedError("a radar that looks at cylinders which do not stand upright")
                centre, radius = self.data.geom_xpos[geom][:2] - eye, self.model.geom_size[geom][0]
                for sector in range(sectors):
                    left, right = (over * (0.5 - (sector + side) / sectors) for side in (0, 1))
                    distance = _disc_in_sector(centre, radius, heading, left, right)
                    seen[sector] = max(seen[sector], 1.0 - distance / span)
        return seen


def _normal(kind: int, size: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Outward unit normal of a shape at a point of its surface, both in its own frame."""
    kinds = mujoco.mjtGeom
    if kind == kinds.mjGEOM_BOX:
        outward = np.where(np.arange(3) == np.argmax(np.abs(point) / size), np.sign(point), 0.0)
    elif kind == kinds.mjGEOM_CYLINDER and abs(point[2]) >= size[1] * (1.0 - 1e-9):
        outward = np.array([0.0, 0.0, np.sign(point[2])])
    elif kind == kinds.mjGEOM_CYLINDER:
        outward = point * [1.0, 1.0, 0.0]
    elif kind == kinds.mjGEOM_CAPSULE:
        outward = point - [0.0, 0.0, np.clip(point[2], -size[1], size[1])]
    else:
        outward = point / size**2 if kind == kinds.mjGEOM_ELLIPSOID else point
    return outward / np.linalg.norm(outward)


def _disc_in_sector(centre: np.ndarray, radius: float, heading: np.ndarray, left: float, right: float) -> np.float64:
    """Distance from the origin to the nearest point of a disc between two bearings; infinite where there is none."""
    away = np.linalg.norm(centre)
    if away <= radius:
        return 0.0
    bearing = np.arctan2(heading[0] * centre[1] - heading[1] * centre[0], heading @ centre)
    if right <= bearing <= left or right <= bearing + 2.0 * np.pi <= left:
        return away - radius
    least = np.inf
    for angle in (left, right):
        direction = heading * np.cos(angle) + np.array([-heading[1], heading[0]]) * np.sin(angle)
        along = direction @ centre
        inside = radius**2 - (away**2 - along**2)
        if along > 0.0 and inside >= 0.0:
            least = min(least, along - np.sqrt(inside))
    return least


# Functions


def number(condition: Any) -> Any:
    """A condition as 0 or 1."""
    return np.asarray(condition, dtype=float)[()]


def choose(condition: Any, yes: Any, no: Any) -> Any:
    """One of two values, element by element; both have been computed."""
    return np.where(condition, yes, no)[()]


def wrap(angle: Any) -> Any:
    """The equal angle in (-pi, pi]."""
    rest = angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
    return np.where(rest <= -np.pi, rest + 2.0 * np.pi, rest)[()]


def join(*parts: Any) -> np.ndarray:
    """Numbers and arrays, one after the other."""
    return np.concatenate([np.atleast_1d(np.asarray(part, dtype=float)) for part in parts])


def quaternion(axes: np.ndarray) -> np.ndarray:
    """Axes forward, left and up as unit quaternion w x y z with w >= 0."""
    turned = np.zeros(4)
    mujoco.mju_mat2Quat(turned, np.ascontiguousarray(axes.reshape(3, 3).T).ravel())
    return -turned if turned[0] < 0.0 else turned


# Operators with memory


class Memory:
    """Operators that remember: each call site has a key of its own and is called once at every control step."""

    def __init__(self) -> None:
        #: Control steps since reset.
        self.step = 0
        self.cells: dict[str, Any] = {}

    def _advance(self, key: str, first: Any, following: Callable[[Any], Any]) -> Any:
        self.cells[key] = first if self.step == 0 else following(self.cells[key])
        return self.cells[key]

    def initial(self, key: str, x: Any) -> Any:
        """x at reset."""
        return self._advance(key, x, lambda kept: kept)

    def running_max(self, key: str, x: Any) -> Any:
        """The highest x so far."""
        return self._advance(key, x, lambda kept: np.maximum(kept, x))

    def running_min(self, key: str, x: Any) -> Any:
        """The lowest x so far."""
        return self._advance(key, x, lambda kept: np.minimum(kept, x))

    def accumulate(self, key: str, x: Any) -> Any:
        """The sum of x over the steps after reset."""
        return self._advance(key, 0.0 * x, lambda kept: kept + x)

    def streak(self, key: str, holds: Any) -> Any:
        """For how many steps without interruption it has held."""
        return self._advance(key, 0.0 * holds, lambda kept: np.where(holds, kept + 1.0, 0.0)[()])

    def steps_since(self, key: str, holds: Any) -> Any:
        """How many steps ago it last held; infinite before."""
        return self._advance(key, np.where(holds, 0.0, np.inf)[()], lambda kept: np.where(holds, 0.0, kept + 1.0)[()])

    def hysteresis(self, key: str, x: Any, low: Any, high: Any) -> Any:
        """Becomes 1 above `high`, 0 below `low`, else stays."""
        later = lambda kept: np.where(x > high, 1.0, np.where(x < low, 0.0, kept))[()]
        return self._advance(key, np.where(x >= high, 1.0, 0.0)[()], later)

    def smooth(self, key: str, x: Any, share: Any) -> Any:
        """Moves by a share of its way towards x."""
        return self._advance(key, x, lambda kept: kept + share * (x - kept))

    def smooth_angle(self, key: str, x: Any, share: Any) -> Any:
        """The same of an angle, which takes the short way."""
        return self._advance(key, wrap(x), lambda kept: wrap(kept + share * wrap(x - kept)))

    def sample_hold(self, key: str, x: Any, holds: Any) -> Any:
        """x at the last step at which `holds` held."""
        return self._advance(key, x, lambda kept: np.where(holds, x, kept)[()])

    def delay(self, key: str, x: Any, steps: int) -> Any:
        """x so many steps ago; before that, x at reset."""
        kept = [x] * steps if self.step == 0 else self.cells[key]
        delayed = x if self.step == 0 else kept.pop(0)
        self.cells[key] = kept if self.step == 0 else [*kept, x]
        return delayed


# Random values


class Stream:
    """The random stream of one name in one episode of a seed: the numbers that `msk` draws itself."""

    def __init__(self, seed: int, episode: int, name: str) -> None:
        key = seed.to_bytes(8, "little") + episode.to_bytes(8, "little") + f"random/{name}".encode()
        digest = hashlib.sha256(key).digest()
        start, number = int.from_bytes(digest[:16], "big"), int.from_bytes(digest[16:], "big")
        mask = (1 << 128) - 1
        increment = (number << 1 | 1) & mask
        state = ((start + increment) * 0x2360ED051FC65DA44385DF649FCCF645 + increment) & mask
        self._bits = np.random.PCG64()
        self._bits.state = {
            "bit_generator": "PCG64",
            "state": {"state": state, "inc": increment},
            "has_uint32": 0,
            "uinteger": 0,
        }

    def uniform(self) -> np.float64:
        """Uniform on [0, 1)."""
        return float(self._bits.random_raw() >> 11) / (1 << 53)

    def normal(self) -> np.float64:
        """Standard normal, after Box and Muller."""
        radius = np.sqrt(-2.0 * np.log(1.0 - self.uniform()))
        return float(radius * np.cos(2.0 * np.pi * self.uniform()))


# Motions


class Motion:
    """A motion: the rows of its table as a file of numbers, between them cubics through values and slopes."""

    def __init__(self, table: dict[str, Any]) -> None:
        self.times = np.array(table["times"])
        self.duration, self.cycle = table["duration"], table["cycle"]
        #: By column: values and slopes at the rows, and how far it goes on in a turn of a cycle.
        self.columns = {
            name: (np.array(column["values"]), np.array(column["slopes"]), column["advance"])
            for name, column in table["columns"].items()
        }

    def _moment(self, time: float) -> tuple[int, float, float, bool]:
        turns = np.floor(time / self.duration) if self.cycle else 0.0
        within = time - turns * self.duration
        still = not self.cycle and not 0.0 <= time <= self.duration
        within = min(max(within, 0.0), self.duration)
        row = min(max(int(np.searchsorted(self.times, within, side="right")) - 1, 0), len(self.times) - 2)
        return row, within - self.times[row], turns, still

    def values(self, time: float, *columns: str) -> np.ndarray:
        """Columns at a time, rad or m."""
        row, after, turns, _ = self._moment(float(time))
        return np.array([self._cubic(name, row, after)[0] + turns * self.columns[name][2] for name in columns])

    def rates(self, time: float, *columns: str) -> np.ndarray:
        """Their rates, rad/s or m/s."""
        row, after, _, still = self._moment(float(time))
        return np.array([0.0 if still else self._cubic(name, row, after)[1] for name in columns])

    def _cubic(self, name: str, row: int, after: float) -> tuple[float, float]:
        values, slopes, _ = self.columns[name]
        length = self.times[row + 1] - self.times[row]
        a, b, rise = values[row], slopes[row], (values[row + 1] - values[row]) / length
        c = (3.0 * rise - 2.0 * b - slopes[row + 1]) / length
        d = (b + slopes[row + 1] - 2.0 * rise) / length**2
        return a + after * (b + after * (c + after * d)), b + after * (2.0 * c + 3.0 * after * d)


# The task


def once(value: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """A value that is computed once per control step, however many read it."""

    @functools.wraps(value)
    def kept(self: Task) -> Any:
        if value.__name__ not in self._known:
            self._known[value.__name__] = value(self)
        return self._known[value.__name__]

    kept.once = True
    return kept


def _marked(role: str, *, cached: bool = True) -> Callable[..., Any]:
    """A decorator that says what a method of a task is for."""

    def of(name: str, **settings: Any) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        def mark(method: Callable[..., Any]) -> Callable[..., Any]:
            marked = once(method) if cached else method
            marked.role, marked.label, marked.settings = role, name, settings
            return marked

        return mark

    return of


term, metric, channel = _marked("term"), _marked("metric"), _marked("channel")
termination, finish, release = _marked("termination"), _marked("finish"), _marked("release")
update, redraw, draw = _marked("update"), _marked("redraw"), _marked("draw", cached=False)


def success(method: Callable[..., Any]) -> Callable[..., Any]:
    """Marks the condition by which an episode counts as solved."""
    return _marked("success")("success")(method)


def state(name: str) -> Callable[[Callable[[Any], Any]], Callable[[Any], Any]]:
    """A declared state before the update of this step; the method gives its value at reset."""

    def mark(first: Callable[[Any], Any]) -> Callable[[Any], Any]:
        @functools.wraps(first)
        def before(self: Task) -> Any:
            if self.memory.step == 0 and name not in self.states:
                self.states[name] = first(self)
            return self.states[name]

        marked = once(before)
        marked.role, marked.label, marked.settings = "state", name, {}
        return marked

    return mark


@dataclass(frozen=True)
class Step:
    """What a task says of one control step."""

    #: What a policy sees, SI units, and what only a critic sees beside it.
    observation: np.ndarray
    critic: np.ndarray
    #: Values of the terms, without weights.
    terms: dict[str, float]
    #: Sum of weight times value.
    reward: float
    metrics: dict[str, Any]
    #: Names of the conditions that hold: failures, ends that are none, connections of the scene that let go.
    terminations: tuple[str, ...]
    finishes: tuple[str, ...]
    released: tuple[str, ...]
    #: Whether the horizon is reached and nothing else ends the episode.
    truncated: bool
    success: bool


class Task:
    """A task over MuJoCo's model and data. The caller places the body, steps the physics and calls `mujoco.mj_forward`."""

    file: Path
    control_frequency: float
    horizon: int
    actions: int
    rest: float
    anatomy: Anatomy
    #: Values of parameters that may be set for every episode, SI units.
    parameters: Mapping[str, float] = {}
    _roles: dict[str, list[Callable[..., Any]]]
    _values: list[Callable[..., Any]]

    def __init_subclass__(cls) -> None:
        methods = list(vars(cls).values())
        cls._roles = {}
        for method in methods:
            if hasattr(method, "role"):
                cls._roles.setdefault(method.role, []).append(method)
        cls._values = [method for method in methods if hasattr(method, "once") and not hasattr(method, "role")]

    def __init__(self, model: mujoco.MjModel | None = None) -> None:
        #: The body in its scene.
        self.model = model or mujoco.MjModel.from_xml_path(str(self.file.with_suffix(".xml")))
        #: Signals of the present step.
        self.now = Signals(self.model, self.anatomy)
        #: Weights of the terms; they may be changed.
        self.weights = {method.label: method.settings["weight"] for method in self._of("term")}
        tables = self.file.with_suffix(".json")
        loaded = json.loads(tables.read_text()) if tables.exists() else {}
        self.motions = {name: Motion(table) for name, table in loaded.items()}
        self.parameters = dict(self.parameters)
        self._begin(0, 0)

    def _of(self, role: str) -> list[Callable[..., Any]]:
        return self._roles.get(role, [])

    def _begin(self, seed: int, episode: int) -> None:
        self.memory = Memory()
        self.states: dict[str, Any] = {}
        self.randoms: dict[str, Any] = {}
        self._known: dict[str, Any] = {}
        self._streams = {method.label: Stream(seed, episode, method.label) for method in self._of("draw")}

    def reset(self, data: mujoco.MjData, seed: int = 0, episode: int = 0) -> Step:
        """The first snapshot of an episode: randoms are drawn, operators start."""
        self._begin(seed, episode)
        self.now.update(data, np.full(self.actions, self.rest), 0.0, 0.0)
        return self._report()

    def step(self, data: mujoco.MjData, action: np.ndarray) -> Step:
        """The snapshot after a control step; `action` has the entries of the task's action space."""
        self.memory.step += 1
        self._known.clear()
        period = 1.0 / self.control_frequency
        self.now.update(data, np.clip(action, -1.0, 1.0), self.memory.step * period, period)
        return self._report()

    def random(self, name: str) -> Any:
        """A random before the redraw of this step."""
        if name in self.parameters:
            return np.float64(self.parameters[name])
        if name not in self.randoms:
            self._draw(name)
        return self.randoms[name]

    def _draw(self, name: str) -> None:
        [method] = [method for method in self._of("draw") if method.label == name]
        stream, settings = self._streams[name], method.settings
        for _ in range(64):
            uniform = [stream.uniform() for _ in range(settings.get("uniform", 0))]
            candidate, taken = method(
                self, np.array(uniform + [stream.normal() for _ in range(settings.get("normal", 0))])
            )
            if taken:
                self.randoms[name] = candidate
                return
        raise RuntimeError(f"none of 64 draws of `{name}` at step {self.memory.step} satisfies its condition")

    def _report(self) -> Step:
        with np.errstate(all="ignore"):
            return self._evaluate()

    def _evaluate(self) -> Step:
        for name in self._streams:
            self.random(name)
        before = ("state", "term", "termination", "finish", "release", "success", "metric", "update", "redraw")
        values = {role: [(method.label, method(self)) for method in self._of(role)] for role in before}
        # States change together, and randoms are drawn anew, after everything but the observation was computed.
        if self.memory.step > 0:
            self.states.update(values["update"])
            for name, wanted in values["redraw"]:
                if wanted:
                    self._draw(name)
        channels = [(method.settings.get("critic", False), method(self)) for method in self._of("channel")]
        # What nobody read in this step advances all the same.
        for method in self._values:
            method(self)
        terms = {name: float(value) for name, value in values["term"]}
        held = {
            role: tuple(name for name, holds in values[role] if holds) for role in ("termination", "finish", "release")
        }
        complete = self.memory.step >= self.horizon
        return Step(
            observation=join(*(value for critic, value in channels if not critic), []),
            critic=join(*(value for critic, value in channels if critic), []),
            terms=terms,
            reward=sum(self.weights[name] * value for name, value in terms.items()),
            metrics=dict(values["metric"]),
            terminations=held["termination"],
            finishes=held["finish"],
            released=held["release"],
            truncated=complete and not held["termination"] and not held["finish"],
            success=any(bool(value) for _, value in values["success"]),
        )
