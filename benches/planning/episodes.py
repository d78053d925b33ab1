#!/usr/bin/env python3
"""Episodes of evaluations, as data and as a table.

    msk eval tasks.msk --task walk --policy "plan good" --episodes 10 --out results/good/walk
    python3 benches/planning/episodes.py benches/planning/good.csv results/good/* > new.csv

Takes folders of evaluations and files that it wrote itself, so that tasks may be played one after the other, on several machines and days. Writes
a row per episode: task, episode, success, control steps, what ended it, return. Standard error has the table of docs/planning.md, and the share of
successes in each family and in all.
"""
import csv
import json
import re
import sys
from collections import Counter
from pathlib import Path

# Family and name of each task, in the order of the suite.
SUITE = re.findall(r'^use "tasks/(\w+)/(\w+)\.msk"', (Path(__file__).parents[2] / "tasks.msk").read_text(), re.MULTILINE)
COLUMNS = ["task", "episode", "success", "steps", "ended_by", "return"]


def rows(path):
    if path.suffix == ".csv":
        yield from csv.DictReader(path.open())
        return
    for line in (path / "episodes.jsonl").read_text().splitlines():
        line = json.loads(line)
        ends = " and ".join(line["terminated_by"]) or "horizon"
        yield {
            "task": line["task"], "episode": line["episode"], "success": int(line["success"]), "steps": line["steps"],
            "ended_by": ends, "return": f"{line['return']:.6g}",
        }


def mean(found, column):
    return sum(float(row[column]) for row in found) / len(found)


def main(paths):
    place = {task: index for index, (_, task) in enumerate(SUITE)}
    episodes = {(place[row["task"]], int(row["episode"])): row for path in paths for row in rows(Path(path))}
    episodes = [episodes[key] for key in sorted(episodes)]
    out = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    out.writeheader()
    out.writerows(episodes)
    for task in place:
        found = [row for row in episodes if row["task"] == task]
        if not found:
            continue
        ends = ", ".join(f"{end} {count}" for end, count in Counter(row["ended_by"] for row in found).most_common())
        print(
            f"| `{task}` | {sum(int(row['success']) for row in found)} of {len(found)} | {mean(found, 'return'):.4g}"
            f" | {mean(found, 'steps'):.0f} | {ends} |", file=sys.stderr,
        )
    for family in [*dict.fromkeys(family for family, _ in SUITE), "all"]:
        tasks = {task for own, task in SUITE if family in (own, "all")}
        found = [row for row in episodes if row["task"] in tasks]
        if found:
            share = 100 * mean(found, "success")
            print(f"{family}: {share:.1f} % of {len(found)} episodes in {len({row['task'] for row in found})} tasks", file=sys.stderr)


main(sys.argv[1:])
