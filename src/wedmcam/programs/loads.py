"""Programs that are loaded one after the other: stretches of one program, and all put together.

A load ends at the end of a block. There the machine waits, with the generator off, and the next
load starts where it stands: so loads that follow each other are one program.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from wedmcam.ir.program import Kind, Program

#: Where nothing of a program follows.
_ENDS = (Kind.STOP, Kind.END)


def stretch(program: Program, first: int, last: int, start: tuple[int, int]) -> Program:
    """Return some blocks of a program as one of their own, which ends as the whole one does.

    Args:
        program: as it was lowered.
        first, last: rows, from 0, both inclusive.
        start: where the first of them starts, steps.
    """
    kinds = program.blocks["kind"]
    ends = np.flatnonzero(np.isin(kinds, _ENDS))
    rows = np.concatenate([np.arange(first, last + 1), ends[ends > last]])
    return _taken(program, rows, start)


def without_end(program: Program) -> Program:
    """Return a program without the blocks that end it: another load follows."""
    rows = np.flatnonzero(~np.isin(program.blocks["kind"], _ENDS))
    return _taken(program, rows, program.origin)


def part(program: Program, first: int, last: int, start: tuple[int, int]) -> Program:
    """Return blocks ``first`` to ``last`` (1-based, both inclusive) of a decoded program."""
    return _taken(program, np.arange(first - 1, last), start)


def joined(programs: Sequence[Program]) -> Program:
    """Return decoded programs as one that runs them one after the other from the first's origin.

    Only the last of them ends it.
    """
    parts = [*(without_end(p) for p in programs[:-1]), programs[-1]]
    begin = np.cumsum([0, *(len(p.blocks) for p in parts)]).tolist()
    return replace(
        parts[0],
        blocks=np.concatenate([p.blocks for p in parts]),
        spans=tuple(span for p in parts for span in p.spans),
        words=tuple(
            (row + at, w) for p, at in zip(parts, begin, strict=False) for row, w in p.words
        ),
    )


def _taken(program: Program, rows: np.ndarray, start: tuple[int, int]) -> Program:
    number = {int(row): k for k, row in enumerate(rows)}
    spans = program.spans
    return replace(
        program,
        blocks=program.blocks[rows],
        origin=start,
        spans=tuple(spans[int(row)] for row in rows) if len(spans) else (),
        words=tuple((number[row], word) for row, word in program.words if row in number),
    )
