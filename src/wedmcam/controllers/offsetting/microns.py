"""The path on the controller's own grid: joints on whole steps, and arcs that arrive there.

The controller computes its path in fractions of a step and moves in whole ones. Every joint goes to
the nearest step. An arc takes a whole centre from which its interpolator stands on the end exactly;
of those near the true centre the one along which the staircase strays least (`staircase`). Where
there is none, joints next to the arc go to a neighbouring step, chosen together along the path;
where that does not help, the arc is parted. So the steps stay within 1.6 um of the exact path, and
within 1.59 um on the side of the outline.

wedmcam puts its own programs on the grid by the same rules. They are written here again, and share
nothing with those.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wedmcam.controllers.offsetting import staircase
from wedmcam.controllers.offsetting.path import Element
from wedmcam.controllers.offsetting.segment import Point
from wedmcam.controllers.offsetting.staircase import Curves, Places
from wedmcam.controllers.stepping import Stepping
from wedmcam.ir.program import BLOCK, Kind

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Blocks = NDArray[np.void]

#: A value this near below a half counts as the half: noise of float64 decides no step.
NOISE = 1e-7
#: Rounds of moving joints and parting arcs; each halves what is left.
ROUNDS = 24
#: A joint lies at most this far from the exact one where it is moved; um.
MOVED_UM = 1.05
#: What a joint costs by its distance from the exact one, in parts of what is allowed a um.
FAR = 0.05
#: An arc whose middle is this near to its chord may be stepped as a line; um.
FLAT_UM = 0.5
#: But better not: it costs so much more.
RATHER_AN_ARC = 0.5
#: With more than that no arc is taken where joints are chosen: it would stray.
TOO_FAR = 1.5
#: Height of the chords of an arc whose radius is too large for a block; um.
CHORD_UM = 0.3
#: Arcs shorter than this are not parted, but lines; um.
SHORT_ARC_UM = 4.0
#: Arcs of a larger sweep are parted in four (radians).
WIDE = 3.5
#: An arc of more than half a turn whose ends are at most this many steps apart is parted: on the
#: grid it could become a full circle, or nothing.
NEARLY_CLOSED = 4
#: Whole steps that are left free below the limits of a block.
SPARE = 2
NINE = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])


@dataclass(frozen=True, slots=True)
class BlockLimits:
    """What the controller's blocks can hold, and how they are stepped.

    Attributes:
        stepping: the interpolator, in the controller's own frame.
        line_um: largest component of a line. arc_um: largest coordinate and radius of an arc.
        count_um: largest J. All in steps.
    """

    stepping: Stepping
    line_um: int
    arc_um: int
    count_um: int

    @property
    def longest(self) -> int:
        """The largest component of a line that is counted."""
        return min(self.line_um, self.count_um)


@dataclass(frozen=True, slots=True)
class NoSteps:
    """An arc that begins ``at`` (um) has no steps within what is allowed."""

    at: Point


def on_grid(values: ArrayLike) -> Ints:
    """Return the nearest whole steps, halves away from zero.

    >>> on_grid([0.5, -0.5, 2.4, -2.6, 1.4999999999]).tolist()
    [1, -1, 2, -3, 2]
    """
    v = np.asarray(values, np.float64)
    return (np.sign(v) * np.floor(np.abs(v) + 0.5 + NOISE)).astype(np.int64)


def line_blocks(dx: int, dy: int, limits: BlockLimits) -> Blocks:
    """Return a line in as many blocks as the limits need; none where it has no length."""
    pieces = -(-max(abs(dx), abs(dy)) // limits.longest)
    k = np.arange(pieces + 1)
    x, y = dx * k // max(pieces, 1), dy * k // max(pieces, 1)
    return _lines(np.diff(x), np.diff(y), limits)


def _lines(dx: Ints, dy: Ints, limits: BlockLimits) -> Blocks:
    blocks = np.zeros(len(dx), BLOCK)
    blocks["kind"], blocks["x"], blocks["y"] = Kind.LINE, dx, dy
    blocks["axis"], blocks["count"] = limits.stepping.line_count(dx, dy)
    return blocks


def stepped(
    path: Sequence[Element], closed: bool, thread: tuple[int, int], left: bool, limits: BlockLimits
) -> tuple[Blocks, Ints] | NoSteps:
    """Return the blocks of a lead-in and a path, and the block of the outline that each is of.

    Args:
        path: each element from where the one before ends, um.
        closed: it ends at its start.
        thread: where the lead-in begins.
        left: whether the outline is to the left of the path.
        limits: of a block.

    Returns:
        Blocks, and for each the number of its element's block, -1 for those of the lead-in.
    """
    chain = _chain(path, closed, thread)
    _part_large_arcs(chain, left, limits)
    _part_long_lines(chain, limits)
    _part_nearly_closed(chain)
    for _ in range(ROUNDS):
        _settle_arcs(chain, left, limits)
        bad = np.flatnonzero(chain.state == _BAD)
        if not len(bad):
            return _blocks(chain, closed, limits)
        bad = _move_joints(chain, bad, left, limits)
        if len(bad):
            _part_bad_arcs(chain, bad)
    k = int(np.flatnonzero(chain.state == _BAD)[0])
    return NoSteps((float(chain.x[k]), float(chain.y[k])))


#: States of a piece: an arc that was not tried, one that arrives nowhere, an arc, a line.
_NEW, _BAD, _ARC, _LINE = -1, 0, 1, 2


@dataclass(slots=True)
class _Chain:
    """Pieces from joint to joint: piece k runs from joint k to joint k + 1.

    Attributes:
        x, y: exact joints, um. gx, gy: on the grid. fixed: may not go to another step than the
            nearest: thread point, start and end of the path.
        cx, cy, radius, turn, sweep: exact arcs; turn 0 for a line.
        of: number of the block of the outline; -1 for the lead-in.
        state: see above. ax, ay: start of an arc from its whole centre. axis, count: of it.
    """

    x: Floats
    y: Floats
    gx: Ints
    gy: Ints
    fixed: Bools
    cx: Floats
    cy: Floats
    radius: Floats
    turn: Ints
    sweep: Floats
    of: Ints
    state: Ints
    ax: Ints
    ay: Ints
    axis: Ints
    count: Ints

    def exact(self, rows: Ints, left: bool) -> Curves:
        """Return the exact pieces ``rows``."""
        return Curves(
            self.x[rows],
            self.y[rows],
            self.x[rows + 1],
            self.y[rows + 1],
            self.cx[rows],
            self.cy[rows],
            self.radius[rows],
            self.turn[rows],
            np.full(len(rows), 1 if left else -1),
        )

    def places(self, rows: Ints) -> Places:
        """Return between which steps the pieces ``rows`` run."""
        return Places(self.gx[rows], self.gy[rows], self.gx[rows + 1], self.gy[rows + 1])

    def reach(self) -> Ints:
        """Return how far each piece goes on x or y, whichever is more, steps."""
        return np.maximum(np.abs(np.diff(self.gx)), np.abs(np.diff(self.gy)))

    def heights(self, rows: Ints) -> Floats:
        """Return how far the middles of arcs are from their chords, um."""
        half = np.minimum(self.sweep[rows], np.pi) / 2
        result: Floats = self.radius[rows] * (1 - np.cos(half))
        return result


#: Columns of `_Chain` that say something of a piece.
_PIECES = tuple(_Chain.__slots__)[5:]


def _chain(path: Sequence[Element], closed: bool, thread: tuple[int, int]) -> _Chain:
    s = [element.segment for element in path]
    end = s[0].start if closed else s[-1].end
    x = np.array([thread[0], *(one.x0 for one in s), end[0]], np.float64)
    y = np.array([thread[1], *(one.y0 for one in s), end[1]], np.float64)
    n = len(s) + 1
    fixed = np.zeros(n + 1, bool)
    fixed[[0, 1, n]] = True
    turn = np.array([0, *(one.turn for one in s)], np.int64)
    cx = np.array([0.0, *(one.cx for one in s)])
    cy = np.array([0.0, *(one.cy for one in s)])
    zero = np.zeros(n, np.int64)
    return _Chain(
        x=x,
        y=y,
        gx=on_grid(x),
        gy=on_grid(y),
        fixed=fixed,
        cx=cx,
        cy=cy,
        # An arc runs on the circle on which it starts: its start may have moved (`path.MEET_UM`).
        radius=np.where(turn != 0, np.hypot(x[:-1] - cx, y[:-1] - cy), 0.0),
        turn=turn,
        sweep=np.array([0.0, *(one.sweep for one in s)]),
        of=np.array([-1, *(element.block for element in path)], np.int64),
        state=np.where(turn != 0, _NEW, _LINE),
        ax=zero,
        ay=zero.copy(),
        axis=zero.copy(),
        count=zero.copy(),
    )


def _part(chain: _Chain, rows: Ints, pieces: Ints, state: int | None = None) -> Ints:
    """Part pieces into equal ones at places of the exact line or arc; return the new joints.

    ``state``: of what the parts are then; None: not tried yet.
    """
    count = np.ones(len(chain.of), np.int64)
    count[rows] = pieces
    k = np.repeat(np.arange(len(count)), count)
    number = np.arange(len(k)) - np.repeat(np.cumsum(count) - count, count)
    share = number / count[k]
    angle = np.arctan2(chain.y[k] - chain.cy[k], chain.x[k] - chain.cx[k])
    angle += chain.turn[k] * chain.sweep[k] * share
    arc = chain.turn[k] != 0
    x = np.where(
        arc,
        chain.cx[k] + chain.radius[k] * np.cos(angle),
        chain.x[k] + (chain.x[k + 1] - chain.x[k]) * share,
    )
    y = np.where(
        arc,
        chain.cy[k] + chain.radius[k] * np.sin(angle),
        chain.y[k] + (chain.y[k + 1] - chain.y[k]) * share,
    )
    new = number > 0
    touched = np.isin(k, rows)
    for name, values in (("x", x), ("y", y)):
        old, grid = getattr(chain, name), getattr(chain, f"g{name}")
        setattr(chain, name, np.append(np.where(new, values, old[k]), old[-1]))
        setattr(chain, f"g{name}", np.append(np.where(new, on_grid(values), grid[k]), grid[-1]))
    chain.fixed = np.append(np.where(new, False, chain.fixed[k]), chain.fixed[-1])
    for name in _PIECES:
        setattr(chain, name, getattr(chain, name)[k])
    chain.sweep /= count[k]
    fresh = np.where(chain.turn != 0, _NEW, _LINE) if state is None else state
    chain.state = np.where(touched, fresh, chain.state)
    if state == _LINE:
        chain.turn[touched] = 0
    return np.flatnonzero(new)


def _part_large_arcs(chain: _Chain, left: bool, limits: BlockLimits) -> None:
    """Make chords of arcs whose radius is too large, their joints off the outline."""
    rows = np.flatnonzero((chain.turn != 0) & (chain.radius > limits.arc_um - SPARE))
    if not len(rows):
        return
    step = 2 * np.arccos(1 - CHORD_UM / chain.radius[rows])
    pieces = np.ceil(chain.sweep[rows] / step).astype(np.int64)
    outline_inside = (chain.turn[rows] > 0) == left
    cx, cy, radius = chain.cx[rows], chain.cy[rows], chain.radius[rows]
    wanted = np.where(outline_inside, CHORD_UM, -0.1)
    v = _part(chain, rows, pieces, _LINE)
    k = np.repeat(np.arange(len(rows)), pieces - 1)
    px, py = chain.gx[v][:, None] + NINE[:, 0], chain.gy[v][:, None] + NINE[:, 1]
    outside = np.hypot(px - cx[k][:, None], py - cy[k][:, None]) - radius[k][:, None]
    moved = np.hypot(px - chain.x[v][:, None], py - chain.y[v][:, None])
    best = np.argmin(np.abs(outside - wanted[k][:, None]) + 0.02 * moved, axis=1)
    chain.gx[v], chain.gy[v] = px[np.arange(len(v)), best], py[np.arange(len(v)), best]


def _part_long_lines(chain: _Chain, limits: BlockLimits) -> None:
    most = limits.longest - SPARE
    rows = np.flatnonzero((chain.turn == 0) & (chain.reach() > most))
    if len(rows):
        _part(chain, rows, -(-chain.reach()[rows] // most))


def _part_nearly_closed(chain: _Chain) -> None:
    x, y = chain.x, chain.y
    whole = (x[1:] == x[:-1]) & (y[1:] == y[:-1])
    near = (chain.turn != 0) & (chain.sweep > np.pi) & ~whole & (chain.reach() <= NEARLY_CLOSED)
    rows = np.flatnonzero(near)
    if len(rows):
        _part(chain, rows, np.full(len(rows), 2))


def _settle_arcs(chain: _Chain, left: bool, limits: BlockLimits) -> None:
    """Find steps for all arcs that were not tried, between the steps of their joints."""
    rows = np.flatnonzero(chain.state == _NEW)
    speck = (chain.reach()[rows] == 0) & (chain.sweep[rows] < np.pi)
    chain.state[rows[speck]] = _LINE
    rows = rows[~speck]
    if not len(rows):
        return
    exact, at = chain.exact(rows, left), chain.places(rows)
    best = staircase.arcs(exact, at, limits.stepping, limits.arc_um, limits.count_um)
    arrives = best.stray <= 1.0
    flat = (chain.heights(rows) <= FLAT_UM) & (staircase.chords(exact, at) <= 1.0)
    chain.state[rows] = np.where(arrives, _ARC, np.where(flat, _LINE, _BAD))
    chain.ax[rows], chain.ay[rows] = at.x0 - best.cx, at.y0 - best.cy
    chain.axis[rows], chain.count[rows] = best.axis, best.count


def _move_joints(chain: _Chain, bad: Ints, left: bool, limits: BlockLimits) -> Ints:
    """Move joints next to arcs that arrive nowhere; return the arcs for which that is no help."""
    moving = np.zeros(len(chain.x), bool)
    moving[bad] = moving[bad + 1] = True
    moving &= ~chain.fixed
    # Where each joint may go to.
    steps: list[NDArray[np.int64]] = [np.zeros((0, 2), np.int64)] * len(chain.x)
    for v in range(len(chain.x)):
        steps[v] = np.array([[chain.gx[v], chain.gy[v]]])
        if moving[v]:
            near = on_grid([chain.x[v], chain.y[v]]) + NINE
            far = np.hypot(near[:, 0] - chain.x[v], near[:, 1] - chain.y[v])
            steps[v] = near[far <= MOVED_UM]
    involved = np.flatnonzero(moving[:-1] | moving[1:])
    strays = _strays(chain, involved, steps, left, limits)
    failed = set(bad.tolist())
    helpless = sorted(failed - set(involved.tolist()))
    stretch: list[int] = []
    for k in involved.tolist():
        stretch.append(k)
        if moving[k + 1]:
            continue
        joints = [*stretch, k + 1]
        chosen = _least([strays[q] for q in stretch], [_far(chain, v, steps[v]) for v in joints])
        if chosen is None:
            helpless += [q for q in stretch if q in failed]
        else:
            for v, c in zip(joints, chosen, strict=True):
                chain.gx[v], chain.gy[v] = steps[v][c]
            arcs = [q for q in stretch if chain.turn[q]]
            chain.state[arcs] = _NEW
        stretch = []
    return np.array(helpless, np.int64)


def _far(chain: _Chain, v: int, steps: Ints) -> Floats:
    result: Floats = FAR * np.hypot(steps[:, 0] - chain.x[v], steps[:, 1] - chain.y[v])
    return result


def _strays(
    chain: _Chain, rows: Ints, steps: Sequence[Ints], left: bool, limits: BlockLimits
) -> dict[int, Floats]:
    """Return for each piece how far it strays from each step of its start to each of its end.

    In parts of what is allowed, inf where that is too much or it does not arrive.
    """
    if not len(rows):
        return {}
    shapes = [(len(steps[k]), len(steps[k + 1])) for k in rows.tolist()]
    of = np.repeat(rows, [a * b for a, b in shapes])
    pairs = [
        np.hstack([np.repeat(steps[k], len(steps[k + 1]), axis=0),
                   np.tile(steps[k + 1], (len(steps[k]), 1))])
        for k in rows.tolist()
    ]  # fmt: skip
    at = Places(*np.concatenate(pairs).T)
    exact = chain.exact(of, left)
    stray = np.full(len(of), np.inf)
    line = exact.turn == 0
    stray[line] = staircase.lines(exact.take(line), at.take(line))
    stray[line & (stray > 1.0)] = np.inf
    if not line.all():
        arc = ~line
        one, places = exact.take(arc), at.take(arc)
        best = staircase.arcs(one, places, limits.stepping, limits.arc_um, limits.count_um).stray
        best[best > 1.0] = np.inf
        # Start and end on one step: nothing, unless it is a whole turn.
        still = (places.x0 == places.x1) & (places.y0 == places.y1)
        best[still & (chain.sweep[of[arc]] < 2 * np.pi)] = np.inf
        chord = staircase.chords(one, places)
        flat = (chain.heights(of[arc]) <= FLAT_UM) & (chord <= 1.0)
        stray[arc] = np.minimum(best, np.where(flat, chord + RATHER_AN_ARC, np.inf))
    stray[stray > TOO_FAR] = np.inf
    sizes = np.cumsum([0, *(a * b for a, b in shapes)])
    return {
        k: stray[sizes[n] : sizes[n + 1]].reshape(shapes[n]) for n, k in enumerate(rows.tolist())
    }


def _least(strays: Sequence[Floats], far: Sequence[Floats]) -> list[int] | None:
    """Return the choice at each joint with which the pieces stray least, or None for no choice.

    From joint to joint: of all ways to a choice only the best goes on (Viterbi). The worst piece
    counts most: strays enter with their fourth power.
    """
    best, came_from = far[0], []
    for stray, more in zip(strays, far[1:], strict=True):
        total = best[:, None] + stray**4 + more
        came_from.append(np.argmin(total, axis=0))
        best = np.min(total, axis=0)
    choice = int(np.argmin(best))
    if not np.isfinite(best[choice]):
        return None
    choices = [choice]
    for before in reversed(came_from):
        choices.append(int(before[choices[-1]]))
    return choices[::-1]


def _part_bad_arcs(chain: _Chain, bad: Ints) -> None:
    """Part arcs in two, wide ones in four; what is too short becomes a line."""
    wide = chain.sweep[bad] > WIDE
    short = (chain.radius[bad] * chain.sweep[bad] < SHORT_ARC_UM) & ~wide
    chain.state[bad[short]] = _LINE
    bad, wide = bad[~short], wide[~short]
    if not len(bad):
        return
    # Joints go back to where they belong: the parts start anew, and their neighbours with them.
    joints = np.concatenate([bad, bad + 1])
    joints = joints[~chain.fixed[joints]]
    chain.gx[joints], chain.gy[joints] = on_grid(chain.x[joints]), on_grid(chain.y[joints])
    beside = np.concatenate([bad - 1, bad + 1])
    beside = beside[(beside >= 0) & (beside < len(chain.of))]
    chain.state[beside[chain.turn[beside] != 0]] = _NEW
    _part(chain, bad, np.where(wide, 4, 2))


def _blocks(chain: _Chain, closed: bool, limits: BlockLimits) -> tuple[Blocks, Ints]:
    dx, dy = np.diff(chain.gx), np.diff(chain.gy)
    arc = (chain.turn != 0) & (chain.state == _ARC)
    blocks = _lines(dx, dy, limits)
    blocks["kind"][arc] = Kind.ARC
    for name in ("turn", "axis", "count"):
        blocks[name][arc] = getattr(chain, name)[arc]
    blocks["x"][arc], blocks["y"][arc] = chain.ax[arc], chain.ay[arc]
    keep = arc | (dx != 0) | (dy != 0)
    blocks, of = blocks[keep], chain.of[keep]
    if len(blocks) == 1 and not closed and blocks["kind"][0] == Kind.LINE:
        return _in_two(blocks, of, limits)
    return blocks, of


def _in_two(blocks: Blocks, of: Ints, limits: BlockLimits) -> tuple[Blocks, Ints]:
    """Return a line in two: a program in which it stands alone has a move there."""
    x, y = int(blocks["x"][0]), int(blocks["y"][0])
    if max(abs(x), abs(y)) < 2:
        return blocks, of
    hx, hy = (int(v) for v in on_grid([x / 2, y / 2]))
    return _lines(np.array([hx, x - hx]), np.array([hy, y - hy]), limits), np.repeat(of, 2)
