"""Diagnostics of the compiler as data, as text for terminals, and as HTML for notebooks."""

from __future__ import annotations

import html
import json
import os
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TextIO

if TYPE_CHECKING:
    from ._native import Report


@dataclass(frozen=True)
class Place:
    """A span of a text. Lines and columns count from 1, columns in characters; bytes count from 0."""

    file: str
    line: int
    column: int
    end_line: int
    end_column: int
    byte: int
    end_byte: int
    text: str = ""

    @staticmethod
    def _of(place: dict[str, Any], text: str = "") -> Place:
        start, end = place["start"], place["end"]
        return Place(
            place["file"], start["line"], start["column"], end["line"], end["column"], start["byte"], end["byte"], text
        )


@dataclass(frozen=True)
class Fix:
    """A change that resolves a diagnostic: replace every place by its text."""

    title: str
    #: Whether it surely is what was meant.
    automatic: bool
    #: (place, replacement)
    edits: tuple[tuple[Place, str], ...]


@dataclass(frozen=True)
class Diagnostic:
    """An error or a warning."""

    #: Stable code, as `E0301`.
    code: str
    #: Name of the lint, if it is one.
    lint: str | None
    #: `error` or `warning`
    severity: str
    message: str
    #: The first is where it is; the others explain.
    places: tuple[Place, ...]
    expected: str | None = None
    found: str | None = None
    help: tuple[str, ...] = ()
    fixes: tuple[Fix, ...] = field(default=())

    @property
    def line(self) -> int:
        """Line of the main place, from 1."""
        return self.places[0].line if self.places else 0

    @property
    def column(self) -> int:
        """Column of the main place in characters, from 1."""
        return self.places[0].column if self.places else 0

    @staticmethod
    def _of(data: dict[str, Any]) -> Diagnostic:
        fixes = (
            Fix(
                fix["title"],
                fix["automatic"],
                tuple((Place._of(edit["place"]), edit["replacement"]) for edit in fix["edits"]),
            )
            for fix in data["fixes"]
        )
        return Diagnostic(
            code=data["code"],
            lint=data["lint"],
            severity=data["severity"],
            message=data["message"],
            places=tuple(Place._of(label["place"], label["text"]) for label in data["labels"]),
            expected=data["expected"],
            found=data["found"],
            help=tuple(data["help"]),
            fixes=tuple(fixes),
        )


class Diagnostics(Sequence[Diagnostic]):
    """All diagnostics of a compilation, sorted by place. Shown in colour by a terminal, as HTML by a notebook."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._all = [Diagnostic._of(data) for data in json.loads(report.to_json())["diagnostics"]]

    @property
    def errors(self) -> list[Diagnostic]:
        """Those with which nothing is compiled."""
        return [diagnostic for diagnostic in self._all if diagnostic.severity == "error"]

    @property
    def warnings(self) -> list[Diagnostic]:
        """Those of lints."""
        return [diagnostic for diagnostic in self._all if diagnostic.severity == "warning"]

    def render(self, *, coloured: bool = False) -> str:
        """As text, with the source and carets below each place; `coloured` with the colours of a terminal."""
        return self._report.render(coloured)

    def __getitem__(self, index: Any) -> Any:
        return self._all[index]

    def __len__(self) -> int:
        return len(self._all)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self._all)

    def __str__(self) -> str:
        return self.render()

    def __repr__(self) -> str:
        return self.render(coloured=wants_colour(sys.stdout)) or "no errors, no warnings"

    def _repr_html_(self) -> str:
        if not self._all:
            return "<pre>no errors, no warnings</pre>"
        return f"<pre>{_to_html(self.render(coloured=True))}</pre>"


def wants_colour(stream: TextIO) -> bool:
    """Whether a stream shows colours: a terminal, unless NO_COLOR is set."""
    return stream is not None and stream.isatty() and "NO_COLOR" not in os.environ


_ESCAPE = re.compile(r"\x1b\[([0-9;]*)m")
_STYLES = {
    "1": "font-weight:bold",
    "31": "color:#c0341d",
    "32": "color:#2c7a3f",
    "33": "color:#9a6700",
    "34": "color:#1f5fbf",
    "35": "color:#8a3ffc",
    "36": "color:#0b7285",
    "90": "color:#6e6a63",
    "91": "color:#c0341d",
    "92": "color:#2c7a3f",
    "93": "color:#9a6700",
    "94": "color:#1f5fbf",
    "96": "color:#0b7285",
}


def _to_html(text: str) -> str:
    """Text with the colours of a terminal as HTML; everything else is escaped."""
    parts, open_spans, end = [], 0, 0
    for escape in _ESCAPE.finditer(text):
        parts.append(html.escape(text[end : escape.start()]))
        end = escape.end()
        codes = escape[1].split(";")
        if codes in ([""], ["0"]):
            parts.append("</span>" * open_spans)
            open_spans = 0
        else:
            parts.append(f'<span style="{";".join(_STYLES[code] for code in codes if code in _STYLES)}">')
            open_spans += 1
    parts.append(html.escape(text[end:]) + "</span>" * open_spans)
    return "".join(parts)
