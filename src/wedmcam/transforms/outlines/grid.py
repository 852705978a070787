"""Outlines on the grid of their format, so that the controller's own path strays least.

The controller rounds twice: the outline is whole numbers, and so is the path that it makes beside
it. Places of the grid are chosen together with the microns that the path then runs on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.geom import segments as seg
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import TAU, Floats, Ints, Segments
from wedmcam.ir.contour import Contour
from wedmcam.ir.program import Role
from wedmcam.ir.programmed import PROGRAMMED
from wedmcam.transforms.lower import CHORD_SAG_UM
from wedmcam.transforms.lower.repair import best_chain

#: Arcs shorter than so many steps of the grid are lines.
SHORT = 8.0
#: Candidates of a vertex, the nearest place of the grid first, in steps of it.
NINE = np.array([(0, 0), *((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if i or j)])
#: A stray into the part counts so much more than one away from it: 1.6 um and 2.0 are allowed.
INTO_PART = 1.25
#: Arcs whose candidates are looked at together: so much memory.
AT_ONCE = 500
#: What a pair of candidates costs more that turned out badly.
BANNED = 10.0
#: Centres that are tried beside the nearest on the grid.
AROUND = np.array([(i, j) for i in range(-3, 4) for j in range(-3, 4)])

Blocks = NDArray[np.void]


@dataclass(frozen=True, slots=True)
class Grid:
    """What the format can state.

    Attributes:
        step_um: between two numbers.
        line_um: largest component of a line. arc_um: largest radius.
    """

    step_um: float = 1.0
    line_um: int = 999_999
    arc_um: int = 999_999

    def put(self, values: Floats) -> Floats:
        """Return the nearest numbers of the grid, halves away from zero, um.

        >>> Grid(0.1).put(np.array([0.26, -1.25])).tolist()
        [0.3, -1.3]
        """
        v = np.asarray(values, np.float64) / self.step_um
        per = round(1.0 / self.step_um)
        whole = np.sign(v) * np.floor(np.abs(v) + 0.5 + 1e-7)
        return np.asarray(whole / per)


def put_on_grid(
    outline: Contour,
    s: Segments,
    grid: Grid,
    shift: float,
    path: Contour,
    bans: Sequence[tuple[int, ...]],
) -> tuple[Blocks, Ints]:
    """Return an open outline as motions whose numbers are on the grid, and what was chosen.

    Arcs take the centre of the grid with which start, middle and end are nearest to the true arc,
    start and end being as far from it as each other; arcs of a few steps become lines.

    Returns:
        Motions, and for each the row of its segment and the candidates of start and end.
    """
    pieces = _pieces(s, grid)
    of = np.repeat(np.arange(len(s)), pieces)
    part = np.arange(len(of)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    length = s.length[of]
    x, y = seg.points_at(s.take(of), length * part / pieces[of])
    # Vertices of the drawing as they are, not as an arc computes them.
    first = np.flatnonzero(part == 0)
    x[first], y[first] = s.x0[of[first]], s.y0[of[first]]
    x, y = np.append(x, s.x1[-1]), np.append(y, s.y1[-1])
    gx, gy = grid.put(x), grid.put(y)
    corner = np.append(first, len(of))
    gx[corner], gy[corner], choice = _vertices(x[corner], y[corner], s, grid, shift, path, bans)
    turn = s.turn[of].astype(np.int64)
    turn[s.radius[of] > grid.arc_um - 2] = 0
    still = (gx[1:] == gx[:-1]) & (gy[1:] == gy[:-1])
    whole = still & (turn != 0) & (length / pieces[of] > 4.0 * s.radius[of])
    turn[(length / pieces[of] < SHORT * grid.step_um) & ~whole] = 0
    keep = np.flatnonzero(~still | whole)
    rows = np.zeros(len(keep), PROGRAMMED)
    rows["role"] = Role.CONTOUR
    rows["turn"] = turn[keep]
    rows["x0"], rows["y0"] = gx[keep], gy[keep]
    after = np.append(keep[1:], len(of))
    rows["x1"], rows["y1"] = gx[after], gy[after]
    arc = np.flatnonzero(rows["turn"] != 0)
    if len(arc):
        k = of[keep[arc]]
        rows["cx"][arc], rows["cy"][arc], _, _ = _centres(rows[arc], s, k, grid)
    row = of[keep]
    return rows, np.column_stack([row, choice[row], choice[row + 1]])


def _vertices(
    x: Floats,
    y: Floats,
    s: Segments,
    grid: Grid,
    shift: float,
    path: Contour,
    bans: Sequence[tuple[int, ...]],
) -> tuple[Floats, Floats, Ints]:
    """Return vertices of an open outline on the grid, and which candidate each is.

    Each vertex has nine candidates; of all chains through them the one is taken along which the
    wire, on the microns that the controller puts it, strays least, strays into the part counting
    more (``_strays``). Start and end of a closed outline were chosen before.

    Args:
        x, y: of the segments' starts, and of the last one's end.
        s: the segments.
        grid: of the format.
        shift: of the wire to the left, um.
        path: of the wire.
        bans: (row, candidate of its start, of its end) that are not to be taken.
    """
    (ax, ay), (bx, by) = _beside(x, y, s, shift, path)
    cx = grid.put(grid.put(x)[:, None] + NINE[:, 0] * grid.step_um)
    cy = grid.put(grid.put(y)[:, None] + NINE[:, 1] * grid.step_um)
    away = np.hypot(cx - x[:, None], cy - y[:, None])
    if x[0] == x[-1] and y[0] == y[-1]:
        away[[0, -1], 1:] = np.inf  # the first is the nearest
    dx, dy = cx - x[:, None], cy - y[:, None]
    # Where the controller's path then has its vertices: whole um.
    ends = [
        (to_grid(px[:, None] + dx) - px[:, None], to_grid(py[:, None] + dy) - py[:, None])
        for px, py in ((ax, ay), (bx, by))
    ]
    tables = _strays(s, cx, cy, ends, grid, shift)
    for row, a, b in bans:
        tables[row, a, b] += BANNED
    chain = best_chain(list(tables), [np.where(np.isfinite(a), 0.02 * a, np.inf) for a in away])
    assert chain is not None  # the nearest places are always there
    k, c = np.arange(len(x)), np.array(chain)
    return cx[k, c], cy[k, c], c


def _beside(
    x: Floats, y: Floats, s: Segments, shift: float, path: Contour
) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Return the path's vertices before and after each vertex of the outline, um.

    On the normal of the segment before, and on that of the one after; at an inner corner both are
    the vertex of the path nearest to these.
    """
    sx, sy = seg.start_tangents(s)
    ex, ey = seg.end_tangents(s)
    ax, ay, bx, by = x.copy(), y.copy(), x.copy(), y.copy()
    ax[1:], ay[1:] = x[1:] - shift * ey, y[1:] + shift * ex
    bx[:-1], by[:-1] = x[:-1] - shift * sy, y[:-1] + shift * sx
    ax[0], ay[0], bx[-1], by[-1] = bx[0], by[0], ax[-1], ay[-1]
    cross = (ex[:-1] * sy[1:] - ey[:-1] * sx[1:]) * np.sign(shift)
    v = path.vertices
    for k in (np.flatnonzero(cross > 1e-3) + 1).tolist():
        d = np.hypot(v["x"] - 0.5 * (ax[k] + bx[k]), v["y"] - 0.5 * (ay[k] + by[k]))
        near = int(np.argmin(d))
        ax[k] = bx[k] = v["x"][near]
        ay[k] = by[k] = v["y"][near]
    return (ax, ay), (bx, by)


