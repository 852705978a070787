"""Read the gap-compensation format of the ZD-065.

`read` returns the outline as it stands there, `decode` the cutting program that the controller's
data processing makes of it with a gap and the radius of its transition arcs: that is what would be
cut.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.controllers.pointwise import MIRROR
from wedmcam.controllers.scaling import scale
from wedmcam.controllers.zd065.compensation import compensate
from wedmcam.controllers.zd065.data import OUTLINE
from wedmcam.controllers.zd065.leads import Leads, entered_leads
from wedmcam.diag import Diagnostic, FileSpan, Severity, error
from wedmcam.formats import compensation, quadrants
from wedmcam.formats.lengths import mm_of
from wedmcam.frontends.zd065.gap_problems import tell_followed, tell_problems
from wedmcam.frontends.zd065.memory import ByteSpans, Stream
from wedmcam.ir.program import Axis, Kind, Program
from wedmcam.machines import Machine

#: Joints that a gap would tear apart by less than this are tangent enough, um.
TORN_UM = 1.0


def read(data: bytes, machine: Machine, file: str) -> tuple[NDArray[np.void], list[Diagnostic]]:
    """Return the blocks of compensation data (dtype `OUTLINE`), and findings.

    Blocks in error are left out. Never raises.
    """
    stream, figure = _fields(data, file, machine)
    _check(stream, figure)
    _, findings = stream.finish(scale(figure, 0))
    return figure[stream.good], findings


def decode(
    data: bytes,
    machine: Machine,
    file: str,
    gap_um: float = 0,
    outwards: bool = True,
    corner_um: float | None = None,
    *,
    leads: Leads = (None, None),
    open_loop: bool = False,
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that the controller makes of compensation data.

    Args:
        data: any bytes; never raises.
        machine: its limits.
        file: name for the spans.
        gap_um: whole um, 0 to 7999 [S].
        outwards: True for a punch, False for a die.
        corner_um: radius of the transition arcs at corners of the outline, um, at least the gap;
            None for the gap. Punch and die of one outline need the same.
        leads: lines that the operator enters for those of the file, from the thread point to where
            the outline starts and from there, um: for the side that the file is not threaded for.
            None for the file's.
        open_loop: only scale the arcs, as 4B does; joints that are not tangent are refused then.

    ``spans[i]`` is where the block stands that block i was made of. Refused, with the place, is
    what has no such path: see `controllers.zd065.compensation.Problem`. With an error the program
    is that of the good blocks, as stated.
    """
    stream, figure = _fields(data, file, machine)
    _check(stream, figure)
    if leads != (None, None) and stream.good.all() and len(figure):
        figure, why = entered_leads(figure, *leads)
        if why:
            program, findings = stream.finish(scale(figure, 0))
            return program, [*findings, _no_leads(why, file)]
    whole = int(gap_um) if gap_um == int(gap_um) and 0 <= gap_um <= compensation.MOST_GAP_UM else 0
    stream.tell(
        Severity.ERROR,
        "gap-value",
        np.full(len(figure), whole != gap_um) & (np.arange(len(figure)) == 0),
        "block {block}: a gap of {gap_um:g} um; the controller takes whole um from 0 to {most_um}",
        lambda i: {"gap_um": gap_um, "most_um": compensation.MOST_GAP_UM},
    )
    sign = figure["grows"].astype(np.int64) * (1 if outwards else -1)
    after = figure["radius"] + sign * whole
    stream.tell(
        Severity.ERROR,
        "gap-value",
        stream.arc & (after <= 0),
        "block {block}: the radius {radius_mm:.3f} mm is not larger than the gap {gap_mm:.3f} mm "
        "by which it shrinks",
        lambda i: {
            "radius_mm": stream.mm(figure["radius"][i]),
            "gap_mm": stream.mm(whole),
        },
    )
    if open_loop:
        if whole:
            _tell_joints(stream, figure, whole)
        blocks = scale(_safe(figure, stream), whole, outwards)
        stream.tell_blocks(blocks["x"], blocks["y"], blocks["count"])
        return stream.finish(blocks)
    made = None
    if stream.good.all() and len(figure):
        made, problems = compensate(
            figure, whole, outwards, corner_um, stepping=machine.own_stepping
        )
        failed = tell_problems(stream, problems)
        tell_followed(stream, made)
        made = None if failed else made
    blocks = scale(_safe(figure, stream), 0)
    program, findings = stream.finish(blocks)
    if made is None:
        return program, findings
    stop = program.blocks[len(figure) :]
    stated = np.concatenate([made.stated, np.arange(len(figure), len(program.blocks))])
    spans = ByteSpans(
        file,
        np.append(stream.starts, stream.end)[stated],
        np.append(stream.starts + stream.sizes, stream.end + 1)[stated],
    )
    cutting = made.blocks.copy()
    cutting["source"] = -1
    return Program(np.concatenate([cutting, stop]), spans=spans), findings


