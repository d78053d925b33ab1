"""The weights of an environment, which change while it runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Protocol

from .tasks import Task


class _Weighted(Protocol):
    def last_weights(self) -> list[float]: ...
    def set_weight(self, index: int, value: float, /) -> None: ...


class LiveWeights(Mapping[str, float]):
    """The weights, by term. ``env.weights["upright"] = 7`` holds from the next step on; nothing is compiled anew. Of a weight that is
    scheduled over a training (``10 -> 5 over 30 %``) it is the last one, whatever the ``progress`` of the environment.

    In a vector environment they are those of all its episodes.
    """

    def __init__(self, native: _Weighted, task: Task) -> None:
        self._native = native
        self._index = {term.name: index for index, term in enumerate(task.terms)}
        self._task = task.name

    def __getitem__(self, term: str) -> float:
        return self._native.last_weights()[self._place(term)]

    def __setitem__(self, term: str, value: float) -> None:
        self._native.set_weight(self._place(term), float(value))

    def update(self, weights: Mapping[str, float]) -> None:
        """Sets several: all of them, or none if one is not allowed."""
        before = self._native.last_weights()
        try:
            for term, value in weights.items():
                self[term] = value
        except (KeyError, ValueError, TypeError):
            for index, value in enumerate(before):
                if self._native.last_weights()[index] != value:
                    self._native.set_weight(index, value)
            raise

    def _place(self, term: str) -> int:
        try:
            return self._index[term]
        except KeyError:
            known = ", ".join(self._index)
            raise KeyError(f"the task `{self._task}` has no term `{term}`; it has: {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)

    def __repr__(self) -> str:
        return f"LiveWeights({dict(zip(self._index, self._native.last_weights(), strict=True))})"
