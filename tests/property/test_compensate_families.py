"""Every hard family of made contours: judged by Clipper2 and by distance, turned and reversed.

``benchmarks/prove_compensate.py`` runs the same over thousands of seeds.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oracle import check_offset, distance_to_contour, lengths, sample_contour, signed_area
from parts import FAMILIES, biarc, family_case, gear, random_part
from wedmcam.arithmetic import FLOAT64
from wedmcam.decimal8 import DECIMAL8
from wedmcam.ir.contour import Contour
from wedmcam.transforms import compensate as package
from wedmcam.transforms.compensate import compensate
from wedmcam.transforms.compensate.regular import regular_paths

#: Seeds that one version or another got wrong: curls that cross themselves, cusps, coincidences.
ONCE_WRONG = [
    *[("star", s) for s in (197, 233, 271, 1067)],
    *[("star-grid", 187), ("biarc-grid", 97), ("biarc-grid", 312), ("slot", 5), ("comb", 5)],
    *[("tangent-grid", s) for s in (53, 184, 316)],
    *[("tiny", s) for s in (20, 56, 58, 89, 93, 289, 1106, 2044, 2186)],
]


def loops_of(contour, distance, outward):
    shift = -distance if outward == (signed_area(contour) > 0) else distance
    result, problems = compensate([contour], [shift])
    assert not problems
    return [p.path for p in (*result.paths, *result.pockets)]


def complaints(name, seed):
    contour, distance, outward = family_case(name, seed)
    made = loops_of(contour, distance, outward)
    found = check_offset(contour, distance if outward else -distance, made)
    area, long = sum(map(signed_area, made)), sum(lengths(p).sum() for p in made)
    k = seed % len(contour.vertices)
    turned = Contour(np.roll(contour.vertices, -k), True)
    for image in (contour.reversed(), turned):
        again = loops_of(image, distance, outward)
        same = len(again) == len(made)
        same &= abs(abs(sum(map(signed_area, again))) - abs(area)) <= 0.02 * long + 1
        same &= abs(sum(lengths(p).sum() for p in again) - long) <= 1
        if not same:
            found.append("reversed or turned it is another path")
    return found


@pytest.mark.parametrize(("name", "seed"), ONCE_WRONG)
def test_once_wrong(name, seed):
    assert not complaints(name, seed)


@pytest.mark.parametrize("name", FAMILIES)
def test_families(name):
    for seed in range(6):
        assert not complaints(name, seed), seed


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10**6), st.booleans())
def test_random_parts_have_a_path_for_each_contour_and_no_interference(seed, die):
    part = random_part(seed)
    signs = [-1.0 if (k == 0) != die else 1.0 for k in range(len(part))]
    result, problems = compensate(part, [100.0 * s for s in signs])
    assert not problems
    assert not result.interference
    assert [p.outline for p in result.paths] == list(range(len(part)))
    for p in result.paths:
        points = sample_contour(p.path, 100)
        assert np.abs(distance_to_contour(points, part[p.outline]) - 100.0).max() < 0.01


@pytest.mark.parametrize("arithmetic", [FLOAT64, DECIMAL8], ids=lambda a: a.name)
@pytest.mark.parametrize("contour", [gear(96), biarc(100), gear(96).reversed()])
@pytest.mark.parametrize("shift", [-130.0, 130.0])
def test_the_fast_case_gives_the_general_path(contour, shift, arithmetic, monkeypatch):
    (fast,) = regular_paths([contour], [shift], arithmetic)
    monkeypatch.setattr(package, "regular_paths", lambda *_: None)
    slow_result, problems = compensate([contour], [shift], arithmetic=arithmetic)
    assert not problems
    (slow,) = (p.path for p in slow_result.paths)
    for name in ("x", "y", "cx", "cy"):
        used = slice(None) if name in "xy" else fast.vertices["turn"] != 0
        assert np.allclose(fast.vertices[name][used], slow.vertices[name][used], atol=1e-3)
    assert (fast.vertices["turn"] == slow.vertices["turn"]).all()