def _no_leads(why: str, file: str) -> Diagnostic:
    """Return why lines of the operator replace no leads."""
    reasons = {
        "contours": "they replace the leads of one contour, and the file has several or none",
        "leads": "the file has no such lead: its contour is open, or starts without one",
        "length": "a line of no length is none",
    }
    return error(
        "compensation-lead",
        "--lead-in or --lead-out: {reason}",
        FileSpan(file),
        hint="compile the drawing for that side; --cuts makes a file of one contour",
        reason=reasons[why],
    )


def senses(data: bytes, machine: Machine) -> NDArray[np.int64]:
    """Return for each block of `decode` +1 for a convex arc, -1 for a concave one, 0 for others."""
    figure, _ = read(data, machine, "")
    program, _ = decode(data, machine, "")
    out = np.zeros(len(program.blocks), np.int64)
    out[: len(figure)] = figure["grows"]
    return out


def describe_blocks(data: bytes, machine: Machine) -> dict[str, str]:
    """Return what each arc states beside x, y and J, for people, by its address.

    >>> from wedmcam.machines import default
    >>> data = bytes.fromhex("24 01 00002000 00000000 00002000 002828 00")
    >>> describe_blocks(data, default("compensation"))
    {'0x0000': 'R 2.000 mm, grows outwards'}
    """
    s, figure = _fields(data, "", machine)
    mm = mm_of(machine.axes.step_um)
    words = {1: "grows outwards", -1: "shrinks outwards", 0: "no type"}
    return {
        f"{int(s.starts[k]):#06x}": f"R {mm(radius)}, {words[grows]}"
        for k, radius, grows in zip(
            np.flatnonzero(s.arc),
            figure["radius"][s.arc].tolist(),
            figure["grows"][s.arc].tolist(),
            strict=True,
        )
    }


def _fields(data: bytes, file: str, machine: Machine) -> tuple[Stream, NDArray[np.void]]:
    s = Stream(data, compensation.LENGTH, file, machine)
    figure = np.zeros(len(s.starts), dtype=OUTLINE)
    figure["kind"], figure["turn"], figure["axis"] = s.kind, s.turn, Axis.SQUARE
    types = s.bytes_at(s.arc, 1)
    figure["grows"] = np.select(
        [types == compensation.GROWS, types == compensation.SHRINKS], [1, -1], 0
    )
    figure["radius"] = s.column(s.arc, 2, 4)
    xs = s.column(s.arc, 6, 4) + s.column(s.straight, 1, 3)
    ys = s.column(s.arc, 10, 4) + s.column(s.straight, 4, 3)
    figure["count"] = s.column(s.arc, 14, 3)
    both = s.arc | s.straight
    figure["x"], figure["y"] = quadrants.signed(xs, ys, np.where(both, s.named, 0))
    return s, figure


