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
from wedmcam.controllers.nby15.data import TapeProgram, radii
from wedmcam.controllers.nby15.run_off import RunOff, run_off
from wedmcam.diag import Diagnostic, Place, Severity, Span, error, has_errors, note
from wedmcam.ir.plan import Plan
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine
from wedmcam.targets.entries import Entries
from wedmcam.targets.stated import Stated

Floats = NDArray[np.float64]


class Nby15(Stated):
    """Its target."""

    is_text = False
    coarse: ClassVar[bool] = True
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

    def lower(
        self, plan: Plan, count: str | None, feed_um: float | None = None
    ) -> tuple[Program | None, list[Diagnostic]]:
        """See `Target`."""
        from wedmcam.transforms.lower.degrees import lower_to_degrees

        return lower_to_degrees(plan, self.rules(count, feed_um))

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
        program, findings = self._decoded(data, file, switches=entries.switches)
        if isinstance(program, TapeProgram) and not has_errors(findings):
            program, more = _switched(program, entries, self.machine)
            findings = [*findings, *more]
        return program, findings

    def entered(self, entries: Entries, plan: Plan | None = None) -> Entries:
        """The switches."""
        return Entries(switches=entries.switches, run_off=entries.run_off)

    def write_carried(
        self,
        program: Program,
        entries: Entries,
        senses: NDArray[np.int64] | None,
        feed_um: float | None = None,
    ) -> tuple[bytes | None, list[Diagnostic]]:
        """See `Target`; arcs of another interpolator are none of whole degrees."""
        arcs = np.flatnonzero(program.blocks["kind"] == Kind.ARC)
        if not len(arcs):
            return super().write_carried(program, entries, senses, feed_um)
        source = int(program.blocks["source"][arcs[0]])
        return None, [
            error(
                "not-in-format",
                "{arcs} arcs: those of the tape are polygons of whole degrees, and step no other "
                "controller's path",
                program.sources[source] if 0 <= source < len(program.sources) else None,
                hint="convert it to a drawing (-o FILE.dxf), and compile that --to nby15",
                arcs=len(arcs),
            )
        ]


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


def _said(c: Correction, span: Span | None) -> Diagnostic:
    """Return a note of what the radius corrector may be set to, and why."""
    block = None if c.block is None else c.block + 1
    if c.why == "no-arc":
        text = "the radius corrector does nothing: the tape has no arc"
        return note("radius-corrector", text, span)
    if c.why == "corner":
        corner = (
            "the radius corrector has to stay at 0: block {block} does not join the one before "
            "tangentially"
        )
        return note("radius-corrector", corner, span, block=block)
    if c.why == "fraction":
        fraction = (
            "the radius corrector has to stay at 0: block {block} is at a fraction of a degree "
            "that is made as a short line"
        )
        return note("radius-corrector", fraction, span, block=block)
    if c.most_um >= 999:
        every = "the radius corrector may be set up to {most_um} um either way: all that it has"
        return note("radius-corrector", every, span, most_um=c.most_um)
    radius = (
        "the radius corrector may be set up to {most_um} um either way: the smallest radius, of "
        "block {block}"
    )
    return note("radius-corrector", radius, span, most_um=c.most_um, block=block)


def _switched(
    program: TapeProgram, entries: Entries, machine: Machine
) -> tuple[Program, list[Diagnostic]]:
    """Return what the machine runs with its switches as set, and whether that is safe.

    With ``run_off`` it is run all the same: up to the limit switch that opens.
    """
    unsafe = [*_unsafe(program, entries), *_too_large(program, entries, machine)]
    # What is unsafe runs off, and is longer than the travel for that.
    beyond = [] if unsafe else _beyond(program, machine)
    if not entries.run_off:
        hint = "--run-off shows what the machine does then"
        return program, [d if d.hint else d.with_hint(hint) for d in (*unsafe, *beyond)]
    findings = [replace(d, severity=Severity.WARNING) for d in unsafe]
    travel = machine.limits.travel_um
    gone = run_off(program.blocks, travel) if (unsafe or beyond) and travel is not None else None
    if gone is None:
        return program, findings
    behind = gone.row + 1
    run = replace(
        program,
        blocks=program.blocks[:behind],
        spans=program.spans[:behind],
        of=program.of[:behind],
    )
    return run, [*findings, _opens(program, entries, gone)]


