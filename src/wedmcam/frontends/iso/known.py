"""Which words of an ISO text its profile knows, and which profiles know the others.

What a profile calls harmless is left out with one note, what it refuses is an error in its own
words; a word that it does not name is not known there. Without words in the profile, or without a
profile, what reads a text knows M00, M01, M02, M30 and the codes that it runs.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Severity, note
from wedmcam.diag.lists import Listing
from wedmcam.formats.iso import IDLE, PER_CODE
from wedmcam.frontends.iso.reading import NAMED, Reading
from wedmcam.frontends.iso.words import Words
from wedmcam.machines import Known, Vocabulary, knowing
from wedmcam.machines.vocabulary import NO_CODE

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Letters of words that no profile needs to name.
_PLACES = np.frombuffer(b"XYIJRN", dtype=np.uint8)


def vocabulary_of(r: Reading) -> Vocabulary:
    """Return the words that count: of the profile where one was named."""
    return r.machine.iso.words if r.dialect.named else Vocabulary()


def tenths_of(w: Words, rows: Ints) -> Ints:
    """Return the numbers of some words in tenths, `NO_CODE` for what no code has.

    G91.1 is 911; a minus and a second digit behind the point are of no code.
    """
    whole, decimals = w.whole[rows], w.decimals[rows]
    fits = w.good[rows] & (whole >= 0) & (decimals <= 1)
    return np.where(fits, np.where(decimals == 1, whole, whole * PER_CODE), NO_CODE)


def take_known(r: Reading) -> NDArray[np.int8]:
    """Take the harmless words of the profile out, and report them and the refused ones.

    Returns:
        The class of each word that is left (`Known`).
    """
    w, words = r.words, vocabulary_of(r)
    classes: NDArray[np.int8] = np.zeros(len(w.letter), np.int8)
    if not words:
        return classes
    rows = np.flatnonzero(~np.isin(w.letter, _PLACES) & w.good)
    entry = words.entries_of(w.letter[rows], tenths_of(w, rows))
    classes[rows] = words.classes[entry]
    texts = words.texts
    harmless = classes == Known.HARMLESS
    _tell_harmless(r, rows, entry, harmless, texts)
    refused = classes[rows] == Known.REFUSED
    calls = (classes == Known.REFUSED) & (w.letter == ord("M")) & np.isin(w.whole, (98, 99))
    for one in np.unique(entry[refused]).tolist():
        mask = np.zeros(len(classes), bool)
        mask[rows[entry == one]] = True
        r.tell_words(
            Severity.ERROR,
            "iso-code",
            mask,
            "{words}: {meaning}",
            hint="the profile {machine} refuses it; --subprograms-in N-label or --subprograms-in "
            "O-number runs it, where the file has its subprograms"
            if (calls & mask).any()
            else "the profile {machine} refuses it; take it out where it changes no path",
            meaning=texts[one],
            machine=r.machine.name,
        )
    _tell_owners(r, harmless)
    gone = harmless
    if calls.any():  # what is found on a path without them is another's
        r.unrun = True
        here = np.zeros(r.lines, bool)
        here[w.line[calls]] = True
        gone = harmless | (here[w.line] & np.isin(w.letter, np.frombuffer(b"PL", np.uint8)))
    r.words = w.without_words(gone)
    left: NDArray[np.int8] = classes[~gone]
    return left


def _tell_owners(r: Reading, harmless: Bools) -> None:
    """Report places in a line with a harmless code that may own them: ``G28 X0 Y0``.

    A mode (G61, G94) owns none, and a line that says its motion or G92 gives them to it.
    """
    w = r.words
    g = (w.letter == ord("G")) & w.good
    rows = np.flatnonzero(g & harmless)
    rows = rows[~np.isin(tenths_of(w, rows), list(IDLE))]
    if not len(rows):
        return
    here = np.zeros(r.lines, bool)
    here[w.line[rows]] = True
    here[w.line[g & ~w.pointed & ((w.whole <= 3) | (w.whole == 92))]] = False
    places = here[w.line] & np.isin(w.letter, np.frombuffer(b"XYIJR", np.uint8))
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        places,
        "{words}: a place in a line with a code that is left out: it may be a motion, or belong to "
        "the code",
        hint="say the motion on this line, or give the code a line of its own",
    )


def _tell_harmless(
    r: Reading, rows: Ints, entry: Ints, harmless: Bools, texts: tuple[str, ...]
) -> None:
    """Report the words that are left out: one note, with what each of them does."""
    mine = harmless[rows]
    if not mine.any():
        return
    w = r.words
    found, first = np.unique(entry[mine], return_index=True)
    every = r.once(rows[mine])
    meanings = [
        f"{r.named(rows[entry == one])}: {texts[one]}" for one in found[np.argsort(first)].tolist()
    ]
    at, end = int(w.start[every[0]]), int(w.end[every[0]])
    finding = note(
        "iso-harmless",
        "{meanings} (left out, as the profile {machine} says)",
        r.spans.at(at, end - at),
        count=len(every),
        meanings=Listing(meanings, between="; "),
        machine=r.machine.name,
    )
    r.findings.append((at, finding))


def unlisted(r: Reading, classes: NDArray[np.int8], codes: Bools) -> Bools:
    """Return which of some G codes a profile that lists its codes does not list."""
    none = np.zeros(len(classes), bool)
    return codes & (classes == Known.NOT) if vocabulary_of(r).lists_codes else none


#: Hint for words that built-in profiles know.
_KNOWN_BY = (
    "profiles that know the word: {profiles}; --profile-in NAME takes it as that machine does"
)


def tell_unknown(
    r: Reading,
    severity: Severity,
    code: str,
    mask: Bools,
    template: str,
    hint: str,
    **values: object,
) -> None:
    """Report words with the built-in profiles that know them; ``hint`` is for where none does."""
    profiles = profiles_that_know(r, mask)
    if profiles:
        r.tell_words(severity, code, mask, template, _KNOWN_BY, profiles=profiles, **values)
    else:
        r.tell_words(severity, code, mask, template, hint, **values)


def profiles_that_know(r: Reading, mask: Bools) -> Listing:
    """Return the built-in profiles whose tables name some words, each with those that it names."""
    w, rows = r.words, np.flatnonzero(mask)
    if not len(rows):
        return Listing([])
    tenths = tenths_of(w, rows)
    # Number and letter as one, as `Reading.named` has it.
    key = tenths * 128 + w.letter[rows]
    first = np.sort(np.unique(key, return_index=True)[1])[:NAMED]
    of: dict[str, list[str]] = {}
    for i in first.tolist():
        row = int(rows[i])
        word = r.plain.excerpt(int(w.start[row]), int(w.end[row]))
        for name in knowing(chr(w.letter[row]), int(tenths[i])):
            if not (r.dialect.named and name == r.machine.name):
                of.setdefault(name, []).append(word)
    ranked = sorted(of, key=lambda name: (-len(of[name]), name))
    return Listing([f"{name} ({', '.join(of[name])})" for name in ranked], between="; ")