def _check(s: Stream, figure: NDArray[np.void]) -> None:
    s.tell_digits()
    s.tell(
        Severity.ERROR,
        "bad-type",
        s.arc & (figure["grows"] == 0),
        "block {block}: the compensation type is neither 0x01 (convex) nor 0x02 (concave)",
    )
    radius = np.hypot(figure["x"], figure["y"])
    s.tell(
        Severity.ERROR,
        "radius-contradicts",
        s.arc & (figure["radius"] < 1),
        "block {block}: R is 0",
    )
    s.tell(
        Severity.WARNING,
        "radius-contradicts",
        s.arc & (np.abs(radius - figure["radius"]) > 2 + 0.01 * radius),
        "block {block}: R is {radius_mm:.3f} mm, but the arc starts {start_mm:.3f} mm from its "
        "centre",
        lambda i: {"radius_mm": s.mm(figure["radius"][i]), "start_mm": s.mm(radius[i])},
    )
    moving = s.arc | s.straight
    right = quadrants.quadrant(figure["x"], figure["y"], s.turn)
    s.tell_repaired(Severity.NOTE, moving & (right != s.named) & (right != 0), right)
    blocks = scale(_safe(figure, s), 0)
    s.tell_blocks(blocks["x"], blocks["y"], blocks["count"])


def _safe(figure: NDArray[np.void], s: Stream) -> NDArray[np.void]:
    """Return the figure with blocks in error made harmless; they are left out in the end."""
    out = figure.copy()
    bad = ~s.good & (s.arc | s.straight)
    out["kind"][bad] = Kind.LINE
    for name, value in (("turn", 0), ("grows", 1), ("radius", 1), ("x", 1), ("y", 1)):
        out[name][bad] = value
    # R + gap > 0 has to hold for arcs only.
    return out


def _tell_joints(s: Stream, figure: NDArray[np.void], gap_um: int) -> None:
    """Refuse joints that the gap would tear apart by more than rounding explains."""
    blocks = scale(_safe(figure, s), 0)
    cutting = (s.kind == Kind.LINE) | s.arc
    ax, ay, bx, by, room = directions(blocks)
    following = np.zeros(len(blocks), dtype=bool)
    following[:-1] = cutting[:-1] & cutting[1:] & s.good[:-1] & s.good[1:]
    lead_in = np.zeros(len(blocks), dtype=bool)
    lead_in[0:1] = True
    lead_in[1:] = ~cutting[:-1]
    lead_out = np.zeros(len(blocks), dtype=bool)
    lead_out[-1:] = True
    lead_out[:-1] = ~cutting[1:]
    line = s.kind == Kind.LINE
    n = np.arange(len(blocks))
    after = np.minimum(n + 1, len(blocks) - 1)
    following &= ~(lead_in & line) & ~(lead_out & line)[after]
    angle = np.abs(np.arctan2(ax * by[after] - ay * bx[after], ax * bx[after] + ay * by[after]))
    allowed = TORN_UM / gap_um + room + room[after]
    s.tell(
        Severity.ERROR,
        "not-tangent",
        following & (angle > allowed),
        "block {block}: it meets the next block at an angle of {angle_deg:.3f} degrees",
        lambda i: {"angle_deg": float(np.degrees(angle[i]))},
        hint="round the corner, or write the offset path: --to compact",
    )


def directions(
    blocks: NDArray[np.void], stepping: Stepping = MIRROR
) -> tuple[NDArray[np.float64], ...]:
    """Return the directions at the end and at the start of blocks, and what rounding does to them.

    Returns:
        End x, y; start x, y (unit vectors or 0); radians.
    """
    arc = blocks["kind"] == Kind.ARC
    x, y = blocks["x"].astype(float), blocks["y"].astype(float)
    turn = blocks["turn"].astype(float)
    motion = stepping.run(blocks)
    ex, ey = x + motion.dx, y + motion.dy
    sx, sy = np.where(arc, -turn * y, x), np.where(arc, turn * x, y)
    ex, ey = np.where(arc, -turn * ey, x), np.where(arc, turn * ex, y)
    size = np.maximum(np.hypot(x, y), 1.0)
    # Where the centre of a short arc lies is known to a few um along the arc only.
    sure = np.minimum(size, np.maximum(motion.steps, 1))
    return (
        ex / np.maximum(np.hypot(ex, ey), 1.0),
        ey / np.maximum(np.hypot(ex, ey), 1.0),
        sx / size,
        sy / size,
        4.0 / sure,
    )
