"""One ISO text while it is read: its words, its lines as columns, and findings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, Severity
from wedmcam.diag.lists import Listing
from wedmcam.formats.listing import Values, in_order, listed
from wedmcam.frontends.iso.dialect import Dialect, Question, completed
from wedmcam.frontends.iso.offsets import tables_of
from wedmcam.frontends.iso.words import Words, with_numbers, words_of
from wedmcam.frontends.text import Plain, TextSpans, plain
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: So many different words are named in one finding; others are counted.
NAMED = 24
#: Codes of findings on a path: another unit or rule has others.
_DEPEND = frozenset({"iso-arc", "iso-end", "over-limit"})


class Reading:
    """Findings of one text, and its lines as columns.

    ``user_dialect`` is what the user says beside the text, ``dialect`` that with what its profile
    says.
    """

    def __init__(self, data: bytes, machine: Machine, file: str, dialect: Dialect) -> None:
        self.plain: Plain = plain(data)
        self.file, self.user_dialect = file, dialect
        self.dialect, closed = completed(dialect, machine.iso)
        self.machine = replace(machine, iso=closed)
        codes, self.entries, self.conditions = tables_of(with_numbers(self.plain.codes))
        self.words: Words = words_of(codes, self.dialect.semicolon == "block")
        self.lines = len(self.words.line_start)
        self.titles = self.words.titles()
        if len(self.titles):
            self.words = self.words.without(self.titles)
        size = np.maximum(self.words.line_end - self.words.line_start, 1).astype(np.int32)
        self.spans = TextSpans(file, self.plain.codes, self.words.line_start, size)
        self.findings: list[tuple[int, Diagnostic]] = []
        self.questions: list[Question] = []
        self.bad: Bools = np.zeros(self.lines, bool)
        #: How subprograms are run, as the user or the profile says; None where neither does.
        self.subprograms: str | None = self.dialect.subprograms
        #: Of each line that is run its line in the text; None where that is the same.
        self.order: Ints | None = None
        #: Calls are not run: what is found on the path is another's.
        self.unrun = False
        self._ends = self.words.line_end
        self._first_run = np.zeros(0, np.int64)

    def run_in(self, order: Ints) -> None:
        """Put lines of the text in the order in which they are run: often, once, or not at all."""
        self.order = order
        self._first_run = np.full(self.lines, len(order) - 1)
        self._first_run[order[::-1]] = np.arange(len(order))[::-1]
        self.words = self.words.in_order(order)
        self.bad = self.bad[order]
        self.lines = len(order)
        size = np.maximum(self.words.line_end - self.words.line_start, 1).astype(np.int32)
        self.spans = TextSpans(self.file, self.plain.codes, self.words.line_start, size)

    def line_of(self, at: int) -> int:
        """Return the line of a character, as it is first run; the last line for one in none."""
        line = int(np.searchsorted(self._ends, at))
        return line if self.order is None else int(self._first_run[line])

    def tell_words(
        self,
        severity: Severity,
        code: str,
        mask: Bools,
        template: str,
        hint: str | None = None,
        **values: object,
    ) -> None:
        """Report words, warnings with every different word and how often it stands there.

        ``{words}`` of the template is the word of an error, and the words of a warning. The lines
        of errors are not read.
        """
        w = self.words
        where = np.flatnonzero(mask)
        if severity is Severity.ERROR:
            self.bad[w.line[where]] = True
        where = self.once(where)
        if severity is not Severity.ERROR:
            if len(where):
                at, end = int(w.start[where[0]]), int(w.end[where[0]])
                finding = Diagnostic(
                    severity,
                    code,
                    template,
                    self.spans.at(at, end - at),
                    hint_template=hint,
                    count=len(where),
                    values={"words": self.named(where), **values},
                )
                self.findings.append((at, finding))
            return
        for i, d in listed(
            severity,
            code,
            where,
            lambda i: self.spans.at(int(w.start[i]), int(w.end[i] - w.start[i])),
            template,
            lambda i: {
                "words": Listing([self.plain.excerpt(int(w.start[i]), int(w.end[i]))]),
                **values,
            },
            hint,
        ):
            self.findings.append((int(w.start[i]), d))

    def once(self, where: Ints) -> Ints:
        """Return some words without those that stand in the same place of the text, run again."""
        if self.order is None:
            return where
        return where[np.unique(self.words.start[where], return_index=True)[1]]

    def named(self, where: Ints) -> Listing:
        """Return the different ones of some words, in their order, each with its count."""
        w, where = self.words, self.once(where)
        # Letter, digits and decimals as one number: 12 digits leave room for both.
        key = (w.whole[where] * 16 + np.minimum(w.decimals[where], 15)) * 128 + w.letter[where]
        _, first, many = np.unique(key, return_index=True, return_counts=True)
        order = np.argsort(first)
        named = [
            self.plain.excerpt(int(w.start[i]), int(w.end[i])) + (f" ({n} times)" if n > 1 else "")
            for i, n in zip(
                where[first[order[:NAMED]]].tolist(), many[order].tolist(), strict=False
            )
        ]
        rest = int(many[order[NAMED:]].sum())
        return Listing(named, unnamed=rest)

    def tell_lines(
        self,
        severity: Severity,
        code: str,
        where: Ints,
        template: str,
        values: Values | None = None,
        hint: str | None = None,
        **common: object,
    ) -> None:
        """Report lines; of warnings the first, with how many there are.

        Args:
            severity, code, template, hint: of the findings.
            where: the lines.
            values: of a line, by its index in ``where``.
            common: values of all of them.
        """
        places = np.arange(len(where))
        if self.order is not None:  # once for each line of the text
            places = np.unique(self.order[where], return_index=True)[1]
        quiet = severity is not Severity.ERROR and len(places) > 1
        for i, d in listed(
            severity,
            code,
            places,
            lambda i: self.spans[int(where[i])],
            template,
            lambda i: {**common, **(values(i) if values is not None else {})},
            hint,
        ):
            finding = d.extended(" ({count} lines)") if quiet else d
            self.findings.append((int(self.words.line_start[where[i]]), finding))
        if severity is Severity.ERROR:
            self.bad[where] = True

    def sorted_findings(self) -> list[Diagnostic]:
        """Return all findings: what had to be assumed or asked first, then the others by place."""
        shown = self.dialect.shown
        questions = [
            q.finding(self.spans, shown) for q in sorted(self.questions, key=lambda q: q.at)
        ]
        findings = in_order(self.findings)
        if (questions and not shown) or self.unrun:  # what depends on the answers is said with them
            findings = [d for d in findings if d.code not in _DEPEND]
        return [*questions, *findings]

    def tell_stated(self, line: Ints, word: str, option: str) -> None:
        """Warn that the file says itself, and otherwise, what an option says."""
        self.tell_lines(
            Severity.WARNING,
            "iso-stated",
            line,
            "{word} is in force here: {option} says otherwise, and has no effect",
            hint="leave {option} out, or correct the program",
            word=word,
            option=option,
        )


def filled(values: Ints, has: Bools, start: int) -> Ints:
    """Return a mode for every line: the last one that was set."""
    last = np.maximum.accumulate(np.where(has, np.arange(len(has)), -1))
    return np.where(last >= 0, values[np.maximum(last, 0)], start)


def column(r: Reading, letter: str) -> tuple[Ints, Bools, Bools, Ints]:
    """Return for each line the digits of a word, whether it is there, pointed, its decimals."""
    w = r.words
    mask = (w.letter == ord(letter)) & w.good
    lines = w.line[mask]
    twice = np.zeros(len(w.line), bool)
    twice[np.flatnonzero(mask)[1:][lines[1:] == lines[:-1]]] = True
    r.tell_words(
        Severity.ERROR, "iso-word", twice, "{words}: a second {letter} in one line", letter=letter
    )
    value, decimals = np.zeros(r.lines, np.int64), np.zeros(r.lines, np.int64)
    has, pointed = np.zeros(r.lines, bool), np.zeros(r.lines, bool)
    # Nine decimals are a thousandth of a nanometre of an inch; further ones are rounded away.
    over = np.maximum(w.decimals[mask] - 9, 0)
    value[lines], has[lines] = (w.whole[mask] + 10**over // 2) // 10**over, True
    pointed[lines], decimals[lines] = w.pointed[mask], w.decimals[mask] - over
    return value, has, pointed, decimals


class ArcTeller:
    """Collects findings about arcs; about one with an error no more."""

    def __init__(self, r: Reading, lines: Ints) -> None:
        self.reading, self._lines = r, lines

    def tell(
        self,
        mask: Bools,
        template: str,
        values: Values | None = None,
        hint: str | None = None,
        **common: object,
    ) -> None:
        """Report arcs of ``mask`` that have no error yet, by their numbers."""
        where = np.flatnonzero(mask & ~self.reading.bad[self._lines])
        self.reading.tell_lines(
            Severity.ERROR,
            "iso-arc",
            self._lines[where],
            template,
            (lambda i: values(int(where[i]))) if values is not None else None,
            hint,
            **common,
        )
