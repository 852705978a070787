"""Lines that a profile puts around an ISO program: what of them no proof would see.

Header and footer are free, and are decoded and proven with the program. But what stands behind M02
is run by no reader, and by some controllers (GRBL); and of an open parenthesis, or of a % inside a
program, each controller makes something else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

#: Text in a line: in parentheses, or behind a semicolon.
_TEXT = re.compile(r"\([^()]*\)|;.*")
_WORD = re.compile(r"[A-Z][-+]?[\d.]*")
#: What stands behind an end without doing anything: numbers of lines and programs, ends.
_IDLE = re.compile(r"[NO][\d.]*|M0*(?:2|30)")
#: Words with which a controller that goes on behind M02 would move, or change what it goes on with:
#: codes, places, and M words that turn the part or call (`formats.iso`).
_MOVES = re.compile(r"[^FSTEDHM].*|M0*(?:60|7\d|9[789]|19[89])")


def behind_end(footer: Sequence[str]) -> list[str]:
    """Return the words of a footer that are not run.

    >>> behind_end(["M30", "N9 M81 (WIRE OFF)", "%"]), behind_end(["g 00 x5"])
    (['M81'], ['G00', 'X5'])
    """
    lines = (re.sub(r"\s", "", _TEXT.sub("", line)).upper() for line in footer)
    words = [word for line in lines for word in _WORD.findall(line)]
    return [word for word in words if not _IDLE.fullmatch(word)]


def modes(header: Sequence[str], feed: bool) -> list[tuple[str, str]]:
    """Return the codes that a header leaves in force and no proof sees, each with what it does.

    Args:
        header: lines in front of a program; of codes of one kind the last counts.
        feed: the program holds F.

    >>> modes(["G61 G64 P0.5", "G93 G94"], True)
    [('G64', 'the controller may round corners')]
    """
    text = re.sub(r"\s", "", " ".join(_TEXT.sub("", line) for line in header)).upper()
    last = {}
    for code in re.findall(r"G0*(6[14]|9[345])(?![\d.])", text):
        last[code[0]] = code
    found = []
    if last.get("6") == "64":
        found.append(("G64", "the controller may round corners"))
    if feed and last.get("9", "94") != "94":
        found.append((f"G{last['9']}", "F is no length a minute"))
    return found


def faults(header: Sequence[str], footer: Sequence[str]) -> list[tuple[str, str]]:
    """Return what is wrong with header and footer: which of them, and why.

    >>> faults(["%", "(PLATE 7)", "G21"], ["M30", "%"])
    []
    >>> faults(["(PLATE"], ["G00 X0"])[0][0], faults(["G21", "%"], [])[0][0]
    ('header', 'header')
    """
    found = []
    for key, lines, at in (("header", header, 0), ("footer", footer, len(footer) - 1)):
        for n, line in enumerate(lines):
            rest = _TEXT.sub("", line)
            if "(" in rest or ")" in rest:
                why = f"'{line}': a parenthesis is open: to some controllers all behind it is text"
                found.append((key, why))
            elif re.fullmatch(r"[\s%]*%[\s%]*", rest) and n != at:
                where = "first in a header" if key == "header" else "last in a footer"
                found.append((key, f"'%' may end a program: it stands {where}"))
    moves = [word for word in behind_end(footer) if _MOVES.fullmatch(word)]
    if moves:
        why = f"'{' '.join(moves)}' stands behind M02: some controllers stop there, others go on"
        found.append(("footer", why))
    return found
