"""Words that change no path, and which of their letters do: G04, G53 to G59, G91.1, C001."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity
from wedmcam.formats import iso
from wedmcam.frontends.iso.reading import Reading
from wedmcam.frontends.iso.words import Words

Bools = NDArray[np.bool_]

#: G64 with P or Q up to this rounds a path no more than machines do anyway, mm [R].
MOST_ROUNDED = 0.05


def take_dwells(r: Reading) -> None:
    """Take the time behind G04 (X, U, P, F or S) out of the words: it is no place and no call."""
    w = r.words
    dwell = (w.letter == ord("G")) & w.good & ~w.pointed & (w.whole == 4)
    if not dwell.any():
        return
    here = np.zeros(r.lines, bool)
    here[w.line[dwell]] = True
    of = here[w.line]
    time = of & w.good & np.isin(w.letter, np.frombuffer(b"XUPFS", np.uint8))
    places = of & np.isin(w.letter, np.frombuffer(b"XYIJRUV", np.uint8))
    many = np.bincount(w.line[places], minlength=r.lines)
    other = places & (~time | (many[w.line] > 1))
    other |= of & (w.letter == ord("G")) & ((w.whole <= 3) | (w.whole == 92))
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        other,
        "{words}: a place or a motion in a line with G04: which one is the time is not known",
        hint="G04 in a line of its own",
    )
    r.words = w.without_words(time)


def take_tolerances(r: Reading) -> Bools:
    """Take P and Q behind G64 out: how far the machine may round the path (LinuxCNC), and no call.

    Up to `MOST_ROUNDED` it is how exactly the machine runs, as steps are; beyond it another path.

    Returns:
        The lines that say it.
    """
    w = r.words
    blends = (w.letter == ord("G")) & w.good & ~w.pointed & (w.whole == 64)
    here = np.zeros(r.lines, bool)
    if not blends.any():
        return here
    here[w.line[blends]] = True
    m = (w.letter == ord("M")) & w.good & ~w.pointed
    here[w.line[m & np.isin(w.whole, iso.SUBPROGRAMS)]] = False
    rounds = here[w.line] & w.good & ((w.letter == ord("P")) | (w.letter == ord("Q")))
    inches = ((w.letter == ord("G")) & ~w.pointed & np.isin(w.whole, (20, 70))).any()
    most = MOST_ROUNDED / (25.4 if inches else 1)
    far = rounds & (w.whole / 10.0**w.decimals > most)
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        far,
        "{words}: G64 lets the machine round the path so far: above {most_mm} mm it is another one",
        hint="G61, or a smaller P",
        most_mm=MOST_ROUNDED,
    )
    r.words = w.without_words(rounds)
    stated = np.zeros(r.lines, bool)
    stated[w.line[rounds]] = True
    return stated


def dotted_codes(r: Reading) -> Bools:
    """Return which codes with a point change nothing: G17.1 where no arc is, and G61.1.

    LinuxCNC's handbook: G61.1 stops exactly at each point. G17.1 is the plane of U and V.
    """
    w = r.words
    found: Bools = (w.letter == ord("G")) & w.good & w.pointed & (w.decimals == 1)
    if not found.any():
        return found
    arcs = (w.letter == ord("G")) & ~w.pointed & np.isin(w.whole, (2, 3))
    found &= ((w.whole == 171) & (not arcs.any())) | (w.whole == 611)
    return found


def moving_frames(r: Reading, work: Bools) -> Bools:
    """Return which of G53 to G59 may move the path, and report them.

    One work offset in front of every place is where the part stands on the table; the machine
    knows how far another one lies from it. G53 counts in a line with a place alone.
    """
    w = r.words
    if not work.any():
        return work
    places = np.zeros(r.lines, bool)
    places[w.line[np.isin(w.letter, np.frombuffer(b"XYIJR", np.uint8))]] = True
    reset = (w.letter == ord("G")) & ~w.pointed & (w.whole == 92)
    first = int(np.argmax(places)) if places.any() else r.lines
    offsets = work & (w.whole > 53)
    rows = np.flatnonzero(offsets)
    machine = work & (w.whole == 53) & places[w.line]
    late: Bools = np.zeros(len(w.line), bool)
    if len(rows):
        late = offsets & (w.whole != w.whole[rows[0]])
        late |= offsets & (w.line[rows[0]] > first)
        zero = np.zeros(r.lines, bool)
        zero[w.line[reset]] = True
        late |= offsets & (w.line[rows[0]] == first) & zero[w.line]
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        machine,
        "{words}: a place of the machine: where the part stands on it is not in the file",
        hint="leave the move out; the program starts where the wire is threaded",
    )
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        late,
        "{words}: another work offset, or one behind the first place: how far it lies is not in "
        "the file",
        hint="one program for each work offset, or one offset in front of all places",
    )
    late |= machine
    return late


def condition_words(w: Words) -> Bools:
    """Return which C words name a condition of the generator, as C001 does, and turn no axis.

    Three digits or more without sign and point, in a line that goes nowhere [R]: C90 turns by 90.
    """
    found: Bools = (w.letter == ord("C")) & ~w.pointed & (w.whole >= 0) & (w.end - w.start >= 4)
    if not found.any():
        return found
    goes = np.isin(w.letter, np.frombuffer(b"XYIJRZUVABKW", np.uint8))
    goes |= (w.letter == ord("G")) & (w.whole <= 3)
    found &= ~np.isin(w.line, w.line[goes])
    return found
