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

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, FileSpan, Severity, error, note
from wedmcam.formats import b3, iso
from wedmcam.formats.iso import PER_CODE
from wedmcam.formats.listing import Values
from wedmcam.frontends.iso import dialect as dialects
from wedmcam.frontends.iso.arcs import centres_of, grid, nearest, stepped_arcs
from wedmcam.frontends.iso.centres import (
    CODES,
    Centres,
    Rules,
    ask,
    centres_by_rule,
    rules_of,
    tell_far,
)
from wedmcam.frontends.iso.codes import (
    condition_words,
    dotted_codes,
    moving_frames,
    take_dwells,
    take_tolerances,
)
from wedmcam.frontends.iso.dialect import UNSAID, Dialect
from wedmcam.frontends.iso.known import take_known, tell_unknown, unlisted, vocabulary_of
from wedmcam.frontends.iso.lengths import distance_of, lengths_of
from wedmcam.frontends.iso.modes import OFF, Modes, Runs, Table, runs_of
from wedmcam.frontends.iso.reading import Reading, column, filled
from wedmcam.frontends.iso.subprograms import STYLES, calls_of, ends_of, order_of
from wedmcam.frontends.iso.table import Tables, modes_of
from wedmcam.frontends.iso.tape import take_end, take_number
from wedmcam.frontends.text import TextSpans
from wedmcam.ir.program import BLOCK, Kind, Program
from wedmcam.ir.programmed import PROGRAMMED, Programmed
from wedmcam.machines import Known, Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

#: Motion behind G80, which ends the one before.
NO_MOTION = -80


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
class Places:
    """Where every line starts and ends, nm, and where it starts in coordinates that G92 sets."""

    starts: dict[str, Ints]
    ends: dict[str, Ints]
    befores: dict[str, Ints]


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
    programmed, found = read(data, machine, file, dialect=dialect)
    return programmed.program, found


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
    r = Reading(data, machine, file, dialect or Dialect())
    # A profile may refuse calls, for nothing states what they run; the user may still say it.
    refuses = vocabulary_of(r).class_of("M", 98 * PER_CODE) is Known.REFUSED
    runs_calls = not refuses or r.said.subprograms in STYLES
    take_end(r, by_word=not (runs_calls and calls_of(r)))
    take_number(r)
    order = order_of(r) if runs_calls else None
    _tell_text(r)
    if order is not None:
        r.run_in(order)
    take_dwells(r)
    stated = take_tolerances(r)
    classes = take_known(r)
    w = r.words
    blends = stated[w.line]
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
    runs = whole & ~refused & ~foreign
    g, m = g & runs, m & runs
    rule, dotted = (codes & ~foreign & ~refused for codes in (rule, dotted))

    modal: dict[str, tuple[Ints, Bools]] = {}
    for name in ("motion", "distance", "inch", "comp", "g92", "centres"):
        modal[name] = (np.zeros(r.lines, np.int64), np.zeros(r.lines, bool))

    def set_mode(name: str, mask: Bools, values: Ints) -> None:
        value, has = modal[name]
        lines = w.line[mask]
        twice = np.zeros(len(w.line), bool)
        again = has[lines]
        again[1:] |= lines[1:] == lines[:-1]
        twice[np.flatnonzero(mask)[again]] = True
        r.tell_words(err, "iso-word", twice, "{words}: a second code of the same kind in one line")
        value[lines], has[lines] = values[mask], True

    code = w.whole
    set_mode("motion", g & (code <= 3), code)
    _end_motion(w.line[g & (code == 80)], *modal["motion"])
    set_mode("centres", rule, code)
    set_mode("distance", g & ((code == 90) | (code == 91)), code)
    inch = g & np.isin(code, (20, 21, 70, 71))
    set_mode("inch", inch, (code % 50 == 20).astype(np.int64))
    comp = g & (code >= 40) & (code <= 42)
    set_mode("comp", comp, code)
    set_mode("g92", g & (code == 92), code)
    work = g & (code >= 53) & (code <= 59)
    known = work | g & ((code <= 3) | np.isin(code, (90, 91, 92)) | inch | comp)
    idle = g & np.isin(code, iso.NOTHING_NEW)
    rounds = g & (code == 64) & ~blends
    work_idle = work & ~moving_frames(r, work)
    places = rule & (code == 901)
    quiet = (idle | dotted | rule | work_idle) & ~places & ~rounds
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
    tell_unknown(
        r,
        err,
        "iso-code",
        g & ~known & ~idle,
        "{words}: a code that is not known here and may change the path",
        hint="known are {known}",
        known=iso.KNOWN,
    )
    axes = {k: column(r, k) for k in "XYIJR"}
    offsets = comp & (code != 40)
    names = b"GMXYIJRNDH" if offsets.any() else b"GMXYIJRN"
    inches = filled(*modal["inch"], UNSAID)
    modes = modes_of(r, modal["comp"], offsets, Tables(table, assumed, inches))
    other = w.good & ~np.isin(w.letter, np.frombuffer(names, np.uint8)) & ~refused
    condition = other & condition_words(w)
    third = other & np.isin(w.letter, np.frombuffer(b"ZUVABCKW", np.uint8)) & (w.whole != 0)
    third &= ~condition
    r.tell_words(err, "iso-code", third, "{words}: an axis or a taper; programs here are flat")
    calls = other & ((w.letter == ord("L")) | (w.letter == ord("P")))
    feed = other & (w.letter == ord("F")) & bool(r.machine.iso.feed_um)
    r.tell_words(
        Severity.NOTE, "iso-ignored", feed, "{words}: the cutting speed: it changes no path"
    )
    _tell_others(r, other & ~third & ~calls & ~feed & (classes != Known.PATH))
    distance = filled(*modal["distance"], UNSAID)
    motion = filled(*modal["motion"], -1)
    reset = modal["g92"][1]
    if r.machine.iso.start == "move":
        reset = reset | _start(axes, motion, reset)
    calls |= m & np.isin(code, iso.SUBPROGRAMS) & ~np.isin(code, ends_of(r.subprograms))
    rules = rules_of(r, *modal["centres"])
    calling = np.flatnonzero(calls)
    return _program(r, Lines(axes, motion, distance, inches, reset, rules), m, calling, modes)


