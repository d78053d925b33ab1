#!/usr/bin/env python3
"""Learning with and without tuning: PPO on `tuning.msk`, whose weights let an agent stand where it is to walk.

    python3 benches/learning/tuning.py results/tuning

Runs `msk tune --policy "learner ppo"` for each seed, once with the reasoner `rules` and once with one that leaves the weights as they are:
20 rounds, 50 000 control steps before each, at most 20 % of a weight in a round, the sum of all weights kept. Then `msk eval --sweep` plays the
agent that each session ends with, and the one of its best round, under pushes and under noise on its actions, with starts that neither the
training nor the tuning has seen.

Writes `tuning_rounds.csv` (weights, success, survival and speed of every round) and `tuning_sweep.csv` (success and survival at every
scale) to the folder. Whatever is there already is not run again.
"""
import argparse
import csv
import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
TASK = HERE / "tuning.msk"
ARMS = ["rules", "unchanged"]
AGENTS = ["last", "best-by-objective"]
ROUNDS, LEARN, INTERVAL, NORM, HELD_OUT = 20, 50_000, 10_000, 7.6, 1000


def answer():
    """What a reasoner says that changes nothing: it is a program, started as this one with `--answer`."""
    terms = json.load(sys.stdin)["request"]["statistics"]["terms"]
    print(json.dumps({"weights": {term["term"]: term["weight"] for term in terms}, "reason": "unchanged"}))


def session(msk, out, arm, seed):
    """The folder of the session of an arm and a seed, which is run or resumed if need be."""
    folder = out / f"{arm}-{seed}"
    reasoner = "rules"
    if arm == "unchanged":
        reasoner = str(out / "unchanged.toml")
        command = json.dumps([sys.executable, str(Path(__file__).resolve()), "--answer"])
        Path(reasoner).write_text(f'kind = "process"\ncommand = {command}\n')
    numbers = {"learn": LEARN, "rounds": ROUNDS, "interval": INTERVAL, "norm": NORM, "seed": seed, "threads": 1}
    options = [word for name, value in numbers.items() for word in (f"--{name}", str(value))]
    command = [msk, "tune", f"{TASK}@stroll", "--policy", "learner ppo", "--reasoner", reasoner, *options, "--out", str(folder)]
    subprocess.run(command, check=True)
    return folder


def sweep(msk, folder, agent):
    """The folder of the sweep of an agent of a session."""
    out = folder / f"sweep-{agent}"
    if not (out / "sweep.json").exists():
        policy = f"agent {folder / 'training' / agent}"
        command = [msk, "eval", str(TASK), "--task", "stroll", "--policy", policy, "--sweep", "push,action", "--episodes", "50"]
        subprocess.run([*command, "--seed", str(HELD_OUT), "--threads", "1", "--out", str(out)], check=True)
    return out


def lines(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, nargs="?", default=Path("results/tuning"))
    parser.add_argument("--msk", default="target/release/msk")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--answer", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.answer:
        return answer()
    out = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    rounds, scales = [], []
    for seed in range(1, arguments.seeds + 1):
        for arm in ARMS:
            folder = session(arguments.msk, out, arm, seed)
            for line in lines(folder / "rounds.jsonl"):
                found = line["statistics"]
                speed = found["metrics"][0]["mean"]["mean"]
                row = {"arm": arm, "seed": seed, "round": line["round"], **dict(line["weights"])}
                rounds.append({**row, "success": found["success_rate"], "survival": found["survival"]["mean"], "speed": speed})
            for agent in AGENTS:
                for scale in sorted(path.parent for path in sweep(arguments.msk, folder, agent).glob("*/episodes.jsonl")):
                    episodes = lines(scale / "episodes.jsonl")
                    mean = lambda key: sum(episode[key] for episode in episodes) / len(episodes)
                    row = {"arm": arm, "seed": seed, "agent": agent, "perturbation": scale.name}
                    scales.append({**row, "success": mean("success"), "survival": mean("steps")})
    for name, rows in [("tuning_rounds.csv", rounds), ("tuning_sweep.csv", scales)]:
        with open(out / name, "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows({key: f"{value:.5g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows)


if __name__ == "__main__":
    main()