def _strays(
    s: Segments,
    cx: Floats,
    cy: Floats,
    ends: list[tuple[Floats, Floats]],
    grid: Grid,
    shift: float,
) -> Floats:
    """Return what each pair of candidates costs each segment, shape (segments, 9, 9).

    Args:
        s: segments of the outline.
        cx, cy: candidates of its vertices, shape (segments + 1, 9), um.
        ends: how far the path's vertices before and after each vertex are off then, x and y.
        grid: of the format.
        shift: of the wire to the left, um.
    """
    side = np.sign(shift)

    def cost(off: Floats) -> Floats:  # off: away from the part
        return np.asarray(np.where(off < 0, INTO_PART * off, off) ** 4)

    (sx, sy), (ex, ey) = seg.start_tangents(s), seg.end_tangents(s)
    start = side * (sx[:, None] * ends[1][1][:-1] - sy[:, None] * ends[1][0][:-1])
    end = side * (ex[:, None] * ends[0][1][1:] - ey[:, None] * ends[0][0][1:])
    total = cost(start)[:, :, None] + cost(end)[:, None, :]
    arc = np.flatnonzero((s.turn != 0) & (s.radius <= grid.arc_um - 2))
    if not len(arc):
        return np.asarray(total**0.25)
    count = len(NINE)
    for low in range(0, len(arc), AT_ONCE):
        some = arc[low : low + AT_ONCE]
        shape = (len(some), count, count)
        rows = np.zeros(len(some) * count * count, PROGRAMMED)
        for name, values in (("x0", cx[some][:, :, None]), ("y0", cy[some][:, :, None])):
            rows[name] = np.broadcast_to(values, shape).ravel()
        for name, values in (("x1", cx[some + 1][:, None, :]), ("y1", cy[some + 1][:, None, :])):
            rows[name] = np.broadcast_to(values, shape).ravel()
        _, _, torn, middle = _centres(rows, s, np.repeat(some, count * count), grid)
        bulge = side * -s.turn[some][:, None, None] * middle.reshape(shape)
        total[some] += 2.0 * cost(bulge) + np.asarray(0.5 * torn.reshape(shape)) ** 4
    return np.asarray(total**0.25)


