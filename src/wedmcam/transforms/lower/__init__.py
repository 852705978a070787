"""Lowering: from the exact path to the controller's integers, as a closed loop.

Every vertex is put on a micron, and every block is chosen so that the simulated controller ends on
the micron of its end vertex exactly: then nothing adds up, and a closed path closes. Lines always
do. For an arc the neighbouring centres are tried (``fit``); where none lands within the budget of
deviation, its ends move by a micron (``repair``); where that does not help either, it is split at a
point of the true arc. One lowering serves all formats: an arc is accepted only if its last step
counts both on its G axis and on the inscribed square.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.diag import Diagnostic, Place, error, note, warning
from wedmcam.geom import measure
from wedmcam.geom.quantize import to_grid
from wedmcam.geom.segments import TAU, Floats, Ints
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import BLOCK, Axis, Kind, Program, Role
from wedmcam.transforms.lower import moves
from wedmcam.transforms.lower.fit import Arcs, Budget, Ideal, chord_cost, fit_arcs, line_cost
from wedmcam.transforms.lower.layout import Layout, lay_out
from wedmcam.transforms.lower.marks import short_marks
from wedmcam.transforms.lower.repair import best_chain
from wedmcam.transforms.lower.steps import in_steps

if TYPE_CHECKING:
    from wedmcam.controllers.eindhoven.vectors import Vectors

__all__ = ["Budget", "Rules", "lower"]

#: Rounds of repairing and splitting; each halves what is left, so this is far more than needed.
ROUNDS = 24
#: An arc whose middle is this near to its chord may be stepped as a line; um.
FLAT_UM = 0.5
#: Sagitta of the chords of an arc whose radius does not fit the format; um.
CHORD_SAG_UM = 0.3
#: A repaired vertex lies at most this far from the true one; um.
MOVED_UM = 1.05
NEIGHBOURS = np.array([(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)])
#: Arcs shorter than this are not split further; um.
UNSPLIT_UM = 4.0
#: Arcs of a larger sweep are split in four (radians).
WIDE = 3.5


@dataclass(frozen=True, slots=True)
class Rules:
    """What lowering must know of the machine.

    Attributes:
        stepping: the controller's interpolator, as it looks from the drawing.
        square: arcs count on the inscribed square (compact format), not on an axis.
        square_axis: how that square counts at a tie, `Axis` SQUARE or SQUARE_X.
        count_um: largest J. line_um: largest line component. arc_um: largest arc coordinate and
            radius.
        textbook: J by geometry, for controllers that recompute the ends of arcs.
        move_um: largest |x| and |y| of a move between two cuts; None for any.
        step_um: how far a step moves the machine. The limits above count steps.
        vectors: the controller runs vectors alone: this is it at its cutting speed; None for one
            that runs lines and arcs.
        moving: what runs the moves between two cuts; None for ``stepping``.
        travel: the largest way along x and along y of the drawing that vectors can be computed for;
            None for any.
    """

    stepping: Stepping
    square: bool = False
    square_axis: Axis = Axis.SQUARE
    count_um: int = 999_999
    line_um: int = 999_999
    move_um: int | None = 999_999
    arc_um: int = 999_999
    textbook: bool = False
    step_um: float = 1.0
    vectors: Vectors | None = None
    moving: Stepping | None = None
    travel: tuple[int, int] | None = None

    @property
    def per_mm(self) -> float:
        """How many steps go to a mm."""
        return 1000.0 / self.step_um

    def place(self, x: float, y: float) -> Place:
        """Return a place that is given in steps."""
        return Place(float(x) / self.per_mm, float(y) / self.per_mm)


@dataclass(slots=True)
class _State:
    """The course as arrays, growing when something is split."""

    v0: Ints
    v1: Ints
    cx: Floats
    cy: Floats
    radius: Floats
    turn: Ints
    source: Ints
    role: Ints
    cut: Ints
    keeps: Ints
    group: Ints
    x: Floats
    y: Floats
    pinned: NDArray[np.bool_]
    gx: Ints
    gy: Ints
    #: arcs: -1 not tried, 0 failed, 1 an arc was found, 2 stepped as a line
    done: Ints
    axis: Ints
    count: Ints
    square: Ints
    ax: Ints
    ay: Ints


#: Columns of a segment.
SEGMENT = (
    "v0",
    "v1",
    "cx",
    "cy",
    "radius",
    "turn",
    "source",
    "role",
    "cut",
    "keeps",
    "group",
    "done",
    "axis",
    "count",
    "square",
    "ax",
    "ay",
)
#: Those that the course states and that are whole numbers.
STATED = ("v0", "v1", "turn", "source", "role", "cut", "keeps", "group")


def lower(plan: Plan, rules: Rules) -> tuple[Program | None, list[Diagnostic]]:
    """Return the program of a plan, and what had to be done to make it.

    The program starts at the thread point of the first cut. Blocks carry role, cut number and
    source. Every arc ends on a whole micron that the next block starts from.

    Findings: ``over-travel``, ``move-too-long``, ``stop-too-short``, ``overcut-too-short`` and
    ``cannot-lower`` (errors), ``radius-over-limit`` (warning: chords), ``blocks-split`` and
    ``specks-dropped`` (notes).
    """
    findings: list[Diagnostic] = []
    plan = in_steps(plan, rules.step_um)
    far = _over_travel(plan, rules)
    if far:
        return None, far
    layout = lay_out(plan)
    s = _state(layout)
    if rules.vectors is not None:
        _cut_into_vectors(s, rules.vectors)
    findings += _chords_over_limit(s, layout, rules)
    _split_long_lines(s, rules)
    _split_nearly_closed(s)
    budget = Budget()
    splits = 0
    for _ in range(ROUNDS):
        _try_arcs(s, rules, budget)
        bad = np.flatnonzero(s.done == 0)
        if not len(bad):
            break
        bad = _repair(s, bad, rules, budget)
        if len(bad):
            splits += len(bad)
            _split(s, bad)
    bad = np.flatnonzero(s.done == 0)
    if len(bad):
        k = int(bad[0])
        findings.append(
            error(
                "cannot-lower",
                "an arc near {place} has no stepped image within the budget of deviation",
                layout.sources[s.source[k]] if s.source[k] >= 0 else None,
                hint="please report the drawing",
                place=rules.place(s.x[s.v0[k]], s.y[s.v0[k]]),
            )
        )
        return None, findings
    if splits:
        findings.append(
            note(
                "blocks-split",
                "{arcs} arcs were split so that the path stays within {within_um:g} um",
                arcs=splits,
                within_um=2 * rules.step_um,
            )
        )
    short = short_marks(s.gx, s.gy, layout, plan, rules)
    if short:
        return None, findings + short
    program, more = _blocks(s, layout, plan, rules)
    return program, findings + more


def _over_travel(plan: Plan, rules: Rules) -> list[Diagnostic]:
    """Return an error where a plan in steps is larger than vectors can be computed for."""
    if rules.travel is None or not plan.cuts:
        return []
    boxes = measure.extents_of_all([(cut.path.vertices, cut.path.closed) for cut in plan.cuts])
    threads = np.array([cut.thread for cut in plan.cuts], float)
    every = np.vstack([boxes[:, :2], boxes[:, 2:], threads])
    size = every.max(axis=0) - every.min(axis=0)
    over = size - np.array(rules.travel)
    axis = int(np.argmax(over))
    if over[axis] <= 2.0:  # rounded to the grid it may fit; the writer knows
        return []
    place = rules.place(*every.max(axis=0))
    return [
        error(
            "over-travel",
            "the path goes {length_mm:.3f} mm along {axis} of the drawing, up to {place}; the "
            "table goes {most_mm:.3f} mm",
            hint="move or turn the part, or split it (--cuts); dem15-steps has a table twice as "
            "large as dem15",
            points_mm=(place,),
            length_mm=float(size[axis]) / rules.per_mm,
            axis="xy"[axis],
            place=place,
            most_mm=rules.travel[axis] / rules.per_mm,
        )
    ]


def _state(layout: Layout) -> _State:
    ints = {n: np.array(getattr(layout, n), np.int64) for n in STATED}
    n = len(layout.v0)
    x, y = np.array(layout.x), np.array(layout.y)
    zero = np.zeros(n, np.int64)
    return _State(
        **ints,
        cx=np.array(layout.cx),
        cy=np.array(layout.cy),
        radius=np.array(layout.radius),
        x=x,
        y=y,
        pinned=np.array(layout.pinned, bool),
        gx=to_grid(x),
        gy=to_grid(y),
        done=np.where(ints["turn"] != 0, -1, 2),
        axis=zero.copy(),
        count=zero.copy(),
        square=zero.copy(),
        ax=zero.copy(),
        ay=zero.copy(),
    )


def _ideal(s: _State, rows: Ints) -> Ideal:
    a, b = s.v0[rows], s.v1[rows]
    return Ideal(
        s.x[a],
        s.y[a],
        s.x[b],
        s.y[b],
        s.cx[rows],
        s.cy[rows],
        s.radius[rows],
        s.turn[rows],
        s.keeps[rows],
    )


def _sweeps(s: _State, rows: Ints) -> tuple[Floats, Floats]:
    """Return the polar angle of the start and the sweep of true arcs; a = b is a full turn."""
    a, b = s.v0[rows], s.v1[rows]
    a0 = np.arctan2(s.y[a] - s.cy[rows], s.x[a] - s.cx[rows])
    a1 = np.arctan2(s.y[b] - s.cy[rows], s.x[b] - s.cx[rows])
    sweep = np.mod((a1 - a0) * s.turn[rows], TAU)
    return a0, np.where(a == b, TAU, sweep)


def _replace(s: _State, rows: Ints, pieces: Ints, chords: bool) -> NDArray[np.bool_]:
    """Split segments ``rows`` into ``pieces`` equal parts at points of the true segment.

    Arcs stay arcs unless ``chords``. New vertices may move by a micron like any other. Returns
    which segments are parts.
    """
    count = np.ones(len(s.v0), np.int64)
    count[rows] = pieces
    of = np.repeat(np.arange(len(s.v0)), count)
    part = np.arange(len(of)) - np.repeat(np.cumsum(count) - count, count)
    inner = np.flatnonzero(part > 0)
    k = of[inner]
    share = part[inner] / count[k]
    a0, sweep = _sweeps(s, k)
    angle = a0 + s.turn[k] * sweep * share
    arc = s.turn[k] != 0
    a, b = s.v0[k], s.v1[k]
    nx = np.where(arc, s.cx[k] + s.radius[k] * np.cos(angle), s.x[a] + (s.x[b] - s.x[a]) * share)
    ny = np.where(arc, s.cy[k] + s.radius[k] * np.sin(angle), s.y[a] + (s.y[b] - s.y[a]) * share)
    new = np.arange(len(s.x), len(s.x) + len(nx))
    s.x, s.y = np.append(s.x, nx), np.append(s.y, ny)
    s.gx, s.gy = np.append(s.gx, to_grid(nx)), np.append(s.gy, to_grid(ny))
    s.pinned = np.append(s.pinned, np.zeros(len(nx), bool))
    v0, v1 = s.v0[of], s.v1[of]
    v0[inner] = new
    v1[inner - 1] = new
    for name in SEGMENT:
        setattr(s, name, getattr(s, name)[of])
    s.v0, s.v1 = v0, v1
    touched = np.isin(of, rows)
    if chords:
        s.turn[touched] = 0
        s.done[touched] = 2
    else:
        s.done[touched] = np.where(s.turn[touched] != 0, -1, 2)
    return touched


def _cut_into_vectors(s: _State, vectors: Vectors) -> None:
    """Part all segments into vectors that the controller runs within the budget; no arc is left."""
    from wedmcam.transforms.lower import chords

    _choose_points(s, np.arange(len(s.x)), vectors)
    open_ = np.ones(len(s.v0), bool)
    for _ in range(ROUNDS):
        rows = np.flatnonzero(open_)
        a, b = s.v0[rows], s.v1[rows]
        _, sweep = _sweeps(s, rows)
        ends = s.gx[a], s.gy[a], s.gx[b], s.gy[b]
        needed = chords.pieces(_ideal(s, rows), sweep, ends, vectors)
        more = needed > 1
        if not more.any():
            break
        known = len(s.x)
        open_ = _replace(s, rows[more], needed[more], chords=False)
        _choose_points(s, np.arange(known, len(s.x)), vectors)
    s.turn[:], s.done[:] = 0, 2


def _choose_points(s: _State, vertices: Ints, vectors: Vectors) -> None:
    """Choose places of the grid for some vertices; those that are pinned stay."""
    from wedmcam.transforms.lower import chords

    free = vertices[~s.pinned[vertices]]
    number = np.full(len(s.x), -1)
    number[free] = np.arange(len(free))
    rows = np.flatnonzero((number[s.v0] >= 0) | (number[s.v1] >= 0))
    if not len(rows):
        return
    starts, ends = number[s.v0[rows]], number[s.v1[rows]]
    some, others = np.flatnonzero(starts >= 0), np.flatnonzero(ends >= 0)
    s.gx[free], s.gy[free] = chords.points(
        _ideal(s, rows),
        (some, starts[some]),
        (others, ends[others]),
        s.x[free],
        s.y[free],
        (s.gx[free], s.gy[free]),
        vectors,
    )


def _chords_over_limit(s: _State, layout: Layout, rules: Rules) -> list[Diagnostic]:
    rows = np.flatnonzero((s.turn != 0) & (s.radius > rules.arc_um - 2))
    if not len(rows):
        return []
    _, sweep = _sweeps(s, rows)
    step = 2 * np.arccos(1 - CHORD_SAG_UM / s.radius[rows])
    findings = []
    for k, n in zip(rows.tolist(), np.ceil(sweep / step).astype(int).tolist(), strict=True):
        findings.append(
            warning(
                "radius-over-limit",
                "an arc of radius {radius_mm:.3f} mm is over the format's limit of {most_mm:.3f} "
                "mm: cut as {chords} chords within {within_um:g} um",
                layout.sources[s.source[k]] if s.source[k] >= 0 else None,
                radius_mm=float(s.radius[k]) / rules.per_mm,
                most_mm=rules.arc_um / rules.per_mm,
                chords=n,
                within_um=CHORD_SAG_UM * rules.step_um,
            )
        )
    first = len(s.x)
    keeps_inside = s.keeps[rows] * s.turn[rows] > 0
    pieces = np.ceil(sweep / step).astype(np.int64)
    cx, cy, radius = s.cx[rows], s.cy[rows], s.radius[rows]
    outwards = np.where(s.keeps[rows] == 0, 0.0, np.where(keeps_inside, CHORD_SAG_UM, -0.1))
    _replace(s, rows, pieces, chords=True)
    # The microns of the new vertices are free to choose: on the side away from the kept material.
    of = np.repeat(np.arange(len(rows)), pieces - 1)
    v = np.arange(first, len(s.x))
    px, py = s.gx[v][:, None] + NEIGHBOURS[:, 0], s.gy[v][:, None] + NEIGHBOURS[:, 1]
    off = np.hypot(px - cx[of][:, None], py - cy[of][:, None]) - radius[of][:, None]
    away = np.hypot(px - s.x[v][:, None], py - s.y[v][:, None])
    best = np.argmin(np.abs(off - outwards[of][:, None]) + 0.02 * away, axis=1)
    s.gx[v], s.gy[v] = px[np.arange(len(v)), best], py[np.arange(len(v)), best]
    return findings


def _split_long_lines(s: _State, rules: Rules) -> None:
    a, b = s.v0, s.v1
    reach = np.maximum(np.abs(s.gx[b] - s.gx[a]), np.abs(s.gy[b] - s.gy[a]))
    limit = min(rules.line_um, rules.count_um) - 2
    rows = np.flatnonzero((s.turn == 0) & (reach > limit))
    if len(rows):
        _replace(s, rows, -(-reach[rows] // limit), chords=False)


def _split_nearly_closed(s: _State) -> None:
    """Split arcs of nearly a turn: on the grid they could become a full circle, or nothing."""
    a, b = s.v0, s.v1
    near = np.maximum(np.abs(s.gx[b] - s.gx[a]), np.abs(s.gy[b] - s.gy[a])) <= 4
    rows = np.flatnonzero((s.turn != 0) & (a != b) & near)
    _, sweep = _sweeps(s, rows)
    rows = rows[sweep > np.pi]
    if len(rows):
        _replace(s, rows, np.full(len(rows), 2), chords=False)


def _try_arcs(s: _State, rules: Rules, budget: Budget) -> None:
    """Fit all arcs that were not tried, between the microns that their vertices are on."""
    rows = np.flatnonzero(s.done == -1)
    a, b = s.v0[rows], s.v1[rows]
    speck = (a != b) & (s.gx[a] == s.gx[b]) & (s.gy[a] == s.gy[b])
    s.done[rows[speck]] = 2
    rows = rows[~speck]
    if not len(rows):
        return
    a, b = s.v0[rows], s.v1[rows]
    ideal = _ideal(s, rows)
    got = fit_arcs(
        ideal,
        s.gx[a],
        s.gy[a],
        s.gx[b],
        s.gy[b],
        budget,
        rules.arc_um,
        rules.count_um,
        rules.stepping,
        textbook=rules.textbook,
        square=rules.square_axis,
    )
    _take(s, rows, got)
    flat = ~got.ok & _flat(s, rows)
    if flat.any():
        cost = chord_cost(ideal, s.gx[a], s.gy[a], s.gx[b], s.gy[b], budget)
        s.done[rows[flat & (cost <= 1.0)]] = 2


def _flat(s: _State, rows: Ints) -> NDArray[np.bool_]:
    _, sweep = _sweeps(s, rows)
    sag = s.radius[rows] * (1 - np.cos(np.minimum(sweep, np.pi) / 2))
    result: NDArray[np.bool_] = sag <= FLAT_UM
    return result


def _take(s: _State, rows: Ints, got: Arcs) -> None:
    s.done[rows] = got.ok.astype(np.int64)
    s.axis[rows], s.count[rows], s.square[rows] = got.axis, got.count, got.square
    s.ax[rows], s.ay[rows] = s.gx[s.v0[rows]] - got.cx, s.gy[s.v0[rows]] - got.cy


def _repair(s: _State, bad: Ints, rules: Rules, budget: Budget) -> Ints:
    """Move vertices next to failed arcs; return the arcs that fail all the same."""
    n = len(s.v0)
    uses = np.bincount(s.v0, minlength=len(s.x)) + np.bincount(s.v1, minlength=len(s.x))
    movable = ~s.pinned & (uses == 2)
    dirty = np.zeros(len(s.x), bool)
    dirty[s.v0[bad]] = dirty[s.v1[bad]] = True
    dirty &= movable
    linked = np.zeros(n, bool)  # segment k and k + 1 meet in a dirty vertex
    linked[:-1] = (s.v1[:-1] == s.v0[1:]) & dirty[s.v1[:-1]]
    involved = dirty[s.v0] | dirty[s.v1]
    rows = np.flatnonzero(involved)
    if not len(rows):
        return bad
    # Candidates of each vertex, as a padded table.
    cand_x, cand_y = s.gx[:, None].copy(), s.gy[:, None].copy()
    numbers = np.flatnonzero(dirty)
    options: dict[int, tuple[Ints, Ints]] = {}
    bx, by = to_grid(s.x[numbers]), to_grid(s.y[numbers])
    for v, px, py in zip(numbers.tolist(), bx.tolist(), by.tolist(), strict=True):
        qx, qy = px + NEIGHBOURS[:, 0], py + NEIGHBOURS[:, 1]
        near = np.hypot(qx - s.x[v], qy - s.y[v]) <= MOVED_UM
        options[v] = (qx[near], qy[near])

    def choices(v: int) -> tuple[Ints, Ints]:
        return options.get(v) or (cand_x[v], cand_y[v])

    # All pairs of all involved segments in one evaluation.
    seg_of, ax, ay, bx_, by_ = [], [], [], [], []
    shape = {}
    for k in rows.tolist():
        (px, py), (qx, qy) = choices(int(s.v0[k])), choices(int(s.v1[k]))
        shape[k] = (len(px), len(qx))
        i, j = np.divmod(np.arange(len(px) * len(qx)), len(qx))
        seg_of.append(np.full(len(i), k))
        ax.append(px[i])
        ay.append(py[i])
        bx_.append(qx[j])
        by_.append(qy[j])
    of = np.concatenate(seg_of)
    cost = _pair_costs(
        s,
        of,
        np.concatenate(ax),
        np.concatenate(ay),
        np.concatenate(bx_),
        np.concatenate(by_),
        rules,
        budget,
    )
    at = np.cumsum([0, *(shape[k][0] * shape[k][1] for k in rows.tolist())])
    table = {k: cost[at[m] : at[m + 1]].reshape(shape[k]) for m, k in enumerate(rows.tolist())}
    still = []
    failed = set(bad.tolist())
    run: list[int] = []
    for k in rows.tolist():
        run.append(k)
        if linked[k]:
            continue
        vertices = [int(s.v0[run[0]]), *(int(s.v1[q]) for q in run)]
        extra = []
        for v in vertices:
            qx, qy = choices(v)
            extra.append(0.05 * np.hypot(qx - s.x[v], qy - s.y[v]))
        chain = best_chain([table[q] for q in run], extra)
        if chain is None:
            still += [q for q in run if q in failed]
        else:
            for v, c in zip(vertices, chain, strict=True):
                qx, qy = choices(v)
                s.gx[v], s.gy[v] = qx[c], qy[c]
            arcs = [q for q in run if s.turn[q] != 0]
            s.done[arcs] = -1
        run = []
    return np.array(still, np.int64)


def _pair_costs(
    s: _State,
    of: Ints,
    ax: Ints,
    ay: Ints,
    bx: Ints,
    by: Ints,
    rules: Rules,
    budget: Budget,
) -> Floats:
    """Return the cost of segment of[k] from (ax, ay)[k] to (bx, by)[k]; inf where impossible."""
    cost = np.full(len(of), np.inf)
    ideal = _ideal(s, of)
    line = s.turn[of] == 0
    if line.any():
        k = np.flatnonzero(line)
        cost[k] = line_cost(ideal.take(k), ax[k], ay[k], bx[k], by[k], budget)
    if not line.all():
        k = np.flatnonzero(~line)
        t = ideal.take(k)
        got = fit_arcs(
            t,
            ax[k],
            ay[k],
            bx[k],
            by[k],
            budget,
            rules.arc_um,
            rules.count_um,
            rules.stepping,
            textbook=rules.textbook,
            square=rules.square_axis,
        )
        arc_cost = np.where(got.ok, got.cost, np.inf)
        # A flat arc may be a line, but better not.
        flat = _flat(s, of[k])
        chord = chord_cost(t, ax[k], ay[k], bx[k], by[k], budget)
        chord = np.where(flat & (chord <= 1.0), chord + 0.5, np.inf)
        # Start and end on one micron: an arc that vanishes, unless it is a whole turn.
        same = (ax[k] == bx[k]) & (ay[k] == by[k]) & (s.v0[of[k]] != s.v1[of[k]])
        arc_cost = np.where(same, np.inf, arc_cost)
        cost[k] = np.minimum(arc_cost, chord)
    cost[cost > 1.5] = np.inf
    cost[line & (cost > 1.0)] = np.inf
    return cost


def _split(s: _State, bad: Ints) -> None:
    """Split failed arcs in two, whole turns in four; what is too short becomes a line."""
    _, sweep = _sweeps(s, bad)
    # A whole turn as a line would be nothing at all.
    short = (s.radius[bad] * sweep < UNSPLIT_UM) & (sweep <= WIDE)
    s.done[bad[short]] = 2
    bad, sweep = bad[~short], sweep[~short]
    if len(bad):
        # Put moved vertices back: the halves start anew.
        for v in (s.v0[bad], s.v1[bad]):
            free = v[~s.pinned[v]]
            s.gx[free], s.gy[free] = to_grid(s.x[free]), to_grid(s.y[free])
        ends = np.isin(s.v0, s.v1[bad]) | np.isin(s.v1, s.v0[bad])
        again = ends & (s.turn != 0)
        s.done[again] = -1
        pieces = np.where(sweep > WIDE, 4, 2)
        _replace(s, bad, pieces, chords=False)


def _blocks(
    s: _State, layout: Layout, plan: Plan, rules: Rules
) -> tuple[Program | None, list[Diagnostic]]:
    """Return the program: blocks of all groups, with the control records between them."""
    findings: list[Diagnostic] = []
    a, b = s.v0, s.v1
    dx, dy = s.gx[b] - s.gx[a], s.gy[b] - s.gy[a]
    arc = (s.turn != 0) & (s.done == 1)
    still = ~arc & (dx == 0) & (dy == 0)
    specks = still & (s.role == Role.CONTOUR) & (a != b)
    if rules.vectors is not None:  # a part of a segment that met the part before it is none
        specks &= np.hypot(s.x[b] - s.x[a], s.y[b] - s.y[a]) < 1.0
    if specks.any():
        findings.append(
            note(
                "specks-dropped",
                "{segments} segments begin and end on one micron: no block of their own",
                segments=int(specks.sum()),
            )
        )
    blocks = np.zeros(len(a), BLOCK)
    blocks["kind"] = np.where(arc, int(Kind.ARC), int(Kind.LINE))
    blocks["turn"] = np.where(arc, s.turn, 0)
    blocks["x"] = np.where(arc, s.ax, dx)
    blocks["y"] = np.where(arc, s.ay, dy)
    axis, count = rules.stepping.line_count(dx, dy)
    arc_axis = np.full(len(a), int(rules.square_axis)) if rules.square else s.axis
    blocks["axis"] = np.where(arc, arc_axis, axis)
    blocks["count"] = np.where(arc, s.square if rules.square else s.count, count)
    blocks["role"], blocks["source"], blocks["cut"] = s.role, s.source, s.cut

    parts: list[NDArray[np.void]] = []
    order = np.flatnonzero(~still)
    groups = s.group[order]
    for index, cut in enumerate(plan.cuts):
        if index:
            before = plan.cuts[index - 1]
            parts.append(_control(Kind.PAUSE))
            here = moves.end_of(before)
            mx, my = cut.thread[0] - here[0], cut.thread[1] - here[1]
            findings += moves.too_long(plan, index, rules)
            if mx or my:
                move = np.zeros(1, BLOCK)
                move["kind"], move["x"], move["y"], move["source"] = Kind.MOVE, mx, my, -1
                moving = rules.moving or rules.stepping
                m_axis, m_count = moving.line_count(np.array([mx]), np.array([my]))
                move["axis"], move["count"] = m_axis, m_count
                parts += [move, _control(Kind.PAUSE)]
        for n, group in enumerate(layout.cut_groups[index]):
            if n:
                parts.append(_control(Kind.PAUSE))
            first, last = np.searchsorted(groups, [group, group + 1])
            body = blocks[order[first:last]]
            parts.append(_split_alone(body, rules))
    parts.append(_control(Kind.STOP))
    start = plan.cuts[0].thread
    if any(d.code == "move-too-long" for d in findings):
        return None, findings
    return (
        Program(np.concatenate(parts), start, tuple(layout.sources), step_um=rules.step_um),
        findings,
    )


def _control(kind: Kind) -> NDArray[np.void]:
    block = np.zeros(1, BLOCK)
    block["kind"], block["source"] = kind, -1
    return block


def _split_alone(body: NDArray[np.void], rules: Rules) -> NDArray[np.void]:
    """Write a single line between two D as two: alone it would be a move (2-3b.md)."""
    if len(body) != 1 or body["kind"][0] != Kind.LINE:
        return body
    x, y = int(body["x"][0]), int(body["y"][0])
    if max(abs(x), abs(y)) < 2:
        return body
    both = np.concatenate([body, body])
    hx, hy = int(to_grid(x / 2)), int(to_grid(y / 2))
    both["x"], both["y"] = [hx, x - hx], [hy, y - hy]
    both["axis"], both["count"] = rules.stepping.line_count(both["x"], both["y"])
    return both
