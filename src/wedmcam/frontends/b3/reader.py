"""Read 3B as shops have it: any layout, any surroundings, nothing dropped in silence.

Records are found wherever they stand (``frontends.records``). What lies between them is read here:
control words, N numbers, end coordinates, comments; anything else is counted and reported. A file
states no end of an arc and none is computed: that is the controller's. A record that no controller
could run is an error and is left out of the program.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, FileSpan, Severity, error, warning
from wedmcam.formats import b3, quadrants
from wedmcam.formats.lengths import to_mm
from wedmcam.formats.listing import Values, in_order, listed
from wedmcam.frontends.b3.records import Records, find_records
from wedmcam.frontends.text import Plain, TextSpans, plain
from wedmcam.ir.program import BLOCK, Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_NUMBER = rb"[-+]?(?:\d++(?:\.\d*+)?+|\.\d++)"
_COORDINATES = re.compile(rb" *+" + _NUMBER + rb" *+, *+" + _NUMBER + rb" *+")
#: What most gaps are: the rest of a line with end coordinates, then the next N number.
_USUAL_GAP = re.compile(
    rb" *+(?:;( *+" + _NUMBER + rb" *+, *+" + _NUMBER + rb" *+))?+[ \n]*+(?:N *+\d++ *+[:.]? *+)?+"
)
_N_NUMBER = re.compile(rb" *+N *+\d++ *+[:.]?")
_COMMENT = re.compile(rb";|\(|#|//")
_WORD = re.compile(rb"[A-Z][A-Z0-9]{0,15}")
_4B = re.compile(
    rb"B[ \d]*+B[ \d]*+B[ \d]*+B[ \d]*+(?:D *+D?+ *+)?+G *+[XY] *+(?:(?:L|[SN] *+R) *+\d?)?"
)
_FRAGMENT = re.compile(rb"B[-+.,\d ]*+B|G *+[XY] *+(?:L|[SN] *+R) *+\d")
_STUMP = re.compile(rb" *+B[-+.,\d ]*+")
#: A line longer than this between records is not looked at word by word.
_LONG = 4096


def _why(fragment: bytes) -> str:
    """Return what keeps a fragment from being a record."""
    if re.search(rb"B *[-+]", fragment):
        return "numbers carry no sign: the quadrant is in the instruction"
    if re.search(rb"\d *[.,]", fragment):
        return "numbers are whole micrometres, without a point or comma"
    if (count := fragment.count(b"B")) < 3:
        return f"{count} of the three B"
    if re.search(rb"B *\d+ +\d", fragment):
        return "a blank inside a number"
    if not re.search(rb"G *[XY]", fragment):
        return "no count direction GX or GY"
    if not re.search(rb"G *[XY] *(?:L|[SN] *R) *[1-4](?!\d)", fragment):
        return "no instruction L, SR or NR with one quadrant 1 to 4"
    return "the parts are not in the order B X B Y B J G Z"


@dataclass(slots=True)
class _Gaps:
    """What the gaps between records hold; offsets in the text."""

    plain: Plain
    controls: dict[bytes, Kind]
    words: list[tuple[int, int, Kind]] = field(default_factory=list)  # start, end, kind
    bad: list[tuple[int, int]] = field(default_factory=list)
    four: list[tuple[int, int]] = field(default_factory=list)
    texts: list[tuple[int, int]] = field(default_factory=list)
    hidden: list[tuple[int, int]] = field(default_factory=list)
    coordinates: list[int] = field(default_factory=list)
    dropped: list[tuple[int, int]] = field(default_factory=list)  # records: first, past the last

    def read(self, records: Records) -> None:
        """Read all gaps that hold more than blanks."""
        codes = self.plain.codes
        total = len(records.start)
        gaps = np.flatnonzero(records.inked)
        lows = np.concatenate([[0], records.end])[gaps]
        highs = np.concatenate([records.start, [len(codes)]])[gaps]
        resume = 0  # where the last comment that held records ended
        usual = _USUAL_GAP.fullmatch
        for gap, low, high in zip(gaps.tolist(), lows.tolist(), highs.tolist(), strict=True):
            if low < resume:
                low = resume
            if high <= low:
                continue
            if match := usual(codes, low, high):
                at = match.start(1)
                if at < 0:
                    continue
                if gap:  # coordinates belong to a record
                    self.coordinates.append(at)
                    continue
            if self._gap(low, high, gap < total):
                stop = codes.find(b"\n", high)
                resume = stop if stop >= 0 else len(codes)
                self.dropped.append((gap, int(np.searchsorted(records.start, resume))))

    def _gap(self, low: int, high: int, record_follows: bool) -> bool:
        """Read one gap; return whether the record behind it stands in a comment."""
        codes = self.plain.codes
        at = low
        while True:
            stop = codes.find(b"\n", at, high)
            last = stop < 0
            stop = high if last else stop
            opens = at == 0 or codes[at - 1] == 10
            if self._line(at, stop, not opens, last and record_follows):
                return True
            if last:
                return False
            at = stop + 1

    def _line(self, low: int, high: int, record_before: bool, record_after: bool) -> bool:
        """Read a line beside its records; return whether a comment runs on to the next record."""
        codes = self.plain.codes
        while mark := _COMMENT.search(codes, low, high):
            self._code(low, mark.start())
            body = mark.end()
            if mark[0] == b"(":
                close = codes.find(b")", body, high)
                stop = high if close < 0 else close + 1
                self.texts.append((mark.start(), stop))
                if close < 0:
                    return record_after
                low = stop
                continue
            if record_before and mark[0] == b";":
                if match := _COORDINATES.match(codes, body, high):
                    self.coordinates.append(body)
                    body = match.end()
                rest = codes[body:high].strip()
                if not rest or (record_after and _N_NUMBER.fullmatch(rest)):
                    return False  # a semicolon between or behind records of one line
            if codes[body:high].strip():
                self.texts.append((mark.start(), high))
            return record_after
        self._code(low, high)
        return False

    def _code(self, low: int, high: int) -> None:
        """Read a part of a line that is neither record nor comment."""
        codes = self.plain.codes
        if match := _N_NUMBER.match(codes, low, high):
            low = match.end()
        part = codes[low:high]
        if not part.strip():
            return
        if match := _4B.search(part):
            self.four.append((low + match.start(), low + match.end()))
            return
        if (match := _FRAGMENT.search(part)) or (match := _STUMP.fullmatch(part)):
            self.bad.append((low + len(part) - len(part.lstrip()), low + len(part.rstrip())))
            return
        if len(part) > _LONG:
            self.texts.append((low, high))
            return
        tokens = [(low + m.start(), low + m.end(), m[0]) for m in re.finditer(rb"\S+", part)]
        kinds = [self.controls.get(token) for _, _, token in tokens]
        if all(kind is not None for kind in kinds):
            self.words += [(a, b, k) for (a, b, _), k in zip(tokens, kinds, strict=True) if k]
        elif len(tokens) == 1 and _WORD.fullmatch(tokens[0][2]):
            self.words.append((tokens[0][0], tokens[0][1], Kind.WORD))
        elif kinds[0] and not any(re.search(rb"[A-Z0-9]", t) for _, _, t in tokens[1:]):
            self.words.append((tokens[0][0], tokens[0][1], kinds[0]))
            self.texts.append((tokens[1][0], tokens[-1][1]))
        else:
            self.texts.append((tokens[0][0], tokens[-1][1]))
            self.hidden += [(a, b) for (a, b, _), k in zip(tokens, kinds, strict=True) if k][:1]


def decode(data: bytes, machine: Machine, file: str) -> tuple[Program, list[Diagnostic]]:
    """Return the program that a 3B file states, and findings.

    Args:
        data: any bytes; never raises.
        machine: a 3B profile: its control words, limits and line table.
        file: name for the spans.

    Returns:
        One block a record, in their order; X and Y of a line as written (a ratio), with the signs
        of its quadrant; a line with X = Y = 0 has its whole length J. Records in error are left
        out. ``spans[i]`` is a `TextSpan`, made when asked for.
    """
    source = plain(data)
    records = find_records(source.codes)
    words = machine.words
    gaps = _Gaps(
        source,
        {
            words.pause.encode(): Kind.PAUSE,
            words.stop.encode(): Kind.STOP,
            words.end.encode(): Kind.END,
        },
    )
    gaps.read(records)

    spans = TextSpans(
        file, source.codes, records.start, (records.end - records.start).astype(np.int32)
    )
    commented = np.zeros(len(records.start), dtype=bool)
    for first, past in gaps.dropped:
        commented[first:past] = True
    blocks, good, by_record = _blocks(records, ~commented, machine, spans)
    findings = [(int(records.start[at]), d) for at, d in by_record]
    findings += _surroundings(gaps, spans, machine, commented, records)

    program, order = _merge(blocks[good], records, good, gaps, file)
    findings += _sequence(program, order, spans)
    if commented.all() and not gaps.bad and not gaps.four:
        findings.append((0, error("no-blocks", "no 3B record in this file", FileSpan(file))))
    return program, in_order(findings)


class _Teller:
    """Collects findings about records; about one with an error no more."""

    def __init__(self, read: Bools, spans: TextSpans) -> None:
        self.good, self.findings = read.copy(), list[tuple[int, Diagnostic]]()
        self._spans = spans

    def tell(
        self,
        severity: Severity,
        code: str,
        mask: Bools,
        template: str,
        values: Values | None = None,
        hint: str | None = None,
    ) -> None:
        where = np.flatnonzero(mask & self.good)
        self.findings.extend(
            listed(severity, code, where, self._spans.__getitem__, template, values, hint)
        )
        if severity is Severity.ERROR:
            self.good[where] = False


class _Columns:
    """Records as columns.

    Attributes:
        code: index into `formats.b3.INSTRUCTIONS`.
        turn: +1 counter-clockwise arc, -1 clockwise, 0 a line. line: which are lines.
        named: quadrant in the instruction.
        xs, ys: X and Y without sign; of a line with X = Y = 0, J along the count axis.
        x, y: the same with the signs of the quadrant.
        count: J. on_y: which are counted on GY.
    """

    def __init__(self, records: Records) -> None:
        self.code, self.count = records.code, records.count
        self.turn = np.array([0, 1, -1])[records.code // 4]
        self.named = records.code % 4 + 1
        self.line: Bools = self.turn == 0
        self.on_y: Bools = records.axis == 1
        whole = self.line & (records.x == 0) & (records.y == 0)
        self.xs = np.where(whole & ~self.on_y, records.count, records.x)
        self.ys = np.where(whole & self.on_y, records.count, records.y)
        self.x, self.y = quadrants.signed(self.xs, self.ys, self.named)

    def instruction(self, i: int) -> str:
        """Return the instruction of a record."""
        return b3.INSTRUCTIONS[int(self.code[i])]

    def counted(self, i: int) -> str:
        """Return the word of the axis on which a record is counted."""
        return "GY" if self.on_y[i] else "GX"


def _blocks(
    records: Records, read: Bools, machine: Machine, spans: TextSpans
) -> tuple[NDArray[np.void], Bools, list[tuple[int, Diagnostic]]]:
    """Return a block for each record, which of those to ``read`` are good, findings by record."""
    teller, columns = _Teller(read, spans), _Columns(records)
    _tell_limits(teller, columns, records, machine)
    _tell_endless(teller, columns, records, machine)
    _tell_quadrants(teller, columns)
    _tell_counts(teller, columns, machine)
    blocks = np.zeros(len(columns.x), dtype=BLOCK)
    blocks["kind"] = np.where(columns.line, Kind.LINE, Kind.ARC)
    blocks["turn"] = columns.turn
    blocks["axis"] = records.axis
    blocks["x"], blocks["y"], blocks["count"] = columns.x, columns.y, columns.count
    blocks["source"] = -1
    return blocks, teller.good, teller.findings


def _largest(columns: _Columns, machine: Machine) -> Ints:
    """Return the largest X or Y that each record may have."""
    return np.where(columns.line, machine.limits.line_um, machine.limits.arc_um)


def _tell_limits(teller: _Teller, columns: _Columns, records: Records, machine: Machine) -> None:
    """Refuse numbers over the limits of the controller, and J = 0."""
    limits, mm = machine.limits, to_mm(machine.axes.step_um)
    count, largest = columns.count, _largest(columns, machine)
    widest = np.maximum(records.x, records.y)
    teller.tell(
        Severity.ERROR,
        "over-limit",
        count > limits.count_um,
        "J is {count_mm:.3f} mm, the largest is {most_mm:.3f} mm",
        lambda i: {"count_mm": mm(count[i]), "most_mm": mm(limits.count_um)},
        hint="split the block",
    )
    teller.tell(
        Severity.ERROR,
        "over-limit",
        widest > largest,
        "{axis} is {length_mm:.3f} mm, the largest is {most_mm:.3f} mm",
        lambda i: {
            "axis": "XY"[int(records.y[i] > records.x[i])],
            "length_mm": mm(widest[i]),
            "most_mm": mm(largest[i]),
        },
        hint="split the block" if limits.line_um == limits.arc_um else None,
    )
    teller.tell(
        Severity.ERROR,
        "zero-count",
        count == 0,
        "J of this {instruction} record is 0",
        lambda i: {"instruction": columns.instruction(i)},
    )


def _tell_endless(teller: _Teller, columns: _Columns, records: Records, machine: Machine) -> None:
    """Refuse records that never end."""
    xs, ys, line, on_y = columns.xs, columns.ys, columns.line, columns.on_y
    # Squares of what is over a limit, and refused already, may overflow.
    over = np.maximum(records.x, records.y) > _largest(columns, machine)
    radius2 = np.where(over, 2, xs * xs + ys * ys)
    teller.tell(
        Severity.ERROR,
        "arc-too-small",
        ~line & (radius2 == 0),
        "X = Y = 0: the arc starts on its own centre",
    )
    teller.tell(
        Severity.ERROR,
        "arc-too-small",
        ~line & (radius2 == 1),
        "the arc starts 0.001 mm from its centre and never ends",
    )
    teller.tell(
        Severity.ERROR,
        "endless-block",
        line & (np.where(on_y, ys, xs) == 0),
        "the line runs along {axis} and is counted on {counted}: it never ends",
        lambda i: {"axis": "X" if on_y[i] else "Y", "counted": columns.counted(i)},
    )


def _tell_quadrants(teller: _Teller, columns: _Columns) -> None:
    """Say where the instruction names the neighbour of the quadrant that a record enters."""
    x, y, turn = columns.x, columns.y, columns.turn
    safe_x, safe_y = np.where(teller.good, x, 1), np.where(teller.good, y, 1)
    right = quadrants.quadrant(safe_x, safe_y, turn)
    repaired = teller.good & (right != columns.named)

    def repair(i: int) -> dict[str, object]:
        code = b3.instruction(turn[i : i + 1], right[i : i + 1])[0]
        return {
            "instruction": columns.instruction(i),
            "repaired": b3.INSTRUCTIONS[int(code)],
            "axis": ("+X", "+Y", "-X", "-Y")[2 * int(x[i] + y[i] < 0) + int(x[i] == 0)],
        }

    teller.tell(
        Severity.WARNING,
        "quadrant-repaired",
        repaired & columns.line,
        "{instruction} read as {repaired}: the line runs along {axis}",
        repair,
    )
    teller.tell(
        Severity.NOTE,
        "quadrant-repaired",
        repaired & ~columns.line,
        "{instruction} read as {repaired}: the arc starts on {axis}",
        repair,
    )


def _tell_counts(teller: _Teller, columns: _Columns, machine: Machine) -> None:
    """Warn of counts that end a line beside its end, or an arc behind a full circle."""
    line, x, y, count = columns.line, columns.x, columns.y, columns.count
    mm = to_mm(machine.axes.step_um)
    other_axis = machine.own_stepping.line_count(x, y)[0] != columns.on_y
    diagonal = columns.xs == columns.ys
    teller.tell(
        Severity.WARNING,
        "count-axis",
        line & other_axis & ~diagonal,
        "counted on {counted}, the shorter axis: the end of the line is inexact",
        lambda i: {"counted": columns.counted(i)},
    )
    teller.tell(
        Severity.WARNING,
        "count-axis",
        line & other_axis & diagonal,
        "a 45 degree {instruction} counted on {counted}: a controller with the {table} line table "
        "ends it exactly only on {exact}",
        lambda i: {
            "instruction": columns.instruction(i),
            "counted": columns.counted(i),
            "table": machine.line_table,
            "exact": "GX" if columns.on_y[i] else "GY",
        },
    )
    teller.tell(
        Severity.WARNING,
        "more-than-a-turn",
        ~line & (count > b3.largest_turn(x, y)),
        "J is {count_mm:.3f} mm; a full circle counts about {turn_mm:.3f} mm",
        lambda i: {
            "count_mm": mm(count[i]),
            "turn_mm": mm(round(4 * float(np.hypot(x[i], y[i])))),
        },
    )


def _merge(
    blocks: NDArray[np.void],
    records: Records,
    good: NDArray[np.bool_],
    gaps: _Gaps,
    file: str,
) -> tuple[Program, NDArray[np.int64]]:
    """Return the program of records and control words in file order, and the offset of each."""
    starts, ends = records.start[good], records.end[good]
    named: tuple[tuple[int, str], ...] = ()
    if gaps.words:
        words = np.zeros(len(gaps.words), dtype=BLOCK)
        words["kind"] = [kind for _, _, kind in gaps.words]
        words["source"] = -1
        starts = np.concatenate([starts, [a for a, _, _ in gaps.words]])
        ends = np.concatenate([ends, [b for _, b, _ in gaps.words]])
        order = np.argsort(starts, kind="stable")
        blocks = np.concatenate([blocks, words])[order]
        starts, ends = starts[order], ends[order]
        named = tuple(
            (int(i), gaps.plain.codes[starts[i] : ends[i]].decode("ascii"))
            for i in np.flatnonzero(blocks["kind"] == Kind.WORD)
        )
        blocks["kind"][b3.moves(blocks["kind"])] = Kind.MOVE
    spans = TextSpans(file, gaps.plain.codes, starts, (ends - starts).astype(np.int32))
    # A sequence that makes spans when asked for: a tuple of a million would cost seconds.
    return Program(blocks, spans=spans, words=named), starts


class _TextTeller:
    """Collects findings about the text around the records, by offset."""

    def __init__(self, text: Plain, spans: TextSpans) -> None:
        self.findings: list[tuple[int, Diagnostic]] = []
        self._text, self._spans = text, spans

    def tell(
        self,
        severity: Severity,
        code: str,
        places: list[tuple[int, int]],
        template: str,
        values: Callable[[int, int], Mapping[str, object]] | None = None,
        hint: str | None = None,
    ) -> None:
        """Report places (start, end); values of a place, ``text`` as it stands there if None."""
        for rank, diagnostic in listed(
            severity,
            code,
            list(range(len(places))),
            lambda i: self._spans.at(places[i][0], places[i][1] - places[i][0]),
            template,
            lambda i: (self.quoted if values is None else values)(*places[i]),
            hint,
        ):
            self.findings.append((places[rank][0], diagnostic))

    def quoted(self, a: int, b: int) -> dict[str, object]:
        """Return the text of a place as a value."""
        return {"text": self._text.excerpt(a, b)}


def _surroundings(
    gaps: _Gaps,
    spans: TextSpans,
    machine: Machine,
    commented: NDArray[np.bool_],
    records: Records,
) -> list[tuple[int, Diagnostic]]:
    """Return findings about the text around the records, by offset."""
    teller = _TextTeller(gaps.plain, spans)
    _tell_fragments(teller, gaps)
    dropped = np.flatnonzero(commented)
    teller.tell(
        Severity.WARNING,
        "commented-record",
        [(int(records.start[i]), int(records.end[i])) for i in dropped[:1]] * len(dropped),
        "record '{text}' stands in a comment and was not read",
    )
    _tell_control_words(teller, gaps, machine)
    ours = {line.strip() for line in (*machine.layout.header, *machine.layout.footer)}
    texts = [(a, b) for a, b in gaps.texts if gaps.plain.excerpt(a, b, _LONG) not in ours]
    teller.tell(Severity.NOTE, "text-skipped", texts, "text around the records: '{text}'")
    if not machine.layout.end_coordinates:
        teller.tell(
            Severity.NOTE,
            "text-skipped",
            [(a, a + 1) for a in gaps.coordinates],
            "end coordinates behind the records are not used",
            lambda a, b: {},
        )
    return teller.findings


def _tell_fragments(teller: _TextTeller, gaps: _Gaps) -> None:
    """Refuse what looks like a record and is none of 3B."""
    codes = gaps.plain.codes
    teller.tell(
        Severity.ERROR,
        "bad-record",
        gaps.bad,
        "'{text}' is no 3B record: {reason}",
        lambda a, b: {**teller.quoted(a, b), "reason": _why(codes[a : min(b, a + _LONG)])},
    )
    teller.tell(
        Severity.ERROR,
        "unsupported-4b",
        gaps.four,
        "'{text}' is a 4B record (its fourth field is the radius)",
        hint="read it as 4B (--format 4b, or a name that ends in .4b); convert makes 3B of it",
    )


def _tell_control_words(teller: _TextTeller, gaps: _Gaps, machine: Machine) -> None:
    """Warn of control words that the machine has not, and of those within other text."""
    words = machine.words
    teller.tell(
        Severity.WARNING,
        "unknown-word",
        [(a, b) for a, b, kind in gaps.words if kind == Kind.WORD],
        "'{text}' is no control word of {machine}; kept as it is",
        lambda a, b: {
            **teller.quoted(a, b),
            "machine": machine.name,
            "pause": words.pause,
            "stop": words.stop,
            "end": words.end,
        },
        hint="known are {pause} (pause), {stop} (stop) and {end} (end)",
    )
    teller.tell(
        Severity.WARNING,
        "hidden-control-word",
        gaps.hidden,
        "'{text}' stands in a line of other text and was not read",
    )


def _sequence(
    program: Program, offsets: NDArray[np.int64], spans: TextSpans
) -> list[tuple[int, Diagnostic]]:
    """Return what is wrong with the order of blocks."""
    kinds = program.blocks["kind"]
    ends = np.flatnonzero((kinds == Kind.STOP) | (kinds == Kind.END))
    if not len(ends):
        return []
    cutting = np.flatnonzero(kinds <= Kind.MOVE)
    late = cutting[cutting > ends[0]]
    if not len(late):
        return []
    at = int(offsets[late[0]])
    return [
        (
            at,
            warning(
                "after-end",
                "blocks after the stop of the program: {count}",
                spans.at(at),
                count=len(late),
            ),
        )
    ]
