"""Pictures of point-by-point comparison for docs/zd065.md: what is exact, the stair, the pixels.

The steps are those of ``step_tables.py``. ``benchmarks/pages.py`` writes docs/figures.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

from made_parts import filled
from step_tables import (
    ARC,
    BESIDE,
    LINE,
    PAGE,
    PARTS,
    RETURN,
    Block,
    Place,
    circle_steps,
    opposite,
)

from wedmcam.controllers.pointwise import counts
from wedmcam.ir.program import Axis

FIGURES = PAGE.parent / "figures"

#: Units of the picture a um.
UM = 36
INK, PIXEL, COUNTED, EXACT, STAIR, OTHER = (
    "#24303c", "#e3eaf2", "#bcd7f5", "#c2410c", "#1d4ed8", "#b91c1c",
)  # fmt: skip


class Sheet:
    """A picture: pixels of 1 um, y upwards."""

    def __init__(self, places: Sequence[Place], um: int = UM) -> None:
        xs, ys = zip(*places, strict=True)
        self.um, self.left, self.high = um, min(xs) - 1, max(ys) + 1
        self.width, self.height = max(xs) + 1 - self.left, self.high - min(ys) + 1
        self.lines: list[str] = []

    def at(self, place: tuple[float, float]) -> tuple[str, str]:
        return (f"{(place[0] - self.left) * self.um:g}", f"{(self.high - place[1]) * self.um:g}")

    def grid(self) -> None:
        u, w, h = self.um, self.width * self.um, self.height * self.um
        d = "".join(f"M{k * u} 0V{h}" for k in range(self.width + 1))
        d += "".join(f"M0 {k * u}H{w}" for k in range(self.height + 1))
        self.lines.append(f'<path d="{d}" stroke="#d4dae1" stroke-width="0.7"/>')

    def pixels(self, places: Sequence[Place], colour: str) -> None:
        for place in dict.fromkeys(places):
            x, y = self.at((place[0] - 0.44, place[1] + 0.44))
            size = f'width="{0.88 * self.um:g}" height="{0.88 * self.um:g}" rx="3"'
            self.lines.append(f'<rect x="{x}" y="{y}" {size} fill="{colour}"/>')

    def way(
        self,
        places: Sequence[tuple[float, float]],
        colour: str,
        width: float = 2,
        dashes: str = "none",
    ) -> None:
        d = "L".join(" ".join(self.at(p)) for p in places)
        line = f'stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}"'
        self.lines.append(f'<path d="M{d}" fill="none" {line}/>')

    def circle(self, centre: Place, radius: float) -> None:
        x, y = self.at(centre)
        line = f'fill="none" stroke="{EXACT}" stroke-width="1.5"'
        self.lines.append(f'<circle cx="{x}" cy="{y}" r="{radius * self.um:.2f}" {line}/>')

    def numbers(self, places: Sequence[Place]) -> None:
        seen: set[Place] = set()
        for n, place in enumerate(places):
            if place in seen:
                continue
            seen.add(place)
            x, y = self.at((place[0] + 0.4, place[1] - 0.38))
            self.lines.append(f'<text x="{x}" y="{y}" text-anchor="end">{n}</text>')

    def svg(self, title: str) -> str:
        w, h = self.width * self.um, self.height * self.um
        font = f'font-family="sans-serif" font-size="{self.um * 0.3:g}" fill="{INK}"'
        size = f'viewBox="0 0 {w} {h}" width="{w}" height="{h}"'
        lines = [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} {font}>',
            f"<title>{title}</title>",
            f'<rect width="{w}" height="{h}" fill="#fff"/>',
            *self.lines,
            "</svg>",
        ]
        return "\n".join(lines) + "\n"


def line_figure(block: Block = LINE) -> str:
    places = block.places()
    sheet = Sheet(places)
    sheet.grid()
    sheet.pixels(places, PIXEL)
    sheet.pixels([r.place for r in block.rows() if r.counted], COUNTED)
    sheet.way([(0, 0), (block.x, block.y)], EXACT, 1.5)
    sheet.way(places, STAIR)
    sheet.numbers(places)
    return sheet.svg(f"Line to ({block.x}, {block.y}): exact line, stair, numbers of the steps")


def arc_figure(block: Block) -> str:
    places = block.places()
    sheet = Sheet([*places, (0, 0)])
    sheet.grid()
    sheet.pixels(places, PIXEL)
    sheet.pixels([r.place for r in block.rows() if r.counted], COUNTED)
    sheet.way([(sheet.left, 0), (sheet.left + sheet.width, 0)], "#94a3b8", 1)
    sheet.way([(0, sheet.high), (0, sheet.high - sheet.height)], "#94a3b8", 1)
    sheet.circle((0, 0), math.hypot(block.x, block.y))
    sheet.way(places, STAIR)
    sheet.numbers(places)
    name = block.name(block.start)
    return sheet.svg(f"{name} from {block.start}: circle, stair, numbers of the steps")


def square_figure(radius: int = 10) -> str:
    """Return a full circle with its square: the steps that count are thick."""
    places, along_y = circle_steps(radius)
    path = [(int(x), int(y)) for x, y in places]
    sheet = Sheet(path, 24)
    sheet.grid()
    side = radius / math.sqrt(2)
    corners = [(side, side), (-side, side), (-side, -side), (side, -side), (side, side)]
    sheet.way(corners, INK, 1.5, "6 4")
    sheet.way([(-radius, -radius), (radius, radius)], "#94a3b8", 1)
    sheet.way([(-radius, radius), (radius, -radius)], "#94a3b8", 1)
    sheet.circle((0, 0), radius)
    sheet.way(path, "#93b4e8", 1.5)
    for (a, b), on_y in zip(pairwise(path), along_y, strict=True):
        if counts(Axis.SQUARE, Axis.Y if on_y else Axis.X, *a):
            sheet.way([a, b], STAIR, 4)
    return sheet.svg(
        f"Full circle of R = {radius} um with its inscribed square: thick steps count in J"
    )


def back_figure(block: Block = RETURN) -> str:
    places = block.places()
    other = opposite(places, block.turn)
    sheet = Sheet([*places, *other])
    sheet.grid()
    sheet.pixels(places, PIXEL)
    sheet.pixels([p for p in other if p not in places], "#fbd5d5")
    sheet.circle((0, 0), math.hypot(block.x, block.y))
    sheet.way(places, STAIR, 2.5)
    sheet.way([(x + 0.06, y + 0.06) for x, y in other], OTHER, 2, "5 3")
    sheet.numbers(places)
    return sheet.svg("A cut stair, and (dashed) the opposite sense with places that were not cut")


#: Name of a picture -> what draws it.
PICTURES: dict[str, Callable[[], str]] = {
    "line-6-4.svg": line_figure,
    "arc-from-4-0.svg": lambda: arc_figure(ARC),
    "arc-beside-axis.svg": lambda: arc_figure(BESIDE),
    "square.svg": square_figure,
    "back.svg": back_figure,
}


def made() -> dict[Path, str]:
    """Return path -> text of the page and its pictures."""
    pictures = {FIGURES / name: draw() for name, draw in PICTURES.items()}
    return {PAGE: filled(PAGE.read_text("utf-8"), PARTS), **pictures}
