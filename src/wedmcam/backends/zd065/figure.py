"""A path as polar blocks: whole lengths and radii, headings of 8 digits, and it closes.

The rotation format holds a chain of displacements. A line's length is whole um, so a vertex cannot
lie just anywhere: it lies on a circle about the one before. Where a figure is turned, an error e of
its own grows to e / sin(pi / N) over the copies. So vertices are first moved together, by as little
as possible, until all lines have whole lengths between the two ends of the path; then the headings
are rounded one after the other, each from where the blocks before it lead; and what is left is
taken away by last digits.

Moved together: least squares of all vertices under the lengths as conditions. The conditions link
neighbours only, so the equations of their multipliers are tridiagonal. The chord of an arc follows
its sweep: it is free where the middle of the arc does not mind (the weight tan(s / 2)^2 / 4 of
chord and middle), fixed at half a turn, where R rules the chord. Wide arcs are two blocks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.zd065.data import POLAR, displacements
from wedmcam.formats import rotation
from wedmcam.ir.program import Kind

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Complex = NDArray[np.complex128]

#: Arcs that cover more are stated as two, degrees; a full circle stays one.
WIDE = 200.0
#: And of those whose R is not whole within this, um, arcs that cover more than this: the nearer to
#: half a turn, the less the chord can make up for the radius.
WHOLE_UM, BLUNT = 0.3, 100.0
#: Longer lines are stated as several, um: the field has 6 digits.
LONGEST_UM = 999_999
#: Blocks shorter than this have no whole length, and are left out, um.
SPECK_UM = 0.7
#: A vertex that would have to move farther is one that the lengths do not allow, um.
MOVED_UM = 1.0
#: Weights of arcs: from here on the chord is fixed.
FIXED = 1e12
#: So many unknowns are solved for, all in all, to find better lengths; nearer is near enough, um.
SOLVED, NEAR_ENOUGH_UM = 2000, 0.1
#: Newton's method takes 3 to 5 rounds.
ROUNDS = 12
#: How many blocks have their last digits tried, and by how many units.
TRIED, UNITS = 90, (-3, -2, -1, 1, 2, 3)


@dataclass(frozen=True, slots=True, eq=False)
class Stated:
    """A path as polar blocks.

    Attributes:
        figure: dtype `POLAR`.
        of: of which row of the path each block is.
        ends: where each block ends as stated, um from the start of the path.
        closes: whether the end of the path could be reached.
        drift_um: how far the stated end is from the end of the path.
        off_um: how far vertices and middles of arcs are from those of the path, at most.
        begin: where the first block begins, from the start of the path.
    """

    figure: NDArray[np.void]
    of: Ints
    ends: Complex
    closes: bool
    drift_um: float
    off_um: float
    begin: complex = 0j

    def off_from(self, path: NDArray[np.void]) -> float:
        """Return how far vertices and middles of arcs are from those of a path of as many rows."""
        path, _ = divided(path, np.bincount(self.of, minlength=len(path)))
        off = abs(self.ends - (path["x"] + 1j * path["y"])).max(initial=0.0)
        return float(max(off, _middles_off(self.figure, path, self.ends, self.begin)))


def state(path: NDArray[np.void], *, closes: bool = True, begin: complex = 0j) -> Stated:
    """Return a path as polar blocks.

    Args:
        path: dtype `WAY`; motions only.
        closes: the end is to be reached as well as the digits allow; where it cannot, `Stated`
            says so. False: the last vertex is as free as any other.
        begin: where the machine really stands instead of at the start of the path, um.
    """
    path, of = divided(path)
    ends = path["x"] + 1j * path["y"]
    points = np.concatenate([[begin], ends])
    ring = rings(path)
    chain = np.flatnonzero(~ring)
    size = np.floor(path["radius"] + 0.5)
    moved = points.copy()
    done = True
    if len(chain):
        t = np.concatenate([points[:1], ends[chain]])
        v, lengths, done = settle(path[chain], t, size[chain], closes)
        at = np.searchsorted(chain, np.arange(len(path)), "right")
        moved = np.concatenate([v[:1], v[at]])
        size[chain] = np.where(path["kind"][chain] == Kind.ARC, size[chain], lengths)
    figure = np.zeros(len(path), dtype=POLAR)
    figure["kind"], figure["turn"], figure["size"] = path["kind"], path["turn"], size
    _find_angles(figure, path, moved)
    if closes and done:
        _close(figure, complex(ends[-1] - begin) if len(ends) else 0j)
    made = np.asarray(begin + np.cumsum(displacements(figure)))
    drift = float(abs(made[-1] - ends[-1])) if len(ends) else 0.0
    off = float(max(abs(made - ends).max(initial=0.0), _middles_off(figure, path, made, begin)))
    return Stated(figure, of, made, done, drift, off, begin)


def nearness(path: NDArray[np.void]) -> float:
    """Return how near the vertices of a path that closes can be stated, um; inf for not at all."""
    path, _ = divided(path)
    chain = path[~rings(path)]
    if not len(chain):
        return 0.0
    points = np.concatenate([[0j], chain["x"] + 1j * chain["y"]])
    v, _, good = settle(chain, points, np.floor(chain["radius"] + 0.5), True)
    return float(abs(v - points).max()) if good else float(np.inf)


def divided(path: NDArray[np.void], pieces: Ints | None = None) -> tuple[NDArray[np.void], Ints]:
    """Return a path without specks, with wide arcs and long lines in pieces, and of which rows.

    ``pieces``: how many of each row; None for as many as it needs.

    >>> from wedmcam.controllers.zd065.data import WAY
    >>> row = np.zeros(1, WAY)
    >>> row[0] = (Kind.ARC, 1, 0.0, -707.1, 500.0, 270.0, 0.0)
    >>> [[round(v) for v in divided(row)[0][k].tolist()] for k in ("x", "y", "sweep")]
    [[-854, 0], [-354, -707], [135, 135]]
    """
    starts = np.concatenate([[0j], (path["x"] + 1j * path["y"])[:-1]])
    ends = path["x"] + 1j * path["y"]
    arc = path["kind"] == Kind.ARC
    ring = rings(path)
    rounded = abs(path["radius"] - np.floor(path["radius"] + 0.5)) > WHOLE_UM
    wide = arc & ~ring & (path["sweep"] > np.where(rounded, BLUNT, WIDE))
    long = np.where(arc, 0.0, abs(ends - starts))
    if pieces is None:
        pieces = np.where(wide, 2, np.maximum(np.ceil(long / (LONGEST_UM - 1)), 1))
        pieces = np.asarray(pieces, dtype=np.int64)
        # A speck ends where the block before it is made to end.
        pieces[~ring & (abs(ends - starts) < SPECK_UM) & ~wide] = 0
    wide, speck = arc & (pieces == 2), pieces == 0
    of = np.repeat(np.arange(len(path)), pieces)
    out = path[of]
    part = np.arange(len(of)) - np.repeat(np.cumsum(pieces) - pieces, pieces) + 1
    inner = np.flatnonzero(part < pieces[of])
    if len(inner):
        k = of[inner]
        share = part[inner] / pieces[k]
        line = starts[k] + (ends[k] - starts[k]) * share
        radius, turn, s = path["radius"][k], path["turn"][k], np.radians(path["sweep"][k])
        chord = ends[k] - starts[k]
        # From the start to the middle of the arc: chord of half the sweep, turned by a quarter.
        half = 2 * radius * np.sin(s / 4) * chord / np.maximum(abs(chord), 1e-9)
        half = half * np.where(s > 2 * np.pi, -1, 1) * np.exp(-1j * turn * s / 4)
        place = np.where(wide[k], starts[k] + half, line)
        out["x"][inner], out["y"][inner] = place.real, place.imag
    out["sweep"] = np.where(wide[of], out["sweep"] / 2, out["sweep"])
    if speck.any() and len(out):
        _end_where(out, complex(ends[-1]), bool(speck[-1]))
    return out, of


def _end_where(out: NDArray[np.void], end: complex, last: bool) -> None:
    """Let a path end where it did, although its last block was a speck."""
    if last:
        out["x"][-1], out["y"][-1] = end.real, end.imag


def rings(rows: NDArray[np.void]) -> NDArray[np.bool_]:
    """Return which rows of a path or of a figure are full circles."""
    return np.asarray((rows["kind"] == Kind.ARC) & (abs(rows["sweep"] - 360.0) < 1e-9))


def settle(
    path: NDArray[np.void], points: Complex, radius: Floats, closes: bool
) -> tuple[Complex, Floats, bool]:
    """Return vertices between which lines have whole lengths, the lengths, and whether all is well.

    Args:
        path: rows with a chord each; dtype `WAY`.
        points: n + 1 vertices as they should be.
        radius: R as it is stated.
        closes: the last vertex stays where it is. Where that cannot be, it does not.
    """
    arc = path["kind"] == Kind.ARC
    half = np.radians(path["sweep"]) / 2
    weight = np.where(arc, (np.tan(half) / 2) ** 2, FIXED)
    # The chord at which the middle of the arc is as near as R allows.
    stray = (radius - path["radius"]) * (1 - np.cos(half))
    with np.errstate(divide="ignore", invalid="ignore"):
        lean = np.where(abs(np.tan(half)) > 1e-6, 2 * stray / np.tan(half), 0.0)
    chord = np.where(arc, 2 * radius * np.sin(half) - np.where(abs(lean) < 2, lean, 0.0), 0.0)
    lengths = _whole_lengths(points, chord, weight, arc)
    goal = np.where(arc, chord, lengths)
    ease = 1 / np.clip(weight, 1e-9, FIXED)
    ease[~arc] = 0.0
    if closes:
        v, goal, good = _best_lengths(points, goal, ease)
        if good:
            return v, np.where(arc, lengths, goal), True
    goal = np.where(arc, chord, lengths)
    v, good = _solve(points, goal, ease, pinned=False)
    if not good:
        v = _follow(points, lengths, chord, weight, arc)
    return v, lengths, good and not closes


def _whole_lengths(
    points: Complex, chord: Floats, weight: Floats, arc: NDArray[np.bool_]
) -> Floats:
    """Return whole lengths of the lines, each from where those before it lead."""
    lengths = np.zeros(len(chord))
    at = complex(points[0])
    goals = points[1:].tolist()
    for i, (goal, fixed, w, is_arc) in enumerate(
        zip(goals, chord.tolist(), weight.tolist(), arc.tolist(), strict=True)
    ):
        way = goal - at
        far = abs(way)
        if is_arc:
            length = far + (fixed - far) * w / (1 + w)
        else:
            length = lengths[i] = max(np.floor(far + 0.5), 1.0)
        at += way / far * length if far else length
    return lengths


def _best_lengths(points: Complex, goal: Floats, ease: Floats) -> tuple[Complex, Floats, bool]:
    """Return vertices of a path that closes, its distances, and whether there are such.

    Lengths rounded one by one are not the best ones together: of a short path each is tried a um
    longer and shorter, as long as the vertices come nearer to where they should be.
    """
    v, good = _solve(points, goal, ease, pinned=True)
    least = float(abs(v - points).max()) if good else np.inf
    lines = np.flatnonzero(ease == 0).tolist()
    tries = SOLVED // max(len(goal), 1)
    better = True
    while better and tries > 0 and least > NEAR_ENOUGH_UM:
        better = False
        for i, by in ((i, by) for i in lines for by in (1.0, -1.0)):
            tries -= 1
            if tries < 0:
                break
            other = goal.copy()
            other[i] = max(other[i] + by, 1.0)
            w, fits = _solve(points, other, ease, pinned=True)
            if fits and (off := float(abs(w - points).max())) < least - 1e-3:
                v, goal, least, better = w, other, off, True
    return v, goal, bool(np.isfinite(least))


def _follow(
    points: Complex, lengths: Floats, chord: Floats, weight: Floats, arc: NDArray[np.bool_]
) -> Complex:
    """Return vertices one after the other, each as near as the one before allows."""
    out = [complex(points[0])]
    for goal, length, fixed, w, is_arc in zip(
        points[1:].tolist(), lengths.tolist(), chord.tolist(), weight.tolist(), arc.tolist(),
        strict=True,
    ):  # fmt: skip
        way = goal - out[-1]
        far = abs(way)
        step = far + (fixed - far) * w / (1 + w) if is_arc else length
        out.append(out[-1] + (way / far * step if far else step))
    return np.array(out)


def _solve(points: Complex, goal: Floats, ease: Floats, *, pinned: bool) -> tuple[Complex, bool]:
    """Return the vertices nearest to ``points`` whose distances are ``goal``.

    Args:
        points: n + 1 vertices; the first stays, and the last where it is ``pinned``.
        goal: n distances.
        ease: 0 where a distance has to be met, else how little it matters.
        pinned: see ``points``.
    """
    v, n = points.copy(), len(goal)
    diagonal = np.full(n, 2.0)
    diagonal[0] -= 1.0
    if pinned:
        diagonal[-1] -= 1.0
    for _ in range(ROUNDS):
        way = np.diff(v)
        far = np.maximum(abs(way), 1e-6)
        u = way / far
        link = -(u[1:] * u[:-1].conj()).real
        back = points - v
        # Row i of G moves vertex i + 1 along u and vertex i against it.
        right = (far - goal) + (u.conj() * np.diff(back)).real
        force = _tridiagonal(diagonal + ease, link, right)
        if force is None:
            return v, False
        pull = u * force
        shift = np.zeros(n + 1, dtype=np.complex128)
        shift[1:] -= pull
        shift[:-1] += pull
        shift[0] = 0
        if pinned:
            shift[-1] = 0
        new = points + shift
        moved = float(abs(new - v).max())
        v = new
        if not np.isfinite(moved) or abs(shift).max() > 50:
            return v, False
        if moved < 1e-7:
            break
    missed = abs(np.diff(v)) - goal
    met = abs(missed[ease == 0]).max(initial=0.0) < 1e-3
    return v, bool(met and abs(v - points).max() <= MOVED_UM)


def _tridiagonal(diagonal: Floats, link: Floats, right: Floats) -> Floats | None:
    """Return the solution of symmetric tridiagonal equations; None where there is none."""
    d, r, e = diagonal.tolist(), right.tolist(), link.tolist()
    for i in range(1, len(d)):
        if abs(d[i - 1]) < 1e-9:
            return None
        factor = e[i - 1] / d[i - 1]
        d[i] -= factor * e[i - 1]
        r[i] -= factor * r[i - 1]
    if abs(d[-1]) < 1e-9:
        return None
    r[-1] /= d[-1]
    for i in range(len(d) - 2, -1, -1):
        r[i] = (r[i] - e[i] * r[i + 1]) / d[i]
    return np.array(r)


def _find_angles(figure: NDArray[np.void], path: NDArray[np.void], points: Complex) -> None:
    """Set headings, start angles and sweeps, of 8 digits, each from where the ones before lead."""
    arc = path["kind"] == Kind.ARC
    ring = rings(path)
    radius = np.maximum(figure["size"].astype(np.float64), 1.0)
    chord = abs(np.diff(points))
    share = np.clip(chord / (2 * radius), 0.0, 1.0)
    short = np.degrees(2 * np.arcsin(share))
    sweep = np.where(path["sweep"] > 180.0, 360.0 - short, short)
    # Near half a turn the chord tells nothing of the sweep.
    blunt = abs(np.cos(np.radians(path["sweep"]) / 2)) < 1e-3
    sweep = np.where(blunt | ring, path["sweep"], sweep)
    figure["sweep"] = np.where(arc, eight(np.where(arc, sweep, 0.0)), 0.0)
    turn = path["turn"].astype(np.float64)
    lean = np.where(arc, turn * (figure["sweep"] / 2 + 90.0), 0.0)
    at = complex(points[0])
    starts = np.zeros(len(path))
    length = np.where(arc, 2 * radius * np.sin(np.radians(figure["sweep"]) / 2), figure["size"])
    for i, goal in enumerate(points[1:].tolist()):
        if ring[i]:
            starts[i] = _eight(float(path["start"][i]))
            continue
        way = goal - at
        heading = float(np.degrees(np.arctan2(way.imag, way.real)))
        starts[i] = _eight((heading - lean[i]) % 360.0)
        angle = np.radians(starts[i] + lean[i])
        at += length[i] * complex(np.cos(angle), np.sin(angle))
    figure["start"] = starts


def eight(degrees: Floats) -> Floats:
    """Return angles rounded to 8 digits."""
    return rotation.angle_value(*rotation.angle_fields(degrees))


def _eight(degrees: float) -> float:
    value = float(eight(np.array([degrees]))[0])
    return 0.0 if value >= 360.0 else value


def _close(figure: NDArray[np.void], end: complex) -> None:
    """Change last digits until the sum of all displacements is as near to ``end`` as they allow."""
    base = displacements(figure)
    rest = complex(base.sum()) - end
    ring = rings(figure)
    rows = np.flatnonzero(~ring)
    if len(rows) > TRIED:
        rows = rows[np.argsort(abs(base[rows]), kind="stable")[:TRIED]]
    names = [(k, "start") for k in rows] + [
        (k, "sweep") for k in rows if figure["kind"][k] == Kind.ARC
    ]
    choices: list[tuple[int, str, float]] = []
    gains: list[complex] = []
    for k, name in names:
        old = float(figure[name][k])
        exponent, digits = (int(v[0]) for v in rotation.angle_fields(np.array([old])))
        for unit in UNITS:
            value = float(rotation.angle_value(np.array([exponent]), np.array([digits + unit]))[0])
            if not (0.0 <= value < 360.0 and 0 <= digits + unit < 10**8) or (
                name == "sweep" and value == 0.0
            ):
                continue
            row = figure[k : k + 1].copy()
            row[name] = value
            choices.append((int(k), name, value))
            gains.append(complex(displacements(row)[0] - base[k]))
    if not gains:
        return
    g = np.array(gains)
    owner = np.array([k for k, _, _ in choices])
    best = abs(rest)
    chosen: tuple[int, ...] = ()
    one = abs(rest + g)
    if one.min() < best:
        best, chosen = float(one.min()), (int(one.argmin()),)
    both = abs(rest + g[:, None] + g[None, :])
    both[owner[:, None] == owner[None, :]] = np.inf
    if both.min() < best:
        at = np.unravel_index(int(both.argmin()), both.shape)
        chosen = tuple(int(v) for v in at)
    for which in chosen:
        row_number, column, new = choices[which]
        figure[column][row_number] = new


def _middles_off(
    figure: NDArray[np.void], path: NDArray[np.void], ends: Complex, begin: complex
) -> float:
    """Return how far the middles of stated arcs are from those of the path, at most, um."""
    arc = np.flatnonzero((path["kind"] == Kind.ARC) & ~rings(path))
    if not len(arc):
        return 0.0
    true = path["x"] + 1j * path["y"]
    stated = _middle(np.concatenate([[begin], ends])[arc], ends[arc], figure["turn"][arc],
                     figure["size"][arc], figure["sweep"][arc])  # fmt: skip
    meant = _middle(np.concatenate([[0j], true])[arc], true[arc], path["turn"][arc],
                    path["radius"][arc], path["sweep"][arc])  # fmt: skip
    return float(abs(stated - meant).max())


def _middle(start: Complex, end: Complex, turn: Ints, radius: Floats, sweep: Floats) -> Complex:
    chord = end - start
    quarter = np.radians(sweep) / 4
    u = chord / np.maximum(abs(chord), 1e-9)
    return np.asarray(start + 2 * radius * np.sin(quarter) * u * np.exp(-1j * turn * quarter))
