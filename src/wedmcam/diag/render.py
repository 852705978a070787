"""Findings as text for people: place, severity, code, sentence, notes, hint."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import replace

from wedmcam.diag.finding import Diagnostic, Severity
from wedmcam.diag.span import EntityRef, TextSpan

COLOURS = {Severity.ERROR: "31;1", Severity.WARNING: "33;1", Severity.NOTE: "36"}


def merged(found: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return the findings with equal ones (same code, place and sentence) counted as one.

    A finding that stands for many by itself says so in its sentence: it counts as one here.
    """
    seen: dict[tuple[object, ...], Diagnostic] = {}
    for d in found:
        key = (d.severity, d.code, d.message, str(d.span))
        count = seen[key].count + 1 if key in seen else 1
        seen[key] = replace(d, count=count)
    return list(seen.values())


def render(found: Diagnostic, file: str = "", colour: bool = False, text: str | None = None) -> str:
    """Return one finding as lines.

    ``file`` stands where the finding has no place of its own. With the ``text`` that its place is
    in, the line is shown with a caret below.

    >>> from wedmcam.diag import EntityRef, error
    >>> print(render(error("open-contour", "ends 0.137 mm short", EntityRef("a.dxf", "2F", "ARC",
    ...     "CUT"), hint="--join 0.15")))
    a.dxf:#2F layer CUT: error[open-contour]: ends 0.137 mm short
      hint: --join 0.15
    """
    place = str(found.span) if found.span is not None else file
    head = f"{found.severity}[{found.code}]"
    if colour:
        head = f"\x1b[{COLOURS[found.severity]}m{head}\x1b[0m"
    times = f" (x {found.count})" if found.count > 1 else ""
    lines = [f"{place}: {head}: {found.message}{times}" if place else f"{head}: {found.message}"]
    if text is not None and isinstance(found.span, TextSpan):
        lines += excerpt(text, found.span)
    for what, span in found.notes:
        kind = f"{span.dxftype} " if isinstance(span, EntityRef) else ""
        lines.append(f"  = {what}" + (f" ({kind}{span})" if span is not None else ""))
    if found.hint:
        lines.append(f"  hint: {found.hint}")
    return "\n".join(lines)


def excerpt(text: str, span: TextSpan) -> list[str]:
    r"""Return the line that a span is in, and a line that marks it; empty where there is none.

    Tabs are kept and wide characters count two, so that the mark stands below what it means.

    >>> print(*excerpt("a = 1\nofset = 0.1\n", TextSpan("x", 2, 1, 5)), sep="\n")
        2 | ofset = 0.1
          | ^~~~~
    """
    lines = text.split("\n")
    if not 1 <= span.line <= len(lines):
        return []
    line = lines[span.line - 1].rstrip("\r")
    before, marked = line[: span.column - 1], line[span.column - 1 :][: max(1, span.length)]
    blank = "".join("\t" if c == "\t" else " " * _width(c) for c in before)
    mark = "^" + "~" * (sum(map(_width, marked)) - 1)
    return [f"{span.line:5d} | {line}", f"      | {blank}{mark}"]


def _width(character: str) -> int:
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
