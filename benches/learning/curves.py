#!/usr/bin/env python3
"""Learning curves of trainings that differ in their seeds, as a table and as data.

    for seed in 1 2 3 4 5; do msk train examples/peers/hopper.msk --seed $seed --out results/hopper-ppo-$seed; done
    python3 benches/learning/curves.py results/hopper-ppo-* > benches/learning/hopper-ppo.csv

Writes a row per training and evaluation: task, algorithm, seed, control steps, mean return without chance in the actions, share of successes,
and the mean return of the training's own episodes since the evaluation before. Standard error has, for each task and algorithm, the
interquartile mean over seeds at the end with a bootstrap interval of 95 %.
"""
import json
import random
import sys
import tomllib
from collections import defaultdict
from pathlib import Path


def rows(folder):
    identity = tomllib.loads((folder / "training.toml").read_text())
    name = (identity["task"], identity["settings"]["algorithm"], identity["seed"])
    total = episodes = 0
    for line in (folder / "curve.jsonl").read_text().splitlines():
        line = json.loads(line)
        if "evaluation" in line:
            own = total / episodes if episodes else float("nan")
            yield (*name, line["step"], line["evaluation"]["return"], line["evaluation"]["success"], own)
            total = episodes = 0
        elif "episodes" in line:
            total += line["return"] * line["episodes"]
            episodes += line["episodes"]


def interquartile_mean(values):
    """The mean of the middle half, with parts of values at its bounds."""
    values, quarter = sorted(values), len(values) / 4
    weights = [min(place + 1, len(values) - quarter) - max(place, quarter) for place in range(len(values))]
    weights = [max(weight, 0.0) for weight in weights]
    return sum(weight * value for weight, value in zip(weights, values)) / sum(weights)


def interval(values, draws=10000):
    chance = random.Random(0)
    means = sorted(interquartile_mean(chance.choices(values, k=len(values))) for _ in range(draws))
    return means[int(0.025 * draws)], means[int(0.975 * draws)]


print("task,algorithm,seed,step,return,success,own_return")
ends = defaultdict(list)
for folder in sys.argv[1:]:
    last = None
    for row in rows(Path(folder)):
        *name, step, mean, success, own = row
        print(",".join(map(str, [*name, step, f"{mean:.2f}", f"{success:.3f}", f"{own:.2f}"])))
        last = row
    if last:
        ends[last[:2]].append(last)
for (task, algorithm), found in ends.items():
    for what, place in [("without chance", 4), ("its own episodes", 6)]:
        values = [row[place] for row in found]
        low, high = interval(values)
        steps = min(row[3] for row in found)
        print(f"{task} {algorithm}, {len(values)} seeds, {steps} steps, {what}: {interquartile_mean(values):.0f} [{low:.0f}, {high:.0f}]", file=sys.stderr)
