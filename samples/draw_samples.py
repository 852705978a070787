"""Draws the sample parts of this folder: ``python samples/draw_samples.py [FOLDER]``.

Eight parts as a shop would get them, from the simplest to the most awkward to read. All can be cut
with an offset of 0.1 mm: no inside radius, neck or slot is too small. Running it again gives the
same bytes. Numbers are mm, but for the bracket, which is drawn in inches.
"""

from __future__ import annotations

import io
import logging
import math
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import ezdxf
from ezdxf.document import Drawing
from ezdxf.layouts import BaseLayout

Point = tuple[float, float]
#: (x, y, bulge): the bulge belongs to the segment that starts here.
Vertex = tuple[float, float, float]


# --- drawing with lines and arcs ---------------------------------------------------------------


def polar(radius: float, angle: float, about: Point = (0, 0)) -> Point:
    """Point at an angle in radians."""
    return about[0] + radius * math.cos(angle), about[1] + radius * math.sin(angle)


def rounded(corners: Sequence[tuple[float, float, float]]) -> list[Vertex]:
    """Closed polygon of (x, y, fillet radius) corners as vertices with bulges."""
    out: list[Vertex] = []
    for i, (x, y, r) in enumerate(corners):
        before, after = corners[i - 1], corners[(i + 1) % len(corners)]
        into = math.atan2(y - before[1], x - before[0])
        away = math.atan2(after[1] - y, after[0] - x)
        turn = math.remainder(away - into, math.tau)
        if r == 0 or turn == 0:
            out.append((x, y, 0.0))
            continue
        back = r * abs(math.tan(turn / 2))
        out.append((*polar(-back, into, (x, y)), math.tan(turn / 4)))
        out.append((*polar(back, away, (x, y)), 0.0))
    return out


def arc_bulge(start: Point, end: Point, centre: Point, ccw: bool) -> float:
    """DXF bulge of the arc from start to end about a centre."""
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    b = math.atan2(end[1] - centre[1], end[0] - centre[0])
    sweep = (b - a) % math.tau if ccw else -((a - b) % math.tau)
    return math.tan(sweep / 4)


def turned(vertices: Iterable[Vertex], angle: float) -> list[Vertex]:
    """Vertices turned about the origin by an angle in radians."""
    c, s = math.cos(angle), math.sin(angle)
    return [(c * x - s * y, s * x + c * y, b) for x, y, b in vertices]


def pairs(vertices: Sequence[Vertex]) -> Iterator[tuple[Vertex, Vertex]]:
    """Start and end of every segment of a closed outline."""
    return zip(vertices, [*vertices[1:], vertices[0]], strict=True)


def add_segments(layout: BaseLayout, vertices: Sequence[Vertex], layer: str) -> None:
    """Add a closed outline as single LINE and ARC entities, as most drawing programs export it."""
    for (x0, y0, bulge), (x1, y1, _) in pairs(vertices):
        if bulge == 0:
            layout.add_line((x0, y0), (x1, y1), dxfattribs={"layer": layer})
            continue
        height = (1 - bulge * bulge) / (4 * bulge)  # of the centre, in chords left of the middle
        cx = (x0 + x1) / 2 - height * (y1 - y0)
        cy = (y0 + y1) / 2 + height * (x1 - x0)
        first = math.degrees(math.atan2(y0 - cy, x0 - cx))
        last = math.degrees(math.atan2(y1 - cy, x1 - cx))
        if bulge < 0:  # a DXF arc is always counter-clockwise
            first, last = last, first
        radius = math.hypot(x0 - cx, y0 - cy)
        layout.add_arc((cx, cy), radius, first, last, dxfattribs={"layer": layer})


def new(version: str = "R2010") -> Drawing:
    """Empty drawing, in mm, with this project's layers; fixed GUIDs and dates."""
    ezdxf.options.write_fixed_meta_data_for_testing = True
    logging.getLogger("ezdxf").setLevel(logging.ERROR)  # R12 and units: see `text_of`
    doc = ezdxf.new(version, units=4)
    doc.layers.add("CUT", color=1)
    doc.layers.add("START", color=3)
    return doc


# --- the parts ---------------------------------------------------------------------------------


