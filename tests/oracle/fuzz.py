"""Random models against an installed MuJoCo, stage by stage, through `msk physics forward`.

    cargo build --release && python tests/oracle/fuzz.py [--cases 1000] [--seed N] [--msk FILE] [--page docs/parity.md] [--keep FOLDER]

Every case is a model that did not exist before: a tree of bodies with joints of all kinds, shapes that touch each other and
the ground, spatial tendons that wrap around spheres and cylinders, fixed tendons, muscles and motors, equalities, limits,
friction loss, either cone, at a random state. Each is compared quantity by quantity; errors are kept by feature, so that the
page shows what each feature has met. A case out of tolerance is printed with its seed, and kept if --keep says where.
Exits with 1 if there was one.

MuJoCo's mid phase is switched off: it lists the contacts of two bodies in the order in which it walks its bounding volumes,
which is not ours and changes nothing but the order of rows.
"""

import argparse
import json
import pathlib
import secrets
import sys
import tempfile

import mujoco
import numpy as np

from live import QUANTITIES, ROOT, ours, theirs
from touching import CLASSES, classify

JOINTS = ["hinge", "slide", "ball"]
SHAPES = ["sphere", "capsule", "box", "ellipsoid", "cylinder"]


class Model:
    """A random model as text, and the features that are in it."""

    def __init__(self, seed):
        self.random = np.random.default_rng(seed)
        self.features = set()
        self.bodies, self.joints, self.sites, self.wraps = [], [], [], []

    def number(self, low, high):
        return float(self.random.uniform(low, high))

    def chance(self, share):
        return self.random.random() < share

    def vector(self, low, high, count=3):
        return " ".join(f"{self.number(low, high):.6g}" for _ in range(count))

    def unit(self, count=3):
        vector = self.random.normal(size=count)
        return " ".join(f"{value:.9g}" for value in vector / np.linalg.norm(vector))

    def pick(self, items):
        return items[int(self.random.integers(len(items)))]

    def joint(self, last):
        # No rotation may follow a ball.
        kind = self.pick(JOINTS if last else JOINTS[:2])
        name = f"j{len(self.joints)}"
        text = f'<joint name="{name}" type="{kind}" pos="{self.vector(-0.05, 0.05)}" axis="{self.unit()}"'
        text += f' damping="{self.number(0, 2):.6g}" armature="{self.number(0.001, 0.1):.6g}"'
        if self.chance(0.3):
            self.features.add("joint springs")
            text += f' stiffness="{self.number(0, 20):.6g}"'
            if kind != "ball":
                text += f' springref="{self.number(-0.5, 0.5):.6g}" ref="{self.number(-0.3, 0.3):.6g}"'
        if self.chance(0.4):
            self.features.add(f"limits of {kind} joints")
            text += ' range="0 0.5"' if kind == "ball" else f' range="{self.number(-0.6, 0):.6g} {self.number(0.1, 0.8):.6g}"'
            text += f' margin="{self.number(0, 0.1):.6g}"' if self.chance(0.3) else ""
        if self.chance(0.3):
            self.features.add("friction loss of joints")
            text += f' frictionloss="{self.number(0.1, 3):.6g}"'
        self.features.add(f"{kind} joints")
        self.joints.append((name, kind))
        return text + "/>"

    def geom(self, shapes):
        kind = self.pick(shapes)
        size = {"sphere": 1, "capsule": 2, "cylinder": 2}.get(kind, 3)
        text = f'<geom type="{kind}" size="{self.vector(0.05, 0.2, size)}" pos="{self.vector(-0.1, 0.1)}" quat="{self.unit(4)}"'
        text += f' density="{self.number(300, 2000):.6g}" condim="{self.pick([1, 3, 3, 4, 6])}"'
        text += f' friction="{self.number(0.2, 1.5):.6g} {self.number(0, 0.02):.6g} {self.number(0, 0.002):.6g}"'
        if self.chance(0.2):
            self.features.add("margins, gaps, priorities")
            text += f' margin="{self.number(0, 0.05):.6g}" gap="{self.number(0, 0.02):.6g}" priority="{self.pick([0, 1])}"'
            text += f' solmix="{self.number(0.1, 3):.6g}" solref="{self.number(0.01, 0.05):.6g} 1"'
        return text + "/>"

    def body(self, depth, shapes):
        index = len(self.bodies)
        self.bodies.append(index)
        text = f'<body name="b{index}" pos="{self.vector(-0.4, 0.4)}" quat="{self.unit(4)}">'
        if depth == 0 and self.chance(0.5):
            self.features.add("free joints")
            text += "<freejoint/>"
        else:
            count = int(self.random.integers(1, 3))
            for number in range(count):
                text += self.joint(number == count - 1)
        text += "".join(self.geom(shapes) for _ in range(int(self.random.integers(1, 3))))
        for _ in range(int(self.random.integers(1, 4))):
            name = f"s{len(self.sites)}"
            self.sites.append((name, index))
            text += f'<site name="{name}" pos="{self.vector(-0.3, 0.3)}"/>'
        if self.chance(0.5):
            name, kind = f"w{len(self.wraps)}", self.pick(["sphere", "cylinder"])
            self.wraps.append(name)
            size = self.vector(0.03, 0.12, 1 if kind == "sphere" else 2)
            text += f'<geom name="{name}" type="{kind}" size="{size}" pos="{self.vector(-0.1, 0.1)}" quat="{self.unit(4)}"'
            text += ' mass="0" contype="0" conaffinity="0"/>'
        if depth < 4:
            for _ in range(int(self.random.integers(0, 3)) if depth else 2):
                if len(self.bodies) < 10:
                    text += self.body(depth + 1, shapes)
        return text + "</body>"

    def tendons(self):
        text, actuators = "", ""
        for index in range(int(self.random.integers(0, 4))):
            if len(self.sites) < 2:
                break
            path = [self.pick(self.sites)[0] for _ in range(int(self.random.integers(2, 5)))]
            parts = f'<site site="{path[0]}"/>'
            for before, site in zip(path, path[1:]):
                if before == site:
                    continue
                if self.wraps and self.chance(0.6):
                    self.features.add("wrapping tendons")
                    side = f' sidesite="{self.pick(self.sites)[0]}"' if self.chance(0.4) else ""
                    parts += f'<geom geom="{self.pick(self.wraps)}"{side}/>'
                parts += f'<site site="{site}"/>'
            if parts.count("<site") < 2:
                continue
            name, extra = f"t{index}", ""
            if self.chance(0.3):
                self.features.add("tendon springs and damping")
                extra += f' stiffness="{self.number(0, 50):.6g}" damping="{self.number(0, 5):.6g}" springlength="{self.number(0.1, 0.3):.6g} {self.number(0.3, 0.6):.6g}"'
            if self.chance(0.3):
                self.features.add("tendon limits")
                extra += f' range="{self.number(0.1, 0.3):.6g} {self.number(0.4, 0.8):.6g}"'
            if self.chance(0.3):
                self.features.add("friction loss of tendons")
                extra += f' frictionloss="{self.number(0.1, 5):.6g}"'
            text += f'<spatial name="{name}"{extra}>{parts}</spatial>'
            self.features.add("spatial tendons")
            if self.chance(0.5):
                self.features.add("muscles")
                actuators += f'<muscle tendon="{name}" lengthrange="0.1 1.2" force="{self.number(50, 500):.6g}" ctrllimited="true" ctrlrange="0 1"/>'
            else:
                actuators += f'<motor tendon="{name}" gear="{self.number(0.5, 3):.6g}"/>'
        scalar = [name for name, kind in self.joints if kind != "ball"]
        if len(scalar) >= 2 and self.chance(0.4):
            self.features.add("fixed tendons")
            a, b = self.random.choice(scalar, 2, replace=False)
            limit = ' range="-0.2 0.3"' if self.chance(0.5) else ""
            text += f'<fixed name="f0" stiffness="{self.number(0, 5):.6g}"{limit}>'
            text += f'<joint joint="{a}" coef="{self.number(-2, 2):.6g}"/><joint joint="{b}" coef="{self.number(-2, 2):.6g}"/></fixed>'
            actuators += '<position tendon="f0" kp="10" kv="1"/>'
        if scalar and self.chance(0.5):
            self.features.add("motors and servos")
            actuators += f'<velocity joint="{self.pick(scalar)}" kv="{self.number(0, 3):.6g}"/>'
            actuators += f'<general joint="{self.pick(scalar)}" dyntype="filter" dynprm="0.05" gainprm="{self.number(1, 5):.6g}" biastype="affine" biasprm="0 -1 -0.1"/>'
        return text, actuators

    def equalities(self):
        text = ""
        scalar = [name for name, kind in self.joints if kind != "ball"]
        if len(scalar) >= 2 and self.chance(0.3):
            self.features.add("joint couplings")
            a, b = self.random.choice(scalar, 2, replace=False)
            text += f'<joint joint1="{a}" joint2="{b}" polycoef="{self.vector(-0.3, 0.3, 5)}"/>'
        if len(self.bodies) >= 2 and self.chance(0.3):
            a, b = self.random.choice(self.bodies, 2, replace=False)
            kind = self.pick(["connect", "weld"])
            self.features.add(f"{kind} equalities")
            anchor = f' anchor="{self.vector(-0.1, 0.1)}"' if kind == "connect" or self.chance(0.5) else ""
            text += f'<{kind} body1="b{a}" body2="b{b}"{anchor} solref="0.03 1"/>'
        return text

    def text(self, shapes):
        world = "".join(self.body(0, shapes) for _ in range(int(self.random.integers(1, 3))))
        if self.chance(0.7):
            self.features.add("ground")
            world = '<geom name="ground" type="plane" size="0 0 1" pos="0 0 -0.3"/>' + world
        tendons, actuators = self.tendons()
        equalities = self.equalities()
        cone = self.pick(["pyramidal", "elliptic"])
        self.features.add(f"{cone} cones")
        return (
            f'<mujoco model="fuzz"><compiler angle="radian" autolimits="true"/>'
            f'<option timestep="0.001" cone="{cone}" impratio="{self.number(1, 5):.6g}" tolerance="1e-14" iterations="300"'
            f' ls_tolerance="1e-6" ls_iterations="100"><flag midphase="disable"/></option>'
            f"<worldbody>{world}</worldbody><tendon>{tendons}</tendon><actuator>{actuators}</actuator>"
            f"<equality>{equalities}</equality></mujoco>"
        )


