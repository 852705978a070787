"""Which profiles know the words of a G-code program: what its style is, never what its machine is.

Words of generator, tank and wire differ from maker to maker, and so do subprograms and tables. What
a profile names stands in its own tables and keys (``machines``); here they are counted in a text.
"""

from __future__ import annotations

import re

from wedmcam import machines
from wedmcam.formats.iso import IDLE, LEADING, PER_CODE
from wedmcam.machines import Known, Machine
from wedmcam.machines.vocabulary import OWN

#: So much of a text is looked at, from its start and from its end: words of a machine stand there.
_HEAD, _TAIL = 200_000, 50_000
#: Letters of words that differ from maker to maker. F, L and P mean too many things.
_WORD = re.compile(rb"(?<![A-Z])([CEGMQST]) *(\d{1,5})(?:\.(\d))?(?![\d.])")
_CALL = re.compile(rb"(?<![A-Z])M *98(?!\d)[^\n;]*?P *0*(\d+)")
#: The number of a program, in a line of its own in front of all others.
_NUMBER = re.compile(rb"[\s%]*(L) *(\d{1,5}) *(?=\n|;|$)")
_ENDED = re.compile(rb";[ \r]*$", re.MULTILINE)
#: So many features must speak for a profile.
LEAST = 2
#: So many words are named.
NAMED = 4

Word = tuple[str, int]


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
    >>> style_of(b"G01 X5.0\nM02\n")
    ''
    """
    if len(codes) > _HEAD + _TAIL:
        codes = codes[:_HEAD] + b"\n" + codes[-_TAIL:]
    words = _words(codes)
    known: dict[str, list[str]] = {}
    score: dict[str, int] = {}
    for machine in map(machines.builtin, machines.names()):
        how = machine.iso
        if not machine.is_of("iso") or not how.words:
            continue
        named = [word for word in words if _knows(machine, word, codes)]
        features = bool(offset_word) and how.offset_word == offset_word
        score[machine.name] = (
            2 * len(named) - len(words) + features + (ended and how.semicolon == "block")
        )
        known[machine.name] = [_text(word) for word in named]
    best = max(score.values(), default=0)
    of = [name for name, points in score.items() if points == best and known[name]]
    if best < LEAST or not of:
        return ""
    shown = known[of[0]][:NAMED]
    more = len(known[of[0]]) - len(shown)
    rest = f" and {more} more" if more else ""
    what = "profile that knows its words" if len(of) == 1 else "profiles that know its words"
    return f"{what}: {' and '.join(of)} ({', '.join(shown)}{rest})"


def lines_end(codes: bytes) -> bool:
    r"""Return whether most lines of a text end with a semicolon.

    >>> lines_end(b"G90;\nG01 X5.0;\nM02\n"), lines_end(b"G90\nG01 X5.0 ; to the left\n")
    (True, False)
    """
    head = codes[:_HEAD]
    return len(_ENDED.findall(head)) * 2 > head.count(b"\n")


def _words(codes: bytes) -> list[Word]:
    """Return the different words of makers in a text, in tenths, in order."""
    found = {
        (letter.decode(), int(number) * PER_CODE + int(tenth or b"0"))
        for letter, number, tenth in _WORD.findall(codes)
    }
    if number := _NUMBER.match(codes):
        found.add((number[1].decode(), int(number[2]) * PER_CODE))
    common = {*OWN, *(("G", n) for n in LEADING | IDLE)}
    return sorted(found - common)


def _knows(machine: Machine, word: Word, codes: bytes) -> bool:
    """Return whether a profile names a word; of a call, whether it runs what stands there."""
    known = machine.iso.words.class_of(*word)
    if word != ("M", 98 * PER_CODE):
        return known is not Known.NOT
    letter = {"N-label": b"N", "O-number": b"O"}.get(machine.iso.subprograms)
    if known is not Known.PATH or letter is None:
        return False
    called = set(_CALL.findall(codes))
    return any(re.search(rb"(?<![A-Z])%s *0*%s(?!\d)" % (letter, n), codes) for n in called)


def _text(word: Word) -> str:
    letter, tenths = word
    digits = {"C": 3, "M": 2, "G": 2, "L": 3}.get(letter, 1)
    whole, tenth = divmod(tenths, PER_CODE)
    return f"{letter}{whole:0{digits}d}" + (f".{tenth}" if tenth else "")
