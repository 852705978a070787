"""Contour: a chain of lines and arcs, open or closed. Arcs stay arcs and carry their centre.

The machine's arc is 'start relative to centre' and DXF states centres, so the centre is stored and
not derived from a bulge.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Span
from wedmcam.geom.segments import following

#: One row per vertex, um. Row i opens the segment to row i + 1 (to row 0 if closed).
#: (cx, cy): centre of an arc, not used for a line. turn: +1 counter-clockwise, -1 clockwise, 0 a
#: line.
#: source: index into ``Contour.sources``, -1 for a segment that was not drawn.
VERTEX = np.dtype(
    [("x", "f8"), ("y", "f8"), ("cx", "f8"), ("cy", "f8"), ("turn", "i1"), ("source", "i4")]
)


def vertices(rows: Iterable[tuple[float, float, float, float, int, int]]) -> NDArray[np.void]:
    """Return an array of dtype `VERTEX` from (x, y, cx, cy, turn, source) rows."""
    return np.array(list(rows), dtype=VERTEX)


@dataclass(frozen=True, slots=True, eq=False)
class Contour:
    """Connected segments that their users cannot change. Takes ``vertices`` over.

    Invariants, checked on construction:
        - ``vertices`` has dtype `VERTEX`, shape (n,), n >= 1.
        - the last row of an open contour has turn 0 and opens no segment; n >= 2 there.
        - a closed contour of one row is a full circle (turn is not 0): start = end with a turn.
        - all coordinates are finite.
    """

    vertices: NDArray[np.void]
    closed: bool
    sources: tuple[Span, ...] = ()

    def __post_init__(self) -> None:
        v = self.vertices
        assert v.dtype == VERTEX, v.dtype
        assert v.ndim == 1
        assert len(v) >= (1 if self.closed else 2), v
        assert self.closed or v["turn"][-1] == 0
        assert len(v) > 1 or v["turn"][0] != 0
        assert all(np.isfinite(v[k]).all() for k in ("x", "y", "cx", "cy"))
        v.flags.writeable = False

    @property
    def starts(self) -> NDArray[np.void]:
        """Rows that open a segment, shape (segments,)."""
        return self.vertices if self.closed else self.vertices[:-1]

    @property
    def ends(self) -> NDArray[np.void]:
        """The row in which each segment ends, shape (segments,)."""
        return following(self.vertices) if self.closed else self.vertices[1:]

    def __len__(self) -> int:
        """How many segments there are."""
        return len(self.vertices) if self.closed else len(self.vertices) - 1

    def source_of(self, row: int) -> Span | None:
        """Return where the segment opened by ``row`` was drawn, or None."""
        index = int(self.vertices["source"][row])
        return self.sources[index] if 0 <= index < len(self.sources) else None

    def reversed(self) -> Contour:
        """Return the contour run the other way; the first vertex stays the first if closed."""
        v = self.vertices
        out = v[::-1].copy() if not self.closed else np.roll(v[::-1], 1)
        # The segment opened by a row of the reversed contour is the one that ended there before.
        opens = (np.roll(v, 1) if self.closed else np.concatenate([v[-1:], v[:-1]]))[::-1]
        if self.closed:
            opens = np.roll(opens, 1)
        for name in ("cx", "cy", "source"):
            out[name] = opens[name]
        out["turn"] = -opens["turn"]
        if not self.closed:
            out["turn"][-1] = 0
        return Contour(out, self.closed, self.sources)
