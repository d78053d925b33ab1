"""Evaluations on many machines, by Ray: ``python -m msk.ray eval tasks.msk --policy cmc --out results/cmc``.

The episodes are divided into shards. Each is a task of Ray that plays its episodes in Rust threads and returns the files of its
results; a shard whose worker dies is played again elsewhere. What comes back is kept, so the same command goes on after an interruption. In the end
the results have the bytes that one machine would have written.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ray

from .evaluation import evaluate as evaluate_here
from .evaluation import merge

#: Shards for each group of processors that plays one: so that no machine waits long for the last.
_PER_WORKER = 4


@dataclass(frozen=True)
class Timing:
    """Where the time of an evaluation went, s."""

    #: From the first shard to the last.
    elapsed: float
    #: Of all shards together, within Rust.
    playing: float
    #: How many were played at once.
    workers: int
    #: Joining the results.
    merging: float

    @property
    def host_share(self) -> float:
        """Share of the workers' time in which nothing was played: starting, waiting, files, 0..1."""
        whole = self.workers * self.elapsed + self.merging
        return 1 - self.playing / whole if whole > 0 else 0.0


def evaluate(
    source: str | os.PathLike[str] | None = None,
    *,
    out: str | os.PathLike[str],
    shards: int | None = None,
    threads: int | None = None,
    **settings: Any,
) -> tuple[dict[str, Any], Timing]:
    """:func:`msk.evaluate` on the nodes of the cluster to which Ray is connected (``ray.init``).

    Files that ``source`` and ``policy`` name are read on the nodes: by paths that all of them have, or relative to the ``working_dir`` of Ray's
    runtime environment.

    Args:
        source: as for :func:`msk.evaluate`.
        out: folder for the results on this machine; it must not hold any yet. ``OUT-shards`` keeps what has come back meanwhile.
        shards: parts of the episodes; by default four for each worker.
        threads: processors of a worker; by default as many as the smallest node has.
        settings: the others of :func:`msk.evaluate`.

    Returns:
        The content of ``summary.json``, and where the time went.

    Raises:
        FileExistsError: ``out`` exists.
        ray.exceptions.RayError: a shard could not be played, such as a file with errors.
    """
    folder = Path(out)
    if folder.exists():
        raise FileExistsError(f"`{folder}` exists: choose a new folder for the results")
    processors = [int(node["Resources"].get("CPU", 0)) for node in ray.nodes() if node["Alive"]]
    each = threads or max(1, min((count for count in processors if count), default=1))
    workers = max(1, sum(count // each for count in processors))
    count = shards or _PER_WORKER * workers
    parts = folder.with_name(f"{folder.name}-shards")
    parts.mkdir(parents=True, exist_ok=True)
    kept = {number: parts / f"{number}-of-{count}" for number in range(1, count + 1)}
    play = ray.remote(num_cpus=each, max_retries=5)(_play)
    start = time.perf_counter()
    playing = 0.0
    name = None if source is None else os.fspath(source)
    pending = {
        play.remote(name, f"{number}/{count}", each, settings): number
        for number, path in kept.items()
        if not path.exists()
    }
    while pending:
        [ready], _ = ray.wait(list(pending), num_returns=1)
        files, seconds = ray.get(ready)
        _keep(files, kept[pending.pop(ready)])
        playing += seconds
    elapsed = time.perf_counter() - start
    start = time.perf_counter()
    summary = merge(kept.values(), folder)
    shutil.rmtree(parts)
    return summary, Timing(elapsed, playing, min(workers, count), time.perf_counter() - start)


def _play(source: str | None, shard: str, threads: int, settings: dict[str, Any]) -> tuple[dict[str, bytes], float]:
    """The files of a shard's results, and how long it took: on some node."""
    with tempfile.TemporaryDirectory(prefix="msk-") as folder:
        out = Path(folder) / "shard"
        start = time.perf_counter()
        evaluate_here(source, out=out, shard=shard, threads=threads, **settings)
        seconds = time.perf_counter() - start
        files = [path for path in sorted(out.rglob("*")) if path.is_file()]
        return {path.relative_to(out).as_posix(): path.read_bytes() for path in files}, seconds


def _keep(files: dict[str, bytes], folder: Path) -> None:
    """Writes a shard in one move: what is there is whole."""
    growing = folder.with_name(f"{folder.name}.new")
    shutil.rmtree(growing, ignore_errors=True)
    for name, content in files.items():
        path = growing / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    growing.rename(folder)


def main(arguments: list[str] | None = None) -> int:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m msk.ray", description=__doc__.splitlines()[0])
    command = parser.add_subparsers(required=True, metavar="COMMAND").add_parser("eval", help="evaluate a policy")
    command.add_argument("file", nargs="?", help="file with tasks [default: the benchmark]")
    command.add_argument("--policy", default="cmc", help="as for `msk eval`, but for `plan` [default: cmc]")
    command.add_argument("--task", help="this task only")
    command.add_argument("--episodes", type=int, help="episodes per task [default: the protocol's]")
    command.add_argument("--seed", type=int, help="random seed [default: the protocol's]")
    command.add_argument("--out", required=True, help="new folder for the results")
    command.add_argument("--shards", type=int, help="parts of the episodes [default: four for each worker]")
    command.add_argument("--threads", type=int, help="processors of a worker [default: those of the smallest node]")
    command.add_argument("--address", help="address of the cluster [default: RAY_ADDRESS, or this machine]")
    command.add_argument("--working-dir", help="folder that is sent to all nodes, with tasks, bodies and agents")
    given = parser.parse_args(arguments)
    environment = {"working_dir": given.working_dir} if given.working_dir else None
    ray.init(address=given.address, runtime_env=environment, log_to_driver=False, ignore_reinit_error=True)
    try:
        summary, timing = evaluate(
            given.file,
            out=given.out,
            shards=given.shards,
            threads=given.threads,
            policy=given.policy,
            task=given.task,
            episodes=given.episodes,
            seed=given.seed,
        )
    except (ray.exceptions.RayTaskError, ValueError, OSError) as error:
        print(f"error: {getattr(error, 'cause', None) or error}", file=sys.stderr)
        return 1
    for task in summary["tasks"]:
        outcome = f"skipped: {task['skipped']}" if task.get("skipped") else f"{task['successes']} of {task['episodes']}"
        print(f"{task['task']:<20} {outcome}")
    print(
        f"{timing.elapsed:.1f} s on {timing.workers} workers; {100 * timing.host_share:.1f} % of their time outside of Rust"
    )
    print(f"Results: {given.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
