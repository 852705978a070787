"""Scripts and transcripts of a panel, whichever it is.

A line of a script is what somebody presses or types, or what happens around the machine, in virtual
time (``run 500``, ``break``). What a panel makes of it is its own; here is what all have in common.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

from wedmcam.diag import Diagnostic, TextSpan, error

#: A number in a line that says what happens.
NUMBER = r"([0-9]{1,9})"
#: Patterns of lines, and which deed they are; numbers of the line are its arguments.
Happenings = Sequence[tuple[re.Pattern[str], str]]


@dataclass(frozen=True, slots=True)
class Shown:
    """What a panel shows: digits, and what they mean; at a terminal a line of text alone."""

    digits: str
    text: str


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a transcript.

    Attributes:
        text: what was keyed in, or happened.
        shown: what the panel showed, one after the other.
        waits_for: what is keyed in next; empty where nothing was begun.
        mode: of the panel behind it.
        time_s: virtual time.
        more: what else there is to say of it.
    """

    text: str
    shown: tuple[Shown, ...]
    waits_for: str
    mode: str
    time_s: float
    more: Mapping[str, Any] = field(default_factory=dict)


class Panel(Protocol):
    """A panel with the machine behind it.

    Attributes:
        controller: its name, in reports.
        greeting: how it opens for somebody at a terminal.
        how: which lines there are.
    """

    controller: str
    greeting: str
    how: str

    @property
    def prompt(self) -> str:
        """What stands in front of a line that is typed."""
        ...

    def load(self, data: bytes, name: str) -> list[Diagnostic]:
        """Put a file into the memory; an error says that it is none."""
        ...

    def play(self, text: str) -> Line | None:
        """Do what a line says; None where it says nothing that is known."""
        ...

    def help_lines(self) -> Iterator[str]:
        """Yield what can be done now."""
        ...

    def saved(self) -> tuple[bytes | None, list[Diagnostic]]:
        """Return the file of the memory; None, and why, where it cannot be one."""
        ...


def happening(table: Happenings, text: str) -> tuple[str, list[int]] | None:
    """Return the deed that a line names, with its numbers; None where it names none."""
    for pattern, name in table:
        if match := pattern.fullmatch(" ".join(text.lower().split())):
            return name, [int(number) for number in match.groups()]
    return None


def play_script(panel: Panel, script: str, name: str) -> Iterator[Line | Diagnostic]:
    """Yield what came of each line of a script; a finding on an unknown line ends it."""
    for number, text in enumerate(re.split("\r\n|\r|\n", script), 1):
        if not text.strip() or text.lstrip().startswith("#"):
            continue
        line = panel.play(text)
        if line is None:
            yield error(
                "bad-script",
                "{text} names no key, and nothing that happens",
                TextSpan(name, number, 1),
                hint="{how}",
                text=text.strip(),
                how=panel.how,
            )
            return
        yield line


def lines_of(line: Line) -> Iterator[str]:
    """Yield a line of a transcript as text: what was keyed in, then what the panel showed."""
    yield f"> {line.text}"
    for one in line.shown:
        digits = f"[{one.digits}]  " if one.digits else ""
        yield f"{digits}{one.text}".rstrip()
    if line.waits_for:
        yield f"          ({line.waits_for})"
