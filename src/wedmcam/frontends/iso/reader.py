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
from wedmcam.frontends.iso import dialect as dialects
from wedmcam.frontends.iso.blocks import Blocks, Path, blocks_of, places_of
from wedmcam.frontends.iso.centres import (
    rules_of,
)
from wedmcam.frontends.iso.codes import (
    take_dwells,
    take_tolerances,
)
from wedmcam.frontends.iso.dialect import UNSAID, Dialect
from wedmcam.frontends.iso.known import take_known, tell_unknown, vocabulary_of
from wedmcam.frontends.iso.lengths import distance_of, lengths_of
from wedmcam.frontends.iso.lines import (
    NO_MOTION,
    Lines,
    calling_words,
    codes_of,
    first_move,
    modes_by_line,
    tell_codes,
)
from wedmcam.frontends.iso.modes import OFF, Modes, Runs, Table, runs_of
from wedmcam.frontends.iso.reading import Reading, column, filled
from wedmcam.frontends.iso.subprograms import STYLES, calls_of, ends_of, order_of
from wedmcam.frontends.iso.table import Tables, modes_of
from wedmcam.frontends.iso.tape import take_end, take_number
from wedmcam.frontends.text import TextSpans
from wedmcam.ir.program import BLOCK, Kind, Program
from wedmcam.ir.programmed import Programmed
from wedmcam.machines import Known, Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]


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
    programmed, findings = read(data, machine, file, dialect=dialect)
    return programmed.program, findings


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
    _put_in_order(r)
    take_dwells(r)
    tolerances = take_tolerances(r)
    codes = codes_of(r, take_known(r))
    modal = modes_by_line(r, codes)
    tell_codes(r, codes, tolerances)
    axes = {k: column(r, k) for k in "XYIJR"}
    inches = filled(*modal["inch"], UNSAID)
    modes = modes_of(r, modal["comp"], codes.switches_on, Tables(table, assumed, inches))
    calls = calling_words(r, codes, ends_of(r.subprograms))
    distance = filled(*modal["distance"], UNSAID)
    motion = filled(*modal["motion"], UNSAID)
    reset = modal["g92"][1]
    if r.machine.iso.start == "move":
        reset = reset | first_move(axes, motion, reset)
    rules = rules_of(r, *modal["centres"])
    lines = Lines(axes, motion, distance, inches, reset, rules)
    return _program(r, lines, codes.m, calls, modes)


def _put_in_order(r: Reading) -> None:
    """Find where the program ends, and put its lines in the order in which they are run."""
    # A profile may refuse calls, for nothing states what they run; the user may still say it.
    refuses = vocabulary_of(r).class_of("M", 98 * PER_CODE) is Known.REFUSED
    runs_calls = not refuses or r.user_dialect.subprograms in STYLES
    take_end(r, by_word=not (runs_calls and calls_of(r)))
    take_number(r)
    order = order_of(r) if runs_calls else None
    _tell_text(r)
    if order is not None:
        r.run_in(order)


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
                "{text}: the bracket is not closed: controllers differ on where the text ends",
                r.spans.at(a, b - a),
                hint="close it on this line: some controllers read on to the next bracket",
                text=r.plain.excerpt(a, b),
            )
            r.findings.append((a, finding))
    texts = [(a, b) for a, b in w.comments if r.plain.codes[a + 1 : b].strip(b" )")]
    for a, b in texts[:1]:
        finding = note(
            "text-skipped",
            "comment: {text} ({count} comments)" if len(texts) > 1 else "comment: {text}",
            r.spans.at(a, b - a),
            count=len(texts),
            text=r.plain.excerpt(a, b),
        )
        r.findings.append((a, finding))
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
    controls = _controls(r, m)
    stop_line = controls.stop_line
    calls = calls[r.words.line[calls] <= stop_line]
    r.questions += dialects.of_repeats(calls, r.words, r.plain)
    path = _path(r, lines, stop_line)
    runs = None
    if modes is not None:
        r.tell_lines(
            Severity.ERROR,
            "compensation-place",
            np.flatnonzero(lines.reset & (modes.code != OFF) & (np.arange(r.lines) <= stop_line)),
            "G92 while compensation is on: controllers differ on whether it is a place of the "
            "outline or of the wire",
            hint="G40 in front of G92",
        )
        runs = runs_of(r, path.rows, lines.motion[path.rows], path.still, modes)
    blocks = blocks_of(r, path, runs)
    programmed = _with_controls(r, blocks, controls, runs)
    if not len(path.rows) and not any(d.severity is Severity.ERROR for _, d in r.findings):
        finding = error("no-blocks", "no ISO record with a motion in this file", FileSpan(r.file))
        r.findings.append((0, finding))
    return programmed, r.sorted_findings()