def _end_motion(lines: Ints, motion: Ints, has: Bools) -> None:
    """End the motion in force where G80 stands alone: the next place needs a word of its own.

    LinuxCNC's handbook: G80 is of the group of G00 to G03, and a place while it is in force is an
    error. Other controllers go on in the old motion.
    """
    alone = lines[~has[lines]]
    motion[alone], has[alone] = NO_MOTION, True


#: Hint for words that are left out.
_AT_MACHINE = "feed, generator and offset tables are set at the machine"


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


def _start(axes: dict[str, tuple[Ints, Bools, Bools, Ints]], motion: Ints, reset: Bools) -> Bools:
    """Return the line that tells the start of a program: its first motion, a G00 to X and Y."""
    x, y = axes["X"][1], axes["Y"][1]
    out = np.zeros(len(motion), bool)
    first = np.flatnonzero(x | y)[:1]
    out[first] = (x & y & (motion == 0) & ~reset)[first]
    return out


def _tell_text(r: Reading) -> None:
    """Report comments, characters that are no words, and optional blocks."""
    w = r.words
    if w.comments and r.dialect.semicolon is None:
        # No profile says what stands behind a semicolon, but for lines that it writes itself.
        own = r.machine.layout if r.dialect.named else None
        r.questions += dialects.of_semicolons(w, r.plain, own)
    for a, b in w.comments:
        if r.plain.codes[a] == ord("(") and r.plain.codes[b - 1] != ord(")"):
            finding = error(
                "iso-word",
                "{text}: the bracket is not closed: where the text ends differs",
                r.spans.at(a, b - a),
                hint="close it on this line: some controllers read on to the next bracket",
                text=r.plain.excerpt(a, b),
            )
            r.found.append((a, finding))
    texts = [(a, b) for a, b in w.comments if r.plain.codes[a + 1 : b].strip(b" )")]
    for a, b in texts[:1]:
        finding = note(
            "text-skipped",
            "comment: {text} ({count} comments)" if len(texts) > 1 else "comment: {text}",
            r.spans.at(a, b - a),
            count=len(texts),
            text=r.plain.excerpt(a, b),
        )
        r.found.append((a, finding))
    r.tell_lines(
        Severity.ERROR,
        "iso-word",
        r.titles,
        "line {line} is text, no ISO words: {text}",
        lambda i: {
            "line": r.spans.at(int(w.line_start[r.titles[i]])).line,
            "text": r.plain.excerpt(int(w.line_start[r.titles[i]]), int(w.line_end[r.titles[i]])),
        },
        hint="put text into brackets: (TITLE); or remove the line",
    )
    if len(w.stray):
        lines = np.unique(w.lines_at(w.stray))
        first = {
            int(n): int(k) for k, n in zip(w.stray[::-1], w.lines_at(w.stray)[::-1], strict=True)
        }
        r.tell_lines(
            Severity.ERROR,
            "iso-word",
            lines,
            "{text}: no letter in front of it",
            lambda i: {"text": r.plain.excerpt(first[int(lines[i])], int(w.line_end[lines[i]]))},
        )
    if len(w.skipped):
        r.tell_lines(
            Severity.WARNING,
            "iso-skip",
            w.skipped,
            "an optional block (/): read as if block skip were off",
            hint="remove the slash, or the block",
        )