def key_punch() -> Drawing:
    """Punch for key blanks, 40 x 8.5 mm: bow, shoulder and five bitting cuts of different depth."""
    doc = new()
    msp = doc.modelspace()
    depth = [1.2, 2.4, 0.6, 1.8, 3.0]
    corners = [(0, 0, 3.0), (40, 0, 0.3), (40, 1.6, 0.3), (38.2, 3.4, 0.6), (38.2, 6.6, 0.6)]
    # Bitting along the upper edge from tip to bow: flanks of 45 degrees, a flat of 0.8 mm.
    for i in range(4, -1, -1):
        x, d = 19.0 + 4.0 * i, depth[i] * 0.5
        corners += [(x + 0.4 + d, 6.6, 0.15), (x + 0.4, 6.6 - d, 0.2)]
        corners += [(x - 0.4, 6.6 - d, 0.2), (x - 0.4 - d, 6.6, 0.15)]
    corners += [(13, 6.6, 0.5), (13, 8.5, 0.8), (0, 8.5, 3.0)]
    add_segments(msp, rounded(corners), "CUT")
    msp.add_point((-3, 4.25), dxfattribs={"layer": "START"})
    return doc


def stator_36() -> Drawing:
    """Lamination, 84 mm: a bore of 50 mm with 36 half-closed slots, and four notches outside."""
    doc = new()
    msp = doc.modelspace()
    slots, bore, mouth, width, shoulder = 36, 25.0, 1.2, 2.6, 0.4
    a, w = mouth / 2, width / 2  # the bottom is a half circle of radius w
    neck = bore + 0.8  # the mouth is straight to here, then opens at 45 degrees
    wide = neck + (w - a)
    bottom = 34.0
    foot = math.sqrt(bore**2 - a**2)
    # The fillet where the 45 degree shoulder meets the side of the slot.
    back = shoulder * math.tan(math.pi / 8)
    low: list[Vertex] = [
        (foot, -a, 0.0),
        (neck, -a, 0.0),
        (wide - back * math.sqrt(0.5), -w + back * math.sqrt(0.5), math.tan(math.pi / 16)),
        (wide + back, -w, 0.0),
        (bottom, -w, 1.0),
    ]
    pitch = math.tau / slots
    high: list[Vertex] = [(bottom, w, 0.0), (low[3][0], w, low[2][2])]
    high += [(low[2][0], -low[2][1], 0.0), (neck, a, 0.0)]
    high += [(foot, a, math.tan((pitch - 2 * math.asin(a / bore)) / 4))]
    inner: list[Vertex] = []
    for i in range(slots):
        inner += turned(low + high, i * pitch)
    add_segments(msp, inner, "CUT")
    outside, notch = 42.0, 1.5
    # A half-round notch centred on the rim: its ends lie at this angle from its middle.
    half = 2 * math.asin(notch / 2 / outside)
    outer: list[Vertex] = []
    for i in range(4):
        middle = math.pi / 4 + i * math.pi / 2
        start, end = polar(outside, middle - half), polar(outside, middle + half)
        outer.append((*start, arc_bulge(start, end, polar(outside, middle), False)))
        outer.append((*end, math.tan((math.pi / 2 - 2 * half) / 4)))
    add_segments(msp, outer, "CUT")
    msp.add_point((0, 0), dxfattribs={"layer": "START"})
    msp.add_point((46, 0), dxfattribs={"layer": "START"})
    return doc


def gear_24() -> Drawing:
    """Gear m 2, z 24: involute flanks as one arc each, root fillets, rounded tips; keyed bore."""
    doc = new()
    msp = doc.modelspace()
    module, z, pressure = 2.0, 24, math.radians(20)
    pitch_r = module * z / 2
    base, tip, root = pitch_r * math.cos(pressure), pitch_r + module, pitch_r - 1.25 * module
    half = math.pi / (2 * z)  # half the tooth's angle at the pitch circle

    def flank_point(r: float) -> Point:
        """Upper flank of the tooth about the x axis at radius r."""
        at = math.acos(base / r)
        involute = math.tan(at) - at - (math.tan(pressure) - pressure)
        return polar(r, half - involute)

    centre, radius = circumcircle(flank_point(base + 0.05), flank_point(pitch_r), flank_point(tip))
    fillet, edge = 0.5, 0.2
    # Root fillet: outside the root circle and outside the flank's; tip rounding: inside both.
    low = circles_cross((0, 0), root + fillet, centre, radius + fillet)
    high = circles_cross((0, 0), tip - edge, centre, radius - edge)
    low_centre = max(low, key=lambda p: math.atan2(p[1], p[0]))
    high_centre = max(high, key=lambda p: math.atan2(p[1], p[0]))
    on_root = polar(root, math.atan2(low_centre[1], low_centre[0]))
    on_tip = polar(tip, math.atan2(high_centre[1], high_centre[0]))
    foot = towards(centre, low_centre, radius)
    head = towards(centre, high_centre, radius)

    upper = [on_tip, head, foot, on_root]
    lower = [(x, -y) for x, y in reversed(upper)]
    points = lower + upper
    fillet_b = arc_bulge(foot, on_root, low_centre, False)
    flank_b = arc_bulge(head, foot, centre, True)
    edge_b = arc_bulge(on_tip, head, high_centre, True)
    tip_b = math.tan(math.atan2(on_tip[1], on_tip[0]) / 2)
    root_b = math.tan((math.pi / z - math.atan2(on_root[1], on_root[0])) / 2)
    bulges = [fillet_b, flank_b, edge_b, tip_b, edge_b, flank_b, fillet_b, root_b]
    tooth = [(*p, b) for p, b in zip(points, bulges, strict=True)]
    outline: list[Vertex] = []
    for i in range(z):
        outline += turned(tooth, i * math.tau / z)
    add_segments(msp, outline, "CUT")

    # Bore of 16 mm with a keyway 5 mm wide, corners filleted 0.3 mm.
    add_segments(msp, keyed_bore(8.0, 2.5, 10.3, 0.3), "CUT")
    msp.add_point((0, 0), dxfattribs={"layer": "START"})
    return doc


