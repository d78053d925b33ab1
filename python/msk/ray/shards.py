"""Evaluations and data sets in shards, which the nodes of a cluster play.

Each shard is a task of Ray that plays its episodes in Rust threads and returns the files of its results; a shard whose worker dies is played
again elsewhere. What comes back is kept, so the same call goes on after an interruption.
"""

from __future__ import annotations

import os
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import ray

from ..collection import DataSet, merge_data
from ..collection import collect as collect_here
from ..evaluation import evaluate as evaluate_here
from ..evaluation import merge

#: Shards for each group of processors that plays one: so that no machine waits long for the last.
_PER_WORKER = 4


@dataclass(frozen=True)
class Timing:
    """Where the time of an evaluation or a collection went, s."""

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
    each = threads or smallest_node()
    run = _Run(_evaluated, None if source is None else os.fspath(source), Path(out), each, settings)
    run.play(shards or _PER_WORKER * run.workers)
    return run.join(merge)


def collect(
    source: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str],
    episodes: int = 10,
    shards: int | None = None,
    **settings: Any,
) -> tuple[DataSet, Timing]:
    """:func:`msk.collect` on the nodes of the cluster to which Ray is connected: the data set has the bytes that one machine would have
    written. A worker has one processor, and plays one episode after the other.

    Args:
        source, episodes, settings: as for :func:`msk.collect`.
        out, shards: as for :func:`evaluate`.

    Returns:
        What the data set holds, and where the time went.

    Raises:
        FileExistsError: ``out`` exists.
        ray.exceptions.RayError: a shard could not be played, such as a file with errors.
    """
    run = _Run(_collected, os.fspath(source), Path(out), 1, {"episodes": episodes, **settings})
    run.play(min(shards or _PER_WORKER * run.workers, max(1, episodes)))
    return run.join(merge_data)


def node_processors() -> dict[str, int]:
    """The processors of each node of the cluster, by its id; nodes without any are left out."""
    nodes = [(str(node["NodeID"]), int(node["Resources"].get("CPU", 0))) for node in ray.nodes() if node["Alive"]]
    return {name: count for name, count in nodes if count}


def smallest_node() -> int:
    """The number of processors of the smallest node."""
    return min(node_processors().values(), default=1)


#: Plays a shard: source, ``2/5``, processors, the other settings, folder.
_Play = Callable[[str | None, str, int, dict[str, Any], Path], None]


class _Run:
    """The shards of one run."""

    def __init__(self, play: _Play, source: str | None, out: Path, each: int, settings: dict[str, Any]) -> None:
        if out.exists():
            raise FileExistsError(f"`{out}` exists: choose a new folder for the results")
        self.what, self.source, self.out, self.each, self.settings = play, source, out, each, settings
        self.workers = max(1, sum(count // each for count in node_processors().values()))
        self.parts = out.with_name(f"{out.name}-shards")
        self.kept: dict[int, Path] = {}
        self.elapsed = self.playing = 0.0

    def play(self, count: int) -> None:
        """Plays so many shards, but for those that are kept."""
        self.parts.mkdir(parents=True, exist_ok=True)
        self.kept = {number: self.parts / f"{number}-of-{count}" for number in range(1, count + 1)}
        play = ray.remote(num_cpus=self.each, max_retries=5)(_played)
        start = time.perf_counter()
        pending = {
            play.remote(self.what, self.source, f"{number}/{count}", self.each, self.settings): number
            for number, path in self.kept.items()
            if not path.exists()
        }
        while pending:
            [ready], _ = ray.wait(list(pending), num_returns=1)
            files, seconds = ray.get(ready)
            _keep(files, self.kept[pending.pop(ready)])
            self.playing += seconds
        self.elapsed = time.perf_counter() - start

    def join(self, merge: Callable[[list[Path], Path], Any]) -> tuple[Any, Timing]:
        """Joins them, and forgets them."""
        start = time.perf_counter()
        merged = merge(list(self.kept.values()), self.out)
        shutil.rmtree(self.parts)
        workers = min(self.workers, len(self.kept))
        return merged, Timing(self.elapsed, self.playing, workers, time.perf_counter() - start)


def _evaluated(source: str | None, shard: str, threads: int, settings: dict[str, Any], out: Path) -> None:
    evaluate_here(source, out=out, shard=shard, threads=threads, **settings)


def _collected(source: str | None, shard: str, threads: int, settings: dict[str, Any], out: Path) -> None:
    assert source is not None
    collect_here(source, out=out, shard=shard, **settings)


def _played(
    play: _Play, source: str | None, shard: str, threads: int, settings: dict[str, Any]
) -> tuple[dict[str, bytes], float]:
    """The files of a shard's results, and how long it took: on some node."""
    with tempfile.TemporaryDirectory(prefix="msk-") as folder:
        out = Path(folder) / "shard"
        start = time.perf_counter()
        play(source, shard, threads, settings, out)
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
