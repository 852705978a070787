"""Read a profile: TOML text in, `Machine` and findings out.

A key that is not read is an error and not a comment: a misspelt limit would otherwise be no limit.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

from wedmcam.diag import Diagnostic, FileSpan, Span, TextSpan, error
from wedmcam.diag.toml import read_toml
from wedmcam.machines import around
from wedmcam.machines.machine import Axes, Iso, Layout, Limits, Machine, Vectors, Words
from wedmcam.machines.vocabulary import CLASSES, Vocabulary, calls_in, wrong_words

FORMATS = ("3b", "compact", "rotation", "compensation", "iso", "4b", "dem15", "nby15")
#: Formats whose files are bytes of a memory.
_BINARY = ("compact", "rotation", "compensation")
_EOL = {"lf": "\n", "crlf": "\r\n", "cr": "\r"}
_ENCODINGS = ("ascii", "utf-8", "gbk")


@dataclass(frozen=True, slots=True)
class _Key:
    """What one key takes. ``of`` is the TOML type; ``good`` says whether a value will do."""

    of: type
    takes: str
    good: Callable[[Any], bool]
    required: bool = False
    formats: tuple[str, ...] = FORMATS


def _choice(*values: str, required: bool = False, formats: tuple[str, ...] = FORMATS) -> _Key:
    takes = " or ".join(f'"{v}"' for v in values)
    return _Key(str, takes, lambda v: v in values, required, formats)


def _whole(low: int, high: int, required: bool = False, formats: tuple[str, ...] = FORMATS) -> _Key:
    takes = f"a whole number, {low} to {high}"
    return _Key(int, takes, lambda v: low <= v <= high, required, formats)


def _blanks(text: str) -> bool:
    return all(c in " \t" for c in text)


def _lines(value: list[Any]) -> bool:
    return all(isinstance(v, str) and (v == "" or v.isprintable()) for v in value)


def _is_text(line: str) -> bool:
    # What every reader takes for text: a record or a control word in a header would be run.
    return bool(re.fullmatch(r";.*|[*%]*", line))


def _pair(value: list[Any]) -> bool:
    return len(value) == 2 and all(type(v) is int and 0 < v <= _UM for v in value)


_B3 = ("3b", "4b")
_ISO = ("iso",)
_READABLE = (*_B3, *_ISO)
_VECTORS = ("dem15",)
_STEPPED = ("3b", "iso", "compact", *_VECTORS)
_TABLES = tuple(f for f in FORMATS if f not in _VECTORS)
_TEXT = _Key(str, "text of one line", lambda v: v != "" and "\n" not in v, required=True)
_BLANKS = _Key(str, "blanks or nothing", _blanks, formats=_B3)
_WORD = _Key(
    # B alone would be the start of a record.
    str,
    "a word of 1 to 8 capital letters other than B",
    lambda v: v != "B" and bool(re.fullmatch("[A-Z]{1,8}", v)),
    formats=_B3,
)
# The NBY-15 has switches for the directions of its axes: they are set, and in no profile.
_FLAG = _Key(
    bool, "true or false", lambda v: True, formats=tuple(f for f in FORMATS if f != "nby15")
)
_LINES = _Key(
    list,
    "a list of lines; in 3B and 4B they start with a semicolon or are rows of * or %",
    _lines,
    formats=_READABLE,
)
#: How far a step of the DEM-15 moves it, um.
VECTOR_STEP_UM = 2.0
_UM = 10**9  # a kilometre: larger than any table, and sums of it stay far inside 64 bits

_SCHEMA: dict[str, dict[str, _Key]] = {
    "": {
        "title": _TEXT,
        "format": _choice(*FORMATS, required=True),
        "line_table": _choice("mirror", "rotate", required=True, formats=_TABLES),
        "count": _choice("exact", "textbook"),
        "writes": _Key(bool, "true or false", lambda v: True, formats=_ISO),
    },
    "limits": {
        # 3B fields have six digits; the compact format stores J in three BCD bytes, a line's x and
        # y in three and an arc's in four.
        # Below a millimetre a plate would take a million blocks, and no controller is so small.
        "count_um": _whole(1000, 999_999, True),
        "line_um": _whole(1000, 999_999, True),
        "arc_um": _whole(1000, 99_999_999, True),
        "memory_bytes": _whole(18, _UM, formats=_BINARY),
        "blocks": _whole(1, _UM, formats=_READABLE),
        "line_chars": _whole(20, 10_000, formats=_ISO),
        "travel_um": _Key(list, "two whole numbers of um, x and y", _pair),
    },
    "axes": {
        "exchange": _FLAG,
        "mirror_x": _FLAG,
        "mirror_y": _FLAG,
        # With the others the controller computes, in um: gaps, rotations.
        "step_um": _Key(
            float, "a number of um, 0.01 to 100", lambda v: 0.01 <= v <= 100, formats=_STEPPED
        ),
    },
    "words": {"pause": _WORD, "stop": _WORD, "end": _WORD},
    "layout": {
        "after_b": _BLANKS,
        "between": _BLANKS,
        "width": _whole(1, 20, formats=_B3),
        "count_digits": _whole(1, 6, formats=_B3),
        "number_width": _whole(0, 9, formats=_READABLE),
        "after_number": _Key(
            str, '"", " ", ":" or ": "', lambda v: bool(re.fullmatch(":?[ \t]*", v)), formats=_B3
        ),
        "header": _LINES,
        "footer": _LINES,
        "end_coordinates": _Key(bool, "true or false", lambda v: True, formats=_B3),
        "eol": _Key(str, '"lf", "crlf" or "cr"', lambda v: v in _EOL, formats=_READABLE),
        "encoding": _Key(
            str, " or ".join(_ENCODINGS), lambda v: v in _ENCODINGS, formats=_READABLE
        ),
    },
    "iso": {
        "coordinates": _choice("incremental", "absolute", "open", formats=_ISO),
        "unit": _choice("um", "mm", formats=_ISO),
        "integers": _choice("um", "mm", "inch", "0.0001in", "open", formats=_ISO),
        "points": _choice("mm", "inch", "open", formats=_ISO),
        "ij": _choice("start", "absolute", "to-start", "open", formats=_ISO),
        "semicolon": _choice("block", "comment", formats=_ISO),
        "subprograms": _choice("none", "N-label", "O-number", formats=_ISO),
        "code_digits": _whole(1, 2, formats=_ISO),
        "rapid": _Key(bool, "true or false", lambda v: True, formats=_ISO),
        "sign": _choice("negative", "always", formats=_ISO),
        "width": _whole(1, 12, formats=_ISO),
        "decimals": _whole(3, 5, formats=_ISO),
        "compensation": _choice("computed", "controller", formats=_ISO),
        "full_circle": _choice("halves", "one", formats=_ISO),
        "d": _whole(0, 999, formats=_ISO),
        "offsets": _choice("radius", "diameter", formats=_ISO),
        "offset_word": _choice("either", "D", "H", formats=_ISO),
        "offset_change": _choice("refused", "skewed", formats=_ISO),
        "start": _choice("g92", "move", formats=_ISO),
        "feed_um": _whole(1, _UM, formats=_ISO),
        "packed_calls": _Key(bool, "true or false", lambda v: True, formats=_ISO),
        "arc_least_um": _whole(1, 1000, formats=_ISO),
        "modes": _Key(
            str,
            "G codes, such as G21 G17",
            lambda v: bool(re.fullmatch(r"(G\d{1,3}(\.\d)? ?)*", v)),
            formats=_ISO,
        ),
        "feed_least_um": _whole(1, _UM, formats=_ISO),
        "between": _Key(str, "blanks or nothing", _blanks, formats=_ISO),
    },
    "vectors": {
        "direction": _choice("root", "sines", formats=_VECTORS),
        "positions": _choice("um", "steps", formats=_VECTORS),
        "speed": _whole(1, 127, formats=_VECTORS),
        "t_i": _whole(1, 255, formats=_VECTORS),
        "t_p": _whole(1, 255, formats=_VECTORS),
    },
}
_TYPE_NAMES: dict[type, str] = {
    str: "text",
    int: "a whole number",
    float: "a number",
    bool: "true or false",
}


@dataclass(frozen=True, slots=True)
class _Source:
    """The text of a profile, and the name that findings call it by."""

    text: str
    name: str

    def at(self, section: str, key: str) -> Span:
        """Return where ``key`` stands, as far as a search of lines can tell."""
        here = ""
        assigned = re.compile(rf"(\s*)(\"?{re.escape(key)}\"?)\s*[=.]")
        for number, line in enumerate(self.text.splitlines(), 1):
            if table := re.match(r"\s*\[\s*([\w.-]+)\s*\]", line):
                here = table[1]
                if here == key and not section:
                    return TextSpan(self.name, number, 1, len(line))
            elif here == section and (m := assigned.match(line)):
                return TextSpan(self.name, number, len(m[1]) + 1, len(m[2]))
        return FileSpan(self.name)


def _named(section: str, key: str) -> str:
    return f"{section}.{key}" if section else key


def _unknown_key(
    name: str, key: str, known: list[str], span: Span, format_: str | None = None
) -> Diagnostic:
    """Return an error on a key that is not read, with the key that may be meant.

    Args:
        name: of the key, with its table.
        key: as it stands there.
        known: keys that are read there.
        span: where it stands.
        format_: of the profile, where other formats have the key.
    """
    near = difflib.get_close_matches(key, known, 1, 0.6)
    return error(
        "profile-key",
        "unknown key '{key}'" if format_ is None else "unknown key '{key}' for format '{format}'",
        span,
        hint="did you mean '{near}'?" if near else "known are {known}" if known else "remove it",
        key=name,
        format=format_,
        near=near[0] if near else None,
        known=", ".join(known),
    )


def _check(
    source: _Source, section: str, table: dict[str, Any], format_: str
) -> tuple[dict[str, Any], list[Diagnostic]]:
    """Return the good values of one table, and what is wrong with the others."""
    findings: list[Diagnostic] = []
    good: dict[str, Any] = {}
    schema = {k: v for k, v in _SCHEMA[section].items() if format_ in v.formats}
    for key, value in table.items():
        if not section and key in _SCHEMA and key:
            continue  # a table, checked by itself
        rule, name = schema.get(key), _named(section, key)
        if rule is None:
            known = [*schema, *(s for s in _SCHEMA if s and not section)]
            elsewhere = format_ if key in _SCHEMA[section] else None
            findings.append(_unknown_key(name, key, known, source.at(section, key), elsewhere))
        elif type(value) is int and rule.of is float and rule.good(value):
            good[key] = float(value)
        elif type(value) is not rule.of or not rule.good(value):
            findings.append(_wrong_value(name, value, rule, source.at(section, key)))
        else:
            good[key] = value
    findings += [
        error(
            "profile-missing",
            "'{key}' is missing; it takes {takes}",
            FileSpan(source.name),
            key=_named(section, key),
            takes=rule.takes,
        )
        for key, rule in schema.items()
        if rule.required and key not in table
    ]
    return good, findings


def _wrong_value(name: str, value: Any, rule: _Key, span: Span) -> Diagnostic:
    """Return an error on a value that a key does not take."""
    kind = _TYPE_NAMES.get(type(value))
    same_type = kind is None or type(value) is rule.of
    return error(
        "profile-value",
        "'{key}' takes {takes}, not {value}"
        if same_type
        else "'{key}' takes {takes}, not {type} {value}",
        span,
        key=name,
        takes=rule.takes,
        type=kind,
        value=repr(value),
    )


def _of_iso(
    source: _Source, iso: dict[str, Any], header: list[str], writes: bool
) -> list[Diagnostic]:
    """Return what contradicts itself under ``[iso]``; header and writes are of the same profile."""
    findings = []
    metric = around.metric([*header, iso.get("modes", "")], iso.get("semicolon", ""))
    if iso.get("points") == "inch" and iso.get("unit") == "mm" and writes and not metric:
        findings.append(
            error(
                "profile-value",
                '\'iso.points\' = "inch" goes with unit = "mm" where header or modes have G21 or '
                "G71, or with writes = false: its own programs would be read in inches",
                source.at("iso", "points"),
            )
        )
    if iso.get("start") == "move" and iso.get("coordinates") != "absolute":
        findings.append(
            error(
                "profile-value",
                '\'iso.start\' = "move" goes to a place: it takes coordinates = "absolute"',
                source.at("iso", "start"),
            )
        )
    if iso.get("feed_um") and iso.get("unit") != "mm":
        findings.append(
            error(
                "profile-value",
                "'iso.feed_um' is written in mm a minute: it takes unit = \"mm\"",
                source.at("iso", "feed_um"),
            )
        )
    return findings


def _words_of(
    source: _Source, data: dict[str, Any], format_: str
) -> tuple[Vocabulary, list[Diagnostic]]:
    """Return the words under ``[iso.words]``, which it takes out of the data of a profile."""
    iso = data.get("iso")
    if format_ not in _ISO or not isinstance(iso, dict) or "words" not in iso:
        return Vocabulary(), []
    data["iso"] = {key: value for key, value in iso.items() if key != "words"}
    tables, findings = _word_tables(source, iso["words"])
    for class_, key, fault in wrong_words(tables):
        findings.append(
            error(
                "profile-value",
                "'iso.words.{table}' {key}: {fault}",
                source.at(f"iso.words.{class_}", key),
                table=class_,
                key=key,
                fault=fault,
            )
        )
    if findings:
        return Vocabulary(), findings
    calls = [key for key in tables.get("path", {}) if calls_in(key)]
    if calls and data["iso"].get("subprograms", "none") == "none":
        findings.append(
            error(
                "profile-value",
                "'iso.words.path' {key}: it takes 'iso.subprograms'",
                source.at("iso.words.path", calls[0]),
                key=calls[0],
            )
        )
    return Vocabulary(**{name: tuple(table.items()) for name, table in tables.items()}), findings


def _word_tables(source: _Source, words: Any) -> tuple[dict[str, dict[str, Any]], list[Diagnostic]]:
    """Return the tables under ``[iso.words]``, and what of them is none."""
    if not isinstance(words, dict):
        return {}, [_no_table("iso.words", words, source.at("iso", "words"))]
    findings: list[Diagnostic] = []
    tables: dict[str, dict[str, Any]] = {}
    for key, value in words.items():
        name = f"iso.words.{key}"
        if key not in CLASSES:
            findings.append(_unknown_key(name, key, list(CLASSES), source.at("", name)))
        elif not isinstance(value, dict):
            findings.append(_no_table(name, value, source.at("", name)))
        else:
            tables[key] = value
    return tables, findings


def _no_table(name: str, value: Any, span: Span) -> Diagnostic:
    """Return an error on a value where a table is to be."""
    return error(
        "profile-value", "'{key}' takes a table, not {value}", span, key=name, value=repr(value)
    )


def parse(text: str, name: str) -> tuple[Machine | None, list[Diagnostic]]:
    """Return the machine that a TOML profile describes.

    Args:
        text: TOML; lengths in um.
        name: of the profile or its file; findings point to it.

    Returns:
        The machine, or None when there are errors; all errors at once.
    """
    data, wrong = read_toml(text, name, "profile-syntax")
    if wrong is not None:
        return None, [wrong]

    source = _Source(text, name)
    format_ = data.get("format")
    known_format = format_ if format_ in FORMATS else "3b"
    vocabulary, unfit = _words_of(source, data, known_format)
    top, findings = _check(source, "", data, known_format)
    findings += unfit
    tables: dict[str, dict[str, Any]] = {}
    for section in [s for s in _SCHEMA if s]:
        value = data.get(section, {})
        if not isinstance(value, dict):
            findings.append(_no_table(section, value, source.at("", section)))
            value = {}
        tables[section], more = _check(source, section, value, known_format)
        findings += more
    findings += _contradictions(source, known_format, top, tables)
    findings += _lines_around(source, known_format, tables["layout"])
    return (None, findings) if findings else (_machine(name, top, tables, vocabulary), [])


def _contradictions(
    source: _Source, format_: str, top: dict[str, Any], tables: dict[str, dict[str, Any]]
) -> list[Diagnostic]:
    """Return what keys say that are good one by one and do not go together."""
    findings: list[Diagnostic] = []
    words, iso, writes = Words(**tables["words"]), tables["iso"], top.get("writes", True)
    if len({words.pause, words.stop, words.end}) < 3:
        findings.append(
            error(
                "profile-value",
                "pause '{pause}', stop '{stop}' and end '{end}' must differ",
                source.at("", "words"),
                pause=words.pause,
                stop=words.stop,
                end=words.end,
            )
        )
    if format_ in _B3 and tables["limits"].get("arc_um", 0) > 999_999:
        findings.append(
            error(
                "profile-value",
                "'limits.arc_um' of a 3B or 4B profile is at most 999999",
                source.at("limits", "arc_um"),
            )
        )
    if iso.get("compensation") == "controller" and tables["axes"].get("step_um", 1) != 1:
        findings.append(
            error(
                "profile-value",
                "'axes.step_um' goes with compensation in the program: outlines are written in um",
                source.at("axes", "step_um"),
            )
        )
    if format_ in _VECTORS and tables["axes"].get("step_um") != VECTOR_STEP_UM:
        findings.append(
            error(
                "profile-value",
                "'axes.step_um' of this controller is {step_um:g}: a step of it is so many um",
                source.at("axes", "step_um"),
                step_um=VECTOR_STEP_UM,
            )
        )
    if format_ not in _ISO:
        return findings
    header, footer = (tables["layout"].get(key, []) for key in ("header", "footer"))
    findings += _of_iso(source, iso, header, writes)
    for key, fault in around.faults(header, footer, iso.get("semicolon", "")):
        findings.append(
            error(
                "profile-value",
                "'layout.{key}': {fault}",
                source.at("layout", key),
                key=key,
                fault=fault,
            )
        )
    if iso.get("coordinates") == "open" and writes:
        findings.append(
            error(
                "profile-value",
                "'iso.coordinates' = \"open\" cannot be written: it takes writes = false",
                source.at("iso", "coordinates"),
            )
        )
    return findings


def _lines_around(source: _Source, format_: str, layout: dict[str, Any]) -> list[Diagnostic]:
    """Return what is wrong with the lines of header and footer, one by one."""
    findings = []
    encoding = layout.get("encoding", "ascii")
    header, footer = (layout.get(key, []) for key in ("header", "footer"))
    for key, line in [*(("header", one) for one in header), *(("footer", one) for one in footer)]:
        # Words of an ISO header are decoded and proven with the program.
        if format_ not in _ISO and not _is_text(line):
            findings.append(
                error(
                    "profile-value",
                    "'layout.{key}' takes {takes}, not {line}",
                    source.at("layout", key),
                    key=key,
                    takes=_LINES.takes,
                    line=repr(line),
                )
            )
        try:
            line.encode(encoding)
        except UnicodeEncodeError:
            findings.append(
                error(
                    "profile-value",
                    "'layout.{key}' does not fit the encoding {encoding}: '{line}'",
                    source.at("layout", key),
                    key=key,
                    encoding=encoding,
                    line=line,
                )
            )
    return findings


def _machine(
    name: str,
    top: dict[str, Any],
    tables: dict[str, dict[str, Any]],
    vocabulary: Vocabulary,
) -> Machine:
    """Return the machine of a profile without errors."""
    layout, limits = dict(tables["layout"]), dict(tables["limits"])
    for key in ("header", "footer"):
        if key in layout:
            layout[key] = tuple(layout[key])
    if "eol" in layout:
        layout["eol"] = _EOL[layout["eol"]]
    if "travel_um" in limits:
        limits["travel_um"] = tuple(limits["travel_um"])
    table: Literal["mirror", "rotate"] = top.get("line_table", "mirror")
    count: Literal["exact", "textbook"] = top.get("count", "exact")
    return Machine(
        name=name,
        title=top["title"],
        format=top["format"],
        line_table=table,
        count=count,
        limits=Limits(**limits),
        words=Words(**tables["words"]),
        layout=Layout(**layout),
        iso=Iso(**tables["iso"], words=vocabulary),
        axes=Axes(**tables["axes"]),
        vectors=Vectors(**tables["vectors"]),
        writes=top.get("writes", True),
    )
