"""What can go wrong, as exceptions and warnings."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from .diagnostics import Diagnostics, wants_colour

if TYPE_CHECKING:
    from ._native import Report


class CompileError(ValueError):
    """A text that does not compile; ``diagnostics`` holds all its errors and warnings."""

    def __init__(self, report: Report) -> None:
        self.diagnostics = Diagnostics(report)
        super().__init__(self.diagnostics.render())

    def __str__(self) -> str:
        return "\n" + self.diagnostics.render(coloured=wants_colour(sys.stderr))

    def __reduce__(self) -> tuple[type[RuntimeError], tuple[str]]:
        # Between processes only the text travels.
        return RuntimeError, (self.diagnostics.render(),)

    def _render_traceback_(self) -> list[str]:
        """What IPython and Jupyter show: the diagnostics in colour, without the frames of this package."""
        return ["CompileError:", *self.diagnostics.render(coloured=True).splitlines()]


class LintWarning(UserWarning):
    """A text that compiles, with lints that warn."""


class InternalError(RuntimeError):
    """A defect of msk: please report it."""
