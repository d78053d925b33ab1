"""Gymnasium's ids: ``walk`` is ``msk/Walk-v0``."""

from __future__ import annotations

import os
from typing import Any

import gymnasium

from .environment import Env
from .tasks import TASKS, Task
from .vector import VectorEnv


def id_of(task: str) -> str:
    """The id of a task of the benchmark: ``single_leg_stand`` is ``msk/SingleLegStand-v0``."""
    return f"msk/{''.join(word.capitalize() for word in task.split('_'))}-v0"


def register() -> None:
    """Registers the tasks of the benchmark, unless that is done. ``import msk`` does it."""
    for task in TASKS:
        if id_of(task) not in gymnasium.registry:
            gymnasium.register(
                id_of(task),
                entry_point="msk.environment:Env",
                vector_entry_point="msk.vector:VectorEnv",
                kwargs={"task": task},
            )


def make(task: Task | str | os.PathLike[str], **settings: Any) -> Env:
    """An environment of a task: a name of :data:`TASKS`, the path of a file, or a compiled task. ``settings`` are those of :class:`Env`.

    >>> env = msk.make("crouch.msk", params={"speed": 1.2}, weights={"upright": 7})
    """
    return Env(task, **settings)


def make_vec(task: Task | str | os.PathLike[str], num_envs: int = 1, **settings: Any) -> VectorEnv:
    """The same for many episodes at once. ``settings`` are those of :class:`VectorEnv`."""
    return VectorEnv(task, num_envs, **settings)
