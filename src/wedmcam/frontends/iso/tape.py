"""What of an ISO file is run at all: from the number of the program to its end.

A percent sign opens a tape and the next one ends it; M02 and M30 end the program before. What
stands behind was never run by any machine, so nothing of it is read, but where the program calls
subprograms: they stand there, and are found by ``subprograms``. The number of a program
(``O1234``, ``:1234``, ``L002``) is its name, and no call.

Sources: Fanuc's operator's manuals (O in EIA code, a colon in ISO code, and the four digits that
follow it are the number); for L002 programs of Mitsubishi machines.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from wedmcam.diag import Severity, warning
from wedmcam.frontends.iso.reading import Reading
from wedmcam.frontends.iso.subprograms import ends_of


def take_end(r: Reading, by_word: bool = True) -> None:
    """Take what stands behind the end of the program out, and say how much of it moves.

    ``by_word``: M02 and M30 end it, as a percent sign does: no subprograms stand behind them.
    """
    w = r.words
    m = (w.letter == ord("M")) & w.good & ~w.pointed & np.isin(w.whole, ends_of(r.subprograms))
    first = w.start[w.letter != ord("N")][:1]  # a number may stand in front of the opening sign
    ends = w.percents[w.percents > first[0]][:1] if len(first) else w.percents[:0]
    by = "%"
    end = int(ends[0]) if len(ends) else len(r.plain.codes)
    stop = np.flatnonzero(m)[:1]
    if by_word and len(stop) and int(w.start[stop[0]]) < end:
        end = int(w.line_end[w.line[stop[0]]])
        by = r.plain.excerpt(int(w.start[stop[0]]), int(w.end[stop[0]]))
    gone = w.start >= end
    torn = ~gone & (w.end > end)  # a number with a percent sign in it
    if not gone.any() and not torn.any() and not len(w.stray):
        return
    goes = np.isin(w.letter, np.frombuffer(b"XYIJR", np.uint8))
    late = np.unique(w.line[gone & goes])
    if len(late):
        at = int(w.start[gone & goes][0])
        finding = warning(
            "after-end",
            "{blocks} blocks behind the end ({end}): not run"
            if len(late) > 1
            else "a block behind the end ({end}): not run",
            r.spans.at(at),
            hint="one program a file",
            blocks=len(late),
            end=by,
        )
        r.findings.append((at, finding))
    last = int(np.searchsorted(w.line_end, end))
    r.words = replace(
        w.without_words(gone),
        stray=w.stray[w.stray < end],
        skipped=w.skipped[w.skipped <= last],
        good=w.good[~gone] & ~torn[~gone],
    )
    r.titles = r.titles[r.titles <= last]


def take_number(r: Reading) -> None:
    """Take the number of the program out, where it is the first word of the file."""
    w = r.words
    if not len(w.letter) or w.letter[0] not in b"OL" or not w.good[0] or w.pointed[0]:
        return
    alone = len(w.line) == 1 or w.line[1] > w.line[0]
    if w.letter[0] == ord("L") and not alone:
        return
    first = np.zeros(len(w.line), bool)
    first[0] = True
    r.tell_words(
        Severity.NOTE, "iso-ignored", first, "{words}: the number of the program: its name"
    )
    r.words = w.without_words(first)
