"""The finding itself, and the three short ways to make one."""

from __future__ import annotations

import enum
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from wedmcam.diag.codes import CODES
from wedmcam.diag.shown import shortened
from wedmcam.diag.span import Span


class Severity(enum.IntEnum):
    """How bad it is. An error stops the compiler after the stage that found it."""

    NOTE = 0
    WARNING = 1
    ERROR = 2

    def __str__(self) -> str:
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    Attributes:
        severity: note, warning or error.
        code: a key of ``diag.codes.CODES``.
        message: what is wrong, with numbers (mm) and places; of `shown.LONGEST` characters at most.
        span: where, or None when it is about no place.
        notes: further sentences, each with a place of its own.
        hint: how to mend it.
        points_mm: places in the drawing, (x, y) in mm, that a picture can mark.
        count: how many things of the drawing or program it is about.
        times: how often this very finding was made.
        rest: it stands for findings of its kind that are not listed (see `capped`).
    """

    severity: Severity
    code: str
    message: str
    span: Span | None = None
    notes: tuple[tuple[str, Span | None], ...] = ()
    hint: str | None = None
    points_mm: tuple[tuple[float, float], ...] = ()
    count: int = 1
    times: int = 1
    rest: bool = False

    def __post_init__(self) -> None:
        assert self.code in CODES, f"finding with an unlisted code: {self.code}"
        object.__setattr__(self, "message", shortened(self.message))


def error(code: str, message: str, span: Span | None = None, **more: Any) -> Diagnostic:
    """Return a finding that stops the compiler; fields as in `Diagnostic`."""
    return Diagnostic(Severity.ERROR, code, message, span, **more)


def warning(code: str, message: str, span: Span | None = None, **more: Any) -> Diagnostic:
    """Return a finding that ``--strict`` turns into an error; fields as in `Diagnostic`."""
    return Diagnostic(Severity.WARNING, code, message, span, **more)


def note(code: str, message: str, span: Span | None = None, **more: Any) -> Diagnostic:
    """Return a finding that reports a repair or a fact; fields as in `Diagnostic`."""
    return Diagnostic(Severity.NOTE, code, message, span, **more)


def has_errors(found: Iterable[Diagnostic]) -> bool:
    """Return whether any finding is an error."""
    return any(d.severity is Severity.ERROR for d in found)
