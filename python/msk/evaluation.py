"""Evaluations, with the results that ``msk eval`` and ``msk merge`` write."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from . import _native
from .tasks import SUITE, TASKS, Parameters, _settings


def evaluate(
    source: str | os.PathLike[str] | None = None,
    *,
    out: str | os.PathLike[str],
    policy: str = "cmc",
    task: str | None = None,
    episodes: int | None = None,
    seed: int | None = None,
    shard: str = "1/1",
    threads: int | None = None,
    params: Parameters | None = None,
) -> dict[str, Any]:
    """Plays episodes of tasks under a policy and keeps their results in a folder, as ``msk eval`` does. What the folder has of the same run is
    not played again, so an evaluation that was interrupted goes on.

    Args:
        source: the path of a file, the name of one of :data:`TASKS`, or None for all of these.
        out: the folder; ``msk report`` and ``msk compare`` read it.
        policy: what ``msk eval --policy`` takes, but for ``plan``: ``cmc``, ``agents``, ``agent FOLDER``, ``network FILE``,
            ``process COMMAND`` and others.
        task: one task of the file; all of its suite by default.
        episodes: for each task; those of the suite's first protocol by default.
        seed: of all chance; that of the protocol by default.
        shard: ``2/5`` for a fifth of the episodes: :func:`merge` joins the folders.
        threads: as many as there are processors by default; results do not depend on it.
        params: values of parameters of the tasks.

    Returns:
        The content of ``summary.json``: success, returns, ends, terms and metrics of each task, means of families.

    Raises:
        CompileError: the file has errors.
        ValueError: there is no such policy or task, or the folder holds another run.
    """
    if source is None:
        path = SUITE
    else:
        path = TASKS.get(os.fspath(source), os.fspath(source))
    protocol = (episodes, seed)
    return _read(_native.evaluate(path, task, _settings(params), policy, protocol, shard, threads, os.fspath(out)))


def merge(shards: Iterable[str | os.PathLike[str]], out: str | os.PathLike[str]) -> dict[str, Any]:
    """Joins the folders of all shards of an evaluation in a new folder, with the bytes that one machine would have written, as ``msk merge``
    does.

    Raises:
        ValueError: they are not the shards of one evaluation, or an episode is missing.
        OSError: the folder exists.
    """
    return _read(_native.merge([os.fspath(shard) for shard in shards], os.fspath(Path(out))))


def _read(summary: str) -> dict[str, Any]:
    read: dict[str, Any] = json.loads(summary)
    return read
