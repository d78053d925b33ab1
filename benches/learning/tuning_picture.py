#!/usr/bin/env python3
"""Draws what tuning.py wrote: weights, speed and survival with and without tuning, a thin line per seed and their mean.

    pip install matplotlib
    python3 benches/learning/tuning_picture.py benches/learning docs/pages/tuning.svg     # reads tuning_rounds.csv and tuning_sweep.csv
"""
import csv
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "msk", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
import matplotlib.pyplot as plt

ARMS = {"rules": ("C0", "tuned by rules"), "unchanged": ("C7", "weights unchanged")}
TERMS = ["pace", "alive", "upright", "effort"]
PUSHES = [("unperturbed", 0.0)] + [(f"push-{scale}", scale) for scale in (0.05, 0.1, 0.2, 0.4)]


def lines(axes, rows, of, colour, label):
    """A thin line for each seed and a thick one for their mean, of points (x, y)."""
    seeds = defaultdict(list)
    for row in rows:
        seeds[row["seed"]].append(of(row))
    curves = [sorted(points) for points in seeds.values()]
    for points in curves:
        axes.plot(*zip(*points), color=colour, linewidth=0.5, alpha=0.5)
    mean = [(column[0][0], sum(y for _, y in column) / len(column)) for column in zip(*curves)]
    axes.plot(*zip(*mean), color=colour, linewidth=2, label=label)


def main():
    data, out = Path(sys.argv[1]), Path(sys.argv[2])
    rounds = list(csv.DictReader(open(data / "tuning_rounds.csv")))
    scales = list(csv.DictReader(open(data / "tuning_sweep.csv")))
    figure, (weights, speed, survival) = plt.subplots(1, 3, figsize=(10, 3), layout="constrained")
    tuned = [row for row in rounds if row["arm"] == "rules"]
    for place, term in enumerate(TERMS):
        lines(weights, tuned, lambda row: (int(row["round"]), float(row[term])), f"C{place}", term)
    weights.set(xlabel="round of 50 000 steps", ylabel="weight, tuned by rules")
    for arm, (colour, label) in ARMS.items():
        lines(speed, [row for row in rounds if row["arm"] == arm], lambda row: (int(row["round"]), float(row["speed"])), colour, label)
        pushed = [row for row in scales if row["arm"] == arm and row["agent"] == "last" and row["perturbation"] in dict(PUSHES)]
        lines(survival, pushed, lambda row: (dict(PUSHES)[row["perturbation"]], float(row["survival"])), colour, label)
    speed.axhline(1.5, color="black", linewidth=0.5, linestyle="--")
    speed.set(xlabel="round of 50 000 steps", ylabel="speed (m/s); dashed: aim")
    survival.set(xlabel="push (body weights)", ylabel="survival of the last agent (steps)", ylim=(0, 1050))
    for axes in (weights, speed, survival):
        axes.legend(frameon=False, fontsize=8)
    figure.savefig(out, metadata={"Date": None})


main()
