"""Which table of offsets counts: that of the file, of the user, or of a drawing."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from wedmcam.diag import Diagnostic, FileSpan, Severity, error, note, warning
from wedmcam.diag.lists import Listing
from wedmcam.frontends.iso import dialect as dialects
from wedmcam.frontends.iso.dialect import UNSAID
from wedmcam.frontends.iso.lengths import MOST_NM, digit_nm, point_nm
from wedmcam.frontends.iso.modes import Modes, Table, answers
from wedmcam.frontends.iso.offsets import Entry
from wedmcam.frontends.iso.reading import Reading, column, filled

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Tables:
    """What offsets are read by: the table that is given, whether assumed, and the unit a line."""

    given: Table | None
    assumed: bool
    inches: Ints


@dataclass(frozen=True, slots=True, eq=False)
class _Numbers:
    """The numbers of offsets: the letter that says them, and the number in force at every line."""

    letter: str
    d: Ints


def modes_of(r: Reading, comp: tuple[Ints, Bools], offsets: Bools, tables: Tables) -> Modes | None:
    """Return the state of compensation at every line; None where there is none, or no table.

    Args:
        r: takes the findings.
        comp: the G code of compensation that each line sets, and which lines set one.
        offsets: the words G41 and G42.
        tables: what offsets are read by.
    """
    _tell_tables(r, bool(offsets.any()))
    if not offsets.any():
        return None
    numbers = _numbers(r)
    if numbers is None:
        return None
    first = int(np.argmax(offsets))
    filed = _filed(r, tables.inches, (int(r.words.line[first]), int(r.words.start[first])))
    if filed is None:
        return None
    table = _table(r, numbers, offsets, tables, filed)
    if table is None:
        return None
    letter, d = numbers.letter, numbers.d
    # An offset that a drawing says is no entry.
    entered = [n for n in np.unique(d[d >= 0]).tolist() if n in filed or not tables.assumed]
    _tell_diameters(r, table, entered, letter)
    skewed = r.machine.iso.offset_change == "skewed"
    mm = r.machine.axes.step_um / 1000
    return Modes(filled(*comp, 40), comp[1], d, table, letter, skewed, mm)


def _numbers(r: Reading) -> _Numbers | None:
    """Return the numbers of offsets, by D or H; None, with a finding, where they are none."""
    value, has, pointed, _ = column(r, "D")
    letter = "D"
    h_value, h_has, h_pointed, _ = column(r, "H")
    both = np.flatnonzero(h_has) if has.any() else np.zeros(0, np.int64)
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        both,
        "D and H both number offsets in this file: the file does not say which counts",
        hint="leave one of them out",
    )
    if len(both):
        return None
    if h_has.any():
        letter, value, has, pointed = "H", h_value, h_has, h_pointed
    offset_word = r.machine.iso.offset_word
    other = has & (offset_word not in ("either", letter))
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        np.flatnonzero(other),
        "{letter} numbers no offset at this controller: the profile '{machine}' has {offset_word}",
        hint="another profile (--profile-in), or offset_word under [iso] of one of your own",
        letter=letter,
        machine=r.machine.name,
        offset_word=offset_word,
    )
    if other.any():
        return None
    wrong = has & (pointed | (value < 0))
    r.tell_lines(
        Severity.ERROR,
        "iso-d",
        np.flatnonzero(wrong),
        "{letter} is the number of an offset in the controller's table: whole, from 0 on",
        hint="{letter} with the number of the offset, such as G41 {letter}1",
        letter=letter,
    )
    return None if wrong.any() else _Numbers(letter, filled(value, has, -1))


def _table(
    r: Reading, numbers: _Numbers, offsets: Bools, tables: Tables, filed: dict[int, float]
) -> Table | None:
    """Return the table that counts; None, with a finding, where it lacks a number in use.

    ``offsets``: the words G41 and G42; ``filed``: the table of the file.
    """
    letter, d = numbers.letter, numbers.d
    lines = r.words.line[offsets]
    used: list[int] = np.unique(d[lines]).tolist()
    table = _merged(r, tables, filed, np.unique(d).tolist(), letter)
    missing = [n for n in used if n not in filed] if tables.given is None else []
    either = letter == "D" and r.machine.iso.offset_word == "either"
    if either and 0 in used and table(0) is None:
        first = int(np.argmax(offsets))
        finding = warning(
            "iso-offsets",
            "D0 is read as no offset; at some machines it is an entry of the table like others",
            r.spans[int(lines[0])],
            hint="--d 0=LENGTH says what is entered there",
        )
        r.findings.append((int(r.words.start[first]), finding))
        table = _none_for_0(table)
        missing = [n for n in missing if n != 0]
    if missing:
        r.tell_words(
            Severity.ERROR,
            "iso-compensation",
            offsets,
            "{words}: the controller offsets the path itself, by a table that the file has not "
            "({missing})",
            hint="give what is entered at the controller: {answers}",
            missing=[f"no {letter} at all" if n < 0 else f"{letter}{n}" for n in missing],
            answers=answers([abs(n) for n in missing]),
        )
        return None
    return table


def _none_for_0(table: Table) -> Table:
    """Return a table in which offset 0 is 0 where nothing else is said."""

    def known(number: int) -> float | None:
        um = table(number)
        return 0.0 if um is None and number == 0 else um

    return known


def _tell_diameters(r: Reading, table: Table, entered: list[int], letter: str) -> None:
    """Say what entries that are diameters mean; ``table`` is the one that counts."""
    factor = r.machine.iso.entry_factor
    if factor == 1:
        return
    mm = r.machine.axes.step_um / 1000
    entries = [
        f"{letter}{n} = {factor * um * mm:.4f} mm is a diameter: the wire runs {um * mm:.4f} mm "
        "beside the outline"
        for n in entered
        if (um := table(n))
    ]
    if entries:
        finding = note(
            "iso-offsets",
            "{entries}",
            FileSpan(r.file),
            count=len(entries),
            entries=Listing(entries, between="; "),
        )
        r.findings.append((0, finding))


def _tell_tables(r: Reading, used: bool) -> None:
    """Report tables of a file that change nothing."""
    for a, b in r.conditions[:1]:
        finding = warning(
            "iso-ignored",
            "{text}: a table of conditions, not read ({count} lines)"
            if len(r.conditions) > 1
            else "{text}: a table of conditions, not read",
            r.spans.at(a, b - a),
            hint="feed, generator and offset tables are set at the machine",
            count=len(r.conditions),
            text=r.plain.excerpt(a, b),
        )
        r.findings.append((a, finding))
    if r.entries and not used:
        one = r.entries[0]
        finding = note(
            "iso-offsets",
            "{text}: no G41 or G42 uses this table ({count} offsets)",
            r.spans.at(one.at, one.end - one.at),
            count=len(r.entries),
            text=r.plain.excerpt(one.at, one.end),
        )
        r.findings.append((one.at, finding))


def _filed(r: Reading, inches: Ints, first_use: tuple[int, int]) -> dict[int, float] | None:
    """Return the offsets of the file's own table, number to um; None where it cannot be read.

    ``first_use``: the line that runs the first G41 or G42, and where in the text that stands.
    """
    stated = np.unique(inches[inches != UNSAID])
    nm: dict[int, Decimal] = {}
    wrong = False
    for entry in r.entries:
        line = r.line_of(entry.at)
        inch = int(inches[line]) if len(stated) != 1 else int(stated[0])
        point, digit = point_nm(r, inch), digit_nm(r, inch)
        value = entry.pointed * point + entry.whole * (digit or 0)
        value += sum(sign * nm.get(n, Decimal(0)) for sign, n in entry.refers)
        unset = [n for _, n in entry.refers if n not in nm]
        problem = None
        if unset:
            problem = _refusal(
                r, entry, "{text}: H{unset} is set nowhere before it", unset=unset[0]
            )
        elif (line, entry.at) > first_use:
            problem = _refusal(
                r,
                entry,
                "{text}: it is set behind the first G41 or G42: what was in force there is not "
                "known",
            )
        elif len(stated) == 2 and inch == UNSAID and (entry.pointed or entry.whole):
            problem = _refusal(
                r, entry, "{text}: the file has inches and mm, and neither is in force here"
            )
        elif entry.whole and digit is None:
            problem = _refusal(
                r,
                entry,
                "{text}: a whole number in inches: the file does not say what its last digit is",
            )
        elif nm.setdefault(entry.number, value) != value:
            problem = _refusal(r, entry, "{text}: the offset is set twice, to different values")
        elif value < 0 or value > MOST_NM:
            problem = _refusal(
                r,
                entry,
                "{text}: an offset is from 0 to a kilometre; G41 and G42 tell the side (one below "
                "0 would be the same offset with the other of the two)",
            )
        if problem is not None:
            r.findings.append((entry.at, problem))
            wrong = True
    r.questions += dialects.of_table(r.entries, r.dialect, r.plain, bool(len(stated)))
    factor = r.machine.iso.entry_factor
    return None if wrong else {n: float(v / 1000 / factor) for n, v in nm.items()}


def _refusal(r: Reading, entry: Entry, template: str, **values: object) -> Diagnostic:
    """Return the finding about an entry of a table; ``{text}`` is what stands there."""
    return error(
        "iso-d",
        template,
        r.spans.at(entry.at, entry.end - entry.at),
        hint="put the table right, in front of the first G41 or G42",
        text=r.plain.excerpt(entry.at, entry.end),
        **values,
    )


def _merged(
    r: Reading, tables: Tables, filed: dict[int, float], used: list[int], letter: str
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
        unit = step * r.machine.iso.entry_factor
        if other is None or abs(other - mine) < 0.05:
            finding = note(
                "iso-offsets",
                "{letter}{number} = {file_mm:.4f} mm, of the table in the file",
                place,
                letter=letter,
                number=n,
                file_mm=mine * unit,
            )
        else:
            finding = warning(
                "iso-offsets",
                "{letter}{number} = {file_mm:.4f} mm, of the table in the file; that of the "
                "drawing is {other_mm:.4f} mm: the table of the file counts"
                if tables.assumed
                else "{letter}{number} = {file_mm:.4f} mm, of the table in the file; --d is "
                "{other_mm:.4f} mm: --d counts",
                place,
                hint="see which is entered at the machine",
                letter=letter,
                number=n,
                file_mm=mine * unit,
                other_mm=other * unit,
            )
        r.findings.append((entry.at, finding))
    own = {n: um for n, um in filed.items() if tables.assumed or entered.get(n) is None}
    given = tables.given
    return lambda n: own[n] if n in own else given(n) if given is not None else None
