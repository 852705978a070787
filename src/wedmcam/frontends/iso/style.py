"""Which profiles know the words of a G-code program: what its style is, never what its machine is.

Words of generator, tank and wire differ from maker to maker, and so do subprograms and tables. What
a profile names stands in its own tables and keys (``machines``); here they are counted in a text.
"""

from __future__ import annotations

import re

import numpy as np

from wedmcam.formats.iso import IDLE, LEADING, PER_CODE
from wedmcam.machines import Known, Machine, builtin, iso_profiles
from wedmcam.machines.vocabulary import OWN

#: So much of a text is looked at, from its start and from its end: words of a machine stand there.
_HEAD, _TAIL = 200_000, 50_000
#: Letters of words that differ from maker to maker. F, L and P mean too many things.
_WORD = re.compile(rb"(?<![A-Z])([CEGMQST]) *(\d{1,5})(?:\.(\d))?(?![\d.])")
_CALL = re.compile(rb"(?<![A-Z])M *98(?!\d)[^\n;PM]*P *(\d{1,9})")
#: Labels of subprograms: what opens a line, N or O.
_LABEL = re.compile(rb"(?:^|;)[ /%]*([NO]) *(\d{1,9})", re.MULTILINE)
#: The number of a program, in a line of its own in front of all others.
_NUMBER = re.compile(rb"[\s%]*(L) *(\d{1,5}) *(?=\n|;|$)")
_ENDED = re.compile(rb";[ \r]*$", re.MULTILINE)
#: Style of subprograms -> letter of their labels.
_LETTERS = {"N-label": b"N", "O-number": b"O"}
#: So many features must speak for a profile.
LEAST = 2
#: So many words are named.
NAMED = 4
#: So many different words are counted: a machine has some dozens, and codes of tools are many.
MOST = 1000

#: The letter and the number in tenths.
Word = tuple[str, int]
_CALLS: Word = ("M", 98 * PER_CODE)


def style_of(codes: bytes, offset_word: str = "", ended: bool = False) -> str:
    r"""Return which profiles know the words of a text best, in a clause; empty where none does.

    Args:
        codes: a text of ``frontends.plain`` without its comments.
        offset_word: letter of the offsets that the file sets itself.
        ended: its lines end with a semicolon; see `lines_end`.

    >>> style_of(b"T84\nC001\nM98 P0001\nM02\nN0001\nM99\n")
    'profile that knows its words: sodick (C001, M98, M99, T84)'
    >>> style_of(b"%\nL002\nN5 G90\n", offset_word="H")
    'profile that knows its words: mitsubishi (L002)'
    >>> style_of(b"G21 G17 G40 G80 G61 G91.1 G94\nG90\n")
    'profiles that open programs so: grbl and linuxcnc'
    >>> style_of(b"G01 X5.0\nM02\n")
    ''
    """
    if len(codes) > _HEAD + _TAIL:
        codes = codes[:_HEAD] + b"\n" + codes[-_TAIL:]
    if opens := iso_profiles(lambda m: _opens(codes, m.iso.modes)):
        return f"profiles that open programs so: {' and '.join(opens)}"
    words = _words(codes)
    if not words:
        return ""
    called = _called(codes)
    letters = np.array([ord(letter) for letter, _ in words], np.uint8)
    tenths = np.array([number for _, number in words])
    known: dict[str, list[str]] = {}
    score: dict[str, int] = {}
    for machine in map(builtin, iso_profiles(lambda m: bool(m.iso.words))):
        how = machine.iso
        classes = how.words.classes[how.words.entries_of(letters, tenths)]
        named = [
            word
            for word, class_ in zip(words, classes.tolist(), strict=True)
            if class_ != Known.NOT and (word != _CALLS or _runs(machine, class_, called))
        ]
        features = bool(offset_word) and how.offset_word == offset_word
        score[machine.name] = (
            2 * len(named) - len(words) + features + (ended and how.semicolon == "block")
        )
        known[machine.name] = [words[word] for word in named]
    best = max(score.values(), default=0)
    of = [name for name, points in score.items() if points == best and known[name]]
    if best < LEAST or not of:
        return ""
    shown = known[of[0]][:NAMED]
    more = len(known[of[0]]) - len(shown)
    rest = f" and {more} more" if more else ""
    what = "profile that knows its words" if len(of) == 1 else "profiles that know its words"
    return f"{what}: {' and '.join(of)} ({', '.join(shown)}{rest})"


def _opens(codes: bytes, modes: str) -> bool:
    """Return whether the modes of a profile stand in a text: three and more are no chance."""
    return modes.count(" ") > 1 and modes.encode() in codes


def lines_end(codes: bytes) -> bool:
    r"""Return whether most lines of a text end with a semicolon.

    >>> lines_end(b"G90;\nG01 X5.0;\nM02\n"), lines_end(b"G90\nG01 X5.0 ; to the left\n")
    (True, False)
    """
    head = codes[:_HEAD]
    return len(_ENDED.findall(head)) * 2 > head.count(b"\n")


def _words(codes: bytes) -> dict[Word, str]:
    """Return the different words of makers in a text, by letter and number, as they first stand.

    At most `MOST` of them.
    """
    common = {*OWN, *(("G", n) for n in LEADING | IDLE)}
    found: dict[Word, str] = {}
    first = _NUMBER.match(codes)
    if first:
        found[first[1].decode(), int(first[2]) * PER_CODE] = _plain(first[0])
    for m in _WORD.finditer(codes):
        word = m[1].decode(), int(m[2]) * PER_CODE + int(m[3] or b"0")
        if word not in common and word not in found:
            found[word] = _plain(m[0])
            if len(found) == MOST:
                break
    return dict(sorted(found.items()))


def _plain(word: bytes) -> str:
    return word.translate(None, b" %\r\n\t").decode()


def _called(codes: bytes) -> set[bytes]:
    """Return the letters of labels that a call of the text finds."""
    numbers = {int(n) for n in _CALL.findall(codes)}
    return (
        {letter for letter, n in _LABEL.findall(codes) if int(n) in numbers} if numbers else set()
    )


def _runs(machine: Machine, class_: int, called: set[bytes]) -> bool:
    """Return whether a profile runs the subprograms that a text calls."""
    return class_ == Known.PATH and _LETTERS.get(machine.iso.subprograms) in called
