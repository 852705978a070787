"""Measure: each cut starts, pauses, closes and ends where the plan says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.diag import Diagnostic, Severity, error, note
from wedmcam.ir.plan import Cut
from wedmcam.ir.program import Kind
from wedmcam.judge.followed import Followed, last_row, places
from wedmcam.judge.measured import Measured
from wedmcam.judge.segments import Floats, Ints
from wedmcam.judge.stretches import Assigned, span_of
from wedmcam.judge.track import LOST
from wedmcam.judge.walk import Walk

#: How far from the asked length of the stop the pause may be, um: it is rounded to the micron, and
#: a vertex next to it may be taken for it.
STOP_ROOM = 5.0

#: A recomputed end may miss by the rounding of its own formula: what closes a contour of a
#: controller that recomputes arc ends, um (ours: no source has it).
TEXTBOOK_CLOSURE = 2.0

#: How far an open cut may end from the end of its path, um: that is rounded, and an arc may end one
#: off.
OPEN_END = 1.5


def closes(f: Followed) -> Measured:
    """Report where cuts end, close and pause elsewhere than planned."""
    findings: list[Diagnostic] = []
    closures: list[float | None] = []
    for k in range(len(f.assigned)):
        closure, problems = _ends(f, k)
        closures.append(closure)
        findings.extend(problems)
    return Measured(findings, closures=tuple(closures))


def moves_on(f: Followed) -> Measured:
    """Report a last move that leads away from where the plan ends."""
    moves = np.flatnonzero(f.way.blocks["kind"] == Kind.MOVE)
    last = last_row(f.way)
    if not len(moves) or moves[-1] < last:
        return Measured([])
    row = int(moves[-1])
    if (f.way.end[row] == f.way.end[last]).all():
        return Measured([])
    findings = [
        error(
            "thread-point",
            "block {block} moves on behind the last cut: the program does not end where the plan "
            "ends; it ends at {end}",
            **f.of_block(row),
        )
    ]
    return Measured(findings if f.terms.strict_order else as_notes(findings))


def _ends(f: Followed, k: int) -> tuple[float | None, list[Diagnostic]]:
    """Return the closure of one cut, and report its ends and its pauses."""
    a, cut = f.assigned[k], f.cuts[k]
    rows = slice(int(f.first[k]), int(f.first[k + 1]))
    findings: list[Diagnostic] = []
    high = f.track.high[rows]
    if np.isnan(high).any():
        return None, findings  # lost: reported
    last = int(a.index[-1])
    end = f.way.end[last]
    limit = TEXTBOOK_CLOSURE if f.count == "textbook" else 0.0
    if high[-1] < f.route.high[k] - LOST:
        short = error(
            "missing-piece",
            "block {block} is the last of cut {cut}, {left_mm:.3f} mm before its end",
            **f.of_block(last),
            cut=a.cut + 1,
            left_mm=float(f.route.high[k] - high[-1]) / f.per,
        )
        findings.append(_with_end(short, f, last))
    elif wrong := _wrong_end(f, a, cut, end, limit):
        findings.append(_with_end(wrong, f, last, tuple(end.tolist()) == cut.thread))
    if f.terms.fitted and not cut.path.closed:
        findings.extend(_loose_start(f, a, cut))
    pauses = _pauses(f, k, high)
    findings.extend(pauses if f.terms.strict_order else as_notes(pauses))
    if not f.route.closed[k]:
        return None, findings
    stands = np.concatenate([f.way.start[a.index[:1]], f.way.end[a.index]])
    at = np.concatenate([f.track.low[rows][:1], high])
    p0, p1 = meeting(
        stands, at, float(f.route.path_low[k]), float(f.route.path_high[k]), f.terms.path_limit_um
    )
    off = abs(at[p0] - f.route.path_low[k])
    if a.closing < 0:
        off = max(off, abs(at[p1] - f.route.path_high[k]))
    block = int(a.index[max(p1 - 1, 0)])
    if off > LOST:
        findings.append(
            error(
                "not-closed",
                "block {block} is the last before the end of cut {cut}, but no block ends where "
                "the contour closes ({off_mm:.3f} mm off); it ends at {end}",
                **f.of_block(block),
                cut=a.cut + 1,
                off_mm=off / f.per,
            )
        )
        return None, findings
    closure = float(np.hypot(*(stands[p1] - stands[p0])))
    if a.closing >= 0:
        block = int(a.index[a.closing])
        closure, limit = _passed(f.way, block, stands[p0]), f.terms.path_limit_um
    if closure > limit:
        findings.append(
            error(
                "not-closed",
                "block {block} ends cut {cut} {closure_mm:.4f} mm from where it started "
                "({start}); it ends at {end}",
                **f.of_block(block),
                cut=a.cut + 1,
                closure_mm=closure / f.per,
                start=f.place(*stands[p0]),
            )
        )
    elif closure > 0 and a.closing < 0:
        findings.append(
            note(
                "not-closed",
                "cut {cut} closes within {closure_mm:.4f} mm on a controller that recomputes arc "
                "ends",
                cut=a.cut + 1,
                closure_mm=closure / f.per,
            )
        )
    return closure, findings


def _with_end(d: Diagnostic, f: Followed, row: int, threaded: bool = False) -> Diagnostic:
    """Return a finding on the last block of a cut with where it ends.

    Args:
        d: the finding.
        f: the program along its plan.
        row: of the block.
        threaded: it ends on the thread point of the plan.
    """
    if row == last_row(f.way) and not threaded:
        d = d.extended(": the program does not end where the plan ends")
    return d.extended("; it ends at {end}")


def _wrong_end(f: Followed, a: Assigned, cut: Cut, end: Ints, limit: float) -> Diagnostic | None:
    """Return what is wrong with the place at which a cut ends; None where nothing is."""

    def off(x: float, y: float) -> float:
        return float(np.hypot(end[0] - x, end[1] - y))

    threaded = f.way.start[int(a.index[0])]
    if cut.path.closed:
        there = off(*cut.thread) <= limit
        if not f.terms.strict_order:
            there = off(*threaded) <= limit or (there and not f.terms.fitted)
        if there:
            return None
        return error(
            "thread-point",
            "block {block} does not return to the thread point {thread} of cut {cut}",
            **f.of_block(int(a.index[-1])),
            thread=f.place(*(cut.thread if f.terms.strict_order else threaded)),
            cut=a.cut + 1,
        )
    v = cut.path.vertices[[-1]] if f.terms.strict_order else cut.path.vertices[[0, -1]]
    apart = min(off(x, y) for x, y in zip(v["x"].tolist(), v["y"].tolist(), strict=True))
    if apart <= OPEN_END or (not f.terms.strict_order and off(*threaded) <= limit):
        return None
    return error(
        "thread-point",
        "block {block} ends {apart_mm:.3f} mm from the end of the path of cut {cut}",
        **f.of_block(int(a.index[-1])),
        apart_mm=apart / f.per,
        cut=a.cut + 1,
    )


def _loose_start(f: Followed, a: Assigned, cut: Cut) -> list[Diagnostic]:
    """Report an open cut that is threaded elsewhere, where nothing else ties its start."""
    first = int(a.index[0])
    threaded = tuple(f.way.start[first].tolist())
    if threaded == cut.thread:
        return []
    start = f.place(*threaded)
    return [
        error(
            "thread-point",
            "cut {cut} is open and threaded at {start}, not at {thread}, and it is not known "
            "where the program starts",
            span_of(f.program, first),
            hint="state --origin",
            points_mm=(start,),
            cut=a.cut + 1,
            start=start,
            thread=f.place(*cut.thread),
        )
    ]


def _pauses(f: Followed, k: int, high: Floats) -> list[Diagnostic]:
    """Report a pause that is missing, too many, or elsewhere."""
    a, cut = f.assigned[k], f.cuts[k]
    at = [float(high[p - 1]) for p in a.pauses]
    wanted = float(f.route.path_high[k]) - cut.stop_um
    if cut.stop_um <= 0 or cut.stop_um >= f.route.path_high[k] - f.route.path_low[k]:
        wanted = float("nan")
    findings = []
    hits = [abs(one - wanted) <= STOP_ROOM for one in at]
    for p, hit in zip(a.pauses, hits, strict=True):
        if not hit:
            findings.append(
                error(
                    "stop-point",
                    "block {block} is followed by a pause in the middle of cut {cut}, where none "
                    "is asked for; it ends at {end}",
                    **f.of_block(int(a.index[p - 1])),
                    cut=a.cut + 1,
                )
            )
    if not np.isnan(wanted) and sum(hits) != 1:
        stop = f.place(*places(f.route, np.array([wanted]))[0])
        findings.append(
            error(
                "stop-point",
                "cut {cut} has {pauses} pauses {stop_mm:.3f} mm before its end, at {stop}; one is "
                "asked for",
                span_of(f.program, int(a.index[-1])),
                points_mm=(stop,),
                cut=a.cut + 1,
                pauses=sum(hits),
                stop_mm=cut.stop_um / f.per,
                stop=stop,
            )
        )
    return findings


def as_notes(findings: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return findings as notes: of a program from elsewhere, whose order and leads are its own."""
    return [replace(d, severity=Severity.NOTE) for d in findings]


