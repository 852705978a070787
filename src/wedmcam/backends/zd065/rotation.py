"""Write the rotation format of the ZD-065.

The controller turns the polar blocks back into whole um. So each block is written with the angle
and the R for which its data processing gives exactly the block that was proven: R is the rounded
distance, and the rounded circle through it misses a whole point by less than half a um. Where the
8 digits fall badly the neighbours are tried; where none fits the block is refused.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks
from wedmcam.backends.zd065.compact import encode as encode_compact
from wedmcam.backends.zd065.memory import Memory
from wedmcam.controllers.zd065.data import POLAR
from wedmcam.controllers.zd065.rotation import rotate
from wedmcam.diag import Diagnostic, Severity, has_errors
from wedmcam.formats import lines, rotation
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
#: How many units of the last digit of an angle, and um of R, are tried.
DIGITS, RADII = 12, (0, 1, -1)


def encode(
    program: Program, machine: Machine, positions: NDArray[np.int64] | None = None
) -> tuple[bytes, list[Diagnostic]]:
    """Return the rotation data of a program, and what was found.

    Args:
        program: blocks as for the cutting format.
        machine: a rotation profile.
        positions: not needed; writers are called alike.

    Returns:
        The bytes, empty when there is an error.
    """
    _, findings = encode_compact(program, machine)
    findings = [d for d in findings if d.code != "over-memory"]
    if has_errors(findings):
        return b"", findings
    blocks = program.blocks
    kind = blocks["kind"]
    arc = kind == Kind.ARC
    straight = (kind == Kind.LINE) | (kind == Kind.MOVE)
    x, y, count = (blocks[k].astype(np.int64) for k in ("x", "y", "count"))
    lx, ly, _ = lines.full(x, y, blocks["axis"], count)
    x, y = np.where(straight, lx, x), np.where(straight, ly, y)
    checks = Checks(program)
    length = np.hypot(x, y)
    checks.tell(
        Severity.ERROR,
        "over-limit",
        straight & (np.floor(length + 0.5) > 999_999),
        "block {block}: the line is {length_mm:.3f} mm long; the format holds 999.999 mm",
        lambda i: {"length_mm": float(length[i]) / 1000},
    )
    figure, reached = polar(blocks, x, y)
    checks.tell(
        Severity.ERROR,
        "not-reachable",
        (arc | straight) & ~reached,
        "block {block}: no angle of 8 digits and whole R give this block",
        hint="--to compact holds it as it is",
    )
    findings += checks.findings
    if checks.failed:
        return b"", findings
    memory = _memory_of(blocks, figure, x, y)
    return memory.data.tobytes(), [*findings, *memory.too_large(machine)]


def polar(blocks: NDArray[np.void], x: Ints, y: Ints) -> tuple[NDArray[np.void], NDArray[np.bool_]]:
    """Return polar blocks (dtype `POLAR`) that the controller turns into these, and which do.

    Args:
        blocks: dtype `BLOCK`.
        x: um; lines in full.
        y: likewise.
    """
    arc = blocks["kind"] == Kind.ARC
    moving = arc | (blocks["kind"] == Kind.LINE) | (blocks["kind"] == Kind.MOVE)
    figure = np.zeros(len(blocks), dtype=POLAR)
    figure["kind"], figure["turn"] = blocks["kind"], np.where(arc, blocks["turn"], 0)
    exact = np.degrees(np.arctan2(y, x)) % 360.0
    size = np.floor(np.hypot(x, y) + 0.5).astype(np.int64)
    done = ~moving
    shifts = sorted(range(-DIGITS, DIGITS + 1), key=abs)
    for radius in RADII:
        for digits in shifts:
            left = np.flatnonzero(~done)
            if not len(left):
                return figure, np.ones(len(blocks), dtype=bool)
            figure["start"][left] = _nudge(exact[left], digits)
            figure["size"][left] = np.maximum(size[left] + radius, 1)
            done[left] = _find_sweeps(figure, blocks, left, x, y)
    return figure, done


def _nudge(degrees: NDArray[np.float64], digits: int) -> NDArray[np.float64]:
    """Return the angles rounded to 8 digits, some units of the last digit away, 0 to 360."""
    exponent, significand = rotation.angle_fields(degrees)
    moved = np.maximum(significand + digits, 0)
    value = rotation.angle_value(exponent, moved)
    exponent, significand = rotation.angle_fields(np.where(value >= 360, value - 360, value))
    return rotation.angle_value(exponent, significand)


def _find_sweeps(
    figure: NDArray[np.void], blocks: NDArray[np.void], rows: Ints, x: Ints, y: Ints
) -> NDArray[np.bool_]:
    """Find the subtended angles of ``rows`` in ``figure``; return which rows come out exactly."""
    count = blocks["count"][rows]
    arc = blocks["kind"][rows] == Kind.ARC
    good = np.zeros(len(rows), dtype=bool)
    for part in (0.0, 0.2, -0.2, 0.4, -0.4):
        todo = np.flatnonzero(~good & (arc | (part == 0.0)))
        if not len(todo):
            break
        of = rows[todo]
        sweep = _sweep(figure["start"][of], figure["size"][of], figure["turn"][of],
                       count[todo] + part)  # fmt: skip
        exponent, significand = rotation.angle_fields(np.clip(sweep, 0.0, 999.0))
        sweep = rotation.angle_value(exponent, significand)
        figure["sweep"][of] = np.where(arc[todo], sweep, 0.0)
        path = rotate(figure[of])
        same = (path["x"] == x[of]) & (path["y"] == y[of])
        good[todo] = same & (~arc[todo] | (path["count"] == count[todo]))
    return good


def _sweep(
    start: NDArray[np.float64],
    radius: Ints,
    turn: NDArray[np.int8],
    count: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the angle, degrees, over which an arc counts J on the inscribed square."""
    root = np.sqrt(2.0)
    n = np.floor(start / 90.0 + 0.5)
    c = root * n + np.sin(np.radians(start - 90.0 * n)) + turn * count / np.maximum(radius, 1)
    m = np.floor(c / root + 0.5)
    end = 90.0 * m + np.degrees(np.arcsin(np.clip(c - root * m, -1.0, 1.0)))
    return np.asarray(np.abs(end - start))


def _memory_of(blocks: NDArray[np.void], figure: NDArray[np.void], x: Ints, y: Ints) -> Memory:
    """Return the data of blocks whose angles and sizes are a figure's."""
    memory = Memory(blocks["kind"], blocks["turn"], x, y, rotation.LENGTH)
    arc, straight = memory.arc, memory.straight
    exponent, significand = rotation.angle_fields(figure["start"])
    memory.put(arc | straight, 1, 1, exponent)
    memory.put(arc | straight, 2, 4, significand)
    memory.put(arc, 6, 4, figure["size"])
    memory.put(straight, 6, 3, figure["size"])
    exponent, significand = rotation.angle_fields(figure["sweep"])
    memory.put(arc, 10, 1, exponent)
    memory.put(arc, 11, 4, significand)
    return memory
