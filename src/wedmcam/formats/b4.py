"""The 4B record ``B X B Y B J B R D|DD G Z``: 3B for controllers that offset arcs by themselves.

X, Y, J, G and Z are those of 3B (``formats.b3``) and state the outline; the offset is entered at
the controller. R is the radius of an arc, um; D (convex) says that it grows when the path is offset
outwards, DD (concave) that it shrinks [S]. A line has R = 0, or is a plain 3B record.

What a controller computes of it [R], for the tables of shops say no more than what the record
holds: X, Y and J of an arc times (R + gap) / R or (R - gap) / R, rounded to whole um, J counted on
the axis of the record; lines as they stand. That is the data processing of the ZD-065's
compensation format, which is printed, with another way of counting. It is the offset path where all
joints are tangent, so other joints are refused.
Marks: [S] published rule, [R] our decision.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

#: The radius grows, or shrinks, when the path is offset outwards.
GROWS, SHRINKS = "D", "DD"
#: The largest gap that is taken, um [R]: five digits, a tenth of a metre.
MOST_GAP_UM = 99_999

RECORD = re.compile(
    rb"B *+(\d*+) *+B *+(\d*+) *+B *+(\d*+) *+(B *+(\d*+) *+(D *+D?+)?+ *+)"
    rb"G *+[XY] *+(?:L|[SN] *+R) *+[1-4](?!\d)"
)


@dataclass(frozen=True, slots=True)
class Fourth:
    """What a record holds beside the five fields of 3B.

    Attributes:
        start: where the record starts in the text.
        low, high: of the fourth field and the letters behind it.
        radius: um; blank is 0.
        grows: +1 for D, -1 for DD, 0 for neither.
    """

    start: int
    low: int
    high: int
    radius: int
    grows: int


def fourths(codes: bytes) -> list[Fourth]:
    """Return the 4B records of a text of ``frontends.plain``, in order.

    >>> [(f.radius, f.grows) for f in fourths(b"B9900B0B39600B9900DDGYNR1 B5B0B5B0GXL1")]
    [(9900, -1), (0, 0)]
    """
    out = []
    for m in RECORD.finditer(codes):
        letters = (m[6] or b"").replace(b" ", b"")
        grows = {b"": 0, b"D": 1, b"DD": -1}[letters]
        radius = int(m[5][:12] or b"0")
        out.append(Fourth(m.start(), m.start(4), m.end(4), radius, grows))
    return out
