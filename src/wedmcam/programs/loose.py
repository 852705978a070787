"""When a slug or a part comes loose: in which block of a program, after how much of its cut.

Whoever stands at the machine has to hold it then. It is through where the path along the contour
has come back to its start; leads and overcut cut nothing free.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from wedmcam.ir.program import Kind, Program, Role
from wedmcam.ir.understanding import Understanding
from wedmcam.machines import Machine
from wedmcam.programs.places import block_ends, match_blocks


@dataclass(frozen=True, slots=True)
class Loose:
    """What a cut frees.

    Attributes:
        number: of the contour.
        what: "slug", "part" or "piece".
        block: at whose end it is free, 1-based, as decoded.
        at: where the wire is then, um, drawing coordinates.
        along_um: how much of this cut is done then, lead-in and contour.
        size: width and height of what is free, um.
    """

    number: int
    what: str
    block: int
    at: tuple[float, float]
    along_um: float
    size: tuple[float, float]


def loose(
    known: Understanding, lowered: Program, program: Program, machine: Machine
) -> tuple[Loose, ...]:
    """Return what comes loose, in the order of cutting.

    Args:
        known: what was understood of the plan of this program.
        lowered: with roles and cuts.
        program: decoded from its bytes.
        machine: both are of this profile.
    """
    like = match_blocks(lowered, program, machine)
    _, ends = block_ends(program, machine)
    cutting = np.flatnonzero((program.blocks["kind"] < Kind.MOVE) & (like >= 0))
    role, cut = (lowered.blocks[name][like[cutting]] for name in ("role", "cut"))
    out = []
    for row in known.rows:
        own = cutting[(cut == row.number) & (role == Role.CONTOUR)]
        if row.frees is None or not len(own):
            continue
        last = int(own[-1])
        x, y = (float(v) for v in ends[last])
        x0, y0, x1, y1 = row.extents
        along = row.lead_um + row.length_um
        out.append(Loose(row.number, row.frees, last + 1, (x, y), along, (x1 - x0, y1 - y0)))
    return tuple(out)
