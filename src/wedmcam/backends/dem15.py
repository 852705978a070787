"""Write job records of the DEM-15 (`formats.dem15`).

Positions are unsigned numbers of 16 bits: a drawing with negative places, or beyond the table, is
moved, by whole millimetres where they fit, and that is said.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.backends.checks import Checks, ends
from wedmcam.diag import Diagnostic, Place, Severity, error, has_errors, note
from wedmcam.formats import dem15
from wedmcam.ir.program import Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]


def encode(
    program: Program, machine: Machine, positions: Ints | None = None
) -> tuple[bytes, list[Diagnostic]]:
    """Return the job records of a program, and what was found.

    Args:
        program: LINE and MOVE with the speed in ``count``, in steps; THREAD becomes a pause.
        machine: a profile of the DEM-15.
        positions: where the machine stands after each block, steps, shape (blocks, 2). Left out,
            the controller is run.

    Returns:
        The bytes, empty when there is an error. An end is added where there is none.
    """
    checks, how = Checks(program), machine.vectors
    blocks = program.blocks
    kinds = blocks["kind"].astype(np.int64)
    _refuse(checks)
    findings = [*checks.findings, *_generator(machine)]
    if has_errors(findings):
        return b"", findings
    if positions is None:
        positions = ends(program, machine)
    at = np.vstack([np.array([program.origin], np.int64), positions])
    shift, more = _shift(at, program, machine)
    findings += more
    if has_errors(findings):
        return b"", findings
    word, step = dem15.UNITS[how.positions]
    at = (at + shift) * step
    rows = [word]
    for i, kind in enumerate(kinds.tolist()):
        if kind <= Kind.MOVE:
            words = (0, 0) if kind == Kind.MOVE else (how.t_i, how.t_p)
            fields = [*at[i].tolist(), *at[i + 1].tolist(), *words, int(blocks["count"][i])]
            rows.append(" ".join(map(str, fields)))
        elif kind in (Kind.PAUSE, Kind.THREAD):
            rows.append(dem15.PAUSE)
        elif kind == Kind.STOP:
            rows.append(dem15.END)
            break
    if rows[-1] != dem15.END:
        rows.append(dem15.END)
    return "".join(row + "\n" for row in rows).encode("ascii"), findings


def _refuse(checks: Checks) -> None:
    """Report what no job record says."""
    blocks = checks.program.blocks
    kind, moving = blocks["kind"], blocks["kind"] <= Kind.MOVE
    checks.tell(
        Severity.ERROR,
        "not-in-format",
        (kind == Kind.ARC) | (kind == Kind.WORD),
        "block {block}: the controller runs vectors; it has no arcs and no words",
        hint="compile the drawing for it: arcs are cut into vectors",
    )
    checks.tell(
        Severity.ERROR,
        "speed-range",
        moving & ((blocks["count"] < 1) | (blocks["count"] > dem15.FASTEST)),
        "block {block}: speed is {value}; the controller takes 1 to 127, 15.75 um a minute each",
        lambda i: {"value": int(blocks["count"][i])},
    )
    checks.tell(
        Severity.ERROR,
        "zero-count",
        moving & (blocks["x"] == 0) & (blocks["y"] == 0),
        "block {block}: it has no step",
    )


def _generator(machine: Machine) -> list[Diagnostic]:
    """Return errors on the control words of the profile."""
    t_i, t_p = machine.vectors.t_i, machine.vectors.t_p
    if t_p < dem15.LEAST_T_P:
        return [
            error(
                "generator-words",
                "profile {machine}: t(p) {t_p} is {volts:.2f} V: below 7 V the pulse generator "
                "cuts out",
                hint="vectors.t_p = 119 or more",
                machine=machine.name,
                t_p=t_p,
                volts=t_p * dem15.VOLTS_T_P / dem15.CONTROL,
            )
        ]
    if dem15.too_much(t_i, t_p):
        return [
            error(
                "generator-words",
                "profile {machine}: t(i) {t_i} with t(p) {t_p} would draw {amperes:.2f} A; the "
                "supply gives 2 A",
                hint="vectors.t_i at most one and a half times vectors.t_p",
                machine=machine.name,
                t_i=t_i,
                t_p=t_p,
                amperes=float(dem15.current(t_i, t_p)),
            )
        ]
    return []


def _shift(at: Ints, program: Program, machine: Machine) -> tuple[Ints, list[Diagnostic]]:
    """Return what is added to all places, steps, so that they are on the table, and findings.

    Args:
        at: every place that is named, steps, in the controller's frame.
        program, machine: whose they are.
    """
    none = np.zeros(2, np.int64)
    most = np.array(dem15.reach(machine.limits.travel_um, machine.vectors.positions))
    low, high = at.min(axis=0), at.max(axis=0)
    if ((high - low) > most).any():
        k = int(np.argmax(high - low - most))
        place = _drawn(at[int(np.argmax(at[:, k]))], machine)
        return none, [
            error(
                "over-travel",
                "the program goes {length_mm:.3f} mm along {axis}, farthest at {place}; the table "
                "of {machine} goes {most_mm:.3f} mm",
                points_mm=(place,),
                length_mm=float((high - low)[k]) * machine.axes.step_um / 1000,
                axis="XY"[k],
                place=place,
                machine=machine.name,
                most_mm=float(most[k]) * machine.axes.step_um / 1000,
                hint="move or turn the part, or split it; dem15-steps has a table twice as large"
                if machine.vectors.positions == "um"
                else "move or turn the part, or split it",
            )
        ]
    if (low >= 0).all() and (high <= most).all():
        return none, []
    per_mm = round(1000 / machine.axes.step_um)
    whole = -(low // per_mm) * per_mm
    shift = np.where(high + whole <= most, whole, -low)
    shift = np.where((low >= 0) & (high <= most), 0, shift)
    x, y = (shift * machine.axes.step_um / 1000).tolist()
    return shift, [
        note(
            "origin-moved",
            "positions are not negative and end with the table: x {x_mm:+.3f} mm and y {y_mm:+.3f} "
            "mm are added to all places of the drawing",
            hint="clamp the blank so, or draw the part on the table",
            x_mm=x,
            y_mm=y,
        )
    ]


def _drawn(place: Ints, machine: Machine) -> Place:
    """Return a place of the controller's frame as the drawing has it, mm."""
    axes = machine.axes
    x, y = (place[::-1] if axes.exchange else place).tolist()
    x, y = (-x if axes.mirror_x else x), (-y if axes.mirror_y else y)
    return Place.of_um(x * axes.step_um, y * axes.step_um)
