"""What 8-digit decimals cost a compile: the same parts in both arithmetics, side by side.

Medians of interleaved runs, imports left out. Three parts of 1,000 segments: smooth (every joint
tangent), sharp (a transition arc or a crossing at every corner), and sharp with rounded corners.

Run: python benchmarks/bench_arithmetic.py [--segments 1000] [--json]
"""

import argparse
import gc
import json
import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import numpy as np
from stage_drawings import drawing

import parts
from wedmcam import api

ROUNDS = 9


def cases(segments):
    """Yield (name, drawing, options)."""
    yield "smooth", drawing(segments)[0], {"offset": 0.1}
    angle = np.arange(segments) * 2 * np.pi / segments
    radius = np.where(np.arange(segments) % 2, 298_000.0, 300_000.0)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    star = parts.dxf_bytes((parts.contour_of_bulges(points, np.zeros(segments)),))
    yield "sharp", star, {"offset": 0.1}
    yield "sharp, --corner 0.15", star, {"offset": 0.1, "corner": 0.15}


def rows(segments=1000):
    """Return a row for each part."""
    out = []
    for name, data, options in cases(segments):
        times = {"float64": [], "decimal8": []}
        gc.disable()
        for k in range(ROUNDS + 1):
            for arithmetic, spent in times.items():
                start = time.perf_counter()
                made = api.compile(data, arithmetic=arithmetic, **options)
                if k:
                    spent.append(time.perf_counter() - start)
                assert made.ok, [d.message for d in made.findings][:3]
        gc.enable()
        a, b = (1000 * statistics.median(times[k]) for k in ("float64", "decimal8"))
        n = sum(len(c) for c in made.drawn.contours)
        out.append({"part": name, "segments": n, "float64_ms": a, "decimal8_ms": b, "ratio": b / a})
    return out


def table(found):
    """Yield the lines of a Markdown table."""
    yield "| part | segments | float64 | decimal8 | ratio |"
    yield "|---|---|---|---|---|"
    for r in found:
        yield (
            f"| {r['part']} | {r['segments']} | {r['float64_ms']:.0f} ms | "
            f"{r['decimal8_ms']:.0f} ms | {r['ratio']:.2f} |"
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--segments", type=int, default=1000)
    parser.add_argument("--json", action="store_true")
    asked = parser.parse_args()
    found = rows(asked.segments)
    print(json.dumps(found, indent=1) if asked.json else "\n".join(table(found)))


if __name__ == "__main__":
    main()
