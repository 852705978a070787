"""Lines of keys and of what happens around the machine, and the transcript of a panel.

A line is keys (``U5 0 0012 0015``) or one of these, in virtual time::

    run            until the machine stops         short 60     the wire touches, free 60 um back
    run 500        so many steps                   break        the wire breaks
    run to block 7                                 power off    power on
    wait 5s                                        # a comment
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from wedmcam.diag import Diagnostic, TextSpan, error
from wedmcam.panel.keys import keys_in
from wedmcam.panel.machine import Denied, Shown
from wedmcam.panel.zd065 import Panel

HOW = (
    "keys are 0 to F and U0 to U7; else: run, run N, run to block N, short UM, break, power off, "
    "power on, wait 5s"
)
_NUMBER = r"([0-9]{1,9})"
#: Pattern of a line -> which method of the panel it is; numbers of the line are its arguments.
_HAPPENS = (
    (re.compile(r"run"), "run_on"),
    (re.compile(rf"run {_NUMBER}"), "run"),
    (re.compile(rf"run to block {_NUMBER}"), "run_to_block"),
    (re.compile(rf"short {_NUMBER}"), "short"),
    (re.compile(r"break"), "break_wire"),
    (re.compile(r"power off"), "cut_power"),
    (re.compile(r"power on"), "restore_power"),
    (re.compile(rf"wait {_NUMBER} ?s"), "wait"),
)


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a transcript.

    Attributes:
        text: what was keyed in, or happened.
        shown: what the digits showed, one after the other.
        waits_for: what is keyed in next; empty where nothing was begun.
        mode: of the panel behind it.
        time_s: virtual time.
    """

    text: str
    shown: tuple[Shown, ...]
    waits_for: str
    mode: str
    time_s: float


def play(panel: Panel, text: str) -> Line | None:
    """Do what a line says; return what came of it, None where it says nothing that is known.

    Keys behind one that shows an error are not pressed.
    """
    plain = " ".join(text.partition("#")[0].split())
    shown: list[Shown] = []
    keys = keys_in(plain)
    if keys is not None:
        for key in keys:
            new = panel.press(key)
            shown += [one for one in new if one.text]
            if new and new[-1].digits.startswith("E"):
                break
    elif plain:
        happens = next(
            ((name, m) for pattern, name in _HAPPENS if (m := pattern.fullmatch(plain.lower()))),
            None,
        )
        if happens is None:
            return None
        shown += _happen(panel, happens[0], [int(n) for n in happens[1].groups()])
    return Line(
        " ".join(text.split()),
        tuple(shown),
        panel.waits_for,
        str(panel.mode),
        panel.machine.time_s,
    )


def _happen(panel: Panel, name: str, numbers: list[int]) -> list[Shown]:
    try:
        if name == "run_on":
            return panel.run(None)
        deed = getattr(panel, name)
        shown: list[Shown] = deed(*numbers)
    except Denied as why:
        return [Shown(panel.digits, f"nothing happens: {why}")]
    return shown


def play_script(panel: Panel, script: str, name: str) -> Iterator[Line | Diagnostic]:
    """Yield what came of each line of a script; a finding on an unknown line ends it."""
    for number, text in enumerate(script.splitlines(), 1):
        if not text.strip() or text.lstrip().startswith("#"):
            continue
        line = play(panel, text)
        if line is None:
            yield error(
                "bad-script",
                "{text} names no key, and nothing that happens",
                TextSpan(name, number, 1),
                hint=HOW,
                text=text.strip(),
            )
            return
        yield line


def lines_of(line: Line) -> Iterator[str]:
    """Yield a line of a transcript as text: what was keyed in, then what the digits showed."""
    yield f"> {line.text}"
    for one in line.shown:
        yield f"[{one.digits}]  {one.text}".rstrip()
    if line.waits_for:
        yield f"          ({line.waits_for})"
