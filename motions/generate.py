"""Makes the reference motions of this folder: `python motions/generate.py [NAME ...]`, with mujoco, numpy and scipy installed.

1. A motion begins as joint curves of the right leg: angles at instants of the cycle, as published (each motion names its sources).
2. The left leg does the same half a cycle later, or at the same time; trunk, pelvis and arms follow published excursions.
3. Curves of other people's bodies do not keep our body's feet on the ground. A least-squares fit changes them as little as possible,
   measured by the scatter between people, until what stands on the ground stays where it is and nothing else reaches into it.
   The path of the root comes out of the same fit: it is what the standing feet make of the angles.

The fit is Gauss-Newton over the values at every row, with third differences as the measure of smoothness. Couplings are solved in
every frame. `msk motion check` measures the result with our own kinematics.
"""

import math
import pathlib
import sys

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline, PchipInterpolator

HERE = pathlib.Path(__file__).resolve().parent
MODEL = HERE.parent / "bodies" / "models" / "human416.xml"
LEG = ["hip_flexion", "hip_adduction", "hip_rotation", "knee_angle", "ankle_angle", "subtalar_angle", "mtp_angle"]
ROOT = ["x", "y", "height", "heading", "pitch", "roll"]
# Names of joints in tasks and in the model.
ALIAS = {
    "lumbar_extension": "flex_extension", "lumbar_bending": "lat_bending", "lumbar_rotation": "axial_rotation",
    "shoulder_plane": "elv_angle", "shoulder_elevation": "shoulder_elv", "elbow_flexion": "elbow_flex",
}  # fmt: skip
# Which way the parts of the root change when left and right are exchanged.
MIRRORED = {"x": 1, "y": -1, "height": 1, "heading": -1, "pitch": 1, "roll": -1}
# Scatter between healthy people, degrees: how dear it is to leave a published curve.
SCATTER = {"hip_flexion": 6, "hip_adduction": 4, "hip_rotation": 4, "knee_angle": 6, "ankle_angle": 5, "subtalar_angle": 5, "mtp_angle": 6}


class Body:
    """Kinematics of our body: poses in, ends of the feet's capsules out."""

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_path(str(MODEL))
        self.data = mujoco.MjData(self.model)
        m = self.model
        self.address = {m.joint(i).name: m.jnt_qposadr[i] for i in range(m.njnt)}
        self.range = {m.joint(i).name: m.jnt_range[i] for i in range(m.njnt)}
        self.couplings = []
        for e in range(m.neq):
            if m.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT:
                follower, leader = m.eq_obj1id[e], m.eq_obj2id[e]
                lead = m.jnt_qposadr[leader] if leader >= 0 else -1
                self.couplings.append((m.jnt_qposadr[follower], lead, m.eq_data[e, :5].copy()))
        # Two rounds solve followers of followers.
        self.couplings *= 2
        self.probes = {}
        for side in "rl":
            heel, ball, toes = [], [], []
            for name, rear, front in [("foot_col1", heel, ball), ("foot_col3", heel, ball), ("bofoot_col1", toes, toes), ("bofoot_col2", toes, toes)]:
                g = m.geom(f"{side}_{name}").id
                axis = np.zeros(9)
                mujoco.mju_quat2Mat(axis, m.geom_quat[g])
                arm = axis.reshape(3, 3)[:, 2] * m.geom_size[g, 1]
                ends = sorted([m.geom_pos[g] - arm, m.geom_pos[g] + arm], key=lambda end: end[0])
                for group, end in zip((rear, front), ends):
                    group.append((m.geom_bodyid[g], end, m.geom_size[g, 0]))
            self.probes[side] = {"heel": heel, "ball": ball, "toes": toes}
        self.axes = np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]], float)  # forward, left, up of the root as columns
        self.upright = {"shoulder_elv_l": math.radians(8), "shoulder_elv_r": math.radians(8)}

    def pose(self, joints, root):
        """joints: model names to rad; root: x, y, height, heading, pitch, roll."""
        q = self.data.qpos
        q[:] = self.model.qpos0
        for name, value in {**self.upright, **joints}.items():
            q[self.address[name]] = value
        for follower, leader, c in self.couplings:
            d = q[leader] - self.model.qpos0[leader] if leader >= 0 else 0.0
            q[follower] = self.model.qpos0[follower] + c[0] + d * (c[1] + d * (c[2] + d * (c[3] + d * c[4])))
        x, y, height, heading, pitch, roll = root
        cy, sy, cp, sp, cr, sr = math.cos(heading), math.sin(heading), math.cos(pitch), math.sin(pitch), math.cos(roll), math.sin(roll)
        turn = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        turn = turn @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]]) @ self.axes.T
        quat = np.zeros(4)
        mujoco.mju_mat2Quat(quat, turn.flatten())
        q[0:3], q[3:7] = [x, y, height], quat
        mujoco.mj_kinematics(self.model, self.data)

    def points(self):
        """Lowest points of the capsules' ends: (feet, heel 2 + ball 2 + toes 4, xyz)."""
        d, out = self.data, []
        for side in "rl":
            for group in ("heel", "ball", "toes"):
                for body, end, radius in self.probes[side][group]:
                    place = d.xpos[body] + d.xmat[body].reshape(3, 3) @ end
                    out.append([place[0], place[1], place[2] - radius])
        return np.array(out)

    def com(self):
        mujoco.mj_comPos(self.model, self.data)
        return self.data.subtree_com[1].copy()


