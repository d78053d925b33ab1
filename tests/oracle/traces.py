"""Standard metrics of an episode by NumPy from its trace, against those of its record.

Usage: traces.py MSK [TASK [POLICY]]: `MSK` is the program, run in the folder of tasks.msk. Needs numpy.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy


def strikes(forces, period):
    """Rows at which a foot begins to stand, and leaves the ground again or not: above 20 N, for at least 50 ms."""
    stands = forces > 20
    edges = numpy.flatnonzero(numpy.diff(stands)) + 1
    starts, ends = numpy.concatenate([[0], edges]), numpy.concatenate([edges, [len(stands)]])
    present, found = stands[0], []
    for start, end in zip(starts, ends):
        if stands[start] != present and (end - start + 0.5) * period >= 0.05:
            present = stands[start]
            if present:
                found.append([start, None])
            elif found:
                found[-1][1] = start
    return found


def gait(archive, period):
    """Gait figures of two feet."""
    feet = [strikes(archive["ground_reactions"][:, 2 + 7 * foot], period) for foot in range(2)]
    places = archive["feet"].reshape(len(archive["time"]), 2, 3)
    steps = sorted((start, foot) for foot in range(2) for start, _ in feet[foot])
    if len(steps) < 2:
        return {}
    (first, _), (last, _) = steps[0], steps[-1]
    found = {"cadence": 60 * (len(steps) - 1) / ((last - first) * period)} if last > first else {}
    way = (archive["center_of_mass"][last] - archive["center_of_mass"][first])[:2]
    way = way / numpy.linalg.norm(way)
    lengths = [[], []]
    for (_, other), (row, foot) in zip(steps, steps[1:]):
        if foot != other:
            lengths[foot].append((places[row, foot] - places[row, 1 - foot])[:2] @ way)
    shares = [[(off - start) / (after[0] - start) for (start, off), after in zip(own, own[1:]) if off is not None] for own in feet]
    for name, values in (("step_length", lengths), ("stance_share", shares)):
        if sum(values, []):
            found[name] = numpy.mean(sum(values, []))
        if all(values):
            left, right = (numpy.mean(side) for side in values)
            asymmetry = {"step_length": "step_length_asymmetry", "stance_share": "stance_asymmetry"}[name]
            found[asymmetry] = abs(left - right) / (0.5 * abs(left + right))
    return found


def recruitment(archive, layout):
    """Activation mass of each muscle family."""
    families = numpy.array([muscle["family"] for muscle in layout["muscles"]])
    means = archive["activations"][:-1].mean(axis=0)
    return {family: means[families == family].sum() for family in layout["families"]}


def metrics(archive):
    """Metrics by name, from the arrays of a trace."""
    layout = json.loads(archive["trace.json"])["layout"]
    columns = {block["quantity"]: block["columns"] for block in layout["blocks"]}
    period, weight = layout["period"], layout["mass"] * layout["gravity"]
    # Samples before a step: all states but the last.
    activations, velocities = archive["activations"][:-1], archive["velocities"][:-1]
    turns = [not column["name"].startswith("root.") and column["unit"] == "rad/s" for column in columns["velocities"]]
    jerk = numpy.diff(velocities[:, turns], n=2, axis=0) / period**2
    energy = numpy.trapezoid(archive["metabolic_power"][:, 0], dx=period)
    way = archive["center_of_mass"][-1] - archive["center_of_mass"][0]
    distance = numpy.hypot(way[0], way[1])
    found = {
        "activation_cost": numpy.mean(activations**2),
        "joint_smoothness": numpy.log10(max(numpy.mean(jerk**2), 1e-12)),
        "metabolic_energy": energy,
        "metabolic_power": energy / (period * (len(archive["time"]) - 1) * layout["mass"]),
        "peak_ground_reaction": archive["ground_reactions"][:, 2::7].sum(axis=1).max() / weight,
        "peak_joint_reaction": archive["joint_reactions"].max() / weight,
        "distance": distance,
    }
    if distance >= 1:
        found["cost_of_transport"] = energy / (weight * distance)
    if "tracking_error" in archive:
        found["tracking_error"] = numpy.sqrt(numpy.nanmean(archive["tracking_error"] ** 2))
    return {**found, **gait(archive, period)}


def main():
    msk = str(pathlib.Path(sys.argv[1]).resolve())
    task, policy = (sys.argv[2:] + ["walk", "cmc"][len(sys.argv) - 2 :])[:2]
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "trace.npz"
        command = [msk, "run", task, "--policy", policy, "--json", "--trace", str(path)]
        record = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        archive = numpy.load(path)
        layout = json.loads(archive["trace.json"])["layout"]
        found, masses = metrics(archive), recruitment(archive, layout)
    if set(found) != set(record["standard"]):
        sys.exit(f"error: NumPy finds {sorted(found)}, the record has {sorted(record['standard'])}")
    numbers = [*((name, value, record["standard"]) for name, value in found.items())]
    numbers += [(name, value, record["recruitment"]) for name, value in masses.items()]
    for name, value, known in numbers:
        expected = known[name]
        print(f"{name:22} {value:.9g}")
        if not numpy.isclose(value, expected, rtol=1e-12, atol=1e-12):
            sys.exit(f"error: {name} is {value} by NumPy and {expected} in the record")


if __name__ == "__main__":
    main()
