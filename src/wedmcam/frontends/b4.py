"""Read 4B: the outline as it stands there, and the cutting program that a gap makes of it.

What a 4B record holds beyond 3B is taken out and the rest is read as 3B, so every layout and every
repair is that of `frontends.b3`. Then arcs are scaled as the controller does (`formats.b4`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.controllers import Stepping
from wedmcam.controllers.scaling import scale
from wedmcam.controllers.zd065.data import OUTLINE
from wedmcam.diag import Diagnostic, Severity, error, has_errors
from wedmcam.formats import b4
from wedmcam.formats.lengths import mm_of, to_mm
from wedmcam.formats.listing import Values, listed
from wedmcam.frontends.b3 import reader as b3
from wedmcam.frontends.text import TextSpans, plain
from wedmcam.frontends.zd065.compensation import TORN_UM, directions
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def decode(
    data: bytes, machine: Machine, file: str, gap_um: float = 0, outwards: bool = True
) -> tuple[Program, list[Diagnostic]]:
    """Return the cutting program that the controller makes of a 4B file.

    Args:
        data: any bytes; never raises.
        machine: a 4B profile.
        file: name for the spans.
        gap_um: as entered at the controller, whole um; 0 gives the outline.
        outwards: True for a punch, False for a die.

    Refused with a gap: arcs without R or without D or DD, R - gap not above 0, and joints that are
    not tangent; the first and the last line between two controls may be leads and are not asked.
    """
    program, figure, findings = _fields(data, machine, file)
    if has_errors(findings):
        return program, findings
    teller = _Teller(program, findings)
    _tell_radii(teller, figure, machine)
    gap = _whole_gap(teller, gap_um)
    if gap and not teller.failed:
        _tell_unfit(teller, figure, machine, gap, outwards)
    if not gap or teller.failed:
        return program, teller.findings
    cutting = _cutting(teller, figure, gap, outwards)
    return Program(cutting, spans=program.spans, words=program.words), teller.findings


def _tell_radii(teller: _Teller, figure: NDArray[np.void], machine: Machine) -> None:
    """Warn of arcs whose R is not the distance of their start from their centre."""
    mm = to_mm(machine.axes.step_um)
    radius, stated = np.hypot(figure["x"], figure["y"]), figure["radius"]
    off = np.abs(radius - stated) > 2 + 0.01 * radius
    teller.tell(
        Severity.WARNING,
        "radius-contradicts",
        (figure["kind"] == Kind.ARC) & (stated > 0) & off,
        "R is {radius_mm:.3f} mm, but the arc starts {start_mm:.3f} mm from its centre",
        lambda i: {"radius_mm": mm(stated[i]), "start_mm": mm(radius[i])},
    )


def _whole_gap(teller: _Teller, gap_um: float) -> int:
    """Return the gap in whole um, 0 with a finding for one that a controller does not take."""
    gap = int(gap_um) if gap_um == int(gap_um) and 0 <= gap_um <= b4.MOST_GAP_UM else 0
    if gap != gap_um:
        teller.tell(
            Severity.ERROR,
            "gap-value",
            np.arange(len(teller.program.blocks)) == 0,
            "a gap of {gap_um:g} um; whole um from 0 to {most_um} are taken",
            lambda i: {"gap_um": gap_um, "most_um": b4.MOST_GAP_UM},
        )
    return gap


def _tell_unfit(
    teller: _Teller, figure: NDArray[np.void], machine: Machine, gap: int, outwards: bool
) -> None:
    """Refuse arcs and joints that cannot be offset by a gap, um."""
    arc, err = figure["kind"] == Kind.ARC, Severity.ERROR
    mm = to_mm(machine.axes.step_um)
    stated, grows = figure["radius"], figure["grows"].astype(np.int64)
    teller.tell(
        err,
        "bad-type",
        arc & ((grows == 0) | (stated < 1)),
        "an arc without R, or without D or DD: it cannot be offset",
        hint="write B R and D (convex) or DD (concave) before G",
    )
    after = stated + grows * (1 if outwards else -1) * gap
    teller.tell(
        err,
        "gap-value",
        arc & (after <= 0),
        "the radius {radius_mm:.3f} mm is not larger than the gap {gap_mm:.3f} mm by which it "
        "shrinks",
        lambda i: {"radius_mm": mm(stated[i]), "gap_mm": mm(gap)},
    )
    angle, allowed, joint = _joints(teller.program.blocks, gap, machine.own_stepping)
    teller.tell(
        err,
        "not-tangent",
        joint & (angle > allowed),
        "it meets the next block at an angle of {angle_deg:.3f} degrees",
        lambda i: {"angle_deg": float(np.degrees(angle[i]))},
        hint="round the corner, or write the offset path: --to 3b",
    )


def _cutting(
    teller: _Teller, figure: NDArray[np.void], gap: int, outwards: bool
) -> NDArray[np.void]:
    """Return the blocks with their arcs offset by a gap, um, and refuse arcs that vanish."""
    cutting = teller.program.blocks.copy()
    arc = cutting["kind"] == Kind.ARC
    scaled = scale(figure, gap, outwards)
    for name in ("x", "y", "count"):
        cutting[name][arc] = scaled[name][arc]
    teller.tell(
        Severity.ERROR,
        "zero-count",
        arc & ((cutting["count"] < 1) | (cutting["x"] ** 2 + cutting["y"] ** 2 < 2)),
        "the gap leaves nothing of this arc",
    )
    return cutting


class _Teller:
    """Collects findings about the blocks of a program."""

    def __init__(self, program: Program, findings: list[Diagnostic]) -> None:
        self.program, self.findings, self.failed = program, list(findings), False

    def tell(
        self,
        severity: Severity,
        code: str,
        mask: Bools,
        template: str,
        values: Values | None = None,
        hint: str | None = None,
    ) -> None:
        where = np.flatnonzero(mask)
        spans = self.program.spans
        self.findings += (
            d for _, d in listed(severity, code, where, spans.__getitem__, template, values, hint)
        )
        self.failed |= severity is Severity.ERROR and len(where) > 0


def _fields(
    data: bytes, machine: Machine, file: str
) -> tuple[Program, NDArray[np.void], list[Diagnostic]]:
    """Return the outline as 3B blocks, the same with R and type (dtype `OUTLINE`), and findings."""
    codes = plain(data).codes
    fourths = b4.fourths(codes)
    text = bytearray(codes)
    for f in fourths:
        text[f.low : f.high] = b" " * (f.high - f.low)
    program, findings = b3.decode(bytes(text), machine, file)
    findings = [_of_4b(d) for d in findings]
    blocks = program.blocks
    figure = np.zeros(len(blocks), OUTLINE)
    for name in ("kind", "turn", "axis", "x", "y", "count"):
        figure[name] = blocks[name]
    if fourths and isinstance(program.spans, TextSpans):
        starts = np.array([f.start for f in fourths], np.int64)
        at = np.minimum(np.searchsorted(starts, program.spans.starts), len(starts) - 1)
        mine = starts[at] == program.spans.starts
        figure["radius"][mine] = np.array([f.radius for f in fourths])[at[mine]]
        figure["grows"][mine] = np.array([f.grows for f in fourths])[at[mine]]
    return program, figure, findings


def _of_4b(d: Diagnostic) -> Diagnostic:
    """Return a finding of the 3B reader as it is of a 4B record: one B too many is no 4B there."""
    if d.code != "unsupported-4b":
        return d
    return error(
        "bad-record",
        "a record with more than the four B of B X B Y B J B R D|DD G Z",
        d.span,
        count=d.count,
    )


def _joints(
    blocks: NDArray[np.void], gap_um: int, stepping: Stepping
) -> tuple[NDArray[np.float64], NDArray[np.float64], Bools]:
    """Return the angle at the end of each block, what rounding explains, and whether it counts."""
    cutting = blocks["kind"] <= Kind.ARC
    ax, ay, bx, by, room = directions(blocks, stepping)
    joint = np.zeros(len(blocks), bool)
    joint[:-1] = cutting[:-1] & cutting[1:]
    first, last = np.ones(len(blocks), bool), np.ones(len(blocks), bool)
    first[1:], last[:-1] = ~cutting[:-1], ~cutting[1:]
    line = blocks["kind"] == Kind.LINE
    after = np.minimum(np.arange(len(blocks)) + 1, len(blocks) - 1)
    joint &= ~(first & line) & ~(last & line)[after]
    angle = np.abs(np.arctan2(ax * by[after] - ay * bx[after], ax * bx[after] + ay * by[after]))
    return angle, TORN_UM / gap_um + room + room[after], joint


def senses(data: bytes, machine: Machine) -> Ints:
    """Return for each block of `decode` +1 for an arc that says D, -1 for DD, 0 for others."""
    return _fields(data, machine, "")[1]["grows"].astype(np.int64)


def describe_blocks(data: bytes, machine: Machine) -> dict[str, str]:
    """Return what each arc states beside the fields of 3B, for people, by line:column.

    >>> from wedmcam.machines import default
    >>> describe_blocks(b"B9900B0B39600B9900DDGYNR1", default("4b"))
    {'1:1': 'R 9.900 mm, shrinks outwards'}
    """
    program, figure, _ = _fields(data, machine, "")
    words = {1: "grows outwards", -1: "shrinks outwards", 0: "no type"}
    mm = mm_of(machine.axes.step_um)
    out = {}
    for i in np.flatnonzero(figure["kind"] == Kind.ARC).tolist():
        span = program.spans[i]
        place = f"{getattr(span, 'line', 0)}:{getattr(span, 'column', 0)}"
        out[place] = f"R {mm(int(figure['radius'][i]))}, {words[int(figure['grows'][i])]}"
    return out
