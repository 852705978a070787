"""``wedmcam panel``: the front panel of a simulated controller as text."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import Any

import click

from wedmcam import api
from wedmcam.cli.files import check_outputs, read_input, shown_name, write_outputs
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import Diagnostic, has_errors
from wedmcam.panel.machine import Machine
from wedmcam.panel.script import HOW, Line, lines_of, play, play_script
from wedmcam.panel.zd065 import FUNCTIONS, Panel, unlocked


def run_panel(
    controller: str, image: str | None, script: str | None, output: str | None, json_: bool
) -> int:
    """Run ``wedmcam panel``; return the exit status."""
    if output is not None:
        check_outputs([name for name in (image, script) if name is not None], [output])
    machine = Machine()
    if image is not None:
        held, findings = api.read_memory(read_input(image), name=shown_name(image))
        print_findings(findings, shown_name(image))
        if held is None:
            return 1
        machine.image = held
    panel = Panel(machine)
    typing = script is None and sys.stdin.isatty()
    if typing and json_:
        raise click.UsageError("--json is for a script: give --script FILE")
    lines, status = _typed(panel), 0
    if not typing:
        name = script or "-"
        text = read_input(name).decode("utf-8", "replace")
        lines = play_script(panel, text, shown_name(name))
    transcript: list[Line] = []
    for line in lines:
        if isinstance(line, Diagnostic):
            print_findings([line], shown_name(script or "-"))
            status = int(has_errors([line]))
            continue
        transcript.append(line)
        if not json_:
            shown = list(lines_of(line))
            print_text("\n".join(shown[1:] if typing else shown))
    if json_:
        print_json(_data(controller, transcript, status == 0))
    if output is not None and status == 0:
        write_outputs([(output, panel.machine.image.data)])
    return status


def _typed(panel: Panel) -> Iterator[Line | Diagnostic]:
    """Yield what comes of each line that somebody types, up to ``quit``."""
    print_text("the panel of a ZD-065; help, quit")
    while True:
        try:
            text = input(f"[{panel.digits}] {panel.mode}> ")
        except EOFError:
            return
        word = text.strip().lower()
        if word in ("quit", "exit"):
            return
        if word == "help":
            print_text("\n".join(_help(panel)))
        elif word:
            line = play(panel, text)
            if line is None:
                print_text(HOW)
            else:
                yield line


def _help(panel: Panel) -> Iterator[str]:
    yield HOW
    for name in unlocked(panel.mode):
        key, digit = name.split()
        yield f"{name}  {FUNCTIONS[key][digit].name}"


def _data(controller: str, transcript: list[Line], ok: bool) -> dict[str, Any]:
    return {
        "controller": controller,
        "ok": ok,
        "lines": [
            {
                "line": line.text,
                "shown": [{"digits": one.digits, "text": one.text} for one in line.shown],
                "waits_for": line.waits_for,
                "mode": line.mode,
                "time_s": round(line.time_s, 6),
            }
            for line in transcript
        ],
    }
