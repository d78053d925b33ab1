"""Rollouts: what a learner gets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Seconds:
    """Where the time of rollouts went, s."""

    #: Steps and resets, within Rust.
    stepping: float = 0.0
    #: The policy.
    acting: float = 0.0
    #: All of it.
    whole: float = 0.0

    def __add__(self, other: Seconds) -> Seconds:
        return Seconds(self.stepping + other.stepping, self.acting + other.acting, self.whole + other.whole)

    @property
    def host_share(self) -> float:
        """Share outside of Rust, policy and all, 0..1."""
        return 1 - self.stepping / self.whole if self.whole > 0 else 0.0


@dataclass(frozen=True)
class Rollout:
    """T control steps in the N slots of a group. Arrays that came through Ray's object store are read-only views of it.

    E episodes ended meanwhile. Row e of what is of ends belongs to ``ends[e]``, a step and a slot of this rollout.
    """

    #: Which group, and the numbers of its slots, shape (N,): slot i plays episodes of the seed ``seed + i``.
    group: int
    slots: NDArray[np.int64]
    #: Rollouts of the group before this one.
    number: int
    #: Of the state under which the policy acted: how many had been broadcast. What the collector's has more is its staleness.
    version: int
    #: How often the group was lost with its worker, and has begun anew: see :class:`Collector`.
    restarts: int
    #: Shape (T, N, width): what each action answers to.
    observations: NDArray[Any]
    #: Shape (T, N, entries).
    actions: NDArray[Any]
    #: Shape (T, N).
    rewards: NDArray[np.float64]
    #: Shape (T, N): what would have followed has no value; or it has: :meth:`bootstrapped` counts it.
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    #: Shape (N, width): what follows the last step, in the next rollout of the group.
    last_observations: NDArray[Any]
    #: Shape (E, 2).
    ends: NDArray[np.int64]
    #: Shape (E, width): the last observations of the episodes that ended.
    final_observations: NDArray[Any]
    #: What only a critic saw, as the three arrays of observations; their last length is 0 for a task without a block ``critic``.
    critic_observations: NDArray[Any]
    last_critic_observations: NDArray[Any]
    final_critic_observations: NDArray[Any]
    #: What else the policy gave, each of shape (T, N, ...).
    extras: dict[str, NDArray[Any]]
    #: Of the episodes that ended, shape (E,): ``return``, ``steps``, ``is_success``, ``seed``, ``episode_index``; ``term_returns``, shape (E, terms).
    episodes: dict[str, NDArray[Any]]
    #: Where the time went.
    seconds: Seconds

    def bootstrapped(self, values: NDArray[Any], discount: float) -> NDArray[np.float64]:
        """The rewards, with ``discount`` times the value of what would have followed where an episode was truncated: shape (T, N).

        Args:
            values: of the final observations, shape (E,); those of terminations do not count.
            discount: of one control step.
        """
        values = np.asarray(values, np.float64)
        if values.shape != (len(self.ends),):
            raise ValueError(f"expected a value for each of {len(self.ends)} final observations, found {values.shape}")
        steps, slots = self.ends.T
        rewards = self.rewards.copy()
        rewards[steps, slots] += discount * np.where(self.truncated[steps, slots], values, 0)
        return rewards