def circumcircle(a: Point, b: Point, c: Point) -> tuple[Point, float]:
    """Circle through three points."""
    bx, by, cx, cy = b[0] - a[0], b[1] - a[1], c[0] - a[0], c[1] - a[1]
    d = 2 * (bx * cy - by * cx)
    x = (cy * (bx**2 + by**2) - by * (cx**2 + cy**2)) / d
    y = (bx * (cx**2 + cy**2) - cx * (bx**2 + by**2)) / d
    return (a[0] + x, a[1] + y), math.hypot(x, y)


def circles_cross(p: Point, r: float, q: Point, s: float) -> tuple[Point, Point]:
    """Both crossings of two circles."""
    d = math.dist(p, q)
    along = (d * d + r * r - s * s) / (2 * d)
    across = math.sqrt(r * r - along * along)
    ux, uy = (q[0] - p[0]) / d, (q[1] - p[1]) / d
    x, y = p[0] + along * ux, p[1] + along * uy
    return (x - across * uy, y + across * ux), (x + across * uy, y - across * ux)


def towards(centre: Point, through: Point, radius: float) -> Point:
    """Point of a circle on the ray from its centre through a point."""
    return polar(radius, math.atan2(through[1] - centre[1], through[0] - centre[0]), centre)


def plate() -> Drawing:
    """Plate 80 x 50 mm whose holes are blocks: turned, mirrored and arrayed; text and dimension."""
    doc = new()
    doc.layers.add("TEXT", color=7)
    doc.layers.add("DIM", color=4)
    msp = doc.modelspace()
    cut, start = {"layer": "CUT"}, {"layer": "START"}
    msp.add_lwpolyline(plate_outline(), format="xyb", close=True, dxfattribs=cut)

    hole = doc.blocks.new("HOLE-6", base_point=(0, 0))
    hole.add_circle((0, 0), 3, dxfattribs=cut)
    slot = doc.blocks.new("SLOT-14", base_point=(0, 0))
    ends = [(-5.0, -2.0, 0.0), (5.0, -2.0, 1.0), (5.0, 2.0, 0.0), (-5.0, 2.0, 1.0)]
    slot.add_lwpolyline(ends, format="xyb", close=True, dxfattribs=cut)
    # Not its own mirror image: a D with one bevelled corner.
    window = doc.blocks.new("WINDOW", base_point=(0, 0))
    window.add_lwpolyline(
        rounded([(-4, -5, 1), (3, -5, 1), (5, -3, 0.6), (5, 5, 2.5), (-4, 5, 0.5)]),
        format="xyb",
        close=True,
        dxfattribs=cut,
    )
    msp.add_blockref(
        "HOLE-6",
        (10, 10),
        dxfattribs={
            "layer": "CUT",
            "column_count": 3,
            "row_count": 2,
            "column_spacing": 30,
            "row_spacing": 30,
        },
    )
    msp.add_blockref("SLOT-14", (25, 25), dxfattribs={**cut, "rotation": 30})
    msp.add_blockref("WINDOW", (52, 25), dxfattribs={**cut, "xscale": 0.8, "yscale": 0.8})
    msp.add_blockref(
        "WINDOW",
        (66, 25),
        dxfattribs={**cut, "xscale": -0.8, "yscale": 0.8, "rotation": 15},
    )
    # Start holes: outside the plate, in the turned slot and in the window.
    for at in ((-4, 25), (25, 25), (52, 25)):
        msp.add_circle(at, 0.5, dxfattribs=start)

    msp.add_text("PLATE 80x50  T=12", height=2.5, dxfattribs={"layer": "TEXT"}).set_placement(
        (90, 45)
    )
    msp.add_text("1.2379  60 HRC", height=2.5, dxfattribs={"layer": "TEXT"}).set_placement((90, 40))
    msp.add_linear_dim(base=(0, -8), p1=(0, 0), p2=(80, 0), dxfattribs={"layer": "DIM"}).render()
    return doc


