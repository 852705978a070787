"""What an ISO program means to a controller that offsets outlines by its own table: G41, G42 D.

The reader of the format gives outlines, the model of the controller (`controllers.offsetting`) the
path that it makes of them. The judge holds programs to that path, so no line of it comes from what
makes programs: this module imports neither `transforms` nor `geom`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from wedmcam.diag import Diagnostic, Place, Span, TextSpan, error, has_errors
from wedmcam.ir.program import Program
from wedmcam.machines import Machine

if TYPE_CHECKING:
    from wedmcam.controllers.offsetting import BlockLimits, Refusal
    from wedmcam.frontends.iso.dialect import Dialect
    from wedmcam.frontends.iso.modes import Table
    from wedmcam.ir.programmed import Programmed

#: What helps where the outline does not leave the offset room.
ROOM = (
    "a smaller offset or larger inside radii (--corner), or a profile that does not leave the "
    "offset to the controller"
)
#: And where it is the last block of the outline that comes too near to another.
CORNER = "end the outline before or behind an inner corner, by more than the offset"


def decode(
    data: bytes,
    machine: Machine,
    file: str,
    table: Table | None = None,
    dialect: Dialect | None = None,
    assumed: bool = False,
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that an ISO file means to a controller with these offsets.

    Args:
        data: any bytes; never raises.
        machine: an ISO profile.
        file: name for the spans.
        table: D number -> offset, um; None to refuse G41 and G42.
        dialect: how a foreign file is read; None: it is of this machine.
        assumed: the table is that of a drawing: one in the file wins.
    """
    from wedmcam.frontends.axes import to_drawing
    from wedmcam.frontends.iso import read

    step = machine.axes.step_um  # what follows is in steps of the machine
    steps = table if table is None or step == 1 else _in_steps(table, step)
    programmed, findings = read(data, machine, file, steps, dialect, assumed)
    program = programmed.program
    if len(programmed.motions) and not has_errors(findings):
        from wedmcam.controllers.offsetting import offset_outlines

        # The controller offsets in its own frame: a mirror turns left and right around.
        cutting, refusals = offset_outlines(programmed, block_limits(machine))
        program = program if cutting is None else cutting
        if refusals:
            spans, d = _spans(programmed), programmed.motions["d"].tolist()
            findings = [*findings, *(_error(refusal, spans, d) for refusal in refusals)]
    return to_drawing(program, machine.axes), findings


def block_limits(machine: Machine) -> BlockLimits:
    """Return what the blocks of a text machine hold, in the controller's own frame."""
    from wedmcam.controllers.offsetting import BlockLimits

    limits = machine.limits
    return BlockLimits(machine.own_stepping, limits.line_um, limits.arc_um, limits.count_um)


def _in_steps(table: Table, step_um: float) -> Table:
    def steps(number: int) -> float | None:
        um = table(number)
        return None if um is None else um / step_um

    return steps


def _spans(programmed: Programmed) -> list[TextSpan]:
    """Return for each motion where it stands in the file."""
    spans: dict[int, Span] = {
        mark: span
        for mark, span in zip(programmed.mark.tolist(), programmed.program.spans, strict=True)
        if mark >= 0
    }
    return [cast(TextSpan, spans[k]) for k in range(len(programmed.motions))]


def _error(refusal: Refusal, spans: list[TextSpan], d: Sequence[int]) -> Diagnostic:
    """Return why the controller makes no path of an outline, for people.

    Args:
        refusal: of the model.
        spans: of each motion.
        d: of each motion the number of its offset.
    """
    span, at = spans[refusal.motion], Place.of_um(*refusal.at)
    offset_mm = refusal.offset_um / 1000
    other_line = spans[refusal.other].line if refusal.other >= 0 else None
    match refusal.kind:
        case "lead":
            return error(
                "compensation-lead",
                "the lead-in is {length_mm:.3f} mm long, shorter than the offset D{number} of "
                "{offset_mm:.3f} mm",
                span,
                hint="start farther from the outline",
                length_mm=refusal.gap_um / 1000,
                number=d[refusal.motion],
                offset_mm=offset_mm,
            )
        case "steps":
            return error(
                "cannot-lower",
                "an arc near {at} has no stepped image within the budget of deviation",
                span,
                hint="please report the drawing",
                at=at,
            )
        case "radius":
            return error(
                "compensation-lost",
                "the controller cannot offset this block at {at} from the start of the program: "
                "its inside radius of {radius_mm:.3f} mm is smaller than the offset "
                "{offset_mm:.3f} mm",
                span,
                hint=ROOM,
                at=at,
                radius_mm=refusal.radius_um / 1000,
                offset_mm=offset_mm,
            )
        case "back":
            return error(
                "compensation-lost",
                "the controller cannot offset this block at {at} from the start of the program: "
                "it runs back on the block of line {other_line}, where the wire would be on its "
                "other side",
                span,
                hint="G40 and a lead-out before a pass the other way, which takes the other of "
                "G41 and G42",
                at=at,
                other_line=other_line,
            )
        case "near":
            return error(
                "compensation-lost",
                "the controller cannot offset this block at {at} from the start of the program: "
                "with an offset of {offset_mm:.3f} mm the wire comes {gap_mm:.3f} mm near to the "
                "block of line {other_line}",
                span,
                hint=CORNER if refusal.last else ROOM,
                at=at,
                offset_mm=offset_mm,
                gap_mm=refusal.gap_um / 1000,
                other_line=other_line,
            )
        case _:
            return error(
                "compensation-lost",
                "the controller cannot offset this block at {at} from the start of the program: "
                "with an offset of {offset_mm:.3f} mm nothing is left of it, or it meets another "
                "block",
                span,
                hint=ROOM,
                at=at,
                offset_mm=offset_mm,
            )
