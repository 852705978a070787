"""What the ZD-065's gap compensation finds, as findings at the blocks of the file.

The controller tells what stands in the way in um and block numbers; here it gets code, words and
cure.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from wedmcam.controllers.zd065.compensation import HARMLESS, Compensated, Problem
from wedmcam.diag import Place, Severity
from wedmcam.frontends.zd065.memory import Stream

#: Vertices as stepped are within this of the exact ones [S], um.
MISS_UM = 1.0


class _Row(NamedTuple):
    severity: Severity
    code: str
    template: str
    hint: str | None = None


_PLACE = ", at {place} from the start of the program"
_LARGEST = "a corner radius of at most {largest_mm:.3f} mm, or round the corner in the outline"

_ROWS = {
    "below": _Row(
        Severity.ERROR,
        "gap-value",
        "the corner radius {corner_mm:.3f} mm is smaller than the gap {gap_mm:.3f} mm: the wire "
        "cannot run inside such an arc",
        "one corner radius for punch and die, at least the larger of their gaps",
    ),
    "turn": _Row(
        Severity.ERROR,
        "more-than-a-turn",
        "block {block}: an arc of {sweep_deg:.3f} degrees; the compensation takes up to a full "
        "circle",
        "split the arc",
    ),
    "sides": _Row(
        Severity.ERROR,
        "bad-type",
        "block {block}: its compensation type puts the wire on the other side of the contour than "
        "that of block {other}",
        "correct one of the two types",
    ),
    "unknown": _Row(
        Severity.ERROR,
        "outline-side",
        "block {block}: an open contour of lines alone: nothing says on which side of it outwards "
        "is",
        "write the offset path: --to compact",
    ),
    "doubtful": _Row(
        Severity.ERROR,
        "outline-side",
        "block {block}: a contour of lines alone, whose side follows from how contours lie; but "
        "the arcs of another contour have types that contradict how that one lies",
        "correct the types, or one file for each contour",
    ),
    "shrinks": _Row(
        Severity.ERROR,
        "gap-value",
        "block {block}: the radius {radius_mm:.3f} mm is not larger than the gap {gap_mm:.3f} mm "
        "by which it shrinks",
    ),
    "touch": _Row(
        Severity.ERROR,
        "corner-too-large",
        "block {block}: no transition arc of {corner_mm:.3f} mm touches it and the next block"
        + _PLACE,
        _LARGEST,
    ),
    "leg": _Row(
        Severity.ERROR,
        "corner-too-large",
        "block {block}: it is {length_mm:.3f} mm long, and the transition arcs of {corner_mm:.3f} "
        "mm at its ends need {need_mm:.3f} mm of it; it starts {place} from the start of the "
        "program",
        _LARGEST,
    ),
    "meet": _Row(
        Severity.ERROR,
        "arcs-not-met",
        "block {block}: offset by the gap, its arc and the next one do not meet within four gaps "
        "of their corner" + _PLACE,
        "round the corner in the outline",
    ),
    "vanishes": _Row(
        Severity.ERROR,
        "gap-value",
        "block {block}: a gap of {gap_mm:.3f} mm leaves nothing of it; it starts {place} from the "
        "start of the program",
        "a smaller gap",
    ),
    "open": _Row(
        Severity.WARNING,
        "not-closed",
        "block {block}: as stepped, the outline ends {off_mm:.3f} mm from where it starts; the "
        "path of the wire closes there",
    ),
    "nesting": _Row(
        Severity.NOTE,
        "outline-side",
        "block {block}: a contour of lines alone is taken for {what}: the wire runs {where} it",
        "enter the gap for the other side if that is wrong",
    ),
}


def tell_problems(stream: Stream, problems: Sequence[Problem]) -> bool:
    """Report problems at their blocks; return whether there is an error among them."""
    good = stream.good.copy()
    groups: dict[tuple[str, tuple[object, bool]], dict[int, Problem]] = {}
    for p in problems:
        key = p.what, (p.values.get("hole"), bool(p.values.get("largest_um", 1)))
        groups.setdefault(key, {})[p.block] = p
    for (what, (_, fits)), group in groups.items():
        row = _ROWS[what]
        stream.tell(
            row.severity,
            row.code,
            np.isin(np.arange(len(good)), list(group)),
            row.template,
            lambda i, group=group: _values(stream, group[i]),  # type: ignore[misc]
            row.hint if fits else "round the corner in the outline",
        )
        stream.good[:] = good  # more than one finding may be about a block
    return any(p.what not in HARMLESS for p in problems)


def tell_followed(stream: Stream, made: Compensated) -> None:
    """Report arcs that are cut in several, and vertices that were not reached within a um."""
    blocks = made.path["source"]
    for row in made.split.tolist():
        stream.tell(
            Severity.NOTE,
            "blocks-split",
            np.arange(len(stream.good)) == int(blocks[row]),
            "block {block}: no one arc with a whole centre ends where its offset arc does: it is "
            "cut in several",
        )
    far = np.flatnonzero(made.miss > MISS_UM)
    miss = np.zeros(len(stream.good))
    np.maximum.at(miss, blocks[far], made.miss[far])
    stream.tell(
        Severity.WARNING,
        "path-deviation",
        miss > MISS_UM,
        "block {block}: as stepped its offset path ends {miss_um:.2f} um from the exact place",
        lambda i: {"miss_um": float(miss[i])},
    )


def _values(stream: Stream, p: Problem) -> dict[str, object]:
    """Return what the fields of a template hold."""
    out: dict[str, object] = {}
    for name, value in p.values.items():
        if name.endswith("_um"):
            out[name.replace("_um", "_mm")] = stream.mm(value)
        else:
            out[name] = value
    if "x_um" in p.values:
        x, y = stream.mm(p.values["x_um"]), stream.mm(p.values["y_um"])
        out["place"] = Place(x, y)
    if "hole" in p.values:
        out["what"] = "a hole" if p.values["hole"] else "an outer contour"
        out["where"] = "inside" if p.values["inside"] else "outside"
    return out
