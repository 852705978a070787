"""Ranges of lengths.

Whatever a user says is held against one where it is read, so that nothing deeper meets a length
that is negative, endless or no number. Without imports: every command fetches it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

#: Longer lengths are typing errors: 100 m; um.
MOST_UM = 1e8


@dataclass(frozen=True, slots=True)
class Range:
    """Lengths from ``least`` to ``most``, um; with ``none`` also 0, for nothing of it."""

    least: float = -MOST_UM
    most: float = MOST_UM
    none: bool = False

    def __str__(self) -> str:
        words = f"{_mm(self.least)} to {_mm(self.most)}"
        return f"0, or {words}" if self.none else words

    def holds(self, um: Any) -> bool:
        """Return whether a value is a length of this range."""
        if isinstance(um, bool) or not isinstance(um, int | float) or not math.isfinite(um):
            return False
        return self.least <= um <= self.most or (self.none and um == 0)


def _mm(um: float) -> str:
    if abs(um) >= 1e6:
        return f"{um / 1e6:g} m"
    return f"{um / 1e3:g} mm" if abs(um) >= 1 else f"{um:.6f}".rstrip("0") + " um" if um else "0"


#: Coordinates of a thread point or an origin, um.
PLACE = Range()
