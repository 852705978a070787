"""Independent judges of geometry: slow, obvious, and sharing nothing with the compiler.

Areas come from Clipper2 (integer polygons, pyclipr), distances from brute force over all segments,
and a contour's own area from the line and arc formulas. Only the data model is shared.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wedmcam.ir.contour import Contour

Floats = NDArray[np.float64]

#: Arcs become chords of this sagitta before Clipper2 sees them, and Clipper2 makes its round joins
#: as fine, um: area is then known to about 0.02 um times the length.
SAGITTA_UM = 0.01
#: Clipper2's integer grid: 10,000 units a um = 0.1 nm.
GRID_PER_UM = 10_000
#: How far a point of an offset contour may be from its distance, um.
DISTANCE_UM = 0.01
#: Two topologies closer than this in offset cannot be told apart by 10 nm chords, um.
BLUR_UM = 0.03


# --- one contour -------------------------------------------------------------------------------


def sweeps(contour: Contour) -> Floats:
    """Signed sweep of each segment, radians; 0 for a line, +-2 pi for a full circle."""
    a, b = contour.starts, contour.ends
    turn = a["turn"].astype(float)
    difference = np.arctan2(b["y"] - a["cy"], b["x"] - a["cx"]) - np.arctan2(
        a["y"] - a["cy"], a["x"] - a["cx"]
    )
    sweep = np.mod(difference * turn, 2 * np.pi)
    full = (a["x"] == b["x"]) & (a["y"] == b["y"])
    return np.where(turn == 0, 0.0, np.where(full, 2 * np.pi, sweep) * turn)


def radii(contour: Contour) -> Floats:
    """Distance of each segment's start from its centre, um; 0 for a line."""
    a = contour.starts
    return np.where(a["turn"] == 0, 0.0, np.hypot(a["x"] - a["cx"], a["y"] - a["cy"]))


def lengths(contour: Contour) -> Floats:
    """Length of each segment, um."""
    a, b = contour.starts, contour.ends
    chord = np.hypot(b["x"] - a["x"], b["y"] - a["y"])
    return np.where(a["turn"] == 0, chord, radii(contour) * np.abs(sweeps(contour)))


def signed_area(contour: Contour) -> float:
    """Area enclosed by a closed contour, um^2, > 0 when it runs counter-clockwise.

    The shoelace formula about the first vertex, and a circular segment R^2 (s - sin s) / 2 an arc.
    """
    a, b = contour.starts, contour.ends
    x0, y0 = a["x"][0], a["y"][0]
    shoelace = (a["x"] - x0) * (b["y"] - y0) - (b["x"] - x0) * (a["y"] - y0)
    s = sweeps(contour)
    # s - sin s cancels for flat arcs: s^3 / 6 is exact to 1e-10 below 1e-4.
    bow = np.where(np.abs(s) < 1e-4, s**3 / 6, s - np.sin(s))
    return float(shoelace.sum() / 2 + (radii(contour) ** 2 * bow).sum() / 2)


def _at(contour: Contour, segment: NDArray[np.intp], part: Floats) -> Floats:
    """Points at ``part`` (0..1) of the given segments, shape (n, 2)."""
    a, b = contour.starts[segment], contour.ends[segment]
    s, r = sweeps(contour)[segment], radii(contour)[segment]
    angle = np.arctan2(a["y"] - a["cy"], a["x"] - a["cx"]) + part * s
    arc = a["turn"] != 0
    x = np.where(arc, a["cx"] + r * np.cos(angle), a["x"] + part * (b["x"] - a["x"]))
    y = np.where(arc, a["cy"] + r * np.sin(angle), a["y"] + part * (b["y"] - a["y"]))
    return np.column_stack([x, y])


def chords(contour: Contour, sagitta_um: float = SAGITTA_UM) -> Floats:
    """Vertices of inscribed chords of at most ``sagitta_um``, shape (n, 2); closing row left out.

    A closed contour's ring is not repeated at its end; an open one ends with its last vertex.
    """
    s, r = np.abs(sweeps(contour)), radii(contour)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = 2 * np.arccos(np.clip(1 - sagitta_um / np.maximum(r, 1e-300), 0, 1))
        count = np.where(r > 0, np.ceil(s / step), 1).astype(np.intp).clip(1)
    count = np.where((s > 0) & (len(contour) < 3), count.clip(3), count)
    segment = np.repeat(np.arange(len(contour)), count)
    first = np.repeat(np.cumsum(count) - count, count)
    part = (np.arange(len(segment)) - first) / count[segment]
    points = _at(contour, segment, part)
    at_vertex = part == 0
    v = contour.vertices[segment[at_vertex]]
    points[at_vertex] = np.column_stack([v["x"], v["y"]])
    if not contour.closed:
        last = contour.vertices[-1]
        points = np.vstack([points, (last["x"], last["y"])])
    return points