def _program(
    r: Reading, lines: Lines, m: Bools, calls: Ints, modes: Modes | None
) -> tuple[Programmed, list[Diagnostic]]:
    """Return the program: ``m`` are its M words, ``calls`` the words that call, as rows."""
    w = r.words
    has, motion, reset = lines.has, lines.motion, lines.reset
    curved = (motion >= 2) & ~reset
    centred = has["I"] | has["J"]
    moves = (has["X"] | has["Y"] | (curved & (centred | has["R"]))) & ~reset
    # M words end at which line? What follows is not read.
    m_rows = np.flatnonzero(m)
    codes, m_lines = w.whole[m_rows], w.line[m_rows]
    ends = ends_of(r.subprograms)
    stop = m_rows[np.isin(codes, ends)][:1]
    stop_line = int(w.line[stop[0]]) if len(stop) else r.lines
    calls = calls[w.line[calls] <= stop_line]
    r.questions += dialects.of_repeats(calls, w, r.plain)
    nm = lengths_of(r, lines.axes, lines.inches, (moves | reset, curved), stop_line)
    distance = distance_of(r, lines.distance, moves & (has["X"] | has["Y"]), stop_line)
    _tell_motions(r, moves, motion, (centred | has["R"]) & ~curved & ~reset)
    places = _places(nm, lines, distance, moves)
    starts_nm, ends_nm = places.starts, places.ends
    rows = np.flatnonzero(moves & (np.arange(r.lines) <= stop_line) & (motion >= 0))
    _tell_start(r, rows[:1], lines, distance)
    runs = None
    if modes is not None:
        r.tell_lines(
            Severity.ERROR,
            "compensation-place",
            np.flatnonzero(reset & (modes.code != OFF) & (np.arange(r.lines) <= stop_line)),
            "G92 while compensation is on: of the outline or of the wire, differs",
            hint="G40 in front of G92",
        )
        still = np.ones(len(rows), bool)
        for k in "XY":
            still &= grid(starts_nm[k][rows]) == grid(ends_nm[k][rows])
        runs = runs_of(r, rows, motion[rows], still & (motion[rows] < 2), modes)
    arcs = rows[motion[rows] >= 2]
    by_rule = centres_by_rule(
        arcs, lines.rules, nm, distance == 90, places.befores, starts_nm, ends_nm
    )
    blocks, block_line, motions = _blocks(
        r, rows, motion, nm, has, starts_nm, ends_nm, by_rule, runs
    )

    kinds = _kinds(r, m_rows, ends, stop_line)
    keep = m_lines <= stop_line
    if len(stop):
        keep &= m_rows <= stop[0]
    controls = np.zeros(int(keep.sum()), BLOCK)
    controls["kind"], controls["source"] = kinds[keep], -1
    # Control words keep the order of the file; those in a line with a motion come behind it.
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
        finding = error("no-blocks", "no ISO record with a motion in this file", FileSpan(r.file))
        r.found.append((0, finding))
    return Programmed(Program(every, spans=spans, words=words), mark, motions), r.findings()