def state_of(model, data, random):
    """A random state near the model's zero, in which quaternions are unit quaternions."""
    data.qpos[:] = model.qpos0
    for joint in range(model.njnt):
        address, kind = model.jnt_qposadr[joint], model.jnt_type[joint]
        if kind == mujoco.mjtJoint.mjJNT_FREE:
            data.qpos[address : address + 3] += random.uniform(-0.3, 0.3, 3)
            address += 3
        if kind in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL):
            quaternion = random.normal(size=4)
            data.qpos[address : address + 4] = quaternion / np.linalg.norm(quaternion)
        else:
            data.qpos[address] += random.uniform(-0.7, 0.7)
    data.qvel[:] = random.uniform(-1.5, 1.5, model.nv)
    data.act[:] = random.uniform(0, 1, model.na)
    data.ctrl[:] = random.uniform(0, 1, model.nu)
    return {name: np.array(getattr(data, name)).tolist() for name in ["qpos", "qvel", "act", "ctrl"]}


# Pairs of shapes that MuJoCo meets with its iterative collider: compared with its tolerance tightened, and more loosely.
CLOSED = {"plane", "sphere", "capsule", "box"}
# Quantities that do not follow from contacts.
SMOOTH = ["xpos", "xquat", "ten_length", "ten_velocity", "actuator_force", "M", "qfrc_bias", "qfrc_passive", "qfrc_actuator", "qacc_smooth"]


