"""Where a program by itself fails to close, and which single value would close it.

A program without its drawing says one thing about what was meant: a contour that leads in and goes
back the same way was to be closed, and so was one that ends beside its start. A count length, a
direction of counting or a size that was mistyped shifts all that follows. So the block at which a
contour should have closed is named, with what is missing, and every block before it is asked
whether one other value would make up for that.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from wedmcam.controllers import Stepping
from wedmcam.controllers.stepping import Blocks
from wedmcam.diag import Diagnostic, warning
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.judge.pieces import EARLY, RECOMPUTED
from wedmcam.judge.segments import Ints
from wedmcam.judge.stretches import per_mm, place, span_of, stretches
from wedmcam.judge.totals import MEANT_CLOSED
from wedmcam.judge.walk import Walk, walk

#: So many contours, and so many values that would close one, are listed.
MOST_LISTED = 5
#: So many blocks of a contour are searched for other values: beyond it the number of answers grows
#: more than their use.
SEARCHED = 20_000
#: In so many blocks every digit is tried.
DIGITS = 500
#: A size that is solved for is rounded: so many neighbours are tried on either side.
BESIDE = 2


#: The number of an instruction (L1, NR3), of x, y and turn.
Quadrant = Callable[[Ints, Ints, Ints], Ints]


class Open(NamedTuple):
    """A contour that does not close.

    Attributes:
        rows: blocks between two threadings, rows of the program.
        first: position in ``rows`` of the first block of the contour.
        last: one past its last.
        gap: (x, y) from where it started to where it ends, steps.
        meant: it is certain that it was to close.
        leads: the contour closes, and its leads do not come back to where the wire was threaded:
            their rows. None where the contour itself is open.
    """

    rows: Ints
    first: int
    last: int
    gap: tuple[int, int]
    meant: bool
    leads: Ints | None = None

    @property
    def searched_rows(self) -> Ints:
        """Rows of the blocks in which another value would make up for the gap."""
        return self.rows[self.first : self.last] if self.leads is None else self.leads


class Change(NamedTuple):
    """One value of one block that would close a contour; ``field`` is empty for an instruction."""

    row: int
    field: str
    now: str
    then: str

    @property
    def text(self) -> str:
        """In words."""
        value = f"{self.field} {self.then}".lstrip()
        return f"{value} instead of {self.now} at block {self.row + 1}"

    @property
    def rank(self) -> tuple[int, bool, int, int, str]:
        """Fewest characters first: a slip of the finger changes, adds or drops one.

        Then J and G before X and Y: many values of X and Y would do as well.
        """
        by = abs(int(self.then) - int(self.now)) if self.field in ("X", "Y", "J") else 0
        return _slips(self.now, self.then), self.field in ("X", "Y"), by, self.row, self.field


def _slips(a: str, b: str) -> int:
    """Return in how many characters two short texts differ; one too many or missing is one.

    >>> _slips("150", "50"), _slips("150", "650"), _slips("150", "99")
    (1, 1, 3)
    """
    if len(a) < len(b):
        a, b = b, a
    if len(a) == len(b):
        return sum(x != y for x, y in zip(a, b, strict=True))
    return 1 if any(a[:k] + a[k + 1 :] == b for k in range(len(a))) else len(a)


def not_closed(
    program: Program,
    stepping: Stepping,
    quadrant: Quadrant | None,
    textbook: bool = False,
) -> list[Diagnostic]:
    """Return a warning for each contour that does not close, with the values that would close it.

    Args:
        program: in the frame and the words of its file.
        stepping: the interpolator in that frame.
        quadrant: of the instructions of a format whose blocks state X, Y, J and G; None for one
            in which these follow from where it goes: then there is no value to look for.
        textbook: the controller recomputes arc ends.

    A contour that ends far from its start may be open on purpose: it is told only where one
    character would close it.
    """
    way = walk(program, stepping, textbook=textbook)
    if (way.steps < 0).any():
        return []  # a block that never ends comes first, and is an error
    per = per_mm(program)
    findings: list[Diagnostic] = []
    more = 0
    for one in open_contours(way):
        changes = [] if quadrant is None or textbook else closing_changes(way, one, quadrant)
        if not one.meant and not (changes and changes[0].rank[0] == 1):
            continue
        if textbook and np.hypot(*one.gap) <= RECOMPUTED:
            continue
        if len(findings) == MOST_LISTED:
            more += 1
            continue
        row = int(one.rows[one.last - 1])
        dx, dy = one.gap
        x, y = way.start[int(one.rows[one.first])].tolist()
        searched = quadrant is not None and not textbook
        findings.append(
            warning(
                "not-closed",
                "block {block} should close the contour that begins with block {first}, and ends "
                "{gap_mm:.3f} mm from its start ({dx_mm:+.3f}, {dy_mm:+.3f})"
                if one.leads is None
                else "block {block} should lead back to where the wire is threaded for block "
                "{first}, and ends {gap_mm:.3f} mm from there ({dx_mm:+.3f}, {dy_mm:+.3f})",
                span_of(program, row),
                hint=None
                if not searched
                else "no other single value of X, Y, J or G would close it"
                if not changes
                else "{changes} closes it"
                if len(changes) == 1
                else "{changes} would close it",
                points_mm=(place(x, y, per),),
                block=row + 1,
                first=int(one.rows[one.first]) + 1,
                gap_mm=float(np.hypot(dx, dy)) / per,
                dx_mm=dx / per,
                dy_mm=dy / per,
                changes=_in_words(changes),
            )
        )
    if more:
        findings.append(warning("not-closed", "and {count} more contours do not close", count=more))
    return findings


def _in_words(changes: Sequence[Change]) -> str:
    """Return the changes that would close a contour, the likeliest first."""
    text = "; or ".join(change.text for change in changes[:MOST_LISTED])
    more = len(changes) - MOST_LISTED
    return f"{text}; and {more} more" if more > 0 else text


def open_contours(way: Walk) -> Iterator[Open]:
    """Yield the contours that do not close, of those between two threadings of the wire."""
    held: list[Ints] = []
    for run in stretches(way):
        if held and not run.joined:
            yield from _open(way, np.concatenate(held))
            held = []
        held.append(run.index)
        if run.joined and tuple(way.start[int(held[0][0])].tolist()) == run.end:
            held = []  # back where it was threaded: closed
    if held:
        yield from _open(way, np.concatenate(held))


def _open(way: Walk, rows: Ints) -> Iterator[Open]:
    """Yield blocks between two threadings, where no contour among them closes."""
    ends = np.concatenate([way.start[rows[:1]], way.end[rows]])
    n = len(rows)
    gap = ends[-1] - ends[0]
    if n < 2 or not gap.any():
        return
    ways = np.diff(ends, axis=0)
    lead = 0
    while 2 * (lead + 1) < n and _back(way, rows, ways, lead):
        lead += 1
    if lead:
        # The way back is the way in: what is missing is missing between them.
        box = np.ptp(ends[lead : n - lead + 1], axis=0).astype(float)
        meant = float(np.hypot(*gap.astype(float))) <= max(MEANT_CLOSED, np.hypot(*box) / 2.0)
        yield Open(rows, lead, n - lead, (int(gap[0]), int(gap[1])), bool(meant))
        return
    # A way in and none out, or another one: it closes where it comes back beside its start.
    near: list[tuple[float, int, int]] = []
    for first in range(min(EARLY, n - 1)):
        off = np.hypot(*(ends[first + 2 :] - ends[first]).astype(float).T)
        if not len(off):
            continue
        if (off == 0).any():  # closed; what its leads miss displaces all that follows
            again = first + 2 + len(off) - 1 - int(np.argmin(off[::-1]))
            leads = np.concatenate([rows[:first], rows[again:]])
            meant = bool(np.hypot(*gap.astype(float)) <= MEANT_CLOSED)
            if first and again < n:
                yield Open(rows, 0, n, (int(gap[0]), int(gap[1])), meant, leads)
            return
        k = len(off) - 1 - int(np.argmin(off[::-1]))
        near.append((float(off[k]), first, first + 2 + k))
    if not near:
        return
    least, first, last = min(near)
    away = ends[last] - ends[first]
    if least <= MEANT_CLOSED:
        yield Open(rows, first, last, (int(away[0]), int(away[1])), True)
        return
    yield Open(rows, 0, n, (int(gap[0]), int(gap[1])), False)


def _back(way: Walk, rows: Ints, ways: Ints, k: int) -> bool:
    """Return whether block k is a line, and the k-th from the end goes back on it."""
    if (ways[k] + ways[-1 - k]).any():
        return False
    kinds = way.blocks["kind"][[int(rows[k]), int(rows[-1 - k])]]
    return bool((kinds == Kind.LINE).all())


def closing_changes(way: Walk, one: Open, quadrant: Quadrant) -> list[Change]:
    """Return the values that would close a contour, one at a time, the likeliest first."""
    rows = one.searched_rows
    if len(rows) > SEARCHED:
        return []
    wanted = way.end[rows] - way.start[rows] - np.array(one.gap)
    tried = [*_counts(way, rows, wanted), *_sizes(way, rows, wanted), *_signs(way, rows)]
    if len(rows) <= DIGITS:
        tried += _digits(way, rows)
    which = np.concatenate([k for k, _ in tried])
    blocks = np.concatenate([b for _, b in tried])
    valid = (blocks["count"] > 0) & ((blocks["x"] != 0) | (blocks["y"] != 0))
    which, blocks = which[valid], blocks[valid]
    motion = way.stepping.run(blocks)
    ends = np.column_stack([motion.dx, motion.dy])
    hit = np.flatnonzero((motion.steps > 0) & (ends == wanted[which]).all(axis=1))
    before, after = way.blocks[rows[which[hit]]], blocks[hit]
    words = [_instructions(b, quadrant) for b in (before, after)]
    changes: set[Change] = set()
    for k, row in enumerate(rows[which[hit]].tolist()):
        change = _change(before[k], after[k], words[0][k], words[1][k], row)
        if change is not None:
            changes.add(change)
    best: dict[tuple[int, str, str], Change] = {}
    for change in sorted(changes, key=lambda c: c.rank):
        # Of sizes many may do as well, since they are directions; each J is another length.
        best.setdefault((change.row, change.field, change.then * (change.field == "J")), change)
    return sorted(best.values(), key=lambda c: c.rank)


def _instructions(b: Blocks, quadrant: Quadrant) -> list[str]:
    """Return the instructions of blocks: L1 to L4, NR1 to SR4."""
    numbers = quadrant(b["x"], b["y"], b["turn"])
    senses = ("L", "NR", "SR")
    return [f"{senses[t]}{q}" for t, q in zip(b["turn"].tolist(), numbers.tolist(), strict=True)]


def _change(before: np.void, after: np.void, now: str, then: str, row: int) -> Change | None:
    """Return the one value in which two blocks differ; None where these are none, or two."""
    pairs = [] if now == then else [("", now, then)]
    for name, field in (("X", "x"), ("Y", "y"), ("J", "count")):
        one, two = abs(int(before[field])), abs(int(after[field]))
        if one != two:
            pairs.append((name, str(one), str(two)))
    if before["axis"] != after["axis"]:
        pairs.append(("G", Axis(before["axis"]).name, Axis(after["axis"]).name))
    return Change(row, *pairs[0]) if len(pairs) == 1 else None


def _counts(way: Walk, rows: Ints, wanted: Ints) -> Iterator[tuple[Ints, Blocks]]:
    """Yield blocks with the J that would bring them to the wanted ends, and with the other G."""
    b = way.blocks[rows]
    every = np.arange(len(rows))
    line, arc = b["kind"] == Kind.LINE, b["kind"] == Kind.ARC
    for axis, name in ((Axis.X, 0), (Axis.Y, 1)):
        some = every[line & (b["axis"] == axis)]
        out = b[some]
        out["count"] = np.abs(wanted[some, name])
        yield some, out
    some = every[arc]
    if len(some):
        x, y = b["x"][some].astype(np.int64), b["y"][some].astype(np.int64)
        end = way.stepping.arc_end(x, y, b["turn"][some], x + wanted[some, 0], y + wanted[some, 1])
        of_axis = {Axis.X: end.count_x, Axis.Y: end.count_y}
        count = np.zeros(len(some), np.int64)
        for axis in Axis:
            counts = of_axis.get(axis, end.count_square)
            count = np.where(b["axis"][some] == axis, counts, count)
        out = b[some]
        out["count"] = np.where(end.landed, count, 0)
        yield some, out
    plain = every[(line | arc) & ((b["axis"] == Axis.X) | (b["axis"] == Axis.Y))]
    out = b[plain]
    out["axis"] = np.where(out["axis"] == Axis.X, Axis.Y, Axis.X)
    yield plain, out


def _sizes(way: Walk, rows: Ints, wanted: Ints) -> Iterator[tuple[Ints, Blocks]]:
    """Yield blocks with another X or Y, for which they run through the wanted ends."""
    b = way.blocks[rows]
    every = np.arange(len(rows))
    x, y = b["x"].astype(float), b["y"].astype(float)
    u, v = wanted[:, 0].astype(float), wanted[:, 1].astype(float)
    line = b["kind"] == Kind.LINE
    with np.errstate(divide="ignore", invalid="ignore"):
        chord = u * u + v * v
        # A line has the direction of its end; the ends of an arc are as far from its centre.
        solved_x = np.where(line, y * u / v, -(chord + 2.0 * y * v) / (2.0 * u))
        solved_y = np.where(line, x * v / u, -(chord + 2.0 * x * u) / (2.0 * v))
    count = b["count"].astype(float)
    for field, solved in (("x", solved_x), ("y", solved_y)):
        # J of a line along an axis is its length, that of a full circle four times the radius.
        size = np.where(line, count, count / 4.0)
        same = np.copysign(size, np.where(line, u if field == "x" else v, b[field]))
        for values in (solved, same):
            fine = np.isfinite(values) & (np.abs(values) < 2.0**31)
            some = every[fine]
            for d in range(-BESIDE, BESIDE + 1):
                out = b[some]
                out[field] = np.rint(values[some]).astype(np.int64) + d
                yield some, out


def _digits(way: Walk, rows: Ints) -> Iterator[tuple[Ints, Blocks]]:
    """Yield blocks with one other digit in X, Y or J."""
    b = way.blocks[rows]
    for field in ("x", "y", "count"):
        size, sign = np.abs(b[field]).astype(np.int64), np.sign(b[field])
        place = 1
        while (size >= place).any():
            some = np.flatnonzero(size >= place)
            digit = size[some] // place % 10
            for other in range(10):
                out = b[some]
                out[field] = sign[some] * (size[some] + (other - digit) * place)
                yield some, out
            place *= 10


def _signs(way: Walk, rows: Ints) -> Iterator[tuple[Ints, Blocks]]:
    """Yield blocks with the other sign of X, of Y, of both, arcs also with the other sense."""
    b = way.blocks[rows]
    every = np.arange(len(rows))
    for sense in (1, -1):
        some = every if sense > 0 else every[b["kind"] == Kind.ARC]
        for sign_x in (1, -1):
            for sign_y in (1, -1):
                out = b[some]
                out["x"] *= sign_x
                out["y"] *= sign_y
                out["turn"] *= sense
                yield some, out
