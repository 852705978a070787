"""Cutting blocks as polar blocks on whose very ends the machine lands.

The machine rounds each vertex of a figure to whole um. So a block only has to end in the square of
a um about its place, not on it, for the machine to step onto just that place. A whole length always
gets into that square: no vertex moves, and there is no closing to be done.

Which places: where the exact path is known its vertices, each rounded once. The ends of lowered
arcs are where stepping happens to end, up to a um off their circle, and between such ends the
machine finds other circles (`controllers.zd065.loop`). Some R and chords are tried, and the one is
taken whose circle, as the machine finds it, strays least from the exact one.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.zd065.figure import eight, rings
from wedmcam.controllers.stepping import Stepping
from wedmcam.controllers.zd065.data import POLAR, displacements
from wedmcam.controllers.zd065.loop import EXACT, single_blocks, to_whole
from wedmcam.controllers.zd065.rotation import rotate_closed
from wedmcam.ir.program import Kind

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Complex = NDArray[np.complex128]

#: A stated vertex stays this near to its place along both axes, um; half a um is the other place.
CELL_UM = 0.45
#: Arcs that cover more are divided, degrees; and others that no chord reaches, near half a turn.
WIDE, BLUNT = 200.0, 100.0
#: A vertex of the exact path this near to that of a program is the same, um; and so is the circle
#: of an arc, at its middle.
SAME_UM = 1.5
#: Arcs of a smaller radius may start next to their centre, and would never end, um: they are lines.
LEAST_RADIUS_UM = 2
#: Blocks that are not longer stay as the program has them, um; and an arc is a line where that
#: lands nearer.
SPECK_UM = 4.0
#: The middle of a stated arc is this near to that of the arc, um, or the arc is divided.
NEAR_UM = 0.6
#: What it weighs that the machine makes several blocks of an arc, um.
SEVERAL_UM = 0.5
#: Where an arc may be divided, um about its middle.
AROUND = np.array([complex(i, j) for i in range(-3, 4) for j in range(-3, 4)])
#: By how much the chord of an arc may differ from that of its places, um: both ends lie in their
#: squares.
CHORDS = np.linspace(-0.8, 0.8, 9)
#: An arc that is stepped farther from its circle has other ends tried, um: 1.6 um is what it may
#: be off towards what is kept. Which end, and which of the places next to its vertex.
FAR_UM = 1.5
_TRIES = ((1, 0), (0, 0), (1, 1), (0, 1), (1, 2), (0, 2))
#: In so many rounds; paths with longer arcs are not looked at step by step, um.
ROUNDS, MOST_STEPPED_UM = 12, 5e6
_SAMPLES = np.linspace(0.0, 1.0, 9)


@dataclass(frozen=True, slots=True, eq=False)
class Landing:
    """Polar blocks of a path.

    Attributes:
        figure: dtype `POLAR`.
        of: of which row of the path each block is.
        off_um: for each row how far its stated end is from its place along an axis, at most.
    """

    figure: NDArray[np.void]
    of: Ints
    off_um: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Exact:
    """Segments of the exact path.

    Attributes:
        starts, ends: um.
        centres, radius: of arcs.
        turn: of arcs, 0 for a line.
    """

    starts: Complex
    ends: Complex
    centres: Complex
    radius: Floats
    turn: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Aim:
    """A path to be stated.

    Attributes:
        path: dtype `WAY`; motions only.
        vertices: as they should be, um; one more than rows.
        places: whole um, where the machine is to land.
        centres: of the circles of arcs.
    """

    path: NDArray[np.void]
    vertices: Complex
    places: Complex
    centres: Complex


def aimed(path: NDArray[np.void], vertices: Complex, centres: Complex, exact: Exact | None) -> Aim:
    """Return a path with vertices and circles of the exact path where they are the same.

    Args:
        path: dtype `WAY`, as a program steps it.
        vertices: whole um, one more than rows.
        centres: of the circles of arcs.
        exact: what was lowered, in the frame of the path; None where that is not known.
    """
    if exact is None:
        return Aim(path, vertices, vertices, centres)
    opens, opened = _nearest(vertices, exact.starts)
    closes, closed = _nearest(vertices, exact.ends)
    true = np.where(opened, exact.starts[opens], np.where(closed, exact.ends[closes], vertices))
    # The machine stands where it is threaded, and specks stay.
    true[0] = vertices[0]
    places = _whole(true)
    way = abs(np.diff(vertices))
    stays = (way <= SPECK_UM) & (way > 0)  # which of the near vertices it is cannot be told
    for ends in (places, true):
        ends[1:][stays], ends[:-1][stays] = vertices[1:][stays], vertices[:-1][stays]
    rows, centres = path.copy(), centres.copy()
    arc = path["kind"] == Kind.ARC
    middle = vertices[:-1] - centres
    middle = centres + middle * np.exp(1j * path["turn"] * np.radians(path["sweep"] / 2))
    for at, known in ((opens[:-1], opened[:-1]), (closes[1:], closed[1:])):
        same = arc & known & (exact.turn[at] == path["turn"])
        same &= abs(abs(middle - exact.centres[at]) - exact.radius[at]) <= SAME_UM
        centres = np.where(same, exact.centres[at], centres)
        rows["radius"] = np.where(same, exact.radius[at], rows["radius"])
    ring = rings(path)
    out = places[:-1] - centres
    rows["start"] = np.where(ring, np.degrees(np.angle(out)) % 360.0, rows["start"])
    return Aim(rows, true, places, centres)


def _whole(xy: Complex) -> Complex:
    near = to_whole(np.stack([xy.real, xy.imag], axis=-1))
    return np.asarray(near[..., 0] + 1j * near[..., 1])


def _nearest(vertices: Complex, of: Complex) -> tuple[Ints, NDArray[np.bool_]]:
    """Return for each vertex which of others is nearest, and whether it is the same."""
    order = np.argsort(of.real, kind="stable")
    x = of.real[order]
    first = np.searchsorted(x, vertices.real - SAME_UM)
    last = np.searchsorted(x, vertices.real + SAME_UM, "right")
    best = np.full(len(vertices), -1, dtype=np.int64)
    least = np.full(len(vertices), SAME_UM)
    rows = np.arange(len(vertices))
    step = 0
    while len(rows := rows[first[rows] + step < last[rows]]):
        other = order[first[rows] + step]
        far = abs(of[other] - vertices[rows])
        nearer = far <= least[rows]
        best[rows[nearer]], least[rows[nearer]] = other[nearer], far[nearer]
        step += 1
    return np.maximum(best, 0), best >= 0


def land(aim: Aim, stepping: Stepping) -> tuple[Landing, Aim]:
    """Return polar blocks that bring the machine along a path, and where they land.

    An arc as stepped may be farther from its circle than what is left of the 2 um of a program
    allows, although both ends are right: then one of them goes to another um beside its vertex.
    """
    landing = _stated(aim, stepping)
    arcs = np.flatnonzero(aim.path["kind"] == Kind.ARC)
    length = (aim.path["radius"] * np.radians(aim.path["sweep"]))[arcs].sum()
    if length > MOST_STEPPED_UM:
        return landing, aim
    far = _strays(landing, aim, stepping, arcs)
    tried: dict[int, int] = {}
    for _ in range(ROUNDS):
        changes = _changes(aim, far, tried)
        if not changes:
            break
        other = aim.places.copy()
        for old, new in changes:
            other[aim.places == old] = new
        moved = replace(aim, places=other)
        made = _stated(moved, stepping)
        touched = np.isin(aim.places, [old for old, _ in changes])
        rows = arcs[(touched[:-1] | touched[1:])[arcs]]
        then = far.copy()
        then[rows] = _strays(made, moved, stepping, rows)[rows]
        better = aim.places.copy()
        for old, new in changes:
            at = aim.places == old
            own = np.zeros(len(far), np.bool_)
            own |= at[:-1]
            own |= at[1:]
            if then[own].max() < far[own].max() - 0.01:
                better[at] = new
                far[own] = then[own]
        aim = replace(aim, places=better)
    return _stated(aim, stepping), aim


def _changes(aim: Aim, far: Floats, tried: dict[int, int]) -> list[tuple[complex, complex]]:
    """Return places to be tried anew, and where: of arcs that stray, not of neighbours at once."""
    out: list[tuple[complex, complex]] = []
    taken: set[complex] = set()
    for k in np.flatnonzero(far > FAR_UM)[np.argsort(-far[far > FAR_UM])].tolist():
        both = {complex(aim.places[k]), complex(aim.places[k + 1])}
        n = tried.get(k, 0)
        if n == len(_TRIES) or both & taken:
            continue
        tried[k] = n + 1
        end, rank = _TRIES[n]
        i = k + end
        old = complex(aim.places[i])
        if old == aim.places[0]:
            continue
        near = _whole(np.round(aim.vertices[i]) + AROUND)
        near = near[np.argsort(abs(near - aim.vertices[i]), kind="stable")]
        new = complex(near[near != old][rank])
        if new in both or abs(new - aim.vertices[i]) > 1.2:
            continue
        out.append((old, new))
        rows = np.flatnonzero(aim.places == old)
        for j in rows.tolist():
            taken |= {complex(p) for p in aim.places[max(j - 1, 0) : j + 2]}
    return out


def _strays(landing: Landing, aim: Aim, stepping: Stepping, rows: Ints) -> Floats:
    """Return for each of some arcs how far the machine steps beside its circle, um; else 0."""
    far = np.zeros(len(aim.path))
    made = rotate_closed(landing.figure)
    row = landing.of[made.blocks["source"]]
    some = np.flatnonzero(np.isin(row, rows))
    if not len(some):
        return far
    begins = np.concatenate([[0j], made.ends[:, 0] + 1j * made.ends[:, 1]])[some]
    xy, first = stepping.trace(made.blocks[some])
    steps = np.diff(np.append(first, len(xy) - 1))[: len(some)]
    first = first[: len(some)]
    at = xy[1:, 0] + 1j * xy[1:, 1]
    zero = (xy[first, 0] + 1j * xy[first, 1]) - begins
    k = row[some]
    moving = steps > 0
    at = at - np.repeat(zero, steps)
    off = abs(abs(at - np.repeat(aim.centres[k], steps)) - np.repeat(aim.path["radius"][k], steps))
    most = np.maximum.reduceat(off, first[moving])
    np.maximum.at(far, k[moving], most)
    return far


def _stated(aim: Aim, stepping: Stepping) -> Landing:
    """Return polar blocks that bring the machine to the places of a path."""
    arcs = _Arcs.of_path(aim.path, aim.places, aim.centres)
    done: list[_Arcs] = []
    while True:
        arcs.choose(stepping)
        wide = arcs.sweep > np.where(arcs.reached, WIDE, BLUNT)
        done.append(arcs.take(~wide))
        if not wide.any():
            return _chain(aim, done, stepping)
        arcs = arcs.take(wide).halves()


@dataclass(slots=True, eq=False)
class _Arcs:
    """Arcs to be stated, and for each what the machine makes of some R and sweeps."""

    row: Ints
    at: Floats
    share: Floats
    turn: Ints
    begin: Complex
    end: Complex
    centre: Complex
    radius: Floats
    sweep: Floats
    sizes: Ints = field(init=False)
    sweeps: Floats = field(init=False)
    off: Floats = field(init=False)
    stray: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.sizes = np.zeros((len(self.row), 0), dtype=np.int64)
        self.sweeps, self.off, self.stray = np.zeros((3, len(self.row), 0))

    @classmethod
    def of_path(cls, path: NDArray[np.void], vertices: Complex, centres: Complex) -> _Arcs:
        k = np.flatnonzero((path["kind"] == Kind.ARC) & ~rings(path))
        return cls(k, np.zeros(len(k)), np.ones(len(k)), path["turn"][k].astype(np.int64),
                   vertices[k], vertices[k + 1], centres[k], path["radius"][k],
                   path["sweep"][k])  # fmt: skip

    @property
    def reached(self) -> NDArray[np.bool_]:
        """Whether some chord lands wherever in its square the arc begins."""
        chord = 2.0 * self.sizes * np.sin(np.radians(self.sweeps) / 2)
        away = chord - abs(self.end - self.begin)[:, None]
        near = self.off <= NEAR_UM
        return np.asarray((near & (away <= -0.1)).any(axis=1) & (near & (away >= 0.1)).any(axis=1))

    def take(self, which: NDArray[np.bool_]) -> _Arcs:
        out = _Arcs(self.row[which], self.at[which], self.share[which], self.turn[which],
                    self.begin[which], self.end[which], self.centre[which], self.radius[which],
                    self.sweep[which])  # fmt: skip
        out.sizes, out.sweeps = self.sizes[which], self.sweeps[which]
        out.off, out.stray = self.off[which], self.stray[which]
        return out

    def halves(self) -> _Arcs:
        """Return two arcs of each, which meet near its middle on a um that lies on the circle."""
        out = self.begin - self.centre
        middle = out * np.exp(1j * self.turn * np.radians(self.sweep / 2))
        middle *= self.radius / np.maximum(abs(middle), 1e-9)
        near = (self.centre + middle)[:, None] + AROUND
        xy = to_whole(np.stack([near.real, near.imag], axis=-1))
        near = xy[..., 0] + 1j * xy[..., 1]
        off = abs(abs(near - self.centre[:, None]) - self.radius[:, None])
        middle = near[np.arange(len(near)), np.argmin(off, axis=1)]
        two = 2 * np.ones(len(self.row), dtype=np.int64)
        half = self.share / 2
        return _Arcs(
            np.repeat(self.row, two),
            np.column_stack([self.at, self.at + half]).ravel(),
            np.repeat(half, two),
            np.repeat(self.turn, two),
            np.column_stack([self.begin, middle]).ravel(),
            np.column_stack([middle, self.end]).ravel(),
            np.repeat(self.centre, two),
            np.repeat(self.radius, two),
            np.repeat(self.sweep / 2, two),
        )

    def choose(self, stepping: Stepping) -> None:
        """Try R and sweeps: `sizes`, `sweeps`, and `stray`, infinite for what is no way."""
        n = len(self.row)
        low = np.maximum(np.floor(self.radius), 1.0)
        size = np.column_stack([low, low + 1.0])
        chord = np.maximum(abs(self.end - self.begin)[:, None] + CHORDS, 0.3)
        size = np.repeat(size, len(CHORDS), axis=1)
        chord = np.tile(chord, (1, 2))
        share = chord / (2 * size)
        short = np.degrees(2 * np.arcsin(np.minimum(share, 1.0)))
        sweeps = np.where(self.sweep[:, None] > 180.0, 360.0 - short, short)
        # How far its middle is from the arc, if both ends are where they should be.
        way = self.end - self.begin
        way = way / np.maximum(abs(way), 1e-9)
        middle = self.turn * np.radians(self.sweep / 2)
        middle = (self.begin - self.centre) * np.exp(1j * middle)
        middle *= self.radius / np.maximum(abs(middle), 1e-9)
        high = -self.turn * ((self.centre + middle - self.begin) * way.conj()).imag
        sag = size * (1 - np.cos(np.radians(sweeps) / 2))
        self.off = np.where(share <= 1.0, abs(sag - high[:, None]), np.inf)
        many = size.shape[1]
        rows = np.zeros(n * many, EXACT)
        rows["kind"], rows["turn"] = Kind.ARC, np.repeat(self.turn, many)
        rows["x"], rows["y"] = np.repeat(self.end.real, many), np.repeat(self.end.imag, many)
        rows["radius"], rows["sweep"] = size.ravel(), eight(sweeps.ravel())
        starts = np.column_stack([self.begin.real, self.begin.imag]).repeat(many, axis=0)
        blocks, lands = single_blocks(rows, starts, stepping)
        stray = self._stray(blocks.reshape(n, many))
        self.sizes = size.astype(np.int64)
        self.sweeps = rows["sweep"].reshape(n, many)
        self.stray = np.where(lands.reshape(n, many), stray, self.off + SEVERAL_UM)

    def _stray(self, blocks: NDArray[np.void]) -> Floats:
        """Return how far what the machine would cut lies from the arcs, um."""
        out = self.begin - self.centre
        ways = self.turn[:, None] * np.radians(self.sweep)[:, None] * _SAMPLES
        points = (self.centre[:, None] + out[:, None] * np.exp(1j * ways))[:, None, :]
        towards = blocks["x"] + 1j * blocks["y"]
        line = blocks["kind"] == Kind.LINE
        centre = self.begin[:, None] - towards
        off = abs(abs(points - centre[..., None]) - abs(towards)[..., None]).max(axis=2)
        u = towards / np.maximum(abs(towards), 1e-9)
        beside = abs(((points - self.begin[:, None, None]) * u.conj()[..., None]).imag).max(axis=2)
        return np.asarray(np.where(line, beside, off))


def _chain(aim: Aim, arcs: list[_Arcs], stepping: Stepping) -> Landing:
    """Return the blocks one after the other, each from where the one before is stated to end."""
    path, vertices = aim.path, aim.places
    row = np.concatenate([a.row for a in arcs])
    order = np.lexsort((np.concatenate([a.at for a in arcs]), row))
    row = row[order]
    ends = np.concatenate([a.end for a in arcs])[order]
    columns = [[a.sizes, a.sweeps, a.stray] for a in arcs]
    sizes, sweeps, stray = (np.concatenate(c)[order] for c in zip(*columns, strict=True))
    first = np.searchsorted(row, np.arange(len(path) + 1))
    ring = rings(path)
    figure = np.zeros(len(path) + len(row), dtype=POLAR)
    of, off_um = np.zeros(len(figure), dtype=np.int64), np.zeros(len(path))
    at, n = complex(vertices[0]), 0
    for k, kind in enumerate(path["kind"].tolist()):
        turn = int(path["turn"][k])
        if ring[k]:
            here = complex(vertices[k])
            centre, radius = complex(aim.centres[k]), float(path["radius"][k])
            figure[n] = _full(turn, here, at, centre, radius, stepping)
            of[n], n = k, n + 1
            continue
        if kind != Kind.ARC:
            goal = complex(vertices[k + 1])
            figure[n] = _line(kind, goal - at)
            at += complex(displacements(figure[n : n + 1])[0])
            of[n], n = k, n + 1
        for i in range(first[k], first[k + 1]):
            figure[n] = _arc(turn, complex(ends[i]) - at, sizes[i], sweeps[i], stray[i])
            at += complex(displacements(figure[n : n + 1])[0])
            of[n], n = k, n + 1
        rest = at - complex(vertices[k + 1])
        off_um[k] = max(abs(rest.real), abs(rest.imag))
    return Landing(figure[:n], of[:n], off_um)


def _line(kind: int, way: complex) -> tuple[int, int, float, int, float]:
    """Return a line of the nearest whole length along a way."""
    return kind, 0, _heading(way), max(round(abs(way)), 1), 0.0


def _full(
    turn: int, here: complex, at: complex, centre: complex, radius: float, stepping: Stepping
) -> tuple[int, int, float, int, float]:
    """Return the full circle from a place for which the machine takes the best whole centre.

    Its centre is where it is stated and not through two ends, from where the block is stated to
    begin (``at``), which is not quite the place.
    """
    near = _whole(centre + AROUND)
    off = abs(near - centre) + abs(abs(near - here) - radius)
    goal = complex(near[np.argmin(off)])
    out = at - goal
    angle = np.degrees(np.angle(out)) + np.degrees(np.array([0.0, 0.3, -0.3]) / max(abs(out), 1.0))
    rows = np.zeros(6, EXACT)
    rows["kind"], rows["turn"], rows["sweep"] = Kind.ARC, turn, 360.0
    rows["start"] = np.repeat([_eight(a % 360.0) for a in angle.tolist()], 2)
    rows["radius"] = np.tile(np.maximum([np.floor(abs(out)), np.ceil(abs(out))], 1.0), 3)
    rows["x"], rows["y"] = at.real, at.imag
    blocks, lands = single_blocks(rows, np.tile([at.real, at.imag], (6, 1)), stepping)
    made = here - (blocks["x"] + 1j * blocks["y"])
    off = abs(made - centre) + abs(abs(made - here) - radius) + np.where(lands, 0.0, 2.0)
    i = int(np.argmin(off))
    return int(Kind.ARC), turn, float(rows["start"][i]), int(rows["radius"][i]), 360.0


def _arc(
    turn: int, way: complex, sizes: Ints, sweeps: Floats, stray: Floats
) -> tuple[int, int, float, int, float]:
    """Return the arc that ends near enough to where it should, and of those strays least."""
    length = abs(way)
    chords = 2 * sizes * np.sin(np.radians(sweeps) / 2)
    off = abs(chords - length)
    # Landing comes first; how far it is off in its square counts little.
    cost = np.minimum(stray, 1e3) + 0.05 * off + np.where(sizes < LEAST_RADIUS_UM, 1e6, 0.0)
    i = int(np.argmin(cost + np.where(off <= CELL_UM, 0.0, 10 + off)))
    speck = length <= SPECK_UM and off[i] > abs(round(length) - length)
    if sizes[i] < LEAST_RADIUS_UM or speck:
        return _line(Kind.LINE, way)
    sweep = float(sweeps[i])
    lean = turn * (sweep / 2 + 90.0)
    heading = float(np.degrees(np.angle(way)))
    return int(Kind.ARC), turn, _eight((heading - lean) % 360.0), int(sizes[i]), sweep


def _heading(way: complex) -> float:
    return _eight(float(np.degrees(np.angle(way))) % 360.0)


def _eight(degrees: float) -> float:
    value = float(eight(np.array([degrees]))[0])
    return 0.0 if value >= 360.0 else value