def kinds_of(model, geoms):
    return tuple(sorted(mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower() for geom in geoms))


def is_iterated(kinds):
    return "plane" not in kinds and kinds != ("cylinder", "sphere") and not all(name in CLOSED for name in kinds)


def meetings(contacts):
    """Contacts by pair of shapes: distance, place and normal."""
    pairs = {}
    for geoms, distance, place, frame in contacts:
        pairs.setdefault(tuple(geoms), []).append((distance, np.array(place), np.array(frame).ravel()[:3]))
    return pairs


def matched(a, b, tolerance):
    """Whether every contact of one list has one of the other nearby."""
    near = lambda x, y: abs(x[0] - y[0]) < tolerance and np.abs(x[1] - y[1]).max() < tolerance  # noqa: E731
    return len(a) == len(b) and all(any(near(x, y) for y in b) for x in a)


def compare_pairs(model, data, report, pairs, classes):
    """Counts the pairs that met by kind, and those that met elsewhere or in another number; says whether there was one."""
    theirs = meetings([([c.geom1, c.geom2], c.dist, c.pos, c.frame) for c in data.contact[: data.ncon]])
    ours = meetings([(c["geom"], c["dist"], c["pos"], c["frame"]) for c in report["contact"]])
    differ = False
    for pair in theirs.keys() | ours.keys():
        kinds = kinds_of(model, pair)
        tolerance = 1e-5 if is_iterated(kinds) else 1e-8
        a, b = ours.get(pair, []), theirs.get(pair, [])
        same = matched(a, b, tolerance)
        if not same:
            reason = classify(model, data, pair, a, b)
            classes[reason] = classes.get(reason, 0) + 1
        row = pairs.setdefault(kinds, [0, 0, 0])
        row[0] += 1
        row[1] += len(a) != len(b)
        row[2] += not same
        differ |= not same
    return differ