def _unsafe(program: TapeProgram, entries: Entries) -> list[Diagnostic]:
    """Return an error where the corrector is set to more than is safe."""
    correct = entries.switches.correct_um
    if not correct:
        return []
    c = correction(program.tape)
    if abs(correct) <= c.most_um:
        return []
    span = None if c.block is None else _span_of(program, c.block)
    said = replace(_said(c, span), severity=Severity.ERROR)
    return [said.extended("; it is set to {correct_um:+} um", correct_um=correct)]


def _too_large(program: TapeProgram, entries: Entries, machine: Machine) -> list[Diagnostic]:
    """Return an error where the scale makes a radius larger than the machine's."""
    radius, most = program.tape["radius"] * entries.switches.scale, machine.limits.arc_um
    if entries.switches.scale == 1 or not (radius > most).any():
        return []
    row = int(np.argmax(radius))
    return [
        error(
            "over-limit",
            "block {block}: the radius is {radius_mm:.3f} mm at scale {scale}, the largest is "
            "{most_mm:.3f} mm",
            _span_of(program, row),
            block=row + 1,
            radius_mm=int(radius[row]) / 1000,
            scale=entries.switches.scale,
            most_mm=most / 1000,
        )
    ]


def _beyond(program: TapeProgram, machine: Machine) -> list[Diagnostic]:
    """Return an error for each axis along which the path is longer than the travel."""
    limit, blocks = machine.limits.travel_um, program.blocks
    if limit is None:
        return []
    out = []
    moving = blocks["kind"] <= Kind.MOVE
    for axis, most in zip("XY", limit, strict=True):
        at = np.concatenate([[0], np.cumsum(np.where(moving, blocks[axis.lower()], 0))])
        size = np.maximum.accumulate(at) - np.minimum.accumulate(at)
        if size[-1] <= most:
            continue
        row = int(np.argmax(size > most)) - 1
        out.append(
            error(
                "over-travel",
                "block {block}: the program goes {length_mm:.3f} mm along {axis}; the table of "
                "{machine} goes {most_mm:.3f} mm",
                program.spans[row] if len(program.spans) else None,
                block=int(program.of[row]) + 1,
                length_mm=int(size[-1]) / 1000,
                axis=axis,
                machine=machine.name,
                most_mm=most / 1000,
            )
        )
    return out


def _opens(program: TapeProgram, entries: Entries, gone: RunOff) -> Diagnostic:
    """Return an error: where a limit switch opens."""
    block = int(program.of[gone.row])
    radius = int(radii(program.tape, entries.switches)[block])
    about = ", turned about R {radius_mm:.3f} mm," if radius else ""
    where = Place.of_um(gone.x, gone.y)
    return error(
        "limit-switch",
        "block {block}" + about + " runs off: the limit switch of {axis} opens at {place} from "
        "the start, after {steps} steps",
        program.spans[gone.row] if len(program.spans) else None,
        points_mm=(where,),
        block=block + 1,
        **({"radius_mm": radius / 1000} if radius else {}),
        axis=f"{'+' if gone.sign > 0 else '-'}{gone.axis}",
        place=where,
        steps=gone.steps,
    )


def _span_of(program: TapeProgram, row: int) -> Span | None:
    """Return where a block of the tape stands in its file."""
    lines = np.flatnonzero(program.of == row)
    return program.spans[int(lines[0])] if len(lines) and len(program.spans) else None


def _correctable(program: TapeProgram) -> list[Diagnostic]:
    """Return a note of the largest value that the corrector may have."""
    c: Correction = correction(program.tape)
    return [_said(c, None if c.block is None else _source(program, c.block))]


def _source(program: TapeProgram, row: int) -> Span | None:
    source = int(program.tape["source"][row])
    return program.sources[source] if 0 <= source < len(program.sources) else None
