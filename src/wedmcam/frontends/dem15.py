"""Read job records of the DEM-15 (`formats.dem15`): every line is one of them, or an error.

A record that the controller could not run as it is meant is refused: the generator's supply, speeds
and places have limits, and a place that is no whole step is never arrived at.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, FileSpan, Severity, Span, error
from wedmcam.formats import dem15
from wedmcam.formats.listing import listed
from wedmcam.frontends.text import TextSpans, plain
from wedmcam.ir.program import BLOCK, Kind, Program
from wedmcam.machines import Machine

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_RECORD = re.compile(rb"\d{1,9}(?: +\d{1,9}){6}")
_WORDS = {dem15.PAUSE.encode(): Kind.PAUSE, dem15.END.encode(): Kind.STOP}
_UNITS = {word.encode(): name for name, (word, _) in dem15.UNITS.items()}


class _Lines:
    """The lines of a file that are not empty, and what was found in them.

    Attributes:
        spans: where each stands.
        kinds: `Kind` of each: a record is a LINE; -1 for what is none of all.
        fields: of the records, shape (lines, 7), 0 elsewhere.
        unit: what the file says that positions count; None where it does not.
    """

    def __init__(self, data: bytes, file: str) -> None:
        text = plain(data)
        self.text, self.file = text, file
        self.findings: list[Diagnostic] = []
        self.failed = False
        self.unit: str | None = None
        starts: list[int] = []
        kinds: list[int] = []
        rows: list[list[int]] = []
        self._sizes: list[int] = []
        at = 0
        for line in text.codes.split(b"\n"):
            part = line.strip()
            begin = at + len(line) - len(line.lstrip())
            at += len(line) + 1
            if not part:
                continue
            if self.unit is None and not starts and part in _UNITS:
                self.unit = _UNITS[part]
                continue
            record = _RECORD.fullmatch(part)
            starts.append(begin)
            self._sizes.append(len(part))
            kinds.append(Kind.LINE if record else _WORDS.get(part, -1))
            rows.append([int(n) for n in part.split()] if record else [0] * 7)
        self.starts = np.array(starts, np.int64)
        self.kinds = np.array(kinds, np.int64)
        self.fields = np.array(rows, np.int64).reshape(-1, 7)
        self.spans = TextSpans(file, text.codes, self.starts, np.array(self._sizes, np.int32))

    def refuse(
        self,
        code: str,
        mask: Bools,
        template: str,
        hint: str | None = None,
        field: int | Ints | None = None,
        **columns: NDArray[np.generic],
    ) -> None:
        """Report lines as errors.

        Args:
            code, mask, template, hint: of the findings, and in which lines they are.
            field: which number of a record is wrong, 0 to 6, one for all or an entry a line.
            **columns: values of the template, an entry a line.
        """

        def values(i: int) -> Mapping[str, object]:
            return {name: column[i].item() for name, column in columns.items()}

        def span(i: int) -> Span:
            if field is None:
                return self.spans[i]
            return self._field(i, field if isinstance(field, int) else int(field[i]))

        where = np.flatnonzero(mask)
        self.findings += (
            d for _, d in listed(Severity.ERROR, code, where, span, template, values, hint)
        )
        self.failed |= len(where) > 0

    def _field(self, i: int, k: int) -> Span:
        """Return where number ``k`` of a record stands."""
        start = int(self.starts[i])
        numbers = re.finditer(rb"\d+", self.text.codes[start : start + self._sizes[i]])
        number = next(islice(numbers, k, None))
        return self.spans.at(start + number.start(), len(number[0]))

    def say(self, d: Diagnostic) -> None:
        """Add an error about the whole file."""
        self.findings.append(d)
        self.failed = True


def decode(data: bytes, machine: Machine, file: str) -> tuple[Program, list[Diagnostic]]:
    """Return the program of a file of job records.

    Args:
        data: any bytes; never raises.
        machine: a profile of the DEM-15.
        file: name for the spans.

    Returns:
        A LINE for each record and a MOVE for each that is run with the generator off, in steps,
        with the speed in ``count``; the program starts at (0, 0), as every program that is read.
        An empty program where there is an error.
    """
    lines = _Lines(data, file)
    _unit(lines, machine)
    lines.refuse(
        "bad-job-record",
        lines.kinds < 0,
        "this is no job record, no {pause} and no {end}",
        "a record is seven whole numbers: x y, new x y, t(i), t(p), speed",
        pause=np.full(len(lines.kinds), dem15.PAUSE),
        end=np.full(len(lines.kinds), dem15.END),
    )
    record = lines.kinds == Kind.LINE
    if not lines.failed:
        _fields(lines, record)
    if not lines.failed:
        _generator(lines, record)
        _places(lines, record, dem15.UNITS[machine.vectors.positions][1])
        _end(lines)
    if lines.failed:
        return Program(np.zeros(0, BLOCK)), lines.findings
    blocks = np.zeros(len(record), BLOCK)
    blocks["source"] = -1
    blocks["kind"] = np.where(record & (lines.fields[:, 5] == 0), int(Kind.MOVE), lines.kinds)
    step = dem15.UNITS[machine.vectors.positions][1]
    f = lines.fields
    blocks["x"], blocks["y"] = (f[:, 2] - f[:, 0]) // step, (f[:, 3] - f[:, 1]) // step
    blocks["count"] = f[:, 6]
    return Program(blocks, spans=lines.spans), lines.findings


def _unit(lines: _Lines, machine: Machine) -> None:
    """Refuse a file whose positions count something else than the profile's, or do not say."""
    mine, own = machine.vectors.positions, dem15.UNITS[machine.vectors.positions][0]
    if lines.unit is None:
        lines.say(
            error(
                "positions-unit",
                "the file does not say in its first line what positions count: {words}",
                FileSpan(lines.file),
                hint="{word} for profile {machine}",
                words=[word for word, _ in dem15.UNITS.values()],
                word=own,
                machine=machine.name,
            )
        )
    elif lines.unit != mine:
        lines.say(
            error(
                "positions-unit",
                "positions of the file count {unit}, those of {machine} {own}",
                FileSpan(lines.file),
                hint="read it with --profile dem15 or dem15-steps",
                unit=lines.unit,
                machine=machine.name,
                own=mine,
            )
        )


