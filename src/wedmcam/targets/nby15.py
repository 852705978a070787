"""The AGIEMERIC NBY-15: whole degrees of a base circle, punched tape, a radius corrector.

The operator sets switches: a correction of the radius, a scale, the directions of the axes. A tape
is compiled for none of them; `verify --correct` runs it with what is set.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers.nby15.base_circle import arc_limit_um, sagitta_um
from wedmcam.controllers.nby15.corrector import Correction, correction
from wedmcam.controllers.nby15.data import TapeProgram
from wedmcam.diag import Diagnostic, error, note
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.targets.entries import Entries
from wedmcam.targets.stated import Stated

Floats = NDArray[np.float64]


class Nby15(Stated):
    """Its target."""

    is_text = False
    pairs: ClassVar[bool] = False

    @property
    def stop_word(self) -> str:
        """See `Target`."""
        return "M02"

    @property
    def whole_contours(self) -> str:
        """See `Target`."""
        return "the controller keeps fractions of a um from arc to arc, and begins with none"

    @property
    def arc_limit_um(self) -> Callable[[Floats], Floats] | None:
        """An arc is a polygon: its sagitta, and 1.5 um, or 2 um beyond R 60 mm."""
        return arc_limit_um

    def lower(self, plan: Plan, count: str | None) -> tuple[Program | None, list[Diagnostic]]:
        """See `Target`."""
        from wedmcam.transforms.lower.degrees import lower_to_degrees

        return lower_to_degrees(plan, self.rules(count))

    def write(
        self,
        program: Program,
        plan: Plan,
        entries: Entries,
        *,
        feed_um: float | None = None,
        sharp: bool = False,
    ) -> tuple[bytes | None, Sequence[Diagnostic]]:
        """See `Target`; says how coarse the arcs are, and what may be corrected."""
        data, findings = self._encoded(program)
        if isinstance(program, TapeProgram):
            findings = [*findings, *_coarse(program), *_correctable(program)]
        return data, findings

    def read(
        self, data: bytes, file: str, entries: Entries
    ) -> tuple[Program, Sequence[Diagnostic]]:
        """See `Target`."""
        return self._decoded(data, file)


def _coarse(program: TapeProgram) -> list[Diagnostic]:
    """Return a note of how far the arcs lie off their circle: a machine of degrees has polygons."""
    arcs = np.flatnonzero(program.tape["kind"] == Kind.ARC)
    if not len(arcs):
        return []
    largest = int(arcs[np.argmax(program.tape["radius"][arcs])])
    radius = int(program.tape["radius"][largest])
    return [
        note(
            "degree-polygons",
            "arcs are polygons of a side a degree: up to {sagitta_um:.2f} um inside the circle, at "
            "R {radius_mm:.3f} mm; an arc is proven within its sagitta + {more_um:g} um, there "
            "{limit_um:.2f} um",
            _source(program, largest),
            sagitta_um=float(sagitta_um(radius)),
            radius_mm=radius / 1000,
            more_um=float(arc_limit_um(radius) - sagitta_um(radius)),
            limit_um=float(arc_limit_um(radius)),
        )
    ]


_WHY = {
    "no-arc": "the radius corrector does nothing: the tape has no arc",
    "corner": "the radius corrector has to stay at 0: block {block} does not join the one before "
    "tangentially",
    "fraction": "the radius corrector has to stay at 0: block {block} is at a fraction of a degree "
    "that is made as a short line",
    "radius": "the radius corrector may be set up to {most_um} um either way: the smallest radius, "
    "of block {block}",
}


def _correctable(program: TapeProgram) -> list[Diagnostic]:
    """Return a note of the largest value that the corrector may have."""
    c: Correction = correction(program.tape)
    why = _WHY[c.why]
    if c.why == "radius" and c.most_um >= 999:
        why = "the radius corrector may be set up to {most_um} um either way: all that it has"
    return [
        note(
            "radius-corrector",
            why,
            None if c.block is None else _source(program, c.block),
            block=None if c.block is None else c.block + 1,
            most_um=c.most_um,
        )
    ]


def _source(program: TapeProgram, row: int):  # type: ignore[no-untyped-def]
    source = int(program.tape["source"][row])
    return program.sources[source] if 0 <= source < len(program.sources) else None
