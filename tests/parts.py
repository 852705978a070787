"""Made parts for property tests and benchmarks: random, seeded, in um, and always simple.

Nothing here calls the compiler's geometry: a fault there cannot hide itself by making its own test
cases. Every contour is counter-clockwise; tests reverse and mirror them as they like.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray

from wedmcam.ir.contour import VERTEX, Contour

Floats = NDArray[np.float64]

# --- building contours -------------------------------------------------------------------------


def contour_of_bulges(points: Floats, bulges: Floats, closed: bool = True) -> Contour:
    """Contour of vertices (um) and DXF bulges, tan(sweep / 4), > 0 counter-clockwise.

    Repeated vertices are dropped: an arc without length would read as a full circle.
    """
    p, b = np.asarray(points, float), np.asarray(bulges, float)
    following = np.roll(p, -1, axis=0)
    keep = (p != following).any(axis=1)
    if not closed:
        keep[-1] = True
    p, b = p[keep], b[keep]
    chord = np.roll(p, -1, axis=0) - p
    arc = np.abs(b) > 1e-12
    if not closed:
        arc[-1] = False
    v = np.zeros(len(p), VERTEX)
    v["x"], v["y"], v["source"] = p[:, 0], p[:, 1], -1
    v["turn"] = np.where(arc, np.sign(b), 0)
    # The centre lies on the chord's bisector, (1 - b^2) / (4 b) chords to the left of its middle.
    height = np.where(arc, (1 - b * b) / (4 * np.where(arc, b, 1)), 0)
    v["cx"] = np.where(arc, p[:, 0] + chord[:, 0] / 2 - height * chord[:, 1], 0)
    v["cy"] = np.where(arc, p[:, 1] + chord[:, 1] / 2 + height * chord[:, 0], 0)
    return Contour(v, closed)


def circle(x: float, y: float, radius: float) -> Contour:
    """Full circle about (x, y), counter-clockwise, one row, starting at its +x end."""
    return Contour(np.array([(x + radius, y, x, y, 1, -1)], VERTEX), True)


def rectangle(width: float, height: float, x: float = 0, y: float = 0) -> Contour:
    """Rectangle with its lower left corner at (x, y)."""
    p = np.array([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])
    return contour_of_bulges(p, np.zeros(4))


def slot(x: float, y: float, length: float, width: float, angle: float = 0.0) -> Contour:
    """Obround about (x, y): two lines of ``length`` and two half circles of ``width / 2``."""
    a, r = length / 2, width / 2
    return contour_of_bulges(
        _turned(np.array([(-a, -r), (a, -r), (a, r), (-a, r)]), angle) + np.array([x, y]),
        np.array([0.0, 1.0, 0.0, 1.0]),
    )


def _turned(points: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([(c, s), (-s, c)])


def turns_of(points: Floats) -> Floats:
    """Turn of heading at every corner of a closed polygon, radians, > 0 to the left."""
    out = np.roll(points, -1, axis=0) - points
    into = np.roll(out, 1, axis=0)
    cross = into[:, 0] * out[:, 1] - into[:, 1] * out[:, 0]
    return np.arctan2(cross, (into * out).sum(axis=1))


def rounded(points: Floats, radii: Floats | float) -> tuple[Floats, Floats]:
    """Vertices and bulges of a closed polygon whose corner i has a tangent fillet of ``radii[i]``.

    A radius of 0 leaves the corner sharp. Asserts that the fillets fit on the sides.
    """
    p = np.asarray(points, float)
    r = np.broadcast_to(np.asarray(radii, float), len(p))
    turn = turns_of(p)
    side = np.roll(p, -1, axis=0) - p
    length = np.hypot(*side.T)
    heading = side / length[:, None]
    back = r * np.abs(np.tan(turn / 2))
    assert (back + np.roll(back, -1) <= length).all(), "fillets overlap"
    rows: list[tuple[float, float, float]] = []
    for i in range(len(p)):
        if r[i] == 0:
            rows.append((p[i, 0], p[i, 1], 0.0))
            continue
        a, b = p[i] - back[i] * heading[i - 1], p[i] + back[i] * heading[i]
        rows += [(a[0], a[1], float(np.tan(turn[i] / 4))), (b[0], b[1], 0.0)]
    made = np.array(rows)
    return made[:, :2], made[:, 2]


def fitting_radii(points: Floats, wish: Floats) -> Floats:
    """``wish`` shortened so that the fillets of two neighbours share at most 0.9 of their side."""
    tangent = np.abs(np.tan(turns_of(points) / 2))
    length = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    room = 0.45 * np.minimum(length, np.roll(length, 1))
    return np.minimum(wish, room / np.maximum(tangent, 1e-12))


def biarcs(points: Floats, tangents: Floats) -> tuple[Floats, Floats]:
    """Vertices and bulges of the closed chain of biarcs (equal tangent lengths) through points."""
    p0, t0 = points, tangents
    p1, t1 = np.roll(points, -1, axis=0), np.roll(tangents, -1, axis=0)
    v = p1 - p0
    vt = (v * (t0 + t1)).sum(1)
    vv = (v * v).sum(1)
    d = vv / (vt + np.sqrt(vt * vt + 2 * (1 - (t0 * t1).sum(1)) * vv))
    joint = (p0 + p1 + d[:, None] * (t0 - t1)) / 2

    def bulge(heading: Floats, chord: Floats) -> Floats:
        cross = heading[:, 0] * chord[:, 1] - heading[:, 1] * chord[:, 0]
        return np.tan(np.arctan2(cross, (heading * chord).sum(1)) / 2)

    first = bulge(t0, joint - p0)
    # The second arc seen backwards from p1 runs along -t1 and bends the other way.
    second = -bulge(-t1, joint - p1)
    at = np.stack([p0, joint], axis=1).reshape(-1, 2)
    return at, np.stack([first, second], axis=1).reshape(-1)


# --- judging them ------------------------------------------------------------------------------


def polygon(contour: Contour, sagitta_um: float = 0.05) -> shapely.Polygon:
    """Closed contour as a polygon of chords whose sagitta is at most ``sagitta_um``."""
    from oracle import chords

    return shapely.Polygon(chords(contour, sagitta_um))


def is_simple(contour: Contour) -> bool:
    """Whether a closed contour neither crosses nor touches itself, as far as fine chords show."""
    from oracle import chords

    ring = chords(contour, 0.01)
    return len(ring) > 2 and shapely.LinearRing(ring).is_simple


def _corner_loss(contour: Contour, radius: float, convex: bool) -> float:
    """Area that a disc of ``radius`` leaves uncut in the sharp corners of one sense, um^2."""
    v, following = contour.vertices, np.roll(contour.vertices, -1)
    start, end = _headings(v, following)
    turn = np.angle(np.exp(1j * (start - np.roll(end, 1))))
    phi = np.maximum(turn if convex else -turn, 0)
    return float((radius**2 * (np.tan(phi / 2) - phi / 2)).sum())


def _headings(a: NDArray[np.void], b: NDArray[np.void]) -> tuple[Floats, Floats]:
    """Heading at the start and at the end of each segment, radians."""
    line = np.arctan2(b["y"] - a["y"], b["x"] - a["x"])
    quarter = a["turn"] * (np.pi / 2)
    start = np.arctan2(a["y"] - a["cy"], a["x"] - a["cx"]) + quarter
    end = np.arctan2(b["y"] - a["cy"], b["x"] - a["cx"]) + quarter
    arc = a["turn"] != 0
    return np.where(arc, start, line), np.where(arc, end, line)


def takes_disc(contour: Contour, radius: float, inside: bool) -> bool:
    """Whether a disc rolls along one side of the contour and loses only the sharp corners.

    So neither a neck nor a fillet is narrower than the disc. The area that morphological opening
    (inside) or closing (outside) takes is compared with d^2 (tan(phi/2) - phi/2) a corner of turn
    phi.
    """
    shape = polygon(contour, 0.2)
    sign = -1 if inside else 1
    moved = shape.buffer(sign * radius, quad_segs=64).buffer(-sign * radius, quad_segs=64)
    if moved.geom_type != "Polygon" or moved.interiors:
        return False
    loss = abs(moved.area - shape.area)
    return loss <= 1.02 * _corner_loss(contour, radius, inside) + 0.5 * shape.length


# --- (a) realistic parts -----------------------------------------------------------------------


def random_part(seed: int, offset_um: float = 100.0) -> tuple[Contour, ...]:
    """Part of an outer contour and up to 6 holes; every fillet is at least twice ``offset_um``.

    Corners are sharp or filleted, sides straight or arcs, 5 to 100 mm across, somewhere within
    200 mm of the origin. Necks, slots and walls between contours are wider than 4 offsets, so the
    part is cut with ``offset_um`` without interference on any side.
    """
    rng = np.random.default_rng([seed, 1])
    size = float(np.exp(rng.uniform(np.log(5e3), np.log(1e5))))
    outer = _redraw(
        rng,
        lambda: _random_outline(rng, size, 2 * offset_um),
        lambda c: takes_disc(c, 1.99 * offset_um, True) and takes_disc(c, 1.99 * offset_um, False),
    )
    shape = polygon(outer, 1.0)
    free = shape.buffer(-6 * offset_um)
    holes: list[Contour] = []
    for _ in range(int(rng.integers(0, 7))):
        if free.is_empty:
            break
        placed = _place_hole(rng, free, size, 2 * offset_um)
        if placed is not None and takes_disc(placed, 1.99 * offset_um, True):
            holes.append(placed)
            free = free.difference(polygon(placed, 1.0).buffer(6 * offset_um))
    shift = rng.uniform(-1e5, 1e5, 2)
    if rng.random() < 0.5:
        shift = np.round(shift)
    return tuple(moved(c, *shift) for c in (outer, *holes))


def moved(contour: Contour, dx: float, dy: float) -> Contour:
    """Return the contour shifted by (dx, dy) um."""
    v = contour.vertices.copy()
    arc = v["turn"] != 0
    v["x"] += dx
    v["y"] += dy
    v["cx"] += dx * arc
    v["cy"] += dy * arc
    return Contour(v, contour.closed, contour.sources)


def _redraw(
    rng: np.random.Generator,
    draw: Callable[[], Contour],
    good: Callable[[Contour], bool] = lambda c: True,
) -> Contour:
    for _ in range(500):
        try:
            made = draw()
        except AssertionError:
            continue
        if is_simple(made) and good(made):
            return made
    raise AssertionError("no simple contour in 500 draws")


def _random_outline(rng: np.random.Generator, size: float, least: float) -> Contour:
    kind = rng.choice(["rect", "star", "steps", "round"])
    if kind == "round":
        n = int(rng.integers(2, 8))
        return _bulged_ring(rng, n, size, least)
    if kind == "star":
        n = int(rng.integers(4, 12))
        angle = np.sort(rng.uniform(0, 2 * np.pi, n))
        radius = size / 2 * rng.uniform(0.45, 1.0, n)
        p = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    else:
        w, h = size, size * rng.uniform(0.3, 1.0)
        p = np.array([(0, 0), (w, 0), (w, h), (0, h)], float)
        if kind == "steps":
            x0, x1 = np.sort(rng.uniform(0.15, 0.85, 2)) * w
            depth = rng.uniform(-0.4, 0.4) * h
            notch = np.array([(x1, h), (x1, h + depth), (x0, h + depth), (x0, h)])
            p = np.vstack([p[:3], notch, p[3:]])
    wish = np.exp(rng.uniform(np.log(least), np.log(size / 8), len(p)))
    radii = np.where(rng.random(len(p)) < 0.35, 0.0, fitting_radii(p, wish))
    assert ((radii == 0) | (radii >= least)).all()
    return contour_of_bulges(*rounded(p, radii))


def _bulged_ring(rng: np.random.Generator, n: int, size: float, least: float) -> Contour:
    """Polygon whose sides are lines or arcs, corners sharp, arcs no tighter than ``least``."""
    n = max(n, 3)
    angle = (np.arange(n) + rng.uniform(-0.3, 0.3, n)) * 2 * np.pi / n
    p = (size / 2 * rng.uniform(0.6, 1.0, n))[:, None] * np.column_stack(
        [np.cos(angle), np.sin(angle)]
    )
    b = rng.uniform(-0.35, 0.6, n) * (rng.random(n) < 0.7)
    side = np.hypot(*(np.roll(p, -1, axis=0) - p).T)
    with np.errstate(divide="ignore"):
        radius = side * (1 + b * b) / (4 * np.abs(b))
    assert (radius >= least).all()
    return contour_of_bulges(p, b)


def _place_hole(
    rng: np.random.Generator, free: shapely.Geometry, size: float, least: float
) -> Contour | None:
    x0, y0, x1, y1 = free.bounds
    for _ in range(30):
        x, y = rng.uniform((x0, y0), (x1, y1))
        at = shapely.Point(x, y)
        room = float(free.boundary.distance(at))
        if not free.contains(at) or room < 2.5 * least:
            continue
        reach = min(room, size / 4) * rng.uniform(0.6, 1.0)
        angle = float(rng.uniform(0, 2 * np.pi))
        kind = rng.choice(["circle", "slot", "poly"])
        if kind == "circle" or reach < 3 * least:
            return circle(x, y, reach)
        if kind == "slot":
            half = rng.uniform(least, reach / 2)
            return slot(x, y, 2 * (reach - half), 2 * half, angle)
        n = int(rng.integers(3, 7))
        a = angle + (np.arange(n) + rng.uniform(-0.2, 0.2, n)) * 2 * np.pi / n
        p = np.array([x, y]) + reach * np.column_stack([np.cos(a), np.sin(a)])
        radii = fitting_radii(p, np.full(n, rng.uniform(least, reach)))
        radii = np.where(radii >= least, radii, 0.0) * (rng.random(n) < 0.8)
        return contour_of_bulges(*rounded(p, radii))
    return None


# --- (b) families of hard offset cases ---------------------------------------------------------

#: Family -> what is hard about it. Each has made at least one published offsetter fail or is next
#: to one that has.
FAMILIES: dict[str, str] = {
    "star": "random star of lines and arcs, sharp corners",
    "star-grid": "the same, vertices on the 1 um grid",
    "fillet-equal": "fillet radius = offset exactly: the arc shrinks to a point",
    "fillet-near": "fillet radius = offset +- 1e-6..1 um",
    "fillet-small": "offset up to 8 fillet radii: arcs vanish, neighbours cross",
    "tangent-grid": "tangent fillets rounded to the 1 um grid: joints miss tangency slightly",
    "slot": "a slot 2 x offset wide, exactly or +- 1e-6..0.1 um",
    "comb": "a comb whose walls and gaps are 2 x offset",
    "tiny": "tiny segments of 1e-4..1 um put in",
    "biarc": "biarc spline, offset greater than the local radius",
    "biarc-grid": "the same, vertices on the 1 um grid",
}


def family_case(name: str, seed: int) -> tuple[Contour, float, bool]:
    """Return (contour, offset in um, outward) number ``seed`` of a family of `FAMILIES`.

    The contour is simple and counter-clockwise; it is offset to its outside (True) or inside.
    """
    rng = np.random.default_rng([seed, 2, list(FAMILIES).index(name)])
    outward = bool(rng.integers(2))
    offset = float(rng.integers(50, 301))
    case: list[tuple[float, bool]] = []

    def draw() -> Contour:
        points, bulges, d, out = _FAMILY[name](rng, offset, outward)
        case[:] = [(d, out)]
        return contour_of_bulges(points, bulges)

    contour = _redraw(rng, draw)
    return contour, *case[0]


_Case = tuple[Floats, Floats, float, bool]


def _star_polygon(rng: np.random.Generator, size: float, least: int = 4, most: int = 25) -> Floats:
    n = int(rng.integers(least, most))
    angle = (np.arange(n) + rng.uniform(0.05, 0.95, n)) * 2 * np.pi / n
    radius = size * rng.uniform(0.35, 1.0, n)
    return radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])


def _star(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    p = _star_polygon(rng, offset * rng.uniform(8, 60))
    b = rng.uniform(-0.7, 0.7, len(p)) * (rng.random(len(p)) < 0.5)
    return p, b, offset, outward


def _on_grid(case: _Case) -> _Case:
    return np.round(case[0]), *case[1:]


def _filleted(rng: np.random.Generator, offset: float, radius: Floats | float) -> tuple:
    p = _star_polygon(rng, offset * rng.uniform(15, 60), 3, 12)
    return rounded(p, radius if np.ndim(radius) == 0 else radius[: len(p)])


def _fillet_equal(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    return *_filleted(rng, offset, offset), offset, outward


def _signed_tiny(rng: np.random.Generator, low: float, high: float, n: int | None = None) -> Floats:
    return 10.0 ** rng.uniform(low, high, n) * rng.choice([-1.0, 1.0], n)


def _fillet_near(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    return *_filleted(rng, offset, offset + _signed_tiny(rng, -6, 0, 12)), offset, outward


def _fillet_small(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    return *_filleted(rng, offset, offset / rng.uniform(1, 8, 12)), offset, outward


def _tangent_grid(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    radius = offset * np.exp(rng.uniform(np.log(0.3), np.log(4), 12))
    near = rng.random(12) < 0.3
    radius = np.where(near, offset + rng.uniform(-3, 3, 12), radius)
    return _on_grid((*_filleted(rng, offset, radius), offset, outward))


def _slot_equal(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    """Rectangle with a notch (outward) or a narrow bridge between two rooms (inward)."""
    width = 2 * offset
    if rng.random() < 0.75:
        width += float(_signed_tiny(rng, -6, -1))
    w, h = offset * rng.uniform(12, 40, 2)
    depth = h * rng.uniform(0.3, 0.7)
    a = w * rng.uniform(0.25, 0.6)
    if outward:
        rows = [(0, 0), (w, 0), (w, h), (a + width, h), (a + width, h - depth), (a, h - depth)]
        rows += [(a, h), (0, h)]
    else:
        y = h * rng.uniform(0.3, 0.6)
        rows = [(0, 0), (a, 0), (a, y), (a + depth, y), (a + depth, 0), (a + depth + w, 0)]
        rows += [(a + depth + w, h), (a + depth, h), (a + depth, y + width), (a, y + width)]
        rows += [(a, h), (0, h)]
    p = np.array(rows)
    b = np.zeros(len(p))
    if outward and rng.random() < 0.5:
        b[4] = -1.0  # a round bottom: a half circle of radius width / 2
    if rng.random() < 0.5:
        p = _turned(p, rng.uniform(0, 2 * np.pi))
    return p + rng.uniform(-1e4, 1e4, 2), b, offset, outward


def _comb(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    teeth = int(rng.integers(2, 9))
    pitch = 4 * offset
    depth = offset * rng.uniform(3, 20)
    rows = [(0.0, -6 * offset), ((teeth - 0.5) * pitch, -6 * offset)]
    for i in range(teeth - 1, -1, -1):
        x = i * pitch
        rows += [(x + pitch / 2, depth), (x, depth)]
        if i:
            rows += [(x, 0.0), (x - pitch / 2, 0.0)]
    p = np.array(rows)
    b = np.zeros(len(p))
    if rng.random() < 0.5:
        b[2::4] = 1.0  # round tips
    if rng.random() < 0.5:
        p = _turned(p, rng.uniform(0, 2 * np.pi))
    return p, b, offset, outward


def _tiny(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    p, b, *_ = _star(rng, offset, outward)
    rows: list[tuple[float, float, float]] = []
    following = np.roll(p, -1, axis=0)
    for i in range(len(p)):
        rows.append((p[i, 0], p[i, 1], b[i]))
        if rng.random() < 0.5:
            # Close to a vertex, at its end of the segment or as a small step beside it.
            step = 10.0 ** rng.uniform(-4, 0)
            ahead = (following[i] - p[i]) / np.hypot(*(following[i] - p[i]))
            way = ahead if rng.random() < 0.5 else _turned(ahead, rng.uniform(-1, 1))
            extra = p[i] + step * way
            rows[-1] = (p[i, 0], p[i, 1], float(rng.choice([0.0, 0.0, 0.3, -0.3])))
            rows.append((extra[0], extra[1], b[i]))
    made = np.array(rows)
    return made[:, :2], made[:, 2], offset, outward


def _wave(
    n: int, radius: float, amplitude: Sequence[float], phase: Sequence[float], lobes: Iterable[int]
) -> tuple[Floats, Floats]:
    """Points and unit tangents of r = radius (1 + sum a cos(k t + f)) at n equal steps of t."""
    t = np.arange(n) * 2 * np.pi / n
    r, dr = np.ones(n), np.zeros(n)
    for a, f, k in zip(amplitude, phase, lobes, strict=True):
        r += a * np.cos(k * t + f)
        dr -= a * k * np.sin(k * t + f)
    p = radius * r[:, None] * np.column_stack([np.cos(t), np.sin(t)])
    tangent = dr[:, None] * np.column_stack([np.cos(t), np.sin(t)]) + r[:, None] * np.column_stack(
        [-np.sin(t), np.cos(t)]
    )
    return p, tangent / np.hypot(*tangent.T)[:, None]


def _biarc(rng: np.random.Generator, offset: float, outward: bool) -> _Case:
    lobes = rng.integers(2, 8, 2)
    amplitude = rng.uniform(0.02, 0.35, 2)
    n = int(rng.integers(12, 50))
    size = offset * rng.uniform(3, 12)
    p, t = _wave(n, size, list(amplitude), list(rng.uniform(0, 6, 2)), lobes)
    points, bulges = biarcs(p, t)
    chord = np.hypot(*(np.roll(points, -1, axis=0) - points).T)
    # Outwards it is the clockwise arcs that shrink, inwards the others.
    shrinks = bulges < -1e-6 if outward else bulges > 1e-6
    assert shrinks.any()  # else drawn again
    tightest = (chord * (1 + bulges**2) / (4 * np.abs(bulges)))[shrinks].min()
    assert tightest < size / 2
    return points, bulges, float(np.round(tightest * rng.uniform(1.05, 3.0))), outward


_FAMILY: dict[str, Callable[[np.random.Generator, float, bool], _Case]] = {
    "star": _star,
    "star-grid": lambda *a: _on_grid(_star(*a)),
    "fillet-equal": _fillet_equal,
    "fillet-near": _fillet_near,
    "fillet-small": _fillet_small,
    "tangent-grid": _tangent_grid,
    "slot": _slot_equal,
    "comb": _comb,
    "tiny": _tiny,
    "biarc": _biarc,
    "biarc-grid": lambda *a: _on_grid(_biarc(*a)),
}

# --- workloads of known size -------------------------------------------------------------------

#: Distance from tooth to tooth, or slot to slot, along the root or bore circle, um.
PITCH_UM = 5000.0


def gear(segments: int) -> Contour:
    """Tangent-continuous gear of 8 segments a tooth: root arc, fillet, flank, fillet, tip arc, ...

    The root circle has a pitch of 5 mm, so 1000 segments have a root radius of 99.5 mm; teeth are
    4 mm high, 2.5 mm wide, fillets 0.5 mm. ``segments`` is a multiple of 8, at least 48.
    """
    assert segments % 8 == 0
    assert segments >= 48
    z = segments // 8
    root = z * PITCH_UM / (2 * np.pi)
    tip, half, r = root + 4000.0, 1250.0, 500.0
    foot = np.array([np.sqrt((root + r) ** 2 - (half + r) ** 2), half + r])
    head = np.array([np.sqrt((tip - r) ** 2 - (half - r) ** 2), half - r])
    upper = np.array(
        [
            head * (tip / (tip - r)),  # tip arc to fillet
            (head[0], half),  # fillet to flank
            (foot[0], half),  # flank to root fillet
            foot * (root / (root + r)),  # root fillet to root arc
        ]
    )
    tooth = np.vstack([upper[::-1] * (1, -1), upper])
    tip_half = np.arctan2(*upper[0][::-1])
    root_half = np.pi / z - np.arctan2(*upper[3][::-1])
    head_sweep = np.pi / 2 - tip_half
    foot_sweep = np.pi / 2 - np.arctan2(*upper[3][::-1])
    sweeps = np.array(
        [-foot_sweep, 0, head_sweep, 2 * tip_half, head_sweep, 0, -foot_sweep, 2 * root_half]
    )
    return _ring(tooth, np.tan(sweeps / 4), z)


def _ring(points: Floats, bulges: Floats, copies: int) -> Contour:
    angle = np.arange(copies) * 2 * np.pi / copies
    p = np.vstack([_turned(points, a) for a in angle])
    return contour_of_bulges(p, np.tile(bulges, copies))


def stator(segments: int, neck_um: float = 600.0) -> Contour:
    """Bore with slots, sharp corners, 8 segments a slot; the neck of a slot is 0.6 mm wide.

    The contour is the hole: the wire runs inside it. Pitch 5 mm along the bore. ``segments`` is a
    multiple of 8, at least 48.
    """
    assert segments % 8 == 0
    assert segments >= 48
    z = segments // 8
    bore = z * PITCH_UM / (2 * np.pi)
    a = neck_um / 2
    lower = np.array(
        [
            (np.sqrt(bore**2 - a**2), -a),  # end of the bore arc
            (bore + 800.0, -a),
            (bore + 1400.0, -1250.0),
            (bore + 5000.0, -1250.0),
        ]
    )
    p = np.vstack([lower, lower[::-1] * (1, -1)])
    b = np.zeros(8)
    b[3] = 0.25  # round bottom
    b[7] = np.tan((2 * np.pi / z - 2 * np.arcsin(a / bore)) / 4)
    return _ring(p, b, z)


def pinch(segments: int) -> Contour:
    """`stator` with necks of 0.2 mm: offset inwards by 0.13 mm it falls into 1 + segments / 8."""
    return stator(segments, 200.0)


def biarc(segments: int) -> Contour:
    """``segments`` (even) short tangent arcs along a curve of 5 lobes and 20 mm mean radius."""
    assert segments % 2 == 0
    assert segments >= 40
    p, t = _wave(segments // 2, 20e3, [0.15], [0.0], [5])
    return contour_of_bulges(*biarcs(p, t))


# --- as a drawing ------------------------------------------------------------------------------


def dxf_bytes(
    contours: Iterable[Contour],
    *,
    thread_points: Iterable[tuple[float, float]] = (),
    layer: str = "CUT",
    units: int = 4,
    polylines: bool = False,
    shuffle: int | None = None,
) -> bytes:
    """Return contours (um) as a minimal DXF R12 drawing of LINE, ARC and CIRCLE.

    Args:
        contours: open or closed.
        thread_points: POINT entities on layer START, um.
        layer: of the contours.
        units: $INSUNITS: 4 mm, 1 inch, 13 um; 0 leaves it out and writes mm.
        polylines: POLYLINE with bulges instead of single segments; a full circle stays a CIRCLE.
        shuffle: seed of a random order and direction of the entities; None keeps both.
    """
    scale = {4: 1e-3, 0: 1e-3, 1: 1 / 25400, 13: 1.0}[units]
    entities: list[list[object]] = []
    for contour in contours:
        entities += _polyline(contour, scale) if polylines else _segments(contour, scale, shuffle)
    entities += [["POINT", "START", 10, x * scale, 20, y * scale] for x, y in thread_points]
    if shuffle is not None:
        order = np.random.default_rng(shuffle).permutation(len(entities))
        entities = [entities[i] for i in order]
    out: list[object] = [0, "SECTION", 2, "HEADER", 9, "$ACADVER", 1, "AC1009"]
    if units:
        out += [9, "$INSUNITS", 70, units]
    out += [0, "ENDSEC", 0, "SECTION", 2, "ENTITIES"]
    handle = 0x20
    for kind, where, *tags in entities:
        for part in _split_at_zero([0, kind, *tags]):
            at = layer if where == "" else where
            out += [*part[:2], 5, f"{handle:X}", 8, at, *part[2:]]
            handle += 1
    out += [0, "ENDSEC", 0, "EOF"]
    return ("\n".join(map(_text, out)) + "\n").encode("ascii")


def _text(value: object) -> str:
    return repr(float(value)) if isinstance(value, float) else str(value)


def _split_at_zero(tags: list[object]) -> list[list[object]]:
    starts = [i for i in range(0, len(tags), 2) if tags[i] == 0 and isinstance(tags[i], int)]
    return [tags[a:b] for a, b in zip(starts, [*starts[1:], len(tags)], strict=True)]


def _circle_tags(v: np.void, scale: float) -> list[object]:
    r = float(np.hypot(v["x"] - v["cx"], v["y"] - v["cy"]))
    return ["CIRCLE", "", 10, v["cx"] * scale, 20, v["cy"] * scale, 40, r * scale]


def _segments(contour: Contour, scale: float, shuffle: int | None) -> list[list[object]]:
    rng = np.random.default_rng(shuffle)
    out: list[list[object]] = []
    for a, b in zip(contour.starts, contour.ends, strict=True):
        if a["turn"] == 0:
            if shuffle is not None and rng.random() < 0.5:
                a, b = b, a
            ends = [10, a["x"] * scale, 20, a["y"] * scale, 11, b["x"] * scale, 21, b["y"] * scale]
            out.append(["LINE", "", *ends])
        elif a["x"] == b["x"] and a["y"] == b["y"]:
            out.append(_circle_tags(a, scale))
        else:
            tags = _circle_tags(a, scale)
            first, last = (a, b) if a["turn"] > 0 else (b, a)  # DXF arcs are counter-clockwise
            angles = [
                float(np.degrees(np.arctan2(p["y"] - a["cy"], p["x"] - a["cx"])) % 360)
                for p in (first, last)
            ]
            out.append(["ARC", *tags[1:], 50, angles[0], 51, angles[1]])
    return out


def _polyline(contour: Contour, scale: float) -> list[list[object]]:
    if len(contour.vertices) == 1:
        return [_circle_tags(contour.vertices[0], scale)]
    tags: list[object] = ["POLYLINE", "", 66, 1, 10, 0.0, 20, 0.0, 70, int(contour.closed)]
    v = contour.vertices
    following = np.roll(v, -1)
    sweep = (
        (
            np.arctan2(following["y"] - v["cy"], following["x"] - v["cx"])
            - np.arctan2(v["y"] - v["cy"], v["x"] - v["cx"])
        )
        * v["turn"]
    ) % (2 * np.pi)
    bulge = np.where(v["turn"] == 0, 0, np.tan(sweep / 4) * v["turn"])
    for row, b in zip(v, bulge, strict=True):
        tags += [0, "VERTEX", 10, row["x"] * scale, 20, row["y"] * scale, 42, b + 0.0]
    return [[*tags, 0, "SEQEND"]]
