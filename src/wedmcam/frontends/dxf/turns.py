"""Whether an arc that is stated by two angles is a full turn, an arc, or neither for certain.

A drawing states full circles as arcs from s to s + 360, and rounds both figures in writing. What is
over a full turn by such a hair would be an arc of no length, by the rule that angles count modulo a
turn. So it matters whether the angles say "once round" themselves:

- They are a whole number of turns apart but for a hair: a full turn. The hair is 1e-3 radians: 2 pi
  written as 6.283, degrees with one decimal.
- They come short of one turn by a hair: a full turn, too. Here the hair is 1e-5 radians (degrees
  with three decimals, radians with five): below 10 um at a radius of 1 m. What is more is a gap,
  that the joining of ends closes or refuses by its own measure in the part.
- A small angle from start to end is an arc, however small: fillets between all but parallel lines
  are such. Where it has no length that a drawing could mean, it is told.
"""

from __future__ import annotations

import math
from enum import Enum

#: Turns by this much more than whole ones are whole ones, radians, if the ends are so near, um.
OVER_RAD, OVER_UM = 1e-3, 10.0
#: A turn that comes short by this much is whole, radians.
SHORT_RAD = 1e-5
#: An arc that is shorter is none, um: `transforms.chain` drops it as a piece without length.
NOTHING_UM = 1e-3


class Turn(Enum):
    """What two angles say."""

    ARC = "arc"
    FULL = "full"  # said, or within what float64 makes of it
    ROUNDED = "rounded"  # a full turn but for a hair
    EQUAL = "equal"  # the same angle twice
    NOTHING = "nothing"  # a hair more than the same angle twice
    OVER = "over"  # more than a turn, and by more than a hair


#: The codes of findings about entities whose angles say so.
TELLING = {
    Turn.EQUAL: "full-arc",
    Turn.ROUNDED: "rounded-turn",
    Turn.NOTHING: "no-arc",
    Turn.OVER: "over-turn",
}


def turn_of(start: float, end: float, radius_um: float, exact: float) -> Turn:
    """Return what the angles of an arc say, counter-clockwise from start to end.

    Args:
        start: angle, radians.
        end: angle, radians.
        radius_um: its radius, or larger half axis, um.
        exact: radians; what differs by less is the same.

    >>> degrees = [(0, 360), (12.345678, 372.345679), (0, 359.9999), (10, 10.01), (0, 365)]
    >>> [turn_of(math.radians(a), math.radians(b), 3e3, 1e-11).value for a, b in degrees]
    ['full', 'rounded', 'rounded', 'arc', 'over']
    """
    full = 2.0 * math.pi
    raw = end - start
    if not math.isfinite(raw):
        return Turn.ARC
    if abs(raw) < exact:
        return Turn.EQUAL
    turns = round(raw / full)
    rest = raw - turns * full  # from -pi to pi
    if turns and abs(rest) < exact:
        return Turn.FULL
    if -SHORT_RAD <= rest < 0.0:  # modulo a turn a full one but for this
        return Turn.ROUNDED
    if 0.0 <= rest <= OVER_RAD:
        length = rest * radius_um
        if turns > 0 and length <= OVER_UM:
            return Turn.ROUNDED
        # Backwards by a turn but for a hair: an arc across angle 0, if both are in one turn.
        crossing = start < full and end >= 0.0
        if turns < 0 and length <= OVER_UM and (not crossing or length < NOTHING_UM):
            return Turn.ROUNDED
        if not turns and length < NOTHING_UM:
            return Turn.NOTHING
    return Turn.OVER if raw > full else Turn.ARC
