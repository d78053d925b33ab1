"""What ``msk train`` made, as something that acts."""

from __future__ import annotations

import os
from typing import Any

from numpy.typing import NDArray

from . import _native
from .tasks import Task, compile


class Agent:
    """A trained network that acts on the observations of its task, as the policy ``agent FOLDER`` of the command line does.

    >>> env = msk.make("stand")
    >>> agent = msk.Agent.built_in(env.task)  # or msk.Agent("results/stand", env.task)
    >>> observation, info = env.reset(seed=0)
    >>> observation, reward, *_ = env.step(agent.act(observation))
    """

    def __init__(self, folder: str | os.PathLike[str], task: Task | str, *, any_task: bool = False) -> None:
        """The agent in a folder that ``msk train`` wrote: that of an agent, or of a training, of which it is the one that succeeded most.

        ``ValueError`` with the reason where it was not trained on this task and body; ``any_task`` allows those that only mean something
        else.
        """
        self._adopt(_native.Agent(os.fspath(folder), _compiled(task)._native, any_task))

    @classmethod
    def built_in(cls, task: Task | str) -> Agent:
        """The agent that comes with the package for a task of the benchmark; ``ValueError`` where there is none."""
        agent = cls.__new__(cls)
        agent._adopt(_native.Agent.built_in(_compiled(task)._native))
        return agent

    def _adopt(self, native: _native.Agent) -> None:
        self._native = native
        #: Name of the task that it was trained on, algorithm, random seed, control steps of the training, and those that an action lasts for.
        self.task, self.algorithm, self.seed, self.steps, self.action_repeat = native.description()

    def act(self, observation: NDArray[Any]) -> NDArray[Any]:
        """The action, float32 in [-1, 1], of shape (entries,) for an observation (numbers,), or (slots, entries) for (slots, numbers).

        Of an agent whose ``action_repeat`` is n, call this at the control steps 0, n, 2n and so on of an episode, and repeat the action in
        between.
        """
        return self._native.act(observation)

    def predict(
        self,
        observation: NDArray[Any],
        state: Any = None,
        episode_start: Any = None,
        deterministic: bool = True,
    ) -> tuple[NDArray[Any], Any]:
        """The action and the state, for what expects a model of Stable-Baselines3, such as its ``evaluate_policy``. It has no state, and
        acts without chance."""
        return self.act(observation), state

    def __repr__(self) -> str:
        return f"Agent(task={self.task!r}, algorithm={self.algorithm!r}, seed={self.seed}, steps={self.steps})"


def _compiled(task: Task | str) -> Task:
    return compile(task) if isinstance(task, str) else task
