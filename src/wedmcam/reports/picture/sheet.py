"""The sheet a picture is drawn on: A4, a grid in mm, dimensions, labels that keep apart, a legend.

What is drawn on it is decided by ``svg``. Geometry goes into one group whose coordinates are the
drawing's own, mm with y up, so that a number in the file is a number on the drawing; text and
symbols stand in sheet units (4 a mm of paper, y down), so that they stay legible at any scale.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from xml.sax.saxutils import escape

from wedmcam.diag import visible

#: Sheet units: A4 at 4 units a mm of paper.
LONG, SHORT = 1188.0, 840.0
MARGIN = 28.0
#: Between the frame and the extents of what is drawn: room for dimensions and labels.
PAD = 62.0
#: Average advance of a sans-serif digit and letter, as a part of the font size.
ADVANCE = 0.58

#: Side of the squares in which the sheet remembers lines, units.
INK_CELL = 2.0

Point = tuple[float, float]
Box = tuple[float, float, float, float]

INK = "#1f2933"
#: The library that draws PNG does not know what a bare sans-serif is: fonts are named.
FONT = "Helvetica, Arial, DejaVu Sans, sans-serif"
GREY = "#7b8794"


def number(value: float, decimals: int = 4) -> str:
    """Return a decimal number without trailing zeros, and never -0.

    >>> number(-0.00001), number(12.340), number(-3)
    ('0', '12.34', '-3')
    """
    text = f"{value:.{decimals}f}"
    if "." in text:
        text = text.rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def words(text: str) -> str:
    r"""Return text as it may stand in XML: escaped, what is not visible too.

    >>> words('a<b' + chr(7))
    'a&lt;b\\x07'
    """
    return escape(visible(text), {'"': "&quot;"})


def nice(least: float) -> float:
    """Return the smallest of 1, 2, 5 x 10^k that is at least ``least`` > 0.

    >>> nice(0.3), nice(17), nice(5)
    (0.5, 20.0, 5.0)
    """
    decade = 10.0 ** math.floor(math.log10(least))
    return next(m * decade for m in (1.0, 2.0, 5.0, 10.0) if m * decade >= least * (1 - 1e-9))


@dataclass(frozen=True, slots=True)
class Caption:
    """What the title block says.

    Attributes:
        title: printed large; the file's name.
        facts: printed in their order, name -> value.
    """

    title: str = ""
    facts: Mapping[str, str] = field(default_factory=dict)


#: A title block without words.
NO_CAPTION = Caption()


class Sheet:
    """One page: collects elements back to front and prints them.

    Attributes:
        scale: sheet units a mm of the drawing.
        width: of the sheet, units.
        height: of the sheet, units.
        view: what the frame shows of the drawing (x0, y0, x1, y1), mm.
    """

    def __init__(self, extents: Box, title: str, facts: int) -> None:
        """Choose orientation and scale.

        Args:
            extents: of what is drawn, (x0, y0, x1, y1), mm.
            title: printed large in the title block.
            facts: how many the title block must hold.
        """
        x0, y0, x1, y1 = extents
        w, h = max(x1 - x0, 1e-3), max(y1 - y0, 1e-3)
        upright = h > 1.15 * w
        self.width, self.height = (SHORT, LONG) if upright else (LONG, SHORT)
        self.title = title
        self._columns = 2 if upright else 3
        self._rows = max(4, math.ceil(facts / self._columns))
        self._band = 52.0 + 15.0 * self._rows
        self._frame = (
            MARGIN + 16,
            MARGIN,
            self.width - MARGIN,
            self.height - MARGIN - self._band - 16,
        )
        left, top, right, bottom = self._frame
        self.scale = min((right - left - 2 * PAD) / w, (bottom - top - 2 * PAD) / h)
        middle = ((left + right) / 2, (top + bottom) / 2)
        self._tx = middle[0] - self.scale * (x0 + x1) / 2
        self._ty = middle[1] + self.scale * (y0 + y1) / 2
        s = self.scale
        self.view = (
            (left - self._tx) / s,
            (self._ty - bottom) / s,
            (right - self._tx) / s,
            (self._ty - top) / s,
        )
        self._geometry: list[str] = []
        self._symbols: list[str] = []
        self._labels: list[str] = []
        self._defs: list[str] = []
        self._taken: dict[tuple[int, int], list[Box]] = {}
        self._inked: set[tuple[int, int]] = set()

    # --- frames --------------------------------------------------------------------------------

    def at(self, x_mm: float, y_mm: float) -> Point:
        """Return where a point of the drawing lies on the sheet."""
        return self._tx + self.scale * x_mm, self._ty - self.scale * y_mm

    def mm(self, units: float) -> str:
        """Return a length on the sheet as a number of the geometry group."""
        return number(units / self.scale, 6)

    # --- collecting ----------------------------------------------------------------------------

    def define(self, element: str) -> None:
        """Add a definition, such as a pattern."""
        self._defs.append(element)

    def draw(self, *elements: str) -> None:
        """Add elements in drawing coordinates (mm, y up)."""
        self._geometry += elements

    def symbol(self, *elements: str) -> None:
        """Add elements in sheet coordinates, above the geometry."""
        self._symbols += elements

    def text(
        self,
        at: Point,
        content: str,
        *,
        size: float = 10.0,
        colour: str = INK,
        anchor: str = "middle",
        bold: bool = False,
        turn: float = 0.0,
        halo: bool = True,
    ) -> None:
        """Add a line of text whose middle height is at ``at``; ``halo`` keeps lines off it."""
        x, y = at
        attributes = f'x="{number(x, 2)}" y="{number(y + 0.36 * size, 2)}"'
        attributes += f' font-size="{number(size)}" fill="{colour}" text-anchor="{anchor}"'
        if bold:
            attributes += ' font-weight="bold"'
        if halo:
            attributes += ' class="halo"'
        if turn:
            attributes += f' transform="rotate({number(turn)} {number(x, 2)} {number(y, 2)})"'
        self._labels.append(f"<text {attributes}>{words(content)}</text>")

    def claim(self, box: Box, force: bool = False) -> bool:
        """Take a box on the sheet if it is free, or by force; return whether it was taken."""
        cell = 40.0
        columns = range(int(box[0] // cell), int(box[2] // cell) + 1)
        rows = range(int(box[1] // cell), int(box[3] // cell) + 1)
        cells = [(i, j) for i in columns for j in rows]
        free = not any(_overlap(box, other) for c in cells for other in self._taken.get(c, ()))
        if free or force:
            for c in cells:
                self._taken.setdefault(c, []).append(box)
        return free or force

    def ink(self, places: Iterable[Point]) -> None:
        """Remember where lines run on the sheet, so that `clear` can keep labels off them."""
        self._inked.update((int(x // INK_CELL), int(y // INK_CELL)) for x, y in places)

    def clear(self, box: Box) -> bool:
        """Return whether no line that `ink` knows of runs through a box."""
        columns = range(int(box[0] // INK_CELL), int(box[2] // INK_CELL) + 1)
        rows = range(int(box[1] // INK_CELL), int(box[3] // INK_CELL) + 1)
        return not any((i, j) in self._inked for i in columns for j in rows)

    def label_box(self, x: float, y: float, content: str, size: float) -> Box:
        """Return the box of a text centred at (x, y), with a little air."""
        half = ADVANCE * size * len(content) / 2 + 1.5
        return x - half, y - size / 2 - 0.5, x + half, y + size / 2 + 0.5

    def inside(self, box: Box) -> bool:
        """Return whether a box lies within the frame."""
        left, top, right, bottom = self._frame
        return box[0] > left and box[1] > top and box[2] < right and box[3] < bottom

    # --- furniture -----------------------------------------------------------------------------

    def dimension(self, extents: Box, clear_of: Box) -> None:
        """Add width and height of ``extents`` (mm), below and to the right of ``clear_of`` (mm)."""
        x0, y0, x1, y1 = extents
        left, bottom = self.at(x0, y0)
        right, top = self.at(x1, y1)
        low = self.at(0, clear_of[1])[1] + 30
        far = self.at(clear_of[2], 0)[0] + 30
        if x1 > x0:
            self._dimension(((left, low), (right, low)), ((left, bottom), (right, bottom)), x1 - x0)
        if y1 > y0:
            self._dimension(((far, bottom), (far, top)), ((right, bottom), (right, top)), y1 - y0)

    def _dimension(
        self, ends: tuple[Point, Point], measured: tuple[Point, Point], value: float
    ) -> None:
        """Add a dimension line between ``ends``, extension lines to what it measures, a number."""
        (a, b), size, content = ends, 11.0, f"{value:.3f}"
        length = math.dist(a, b)
        ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        half = ADVANCE * size * len(content) / 2 + 4
        beside = length < 2 * half + 24  # no room between the arrows
        parts = [_line(a, b)]
        if beside:
            middle = (b[0] + (half + 8) * ux, b[1] + (half + 8) * uy)
        else:
            parts = [
                _line(a, (middle[0] - half * ux, middle[1] - half * uy)),
                _line((middle[0] + half * ux, middle[1] + half * uy), b),
            ]
        for end, part in zip(ends, measured, strict=True):
            d = math.dist(end, part) or 1.0
            away = ((end[0] - part[0]) / d, (end[1] - part[1]) / d)
            near = (part[0] + 5 * away[0], part[1] + 5 * away[1])
            parts.append(_line(near, (end[0] + 4 * away[0], end[1] + 4 * away[1])))
        # The arrow heads point outwards from between the ends, or inwards from outside.
        inward = 1.0 if length > 24 else -1.0
        for end, sign in ((a, inward), (b, -inward)):
            foot = (end[0] + 8 * sign * ux, end[1] + 8 * sign * uy)
            parts += [_line(end, (foot[0] - w * uy, foot[1] + w * ux)) for w in (-2.2, 2.2)]
        self.symbol(f'<path d="{"".join(parts)}" stroke="{INK}" stroke-width="0.8" fill="none"/>')
        wide, tall = (half, size / 2 + 1) if abs(ux) > abs(uy) else (size / 2 + 1, half)
        x, y = middle
        self.claim((x - wide, y - tall, x + wide, y + tall), force=True)
        self.text(middle, content, size=size, turn=0.0 if abs(ux) > abs(uy) else -90.0)

    def mark(self, x_mm: float, y_mm: float, name: str, colour: str, text: str) -> None:
        """Add a numbered ring about a place that a finding points to."""
        x, y = self.at(x_mm, y_mm)
        self.symbol(
            f'<circle cx="{number(x, 2)}" cy="{number(y, 2)}" r="9" fill="none" '
            f'stroke="{colour}" stroke-width="2"><title>{words(text)}</title></circle>'
        )
        self.text((x + 13, y - 11), name, size=11, colour=colour, bold=True, anchor="start")

    # --- printing ------------------------------------------------------------------------------

    def print(
        self,
        description: str,
        facts: Mapping[str, str],
        legend: Sequence[tuple[str, str]],
    ) -> str:
        """Return the SVG text. ``legend`` holds (SVG of a sample 28 x 12 units, its meaning)."""
        w, h = number(self.width), number(self.height)
        # 96 px an inch make it A4 on paper; some renderers refuse a size in mm.
        paper = [number(v / 4 * 96 / 25.4, 2) for v in (self.width, self.height)]
        out = [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{paper[0]}" height="{paper[1]}" '
            f'viewBox="0 0 {w} {h}" font-family="{FONT}">',
            f"<title>{words(self.title)}</title>",
            f"<desc>{words(description)}</desc>",
            "<style>.halo{paint-order:stroke;stroke:#fff;stroke-width:3px;"
            "stroke-linejoin:round}</style>",
            "<defs>",
            *self._defs,
            self._clip(),
            "</defs>",
            f'<rect width="{w}" height="{h}" fill="#fff"/>',
            *self._grid(),
            '<g clip-path="url(#frame)">',
            f'<g id="drawing" transform="matrix({number(self.scale, 6)} 0 0 '
            f'{number(-self.scale, 6)} {number(self._tx)} {number(self._ty)})" fill="none" '
            'stroke-linejoin="round" stroke-linecap="round">',
            *self._geometry,
            "</g>",
            '<g id="symbols">',
            *self._symbols,
            "</g>",
            '<g id="labels">',
            *self._labels,
            "</g>",
            "</g>",
            *self._title_block(facts, legend),
            "</svg>",
        ]
        return "\n".join(out) + "\n"

    def _clip(self) -> str:
        left, top, right, bottom = self._frame
        return (
            f'<clipPath id="frame"><rect x="{number(left)}" y="{number(top)}" '
            f'width="{number(right - left)}" height="{number(bottom - top)}"/></clipPath>'
        )

    def _grid(self) -> list[str]:
        left, top, right, bottom = self._frame
        step = nice(26.0 / self.scale)
        decimals = max(0, -math.floor(math.log10(step) + 1e-9))
        # Numbers on every line, or every fifth or so where they would touch.
        widest = max(len(f"{v:.{decimals}f}") for v in self.view) * ADVANCE * 8.5 + 10
        every = max(1, math.ceil(nice(widest / self.scale) / step - 1e-9))
        fine: list[str] = []
        zero: list[str] = []
        texts: list[str] = []
        for k in range(math.ceil(self.view[0] / step), math.floor(self.view[2] / step) + 1):
            x = self.at(k * step, 0)[0]
            (fine if k else zero).append(_line((x, top), (x, bottom)))
            if k % every == 0 and left + 8 < x < right - 8:
                texts.append(self._tick(x, bottom + 9, k * step, decimals, "middle"))
        for k in range(math.ceil(self.view[1] / step), math.floor(self.view[3] / step) + 1):
            y = self.at(0, k * step)[1]
            (fine if k else zero).append(_line((left, y), (right, y)))
            if k % every == 0 and top + 4 < y < bottom - 4:
                texts.append(self._tick(left - 4, y, k * step, decimals, "end"))
        return [
            f'<path d="{"".join(fine)}" stroke="#e4e8ec" stroke-width="0.6" fill="none"/>',
            f'<path d="{"".join(zero)}" stroke="#c3ccd5" stroke-width="0.9" fill="none"/>',
            f'<g font-size="8.5" fill="{GREY}">{"".join(texts)}</g>',
            f'<path d="M{number(left)} {number(top)}H{number(right)}V{number(bottom)}'
            f'H{number(left)}Z" stroke="{GREY}" stroke-width="0.9" fill="none"/>',
        ]

    def _tick(self, x: float, y: float, value: float, decimals: int, anchor: str) -> str:
        return (
            f'<text x="{number(x, 2)}" y="{number(y + 3, 2)}" text-anchor="{anchor}">'
            f"{value + 0.0:.{decimals}f}</text>"
        )

    def _title_block(
        self, facts: Mapping[str, str], legend: Sequence[tuple[str, str]]
    ) -> list[str]:
        left, right = self._frame[0], self._frame[2]
        top = self.height - MARGIN - self._band
        bottom = self.height - MARGIN
        legend_width = 300.0 if self.width == LONG else 250.0
        split = right - legend_width
        out = [
            f'<path d="M{number(left)} {number(top)}H{number(right)}V{number(bottom)}'
            f"H{number(left)}ZM{number(split)} {number(top)}V{number(bottom)}"
            f'" stroke="{GREY}" stroke-width="0.9" fill="none"/>'
        ]
        room = int((split - left - 150) / (15 * ADVANCE))
        out.append(
            f'<text x="{number(left + 12)}" y="{number(top + 25)}" font-size="15" '
            f'font-weight="bold" fill="{INK}">{words(shortened(self.title, room))}</text>'
        )
        out.append(self._ruler(split - 14, top + 24))
        rows = self._rows
        width = (split - left - 20) / self._columns
        for i, (name, value) in enumerate(facts.items()):
            x = left + 12 + width * (i // rows)
            y = top + 48 + 15 * (i % rows)
            fits = int((width - 90) / (10 * ADVANCE))
            out.append(
                f'<text x="{number(x, 2)}" y="{number(y, 2)}" font-size="10" fill="{INK}">'
                f'<tspan fill="{GREY}">{words(shortened(name, 14))}</tspan>'
                f'<tspan x="{number(x + 84, 2)}">{words(shortened(value, fits))}</tspan></text>'
            )
        per_column = math.ceil(max(len(legend), 1) / 2)
        for i, (sample, meaning) in enumerate(legend):
            x = split + 12 + (legend_width / 2 - 4) * (i // per_column)
            y = top + 20 + 18 * (i % per_column)
            out.append(
                f'<g transform="translate({number(x, 2)} {number(y - 6, 2)})">{sample}'
                f'<text x="36" y="9.5" font-size="10" fill="{INK}">{words(meaning)}</text></g>'
            )
        return out

    def _ruler(self, right: float, y: float) -> str:
        """Return a bar of a round length that ends at ``right``."""
        length = nice(45.0 / self.scale)
        if length * self.scale > 105:
            length /= 2
        left = right - length * self.scale
        bar = _line((left, y - 4), (left, y + 4)) + _line((right, y - 4), (right, y + 4))
        bar += _line((left, y), (right, y))
        return (
            f'<path d="{bar}" stroke="{INK}" stroke-width="1.2" fill="none"/>'
            f'<text x="{number((left + right) / 2, 2)}" y="{number(y - 5, 2)}" font-size="9" '
            f'text-anchor="middle" fill="{INK}">{number(length)} mm</text>'
        )


def shortened(text: str, room: int) -> str:
    """Return text of at most ``room`` characters, the end replaced by an ellipsis.

    >>> shortened("stator-36.dxf", 8)
    'stator-…'
    """
    return text if len(text) <= room else text[: max(room - 1, 0)] + "…"


def union(boxes: Iterable[Box]) -> Box:
    """Return the smallest box about all of at least one."""
    x0, y0, x1, y1 = zip(*boxes, strict=True)
    return min(x0), min(y0), max(x1), max(y1)


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _line(a: Point, b: Point) -> str:
    return f"M{number(a[0], 2)} {number(a[1], 2)}L{number(b[0], 2)} {number(b[1], 2)}"
