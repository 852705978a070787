"""What every writer asks of a program before it writes: does it fit, and where does it end.

Findings name the block, and the place in the source or in the file that it was read from.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Severity, Span, error, has_errors, warning
from wedmcam.formats.listing import listed
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine


class Checks:
    """Collects findings about the blocks of one program."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.findings: list[Diagnostic] = []
        self._well = np.ones(len(program.blocks), dtype=bool)

    @property
    def failed(self) -> bool:
        """Whether any finding is an error."""
        return has_errors(self.findings)

    def span(self, i: int) -> Span | None:
        """Return where block ``i`` was read or drawn, or None."""
        if i < len(self.program.spans):
            return self.program.spans[i]
        source = int(self.program.blocks["source"][i])
        return self.program.sources[source] if 0 <= source < len(self.program.sources) else None

    def tell(
        self,
        severity: Severity,
        code: str,
        mask: NDArray[np.bool_],
        template: str,
        values: Callable[[int], Mapping[str, object]] | None = None,
        hint: str | None = None,
    ) -> None:
        """Report the blocks in ``mask`` that have no error yet.

        Args:
            severity, code, hint: of the findings.
            mask: for each block whether it has what is found.
            template: of the message; ``{block}`` is the number of the block, from 1.
            values: further values of template and hint, for a row of the program.
        """
        where = np.flatnonzero(mask & self._well)

        def of_block(i: int) -> dict[str, object]:
            return {"block": i + 1, **(values(i) if values else {})}

        self.findings += (
            d for _, d in listed(severity, code, where, self.span, template, of_block, hint)
        )
        if severity is Severity.ERROR:
            self._well[where] = False


def over_memory(records: int, machine: Machine) -> list[Diagnostic]:
    """Return a warning where a controller holds fewer records than a program has."""
    most = machine.limits.blocks
    if not most or records <= most:
        return []
    return [
        warning(
            "over-memory",
            "{records} records; {machine} holds {most}: {loads} loads",
            records=records,
            machine=machine.name,
            most=most,
            loads=-(-records // most),
        )
    ]


def ends(program: Program, machine: Machine) -> NDArray[np.int64]:
    """Return where the machine stands after each block, drawing um, shape (blocks, 2)."""
    motion = machine.own_stepping.run(program.blocks)
    return _summed(program, motion.dx, motion.dy)


def _summed(program: Program, dx: NDArray[np.int64], dy: NDArray[np.int64]) -> NDArray[np.int64]:
    steps = np.cumsum(np.stack([dx, dy], axis=1), axis=0)
    summed: NDArray[np.int64] = steps + np.array(program.origin)
    return summed


def extents(program: Program, machine: Machine) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the smallest and largest x, y that the wire reaches, moves included, drawing um.

    Arcs count with the apexes that they pass; the interpolator stays within 1 um of those.
    """
    blocks = program.blocks
    motion = machine.own_stepping.run(blocks)
    positions = _summed(program, motion.dx, motion.dy)
    starts = np.vstack([[program.origin], positions[:-1]])[: len(positions)]
    points = [np.array([program.origin]), positions]
    arc = blocks["kind"] == Kind.ARC
    a = blocks[arc]
    centre = starts[arc] - np.stack([a["x"], a["y"]], axis=1)
    end = positions[arc] - centre
    turn = a["turn"].astype(np.float64)
    first = np.arctan2(a["y"], a["x"])
    radius = np.hypot(a["x"], a["y"])
    sweep = turn * (np.arctan2(end[:, 1], end[:, 0]) - first) % (2 * np.pi)
    # Start and end leave whole turns open. A turn takes 8R steps, and parts of it in proportion to
    # within a tenth of a turn: enough to tell an arc that just passes its start from a short one.
    expected = motion.steps[arc] / (8 * radius) * (2 * np.pi)
    sweep += 2 * np.pi * np.round((expected - sweep) / (2 * np.pi))
    apex = np.ceil(radius).astype(np.int64)
    for k, (ux, uy) in enumerate(((1, 0), (0, 1), (-1, 0), (0, -1))):
        passed = turn * (k * np.pi / 2 - first) % (2 * np.pi) <= sweep
        points.append((centre + apex[:, None] * np.array([ux, uy]))[passed])
    every = np.concatenate(points)
    return every.min(axis=0), every.max(axis=0)


def travel(program: Program, machine: Machine) -> list[Diagnostic]:
    """Return a finding for each axis on which the program goes farther than the table does."""
    limit = machine.limits.travel_um
    if limit is None or not len(program.blocks):
        return []
    low, high = (e * machine.axes.step_um for e in extents(program, machine))
    return [
        error(
            "over-travel",
            "the program goes {length_mm:.3f} mm along {axis}; the table of {machine} goes "
            "{most_mm:.3f} mm",
            length_mm=int(size) / 1000,
            axis=name,
            machine=machine.name,
            most_mm=most / 1000,
        )
        for name, size, most in zip("XY", high - low, limit, strict=True)
        if size > most
    ]