def _tell_motions(r: Reading, moves: Bools, motion: Ints, centred: Bools) -> None:
    """Report places without a motion; ``centred``: lines with a centre or radius and no arc."""
    r.tell_lines(
        Severity.ERROR,
        "iso-code",
        np.flatnonzero(moves & (motion == UNSAID)),
        "coordinates before any G00, G01, G02 or G03",
    )
    r.tell_lines(
        Severity.ERROR,
        "iso-code",
        np.flatnonzero(moves & (motion == NO_MOTION)),
        "coordinates behind G80, and no G00, G01, G02 or G03 before them",
        hint="G80 ends the motion at some controllers: say the motion on this line",
    )
    r.tell_lines(
        Severity.ERROR,
        "iso-arc",
        np.flatnonzero(centred),
        "a centre or a radius without G02 or G03",
    )


def _places(nm: dict[str, Ints], lines: Lines, distance: Ints, moves: Bools) -> Places:
    """Return where every line starts and ends: ``moves`` go there, G90 or G91 by ``distance``."""
    has, reset, many = lines.has, lines.reset, len(moves)
    ends, starts, befores = {}, {}, {}
    for k in "XY":
        absolute = (distance == 90) & has[k] & moves
        sets = absolute | (reset & has[k])
        step = np.where(moves & has[k] & (distance == 91), nm[k], 0)
        summed = np.cumsum(step)
        last = np.maximum.accumulate(np.where(sets, np.arange(many), -1))
        at = np.maximum(last, 0)
        work = np.where(last >= 0, nm[k][at] + summed - summed[at], summed)
        before = np.concatenate([[0], work[:-1]])
        place = np.cumsum(np.where(reset, 0, work - before))
        ends[k], starts[k] = place, np.concatenate([[0], place[:-1]])
        befores[k] = before
    return Places(starts, ends, befores)


def _kinds(r: Reading, m_rows: Ints, ends: tuple[int, ...], stop_line: int) -> Ints:
    """Return the kind of block of each M word, and report those that nothing here knows."""
    w = r.words
    codes = w.whole[m_rows]
    unknown = np.zeros(len(w.letter), bool)
    kinds = np.full(len(m_rows), int(Kind.WORD))
    kinds[np.isin(codes, iso.PAUSES)] = Kind.PAUSE
    kinds[np.isin(codes, ends)] = Kind.STOP
    optional = np.zeros(len(w.letter), bool)
    optional[m_rows[(codes == 1) & (w.line[m_rows] <= stop_line)]] = True
    r.tell_words(
        Severity.NOTE,
        "iso-skip",
        optional,
        "{words}: an optional stop: read as if it were on, as a pause",
        hint="leave it out where it is off",
    )
    plain_word = (kinds == Kind.WORD) & ~np.isin(codes, iso.SUBPROGRAMS)
    plain_word &= w.line[m_rows] <= stop_line
    turns = np.zeros(len(w.letter), bool)
    turns[m_rows[plain_word & np.isin(codes, iso.TURNS)]] = True
    tell_unknown(
        r,
        Severity.ERROR,
        "iso-code",
        turns,
        "{words}: turns the part or changes modes at some machines",
        hint="no profile knows what it does; take it out where it changes no path",
    )
    unknown[m_rows[plain_word]] = True
    unknown &= ~turns
    tell_unknown(
        r,
        Severity.WARNING,
        "unknown-word",
        unknown,
        "{words}: no M word of the profile {machine}; kept as a control record"
        if vocabulary_of(r)
        else "{words}: an M word that is not known here; kept as a control record",
        hint="a profile of your own can say what it does: [iso.words]",
        machine=r.machine.name,
    )
    return kinds


def _tell_start(r: Reading, first: Ints, lines: Lines, distance: Ints) -> None:
    """Say from where a program is cut that goes to a place first, and says no start before."""
    goes = (lines.motion[first] > 0) | (r.machine.iso.start == "move")
    cuts = first[goes & (distance[first] == 90)]
    r.tell_lines(
        Severity.NOTE,
        "iso-start",
        cuts[~np.cumsum(lines.reset)[cuts].astype(bool)],
        "no G92, and no G00 to X and Y, stands before this: taken to start at X0 Y0",
        hint="G92 with the place where the wire stands, in front of the first cut",
    )


