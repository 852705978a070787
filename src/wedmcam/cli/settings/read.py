"""A settings file becomes settings; everything that is wrong with it is found at once."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from wedmcam import machines
from wedmcam.cli.lengths import Length, Point
from wedmcam.cli.settings.keys import PROFILES, known_options, of_one_run
from wedmcam.cli.settings.layers import take_layers
from wedmcam.cli.terminal import coloured
from wedmcam.diag import Diagnostic, TextSpan, error
from wedmcam.diag.render import render
from wedmcam.diag.toml import read_toml
from wedmcam.formats.names import PROGRAM_FORMATS, SOURCE_FORMATS


@dataclass(frozen=True, slots=True)
class Setting:
    """One key of one file.

    Attributes:
        key: long name of the option, without dashes.
        value: as the option takes it (lengths in um).
        written: as it stands in the file.
        span: of the value.
        folder: of the file; names of files are relative to it.
    """

    key: str
    value: Any
    written: Any
    span: TextSpan
    folder: Path


@dataclass(frozen=True, slots=True)
class File:
    """A settings file that was read: its settings, what is wrong with it, and its text."""

    name: str
    settings: dict[str, Setting]
    findings: tuple[Diagnostic, ...]
    text: str


class BadSettings(click.ClickException):
    """A settings file is wrong: exit status 2, all findings with their lines."""

    exit_code = 2

    def __init__(self, findings: Iterable[tuple[Diagnostic, str]]) -> None:
        self.findings = tuple(findings)
        super().__init__(self.rendered(False))

    def rendered(self, colour: bool) -> str:
        """Return the findings as lines."""
        return "\n".join(render(d, "", colour, text) for d, text in self.findings)

    def show(self, file: Any = None) -> None:
        """Print the findings."""
        click.echo(self.rendered(coloured()), err=True)


def load(path: Path, ctx: click.Context) -> File:
    """Return a settings file as read."""
    name = _shown(path)
    try:
        text = path.read_bytes().decode("utf-8")
    except OSError as why:
        wrong = error(
            "settings-syntax", "cannot be read: {why}", TextSpan(name, 1, 1), why=why.strerror
        )
    except UnicodeDecodeError:
        wrong = error("settings-syntax", "not UTF-8", TextSpan(name, 1, 1))
    else:
        group = ctx.find_root().command
        assert isinstance(group, click.Group)
        return read_text(text, name, path.parent, known_options(group))
    return File(name, {}, (wrong,), "")


def _shown(path: Path) -> str:
    """Return a path as people know it: from here, where it is below here."""
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


def read_text(text: str, name: str, folder: Path, known: Mapping[str, click.Option]) -> File:
    """Return the settings of one file.

    Args:
        text: of the file.
        name: in findings.
        folder: of the file.
        known: key -> option.
    """
    data, wrong = read_toml(text, name, "settings-syntax")
    if wrong is not None:
        return File(name, {}, (wrong,), text)
    line_of_layers = _placed(text, "layers")[0]
    layers, findings = take_layers(data, text, name, line_of_layers, known)
    settings: dict[str, Setting] = {}
    for key, value in data.items():
        line, column, length, value_column, value_length = _placed(text, key)
        option = known.get(key)
        if option is None or of_one_run(option):
            span = TextSpan(name, line, column, length)
            findings.append(_unknown(key, value, option, span, known))
            continue
        setting = _setting(
            key, value, option, TextSpan(name, line, value_column, value_length), folder
        )
        if isinstance(setting, Diagnostic):
            findings.append(setting)
        else:
            settings[key] = setting
    for key, values in layers.items():
        before = settings[key].value if key in settings else ()
        span = TextSpan(name, line_of_layers, 1)
        settings[key] = Setting(key, (*before, *values), data.get(key, values), span, folder)
    return File(name, settings, tuple(findings), text)


def _placed(text: str, key: str) -> tuple[int, int, int, int, int]:
    """Return line, column and length of a key, and column and length of its value.

    The file is flat, so a search of lines finds it.
    """
    at = re.compile(rf"(\s*)([\"']?){re.escape(key)}\2\s*(?=[.=])=?\s*")
    for number, line in enumerate(text.splitlines(), 1):
        if m := at.match(line):
            start = len(m[1])
            name = re.match(r"[\"']?[^\s\"'=.]*[\"']?", line[start:])
            length = len(name[0]) if name else 1
            rest = re.match(r"\"(?:[^\"\\]|\\.)*\"|'[^']*'|[^#]*", line[m.end() :])
            value = rest[0].rstrip() if rest else ""
            return number, start + 1, length, m.end() + 1, max(1, len(value))
        if (m := re.match(r"\s*\[+\s*([\w-]+)", line)) and m[1] == key:
            return number, 1, len(line.rstrip()), 1, len(line.rstrip())
    return 1, 1, 1, 1, 1


def _setting(
    key: str, value: Any, option: click.Option, span: TextSpan, folder: Path
) -> Setting | Diagnostic:
    """Return a key's setting, or what is wrong with its value."""
    try:
        if isinstance(value, dict):
            raise ValueError("takes a value, not a table")
        nowhere = click.Context(click.Command("settings"))
        converted = option.type_cast_value(nowhere, _raw(option, value))
        return Setting(key, _checked(key, converted, folder), value, span, folder)
    except (ValueError, click.BadParameter) as why:
        reason = why.message if isinstance(why, click.BadParameter) else f"{why}, not {value!r}"
        near = _near_choice(option, value)
        return error(
            "settings-value",
            "'{key}': {reason}",
            span,
            hint="did you mean '{near}'?" if near else None,
            key=key,
            reason=reason,
            near=near,
        )


