"""Profile errors of the DEM-15's arithmetic on samples: the tables of docs/dem15.md.

``python tests/vector_errors.py`` prints them; `test_dem15_page` demands that the page has them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from wedmcam import api
from wedmcam.ir.program import Kind

SAMPLES = Path(__file__).parents[1] / "samples"
SPEEDS = (127, 64, 32, 10, 3, 1)
PARTS = {"key-punch": SPEEDS, "gear-24": (127, 32, 10)}
PROFILES = ("dem15", "dem15-sines")


def compiled(name, speed, profile):
    feed = speed * 0.01575 + 1e-9
    data = (SAMPLES / f"{name}.dxf").read_bytes()
    made = api.compile(data, to="dem15", name=name, feed=feed, profile=profile, offset=0.1)
    assert made.ok
    return made


def cutting(made, speed):
    blocks = made.program.blocks[made.program.blocks["kind"] == Kind.LINE].copy()
    blocks["count"] = speed
    return blocks


def rows() -> Iterator[str]:
    """Yield the lines of the table."""
    yield (
        "| sample | speed | mm a minute | vectors cut for 2 mm a minute: beside, um | cut for the "
        "speed: vectors | beside, um | deviation, um | cutting, min |"
    )
    yield "|---|---|---|---|---|---|---|---|"
    for name, speeds in PARTS.items():
        fast = {p: compiled(name, 127, p) for p in PROFILES}
        for speed in speeds:
            cells = []
            for profile in PROFILES:
                stepping = fast[profile].machine.stepping
                uncut = 2.0 * stepping.sideways(cutting(fast[profile], speed)).max()
                made = compiled(name, speed, profile)
                own = cutting(made, speed)
                beside = 2.0 * stepping.sideways(own).max()
                minutes = stepping.seconds(own).sum() / 60.0
                cells.append(
                    (
                        f"{uncut:.1f}",
                        f"{len(own)}",
                        f"{beside:.1f}",
                        f"{made.verdict.max_deviation_um:.1f}",
                        f"{minutes:.0f}",
                    )
                )
            both = [" / ".join(pair) for pair in zip(*cells, strict=True)]
            yield f"| {name} | {speed} | {speed * 0.01575:.3f} | " + " | ".join(both) + " |"


def directions() -> Iterator[str]:
    """Yield the lines of the table of directions."""
    from wedmcam.controllers.eindhoven.arithmetic import poscal, sine_speeds

    a, b = (v.ravel() for v in np.meshgrid(np.arange(256), np.arange(256)))
    fits = (a * a + b * b <= 65_535) & (a + b > 0)
    a, b = a[fits], b[fits]
    yield (
        "| speed | direction off, degrees | speed of the path / wanted | 2 um beside by direction, "
        "um |"
    )
    yield "|---|---|---|---|"
    for speed in SPEEDS:
        cells = []
        for routine in (poscal, sine_speeds):
            got = routine(a, b, np.full(len(a), speed))
            off = np.abs(np.arctan2(got.y, got.x) - np.arctan2(b, a)).max()
            rate = np.hypot(got.x, got.y) / (speed * got.scale)
            least, most = rate.min() - 5e-4, rate.max() + 5e-4
            cells.append(
                (
                    f"{np.degrees(off):.2f}",
                    f"{least:.2f} to {most:.2f}",
                    f"{2.0 / np.sin(off):.0f}",
                )
            )
        yield f"| {speed} | " + " | ".join(" / ".join(p) for p in zip(*cells, strict=True)) + " |"


if __name__ == "__main__":
    print("\n".join([*directions(), "", *rows()]))
