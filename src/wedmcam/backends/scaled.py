"""Outlines whose arcs the controller scales by a gap: numbers that come out as the path proven.

The controller scales x, y and J of each arc by (R + gap) / R or (R - gap) / R and rounds. So for
each arc of the offset path numbers of the outline are sought that come out as the arc that was
proven. An arc that grows leaves some whole numbers out: there the nearest is taken, and the next
line of the contour takes the difference up, so that the contour still closes.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks
from wedmcam.controllers import Stepping
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.controllers.scaling import scale
from wedmcam.controllers.zd065.data import OUTLINE
from wedmcam.diag import Severity
from wedmcam.formats import lines
from wedmcam.ir.program import Kind, Program, Role
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
#: R may be stated off by this share, so that the rounding falls better; its error is the gap times
#: as much.
SHARE = 0.01
MOST_OFF = 100


def outline_of(
    program: Program,
    machine: Machine,
    checks: Checks,
    gap_um: int,
    outwards: bool,
    grown: NDArray[np.integer[Any]] | None,
    most_um: int,
    instead: str,
) -> NDArray[np.void] | None:
    """Return the outline that a file states, dtype `OUTLINE`; None where it cannot, as checked.

    Args:
        program: the offset path.
        machine: whose controller makes the path of the outline.
        checks: takes what is found.
        gap_um: see `b4.encode`.
        outwards: see `b4.encode`.
        grown: see `b4.encode`.
        most_um: the largest gap that the controller takes.
        instead: a format that takes any path, for hints.
    """
    blocks = program.blocks
    arc = blocks["kind"] == Kind.ARC
    if grown is None:
        assert not gap_um
        grown = np.where(blocks["turn"] < 0, -1, 1)
    sign: Ints = grown.astype(np.int64)  # products with the gap need the room
    radius = np.floor(np.hypot(blocks["x"], blocks["y"]) + 0.5).astype(np.int64)
    checks.tell(
        Severity.ERROR,
        "gap-value",
        np.full(len(blocks), not 0 <= gap_um <= most_um),
        "block {block}: a gap of {gap_mm:.3f} mm; the controller takes up to {most_mm:.3f} mm",
        lambda i: {"gap_mm": gap_um / 1000, "most_mm": most_um / 1000},
    )
    checks.tell(
        Severity.ERROR,
        "not-tangent",
        arc & (sign > 0) & (radius - gap_um < 1),
        "block {block}: the wire goes round a sharp corner of the outline",
        lambda i: {"format": instead},
        hint="round the corners (--corner), or --to {format}",
    )
    if checks.failed:
        return None
    figure = outline(blocks, gap_um, outwards, sign)
    figure, lost = closed(figure, program, gap_um, outwards, machine.own_stepping)
    checks.tell(
        Severity.ERROR,
        "not-reachable",
        lost,
        "block {block}: the contour cannot end where it started with a gap of {gap_mm:.3f} mm: no "
        "line follows its arcs to take up what scaling rounds off",
        lambda i: {"gap_mm": gap_um / 1000, "format": instead},
        hint="another gap by some um, or --to {format}",
    )
    return None if checks.failed else figure


def outline(blocks: NDArray[np.void], gap_um: int, outwards: bool, grown: Ints) -> NDArray[np.void]:
    """Return blocks of an outline (dtype `OUTLINE`) that the gap makes into ``blocks``, or nearly.

    Args:
        blocks: dtype `BLOCK`.
        gap_um: whole um.
        outwards: see `b4.encode`.
        grown: see `b4.encode`.
    """
    n = len(blocks)
    arc = blocks["kind"] == Kind.ARC
    straight = (blocks["kind"] == Kind.LINE) | (blocks["kind"] == Kind.MOVE)
    x, y, count = (blocks[k].astype(np.int64) for k in ("x", "y", "count"))
    lx, ly, _ = lines.full(x, y, blocks["axis"], count)
    figure = np.zeros(n, dtype=OUTLINE)
    figure["kind"], figure["turn"] = blocks["kind"], np.where(arc, blocks["turn"], 0)
    figure["axis"] = np.where(arc, blocks["axis"], 0)
    figure["grows"] = np.where(arc, grown * (1 if outwards else -1), 0)
    figure["x"], figure["y"] = np.where(straight, lx, x), np.where(straight, ly, y)
    figure["count"] = np.where(arc, count, 0)
    rows = np.flatnonzero(arc)
    if not len(rows):
        return figure
    exact = np.hypot(x[rows], y[rows]) - grown[rows] * gap_um
    radius = np.maximum(np.floor(exact + 0.5), 1).astype(np.int64)
    figure["radius"][rows] = radius
    if not gap_um:
        return figure
    todo = np.arange(len(rows))
    for off in sorted(range(-MOST_OFF, MOST_OFF + 1), key=abs):
        todo = todo[abs(off) <= np.maximum(SHARE * radius[todo], 0)]
        if not len(todo):
            break
        tried = _scaled_back(figure[rows[todo]], blocks[rows[todo]], radius[todo] + off, gap_um,
                             grown[rows[todo]])  # fmt: skip
        good = _same(scale(tried, gap_um, outwards), blocks[rows[todo]])
        figure[rows[todo[good]]] = tried[good]
        todo = todo[~good]
    left = np.setdiff1d(rows, rows[_reached(figure[rows], blocks[rows], gap_um, outwards)])
    for row in left.tolist():
        one = slice(row, row + 1)
        own = radius[rows == row]
        figure[one] = _nearest(figure[one], blocks[one], gap_um, outwards, grown[one], own)
    return figure


def _reached(
    figure: NDArray[np.void], blocks: NDArray[np.void], gap_um: int, outwards: bool
) -> NDArray[np.bool_]:
    return _same(scale(figure, gap_um, outwards), blocks)


def _same(a: NDArray[np.void], b: NDArray[np.void]) -> NDArray[np.bool_]:
    return np.asarray((a["x"] == b["x"]) & (a["y"] == b["y"]) & (a["count"] == b["count"]))


def _scaled_back(
    figure: NDArray[np.void],
    blocks: NDArray[np.void],
    radius: Ints,
    gap_um: int,
    grown: Ints,
) -> NDArray[np.void]:
    """Return arcs of the outline, with R as given, whose scaling comes nearest to ``blocks``."""
    out = figure.copy()
    radius = np.maximum(radius, np.where(grown < 0, gap_um + 1, 1))
    out["radius"] = radius
    share = radius / (radius + grown.astype(np.float64) * gap_um)
    for name in ("x", "y", "count"):
        value = blocks[name] * share
        out[name] = (np.sign(value) * np.floor(np.abs(value) + 0.5)).astype(np.int64)
    return out


def _nearest(
    figure: NDArray[np.void],
    block: NDArray[np.void],
    gap_um: int,
    outwards: bool,
    grown: Ints,
    radius: Ints,
) -> NDArray[np.void]:
    """Return the arc of the outline whose scaling starts and ends nearest to one block."""
    off = max(int(SHARE * radius[0]), 1)
    radii = np.unique(np.linspace(radius[0] - off, radius[0] + off, 9).astype(np.int64))
    base = _scaled_back(
        np.repeat(figure, len(radii)),
        np.repeat(block, len(radii)),
        radii,
        gap_um,
        np.repeat(grown, len(radii)),
    )
    steps = np.array([(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in range(-3, 4)])
    tried = np.repeat(base, len(steps))
    for column, name in enumerate(("x", "y", "count")):
        tried[name] += np.tile(steps[:, column], len(radii))
    ok = (tried["count"] > 0) & (np.sign(tried["x"]) * np.sign(block["x"]) >= 0)
    ok &= np.sign(tried["y"]) * np.sign(block["y"]) >= 0
    tried = tried[ok]
    path = scale(tried, gap_um, outwards)
    keep = path["x"].astype(np.int64) ** 2 + path["y"].astype(np.int64) ** 2 >= 2
    tried, path = tried[keep], path[keep]
    if not len(tried):
        return base[:1]
    moved, wanted = MIRROR.run(path), MIRROR.run(block)
    start = np.hypot(path["x"] - block["x"][0], path["y"] - block["y"][0])
    end = np.hypot(moved.dx - wanted.dx[0], moved.dy - wanted.dy[0])
    best = int(np.lexsort((start + end, np.maximum(start, end)))[0])
    chosen: NDArray[np.void] = tried[best : best + 1]
    return chosen


def closed(
    figure: NDArray[np.void], program: Program, gap_um: int, outwards: bool, stepping: Stepping
) -> tuple[NDArray[np.void], NDArray[np.bool_]]:
    """Let lines of the contour take up what the arcs before them are off.

    Returns:
        The figure, and the blocks at which a contour is left open because no line came.
    """
    blocks = program.blocks
    lost = np.zeros(len(blocks), dtype=bool)
    path = scale(figure, gap_um, outwards)
    have, want = stepping.run(path), stepping.run(blocks)
    off_x, off_y = have.dx - want.dx, have.dy - want.dy
    arc = blocks["kind"] == Kind.ARC
    if not (arc & ((off_x != 0) | (off_y != 0))).any():
        return figure, lost
    ex = ey = 0
    for k in range(len(blocks)):
        kind, role = blocks["kind"][k], blocks["role"][k]
        if kind == Kind.ARC:
            ex, ey = ex + int(off_x[k]), ey + int(off_y[k])
        elif (ex or ey) and kind == Kind.LINE and role == Role.CONTOUR:
            x, y = int(figure["x"][k]) - ex, int(figure["y"][k]) - ey
            if x or y:
                figure["x"][k], figure["y"][k] = x, y
                ex = ey = 0
        elif (ex or ey) and kind != Kind.PAUSE:
            lost[max(k - 1, 0)] = True
            ex = ey = 0
    if ex or ey:
        lost[-1] = True
    return figure, lost