def through(points, cycle):
    """A curve through (per cent, value): monotone between the points, so that peaks are where they were published."""
    x, y = np.array(points, float).T
    if cycle:
        x, y = np.concatenate([x - 100, x, x + 100]), np.tile(y, 3)
    return lambda phase: PchipInterpolator(x, y)(100 * np.asarray(phase))


def ramp(phase, begin, end, edge=0.02):
    """1 between begin and end of the cycle (begin may be negative), 0 elsewhere, with soft edges."""
    total = 0.0
    for turn in (-1, 0, 1):
        p = np.asarray(phase) + turn
        rise, fall = np.clip((p - begin) / edge, 0, 1), np.clip((end - p) / edge, 0, 1)
        total = np.maximum(total, np.minimum(rise, fall))
    return total


class Fit:
    """Least squares over the rows of one motion."""

    def __init__(self, body, spec):
        self.body, self.spec = body, spec
        self.n = spec["rows"]
        self.alternating = spec["sides"] == "alternating"
        self.cycle = spec["cycle"]
        rows = self.n if self.cycle else self.n + 1
        self.phase = np.arange(rows) / self.n
        self.rows = rows
        self.half = self.n // 2
        # Rows at which the feet are looked at: half a cycle holds everything where the sides alternate.
        self.seen = np.arange(self.half if self.alternating else rows)
        curve = lambda points: through(points, self.cycle)(self.phase)
        self.wanted = {joint: np.radians(curve(spec["leg"].get(joint, [(0, 0)] if self.cycle else [(0, 0), (100, 0)]))) for joint in LEG}
        self.root_wanted = {}
        for part in ROOT:
            points = spec["root"].get(part, [(0, 0)] if self.cycle else [(0, 0), (100, 0)])
            values = curve(points)
            self.root_wanted[part] = np.radians(values) if part in ("heading", "pitch", "roll") else values
        self.layout()
        self.upper = spec["upper"](self.phase)

    def layout(self):
        """Where each unknown stands: leg joints at every row, the root at every row of half a cycle, places of the feet."""
        self.place, count = {}, 0
        for joint in LEG:
            self.place[joint] = count
            count += self.rows
        for part in ROOT:
            free = self.half if self.alternating else self.rows
            if not self.alternating and part in ("y", "heading", "roll"):
                free = 0
            self.place[part] = count
            count += free
        self.place["anchor"] = count
        count += 2 * 8
        self.place["stride"] = count
        count += 1
        self.count = count

    def start(self):
        v = np.zeros(self.count)
        for joint in LEG:
            v[self.place[joint] : self.place[joint] + self.rows] = self.wanted[joint]
        for part in ROOT:
            free = self.half if self.alternating else (0 if part in ("y", "heading", "roll") else self.rows)
            v[self.place[part] : self.place[part] + free] = self.root_wanted[part][:free]
        v[self.place["stride"]] = self.spec.get("stride", 0.0)
        return v

    def names(self, k):
        """Unknowns that row k reads: (what, index, sign)."""
        out = []
        for joint in LEG:
            out.append((joint + "_r", self.place[joint] + k, 1))
            other = (k + self.half) % self.n if self.alternating else k
            out.append((joint + "_l", self.place[joint] + other, 1))
        for part in ROOT:
            if self.alternating:
                out.append((part, self.place[part] + k % self.half, MIRRORED[part] if k >= self.half else 1))
            elif part not in ("y", "heading", "roll"):
                out.append((part, self.place[part] + k, 1))
        return out

    def frame(self, v, k):
        """Joints (model names) and root of row k."""
        joints, root = dict(self.upper_at(k)), dict.fromkeys(ROOT, 0.0)
        for name, index, sign in self.names(k):
            if name in root:
                root[name] = sign * v[index]
            else:
                joints[name] = v[index]
        stride, rise = v[self.place["stride"]], self.spec.get("rise", 0.0)
        root["x"] += stride * self.phase[k]
        root["height"] += rise * self.phase[k]
        return joints, [root[part] for part in ROOT]

    def upper_at(self, k):
        return {name: values[k] for name, values in self.upper.items()}

    def look(self, v, k):
        self.body.pose(*self.frame(v, k))
        points = self.body.points()
        com = self.body.com()[0] if "balance" in self.spec else 0.0
        return points, com

    def feet(self, v, k, points, com):
        """Residuals of row k: what stands stays, what swings is clear."""
        spec, out = self.spec, []
        stride, rise = v[self.place["stride"]], self.spec.get("rise", 0.0)
        anchors = v[self.place["anchor"] :][:16].reshape(8, 2)
        for foot in range(2):
            # The left foot stands half a stride ahead, mirrored.
            late = 0.5 if (self.alternating and foot == 1) else 0.0
            own = (self.phase[k] + late) % 1.0 if self.cycle else self.phase[k]
            # How many whole strides its present stance is ahead of the first.
            for group, (first, last) in {"heel": (0, 2), "ball": (2, 4), "toes": (4, 8)}.items():
                begin, end = spec["stance"][group]
                standing = ramp(own, begin, end) if self.cycle else 1.0
                turn = 0.0
                if self.cycle and self.alternating:
                    turn = self.phase[k] - own
                    # A stance that reaches over the end of the cycle belongs to the turn before.
                    turn += 1.0 if own > end and own > 1.0 + begin - 0.02 else 0.0
                    turn = round(turn * 2) / 2
                for probe in range(first, last):
                    x, y, z = points[8 * foot + probe]
                    ax, ay = anchors[probe]
                    ay = ay if foot == 0 else -ay
                    # Toes bend about a slanted axis: held as fast as the rest they would twist the whole leg.
                    hold = self.spec.get("toe_hold", 0.007) if group == "toes" else 0.004
                    out += [standing * (x - ax - stride * turn) / hold, standing * (y - ay) / (1.5 * hold)]
                    level = 2 * rise * 0.5 * turn if self.alternating else 0.0
                    out.append(standing * (z - level) / (0.010 if group == "toes" else 0.002))
                    floor, clear = self.floor(own, x - ax - stride * turn, stride, rise, standing)
                    # Nothing reaches into the ground. Pushed up softly, so that the fit does not jump between touching and not.
                    soft = 0.001 + 0.002 * (1 - standing)
                    above = (z - level - floor - clear - soft * (1 - standing)) / soft
                    out.append(soft * np.logaddexp(0.0, -above) / 0.0015)
        if "balance" in spec:
            weight = spec["balance"](self.phase[k])
            middle = 0.5 * (anchors[0, 0] + anchors[2, 0])
            out.append(weight * (com - middle) / 0.02)
        return out

    def floor(self, own, ahead, stride, rise, standing):
        """What a swinging foot must stay above, relative to its last stance: the ground, or the line over the edges of the steps."""
        lift = self.spec.get("lift", 0.0) * max(0.0, math.sin(math.pi * np.clip((own - self.spec["toe_off"]) / (1 - self.spec["toe_off"]), 0, 1))) if self.cycle and self.alternating else 0.0
        if rise == 0.0:
            return 0.0, lift * (1 - standing)
        swing = np.clip((own - self.spec["toe_off"]) / (1 - self.spec["toe_off"]), 0, 1)
        line = np.clip(rise * (ahead + 0.10) / stride, 0, rise) if 0.05 < swing < 0.95 else (0.0 if swing < 0.5 else rise)
        return line, lift * (1 - standing)

    def smooth(self):
        """Third differences of every unknown over the rows, as rows of a matrix."""
        blocks = []
        for name in LEG + ROOT:
            free = self.rows if name in LEG else (self.half if self.alternating else (0 if name in ("y", "heading", "roll") else self.rows))
            scale = (0.02 if name in ("x", "y", "height") else math.radians(12)) * self.spec.get("softness", 0.4)
            weight = 1 / scale * (self.n / 50) ** 2.5
            sign = MIRRORED.get(name, 1) if (self.alternating and name in ROOT) else 1
            for k in range(free):
                row = np.zeros(self.count)
                for offset, c in ((-1, -1), (0, 3), (1, -3), (2, 1)):
                    index, s = k + offset, 1
                    if name in LEG and self.cycle:
                        index %= self.rows
                    elif self.cycle:
                        s = sign if (index // free) % 2 else 1
                        index %= free
                    elif not 0 <= index < free:
                        # A motion that is no cycle rests before and after.
                        index = min(max(index, 0), free - 1)
                    row[self.place[name] + index] += weight * c * s
                blocks.append(row)
        return np.array(blocks)

    def priors(self, v):
        rows, right = [], []
        for joint in LEG:
            sigma = math.radians(self.spec.get("scatter", {}).get(joint, SCATTER[joint]))
            for k in range(self.rows):
                row = np.zeros(self.count)
                row[self.place[joint] + k] = 1 / sigma
                rows.append(row)
                right.append(self.wanted[joint][k] / sigma)
        sigmas = {"x": 0.03, "y": 0.02, "height": 0.03, "heading": math.radians(2), "pitch": math.radians(2), "roll": math.radians(1.5)}
        sigmas.update(self.spec.get("root_scatter", {}))
        for part in ROOT:
            free = self.half if self.alternating else (0 if part in ("y", "heading", "roll") else self.rows)
            for k in range(free):
                row = np.zeros(self.count)
                row[self.place[part] + k] = 1 / sigmas[part]
                rows.append(row)
                right.append(self.root_wanted[part][k] / sigmas[part])
        row = np.zeros(self.count)
        row[self.place["stride"]] = 1 / self.spec.get("stride_scatter", 0.05)
        rows.append(row)
        right.append(self.spec.get("stride", 0.0) / self.spec.get("stride_scatter", 0.05))
        if not self.alternating:
            for k in self.spec.get("fixed", []):
                for joint in LEG:
                    row = np.zeros(self.count)
                    row[self.place[joint] + k] = 1 / math.radians(0.2)
                    rows.append(row)
                    right.append(self.wanted[joint][k] / math.radians(0.2))
        return np.array(rows), np.array(right)

    def limits(self, v):
        """Joints stay within their ranges."""
        rows, right = [], []
        for joint in LEG:
            low, high = self.body.range[joint + "_r"] + np.radians([0.3, -0.3])
            for k in range(self.rows):
                index = self.place[joint] + k
                beyond = max(low - v[index], 0) or min(high - v[index], 0)
                if beyond:
                    row = np.zeros(self.count)
                    row[index] = 1 / math.radians(0.05)
                    rows.append(row)
                    right.append((v[index] + beyond) / math.radians(0.05))
        return (np.array(rows).reshape(-1, self.count), np.array(right))

    def anchored(self, v):
        """Begins with each foot's place as it stands in the middle of its stance."""
        for group, (first, last) in {"heel": (0, 2), "ball": (2, 4), "toes": (4, 8)}.items():
            begin, end = self.spec["stance"][group]
            middle = (0.5 * (begin + end)) % 1.0 if self.cycle else 0.0
            k = int(round(middle * self.n)) % self.rows
            joints, root = self.frame(v, k)
            if k >= self.half and self.alternating:
                joints, root = self.whole_frame(v, k)
            self.body.pose(joints, root)
            v[self.place["anchor"] + 2 * first : self.place["anchor"] + 2 * last] = self.body.points()[first:last, :2].flatten()
        return v

    def whole_frame(self, v, k):
        joints, root = self.frame(v, k)
        return joints, root

    def solve(self, steps=10):
        v = self.anchored(self.start())
        smooth = self.smooth()
        for step in range(steps):
            prior, prior_right = self.priors(v)
            limit, limit_right = self.limits(v)
            jacobian, residual = [], []
            for k in self.seen:
                points, com = self.look(v, k)
                base = np.array(self.feet(v, k, points, com))
                local = np.zeros((len(base), self.count))
                for name, index, sign in self.names(k):
                    w = v.copy()
                    w[index] += 1e-5
                    local[:, index] = (np.array(self.feet(w, k, *self.look(w, k))) - base) / 1e-5
                for index in list(range(self.place["anchor"], self.place["anchor"] + 16)) + [self.place["stride"]]:
                    w = v.copy()
                    w[index] += 1e-5
                    moved = (points, com) if index != self.place["stride"] else self.look(w, k)
                    local[:, index] = (np.array(self.feet(w, k, *moved)) - base) / 1e-5
                jacobian.append(local)
                residual.append(base)
            feet, feet_residual = np.vstack(jacobian), np.concatenate(residual)
            a = np.vstack([feet, prior, smooth, limit, 1e-3 * np.eye(self.count)])
            b = np.concatenate([-feet_residual, prior_right - prior @ v, -smooth @ v, limit_right - limit @ v, np.zeros(self.count)])
            delta = np.linalg.solve(a.T @ a, a.T @ b)
            cost, size = self.cost(v, prior, prior_right, smooth), 1.0
            while size > 0.02 and self.cost(v + size * delta, prior, prior_right, smooth) > cost:
                size *= 0.5
            v = v + size * delta
            if "-v" in sys.argv:
                print(f"  step {step}: cost {cost:.1f}, worst {np.abs(feet_residual).max():.2f}, length {size:.2f}")
            if size <= 0.02 or np.abs(delta).max() < 1e-4:
                break
        return v

    def cost(self, v, prior, prior_right, smooth):
        """The sum of squares that the fit makes small."""
        feet = [self.feet(v, k, *self.look(v, k)) for k in self.seen]
        limit, limit_right = self.limits(v)
        parts = [np.concatenate(feet), prior @ v - prior_right, smooth @ v, limit @ v - limit_right]
        return sum(float(part @ part) for part in parts)

    def table(self, v):
        """Columns in degrees and metres, one row more than the cycle has."""
        rows = self.n + 1
        columns = {}
        for side in "lr":
            for joint in LEG:
                values = []
                for k in range(rows):
                    index = k % self.n if self.cycle else k
                    if side == "l" and self.alternating:
                        index = (index + self.half) % self.n
                    values.append(math.degrees(v[self.place[joint] + index]))
                columns[f"{joint}_{side} [deg]"] = values
        names = {model: name for name, model in ALIAS.items()}
        for model, values in self.upper.items():
            plain, side = (model[:-2], model[-2:]) if model.endswith(("_l", "_r")) else (model, "")
            shown = names.get(plain, plain) + side
            columns[f"{shown} [deg]"] = [math.degrees(values[k % self.n if self.cycle else k]) for k in range(rows)]
        stride, rise = v[self.place["stride"]], self.spec.get("rise", 0.0)
        origin = None
        for part in ROOT:
            values = []
            for k in range(rows):
                index = k % self.n if self.cycle else k
                _, root = self.frame(v, index)
                value = root[ROOT.index(part)]
                if self.cycle and k == self.n:
                    value += stride * (part == "x") + rise * (part == "height")
                values.append(math.degrees(value) if part in ("heading", "pitch", "roll") else value)
            if part == "x":
                origin = values[0]
                values = [value - origin for value in values]
            columns[f"root.{part} [{'deg' if part in ('heading', 'pitch', 'roll') else 'm'}]"] = values
        return columns

    def report(self, v):
        worst, floor = 0.0, 0.0
        for k in self.seen:
            points, com = self.look(v, k)
            floor = min(floor, points[:, 2].min())
        away = {joint: math.degrees(np.sqrt(np.mean((v[self.place[joint] :][: self.rows] - self.wanted[joint]) ** 2))) for joint in LEG}
        if "-v" in sys.argv:
            for k in self.seen:
                points, com = self.look(v, k)
                print(k, " ".join(f"{z * 1000:5.0f}" for z in points[:, 2]), "|", " ".join(f"{x * 1000:5.0f}" for x in points[[0, 2, 4, 8, 10, 12], 0] - v[self.place["anchor"]]))
        print(f"{self.spec['name']}: stride {v[self.place['stride']]:.3f} m, speed {v[self.place['stride']] / self.spec['duration']:.2f} m/s; rms from the published curves, deg: " + ", ".join(f"{joint} {value:.1f}" for joint, value in away.items()))


def write(fit, v):
    spec = fit.spec
    columns = fit.table(v)
    lines = [f"# name: {spec['name']}"] + [f"# source: {source}" for source in spec["sources"]]
    lines += ["# source: fitted to our body by motions/generate.py so that standing feet stay in place", f"# cycle: {'yes' if fit.cycle else 'no'}", f"# duration: {spec['duration']} s"]
    if spec.get("advances"):
        lines.append("# advances: " + ", ".join(spec["advances"]))
    lines.append("phase, " + ", ".join(columns))
    for k in range(fit.n + 1):
        phase = f"{k / fit.n:.6g}"
        cells = [f"{values[k]:.4f}" if "[m]" in name else f"{values[k]:.2f}" for name, values in columns.items()]
        lines.append(", ".join([phase] + ["0" if float(cell) == 0 else cell for cell in cells]))
    (HERE / f"{spec['name']}.csv").write_text("\n".join(lines) + "\n")


def arms(swing, middle, elbow, elbow_swing, spread=8.0):
    """Arms that swing against the legs: flexion middle +- swing, elbow bent by elbow +- elbow_swing; degrees."""

    def at(phase):
        out = {}
        for side, shift in (("r", 0.0), ("l", 0.5)):
            turn = 2 * math.pi * (phase + shift)
            flexion, aside = np.radians(middle - swing * np.cos(turn)), math.radians(spread)
            # Plane and elevation of an upper arm that is flexed and spread.
            out[f"elv_angle_{side}"] = np.arctan2(np.tan(flexion), math.tan(aside))
            out[f"shoulder_elv_{side}"] = np.arccos(np.cos(flexion) * math.cos(aside))
            out[f"elbow_flex_{side}"] = np.radians(elbow - elbow_swing * np.cos(turn))
        return out

    return at


def trunk(lean, rotation, bending):
    """The trunk against the pelvis: leant back by `lean`, turned and bent by cosines of the cycle; degrees."""

    def at(phase):
        turn = 2 * math.pi * phase
        return {
            "flex_extension": np.radians(lean + 0 * turn),
            "axial_rotation": np.radians(rotation * np.cos(turn)),
            "lat_bending": np.radians(bending * np.sin(turn)),
        }

    return at


def together(*parts):
    return lambda phase: {name: values for part in parts for name, values in part(phase).items()}


def both(curves):
    """Curves of the upper body that are the same on both sides: model name (sides as {s}) to points, degrees."""

    def at(phase, cycle):
        out = {}
        for name, points in curves.items():
            for side in ("l", "r") if "{s}" in name else ("",):
                out[name.replace("{s}", side)] = np.radians(through(points, cycle)(phase))
        return out

    return at


# Right leg, per cent of the cycle from the right foot's contact. Flexion, dorsiflexion and adduction positive.
WALK = {
    "name": "walk", "rows": 50, "cycle": True, "sides": "alternating", "duration": 1.1, "advances": ["root.x"],
    "sources": [
        "joint curves of adults at their own speed: D. A. Winter, Biomechanics and Motor Control of Human Movement, 4th ed., 2009, appendix A",
        "instants and peaks: J. Perry, J. M. Burnfield, Gait Analysis: Normal and Pathological Function, 2nd ed., 2010",
    ],
    # The body's legs are shorter than those of the published walkers: at 1.36 m a stretched knee would have to push instead of the ankle.
    "stride": 1.32, "stride_scatter": 0.01, "stance": {"heel": (-0.01, 0.31), "ball": (0.08, 0.40), "toes": (0.12, 0.57)}, "toe_off": 0.59, "lift": 0.02,
    "scatter": {"ankle_angle": 3, "knee_angle": 5}, "toe_hold": 0.004,
    "leg": {
        # Thigh against the vertical, as Perry has it, and the pelvis tilted forward: some three degrees behind Winter's in late stance.
        "hip_flexion": [(0, 25), (10, 21), (20, 11), (30, 1), (40, -8), (50, -14), (56, -13), (65, 3), (75, 19), (86, 28), (94, 27)],
        "knee_angle": [(0, 6), (8, 15), (14, 19), (22, 15), (32, 8), (40, 6), (48, 10), (56, 25), (62, 41), (71, 61), (80, 47), (90, 14), (97, 4)],
        "ankle_angle": [(0, 0), (7, -7), (15, -1), (30, 6), (45, 10), (52, 4), (62, -17), (72, -5), (82, 1), (93, 1)],
        "hip_adduction": [(0, 1), (15, 5), (35, 4), (50, 1), (65, -6), (80, -3), (92, 0)],
        "mtp_angle": [(0, 8), (12, 0), (32, 0), (45, 12), (56, 26), (63, 14), (75, 2), (90, 6)],
    },
    "root": {
        "height": [(0, 0.905), (12.5, 0.92), (30, 0.935), (50, 0.905), (62.5, 0.92), (80, 0.935)],
        "heading": [(0, 4), (50, -4)], "roll": [(0, 0), (15, -4), (40, 0), (50, 0), (65, 4), (90, 0)], "pitch": [(0, 4), (25, 4.5), (50, 4), (75, 4.5)],
        "y": [(0, 0), (30, -0.022), (50, 0), (80, 0.022)],
    },
    "upper": together(trunk(-2, -7, -3), arms(17, -8, 32, 11)),
}  # fmt: skip

RUN = {
    "name": "run", "rows": 50, "cycle": True, "sides": "alternating", "duration": 0.7, "advances": ["root.x"],
    "sources": ["joint curves and instants at 3.2 m/s: T. F. Novacheck, The biomechanics of running, Gait and Posture 7 (1998) 77-95"],
    "stride": 2.24, "stride_scatter": 0.005, "stance": {"heel": (-0.01, 0.16), "ball": (0.03, 0.32), "toes": (0.05, 0.345)}, "toe_off": 0.36, "lift": 0.03,
    "scatter": {"ankle_angle": 3, "mtp_angle": 4},
    "leg": {
        "hip_flexion": [(0, 38), (10, 32), (20, 17), (30, 4), (38, -5), (44, -7), (55, 8), (68, 34), (80, 50), (90, 47)],
        "knee_angle": [(0, 16), (8, 34), (14, 42), (22, 36), (32, 22), (38, 18), (48, 40), (58, 72), (67, 91), (78, 70), (88, 32), (95, 13)],
        "ankle_angle": [(0, 6), (6, 4), (20, 24), (28, 14), (36, -14), (42, -24), (52, -12), (65, 2), (85, 6)],
        "hip_adduction": [(0, 4), (14, 9), (30, 3), (40, -3), (60, -5), (85, 1)],
        "mtp_angle": [(0, 6), (8, 0), (18, 2), (30, 22), (37, 16), (50, 0), (85, 4)],
    },
    "root": {
        "height": [(0, 0.89), (15, 0.845), (37, 0.905), (44, 0.915), (50, 0.89), (65, 0.845), (87, 0.905), (94, 0.915)],
        "heading": [(0, 0), (25, -7), (50, 0), (75, 7)], "roll": [(0, 0), (14, -5), (35, 2), (50, 0), (64, 5), (85, -2)], "pitch": [(0, 12), (25, 13), (50, 12), (75, 13)],
        "y": [(0, 0), (15, -0.012), (50, 0), (65, 0.012)],
    },
    "root_scatter": {"x": 0.02},
    "upper": together(trunk(-5, -14, -4), arms(32, -12, 88, 12, 12)),
}  # fmt: skip

STAIRS = {
    "name": "stairs", "rows": 50, "cycle": True, "sides": "alternating", "duration": 1.4, "advances": ["root.x", "root.height"],
    "sources": [
        "joint curves of climbing: R. Riener, M. Rabuffetti, C. Frigo, Stair ascent and descent at different inclinations, Gait and Posture 15 (2002) 32-44",
        "steps of 15 cm by 50 cm, as the task stairs has them: the stride is longer than in the source, the climb the least of the three there",
    ],
    "stride": 1.0, "stride_scatter": 0.0005, "rise": 0.30, "stance": {"heel": (-0.01, 0.42), "ball": (0.03, 0.60), "toes": (0.06, 0.63)}, "toe_off": 0.64, "lift": 0.08,
    "leg": {
        "hip_flexion": [(0, 58), (12, 52), (25, 36), (40, 18), (55, 7), (63, 8), (75, 40), (86, 62), (94, 62)],
        "knee_angle": [(0, 56), (10, 58), (22, 44), (35, 26), (48, 14), (55, 16), (63, 40), (75, 85), (85, 82), (94, 62)],
        "ankle_angle": [(0, 8), (12, 15), (28, 10), (45, 8), (54, 6), (63, -14), (75, 6), (85, 12), (94, 8)],
        "hip_adduction": [(0, 0), (15, 5), (40, 4), (55, 0), (70, -5), (88, -2)],
        "mtp_angle": [(0, 0), (35, 0), (50, 12), (60, 22), (68, 8), (80, 0)],
    },
    "root": {
        "height": [(0, 0.90), (12, 0.915), (25, 0.935), (38, 0.92), (50, 0.90), (62, 0.915), (75, 0.935), (88, 0.92)],
        "heading": [(0, 3), (50, -3)], "roll": [(0, 0), (15, -3), (35, 0), (50, 0), (65, 3), (85, 0)], "pitch": [(0, 10), (50, 10)],
        "y": [(0, 0), (30, -0.03), (50, 0), (80, 0.03)],
    },
    "scatter": {"hip_flexion": 8, "knee_angle": 8, "ankle_angle": 6}, "root_scatter": {"height": 0.06, "x": 0.06},
    "upper": together(trunk(-6, -5, -3), arms(12, -4, 35, 8)),
}  # fmt: skip

PLANTED = {"heel": (-0.5, 1.5), "ball": (-0.5, 1.5), "toes": (-0.5, 1.5)}

SQUAT = {
    "name": "squat", "rows": 50, "cycle": True, "sides": "together", "duration": 4.0, "advances": [], "stride_scatter": 1e-7,
    "sources": [
        "peaks of hip, knee, ankle and trunk in a squat with thighs near level: R. F. Escamilla, Knee biomechanics of the dynamic squat exercise, Medicine and Science in Sports and Exercise 33 (2001) 127-141",
        "B. J. Schoenfeld, Squatting kinematics and kinetics and their application to exercise performance, Journal of Strength and Conditioning Research 24 (2010) 3497-3506",
    ],
    "stance": PLANTED, "toe_off": 1.0,
    "leg": {
        "hip_flexion": [(0, 3), (12, 22), (30, 75), (50, 100), (70, 75), (88, 22)],
        "knee_angle": [(0, 4), (12, 28), (30, 82), (50, 108), (70, 82), (88, 28)],
        "ankle_angle": [(0, 1), (12, 10), (30, 25), (50, 28), (70, 25), (88, 10)],
        "hip_adduction": [(0, -6), (50, -14)],
    },
    "root": {"height": [(0, 0.94), (50, 0.50)], "pitch": [(0, 0), (12, 6), (30, 20), (50, 24), (70, 20), (88, 6)], "x": [(0, 0), (50, -0.12)]},
    "root_scatter": {"height": 0.2, "x": 0.2, "pitch": math.radians(4)},
    "balance": lambda phase: 1.0,
    "upper": lambda phase: both({
        "flex_extension": [(0, 0), (50, -12)], "elv_angle_{s}": [(0, 60), (25, 82), (50, 86), (75, 82)],
        "shoulder_elv_{s}": [(0, 12), (15, 35), (50, 85), (85, 35)], "elbow_flex_{s}": [(0, 10), (50, 8)],
    })(phase, True),
}  # fmt: skip

SIT = {
    "name": "sit", "rows": 50, "cycle": False, "sides": "together", "duration": 2.0, "advances": [], "stride_scatter": 1e-7,
    "sources": [
        "order and peaks of trunk, hip and knee in sitting down: S. Nuzik, R. Lamb, A. VanSant, S. Hirt, Sit-to-stand movement pattern: a kinematic study, Physical Therapy 66 (1986) 1708-1713, taken backwards",
        "K. M. Kerr, J. A. White, D. A. Barr, R. A. B. Mollan, Analysis of the sit-stand-sit movement cycle in normal subjects, Clinical Biomechanics 12 (1997) 236-245",
    ],
    "stance": PLANTED, "toe_off": 1.0,
    "leg": {
        "hip_flexion": [(0, 3), (10, 6), (30, 42), (55, 88), (75, 100), (92, 91), (100, 90)],
        "knee_angle": [(0, 4), (10, 9), (30, 40), (55, 74), (75, 88), (92, 90), (100, 90)],
        "ankle_angle": [(0, 1), (10, 4), (30, 14), (50, 16), (75, 6), (92, 0), (100, 0)],
        "hip_adduction": [(0, -4), (100, -6)],
    },
    "root": {"height": [(0, 0.94), (10, 0.935), (50, 0.70), (80, 0.55), (100, 0.53)], "pitch": [(0, 0), (10, 4), (35, 24), (60, 32), (80, 20), (94, 2), (100, 0)], "x": [(0, 0), (50, -0.25), (100, -0.42)]},
    "root_scatter": {"height": 0.2, "x": 0.2, "pitch": math.radians(4)},
    "balance": lambda phase: float(np.clip((0.70 - phase) / 0.15, 0, 1)),
    "upper": lambda phase: both({
        "flex_extension": [(0, 0), (10, -2), (45, -16), (70, -14), (92, -1), (100, 0)], "elv_angle_{s}": [(0, 60), (45, 80), (80, 70), (100, 60)],
        "shoulder_elv_{s}": [(0, 10), (10, 12), (45, 40), (75, 30), (95, 13), (100, 12)], "elbow_flex_{s}": [(0, 10), (45, 15), (100, 30)],
    })(phase, False),
}  # fmt: skip

ALL = [WALK, RUN, STAIRS, SQUAT, SIT]

if __name__ == "__main__":
    body = Body()
    for spec in ALL:
        if len(sys.argv) == 1 or spec["name"] in sys.argv[1:]:
            fit = Fit(body, spec)
            unknowns = fit.solve()
            fit.report(unknowns)
            write(fit, unknowns)
