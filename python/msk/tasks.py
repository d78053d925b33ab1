"""Texts to tasks: the 22 that come with the package, and one's own."""

from __future__ import annotations

import math
import os
import tomllib
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias

from . import _native
from .diagnostics import Diagnostics
from .errors import LintWarning

Parameters: TypeAlias = Mapping[str, float | str]
"""Parameters of a task: ``{"speed": 1.5}`` in the unit in which it is written, or ``{"speed": "1.5 m/s"}``."""
Weights: TypeAlias = Mapping[str, float] | str | os.PathLike[str]
"""Weights by term, or the path of a weights file."""

SUITE: str = next(path for path in _native.texts() if path.endswith("/tasks.msk"))
"""The path of the benchmark's suite in the package."""

_FAMILIES = ("stabilization", "locomotion", "interaction")

TASKS: dict[str, str] = {
    path.rsplit("/", 1)[1].removesuffix(".msk"): path
    for family in _FAMILIES
    for path in _native.texts()
    if f"/tasks/{family}/" in path
}
"""The tasks of the benchmark, by name, with the paths of their texts in the package."""


@dataclass(frozen=True)
class Channel:
    """A named part of the observation, or a metric."""

    name: str
    offset: int
    size: int
    #: As printed (`rad/s`), empty for plain numbers.
    unit: str

    @property
    def slice(self) -> slice:
        """Where it is in the observation: ``observation[..., channel.slice]``."""
        return slice(self.offset, self.offset + self.size)


@dataclass(frozen=True)
class Term:
    """A named reward term: the reward is the sum of weight times value."""

    name: str
    #: In the task as compiled; an environment's own are in its ``weights``.
    weight: float
    #: What the author allows; None where the weight is free, equal ends where it is fixed.
    range: tuple[float, float] | None
    #: As written.
    formula: str
    #: First weight, and the shares of a training between which it changes to ``weight``; None where it does not.
    schedule: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Parameter:
    """A number that may be set from outside."""

    name: str
    #: In SI units.
    value: float
    unit: str
    #: What it may be, in SI units; None without bounds.
    range: tuple[float, float] | None = None
    #: Whether it may be set for every episode, ``reset(options={"params": {...}})``; else it is a constant of the compiled task.
    per_episode: bool = False


class Explanation(str):
    """A text that shows itself as it is, in a terminal and in a notebook."""

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        import html

        return f"<pre>{html.escape(self)}</pre>"


class Task:
    """A compiled task on its body: immutable, and shared by all environments that are made of it."""

    def __init__(self, native: _native.Task, origin: tuple[Any, ...]) -> None:
        self._native = native
        self._origin = origin
        self.name: str = native.name
        self.family: str = native.family
        #: First paragraph of its documentation.
        self.summary: str = native.summary
        #: Of its meaning: the same whatever the layout of the text.
        self.hash: str = native.hash
        #: Control steps per second, Hz.
        self.control_frequency: float = native.control_frequency
        #: Physics step, s.
        self.timestep: float = native.timestep
        #: Length of an episode, control steps.
        self.horizon: int = native.horizon
        self.observation_size: int = native.observation_size
        #: Names of the muscles of the body.
        self.muscles: tuple[str, ...] = tuple(native.muscles)
        #: Names of the entries of an action: the muscles, unless the task has an `act` block.
        self.actions: tuple[str, ...] = tuple(native.actions)
        self.channels: tuple[Channel, ...] = tuple(Channel(*part) for part in native.channels)
        #: The parts of what only a critic sees, beside the observation.
        self.critic: tuple[Channel, ...] = tuple(Channel(*part) for part in native.critic)
        self.metrics: tuple[Channel, ...] = tuple(Channel(*part) for part in native.metrics)
        self.terms: tuple[Term, ...] = tuple(
            Term(name, weight, None if low is None or high is None else (low, high), formula, schedule)
            for name, weight, low, high, formula, schedule in native.terms
        )
        #: Conditions that end an episode as a failure.
        self.terminations: tuple[str, ...] = tuple(native.terminations)
        #: Conditions that end it without being failures.
        self.finishes: tuple[str, ...] = tuple(native.finishes)
        #: Those of them after which a learner values what would have followed: such an end is a truncation.
        self.bootstraps: tuple[str, ...] = tuple(
            name for name, bootstraps in zip(native.finishes, native.bootstraps, strict=True) if bootstraps
        )
        self.parameters: tuple[Parameter, ...] = tuple(Parameter(*parameter) for parameter in native.parameters)

    def explain(self, format: Literal["text", "json", "html", "latex"] = "text") -> Explanation:
        """What the compiler understood: every term as a formula with its range and its value at reset, observation,
        initial state, terminations, success."""
        return Explanation(self._native.explain(format))

    def export(self, folder: str | os.PathLike[str]) -> Path:
        """Writes the task as a module over MuJoCo's own ``MjModel`` and ``MjData``, with its model, into a folder: observation, terms,
        terminations, success, for people who stay on MuJoCo. Gives the path of the module.

        Raises:
            ValueError: the task reads what MuJoCo does not measure, or is a sequence.
        """
        files = self._native.export()
        Path(folder).mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        return Path(folder) / f"{self.name}.py"

    def reweighted(self, weights: Weights) -> Task:
        """The same task with other weights; those that are not named stay.

        Raises:
            KeyError: there is no such term.
            ValueError: the author of the task does not allow such a weight.
        """
        chosen, origin = _read_weights(weights, self.name)
        return Task(self._native.reweighted(chosen, origin), (*self._origin, chosen))

    def __repr__(self) -> str:
        return f"<Task {self.name}: {len(self.terms)} terms, {self.horizon} steps at {self.control_frequency:g} Hz>"

    def __reduce__(self) -> tuple[Any, ...]:
        return _recompiled, self._origin