def plate_outline() -> list[Vertex]:
    """Rounded rectangle with a flat notch in its upper side."""
    corners = [(0, 0, 5), (80, 0, 5), (80, 50, 5), (50, 50, 2), (46, 46, 2), (34, 46, 2)]
    return rounded([*corners, (30, 50, 2), (0, 50, 5)])


def bracket_inch() -> Drawing:
    """Angle bracket 3 x 2 inch, R12: POLYLINE with bulges, two holes and a slot."""
    doc = new("R12")
    msp = doc.modelspace()
    cut = {"layer": "CUT"}

    def polyline(vertices: Sequence[Vertex]) -> None:
        msp.add_polyline2d(vertices, format="xyb", close=True, dxfattribs=cut)

    corners = [(0, 0, 0.125), (3, 0, 0.25), (3, 0.75, 0.25), (0.75, 0.75, 0.1875)]
    polyline(rounded([*corners, (0.75, 2, 0.25), (0, 2, 0.25)]))
    msp.add_circle((0.375, 1.5), 0.15625, dxfattribs=cut)
    msp.add_circle((0.375, 0.375), 0.125, dxfattribs=cut)
    ends = [(1.5, 0.25, 0.0), (2.5, 0.25, 1.0), (2.5, 0.5, 0.0), (1.5, 0.5, 1.0)]
    polyline(ends)
    msp.add_point((-0.125, 0.75), dxfattribs={"layer": "START"})
    return doc


def cam() -> Drawing:
    """Disc cam, 70 x 60 mm: one closed spline, with a keyed bore of lines and an arc."""
    doc = new()
    msp = doc.modelspace()
    # Lift of 10 mm, harmonic up and down, over a base circle of 30 mm; a periodic cubic whose
    # control points lie on the profile, three of them repeated.
    around, degree = 24, 3
    control = []
    for i in range(around + degree):
        angle = math.tau * (i % around) / around
        lift = 5.0 * (1 - math.cos(angle)) - 0.8 * (1 - math.cos(3 * angle))
        control.append((*polar(30.0 + lift, angle), 0.0))
    curve = msp.add_spline(degree=degree, dxfattribs={"layer": "CUT"})
    curve.control_points = control
    curve.knots = [float(k) for k in range(len(control) + degree + 1)]
    curve.dxf.flags = 3  # closed and periodic
    add_segments(msp, keyed_bore(6.0, 2.0, 7.8, 0.3), "CUT")
    msp.add_point((0, 0), dxfattribs={"layer": "START"})
    msp.add_point((34, 0), dxfattribs={"layer": "START"})
    return doc


def keyed_bore(bore: float, key: float, top: float, fillet: float) -> list[Vertex]:
    """Bore of a radius with a keyway: half its width, its top above the centre, its fillets."""
    side = math.sqrt(bore**2 - key**2)
    quarter = math.tan(math.pi / 8)
    start = math.atan2(side, -key)
    return [
        (-key, side, math.tan((math.tau - 2 * (start - math.pi / 2)) / 4)),
        (key, side, 0.0),
        (key, top - fillet, quarter),
        (key - fillet, top, 0.0),
        (-key + fillet, top, quarter),
        (-key, top - fillet, 0.0),
    ]


