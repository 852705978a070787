"""Drawings of any size for benchmarks: a plate of toothed holes, loose lines and arcs in any order.

Written as text, so that 100,000 entities cost a second.
"""

import math
import random

TEETH = 12
PER_HOLE = 4 * TEETH
PITCH_MM = 8.0


def hole(cx, cy, turn, outer=3.0, inner=2.2, fillet=0.35):
    """Lines and arcs of a hole with rounded teeth, as (kind, numbers) in mm and degrees."""
    points = []
    for k in range(2 * TEETH):
        r = outer if k % 2 == 0 else inner
        a = turn + math.pi * k / TEETH
        points.append((cx + r * math.cos(a), cy + r * math.sin(a)))
    out, cuts = [], []
    n = len(points)
    for k in range(n):
        (px, py), (x, y), (qx, qy) = points[k - 1], points[k], points[(k + 1) % n]
        a0 = math.atan2(y - py, x - px)
        a1 = math.atan2(qy - y, qx - x)
        bend = math.remainder(a1 - a0, 2 * math.pi)
        back = fillet * abs(math.tan(bend / 2))
        side = math.copysign(fillet, bend)
        sx, sy = x - back * math.cos(a0), y - back * math.sin(a0)
        ex, ey = x + back * math.cos(a1), y + back * math.sin(a1)
        mx, my = sx - side * math.sin(a0), sy + side * math.cos(a0)
        b0, b1 = math.atan2(sy - my, sx - mx), math.atan2(ey - my, ex - mx)
        if bend < 0:
            b0, b1 = b1, b0
        out.append(("ARC", (mx, my, fillet, math.degrees(b0) % 360, math.degrees(b1) % 360)))
        cuts.append((sx, sy, ex, ey))
    for k in range(n):
        out.append(("LINE", (*cuts[k][2:], *cuts[(k + 1) % n][:2])))
    return out


def drawing(entities, seed=1):
    """Return an R2000-like DXF (mm) of about so many entities, as bytes, and its holes."""
    rng = random.Random(seed)
    holes = max(1, entities // PER_HOLE)
    wide = math.ceil(math.sqrt(holes))
    parts = []
    for k in range(holes):
        turn = rng.uniform(0, math.pi)
        parts += hole(PITCH_MM * (k % wide), PITCH_MM * (k // wide), turn)
    rng.shuffle(parts)
    rows = ["0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n0\nENDSEC"]
    rows.append("0\nSECTION\n2\nENTITIES")
    for number, (kind, v) in enumerate(parts):
        head = f"0\n{kind}\n5\n{number + 256:X}\n8\n0\n"
        if kind == "LINE":
            rows.append(
                head + f"10\n{v[0]:.6f}\n20\n{v[1]:.6f}\n30\n0.0\n"
                f"11\n{v[2]:.6f}\n21\n{v[3]:.6f}\n31\n0.0"
            )
        else:
            rows.append(
                head + f"10\n{v[0]:.6f}\n20\n{v[1]:.6f}\n30\n0.0\n"
                f"40\n{v[2]:.6f}\n50\n{v[3]:.8f}\n51\n{v[4]:.8f}"
            )
    rows.append("0\nENDSEC\n0\nEOF\n")
    return "\n".join(rows).encode("ascii"), holes
