"""Collects rollouts on a node."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..tasks import Task
from ..vector import VectorEnv
from .policies import Acted, Policy, named
from .rollout import Rollout, Seconds


@dataclass(frozen=True)
class Plan:
    """What all rollouts of a collector have in common."""

    task: Task
    #: Slots of a group.
    batch_size: int
    #: Control steps of a rollout.
    steps: int
    seed: int
    threads: int
    #: Of the environments: see :class:`msk.VectorEnv`.
    settings: dict[str, Any]

    def slots(self, group: int) -> NDArray[np.int64]:
        """The numbers of the slots of a group."""
        return np.arange(group * self.batch_size, (group + 1) * self.batch_size)


@dataclass(frozen=True)
class Order:
    """Which rollout is to be collected: see :class:`Rollout`."""

    group: int
    number: int
    version: int
    restarts: int


class Worker:
    """Steps the groups that are given to it, in one process and in Rust threads."""

    def __init__(self, plan: Plan, policy: Policy | str) -> None:
        self.plan = plan
        self.policy = named(policy, plan.task) if isinstance(policy, str) else policy
        #: Environments, with how often their group had begun anew, and the observations that the next action answers to.
        self._groups: dict[int, tuple[int, VectorEnv, NDArray[Any]]] = {}

    def ready(self) -> None:
        """Returns once the worker has started."""

    def rollout(self, order: Order, state: Any) -> Rollout:
        """Collects a rollout. A group that is not here, or is to begin anew, begins."""
        begun = time.perf_counter()
        stepping = acting = 0.0
        envs, observations = self._take(order)
        native, task = envs._native, self.plan.task
        # Of the place in the plan alone: neither of the node nor of what was collected before.
        generator = np.random.default_rng([self.plan.seed, order.group, order.restarts, order.number])
        table, ends = _Table(self.plan), _Ends(task, observations)
        for step in range(self.plan.steps):
            table.put(step, "observations", observations)
            table.put(step, "critic_observations", native.critic_observations())
            start = time.perf_counter()
            actions, extras = _parts(self.policy(observations, state, generator))
            acting += time.perf_counter() - start
            start = time.perf_counter()
            observations, rewards, terminated, truncated, ended = native.step(actions)
            stepping += time.perf_counter() - start
            for name, rows in (("actions", actions), ("rewards", rewards), *extras.items()):
                table.put(step, name, rows)
            table.put(step, "terminated", terminated)
            table.put(step, "truncated", truncated)
            if ended.any():
                ends.put(step, envs)
        self._groups[order.group] = (order.restarts, envs, observations)
        own = ("observations", "critic_observations", "actions", "rewards", "terminated", "truncated")
        arrays: dict[str, Any] = {name: table.arrays.pop(name) for name in own}
        return Rollout(
            **arrays,
            **ends.arrays(),
            group=order.group,
            slots=self.plan.slots(order.group),
            number=order.number,
            version=order.version,
            restarts=order.restarts,
            last_observations=observations,
            last_critic_observations=native.critic_observations(),
            extras=table.arrays,
            seconds=Seconds(stepping, acting, time.perf_counter() - begun),
        )

    def _take(self, order: Order) -> tuple[VectorEnv, NDArray[Any]]:
        """The environments of a group, which come back when the rollout is whole: one that fails has lost them."""
        known = self._groups.pop(order.group, None)
        if known is not None and known[0] == order.restarts:
            return known[1:]
        envs = VectorEnv(self.plan.task, self.plan.batch_size, threads=self.plan.threads, **self.plan.settings)
        # A group that begins anew plays no episode once more.
        first = order.restarts << 32
        keys: list[_Key | None] = [(self.plan.seed + int(slot), first) for slot in self.plan.slots(order.group)]
        return envs, envs._native.reset(keys)[0]


#: Seed and index of an episode.
_Key = tuple[int, int]


def _parts(acted: Acted) -> tuple[NDArray[Any], dict[str, NDArray[Any]]]:
    """Actions, and what a learner wants beside them."""
    return (acted[0], dict(acted[1])) if isinstance(acted, tuple) else (acted, {})


class _Table:
    """Rows of each step, in arrays whose length is known beforehand."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.arrays: dict[str, NDArray[Any]] = {}

    def put(self, step: int, name: str, rows: NDArray[Any]) -> None:
        rows = np.asarray(rows)
        if step == 0:
            if name in self.arrays or rows.shape[:1] != (self.plan.batch_size,):
                expected = f"an array of its own with a row for each of {self.plan.batch_size} slots"
                raise ValueError(f"`{name}` of the policy has the shape {rows.shape}: expected {expected}")
            self.arrays[name] = np.empty((self.plan.steps, *rows.shape), rows.dtype)
        array = self.arrays.get(name)
        if array is None or array.shape[1:] != rows.shape or array.dtype != rows.dtype:
            before = "nothing" if array is None else f"{array.dtype} of shape {array.shape[1:]}"
            raise ValueError(f"`{name}` of the policy is {rows.dtype} of shape {rows.shape}, and was {before} at first")
        array[step] = rows


class _Ends:
    """The episodes that end."""

    def __init__(self, task: Task, observations: NDArray[Any]) -> None:
        self.task = task
        self.places: list[tuple[int, int]] = []
        self.records: list[tuple[float, int, bool, int, int]] = []
        self.term_returns: list[list[float]] = []
        # Without any end there are no rows, of the right width.
        self.final = [observations[:0]]
        self.final_critic = [np.zeros((0, sum(part.size for part in task.critic)), observations.dtype)]

    def put(self, step: int, envs: VectorEnv) -> None:
        """Takes down those of a step."""
        ends = envs._native.ends()
        slots = [end[0] for end in ends]
        for slot, _, (seed, index), success, steps, total, totals, _, _ in ends:
            self.places.append((step, slot))
            self.records.append((total, steps, success, seed, index))
            self.term_returns.append(totals)
        self.final.append(envs._native.final_observations()[slots])
        self.final_critic.append(envs._native.final_critic_observations()[slots])

    def arrays(self) -> dict[str, Any]:
        """What a :class:`Rollout` has of them."""
        count = len(self.places)
        kinds = {
            "return": np.float64,
            "steps": np.int64,
            "is_success": np.bool_,
            "seed": np.int64,
            "episode_index": np.int64,
        }
        columns = list(zip(*self.records, strict=True)) if count else [()] * len(kinds)
        episodes: dict[str, NDArray[Any]] = {
            name: np.array(column, kind) for (name, kind), column in zip(kinds.items(), columns, strict=True)
        }
        episodes["term_returns"] = np.array(self.term_returns, np.float64).reshape(count, len(self.task.terms))
        return {
            "ends": np.array(self.places, np.int64).reshape(count, 2),
            "final_observations": np.concatenate(self.final),
            "final_critic_observations": np.concatenate(self.final_critic),
            "episodes": episodes,
        }