def cover() -> Drawing:
    """Cover, an ellipse of 90 x 50 mm: bolt holes, elliptic window, lens of two half ellipses."""
    doc = new()
    msp = doc.modelspace()
    cut = {"layer": "CUT"}
    msp.add_ellipse((0, 0), (45, 0), 25 / 45, dxfattribs=cut)
    msp.add_ellipse((0, 0), (0, 14), 0.6, dxfattribs=cut)
    for x in (-35, 35):
        msp.add_circle((x, 0), 3.2, dxfattribs=cut)
    for x in (-20, 20):
        msp.add_circle((x, 15), 2.1, dxfattribs=cut)
    # A lens between two elliptic arcs, below on the right: parameters run counter-clockwise.
    msp.add_ellipse((20, -13), (7, 0), 0.5, 0, math.pi, dxfattribs=cut)
    msp.add_ellipse((20, -13), (7, 0), 0.3, math.pi, math.tau, dxfattribs=cut)
    # The same drawing has one hole as programs for artists export it: four cubic pieces.
    k = 4 / 3 * (math.sqrt(2) - 1)
    for i in range(4):
        c, s = round(math.cos(i * math.pi / 2)), round(math.sin(i * math.pi / 2))
        leg = [(1.0, 0.0), (1.0, k), (k, 1.0), (0.0, 1.0)]
        points = [(-20 + 2.1 * (c * x - s * y), -15 + 2.1 * (s * x + c * y)) for x, y in leg]
        msp.add_open_spline(points, dxfattribs=cut)
    msp.add_point((-50, 0), dxfattribs={"layer": "START"})
    return doc


def damaged() -> str:
    """Latch plate, 40 x 30 mm, as an old exporter writes it: read with every repair reported.

    There is no HEADER (so no version, no units) and no table; the LWPOLYLINE and the SPLINE have
    no subclass markers, all entities one handle, and a stray end of section follows the first.
    """
    outline = rounded([(0, 0, 4), (40, 0, 4), (40, 30, 4), (24, 30, 2), (24, 22, 2), (0, 22, 4)])
    lines = ["999", "an old exporter", "0", "SECTION", "2", "ENTITIES"]
    lines += ["0", "LWPOLYLINE", "5", "43", "8", "CUT", "90", str(len(outline)), "70", "1"]
    for x, y, bulge in outline:
        lines += ["10", f"{x:.9f}", "20", f"{y:.9f}", "42", f"{bulge:.9f}"]
    lines += ["0", "CIRCLE", "5", "43", "8", "CUT", "10", "32.0", "20", "22.0", "40", "3.5"]
    # Coordinates as AutoCAD 2 wrote them: both x, then both y.
    slot = [((8.0, 8.0), (20.0, 8.0)), ((20.0, 13.0), (8.0, 13.0))]
    for (x0, y0), (x1, y1) in slot:
        lines += ["0", "LINE", "5", "43", "8", "CUT"]
        lines += ["10", f"{x0}", "11", f"{x1}", "20", f"{y0}", "21", f"{y1}"]
    lines += ["0", "ARC", "5", "43", "8", "CUT", "62", "BYLAYER", "10", "20.0", "20", "10.5"]
    lines += ["40", "2.5", "50", "270", "51", "90"]
    lines += ["0", "SPLINE", "5", "43", "8", "CUT", "70", "8", "71", "3", "72", "8", "73", "4"]
    lines += ["74", "0", *(line for u in "00001111" for line in ("40", u))]
    for x, y in ((8.0, 13.0), (4.5, 13.0), (4.5, 8.0), (8.0, 8.0)):
        lines += ["10", f"{x}", "20", f"{y}", "30", "0"]
    lines += ["0", "ENDSEC", "0", "ENDSEC", "0", "EOF"]
    return "".join(f"{line}\n" for line in lines)


SAMPLES = {
    "key-punch": key_punch,
    "stator-36": stator_36,
    "gear-24": gear_24,
    "plate": plate,
    "bracket-inch": bracket_inch,
    "cam": cam,
    "cover": cover,
    "damaged": damaged,
}


def text_of(doc: Drawing | str) -> str:
    """DXF text of a drawing, the same on every run."""
    if isinstance(doc, str):  # written by hand
        return doc
    stream = io.StringIO()
    doc.write(stream)
    text = stream.getvalue()
    if doc.dxfversion == "AC1009":
        # $INSUNITS is younger than R12, yet CAD programs write it there; ezdxf leaves it out.
        mark = "$ACADVER\n  1\nAC1009\n"
        assert mark in text
        text = text.replace(mark, f"{mark}  9\n$INSUNITS\n 70\n     1\n", 1)
    return text


def main(folder: Path) -> None:
    """Write every sample into a folder."""
    for name, draw in SAMPLES.items():
        (folder / f"{name}.dxf").write_text(text_of(draw()), encoding="utf-8", newline="\n")
        print(folder / f"{name}.dxf")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent)
