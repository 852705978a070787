"""Say what a file is, by content alone (数据类型的智能识别): format, blocks, last address.

Nothing is ever cleared: the ZD-065 answers random data by clearing its memory; a user's file stays
as it is. Text comes first, because letters and digits of ASCII are valid packed BCD.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from wedmcam.formats import b4, compact, compensation, nby15, rotation, tape
from wedmcam.frontends.b3.records import find_records
from wedmcam.frontends.iso.offsets import tables_of
from wedmcam.frontends.iso.style import lines_end, style_of
from wedmcam.frontends.iso.words import COMMENT, with_numbers
from wedmcam.frontends.text import plain
from wedmcam.frontends.zd065.memory import addresses


@dataclass(frozen=True, slots=True)
class Identification:
    """What a file seems to be.

    Attributes:
        format: a key of ``frontends.DECODERS``, ``dxf``, ``wed``, ``empty`` or ``unknown``.
        blocks: complete blocks found; control records of a text are not counted.
        last_address: address of the last byte that belongs to a block or is the end byte; of a text
            the last character of the last record; None where there is none.
        bad_address: address of the first byte that does not fit, or None.
        certain: whether nothing else would do.
        reason: one sentence for people.
    """

    format: str
    blocks: int
    last_address: int | None
    bad_address: int | None
    certain: bool
    reason: str


#: How a DXF begins, behind comments.
_DXF = re.compile(rb"(\xef\xbb\xbf)?\s*(999[ \t]*\r?\n[^\n]*\n\s*)*0[ \t]*\r?\n\s*SECTION\b")


def is_drawing(data: bytes) -> bool:
    r"""Return whether data begin like a DXF, in text or in binary.

    >>> is_drawing(b"  0\nSECTION\n"), is_drawing(b"B0B0B0GXL1")
    (True, False)
    """
    return data.startswith(b"AutoCAD Binary DXF\r\n") or bool(_DXF.match(data))


#: How a part program begins, behind comments.
_PART = re.compile(
    rb"(\xef\xbb\xbf)?(\s|#[^\n]*(\n|$))*"
    rb'(part\s*"|units\s+(mm|um|inch)\b|let\s+\w+\s*=|contour\s+\w+\s*\{|cut\s+\w)'
)


def is_part(data: bytes) -> bool:
    r"""Return whether data begin like a program of the part language.

    >>> is_part(b"# a key\nlet w = 8.5"), is_part(b"B0B0B0GXL1")
    (True, False)
    """
    return bool(_PART.match(data[:100_000]))


def identify(data: bytes) -> Identification:
    """Return which format ``data`` has; never raises.

    >>> identify(b"B9900B0B39600GYNR1").format
    '3b'
    >>> identify(bytes.fromhex("01 017000 005000 00")).reason
    'compact cutting format: 1 block, lines alone: the compensation format has the same bytes'
    """
    if not data.rstrip(b"\0"):
        size = len(data)
        return Identification("empty", 0, None, None, True, f"empty: {size} bytes, all 0")
    if is_drawing(data):
        return Identification("dxf", 0, None, None, True, "DXF drawing")
    if is_part(data):
        return Identification("wed", 0, None, None, True, "program of the part language")
    if (punched := _tape(data)) is not None:
        return punched
    codes = plain(data).codes
    if (jobs := _jobs(codes)) is not None:
        return jobs
    records = find_records(codes)
    if (four := b4.fourths(codes)) and len(four) >= len(records.start):
        last, count = b4.RECORD.match(codes, four[-1].start), len(four)
        assert last is not None
        words = "record" if count == 1 else "records"
        more = f", {len(records.start)} of 3B" if len(records.start) else ""
        reason = f"4B text: {count} {words}{more}; the controller offsets arcs by a gap"
        return Identification("4b", count, last.end() - 1, None, True, reason)
    if count := len(records.start):
        words = "record" if count == 1 else "records"
        return Identification(
            "3b", count, int(records.end[-1]) - 1, None, True, f"3B text: {count} {words}"
        )
    if (seen := _iso(data, codes)) is not None:
        return seen
    return identify_memory(data)


#: How a file of job records begins: with what positions count, or with a record.
_JOBS = re.compile(rb"\s*(?:(UM|STEPS) *\n|\d+(?: +\d+){6} *(?:\n|$))")
_JOB = re.compile(rb"^ *\d+(?: +\d+){6} *$", re.M)


def _jobs(codes: bytes) -> Identification | None:
    """Return what a text of job records of the DEM-15 is; None where it does not begin like one."""
    begin = _JOBS.match(codes)
    records = list(_JOB.finditer(codes)) if begin else []
    if begin is None or not records:
        return None
    count, last = len(records), records[-1].end() - 1
    words = "vector" if count == 1 else "vectors"
    unit = {b"UM": "um", b"STEPS": "steps"}.get(begin[1], "an unknown unit")
    reason = f"job records of the DEM-15: {count} {words}, positions in {unit}"
    return Identification("dem15", count, last, None, begin[1] is not None, reason)


def _tape(data: bytes) -> Identification | None:
    """Return what a punched tape is, or None: seven rows in eight have even parity, and words."""
    wrong = len(tape.odd_rows(data))
    if wrong * 8 > len(data.strip(b"\0")) or not max(data) & 0x80:
        return None
    text = tape.readable(data).decode("ascii")
    _, start, body = text.partition(tape.REWIND_STOP)
    lines = [bare for line in body.split("\n") if (bare := "".join(line.split()))]
    blocks = [line for line in lines if nby15.BLOCK.fullmatch(line)]
    if not start or not blocks or len(blocks) * 10 < len(lines) * 9:
        return None
    cuts = sum("G" in line for line in blocks)
    words = "block" if cuts == 1 else "blocks"
    reason = f"punched tape of the NBY-15: {len(data)} rows, {cuts} {words}"
    if wrong:
        reason += f"; {wrong} rows have an odd number of holes"
    last = len(data.rstrip(b"\0\xff")) - 1
    bad = int(tape.odd_rows(data)[0]) if wrong else None
    return Identification("nby15", cuts, last, bad, not wrong, reason)


#: A line of ISO words: letters and numbers, an optional slash first, nothing else.
_ISO_LINE = re.compile(rb"/?(?:[A-Z] *[-+]?(?:\d[\d ]*\.?[\d ]*|\.\d[\d ]*))+|%+")
_ISO_MOTION = re.compile(rb"G *0?[0-3](?!\d)|[XYIJ] *[-+]?[\d.]")


def _iso(data: bytes, codes: bytes) -> Identification | None:
    """Return what a text of ISO words is, or None: nine lines in ten must be such words.

    Args:
        data: the file. codes: its text, see ``frontends.plain``.

    A line of text in front of the first code is a title, and counts for none.
    """
    if data.count(b"\0") > len(data) // 8 and not data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return None
    codes, entries, _ = tables_of(with_numbers(codes))
    ended = lines_end(codes)
    codes = COMMENT.sub(lambda m: b" " * len(m[0]), codes)
    at, motions, lines, last, bad, wrong = 0, 0, 0, -1, None, 0
    coded, titles = False, 0
    for line in codes.split(b"\n"):
        if part := line.strip():
            lines += 1
            if not _ISO_LINE.fullmatch(part):
                bad = at if bad is None else bad
                wrong += 1
                titles += not coded
                if lines > 20 and motions * 2 < lines:
                    return None
            else:
                motions += bool(_ISO_MOTION.search(part))
                coded = coded or bool(re.search(rb"G *\d", part))
                last = at + len(line.rstrip()) - 1
        at += len(line) + 1
    title = titles == 1 and lines > 3
    if not coded or not motions or (wrong - title) * 10 > lines:
        return None
    words = "line" if motions == 1 else "lines"
    named = ", ".join(f"H{n}" for n in dict.fromkeys(e.number for e in entries))
    table = f" with an offset table ({named})" if entries else ""
    reason = f"ISO G-code{table}: {motions} {words} with a motion" + (
        "" if bad is None else f", {wrong} other"
    )
    if re.search(rb"G *4[12](?!\d)", codes):
        numbers = sorted({(k, int(n)) for k, n in re.findall(rb"([DH]) *(\d{1,6})", codes)})
        given = ", ".join(f"{k.decode()}{n}" for k, n in numbers) or "no D"
        reason += f"; the controller offsets outlines (G41, G42) by its table: {given}"
    if style := style_of(codes, "H" if entries else "", ended):
        reason += f"; {style}"
    return Identification("iso", motions, last, bad, bad is None, reason)


@dataclass(frozen=True, slots=True)
class _Layout:
    """One of the three formats: its name, its lengths, and which bytes are no plain digits.

    Attributes:
        format: a key of ``frontends.DECODERS``.
        title: for people.
        length: bytes of the block that each instruction opens.
        arc_most: (offset, largest value) of bytes of an arc.
        line_most: the same of a line.
        arc_least: (offset, smallest value) of bytes of an arc.
    """

    format: str
    title: str
    length: bytes
    arc_most: tuple[tuple[int, int], ...] = ()
    line_most: tuple[tuple[int, int], ...] = ()
    arc_least: tuple[tuple[int, int], ...] = ()


#: Exponents of angles in degrees are 0 to 3; a compensation type is 1 or 2.
_LAYOUTS = (
    _Layout("compact", "compact cutting format", compact.LENGTH),
    _Layout("rotation", "rotation format", rotation.LENGTH, ((1, 3), (10, 3)), ((1, 3),)),
    _Layout(
        "compensation", "gap-compensation format", compensation.LENGTH, ((1, 2),), (), ((1, 1),)
    ),
)


def identify_memory(data: bytes, format: str | None = None) -> Identification:
    """Return which of the ZD-065's formats fits best: to its end, with the least doubts, longest.

    Args:
        data: bytes of its memory, from the first block on.
        format: it is known to be this one; None for any of the three.

    Data that fit the cutting format are called that: lines alone are the same bytes in the
    compensation format, and the reason says so.
    """
    seen = [_fits(data, layout) for layout in _LAYOUTS if format in (None, layout.format)]
    whole = [s for s in seen if s.format != "unknown" and s.bad_address is None]
    if whole:
        ended = [s for s in whole if "stop without" not in s.reason] or whole
        return _likeliest(data, ended) if len(ended) > 1 else ended[0]
    known = [s for s in seen if s.format != "unknown"]
    return max(known, key=lambda s: s.last_address or 0) if known else seen[0]


def _likeliest(data: bytes, seen: list[Identification]) -> Identification:
    """Return the one with the least doubts, then the one that explains most bytes."""
    rank = [(_doubts(data, s.format), -(s.last_address or 0)) for s in seen]
    best = min(range(len(seen)), key=lambda k: rank[k])
    same = [s for k, s in enumerate(seen) if k != best and rank[k][0] == rank[best][0]]
    if not same or "same bytes" in seen[best].reason:
        return seen[best]
    reason = f"{seen[best].reason}; they would also do as {same[0].reason}"
    return replace(seen[best], certain=False, reason=reason)


def _doubts(data: bytes, format_: str) -> int:
    """Return how much the reader of a format finds wrong: zero lengths, angles, quadrants."""
    from wedmcam import machines
    from wedmcam.diag import Severity
    from wedmcam.frontends import decoder

    _, findings = decoder(format_)(data, machines.reading(format_), "")
    return sum(d.count for d in findings if d.severity > Severity.NOTE)


def _fits(data: bytes, layout: _Layout) -> Identification:
    starts, end = addresses(data, layout.length)
    bad = _first_bad_digit(data, starts, layout)
    if bad is not None:
        starts = starts[starts + _lengths(data, starts, layout) <= bad]
        end = int(starts[-1] + _lengths(data, starts, layout)[-1]) if len(starts) else 0
    count = len(starts)
    ended = bad is None and end < len(data) and data[end] == compact.END
    if bad is None and not ended:
        bad = end
    words = "block" if count == 1 else "blocks"
    # A number is what random bytes do not make: one digit pair in 2.6 is BCD, and one instruction
    # in 18 is one. A text has no byte 0, a compact program nearly always.
    numbers = int((_lengths(data, starts, layout) > 1).sum())
    text = all(0x20 <= b < 0x7F or b in b"\t\r\n" for b in data[:4096])
    # One block that would do in another format is no proof either, when other data follow it.
    trail = layout.format != "compact" and ended and bool(data[end + 1 :].strip(b"\0"))
    if not numbers or text or (numbers < 2 and (not ended or trail)):
        where = 0 if bad is None else bad
        kind = "text without a 3B record" if text else "random data or a format not known here"
        reason = f"{kind}; as compact data byte {where:#06x} would be the first that does not fit"
        return Identification("unknown", 0, None, where, False, reason)
    if ended:
        rest = data[end + 1 :]
        if rest.strip(b"\0"):
            bad = end + 1 + next(i for i, b in enumerate(rest) if b)
        codes = np.frombuffer(data, dtype=np.uint8)[starts]
        arcs = (codes & 0xF0 == compact.CW) | (codes & 0xF0 == compact.CCW)
        certain = bool(arcs.any()) or layout.format == "rotation"
        reason = f"{layout.title}: {count} {words}" + (
            "" if certain else ", lines alone: the compensation format has the same bytes"
        )
        if bad is not None:
            reason += f"; then other data from {bad:#06x} on"
        return Identification(layout.format, count, end, bad, certain, reason)
    reason = f"{layout.title}: {count} {words}, " + (
        "then the data stop without an end byte"
        if bad is None or bad >= len(data)
        else f"damaged at {bad:#06x}"
    )
    fits = None if bad is not None and bad >= len(data) else bad
    return Identification(layout.format, count, end - 1, fits, False, reason)


def longest_run(data: bytes, first: int = 0, format: str | None = None) -> tuple[int, int, str]:
    """Return where the most blocks of the ZD-065 follow each other: address, blocks, format.

    Args:
        data: bytes of its memory; what is before or behind the blocks may be anything.
        first: the search begins at this address.
        format: of the blocks; None for any of the three.

    Blocks are counted that hold numbers. Random bytes make two in a row at one of eighty million
    places.

    >>> longest_run(bytes.fromhex("ff 01017000005000 02017000005000 00"))
    (1, 2, 'compact')
    """
    layouts = [layout for layout in _LAYOUTS if format in (None, layout.format)]
    runs = [(*_longest_run(data, first, layout), layout.format) for layout in layouts]
    return max(runs, key=lambda run: run[1])


def _longest_run(data: bytes, first: int, layout: _Layout) -> tuple[int, int]:
    """Return where the most good blocks of a layout follow each other, and how many; see above."""
    size = len(data)
    run = [0] * (size + 1)  # good blocks with numbers from an address on
    for at in range(size - 1, first - 1, -1):
        length = layout.length[data[at]]
        if not length or at + length > size:
            continue
        block = data[at : at + length]
        alone = np.zeros(1, dtype=np.int64)
        if length == 1 or _first_bad_digit(block, alone, layout) is None:
            run[at] = run[at + length] + (length > 1)
    best = max(range(first, size + 1), key=run.__getitem__)
    return best, run[best]


def _lengths(data: bytes, starts: NDArray[np.int64], layout: _Layout) -> NDArray[np.int64]:
    codes = np.frombuffer(data, dtype=np.uint8)[starts]
    table = np.frombuffer(layout.length, dtype=np.uint8).astype(np.int64)
    lengths: NDArray[np.int64] = table[codes]
    return lengths


def _first_bad_digit(data: bytes, starts: NDArray[np.int64], layout: _Layout) -> int | None:
    """Return the address of the first byte of a number that is no packed BCD, or out of range."""
    raw = np.frombuffer(data, dtype=np.uint8)
    number = np.zeros(len(raw), dtype=np.int8)
    lengths = _lengths(data, starts, layout)
    number[: int(starts[-1] + lengths[-1]) if len(starts) else 0] = 1
    number[starts] = 0  # instructions
    bad = (number == 1) & ((raw >> 4 > 9) | (raw & 15 > 9))
    group = raw[starts] & 0xF0
    arcs = starts[(group == compact.CW) | (group == compact.CCW)]
    straight = starts[(lengths > 1) & ~np.isin(starts, arcs)]
    for rows, limits in ((arcs, layout.arc_most), (straight, layout.line_most)):
        for offset, most in limits:
            bad[rows + offset] |= raw[rows + offset] > most
    if layout.format == "rotation":  # angles are normalised: no zero first but for exponent 0
        angles = np.concatenate([arcs + 1, arcs + 10, straight + 1])
        bad[angles + 1] |= (raw[angles] > 0) & (raw[angles + 1] < 0x10)
    for offset, least in layout.arc_least:
        bad[arcs + offset] |= raw[arcs + offset] < least
    wrong = np.flatnonzero(bad)
    return int(wrong[0]) if len(wrong) else None
