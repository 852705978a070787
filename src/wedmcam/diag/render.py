"""Findings as text for people: place, severity, code, sentence, notes, hint."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import replace

from wedmcam.diag.capped import capped
from wedmcam.diag.finding import Diagnostic, Severity
from wedmcam.diag.shown import shortened, visible
from wedmcam.diag.span import EntityRef, Span, TextSpan

COLOURS = {Severity.ERROR: "31;1", Severity.WARNING: "33;1", Severity.NOTE: "36"}

#: A place that is longer (a name of a layer is any text) is cut in its middle, characters.
PLACE = 300
#: Of a longer line so many characters are shown.
WINDOW = 160


def merged(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return the findings, capped, with equal ones (same code, place and sentence) made one."""
    seen: dict[tuple[object, ...], Diagnostic] = {}
    for d in capped(findings):
        key = (d.severity, d.code, d.message, str(d.span))
        seen[key] = replace(d, times=seen[key].times + d.times) if key in seen else d
    return list(seen.values())


def render(
    finding: Diagnostic, file: str = "", colour: bool = False, text: str | None = None
) -> str:
    """Return one finding as lines.

    ``file`` stands where the finding has no place of its own. With the ``text`` that its place is
    in, the line is shown with a caret below.

    >>> from wedmcam.diag import EntityRef, error
    >>> print(render(error("open-contour", "ends 0.137 mm short", EntityRef("a.dxf", "2F", "ARC",
    ...     "CUT"), hint="--join 0.15")))
    a.dxf:#2F layer CUT: error[open-contour]: ends 0.137 mm short
      hint: --join 0.15
    """
    place = _place(finding.span) if finding.span is not None else _plain(file)
    head = f"{finding.severity}[{finding.code}]"
    if colour:
        head = f"\x1b[{COLOURS[finding.severity]}m{head}\x1b[0m"
    times = f" (x {finding.times})" if finding.times > 1 else ""
    headline = f"{head}: {visible(finding.message)}{times}"
    lines = [f"{place}: {headline}" if place else headline]
    if text is not None and isinstance(finding.span, TextSpan):
        lines += excerpt(text, finding.span)
    for what, span in finding.notes:
        kind = f"{_plain(span.dxftype)} " if isinstance(span, EntityRef) else ""
        where = f" ({kind}{_place(span)})" if span is not None else ""
        lines.append(f"  = {_plain(what)}{where}")
    if finding.hint:
        lines.append(f"  hint: {_plain(finding.hint)}")
    return "\n".join(lines)


def _plain(text: str) -> str:
    return visible(shortened(text))


def _place(span: Span) -> str:
    return visible(shortened(str(span), PLACE))


def excerpt(text: str, span: TextSpan) -> list[str]:
    r"""Return the line that a span is in, and a line that marks it; empty where there is none.

    Tabs are kept and wide characters count two, so that the mark stands below what it means. Of a
    line longer than `WINDOW` characters the part around the mark is shown.

    >>> print(*excerpt("a = 1\nofset = 0.1\n", TextSpan("x", 2, 1, 5)), sep="\n")
        2 | ofset = 0.1
          | ^~~~~
    """
    begin = 0
    for _ in range(span.line - 1):
        begin = text.find("\n", begin) + 1
        if not begin:
            return []
    end = text.find("\n", begin)
    end = len(text) if end < 0 else end
    if span.line < 1:
        return []
    mark = begin + span.column - 1
    if end - begin > WINDOW:
        begin = max(begin, min(mark - WINDOW // 2, end - WINDOW))
        end = min(end, begin + WINDOW)
    line = text[begin:end].rstrip("\r")
    at = max(0, mark - begin)
    before, marked = (
        visible(part, "\t") for part in (line[:at], line[at : at + max(1, span.length)])
    )
    line = visible(line, "\t")
    blank = "".join("\t" if c == "\t" else " " * _width(c) for c in before)
    below = "^" + "~" * (sum(map(_width, marked)) - 1)
    return [f"{span.line:5d} | {line}", f"      | {blank}{below}"]


def _width(character: str) -> int:
    return 2 if unicodedata.east_asian_width(character) in "WF" else 1