def errors_of(actual, expected):
    errors = {}
    for name, absolute, *_ in QUANTITIES:
        a, e = np.asarray(actual[name], dtype=float), expected[name]
        if a.shape != e.shape:
            errors[name] = np.inf
        elif a.size:
            scale = 1.0 if absolute else max(np.abs(e).max(), 1e-6)
            errors[name] = float(np.abs(a - e).max() / scale)
        else:
            errors[name] = 0.0
    return errors


def page(worst, counts, pairs, classes, cases, seed, failures, differing, apart):
    """The page of what was met."""
    quantities = [name for name, *_ in QUANTITIES]
    head = " | ".join(f"{name} {'abs' if absolute else 'rel'}" for name, absolute, *_ in QUANTITIES)
    lines = [
        "# Parity with MuJoCo on random models", "",
        f"Written by `python tests/oracle/fuzz.py --cases {cases} --seed {seed} --page docs/parity.md`, MuJoCo {mujoco.__version__}.", "",
        "Every case is a random tree of bodies with whatever the row says in it, at a random state; shapes start wherever chance puts",
        "them, often decimetres inside each other. A row gives the worst error over the cases that have the feature; `abs` errors are",
        "in SI units, `rel` ones are relative to the largest entry.", "",
        f"In {differing} of {cases} cases some pair of shapes met elsewhere, or in another number of points, than in MuJoCo: they are in the",
        "second table. Of these, and of the others in which MuJoCo's iterative collider ran, the first table counts only what does not",
        f"follow from contacts; {cases - apart} cases are in it whole. The collider ran with its tolerance tightened to 1e-13 m; what it finds deep",
        "inside two shapes is not always the shortest way out.", "",
        f"| feature | cases | {head} |",
        "|---|---:|" + "---:|" * len(quantities),
    ]
    for feature in sorted(counts):
        cells = " | ".join(f"{worst[feature][name]:.0e}" for name in quantities)
        lines.append(f"| {feature} | {counts[feature]} | {cells} |")
    lines += ["", "| pair | met | in another number of points | anything differs | compared at |", "|---|---:|---:|---:|---:|"]
    for kinds in sorted(pairs):
        met, number, differ = pairs[kinds]
        lines.append(f"| {kinds[0]}, {kinds[1]} | {met} | {number} | {differ} | {'1e-5' if is_iterated(kinds) else '1e-8'} m |")
    lines += ["", "| why a pair differs, judged from the shapes alone (`tests/oracle/touching.py`) | pairs |", "|---|---:|"]
    lines += [f"| {text} | {classes.get(name, 0)} |" for name, text in CLASSES.items()]
    told = f"{len(failures)} cases are out of tolerance:" if failures else f"Apart from these pairs all {cases} cases are within tolerance."
    lines += ["", told, ""] + [f"* {failure}" for failure in failures]
    if failures:
        lines += ["", "Where rows repeat each other their forces are not unique: `efc_force` may differ while `qacc` agrees. A tendon that all but",
                  "slides off its obstacle turns rounding into more of the same."]
    return "\n".join(lines + [""] + small_models()).rstrip() + "\n"


# Folders of small models below tests/oracle, and the test that compares them.
SMALL = [
    ("models", "smooth_parity"), ("models/actuation", "actuation_parity"), ("models/sensors", "sensors"), ("models/mjcf", "mjcf_parity"),
    ("contact_models", "constraint_parity"), ("row_models", "row_parity"), ("scene_models", "scene_stages"),
]


