"""Read ISO G-code: words in any spelling, modal or not, absolute or not, into stepped blocks.

All lines are read at once: modes are filled forward, positions summed, and only what is wrong is
looked at one by one. Positions are summed in nanometres and put on the grid afterwards, so that
small increments add up. A word that is not understood is an error where it could change the path,
else a warning; nothing is dropped in silence.

Where the controller offsets the path itself (G41, G42), `read` gives the outline as it stands there
with the offsets of a table; what the controller makes of it is for the shell to apply. `decode`
reads programs that need no table. What a file does not say itself, and who says it: `dialect`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, FileSpan, Severity, error, note, warning
from wedmcam.formats import b3, iso
from wedmcam.formats.listing import in_order, listed
from wedmcam.frontends import dialect as dialects
from wedmcam.frontends.compensation import Modes, Runs, Table, runs_of
from wedmcam.frontends.dialect import UNSAID, Dialect, Question
from wedmcam.frontends.offsets import tables_of
from wedmcam.frontends.plain import Plain, TextSpans, plain
from wedmcam.frontends.words import Words, words_of
from wedmcam.ir.program import BLOCK, Axis, Kind, Program
from wedmcam.ir.programmed import PROGRAMMED, Programmed
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

#: Coordinates beyond this are an error, nm: a kilometre.
_MOST_NM = 10**12
#: So many different words are named in one finding; others are counted.
NAMED = 24
#: Codes of findings on a path: another unit or rule has others.
_DEPEND = frozenset({"iso-arc", "iso-end", "over-limit"})


class _Reader:
    """Findings of one text, and its lines as columns."""

    def __init__(self, data: bytes, machine: Machine, file: str, dialect: Dialect) -> None:
        self.plain: Plain = plain(data)
        self.machine, self.file, self.dialect = machine, file, dialect
        codes, self.entries, self.conditions = tables_of(self.plain.codes)
        self.words: Words = words_of(codes, dialect.semicolon == "block")
        self.lines = len(self.words.line_start)
        self.titles = self.words.titles()
        if len(self.titles):
            self.words = self.words.without(self.titles)
        size = np.maximum(self.words.line_end - self.words.line_start, 1).astype(np.int32)
        self.spans = TextSpans(file, self.plain.codes, self.words.line_start, size)
        self.found: list[tuple[int, Diagnostic]] = []
        self.questions: list[Question] = []
        self.bad: Bools = np.zeros(self.lines, bool)

    def tell_words(
        self, severity: Severity, code: str, mask: Bools, why: str, hint: str | None = None
    ) -> None:
        """Report words, warnings with every different word and how often it stands there.

        The lines of errors are not read.
        """
        w = self.words
        where = np.flatnonzero(mask)
        if severity is not Severity.ERROR:
            if len(where):
                at, end = int(w.start[where[0]]), int(w.end[where[0]])
                what = f"{self._named(where)}: {why}"
                place = self.spans.at(at, end - at)
                count = len(where)
                self.found.append(
                    (at, Diagnostic(severity, code, what, place, hint=hint, count=count))
                )
            return
        for i, d in listed(
            severity,
            code,
            where,
            lambda i: self.spans.at(int(w.start[i]), int(w.end[i] - w.start[i])),
            lambda i: f"{self.plain.excerpt(int(w.start[i]), int(w.end[i]))}: {why}",
            hint,
        ):
            self.found.append((int(w.start[i]), d))
        self.bad[w.line[where]] = True

    def _named(self, where: Ints) -> str:
        """Return the different ones of some words, in their order, each with its count."""
        w = self.words
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
        return ", ".join(named) + (f" and {rest} more" if rest else "")

    def tell_lines(
        self,
        severity: Severity,
        code: str,
        where: Ints,
        message: Callable[[int], str],
        hint: str | None = None,
    ) -> None:
        """Report lines, by index into ``where``; of warnings the first, with how many there are."""
        quiet = severity is not Severity.ERROR and len(where) > 1
        many = f" ({len(where)} lines)" if quiet else ""
        for i, d in listed(
            severity,
            code,
            np.arange(len(where)),
            lambda i: self.spans[int(where[i])],
            lambda i: message(i) + many,
            hint,
        ):
            self.found.append((int(self.words.line_start[where[i]]), d))
        if severity is Severity.ERROR:
            self.bad[where] = True

    def findings(self) -> list[Diagnostic]:
        """Return what was found: what had to be assumed or asked first, then all by its place."""
        questions = sorted(self.questions, key=lambda q: q.at)
        shown = self.dialect.shown
        asked = [q.finding(self.spans, shown) for q in questions]
        found = in_order(self.found)
        if asked and not shown:  # what depends on the answers is said with them
            found = [d for d in found if d.code not in _DEPEND]
        return [*asked, *found]


def _filled(values: Ints, has: Bools, start: int) -> Ints:
    """Return a mode for every line: the last one that was set."""
    last = np.maximum.accumulate(np.where(has, np.arange(len(has)), -1))
    return np.where(last >= 0, values[np.maximum(last, 0)], start)


def decode(
    data: bytes, machine: Machine, file: str, dialect: Dialect | None = None
) -> tuple[Program, list[Diagnostic]]:
    """Return the program that an ISO file states, as its controller steps it.

    Args:
        data: any bytes; never raises.
        machine: an ISO profile: what whole numbers are, and the line table.
        file: name for the spans.
        dialect: what is said beside the file; None: the machine is known, and says it.

    Returns:
        A block a motion, with the micron or two that an arc is completed by as a line of its own;
        M00 and M01 are pauses, M02 and M30 the stop, other M words are kept. A G01 alone between
        two pauses is a move, like G00. ``spans[i]`` is the line. G41 and G42 are refused: where
        they lead depends on a table.
    """
    made, found = read(data, machine, file, dialect=dialect)
    return made.program, found


def read(
    data: bytes,
    machine: Machine,
    file: str,
    table: Table | None = None,
    dialect: Dialect | None = None,
    assumed: bool = False,
) -> tuple[Programmed, list[Diagnostic]]:
    """Return the program of an ISO file, with outlines where the controller is to offset.

    Args:
        data: any bytes; never raises.
        machine: an ISO profile.
        file: name for the spans.
        table: D number -> offset, um, as entered at the controller. A motion whose D is 0 um is
            stepped as it stands. None: G41 and G42 are refused, with the D numbers used, but for
            those of a table in the file (``H001 = 0.14``).
        assumed: the table is taken from a drawing, and was not entered: that of the file wins.
        dialect: as for `decode`.
    """
    r = _Reader(data, machine, file, dialect or Dialect())
    _tell_text(r)
    _take_dwells(r)
    w = r.words
    g, m = w.letter == ord("G"), w.letter == ord("M")
    whole = w.good & ~w.pointed & (w.whole >= 0)
    err, warn = Severity.ERROR, Severity.WARNING
    r.tell_words(err, "iso-word", ~w.good, "no number that can be read behind the letter")
    # G91.1, the only code with a point that is known: I and J lead from the start.
    from_start = g & w.good & w.pointed & (w.whole == 911) & (w.decimals == 1)
    _from_start(r, from_start)
    dotted = _dotted(r)
    r.tell_words(
        err,
        "iso-word",
        w.good & (g | m) & ~whole & ~from_start & ~dotted,
        "a code is a whole number",
    )
    g, m = g & whole, m & whole

    modal: dict[str, tuple[Ints, Bools]] = {}
    for name in ("motion", "distance", "inch", "comp", "g92"):
        modal[name] = (np.zeros(r.lines, np.int64), np.zeros(r.lines, bool))

    def set_mode(name: str, mask: Bools, values: Ints) -> None:
        value, has = modal[name]
        lines = w.line[mask]
        twice = np.zeros(len(w.line), bool)
        again = has[lines]
        again[1:] |= lines[1:] == lines[:-1]
        twice[np.flatnonzero(mask)[again]] = True
        r.tell_words(err, "iso-word", twice, "a second code of the same kind in one line")
        value[lines], has[lines] = values[mask], True

    code = w.whole
    set_mode("motion", g & (code <= 3), code)
    set_mode("distance", g & ((code == 90) | (code == 91)), code)
    inch = g & np.isin(code, (20, 21, 70, 71))
    set_mode("inch", inch, (code % 50 == 20).astype(np.int64))
    comp = g & (code >= 40) & (code <= 42)
    set_mode("comp", comp, code)
    set_mode("g92", g & (code == 92), code)
    work = g & (code >= 53) & (code <= 59)
    known = work | g & ((code <= 3) | np.isin(code, (90, 91, 92)) | inch | comp)
    idle = g & np.isin(code, iso.NOTHING_NEW)
    work_idle = work & ~_moving_frames(r, work)
    quiet = idle | dotted | from_start | work_idle
    r.tell_words(Severity.NOTE, "iso-ignored", quiet, "nothing of the path changes by it")
    r.tell_words(
        err,
        "iso-code",
        g & ~known & ~idle,
        "a code that is not known here and may change the path",
        "known are G00 to G04, G17, G20, G21, G40 to G42, G54 to G59, G70, G71, G80, G90 to G92",
    )
    axes = {k: _column(r, k) for k in "XYIJR"}
    offsets = comp & (code != 40)
    names = b"GMXYIJRNDH" if offsets.any() else b"GMXYIJRN"
    inches = _filled(*modal["inch"], UNSAID)
    modes = _modes(r, modal["comp"], offsets, _Tables(table, assumed, inches))
    other = w.good & ~np.isin(w.letter, np.frombuffer(names, np.uint8))
    condition = other & _conditions(w)
    third = other & np.isin(w.letter, np.frombuffer(b"ZUVABCKW", np.uint8)) & (w.whole != 0)
    third &= ~condition
    r.tell_words(err, "iso-code", third, "an axis or a taper; programs here are flat")
    calls = other & ((w.letter == ord("L")) | (w.letter == ord("P")))
    feed = other & (w.letter == ord("F")) & bool(r.machine.iso.feed_um)
    r.tell_words(Severity.NOTE, "iso-ignored", feed, "the cutting speed: it changes no path")
    r.tell_words(
        warn,
        "iso-ignored",
        other & ~third & ~calls & ~feed,
        "not read: it changes no path",
        "feed, generator and offset tables are set at the machine",
    )
    distance = _filled(*modal["distance"], UNSAID)
    motion = _filled(*modal["motion"], -1)
    reset = modal["g92"][1]
    if r.machine.iso.start == "move":
        reset = reset | _start(axes, motion, reset)
    calls |= m & np.isin(code, iso.SUBPROGRAMS)
    return _program(r, axes, distance, motion, inches, reset, m, np.flatnonzero(calls), modes)


def _from_start(r: _Reader, words: Bools) -> None:
    """Take what G91.1 says of I and J, whatever an option says."""
    if not words.any():
        return
    if r.dialect.centres == "absolute":
        _tell_stated(r, r.words.line[words][:1], "G91.1", "--centres-in")
    r.dialect = replace(r.dialect, centres="start")


def _start(axes: dict[str, tuple[Ints, Bools, Bools, Ints]], motion: Ints, reset: Bools) -> Bools:
    """Return the line that tells the start of a program: its first motion, a G00 to X and Y."""
    x, y = axes["X"][1], axes["Y"][1]
    out = np.zeros(len(motion), bool)
    first = np.flatnonzero(x | y)[:1]
    out[first] = (x & y & (motion == 0) & ~reset)[first]
    return out


def _take_dwells(r: _Reader) -> None:
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
    why = "a place or a motion in a line with G04: which of them is the time cannot be told"
    r.tell_words(Severity.ERROR, "iso-code", other, why, "G04 in a line of its own")
    r.words = w.without_words(time)


def _dotted(r: _Reader) -> Bools:
    """Return which codes with a point change nothing: G17.1 where no arc is."""
    w = r.words
    found: Bools = (w.letter == ord("G")) & w.good & w.pointed & (w.decimals == 1)
    if not found.any():
        return found
    arcs = (w.letter == ord("G")) & ~w.pointed & np.isin(w.whole, (2, 3))
    found &= (w.whole == 171) & (not arcs.any())
    return found


def _moving_frames(r: _Reader, work: Bools) -> Bools:
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
        "a place of the machine: where the part stands on it is not in the file",
        "leave the move out; the program starts where the wire is threaded",
    )
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        late,
        "another work offset, or one behind the first place: how far it lies is not in the file",
        "one program for each work offset, or one offset in front of all places",
    )
    late |= machine
    return late


def _conditions(w: Words) -> Bools:
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


@dataclass(frozen=True, slots=True)
class _Tables:
    """What offsets are read by: the table that is given, whether assumed, and the unit a line."""

    given: Table | None
    assumed: bool
    inches: Ints


def _modes(r: _Reader, comp: tuple[Ints, Bools], offsets: Bools, tables: _Tables) -> Modes | None:
    """Return the state of compensation at every line; None where there is none, or no table."""
    _tell_tables(r, bool(offsets.any()))
    if not offsets.any():
        return None
    value, has, pointed, _ = _column(r, "D")
    letter = "D"
    h_value, h_has, h_pointed, _ = _column(r, "H")
    both = np.flatnonzero(h_has) if has.any() else np.zeros(0, np.int64)
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        both,
        lambda i: "D and H both number offsets in this file: which of them counts is nowhere said",
        "leave one of them out",
    )
    if len(both):
        return None
    if h_has.any():
        letter, value, has, pointed = "H", h_value, h_has, h_pointed
    wrong = has & (pointed | (value < 0))
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        np.flatnonzero(wrong),
        lambda i: (
            f"{letter} is the number of an offset in the controller's table: whole, from 0 on"
        ),
        f"{letter} with the number of the offset, such as G41 {letter}1",
    )
    if wrong.any():
        return None
    d = _filled(value, has, -1)
    used: list[int] = np.unique(d[r.words.line[offsets]]).tolist()
    filed = _filed(r, tables.inches, int(r.words.start[np.argmax(offsets)]))
    if filed is None:
        return None
    table = _merged(r, tables, filed, np.unique(d).tolist(), letter)
    missing = [n for n in used if n not in filed] if tables.given is None else []
    if missing:
        given = " ".join(f"--d {max(n, 1)}=0.1mm" for n in missing)
        called = ", ".join(f"no {letter} at all" if n < 0 else f"{letter}{n}" for n in missing)
        r.tell_words(
            Severity.ERROR,
            "iso-compensation",
            offsets,
            f"the controller offsets the path itself, by a table that the file has not ({called})",
            f"give what is entered at the controller: {given}",
        )
        return None
    return Modes(_filled(*comp, 40), comp[1], d, table, letter)


def _tell_tables(r: _Reader, used: bool) -> None:
    """Report tables of a file that change nothing."""
    for a, b in r.conditions[:1]:
        many = f" ({len(r.conditions)} lines)" if len(r.conditions) > 1 else ""
        what = f"{r.plain.excerpt(a, b)}: a table of conditions, not read{many}"
        hint = "feed, generator and offset tables are set at the machine"
        said = warning("iso-ignored", what, r.spans.at(a, b - a), hint=hint)
        r.found.append((a, replace(said, count=len(r.conditions))))
    if r.entries and not used:
        one, size = r.entries[0], len(r.entries)
        what = f"{r.plain.excerpt(one.at, one.end)}: no G41 or G42 uses this table ({size} offsets)"
        place = r.spans.at(one.at, one.end - one.at)
        r.found.append((one.at, note("iso-offsets", what, place, count=size)))


def _filed(r: _Reader, inches: Ints, first_use: int) -> dict[int, float] | None:
    """Return the offsets of the file's own table, number to um; None where it cannot be read.

    ``first_use``: where in the text the first G41 or G42 stands.
    """
    stated = np.unique(inches[inches != UNSAID])
    nm: dict[int, Decimal] = {}
    wrong = False
    for entry in r.entries:
        line = int(np.searchsorted(r.words.line_end, entry.at))
        inch = int(inches[line]) if len(stated) != 1 else int(stated[0])
        point, digit = _entry_units(r, inch)
        value = entry.pointed * point + entry.whole * (digit or 0)
        value += sum(sign * nm.get(n, Decimal(0)) for sign, n in entry.refers)
        unset = [n for _, n in entry.refers if n not in nm]
        problem = None
        if unset:
            problem = f"H{unset[0]} is set nowhere before it"
        elif entry.at > first_use:
            problem = "it is set behind the first G41 or G42: what was in force there is not known"
        elif len(stated) == 2 and inch == UNSAID and (entry.pointed or entry.whole):
            problem = "the file has inches and mm, and neither is in force here"
        elif entry.whole and digit is None:
            problem = "a whole number in inches: what its last digit is stands nowhere"
        elif nm.setdefault(entry.number, value) != value:
            problem = "the offset is set twice, to different values"
        elif value < 0 or value > _MOST_NM:
            problem = "an offset is from 0 to a kilometre; G41 and G42 tell the side"
        place = r.spans.at(entry.at, entry.end - entry.at)
        if problem is not None:
            text = f"{r.plain.excerpt(entry.at, entry.end)}: {problem}"
            hint = "put the table right, in front of the first G41 or G42"
            r.found.append((entry.at, error("iso-d", text, place, hint=hint)))
            wrong = True
    r.questions += dialects.of_table(r.entries, r.dialect, r.plain, bool(len(stated)))
    return None if wrong else {n: float(v / 1000) for n, v in nm.items()}


def _entry_units(r: _Reader, inch: int) -> tuple[int, int | None]:
    """Return what 1 is in a table with a point and without one, nm; None where nothing says it."""
    said = r.dialect
    point = iso.NM_OF_INCH if inch == 1 else iso.NM_OF_MM
    if inch == UNSAID and said.units_nm is not None:
        point = said.units_nm
    if said.whole_nm is not None:
        return point, said.whole_nm
    if point == iso.NM_OF_INCH:
        return point, dialects.INCH_DIGIT_NM if said.is_open(None) else None
    return point, 1000 if r.machine.iso.integers == "um" else iso.NM_OF_MM


def _merged(
    r: _Reader, tables: _Tables, filed: dict[int, float], used: list[int], letter: str
) -> Table:
    """Return the table that counts, and say which it is where the file has one."""
    if not filed:
        return tables.given or filed.get
    step = r.machine.axes.step_um / 1000
    entered = {n: tables.given(n) for n in used} if tables.given is not None else {}
    for n in used:
        mine, other = filed.get(n), entered.get(n)
        if mine is None or (mine == 0 and other is None):
            continue
        entry = next(e for e in r.entries if e.number == n)
        place = r.spans.at(entry.at, entry.end - entry.at)
        what = f"{letter}{n} = {mine * step:.4f} mm, of the table in the file"
        if other is None or abs(other - mine) < 0.05:
            r.found.append((entry.at, note("iso-offsets", what, place)))
            continue
        which = "that of the drawing" if tables.assumed else "--d"
        wins = "the table of the file" if tables.assumed else "--d"
        what += f"; {which} is {other * step:.4f} mm: {wins} counts"
        hint = "see which is entered at the machine"
        r.found.append((entry.at, warning("iso-offsets", what, place, hint=hint)))
    own = {n: um for n, um in filed.items() if tables.assumed or entered.get(n) is None}
    given = tables.given
    return lambda n: own[n] if n in own else given(n) if given is not None else None


def _tell_text(r: _Reader) -> None:
    """Report comments, characters that are no words, and optional blocks."""
    w = r.words
    if w.comments and r.dialect.semicolon is None:
        # No profile says what stands behind a semicolon, but for lines that it writes itself.
        own = r.machine.layout if r.dialect.named else None
        r.questions += dialects.of_semicolons(w, r.plain, own)
    texts = [(a, b) for a, b in w.comments if r.plain.codes[a + 1 : b].strip(b" )")]
    for a, b in texts[:1]:
        many = f" ({len(texts)} comments)" if len(texts) > 1 else ""
        what = f"comment: {r.plain.excerpt(a, b)}{many}"
        r.found.append((a, note("text-skipped", what, r.spans.at(a, b - a), count=len(texts))))
    r.tell_lines(
        Severity.ERROR,
        "iso-word",
        r.titles,
        lambda i: (
            f"line {int(r.titles[i]) + 1} is text, no ISO words: "
            f"{r.plain.excerpt(int(w.line_start[r.titles[i]]), int(w.line_end[r.titles[i]]))}"
        ),
        "put text into brackets: (TITLE); or remove the line",
    )
    if len(w.stray):
        lines = np.unique(np.searchsorted(w.line_end, w.stray))
        first = {
            int(n): int(k) for k, n in zip(w.stray[::-1], lines_of(w, w.stray)[::-1], strict=True)
        }
        r.tell_lines(
            Severity.ERROR,
            "iso-word",
            lines,
            lambda i: (
                f"{r.plain.excerpt(first[int(lines[i])], int(w.line_end[lines[i]]))}: "
                "no letter in front of it"
            ),
        )
    if len(w.skipped):
        r.tell_lines(
            Severity.WARNING,
            "iso-skip",
            w.skipped,
            lambda i: "an optional block (/): read as if block skip were off",
            "remove the slash, or the block",
        )


def lines_of(w: Words, at: Ints) -> Ints:
    """Return the line of characters."""
    return np.searchsorted(w.line_end, at)


def _column(r: _Reader, letter: str) -> tuple[Ints, Bools, Bools, Ints]:
    """Return for each line the digits of a word, whether it is there, pointed, its decimals."""
    w = r.words
    mask = (w.letter == ord(letter)) & w.good
    lines = w.line[mask]
    twice = np.zeros(len(w.line), bool)
    twice[np.flatnonzero(mask)[1:][lines[1:] == lines[:-1]]] = True
    r.tell_words(Severity.ERROR, "iso-word", twice, f"a second {letter} in one line")
    value, decimals = np.zeros(r.lines, np.int64), np.zeros(r.lines, np.int64)
    has, pointed = np.zeros(r.lines, bool), np.zeros(r.lines, bool)
    # Nine decimals are a thousandth of a nanometre of an inch; further ones are rounded away.
    over = np.maximum(w.decimals[mask] - 9, 0)
    value[lines], has[lines] = (w.whole[mask] + 10**over // 2) // 10**over, True
    pointed[lines], decimals[lines] = w.pointed[mask], w.decimals[mask] - over
    return value, has, pointed, decimals


def _lengths(
    r: _Reader,
    axes: dict[str, tuple[Ints, Bools, Bools, Ints]],
    inches: Ints,
    used: tuple[Bools, Bools],
    stop_line: int,
) -> dict[str, Ints]:
    """Return the lengths of each letter in nm; 0 where there are none.

    ``used``: lines of which X and Y, and of which I, J and R lead somewhere.
    """
    said, how = r.dialect, r.machine.iso
    um = how.integers == "um"
    in_inch = (inches == 1) | ((inches == UNSAID) & (said.units_nm == iso.NM_OF_INCH))
    point = np.where(inches == 1, iso.NM_OF_INCH, iso.NM_OF_MM)
    if said.units_nm is not None:
        point = np.where(inches == UNSAID, said.units_nm, point)
    if said.whole_nm is not None:
        last = np.full(r.lines, said.whole_nm)
    else:
        last = np.where(in_inch, dialects.INCH_DIGIT_NM, 1000 if um else iso.NM_OF_MM)
    out = {}
    bare = np.zeros(r.lines, bool)
    some_pointed = False
    for name, (value, has, pointed, decimals) in axes.items():
        unit = np.where(pointed, point, last)
        exact = value.astype(np.float64) * unit / 10.0**decimals
        large = np.abs(exact) > _MOST_NM
        r.tell_lines(
            Severity.ERROR,
            "over-limit",
            np.flatnonzero(large),
            lambda i, name=name: f"{name} is larger than a kilometre",  # type: ignore[misc]
        )
        safe = np.where(large, 0, value)
        # Exact in integers: 12 digits of inch do not fit, so whole and fraction apart.
        scale = 10**decimals
        q, rest = np.divmod(safe, scale)
        nm = q * unit + (rest * unit + scale // 2) // scale
        out[name] = np.where(large | ~has, 0, nm)
        bare |= has & ~pointed & (value != 0)
        some_pointed |= bool(np.any(has & pointed))
    if not said.named or said.units_nm is not None:
        _ask_units(r, inches, in_inch, used, stop_line)
    if not said.named or said.whole_nm is not None:
        return out
    mixed = np.flatnonzero(bare & in_inch)
    r.tell_lines(
        Severity.ERROR,
        "iso-units",
        mixed,
        lambda i: "a whole number in inches: what its last digit is stands nowhere",
        "write inches with a point, or give --whole-in 0.0001in",
    )
    if some_pointed and bare.any() and um:
        r.tell_lines(
            Severity.WARNING,
            "iso-units",
            np.flatnonzero(bare & ~in_inch),
            lambda i: "whole numbers are read as um here, and others in this file have a point: mm",
            'if they are mm, give --whole-in mm, or a profile of integers = "mm" (iso-mm)',
        )
    return out


def _ask_units(
    r: _Reader, inches: Ints, in_inch: Bools, used: tuple[Bools, Bools], stop_line: int
) -> None:
    """Ask for units that nothing says, and warn of an answer that the file gives otherwise."""
    w, said = r.words, r.dialect
    lengths = w.good & (w.whole != 0) & (w.line <= stop_line)
    letters = [np.isin(w.letter, np.frombuffer(k, np.uint8)) for k in (b"XY", b"IJR")]
    lengths &= (letters[0] & used[0][w.line]) | (letters[1] & used[1][w.line])
    if said.is_open(said.whole_nm):
        whole = np.flatnonzero(lengths & ~w.pointed)
        r.questions += dialects.of_whole(
            whole, w, r.plain, in_inch[w.line[whole]], r.machine.iso.integers
        )
    if said.is_open(said.units_nm):
        unsaid = np.flatnonzero(lengths & w.pointed & (inches[w.line] == UNSAID))
        r.questions += dialects.of_units(unsaid, w, r.plain)
    elif said.units_nm is not None:
        pointed = np.flatnonzero(lengths & w.pointed)
        stated = inches[w.line[pointed]]
        if len(pointed) and not (stated == UNSAID).any():
            nm = np.where(stated == 1, iso.NM_OF_INCH, iso.NM_OF_MM)
            other = w.line[pointed[nm != said.units_nm]][:1]
            _tell_stated(r, other, "G20 or G21", "--units-in")


def _tell_stated(r: _Reader, line: Ints, code: str, option: str) -> None:
    """Warn that the file says itself, and otherwise, what an option says."""
    r.tell_lines(
        Severity.WARNING,
        "iso-stated",
        line,
        lambda i: f"{code} is in force here: {option} says otherwise, and has no effect",
        f"leave {option} out, or correct the program",
    )


def _program(
    r: _Reader,
    axes: dict[str, tuple[Ints, Bools, Bools, Ints]],
    distance: Ints,
    motion: Ints,
    inches: Ints,
    reset: Bools,
    m: Bools,
    calls: Ints,
    modes: Modes | None,
) -> tuple[Programmed, list[Diagnostic]]:
    w = r.words
    has = {k: axes[k][1] for k in axes}
    curved = (motion >= 2) & ~reset
    centred = has["I"] | has["J"]
    moves = (has["X"] | has["Y"] | (curved & (centred | has["R"]))) & ~reset
    # M words end at which line? What follows is not read.
    m_rows = np.flatnonzero(m)
    codes, m_lines = w.whole[m_rows], w.line[m_rows]
    stop = m_rows[np.isin(codes, iso.ENDS)][:1]
    stop_line = int(w.line[stop[0]]) if len(stop) else r.lines
    calls = calls[w.line[calls] <= stop_line]
    r.questions += dialects.of_subprograms(calls, w, r.plain)
    nm = _lengths(r, axes, inches, (moves | reset, curved), stop_line)
    distance = _distance(r, distance, moves & (has["X"] | has["Y"]), stop_line)
    r.tell_lines(
        Severity.ERROR,
        "iso-code",
        np.flatnonzero(moves & (motion < 0)),
        lambda i: "coordinates before any G00, G01, G02 or G03",
    )
    r.tell_lines(
        Severity.ERROR,
        "iso-arc",
        np.flatnonzero((centred | has["R"]) & ~curved & ~reset),
        lambda i: "a centre or a radius without G02 or G03",
    )
    ends_nm, starts_nm, befores = {}, {}, {}
    for k in "XY":
        absolute = (distance == 90) & has[k] & moves
        sets = absolute | (reset & has[k])
        step = np.where(moves & has[k] & (distance == 91), nm[k], 0)
        summed = np.cumsum(step)
        last = np.maximum.accumulate(np.where(sets, np.arange(r.lines), -1))
        at = np.maximum(last, 0)
        work = np.where(last >= 0, nm[k][at] + summed - summed[at], summed)
        before = np.concatenate([[0], work[:-1]])
        place = np.cumsum(np.where(reset, 0, work - before))
        ends_nm[k], starts_nm[k] = place, np.concatenate([[0], place[:-1]])
        befores[k] = before

    late = np.flatnonzero(moves & (np.arange(r.lines) > stop_line))
    if len(late):
        what = f"{len(late)} blocks behind the end (M02) are not run"
        r.found.append(
            (
                int(w.line_start[late[0]]),
                warning("after-end", what, r.spans.at(int(w.line_start[late[0]]))),
            )
        )
    rows = np.flatnonzero(moves & (np.arange(r.lines) <= stop_line) & (motion >= 0))
    runs = None
    if modes is not None:
        still = np.ones(len(rows), bool)
        for k in "XY":
            still &= _grid(starts_nm[k][rows]) == _grid(ends_nm[k][rows])
        runs = runs_of(r, rows, motion[rows], still & (motion[rows] < 2), modes)
    # How far the zero of I and J lies from the start of each arc, were they places (G90).
    away = {k: np.where(distance == 90, befores[k], 0) for k in "XY"}
    blocks, block_line, motions = _blocks(r, rows, motion, nm, has, starts_nm, ends_nm, away, runs)

    unknown = np.zeros(len(w.letter), bool)
    kinds = np.full(len(m_rows), int(Kind.WORD))
    kinds[np.isin(codes, iso.PAUSES)] = Kind.PAUSE
    kinds[np.isin(codes, iso.ENDS)] = Kind.STOP
    plain_word = (kinds == Kind.WORD) & ~np.isin(codes, iso.SUBPROGRAMS)
    plain_word &= m_lines <= stop_line
    turns = np.zeros(len(w.letter), bool)
    turns[m_rows[plain_word & np.isin(codes, iso.TURNS)]] = True
    r.tell_words(
        Severity.ERROR,
        "iso-code",
        turns,
        "turns the part or changes modes at some machines",
        "no profile knows what it does; take it out where it changes no path",
    )
    unknown[m_rows[plain_word]] = True
    unknown &= ~turns
    r.tell_words(
        Severity.WARNING,
        "unknown-word",
        unknown,
        "an M word that is not known here; kept as a control record",
    )
    keep = m_lines <= stop_line
    if len(stop):
        keep &= m_rows <= stop[0]
    controls = np.zeros(int(keep.sum()), BLOCK)
    controls["kind"], controls["source"] = kinds[keep], -1
    # A control word in a line with a motion comes after it, except that the order is the file's.
    every = np.concatenate([blocks, controls])
    key = np.concatenate([2 * block_line, 2 * m_lines[keep] + 1])
    order = np.argsort(key, kind="stable")
    every, line = every[order], np.concatenate([block_line, m_lines[keep]])[order]
    names = np.concatenate([np.full(len(blocks), -1), codes[keep]])[order]
    moved = b3.moves(every["kind"]) & (every["kind"] == Kind.LINE)
    mark = every["source"].astype(np.int64)
    every["source"] = -1
    if runs is not None:  # a line in compensation, or one that says G40 itself, cuts
        moved[(mark >= 0) & runs.cuts[mark]] = False
    every["kind"][moved] = Kind.MOVE
    words = tuple((int(i), f"M{names[i]:02d}") for i in np.flatnonzero(every["kind"] == Kind.WORD))
    size = np.maximum(w.line_end[line] - w.line_start[line], 1).astype(np.int32)
    spans = TextSpans(r.file, r.plain.codes, w.line_start[line], size)
    if not len(rows) and not any(d.severity is Severity.ERROR for _, d in r.found):
        what = "no ISO record with a motion in this file"
        r.found.append((0, error("no-blocks", what, FileSpan(r.file))))
    return Programmed(Program(every, spans=spans, words=words), mark, motions), r.findings()


def _distance(r: _Reader, stated: Ints, moves: Bools, stop_line: int) -> Ints:
    """Return 90 or 91 for every line, as the file, an option or the profile says, or ask."""
    said, profile = r.dialect, r.machine.iso.coordinates
    incremental = (said.coordinates or profile) == "incremental"
    out = np.where(stated == UNSAID, 91 if incremental else 90, stated)
    if said.named and said.coordinates is None:
        return out
    lines = np.flatnonzero(moves[: stop_line + 1])
    unsaid = stated[lines] == UNSAID
    if said.coordinates is None:
        r.questions += dialects.of_coordinates(lines[unsaid], r.words, r.plain, incremental)
    elif len(lines) and not unsaid.any():
        other = lines[stated[lines] != (91 if incremental else 90)]
        if len(other) == len(lines):
            code = f"G{stated[lines[0]]}"
            _tell_stated(r, other[:1], code, f"--coordinates-in {said.coordinates}")
    return out


def _grid(nm: Ints) -> Ints:
    return (nm + 500) // 1000


def _blocks(
    r: _Reader,
    rows: Ints,
    motion: Ints,
    nm: dict[str, Ints],
    has: dict[str, Bools],
    starts_nm: dict[str, Ints],
    ends_nm: dict[str, Ints],
    away: dict[str, Ints],
    runs: Runs | None,
) -> tuple[NDArray[np.void], Ints, NDArray[np.void]]:
    """Return the blocks of the motions in ``rows``, the line of each, and the motions of runs.

    ``source`` of a block is the row of the motions of runs that it stands for, else -1.
    """
    arcs = rows[motion[rows] >= 2]
    sx, sy = _grid(starts_nm["X"][arcs]), _grid(starts_nm["Y"][arcs])
    ex, ey = _grid(ends_nm["X"][arcs]), _grid(ends_nm["Y"][arcs])
    turn = np.where(motion[arcs] == 3, 1, -1)
    same_nm = (starts_nm["X"][arcs] == ends_nm["X"][arcs]) & (
        starts_nm["Y"][arcs] == ends_nm["Y"][arcs]
    )
    by_radius = has["R"][arcs]
    shifts = [away[k][arcs] for k in "XY"]
    centres_nm = [starts_nm[a][arcs] + nm[b][arcs] for a, b in ("XI", "YJ")]
    by_place = r.dialect.centres == "absolute"
    if by_place:
        centres_nm = [c - d for c, d in zip(centres_nm, shifts, strict=True)]
        shifts = [-d for d in shifts]
    exact = [c / 1000.0 for c in centres_nm]
    cx, cy = map(_grid, centres_nm)
    both = by_radius & (has["I"] | has["J"])[arcs]
    neither = ~by_radius & ~(has["I"] | has["J"])[arcs]
    err = Severity.ERROR

    def tell(mask: Bools, message: Callable[[int], str], hint: str | None = None) -> None:
        where = np.flatnonzero(mask & ~r.bad[arcs])
        r.tell_lines(err, "iso-arc", arcs[where], lambda i: message(int(where[i])), hint)

    tell(both, lambda i: "both a centre (I, J) and a radius R")
    tell(neither, lambda i: "an arc without a centre (I, J) or a radius R")
    if by_place:
        alone = (has["I"] ^ has["J"])[arcs] & ((shifts[0] != 0) | (shifts[1] != 0)) & ~both
        tell(alone, lambda i: "I or J alone: the place of a centre is both")
    tell(
        by_radius & same_nm, lambda i: "R with an end that is the start: the centre may be anywhere"
    )
    of_radius = by_radius & ~same_nm
    found = _centres(tell, of_radius, sx, sy, ex, ey, turn, nm["R"][arcs])
    cx, cy = (np.where(of_radius, _nearest(f), c) for f, c in zip(found, (cx, cy), strict=True))
    exact = [np.where(of_radius, f, c) for f, c in zip(found, exact, strict=True)]
    x, y, fx, fy = sx - cx, sy - cy, ex - cx, ey - cy
    radius, reach = np.hypot(x, y), np.hypot(fx, fy)
    tell(
        (x * x + y * y < 2) & ~both & ~neither,  # as in 3B: no step leads round
        lambda i: (
            "the centre is the start: the arc has no radius"
            if radius[i] == 0
            else "the arc starts 0.001 mm from its centre and never ends"
        ),
    )
    off = np.abs(reach - radius)
    far = off > iso.END_UM
    other = np.zeros(len(arcs), bool)
    if r.dialect.is_open(r.dialect.centres) or far.any():
        ends = [(starts_nm[k][arcs] / 1000.0, ends_nm[k][arcs] / 1000.0) for k in "XY"]
        shifted = (np.hypot(*shifts) > 1000) & ~by_radius & ~neither
        this = shifted & _fits(ends, exact)
        other = shifted & _fits(ends, [c - d / 1000.0 for c, d in zip(exact, shifts, strict=True)])
        both_fit = this & other & ~r.bad[arcs]
        if r.dialect.is_open(r.dialect.centres) and both_fit.any() and not (this ^ other).any():
            first = int(arcs[np.argmax(both_fit)])
            r.questions += dialects.of_centres(first, int(both_fit.sum()), r.words, r.plain)
    rule = "start" if by_place else "absolute"
    tell(
        far,
        lambda i: (
            f"the end lies {off[i]:.1f} um from the circle: the start is {radius[i] / 1000:.3f} mm "
            f"from the centre, the end {reach[i] / 1000:.3f} mm"
        ),
        f"I and J fit as --centres-in {rule} reads them"
        if (far & other).any()
        else "check I and J: from the start to the centre, signed",
    )
    motions = np.zeros(0, PROGRAMMED)
    if runs is not None:
        motions = _programmed(runs, starts_nm, ends_nm, arcs, turn, exact)
    good = ~r.bad[arcs]
    if runs is not None:
        good &= runs.of[arcs] < 0
    arcs, turn, x, y, fx, fy = (v[good] for v in (arcs, turn, x, y, fx, fy))
    same_nm = same_nm[good]
    made, rest_x, rest_y = _stepped(r, arcs, turn, x, y, fx, fy, same_nm)

    ran = rows[:0] if runs is None else runs.line[~r.bad[runs.line]]
    straight = (motion[rows] < 2) & ~r.bad[rows]
    if runs is not None:
        straight &= runs.of[rows] < 0
    lines = rows[straight]
    goes = np.zeros(len(lines), BLOCK)
    goes["kind"] = np.where(motion[lines] == 0, int(Kind.MOVE), int(Kind.LINE))
    for k, name in (("X", "x"), ("Y", "y")):
        goes[name] = _grid(ends_nm[k][lines]) - _grid(starts_nm[k][lines])
    rest = np.zeros(len(arcs), BLOCK)
    rest["kind"], rest["x"], rest["y"] = Kind.LINE, rest_x, rest_y
    stepping = r.machine.own_stepping
    for part in (goes, rest):
        part["axis"], part["count"] = stepping.line_count(part["x"], part["y"])
    for part in (goes, made, rest):
        part["source"] = -1
    place = np.zeros(len(ran), BLOCK)  # what a controller makes of it is not known here
    place["kind"] = np.where(motion[ran] == 0, int(Kind.MOVE), int(Kind.LINE))
    place["x"], place["count"] = 1, 1
    if runs is not None:
        place["source"] = runs.of[ran]
    every = np.concatenate([goes, made, rest, place])
    key = np.concatenate([2 * lines, 2 * arcs, 2 * arcs + 1, 2 * ran])
    still = every["count"] == 0
    nothing = np.flatnonzero(still[: len(lines)])
    r.tell_lines(
        Severity.NOTE, "iso-ignored", lines[nothing], lambda i: "a motion of length 0: no block"
    )
    order = np.argsort(key, kind="stable")
    order = order[~still[order]]
    return every[order], key[order] // 2, motions


def _fits(ends: list[tuple[Floats, Floats]], centre: list[Floats]) -> Bools:
    """Return which arcs, from the first of ``ends`` to the second, a centre fits; um."""
    (sx, ex), (sy, ey) = ends
    start, end = (np.hypot(x - centre[0], y - centre[1]) for x, y in ((sx, sy), (ex, ey)))
    fit: Bools = (np.abs(start - end) <= iso.END_UM) & (start >= 1.5)
    return fit


def _programmed(
    runs: Runs,
    starts_nm: dict[str, Ints],
    ends_nm: dict[str, Ints],
    arcs: Ints,
    turn: Ints,
    centre: list[Floats],
) -> NDArray[np.void]:
    """Return the motions of runs as they are programmed."""
    out = np.zeros(len(runs.line), PROGRAMMED)
    for name in ("role", "shift", "d", "run"):
        out[name] = getattr(runs, name)
    for k, name in (("X", "x"), ("Y", "y")):
        out[f"{name}0"] = starts_nm[k][runs.line] / 1000.0
        out[f"{name}1"] = ends_nm[k][runs.line] / 1000.0
    mine = runs.of[arcs]
    some = mine >= 0
    out["turn"][mine[some]] = turn[some]
    out["cx"][mine[some]], out["cy"][mine[some]] = centre[0][some], centre[1][some]
    return out


def _nearest(values: Floats) -> Ints:
    return np.floor(values + 0.5).astype(np.int64)


def _centres(
    tell: Callable[..., None],
    which: Bools,
    sx: Ints,
    sy: Ints,
    ex: Ints,
    ey: Ints,
    turn: Ints,
    radius_nm: Ints,
) -> tuple[Floats, Floats]:
    """Return the centres from R: positive below half a turn, else above. Told of ``which``."""
    radius = np.abs(radius_nm) / 1000.0
    dx, dy = (ex - sx).astype(float), (ey - sy).astype(float)
    chord = np.hypot(dx, dy)
    tell(
        which & (chord / 2 > radius + 1.0),
        lambda i: f"R is {radius[i] / 1000:.3f} mm, half the chord {chord[i] / 2000:.3f} mm",
    )
    high = np.sqrt(np.maximum(radius**2 - chord**2 / 4, 0.0))
    side = turn * np.where(radius_nm > 0, 1, -1)
    safe = np.where(chord > 0, chord, 1.0)
    mx = sx + dx / 2 - side * high * dy / safe
    my = sy + dy / 2 + side * high * dx / safe
    return mx, my


def _stepped(
    r: _Reader,
    lines: Ints,
    turn: Ints,
    x: Ints,
    y: Ints,
    fx: Ints,
    fy: Ints,
    same_nm: Bools,
) -> tuple[NDArray[np.void], Ints, Ints]:
    """Return an arc a row (count 0 for none), and the straight rest to its stated end."""
    made = np.zeros(len(x), BLOCK)
    made["kind"], made["turn"], made["x"], made["y"] = Kind.ARC, turn, x, y
    radius = np.hypot(x, y)
    sweep = turn * (np.arctan2(fy, fx) - np.arctan2(y, x)) % (2 * np.pi)
    tiny = sweep * radius < 4.0
    here = (x == fx) & (y == fy)
    # Start and end on one micron: a full circle if they were stated so, else next to nothing.
    tiny = np.where(here, ~same_nm & (sweep < np.pi), tiny)
    whole = here & ~tiny
    arc_end = r.machine.own_stepping.arc_end
    end = arc_end(x, y, turn, fx, fy)
    px, py = fx.copy(), fy.copy()
    beside = np.flatnonzero(~end.landed & ~tiny & ~whole)
    if len(beside):
        scale = radius[beside] / np.maximum(np.hypot(fx[beside], fy[beside]), 1e-9)
        nx = np.floor(fx[beside] * scale + 0.5).astype(np.int64)
        ny = np.floor(fy[beside] * scale + 0.5).astype(np.int64)
        best = np.full(len(beside), np.inf)
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                qx, qy = nx + i, ny + j
                got = arc_end(x[beside], y[beside], turn[beside], qx, qy)
                angle = (
                    turn[beside]
                    * (np.arctan2(qy, qx) - np.arctan2(y[beside], x[beside]))
                    % (2 * np.pi)
                )
                far = np.hypot(qx - fx[beside], qy - fy[beside])
                far = np.where(got.landed & (np.abs(angle - sweep[beside]) < np.pi), far, np.inf)
                better = far < best
                best = np.where(better, far, best)
                px[beside] = np.where(better, qx, px[beside])
                py[beside] = np.where(better, qy, py[beside])
        end = arc_end(x, y, turn, px, py)
        worst = float(best.max())
        if np.isfinite(worst):
            r.tell_lines(
                Severity.NOTE,
                "iso-end",
                lines[beside],
                lambda i: (
                    f"the stepped circle passes {best[i]:.1f} um beside the stated end (at most "
                    f"{worst:.1f} um in this file); the controller goes the rest straight"
                ),
            )
    ok = end.landed & ~tiny
    made["axis"] = np.where(ok, end.last_axis, int(Axis.X))
    made["count"] = np.where(ok, np.where(end.last_axis == Axis.X, end.count_x, end.count_y), 0)
    rest_x = fx - np.where(ok, px, x)
    rest_y = fy - np.where(ok, py, y)
    lost = np.flatnonzero(~ok & ~tiny)
    r.tell_lines(
        Severity.ERROR,
        "iso-arc",
        lines[lost],
        lambda i: "no controller steps this arc: its radius is too small or over 23 m",
    )
    rest_x[lost], rest_y[lost] = 0, 0
    return made, rest_x, rest_y
