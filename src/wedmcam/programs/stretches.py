"""What each stretch of a decoded program is: lead, path, overcut, pause; told from the path alone.

A decoded program knows no roles. But a lead is straight and run back the same way at the end of its
contour, and what is run there and back past the point where the contour closed is overcut. Writers
of drawings and of part programs tell by this what the first programmer meant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, counted, warning
from wedmcam.ir.program import Kind, Program

Ints = NDArray[np.int64]
Blocks = NDArray[np.void]


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """What is cut between two moves.

    Attributes:
        lead_in: blocks (numbers from 0) from the thread point to the path; lead_out: back from it.
        path: blocks of the contour, or of what is no contour with a lead.
        overcut: blocks past the start of a closed path and back.
        pauses: pauses within the stretch, each by the number of the cutting block before it.
        closed: the path ends on the micron where it starts.
    """

    lead_in: Ints
    path: Ints
    overcut: Ints
    lead_out: Ints
    pauses: tuple[int, ...]
    closed: bool


def stretches(blocks: Blocks, starts: Ints, ends: Ints) -> list[Stretch]:
    """Return what is cut between the moves of a program.

    Args:
        blocks: dtype `ir.program.BLOCK`, as decoded.
        starts: where each block begins, um, shape (n, 2).
        ends: where its last step ends.
    """
    kinds = blocks["kind"]
    cutting = np.flatnonzero(kinds < Kind.MOVE)
    number = np.cumsum(kinds == Kind.MOVE)[cutting]
    runs = np.split(cutting, np.flatnonzero(np.diff(number)) + 1) if len(cutting) else []
    pauses = np.flatnonzero(kinds == Kind.PAUSE)
    out = []
    for run in runs:
        # A move of length 0 leaves one pause (2-3b.md): the next contour has the same thread point.
        own = pauses[(pauses > run[0]) & (pauses < run[-1])]
        after = np.searchsorted(run, own)
        home = starts[run[0]]
        again = np.unique(after[(ends[run[after - 1]] == home).all(axis=1)])
        out += [_stretch(blocks, part, starts, ends) for part in np.split(run, again)]
    return out


def beside(kinds: NDArray[np.uint8], runs: list[Stretch]) -> list[int]:
    """Return the pauses that are neither in a stretch nor made by the moves between two.

    Args:
        kinds: of all blocks.
        runs: what `stretches` told of them.
    """
    numbers, first = set(), 0
    for one in runs:
        parts = np.concatenate([one.lead_in, one.path, one.overcut, one.lead_out])
        start, end = int(parts.min()), int(parts.max())
        numbers |= set(range(start, end + 1))
        between = np.arange(first, start)
        moves = between[kinds[between] == Kind.MOVE]
        if len(moves):
            numbers |= {int(moves[0]) - 1, int(moves[-1]) + 1}
        elif first:
            numbers.add(start - 1)  # a move of length 0
        first = end + 1
    return [int(i) for i in np.flatnonzero(kinds == Kind.PAUSE) if int(i) not in numbers]


def _stretch(blocks: Blocks, rows: Ints, starts: Ints, ends: Ints) -> Stretch:
    leads = _leads(blocks, rows, starts, ends)
    path = rows[leads : len(rows) - leads]
    over = path[:0]
    home = (ends[path] == starts[path[0]]).all(axis=1)
    if leads and len(path) > 1 and home.any():
        closed = int(np.argmax(home)) + 1
        rest = path[closed:]
        half = len(rest) // 2
        back = rest[half:][::-1]
        there_and_back = len(rest) % 2 == 0 and (ends[rest[:half]] == starts[back]).all()
        if half and there_and_back:
            path, over = path[:closed], rest
    kinds = blocks["kind"]
    within = np.arange(rows[0], rows[-1])
    pauses = within[kinds[within] == Kind.PAUSE]
    before = rows[np.searchsorted(rows, pauses) - 1]
    return Stretch(
        rows[:leads],
        path,
        over,
        rows[len(rows) - leads :],
        tuple(before.tolist()),
        bool((ends[path[-1]] == starts[path[0]]).all()),
    )


def _leads(blocks: Blocks, rows: Ints, starts: Ints, ends: Ints) -> int:
    """Return how many blocks at the start of a contour are a lead; as many at its end go back."""
    way = ends[rows[0]] - starts[rows[0]]
    count = 0
    while 2 * count + 2 < len(rows):
        i, j = rows[count], rows[-1 - count]
        there, back = ends[i] - starts[i], ends[j] - starts[j]
        straight = blocks["kind"][i] == Kind.LINE and blocks["kind"][j] == Kind.LINE
        same = (ends[i] == starts[j]).all() and (starts[i] == ends[j]).all()
        # Pieces of one line agree within the micron that each end is rounded to.
        bend = abs(int(way[0]) * int(there[1]) - int(way[1]) * int(there[0]))
        room = 2.0 * (np.hypot(*way) + np.hypot(*there))
        if not (straight and same and (there == -back).all() and bend <= room):
            break
        if int(way @ there) <= 0:
            break
        count += 1
    return count


def words_left_out(program: Program, rows: list[int], output: str) -> list[Diagnostic]:
    """Return the warning that names control words which have no place in what is written.

    Args:
        program: as decoded.
        rows: numbers of the blocks that are such words, from 0.
        output: what is written, for people: "a drawing".
    """
    if not rows:
        return []
    words = dict(program.words)
    return [
        warning(
            "not-carried",
            "control words that have no place in {output}, left out: {words}",
            program.spans[rows[0]] if rows[0] < len(program.spans) else None,
            hint="see to it at the machine",
            count=len(rows),
            output=output,
            words=counted(words[i] for i in rows),
        )
    ]
