"""What the judge says: the figures of a program, and of each of its cuts and blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Count = Literal["exact", "textbook"]


class BlockTable(NamedTuple):
    """One entry a cutting block, in the order of the program. um.

    Attributes:
        block: 1-based number among all blocks of the program, control records included.
        cut: 1-based number of the cut in the plan; 0 where it is none.
        nominal: (x, y) of the exact route where the block was to end; NaN where it was lost.
        stepped: (x, y) where the machine stands after it.
        error: distance between the two.
        low: farthest that the block's places lie to the right of the exact route, <= 0.
        high: and to the left, >= 0.
    """

    block: NDArray[np.int64]
    cut: NDArray[np.int64]
    nominal: NDArray[np.float64]
    stepped: NDArray[np.int64] | NDArray[np.float64]
    error: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]


class CutVerdict(NamedTuple):
    """One contour.

    Attributes:
        number: 1-based, in the order of the plan.
        first_block: 1-based, among all blocks of the program.
        last_block: likewise.
        blocks: cutting blocks, leads included.
        steps: of these.
        closed: whether the contour is closed.
        closure_um: |end - start| of a closed contour without leads and overcut; None if open, or
            if the program does not come that far.
        max_deviation_um: of the contour and its overcut, both ways: a bound, which is no higher
            than the figure of the program, and exact where that is this contour's.
        lead_deviation_um: of the leads, likewise.
        length_mm: of the wire's way, leads included.
        backwards: the program runs the contour against the plan's sense (other leads and order
            being allowed).
    """

    number: int
    first_block: int
    last_block: int
    blocks: int
    steps: int
    closed: bool
    closure_um: float | None
    max_deviation_um: float
    lead_deviation_um: float
    length_mm: float
    backwards: bool = False


@dataclass(frozen=True, slots=True)
class Verdict:
    """The figures of a program; see ``docs`` of the fields in the command line's summary.

    Lengths are true um and mm, also where a step of the machine is not 1 um.

    Attributes:
        ok: no error was found.
        count: the machine that was judged: "exact" counts steps, "textbook" recomputes arc ends.
        closure_um: largest |end - start| over the closed contours, leads, overcut and moves left
            out; None when none is closed.
        max_deviation_um: over all contours, both ways between the wire's way and the exact route;
            a lost block counts with its distance from the route.
        lead_deviation_um: the same of the leads.
        gouge_um: by how much a disc of radius offset about the wire's centre enters the kept
            material, leads included; 0 when it does not; None for ``on``, ``left``, ``right``.
        uncut_um: how far inner corners stay uncut; None where gouge_um is None.
        contours: contours cut.
        blocks: cutting blocks.
        steps: of these; leads count as cutting.
        moves: blocks with the generator off.
        controls: pauses, stops, ends, thread marks and unknown words.
        path_mm: length of the wire's way while cutting.
        extents_um: x low, y low, x high, y high of the wire's centre while cutting.
        origin_um: where the first block starts in the drawing.
        offset_um: of the plan.
        side: of the plan.
        path_limit_um: the limit of max_deviation_um.
        gouge_limit_um: the limit of gouge_um.
        cuts: one entry a contour that was found.
        make_table: measures every block; see ``table``.
        stepped_closure_um: with "textbook", what a controller that counts steps would do; else
            None.
        stepped_max_deviation_um: likewise.
        stepped_gouge_um: likewise.
    """

    ok: bool
    count: Count
    closure_um: float | None
    max_deviation_um: float
    lead_deviation_um: float
    gouge_um: float | None
    uncut_um: float | None
    contours: int
    blocks: int
    steps: int
    moves: int
    controls: int
    path_mm: float
    extents_um: tuple[float, float, float, float]
    origin_um: tuple[float, float]
    offset_um: float
    side: str
    path_limit_um: float
    gouge_limit_um: float
    cuts: tuple[CutVerdict, ...]
    make_table: Callable[[], BlockTable]
    stepped_closure_um: float | None = None
    stepped_max_deviation_um: float | None = None
    stepped_gouge_um: float | None = None

    @property
    def table(self) -> BlockTable:
        """One entry a cutting block, measured when it is asked for."""
        return self.make_table()