def meeting(places: Ints, at: Floats, low: float, high: float, room: float) -> tuple[int, int]:
    """Return at which of the places of a cut its contour begins, and at which it closes.

    Where blocks are no longer than what rounding moves their ends (a stop or an overcut of a step
    or two) the nearest along the path may be a neighbour: of those within ``room`` of both ends of
    the path, one place that was passed twice, a whole contour apart, is where it closes.

    Args:
        places: where blocks begin and end, steps, shape (n, 2).
        at: how far along the route these are.
        low, high: where on it the contour begins and ends.
        room: how far along the route a place may be from where it was to be.
    """
    starts, ends = np.abs(at - low), np.abs(at - high)
    # The last of several that stand there.
    first, last = int(np.argmin(starts)), len(at) - 1 - int(np.argmin(ends[::-1]))
    if high - low > 4.0 * room and (places[first] != places[last]).any():
        a, b = np.flatnonzero(starts <= room), np.flatnonzero(ends <= room)
        i, j = np.nonzero((places[a][:, None] == places[b][None]).all(axis=2))
        if len(i):
            best = int(np.argmin(starts[a[i]] + ends[b[j]]))
            return int(a[i[best]]), int(b[j[best]])
    return first, last


def _passed(way: Walk, row: int, place: Ints) -> float:
    """Return how near a block comes to a place that it passes, um."""
    x, y, _ = way.points(np.array([row]))
    return float(np.hypot(x - place[0], y - place[1]).min())