def small_models():
    """The small models that are compared in every run of the tests."""
    rows, count = [], 0
    for folder, test in SMALL:
        names = sorted(path.stem for path in (ROOT / "tests/oracle" / folder).glob("*.xml"))
        count += len(names)
        rows.append(f"| `tests/oracle/{folder}` | `{test}` | {len(names)} | {', '.join(names)} |")
    head = [f"## {count} small models, compared in every run of the tests", "", "| folder | test | models | |", "|---|---|---:|---|"]
    return head + rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=None)
    parser.add_argument("--msk", default=str(ROOT / "target/release/msk"), help="the program")
    parser.add_argument("--shapes", nargs="*", default=SHAPES)
    parser.add_argument("--page", help="where the table goes")
    parser.add_argument("--keep", help="folder for the models that differ")
    arguments = parser.parse_args()
    seed = secrets.randbits(32) if arguments.seed is None else arguments.seed
    print(f"MuJoCo {mujoco.__version__}, {arguments.cases} models from seed {seed}")
    worst, counts, pairs, classes, failures, skipped, differing, apart = {}, {}, {}, {}, [], 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "model.xml"
        for case in range(arguments.cases):
            generator = Model([seed, case])
            text = generator.text(arguments.shapes)
            try:
                model = mujoco.MjModel.from_xml_string(text)
            except ValueError:
                skipped += 1
                continue
            path.write_text(text)
            model.opt.ccd_tolerance, model.opt.ccd_iterations = 1e-13, 1000
            data = mujoco.MjData(model)
            state = state_of(model, data, generator.random)
            try:
                actual, _ = ours(arguments.msk, str(path), state, folder)
            except Exception as error:  # noqa: BLE001: whatever the program says, it is a difference.
                failures.append(f"case {case}: {getattr(error, 'stderr', error)}".strip())
                keep(arguments.keep, case, text, state)
                continue
            mujoco.mj_forward(model, data)
            expected, _ = theirs(model, data)
            errors = errors_of(actual, expected)
            iterated = any(is_iterated(kinds_of(model, [c.geom1, c.geom2])) for c in data.contact[: data.ncon])
            compared = [name for name, *_ in QUANTITIES]
            before = dict(classes)
            other = compare_pairs(model, data, actual, pairs, classes)
            differing += other
            if any(classes.get(name) != before.get(name) for name in CLASSES):
                keep(arguments.keep, case, text, state)
            # What follows from iterated contacts is no better than they are.
            if other or iterated:
                apart += 1
                compared = SMOOTH
            bad = [name for name, _, exact, _ in QUANTITIES if name in compared and not errors[name] <= exact]
            if bad:
                failures.append(f"case {case}: " + ", ".join(f"{name} {errors[name]:.1e}" for name in bad[:4]))
                keep(arguments.keep, case, text, state)
            for feature in {"all"} | generator.features:
                counts[feature] = counts.get(feature, 0) + 1
                row = worst.setdefault(feature, {name: 0.0 for name, *_ in QUANTITIES})
                for name in compared:
                    row[name] = max(row[name], errors[name])
    for failure in failures[:40]:
        print(failure)
    for kinds in sorted(pairs):
        met, number, differ = pairs[kinds]
        print(f"{kinds[0]:>10} {kinds[1]:<10} {met:5} met, {number:3} in another number, {differ:3} differ")
    print(classes)
    print({name: f"{error:.0e}" for name, error in worst.get("all", {}).items()})
    whole = arguments.cases - skipped - apart
    print(f"{whole} cases were compared whole, {apart} without what follows from iterated or other contacts")
    print(f"{len(failures)} of {arguments.cases} out of tolerance, {differing} with other contacts, {skipped} refused by MuJoCo")
    if arguments.page:
        pathlib.Path(arguments.page).write_text(page(worst, counts, pairs, classes, arguments.cases, seed, failures, differing, apart))
    sys.exit(1 if failures else 0)


def keep(folder, case, text, state):
    if folder:
        pathlib.Path(folder).mkdir(parents=True, exist_ok=True)
        (pathlib.Path(folder) / f"{case}.xml").write_text(text)
        (pathlib.Path(folder) / f"{case}.json").write_text(json.dumps(state))


if __name__ == "__main__":
    main()
