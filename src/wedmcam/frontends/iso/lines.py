"""What every line of an ISO text says: its places, the modes in force there, its M words and calls.

Codes are sorted by what they do; what stands in a line and does nothing, or nothing that is known,
is reported here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity
from wedmcam.formats import iso
from wedmcam.frontends.iso.centres import CODES, Rules
from wedmcam.frontends.iso.codes import condition_words, dotted_codes, moving_frames
from wedmcam.frontends.iso.known import tell_unknown, unlisted, vocabulary_of
from wedmcam.frontends.iso.reading import Reading
from wedmcam.machines import Known

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
#: What a mode is set to at every line, and the lines that set it.
Mode = tuple[Ints, Bools]

#: Motion behind G80, which ends the one before.
NO_MOTION = -80
#: Hint for words that are left out.
_AT_MACHINE = "feed, generator and offset tables are set at the machine"


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """What every line says, and what is in force there.

    Attributes:
        axes: of X, Y, I, J and R, as of `reading.column`.
        motion: G code in force, `UNSAID` for none, `NO_MOTION` behind G80.
        distance: 90 or 91 in force, or `UNSAID`.
        inches: 1 in inches, 0 in mm, or `UNSAID`.
        reset: whether the line sets where the wire stands, and goes nowhere.
        rules: from where I and J count.
    """

    axes: dict[str, tuple[Ints, Bools, Bools, Ints]]
    motion: Ints
    distance: Ints
    inches: Ints
    reset: Bools
    rules: Rules

    @property
    def has(self) -> dict[str, Bools]:
        """Which lines have a letter."""
        return {k: column[1] for k, column in self.axes.items()}


@dataclass(frozen=True, slots=True, eq=False)
class Codes:
    """Which words of a text are codes that are run, and what they do.

    Attributes:
        number: digits of each word.
        g, m: G and M codes, which are whole numbers.
        rule: G90.1 and G91.1, which say what I and J are.
        dotted: other codes with a point; they change nothing.
        classes: what the profile says of each word (`Known`).
        modal: words of each group of modes: motion, centres, distance, inch, comp, g92.
    """

    number: Ints
    g: Bools
    m: Bools
    rule: Bools
    dotted: Bools
    classes: NDArray[np.int8]
    modal: dict[str, Bools]

    @property
    def switches_on(self) -> Bools:
        """Which words switch compensation on: G41 and G42."""
        mask: Bools = self.modal["comp"] & (self.number != 40)
        return mask


def codes_of(r: Reading, classes: NDArray[np.int8]) -> Codes:
    """Return the codes that are run, and report words that are no numbers or no codes.

    ``classes``: what the profile says of each word.
    """
    w = r.words
    g, m = w.letter == ord("G"), w.letter == ord("M")
    whole = w.good & ~w.pointed & (w.whole >= 0)
    err = Severity.ERROR
    r.tell_words(err, "iso-word", ~w.good, "{words}: no number that can be read behind the letter")
    # Codes with a point: G90.1 and G91.1, and some that change nothing.
    rule = g & w.good & w.pointed & np.isin(w.whole, list(CODES)) & (w.decimals == 1)
    dotted = dotted_codes(r)
    refused, foreign = classes == Known.REFUSED, unlisted(r, classes, g & w.good)
    r.tell_words(
        err,
        "iso-word",
        w.good & (g | m) & ~whole & ~rule & ~dotted & ~refused & ~foreign,
        "{words}: a code is a whole number",
    )
    tell_unknown(
        r,
        err,
        "iso-code",
        foreign,
        "{words}: a code that the profile {machine} does not name",
        hint="name another profile, or take it out where it changes no path",
        machine=r.machine.name,
    )
    runs = ~refused & ~foreign
    g, m, rule, dotted = g & whole & runs, m & whole & runs, rule & runs, dotted & runs
    number = w.whole
    modal = {
        "motion": g & (number <= 3),
        "centres": rule,
        "distance": g & ((number == 90) | (number == 91)),
        "inch": g & np.isin(number, (20, 21, 70, 71)),
        "comp": g & (number >= 40) & (number <= 42),
        "g92": g & (number == 92),
    }
    return Codes(number, g, m, rule, dotted, classes, modal)


def modes_by_line(r: Reading, codes: Codes) -> dict[str, Mode]:
    """Return what each group of modes is set to, and report a second code of one in a line.

    Motions are 0 to 3 or `NO_MOTION`, inch is 1 or 0, centres are in tenths; others are G codes.
    """
    modes = {}
    for name, mask in codes.modal.items():
        words = np.flatnonzero(mask)
        lines = r.words.line[words]
        twice = np.zeros(len(mask), bool)
        twice[words[1:][lines[1:] == lines[:-1]]] = True
        r.tell_words(
            Severity.ERROR,
            "iso-word",
            twice,
            "{words}: a second code of the same kind in one line",
        )
        number, has = np.zeros(r.lines, np.int64), np.zeros(r.lines, bool)
        number[lines], has[lines] = codes.number[words], True
        modes[name] = number, has
    inch, states = modes["inch"]
    modes["inch"] = ((inch % 50 == 20) & states).astype(np.int64), states
    _end_motion(r.words.line[codes.g & (codes.number == 80)], *modes["motion"])
    return modes


def _end_motion(lines: Ints, motion: Ints, has: Bools) -> None:
    """End the motion in force where G80 stands alone: the next place needs a word of its own.

    LinuxCNC's handbook: G80 is of the group of G00 to G03, and a place while it is in force is an
    error. Other controllers go on in the old motion.
    """
    alone = lines[~has[lines]]
    motion[alone], has[alone] = NO_MOTION, True


def tell_codes(r: Reading, codes: Codes, tolerances: Bools) -> None:
    """Report codes that change nothing, may round corners, or are not known.

    ``tolerances``: the lines that say how far G64 may round.
    """
    w, g, number = r.words, codes.g, codes.number
    work = g & (number >= 53) & (number <= 59)
    idle = g & np.isin(number, iso.NOTHING_NEW)
    rounds = g & (number == 64) & ~tolerances[w.line]
    work_idle = work & ~moving_frames(r, work)
    places = codes.rule & (number == 901)
    quiet = (idle | codes.dotted | codes.rule | work_idle) & ~places & ~rounds
    r.tell_words(
        Severity.NOTE,
        "iso-ignored",
        places,
        "{words}: I and J are the place of the centre from here on",
    )
    r.tell_words(Severity.NOTE, "iso-ignored", quiet, "{words}: nothing of the path changes by it")
    r.tell_words(
        Severity.WARNING,
        "iso-ignored",
        rounds,
        "{words}: the machine may round corners; the path is read as if it did not",
        hint="G61, or G64 with a small P",
    )
    known = work | idle
    for mask in codes.modal.values():
        known |= mask
    tell_unknown(
        r,
        Severity.ERROR,
        "iso-code",
        g & ~known,
        "{words}: a code that is not known here and may change the path",
        hint="known are {known}",
        known=iso.KNOWN,
    )


def calling_words(r: Reading, codes: Codes, ends: tuple[int, ...]) -> Ints:
    """Return the words that call a subprogram, as rows, and report words that nothing reads.

    ``ends``: the M codes that end the program, and call nothing.
    """
    w = r.words
    names = b"GMXYIJRNDH" if codes.switches_on.any() else b"GMXYIJRN"
    other = w.good & ~_is_one_of(r, names) & (codes.classes != Known.REFUSED)
    third = other & _is_one_of(r, b"ZUVABCKW") & (w.whole != 0)
    third &= ~(other & condition_words(w))
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        third,
        "{words}: an axis or a taper; programs here are flat",
    )
    calls = other & _is_one_of(r, b"LP")
    feed = other & (w.letter == ord("F")) & bool(r.machine.iso.feed_um)
    r.tell_words(
        Severity.NOTE, "iso-ignored", feed, "{words}: the cutting speed: it changes no path"
    )
    _tell_others(r, other & ~third & ~calls & ~feed & (codes.classes != Known.PATH))
    calls |= codes.m & np.isin(codes.number, iso.SUBPROGRAMS) & ~np.isin(codes.number, ends)
    return np.flatnonzero(calls)


def _is_one_of(r: Reading, letters: bytes) -> Bools:
    """Return which words have one of some letters."""
    return np.isin(r.words.letter, np.frombuffer(letters, np.uint8))


def _tell_others(r: Reading, mask: Bools) -> None:
    """Report words that are left out, and that no profile which was named knows."""
    if vocabulary_of(r):
        tell_unknown(
            r,
            Severity.WARNING,
            "unknown-word",
            mask,
            "{words}: no word of the profile {machine}; left out: nothing is known of it",
            hint=_AT_MACHINE,
            machine=r.machine.name,
        )
    else:
        tell_unknown(
            r,
            Severity.WARNING,
            "iso-ignored",
            mask,
            "{words}: not read: it changes no path",
            hint=_AT_MACHINE,
        )


def first_move(
    axes: dict[str, tuple[Ints, Bools, Bools, Ints]], motion: Ints, reset: Bools
) -> Bools:
    """Return the line that tells the start of a program: its first motion, a G00 to X and Y."""
    x, y = axes["X"][1], axes["Y"][1]
    out = np.zeros(len(motion), bool)
    first = np.flatnonzero(x | y)[:1]
    out[first] = (x & y & (motion == 0) & ~reset)[first]
    return out
