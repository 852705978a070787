"""What the ZD-065's gap compensation finds, as findings at the blocks of the file.

The controller tells what stands in the way in um and block numbers; here it gets code, words and
cure: a function for each kind of problem.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.compensation import HARMLESS, Compensated
from wedmcam.controllers.zd065.wire import Problem
from wedmcam.diag import Place, Severity
from wedmcam.frontends.zd065.memory import Stream

#: Vertices as stepped are within this of the exact ones [S], um.
MISS_UM = 1.0

_LARGEST = "a corner radius of at most {largest_mm:.3f} mm, or round the corner in the outline"
_ROUNDED = "round the corner in the outline"


class _Problems:
    """Problems of one kind, the last of each block."""

    def __init__(self, stream: Stream, problems: Sequence[Problem]) -> None:
        self.stream = stream
        self._values = {p.block: p.values for p in problems}

    def blocks(self, fits: bool | None = None) -> NDArray[np.bool_]:
        """Return which blocks have one; ``fits``: those for which some radius would do, or not."""
        some = [
            k
            for k, values in self._values.items()
            if fits is None or bool(values["largest_um"]) is fits
        ]
        return np.isin(np.arange(len(self.stream.good)), some)

    def value(self, block: int, name: str) -> object:
        """Return a value of the problem of a block."""
        return self._values[block][name]

    def mm(self, block: int, name: str) -> float:
        """Return a length of the problem of a block, which is stated in um."""
        return self.stream.mm(self._values[block][name])

    def place(self, block: int) -> Place:
        """Return where the problem of a block is, from the start of the program."""
        return Place(self.mm(block, "x_um"), self.mm(block, "y_um"))


def _below(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "gap-value",
        p.blocks(),
        "the corner radius {corner_mm:.3f} mm is smaller than the gap {gap_mm:.3f} mm: the wire "
        "cannot run inside such an arc",
        lambda i: {"corner_mm": p.mm(i, "corner_um"), "gap_mm": p.mm(i, "gap_um")},
        "one corner radius for punch and die, at least the larger of their gaps",
    )


def _turn(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "more-than-a-turn",
        p.blocks(),
        "block {block}: an arc of {sweep_deg:.3f} degrees; the compensation takes up to a full "
        "circle",
        lambda i: {"sweep_deg": p.value(i, "sweep_deg")},
        "split the arc",
    )


def _sides(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "bad-type",
        p.blocks(),
        "block {block}: its compensation type puts the wire on the other side of the contour than "
        "that of block {other}",
        lambda i: {"other": p.value(i, "other")},
        "correct one of the two types",
    )


def _unknown(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "outline-side",
        p.blocks(),
        "block {block}: an open contour of lines alone: nothing says on which side of it outwards "
        "is",
        hint="write the offset path: --to compact",
    )


def _doubtful(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "outline-side",
        p.blocks(),
        "block {block}: a contour of lines alone, whose side follows from how contours lie; but "
        "the arcs of another contour have types that contradict how that one lies",
        hint="correct the types, or one file for each contour",
    )


def _shrinks(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "gap-value",
        p.blocks(),
        "block {block}: the radius {radius_mm:.3f} mm is not larger than the gap {gap_mm:.3f} mm "
        "by which it shrinks",
        lambda i: {"radius_mm": p.mm(i, "radius_um"), "gap_mm": p.mm(i, "gap_um")},
    )


def _touch(s: Stream, p: _Problems) -> None:
    for fits in (True, False):
        s.tell(
            Severity.ERROR,
            "corner-too-large",
            p.blocks(fits),
            "block {block}: no transition arc of {corner_mm:.3f} mm touches it and the next block, "
            "at {place} from the start of the program",
            lambda i: {
                "corner_mm": p.mm(i, "corner_um"),
                "largest_mm": p.mm(i, "largest_um"),
                "place": p.place(i),
            },
            _LARGEST if fits else _ROUNDED,
        )


def _leg(s: Stream, p: _Problems) -> None:
    for fits in (True, False):
        s.tell(
            Severity.ERROR,
            "corner-too-large",
            p.blocks(fits),
            "block {block}: it is {length_mm:.3f} mm long, and the transition arcs of "
            "{corner_mm:.3f} mm at its ends need {need_mm:.3f} mm of it; it starts {place} from "
            "the start of the program",
            lambda i: {
                "length_mm": p.mm(i, "length_um"),
                "corner_mm": p.mm(i, "corner_um"),
                "need_mm": p.mm(i, "need_um"),
                "largest_mm": p.mm(i, "largest_um"),
                "place": p.place(i),
            },
            _LARGEST if fits else _ROUNDED,
        )


def _meet(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "arcs-not-met",
        p.blocks(),
        "block {block}: offset by the gap, its arc and the next one do not meet within four gaps "
        "of their corner, at {place} from the start of the program",
        lambda i: {"place": p.place(i)},
        _ROUNDED,
    )


def _vanishes(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.ERROR,
        "gap-value",
        p.blocks(),
        "block {block}: a gap of {gap_mm:.3f} mm leaves nothing of it; it starts {place} from the "
        "start of the program",
        lambda i: {"gap_mm": p.mm(i, "gap_um"), "place": p.place(i)},
        "a smaller gap",
    )


def _open(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.WARNING,
        "not-closed",
        p.blocks(),
        "block {block}: as stepped, the outline ends {off_mm:.3f} mm from where it starts; the "
        "path of the wire closes there",
        lambda i: {"off_mm": p.mm(i, "off_um")},
    )


def _nesting(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.NOTE,
        "outline-side",
        p.blocks(),
        "block {block}: a contour of lines alone is taken for {what}: the wire runs {where} it",
        lambda i: {
            "what": "a hole" if p.value(i, "hole") else "an outer contour",
            "where": "inside" if p.value(i, "inside") else "outside",
        },
        "enter the gap for the other side if that is wrong",
    )


def _lead(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.WARNING,
        "compensation-lead",
        p.blocks(),
        "block {block}: this lead cuts into what is kept: it lies up to {depth_mm:.3f} mm "
        "{where} the path of the wire; the file is threaded for the other side",
        lambda i: {
            "depth_mm": p.mm(i, "depth_um"),
            "where": "inside" if p.value(i, "inside") else "outside",
            "other": "outside" if p.value(i, "inside") else "inside",
            "place": p.place(i),
        },
        "--lead-in X,Y --lead-out X,Y: lines from a thread point {other} the contour to the start "
        "of the outline, {place} from the start of the program, and back",
    )


def _acute(s: Stream, p: _Problems) -> None:
    s.tell(
        Severity.WARNING,
        "acute-corner",
        p.blocks(),
        "block {block}: the corner of {angle_deg:.1f} degrees behind it, at {place} from the start "
        "of the program, has an arc of {corner_mm:.3f} mm, the gap: with another gap the die is "
        "too narrow or too wide for the punch there",
        lambda i: {
            "angle_deg": p.value(i, "angle_deg"),
            "place": p.place(i),
            "corner_mm": p.mm(i, "corner_um"),
        },
        "--corner in both runs: the larger of the gaps of punch and die",
    )


#: By `Problem.what`.
_TELL: dict[str, Callable[[Stream, _Problems], None]] = {
    "below": _below,
    "turn": _turn,
    "sides": _sides,
    "unknown": _unknown,
    "doubtful": _doubtful,
    "shrinks": _shrinks,
    "touch": _touch,
    "leg": _leg,
    "meet": _meet,
    "vanishes": _vanishes,
    "open": _open,
    "nesting": _nesting,
    "lead": _lead,
    "acute": _acute,
}


def tell_problems(stream: Stream, problems: Sequence[Problem]) -> bool:
    """Report problems at their blocks; return whether there is an error among them."""
    good = stream.good.copy()
    for what, finding_of in _TELL.items():
        finding_of(stream, _Problems(stream, [p for p in problems if p.what == what]))
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
