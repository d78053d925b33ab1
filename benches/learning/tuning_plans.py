#!/usr/bin/env python3
"""Tuning by planned behaviour: three tasks with weights under which a body stands instead. `squat` and `reach` begin with those of
`tuning_plans.toml`, `shuffle` is a walk with one more term (`tuning_plans.msk`).

    python3 benches/learning/tuning_plans.py results/tuning-plans

Each task is tuned twice, from the root of the project. By `msk tune --policy plan` with the reasoner `rules`; and by an agent, which is a
script here: it plays episodes with `msk eval --policy plan`, and through the tools of `msk mcp` reads what came of them, proposes weights and
applies them to a weights file. The script does not depend on the task. It doubles the weight of a term whose mean value is below half of its
largest, and halves the weight of a term above 95 % of it, until every episode of a round succeeds.

Writes `tuning_plans.csv`, a line per round with its success and weights, to the folder. Whatever is there already is not run again.
"""
import argparse
import csv
import json
import subprocess
from pathlib import Path

HERE = Path(__file__).resolve().parent
START = HERE / "tuning_plans.toml"
# The file of each task, rounds at most, episodes of a round, and control steps of each.
OWN = "benches/learning/tuning_plans.msk"
TASKS = {"squat": ("tasks.msk", 10, 2, 1000), "reach": ("tasks.msk", 8, 2, 500), "shuffle": (OWN, 8, 2, 1000)}
STEP = 0.5


class Server:
    """A client of `msk mcp` over its standard input and output."""

    def __init__(self, msk):
        self.process = subprocess.Popen([msk, "mcp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.asked = 0
        client = {"name": "tuning_plans", "version": "1"}
        self.ask("initialize", {"protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": client})
        self.send({"method": "notifications/initialized"})

    def send(self, message):
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}) + "\n")
        self.process.stdin.flush()

    def ask(self, method, parameters):
        self.asked += 1
        self.send({"id": self.asked, "method": method, "params": parameters})
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer or answer["result"].get("isError"):
            raise RuntimeError(f"{method} {parameters}: {answer}")
        return answer["result"]

    def call(self, tool, **arguments):
        return self.ask("tools/call", {"name": tool, "arguments": arguments})["structuredContent"]

    def close(self):
        """The server ends with its input."""
        self.process.stdin.close()
        self.process.wait()


def weights_of(task):
    """What `msk tune` is given for the weights that a task begins with."""
    return ["--weights", str(START)] if f"[{task}]" in START.read_text() else []


def by_rules(msk, out, task):
    """The rounds of a session with the reasoner `rules`."""
    file, rounds, episodes, steps = TASKS[task]
    numbers = {"step": STEP, "rounds": rounds, "interval": episodes * steps}
    options = [word for name, value in numbers.items() for word in (f"--{name}", str(value))]
    command = [msk, "tune", f"{file}@{task}", "--policy", "plan", *weights_of(task), *options, "--out", str(out / "rules")]
    subprocess.run(command, check=True)
    for line in (out / "rules" / "rounds.jsonl").read_text().splitlines():
        found = json.loads(line)
        yield found["statistics"]["success_rate"], dict(found["weights"])


def wish(terms, found):
    """What the scripted agent makes of the mean values of the terms."""
    weights = {}
    for term in terms:
        top, mean = term["value_range"][1], found[term["term"]]
        if term["weight"] <= 0 or not top:
            continue
        share = mean / top
        weights[term["term"]] = term["weight"] * (2 if share < 0.5 else 0.5 if share > 0.95 else 1)
    return weights


def by_agent(msk, out, task):
    """The rounds of the scripted agent."""
    file, rounds, episodes, _ = TASKS[task]
    server, weights = Server(msk), out / "agent" / "weights.toml"
    weights.parent.mkdir(parents=True, exist_ok=True)
    if not weights.exists():
        weights.write_text(START.read_text() if weights_of(task) else "")
    overlay = str(weights.relative_to(Path.cwd()))
    for round in range(1, rounds + 1):
        folder = weights.parent / f"round-{round}"
        kept = weights.parent / f"round-{round}.toml"
        if not kept.exists():
            kept.write_text(weights.read_text())
        command = [msk, "eval", file, "--task", task, "--policy", "plan", "--episodes", str(episodes), "--seed", str(round)]
        subprocess.run([*command, "--weights", str(kept), "--out", str(folder)], check=True)
        found = server.call("read_results", folder=str(folder.relative_to(Path.cwd())))["content"]["tasks"][0]
        played = {"file": file, "task": task, "overlay": str(kept.relative_to(Path.cwd()))}
        terms = server.call("list_terms", **played)["terms"]
        yield found["success_rate"], {term["term"]: term["weight"] for term in terms}
        if found["success_rate"] == 1:
            break
        if not (weights.parent / f"round-{round + 1}.toml").exists():
            means = {term["name"]: term["value_per_step"] for term in found["terms"]}
            proposed = server.call("propose_weights", **played, weights=wish(terms, means), step=1)
            changed = {f"{task}.{term}": weight for term, weight in proposed["apply"].items()}
            server.call("apply_weights", file=file, weights=changed, overlay=overlay, dry_run=False)
    server.close()


REASONERS = {"rules": by_rules, "agent": by_agent}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, nargs="?", default=Path("results/tuning-plans"))
    parser.add_argument("--msk", default="target/release/msk")
    parser.add_argument("--task", choices=TASKS, help="this one only")
    parser.add_argument("--reasoner", choices=REASONERS, help="this one only")
    arguments = parser.parse_args()
    rows = []
    for task in [arguments.task] if arguments.task else TASKS:
        out = arguments.out.resolve() / task
        out.mkdir(parents=True, exist_ok=True)
        for reasoner in [arguments.reasoner] if arguments.reasoner else REASONERS:
            for round, (success, weights) in enumerate(REASONERS[reasoner](arguments.msk, out, task), 1):
                weights = " ".join(f"{term}={weight:.3g}" for term, weight in weights.items())
                rows.append({"task": task, "reasoner": reasoner, "round": round, "success": f"{success:.3g}", "weights": weights})
    with open(arguments.out / "tuning_plans.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
