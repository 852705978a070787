"""A profile as text with every value in force: what a shop starts its own from.

The built-in files leave defaults out, and a reader cannot see what could stand there. Here each key
that the format takes is written with what it means. Meanings are those of the attributes in
``machine``, so they are stated once.
"""

from __future__ import annotations

import hashlib
import inspect
import json
import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

from wedmcam.machines import machine as model
from wedmcam.machines.machine import Machine
from wedmcam.machines.read import _EOL, _ISO, _SCHEMA
from wedmcam.machines.vocabulary import TAKES, Vocabulary


@dataclass(frozen=True, slots=True)
class Entry:
    """One key of a profile.

    Attributes:
        section: table that it stands in; empty for the top.
        key: its name there.
        value: in force, as TOML has it; None where there is none and none is written.
        takes: what may stand there.
        means: what it does.
        required: every profile must say it.
        formats: that know it.
    """

    section: str
    key: str
    value: Any
    takes: str
    means: str
    required: bool
    formats: tuple[str, ...]


@cache
def meanings(of: type) -> dict[str, str]:
    """Return attribute -> meaning from the docstring of a dataclass.

    >>> meanings(model.Limits)["count_um"]
    'count length J of one block.'
    """
    text = inspect.getdoc(of) or ""
    _, _, attributes = text.partition("Attributes:\n")
    out: dict[str, str] = {}
    for name, meaning in re.findall(r"^    (\w+): (.*(?:\n(?:        .*|))*)", attributes, re.M):
        out[name] = " ".join(re.sub("`+", "", meaning).split())
    return out


def about(of: type) -> list[str]:
    """Return the paragraphs of a dataclass's docstring between its first line and its attributes.

    >>> about(model.Axes)[1][:36]
    'Programs, their limits, travel and 4'
    """
    text = (inspect.getdoc(of) or "").partition("Attributes:\n")[0]
    return [" ".join(re.sub("`+", "", p).split()) for p in text.split("\n\n")[1:] if p.strip()]


def section_types() -> dict[str, type]:
    """Return section -> the dataclass that holds it; the top is the machine itself."""
    hints = Machine.__annotations__
    return {"": Machine} | {s: getattr(model, str(hints[s])) for s in _SCHEMA if s in hints}


def entries(machine: Machine | None = None, format_: str | None = None) -> Iterator[Entry]:
    """Yield the keys that a format takes, in their order, with the values of a machine.

    Without a machine values are None; without a format all keys are given.
    """
    wanted = machine.format if machine else format_
    for section, rules in _SCHEMA.items():
        holder: Any = getattr(machine, section) if machine and section else machine
        of_key = meanings(section_types()[section]) if section in section_types() else {}
        for key, rule in rules.items():
            if wanted is not None and wanted not in rule.formats:
                continue
            value = None if holder is None else _toml_value(key, getattr(holder, key))
            if value is not None and not (type(value) is rule.of and rule.good(value)):
                value = None  # 0 for no limit: a profile says that by leaving the key out
            yield Entry(
                section, key, value, rule.takes, of_key.get(key, ""), rule.required, rule.formats
            )
        if section == "iso" and (wanted is None or wanted in _ISO):
            yield from _word_entries(machine)


def _word_entries(machine: Machine | None) -> Iterator[Entry]:
    """Yield the words of a dialect; of none, and of a class without words, its class."""
    for class_, means in meanings(Vocabulary).items():
        named = getattr(machine.iso.words, class_) if machine else ()
        section = f"iso.words.{class_}"
        for key, text in named:
            yield Entry(section, key, text, "", "", False, _ISO)
        if not named:
            yield Entry(section, "", None, TAKES, means, False, _ISO)


def _toml_value(key: str, value: Any) -> Any:
    if key == "eol":
        return next(name for name, text in _EOL.items() if text == value)
    return list(value) if isinstance(value, tuple) else value


def _toml_text(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{', '.join(_toml_text(v) for v in value)}]"
    # Strings of JSON are basic strings of TOML; whole numbers are the same in both.
    return json.dumps(value, ensure_ascii=False)


def fingerprint(machine: Machine) -> str:
    """Return the SHA-256 of a profile: of the keys and values that `as_toml` prints.

    Comments and what has no value do not count, so it changes with the machine alone.

    >>> from wedmcam.machines import builtin
    >>> fingerprint(builtin("zd065")) == fingerprint(builtin("zd065-rotation"))
    False
    """
    lines = [f"[{e.section}] {e.key} = {_toml_text(e.value)}\n" for e in entries(machine)
             if e.value is not None]  # fmt: skip
    return hashlib.sha256("".join(lines).encode("utf-8")).hexdigest()


def _comment(text: str) -> list[str]:
    return textwrap.wrap(text, 96, initial_indent="# ", subsequent_indent="#   ")


def as_toml(machine: Machine) -> str:
    """Return a profile as TOML: every key that its format takes, with its meaning.

    `parse` makes the same machine of it.
    """
    lines = [f"# Profile {machine.name}: every value in force. Lengths in um."]
    section = ""
    words = meanings(Vocabulary)
    for entry in entries(machine):
        if entry.section != section:
            section = entry.section
            lines += ["", f"[{section}]"]
            if (class_ := section.removeprefix("iso.words.")) in words:
                lines += _comment(f"{words[class_]} Takes {TAKES}, and what it does.")
        if section.startswith("iso.words."):
            key = entry.key if "." not in entry.key else json.dumps(entry.key)
            lines += [f"{key} = {_toml_text(entry.value)}"] if entry.key else ["# no word"]
            continue
        about = f"{entry.means} Takes {entry.takes}.".strip()
        lines += _comment(about)
        if entry.value is None:
            lines.append(f"# {entry.key} is not set")
        else:
            lines.append(f"{entry.key} = {_toml_text(entry.value)}")
    return "\n".join(lines) + "\n"
