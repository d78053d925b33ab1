"""Rollouts for a learner, from all nodes of a cluster."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from typing import Any, Self

import ray

from ..environment import checked_batches, checked_seed, prepared
from ..tasks import Parameters, Task, Weights
from .crew import Crew
from .policies import Policy
from .rollout import Rollout, Seconds
from .shards import smallest_node
from .worker import Order, Plan


@dataclass
class _Group:
    """Slots that are stepped together."""

    #: Where: a place of the crew.
    place: int
    #: The actor that has its environments; None before the first rollout.
    actor: Any = None
    #: How many it has given.
    rollouts: int = 0
    restarts: int = 0


class Collector:
    """Collects rollouts of a task on all nodes of the cluster to which Ray is connected (``ray.init``): one actor for each node, which steps
    groups of ``batch_size`` slots in Rust threads, under a policy.

    >>> with msk.ray.Collector("walk", policy, num_envs=64, batch_size=16, steps=128) as collector:
    ...     for _ in range(100):
    ...         collector.broadcast(state)
    ...         state = learn(state, collector.collect())  # a rollout of each group, in their order

    :meth:`collect` waits for all groups. What it gives depends on the arguments of the collector and on the states alone, to the bit: on any
    number of nodes, actors and threads. With :meth:`next` the learner works while all groups are collected; each rollout tells the version of
    the state that acted.

    When a worker dies, another one takes its place, or its groups go to those that are left. Their environments are lost with it: after the
    n-th loss of its group, slot i goes on with episode ``n * 2**32`` of the seed ``seed + i``, so that no episode is played twice.
    ``Rollout.restarts`` is n.

    Args:
        task, params, weights: as for :class:`msk.VectorEnv`; nodes read files by the same path.
        policy: a function or an object as :class:`Policy` says, of which every actor has a copy, or a name: ``zero``, ``random``, ``agents``,
            ``agent FOLDER``.
        num_envs: number of slots, in all.
        batch_size: slots of a group: a divisor of ``num_envs``. The policy acts for one group at a time; multiples of 8 times ``threads``
            fill the lanes of the processors.
        steps: control steps of a rollout.
        seed: of all chance: slot i plays the episodes of ``seed + i``.
        threads: processors of an actor; by default as many as the smallest node has.
        settings: others of :class:`msk.VectorEnv`. Actions outside of [-1, 1] are clipped unless ``clip_actions=False``.

    Raises:
        ValueError: numbers that do not fit each other.
        TimeoutError: the workers do not start, as without free processors.
    """

    def __init__(
        self,
        task: Task | str | os.PathLike[str],
        policy: Policy | str,
        *,
        num_envs: int,
        batch_size: int,
        steps: int,
        seed: int = 0,
        threads: int | None = None,
        params: Parameters | None = None,
        weights: Weights | None = None,
        **settings: Any,
    ) -> None:
        count = checked_batches(num_envs, batch_size)
        if steps < 1:
            raise ValueError(f"expected at least one step, found {steps}")
        self.task = prepared(task, params, weights)
        checked_seed(seed + num_envs - 1)
        settings = {"clip_actions": True, **settings}
        plan = Plan(self.task, batch_size, steps, checked_seed(seed), threads or smallest_node(), settings)
        self._crew = Crew(plan, policy, count)
        self._groups = [_Group(number % len(self._crew)) for number in range(count)]
        #: Rollouts that are under way, with the numbers of their groups, in the order in which they were ordered.
        self._pending: dict[Any, int] = {}
        self._version, self._state = 0, ray.put(None)
        self._begun = time.perf_counter()
        self._seconds = Seconds()

    @property
    def version(self) -> int:
        """How many states have been broadcast."""
        return self._version

    @property
    def seconds(self) -> Seconds:
        """Where the time of all rollouts so far went, of all actors together; ``seconds.host_share`` is the share outside of Rust."""
        return self._seconds

    @property
    def waiting_share(self) -> float:
        """Share of the actors' time since the collector began in which they collected nothing: the learner's, in :meth:`collect`; 0..1."""
        whole = len(self._crew) * (time.perf_counter() - self._begun)
        return max(0.0, 1 - self._seconds.whole / whole)

    def broadcast(self, state: Any) -> int:
        """Sends a state, such as the weights of a network, to all actors: rollouts that begin from now on act under it. Gives its version, 1
        for the first."""
        self._state = ray.put(state)
        self._version += 1
        return self._version

    def collect(self) -> list[Rollout]:
        """Collects a rollout of each group, under the state that was broadcast last, and waits for all of them.

        Raises:
            RuntimeError: rollouts are under way.
            ray.exceptions.RayError: workers die again and again. What a policy raises is raised here, too; groups that were under way begin
                anew after that, as if they were lost.
        """
        if self._pending:
            raise RuntimeError(
                f"{len(self._pending)} rollouts are under way: take them by next(), or make a collector for each use"
            )
        for number in range(len(self._groups)):
            self._order(number)
        found: dict[int, Rollout] = {}
        while self._pending:
            rollout = self._receive()
            found[rollout.group] = rollout
        return [found[number] for number in range(len(self._groups))]

    def next(self) -> Rollout:
        """Waits for the first rollout that is ready, of whichever group, and lets the group go on under the state that was broadcast last:
        meanwhile the learner learns. ``collector.version - rollout.version`` is how many states have been broadcast since it began.

        Raises:
            ray.exceptions.RayError: as for :meth:`collect`.
        """
        under_way = set(self._pending.values())
        for number in range(len(self._groups)):
            if number not in under_way:
                self._order(number)
        rollout = self._receive()
        self._order(rollout.group)
        return rollout

    def close(self) -> None:
        """Ends the workers."""
        self._pending.clear()
        self._crew.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _order(self, number: int) -> None:
        """Begins the next rollout of a group."""
        group = self._groups[number]
        actor = self._crew.actor(group.place)
        if group.actor is not None and group.actor is not actor:
            group.restarts += 1
        group.actor = actor
        order = Order(number, group.rollouts, self._version, group.restarts)
        self._pending[actor.rollout.remote(order, self._state)] = number

    def _abandon(self, numbers: list[int]) -> None:
        """Lets groups begin anew, which may stand in the middle of a rollout."""
        self._pending.clear()
        for number in numbers:
            self._groups[number].restarts += 1

    def _receive(self) -> Rollout:
        """The first rollout that is ready. Groups of workers that died meanwhile begin anew."""
        while True:
            [ready], _ = ray.wait(list(self._pending), num_returns=1)
            number = self._pending.pop(ready)
            group = self._groups[number]
            try:
                rollout: Rollout = ray.get(ready)
            except (ray.exceptions.RayActorError, ray.exceptions.ObjectLostError) as error:
                self._crew.replace(group.actor, error)
                self._order(number)
                continue
            except ray.exceptions.RayTaskError:
                self._abandon([number, *self._pending.values()])
                raise
            self._crew.praise()
            group.rollouts += 1
            self._seconds += rollout.seconds
            return rollout
