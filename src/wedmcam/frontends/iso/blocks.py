"""The motions of an ISO text, and the blocks that a controller steps them in.

Places are exact, in nm; blocks are on the grid, in whole um. Motions in compensation (`modes.Runs`)
stay exact: a block only keeps their place among the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity
from wedmcam.formats import iso
from wedmcam.frontends.iso.arcs import Arcs, Radii, centres_of, grid, nearest, stepped_arcs
from wedmcam.frontends.iso.centres import Centres, ask, centres_by_rule, tell_far
from wedmcam.frontends.iso.lines import Lines
from wedmcam.frontends.iso.modes import Runs
from wedmcam.frontends.iso.reading import ArcTeller, Reading
from wedmcam.ir.program import BLOCK, Kind
from wedmcam.ir.programmed import PROGRAMMED

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Where every line starts and ends, nm, and where it starts in coordinates that G92 sets."""

    starts: dict[str, Ints]
    ends: dict[str, Ints]
    befores: dict[str, Ints]


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """The motions of a text as they are programmed.

    Attributes:
        rows: the lines with a motion, in order.
        lines: what every line says.
        nm: of every line X, Y, I, J and R.
        absolute: of every line whether G90 is in force.
        places: where every line starts and ends.
    """

    rows: Ints
    lines: Lines
    nm: dict[str, Ints]
    absolute: Bools
    places: Places

    @property
    def arcs(self) -> Ints:
        """The lines with an arc."""
        return self.rows[self.lines.motion[self.rows] >= 2]

    @property
    def still(self) -> Bools:
        """Which of ``rows`` are straight motions of length 0 on the grid."""
        still = self.lines.motion[self.rows] < 2
        for k in "XY":
            start, end = self.places.starts[k][self.rows], self.places.ends[k][self.rows]
            still &= grid(start) == grid(end)
        return still


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """The blocks of motions.

    Attributes:
        rows: dtype `BLOCK`; ``source`` is the row of ``motions`` that a block stands for, else -1.
        line: of each block.
        motions: those in compensation, dtype `PROGRAMMED`.
    """

    rows: NDArray[np.void]
    line: Ints
    motions: NDArray[np.void]


def places_of(nm: dict[str, Ints], lines: Lines, distance: Ints, moves: Bools) -> Places:
    """Return where every line starts and ends: ``moves`` go there, G90 or G91 by ``distance``."""
    has, reset, many = lines.has, lines.reset, len(moves)
    ends, starts, befores = {}, {}, {}
    for k in "XY":
        absolute = (distance == 90) & has[k] & moves
        sets = absolute | (reset & has[k])
        step = np.where(moves & has[k] & (distance == 91), nm[k], 0)
        summed = np.cumsum(step)
        last = np.maximum.accumulate(np.where(sets, np.arange(many), -1))
        at = np.maximum(last, 0)
        work = np.where(last >= 0, nm[k][at] + summed - summed[at], summed)
        before = np.concatenate([[0], work[:-1]])
        place = np.cumsum(np.where(reset, 0, work - before))
        ends[k], starts[k] = place, np.concatenate([[0], place[:-1]])
        befores[k] = before
    return Places(starts, ends, befores)


