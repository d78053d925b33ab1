"""Batches of episodes in a pipeline: while a policy decides for one, the others are stepped."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from .environment import checked_batches, prepared
from .tasks import Parameters, Task, Weights
from .vector import VectorEnv

#: Observations, rewards, terminated, truncated, infos.
Step = tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]


class Pipeline:
    """``num_envs`` episodes of a task in batches, which are stepped one after the other, in Rust threads, while the program goes on.

    >>> pipeline = msk.Pipeline("walk", num_envs=64, batch_size=32)
    >>> pipeline.reset(seed=0)
    >>> while True:
    ...     observations, rewards, terminated, truncated, infos = pipeline.recv()
    ...     pipeline.send(policy(observations))  # meanwhile the other batch is stepped

    * :meth:`recv` gives the batches in the order in which they were sent, so results do not depend on timing: slot ``i`` plays the
      episodes that slot ``i`` of ``VectorEnv(task, num_envs)`` plays, to the bit. ``infos["env_id"]`` has the slots of the batch.
    * :meth:`send` takes actions for the batch that was received first of those that have none yet.
    * Each step uses all ``threads``. Two batches hide the time of a policy that takes at most as long as a step of one batch.

    Args:
        task, params, weights, settings: as for :class:`VectorEnv`.
        num_envs: number of slots.
        batch_size: slots of a batch: a divisor of ``num_envs``; multiples of 8 fill the lanes.
    """

    def __init__(
        self,
        task: Task | str | os.PathLike[str],
        num_envs: int,
        batch_size: int,
        *,
        params: Parameters | None = None,
        weights: Weights | None = None,
        **settings: Any,
    ) -> None:
        count = checked_batches(num_envs, batch_size)
        self.task = prepared(task, params, weights)
        self.num_envs, self.batch_size = num_envs, batch_size
        #: The batches. Weights, progress and states of one are set and read between its ``recv`` and the ``send`` after it.
        self.batches = tuple(VectorEnv(self.task, batch_size, **settings) for _ in range(count))
        # One queue: a step of one batch after the other, in the order in which they are sent.
        queue = _native.Queue()
        for batch in self.batches:
            batch._queue = queue
        self.single_observation_space = self.batches[0].single_observation_space
        self.single_action_space = self.batches[0].single_action_space
        # Numbers of the batches: on their way with what a reset gave, or None for a step; and those that wait for actions.
        self._sent: deque[tuple[int, Step | None]] = deque()
        self._received: deque[int] = deque()

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, params: Mapping[str, float] | None = None
    ) -> None:
        """Begins an episode in every slot, as :meth:`VectorEnv.reset`; ``params`` are parameters that the task declares ``per episode``.
        :meth:`recv` gives the first observations, with rewards of 0, batch by batch. What is under way is waited for and dropped.

        Raises:
            ValueError: a wrong number of seeds, or a parameter that cannot be.
        """
        while self._sent:
            self.recv()
        self._received.clear()
        if seed is not None and not isinstance(seed, (int, np.integer)) and len(seed) != self.num_envs:
            raise ValueError(f"expected one seed per environment, {self.num_envs}, found {len(seed)}")
        for number, batch in enumerate(self.batches):
            first = number * self.batch_size
            if seed is None:
                own: int | Sequence[int | None] | None = None
            elif isinstance(seed, (int, np.integer)):
                own = int(seed) + first
            else:
                own = seed[first : first + self.batch_size]
            observations, infos = batch.reset(seed=own, options={"params": dict(params or {})})
            none = np.zeros(self.batch_size, np.bool_)
            self._sent.append((number, (observations, np.zeros(self.batch_size), none, none.copy(), infos)))

    def recv(self) -> Step:
        """Waits for the batch that was sent first; gives what :meth:`VectorEnv.step` gives of it, and ``infos["env_id"]``.

        Raises:
            RuntimeError: no batch is under way: all wait for actions, or no episode has begun.
        """
        if not self._sent:
            raise RuntimeError("no batch is under way: call reset(), or send() for a batch that was received")
        number, begun = self._sent[0]
        observations, rewards, terminated, truncated, infos = begun or self.batches[number].recv()
        self._sent.popleft()
        self._received.append(number)
        slots = np.arange(number * self.batch_size, (number + 1) * self.batch_size)
        return observations, rewards, terminated, truncated, infos | {"env_id": slots}

    def send(self, actions: NDArray[Any]) -> None:
        """Begins a control step of the batch that was received first of those without actions, and returns at once.

        Raises:
            TypeError, ValueError: actions that are not in the action space, of shape ``(batch_size, entries)``; nothing is sent then.
            RuntimeError: no batch waits for actions.
        """
        if not self._received:
            raise RuntimeError("no batch waits for actions: call recv() before send()")
        number = self._received[0]
        self.batches[number].send(actions)
        self._received.popleft()
        self._sent.append((number, None))
