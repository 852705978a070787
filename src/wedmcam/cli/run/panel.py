"""``wedmcam panel``: the panel of a simulated controller as text."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from typing import Any

import click

from wedmcam.cli.files import check_outputs, read_input, shown_name, write_outputs
from wedmcam.cli.terminal import print_findings, print_json, print_text
from wedmcam.diag import Diagnostic, has_errors
from wedmcam.panel import zd065
from wedmcam.panel.script import Line, Panel, lines_of, play_script
from wedmcam.panel.terminal import Terminal

#: Name on the command line -> panel.
PANELS: dict[str, Callable[[], Panel]] = {
    "zd065": zd065.Panel,
    "eindhoven": Terminal,
    "dem15": Terminal,
}


def run_panel(
    controller: str, image: str | None, script: str | None, output: str | None, json_: bool
) -> int:
    """Run ``wedmcam panel``; return the exit status."""
    if output is not None:
        check_outputs([name for name in (image, script) if name is not None], [output])
    panel = PANELS[controller]()
    if image is not None:
        findings = panel.load(read_input(image), shown_name(image))
        print_findings(findings, shown_name(image))
        if has_errors(findings):
            return 1
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
    data = None
    if output is not None and status == 0:
        data, findings = panel.saved()
        print_findings(findings, output)
        status = int(data is None)
    if json_:
        print_json(_data(panel.controller, transcript, status == 0))
    if output is not None and data is not None:
        write_outputs([(output, data)])
    return status


def _typed(panel: Panel) -> Iterator[Line | Diagnostic]:
    """Yield what comes of each line that somebody types, up to ``quit``."""
    print_text(panel.greeting)
    while True:
        try:
            text = input(panel.prompt)
        except EOFError:
            return
        word = text.strip().lower()
        if word in ("quit", "exit"):
            return
        if word == "help":
            print_text("\n".join(panel.help_lines()))
        elif word:
            line = panel.play(text)
            if line is None:
                print_text(panel.how)
            else:
                yield line


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
                **line.more,
            }
            for line in transcript
        ],
    }
