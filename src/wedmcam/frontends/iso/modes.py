"""Where an ISO program switches compensation on and off (G41, G42, G40), and whether it may there.

A controller goes into compensation on a straight lead-in, stays on one side, and leaves on a
straight lead-out. With another number of an offset some run askew to it: where a profile says so it
is read. What else a file may say differs from controller to controller, so it is refused here with
its place: there is no telling what would be cut.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity
from wedmcam.frontends.iso.reading import Reading
from wedmcam.ir.program import Role
from wedmcam.machines import builtin, names

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
LEFT, OFF = 41, 40
#: Hint for a motion in compensation that cannot be one.
_LEADS = "lead in and out on straight lines, G01"

#: D number -> the offset entered for it, um, >= 0; None for one that was not given.
Table = Callable[[int], float | None]


@dataclass(frozen=True, slots=True, eq=False)
class Modes:
    """The state of compensation at every line of a file.

    Attributes:
        code: 40, 41 or 42 in force.
        here: whether the line itself says one.
        d: D number in force, -1 for none.
        table: see `Table`.
        letter: of the words that number offsets.
        skewed: with another number a straight block runs from the old offset to the new one.
        mm: what 1 of an offset is, mm.
    """

    code: Ints
    here: Bools
    d: Ints
    table: Table
    letter: str = "D"
    skewed: bool = False
    mm: float = 0.001


@dataclass(frozen=True, slots=True, eq=False)
class Runs:
    """The motions in compensation, in the order of the file, a row each.

    Attributes:
        line: of each motion. of: for each line of the file its row here, else -1.
        role, shift, d, run: as in `ir.programmed.PROGRAMMED`.
        cuts: a line that is no move even if it stands alone between two pauses.
    """

    line: Ints
    of: Ints
    role: Ints
    shift: NDArray[np.float64]
    d: Ints
    run: Ints
    cuts: Bools


def runs_of(r: Reading, rows: Ints, motion: Ints, still: Bools, modes: Modes) -> Runs | None:
    """Return the motions in compensation, and report where it cannot be followed.

    Args:
        r: takes the findings.
        rows: lines with a motion, in order.
        motion: G code of each, 0 to 3.
        still: motions of length 0; they are none.
        modes: at every line.
    """
    rows, motion = rows[~still], motion[~still]
    code, d = modes.code[rows], modes.d[rows]
    on = code != OFF
    _tell_numbers(r, rows, on, d, modes)
    given = {n: modes.table(n) or 0.0 for n in set(d.tolist())}
    offset = np.array([given[n] for n in d.tolist()], np.float64)
    on &= offset > 0
    before = np.zeros(len(rows), bool)
    before[1:] = on[:-1]
    leads_in, leads_out = on & ~before, ~on & before

    def tell(mask: Bools, template: str, hint: str) -> None:
        r.tell_lines(Severity.ERROR, "compensation-place", rows[mask], template, hint=hint)

    change = np.zeros(len(rows), bool)
    change[1:] = on[1:] & before[1:] & (code[1:] != code[:-1])
    tell(change, "G41 and G42 change places without G40", "G40 on a line before the other side")
    other = np.zeros(len(rows), bool)
    other[1:] = (code[1:] != OFF) & before[1:] & (d[1:] != d[:-1]) & ~change[1:]
    switched_off = np.cumsum(modes.here & (modes.code == OFF))[rows]
    again = np.zeros(len(rows), bool)
    again[1:] = on[1:] & before[1:] & (switched_off[1:] != switched_off[:-1])
    tell(again, "no motion stands between G40 and this line", "lead out on a straight line, G01")
    _tell_changes(r, rows, other, leads_in, motion, modes, d, offset)
    tell(leads_in & (motion >= 2), "compensation is switched on in an arc", _LEADS)
    tell(leads_out & (motion >= 2), "compensation is switched off in an arc", _LEADS)
    tell(on & (motion == 0), "G00 while compensation is on", _LEADS)
    alone = leads_in.copy()
    alone[:-1] &= ~on[1:]
    tell(
        alone,
        "no motion follows the lead-in while compensation is on",
        "the outline stands between the line with G41 or G42 and the line with G40",
    )
    inside = on | leads_out
    which = np.flatnonzero(inside)
    if not len(which):
        return None
    line = rows[which]
    of = np.full(r.lines, -1, np.int64)
    of[line] = np.arange(len(which))
    role = np.where(leads_in, int(Role.LEAD_IN), int(Role.CONTOUR))
    role = np.where(leads_out, int(Role.LEAD_OUT), role)[which]
    side = np.where(code == LEFT, 1.0, -1.0)
    run = np.cumsum(leads_in) - 1
    return Runs(
        line=line,
        of=of,
        role=role,
        shift=np.where(on, side * offset, 0.0)[which],
        d=np.where(on, d, -1)[which],
        run=run[which],
        cuts=(on | modes.here[rows])[which],
    )


def answers(numbers: list[int]) -> str:
    """Return how the entries of some numbers are given.

    >>> answers([0, 2])
    '--d 0=0mm --d 2=0.1mm'
    """
    return " ".join(f"--d {n}={0.1 if n else 0:g}mm" for n in numbers)


def _tell_numbers(r: Reading, rows: Ints, on: Bools, d: Ints, modes: Modes) -> None:
    """Report motions whose D is missing or not in the table, once for each number."""
    first = np.zeros(len(rows), bool)
    first[np.unique(np.where(on, d, -2), return_index=True)[1]] = True
    none = rows[on & first & (d < 0)]
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        none,
        "G41 or G42 without a {letter}: the file does not say by how much",
        hint="{letter} with the number of the offset, such as G41 {letter}1",
        letter=modes.letter,
    )
    where = np.flatnonzero(on & first & (d >= 0))
    where = where[[modes.table(n) is None for n in d[where].tolist()]]
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        rows[where],
        "no offset was given for {letter}{number}",
        lambda i: {"number": int(d[where[i]])},
        hint="give what is entered at the controller, such as {answers}",
        letter=modes.letter,
        answers=answers(np.unique(d[where]).tolist()),
    )


def _tell_changes(
    r: Reading,
    rows: Ints,
    other: Bools,
    leads_in: Bools,
    motion: Ints,
    modes: Modes,
    d: Ints,
    offset: NDArray[np.float64],
) -> None:
    """Report another number of an offset while G41 or G42 is in force.

    Args:
        rows: lines with a motion.
        other: of these, which have another number than the one before, in compensation.
        leads_in: at which compensation begins; it does so too where the offset before was 0.
        motion, d, offset: of each.
    """
    n, code = modes.letter, modes.code[rows]
    askew = leads_in.copy()
    askew[:1] = False
    askew[1:] &= (code[:-1] == code[1:]) & (d[:-1] != d[1:]) & (d[:-1] >= 0)
    if modes.skewed:
        arc = other & (motion >= 2)
        askew |= other & ~arc & (offset > 0)
        r.tell_lines(
            Severity.ERROR,
            "compensation-place",
            rows[arc],
            "another {letter} in an arc while compensation is on",
            hint="the other {letter} in front of a straight line, or behind G40",
            letter=n,
        )
    else:
        known = [name for name in names() if builtin(name).iso.offset_change == "skewed"]
        r.tell_lines(
            Severity.ERROR,
            "compensation-place",
            rows[other],
            "another {letter} while compensation is on: no source says how the controller goes on",
            hint="G40 before the other {letter}; or, where the controller runs from the one offset "
            'to the other, offset_change = "skewed" in its profile ({profiles})',
            letter=n,
            profiles=known,
        )
    skew = np.flatnonzero(askew)
    r.tell_lines(
        Severity.WARNING,
        "iso-offsets",
        rows[skew],
        "{letter}{number} = {offset_mm:.4f} mm after {letter}{before} = {before_mm:.4f} mm: along "
        "this block the wire runs askew, from the one offset to the other",
        lambda i: {
            "number": int(d[skew[i]]),
            "offset_mm": float(offset[skew[i]] * modes.mm),
            "before": int(d[skew[i] - 1]),
            "before_mm": float(offset[skew[i] - 1] * modes.mm),
        },
        letter=n,
        hint="G40 before the other number keeps the wire parallel",
    )
