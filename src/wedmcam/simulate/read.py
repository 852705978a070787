"""Read a scenario: TOML text in, `Conditions` and findings out.

A key that is not read is an error and not a comment: a misspelt fault would otherwise never happen.
Every finding names the line of its entry.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from wedmcam.diag import Diagnostic, TextSpan, error
from wedmcam.diag.toml import read_toml
from wedmcam.simulate.conditions import FEEDS, LARGEST, MOST_RANDOM, Conditions
from wedmcam.simulate.scenario import Fault, Trouble

#: Largest number of a step.
_STEP = 999_999_999
_SIGNS = {"+": 1, "-": -1}


@dataclass(frozen=True, slots=True)
class _Key:
    """What an entry takes, in words, and whether a value will do."""

    takes: str
    good: Callable[[Any], bool]


def _whole(low: int, high: int) -> _Key:
    return _Key(f"a whole number, {low} to {high}", lambda v: type(v) is int and low <= v <= high)


def _pair(what: str, good: Callable[[Any], bool]) -> _Key:
    return _Key(what, lambda v: isinstance(v, list) and len(v) == 2 and all(map(good, v)))


def _is_rate(value: Any) -> bool:
    return type(value) in (int, float) and FEEDS[0] <= value <= FEEDS[1]


def _choice(*words: str) -> _Key:
    takes = " or ".join(f'"{word}"' for word in words)
    return _Key(takes, lambda v: isinstance(v, str) and v in words)


_LENGTHS = _pair(
    f"two whole numbers of um, 0 to {LARGEST}, as in [12, 15]",
    lambda v: type(v) is int and 0 <= v <= LARGEST,
)
_DIRECTIONS = _pair('two signs, as in ["+", "-"]', lambda v: isinstance(v, str) and v in _SIGNS)
_RATE = _Key(f"steps a second, {FEEDS[0]:g} to {FEEDS[1]:g}", _is_rate)
#: Table -> entry -> what it takes. "" holds what stands before all tables.
_SCHEMA: dict[str, dict[str, _Key]] = {
    "": {
        "backlash": _LENGTHS,
        "play": _LENGTHS,
        "approach": _DIRECTIONS,
        "true_approach": _DIRECTIONS,
        "feed": _RATE,
        "return_ms": _whole(1, LARGEST),
        "dry_ms": _whole(1, LARGEST),
    },
    "random": {"faults": _whole(1, MOST_RANDOM), "seed": _whole(0, _STEP)},
    "feed_change": {"step": _whole(0, _STEP), "feed": _RATE},
    "fault": {
        "kind": _choice(*Trouble),
        "step": _whole(0, _STEP),
        "length": _whole(1, _STEP),
        "block": _whole(1, _STEP),
        "pulses": _whole(0, LARGEST),
        "power_after": _whole(0, _STEP),
        "operator": _choice("stop", "continue"),
    },
}
_NEEDED = {
    "random": {"faults", "seed"},
    "feed_change": {"step", "feed"},
    "fault": {"kind", "step"},
}
#: Tables that a file may hold several times, as [[fault]].
_LISTS = ("feed_change", "fault")
#: Kind of a fault -> the entries that mean something for it.
_OF_KIND = {
    Trouble.SHORT: {"length", "power_after", "operator"},
    Trouble.BREAK: {"block", "power_after"},
    Trouble.POWER: {"pulses"},
    Trouble.STOP: set(),
    Trouble.LIMIT: {"operator"},
    Trouble.TAPE: set(),
}


def read_scenario(text: str, name: str) -> tuple[Conditions | None, list[Diagnostic]]:
    """Return the conditions that a scenario states, or everything that is wrong with it.

    Args:
        text: of the file; any.
        name: of the file, for the spans.
    """
    data, wrong = read_toml(text, name, "bad-scenario")
    if wrong is not None:
        return None, [wrong]
    lines = _Lines(text, name)
    findings = list(_wrong_entries(data, lines))
    if findings:
        return None, findings
    return _conditions(data, lines), []


class _Lines:
    """Where the entries of a text stand."""

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        self._at: dict[tuple[str, int, str], int] = {}
        table, counts = "", dict.fromkeys(_SCHEMA, 0)
        for number, line in enumerate(text.splitlines(), 1):
            head = re.match(r"\s*\[\[?\s*\"?([A-Za-z_]+)\"?\s*\]\]?", line)
            if head:
                table = head[1]
                counts[table] = counts.get(table, 0) + 1
                self._at.setdefault((table, counts[table] - 1, ""), number)
                continue
            entry = re.match(r"\s*\"?([A-Za-z0-9_-]+)\"?\s*[=.]", line)
            if entry:
                nth = max(counts.get(table, 0) - 1, 0)
                self._at.setdefault((table, nth, entry[1]), number)

    def span(self, table: str, nth: int, entry: str) -> TextSpan:
        """Return the place of an entry, else of its table, else of the text."""
        for key in ((table, nth, entry), (table, nth, ""), ("", 0, table)):
            if key in self._at:
                return TextSpan(self.name, self._at[key], 1)
        return TextSpan(self.name, 1, 1)


def _wrong_entries(data: dict[str, Any], lines: _Lines) -> Iterator[Diagnostic]:
    """Yield what is wrong with the entries, each by itself."""
    plain = {name: value for name, value in data.items() if name not in _NEEDED}
    yield from _wrong_table("", 0, plain, lines)
    for table in _NEEDED:
        if table not in data:
            continue
        rows = data[table]
        if table not in _LISTS:
            rows = [rows]
        if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
            span = lines.span(table, 0, "")
            text = "{table} is written as {how}"
            how = f"[[{table}]]" if table in _LISTS else f"[{table}]"
            yield error("bad-scenario", text, span, table=table, how=how)
            continue
        for nth, row in enumerate(rows):
            yield from _wrong_table(table, nth, row, lines)


def _wrong_table(table: str, nth: int, row: dict[str, Any], lines: _Lines) -> Iterator[Diagnostic]:
    schema = _SCHEMA[table]
    where = f" in [[{table}]]" if table in _LISTS else f" in [{table}]" if table else ""
    for name, value in row.items():
        span = lines.span(table, nth, name)
        if name not in schema:
            near = difflib.get_close_matches(name, [*schema, *_NEEDED], 1)
            unknown = "no entry{where} is called {name}"
            found = error("bad-scenario", unknown, span, where=where, name=name)
            if near:
                yield found.with_hint("did you mean {near}?", near=near[0])
            else:
                yield found.with_hint("entries: {entries}", entries=sorted(schema))
        elif not schema[name].good(value):
            wrong = "{name}{where} takes {takes}"
            takes = schema[name].takes
            yield error("bad-scenario", wrong, span, name=name, where=where, takes=takes)
    missing = sorted(_NEEDED.get(table, set()) - row.keys())
    if missing:
        span = lines.span(table, nth, "")
        lacks = "{names} missing{where}"
        yield error("bad-scenario", lacks, span, names=missing, where=where)
    elif table == "fault" and row["kind"] in set(Trouble):
        yield from _wrong_fault(nth, row, lines)


def _wrong_fault(nth: int, row: dict[str, Any], lines: _Lines) -> Iterator[Diagnostic]:
    kind = Trouble(row["kind"])
    for name in row.keys() & _SCHEMA["fault"].keys() - {"kind", "step"} - _OF_KIND[kind]:
        span = lines.span("fault", nth, name)
        text = "{name} means nothing for a fault of the kind {kind}"
        yield error("bad-scenario", text, span, name=name, kind=str(kind))
    if kind is Trouble.SHORT and "length" not in row:
        span = lines.span("fault", nth, "")
        yield error(
            "bad-scenario",
            "a short circuit has a length: how far the wire goes back until it is free, um",
            span,
        )


def _conditions(data: dict[str, Any], lines: _Lines) -> Conditions:
    """Return the conditions of good data."""
    values: dict[str, Any] = {}
    for name in ("backlash", "play"):
        values[name] = tuple(data[name]) if name in data else None
    for name in ("approach", "true_approach"):
        values[name] = tuple(_SIGNS[sign] for sign in data[name]) if name in data else None
    for name in ("feed", "return_ms", "dry_ms"):
        values[name] = data.get(name)
    drawn = data.get("random")
    return Conditions(
        **values,
        random=None if drawn is None else (drawn["faults"], drawn["seed"]),
        faults=tuple(
            Fault(
                Trouble(row["kind"]),
                row["step"],
                length=row.get("length", 0),
                block=row.get("block"),
                pulses=row.get("pulses", 0),
                cut_after=row.get("power_after"),
                goes_on=row.get("operator") == "continue",
                span=lines.span("fault", nth, "step"),
            )
            for nth, row in enumerate(data.get("fault", []))
        ),
        feeds=tuple((row["step"], float(row["feed"])) for row in data.get("feed_change", [])),
    )