def compile(
    source: str | os.PathLike[str],
    *,
    task: str | None = None,
    params: Parameters | None = None,
    weights: Weights | None = None,
) -> Task:
    """Compiles a task.

    Args:
        source: the name of one of :data:`TASKS`, or the path of a file, ``FILE@TASK`` for one of several.
        task: the same apart: which one, if the file holds several.
        params: values of its parameters.
        weights: weights of its terms, or a weights file.

    Raises:
        CompileError: the text has errors.
        ValueError: there is no such task.

    Warns:
        LintWarning: lints have something to say.
    """
    name = os.fspath(source)
    file, at, part = name.rpartition("@")
    if at and task is None and file.endswith(".msk"):
        name, task = file, part
    if name not in TASKS and not name.endswith(".msk"):
        known = ", ".join(TASKS)
        raise ValueError(f"there is no task `{name}`; a file ends in .msk, and built in are: {known}")
    return _compiled(TASKS.get(name, name), None, task, params, weights)


def compile_text(
    text: str,
    *,
    path: str | os.PathLike[str] = "text.msk",
    task: str | None = None,
    params: Parameters | None = None,
    weights: Weights | None = None,
) -> Task:
    """Compiles a task from its text; ``use`` in it is relative to the folder of ``path``. Otherwise as :func:`compile`."""
    return _compiled(os.fspath(path), text, task, params, weights)


def check(source: str | Path, *, params: Parameters | None = None, probe: bool = False) -> Diagnostics:
    """All errors and warnings of a text (a string) or of a file (a ``Path``). Never raises because of what is in it.

    Args:
        source: the text, or the path of a file.
        params: values of parameters.
        probe: also reset the tasks on their bodies and evaluate them in many poses, as ``msk check`` does (about a second).
    """
    path, text = (os.fspath(source), None) if isinstance(source, Path) else ("text.msk", source)
    return Diagnostics(_native.check(path, text, _settings(params), probe))


def _compiled(
    path: str, text: str | None, task: str | None, params: Parameters | None, weights: Weights | None
) -> Task:
    settings = _settings(params)
    native, report = _native.compile(path, text, task, settings)
    diagnostics = Diagnostics(report)
    if diagnostics:
        warnings.warn("\n" + diagnostics.render(), LintWarning, stacklevel=3)
    compiled = Task(native, (path, text, task, settings))
    return compiled if weights is None else compiled.reweighted(weights)


def _recompiled(
    path: str, text: str | None, task: str | None, settings: list[tuple[str, str]], *weights: dict[str, float]
) -> Task:
    """A task in another process."""
    native, _ = _native.compile(path, text, task, settings)
    compiled = Task(native, (path, text, task, settings))
    for chosen in weights:
        compiled = compiled.reweighted(chosen)
    return compiled


def _settings(params: Parameters | None) -> list[tuple[str, str]]:
    def written(name: str, value: float | str) -> str:
        if isinstance(value, str):
            return value
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"the parameter `{name}` is {value}: expected a finite number, or a string with a unit")
        return f"{number:.17g}"

    return [(name, written(name, value)) for name, value in (params or {}).items()]


def _read_weights(weights: Weights, task: str) -> tuple[dict[str, float], str]:
    """Weights by term, and where they come from."""
    if isinstance(weights, Mapping):
        return {name: float(value) for name, value in weights.items()}, "Python"
    path = os.fspath(weights)
    tables = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    if unexpected := [name for name, table in tables.items() if not isinstance(table, dict)]:
        raise ValueError(f"{path}: expected a table for each task (`[{task}]`), found the key `{unexpected[0]}`")
    return {name: float(value) for name, value in _flat(tables.get(task, {}))}, path


def _flat(table: dict[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """`sit.pose = 3` is a nested table in TOML, and the term `sit.pose` of a sequence here."""
    flat: list[tuple[str, Any]] = []
    for name, value in table.items():
        flat += _flat(value, f"{prefix}{name}.") if isinstance(value, dict) else [(prefix + name, value)]
    return flat
