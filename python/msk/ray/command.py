"""The command line: ``python -m msk.ray eval tasks.msk --policy cmc --out results/cmc``, and ``collect``."""

from __future__ import annotations

import argparse
import sys

import ray

from .shards import Timing, collect, evaluate


def main(arguments: list[str] | None = None) -> int:
    """Plays what the arguments say on a cluster, and prints what came of it. Gives the exit code."""
    given = _parser().parse_args(arguments)
    environment = {"working_dir": given.working_dir} if given.working_dir else None
    ray.init(address=given.address, runtime_env=environment, log_to_driver=False, ignore_reinit_error=True)
    try:
        timing = given.run(given)
    except (ray.exceptions.RayTaskError, ValueError, OSError) as error:
        print(f"error: {getattr(error, 'cause', None) or error}", file=sys.stderr)
        return 1
    share = f"{100 * timing.host_share:.1f} % of their time outside of Rust"
    print(f"{timing.elapsed:.1f} s on {timing.workers} workers; {share}")
    print(f"Results: {given.out}")
    return 0


def _evaluate(given: argparse.Namespace) -> Timing:
    settings = {key: getattr(given, key) for key in ("shards", "threads", "policy", "task", "episodes", "seed")}
    summary, timing = evaluate(given.file, out=given.out, **settings)
    for task in summary["tasks"]:
        outcome = f"skipped: {task['skipped']}" if task.get("skipped") else f"{task['successes']} of {task['episodes']}"
        print(f"{task['task']:<20} {outcome}")
    return timing


def _collect(given: argparse.Namespace) -> Timing:
    settings = {key: getattr(given, key) for key in ("shards", "policy", "task", "episodes", "seed")}
    data, timing = collect(given.file, out=given.out, **settings)
    print(
        f"{data.episodes} episodes, {data.steps} control steps, {data.successes} successes, "
        f"mean return {data.mean_return:.1f}"
    )
    return timing


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m msk.ray",
        description="Evaluations and data sets on many machines, by Ray. The same command goes on after an interruption.",
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    command = commands.add_parser("eval", help="evaluate a policy")
    command.add_argument("file", nargs="?", help="file with tasks [default: the benchmark]")
    command.add_argument("--policy", default="cmc", help="as for `msk eval`, but for `plan` [default: cmc]")
    command.add_argument("--task", help="this task only")
    command.add_argument("--episodes", type=int, help="episodes per task [default: the protocol's]")
    command.add_argument("--seed", type=int, help="random seed [default: the protocol's]")
    command.add_argument("--threads", type=int, help="processors of a worker [default: those of the smallest node]")
    command.set_defaults(run=_evaluate)
    _add_cluster(command)

    command = commands.add_parser("collect", help="keep episodes under a policy as a data set")
    command.add_argument("file", help="file with tasks, or the name of a task of the benchmark")
    command.add_argument("--policy", default="cmc", help="as for `msk collect`, but for `plan` [default: cmc]")
    command.add_argument("--task", help="this task of the file")
    command.add_argument("--episodes", type=int, default=10, help="number of episodes [default: 10]")
    command.add_argument("--seed", type=int, default=0, help="random seed [default: 0]")
    command.set_defaults(run=_collect)
    _add_cluster(command)
    return parser


def _add_cluster(command: argparse.ArgumentParser) -> None:
    """What all commands have."""
    command.add_argument("--out", required=True, help="new folder for the results")
    command.add_argument("--shards", type=int, help="parts of the episodes [default: four for each worker]")
    command.add_argument("--address", help="address of the cluster [default: RAY_ADDRESS, or this machine]")
    command.add_argument("--working-dir", help="folder that is sent to all nodes, with tasks, bodies and agents")
