"""How often compensation is right on the hard families of made contours, and by how much it errs.

Run: python benchmarks/prove_compensate.py [--seeds 400] [--first 0] [--family NAME] [--turned].
Each case is judged by `oracle.check_offset` (area and loops against Clipper2, every sampled point's
distance). ``--turned`` runs each contour reversed too, and from another start vertex, and asks for
the same number of loops, area and length.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from oracle import (
    check_offset,
    distance_to_contour,
    lengths,
    negligible_area,
    sample_contour,
    signed_area,
)
from parts import FAMILIES, family_case
from wedmcam.ir.contour import Contour
from wedmcam.transforms.compensate import compensate


def offset(contour, distance, outward):
    """Return the paths and whether they could be resolved, offset outward or inward."""
    ccw = signed_area(contour) > 0
    result, problems = compensate([contour], [-distance if outward == ccw else distance])
    return [p.path for p in (*result.paths, *result.pockets)], not problems


def figures(paths):
    """Return how many loops there are that have a width, their area and their length."""
    areas, long = [signed_area(p) for p in paths], [lengths(p).sum() for p in paths]
    wide = [abs(a) > negligible_area(n) for a, n in zip(areas, long, strict=True)]
    return sum(wide), abs(sum(areas)), float(sum(long))


def turned(contour, k):
    """Return the contour from start vertex k on."""
    return Contour(np.roll(contour.vertices, -k), True, contour.sources)


def differences(contour, distance, outward, paths, seed):
    """Return complaints where the reversed or the turned contour gives another path."""
    found = []
    loops, area, length = figures(paths)
    k = int(np.random.default_rng(seed).integers(len(contour.vertices)))
    for name, other in (("reversed", contour.reversed()), ("turned", turned(contour, k))):
        again, resolved = offset(other, distance, outward)
        if not resolved:
            found.append(f"{name}: unresolved")
            continue
        loops2, area2, length2 = figures(again)
        if loops2 != loops or abs(area2 - area) > 0.02 * length + 1 or abs(length2 - length) > 1:
            found.append(
                f"{name}: {loops2} {area2:.3f} {length2:.3f}, {loops} {area:.3f} {length:.3f}"
            )
    return found


def judge(name, seed, both):
    """Return complaints, whether it was resolved, and the largest distance error, um."""
    contour, distance, outward = family_case(name, seed)
    paths, resolved = offset(contour, distance, outward)
    if not resolved:
        return ["unresolved"], False, 0.0, 0.0
    start = time.perf_counter()
    offset(contour, distance, outward)
    spent = time.perf_counter() - start
    wrong = check_offset(contour, distance if outward else -distance, paths)
    worst = 0.0
    for p in paths:
        error = np.abs(distance_to_contour(sample_contour(p, 400), contour) - distance)
        worst = max(worst, float(error.max()))
    if both:
        wrong += differences(contour, distance, outward, paths, seed)
    return wrong, True, worst, spent


def main():
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seeds", type=int, default=400)
    asked.add_argument("--first", type=int, default=0)
    asked.add_argument("--family", action="append", choices=FAMILIES)
    asked.add_argument("--turned", action="store_true")
    asked.add_argument("--list", type=int, default=3, help="complaints printed a family")
    options = asked.parse_args()
    total = np.zeros(3, int)
    print(f"{'family':14}{'cases':>7}{'wrong':>7}{'unresolved':>12}{'error um':>10}{'ms':>8}")
    for name in options.family or FAMILIES:
        count, worst, spent, said = np.zeros(3, int), 0.0, 0.0, []
        for seed in range(options.first, options.first + options.seeds):
            wrong, resolved, error, seconds = judge(name, seed, options.turned)
            count += (1, bool(wrong) and resolved, not resolved)
            worst, spent = max(worst, error), spent + seconds
            said += [f"    {name} {seed}: {text}" for text in wrong]
        total += count
        print(
            f"{name:14}{count[0]:7}{count[1]:7}{count[2]:12}{worst:10.2g}"
            f"{1e3 * spent / count[0]:8.2f}",
            *said[: options.list],
            sep="\n",
            flush=True,
        )
    print(f"{'all':14}{total[0]:7}{total[1]:7}{total[2]:12}")
    return int(total[1] + total[2] > 0)


if __name__ == "__main__":
    sys.exit(main())
