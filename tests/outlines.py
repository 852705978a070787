"""Outlines in compensation data for tests: random contours, and their wire in 50 digits."""

from typing import NamedTuple

import mpmath
import numpy as np

from wedmcam.controllers.pointwise import MIRROR, arc_end
from wedmcam.controllers.zd065.data import OUTLINE
from wedmcam.ir.program import Axis, Kind

DIGITS = 50


def line(x, y):
    """Return a row of `OUTLINE`: a line."""
    return (Kind.LINE, 0, 0, 0, 0, x, y, 0)


def arc(start, end, centre, turn, grows):
    """Return a row of `OUTLINE` that lands on ``end``, or None; places are whole um."""
    x, y = start[0] - centre[0], start[1] - centre[1]
    e = arc_end(x, y, turn, end[0] - centre[0], end[1] - centre[1])
    if not (e.landed and e.square_counts and 0 < e.count_square <= 999_999):
        return None
    radius = round(float(np.hypot(x, y)))
    return (Kind.ARC, turn, grows, Axis.SQUARE, radius, x, y, int(e.count_square))


def figure(*rows):
    """Return rows as an outline."""
    out = np.zeros(len(rows), OUTLINE)
    for k, row in enumerate(rows):
        out[k] = row
    return out


def bulged(start, end, bulge, outwards_right=True):
    """Return an arc of a bulge (tan of a quarter of the sweep), with the nearest whole centre."""
    (x0, y0), (x1, y1) = start, end
    turn = 1 if bulge > 0 else -1
    factor = (1 / bulge - bulge) / 4
    cx = (x0 + x1) / 2 - (y1 - y0) * factor
    cy = (y0 + y1) / 2 + (x1 - x0) * factor
    near = [(i, j) for i in range(-3, 4) for j in range(-3, 4)]
    for i, j in sorted(near, key=lambda o: o[0] ** 2 + o[1] ** 2):
        centre = round(cx) + i, round(cy) + j
        row = arc(start, end, centre, turn, turn if outwards_right else -turn)
        if row is not None:
            return row
    return None


def contour(points, bulges, lead=None):
    """Return a closed counter-clockwise outline through whole places; its types say outer.

    An edge with bulge 0 is a line, as is one for which there is no arc. ``lead``: a place, from
    which the wire goes to the first point and back.
    """
    rows = []
    for k, start in enumerate(points):
        end = points[(k + 1) % len(points)]
        row = bulged(start, end, bulges[k]) if bulges[k] else None
        rows.append(row or line(end[0] - start[0], end[1] - start[1]))
    if lead is not None:
        (x, y), (a, b) = points[0], lead
        rows = [line(x - a, y - b), *rows, line(a - x, b - y)]
    return figure(*rows)


def random_contour(rng, size=20_000.0, arcs=0.4, bulge=0.5, apart=False):
    """Return a random star-shaped contour that starts in the middle of its first line.

    ``apart``: no arc meets an arc.
    """
    n = int(rng.integers(3, 9))
    angles = np.sort((np.arange(n) + rng.uniform(-0.35, 0.35, n)) * 2 * np.pi / n)
    radii = size * rng.uniform(0.55, 1.0, n)
    points = [
        (round(r * np.cos(a)), round(r * np.sin(a)))
        for r, a in zip(radii.tolist(), angles.tolist(), strict=True)
    ]
    bulges = np.where(rng.random(n) < arcs, rng.uniform(-bulge, bulge, n), 0.0).tolist()
    if apart:
        bulges = [b if k % 2 else 0.0 for k, b in enumerate(bulges)]
    (x0, y0), (x1, y1) = points[0], points[-1]
    # The last edge is a line with a whole middle, in which the contour starts and ends.
    points[-1] = (x1 + (x0 + x1) % 2, y1 + (y0 + y1) % 2)
    x1, y1 = points[-1]
    middle = (x0 + x1) // 2, (y0 + y1) // 2
    lead = middle[0] + round(0.2 * (y0 - y1)), middle[1] - round(0.2 * (x0 - x1))
    return contour([middle, *points], [0.0, *bulges[:-1], 0.0], lead)


class Exact(NamedTuple):
    """What the wire does at a joint: two places, and the radius of the arc between, or None."""

    out: tuple
    into: tuple
    radius: object


def exact_joints(rows, shift, corner, sure=1.5):
    """Return for each joint of a closed contour what the wire does there, in 50 digits.

    Args:
        rows: an outline whose first and last blocks are leads.
        shift: of the wire to the left, um.
        corner: radius of the transition arcs.
        sure: over which length directions are known, um.

    All is done about the origin, with circles as centres and radii, as one would on paper.
    """
    with mpmath.workdps(DIGITS):
        return _exact_joints(rows, mpmath.mpf(shift), mpmath.mpf(corner), sure)


