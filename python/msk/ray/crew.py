"""The actors of a collector, one for each node, and what takes the place of one that dies."""

from __future__ import annotations

from typing import Any

import ray
from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

from .policies import Policy
from .shards import node_processors
from .worker import Plan, Worker

#: How long a worker may take to start, s.
_STARTING = 180.0
#: Workers that may die one after the other, without a rollout in between.
_DEATHS = 5


class Crew:
    """As many actors as there are nodes with processors for one, ``most`` at most. A place is the number of an actor, whichever it is.

    Raises:
        TimeoutError: no node has so many processors, or they are not free.
    """

    def __init__(self, plan: Plan, policy: Policy | str, most: int) -> None:
        self._plan, self._policy = plan, ray.put(policy)
        self._nodes = [name for name, count in node_processors().items() if count >= plan.threads][:most]
        if not self._nodes:
            raise TimeoutError(f"no node of the cluster has {plan.threads} processors: choose fewer with `threads`")
        self._actors = [self._made(node) for node in self._nodes]
        self._deaths = 0
        try:
            ray.get([actor.ready.remote() for actor in self._actors], timeout=_STARTING)
        except ray.exceptions.GetTimeoutError:
            self.close()
            raise TimeoutError(
                f"{len(self._actors)} workers of {plan.threads} processors did not start within {_STARTING:.0f} s: "
                "others use the processors of the cluster; choose fewer with `threads`"
            ) from None

    def __len__(self) -> int:
        return len(self._actors)

    def actor(self, place: int) -> Any:
        """The actor in a place."""
        return self._actors[place]

    def praise(self) -> None:
        """A rollout has come: deaths before it do not count any more."""
        self._deaths = 0

    def replace(self, dead: Any, error: ray.exceptions.RayError) -> None:
        """Puts another actor where a dead one was, on its node or, if that is gone, on any other; where none starts, one that is left.

        Raises:
            ray.exceptions.RayError: ``error``, if workers die again and again, or none is left.
        """
        places = [place for place, actor in enumerate(self._actors) if actor is dead]
        if not places:
            return
        self._deaths += 1
        ray.kill(dead)
        left = [actor for actor in self._actors if actor is not dead]
        if self._deaths > _DEATHS:
            raise error
        fresh = self._made(self._nodes[places[0]])
        try:
            ray.get(fresh.ready.remote(), timeout=_STARTING)
        except (ray.exceptions.GetTimeoutError, ray.exceptions.RayActorError):
            ray.kill(fresh)
            if not left:
                raise error from None
            fresh = left[places[0] % len(left)]
        for place in places:
            self._actors[place] = fresh

    def close(self) -> None:
        """Ends the actors."""
        for actor in self._actors:
            ray.kill(actor)

    def _made(self, node: str) -> Any:
        options: dict[str, Any] = {
            "num_cpus": self._plan.threads,
            "max_restarts": 0,
            "scheduling_strategy": NodeAffinitySchedulingStrategy(node, soft=True),
        }
        return ray.remote(**options)(Worker).remote(self._plan, self._policy)
