#!/usr/bin/env python3
"""Draws what tuning_plans.py wrote: success by round, of each task, tuned by rules and by an agent.

    pip install matplotlib
    python3 benches/learning/tuning_plans_picture.py benches/learning/tuning_plans.csv docs/pages/tuning-plans.svg
"""
import csv
import sys

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "msk", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
import matplotlib.pyplot as plt

REASONERS = {"rules": ("C0", "reasoner `rules`"), "agent": ("C1", "scripted agent")}


def main():
    rows = list(csv.DictReader(open(sys.argv[1])))
    tasks = list(dict.fromkeys(row["task"] for row in rows))
    figure, panels = plt.subplots(1, len(tasks), figsize=(3 * len(tasks), 2.6), layout="constrained", sharey=True)
    for task, axes in zip(tasks, panels):
        for reasoner, (colour, label) in REASONERS.items():
            points = [(int(row["round"]), 100 * float(row["success"])) for row in rows if (row["task"], row["reasoner"]) == (task, reasoner)]
            axes.plot(*zip(*points), color=colour, marker="o", markersize=3, label=label)
        axes.set(title=task, xlabel="round", ylim=(-5, 105))
    panels[0].set(ylabel="episodes that succeed (%)")
    panels[0].legend(frameon=False, fontsize=8)
    figure.savefig(sys.argv[2], metadata={"Date": None})


main()
