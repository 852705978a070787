"""Read 3B as shops have it: any layout, any surroundings, nothing dropped in silence.

Records are found wherever they stand (``frontends.records``). What lies between them is read here:
control words, N numbers, end coordinates, comments; anything else is counted and reported. A file
states no end of an arc and none is computed: that is the controller's. A record that no controller
could run is an error and is left out of the program.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, FileSpan, Severity, error, warning
from wedmcam.formats import b3, quadrants
from wedmcam.formats.lengths import mm_of
from wedmcam.formats.listing import in_order, listed
from wedmcam.frontends.b3.records import Records, find_records
from wedmcam.frontends.text import Plain, TextSpans, plain
from wedmcam.ir.program import BLOCK, Kind, Program
from wedmcam.machines import Machine

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
    """Return the program that a 3B file states, and what was found on the way.

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
    found = [(int(records.start[at]), d) for at, d in by_record]
    found += _surroundings(gaps, spans, machine, commented, records)

    program, order = _merge(blocks[good], records, good, gaps, file)
    found += _sequence(program, order, spans)
    if commented.all() and not gaps.bad and not gaps.four:
        found.append((0, error("no-blocks", "no 3B record in this file", FileSpan(file))))
    return program, in_order(found)


def _blocks(
    records: Records, read: NDArray[np.bool_], machine: Machine, spans: TextSpans
) -> tuple[NDArray[np.void], NDArray[np.bool_], list[tuple[int, Diagnostic]]]:
    """Return a block for each record, which of those to ``read`` are good, findings by record."""
    mm = mm_of(machine.axes.step_um)
    turn = np.array([0, 1, -1])[records.code // 4]
    named = records.code % 4 + 1
    line = turn == 0
    xs, ys, count = records.x, records.y, records.count
    on_y = records.axis == 1
    # X = Y = 0: J along the count axis, in the direction of the quadrant.
    whole = line & (xs == 0) & (ys == 0)
    xs = np.where(whole & ~on_y, count, xs)
    ys = np.where(whole & on_y, count, ys)
    x, y = quadrants.signed(xs, ys, named)
    limits = machine.limits
    largest = np.where(line, limits.line_um, limits.arc_um)
    widest = np.maximum(records.x, records.y)
    found: list[tuple[int, Diagnostic]] = []
    good = read.copy()

    def tell(
        severity: Severity,
        code: str,
        mask: NDArray[np.bool_],
        message: Callable[[int], str],
        hint: str | None = None,
    ) -> None:
        # Each record is told once what is wrong with it, and no more after an error.
        where = np.flatnonzero(mask & good)
        found.extend(listed(severity, code, where, spans.__getitem__, message, hint))
        if severity is Severity.ERROR:
            good[where] = False

    def z(i: int) -> str:
        return b3.INSTRUCTIONS[int(records.code[i])]

    def g(i: int) -> str:
        return "GY" if on_y[i] else "GX"

    err, warn = Severity.ERROR, Severity.WARNING
    tell(
        err,
        "over-limit",
        count > limits.count_um,
        lambda i: f"J is {mm(int(count[i]))}, the largest is {mm(limits.count_um)}",
        "split the block",
    )
    tell(
        err,
        "over-limit",
        widest > largest,
        lambda i: (
            f"{'XY'[int(records.y[i] > records.x[i])]} is {mm(int(widest[i]))}, "
            f"the largest is {mm(int(largest[i]))}"
        ),
        "split the block" if limits.line_um == limits.arc_um else None,
    )
    tell(err, "zero-count", count == 0, lambda i: f"J of this {z(i)} record is 0")
    radius2 = np.where(widest > largest, 2, xs * xs + ys * ys)
    tell(
        err,
        "arc-too-small",
        ~line & (radius2 < 2),
        lambda i: (
            "X = Y = 0: the arc starts on its own centre"
            if radius2[i] == 0
            else "the arc starts 0.001 mm from its centre and never ends"
        ),
    )
    tell(
        err,
        "endless-block",
        line & (np.where(on_y, ys, xs) == 0),
        lambda i: (
            f"the line runs along {'X' if on_y[i] else 'Y'} and is counted on {g(i)}: it never ends"
        ),
    )
    safe_x, safe_y = np.where(good, x, 1), np.where(good, y, 1)
    right = quadrants.quadrant(safe_x, safe_y, turn)
    repaired = good & (right != named)

    def repair(i: int) -> str:
        code = b3.instruction(turn[i : i + 1], right[i : i + 1])[0]
        what = "line runs along" if line[i] else "arc starts on"
        axis = ("+X", "+Y", "-X", "-Y")[2 * int(x[i] + y[i] < 0) + int(x[i] == 0)]
        return f"{z(i)} read as {b3.INSTRUCTIONS[int(code)]}: the {what} {axis}"

    tell(warn, "quadrant-repaired", repaired & line, repair)
    tell(Severity.NOTE, "quadrant-repaired", repaired & ~line, repair)
    wanted = machine.own_stepping.line_count(x, y)[0]
    tell(
        warn,
        "count-axis",
        line & (wanted != records.axis) & (xs != ys),
        lambda i: f"counted on {g(i)}, the shorter axis: the end of the line is inexact",
    )
    tell(
        warn,
        "count-axis",
        line & (wanted != records.axis) & (xs == ys),
        lambda i: (
            f"a 45 degree {z(i)} counted on {g(i)}: a controller with the "
            f"{machine.line_table} line table ends it exactly only on {'GX' if on_y[i] else 'GY'}"
        ),
    )
    tell(
        warn,
        "more-than-a-turn",
        ~line & (count > b3.largest_turn(x, y)),
        lambda i: (
            f"J is {mm(int(count[i]))}; a full circle counts about "
            f"{mm(round(4 * float(np.hypot(x[i], y[i]))))}"
        ),
    )

    blocks = np.zeros(len(x), dtype=BLOCK)
    blocks["kind"] = np.where(line, Kind.LINE, Kind.ARC)
    blocks["turn"] = turn
    blocks["axis"] = records.axis
    blocks["x"], blocks["y"], blocks["count"] = x, y, count
    blocks["source"] = -1
    return blocks, good, found


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


def _surroundings(
    gaps: _Gaps,
    spans: TextSpans,
    machine: Machine,
    commented: NDArray[np.bool_],
    records: Records,
) -> list[tuple[int, Diagnostic]]:
    """Return what is to be said about the text around the records, by offset."""
    found: list[tuple[int, Diagnostic]] = []
    excerpt = gaps.plain.excerpt

    def tell(
        severity: Severity,
        code: str,
        places: list[tuple[int, int]],
        message: Callable[[int, int], str],
        hint: str | None = None,
    ) -> None:
        for rank, diagnostic in listed(
            severity,
            code,
            list(range(len(places))),
            lambda i: spans.at(places[i][0], places[i][1] - places[i][0]),
            lambda i: message(*places[i]),
            hint,
        ):
            found.append((places[rank][0], diagnostic))

    err, warn, note = Severity.ERROR, Severity.WARNING, Severity.NOTE
    tell(
        err,
        "bad-record",
        gaps.bad,
        lambda a, b: (
            f"'{excerpt(a, b)}' is no 3B record: {_why(gaps.plain.codes[a : min(b, a + _LONG)])}"
        ),
    )
    tell(
        err,
        "unsupported-4b",
        gaps.four,
        lambda a, b: f"'{excerpt(a, b)}' is a 4B record (its fourth field is the radius)",
        "read it as 4B (--format 4b, or a name that ends in .4b); convert makes 3B of it",
    )
    dropped = np.flatnonzero(commented)
    tell(
        warn,
        "commented-record",
        [(int(records.start[i]), int(records.end[i])) for i in dropped[:1]] * len(dropped),
        lambda a, b: f"record '{excerpt(a, b)}' stands in a comment and was not read",
    )
    words = [(a, b) for a, b, kind in gaps.words if kind == Kind.WORD]
    known = machine.words
    tell(
        warn,
        "unknown-word",
        words,
        lambda a, b: f"'{excerpt(a, b)}' is no control word of {machine.name}; kept as it is",
        f"known are {known.pause} (pause), {known.stop} (stop) and {known.end} (end)",
    )
    tell(
        warn,
        "hidden-control-word",
        gaps.hidden,
        lambda a, b: f"'{excerpt(a, b)}' stands in a line of other text and was not read",
    )
    ours = {line.strip() for line in (*machine.layout.header, *machine.layout.footer)}
    texts = [(a, b) for a, b in gaps.texts if excerpt(a, b, _LONG) not in ours]
    tell(note, "text-skipped", texts, lambda a, b: f"text around the records: '{excerpt(a, b)}'")
    if not machine.layout.end_coordinates:
        tell(
            note,
            "text-skipped",
            [(a, a + 1) for a in gaps.coordinates],
            lambda a, b: "end coordinates behind the records are not used",
        )
    return found


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
    text = f"blocks after the stop of the program: {len(late)}"
    return [(at, warning("after-end", text, spans.at(at), count=len(late)))]
