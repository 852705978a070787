"""What a figure transform can be: the words of the part language as values.

Lengths are um, angles degrees and exact. ``copies`` is 0 where none was asked for: then the image
takes the figure's place; with copies the figure stays, and copy k is k times as far away, computed
from the figure itself and never from the copy before.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

#: Most copies of a rotation [S], and of a translation (ours: more is a typing error).
MOST_TURNS = 99
MOST_COPIES = 9_999


@dataclass(frozen=True, slots=True)
class Translate:
    """Move by (x, y) um."""

    x: float
    y: float
    copies: int = 0


@dataclass(frozen=True, slots=True)
class Rotate:
    """Turn counter-clockwise by ``degrees`` about a point, um."""

    degrees: Fraction
    copies: int = 0
    about: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Symmetry:
    """Reflect in the x axis (y -> -y) or in the y axis (x -> -x) [D]."""

    axis: Literal["x", "y"]


@dataclass(frozen=True, slots=True)
class Mirror:
    """Reflect in the line through 0 at 45 or 135 degrees [D]."""

    degrees: Literal[45, 135]


@dataclass(frozen=True, slots=True)
class Reverse:
    """Run every chain the other way, the last one first."""


@dataclass(frozen=True, slots=True)
class With:
    """Keep the figure and add its image; a reflected image runs in reverse, so the path goes on."""

    transform: Transform


@dataclass(frozen=True, slots=True)
class Sequence:
    """One transform after the other."""

    transforms: tuple[Transform, ...]


Transform = Translate | Rotate | Symmetry | Mirror | Reverse | With | Sequence