def _pieces(s: Segments, grid: Grid) -> Ints:
    """Return in how many motions a segment is written: what is too large for one is parted."""
    most = float(grid.line_um - 2)
    reach = np.maximum(np.abs(s.x1 - s.x0), np.abs(s.y1 - s.y0))
    pieces = np.where(s.turn == 0, np.ceil(reach / most), 1.0)
    large = np.flatnonzero((s.turn != 0) & (s.radius > grid.arc_um - 2))
    if len(large):
        step = 2.0 * np.arccos(1.0 - CHORD_SAG_UM / s.radius[large])
        pieces[large] = np.ceil(s.sweep[large] / step)
    return np.maximum(pieces, 1.0).astype(np.int64)


def _centres(
    rows: Blocks, s: Segments, k: Ints, grid: Grid
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return centres on the grid for arcs that were segments ``k``.

    Returns:
        x, y; by how much the end is farther from it than the start or nearer, and how far the
        middle of the arc is outside of the true one, um.
    """
    bx, by = grid.put(s.cx[k]), grid.put(s.cy[k])
    x0, y0, x1, y1 = (rows[n] for n in ("x0", "y0", "x1", "y1"))
    dx, dy = x1 - x0, y1 - y0
    chord = dx * dx + dy * dy
    safe = np.where(chord > 0, chord, 1.0)
    mx, my = seg.points_at(s.take(k), 0.5 * s.length[k])
    sweep, turn = s.sweep[k], s.turn[k]
    best = np.zeros((4, len(k)))
    best[0], best[1] = bx, by
    least = np.full(len(k), np.inf)
    for i, j in AROUND.tolist():
        cx, cy = grid.put(bx + i * grid.step_um), grid.put(by + j * grid.step_um)
        torn = np.abs(np.hypot(x0 - cx, y0 - cy) - np.hypot(x1 - cx, y1 - cy))
        # The controller's centre: as far from the end as from the start.
        along = ((cx - 0.5 * (x0 + x1)) * dx + (cy - 0.5 * (y0 + y1)) * dy) / safe
        qx, qy = np.where(chord > 0, cx - along * dx, cx), np.where(chord > 0, cy - along * dy, cy)
        middle = np.hypot(x0 - qx, y0 - qy) - np.hypot(mx - qx, my - qy)
        off = np.hypot(cx - s.cx[k], cy - s.cy[k])
        cost = 0.5 * torn + np.abs(middle) + 0.05 * off
        reach = np.hypot(x0 - cx, y0 - cy)
        cost = np.where(chord > 0, cost, np.abs(reach - s.radius[k]) + off)
        turned = np.arctan2(y1 - cy, x1 - cx) - np.arctan2(y0 - cy, x0 - cx)
        turned = np.where(chord > 0, np.mod(turn * turned, TAU), TAU)
        cost = np.where(np.abs(turned - sweep) < 1.0, cost, np.inf)
        better = cost < least
        least = np.where(better, cost, least)
        best = np.where(better, np.stack([cx, cy, torn, middle]), best)
    return best[0], best[1], best[2], best[3]
