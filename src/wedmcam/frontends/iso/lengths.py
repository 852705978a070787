"""What the numbers of an ISO text are in nm, and whether a place or a way: as said, or asked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity
from wedmcam.formats import iso
from wedmcam.frontends.iso import dialect as dialects
from wedmcam.frontends.iso.dialect import UNSAID
from wedmcam.frontends.iso.reading import Reading
from wedmcam.machines import Known

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: What 1 is in a number without a point, nm: in mm and in inches.
_DIGITS = {
    "um": (1000, dialects.INCH_DIGIT_NM),
    "0.0001in": (1000, dialects.INCH_DIGIT_NM),
    "mm": (iso.NM_OF_MM, iso.NM_OF_INCH),
    "inch": (iso.NM_OF_MM, iso.NM_OF_INCH),
}
#: Coordinates beyond this are an error, nm: a kilometre.
MOST_NM = 10**12


def lengths_of(
    r: Reading,
    axes: dict[str, tuple[Ints, Bools, Bools, Ints]],
    inches: Ints,
    used: tuple[Bools, Bools],
    stop_line: int,
) -> dict[str, Ints]:
    """Return the lengths of each letter in nm; 0 where there are none.

    ``used``: the lines whose X and Y lead somewhere, and those whose I, J and R do.
    """
    dialect, how = r.dialect, r.machine.iso
    um = how.integers == "um"
    in_inch = (inches == 1) | ((inches == UNSAID) & (point_nm(r, UNSAID) == iso.NM_OF_INCH))
    systems = [inches == UNSAID, inches == 1]
    point = np.select(systems, [point_nm(r, k) for k in (UNSAID, 1)], point_nm(r, 0))
    # What nothing says is an error below; here it needs a value.
    digits = [digit_nm(r, k) or dialects.INCH_DIGIT_NM for k in (UNSAID, 1, 0)]
    last = np.select(systems, digits[:2], digits[2])
    out = {}
    bare = np.zeros(r.lines, bool)
    some_pointed = False
    for name, (value, has, pointed, decimals) in axes.items():
        unit = np.where(pointed, point, last)
        exact = value.astype(np.float64) * unit / 10.0**decimals
        large = np.abs(exact) > MOST_NM
        r.tell_lines(
            Severity.ERROR,
            "over-limit",
            np.flatnonzero(large),
            "{letter} is larger than a kilometre",
            letter=name,
        )
        safe = np.where(large, 0, value)
        # Exact in integers: 12 digits of inch do not fit, so whole and fraction apart.
        scale = 10**decimals
        q, rest = np.divmod(safe, scale)
        nm = q * unit + (rest * unit + scale // 2) // scale
        out[name] = np.where(large | ~has, 0, nm)
        bare |= has & ~pointed & (value != 0)
        some_pointed |= bool(np.any(has & pointed))
    if not dialect.named or dialect.leaves or dialect.units_nm is not None:
        _ask_units(r, inches, in_inch, used, stop_line)
    if dialect.is_open(None, "integers") or dialect.whole_nm is not None:
        return out
    units = how.integers in ("mm", "inch")  # a controller that counts units in one system
    for inch, system, answer in (
        (1, "inches", "inch" if units else "0.0001in"),
        (0, "mm", "mm" if units else "um"),
    ):
        of = [k for k in (inch, UNSAID) if digit_nm(r, k) is None and (k == inch or inch == 1)]
        mixed = bare & np.isin(inches, of)
        r.tell_lines(
            Severity.ERROR,
            "iso-units",
            np.flatnonzero(mixed),
            "a whole number in {system}: the file does not say what its last digit is",
            hint="write {system} with a point, or give --whole-in {answer}",
            system=system,
            answer=answer,
        )
    if some_pointed and bare.any() and um and not how.words:
        r.tell_lines(
            Severity.WARNING,
            "iso-units",
            np.flatnonzero(bare & ~in_inch),
            "whole numbers are read as um here, and others in this file have a point: mm",
            hint='if they are mm, give --whole-in mm, or a profile of integers = "mm" (iso-mm)',
        )
    return out


def point_nm(r: Reading, inch: int) -> int:
    """Return what 1 is in a number with a point, nm; ``inch``: 1 in G20, 0 in G21, or UNSAID."""
    if inch != UNSAID:
        return iso.NM_OF_INCH if inch == 1 else iso.NM_OF_MM
    if r.dialect.units_nm is not None:
        return r.dialect.units_nm
    inches = r.dialect.named and r.machine.iso.points == "inch"
    return iso.NM_OF_INCH if inches else iso.NM_OF_MM


def digit_nm(r: Reading, inch: int) -> int | None:
    """Return what 1 is in a number without a point, nm; None where a named profile does not say.

    A profile says it in its own system of units. In the other one it is the like of it, um and
    0.0001 in, or mm and inch, where the profile lists the code that changes the system.
    """
    dialect, how = r.dialect, r.machine.iso
    if dialect.whole_nm is not None:
        return dialect.whole_nm
    if dialect.is_open(None, "integers"):
        in_inch = inch == 1 or (inch == UNSAID and point_nm(r, UNSAID) == iso.NM_OF_INCH)
        return dialects.INCH_DIGIT_NM if in_inch else _DIGITS[how.integers][0]
    of_inch = how.integers in ("inch", "0.0001in")
    if inch == UNSAID:
        if dialect.units_nm is None:
            return _DIGITS[how.integers][of_inch]
        inch = int(dialect.units_nm == iso.NM_OF_INCH)
    codes = (200, 700) if inch == 1 else (210, 710)
    knows = any(how.words.class_of("G", code) is Known.PATH for code in codes)
    return _DIGITS[how.integers][inch] if knows or of_inch == bool(inch) else None


def _ask_units(
    r: Reading, inches: Ints, in_inch: Bools, used: tuple[Bools, Bools], stop_line: int
) -> None:
    """Ask for units that nothing says, and warn of an answer that the file gives otherwise."""
    w, dialect = r.words, r.dialect
    lengths = w.good & (w.whole != 0) & (w.line <= stop_line)
    letters = [np.isin(w.letter, np.frombuffer(k, np.uint8)) for k in (b"XY", b"IJR")]
    lengths &= (letters[0] & used[0][w.line]) | (letters[1] & used[1][w.line])
    if dialect.is_open(dialect.whole_nm, "integers"):
        whole = np.flatnonzero(lengths & ~w.pointed)
        r.questions += dialects.of_whole(
            whole, w, r.plain, in_inch[w.line[whole]], r.machine.iso.integers
        )
    if dialect.is_open(dialect.units_nm, "points"):
        unsaid = np.flatnonzero(lengths & w.pointed & (inches[w.line] == UNSAID))
        r.questions += dialects.of_units(unsaid, w, r.plain)
    elif dialect.units_nm is not None:
        pointed = np.flatnonzero(lengths & w.pointed)
        stated = inches[w.line[pointed]]
        if len(pointed) and not (stated == UNSAID).any():
            nm = np.where(stated == 1, iso.NM_OF_INCH, iso.NM_OF_MM)
            other = w.line[pointed[nm != dialect.units_nm]][:1]
            r.tell_stated(other, "G20 or G21", "--units-in")


def distance_of(r: Reading, stated: Ints, moves: Bools, stop_line: int) -> Ints:
    """Return 90 or 91 for every line, as the file, an option or the profile says, or ask."""
    dialect, profile = r.dialect, r.machine.iso.coordinates
    incremental = (dialect.coordinates or profile) == "incremental"
    out = np.where(stated == UNSAID, 91 if incremental else 90, stated)
    if dialect.coordinates is None and not dialect.is_open(None, "coordinates"):
        return out
    lines = np.flatnonzero(moves[: stop_line + 1])
    unsaid = stated[lines] == UNSAID
    if dialect.coordinates is None:
        r.questions += dialects.of_coordinates(lines[unsaid], r.words, r.plain, incremental)
    elif len(lines) and not unsaid.any():
        other = lines[stated[lines] != (91 if incremental else 90)]
        if len(other) == len(lines):
            code = f"G{stated[lines[0]]}"
            r.tell_stated(other[:1], code, f"--coordinates-in {dialect.coordinates}")
    return out
