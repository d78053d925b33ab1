"""Makes the reference motions of this folder: `python motions/generate.py [NAME ...]`, with mujoco, numpy and scipy installed.

1. A motion begins as joint curves of the right leg: angles at instants of the cycle, as published (each motion names its sources).
2. The left leg does the same half a cycle later, or at the same time; trunk, pelvis and arms follow published excursions.
3. Curves of other people's bodies do not keep our body's feet on the ground. A least-squares fit changes them as little as possible,
   measured by the scatter between people, until what stands on the ground stays where it is and nothing else reaches into it.
   The path of the root comes out of the same fit: it is what the standing feet make of the angles.

The fit is Gauss-Newton over the values at every row, with third differences as the measure of smoothness. Couplings are solved in
every frame. `msk motion check` measures the result with our own kinematics.

`published.py` holds the curves and what they weigh, `kinematics.py` the body.
"""

import math
import pathlib
import sys

import numpy as np
from kinematics import Body
from published import ALL, through

HERE = pathlib.Path(__file__).resolve().parent
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
                    hold = 0.007 if group == "toes" else 0.004
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


if __name__ == "__main__":
    body = Body()
    for spec in ALL:
        if len(sys.argv) == 1 or spec["name"] in sys.argv[1:]:
            fit = Fit(body, spec)
            unknowns = fit.solve()
            fit.report(unknowns)
            write(fit, unknowns)
