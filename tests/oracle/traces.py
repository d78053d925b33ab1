"""Standard metrics of an episode by NumPy from its trace, against those of its record.

Usage: traces.py MSK [TASK [POLICY]]: `MSK` is the program, run in the folder of tasks.msk. Needs numpy.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import numpy


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
    return found


def main():
    msk = str(pathlib.Path(sys.argv[1]).resolve())
    task, policy = (sys.argv[2:] + ["walk", "cmc"][len(sys.argv) - 2 :])[:2]
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "trace.npz"
        command = [msk, "run", task, "--policy", policy, "--json", "--trace", str(path)]
        record = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
        found = metrics(numpy.load(path))
    for name, value in found.items():
        expected = record["standard"][name]
        print(f"{name:22} {value:.9g}")
        if not numpy.isclose(value, expected, rtol=1e-12, atol=1e-12):
            sys.exit(f"error: {name} is {value} by NumPy and {expected} in the record")


if __name__ == "__main__":
    main()
