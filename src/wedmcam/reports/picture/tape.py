"""A picture of a punched tape: rows of holes in strips, as it lies on the bench.

Read from left to right, strip by strip; channel 1 is at the bottom, the sprocket holes lie between
channels 3 and 4. Under each row stands what it says, every tenth is numbered. A row of wrong parity
is marked. Runs of blank rows are shortened.
"""

from __future__ import annotations

from xml.sax.saxutils import escape

from wedmcam.formats import tape
from wedmcam.reports.picture.sheet import FONT, GREY, INK

#: Rows in one strip, and units between rows and channels (10 a row: 2.54 mm on paper at 3.94).
ROWS = 72
PITCH, EDGE, LABEL, GAP = 14.0, 12.0, 46.0, 44.0
#: Blank rows that are drawn of a longer run.
BLANKS = 6
_WRONG = "#c0392b"


def tape_picture(data: bytes, title: str) -> str:
    """Return a tape as SVG."""
    rows = _drawn(data)
    strips = [rows[k : k + ROWS] for k in range(0, len(rows), ROWS)] or [[]]
    height, width = 8 * PITCH + 2 * EDGE, ROWS * PITCH + 2 * EDGE
    total_w = LABEL + width + EDGE
    total_h = 54.0 + len(strips) * (height + GAP)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {total_w:g} {total_h:g}" '
        f'width="{total_w:g}" height="{total_h:g}" font-family="{FONT}" fill="{INK}">',
        f'<rect width="{total_w:g}" height="{total_h:g}" fill="#fff"/>',
        f'<text x="{EDGE:g}" y="26" font-size="16">{escape(title)}</text>',
        f'<text x="{EDGE:g}" y="43" font-size="11" fill="{GREY}">{len(data)} rows, '
        f"{len(data) * tape.ROW_MM / 1000:.2f} m; ISO 840, even parity in channel 8</text>",
    ]
    for k, strip in enumerate(strips):
        out += _strip(strip, 54.0 + k * (height + GAP), height, width)
    out.append("</svg>")
    return "\n".join(out) + "\n"


def _drawn(data: bytes) -> list[tuple[int, int | None]]:
    """Return rows as (number, character), and None for what is left out of a run of blanks."""
    rows: list[tuple[int, int | None]] = []
    at = 0
    while at < len(data):
        run = 1
        while data[at] == tape.BLANK and at + run < len(data) and data[at + run] == tape.BLANK:
            run += 1
        kept = min(run, BLANKS)
        rows += [(at + k + 1, data[at]) for k in range(kept)]
        if run > kept:
            rows.append((run - kept, None))
        at += run
    return rows


def _strip(
    strip: list[tuple[int, int | None]], top: float, height: float, width: float
) -> list[str]:
    """Return one strip of tape."""

    def y(line: float) -> float:
        # Lines from the bottom: channels 1 to 3, the sprocket holes, channels 4 to 8.
        return top + EDGE + 8 * PITCH - line * PITCH

    lines = [0, 1, 2, 4, 5, 6, 7, 8]
    out = [
        f'<rect x="{LABEL:g}" y="{top:g}" width="{width:g}" height="{height:g}" fill="#f7edd0" '
        f'stroke="{GREY}" stroke-width="0.8"/>'
    ]
    out += [
        f'<text x="{LABEL - 6:g}" y="{y(line) + 3.5:g}" font-size="9" fill="{GREY}" '
        f'text-anchor="end">{channel}</text>'
        for channel, line in enumerate(lines, 1)
    ]
    for k, (number, b) in enumerate(strip):
        x = LABEL + EDGE + (k + 0.5) * PITCH
        if b is None:
            out.append(
                f'<text x="{x:g}" y="{y(4):g}" font-size="8" fill="{GREY}" text-anchor="middle" '
                f'transform="rotate(-90 {x:g} {y(4):g})">{number} blank rows</text>'
            )
            continue
        holes = [line for c, line in enumerate(lines) if b >> c & 1]
        out += [f'<circle cx="{x:g}" cy="{y(line):g}" r="4.6"/>' for line in holes]
        out.append(f'<circle cx="{x:g}" cy="{y(3):g}" r="2.4" fill="{GREY}"/>')
        wrong = len(holes) % 2 == 1
        if wrong:
            out.append(
                f'<rect x="{x - PITCH / 2:g}" y="{top:g}" width="{PITCH:g}" height="{height:g}" '
                f'fill="none" stroke="{_WRONG}" stroke-width="2"/>'
            )
        name = tape.name_of(b)
        if b != tape.BLANK:
            small = 7 if len(name) > 1 else 11
            out.append(
                f'<text x="{x:g}" y="{top + height + 12:g}" font-size="{small}" '
                f'text-anchor="middle"{f" fill={chr(34)}{_WRONG}{chr(34)}" if wrong else ""}>'
                f"{escape(name)}</text>"
            )
        if number % 10 == 0:
            out.append(
                f'<text x="{x:g}" y="{top + height + 24:g}" font-size="8" fill="{GREY}" '
                f'text-anchor="middle">{number}</text>'
            )
    return out
