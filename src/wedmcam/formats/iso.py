"""ISO G-code of wire EDM: which words mean what, for reader and writer.

A record states where it ends, and an arc its centre (I, J from the start) or its radius; the
controller interpolates point by point between. Lengths with a point are mm; whole numbers are what
the profile says. What is neither motion, mode, pause nor end is never dropped in silence.
Marks: [S] published rule, [R] our decision.

Where an arc ends [R]: the controller steps round the circle of the start until it stands on the
stated end. Where the stepped circle passes beside the end (centre and end are rounded), it leaves
at the place nearest to the end and goes the last micron or two straight. An end farther from the
circle than `END_UM` is an error: there is no telling what a controller would cut.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

#: How far a stated end may lie from the circle of its arc, um [R]. Start, end and centre rounded
#: to a micron make 2.3 at most; controllers refuse from 2 to 5 on.
END_UM = 5.0

#: Codes with a digit behind the point are counted in tenths: G91.1 is 911.
PER_CODE = 10
#: G04, a wait, and modes in which a wire machine that is not told otherwise already is: nothing of
#: the path changes.
NOTHING_NEW = (4, 17, 61, 64, 80, 94, 95)
#: The like of them with a point, in tenths: G17.1 and G61.1 (``frontends.iso.codes``).
NOTHING_NEW_TENTHS = (171, 611)
#: G codes that the reader runs, in tenths: they lead somewhere, or say where that is.
LEADING = frozenset(
    PER_CODE * n for n in (*range(4), 20, 21, 40, 41, 42, *range(53, 60), 70, 71, 90, 91, 92)
) | {901, 911}
#: G codes that the reader knows to change no path, in tenths.
IDLE = frozenset({*(PER_CODE * n for n in NOTHING_NEW), *NOTHING_NEW_TENTHS})
PAUSES = (0, 1)
ENDS = (2, 30)
#: Ends a main program of Sodick, as M02 does [github.com/Meconer/SodickDXFCoder writes either].
END_OF_LABELS = 199
#: M codes that call or end a subprogram: M97 of Haas, M98 and M99 of all, M198 and M199 of an
#: outer or a later one. M98 and M99 are run (``frontends.iso.subprograms``), others are refused.
SUBPROGRAMS = (97, 98, 99, 198, 199)
#: M codes after which the same words may be another path: M60 turns the part at Makino, M70 to M73
#: save and restore modes at LinuxCNC, the others of M7x are the builder's [R]. A profile that names
#: one says what it does there.
TURNS = (60, *range(70, 80))

#: nanometres of one unit with a point.
NM_OF_MM = 1_000_000
NM_OF_INCH = 25_400_000


def is_word(text: str) -> bool:
    """Return whether a control word can stand in a program and be read as that word.

    >>> is_word("M50"), is_word("M00"), is_word("M98"), is_word("QUENCH")
    (True, False, False, False)
    """
    match = re.fullmatch(r"M(\d{1,4})", text)
    other = PAUSES + ENDS + SUBPROGRAMS + TURNS
    return bool(match) and int(match[1]) not in other if match else False


def in_words(tenths: Iterable[int]) -> str:
    """Return some G codes, counted in tenths, as text; three and more in a row become a range.

    >>> in_words([0, 10, 20, 170, 171, 200, 210])
    'G00 to G02, G17, G17.1, G20, G21'
    """
    rows: list[list[int]] = []
    for code in sorted(tenths):
        if rows and code == rows[-1][-1] + PER_CODE and code % PER_CODE == 0:
            rows[-1].append(code)
        else:
            rows.append([code])
    words = []
    for row in rows:
        named = [f"G{n // PER_CODE:02d}" + (f".{n % PER_CODE}" * (n % PER_CODE > 0)) for n in row]
        words += [f"{named[0]} to {named[-1]}"] if len(row) > 2 else named
    return ", ".join(words)


#: The G codes that the reader knows where no profile is named, for people.
KNOWN = in_words(LEADING | IDLE)