def _raw(option: click.Option, value: Any) -> Any:
    """Return a TOML value as click would get it from the command line.

    Raises:
        ValueError: of another type; says what is taken.
    """
    if option.is_flag:
        if not isinstance(value, bool):
            raise ValueError("takes true or false")
        return value
    if not option.multiple:
        return _word(option, value)
    if not isinstance(value, list) or _is_point(option, value):
        value = [value]
    return tuple(_word(option, v) for v in value)


def _is_point(option: click.Option, value: Any) -> bool:
    numbers = isinstance(value, list) and len(value) == 2
    return numbers and isinstance(option.type, Point) and not any(_not_number(v) for v in value)


def _not_number(value: Any) -> bool:
    return isinstance(value, bool) or not isinstance(value, int | float)


def _word(option: click.Option, value: Any) -> Any:
    if _is_point(option, value):
        return f"{value[0]},{value[1]}"
    if isinstance(option.type, Length) and not _not_number(value):
        return str(value)
    if isinstance(option.type, click.types.IntParamType):
        if isinstance(value, bool) or not isinstance(value, int):
            raise ValueError("takes a whole number")
        return value
    if not isinstance(value, str):
        kind = {"length": 'a length: 0.1, "0.1mm" or "100um"', "x,y": 'a point: "4,10"'}
        raise ValueError(f"takes {kind.get(option.type.name, 'text')}")
    return value


def _unknown(
    key: str,
    value: Any,
    option: click.Option | None,
    span: TextSpan,
    known: Mapping[str, click.Option],
) -> Diagnostic:
    """Return the finding for a key that is no setting; ``option`` where it is one of one run."""
    if option is not None:
        return error(
            "settings-key",
            "'{key}' names a file of one run: it is no default for others",
            span,
            hint="give --{key} on the command line",
            key=key,
        )
    can = [k for k, o in known.items() if not of_one_run(o)]
    near = next(iter(difflib.get_close_matches(key.replace("_", "-"), can, 1, 0.6)), None)
    return error(
        "settings-key",
        "there is no option --{key}",
        span,
        hint="settings stand in one list, without sections; "
        "wedmcam config lists what can stand here"
        if isinstance(value, dict)
        else "did you mean '{near}'?"
        if near
        else "wedmcam config lists what can stand here",
        key=key,
        near=near,
    )


def _near_choice(option: click.Option, value: Any) -> str | None:
    if not isinstance(option.type, click.Choice) or not isinstance(value, str):
        return None
    choices = [str(c) for c in option.type.choices]
    return next(iter(difflib.get_close_matches(value, choices, 1, 0.5)), None)


def _checked(key: str, value: Any, folder: Path) -> Any:
    """Return the value of an option that click takes as any text, checked.

    Raises:
        ValueError: no such format or profile.
    """
    if key in PROFILES:
        return _profile(value, folder)
    if key in ("to", "from"):
        formats = PROGRAM_FORMATS if key == "to" else SOURCE_FORMATS
        if value not in formats:
            raise ValueError(f"takes {', '.join(formats)}")
    return value


def _profile(value: str, folder: Path) -> str:
    if value in machines.names():
        return value
    if value.lower().endswith(".toml"):
        place = folder / value
        if not place.is_file():
            raise ValueError(f"there is no file {place}")
        return str(place)
    _, findings = machines.find(value)
    raise ValueError(f"{findings[0].message} ({findings[0].hint})")
