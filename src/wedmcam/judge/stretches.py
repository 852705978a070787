"""A decoded program parted into stretches: cutting blocks with nothing between them.

A program knows no roles and no cut numbers, only blocks and control records; which stretch is
which cut follows from the order and from where the wire is threaded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wedmcam.diag import Diagnostic, Place, Span, error
from wedmcam.ir.plan import Cut
from wedmcam.ir.program import Kind, Program
from wedmcam.judge.segments import Ints
from wedmcam.judge.walk import Walk

#: Against a whole drawing a program of some of its contours has too few cuts, in other places.
SOME_CONTOURS = "a load of --split, or a program of some contours: --cuts A-B names them"


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """Cutting blocks without a control record or a move between them.

    Attributes:
        index: rows of the program, in order.
        start: where the wire is before the first, um.
        end: where it is after the last.
        joined: the stretch before ends in a pause only, so this may go on with the same contour.
    """

    index: Ints
    start: tuple[int, int]
    end: tuple[int, int]
    joined: bool


@dataclass(frozen=True, slots=True, eq=False)
class Assigned:
    """The blocks of one cut.

    Attributes:
        cut: 0-based number in the plan.
        index: rows of the program.
        pauses: rows of ``index`` (positions) after which the machine pauses.
        closing: row of ``index`` (position) of a block that closes the contour on its way and runs
            on over its start; -1 where a block ends there.
    """

    cut: int
    index: Ints
    pauses: tuple[int, ...]
    closing: int = -1


def per_mm(program: Program) -> float:
    """Return how many steps of a program go to a mm: what all lengths here are divided by."""
    return 1000.0 / program.step_um


def place(x: float, y: float, per: float = 1000.0) -> Place:
    """Return a place for a finding, from coordinates in steps; ``per`` steps are a mm.

    >>> str(place(-0.4, 12500))
    '(0.000, 12.500) mm'
    """
    return Place(float(x / per), float(y / per))


def span_of(program: Program, row: int) -> Span | None:
    """Return where a block was read, or what it was made from."""
    if row < len(program.spans):
        return program.spans[row]
    source = int(program.blocks["source"][row])
    return program.sources[source] if 0 <= source < len(program.sources) else None


def stretches(walk: Walk) -> list[Stretch]:
    """Part the program. Unknown words do not part it; blocks without a step are left out."""
    kind = walk.blocks["kind"]
    control = ~walk.cutting & (kind != Kind.WORD)
    group = np.cumsum(control)
    rows = np.flatnonzero(walk.cutting & (walk.steps > 0))
    pieces: list[Stretch] = []
    if not len(rows):
        return pieces
    edges = np.flatnonzero(np.diff(group[rows])) + 1
    for part in np.split(rows, edges):
        first, last = int(part[0]), int(part[-1])
        joined = False
        if pieces:
            between = kind[int(pieces[-1].index[-1]) + 1 : first]
            between = between[(between != Kind.WORD) & (between != Kind.LINE)]
            joined = bool((between == Kind.PAUSE).all())
        start, end = walk.start[first], walk.end[last]
        pieces.append(
            Stretch(part, (int(start[0]), int(start[1])), (int(end[0]), int(end[1])), joined)
        )
    return pieces


def assign(
    program: Program, pieces: list[Stretch], cuts: tuple[Cut, ...]
) -> tuple[list[Assigned], list[Diagnostic]]:
    """Give each planned cut its stretches, in the plan's order; report too many and too few."""
    out: list[Assigned] = []
    findings: list[Diagnostic] = []
    r = c = 0
    while r < len(pieces) and c < len(cuts):
        stretch, cut = pieces[r], cuts[c]
        if stretch.start != cut.thread:
            later = next(
                (k for k in range(c + 1, len(cuts)) if cuts[k].thread == stretch.start), None
            )
            ahead = next(
                (k for k in range(r + 1, len(pieces)) if pieces[k].start == cut.thread), None
            )
            if later is not None and ahead is None:
                findings.extend(_missing(program, cuts[k], k) for k in range(c, later))
                c = later
                continue
            if ahead is not None:
                findings.extend(_extra(program, pieces[k]) for k in range(r, ahead))
                r = ahead
                continue
            findings.append(_thread(program, stretch, cut, c))
        pauses: list[int] = []
        index, end = [stretch.index], stretch.end
        r += 1
        while (
            r < len(pieces)
            and pieces[r].joined
            and _goes_on(cut, end, len(pauses), pieces[r], cuts, c)
        ):
            pauses.append(sum(len(k) for k in index))
            index.append(pieces[r].index)
            end = pieces[r].end
            r += 1
        out.append(Assigned(c, np.concatenate(index), tuple(pauses)))
        c += 1
    findings.extend(_missing(program, cuts[k], k) for k in range(c, len(cuts)))
    findings.extend(_extra(program, pieces[k]) for k in range(r, len(pieces)))
    return out, findings


def _goes_on(
    cut: Cut, end: tuple[int, int], paused: int, stretch: Stretch, cuts: tuple[Cut, ...], c: int
) -> bool:
    """Return whether a stretch after a pause goes on with the same cut."""
    if cut.path.closed:
        return end != cut.thread
    if cut.stop_um > 0 and not paused:
        return True
    return c + 1 >= len(cuts) or cuts[c + 1].thread != stretch.start


def _missing(program: Program, cut: Cut, number: int) -> Diagnostic:
    thread = place(*cut.thread, per_mm(program))
    return error(
        "missing-cut",
        "cut {cut} (threaded at {thread}) is not in the program",
        hint=SOME_CONTOURS,
        points_mm=(thread,),
        cut=number + 1,
        thread=thread,
    )


def _extra(program: Program, stretch: Stretch) -> Diagnostic:
    first = int(stretch.index[0])
    start = place(*stretch.start, per_mm(program))
    return error(
        "extra-cut",
        "blocks {first} to {last} cut from {start} on; no contour is left for them",
        span_of(program, first),
        hint=SOME_CONTOURS,
        points_mm=(start,),
        first=first + 1,
        last=int(stretch.index[-1]) + 1,
        start=start,
    )


def _thread(program: Program, stretch: Stretch, cut: Cut, number: int) -> Diagnostic:
    per = per_mm(program)
    first = int(stretch.index[0])
    start = place(*stretch.start, per)
    return error(
        "thread-point",
        "block {block} starts cut {cut} at {start}, {off_mm:.3f} mm from its thread point {thread}",
        span_of(program, first),
        points_mm=(start,),
        block=first + 1,
        cut=number + 1,
        start=start,
        off_mm=np.hypot(stretch.start[0] - cut.thread[0], stretch.start[1] - cut.thread[1]) / per,
        thread=place(*cut.thread, per),
    )
