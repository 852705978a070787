"""Thread points and the side of the kept material on a sheet.

Many thread points lie near each other, so their numbers are placed after all crosses: beside their
own one, or farther away with a line to it. A number that finds no room is left out and counted; its
tool tip has it all the same.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from wedmcam.reports.picture.sheet import ADVANCE, INK, Point, Sheet, number, words

Floats = NDArray[np.float64]

#: Text size of a number, sheet units.
SIZE = 10.5
#: Half the size of a cross.
ARM = 7.0
#: Distances from a cross at which a number is tried, and in how many directions.
RINGS, DIRECTIONS = (22.0, 32.0, 44.0, 58.0, 74.0, 92.0), 16
#: So many thread points are drawn: more would cover each other.
MOST = 1000
#: Ticks on the kept side: distance and length, sheet units.
TICK_EVERY, TICK = 16.0, 6.0

_CROSS = (
    f'<g stroke="{INK}" stroke-width="1.1" fill="none"><circle cx="14" cy="6" r="3.6"/>'
    '<path d="M7 6H21M14 -1V13"/></g>'
)


def draw_threads(
    sheet: Sheet, threads: Sequence[tuple[float, float, str, str]], start: str = ""
) -> list[tuple[str, str]]:
    """Draw thread points with their names; return their legend.

    Args:
        sheet: on which lines are known already (`Sheet.ink`).
        threads: x, y (mm), name and tool tip of each.
        start: what is printed before the name of the first one, where the program starts.
    """
    left, threads = len(threads) - MOST, threads[:MOST]
    for x_mm, y_mm, _, tip in threads:
        x, y = sheet.at(x_mm, y_mm)
        sheet.symbol(
            f'<g stroke="{INK}" stroke-width="1.1" fill="none"><title>{words(tip)}</title>'
            f'<circle cx="{number(x, 2)}" cy="{number(y, 2)}" r="3.6" fill="#fff"/>'
            f'<path d="M{number(x - ARM, 2)} {number(y, 2)}h{number(2 * ARM)}'
            f'M{number(x, 2)} {number(y - ARM, 2)}v{number(2 * ARM)}"/></g>'
        )
        sheet.claim((x - ARM, y - ARM, x + ARM, y + ARM), force=True)
    bare = 0
    for k, (x_mm, y_mm, name, _) in enumerate(threads):
        bare += not _named(sheet, sheet.at(x_mm, y_mm), name, "" if k else start)
    if not threads:
        return []
    many = f", {bare} without room for a number" if bare else ""
    many += f", {left:,} more are not drawn" if left > 0 else ""
    return [(_CROSS, f"thread point{many}")]


def _named(sheet: Sheet, at: Point, name: str, before: str) -> bool:
    """Print the name of a thread point where there is room; return whether there was."""
    text = f"{before}  {name}" if before else name
    half = ADVANCE * SIZE * len(text) / 2
    spots = list(_spots(at, half))
    near, ring, every = range(4), range(4, 4 + 2 * DIRECTIONS), range(len(spots))
    for clear, some in ((True, near), (True, ring), (False, near), (True, every), (False, every)):
        for k in some:
            u, v = spots[k]
            box = sheet.label_box(u, v, text, SIZE)
            if not sheet.inside(box) or (clear and not sheet.clear(box)) or not sheet.claim(box):
                continue
            if k >= len(near):
                sheet.symbol(_leader(at, (u, v), half))
            if before:
                left = u - half + ADVANCE * SIZE * len(before) / 2
                sheet.text((left, v), before, size=SIZE, bold=True)
                u += half - ADVANCE * SIZE * len(name) / 2
            sheet.text((u, v), name, size=SIZE, bold=True)
            return True
    return False


def _spots(at: Point, half: float) -> Iterator[Point]:
    """Yield centres of a text about a cross: its four corners, then rings about it."""
    x, y = at
    for dy in (-9.0, 9.0):
        for dx in (-ARM - 2.5 - half, ARM + 2.5 + half):
            yield x + dx, y + dy
    for ring in RINGS:
        for k in range(DIRECTIONS):
            angle = 2 * math.pi * (k + 0.5) / DIRECTIONS
            yield x + (ring + half) * math.cos(angle), y - ring * math.sin(angle)


def _leader(at: Point, label: Point, half: float) -> str:
    """Return a thin line from a cross to its name."""
    end = (min(max(at[0], label[0] - half), label[0] + half), label[1])
    way = math.dist(at, end) or 1.0
    start = tuple(a + 4.5 * (b - a) / way for a, b in zip(at, end, strict=True))
    return (
        f'<path d="M{number(start[0], 2)} {number(start[1], 2)}L{number(end[0], 2)} '
        f'{number(end[1], 2)}" stroke="{INK}" stroke-width="0.6" fill="none"/>'
    )


def kept_ticks(outlines: Iterable[tuple[Floats, Floats, bool]], sheet: Sheet) -> str:
    """Return short lines on the kept side of closed outlines as one path, mm.

    Args:
        outlines: x and y of places along each, mm, denser than ticks; whether its inside is kept.
        sheet: says how long a unit is.
    """
    out = []
    reach = TICK / sheet.scale / math.sqrt(2)
    for x, y, inside in outlines:
        area = float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum())
        sign = 1.0 if inside == (area > 0) else -1.0
        dx, dy = np.roll(x, -1) - np.roll(x, 1), np.roll(y, -1) - np.roll(y, 1)
        step = np.hypot(x - np.roll(x, 1), y - np.roll(y, 1))
        every = min(TICK_EVERY / sheet.scale, float(step.sum()) / 4)
        at = np.flatnonzero(np.diff(np.floor(np.cumsum(step) / max(every, 1e-9)), prepend=-1) > 0)
        way = np.maximum(np.hypot(dx, dy), 1e-9)
        ux, uy = (dx / way)[at], (dy / way)[at]
        # Slanted backwards, so that they are no part of the outline.
        ex, ey = x[at] + reach * (-sign * uy - ux), y[at] + reach * (sign * ux - uy)
        out += [
            f"M{number(a)} {number(b)}L{number(c)} {number(d)}"
            for a, b, c, d in zip(*(v.tolist() for v in (x[at], y[at], ex, ey)), strict=True)
        ]
    return "".join(out)