def sample_contour(contour: Contour, n: int) -> Floats:
    """About ``n`` points of the contour, shape (m, 2): evenly by length, and of every segment the
    start, a point inside and a point near each end, however short it is.
    """
    length = lengths(contour)
    count = np.maximum(np.round(n * length / max(length.sum(), 1e-300)).astype(np.intp), 1)
    segment = np.repeat(np.arange(len(contour)), count)
    first = np.repeat(np.cumsum(count) - count, count)
    part = (np.arange(len(segment)) - first + 0.5) / count[segment]
    each = np.arange(len(contour))
    segment = np.concatenate([segment, each, each, each])
    part = np.concatenate([part, 0.0 * each, 0.0 * each + 0.01, 0.0 * each + 0.99])
    points = _at(contour, segment, part)
    last = contour.ends[-1]
    return np.vstack([points, (last["x"], last["y"])])


def distance_to_contour(points: Floats, contour: Contour) -> Floats:
    """Distance of each point (n, 2) to the nearest point of the contour, um, by brute force."""
    p = np.atleast_2d(np.asarray(points, float))
    out = np.empty(len(p))
    chunk = max(1, 2_000_000 // len(contour))
    for i in range(0, len(p), chunk):
        out[i : i + chunk] = _distances(p[i : i + chunk], contour).min(axis=1)
    return out


def _distances(p: Floats, contour: Contour) -> Floats:
    a, b = contour.starts, contour.ends
    x, y = p[:, :1], p[:, 1:]
    to_start = np.hypot(x - a["x"], y - a["y"])
    to_end = np.hypot(x - b["x"], y - b["y"])
    ends = np.minimum(to_start, to_end)
    # Lines: the foot of the perpendicular, if it lies on the segment.
    dx, dy = b["x"] - a["x"], b["y"] - a["y"]
    length = np.hypot(dx, dy)
    safe = np.where(length > 0, length, 1)
    along = ((x - a["x"]) * dx + (y - a["y"]) * dy) / safe
    across = np.abs((x - a["x"]) * dy - (y - a["y"]) * dx) / safe
    on_line = (along >= 0) & (along <= length) & (length > 0)
    # Arcs: the radial distance, if the point's polar angle lies within the sweep.
    s = np.abs(sweeps(contour))
    angle = np.arctan2(y - a["cy"], x - a["cx"]) - np.arctan2(a["y"] - a["cy"], a["x"] - a["cx"])
    on_arc = np.mod(angle * a["turn"], 2 * np.pi) <= s
    radial = np.abs(np.hypot(x - a["cx"], y - a["cy"]) - radii(contour))
    inner = np.where(a["turn"] == 0, across, radial)
    inside = np.where(a["turn"] == 0, on_line, on_arc)
    return np.where(inside, np.minimum(inner, ends), ends)


# --- offsets -----------------------------------------------------------------------------------


def _ring_area(ring: Floats) -> float:
    x, y = (ring - ring[0]).T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


def _ring_length(ring: Floats) -> float:
    return float(np.hypot(*(np.roll(ring, -1, axis=0) - ring).T).sum())


def clipper_offset_area(contour: Contour, signed_offset_um: float) -> tuple[float, list[Floats]]:
    """Area (um^2) and loops of a closed contour offset by Clipper2.

    Args:
        contour: closed and simple, either direction.
        signed_offset_um: > 0 outwards, < 0 inwards; round joins.

    Returns:
        The area of the offset region, holes taken off, and its loops, each (n, 2) in um: outer
        loops counter-clockwise, holes clockwise.
    """
    import pyclipr

    ring = chords(contour)
    if _ring_area(ring) < 0:
        ring = ring[::-1]
    origin = np.round(ring.mean(axis=0))
    engine = pyclipr.ClipperOffset()
    engine.scaleFactor = GRID_PER_UM
    engine.arcTolerance = SAGITTA_UM * GRID_PER_UM
    engine.addPath(ring - origin, pyclipr.JoinType.Round, pyclipr.EndType.Polygon)
    loops = [np.asarray(loop, float) + origin for loop in engine.execute(signed_offset_um)]
    loops = [loop for loop in loops if len(loop) > 2]
    return sum(map(_ring_area, loops)), loops


def negligible_area(length_um: float) -> float:
    """Area below which a loop of this length is a sliver that 10 nm chords cannot judge, um^2."""
    return 0.05 * length_um + 1.0


def _counts(loops: list[Floats]) -> tuple[int, int]:
    """How many loops run counter-clockwise and clockwise, slivers left out."""
    area = [_ring_area(loop) for loop in loops]
    real = [a for a, loop in zip(area, loops, strict=True) if abs(a) > _sliver(loop)]
    return sum(a > 0 for a in real), sum(a < 0 for a in real)


def _sliver(loop: Floats) -> float:
    return negligible_area(_ring_length(loop))


def check_offset(
    contour: Contour,
    signed_offset_um: float,
    result: Sequence[Contour],
    *,
    samples: int = 400,
    tolerance_um: float = DISTANCE_UM,
) -> list[str]:
    """Complaints about an offset of a closed contour; an empty list means that it is right.

    Checked: every loop is closed and its arcs end on their circles; the number of loops of each
    direction and the enclosed area, against Clipper2; every sampled point lies at the offset from
    the contour; outer loops run as the contour does, holes the other way. Loops thinner than some
    0.05 um are not counted, and where Clipper2 itself changes its mind within 0.03 um of offset
    (a slot as wide as twice the offset) either number of loops passes.

    Args:
        contour: closed and simple, either direction.
        signed_offset_um: > 0 outwards, < 0 inwards.
        result: the loops to judge.
        samples: points sampled a loop, at least four a segment.
        tolerance_um: how far a point may be off the offset, and an arc's end off its circle.
    """
    complaints: list[str] = []
    offset = abs(signed_offset_um)
    direction = np.sign(signed_area(contour))
    for i, loop in enumerate(result):
        if not loop.closed:
            complaints.append(f"loop {i} is open")
            continue
        ends = loop.ends
        off_circle = np.abs(np.hypot(ends["x"] - loop.starts["cx"], ends["y"] - loop.starts["cy"]))
        off_circle = np.where(loop.starts["turn"] != 0, np.abs(off_circle - radii(loop)), 0.0)
        if off_circle.max() > tolerance_um:
            complaints.append(f"loop {i}: an arc misses its end by {off_circle.max():.4g} um")
        points = sample_contour(loop, samples)
        error = np.abs(distance_to_contour(points, contour) - offset)
        worst = int(error.argmax())
        if error[worst] > tolerance_um:
            x, y = points[worst]
            complaints.append(
                f"loop {i}: ({x:.3f}, {y:.3f}) um is {error[worst]:.4g} um off the offset"
            )
    closed = [loop for loop in result if loop.closed]
    complaints += _check_area(contour, signed_offset_um, closed, float(direction))
    return complaints


def _check_area(
    contour: Contour, signed_offset_um: float, result: list[Contour], direction: float
) -> list[str]:
    complaints: list[str] = []
    expected, loops = clipper_offset_area(contour, signed_offset_um)
    areas = [direction * signed_area(loop) for loop in result]
    length = lengths(contour).sum() + sum(lengths(loop).sum() for loop in result)
    length += sum(map(_ring_length, loops))
    # Half of the 0.02 um a length each for the two contours that Clipper2's chords approximate;
    # 1 um^2 for a figure too small for that.
    tolerance = 0.01 * length + 1.0
    if abs(sum(areas) - expected) > tolerance:
        complaints.append(
            f"area {sum(areas):.3f} um^2, Clipper2 {expected:.3f} um^2, tolerance {tolerance:.3f}"
        )
    real = [
        a
        for a, loop in zip(areas, result, strict=True)
        if abs(a) > negligible_area(float(lengths(loop).sum()))
    ]
    counts = sum(a > 0 for a in real), sum(a < 0 for a in real)
    if counts != _counts(loops):
        blurred = [
            _counts(clipper_offset_area(contour, signed_offset_um + blur)[1])
            for blur in (-BLUR_UM, 0.0, BLUR_UM)
        ]
        for k, name in ((0, "outer"), (1, "inner")):
            low, high = min(c[k] for c in blurred), max(c[k] for c in blurred)
            if not low <= counts[k] <= high:
                complaints.append(f"{counts[k]} {name} loops, Clipper2 {low} to {high}")
    return complaints
