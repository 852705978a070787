"""The finding itself, and the three short ways to make one.

A finding carries a sentence with gaps and what stands in them, `error("gap", "the ends are
{gap_mm:.3f} mm apart", span, gap_mm=0.02)`: the text is formed when it is printed, and a program
that reads findings need not take sentences apart.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from wedmcam.diag.codes import CODES
from wedmcam.diag.shown import shortened
from wedmcam.diag.span import Span

#: Whether a finding whose values do not fit its templates is refused where it is made. The tests
#: want that; a user is better served by the bare template.
CHECKS = False


class Severity(enum.IntEnum):
    """How bad it is. An error stops the compiler after the stage that found it."""

    NOTE = 0
    WARNING = 1
    ERROR = 2

    def __str__(self) -> str:
        return self.name.lower()


class Place(NamedTuple):
    """A place in the drawing, mm, as a value of a finding.

    ``{place:xy}`` leaves the unit out, where another place follows that has it.

    >>> f"it starts at {Place.of_um(1000.0, -0.1)}"
    'it starts at (1.000, 0.000) mm'
    """

    x_mm: float
    y_mm: float

    @classmethod
    def of_um(cls, x: float, y: float) -> Place:
        """Return the place of coordinates in um."""
        return cls(float(x) / 1000.0, float(y) / 1000.0)

    def __str__(self) -> str:
        return f"({self.x_mm:z.3f}, {self.y_mm:z.3f}) mm"

    def __format__(self, spec: str) -> str:
        return str(self).removesuffix(" mm") if spec == "xy" else format(str(self), spec)


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One finding.

    Attributes:
        severity: note, warning or error.
        code: a key of ``diag.codes.CODES``.
        template: what is wrong, in the form of `str.format`, with a field for each value.
        span: where, or None when it is about no place.
        notes: further sentences, each with a place of its own.
        hint_template: how to mend it; a template of the same values.
        points_mm: places in the drawing, (x, y) in mm, that a picture can mark.
        count: how many things of the drawing or program it is about.
        times: how often this very finding was made.
        rest: it stands for findings of its kind that are not listed (see `capped`).
        values: name -> number, text or `Place`, or a list of them, printed with commas: what the
            fields of the templates say. Names of lengths end with their unit (``gap_mm``).
            ``{count}`` is always there.
    """

    severity: Severity
    code: str
    template: str
    span: Span | None = None
    notes: tuple[tuple[str, Span | None], ...] = ()
    hint_template: str | None = None
    points_mm: tuple[tuple[float, float], ...] = ()
    count: int = 1
    times: int = 1
    rest: bool = False
    values: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        assert self.code in CODES, f"finding with an unlisted code: {self.code}"
        assert not CHECKS or self._forms(), f"{self.code}: {self.template!r} and its values differ"

    @property
    def message(self) -> str:
        """What is wrong, with numbers (mm) and places; of `shown.LONGEST` characters at most."""
        return shortened(self._formed(self.template))

    @property
    def hint(self) -> str | None:
        """How to mend it; as long as the message at most."""
        return None if self.hint_template is None else shortened(self._formed(self.hint_template))

    def extended(self, more: str = "", *, hint: str = "", **values: Any) -> Diagnostic:
        """Return the finding with more text behind its own and its hint: templates, and values.

        Names of values are new, or mean the same as in the finding.

        >>> note("join", "{count} gaps closed", count=3).extended("; {few} small", few=2).message
        '3 gaps closed; 2 small'
        """
        return replace(
            self,
            template=self.template + more,
            hint_template=(self.hint_template or "") + hint or None,
            values={**self.values, **values},
        )

    def with_hint(self, hint: str, **values: Any) -> Diagnostic:
        """Return the finding with another hint, a template, and more values.

        >>> note("join", "a gap", hint="close it").with_hint("draw {what}", what="an arc").hint
        'draw an arc'
        """
        return replace(self, hint_template=hint, values={**self.values, **values})

    def _formed(self, template: str) -> str:
        try:
            return self._filled(template)
        except (LookupError, ValueError, TypeError, AttributeError):
            return (
                f"{template} {dict(self.values)}"  # a fault of ours that must not hide the finding
            )

    def _filled(self, template: str) -> str:
        values = {
            name: ", ".join(map(str, value)) if type(value) in (list, tuple) else value
            for name, value in self.values.items()
        }
        return template.format_map({"count": self.count, **values})

    def _forms(self) -> bool:
        """Return whether the values fill the templates."""
        try:
            self._filled(self.template)
            self._filled(self.hint_template or "")
        except (LookupError, ValueError, TypeError, AttributeError):
            return False
        return True


#: Arguments of `error`, `warning`, `note` that are fields of the finding; others are values.
_FIELDS = {"hint": "hint_template", "notes": "notes", "points_mm": "points_mm", "count": "count"}


def error(code: str, template: str, span: Span | None = None, **values: Any) -> Diagnostic:
    """Return a finding that stops the compiler.

    ``hint``, ``notes``, ``points_mm`` and ``count`` are those of `Diagnostic`; every other keyword
    is a value of the templates.

    >>> short = error("open-contour", "ends {gap_mm:.3f} mm short", hint="--join", gap_mm=0.2)
    >>> short.message, short.values["gap_mm"]
    ('ends 0.200 mm short', 0.2)
    """
    return _finding(Severity.ERROR, code, template, span, values)


def warning(code: str, template: str, span: Span | None = None, **values: Any) -> Diagnostic:
    """Return a finding that ``--strict`` turns into an error; keywords as in `error`."""
    return _finding(Severity.WARNING, code, template, span, values)


def note(code: str, template: str, span: Span | None = None, **values: Any) -> Diagnostic:
    """Return a finding that reports a repair or a fact; keywords as in `error`."""
    return _finding(Severity.NOTE, code, template, span, values)


def _finding(
    severity: Severity, code: str, template: str, span: Span | None, values: dict[str, Any]
) -> Diagnostic:
    fields = {field: values.pop(name) for name, field in _FIELDS.items() if name in values}
    return Diagnostic(severity, code, template, span, values=values, **fields)


def has_errors(findings: Iterable[Diagnostic]) -> bool:
    """Return whether any finding is an error."""
    return any(d.severity is Severity.ERROR for d in findings)
