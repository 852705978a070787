"""Offsets: arcs kept against polygons, at equal accuracy; and the polygon route to a program.

shapely.buffer and pyclipr know no arcs: contours go in as chords and come out as chords. At equal
accuracy their chords have a sagitta of ``SAGITTA`` um on both sides. The polygon route is what one
writes in forty lines: flatten with ezdxf, offset with shapely, emit the chords as 3B lines; its
error is measured by our own judge's ruler against the exact path.

Run: python benchmarks/bench_offsets.py [--json] [--most 1000]
"""

import argparse
import io
import json
import sys
import time
from pathlib import Path

import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
sys.path.insert(0, str(Path(__file__).parent))

from stage_drawings import drawing

import parts
from oracle import chords
from wedmcam import api
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.ir.program import BLOCK, Axis
from wedmcam.judge.route import of_contours
from wedmcam.judge.segments import nearest
from wedmcam.transforms.compensate import compensate

OFFSET_UM = 100.0
#: Chords lie this far from their arcs, um: half of what the judge allows a path is spent already.
SAGITTA = 0.5


def best(function, rounds=5):
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return min(times)


def quarter_segments(radius):
    """Return shapely's segments a quarter circle for the sagitta at this radius."""
    return max(2, int(np.ceil(np.pi / 4 / np.arccos(1 - min(SAGITTA / radius, 0.9)))))


def offsets(most):
    """Return ms and vertices of three ways to offset made parts outwards."""
    try:
        import pyclipr
    except ImportError:
        pyclipr = None
    out = []
    for name, make in (("gear", parts.gear), ("stator", parts.stator), ("biarc", parts.biarc)):
        for size in (96, 1000, 10_000):
            if size > most:
                continue
            contour = make(size)
            result, problems = compensate([contour], [OFFSET_UM])
            ring = chords(contour, SAGITTA)
            polygon = shapely.Polygon(ring)
            quads = quarter_segments(OFFSET_UM)
            buffered = polygon.buffer(OFFSET_UM, quad_segs=quads)
            row = {
                "part": f"{name} {len(contour.vertices)}",
                "ours_ms": 1000 * best(lambda c=contour: compensate([c], [OFFSET_UM])),
                "ours_vertices": sum(len(p.path.vertices) for p in result.paths),
                "resolved": not problems,
                "chords": len(ring),
                "shapely_ms": 1000
                * best(lambda p=polygon, q=quads: p.buffer(OFFSET_UM, quad_segs=q)),
                "shapely_vertices": int(shapely.get_num_coordinates(buffered)),
            }
            if pyclipr is not None:

                def clipped(ring=ring):
                    tool = pyclipr.ClipperOffset()
                    tool.scaleFactor = 1000  # its integers: nanometres
                    tool.arcTolerance = SAGITTA * tool.scaleFactor
                    tool.addPath(ring, pyclipr.JoinType.Round, pyclipr.EndType.Polygon)
                    return tool.execute(OFFSET_UM)

                row["pyclipr_ms"] = 1000 * best(clipped)
                row["pyclipr_vertices"] = sum(len(p) for p in clipped())
            out.append(row)
    return out


def polygon_route(data, sagitta_um):
    """Return 3B-like line blocks and their start: flatten, polygonize, offset, round, emit."""
    import ezdxf
    from ezdxf import path

    document = ezdxf.read(io.StringIO(data.decode("ascii")))
    lines = []
    for entity in document.modelspace():
        points = path.make_path(entity).flattening(sagitta_um / 1000)
        points = 1000 * np.array([(p.x, p.y) for p in points])
        lines.append(shapely.LineString(np.round(points, 2)))
    blocks = []
    for hole in shapely.get_parts(shapely.polygonize(lines)):
        # The material is round the holes as well as within the outer contours: this benchmark has
        # contours beside each other, so all are outer ones.
        quads = quarter_segments(OFFSET_UM)
        ring = np.round(shapely.get_coordinates(hole.buffer(OFFSET_UM, quad_segs=quads).exterior))
        steps = np.diff(ring, axis=0).astype(int)
        steps = steps[steps.any(axis=1)]
        b = np.zeros(len(steps), BLOCK)
        b["x"], b["y"] = steps.T
        b["axis"] = np.where(np.abs(b["x"]) > np.abs(b["y"]), Axis.X, Axis.Y)
        b["count"] = np.maximum(np.abs(b["x"]), np.abs(b["y"]))
        blocks.append((ring[0], b))
    return blocks


def route_error(blocks, plan):
    """Return the largest distance of stepped places from the exact wire paths, um."""
    exact, _ = of_contours([c.path for c in plan.cuts])
    worst = 0.0
    for start, b in blocks[:4]:  # some contours tell
        at, _ = MIRROR.trace(b)
        d, _ = nearest(exact, at[::3, 0] + start[0], at[::3, 1] + start[1], 100.0)
        worst = max(worst, float(d.max()))
    return worst


def routes(most):
    """Return error, blocks and time of both routes on drawings of some sizes."""
    out = []
    for size in (1000, 10_000):
        if size > most:
            continue
        data, _ = drawing(size)
        api.compile(drawing(200)[0], offset=0.1)
        start = time.perf_counter()
        made = api.compile(data, offset=0.1)
        ours = time.perf_counter() - start
        assert made.ok
        row = {
            "entities": size,
            "ours_ms": 1000 * ours,
            "ours_blocks": made.verdict.blocks,
            "ours_error_um": round(made.verdict.max_deviation_um, 2),
            "polygon": [],
        }
        for sagitta in (SAGITTA, 5.0):
            start = time.perf_counter()
            blocks = polygon_route(data, sagitta)
            spent = time.perf_counter() - start
            row["polygon"].append(
                {
                    "sagitta_um": sagitta,
                    "ms": 1000 * spent,
                    "blocks": sum(len(b) for _, b in blocks),
                    "error_um": round(route_error(blocks, made.plan), 2),
                }
            )
        out.append(row)
    return out


def offset_table(found):
    """Yield the lines of a Markdown table."""
    yield (
        "| part, vertices | ours | shapely.buffer | pyclipr | ratio to shapely | vertices: ours, "
        "shapely, pyclipr |"
    )
    yield "|---" * 6 + "|"
    for r in found:
        clip = f"{r['pyclipr_ms']:.2f} ms" if "pyclipr_ms" in r else "-"
        yield (
            f"| {r['part']} | {r['ours_ms']:.2f} ms | {r['shapely_ms']:.2f} ms | {clip} | "
            f"{r['ours_ms'] / r['shapely_ms']:.2f} | {r['ours_vertices']}, "
            f"{r['shapely_vertices']}, {r.get('pyclipr_vertices', '-')} |"
        )


def route_table(found):
    """Yield the lines of a Markdown table."""
    yield "| entities | route | time | blocks | largest error |"
    yield "|---|---|---|---|---|"
    for r in found:
        yield (
            f"| {r['entities']} | wedmcam, proven | {r['ours_ms']:.0f} ms | {r['ours_blocks']} | "
            f"{r['ours_error_um']} um |"
        )
        for p in r["polygon"]:
            yield (
                f"| {r['entities']} | polygons, sagitta {p['sagitta_um']} um, unproven | "
                f"{p['ms']:.0f} ms | {p['blocks']} | {p['error_um']} um |"
            )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--most", type=int, default=1000)
    asked = parser.parse_args()
    found, ways = offsets(asked.most), routes(asked.most)
    if asked.json:
        print(json.dumps({"offsets": found, "routes": ways}, indent=1))
    else:
        print("\n".join([*offset_table(found), "", *route_table(ways)]))


if __name__ == "__main__":
    main()
