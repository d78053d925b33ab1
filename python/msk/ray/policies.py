"""What acts in rollouts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..agents import Agent
from ..tasks import Task

Acted: TypeAlias = NDArray[Any] | tuple[NDArray[Any], Mapping[str, NDArray[Any]]]
"""Actions of shape (slots, entries), alone or with arrays that a learner wants of the same moment, such as log-probabilities or values, with a
row for each slot."""


class Policy(Protocol):
    """Anything that acts on the observations of a batch of slots."""

    def __call__(self, observations: NDArray[Any], state: Any, generator: np.random.Generator) -> Acted:
        """Acts.

        Args:
            observations: shape (slots, width), always as many slots.
            state: what was broadcast last before the rollout began, such as the weights of a network; the same object in all steps of a
                rollout, read-only arrays in it.
            generator: for all chance, so that the same seed gives the same rollouts.
        """


def named(policy: str, task: Task) -> Policy:
    """The policy that a name stands for: ``zero``, ``random``, ``agents`` (the agent that comes with the package) or ``agent FOLDER``.

    Raises:
        ValueError: any other name, or an agent that does not fit the task.
    """
    word, _, folder = policy.partition(" ")
    if policy == "zero":
        return _Rest(task)
    if policy == "random":
        return _Random(task)
    if policy == "agents":
        return _Trained(Agent.built_in(task))
    if word == "agent" and folder.strip():
        return _Trained(Agent(folder.strip(), task))
    raise ValueError(
        f"there is no policy `{policy}` for rollouts: expected a function, `zero`, `random`, `agents` or `agent FOLDER`; "
        "others need more than observations, and `msk.ray.collect` plays whole episodes under them"
    )


class _Rest:
    def __init__(self, task: Task) -> None:
        self.action = np.full(len(task.actions), task._native.rest, np.float32)

    def __call__(self, observations: NDArray[Any], state: Any, generator: np.random.Generator) -> NDArray[Any]:
        return np.broadcast_to(self.action, (len(observations), len(self.action)))


class _Random:
    def __init__(self, task: Task) -> None:
        self.entries = len(task.actions)

    def __call__(self, observations: NDArray[Any], state: Any, generator: np.random.Generator) -> NDArray[Any]:
        return 2 * generator.random((len(observations), self.entries), np.float32) - 1


class _Trained:
    def __init__(self, agent: Agent) -> None:
        self.agent = agent

    def __call__(self, observations: NDArray[Any], state: Any, generator: np.random.Generator) -> NDArray[Any]:
        return self.agent.act(observations)
