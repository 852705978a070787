"""A program for another controller: the same path, in blocks that the other format can state.

Formats count arcs on an axis or on the inscribed square, step lines by one of two tables, hold
numbers up to a limit and know some control records. What a program means is the path that its own
controller steps, so blocks are made anew from where it really goes: a line to where it ends, an arc
to the step at which it ends. Whoever writes the result proves it against the first program; nothing
here has to be believed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Motion, Stepping
from wedmcam.diag import Diagnostic, Span, counted, error, warning
from wedmcam.ir.program import BLOCK, Axis, Kind, Program

Ints = NDArray[np.int64]
Blocks = NDArray[np.void]


@dataclass(frozen=True, slots=True)
class Rules:
    """What the other format asks for.

    Attributes:
        square: arcs count on the inscribed square, not on an axis.
        stepping: of the other controller, as it looks from the drawing.
        count_um: largest J. line_um: largest component of a line.
        keeps: whether a bare control word stays one.
        pairs: a line alone between two pauses would be read as a move.
        turns: a block may hold more than a turn.
        square_axis: how the square counts at a tie, `Axis` SQUARE or SQUARE_X.
        end: there is a record for the end of the file beside that for the end of cutting.
    """

    square: bool
    stepping: Stepping
    count_um: int
    line_um: int
    keeps: Callable[[str], bool]
    pairs: bool
    end: bool
    turns: bool = True
    square_axis: Axis = Axis.SQUARE


def carry(
    program: Program, stepping: Stepping, rules: Rules
) -> tuple[Program | None, list[Diagnostic]]:
    """Return the program for another controller, and what could not be carried over.

    Args:
        program: as its own reader made it.
        stepping: of the controller that it was read for.
        rules: of the format that it goes to.

    Returns:
        A program that ends every block of the first where that ends, in as many blocks or more; a
        block's ``source`` is the block that it was made of, ``sources`` are the places in the file
        that was read. None when a block cannot be run at all.
    """
    blocks = program.blocks
    motion = stepping.run(blocks)
    findings: list[Diagnostic] = []
    endless = np.flatnonzero(motion.steps < 0)
    for i in endless[:1].tolist():
        findings.append(
            error(
                "endless-block",
                "block {block} never ends on its own controller: it is no path to carry over",
                _span(program, i),
                block=i + 1,
            )
        )
    if findings:
        return None, findings
    kind = blocks["kind"].astype(np.int64)
    moving = kind <= Kind.MOVE
    kept = ~moving | (motion.steps > 0)
    words = dict(program.words)
    lost = np.array([i for i, word in words.items() if not rules.keeps(word)], dtype=np.int64)
    if len(lost):
        findings.append(
            warning(
                "not-carried",
                "control words that have no place in the other format, left out: {words}",
                _span(program, int(lost[0])),
                hint="see to it at the machine",
                count=len(lost),
                words=counted(words[i] for i in lost.tolist()),
            )
        )
        kept[lost] = False
    stops = np.flatnonzero((kind == Kind.STOP) | (kind == Kind.END))
    if len(stops) and not rules.end:
        kept[stops[1:]] = False
    after = np.arange(len(blocks)) > (stops[0] if len(stops) else len(blocks))
    late = np.flatnonzero(after & moving & kept)
    if len(late):
        findings.append(
            warning(
                "not-carried",
                "{blocks} blocks behind the end of cutting are no part of the path; left out",
                _span(program, int(late[0])),
                blocks=len(late),
            )
        )
        kept[late] = False
    parts = _parts(blocks, motion, kept, rules, stepping)
    out = np.zeros(len(parts.source), BLOCK)
    for name in ("kind", "turn", "axis", "x", "y", "count", "source"):
        out[name] = getattr(parts, name)
    out["cut"], out["role"] = blocks["cut"][parts.source], blocks["role"][parts.source]
    if rules.pairs:
        out = _never_alone(out, rules.stepping)
    carried_words = tuple(
        (k, words[int(s)]) for k, s in enumerate(out["source"]) if int(s) in words
    )
    sources = tuple(program.spans)
    if len(sources) != len(blocks):
        out["source"], sources = -1, ()
    return replace(program, blocks=out, sources=sources, spans=(), words=carried_words), findings


def _span(program: Program, i: int) -> Span | None:
    return program.spans[i] if i < len(program.spans) else None


@dataclass(slots=True)
class _Parts:
    """Blocks in the making; ``source`` is the block that each is a part of."""

    kind: Ints
    turn: Ints
    axis: Ints
    x: Ints
    y: Ints
    count: Ints
    source: Ints


def _parts(
    blocks: Blocks, motion: Motion, kept: NDArray[np.bool_], rules: Rules, stepping: Stepping
) -> _Parts:
    """Return every kept block as one or more blocks that the other format can state."""
    kind = blocks["kind"].astype(np.int64)
    arc = kind == Kind.ARC
    straight = (kind == Kind.LINE) | (kind == Kind.MOVE)
    # In how many pieces: a line by its longer side, an arc by its steps, or by whole turns,
    # which end where they start.
    longest = np.maximum(abs(motion.dx), abs(motion.dy))
    pieces = np.where(kept, 1, 0)
    most = min(rules.line_um, rules.count_um)
    pieces = np.where(straight & kept, -(-longest // most), pieces)
    # J of one that is counted alike is known, and cutting it where it fits would move the path.
    alike = rules.square and stepping == rules.stepping
    counted = blocks["count"] if alike else motion.steps
    counted = np.where(blocks["axis"] == int(rules.square_axis), counted, motion.steps)
    halves = -(-counted // (2 * rules.count_um)) if rules.count_um else 1
    long = np.where(counted > rules.count_um, halves * 2, 1)
    x, y = blocks["x"], blocks["y"]
    whole = stepping.arc_end(x, y, np.where(arc, blocks["turn"], 1), x, y).steps
    rounds = np.where(arc & (not rules.turns), -(-motion.steps // np.maximum(whole, 1)), 1)
    long = np.where(rounds > 1, rounds, long)
    pieces = np.where(arc & kept, long, pieces)
    pieces = np.where(kept & (straight | arc), np.maximum(pieces, 1), pieces)
    source = np.repeat(np.arange(len(blocks)), pieces)
    nth = np.arange(len(source)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    of = pieces[source]
    steps = motion.steps[source]
    low, high = steps * nth // of, steps * (nth + 1) // of
    by_turn = (arc & (rounds > 1))[source]
    low = np.where(by_turn, nth * whole[source], low)
    high = np.where(by_turn, np.minimum((nth + 1) * whole[source], steps), high)
    part = blocks[source].copy()
    x0, y0 = stepping.position(part, low)
    x1, y1 = stepping.position(part, high)
    last = nth == of - 1
    x1, y1 = np.where(last, motion.dx[source], x1), np.where(last, motion.dy[source], y1)
    dx, dy = x1 - x0, y1 - y0
    out = _Parts(
        kind=kind[source],
        turn=part["turn"].astype(np.int64),
        axis=np.zeros(len(source), np.int64),
        x=dx.copy(),
        y=dy.copy(),
        count=np.zeros(len(source), np.int64),
        source=source.astype(np.int64),
    )
    line = straight[source]
    axis, count = rules.stepping.line_count(dx, dy)
    out.axis = np.where(line, axis, 0)
    out.count = np.where(line, count, 0)
    rows = np.flatnonzero(arc[source])
    sx, sy = part["x"][rows] + x0[rows], part["y"][rows] + y0[rows]
    return _with_arcs(out, rows, sx, sy, dx[rows], dy[rows], (high - low)[rows], rules)


def _with_arcs(
    out: _Parts, rows: Ints, sx: Ints, sy: Ints, dx: Ints, dy: Ints, steps: Ints, rules: Rules
) -> _Parts:
    """Fill in the arcs: start from the centre, and the J that stops at the same step.

    On the inscribed square not every step counts. Where the last one does not, the arc stops at
    the one before that does, and a line of a micron or two goes on to the end. The path comes by an
    end once a turn: what ``steps`` go beyond that are whole turns.
    """
    end = rules.stepping.arc_end(sx, sy, out.turn[rows], sx + dx, sy + dy, rules.square_axis)
    whole = rules.stepping.arc_end(sx, sy, out.turn[rows], sx, sy, rules.square_axis)
    turns = np.where(end.landed, (steps - end.steps) // np.maximum(whole.steps, 1), 0)
    out.x[rows], out.y[rows] = sx, sy
    if not rules.square:
        out.axis[rows] = end.last_axis
        x, y = (end.count_x + turns * whole.count_x, end.count_y + turns * whole.count_y)
        out.count[rows] = np.where(end.last_axis == Axis.X, x, y)
        return out
    square = end.count_square + turns * whole.count_square
    out.axis[rows], out.count[rows] = int(rules.square_axis), square
    short = ~end.square_counts
    if not short.any():
        return out
    cut = np.zeros(int(short.sum()), BLOCK)
    for name, values in (("x", sx), ("y", sy), ("count", square)):
        cut[name] = values[short]
    cut["kind"], cut["turn"], cut["axis"] = Kind.ARC, out.turn[rows][short], rules.square_axis
    there = rules.stepping.run(cut)
    rest_x, rest_y = dx[short] - there.dx, dy[short] - there.dy
    axis, count = rules.stepping.line_count(rest_x, rest_y)
    at = rows[short] + 1
    gone = np.flatnonzero(square[short] == 0)

    def insert(values: Ints, new: Ints | int) -> Ints:
        added: Ints = np.insert(values, at, new)
        return added

    # An arc that has no counting step at all is the line alone.
    keep = np.ones(len(out.kind), dtype=bool)
    keep[rows[short][gone]] = False
    keep = np.insert(keep, at, (rest_x != 0) | (rest_y != 0))
    parts = _Parts(
        kind=insert(out.kind, int(Kind.LINE)),
        turn=insert(out.turn, 0),
        axis=insert(out.axis, axis),
        x=insert(out.x, rest_x),
        y=insert(out.y, rest_y),
        count=insert(out.count, count),
        source=insert(out.source, out.source[rows[short]]),
    )
    for name in _Parts.__slots__:
        setattr(parts, name, getattr(parts, name)[keep])
    return parts


def _never_alone(blocks: Blocks, stepping: Stepping) -> Blocks:
    """Write a single line between two pauses as two: alone it would be read as a move."""
    kind = blocks["kind"]
    quiet = (kind == Kind.PAUSE) | (kind == Kind.THREAD)
    alone = np.zeros(len(blocks), dtype=bool)
    alone[1:-1] = (kind[1:-1] == Kind.LINE) & quiet[:-2] & quiet[2:]
    alone &= np.maximum(abs(blocks["x"]), abs(blocks["y"])) > 1
    if not alone.any():
        return blocks
    at = np.flatnonzero(alone)
    both = np.insert(blocks, at + 1, blocks[at])
    first = at + np.arange(len(at))
    for name in ("x", "y"):
        half = blocks[name][at] // 2
        both[name][first] = half
        both[name][first + 1] = blocks[name][at] - half
    rows = np.concatenate([first, first + 1])
    both["axis"][rows], both["count"][rows] = stepping.line_count(both["x"][rows], both["y"][rows])
    return both