def _fields(lines: _Lines, record: Bools) -> None:
    """Refuse numbers that do not fit their field."""
    for k, (name, most) in enumerate(zip(dem15.FIELDS, dem15.MOST.tolist(), strict=True)):
        least = 1 if name == "speed" else 0
        value = lines.fields[:, k]
        lines.refuse(
            "speed-range" if name == "speed" else "over-limit",
            record & ((value > most) | (value < least)),
            "speed is {value}; the controller takes 1 to 127, 15.75 um a minute each"
            if name == "speed"
            else "{name} is {value}; it goes to {most}",
            field=k,
            name=np.full(len(value), name),
            value=value,
            most=np.full(len(value), most),
        )


def _generator(lines: _Lines, record: Bools) -> None:
    """Refuse control words with which the generator cuts out or draws more than it has."""
    t_i, t_p = lines.fields[:, 4], lines.fields[:, 5]
    off = (t_i == 0) & (t_p == 0)
    low = record & ~off & (t_p < dem15.LEAST_T_P)
    lines.refuse(
        "generator-words",
        low,
        "t(p) {t_p} is {volts:.2f} V: below 7 V the pulse generator cuts out",
        "t(p) 119 or more; t(i) and t(p) 0 for a move with the generator off",
        field=5,
        t_p=t_p,
        volts=t_p * (dem15.VOLTS_T_P / dem15.CONTROL),
    )
    lines.refuse(
        "generator-words",
        record & ~off & ~low & (t_i == 0),
        "t(i) is 0: pulses without a duration cut nothing",
        "t(i) and t(p) 0 for a move with the generator off",
        field=4,
    )
    lines.refuse(
        "generator-words",
        record & ~off & ~low & dem15.too_much(t_i, t_p),
        "t(i) {t_i} with t(p) {t_p} would draw {amperes:.2f} A; the supply gives 2 A",
        "t(i) at most one and a half times t(p)",
        field=4,
        t_i=t_i,
        t_p=t_p,
        amperes=dem15.current(t_i, t_p),
    )