def _exact_joints(rows, h, r, sure):
    blocks = []
    at = (int(rows["x"][0]), int(rows["y"][0]))
    first = at
    for row in rows[1:-1]:
        x, y = int(row["x"]), int(row["y"])
        if row["kind"] == Kind.LINE:
            end = (at[0] + x, at[1] + y)
            blocks.append((None, 0, at, end))
        else:
            one = np.zeros(1, MIRROR_BLOCK)
            for name in ("kind", "turn", "axis", "x", "y", "count"):
                one[name] = row[name]
            m = MIRROR.run(one)
            end = (at[0] + int(m.dx[0]), at[1] + int(m.dy[0]))
            blocks.append(((at[0] - x, at[1] - y), int(row["turn"]), at, end))
        at = end
    assert at == first
    return [
        _joint(blocks[k], blocks[(k + 1) % len(blocks)], h, r, sure) for k in range(len(blocks))
    ]


def _unit(x, y):
    size = mpmath.sqrt(mpmath.mpf(x) ** 2 + mpmath.mpf(y) ** 2)
    return x / size, y / size


def _normal(block, at):
    centre, turn, start, end = block
    if centre is None:
        return _unit(-(end[1] - start[1]), end[0] - start[0])
    return _unit(turn * (centre[0] - at[0]), turn * (centre[1] - at[1]))


def _size(block, at):
    centre, _, start, end = block
    a, b = (start, end) if centre is None else (centre, at)
    return mpmath.hypot(a[0] - b[0], a[1] - b[1])


def _joint(a, b, h, r, sure):
    v = a[3]
    n, m = _normal(a, v), _normal(b, v)
    sine, cosine = n[0] * m[1] - n[1] * m[0], n[0] * m[0] + n[1] * m[1]
    turn = mpmath.atan2(sine, cosine)
    unsure = min(sure / _size(a, v) + sure / _size(b, v), 0.35)
    if abs(turn) * r < 2 or abs(turn) < unsure:
        place = tuple(v[i] + h * (n[i] + m[i]) / (1 + cosine) for i in (0, 1))
        return Exact(place, place, None)
    if a[0] is not None and b[0] is not None:
        (cx, cy), (dx, dy) = a[0], b[0]
        p, q = _size(a, v) - a[1] * h, _size(b, v) - b[1] * h
        place = _nearest(_circles(cx, cy, p, dx, dy, q), v)
        return Exact(place, place, None)
    s = 1 if turn > 0 else -1
    centres = _centres(a, b, v, n, m, s * r)
    # Of several centres the one whose arc lies behind the one block and before the other.
    o = _nearest([c for c in centres if c is not None], v)
    wire = r - s * h
    out, into = (_foot(block, v, normal, o, s, wire) for block, normal in ((a, n), (b, m)))
    return Exact(out, into, wire)


def _centres(a, b, v, n, m, by):
    """Places at a distance from both blocks, to the left."""
    if a[0] is None and b[0] is None:
        # v + by n + t u = v + by m + w z
        u, z = (n[1], -n[0]), (m[1], -m[0])
        t = (by * (m[0] - n[0]) * z[1] - by * (m[1] - n[1]) * z[0]) / (u[0] * z[1] - u[1] * z[0])
        return [(v[0] + by * n[0] + t * u[0], v[1] + by * n[1] + t * u[1])]
    block, normal = (a, n) if a[0] is None else (b, m)
    other = b if a[0] is None else a
    u = normal[1], -normal[0]
    distance = _size(other, v) - other[1] * by
    px, py = v[0] + by * normal[0] - other[0][0], v[1] + by * normal[1] - other[0][1]
    half = px * u[0] + py * u[1]
    inner = half * half - (px * px + py * py - distance * distance)
    assert inner >= 0
    assert block[0] is None
    return [
        (v[0] + by * normal[0] + t * u[0], v[1] + by * normal[1] + t * u[1])
        for t in (-half - mpmath.sqrt(inner), -half + mpmath.sqrt(inner))
    ]


def _foot(block, v, normal, o, s, wire):
    if block[0] is None:
        return o[0] - s * wire * normal[0], o[1] - s * wire * normal[1]
    x, y = _unit(block[0][0] - o[0], block[0][1] - o[1])
    return o[0] - s * wire * block[1] * x, o[1] - s * wire * block[1] * y


def _circles(cx, cy, p, dx, dy, q):
    x, y = dx - cx, dy - cy
    apart = mpmath.hypot(x, y)
    along = (p * p - q * q + apart * apart) / (2 * apart)
    half = mpmath.sqrt(p * p - along * along)
    ux, uy = x / apart, y / apart
    return [(cx + ux * along - s * uy * half, cy + uy * along + s * ux * half) for s in (1, -1)]


def _nearest(places, v):
    return min(places, key=lambda p: (p[0] - v[0]) ** 2 + (p[1] - v[1]) ** 2)


MIRROR_BLOCK = np.dtype([(n, OUTLINE[n]) for n in ("kind", "turn", "axis", "x", "y", "count")])