@dataclass(frozen=True, slots=True, eq=False)
class _Controls:
    """The M words of a text.

    Attributes:
        rows: of the words.
        stop_line: the line of the one that ends the program; what follows is not read.
        run: which of them are run: none behind that one.
    """

    rows: Ints
    stop_line: int
    run: Bools


def _controls(r: Reading, m: Bools) -> _Controls:
    """Return the M words, which ``m`` are."""
    w, rows = r.words, np.flatnonzero(m)
    stop = rows[np.isin(w.whole[rows], ends_of(r.subprograms))][:1]
    if len(stop):
        return _Controls(rows, int(w.line[stop[0]]), rows <= stop[0])
    return _Controls(rows, r.lines, np.ones(len(rows), bool))


def _path(r: Reading, lines: Lines, stop_line: int) -> Path:
    """Return the motions as programmed, and report places that nothing says how to go to."""
    has, motion, reset = lines.has, lines.motion, lines.reset
    curved = (motion >= 2) & ~reset
    centred = has["I"] | has["J"] | has["R"]
    moves = (has["X"] | has["Y"] | (curved & centred)) & ~reset
    nm = lengths_of(r, lines.axes, lines.inches, (moves | reset, curved), stop_line)
    distance = distance_of(r, lines.distance, moves & (has["X"] | has["Y"]), stop_line)
    _tell_motions(r, moves, motion, centred & ~curved & ~reset)
    rows = np.flatnonzero(moves & (np.arange(r.lines) <= stop_line) & (motion >= 0))
    _tell_start(r, rows[:1], lines, distance)
    return Path(rows, lines, nm, distance == 90, places_of(nm, lines, distance, moves))


def _with_controls(
    r: Reading, blocks: Blocks, controls: _Controls, runs: Runs | None
) -> Programmed:
    """Return the program of the blocks of motions, and of M words as control records.

    Control words keep the order of the file; those in a line with a motion come behind it.
    """
    w, m_rows = r.words, controls.rows[controls.run]
    records = np.zeros(len(m_rows), BLOCK)
    records["kind"] = _kinds(r, controls)[controls.run]
    records["source"] = -1
    every = np.concatenate([blocks.rows, records])
    key = np.concatenate([2 * blocks.line, 2 * w.line[m_rows] + 1])
    order = np.argsort(key, kind="stable")
    every, line = every[order], key[order] // 2
    names = np.concatenate([np.full(len(blocks.rows), -1), w.whole[m_rows]])[order]
    moved = b3.moves(every["kind"]) & (every["kind"] == Kind.LINE)
    mark = every["source"].astype(np.int64)
    every["source"] = -1
    if runs is not None:  # a line in compensation, or one that says G40 itself, cuts
        moved[(mark >= 0) & runs.cuts[mark]] = False
    every["kind"][moved] = Kind.MOVE
    words = tuple((int(i), f"M{names[i]:02d}") for i in np.flatnonzero(every["kind"] == Kind.WORD))
    size = np.maximum(w.line_end[line] - w.line_start[line], 1).astype(np.int32)
    spans = TextSpans(r.file, r.plain.codes, w.line_start[line], size)
    return Programmed(Program(every, spans=spans, words=words), mark, blocks.motions)


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


def _kinds(r: Reading, controls: _Controls) -> Ints:
    """Return the kind of block of each M word, and report those that nothing here knows."""
    w, m_rows, stop_line = r.words, controls.rows, controls.stop_line
    codes = w.whole[m_rows]
    unknown = np.zeros(len(w.letter), bool)
    kinds = np.full(len(m_rows), int(Kind.WORD))
    kinds[np.isin(codes, iso.PAUSES)] = Kind.PAUSE
    kinds[np.isin(codes, ends_of(r.subprograms))] = Kind.STOP
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
