"""Data sets of episodes, with the files that ``msk collect`` writes."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass

from . import _native
from .tasks import TASKS, Parameters, _settings


@dataclass(frozen=True)
class DataSet:
    """What a data set holds."""

    episodes: int
    #: Control steps of all episodes.
    steps: int
    #: Episodes whose success holds at their last step.
    successes: int
    mean_return: float


def collect(
    source: str | os.PathLike[str],
    *,
    out: str | os.PathLike[str],
    policy: str = "cmc",
    task: str | None = None,
    episodes: int = 10,
    seed: int = 0,
    shard: str = "1/1",
    params: Parameters | None = None,
) -> DataSet:
    """Plays episodes of a task under a policy and keeps every control step of them in a folder, as ``msk collect`` does:
    ``0000.npz`` and on, one for each episode, which ``numpy.load`` reads. What the folder has of the same run is not played again.

    Args:
        source: the path of a file, or the name of one of :data:`TASKS`.
        out: the folder; ``data.json`` in it names the columns of the arrays, ``msk train --data`` reads it.
        policy: what ``msk collect --policy`` takes, but for ``plan``: see :func:`msk.evaluate`.
        task: which one, if the file holds several.
        episodes: how many.
        seed: of all chance.
        shard: ``2/5`` for a fifth of the episodes: :func:`merge_data` joins the folders.
        params: values of parameters of the task.

    Raises:
        CompileError: the file has errors.
        ValueError: there is no such policy or task, or the folder holds another run.
    """
    path = TASKS.get(os.fspath(source), os.fspath(source))
    return DataSet(*_native.collect(path, task, _settings(params), policy, (episodes, seed), shard, os.fspath(out)))


def merge_data(shards: Iterable[str | os.PathLike[str]], out: str | os.PathLike[str]) -> DataSet:
    """Joins the folders of all shards of a data set in a new folder, with the bytes that one machine would have written, as ``msk merge``
    does.

    Raises:
        ValueError: they are not the shards of one data set, or an episode is missing.
        OSError: the folder exists.
    """
    return DataSet(*_native.merge_collected([os.fspath(shard) for shard in shards], os.fspath(out)))