def blocks_of(r: Reading, path: Path, runs: Runs | None) -> Blocks:
    """Return the blocks of the motions, and report arcs that are none."""
    arcs = _arcs(path)
    exact, x, y = _centres(r, path, arcs)
    radii = Radii(arcs.sx - x, arcs.sy - y, arcs.ex - x, arcs.ey - y)
    motions = np.zeros(0, PROGRAMMED)
    stepped = ~r.bad[arcs.lines]
    if runs is not None:
        motions = _programmed(runs, path.places, arcs, exact)
        stepped &= runs.of[arcs.lines] < 0
    arcs = arcs.of(stepped)
    curves, rest_x, rest_y = stepped_arcs(r, arcs, radii.of(stepped))
    rest = np.zeros(len(curves), BLOCK)
    rest["kind"], rest["x"], rest["y"] = Kind.LINE, rest_x, rest_y
    straight, lines = _straight(r, path, runs)
    for part in (straight, rest):
        part["axis"], part["count"] = r.machine.own_stepping.line_count(part["x"], part["y"])
    for part in (straight, curves, rest):
        part["source"] = -1
    places, compensated = _places_of_runs(r, path, runs)
    every = np.concatenate([straight, curves, rest, places])
    # The straight rest of an arc stands behind it.
    key = np.concatenate([2 * lines, 2 * arcs.lines, 2 * arcs.lines + 1, 2 * compensated])
    still = every["count"] == 0
    nothing = np.flatnonzero(still[: len(lines)])
    r.tell_lines(Severity.NOTE, "iso-ignored", lines[nothing], "a motion of length 0: no block")
    order = np.argsort(key, kind="stable")
    order = order[~still[order]]
    return Blocks(every[order], key[order] // 2, motions)


def _arcs(path: Path) -> Arcs:
    """Return the arcs as they are programmed."""
    lines, has = path.arcs, path.lines.has
    (sx, sy), (ex, ey) = (
        (place["X"][lines], place["Y"][lines]) for place in (path.places.starts, path.places.ends)
    )
    return Arcs(
        lines=lines,
        turn=np.where(path.lines.motion[lines] == 3, 1, -1),
        sx=grid(sx),
        sy=grid(sy),
        ex=grid(ex),
        ey=grid(ey),
        closed=(sx == ex) & (sy == ey),
        by_radius=has["R"][lines],
        by_centre=(has["I"] | has["J"])[lines],
    )


def _centres(r: Reading, path: Path, arcs: Arcs) -> tuple[list[Floats], Ints, Ints]:
    """Return the centres of arcs, exact in um and X and Y on the grid, and report wrong ones."""
    has, places = path.lines.has, path.places
    centres = centres_by_rule(
        arcs.lines,
        path.lines.rules,
        path.nm,
        path.absolute,
        places.befores,
        places.starts,
        places.ends,
    )
    teller = ArcTeller(r, arcs.lines)
    both, neither = arcs.by_radius & arcs.by_centre, ~arcs.by_radius & ~arcs.by_centre
    teller.tell(both, "both a centre (I, J) and a radius R")
    teller.tell(neither, "an arc without a centre (I, J) or a radius R")
    alone = (has["I"] ^ has["J"])[arcs.lines] & centres.by_place & (centres.shift > 0) & ~both
    teller.tell(alone, "I or J alone: the place of a centre is both")
    teller.tell(
        arcs.by_radius & arcs.closed,
        "R with an end that is the start: the centre may be anywhere",
    )
    of_radius = arcs.by_radius & ~arcs.closed
    from_radius = centres_of(teller, of_radius, arcs, path.nm["R"][arcs.lines])
    x, y = (
        np.where(of_radius, nearest(c), grid(nm))
        for c, nm in zip(from_radius, centres.exact_nm, strict=True)
    )
    exact = [
        np.where(of_radius, c, nm / 1000.0)
        for c, nm in zip(from_radius, centres.exact_nm, strict=True)
    ]
    _tell_radii(teller, arcs, Radii(arcs.sx - x, arcs.sy - y, arcs.ex - x, arcs.ey - y), centres)
    return exact, x, y


def _tell_radii(teller: ArcTeller, arcs: Arcs, radii: Radii, centres: Centres) -> None:
    """Report arcs that are too small, and those whose end is not on their circle."""
    x, y = radii.x, radii.y
    radius, reach = np.hypot(x, y), np.hypot(radii.fx, radii.fy)
    one_way = arcs.by_radius ^ arcs.by_centre
    # As in 3B: no step leads round.
    teller.tell(one_way & (radius == 0), "the centre is the start: the arc has no radius")
    teller.tell(
        one_way & (x * x + y * y == 1),
        "the arc starts 0.001 mm from its centre and never ends",
    )
    off = np.abs(reach - radius)
    stated = ~arcs.by_radius & arcs.by_centre
    ask(teller.reading, arcs.lines, stated, centres)
    tell_far(
        teller,
        off > iso.END_UM,
        stated,
        lambda i: {
            "off_um": float(off[i]),
            "start_mm": float(radius[i] / 1000),
            "end_mm": float(reach[i] / 1000),
        },
        centres,
    )


def _straight(r: Reading, path: Path, runs: Runs | None) -> tuple[NDArray[np.void], Ints]:
    """Return the blocks of straight motions, without their counts, and the line of each."""
    rows, motion = path.rows, path.lines.motion
    straight = (motion[rows] < 2) & ~r.bad[rows]
    if runs is not None:
        straight &= runs.of[rows] < 0
    lines = rows[straight]
    blocks = np.zeros(len(lines), BLOCK)
    blocks["kind"] = np.where(motion[lines] == 0, int(Kind.MOVE), int(Kind.LINE))
    for k, name in (("X", "x"), ("Y", "y")):
        blocks[name] = grid(path.places.ends[k][lines]) - grid(path.places.starts[k][lines])
    return blocks, lines


def _places_of_runs(r: Reading, path: Path, runs: Runs | None) -> tuple[NDArray[np.void], Ints]:
    """Return blocks that keep the place of motions in compensation, and the line of each.

    What a controller makes of those motions is not known here.
    """
    lines = path.rows[:0] if runs is None else runs.line[~r.bad[runs.line]]
    blocks = np.zeros(len(lines), BLOCK)
    blocks["kind"] = np.where(path.lines.motion[lines] == 0, int(Kind.MOVE), int(Kind.LINE))
    blocks["x"], blocks["count"] = 1, 1
    if runs is not None:
        blocks["source"] = runs.of[lines]
    return blocks, lines


def _programmed(runs: Runs, places: Places, arcs: Arcs, centre: list[Floats]) -> NDArray[np.void]:
    """Return the motions of runs as they are programmed."""
    out = np.zeros(len(runs.line), PROGRAMMED)
    for name in ("role", "shift", "d", "run"):
        out[name] = getattr(runs, name)
    for k, name in (("X", "x"), ("Y", "y")):
        out[f"{name}0"] = places.starts[k][runs.line] / 1000.0
        out[f"{name}1"] = places.ends[k][runs.line] / 1000.0
    mine = runs.of[arcs.lines]
    some = mine >= 0
    out["turn"][mine[some]] = arcs.turn[some]
    out["cx"][mine[some]], out["cy"][mine[some]] = centre[0][some], centre[1][some]
    return out
