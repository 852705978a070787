"""500 random parts through the whole compiler: the figures that every program must reach."""

import pytest

import parts
import wedmcam

CHUNK = 25


@pytest.mark.parametrize("first", range(0, 500, CHUNK))
def test_random_parts(first):
    for seed in range(first, first + CHUNK):
        contours = parts.random_part(seed)
        drawing = parts.dxf_bytes(contours, shuffle=seed, polylines=bool(seed % 2))
        made = wedmcam.compile(
            drawing,
            to=("3b", "compact")[seed // 4 % 2],
            offset=0.1,
            side=("part", "die")[seed // 2 % 2],
        )
        assert made.ok, (seed, [d.message for d in made.findings if d.severity == 2])
        v = made.verdict
        assert v.contours == len(contours), seed
        assert v.max_deviation_um <= 1.6, seed
        assert v.gouge_um <= 1.6, seed
        assert v.closure_um == 0, seed


def test_shuffled_and_reversed_entities_give_the_same_bytes():
    for seed in range(12):
        contours = parts.random_part(seed)
        programs = {
            wedmcam.compile(parts.dxf_bytes(contours, shuffle=s), offset=0.1).data
            for s in (None, 1, 2, 3)
        }
        assert len(programs) == 1, seed
