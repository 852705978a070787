"""Lines that a profile puts around an ISO program: what of them no proof would see.

Header and footer are free, and are decoded and proven with the program. But what stands behind M02
is run by no reader, and by some controllers (GRBL); and of an open parenthesis, or of a % inside a
program, each controller makes something else.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from wedmcam.formats import iso

#: Text in a line: in parentheses, and behind a semicolon that ends no block.
_BRACKETS = re.compile(r"\([^()]*\)")
_TEXT = re.compile(r"\([^()]*\)|;.*")
_WORD = re.compile(r"([A-Z])([-+]?[\d.]*)")
#: Letters of words that move nothing, whatever their number.
_QUIET = frozenset("FSTEDH")
#: M words with which a controller that goes on behind M02 would call or turn the part.
_MOVING = frozenset(iso.SUBPROGRAMS + iso.TURNS)
#: Codes of header modes: how exactly the path is run, and what F is.
_EXACT, _FEED = {"61", "64"}, {"93", "94", "95"}


def code_of(line: str, semicolon: str) -> str:
    """Return a line without its text, in capitals and without blanks: what a controller counts.

    Args:
        line: of a header, a footer or a program.
        semicolon: what stands behind one, ``Iso.semicolon``: with "block" it is no text.

    >>> code_of("g40 (ON) ; off", ""), code_of("M02; g00 x5", "block")
    ('G40', 'M02;G00X5')
    """
    text = _BRACKETS if semicolon == "block" else _TEXT
    return "".join(text.sub("", line).split()).upper()


def behind_end(footer: Sequence[str], semicolon: str) -> list[str]:
    """Return the words of a footer that are not run.

    Args:
        footer, semicolon: of a profile; see `code_of`.

    >>> behind_end(["M30", "N9 M81 (WIRE OFF)", "%"], ""), behind_end(["g 00 x5;M02"], "block")
    (['M81'], ['G00', 'X5'])
    """
    words = []
    for line in footer:
        for letter, number in _WORD.findall(code_of(line, semicolon)):
            ends = letter == "M" and _whole(number) in iso.ENDS
            if not ends and letter not in "NO":  # numbers of lines and programs do nothing
                words.append(letter + number)
    return words


def _whole(number: str) -> int:
    """Return a code as a number; -1 where it is none."""
    return int(number) if number.isdecimal() else -1


def _moves(word: str) -> bool:
    """Return whether a controller that goes on behind M02 would move by a word, or change modes."""
    letter, number = word[0], word[1:]
    return letter not in _QUIET and (letter != "M" or _whole(number) in _MOVING)


def modes(header: Sequence[str], feed: bool, semicolon: str) -> list[tuple[str, str]]:
    """Return the codes that a header leaves in force and no proof sees, each with what it does.

    Args:
        header: lines in front of a program; of codes of one kind the last counts.
        feed: the program holds F.
        semicolon: see `code_of`.

    >>> modes(["G61 G64 P0.5", "G93 G94"], True, ""), modes(["G40;G64"], False, "block")
    ([('G64', 'the controller may round corners')], [('G64', 'the controller may round corners')])
    """
    text = " ".join(code_of(line, semicolon) for line in header)
    codes = re.findall(r"G0*(6[14]|9[345])(?![\d.])", text)
    exact = [code for code in codes if code in _EXACT]
    fed = [code for code in codes if code in _FEED]
    doubts = []
    if exact and exact[-1] == "64":
        doubts.append(("G64", "the controller may round corners"))
    if feed and fed and fed[-1] != "94":
        doubts.append((f"G{fed[-1]}", "F is no length a minute"))
    return doubts


def metric(header: Sequence[str], semicolon: str) -> bool:
    """Return whether a header says that lengths are mm: G21 or G71, and no other behind it.

    Args:
        header, semicolon: of a profile; see `code_of`.

    >>> metric(["G90", "G21 (MM)"], ""), metric(["G21", "G70"], ""), metric(["G40;G71"], "")
    (True, False, False)
    """
    text = " ".join(code_of(line, semicolon) for line in header)
    return re.findall(r"G0*(2[01]|7[01])(?![\d.])", text)[-1:] in (["21"], ["71"])


def faults(header: Sequence[str], footer: Sequence[str], semicolon: str) -> list[tuple[str, str]]:
    """Return what is wrong with header and footer: which of them, and why.

    Args:
        header, footer, semicolon: of a profile; see `code_of`.

    >>> faults(["%", "(PLATE 7)", "G21"], ["M30", "%"], "")
    []
    >>> faults(["(PLATE"], ["G00 X0"], "")[0][0], faults(["G21", "%"], [], "")[0][0]
    ('header', 'header')
    """
    problems = []
    for key, lines, at in (("header", header, 0), ("footer", footer, len(footer) - 1)):
        for n, line in enumerate(lines):
            rest = code_of(line, semicolon)
            if "(" in rest or ")" in rest:
                why = f"'{line}': a parenthesis is open: to some controllers all behind it is text"
                problems.append((key, why))
            elif re.fullmatch(r"[%;]*%[%;]*", rest) and n != at:
                where = "first in a header" if key == "header" else "last in a footer"
                problems.append((key, f"'%' may end a program: it stands {where}"))
    moves = [word for word in behind_end(footer, semicolon) if _moves(word)]
    if moves:
        why = f"'{' '.join(moves)}' stands behind M02: some controllers stop there, others go on"
        problems.append(("footer", why))
    return problems
