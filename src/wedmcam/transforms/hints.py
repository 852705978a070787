"""What a drawing itself says about segments that are in the way: centre lines have a line type.

Findings about segments that meet name a place and entities. Where one of these is drawn in a line
type of its own, it is most likely no outline, and the way to leave it out is known.
"""

from __future__ import annotations

from collections.abc import Iterable

from wedmcam.diag import Diagnostic, EntityRef

#: Findings that go away when a line is left out that is no outline.
CODES = frozenset(
    {"branch", "crossing-contours", "self-crossing", "overlap", "contours-touch", "open-contour"}
)


def with_linetypes(findings: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return findings whose hints say how to leave line types out that they are about."""
    return tuple(_with_linetype(d) for d in findings)


def _with_linetype(d: Diagnostic) -> Diagnostic:
    if d.code not in CODES:
        return d
    spans = [d.span, *(span for _, span in d.notes)]
    names = {s.linetype: None for s in spans if isinstance(s, EntityRef) and s.linetype}
    if not names:
        return d
    options = " ".join(f"--ignore-linetype {quote(name)}" for name in names)
    return d.extended(
        hint="; {leave_out} leaves that line type out"
        if d.hint_template
        else "{leave_out} leaves it out",
        leave_out=options,
    )


def quote(name: str) -> str:
    """Return a name as a shell takes it."""
    return f"'{name}'" if set(name) & set(' ()*?$&;[]|<>#!"') else name