def _blocks(
    r: Reading,
    rows: Ints,
    motion: Ints,
    nm: dict[str, Ints],
    has: dict[str, Bools],
    starts_nm: dict[str, Ints],
    ends_nm: dict[str, Ints],
    centres: Centres,
    runs: Runs | None,
) -> tuple[NDArray[np.void], Ints, NDArray[np.void]]:
    """Return the blocks of the motions in ``rows``, the line of each, and the motions of runs.

    ``source`` of a block is the row of the motions of runs that it stands for, else -1.
    """
    arcs = rows[motion[rows] >= 2]
    sx, sy = grid(starts_nm["X"][arcs]), grid(starts_nm["Y"][arcs])
    ex, ey = grid(ends_nm["X"][arcs]), grid(ends_nm["Y"][arcs])
    turn = np.where(motion[arcs] == 3, 1, -1)
    same_nm = (starts_nm["X"][arcs] == ends_nm["X"][arcs]) & (
        starts_nm["Y"][arcs] == ends_nm["Y"][arcs]
    )
    by_radius = has["R"][arcs]
    exact = [c / 1000.0 for c in centres.exact_nm]
    cx, cy = map(grid, centres.exact_nm)
    both = by_radius & (has["I"] | has["J"])[arcs]
    neither = ~by_radius & ~(has["I"] | has["J"])[arcs]
    err = Severity.ERROR

    def tell(
        mask: Bools,
        template: str,
        values: Values | None = None,
        hint: str | None = None,
        **common: object,
    ) -> None:
        where = np.flatnonzero(mask & ~r.bad[arcs])
        r.tell_lines(
            err,
            "iso-arc",
            arcs[where],
            template,
            (lambda i: values(int(where[i]))) if values is not None else None,
            hint,
            **common,
        )

    tell(both, "both a centre (I, J) and a radius R")
    tell(neither, "an arc without a centre (I, J) or a radius R")
    alone = (has["I"] ^ has["J"])[arcs] & centres.by_place & (centres.shift > 0) & ~both
    tell(alone, "I or J alone: the place of a centre is both")
    tell(by_radius & same_nm, "R with an end that is the start: the centre may be anywhere")
    of_radius = by_radius & ~same_nm
    found = centres_of(tell, of_radius, sx, sy, ex, ey, turn, nm["R"][arcs])
    cx, cy = (np.where(of_radius, nearest(f), c) for f, c in zip(found, (cx, cy), strict=True))
    exact = [np.where(of_radius, f, c) for f, c in zip(found, exact, strict=True)]
    x, y, fx, fy = sx - cx, sy - cy, ex - cx, ey - cy
    radius, reach = np.hypot(x, y), np.hypot(fx, fy)
    small = ~both & ~neither  # as in 3B: no step leads round
    tell(small & (radius == 0), "the centre is the start: the arc has no radius")
    tell(
        small & (x * x + y * y == 1),
        "the arc starts 0.001 mm from its centre and never ends",
    )
    off = np.abs(reach - radius)
    stated = ~by_radius & ~neither
    ask(r, arcs, stated, centres)
    tell_far(
        tell,
        off > iso.END_UM,
        stated,
        lambda i: {
            "off_um": float(off[i]),
            "start_mm": float(radius[i] / 1000),
            "end_mm": float(reach[i] / 1000),
        },
        centres,
    )
    motions = np.zeros(0, PROGRAMMED)
    if runs is not None:
        motions = _programmed(runs, starts_nm, ends_nm, arcs, turn, exact)
    good = ~r.bad[arcs]
    if runs is not None:
        good &= runs.of[arcs] < 0
    arcs, turn, x, y, fx, fy = (v[good] for v in (arcs, turn, x, y, fx, fy))
    same_nm = same_nm[good]
    made, rest_x, rest_y = stepped_arcs(r, arcs, turn, x, y, fx, fy, same_nm)

    ran = rows[:0] if runs is None else runs.line[~r.bad[runs.line]]
    straight = (motion[rows] < 2) & ~r.bad[rows]
    if runs is not None:
        straight &= runs.of[rows] < 0
    lines = rows[straight]
    goes = np.zeros(len(lines), BLOCK)
    goes["kind"] = np.where(motion[lines] == 0, int(Kind.MOVE), int(Kind.LINE))
    for k, name in (("X", "x"), ("Y", "y")):
        goes[name] = grid(ends_nm[k][lines]) - grid(starts_nm[k][lines])
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
    r.tell_lines(Severity.NOTE, "iso-ignored", lines[nothing], "a motion of length 0: no block")
    order = np.argsort(key, kind="stable")
    order = order[~still[order]]
    return every[order], key[order] // 2, motions


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