def _places(lines: _Lines, record: Bools, step: int) -> None:
    """Refuse places that no step arrives at, that do not follow, and vectors without length."""
    f = lines.fields
    odd = f[:, :4] % step != 0
    lines.refuse(
        "place-step",
        record & odd.any(axis=1),
        "a place of ({x}, {y}) to ({new_x}, {new_y}) is odd: steps of 2 um never arrive there",
        field=odd.argmax(axis=1),
        x=f[:, 0],
        y=f[:, 1],
        new_x=f[:, 2],
        new_y=f[:, 3],
    )
    lines.refuse(
        "zero-count",
        record & (f[:, 0] == f[:, 2]) & (f[:, 1] == f[:, 3]),
        "place and new place are the same: a vector without a step",
        field=2,
    )
    rows = np.flatnonzero(record)
    before = f[:, :2].copy()
    before[rows[1:]] = f[rows[:-1], 2:4]
    jumps = before != f[:, :2]
    lines.refuse(
        "place-jump",
        jumps.any(axis=1),
        "the place is ({x}, {y}), and the record before ends at ({before_x}, {before_y})",
        "a record is missing, or one of the two was changed",
        field=jumps.argmax(axis=1),
        x=f[:, 0],
        y=f[:, 1],
        before_x=before[:, 0],
        before_y=before[:, 1],
    )


def _end(lines: _Lines) -> None:
    """Refuse a file without an end, or with records behind it."""
    ends = np.flatnonzero(lines.kinds == Kind.STOP)
    if not len(ends):
        lines.say(
            error(
                "no-end",
                "the program has no end ({end})",
                FileSpan(lines.file),
                hint="end it so, and check whether the file was cut short",
                end=dem15.END,
            )
        )
        return
    after = np.zeros(len(lines.kinds), bool)
    after[ends[0] + 1 :] = True
    lines.refuse("after-end", after, "this stands behind the end of the program")


def records_in(data: bytes, file: str) -> tuple[str | None, list[str]]:
    r"""Return what positions count in a file, a key of `formats.dem15.UNITS`, and its records.

    As text with one blank between numbers; pauses and ends are records too. Of a file that is no
    program, the lines as they are.

    >>> records_in(b"um\n0  0 40 0 100 200 64\r\ne\n", "")
    ('um', ['0 0 40 0 100 200 64', 'E'])
    """
    lines = _Lines(data, file)
    sizes = zip(lines.starts.tolist(), lines._sizes, strict=True)
    codes = (lines.text.codes[start : start + size] for start, size in sizes)
    return lines.unit, [" ".join(code.decode("latin-1").split()) for code in codes]


def describe_blocks(data: bytes, machine: Machine) -> dict[str, str]:
    r"""Return what each record says of speed and generator, for people, by line:column.

    >>> from wedmcam.machines import default
    >>> describe_blocks(b"UM\n0 0 40 0 100 200 64\nE\n", default("dem15"))
    {'2:1': 'speed 64: 1.008 mm a minute, t(i) 1.96 V, t(p) 11.76 V, 0.67 A'}
    """
    lines = _Lines(data, "")
    out = {}
    for i in np.flatnonzero(lines.kinds == Kind.LINE).tolist():
        t_i, t_p, speed = lines.fields[i, 4:].tolist()
        span = lines.spans.at(int(lines.starts[i]))
        words = f"speed {speed}: {speed * dem15.SPEED_UM / 1000:.3f} mm a minute, "
        words += (
            "generator off"
            if not t_p
            else (
                f"t(i) {t_i * dem15.VOLTS_T_I / dem15.CONTROL:.2f} V, "
                f"t(p) {t_p * dem15.VOLTS_T_P / dem15.CONTROL:.2f} V, "
                f"{float(dem15.current(t_i, t_p)):.2f} A"
            )
        )
        out[f"{span.line}:{span.column}"] = words
    return out
